//! Random machines and random motions, compared with an exact rational reference that shares no code with the
//! crate.
mod oracle;

use glidepath::machine::{AxisData, AxisKind, AxisName, ChannelData, MachineData};
use glidepath::quantity::Position;
use glidepath_steps::{AxisSteps, Motor, Pin, State, StepData, Steps};
use oracle::{Random, Watch, crossing_slots, rounded};

/// A machine that the crate accepts, of random data.
fn machine<const SLOTS: usize>(random: &mut Random) -> (MachineData<3>, StepData<3>) {
    let cycle_us = [500, 1000, 2000][random.below(3) as usize];
    let slot_ns = cycle_us * 1000 / SLOTS as u32;
    let names = ["X", "Y", "Z"];
    let mut bits: Vec<u8> = (0..16).collect();
    for i in (1..16).rev() {
        bits.swap(i, random.below(i as u64 + 1) as usize);
    }
    let mut pin = || Pin { bit: bits.pop().expect("a free bit"), is_inverted: bits.len().is_multiple_of(3) };
    let mut axes = [AxisData::new(AxisName::new("X").expect("a name"), AxisKind::Linear); 3];
    let steps = std::array::from_fn(|i| {
        let two = random.below(2) == 0;
        let mut motor = || Motor { step: pin(), direction: pin() };
        let steps = AxisSteps {
            counts: 1 + random.below(2_000_000) as u32,
            length: 1 + random.below(10_000) as u32,
            pulse_ns: 1 + random.below(6000) as u32,
            gap_ns: random.below(6000) as u32,
            setup_ns: random.below(12_000) as u32,
            hold_ns: random.below(12_000) as u32,
            motors: [Some(motor()), two.then(motor)],
            ..AxisSteps::new(1, 1, Motor::new(0, 1))
        };
        axes[i].name = AxisName::new(names[i]).expect("a name");
        let slots = |ns: u32| ns.div_ceil(slot_ns);
        let period = slots(steps.pulse_ns).max(1) + slots(steps.gap_ns).max(1);
        let most = u64::from(SLOTS as u32 / period);
        // counts per tick / (counts / length) / µs · 10^9
        let fastest =
            most * u64::from(steps.length) * 1_000_000_000 / (u64::from(steps.counts) * u64::from(cycle_us));
        axes[i].vb_max = fastest.min(4_000_000_000) as u32;
        // Half of what fits into the tick of a reversal, at most.
        let room = (SLOTS as u64
            - u64::from(slots(steps.setup_ns) + slots(steps.hold_ns) + slots(steps.pulse_ns)))
            / u64::from(period);
        let steepest = room.saturating_sub(2) * u64::from(steps.length) * 1_000_000_000_000
            / (u64::from(steps.counts) * u64::from(cycle_us) * u64::from(cycle_us));
        axes[i].a_max = (steepest / 2).min(100_000_000) as u32;
        steps
    });
    let channel = ChannelData { cycle_us, ..ChannelData::new() };
    (MachineData { axes, channel }, StepData { slot_ns, axes: steps })
}

/// A motion with limited acceleration, in set points: stretches of random acceleration, rests, and reversals.
struct Walk {
    /// LSB 2^-32 mm.
    at: i64,
    speed: i64,
    accel: i64,
    left: u64,
    fastest: i64,
    steepest: i64,
}

impl Walk {
    fn new(axis: &AxisData, cycle_us: u32, at: i64) -> Self {
        let cycle = i128::from(cycle_us);
        let fastest = ((i128::from(axis.vb_max) * cycle) << 32) / 1_000_000_000;
        let steepest = ((i128::from(axis.a_max) * cycle * cycle) << 32) / 1_000_000_000_000;
        let [fastest, steepest] = [fastest, steepest].map(|bits| bits as i64);
        Self { at, speed: 0, accel: 0, left: 0, fastest, steepest }
    }

    fn next(&mut self, random: &mut Random) -> i64 {
        if self.left == 0 {
            self.left = 1 + random.below(60);
            self.accel = match random.below(6) {
                0 => 0,
                1 => -self.speed / self.left as i64,
                2 => random.signed(self.steepest / 1000),
                _ => random.signed(self.steepest),
            };
            self.accel = self.accel.clamp(-self.steepest, self.steepest);
        }
        self.left -= 1;
        self.speed = (self.speed + self.accel).clamp(-self.fastest, self.fastest);
        if self.at.abs() > 1 << 47 && self.speed.signum() == self.at.signum() {
            self.speed -= self.speed.clamp(-self.steepest, self.steepest);
        }
        self.at += self.speed;
        self.at
    }
}

fn walk<const SLOTS: usize>(seed: u64) -> u64 {
    let mut random = Random(seed);
    let (machine, data) = machine::<SLOTS>(&mut random);
    let start: [i64; 3] = std::array::from_fn(|_| random.signed(1 << 45));
    let mut steps = Steps::<3, SLOTS>::new(&data, &machine, &start.map(Position::from_bits))
        .unwrap_or_else(|unfit| panic!("seed {seed}: {unfit}"));
    let mut walks: [Walk; 3] =
        std::array::from_fn(|i| Walk::new(&machine.axes[i], machine.channel.cycle_us, start[i]));
    let mut watches: Vec<Watch> = data
        .axes
        .iter()
        .flat_map(|axis| axis.motors.iter().flatten().map(|motor| Watch::new(axis, motor, data.slot_ns)))
        .collect();
    let owners: Vec<usize> =
        (0..3).flat_map(|i| vec![i; data.axes[i].motors.iter().flatten().count()]).collect();
    let first: [i128; 3] =
        std::array::from_fn(|i| rounded(start[i], data.axes[i].counts, data.axes[i].length));
    let mut words = [0; SLOTS];
    let mut total = 0;
    let mut before = start;
    for tick in 0..1000 {
        let set_points = std::array::from_fn(|i| walks[i].next(&mut random));
        let state = steps.fill(&set_points.map(Position::from_bits), &mut words);
        assert_eq!(state, State::InTime, "seed {seed}, tick {tick}");
        for (watch, &i) in watches.iter_mut().zip(&owners) {
            let axis = &data.axes[i];
            let wanted = rounded(set_points[i], axis.counts, axis.length);
            let begun = watch
                .tick(&words)
                .unwrap_or_else(|fault| panic!("seed {seed}, tick {tick}, axis {i}: {fault}"));
            assert_eq!(first[i] + watch.count, wanted, "seed {seed}, tick {tick}, axis {i}");
            assert_eq!(i128::from(steps.count(i)), wanted);
            // No step comes before its slot. Behind a reversal it may come later.
            let ideal = crossing_slots(before[i], set_points[i], axis.counts, axis.length, SLOTS as u32);
            assert_eq!(begun.len(), ideal.len());
            for (slot, [from, to]) in begun.iter().zip(&ideal) {
                assert!(
                    *slot as f64 + 1.05 >= *from,
                    "seed {seed}, tick {tick}: slot {slot}, due at {from}…{to}"
                );
            }
            total += begun.len() as u64;
        }
        before = set_points;
    }
    total
}

#[test]
fn sums_are_the_rounded_set_points_and_times_are_kept() {
    let mut total = 0;
    let extra = oracle::fresh_seed();
    for seed in (0..60).chain(extra..extra + 20) {
        total += walk::<200>(seed) + walk::<400>(seed) + walk::<50>(seed) + walk::<500>(seed);
    }
    // The walks are not all too slow to step.
    assert!(total > 2_000_000, "{total} steps");
}

/// At constant speed each step begins in the slot of its ideal time, or one beside it.
#[test]
fn constant_speed_jitters_by_a_slot_at_most() {
    const SLOTS: usize = 200;
    let mut random = Random(7);
    for seed in 0..200 {
        let (counts, length) = (1 + random.below(1_000_000) as u32, 1 + random.below(5000) as u32);
        let axis = AxisSteps { counts, length, ..AxisSteps::new(1, 1, Motor::new(0, 1)) };
        let mut data = AxisData::new(AxisName::new("X").expect("a name"), AxisKind::Linear);
        // Up to the 100 counts per tick that fit.
        let most = 100 * (i128::from(length) << 32) / i128::from(counts);
        data.vb_max = ((most * 1_000_000) >> 32).min(4_000_000_000) as u32;
        data.a_max = 0;
        let machine = MachineData { axes: [data], channel: ChannelData::new() };
        let start = random.signed(1 << 45);
        let mut steps = Steps::<1, SLOTS>::new(
            &StepData { slot_ns: 5000, axes: [axis] },
            &machine,
            &[Position::from_bits(start)],
        )
        .unwrap_or_else(|unfit| panic!("{unfit}"));
        let speed = random.signed((most as i64).min(i64::from(data.vb_max) << 32) / 1000 * (1 + seed % 1000));
        let (mut at, mut words, mut worst) = (start, [0; SLOTS], 0.0_f64);
        let mut watch = Watch::new(&axis, &axis.motors[0].expect("a motor"), 5000);
        for _ in 0..500 {
            let next = at + speed;
            assert_eq!(steps.fill(&[Position::from_bits(next)], &mut words), State::InTime);
            let begun = watch.tick(&words).expect("times are kept");
            let ideal = crossing_slots(at, next, counts, length, SLOTS as u32);
            assert_eq!(begun.len(), ideal.len());
            for (slot, [from, to]) in begun.iter().zip(&ideal) {
                let slot = f64::from(*slot);
                worst = worst.max(slot - from).max(to - slot - 1.0);
            }
            at = next;
        }
        assert!(worst <= 1.05, "seed {seed}: {worst} slots off, {speed} per tick");
    }
}

/// A motion there and back ends where it began, with as many steps each way, and both ends are exact.
#[test]
fn both_ends_are_exact() {
    const SLOTS: usize = 200;
    for (counts, length) in [(80, 1), (250_123, 1000), (3200, 360), (1, 1), (999_983, 9973)] {
        let axis = AxisSteps { counts, length, ..AxisSteps::new(1, 1, Motor::new(0, 1)) };
        let mut data = AxisData::new(AxisName::new("X").expect("a name"), AxisKind::Linear);
        (data.vb_max, data.a_max) = (10_000, 100);
        let machine = MachineData { axes: [data], channel: ChannelData::new() };
        let data = StepData { slot_ns: 5000, axes: [axis] };
        let mut steps = Steps::<1, SLOTS>::new(&data, &machine, &[Position::ZERO])
            .unwrap_or_else(|unfit| panic!("{unfit}"));
        let mut watch = Watch::new(&axis, &axis.motors[0].expect("a motor"), 5000);
        let mut words = [0; SLOTS];
        // 10 mm at 10 mm/s.
        let there = (1..=1000).map(|tick| tick * (10 << 32) / 1000);
        let back = (0..1000).rev().map(|tick| tick * (10 << 32) / 1000);
        let mut rises = 0;
        for at in there.chain(back) {
            assert_eq!(steps.fill(&[Position::from_bits(at)], &mut words), State::InTime);
            rises += watch.tick(&words).expect("times are kept").len() as i128;
            if at == 10 << 32 {
                assert_eq!(watch.count, rounded(10 << 32, counts, length));
            }
        }
        assert_eq!((watch.count, rises), (0, 2 * rounded(10 << 32, counts, length)));
    }
}

//! Impossible data, set points beyond the limits, backlash, and two motors.
mod oracle;

use glidepath::machine::{AxisData, AxisKind, AxisName, ChannelData, MachineData};
use glidepath::quantity::Position;
use glidepath_steps::{AxisSteps, Backlash, Levels, Motor, Pin, State, StepData, Steps, Unfit};
use oracle::{Random, Watch, rounded};

const SLOTS: usize = 200;

fn name() -> AxisName {
    AxisName::new("X").expect("a name")
}

/// 100 counts per mm at a cycle of 1 ms with slots of 5 µs: 100 counts per tick are 1,000 mm/s.
fn good() -> (MachineData<1>, StepData<1>) {
    let axis = AxisData { vb_max: 1_000_000, a_max: 6000, ..AxisData::new(name(), AxisKind::Linear) };
    let machine = MachineData { axes: [axis], channel: ChannelData::new() };
    (machine, StepData { slot_ns: 5000, axes: [AxisSteps::new(100, 1, Motor::new(0, 1))] })
}

fn refusal(change: impl Fn(&mut AxisSteps)) -> Result<(), Unfit> {
    let (machine, mut data) = good();
    change(&mut data.axes[0]);
    Steps::<1, SLOTS>::new(&data, &machine, &[Position::ZERO]).map(|_| ())
}

#[test]
fn data_that_cannot_work_are_refused_by_name() {
    assert_eq!(refusal(|_| {}), Ok(()));
    for (counts, length) in [(0, 1), (1_000_000_001, 1), (1, 0), (1, 1_000_001)] {
        assert_eq!(refusal(|axis| (axis.counts, axis.length) = (counts, length)), Err(Unfit::Ratio(name())));
    }
    assert_eq!(refusal(|axis| axis.motors = [None; 2]), Err(Unfit::NoMotor(name())));
    assert_eq!(refusal(|axis| axis.motors[1] = Some(Motor::new(2, 16))), Err(Unfit::NoPin(name(), 16)));
    assert_eq!(refusal(|axis| axis.motors[1] = Some(Motor::new(2, 1))), Err(Unfit::PinTaken(name(), 1)));
    assert_eq!(refusal(|axis| axis.motors[0] = Some(Motor::new(3, 3))), Err(Unfit::PinTaken(name(), 3)));
    assert_eq!(refusal(|axis| axis.hold_ns = 1_000_000), Err(Unfit::Times(name())));
    assert_eq!(refusal(|axis| axis.setup_ns = u32::MAX), Err(Unfit::Times(name())));
    assert_eq!(refusal(|axis| axis.pulse_ns = 1_000_000), Err(Unfit::Times(name())));
    // 101 counts per mm and tick.
    let told = Unfit::TooFast { axis: name(), speed: 1_000_000, permitted: 990_099 };
    assert_eq!(refusal(|axis| axis.counts = 101), Err(told));
    // A pulse of two slots: 66 in a tick.
    let told = Unfit::TooFast { axis: name(), speed: 1_000_000, permitted: 660_000 };
    assert_eq!(refusal(|axis| axis.pulse_ns = 5001), Err(told));
    // 990 µs of set-up leave room for one step: a turn at 6,000 mm/s² may need three.
    let told = Unfit::TurnsTooFast { axis: name(), accel: 6000, permitted: 0 };
    assert_eq!(refusal(|axis| axis.setup_ns = 990_000), Err(told));
    let play = Backlash { width: 100, speed: 0, accel: 100, starts_positive: false };
    assert_eq!(refusal(|axis| axis.backlash = play), Err(Unfit::Backlash(name())));
    assert_eq!(
        refusal(|axis| axis.backlash = Backlash { width: 1_000_001, speed: 1, ..play }),
        Err(Unfit::Backlash(name()))
    );
    // The backlash needs speed of its own.
    let told = Unfit::TooFast { axis: name(), speed: 1_001_000, permitted: 1_000_000 };
    assert_eq!(refusal(|axis| axis.backlash = Backlash { speed: 1000, ..play }), Err(told));
}

#[test]
fn slots_fill_the_cycle() {
    let (mut machine, data) = good();
    assert!(matches!(
        Steps::<1, 400>::new(&data, &machine, &[Position::ZERO]),
        Err(Unfit::Cycle { cycle_us: 1000, slot_ns: 5000, slots: 400 })
    ));
    machine.channel.cycle_us = 2000;
    assert!(Steps::<1, 400>::new(&data, &machine, &[Position::ZERO]).is_ok());
    assert!(matches!(Steps::<1, 3>::new(&data, &machine, &[Position::ZERO]), Err(Unfit::Slots(3))));
    assert!(matches!(Steps::<1, 513>::new(&data, &machine, &[Position::ZERO]), Err(Unfit::Slots(513))));
    let told = Unfit::Cycle { cycle_us: 1000, slot_ns: 5000, slots: 400 }.to_string();
    assert_eq!(
        told,
        "400 slots of 5000 ns do not fill the cycle of 1000 µs; expected slot_ns = cycle_us · 1000 / 400"
    );
}

fn steps(data: &StepData<1>) -> (Steps<1, SLOTS>, Watch) {
    let (machine, _) = good();
    let steps = Steps::new(data, &machine, &[Position::ZERO]).unwrap_or_else(|unfit| panic!("{unfit}"));
    let motor = data.axes[0].motors[0].expect("a motor");
    (steps, Watch::new(&data.axes[0], &motor, data.slot_ns))
}

#[test]
fn too_many_steps_are_late_and_none_is_lost() {
    let (_, data) = good();
    let (mut steps, mut watch) = steps(&data);
    let mut words = [0; SLOTS];
    // 130 counts in a tick that has room for 100.
    assert_eq!(steps.fill(&[Position::from_num(1.3)], &mut words), State::Late);
    watch.tick(&words).expect("times are kept");
    assert_eq!((watch.count, steps.count(0)), (100, 100));
    assert_eq!(steps.fill(&[Position::from_num(1.3)], &mut words), State::InTime);
    watch.tick(&words).expect("times are kept");
    assert_eq!((watch.count, steps.count(0)), (130, 130));
    // At full speed there and at once back.
    for (at, count, state) in [(2.3, 230, State::InTime), (1.31, 131, State::InTime)] {
        assert_eq!(steps.fill(&[Position::from_num(at)], &mut words), state);
        watch.tick(&words).expect("times are kept");
        assert_eq!(watch.count, count);
    }
}

/// Set points with jumps of all sizes: times are kept, and what is late comes.
#[test]
fn set_points_beyond_all_limits_keep_the_times() {
    let mut random = Random(3);
    let (_, mut data) = good();
    for setup_ns in [0, 1000, 20_000, 400_000] {
        data.axes[0].setup_ns = setup_ns;
        let (mut steps, mut watch) = steps(&data);
        let (mut at, mut words, mut seen) = (0_i64, [0; SLOTS], [0; 3]);
        for _ in 0..20_000 {
            let most = 1 << (25 + random.below(9));
            at += random.signed(most);
            let state = steps.fill(&[Position::from_bits(at)], &mut words);
            watch.tick(&words).expect("times are kept");
            seen[state as usize] += 1;
            match state {
                State::InTime => assert_eq!(watch.count, rounded(at, 100, 1)),
                State::Late => {}
                State::Stopped => {
                    assert_eq!(steps.fill(&[Position::from_bits(at)], &mut words), State::Stopped);
                    watch.tick(&words).expect("times are kept");
                    // Where the axis really is, in the middle of a count.
                    at = ((watch.count << 32) / 100) as i64;
                    let is = rounded(at, 100, 1);
                    at += i64::from(is < watch.count);
                    assert_eq!(i128::from(steps.count(0)), watch.count);
                    steps.stand_at(&[Position::from_bits(at)]);
                }
            }
            assert_eq!(i128::from(steps.count(0)), watch.count);
        }
        assert!(seen[0] > 0 && seen[1] > 0 && seen[2] > 0, "{seen:?}");
    }
}

#[test]
fn backlash_is_taken_up_at_each_reversal() {
    let (mut machine, mut data) = good();
    (machine.axes[0].vb_max, machine.axes[0].a_max) = (500_000, 2000);
    // 0.234 mm: 23.4 counts.
    data.axes[0].backlash = Backlash { width: 2340, speed: 100_000, accel: 1000, starts_positive: true };
    let mut steps =
        Steps::<1, SLOTS>::new(&data, &machine, &[Position::ZERO]).unwrap_or_else(|unfit| panic!("{unfit}"));
    let motor = data.axes[0].motors[0].expect("a motor");
    let mut watch = Watch::new(&data.axes[0], &motor, data.slot_ns);
    let mut words = [0; SLOTS];
    let play = |bits: i64, is_positive: bool| {
        // 23.4 counts in the units of the set point, exact to its LSB.
        let width = if is_positive { (2340_i64 << 32) / 10_000 } else { 0 };
        rounded(bits + width, 100, 1)
    };
    // From here the motor counts: it stands on the positive flank.
    let zero = play(0, true);
    let mut at = 0_i64;
    for (way_mm, is_positive) in [(3_i64, true), (-5, false), (-1, false), (4, true), (-2, false), (1, true)]
    {
        let goal = at + (way_mm << 32);
        let speed = (way_mm.signum() << 32) / 20;
        let mut most = 0;
        // Taking it up lasts 31 ms, the shortest motion 20.
        let mut rest = 0;
        while rest < 20 {
            rest += usize::from(at == goal);
            at = if (goal - at).abs() < speed.abs() { goal } else { at + speed };
            assert_eq!(steps.fill(&[Position::from_bits(at)], &mut words), State::InTime);
            most = watch.tick(&words).expect("times are kept").len().max(most);
            let between = [play(at, false), play(at, true)];
            assert!((between[0]..=between[1]).contains(&(zero + watch.count)), "{between:?} {}", watch.count);
        }
        // 5 counts of the axis, at most 10 of the play, one more of rounding.
        assert!(most <= 16, "{most} steps in a tick");
        assert_eq!(zero + watch.count, play(at, is_positive), "{way_mm} mm");
    }
}

/// Both motors of an axis get the same steps; one of them may rest.
#[test]
fn a_second_motor_goes_along() {
    let (machine, mut data) = good();
    let motors = [Motor::new(4, 5), Motor { step: Pin::new(6).inverted(), ..Motor::new(6, 7).reversed() }];
    data.axes[0].motors = motors.map(Some);
    let mut steps =
        Steps::<1, SLOTS>::new(&data, &machine, &[Position::ZERO]).unwrap_or_else(|unfit| panic!("{unfit}"));
    assert_eq!(Levels::default().behind(steps.rest_word()), Levels(1 << 5 | 1 << 6));
    let mut watches = motors.map(|motor| Watch::new(&data.axes[0], &motor, 5000));
    let mut words = [0; SLOTS];
    for (at, motor, counts) in [(0.5, None, [50, 50]), (0.3, Some(0), [50, 30]), (0.4, Some(1), [60, 30])] {
        for other in 0..2 {
            steps.set_motor(0, other, motor != Some(other));
        }
        assert_eq!(steps.fill(&[Position::from_num(at)], &mut words), State::InTime);
        for (watch, count) in watches.iter_mut().zip(counts) {
            watch.tick(&words).expect("times are kept");
            assert_eq!(watch.count, count, "at {at}");
        }
        assert_eq!(steps.count(0), (at * 100.0_f64).round() as i64);
    }
    // Where the axis was in the middle of the tick: a tenth of a millimetre in 10 steps.
    assert_eq!((steps.steps_in(0, &words), steps.steps_in(0, &words[..100])), (10, 5));
}

/// Half a count is rounded up, from both sides; one LSB below it is rounded down.
#[test]
fn half_a_count_is_rounded_up_from_both_sides() {
    let (machine, mut data) = good();
    (data.axes[0].counts, data.axes[0].length) = (1, 1);
    let half = 1_i64 << 31;
    let edges = [-3 * half, -half, half, 3 * half, 5 * half];
    let near: Vec<i64> = edges.into_iter().flat_map(|edge| [edge - 1, edge, edge + 1]).collect();
    for &from in &near {
        for &to in &near {
            let start = [Position::from_bits(from)];
            let mut steps =
                Steps::<1, SLOTS>::new(&data, &machine, &start).unwrap_or_else(|unfit| panic!("{unfit}"));
            let mut words = [0; SLOTS];
            assert_eq!(i128::from(steps.count(0)), rounded(from, 1, 1));
            // There in two ticks, and back.
            for at in [to.midpoint(from), to, from, to] {
                let state = steps.fill(&[Position::from_bits(at)], &mut words);
                assert_eq!(state, State::InTime, "{from} to {to} at {at}");
                assert_eq!(i128::from(steps.count(0)), rounded(at, 1, 1), "{from} to {to} at {at}");
            }
        }
    }
}

/// The play is taken up once the set point has come back by a count, not before.
#[test]
fn a_reversal_of_less_than_a_count_takes_up_nothing() {
    let (machine, mut data) = good();
    (data.axes[0].counts, data.axes[0].length) = (4, 1);
    data.axes[0].backlash = Backlash { width: 10_000, speed: 1000, accel: 100, starts_positive: false };
    let mut steps =
        Steps::<1, SLOTS>::new(&data, &machine, &[Position::ZERO]).unwrap_or_else(|unfit| panic!("{unfit}"));
    let mut words = [0; SLOTS];
    let mut go = |bits: i64| {
        // A millimetre at 1 mm/s, and the ramps.
        for _ in 0..1100 {
            steps.fill(&[Position::from_bits(bits)], &mut words);
        }
        steps.count(0)
    };
    let count = 1_i64 << 30;
    assert_eq!([go(count - 1), go(-5), go(count - 6), go(-6 + count), go(-5 + count)], [1, 0, 1, 1, 1 + 4]);
    assert_eq!([go(-4), go(-5), go(-5 + count), go(-5)], [4, 4 - 4, 1 + 4, 0]);
}

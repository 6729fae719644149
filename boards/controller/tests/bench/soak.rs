//! Hours of random operation: jobs, jogs, holds, resets, doors, homing, probing, and refused lines.
use super::corruption::Random;
use super::world::{Rig, Switch, World, mm, settings, with_rig};
use super::{AXES, BUFFER};
use glidepath::quantity::Position;
use glidepath_controller::{Motion, Settings, Signals, State};

/// What was done.
#[derive(Default, Debug)]
pub struct Soaked {
    pub ticks: u64,
    pub lines: u64,
    pub jobs: u64,
    pub jogs: u64,
    pub resets: u64,
    pub homed: u64,
    pub probed: u64,
    /// FNV-1a over the set points of all ticks.
    pub digest: u64,
}

/// Travel of each axis, mm.
const TRAVEL: u64 = 60;

/// Longest time to come to rest, ticks.
const PATIENCE: u32 = 100_000;

/// The plate of the probe, true place.
const PLATE: f64 = -40.0;

/// Whether a report may say `to` when the one before said `from`.
fn may_follow(from: State, to: State) -> bool {
    use State::{Alarm, Check, Door, Hold, Home, Idle, Jog, Run, Sleep};
    match (from, to) {
        _ if from == to => true,
        (Idle, Run | Hold(_) | Jog | Door(0..=2) | Check | Home | Alarm) => true,
        (Run, Idle | Hold(_) | Door(0..=2) | Alarm) => true,
        // A resume, or a reset that has come to rest.
        (Hold(_), Hold(_) | Run | Idle | Door(0..=2) | Alarm) => true,
        (Jog, Idle | Run | Hold(_) | Door(0..=2) | Alarm) => true,
        (Door(2), Door(0 | 1)) => true,
        // The door is closed and the start comes in one look.
        (Door(0 | 1 | 3), Door(0 | 1 | 3) | Run | Idle) => true,
        (Door(_), Hold(_)) | (Check | Home | Sleep | Alarm, Idle) => true,
        (Home, Alarm) | (Alarm, Home) => true,
        _ => false,
    }
}

struct Shift<'r, 'a> {
    rig: &'r mut Rig<'a>,
    random: Random,
    state: State,
    /// Answers to come.
    wanted: u64,
    answers: u64,
    soaked: Soaked,
    /// For messages: the seed, and what was sent last.
    seed: u64,
    trail: Vec<String>,
}

/// Works for so many ticks.
///
/// # Panics
/// A state follows that must not, a line is answered not at all or twice, a place is lost by a bit.
pub fn soak(seed: u64, ticks: u64) -> Soaked {
    let mut settings: Settings<AXES> = settings();
    (settings.homing, settings.soft_limits) = (true, true);
    let mut world = World::new(seed);
    for limit in &mut world.limits {
        let mut switch = Switch::new(0.5, 1.0);
        switch.bounce = 30;
        *limit = Some(switch);
    }
    world.probe = Some((2, Switch::new(PLATE, -1.0)));
    with_rig(&settings, world, |rig| {
        let random = Random(seed);
        let soaked = Soaked { digest: 0xcbf2_9ce4_8422_2325, ..Soaked::default() };
        let mut shift = Shift {
            rig,
            random,
            state: State::Alarm,
            wanted: 0,
            answers: 0,
            soaked,
            seed,
            trail: Vec::new(),
        };
        shift.home();
        while shift.soaked.ticks < ticks {
            match shift.random.below(20) {
                0 => shift.home(),
                1 | 2 => shift.probe(),
                3..=6 => shift.jog(),
                7 | 8 => shift.reset(),
                9 => shift.check_mode(),
                _ => shift.job(),
            }
        }
        shift.soaked
    })
}

impl Shift<'_, '_> {
    fn tick(&mut self) {
        self.rig.tick();
        self.soaked.ticks += 1;
        for point in &self.rig.points {
            self.soaked.digest = (self.soaked.digest ^ point.to_bits() as u64).wrapping_mul(0x0100_0000_01b3);
        }
        let state = self.rig.controller.state(&self.rig.machine.status());
        assert!(may_follow(self.state, state), "seed {}: {:?} behind {:?}", self.seed, state, self.state);
        if core::mem::replace(&mut self.state, state) != state {
            self.keep(format!("→ {state:?}"));
        }
        for line in self.rig.read().lines() {
            self.answers += u64::from(line == "ok" || line.starts_with("error:"));
        }
        assert!(self.answers <= self.wanted, "seed {}: an answer too many", self.seed);
    }

    fn keep(&mut self, sent: String) {
        if self.trail.len() > 40 {
            self.trail.remove(0);
        }
        let state = self.state;
        self.trail.push(format!("{} {state:?} {sent}", self.soaked.ticks));
    }

    fn ticks(&mut self, most: u64) {
        for _ in 0..self.random.below(most) {
            self.tick();
        }
    }

    fn line(&mut self, line: &str) {
        while self.rig.room() < 100 {
            self.tick();
        }
        self.rig.send(line);
        self.rig.send("\n");
        self.keep(line.to_owned());
        self.wanted += 1;
        self.soaked.lines += 1;
    }

    /// Everything is answered and at rest. Holds and doors are ended meanwhile.
    fn settle(&mut self) {
        for count in 0..PATIENCE {
            self.tick();
            let status = self.rig.machine.status();
            let stands = status.is_at_rest && !status.is_busy;
            if self.answers == self.wanted && stands && matches!(self.state, State::Idle | State::Check) {
                assert_eq!((self.rig.room(), self.rig.controller.lost()), (BUFFER, 0), "seed {}", self.seed);
                return;
            }
            if count % 50 == 49 {
                // Full speed again: overrides may add up to a tenth of it.
                self.rig.send([0x90, 0x95]);
                if matches!(self.state, State::Hold(0) | State::Door(0)) {
                    self.rig.send("~");
                    self.keep("~".into());
                }
            }
        }
        let (report, status) = (self.rig.report(), self.rig.machine.status());
        let Self { seed, state, answers, wanted, trail, .. } = self;
        panic!("seed {seed}: {state:?}, {answers} of {wanted} answers, {report}{status:?}\n{trail:?}");
    }

    /// A place inside the travel, in micrometres.
    fn place(&mut self) -> String {
        let (mm, um) = (1 + self.random.below(TRAVEL - 20), self.random.below(1000));
        format!("-{mm}.{um:03}")
    }

    fn speed(&mut self) -> u64 {
        600 + self.random.below(5400)
    }

    fn words(&mut self) -> String {
        let (a, b, f) = (self.place(), self.place(), self.speed());
        match self.random.below(14) {
            0 => format!("G0X{a}Y{b}"),
            1 => format!("G90G2X{a}Y{b}R100F{f}"),
            2 => "M3S500M8".into(),
            3 => "M5M9".into(),
            4 => "G4P0.02".into(),
            5 => "M0".into(),
            // Refused: the motion goes on with the next line.
            6 => ["G77", "G90G1X1", "G2X-1", "$Q", "X", "$J=G2X-1F9", "$$$"][self.random.below(7) as usize]
                .into(),
            7 => "$G".into(),
            _ => format!("G90G1X{a}Y{b}Z-{}F{f}", self.random.below(30)),
        }
    }

    /// What a user does while it runs.
    fn interfere(&mut self) {
        let byte = [b'!', b'~', b'?', 0x91, 0x92, 0x90, 0x96, 0x95, 0x9b, 0x99, 0xa0, 0x84, 0xc2, 0x85];
        match self.random.below(30) {
            0 => {
                self.rig.world.signals = Signals::DOOR;
                self.ticks(300);
                self.rig.world.signals = Signals::default();
            }
            1..=14 => {
                let byte = byte[self.random.below(byte.len() as u64) as usize];
                self.rig.send([byte]);
                self.keep(format!("{byte:#x}"));
            }
            _ => {}
        }
    }

    fn job(&mut self) {
        self.soaked.jobs += 1;
        for _ in 0..1 + self.random.below(25) {
            let words = self.words();
            self.line(&words);
            self.ticks(60);
            self.interfere();
        }
        let [x, y, z] = [(); 3].map(|()| self.place());
        self.line(&format!("G90 G1 X{x} Y{y} Z{z} F6000"));
        self.settle();
        // The end of the job, to the last bit.
        let wanted = [&x, &y, &z].map(|text| exact(text));
        assert_eq!(self.rig.points, wanted, "seed {}", self.seed);
    }

    /// The place is known to the last bit: a way of an eighth of a millimetre leads exactly that far.
    fn place_is_kept(&mut self) {
        let stands = self.rig.points;
        let way = if stands[0] > mm(-30.0) { "-0.125" } else { "0.125" };
        self.line(&format!("G91G1X{way}F3000"));
        self.line("G90");
        self.settle();
        let wanted = [stands[0] + exact(way), stands[1], stands[2]];
        assert_eq!(self.rig.points, wanted, "seed {}", self.seed);
    }

    fn jog(&mut self) {
        self.soaked.jogs += 1;
        for _ in 0..1 + self.random.below(4) {
            let (place, feed) = (self.place(), self.speed());
            self.line(&format!("$J=G53G90X{place}F{feed}"));
            self.ticks(40);
        }
        self.ticks(400);
        let byte = [0x85, b'!', b'?', 0x91][self.random.below(4) as usize];
        if self.state == State::Jog {
            self.rig.send([byte]);
        }
        self.settle();
        self.place_is_kept();
    }

    fn reset(&mut self) {
        self.soaked.resets += 1;
        for _ in 0..1 + self.random.below(5) {
            let words = self.words();
            self.line(&words);
        }
        self.ticks(800);
        if self.random.below(2) == 0 {
            self.rig.send("!");
            self.ticks(200);
        }
        self.rig.send([0x18]);
        // What was not answered is dropped.
        self.tick();
        self.wanted = self.answers;
        self.settle();
        self.place_is_kept();
    }

    fn check_mode(&mut self) {
        let stands = self.rig.points;
        self.line("$C");
        for _ in 0..5 {
            let words = self.words();
            self.line(&words);
        }
        self.settle();
        self.line("$C");
        self.settle();
        assert_eq!(self.rig.points, stands, "seed {}", self.seed);
    }

    /// The switches are where they were, however much was moved before.
    fn home(&mut self) {
        self.soaked.homed += 1;
        self.line("$H");
        self.settle();
        assert_eq!(self.rig.points, [mm(-1.0); AXES], "seed {}", self.seed);
        for axis in 0..AXES {
            let stray = self.rig.world.place(&self.rig.points, axis) - (0.5 - 1.0);
            // A slot's way at 60 mm/min.
            assert!(stray.abs() < 1.0 / 20_000.0 + 1e-8, "seed {}: {stray}", self.seed);
        }
    }

    fn probe(&mut self) {
        self.soaked.probed += 1;
        self.line("G90G1Z-35F6000");
        self.settle();
        // The line is answered behind its place.
        self.line("G38.2Z-50F300");
        self.settle();
        let offsets = self.rig.machine.offsets();
        let place = offsets.probe[2].to_num::<f64>() + self.rig.world.shift[2];
        assert!(
            offsets.probed && (place - PLATE).abs() < 5.0 / 20_000.0 + 1e-8,
            "seed {}: {place}",
            self.seed
        );
        self.place_is_kept();
        self.line("G0Z-35");
        self.settle();
    }
}

/// A decimal as the decoder reads it: the nearest multiple of 2^-32 mm.
fn exact(text: &str) -> Position {
    let (sign, digits) = text.strip_prefix('-').map_or((1, text), |rest| (-1, rest));
    let (whole, part) = digits.split_once('.').unwrap_or((digits, "0"));
    let unit = 10_i128.pow(part.len() as u32);
    let number = |text: &str| text.parse::<i128>().expect("digits");
    let value = (number(whole) * unit + number(part)) << 32;
    Position::from_bits((sign * ((value + unit / 2) / unit)) as i64)
}

//! A machine with axes, switches and a probe: planner, interpolator and protocol as a board has them, on simulated time.
use super::corruption::Random;
use super::{AXES, BUFFER, Sink, names, serial};
use glidepath::channel::Channel;
use glidepath::fir::FilterTick;
use glidepath::machine::{AxisData, AxisKind, ChannelData, MachineData};
use glidepath::quantity::Position;
use glidepath::tick::Interpolator;
use glidepath_controller::machine::{Carried, Latch, Machine, MachineMemory, between, controller_data};
use glidepath_controller::store::{MemoryFlash, Parameters};
use glidepath_controller::{Config, Controller, Look, Receiver, Settings, Signals};
use glidepath_steps::{AxisSteps, Drive, Levels, Motor, StepData, Steps};

pub const BLOCKS: usize = 40;

/// Parts of a tick in which inputs are sampled.
pub const SLOTS: u16 = 20;

pub fn mm(value: f64) -> Position {
    Position::from_num(value)
}

/// Settings of a quick small machine.
pub fn settings() -> Settings<AXES> {
    let mut settings = Settings::new();
    for axis in &mut settings.axes {
        (axis.rate_milli, axis.accel_milli, axis.travel_milli) = (6_000_000, 800_000, 60_000);
        axis.counts_milli = 400_000;
    }
    settings.seek_milli = 1_200_000;
    settings.locate_milli = 60_000;
    settings.debounce_ms = 5;
    settings
}

/// Machine data of these settings.
pub fn data(settings: &Settings<AXES>) -> MachineData<AXES> {
    let axes = names().map(|name| AxisData::new(name, AxisKind::Linear));
    let mut data = MachineData {
        axes,
        channel: ChannelData { slope_profile: 1, look_ahead: BLOCKS as u32, ..ChannelData::new() },
    };
    settings.apply(&mut data);
    controller_data(&data)
}

/// An input that closes at a place, with hysteresis and bounce.
#[derive(Clone, Copy)]
pub struct Switch {
    /// True place at which it closes.
    pub at: f64,
    /// +1: it closes above.
    pub direction: f64,
    pub hysteresis: f64,
    /// Slots for which it bounces.
    pub bounce: u16,
    is_closed: bool,
    left: u16,
    pub broken: bool,
}

impl Switch {
    pub const fn new(at: f64, direction: f64) -> Self {
        Self { at, direction, hysteresis: 0.020, bounce: 0, is_closed: false, left: 0, broken: false }
    }

    /// What a sample shows.
    fn sample(&mut self, position: f64, random: &mut Random) -> bool {
        let beyond = (position - self.at) * self.direction;
        let closes = beyond >= 0.0 || self.is_closed && beyond > -self.hysteresis;
        if closes != self.is_closed {
            (self.is_closed, self.left) = (closes, self.bounce);
            return !self.broken && closes;
        }
        if self.left > 0 {
            self.left -= 1;
            return !self.broken && (random.below(2) == 0) == self.is_closed;
        }
        !self.broken && self.is_closed
    }
}

/// What is around the controller.
pub struct World {
    pub limits: [Option<Switch>; AXES],
    /// The probe touches a plane across this axis.
    pub probe: Option<(usize, Switch)>,
    /// True position minus machine coordinate.
    pub shift: [f64; AXES],
    /// Largest way beyond a limit switch that closed, mm.
    pub beyond: f64,
    pub random: Random,
    /// Signals beside them: door, hold.
    pub signals: Signals,
    /// Largest and least machine coordinates seen.
    pub seen: [(f64, f64); AXES],
    /// Ways of the last tick.
    ways: [f64; AXES],
}

impl World {
    pub fn new(seed: u64) -> Self {
        Self {
            limits: [None; AXES],
            probe: None,
            shift: [0.0; AXES],
            beyond: 0.0,
            random: Random(seed),
            signals: Signals::default(),
            seen: [(f64::MAX, f64::MIN); AXES],
            ways: [0.0; AXES],
        }
    }

    pub fn place(&self, position: &[Position; AXES], axis: usize) -> f64 {
        position[axis].to_num::<f64>() + self.shift[axis]
    }

    fn sample(&mut self, position: &[Position; AXES]) -> Signals {
        let mut signals = self.signals;
        for axis in 0..AXES {
            let place = self.place(position, axis);
            if let Some(switch) = &mut self.limits[axis] {
                if switch.sample(place, &mut self.random) {
                    signals = signals.and(Signals::limit(axis as u8));
                }
                self.beyond = self.beyond.max((place - switch.at) * switch.direction);
            }
        }
        if let Some((axis, mut switch)) = self.probe {
            if switch.sample(self.place(position, axis), &mut self.random) {
                signals = signals.and(Signals::PROBE);
            }
            self.probe = Some((axis, switch));
        }
        signals
    }

    /// A tick from one set point to the next. What the inputs show at its end.
    fn tick(&mut self, from: &[Position; AXES], to: &[Position; AXES], latch: &mut Latch<AXES>) -> Signals {
        let mut from = *from;
        for axis in 0..AXES {
            let way = to[axis].to_num::<f64>() - from[axis].to_num::<f64>();
            // From rest no axis comes as far in a tick.
            let jumps = self.ways[axis] == 0.0 && way.abs() > 1e-4;
            self.ways[axis] = if jumps { 0.0 } else { way };
            if jumps {
                // Other coordinates for the same place.
                self.shift[axis] -= way;
                from[axis] = to[axis];
            }
            let at = to[axis].to_num::<f64>();
            self.seen[axis] = (self.seen[axis].0.min(at), self.seen[axis].1.max(at));
        }
        // Without switches nothing changes inside a tick.
        let slots = if self.limits.iter().all(Option::is_none) && self.probe.is_none() { 0 } else { SLOTS };
        for slot in 1..slots {
            let position = between(&from, to, slot, SLOTS);
            let signals = self.sample(&position);
            latch.edge(signals, &position);
        }
        let signals = self.sample(to);
        latch.look(signals, to);
        signals
    }
}

/// A controller with its machine, and a sender that keeps what it reads.
pub struct Rig<'a> {
    pub machine: Machine<'a, AXES, BLOCKS, AXES>,
    interpolator: Interpolator<'a, AXES, glidepath::fir::Unfiltered, AXES>,
    pub controller: Controller<'static, AXES, BUFFER>,
    receiver: Receiver<'static, BUFFER>,
    pub world: World,
    latch: Latch<AXES>,
    sink: Sink,
    /// Step output, where a test looks at the motors.
    pub motors: Option<Motors>,
    pub store: Parameters<MemoryFlash<8192>, AXES>,
    pub now_ms: u32,
    raw: Signals,
    pub points: [Position; AXES],
    /// What was said at power-up.
    pub banner: String,
}

/// Slots of the step output.
const STEP_SLOTS: usize = 200;

/// Counts per mm.
pub const COUNTS: u32 = 400;

/// The step output, and where it has turned the motors to.
pub struct Motors {
    pub drive: Drive<AXES, STEP_SLOTS>,
    words: [u32; STEP_SLOTS],
    levels: Levels,
    pub counts: [i64; AXES],
}

impl Motors {
    pub fn new(data: &MachineData<AXES>) -> Self {
        let axes = core::array::from_fn(|axis| {
            AxisSteps::new(COUNTS, 1, Motor::new(2 * axis as u8, 2 * axis as u8 + 1))
        });
        let start = [Position::ZERO; AXES];
        let steps = Steps::new(&StepData { slot_ns: 5000, axes }, data, &start).expect("slow enough");
        let levels = Levels::default().behind(steps.rest_word());
        Self { drive: Drive::new(steps, data, start), words: [0; STEP_SLOTS], levels, counts: [0; AXES] }
    }

    fn tick<F: FilterTick<AXES>>(&mut self, interpolator: &mut Interpolator<'_, AXES, F, AXES>) {
        // What the tick before has written goes out.
        for word in self.words {
            let levels = self.levels.behind(word);
            for (axis, count) in self.counts.iter_mut().enumerate() {
                let [step, direction] = [0, 1].map(|pin| 2 * axis as u8 + pin);
                if levels.is_high(step) && !self.levels.is_high(step) {
                    *count += if levels.is_high(direction) { 1 } else { -1 };
                }
            }
            self.levels = levels;
        }
        self.drive.tick(interpolator, &mut self.words);
    }
}

/// A conversation with a machine of these settings, at machine coordinate 0.
pub fn with_rig<R>(settings: &Settings<AXES>, world: World, talk: impl FnOnce(&mut Rig<'_>) -> R) -> R {
    let mut config = Config::new(names());
    (config.settings, config.defaults) = (*settings, *settings);
    with_store(config, MemoryFlash::new(), world, talk)
}

/// The same with what a store holds.
pub fn with_store<R>(
    config: Config<AXES>,
    flash: MemoryFlash<8192>,
    world: World,
    talk: impl FnOnce(&mut Rig<'_>) -> R,
) -> R {
    let mut talk = Some(talk);
    let mut result = None;
    with_successors(config, flash, world, |rig| {
        result = talk.take().map(|talk| talk(rig));
        None
    });
    result.expect("one talk")
}

/// What outlives a machine.
struct Around {
    controller: Controller<'static, AXES, BUFFER>,
    receiver: Receiver<'static, BUFFER>,
    world: World,
    latch: Latch<AXES>,
    store: Parameters<MemoryFlash<8192>, AXES>,
    now_ms: u32,
    points: [Position; AXES],
    banner: String,
}

/// Talks to a machine until `talk` returns no successor. With other machine data a new machine takes over, as
/// on a board.
pub fn with_successors(
    mut config: Config<AXES>,
    flash: MemoryFlash<8192>,
    world: World,
    mut talk: impl FnMut(&mut Rig<'_>) -> Option<Carried<AXES>>,
) {
    let mut store = Parameters::open(flash).expect("large enough");
    let stored = store.load(&mut config);
    let mut data = data(&config.settings);
    let mut channel = Box::new(Channel::<AXES, BLOCKS, AXES>::new());
    let mut memory = Box::new(MachineMemory::new());
    let mut carried = Carried::new([Position::ZERO; AXES], config.settings, stored);
    let (receiver, inbox) = serial().split();
    let mut around = Around {
        controller: Controller::new(inbox, config),
        receiver,
        world,
        latch: Latch::new(3),
        store,
        now_ms: 0,
        points: [Position::ZERO; AXES],
        banner: String::new(),
    };
    loop {
        *channel = Channel::new();
        let parts = memory.split();
        let handles = channel.split(&data, carried.position, parts.0).expect("machine data");
        let (machine, interpolator) = Machine::new(handles, parts, &data, &carried);
        let Around { controller, receiver, world, latch, store, now_ms, points, banner } = around;
        let (sink, motors, raw) = (Sink::default(), None, Signals::default());
        let mut rig = Rig {
            machine,
            interpolator,
            controller,
            receiver,
            world,
            latch,
            sink,
            motors,
            store,
            now_ms,
            raw,
            points,
            banner,
        };
        if rig.now_ms == 0 {
            rig.tick();
            rig.banner = rig.read();
        }
        let next = talk(&mut rig);
        let Rig { controller, receiver, world, latch, store, now_ms, points, banner, .. } = rig;
        around = Around { controller, receiver, world, latch, store, now_ms, points, banner };
        let Some(next) = next else { return };
        data = next.settings.onto(&data, &carried.settings);
        carried = next;
    }
}

impl Rig<'_> {
    /// A tick of a millisecond, with one look of the controller.
    pub fn tick(&mut self) {
        match &mut self.motors {
            Some(motors) => motors.tick(&mut self.interpolator),
            None => _ = self.interpolator.tick(),
        }
        let points = *self.interpolator.set_points();
        let before = core::mem::replace(&mut self.points, points);
        self.raw = self.world.tick(&before, &points, &mut self.latch);
        self.machine.service(&self.latch);
        let signals = self.latch.signals().and(self.world.signals);
        let look = Look { now_ms: self.now_ms, signals, motion: &mut self.machine, store: &mut self.store };
        let Ok(()) = self.controller.poll(look, &mut self.sink);
        self.machine.service(&self.latch);
        self.now_ms += 1;
    }

    /// A tick in which the task does something else: nothing is planned, nothing is answered.
    pub fn late_tick(&mut self) {
        self.interpolator.tick();
        let points = *self.interpolator.set_points();
        let before = core::mem::replace(&mut self.points, points);
        self.raw = self.world.tick(&before, &points, &mut self.latch);
        self.now_ms += 1;
    }

    /// Bytes of text that find room.
    pub fn room(&self) -> usize {
        self.receiver.room()
    }

    pub fn ticks(&mut self, count: u32) {
        for _ in 0..count {
            self.tick();
        }
    }

    pub fn send(&mut self, bytes: impl AsRef<[u8]>) {
        for byte in bytes.as_ref() {
            self.receiver.push(*byte);
        }
    }

    pub fn read(&mut self) -> String {
        String::from_utf8(core::mem::take(&mut self.sink.0)).expect("ASCII")
    }

    /// Sends a line and waits for its answer, at most a simulated minute. Line ends are LF.
    pub fn ask(&mut self, line: &str) -> String {
        self.send(line);
        self.send("\n");
        let mut said = String::new();
        for _ in 0..60_000 {
            self.tick();
            said += &self.read().replace("\r\n", "\n");
            if said.lines().any(|line| line == "ok" || line.starts_with("error:")) {
                return said;
            }
        }
        panic!("no answer to {line}: {said}");
    }

    /// The status report.
    pub fn report(&mut self) -> String {
        self.read();
        self.send("?");
        self.tick();
        self.read()
    }

    pub fn state(&mut self) -> String {
        let report = self.report();
        report.trim_start_matches('<').split('|').next().unwrap_or_default().to_owned()
    }

    /// Ticks until the state is this one, at most a simulated minute.
    pub fn until(&mut self, state: &str) {
        for _ in 0..60_000 {
            if self.state() == state {
                return;
            }
        }
        panic!("never {state}: {}", self.report());
    }

    pub fn at(&self, axis: usize) -> f64 {
        self.points[axis].to_num()
    }
}

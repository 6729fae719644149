//! Runs a program with commands of an operator at given ticks, and checks all properties.
use crate::calls::call;
use crate::cases::random::{Mix, Random, program};
use crate::cases::{Program, machines, set_point};
use crate::check;
use crate::properties::{axis_limits, keeps_limits};
use crate::reference::limits::Machine;
use crate::reference::merge::path_tolerance;
use crate::reference::planner::{Block, blocks};
use crate::reference::profile::Profile;
use crate::trace::Trace;
use glidepath::channel::{Channel, Handles, Progress};
use glidepath::kinematics::Kinematic;
use glidepath::machine::{AxisData, MachineData};
use glidepath::nc::{Text, TextError};
use glidepath::operator::Operator;
use glidepath::quantity::Position;
use glidepath::technology::Output;
use glidepath::tick::State;
use std::cell::Cell;
use std::collections::VecDeque;

/// A command or a disturbance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Act {
    /// Feed hold.
    Hold,
    /// Go on.
    Resume,
    /// Abort.
    Abort,
    /// Feed override, LSB 0.1 %.
    Override(u16),
    /// Reduced speed.
    Reduced(bool),
    /// No program text for this number of ticks.
    Starve(usize),
    /// From now on the text arrives with this number of bytes per tick.
    Slow(usize),
    /// The planner is not called for this number of ticks.
    Stall(usize),
    /// From now on functions that wait are acknowledged this number of ticks after their output.
    Acknowledge(usize),
}

impl Act {
    /// Gives the command.
    pub fn give<const AXES: usize>(self, operator: &Operator<'_, AXES>) {
        match self {
            Self::Hold => operator.feed_hold(),
            Self::Resume => operator.resume(),
            Self::Abort => operator.abort(),
            Self::Override(feed) => operator.set_override(feed),
            Self::Reduced(on) => operator.set_reduced(on),
            Self::Starve(_) | Self::Slow(_) | Self::Stall(_) | Self::Acknowledge(_) => {}
        }
    }

    /// Whether it is a command of the operator, not a disturbance.
    pub fn is_command(self) -> bool {
        !matches!(self, Self::Starve(_) | Self::Slow(_) | Self::Stall(_) | Self::Acknowledge(_))
    }
}

/// A run with commands.
#[derive(Clone, Debug, Default)]
pub struct Operated {
    /// Set points of all ticks, those of rest included.
    pub trace: Trace,
    /// Path distance after each of them.
    pub distances: Vec<i64>,
    /// Ticks at which a hold had stopped the motion.
    pub holds: Vec<usize>,
    /// Whether the rest of the program was dropped.
    pub aborted: bool,
    /// The highest override, at least 1.
    pub over: f64,
    /// Ticks at which late program text was reported.
    pub starved: Vec<usize>,
    /// Ticks at which a late planner was reported.
    pub late: Vec<usize>,
    /// Ticks at which the planner reported a slower motion, so that a stop fits into the queue.
    pub slower: Vec<usize>,
    /// Functions, with the tick after which they were output.
    pub outputs: Vec<(usize, Output)>,
}

/// A program text whose arrival is controlled.
struct Wire<'a> {
    text: &'a [u8],
    /// No text can be read now.
    closed: Cell<bool>,
    /// Number of arrived bytes, and of read bytes.
    arrived: Cell<usize>,
    read: Cell<usize>,
}

impl<'a> Wire<'a> {
    fn new(text: &'a str) -> Self {
        let text = text.as_bytes();
        Self { text, closed: Cell::new(false), arrived: Cell::new(text.len()), read: Cell::new(0) }
    }
}

impl Text for &Wire<'_> {
    fn read(&mut self, _: u16, offset: u32, buffer: &mut [u8]) -> Result<usize, TextError> {
        let arrived = self.arrived.get().min(self.text.len());
        let mut there = self.text.get(offset as usize..arrived).unwrap_or(&[]);
        if self.closed.get() || (there.is_empty() && arrived < self.text.len()) {
            return Err(TextError::NotYet);
        }
        let count = there.read(0, 0, buffer)?;
        self.read.set(self.read.get().max(offset as usize + count));
        Ok(count)
    }
}

/// Highest number of ticks of a run, and of a standstill between two commands.
pub const LONGEST: usize = 1_000_000;
const RESTS: usize = 20_000;

/// Reason to give up a run that may be without a fault.
pub const TOO_LONG: &str = "longer than a run may be";

/// Planner calls between two ticks: enough to keep up without corner curves, or unlimited.
pub const POLLS: [usize; 3] = [12, 40, 1000];

/// Runs `program`; `acts` are commands with the tick before which they are given. The planner is called at
/// most `polls` times between two ticks.
///
/// # Errors
/// The library's refusal, or a motion that does not end.
pub fn operate<const AXES: usize, const BLOCKS: usize>(
    program: &Program,
    machine: &MachineData<AXES>,
    acts: &[(usize, Act)],
    polls: usize,
) -> Result<Operated, String> {
    let start: [Position; AXES] = std::array::from_fn(|k| Position::from_bits(set_point(program.start[k])));
    operate_text::<AXES, BLOCKS>(&program.text(machine), start, machine, acts, polls)
        .map_err(|fault| format!("{}: {fault}", program.name))
}

/// The same of any NC text, from `start` on.
///
/// # Errors
/// The same.
pub fn operate_text<const AXES: usize, const BLOCKS: usize>(
    text: &str,
    start: [Position; AXES],
    machine: &MachineData<AXES>,
    acts: &[(usize, Act)],
    polls: usize,
) -> Result<Operated, String> {
    operate_within::<AXES, BLOCKS>(text, start, machine, (acts, polls), LONGEST)
}

/// The same with a highest number of ticks.
///
/// # Errors
/// The same.
pub fn operate_within<const AXES: usize, const BLOCKS: usize>(
    text: &str,
    start: [Position; AXES],
    machine: &MachineData<AXES>,
    calls: (&[(usize, Act)], usize),
    longest: usize,
) -> Result<Operated, String> {
    operate_transformed::<AXES, BLOCKS>(text, start, machine, &[], calls, longest)
}

/// The same on a machine with these transformations; the first of them is the default.
///
/// # Errors
/// The same.
pub fn operate_transformed<const AXES: usize, const BLOCKS: usize>(
    text: &str,
    start: [Position; AXES],
    machine: &MachineData<AXES>,
    kinematics: &[Kinematic],
    (acts, polls): (&[(usize, Act)], usize),
    longest: usize,
) -> Result<Operated, String> {
    let wire = Wire::new(text);
    let (mut late_until, mut rate, mut stalled_until) = (0, text.len(), 0);
    let (mut answer, mut due) = (None, VecDeque::new());
    let mut channel: Box<Channel<AXES, BLOCKS>> = Box::new(Channel::new());
    let Handles { mut planner, mut interpolator, operator } =
        channel.split(machine, start, &wire).map_err(|e| e.to_string())?;
    planner.transform_with(kinematics, kinematics.first().map_or(0, |first| first.id));
    let over = acts.iter().map(|(_, act)| if let Act::Override(feed) = act { *feed } else { 0 });
    let mut run = Operated {
        trace: Trace::empty(f64::from(machine.channel.cycle_us) * 1e-6, AXES),
        aborted: acts.iter().any(|(_, act)| *act == Act::Abort),
        over: f64::from(over.fold(1000, u16::max)) / 1000.0,
        ..Operated::default()
    };
    let mut acts = acts.iter().peekable();
    let mut held = false;
    let mut rests = 0;
    for tick in 0..longest {
        while let Some((_, act)) = acts.next_if(|(at, _)| *at <= tick) {
            act.give(&operator);
            match act {
                Act::Starve(ticks) => late_until = late_until.max(tick + ticks),
                Act::Slow(bytes) => {
                    rate = *bytes;
                    wire.arrived.set(wire.read.get());
                }
                Act::Stall(ticks) => stalled_until = stalled_until.max(tick + ticks),
                Act::Acknowledge(ticks) => answer = Some(*ticks),
                _ => {}
            }
        }
        while let Some((_, function)) = due.pop_front_if(|(at, _)| *at <= tick) {
            // Behind an abort nothing waits for it.
            let _ = operator.acknowledge(function);
        }
        wire.closed.set(tick < late_until);
        wire.arrived.set(wire.arrived.get().saturating_add(rate));
        let most = if tick < stalled_until { 0 } else { polls };
        let said = |progress| match progress {
            Progress::Starved => run.starved.push(tick),
            other if says(other, "Late") => run.late.push(tick),
            other if says(other, "Slower") => run.slower.push(tick),
            _ => {}
        };
        let done = call(&mut planner, most, said).map_err(|e| format!("tick {tick}: {e:?}"))?;
        let state = interpolator.tick();
        run.trace.push(interpolator.set_points().iter().map(|p| p.to_bits()));
        run.distances.push(interpolator.telemetry().distance.to_bits());
        while let Some(output) = operator.output() {
            run.outputs.push((tick, output));
            if let (true, Some(ticks)) = (output.waits, answer) {
                due.push_back((tick + 1 + ticks, output.function));
            }
        }
        if planner.is_holding() && !held {
            run.holds.push(tick);
        }
        held = planner.is_holding();
        if done && state == State::Idle {
            return Ok(run);
        }
        rests = if state == State::Idle { rests + 1 } else { 0 };
        if rests > RESTS && acts.peek().is_none() {
            return Err(format!("nothing moves at tick {tick}"));
        }
    }
    Err(TOO_LONG.to_owned())
}

/// Whether the planner returns this result, by name, so that most calls need no text.
fn says(progress: Progress, name: &str) -> bool {
    let other = matches!(progress, Progress::Working | Progress::Planned | Progress::Waiting);
    !other && format!("{progress:?}") == name
}

/// Checks such a run: limits at every tick, contour in order, exact end.
///
/// # Errors
/// The first fault.
pub fn judge<const AXES: usize>(
    program: &Program,
    machine: &MachineData<AXES>,
    run: &Operated,
) -> Result<(), String> {
    let mut contour = program.contour(machine);
    check::limits(&run.trace, &axis_limits(machine, &contour))?;
    for feed in contour.elements.iter_mut().filter_map(|element| element.feed.as_mut()) {
        *feed *= run.over;
    }
    let start: Vec<i64> = program.start.iter().map(|&nm| set_point(nm)).collect();
    let v_rapid = machine.axes.iter().map(|a| (f64::from(a.vb_eilgang) * 1e-3).powi(2)).sum::<f64>().sqrt();
    if run.aborted {
        return Ok(());
    }
    check::ends(&run.trace, &start, &program.end_points())?;
    let course = check::path(&run.trace, &contour, path_tolerance(&contour), v_rapid)?;
    keeps_limits(&run.trace, &course, &contour, machine)
}

/// A random program, every second one with NO_OPT=0 where the slope is HSC, a random machine with any slope,
/// any mode of the override and a reduced speed, and random numbers for the operator.
pub fn random_setup(seed: u64) -> (Program, MachineData<3>, Random) {
    let mut machine = machines::arbitrary::<3>(seed);
    machine.channel.slope_profile = (seed % 4) as u8;
    machine.channel.override_weight_prog_feed = (seed / 4 % 3) as u8;
    let mut random = Random::new(seed);
    for axis in &mut machine.axes {
        axis.vb_max_red = (f64::from(axis.vb_max) * random.unit()) as u32;
    }
    let mut program = program(seed, Mix::arbitrary(3, seed));
    program.optimised = (seed / 4).is_multiple_of(2);
    (program, machine, random)
}

/// Whether a block may take more than its highest number of 2^26 ticks. Reduced speed may be any low limit,
/// and an override lowers the speed further. Such a run may end with an error.
pub fn crawls<const AXES: usize>(machine: &MachineData<AXES>, acts: &[(usize, Act)]) -> bool {
    crawls_along(machine, acts, LENGTH)
}

/// Longer than any block of a random program, mm.
const LENGTH: f64 = 1000.0;

/// The same for blocks no longer than `length`, mm.
pub fn crawls_along<const AXES: usize>(
    machine: &MachineData<AXES>,
    acts: &[(usize, Act)],
    length: f64,
) -> bool {
    let slowest = machine.axes.iter().map(|axis| axis.vb_max_red).filter(|v| *v > 0).min();
    let over = acts.iter().fold(1000, |least, (_, act)| match act {
        Act::Override(over) if *over > 0 => least.min(*over),
        _ => least,
    });
    let reduced = acts.iter().any(|(_, act)| *act == Act::Reduced(true));
    // µm/s, and 0.1 %.
    let part = f64::from(over) * f64::from(machine.channel.cycle_us) * 1e-12;
    reduced && slowest.is_some_and(|v| f64::from(v) * part * 2f64.powi(26) < length)
}

/// Overrides and reduced speed at random ticks of a motion with `ticks` ticks, mixed with `others`, in the
/// order of time; at the end 100 %.
pub fn with_overrides(random: &mut Random, ticks: usize, others: Vec<(usize, Act)>) -> Vec<(usize, Act)> {
    let mut acts = others;
    for _ in 0..1 + random.bits() % 8 {
        let tick = (random.unit() * ticks as f64) as usize;
        let act = match random.bits() % 6 {
            0 => Act::Override(1000),
            1 => Act::Override(1000 + (random.unit() * 1000.0) as u16),
            2 => Act::Reduced(random.once_in(2)),
            _ => Act::Override(random.magnitude(20.0, 1200.0) as u16),
        };
        acts.push((tick, act));
        // A knob is turned step by step.
        if let (Act::Override(feed), true) = (act, random.once_in(3)) {
            for step in 1..20 {
                acts.push((tick + 3 * step, Act::Override(feed + 5 * step as u16)));
            }
        }
    }
    let last = acts.iter().map(|(tick, _)| *tick).max().unwrap_or(0).max(ticks);
    acts.push((last + 1, Act::Override(1000)));
    acts.push((last + 1, Act::Reduced(false)));
    acts.sort_by_key(|(tick, _)| *tick);
    acts
}

/// Number of ticks with a stop at the end of each block, by the f64 reference; the program never takes
/// longer. HSC has one ramp time, the longest of an axis.
pub fn longest<const AXES: usize>(program: &Program, machine: &MachineData<AXES>) -> f64 {
    let mut machine = *machine;
    if machine.channel.slope_profile == 3 {
        for axis in &mut machine.axes {
            let ramps = [axis.tr_beschl_zu, axis.tr_beschl_ab, axis.tr_brems_zu, axis.tr_brems_ab];
            let tr = ramps.into_iter().fold(0, u32::max);
            [axis.tr_beschl_zu, axis.tr_beschl_ab, axis.tr_brems_zu, axis.tr_brems_ab] = [tr; 4];
        }
    }
    let machine = &machine;
    let stands = |block: &Block| {
        let limits = &block.limits;
        let law = Profile::fastest(block.length, 0.0, 0.0, limits.v, limits.accelerate(), limits.brake());
        law.map_or(0.0, |law| law.time())
    };
    let contour = program.contour(machine);
    blocks(&contour, &Machine::new(&machine.axes, &machine.channel)).iter().map(stands).sum()
}

/// Whether a run that was given up for [`TOO_LONG`] may take so long. The operator's last command is at the
/// tick `last`.
pub fn is_long<const AXES: usize>(program: &Program, machine: &MachineData<AXES>, last: usize) -> bool {
    longest(program, machine) + last as f64 > LONGEST as f64
}

/// Whether a run may end with that fault: it takes so long, or crawls, by what is expected.
pub fn may_end<const AXES: usize>(
    fault: &str,
    program: &Program,
    machine: &MachineData<AXES>,
    acts: &[(usize, Act)],
) -> bool {
    let last = acts.last().map_or(0, |(tick, _)| *tick);
    fault.ends_with(TOO_LONG) && is_long(program, machine, last)
        || fault.ends_with("Unplannable") && crawls(machine, acts)
}

/// Result of [`crawl`].
#[derive(Clone, Debug, PartialEq)]
pub enum Crawled {
    /// All is well.
    Good,
    /// Without an operator the program takes so long that it was not tried.
    Long,
    /// The first fault.
    Fault(String),
}

/// Ticks of the longest program that is tried, and of the longest crawl.
const TRIED: usize = 20_000;
const CRAWLS: f64 = 300.0;

/// A program of [`random_setup`], slowed down nearly to a standstill a few times, by the override or by the
/// reduced speed, or to one by a hold. Behind each of these it is as fast as before: all together it takes as long as it does alone
/// (a quarter more: spans of HSC entered slower than planned), the time of the crawls, and for each of them `2 · (v/a + ramps)` of the slowest axis, to slow down and to
/// speed up again.
pub fn crawl(seed: u64) -> Crawled {
    let (program, machine, mut random) = random_setup(seed);
    let alone = match operate::<3, 120>(&program, &machine, &[], 1000) {
        Ok(run) if run.distances.len() <= TRIED => run.distances.len(),
        Ok(_) => return Crawled::Long,
        Err(fault) if fault.ends_with(TOO_LONG) => return Crawled::Long,
        Err(fault) => return Crawled::Fault(fault),
    };
    let (mut acts, mut crawled, mut tick) = (Vec::new(), 0, 0);
    let count = 1 + random.bits() as usize % 4;
    for _ in 0..count {
        let ticks = random.magnitude(5.0, CRAWLS) as usize;
        tick += 1 + (random.unit() * alone as f64 / count as f64) as usize;
        if random.once_in(4) {
            acts.extend([(tick, Act::Reduced(true)), (tick + ticks, Act::Reduced(false))]);
        }
        if random.once_in(3) {
            acts.extend([(tick, Act::Hold), (tick + ticks, Act::Resume)]);
        } else {
            let over = random.magnitude(1.0, 20.0) as u16;
            acts.extend([(tick, Act::Override(over)), (tick + ticks, Act::Override(1000))]);
        }
        tick += ticks;
        crawled += ticks;
    }
    acts.sort_by_key(|(tick, _)| *tick);
    let cycle = f64::from(machine.channel.cycle_us) * 1e-6;
    let change = |axis: &AxisData| {
        let a = [axis.a_beschl, axis.a_brems].into_iter().chain(axis.a_stufe).min().unwrap_or(1);
        let ramp = axis.tr_beschl_zu.max(axis.tr_beschl_ab).max(axis.tr_brems_zu).max(axis.tr_brems_ab);
        f64::from(axis.vb_max.max(axis.vb_eilgang)) * 1e-3 / f64::from(a.max(1)) + 2e-6 * f64::from(ramp)
    };
    let change = machine.axes.iter().map(change).fold(0.0, f64::max) / cycle;
    let most = (1.25 * alone as f64) as usize + crawled + count * (2.0 * change) as usize + 100;
    let run = match operate::<3, 120>(&program, &machine, &acts, 1000) {
        Ok(run) => run,
        Err(fault) => return Crawled::Fault(format!("{acts:?}: {fault}, {alone} ticks alone")),
    };
    if let Err(fault) = judge(&program, &machine, &run) {
        return Crawled::Fault(format!("{acts:?}: {fault}"));
    }
    if run.distances.len() > most {
        let ticks = run.distances.len();
        return Crawled::Fault(format!("{acts:?}: {ticks} ticks, {most} expected, {alone} alone"));
    }
    Crawled::Good
}

/// Late text at random ticks of a motion with `ticks` ticks, mixed with `others`, in the order of time.
pub fn with_starvation(random: &mut Random, ticks: usize, others: Vec<(usize, Act)>) -> Vec<(usize, Act)> {
    let mut acts = others;
    for _ in 0..1 + random.bits() % 4 {
        let tick = (random.unit() * ticks as f64) as usize;
        acts.push((tick, Act::Starve(random.magnitude(1.0, 2000.0) as usize)));
    }
    if random.once_in(4) {
        let tick = (random.unit() * ticks as f64) as usize;
        acts.push((tick, Act::Slow(random.magnitude(1.0, 20.0) as usize)));
    }
    acts.sort_by_key(|(tick, _)| *tick);
    acts
}

/// Whether the planner gets no time at some ticks of a seed of [`random_setup`]: with every slope, every mode
/// of the override, and NO_OPT=0.
pub fn is_stalled(seed: u64) -> bool {
    !(seed / 24).is_multiple_of(2)
}

/// Ticks after a command within which no stall begins, because the motion at the end of the queue is not
/// planned anew yet.
const QUIET: usize = 16;

/// Times without planner calls at random ticks of a motion with `ticks` ticks, mixed with `others`, in the
/// order of time.
pub fn with_stalls(random: &mut Random, ticks: usize, others: Vec<(usize, Act)>) -> Vec<(usize, Act)> {
    let mut stalls: Vec<[usize; 2]> = (0..1 + random.bits() % 4)
        .map(|_| [random.unit() * ticks as f64, random.magnitude(1.0, 2000.0)].map(|x| x as usize))
        .collect();
    stalls.sort_unstable();
    let mut acts = others.clone();
    let mut last = 0..0;
    for [mut start, ticks] in stalls {
        start = start.max(last.end);
        for (tick, _) in others.iter().filter(|(_, act)| act.is_command()) {
            // Commands during a time without planner calls act after this time.
            let seen = if last.contains(tick) { last.end } else { *tick };
            if (seen..seen + QUIET).contains(&start) {
                start = seen + QUIET;
            }
        }
        acts.push((start, Act::Stall(ticks)));
        last = start..start + ticks;
    }
    acts.sort_by_key(|(tick, _)| *tick);
    acts
}

/// Holds with their ends at random ticks of a motion with `ticks` ticks; sometimes an abort.
pub fn random_acts(random: &mut Random, ticks: usize) -> Vec<(usize, Act)> {
    let mut acts = Vec::new();
    let mut tick = 0;
    for _ in 0..1 + random.bits() % 6 {
        tick += (random.unit() * ticks as f64 / 2.0) as usize;
        acts.push((tick, Act::Hold));
        // Often before it stands.
        tick += random.magnitude(1.0, 1000.0) as usize;
        acts.push((tick, Act::Resume));
    }
    if random.once_in(4) {
        acts.push((tick + (random.unit() * ticks as f64 / 2.0) as usize, Act::Abort));
    }
    acts
}

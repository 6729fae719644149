//! Runs a case and reports every set point of every tick, and what tick and planner cost.
use crate::stack::Watched;
use crate::{Counter, Report, UNIT, exit, stack};
use core::fmt::Write;
use core::mem::size_of;
use glidepath::channel::{Channel, Error, Planner, Progress};
use glidepath::fir::Filters;
use glidepath::machine::MachineData;
#[cfg(feature = "grbl")]
use glidepath::machine::{ChannelData, Dialect, ForeignChannel};
use glidepath::nc::{Decoder, NcError, Step, Window};
use glidepath::quantity::Position;
use glidepath::tick::Interpolator;
#[cfg(feature = "grbl")]
use hil_cases::{AXES_3_SHORT, PLAIN};
use hil_cases::{
    CASES_BESIDE, Case, Failure, FilterMemory, OVERLAYS, Outcome, SEEDS, TAPS, WINDOW, Watch, beside,
    commanded, run, session,
};

/// Number, sum and largest of something counted.
#[derive(Default)]
struct Cost {
    calls: u32,
    sum: u64,
    max: u32,
}

impl Cost {
    fn add(&mut self, cost: u32) {
        self.calls += 1;
        self.sum += u64::from(cost);
        self.max = self.max.max(cost);
    }
}

/// More than a tick needs of the stack, bytes.
const TICK_STACK: usize = 1024;

/// How deep the stack of each kind of call was.
#[derive(Clone, Copy, Default)]
struct Stacks {
    start: Watched,
    poll: Watched,
    tick: Watched,
}

struct Recorder<'a> {
    counter: &'a Counter,
    report: &'a mut Report,
    stacks: &'a mut Stacks,
    begun: u32,
    start: Cost,
    tick: Cost,
    plan: Cost,
    wait: Cost,
}

impl<'a> Recorder<'a> {
    fn new(counter: &'a Counter, report: &'a mut Report, stacks: &'a mut Stacks) -> Self {
        let (start, tick, plan, wait) = Default::default();
        Self { counter, report, stacks, begun: 0, start, tick, plan, wait }
    }

    /// Reports the costs and the end of a case; whether it ended as it should.
    fn close(self, result: &Result<Outcome, Failure>, decode: Cost) -> bool {
        let Self { report, start, tick, plan, wait, .. } = self;
        let costs = [("start", start), ("tick", tick), ("plan", plan), ("wait", wait), ("decode", decode)];
        for (name, cost) in costs {
            let _ = writeln!(report, "cost {name} calls {} sum {} max {}", cost.calls, cost.sum, cost.max);
        }
        report_end(report, result);
        result.is_ok()
    }
}

impl<const AXES: usize> Watch<AXES> for Recorder<'_> {
    #[inline(always)]
    fn now(&mut self) -> u32 {
        self.counter.now()
    }

    #[inline(always)]
    fn starting(&mut self) {
        self.stacks.start.paint(usize::MAX);
        self.begun = self.counter.now();
    }

    #[inline(always)]
    fn started(&mut self) {
        let cost = self.counter.now().wrapping_sub(self.begun);
        self.start.add(self.counter.net(cost));
        self.stacks.start.look(usize::MAX);
        self.stacks.poll.paint(usize::MAX);
    }

    #[inline(always)]
    fn ticking(&mut self) {
        self.stacks.tick.paint(TICK_STACK);
    }

    #[inline(always)]
    fn rested(&mut self) {
        self.stacks.tick.look(TICK_STACK);
    }

    #[inline(always)]
    fn ended(&mut self) {
        self.stacks.poll.look(usize::MAX);
    }

    fn polled(&mut self, cost: u32, result: &Result<Progress, Error>) {
        let cost = self.counter.net(cost);
        match result {
            Ok(Progress::Waiting) => self.wait.add(cost),
            _ => self.plan.add(cost),
        }
    }

    fn ticked(&mut self, cost: u32, set_points: &[Position; AXES]) {
        self.tick.add(self.counter.net(cost));
        self.report.set_points(set_points);
    }
}

/// Runs all cases and ends; whether all of them ended as they should is the exit code.
pub fn record_all<const AXES: usize, const BLOCKS: usize>(
    channel: &mut Channel<AXES, BLOCKS>,
    machine: &MachineData<AXES>,
    cases: &[Case],
) -> ! {
    let mut report = Report::open();
    let counter = Counter::start();
    let _ = writeln!(report, "unit {UNIT}");
    let mut stacks = Stacks::default();
    let mut good = true;
    for case in cases {
        good &= record(channel, machine, case, &counter, &mut report, &mut stacks);
    }
    let [start, poll, tick] = [stacks.start, stacks.poll, stacks.tick].map(|stack| stack.deepest);
    let _ = writeln!(report, "stacks axes {AXES} blocks {BLOCKS} start {start} poll {poll} tick {tick}");
    report_memory::<AXES, BLOCKS>(&mut report);
    report.flush();
    exit(good)
}

/// Runs the session twice, with its text in memory and over a line, and ends.
pub fn record_sessions<const AXES: usize, const BLOCKS: usize>(
    channel: &mut Channel<AXES, BLOCKS>,
    line: &mut Window<WINDOW>,
    machine: &MachineData<AXES>,
) -> ! {
    let mut report = Report::open();
    let counter = Counter::start();
    let _ = writeln!(report, "unit {UNIT}");
    let mut good = true;
    let mut stacks = Stacks::default();
    for (name, window) in [("session", None), ("session_line", Some(line))] {
        let _ = writeln!(report, "case {name} axes {AXES} blocks {BLOCKS}");
        let mut recorder = Recorder::new(&counter, &mut report, &mut stacks);
        let result = session(channel, machine, window, &mut recorder);
        good &= recorder.close(&result, Cost::default());
    }
    report.flush();
    exit(good)
}

/// Runs the cases with commands all the time, and ends.
pub fn record_commanded<const AXES: usize, const BLOCKS: usize>(
    channel: &mut Channel<AXES, BLOCKS>,
    machine: &MachineData<AXES>,
    cases: &[Case],
) -> ! {
    let mut report = Report::open();
    let counter = Counter::start();
    let _ = writeln!(report, "unit {UNIT}");
    let mut good = true;
    let mut stacks = Stacks::default();
    for (case, seed) in cases.iter().flat_map(|case| (0..=SEEDS).map(move |seed| (case, seed))) {
        let _ = writeln!(report, "case {} axes {AXES} blocks {BLOCKS}", case.name);
        let mut recorder = Recorder::new(&counter, &mut report, &mut stacks);
        let result = commanded(channel, machine, case, seed, &mut recorder);
        good &= recorder.close(&result, Cost::default());
    }
    report.flush();
    exit(good)
}

/// Runs the cases with filters and overlays, and ends.
pub fn record_beside<const BLOCKS: usize>(
    channel: &mut Channel<3, BLOCKS, OVERLAYS>,
    filters: &mut FilterMemory,
) -> ! {
    let mut report = Report::open();
    let counter = Counter::start();
    let _ = writeln!(report, "unit {UNIT}");
    let mut good = true;
    let mut stacks = Stacks::default();
    for case in &CASES_BESIDE {
        let _ = writeln!(report, "case {} axes 3 blocks {BLOCKS}", case.name);
        let mut recorder = Recorder::new(&counter, &mut report, &mut stacks);
        let result = beside(channel, filters, case, &mut recorder);
        good &= recorder.close(&result, Cost::default());
    }
    let taps = (size_of::<FilterMemory>() - size_of::<Filters<3, 0>>()) / (3 * TAPS);
    let one = size_of::<Channel<3, BLOCKS, 1>>() - size_of::<Channel<3, BLOCKS, 0>>();
    let _ = writeln!(report, "beside tap {taps} overlay {one}");
    report.flush();
    exit(good)
}

/// The ring with and without a log, and the laser; whether set points and outputs are those of the host is the exit code.
#[cfg(feature = "plc")]
pub fn record_plc(channel: &mut Channel<3, { hil_cases::BLOCKS }>, memory: &mut hil_cases::PlcMemory) -> ! {
    let mut report = Report::open();
    let counter = Counter::start();
    let _ = writeln!(report, "unit {UNIT}");
    let (mut good, mut stacks) = (true, Stacks::default());
    for (name, logs) in [("ring", false), ("ring_logged", true)] {
        let _ = writeln!(report, "case {name} axes 3 blocks {}", hil_cases::BLOCKS);
        let mut recorder = Recorder::new(&counter, &mut report, &mut stacks);
        let result = hil_cases::ring(channel, memory, logs, &mut recorder);
        good &= recorder.close(&result, Cost::default());
        good &= result.is_ok_and(|outcome| outcome.digest.value() == hil_cases::RING_DIGEST);
    }
    let _ = writeln!(report, "case laser axes 3 blocks {}", hil_cases::BLOCKS);
    let mut recorder = Recorder::new(&counter, &mut report, &mut stacks);
    let (mut wanted, mut same) = (hil_cases::LASER_POWER.iter(), true);
    let result = hil_cases::laser(channel, memory, &mut recorder, |tick, percent| {
        same &= wanted.next() == Some(&(tick, percent));
    });
    good &= recorder.close(&result, Cost::default()) && same && wanted.next().is_none();
    let _ = writeln!(report, "laser {}", if same { "same" } else { "differs" });
    report.flush();
    exit(good)
}

/// The case with a transformation.
#[cfg(feature = "five")]
pub fn record_five<const BLOCKS: usize>(channel: &mut Channel<5, BLOCKS>) -> ! {
    let mut report = Report::open();
    let counter = Counter::start();
    let _ = writeln!(report, "unit {UNIT}");
    let mut stacks = Stacks::default();
    let _ = writeln!(report, "case {} axes 5 blocks {BLOCKS}", hil_cases::FIVE);
    let mut recorder = Recorder::new(&counter, &mut report, &mut stacks);
    let result = hil_cases::five(channel, &mut recorder);
    let good = recorder.close(&result, Cost::default());
    report_memory::<5, BLOCKS>(&mut report);
    report.flush();
    exit(good)
}

/// Decodes the plain program in each dialect of the build, and ends. A dialect that the build does not have has
/// no line of costs.
#[cfg(feature = "grbl")]
pub fn record_decoder<const BLOCKS: usize>(channel: &mut Channel<3, BLOCKS>) -> ! {
    let mut report = Report::open();
    let counter = Counter::start();
    let mut good = true;
    for &dialect in Dialect::ALL {
        let foreign = ForeignChannel { dialect, ..AXES_3_SHORT.channel.foreign };
        let machine =
            MachineData { channel: ChannelData { foreign, ..AXES_3_SHORT.channel }, ..AXES_3_SHORT };
        if channel.split(&machine, [Position::ZERO; 3], PLAIN).is_err() {
            continue;
        }
        let (Cost { calls, sum, max }, is_whole) = decode(channel, &machine, PLAIN, &counter);
        good &= is_whole;
        let name = dialect.name();
        let _ = writeln!(report, "dialect {name} calls {calls} sum {sum} max {max}");
    }
    let channel = size_of::<Channel<3, BLOCKS>>();
    let _ = writeln!(report, "channel axes 3 blocks {BLOCKS} bytes {channel}");
    report.flush();
    exit(good)
}

fn report_end(report: &mut Report, result: &Result<Outcome, Failure>) {
    let _ = match result {
        Ok(o) => writeln!(
            report,
            "end ticks {} starved {} blocks {} digest {:016x}",
            o.ticks,
            o.starved,
            o.blocks,
            o.digest.value()
        ),
        Err(failure) => writeln!(report, "failed {failure:?}"),
    };
    report.flush();
}

/// What RAM this configuration needs: its channel, and the stack at its deepest.
pub fn report_memory<const AXES: usize, const BLOCKS: usize>(report: &mut Report) {
    let (stack, depth) = stack::depth();
    let _ = writeln!(
        report,
        "memory axes {AXES} blocks {BLOCKS} channel {} planner {} interpolator {} statics {} stack {stack} depth {depth}",
        size_of::<Channel<AXES, BLOCKS>>(),
        size_of::<Planner<'static, &'static [u8], AXES, BLOCKS>>(),
        size_of::<Interpolator<'static, AXES>>(),
        stack::statics(),
    );
}

/// Runs a case; whether it ended as it should.
fn record<const AXES: usize, const BLOCKS: usize>(
    channel: &mut Channel<AXES, BLOCKS>,
    machine: &MachineData<AXES>,
    case: &Case,
    counter: &Counter,
    report: &mut Report,
    stacks: &mut Stacks,
) -> bool {
    let _ = writeln!(report, "case {} axes {AXES} blocks {BLOCKS}", case.name);
    let mut recorder = Recorder::new(counter, report, stacks);
    let result = run(channel, machine, case.text, &mut recorder);
    recorder.close(&result, decode(channel, machine, case.text, counter).0)
}

/// The decoder alone, to tell its share of the planner's work; and whether it reached the end.
fn decode<const AXES: usize, const BLOCKS: usize>(
    channel: &mut Channel<AXES, BLOCKS>,
    machine: &MachineData<AXES>,
    text: &'static [u8],
    counter: &Counter,
) -> (Cost, bool) {
    let mut decoder = channel.decode(machine, [Position::ZERO; AXES], text);
    let mut cost = Cost::default();
    loop {
        let before = counter.now();
        let step = step(&mut decoder);
        cost.add(counter.net(counter.now().wrapping_sub(before)));
        if matches!(step, Ok(Step::End) | Err(_)) {
            return (cost, step.is_ok());
        }
    }
}

#[inline(never)]
fn step<const AXES: usize>(decoder: &mut Decoder<'_, &'static [u8], AXES>) -> Result<Step<AXES>, NcError> {
    decoder.step()
}

//! The board: memory, clock and main loop.
use crate::acknowledge::{Automatic, Delay};
use crate::beside::Beside;
use crate::clock::clock;
use crate::deviation::{CHORDS, Deviation};
use crate::diagnose::Diagnostic;
use crate::driven::Driven;
use crate::events::{Event, Schedule, Script, What, function_name};
use crate::files::{Delayed, Files};
use crate::filtered::Filtered;
use crate::machine::{Machine, with_axes};
use crate::monitor::Monitor;
use crate::output;
use crate::plc::{self, Plc};
use crate::plot::Picture;
use crate::program::{self, Program};
use crate::report::Tape;
use crate::statistics::{Pause, Statistics};
use crate::trace::{Extract, Trace};
use crate::usage::Usage;
use crate::vcd::Vcd;
use glidepath::channel::{Channel, Error, FilteredHandles, Planner, Progress};
use glidepath::fir::{Bank, Filters};
use glidepath::kinematics::{Chain, Kinematic};
use glidepath::operator::Operator;
use glidepath::quantity::{Accel, Position, Speed};
use glidepath::queue::Function;
use glidepath::tick::{State, Telemetry};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::cell::Cell;
use std::io::{self, Write};
use std::path::Path;
use std::time::{Duration, Instant};

/// The largest look-ahead of this build, blocks.
pub const BLOCKS: usize = 500;

/// Number of samples in the filter of an axis: the highest order is 200.
pub const TAPS: usize = 202;

/// Number of elements and entries that a PLC may read.
pub const KEPT: usize = 1 << 12;

/// Number of axes that may move independently of the path at once.
pub const OVERLAYS: usize = 6;

/// Outputs of a run, and events during the run.
#[derive(Default)]
pub struct Wanted<'a> {
    /// Receives a row per tick.
    pub trace: Option<(&'a Path, Box<dyn Write>)>,
    /// Selection of the rows.
    pub extract: Extract,
    /// Receives the words of the step output, with this number of slots per tick.
    pub vcd: Option<(&'a Path, Box<dyn Write>, usize)>,
    /// A [`Picture`] is recorded.
    pub picture: bool,
    /// A [`Tape`] is recorded, in [`Statistics::tape`].
    pub report: bool,
    /// Events from outside.
    pub script: Option<&'a Script>,
    /// Functions that no event acknowledges.
    pub acknowledge: Delay,
    /// Requests of a PLC.
    pub plc: Option<&'a plc::Script>,
    /// Whether no progress is shown.
    pub quiet: bool,
}

/// Runs the program to its end.
///
/// # Errors
/// Program or machine data are refused, the trace file cannot be written, or the motion stands still for
/// ever.
pub fn simulate(
    files: &Files,
    machine: &Machine,
    program: &Program,
    wanted: Wanted<'_>,
) -> Result<(Statistics, Option<Picture>), Vec<Diagnostic>> {
    with_axes!(machine, simulate_axes(files, machine, program, wanted))
}

fn simulate_axes<const AXES: usize>(
    files: &Files,
    machine: &Machine,
    program: &Program,
    wanted: Wanted<'_>,
) -> Result<(Statistics, Option<Picture>), Vec<Diagnostic>> {
    let data = machine.data::<AXES>().ok_or_else(|| vec![Diagnostic::error("wrong number of axes")])?;
    let start = [Position::ZERO; AXES];
    let late = Cell::new(false);
    // On a controller the memory is static; here it is too large for some stacks.
    let mut channel = Box::new(Channel::<AXES, BLOCKS, OVERLAYS>::new());
    let mut filters = Box::new(Filters::<AXES, TAPS>::new());
    let mut outside = plc::Memory::<AXES>::new(machine, wanted.plc);
    let mut handles = channel
        .split_filtered(&mut filters, &data, start, Delayed { files, late: &late })
        .map_err(|error| vec![Diagnostic::error(format!("{}: {error}", machine.name))])?;

    let (contour, outside) = outside.give(&mut handles.planner, plc::Wants::of(files, wanted.plc));
    let plc = wanted.plc.map(|script| Plc::new(script, (contour, outside), machine.channel.cycle_us));
    let writer = plc::Writer::new(outside, wanted.plc, machine.channel.cycle_us);
    let kinematics = machine.kinematics.fitted(&data);
    handles.planner.transform_with(&kinematics, machine.kinematics.default_id);
    if let Some(smooth) = machine.smooth {
        handles.planner.begin_with(smooth.command());
    }
    let trace_path = wanted.trace.as_ref().map_or(Path::new(""), |(path, _)| path).to_path_buf();
    let unwritable = |error: io::Error| output::refused(&trace_path, error);
    let trace = match wanted.trace {
        Some(file) => {
            let trace = Trace::new(file, machine, &wanted.extract)?;
            Some(trace.map_err(unwritable)?)
        }
        None => None,
    };
    let vcd_path = wanted.vcd.as_ref().map_or(Path::new(""), |(path, ..)| path).to_path_buf();
    let vcd = match wanted.vcd {
        Some((path, file, slots)) => {
            let vcd = Vcd::new((file, slots), machine, &start).map_err(|error| vec![*error])?;
            Some(vcd.map_err(|error| output::refused(path, error))?)
        }
        None => None,
    };
    let events = wanted.script.map_or(&[][..], |script| &script.events);
    let mut statistics = Statistics::new(&start, events.len());
    statistics.monitor = Monitor::new(machine, program);
    statistics.deviation = (!wanted.quiet).then(|| Deviation::new(machine, program));
    statistics.filtered = Filtered::new(machine);
    statistics.beside = Beside::new(machine);
    statistics.usage = Usage::new(machine, program);
    let recorder = Recorder {
        tool: None,
        leans: None,
        chain: machine.kinematics.usual().copied(),
        statistics,
        driven: Driven::new(machine, &start),
        trace,
        vcd,
        picture: wanted.picture.then(|| {
            let (shown, moving) = (program.shown_axes(machine), program.moving_axes(machine));
            let rapid = program.motions().map(|segment| segment.feed.is_none()).collect();
            let transformed = !program.transformed.is_empty();
            Picture::new(machine, shown, moving, (program.axes_beside(), rapid), transformed)
        }),
        tape: wanted.report.then(|| Tape::new(machine)),
        cycle_s: machine.cycle_s(),
        has_events: !events.is_empty(),
        seen: 0,
    };
    let schedule = Schedule::new(events, machine.channel.cycle_us);
    let patience = PATIENCE + (program.dwell_s() / machine.cycle_s()).ceil() as u64;
    let bar = Bar::new(program.motions, wanted.quiet);
    let automatic = Automatic::new(wanted.acknowledge, machine.channel.cycle_us);
    let rules = Rules { schedule, automatic, patience, late: &late, program, writer, plc };
    let result = drive(handles, recorder, rules, (bar, &kinematics)).map_err(|stop| match stop {
        Stop::Refused(error) => vec![program::refusal(files, &error)],
        Stop::Unwritable(error) => unwritable(error),
        Stop::UnwritableSteps(error) => output::refused(&vcd_path, error),
        Stop::Starved => vec![Diagnostic::error(
            "internal error: the planner waits for the interpolator, which has nothing to do; please report it",
        )],
        Stop::Unanswered { since, function, early } => {
            let (at, name) = (since as f64 * machine.cycle_s(), function_name(function));
            let message = format!(
                "the motion waits for the acknowledgement of {name} from {at:.3} s on, and no later event gives it"
            );
            let expected = format!("a later line `{at:.3} ack {name}` or abort in --events, or --ack SECONDS");
            let mut told = vec![Diagnostic::error(message).expected(expected)];
            if let Some((script, event)) = wanted.script.zip(early) {
                let message = format!("this acknowledgement came before {name} was put out, or a second time");
                told.push(script.at(&event, Diagnostic::warning(message)));
            }
            told
        }
        Stop::Held { since, cause } => {
            let at = since as f64 * machine.cycle_s();
            let clock = clock(at);
            let message =
                format!("the motion stands still from {at:.3} s{clock} on and no later event lets it go on");
            let diagnostic = Diagnostic::error(message);
            vec![match wanted.script.zip(cause) {
                Some((script, event)) => {
                    let way_out = if event.what == What::FeedHold { "resume" } else { "override above 0" };
                    let expected = format!("expected a later {way_out} or abort");
                    script.at(&event, diagnostic).expected(expected)
                }
                None => diagnostic,
            }]
        }
    })?;
    match program.passes {
        Some(passes) if passes != outside.switch.passes() => {
            let message =
                "internal error: the loops of the run are not those of the program; please report it";
            Err(vec![Diagnostic::error(message)])
        }
        _ => Ok(result),
    }
}

/// Positions of the axes of a channel in the order of a chain.
fn widened(axes: &[Position]) -> [Position; 6] {
    std::array::from_fn(|k| axes.get(k).copied().unwrap_or(Position::ZERO))
}

/// Number of idle ticks after which the simulation stops with an error.
const PATIENCE: u64 = 1000;

enum Stop {
    /// A refused line. The check reports the others too.
    Refused(Error),
    Unwritable(io::Error),
    /// The dump of the step output.
    UnwritableSteps(io::Error),
    Starved,
    /// Standstill from this tick on, by this event.
    Held {
        since: u64,
        cause: Option<Event>,
    },
    /// Standstill from this tick on, for this function.
    Unanswered {
        since: u64,
        function: Function,
        /// An event that acknowledged the function without effect.
        early: Option<Event>,
    },
}

/// State outside the program.
struct Rules<'a> {
    schedule: Schedule<'a>,
    automatic: Automatic,
    /// The longest standstill, in ticks, that the program itself may contain.
    patience: u64,
    /// The program text is late.
    late: &'a Cell<bool>,
    /// The decoded program, which tells where the transformation changes.
    program: &'a Program,
    writer: plc::Writer<'a>,
    plc: Option<Plc<'a>>,
}

/// A controller has a timer interrupt and a main loop. Here the main loop gets unlimited time, then time
/// advances by one tick. So program text and planner are never late, unless an event makes them late, and the
/// set points are those of any controller that is fast enough.
///
/// If the motion stands still because of an event, or waits for an acknowledgement, time continues: the set
/// points stay the same, tick by tick.
fn drive<const AXES: usize>(
    handles: FilteredHandles<'_, Delayed<'_>, AXES, BLOCKS, TAPS, OVERLAYS>,
    mut recorder: Recorder,
    rules: Rules<'_>,
    (mut bar, kinematics): (Bar, &[Kinematic]),
) -> Result<(Statistics, Option<Picture>), Stop> {
    let Rules { mut schedule, mut automatic, patience, late: text_is_late, program, mut writer, mut plc } =
        rules;
    let FilteredHandles { mut planner, mut interpolator, operator } = handles;
    let mut done = false;
    let mut idle = 0;
    loop {
        let tick = recorder.statistics.ticks;
        while let Some((index, what, taken)) = schedule.due(tick, &operator) {
            recorder.statistics.happens(index, what, taken);
        }
        while let Some(function) = automatic.due(tick, &operator) {
            recorder.statistics.acknowledged(function);
        }
        writer.before(tick);
        let (starved, stalled) = (schedule.is_starved(tick), schedule.is_stalled(tick));
        let late = starved || stalled;
        text_is_late.set(starved);
        if !starved {
            recorder.statistics.has_text();
        }
        if !stalled {
            recorder.statistics.catches_up();
        }
        // Also after all motion is queued, because a command may change the queue.
        done &= stalled;
        while !done && !stalled {
            let progress = planner.poll().map_err(Stop::Refused)?;
            writer.behind();
            recorder.curves(&planner, program, kinematics);
            recorder.statistics.monitor.beside(recorder.statistics.ticks, planner.beside());
            match progress {
                Progress::Working => {}
                // The decoder pass has already collected the other refusals.
                Progress::Warning(warning) if warning.kind.is_of_curve() => {
                    recorder.statistics.remark(warning);
                }
                Progress::Warning(_) => {}
                Progress::Planned => {
                    let planned = planner.planned();
                    bar.at(u64::from(planned.block) + u64::from(planned.blocks));
                    recorder.statistics.spans.push(planned);
                }
                Progress::Replanned => {
                    if let Some(last) = recorder.statistics.spans.last_mut() {
                        *last = planner.planned();
                    }
                }
                // The list of events contains the late times.
                Progress::Starved | Progress::Late => {}
                Progress::Slower => recorder.statistics.slower = true,
                Progress::Deviated(axis) => recorder.statistics.filtered.beyond(axis),
                Progress::Waiting => break,
                Progress::Done => done = true,
            }
        }
        if let Some(plc) = &mut plc {
            plc.act(tick, &mut planner, &operator);
        }
        let commands = operator.commands();
        let held = commands.hold || commands.feed == 0;
        let waiting = planner.is_waiting();
        let state = interpolator.tick();
        let mut telemetry = interpolator.telemetry();
        if state == State::Idle {
            if done {
                break;
            }
            if !late && !held && !waiting {
                idle += 1;
                if idle > PATIENCE {
                    return Err(Stop::Starved);
                }
                // Functions before the first motion.
                put_out(&operator, &mut recorder, &mut automatic, &schedule);
                continue;
            }
        }
        if state != State::Active {
            (telemetry.speed, telemetry.accel) = (Speed::ZERO, Accel::ZERO);
        }
        idle = 0;
        let pause = match (held || late, waiting) {
            (true, _) => Pause::Held,
            (false, true) => Pause::Waiting,
            _ => Pause::None,
        };
        let (path, drives) = (interpolator.path_points(), interpolator.set_points());
        recorder.statistics.filtered.add(
            (path, drives),
            &planner.filter_deviation(),
            planner.filter_in_force(),
        );
        let (row, beside) = (recorder.statistics.ticks, planner.beside());
        recorder.statistics.beside.add(row, path, beside, commands.hold || commands.abort);
        recorder.statistics.monitor.beside(row, beside);
        let slope = interpolator.path_slope();
        // Under a transformation the path is that of the tip, and its distance is the driven distance.
        let tip = tip_of(kinematics, program.transformation(telemetry.block), path);
        let along = slope.as_ref().map(|slope| &slope[..]).filter(|_| tip.is_none());
        let telemetry = recorder.driven.tick(&telemetry, path, along);
        recorder.tool = tip.map(|tip| tip.to_vec());
        let set = kinematics.iter().find(|set| set.id == program.transformation(telemetry.block));
        recorder.leans = set.map(|set| set.direction(path).to_vec());
        recorder.tick(&telemetry, [path, drives], slope.is_some(), pause)?;
        put_out(&operator, &mut recorder, &mut automatic, &schedule);
        if waiting
            && state == State::Idle
            && let Some(function) = operator.awaited()
            && !automatic.answers(function)
            && !schedule.answers(function)
        {
            let since = recorder.statistics.ticks.saturating_sub(1 + recorder.statistics.rest);
            let early = schedule.in_vain(function, &recorder.statistics.outcomes).cloned();
            return Err(Stop::Unanswered { since, function, early });
        }
        let rest = recorder.statistics.rest_of_all();
        let enough = if state == State::Idle { !late } else { rest > patience };
        if held && rest > 0 && enough && !schedule.goes_on(&commands) {
            let since = recorder.statistics.ticks.saturating_sub(1 + rest);
            return Err(Stop::Held { since, cause: schedule.cause(&commands).cloned() });
        }
    }
    bar.finish();
    if let Some(plc) = &mut plc {
        plc.end(recorder.statistics.ticks, &mut planner, &operator);
    }
    recorder.statistics.plc = plc.map(|plc| plc.finish(recorder.statistics.ticks));
    recorder.statistics.split = planner.split();
    recorder.finish(interpolator.set_points())
}

/// Passes due functions to the statistics and to the acknowledgement.
fn put_out<const AXES: usize>(
    operator: &Operator<'_, AXES>,
    recorder: &mut Recorder,
    automatic: &mut Automatic,
    schedule: &Schedule<'_>,
) {
    while let Some(output) = operator.output() {
        recorder.statistics.output(output);
        if output.waits && !schedule.acknowledges(output.function) {
            automatic.answer(output.function, recorder.statistics.ticks);
        }
    }
}

/// Tip and angles for the positions of the axes, under this transformation.
fn tip_of<const AXES: usize>(
    kinematics: &[Kinematic],
    id: u16,
    axes: &[Position; AXES],
) -> Option<[Position; AXES]> {
    kinematics.iter().find(|set| set.id == id).and_then(|set| set.workpiece(axes))
}

/// All consumers of the set points.
struct Recorder {
    /// Under a transformation: tip and angles for the positions of the axes.
    tool: Option<Vec<Position>>,
    /// Under a transformation: the direction from tip to holder, by axis of the channel.
    leans: Option<Vec<f64>>,
    /// Where the tool is, in every row of the trace.
    chain: Option<Chain>,
    statistics: Statistics,
    driven: Driven,
    trace: Option<Trace>,
    vcd: Option<Vcd>,
    picture: Option<Picture>,
    tape: Option<Tape>,
    cycle_s: f64,
    /// Whether driven speeds may differ from planned speeds.
    has_events: bool,
    /// Number of examined curves.
    seen: u32,
}

impl Recorder {
    /// The curves since the last call. Some curves may have been taken back.
    fn curves<const AXES: usize>(
        &mut self,
        planner: &Planner<'_, Delayed<'_>, AXES, BLOCKS, Bank<'_, AXES, TAPS>, OVERLAYS>,
        program: &Program,
        kinematics: &[Kinematic],
    ) {
        let Some(deviation) = &mut self.statistics.deviation else { return };
        let all = planner.curves();
        self.seen = if (all.wrapping_sub(self.seen) as i32) < 0 { all } else { self.seen };
        while self.seen != all {
            let curve = self.seen;
            let exact = |part: u32| {
                let (block, point) = planner.point(curve, part)?;
                let point = tip_of(kinematics, program.transformation(block), &point).unwrap_or(point);
                Some(point.iter().map(|value| value.to_num()).collect::<Vec<f64>>())
            };
            let block = planner.point(curve, 0).map_or(0, |(block, _)| block);
            let points: Vec<Vec<f64>> = (0..=CHORDS).filter_map(|i| exact((i << 16) / CHORDS)).collect();
            deviation.curve(block, &points, &exact);
            self.seen = self.seen.wrapping_add(1);
        }
    }

    /// Records a row with its set points before and after the filters, whether it is on a curve that is no
    /// arc, and the possible reason of a standstill.
    fn tick(
        &mut self,
        telemetry: &Telemetry,
        [set_points, drives]: [&[Position]; 2],
        curve: bool,
        pause: Pause,
    ) -> Result<(), Stop> {
        self.statistics.digest.add(drives);
        self.statistics.add(telemetry, set_points, curve, pause);
        self.statistics.usage.add(telemetry, pause);
        let statistics = &self.statistics;
        if let Some(picture) = &mut self.picture {
            let off = statistics.filtered.off();
            picture.add(
                telemetry,
                self.tool.as_deref().unwrap_or(set_points),
                (&statistics.axes, &off),
                (self.cycle_s, self.leans.as_deref()),
            );
        }
        if let Some(tape) = &mut self.tape {
            let shown = self.tool.as_deref();
            tape.add(telemetry, [shown.unwrap_or(set_points), shown.unwrap_or(drives)], statistics);
        }
        if let Some(vcd) = &mut self.vcd {
            vcd.tick(drives).map_err(Stop::UnwritableSteps)?;
        }
        if let Some(trace) = &mut self.trace {
            let points = [set_points, drives];
            let tip = self.chain.as_ref().map(|chain| chain.forward(&widened(set_points)).0);
            trace
                .row(statistics.ticks - 1, telemetry, statistics.distance, points, tip)
                .map_err(Stop::Unwritable)?;
        }
        Ok(())
    }

    fn finish(mut self, set_points: &[Position]) -> Result<(Statistics, Option<Picture>), Stop> {
        if self.statistics.ticks == 0 {
            // No axis moved: the standstill gets a row.
            self.tick(&Telemetry::default(), [set_points; 2], false, Pause::None)?;
        }
        self.statistics.finish(set_points);
        self.statistics.over_time = self.driven.differs;
        self.statistics.tape = self.tape;
        if let Some(deviation) = &mut self.statistics.deviation {
            deviation.finish();
        }
        if !self.has_events {
            let ends = self.statistics.ends();
            self.statistics.course.refine(&ends);
        }
        if let Some(trace) = self.trace {
            trace.finish().map_err(Stop::Unwritable)?;
        }
        if let Some(vcd) = self.vcd {
            vcd.finish().map_err(Stop::UnwritableSteps)?;
        }
        Ok((self.statistics, self.picture))
    }
}

/// Progress in motion blocks on the error output: only on a terminal, and only in long runs.
struct Bar {
    start: Instant,
    motions: usize,
    shown: Option<ProgressBar>,
    quiet: bool,
    /// The highest position so far, because blocks may be planned again.
    reached: u64,
}

/// Estimated seconds left; `None` while nothing is done.
fn to_go(elapsed: Duration, done: u64, all: u64) -> Option<u64> {
    let left = all.saturating_sub(done) as f64;
    (done > 0).then(|| (elapsed.as_secs_f64() * left / done as f64).ceil() as u64)
}

impl Bar {
    fn new(motions: usize, quiet: bool) -> Self {
        Self { start: Instant::now(), motions, shown: None, quiet, reached: 0 }
    }

    fn at(&mut self, block: u64) {
        self.reached = self.reached.max(block);
        let block = self.reached;
        let elapsed = self.start.elapsed();
        match &self.shown {
            Some(bar) => {
                bar.set_position(block);
                if let Some(seconds) = to_go(elapsed, block, self.motions as u64) {
                    bar.set_message(format!("{seconds} s{} to go", clock(seconds as f64)));
                }
            }
            None if !self.quiet && elapsed > Duration::from_secs(1) => {
                let bar = ProgressBar::with_draw_target(
                    Some(self.motions as u64),
                    ProgressDrawTarget::stderr_with_hz(10),
                );
                let style = ProgressStyle::with_template("{bar:40.cyan} {pos}/{len} blocks, {msg}");
                bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
                bar.set_position(block);
                self.shown = Some(bar);
            }
            None => {}
        }
    }

    fn finish(self) {
        if let Some(bar) = self.shown {
            bar.finish_and_clear();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::program::decode;

    /// Runs one program and judges it by the weights of another one: N number and order of what is beyond.
    fn judged(driven: &str, by: &str) -> Vec<(u32, usize)> {
        let machine = Machine::built_in();
        let [driven, by] = [driven, by].map(Files::of_text);
        let program = decode(&by, &machine, 100).unwrap_or_else(|_| panic!("it is a program"));
        let wanted = Wanted { quiet: true, ..Wanted::default() };
        let (seen, _) = simulate(&driven, &machine, &program, wanted).unwrap_or_else(|_| panic!("it runs"));
        seen.monitor.excess.iter().map(|excess| (excess.n, excess.order)).collect()
    }

    /// The machine permits every tick of the first program, and so does the second one in all blocks but one.
    #[test]
    fn a_weighted_limit_that_is_broken_in_one_block_is_told() {
        let program = |before: &str, motion: &str, behind: &str| {
            format!("%p\nN10 G01 X50 F30000\n{before}\nN20 {motion}\n{behind}\nN30 G01 X0\nM30\n")
        };
        let (line, rapid) = ("G01 Y50", "G00 Y50");
        for (motion, weight, expected) in [
            (line, "G131 50", vec![1, 2]),
            (line, "G130 Y60", vec![1, 2]),
            (line, "G133 200", vec![2]),
            (line, "G132 Y120", vec![2]),
            (rapid, "G231 50", vec![1, 2]),
            (rapid, "G233 200", vec![2]),
            // Weights of rapid motion do not weight lines, and vice versa.
            (line, "G231 50", vec![]),
            (rapid, "G131 50", vec![]),
        ] {
            let (off, _) = weight.split_once(' ').unwrap_or_default();
            let (plain, weighted) = (
                program("", motion, ""),
                program(
                    weight,
                    motion,
                    &format!("{off}{}100", if weight.contains(" Y") { " Y" } else { " " }),
                ),
            );
            let told = judged(&plain, &weighted);
            assert!(told.iter().all(|(n, _)| *n == 20), "{motion}, {weight}: {told:?}");
            let mut orders: Vec<usize> = told.into_iter().map(|(_, order)| order).collect();
            orders.sort_unstable();
            assert_eq!(orders, expected, "{motion}, {weight}");
            assert_eq!(judged(&weighted, &weighted), [], "{motion}, {weight}");
            // Before, the union of both permitted all.
            assert_eq!(judged(&plain, &plain), [], "{motion}, {weight}");
        }
    }

    #[test]
    fn the_time_to_go_is_that_of_the_blocks_left() {
        let after = |seconds, done| to_go(Duration::from_secs(seconds), done, 1000);
        assert_eq!((after(1, 100), after(5, 500), after(10, 1000)), (Some(9), Some(5), Some(0)));
        assert_eq!((after(1, 999), after(1, 0)), (Some(1), None));
    }

    #[test]
    fn progress_does_not_run_backward() {
        let mut bar = Bar::new(10, true);
        for block in [3, 5, 4, 1] {
            bar.at(block);
        }
        assert_eq!(bar.reached, 5);
    }
}

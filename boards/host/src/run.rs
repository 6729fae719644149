//! The board itself: memory, clock and drive loop.
use crate::diagnose::Diagnostic;
use crate::files::Files;
use crate::machine::{Machine, with_axes};
use crate::output;
use crate::plot::Picture;
use crate::program::{self, Program};
use crate::statistics::Statistics;
use crate::trace::Trace;
use glidepath::channel::{Channel, Planner, Progress};
use glidepath::quantity::Position;
use glidepath::tick::{Interpolator, State, Telemetry};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::fs::File;
use std::io;
use std::path::Path;
use std::time::{Duration, Instant};

/// The largest look-ahead this board is compiled for, blocks.
pub const BLOCKS: usize = 500;

/// Runs the program to its end. `trace` receives a row per tick; a [`Picture`] is recorded if wanted.
///
/// # Errors
/// Program or machine data refused; the trace file cannot be written.
pub fn simulate(
    files: &Files,
    machine: &Machine,
    program: &Program,
    trace: Option<(&Path, File)>,
    picture: bool,
) -> Result<(Statistics, Option<Picture>), Vec<Diagnostic>> {
    with_axes!(machine, simulate_axes(files, machine, program, trace, picture))
}

fn simulate_axes<const AXES: usize>(
    files: &Files,
    machine: &Machine,
    program: &Program,
    trace: Option<(&Path, File)>,
    picture: bool,
) -> Result<(Statistics, Option<Picture>), Vec<Diagnostic>> {
    let data = machine.data::<AXES>().ok_or_else(|| vec![Diagnostic::error("wrong number of axes")])?;
    let start = [Position::ZERO; AXES];
    // Static on a controller; here too large for some stacks.
    let mut channel = Box::new(Channel::<AXES, BLOCKS>::new());
    let (planner, interpolator) = channel
        .split(&data, start, files)
        .map_err(|error| vec![Diagnostic::error(format!("{}: {error}", machine.name))])?;

    let trace_path = trace.as_ref().map_or(Path::new(""), |(path, _)| path).to_path_buf();
    let unwritable = |error: io::Error| output::refused(&trace_path, error);
    let trace = trace.map(|(_, file)| Trace::new(file, machine)).transpose().map_err(unwritable)?;
    let recorder = Recorder {
        statistics: Statistics::new(&start),
        trace,
        picture: picture.then(|| Picture::new(machine, program.shown_axes(machine))),
        cycle_s: machine.cycle_s(),
    };
    drive(planner, interpolator, recorder, Bar::new(program.motions)).map_err(|stop| match stop {
        Stop::Refused(error) => vec![program::refusal(files, &error)],
        Stop::Unwritable(error) => unwritable(error),
        Stop::Starved => vec![Diagnostic::error(
            "internal error: the planner waits for the interpolator, which has nothing to do; please report it",
        )],
    })
}

enum Stop {
    Refused(Box<glidepath::channel::Error>),
    Unwritable(io::Error),
    Starved,
}

/// A controller has a timer interrupt and a main loop. Here the main loop gets all the time it needs, then time passes
/// by one tick: the motion never starves, and the set points are those of any controller that is fast enough.
fn drive<const AXES: usize>(
    mut planner: Planner<'_, &Files, AXES, BLOCKS>,
    mut interpolator: Interpolator<'_, AXES>,
    mut recorder: Recorder,
    mut bar: Bar,
) -> Result<(Statistics, Option<Picture>), Stop> {
    let mut done = false;
    let mut idle = 0;
    loop {
        while !done {
            match planner.poll().map_err(|error| Stop::Refused(Box::new(error)))? {
                // The decode pass has collected the warnings.
                Progress::Working | Progress::Warning(_) => {}
                Progress::Planned => {
                    bar.at(recorder.statistics.blocks.len());
                    recorder.statistics.blocks.push(*planner.planned());
                }
                Progress::Waiting => break,
                Progress::Done => done = true,
            }
        }
        match interpolator.tick() {
            State::Active => {
                idle = 0;
                let telemetry = interpolator.telemetry();
                recorder.tick(&telemetry, interpolator.set_points()).map_err(Stop::Unwritable)?;
                while let Some(event) = interpolator.event() {
                    recorder.statistics.output(event);
                }
            }
            State::Idle if done => break,
            State::Idle => {
                idle += 1;
                if idle > 1000 {
                    return Err(Stop::Starved);
                }
            }
        }
    }
    bar.finish();
    recorder.finish(interpolator.set_points())
}

/// Everything that looks at the set points.
struct Recorder {
    statistics: Statistics,
    trace: Option<Trace>,
    picture: Option<Picture>,
    cycle_s: f64,
}

impl Recorder {
    fn tick(&mut self, telemetry: &Telemetry, set_points: &[Position]) -> io::Result<()> {
        self.statistics.add(telemetry.distance, set_points);
        let statistics = &self.statistics;
        if let Some(picture) = &mut self.picture {
            picture.add(telemetry, set_points, &statistics.axes, self.cycle_s);
        }
        match &mut self.trace {
            Some(trace) => trace.row(statistics.ticks - 1, telemetry, statistics.distance, set_points),
            None => Ok(()),
        }
    }

    fn finish(mut self, set_points: &[Position]) -> Result<(Statistics, Option<Picture>), Stop> {
        if self.statistics.ticks == 0 {
            // Nothing moved: the rest is worth a row.
            self.tick(&Telemetry::default(), set_points).map_err(Stop::Unwritable)?;
        }
        self.statistics.finish(set_points);
        if let Some(trace) = self.trace {
            trace.finish().map_err(Stop::Unwritable)?;
        }
        Ok((self.statistics, self.picture))
    }
}

/// Progress in motion blocks on the error output: only on a terminal, and only when it takes long.
struct Bar {
    start: Instant,
    motions: usize,
    shown: Option<ProgressBar>,
}

impl Bar {
    fn new(motions: usize) -> Self {
        Self { start: Instant::now(), motions, shown: None }
    }

    fn at(&mut self, block: usize) {
        match &self.shown {
            Some(bar) => bar.set_position(block as u64),
            None if block.is_multiple_of(64) && self.start.elapsed() > Duration::from_secs(1) => {
                let bar = ProgressBar::with_draw_target(
                    Some(self.motions as u64),
                    ProgressDrawTarget::stderr_with_hz(10),
                );
                let style = ProgressStyle::with_template("{bar:40.cyan} {pos}/{len} blocks, {eta} to go");
                bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
                bar.set_position(block as u64);
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

//! Runs the program once more for every limit that may have bound its speed.
use super::count::{Places, Why};
use super::loosen::{COMPARED, Limit, Loosened, SWITCHED};
use crate::course::Course;
use crate::files::Files;
use crate::machine::Machine;
use crate::program::Program;
use crate::run::{self, Wanted};
use crate::smooth;
use crate::statistics::Statistics;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

/// Highest number of rows for which the reasons are searched without the option `always`.
const ROWS: u64 = 400_000;

/// Stack of a simulation thread: the memory of a channel is built on the stack before it moves to its place.
const STACK: usize = 32 << 20;

/// Whether to ask.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum Asked {
    /// Unless the run is long.
    #[default]
    Auto,
    /// However long it takes.
    Always,
    /// Not at all.
    Never,
}

/// Result of a run with one limit changed.
pub struct Trial {
    pub limit: Limit,
    pub axis: Option<usize>,
    pub time_s: f64,
    pub course: Course,
}

/// Finds the reasons that bound the speed of a run; nothing if not requested, or without motion.
pub fn ask(
    files: &Files,
    machine: &Machine,
    program: &Program,
    run: &Statistics,
    by_itself: bool,
    asked: Asked,
) -> Option<Why> {
    let wanted = match asked {
        Asked::Auto => run.ticks <= ROWS,
        Asked::Always => true,
        Asked::Never => false,
    };
    if !wanted || run.course.blocks() == 0 {
        return None;
    }
    let again;
    let base = if by_itself {
        run
    } else {
        again = simulate(files, machine, program)?;
        &again
    };
    let time_s = base.time_s(machine);
    let limits = COMPARED.into_iter().chain(SWITCHED);
    let trials = all(files, program, limits.filter_map(|limit| limit.loosen(machine, None)).collect());
    let (compared, switched): (Vec<Trial>, Vec<Trial>) =
        trials.into_iter().partition(|trial| COMPARED.contains(&trial.limit));
    let places = Places { machine, program, run, base, trials: &compared };
    let mut why = places.count(time_s);
    // The limits that bind most places, axis by axis.
    let moving: Vec<usize> = (0..machine.axes.len()).filter(|&k| base.axes[k].travel() > 0.0).collect();
    let most: Vec<Limit> = why.most().into_iter().filter(|limit| *limit != Limit::LookAhead).collect();
    if moving.len() == 1 {
        why.name_axes(|_, _| moving.first().copied());
    } else if !most.is_empty() {
        let one = |limit: &Limit| {
            moving.iter().filter_map(|&axis| limit.loosen(machine, Some(axis))).collect::<Vec<_>>()
        };
        let by_axis = all(files, program, most.iter().flat_map(one).collect());
        why.name_axes(|place, limit| place.fastest(by_axis.iter().filter(|trial| trial.limit == limit)));
    }
    why.helps(&switched, &compared);
    why.smoothed_s = smooth::advised(files, machine, program, time_s);
    Some(why)
}

fn simulate(files: &Files, machine: &Machine, program: &Program) -> Option<Statistics> {
    let wanted = Wanted { quiet: true, ..Wanted::default() };
    run::simulate(files, machine, program, wanted).ok().map(|(statistics, _)| statistics)
}

/// Runs all trials, on all processors, in their order.
fn all(files: &Files, program: &Program, machines: Vec<Loosened>) -> Vec<Trial> {
    let bar =
        ProgressBar::with_draw_target(Some(machines.len() as u64), ProgressDrawTarget::stderr_with_hz(5));
    let style = ProgressStyle::with_template("{bar:40.cyan} {pos}/{len} what bound the speed, {eta} to go");
    bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
    bar.enable_steady_tick(Duration::from_secs(1));
    let next = AtomicUsize::new(0);
    let done: Mutex<Vec<(usize, Trial)>> = Mutex::default();
    let threads = std::thread::available_parallelism().map_or(1, usize::from).min(machines.len());
    std::thread::scope(|scope| {
        for _ in 0..threads {
            let files = files.again();
            let (next, done, machines, bar) = (&next, &done, &machines, &bar);
            let work = move || {
                while let Some((index, loosened)) = {
                    let index = next.fetch_add(1, Ordering::Relaxed);
                    machines.get(index).map(|loosened| (index, loosened))
                } {
                    let Loosened { machine, limit, axis } = loosened;
                    if let Some(result) = simulate(&files, machine, program) {
                        let time_s = result.time_s(machine);
                        let trial = Trial { limit: *limit, axis: *axis, time_s, course: result.course };
                        if let Ok(mut done) = done.lock() {
                            done.push((index, trial));
                        }
                    }
                    bar.inc(1);
                }
            };
            // If no more threads start, the started ones do all work.
            if std::thread::Builder::new().stack_size(STACK).spawn_scoped(scope, work).is_err() {
                break;
            }
        }
    });
    bar.finish_and_clear();
    let mut done = done.into_inner().unwrap_or_default();
    done.sort_by_key(|(index, _)| *index);
    done.into_iter().map(|(_, trial)| trial).collect()
}

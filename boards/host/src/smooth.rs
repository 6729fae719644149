//! `--smooth`: Surface or contour mode DEV over a program that has no smoothing of its own.
//!
//! Surface suits short chords, DEV corners of long blocks. Both are tried, and the program as it is: the fastest one
//! is taken, so that no program gets slower.
use crate::diagnose::Diagnostic;
use crate::files::Files;
use crate::machine::Machine;
use crate::program::{self, Program};
use crate::run::{self, Wanted};
use glidepath::nc::{Command, Contour, ContourMethod, ContourSwitch, Head, Hsc, HscMethod, Place};
use glidepath::quantity::Position;

/// The tolerance that the advice of a summary tries, mm.
pub const ADVISED: f64 = 0.01;

/// A smoothing that a program begins with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Smooth {
    pub method: Method,
    /// PATH_DEV, mm.
    pub tolerance: f64,
}

/// The methods that are tried.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// #HSC ON \[SURFACE\].
    Surface,
    /// #CONTOUR MODE ON \[DEV\].
    Dev,
}

impl Smooth {
    /// As the command of a program.
    pub fn command<const AXES: usize>(self) -> Command<AXES> {
        let head = Head { n: 0, place: Place::default(), in_motion: false };
        let path_dev = Some(Position::from_num(self.tolerance));
        match self.method {
            Method::Surface => {
                let method = Some(HscMethod::Surface);
                Command::Hsc(head, Hsc { switch: Some(true), method, path_dev, ..Hsc::default() })
            }
            Method::Dev => {
                let (switch, method) = (Some(ContourSwitch::On), Some(ContourMethod::Dev));
                Command::Contour(head, Contour { switch, method, path_dev, ..Contour::default() })
            }
        }
    }

    /// As a user would write it.
    pub fn name(self) -> String {
        match self.method {
            Method::Surface => format!("#HSC ON [SURFACE PATH_DEV={}]", self.tolerance),
            Method::Dev => format!("#CONTOUR MODE ON [DEV PATH_DEV={}]", self.tolerance),
        }
    }
}

/// The tolerance of the command line.
pub fn parse(text: &str) -> Result<f64, String> {
    let value = text.parse().ok().filter(|value| (0.0001..=10.0).contains(value));
    value.ok_or_else(|| "expected a tolerance of 0.0001 to 10 mm".into())
}

/// Whether a program smooths some of its path itself.
fn has_its_own(program: &Program) -> bool {
    program.through_points || program.motions().any(|motion| motion.smoothed)
}

/// Seconds, where the run comes to its end inside all limits.
fn time(files: &Files, machine: &Machine, program: &Program) -> Option<f64> {
    let wanted = Wanted { quiet: true, ..Wanted::default() };
    let (result, _) = run::simulate(files, machine, program, wanted).ok()?;
    result.monitor.excess.is_empty().then(|| result.time_s(machine))
}

/// The faster method with its time; none where neither does.
fn best(files: &Files, machine: &Machine, tolerance: f64, limit: u64) -> Option<(Smooth, Program, f64)> {
    let trials = [Method::Surface, Method::Dev].map(|method| {
        let smooth = Smooth { method, tolerance };
        let machine = machine.smoothed(Some(smooth));
        let program = program::decode(files, &machine, limit).ok().filter(|program| !program.refused)?;
        let time = time(files, &machine, &program)?;
        Some((smooth, program, time))
    });
    trials.into_iter().flatten().min_by(|one, other| one.2.total_cmp(&other.2))
}

/// Puts the method that makes the program fastest over it, and says which.
pub fn put(files: &Files, machine: &mut Machine, program: Program, tolerance: f64, limit: u64) -> Program {
    let mut program = program;
    if has_its_own(&program) {
        let message = "the program has smoothing of its own: --smooth changes nothing";
        program.warnings.push(Diagnostic::warning(message));
        return program;
    }
    let plain = time(files, machine, &program);
    match best(files, machine, tolerance, limit) {
        Some((smooth, mut smoothed, time)) if plain.is_none_or(|plain| time < plain) => {
            let before = plain.map_or_else(String::new, |plain| format!(" in place of {plain:.3} s"));
            let message = format!("--smooth {tolerance}: {}, {time:.3} s{before}", smooth.name());
            smoothed.messages.push(Diagnostic::note(message));
            machine.smooth = Some(smooth);
            smoothed
        }
        _ => {
            let message = format!("--smooth {tolerance} makes this program no faster: it runs as it is");
            program.messages.push(Diagnostic::note(message));
            program
        }
    }
}

/// The time with `--smooth` [`ADVISED`], where that is shorter than `time_s` and the program has no smoothing.
pub fn advised(files: &Files, machine: &Machine, program: &Program, time_s: f64) -> Option<f64> {
    if has_its_own(program) || machine.smooth.is_some() {
        return None;
    }
    let (_, _, time) = best(files, machine, ADVISED, 1_000_000)?;
    (time < time_s * 0.99).then_some(time)
}

//! `--smooth`: applies Surface or contour mode DEV to a program that has no smoothing.
//!
//! Surface suits short chords, and DEV suits corners of long blocks. The simulator tries both methods and the
//! unchanged program, and takes the fastest one, so no program gets slower.
use crate::diagnose::Diagnostic;
use crate::files::Files;
use crate::machine::Machine;
use crate::program::{self, Program};
use crate::run::{self, Wanted};
use glidepath::nc::{Command, Contour, ContourMethod, ContourSwitch, Head, Hsc, HscMethod, Place};
use glidepath::quantity::Position;

/// The tolerance of the advice in a summary, mm.
pub const ADVISED: f64 = 0.01;

/// A smoothing that a program begins with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Smooth {
    pub method: Method,
    /// PATH_DEV, mm.
    pub tolerance: f64,
}

/// The methods that the simulator tries.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// #HSC ON \[SURFACE\].
    Surface,
    /// #CONTOUR MODE ON \[DEV\].
    Dev,
}

impl Smooth {
    /// Returns the command of the program.
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

    /// Returns the text of the command.
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

/// Whether a program contains a smoothing command.
fn has_its_own(program: &Program) -> bool {
    program.through_points || program.motions().any(|motion| motion.smoothed)
}

/// Program time in seconds, if the run ends inside all limits.
fn time(files: &Files, machine: &Machine, program: &Program) -> Option<f64> {
    let wanted = Wanted { quiet: true, ..Wanted::default() };
    let (result, _) = run::simulate(files, machine, program, wanted).ok()?;
    result.monitor.excess.is_empty().then(|| result.time_s(machine))
}

/// Returns the faster method with its time, or none if neither ends.
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

/// Applies the method with which the program is fastest, and returns its name.
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

/// The time with `--smooth` [`ADVISED`], if it is shorter than `time_s` and the program has no smoothing.
pub fn advised(files: &Files, machine: &Machine, program: &Program, time_s: f64) -> Option<f64> {
    if has_its_own(program) || machine.smooth.is_some() {
        return None;
    }
    let (_, _, time) = best(files, machine, ADVISED, 1_000_000)?;
    (time < time_s * 0.99).then_some(time)
}

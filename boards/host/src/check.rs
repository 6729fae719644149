//! Checks a program without planning it: takes its text, and returns the refusals and warnings of `run`.
//!
//! The planner of the library checks the program with all its rules, but without look-ahead and interrupt
//! ([`glidepath::Planner::examine`]). After a refused line the check continues, so that all mistakes are
//! reported at once.
use crate::diagnose::Diagnostic;
use crate::files::Files;
use crate::machine::{Machine, with_axes};
use crate::mistakes::Mistakes;
use crate::plc;
use crate::program::repeats::Repeats;
use crate::program::told::{Warned, endless, message};
use crate::program::{plural, remark};
use crate::run::{BLOCKS, OVERLAYS, TAPS};
use glidepath::channel::{Channel, Planner, Progress};
use glidepath::fir::FilterPlan;
use glidepath::fir::Filters;
use glidepath::nc::{Command, DwellTime, Motion, MotionKind, Text};
use glidepath::quantity::Position;

/// Bounds at which a check ends early.
#[derive(Clone, Copy)]
pub struct Bounds {
    /// Number of commands of repeated lines.
    pub commands: u64,
    /// Mistakes.
    pub mistakes: usize,
}

/// A program without mistakes.
#[derive(Default)]
pub struct Checked {
    motions: usize,
    arcs: usize,
    dwells: usize,
    /// Warnings of the decoder.
    pub warnings: Vec<Diagnostic>,
    /// Warnings about curves.
    pub remarks: Vec<Diagnostic>,
    /// Messages of the program to the operator.
    pub messages: Vec<Diagnostic>,
    /// Axes move independently of the path. Their positions may depend on time, which only a plan knows.
    pub beside: bool,
}

impl Checked {
    /// In one line.
    pub fn describe(&self) -> String {
        let Self { motions, arcs, dwells, .. } = self;
        let warnings = self.warnings.len() + self.remarks.len();
        format!(
            "{motions} motion block{} ({arcs} arc{}), {dwells} dwell{}, {warnings} warning{}",
            plural(*motions),
            plural(*arcs),
            plural(*dwells),
            plural(warnings),
        )
    }

    /// Counts a command; `at` is the position of the axes.
    fn count<const AXES: usize>(&mut self, command: &Command<AXES>, at: &[Position; AXES]) {
        match command {
            Command::Motion(motion) => {
                let is_arc = matches!(motion.kind, MotionKind::Arc { .. });
                if is_arc || motion.target != *at {
                    self.motions += 1;
                    self.arcs += usize::from(is_arc);
                }
            }
            Command::Dwell(_, DwellTime::Seconds(_)) => self.dwells += 1,
            Command::Oscillation(..) | Command::Independent(..) => self.beside = true,
            _ => {}
        }
    }
}

/// Checks the whole program. `plc`: the requests beside it, whose variables it knows.
///
/// # Errors
/// All its mistakes in the order of the text, as far as the bounds allow.
pub fn check(
    files: &Files,
    machine: &Machine,
    bounds: Bounds,
    plc: Option<&plc::Script>,
) -> Result<Checked, Vec<Diagnostic>> {
    with_axes!(machine, check_axes(files, machine, bounds, plc))
}

fn check_axes<const AXES: usize>(
    files: &Files,
    machine: &Machine,
    bounds: Bounds,
    plc: Option<&plc::Script>,
) -> Result<Checked, Vec<Diagnostic>> {
    let data = machine.data::<AXES>().ok_or_else(|| vec![Diagnostic::error("wrong number of axes")])?;
    let start = [Position::ZERO; AXES];
    // On a controller the memory is static; here it is too large for some stacks.
    let mut channel = Box::new(Channel::<AXES, BLOCKS, OVERLAYS>::new());
    let mut filters = Box::new(Filters::<AXES, TAPS>::new());
    let mut outside = plc::Memory::<AXES>::new(machine, plc);
    let mut handles = channel
        .split_filtered(&mut filters, &data, start, files)
        .map_err(|error| vec![Diagnostic::error(format!("{}: {error}", machine.name))])?;
    let planner = &mut handles.planner;
    if let Some(smooth) = machine.smooth {
        planner.begin_with(smooth.command());
    }
    outside.give(planner, plc::Wants { contour: true, outside: true });
    planner.examine();
    let mut checked = Checked::default();
    let mut mistakes = Mistakes::new(bounds.mistakes);
    let (mut warned, mut repeats) = (Warned::default(), Repeats::default());
    let mut at = start;
    // The last motion, if nothing follows it.
    let mut last = None;
    loop {
        let progress = planner.poll();
        if let Some(command) = planner.seen() {
            if repeats.add(command.place()) > bounds.commands {
                return Err(vec![endless(files, command.place(), bounds.commands)]);
            }
            checked.count(&command, &at);
            last = None;
            match command {
                Command::Motion(motion) => {
                    at = motion.target;
                    last = Some(motion);
                }
                Command::Message(head) => {
                    checked.messages.extend(message(files, &head, |name| planner.parameter(name)));
                }
                _ => {}
            }
        }
        match progress {
            Ok(Progress::Warning(warning)) if warned.is_new(&warning) => {
                let of_curve = warning.kind.is_of_curve();
                let list = if of_curve { &mut checked.remarks } else { &mut checked.warnings };
                list.push(remark(files, &warning));
            }
            // Filters and independent axes continue with the tick.
            Ok(Progress::Waiting) => _ = handles.interpolator.tick(),
            Ok(Progress::Done) if mistakes.is_empty() => return Ok(checked),
            Ok(Progress::Done) if mistakes.goes_on() && go_on(planner, &mistakes, last.as_ref()) => {
                at = *planner.position();
            }
            Ok(Progress::Done) => return Err(mistakes.tell(files)),
            Ok(_) => {}
            Err(error) => {
                if !mistakes.add(error, files) {
                    return Err(mistakes.tell(files));
                }
            }
        }
    }
}

/// After a refused line: the axes get the end point of this line, if it is known. Returns whether the program
/// continues.
fn go_on<T: Text, const AXES: usize, const BLOCKS: usize, F: FilterPlan<AXES>, const OVERLAYS: usize>(
    planner: &mut Planner<'_, T, AXES, BLOCKS, F, OVERLAYS>,
    mistakes: &Mistakes,
    last: Option<&Motion<AXES>>,
) -> bool {
    if let Some(motion) = last.filter(|_| mistakes.leads_on()) {
        for (axis, &end) in motion.target.iter().enumerate() {
            // A position outside the range of positions: the axis stays.
            let _ = planner.set_position(axis, end);
        }
    }
    planner.go_on().is_ok()
}

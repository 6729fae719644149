//! The pass of the decoder that makes a [`Program`].
use super::repeats::Repeats;
use super::told::{Warned, endless, message, remark};
use super::transformed::Switch;
use super::{Kind, Program, Segment};
use crate::beside::Told;
use crate::diagnose::Diagnostic;
use crate::files::Files;
use crate::machine::{Limits, Machine, limits, with_axes};
use crate::tolerance::{Smoothing, Tolerance};
use glidepath::dynamics::Weights;
use glidepath::kinematics::Kinematic;
use glidepath::machine::{AxisData, MachineData};
use glidepath::nc::{
    ArcBy, Command, Decoder, DecoderMemory, DwellTime, Motion, MotionKind, Setup, SlopeType, Step,
};
use glidepath::quantity::Position;

/// Number of refused lines, repeats in loops included, after which decoding ends.
const REFUSALS: u32 = 10_000;

/// Decodes the whole program, with at most `limit` commands of repeated lines.
///
/// # Errors
/// The program repeats more than `limit` commands.
pub fn decode(files: &Files, machine: &Machine, limit: u64) -> Result<Program, Vec<Diagnostic>> {
    with_axes!(machine, decode_axes(files, machine, limit))
}

fn decode_axes<const AXES: usize>(
    files: &Files,
    machine: &Machine,
    limit: u64,
) -> Result<Program, Vec<Diagnostic>> {
    let data = machine.data::<AXES>().ok_or_else(|| vec![Diagnostic::error("wrong number of axes")])?;
    let start = [Position::ZERO; AXES];
    let mut memory = Box::new(DecoderMemory::new());
    let mut decoder = Decoder::new(&mut memory, Setup::new(&data, start), files);
    if let Some(smooth) = machine.smooth {
        decoder.begin_with(smooth.command());
    }
    let sets = machine.kinematics.fitted(&data);
    let mut reading = Reading::new(machine, &data, &sets);
    let mut warned = Warned::default();
    let mut repeats = Repeats::default();
    let mut refusals = 0;
    loop {
        let step = match decoder.step() {
            Ok(step) => step,
            // The check reports the error and its place.
            Err(_) => {
                reading.program.refused = true;
                refusals += 1;
                if refusals > REFUSALS {
                    return Ok(reading.program);
                }
                let here = decoder.position();
                decoder.go_on(here);
                continue;
            }
        };
        match step {
            // All files are there.
            Step::Working | Step::Late => {}
            Step::Warning(warning) => {
                if warned.is_new(&warning) {
                    reading.program.warnings.push(remark(files, &warning));
                }
            }
            Step::Command(command) => {
                if repeats.add(command.place()) > limit {
                    return Err(vec![endless(files, command.place(), limit)]);
                }
                if let Command::Message(head) = &command {
                    let told = message(files, head, |name| decoder.parameter(name));
                    reading.program.messages.extend(told);
                }
                if let Some(stands) = reading.take(&command) {
                    decoder.stand_at(stands);
                }
            }
            Step::End => return Ok(reading.program),
        }
    }
}

/// The program so far, and the modal state for the next block.
pub(super) struct Reading<'a, const AXES: usize> {
    machine: &'a Machine,
    data: &'a MachineData<AXES>,
    main: [Option<usize>; 3],
    at: [Position; AXES],
    pub(super) program: Program,
    weights: Weights<AXES>,
    /// Limits of the axes with their weights.
    axes: [AxisData; AXES],
    slope: SlopeType,
    /// No block has moved with these weights and this slope yet.
    changed: bool,
    smoothing: Smoothing,
    switch: Switch<'a>,
}

impl<'a, const AXES: usize> Reading<'a, AXES> {
    /// No command yet; all axes are at zero.
    pub(super) fn new(machine: &'a Machine, data: &'a MachineData<AXES>, sets: &'a [Kinematic]) -> Self {
        Self {
            switch: Switch { sets, selected: machine.kinematics.default_id, active: None },
            machine,
            data,
            main: data.main_axes(),
            at: [Position::ZERO; AXES],
            program: Program::empty(machine),
            weights: Weights::new(),
            axes: data.axes,
            slope: machine.slope(),
            changed: true,
            smoothing: Smoothing::new(),
        }
    }
}

impl<const AXES: usize> Reading<'_, AXES> {
    /// Handles a command. Returns the position, if the command changes it.
    pub(super) fn take(&mut self, command: &Command<AXES>) -> Option<[Position; AXES]> {
        let Self { machine, data, program, .. } = self;
        match command {
            Command::Weight(_, weight) => {
                self.weights.set(weight);
                let weights = &self.weights;
                self.axes = std::array::from_fn(|k| weights.apply(k, &data.axes[k], &data.channel));
                self.changed = true;
            }
            Command::Slope(_, command) => {
                let kind = command.kind.unwrap_or(self.slope);
                self.slope = if command.default { machine.slope() } else { kind };
                self.changed = true;
            }
            Command::Motion(motion) => {
                if std::mem::take(&mut self.changed) {
                    program.allow(&self.axes, self.slope, machine);
                }
                program.add(motion, &self.at, &self.main, &mut self.smoothing);
                self.at = motion.target;
            }
            Command::Dwell(head, DwellTime::Seconds(time)) => {
                program.segments.push(Segment {
                    n: head.n,
                    place: head.place,
                    kind: Kind::Dwell(time.to_num()),
                    end: numbers(&self.at),
                    feed: None,
                    stop: true,
                    smoothed: false,
                    tolerance: Tolerance::default(),
                    dynamics: program.latest_dynamics(),
                });
            }
            Command::FlushWait(_) | Command::Pause(..) | Command::WaitInput(..) => program.stop(),
            Command::Kinematics(head, kinematics) => {
                let (Some(id), Some(to)) = self.switch.take(*kinematics, &self.at) else { return None };
                self.at = to;
                program.transform(head, &to, id);
                return Some(to);
            }
            Command::Spline(..) => program.through_points = true,
            Command::Hsc(..) | Command::Contour(..) => self.smooth(command),
            command => {
                if let Some(told) = Told::of(command) {
                    program.allow_beside(&told, &data.axes, machine);
                    program.beside.push(told);
                }
            }
        }
        None
    }

    /// Takes a command of #HSC or contour mode.
    fn smooth(&mut self, command: &Command<AXES>) {
        let Self { machine, program, smoothing, .. } = self;
        match command {
            Command::Hsc(_, hsc) => {
                program.through_points = true;
                if smoothing.hsc(hsc) {
                    program.checks_jerk(hsc.check_jerk, machine);
                }
                if !smoothing.is_on() {
                    program.ends_smoothing();
                }
            }
            Command::Contour(head, contour) => {
                smoothing.contour(contour);
                let relevant = contour.relevant_path.map_or(0.0, |path| path.to_num());
                program.relevant = program.relevant.max(relevant);
                // In a block with a motion, the corner before it stays rounded.
                if !smoothing.is_on() && !head.in_motion {
                    program.ends_smoothing();
                }
                program.checks_jerk(contour.check_jerk, machine);
            }
            _ => {}
        }
    }
}

pub(super) fn numbers(position: &[Position]) -> Vec<f64> {
    position.iter().map(|value| value.to_num()).collect()
}

/// Centre of an arc given by its radius; the planner checks the radius.
fn centre(start: [Position; 2], end: [Position; 2], radius: Position, clockwise: bool) -> [f64; 2] {
    let bits = |value: Position| i128::from(value.to_bits());
    let [dx, dy] = [0, 1].map(|i| bits(end[i]) - bits(start[i]));
    // Squares are exact. If half the chord is nearly the radius, rounding would move the centre.
    let square = 4 * bits(radius) * bits(radius) - dx * dx - dy * dy;
    let chord = (dx as f64).hypot(dy as f64);
    // From the middle of the chord to the left for G03 and angles below 180°.
    let left = if clockwise == (radius < Position::ZERO) { 1.0 } else { -1.0 };
    let share = left * (square.max(0) as f64).sqrt() / 2.0 / chord.max(1.0);
    let lsb = 2.0_f64.powi(-32);
    let middle = |i: usize| (bits(start[i]) + bits(end[i])) as f64 / 2.0;
    [(middle(0) - share * dy as f64) * lsb, (middle(1) + share * dx as f64) * lsb]
}

impl Program {
    /// Records the limits of the axes from a block on.
    fn allow(&mut self, axes: &[AxisData], slope: SlopeType, machine: &Machine) {
        let now: Vec<Limits> =
            axes.iter().map(|axis| limits(&axis.planned(&machine.channel), slope)).collect();
        if self.limits.is_empty() {
            self.limits.clone_from(&now);
        }
        for (allowed, now) in self.limits.iter_mut().zip(&now) {
            *allowed = allowed.or(*now);
        }
        if self.dynamics.last() != Some(&now) {
            self.dynamics.push(now);
        }
    }

    /// Records the limits of an axis in an independent motion, on which weights and slope of the program do
    /// not act.
    fn allow_beside(&mut self, told: &Told, axes: &[AxisData], machine: &Machine) {
        let slope = told.slope.unwrap_or(machine.slope());
        if let (Some(axis), Some(allowed)) = (axes.get(told.axis), self.limits_beside.get_mut(told.axis)) {
            allowed.push(limits(&told.weigh(axis).planned(&machine.channel), slope));
        }
    }

    /// CHECK_JERK of a command, or P-CHAN-00110.
    fn checks_jerk(&mut self, given: Option<u8>, machine: &Machine) {
        self.free_curves |= given.unwrap_or(machine.channel.check_jerk_on_poly_path) == 0;
    }

    /// The active weights and slope.
    pub(super) fn latest_dynamics(&self) -> u32 {
        self.dynamics.len().saturating_sub(1) as u32
    }

    fn add<const AXES: usize>(
        &mut self,
        motion: &Motion<AXES>,
        start: &[Position; AXES],
        main: &[Option<usize>; 3],
        smoothing: &mut Smoothing,
    ) {
        let is_arc = matches!(motion.kind, MotionKind::Arc { .. });
        if motion.target == *start && !is_arc {
            // A block without motion: an exact stop then belongs to the end of the block before.
            if motion.exact_stop {
                self.stop();
            }
            return;
        }
        let kind = match motion.kind {
            MotionKind::Arc { plane, clockwise, by } => {
                // The decoder refuses planes that the machine does not have.
                let axes = plane.main_axes().map(|index| main[index].unwrap_or(0));
                let centre = match by {
                    ArcBy::Centre(centre) => centre.map(|value| value.to_num()),
                    ArcBy::Radius(radius) => {
                        let [from, to] = [start, &motion.target].map(|point| axes.map(|axis| point[axis]));
                        centre(from, to, radius, clockwise)
                    }
                };
                Kind::Arc { plane: axes, centre, clockwise }
            }
            MotionKind::Rapid | MotionKind::Line => Kind::Line,
        };
        let feed = (motion.kind != MotionKind::Rapid).then(|| motion.feed.to_num());
        let end = numbers(&motion.target);
        self.segments.push(Segment {
            n: motion.n,
            place: motion.place,
            kind,
            end,
            feed,
            stop: motion.exact_stop,
            smoothed: smoothing.is_on(),
            tolerance: smoothing.tolerance(motion.kind == MotionKind::Rapid),
            dynamics: self.latest_dynamics(),
        });
        smoothing.passes();
        self.motions += 1;
    }

    /// The corner after the last motion is not rounded.
    fn ends_smoothing(&mut self) {
        if let Some(last) = self.segments.last_mut() {
            last.smoothed = false;
        }
    }

    pub(super) fn stop(&mut self) {
        if let Some(last) = self.segments.last_mut() {
            last.stop = true;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn position(x: f64, y: f64) -> [Position; 2] {
        [Position::from_num(x), Position::from_num(y)]
    }

    #[test]
    fn radius_words_have_their_centre_on_the_right_side() {
        // Quarter circle from (10, 0) to (0, 10) about the origin, or the long way about (10, 10).
        let arc = |radius: i32, clockwise| {
            centre(position(10.0, 0.0), position(0.0, 10.0), Position::from_num(radius), clockwise)
        };
        assert_eq!(arc(10, false), [0.0, 0.0]);
        assert_eq!(arc(-10, false), [10.0, 10.0]);
        assert_eq!(arc(10, true), [10.0, 10.0]);
        assert_eq!(arc(-10, true), [0.0, 0.0]);
    }
}

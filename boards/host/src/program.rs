//! The program as decoded, before anything is planned: for the contour, the picture, warnings, and `check`.
//!
//! An own pass of the decoder, so that what is shown as programmed owes nothing to path, look-ahead and
//! slope.
use crate::beside::Told;
use crate::diagnose::Diagnostic;
use crate::files::Files;
use crate::machine::{Limits, Machine, limits, with_axes};
use crate::resolution::Resolution;
use crate::tolerance::{Smoothing, Tolerance};
use glidepath::channel::Error;
use glidepath::dynamics::Weights;
use glidepath::machine::AxisData;
use glidepath::nc::{
    ArcBy, Command, Decoder, DecoderMemory, DwellTime, Motion, MotionKind, NcError, NcWarning, Place, Setup,
    SlopeType, Step,
};
use glidepath::quantity::Position;
use std::collections::HashSet;

/// A block of the contour. Coordinates are absolute, one per axis of the machine, exact in f64.
pub struct Segment {
    /// Programmed N number.
    pub n: u32,
    /// Where that stands in the text.
    pub place: Place,
    /// Shape.
    pub kind: Kind,
    /// End point.
    pub end: Vec<f64>,
    /// Feed in mm/min; none in rapid motion.
    pub feed: Option<f64>,
    /// Standstill at its end is programmed.
    pub stop: bool,
    /// The corner at its end may be rounded, or it belongs to a smoothed path.
    pub smoothed: bool,
    /// How far the motion may leave it, where that is monitored.
    pub tolerance: Tolerance,
    /// Which of [`Program::dynamics`] it moves with.
    pub dynamics: u32,
}

/// Shapes of blocks.
pub enum Kind {
    /// Straight.
    Line,
    /// Arc, full circle or helix.
    Arc {
        /// Axes of the plane.
        plane: [usize; 2],
        /// Centre in these axes.
        centre: [f64; 2],
        /// G02.
        clockwise: bool,
    },
    /// No motion for so many seconds.
    Dwell(f64),
}

/// What makes an arc out of a travel.
struct Turn {
    plane: [usize; 2],
    radius: f64,
    /// Length in the plane.
    along: f64,
}

impl Segment {
    /// What every axis travels from `start`; of an arc, the first axis of its plane as far as the arc is long
    /// and the second one not at all.
    fn travel(&self, start: &[f64]) -> (Vec<f64>, Option<Turn>) {
        let mut travel: Vec<f64> = self.end.iter().zip(start).map(|(to, from)| (to - from).abs()).collect();
        let Kind::Arc { plane, centre, clockwise } = self.kind else { return (travel, None) };
        let [from, to] = [start, &self.end].map(|point| plane.map(|axis| point[axis]));
        let radius = (to[0] - centre[0]).hypot(to[1] - centre[1]);
        let along = radius * sweep(from, to, centre, clockwise).abs();
        travel[plane[0]] = along;
        travel[plane[1]] = 0.0;
        (travel, Some(Turn { plane, radius, along }))
    }
}

/// Length over some of the axes.
fn length(travel: &[f64], axes: &[usize]) -> f64 {
    axes.iter().map(|&index| travel[index].powi(2)).sum::<f64>().sqrt()
}

/// Path length: along the feed axes; where none of them moves along the main axes, then along all others. At
/// least a 1024th of what any axis travels, a 64th beside other feed axes than the main ones.
fn path(machine: &Machine, travel: &[f64]) -> f64 {
    let (feed, main) = (machine.feed_axes(), machine.main_axes());
    let all: Vec<usize> = (0..travel.len()).collect();
    let lengths = [&feed, &main, &all].map(|axes| length(travel, axes));
    let path = lengths.into_iter().find(|length| *length > 0.0).unwrap_or(0.0);
    let steepest = if lengths[0] > 0.0 && feed != main { 64.0 } else { 1024.0 };
    travel.iter().fold(path, |path, travel| path.max(travel / steepest))
}

/// The path speed of a block, per second.
pub struct PathSpeed {
    /// None in rapid motion.
    pub programmed: Option<f64>,
    /// What the axes allow in its direction.
    pub limit: f64,
}

/// A decoded program.
pub struct Program {
    /// Where all axes stand at first.
    pub start: Vec<f64>,
    /// All blocks that move or wait.
    pub segments: Vec<Segment>,
    /// How many of them move.
    pub motions: usize,
    /// Remarks of the decoder.
    pub warnings: Vec<Diagnostic>,
    /// What the program tells the operator.
    pub messages: Vec<Diagnostic>,
    /// What each axis may do with the largest weights under which the program moves.
    pub limits: Vec<Limits>,
    /// What each axis may do with the weights and the slope of a stretch of the program, stretch by stretch.
    pub dynamics: Vec<Vec<Limits>>,
    /// What each axis may do in each of its motions beside the path, in their order.
    pub limits_beside: Vec<Vec<Limits>>,
    /// #HSC or #SPLINE: curves go through points, or along them.
    pub through_points: bool,
    /// Curves in corners may have any jerk: CHECK_JERK=0, P-CHAN-00110 = 0.
    pub free_curves: bool,
    /// Blocks up to so much path may be left out at a corner: 32 µm, or the largest RELEVANT_PATH, mm.
    pub relevant: f64,
    /// Motions of axes beside the path, in the order of the program.
    pub beside: Vec<Told>,
    /// Some lines are not understood; what is here is the rest.
    pub refused: bool,
}

/// Why a program was not decoded to its end.
pub enum Undecoded {
    /// The machine data have no program.
    Refused(Vec<Diagnostic>),
    /// It repeats its lines more often than wanted: it may have no end. With the place it had come to.
    Endless(Vec<Diagnostic>),
}

/// Refused lines, those of loops again and again, behind which the rest is not looked at.
const REFUSALS: u32 = 10_000;

/// More commands than one line can have.
const LINE: u32 = 64;

/// Counts the commands of lines that were carried out before: what makes a program endless, however long it is.
#[derive(Default)]
struct Repeats {
    /// File and offset of the commands so far.
    seen: HashSet<(u16, u32)>,
    last: Option<(u16, u32)>,
    /// The line at hand is carried out for the first time.
    is_new: bool,
    /// Commands of the place at hand, one behind the other.
    row: u32,
    count: u64,
}

impl Repeats {
    /// Takes in a command; how many are repeated up to now.
    fn add(&mut self, place: Place) -> u64 {
        let here = (place.file, place.offset);
        if self.last == Some(here) {
            // Either of one line, or of a loop of one line.
            self.row += 1;
        } else {
            (self.last, self.row) = (Some(here), 1);
            self.is_new = self.seen.insert(here);
        }
        self.count += u64::from(!self.is_new || self.row > LINE);
        self.count
    }
}

/// Decodes the whole program, at most `limit` commands of lines that were carried out before.
///
/// # Errors
/// It repeats more than `limit` commands.
pub fn decode(files: &Files, machine: &Machine, limit: u64) -> Result<Program, Undecoded> {
    with_axes!(machine, decode_axes(files, machine, limit))
}

fn decode_axes<const AXES: usize>(
    files: &Files,
    machine: &Machine,
    limit: u64,
) -> Result<Program, Undecoded> {
    let data = machine
        .data::<AXES>()
        .ok_or_else(|| Undecoded::Refused(vec![Diagnostic::error("wrong number of axes")]))?;
    let start = [Position::ZERO; AXES];
    let main = data.main_axes();
    let mut memory = Box::new(DecoderMemory::new());
    let mut decoder = Decoder::new(&mut memory, Setup::new(&data, start), files);
    if let Some(smooth) = machine.smooth {
        decoder.begin_with(smooth.command());
    }
    let mut at = start;
    let mut program = Program::empty(machine);
    let mut weights = Weights::new();
    // The axes as they are weighted, and whether a block has moved with it.
    let (mut axes, mut slope, mut changed) = (data.axes, machine.slope(), true);
    let mut warned = HashSet::new();
    let mut smoothing = Smoothing::new();
    let mut repeats = Repeats::default();
    let mut refusals = 0;
    loop {
        let step = match decoder.step() {
            Ok(step) => step,
            // The planner tells what and where.
            Err(_) => {
                program.refused = true;
                refusals += 1;
                if refusals > REFUSALS {
                    return Ok(program);
                }
                let here = decoder.position();
                decoder.go_on(here);
                continue;
            }
        };
        if let Step::Command(command) = &step
            && repeats.add(command.place()) > limit
        {
            let message =
                format!("the program goes on after {limit} commands of lines that were carried out before");
            let diagnostic = place(Diagnostic::error(message), files, command.place());
            let expected = "expected an end; --max-commands N allows for more";
            return Err(Undecoded::Endless(vec![diagnostic.expected(expected)]));
        }
        match step {
            // All files are there.
            Step::Working | Step::Late => {}
            // Lines of loops and subroutines are read again: one remark is enough.
            Step::Warning(warning) => {
                let key = (warning.place.file, warning.place.offset, warning.to_string());
                if warned.insert(key) {
                    program.warnings.push(remark(files, &warning));
                }
            }
            Step::Command(Command::Weight(_, weight)) => {
                weights.set(&weight);
                axes = std::array::from_fn(|k| weights.apply(k, &data.axes[k], &data.channel));
                changed = true;
            }
            Step::Command(Command::Slope(_, command)) => {
                slope = if command.default { machine.slope() } else { command.kind.unwrap_or(slope) };
                changed = true;
            }
            Step::Command(Command::Motion(motion)) => {
                if std::mem::take(&mut changed) {
                    program.allow(&axes, slope, machine);
                }
                program.add(&motion, &at, &main, &mut smoothing);
                at = motion.target;
            }
            Step::Command(Command::Dwell(head, DwellTime::Seconds(time))) => {
                let kind = Kind::Dwell(time.to_num());
                program.segments.push(Segment {
                    n: head.n,
                    place: head.place,
                    kind,
                    end: numbers(&at),
                    feed: None,
                    stop: true,
                    smoothed: false,
                    tolerance: Tolerance::default(),
                    dynamics: program.latest_dynamics(),
                });
            }
            Step::Command(Command::FlushWait(_)) => program.stop(),
            Step::Command(Command::Message(head)) => {
                let text = files.with(head.place.file, |source| {
                    let from = head.place.offset as usize;
                    let text = source.text.get(from..from + usize::from(head.place.length));
                    String::from_utf8_lossy(text.unwrap_or_default()).trim().to_owned()
                });
                program.messages.push(Diagnostic::note(format!("line {}: {text}", head.place.line)));
            }
            Step::Command(Command::Pause(..)) => program.stop(),
            Step::Command(Command::Spline(..)) => program.through_points = true,
            Step::Command(Command::Hsc(_, hsc)) => {
                program.through_points = true;
                if smoothing.hsc(&hsc) {
                    program.checks_jerk(hsc.check_jerk, machine);
                }
                if !smoothing.is_on() {
                    program.ends_smoothing();
                }
            }
            Step::Command(Command::Contour(head, contour)) => {
                smoothing.contour(&contour);
                let relevant = contour.relevant_path.map_or(0.0, |path| path.to_num());
                program.relevant = program.relevant.max(relevant);
                // In a block that moves, the corner before it stays rounded.
                if !smoothing.is_on() && !head.in_motion {
                    program.ends_smoothing();
                }
                program.checks_jerk(contour.check_jerk, machine);
            }
            Step::Command(command) => {
                if let Some(told) = Told::of(&command) {
                    program.allow_beside(&told, &data.axes, machine);
                    program.beside.push(told);
                }
            }
            Step::End => return Ok(program),
        }
    }
}

fn numbers(position: &[Position]) -> Vec<f64> {
    position.iter().map(|value| value.to_num()).collect()
}

/// Centre of an arc given by its radius; the radius itself is checked where the path is made.
fn centre(start: [Position; 2], end: [Position; 2], radius: Position, clockwise: bool) -> [f64; 2] {
    let bits = |value: Position| i128::from(value.to_bits());
    let [dx, dy] = [0, 1].map(|i| bits(end[i]) - bits(start[i]));
    // Squares are exact: where half the chord is nearly the radius, rounding would move the centre.
    let square = 4 * bits(radius) * bits(radius) - dx * dx - dy * dy;
    let chord = (dx as f64).hypot(dy as f64);
    // From the middle of the chord to the left for G03 and less than 180°.
    let left = if clockwise == (radius < Position::ZERO) { 1.0 } else { -1.0 };
    let share = left * (square.max(0) as f64).sqrt() / 2.0 / chord.max(1.0);
    let lsb = 2.0_f64.powi(-32);
    let middle = |i: usize| (bits(start[i]) + bits(end[i])) as f64 / 2.0;
    [(middle(0) - share * dy as f64) * lsb, (middle(1) + share * dx as f64) * lsb]
}

fn place(diagnostic: Diagnostic, files: &Files, place: Place) -> Diagnostic {
    files.with(place.file, |source| {
        diagnostic.at(source, place.line as usize, place.column as usize, usize::from(place.length))
    })
}

/// What the decoder refused.
fn refused(files: &Files, error: &NcError) -> Diagnostic {
    explained(files, error.place, &error.to_string(), id(error.kind.id()))
}

/// What was expected stands beside the caret.
fn explained(files: &Files, at: Place, text: &str, id: String) -> Diagnostic {
    let split = text.find(" expected ").map(|at| text.split_at(at));
    match split {
        Some((what, expected)) => {
            let what = what.trim_end_matches([':', ';', ',']);
            place(Diagnostic::error(what).id(id), files, at).expected(expected.trim_start())
        }
        None => place(Diagnostic::error(text).id(id), files, at),
    }
}

/// ISG's number of a message, where it has one.
fn id(number: u32) -> String {
    if number == 0 { String::new() } else { number.to_string() }
}

/// What the decoder or the planner remarked.
pub fn remark(files: &Files, warning: &NcWarning) -> Diagnostic {
    place(Diagnostic::warning(warning.to_string()).id(id(warning.id())), files, warning.place)
}

/// What the planner refused.
pub fn refusal(files: &Files, error: &Error) -> Diagnostic {
    match error {
        Error::Nc(error) => refused(files, error),
        Error::ReducedTooSlow | Error::Unplannable => Diagnostic::error(error.to_string()),
        // All others have a place.
        _ => explained(files, error.place(), &error.to_string(), id(error.id())),
    }
}

impl Program {
    /// One without blocks.
    pub fn empty(machine: &Machine) -> Self {
        Self {
            start: vec![0.0; machine.axes.len()],
            segments: Vec::new(),
            motions: 0,
            warnings: Vec::new(),
            messages: Vec::new(),
            limits: Vec::new(),
            dynamics: Vec::new(),
            limits_beside: vec![Vec::new(); machine.axes.len()],
            through_points: false,
            free_curves: false,
            relevant: 0.032,
            beside: Vec::new(),
            refused: false,
        }
    }

    /// Axes that move beside the path.
    pub fn axes_beside(&self) -> Vec<usize> {
        let mut axes: Vec<usize> = self.beside.iter().map(|told| told.axis).collect();
        axes.sort_unstable();
        axes.dedup();
        axes
    }

    /// Takes in what axes are allowed from a block on.
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

    /// Takes in what an axis is allowed beside the path: the program's weights and slope do not count there.
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

    /// What the axis with this index may do, on the path or beside it.
    pub fn allowed_anywhere(&self, axis: usize, machine: &Machine) -> Limits {
        let beside = self.limits_beside.get(axis).into_iter().flatten();
        beside.fold(self.allowed(axis, machine), |allowed, beside| allowed.or(*beside))
    }

    /// What the resolution of the path adds to the motion of every axis on it. Beside the axes that measure
    /// the path a curve through points is steeper than its chords in places: so much steeper at most.
    pub fn resolution(&self, machine: &Machine) -> Vec<Resolution> {
        let rounds = self.through_points || self.segments.iter().any(|segment| segment.smoothed);
        let feed = machine.feed_axes();
        let mut all = vec![Resolution { steepest: 0.0, rounds }; machine.axes.len()];
        let mut from = &self.start;
        for segment in self.motions() {
            let (travel, _) = segment.travel(from);
            let path = path(machine, &travel);
            for (k, (of, travel)) in all.iter_mut().zip(&travel).enumerate().filter(|_| path > 0.0) {
                let steeper = if self.through_points && !feed.contains(&k) { 8.0 } else { 1.0 };
                of.steepest = of.steepest.max(steeper * travel / path);
            }
            from = &segment.end;
        }
        all
    }

    /// Which weights and slope are in force.
    fn latest_dynamics(&self) -> u32 {
        self.dynamics.len().saturating_sub(1) as u32
    }

    /// What the axis with this index may do in a block.
    fn allowed_in(&self, segment: &Segment, axis: usize, machine: &Machine) -> Limits {
        let dynamics = self.dynamics.get(segment.dynamics as usize).and_then(|axes| axes.get(axis));
        dynamics.copied().unwrap_or_else(|| self.allowed(axis, machine))
    }

    /// What the axis with this index may do somewhere on the path.
    pub fn allowed(&self, axis: usize, machine: &Machine) -> Limits {
        self.limits
            .get(axis)
            .copied()
            .unwrap_or_else(|| limits(&machine.axes[axis].planned(&machine.channel), machine.slope()))
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
            // No motion; an exact stop then belongs to the end of the block before.
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

    /// The corner behind the last motion is not rounded.
    fn ends_smoothing(&mut self) {
        if let Some(last) = self.segments.last_mut() {
            last.smoothed = false;
        }
    }

    fn stop(&mut self) {
        if let Some(last) = self.segments.last_mut() {
            last.stop = true;
        }
    }

    /// The blocks that move.
    pub fn motions(&self) -> impl Iterator<Item = &Segment> {
        self.segments.iter().filter(|segment| !matches!(segment.kind, Kind::Dwell(_)))
    }

    /// Of every motion, whether a standstill at its end is programmed, also by a dwell behind it.
    pub fn stops(&self) -> Vec<bool> {
        let mut stops: Vec<bool> = Vec::with_capacity(self.motions);
        for segment in &self.segments {
            match (&segment.kind, stops.last_mut()) {
                (Kind::Dwell(_), Some(last)) => *last = true,
                (Kind::Dwell(_), None) => {}
                _ => stops.push(segment.stop),
            }
        }
        stops
    }

    /// Seconds of programmed dwell.
    pub fn dwell_s(&self) -> f64 {
        self.segments
            .iter()
            .map(|segment| if let Kind::Dwell(time) = segment.kind { time } else { 0.0 })
            .sum()
    }

    /// In one line.
    pub fn describe(&self) -> String {
        let arcs = self.motions().filter(|segment| matches!(segment.kind, Kind::Arc { .. })).count();
        let waits = self.segments.len() - self.motions;
        format!(
            "{} motion block{} ({arcs} arc{}), {waits} dwell{}, {} warning{}",
            self.motions,
            plural(self.motions),
            plural(arcs),
            plural(waits),
            self.warnings.len(),
            plural(self.warnings.len()),
        )
    }

    /// The path speed of every motion.
    pub fn speeds(&self, machine: &Machine) -> Vec<PathSpeed> {
        let mut at = self.start.as_slice();
        let mut speeds = Vec::with_capacity(self.motions);
        for segment in self.motions() {
            let programmed = segment.feed.map(|feed| feed / 60.0);
            speeds.push(PathSpeed { programmed, limit: self.limit(machine, at, segment) });
            at = &segment.end;
        }
        speeds
    }

    /// The feed of a block that begins at `start` along the main axes, mm/min: the programmed one counts
    /// along the feed axes. Where no main axis moves, that.
    pub fn feed_in_space(machine: &Machine, start: &[f64], segment: &Segment) -> Option<f64> {
        let (travel, _) = segment.travel(start);
        let (space, path) = (length(&travel, &machine.main_axes()), path(machine, &travel));
        segment.feed.map(|feed| if space > 0.0 && space != path { feed * (space / path) } else { feed })
    }

    /// The path speed that the axes allow: their speeds, and on an arc the acceleration towards its centre.
    fn limit(&self, machine: &Machine, start: &[f64], segment: &Segment) -> f64 {
        let (mut travel, arc) = segment.travel(start);
        let path = path(machine, &travel);
        let mut limit = f64::INFINITY;
        if let Some(Turn { plane, radius, along }) = arc {
            // At some point, or nearly, this axis too has all of the speed.
            travel[plane[1]] = along;
            for axis in plane {
                let allowed = self.allowed_in(segment, axis, machine);
                let accel = allowed.accel_feed.min(allowed.brake_feed).min(allowed.accel);
                limit = limit.min((accel * radius).sqrt() * path / along);
            }
        }
        let moving = travel.iter().enumerate().filter(|(_, travel)| **travel > 0.0);
        let speeds = moving.map(|(axis, travel)| {
            let allowed = self.allowed_in(segment, axis, machine);
            let speed = if segment.feed.is_some() { allowed.speed } else { allowed.speed_rapid };
            speed * path / travel
        });
        speeds.fold(limit, f64::min)
    }

    /// Up to three axes that show best what moves: the main axes, or others where no main axis moves.
    pub fn shown_axes(&self, machine: &Machine) -> Vec<usize> {
        let main = machine.main_axes();
        let moves = |axis: &usize| self.motions().any(|segment| segment.end[*axis] != self.start[*axis]);
        let circles = self.motions().any(|segment| matches!(segment.kind, Kind::Arc { .. }));
        if circles || main.iter().any(moves) {
            return main;
        }
        let others: Vec<usize> = (0..machine.axes.len()).filter(moves).take(3).collect();
        if others.is_empty() { main } else { others }
    }

    /// All axes that move; the main axes where there are none.
    pub fn moving_axes(&self, machine: &Machine) -> Vec<usize> {
        let moves = |axis: &usize| {
            self.motions().any(|segment| match segment.kind {
                Kind::Arc { plane, .. } if plane.contains(axis) => true,
                _ => segment.end[*axis] != self.start[*axis],
            })
        };
        let moving: Vec<usize> = (0..machine.axes.len()).filter(moves).collect();
        if moving.is_empty() { machine.main_axes() } else { moving }
    }

    /// The contour in up to three axes, arcs in small chords: stretches of feed and of rapid motion, connected.
    pub fn polylines(&self, axes: &[usize]) -> Vec<Stretch> {
        let pick = |point: &[f64]| {
            let mut at = [0.0; 3];
            for (value, &index) in at.iter_mut().zip(axes) {
                *value = point[index];
            }
            at
        };
        let mut stretches: Vec<Stretch> = Vec::new();
        let mut start = self.start.as_slice();
        for segment in self.motions() {
            let rapid = segment.feed.is_none();
            if stretches.last().is_none_or(|stretch| stretch.rapid != rapid) {
                stretches.push(Stretch { rapid, line: vec![pick(start)] });
            }
            if let Some(Stretch { line, .. }) = stretches.last_mut() {
                if let Kind::Arc { plane, centre, clockwise } = segment.kind {
                    chords(line, start, &segment.end, plane, centre, clockwise, &pick);
                }
                line.push(pick(&segment.end));
            }
            start = &segment.end;
        }
        stretches
    }
}

/// A part of the contour, all of it rapid motion or none.
pub struct Stretch {
    pub rapid: bool,
    pub line: Vec<[f64; 3]>,
}

/// Ending of a counted word.
pub fn plural(count: usize) -> &'static str {
    if count == 1 { "" } else { "s" }
}

/// Signed angle of an arc; a whole turn where start and end are one point.
pub fn sweep(start: [f64; 2], end: [f64; 2], centre: [f64; 2], clockwise: bool) -> f64 {
    let angle = |point: [f64; 2]| (point[1] - centre[1]).atan2(point[0] - centre[0]);
    let turn = std::f64::consts::TAU;
    let swept = angle(end) - angle(start);
    let swept = (if clockwise { -swept } else { swept }).rem_euclid(turn);
    let swept = if swept < 1e-9 { turn } else { swept };
    if clockwise { -swept } else { swept }
}

fn chords(
    line: &mut Vec<[f64; 3]>,
    start: &[f64],
    end: &[f64],
    plane: [usize; 2],
    centre: [f64; 2],
    clockwise: bool,
    pick: &impl Fn(&[f64]) -> [f64; 3],
) {
    let at = |point: &[f64]| plane.map(|index| point[index]);
    let swept = sweep(at(start), at(end), centre, clockwise);
    let radius = |point: &[f64]| (at(point)[0] - centre[0]).hypot(at(point)[1] - centre[1]);
    let first = (start[plane[1]] - centre[1]).atan2(start[plane[0]] - centre[0]);
    let count = ((swept.abs() / std::f64::consts::TAU) * 120.0).ceil().max(2.0) as usize;
    for i in 1..count {
        let share = i as f64 / count as f64;
        let mut point: Vec<f64> =
            start.iter().zip(end).map(|(from, to)| from + (to - from) * share).collect();
        let length = radius(start) + (radius(end) - radius(start)) * share;
        let (sin, cos) = (first + swept * share).sin_cos();
        point[plane[0]] = centre[0] + length * cos;
        point[plane[1]] = centre[1] + length * sin;
        line.push(pick(&point));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_programs_are_not_endless_and_loops_are_counted() {
        let place = |offset| Place { offset, ..Place::NONE };
        let mut repeats = Repeats::default();
        // Three commands per line.
        assert!((0..1_500_000).all(|i| repeats.add(place(10 * (i / 3))) == 0));
        // Back to a line, and twice over two.
        let again = [30, 30, 40, 50, 40, 50].map(|offset| repeats.add(place(offset)));
        assert_eq!(again, [1, 2, 3, 4, 5, 6]);
        // A loop of one line.
        let mut repeats = Repeats::default();
        let last = (0..1000).map(|_| repeats.add(place(7))).last();
        assert_eq!(last, Some(1000 - u64::from(LINE)));
    }

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

    #[test]
    fn axes_limit_the_path_speed() {
        let machine = Machine::built_in();
        let program = Program::empty(&machine);
        let limit = |kind, end: [f64; 3], feed| {
            let end = end.to_vec();
            let (smoothed, tolerance) = (false, Tolerance::default());
            let place = Place::default();
            let (stop, dynamics) = (false, 0);
            let segment = Segment { n: 0, place, kind, end, feed, stop, smoothed, tolerance, dynamics };
            program.limit(&machine, &[10.0, 0.0, 0.0], &segment)
        };
        // 1000 mm/s per axis: 3-4-5, and two thirds of the way in Z.
        assert!((limit(Kind::Line, [13.0, 4.0, 0.0], Some(60.0)) - 1250.0).abs() < 1e-9);
        assert!((limit(Kind::Line, [12.0, 1.0, 2.0], None) - 1500.0).abs() < 1e-9);
        // 2000 mm/s² on a radius of 10 mm; a helix as steep as that is faster along its path.
        let arc = || Kind::Arc { plane: [0, 1], centre: [0.0, 0.0], clockwise: false };
        let flat = 20_000.0_f64.sqrt();
        assert!((limit(arc(), [0.0, 10.0, 0.0], Some(60.0)) - flat).abs() < 1e-9);
        let climb = 5.0 * std::f64::consts::PI;
        let helix = limit(arc(), [0.0, 10.0, climb], Some(60.0));
        assert!((helix - flat * 2.0_f64.sqrt()).abs() < 1e-9);
    }

    #[test]
    fn sweeps_go_the_programmed_way() {
        let quarter = std::f64::consts::FRAC_PI_2;
        let swept = |end, clockwise| sweep([10.0, 0.0], end, [0.0, 0.0], clockwise);
        assert!((swept([0.0, 10.0], false) - quarter).abs() < 1e-12);
        assert!((swept([0.0, 10.0], true) + 3.0 * quarter).abs() < 1e-12);
        assert!((swept([10.0, 0.0], true) + 4.0 * quarter).abs() < 1e-12);
    }
}

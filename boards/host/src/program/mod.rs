//! The program as decoded, before anything is planned: for the contour, the picture and warnings.
//!
//! A separate pass of the decoder makes this program, so the programmed path does not depend on path,
//! look-ahead and slope.
mod decode;
mod rehearse;
pub mod repeats;
mod shape;
pub mod told;
mod transformed;

use crate::beside::Told;
use crate::diagnose::Diagnostic;
use crate::machine::{Limits, Machine, limits};
use crate::resolution::Resolution;
use crate::tolerance::Tolerance;
pub use decode::decode;
use glidepath::nc::Place;
pub use rehearse::{Around, rehearse};
pub use shape::{Stretch, sweep};
pub use told::{refusal, remark};

/// A block of the contour. Coordinates are absolute, one per axis of the machine, exact in f64.
pub struct Segment {
    /// Programmed N number.
    pub n: u32,
    /// Place in the text.
    pub place: Place,
    /// Shape.
    pub kind: Kind,
    /// End point.
    pub end: Vec<f64>,
    /// Feed in mm/min; none in rapid motion.
    pub feed: Option<f64>,
    /// Whether the program demands a standstill at its end.
    pub stop: bool,
    /// Whether the corner at its end may be rounded, or belongs to a smoothed path.
    pub smoothed: bool,
    /// Permitted deviation from the block, where it is monitored.
    pub tolerance: Tolerance,
    /// Index into [`Program::dynamics`].
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
    /// Dwell of this number of seconds, without motion.
    Dwell(f64),
}

/// Data that turn a straight travel into an arc.
struct Turn {
    plane: [usize; 2],
    radius: f64,
    /// Length in the plane.
    along: f64,
}

impl Segment {
    /// Travel of every axis from `start`. In an arc, the first axis of its plane has the length of the arc,
    /// and the second axis has 0.
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

/// Path length: along the feed axes; if no feed axis moves, along the main axes, then along all others. The
/// length is at least a 1024th of the travel of any axis, and a 64th if the feed axes are not the main axes.
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
    /// Programmed speed; none in rapid motion.
    pub programmed: Option<f64>,
    /// Speed that the axes permit in this direction.
    pub limit: f64,
}

/// A decoded program.
pub struct Program {
    /// Start position of all axes.
    pub start: Vec<f64>,
    /// All blocks with motion or dwell.
    pub segments: Vec<Segment>,
    /// Number of blocks with motion.
    pub motions: usize,
    /// Warnings of the decoder.
    pub warnings: Vec<Diagnostic>,
    /// Messages of the program to the operator.
    pub messages: Vec<Diagnostic>,
    /// Limits of each axis with the highest weights of the program's motions.
    pub limits: Vec<Limits>,
    /// Limits of each axis, for each part of the program with equal weights and slope.
    pub dynamics: Vec<Vec<Limits>>,
    /// Limits of each axis in each of its independent motions, in their order.
    pub limits_beside: Vec<Vec<Limits>>,
    /// #HSC or #SPLINE: curves through points, or near points.
    pub through_points: bool,
    /// Whether jerk in corner curves is not limited: CHECK_JERK=0, P-CHAN-00110 = 0.
    pub free_curves: bool,
    /// Blocks up to this length may be left out at a corner: 32 µm, or the highest RELEVANT_PATH, mm.
    pub relevant: f64,
    /// Independent motions of axes, in the order of the program.
    pub beside: Vec<Told>,
    /// Some lines could not be decoded; this program has only the other lines.
    pub refused: bool,
    /// Motion blocks at which the transformation changes; 0: no transformation.
    pub transformed: Vec<(usize, u16)>,
    /// Passes of real-time loops, if a rehearsal made this program.
    pub passes: Option<u32>,
}

impl Program {
    /// A program without blocks.
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
            transformed: Vec::new(),
            passes: None,
        }
    }

    /// The transformation of a motion block: its identifier, 0 for none.
    pub fn transformation(&self, block: u32) -> u16 {
        let before = self.transformed.iter().take_while(|(from, _)| *from <= block as usize);
        before.last().map_or(0, |(_, id)| *id)
    }

    /// Axes that move independently of the path.
    pub fn axes_beside(&self) -> Vec<usize> {
        let mut axes: Vec<usize> = self.beside.iter().map(|told| told.axis).collect();
        axes.sort_unstable();
        axes.dedup();
        axes
    }

    /// Limits of the axis with this index, on the path or independently.
    pub fn allowed_anywhere(&self, axis: usize, machine: &Machine) -> Limits {
        let beside = self.limits_beside.get(axis).into_iter().flatten();
        beside.fold(self.allowed(axis, machine), |allowed, beside| allowed.or(*beside))
    }

    /// Effect of the path's resolution on the motion of every axis. For axes that do not measure the path, a
    /// curve through points may be steeper than its chords; the value includes the highest possible factor.
    pub fn resolution(&self, machine: &Machine) -> Vec<Resolution> {
        let rounds = self.through_points || self.segments.iter().any(|segment| segment.smoothed);
        let feed = machine.feed_axes();
        let mut all = vec![Resolution { steepest: 0.0, rounds }; machine.axes.len()];
        for (from, segment) in self.steps() {
            let (travel, _) = segment.travel(from);
            let path = path(machine, &travel);
            for (k, (of, travel)) in all.iter_mut().zip(&travel).enumerate().filter(|_| path > 0.0) {
                let steeper = if self.through_points && !feed.contains(&k) { 8.0 } else { 1.0 };
                of.steepest = of.steepest.max(steeper * travel / path);
            }
        }
        all
    }

    /// Limits of the axis with this index in a block.
    fn allowed_in(&self, segment: &Segment, axis: usize, machine: &Machine) -> Limits {
        let dynamics = self.dynamics.get(segment.dynamics as usize).and_then(|axes| axes.get(axis));
        dynamics.copied().unwrap_or_else(|| self.allowed(axis, machine))
    }

    /// Limits of the axis with this index anywhere on the path.
    pub fn allowed(&self, axis: usize, machine: &Machine) -> Limits {
        self.limits
            .get(axis)
            .copied()
            .unwrap_or_else(|| limits(&machine.axes[axis].planned(&machine.channel), machine.slope()))
    }

    /// The blocks with motion, each with its start. After a change of the transformation the start differs
    /// from the end of the block before.
    pub fn steps(&self) -> impl Iterator<Item = (&[f64], &Segment)> {
        let starts = std::iter::once(&self.start).chain(self.segments.iter().map(|segment| &segment.end));
        let steps = starts.map(Vec::as_slice).zip(&self.segments);
        steps.filter(|(_, segment)| !matches!(segment.kind, Kind::Dwell(_)))
    }

    /// The blocks with motion.
    pub fn motions(&self) -> impl Iterator<Item = &Segment> {
        self.segments.iter().filter(|segment| !matches!(segment.kind, Kind::Dwell(_)))
    }

    /// For each motion, whether the program demands a standstill at its end, also by a following dwell.
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

    /// The path speed of every motion.
    pub fn speeds(&self, machine: &Machine) -> Vec<PathSpeed> {
        let mut speeds = Vec::with_capacity(self.motions);
        for (at, segment) in self.steps() {
            let programmed = segment.feed.map(|feed| feed / 60.0);
            speeds.push(PathSpeed { programmed, limit: self.limit(machine, at, segment) });
        }
        speeds
    }

    /// The feed of a block from `start` along the main axes, mm/min. The programmed feed refers to the feed
    /// axes. If no main axis moves, the programmed feed is returned.
    pub fn feed_in_space(machine: &Machine, start: &[f64], segment: &Segment) -> Option<f64> {
        let (travel, _) = segment.travel(start);
        let (space, path) = (length(&travel, &machine.main_axes()), path(machine, &travel));
        segment.feed.map(|feed| if space > 0.0 && space != path { feed * (space / path) } else { feed })
    }

    /// The path speed that the axes permit: by their speed limits, and on an arc by the acceleration towards
    /// its centre.
    fn limit(&self, machine: &Machine, start: &[f64], segment: &Segment) -> f64 {
        let (mut travel, arc) = segment.travel(start);
        let path = path(machine, &travel);
        let mut limit = f64::INFINITY;
        if let Some(Turn { plane, radius, along }) = arc {
            // Near some point of the arc, this axis moves with the whole path speed.
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

    /// Up to three axes for the picture: the main axes, or others if no main axis moves.
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

    /// All axes that move, or the main axes if no axis moves.
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
}

/// Ending of a counted word.
pub fn plural(count: usize) -> &'static str {
    if count == 1 { "" } else { "s" }
}

#[cfg(test)]
mod tests {
    use super::*;

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
}

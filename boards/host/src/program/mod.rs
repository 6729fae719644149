//! The program as decoded, before anything is planned: for the contour, the picture and warnings.
//!
//! An own pass of the decoder, so that what is shown as programmed owes nothing to path, look-ahead and
//! slope.
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
    /// Motion blocks from which on a transformation is in force, or none (0).
    pub transformed: Vec<(usize, u16)>,
    /// Passes of real-time loops, if the program is what a rehearsal has carried out.
    pub passes: Option<u32>,
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
            transformed: Vec::new(),
            passes: None,
        }
    }

    /// The transformation of a motion block: its identifier, 0 for none.
    pub fn transformation(&self, block: u32) -> u16 {
        let before = self.transformed.iter().take_while(|(from, _)| *from <= block as usize);
        before.last().map_or(0, |(_, id)| *id)
    }

    /// Axes that move beside the path.
    pub fn axes_beside(&self) -> Vec<usize> {
        let mut axes: Vec<usize> = self.beside.iter().map(|told| told.axis).collect();
        axes.sort_unstable();
        axes.dedup();
        axes
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

    /// The blocks that move, each with where it begins: where a transformation changes, that is another place than
    /// the end of the block before.
    pub fn steps(&self) -> impl Iterator<Item = (&[f64], &Segment)> {
        let starts = std::iter::once(&self.start).chain(self.segments.iter().map(|segment| &segment.end));
        let steps = starts.map(Vec::as_slice).zip(&self.segments);
        steps.filter(|(_, segment)| !matches!(segment.kind, Kind::Dwell(_)))
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

    /// The path speed of every motion.
    pub fn speeds(&self, machine: &Machine) -> Vec<PathSpeed> {
        let mut speeds = Vec::with_capacity(self.motions);
        for (at, segment) in self.steps() {
            let programmed = segment.feed.map(|feed| feed / 60.0);
            speeds.push(PathSpeed { programmed, limit: self.limit(machine, at, segment) });
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

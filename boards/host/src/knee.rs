//! The angle of the programmed path at the transition between two motions.
use crate::program::{Kind, Program, Segment, sweep};

/// A transition with a larger angle is a corner, degrees; smaller angles are rounding of coordinates.
pub const SHARP: f64 = 0.01;

/// Directions of a motion at its start and end: travel of every axis, in any scale.
fn directions(start: &[f64], segment: &Segment) -> [Vec<f64>; 2] {
    let travel: Vec<f64> = segment.end.iter().zip(start).map(|(to, from)| to - from).collect();
    let Kind::Arc { plane, centre, clockwise } = segment.kind else { return [travel.clone(), travel] };
    let [from, to] = [start, &segment.end].map(|point| plane.map(|axis| point[axis]));
    let swept = sweep(from, to, centre, clockwise);
    [from, to].map(|point| {
        let mut direction = travel.clone();
        // The radius, rotated by a quarter turn, times the angle has the length of the arc.
        direction[plane[0]] = -(point[1] - centre[1]) * swept;
        direction[plane[1]] = (point[0] - centre[0]) * swept;
        direction
    })
}

/// Angle between two directions, degrees.
fn angle(one: &[f64], other: &[f64]) -> f64 {
    let length = |v: &[f64]| v.iter().map(|value| value * value).sum::<f64>().sqrt();
    let lengths = [length(one), length(other)];
    if lengths.contains(&0.0) {
        return 0.0;
    }
    // Computed from both diagonals of the rhombus, so small angles are exact too.
    let unit = |v: &[f64], length: f64| v.iter().map(|value| value / length).collect::<Vec<f64>>();
    let (a, b) = (unit(one, lengths[0]), unit(other, lengths[1]));
    let diagonal = |sign: f64| length(&a.iter().zip(&b).map(|(a, b)| a + sign * b).collect::<Vec<f64>>());
    (2.0 * diagonal(-1.0).atan2(diagonal(1.0))).to_degrees()
}

/// Returns for each motion the angle of the path at its end, degrees; 0 at the end of the last motion.
pub fn knees(program: &Program) -> Vec<f64> {
    let mut knees = Vec::with_capacity(program.motions);
    let mut exit: Option<Vec<f64>> = None;
    for (at, segment) in program.steps() {
        let [entry, next] = directions(at, segment);
        if let Some(exit) = exit.replace(next) {
            knees.push(angle(&exit, &entry));
        }
    }
    knees.extend(exit.map(|_| 0.0));
    knees
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::machine::Machine;
    use crate::tolerance::Tolerance;
    use glidepath::nc::Place;

    #[test]
    fn knees_are_angles_between_tangents() {
        let segment = |kind, end: [f64; 3]| Segment {
            n: 0,
            place: Place::default(),
            kind,
            end: end.to_vec(),
            feed: Some(1.0),
            stop: false,
            smoothed: false,
            tolerance: Tolerance::default(),
            dynamics: 0,
        };
        let arc = Kind::Arc { plane: [0, 1], centre: [10.0, 10.0], clockwise: false };
        let segments = vec![
            segment(Kind::Line, [10.0, 0.0, 0.0]),
            segment(arc, [20.0, 10.0, 0.0]),
            segment(Kind::Line, [20.0, 20.0, 0.0]),
            segment(Kind::Line, [30.0, 20.0, 0.0]),
            segment(Kind::Line, [20.0, 20.0, 0.0]),
        ];
        let machine = Machine::built_in();
        let knees = knees(&Program { segments, motions: 5, ..Program::empty(&machine) });
        let expected = [0.0, 0.0, 90.0, 180.0, 0.0];
        assert!(
            knees.iter().zip(expected).all(|(knee, expected)| (knee - expected).abs() < 1e-9),
            "{knees:?}"
        );
    }
}

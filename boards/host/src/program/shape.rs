//! The contour as lines: arcs as chords, parts at feed and parts in rapid motion.
use super::{Kind, Program};

impl Program {
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
        let mut end = self.start.as_slice();
        for (start, segment) in self.steps() {
            let rapid = segment.feed.is_none();
            if start != end || stretches.last().is_none_or(|stretch| stretch.rapid != rapid) {
                stretches.push(Stretch { rapid, line: vec![pick(start)] });
            }
            if let Some(Stretch { line, .. }) = stretches.last_mut() {
                if let Kind::Arc { plane, centre, clockwise } = segment.kind {
                    chords(line, start, &segment.end, plane, centre, clockwise, &pick);
                }
                line.push(pick(&segment.end));
            }
            end = &segment.end;
        }
        stretches
    }
}

/// A part of the contour, either in rapid motion or at feed.
pub struct Stretch {
    pub rapid: bool,
    pub line: Vec<[f64; 3]>,
}

/// Signed angle of an arc; a whole turn if start and end are equal.
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
    fn sweeps_go_the_programmed_way() {
        let quarter = std::f64::consts::FRAC_PI_2;
        let swept = |end, clockwise| sweep([10.0, 0.0], end, [0.0, 0.0], clockwise);
        assert!((swept([0.0, 10.0], false) - quarter).abs() < 1e-12);
        assert!((swept([0.0, 10.0], true) + 3.0 * quarter).abs() < 1e-12);
        assert!((swept([10.0, 0.0], true) + 4.0 * quarter).abs() < 1e-12);
    }
}

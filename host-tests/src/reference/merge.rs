//! Merges lines with the same direction and feed, as long as the merged line is within a tolerance of every
//! dropped point. All points are stored and checked each time.
use super::geometry::{Contour, Element, Shape};
use super::limits::{Machine, path_length};
use super::planner::ways;
use crate::tolerance;

/// Length above which a line does not grow, mm.
const LONGEST: f64 = 1024.0;

/// A merged line is long enough at this number of distances from a stop to the highest speed.
const WAYS: f64 = 2.0;

/// Longest time after which a corner is expected to be unnoticeable, ticks.
const LONGEST_TIME: f64 = 1024.0;

/// Highest angle of a block, and at most twice the angle that the tolerance explains, times 1 + tangent.
const TURN: f64 = 0.125;

/// The contour with lines merged.
pub fn merged(contour: &Contour, machine: &Machine) -> Contour {
    let mut elements: Vec<Element> = Vec::new();
    let mut points: Vec<Vec<f64>> = Vec::new();
    for element in &contour.elements {
        if let Some(last) = elements.last_mut()
            && let Some(line) = joined(last, element, &points, 0.0)
        {
            points.push(last.to.clone());
            *last = line;
            let limits = machine.block(last, 0.0);
            let time = (tolerance::MERGED / machine.unseen_knee(last.feed.is_none())).min(LONGEST_TIME);
            last.long = path_length(last) >= (WAYS * ways(&limits)).max(limits.v * time);
        } else {
            points.clear();
            elements.push(element.clone());
        }
    }
    Contour { start: contour.start.clone(), elements }
}

/// Permitted deviation of the motion from the contour, which is larger where two blocks may be merged. Where
/// rounding decides ([`tolerance::MERGED_ROUNDING`]), both results are permitted.
pub fn path_tolerance(contour: &Contour) -> f64 {
    let rounding = tolerance::MERGED_ROUNDING;
    let merges = contour.elements.windows(2).any(|pair| joined(&pair[0], &pair[1], &[], rounding).is_some());
    if merges { tolerance::MERGED_PATH } else { tolerance::PATH }
}

/// Merges two lines, if all dropped `points` and the point between both lines permit it: on each axis within
/// the tolerance, plus `rounding` times 1 + tangent.
fn joined(last: &Element, next: &Element, points: &[Vec<f64>], rounding: f64) -> Option<Element> {
    let lines = last.shape == Shape::Line && next.shape == Shape::Line;
    if !lines || last.stop || last.long || last.feed != next.feed {
        return None;
    }
    let tangent = |e: &Element| -> Vec<f64> {
        let length = path_length(e);
        (0..e.from.len()).map(|k| e.travel(k) / length).collect()
    };
    let line = Element { from: last.from.clone(), blocks: last.blocks + next.blocks, ..next.clone() };
    let (whole, [s, l]) = (path_length(&line), [last, next].map(path_length));
    let turn = |room: f64| 2.0 * room * (s + l) / (s * l);
    let bound = turn(tolerance::MERGED + rounding);
    let here = tangent(last);
    let turns = here.iter().zip(tangent(next)).any(|(a, b)| (a - b).abs() > bound * (1.0 + a.abs()));
    if turns || turn(tolerance::MERGED - rounding) >= TURN || whole <= s || whole > LONGEST {
        return None;
    }
    let direction = tangent(&line);
    let mut part = line.clone();
    let mut near = |point: &Vec<f64>| {
        // A line from the start with the same length as the distance to the point.
        part.to.clone_from(point);
        let to = path_length(&part);
        (0..point.len()).all(|k| {
            let main = line.main.contains(&k);
            let steep = 1.0 + ((point[k] - line.from[k]) / to).abs();
            let wide = if main { 1.0 } else { steep };
            (line.from[k] + direction[k] * to - point[k]).abs() <= wide * tolerance::MERGED + steep * rounding
        })
    };
    (near(&last.to) && points.iter().all(near)).then_some(line)
}

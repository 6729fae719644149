//! Where on the programmed contour is every set point, in order?
//!
//! A contour may pass the same place twice or turn back on itself. Then a set point alone does not show its
//! position on the contour, so all candidates are followed. A *candidate* is a point of the contour within
//! the tolerance of the set point. It must be reachable from a candidate of the row before, forward, with at
//! most the feed. The motion follows the contour in order if a candidate of the last row is the end of the
//! contour.
use super::ROUNDING;
use crate::reference::geometry::{Contour, Element, Shape};
use crate::reference::limits::path_length;
use crate::trace::Trace;

/// The motion along the contour.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Course {
    /// Distance from the contour's start at every row, mm of path (degrees in blocks without main axes).
    pub s: Vec<f64>,
    /// Element of every row.
    pub element: Vec<usize>,
    /// Largest distance of a set point from the contour in the main axes, mm.
    pub error: f64,
    /// Largest deviation of a tracking axis, degrees.
    pub tracking_error: f64,
}

/// A place on the contour where a row can be.
#[derive(Clone, Copy, Debug)]
struct Candidate {
    element: usize,
    u: f64,
    s: f64,
    main: f64,
    tracking: f64,
    /// Candidate of the row before with the smallest change of speed.
    before: usize,
    /// Distance from it.
    step: f64,
}

/// Path length: of the main axes, or of the tracking axes if these move alone.
fn length(element: &Element) -> f64 {
    let main = element.main_length();
    if main > 0.0 { main } else { element.tracking_length() }
}

/// The length for speeds: the same, or that of other feed axes.
pub fn measured(element: &Element) -> f64 {
    if element.feed_axes == element.main { length(element) } else { path_length(element) }
}

/// Follows the contour in order. Every set point must lie within `tolerance` (mm; degrees for tracking axes,
/// plus what the tolerance in the plane means for them) of the contour, not before its predecessor, and not
/// further on than the feed (`v_rapid` in rapid blocks, mm/s) allows within a tick. The last one must be the
/// end.
///
/// # Errors
/// The first row that does not.
pub fn path(trace: &Trace, contour: &Contour, tolerance: f64, v_rapid: f64) -> Result<Course, String> {
    let lengths: Vec<f64> = contour.elements.iter().map(measured).collect();
    let begins: Vec<f64> = lengths
        .iter()
        .scan(0.0, |at, length| {
            *at += length;
            Some(*at - length)
        })
        .collect();
    let total: f64 = lengths.iter().sum();
    let steps: Vec<f64> =
        contour.elements.iter().map(|e| e.feed.map_or(v_rapid, |f| f / 60.0) * trace.cycle).collect();
    let slack = 4.0 * tolerance;

    let mut rows: Vec<Vec<Candidate>> = Vec::with_capacity(trace.len());
    for tick in 0..trace.len() {
        let q = trace.mm(tick);
        let start = Candidate { element: 0, u: 0.0, s: 0.0, main: 0.0, tracking: 0.0, before: 0, step: 0.0 };
        let previous = rows.last().map_or_else(|| vec![start], Clone::clone);
        let mut row: Vec<Candidate> = Vec::new();
        let mut nearest = Deviation { u: 0.0, main: f64::INFINITY, tracking: 0.0, inside: false };
        for (before, from) in previous.iter().enumerate() {
            let mut fastest = 0.0_f64;
            for element in from.element..contour.elements.len() {
                fastest = fastest.max(steps[element]);
                let farthest = from.s + fastest * (1.0 + 1e-9) + slack;
                if begins[element] > farthest {
                    break;
                }
                let near = if element == from.element { from.u } else { 0.0 };
                let off = Deviation::of(&contour.elements[element], &q, near, tolerance);
                if off.main < nearest.main {
                    nearest = off;
                }
                let u = off.u.clamp(0.0, 1.0);
                let s = begins[element] + u * lengths[element];
                if !off.inside || s > farthest || s < from.s - slack {
                    continue;
                }
                let s = s.max(from.s);
                let step = s - from.s;
                let change = (step - from.step).abs();
                let Deviation { main, tracking, .. } = off;
                let new = Candidate { element, u, s, main, tracking, before, step };
                match row.iter_mut().find(|c| c.element == element) {
                    Some(c) if change < (c.step - previous[c.before].step).abs() => *c = new,
                    Some(_) => {}
                    None => row.push(new),
                }
            }
        }
        if row.is_empty() {
            let Deviation { main, tracking, u, .. } = nearest;
            let from: Vec<usize> = previous.iter().map(|c| c.element).collect();
            return Err(format!(
                "tick {tick}: {q:?} is {main} mm (tracking {tracking}) off at {u}, after elements {from:?}"
            ));
        }
        rows.push(row);
    }

    let last = rows.last().map_or(&[][..], |row| row);
    let reached = last.iter().enumerate().max_by(|a, b| a.1.s.total_cmp(&b.1.s));
    let Some((mut at, end)) = reached else {
        return if total == 0.0 { Ok(Course::default()) } else { Err("no motion".to_owned()) };
    };
    if end.s < total - slack {
        return Err(format!("{} mm of the contour are missing", total - end.s));
    }
    let mut course = Course::default();
    for row in rows.iter().rev() {
        let candidate = row[at];
        course.s.push(candidate.s);
        course.element.push(candidate.element);
        // Near a transition both elements are candidates; the distance from the contour is that of the nearer
        // one.
        let least = |off: fn(&Candidate) -> f64| row.iter().map(off).fold(f64::INFINITY, f64::min);
        course.error = course.error.max(least(|c| c.main));
        course.tracking_error = course.tracking_error.max(least(|c| c.tracking));
        at = candidate.before;
    }
    course.s.reverse();
    course.element.reverse();
    Ok(course)
}

impl Course {
    /// Highest acceleration of the distance along the contour, mm/s², with its allowance: the effect of
    /// position errors up to the measured error. A motion that skips a part of the contour shows here, for
    /// every length of this part.
    pub fn acceleration(&self, cycle: f64) -> (f64, f64, usize) {
        let rest = [*self.s.last().unwrap_or(&0.0); 2];
        let padded: Vec<f64> = [0.0; 2].into_iter().chain(self.s.iter().copied()).chain(rest).collect();
        let (mut largest, mut tick) = (0.0, 0);
        for (i, w) in padded.windows(3).enumerate() {
            let value = (w[2] - 2.0 * w[1] + w[0]).abs() / (cycle * cycle);
            if value > largest {
                (largest, tick) = (value, i);
            }
        }
        (largest, 4.0 * (self.error + 4.0 * ROUNDING) / (cycle * cycle), tick)
    }
}

#[derive(Clone, Copy)]
struct Deviation {
    u: f64,
    main: f64,
    tracking: f64,
    inside: bool,
}

impl Deviation {
    /// At the point nearest in all axes, or in the main axes only. If an axis moves far while the path is
    /// short, the first point is that of this axis.
    fn of(element: &Element, q: &[f64], near: f64, tolerance: f64) -> Self {
        let off = Self::at(element, q, element.project(q, near), tolerance);
        if off.inside || element.shape != Shape::Line || element.main_length() == 0.0 {
            return off;
        }
        let along = Self::at(element, q, element.project_on(q, &element.main), tolerance);
        if along.inside { along } else { off }
    }

    fn at(element: &Element, q: &[f64], u: f64, tolerance: f64) -> Self {
        let p = element.at(u.clamp(0.0, 1.0));
        let main = element.main.iter().map(|&k| (q[k] - p[k]).powi(2)).sum::<f64>().sqrt();
        let mut tracking = 0.0_f64;
        let mut inside = main <= tolerance;
        for k in (0..q.len()).filter(|k| !element.main.contains(k)) {
            let off = (q[k] - p[k]).abs();
            tracking = tracking.max(off);
            inside &= off <= tolerance * (1.0 + element.travel(k).abs() / measured(element).max(1e-9));
        }
        Self { u, main, tracking, inside }
    }
}

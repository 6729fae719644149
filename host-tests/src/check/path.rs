//! Where on the programmed contour is every set point, in order?
use super::ROUNDING;
use crate::reference::geometry::{Contour, Element};
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

/// The length that speeds count along: main axes, or tracking axes where they move alone.
fn length(element: &Element) -> f64 {
    let main = element.main_length();
    if main > 0.0 { main } else { element.tracking_length() }
}

/// Follows the contour in order. Every set point must lie within `tolerance` (mm; degrees for tracking axes, plus what
/// the tolerance in the plane means for them) of the contour, not before its predecessor, and not further on than
/// the feed (`v_rapid` in rapid blocks, mm/s) allows within a tick. The last one must be the end.
///
/// # Errors
/// The first row that does not.
pub fn path(trace: &Trace, contour: &Contour, tolerance: f64, v_rapid: f64) -> Result<Course, String> {
    let mut course = Course::default();
    let lengths: Vec<f64> = contour.elements.iter().map(length).collect();
    let (mut j, mut u, mut begin) = (0, 0.0, 0.0);
    for tick in 0..trace.len() {
        let q = trace.mm(tick);
        let before = course.s.last().copied().unwrap_or(0.0);
        let mut nearest = f64::INFINITY;
        let mut fastest = 0.0_f64;
        loop {
            let Some(element) = contour.elements.get(j) else {
                return Err(format!(
                    "tick {tick}: {q:?} is {nearest} mm from the rest of the contour (element {j})"
                ));
            };
            fastest = fastest.max(element.feed.map_or(v_rapid, |f| f / 60.0));
            let off = Deviation::of(element, &q, u, tolerance);
            // Forward only; a step back by twice the tolerance is rounding.
            let slack = 2.0 * tolerance / lengths[j].max(1e-9);
            // At a joint both elements are within tolerance: the nearer one.
            let ahead = (off.u >= 1.0).then(|| contour.elements.get(j + 1)).flatten();
            let leave = ahead.is_some_and(|next| {
                let other = Deviation::of(next, &q, 0.0, tolerance);
                other.inside && other.u >= 0.0 && other.main < off.main
            });
            if off.inside && !leave && off.u >= u - slack {
                u = off.u.clamp(u, 1.0);
                course.error = course.error.max(off.main);
                course.tracking_error = course.tracking_error.max(off.tracking);
                break;
            }
            nearest = nearest.min(off.main);
            // The rest of this element lies between the two rows: it must be short enough to pass within a tick.
            let passed = begin + lengths[j] - before;
            if passed > fastest * trace.cycle * (1.0 + 1e-9) + 4.0 * tolerance {
                return Err(format!(
                    "tick {tick}, element {j}: {q:?} is {} mm (tracking {}) from the contour at {u} of it",
                    off.main, off.tracking
                ));
            }
            begin += lengths[j];
            j += 1;
            u = 0.0;
        }
        let s = begin + u * lengths[j];
        if s - before > fastest * trace.cycle * (1.0 + 1e-9) + 4.0 * tolerance {
            return Err(format!("tick {tick}: {} mm within a tick, feed {fastest} mm/s", s - before));
        }
        course.s.push(s);
        course.element.push(j);
    }
    let left = (1.0 - u) * lengths.get(j).copied().unwrap_or(0.0);
    let later: f64 = lengths.iter().skip(j + 1).sum();
    if left + later > 4.0 * tolerance {
        return Err(format!("{} mm of the contour are missing", left + later));
    }
    Ok(course)
}

impl Course {
    /// Largest acceleration of the distance along the contour, mm/s², with the allowance that belongs to it: what
    /// positions off by at most the measured error can pretend. A motion that leaves out or jumps over a piece of the
    /// contour shows here, however short the piece.
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

struct Deviation {
    u: f64,
    main: f64,
    tracking: f64,
    inside: bool,
}

impl Deviation {
    fn of(element: &Element, q: &[f64], near: f64, tolerance: f64) -> Self {
        let u = element.project(q, near);
        let p = element.at(u.clamp(0.0, 1.0));
        let main = element.main.iter().map(|&k| (q[k] - p[k]).powi(2)).sum::<f64>().sqrt();
        let mut tracking = 0.0_f64;
        let mut inside = main <= tolerance;
        for k in (0..q.len()).filter(|k| !element.main.contains(k)) {
            let off = (q[k] - p[k]).abs();
            tracking = tracking.max(off);
            inside &= off <= tolerance * (1.0 + element.travel(k).abs() / length(element).max(1e-9));
        }
        Self { u, main, tracking, inside }
    }
}

//! The checker: is a trace a permitted motion on the programmed contour? The checker uses only set points,
//! limits and the contour, not the plan.
//!
//! # Why finite differences need no safety factor
//! Let x(t) be an axis' motion and x_k = x(kT). The n-th difference is a weighted mean of the n-th
//! derivative,
//!
//! D_n x_k / T^n = integral of x^(n)(t_k + uT) B_n(u) du over 0…n, B_n >= 0, integral of B_n = 1,
//!
//! with B_n the uniform B-spline of n intervals. So |D_n| / T^n never exceeds the largest |x^(n)|: no correct
//! motion is refused, and a limit that is used for n ticks is met with equality. The only allowance is that
//! set points are rounded: an error of r per sample adds at most 2^n r / T^n.
//!
//! Three rows of rest are added at both ends, so that a start or an end with a jump counts.

mod path;
mod place;

pub use path::{Course, measured, path};
pub use place::by_place;

use crate::trace::Trace;

/// Half the LSB of a set point, mm.
pub const ROUNDING: f64 = 0.5 / (1u64 << 32) as f64;

/// Limits of an axis; infinite if not limited.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// mm/s
    pub v: f64,
    /// mm/s²
    pub a: f64,
    /// mm/s³
    pub jerk: f64,
}

/// The largest values seen.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Peaks {
    /// Largest |D_1|/T, |D_2|/T², |D_3|/T³.
    pub values: [f64; 3],
    /// The row after which each was seen.
    pub ticks: [usize; 3],
}

/// Names of the derivatives.
const NAMES: [&str; 3] = ["speed", "acceleration", "jerk"];

/// Largest finite differences of one column with rest before and after.
pub fn peaks(column: &[i64], cycle: f64) -> Peaks {
    let mut peaks = Peaks::default();
    let (Some(&first), Some(&last)) = (column.first(), column.last()) else { return peaks };
    let padded = [first; 3].into_iter().chain(column.iter().copied()).chain([last; 3]);
    let mut window = [first; 4];
    for (row, x) in padded.enumerate() {
        window.rotate_left(1);
        window[3] = x;
        let [x0, x1, x2, x3] = window.map(i128::from);
        let differences = [x3 - x2, x3 - 2 * x2 + x1, x3 - 3 * x2 + 3 * x1 - x0];
        for (order, difference) in differences.into_iter().enumerate() {
            let value = difference.unsigned_abs() as f64 * 2.0 * ROUNDING / cycle.powi(order as i32 + 1);
            if value > peaks.values[order] {
                peaks.values[order] = value;
                peaks.ticks[order] = row.saturating_sub(3);
            }
        }
    }
    peaks
}

/// Effect of rounded set points on the difference of an order (1: speed, 2: acceleration, 3: jerk).
pub fn allowance(order: i32, cycle: f64) -> f64 {
    2f64.powi(order) * ROUNDING / cycle.powi(order)
}

/// Checks every axis against its limits.
///
/// # Errors
/// The first excess, with axis, tick, value and limit.
pub fn limits(trace: &Trace, limits: &[Limits]) -> Result<Vec<Peaks>, String> {
    let mut all = Vec::new();
    for (axis, (column, limit)) in trace.columns.iter().zip(limits).enumerate() {
        let peaks = peaks(column, trace.cycle);
        for (order, bound) in [limit.v, limit.a, limit.jerk].into_iter().enumerate() {
            let allowance = allowance(order as i32 + 1, trace.cycle);
            let value = peaks.values[order];
            // 1e-12: the division by T^n in f64.
            if value > bound * (1.0 + 1e-12) + allowance {
                let tick = peaks.ticks[order];
                let name = NAMES[order];
                return Err(format!(
                    "axis {axis}: {name} {value} above {bound} (+ {allowance}) at tick {tick}"
                ));
            }
        }
        all.push(peaks);
    }
    Ok(all)
}

/// Checks start and end, and that every stop point is reached to the bit, in order. `ends` are the end points
/// of all blocks with whether the motion must stop there.
///
/// # Errors
/// The first point that was not reached.
pub fn ends(trace: &Trace, start: &[i64], ends: &[(Vec<i64>, bool)]) -> Result<(), String> {
    if !trace.row(0).eq(start.iter().copied()) {
        return Err(format!("starts at {:?}, not at {start:?}", trace.row(0).collect::<Vec<_>>()));
    }
    let mut tick = 0;
    for (block, (point, stop)) in ends.iter().enumerate() {
        if *stop {
            match (tick..trace.len()).find(|&t| trace.row(t).eq(point.iter().copied())) {
                Some(found) => tick = found,
                None => return Err(format!("block {block}: stop point {point:?} is never a set point")),
            }
        }
    }
    let target = ends.last().map_or(start, |(point, _)| point);
    let last = trace.len() - 1;
    if !trace.row(last).eq(target.iter().copied()) {
        return Err(format!("ends at {:?}, not at {target:?}", trace.row(last).collect::<Vec<_>>()));
    }
    Ok(())
}

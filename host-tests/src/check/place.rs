//! Limits that depend on the place: inside a straight block only the slope acts; inside an arc and near a
//! transition the contour acts too.
use super::path::{Course, measured};
use super::{Limits, NAMES, ROUNDING, allowance};
use crate::reference::geometry::Contour;
use crate::trace::Trace;
use std::ops::RangeInclusive;

/// Highest distance of a row from a transition (mm of path) at which the row may count for the other side.
/// Where a line touches a circle of 60 mm, both are within a nanometre for 11 µm.
const NEAR: f64 = 0.02;

/// Checks every axis at every tick against the limits of the place of its differences: `limits` of an axis
/// and of the elements that these differences touch.
///
/// # Errors
/// The first excess.
pub fn by_place(
    trace: &Trace,
    course: &Course,
    contour: &Contour,
    limits: impl Fn(usize, RangeInclusive<usize>) -> Limits,
) -> Result<(), String> {
    let mut ends = Vec::with_capacity(contour.elements.len());
    let mut at = 0.0;
    for element in &contour.elements {
        at += measured(element);
        ends.push(at);
    }
    let Some(last) = contour.elements.len().checked_sub(1) else { return Ok(()) };
    let element_at = |s: f64| ends.partition_point(|end| *end <= s).min(last);
    // Per order of difference: the elements that it touches at every row.
    let rows = course.s.len();
    let touched = |row: usize, order: usize| {
        let from = course.s[row.saturating_sub(order).min(rows - 1)];
        element_at(from - NEAR)..=element_at(course.s[row.min(rows - 1)] + NEAR)
    };
    for (axis, column) in trace.columns.iter().enumerate() {
        let point = |row: isize| i128::from(column[row.clamp(0, rows as isize - 1) as usize]);
        // Three rows at standstill after the last one.
        for row in 1..rows + 3 {
            let x = [0, 1, 2, 3].map(|back| point(row as isize - back));
            let differences = [x[0] - x[1], x[0] - 2 * x[1] + x[2], x[0] - 3 * x[1] + 3 * x[2] - x[3]];
            for (order, difference) in (1..).zip(differences) {
                let scale = 2.0 * ROUNDING / trace.cycle.powi(order);
                let value = difference.unsigned_abs() as f64 * scale;
                if value <= allowance(order, trace.cycle) {
                    continue;
                }
                let elements = touched(row, order as usize);
                let limit = limits(axis, elements.clone());
                let bound = [limit.v, limit.a, limit.jerk][order as usize - 1];
                if value > bound * (1.0 + 1e-12) + allowance(order, trace.cycle) {
                    let name = NAMES[order as usize - 1];
                    return Err(format!(
                        "axis {axis}: {name} {value} above {bound} at tick {row}, in elements {elements:?}"
                    ));
                }
            }
        }
    }
    Ok(())
}

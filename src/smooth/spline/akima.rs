//! Computes Akima's curve, which passes through every point. The slope at a point depends on the point itself
//! and on two points at each side.
//!
//! The parameter of the curve is the length of the chords, the straight lines between the points. Let m₋₂ and
//! m₋₁ be the slopes of the two chords before a point, and m₊₁ and m₊₂ those of the two chords after it. The
//! slope of the curve at the point is
//!
//! ```text
//! t = (w_behind·m₋₁ + w_before·m₊₁) / (w_behind + w_before)
//! w_behind = |m₊₂ − m₊₁|, w_before = |m₋₁ − m₋₂|
//! ```
//!
//! Lengths count along the path axes, so the shape of the curve does not depend on its direction in the
//! machine. Other axes use the same weights.
//!
//! At an end of the curve, chords are missing. By default they are extrapolated: m₋₁ = 2·m₊₁ − m₊₂, and so
//! on. The program may also demand the slope at an end (tangential, or a given vector). The missing chords
//! are then chosen so that the curve has this slope.
//!
//! Akima, A new method of interpolation and smooth curve fitting based on local procedures, J. ACM 17 (1970).
use super::window::{Leg, Window};
use crate::math::float::{magnitude, max};
use crate::smooth::contour::curve::{plus, size};

/// A slope of the curve below this part of the chord's slope means a reversal: the point is a corner.
const LEAST_SLOPE: f32 = 0.25;
/// Chords with a smaller relative difference count as straight.
const STRAIGHT: f32 = 1.0 / 4_194_304.0;

/// Slopes at both ends of the curve, given by the program or by the neighbouring block.
#[derive(Clone, Copy, Debug)]
pub struct Given<const AXES: usize> {
    pub start: Option<[f32; AXES]>,
    pub end: Option<[f32; AXES]>,
}

/// Slopes on both sides of a point; they differ at a corner.
pub type Slopes<const AXES: usize> = [[f32; AXES]; 2];

/// The vector 2a − b.
fn evenly<const AXES: usize>(a: &[f32; AXES], b: &[f32; AXES]) -> [f32; AXES] {
    plus(&plus(a, 1.0, a), -1.0, b)
}

/// Slopes of the curve at point `i` of the window. Returns `None` if there is no leg on one side.
pub fn slopes<const AXES: usize>(
    window: &Window<AXES>,
    given: &Given<AXES>,
    i: i32,
    is_corner: impl Fn(i32) -> bool,
) -> Option<Slopes<AXES>> {
    let axes = window.axes();
    // The chord next to a point, and the next chord of the same part of the curve, without a corner between.
    let side = |i: i32, step: i32| {
        let chord = |leg: i32| window.leg(leg).map(|leg: Leg<AXES>| leg.slope);
        let next = if step > 0 { i } else { i - 1 };
        let second = if is_corner(i + step) { None } else { chord(next + step) };
        (chord(next), second)
    };
    let (before, before2) = side(i, -1);
    let (behind, behind2) = side(i, 1);
    match (before, behind) {
        (None, None) => None,
        (None, Some(m)) => {
            Some([end(given.start.as_ref(), &m, behind2.as_ref(), far(window, given, i, 1)); 2])
        }
        (Some(m), None) => {
            Some([end(given.end.as_ref(), &m, before2.as_ref(), far(window, given, i, -1)); 2])
        }
        (Some(m1), Some(m2)) if is_corner(i) => Some([
            end(None, &m1, before2.as_ref(), far(window, given, i, -1)),
            end(None, &m2, behind2.as_ref(), far(window, given, i, 1)),
        ]),
        (Some(m1), Some(m2)) => {
            let beyond = |given: Option<&[f32; AXES]>, near: &[f32; AXES], other: &[f32; AXES]| match given {
                Some(slope) => evenly(slope, near),
                None => evenly(near, other),
            };
            let start = given.start.as_ref().filter(|_| window.is_end(i - 1));
            let last = given.end.as_ref().filter(|_| window.is_end(i + 1));
            let m0 = before2.unwrap_or_else(|| beyond(start, &m1, &m2));
            let m3 = behind2.unwrap_or_else(|| beyond(last, &m2, &m1));
            let weigh = |a: &[f32; AXES], b: &[f32; AXES]| size(axes, &plus(a, -1.0, b));
            let (w1, w2) = (weigh(&m3, &m2), weigh(&m1, &m0));
            let share = if w1 + w2 > STRAIGHT { w1 / (w1 + w2) } else { 0.5 };
            Some([plus(&m1.map(|m| m * share), 1.0 - share, &m2); 2])
        }
    }
}

/// The slope given at the other end of a curve with one chord.
fn far<'a, const AXES: usize>(
    window: &Window<AXES>,
    given: &'a Given<AXES>,
    i: i32,
    step: i32,
) -> Option<&'a [f32; AXES]> {
    let slope = if step > 0 { given.end.as_ref() } else { given.start.as_ref() };
    slope.filter(|_| window.is_end(i + step))
}

/// The slope at an end: the given slope, or the slope from the two nearest chords, or from one chord and the
/// slope at its other end.
fn end<const AXES: usize>(
    given: Option<&[f32; AXES]>,
    near: &[f32; AXES],
    next: Option<&[f32; AXES]>,
    far: Option<&[f32; AXES]>,
) -> [f32; AXES] {
    match (given, next, far) {
        (Some(slope), ..) => *slope,
        // Both weights are equal: the mean of the chord and the extrapolated one, 2·m₁ − m₂.
        (None, Some(next), _) => plus(near, 0.5, &plus(near, -1.0, next)),
        // With one chord, the curve is a parabola.
        (None, None, Some(far)) => evenly(near, far),
        (None, None, None) => *near,
    }
}

/// Whether the point `i` is a corner. A point is a corner in three cases. The curve would have nearly no
/// slope there. The path turns by more than the angle with the cosine `cosine`. One leg is more than `ratio`
/// times as long as the other.
pub fn is_corner<const AXES: usize>(window: &Window<AXES>, i: i32, cosine: f32, ratio: f32) -> bool {
    let (Some(before), Some(behind)) = (window.leg(i - 1), window.leg(i)) else { return false };
    if window.is_end(i) {
        return false;
    }
    let axes = window.axes();
    // At such a turn, the mean of both chords has the smallest slope.
    let mean = 0.5 * size(axes, &plus(&before.slope, 1.0, &behind.slope));
    if mean < LEAST_SLOPE {
        return true;
    }
    // cos θ = 2·|mean|² − 1.
    let turns = 2.0 * mean * mean - 1.0 < cosine;
    turns || max(before.length, behind.length) > ratio * max(magnitude(before.length.min(behind.length)), 0.0)
}

//! Makes the curve of a shallow corner between two lines: two cubics that meet where the curve is nearest to
//! the corner.
//!
//! ```text
//! Q(s) = P(s) + d·(c − |s|)³ / (6·c²)     −c ≤ s ≤ c,   d = t2 − t1
//! ```
//!
//! P is the contour over its own length s, counted from the corner. c is the distance from the corner to both
//! ends of the curve. Over the length 2·c, the direction changes from t1 to t2.
//!
//! The second derivative rises and falls linearly: it is d/c in the middle and zero at both ends. So the
//! third derivative is ±d/c², the smallest of all curves of this length. The deviation is |d|·c/6 in the
//! middle and less elsewhere.
//!
//! The length s of the contour is the path distance. |Q'| is at most 1, so the speed along the curve does not
//! exceed the feed. In the middle, the speed is cos(θ/2) times the feed, where θ is the change of direction.
use crate::math::float::{magnitude, to_i64};
use crate::quantity::Position;

use super::halves::Halves;
use super::{LSB_40, ONE_32};

/// Makes the curve about the corner `origin` between the knots of `halves`, both at the distance `c` from it.
pub fn kernel<const AXES: usize>(origin: &[Position; AXES], c: f32, halves: &mut Halves<AXES>) {
    let Halves { from, middle, to, .. } = halves;
    (middle.position, middle.end) = (*origin, from.end);
    let mut third = [0.0; AXES];
    let per = 1.0 / c;
    let end = middle.end.tangent.iter_mut().zip(&mut middle.end.curvature);
    let axes = middle.position.iter_mut().zip(end).zip(&to.end.tangent).zip(&mut third);
    for (((x, (tangent, curvature)), t2), third) in axes {
        let change = t2 - *tangent;
        let d = change as f32 * LSB_40;
        let off = to_i64(d * c * (1.0 / 6.0) * ONE_32);
        *x = Position::from_bits(x.to_bits().saturating_add(off));
        *tangent += change / 2;
        *curvature = d * per;
        *third = magnitude(d) * per * per * ROUNDED;
    }
    (halves.length, halves.fastest, halves.third) = (c, 1.0 + 1e-6, Some(third));
}

/// Margin for rounding.
const ROUNDED: f32 = 1.0 + 1.0 / 1_048_576.0;

//! The curve over arc length for a corner between two lines, with the same distance c from the corner to both
//! ends, in closed form.
//!
//! The curve is the polynomial of the fifth degree of [`super::corner`]. Let t1 and t2 be the directions of
//! the lines, and θ the change of direction. The vectors p = (t1 + t2)/2 and n = (t2 − t1)/2 are at a right
//! angle. With C = |p| = cos(θ/2) and x = 2·u − 1, the derivative over the parameter u = 0…1 is
//!
//! ```text
//! Q'(u) = p·(v + w·15/8·(1 − x²)²) + n·v·x·(3 − x²)/2      w = 2·c − v,   v = 30·C·c/(8 + 7·C)
//! ```
//!
//! The speed |Q'| is v at both ends and in the middle. The middle is at (c − 5/16·v)·n from the corner, with
//! the direction p/C and the curvature 3·n/v. So the deviation in the middle is known without a search. Both
//! halves are equal, and for a given c their length depends on C alone.
//!
//! Each half is emitted as one polynomial of the fifth degree over its own length. Up to a turn of 100°, the
//! speed along this polynomial differs from the path speed by at most 0.9 ‰.
use super::ONE_32;
use super::corner::{Corner, Tolerance};
use super::corner_curve::EVEN;
use super::curve::{Main, aside, plus, size};
use super::halves::Halves;
use crate::math::float::{magnitude, max, min, to_f32, to_i64};
use crate::quantity::Position;

/// The form of the curve, for a distance of 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Symmetric<const AXES: usize> {
    along: [f32; AXES],
    across: [f32; AXES],
    cosine: f32,
    /// Speed of the curve at the ends and in the middle, mm per u.
    speed: f32,
}

/// Cosine of half the turn up to which each half is one element: 100°.
const LEAST_COSINE: f32 = 0.643;

/// Length of a half as a polynomial in 1 − C, from the first power on: accurate to 3·10^-8 up to 104°.
const LENGTH: [f32; 5] = [-0.514_288_7, -0.332_221_84, -0.080_998_49, -0.037_167_14, -0.028_881_88];

/// Relative excess of the speed along a half over the path speed, divided by 1 − C. The excess is at most
/// [`EVEN`].
const ABOVE: f32 = 0.0067;

impl<const AXES: usize> Symmetric<AXES> {
    /// No corner.
    pub const NONE: Self = Self { along: [0.0; AXES], across: [0.0; AXES], cosine: 0.0, speed: 0.0 };

    /// The symmetric form of a corner between lines, with no block left out and with path length as in space.
    pub fn new(corner: &Corner<'_, AXES>) -> Self {
        let (t1, t2) = (corner.before.tangent(), corner.behind.tangent());
        let [along, across] = [1.0, -1.0].map(|sign| plus(t2, sign, t1).map(|x| 0.5 * x));
        let cosine = min(size(corner.main, &along), 1.0);
        Self { along, across, cosine, speed: 30.0 * cosine / (8.0 + 7.0 * cosine) }
    }

    /// The part of the tolerances that the curve uses: deviation divided by tolerance, the larger value of
    /// path and tracking axes (1: all of it). `c`: distance from the corner to either end of the curve, mm.
    pub fn used(&self, main: &Main, tolerance: &Tolerance, c: f32) -> f32 {
        let off = c * (1.0 - 0.3125 * self.speed);
        let path = tolerance.path.map_or(0.0, |path| size(main, &self.across) / path);
        let track = if tolerance.track > 0.0 { aside(main, &self.across) / tolerance.track } else { 0.0 };
        off * max(path, track)
    }

    /// Length of a half with the corner distance 1.
    fn half(&self) -> f32 {
        let y = 1.0 - self.cosine;
        1.0 + y * LENGTH.iter().rev().fold(0.0, |sum, x| sum * y + x)
    }

    /// Path length of the whole curve.
    pub fn path(&self, c: f32) -> f32 {
        2.0 * c * self.half()
    }

    /// Largest magnitudes of second and third derivative, from the ends, the middle and places between.
    pub fn bends(&self, c: f32) -> [[f32; AXES]; 2] {
        let (v, w) = (c * self.speed, c * (2.0 - self.speed));
        let mut bends = [[0.0; AXES]; 2];
        let [second, third] = &mut bends;
        let axes = second.iter_mut().zip(third).zip(self.along.iter().zip(&self.across));
        for ((second, third), (p, n)) in axes {
            let (p, n) = (w * magnitude(*p), v * magnitude(*n));
            (*second, *third) = (max(5.625 * p + 2.25 * n, 3.0 * n), 60.0 * p + 12.0 * n);
        }
        bends
    }

    /// Whether each half is one element.
    pub fn is_even(&self) -> bool {
        self.cosine >= LEAST_COSINE
    }

    /// Makes the curve between the knots of `halves` at the corner distance `c`.
    pub fn curve(&self, c: f32, halves: &mut Halves<AXES>) {
        let Halves { from, middle, to, .. } = halves;
        *middle = *from;
        let (v, per) = (c * self.speed, 0.5 / self.cosine);
        let end = middle.end.tangent.iter_mut().zip(&mut middle.end.curvature);
        let knots = middle.position.iter_mut().zip(end).zip(to.position.iter().zip(&to.end.tangent));
        for (((x, (tangent, curvature)), (x2, t2)), n) in knots.zip(&self.across) {
            let between = x2.to_bits().saturating_sub(x.to_bits()) / 2;
            let off = to_i64(0.3125 * v * n * ONE_32);
            *x = Position::from_bits(x.to_bits().saturating_add(between).saturating_sub(off));
            *tangent = to_i64(to_f32(*tangent + t2) * per);
            *curvature = 3.0 * n / v;
        }
        let above = min(ABOVE * (1.0 - self.cosine), EVEN);
        (halves.length, halves.fastest) = (c * self.half(), 1.0 + above + 1e-6);
    }
}

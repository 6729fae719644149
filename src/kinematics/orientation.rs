//! Computes the angles of two rotary axes at which the tool points in a given direction.
use super::chain::{Chain, ROTARIES, Rotary};
use super::vector::{RADIANS, Vector, nearest, number, position, sqrt};
use crate::math::angle::atan2_turns;
use crate::quantity::Position;
use core::fmt;

/// The reason why no angles of the rotary axes give a tool direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Reach {
    /// The machine has this number of rotary axes, not two.
    Rotaries(u8),
    /// The axis with this index cannot tilt the tool far enough at any angle.
    Beyond(u8),
    /// The tool is parallel to the axis with this index, so every angle of this axis fits.
    Singular(u8),
    /// The direction has length 0, or the angles are beyond ±200 000 degrees.
    Range,
}

impl fmt::Display for Reach {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Rotaries(count) => {
                write!(f, "direction of the tool: expected two rotary axes, the machine has {count}")
            }
            Self::Beyond(axis) => write!(f, "direction of the tool: axis {axis} cannot tilt it so far"),
            Self::Singular(axis) => {
                write!(f, "singular direction: the tool stands along rotary axis {axis}")
            }
            Self::Range => f.write_str("direction of the tool: expected a vector, and angles in range"),
        }
    }
}

impl core::error::Error for Reach {}

/// A tool direction is singular if the sine of its angle to the outer axis is below this value (10^-5
/// degree).
const SINGULAR: f64 = 1.7e-7;

impl Chain {
    /// Angles of the rotary axes (degrees, in the order of their axis indices) at which the tool points in
    /// `direction`. `direction` is the vector from tool tip to holder. There may be two solutions. The result
    /// is the one with the smaller sum of both turns from `last`. Software limits have no effect.
    ///
    /// Let u be the outer axis (the one nearer to the workpiece), and w the inner axis. d is the tool
    /// direction with both axes at 0, and t the wanted direction. R_w(θ) is the turn by the inner angle θ.
    /// The equation u·R_w(θ)·d = u·t has the form `A cos θ + B sin θ = C`. The outer angle then turns the
    /// projection of the tilted tool to the projection of t.
    ///
    /// # Errors
    /// The direction cannot be reached, or is singular: [`Reach`].
    pub fn angles(
        &self,
        direction: Vector,
        last: &[Position; ROTARIES],
    ) -> Result<[Position; ROTARIES], Reach> {
        let mut rotaries = self.rotaries();
        let (Some(outer), Some(inner), None) = (rotaries.next(), rotaries.next(), rotaries.next()) else {
            return Err(Reach::Rotaries(self.rotaries().count() as u8));
        };
        let target = direction.unit().ok_or(Reach::Range)?;
        let (u, w, d) = (outer.direction, inner.direction, self.tool);
        let still = u.dot(w) * w.dot(d);
        let (a, b, c) = (u.dot(d) - still, u.dot(w.cross(d)), u.dot(target) - still);
        let square = a * a + b * b;
        let left = square - c * c;
        if left < -1e-12 {
            return Err(Reach::Beyond(inner.axis));
        }
        if u.cross(target).length() < SINGULAR {
            return Err(Reach::Singular(outer.axis));
        }
        let root = sqrt(left);
        let mut best: Option<(f64, [Position; ROTARIES])> = None;
        for root in [root, -root] {
            // θ = direction of (A, B) ± the angle whose cosine is C/√(A² + B²).
            let (cos, sin) = (a * c - b * root, b * c + a * root);
            let tilted = {
                let along = w.times(w.dot(d));
                let n = 1.0 / square;
                along.plus(d.minus(along).times(cos * n)).plus(w.cross(d).times(sin * n))
            };
            let turned = Self::about(u, tilted, target);
            let mut angles = *last;
            let mut way = 0.0;
            for (rotary, degrees) in [(inner, degrees(cos, sin)), (outer, turned)] {
                let place = angles.get_mut(usize::from(rotary.slot)).ok_or(Reach::Range)?;
                let near = next_to(*place, &rotary, degrees);
                way += (near - number(*place)).abs();
                *place = position(near).ok_or(Reach::Range)?;
            }
            if best.is_none_or(|(shortest, _)| way < shortest) {
                best = Some((way, angles));
            }
        }
        best.map(|(_, angles)| angles).ok_or(Reach::Range)
    }

    /// The angle from `from` to `to` about `u`, degrees.
    fn about(u: Vector, from: Vector, to: Vector) -> f64 {
        let cos = from.dot(to) - u.dot(from) * u.dot(to);
        degrees(cos, u.dot(from.cross(to)))
    }
}

/// The angle of (cos, sin), both of magnitude below 8, in degrees from −180 to 180.
fn degrees(cos: f64, sin: f64) -> f64 {
    const SCALE: f64 = (1u64 << 59) as f64;
    let turns = atan2_turns(nearest(sin * SCALE), nearest(cos * SCALE)) as i64;
    turns as f64 * (360.0 / 18_446_744_073_709_551_616.0)
}

/// The position of an axis with the angle `degrees` that is nearest to `last`.
fn next_to(last: Position, rotary: &Rotary, degrees: f64) -> f64 {
    let last = number(last);
    let way = degrees - number(rotary.offset) - last;
    let whole = nearest(way * (RADIANS / core::f64::consts::TAU));
    last + way - whole as f64 * 360.0
}

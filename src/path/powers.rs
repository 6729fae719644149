//! Converts an element to polynomials with `f64` coefficients over the fraction of its path, and back. The
//! kinematic transformation computes with these (feature `kinematics`).
use super::poly::{SEEN, Scale, bends, bent, fastest};
use super::{Bounds, Curve, Distance, Element, End, GUARD, Passage, Shape};
use crate::math::float::{magnitude, max, to_f32};
use crate::math::wide::mul_shift;
use crate::quantity::Position;

/// An arc about its centre, in the two axes of its plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turn {
    /// Axes of its plane.
    pub plane: [usize; 2],
    /// Vector from the centre to the start, mm.
    pub radius: [f64; 2],
    /// Change of the radius vector from start to end, before the vector is turned by the angle, mm.
    pub growth: [f64; 2],
    /// Angle of the arc, from the first axis of the plane to the second, degrees.
    pub degrees: f64,
}

/// A curve over the fraction of its path, 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Powers<const AXES: usize> {
    /// Coefficients of the zeroth to fifth power, mm or degrees. For the axes of an arc's plane, the zeroth
    /// one is the centre.
    pub axes: [[f64; 6]; AXES],
    /// The additional term of an arc.
    pub turn: Option<Turn>,
}

const LSB_32: f64 = 1.0 / (1u64 << 32) as f64;
const LSB_42: f64 = 1.0 / (1u64 << 42) as f64;
const LSB_44: f64 = 1.0 / (1u64 << 44) as f64;
const LSB_62: f64 = 1.0 / (1u64 << 62) as f64;
const ONE_40: f64 = (1u64 << 40) as f64;

impl<const AXES: usize> Shape<AXES> {
    /// The curve from `start` as coefficients. Rounding is below 2^-50 of the largest coordinate.
    pub(crate) fn powers(&self, start: &[Position; AXES]) -> Powers<AXES> {
        let base = self.base(start);
        let end = self.end_w() as f64 * LSB_62;
        let mut axes = [[0.0; 6]; AXES];
        for ((axis, base), gain) in axes.iter_mut().zip(&base).zip(&self.gain) {
            axis[0] = base.to_bits() as f64 * LSB_32;
            axis[1] = *gain as f64 * LSB_44 * end;
        }
        let mut turn = None;
        match &self.curve {
            Curve::Line => {}
            Curve::Arc(arc) => {
                let plane = arc.plane.map(usize::from);
                // The unit of τ is 2^30 upper halves.
                for (k, miss) in plane.into_iter().zip(arc.miss) {
                    if let Some(axis) = axes.get_mut(k) {
                        axis[1] += f64::from(miss) * 0.25 * LSB_42 * end;
                    }
                }
                turn = Some(Turn {
                    plane,
                    radius: { arc.a }.map(|a| a as f64 * LSB_44),
                    growth: { arc.grow }.map(|grow| f64::from(grow) * 2048.0 * LSB_44 * end),
                    degrees: arc.turn as f64 * (0.25 * 360.0 / (1u64 << 59) as f64) * end,
                });
            }
            Curve::Poly { power, down } => {
                for ((axis, power), down) in axes.iter_mut().zip(power).zip(down) {
                    let mut factor = f64::from_bits((1023 - 12 - u64::from(*down)) << 52) * end;
                    for (place, c) in axis.iter_mut().skip(2).zip(power) {
                        factor *= end;
                        *place = f64::from(*c) * factor;
                    }
                }
            }
        }
        Powers { axes, turn }
    }
}

/// A polynomial of one axis that will be a part of an element.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Quintic {
    /// Coefficients of the first to fifth power over the fraction 0 to 1, LSB 2^-42 mm or degrees. Their sum
    /// is the travel, which is a multiple of the LSB of a position.
    pub power: [i64; 5],
    /// First and second derivative at both ends, mm or degrees.
    pub ends: [[f64; 2]; 2],
}

impl Quintic {
    /// An axis that does not move.
    pub const REST: Self = Self { power: [0; 5], ends: [[0.0; 2]; 2] };

    /// Largest magnitudes of the second and third derivative over the fraction. The arguments `powers` are
    /// rounded. So a cubic uses the derivatives at its ends: the rounded powers of a short piece would be
    /// inaccurate.
    fn bends(&self, powers: [f32; 4]) -> [f32; 2] {
        let ([.., 0, 0], [[_, from], [_, to]]) = (&self.power, &self.ends) else { return bends(powers) };
        let ([from, to], third) = ([*from, *to].map(|x| magnitude(x as f32)), magnitude((to - from) as f32));
        [max(from, to) * SEEN, third * SEEN]
    }

    fn travel(&self) -> i64 {
        self.power.iter().fold(0i64, |sum, c| sum.wrapping_add(*c)) >> GUARD
    }
}

impl<const AXES: usize> Element<AXES> {
    /// Writes polynomials of all axes over this path length into the element; `fastest_of` as `fastest` in
    /// [`Bounds`]. `is_straight`: only the first powers are not zero. Returns `None` if the formats cannot
    /// hold them.
    pub(crate) fn become_quintics(
        &mut self,
        length: Distance,
        axes: &[Quintic; AXES],
        (fastest_of, is_straight): (f32, bool),
    ) -> Option<()> {
        if length.to_bits() <= 0 {
            return None;
        }
        let per = 1.0 / (length.to_bits() as f64 * LSB_44);
        self.shape.rest(length);
        (self.circle, self.bounds) = (None, None);
        for (k, axis) in axes.iter().enumerate() {
            for (end, of) in [&mut self.entry, &mut self.exit].into_iter().zip(&axis.ends) {
                *end.tangent.get_mut(k)? = (of[0] * per * ONE_40) as i64;
                *end.curvature.get_mut(k)? = (of[1] * per * per) as f32;
            }
        }
        if is_straight {
            self.shape.set_gains(&axes.map(|axis| axis.travel()));
            let tangent = self.shape.linear_tangent();
            self.entry = End { tangent, curvature: [0.0; AXES] };
            self.exit = self.entry;
            return Some(());
        }
        self.bend(axes, (per as f32, fastest_of))
    }

    /// Sets the powers of all axes and their bounds. `per`: 1 mm divided by the path length; `fastest_of` as
    /// `fastest` in [`Bounds`].
    fn bend(&mut self, axes: &[Quintic; AXES], (per, fastest_of): (f32, f32)) -> Option<()> {
        let shape = &mut self.shape;
        let (end_w, reciprocal) = (shape.end_w(), shape.reciprocal());
        let scale = Scale::new(1.0 / per, end_w, reciprocal);
        let mut bounds = Bounds::none(fastest_of);
        bounds.passage = Passage::Flowing;
        let (mut power, mut down) = ([[0; 4]; AXES], [0; AXES]);
        for (k, axis) in axes.iter().enumerate() {
            let [c1, bent_of @ ..] = axis.power;
            let made = scale.scaled(bent_of, 42)?;
            let [second, third] = axis.bends(made.powers);
            let first = fastest(to_f32(c1) * LSB_42 as f32, made.powers);
            bounds.set(k, &[first, second, third], per)?;
            let rest = (axis.travel() << GUARD).wrapping_sub(bent(end_w, &made.coefficients, made.down));
            *shape.gain.get_mut(k)? = mul_shift(rest, reciprocal, 60);
            (*power.get_mut(k)?, *down.get_mut(k)?) = (made.coefficients, made.down);
        }
        shape.curve = Curve::Poly { power, down };
        self.bounds = Some(bounds);
        Some(())
    }
}

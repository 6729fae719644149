//! Computes the largest derivatives of every axis over path length, in a part of a curve. The planner uses
//! these bounds when it searches for a short stop (feed hold).
use super::poly::power_of_two;
use super::{Arc, Curve, Shape};
use crate::math::float::{magnitude, max, min, to_f32};
use crate::math::root::sqrt_f32;
use crate::math::trig::sin_cos;
use crate::math::wide::mul_near;
use crate::quantity::DISTANCE_LSB;
use core::f32::consts::TAU;

const LSB_62: f32 = 1.0 / (1u64 << 62) as f32;
/// Margin for rounding of `f32`.
const ROUNDED: f32 = 1.0 + 1.0 / 1_048_576.0;

/// For each axis, the largest first, second and third derivative over path length in a part of a curve: x′,
/// x″ (1/mm), x‴ (1/mm²). Each derivative has two values, both at least 0: the largest positive value, and
/// the magnitude of the largest negative value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Swings<const AXES: usize>(pub [[[f32; 2]; 3]; AXES]);

impl<const AXES: usize> Swings<AXES> {
    /// The values of an empty part: all zero.
    pub const NONE: Self = Self([[[0.0; 2]; 3]; AXES]);

    /// Raises the values of one axis to these derivatives, if they are larger.
    fn widen(&mut self, axis: usize, derivatives: [[f32; 2]; 3]) {
        let Some(swing) = self.0.get_mut(axis) else { return };
        for (most, value) in swing.iter_mut().zip(derivatives) {
            for (most, value) in most.iter_mut().zip(value) {
                *most = max(*most, value * ROUNDED);
            }
        }
    }

    /// Makes both values of each derivative equal to the larger one, because each derivative may have the
    /// other sign.
    pub fn even(&mut self) {
        for most in self.0.iter_mut().flatten() {
            *most = [max(most[0], most[1]); 2];
        }
    }
}

impl<const AXES: usize> Shape<AXES> {
    /// Raises `swings` to the largest derivatives of every axis between two distances from the curve's start
    /// (LSB 2^-44 mm). The values of a line are exact. Those of a polynomial are upper bounds ([`hull`]).
    /// Those of an arc are upper bounds too, equal for both signs.
    #[inline(never)]
    pub fn bend(&self, [from, to]: [i64; 2], swings: &mut Swings<AXES>) {
        let per_mm = power_of_two(i32::from(self.shift) - 18);
        for (axis, gain) in self.gain.iter().enumerate().filter(|(_, gain)| **gain != 0) {
            if !matches!(self.curve, Curve::Poly { .. }) {
                let first = magnitude(to_f32(*gain)) * DISTANCE_LSB * per_mm;
                swings.widen(axis, [[first; 2], [0.0; 2], [0.0; 2]]);
            }
        }
        match &self.curve {
            Curve::Line => {}
            Curve::Arc(arc) => self.bend_arc(arc, [from, to], per_mm, swings),
            Curve::Poly { power, down } => {
                let at = |distance: i64| to_f32(self.w(distance)) * LSB_62;
                let (start, part) = (at(from), to_f32(to.wrapping_sub(from)) * DISTANCE_LSB * per_mm);
                let per = per_mm / part;
                let coefficients = self.gain.iter().zip(power).zip(down).enumerate();
                let moves = |(_, ((gain, power), _)): &(usize, ((&i64, &[i32; 4]), _))| {
                    **gain != 0 || **power != [0; 4]
                };
                for (axis, ((gain, power), down)) in coefficients.filter(moves) {
                    let scale = power_of_two(-12 - i32::from(*down));
                    let [c2, c3, c4, c5] = power.map(|c| c as f32 * scale);
                    let whole = [to_f32(*gain) * DISTANCE_LSB, c2, c3, c4, c5];
                    let most = hull(within(&whole, start, part));
                    let mut derivatives = hidden(&whole, per_mm).map(|hidden| [hidden; 2]);
                    for ((sums, most), n) in
                        derivatives.iter_mut().zip(most).zip([per, per * per, per * per * per])
                    {
                        for (sum, most) in sums.iter_mut().zip(most) {
                            *sum += most * n;
                        }
                    }
                    swings.widen(axis, derivatives);
                }
            }
        }
    }

    /// The part of [`Self::bend`] for an arc. Both axes are sines of the angle. In a part of the arc, each
    /// axis is at most its larger end value, divided by the cosine of half the angle between the ends.
    fn bend_arc(&self, arc: &Arc, part: [i64; 2], per_mm: f32, swings: &mut Swings<AXES>) {
        let Arc { a, turn, plane, .. } = *arc;
        let [p, q] = a.map(|a| to_f32(a) * DISTANCE_LSB);
        let radius = sqrt_f32(p * p + q * q);
        // In units of 2^-61 revolutions per 2^62 of `w`.
        let turns = magnitude(to_f32(turn)) * (1.0 / (1u64 << 61) as f32);
        let rate = TAU * turns * per_mm;
        // LSB 2^-62.
        let unit = |distance: i64| {
            let (sin, cos) = sin_cos((mul_near(self.w(distance), turn) << 5) as u64);
            [sin, cos].map(|x| to_f32(x) * LSB_62)
        };
        let half = 0.5 * rate * to_f32(part[1].wrapping_sub(part[0])) * DISTANCE_LSB;
        let cosine = 1.0 - 0.5 * half * half;
        let [mut x, mut y] = [0.0; 2];
        for [sin, cos] in part.map(unit) {
            x = max(x, magnitude(p * cos - q * sin));
            y = max(y, magnitude(q * cos + p * sin));
        }
        let most = |end: f32| if cosine > 0.25 { min(radius, end / cosine) } else { radius };
        let [x, y] = [x, y].map(most);
        for (axis, across, along) in [(plane[0], x, y), (plane[1], y, x)] {
            let [first, second] = [along * rate, across * rate * rate];
            let third = first * rate * rate;
            swings.widen(usize::from(axis), [[first; 2], [second; 2], [third; 2]]);
        }
    }
}

/// Largest rounding error of [`within`] in the first three derivatives over path length.
fn hidden(a: &[f32; 5], per_mm: f32) -> [f32; 3] {
    let [a1, a2, a3, a4, a5] = a.map(magnitude);
    let unit = per_mm * (1.0 / 1_048_576.0);
    let first = a1 + 2.0 * a2 + 3.0 * a3 + 4.0 * a4 + 5.0 * a5;
    let second = 2.0 * a2 + 6.0 * a3 + 12.0 * a4 + 20.0 * a5;
    let third = 6.0 * a3 + 24.0 * a4 + 60.0 * a5;
    [first * unit, second * unit * per_mm, third * unit * per_mm * per_mm]
}

/// Upper bounds of the first three derivatives over 0..1, and of their negatives. The bounds are the largest
/// Bernstein coefficients Σ C(i,j)/C(n,j)·p_j of the powers p0…pn. A bound below zero becomes zero.
fn hull([a1, a2, a3, a4, a5]: [f32; 5]) -> [[f32; 2]; 3] {
    const THIRD: f32 = 1.0 / 3.0;
    let most = |x: &[f32]| x.iter().fold([0.0; 2], |[above, below], x| [max(above, *x), max(below, -*x)]);
    let p = [a1, 2.0 * a2, 3.0 * a3, 4.0 * a4, 5.0 * a5];
    let (q1, q2, q3) = (p[1] * 0.25, p[2] * (1.0 / 6.0), p[3] * 0.25);
    let first = [
        p[0],
        p[0] + q1,
        p[0] + 2.0 * q1 + q2,
        p[0] + 3.0 * (q1 + q2) + q3,
        p[0] + p[1] + p[2] + p[3] + p[4],
    ];
    let [b0, b1, b2, b3] = [2.0 * a2, 6.0 * a3, 12.0 * a4, 20.0 * a5];
    let (b1_third, b2_third) = (b1 * THIRD, b2 * THIRD);
    let second = [b0, b0 + b1_third, b0 + 2.0 * b1_third + b2_third, b0 + b1 + b2 + b3];
    let third = [b1, b1 + b2, b1 + 2.0 * b2 + 3.0 * b3];
    [most(&first), most(&second), most(&third)]
}

/// The part of a polynomial of the first to fifth power between `start` and `start` + `part`, as a polynomial
/// over 0..1.
fn within(a: &[f32; 5], start: f32, part: f32) -> [f32; 5] {
    let [mut a1, mut a2, mut a3, mut a4, a5] = *a;
    // Repeated Horner's scheme: the remainders of the divisions by (τ − start).
    for pass in 0..5 {
        a4 += a5 * start;
        a3 += if pass < 4 { a4 * start } else { 0.0 };
        a2 += if pass < 3 { a3 * start } else { 0.0 };
        a1 += if pass < 2 { a2 * start } else { 0.0 };
    }
    let (square, cube) = (part * part, part * part * part);
    [a1 * part, a2 * square, a3 * cube, a4 * (square * square), a5 * (square * cube)]
}

//! The driven speed along a polynomial, squared, as a series (feature `plc`).
//!
//! The axes of a polynomial move by polynomials of the fifth degree. Their speeds have the fourth degree, and the sum
//! of the squares has the eighth. Nine Chebyshev coefficients hold this sum for any number of axes.
use super::{Curve, Measure, Shape};

/// Number of coefficients of a squared speed.
pub const SQUARED: usize = 9;

/// Number of coefficients of the speed of an axis.
const SPEED: usize = 5;

const LSB_12: f64 = 1.0 / (1u64 << 12) as f64;
const LSB_44: f64 = 1.0 / (1u64 << 44) as f64;
const LSB_62: f64 = 1.0 / (1u64 << 62) as f64;

impl<const AXES: usize> Shape<AXES> {
    /// The square of the speed over the fraction τ of the path, (mm per whole curve)², as Chebyshev coefficients over
    /// 2·τ − 1. The speed is that along the axes of `measure`: the feed axes; if none of them moves, the main axes; if
    /// none of these moves, all axes. Returns zeros for a curve that is not a polynomial.
    pub(crate) fn squared_speed(&self, measure: &Measure) -> [f32; SQUARED] {
        let mut sum = [0.0; SQUARED];
        for wanted in
            [Measure::feeds, |measure: &Measure, axis| measure.main.contains(axis), |_: &Measure, _| true]
        {
            for axis in (0..AXES).filter(|axis| wanted(measure, *axis)) {
                add_square(&mut sum, &self.speed(axis));
            }
            if sum.iter().any(|c| *c != 0.0) {
                break;
            }
        }
        sum.map(|c| c as f32)
    }

    /// The speed of an axis over the fraction of the path, mm per whole curve, as Chebyshev coefficients.
    fn speed(&self, axis: usize) -> [f64; SPEED] {
        let mut made = [0.0; SPEED];
        let Curve::Poly { power, down } = &self.curve else { return made };
        let (Some(gain), Some(power), Some(down)) = (self.gain.get(axis), power.get(axis), down.get(axis))
        else {
            return made;
        };
        let end = self.end_w() as f64 * LSB_62;
        // A coefficient has the unit 2^(−12 − down) mm, as in `powers`.
        let unit = LSB_12 / (1u64 << (down & 63)) as f64;
        let mut slopes = [*gain as f64 * LSB_44 * end, 0.0, 0.0, 0.0, 0.0];
        let mut factor = unit * end;
        for ((slope, c), k) in slopes.iter_mut().skip(1).zip(power).zip([2.0, 3.0, 4.0, 5.0]) {
            factor *= end;
            *slope = k * f64::from(*c) * factor;
        }
        // Horner's scheme with τ = (1 + u)/2 as a factor.
        for slope in slopes.iter().rev() {
            let product = times_u(&made);
            for (made, product) in made.iter_mut().zip(product) {
                *made = 0.5 * (*made + product);
            }
            made[0] += slope;
        }
        made
    }
}

/// A series times u, for a series whose last coefficient is zero.
fn times_u(series: &[f64; SPEED]) -> [f64; SPEED] {
    let [a, b, c, d, e] = *series;
    [0.5 * b, a + 0.5 * c, 0.5 * (b + d), 0.5 * (c + e), 0.5 * d]
}

/// Adds the square of a series: the product of T_i and T_k is half the sum of T_(i+k) and T_|i−k|.
fn add_square(sum: &mut [f64; SQUARED], series: &[f64; SPEED]) {
    for (i, a) in series.iter().enumerate() {
        for (k, b) in series.iter().enumerate() {
            let half = 0.5 * a * b;
            for place in [i + k, i.abs_diff(k)] {
                if let Some(c) = sum.get_mut(place) {
                    *c += half;
                }
            }
        }
    }
}

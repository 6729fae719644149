//! Computes an upper bound for the error of the tool tip under a transformation. The error arises because
//! polynomials of the fifth degree (quintics) replace the exact motion of the linear axes.
//!
//! A `Series` bounds a curve over the parameter 0 to 1: coefficient j is at least the largest magnitude of
//! the j-th derivative, divided by j!. By Leibniz' rule, the product of two series bounds the product of two
//! curves. A turn by an angle θ multiplies the series by exp(Θ), with Θ the series of θ without its first
//! coefficient. The reason: the derivatives of a turn obey the recurrence of the exponential function, and a
//! turn changes no length.
//!
//! Let a quintic have value, first and second derivative of a curve at both ends of an interval h. The
//! quintic then deviates from the curve by at most h⁶/46080 times the largest sixth derivative of the curve.
//! Rotary axes change no length and follow their angles exactly. So the tool tip deviates by the same
//! distance as the linear axes.
//!
//! The bound is `c₆/64` for the whole curve, with the coefficient c₆ of its series, and `c₆/(64·n⁶)` for each
//! of n equal parts.
use super::cells::Course;
use super::chain::{Chain, ROTARIES, Rotary};
use super::vector::{RADIANS, Vector};

/// Number of coefficients.
const TERMS: usize = 7;

/// Binomial coefficients C(k, j) of row k = 0 to 5.
const BINOMIAL: [[f64; 6]; 6] = [
    [1.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    [1.0, 1.0, 0.0, 0.0, 0.0, 0.0],
    [1.0, 2.0, 1.0, 0.0, 0.0, 0.0],
    [1.0, 3.0, 3.0, 1.0, 0.0, 0.0],
    [1.0, 4.0, 6.0, 4.0, 1.0, 0.0],
    [1.0, 5.0, 10.0, 10.0, 5.0, 1.0],
];

/// Bounds of a curve and its derivatives.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Series([f64; TERMS]);

impl Series {
    /// A constant curve of magnitude `x`.
    const fn constant(x: f64) -> Self {
        Self([x, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])
    }

    /// The series of a polynomial, from the magnitudes of its coefficients.
    fn polynomial(magnitudes: &[f64; 6]) -> Self {
        let mut series = [0.0; TERMS];
        for (row, magnitude) in BINOMIAL.iter().zip(magnitudes) {
            for (c, binomial) in series.iter_mut().zip(row) {
                *c += binomial * magnitude;
            }
        }
        Self(series)
    }

    /// The series of a product.
    fn times(&self, b: &Self) -> Self {
        let mut product = [0.0; TERMS];
        for (n, c) in product.iter_mut().enumerate() {
            // Coefficients n, n − 1 … 0 of `b` with 0, 1 … n of this series.
            *c = self.0.iter().zip(b.0.iter().take(n + 1).rev()).map(|(x, y)| x * y).sum();
        }
        Self(product)
    }

    /// exp of the series without its first coefficient: n·e_n = Σ k·f_k·e_(n−k), k = 1 to n.
    fn turn(&self) -> Self {
        let mut e = [0.0; TERMS];
        for n in 0..TERMS {
            let weighted = self.0.iter().enumerate().skip(1).map(|(k, f)| k as f64 * f);
            let sum: f64 = weighted.zip(e.iter().take(n).rev()).map(|(f, e)| f * e).sum();
            if let Some(place) = e.get_mut(n) {
                *place = if n == 0 { 1.0 } else { sum / n as f64 };
            }
        }
        Self(e)
    }

    /// The sum of both series.
    fn sum(mut self, b: &Self) -> Self {
        for (c, b) in self.0.iter_mut().zip(&b.0) {
            *c += b;
        }
        self
    }

    /// The series plus a constant.
    fn plus(mut self, x: f64) -> Self {
        self.0[0] += x;
        self
    }
}

/// The series of an axis's angle along the curve `course`.
fn turn(course: &Course, rotary: &Rotary) -> Series {
    let none = [0.0; 6];
    let angle = course.angles.get(usize::from(rotary.slot)).unwrap_or(&none);
    Series::polynomial(&angle.map(|c| c.abs() * RADIANS)).turn()
}

/// The series of an arc's radius vector.
fn round(course: &Course) -> Series {
    let Some(round) = &course.round else { return Series::constant(0.0) };
    let turn = [0.0, round.degrees.abs() * RADIANS, 0.0, 0.0, 0.0, 0.0];
    let radius = [round.radius.length(), round.growth.length(), 0.0, 0.0, 0.0, 0.0];
    Series::polynomial(&radius).times(&Series::polynomial(&turn).turn())
}

/// The distance between two centres before and after a turn about `u`: the component across `u`, and the
/// component along `u`.
fn split(r: Vector, u: Vector) -> (f64, f64) {
    let along = u.dot(r);
    (r.minus(u.times(along)).length(), along.abs())
}

/// 64 times the bound (mm) for the error of the tool tip, if one quintic per axis replaces the whole curve
/// `course`. With n equal parts the bound is n⁶ times smaller. The sums are raised by a relative 10^-9, to
/// cover the rounding of `f64`.
pub fn stray(chain: &Chain, course: &Course) -> f64 {
    let [start, rest @ ..] = course.tip;
    let [a, b, c, d, e] = rest.map(Vector::length);
    let mut rotaries = chain.base.iter().flatten();
    // Without a rotary axis before the linear axes, a polynomial of the tool tip is also a polynomial of the
    // axes.
    let arc = round(course);
    let mut outer = arc;
    if let Some(first) = rotaries.next() {
        let from = start.minus(first.point).length();
        outer = Series::polynomial(&[from, a, b, c, d, e]).sum(&arc).times(&turn(course, first));
        let mut centre = first.point;
        for rotary in rotaries {
            let (across, along) = split(centre.minus(rotary.point), rotary.direction);
            outer = outer.plus(across).times(&turn(course, rotary)).plus(along);
            centre = rotary.point;
        }
    }
    let (mut inner, mut centre) = (Series::constant(0.0), chain.tip);
    for rotary in chain.head.iter().flatten().rev().take(ROTARIES) {
        let (across, along) = split(centre.minus(rotary.point), rotary.direction);
        inner = inner.plus(across).times(&turn(course, rotary)).plus(along);
        centre = rotary.point;
    }
    let [.., outer] = outer.0;
    let [.., inner] = inner.0;
    (outer + inner) * (1.0 + 1e-9)
}

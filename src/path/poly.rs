//! A polynomial of the fifth degree for every axis, over a path distance. The polynomial has given position,
//! direction and curvature at both ends. These values decide how closely the path distance agrees with the
//! arc length.
//!
//! ```text
//! x_k = base_k + gain_k·w + 2^(12 − down_k)·τ²·(c_k2 + τ·(c_k3 + τ·(c_k4 + τ·c_k5)))      τ = w / 2^62
//! ```
//!
//! `w` is the path distance with 62 bits, as in [`super::Shape`]. `down_k` scales the coefficients of an
//! axis. The last part of the sum has LSB 2^-42 mm, and its coefficients have 32 bits. The linear part
//! absorbs their rounding error, so the end is exact to the last bit. Direction and curvature at the ends
//! have an error of about 2^-29 of the curve's own values.
//!
//! A cubic needs no curvature at its ends, because position and direction there determine it.
use super::{Curve, Element, End, FINER, GUARD, LONGEST, Shape};
use crate::math::float::{magnitude, max, min, to_bits, to_f32};
use crate::math::root::sqrt_f32;
use crate::math::wide::{mul_near, mul_shift};
use crate::quantity::{Distance, Position};

/// A point of the path, with the direction and curvature that neighbouring curves share there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Knot<const AXES: usize> {
    /// Position of every axis at the point, mm or degrees.
    pub position: [Position; AXES],
    /// Direction and curvature at the point.
    pub end: End<AXES>,
}

impl<const AXES: usize> Knot<AXES> {
    /// An empty knot.
    pub(crate) const BLANK: Self = Self { position: [Position::ZERO; AXES], end: End::BLANK };
}

/// The largest magnitudes of the derivatives along a polynomial, from which its limits follow. For the
/// direction, the value is an upper bound: the largest Bernstein coefficient. For the other derivatives, the
/// value is the largest one at the ends and where the next derivative is zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds<const AXES: usize> {
    /// Largest travel of each axis per path length, |dx/ds|.
    pub first: [f32; AXES],
    /// Largest second derivative of each axis, |d²x/ds²|, 1/mm.
    pub second: [f32; AXES],
    /// Largest third derivative of each axis, |d³x/ds³|, 1/mm².
    pub third: [f32; AXES],
    /// Largest ratio of the speed along the curve to the path speed: 1, or more if the path distance is
    /// shorter than the arc length.
    pub fastest: f32,
    /// Whether and how the speed may change inside the polynomial.
    pub passage: Passage,
}

/// Whether and how the speed may change inside a polynomial.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Passage {
    /// The speed changes inside the element. This is the usual case.
    Varying,
    /// The plan keeps the speed constant in the element; the speed changes before and after it.
    Steady,
    /// The element is part of a curve of many elements; the speed changes over all of them as over one
    /// element.
    Flowing,
    /// The speed is constant, because the program demands it (CONST_VEL).
    Constant,
    /// The speed changes as in a line; acceleration need not be zero at the ends.
    Through,
    /// The parameter of the curve is time. The value is the planned path speed, mm/tick.
    Timed(f32),
}

impl<const AXES: usize> Bounds<AXES> {
    /// Bounds that are zero for every axis; `fastest` as in [`Bounds`].
    pub(super) const fn none(fastest: f32) -> Self {
        let none = [0.0; AXES];
        Self { first: none, second: none, third: none, fastest, passage: Passage::Varying }
    }

    /// Bounds and path length of the curve between two knots, as [`Draft`] makes it. Returns `None` if the
    /// formats cannot hold the curve.
    pub fn between(
        from: &Knot<AXES>,
        to: &Knot<AXES>,
        length: f32,
        fastest: f32,
    ) -> Option<(Distance, Self)> {
        let mut shape = Shape::<AXES>::BLANK;
        shape.measure(length)?;
        let mut bounds = Self::none(fastest);
        let (scale, per) = (Scale::new(length, shape.end_w(), shape.reciprocal()), 1.0 / length);
        for k in 0..AXES {
            let (Some(x0), Some(x1)) = (from.position.get(k), to.position.get(k)) else { return None };
            let (Some(t0), Some(t1)) = (from.end.tangent.get(k), to.end.tangent.get(k)) else { return None };
            let (Some(k0), Some(k1)) = (from.end.curvature.get(k), to.end.curvature.get(k)) else {
                return None;
            };
            let travel = travel(*x0, *x1)?;
            if rests(travel, [*t0, *t1], [*k0, *k1]) {
                continue;
            }
            let made = scale.quintic(travel, [*t0, *t1], [*k0, *k1])?;
            bounds.set(k, &made.bounds, per)?;
        }
        Some((shape.length, bounds))
    }

    /// Sets the bounds of an axis from derivatives over 0..1. `per`: 1 mm divided by the path length.
    #[cfg_attr(feature = "fast", inline(always))]
    pub(super) fn set(&mut self, k: usize, [first, second, third]: &[f32; 3], per: f32) -> Option<()> {
        *self.first.get_mut(k)? = first * per;
        *self.second.get_mut(k)? = second * per * per;
        *self.third.get_mut(k)? = third * per * per * per;
        Some(())
    }

    /// Whether the parameter of the curve is time.
    pub const fn is_timed(&self) -> bool {
        matches!(self.passage, Passage::Timed(_))
    }

    /// Whether the element is a part of a curve of many elements.
    pub const fn flows(&self) -> bool {
        matches!(self.passage, Passage::Flowing)
    }

    /// Whether acceleration may be other than zero at both ends, with known limits.
    pub const fn passes(&self) -> bool {
        self.flows() || self.is_through()
    }

    /// Whether the element is a part of a corner's curve at whose ends acceleration need not be zero.
    pub const fn is_through(&self) -> bool {
        matches!(self.passage, Passage::Through)
    }

    /// Whether a lower speed in the element leaves more acceleration for a change of speed.
    pub const fn trades(&self) -> bool {
        matches!(self.passage, Passage::Timed(_) | Passage::Steady)
    }
}

const LSB_40: f32 = 1.0 / (1u64 << 40) as f32;
const LSB_32: f32 = 1.0 / (1u64 << 32) as f32;

/// The fixed part of a coefficient's exponent: 42 bits of the sum, minus 32 bits and plus 2 bits of the
/// products.
const POINT: i32 = 12;
/// Sums of coefficients stay below 2^30.
const SUM: i32 = 30;

/// τ² times the rest of the polynomial, LSB 2^-42 mm. Runs in the tick.
#[inline(always)]
pub(super) fn bent(w: i64, power: &[i32; 4], down: u8) -> i64 {
    let up = |c: i32| i64::from(c) << 32;
    let [c2, c3, c4, c5] = *power;
    let p = (mul_near(w, up(c5)) << 2).wrapping_add(up(c4));
    let p = (mul_near(w, p) << 2).wrapping_add(up(c3));
    let p = (mul_near(w, p) << 2).wrapping_add(up(c2));
    mul_near(w, mul_near(w, p) << 2) >> (down & 63)
}

/// As [`bent`], for a cubic, with the same bits. Runs in the tick.
#[inline(always)]
pub(super) fn bent_cubic(w: i64, [c2, c3]: [i32; 2], down: u8) -> i64 {
    let up = |c: i32| i64::from(c) << 32;
    let p = (mul_near(w, up(c3)) << 2).wrapping_add(up(c2));
    mul_near(w, mul_near(w, p) << 2) >> (down & 63)
}

/// 2^n for n in -126..128; for other n the nearest of these values.
pub(super) fn power_of_two(n: i32) -> f32 {
    f32::from_bits(((127 + n.clamp(-126, 127)) as u32) << 23)
}

/// The least n with x < 2^n, for x > 0.
fn exponent(x: f32) -> i32 {
    (x.to_bits() >> 23) as i32 - 126
}

/// x·2^n as an integer, if the magnitude of `x`·2^(n − 32) is below 2^31.
#[cfg_attr(feature = "fast", inline(always))]
fn fixed(x: f32, n: i32) -> i64 {
    let upper = magnitude(x) * power_of_two(n - 32);
    let whole = upper as u32;
    let size = (u64::from(whole) << 32 | u64::from(((upper - whole as f32) * TWO_32) as u32)) as i64;
    if x < 0.0 { -size } else { size }
}

const TWO_32: f32 = 4_294_967_296.0;

/// x·2^-n, rounded to nearest, for n in 1..64. All numbers are shifted by the same amount.
#[cfg_attr(feature = "fast", inline(always))]
fn rounded<const N: usize>(x: [i64; N], n: u32) -> [i32; N] {
    let (n, high) = ((n - 1) & 31, n > 32);
    x.map(|x| {
        let size = x.unsigned_abs();
        let (upper, lower) = ((size >> 32) as u32, size as u32);
        let size = if high { upper >> n } else { (upper << 1) << (31 - n) | lower >> n };
        let size = size.wrapping_add(1) >> 1;
        if x < 0 { -(size as i32) } else { size as i32 }
    })
}

/// x·2^n, for n in 0..64. All numbers are shifted by the same amount.
#[cfg_attr(feature = "fast", inline(always))]
fn raised<const N: usize>(mut x: [i64; N], n: u32) -> [i64; N] {
    let (n, high) = (n & 31, n > 31);
    for x in &mut x {
        let (upper, lower) = ((*x >> 32) as u32, *x as u32);
        let [upper, lower] =
            if high { [lower << n, 0] } else { [upper << n | (lower >> 1) >> (31 - n), lower << n] };
        *x = (u64::from(upper) << 32 | u64::from(lower)) as i64;
    }
    x
}

/// x·2^-n, rounded down, for n in 0..64. All numbers are shifted by the same amount.
#[cfg_attr(feature = "fast", inline(always))]
fn lowered<const N: usize>(mut x: [i64; N], n: u32) -> [i64; N] {
    let (n, high) = (n & 31, n > 31);
    for x in &mut x {
        let (upper, lower) = ((*x >> 32) as i32, *x as u32);
        let [upper, lower] = if high {
            [upper >> 31, upper >> n]
        } else {
            [upper >> n, (((upper as u32) << 1) << (31 - n) | lower >> n) as i32]
        };
        *x = i64::from(upper) << 32 | i64::from(lower as u32);
    }
    x
}

/// A polynomial that is not complete yet: each call of [`Self::go_on`] computes a few of its axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Draft<const AXES: usize> {
    /// Both ends.
    ends: [[Position; AXES]; 2],
    /// Path length, mm.
    length: f32,
    /// Number of finished axes.
    made: usize,
    /// Whether the polynomial is a cubic; the caller then sets the bounds of its second and third derivative.
    is_cubic: bool,
}

/// Axes that one call computes.
const AXES_PER_CALL: usize = 4;

/// Largest magnitude of an axis' values, mm, as the exponent of the power of two above it. Below: number of
/// bits that such a value has in a 64-bit number; sums in [`quintic`] use six of the other bits.
const MOST: i32 = 24;
const ROOM: i32 = 57;
/// Smallest magnitude that is not zero, mm.
const LEAST: f32 = LSB_40 * LSB_32;

impl<const AXES: usize> Draft<AXES> {
    /// The curve between two knots with `length` (mm) as path length; no axis is computed yet. `fastest` as
    /// in [`Bounds`]. Returns `None` if the formats cannot hold the curve.
    pub fn new(
        from: &Knot<AXES>,
        to: &Knot<AXES>,
        length: f32,
        fastest: f32,
    ) -> Option<(Element<AXES>, Self)> {
        let mut shape = Shape::BLANK;
        shape.uncurve(length)?;
        let bounds = Some(Bounds::none(fastest));
        let element = Element { shape, entry: from.end, exit: to.end, circle: None, bounds };
        Some((element, Self { ends: [from.position, to.position], length, made: 0, is_cubic: false }))
    }

    /// As [`Self::new`], written into an existing element.
    pub fn begin(
        element: &mut Element<AXES>,
        [from, to]: [&Knot<AXES>; 2],
        length: f32,
        fastest: f32,
    ) -> Option<Self> {
        let Element { shape, entry, exit, circle, bounds } = element;
        shape.uncurve(length)?;
        (*entry, *exit, *circle) = (from.end, to.end, None);
        match bounds {
            Some(bounds) => (bounds.fastest, bounds.passage) = (fastest, Passage::Varying),
            None => *bounds = Some(Bounds::none(fastest)),
        }
        Some(Self { ends: [from.position, to.position], length, made: 0, is_cubic: false })
    }

    /// Makes the curve a cubic: points and directions then determine the curvature at its ends. When the
    /// curve is complete, the caller sets the bounds of its second and third derivative.
    pub fn cubic(self) -> Self {
        Self { is_cubic: true, ..self }
    }

    /// Start of the curve, mm or degrees.
    pub fn from(&self) -> &[Position; AXES] {
        &self.ends[0]
    }

    /// End of the curve, mm or degrees.
    pub fn to(&self) -> &[Position; AXES] {
        &self.ends[1]
    }

    /// Whether all axes are computed.
    pub fn is_done(&self) -> bool {
        self.made >= AXES
    }

    /// Computes the next axes. Returns `None` if the formats cannot hold them.
    pub fn go_on(&mut self, element: &mut Element<AXES>) -> Option<()> {
        let Element { shape, entry, exit, bounds, .. } = element;
        let (end_w, reciprocal) = (shape.end_w(), shape.reciprocal());
        let Curve::Poly { power, down: downs } = &mut shape.curve else { return None };
        let bounds = bounds.as_mut()?;
        let scale = Scale::new(self.length, end_w, reciprocal);
        let [start, end] = &self.ends;
        let made = self.made;
        self.made = AXES.min(made + AXES_PER_CALL);
        for k in made..self.made {
            let (Some(x0), Some(x1)) = (start.get(k), end.get(k)) else { return None };
            let (Some(t0), Some(t1)) = (entry.tangent.get(k), exit.tangent.get(k)) else { return None };
            let (Some(k0), Some(k1)) = (entry.curvature.get(k), exit.curvature.get(k)) else { return None };
            let travel = travel(*x0, *x1)?;
            if rests(travel, [*t0, *t1], [*k0, *k1]) {
                // The old values belong to the previous element.
                (*power.get_mut(k)?, *downs.get_mut(k)?, *shape.gain.get_mut(k)?) = ([0; 4], 0, 0);
                bounds.set(k, &[0.0; 3], 0.0)?;
                continue;
            }
            let per = 1.0 / self.length;
            let (coefficients, down, bent) = if self.is_cubic {
                let made = scale.cubic(travel, [*t0, *t1])?;
                *bounds.first.get_mut(k)? = made.first * per;
                let [c2, c3] = made.coefficients;
                ([c2, c3, 0, 0], made.down, made.bent)
            } else {
                let made = scale.quintic(travel, [*t0, *t1], [*k0, *k1])?;
                bounds.set(k, &made.bounds, per)?;
                (made.coefficients, made.down, made.bent)
            };
            *power.get_mut(k)? = coefficients;
            *downs.get_mut(k)? = down;
            // The error is at most a few LSB, which is less than the guard bits.
            let rest = (travel << GUARD).wrapping_sub(bent);
            *shape.gain.get_mut(k)? = mul_shift(rest, reciprocal, 60);
        }
        Some(())
    }
}

/// A path length (mm) in the format of an element. Returns `None` if the format cannot hold it.
#[cfg_attr(feature = "fast", inline(always))]
pub fn distance(length: f32) -> Option<Distance> {
    let bits = to_bits::<44>(length);
    (bits > 0 && bits < LONGEST).then(|| Distance::from_bits(bits))
}

/// Travel of an axis. Returns `None` if the formats cannot hold it.
#[cfg_attr(feature = "fast", inline(always))]
fn travel(from: Position, to: Position) -> Option<i64> {
    const MOST: i64 = LONGEST >> FINER;
    let upper = |x: Position| (x.to_bits() >> 32) as i32;
    upper(to).checked_sub(upper(from))?;
    let travel = to.to_bits().wrapping_sub(from.to_bits());
    // True for −MOST up to, not including, MOST.
    (travel.wrapping_add(MOST) as u64 >> (MOST.trailing_zeros() + 1) == 0).then_some(travel)
}

/// Whether an axis does not move: all values are zero.
#[cfg_attr(feature = "fast", inline(always))]
fn rests(travel: i64, [t0, t1]: [i64; 2], [k0, k1]: [f32; 2]) -> bool {
    travel | t0 | t1 == 0 && k0 == 0.0 && k1 == 0.0
}

impl<const AXES: usize> Shape<AXES> {
    /// Sets the path length, mm.
    #[cfg_attr(feature = "fast", inline(always))]
    fn measure(&mut self, length: f32) -> Option<()> {
        self.length = distance(length)?;
        self.shift = Self::shift_of(self.length);
        Some(())
    }

    /// Makes the element a polynomial of this length (mm). The values of its axes are undefined until they
    /// are computed.
    #[cfg_attr(feature = "fast", inline(always))]
    fn uncurve(&mut self, length: f32) -> Option<()> {
        self.measure(length)?;
        if !matches!(self.curve, Curve::Poly { .. }) {
            self.curve = Curve::Poly { power: [[0; 4]; AXES], down: [0; AXES] };
        }
        Some(())
    }
}

/// Values that all axes of an element share.
pub(super) struct Scale {
    /// The path length in mm, its square, and its form mantissa·2^`up`. The mantissa has 24 bits and 38 zeros
    /// below.
    length: f32,
    square: f32,
    mantissa: i64,
    up: i32,
    /// τ at the end, times 2^62.
    end_w: i64,
    /// Second to fifth power of 1/τ at the end, each in 1..2, with 60, 58, 56 and 54 fraction bits.
    powers: [i64; 4],
}

impl Scale {
    /// The values for a curve of this `length` (mm). `end_w` and `reciprocal` are those of its [`Shape`].
    pub(super) fn new(length: f32, end_w: i64, reciprocal: i64) -> Self {
        let bits = length.to_bits();
        let mantissa = i64::from(bits & 0x7f_ffff | 0x80_0000) << 38;
        let up = (bits >> 23) as i32 - 150 - 38;
        let square = mul_near(reciprocal, reciprocal);
        let (cube, fourth) = (mul_near(square, reciprocal), mul_near(square, square));
        let powers = [square, cube, fourth, mul_near(fourth, reciprocal)];
        Self { length, square: length * length, mantissa, up, end_w, powers }
    }

    /// First derivatives of an axis over 0..1 at both ends, mm.
    #[cfg_attr(feature = "fast", inline(always))]
    fn slopes(&self, tangents: [i64; 2]) -> [f32; 2] {
        let [t0, t1] = tangents;
        [to_f32(t0) * LSB_40 * self.length, to_f32(t1) * LSB_40 * self.length]
    }

    /// Position of the binary point in 64-bit numbers, for an axis whose values are at most `most`, mm.
    /// Returns `None` for values that are too large.
    #[cfg_attr(feature = "fast", inline(always))]
    fn point(&self, travel: i64, most: f32) -> Option<i32> {
        let above = exponent(max(max(magnitude(to_f32(travel) * LSB_32), most), LEAST));
        if above > MOST { None } else { Some(ROOM - above) }
    }

    /// Travel and first derivatives as numbers with this binary point.
    #[cfg_attr(feature = "fast", inline(always))]
    fn placed(&self, travel: i64, tangents: [i64; 2], point: i32) -> (i64, [i64; 2]) {
        // Tangents are used in full width, so a product has the weight 2^(40 − 64) of its LSB.
        let [t0, t1] = tangents;
        let up = ((t0.unsigned_abs() | t1.unsigned_abs() | 1).leading_zeros() as i32 - 1).max(0);
        // The values are below 2^57 with this binary point.
        let down = (up - 24 - self.up - point).clamp(0, 63);
        let mut slopes = raised(tangents, up as u32);
        for slope in &mut slopes {
            *slope = mul_near(*slope, self.mantissa);
        }
        let [travel] = raised([travel], (point - 32).clamp(0, 63) as u32);
        (travel, lowered(slopes, down as u32))
    }

    /// The polynomial of the fifth degree for one axis, and its bounds over 0..1. Returns `None` if the
    /// formats cannot hold it.
    ///
    /// The calculation uses integers. Without f64 hardware, it takes some hundred instructions, a tenth of
    /// the same calculation in f64.
    #[inline(never)]
    fn quintic(&self, travel: i64, tangents: [i64; 2], curvatures: [f32; 2]) -> Option<Quintic> {
        let slopes = self.slopes(tangents);
        let [v0, v1] = slopes;
        let [w0, w1] = [curvatures[0] * self.square, curvatures[1] * self.square];
        let point = self.point(travel, most(&[v0, v1, w0, w1]))?;
        let (travel, v) = self.placed(travel, tangents, point);
        let a = quintic(travel, v, [fixed(w0, point), fixed(w1, point)]);
        let Scaled { coefficients, down, powers } = self.scaled(a, point)?;
        let [second, third] = bends(powers);
        let bent = bent(self.end_w, &coefficients, down);
        Some(Quintic { coefficients, down, bent, bounds: [fastest(v0, powers), second, third] })
    }

    /// The polynomial of the third degree for one axis, and its bound over 0..1. Returns `None` if the
    /// formats cannot hold it.
    #[inline(never)]
    fn cubic(&self, travel: i64, tangents: [i64; 2]) -> Option<Cubic> {
        let slopes = self.slopes(tangents);
        let point = self.point(travel, most(&slopes))?;
        let (travel, [v0, v1]) = self.placed(travel, tangents, point);
        let (d, e) = (travel - v0, v1 - v0);
        let Scaled { coefficients, down, powers } = self.scaled([3 * d - e, e - (d + d)], point)?;
        let bent = bent_cubic(self.end_w, coefficients, down);
        Some(Cubic { coefficients, down, bent, first: fastest_of_cubic(slopes[0], powers) })
    }

    /// Converts coefficients over 0..1 to coefficients over τ.
    #[cfg_attr(feature = "fast", inline(always))]
    pub(super) fn scaled<const N: usize>(&self, a: [i64; N], point: i32) -> Option<Scaled<N>> {
        let zeros = a.iter().fold(0, |bits, a| bits | a.unsigned_abs()).leading_zeros() as i32;
        if zeros == 64 {
            return Some(Scaled { coefficients: [0; N], down: 0, powers: [0.0; N] });
        }
        // In full width, over τ.
        let (a, point) = (raised(a, (zeros - 1) as u32), point + zeros - 1);
        let unit = power_of_two(32 - point);
        let powers = a.map(|a| (a >> 32) as i32 as f32 * unit);
        let mut b = a;
        for (b, (power, more)) in b.iter_mut().zip(self.powers.iter().zip([6, 4, 2, 0])) {
            *b = mul_near(*b, *power) >> more;
        }
        let sum = b.iter().fold(0, |sum, b| sum + b.unsigned_abs());
        // Bits of the sum, and bits after the binary point.
        let (bits, behind) = (64 - sum.leading_zeros() as i32, point - 10);
        let scale = (SUM + behind - bits).min(POINT + 60);
        if scale < POINT {
            return None;
        }
        let less = (behind - scale).min(63) as u32;
        let coefficients = rounded(b, less);
        Some(Scaled { coefficients, down: (scale - POINT) as u8, powers })
    }
}

/// The part of an axis beyond the linear part, and its bounds over 0..1.
struct Quintic {
    coefficients: [i32; 4],
    down: u8,
    /// The value of this part at the end, LSB 2^-42 mm.
    bent: i64,
    bounds: [f32; 3],
}

/// As [`Quintic`], for a cubic; the caller sets its second and third derivative.
struct Cubic {
    coefficients: [i32; 2],
    down: u8,
    bent: i64,
    first: f32,
}

/// The part beyond the linear part, without bounds.
pub(super) struct Scaled<const N: usize> {
    /// Coefficients from the second power on, and their exponent.
    pub(super) coefficients: [i32; N],
    pub(super) down: u8,
    /// The same coefficients as numbers over 0..1.
    pub(super) powers: [f32; N],
}

/// Coefficients of the second to fifth power over 0..1, from travel, slopes and second derivatives at both
/// ends. With d = travel − v0, e = v1 − v0, and half of w0 and w1, few products are needed.
fn quintic(travel: i64, [v0, v1]: [i64; 2], [w0, w1]: [i64; 2]) -> [i64; 4] {
    let (d, e, p, q) = (travel - v0, v1 - v0, w0 >> 1, w1 >> 1);
    let (e3, p3) = (3 * e, 3 * p);
    [p, 10 * d - (e3 + e) - p3 + q, 7 * e - 15 * d + p3 - (q + q), 6 * d - e3 - p + q]
}

/// The largest magnitude of some values.
fn most(x: &[f32]) -> f32 {
    let mut sizes = x.iter().map(|x| magnitude(*x));
    let first = sizes.next().unwrap_or(0.0);
    sizes.fold(first, max)
}

/// Upper bound of the first derivative over 0..1, including rounding.
pub(super) fn fastest(a1: f32, [a2, a3, a4, a5]: [f32; 4]) -> f32 {
    // Powers p0…pn become Bernstein coefficients Σ C(i,j)/C(n,j)·p_j.
    let p = [a1, 2.0 * a2, 3.0 * a3, 4.0 * a4, 5.0 * a5];
    let (q1, q2, q3) = (p[1] * 0.25, p[2] * (1.0 / 6.0), p[3] * 0.25);
    let first = [
        p[0],
        p[0] + q1,
        p[0] + 2.0 * q1 + q2,
        p[0] + 3.0 * (q1 + q2) + q3,
        p[0] + p[1] + p[2] + p[3] + p[4],
    ];
    most(&first) * SEEN
}

/// As [`fastest`], for a cubic: the last two powers are zero.
fn fastest_of_cubic(a1: f32, [a2, a3]: [f32; 2]) -> f32 {
    let (q1, q2) = (0.5 * a2, 0.5 * a3);
    most(&[a1, a1 + q1, a1 + 2.0 * q1 + q2, a1 + 3.0 * (q1 + q2), a1 + 4.0 * q1 + 6.0 * q2]) * SEEN
}

/// Margin for rounding.
pub(super) const SEEN: f32 = 1.0 + 1.0 / 1_048_576.0;

/// As [`fastest`], for the second and the third derivative.
pub(super) fn bends([a2, a3, a4, a5]: [f32; 4]) -> [f32; 2] {
    let [b0, b1, b2, b3] = [2.0 * a2, 6.0 * a3, 12.0 * a4, 20.0 * a5];
    let second = |u: f32| b0 + u * (b1 + u * (b2 + u * b3));
    let third = |u: f32| b1 + u * (2.0 * b2 + u * (3.0 * b3));
    // Each derivative has its extremes where the next one is zero: at the roots of t² + …. One of the roots
    // needs no subtraction.
    let root = sqrt_f32(max(b2 * b2 - 3.0 * b1 * b3, 0.0));
    let sum = -(b2 + if b2 < 0.0 { -root } else { root });
    let inside = |p: f32, q: f32| if q == 0.0 { 0.0 } else { min(max(p / q, 0.0), 1.0) };
    let seconds = [b0, second(1.0), second(inside(sum, 3.0 * b3)), second(inside(b1, sum))];
    let thirds = [b1, third(1.0), third(inside(-b2, 3.0 * b3))];
    // Rounding of sums of four numbers. Two roots that coincide are accurate to 2^-11.
    let hidden = |p: [f32; 4]| p.iter().map(|p| magnitude(*p)).sum::<f32>() * (1.0 / 1_048_576.0);
    let (of_second, of_third) = (hidden([b0, b1, b2, b3]), hidden([0.0, b1, 2.0 * b2, 3.0 * b3]));
    [most(&seconds) + of_second, most(&thirds) + of_third]
}

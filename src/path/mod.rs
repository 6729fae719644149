//! Geometry over distance: every block becomes an [`Element`], a curve over its own path length. This module
//! does not depend on time.
//!
//! The curve of an element is a [`Shape`]. The parameter `w` is the path distance shifted so that the length
//! of the block has 62 bits; so every factor uses its full width for any length. The position of axis k is
//!
//! ```text
//! x_k = base_k + gain_k·w                                   axes of a line; axes of an arc outside its plane
//! x_p = base_p + a_p(w)·cos φ − a_q(w)·sin φ + miss_p·w     the two axes of an arc's plane
//! x_q = base_q + a_q(w)·cos φ + a_p(w)·sin φ + miss_q·w     with φ = turn·w,  a(w) = a + grow·w
//! ```
//!
//! `base` is the start of a line, or the centre of an arc. `a` is the vector from the centre to the start,
//! and `grow` the change of the radius. `miss` is the difference between the rounded end of the circle and
//! the programmed end; with this term, the curve ends exactly at the programmed point. `miss` and `grow` are
//! so small that the upper half of `w` suffices. A tick only multiplies and adds.
//!
//! The third kind of curve is a polynomial of the fifth degree for every axis ([`mod@poly`]).
mod arc;
mod bend;
mod extent;
mod line;
pub mod measure;
mod merge;
pub mod poly;
#[cfg(feature = "kinematics")]
pub mod powers;
#[cfg(feature = "driven")]
pub mod speed;

pub(crate) use arc::arc_to;
pub use arc::{arc, centre_of_radius};
pub use bend::Swings;
pub use line::line;
pub(crate) use line::{Straight, line_to, straight, straight_line};
pub use measure::Measure;
pub(crate) use merge::{Stretch, TOLERANCE_MM};
pub use poly::{Bounds, Passage};

use crate::math::float::to_f32;
use crate::math::root::sqrt_wide;
use crate::math::trig::sin_cos;
use crate::math::wide::{Halves, mul_near, square_wide};
use crate::nc::Plane;
use crate::quantity::{Decimal, Distance, Position};
use core::hint::black_box;

/// Direction and curvature of all axes over the path length, at one end of an element.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct End<const AXES: usize> {
    /// Direction of each axis: travel per path length (dx/ds), LSB 2^-40.
    pub tangent: [i64; AXES],
    /// Curvature of each axis: d²x/ds², 1/mm.
    pub curvature: [f32; AXES],
}

impl<const AXES: usize> End<AXES> {
    /// An end with direction and curvature zero.
    pub(crate) const BLANK: Self = Self { tangent: [0; AXES], curvature: [0.0; AXES] };

    /// How much the direction of one axis changes from this end to another; 0 if the axis does not exist.
    pub(crate) fn turn(&self, to: &Self, axis: usize) -> f32 {
        let at = |end: &Self| end.tangent.get(axis).copied().unwrap_or(0);
        to_f32(at(to).wrapping_sub(at(self))) * (1.0 / (1u64 << 40) as f32)
    }
}

/// The circle of an arc. The limits of the arc are computed from this data.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Circle {
    /// Indices of the two axes of the circle's plane.
    pub plane: [usize; 2],
    /// The smaller of start and end radius, mm.
    pub radius: f32,
    /// The part of the path that lies in the plane: 1 for an arc, less for a helix.
    pub share: f32,
    /// Angle from the start of the circle to the end of this arc, radians. The circle may have begun in an
    /// earlier arc.
    pub turn: f32,
}

/// A block as a curve: the output of this module.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Element<const AXES: usize> {
    /// The position of every axis over the path length.
    pub shape: Shape<AXES>,
    /// Direction and curvature at the first point.
    pub entry: End<AXES>,
    /// Direction and curvature at the last point.
    pub exit: End<AXES>,
    /// The circle of an arc; `None` for other curves.
    pub circle: Option<Circle>,
    /// Largest derivatives of a polynomial, for its limits; `None` for other curves.
    pub bounds: Option<Bounds<AXES>>,
}

/// Data of an element for the look-ahead.
#[derive(Clone, Copy)]
pub(crate) struct Piece<'a, const AXES: usize> {
    pub shape: &'a Shape<AXES>,
    /// Length of the shape, or of a part of it.
    pub length: Distance,
    /// Whether the piece continues the shape of the piece before.
    pub continued: bool,
    pub entry: &'a End<AXES>,
    pub exit: &'a End<AXES>,
    /// Whether the parameter of the curve is time, and not length.
    pub timed: bool,
    /// Whether the piece belongs to a curve over arc length whose permitted change of speed differs from part
    /// to part.
    pub bent: bool,
    /// Whether the piece belongs to a corner's curve at whose ends acceleration need not be zero.
    pub through: bool,
    /// Whether a lower speed in the piece leaves more acceleration for a change of speed.
    pub trades: bool,
    /// Whether the piece belongs to a curve of many elements.
    pub flows: bool,
}

impl<const AXES: usize> Element<AXES> {
    /// An empty element.
    pub(crate) const BLANK: Self =
        Self { shape: Shape::BLANK, entry: End::BLANK, exit: End::BLANK, circle: None, bounds: None };

    /// The data of this element for the look-ahead.
    #[cfg_attr(feature = "fast", inline(always))]
    pub(crate) fn piece(&self) -> Piece<'_, AXES> {
        let Self { shape, entry, exit, bounds, .. } = self;
        let timed = bounds.as_ref().is_some_and(Bounds::is_timed);
        let trades = bounds.as_ref().is_some_and(Bounds::trades);
        let flows = bounds.as_ref().is_some_and(Bounds::flows);
        let through = bounds.as_ref().is_some_and(Bounds::is_through);
        let bent = bounds.is_some() && !timed && !flows && !through;
        let length = shape.length;
        Piece { shape, length, continued: false, entry, exit, timed, bent, trades, flows, through }
    }
}

/// The reason why a motion block has no valid path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum PathError {
    /// The path of the block is longer than 2^18 mm (262 m).
    TooLong,
    /// The machine lacks a main axis that the plane of the arc needs.
    NoPlane(Plane),
    /// An axis of the plane is not a feed axis.
    NoFeedPlane(Plane),
    /// R is shorter than half the distance from start to end: radius and half distance, LSB 2^-32 mm.
    RadiusTooShort {
        /// R.
        radius: i64,
        /// Half the distance.
        half: i64,
    },
    /// R needs an end point that differs from the start.
    RadiusWithoutEnd,
    /// The start or the end of the arc is at its centre, so the arc has no radius.
    NoRadius,
    /// Distances of start and end from the centre differ too much: LSB 2^-32 mm.
    RadiusDiffers {
        /// Distance of the start.
        start: i64,
        /// Distance of the end.
        end: i64,
    },
}

impl PathError {
    /// Whether the error is about the words for the centre of an arc: R, or I, J and K.
    pub const fn concerns_centre(&self) -> bool {
        !matches!(self, Self::TooLong | Self::NoPlane(_) | Self::NoFeedPlane(_))
    }
}

impl core::fmt::Display for PathError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let mm = |bits| Decimal { bits, decimals: 6 };
        match *self {
            Self::TooLong => f.write_str("block longer than 262 144 mm; split it"),
            Self::NoPlane(plane) => write!(f, "the machine lacks a main axis of the plane {plane:?}"),
            Self::NoFeedPlane(plane) => write!(
                f,
                "an arc in the plane {plane:?}, whose axes the feed does not count along; expected both among the feed axes (P-CHAN-00011, default_feed_axis)"
            ),
            Self::RadiusTooShort { radius, half } => write!(
                f,
                "radius {} mm is shorter than half the distance from start to end, {} mm",
                mm(radius),
                mm(half)
            ),
            Self::RadiusWithoutEnd => f.write_str(
                "an arc by radius ends where it starts; give a full circle by its centre (I, J, K)",
            ),
            Self::NoRadius => {
                f.write_str("start or end of the arc lies on its centre; expected a radius above 0")
            }
            Self::RadiusDiffers { start, end } => write!(
                f,
                "the end is {} mm from the centre, the start {} mm; expected the same radius",
                mm(end),
                mm(start)
            ),
        }
    }
}

impl core::error::Error for PathError {}

/// Longest path length of one block: 2^18 mm, LSB 2^-44 mm.
pub const LONGEST: i64 = 1 << 62;

/// Fraction bits below the LSB of a position, for sums in a tick.
const GUARD: u32 = 10;

/// Half an LSB of a position, in a sum with guard bits.
const HALF: i32 = 1 << (GUARD - 1);

/// A curve over its path length, ready for the tick. See the module for the formula.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shape<const AXES: usize> {
    /// Path length of the curve, above 0.
    pub length: Distance,
    /// Linear part: LSB 2^-42 mm per 2^64 units of `w`.
    gain: [i64; AXES],
    curve: Curve<AXES>,
    /// `w = distance << shift`. `length << shift` is in 2^61..2^62, so that a distance beyond the end still
    /// fits.
    shift: u8,
}

/// The part of the curve beyond the linear part.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Curve<const AXES: usize> {
    /// Nothing: the curve is a line.
    Line,
    /// The circle of an arc.
    Arc(Arc),
    /// A polynomial of each axis: see [`mod@poly`].
    Poly {
        /// Coefficients of the second to the fifth power.
        power: [[i32; 4]; AXES],
        /// Their exponents.
        down: [u8; AXES],
    },
}

/// The part of an arc in its plane. Packed, so that an arc takes hardly more memory than a polynomial of
/// three axes.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, packed(4))]
pub(crate) struct Arc {
    /// Radius vector at the start, LSB 2^-44 mm.
    a: [i64; 2],
    /// The angle by which the radius vector turns: 2^-59 revolutions per 2^64 units of `w`.
    turn: i64,
    /// Growth of the radius vector `a`: 2^-44 mm per 2^51 units of `w`.
    grow: [i32; 2],
    /// Missing distance at the end of the circle, a few nanometres at most: 2^-42 mm per 2^64 units of `w`.
    miss: [i32; 2],
    /// Axes of the plane.
    plane: [u8; 2],
}

impl<const AXES: usize> Shape<AXES> {
    /// An empty shape; all bits zero.
    pub(crate) const BLANK: Self =
        Self { length: Distance::ZERO, gain: [0; AXES], curve: Curve::Line, shift: 0 };

    /// A shape of this length in which no axis moves yet.
    fn resting(length: Distance) -> Self {
        Self { length, gain: [0; AXES], curve: Curve::Line, shift: Self::shift_of(length) }
    }

    /// As [`Self::resting`], in place.
    fn rest(&mut self, length: Distance) {
        (self.length, self.gain, self.curve) = (length, [0; AXES], Curve::Line);
        self.shift = Self::shift_of(length);
    }

    fn shift_of(length: Distance) -> u8 {
        (length.to_bits().leading_zeros() as u8).saturating_sub(2)
    }

    /// The curve from its parts, as [`Self::linear`] and [`Self::bent`] return them.
    pub(crate) fn of_parts(
        length: Distance,
        Linear { gain, shift }: Linear<'_, AXES>,
        bent: Bent<'_, AXES>,
    ) -> Self {
        let curve = match bent {
            Bent::Line => Curve::Line,
            Bent::Arc(arc) => Curve::Arc(*arc),
            Bent::Poly(power, down) => Curve::Poly { power: *power, down: *down },
        };
        Self { length, gain: *gain, curve, shift }
    }

    /// The linear part of the curve.
    #[inline(always)]
    pub(crate) const fn linear(&self) -> Linear<'_, AXES> {
        Linear { gain: &self.gain, shift: self.shift }
    }

    /// The part of the curve beyond the linear part.
    #[inline(always)]
    pub(crate) const fn bent(&self) -> Bent<'_, AXES> {
        match &self.curve {
            Curve::Line => Bent::Line,
            Curve::Arc(arc) => Bent::Arc(arc),
            Curve::Poly { power, down } => Bent::Poly(power, down),
        }
    }

    /// Whether the shape is a line.
    pub(crate) fn is_line(&self) -> bool {
        matches!(self.curve, Curve::Line)
    }

    /// Whether the shape is an arc.
    pub fn is_arc(&self) -> bool {
        matches!(self.curve, Curve::Arc(_))
    }

    /// For an arc: its radius at the start, LSB 2^-44 mm, and its angle from the first axis of its plane
    /// towards the second one, 2^-59 revolutions.
    #[cfg(feature = "plc")]
    pub(crate) fn turn(&self) -> Option<(u64, i64)> {
        let Curve::Arc(arc) = self.curve else { return None };
        let [p, q] = arc.a.map(|a| square_wide(a.unsigned_abs()));
        let (lower, carry) = p.1.overflowing_add(q.1);
        let upper = p.0.wrapping_add(q.0).wrapping_add(carry.into());
        Some((sqrt_wide(upper, lower), mul_near(self.end_w(), arc.turn)))
    }

    /// The base of the formula of this module, as [`Self::at`] needs it, for a block that begins at `start`.
    /// For an arc, the base contains the centre of the circle.
    pub fn base(&self, start: &[Position; AXES]) -> [Position; AXES] {
        let mut base = *start;
        if let Curve::Arc(arc) = self.curve {
            for (axis, a) in arc.plane.into_iter().zip(arc.a) {
                if let Some(x) = base.get_mut(axis as usize) {
                    *x = Position::from_bits(x.to_bits().wrapping_sub(a >> 12));
                }
            }
        }
        base
    }

    /// The variable `w` of the formula: `distance << shift`.
    #[inline(always)]
    fn w(&self, distance: i64) -> i64 {
        self.linear().w(distance)
    }

    /// Writes the position of every axis at `distance` (LSB 2^-44 mm) from the start of the block to `out`.
    /// The error against the exact curve is half an LSB of a position; an arc has an error of 2^-44 of its
    /// radius in addition. At both ends the error is 0.
    #[inline(always)]
    pub fn at(&self, distance: i64, base: &[Position; AXES], out: &mut [Position; AXES]) {
        let w = self.w(distance);
        *out = *base;
        match &self.curve {
            Curve::Line => {}
            Curve::Arc(arc) => arc.add(w, out),
            Curve::Poly { power, down } => return add_poly(w, &self.gain, (power, down), out),
        }
        self.linear().add(w, base, out);
    }

    /// As [`Self::at`], but not inlined. Do not call this function in the tick.
    #[inline(never)]
    pub fn put(&self, distance: i64, base: &[Position; AXES], out: &mut [Position; AXES]) {
        self.at(distance, base, out);
    }

    /// The point at `distance` in a block that begins at `start`, as [`Self::at`] computes it. Do not call
    /// this function in the tick.
    pub fn point(&self, distance: i64, start: &[Position; AXES]) -> [Position; AXES] {
        self.placed(distance, &self.base(start))
    }

    /// As [`Self::point`], for a block with this base.
    #[inline(never)]
    pub(crate) fn placed(&self, distance: i64, base: &[Position; AXES]) -> [Position; AXES] {
        let mut point = *base;
        self.put(distance, base, &mut point);
        point
    }

    /// Writes the positions at the end of the shape to `out`. For a line, there is no branch for each axis; a
    /// branch would keep the halves of `w` in separate registers.
    #[cfg_attr(feature = "fast", inline(always))]
    pub(crate) fn end(&self, base: &[Position; AXES], out: &mut [Position; AXES]) {
        if !self.is_line() {
            return self.put(self.length.to_bits(), base, out);
        }
        let w = self.end_w();
        for ((x, base), gain) in out.iter_mut().zip(base).zip(&self.gain) {
            *x = add(*base, mul_near(w, *gain));
        }
    }
}

/// The linear part of a curve, by reference.
#[derive(Clone, Copy)]
pub(crate) struct Linear<'a, const AXES: usize> {
    pub gain: &'a [i64; AXES],
    pub shift: u8,
}

/// The part beyond the linear part, by reference.
#[derive(Clone, Copy)]
pub(crate) enum Bent<'a, const AXES: usize> {
    /// Nothing: the curve is a line.
    Line,
    /// The circle of an arc.
    Arc(&'a Arc),
    /// Coefficients of a polynomial, and their exponents.
    Poly(&'a [[i32; 4]; AXES], &'a [u8; AXES]),
}

impl<const AXES: usize> Linear<'_, AXES> {
    /// The variable `w`: `distance << shift`, word by word. With a branch that nearly always goes the same
    /// way, this takes fewer instructions than a shift of two words.
    #[inline(always)]
    pub fn w(&self, distance: i64) -> i64 {
        let (upper, lower) = ((distance >> 32) as u32, distance as u32);
        let shift = u32::from(self.shift);
        let (upper, lower) = if shift < 32 {
            (upper << shift | lower >> 1 >> (31 - shift), lower << shift)
        } else {
            (lower << (shift & 31), 0)
        };
        (u64::from(upper) << 32 | u64::from(lower)) as i64
    }

    /// Adds the linear part at `w` to `base`, for the axes that it moves. Runs in the tick.
    #[inline(always)]
    pub fn add(&self, w: i64, base: &[Position; AXES], out: &mut [Position; AXES]) {
        for ((x, base), gain) in out.iter_mut().zip(base).zip(self.gain) {
            if *gain != 0 {
                // Hidden from the optimiser in each branch. Otherwise the sign of the upper word would get
                // its own word, and each product would become three products.
                let w = black_box(Halves::of(w));
                *x = add(*base, w.times(Halves::of(*gain)));
            }
        }
    }
}

/// Adds a polynomial of the third degree at `w`. The result has the same bits as that of [`add_poly`]. Runs
/// in the tick.
#[inline(always)]
pub(crate) fn add_cubic<const AXES: usize>(
    w: i64,
    gain: &[i64; AXES],
    (power, down): (&[[i32; 4]; AXES], &[u8; AXES]),
    out: &mut [Position; AXES],
) {
    // The loop is not unrolled, because that would take much flash for little gain.
    let axes = black_box(AXES);
    for ((x, gain), ([c2, c3, ..], down)) in out.iter_mut().zip(gain).zip(power.iter().zip(down)).take(axes) {
        // Hidden from the optimiser, as in [`Linear::add`].
        let w = black_box(w);
        *x = add(*x, mul_near(w, *gain).wrapping_add(poly::bent_cubic(w, [*c2, *c3], *down)));
    }
}

/// Adds a polynomial at `w`. Runs in the tick.
#[inline(always)]
pub(crate) fn add_poly<const AXES: usize>(
    w: i64,
    gain: &[i64; AXES],
    (power, down): (&[[i32; 4]; AXES], &[u8; AXES]),
    out: &mut [Position; AXES],
) {
    for ((x, gain), (power, down)) in out.iter_mut().zip(gain).zip(power.iter().zip(down)) {
        // Hidden from the optimiser for each axis. Otherwise the loop would keep the sign of the upper word
        // separately, and each product would become three products.
        let w = black_box(w);
        *x = add(*x, mul_near(w, *gain).wrapping_add(poly::bent(w, power, *down)));
    }
}

impl Arc {
    /// Adds the circle at `w` to the axes of its plane. Runs in the tick.
    #[inline(always)]
    pub fn add<const AXES: usize>(&self, w: i64, out: &mut [Position; AXES]) {
        // The axes of the plane exist. `min` tells the compiler so without a branch; a branch would keep the
        // products in separate registers.
        let ([p, q], last) = (self.plane, AXES.saturating_sub(1));
        let (p, q) = ((p as usize).min(last), (q as usize).min(last));
        let [x, y] = self.circle(Halves::of(w), HALF);
        out[p] = Position::from_bits(out[p].to_bits().wrapping_add(x >> GUARD));
        out[q] = Position::from_bits(out[q].to_bits().wrapping_add(y >> GUARD));
    }

    /// The radius vector at `w`, LSB 2^-42 mm. `more`: number of additional guard bits.
    #[inline(always)]
    fn circle(&self, w: Halves, more: i32) -> [i64; 2] {
        let Self { a, turn, grow, miss, .. } = *self;
        let (sin, cos) = sin_cos((w.times(Halves::of(turn)) << 5) as u64);
        let upper = w.upper();
        // Written out one by one. With an index or a closure, the code could contain a panic in builds that
        // are optimised for size.
        let ([p, q], [grow_p, grow_q], [x, y]) = (a, grow, miss);
        let p = p.wrapping_add((upper * i64::from(grow_p)) >> 19);
        let q = q.wrapping_add((upper * i64::from(grow_q)) >> 19);
        let (x, y) = (((upper * i64::from(x)) >> 32) as i32, ((upper * i64::from(y)) >> 32) as i32);
        let (x, y) = (i64::from(x.wrapping_add(more)), i64::from(y.wrapping_add(more)));
        let (p, q, cos, sin) = (Halves::of(p), Halves::of(q), Halves::of(cos), Halves::of(sin));
        [x.wrapping_add(p.turn(cos, q, sin.negated())), y.wrapping_add(q.turn(cos, p, sin))]
    }
}

/// `base` plus an offset of 2^-42 mm, rounded to nearest.
#[inline(always)]
fn add(base: Position, offset: i64) -> Position {
    let rounded = offset.wrapping_add(1 << (GUARD - 1)) >> GUARD;
    Position::from_bits(base.to_bits().wrapping_add(rounded))
}

/// The length of these travels (LSB of a position, below 2^50) as a distance: the square root of the sum of
/// squares, rounded down.
#[cfg_attr(feature = "fast", inline(always))]
fn travelled(travel: impl IntoIterator<Item = i64>) -> i64 {
    let (mut high, mut low) = (0u64, 0u64);
    for x in travel.into_iter().filter(|x| *x != 0) {
        let (hi, lo) = square_wide(x.unsigned_abs());
        let (sum, carry) = low.overflowing_add(lo);
        low = sum;
        high += hi + u64::from(carry);
    }
    let (high, low) = (high << (2 * FINER) | low >> (64 - 2 * FINER), low << (2 * FINER));
    i64::try_from(sqrt_wide(high, low)).unwrap_or(i64::MAX)
}

/// Additional fraction bits of a distance, compared with a position.
const FINER: u32 = 12;

/// The bitwise OR of all magnitudes of travel: at least the largest magnitude, and below twice the largest.
#[cfg_attr(feature = "fast", inline(always))]
fn reach<const AXES: usize>(travel: &[i64; AXES]) -> u64 {
    travel.iter().fold(0, |bits, x| bits | x.unsigned_abs())
}

/// Path length of a block. `along`: the result of [`Measure::travelled`], LSB 2^-44 mm. If `along` is zero,
/// the length counts along all axes together. If an axis moves more than 1024 degrees or millimetres per
/// millimetre of path, a 1024th of its travel counts, so that a distance still resolves this axis.
#[cfg_attr(feature = "fast", inline(always))]
fn path_length<const AXES: usize>(along: i64, travel: &[i64; AXES]) -> Result<Distance, PathError> {
    let length = if along == 0 {
        travelled(travel.iter().copied())
    } else if reach(travel) << (FINER - 10) <= along.unsigned_abs() {
        along
    } else {
        // The axes that count give a length above a 1024th of their own travel.
        travel.iter().map(|x| x.wrapping_abs() << (FINER - 10)).fold(along, i64::max)
    };
    if length < LONGEST { Ok(Distance::from_bits(length)) } else { Err(PathError::TooLong) }
}

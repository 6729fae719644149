//! G02 and G03: arcs, full circles and helices, with the centre (I, J, K) or with the radius (R).
//!
//! Programmed coordinates have few decimals, so start and end rarely have the same distance from the centre.
//! The radius then changes linearly with the angle, from the distance of the start to that of the end.
use super::measure::Main;
use super::{
    Arc, Circle, Curve, Element, End, FINER, GUARD, LONGEST, Measure, PathError, Shape, path_length, reach,
};
use crate::math::angle::atan2_turns;
use crate::math::divide::{div_wide, reciprocal_near};
use crate::math::float::{size_f32, to_f32};
use crate::math::root::{sqrt_f32, sqrt_wide};
use crate::math::wide::{Halves, mul_hi, mul_shift, mul_wide, square_wide};
use crate::nc::Plane;
use crate::quantity::{DISTANCE_LSB, Distance, Position};

/// 2π, LSB 2^-60.
const TWO_PI: i64 = 0x6487_ED51_10B4_611A;

/// Start and end count as the same point if they are closer than this in both axes of the plane: 2^-20 mm,
/// about a nanometre.
const SAME_POINT: i64 = 1 << 12;

/// Directions of start and end whose difference is below 2^-54 revolutions (LSB 2^-64) count as equal: a
/// tenth of a picometre at the largest radius.
const SAME_DIRECTION: u64 = 1 << 10;

/// Radii may differ by 2 µm for any radius: coordinates of three decimals cause such differences.
const DIFFERENCE: i64 = 8_589_935 << FINER;
/// Radii may also differ by a 1024th of the start radius, up to 50 µm. ISG sets these limits by P-CHAN-00171
/// and P-CHAN-00172, and gives no defaults.
const LARGEST_DIFFERENCE: i64 = 214_748_365 << FINER;

/// Half a chord may exceed the radius by 1 µm; this counts as rounding. A larger excess is an error.
const CHORD_EXCESS: i64 = 4_294_967;

/// Makes the arc from `start` to `target` about `centre`, which has absolute coordinates of the plane's two
/// axes. A target equal to the start means a full circle. Axes outside the plane move linearly. A third main
/// axis makes the arc a helix, and a feed axis outside the plane makes its path longer.
///
/// # Errors
/// See [`PathError`].
pub fn arc<const AXES: usize>(
    start: &[Position; AXES],
    target: &[Position; AXES],
    centre: [Position; 2],
    plane: Plane,
    clockwise: bool,
    measure: &Measure,
) -> Result<Element<AXES>, PathError> {
    let mut element = Element::BLANK;
    arc_to([start, target], (centre, plane, clockwise), measure, &mut element)?;
    Ok(element)
}

/// As [`arc`], written into an existing element: a returned element would be on the stack several times.
///
/// # Errors
/// See [`PathError`]; the element does not change.
pub(crate) fn arc_to<const AXES: usize>(
    [start, target]: [&[Position; AXES]; 2],
    (centre, plane, clockwise): ([Position; 2], Plane, bool),
    measure: &Measure,
    element: &mut Element<AXES>,
) -> Result<(), PathError> {
    let axes = plane_axes(plane, &measure.main)?;
    if !measure.is_space() && !axes.iter().all(|k| measure.feeds(*k)) {
        return Err(PathError::NoFeedPlane(plane));
    }
    let mut travel = [0; AXES];
    let points = points(start, target, centre, axes, &mut travel)?;
    let lengths = lengths(points, measure.is_tolerant())?;
    let ends = Ends::new(points, lengths);
    let swept = ends.swept(clockwise);
    let angle = mul_shift(swept, TWO_PI, 60);
    let [len0, len1] = ends.lengths;
    if mul_hi(len0.max(len1), angle) >= LONGEST >> 4 {
        return Err(PathError::TooLong);
    }
    let difference = len1 - len0;
    let plane0 = mul_shift(len0, angle, 60);
    let plane1 = if difference == 0 { plane0 } else { mul_shift(len1, angle, 60) };
    let outside = outside(&travel, axes);
    let flat = reach(&outside) == 0;
    let outer = if flat { None } else { Some(&outside) };
    let travelled = travelled(plane0.max(plane1), difference, outer, measure);
    // One LSB more, because a chord is never longer than its path.
    let length = if flat && measure.is_space() {
        if travelled + 1 >= LONGEST {
            return Err(PathError::TooLong);
        }
        Distance::from_bits(travelled + 1)
    } else {
        path_length(measure.resolved(travelled, &travel) + 1, &travel)?
    };
    let Element { shape, entry, exit, .. } = element;
    shape.rest(length);
    let whole = shape.reciprocal();
    let reciprocal = Halves::of(whole);
    (entry.tangent, entry.curvature) = ([0; AXES], [0.0; AXES]);
    if !flat {
        shape.set_gains_by(&outside, whole);
        entry.tangent = shape.linear_tangent();
    }
    *exit = *entry;
    let sweep = if clockwise { -swept } else { swept };
    let circle = ends.circle(axes, sweep, shape, reciprocal);
    shape.curve = Curve::Arc(circle);

    // A length as a fraction of the block's length, with 60 fraction bits.
    let part = |length: i64| part(length, shape.shift, reciprocal);
    let outward = Halves::of(part(difference));
    let end = |radius: &Radius, plane: i64, len: i64, end: &mut End<AXES>| {
        let along = part(plane);
        let share = size_f32(along as u64) * LSB_60;
        let along = Halves::of(if clockwise { -along } else { along });
        let [p, q] = [Halves::of(radius.unit[0]), Halves::of(radius.unit[1])];
        // With 56 fraction bits.
        let tangent = [p.turn(outward, q.negated(), along), q.turn(outward, p, along)];
        let bend = -(share * share) / (to_f32(len) * DISTANCE_LSB) * LSB_28;
        for i in 0..2 {
            if let (Some(t), Some(c)) = (end.tangent.get_mut(axes[i]), end.curvature.get_mut(axes[i])) {
                *t = (tangent[i] + (1 << 15)) >> 16;
                *c = (radius.unit[i] >> 32) as i32 as f32 * bend;
            }
        }
        share
    };
    let share0 = end(&ends.radii[0], plane0, len0, entry);
    let share1 = end(&ends.radii[1], plane1, len1, exit);
    element.bounds = None;
    element.circle = Some(Circle {
        plane: axes,
        radius: to_f32(len0.min(len1)) * DISTANCE_LSB,
        share: if share0 > share1 { share0 } else { share1 },
        turn: size_f32(angle as u64) * LSB_60,
    });
    Ok(())
}

/// Travel of the axes outside the plane.
#[cfg_attr(feature = "fast", inline(always))]
fn outside<const AXES: usize>(travel: &[i64; AXES], plane: [usize; 2]) -> [i64; AXES] {
    let mut outside = *travel;
    for k in plane {
        if let Some(travel) = outside.get_mut(k) {
            *travel = 0;
        }
    }
    outside
}

/// Start and end of an arc in its plane. Points are relative to the centre.
struct Ends {
    /// Both points, LSB 2^-44 mm.
    points: [[i64; 2]; 2],
    /// Their distances from the centre, LSB 2^-44 mm.
    lengths: [i64; 2],
    radii: [Radius; 2],
    /// Whether the points differ by more than [`SAME_POINT`].
    apart: bool,
}

/// Start and end of an arc in its plane relative to `centre`, LSB 2^-44 mm, and the travel of every axis.
#[cfg_attr(feature = "fast", inline(always))]
fn points<const AXES: usize>(
    start: &[Position; AXES],
    target: &[Position; AXES],
    centre: [Position; 2],
    axes: [usize; 2],
    travel: &mut [i64; AXES],
) -> Result<[[i64; 2]; 2], PathError> {
    let (mut bits, mut over) = (0i64, false);
    for ((travel, from), to) in travel.iter_mut().zip(start).zip(target) {
        let wide;
        (*travel, wide) = to.to_bits().overflowing_sub(from.to_bits());
        over |= wide;
        bits |= *travel ^ *travel >> 63;
    }
    let at = |k: usize| (start.get(k).map_or(0, |x| x.to_bits()), travel.get(k).copied().unwrap_or(0));
    let [(p, dp), (q, dq)] = [at(axes[0]), at(axes[1])];
    let ((p0, wide_p), (q0, wide_q)) =
        (p.overflowing_sub(centre[0].to_bits()), q.overflowing_sub(centre[1].to_bits()));
    let ((p1, wider_p), (q1, wider_q)) = (p0.overflowing_add(dp), q0.overflowing_add(dq));
    over |= wide_p | wide_q | wider_p | wider_q;
    for x in [p0, q0, p1, q1] {
        // Doubled magnitudes: a coordinate may use half of the range.
        bits |= x << 1 ^ x >> 63;
    }
    if over || bits as u64 >= (LONGEST >> FINER) as u64 {
        return Err(PathError::TooLong);
    }
    Ok([[p0 << FINER, q0 << FINER], [p1 << FINER, q1 << FINER]])
}

/// Distances of both points from the centre, LSB 2^-44 mm. `tolerant`: the distances may differ as much as
/// LinuxCNC and Grbl permit.
#[cfg_attr(feature = "fast", inline(always))]
fn lengths(points: [[i64; 2]; 2], tolerant: bool) -> Result<[i64; 2], PathError> {
    let [len0, len1] = points.map(plane_hypot);
    if len0 == 0 || len1 == 0 {
        return Err(PathError::NoRadius);
    }
    let difference = (len1 - len0).abs();
    if tolerant && is_tolerable(difference, len0.min(len1)) {
        return Ok([len0, len1]);
    }
    if difference > DIFFERENCE && difference > LARGEST_DIFFERENCE.min(len0 >> 10) {
        return Err(PathError::RadiusDiffers { start: len0 >> FINER, end: len1 >> FINER });
    }
    Ok([len0, len1])
}

/// Whether an arc of LinuxCNC or Grbl may have this difference of radii. 5 µm are permitted, but at most a
/// quarter of the radius, because the path would not be an arc. 0.1 % of the radius is also permitted, but at
/// most 50 µm. These controllers permit up to 0.5 mm, but the format of the interrupt only has room for 50
/// µm.
fn is_tolerable(difference: i64, radius: i64) -> bool {
    const ALWAYS: i64 = 21_474_836 << FINER;
    difference <= ALWAYS.min(radius >> 2) || difference <= LARGEST_DIFFERENCE.min(radius / 1000)
}

impl Ends {
    #[cfg_attr(feature = "fast", inline(always))]
    fn new(points: [[i64; 2]; 2], lengths: [i64; 2]) -> Self {
        let [[p0, q0], [p1, q1]] = points;
        let far = |from: i64, to: i64| (to - from).abs() > SAME_POINT << FINER;
        let apart = far(p0, p1) || far(q0, q1);
        let radii = [Radius::new(points[0], lengths[0]), Radius::new(points[1], lengths[1])];
        Self { points, lengths, radii, apart }
    }

    /// The angle of the arc, LSB 2^-60 revolutions.
    #[cfg_attr(feature = "fast", inline(always))]
    fn swept(&self, clockwise: bool) -> i64 {
        let turned = self.radii[0].angle_to(&self.radii[1]);
        let turned = if clockwise { turned.wrapping_neg() } else { turned };
        if self.apart && turned >= SAME_DIRECTION { (turned >> 4) as i64 } else { 1 << 60 }
    }

    /// The circle in the format of the tick, for a shape whose length is known. `sweep`: angle, LSB 2^-60
    /// revolutions, positive counter-clockwise.
    #[cfg_attr(feature = "fast", inline(always))]
    fn circle<const AXES: usize>(
        &self,
        axes: [usize; 2],
        sweep: i64,
        shape: &Shape<AXES>,
        reciprocal: Halves,
    ) -> Arc {
        let [len0, len1] = self.lengths;
        let mut circle = Arc {
            a: self.points[0],
            turn: Halves::of(sweep << 2).times(reciprocal) << 1,
            grow: [0; 2],
            miss: [0; 2],
            plane: [axes[0] as u8, axes[1] as u8],
        };
        if len1 != len0 {
            // Below 2^40: 2^-44 mm per 2^-18 units of `w`.
            let growth = Halves::of((len1 - len0) << 22).times(reciprocal);
            let grow = |unit: i64| ((Halves::of(unit).times(Halves::of(growth)) + (1 << 26)) >> 27) as i32;
            circle.grow = [grow(self.radii[0].unit[0]), grow(self.radii[0].unit[1])];
        }
        // The error of the turn is at most 2^-56 revolutions. It adds to the missing part at the end, which
        // is smaller than the guard bits.
        let end = circle.circle(Halves::of(shape.end_w()), 0);
        let missed = |i: usize| {
            let missed = (self.points[1][i] >> (FINER - GUARD)).wrapping_sub(end[i]);
            ((Halves::of(missed << 12).times(reciprocal) + (1 << 7)) >> 8) as i32
        };
        circle.miss = [missed(0), missed(1)];
        circle
    }
}

/// Path length along the feed axes, LSB 2^-44 mm. The length has three parts: `along` the circle, the
/// `difference` of both radii, and the travel of the axes `outside` the plane, if there is any.
#[cfg_attr(feature = "fast", inline(always))]
fn travelled<const AXES: usize>(
    along: i64,
    difference: i64,
    outside: Option<&[i64; AXES]>,
    measure: &Measure,
) -> i64 {
    let small = difference.unsigned_abs() as u32;
    let counts = outside.is_some()
        || u64::from(small) != difference.unsigned_abs()
        || u64::from(small) * u64::from(small) > along as u64;
    if !counts {
        // The square of the exact length is below that of the next LSB.
        return along;
    }
    let mut square = with_square(square_wide(along as u64), difference);
    for (k, x) in outside.into_iter().flatten().enumerate() {
        if *x != 0 && measure.feeds(k) {
            square = with_square(square, x << FINER);
        }
    }
    i64::try_from(sqrt_wide(square.0, square.1)).unwrap_or(i64::MAX - 1)
}

#[cfg_attr(feature = "fast", inline(always))]
fn part(length: i64, shift: u8, reciprocal: Halves) -> i64 {
    Halves::of(length << (shift & 63)).times(reciprocal)
}

/// The vector from the centre to the start or to the end of an arc.
struct Radius {
    /// The vector, scaled to a length in 2^61..2^62.
    direction: [Halves; 2],
    /// Direction with length 1, LSB 2^-60; error at most 2^-56.
    unit: [i64; 2],
}

impl Radius {
    /// A radius from its vector and the vector's length, which is above 0 and below 2^62.
    #[cfg_attr(feature = "fast", inline(always))]
    fn new(vector: [i64; 2], length: i64) -> Self {
        let shift = (length.leading_zeros().saturating_sub(2)) & 63;
        let reciprocal = Halves::of(reciprocal_near((length as u64) << shift << 2) as i64);
        let [p, q] = [Halves::of(vector[0] << shift), Halves::of(vector[1] << shift)];
        Self { direction: [p, q], unit: [p.times(reciprocal), q.times(reciprocal)] }
    }

    /// The counter-clockwise angle from this vector to the other, 2^-64 revolutions; error at most 2^-58
    /// revolutions.
    #[cfg_attr(feature = "fast", inline(always))]
    fn angle_to(&self, other: &Self) -> u64 {
        let ([p0, q0], [p1, q1]) = (self.direction, other.direction);
        atan2_turns(p0.turn(q1, q0.negated(), p1), p0.turn(p1, q0, q1))
    }
}

/// Length of a vector in the plane, rounded down. Each component is within ±2^62.
#[cfg_attr(feature = "fast", inline(always))]
pub(super) fn plane_hypot([p, q]: [i64; 2]) -> i64 {
    let (high, low) = with_square(square_wide(p.unsigned_abs()), q);
    sqrt_wide(high, low) as i64
}

/// The sum of two squares: a sum in two words plus the square of `x`.
#[cfg_attr(feature = "fast", inline(always))]
fn with_square((high, low): (u64, u64), x: i64) -> (u64, u64) {
    let (more, lower) = square_wide(x.unsigned_abs());
    let (low, carry) = low.overflowing_add(lower);
    (high.saturating_add(more + u64::from(carry)), low)
}

/// 2^-28; below: 2^-60.
const LSB_28: f32 = 1.0 / (1u64 << 28) as f32;
const LSB_60: f32 = 1.0 / (1u64 << 60) as f32;

fn plane_axes(plane: Plane, main: &Main) -> Result<[usize; 2], PathError> {
    let [p, q] = plane.main_axes();
    match (main.get(p), main.get(q)) {
        (Some(p), Some(q)) => Ok([p, q]),
        _ => Err(PathError::NoPlane(plane)),
    }
}

/// Centre of an arc that has a radius instead of a centre, rounded to the LSB of a position. Two such arcs
/// lead through both points. A positive radius selects the arc of at most 180°, a negative radius the other
/// one.
///
/// # Errors
/// [`PathError::RadiusWithoutEnd`], [`PathError::RadiusTooShort`], [`PathError::NoRadius`],
/// [`PathError::NoPlane`], [`PathError::TooLong`].
pub fn centre_of_radius<const AXES: usize>(
    start: &[Position; AXES],
    target: &[Position; AXES],
    radius: Position,
    plane: Plane,
    clockwise: bool,
    main: &Main,
) -> Result<[Position; 2], PathError> {
    let axes = plane_axes(plane, main)?;
    let from = axes.map(|k| start.get(k).map_or(0, |x| x.to_bits()));
    let to = axes.map(|k| target.get(k).map_or(0, |x| x.to_bits()));
    let chord = [to[0].saturating_sub(from[0]), to[1].saturating_sub(from[1])];
    let size = radius.to_bits().saturating_abs();
    if size == 0 {
        return Err(PathError::NoRadius);
    }
    if chord.iter().any(|x| x.saturating_abs() >= LONGEST >> FINER) || size >= LONGEST >> (FINER + 1) {
        return Err(PathError::TooLong);
    }
    if chord.iter().all(|x| x.abs() <= SAME_POINT) {
        return Err(PathError::RadiusWithoutEnd);
    }
    // All values below have LSB 2^-44 mm: half the chord, and the distance of the centre from the chord.
    let length = plane_hypot(chord.map(|x| x << FINER));
    let half = length >> 1;
    let size44 = size << FINER;
    if half - size44 > CHORD_EXCESS << FINER {
        return Err(PathError::RadiusTooShort { radius: size, half: half >> FINER });
    }
    let (sum, difference) = (size44 + half, (size44 - half).max(0));
    let (hi, lo) = mul_wide(sum.unsigned_abs(), difference.unsigned_abs());
    let height = sqrt_wide(hi, lo);
    // For the short counter-clockwise arc, the centre is to the left of the chord.
    let left = clockwise == (radius < Position::ZERO);
    let offset = |x: i64| {
        let (hi, lo) = mul_wide(x.unsigned_abs(), height);
        let size = div_wide(hi, lo, length.unsigned_abs()) as i64;
        if (x < 0) != left { size } else { -size }
    };
    Ok([
        Position::from_bits(from[0] + chord[0] / 2 - offset(chord[1])),
        Position::from_bits(from[1] + chord[1] / 2 + offset(chord[0])),
    ])
}

impl<const AXES: usize> Element<AXES> {
    /// Direction and curvature at `distance` from the start of a line or an arc.
    pub fn end_at(&self, distance: i64) -> End<AXES> {
        let mut end = self.entry;
        let (Curve::Arc(arc), Some(circle)) = (self.shape.curve, self.circle) else { return end };
        let shift = u32::from(self.shape.shift & 63);
        let r = arc.circle(Halves::of(distance << shift), 0).map(|x| x as f64 * LSB_42);
        let r0 = { arc.a }.map(|x| x as f64 * LSB_44_F64);
        // Angle per millimetre: 2^-59 revolutions per 2^64 units of `w`; a millimetre has 2^(44 + shift)
        // units.
        let per_mm = (1u64 << shift) as f64 * PER_MM;
        let rate = { arc.turn } as f64 * per_mm;
        let (length, first) = (hypot_f64(r), hypot_f64(r0));
        let along = length * rate;
        let t0 = circle.plane.map(|k| self.entry.tangent.get(k).map_or(0.0, |t| *t as f64));
        let outward = (t0[0] * r0[0] + t0[1] * r0[1]) / first;
        let unit = r.map(|x| x / length);
        let tangent =
            [-unit[1] * along * ONE_40 + unit[0] * outward, unit[0] * along * ONE_40 + unit[1] * outward];
        let bend = -along * along / length;
        for i in 0..2 {
            if let (Some(t), Some(c)) =
                (end.tangent.get_mut(circle.plane[i]), end.curvature.get_mut(circle.plane[i]))
            {
                *t = tangent[i] as i64;
                *c = (unit[i] * bend) as f32;
            }
        }
        end
    }
}

const LSB_42: f64 = 1.0 / (1u64 << 42) as f64;
const LSB_44_F64: f64 = 1.0 / (1u64 << 44) as f64;
const ONE_40: f64 = (1u64 << 40) as f64;
/// 2π·2^(44 − 59 − 64).
const PER_MM: f64 = core::f64::consts::TAU / (1u64 << 40) as f64 / (1u64 << 39) as f64;

/// Length of a vector: a value from `f32`, and two Newton steps.
fn hypot_f64([x, y]: [f64; 2]) -> f64 {
    let square = x * x + y * y;
    let mut root = f64::from(sqrt_f32(square as f32));
    for _ in 0..2 {
        root = 0.5 * (root + square / root);
    }
    root
}

//! G02 and G03: arcs, full circles and helices, by centre or by radius.
//!
//! Programmed coordinates have few decimals, so start and end are rarely equally far from the centre. The radius
//! then changes linearly with the angle from the one to the other.
use super::{
    Arc, Circle, Curve, Element, End, FINER, GUARD, LONGEST, Measure, PathError, Shape, hypot, path_length,
};
use crate::math::angle::atan2_turns;
use crate::math::divide::{div_shift_signed, div_wide};
use crate::math::float::to_f32;
use crate::math::root::sqrt_f32;
use crate::math::wide::{Halves, mul_shift, mul_wide};
use crate::nc::Plane;
use crate::quantity::Position;

/// 2π, LSB 2^-60.
const TWO_PI: i64 = 0x6487_ED51_10B4_611A;

/// Start and end closer than this in both axes of the plane are the same point: 2^-20 mm, about a nanometre.
const SAME_POINT: i64 = 1 << 12;

/// Radii may always differ by 2 µm (coordinates of three decimals) …
const DIFFERENCE: i64 = 8_589_935 << FINER;
/// … and by a thousandth, up to 50 µm. ISG leaves it to P-CHAN-00171 and P-CHAN-00172 without a default.
const LARGEST_DIFFERENCE: i64 = 214_748_365 << FINER;

/// How far half a chord may exceed the radius before it is an error rather than rounding: 1 µm.
const CHORD_EXCESS: i64 = 4_294_967;

/// The arc from `start` to `target` about `centre` (absolute, the plane's two axes). A target equal to the start is
/// a full circle. Axes outside the plane move along linearly; a third main axis makes it a helix, and another feed axis a longer path.
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
    let axes = plane_axes(plane, &measure.main)?;
    if !axes.iter().all(|k| measure.feeds(*k)) {
        return Err(PathError::NoFeedPlane(plane));
    }
    let mut travel = [0; AXES];
    for ((travel, from), to) in travel.iter_mut().zip(start).zip(target) {
        *travel = to.to_bits().saturating_sub(from.to_bits());
        if travel.saturating_abs() >= LONGEST >> FINER {
            return Err(PathError::TooLong);
        }
    }
    let [r0, r1] = [radius_vector(start, axes, centre)?, radius_vector(target, axes, centre)?];
    let [len0, len1] = [hypot(r0), hypot(r1)];
    if len0 == 0 || len1 == 0 {
        return Err(PathError::NoRadius);
    }
    let difference = len1 - len0;
    let allowed = DIFFERENCE.max(LARGEST_DIFFERENCE.min(len0 / 1024));
    if difference.abs() > allowed {
        return Err(PathError::RadiusDiffers { start: len0 >> FINER, end: len1 >> FINER });
    }

    // Angle travelled, 2^-60 revolutions, positive counter-clockwise.
    let [from, to] = [atan2_turns(r0[1], r0[0]), atan2_turns(r1[1], r1[0])];
    let apart = axes.iter().any(|k| travel.get(*k).is_some_and(|x: &i64| x.abs() > SAME_POINT));
    let swept = if clockwise { from.wrapping_sub(to) } else { to.wrapping_sub(from) };
    let swept = if apart && swept != 0 { (swept >> 4) as i64 } else { 1 << 60 };
    let sweep = if clockwise { -swept } else { swept };

    let plane_length = mul_shift(mul_shift(len0.max(len1), swept, 60), TWO_PI, 60);
    if plane_length >= LONGEST {
        return Err(PathError::TooLong);
    }
    let others = travel.iter().enumerate().filter(|(k, _)| measure.feeds(*k) && !axes.contains(k));
    let travelled = hypot([plane_length, difference].into_iter().chain(others.map(|(_, x)| x << FINER)));
    let travelled = measure.resolved(travelled, &travel);
    // One LSB up: a chord is never longer than the path under it.
    let mut shape = Shape::resting(path_length(travelled + 1, &travel)?);
    let length = shape.length.to_bits();
    let end_w = shape.end_w().unsigned_abs();
    let mut circle = Arc {
        a: r0,
        turn: div_shift_signed(sweep >> 1, 64, end_w),
        grow: [0; 2],
        miss: [0; 2],
        plane: [axes[0] as u8, axes[1] as u8],
    };
    if difference != 0 {
        let ratio = div_shift_signed(difference, 62, len0.unsigned_abs());
        circle.grow = r0.map(|a| div_shift_signed(mul_shift(a, ratio, 62), 51, end_w) as i32);
    }
    for k in axes {
        if let Some(travel) = travel.get_mut(k) {
            *travel = 0;
        }
    }
    shape.set_gains(&travel);
    // Quotient and product are off by at most one LSB each: hidden by the guard bits.
    let end = circle.circle(Halves::of(shape.end_w()), 0);
    circle.miss = [0, 1].map(|i| {
        let missed = (r1[i] >> (FINER - GUARD)).wrapping_sub(end[i]);
        (div_shift_signed(missed, 62, end_w) << 2) as i32
    });
    shape.curve = Curve::Arc(circle);

    let linear = shape.linear_tangent();
    let end = |r: [i64; 2], len: i64| {
        let unit = r.map(|x| div_shift_signed(x, 40, len.unsigned_abs()));
        let along = mul_shift(mul_shift(len, sweep, 60), TWO_PI, 60);
        let along = div_shift_signed(along, 40, length.unsigned_abs());
        let outward = div_shift_signed(difference, 40, length.unsigned_abs());
        let mut ends = End { tangent: linear, curvature: [0.0; AXES] };
        let tangent = [-mul_shift(unit[1], along, 40), mul_shift(unit[0], along, 40)];
        let share = to_f32(along) * LSB_40;
        for i in 0..2 {
            if let (Some(t), Some(c)) = (ends.tangent.get_mut(axes[i]), ends.curvature.get_mut(axes[i])) {
                *t = tangent[i].wrapping_add(mul_shift(unit[i], outward, 40));
                *c = -(to_f32(unit[i]) * LSB_40) * share * share / (to_f32(len) * LSB_44);
            }
        }
        (ends, if share < 0.0 { -share } else { share })
    };
    let (entry, share0) = end(r0, len0);
    let (exit, share1) = end(r1, len1);
    let circle = Circle {
        plane: axes,
        radius: to_f32(len0.min(len1)) * LSB_44,
        share: if share0 > share1 { share0 } else { share1 },
    };
    Ok(Element { shape, entry, exit, circle: Some(circle), bounds: None })
}

/// 2^-40 and 2^-44.
const LSB_40: f32 = 1.0 / (1u64 << 40) as f32;
const LSB_44: f32 = 1.0 / (1u64 << 44) as f32;

fn plane_axes(plane: Plane, main: &[Option<usize>; 3]) -> Result<[usize; 2], PathError> {
    let [p, q] = plane.main_axes();
    match (main.get(p).copied().flatten(), main.get(q).copied().flatten()) {
        (Some(p), Some(q)) => Ok([p, q]),
        _ => Err(PathError::NoPlane(plane)),
    }
}

/// Vector from the centre, LSB 2^-44 mm.
fn radius_vector<const AXES: usize>(
    point: &[Position; AXES],
    axes: [usize; 2],
    centre: [Position; 2],
) -> Result<[i64; 2], PathError> {
    let mut vector = [0; 2];
    for ((r, k), c) in vector.iter_mut().zip(axes).zip(centre) {
        let x = point.get(k).map_or(0, |x| x.to_bits()).saturating_sub(c.to_bits());
        if x.saturating_abs() >= LONGEST >> (FINER + 1) {
            return Err(PathError::TooLong);
        }
        *r = x << FINER;
    }
    Ok(vector)
}

/// Centre of the arc by radius: of the two arcs through both points the one of at most 180°, for a negative radius
/// the other. Rounded to the LSB of a position.
///
/// # Errors
/// [`PathError::RadiusWithoutEnd`], [`PathError::RadiusTooShort`], [`PathError::NoRadius`], [`PathError::NoPlane`],
/// [`PathError::TooLong`].
pub fn centre_of_radius<const AXES: usize>(
    start: &[Position; AXES],
    target: &[Position; AXES],
    radius: Position,
    plane: Plane,
    clockwise: bool,
    main: &[Option<usize>; 3],
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
    // All below in 2^-44 mm: half the chord and the distance of the centre from it.
    let length = hypot(chord.map(|x| x << FINER));
    let half = length >> 1;
    let size44 = size << FINER;
    if half - size44 > CHORD_EXCESS << FINER {
        return Err(PathError::RadiusTooShort { radius: size, half: half >> FINER });
    }
    let (sum, difference) = (size44 + half, (size44 - half).max(0));
    let (hi, lo) = mul_wide(sum.unsigned_abs(), difference.unsigned_abs());
    let height = crate::math::root::sqrt_wide(hi, lo);
    // The centre lies left of the chord for the short counter-clockwise arc.
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
        // Angle per millimetre: 2^-59 revolutions per 2^64 units of `w`, of which there are 2^(44 + shift).
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

/// Length of a vector: `f32` and two of Newton's steps.
fn hypot_f64([x, y]: [f64; 2]) -> f64 {
    let square = x * x + y * y;
    let mut root = f64::from(sqrt_f32(square as f32));
    for _ in 0..2 {
        root = 0.5 * (root + square / root);
    }
    root
}

//! How far a curve reaches along an axis, for limits of its travel.
use super::arc::plane_hypot;
use super::{Curve, Element, FINER};
use crate::math::angle::atan2_turns;
use crate::math::float::to_f32;
use crate::math::wide::Halves;
use crate::quantity::Position;

/// A quarter of a revolution, LSB 2^-64.
const QUARTER: u64 = 1 << 62;

/// Points of a polynomial that are looked at.
const POINTS: u32 = 64;

const LSB_44: f32 = 1.0 / (1u64 << 44) as f32;
const ONE_32: f32 = (1u64 << 32) as f32;

impl<const AXES: usize> Element<AXES> {
    /// The least and the greatest coordinate of an axis on an arc from `from` to `to` about `centre`. Where the radius changes from start to
    /// end, the larger one counts.
    pub fn arc_range(
        &self,
        axis: usize,
        from: &[Position; AXES],
        to: &[Position; AXES],
        centre: &[Position; 2],
    ) -> [Option<Position>; 2] {
        let ends = [from.get(axis).copied(), to.get(axis).copied()];
        let [Some(start), Some(end)] = ends else { return ends };
        let mut range = [start.min(end), start.max(end)];
        let Curve::Arc(arc) = self.shape.curve else { return range.map(Some) };
        let [p, q] = arc.plane.map(usize::from);
        let which = if axis == p { 0 } else { 1 };
        if axis == p || axis == q {
            let a = arc.a;
            let radius = |at: &[Position; AXES]| {
                let of = |k: usize, centre: Position| {
                    at.get(k).map_or(0, |x| x.to_bits().wrapping_sub(centre.to_bits()) << FINER)
                };
                plane_hypot([of(p, centre[0]), of(q, centre[1])])
            };
            // Up to a position: what is less than its LSB does not count.
            let radius = Position::from_bits(radius(from).max(radius(to)) >> FINER);
            let centre = centre[which];
            // From 2^-59 revolutions; one whole revolution is as much as there is.
            let sweep = Halves::of(self.shape.end_w()).times(Halves::of(arc.turn));
            let size = (sweep.unsigned_abs() << 5).wrapping_sub(u64::from(sweep.unsigned_abs() >= 1 << 59));
            let begin = atan2_turns(a[1], a[0]);
            // The directions of the two extremes of this axis.
            let passes = |direction: u64| {
                let turned = direction.wrapping_sub(begin);
                (if sweep < 0 { turned.wrapping_neg() } else { turned }) <= size
            };
            let up = which as u64 * QUARTER;
            if passes(up) {
                range[1] = range[1].max(centre.saturating_add(radius));
            }
            if passes(up.wrapping_add(2 * QUARTER)) {
                range[0] = range[0].min(centre.saturating_sub(radius));
            }
        }
        range.map(Some)
    }

    /// The least and the greatest coordinate of an axis on a polynomial that begins at `from`: neither is passed, and both are reached up to a
    /// 2^15th of what its curvature bends it by. Where it is well inside `limits`, these may be wider.
    pub fn bent_range(
        &self,
        axis: usize,
        from: &[Position; AXES],
        limits: [Position; 2],
    ) -> [Option<Position>; 2] {
        let ends = |x: Option<&Position>| [x.copied(); 2];
        let (Some(start), Some(bounds)) = (from.get(axis), &self.bounds) else { return ends(from.get(axis)) };
        let Curve::Poly { power, down } = &self.shape.curve else { return ends(Some(start)) };
        let length = to_f32(self.shape.length.to_bits()) * LSB_44;
        let of = |all: &[f32; AXES]| all.get(axis).copied().unwrap_or(0.0);
        let position = |mm: f32| Position::from_bits((mm * ONE_32) as i64);
        let way = position(of(&bounds.slope) * length);
        let near = [start.saturating_sub(way), start.saturating_add(way)];
        if near[0] >= limits[0] && near[1] <= limits[1] {
            return near.map(Some);
        }
        // Between two points a curve leaves their chord by an eighth of its curvature times the square of their distance.
        let step = length * (1.0 / POINTS as f32);
        let more = position(of(&bounds.bend) * step * step * 0.125);
        let mut at = *from;
        let mut range = [*start; 2];
        for k in 1..=POINTS {
            let along = if k == POINTS {
                self.shape.length.to_bits()
            } else {
                self.shape.length.to_bits() / i64::from(POINTS) * i64::from(k)
            };
            self.shape.bent(self.shape.w(along), (power, down), from, &mut at);
            let x = at.get(axis).copied().unwrap_or(*start);
            range = [range[0].min(x), range[1].max(x)];
        }
        [Some(range[0].saturating_sub(more)), Some(range[1].saturating_add(more))]
    }
}

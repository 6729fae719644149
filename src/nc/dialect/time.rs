//! Inverse time (G93): F is 1 divided by the block's time in minutes. So the feed is the path length times F.
use crate::math::angle::atan2_turns;
use crate::math::root::sqrt_wide;
use crate::nc::interpreter::Interpreter;
use crate::nc::{ArcBy, Motion, MotionKind, Plane};
use crate::quantity::{Feed, Position};

/// 2π, LSB 2^-60.
const TWO_PI: u128 = 0x6487_ED51_10B4_611A;

/// floor(√x), exact.
fn root(x: u128) -> u128 {
    u128::from(sqrt_wide((x >> 64) as u64, x as u64))
}

/// Distance between two positions, LSB 2^-32 mm or degree.
fn between(from: Position, to: Position) -> u128 {
    u128::from(to.to_bits().abs_diff(from.to_bits()))
}

impl<const AXES: usize> Interpreter<AXES> {
    /// The feed of a motion from `start` whose F is inverse time. A motion without a path has the smallest
    /// feed.
    pub(super) fn feed_by_time(&self, motion: &Motion<AXES>, start: &[Position; AXES]) -> Feed {
        let per_minute = u128::from(motion.feed.to_bits().unsigned_abs());
        // A value below 2^55 times a value below 2^63.
        let feed = (self.length(motion, start) * per_minute) >> 32;
        Feed::from_bits(i64::try_from(feed).unwrap_or(i64::MAX).max(1))
    }

    /// Length of the path, LSB 2^-32 mm: along the main axes; if none of them moves, along all other axes.
    fn length(&self, motion: &Motion<AXES>, start: &[Position; AXES]) -> u128 {
        let travel = |axis: usize| match (start.get(axis), motion.target.get(axis)) {
            (Some(from), Some(to)) => between(*from, *to),
            _ => 0,
        };
        let square = |axis: usize| travel(axis) * travel(axis);
        let main = || self.setup.main.iter().flatten().copied();
        let across = |plane: Plane| {
            let [first, second] = plane.main_axes();
            self.setup.main.get(3 - first - second).copied().flatten()
        };
        if let MotionKind::Arc { plane, clockwise, by } = motion.kind {
            let along = self.arc_length(motion, start, (plane, clockwise, by));
            return root(along * along + across(plane).map_or(0, square));
        }
        let space: u128 = main().map(square).sum();
        let all = || (0..AXES).map(square).sum();
        root(if space > 0 { space } else { all() })
    }

    /// Length of an arc in its plane.
    fn arc_length(
        &self,
        motion: &Motion<AXES>,
        start: &[Position; AXES],
        (plane, clockwise, by): (Plane, bool, ArcBy),
    ) -> u128 {
        let axes = plane.main_axes().map(|place| self.setup.main.get(place).copied().flatten());
        let of = |point: &[Position; AXES]| {
            axes.map(|axis| axis.and_then(|axis| point.get(axis)).copied().unwrap_or_default())
        };
        let [from, to] = [of(start), of(&motion.target)];
        let (radius, angle) = match by {
            ArcBy::Centre(centre) => {
                let seen = |[p, q]: [Position; 2]| {
                    let [x, y] = [p.saturating_sub(centre[0]), q.saturating_sub(centre[1])];
                    (x.to_bits(), y.to_bits())
                };
                let ((x0, y0), (x1, y1)) = (seen(from), seen(to));
                let turned = atan2_turns(y1, x1).wrapping_sub(atan2_turns(y0, x0));
                let turned = if clockwise { turned.wrapping_neg() } else { turned };
                let [x, y] = [x0, y0].map(|x| u128::from(x.unsigned_abs()));
                // An angle of nearly zero is a full circle.
                let full = turned < 1 << 10 || from == to;
                (root(x * x + y * y), if full { 1 << 64 } else { u128::from(turned) })
            }
            ArcBy::Radius(radius) => {
                let [dx, dy] = [between(from[0], to[0]), between(from[1], to[1])];
                let r = u128::from(radius.to_bits().unsigned_abs());
                let half = root(dx * dx + dy * dy) / 2;
                let rest = root((r * r).saturating_sub(half * half));
                let turned = u128::from(atan2_turns(half as i64, rest as i64)) * 2;
                (r, if radius < Position::ZERO { (1 << 64) - turned } else { turned })
            }
        };
        // A value below 2^51 times at most 2^64; then a value below 2^51 times a value below 2^63.
        (((radius * angle) >> 64) * TWO_PI) >> 60
    }
}

//! Combines the limits of all axes into the limits of an element along the path. Also holds the part of these
//! limits that a transition leaves to the speed profiles of both elements.
use super::axis::Set;
use super::override_range::OverrideRange;
use super::{ROUGH, ROUGH_BELOW};
use crate::machine::functions;
use crate::math::float::{max, min};
use crate::nc::SlopeType;
use crate::slope::limits::{Joins, Limits, SlopeLaw, lower};
use crate::slope::ramp_shape::RampShape;

/// Part of `B` for a transition. The speed profile has the same part, and transitions within three ticks
/// share a fifth.
pub(crate) const TRANSITION_PART: f32 = 0.4;
/// Parts of `B` at a transition of an arc, and inside a polynomial. The first part is for the speed profile,
/// the second for v³κ², and the rest for 3vκ·a.
pub(crate) const ARC_SLOPE_PART: f32 = 0.25;
pub(crate) const ARC_PART: f32 = 0.5;
/// If the ratio of two values is below this number, the first value is the smaller one despite rounding.
pub(crate) const SURELY: f32 = 0.999;
/// Two change-over speeds whose ratio is below this value count as equal.
const SAME: f32 = 1.0 + 1.0 / 1_048_576.0;

/// The limits along the path that the transition between two blocks leaves to the speed profile. The change
/// of direction or curvature at the transition uses the rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Share {
    /// Jerk that is left, mm/tick³.
    pub j: f32,
    /// Acceleration that is left if the profile may have an acceleration at the transition, mm/tick².
    pub a: f32,
    /// Acceleration that is left if the acceleration of the profile is zero at the transition, mm/tick².
    pub a_resting: f32,
    /// For an arc: the speed at which the curvature uses its part of the limits, mm/tick. `f32::MAX` for
    /// other elements.
    pub v: f32,
    /// Acceleration that may pass the ends of an arc where another profile begins, mm/tick².
    pub passing: f32,
}

impl Share {
    /// For a transition that leaves all limits to the speed profile.
    pub const WHOLE: Self =
        Self { j: f32::MAX, a: f32::MAX, a_resting: f32::MAX, v: f32::MAX, passing: f32::MAX };

    /// The limits that are left if acceleration is zero at the transition.
    pub(crate) fn resting(self) -> Self {
        Self { a: self.a_resting, ..self }
    }
}

/// An acceleration along the path, less the rounding of path distances. The result is at least half of `a`.
pub(super) fn less_rough(a: f32) -> f32 {
    if a < ROUGH_BELOW { max(a - ROUGH, 0.5 * a) } else { a }
}

impl Joins {
    /// Which blocks may share a span with this slope. `optimised`: NO_OPT=0, which only HSC has.
    pub fn of(slope: SlopeType, optimised: bool) -> Self {
        match slope {
            _ if !functions::HSC.is_built() => Self::Alike,
            SlopeType::Hsc if optimised => Self::Valleys,
            SlopeType::Hsc => Self::Any,
            SlopeType::Step | SlopeType::Trapez | SlopeType::Sin2 => Self::Alike,
        }
    }
}

impl Limits {
    /// Lowers the speed to the feed at the planned override `level`. The range is exact if the block reaches
    /// this speed.
    #[cfg_attr(feature = "fast", inline(always))]
    pub(crate) fn take_feed(&mut self, feed: f32, v_reduced: f32, level: f32) -> OverrideRange {
        if feed == f32::MAX {
            return OverrideRange::new(self.v, self.v, v_reduced);
        }
        let override_range = OverrideRange::new(self.v, feed, v_reduced);
        if self.v > feed {
            self.v = feed * override_range.raised(level);
        }
        override_range
    }

    /// With TRAPEZ and SIN2, acceleration passes the elements of one curve, as with HSC. These transitions
    /// are not part of the program. This holds only if the jerks of all four ramps are equal.
    pub(crate) fn flow_on(&mut self) {
        if functions::HSC.is_built()
            && let SlopeLaw::JerkLimited { joins, j, .. } = &mut self.law
            && *joins == Joins::Alike
            && j.iter().all(|jerk| jerk == j.first().unwrap_or(jerk))
        {
            *joins = Joins::Any;
        }
    }

    /// Reserves the transition's part of the limits.
    ///
    /// A plan that is possible with a lower jerk must be possible with a higher one. For SIN2, all jerks are
    /// lowered by one factor, because q is below 1/6. If the ramp at the lower speed is shorter than a third
    /// of the other ramp, a longer single ramp would shorten the distance.
    pub(crate) fn share(&mut self, share: &Share) {
        match &mut self.law {
            SlopeLaw::JerkLimited { shape: RampShape::SineSquare, j, .. } => {
                let highest = j.iter().fold(0.0, |highest, j| max(highest, *j));
                let part = min(1.0, share.j / highest);
                *j = j.map(|j| j * part);
            }
            SlopeLaw::JerkLimited { j, .. } => lower(j, [share.j; 4]),
            SlopeLaw::Stepped { .. } => {}
        }
        self.lower_accelerations(share.a);
    }

    /// Reserves acceleration for the rounding of path distances. If an axis moves much farther than the path,
    /// little acceleration is left along the path. The share of a transition reserves as much.
    #[cfg_attr(feature = "fast", inline(always))]
    pub(crate) fn leave_rough(&mut self, share: &mut Share) {
        if min(self.a_up, self.a_down) < ROUGH_BELOW {
            self.lower_by_rough(share);
        }
    }

    #[cold]
    #[inline(never)]
    fn lower_by_rough(&mut self, share: &mut Share) {
        // Lower accelerations are halved; zero stays zero.
        let least = max(self.least(), ROUGH);
        let part = less_rough(least) / least;
        self.scale_accelerations(part);
        if let SlopeLaw::Stepped { still, .. } = &mut self.law {
            *still *= part;
        }
        share.a *= part;
        share.a_resting *= part;
    }

    /// Whether the share leaves the limits unchanged.
    pub(crate) fn are_within(&self, share: &Share) -> bool {
        let most = max(self.a_up, self.a_down);
        match self.law {
            SlopeLaw::JerkLimited { j, .. } => most <= share.a && j.iter().all(|j| *j <= share.j),
            SlopeLaw::Stepped { .. } => self.most() <= share.a,
        }
    }

    /// The limits that are left in a block next to a transition.
    pub(crate) fn shared(mut self, share: &Share) -> Self {
        self.share(share);
        self
    }

    /// Restricts the limits to those of an axis that moves `1 / scale` times as far as the path. `turns`: in
    /// some places, the axis moves less far.
    #[cfg_attr(feature = "fast", inline(always))]
    pub(crate) fn restrict(&mut self, share: &mut Share, set: &Set, scale: f32, turns: bool) {
        self.v = min(set.v * scale, self.v);
        self.a_up = min(set.a_up * scale, self.a_up);
        self.a_down = min(set.a_down * scale, self.a_down);
        let mut peak = 1.0;
        match &mut self.law {
            SlopeLaw::JerkLimited { shape, j, .. } => {
                lower(j, set.j.map(|j| j * scale));
                peak = 1.0 / shape.peak_jerk();
            }
            SlopeLaw::Stepped { change_over, a_up, a_down, still, .. } => {
                // The axis may be below its change-over speed while the path is above the path's change-over
                // speed.
                let both = turns || set.change_over * scale > *change_over * SAME;
                let above = |lower: f32, upper: f32| scale * if both { min(lower, upper) } else { upper };
                *a_up = min(*a_up, above(set.a_up, set.upper[0]));
                *a_down = min(*a_down, above(set.a_down, set.upper[1]));
                *still = min(*still, set.a_down * scale);
            }
        }
        share.j = min(TRANSITION_PART * peak * set.joint.budget * scale, share.j);
        share.a = min(set.a_shared * scale, share.a);
        share.a_resting = min(set.a_resting * scale, share.a_resting);
    }
}

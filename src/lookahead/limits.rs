//! Permitted path speed, acceleration and jerk of one element, and how those of several become one.
use super::block::ROUNDED;
use super::dynamics::Set;
use super::ease::Ease;
use super::pace::Headroom;
use crate::math::root::{cbrt_f32, sqrt_f32};
use crate::nc::SlopeType;
use crate::quantity::Speed;
use crate::slope::bend::Bend;
use crate::slope::profile::speed_f32;
use crate::slope::ramp::{Bowed, Ramp, Stepped};
use core::f32::consts::TAU;

/// Part of `B` for a transition; as much is left to the slope, and a fifth to transitions closer than three ticks.
pub(super) const TRANSITION_PART: f32 = 0.4;
/// Parts of `B` inside an arc: slope, and v³κ²; the rest goes to 3vκ·a.
pub(super) const ARC_SLOPE_PART: f32 = 0.25;
pub(super) const ARC_PART: f32 = 0.5;
/// Speeds tried for an arc, and the step from one to the next.
pub(super) const ARC_SPEEDS: usize = 5;
pub(super) const ARC_SPEED_STEP: f32 = 0.8;
/// What is below that part of another value is below it for any rounding.
const SURELY: f32 = 0.999;
/// Two limits that differ by less are alike. Of the speeds a span has the higher one: four roundings.
const ALIKE: f32 = 1.0 / 262_144.0;
const ALIKE_SPEED: f32 = 1.0 / 4_194_304.0;
/// An acceleration below this part of another one is far less.
const WEAK: f32 = 1.0 / 64.0;
/// Two change-over speeds that differ by less are one.
const SAME: f32 = 1.0 + 1.0 / 1_048_576.0;

/// The four ramps of a slope: acceleration rises, falls, deceleration rises, falls.
pub type Ramps = [f32; 4];

/// Blocks that may follow each other without acceleration zero between.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Joins {
    /// With the same limits: TRAPEZ, SIN2.
    Alike,
    /// All: HSC.
    Any,
    /// All, and slow ones may be entered and left with acceleration: HSC with NO_OPT=0.
    Dips,
}

impl Joins {
    /// `optimised`: NO_OPT=0, which only HSC knows.
    pub fn of(slope: SlopeType, optimised: bool) -> Self {
        match slope {
            SlopeType::Hsc if optimised => Self::Dips,
            SlopeType::Hsc => Self::Any,
            SlopeType::Step | SlopeType::Trapez | SlopeType::Sin2 => Self::Alike,
        }
    }
}

/// What a slope permits beside speed and acceleration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Law {
    /// TRAPEZ, SIN2, HSC.
    Bowed {
        /// Shape of the ramps.
        bend: Bend,
        /// What may follow without acceleration zero between.
        joins: Joins,
        /// Mean jerk of each ramp.
        j: Ramps,
    },
    /// STEP: the path has one change-over speed, that of the axis which reaches its own first.
    Stepped {
        /// Speed up to which the accelerations of the limits hold.
        change_over: f32,
        /// Acceleration above it.
        a_up: f32,
        /// Deceleration above it.
        a_down: f32,
    },
}

/// Permitted values along the path: mm/tick, mm/tick², mm/tick³.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Speed.
    pub v: f32,
    /// Acceleration.
    pub a_up: f32,
    /// Deceleration.
    pub a_down: f32,
    /// What the slope adds to that.
    pub law: Law,
}

/// What is left to the slope beside a transition.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Share {
    /// Jerk, mm/tick³.
    pub j: f32,
    /// Acceleration, mm/tick².
    pub a: f32,
    /// The same where it is zero at the transition.
    pub a_resting: f32,
}

impl Share {
    /// All of it.
    pub const WHOLE: Self = Self { j: f32::MAX, a: f32::MAX, a_resting: f32::MAX };

    /// What is left where acceleration is zero at the transition.
    pub(super) fn resting(self) -> Self {
        Self { a: self.a_resting, ..self }
    }
}

impl Limits {
    /// No limit.
    pub const WIDEST: Self = Self {
        v: f32::MAX,
        a_up: f32::MAX,
        a_down: f32::MAX,
        law: Law::Bowed { bend: Bend::Linear, joins: Joins::Alike, j: [f32::MAX; 4] },
    };

    /// Nothing is permitted; all bits zero.
    pub(super) const NOTHING: Self = Self {
        v: 0.0,
        a_up: 0.0,
        a_down: 0.0,
        law: Law::Bowed { bend: Bend::Linear, joins: Joins::Alike, j: [0.0; 4] },
    };

    /// The speed becomes that of the feed at the level, at most what it was; all of it is known where it is reached.
    #[inline(always)]
    pub(super) fn take_feed(&mut self, feed: f32, v_reduced: f32, level: f32) -> Headroom {
        if feed == f32::MAX {
            return Headroom::new(self.v, self.v, v_reduced);
        }
        let headroom = Headroom::new(self.v, feed, v_reduced);
        if self.v > feed {
            self.v = feed * headroom.raised(level);
        }
        headroom
    }

    /// Whether they are the others but for rounding.
    pub(super) fn are(&self, other: &Self) -> bool {
        let near = |a: f32, b: f32, part: f32| magnitude(a - b) <= a * part;
        let laws = match (&self.law, &other.law) {
            (Law::Bowed { j, .. }, Law::Bowed { j: others, .. }) => {
                j.iter().zip(others).all(|(a, b)| near(*a, *b, ALIKE))
            }
            _ => false,
        };
        laws && near(self.v, other.v, ALIKE_SPEED)
            && near(self.a_up, other.a_up, ALIKE)
            && near(self.a_down, other.a_down, ALIKE)
    }

    /// Becomes what both permit; of the speeds the higher one.
    #[inline]
    pub(super) fn join(&mut self, other: &Self) {
        self.v = max(self.v, other.v);
        self.a_up = min(self.a_up, other.a_up);
        self.a_down = min(self.a_down, other.a_down);
        match (&mut self.law, &other.law) {
            (Law::Bowed { j, .. }, Law::Bowed { j: other, .. }) => lower(j, *other),
            (Law::Stepped { change_over, .. }, Law::Stepped { change_over: other, .. }) => {
                *change_over = min(*change_over, *other);
            }
            _ => {}
        }
    }

    /// Becomes those of a slowing down that goes on from here into a motion with the others; what ends a gain of speed stays.
    pub fn go_on_braking(&mut self, other: &Self) {
        self.a_down = min(self.a_down, other.a_down);
        match (&mut self.law, &other.law) {
            (Law::Bowed { j: [.., rise, fall], .. }, Law::Bowed { j: [.., other_rise, other_fall], .. }) => {
                (*rise, *fall) = (min(*rise, *other_rise), min(*fall, *other_fall));
            }
            (
                Law::Stepped { change_over, a_down, .. },
                Law::Stepped { change_over: other_change_over, a_down: other_a_down, .. },
            ) => {
                *a_down = min(*a_down, *other_a_down);
                if change_over != other_change_over {
                    // Between both of them one has the deceleration of the lower stage.
                    *change_over = min(*change_over, *other_change_over);
                    *a_down = min(*a_down, self.a_down);
                }
            }
            _ => {}
        }
    }

    /// Whether a slowing down with these limits is at least as hard as with the others.
    pub fn brakes_like(&self, other: &Self) -> bool {
        let ramps = match (&self.law, &other.law) {
            (Law::Bowed { j: [.., rise, fall], .. }, Law::Bowed { j: [.., other_rise, other_fall], .. }) => {
                rise >= other_rise && fall >= other_fall
            }
            _ => false,
        };
        ramps && self.a_down >= other.a_down
    }

    /// NO_OPT=0.
    pub(super) fn may_dip(&self) -> bool {
        matches!(self.law, Law::Bowed { joins: Joins::Dips, .. })
    }

    /// Whether blocks with other speeds may be in one span with it: HSC.
    pub fn varies(&self) -> bool {
        matches!(self.law, Law::Bowed { joins: Joins::Any | Joins::Dips, .. })
    }

    /// Those of the same law at `part` of its speed, at every point: of the accelerations the square, of the jerks the cube. A
    /// little more, for rounding: far less than `part` leaves.
    pub fn stretched(&self, part: f32) -> Self {
        let mut limits = *self;
        let square = min(part * part * (2.0 - ROUNDED), 1.0);
        limits.v *= part;
        limits.a_up *= square;
        limits.a_down *= square;
        if let Law::Bowed { j, .. } = &mut limits.law {
            *j = j.map(|j| j * (square * part));
        }
        limits
    }

    /// Of a ramp; of STEP none.
    pub fn jerk(&self, ramp: usize) -> f32 {
        match self.law {
            Law::Bowed { j, .. } => j.get(ramp).copied().unwrap_or(0.0),
            Law::Stepped { .. } => f32::MAX,
        }
    }

    /// Speed, acceleration and jerk that a motion may have in both directions; `None` with a slope that has no jerk.
    pub fn along(&self) -> Option<[f32; 3]> {
        let Law::Bowed { j, .. } = self.law else { return None };
        Some([self.v, min(self.a_up, self.a_down), j.into_iter().fold(f32::MAX, min)])
    }

    /// Uses less than permitted.
    pub(super) fn ease(&mut self, ease: Ease) {
        let ([up, down], v) = ease.parts();
        self.a_up *= up;
        self.a_down *= down;
        self.v = min(self.v, v);
    }

    /// Permits no speed above those.
    pub(super) fn flatten(&mut self, v_in: Speed, v_out: Speed) {
        self.v = speed_f32(v_in.max(v_out).to_bits());
    }

    /// Largest acceleration or deceleration of both.
    pub(super) fn fastest(&self, other: &Self) -> f32 {
        max(max(self.a_up, self.a_down), max(other.a_up, other.a_down))
    }

    /// Whether neither has far less acceleration, or deceleration, than the other.
    pub(super) fn is_as_strong(&self, other: &Self) -> bool {
        let near = |a: f32, b: f32| min(a, b) >= WEAK * max(a, b);
        near(self.a_up, other.a_up) && near(self.a_down, other.a_down)
    }

    /// Its ramps become linear; the law they had.
    pub const fn straighten(&mut self) -> Law {
        let before = self.law;
        if let Law::Bowed { bend, .. } = &mut self.law {
            *bend = Bend::Linear;
        }
        before
    }

    /// The largest acceleration or deceleration at any speed.
    pub(super) fn most(&self) -> f32 {
        let a = max(self.a_up, self.a_down);
        match self.law {
            Law::Bowed { .. } => a,
            Law::Stepped { a_up, a_down, .. } => max(a, max(a_up, a_down)),
        }
    }

    /// The slope that gains speed.
    pub fn speed_up(&self) -> Ramp {
        match self.law {
            Law::Bowed { bend, j: [rise, fall, ..], .. } => {
                Ramp::Bowed(Bowed::new(bend, self.a_up, rise, fall))
            }
            Law::Stepped { change_over, a_up, .. } => {
                Ramp::Stepped(Stepped { a: [self.a_up, a_up], change_over })
            }
        }
    }

    /// The slope that loses speed, seen backward from the lower one.
    pub fn brake(&self) -> Ramp {
        match self.law {
            Law::Bowed { bend, j: [.., rise, fall], .. } => {
                Ramp::Bowed(Bowed::new(bend, self.a_down, fall, rise))
            }
            Law::Stepped { change_over, a_down, .. } => {
                Ramp::Stepped(Stepped { a: [self.a_down, a_down], change_over })
            }
        }
    }

    /// Leaves a transition its part.
    ///
    /// What could be planned with less jerk must be possible with more. Of SIN2 all jerks go down by one factor: with q < 1/6
    /// and a ramp at the lower speed shorter than a third of the other one, a longer one alone would shorten the way.
    pub(super) fn share(&mut self, share: &Share) {
        match &mut self.law {
            Law::Bowed { bend: Bend::SineSquare, j, .. } => {
                let highest = j.iter().fold(0.0, |highest, j| max(highest, *j));
                let part = min(1.0, share.j / highest);
                *j = j.map(|j| j * part);
            }
            Law::Bowed { j, .. } => lower(j, [share.j; 4]),
            Law::Stepped { .. } => {}
        }
        self.lower_accelerations(share.a);
    }

    /// Whether that leaves them as they are.
    pub(super) fn are_within(&self, share: &Share) -> bool {
        let most = max(self.a_up, self.a_down);
        match self.law {
            Law::Bowed { j, .. } => most <= share.a && j.iter().all(|j| *j <= share.j),
            Law::Stepped { .. } => self.most() <= share.a,
        }
    }

    /// With a transition's part left to it.
    pub(super) fn shared(mut self, share: &Share) -> Self {
        self.share(share);
        self
    }

    /// No acceleration above `a`.
    pub(super) fn lower_accelerations(&mut self, a: f32) {
        self.a_up = min(a, self.a_up);
        self.a_down = min(a, self.a_down);
        if let Law::Stepped { a_up, a_down, .. } = &mut self.law {
            *a_up = min(*a_up, a);
            *a_down = min(*a_down, a);
        }
    }

    /// Takes in an axis that moves `1 / scale` times as far as the path; `turns`: at times, less.
    #[inline(always)]
    pub(super) fn restrict(&mut self, share: &mut Share, set: &Set, scale: f32, turns: bool) {
        self.v = min(set.v * scale, self.v);
        self.a_up = min(set.a_up * scale, self.a_up);
        self.a_down = min(set.a_down * scale, self.a_down);
        let mut peak = 1.0;
        match &mut self.law {
            Law::Bowed { bend, j, .. } => {
                lower(j, set.j.map(|j| j * scale));
                peak = 1.0 / bend.peak_jerk();
            }
            Law::Stepped { change_over, a_up, a_down } => {
                // The axis may be below its own change-over speed while the path is above its.
                let both = turns || set.change_over * scale > *change_over * SAME;
                let above = |lower: f32, upper: f32| scale * if both { min(lower, upper) } else { upper };
                *a_up = min(*a_up, above(set.a_up, set.upper[0]));
                *a_down = min(*a_down, above(set.a_down, set.upper[1]));
            }
        }
        share.j = min(TRANSITION_PART * peak * set.joint.budget * scale, share.j);
        share.a = min(set.a_shared * scale, share.a);
        share.a_resting = min(set.a_resting * scale, share.a_resting);
    }

    /// Takes in a curvature κ: v²κ across the path, with the tangential acceleration inside `a_max`; jerks
    /// v³κ²/share + 3vκ·a + share·j inside `budget` (their exact sum is a vector no longer than that). `share` is the part of the
    /// path that lies in the arc's plane: of a helix κ = share²/r, and the first of them is (share·v)³/r².
    ///
    /// The faster the arc, the less acceleration is left to reach that speed: of five speeds, each four fifths of the
    /// one before, the one is taken with which the full circle, from rest to rest with that acceleration, is fastest.
    /// So an arc does not become slower where it is cut.
    pub(super) fn bend(&mut self, curvature: f32, normal: f32, a_max: f32, budget: f32, share: f32) {
        let twist = curvature * curvature / share;
        // Roots only where they may be lower.
        if self.v * self.v * curvature >= SURELY * normal {
            self.v = min(self.v, sqrt_f32(normal / curvature));
        }
        if self.v * self.v * self.v * twist >= SURELY * ARC_PART * budget {
            self.v = min(self.v, cbrt_f32(ARC_PART * budget / twist));
        }
        if let Law::Bowed { bend, j, .. } = &mut self.law {
            lower(j, [ARC_SLOPE_PART / bend.peak_jerk() * budget / share; 4]);
        }
        let most = min(self.a_up, self.a_down);
        let mut v = self.v;
        let across = v * v * curvature;
        let left = SURELY * (a_max * a_max - across * across);
        let jerk = SURELY * ((1.0 - ARC_SLOPE_PART) * budget - twist * v * v * v);
        if left > most * share * most * share && jerk > most * (3.0 * v * curvature) {
            // The first speed leaves all of it.
            return self.lower_accelerations(most);
        }
        let length = TAU / curvature;
        let mut best = (f32::MAX, 0.0, 0.0);
        for _ in 0..ARC_SPEEDS {
            let across = v * v * curvature;
            let along = sqrt_f32(max(a_max * a_max - across * across, 0.0)) / share;
            let jerk = (1.0 - ARC_SLOPE_PART) * budget - twist * v * v * v;
            let a = min(most, min(along, jerk / (3.0 * v * curvature)));
            let time = if length * a >= v * v { length / v + v / a } else { 2.0 * sqrt_f32(length / a) };
            if time < best.0 {
                best = (time, v, a);
            }
            // Slower there is no more acceleration, and no time to gain.
            if a >= most {
                break;
            }
            v *= ARC_SPEED_STEP;
        }
        self.v = best.1;
        self.lower_accelerations(best.2);
    }
}

#[inline]
pub(super) fn lower<const N: usize>(values: &mut [f32; N], others: [f32; N]) {
    for (value, other) in values.iter_mut().zip(others) {
        *value = min(other, *value);
    }
}

/// f32::min has a NaN rule that costs instructions; no operand here is one. What is lowered comes second: it then stays in its
/// register.
pub(crate) fn min(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

pub(crate) fn max(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

pub(super) fn magnitude(x: f32) -> f32 {
    if x < 0.0 { -x } else { x }
}

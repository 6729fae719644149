//! The highest speed at the transition from one element to the next, for a change of direction or of
//! curvature.
use super::axis::TransitionLimits;
use super::{Dynamics, KNEE_PART, LSB_40, MARGIN, SLIGHT, SMOOTH};
use crate::dynamics::arc::HIGHEST;
use crate::dynamics::permitted::TRANSITION_PART;
use crate::math::float::{magnitude, max, min, size_f32};
use crate::math::root::sqrt_f32;
use crate::nc::SlopeType;
use crate::path::End;

/// Longest time for [`Dynamics::smoothing`], ticks.
const LONGEST_SMOOTHING: f32 = 1024.0;
/// STEP: a step below this part of a knee's limit is rounding of coordinates.
const STEP_SMOOTH: f32 = 1.0 / 4_194_304.0;
/// Part of `B` for an acceleration that changes its direction with the path at a transition.
const TURN_PART: f32 = 0.05;

impl<const AXES: usize> Dynamics<AXES> {
    /// Highest speed of a transition (mm/tick). For each axis, the step of speed stays inside the limit for
    /// corners without a curve (P-AXIS-00013). The steps of speed and acceleration stay inside the
    /// transition's part of the jerk budget. Returns `None` if the transition is smooth, except for rounding,
    /// at `fastest`, the highest speed of its neighbours. `shorter` is the length of the shorter neighbour,
    /// mm.
    ///
    /// In two cases the machine data permit unlimited jerk: for a step of acceleration without P-CHAN-00009,
    /// and for a step of speed with P-AXIS-00013. With P-CHAN-00009, P-AXIS-00154 gives the permitted part of
    /// the transition's jerk. Acceleration is limited in all cases.
    ///
    /// A speed step Δv shows as a third difference of at most Δv/T², an acceleration step Δa as Δa/T. Steps
    /// within three ticks add up. If blocks take h ticks, at most 2 + 2/h steps lie within three ticks. `a`
    /// is the largest acceleration near the transition, or 0 if the acceleration is zero there (all slopes
    /// but STEP).
    #[cfg_attr(feature = "fast", inline(always))]
    pub fn transition(
        &self,
        from: &End<AXES>,
        to: &End<AXES>,
        rapid: bool,
        shorter: f32,
        (fastest, a): (f32, f32),
    ) -> Option<f32> {
        // Usually between elements of one curve.
        let ends = from.tangent.iter().zip(&to.tangent).zip(from.curvature.iter().zip(&to.curvature));
        let mut axes = ends.map(|((t0, t1), (c0, c1))| t0 == t1 && c0 == c1);
        let goes_on = axes.all(|is_same| is_same) && !self.watched.is_some();
        if goes_on { None } else { self.turn((from, to), rapid, shorter, (fastest, a)) }
    }

    /// As [`Self::transition`], if direction or curvature changes, or an axis has AX_DEV.
    #[inline(never)]
    fn turn(
        &self,
        (from, to): (&End<AXES>, &End<AXES>),
        rapid: bool,
        shorter: f32,
        (fastest, a): (f32, f32),
    ) -> Option<f32> {
        let mut v = f32::MAX;
        for k in 0..AXES {
            let (axis, [t0, t1]) = (&self.axes[k], [from.tangent[k], to.tangent[k]]);
            let [c0, c1] = [from.curvature[k], to.curvature[k]];
            if t0 == t1 && c0 == c1 {
                continue;
            }
            let mut joint = if rapid { &axis.rapid.joint } else { &axis.feed.joint };
            let both;
            if let Some([feed_before, rapid_before]) = self.before.as_ref().map(|axes| &axes[k]) {
                both = joint.restricted(if rapid { rapid_before } else { feed_before });
                joint = &both;
            }
            let knee = size_f32(t1.wrapping_sub(t0).unsigned_abs()) * LSB_40;
            let bend = magnitude(c1 - c0);
            let stepped = self.slope == SlopeType::Step;
            let unseen = if stepped { STEP_SMOOTH } else { SMOOTH } * joint.budget;
            let knee = if fastest * knee <= unseen { 0.0 } else { knee };
            let bend = if stepped || fastest * fastest * bend <= unseen { 0.0 } else { bend };
            let part = TRANSITION_PART * joint.budget;
            let is_free = joint.bend == f32::MAX;
            if knee > 0.0 {
                let part = match joint.is_weighted {
                    true => joint.knee,
                    false if bend > 0.0 && !is_free => 0.5 * part,
                    false => part,
                };
                let alone = min(part, joint.knee) / knee;
                if stepped {
                    v = min(v, beside_others(alone, 0.25 * part / knee, shorter, a));
                } else if 3.0 * alone > shorter {
                    let close = min(0.25 * part / knee, sqrt_f32(0.25 * part * shorter / knee));
                    v = min(v, min(alone, max(shorter * (1.0 / 3.0), close)));
                } else {
                    v = min(v, alone);
                }
            }
            let curvature = max(magnitude(c0), magnitude(c1));
            if knee > 0.0 && curvature > 0.0 && !stepped {
                // Curves leave a part of the acceleration free, and the speed profile needs some of this
                // part. Arcs leave the least.
                let rest = (joint.left - HIGHEST * HIGHEST * axis.a_max) / knee;
                v = min(v, max(joint.beside_turn(knee, curvature), max(rest, 0.0)));
            }
            if bend > 0.0 && !is_free {
                let part = if knee > 0.0 { 0.5 * joint.bend } else { joint.bend };
                v = min(v, sqrt_f32(part / bend));
            }
        }
        if self.watched.is_some() {
            v = min(v, self.watched((from, to), rapid, shorter, fastest));
        }
        if v == f32::MAX { None } else { Some(v * MARGIN) }
    }

    /// Permitted step of speed of one axis at a corner without a curve, mm/tick.
    pub fn knee(&self, axis: usize, rapid: bool) -> f32 {
        let Some(of) = self.axes.get(axis) else { return 0.0 };
        let mut joint = of.set(rapid).joint;
        if let Some(before) = self.before.as_ref().and_then(|axes| axes.get(axis)) {
            joint = joint.restricted(&before[usize::from(rapid)]);
        }
        if joint.is_weighted { joint.knee } else { min(joint.knee, TRANSITION_PART * joint.budget) }
    }

    /// Highest speed (mm/tick) at several transitions that the motion passes within a tick. `from`: end of
    /// the block before the first transition; `to`: start of the block after the last one. The steps of
    /// acceleration add up. The sum stays inside the transition's part of the jerk budget.
    pub fn bending(&self, from: &End<AXES>, to: &End<AXES>, rapid: bool) -> f32 {
        let bends = from.curvature.iter().zip(&to.curvature);
        let square = self.axes.iter().zip(bends).fold(f32::MAX, |square, (axis, (c0, c1))| {
            let bend = magnitude(c1 - c0);
            let part = TRANSITION_PART * axis.set(rapid).joint.budget;
            if part < square * bend { part / bend } else { square }
        });
        sqrt_f32(square) * MARGIN
    }

    /// Highest speed (mm/tick) at which a change of direction from `from` to `to` is no more than rounding of
    /// coordinates. At this speed, the speed profile keeps all limits without a part for the transition.
    pub fn unseen(&self, from: &End<AXES>, to: &End<AXES>, rapid: bool) -> f32 {
        let smooth = if self.slope == SlopeType::Step { STEP_SMOOTH } else { SMOOTH };
        let mut v = f32::MAX;
        for (k, (axis, (t0, t1))) in self.axes.iter().zip(from.tangent.iter().zip(&to.tangent)).enumerate() {
            let knee = size_f32(t1.wrapping_sub(*t0).unsigned_abs()) * LSB_40;
            let before = self.before.as_ref().and_then(|axes| axes.get(k));
            let before = before.map_or(f32::MAX, |joints| joints[usize::from(rapid)].budget);
            let unseen = smooth * min(axis.set(rapid).joint.budget, before);
            v = if unseen < v * knee { unseen / knee } else { v };
            let bend = magnitude(from.curvature[k] - to.curvature[k]);
            let is_free = axis.set(rapid).joint.bend == f32::MAX;
            v = if is_free || unseen >= v * v * bend { v } else { sqrt_f32(unseen / bend) };
        }
        v * MARGIN
    }

    /// The least duration of a straight line, in ticks, at which the rounding of its end point causes no step
    /// of speed above the limits. The end point is `off` (mm) from its exact place, so the direction changes
    /// by `off` divided by the line's length. The result is at most [`LONGEST_SMOOTHING`]; a line of that
    /// duration may still have such a step.
    pub fn smoothing(&self, off: f32, rapid: bool) -> f32 {
        let least = self.axes.iter().fold(f32::MAX, |least, axis| min(least, axis.set(rapid).joint.budget));
        min(off / (SMOOTH * least), LONGEST_SMOOTHING)
    }

    /// Whether a transition is tangential except for rounding of coordinates. If so, at the speed `fastest`
    /// the steps of each axis are far below the limits of a transition.
    pub fn is_slight(&self, from: &End<AXES>, to: &End<AXES>, rapid: bool, fastest: f32) -> bool {
        let ends = from.tangent.iter().zip(&to.tangent).zip(from.curvature.iter().zip(&to.curvature));
        self.axes.iter().zip(ends).all(|(axis, ((t0, t1), (c0, c1)))| {
            let TransitionLimits { budget, knee, .. } = axis.set(rapid).joint;
            let step = fastest * size_f32(t1.wrapping_sub(*t0).unsigned_abs()) * LSB_40;
            let part = TRANSITION_PART * budget;
            step <= SLIGHT * min(part, knee) && fastest * fastest * magnitude(c1 - c0) <= SLIGHT * part
        })
    }

    /// Whether the acceleration `a` along the path (mm/tick²) may pass a change of direction. The step in the
    /// acceleration of each axis then stays inside its part of the jerk budget.
    pub fn turns_little(&self, from: &End<AXES>, to: &End<AXES>, rapid: bool, a: f32) -> bool {
        self.axes.iter().zip(from.tangent.iter().zip(&to.tangent)).all(|(axis, (t0, t1))| {
            let set = if rapid { &axis.rapid } else { &axis.feed };
            a * size_f32(t1.wrapping_sub(*t0).unsigned_abs()) * LSB_40 <= TURN_PART * set.joint.budget
        })
    }

    /// The part of the deceleration `a` along the path that may pass a corner without a curve at the speed
    /// `v`. For every axis, the step of speed and the deceleration together stay inside the largest
    /// acceleration on both sides. If blocks of `shorter` mm take less than a tick, several corners add up.
    ///
    /// On a bent path, a stop from a lower speed than planned may have more deceleration than `a`. The part
    /// for the corner stays the same.
    #[inline(never)]
    pub fn passing_knee(
        &self,
        from: &End<AXES>,
        to: &End<AXES>,
        rapid: bool,
        shorter: f32,
        (v, a): (f32, f32),
    ) -> Passing {
        let mut part = 1.0;
        let a = a * (1.0 / (1.0 - KNEE_PART * SLIGHT));
        let knees = if v > shorter { v + v * v / max(shorter, LSB_40) } else { v };
        let tangents = from.tangent.iter().zip(&to.tangent);
        let curvatures = from.curvature.iter().zip(&to.curvature);
        for ((axis, (&t0, &t1)), (c0, c1)) in self.axes.iter().zip(tangents).zip(curvatures) {
            if t0 == t1 {
                continue;
            }
            let set = axis.set(rapid);
            let step = knees * size_f32(t1.wrapping_sub(t0).unsigned_abs()) * LSB_40;
            let bend = max(magnitude(*c0), magnitude(*c1));
            // A slight knee has its own part of the limits.
            if step <= SMOOTH * set.joint.budget || (bend <= 0.0 && step <= KNEE_PART * SLIGHT * axis.a_max) {
                continue;
            }
            if bend > 0.0 && step > KNEE_PART * axis.a_max {
                return Passing::NONE;
            }
            let left = axis.a_max - step - min(v * v * bend, HIGHEST * HIGHEST * axis.a_max);
            let most = a * size_f32(max_size(t0, t1)) * LSB_40;
            part = if left < part * most { left / most } else { part };
        }
        Passing::of(part)
    }
}

fn max_size(a: i64, b: i64) -> u64 {
    a.unsigned_abs().max(b.unsigned_abs())
}

/// How much of a deceleration may continue through a transition: all of it, 15/16, 3/4, half, or none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Passing(u8);

impl Passing {
    /// All of the deceleration may pass the transition.
    pub const ALL: Self = Self(0);
    /// No deceleration may pass: it is zero at the transition.
    pub const NONE: Self = Self(4);
    /// The parts by their number. Number 4, after the last part, means none.
    const PARTS: [f32; 4] = [1.0, 15.0 / 16.0, 3.0 / 4.0, 1.0 / 2.0];

    /// The largest part that is at most `part`.
    fn of(part: f32) -> Self {
        Self::PARTS.iter().fold(Self::ALL, |Self(k), of| if *of <= part { Self(k) } else { Self(k + 1) })
    }

    /// The largest of the four parts with which the deceleration `a` is at most `most`; none if half of `a`
    /// is too much.
    pub fn of_part(most: f32, a: f32) -> Self {
        if most >= a { Self::ALL } else { Self::of(most / a) }
    }

    /// The smaller one of two parts.
    pub fn least(self, other: Self) -> Self {
        Self(self.0.max(other.0))
    }

    /// The part with this number, as [`Self::number`] returns it.
    pub const fn numbered(number: u8) -> Self {
        Self(number)
    }

    /// The part as a number of two bits: 0 is all, 3 is the smallest part. [`Self::NONE`] gives 3 too;
    /// callers store elsewhere that no deceleration may pass.
    pub const fn number(self) -> u8 {
        if self.0 < 3 { self.0 } else { 3 }
    }

    /// The part as a factor, 0 to 1.
    pub fn part(self) -> f32 {
        Self::PARTS.get(usize::from(self.0)).copied().unwrap_or(0.0)
    }
}

/// Speed of a transition with steps of speed. `alone`: its speed if no other one is within three ticks. Near
/// the transition, the speed changes by `a` per tick. `quarter` is a fourth of its part, divided by its knee;
/// `length` is the length of the shorter block.
///
/// A block that begins or ends with the speed v takes three ticks if its length is 3 v + 9/2 a. The check has
/// two steps, because a small difference of length and a would be inaccurate. Otherwise the steps of all
/// transitions within a tick share a fourth of the part: v·√(v² + a·length) ≤ quarter·length. The root is the
/// speed in the middle of a block with v at both ends.
fn beside_others(alone: f32, quarter: f32, length: f32, a: f32) -> f32 {
    let part = if length >= 45.0 * a {
        0.3
    } else if length >= 9.0 * a {
        1.0 / 6.0
    } else {
        0.0
    };
    let slow = part * length;
    if alone <= slow {
        return alone;
    }
    let (gained, shared) = (a * length, quarter * length);
    let both = gained + sqrt_f32(gained * gained + 4.0 * shared * shared);
    let close = if both > 0.0 { shared * sqrt_f32(2.0 / both) } else { 0.0 };
    min(alone, max(slow, min(quarter, close)))
}

//! The deceleration and jerk that the axes permit for a stop on the coming part of the path.
//!
//! The planned limits of an element are for its highest speed, and for the place with the strongest
//! curvature. A stop uses only a part of the element, at a falling speed. So the axes permit more
//! deceleration than the planned limits.
use super::axis::{Axis, Set};
use super::permitted::{TRANSITION_PART, less_rough};
use super::{Dynamics, KNEE_PART, MARGIN};
use crate::math::float::{max, min};
use crate::math::root::sqrt_f32;
use crate::nc::SlopeType;
use crate::path::Swings;
use crate::slope::ramp_shape::RampShape;

/// Deceleration and jerk with which a motion stops along a part of the path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Braking {
    /// Deceleration, mm/tick². STEP has two decelerations: the second acts below a lower speed.
    pub a: [f32; 2],
    /// Jerk with which the deceleration rises, and jerk with which it falls, mm/tick³.
    pub j: [f32; 2],
    /// Mean jerk with which a positive acceleration falls to zero before the braking, mm/tick³.
    pub ends: f32,
}

impl Braking {
    /// Limits that restrict nothing: the start value before limits are lowered.
    pub const WIDEST: Self = Self { a: [f32::MAX; 2], j: [f32::MAX; 2], ends: f32::MAX };

    /// The next step of the search for limits that the axes permit. Returns lower limits for the next try, or
    /// `None` if the axes permit `self`. `left`: the limits that the axes permit for the try `self`.
    /// `before`: the try before, and the limits that the axes permitted for that try. With two tries, the
    /// secant method gives the next limit. With a single try, a limit is lowered by about twice its excess.
    #[inline(never)]
    pub fn less(&self, left: &Self, before: Option<&[Self; 2]>) -> Option<Self> {
        if *left == *self {
            return None;
        }
        let of = |braking: &Self| {
            let Self { a: [a, b], j: [rise, fall], ends } = *braking;
            [a, b, rise, fall, ends]
        };
        let mut less = of(self);
        let before = before.map(|before| before.each_ref().map(of));
        for (k, (tried, left)) in less.iter_mut().zip(of(left)).enumerate() {
            let above = *tried - left;
            if above <= 0.0 {
                continue;
            }
            let before = before.as_ref().and_then(|[was, had]| Some((*was.get(k)?, *had.get(k)?)));
            let again = match before {
                Some((was, had)) if was > *tried && was - had > above => {
                    above * (was - *tried) / (was - had - above)
                }
                None if above < NEARLY * left => {
                    *tried = left * JUST;
                    continue;
                }
                _ => 2.0 * above,
            };
            *tried = max(*tried - max(again, above) - SURPLUS * left, left * LESS);
        }
        let [a, b, rise, fall, ends] = less;
        Some(Self { a: [a, b], j: [rise, fall], ends })
    }

    /// Duration of a stop from the speed `v` and the deceleration `begun` at its start, ticks.
    fn time(&self, v: f32, begun: f32) -> f32 {
        let Self { a: [a, _], j: [rise, fall], .. } = *self;
        let [rising, falling] = [0.5 / rise, 0.5 / fall];
        let v = v + begun * begun * rising;
        let peak = min(a, sqrt_f32(v / (rising + falling)));
        v / peak + peak * (rising + falling) - 2.0 * begun * rising
    }
}

impl Braking {
    /// Lowers the deceleration or a jerk so that the deceleration stays below `most` in a part of the path.
    /// The code lowers the value that costs the least time.
    fn give_way(&mut self, most: f32, passed: &Passed) {
        let Passed { begun: [fastest, begun], change: [lost, left], .. } = *passed;
        let Self { a: [a, b], j: [rise, fall], .. } = *self;
        let (square, before) = (most * most, begun * begun);
        if a <= most || before + 2.0 * lost * rise <= square || 2.0 * left * fall <= square {
            return;
        }
        let with = |a: f32, j: [f32; 2]| Self { a: [a, b], j, ..*self };
        let mut best = with(most, [rise, fall]);
        let mut time = best.time(fastest, begun);
        for j in [[max(square - before, 0.0) / (2.0 * lost), fall], [rise, square / (2.0 * left)]] {
            let other = with(a, j);
            let takes = other.time(fastest, begun);
            if j[0] > LEAST && takes < time {
                (best, time) = (other, takes);
            }
        }
        *self = best;
    }

    /// Lowers the jerks to those that an axis permits on one side, in positive or in negative direction.
    /// `firsts`: how far the axis moves towards this side per path distance, while the deceleration rises and
    /// while it falls. `budget`: the jerk that the curve leaves to the axis. A deceleration a takes c·a from
    /// `budget`, and an acceleration a takes `c_gains`·a.
    fn leave(&mut self, firsts: [f32; 2], (budget, c, c_gains): (f32, f32, f32), passed: &Passed, peak: f32) {
        let Passed { begun: [_, begun], change: [lost, left], ramps, gains, .. } = *passed;
        let [first, _] = firsts;
        if gains > 0.0 {
            self.ends = min(self.ends, max(budget - c_gains * gains, 0.0) / (max(first, TINY) * peak));
        }
        let spared = budget - c * self.a[0];
        let froms = [(lost, begun), (left, 0.0)];
        for (((j, has), first), (u, begun)) in self.j.iter_mut().zip(ramps).zip(firsts).zip(froms) {
            let first = max(first, TINY);
            let with_all = spared / first;
            if !has || with_all >= *j {
                continue;
            }
            // The root of (budget − first·j)² = c²·(begun² + 2·j·u).
            let (cu, fb) = (c * u, first * begun);
            let below = c * sqrt_f32(2.0 * first * budget * u + cu * cu + fb * fb);
            let square = max(budget * budget - c * c * (begun * begun), 0.0);
            let root = square / max(first * budget + c * cu + below, TINY * TINY);
            *j = min(*j, max(with_all, root));
        }
    }
}

/// A part of the path through which a motion brakes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Passed {
    /// Highest speed in this part, mm/tick.
    pub v: f32,
    /// Whether this part is rapid motion; `None` if a part is feed motion and another part rapid motion.
    pub rapid: Option<bool>,
    /// Whether the ramp times limit the jerk of a curve (CHECK_JERK=2).
    pub by_ramps: bool,
    /// Speed (mm/tick) and deceleration (mm/tick²) at the start of the stop.
    pub begun: [f32; 2],
    /// Largest difference of the speed in this part to the speed at the start of the stop, and to the speed
    /// at its end.
    pub change: [f32; 2],
    /// Whether the deceleration rises in this part, and whether it falls.
    pub ramps: [bool; 2],
    /// An acceleration from before the stop that falls to zero in this part, mm/tick²; 0 if there is none.
    pub gains: f32,
    /// The stage of the braking with STEP: 0, or 1 below the speed at which the second deceleration begins.
    pub stage: usize,
    /// Whether a transition is near, which reserves its part of acceleration and jerk.
    pub corners: bool,
    /// The part of a deceleration that may pass the transitions nearby.
    pub passing: f32,
}

impl<const AXES: usize> Dynamics<AXES> {
    /// Lowers `braking` to the deceleration and jerks that the axes permit along a part of the path. The
    /// bounds of each axis, with the deceleration d and its jerk j, are
    ///
    /// |x″·v² − x′·d| ≤ a_max,  |x‴·v³ − 3·x″·v·d ∓ x′·j| ≤ B.
    ///
    /// The limits of the slope also hold. The positive and the negative side of an axis count separately,
    /// each with the largest value of each term towards it. So terms with different signs do not add up. Near
    /// a transition, all terms add up. Returns `None` if no motion is possible.
    #[inline(never)]
    pub fn stopping(&self, swings: &mut Swings<AXES>, passed: &Passed, braking: &mut Braking) -> Option<()> {
        if passed.corners || self.slope == SlopeType::Step {
            swings.even();
        }
        let swings = &*swings;
        let stage = passed.stage;
        let kinds = [false, true].into_iter().filter(|kind| passed.rapid.is_none_or(|rapid| rapid == *kind));
        for rapid in kinds {
            if self.slope.is_step() {
                let a = braking.a.get_mut(stage)?;
                *a = min(*a, self.stage(swings, passed, rapid));
                continue;
            }
            self.ramps(swings, passed, rapid, braking);
        }
        let Braking { a: [a, b], j: [rise, fall], ends } = *braking;
        (a > LEAST && b > LEAST && rise > LEAST && fall > LEAST && ends > LEAST).then_some(())
    }

    /// Deceleration and jerks of slopes other than STEP. The deceleration begins with the value d and rises
    /// with the jerk j. After the speed has dropped by u, the deceleration is at most √(d² + 2·j·u). The
    /// deceleration falls with another jerk j: if the speed will still drop by u, it is at most √(2·j·u). So
    /// an axis has all of a_max and of B, with c = 3·|x″|·v, for
    ///
    /// - the least of three values: a, and both roots. The result is at most A = (a_max − |x″|·v²)/|x′|. Of a
    ///   and both jerks, the code lowers the value that costs the least time;
    /// - |x′|·j + c·a ≤ B − |x‴|·v³ with the current a, or with the root for this j.
    ///
    /// On the positive side of an axis, a deceleration counts where x′ and x″ are negative, and the reverse.
    #[inline(never)]
    fn ramps(&self, swings: &Swings<AXES>, passed: &Passed, rapid: bool, braking: &mut Braking) {
        let Passed { v, corners, by_ramps, .. } = *passed;
        let part = if corners { 1.0 - KNEE_PART } else { 1.0 };
        let path = self.path.deceleration(rapid);
        let (mut still, mut most) = (path, path);
        // The part of B that the curve leaves on a side, and c for a deceleration and for an acceleration.
        let jerk = |axis: &Axis, [with, against]: [f32; 2], third: f32| {
            let Set { joint, geometric_budget, ramp_budget, .. } = axis.set(rapid);
            let budget = min(joint.budget, if by_ramps { *ramp_budget } else { *geometric_budget });
            (max(budget - third * v * v * v, 0.0), 3.0 * against * v, 3.0 * with * v)
        };
        for (axis, swing) in self.axes.iter().zip(&swings.0) {
            let [[above, below], ..] = *swing;
            let first = max(above, below);
            if first > 0.0 {
                self.lower(axis.set(rapid), first, rapid, passed, braking);
                still = min(still, axis.set(rapid).a_down / first);
            }
            for ([_, against], second, third) in sides(swing) {
                let (budget, c, _) = jerk(axis, second, third);
                let left = max(part * axis.a_max - second[0] * v * v, 0.0) / max(against, TINY);
                most = min(most, min(left, budget / max(c, TINY)));
            }
        }
        let [still, most] = [still, most].map(less_rough);
        if braking.a[0] == f32::MAX {
            braking.a[0] = still;
        }
        braking.give_way(min(most, passed.passing * still), passed);
        for (axis, swing) in self.axes.iter().zip(&swings.0) {
            for ([with, against], second, third) in sides(swing) {
                braking.leave([against, with], jerk(axis, second, third), passed, self.peak_jerk());
            }
        }
    }

    /// Lowers the jerks to those of an axis that moves `first` times as far as the path.
    fn lower(&self, set: &Set, first: f32, rapid: bool, passed: &Passed, braking: &mut Braking) {
        let Set { a_up, a_down, j: [_, ends, rise, fall], joint, .. } = set;
        let near_knee = TRANSITION_PART / self.peak_jerk() * joint.budget / first;
        // Path limits do not change the ramp times.
        let part = min(self.path.deceleration(rapid) * first / a_down, 1.0);
        let most = |j: f32, part: f32| {
            let j = j / first * part;
            if passed.corners { min(j, near_knee) } else { j }
        };
        for ((j, has), of) in braking.j.iter_mut().zip(passed.ramps).zip([rise, fall]) {
            if has {
                *j = min(*j, most(*of, part));
            }
        }
        if passed.gains > 0.0 {
            let part = min(part, self.path.acceleration(rapid) * first / a_up);
            braking.ends = min(braking.ends, most(*ends, part));
        }
    }

    /// Ratio of the highest jerk of a ramp to its mean jerk.
    fn peak_jerk(&self) -> f32 {
        let shape = if self.slope == SlopeType::Sin2 { RampShape::SineSquare } else { RampShape::Linear };
        shape.peak_jerk()
    }

    /// Deceleration of STEP in this stage.
    #[inline(never)]
    fn stage(&self, swings: &Swings<AXES>, passed: &Passed, rapid: bool) -> f32 {
        let v = passed.v;
        let part = if passed.corners { 1.0 - KNEE_PART } else { MARGIN };
        let mut a = self.path.deceleration(rapid);
        for (axis, [[first, _], [second, _], _]) in self.axes.iter().zip(&swings.0) {
            let set = axis.set(rapid);
            if *first > 0.0 {
                let upper = if v * first > set.change_over { set.upper[1] } else { f32::MAX };
                a = min(a, min(set.a_down, upper) / first);
                a = min(a, max(part * axis.a_max - second * v * v, 0.0) / first);
            }
        }
        less_rough(a) * MARGIN
    }
}

/// The derivatives of an axis for each side, positive and negative. The first and the second derivative each
/// have two values: towards this side and towards the other one. The third derivative has the value towards
/// this side.
const fn sides([[a1, b1], [a2, b2], [a3, b3]]: &[[f32; 2]; 3]) -> [([f32; 2], [f32; 2], f32); 2] {
    [([*a1, *b1], [*a2, *b2], *a3), ([*b1, *a1], [*b2, *a2], *b3)]
}

/// Smallest part that one step leaves.
const LESS: f32 = 0.8;
/// Additional relative reduction below the permitted value.
const SURPLUS: f32 = 0.002;
/// A first reduction by less than this part is not doubled: other limits than those of the axes may be as
/// near.
const NEARLY: f32 = 0.01;
const JUST: f32 = 1.0 - 1.0 / 524_288.0;
/// Values below this one count as zero.
const LEAST: f32 = 1e-11;
/// Replaces a zero in a denominator.
const TINY: f32 = 1e-12;

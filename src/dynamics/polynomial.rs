//! Limits inside a curve that is a polynomial: at corners, in Surface and in splines. The parameter of such a
//! polynomial is its path length or, for some corners, time.
use super::axis::{Axis, Set};
use super::{Dynamics, KNEE_PART, NO_LIMIT, NORMAL_PART, Permitted};
use crate::dynamics::Share;
use crate::dynamics::permitted::{ARC_PART, ARC_SLOPE_PART, SURELY};
use crate::math::float::{magnitude, max, min, to_f32};
use crate::math::root::{cbrt_f32, sqrt_f32};
use crate::nc::SlopeType;
use crate::path::{Bounds, Passage};
use crate::quantity::{DISTANCE_LSB, Distance};
use crate::slope::limits::{Limits, Loose, SlopeLaw, lower};

/// Share of `a_max` and of the jerk budget `B` for an element whose path is time.
const TIMED_PART: f32 = 0.988;
/// Margin for rounding of the jerk that [`Dynamics::left`] returns.
const ROUNDED: f32 = 1.0 - 1.0 / 1_048_576.0;
/// Margin for rounding of the acceleration in [`Dynamics::trade`].
const TRADED: f32 = 1.0 - 1.0 / 65_536.0;
/// Least value of a denominator, in place of zero.
const TINY: f32 = 1e-12;

/// Number of speeds tried for a curve, and the ratio from one speed to the next.
const SPEEDS: usize = 5;
const SPEED_STEP: f32 = 0.8;
/// Shares of `a_max` and of `B` for the curvature of an element that is passed at one speed. A lower share
/// shortens a feed hold inside the element.
const STEADY_NORMAL_PART: f32 = 0.95;
const STEADY_PART: f32 = 0.88;
/// Shares of `a_max` and of `B` for the curvature of an element inside a curve of many elements. One speed
/// profile passes all these elements with the lowest of their accelerations. So they leave nearly equal
/// shares to the profile.
const FLOWING_NORMAL_PART: f32 = 0.7;
const FLOWING_PART: f32 = 0.6;
const FLOWING_SLOPE_PART: f32 = 0.25;
/// In a curve of many elements, the speed leaves at least this share of the acceleration that its jerk
/// reaches. The second value is the largest number of speeds that are tried.
const FLOWING_PULL: f32 = 0.25;
const FLOWING_SPEEDS: usize = 8;
/// Shares of `a_max` and of `B` for the curvature of a sharp turn. The speed changes in the elements before
/// and after the turn.
const SHARP_NORMAL_PART: f32 = 0.75;
const SHARP_PART: f32 = 0.85;
/// From this share of the feed on, the element gets a higher acceleration at a reduced speed
/// ([`Dynamics::trade`]).
const NEARLY: f32 = 0.9;
/// A speed profile with less jerk and the full acceleration is chosen if it is not much slower than one with
/// less acceleration. This is the highest ratio of the times.
const SLOWER: f32 = 1.2;
/// Shares of `a_max` and of `B` for the curvature, and share of `B` for the speed profile, where acceleration
/// passes both ends of an element. With 0.8 in place of 0.6, constant speeds in runs of chords are 2 %
/// higher. But random programs then take 1.3 % longer, some of them up to 50 %: the speed hardly changes
/// inside the elements.
const THROUGH_PARTS: [f32; 3] = [NORMAL_PART, 0.6, 0.0];
/// Share of `B` for a curve at its highest speed.
const PASSING_PART: f32 = 0.8;
/// With STEP, a lower speed of an element is chosen if the time from stop to stop falls below this share.
const GAINS: f32 = 0.8;
/// With CONST_VEL: share of `B` for the curvature, and share left to the speed profile.
const CONSTANT_PART: f32 = 0.95;
const CONSTANT_SLOPE_PART: f32 = 0.02;

/// Limits of a curve that replaces a corner, in addition to those of the axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Curving {
    /// CHECK_JERK: the jerk that the curvature may cause. 0: no limit, 1: by the geometric ramp time, 2: by
    /// the ramp times.
    pub jerk: u8,
    /// CONST_VEL: data of a curve with constant speed. `None` without CONST_VEL.
    pub constant: Option<Steady>,
    /// The nearest sharp turn in the same curve, which limits the speed around it.
    pub near: Near,
}

/// A sharp turn of a curve that consists of many elements. The turn is inside the element or near it, and
/// limits the element's speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Near {
    /// Highest speed in the turn, mm/tick.
    pub v: f32,
    /// Distance along the path from the turn to the farther end of the element, mm; 0 if the turn is in the
    /// element.
    pub way: f32,
}

impl Near {
    /// No sharp turn is near, so there is no limit.
    pub const NONE: Self = Self { v: f32::MAX, way: f32::MAX };

    /// Highest speed of an element under a speed profile with jerk `jerk`. In the turn, the acceleration is
    /// zero. With constant jerk j, the distance is v·t + j·t³/6, so the speed changes by at most
    /// ∛(9/2·j·way²).
    fn speed(&self, jerk: f32) -> f32 {
        if self.way <= 0.0 { f32::MAX } else { self.v + cbrt_f32(4.5 * jerk * self.way * self.way) }
    }
}

/// CONST_VEL: the common speed of all elements of a curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Steady {
    /// Highest speed that every element of the curve permits, mm/tick.
    pub v: f32,
    /// Path length of all elements of the curve, mm.
    pub length: f32,
}

impl Steady {
    /// For an element that stands alone, without a common speed.
    pub const FREE: Self = Self { v: f32::MAX, length: f32::MAX };
}

/// Largest relative change of speed over a curve of constant speed. The error of the elements' arc length
/// adds to this change.
const CONSTANT: f32 = 3e-4;

/// Shares for the curvature of an element, of `a_max` and of `B`, and the share of `B` that is left to the
/// speed profile.
const fn parts(passage: Passage, sharp: bool, stepped: bool) -> [f32; 3] {
    match passage {
        // A deceleration of STEP acts from the first tick on.
        Passage::Steady if stepped => [NORMAL_PART, STEADY_PART, CONSTANT_SLOPE_PART],
        Passage::Steady => [STEADY_NORMAL_PART, STEADY_PART, CONSTANT_SLOPE_PART],
        Passage::Flowing if sharp => [SHARP_NORMAL_PART, SHARP_PART, FLOWING_SLOPE_PART],
        Passage::Flowing => [FLOWING_NORMAL_PART, FLOWING_PART, FLOWING_SLOPE_PART],
        Passage::Constant => [TIMED_PART, CONSTANT_PART, CONSTANT_SLOPE_PART],
        Passage::Through => THROUGH_PARTS,
        Passage::Varying | Passage::Timed(_) => [NORMAL_PART, ARC_PART, ARC_SLOPE_PART],
    }
}

impl Limits {
    /// Tries `speeds` speeds; each is four fifths of the one before. Takes the speed with which an element of
    /// `length` (mm) needs the least time from stop to stop. `left_at(v, a)` returns the part of the
    /// acceleration `a` that is available at the speed `v`.
    #[cfg_attr(feature = "fast", inline(always))]
    fn choose(
        &mut self,
        length: f32,
        speeds: usize,
        constant: Option<Steady>,
        left_at: impl Fn(f32, f32) -> f32,
    ) {
        let mut best = (f32::MAX, 0.0, 0.0);
        if let Some(Steady { v, .. }) = constant {
            // All elements have the speed of the slowest one.
            self.v = min(self.v, v);
        }
        let mut v = self.v;
        let still = left_at(0.0, min(self.a_up, self.a_down));
        // With STEP, acceleration has no ramp, and the motion passes most elements without a change of speed.
        let gains = if matches!(self.law, SlopeLaw::Stepped { .. }) { GAINS } else { 1.0 };
        for _ in 0..speeds {
            let a = left_at(v, min(self.a_up, self.a_down));
            let time = if length * a >= v * v { length / v + v / a } else { 2.0 * sqrt_f32(length / a) };
            if time < gains * best.0 {
                best = (time, v, a);
            }
            // A lower speed gives no higher acceleration and no shorter time.
            if a >= still {
                break;
            }
            v *= SPEED_STEP;
        }
        self.v = best.1;
        if let Some(Steady { length, .. }) = constant {
            self.loose = Loose::of(best.2);
            // Over this length, the square of the speed changes by 2·a·length.
            best.2 = min(best.2, CONSTANT * self.v * self.v / length);
        }
        let loose = self.loose;
        self.curve(best.2, still, false);
        self.loose = loose;
    }
}

impl<const AXES: usize> Dynamics<AXES> {
    /// Limits of a polynomial of `length`, as [`Self::element`] returns them for lines and arcs. The largest
    /// derivatives of the path share a_max and the jerk budget B of each axis:
    ///
    /// |x''|·v² + |x'|·a ≤ a_max,  |x'''|·v³ + 3·|x''|·v·a + |x'|·j ≤ B.
    ///
    /// As for an arc, five speeds are compared. The result has the speed with which the element alone takes
    /// the least time. An element of constant speed has the highest of these speeds. The acceleration that
    /// this speed leaves is then for changes of speed by commands of the operator. With CONST_VEL, this
    /// acceleration is also for the motion from and to a standstill ([`Loose`]).
    pub fn polynomial(
        &self,
        length: Distance,
        bounds: &Bounds<AXES>,
        feed: Option<f32>,
        curving: Curving,
    ) -> Permitted {
        let rapid = feed.is_none();
        let length = to_f32(length.to_bits()) * DISTANCE_LSB;
        if let Passage::Timed(speed) = bounds.passage {
            return self.timed(bounds, speed, feed);
        }
        let mut limits = Limits { v: self.path.speed(rapid), ..Limits::WIDEST };
        let mut share_left = Share::WHOLE;
        let mut v_reduced = f32::MAX;
        // Rapid motion has no programmed feed.
        let feed = feed.map_or(f32::MAX, |feed| self.programmed(Some(feed)) / bounds.fastest);
        limits.v = min(limits.v, feed * self.level);
        let derivatives = || bounds.first.iter().zip(&bounds.second).zip(&bounds.third);
        let stepped = self.slope == SlopeType::Step;
        let a_max = |axis: &Axis| if stepped { (1.0 - KNEE_PART) * axis.a_max } else { axis.a_max };
        let budget_of = |set: &Set| if stepped { f32::MAX } else { set.curving_budget(curving.jerk) };
        let mut change_over = f32::MAX;
        if stepped {
            for (axis, first) in self.axes.iter().zip(&bounds.first).filter(|(_, first)| **first > 0.0) {
                change_over = min(change_over, axis.set(rapid).change_over / first);
            }
        }
        limits.law = self.law(change_over);
        let [normal_part, curve_part, slope_part] = parts(bounds.passage, curving.near.way <= 0.0, stepped);
        let trades = bounds.trades() && !stepped;
        let peak = match &limits.law {
            SlopeLaw::JerkLimited { shape, .. } => shape.peak_jerk(),
            SlopeLaw::Stepped { .. } => 1.0,
        };
        // Jerk left to the speed profile.
        let mut left = f32::MAX;
        for (axis, ((first, second), third)) in self.axes.iter().zip(derivatives()) {
            let set = axis.set(rapid);
            if *first > 0.0 {
                limits.restrict(&mut share_left, set, 1.0 / first, true);
                v_reduced = min(v_reduced, axis.v_reduced / first);
            }
            if *second > 0.0 {
                let normal = min(set.least(), normal_part * a_max(axis));
                // A root is computed only if it can lower the speed.
                if limits.v * limits.v * second >= SURELY * normal {
                    limits.v = min(limits.v, sqrt_f32(normal / second));
                }
            }
            let budget = budget_of(set);
            if budget < f32::MAX {
                let v = limits.v;
                if *third > 0.0 && v * v * v * third >= SURELY * (curve_part * budget) {
                    limits.v = min(v, cbrt_f32(curve_part * budget / third));
                }
                if *first > 0.0 {
                    left = min(left, slope_part / peak * budget / first);
                }
            }
        }
        if let (true, SlopeLaw::JerkLimited { j, .. }) = (!trades && !bounds.passes(), &mut limits.law) {
            lower(j, [left; 4]);
        }
        let mut slow = false;
        if bounds.flows() {
            limits.flow_on();
            let jerk = (0..4).fold(0.0, |most, ramp| max(most, limits.jerk(ramp)));
            let near = curving.near.speed(jerk);
            slow = near < limits.v;
            limits.v = min(limits.v, near);
        }
        let whole = if rapid { f32::MAX } else { feed * bounds.fastest * self.level };
        self.share_out(bounds, (length, whole, slow), &mut limits, (rapid, curving));
        self.path.lower(&mut limits, rapid, true);
        let override_range = limits.take_feed(feed, v_reduced, self.level);
        (limits, share_left, override_range)
    }

    /// Limits of an element inside a curve of many elements. Each speed tried is four fifths of the one
    /// before. The result is the highest speed that leaves enough acceleration to reach it
    /// ([`FLOWING_PULL`]). `feed`: the highest speed in the span. Near this speed, [`Self::trade`] sets the
    /// acceleration.
    #[inline(never)]
    fn flow(
        &self,
        bounds: &Bounds<AXES>,
        (feed, slow): (f32, bool),
        limits: &mut Limits,
        budget_of: impl Fn(&Axis) -> f32,
    ) {
        // A corner that acceleration passes has its highest speed.
        let mut speeds = if bounds.flows() { FLOWING_SPEEDS } else { 0 };
        let most = min(limits.a_up, limits.a_down);
        let [a, jerk] = loop {
            let [a, j] = self.left(bounds, (limits.v, slow), most, &budget_of);
            if speeds == 0 || a >= FLOWING_PULL * min(most, sqrt_f32(j * limits.v)) {
                break [a, j];
            }
            limits.v *= SPEED_STEP;
            speeds -= 1;
        };
        if bounds.flows() && limits.v >= NEARLY * feed && self.trade(bounds, (feed, jerk), limits, &budget_of)
        {
            return;
        }
        if let SlopeLaw::JerkLimited { shape, j, .. } = &mut limits.law {
            lower(j, [jerk / shape.peak_jerk(); 4]);
        }
        limits.lower_accelerations(a);
    }

    /// Acceleration and jerk that the speed `v` leaves; the acceleration is at most `most`. A share s of the
    /// jerk left serves an acceleration along the path, and 1 − s serves its change. Let A be the
    /// acceleration for s = 1, and J the jerk for s = 0. A change of speed by v then takes v/(sA) +
    /// sA/((1−s)J). This time is least for s = 1/(1 + A/√(vJ)). Here v is twice the speed, because a speed
    /// profile also has phases of constant speed. Jerk that the acceleration does not use is left for its
    /// change.
    ///
    /// Every speed profile begins and ends with zero acceleration, so a jerk j reaches at most a = √(2jv).
    /// With `slow`, this acceleration is the lowest in the span, and the other elements are faster. The
    /// element then keeps the full acceleration if the profile is not much slower ([`SLOWER`]).
    #[inline(never)]
    fn left(
        &self,
        bounds: &Bounds<AXES>,
        (v, slow): (f32, bool),
        mut most: f32,
        budget_of: &impl Fn(&Axis) -> f32,
    ) -> [f32; 2] {
        let derivatives = || bounds.first.iter().zip(&bounds.second).zip(&bounds.third);
        let left = |axis: &Axis, third: f32| max(budget_of(axis) - third * v * v * v, 0.0);
        for (axis, ((first, second), _)) in self.axes.iter().zip(derivatives()) {
            if *first > 0.0 {
                most = min(most, max(axis.a_max - second * v * v, 0.0) / first);
            }
        }
        let (all, mut root) = (most, f32::MAX);
        for (axis, ((first, second), third)) in self.axes.iter().zip(derivatives()) {
            if *second > 0.0 && budget_of(axis) < f32::MAX {
                let left = left(axis, *third);
                let whole = left / (3.0 * second * v);
                let reached = sqrt_f32(2.0 * v * left / max(*first, TINY));
                most = min(most, whole / (1.0 + whole / max(reached, TINY)));
                root = min(root, root_of(left, 1.5 * second * v * sqrt_f32(2.0 * v), *first));
            }
        }
        let (mut jerk, mut any) = (NO_LIMIT, root * root);
        for (axis, ((first, second), third)) in self.axes.iter().zip(derivatives()) {
            if *first > 0.0 && budget_of(axis) < f32::MAX {
                let left = left(axis, *third);
                jerk = min(jerk, max(left - 3.0 * second * v * most, 0.0) / first);
                any = min(any, left / first);
            }
        }
        let time = |a: f32, j: f32| {
            let a = min(a, sqrt_f32(j * v));
            v / a + a / j
        };
        if slow && any > TINY && time(all, any) <= SLOWER * time(most, jerk) {
            (most, jerk) = (all, any);
        }
        [max(most, TINY), max(jerk * ROUNDED, TINY)]
    }

    /// Shares out acceleration and jerk of an element between its curvature and the speed profile, as its
    /// passage demands.
    fn share_out(
        &self,
        bounds: &Bounds<AXES>,
        (length, feed, slow): (f32, f32, bool),
        limits: &mut Limits,
        (rapid, curving): (bool, Curving),
    ) {
        let stepped = self.slope == SlopeType::Step;
        let a_max = |axis: &Axis| if stepped { (1.0 - KNEE_PART) * axis.a_max } else { axis.a_max };
        let budget_of = |set: &Set| if stepped { f32::MAX } else { set.curving_budget(curving.jerk) };
        let [.., slope_part] = parts(bounds.passage, curving.near.way <= 0.0, stepped);
        let speeds = if bounds.passage == Passage::Varying { SPEEDS } else { 1 };
        if bounds.passes() && !stepped {
            self.flow(bounds, (feed, slow), limits, |axis| budget_of(axis.set(rapid)));
        } else if bounds.trades() && !stepped {
            let whole = |axis: &Axis| {
                let set = axis.set(rapid);
                max(set.curving_budget(curving.jerk), set.joint.budget)
            };
            self.trade(bounds, (limits.v, 0.0), limits, whole);
        } else {
            let derivatives = || bounds.first.iter().zip(&bounds.second).zip(&bounds.third);
            limits.choose(length, speeds, curving.constant, |v: f32, mut a: f32| {
                for (axis, ((first, second), third)) in self.axes.iter().zip(derivatives()) {
                    if *first > 0.0 {
                        a = min(a, max(a_max(axis) - second * v * v, 0.0) / first);
                    }
                    let budget = budget_of(axis.set(rapid));
                    if *second > 0.0 && budget < f32::MAX {
                        let left = (1.0 - slope_part) * budget - third * v * v * v;
                        a = min(a, left / (3.0 * v * second));
                    }
                }
                a
            });
        }
    }

    /// Whether [`Self::polynomial`] surely permits the speed `v` (mm/tick) for an element of constant speed.
    /// `first`, `second` and `third` are the highest derivatives of the element, per axis. The check may
    /// return `false` for a permitted speed, but never `true` for a forbidden one.
    pub fn permits(
        &self,
        v: f32,
        [first, second, third]: &[[f32; AXES]; 3],
        (feed, fastest): (Option<f32>, f32),
        check: u8,
    ) -> bool {
        let rapid = feed.is_none();
        let feed = feed.map_or(f32::MAX, |feed| self.programmed(Some(feed)) / fastest);
        // A planned override above 100 % raises the feed up to the limits; that case is not checked here.
        if self.slope == SlopeType::Step
            || self.level > 1.0
            || min(self.path.speed(rapid), feed * self.level) < v
        {
            return false;
        }
        let [normal_part, curve_part, _] = parts(Passage::Constant, false, false);
        let derivatives = first.iter().zip(second).zip(third);
        self.axes.iter().zip(derivatives).all(|(axis, ((first, second), third))| {
            let set = axis.set(rapid);
            let budget = set.curving_budget(check);
            v * first <= SURELY * set.v
                && v * v * second <= SURELY * min(set.least(), normal_part * axis.a_max)
                && (budget == f32::MAX || v * v * v * third <= SURELY * (curve_part * budget))
        })
    }

    /// The highest speed (mm/tick) of a curve whose ends may be passed with acceleration, from the second and
    /// third derivatives per axis. `check` is CHECK_JERK.
    pub fn passing(&self, [second, third]: [&[f32; AXES]; 2], rapid: bool, check: u8) -> f32 {
        let (normal_part, curve_part) = (NORMAL_PART, PASSING_PART);
        let (mut square, mut cube) = (NO_LIMIT, NO_LIMIT);
        for (axis, (second, third)) in self.axes.iter().zip(second.iter().zip(third)) {
            let (set, second, third) = (axis.set(rapid), magnitude(*second), magnitude(*third));
            if second > 0.0 {
                square = min(square, min(set.least(), normal_part * axis.a_max) / second);
            }
            if third > 0.0 {
                cube = min(cube, curve_part * set.curving_budget(check) / third);
            }
        }
        min(sqrt_f32(square), cbrt_f32(cube))
    }

    /// Limits of an element whose path is time. At the highest speed, the curvature takes nearly all of
    /// acceleration and jerk. [`Self::trade`] finds what is left to the speed profile.
    fn timed(&self, bounds: &Bounds<AXES>, speed: f32, feed: Option<f32>) -> Permitted {
        let rapid = feed.is_none();
        let mut limits = Limits { v: min(speed, self.path.speed(rapid)), ..Limits::WIDEST };
        let mut share_left = Share::WHOLE;
        let feed = self.programmed(feed);
        limits.v = min(limits.v, feed * self.level);
        let mut v_reduced = f32::MAX;
        limits.law = self.law(f32::MAX);
        let derivatives = || bounds.first.iter().zip(&bounds.second).zip(&bounds.third);
        for (axis, ((first, second), third)) in self.axes.iter().zip(derivatives()) {
            let set = axis.set(rapid);
            if *first > 0.0 {
                limits.restrict(&mut share_left, set, 1.0 / first, true);
                v_reduced = min(v_reduced, axis.v_reduced / first);
            }
            // A root is computed only if it can lower the speed.
            let v = limits.v;
            if v * v * second >= SURELY * TIMED_PART * axis.a_max {
                limits.v = min(limits.v, sqrt_f32(TIMED_PART * axis.a_max / second));
            }
            if v * v * v * third >= SURELY * TIMED_PART * set.joint.budget {
                limits.v = min(limits.v, cbrt_f32(TIMED_PART * set.joint.budget / third));
            }
        }
        self.trade(bounds, (limits.v, 0.0), &mut limits, |axis| axis.set(rapid).joint.budget);
        self.path.lower(&mut limits, rapid, true);
        let override_range = limits.take_feed(feed, v_reduced, self.level);
        (limits, share_left, override_range)
    }

    /// The jerk left to the speed profile in a curve whose highest speed V takes nearly all of acceleration
    /// and jerk. A path acceleration a needs 3·x''·v·a in addition.
    ///
    /// A lower speed permits acceleration: v + a²/(2·j) ≤ V. With the jerk j, this rule holds for an
    /// acceleration that starts from a = 0 at a speed up to V. The rule also holds for a return to a = 0 at
    /// such a speed. If a braking motion meets the rule at the start of the curve, it meets the rule inside
    /// the curve. The highest j is wanted. With v = V·(1 − e²), a = e·√(2·j·V) and 0 ≤ e ≤ 1, an axis needs
    ///
    /// |x''|·V²·(1 − e²)² + |x'|·e·√(2·j·V) ≤ a_max,  |x'''|·V³·(1 − e²)³ + 3·|x''|·V·e·(1 − e²)·√(2·j·V) + |x'|·j ≤ B.
    ///
    /// For e ≤ 1/2, the powers are at most 1 − 7/4·e² and 1 − 9/4·e². For larger e, they are at most their
    /// value at 1/2 times 2·(1 − e). The product e·(1 − e²) is at most 0.385. With x = √(2·j·V), A =
    /// |x''|·V², C = |x'''|·V³ and D = 3·|x''|·V, sufficient conditions are
    ///
    /// - A + |x'|·x ≤ a_max or A² + (|x'|·x)²/7 ≤ a_max·A, and |x'|·x ≤ a_max and 9/16·A + |x'|·x/2 ≤ a_max;
    /// - C + 0.385·D·x + |x'|·j ≤ B or C² + D²·x²/9 ≤ (B − |x'|·j)·C, and 27/64·C + 0.385·D·x + |x'|·j ≤ B.
    ///
    /// Each condition has a largest x. The lowest of these x is the largest acceleration, the one at
    /// standstill; the jerk j follows from it. At a speed below V, the same x is stricter.
    ///
    /// Returns `false` and changes nothing if j is less than `least`.
    fn trade(
        &self,
        bounds: &Bounds<AXES>,
        (v, least): (f32, f32),
        limits: &mut Limits,
        budget_of: impl Fn(&Axis) -> f32,
    ) -> bool {
        let SlopeLaw::JerkLimited { shape: ramp, j: ramps, .. } = &mut limits.law else { return false };
        let mut most = f32::MAX;
        let derivatives = bounds.first.iter().zip(&bounds.second).zip(&bounds.third);
        for (axis, ((first, second), third)) in self.axes.iter().zip(derivatives) {
            if *first <= 0.0 {
                continue;
            }
            let a = second * v * v;
            let free = max(axis.a_max - a, 0.0);
            // A root below the lower or above the upper one of the two bounds is not needed.
            let whole = axis.a_max * axis.a_max;
            let near = if 7.0 * a <= SURELY * free {
                free
            } else if SURELY * (7.0 * a * free) >= whole {
                axis.a_max
            } else {
                max(free, sqrt_f32(7.0 * a * free))
            };
            most = min(most, min(min(near, axis.a_max), 2.0 * (axis.a_max - 0.5625 * a)) / first);
            let budget = min(budget_of(axis), NO_LIMIT);
            let (cubed, across, along) = (third * v * v * v, second * v, first / (2.0 * v));
            // The largest x with 0.385·D·x + |x'|·j ≤ rest.
            let reach = |rest: f32| root_of(rest, 0.5 * 0.385 * 3.0 * across, along);
            let slack = max(budget - cubed, 0.0);
            let least = reach(slack);
            if least >= most {
                continue;
            }
            let evenly = sqrt_f32(cubed * slack / max(across * across + cubed * along, f32::MIN_POSITIVE));
            let whole = reach(budget - 0.421_875 * cubed);
            most = min(most, max(least, min(evenly, whole)));
        }
        most *= TRADED;
        let j = most * most / (2.0 * v);
        if j < least {
            return false;
        }
        lower(ramps, [j / ramp.peak_jerk(); 4]);
        limits.lower_accelerations(most);
        true
    }
}

/// The largest x with along·x² + 2·half·x ≤ rest.
#[inline(never)]
fn root_of(rest: f32, half: f32, along: f32) -> f32 {
    rest / max(half + sqrt_f32(half * half + along * rest), TINY)
}

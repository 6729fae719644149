//! What the axes leave to a way to a standstill, along the part of the path that it takes.
//!
//! An element is planned for its highest speed, and for the place where it bends most. A motion that comes to a
//! standstill passes a part of it, slower and slower: there the axes permit more.
use super::axis::Set;
use super::permitted::TRANSITION_PART;
use super::{Dynamics, KNEE_PART, MARGIN};
use crate::math::float::{max, min};
use crate::math::root::sqrt_f32;
use crate::nc::SlopeType;
use crate::path::Bounds;
use crate::slope::ramp_shape::RampShape;

/// Acceleration and jerk of a way to a standstill.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Braking {
    /// Deceleration, mm/tick². The second one is that of STEP from a lower speed on.
    pub a: [f32; 2],
    /// Jerk of its ramps, mm/tick³.
    pub j: f32,
}

impl Braking {
    /// All of it.
    pub const WIDEST: Self = Self { a: [f32::MAX; 2], j: f32::MAX };

    /// Less than `left`, where that is less than `self`: by as much again, or by a part. `None` where all of it is
    /// left.
    pub fn less(&self, left: &Self) -> Option<Self> {
        if *left == *self {
            return None;
        }
        let less = |tried: f32, left: f32| max(left - (tried - left), left * LESS);
        let [a, b] = self.a;
        Some(Self { a: [less(a, left.a[0]), less(b, left.a[1])], j: less(self.j, left.j) })
    }
}

/// A part of the path, for a motion that slows down in it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Passed {
    /// Highest speed, mm/tick.
    pub v: f32,
    /// Whether it is rapid motion; `None`: some of it.
    pub rapid: Option<bool>,
    /// CHECK_JERK=2: the jerk of a curve is that of the ramp times.
    pub by_ramps: bool,
    /// The deceleration of its begin, and how far its speed is from the highest one or from zero at most.
    pub change: [f32; 2],
    /// The stage of STEP: 0, or 1 from the lower speed on.
    pub stage: usize,
    /// A transition is near, which has its part of acceleration and jerk.
    pub corners: bool,
}

impl<const AXES: usize> Dynamics<AXES> {
    /// Lowers `braking` to what a motion has along a part of the path with these bounds:
    ///
    /// |x''|·v² + |x'|·a ≤ a_max,  |x'''|·v³ + 3·|x''|·v·a + |x'|·j ≤ B,
    ///
    /// at most what the slope permits. `None` where nothing is left.
    pub fn stopping(&self, bounds: &Bounds<AXES>, passed: &Passed, braking: &mut Braking) -> Option<()> {
        let stage = passed.stage;
        let kinds = [false, true].into_iter().filter(|kind| passed.rapid.is_none_or(|rapid| rapid == *kind));
        for rapid in kinds {
            if self.slope == SlopeType::Step {
                let a = braking.a.get_mut(stage)?;
                *a = min(*a, self.stage(bounds, passed, rapid));
                continue;
            }
            self.ramps(bounds, passed, rapid, braking);
        }
        (braking.a[0] > LEAST && braking.a[1] > LEAST && braking.j > LEAST).then_some(())
    }

    /// Deceleration and jerk of the other slopes. Where the motion has come down by u, or is down to u, the
    /// deceleration is at most d + √(2·j·u), d being that of the begin. So an axis has all of a_max and of B,
    /// with c = 3·|x″|·v, for
    ///
    /// - a ≤ A or j ≤ (A − d)²/2u, whichever is more, with A = (a_max − |x″|·v²)/|x′|;
    /// - |x′|·j + c·a ≤ B − |x‴|·v³ with the a at hand, or
    ///   |x′|·j + c·√(2u)·√j ≤ B − |x‴|·v³ − c·d.
    #[inline(never)]
    fn ramps(&self, bounds: &Bounds<AXES>, passed: &Passed, rapid: bool, braking: &mut Braking) {
        let Passed { v, by_ramps, change: [begun, u], corners, .. } = *passed;
        let part = if corners { 1.0 - KNEE_PART } else { 1.0 };
        let shape = if self.slope == SlopeType::Sin2 { RampShape::SineSquare } else { RampShape::Linear };
        let peak = TRANSITION_PART / shape.peak_jerk();
        let Braking { a: [a, _], j } = braking;
        let path = self.path.deceleration(rapid);
        let moves = |first: &f32| *first > 0.0;
        for (axis, first) in self.axes.iter().zip(&bounds.first).filter(|(_, first)| moves(first)) {
            let Set { a_down, j: [.., rise, fall], joint, .. } = axis.set(rapid);
            // Path limits leave the ramp times.
            *j = min(*j, min(*rise, *fall) / first * min(path * first / a_down, 1.0));
            *a = min(*a, min(a_down / first, path));
            if corners {
                *j = min(*j, peak * joint.budget / first);
            }
        }
        let derivatives = || bounds.first.iter().zip(&bounds.second).zip(&bounds.third);
        for (axis, ((first, second), third)) in self.axes.iter().zip(derivatives()) {
            let first = max(*first, TINY);
            let left = max(part * axis.a_max - second * v * v, 0.0) / first;
            let rises = max(left - begun, 0.0);
            if *a > left && *j * (2.0 * u) > rises * rises {
                *a = left;
            }
            let Set { joint, geometric_budget, ramp_budget, .. } = axis.set(rapid);
            let budget = min(joint.budget, if by_ramps { *ramp_budget } else { *geometric_budget });
            let (budget, c) = (budget - third * v * v * v, 3.0 * second * v);
            let with_all = (budget - c * *a) / first;
            let (left, half) = (max(budget - c * begun, 0.0), 0.5 * c * sqrt_f32(2.0 * u));
            let root = left / (half + sqrt_f32(max(half * half + first * left, TINY * TINY)));
            *j = min(*j, max(with_all, root * root));
        }
    }

    /// Deceleration of STEP.
    #[inline(never)]
    fn stage(&self, bounds: &Bounds<AXES>, passed: &Passed, rapid: bool) -> f32 {
        let v = passed.v;
        let part = if passed.corners { 1.0 - KNEE_PART } else { MARGIN };
        let mut a = self.path.deceleration(rapid);
        for (axis, (first, second)) in self.axes.iter().zip(bounds.first.iter().zip(&bounds.second)) {
            let set = axis.set(rapid);
            if *first > 0.0 {
                let upper = if v * first > set.change_over { set.upper[1] } else { f32::MAX };
                a = min(a, min(set.a_down, upper) / first);
                a = min(a, max(part * axis.a_max - second * v * v, 0.0) / first);
            }
        }
        a * MARGIN
    }
}

/// What is left of it at least.
const LESS: f32 = 0.94;
/// Less is none.
const LEAST: f32 = 1e-11;
/// In place of a zero in a denominator.
const TINY: f32 = 1e-12;

//! Limits of axes with a FIR filter. Three things change the limits:
//!
//! - AX_DEV limits how far a filtered axis may deviate from its unfiltered set points, delayed by the same
//!   time.
//! - ACC_FACT (1…10) permits a larger step of speed at a corner without a curve, because the filter spreads
//!   the step over several ticks.
//! - A filter with negative taps can raise speed, acceleration and jerk, so the limits are lowered.
//!
//! A filtered axis deviates when it accelerates, and when its speed has a step at a corner without a curve.
//! The two causes share AX_DEV ([`crate::fir::Watch`]). The part for acceleration is the same everywhere. The
//! rest is for a step of speed, if no other step is within the length of the filter. If several steps are
//! closer, each of them gets a tenth of AX_DEV. Together they count like a curve with the same acceleration.
use super::{Axis, Dynamics, LSB_40, Permitted};
use crate::dynamics::axis::{Set, TransitionLimits};
use crate::fir::{CLOSE, GOING_ON, REACH, SHORT, Watch};
use crate::machine::{MachineData, functions};
use crate::math::float::{magnitude, max, min, to_f32};
use crate::math::root::sqrt_f32;
use crate::nc::SlopeType;
use crate::path::End;
use crate::slope::ramp_shape::RampShape;

/// Part of the permitted acceleration that may pass a corner if the profile's acceleration is zero there. A
/// feed hold may brake through the corner if the jerk of this part stays below the jerk limit.
const PASSING_JERK: f32 = 0.1;
/// Part of AX_DEV for a step of speed at a corner that acceleration passes. The value is relative to the part
/// for acceleration: 0.46/0.91.
const PASSING: f32 = 0.5;
/// Above this ratio, an acceleration is clearly higher. For a filter without negative taps, the ratio is
/// 0.97/0.91.
const WORTH: f32 = 1.07;
/// Factor of the speed with which the acceleration across the path gets the factor [`SHORT`]: its square
/// root, rounded down.
const SHORT_SPEED: f32 = 0.707;
/// Rounding of a filter in the third difference of a set point, in addition to the rounding of the path, mm:
/// 9 LSB of 2^-32.
const ROUNDED: f32 = 9.0 / (1u64 << 32) as f32;
/// Longest ramp that is considered, as a part of the window.
const WINDOW_PART: f32 = 0.5;

/// Data of transitions that AX_DEV restricts.
#[derive(Clone, Copy, Debug)]
pub(super) struct Watched {
    /// Restricted axes: bit i is axis i.
    axes: u32,
    /// Steps of speed within this number of ticks add up.
    window: f32,
    /// The lowest Σ|G| / |G(0)| of the axes, ticks.
    ratio: f32,
}

impl Watched {
    /// No restricted transitions.
    pub(super) const NONE: Self = Self { axes: 0, window: 0.0, ratio: f32::MAX };

    /// Whether AX_DEV restricts any axis.
    #[inline(always)]
    pub(super) const fn is_some(&self) -> bool {
        functions::FILTERS.is_built() && self.axes != 0
    }
}

impl Axis {
    /// Factor for accelerations and jerks by AX_DEV, if all jerk is limited and the factor leaves clearly
    /// more than [`Watch::accel`].
    fn smooth_share(&self, watch: &Watch, slope: SlopeType) -> Option<f32> {
        let peak = match slope {
            SlopeType::Trapez => 1.0,
            SlopeType::Sin2 => RampShape::SineSquare.peak_jerk(),
            SlopeType::Step | SlopeType::Hsc => return None,
        };
        let jerk = max(self.feed.jerk(peak)?, self.rapid.jerk(peak)?);
        // The filter's gain has already lowered them.
        let of = |[by_accel, by_jerk]: [f32; 2]| (by_accel * self.a_max + by_jerk * jerk) / watch.gain;
        let [one, other] = watch.bound?.map(of);
        let deviation = min(one, other);
        let share = if deviation > 1.0 { 1.0 / deviation } else { 1.0 };
        (share * self.a_max / watch.gain > WORTH * watch.accel?).then_some(share)
    }

    /// Limits of an axis that moves alone, with the filter of `other`. `alike`: both axes have the same
    /// slope.
    pub(super) fn filtered_as(mut self, other: &Self, alike: bool) -> Self {
        let part = 1.0 / other.gain;
        for set in [&mut self.feed, &mut self.rapid] {
            if other.is_filtered {
                set.leave_rounding();
            }
            if other.gain > 1.0 {
                set.scale(part);
            }
            match other.share {
                Some(share) if alike => set.slow_down(share),
                _ => set.cap(other.cap),
            }
        }
        self.v_reduced = if self.v_reduced == f32::MAX { f32::MAX } else { self.v_reduced * part };
        self
    }
}

impl Set {
    /// Lowers jerks so that rounding in the filter keeps the limits; a jerk of a few LSB is halved.
    fn leave_rounding(&mut self) {
        let TransitionLimits { budget, knee, bend, .. } = &mut self.joint;
        let jerks = [&mut self.ramp_budget, &mut self.geometric_budget, budget, knee, bend];
        for jerk in self.j.iter_mut().chain(jerks) {
            *jerk = max(*jerk - ROUNDED, 0.5 * *jerk);
        }
    }

    /// Multiplies every value that is proportional to the motion by `part`.
    fn scale(&mut self, part: f32) {
        for value in [&mut self.v, &mut self.a_up, &mut self.a_down, &mut self.change_over] {
            *value *= part;
        }
        for value in self.upper.iter_mut().chain(&mut self.j) {
            *value = if *value == f32::MAX { *value } else { *value * part };
        }
        let TransitionLimits { budget, knee, bend, left, gained, .. } = &mut self.joint;
        for value in [budget, knee, left, gained] {
            *value *= part;
        }
        if *bend != f32::MAX {
            *bend *= part;
        }
        for value in
            [&mut self.ramp_budget, &mut self.geometric_budget, &mut self.a_shared, &mut self.a_resting]
        {
            *value *= part;
        }
    }

    /// Multiplies all values except the speed by `part`. The effect is that of lower accelerations with the
    /// same ramp times.
    fn slow_down(&mut self, part: f32) {
        let fast = (self.v, self.change_over);
        self.scale(part);
        (self.v, self.change_over) = fast;
    }

    /// The largest jerk of the axis, mm/tick³: `peak` times the mean jerk of the slope. `None` without limit.
    fn jerk(&self, peak: f32) -> Option<f32> {
        if self.joint.is_weighted || self.joint.bend == f32::MAX {
            return None;
        }
        let (fast, slow) = (max(self.a_up, self.a_down), min(self.a_up, self.a_down));
        Some(max(peak * self.j.into_iter().fold(0.0, max), self.geometric_budget * fast / slow))
    }

    /// Lowers all accelerations to at most `accel`.
    fn cap(&mut self, accel: f32) {
        for value in [&mut self.a_up, &mut self.a_down, &mut self.a_shared, &mut self.a_resting] {
            *value = min(*value, accel);
        }
        for value in &mut self.upper {
            *value = min(*value, accel);
        }
    }
}

impl<const AXES: usize> Dynamics<AXES> {
    /// Removes the filters of all axes from the dynamics, until [`Self::watch`] is called again.
    pub fn unwatch(&mut self, machine: &MachineData<AXES>) {
        self.watched = Watched::NONE;
        self.change(machine);
    }

    /// Lowers the limits of an axis to those with its filter, for the elements that follow. Call
    /// [`Self::unwatch`] before the first filter. `corner(jerk)`: the part of AX_DEV for a step of speed
    /// whose acceleration falls to zero with this jerk.
    pub fn watch(&mut self, axis: usize, watch: &Watch, corner: impl Fn(f32) -> f32) {
        let slope = self.slope;
        let Some(limits) = self.axes.get_mut(axis) else { return };
        let part = 1.0 / watch.gain;
        let a_max = limits.a_max * part;
        limits.share = limits.smooth_share(watch, slope);
        limits.v_reduced = if limits.v_reduced == f32::MAX { f32::MAX } else { limits.v_reduced * part };
        limits.is_filtered = true;
        for set in [&mut limits.feed, &mut limits.rapid] {
            set.leave_rounding();
            if watch.gain > 1.0 {
                set.scale(part);
            }
            let fastest = set.j.into_iter().fold(0.0, max);
            let jerk = match slope {
                SlopeType::Trapez => fastest,
                SlopeType::Sin2 => fastest * RampShape::SineSquare.peak_jerk(),
                // Acceleration may begin at the transition, or pass it.
                SlopeType::Step | SlopeType::Hsc => f32::MAX,
            };
            if set.joint.is_weighted && watch.acc_fact > 1.0 {
                // The filter spreads a step over its window. The result stays inside a_max, together with the
                // acceleration of the profile.
                let beside = min(max(set.a_up, set.a_down), WINDOW_PART * watch.window * jerk);
                let spread = min(max(a_max - beside, 0.0) / watch.tap, REACH - a_max);
                set.joint.knee = max(set.joint.knee, min(set.joint.knee * watch.acc_fact, spread));
            }
            if let Some(share) = limits.share {
                set.slow_down(share);
            } else if let Some(accel) = watch.accel {
                set.cap(accel);
                let part = if jerk == f32::MAX { corner(1e20) } else { corner(jerk) };
                set.joint.knee = min(set.joint.knee, watch.knee * max(part, 0.0));
            }
        }
        limits.a_max = a_max;
        limits.gain = watch.gain;
        let Some(accel) = watch.accel else { return };
        limits.cap = accel;
        if let Some(share) = limits.share {
            limits.a_max = a_max * share;
        } else {
            limits.a_max = min(a_max, accel);
            self.watched.axes |= 1 << axis.min(31);
            self.watched.window = max(self.watched.window, watch.window);
            self.watched.ratio = min(self.watched.ratio, watch.ratio);
        }
    }

    /// Whether AX_DEV restricts an axis.
    #[inline(always)]
    pub const fn is_watched(&self) -> bool {
        self.watched.is_some()
    }

    /// Lower limits for a short element of `length` (mm), which the motion may pass within the window of the
    /// filters. Returns `None` if the element takes longer. `bends`: the element is no line.
    pub fn shorten(&self, limits: &Permitted, length: f32, bends: bool) -> Option<Permitted> {
        let is_short = length < limits.0.v * self.watched.window;
        let mut limits = if is_short { *limits } else { return None };
        limits.0.scale_accelerations(SHORT);
        if bends {
            // A lower speed also lowers the acceleration across the path.
            limits.0.v *= SHORT_SPEED;
        }
        Some(limits)
    }

    /// Largest acceleration along the path with this direction.
    fn along(&self, end: &End<AXES>) -> f32 {
        let axes = self.axes.iter().zip(&end.tangent).filter(|(_, tangent)| **tangent != 0);
        axes.fold(f32::MAX, |a, (axis, tangent)| min(a, axis.a_max / (magnitude(to_f32(*tangent)) * LSB_40)))
    }

    /// Highest speed at which the steps of speed at a transition stay inside their part of AX_DEV, if that is
    /// below `fastest`. `shorter` is the length of the shorter neighbour, mm.
    pub(super) fn watched(
        &self,
        (from, to): (&End<AXES>, &End<AXES>),
        rapid: bool,
        shorter: f32,
        fastest: f32,
    ) -> f32 {
        // In a curve, every axis may use all of its acceleration, for any direction at the end.
        let bends = |end: &End<AXES>| end.curvature.iter().any(|curvature| *curvature != 0.0);
        let bends = bends(from) || bends(to);
        let along = [self.along(from), self.along(to)];
        let mut v = f32::MAX;
        for (k, (axis, ends)) in self.axes.iter().zip(from.tangent.iter().zip(&to.tangent)).enumerate() {
            if ends.0 == ends.1 || self.watched.axes >> k.min(31) & 1 == 0 {
                continue;
            }
            let TransitionLimits { mut knee, budget, .. } = axis.set(rapid).joint;
            if let Some(before) = self.before.as_ref().and_then(|axes| axes.get(k)) {
                knee = min(knee, before[usize::from(rapid)].knee);
            }
            let step = magnitude(to_f32(ends.1.wrapping_sub(*ends.0))) * LSB_40;
            let [before, behind] = [(ends.0, along[0]), (ends.1, along[1])]
                .map(|(tangent, along)| magnitude(to_f32(*tangent)) * LSB_40 * along);
            let part = if bends { 1.0 } else { min(1.0, min(before, behind) / axis.a_max) };
            let most = 1.0 - (1.0 - GOING_ON) * part;
            let faster = max(along[0], along[1]);
            v = min(v, self.watched.speed((axis.a_max, budget), (step, knee, most), faster, shorter));
        }
        if v < fastest { v } else { f32::MAX }
    }
}

impl Watched {
    /// As [`Self::watched`], for one axis whose direction changes by `step`. `knee`: permitted step of speed.
    /// `most`: the part of this step that the accelerations on both sides leave. `along`: the largest
    /// acceleration of the path.
    fn speed(
        &self,
        (a_max, budget): (f32, f32),
        (step, knee, most): (f32, f32, f32),
        along: f32,
        shorter: f32,
    ) -> f32 {
        let passes = a_max * step <= PASSING_JERK * budget;
        let alone = if passes { min(knee, PASSING * a_max * self.ratio) } else { knee } * most / step;
        // Speed at which a block takes the whole window, if the motion speeds up from the end of the block.
        let long = (shorter - 0.5 * along * self.window * self.window) / self.window;
        if long >= alone {
            return alone;
        }
        // There is one step v·step per length/√(v² + 2·a·length) ticks at most, so v·√(v² + 2·a·length) ≤ s.
        let s = SHORT * a_max * shorter / step;
        let gained = along * shorter;
        let both = gained + sqrt_f32(gained * gained + s * s);
        let dense = if both > 0.0 { s / sqrt_f32(both) } else { 0.0 };
        min(alone, max(long, min(dense, CLOSE * knee / step)))
    }
}

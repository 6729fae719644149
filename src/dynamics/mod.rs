//! Turns the limits of the axes into limits along the path: speed, acceleration and jerk inside an element,
//! and the speed at a transition.
//!
//! All values are per tick, in `f32`. Every limit is lowered by a margin for rounding, so the set points keep
//! the limits of the axes exactly:
//!
//! | limit | margin | covers |
//! |---|---|---|
//! | speed, acceleration | 1 − 2^-19 | 32 roundings of 2^-24: ten in this module, sixteen in the plan, six in the check of the plan |
//! | jerk | 1 − 2^-13 | the same, and third differences of path distances rounded to 2^-44 mm |
//! | small accelerations | 4 · 2^-37 mm/tick² | rounding of path distances; an axis that moves farther than the path enlarges this rounding |
//!
//! **Jerk.** `B` is the jerk that an axis may have where its motion has a geometric cause too: on arcs and at
//! transitions. For each ramp of an axis, `a` / min(ramp time, geometric ramp time) is computed, with its
//! acceleration or deceleration `a`. `B` is the lowest of these values. The speed profile and the geometry
//! each get a part of `B`. If a curve has CHECK_JERK=1, its curvature may cause the jerk `a` / geometric ramp
//! time, which may be less than `B`.
//!
//! A ramp of SIN2 has a peak jerk of π/2 times its mean jerk. Where the geometry causes jerk too, the planner
//! counts this peak. On a straight line, the peak is π/2 · `a` / ramp time. So an axis with SIN2 has at most
//! the larger one of this peak and `B`.
//!
//! **STEP** has no jerk limit. At a knee (a corner without a curve), the speed of an axis has a step, which
//! acts like an acceleration for one tick. This acceleration adds to that of the speed profile. So every arc
//! leaves a quarter of `a_max` (P-AXIS-00008) for knees. A line does so if a knee is at one of its ends, or
//! if the line or its neighbour may take less than a tick. The step of speed at a knee is at most 1 tick
//! times the lowest acceleration of STEP, and at most 1 tick times a quarter of `a_max`.

mod arc;
mod axis;
mod filter;
mod override_range;
mod permitted;
mod polynomial;
mod stopping;
mod transition;
mod turns;
mod vector;
mod weights;

use crate::machine::MachineData;
use crate::machine::functions::STEP_BUILT;
use crate::math::float::{magnitude, max, min, size_f32};
use crate::nc::{Restriction, Slope, SlopeType, VectorLimit, Weight};
use crate::path::{Circle, Element};
use crate::slope::limits::{Joins, Limits, SlopeLaw};
use crate::slope::ramp_shape::RampShape;
use arc::Bend;
use axis::{Axis, TransitionLimits};
use filter::Watched;
pub use override_range::OverrideRange;
pub use permitted::Share;
pub use polynomial::{Curving, Near, Steady};
pub use stopping::{Braking, Passed};
pub use transition::Passing;
pub use turns::Turns;
use vector::PathLimits;
pub use vector::TooLow;
pub use weights::Weights;

/// Factor for speeds and accelerations, a margin for rounding.
pub(super) const MARGIN: f32 = 1.0 - 1.0 / 524_288.0;
/// Acceleration along the path that rounding can cause, mm/tick². A path distance is accurate to 2^-37 mm,
/// and this error counts four times in a second difference. [`MARGIN`] does not cover this error for small
/// accelerations.
const ROUGH: f32 = 4.0 / (1u64 << 37) as f32;
const ROUGH_BELOW: f32 = 1.0 / 65_536.0;
/// Factor for jerks.
const JERK_MARGIN: f32 = 1.0 - 1.0 / 8192.0;
/// Part of the largest acceleration (P-AXIS-00008) that may act perpendicular to the path.
const NORMAL_PART: f32 = 0.8;
/// Part of the largest acceleration that is reserved for a knee: a step of speed Δv shows as a second
/// difference of Δv/T. At the ends of a block, the acceleration of the speed profile is zero. Exceptions are
/// very short ramps, and acceleration that passes the knee (HSC).
const KNEE_PART: f32 = 0.25;
/// A transition below this part of its limit counts as smooth.
const SLIGHT: f32 = 1.0 / 64.0;
/// A step of speed below this part of the jerk budget is rounding of coordinates. The margin of the jerk
/// covers this step, so the speed profile may use all of the budget.
const SMOOTH: f32 = 1.0 / 20_000.0;

const LSB_40: f32 = 1.0 / (1u64 << 40) as f32;

/// Jerk that counts as no limit, mm/tick³.
const NO_LIMIT: f32 = 1e20;

/// The dynamics of a machine's axes: their limits per tick. The machine data are converted once, and again
/// when the program weights them or changes the slope. The machine data are not kept: a caller that changes
/// the dynamics passes the data of [`Self::new`] again.
pub struct Dynamics<const AXES: usize> {
    axes: [Axis; AXES],
    /// Feed and rapid limits at the end of the block before new weights, until the next block follows.
    before: Option<[[TransitionLimits; 2]; AXES]>,
    weights: Weights<AXES>,
    path: PathLimits,
    /// 1 mm/min in mm/tick.
    feed_unit: f32,
    slope: SlopeType,
    joins: Joins,
    /// The planned override for the elements, 1…2.
    level: f32,
    /// Number of changes of the dynamics; limits that were kept become invalid.
    changes: u32,
    /// Whether an axis has a reduced speed.
    reduces: bool,
    /// Whether a step of curvature has a jerk limit: P-CHAN-00009.
    bends_have_jerk: bool,
    /// Filters with AX_DEV.
    watched: Watched,
    /// Whether the axes of smoothed elements differ from those of the machine: a transformation follows.
    #[cfg(feature = "kinematics")]
    is_transformed: bool,
}

/// Limits of an element. Three parts: the limits along the path, what the element's transitions leave to the
/// speed profile, and how an override changes the speed.
pub type Permitted = (Limits, Share, OverrideRange);

/// Limits of an element, and a stamp of the dynamics for which they were computed. The planner uses the
/// limits again as long as the dynamics do not change.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Known {
    /// [`Dynamics::changes`] when the limits were computed.
    changes: u32,
    /// The limits, as [`Dynamics::element`] returns them.
    pub permitted: Permitted,
}

/// Whether HSC has NO_OPT=0 by default: FCT_LOOK_AHEAD_OPT.
#[cfg(feature = "plc")]
const fn optimises<const AXES: usize>(machine: &MachineData<AXES>) -> bool {
    machine.channel.interpolator.has(crate::machine::InterpolatorFunctions::LOOK_AHEAD_OPT)
}

/// Whether HSC has NO_OPT=0 by default.
#[cfg(not(feature = "plc"))]
const fn optimises<const AXES: usize>(_: &MachineData<AXES>) -> bool {
    false
}

impl<const AXES: usize> Dynamics<AXES> {
    /// Converts the machine data of all axes to limits per tick.
    pub fn new(machine: &MachineData<AXES>) -> Self {
        let cycle_s = machine.channel.cycle_us as f32 * 1e-6;
        let slope = SlopeType::of_profile(machine.channel.slope_profile);
        let mut new = Self {
            axes: [Axis::BLANK; AXES],
            before: None,
            weights: Weights::new(),
            path: PathLimits::new(&machine.channel),
            feed_unit: cycle_s / 60.0,
            slope,
            joins: Joins::of(slope, optimises(machine)),
            level: 1.0,
            changes: 0,
            bends_have_jerk: machine.channel.corr_v_trans_jerk,
            reduces: machine.axes.iter().any(|axis| axis.vb_max_red > 0),
            watched: Watched::NONE,
            #[cfg(feature = "kinematics")]
            is_transformed: false,
        };
        // One axis after the other, because all of them are large.
        for (axis, data) in new.axes.iter_mut().zip(&machine.axes) {
            *axis = Axis::new(data, &machine.channel, slope);
        }
        new
    }

    /// Sets whether a transformation for rotary axes lies between the smoothing stage and the axes.
    #[cfg(feature = "kinematics")]
    pub fn set_transformed(&mut self, is_transformed: bool) {
        self.is_transformed = is_transformed;
        self.count();
    }

    /// Whether a transformation for rotary axes lies between the smoothing stage and the axes. The smoothing
    /// stage then does not know the limits of the axes.
    #[cfg(feature = "kinematics")]
    pub const fn is_transformed(&self) -> bool {
        self.is_transformed
    }

    /// Whether a transformation for rotary axes lies between the smoothing stage and the axes; always `false`
    /// in a build without transformations.
    #[cfg(not(feature = "kinematics"))]
    #[inline(always)]
    pub const fn is_transformed(&self) -> bool {
        false
    }

    /// Sets the weights of the axes for the elements that follow. The first transition to these elements
    /// keeps the limits of both sides.
    pub fn weigh(&mut self, machine: &MachineData<AXES>, weight: &Weight<AXES>) {
        self.weights.set(weight);
        self.change(machine);
    }

    /// Sets the slope of the elements that follow, with the option NO_OPT of HSC. `#SLOPE DEFAULT` selects
    /// the slope of P-CHAN-00071.
    pub fn set_slope(&mut self, machine: &MachineData<AXES>, command: &Slope) {
        let slope;
        (slope, self.joins) = self.slope_of(machine, command);
        self.count();
        if slope != self.slope {
            self.slope = slope;
            self.change(machine);
        }
    }

    /// The slope after a command, and which blocks it joins.
    fn slope_of(&self, machine: &MachineData<AXES>, command: &Slope) -> (SlopeType, Joins) {
        let &Slope { default, kind, no_opt } = command;
        let given = SlopeType::of_profile(machine.channel.slope_profile);
        let slope = if default { given } else { kind.unwrap_or(self.slope) };
        let asked = !default && no_opt == Some(false);
        let optimised = asked || ((default || no_opt.is_none()) && optimises(machine));
        (slope, Joins::of(slope, optimised))
    }

    /// Returns to program start: no weights, no limits along the path, the slope of P-CHAN-00071.
    pub fn restart(&mut self, machine: &MachineData<AXES>) {
        self.weights = Weights::new();
        self.path = PathLimits::new(&machine.channel);
        self.slope = SlopeType::of_profile(machine.channel.slope_profile);
        self.joins = Joins::of(self.slope, optimises(machine));
        self.change(machine);
    }

    /// Invalidates limits that were kept.
    fn count(&mut self) {
        self.changes = self.changes.wrapping_add(1);
    }

    /// Converts the axes again, for the elements that follow.
    fn change(&mut self, machine: &MachineData<AXES>) {
        self.count();
        if self.before.is_none() {
            self.before = Some(self.axes.map(|axis| [axis.feed.joint, axis.rapid.joint]));
        }
        let channel = &machine.channel;
        for (k, (axis, data)) in self.axes.iter_mut().zip(&machine.axes).enumerate() {
            *axis = Axis::new(&self.weights.apply(k, data, channel), channel, self.slope);
        }
    }

    /// Sets limits along the path (`#VECTOR LIMIT`) in the elements that follow.
    ///
    /// # Errors
    /// An acceleration is too low or a speed is 0.
    pub fn limit(&mut self, command: &VectorLimit) -> Result<(), TooLow> {
        self.count();
        self.path.set(command)
    }

    /// Whether a command of the program changes the dynamics.
    #[cold]
    #[inline(never)]
    pub(crate) fn differ(&self, machine: &MachineData<AXES>, command: &Restriction<AXES>) -> bool {
        match command {
            Restriction::Slope(slope) => self.slope_of(machine, slope) != (self.slope, self.joins),
            Restriction::Weight(weight) => self.weights.differ(weight),
            Restriction::VectorLimit(limit) => self.path.differ(limit),
        }
    }

    /// Ends the change of weights: an element with the current weights has entered the look-ahead. From now
    /// on, transitions have the current limits on both sides.
    pub fn settle(&mut self) {
        self.before = None;
    }

    /// Limits of an axis that moves alone, and its reduced speed (P-AXIS-00214). Weights and path limits of
    /// the program do not act, but a filter of the axis acts. The slope is `slope`, or that of P-CHAN-00071
    /// without one. The acceleration is `percent` of the machine data and at most P-AXIS-00008. Ramp times do
    /// not change.
    pub fn single(
        &self,
        machine: &MachineData<AXES>,
        axis: usize,
        rapid: bool,
        slope: Option<SlopeType>,
        percent: u32,
    ) -> Option<(Limits, f32)> {
        let channel = &machine.channel;
        let slope = slope.unwrap_or(SlopeType::of_profile(channel.slope_profile));
        let mut data = *machine.axes.get(axis)?;
        data.weigh(percent);
        let axis = Axis::new(&data, channel, slope).filtered_as(self.axes.get(axis)?, slope == self.slope);
        let set = axis.set(rapid);
        let mut limits = Limits { law: law_of(slope, Joins::Alike, set.change_over), ..Limits::WIDEST };
        let mut share = Share::WHOLE;
        limits.restrict(&mut share, set, 1.0, false);
        Some((limits, axis.v_reduced))
    }

    /// The slope's limits before any axis restricts them.
    fn law(&self, change_over: f32) -> SlopeLaw {
        law_of(self.slope, self.joins, change_over)
    }

    /// Sets the override for which the elements that follow are planned; 1 is 100 %, range 1 to 2.
    pub fn set_level(&mut self, level: f32) {
        if level != self.level {
            self.level = level;
            self.count();
        }
    }

    /// Converts a feed (mm/min) to a path speed (mm/tick). Without a feed, the result does not limit the
    /// speed.
    pub fn programmed(&self, feed: Option<f32>) -> f32 {
        feed.map_or(f32::MAX, |feed| feed * self.feed_unit * MARGIN)
    }

    /// Limits of an element that is run with `feed` (mm/min), or as rapid motion if there is no feed.
    pub fn element(&self, element: &Element<AXES>, feed: Option<f32>) -> Permitted {
        match &element.circle {
            None => self.line(&element.entry.tangent, feed),
            circle => self.arc(&element.entry.tangent, circle, feed),
        }
    }

    /// Limits of an arc.
    #[inline(never)]
    fn arc(&self, tangent: &[i64; AXES], circle: &Option<Circle>, feed: Option<f32>) -> Permitted {
        self.permitted(tangent, circle, feed)
    }

    /// As [`Self::element`]. A caller keeps the result as long as the element does not change.
    pub(crate) fn known(&self, element: &Element<AXES>, feed: Option<f32>) -> Known {
        Known { changes: self.changes, permitted: self.element(element, feed) }
    }

    /// Returns limits that were kept, or `None` if the dynamics or the planned override have changed.
    pub(crate) fn recall<'a>(&self, known: &'a Known) -> Option<&'a Permitted> {
        (known.changes == self.changes).then_some(&known.permitted)
    }

    /// The speed limit of [`Self::line`] alone.
    pub(crate) fn speed_of_line(&self, tangent: &[i64; AXES], feed: Option<f32>) -> f32 {
        let rapid = feed.is_none();
        let mut v = self.path.speed(rapid);
        for (axis, tangent) in self.axes.iter().zip(tangent) {
            let share = size_f32(tangent.unsigned_abs()) * LSB_40;
            if share > 0.0 {
                v = min(axis.set(rapid).v * (1.0 / share), v);
            }
        }
        let mut limits = Limits { v, ..Limits::WIDEST };
        limits.take_feed(self.programmed(feed), f32::MAX, self.level);
        limits.v
    }

    /// Limits of a straight line with this direction (LSB 2^-40), run with `feed` (mm/min), or as rapid
    /// motion without one.
    #[inline(never)]
    pub(crate) fn line(&self, tangent: &[i64; AXES], feed: Option<f32>) -> Permitted {
        self.permitted(tangent, &None, feed)
    }

    #[cfg_attr(feature = "fast", inline(always))]
    fn permitted(&self, tangent: &[i64; AXES], circle: &Option<Circle>, feed: Option<f32>) -> Permitted {
        let rapid = feed.is_none();
        let mut limits = Limits { v: self.path.speed(rapid), ..Limits::WIDEST };
        let mut share_left = Share::WHOLE;
        let mut v_reduced = f32::MAX;
        let turns = |k: usize| circle.filter(|circle| circle.plane.contains(&k));
        let shares = || {
            let shares = self.axes.iter().zip(tangent).enumerate().map(|(k, (axis, tangent))| {
                let along = || size_f32(tangent.unsigned_abs()) * LSB_40;
                (k, axis.set(rapid), turns(k).map_or_else(along, |circle| circle.share))
            });
            shares.filter(|(_, _, share)| *share > 0.0)
        };
        let mut change_over = f32::MAX;
        if self.slope == SlopeType::Step {
            for (_, set, share) in shares() {
                change_over = min(change_over, set.change_over / share);
            }
        }
        limits.law = self.law(change_over);
        for (k, set, share) in shares() {
            let scale = 1.0 / share;
            limits.restrict(&mut share_left, set, scale, turns(k).is_some());
        }
        if self.reduces {
            for (k, _, share) in shares() {
                v_reduced = min(v_reduced, self.axes.get(k).map_or(f32::MAX, |axis| axis.v_reduced) / share);
            }
        }
        let feed = self.programmed(feed);
        if let Some(circle) = circle {
            let curvature = circle.share * circle.share / circle.radius;
            let stepped = self.slope == SlopeType::Step;
            let mut bend = Bend {
                curvature,
                share: circle.share,
                turn: circle.turn,
                normal: f32::MAX,
                a_max: f32::MAX,
                budget: if stepped { None } else { Some(f32::MAX) },
                is_free: !stepped && !self.bends_have_jerk,
            };
            for axis in circle.plane.into_iter().filter_map(|k| self.axes.get(k)) {
                let set = axis.set(rapid);
                bend.normal = min(bend.normal, set.least());
                bend.a_max =
                    min(bend.a_max, if stepped { (1.0 - KNEE_PART) * axis.a_max } else { axis.a_max });
                bend.budget = bend.budget.map(|budget| min(budget, set.joint.budget));
            }
            limits.v = min(limits.v, feed * self.level);
            limits.bend(&mut share_left, &bend);
        }
        self.path.lower(&mut limits, rapid, circle.is_some());
        limits.leave_rough(&mut share_left);
        let override_range = limits.take_feed(feed, v_reduced, self.level);
        (limits, share_left, override_range)
    }

    /// With STEP, a curve may use this part of an axis's largest acceleration (P-AXIS-00008) perpendicular to
    /// the path. The rest is for corners without a curve and for acceleration along the path.
    pub const STEPPED_NORMAL_PART: f32 = NORMAL_PART * (1.0 - KNEE_PART);

    /// Acceleration and jerk (per tick) with which all axes together may move in proportion to `parts`. The
    /// result is within the limits of the slope. `of`: the highest permitted share of each axis' largest
    /// acceleration, and that of its jerk `B`.
    pub fn together(&self, parts: &[f32; AXES], rapid: bool, of: [f32; 2]) -> [f32; 2] {
        let [mut a, mut j] = [f32::MAX; 2];
        for (axis, part) in self.axes.iter().zip(parts) {
            let (set, part) = (axis.set(rapid), magnitude(*part));
            if part > 0.0 {
                a = min(a, min(set.least(), of[0] * axis.a_max) / part);
                j = min(j, min(set.ramp_budget, of[1] * set.joint.budget) / part);
            }
        }
        [a, j]
    }

    /// The longest ramp time, in ticks, of the axes that move in proportion to `parts`.
    pub fn longest_ramp(&self, parts: &[f32; AXES], rapid: bool) -> f32 {
        let axes = self.axes.iter().zip(parts).filter(|(_, part)| **part != 0.0);
        axes.fold(0.0, |longest, (axis, _)| {
            let set = axis.set(rapid);
            let [up, up_end, down, down_end] = set.j;
            max(longest, JERK_MARGIN * max(set.a_up / min(up, up_end), set.a_down / min(down, down_end)))
        })
    }

    /// The jerk (mm/tick³) that the curve of a corner may cause if the axes move in proportion to `parts`.
    /// `check` is CHECK_JERK.
    pub fn across(&self, parts: &[f32; AXES], rapid: bool, check: u8) -> f32 {
        let axes = self.axes.iter().zip(parts).filter(|(_, part)| **part != 0.0);
        axes.fold(f32::MAX, |j, (axis, part)| {
            min(j, axis.set(rapid).curving_budget(check) / magnitude(*part))
        })
    }

    /// Whether the jerk of a step of curvature is limited: P-CHAN-00009 is set, and the slope is not STEP.
    pub fn limits_bends(&self) -> bool {
        self.bends_have_jerk && !self.slope.is_step()
    }

    /// The slope (kind of speed profile) of the elements that follow.
    pub fn slope(&self) -> SlopeType {
        self.slope
    }
}

/// The limits of a slope before any axis restricts them.
fn law_of(slope: SlopeType, joins: Joins, change_over: f32) -> SlopeLaw {
    match (slope, STEP_BUILT) {
        (SlopeType::Step, Some(built)) => {
            let (a_up, a_down, still) = (f32::MAX, f32::MAX, f32::MAX);
            SlopeLaw::Stepped { change_over, a_up, a_down, still, across: false, built }
        }
        (SlopeType::Sin2, _) => {
            let shape = RampShape::SineSquare.built();
            SlopeLaw::JerkLimited { shape, joins: Joins::Alike, j: [f32::MAX; 4] }
        }
        _ => SlopeLaw::JerkLimited { shape: RampShape::Linear, joins, j: [f32::MAX; 4] },
    }
}

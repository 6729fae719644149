//! Permitted path speed, acceleration and jerk of one element and of one transition, from those of the axes.
//!
//! Everything here is per tick and in `f32`; three margins make up for its rounding and for that of the integers
//! behind it, so that the limits of the axes hold exactly:
//!
//! | of | factor | covers |
//! |---|---|---|
//! | speed, acceleration | 1 − 2^-19 | ten roundings of 2^-24; as much as sixteen for the plan, and six for its check |
//! | jerk | 1 − 2^-13 | the same, and third differences of path distances rounded to 2^-44 mm |
//!
//! The jerk an axis may show is `B = a / min(ramp time, geometric ramp time)`. Slope and contour share it: where a
//! contour effect acts (an arc, a transition that is not smooth), slope and contour get parts that add up to at most
//! `B`.
use super::vector::{PathLimits, TooLow};
use super::weights::Weights;
use crate::machine::{AxisData, ChannelData, MachineData};
use crate::math::float::{size_f32, to_f32};
use crate::math::root::{cbrt_f32, sqrt_f32};
use crate::nc::{SlopeType, VectorLimit, Weight};
use crate::path::{Element, End};
use crate::slope::ramp::Ramp;
use crate::tick::SKIP_PER_TICK;

/// Factor on speeds and accelerations.
pub(super) const MARGIN: f32 = 1.0 - 1.0 / 524_288.0;
/// Factor on jerks.
const JERK_MARGIN: f32 = 1.0 - 1.0 / 8192.0;
/// Part of `B` for a transition; as much is left to the slope, and a fifth to transitions closer than three ticks.
const TRANSITION_PART: f32 = 0.4;
/// Parts of `B` inside an arc: slope, and v³κ²; the rest goes to 3vκ·a.
const ARC_SLOPE_PART: f32 = 0.25;
const ARC_PART: f32 = 0.5;
/// Speeds tried for an arc, and the step from one to the next.
const ARC_SPEEDS: usize = 5;
const ARC_SPEED_STEP: f32 = 0.8;
/// Part of the largest acceleration that may act across the path.
const NORMAL_PART: f32 = 0.8;
/// Part of the largest acceleration for a knee: Δv shows as a second difference of Δv/T. Slopes vanish at the ends
/// of a block, which leaves the knee its part, unless their ramps are as short as the difference looks, or
/// acceleration passes the knee (HSC).
const KNEE_PART: f32 = 0.25;
/// Ramps of that many ticks are not.
const LONG_RAMP: f32 = 4.0;
/// Element lengths per tick, so that a tick never has to pass more elements than it may.
const SKIP: f32 = (SKIP_PER_TICK - 1) as f32;

const LSB_40: f32 = 1.0 / (1u64 << 40) as f32;
const LSB_44: f32 = 1.0 / (1u64 << 44) as f32;

/// The four ramps of a slope: acceleration rises, falls, deceleration rises, falls.
pub type Ramps = [f32; 4];

/// Permitted values along the path: mm/tick, mm/tick², mm/tick³.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Speed.
    pub v: f32,
    /// Acceleration.
    pub a_up: f32,
    /// Deceleration.
    pub a_down: f32,
    /// Jerk of each ramp.
    pub j: Ramps,
    /// Jerk left to the slope beside a transition.
    pub j_shared: f32,
    /// Acceleration left to it.
    pub a_shared: f32,
}

/// Dynamics of one axis in one kind of motion (feed or rapid), per tick.
#[derive(Clone, Copy, Debug)]
struct Set {
    v: f32,
    a_up: f32,
    a_down: f32,
    j: Ramps,
    joint: Joint,
    /// Acceleration left to the slope beside a knee.
    a_shared: f32,
}

/// What an axis permits at a transition.
#[derive(Clone, Copy, Debug)]
struct Joint {
    /// `B`.
    budget: f32,
    /// Speed step permitted at a knee (P-AXIS-00013).
    knee: f32,
    /// Acceleration step permitted at a tangential transition (P-AXIS-00154), where P-CHAN-00009 asks for it.
    bend: f32,
}

#[derive(Clone, Copy, Debug)]
struct Axis {
    feed: Set,
    rapid: Set,
    a_max: f32,
}

/// The dynamics of a machine's axes, converted to ticks once, and again when the program weights them.
pub struct Dynamics<const AXES: usize> {
    axes: [Axis; AXES],
    /// Feed and rapid joints of the axes as they were at the block before, while no block has followed the weights.
    before: Option<[[Joint; 2]; AXES]>,
    machine: MachineData<AXES>,
    weights: Weights<AXES>,
    path: PathLimits,
    /// mm/tick of 1 mm/min.
    feed_unit: f32,
    slope: SlopeType,
}

impl<const AXES: usize> Dynamics<AXES> {
    /// Converts the machine data.
    pub fn new(machine: &MachineData<AXES>) -> Self {
        let cycle_s = machine.channel.cycle_us as f32 * 1e-6;
        let slope = SlopeType::of_profile(machine.channel.slope_profile);
        Self {
            axes: machine.axes.map(|axis| Axis::new(&axis, &machine.channel, slope)),
            before: None,
            machine: *machine,
            weights: Weights::new(),
            path: PathLimits::new(&machine.channel),
            feed_unit: cycle_s / 60.0,
            slope,
        }
    }

    /// Weights the axes in the elements that follow. The transition to the first of them belongs to both sides.
    pub fn weigh(&mut self, weight: &Weight<AXES>) {
        self.weights.set(weight);
        self.change();
    }

    /// Elements that follow run with that slope; by default (#SLOPE DEFAULT) with that of P-CHAN-00071.
    pub fn set_slope(&mut self, slope: Option<SlopeType>) {
        let slope = slope.unwrap_or(SlopeType::of_profile(self.machine.channel.slope_profile));
        if slope != self.slope {
            self.slope = slope;
            self.change();
        }
    }

    /// The axes anew, for the elements that follow.
    fn change(&mut self) {
        if self.before.is_none() {
            self.before = Some(self.axes.map(|axis| [axis.feed.joint, axis.rapid.joint]));
        }
        let channel = &self.machine.channel;
        for (k, (axis, data)) in self.axes.iter_mut().zip(&self.machine.axes).enumerate() {
            *axis = Axis::new(&self.weights.apply(k, data, channel), channel, self.slope);
        }
    }

    /// Sets limits along the path in the elements that follow.
    ///
    /// # Errors
    /// An acceleration is too low.
    pub fn limit(&mut self, command: &VectorLimit) -> Result<(), TooLow> {
        self.path.set(command)
    }

    /// An element with the weights of now has been taken in.
    pub fn settle(&mut self) {
        self.before = None;
    }

    /// Limits of an element run with `feed` (mm/min), or as rapid motion without one.
    pub fn element(&self, element: &Element<AXES>, feed: Option<f32>) -> Limits {
        let sets = |axis: &Axis| if feed.is_some() { axis.feed } else { axis.rapid };
        let length = to_f32(element.shape.length.to_bits()) * LSB_44;
        let mut limits = Limits { v: min(SKIP * length, self.path.speed(feed.is_none())), ..Limits::WIDEST };
        if let Some(feed) = feed {
            limits.v = min(limits.v, feed * self.feed_unit * MARGIN);
        }
        for (k, (axis, tangent)) in self.axes.iter().zip(&element.entry.tangent).enumerate() {
            let share = match element.circle {
                Some(circle) if circle.plane.contains(&k) => circle.share,
                _ => size_f32(tangent.unsigned_abs()) * LSB_40,
            };
            if share > 0.0 {
                limits.restrict(&sets(axis), 1.0 / share);
            }
        }
        if let Some(circle) = element.circle {
            let curvature = circle.share * circle.share / circle.radius;
            let mut normal = f32::MAX;
            let mut a_max = f32::MAX;
            let mut budget = f32::MAX;
            for axis in circle.plane.into_iter().filter_map(|k| self.axes.get(k)) {
                let set = sets(axis);
                normal = min(normal, min(set.a_up, set.a_down));
                a_max = min(a_max, axis.a_max);
                budget = min(budget, set.joint.budget);
            }
            let normal = min(normal, NORMAL_PART * a_max);
            limits.bend(curvature, length, normal, a_max, budget, circle.share);
        }
        self.path.lower(&mut limits, feed.is_none(), element.circle.is_some());
        limits
    }

    /// Highest speed of a transition: per axis, the step of its speed and the step of its acceleration stay inside
    /// what a knee permits (P-AXIS-00013) and inside the transition's part of the jerk budget. `None` if the
    /// transition is smooth at the speed `fastest` of its neighbours. `shorter` is the length of the shorter one, mm.
    ///
    /// With P-CHAN-00009 the step of acceleration at a tangential transition is at most the part of the axis'
    /// acceleration that P-AXIS-00154 gives. Without it, and where it gives more, the jerk budget alone decides: unlike
    /// ISG's kernel, which then takes no notice of the jerk, limits of jerk hold here in any case.
    ///
    /// A speed step Δv shows as a third difference of at most Δv/T², an acceleration step Δa as Δa/T. Steps that
    /// follow each other within three ticks add up: at a distance of h ticks at most 2 + 2/h of them.
    pub fn transition(
        &self,
        from: &End<AXES>,
        to: &End<AXES>,
        rapid: bool,
        shorter: f32,
        fastest: f32,
    ) -> Option<f32> {
        let mut v = f32::MAX;
        let mut tangential = true;
        let mut square = f32::MAX;
        for (k, axis) in self.axes.iter().enumerate() {
            let mut joint = if rapid { axis.rapid.joint } else { axis.feed.joint };
            if let Some([feed_before, rapid_before]) = self.before.as_ref().and_then(|axes| axes.get(k)) {
                joint.restrict(if rapid { rapid_before } else { feed_before });
            }
            let (Some(t0), Some(t1)) = (from.tangent.get(k), to.tangent.get(k)) else { continue };
            let (Some(c0), Some(c1)) = (from.curvature.get(k), to.curvature.get(k)) else { continue };
            let knee = size_f32(t1.wrapping_sub(*t0).unsigned_abs()) * LSB_40;
            let bend = magnitude(c1 - c0);
            let unseen = SMOOTH * joint.budget;
            let knee = if fastest * knee <= unseen { 0.0 } else { knee };
            let bend = if fastest * fastest * bend <= unseen { 0.0 } else { bend };
            let part = TRANSITION_PART * joint.budget;
            if knee > 0.0 {
                tangential = false;
                let part = if bend > 0.0 { 0.5 * part } else { part };
                let alone = min(part, joint.knee) / knee;
                if 3.0 * alone > shorter {
                    let close = min(0.25 * part / knee, sqrt_f32(0.25 * part * shorter / knee));
                    v = min(v, min(alone, max(shorter * (1.0 / 3.0), close)));
                } else {
                    v = min(v, alone);
                }
            }
            if bend > 0.0 {
                let part = if knee > 0.0 { 0.5 * part } else { part };
                v = min(v, sqrt_f32(part / bend));
                square = min(square, joint.bend / bend);
            }
        }
        if tangential && square < f32::MAX {
            v = min(v, sqrt_f32(square));
        }
        if v == f32::MAX { None } else { Some(v * MARGIN) }
    }

    /// Whether acceleration may pass transitions (HSC).
    pub fn is_across(&self) -> bool {
        self.slope == SlopeType::Hsc
    }

    /// Whether the acceleration `a` along the path may turn from the one direction to the other: the step of every
    /// axis' acceleration stays inside its part of the jerk budget.
    pub fn turns_little(&self, from: &End<AXES>, to: &End<AXES>, rapid: bool, a: f32) -> bool {
        self.axes.iter().zip(from.tangent.iter().zip(&to.tangent)).all(|(axis, (t0, t1))| {
            let set = if rapid { &axis.rapid } else { &axis.feed };
            a * size_f32(t1.wrapping_sub(*t0).unsigned_abs()) * LSB_40 <= TURN_PART * set.joint.budget
        })
    }
}

/// Part of `B` for an acceleration that turns with the path at a transition.
const TURN_PART: f32 = 0.05;

/// A step below this part of the jerk budget is rounding of coordinates: the margin of the jerk covers it, and
/// all of the budget is left to the slope.
const SMOOTH: f32 = 1.0 / 20_000.0;

impl Joint {
    fn restrict(&mut self, other: &Self) {
        self.budget = min(self.budget, other.budget);
        self.knee = min(self.knee, other.knee);
        self.bend = min(self.bend, other.bend);
    }
}

impl Axis {
    fn new(data: &AxisData, channel: &ChannelData, slope: SlopeType) -> Self {
        let cycle_s = channel.cycle_us as f32 * 1e-6;
        let speed = |um_s: u32| um_s as f32 * 1e-3 * cycle_s * MARGIN;
        let accel = |a: u32| a as f32 * cycle_s * cycle_s * MARGIN;
        let ticks = |us: u32| max(us as f32 * 1e-6, 1e-9) / cycle_s;
        let geometric = ticks(data.tr_geom);
        let a_max = accel(data.a_max);
        let set = |v: u32, a: [u32; 2], tr: [u32; 4]| {
            let [a_up, a_down] = a.map(accel);
            // HSC has one ramp time: the longest.
            let tr = if slope == SlopeType::Hsc { [tr.into_iter().max().unwrap_or(0); 4] } else { tr };
            let tr = tr.map(ticks);
            let over = |tr: f32, k: usize| (if k < 2 { a_up } else { a_down }) / tr;
            let mut j = [0.0; 4];
            let mut budget = f32::MAX;
            let [mut shortest, mut longest] = [f32::MAX, 0.0];
            for (k, (j, tr)) in j.iter_mut().zip(tr).enumerate() {
                *j = over(tr, k) * JERK_MARGIN;
                budget = min(budget, over(min(tr, geometric), k) * JERK_MARGIN);
                longest = max(longest, tr);
                shortest = min(shortest, tr);
            }
            let a = min(a_up, a_down);
            // Of `a`, in 0.1 %; 0: cycle time / ramp time.
            let part = |weight: u32| a * if weight == 0 { 1.0 / longest } else { weight as f32 * 1e-3 };
            let knee = min(part(data.a_trans_weight), KNEE_PART * a_max);
            let bend = if channel.corr_v_trans_jerk { part(data.r_trans_weight) } else { f32::MAX };
            let short = shortest < LONG_RAMP || slope == SlopeType::Hsc;
            let a_shared = if short { (1.0 - KNEE_PART) * a_max } else { f32::MAX };
            Set { v: speed(v), a_up, a_down, j, joint: Joint { budget, knee, bend }, a_shared }
        };
        let tr = [data.tr_beschl_zu, data.tr_beschl_ab, data.tr_brems_zu, data.tr_brems_ab];
        Self {
            feed: set(data.vb_max, [data.a_beschl, data.a_brems], tr),
            rapid: set(data.vb_eilgang, [data.a_grenz; 2], [data.tr_grenz; 4]),
            a_max,
        }
    }
}

impl Limits {
    /// No limit.
    pub const WIDEST: Self = Self {
        v: f32::MAX,
        a_up: f32::MAX,
        a_down: f32::MAX,
        j: [f32::MAX; 4],
        j_shared: f32::MAX,
        a_shared: f32::MAX,
    };

    /// Becomes what both permit; of the speeds the higher one.
    pub(super) fn join(&mut self, other: &Self) {
        self.v = max(self.v, other.v);
        self.a_up = min(self.a_up, other.a_up);
        self.a_down = min(self.a_down, other.a_down);
        for (j, other) in self.j.iter_mut().zip(other.j) {
            *j = min(*j, other);
        }
    }

    /// Largest acceleration or deceleration of both.
    pub(super) fn fastest(&self, other: &Self) -> f32 {
        max(max(self.a_up, self.a_down), max(other.a_up, other.a_down))
    }

    /// The slope that gains speed.
    pub fn speed_up(&self) -> Ramp {
        Ramp::new(self.a_up, self.j[0], self.j[1])
    }

    /// The slope that loses speed, seen backward from the lower one.
    pub fn brake(&self) -> Ramp {
        Ramp::new(self.a_down, self.j[3], self.j[2])
    }

    /// Leaves a transition its part.
    pub(super) fn share(&mut self) {
        for j in &mut self.j {
            *j = min(*j, self.j_shared);
        }
        self.a_up = min(self.a_up, self.a_shared);
        self.a_down = min(self.a_down, self.a_shared);
    }

    /// Takes in an axis that moves `1 / scale` times as far as the path.
    fn restrict(&mut self, set: &Set, scale: f32) {
        self.v = min(self.v, set.v * scale);
        self.a_up = min(self.a_up, set.a_up * scale);
        self.a_down = min(self.a_down, set.a_down * scale);
        for (j, axis) in self.j.iter_mut().zip(set.j) {
            *j = min(*j, axis * scale);
        }
        self.j_shared = min(self.j_shared, TRANSITION_PART * set.joint.budget * scale);
        self.a_shared = min(self.a_shared, set.a_shared * scale);
    }

    /// Takes in a curvature κ: v²κ across the path, with the tangential acceleration inside `a_max`; jerks
    /// v³κ² + 3vκ·a + j inside `budget` (their exact sum is a vector no longer than that).
    ///
    /// The faster the arc, the less acceleration is left to reach that speed: of five speeds, each four fifths of the
    /// one before, the one is taken with which the arc alone, from rest to rest with that acceleration, is fastest.
    fn bend(&mut self, curvature: f32, length: f32, normal: f32, a_max: f32, budget: f32, share: f32) {
        self.v = min(self.v, sqrt_f32(normal / curvature));
        self.v = min(self.v, cbrt_f32(ARC_PART * budget / (curvature * curvature)));
        for j in &mut self.j {
            *j = min(*j, ARC_SLOPE_PART * budget / share);
        }
        let mut best = (f32::MAX, 0.0, 0.0);
        let mut v = self.v;
        for _ in 0..ARC_SPEEDS {
            let across = v * v * curvature;
            let along = sqrt_f32(max(a_max * a_max - across * across, 0.0)) / share;
            let jerk = (1.0 - ARC_SLOPE_PART) * budget - across * v * curvature;
            let a = min(min(self.a_up, self.a_down), min(along, jerk / (3.0 * v * curvature)));
            let time = if length * a >= v * v { length / v + v / a } else { 2.0 * sqrt_f32(length / a) };
            if time < best.0 {
                best = (time, v, a);
            }
            v *= ARC_SPEED_STEP;
        }
        self.v = best.1;
        self.a_up = min(self.a_up, best.2);
        self.a_down = min(self.a_down, best.2);
    }
}

/// f32::min has a NaN rule that costs instructions; no operand here is one.
pub(crate) fn min(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

pub(crate) fn max(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

fn magnitude(x: f32) -> f32 {
    if x < 0.0 { -x } else { x }
}

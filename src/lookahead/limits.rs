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
//! `B`. Ramps of SIN2 count with the peak of their jerk, π/2 times the mean: the axis shows at most the larger one of `B` and
//! π/2 · a / ramp time.
//!
//! STEP knows no jerk. What it needs is acceleration: a knee is a step of speed, which shows as an acceleration beside that of
//! the slope, which does not vanish there. A quarter of `a_max` is left to knees: beside them and beside blocks that may pass
//! within a tick on lines, always on arcs. A knee takes no more than what the acceleration of a stage changes in a cycle.
use super::pace::Headroom;
use super::vector::{PathLimits, TooLow};
use super::weights::Weights;
use crate::machine::{AxisData, ChannelData, MachineData, Stages};
use crate::math::float::{size_f32, to_f32};
use crate::math::root::{cbrt_f32, sqrt_f32};
use crate::nc::{SlopeType, VectorLimit, Weight};
use crate::path::{Bounds, Circle, Element, End};
use crate::quantity::{Distance, Speed};
use crate::slope::bend::Bend;
use crate::slope::profile::speed_f32;
use crate::slope::ramp::{Bowed, Ramp, Stepped};
use crate::tick::SKIP_PER_TICK;
use core::f32::consts::TAU;

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
/// Part of `a_max` and of `B` inside an element whose path is time.
const TIMED_PART: f32 = 0.988;
/// Jerks tried there, each by that factor less: down to a thousandth.
const TIMED_STEPS: usize = 44;
const TIMED_STEP: f32 = 0.85;
/// Part of the largest acceleration that may act across the path.
const NORMAL_PART: f32 = 0.8;
/// Part of the largest acceleration for a knee: Δv shows as a second difference of Δv/T. Slopes vanish at the ends
/// of a block, which leaves the knee its part, unless their ramps are as short as the difference looks, or
/// acceleration passes the knee (HSC).
const KNEE_PART: f32 = 0.25;
/// Longest time for [`Dynamics::smoothing`], ticks.
const LONGEST_SMOOTHING: f32 = 1024.0;
/// Part of what a transition may show that passes for none, and what it takes of the largest acceleration.
const SLIGHT: f32 = 1.0 / 64.0;
const SLIGHT_KNEE: f32 = KNEE_PART * SLIGHT;
/// Ramps of that many ticks are not.
const LONG_RAMP: f32 = 4.0;
/// Element lengths per tick, so that a tick never has to pass more elements than it may.
const SKIP: f32 = (SKIP_PER_TICK - 1) as f32;

const LSB_40: f32 = 1.0 / (1u64 << 40) as f32;
const LSB_44: f32 = 1.0 / (1u64 << 44) as f32;

/// A jerk that is none, mm/tick³.
const NO_LIMIT: f32 = 1e20;
/// STEP: a step below this part of what a knee may take is rounding of coordinates.
const STEP_SMOOTH: f32 = 1.0 / 4_194_304.0;
/// Two limits that differ by less are alike. Of the speeds a span has the higher one: four roundings.
const ALIKE: f32 = 1.0 / 262_144.0;
const ALIKE_SPEED: f32 = 1.0 / 4_194_304.0;
/// Two change-over speeds that differ by less are one.
const SAME: f32 = 1.0 + 1.0 / 1_048_576.0;

/// The four ramps of a slope: acceleration rises, falls, deceleration rises, falls.
pub type Ramps = [f32; 4];

/// What a slope permits beside speed and acceleration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Law {
    /// TRAPEZ, SIN2, HSC.
    Bowed {
        /// Shape of the ramps.
        bend: Bend,
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
}

/// What limits a curve that replaces a corner, beside the axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Curving {
    /// CHECK_JERK: the jerk its curvature may cause. 0: any, 1: by the geometric ramp time, 2: by the ramp times.
    pub jerk: u8,
    /// CONST_VEL: its speed does not change.
    pub constant: bool,
}

/// Largest change of the speed's square inside an element where the speed is to stay, relative.
const CONSTANT: f32 = 1.0 / 8192.0;

/// Dynamics of one axis in one kind of motion (feed or rapid), per tick.
#[derive(Clone, Copy, Debug)]
struct Set {
    v: f32,
    a_up: f32,
    a_down: f32,
    /// STEP: the same above the change-over speed, and that.
    upper: [f32; 2],
    change_over: f32,
    /// The others: mean jerks.
    j: Ramps,
    joint: Joint,
    /// The least a / ramp time, at most `B`.
    ramp_budget: f32,
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
    /// P-AXIS-00214; none where that is 0.
    v_reduced: f32,
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
    /// Elements are to be good for so many times their feed.
    level: f32,
    /// An axis has a reduced speed.
    reduces: bool,
}

/// What an element permits: along the path, beside a transition, with an override.
pub type Permitted = (Limits, Share, Headroom);

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
            level: 1.0,
            reduces: machine.axes.iter().any(|axis| axis.vb_max_red > 0),
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

    /// The law of the slope before any axis restricts it.
    fn law(&self, change_over: f32) -> Law {
        match self.slope {
            SlopeType::Step => Law::Stepped { change_over, a_up: f32::MAX, a_down: f32::MAX },
            SlopeType::Sin2 => Law::Bowed { bend: Bend::SineSquare, j: [f32::MAX; 4] },
            SlopeType::Trapez | SlopeType::Hsc => Law::Bowed { bend: Bend::Linear, j: [f32::MAX; 4] },
        }
    }

    /// Elements that follow are to be good for `level` times their feed, 1…2.
    pub fn set_level(&mut self, level: f32) {
        self.level = level;
    }

    /// Path speed of a feed (mm/min); without one there is no limit.
    fn programmed(&self, feed: Option<f32>) -> f32 {
        feed.map_or(f32::MAX, |feed| feed * self.feed_unit * MARGIN)
    }

    /// Limits of an element run with `feed` (mm/min), or as rapid motion without one.
    pub fn element(&self, element: &Element<AXES>, feed: Option<f32>) -> Permitted {
        match &element.circle {
            None => self.line(&element.entry.tangent, element.shape.length, feed),
            circle => self.permitted(&element.entry.tangent, element.shape.length, circle, feed),
        }
    }

    /// The same for a straight line: its direction (LSB 2^-40) and its length.
    #[inline(never)]
    pub(crate) fn line(&self, tangent: &[i64; AXES], length: Distance, feed: Option<f32>) -> Permitted {
        self.permitted(tangent, length, &None, feed)
    }

    #[inline(always)]
    fn permitted(
        &self,
        tangent: &[i64; AXES],
        length: Distance,
        circle: &Option<Circle>,
        feed: Option<f32>,
    ) -> Permitted {
        let rapid = feed.is_none();
        let length = to_f32(length.to_bits()) * LSB_44;
        let mut limits = Limits { v: min(SKIP * length, self.path.speed(rapid)), ..Limits::WIDEST };
        let mut share_left = Share { j: f32::MAX, a: f32::MAX };
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
            let mut normal = f32::MAX;
            let mut a_max = f32::MAX;
            let mut budget = f32::MAX;
            for axis in circle.plane.into_iter().filter_map(|k| self.axes.get(k)) {
                let set = axis.set(rapid);
                normal = min(normal, set.least());
                let stepped = self.slope == SlopeType::Step;
                a_max = min(a_max, if stepped { (1.0 - KNEE_PART) * axis.a_max } else { axis.a_max });
                budget = min(budget, if stepped { NO_LIMIT } else { set.joint.budget });
            }
            let normal = min(normal, NORMAL_PART * a_max);
            limits.v = min(limits.v, feed * self.level);
            limits.bend(curvature, normal, a_max, budget, circle.share);
        }
        self.path.lower(&mut limits, rapid, circle.is_some());
        let headroom = limits.take_feed(feed, v_reduced, self.level);
        (limits, share_left, headroom)
    }

    /// Speed, acceleration and jerk that a motion along the line `element` may have in both directions; `None` with a slope that
    /// has no jerk.
    pub fn along(&self, element: &Element<AXES>, feed: Option<f32>) -> Option<[f32; 3]> {
        let (limits, ..) = self.element(element, feed);
        let Law::Bowed { j, .. } = limits.law else { return None };
        let j = j.into_iter().fold(f32::MAX, min);
        Some([limits.v, min(limits.a_up, limits.a_down), j])
    }

    /// Acceleration and jerk with which all axes together may move in proportion to `parts`: as a slope, and no more than
    /// `of` a_max and of `B`.
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

    /// The jerk that a curve in a corner may cause, with this CHECK_JERK, where axes share it in proportion to `parts`.
    pub fn across(&self, parts: &[f32; AXES], rapid: bool, check: u8) -> f32 {
        let axes = self.axes.iter().zip(parts).filter(|(_, part)| **part != 0.0);
        axes.fold(f32::MAX, |j, (axis, part)| {
            min(j, axis.set(rapid).curving_budget(check) / magnitude(*part))
        })
    }

    /// Limits of a polynomial, as [`Self::element`] has them for lines and arcs. Per axis the path's derivatives, each at
    /// its largest, share the acceleration a_max and the jerk budget:
    ///
    /// |x''|·v² + |x'|·a ≤ a_max,  |x'''|·v³ + 3·|x''|·v·a + |x'|·j ≤ B.
    ///
    /// As in an arc, of five speeds the one is taken with which the element alone is fastest.
    pub fn polynomial(
        &self,
        element: &Element<AXES>,
        bounds: &Bounds<AXES>,
        feed: Option<f32>,
        curving: Curving,
    ) -> Permitted {
        let rapid = feed.is_none();
        let length = to_f32(element.shape.length.to_bits()) * LSB_44;
        if let Some(speed) = bounds.timed {
            return self.timed(bounds, speed, feed);
        }
        let mut limits = Limits { v: min(SKIP * length, self.path.speed(rapid)), ..Limits::WIDEST };
        let mut share_left = Share { j: f32::MAX, a: f32::MAX };
        let mut v_reduced = f32::MAX;
        let feed = self.programmed(feed) / bounds.fastest;
        limits.v = min(limits.v, feed * self.level);
        let derivatives = || bounds.slope.iter().zip(&bounds.bend).zip(&bounds.twist);
        let stepped = self.slope == SlopeType::Step;
        let a_max = |axis: &Axis| if stepped { (1.0 - KNEE_PART) * axis.a_max } else { axis.a_max };
        let budget_of = |set: &Set| if stepped { f32::MAX } else { set.curving_budget(curving.jerk) };
        let mut change_over = f32::MAX;
        if stepped {
            for (axis, slope) in self.axes.iter().zip(&bounds.slope).filter(|(_, slope)| **slope > 0.0) {
                change_over = min(change_over, axis.set(rapid).change_over / slope);
            }
        }
        limits.law = self.law(change_over);
        for (axis, ((slope, bend), twist)) in self.axes.iter().zip(derivatives()) {
            let set = axis.set(rapid);
            if *slope > 0.0 {
                limits.restrict(&mut share_left, set, 1.0 / slope, true);
                v_reduced = min(v_reduced, axis.v_reduced / slope);
            }
            if *bend > 0.0 {
                let normal = min(set.least(), NORMAL_PART * a_max(axis));
                limits.v = min(limits.v, sqrt_f32(normal / bend));
            }
            let budget = budget_of(set);
            if budget < f32::MAX {
                if *twist > 0.0 {
                    limits.v = min(limits.v, cbrt_f32(ARC_PART * budget / twist));
                }
                if let (true, Law::Bowed { bend, j }) = (*slope > 0.0, &mut limits.law) {
                    lower(j, [ARC_SLOPE_PART / bend.peak_jerk() * budget / slope; 4]);
                }
            }
        }
        let mut best = (f32::MAX, 0.0, 0.0);
        let mut v = limits.v;
        for _ in 0..ARC_SPEEDS {
            let mut a = min(limits.a_up, limits.a_down);
            for (axis, ((slope, bend), twist)) in self.axes.iter().zip(derivatives()) {
                if *slope > 0.0 {
                    a = min(a, max(a_max(axis) - bend * v * v, 0.0) / slope);
                }
                let budget = budget_of(axis.set(rapid));
                if *bend > 0.0 && budget < f32::MAX {
                    let left = (1.0 - ARC_SLOPE_PART) * budget - twist * v * v * v;
                    a = min(a, left / (3.0 * v * bend));
                }
            }
            let time = if length * a >= v * v { length / v + v / a } else { 2.0 * sqrt_f32(length / a) };
            if time < best.0 {
                best = (time, v, a);
            }
            v *= ARC_SPEED_STEP;
        }
        limits.v = best.1;
        if curving.constant {
            // Over its length the square of the speed changes by 2·a·length.
            best.2 = min(best.2, CONSTANT * best.1 * best.1 / length);
        }
        limits.lower_accelerations(best.2);
        self.path.lower(&mut limits, rapid, true);
        let headroom = limits.take_feed(feed, v_reduced, self.level);
        (limits, share_left, headroom)
    }

    /// Limits of an element whose path is time. Nearly all of acceleration and jerk belongs to the curve as long as it is passed at
    /// the highest speed V; a path acceleration needs 3·x''·v·a beside it.
    ///
    /// But acceleration is zero at both ends of a span, and between them it changes with the jerk j at most: from zero at a
    /// speed of V at most, or to zero there. So v + a²/(2·j) ≤ V, which leaves room where there is acceleration: the only
    /// question is, how high j may be. With v = V·(1 − e²), a = e·√(2·j·V) and 0 ≤ e ≤ 1 an axis needs
    ///
    /// |x''|·V²·(1 − e²)² + |x'|·e·√(2·j·V) ≤ a_max,  |x'''|·V³·(1 − e²)³ + 3·|x''|·V·e·(1 − e²)·√(2·j·V) + |x'|·j ≤ B.
    ///
    /// For e ≤ 1/2 the powers are at most 1 − 7/4·e² and 1 − 9/4·e², for others at most their value at 1/2 times 2·(1 − e);
    /// e·(1 − e²) is at most 0.385.
    fn timed(&self, bounds: &Bounds<AXES>, speed: f32, feed: Option<f32>) -> Permitted {
        let rapid = feed.is_none();
        let mut limits = Limits { v: min(speed, self.path.speed(rapid)), ..Limits::WIDEST };
        let mut share_left = Share { j: f32::MAX, a: f32::MAX };
        let feed = self.programmed(feed);
        limits.v = min(limits.v, feed * self.level);
        let mut v_reduced = f32::MAX;
        limits.law = self.law(f32::MAX);
        let derivatives = || bounds.slope.iter().zip(&bounds.bend).zip(&bounds.twist);
        let mut jerk = f32::MAX;
        for (axis, ((slope, bend), twist)) in self.axes.iter().zip(derivatives()) {
            let set = axis.set(rapid);
            if *slope > 0.0 {
                limits.restrict(&mut share_left, set, 1.0 / slope, true);
                jerk = min(jerk, set.joint.budget / slope);
                v_reduced = min(v_reduced, axis.v_reduced / slope);
            }
            if *bend > 0.0 {
                limits.v = min(limits.v, sqrt_f32(TIMED_PART * axis.a_max / bend));
            }
            if *twist > 0.0 {
                limits.v = min(limits.v, cbrt_f32(TIMED_PART * set.joint.budget / twist));
            }
        }
        let v = limits.v;
        for _ in 0..TIMED_STEPS {
            let root = sqrt_f32(2.0 * jerk * v);
            let keeps = self.axes.iter().zip(derivatives()).all(|(axis, ((slope, bend), twist))| {
                let (a, left) = (bend * v * v, axis.set(rapid).joint.budget - slope * jerk);
                let (along, across) = (slope * root, 3.0 * bend * v * root);
                let third = twist * v * v * v;
                let near = a + along <= axis.a_max || a * a + along * along * (1.0 / 7.0) <= axis.a_max * a;
                let evenly = third + 0.385 * across <= left
                    || third * third + across * across * (1.0 / 9.0) <= left * third;
                near && evenly
                    && max(along, 0.5625 * a + 0.5 * along) <= axis.a_max
                    && 0.421_875 * third + 0.385 * across <= left
            });
            if keeps {
                break;
            }
            jerk *= TIMED_STEP;
        }
        if let Law::Bowed { bend, j } = &mut limits.law {
            lower(j, [jerk / bend.peak_jerk(); 4]);
        }
        self.path.lower(&mut limits, rapid, true);
        let headroom = limits.take_feed(feed, v_reduced, self.level);
        (limits, share_left, headroom)
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
        let ends = from.tangent.iter().zip(&to.tangent).zip(from.curvature.iter().zip(&to.curvature));
        for (k, (axis, ((t0, t1), (c0, c1)))) in self.axes.iter().zip(ends).enumerate() {
            if t0 == t1 && c0 == c1 {
                continue;
            }
            let mut joint = if rapid { &axis.rapid.joint } else { &axis.feed.joint };
            let both;
            if let Some([feed_before, rapid_before]) = self.before.as_ref().and_then(|axes| axes.get(k)) {
                both = joint.restricted(if rapid { rapid_before } else { feed_before });
                joint = &both;
            }
            let knee = size_f32(t1.wrapping_sub(*t0).unsigned_abs()) * LSB_40;
            let bend = magnitude(c1 - c0);
            let stepped = self.slope == SlopeType::Step;
            let unseen = if stepped { STEP_SMOOTH } else { SMOOTH } * joint.budget;
            let knee = if fastest * knee <= unseen { 0.0 } else { knee };
            let bend = if stepped || fastest * fastest * bend <= unseen { 0.0 } else { bend };
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

    /// Ticks that a straight line must take at least so that a knee at its end does not show if the end is `off` (mm) beside where
    /// it should be: the knee is at most `off` over its length. Where that takes long, it shows.
    pub fn smoothing(&self, off: f32, rapid: bool) -> f32 {
        let least = self.axes.iter().fold(f32::MAX, |least, axis| min(least, axis.set(rapid).joint.budget));
        min(off / (SMOOTH * least), LONGEST_SMOOTHING)
    }

    /// Whether a transition is tangential but for rounding of coordinates: at the speed `fastest` each axis shows far less than
    /// what a transition may.
    pub fn is_slight(&self, from: &End<AXES>, to: &End<AXES>, rapid: bool, fastest: f32) -> bool {
        let ends = from.tangent.iter().zip(&to.tangent).zip(from.curvature.iter().zip(&to.curvature));
        self.axes.iter().zip(ends).all(|(axis, ((t0, t1), (c0, c1)))| {
            let Joint { budget, knee, .. } = axis.set(rapid).joint;
            let step = fastest * size_f32(t1.wrapping_sub(*t0).unsigned_abs()) * LSB_40;
            let part = TRANSITION_PART * budget;
            step <= SLIGHT * min(part, knee) && fastest * fastest * magnitude(c1 - c0) <= SLIGHT * part
        })
    }

    /// The slope of the elements that follow.
    pub fn slope(&self) -> SlopeType {
        self.slope
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
    fn restricted(&self, other: &Self) -> Self {
        Self {
            budget: min(self.budget, other.budget),
            knee: min(self.knee, other.knee),
            bend: min(self.bend, other.bend),
        }
    }
}

impl Set {
    /// The jerk that a curve in a corner may cause.
    fn curving_budget(&self, check: u8) -> f32 {
        match check {
            0 => f32::MAX,
            1 => self.joint.budget,
            _ => self.ramp_budget,
        }
    }
}

impl Axis {
    /// Feed or rapid.
    #[inline(always)]
    fn set(&self, rapid: bool) -> &Set {
        if rapid { &self.rapid } else { &self.feed }
    }

    fn new(data: &AxisData, channel: &ChannelData, slope: SlopeType) -> Self {
        let cycle_s = channel.cycle_us as f32 * 1e-6;
        let speed = |um_s: u32| um_s as f32 * 1e-3 * cycle_s * MARGIN;
        let accel = |a: u32| a as f32 * cycle_s * cycle_s * MARGIN;
        let ticks = |us: u32| max(us as f32 * 1e-6, 1e-9) / cycle_s;
        let geometric = ticks(data.tr_geom);
        let a_max = accel(data.a_max);
        let stepped = slope == SlopeType::Step;
        let set = |v: u32, a: [u32; 2], tr: [u32; 4], stages: Stages| {
            let [a_up, a_down] = if stepped { [stages.a[0], stages.d[0]] } else { a }.map(accel);
            let upper = [stages.a[1], stages.d[1]].map(accel);
            // HSC has one ramp time: the longest.
            let tr = if slope == SlopeType::Hsc { [tr.into_iter().max().unwrap_or(0); 4] } else { tr };
            let tr = tr.map(ticks);
            let over = |tr: f32, k: usize| (if k < 2 { a_up } else { a_down }) / tr;
            let mut j = [0.0; 4];
            let mut budget = f32::MAX;
            let mut ramp_budget = f32::MAX;
            let [mut shortest, mut longest] = [f32::MAX, 0.0];
            for (k, (j, tr)) in j.iter_mut().zip(tr).enumerate() {
                *j = over(tr, k) * JERK_MARGIN;
                budget = min(budget, over(min(tr, geometric), k) * JERK_MARGIN);
                ramp_budget = min(ramp_budget, *j);
                longest = max(longest, tr);
                shortest = min(shortest, tr);
            }
            let a = min(a_up, a_down);
            // Of `a`, in 0.1 %; 0: cycle time / ramp time.
            let part = |weight: u32| a * if weight == 0 { 1.0 / longest } else { weight as f32 * 1e-3 };
            let mut set = Set {
                v: speed(v),
                a_up,
                a_down,
                upper,
                change_over: speed(stages.change_over),
                j,
                joint: Joint {
                    budget,
                    knee: min(part(data.a_trans_weight), KNEE_PART * a_max),
                    bend: if channel.corr_v_trans_jerk { part(data.r_trans_weight) } else { f32::MAX },
                },
                ramp_budget: min(ramp_budget, budget),
                a_shared: (1.0 - SLIGHT_KNEE) * a_max,
            };
            if stepped {
                // One tick of the acceleration: the weight is for the other slopes. Close knees add up as they do there.
                let knee = min(set.least(), KNEE_PART * a_max);
                set.joint = Joint { budget: knee / TRANSITION_PART, knee, bend: f32::MAX };
            } else {
                set.upper = [f32::MAX; 2];
            }
            if stepped || shortest < LONG_RAMP || slope == SlopeType::Hsc {
                set.a_shared = (1.0 - KNEE_PART) * a_max;
            }
            set
        };
        let tr = [data.tr_beschl_zu, data.tr_beschl_ab, data.tr_brems_zu, data.tr_brems_ab];
        let (a_feed, a_rapid) = ([data.a_beschl, data.a_brems], [data.a_grenz; 2]);
        Self {
            feed: set(data.vb_max, a_feed, tr, data.stages(false)),
            rapid: set(data.vb_eilgang, a_rapid, [data.tr_grenz; 4], data.stages(true)),
            a_max,
            v_reduced: if data.vb_max_red == 0 { f32::MAX } else { speed(data.vb_max_red) },
        }
    }
}

impl Set {
    /// Smallest acceleration.
    fn least(&self) -> f32 {
        min(min(self.a_up, self.a_down), min(self.upper[0], self.upper[1]))
    }
}

impl Limits {
    /// No limit.
    pub const WIDEST: Self = Self {
        v: f32::MAX,
        a_up: f32::MAX,
        a_down: f32::MAX,
        law: Law::Bowed { bend: Bend::Linear, j: [f32::MAX; 4] },
    };

    /// The speed becomes that of the feed at the level, at most what it was; all of it is known where it is reached.
    #[inline(always)]
    fn take_feed(&mut self, feed: f32, v_reduced: f32, level: f32) -> Headroom {
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

    /// Permits no speed above those.
    pub(super) fn flatten(&mut self, v_in: Speed, v_out: Speed) {
        self.v = speed_f32(v_in.max(v_out).to_bits());
    }

    /// Largest acceleration or deceleration of both.
    pub(super) fn fastest(&self, other: &Self) -> f32 {
        max(max(self.a_up, self.a_down), max(other.a_up, other.a_down))
    }

    /// The slope that gains speed.
    pub fn speed_up(&self) -> Ramp {
        match self.law {
            Law::Bowed { bend, j: [rise, fall, ..] } => Ramp::Bowed(Bowed::new(bend, self.a_up, rise, fall)),
            Law::Stepped { change_over, a_up, .. } => {
                Ramp::Stepped(Stepped { a: [self.a_up, a_up], change_over })
            }
        }
    }

    /// The slope that loses speed, seen backward from the lower one.
    pub fn brake(&self) -> Ramp {
        match self.law {
            Law::Bowed { bend, j: [.., rise, fall] } => {
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
            Law::Bowed { bend: Bend::SineSquare, j } => {
                let highest = j.iter().fold(0.0, |highest, j| max(highest, *j));
                let part = min(1.0, share.j / highest);
                *j = j.map(|j| j * part);
            }
            Law::Bowed { j, .. } => lower(j, [share.j; 4]),
            Law::Stepped { .. } => {}
        }
        self.lower_accelerations(share.a);
    }

    /// With a transition's part left to it.
    pub(super) fn shared(mut self, share: &Share) -> Self {
        self.share(share);
        self
    }

    /// No acceleration above `a`.
    fn lower_accelerations(&mut self, a: f32) {
        self.a_up = min(a, self.a_up);
        self.a_down = min(a, self.a_down);
        if let Law::Stepped { a_up, a_down, .. } = &mut self.law {
            *a_up = min(*a_up, a);
            *a_down = min(*a_down, a);
        }
    }

    /// Takes in an axis that moves `1 / scale` times as far as the path; `turns`: at times, less.
    #[inline(always)]
    fn restrict(&mut self, share: &mut Share, set: &Set, scale: f32, turns: bool) {
        self.v = min(set.v * scale, self.v);
        self.a_up = min(set.a_up * scale, self.a_up);
        self.a_down = min(set.a_down * scale, self.a_down);
        let mut peak = 1.0;
        match &mut self.law {
            Law::Bowed { bend, j } => {
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
    }

    /// Takes in a curvature κ: v²κ across the path, with the tangential acceleration inside `a_max`; jerks
    /// v³κ²/share + 3vκ·a + share·j inside `budget` (their exact sum is a vector no longer than that). `share` is the part of the
    /// path that lies in the arc's plane: of a helix κ = share²/r, and the first of them is (share·v)³/r².
    ///
    /// The faster the arc, the less acceleration is left to reach that speed: of five speeds, each four fifths of the
    /// one before, the one is taken with which the full circle, from rest to rest with that acceleration, is fastest.
    /// So an arc does not become slower where it is cut.
    fn bend(&mut self, curvature: f32, normal: f32, a_max: f32, budget: f32, share: f32) {
        self.v = min(self.v, sqrt_f32(normal / curvature));
        let twist = curvature * curvature / share;
        self.v = min(self.v, cbrt_f32(ARC_PART * budget / twist));
        if let Law::Bowed { bend, j } = &mut self.law {
            lower(j, [ARC_SLOPE_PART / bend.peak_jerk() * budget / share; 4]);
        }
        let length = TAU / curvature;
        let mut best = (f32::MAX, 0.0, 0.0);
        let mut v = self.v;
        for _ in 0..ARC_SPEEDS {
            let across = v * v * curvature;
            let along = sqrt_f32(max(a_max * a_max - across * across, 0.0)) / share;
            let jerk = (1.0 - ARC_SLOPE_PART) * budget - twist * v * v * v;
            let a = min(min(self.a_up, self.a_down), min(along, jerk / (3.0 * v * curvature)));
            let time = if length * a >= v * v { length / v + v / a } else { 2.0 * sqrt_f32(length / a) };
            if time < best.0 {
                best = (time, v, a);
            }
            v *= ARC_SPEED_STEP;
        }
        self.v = best.1;
        self.lower_accelerations(best.2);
    }
}

fn lower<const N: usize>(values: &mut [f32; N], others: [f32; N]) {
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

fn magnitude(x: f32) -> f32 {
    if x < 0.0 { -x } else { x }
}

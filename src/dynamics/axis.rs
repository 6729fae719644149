//! The limits of one axis: machine data converted to mm and ticks.
use super::{JERK_MARGIN, KNEE_PART, MARGIN, SLIGHT, SMOOTH};
use crate::dynamics::permitted::TRANSITION_PART;
use crate::machine::{AxisData, ChannelData, Stages};
use crate::math::float::{max, min};
use crate::math::root::sqrt_f32;
use crate::nc::SlopeType;
use crate::slope::limits::Ramps;
use crate::slope::ramp_shape::RampShape;

/// Part of the largest acceleration that is reserved for a slight transition.
const SLIGHT_KNEE: f32 = KNEE_PART * SLIGHT;
/// Ramps of at least this number of ticks count as long.
const LONG_RAMP: f32 = 4.0;

/// Limits of one axis in one kind of motion (feed or rapid), per tick. Units: mm or degrees, and ticks.
#[derive(Clone, Copy, Debug)]
pub struct Set {
    pub v: f32,
    pub a_up: f32,
    pub a_down: f32,
    /// STEP: accelerations above the change-over speed, and the change-over speed.
    pub upper: [f32; 2],
    pub change_over: f32,
    /// Slopes other than STEP: mean jerks of the four ramps, units per tick³.
    pub j: Ramps,
    pub joint: TransitionLimits,
    /// The lowest acceleration divided by its ramp time; at most `B`.
    pub ramp_budget: f32,
    /// The lowest acceleration divided by the geometric ramp time. This value is `B`, or less if the
    /// geometric ramp time is longer than the ramp times.
    pub geometric_budget: f32,
    /// Acceleration that is left to the speed profile at a knee (a corner without a curve).
    pub a_shared: f32,
    /// As `a_shared`, for a knee at which the acceleration of the profile is zero.
    pub a_resting: f32,
}

/// What one axis may do at the transition between two blocks, per tick.
#[derive(Clone, Copy, Debug)]
pub struct TransitionLimits {
    /// Jerk `B` of the axis: see the documentation of [`mod@crate::dynamics`].
    pub budget: f32,
    /// Permitted step of speed of the axis at a knee (P-AXIS-00013).
    pub knee: f32,
    /// Whether P-AXIS-00013 is given; the jerk of a step of speed at a knee is then not limited.
    pub is_weighted: bool,
    /// Permitted jerk of a step of acceleration, as the curvature changes (P-CHAN-00009, P-AXIS-00154);
    /// `f32::MAX` without limit.
    pub bend: f32,
    /// Acceleration for a corner without a curve and for the curvature together, within a tick of the
    /// transition. The rest of the acceleration is for the speed profile.
    pub left: f32,
    /// Speed that the profile gains within a tick of the transition.
    pub gained: f32,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Axis {
    pub(super) feed: Set,
    pub(super) rapid: Set,
    pub(super) a_max: f32,
    /// P-AXIS-00214: reduced speed; `f32::MAX` if the parameter is 0.
    pub(super) v_reduced: f32,
    /// Gain of the filter of the axis, and the acceleration that AX_DEV permits.
    pub(super) gain: f32,
    pub(super) cap: f32,
    /// Factor for accelerations and jerks by AX_DEV, if all jerk is limited.
    pub(super) share: Option<f32>,
    /// Whether the axis has a filter that rounds its set points.
    pub(super) is_filtered: bool,
}

impl TransitionLimits {
    pub(super) fn restricted(&self, other: &Self) -> Self {
        Self {
            budget: min(self.budget, other.budget),
            knee: min(self.knee, other.knee),
            is_weighted: self.is_weighted && other.is_weighted,
            bend: min(self.bend, other.bend),
            left: min(self.left, other.left),
            gained: max(self.gained, other.gained),
        }
    }
}

impl TransitionLimits {
    /// Highest speed at which two accelerations together are at most `left`: that of the speed step at a
    /// knee, and that of the curvature. The curvature acts at the speed one tick later:
    ///
    /// knee·v + curvature·(v + gained)² ≤ left.
    pub(super) fn beside_turn(&self, knee: f32, curvature: f32) -> f32 {
        let both = knee + sqrt_f32(knee * knee + 4.0 * curvature * self.left);
        2.0 * self.left / both - self.gained
    }
}

impl Set {
    /// The jerk that the curve of a corner may cause. `check`: CHECK_JERK.
    pub(super) fn curving_budget(&self, check: u8) -> f32 {
        match check {
            0 => f32::MAX,
            1 => self.geometric_budget,
            _ => self.ramp_budget,
        }
    }

    /// The lowest of acceleration and deceleration.
    pub(super) fn least(&self) -> f32 {
        min(min(self.a_up, self.a_down), min(self.upper[0], self.upper[1]))
    }
}

impl Axis {
    /// An axis without any permitted motion.
    pub(super) const BLANK: Self = {
        let joint = TransitionLimits {
            budget: 0.0,
            knee: 0.0,
            is_weighted: false,
            bend: 0.0,
            left: 0.0,
            gained: 0.0,
        };
        let set = Set {
            v: 0.0,
            a_up: 0.0,
            a_down: 0.0,
            upper: [0.0; 2],
            change_over: 0.0,
            j: [0.0; 4],
            joint,
            ramp_budget: 0.0,
            geometric_budget: 0.0,
            a_shared: 0.0,
            a_resting: 0.0,
        };
        Self {
            feed: set,
            rapid: set,
            a_max: 0.0,
            v_reduced: 0.0,
            gain: 0.0,
            cap: 0.0,
            share: None,
            is_filtered: false,
        }
    };

    /// Limits of feed or of rapid motion.
    #[cfg_attr(feature = "fast", inline(always))]
    pub(super) fn set(&self, rapid: bool) -> &Set {
        if rapid { &self.rapid } else { &self.feed }
    }

    /// Converts the planned machine data of an axis.
    #[cfg_attr(not(feature = "fast"), inline(never))]
    pub(super) fn new(data: &AxisData, channel: &ChannelData, slope: SlopeType) -> Self {
        let units = Units { cycle_s: channel.cycle_us as f32 * 1e-6 };
        let data = &data.planned(channel);
        let tr = [data.tr_beschl_zu, data.tr_beschl_ab, data.tr_brems_zu, data.tr_brems_ab];
        let (a_feed, a_rapid) = ([data.a_beschl, data.a_brems], [data.a_grenz; 2]);
        let feed = Motion { v: data.vb_max, a: a_feed, tr, stages: data.stages(false) };
        let rapid =
            Motion { v: data.vb_eilgang, a: a_rapid, tr: [data.tr_grenz; 4], stages: data.stages(true) };
        let v_reduced = if data.vb_max_red == 0 { f32::MAX } else { units.speed(data.vb_max_red) };
        let [feed, rapid] = [feed, rapid].map(|motion| Set::new(&motion, data, channel, slope));
        Self {
            feed,
            rapid,
            a_max: units.accel(data.a_max),
            v_reduced,
            gain: 1.0,
            cap: f32::MAX,
            share: None,
            is_filtered: false,
        }
    }
}

/// Machine data of one kind of motion: speed, acceleration and deceleration, ramp times, stages of STEP.
struct Motion {
    v: u32,
    a: [u32; 2],
    tr: [u32; 4],
    stages: Stages,
}

/// Factors from the units of machine data to values per tick.
#[derive(Clone, Copy)]
struct Units {
    cycle_s: f32,
}

impl Units {
    /// From µm/s, or 0.001 degrees/s.
    fn speed(self, um_s: u32) -> f32 {
        um_s as f32 * 1e-3 * self.cycle_s * MARGIN
    }

    /// From mm/s².
    fn accel(self, a: u32) -> f32 {
        a as f32 * self.cycle_s * self.cycle_s * MARGIN
    }

    /// From µs.
    fn ticks(self, us: u32) -> f32 {
        us as f32 * 1e-6 / self.cycle_s
    }
}

/// Jerks of the four ramps of an axis.
struct Jerks {
    /// Mean jerk of each ramp.
    j: Ramps,
    /// The lowest ratio of acceleration to min(ramp time, geometric ramp time), to the ramp time, and to the
    /// geometric ramp time.
    budget: f32,
    ramp_budget: f32,
    geometric_budget: f32,
    /// Shortest ramp time, ticks.
    shortest: f32,
    longest: f32,
}

impl Jerks {
    /// Computes the jerks from acceleration and deceleration, ramp times and geometric ramp time.
    fn new([a_up, a_down]: [f32; 2], tr: [f32; 4], geometric: f32) -> Self {
        let over = |tr: f32, k: usize| (if k < 2 { a_up } else { a_down }) / tr;
        let mut jerks = Self {
            j: [0.0; 4],
            budget: f32::MAX,
            ramp_budget: f32::MAX,
            geometric_budget: f32::MAX,
            shortest: f32::MAX,
            longest: 0.0,
        };
        for (k, (j, tr)) in jerks.j.iter_mut().zip(tr).enumerate() {
            *j = over(tr, k) * JERK_MARGIN;
            jerks.budget = min(jerks.budget, over(min(tr, geometric), k) * JERK_MARGIN);
            jerks.ramp_budget = min(jerks.ramp_budget, *j);
            jerks.geometric_budget = min(jerks.geometric_budget, over(geometric, k) * JERK_MARGIN);
            jerks.longest = max(jerks.longest, tr);
            jerks.shortest = min(jerks.shortest, tr);
        }
        jerks
    }
}

impl Set {
    fn new(motion: &Motion, data: &AxisData, channel: &ChannelData, slope: SlopeType) -> Self {
        let units = Units { cycle_s: channel.cycle_us as f32 * 1e-6 };
        let Motion { v, a, tr, stages } = *motion;
        let (stepped, a_max) = (slope.is_step(), units.accel(data.a_max));
        let [a_up, a_down] = if stepped { [stages.a[0], stages.d[0]] } else { a }.map(|a| units.accel(a));
        let upper = [stages.a[1], stages.d[1]].map(|a| units.accel(a));
        // HSC has one ramp time: the longest.
        let tr = if slope == SlopeType::Hsc { [tr.into_iter().max().unwrap_or(0); 4] } else { tr };
        let jerks = Jerks::new([a_up, a_down], tr.map(|us| units.ticks(us)), units.ticks(data.tr_geom));
        let Jerks { j, budget, .. } = jerks;
        // A small step of speed by rounding of coordinates adds to these accelerations.
        let beside = if stepped { a_max } else { a_max - SMOOTH * budget };
        let [a_up, a_down] = [min(a_up, beside), min(a_down, beside)];
        let a = min(a_up, a_down);
        // Weight of the acceleration in 0.1 %; 0 selects cycle time / ramp time.
        let weight = data.a_trans_weight;
        let knee = a * if weight == 0 { 1.0 / jerks.longest } else { weight as f32 * 1e-3 };
        // Within a tick of a transition with zero acceleration, the profile has at most this acceleration. A
        // third of this value counts.
        let peak = if slope == SlopeType::Sin2 { RampShape::SineSquare.peak_jerk() } else { 1.0 };
        let near = min(peak * j.into_iter().fold(0.0, max), TRANSITION_PART * budget);
        // With HSC, acceleration may pass a knee.
        let passes = slope == SlopeType::Hsc;
        let left = if passes { a_max } else { a_max - near * (1.0 / 3.0) };
        let most = if passes || weight == 0 { KNEE_PART * a_max } else { left };
        let jerk = match data.r_trans_weight {
            0 => 1000,
            weight => weight,
        };
        let bend = jerk as f32 * 1e-3 * TRANSITION_PART * budget;
        let mut set = Self {
            v: units.speed(v),
            a_up,
            a_down,
            upper,
            change_over: units.speed(stages.change_over),
            j,
            joint: TransitionLimits {
                budget,
                knee: min(knee, most),
                is_weighted: weight > 0,
                bend: if channel.corr_v_trans_jerk { bend } else { f32::MAX },
                left,
                gained: 0.5 * near,
            },
            ramp_budget: min(jerks.ramp_budget, budget),
            geometric_budget: jerks.geometric_budget,
            a_shared: (1.0 - KNEE_PART) * a_max,
            a_resting: (1.0 - SLIGHT_KNEE) * a_max,
        };
        if stepped {
            set.step(a_max);
        } else {
            set.upper = [f32::MAX; 2];
        }
        if stepped || jerks.shortest < LONG_RAMP {
            set.a_resting = set.a_shared;
        }
        if !passes {
            set.a_shared = set.a_resting;
        }
        set
    }

    /// Sets the knee of STEP: the speed that the acceleration gains in one tick. The weight acts for the
    /// other slopes only. Steps at close knees add up as for these slopes.
    fn step(&mut self, a_max: f32) {
        let knee = min(self.least(), KNEE_PART * a_max);
        self.joint.budget = knee / TRANSITION_PART;
        self.geometric_budget = self.joint.budget;
        (self.joint.knee, self.joint.is_weighted, self.joint.bend) = (knee, false, f32::MAX);
    }
}

//! Limits of the axes along the path of one block and at its transitions. Path values per tick, in f64.
//!
//! Written from the rules of the look-ahead:
//!
//! - every limit of a straight block is that of the axis that reaches its limit first;
//! - an axis has at most the jerk B = a / min(ramp time, geometric ramp time); an arc or a corner uses a part
//!   of B;
//! - a ramp of SIN2 has π/2 times the jerk of a linear one;
//! - a corner with P-AXIS-00013, and without P-CHAN-00009 a step of acceleration, may have unlimited jerk.
//!   With P-CHAN-00009 the step has the part of the transition's jerk that P-AXIS-00154 gives. Corner,
//!   curvature and slope together keep the highest acceleration;
//! - STEP has no jerk limit: a corner is a step of speed. The step is at most the change of speed in a tick,
//!   at a quarter of the highest acceleration. Neighbouring lines and all arcs leave this quarter to the
//!   corner;
//! - speeds and accelerations keep [`tolerance::SPEED_MARGIN`], jerks [`tolerance::JERK_MARGIN`];
//! - a path distance is good to [`tolerance::DISTANCE`] δ, and each of the four that count in a second difference may be
//!   off by it (1, 2 and 1 times): along the path 4·δ of acceleration are left to that. Of an axis that moves n times as
//!   far as the path that is 4·n·δ, so it keeps its own limit with any n.
use super::geometry::{Element, Shape};
use super::profile::{Change, Ramps, Slope};
use crate::tolerance;
use glidepath::machine::{AxisData, ChannelData};
use std::f64::consts::{FRAC_PI_4, PI, TAU};

/// Part of B for a transition that is not smooth; the slope next to the transition gets the same part.
const JOINT: f64 = 0.4;
/// Part of B for an acceleration along the path whose direction changes at a transition.
const TURN: f64 = 0.05;
/// Next to a transition an arc has these parts of B: for the slope, for v³κ².
const ARC_SLOPE: f64 = 0.25;
const ARC_TURN: f64 = 0.5;
/// Each row: a part of the speed V at which v³κ² takes all of B, then two jerks, against and along the
/// motion, in parts of B. An arc at up to this speed leaves these jerks to a speed profile that begins and
/// ends without acceleration.
const ARC_LEVELS: [[f64; 3]; 11] = [
    [0.986, 0.0404, 0.80],
    [0.957, 0.1223, 0.95],
    [0.918, 0.2241, 0.87],
    [0.868, 0.3408, 0.78],
    [0.810, 0.3983, 0.78],
    [0.740, 0.4491, 0.81],
    [0.671, 0.5444, 0.82],
    [0.592, 0.6776, 0.84],
    [0.500, 0.7788, 0.89],
    [0.400, 0.8939, 0.93],
    [0.300, 0.9535, 0.97],
];
/// Highest part of V, and parts of the highest speed that are tried: of two turns and more the first two.
const ARC_HIGHEST: f64 = 0.985;
const ARC_SPEEDS: [f64; 8] = [1.0, 0.971, 0.93, 0.88, 0.82, 0.75, 0.68, 0.6];
const ARC_TURNS: f64 = 4.0 * PI;
const ARC_MOST_TURNS: f64 = 64.0 * PI;
/// Times with a smaller difference are equal: the higher speed is used.
const ARC_CLEARLY: f64 = 1.0 - 1.0 / 4096.0;
/// Angles with a smaller difference are equal.
const ARC_NEARLY: f64 = 1.001;
/// For rounding.
const SURELY: f64 = 0.999;
/// Part of the highest acceleration for a corner, and the ramp length in ticks above which the slope is small
/// in comparison.
const KNEE: f64 = 0.25;
const LONG_RAMP: f64 = 4.0;
/// A transition with less than this part of its limit does not count for acceleration.
const SLIGHT: f64 = 1.0 / 64.0;
/// Part of the highest acceleration that may act perpendicular to the path.
const ACROSS: f64 = ARC_HIGHEST * ARC_HIGHEST;
/// A smaller corner is rounding of coordinates.
const SMOOTH: f64 = 1.0 / 20_000.0;
/// The same for STEP.
const STEP_SMOOTH: f64 = 1.0 / 4_194_304.0;

/// Path limits of one block, per tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BlockLimits {
    /// Speed.
    pub v: f64,
    /// Acceleration.
    pub a_up: f64,
    /// Deceleration.
    pub a_down: f64,
    /// P-CHAN-00071.
    pub slope: u8,
    /// STEP: the change-over speed, acceleration and deceleration above it.
    pub upper: [f64; 3],
    /// Mean jerk while acceleration rises and falls, while deceleration rises and falls.
    pub j: [f64; 4],
    /// Jerk that a block next to a transition may use.
    pub j_beside: f64,
    /// Acceleration that it may use.
    pub a_beside: f64,
    /// Speed of an arc that leaves a transition its part; a line has none.
    pub v_beside: f64,
    /// Permitted acceleration at the ends of an arc.
    pub passing: f64,
}

impl BlockLimits {
    /// The largest acceleration or deceleration at any speed.
    pub fn most(&self) -> f64 {
        let above = if self.slope == 0 { self.upper[1].max(self.upper[2]) } else { 0.0 };
        self.a_up.max(self.a_down).max(above)
    }

    /// Acceleration, in the order of time.
    pub fn accelerate(&self) -> Slope {
        self.follow(self.a_up, self.upper[1], self.j[0], self.j[1])
    }

    /// Deceleration, in the order of time.
    pub fn brake(&self) -> Slope {
        self.follow(self.a_down, self.upper[2], self.j[2], self.j[3])
    }

    fn follow(&self, a: f64, upper: f64, rise: f64, fall: f64) -> Slope {
        let ramps = Ramps { a, up: a / rise, down: a / fall };
        match self.slope {
            0 => Slope::Step([a, upper], self.upper[0]),
            2 => Slope::Sin2(ramps),
            _ => Slope::Trapez(ramps),
        }
    }

    /// Leaves the transition its part of the jerk. Ramps of SIN2 keep their proportions.
    pub fn share(&mut self) {
        if self.slope == 2 {
            let part = self.j.into_iter().map(|j| self.j_beside / j).fold(1.0, f64::min);
            self.j = self.j.map(|j| j * part);
        } else {
            self.j = self.j.map(|j| j.min(self.j_beside));
        }
        self.lower(self.a_beside);
    }

    /// Whether both limits are equal except for rounding.
    pub fn are(&self, other: &Self) -> bool {
        let near = |a: f64, b: f64, part: f64| (a - b).abs() <= a * part;
        let alike = |a: f64, b: f64| near(a, b, 2f64.powi(-18));
        near(self.v, other.v, 2f64.powi(-22))
            && alike(self.a_up, other.a_up)
            && alike(self.a_down, other.a_down)
            && self.j.iter().zip(&other.j).all(|(a, b)| alike(*a, *b))
    }

    /// The lower limits of both; of the speeds the higher one.
    pub fn with(&self, other: &Self) -> Self {
        Self {
            v: self.v.max(other.v),
            a_up: self.a_up.min(other.a_up),
            a_down: self.a_down.min(other.a_down),
            j: std::array::from_fn(|k| self.j[k].min(other.j[k])),
            ..*self
        }
    }

    /// Leaves [`tolerance::DISTANCE`] its second difference, where that is more than [`tolerance::SPEED_MARGIN`] of the
    /// acceleration along the path; of the least acceleration half at most, of the others the same part.
    fn leave_distance(&mut self) {
        let a = self.a_up.min(self.a_down);
        let rough = 4.0 * tolerance::DISTANCE;
        if a * tolerance::SPEED_MARGIN >= rough {
            return;
        }
        let least = if self.slope == 0 { a.min(self.upper[1]).min(self.upper[2]) } else { a };
        let part = (1.0 - rough / least).max(0.5);
        let [_, upper_up, upper_down] = &mut self.upper;
        for value in [&mut self.a_up, &mut self.a_down, &mut self.a_beside, upper_up, upper_down] {
            *value *= part;
        }
    }

    fn lower(&mut self, a: f64) {
        let [_, upper_up, upper_down] = &mut self.upper;
        for value in [&mut self.a_up, &mut self.a_down, upper_up, upper_down] {
            *value = value.min(a);
        }
    }
}

/// One axis' limits per tick for feed or for rapid motion.
#[derive(Clone, Copy, Debug)]
pub struct AxisLimits {
    v: f64,
    a_up: f64,
    a_down: f64,
    j: [f64; 4],
    /// STEP: accelerations and decelerations of both stages, change-over speed.
    up: [f64; 2],
    down: [f64; 2],
    change_over: f64,
    /// B.
    jerk: f64,
    /// Step of speed at a knee, and whether its jerk is free.
    knee: f64,
    free_knee: bool,
    /// Jerk of a step of acceleration.
    bend: f64,
    /// Acceleration of corner and curvature together, and speed gained in a tick in addition.
    beside_turn: [f64; 2],
    a_beside: f64,
    a_max: f64,
}

impl AxisLimits {
    /// Limits of a machine's axis, for a cycle in µs and a slope of P-CHAN-00071.
    pub fn new(axis: &AxisData, channel: &ChannelData, rapid: bool) -> Self {
        let (cycle_us, slope) = (channel.cycle_us, channel.slope_profile);
        let cycle = f64::from(cycle_us) * 1e-6;
        let keep = 1.0 - tolerance::SPEED_MARGIN;
        let acceleration = |mm_s2: u32| f64::from(mm_s2) * cycle * cycle * keep;
        // No ramp is shorter than a cycle.
        let ticks = |us: u32| (f64::from(us) / f64::from(cycle_us)).max(1.0);
        let (v, up, down, ramps) = if rapid {
            (axis.vb_eilgang, axis.a_grenz, axis.a_grenz, [axis.tr_grenz; 4])
        } else {
            let ramps = [axis.tr_beschl_zu, axis.tr_beschl_ab, axis.tr_brems_zu, axis.tr_brems_ab];
            (axis.vb_max, axis.a_beschl, axis.a_brems, ramps)
        };
        let stages =
            if rapid { [axis.a_grenz_stufe, axis.d_grenz_stufe] } else { [axis.a_stufe, axis.d_stufe] };
        // A deceleration of 0 is that of the acceleration.
        let down_of = |i: usize| if stages[1][i] == 0 { stages[0][i] } else { stages[1][i] };
        let stage = |mm_s2: u32| acceleration(mm_s2.min(axis.a_max));
        let (accelerate, brake) = (stages[0].map(stage), [0, 1].map(|i| stage(down_of(i))));
        let change_over = if rapid { axis.vb_grenz_stufe_1_2 } else { axis.vb_stufe_1_2 };
        let (a_up, a_down) =
            if slope == 0 { (accelerate[0], brake[0]) } else { (acceleration(up), acceleration(down)) };
        let jerk_with = |k: usize, ticks: f64| {
            let a = if k < 2 { a_up } else { a_down };
            a / ticks * (1.0 - tolerance::JERK_MARGIN)
        };
        let over = |shortest: f64| std::array::from_fn(|k| jerk_with(k, ticks(ramps[k]).min(shortest)));
        let j: [f64; 4] = over(f64::INFINITY);
        let shared: [f64; 4] = over(ticks(if axis.tr_geom == 0 { axis.tr_min } else { axis.tr_geom }));
        let longest = ramps.into_iter().map(ticks).fold(0.0, f64::max);
        let weight =
            if axis.a_trans_weight == 0 { 1.0 / longest } else { f64::from(axis.a_trans_weight) * 1e-3 };
        let shortest = ramps.into_iter().map(ticks).fold(f64::INFINITY, f64::min);
        let a_max = acceleration(axis.a_max);
        let jerk = shared.into_iter().fold(f64::INFINITY, f64::min);
        // A corner that counts as rounding of coordinates acts in addition to the slope's acceleration.
        let beside = if slope == 0 { a_max } else { a_max - SMOOTH * jerk };
        let (a_up, a_down) = (a_up.min(beside), a_down.min(beside));
        let peak = if slope == 2 { std::f64::consts::FRAC_PI_2 } else { 1.0 };
        let near = (peak * j.into_iter().fold(0.0, f64::max)).min(JOINT * jerk);
        let left = if slope == 3 { a_max } else { a_max - near / 3.0 };
        let free_knee = axis.a_trans_weight > 0;
        let most = if free_knee && slope != 3 { left } else { KNEE * a_max };
        let part = if axis.r_trans_weight == 0 { 1.0 } else { f64::from(axis.r_trans_weight) * 1e-3 };
        let mut limits = Self {
            v: f64::from(v) * 1e-3 * cycle * keep,
            a_up,
            a_down,
            j,
            up: accelerate,
            down: brake,
            change_over: f64::from(change_over.min(axis.vb_max)) * 1e-3 * cycle * keep,
            jerk,
            knee: (a_up.min(a_down) * weight).min(most),
            free_knee,
            bend: if channel.corr_v_trans_jerk { part * JOINT * jerk } else { f64::INFINITY },
            beside_turn: [left, near / 2.0],
            a_beside: (1.0 - if shortest < LONG_RAMP { KNEE } else { KNEE * SLIGHT }) * a_max,
            a_max,
        };
        if slope == 0 {
            let least = accelerate.into_iter().chain(brake).fold(f64::INFINITY, f64::min);
            limits.knee = least.min(KNEE * a_max);
            limits.jerk = limits.knee / JOINT;
            (limits.free_knee, limits.bend) = (false, f64::INFINITY);
            limits.a_beside = (1.0 - KNEE) * a_max;
        }
        limits
    }

    fn least(&self) -> f64 {
        self.up.into_iter().chain(self.down).fold(f64::INFINITY, f64::min)
    }
}

/// A machine's axes, at feed and in rapid motion.
#[derive(Clone, Debug)]
pub struct Machine {
    feed: Vec<AxisLimits>,
    rapid: Vec<AxisLimits>,
    cycle_us: u32,
    slope: u8,
}

impl Machine {
    /// From its data.
    pub fn new(axes: &[AxisData], channel: &ChannelData) -> Self {
        let (cycle_us, slope) = (channel.cycle_us, channel.slope_profile);
        let of = |rapid| axes.iter().map(|a| AxisLimits::new(a, channel, rapid)).collect();
        Self { feed: of(false), rapid: of(true), cycle_us, slope }
    }

    fn axes(&self, rapid: bool) -> &[AxisLimits] {
        if rapid { &self.rapid } else { &self.feed }
    }

    /// Limits of one block; of an arc with the radians from where its circle begins to its end.
    pub fn block(&self, element: &Element, turn: f64) -> BlockLimits {
        let axes = self.axes(element.feed.is_none());
        let shares = shares(element);
        let least = |limit: &dyn Fn(&AxisLimits) -> f64| {
            let each = axes.iter().zip(&shares).filter(|(_, d)| **d > 0.0);
            each.map(|(axis, d)| limit(axis) / d).fold(f64::INFINITY, f64::min)
        };
        let keep = 1.0 - tolerance::SPEED_MARGIN;
        let feed = element.feed.map_or(f64::INFINITY, |f| f / 60.0 * f64::from(self.cycle_us) * 1e-6 * keep);
        let arc = match &element.shape {
            Shape::Arc { axes, .. } => axes.to_vec(),
            Shape::Line => Vec::new(),
        };
        let change_over = least(&|a| a.change_over);
        // Axes that are slower than their own change-over at that speed, always or within an arc, need both.
        let above = |of: &dyn Fn(&AxisLimits) -> [f64; 2]| {
            let each = axes.iter().zip(&shares).enumerate().filter(|(_, (_, d))| **d > 0.0);
            let upper = each.map(|(k, (axis, d))| {
                let [lower, upper] = of(axis);
                let both = arc.contains(&k) || axis.change_over / d > change_over * (1.0 + 1e-6);
                (if both { lower.min(upper) } else { upper }) / d
            });
            upper.fold(f64::INFINITY, f64::min)
        };
        // The mean jerk of a ramp with the highest jerk 1.
        let mean = if self.slope == 2 { std::f64::consts::FRAC_2_PI } else { 1.0 };
        let mut limits = BlockLimits {
            slope: self.slope,
            upper: [change_over, above(&|a| a.up), above(&|a| a.down)],
            v: least(&|a| a.v).min(feed),
            a_up: least(&|a| a.a_up),
            a_down: least(&|a| a.a_down),
            j: std::array::from_fn(|k| least(&|a| a.j[k])),
            j_beside: mean * JOINT * least(&|a| a.jerk),
            a_beside: least(&|a| a.a_beside),
            v_beside: f64::INFINITY,
            passing: f64::INFINITY,
        };
        if let Shape::Arc { axes: plane, radius, .. } = &element.shape {
            let share = shares[plane[0]];
            let curvature = share * share / radius[0].min(radius[1]);
            let both =
                |limit: &dyn Fn(&AxisLimits) -> f64| limit(&axes[plane[0]]).min(limit(&axes[plane[1]]));
            let (mut a_max, jerk) = (both(&|a| a.a_max), both(&|a| a.jerk));
            let mut normal = both(&|a| a.a_up.min(a.a_down));
            let stepped = self.slope == 0;
            if stepped {
                (a_max, normal) = ((1.0 - KNEE) * a_max, both(&AxisLimits::least));
            }
            let is_free = !stepped && both(&|a| a.bend) == f64::INFINITY;
            // At that speed v³κ² takes all of B.
            let whole = if stepped { f64::INFINITY } else { (jerk * share / (curvature * curvature)).cbrt() };
            limits.v = limits.v.min(ARC_HIGHEST * whole);
            limits.v = limits.v.min((normal.min(ACROSS * a_max) / curvature).sqrt());
            let mut counted = FRAC_PI_4;
            while counted < ARC_MOST_TURNS && 2.0 * counted <= turn * ARC_NEARLY {
                counted *= 2.0;
            }
            let counted = if stepped { counted.max(TAU) } else { counted };
            let length = counted * share / curvature;
            let at = |v: f64| {
                let mut with = BlockLimits { v, ..limits };
                let across = v * v * curvature;
                with.lower((a_max * a_max - across * across).max(0.0).sqrt() / share);
                if !stepped {
                    let level = ARC_LEVELS.iter().rev().find(|level| v <= level[0] * whole);
                    let [against, along] = level.map_or([0.0; 2], |level| [level[1], level[2]]);
                    let unit = mean * jerk / share;
                    for (j, part) in with.j.iter_mut().zip([along, against, against, along]) {
                        *j = j.min(part * unit);
                    }
                }
                with
            };
            // From rest to rest, or with one end at the speed.
            let time = |with: &BlockLimits| {
                let rise = Change::new(0.0, with.v, with.accelerate());
                let (takes, way) = (rise.time(), rise.distance);
                if is_free {
                    length / with.v + takes - way / with.v
                } else if 2.0 * way <= length {
                    2.0 * takes + (length - 2.0 * way) / with.v
                } else {
                    2.0 * takes * (length / (2.0 * way)).cbrt()
                }
            };
            let tried = if counted * ARC_NEARLY >= ARC_TURNS { 2 } else { ARC_SPEEDS.len() };
            let first = at(limits.v);
            let unchanged = (first.a_up, first.a_down, first.j) == (limits.a_up, limits.a_down, limits.j);
            let tried = if unchanged { 1 } else { tried };
            let (mut best, mut shortest) = (first, time(&first));
            for with in ARC_SPEEDS[1..tried].iter().map(|part| at(limits.v * part)) {
                if time(&with) < ARC_CLEARLY * shortest {
                    (best, shortest) = (with, time(&with));
                } else if ARC_CLEARLY * time(&with) > shortest {
                    break;
                }
            }
            limits = best;
            limits.lower(limits.a_up.min(limits.a_down));
            if !stepped {
                limits.j_beside = limits.j_beside.min(mean * ARC_SLOPE * jerk / share);
                limits.v_beside = ARC_TURN.cbrt() * whole;
                let steepest = limits.j.into_iter().fold(0.0, f64::max) / mean;
                let both = steepest * share + curvature * curvature / share * limits.v.powi(3);
                limits.passing =
                    SURELY * (jerk * jerk - both * both).max(0.0).sqrt() / (3.0 * limits.v * curvature);
            }
        }
        limits.leave_distance();
        limits
    }

    /// Highest speed of a block with any override: that of the machine, up to twice the feed. That of an arc
    /// follows from its feed.
    pub fn overridden(&self, element: &Element, turn: f64) -> f64 {
        let v = self.block(element, turn).v;
        if element.shape != Shape::Line || element.feed.is_none() {
            return v;
        }
        let axes = self.feed.iter().zip(shares(element)).filter(|(_, d)| *d > 0.0);
        axes.map(|(axis, d)| axis.v / d).fold(2.0 * v, f64::min)
    }

    /// Whether a transition is smooth except for rounding, if it is passed at the speed `fastest`.
    pub fn slight(&self, before: &Element, after: &Element, fastest: f64) -> bool {
        let axes = self.axes(before.feed.is_none() && after.feed.is_none());
        let (end, begin) = (direction(before, 1.0), direction(after, 0.0));
        axes.iter().enumerate().all(|(k, axis)| {
            let knee = fastest * (begin.tangent[k] - end.tangent[k]).abs();
            let bend = fastest * fastest * (begin.curvature[k] - end.curvature[k]).abs();
            let part = JOINT * axis.jerk;
            knee <= SLIGHT * part.min(axis.knee) && bend <= SLIGHT * part
        })
    }

    /// Whether the acceleration `a` along the path may change direction with the path at a transition.
    pub fn turns_little(&self, before: &Element, after: &Element, a: f64) -> bool {
        let axes = self.axes(before.feed.is_none() && after.feed.is_none());
        let (end, begin) = (direction(before, 1.0).tangent, direction(after, 0.0).tangent);
        axes.iter()
            .zip(end.iter().zip(&begin))
            .all(|(axis, (t0, t1))| a * (t1 - t0).abs() <= TURN * axis.jerk)
    }

    /// Highest speed at which the steps of speed and acceleration at a transition stay unnoticeable on every
    /// axis.
    pub fn unseen(&self, before: &Element, after: &Element) -> f64 {
        let axes = self.axes(before.feed.is_none() && after.feed.is_none());
        let (end, begin) = (direction(before, 1.0), direction(after, 0.0));
        let smooth = if self.slope == 0 { STEP_SMOOTH } else { SMOOTH };
        let speeds = axes.iter().enumerate().map(|(k, axis)| {
            let knee = (begin.tangent[k] - end.tangent[k]).abs();
            let bend = (begin.curvature[k] - end.curvature[k]).abs();
            let bend = if axis.bend == f64::INFINITY { 0.0 } else { bend };
            (smooth * axis.jerk / knee).min((smooth * axis.jerk / bend).sqrt())
        });
        speeds.fold(f64::INFINITY, f64::min) * (1.0 - tolerance::SPEED_MARGIN)
    }

    /// Highest speed at which the step of acceleration from the end of a block to the start of another one
    /// keeps the jerk of a transition, if less than a tick lies between them.
    pub fn bending(&self, before: &Element, after: &Element) -> f64 {
        let axes = self.axes(before.feed.is_none() && after.feed.is_none());
        let (end, begin) = (direction(before, 1.0).curvature, direction(after, 0.0).curvature);
        let bends = end.iter().zip(&begin).map(|(c0, c1)| (c1 - c0).abs());
        let squares = axes.iter().zip(bends).map(|(axis, bend)| JOINT * axis.jerk / bend);
        squares.fold(f64::INFINITY, f64::min).sqrt() * (1.0 - tolerance::SPEED_MARGIN)
    }

    /// How the axes turn between two elements.
    pub fn turns(&self, [before, after]: [&Element; 2]) -> Vec<Turn> {
        let axes = self.axes(before.feed.is_none() && after.feed.is_none());
        let (end, begin) = (direction(before, 1.0).tangent, direction(after, 0.0).tangent);
        let most =
            |axis: &AxisLimits| if axis.free_knee { axis.knee } else { axis.knee.min(JOINT * axis.jerk) };
        let each = axes.iter().zip(end.iter().zip(&begin));
        each.map(|(axis, (t0, t1))| Turn { by: t1 - t0, most: most(axis) }).collect()
    }

    /// Largest step of speed that never shows, mm/tick.
    pub fn unseen_knee(&self, rapid: bool) -> f64 {
        SMOOTH * self.axes(rapid).iter().map(|axis| axis.jerk).fold(f64::INFINITY, f64::min)
    }

    /// Highest speed of a transition, if neither neighbouring block is faster than `fastest`, with
    /// accelerations up to `most`; `None` if the transition is smooth.
    pub fn joint(&self, before: &Element, after: &Element, fastest: f64, most: f64) -> Option<f64> {
        let axes = self.axes(before.feed.is_none() && after.feed.is_none());
        let shorter = path_length(before).min(path_length(after));
        let (end, begin) = (direction(before, 1.0), direction(after, 0.0));
        let mut v = f64::INFINITY;
        for (k, axis) in axes.iter().enumerate() {
            let knee = (begin.tangent[k] - end.tangent[k]).abs();
            let bend = (begin.curvature[k] - end.curvature[k]).abs();
            // Steps too small to be noticed, at any speed of the transition.
            let smooth = if self.slope == 0 { STEP_SMOOTH } else { SMOOTH };
            let unseen = |step: f64| step <= smooth * axis.jerk;
            let knee = if unseen(fastest * knee) { 0.0 } else { knee };
            let bend = if self.slope == 0 || unseen(fastest * fastest * bend) { 0.0 } else { bend };
            let counts = bend > 0.0 && axis.bend < f64::INFINITY;
            let part = match axis.free_knee {
                true => axis.knee,
                false if counts => 0.5 * JOINT * axis.jerk,
                false => JOINT * axis.jerk,
            };
            if knee > 0.0 {
                // Alone, if no other transition follows within three ticks; else up to 2 + 2/h of them, h
                // ticks apart.
                let alone = part.min(axis.knee) / knee;
                // With STEP speed is gained from the transition on: 3 v + 4.5 a in three ticks (of L at most,
                // in two steps), to √(v² + aL) in the middle of a block.
                let a = if self.slope == 0 { most } else { 0.0 };
                let slow = shorter
                    * match shorter / a {
                        ratio if ratio == f64::INFINITY => 1.0 / 3.0,
                        45.0.. => 0.3,
                        9.0.. => 1.0 / 6.0,
                        _ => 0.0,
                    };
                // v √(v² + aL) = part L / 4 knee
                let product = 0.25 * part * shorter / knee;
                let half = 0.5 * a * shorter;
                let close = (product / (half + half.hypot(product)).sqrt()).min(0.25 * part / knee);
                v = v.min(alone.min(slow).max(alone.min(close)));
            }
            let curvature = begin.curvature[k].abs().max(end.curvature[k].abs());
            if knee > 0.0 && curvature > 0.0 && self.slope != 0 {
                // knee·v + curvature·(v + gained)² = left
                let [left, gained] = axis.beside_turn;
                let root = (knee * knee + 4.0 * curvature * left).sqrt();
                let together = 2.0 * left / (knee + root) - gained;
                v = v.min(together.max((left - ACROSS * axis.a_max) / knee).max(0.0));
            }
            if counts {
                let part = if knee > 0.0 { 0.5 * axis.bend } else { axis.bend };
                v = v.min((part / bend).sqrt());
            }
        }
        if v == f64::INFINITY { None } else { Some(v * (1.0 - tolerance::SPEED_MARGIN)) }
    }
}

/// Change of an axis at a transition.
#[derive(Clone, Copy, Debug)]
pub struct Turn {
    /// Change of its direction.
    pub by: f64,
    /// Step of speed that it may take there.
    pub most: f64,
}

/// First and second derivative of every axis over the path length.
struct Direction {
    tangent: Vec<f64>,
    curvature: Vec<f64>,
}

fn direction(element: &Element, u: f64) -> Direction {
    let length = path_length(element);
    let tangent = element.derivative(u).into_iter().map(|d| d / length).collect();
    let mut curvature = vec![0.0; element.from.len()];
    if let Shape::Arc { axes, radius, angle, sweep, .. } = &element.shape {
        let turn = sweep / length;
        let r = radius[0] + (radius[1] - radius[0]) * u;
        let (sin, cos) = (angle + sweep * u).sin_cos();
        curvature[axes[0]] = -r * turn * turn * cos;
        curvature[axes[1]] = -r * turn * turn * sin;
    }
    Direction { tangent, curvature }
}

/// Length to which a block's speeds refer: that of the feed axes; if no feed axis moves, that of the main
/// axes, then of all others. If an axis moves more than 1024 times as far, a 1024th of its travel; if the
/// feed axes are not the main axes, a 64th. An arc whose radius changes counts with its larger radius.
pub fn path_length(element: &Element) -> f64 {
    let along = |axes: &[usize]| match &element.shape {
        Shape::Line => axes.iter().map(|&k| element.travel(k).powi(2)).sum::<f64>().sqrt(),
        Shape::Arc { axes: plane, radius, sweep, .. } => {
            let others = axes.iter().filter(|k| !plane.contains(k)).map(|&k| element.travel(k).powi(2));
            let turn = (radius[0].max(radius[1]) * sweep).powi(2);
            (turn + (radius[1] - radius[0]).powi(2) + others.sum::<f64>()).sqrt()
        }
    };
    let fed = along(&element.feed_axes);
    let path = [fed, along(&element.main)].into_iter().find(|path| *path > 0.0);
    let path = path.unwrap_or_else(|| element.tracking_length());
    let steepest = if fed > 0.0 && element.feed_axes != element.main { 64.0 } else { 1024.0 };
    (0..element.from.len()).map(|k| element.travel(k).abs() / steepest).fold(path, f64::max)
}

/// Largest share of the path speed that each axis can have within the block.
pub fn shares(element: &Element) -> Vec<f64> {
    let length = path_length(element);
    let mut shares: Vec<f64> = (0..element.from.len()).map(|k| element.travel(k).abs() / length).collect();
    if let Shape::Arc { axes, radius, sweep, .. } = &element.shape {
        for &k in axes {
            shares[k] = radius[0].max(radius[1]) * sweep.abs() / length;
        }
    }
    shares
}

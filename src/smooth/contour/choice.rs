//! Selects the kind of curve for a corner: a curve over time, a curve over arc length, or a stop in the
//! corner.
//!
//! | method | possible kinds |
//! |---|---|
//! | DEV, PTP | all three |
//! | DIST_SOFT | curve over time; a stop, unless ACC_MAX is below 100 % |
//! | DIST_MASTER | curve over time |
//! | DIST, POS | curve over arc length |
//!
//! A curve over time needs a corner between two lines, both rapid or both at feed, and a slope other than
//! STEP. With DIST_MASTER, the master axis must have the same speed on both lines. DEV with CONST_VEL and an
//! active transformation exclude a curve over time. If no curve over time is possible, a curve over arc
//! length takes its place.
//!
//! The planner estimates how long each kind takes over all of the path that the corner may use, and selects
//! the quickest. PATH_DEV is an upper limit: curves with a smaller deviation are compared too. This estimate
//! regards one corner alone. By this estimate, a curve of DEV without CONST_VEL never takes longer than a
//! stop, and a smaller PATH_DEV is never quicker.
use super::Parameters;
use super::corner::{Corner, Tolerance};
use super::curve::{Main, Quintic, aside, plus, size};
use super::held_block::HeldBlock;
use super::joining::Setting;
use super::timed::{Overlap, Rise, larger};
use crate::dynamics::Dynamics;
use crate::math::float::{max, min};
use crate::math::root::{cbrt_f32, sqrt_f32};
use crate::nc::{ContourMethod, SlopeType};
use crate::path::Measure;
use crate::slope::limits::Limits;
use crate::slope::ramp::Ramp;

/// The two blocks of a corner. Computes how long the motion takes before, inside and after a curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Approach {
    /// Ramps: from the speed of the first block to the speed in the corner, and from there to the speed of
    /// the second block.
    slopes: [Ramp; 2],
    /// Speeds, mm/tick, and the path of both blocks that the corner may use, mm.
    v: [f32; 2],
    room: [f32; 2],
    /// Limits of speed, acceleration and jerk for both speeding up and braking on each block; `None` with a
    /// slope without jerk limit.
    along: [Option<[f32; 3]>; 2],
}

impl Approach {
    /// Takes the limits of both blocks. `room`: path length of each block that the corner may use, mm.
    pub fn new([first, second]: [&Limits; 2], room: [f32; 2]) -> Self {
        let along = [first.along(), second.along()];
        Self { slopes: [first.brake(), second.speed_up()], v: [first.v, second.v], room, along }
    }

    /// Ticks over all of `room`, with a curve that the motion enters and leaves at the speed `v`. The curve
    /// begins and ends at the distances `c` from the corner, and takes `inside` ticks.
    fn time(&self, v: f32, c: [f32; 2], inside: f32) -> f32 {
        let sides = self.slopes.iter().zip(self.v).zip(self.room.iter().zip(c));
        sides.fold(inside, |sum, ((slope, fastest), (room, c))| {
            let (way, missing) = (max(room - c, 0.0), fastest - v);
            if way <= 0.0 {
                return sum;
            }
            if missing <= 0.0 {
                return sum + way / max(v, f32::MIN_POSITIVE);
            }
            let (mut gain, mut gaining) = (missing, f32::MAX);
            // `slope.reach` needs a root. No root is needed if the path is long enough for the ramp. The ramp
            // is tried only if even full acceleration from its start could reach the speed.
            if (v + 0.5 * missing) * missing <= way * slope.acceleration() {
                gaining = slope.distance(v, gain)[0];
            }
            if gaining > SURELY * way {
                gain = max(min(missing, slope.reach(v, way)), 0.0);
                gaining = slope.distance(v, gain)[0];
            }
            let cruise = max(way - gaining, 0.0);
            sum + slope.duration(v, gain) + cruise / max(v + gain, f32::MIN_POSITIVE)
        })
    }

    /// The factor by which a curve must be quicker than a stop: the accuracy of ramp times. The factor is 1
    /// for STEP, which has no ramps.
    pub fn known(&self) -> f32 {
        if self.along.iter().all(Option::is_some) { KNOWN } else { 1.0 }
    }

    /// Whether a stop in the corner takes fewer ticks than `most`.
    pub fn stops_within(&self, most: f32) -> bool {
        let sides = self.slopes.iter().zip(self.v).zip(self.room);
        // A quick lower bound: the speed exceeds neither the feed nor the speed that full acceleration
        // reaches.
        let least = sides.fold(0.0, |sum, ((slope, v), room)| {
            sum + max(room / v, sqrt_f32(2.0 * room / slope.acceleration()))
        });
        SURELY * least < most && self.time(0.0, [0.0; 2], 0.0) < most
    }

    /// Ticks over all of the path that the corner may use, with a curve over time.
    pub fn overlapping(&self, way: &Overlap) -> f32 {
        self.time(way.rise.v, [way.rise.distance(); 2], way.duration())
    }

    /// Ticks over all of the path that the corner may use, with a curve over arc length. `length`: path
    /// length of the curve, mm; `distances`: corner distances of its ends, mm. The limits of the axes permit
    /// `length * passes` as speed in the curve.
    pub fn even(&self, (length, passes): (f32, f32), distances: [f32; 2]) -> f32 {
        let [v1, v2] = self.v;
        let (even, tight) = (length * passes, self.is_tight(distances));
        let through = if self.along.iter().all(Option::is_some) {
            min(min(v1, v2), even) * if tight { VARYING } else { 1.0 }
        } else {
            min(min(v1, v2), even * if tight { VARYING_STEPPED } else { 1.0 })
        };
        self.time(through, distances, length / through)
    }
}

impl Approach {
    /// The speed that the motion reaches from a stop over the shorter of both lengths in `room`.
    fn reached(&self) -> f32 {
        let [v1, v2] = self.v;
        min(min(v1, v2), self.slopes[0].reach(0.0, min(self.room[0], self.room[1])))
    }

    /// Whether the curve takes nearly all of the path. The speed must then change inside the curve.
    fn is_tight(&self, distances: [f32; 2]) -> bool {
        let beside = self.room.iter().zip(distances).fold(f32::MAX, |least, (room, c)| min(least, room - c));
        beside < LITTLE * max(distances[0], distances[1])
    }

    /// The share of these corner distances that leaves enough path beside the curve for a change of speed.
    /// Returns `None` if the whole distances leave enough.
    pub fn loosened(&self, distances: [f32; 2]) -> Option<f32> {
        let beside = LITTLE * max(distances[0], distances[1]);
        let sides = self.room.iter().zip(distances);
        let part = sides.fold(SURELY, |part, (room, c)| min(part, SURELY * room / (c + beside)));
        self.is_tight(distances).then_some(part)
    }
}

/// If the path next to a curve is at least this share of the corner distance, the speed need not change
/// inside the curve.
const LITTLE: f32 = 0.25;
/// If the path is shorter, the speed in the curve is about this share of the highest speed: (4/5)³.
const VARYING: f32 = 0.512;
/// The same share for STEP, if the curve limits the speed at all: (4/5)².
const VARYING_STEPPED: f32 = 0.64;

/// Accuracy of ramp times, as a factor.
const KNOWN: f32 = 1.0 + 1.0 / 256.0;

/// Margin for rounding.
const SURELY: f32 = 0.999;

/// A curve at less than this share of the speed that the motion reaches from a stop is not quicker than a
/// stop.
const SLOWEST: f32 = 0.25;

/// A corner, and the data for the choice of its curve.
#[derive(Clone, Copy)]
pub struct Choice<'a, const AXES: usize> {
    /// The blocks before and after the corner.
    pub blocks: [&'a HeldBlock<AXES>; 2],
    /// The corner between both blocks.
    pub corner: &'a Corner<'a, AXES>,
    /// The parameters of the program.
    pub rule: &'a Parameters,
    /// Machine, limits and slope.
    pub setting: &'a Setting<'a, AXES>,
    /// Largest distance from the corner, mm.
    pub most: f32,
    /// The tolerances that are left for the curve.
    pub tolerance: &'a Tolerance,
    /// Times of the parts of both blocks before and after a curve.
    pub approach: &'a Approach,
}

impl<const AXES: usize> Choice<'_, AXES> {
    /// Whether the corner is between two lines of rapid motion. Returns `None` if a block is no line, if one
    /// line is rapid and the other is not, or if blocks are left out.
    fn lines(&self) -> Option<bool> {
        let [held, next] = self.blocks;
        let [first, second] = [&held.block, &next.block];
        let rapid = first.data.feed.is_none();
        let straight = held.is_line() && next.is_line() && first.to == second.from;
        let alike = self.setting.skipped.is_none() && rapid == second.data.feed.is_none();
        (straight && alike).then_some(rapid)
    }
}

/// A curve over time for a corner between two lines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Candidate {
    /// Overlap of both motions.
    pub way: Overlap,
    /// Whether no other curve is possible.
    pub only: bool,
    /// Whether the curve uses all of the permitted acceleration. A stop then uses no more acceleration than
    /// the curve.
    pub full: bool,
}

impl Candidate {
    /// The curve over time between two lines, if the method demands or permits it.
    pub fn new<const AXES: usize>(choice: &Choice<'_, AXES>) -> Option<Self> {
        let Choice { corner, rule, setting, most, tolerance, approach, .. } = *choice;
        let dynamics = setting.dynamics;
        if dynamics.is_transformed() {
            return None;
        }
        let led = corner.follows_master(rule, setting.measure);
        let soft = rule.method == ContourMethod::DistSoft || led;
        let quick = match rule.method {
            ContourMethod::Dev => !setting.const_vel,
            ContourMethod::Ptp => true,
            _ => soft,
        };
        let rapid = choice.lines().filter(|_| quick)?;
        let [Some([v1, a1, j1]), Some([v2, a2, j2])] = approach.along else { return None };
        let v = min(v1, v2);
        let (t1, t2) = (corner.before.tangent(), corner.behind.tangent());
        let mut change = plus(t2, -1.0, t1);
        if let (true, Some(x)) = (led, setting.measure.master().and_then(|k| change.get_mut(k))) {
            // Zero except for rounding.
            *x = 0.0;
        }
        // Both motions run at the same time, so the change of direction limits acceleration and jerk.
        let of = match rule.method {
            ContourMethod::Ptp => PART_PTP,
            ContourMethod::Dev => PART_DEV,
            _ => PART,
        };
        let [a, j] = dynamics.together(&change, rapid, of);
        if soft {
            let ramp = max(a / j, dynamics.longest_ramp(&change, rapid));
            let distance = soft_distance(rule, most, &change, setting.measure);
            let (rise, full) = soft_rise(rule, distance, [v, a, j], ramp)?;
            let way = Overlap::whole(rise);
            return way.is_long().then_some(Self { way, only: true, full: full && !led });
        }
        let off = off_corner(&setting.measure.main, &change, tolerance);
        let sharing = Sharing { dynamics, rapid, of, v, most, tangents: [*t1, *t2] };
        let along = [min(a1, a2), min(j1, j2)];
        let way = sharing.overlap(approach, [a, j], along, [off, rule.ptp_distance()]);
        way.is_long().then_some(Self { way, only: false, full: true })
    }
}

/// Two lines for which the motion along the second line starts before the motion along the first line ends.
struct Sharing<'a, const AXES: usize> {
    dynamics: &'a Dynamics<AXES>,
    rapid: bool,
    /// Shares of a_max and of the jerk budget that the curve uses.
    of: [f32; 2],
    /// Highest speed, mm/tick, and largest distance from the corner, mm.
    v: f32,
    most: f32,
    tangents: [[f32; AXES]; 2],
}

impl<const AXES: usize> Sharing<'_, AXES> {
    /// The quickest overlap of both motions. In the middle of the overlap, both motions are at most `off`
    /// (mm) from the corner. The overlap begins at most `reach` (mm) before the corner. `a`, `j`:
    /// acceleration and jerk that the change of direction permits; `a_along`, `j_along`: those that both
    /// lines permit.
    fn overlap(
        &self,
        approach: &Approach,
        [a, j]: [f32; 2],
        [a_along, j_along]: [f32; 2],
        [off, reach]: [f32; 2],
    ) -> Overlap {
        let &Self { dynamics, rapid, of, v, most, tangents: [t1, t2] } = self;
        let whole = Rise::within(most, v, a, j);
        let quickest = |a: Overlap, b: Overlap| {
            if approach.overlapping(&b) < approach.overlapping(&a) { b } else { a }
        };
        let half_way = whole.half_way();
        if half_way <= off && whole.distance() <= reach {
            let distance = whole.distance();
            // At the feed speed, the least acceleration that the tolerance permits takes the same time.
            let most = min(off / half_way, min(most, reach) / distance);
            let by = if most < 1.0 { 1.0 } else { most };
            Overlap::whole(whole.stretched(by))
        } else {
            let alone = [t1, t2].map(|t| dynamics.together(&t, rapid, of));
            let [_, j_sum] = dynamics.together(&plus(&t1, 1.0, &t2), rapid, of);
            let brief = alone
                .iter()
                .fold([a_along, min(j_along, j_sum)], |[a, j], alone| [min(a, alone[0]), min(j, alone[1])]);
            let overlap = |[a, j]: [f32; 2]| {
                let rise = Rise::within(most, v, a, j);
                let (by_off, by_reach) = (Overlap::off(rise, off), Overlap::from_distance(rise, reach));
                if by_off.time < by_reach.time { by_off } else { by_reach }
            };
            let way = overlap(brief);
            // If more than the ramps overlap, both motions share the limits of the axes. A smaller tolerance
            // may then be quicker.
            let way = if way.is_brief() {
                way
            } else {
                quickest(overlap([min(brief[0], a), min(brief[1], j)]), way.brief())
            };
            // If the lines are too short for their feed, a lower speed may also be quicker: then both motions
            // overlap completely.
            let slower = min(v, Rise::speed_of(off, a, j));
            if slower < SLOWEST * approach.reached() {
                way
            } else {
                let whole = Overlap::whole(Rise::within(min(most, reach), slower, a, j));
                quickest(way, whole)
            }
        }
    }
}

/// A corner between two lines under `#HSC [SURFACE]`. Contour mode rounds the corner if this is quicker than
/// a smoothing curve of Surface.
pub struct Edge<'a, const AXES: usize> {
    pub dynamics: &'a Dynamics<AXES>,
    pub rapid: bool,
    pub tangents: [[f32; AXES]; 2],
    pub limits: [&'a Limits; 2],
    /// Half of both lines, mm.
    pub room: [f32; 2],
}

impl<const AXES: usize> Edge<'_, AXES> {
    /// Ticks over both lines with a smoothing curve of Surface. The curve begins `half` (mm) before the
    /// corner and has the speed `v` (mm/tick).
    fn kernel(&self, approach: &Approach, (v, half): (f32, f32)) -> f32 {
        let [first, second] = self.limits;
        let (v, c) = (min(v, min(first.v, second.v)), min(half, min(self.room[0], self.room[1])));
        approach.time(v, [c; 2], 2.0 * c / max(v, f32::MIN_POSITIVE))
    }

    /// Whether a stop takes fewer ticks than a smoothing curve of Surface. `kernel`: speed in that curve
    /// (mm/tick), and distance from its start to the corner (mm).
    #[inline(never)]
    pub fn stands(&self, kernel: (f32, f32)) -> bool {
        let approach = Approach::new(self.limits, self.room);
        approach.stops_within(self.kernel(&approach, kernel))
    }

    /// Whether contour mode takes fewer ticks than a smoothing curve of Surface (`kernel`: see
    /// [`Self::stands`]). Contour mode either stops in the corner, or makes a curve of DEV; in its middle,
    /// both motions are `off` (mm) from the corner.
    #[inline(never)]
    pub fn is_quicker(&self, off: f32, kernel: (f32, f32)) -> bool {
        let &Self { dynamics, rapid, tangents, room, .. } = self;
        let approach = Approach::new(self.limits, room);
        let kernel = KERNEL * self.kernel(&approach, kernel);
        if approach.stops_within(kernel) {
            return true;
        }
        let [Some([v1, a1, j1]), Some([v2, a2, j2])] = approach.along else { return false };
        let [t1, t2] = &tangents;
        let of_change = dynamics.together(&plus(t2, -1.0, t1), rapid, PART_DEV);
        let sharing =
            Sharing { dynamics, rapid, of: PART_DEV, v: min(v1, v2), most: min(room[0], room[1]), tangents };
        let way = sharing.overlap(&approach, of_change, [min(a1, a2), min(j1, j2)], [off, f32::MAX]);
        approach.overlapping(&way) < kernel
    }
}

/// A smoothing curve among many is quicker than a single one. A change to contour mode and back costs this
/// factor of its time.
const KERNEL: f32 = 1.33;

/// The corner distance of the curve at a shallow corner between two lines, mm, equal on both sides; `None` if
/// the corner gets another curve. This curve has the least jerk ([`super::kernel`]). DEV with HSC takes this
/// curve if all of both blocks lies inside the tolerance. The acceleration need not be zero in the curve, so
/// many short lines become one motion. Longer lines are quicker with curves over time, because their speed
/// changes before and after these curves.
pub fn shallow_distance<const AXES: usize>(choice: &Choice<'_, AXES>) -> Option<f32> {
    let Choice { corner, rule, setting, most, tolerance, approach, .. } = *choice;
    let dev = rule.method == ContourMethod::Dev && !setting.const_vel;
    if !dev || setting.dynamics.slope() != SlopeType::Hsc {
        return None;
    }
    let [Some([_, a, j]), Some(_)] = approach.along else { return None };
    if BRIEF * most * j * j > a * a * a {
        return None;
    }
    choice.lines()?;
    let change = plus(corner.behind.tangent(), -1.0, corner.before.tangent());
    let off = off_corner(&setting.measure.main, &change, tolerance);
    (size(&setting.measure.main, &change) <= SHALLOW && 6.0 * off >= most).then_some(most)
}

/// Divisor of a³/j²: a corner distance below a³/(5·j²) is short. From a stop, a ramp with the jerk j reaches
/// the acceleration a after the distance a³/(6·j²).
const BRIEF: f32 = 5.0;
/// Largest change of direction of a shallow corner, rad.
const SHALLOW: f32 = 0.05;

/// Distance from the corner at which a curve of DIST_SOFT begins, mm; at most `most`.
fn soft_distance<const AXES: usize>(
    rule: &Parameters,
    most: f32,
    change: &[f32; AXES],
    measure: &Measure,
) -> f32 {
    let distance = rule.distances([most; 2])[0];
    if tracks(&measure.main, change) { min(distance, rule.track_distance()) } else { distance }
}

/// Largest distance (mm) of both motions from the corner in the middle of the curve, where both are equally
/// far from the corner. With this distance, the curve keeps the tolerances, with a small margin.
fn off_corner<const AXES: usize>(main: &Main, change: &[f32; AXES], tolerance: &Tolerance) -> f32 {
    let off = tolerance.path.map_or(f32::MAX, |dev| dev * EXACT / size(main, change));
    let turn = aside(main, change);
    if tolerance.track > 0.0 && turn > 0.0 { min(off, tolerance.track * EXACT / turn) } else { off }
}

/// Largest magnitudes of the second and third derivative of a curve at the examined places.
pub fn bends<const AXES: usize>(curve: &Quintic<AXES>) -> [[f32; AXES]; 2] {
    let mut most = [[0.0; AXES]; 2];
    for u in PLACES {
        let [second, third] = most;
        most = [larger(&second, &curve.second(u)), larger(&third, &curve.third(u))];
    }
    most
}

/// Examined places of a curve, as shares of its parameter.
const PLACES: [f32; 5] = [0.0, 0.25, 0.5, 0.75, 1.0];

/// Approximate speed that the limits of the axes permit along a curve with these second and third
/// derivatives.
pub fn passes<const AXES: usize>(
    [second, third]: &[[f32; AXES]; 2],
    rapid: bool,
    setting: &Setting<'_, AXES>,
) -> f32 {
    let dynamics = setting.dynamics;
    if dynamics.slope() == SlopeType::Step {
        let [a, _] = dynamics.together(second, rapid, [Dynamics::<AXES>::STEPPED_NORMAL_PART; 2]);
        return sqrt_f32(min(a, UNLIMITED));
    }
    let [a, _] = dynamics.together(second, rapid, [1.0; 2]);
    let j = dynamics.across(third, rapid, setting.check_jerk);
    min(sqrt_f32(NORMAL * min(a, UNLIMITED)), cbrt_f32(TWISTED * min(j, UNLIMITED)))
}

/// Whether axes other than main axes change their direction.
fn tracks<const AXES: usize>(main: &Main, change: &[f32; AXES]) -> bool {
    change.iter().enumerate().any(|(k, x)| *x != 0.0 && !main.contains(k))
}

/// Jerk that counts as unlimited, mm/tick³.
const UNLIMITED: f32 = 1e6;

/// Share of a tolerance that is used.
const EXACT: f32 = 1.0 - 1.0 / 16_384.0;

/// Shares of the axes' largest acceleration and of their jerk budget for a curve over time. The rest is for
/// changes of path speed inside the curve, mainly for a feed hold. With a smaller rest, a feed hold takes
/// longer. PTP has other shares for the shortest time.
const PART: [f32; 2] = [0.93, 0.85];
/// Shares for DEV, which competes with stops. At a small tolerance, a curve must not lose more time than a
/// stop saves. A feed hold must take at most 1.3 s in the corners of `host-tests/tests/commands/hold.rs`.
const PART_DEV: [f32; 2] = [0.95, 0.905];
/// Shares for PTP; see [`PART`].
const PART_PTP: [f32; 2] = [0.975, 0.96];

/// Share of acceleration and jerk for a curve over arc length; slightly lower.
const NORMAL: f32 = 0.932;
const TWISTED: f32 = 0.866;

/// Smallest share of the acceleration for DIST_SOFT.
const GENTLEST: f32 = 0.01;

/// DIST_SOFT: the rise with the least acceleration, between ACC_MIN and ACC_MAX, that changes the speed
/// within `distance`. If ACC_MAX is not enough, the speed is lower. `ramp`: longest ramp time of the axes
/// that change their speed, ticks. The second result tells whether the rise uses all of the acceleration.
fn soft_rise(rule: &Parameters, distance: f32, [v, a, j]: [f32; 3], ramp: f32) -> Option<(Rise, bool)> {
    let [least, most] = rule.acc;
    let ramp = max(rule.ramp_time, 1e-4) * ramp;
    // D = v·T/2 with T = v/a' + ramp, or 2·√(v·ramp/a') if a' is not reached.
    let mut part = v * v * v * ramp / (a * distance * distance);
    let hold = distance - 0.5 * v * ramp;
    if v > part * a * ramp && hold > 0.0 {
        part = v * v / (2.0 * a * hold);
    }
    // 0 % counts as 1 %, the gentlest value.
    let part = min(max(part, least), max(most, GENTLEST));
    if part <= 0.0 || distance <= 0.0 {
        return None;
    }
    let a = part * a;
    Some((Rise::within(distance, v, a, min(a / ramp, j)), part >= 1.0))
}

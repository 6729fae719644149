//! The shortest stop that the axes permit along the path ahead.
//!
//! The planned limits of a span are for its highest speed, and for the place with the strongest curvature. A
//! stop uses only a part of the span, at a falling speed. So the axes may permit more deceleration than these
//! limits. What the axes permit at a place depends on the speed there. This speed in turn depends on the
//! deceleration before. So the profile is found in rounds:
//!
//! 1. The first round makes a profile with the deceleration and jerk that the axes permit at the start of the
//!    stop.
//! 2. Each round checks a few speeds of its profile, each at the place where the profile has this speed.
//! 3. If the axes do not permit the profile at one of these places, the next round uses lower values.
//!
//! One call of the planner makes one round, or a few rounds if the path of the stop has few curves
//! (`search`).
use super::descent::{CLOSE, Cursor, Descent, SPANS, Stretch};
use super::search::{LAW_COSTS, WALK, curve_costs, part_costs};
use super::{Brake, Instant, Planning, Speed};
use crate::dynamics::{Braking, Passed};
use crate::lookahead::ReleasedSpan;
use crate::math::float::{max, min, to_bits, to_f32};
use crate::path::Swings;
use crate::quantity::{speed_bits, speed_f32};
use crate::slope::brake::SHORT;
use crate::slope::limits::{Limits, SlopeLaw};

/// Speeds at the starts of the parts of a stop and at its end, as ratios to the highest speed.
type Speeds = [f32; PARTS + 1];
/// Number of parts, and number of the part with which the second stage of STEP begins.
const PARTS: usize = 7;
const STAGE: usize = 3;
/// Speeds down to a stop. The second row is for STEP: down to half the speed, where the next profile begins.
const STANDS: Speeds = [1.0, 0.95, 0.85, 0.7, 0.5, 0.3, 0.12, 0.0];
const SLOWS: Speeds = [1.0, 0.95, 0.9, 0.8, 0.7, 0.6, 0.55, 0.5];
/// STEP uses one profile for a stop that is up to this many times longer than with the limits at its start.
const NEARLY: f32 = 1.2;
/// The same factor for other slopes; a longer stop has several profiles.
const FAIRLY: f32 = 3.0;
/// Largest number of rounds.
const ROUNDS: usize = 8;
/// Number of ticks in which the step of a knee acts.
const KNEE_TICKS: i64 = 2;

/// A part of a stop. `v`: its highest speed. `change`: difference of its speeds to the highest speed of the
/// stop, and to the last speed. `ramps`: whether the deceleration rises in it, and whether the deceleration
/// falls. `gains`: whether an acceleration falls in it. `until`: path distance of its end.
#[derive(Clone, Copy)]
struct Part {
    v: f32,
    change: [f32; 2],
    ramps: [bool; 2],
    gains: bool,
    until: i64,
}

impl Part {
    /// An empty part.
    const BLANK: Self = Self { v: 0.0, change: [0.0; 2], ramps: [true; 2], gains: true, until: 0 };
}

/// The reason why there is no short stop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum No {
    /// The stop within the limits of the spans is as short.
    Shorter,
    /// No single profile reaches a stop.
    Law,
}

/// State after this round.
#[derive(Clone, Copy, Debug)]
struct Rounds {
    count: usize,
    are_over: bool,
    /// The limits of the next round. Also the limits of the round before, and what the axes then permitted.
    braking: Braking,
    before: Option<[Braking; 2]>,
    /// Path of the first profile, mm; no stop is shorter.
    nearest: f32,
}

impl Rounds {
    const NONE: Self =
        Self { count: 0, are_over: false, braking: Braking::WIDEST, before: None, nearest: 0.0 };
}

/// The search for the shortest stop, between two calls.
#[derive(Clone, Copy, Debug)]
pub(super) struct Short {
    /// Path distance of the end of the first span, and path distance up to which a deceleration may continue.
    ends: [i64; 2],
    /// Length of the known stop, mm; a longer one is useless.
    way: f32,
    /// STEP: whether a braking to half the speed is searched.
    slows: bool,
    rounds: Rounds,
    /// The profile of a stop, and the ratio of its length to the length with the limits at its start.
    stands: Result<(Braking, f32), No>,
}

impl Short {
    /// No search.
    pub const NONE: Self =
        Self { ends: [0; 2], way: 0.0, slows: false, rounds: Rounds::NONE, stands: Err(No::Law) };

    /// STEP: whether another braking is searched, because no single profile stops, or the stop is much
    /// longer.
    fn goes_on(&self, begin: &Begin) -> bool {
        let is_near = self.stands.is_ok_and(|(_, needs)| needs <= NEARLY);
        begin.is_stepped() && !is_near && !self.rounds.are_over
    }
}

/// The start of a stop.
struct Begin {
    cursor: Cursor,
    /// Number of the first curve.
    curve: u32,
    /// Path distances of the starts of the first curve and of the next one.
    curve_starts: [i64; 2],
    is_line: bool,
    /// Whether the stop begins near the start of its first span.
    starts: bool,
    /// Limits of the first span.
    planned: Limits,
    /// Highest speed.
    v: f32,
    /// Deceleration at the start of the stop.
    begun: f32,
    /// Acceleration at the start of the stop; 0 with STEP.
    gains: f32,
}

impl Begin {
    /// Whether the slope is STEP.
    const fn is_stepped(&self) -> bool {
        matches!(self.planned.law, SlopeLaw::Stepped { .. })
    }

    /// Limits of a profile with these speeds.
    fn limits(&self, braking: &Braking, speeds: &Speeds) -> Limits {
        let ends = if self.gains > 0.0 { braking.ends } else { 0.0 };
        self.planned.braked(braking.a, speeds[STAGE] * self.v, braking.j, ends)
    }
}

impl<const AXES: usize, const BLOCKS: usize> Planning<'_, AXES, BLOCKS> {
    /// Begins the search for a stop from `motion` by one profile. The axes permit this profile along its own
    /// path. Returns an error if there is no such stop, or if the dynamics have changed since those blocks
    /// entered. Unless `surely` is true, the function also returns an error if the limits of the spans permit
    /// a stop that is as short.
    #[inline(never)]
    pub(super) fn begin_short(
        &self,
        cursor: &Cursor,
        span: &mut ReleasedSpan,
        motion: &Instant,
        surely: bool,
    ) -> Result<Short, No> {
        let begin = self.begin_way(cursor, span, motion).ok_or(No::Law)?;
        let (now, ends, mut way) = self.as_planned(*cursor, span, motion).ok_or(No::Law)?;
        // For several blocks, the limits are those of the most restrictive block.
        if begin.is_line && !now.is_many && Brake::fits(motion, ends[0], &now.limits, CLOSE) {
            return Err(No::Shorter);
        }
        if surely {
            way = f32::MAX;
        }
        Ok(Short { ends, way, slows: false, rounds: Rounds::NONE, stands: Err(No::Law) })
    }

    // The following functions are not inlined, so that only one of their stack frames exists at a time.

    /// Does one round, or after the rounds makes the found profile with its spans. Returns `Ok(false)` if the
    /// search continues. The emitter's profile holds the result.
    #[inline(never)]
    pub(super) fn go_on_short(
        &mut self,
        cursor: &Cursor,
        span: &mut ReleasedSpan,
        (motion, descent): (&Instant, &mut Descent),
        short: &mut Short,
    ) -> Result<bool, No> {
        // A reference, here and below: a value would be on the stack twice.
        let begun = self.begin_way(cursor, span, motion);
        let begin = begun.as_ref().ok_or(No::Law)?;
        if let Ok((braking, needs)) = short.stands
            && !short.goes_on(begin)
        {
            return self.take_short(begin, span, (motion, descent), short, (&braking, needs)).map(|()| true);
        }
        let [first, end] = short.ends;
        let aim = if short.slows { (&SLOWS, first, f32::MAX) } else { (&STANDS, end, short.way) };
        let mut brake = Brake::default();
        let found = self.go_round(begin, span, motion, aim, (&mut short.rounds, &mut brake));
        if !short.slows {
            match found {
                Ok(None) => {}
                Ok(Some(found)) => short.stands = Ok(found),
                Err(no) if begin.is_stepped() => short.stands = Err(no),
                Err(no) => return Err(no),
            }
            if found != Ok(None) && short.goes_on(begin) {
                // Down to half the speed within the first span, at least as hard as planned. So every later
                // speed stays possible.
                (short.slows, short.rounds) = (true, Rounds::NONE);
            }
            return Ok(false);
        }
        match found {
            Ok(None) => return Ok(false),
            Ok(Some((braking, _)))
                if brake.v_out > 0
                    && begin.limits(&braking, &SLOWS).brakes_above(&begin.planned)
                    && self.leaves_way(begin.cursor, span, &brake) =>
            {
                *descent = Descent::inside(brake);
                return Ok(true);
            }
            _ => {}
        }
        short.rounds.are_over = true;
        short.stands.map(|_| false)
    }

    /// Makes the found profile with its spans, if no other one is better.
    #[inline(never)]
    fn take_short(
        &mut self,
        begin: &Begin,
        span: &mut ReleasedSpan,
        (motion, descent): (&Instant, &mut Descent),
        short: &Short,
        (braking, needs): (&Braking, f32),
    ) -> Result<(), No> {
        let stepped = begin.is_stepped();
        let most = if stepped && begin.is_line { NEARLY } else { FAIRLY };
        if needs > most && (stepped || short.way == f32::MAX) {
            return Err(No::Law);
        }
        let limits = &begin.limits(braking, &STANDS);
        let braking = (limits, limits.a_down);
        self.orders.search.spend(LAW_COSTS);
        let brake = Brake::down_to(&mut self.profile, motion, short.ends[1], braking, 0).ok_or(No::Law)?;
        self.verify(begin.cursor, span, (motion, descent), (&brake, limits), true).map_err(|_| No::Law)
    }

    /// The data at the start of a short stop.
    #[inline(never)]
    fn begin_way(&self, cursor: &Cursor, span: &mut ReleasedSpan, motion: &Instant) -> Option<Begin> {
        let curve = self.curve_at(motion.distance)?;
        let first = self.queue.segments.recent(curve)?;
        let curve_starts = [curve, curve.wrapping_add(1)].map(|curve| self.queue.segments.start(curve));
        let behind = motion.distance.wrapping_sub(curve_starts[0]);
        let is_line = first.segment.is_line();
        let starts = behind <= KNEE_TICKS * (motion.speed >> 14);
        let planned = self.ahead(&mut cursor.clone(), span, false)?.limits;
        let accel = to_f32(motion.accel) * (1.0 / (1u64 << 58) as f32);
        let v = fastest(speed_f32(motion.speed), accel, &planned);
        let stepped = matches!(planned.law, SlopeLaw::Stepped { .. });
        let begun = if stepped { 0.0 } else { max(-accel, 0.0) };
        let gains = if stepped { 0.0 } else { max(accel, 0.0) };
        Some(Begin { cursor: *cursor, curve, curve_starts, is_line, starts, planned, v, begun, gains })
    }

    /// Does a round for a profile with these speeds. The axes must permit it, before the path distance `end`
    /// and in less than `way` (mm). The last round returns the profile, and the share of the axes' limits
    /// that the profile uses.
    #[inline(never)]
    fn go_round(
        &mut self,
        begin: &Begin,
        span: &mut ReleasedSpan,
        motion: &Instant,
        (speeds, end, way): (&Speeds, i64, f32),
        (rounds, brake): (&mut Rounds, &mut Brake),
    ) -> Result<Option<(Braking, f32)>, No> {
        let Begin { v, begun, .. } = begin;
        let mut parts = [Part::BLANK; PARTS];
        let Rounds { count, braking, nearest, before, .. } = rounds;
        if *count == 0 {
            // Some parts of the profile are in each stage of STEP.
            let mut here = motion.distance;
            for (k, (part, speed)) in parts.iter_mut().zip(speeds).enumerate() {
                if k % STAGE == 0 && k <= STAGE {
                    here = here.wrapping_add(SHORT);
                }
                let v = speed * v;
                *part = Part { v, change: [0.0, v], ramps: [true; 2], gains: true, until: here };
            }
            *count = 1;
            return self.permitted(begin, span, motion, &parts, braking).map(|()| None).ok_or(No::Law);
        }
        if *begun > braking.a[0] || *count > ROUNDS {
            return Err(No::Law);
        }
        *count += 1;
        let limits = &begin.limits(braking, speeds);
        let needs = Brake::needs(motion, limits);
        if needs >= way {
            return Err(No::Shorter);
        }
        *nearest = if *nearest > 0.0 { *nearest } else { needs };
        let (law, to) = ((limits, limits.a_down), speed_bits(speeds[PARTS] * v));
        self.orders.search.spend(LAW_COSTS);
        *brake = Brake::down_to(&mut self.profile, motion, end, law, to).ok_or(No::Law)?;
        self.part(brake, (speeds, *v), &mut parts);
        let mut left = *braking;
        self.permitted(begin, span, motion, &parts, &mut left).ok_or(No::Law)?;
        let Some(less) = braking.less(&left, before.as_ref()) else {
            return Ok(Some((*braking, needs / *nearest)));
        };
        *before = Some([*braking, left]);
        *braking = less;
        Ok(None)
    }

    /// Divides the path of the profile into parts. An acceleration falls up to the top speed, in all parts
    /// that begin before this speed.
    #[inline(never)]
    fn part(&self, brake: &Brake, (speeds, v): (&Speeds, f32), parts: &mut [Part; PARTS]) {
        let [begins, risen, falls, _] = self.profile.down.speeds;
        let gains = self.profile.up.length() > 0;
        let top = speed_f32(if gains { self.profile.up.speeds[3] } else { begins });
        let [risen, falls] = [risen, falls].map(speed_f32);
        for (k, part) in parts.iter_mut().enumerate() {
            let [from, to] = [speeds[k], speeds[k + 1]].map(|part| part * v);
            let until = if k + 1 < PARTS {
                brake.from.wrapping_add(to_bits::<44>(brake.passes(&self.profile, to)))
            } else {
                brake.end
            };
            let change = [v - to, from - speeds[PARTS] * v];
            *part = Part {
                v: from,
                change,
                ramps: [from > risen, to < falls],
                gains: k == 0 || from > top,
                until,
            };
        }
    }

    /// Returns the first stretch and its end, and the path distance up to which a deceleration may continue.
    /// Also returns the path of a stop with the limits of the spans, if one profile suffices.
    fn as_planned(
        &self,
        mut cursor: Cursor,
        span: &mut ReleasedSpan,
        motion: &Instant,
    ) -> Option<(Stretch, [i64; 2], f32)> {
        let now = self.ahead(&mut cursor, span, false)?;
        let (first, mut limits) = (now.end, now.limits);
        let mut end = first;
        let room = |end: i64| to_f32(end.wrapping_sub(motion.distance)) * (1.0 / (1u64 << 44) as f32);
        let needs = |limits: &Limits, end: i64| {
            let needs = Brake::needs(motion, limits);
            if needs <= room(end) { needs } else { f32::MAX }
        };
        let mut way = match limits.falls(speed_f32(motion.speed)) {
            Some(way) if way <= room(end) => way,
            Some(_) => f32::MAX,
            None => needs(&limits, end),
        };
        for _ in 1..SPANS {
            match self.ahead(&mut cursor, span, false) {
                Some(next) if next.smooth && next.v_in > Speed::ZERO => {
                    if way == f32::MAX && limits.slows_alike(&next.limits) {
                        limits.go_on_braking(&next.entered());
                        way = needs(&limits, next.end);
                    }
                    end = next.end;
                }
                _ => break,
            }
        }
        Some((now, [first, end], way))
    }

    /// The number of the curve at a path distance.
    fn curve_at(&self, distance: i64) -> Option<u32> {
        self.queue.segments.ends_behind(distance)
    }

    /// Lowers `braking` where a part permits less. In each span, the speed is at most the one planned at the
    /// start of the span.
    #[inline(never)]
    fn permitted(
        &self,
        begin: &Begin,
        span: &mut ReleasedSpan,
        motion: &Instant,
        parts: &[Part; PARTS],
        braking: &mut Braking,
    ) -> Option<()> {
        let Begin { mut cursor, mut curve, starts, begun, .. } = *begin;
        let most = self.orders.search.spent() + WALK;
        let [mut start, second] = begin.curve_starts;
        let mut at = motion.distance;
        let mut stretch = self.ahead(&mut cursor, span, false)?;
        let mut v_in = f32::MAX;
        let mut corners = stretch.knees && (starts || stretch.is_many);
        let mut passing = if starts && stretch.smooth { stretch.passing } else { 1.0 };
        for (part, Part { v, change, ramps, gains, until }) in parts.iter().enumerate() {
            let stage = usize::from(part >= STAGE);
            while until.wrapping_sub(at) > 0 {
                let goes_on = until.wrapping_sub(stretch.end) > 0;
                let end = if goes_on { stretch.end } else { *until };
                let (v, rapid, mut knee) = (min(*v, v_in), stretch.rapid, corners);
                let mut still = passing;
                if goes_on {
                    stretch = self.ahead(&mut cursor, span, false)?;
                    v_in = speed_f32(stretch.v_in.to_bits());
                    corners = stretch.knees;
                    // A knee also acts shortly before its point.
                    knee |= corners;
                    passing = stretch.passing;
                    still = min(still, passing);
                }
                let (change, ramps, begun) = (*change, *ramps, [begin.v, begun]);
                let gains = if *gains { begin.gains } else { 0.0 };
                let passed = Passed {
                    v,
                    rapid,
                    by_ramps: self.intake.uniform.by_ramps,
                    begun,
                    change,
                    ramps,
                    gains,
                    stage,
                    corners: knee,
                    passing: still,
                };
                let is_one = knee || begin.is_stepped();
                let mut swings = Swings::NONE;
                loop {
                    let track = self.queue.segments.recent(curve)?;
                    let block = self.queue.segments.block_of(track.segment);
                    (block.wrapping_sub(self.intake.uniform.since) as i32 >= 0).then_some(())?;
                    self.orders.search.spend_up_to(most, curve_costs(track.segment))?;
                    let length = track.segment.length();
                    let [from, to] = [at, end].map(|at| at.wrapping_sub(start));
                    let (from, to) = (from.max(0), to.min(length));
                    if to > from {
                        track.bend([from, to], &mut swings);
                    }
                    let behind = start.wrapping_add(length);
                    let is_last = behind.wrapping_sub(end) >= 0;
                    // Signs differ between two polynomials, so each counts alone. STEP and knees use none.
                    if is_last || !(is_one || track.segment.is_line() || track.segment.is_arc()) {
                        self.orders.search.spend_up_to(most, part_costs(AXES))?;
                        self.dynamics.stopping(&mut swings, &passed, braking)?;
                        swings = Swings::NONE;
                    }
                    if is_last {
                        break;
                    }
                    curve = self.queue.segments.after(curve);
                    // The motion may have stopped inside the first curve.
                    let is_second = curve == self.queue.segments.after(begin.curve);
                    start = if is_second { second } else { behind };
                }
                at = end;
            }
        }
        Some(())
    }
}

/// The highest speed of a motion whose acceleration ends as planned.
fn fastest(v: f32, accel: f32, limits: &Limits) -> f32 {
    match limits.law {
        SlopeLaw::JerkLimited { shape, j: [_, fall, ..], .. } if accel > 0.0 => {
            v + 0.5 * accel * accel / (fall * shape.peak_jerk())
        }
        _ => max(v, 0.0),
    }
}

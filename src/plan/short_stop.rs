//! A standstill as soon as the path ahead permits.
//!
//! The limits of a span are those of its highest speed, and of the place where it bends most. A way to a
//! standstill takes a part of it only, and is slower and slower there, so the axes may permit more. How much they
//! permit depends on the speed at each place of the path, and that depends on the deceleration. So the law is found
//! in rounds. The first one tries what the axes leave at the start of the way. Each further one takes less, until
//! the axes permit the law everywhere: that is asked for each of a few speeds, for the path that is left when the
//! law has come down to it.
use super::descent::{CLOSE, Cursor, Descent, SPANS, Stretch};
use super::{Brake, Instant, Planning, Speed};
use crate::dynamics::{Braking, Passed};
use crate::lookahead::ReleasedSpan;
use crate::math::float::{max, min, to_bits, to_f32};
use crate::path::Bounds;
use crate::quantity::{speed_bits, speed_f32};
use crate::slope::brake::SHORT;
use crate::slope::limits::{Limits, SlopeLaw};
use core::cell::Cell;

/// Speeds at which the parts of a way begin, and at which it ends, as parts of the highest one.
type Speeds = [f32; PARTS + 1];
/// Their number, and that of the part with which the second stage of STEP begins.
const PARTS: usize = 7;
const STAGE: usize = 3;
/// To a standstill; with STEP to half the speed, where the next law begins.
const STANDS: Speeds = [1.0, 0.95, 0.85, 0.7, 0.5, 0.3, 0.12, 0.0];
const SLOWS: Speeds = [1.0, 0.95, 0.9, 0.8, 0.7, 0.6, 0.55, 0.5];
/// A way of STEP that is no longer than so many times that with what is left here and now is one law.
const NEARLY: f32 = 1.2;
/// The same with another slope, in place of several laws.
const FAIRLY: f32 = 3.0;
/// Rounds.
const ROUNDS: usize = 8;
/// Most parts of curves that one call looks at for a standstill, in all its tries together.
pub(super) const CURVES: usize = 72;
/// A knee shows in so many ticks.
const KNEE_TICKS: i64 = 2;

/// A part of a way: the highest speed in it, how far its speeds are below the highest of all and above the last at
/// most, whether the deceleration rises and falls in it, and the path distance of its end.
#[derive(Clone, Copy)]
struct Part {
    v: f32,
    change: [f32; 2],
    ramps: [bool; 2],
    gains: bool,
    until: i64,
}

impl Part {
    /// None yet.
    const BLANK: Self = Self { v: 0.0, change: [0.0; 2], ramps: [true; 2], gains: true, until: 0 };
}

/// Why there is no such way.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum No {
    /// That of the spans is as short.
    Shorter,
    /// Not by one law.
    Law,
}

/// A law that was found, its limits, and how many times longer it is than with what is left here and now.
struct Found {
    brake: Brake,
    limits: Limits,
    needs: f32,
}

impl Found {
    /// None yet, with these limits.
    fn with(limits: &Limits) -> Self {
        Self { brake: Brake::default(), limits: *limits, needs: 0.0 }
    }
}

/// Where a way begins.
struct Begin {
    cursor: Cursor,
    /// Number of its first curve.
    curve: u32,
    /// Where that starts, and the next one.
    curve_starts: [i64; 2],
    is_line: bool,
    /// Near the start of its first span.
    starts: bool,
    /// Limits of its first span.
    planned: Limits,
    /// Highest speed.
    v: f32,
    /// Deceleration.
    begun: f32,
    /// Acceleration, but with STEP.
    gains: f32,
    /// Parts of curves that may still be looked at.
    left: Cell<usize>,
}

impl Begin {
    /// With STEP.
    const fn is_stepped(&self) -> bool {
        matches!(self.planned.law, SlopeLaw::Stepped { .. })
    }
}

impl<const AXES: usize, const BLOCKS: usize> Planning<'_, AXES, BLOCKS> {
    /// The way down from `motion` by one law that the axes permit on its own part of the path: `descent`, and the
    /// law is in the profile. An error where there is none, or where the dynamics have changed since those blocks came in;
    /// where the limits of the spans lead to a standstill as soon, too, unless they do not: `surely`.
    #[inline(never)]
    pub(super) fn stand_short(
        &mut self,
        cursor: Cursor,
        span: &mut ReleasedSpan,
        (motion, surely): (&Instant, bool),
        descent: &mut Descent,
    ) -> Result<(), No> {
        // By reference, here and below: as a whole it would be there twice.
        let begun = self.begin_short(cursor, span, motion, surely);
        let &(ref begin, ends, way) = begun.as_ref().map_err(|no| *no)?;
        let found = self.come_short(begin, span, (motion, descent), (ends, way));
        self.orders.looks = begin.left.get();
        found
    }

    // What follows is not inlined: of what each has on the stack, only one is there at a time.

    /// The same from there.
    #[inline(never)]
    fn come_short(
        &mut self,
        begin: &Begin,
        span: &mut ReleasedSpan,
        (motion, descent): (&Instant, &mut Descent),
        (ends, way): ([i64; 2], f32),
    ) -> Result<(), No> {
        let [first, end] = ends;
        let found = &mut Found::with(&begin.planned);
        let stands = self.come_down(begin, span, motion, (&STANDS, end, way), found);
        if begin.is_stepped() && !(stands.is_ok() && found.needs <= NEARLY) {
            // To half the speed in the first span, at least as hard as planned. What is planned behind it stays
            // possible.
            let slows = &mut Found::with(&begin.planned);
            if self.come_down(begin, span, motion, (&SLOWS, first, f32::MAX), slows).is_ok()
                && slows.brake.v_out > 0
                && slows.limits.brakes_above(&begin.planned)
                && self.leaves_way(begin.cursor, span, &slows.brake)
            {
                *descent = Descent::inside(slows.brake);
                return Ok(());
            }
        }
        stands?;
        self.take_short(begin, span, (motion, descent), (end, way), found)
    }

    /// The law that was found, if no other one is better, with its spans.
    #[inline(never)]
    fn take_short(
        &mut self,
        begin: &Begin,
        span: &mut ReleasedSpan,
        (motion, descent): (&Instant, &mut Descent),
        (end, way): (i64, f32),
        Found { brake, limits, needs }: &mut Found,
    ) -> Result<(), No> {
        let stepped = begin.is_stepped();
        let most = if stepped && begin.is_line { NEARLY } else { FAIRLY };
        if *needs > most && (stepped || way == f32::MAX) {
            return Err(No::Law);
        }
        if stepped {
            // The profile had another one.
            *brake =
                Brake::down_to(&mut self.profile, motion, end, (limits, limits.a_down), 0).ok_or(No::Law)?;
        }
        self.verify(begin.cursor, span, (motion, descent), (brake, limits), true).map_err(|_| No::Law)
    }

    /// Where such a way begins, and what [`Self::as_planned`] has.
    #[inline(never)]
    fn begin_short(
        &mut self,
        cursor: Cursor,
        span: &mut ReleasedSpan,
        motion: &Instant,
        surely: bool,
    ) -> Result<(Begin, [i64; 2], f32), No> {
        let curve = self.curve_at(motion.distance).ok_or(No::Law)?;
        let first = self.queue.segments.recent(curve).ok_or(No::Law)?;
        let curve_starts = [curve, curve.wrapping_add(1)].map(|curve| self.queue.segments.start(curve));
        let behind = motion.distance.wrapping_sub(curve_starts[0]);
        let is_line = first.segment.is_line();
        let starts = behind <= KNEE_TICKS * (motion.speed >> 14);
        let (now, ends, mut way) = self.as_planned(cursor, span, motion).ok_or(No::Law)?;
        let planned = now.limits;
        // Of several blocks the limits are those of the worst one.
        if is_line && !now.is_many && Brake::fits(motion, ends[0], &planned, CLOSE) {
            return Err(No::Shorter);
        }
        if surely {
            way = f32::MAX;
        }
        let accel = to_f32(motion.accel) * (1.0 / (1u64 << 58) as f32);
        let v = fastest(speed_f32(motion.speed), accel, &planned);
        let stepped = matches!(planned.law, SlopeLaw::Stepped { .. });
        let begun = if stepped { 0.0 } else { max(-accel, 0.0) };
        let gains = if stepped { 0.0 } else { max(accel, 0.0) };
        let left = Cell::new(self.orders.looks);
        let begin = Begin { cursor, curve, curve_starts, is_line, starts, planned, v, begun, gains, left };
        Ok((begin, ends, way))
    }

    /// A law through these speeds that the axes permit, before the path distance `end` and in less than `way`
    /// (mm).
    #[inline(never)]
    fn come_down(
        &mut self,
        begin: &Begin,
        span: &mut ReleasedSpan,
        motion: &Instant,
        (speeds, end, way): (&Speeds, i64, f32),
        Found { brake, limits, needs: longer }: &mut Found,
    ) -> Result<(), No> {
        let Begin { planned, v, begun, gains, .. } = begin;
        // Of each stage of STEP something.
        let mut here = motion.distance;
        let mut parts = [Part::BLANK; PARTS];
        for (k, (part, speed)) in parts.iter_mut().zip(speeds).enumerate() {
            if k % STAGE == 0 && k <= STAGE {
                here = here.wrapping_add(SHORT);
            }
            let v = speed * v;
            *part = Part { v, change: [0.0, v], ramps: [true; 2], gains: true, until: here };
        }
        let mut braking = Braking::WIDEST;
        self.permitted(begin, span, motion, &parts, &mut braking).ok_or(No::Law)?;
        let mut nearest = 0.0;
        let mut before = None;
        for _round in 0..ROUNDS {
            if *begun > braking.a[0] {
                return Err(No::Law);
            }
            let ends = if *gains > 0.0 { braking.ends } else { 0.0 };
            *limits = planned.braked(braking.a, speeds[STAGE] * v, braking.j, ends);
            let needs = Brake::needs(motion, limits);
            if needs >= way {
                return Err(No::Shorter);
            }
            nearest = if nearest > 0.0 { nearest } else { needs };
            let (law, to) = ((&*limits, limits.a_down), speed_bits(speeds[PARTS] * v));
            *brake = Brake::down_to(&mut self.profile, motion, end, law, to).ok_or(No::Law)?;
            self.part(brake, (speeds, *v), &mut parts);
            let mut left = braking;
            self.permitted(begin, span, motion, &parts, &mut left).ok_or(No::Law)?;
            let Some(less) = braking.less(&left, before.as_ref()) else {
                *longer = needs / nearest;
                return Ok(());
            };
            before = Some([braking, left]);
            braking = less;
        }
        Err(No::Law)
    }

    /// The parts of the way of a law that is in the profile. An acceleration falls up to the top speed: in all parts
    /// that begin before it.
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

    /// The first stretch, its end and the path distance up to which a deceleration may go on, and how much path a
    /// standstill takes with the limits of the spans, if that is one law.
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

    /// The number of the curve that a path distance is on.
    fn curve_at(&self, distance: i64) -> Option<u32> {
        self.queue.segments.ends_behind(distance)
    }

    /// Less of `braking` where a part permits less: in each span at most at the speed planned at its start.
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
                let mut bounds = Bounds::NONE;
                loop {
                    let track = self.queue.segments.recent(curve)?;
                    let block = self.queue.segments.block_of(track.segment);
                    let is_of_now = block.wrapping_sub(self.intake.uniform.since) as i32 >= 0;
                    begin.left.set(if is_of_now { begin.left.get().checked_sub(1)? } else { return None });
                    let length = track.segment.length();
                    let [from, to] = [at, end].map(|at| at.wrapping_sub(start));
                    let (from, to) = (from.max(0), to.min(length));
                    if to > from {
                        track.bend([from, to], &mut bounds);
                    }
                    let behind = start.wrapping_add(length);
                    if behind.wrapping_sub(end) >= 0 {
                        break;
                    }
                    curve = self.queue.segments.after(curve);
                    // The first one may have been left within: the motion stood there.
                    let is_second = curve == self.queue.segments.after(begin.curve);
                    start = if is_second { second } else { behind };
                }
                let (v, rapid, mut knee) = (min(*v, v_in), stretch.rapid, corners);
                let mut still = passing;
                if goes_on {
                    stretch = self.ahead(&mut cursor, span, false)?;
                    v_in = speed_f32(stretch.v_in.to_bits());
                    corners = stretch.knees;
                    // It shows before it, too.
                    knee |= corners;
                    passing = stretch.passing;
                    still = min(still, passing);
                }
                let by_ramps = self.intake.uniform.by_ramps;
                let (change, ramps, begun) = (*change, *ramps, [begin.v, begun]);
                let gains = if *gains { begin.gains } else { 0.0 };
                let passed = Passed {
                    v,
                    rapid,
                    by_ramps,
                    begun,
                    change,
                    ramps,
                    gains,
                    stage,
                    corners: knee,
                    passing: still,
                };
                self.dynamics.stopping(&bounds, &passed, braking)?;
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

//! The way down to a standstill from a motion at hand: one law through as many spans as it takes.
//!
//! Spans end with acceleration zero where the plan has it so. A standstill need not keep that: where the path
//! turns little between two spans (`SpanMarks::passing`) a deceleration passes. The law brakes with the
//! least deceleration and jerk of all spans on its way, from the first to the one in which it stands. It is
//! no faster at any transition than planned, and it is slowing down there, so the spans behind keep their
//! limits of speed too. Where the law would be too fast, it ends: at that transition, with acceleration zero,
//! at the planned speed or below, and the next law goes on from there.
//!
//! STEP may change its deceleration at any place: spans whose decelerations differ have a law each. What a
//! curve leaves to it grows while the motion slows down in it, since the curve takes its part with the square
//! of the speed ([`Fall`]): there the way has several laws of two stages.
//!
//! A span of several blocks (HSC) is passed below the speed of its slowest block, or at least as hard braking
//! as its own law does. A curve in which acceleration is bought with speed is entered so slowly that the
//! deceleration of the law may go on in it.
use super::hold::NOTHING;
use super::search::{PLAN_COSTS, SCAN_COSTS, SPAN_COSTS};
use super::{Brake, Instant, Planning, Profile, RingStage, Speed, clock};
use crate::lookahead::ReleasedSpan;
use crate::math::float::{min, to_f32};
use crate::math::root::sqrt_f32;
use crate::quantity::{speed_bits, speed_f32};
use crate::slope::brake::SHORT;
use crate::slope::limits::{Fall, Limits, SlopeLaw};

/// Most spans of one law. A longer way has several.
pub(super) const SPANS: usize = 32;

/// A way has to be shorter than the room by this part: rounding of its length.
pub(super) const CLOSE: f32 = 1.0 - 1.0 / 262_144.0;

/// A law and where it leads.
#[derive(Clone, Copy, Debug)]
pub(super) struct Descent {
    pub brake: Brake,
    /// Spans that it passes whole.
    pub spans: usize,
    /// Behind these: the next block of the look-ahead, and its path distance.
    ahead: Ahead,
}

impl Descent {
    /// No descent.
    pub fn none() -> Self {
        Self::inside(Brake::default())
    }

    /// A slowing down inside one span.
    pub fn inside(brake: Brake) -> Self {
        Self { brake, spans: 0, ahead: Ahead::NONE }
    }
}

/// What a way down passes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Passed {
    /// The span it begins in, and the one behind those that it passes whole.
    from: usize,
    to: usize,
    /// The instant behind its last tick.
    last: u32,
    /// Path distance where it stands inside a span.
    pub stands: Option<i64>,
}

/// A place in the look-ahead, or none.
#[derive(Clone, Copy, Debug)]
struct Ahead {
    next: usize,
    distance: i64,
}

impl Ahead {
    const NONE: Self = Self { next: usize::MAX, distance: 0 };
}

/// Goes along the spans: committed ones first, then those of the look-ahead.
#[derive(Clone, Copy)]
pub(super) struct Cursor {
    k: usize,
    ahead: Ahead,
    /// With STEP, what the limits of all of them are known for.
    fall: Option<Fall>,
}

/// What a law has to know of a span.
pub(super) struct Stretch {
    pub limits: Limits,
    /// Speed planned at its start; of several blocks the slowest one.
    pub v_in: Speed,
    v_slow: f32,
    v_least: f32,
    is_uneven: bool,
    pub smooth: bool,
    /// The part of a deceleration that passes its start.
    pub passing: f32,
    /// Acceleration inside it is bought with speed.
    trades: bool,
    /// The path turns at its start, or inside it where it is of several blocks.
    pub knees: bool,
    pub is_many: bool,
    bought: bool,
    /// Rapid motion.
    pub rapid: Option<bool>,
    /// Path distance of its end, and the speed planned there.
    pub end: i64,
    v_out: Speed,
}

/// What the limits of the spans lead to.
pub(super) enum Along {
    /// A standstill.
    Stands,
    /// A law through so many spans; a standstill fits into them.
    Through { spans: usize, fits: bool },
}

impl Stretch {
    #[cfg_attr(feature = "fast", inline(always))]
    fn new(span: &ReleasedSpan, v_in: Speed, end: i64, fall: Option<&Fall>) -> Self {
        let mut limits = Limits { a_down: span.a_down, ..span.limits };
        if let Some(fall) = fall {
            limits.fall_from(fall);
        }
        Self {
            limits,
            v_in,
            v_slow: span.slow.shared,
            v_least: min(span.slow.least, span.limits.v),
            is_uneven: span.is_uneven(),
            smooth: span.marks.is_smooth(),
            passing: span.marks.passing(),
            trades: span.marks.trades(),
            knees: span.marks.has_knees(),
            is_many: span.blocks > 1,
            bought: span.marks.trades_somewhere(),
            rapid: span.marks.rapid(),
            end,
            v_out: span.v_out,
        }
    }

    /// Whether the deceleration at hand may go on in it. That of STEP becomes another one at any tick.
    fn permits(&self, motion: &Instant) -> bool {
        let decel = speed_f32(motion.accel.wrapping_neg());
        matches!(self.limits.law, SlopeLaw::Stepped { .. }) || decel <= self.entered().a_down
    }

    /// Limits of the span for a braking that comes through its start.
    pub fn entered(&self) -> Limits {
        Limits { a_down: self.limits.a_down * self.passing, ..self.limits }
    }

    /// Where acceleration is bought with speed: the highest speed without, and the acceleration at standstill.
    fn bought(&self) -> Option<(f32, f32)> {
        let Limits { v, a_down, .. } = self.limits;
        if self.trades {
            Some((self.v_least, a_down))
        } else {
            self.bought.then(|| (v, sqrt_f32(2.0 * v * self.limits.jerk(2))))
        }
    }

    /// Highest speed at which a law with these limits may be in it, whose deceleration falls from the speed `falls`
    /// on: below the slowest block it may be as slow in falling as it is.
    fn cap(&self, limits: &Limits, falls: f32) -> f32 {
        if !self.is_uneven {
            return f32::MAX;
        }
        let [begins, ends] = limits.brakes_like(&self.limits);
        if ends || (begins && falls <= self.v_slow) { f32::MAX } else { self.v_slow }
    }
}

impl<const AXES: usize, const BLOCKS: usize> Planning<'_, AXES, BLOCKS> {
    /// Where spans begin that a way from the span `k` on may pass: behind those that are committed, those of the
    /// look-ahead, unless the way is to stay within the former.
    pub(super) fn begin_ahead(&self, k: usize, stays: bool) -> Cursor {
        let ahead = if stays {
            Ahead::NONE
        } else if self.reserve.is_made() {
            let (next, distance) = self.reserve.ahead();
            Ahead { next, distance: distance.to_bits() }
        } else if self.task.stage == RingStage::Passing || self.reserve.behind.is_some() {
            Ahead::NONE
        } else {
            Ahead { next: 0, distance: self.handed.to_bits() }
        };
        Cursor { k, ahead, fall: None }
    }

    /// The same with the limits that the first span has from this motion on: [`Fall`].
    #[inline(never)]
    pub(super) fn know_fall(
        &self,
        start: &mut Cursor,
        span: &mut ReleasedSpan,
        motion: &Instant,
    ) -> Option<()> {
        let first = self.ahead(&mut start.clone(), span, false)?;
        start.fall = first.limits.fall(speed_f32(motion.speed));
        Some(())
    }

    // What follows is not inlined: of what each has on the stack, only one is there at a time.

    /// Whether the limits of the spans permit a standstill by one law; else through how many spans a law may lead, and
    /// whether a standstill fits into them.
    #[inline(never)]
    pub(super) fn look_along(
        &mut self,
        start: &Cursor,
        span: &mut ReleasedSpan,
        (motion, found): (&Instant, &mut Descent),
    ) -> Option<Along> {
        let mut cursor = *start;
        if let Some(fall) = start.fall
            && let Some(descent) = self.fall_inside(*start, span, motion, &fall)
        {
            *found = descent;
            return Some(Along::Stands);
        }
        let Stretch { mut limits, mut end, .. } = self.ahead(&mut cursor, span, false)?;
        let mut spans = 1;
        let mut fits = Brake::fits(motion, end, &limits, CLOSE);
        while !fits && spans < SPANS {
            // A deceleration that a span does not permit ends before it.
            let goes_on = |next: &Stretch| {
                let passes = next.smooth && next.v_in > Speed::ZERO && next.permits(motion);
                passes && limits.slows_alike(&next.limits)
            };
            let Some(next) = self.ahead(&mut cursor, span, false).filter(goes_on) else { break };
            limits.go_on_braking(&next.entered());
            (end, spans) = (next.end, spans + 1);
            fits = Brake::fits(motion, end, &limits, CLOSE);
        }
        if fits
            && let Some(brake) = Brake::down_to(&mut self.profile, motion, end, (&limits, limits.a_down), 0)
        {
            match self.verify(*start, span, (motion, found), (&brake, &limits), false) {
                Ok(()) => return Some(Along::Stands),
                Err(whole) => spans = whole,
            }
        }
        Some(Along::Through { spans, fits })
    }

    /// To the end of so many spans. `Err`: fewer of them, since the law is too fast before.
    #[inline(never)]
    pub(super) fn step_down(
        &mut self,
        start: &Cursor,
        span: &mut ReleasedSpan,
        (motion, found): (&Instant, &mut Descent),
        spans: usize,
    ) -> Option<Result<(), usize>> {
        let (limits, end, v_out) = self.together(*start, span, spans)?;
        let braking = (&limits, limits.a_down);
        self.orders.search.spend(PLAN_COSTS);
        let brake = Brake::plan(&mut self.profile, motion, end, v_out.to_bits(), braking, 0);
        if spans == 1 {
            let brake = brake?;
            let spans = usize::from(end.wrapping_sub(brake.end) <= NOTHING);
            let mut cursor = *start;
            if spans > 0 {
                self.ahead(&mut cursor, span, false)?;
            }
            *found = Descent { brake, spans, ahead: cursor.ahead };
            return Some(Ok(()));
        }
        let Some(brake) = brake else { return Some(Err(1)) };
        let followed = self.verify(*start, span, (motion, found), (&brake, &limits), false);
        Some(followed.map_err(|whole| whole.min(spans - 1)))
    }

    /// With STEP, whether a way down that begins in the span `k` ends where another law takes it further: it
    /// needs nothing of the look-ahead.
    pub(super) fn is_stage(&self, k: usize, descent: &Descent) -> bool {
        let steps = |limits: &Limits| matches!(limits.law, SlopeLaw::Stepped { .. });
        k + descent.spans < self.committed.len()
            && self.committed.get(k).is_some_and(|committed| steps(&committed.span.limits))
    }

    /// With STEP, in a curve: only to a speed at which it leaves more, and the rest has a law of its own. It
    /// slows down at least as hard as the law planned, so that what was possible behind it still is.
    fn fall_inside(
        &mut self,
        start: Cursor,
        span: &mut ReleasedSpan,
        motion: &Instant,
        fall: &Fall,
    ) -> Option<Descent> {
        if fall.to <= 0.0 {
            return None;
        }
        let mut cursor = start;
        let Stretch { limits, end, .. } = self.ahead(&mut cursor, span, false)?;
        let (braking, to) = ((&limits, limits.a_down), speed_bits(fall.to));
        let brake = Brake::down_to(&mut self.profile, motion, end, braking, to)?;
        (brake.v_out == to && self.leaves_way(start, span, &brake)).then(|| Descent::inside(brake))
    }

    /// Whether a slowing down inside the first span leaves path for another law, and enough of it for what is planned
    /// at the end of the span. Of one that slows down just as hard as planned rounding may leave too little: the less
    /// is left, the larger a part of it.
    pub(super) fn leaves_way(&self, start: Cursor, span: &mut ReleasedSpan, brake: &Brake) -> bool {
        let Some(first) = self.ahead(&mut Cursor { fall: None, ..start }, span, true) else { return false };
        let span = self.committed.get(start.k).map_or(&*span, |committed| &committed.span);
        let left = first.end.wrapping_sub(brake.end);
        left > SHORT && span.can_slow_within(left, Speed::from_bits(brake.v_out))
    }

    /// The next span, if there is one whose path the interrupt knows.
    ///
    /// Where the motion goes on behind it, the speed planned at its end need not be known: not `ends`.
    pub(super) fn ahead(&self, cursor: &mut Cursor, span: &mut ReleasedSpan, ends: bool) -> Option<Stretch> {
        if let Some(committed) = self.committed.get(cursor.k) {
            self.orders.search.spend(SPAN_COSTS);
            cursor.k += 1;
            let (span, v_in) = (&committed.span, committed.planned());
            return Some(Stretch::new(span, v_in, committed.end(), cursor.fall.as_ref()));
        }
        if cursor.ahead.next == usize::MAX || !self.lookahead.ring.scan(cursor.ahead.next, span, ends) {
            return None;
        }
        self.orders.search.spend(SCAN_COSTS + u32::from(span.blocks));
        let end = cursor.ahead.distance.wrapping_add(span.length.to_bits());
        if !self.queue.segments.is_known(crate::quantity::Distance::from_bits(end)) {
            return None;
        }
        cursor.ahead = Ahead { next: cursor.ahead.next + usize::from(span.blocks), distance: end };
        Some(Stretch::new(span, span.v_in, end, cursor.fall.as_ref()))
    }

    /// What so many spans permit to a slowing down, the end of the last of them, and the speed planned there.
    fn together(
        &self,
        mut cursor: Cursor,
        span: &mut ReleasedSpan,
        spans: usize,
    ) -> Option<(Limits, i64, Speed)> {
        let mut last = self.ahead(&mut cursor, span, spans <= 1)?;
        let mut limits = last.limits;
        for k in 1..spans {
            last = self.ahead(&mut cursor, span, k + 1 == spans)?;
            limits.go_on_braking(&last.entered());
        }
        Some((limits, last.end, last.v_out))
    }

    /// Follows a law, whose parts are in the profile, through its spans; then it is `found`. `Err`: it is too fast behind so many
    /// spans. `short`: its limits are those of the axes on its way.
    #[inline(never)]
    pub(super) fn verify(
        &self,
        start: Cursor,
        span: &mut ReleasedSpan,
        (motion, found): (&Instant, &mut Descent),
        (brake, limits): (&Brake, &Limits),
        short: bool,
    ) -> Result<(), usize> {
        let mut cursor = start;
        let mut spans = 0;
        let mut at = motion.distance;
        let [.., falls, _] = self.profile.down.speeds.map(speed_f32);
        loop {
            let ahead = cursor.ahead;
            let Some(stretch) = self.ahead(&mut cursor, span, false) else { return Err(spans.max(1)) };
            let mut cap = stretch.cap(limits, falls);
            if spans > 0 {
                if !short && let Some((v, a)) = stretch.bought() {
                    cap = min(cap, brake.trade(&self.profile, v, a));
                }
                cap = min(cap, speed_f32(stretch.v_in.to_bits()));
            }
            if cap < f32::MAX && !is_slower(&self.profile, brake, at, cap) {
                return Err(spans.max(1));
            }
            let left = stretch.end.wrapping_sub(brake.end);
            if left > NOTHING {
                *found = Descent { brake: *brake, spans, ahead };
                return Ok(());
            }
            spans += 1;
            if left >= -NOTHING {
                *found = Descent { brake: *brake, spans, ahead: cursor.ahead };
                return Ok(());
            }
            at = stretch.end;
        }
    }

    /// The law of a descent that begins in the span `k` goes to the emitter. [`Self::note_passed`] tells the
    /// spans.
    #[inline(never)]
    pub(super) fn go_down(&mut self, k: usize, descent: &Descent) {
        let Descent { brake, spans, ahead } = descent;
        let inside =
            self.committed.get(k).is_some_and(|committed| committed.end().wrapping_sub(brake.end) >= 0);
        if *spans == 0 || inside {
            self.brake(k, brake);
            return;
        }
        self.frontier.emitter.begin_brake(&self.profile, brake);
        let last = self.frontier.end.wrapping_add(clock::TICK * self.frontier.emitter.ticks());
        let to = k + spans;
        self.frontier.speed = Speed::from_bits(brake.v_out);
        self.frontier.stops = self.frontier.speed == Speed::ZERO;
        self.frontier.pending_dwell = 0;
        if self.reserve.is_made() {
            let committed = self.committed.len();
            self.frontier.planned = to.min(committed);
            self.orders.mode.halting = self.frontier.stops;
            if self.frontier.stops {
                self.reserve.stand_at(brake.end);
            } else if to > committed {
                self.reserve.go_on_at(ahead.next, ahead.distance);
            }
            return;
        }
        let committed = self.committed.len();
        self.frontier.planned = to.min(committed);
        let speed = self.frontier.speed;
        let ended = to.checked_sub(1).and_then(|k| self.committed.get_mut(k));
        let mut stands = None;
        if let Some(ended) = ended.filter(|last| last.end().wrapping_sub(brake.end) >= -NOTHING) {
            ended.leaves = speed;
            self.frontier.pending_dwell = u64::from(ended.rest);
            self.lower();
        } else {
            // Inside a span, or at the end of one of the look-ahead.
            self.orders.mode.halting = true;
            stands = Some(brake.end);
            if to >= committed {
                self.reserve.behind = stands;
            }
        }
        self.orders.mode.passed = Some(Passed { from: k, to, last, stands });
    }

    /// The law is in the queue: the spans on its way are passed.
    pub(super) fn note_passed(&mut self) {
        let Some(Passed { from, to, last, stands }) = self.orders.mode.passed.take() else { return };
        for k in from + 1..=to {
            if let Some(committed) = self.committed.get_mut(k) {
                committed.first = last;
            }
        }
        if let (Some(stands), Some(committed)) = (stands, self.committed.get_mut(to)) {
            committed.begin_at(stands, Speed::ZERO);
        }
    }
}

/// Whether the law is at most as fast as `v` from the path distance `at` on.
fn is_slower(profile: &Profile, brake: &Brake, at: i64, v: f32) -> bool {
    let along = to_f32(at.wrapping_sub(brake.from)) * (1.0 / (1u64 << 44) as f32);
    brake.passes(profile, v) <= along * CLOSE
}

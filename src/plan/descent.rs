//! Finds a stop, or a braking, within the planned limits of the spans. One braking profile passes as many
//! spans as needed.
//!
//! In the plan, acceleration is zero at both ends of a span. A stop may pass such an end with a deceleration
//! if the path turns little there (`SpanMarks::passing`). The braking uses the lowest deceleration and the
//! lowest jerks of all spans that it passes. At every transition, the motion is at most as fast as planned,
//! and it brakes. So the speed limits of the following spans hold. If the motion would be too fast at a
//! transition, the braking ends there, with zero acceleration and at most the planned speed. The next profile
//! continues from there.
//!
//! Three kinds of spans have rules of their own:
//!
//! - STEP: the deceleration may change at any tick, so spans with different decelerations get separate
//!   profiles. In a curve, a part of the deceleration is needed for the curve itself. This part falls with
//!   the square of the speed, so more deceleration is available as the motion slows down ([`Fall`]). A stop
//!   inside such a curve has several profiles.
//! - A span of several blocks (HSC): the motion is slower than the slowest block, or it brakes at least as
//!   hard as the planned profile.
//! - A curve that permits more acceleration at a lower speed: the motion enters so slowly that the
//!   deceleration may continue inside the curve.
use super::hold::NOTHING;
use super::search::{PLAN_COSTS, SCAN_COSTS, SPAN_COSTS};
use super::{Brake, Instant, Planning, Profile, RingStage, Speed, clock};
use crate::lookahead::ReleasedSpan;
use crate::math::float::{min, to_f32};
use crate::math::root::sqrt_f32;
use crate::quantity::{speed_bits, speed_f32};
use crate::slope::brake::SHORT;
use crate::slope::limits::{Fall, Limits, SlopeLaw};

/// Largest number of spans in one profile. A longer stop has several profiles.
pub(super) const SPANS: usize = 20;

/// A stop must be shorter than its room by this factor, because its length is rounded.
pub(super) const CLOSE: f32 = 1.0 - 1.0 / 262_144.0;

/// A braking profile and its end.
#[derive(Clone, Copy, Debug)]
pub(super) struct Descent {
    pub brake: Brake,
    /// Number of spans that the profile passes completely.
    pub spans: usize,
    /// The next block of the look-ahead after the spans of the braking, and its path distance.
    ahead: Ahead,
}

impl Descent {
    /// No braking profile.
    pub fn none() -> Self {
        Self::inside(Brake::default())
    }

    /// A braking inside one span.
    pub fn inside(brake: Brake) -> Self {
        Self { brake, spans: 0, ahead: Ahead::NONE }
    }
}

/// The spans that a braking passes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Passed {
    /// The span in which the braking begins, and the first span after those that it passes completely.
    from: usize,
    to: usize,
    /// The instant after the braking's last tick.
    last: u32,
    /// Path distance of the stop, if it is inside a span.
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

/// Walks through the spans: committed spans first, then those of the look-ahead.
#[derive(Clone, Copy)]
pub(super) struct Cursor {
    k: usize,
    ahead: Ahead,
    /// STEP: the braking for which the limits of all spans are known.
    fall: Option<Fall>,
}

/// Data of a span for a braking.
pub(super) struct Stretch {
    pub limits: Limits,
    /// Speed planned at the start of the span; with several blocks, the speed of the slowest one.
    pub v_in: Speed,
    v_slow: f32,
    v_least: f32,
    is_uneven: bool,
    pub smooth: bool,
    /// The part of a deceleration that may pass the start of the span.
    pub passing: f32,
    /// Whether the limits of the span trade speed for acceleration.
    trades: bool,
    /// Whether the path turns at the start of the span, or inside a span of several blocks.
    pub knees: bool,
    pub is_many: bool,
    bought: bool,
    /// Whether the span is rapid motion; `None` if only a part of it is.
    pub rapid: Option<bool>,
    /// Path distance of the span's end, and the speed planned there.
    pub end: i64,
    v_out: Speed,
}

/// The result of [`Planning::look_along`].
pub(super) enum Along {
    /// The braking ends in a stop.
    Stands,
    /// One profile passes `spans` spans; `fits`: whether a stop has room in them.
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

    /// Whether the current deceleration may continue in the span. With STEP, always: its deceleration changes
    /// at any tick.
    fn permits(&self, motion: &Instant) -> bool {
        let decel = speed_f32(motion.accel.wrapping_neg());
        matches!(self.limits.law, SlopeLaw::Stepped { .. }) || decel <= self.entered().a_down
    }

    /// Limits of the span for a braking that passes the start of the span: the transition there may permit
    /// only a part of the deceleration.
    pub fn entered(&self) -> Limits {
        Limits { a_down: self.limits.a_down * self.passing, ..self.limits }
    }

    /// The highest speed without acceleration, and the acceleration at standstill, if the limits of the span
    /// trade speed for acceleration.
    fn bought(&self) -> Option<(f32, f32)> {
        let Limits { v, a_down, .. } = self.limits;
        if self.trades {
            Some((self.v_least, a_down))
        } else {
            self.bought.then(|| (v, sqrt_f32(2.0 * v * self.limits.jerk(2))))
        }
    }

    /// Highest speed in the span for a braking with these limits. Its deceleration begins to fall at the
    /// speed `falls`. Below the speed of the slowest block, the fall may be as slow as needed.
    fn cap(&self, limits: &Limits, falls: f32) -> f32 {
        if !self.is_uneven {
            return f32::MAX;
        }
        let [begins, ends] = limits.brakes_like(&self.limits);
        if ends || (begins && falls <= self.v_slow) { f32::MAX } else { self.v_slow }
    }
}

impl<const AXES: usize, const BLOCKS: usize> Planning<'_, AXES, BLOCKS> {
    /// A cursor at the start of the spans after span `k`: first committed spans, then those of the
    /// look-ahead. `stays`: only committed spans.
    pub(super) fn begin_ahead(&self, k: usize, stays: bool) -> Cursor {
        let ahead = if stays {
            Ahead::NONE
        } else if self.reserve.is_made() {
            let (next, distance) = self.reserve.ahead();
            Ahead { next, distance: distance.to_bits() }
        } else if self.task.stage == RingStage::Passing
            || (self.reserve.behind.is_some() && !self.orders.mode.is_standing())
        {
            Ahead::NONE
        } else {
            Ahead { next: 0, distance: self.handed.to_bits() }
        };
        Cursor { k, ahead, fall: None }
    }

    /// As [`Self::begin_ahead`], and sets the limits that the first span has from this motion on: [`Fall`].
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

    // The following functions are not inlined, so that only one of their stack frames exists at a time.

    /// Whether the limits of the spans permit a stop by one profile. If not, returns the number of spans for
    /// one profile, and whether a stop has room in them.
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
            // If the next span does not permit a deceleration, the deceleration ends before this span.
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

    /// Brakes to the end of `spans` spans. Returns an error with fewer spans if the profile is too fast at an
    /// earlier one.
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

    /// For STEP: whether a braking that begins in the span `k` ends inside committed spans, so that another
    /// profile continues it. Such a braking needs no data of the look-ahead.
    pub(super) fn is_stage(&self, k: usize, descent: &Descent) -> bool {
        let steps = |limits: &Limits| matches!(limits.law, SlopeLaw::Stepped { .. });
        k + descent.spans < self.committed.len()
            && self.committed.get(k).is_some_and(|committed| steps(&committed.span.limits))
    }

    /// STEP in a curve: brakes only to a speed at which the curve leaves more deceleration. The rest of the
    /// stop has its own profile. The braking is at least as hard as the planned profile, so every later speed
    /// stays possible.
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

    /// Whether a braking inside the first span leaves enough path for the next profile, which has to reach
    /// the planned end speed. If the braking is only as hard as planned, rounding may leave too little path;
    /// the shorter the rest, the larger this effect.
    pub(super) fn leaves_way(&self, start: Cursor, span: &mut ReleasedSpan, brake: &Brake) -> bool {
        let Some(first) = self.ahead(&mut Cursor { fall: None, ..start }, span, true) else { return false };
        let span = self.committed.get(start.k).map_or(&*span, |committed| &committed.span);
        let left = first.end.wrapping_sub(brake.end);
        left > SHORT && span.can_slow_within(left, Speed::from_bits(brake.v_out))
    }

    /// The next span. Returns `None` after the last span, or if the interrupt does not know the span's path
    /// yet.
    ///
    /// If the motion continues after the span, its end speed need not be computed: `ends` is false.
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

    /// Limits that `spans` spans together permit for a braking, the end of the last of them, and the planned
    /// speed there.
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

    /// Checks the braking of the emitter's profile against its spans. On success, `found` holds the braking.
    /// Otherwise returns the number of spans after which the braking is too fast. `short`: the limits of the
    /// braking are those of the axes along its path.
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

    /// Gives the emitter a braking that begins in the span `k`. [`Self::note_passed`] updates the spans
    /// later.
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
            // The stop is inside a span, or at the end of a span of the look-ahead.
            self.orders.mode.halting = true;
            stands = Some(brake.end);
            if to >= committed {
                self.reserve.behind = stands;
            }
        }
        self.orders.mode.passed = Some(Passed { from: k, to, last, stands });
    }

    /// After the braking is in the queue: marks the spans on its path as passed.
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

/// Whether the speed of the braking is at most `v` from the path distance `at` on.
fn is_slower(profile: &Profile, brake: &Brake, at: i64, v: f32) -> bool {
    let along = to_f32(at.wrapping_sub(brake.from)) * (1.0 / (1u64 << 44) as f32);
    brake.passes(profile, v) <= along * CLOSE
}

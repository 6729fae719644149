//! The reserve: a prepared stop that the interrupt executes if the planner gets no processor time.
//!
//! The motion in the queue may end at speed. So the planner always keeps a stop that continues from the end
//! of the queue. When the queue is empty, the interrupt goes on with this stop ([`clock`]), and the axes
//! brake within the limits of every block. A planner that is called often enough replaces the reserve before
//! the interrupt reaches it. So the reserve is then never used.
//!
//! **Making a reserve.** The stop begins with the motion at the end of the queue, and is made like a feed
//! hold (`hold`). The stop continues through the planned spans of the look-ahead, until one span is long
//! enough for the rest of the stop. The plan of the ring ends in a stop, so there is always such a span.
//! Meanwhile, the planner sets its current work aside. A new reserve is made when the interrupt comes near
//! the old one. This is about once per full queue.
//!
//! **After a planned stop.** If the queue ends in a planned stop, its last tick shows the axes just before
//! the stop. One more tick has to show the stop itself. As long as no further motion is in the queue, the
//! reserve consists of this tick alone.
//!
//! **After the interrupt has used the reserve**, the planner waits until the stop is complete. Then the
//! planner withdraws the rest of the queue, plans from the standstill, and reports [`Work::Late`].
//!
//! **No room.** A stop may need more pieces than there is room for. Or its end may lie beyond the curves that
//! the interrupt knows. Such a stop is not used: the old reserve stays, and the motion gets slower
//! ([`super::slower`]).
//!
//! New pieces that replace others, and the first pieces after a standstill, become valid together with their
//! own reserve ([`super::change`]).
use super::change::Pending;
use super::committed::CommittedSpan;
use super::hold::{Mode, NOTHING};
use super::search::Later;
use super::{Distance, Frontier, Instant, PIECES, Phase, Planning, RingStage, Slot, Speed, Work, clock};

/// Least time before the old reserve at which a new one is made. The second value is the same before blocks
/// are taken and planned, because a slow planner needs this time.
const NEAR: u32 = clock::TICK * 32;
pub(super) const FAR: u32 = clock::TICK * 256;

/// A rarely called planner makes the new reserve earlier, by this multiple of the time between its calls.
const CALLS: u32 = 2;

/// Profiles per call. Each profile may pass many spans.
const LAWS: u32 = 1;

/// The stop in the reserve: when it begins and ends, and where.
#[derive(Clone, Copy, Debug)]
pub(super) struct Way {
    /// The first instant of the stop, and the instant at which the axes stand still.
    pub at: u32,
    end: u32,
    /// Path distance of the stop.
    stands: i64,
    /// Whether the plan stops at this place too.
    as_planned: bool,
}

/// The work that is set aside while a reserve is made.
#[derive(Clone, Copy, Debug)]
pub(super) struct Aside {
    frontier: Frontier,
    pub mode: Mode,
    spans: usize,
    /// A span that gets another profile meanwhile.
    touched: Option<(usize, CommittedSpan)>,
    /// Whether a braking from inside the emitter's profile is still being searched.
    slows: bool,
    /// Whether the next span keeps its own ramps, because no profile with linear ramps exists for it.
    keeps_ramps: bool,
}

/// The state of the reserve: the stop in force, and the stop that is being made.
pub(super) struct Reserve {
    pub kept: Option<Way>,
    pub aside: Option<Aside>,
    /// New pieces that become valid when the reserve is complete.
    pub pending: Option<Pending>,
    /// The span that got another profile for the stop, and whether the rest of the look-ahead begins slower
    /// because of it.
    pub changed: Option<(usize, bool)>,
    pub undone: bool,
    pub waits: bool,
    /// For the stop in progress: the next block of the look-ahead and its path distance. `usize::MAX` if the
    /// stop has to end before the look-ahead.
    next: usize,
    distance: Distance,
    /// Whether the stop so far is only the emitter's profile.
    as_planned: bool,
    /// Path distance of the stop, if it is not in a committed span.
    stands: Option<i64>,
    /// The instant of the last call without work, and the time before the old reserve at which a new one is
    /// made.
    waited: u32,
    pub near: u32,
    /// Start of a stop that has no room. The motion gets slower, and this has not been reported yet.
    pub failed: Option<u32>,
    pub slowed: bool,
    /// Path distance of the stop, if spans up to there are still in the look-ahead.
    pub behind: Option<i64>,
}

impl Reserve {
    pub const fn none() -> Self {
        Self {
            kept: None,
            aside: None,
            pending: None,
            changed: None,
            undone: false,
            waits: false,
            next: 0,
            distance: Distance::ZERO,
            as_planned: false,
            stands: None,
            waited: 0,
            near: NEAR,
            failed: None,
            slowed: false,
            behind: None,
        }
    }

    /// Whether the stop of a new reserve is being made.
    pub const fn is_made(&self) -> bool {
        self.aside.is_some()
    }

    /// Whether a stop is in force, with which the interrupt can continue.
    pub const fn is_kept(&self) -> bool {
        self.kept.is_some()
    }

    /// Whether the new pieces in progress replace the profile of a span, and are not a start from a stop.
    pub fn renews_law(&self) -> bool {
        self.pending.as_ref().is_some_and(Pending::is_command)
    }

    /// Where the stop in progress enters the look-ahead: number of the next block, and its path distance.
    pub const fn ahead(&self) -> (usize, Distance) {
        (self.next, self.distance)
    }

    /// Whether the reserve is only the tick that shows a planned stop.
    fn shows_end(&self) -> bool {
        self.kept.is_some_and(|way| way.as_planned && way.end.wrapping_sub(way.at) == clock::TICK)
    }

    /// Lets the stop in progress continue at the block `next` of the look-ahead, which begins at this path
    /// distance.
    pub const fn go_on_at(&mut self, next: usize, distance: i64) {
        (self.next, self.distance) = (next, Distance::from_bits(distance));
    }

    /// Permits another try of a stop that had no room: the plan of the look-ahead is now complete.
    pub const fn try_again(&mut self) {
        (self.failed, self.waits) = (None, false);
    }

    /// Ends the stop in progress at this path distance.
    pub const fn stand_at(&mut self, distance: i64) {
        self.stands = Some(distance);
    }

    /// Drops the reserve.
    pub fn clear(&mut self) {
        *self = Self { waited: self.waited, ..Self::none() };
    }
}

impl<const AXES: usize, const BLOCKS: usize> Planning<'_, AXES, BLOCKS> {
    /// Does one step of a reserve being made, or of the return after the interrupt has left the queue.
    #[inline(never)]
    pub(super) fn look_after(&mut self) -> Work {
        if self.queue.clock.has_left() {
            self.undo();
            self.take_back();
            return self.go_on_late();
        }
        if self.reserve.pending.is_some() && !self.reserve.is_made() {
            if !self.begin_reserve() {
                self.undo();
            }
            return Work::Working;
        }
        // Commands come first, unless new pieces are already written.
        let called = self.queue.control.word() != self.orders.word && self.reserve.pending.is_none();
        if called || !self.go_on_stopping() {
            self.take_back();
        }
        Work::Working
    }

    /// Begins a reserve if two conditions hold. The queue ends at speed beyond the old reserve. The interrupt
    /// reaches the old reserve within `within` ticks, or within half of the queue.
    #[cfg_attr(feature = "fast", inline(always))]
    pub(super) fn secure(&mut self, within: u32) -> bool {
        self.secure_at(self.queue.clock.now(), within)
    }

    /// As [`Self::secure`], at this instant.
    #[cfg_attr(feature = "fast", inline(always))]
    pub(super) fn secure_at(&mut self, now: u32, within: u32) -> bool {
        let within = (self.frontier.end.wrapping_sub(now) / 2).min(within);
        self.reserve.kept.is_none_or(|way| clock::is_before(way.at, now.wrapping_add(within)))
            && (self.frontier.speed > Speed::ZERO || !self.frontier.emitter.is_done())
            && self.begin_reserve()
    }

    /// Uses a call without other work for the reserve.
    #[cfg_attr(feature = "fast", inline(always))]
    pub(super) fn wait_a_while(&mut self) -> Work {
        let now = self.queue.clock.now();
        let since = now.wrapping_sub(self.reserve.waited).min(1 << 28);
        (self.reserve.waited, self.reserve.near) = (now, (CALLS * since).max(NEAR));
        if self.secure_at(now, self.reserve.near) { Work::Working } else { Work::Waiting }
    }

    /// Replaces the reserve when a profile that stops is in the queue: the new reserve is one tick, which
    /// shows the stop.
    #[inline(never)]
    pub(super) fn keep_end(&mut self) {
        if self.reserve.is_kept() {
            self.drop_reserve();
        }
        // If the stop was demanded, this tick enters the queue at once.
        if !self.orders.mode.stopping && !self.orders.mode.halting {
            self.begin_reserve();
        }
    }

    /// Makes one tick of a standstill the reserve, if the queue ends in a standstill that is far ahead.
    pub(super) fn keep_rest(&mut self) {
        let at = self.frontier.end;
        let Some(motion) = self.motion_at(at).filter(Instant::is_rest) else { return };
        let rest = Phase { distance: Distance::from_bits(motion.distance), ticks: 1, ..Phase::BLANK };
        self.queue.reserve.begin();
        if self.queue.reserve.push(rest) && self.queue.reserve.push(Phase::BLANK) {
            let (end, stands) = (at.wrapping_add(clock::TICK), motion.distance);
            self.hand_over(Some(Way { at, end, stands, as_planned: true }));
        }
    }

    /// The queue continues after the stop, and shows the stop.
    #[cfg_attr(feature = "fast", inline(always))]
    pub(super) fn pass_end(&mut self) {
        if self.reserve.shows_end() && self.reserve.pending.is_none() {
            self.drop_reserve();
        }
    }

    #[inline(never)]
    pub(super) fn begin_reserve(&mut self) -> bool {
        let has_one = self.reserve.kept.is_some_and(|way| way.at == self.frontier.end);
        let failed = self.reserve.failed == Some(self.frontier.end) || has_one;
        let ends = self.frontier.speed == Speed::ZERO;
        let stands = ends && !self.frontier.emitter.has_piece();
        // The rest of a profile that stops is itself a stop.
        let stops = ends && !stands && self.orders.mode.stopping;
        let unplanned = self.task.stage == RingStage::Passing;
        // While the look-ahead is being planned, a new reserve has to end before it. The existing reserve may
        // lead further.
        let has_better = unplanned && self.reserve.is_kept();
        let refused = (has_better || failed || self.comes_down()) && self.reserve.pending.is_none();
        if refused || (self.reserve.behind.is_some() && !stops) {
            return false;
        }
        self.queue.reserve.begin();
        self.set_aside();
        let mode = &self.orders.mode;
        let halts = mode.halting;
        let inside = mode.passed.and_then(|passed| passed.stands);
        // A stop through the look-ahead is known only when the plan of the look-ahead is complete.
        let next = if unplanned { usize::MAX } else { 0 };
        (self.reserve.next, self.reserve.distance) = (next, self.handed);
        self.orders.mode = mode.stop();
        (self.reserve.as_planned, self.reserve.stands) = (stands || stops, None);
        if stops && halts {
            self.reserve.stands = inside.or(self.reserve.behind);
        } else if self.frontier.emitter.has_piece() && !stops {
            self.slow_down();
        }
        if !self.go_on_stopping() {
            self.take_back();
        }
        true
    }

    /// Saves the state that is restored afterwards. This function and the next one are not inlined, so that
    /// only one of their stack frames exists at a time.
    #[inline(never)]
    fn set_aside(&mut self) {
        let (frontier, mode, spans) = (self.frontier, self.orders.mode, self.committed.len());
        self.reserve.aside =
            Some(Aside { frontier, mode, spans, touched: None, slows: false, keeps_ramps: false });
    }

    /// Brakes from inside the emitter's profile.
    #[inline(never)]
    fn slow_down(&mut self) {
        let mut phase = Phase::BLANK;
        self.frontier.emitter.step(&mut phase);
        let motion = Instant {
            distance: phase.distance.to_bits(),
            speed: phase.speed.to_bits(),
            accel: 2 * phase.half_accel.to_bits(),
        };
        let k = self.span_at(motion.distance);
        self.touch(k);
        if motion.speed == 0 {
            // The profile has not begun.
            self.frontier.emitter.resume_at(0);
            (self.frontier.planned, self.frontier.speed, self.orders.mode.halting) = (k, Speed::ZERO, true);
            return;
        }
        self.slow_down_within(k, &motion);
    }

    /// Brakes from this motion on.
    #[inline(never)]
    fn slow_down_within(&mut self, k: usize, motion: &Instant) {
        let descent = self.descend(k, motion);
        let Some(aside) = &mut self.reserve.aside else { return };
        aside.slows = descent.is_err();
        match descent {
            Ok(Some(descent)) => {
                self.frontier.emitter.resume_at(0);
                self.go_down(k, &descent);
            }
            Ok(None) => {
                self.frontier.emitter = aside.frontier.emitter;
                self.reserve.as_planned = true;
            }
            Err(Later) => {}
        }
    }

    /// The span of the emitter's profile, at this path distance. A span with a braking may have no other
    /// profile yet.
    fn span_at(&self, distance: i64) -> usize {
        let mut k = self.frontier.planned;
        let is_within = |committed: &CommittedSpan| distance.wrapping_sub(committed.end()) < 0;
        while k > 0 && self.committed.get(k - 1).is_some_and(is_within) {
            k -= 1;
        }
        k
    }

    /// Saves the span `k` before it gets another profile. Its state is restored afterwards.
    fn touch(&mut self, k: usize) {
        self.restore_touched();
        let begins = self.committed.begins(k);
        let renews = self.reserve.pending.as_ref().is_some_and(|pending| pending.renews(k));
        if let (Some(aside), Some(committed)) = (&mut self.reserve.aside, self.committed.get_mut(k)) {
            aside.touched = Some((k, *committed));
            if renews {
                committed.restore(begins);
            }
        }
    }

    fn restore_touched(&mut self) {
        if let Some(aside) = &mut self.reserve.aside
            && let Some((k, before)) = aside.touched.take()
            && let Some(committed) = self.committed.get_mut(k)
        {
            *committed = before;
        }
    }

    /// Does one step of the stop. Returns `false` if the stop is complete or impossible.
    fn go_on_stopping(&mut self) -> bool {
        if self.reserve.aside.as_ref().is_some_and(|aside| aside.slows) {
            let (k, motion) = self.orders.search.begins();
            self.slow_down_within(k, &motion);
            return true;
        }
        for _ in 0..LAWS {
            for _ in 0..PIECES {
                if !self.frontier.emitter.has_piece() {
                    break;
                }
                let mut phase = Phase::BLANK;
                self.frontier.emitter.step(&mut phase);
                if !self.put_aside(phase) {
                    return false;
                }
            }
            if self.frontier.emitter.has_piece() {
                return true;
            }
            if self.orders.mode.halting || self.frontier.speed == Speed::ZERO {
                self.keep();
                return false;
            }
            if !self.lay_next() {
                return self.fail();
            }
        }
        true
    }

    /// Writes a piece of the stop to the reserve.
    fn put_aside(&mut self, phase: Phase) -> bool {
        self.frontier.end = self.frontier.end.wrapping_add(clock::TICK * u32::from(phase.ticks));
        self.queue.reserve.push(phase) || self.fail()
    }

    /// Makes the profile of the next span, a released one or one of the look-ahead.
    #[inline(never)]
    fn lay_next(&mut self) -> bool {
        let Some(Aside { spans, touched, .. }) = &self.reserve.aside else { return false };
        let (spans, touched) = (*spans, touched.as_ref().map(|(k, _)| *k));
        self.reserve.as_planned = false;
        if self.frontier.planned >= spans {
            if self.frontier.planned == self.committed.len() {
                self.committed.truncate(spans);
                self.frontier.planned = spans;
                let Some(committed) = self.committed.spare() else { return false };
                let next = self.reserve.next;
                if next == usize::MAX || !self.lookahead.ring.planned(next, &mut committed.span) {
                    return false;
                }
                // The stop would leave the part of the path that the interrupt knows.
                if !self.queue.segments.is_known(self.reserve.distance) {
                    return false;
                }
                committed.begin(self.reserve.distance);
                self.reserve.next += usize::from(committed.span.blocks);
                self.reserve.distance = Distance::from_bits(committed.end());
                self.committed.push();
            }
        } else if touched != Some(self.frontier.planned) {
            self.touch(self.frontier.planned);
        }
        // A ramp of SIN2 has many pieces. A linear ramp with the mean jerk also keeps the limits, with few
        // pieces. If the four ramps differ, the linear profile may need more path than is left.
        let keeps_ramps =
            self.reserve.aside.as_mut().is_some_and(|aside| core::mem::take(&mut aside.keeps_ramps));
        let Some(committed) = self.committed.get_mut(self.frontier.planned) else { return false };
        let law = committed.span.limits.law;
        if !keeps_ramps {
            committed.span.limits.straighten();
        }
        let is_straight = committed.span.limits.law != law;
        let is_laid = self.lay();
        if is_laid == Ok(true) {
            return true;
        }
        let (Some(committed), Some(aside)) =
            (self.committed.get_mut(self.frontier.planned), &mut self.reserve.aside)
        else {
            return false;
        };
        committed.span.limits.law = law;
        aside.keeps_ramps = if is_laid.is_ok() { keeps_ramps } else { is_straight };
        is_laid.is_ok() || is_straight
    }

    /// Completes the reserve: the interrupt may use it.
    fn keep(&mut self) {
        let Some(aside) = &self.reserve.aside else { return };
        let at = aside.frontier.end;
        let k = if self.orders.mode.halting {
            self.frontier.planned
        } else {
            self.frontier.planned.wrapping_sub(1)
        };
        let in_span = |committed: &CommittedSpan| {
            if self.orders.mode.halting { committed.start.to_bits() } else { committed.end() }
        };
        let Some(stands) = self.reserve.stands.or_else(|| self.committed.get(k).map(in_span)) else { return };
        let rest = Phase { distance: Distance::from_bits(stands), ticks: 1, ..Phase::BLANK };
        if !self.queue.segments.is_known(rest.distance) {
            self.fail();
            return;
        }
        if !self.put_aside(rest) || !self.put_aside(Phase::BLANK) {
            return;
        }
        let as_planned = self.reserve.as_planned;
        self.rise();
        self.hand_over(Some(Way { at, end: self.frontier.end, stands, as_planned }));
    }

    /// Continues the work that was set aside.
    fn take_back(&mut self) {
        self.drop_aside();
        self.take_over();
    }

    /// Restores the work that was set aside.
    pub(super) fn drop_aside(&mut self) {
        self.restore_touched();
        let Some(aside) = &self.reserve.aside else { return };
        (self.frontier, self.orders.mode) = (aside.frontier, aside.mode);
        self.committed.truncate(aside.spans);
        self.reserve.aside = None;
    }

    /// Withdraws the reserve before profiles in the queue change; the next reserve follows later. Returns
    /// `false` if the interrupt already uses the reserve.
    pub(super) fn drop_reserve(&mut self) -> bool {
        if self.queue.clock.has_left() || !self.queue.reserve.drop_kept(self.queue.clock) {
            return false;
        }
        self.reserve.kept = None;
        self.reserve.failed = None;
        true
    }

    /// Continues after the interrupt has used the reserve: all further motion begins at its stop.
    fn go_on_late(&mut self) -> Work {
        let Some(way) = self.reserve.kept else {
            self.queue.clock.let_go();
            return Work::Working;
        };
        if self.queue.clock.now() != way.end {
            return Work::Waiting;
        }
        self.queue.clock.withdraw();
        let void = self.queue.phases.taken();
        self.queue.phases.withdraw(void);
        self.queue.reserve.clear();
        self.reserve.kept = None;
        self.reserve.failed = None;
        self.reserve.behind = Some(way.stands);
        self.frontier.end = way.end;
        self.frontier.speed = Speed::ZERO;
        self.frontier.stops = false;
        self.frontier.emitter.resume_at(0);
        self.orders.mode = Mode::AGAIN;
        self.put_rest(Distance::from_bits(way.stands), 1);
        (self.frontier.pending_dwell, self.frontier.planned) = (0, 0);
        while self.frontier.planned < self.committed.len() && self.is_behind(self.frontier.planned) {
            self.frontier.planned += 1;
        }
        let made = self.frontier.planned;
        self.committed.restore_from(made + 1);
        self.queue.clock.let_go();
        if way.as_planned { Work::Working } else { Work::Late }
    }

    /// Whether the span `k` is after the stop. Otherwise, the span begins at the stop.
    pub(super) fn is_behind(&mut self, k: usize) -> bool {
        let begins = self.committed.begins(k);
        let (Some(stands), Some(committed)) = (self.reserve.behind, self.committed.get_mut(k)) else {
            return false;
        };
        if committed.end().wrapping_sub(stands) <= NOTHING {
            // The span has begun, so that a command does not change it.
            committed.first = self.frontier.end.wrapping_sub(clock::TICK);
            self.frontier.pending_dwell = u64::from(committed.rest);
            return true;
        }
        committed.restore(begins);
        if stands.wrapping_sub(committed.start.to_bits()) > 0 {
            committed.begin_at(stands, Speed::ZERO);
        }
        self.frontier.pending_dwell = 0;
        self.reserve.behind = None;
        false
    }
}

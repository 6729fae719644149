//! The operator's commands in the planner: standing still on the path, going on, forgetting the rest.
//!
//! A standstill is wanted while up to [`crate::queue::PHASES`] pieces of a faster motion are in the queue.
//! The planner finds the span and the motion a few ticks ahead, plans the way to a standstill from there
//! ([`Brake`]) and has the interrupt change over at that tick ([`clock`]). If the span is too short to stop,
//! the spans behind it are planned in the same way, each with its own limits, until one is long enough; the
//! last span known always is. A span that already slows down as hard as it can keeps its law, and the change
//! begins with the next one.
//!
//! Going on begins at rest, once the interrupt has come to the standstill, even if it is wanted before. What is
//! left of a span then gets another law (`super::law`).
//!
//! A dwell runs on during a feed hold; the motion behind it waits. Time of rest begins only after the motion
//! before it is complete. An abort ends a dwell.
use super::clock;
use super::committed::CommittedSpan;
use super::descent::{Descent, Passed};
use super::search::Later;
use super::{Commands, Control, Distance, Instant, KEPT_FREE, Planning, RingStage, Speed, Unplannable, Work};
use crate::queue::{Change, Cut, PHASES};
use crate::smooth::Smoother;

/// Ticks from a command to the change: the time in which the planner makes the new profile.
pub const REACTION: u32 = 4;

/// Ticks before the start of a motion from which on another law for it is handed over: a dwell may be before
/// it, and there is one change at a time.
const NEAR: u32 = 64;

/// A way down is looked at anew where it has lost that power of two of its speed since the last time, if it has
/// so many ticks left. Another one is shorter by that power of two.
const SLOWED: u32 = 3;
const WORTH: u32 = 8;
const SHORTER: u32 = 5;

/// Path shorter than that (2^-44 mm) is less than the rounding of a set point.
pub(super) const NOTHING: i64 = 1 << 10;

/// Where the commands stand.
#[derive(Clone, Copy, Debug)]
pub(super) struct Mode {
    /// There is something to do for the commands, or to be told.
    pub(super) busy: bool,
    /// The profiles lead to a stop.
    pub stopping: bool,
    /// Laws in the queue may have been made for another pace.
    pub(super) adjusting: bool,
    /// Spans without a law may have had one before, which began at another speed.
    pub(super) uneven: bool,
    /// The law with the emitter ends in it.
    pub(super) halting: bool,
    /// It is handed out.
    standing: bool,
    /// The cut that may be pending, and the last instant at which one was tried.
    pub(super) cut: Option<Cut>,
    pub(super) tried: Option<u32>,
    /// What a way down passes, until its spans know.
    pub(super) passed: Option<Passed>,
    /// At that speed a shorter way down is looked for: [`Planning::stand_sooner`].
    slowed: Speed,
}

impl Mode {
    /// No command.
    pub const RUN: Self = Self {
        busy: false,
        stopping: false,
        adjusting: false,
        uneven: false,
        halting: false,
        standing: false,
        cut: None,
        tried: None,
        passed: None,
        slowed: Speed::ZERO,
    };

    /// The state after a stop that no command asked for: the commands are to be read again.
    pub const AGAIN: Self = Self { busy: true, uneven: true, ..Self::RUN };

    /// A way to a standstill is handed out.
    pub(super) const fn is_standing(&self) -> bool {
        self.standing
    }

    /// The same state, and a stop is made after the profile with the emitter, whatever the commands are.
    pub const fn stop(self) -> Self {
        Self { busy: true, stopping: true, uneven: true, halting: self.halting, ..Self::RUN }
    }
}

impl<const AXES: usize, const BLOCKS: usize> Planning<'_, AXES, BLOCKS> {
    /// Follows the commands, if there is something to do for them.
    #[cfg_attr(feature = "fast", inline(always))]
    pub(super) fn attend(&mut self) -> Option<Work> {
        self.orders.search.begin_call();
        let word = self.queue.control.word();
        let is_changed = word != self.orders.word || self.reserve.pending.is_some();
        let is_called = self.orders.mode.busy || is_changed || self.queue.clock.has_left();
        if is_called { self.follow(word) } else { None }
    }

    #[inline(never)]
    fn follow(&mut self, word: u32) -> Option<Work> {
        if self.reserve.is_made() || self.reserve.pending.is_some() || self.queue.clock.has_left() {
            return Some(self.look_after());
        }
        if core::mem::take(&mut self.reserve.slowed) {
            return Some(Work::Slower);
        }
        let mut commands = Commands::of(word);
        // A law that failed ends the motion as an abort does.
        commands.abort |= self.orders.failed;
        // An acknowledgement to be looked at makes every word a new one.
        let word = word & Control::COMMANDS;
        if word != self.orders.word {
            self.orders.word = word;
            self.orders.search.forget();
            #[cfg(feature = "plc")]
            self.settle(false);
            // At a standstill no tick of motion passes: another command is tried at the same instant.
            self.orders.mode.tried = None;
            // All spans at hand were gone through: that is work, unless other work was put off for it before.
            let is_paced = self.set_pace(&commands);
            self.orders.trying = is_paced && !self.orders.yields;
        }
        self.orders.mode.busy = true;
        if let Some(work) = self.answer() {
            return Some(work);
        }
        let work = if self.orders.mode.stopping {
            self.hold(&commands)
        } else if commands.standstill() {
            self.stop(commands.abort)
        } else if self.orders.mode.adjusting {
            self.adjust()
        } else {
            None
        };
        self.orders.mode.busy = self.orders.mode.stopping
            || self.orders.mode.adjusting
            || commands.standstill()
            || self.task.joining
            || self.queue.control.is_answered();
        // A try that changed nothing is work in a call of its own; other work has the next one.
        let tried = core::mem::take(&mut self.orders.trying);
        self.orders.yields = tried && work.is_none();
        if tried && matches!(work, None | Some(Work::Waiting)) { Some(Work::Working) } else { work }
    }

    // What follows is not inlined: of what each has on the stack, only one is there at a time.

    /// On the way to a standstill, and in it.
    #[inline(never)]
    fn hold(&mut self, commands: &Commands) -> Option<Work> {
        if commands.abort {
            self.end_rest();
        }
        if !self.orders.mode.standing {
            return None;
        }
        if !self.orders.search.is_paused() {
            self.trim();
        }
        // What has been handed out holds: a span knows of one standstill only.
        if self.queue.clock.now() != self.frontier.end {
            return Some(self.stand_sooner().unwrap_or(Work::Waiting));
        }
        if commands.abort {
            if self.queue.control.commands().abort {
                self.queue.control.aborted();
            }
            self.forget();
            return Some(Work::Aborted);
        }
        if commands.standstill() {
            return Some(Work::Waiting);
        }
        self.orders.mode = Mode { cut: self.orders.mode.cut, ..Mode::RUN };
        None
    }

    /// The slower the motion, the more deceleration the axes have for it, and what was in its way is behind. So
    /// on its way down another one takes its place, if that is shorter by a part.
    #[inline(never)]
    fn stand_sooner(&mut self) -> Option<Work> {
        #[cfg(feature = "plc")]
        if self.keeps_stop() {
            return None;
        }
        let paused = self.paused();
        let soon = || self.queue.clock.now().wrapping_add(clock::TICK * self.orders.lead);
        let at = paused.map_or_else(soon, |(at, _)| at);
        let worth = clock::is_before(at.wrapping_add(clock::TICK * WORTH), self.frontier.end);
        if !worth || self.orders.mode.cut.is_some() || self.reserve.behind.is_some() {
            return None;
        }
        let motion = self.motion_at(at)?;
        if paused.is_none() && !self.has_slowed(&motion) {
            return None;
        }
        self.orders.trying = true;
        let stands = self.motion_at(self.frontier.end)?.distance;
        let k = (0..self.committed.len()).find(|&k| {
            self.committed.get(k).is_some_and(|committed| committed.end().wrapping_sub(motion.distance) > 0)
        })?;
        let Ok(descent) = self.descend(k, &motion) else {
            self.orders.search.pause((at, k), false);
            return None;
        };
        let descent = descent?;
        let [way, now] = [descent.brake.end, stands].map(|end| end.wrapping_sub(motion.distance));
        if descent.brake.v_out > 0 || way >= now - (now >> SHORTER) {
            return None;
        }
        let work = self.change(k, at, Some(descent))?;
        // All of it is handed out, or nothing of it counts.
        if self.reserve.pending.is_some() {
            self.undo();
            return None;
        }
        // Spans that the other way passed were to begin at its end.
        let passed = |committed: &&mut CommittedSpan| clock::is_before(at, committed.first);
        for committed in self.committed.among(0, k + 1).filter(passed) {
            committed.first = at;
        }
        Some(work)
    }

    /// Whether the motion is slow enough for another look at its way down. The first one notes the speed alone: the way
    /// in the queue is still new.
    fn has_slowed(&mut self, motion: &Instant) -> bool {
        let slowed = self.orders.mode.slowed.to_bits();
        let is_slow = motion.speed <= slowed;
        if is_slow || slowed == 0 {
            self.orders.mode.slowed = Speed::from_bits(motion.speed - (motion.speed >> SLOWED));
        }
        is_slow && slowed > 0
    }

    /// What is left of a dwell goes, if nothing but that is left.
    #[inline(never)]
    fn end_rest(&mut self) {
        self.frontier.pending_dwell = 0;
        self.trim();
        let at = self.queue.clock.now().wrapping_add(clock::TICK * REACTION);
        let last = self.frontier.end.wrapping_sub(clock::TICK);
        if !clock::is_before(at, last) || self.orders.mode.cut.is_some() || self.queue.phases.room() < 2 {
            return;
        }
        let (Some(motion), Some(end)) = (self.motion_at(at), self.motion_at(last)) else { return };
        if motion != end || !motion.is_rest() {
            return;
        }
        let before = self.frontier.end;
        let change = Change::begin(&mut self.queue.phases);
        self.frontier.end = at;
        self.put_rest(Distance::from_bits(motion.distance), 1);
        match change.hand_over(at, None, &mut self.queue.phases, &mut self.queue.reserve, self.queue.clock) {
            Ok(cut) => {
                self.orders.mode.cut = cut;
                // It was behind what is gone.
                (self.reserve.kept, self.reserve.failed) = (None, None);
            }
            Err(_) => self.frontier.end = before,
        }
    }

    /// Whether the motion stands still because the operator wants it to.
    pub fn is_holding(&self) -> bool {
        self.orders.mode.standing && self.queue.clock.now() == self.frontier.end
    }

    /// Whether there is nothing that moves or may move.
    pub fn is_idle(&self) -> bool {
        let left = self.queue.clock.has_left();
        let empty = self.committed.len() == 0 && self.lookahead.ring.is_empty();
        empty && self.task.rest == 0 && !left && !self.orders.failed
    }

    /// Spans that the interrupt has left are over, and so is a cut it has passed. On its way to a standstill it is
    /// slower than they are: none of them is over by its time. An instant that was read before that is one of theirs.
    /// The instant of now.
    #[inline]
    pub(super) fn trim(&mut self) -> u32 {
        let now = self.queue.clock.now();
        if self.orders.mode.cut.is_some_and(|Cut(at)| clock::is_before(at, now)) {
            self.queue.clock.withdraw();
            self.orders.mode.cut = None;
        }
        while self.frontier.planned >= 2
            && self.committed.get(1).is_some_and(|next| !clock::is_before(now, next.first))
            && !self.queue.clock.has_left()
        {
            self.committed.drop_first();
            self.frontier.planned -= 1;
        }
        now
    }

    /// The way to a standstill takes the place of what is in the queue.
    #[inline(never)]
    fn stop(&mut self, abort: bool) -> Option<Work> {
        let (at, later) = self.attempt()?;
        let skips = self.orders.search.skips();
        let mut next = later;
        if let Some((k, committed)) = later.checked_sub(1).and_then(|k| Some((k, self.committed.get(k)?))) {
            if committed.first == at {
                next = k;
            } else if !skips
                && !self.is_settled()
                && let Some(motion) = self.motion_at(at)
                && let Some(descent) = match self.descend(k, &motion) {
                    Ok(descent) => {
                        #[cfg(feature = "plc")]
                        self.settle(descent.is_none());
                        descent
                    }
                    Err(Later) => {
                        self.orders.search.pause((at, later), false);
                        return Some(Work::Working);
                    }
                }
            {
                let waits = self.task.stage == RingStage::Passing && !self.orders.failed;
                if waits && descent.brake.v_out > 0 && !self.is_stage(k, &descent) {
                    // The way through the look-ahead is known when its plan is complete.
                    return None;
                }
                return self.stop_at(k, at, Some(descent));
            }
        }
        // From the start of the next span that has a tick.
        next = self.with_tick(next);
        let stops = match self.committed.get(next) {
            Some(committed) if next < self.frontier.planned => {
                let first = committed.first;
                if abort && next > 0 && self.motion_at(at).is_some_and(|motion| motion.is_rest()) {
                    // In a dwell.
                    self.stop_at(next, at, None)
                } else if self.is_far(first) {
                    None
                } else {
                    self.stop_at(next, first, None)
                }
            }
            _ => {
                self.orders.mode.stopping = true;
                None
            }
        };
        if stops.is_none() && self.orders.search.goes_on() {
            self.orders.search.pause((at, later), true);
            return Some(Work::Working);
        }
        stops
    }

    /// Whether the law at hand stays up to its end, as an answer to a question may say.
    #[cfg(feature = "plc")]
    const fn is_settled(&self) -> bool {
        self.orders.settled
    }

    /// Whether the law at hand stays up to its end.
    #[cfg(not(feature = "plc"))]
    const fn is_settled(&self) -> bool {
        false
    }

    fn stop_at(&mut self, k: usize, at: u32, descent: Option<Descent>) -> Option<Work> {
        self.orders.mode.stopping = true;
        let work = self.change(k, at, descent);
        self.orders.mode.stopping = work.is_some();
        work
    }

    /// The instant of a change decided now, and the first span that begins behind it: one change at a time,
    /// and one attempt a tick.
    pub(super) fn attempt(&mut self) -> Option<(u32, usize)> {
        if let Some(paused) = self.paused() {
            self.orders.trying = true;
            return Some(paused);
        }
        let now = self.trim();
        let waits = self.reserve.waits && self.task.stage == RingStage::Passing;
        // A change has no room: nothing is looked for.
        if waits
            || self.queue.phases.room() < KEPT_FREE
            || self.orders.yields
            || self.orders.mode.tried == Some(now)
            || self.orders.mode.cut.is_some()
        {
            return None;
        }
        self.orders.mode.tried = Some(now);
        self.orders.trying = true;
        let at = now.wrapping_add(clock::TICK * self.orders.lead);
        let at = if clock::is_before(at, self.frontier.end) { at } else { self.frontier.end };
        let begun = |committed: &CommittedSpan| !clock::is_before(at, committed.first);
        let later = (0..self.frontier.planned)
            .find(|&k| !self.committed.get(k).is_some_and(begun))
            .unwrap_or(self.frontier.planned);
        Some((at, later))
    }

    /// Whether that is too far ahead to hand over what is to happen then.
    pub(super) fn is_far(&self, instant: u32) -> bool {
        clock::is_before(self.queue.clock.now().wrapping_add(clock::TICK * NEAR), instant)
    }

    /// The span `k` or, if it is over before its first tick, the next one that is not.
    pub(super) fn with_tick(&self, mut k: usize) -> usize {
        while k + 1 < self.frontier.planned
            && self.committed.get(k).map(|f| f.first) == self.committed.get(k + 1).map(|f| f.first)
        {
            k += 1;
        }
        k
    }

    /// The motion at an instant that the pieces in the queue or their end cover.
    pub(super) fn motion_at(&self, at: u32) -> Option<Instant> {
        let mut start = self.frontier.end;
        let mut number = self.queue.phases.count();
        for _ in 0..PHASES {
            number = number.wrapping_sub(1);
            let phase = self.queue.phases.recent(number)?;
            start = start.wrapping_sub(clock::TICK * u32::from(phase.ticks));
            if clock::is_before(at, start) {
                continue;
            }
            let ticks = at.wrapping_sub(start) / clock::TICK;
            let n = i64::from(ticks);
            let (half, sixth) = (phase.half_accel.to_bits(), phase.sixth_jerk.to_bits());
            let gained = n.wrapping_mul(3).wrapping_mul(sixth);
            return Some(Instant {
                distance: phase.at(ticks as u16),
                speed: phase.speed.to_bits().wrapping_add(n.wrapping_mul(gained.wrapping_add(2 * half))),
                accel: gained.wrapping_add(half).wrapping_mul(2),
            });
        }
        None
    }

    /// The law with the emitter, which ended inside a span, is handed out: a tick shows where it stands.
    pub(super) fn stand_inside(&mut self) {
        self.orders.mode.halting = false;
        self.orders.mode.standing = true;
        let stands = self.reserve.behind.map(Distance::from_bits);
        if let Some(stands) =
            self.committed.get(self.frontier.planned).map(|committed| committed.start).or(stands)
        {
            self.put_rest(stands, 1);
        }
    }

    /// What comes before new spans once a law is handed out.
    #[inline(never)]
    pub(super) fn catch_up(&mut self) -> Result<Option<Work>, Unplannable> {
        if self.orders.mode.halting {
            self.stand_inside();
            return Ok(Some(Work::Working));
        }
        if self.frontier.pending_dwell > 0 {
            let at = self.committed.get(self.frontier.planned - 1).map_or(self.handed, |committed| {
                Distance::from_bits(committed.start.to_bits().wrapping_add(committed.span.length.to_bits()))
            });
            self.frontier.pending_dwell = self.put_rest(at, self.frontier.pending_dwell);
            return Ok(Some(Work::Working));
        }
        let all = self.frontier.planned == self.committed.len() && self.lookahead.ring.is_empty();
        if self.orders.mode.stopping && (self.frontier.speed == Speed::ZERO || all) {
            self.orders.mode.standing = true;
            self.show_end();
            return Ok(Some(Work::Working));
        }
        if self.frontier.planned < self.committed.len() {
            // Many laws may be to be made: meanwhile the queue ends early.
            if self.secure(self.reserve.near) {
                return Ok(Some(Work::Working));
            }
            let is_made = self.lay().map_err(|error| self.fail_to_plan(error))?;
            let is_told = is_made && core::mem::take(&mut self.report.is_due);
            return Ok(Some(if is_told { Work::Planned } else { Work::Working }));
        }
        Ok(None)
    }

    /// A law ends between two ticks. Where no other one follows, a tick of rest shows its end. There is room.
    fn show_end(&mut self) {
        let last = self.frontier.end.wrapping_sub(clock::TICK);
        let moves = self.motion_at(last).is_some_and(|motion| !motion.is_rest());
        let ended =
            self.frontier.planned.checked_sub(1).and_then(|k| self.committed.get(k)).map(CommittedSpan::end);
        if let (true, Some(end)) = (moves, ended) {
            self.put_rest(Distance::from_bits(end), 1);
        }
    }

    /// There is no law for the next span. The motion at hand comes to a standstill as with an abort: its way
    /// down is another law. Where that fails too, it ends where the queue does.
    #[cold]
    #[inline(never)]
    pub(super) fn fail_to_plan(&mut self, error: Unplannable) -> Unplannable {
        if core::mem::replace(&mut self.orders.failed, true) {
            if let Some(motion) = self.motion_at(self.frontier.end) {
                self.put_rest(Distance::from_bits(motion.distance), 1);
            }
            self.frontier.speed = Speed::ZERO;
            (self.orders.mode.stopping, self.orders.mode.standing) = (true, true);
        }
        (self.orders.mode.busy, self.orders.mode.tried) = (true, None);
        error
    }

    /// Where it stands is all that is left. The interrupt has nothing to do.
    pub(super) fn forget(&mut self) {
        let number = self.queue.segments.taken();
        let stands =
            self.motion_at(self.frontier.end).map_or(self.handed.to_bits(), |motion| motion.distance);
        if let Some(track) = self.queue.segments.recent(number) {
            let along = stands.wrapping_sub(self.queue.segments.start(number));
            self.intake.entered = track.point(along);
            // At the end of all that was handed on, no block of the look-ahead has begun.
            if along > 0 || number != self.queue.segments.curve_of(self.queue.segments.handed()) {
                self.report.begun = self.queue.segments.block_of(track.segment).wrapping_add(1);
            }
        }
        // The interrupt keeps the curve it is on, somewhere in it. The point where it stands comes next.
        self.queue.segments.end_at(stands);
        self.handed = self.queue.segments.end();
        self.stay_here(self.report.begun.saturating_sub(1));
        let is_due = |point: Distance| stands.wrapping_sub(point.to_bits()) >= 0;
        let mut action = self.queue.actions.first_open();
        while self.queue.actions.open(action).is_some_and(is_due) {
            action = action.wrapping_add(1);
        }
        self.queue.actions.withdraw(action);
        // A tick at hand may look at those.
        self.queue.clock.settle();
        self.functions.clear(self.queue.control);
        (self.task.reopened, self.task.joining, self.task.stood) = (false, false, false);
        self.intake.stand();
        self.intake.taken = self.report.begun;
        self.intake.smoothing.clear();
        self.intake.held.clear();
        self.lookahead.clear();
        self.task.stage = super::RingStage::Filling;
        self.task.flush = false;
        self.task.rest = 0;
        self.frontier.pending_dwell = 0;
        self.committed.truncate(0);
        self.frontier.planned = 0;
        self.frontier.emitter.settle();
        self.drop_reserve();
        self.reserve.clear();
        self.orders.mode = Mode { cut: self.orders.mode.cut, ..Mode::RUN };
        self.orders.failed = false;
        self.orders.search.forget();
        self.report.is_due = false;
    }
}

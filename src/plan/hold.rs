//! Carries out the operator's commands feed hold, resume and abort.
//!
//! At a feed hold, the queue holds up to [`crate::queue::PHASES`] pieces of the faster motion. The planner
//! computes the motion a few ticks ahead ([`REACTION`], or more after a late try), and plans a stop from
//! there ([`Brake`](crate::slope::brake::Brake)). The interrupt changes to the stop at that tick ([`clock`]).
//! If the span is too short for the stop, the following spans brake too, each within its own limits. The plan
//! ends in a stop, so the known path is always long enough. If a span already brakes as hard as possible, its
//! profile stays, and the stop begins with the next span.
//!
//! A resume takes effect when the axes stand still, even if the command comes earlier. The rest of the span
//! then gets a new profile (`super::law`).
//!
//! A feed hold does not interrupt a dwell, but the motion after the dwell waits. An abort ends a dwell.
use super::clock;
use super::committed::CommittedSpan;
use super::descent::{Descent, Passed};
use super::search::Later;
use super::{Commands, Control, Distance, Instant, KEPT_FREE, Planning, RingStage, Speed, Unplannable, Work};
use crate::queue::{Change, Cut, PHASES};
use crate::smooth::Smoother;

/// Number of ticks from a command to the change of motion. In this time, the planner makes the new profile.
pub const REACTION: u32 = 4;

/// A new profile is handed over at most this number of ticks before its motion starts. A dwell may come
/// first, and only one change exists at a time.
const NEAR: u32 = 64;

/// While braking, the planner searches for a shorter stop each time the speed has dropped by its 2^`SLOWED`th
/// part, if at least `WORTH` ticks are left. A new stop must be shorter by its 2^`SHORTER`th part.
const SLOWED: u32 = 6;
const WORTH: u32 = 8;
const SHORTER: u32 = 6;

/// A path shorter than this (LSB 2^-44 mm) is below the rounding of a set point.
pub(super) const NOTHING: i64 = 1 << 10;

/// How far the operator's commands are carried out.
#[derive(Clone, Copy, Debug)]
pub(super) struct Mode {
    /// Whether the commands need work or a report.
    pub(super) busy: bool,
    /// Whether the profiles lead to a stop.
    pub stopping: bool,
    /// Whether profiles in the queue may have been made for another override.
    pub(super) adjusting: bool,
    /// Whether spans without a profile may have had one before, which began at another speed.
    pub(super) uneven: bool,
    /// Whether the emitter's profile ends in the stop.
    pub(super) halting: bool,
    /// Whether the stop is in the queue.
    standing: bool,
    /// The cut that may be pending, and the instant of the last try: of a change, or while standing of a shorter stop.
    pub(super) cut: Option<Cut>,
    pub(super) tried: Option<u32>,
    /// The spans that a braking passes, until they are marked.
    pub(super) passed: Option<Passed>,
    /// Speed at which a shorter stop is searched: [`Planning::stand_sooner`].
    slowed: Speed,
}

impl Mode {
    /// The state without commands.
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

    /// The state after a stop that no command asked for: the commands have to be read again.
    pub const AGAIN: Self = Self { busy: true, uneven: true, ..Self::RUN };

    /// Whether a stop is in the queue.
    pub(super) const fn is_standing(&self) -> bool {
        self.standing
    }

    /// The same state, but the motion stops at the end of the current profile, whatever the commands are.
    pub const fn stop(self) -> Self {
        Self { busy: true, stopping: true, uneven: true, halting: self.halting, ..Self::RUN }
    }
}

impl<const AXES: usize, const BLOCKS: usize> Planning<'_, AXES, BLOCKS> {
    /// Carries out commands, if they need work.
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
        // After a profile that failed, the motion ends as with an abort.
        commands.abort |= self.orders.failed;
        // Acknowledgements also change the word.
        let word = word & Control::COMMANDS;
        if word != self.orders.word {
            self.orders.word = word;
            self.orders.search.forget();
            #[cfg(feature = "plc")]
            self.settle(false);
            // At a standstill, the instant does not change, so another command is tried at the same instant.
            self.orders.mode.tried = None;
            // The call has looked at all committed spans. This counts as work, unless other work was
            // postponed for it.
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
        // A try that changed nothing uses the call; the next call does other work.
        let tried = core::mem::take(&mut self.orders.trying);
        self.orders.yields = tried && work.is_none();
        if tried && matches!(work, None | Some(Work::Waiting)) { Some(Work::Working) } else { work }
    }

    // The following functions are not inlined, so that only one of their stack frames exists at a time.

    /// Begins a stop, or continues to work on it.
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
        // Pieces in the queue stay: a span can hold only one stop.
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

    /// Replaces the current stop by another one, if that stop is sufficiently shorter. At a lower speed, the
    /// axes permit more deceleration, and narrow bends may already have been passed.
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
        if !worth || self.orders.mode.cut.is_some() {
            return None;
        }
        // To find the motion, a call goes through all pieces of the stop. This is its work; the next call
        // waits.
        if paused.is_none() && self.orders.mode.tried.replace(at) == Some(at) {
            return None;
        }
        self.orders.trying = true;
        let motion = self.motion_at(at)?;
        if paused.is_none() && !self.has_slowed(&motion) {
            return None;
        }
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
        // This stop is shorter, so it need not lead into the look-ahead as the other one did.
        let behind = self.reserve.behind.take();
        let work = self.change(k, at, Some(descent));
        if work.is_none() {
            self.reserve.behind = behind;
        }
        let work = work?;
        // The stop is completely in the queue, or none of it is valid.
        if self.reserve.pending.is_some() {
            self.undo();
            self.reserve.behind = behind;
            return None;
        }
        // Spans that the other stop passed had their start at its end.
        let passed = |committed: &&mut CommittedSpan| clock::is_before(at, committed.first);
        for committed in self.committed.among(0, k + 1).filter(passed) {
            committed.first = at;
        }
        Some(work)
    }

    /// Whether the motion is slow enough for another search. The first call only stores the speed, because
    /// the stop in the queue is still new.
    fn has_slowed(&mut self, motion: &Instant) -> bool {
        let slowed = self.orders.mode.slowed.to_bits();
        let is_slow = motion.speed <= slowed;
        if is_slow || slowed == 0 {
            self.orders.mode.slowed = Speed::from_bits(motion.speed - (motion.speed >> SLOWED));
        }
        is_slow && slowed > 0
    }

    /// Drops the rest of a dwell, if no motion is left.
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
                // The reserve came after the dropped dwell.
                (self.reserve.kept, self.reserve.failed) = (None, None);
            }
            Err(_) => self.frontier.end = before,
        }
    }

    /// Whether the axes stand still because of a feed hold.
    pub fn is_holding(&self) -> bool {
        self.orders.mode.standing && self.queue.clock.now() == self.frontier.end
    }

    /// Whether the axes stand still, no motion is planned, and no block waits in the look-ahead.
    pub fn is_idle(&self) -> bool {
        let left = self.queue.clock.has_left();
        let empty = self.committed.len() == 0 && self.lookahead.ring.is_empty();
        empty && self.task.rest == 0 && !left && !self.orders.failed
    }

    /// Removes spans and a cut that the interrupt has passed. A motion that brakes to a stop is slower than
    /// planned, so its spans do not end at their planned time. An instant that was read before this call is
    /// valid for the removed spans. Returns the current instant.
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

    /// Replaces the motion in the queue by a stop.
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
                    // A stop through the look-ahead is known only when the plan of the look-ahead is
                    // complete.
                    return None;
                }
                return self.stop_at(k, at, Some(descent));
            }
        }
        // The stop begins at the start of the next span that has a tick.
        next = self.with_tick(next);
        let stops = match self.committed.get(next) {
            Some(committed) if next < self.frontier.planned => {
                let first = committed.first;
                if abort && next > 0 && self.motion_at(at).is_some_and(|motion| motion.is_rest()) {
                    // The motion is in a dwell.
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

    /// Whether the current profile stays to its end, as the answer to a question assumes.
    #[cfg(feature = "plc")]
    const fn is_settled(&self) -> bool {
        self.orders.settled
    }

    /// Whether the current profile stays to its end.
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

    /// The instant of a change that is decided now, and the first span that begins after this instant. Only
    /// one change exists at a time, and each tick has at most one attempt.
    pub(super) fn attempt(&mut self) -> Option<(u32, usize)> {
        if let Some(paused) = self.paused() {
            self.orders.trying = true;
            return Some(paused);
        }
        let now = self.trim();
        let waits = self.reserve.waits && self.task.stage == RingStage::Passing;
        // There is no room for a change, so no search begins.
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

    /// Whether the instant is too far ahead for a change.
    pub(super) fn is_far(&self, instant: u32) -> bool {
        clock::is_before(self.queue.clock.now().wrapping_add(clock::TICK * NEAR), instant)
    }

    /// The span `k`, or the next span that has a tick.
    pub(super) fn with_tick(&self, mut k: usize) -> usize {
        while k + 1 < self.frontier.planned
            && self.committed.get(k).map(|f| f.first) == self.committed.get(k + 1).map(|f| f.first)
        {
            k += 1;
        }
        k
    }

    /// The motion at an instant that the queue covers.
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

    /// Ends a profile that stops inside a span and is in the queue. A tick shows the stop.
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

    /// Does the work after the end of a profile, before new spans.
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
            // Many profiles may be needed, and until then the queue ends early.
            if self.secure(self.reserve.near) {
                return Ok(Some(Work::Working));
            }
            let is_made = self.lay().map_err(|error| self.fail_to_plan(error))?;
            let is_told = is_made && core::mem::take(&mut self.report.is_due);
            return Ok(Some(if is_told { Work::Planned } else { Work::Working }));
        }
        Ok(None)
    }

    /// Shows the end of a profile that lies between two ticks, by a tick of standstill, if no other profile
    /// follows. The queue must have room.
    fn show_end(&mut self) {
        let last = self.frontier.end.wrapping_sub(clock::TICK);
        let moves = self.motion_at(last).is_some_and(|motion| !motion.is_rest());
        let ended =
            self.frontier.planned.checked_sub(1).and_then(|k| self.committed.get(k)).map(CommittedSpan::end);
        if let (true, Some(end)) = (moves, ended) {
            self.put_rest(Distance::from_bits(end), 1);
        }
    }

    /// Handles a next span without a possible profile. The motion stops as with an abort: the stop is another
    /// profile. If this stop fails too, the motion ends at the end of the queue.
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

    /// Drops all motion after the stop. Call this function only while the interrupt has no motion.
    pub(super) fn forget(&mut self) {
        let number = self.queue.segments.taken();
        let stands =
            self.motion_at(self.frontier.end).map_or(self.handed.to_bits(), |motion| motion.distance);
        if let Some(track) = self.queue.segments.recent(number) {
            let along = stands.wrapping_sub(self.queue.segments.start(number));
            self.intake.entered = track.point(along);
            // At the end of the released path, no block of the look-ahead has begun.
            if along > 0 || number != self.queue.segments.curve_of(self.queue.segments.handed()) {
                self.report.begun = self.queue.segments.block_of(track.segment).wrapping_add(1);
            }
        }
        // The interrupt keeps its current curve up to the stop inside it. The stop becomes the next curve.
        self.queue.segments.end_at(stands);
        self.handed = self.queue.segments.end();
        self.stay_here(self.report.begun.saturating_sub(1));
        let is_due = |point: Distance| stands.wrapping_sub(point.to_bits()) >= 0;
        let mut action = self.queue.actions.first_open();
        while self.queue.actions.open(action).is_some_and(is_due) {
            action = action.wrapping_add(1);
        }
        self.queue.actions.withdraw(action);
        // A tick in progress may still read those curves.
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

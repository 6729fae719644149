//! Replaces the profile of spans whose pieces are already in the queue, or starts the motion after a
//! standstill.
//!
//! A change is safe at every tick, even if the planner is interrupted in the middle:
//!
//! 1. The planner writes the new pieces behind an end marker (barrier), which the interrupt does not pass.
//! 2. The planner writes the stop after the new pieces into the reserve, next to the stop in force. This may
//!    take several calls.
//! 3. The planner publishes the cut: the tick at which the interrupt goes to the new pieces. In the same
//!    tick, the new stop replaces the old one.
//!
//! If the interrupt has already passed that tick, the planner withdraws the new pieces. The next try is for a
//! tick that is twice as many ticks ahead, at most [`FURTHEST`].
//!
//! At a start after a standstill, the last tick of the stop may be in the reserve instead of the queue. That
//! tick then serves as the barrier. If the planner gets no time, the axes stand still after that tick.
use super::committed::CommittedSpan;
use super::descent::Descent;
use super::hold::{Mode, REACTION};
use super::reserve::Way;
use super::{Distance, Frontier, Instant, KEPT_FREE, Planning, Speed, Work};
use crate::queue::{Change, NotNow, renew};

/// Steps per call for the stop after new pieces, if they become valid, or are withdrawn, in the same call.
const WAYS: u32 = 8;

/// Largest distance of a change from the current instant, ticks.
const FURTHEST: u32 = 128;

/// New pieces that are not valid yet, and the state before them.
pub(super) struct Pending {
    change: Change,
    at: u32,
    before: Before,
    /// Whether the look-ahead begins slower as soon as the pieces are valid.
    lowers: bool,
}

/// The state before a change.
struct Before {
    /// The span that gets another profile; `None` at a start.
    span: Option<(usize, CommittedSpan)>,
    frontier: Frontier,
    mode: Mode,
    behind: Option<i64>,
}

impl Pending {
    /// Marks the look-ahead to begin slower as soon as the pieces are valid. Returns `false` if there is no
    /// pending change of a profile.
    pub(super) const fn lower_later(&mut self) -> bool {
        self.lowers = self.before.span.is_some();
        self.lowers
    }

    /// Whether the change is a new profile of a span, and not a start from a stop.
    pub const fn is_command(&self) -> bool {
        self.before.span.is_some()
    }

    /// Whether the change also gives a new profile to the span `k`, which is after the changed span.
    pub fn renews(&self, k: usize) -> bool {
        self.before.span.as_ref().is_some_and(|(first, _)| k > *first)
    }
}

impl<const AXES: usize, const BLOCKS: usize> Planning<'_, AXES, BLOCKS> {
    /// Gives the span `k` another profile from the instant `at` on: a braking that begins there, or a new
    /// profile from the start of the span. Returns `None`, and changes nothing, if the change came too late.
    pub(super) fn change(&mut self, k: usize, at: u32, descent: Option<Descent>) -> Option<Work> {
        self.make_change(k, at, descent.as_ref())?;
        self.secure_change().then_some(Work::Working)
    }

    /// Makes the first pieces of the change. Not inlined, so that its stack frame is gone before the stop
    /// after these pieces is made.
    #[inline(never)]
    fn make_change(&mut self, k: usize, at: u32, descent: Option<&Descent>) -> Option<()> {
        let drops = at != self.frontier.end;
        self.open_change(k, at)?;
        let mut made = Ok(true);
        if let Some(descent) = descent {
            self.frontier.emitter.resume_at(0);
            self.go_down(k, descent);
            self.hand_out();
        } else {
            let committed = self.committed.get(k)?;
            self.frontier.emitter.resume_at(committed.next);
            self.frontier.speed = committed.enters;
        }
        if descent.is_none() && self.orders.mode.stopping && self.frontier.speed == Speed::ZERO {
            // The motion has not reached the span, and no profile stops it before the span.
            (self.frontier.pending_dwell, self.frontier.stops) = (0, true);
        } else if self.frontier.end == at && self.frontier.planned == k && !self.orders.mode.halting {
            if descent.is_some()
                && let Some(committed) = self.committed.get(k)
            {
                // If a braking is too short for a tick, the rest of the span brakes.
                let (distance, speed) = (committed.start.to_bits(), self.frontier.speed.to_bits());
                self.stay_within(k, &Instant { distance, speed, accel: 0 });
            }
            made = self.make_law();
            if made == Ok(true) {
                self.hand_out();
            }
        }
        if self.frontier.end == at && self.frontier.speed == Speed::ZERO {
            // The motion stops there without the change: at the end of a profile, or inside the span.
            let ended = self
                .frontier
                .planned
                .checked_sub(1)
                .filter(|last| *last >= k)
                .and_then(|last| self.committed.get(last));
            let in_span = self.committed.get(k).map_or(self.handed, |committed| committed.start);
            let in_span = ended.map_or(in_span, |ended| Distance::from_bits(ended.end()));
            let stands = self.orders.mode.passed.and_then(|passed| passed.stands).map(Distance::from_bits);
            self.put_rest(stands.unwrap_or(in_span), 1);
        }
        // There are no pieces if the profile failed or is still being searched.
        if made != Ok(true) || (drops && self.frontier.end == at) {
            self.undo();
            return None;
        }
        Some(())
    }

    /// Saves the state that the change modifies. Returns `None`, and changes nothing, if there is no room.
    #[inline(never)]
    fn open_change(&mut self, k: usize, at: u32) -> Option<()> {
        let committed = *self.committed.get(k)?;
        if self.queue.phases.room() < KEPT_FREE || self.queue.clock.has_left() {
            return None;
        }
        self.begin_change(at, Some((k, committed)));
        self.frontier.end = at;
        self.frontier.planned = k;
        self.orders.mode.uneven = true;
        Some(())
    }

    /// Begins a change: new pieces from the instant `at` on are valid only after [`Self::hand_over`]. There
    /// must be room for a barrier.
    pub(super) fn begin_change(&mut self, at: u32, span: Option<(usize, CommittedSpan)>) {
        let needs_barrier = at != self.frontier.end || !self.reserve.is_kept();
        let phases = &mut self.queue.phases;
        let change = if needs_barrier { Change::begin(phases) } else { Change::append(phases) };
        let (frontier, mode, behind) = (self.frontier, self.orders.mode, self.reserve.behind);
        let before = Before { span, frontier, mode, behind };
        self.reserve.pending = Some(Pending { change, at, before, lowers: false });
        self.reserve.undone = false;
        self.frontier.rests = false;
    }

    /// Begins the first pieces after a stop: they become valid when the motion can end. Returns `false` if it
    /// is too early.
    pub(super) fn begin_start(&mut self) -> bool {
        self.trim();
        if !self.reserve.is_kept() {
            // Only one cut exists at a time, and a command may need it before.
            if self.is_far(self.frontier.end) {
                self.keep_rest();
            } else if self.orders.mode.cut.is_some() {
                return false;
            }
        }
        self.begin_change(self.frontier.end, None);
        true
    }

    /// Ends the new pieces. If they end in a stop, they become valid; otherwise they become valid together
    /// with the stop after them. Returns `false` if nothing has changed.
    pub(super) fn secure_change(&mut self) -> bool {
        let ends = self.frontier.speed == Speed::ZERO && self.frontier.emitter.is_done();
        if ends {
            if !self.hand_over(None) {
                return false;
            }
            self.take_over();
            self.end_law();
            if self.orders.mode.halting {
                self.stand_inside();
            }
            return true;
        }
        // The next call begins to make the stop.
        true
    }

    /// Makes the new pieces, if there are any, and the stop after them valid. Returns `false`, and changes
    /// nothing, if it is too late, or if the interrupt has left the queue.
    pub(super) fn hand_over(&mut self, way: Option<Way>) -> bool {
        if self.queue.clock.has_left() {
            self.undo();
            return false;
        }
        let (keeper, clock) = (&mut self.queue.reserve, self.queue.clock);
        if let Some(Pending { change, at, before, lowers }) = self.reserve.pending.take() {
            let instant = way.map(|way| way.at);
            match change.hand_over(at, instant, &mut self.queue.phases, keeper, clock) {
                Ok(cut) => {
                    let aside = self.reserve.aside.as_mut();
                    let mode = aside.map_or(&mut self.orders.mode, |aside| &mut aside.mode);
                    mode.cut = cut.or(mode.cut);
                }
                Err(not_now) => {
                    if not_now == NotNow::TooLate {
                        self.look_further();
                    }
                    self.put_back(&before);
                    return false;
                }
            }
            self.reserve.changed = before.span.map(|(k, _)| (k, lowers));
            self.orders.lead = REACTION;
        } else {
            let is_free = match way {
                Some(way) => renew(way.at, keeper, clock),
                None => keeper.drop_kept(clock),
            };
            if !is_free {
                return false;
            }
        }
        (self.reserve.kept, self.reserve.failed) = (way, None);
        true
    }

    /// Notes that a change came too late; the next try is for a later instant.
    pub(super) fn look_further(&mut self) {
        self.orders.lead = (2 * self.orders.lead).min(FURTHEST);
    }

    /// Updates the spans after a valid change: the changed span has its new profile. Later spans begin anew,
    /// except for those that the braking passes.
    pub(super) fn take_over(&mut self) {
        if let Some((k, lowers)) = self.reserve.changed.take() {
            self.committed.restore_from(k + 1);
            self.note_passed();
            if lowers {
                self.lower();
            }
        }
    }

    /// Withdraws the pieces that are not valid, if there are any, and restores the earlier state.
    pub(super) fn undo(&mut self) {
        if let Some(pending) = self.reserve.pending.take() {
            pending.change.abandon(&mut self.queue.phases, self.queue.clock);
            self.put_back(&pending.before);
        }
    }

    fn put_back(&mut self, before: &Before) {
        self.drop_aside();
        (self.frontier, self.orders.mode, self.reserve.behind) =
            (before.frontier, before.mode, before.behind);
        if let Some((k, span)) = before.span {
            // If a stop is wanted and not in the queue yet, it is tried again.
            self.orders.mode.stopping = before.mode.is_standing();
            if let Some(committed) = self.committed.get_mut(k) {
                *committed = span;
            }
        }
        self.reserve.undone = true;
    }

    /// Carries out a change completely in this call, or not at all.
    pub(super) fn join_change(&mut self) -> bool {
        self.secure_change();
        for _ in 0..WAYS {
            if self.reserve.pending.is_some() {
                self.orders.search.begin_call();
                self.look_after();
            }
        }
        let joined = self.reserve.pending.is_none() && !self.reserve.undone;
        self.undo();
        joined
    }
}

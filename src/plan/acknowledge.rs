//! Waits for acknowledgements at synchronisation points, which the code calls gates, and continues after
//! them.
//!
//! The motion is planned to stop at a gate, and no block after the gate is released. If the last
//! acknowledgement comes before the motion begins to brake, the axes need not stop. The planner then makes
//! the last profile before the gate again, with the end speed that the path after the gate permits. The
//! interrupt changes to the new profile a few ticks ahead ([`clock`]). This is possible only if both profiles
//! give the same motion at that tick, that is, if they differ only later. Otherwise the old profile stays.
//! The motion then stops at the gate, and continues from there.
use super::hold::REACTION;
use super::{PIECES, Phase, Planning, RingStage, Slot, Speed, Work, clock};
use crate::queue::PHASES;

impl<const AXES: usize, const BLOCKS: usize> Planning<'_, AXES, BLOCKS> {
    /// Handles a gate at the first block of the look-ahead.
    pub(super) fn wait(&mut self) -> Work {
        self.stand()
    }

    /// Stops at the end of the released path: a tick shows the end point.
    pub(super) fn stand(&mut self) -> Work {
        if self.task.stood {
            return Work::Waiting;
        }
        self.task.stood = true;
        self.stay(1);
        Work::Working
    }

    /// Whether the axes stand still at a gate, because the operator has not acknowledged a function.
    pub fn is_waiting(&self) -> bool {
        let gate = self.lookahead.ring.first().is_some_and(|first| first.is_gate()) || self.functions.waits();
        gate && self.task.stood && self.queue.clock.now() == self.frontier.end
    }

    /// Reads acknowledgements, and continues the work that they started.
    #[inline(never)]
    pub(super) fn answer(&mut self) -> Option<Work> {
        if self.task.joining {
            return self.join();
        }
        // A plan in progress is completed first.
        if !self.queue.control.is_answered() || self.task.stage == RingStage::Passing {
            return None;
        }
        let answers = self.queue.control.take_answers();
        let ring = &mut self.lookahead.ring;
        let (mut first, mut any) = (false, false);
        self.functions.answer(answers, |gate| {
            let index = ring.open_gate(gate);
            first |= index == Some(0);
            any |= index > Some(0);
        });
        self.task.reopened |= any;
        if first && self.begin_join() { Some(Work::Working) } else { None }
    }

    /// The first gate is open. Plans the path after it, if the motion may still pass the gate without a stop.
    fn begin_join(&mut self) -> bool {
        let Some(last) = self.committed.len().checked_sub(1) else { return false };
        let Some(committed) = self.committed.get(last) else { return false };
        let done = !clock::is_before(self.queue.clock.now(), self.frontier.end);
        // A span that already has a new profile, of a hold for example, keeps it.
        if done || self.orders.mode.stopping || self.frontier.planned != self.committed.len() {
            return false;
        }
        let reach = committed.span.reach(self.lookahead.ring.entry());
        if committed.span.v_out != Speed::ZERO || reach == Speed::ZERO {
            return false;
        }
        self.lookahead.ring.free_start(reach);
        self.lookahead.begin_pass(self.is_open());
        self.task.joining = true;
        true
    }

    /// Continues the plan of the path after the first gate. When the plan is complete, changes the profile
    /// before the gate.
    fn join(&mut self) -> Option<Work> {
        if self.lookahead.step_pass().is_none() {
            return Some(Work::Working);
        }
        self.task.joining = false;
        // The blocks to be released belonged to another plan.
        self.task.reopened = true;
        let first = self.lookahead.ring.first_speed();
        let last = self.committed.len().wrapping_sub(1);
        let v_out = self.committed.get(last).map_or(Speed::ZERO, |committed| committed.span.reach(first));
        let joined = v_out > Speed::ZERO && self.join_at(v_out);
        let begins = if joined { v_out } else { Speed::ZERO };
        if begins != first {
            // The plan began at a higher speed.
            self.lookahead.ring.restart(begins);
        }
        if !joined {
            return Some(Work::Working);
        }
        self.task.stood = false;
        Some(Work::Replanned)
    }

    /// Sets the end speed of the last span to `v_out`, if the profile can be changed in time.
    fn join_at(&mut self, v_out: Speed) -> bool {
        self.trim();
        match self.make_join(v_out) {
            Some(true) => self.join_change(),
            Some(false) => {
                self.undo();
                false
            }
            None => false,
        }
    }

    /// Makes the first pieces of the profile, if they agree with the current motion; `None` if the motion has
    /// not begun. Not inlined, so that its stack frame is gone before the stop after these pieces is made.
    #[inline(never)]
    fn make_join(&mut self, v_out: Speed) -> Option<bool> {
        let k = self.committed.len().checked_sub(1)?;
        let committed = *self.committed.get(k)?;
        let now = self.queue.clock.now();
        let at = now.wrapping_add(clock::TICK * REACTION);
        let at = if clock::is_before(at, committed.first) { committed.first } else { at };
        let stopping = self.orders.mode.stopping || self.queue.control.commands().standstill();
        let room = self.queue.phases.room() >= PIECES + 2;
        let idle = self.frontier.planned == self.committed.len();
        if !clock::is_before(at, self.frontier.end)
            || stopping
            || self.orders.mode.cut.is_some()
            || !room
            || !idle
        {
            return None;
        }
        let motion = self.motion_at(at).filter(|_| !self.queue.clock.has_left())?;
        self.begin_change(at, Some((k, committed)));
        if let Some(committed) = self.committed.get_mut(k) {
            committed.span.v_out = v_out;
            if committed.span.blocks > 1 {
                committed.span.checked.lose();
            }
            committed.rest = 0;
        }
        self.frontier.emitter.resume_at(committed.next);
        (self.frontier.planned, self.frontier.speed, self.frontier.end) =
            (k, committed.enters, committed.first);
        if self.lay() == Ok(true)
            && self.frontier.speed > Speed::ZERO
            && let Some((_, rest)) = self.piece_at(at).filter(|(same, _)| *same == motion)
        {
            self.put(rest);
            self.hand_out();
            self.frontier.rests = false;
            return Some(true);
        }
        Some(false)
    }

    /// The motion at the instant `at` of the new profile, and the piece from this instant on.
    fn piece_at(&mut self, at: u32) -> Option<(super::Instant, Phase)> {
        let mut phase = Phase::BLANK;
        for _ in 0..PHASES {
            if !self.frontier.emitter.has_piece() {
                return None;
            }
            self.frontier.emitter.step(&mut phase);
            let end = self.frontier.end.wrapping_add(clock::TICK * u32::from(phase.ticks));
            if clock::is_before(at, end) {
                let gone = at.wrapping_sub(self.frontier.end) / clock::TICK;
                self.frontier.end = at;
                phase.advance(gone as u16);
                let motion = super::Instant {
                    distance: phase.distance.to_bits(),
                    speed: phase.speed.to_bits(),
                    accel: 2 * phase.half_accel.to_bits(),
                };
                return Some((motion, phase));
            }
            self.frontier.end = end;
        }
        None
    }
}

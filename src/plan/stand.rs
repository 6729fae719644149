//! Functions for a standstill: the position of the axes, the start of a new program, and a new coordinate for
//! the place where the axes stand.
use super::{Beyond, Commands, KEPT_FREE, PIECES, Phase, Place, Planning, Slot, Speed, clock, to_f32};
use crate::nc::SlopeType;
use crate::path::Shape;
use crate::quantity::{Feed, Position};
use crate::slope::limits::Limits;
use crate::smooth::Smoother;

impl<const AXES: usize, const BLOCKS: usize> Planning<'_, AXES, BLOCKS> {
    /// Whether the axes stand still and all commands read so far are carried out.
    pub fn is_at_rest(&self) -> bool {
        #[cfg(feature = "kinematics")]
        if self.intake.transform.is_busy() {
            return false;
        }
        let taken_in = !self.lookahead.ring.is_empty()
            || !self.intake.held.is_none()
            || !self.intake.smoothing.is_empty();
        let handed_out = self.frontier.planned == self.committed.len() && self.frontier.emitter.is_done();
        let passed = self.is_shown() || self.task.shifted == Some(self.frontier.end);
        let rests =
            self.frontier.speed == Speed::ZERO && self.task.rest == 0 && self.frontier.pending_dwell == 0;
        !taken_in && handed_out && passed && rests && !self.queue.clock.has_left() && !self.orders.failed
    }

    /// Whether a tick has output the end of all released motion.
    pub fn is_shown(&self) -> bool {
        !clock::is_before(self.queue.clock.now(), self.frontier.end)
    }

    /// Number of ticks for which the planner may do other work: half of the ticks up to the reserve, at least
    /// 1. Without a reserve, the end of the queue counts.
    pub fn ticks_of_reserve(&self) -> u32 {
        let ahead = self.reserve.kept.map_or(self.frontier.end, |way| way.at);
        let ticks = (ahead.wrapping_sub(self.queue.clock.now()) as i32).max(0).unsigned_abs() / clock::TICK;
        (ticks / 2).max(1)
    }

    /// End of the last block. At a standstill, this is exactly the set point of every axis; with a
    /// transformation, it is the tool tip instead.
    pub fn position(&self) -> &[Position; AXES] {
        &self.intake.programmed
    }

    /// Position of the axes at a standstill, exactly the set points: mm or degrees. With a transformation,
    /// [`Self::position`] returns the tool tip instead.
    pub fn stands(&self) -> &[Position; AXES] {
        #[cfg(feature = "kinematics")]
        if self.is_transformed() {
            return &self.intake.entered;
        }
        &self.intake.programmed
    }

    /// Checks whether an axis may move alone from its position to `target`.
    ///
    /// # Errors
    /// Returns the software limit that the motion would violate.
    pub fn may_go(&self, axis: usize, target: Position) -> Result<(), Beyond> {
        let mut to = *self.stands();
        if let Some(slot) = to.get_mut(axis) {
            *slot = target;
        }
        self.intake.travel.line(self.stands(), &to)
    }

    /// Limits of an axis that moves alone; parameters and result as in [`crate::dynamics::Dynamics::single`].
    pub fn single(
        &self,
        axis: usize,
        rapid: bool,
        slope: Option<SlopeType>,
        percent: u32,
    ) -> Option<(Limits, f32)> {
        self.dynamics.single(self.intake.machine, axis, rapid, slope, percent)
    }

    /// Converts a feed (mm/min) to a speed along the path, mm/tick.
    pub fn speed_of(&self, feed: Feed) -> f32 {
        self.dynamics.programmed(Some(to_f32(feed.to_bits()) * (1.0 / 4_294_967_296.0)))
    }

    /// The commands of the operator that are in force now.
    pub fn commands(&self) -> Commands {
        self.queue.control.commands()
    }

    /// The place of a curve that was refused because of a software limit, and the limit. Each refusal is
    /// returned once.
    pub fn take_refused(&mut self) -> Option<(Place, Beyond)> {
        self.intake.refused.take()
    }

    /// Drops an abort that came at a standstill, when there was no motion to end.
    pub fn forget_abort(&mut self) {
        if self.queue.control.commands().abort {
            self.queue.control.aborted();
        }
    }

    /// Begins another program text, at a standstill. A tick has already shown the end of the last motion, so
    /// no further tick is needed if the text is late.
    pub fn begin(&mut self) {
        self.task.stood |= self.committed.len() > 0;
    }

    /// Resets weights, path limits, slope and contour mode to program start. Call this function only at a
    /// standstill.
    pub fn restart(&mut self) {
        self.intake.uniform.since = self.intake.taken;
        #[cfg(feature = "kinematics")]
        self.end_transformation();
        self.dynamics.restart(self.intake.machine);
        self.intake.smoothing.restart();
        self.lookahead.ring.forget_exit();
    }

    /// Drops the blocks that have been read and not planned, after a plan that failed.
    pub fn drop_ahead(&mut self) {
        self.forget_ahead();
        (self.task.flush, self.task.rest) = (false, 0);
    }

    /// Appends a curve without length at the position of the axes; the next curve begins there. The queue
    /// must have room.
    pub(super) fn stay_here(&mut self, block: u32) {
        let _ = self.queue.segments.push(&Shape::BLANK, &self.intake.entered, 0, block);
        self.queue.segments.hand_on(1);
    }

    /// Sets the coordinate of an axis to `position`; no axis moves. A curve without length carries the new
    /// set point to the interrupt, which shows it from its next tick on. Call this function only at a
    /// standstill. Returns `false`, and changes nothing, if there is no room.
    #[must_use]
    pub fn set_position(&mut self, axis: usize, position: Position) -> bool {
        if self.queue.segments.is_full() || self.queue.phases.room() < PIECES + KEPT_FREE {
            return false;
        }
        for stands in [&mut self.intake.entered, &mut self.intake.programmed] {
            if let Some(slot) = stands.get_mut(axis) {
                *slot = position;
            }
        }
        #[cfg(feature = "examine")]
        if self.lookahead.ring.examines() {
            return true;
        }
        #[cfg(feature = "kinematics")]
        self.intake.stand();
        // The curve belongs to the last block.
        self.stay_here(self.intake.taken.saturating_sub(1));
        self.put(Phase { distance: self.handed, ticks: 1, ..Phase::BLANK });
        self.task.shifted = Some(self.frontier.end);
        true
    }
}

//! Checks a program without a plan (feature `examine`). The check takes motion blocks as [`Planning::take`]
//! does, and returns the refusals.
//!
//! Blocks go through all stages that may refuse them: path, feed, software limits, smoothing. Elements are
//! dropped before they would enter the look-ahead. The queue stays empty, and a stop or a dwell takes no
//! time.
use super::{Planning, Work};
use crate::smooth::Smoother;

impl<const AXES: usize, const BLOCKS: usize> Planning<'_, AXES, BLOCKS> {
    /// Starts a check: from now on, the planner only examines blocks. Call this function before the first
    /// block.
    pub fn begin_to_examine(&mut self) {
        self.lookahead.ring.begin_to_examine();
    }

    /// Whether the planner only examines blocks for refusals, without a plan.
    pub fn examines(&self) -> bool {
        self.lookahead.ring.examines()
    }

    /// Does one piece of work in place of a plan.
    pub(super) fn examine(&mut self) -> Work {
        self.functions.drop_passed(self.queue.control);
        if !self.intake.smoothing.is_empty() && self.round_off() {
            return if self.intake.refused.is_some() { Work::Refused } else { Work::Working };
        }
        if !self.task.flush {
            return Work::Hungry;
        }
        if self.intake.smoothing.holds() {
            self.intake.smoothing.flush(false);
            return Work::Working;
        }
        self.let_go();
        // No motion is pending here: functions are output and acknowledged at once.
        self.functions.clear(self.queue.control);
        (self.task.flush, self.task.rest) = (false, 0);
        Work::Working
    }
}

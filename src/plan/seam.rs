//! The seam between two passes of a real-time loop: how long the planner can do without knowing what follows.
//!
//! What was taken in waits in the look-ahead. Of it the planner hands on only what a longer path would not make
//! faster: behind the blocks handed on there is always enough path to stop from the highest speed. When there is
//! not enough any more, and the queue runs low, the flag decides on the next pass.
//!
//! So the decision comes [`SOON`] ticks and the path to a standstill ahead, in whole blocks.
use super::{Planning, clock};
use crate::contour_log::{Crowded, Turn};

/// Ticks of motion in the queue below which the next pass is decided on: time to take it in and to plan a full ring.
const SOON: u32 = 128;

/// What is to be done at a seam.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Seam {
    /// There is time: nothing was done.
    Wait,
    /// Something was done; there is more.
    Working,
    /// What follows has to be known now.
    Decide,
}

impl<const AXES: usize, const BLOCKS: usize> Planning<'_, AXES, BLOCKS> {
    /// What is to be done while it is not known what follows. Only after [`super::Work::Hungry`].
    pub fn seam(&mut self) -> Seam {
        let now = self.queue.clock.now();
        // The queue is low on purpose.
        (self.supply.seen, self.supply.low) = (now, 0);
        if self.frontier.end.wrapping_sub(now) > clock::TICK * SOON {
            return match self.wait_a_while() {
                super::Work::Waiting => Seam::Wait,
                _ => Seam::Working,
            };
        }
        if !self.lookahead.ring.is_long_enough() {
            return Seam::Decide;
        }
        self.begin_pass();
        Seam::Working
    }

    /// A pass of a real-time loop begins behind the last motion block taken in, or the last one ends there.
    ///
    /// # Errors
    /// Too many commands of the log wait for one motion block.
    pub fn turn(&mut self, turn: Turn, modulo: bool) -> Result<(), Crowded> {
        // A line that goes on in the next pass is not one element with it.
        self.let_go();
        let taken = self.intake.taken;
        self.intake.recorder.as_mut().map_or(Ok(()), |recorder| recorder.turn(taken, turn, modulo))?;
        self.settle_log();
        Ok(())
    }

    /// Whether a spline is on.
    pub fn has_spline(&self) -> bool {
        self.intake.smoothing.has_spline()
    }
}

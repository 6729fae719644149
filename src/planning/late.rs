//! Program text that comes late.
//!
//! What has been taken in waits in the look-ahead for what follows. When the queue runs low, it is handed on as it is, a
//! quarter at a time, planned down to a standstill at its end like every plan. So the motion slows down on its slope as the way
//! known ahead of it gets shorter, gains speed when blocks come, and stands at the end of the last one if none does.
//!
//! A corner that contour mode holds back waits for its second block: the path does not depend on when the text comes.
use super::{Planning, Work, clock};

/// Ticks of motion in the queue below which nothing is waited for: time for the plan of a full ring.
const LOW: u32 = 64;

impl<const AXES: usize, const BLOCKS: usize> Planning<'_, AXES, BLOCKS> {
    /// Goes on without a next block. Only after [`Work::Hungry`]. [`Work::Starved`] once for each standstill.
    pub fn go_without(&mut self) -> Work {
        let left = self.end.wrapping_sub(self.queue.clock.now());
        if left > clock::TICK * LOW {
            return Work::Waiting;
        }
        self.let_go();
        if !self.lookahead.is_empty() {
            return self.begin_pass();
        }
        if !self.contouring.holds() {
            self.functions.at_end(self.taken, self.distance, &mut self.queue.events);
        }
        if self.stood || self.flights.len() == 0 {
            return Work::Waiting;
        }
        self.stand();
        Work::Starved
    }
}

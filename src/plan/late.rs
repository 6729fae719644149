//! Handles three cases in which the next block does not enter the look-ahead in time. In each case, the
//! planner releases the blocks that wait in the look-ahead, a quarter of the ring at a time. The plan of
//! these blocks ends in a stop, like every plan. So the motion slows down as the known path gets shorter, and
//! speeds up again when blocks come. If no block comes, the motion stops at the end of the known path.
//!
//! | case | the planner releases blocks when |
//! |---|---|
//! | the program text is late | the queue holds at most [`LOW`] ticks of motion |
//! | the next function (M, H, S, T) has no room | the same; the interrupt then reaches earlier functions, and their places become free |
//! | the planner gets too little processor time | a block is being taken, and in two ticks the queue was low: it ends at speed, with at most [`FEW`] pieces and [`FEW`] curves |
//!
//! A planner that keeps up fills the queue again before each tick, so the third case does not occur. If the
//! planner is not called at all, the interrupt uses the reserve (`reserve`).
//!
//! At the end of the known path, contour mode may still keep a block, whose corner needs the next block. The
//! motion then stops before this corner, because the path must not depend on the time at which text arrives.
//! A run of short blocks (HSC) ends at the end of its last known block ([`Smoother::gives_way`]).
use super::{KEPT_FREE, Planning, Speed, Work, clock};
use crate::queue::{MAX_CURVES_PER_TICK, PHASES, SEGMENTS};
use crate::smooth::Smoother;

/// Ticks of motion in the queue below which the planner does not wait for text: the time for a plan of the
/// full ring.
const LOW: u32 = 64;

/// As [`LOW`], for a planner that is slower than the motion: its plan takes longer.
const DRY: u32 = 256;

/// Released curves and pieces: fewer than this number count as few. With a full ring, more of them are left
/// after a tick.
const FEW: u32 = 10;
const _: () = assert!(FEW < SEGMENTS as u32 - MAX_CURVES_PER_TICK && FEW < PHASES as u32 - 2 * KEPT_FREE);

/// A planner that keeps up has filled the queue again within this number of ticks, if it is called in each
/// tick.
const SOON: u32 = 2;

impl<const AXES: usize, const BLOCKS: usize> Planning<'_, AXES, BLOCKS> {
    /// Whether the queue ends at speed and will soon be empty, while the next block is still being taken.
    pub(super) fn runs_dry(&mut self) -> bool {
        if self.frontier.speed == Speed::ZERO || self.lookahead.ring.is_empty() {
            return false;
        }
        let now = self.queue.clock.now();
        let low = self.frontier.end.wrapping_sub(now) <= clock::TICK * DRY
            && self.queue.phases.len() <= FEW
            && self.queue.segments.len() <= FEW;
        // Ticks without a call of the planner do not count.
        if low && now != self.supply.seen {
            (self.supply.seen, self.supply.low) = (now, self.supply.low + 1);
        }
        low && self.supply.low >= SOON
    }

    /// Continues if no next block is there yet: waits while the queue holds enough motion, and then releases
    /// the blocks of the look-ahead. Call this function only after [`Work::Hungry`]. Returns
    /// [`Work::Starved`] once for each stop.
    pub fn go_without(&mut self) -> Work {
        let left = self.frontier.end.wrapping_sub(self.queue.clock.now());
        if left > clock::TICK * LOW {
            return self.wait_a_while();
        }
        self.let_go();
        if !self.lookahead.ring.is_empty() {
            return self.begin_pass();
        }
        if self.intake.smoothing.gives_way() {
            return Work::Working;
        }
        if !self.intake.smoothing.holds() {
            self.functions.at_end(self.intake.taken, self.handed, &mut self.queue.actions);
        }
        if self.task.stood || self.committed.len() == 0 {
            return self.wait_a_while();
        }
        self.stand();
        Work::Starved
    }

    /// Makes room in the queue for the next function: releases blocks, so that the interrupt reaches the
    /// functions before. Call this function only after [`Work::Hungry`].
    pub fn make_room(&mut self) -> Work {
        let left = self.frontier.end.wrapping_sub(self.queue.clock.now());
        if left > clock::TICK * LOW {
            return self.wait_a_while();
        }
        if self.lookahead.ring.is_empty() {
            self.rest(0);
            return Work::Waiting;
        }
        self.begin_pass()
    }
}

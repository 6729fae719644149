//! Program text that comes late, and functions without room.
//!
//! Blocks wait in the look-ahead for the blocks that follow. When the queue runs low, the planner releases
//! the waiting blocks, a quarter of the ring at a time. Like every plan, theirs ends in a stop. So the motion
//! slows down as the known path gets shorter, speeds up when blocks come, and stops at the end of the last
//! block if none comes.
//!
//! If the next function has no room, the planner releases the waiting blocks in the same way, because the interrupt
//! has to reach the functions before. The planner stops the motion only if no block is left to be released.
//!
//! A planner that does not keep up releases blocks in the same way, before it has finished the next block.
//! The condition is a low queue that ends at speed, while blocks are being taken. A planner that keeps up
//! never meets this condition, because it has filled the queue before each tick. If the planner is not called
//! at all, the interrupt uses the reserve (`reserve.rs`).
//!
//! A corner that contour mode holds back waits for its second block, because the path must not depend on the
//! arrival time of text. A run of blocks that HSC holds back ends at the end of its last block
//! ([`Smoother::gives_way`]).
use super::{KEPT_FREE, Planning, Speed, Work, clock};
use crate::queue::{MAX_CURVES_PER_TICK, PHASES, SEGMENTS};
use crate::smooth::Smoother;

/// Ticks of motion in the queue below which the planner does not wait for text: the time for a plan of the
/// full ring.
const LOW: u32 = 64;

/// Ticks of motion in the queue that are few for a planner that does not keep up, whose plan takes longer.
const DRY: u32 = 256;

/// Numbers of released curves and of pieces that are few: of a full ring, more are left after a tick.
const FEW: u32 = 10;
const _: () = assert!(FEW < SEGMENTS as u32 - MAX_CURVES_PER_TICK && FEW < PHASES as u32 - 2 * KEPT_FREE);

/// Number of ticks within which a planner that keeps up, called in each tick, has filled the queue again.
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
        // Ticks without a call of the planner say nothing about later ticks.
        if low && now != self.supply.seen {
            (self.supply.seen, self.supply.low) = (now, self.supply.low + 1);
        }
        low && self.supply.low >= SOON
    }

    /// Continues without a next block. Call it only after [`Work::Hungry`]. Returns [`Work::Starved`] once for each
    /// stop.
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

    /// Makes room for a function. Call it only after [`Work::Hungry`].
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

//! Program text that comes late, and functions that have no room.
//!
//! What has been taken in waits in the look-ahead for what follows. When the queue runs low, it is handed on
//! as it is, a quarter at a time, planned down to a standstill at its end like every plan. So the motion
//! slows down on its slope as the way known ahead of it gets shorter, gains speed when blocks come, and
//! stands at the end of the last one if none does.
//!
//! Where the next function has no room, what has been taken in is handed on in the same way: the interrupt comes to
//! the functions before it. A standstill makes room only where nothing is left to be handed on.
//!
//! A planner that does not keep up hands on in the same way, before it is done with the next block: when the
//! queue has run low while blocks are being taken in, and what is in it ends at speed. A planner that keeps
//! up never comes to that, since it has filled the queue before each tick. If it is not called at all, the
//! interrupt takes the way in reserve (`reserve.rs`).
//!
//! A corner that contour mode holds back waits for its second block: the path does not depend on when the
//! text comes. The row of blocks that HSC holds back ends where its last block ends ([`Smoother::gives_way`]).
use super::{KEPT_FREE, Planning, Speed, Work, clock};
use crate::queue::{MAX_CURVES_PER_TICK, PHASES, SEGMENTS};
use crate::smooth::Smoother;

/// Ticks of motion in the queue below which nothing is waited for: time for the plan of a full ring.
const LOW: u32 = 64;

/// Ticks of motion in the queue that are few for a planner that does not keep up: its plan takes longer.
const DRY: u32 = 256;

/// Curves handed on, and pieces of time, that are few: of a full ring a tick leaves more.
const FEW: u32 = 10;
const _: () = assert!(FEW < SEGMENTS as u32 - MAX_CURVES_PER_TICK && FEW < PHASES as u32 - 2 * KEPT_FREE);

/// Ticks within which a planner that is called in each of them, and keeps up, has filled the queue again.
const SOON: u32 = 2;

impl<const AXES: usize, const BLOCKS: usize> Planning<'_, AXES, BLOCKS> {
    /// Whether what is in the queue ends at speed and will soon have passed, though the next block is being
    /// taken in.
    pub(super) fn runs_dry(&mut self) -> bool {
        if self.frontier.speed == Speed::ZERO || self.lookahead.ring.is_empty() {
            return false;
        }
        let now = self.queue.clock.now();
        let low = self.frontier.end.wrapping_sub(now) <= clock::TICK * DRY
            && self.queue.phases.len() <= FEW
            && self.queue.segments.len() <= FEW;
        // Ticks in which it was not called say nothing about those to come.
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

    /// Makes room for a function. Only after [`Work::Hungry`].
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

//! The look-ahead: a ring of blocks, and the speed at each transition between two blocks.
//!
//! Two rules give the speeds. Both rules use profiles with zero acceleration at the ends of a block:
//!
//! - Backward, from a stop at the end of the ring: from its start speed, a block can brake to its end speed
//!   within its length. So the plan always stops inside the ring.
//! - Forward, when the ring releases a block: from its start speed, the block can reach its end speed within
//!   its length.
//!
//! A higher end speed may lower the start speed that the first rule permits. The earlier planned start speed then
//! stays, and the end speed is lowered when the ring releases the block.
//!
//! With HSC, acceleration may pass a transition between two blocks, and need not be zero there. With TRAPEZ
//! and SIN2, acceleration may pass in two cases. In the first case, the transition is tangential and both
//! blocks have the same limits, as in a circle of several arcs. In the second case, both blocks are elements
//! of one curve. The blocks on both sides then belong to one *span*: one speed profile covers them.
//! Transitions between spans are *anchors*: acceleration is zero there. `span` decides which transitions are
//! anchors, and `ease` removes some of them.
//!
//! The backward pass runs when the ring is full, a few blocks per call. The pass ends early at the first
//! transition whose speed stays that of the plan before. Then the ring releases a quarter of its blocks.
//!
//! | file | what it decides |
//! |---|---|
//! | `append` | the limits of a new block and of the transition before it |
//! | `knees`, `brief`, `worth` | speeds where several knees, or whole blocks, fall into one tick; whether the motion stops at a corner |
//! | `plan` | which pass runs, and how much of it in a call |
//! | `span`, `ease`, `valley` | which transitions are anchors; which anchors are removed; which anchors move into a slow block |
//! | `run_out` | the end of an arc while it is unknown whether the circle continues |
//! | `law` | the speed profile of a span |
//! | `pace` | the speed of a block under override and reduced speed |
//! | `release` | which blocks the ring releases |
//! | `enough` | how much the ring may release while the following blocks are unknown |
//! | `ring`, `blocks`, `block`, `planned` | the ring, its places, a block, a planned speed |
mod append;
mod block;
mod blocks;
mod brief;
mod ease;
#[cfg(feature = "plc")]
mod enough;
mod knees;
mod law;
mod pace;
mod plan;
mod planned;
mod release;
mod ring;
mod run_out;
mod span;
mod valley;
mod worth;

pub use block::Block;
use blocks::Blocks;
#[cfg(feature = "plc")]
pub(crate) use enough::WAYS;
pub use pace::Pace;
pub(crate) use pace::SLOWEST;
pub use release::{Gain, GoingOn, ReleasedSpan};
pub use ring::Ring;

use crate::quantity::Speed;
use core::mem::MaybeUninit;
use plan::Plan;

/// Memory of a [`Lookahead`]. All bits are zero when new, so the memory takes no flash.
pub struct LookaheadMemory<const BLOCKS: usize> {
    blocks: Blocks<BLOCKS>,
    plan: MaybeUninit<Plan>,
}

impl<const BLOCKS: usize> LookaheadMemory<BLOCKS> {
    /// Memory without blocks.
    pub const fn new() -> Self {
        Self { blocks: Blocks::new(), plan: MaybeUninit::uninit() }
    }
}

impl<const BLOCKS: usize> Default for LookaheadMemory<BLOCKS> {
    fn default() -> Self {
        Self::new()
    }
}

/// The blocks whose speeds may still change, and the plan of their speeds.
pub struct Lookahead<'a, const AXES: usize, const BLOCKS: usize> {
    /// The ring of blocks.
    pub ring: Ring<'a, AXES, BLOCKS>,
    plan: &'a mut Plan,
}

impl<'a, const AXES: usize, const BLOCKS: usize> Lookahead<'a, AXES, BLOCKS> {
    /// An empty look-ahead in `memory`. `depth`: number of blocks that it may hold, at most `BLOCKS`.
    pub fn new(memory: &'a mut LookaheadMemory<BLOCKS>, depth: usize) -> Self {
        Self { ring: Ring::new(&mut memory.blocks, depth), plan: memory.plan.write(Plan::NONE) }
    }

    /// Drops all blocks and the plan.
    pub fn clear(&mut self) {
        self.ring.clear();
        *self.plan = Plan::NONE;
    }

    /// Plans the speeds for another override; `level` 1 is 100 %. Call this function only before a pass
    /// begins.
    ///
    /// The first block starts at `v_in`. Its start is planned for a speed up to `most`, so that the speed can
    /// rise again after a low override. If the override is lower than before and `v_in` is too fast for it,
    /// the function returns `false` and changes nothing. The motion can still follow the old plan.
    /// [`Self::complete_level`] completes a change to a lower override.
    pub fn set_level(&mut self, level: f32, [v_in, most]: [Speed; 2]) -> bool {
        if level >= self.ring.level() {
            self.ring.raise(level);
            return true;
        }
        let part = self.ring.lowers(level);
        let entry = self.ring.entry_at(part);
        if v_in > entry {
            return false;
        }
        self.ring.lower((level, part), most.min(entry));
        true
    }

    /// Lowers the planned speeds to the new override, after [`Self::set_level`]. Call this function before
    /// any other function of the ring.
    pub fn complete_level(&mut self) {
        self.ring.lower_planned();
    }

    /// Whether [`Self::complete_level`] still has to be called.
    pub fn is_lowering(&self) -> bool {
        self.ring.lowering.is_some()
    }

    /// Begins a plan of the whole ring. `open`: more blocks may follow. The transition after the last block
    /// may then reserve a part of that block's limits, and the plan leaves this part free.
    pub fn begin_pass(&mut self, open: bool) {
        self.ring.begin_pass(open);
        self.plan.begin(&mut self.ring);
    }

    /// Does the next step of the plan. When the plan is complete, returns how many blocks may be released.
    pub fn step_pass(&mut self) -> Option<usize> {
        self.plan.step(&mut self.ring).then(|| self.ring.ready())
    }

    /// Sets the start speed of the first block to `v_in`, or to the planned speed if that is lower.
    pub fn start_at(&mut self, v_in: Speed) {
        self.ring.start_at(v_in, !self.plan.is_done());
    }
}

//! The look-ahead: a ring of blocks, and the planned speed at each transition between two blocks. The plan
//! always ends in a stop at the end of the ring.
//!
//! A planned speed fulfils two rules:
//!
//! - Backward rule: the motion can brake from the start speed of a block to its end speed, within the length
//!   of the block. The backward pass computes these speeds from the end of the ring to its front.
//! - Forward rule: the motion can speed up from the start speed of a block to its end speed, within the
//!   length of the block. This rule may lower the end speed.
//!
//! In both rules, acceleration is zero at both ends of the block. With limited jerk, a higher end speed may
//! therefore need more length, and permit only a lower start speed. The planner then keeps the start speed of
//! the earlier plan, and the forward rule lowers the end speed.
//!
//! A *span* is a run of blocks with one speed profile. Within a span, acceleration need not be zero at the
//! transitions, and both rules apply to the span instead of the block. A transition between two spans is an
//! *anchor*: acceleration is zero there (with STEP, it may step there). Which blocks a span may contain
//! depends on the slope:
//!
//! | slope | blocks of a span |
//! |---|---|
//! | HSC | blocks with any limits; `span` finds the transitions that must be anchors, `ease` removes some of them |
//! | TRAPEZ, SIN2 | blocks with equal limits and tangential transitions, as in a circle of several arcs; elements of one curve |
//! | STEP | one block, because a longer span saves no time without ramps of acceleration |
//!
//! The backward pass usually begins when the ring is full, and covers a few blocks per call. Earlier
//! transitions keep their speeds if the pass reaches a transition with the same speed as in the plan before.
//! The pass ends there. For spans of several blocks, a forward pass follows, and every block is compared with
//! the profile. When the plan is complete, the ring releases the spans that begin in its first quarter.
//!
//! | file | what it decides |
//! |---|---|
//! | `append` | the limits of a new block and of the transition before it |
//! | `knees` | speeds where an axis has several corners without a curve within one tick |
//! | `brief` | speeds of very short blocks, of which the motion passes many per tick |
//! | `worth` | whether the motion passes a corner without a curve or stops there |
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

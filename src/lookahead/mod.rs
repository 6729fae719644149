//! Limits over distance: a ring of blocks and, for each transition, the speed at which it may be taken.
//!
//! Two rules fix the speeds. Backward, from a standstill at the end of the ring: a block may be entered at
//! the speed from which its end speed can be reached within its length. Forward, when a block is handed on:
//! its end speed is at most what its start speed can grow to. Both use the slope with zero acceleration at
//! the ends of the block. The plan therefore always stops inside the ring. A higher end speed may lower what
//! the first rule allows at the start; then the speed planned before stays, and the end speed gives way when
//! the block is handed on.
//!
//! Where acceleration may pass a transition (with HSC; with TRAPEZ and SIN2 if it is tangential and both
//! sides have the same limits, as it is in a circle of several arcs), the blocks on both sides belong to one
//! *span*: one change of speed after the other runs across them. Transitions between spans are *anchors*:
//! acceleration is zero there. `span` decides which transitions are anchors, `ease` does without some of
//! them.
//!
//! The backward pass runs when the ring is full, a few blocks per call; then a quarter of the ring is handed
//! on. It ends early at the first transition whose speed did not change.
//!
//! | file | what it decides |
//! |---|---|
//! | `append` | what the next block of the ring permits, and the transition before it |
//! | `knees`, `brief`, `worth` | knees within one tick; blocks within one tick; whether a corner is a standstill |
//! | `plan` | which pass runs, and how much of it in a call |
//! | `span`, `ease`, `valley` | which transitions are anchors; which of them go; which move into a slow block |
//! | `run_out` | the end of an arc, as long as nobody knows whether the circle goes on |
//! | `law` | the law of a span |
//! | `pace` | what override and reduced speed make of the speed of a block |
//! | `release` | what leaves the ring |
//! | `ring`, `blocks`, `block`, `planned` | the ring, its places, a block, a planned speed |
mod append;
mod block;
mod blocks;
mod brief;
mod ease;
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
pub use pace::Pace;
pub(crate) use pace::SLOWEST;
pub use release::{Gain, GoingOn, ReleasedSpan};
pub use ring::Ring;

use crate::quantity::Speed;
use core::mem::MaybeUninit;
use plan::Plan;

/// Memory of a [`Lookahead`]. All bits zero when new, so that it takes no room in flash.
pub struct LookaheadMemory<const BLOCKS: usize> {
    blocks: Blocks<BLOCKS>,
    plan: MaybeUninit<Plan>,
}

impl<const BLOCKS: usize> LookaheadMemory<BLOCKS> {
    /// Nothing is in it.
    pub const fn new() -> Self {
        Self { blocks: Blocks::new(), plan: MaybeUninit::uninit() }
    }
}

impl<const BLOCKS: usize> Default for LookaheadMemory<BLOCKS> {
    fn default() -> Self {
        Self::new()
    }
}

/// The ring and its plan.
pub struct Lookahead<'a, const AXES: usize, const BLOCKS: usize> {
    /// The blocks.
    pub ring: Ring<'a, AXES, BLOCKS>,
    plan: &'a mut Plan,
}

impl<'a, const AXES: usize, const BLOCKS: usize> Lookahead<'a, AXES, BLOCKS> {
    /// An empty ring in `memory` that uses `depth` of its blocks.
    pub fn new(memory: &'a mut LookaheadMemory<BLOCKS>, depth: usize) -> Self {
        Self { ring: Ring::new(&mut memory.blocks, depth), plan: memory.plan.write(Plan::NONE) }
    }

    /// Throws away what it holds.
    pub fn clear(&mut self) {
        self.ring.clear();
        *self.plan = Plan::NONE;
    }

    /// Speeds are planned for another level; only before a plan begins. The first block is entered at the
    /// speed `v_in`, and is planned to be entered at up to `most`, at least that: what an override takes may come back.
    /// `false`, and nothing has changed, if `v_in` is too fast for a lower level. What was planned stays possible.
    /// A lower level is complete with [`Self::complete_level`].
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

    /// Planned speeds follow a lower level: before anything else is done with the ring.
    pub fn complete_level(&mut self) {
        self.ring.lower_planned();
    }

    /// Whether [`Self::complete_level`] is to come.
    pub fn is_lowering(&self) -> bool {
        self.ring.lowering.is_some()
    }

    /// Begins to plan the whole ring. `open`: blocks may follow the last one, and their transition may need
    /// its part of the limits, which must not lower what is planned now.
    pub fn begin_pass(&mut self, open: bool) {
        self.ring.begin_pass(open);
        self.plan.begin(&mut self.ring);
    }

    /// Goes on with the plan; when it is complete, how many blocks may leave now.
    pub fn step_pass(&mut self) -> Option<usize> {
        self.plan.step(&mut self.ring).then(|| self.ring.ready())
    }

    /// The first block begins at the speed `v_in`, lower than planned or as planned.
    pub fn start_at(&mut self, v_in: Speed) {
        self.ring.start_at(v_in, !self.plan.is_done());
    }
}

//! The plan of the look-ahead in progress: which pass over the blocks runs, its data, and how much of it one
//! call does. Only one pass runs at a time.
use super::block::{Block, Marks};
use super::ease::{Step, Trial};
use super::law::{faster, length_mm};
use super::planned::{Planned, settled};
use super::ring::Ring;
use super::span::{Backward, Forward, Inside};
use super::valley::Valley;
use crate::dynamics::Share;
use crate::machine::functions;
use crate::math::float::min;
use crate::quantity::Speed;
use crate::slope::limits::Limits;

/// The current pass.
#[derive(Clone, Copy, Debug)]
pub(super) enum Pass {
    /// The plan is complete.
    Done,
    /// Every transition is an anchor: a pass over single blocks from the end to the front. Fields: number of
    /// remaining blocks, and speed at the end of the last of them.
    Blocks(usize, Speed),
    /// A pass over spans from the end to the front: speeds from which the motion can stop.
    Backward,
    /// A pass from the front to the end: speeds that the motion can reach.
    Forward,
    /// Compares the blocks of one span with its profile.
    Inside,
    /// Tries one profile for two spans.
    Trial,
}

/// The data of the passes. One pass is in progress.
pub(super) struct Plan {
    pub pass: Pass,
    pub backward: Backward,
    pub forward: Forward,
    pub inside: Inside,
    /// Data of the trials with two spans of HSC; empty in a build without HSC.
    pub tries: [Tries; functions::HSC.room(1)],
}

/// Data of trials with two spans.
pub(super) struct Tries {
    pub trial: Trial,
    /// The cuts of the valley that is being tried.
    pub valley: Valley,
}

/// Blocks per call. A block takes about 500 instructions; with fewer blocks the call itself would cost as
/// much.
const STEPS: usize = 16;
/// Work of one call with spans, in units of about 32 instructions. The call itself costs 1,000 instructions.
const WORK: usize = 520;

/// Subtracts work from the budget of the call.
pub(super) fn spend(work: &mut usize, part: usize) {
    *work = work.saturating_sub(part);
}

impl Plan {
    /// No plan in progress.
    pub const NONE: Self = Self {
        pass: Pass::Done,
        backward: Backward::NONE,
        forward: Forward::NONE,
        inside: Inside::NONE,
        tries: [const { Tries { trial: Trial::NONE, valley: Valley::NONE } }; functions::HSC.room(1)],
    };

    /// Whether no plan is in progress: the last one is complete.
    pub fn is_done(&self) -> bool {
        matches!(self.pass, Pass::Done)
    }

    /// Begins a plan of the whole ring.
    pub fn begin<const AXES: usize, const BLOCKS: usize>(&mut self, ring: &mut Ring<'_, AXES, BLOCKS>) {
        let left = ring.blocks.len();
        if ring.counts.through == 0 && ring.counts.untried == 0 {
            ring.scope.blockwise = true;
            self.pass = Pass::Blocks(left, Speed::ZERO);
            return;
        }
        if ring.scope.blockwise {
            ring.scope.blockwise = false;
            for block in ring.blocks.iter_mut() {
                block.v_old = block.v_in;
                block.marks.set(Marks::CHECKED, false);
            }
        }
        let until = left.min(core::mem::replace(&mut ring.scope.until, usize::MAX));
        self.backward = Backward::new(left, until, Speed::ZERO);
        self.pass = Pass::Backward;
    }

    /// Does the work of one call on the plan. Returns `true` when the plan is complete.
    pub fn step<const AXES: usize, const BLOCKS: usize>(
        &mut self,
        ring: &mut Ring<'_, AXES, BLOCKS>,
    ) -> bool {
        match self.pass {
            Pass::Blocks(left, v_out) => self.blocks(ring, left, v_out),
            Pass::Done => true,
            _ => self.spans(ring),
        }
    }

    /// Continues a plan of spans with several blocks, within the budget of one call. Returns `true` when the
    /// plan is complete.
    #[inline(never)]
    fn spans<const AXES: usize, const BLOCKS: usize>(&mut self, ring: &mut Ring<'_, AXES, BLOCKS>) -> bool {
        let mut work = WORK;
        while work > 0 {
            match self.pass {
                Pass::Backward => ring.backward(self, &mut work),
                Pass::Forward => ring.forward(self, &mut work),
                Pass::Inside => ring.inside(self, &mut work),
                Pass::Trial => {
                    let tries = self.tries.first_mut();
                    if tries.is_none_or(|tries| ring.trials(&mut tries.trial, &mut tries.valley, &mut work)) {
                        self.tried(ring);
                    }
                }
                Pass::Done | Pass::Blocks(..) => break,
            }
        }
        self.is_done()
    }

    /// The trials end: the plan is complete, or speeds behind a removed anchor rise.
    fn tried<const AXES: usize, const BLOCKS: usize>(&mut self, ring: &mut Ring<'_, AXES, BLOCKS>) {
        if self.tries.first().is_some_and(|tries| matches!(tries.trial.step, Step::Faster)) {
            ring.forward_again(self);
        } else {
            self.complete(ring);
        }
    }

    /// Ends the plan with the speeds that the motion can reach, even if a pass is not complete.
    pub fn complete<const AXES: usize, const BLOCKS: usize>(&mut self, ring: &mut Ring<'_, AXES, BLOCKS>) {
        ring.scope.end = ring.blocks.len();
        ring.scope.free = None;
        for block in ring.blocks.iter_mut().filter(|block| block.is(Marks::ANCHOR)) {
            block.marks.set(Marks::FRESH, false);
            block.v_old = block.v_reached;
        }
        self.pass = Pass::Done;
    }

    fn blocks<const AXES: usize, const BLOCKS: usize>(
        &mut self,
        ring: &mut Ring<'_, AXES, BLOCKS>,
        mut left: usize,
        mut v_out: Speed,
    ) -> bool {
        for _ in 0..STEPS {
            // The start speed of the first block is already decided.
            if left <= 1 {
                ring.raise_first(v_out);
                return self.blocks_done(ring);
            }
            left -= 1;
            let last = left + 1 == ring.blocks.len();
            let Some(block) = ring.blocks.get_mut(left) else { continue };
            let share = ring.tail.share(last && ring.scope.open);
            let v = enters(block, share, v_out);
            let (v, settled) = (Planned::below(v), settled(v));
            // With zero acceleration at both ends, a smaller loss of speed may need more length. Below the
            // largest acceleration, the distance from v to w is proportional to (v + w)·√(v − w). This
            // distance grows with w up to about v/2. A speed that was planned with a lower end speed stays
            // possible, and is kept.
            block.marks.set(Marks::KEPT, v < block.v_in);
            if v <= block.v_in {
                if left <= ring.scope.until {
                    return self.blocks_done(ring);
                }
                v_out = block.v_in.speed();
                continue;
            }
            (block.v_in, v_out) = (v, settled);
        }
        self.pass = Pass::Blocks(left, v_out);
        false
    }

    fn blocks_done<const AXES: usize, const BLOCKS: usize>(
        &mut self,
        ring: &mut Ring<'_, AXES, BLOCKS>,
    ) -> bool {
        ring.scope.end = ring.blocks.len();
        ring.scope.until = usize::MAX;
        self.pass = Pass::Done;
        true
    }
}

/// Highest speed at the start of a block from which the block can brake to `v_out`.
#[cfg_attr(feature = "fast", inline(always))]
fn enters(block: &Block, share: Option<&Share>, v_out: Speed) -> Speed {
    match share {
        None => enters_with(&block.limits(), block, v_out),
        Some(share) => enters_shared(share, block, v_out),
    }
}

#[inline(never)]
fn enters_shared(share: &Share, block: &Block, v_out: Speed) -> Speed {
    enters_with(&block.limits_by_call().shared(share), block, v_out)
}

#[cfg_attr(feature = "fast", inline(always))]
fn enters_with(limits: &Limits, block: &Block, v_out: Speed) -> Speed {
    let mut room = None;
    let limits = limits.near(v_out, &mut room);
    faster(&limits.brake(), length_mm(block), v_out, min(block.cap(), limits.v))
}

impl<const AXES: usize, const BLOCKS: usize> Ring<'_, AXES, BLOCKS> {
    /// Raises the start speed of the first block, as far as the speed at its end permits.
    fn raise_first(&mut self, v_out: Speed) {
        let last = self.scope.open && self.blocks.len() == 1;
        let share = self.tail.share(last);
        let Some(block) = self.blocks.front_mut() else { return };
        // The start speed was decided with another end speed.
        block.marks.set(Marks::KEPT, true);
        let Some(reach) = self.scope.free.take() else { return };
        self.start = enters(block, share, v_out).min(reach).max(self.start);
    }

    /// Number of blocks that may be released: all blocks if none follows, otherwise the spans that begin in
    /// the first quarter.
    pub(super) fn ready(&self) -> usize {
        if !self.scope.open {
            return self.blocks.len();
        }
        let batch = self.batch();
        (batch..self.blocks.len())
            .find(|&k| self.blocks.get(k).is_some_and(|b| b.is(Marks::ANCHOR)))
            .unwrap_or(batch)
    }
}

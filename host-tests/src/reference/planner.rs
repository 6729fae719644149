//! The plan block by block: limits, speeds at joints, time laws. Acceleration is zero at every joint.
use super::limits::BlockLimits;
use super::profile::{Profile, reach};

/// What the planner needs of one block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Block {
    /// Length.
    pub length: f64,
    /// Limits inside.
    pub limits: BlockLimits,
    /// Highest speed at its end; zero for a stop.
    pub v_end: f64,
}

/// The time laws of all blocks from standstill to standstill. When a block is decided, only `ahead` blocks behind it are
/// known, and the motion must be able to stop at the end of the last of them.
///
/// # Panics
/// If a block cannot be travelled between speeds that the passes found: then the passes are wrong.
pub fn plan(blocks: &[Block], ahead: usize) -> Vec<Profile> {
    let mut v_in = 0.0;
    (0..blocks.len())
        .map(|i| {
            let last = blocks.len().min(i + 1 + ahead);
            let mut v_out = leave(&blocks[i..last]);
            let block = &blocks[i];
            v_out = reach(block.length, v_in, v_out, block.limits.accelerate).min(v_out);
            let l = block.limits;
            let profile = Profile::fastest(block.length, v_in, v_out, l.v, l.accelerate, l.brake)
                .unwrap_or_else(|| panic!("block {i}: {v_in} to {v_out} in {block:?}"));
            v_in = v_out;
            profile
        })
        .collect()
}

/// Highest speed at the end of the first block from which the others can still stop.
fn leave(blocks: &[Block]) -> f64 {
    let mut v = 0.0;
    for i in (1..blocks.len()).rev() {
        // Into block i from its end, with time running backward.
        v = reach(blocks[i].length, v, blocks[i - 1].v_end, blocks[i].limits.brake.reversed());
    }
    v
}

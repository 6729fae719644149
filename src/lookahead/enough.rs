//! How much of the ring may leave while it is not known what follows (feature `plc`).
use super::law::length_mm;
use super::ring::Ring;

/// Ways to a standstill that have to be known: the transition behind the last block may take a part of its limits.
pub const WAYS: f32 = 2.0;

impl<const AXES: usize, const BLOCKS: usize> Ring<'_, AXES, BLOCKS> {
    /// Whether a plan of now hands on its first blocks as fast as a longer path would let them be: behind them is [`WAYS`]
    /// times the path to a standstill from the highest speed. Looks at each block once.
    pub fn is_long_enough(&self) -> bool {
        let batch = self.batch();
        let Some(first) = self.blocks.get(batch) else { return false };
        let (mut limits, mut length) = (first.limits_by_call(), 0.0);
        for block in (batch..self.blocks.len()).filter_map(|k| self.blocks.get(k)) {
            block.join_to(&mut limits);
            length += length_mm(block);
        }
        limits.brake().reach(0.0, length / WAYS) >= limits.v
    }

    /// The last block is a part of the curve of the one before it.
    pub(crate) fn continue_last(&mut self) {
        if let Some(block) = self.blocks.back_mut() {
            block.go_on();
        }
    }
}

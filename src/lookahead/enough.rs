//! Whether the known path is long enough to release blocks while the path after it is not known yet (feature
//! `plc`). The question arises at the end of a real-time loop, before the PLC's decision whether the loop
//! repeats.
use super::block::{Block, Marks};
use super::law::length_mm;
use super::ring::Ring;
use crate::math::float::min;

/// Number of braking distances that must be known at the end of the ring. One would suffice, but the
/// transition after the last block may reserve a part of its limits.
pub const WAYS: f32 = 2.0;

/// Spans per call. A span costs about as much as a block of the plan.
const SPANS: usize = 48;

impl<const AXES: usize, const BLOCKS: usize> Ring<'_, AXES, BLOCKS> {
    /// Whether the blocks to be released are already as fast as they would be in a longer path.
    ///
    /// The function computes two speeds from the end of the ring to the front. One is for a stop at the end,
    /// the other for a path that continues. Before the place where both speeds meet, the end has no effect.
    pub fn is_long_enough(&self) -> bool {
        let (batch, mut end) = (self.batch(), self.blocks.len());
        let (mut speeds, mut part) = ([0.0, f32::MAX], 1.0 / WAYS);
        for _ in 0..SPANS {
            if end <= batch {
                return false;
            }
            let mut at = end - 1;
            let Some(mut first) = self.blocks.get(at) else { return false };
            let (mut limits, mut length) = (first.limits_by_call(), length_mm(first));
            while at > batch
                && !first.is(Marks::ANCHOR)
                && let Some(before) = self.blocks.get(at - 1)
            {
                before.join_to(&mut limits);
                length += length_mm(before);
                (first, at) = (before, at - 1);
            }
            let (brake, most) = (limits.brake(), min(Block::cap(first), limits.v));
            speeds = speeds.map(|v_out| {
                let v_out = min(v_out, limits.v);
                min(most, v_out + brake.reach(v_out, length * part))
            });
            let [stops, goes_on] = speeds;
            if stops >= goes_on {
                return true;
            }
            (end, part) = (at, 1.0);
        }
        false
    }

    /// Marks that the last block and the block before are parts of one curve.
    pub(crate) fn continue_last(&mut self) {
        if let Some(block) = self.blocks.back_mut() {
            block.go_on();
        }
    }
}

//! Limits how many blocks the motion passes per tick, because the interrupt passes at most
//! [`MAX_CURVES_PER_TICK`] curves per tick. (Between the starts of 32 curves lie 31 blocks.)
//!
//! | build | curves per tick, at most | blocks in a row that take at least a tick | brief blocks among them, at most | least time of the other blocks, if some are brief |
//! |---|---|---|---|---|
//! | usual | 32 | 31 | 11 ([`MOST_BRIEF`]) | 1/20 tick |
//! | small | 16 | 15 | 5 | 1/10 tick |
//!
//! The following numbers are those of the usual build. A simple rule would be that every block takes at least
//! 1/31 tick. But then the motion would be very slow in a single block that is far shorter than its
//! neighbours. So some blocks may be *brief*. A brief block is at least eight times shorter than the last
//! block that is not brief, and may take less than 1/31 tick. As long as there are no brief blocks, for
//! example in a row of equal blocks, the motion may pass 31 blocks per tick.
use crate::dynamics::OverrideRange;
use crate::math::float::{max, min};
use crate::queue::MAX_CURVES_PER_TICK;

/// Number of consecutive blocks that take at least a tick.
const ROW: u32 = MAX_CURVES_PER_TICK - 1;
/// Largest number of brief blocks among them: a third.
const MOST_BRIEF: u32 = ROW.div_ceil(3);
/// Blocks per tick: without brief blocks among them, with brief blocks, and for a brief block. For a brief
/// block, rounding to 2^-36 tick is 2^-18 of its time.
const ALL: f32 = ROW as f32;
const OTHERS: f32 = (ROW - MOST_BRIEF) as f32;
const BRIEF: f32 = (1 << 18) as f32;
/// A brief block is shorter than this part of a block that is not brief.
const FAR_SHORTER: f32 = 0.125;
/// Bits of the blocks before the current one.
const BEFORE: u32 = (1 << (ROW - 1)) - 1;

/// Which of the last consecutive blocks take less time than their share of a tick.
#[derive(Clone, Copy, Debug)]
pub(super) struct Row {
    /// Bit k is for the block k places back. `brief`: the block is brief. `quick`: the block takes less than
    /// a 20th of a tick, and is not brief.
    brief: u32,
    quick: u32,
    /// Length of the last block that is not brief, mm.
    length: f32,
}

impl Row {
    /// The state before the first block.
    pub const NONE: Self = Self { brief: 0, quick: 0, length: f32::MAX };

    /// Whether the last block is brief: far shorter than the blocks before, and passed in less than its share
    /// of a tick.
    pub const fn is_brief(&self) -> bool {
        self.brief & 1 != 0
    }

    /// Adds a block of this length (mm) with the speed `v`, planned for the override `level`. Lowers `v` if
    /// the motion would otherwise pass too many blocks per tick. `timed`: the speed stays, because the block
    /// is a part of a curve of several ticks.
    #[cfg_attr(feature = "fast", inline(always))]
    pub fn take(
        &mut self,
        length: f32,
        (v, override_range): (&mut f32, &mut OverrideRange),
        level: f32,
        timed: bool,
    ) {
        (self.brief, self.quick) = (self.brief << 1 & BEFORE << 1, self.quick << 1 & BEFORE << 1);
        // At twice the speed, which is the highest override.
        if length >= (2.0 / OTHERS) * *v {
            self.length = length;
        } else {
            self.take_short(length, (v, override_range), level, timed);
        }
    }

    #[inline(never)]
    fn take_short(
        &mut self,
        length: f32,
        (v, override_range): (&mut f32, &mut OverrideRange),
        level: f32,
        timed: bool,
    ) {
        let most = override_range.highest(*v, level);
        if most <= OTHERS * length {
            self.length = length;
            return;
        }
        let is_brief =
            self.quick == 0 && self.brief.count_ones() < MOST_BRIEF && length < FAR_SHORTER * self.length;
        if is_brief || timed {
            self.brief |= 1;
        } else {
            self.length = length;
        }
        let lengths = if is_brief {
            BRIEF
        } else if self.brief & !1 != 0 {
            OTHERS
        } else {
            ALL
        };
        if !timed && !is_brief && lengths > OTHERS {
            self.quick |= 1;
        }
        if !timed && most > lengths * length {
            *override_range = override_range.lowered(*v, level, lengths * length);
            *v = min(*v, lengths * length);
        }
        // Never zero, so that quotients stay finite.
        self.length = max(self.length, f32::MIN_POSITIVE);
    }
}

//! How the speed of a block changes with the override (P-CHAN-00066) and with reduced speed (P-AXIS-00214),
//! in four bytes for the memory of the look-ahead.
use crate::math::float::{max, min};
use crate::math::root::sqrt_f32;
use crate::slope::limits::ROUNDED;

/// How the speed of a block follows the override, stored in two 16-bit numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OverrideRange {
    /// Ratio of the machine's speed limit to the feed; [`EVEN`] if both are equal. [`EVEN`] − n: the machine
    /// permits 1 + n/2^15 times the feed; a higher ratio counts as 2. [`EVEN`] + n: the machine permits 1 −
    /// n/2^15 times the feed. Both are rounded to the lower speed.
    over: u16,
    /// Root of (reduced speed / speed at 100 %), LSB 2^-16, rounded down. The largest number means: not
    /// reduced. The root resolves the lowest reduced speed (1 µm/s) and the highest speed.
    reduced: u16,
}

const ONE: f32 = 32_768.0;
const EVEN: u16 = 1 << 15;
const WHOLE: u16 = u16::MAX;

impl OverrideRange {
    /// For a block whose machine limit and feed permit the same speed, and which is not slower at reduced
    /// speed.
    pub const NONE: Self = Self { over: EVEN, reduced: WHOLE };

    /// For no block; all bits zero.
    pub(crate) const BLANK: Self = Self { over: 0, reduced: 0 };

    /// How a block with this feed follows the override. The machine permits `v_max`, and `v_reduced` while
    /// reduced speed is on; all three in mm/tick.
    pub fn new(v_max: f32, feed: f32, v_reduced: f32) -> Self {
        let mut override_range = Self::NONE;
        if v_max > feed {
            override_range.over = EVEN - (min(v_max / feed - 1.0, 1.0) * ONE) as u32 as u16;
        } else if v_max < feed {
            override_range.over = EVEN + min((1.0 - v_max / feed) * ONE, ONE - 1.0) as u16;
        }
        let v = min(v_max, feed);
        if v_reduced < v {
            let root = (sqrt_f32(v_reduced / v) * (2.0 * ONE * ROUNDED)) as u16;
            override_range.reduced = root.clamp(1, WHOLE - 1);
        }
        override_range
    }

    /// Whether the reduced speed makes the block slower.
    pub(crate) fn is_reduced(self) -> bool {
        self.reduced != WHOLE
    }

    /// Ratio of the reduced speed to the speed at 100 %; `None` if the block is not reduced.
    pub(crate) fn part_reduced(self) -> Option<f32> {
        let root = f32::from(self.reduced) * (0.5 / ONE);
        (self.reduced != WHOLE).then_some(root * root)
    }

    /// Two factors: the machine's limit above the feed, 1…2, and the machine's limit below the feed, 0…1.
    pub(crate) fn parts(self) -> [f32; 2] {
        let n = |from: u16, to: u16| f32::from(from.saturating_sub(to)) * (1.0 / ONE);
        [1.0 + n(EVEN, self.over), 1.0 - n(self.over, EVEN)]
    }

    /// Ratio of the speed at the override `level` (1 is 100 %) to the speed at 100 %. Below 100 %, only the
    /// feed falls, and not the limit of the machine.
    pub fn raised(self, level: f32) -> f32 {
        let [above, below] = self.parts();
        min(level / below, above)
    }

    /// The highest speed of a block at any override. The block is planned with the speed `v` for `level`.
    pub(crate) fn highest(self, v: f32, level: f32) -> f32 {
        v / self.raised(level) * self.parts()[0]
    }

    /// The range of a block that is planned with the speed `v` for `level`, if the machine permits at most
    /// the speed `most`.
    pub(crate) fn lowered(self, v: f32, level: f32, most: f32) -> Self {
        let even = v / self.raised(level);
        let feed = even / max(self.parts()[1], 1.0 / ONE);
        let reduced = self.part_reduced().map_or(f32::MAX, |part| even * part);
        Self::new(most, feed, reduced)
    }

    /// A range that is at least as fast as both.
    pub(crate) fn join(&mut self, other: Self) {
        self.over = self.over.max(other.over);
    }

    /// Speed of a block while reduced speed is on. The block is planned with the speed `v` for `level`.
    pub(crate) fn reduced(self, v: f32, level: f32) -> Option<f32> {
        self.part_reduced().map(|part| v / self.raised(level) * part)
    }
}

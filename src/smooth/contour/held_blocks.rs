//! The blocks held back, in their order. They stay where they are: when the first one leaves, the others are
//! only counted anew.
use super::held_block::HeldBlock;

/// Places of three blocks.
#[derive(Clone, Copy, Debug)]
pub(super) struct HeldBlocks<const AXES: usize> {
    places: [Option<HeldBlock<AXES>>; 3],
    /// Where the first one is: 0…2.
    first: u8,
}

impl<const AXES: usize> HeldBlocks<AXES> {
    /// None.
    pub const NONE: Self = Self { places: [None; 3], first: 0 };

    /// The one held back.
    #[cfg_attr(feature = "fast", inline(always))]
    pub fn first(&self) -> Option<&HeldBlock<AXES>> {
        self.places.get(usize::from(self.first))?.as_ref()
    }

    /// The one held back, the one that waits behind it, and the one behind that; or the one that leaves,
    /// behind [`Self::leave`].
    #[cfg_attr(feature = "fast", inline(always))]
    pub const fn all(&self) -> [&Option<HeldBlock<AXES>>; 3] {
        let [a, b, c] = &self.places;
        match self.first {
            0 => [a, b, c],
            1 => [b, c, a],
            _ => [c, a, b],
        }
    }

    /// The same, to be changed.
    #[cfg_attr(feature = "fast", inline(always))]
    pub const fn all_mut(&mut self) -> [&mut Option<HeldBlock<AXES>>; 3] {
        let [a, b, c] = &mut self.places;
        match self.first {
            0 => [a, b, c],
            1 => [b, c, a],
            _ => [c, a, b],
        }
    }

    /// The first one becomes the last one, and each other one the one before.
    pub const fn leave(&mut self) {
        self.first = if self.first < 2 { self.first + 1 } else { 0 };
    }
}

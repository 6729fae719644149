//! The blocks held back, in their order. They stay where they are: when the first one leaves, the others are
//! only counted anew. Where it was, the elements behind it have their place, one after the other.
use super::Made;
use super::held_block::HeldBlock;

/// What is in a place.
#[derive(Clone, Copy, Debug)]
pub(super) enum Slot<const AXES: usize> {
    /// Nothing.
    Free,
    /// A block.
    Block(HeldBlock<AXES>),
    /// An element on its way out: only in the last place.
    Made(Made<AXES>),
}

impl<const AXES: usize> Slot<AXES> {
    /// The block in it.
    #[inline(always)]
    pub const fn block(&self) -> Option<&HeldBlock<AXES>> {
        if let Self::Block(block) = self { Some(block) } else { None }
    }

    /// The block, to change it.
    #[inline(always)]
    pub const fn block_mut(&mut self) -> Option<&mut HeldBlock<AXES>> {
        if let Self::Block(block) = self { Some(block) } else { None }
    }
}

/// Places of three blocks.
#[derive(Clone, Copy, Debug)]
pub(super) struct HeldBlocks<const AXES: usize> {
    slots: [Slot<AXES>; 3],
    /// Where the first one is: 0…2.
    first: u8,
}

impl<const AXES: usize> HeldBlocks<AXES> {
    /// None.
    // In its place: a constant is copied as a whole.
    #[inline(always)]
    pub const fn none() -> Self {
        Self { slots: [Slot::Free, Slot::Free, Slot::Free], first: 0 }
    }

    /// The one held back.
    #[cfg_attr(feature = "fast", inline(always))]
    pub fn first(&self) -> Option<&HeldBlock<AXES>> {
        self.slots.get(usize::from(self.first))?.block()
    }

    /// The block held back, the one that waits after it, and the next one; or, after [`Self::leave`], the block that
    /// leaves and then the elements after it.
    #[cfg_attr(feature = "fast", inline(always))]
    pub const fn all(&self) -> [&Slot<AXES>; 3] {
        let [a, b, c] = &self.slots;
        match self.first {
            0 => [a, b, c],
            1 => [b, c, a],
            _ => [c, a, b],
        }
    }

    /// The three slots, to change them.
    #[cfg_attr(feature = "fast", inline(always))]
    pub const fn all_mut(&mut self) -> [&mut Slot<AXES>; 3] {
        let [a, b, c] = &mut self.slots;
        match self.first {
            0 => [a, b, c],
            1 => [b, c, a],
            _ => [c, a, b],
        }
    }

    /// The block held back, and the place of an element before it, where no block leaves.
    #[cfg_attr(feature = "fast", inline(always))]
    pub fn made(&mut self) -> Option<(&HeldBlock<AXES>, &mut Made<AXES>)> {
        let [held, _, last] = self.all_mut();
        if !matches!(last, Slot::Made(_)) {
            *last = Slot::Made(Made::BLANK);
        }
        if let (Slot::Block(held), Slot::Made(made)) = (held, last) { Some((held, made)) } else { None }
    }

    /// The first one becomes the last one, and each other one the one before.
    pub const fn leave(&mut self) {
        self.first = if self.first < 2 { self.first + 1 } else { 0 };
    }
}

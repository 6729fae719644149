//! Stores up to three blocks that contour mode holds back, in order. When the first block leaves, only
//! indices change, so no block is moved in memory.
//!
//! When the first block has been emitted, its place holds the elements between this block and the next one:
//! the corner's curve, or the line over left-out blocks. The place holds one such element at a time, until
//! the element is emitted.
use super::Made;
use super::held_block::HeldBlock;

/// Content of a place.
#[derive(Clone, Copy, Debug)]
pub(super) enum Slot<const AXES: usize> {
    /// Nothing.
    Free,
    /// A block.
    Block(HeldBlock<AXES>),
    /// An element to be emitted; only the last place may hold an element.
    Made(Made<AXES>),
}

impl<const AXES: usize> Slot<AXES> {
    /// The block in this place.
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

/// Places for three blocks.
#[derive(Clone, Copy, Debug)]
pub(super) struct HeldBlocks<const AXES: usize> {
    slots: [Slot<AXES>; 3],
    /// Index of the first place: 0…2.
    first: u8,
}

impl<const AXES: usize> HeldBlocks<AXES> {
    /// No blocks.
    // Made in place; a constant would be copied as a whole.
    #[inline(always)]
    pub const fn none() -> Self {
        Self { slots: [Slot::Free, Slot::Free, Slot::Free], first: 0 }
    }

    /// The first held block.
    #[cfg_attr(feature = "fast", inline(always))]
    pub fn first(&self) -> Option<&HeldBlock<AXES>> {
        self.slots.get(usize::from(self.first))?.block()
    }

    /// The three slots in order: the held block, the block that waits, and the block after it. After
    /// [`Self::leave`]: the block that leaves, then the elements after it.
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

    /// The held block, and the place of an element before it. Returns `None` while a block is leaving.
    #[cfg_attr(feature = "fast", inline(always))]
    pub fn made(&mut self) -> Option<(&HeldBlock<AXES>, &mut Made<AXES>)> {
        let [held, _, last] = self.all_mut();
        if !matches!(last, Slot::Made(_)) {
            *last = Slot::Made(Made::BLANK);
        }
        if let (Slot::Block(held), Slot::Made(made)) = (held, last) { Some((held, made)) } else { None }
    }

    /// The first place becomes the last one, and every other place moves forward.
    pub const fn leave(&mut self) {
        self.first = if self.first < 2 { self.first + 1 } else { 0 };
    }
}

//! Memory of the blocks: a ring buffer of fixed size, without heap. Blocks enter at the end and leave at the
//! front.
use super::block::Block;

/// A ring of blocks, counted from its front. All bits are zero when new, so the ring takes no flash.
pub(super) struct Blocks<const BLOCKS: usize> {
    places: [Block; BLOCKS],
    /// Index of the first block, below `BLOCKS`, and number of blocks.
    front: usize,
    len: usize,
}

impl<const BLOCKS: usize> Blocks<BLOCKS> {
    /// An empty ring.
    pub const fn new() -> Self {
        Self { places: [Block::BLANK; BLOCKS], front: 0, len: 0 }
    }

    /// Drops all blocks.
    pub fn clear(&mut self) {
        (self.front, self.len) = (0, 0);
    }

    /// Number of blocks.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Number of blocks that fit.
    pub const fn capacity(&self) -> usize {
        BLOCKS
    }

    /// Whether the ring is empty.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// The index `by` places after the front; `by` is at most `BLOCKS`.
    #[cfg_attr(feature = "fast", inline(always))]
    fn place(&self, by: usize) -> usize {
        let at = self.front.wrapping_add(by);
        if at < BLOCKS { at } else { at - BLOCKS }
    }

    /// The block `at` places after the first one.
    #[inline]
    pub fn get(&self, at: usize) -> Option<&Block> {
        if at < self.len { self.places.get(self.place(at)) } else { None }
    }

    /// As [`Self::get`], to change the block.
    #[inline]
    pub fn get_mut(&mut self, at: usize) -> Option<&mut Block> {
        let place = self.place(at);
        if at < self.len { self.places.get_mut(place) } else { None }
    }

    /// The first block.
    #[inline]
    pub fn front(&self) -> Option<&Block> {
        self.get(0)
    }

    /// As [`Self::front`], to change the block.
    #[inline]
    pub fn front_mut(&mut self) -> Option<&mut Block> {
        self.get_mut(0)
    }

    /// The last block.
    #[inline]
    pub fn back_mut(&mut self) -> Option<&mut Block> {
        self.get_mut(self.len.wrapping_sub(1))
    }

    /// Appends a block. Returns `false` if there is no room.
    #[cfg_attr(feature = "fast", inline(always))]
    pub fn push_back(&mut self, block: Block) -> bool {
        if self.len >= BLOCKS {
            return false;
        }
        let at = self.place(self.len);
        let Some(place) = self.places.get_mut(at) else { return false };
        *place = block;
        self.len += 1;
        true
    }

    /// Inserts a block before the first one. Returns `false` if there is no room.
    pub fn push_front(&mut self, block: Block) -> bool {
        if self.len >= BLOCKS {
            return false;
        }
        let at = self.place(BLOCKS - 1);
        let Some(place) = self.places.get_mut(at) else { return false };
        *place = block;
        (self.front, self.len) = (at, self.len + 1);
        true
    }

    /// Removes the first block.
    #[cfg_attr(feature = "fast", inline(always))]
    pub fn pop_front(&mut self) -> Option<&Block> {
        let at = self.front;
        if self.len == 0 {
            return None;
        }
        (self.front, self.len) = (self.place(1), self.len - 1);
        self.places.get(at)
    }

    /// Removes the last block.
    pub fn pop_back(&mut self) -> Option<&Block> {
        let last = self.len.checked_sub(1)?;
        self.len = last;
        self.places.get(self.place(last))
    }

    /// All blocks in order, in two slices: the ring may continue at the start of its array.
    pub fn as_slices(&self) -> (&[Block], &[Block]) {
        let [front, back] = self.parts();
        let part = |places: core::ops::Range<usize>| self.places.get(places).unwrap_or_default();
        (part(front), part(back))
    }

    /// As [`Self::as_slices`], to change the blocks.
    pub fn as_mut_slices(&mut self) -> (&mut [Block], &mut [Block]) {
        let [front, back] = self.parts();
        let (before, behind) = self.places.split_at_mut_checked(front.start).unwrap_or_default();
        let of_front = behind.get_mut(..front.end - front.start).unwrap_or_default();
        (of_front, before.get_mut(back).unwrap_or_default())
    }

    /// The index ranges of both parts.
    fn parts(&self) -> [core::ops::Range<usize>; 2] {
        let room = BLOCKS.saturating_sub(self.front);
        let first = self.len.min(room);
        [self.front..self.front + first, 0..self.len - first]
    }

    /// All blocks in order, to change them.
    pub fn iter_mut(&mut self) -> impl DoubleEndedIterator<Item = &mut Block> {
        let (front, back) = self.as_mut_slices();
        front.iter_mut().chain(back)
    }
}

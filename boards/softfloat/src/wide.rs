//! Products and quotients of integers, for a core whose product has 32 bits.

/// The halves of a word.
#[derive(Clone, Copy)]
pub(crate) struct Halves {
    pub upper: u32,
    pub lower: u32,
}

impl Halves {
    #[inline(always)]
    pub fn of(x: u32) -> Self {
        Self { upper: x >> 16, lower: x & 0xffff }
    }
}

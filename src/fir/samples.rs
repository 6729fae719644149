//! Stores the positions of the last ticks of one axis, or their second differences.
//!
//! Positions are in a ring that is as long as the filter: the newest position replaces the oldest. Each
//! second difference is stored at two places of an array. So the second differences that a filter needs are
//! always one slice of this array, without a wrap.

/// Positions, or second differences. All bits are zero when new.
pub(super) struct Samples<const TAPS: usize>([[i32; 2]; TAPS]);

/// A ring of positions, used from its last place down to its first.
#[repr(C)]
pub(super) struct Ring {
    /// Place of the next position, and place of the oldest one. After the first place, the ring continues
    /// with the last one.
    place: usize,
    /// The last place.
    last: usize,
}

impl Ring {
    /// A buffer of `length` positions, at least one.
    pub const fn of(length: u32) -> Self {
        let last = (length as usize).saturating_sub(1);
        Self { place: last, last }
    }

    /// The place of the next position. A value out of range means: call [`Self::rewind`] first.
    #[inline(always)]
    pub const fn place(&self) -> usize {
        self.place
    }

    /// Steps to the next place, after a position has been written.
    #[inline(always)]
    pub const fn pass(&mut self) {
        self.place = self.place.wrapping_sub(1);
    }

    /// Makes the last place of the ring the next one.
    pub const fn rewind(&mut self) {
        self.place = self.last;
    }

    /// The place of the position with this age; the age is below the ring's length.
    const fn place_of(&self, age: u32) -> usize {
        let place = self.place.wrapping_add(1 + age as usize);
        if place > self.last { place.wrapping_sub(self.last + 1) } else { place }
    }
}

impl<const TAPS: usize> Samples<TAPS> {
    pub const ZERO: Self = Self([[0; 2]; TAPS]);

    /// Fills `some` places from `from` on with a sample.
    pub fn fill(&mut self, from: usize, some: usize, sample: i64) {
        self.0.iter_mut().skip(from).take(some).for_each(|slot| *slot = split(sample));
    }

    /// Writes a position and returns the old one. Returns `None` if there is no such place.
    #[inline(always)]
    pub fn exchange(&mut self, place: usize, x: i64) -> Option<i64> {
        let slot = self.0.get_mut(place)?;
        let oldest = join(*slot);
        *slot = split(x);
        Some(oldest)
    }

    /// The position with this age; the age is below the ring's length.
    pub fn position(&self, ring: &Ring, age: u32) -> i64 {
        self.0.get(ring.place_of(age)).copied().map_or(0, join)
    }

    /// Writes a second difference.
    #[inline(always)]
    pub fn put_difference(&mut self, at: usize, second: i32) {
        if let Some((first, again)) = self.0.as_flattened_mut().split_at_mut_checked(TAPS)
            && let (Some(slot), Some(copy)) = (first.get_mut(at), again.get_mut(at))
        {
            (*slot, *copy) = (second, second);
        }
    }

    /// The second difference with this age; `at` is the place of the newest one.
    pub fn difference(&self, at: usize, age: u32) -> i32 {
        self.differences().get((at + TAPS).wrapping_sub(age as usize)).copied().unwrap_or(0)
    }

    /// All second differences, stored twice, from older to newer ones.
    #[inline(always)]
    pub const fn differences(&self) -> &[i32] {
        self.0.as_flattened()
    }
}

const fn split(position: i64) -> [i32; 2] {
    [position as i32, (position >> 32) as i32]
}

const fn join([lower, upper]: [i32; 2]) -> i64 {
    (upper as i64) << 32 | lower as u32 as i64
}

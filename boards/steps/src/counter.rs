//! Converts set points of one axis to counts (steps of the motor), exactly: a digital differential analyser.
//!
//! The axis makes `counts` steps per `length` mm or degrees. A set point has LSB 2^-32 mm or degrees. A set
//! point times `counts` is a distance in *grains*, and one count has `length` · 2^32 grains. The counter
//! keeps the distance from the last rounding boundary to the set point, in grains. Boundaries are half a
//! count below each whole count. So the boundaries that are passed are the counts of the rounded set point.
use core::num::NonZeroU32;

/// Grains of one axis.
#[derive(Clone, Copy, Debug)]
pub struct Counter {
    counts: i64,
    length: NonZeroU32,
    /// Grains beyond the last boundary: 0…[`Self::unit`] − 1.
    phase: u64,
}

/// Boundaries that a move passes.
#[derive(Clone, Copy, Debug)]
pub struct Crossings {
    /// Number of boundaries.
    pub count: u32,
    /// Grains from the start of the move to the first boundary, 1…`unit`.
    pub first: u64,
    /// Grains from boundary to boundary.
    pub unit: u64,
    /// Grains of the whole move.
    pub size: u64,
}

impl Counter {
    /// A counter at rest on the set point `bits`; also returns its count. `counts` is below 2^31.
    pub fn new(counts: u32, length: NonZeroU32, bits: i64) -> (Self, i64) {
        let mut counter = Self { counts: i64::from(counts), length, phase: 0 };
        let count = counter.stand_at(bits);
        (counter, count)
    }

    /// Sets the position to the set point `bits` without motion; returns its count.
    pub fn stand_at(&mut self, bits: i64) -> i64 {
        let unit = i128::from(self.unit());
        let grains = i128::from(bits) * i128::from(self.counts) + unit / 2;
        let count = grains.checked_div_euclid(unit).unwrap_or(0);
        self.phase = grains.checked_rem_euclid(unit).unwrap_or(0) as u64;
        count as i64
    }

    /// Grains of a count: 2^32…2^52, as `length` is at most 1,000,000.
    pub const fn unit(&self) -> u64 {
        (self.length.get() as u64) << 32
    }

    /// Grains of a move of the set point. The move has to be shorter than [`Self::reach`].
    pub const fn grains(&self, move_bits: i64) -> i64 {
        self.counts.wrapping_mul(move_bits)
    }

    /// The longest move of a set point with fewer counts than `most`, LSB 2^-32 mm. At least 1.
    pub fn reach(&self, most: u32) -> i64 {
        let grains = i64::from(most).saturating_mul(self.unit() as i64);
        grains.checked_div(self.counts).unwrap_or(0).max(1)
    }

    /// Moves by `grains`, fewer than 2^62. One division of 32 bits.
    pub fn advance(&mut self, grains: i64) -> Crossings {
        let unit = self.unit();
        let forward = grains >= 0;
        // Backward all values are mirrored: a boundary is passed by the first grain below it.
        let mirror = |phase: u64| if forward { phase } else { unit.wrapping_sub(1).wrapping_sub(phase) };
        let size = grains.unsigned_abs();
        let phase = mirror(self.phase);
        let total = phase.wrapping_add(size);
        // The lower 32 bits do not matter: those of the unit are 0.
        let count = ((total >> 32) as u32) / self.length;
        self.phase = mirror(total.wrapping_sub(u64::from(count).wrapping_mul(unit)));
        Crossings { count, first: unit.wrapping_sub(phase), unit, size }
    }
}

//! Finds the slots of the tick in which an axis passes the boundaries between counts, which are the slots of
//! its steps.
//!
//! Inside a tick the set point changes linearly. The first slot and the interval between steps take two
//! divisions of 32 bits per axis and tick. Each further step takes one addition that carries the remainder.
//!
//! For this, the length of the move is cut to [`BITS`] bits. The resulting error of a step's slot is below
//! 0.04 slots: each of up to 256 intervals contributes less than 512 · 2^-22, and so does the whole move.
use crate::counter::Crossings;

/// Bits of a move that count. Multiplied by 512 slots, it has 32 bits.
const BITS: u32 = 23;

/// Largest number of slots of a tick.
pub const MAX_SLOTS: u32 = 512;

/// The slots of a tick's steps, one after the other.
#[derive(Clone, Copy, Debug)]
pub struct Spread {
    /// Slot of the next step.
    slot: u32,
    /// Remainder of the slot, below `size`.
    rest: u32,
    /// Interval between steps.
    interval: u32,
    interval_rest: u32,
    size: u32,
}

impl Spread {
    /// For a move that passes at least one boundary; `slots` up to [`MAX_SLOTS`].
    pub fn new(crossings: &Crossings, slots: u32) -> Self {
        let cut = (u64::BITS - crossings.size.leading_zeros()).saturating_sub(BITS);
        // Rounded up, so that every step inside the move stays in the tick.
        let size = ((crossings.size >> cut) as u32).max(1) + u32::from(cut > 0);
        let [first, interval] = [crossings.first, crossings.unit].map(|grains| {
            // With a single boundary the unit may be longer than the move; the interval is then unused.
            ((grains >> cut).min(u64::from(size)) as u32).wrapping_mul(slots)
        });
        // A boundary at the very end of a slot belongs to that slot.
        let first = first.saturating_sub(1);
        // `size` is not 0.
        let divide =
            |value: u32| (value.checked_div(size).unwrap_or(0), value.checked_rem(size).unwrap_or(0));
        let ((slot, rest), (interval, interval_rest)) = (divide(first), divide(interval));
        Self { slot, rest, interval, interval_rest, size }
    }

    /// The slot of the next step, not before that of the last call.
    pub fn next(&mut self) -> u32 {
        let slot = self.slot;
        self.slot += self.interval;
        self.rest += self.interval_rest;
        if self.rest >= self.size {
            self.rest -= self.size;
            self.slot += 1;
        }
        slot
    }
}

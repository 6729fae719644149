//! In which slots of the tick the boundaries are passed.
//!
//! Inside a tick the set point counts as linear. The first slot and the interval are two divisions of 32 bits per axis
//! and tick; each step behind the first one is an addition that carries its remainder.
//!
//! Moves are cut to [`BITS`] bits for that. The slot of a step is off by less than 0.04 slots because of it: each of
//! the up to 256 intervals by less than 512 · 2^-22, the move as a whole by as much.
use crate::counter::Crossings;

/// Bits of a move that count. Times 512 slots it has 32 of them.
const BITS: u32 = 23;

/// Largest number of slots of a tick.
pub const MAX_SLOTS: u32 = 512;

/// The slots of the steps of a tick, one behind the other.
#[derive(Clone, Copy, Debug)]
pub struct Spread {
    /// Of the next step.
    slot: u32,
    /// Its remainder, below `size`.
    rest: u32,
    /// From step to step.
    interval: u32,
    interval_rest: u32,
    size: u32,
}

impl Spread {
    /// Of a move that passes a boundary at least; `slots` up to [`MAX_SLOTS`].
    pub fn new(crossings: &Crossings, slots: u32) -> Self {
        let cut = (u64::BITS - crossings.size.leading_zeros()).saturating_sub(BITS);
        // Rounded up: what lies inside the move stays in the tick.
        let size = ((crossings.size >> cut) as u32).max(1) + u32::from(cut > 0);
        let [first, interval] = [crossings.first, crossings.unit].map(|grains| {
            // With one boundary alone the unit may be longer than the move: then the interval is not used.
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

    /// The slot of the next step, not before the one that the last call gave.
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

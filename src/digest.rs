//! A checksum over the set points of all ticks. If a run on a PC and a run on a microcontroller have the same
//! checksum, their set points are equal.
use crate::quantity::Position;

/// A checksum over set points: FNV-1a, 64 bits, over the 32-bit halves of each set point, low half first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Digest(u64);

impl Default for Digest {
    fn default() -> Self {
        Self::new()
    }
}

impl Digest {
    /// The digest before the first set point.
    pub const fn new() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }

    /// Adds the set points of one tick.
    pub fn add(&mut self, set_points: &[Position]) {
        for point in set_points {
            let bits = point.to_bits() as u64;
            for half in [bits & 0xffff_ffff, bits >> 32] {
                self.0 = (self.0 ^ half).wrapping_mul(0x0000_0100_0000_01b3);
            }
        }
    }

    /// The checksum over all set points added so far.
    pub const fn value(self) -> u64 {
        self.0
    }
}

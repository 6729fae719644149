//! Every number that travels between stages, with its unit, LSB, range and rounding.
//!
//! | type | unit | bits | LSB | range | made by, rounded |
//! |---|---|---|---|---|---|
//! | [`Position`] | mm, degree | I32F32 | 2^-32 (0.23 pm) | ±2^31, programs ±100 000 | decimals: to nearest, ties away from zero; set points: to nearest, ties up |
//! | [`Feed`] | mm/min, degree/min | I32F32 | 2^-32 | 0…2^31 | decimals: to nearest |
//! | [`Distance`] | mm of path | I20F44 | 2^-44 (0.06 fm) | ±2^19, wraps | to nearest |
//! | [`Speed`] | mm/tick | I6F58 | 2^-58 | ±32 | limits down |
//! | [`Accel`] | mm/tick² | I6F58 | 2^-58 | ±32 | limits down |
//! | [`Jerk`] | mm/tick³ | I6F58 | 2^-58 | ±32 | limits down |
//! | [`Time`] | ticks | U28F36 | 2^-36 | 0…2^28 | down, what is left goes to the cruise |
//!
//! Speeds are per tick so that the interrupt needs no multiplication by time. A path speed of a block without
//! motion of the main axes counts degrees instead of millimetres.
use crate::math::float::{to_bits, to_f32};
use fixed::types::{I6F58, I20F44, I32F32, U28F36};

/// Axis coordinate or set point: mm (linear) or degrees (rotary), LSB 2^-32.
pub type Position = I32F32;

/// Programmed feed: mm/min, or degrees/min where no main axis moves.
pub type Feed = I32F32;

macro_rules! quantity {
    ($(#[$doc:meta])* $name:ident, $repr:ty, $bits:ty) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
        pub struct $name(pub $repr);

        impl $name {
            /// The value zero.
            pub const ZERO: Self = Self(<$repr>::ZERO);

            /// From the raw bits, see the table above for the LSB.
            pub const fn from_bits(bits: $bits) -> Self {
                Self(<$repr>::from_bits(bits))
            }

            /// The raw bits.
            pub const fn to_bits(self) -> $bits {
                self.0.to_bits()
            }
        }

        #[cfg(feature = "defmt")]
        impl defmt::Format for $name {
            fn format(&self, f: defmt::Formatter) {
                defmt::write!(f, "{}({=i64})", stringify!($name), self.to_bits() as i64)
            }
        }
    };
}

quantity!(
    /// Length along the path, mm, LSB 2^-44; wraps at ±2^19 mm, only differences count.
    Distance, I20F44, i64);
quantity!(
    /// Path speed, mm/tick, LSB 2^-58.
    Speed, I6F58, i64);
quantity!(
    /// Path acceleration, mm/tick², LSB 2^-58.
    Accel, I6F58, i64);
quantity!(
    /// Path jerk, mm/tick³, LSB 2^-58.
    Jerk, I6F58, i64);
quantity!(
    /// Duration or instant, ticks, LSB 2^-36.
    Time, U28F36, u64);

/// An LSB of a [`Distance`], mm.
pub const DISTANCE_LSB: f32 = 1.0 / (1u64 << 44) as f32;

/// The LSB of [`Speed`], [`Accel`] and [`Jerk`], 2^-58, as a factor.
pub const SPEED_LSB: f32 = 1.0 / (1u64 << 58) as f32;

/// Speed in units of 2^-58, cut to the integer below.
pub fn speed_bits(v: f32) -> i64 {
    to_bits::<58>(v)
}

/// Speed as `f32`.
pub fn speed_f32(bits: i64) -> f32 {
    to_f32(bits) * SPEED_LSB
}

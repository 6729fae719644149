//! The fixed-point numbers that stages exchange: set points, feeds and path values, with unit, LSB (value of
//! the lowest bit), range and rounding.
//!
//! ```
//! use glidepath::quantity::{Position, Speed};
//!
//! let half = Position::from_num(0.5); // mm or degrees
//! assert_eq!(half.to_bits(), 1 << 31); // LSB 2^-32
//! let speed = Speed::from_bits(1 << 57); // 0.5 mm per tick: 500 mm/s at a cycle of 1 ms
//! assert_eq!(speed.0.to_num::<f64>() * 1000.0, 500.0);
//! ```
//!
//! | type | unit | bits | LSB | range | rounding |
//! |---|---|---|---|---|---|
//! | [`Position`] | mm, degree | I32F32 | 2^-32 (0.23 pm) | ±2^31; in programs ±100 000 | decimals of a program: to nearest, ties away from zero; set points: to nearest, ties up |
//! | [`Feed`] | mm/min, degree/min | I32F32 | 2^-32 | 0…2^31 | decimals of a program: to nearest |
//! | [`Distance`] | mm of path | I20F44 | 2^-44 (0.06 fm) | ±2^19, wraps | to nearest |
//! | [`Speed`] | mm/tick | I6F58 | 2^-58 | ±32 | limits: down |
//! | [`Accel`] | mm/tick² | I6F58 | 2^-58 | ±32 | limits: down |
//! | [`Jerk`] | mm/tick³ | I6F58 | 2^-58 | ±32 | limits: down |
//! | [`Time`] | ticks | U28F36 | 2^-36 | 0…2^28 | down; the time of constant speed gets the remainder |
//!
//! Speeds are per tick, so the interrupt needs no multiplication by time. In a block that moves no main axis,
//! degrees replace millimetres.
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

            /// The value with these raw bits. The table of [the module](crate::quantity) gives the LSB.
            pub const fn from_bits(bits: $bits) -> Self {
                Self(<$repr>::from_bits(bits))
            }

            /// The raw bits: the value as a multiple of the LSB.
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
    /// Length along the path, mm, LSB 2^-44. The value wraps around at ±2^19 mm, so only differences of two
    /// distances have a meaning.
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
    /// Duration or time, ticks, LSB 2^-36.
    Time, U28F36, u64);

/// The LSB of a [`Distance`], 2^-44, in mm.
pub const DISTANCE_LSB: f32 = 1.0 / (1u64 << 44) as f32;

/// The LSB of [`Speed`], [`Accel`] and [`Jerk`], 2^-58, in mm per tick, tick² and tick³.
pub const SPEED_LSB: f32 = 1.0 / (1u64 << 58) as f32;

/// Converts a speed from mm/tick to units of 2^-58 mm/tick, rounded down. A negative speed gives 0. A speed
/// above the range gives the largest value.
pub fn speed_bits(v: f32) -> i64 {
    to_bits::<58>(v)
}

/// Converts a speed from units of 2^-58 mm/tick to mm/tick.
pub fn speed_f32(bits: i64) -> f32 {
    to_f32(bits) * SPEED_LSB
}

/// A position that `Display` writes with a fixed number of decimals, at most 18. The output is rounded to
/// nearest, ties to even. `Display` of the `fixed` crate is not used, because it contains an index that could
/// panic.
#[doc(hidden)]
pub struct Decimal {
    /// The position, LSB 2^-32 mm or degrees.
    pub bits: i64,
    /// Digits after the decimal point.
    pub decimals: usize,
}

impl core::fmt::Display for Decimal {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        const ONE: u64 = 1 << 32;
        let one = (0..self.decimals.min(18)).fold(1_u64, |power, _| power * 10);
        let size = self.bits.unsigned_abs();
        let scaled = u128::from(size % ONE) * u128::from(one);
        let (mut digits, rest) = ((scaled >> 32) as u64, scaled as u64 % ONE);
        let half = ONE / 2;
        digits += u64::from(rest > half || rest == half && digits % 2 == 1);
        let whole = size / ONE + u64::from(digits == one);
        let digits = if digits == one { 0 } else { digits };
        let sign = if self.bits < 0 { "-" } else { "" };
        write!(f, "{sign}{whole}.{digits:0width$}", width = self.decimals.min(18))
    }
}

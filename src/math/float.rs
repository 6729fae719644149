//! Conversions between 64-bit integers and `f32` without library calls. All operations are exact or correctly
//! rounded, so every machine gives the same bits.

use super::soft::{self, IS_SOFT};

const TWO_32: f32 = 4_294_967_296.0;

/// `x` as `f32`, relative error at most 2^-23: each half is rounded, then the sum. Mirrored input gives
/// mirrored output.
#[cfg_attr(feature = "fast", inline(always))]
pub fn to_f32(x: i64) -> f32 {
    let size = size_f32(x.unsigned_abs());
    if x < 0 { -size } else { size }
}

/// `x` as `f32`, relative error at most 2^-23.
#[cfg_attr(feature = "fast", inline(always))]
pub fn size_f32(x: u64) -> f32 {
    if IS_SOFT {
        return soft::size_f32(x);
    }
    (x >> 32) as u32 as f32 * TWO_32 + x as u32 as f32
}

/// The integer part of `x`·2^`SCALE`, exact, for 0 ≤ x·2^(`SCALE` − 32) < 2^31. Larger values saturate;
/// negative values give 0.
#[cfg_attr(feature = "fast", inline(always))]
pub fn to_bits<const SCALE: u32>(x: f32) -> i64 {
    if IS_SOFT {
        return soft::integer(x, SCALE);
    }
    // Both factors are powers of two: the products are exact, and so is the difference.
    let upper = x * const { (1u64 << (SCALE - 32)) as f32 };
    let whole = upper as i32;
    if whole < 0 {
        return 0;
    }
    let rest = (upper - whole as f32) * TWO_32;
    (i64::from(whole) << 32) | i64::from(rest as u32)
}

/// The integer part of `x`, exact, rounded toward zero; magnitudes from 2^63 on become 2^63 − 1.
#[cfg_attr(feature = "fast", inline(always))]
pub fn to_i64(x: f32) -> i64 {
    if IS_SOFT {
        let size = soft::integer(magnitude(x), 0);
        return if x < 0.0 { -size } else { size };
    }
    // A power of two and a difference: both are exact where the result depends on them.
    let upper = magnitude(x) * (1.0 / TWO_32);
    let whole = upper as i32;
    let rest = (upper - whole as f32) * TWO_32;
    let size = (i64::from(whole) << 32) | i64::from(rest as u32);
    if x < 0.0 { -size } else { size }
}

/// The smaller value, without the NaN rule of `f32::min`, which costs instructions. No operand may be NaN. In
/// a running minimum, pass the minimum so far second: it then stays in its register.
#[cfg_attr(feature = "fast", inline(always))]
pub fn min(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// The larger value. No operand may be NaN.
#[cfg_attr(feature = "fast", inline(always))]
pub fn max(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// The absolute value.
#[cfg_attr(feature = "fast", inline(always))]
pub fn magnitude(x: f32) -> f32 {
    x.abs()
}

//! Numbers of 32 bits from integers, to integers, and from and to 64 bits.
use crate::single::{LIMIT, SIGN, lift};

/// Rounds a mantissa with its first bit in bit 31, to nearest, ties to even. `exponent` is that in the bits,
/// less one, of 1 to 253.
#[inline(always)]
fn round(sign: u32, exponent: u32, mantissa: u32) -> u32 {
    let odd = mantissa >> 8 & 1;
    let below = mantissa & 0xff;
    let up = u32::from(below.wrapping_add(odd) > 0x80);
    (exponent << 23).wrapping_add(mantissa >> 8).wrapping_add(up) | sign
}

/// From an integer without sign.
#[inline(always)]
pub fn from_u32(x: u32) -> u32 {
    if x == 0 { 0 } else { magnitude(0, x) }
}

/// From an integer.
#[inline(always)]
pub fn from_i32(x: i32) -> u32 {
    if x == 0 { 0 } else { magnitude(x as u32 & SIGN, x.unsigned_abs()) }
}

#[inline(always)]
fn magnitude(sign: u32, x: u32) -> u32 {
    let (mantissa, zeros) = lift(x);
    round(sign, 157u32.wrapping_sub(zeros), mantissa)
}

/// From an integer of 64 bits without sign.
#[inline(always)]
pub fn from_u64(x: u64) -> u32 {
    if x >> 32 == 0 { from_u32(x as u32) } else { long_magnitude(0, x) }
}

/// From an integer of 64 bits.
#[inline(always)]
pub fn from_i64(x: i64) -> u32 {
    let sign = (x >> 32) as u32 & SIGN;
    let x = x.unsigned_abs();
    match ((x >> 32) as u32, x as u32) {
        (0, 0) => 0,
        (0, low) => magnitude(sign, low),
        _ => long_magnitude(sign, x),
    }
}

/// From an integer of at least 2^32.
#[inline(always)]
fn long_magnitude(sign: u32, x: u64) -> u32 {
    let (high, low) = ((x >> 32) as u32, x as u32);
    let (high, zeros) = lift(high);
    let (next, lost) = (low >> 1 >> (31 - zeros), low << zeros);
    let mantissa = high | next | u32::from(lost != 0);
    round(sign, 189u32.wrapping_sub(zeros), mantissa)
}

/// The mantissa of a number from 1 to 2^64 with its first bit in bit 31, and the place of this bit in the
/// integer.
#[inline(always)]
fn integer(x: u32) -> (u32, u32) {
    (x << 8 | SIGN, (x << 1 >> 24).wrapping_sub(127))
}

/// To an integer without sign, towards 0. Out of range: 0 or the largest integer; 0 for a NaN.
#[inline(always)]
pub fn to_u32(x: u32) -> u32 {
    let (mantissa, place) = integer(x);
    if (x as i32) < 0 || place >= 32 {
        return outside(x, 0, u32::MAX);
    }
    mantissa >> (31 - place)
}

/// To an integer, towards 0. Out of range: the smallest or the largest integer; 0 for a NaN.
#[inline(always)]
pub fn to_i32(x: u32) -> i32 {
    let (mantissa, place) = integer(x);
    if place >= 31 {
        return outside(x, i32::MIN, i32::MAX);
    }
    let magnitude = (mantissa >> (31 - place)) as i32;
    if (x as i32) < 0 { magnitude.wrapping_neg() } else { magnitude }
}

/// To an integer of 64 bits without sign, towards 0.
#[inline(always)]
pub fn to_u64(x: u32) -> u64 {
    let (mantissa, place) = integer(x);
    if (x as i32) < 0 || place >= 64 {
        return outside(x, 0, u64::MAX);
    }
    long(mantissa, place)
}

/// To an integer of 64 bits, towards 0.
#[inline(always)]
pub fn to_i64(x: u32) -> i64 {
    let (mantissa, place) = integer(x);
    if place >= 63 {
        return outside(x, i64::MIN, i64::MAX);
    }
    let magnitude = long(mantissa, place) as i64;
    if (x as i32) < 0 { magnitude.wrapping_neg() } else { magnitude }
}

/// The integer with the first bit of `mantissa` at `place`, of 0 to 63.
#[inline(always)]
fn long(mantissa: u32, place: u32) -> u64 {
    if place < 32 {
        return u64::from(mantissa >> (31 - place));
    }
    let shift = place - 31;
    let high = mantissa >> (32 - shift);
    u64::from(high) << 32 | u64::from(mantissa << 1 << (shift - 1))
}

/// The integer for a number that is below 1, negative or too large.
#[inline(always)]
fn outside<T: From<bool>>(x: u32, lowest: T, highest: T) -> T {
    match x << 1 {
        small if small < 127 << 24 => T::from(false),
        nan if nan > LIMIT => T::from(false),
        _ if (x as i32) < 0 => lowest,
        _ => highest,
    }
}

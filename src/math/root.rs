//! Square roots of integers, exact; square and cube roots of `f32`, with a relative error below 2^-23.
//!
//! The integer roots scale the radicand to x in [1/4, 1). Newton's step y ← y + y·(1 − x·y²)/2 approaches
//! 1/√x; the first steps use `f32`. The product s = x·y is then close to √x. The step s ← s + (x − s²)·y/2
//! (Karp and Markstein) improves s, and an exact remainder decides the last unit. The integer roots need
//! neither a division nor a loop.
use super::soft::{self, IS_SOFT};
use super::wide::mul_wide;
use micromath::F32Ext;

/// 1/√x with 30 fraction bits, for x = m / 2^32 in [1/4, 1). The relative error is below 2^-29.
fn inverse_sqrt(m: u32) -> u32 {
    let x = m as f32;
    // The seed of micromath has a relative error of 3.5 %. The steps reduce it to 1.8e-3, 5e-6 and 4e-11,
    // plus 2^-30 of rounding.
    let mut y = F32Ext::invsqrt(x);
    let half = 0.5 * x;
    y *= 1.5 - half * y * y;
    y *= 1.5 - half * y * y;
    // 1/√m = 2^-16/√x
    newton(m as u64, (y * (1u64 << 46) as f32) as u32 as u64) as u32
}

/// One Newton step for 1/√x: y + y·(1 − x·y²)/2, with 30 fraction bits in y and x = m / 2^32.
const fn newton(m: u64, y: u64) -> u64 {
    let square = y.wrapping_mul(y) >> 30;
    // 1 − x·y² in 62 fraction bits, its half in 32 of them.
    let error = (1i64 << 62).wrapping_sub(square.wrapping_mul(m) as i64) >> 31;
    y.wrapping_add_signed(error.wrapping_mul(y as i64) >> 32)
}

/// First values for the upper word `n` of a scaled radicand x: 1/√x with 30 fraction bits, and √x with 32
/// fraction bits. Both are a few units off.
fn estimate(n: u64) -> (i64, u64) {
    let y = inverse_sqrt((n >> 32) as u32) as u64;
    // x < 1 keeps the root below 1, but the error of y may not.
    let root = (n >> 32).wrapping_mul(y) >> 30;
    (y as i64, if root > 0xffff_ffff { 0xffff_ffff } else { root })
}

/// n − s² modulo 2^128.
const fn remainder(n: u128, s: u64) -> i128 {
    let (hi, lo) = mul_wide(s, s);
    n.wrapping_sub(((hi as u128) << 64) | lo as u128) as i128
}

/// floor(√(hi·2^64 + lo)), exact.
pub fn sqrt_wide(hi: u64, lo: u64) -> u64 {
    if hi == 0 && lo == 0 {
        return 0;
    }
    let zeros = if hi == 0 { 64 + lo.leading_zeros() } else { hi.leading_zeros() };
    let half_shift = (zeros / 2) & 63;
    let shift = 2 * half_shift;
    let high =
        if shift < 64 { (hi << shift) | ((lo >> 1) >> (63 - shift)) } else { lo << ((shift - 64) & 63) };
    let (y, root) = estimate(high);
    // |x − s²| < 2^-28: 31 bits of the difference suffice; the error is then below 2^6 units of 2^-64.
    let error = high.wrapping_sub(root.wrapping_mul(root)) as i64 >> 5;
    let root = (root << 32).saturating_add_signed(error.wrapping_mul(y) >> 26);
    if half_shift >= 8 {
        // At most one unit off, so the remainder fits 64 bits.
        let root = root >> half_shift;
        let error = lo.wrapping_sub(root.wrapping_mul(root)) as i64;
        return settle(root, error < 0, error > (root << 1) as i64);
    }
    let n = (((hi as u128) << 64) | lo as u128) << shift;
    // |n − s²| < 2^71: 31 bits suffice; the result is then at most one unit off.
    let error = (remainder(n, root) >> 40) as i64;
    let root = root.saturating_add_signed(error.wrapping_mul(y) >> 55);
    // floor(√(n·4^-k)) = floor(floor(√n)·2^-k).
    let error = remainder(n, root);
    settle(root, error < 0, error > (root as i128) << 1) >> half_shift
}

/// The exact root, from a `root` that is at most one unit off. `above`: the square of `root` is too large.
/// `below`: the square is so small that the next root fits too.
#[cfg_attr(feature = "fast", inline(always))]
const fn settle(root: u64, above: bool, below: bool) -> u64 {
    if above {
        root.wrapping_sub(1)
    } else if below {
        root.wrapping_add(1)
    } else {
        root
    }
}

/// floor(√x), exact. At most 139 instructions on thumbv7em.
pub fn sqrt_u64(x: u64) -> u32 {
    if x == 0 {
        return 0;
    }
    let half_shift = (x.leading_zeros() / 2) & 31;
    let n = x << (2 * half_shift);
    let (y, root) = estimate(n);
    // |n − s²| < 2^37: 29 bits suffice; the result is then at most one unit off.
    let error = n.wrapping_sub(root.wrapping_mul(root)) as i64 >> 8;
    let root = root.wrapping_add_signed(error.wrapping_mul(y) >> 55);
    let root = if root > 0xffff_ffff { 0xffff_ffff } else { root };
    let error = n.wrapping_sub(root.wrapping_mul(root)) as i64;
    let root = settle(root, error < 0, error > (root << 1) as i64);
    (root >> half_shift) as u32
}

/// √x with a relative error of at most 9.0e-8 < 2^-23, measured for all mantissas. 0 gives 0, and a number
/// below 0 gives NaN.
///
/// Squares of whole numbers up to 4095² have exact roots. The function takes 21 instructions inlined on
/// thumbv7em, three of them divisions.
///
/// The seed uses half the exponent, with an error of 6 %. Three of Heron's steps s ← (s + x/s)/2 reduce the
/// error: 6 % → 1.8e-3 → 1.6e-6 → rounding only.
#[cfg_attr(feature = "fast", inline(always))]
pub fn sqrt_f32(x: f32) -> f32 {
    // Not 0, subnormal, infinite or negative.
    const NORMAL: core::ops::Range<u32> = f32::MIN_POSITIVE.to_bits()..f32::INFINITY.to_bits();
    if x.to_bits().wrapping_sub(NORMAL.start) < NORMAL.end - NORMAL.start {
        heron(x)
    } else {
        sqrt_special(x)
    }
}

/// The root of a normal number above 0.
#[cfg_attr(feature = "fast", inline(always))]
fn heron(x: f32) -> f32 {
    let mut s = f32::from_bits((x.to_bits() + 0x3f80_0000) >> 1);
    // The sum is normal, so half of it is exact.
    let half = |x: f32| if IS_SOFT { soft::half(x) } else { 0.5 * x };
    s = half(s + x / s);
    s = half(s + x / s);
    // The difference is exact, so only half of it carries the quotient's rounding.
    s + 0.5 * (x / s - s)
}

#[cold]
#[inline(never)]
fn sqrt_special(x: f32) -> f32 {
    if x == 0.0 || x == f32::INFINITY {
        x
    } else if x > 0.0 {
        // The seed reads the exponent. Subnormal numbers have none, so x is scaled by 2^48.
        heron(x * 281_474_976_710_656.0) * (1.0 / 16_777_216.0)
    } else {
        f32::NAN
    }
}

/// ³√x with the sign of x; 0 gives 0. The relative error is at most 9.8e-8, measured for all mantissas.
///
/// The function takes 65 instructions on thumbv7em, two of them divisions.
///
/// The seed uses a third of the exponent, with an error of 4 %. Two of Halley's steps reduce the error: 4 % →
/// 4.3e-5 → rounding only.
pub fn cbrt_f32(x: f32) -> f32 {
    let magnitude = f32::from_bits(x.to_bits() & 0x7fff_ffff);
    if magnitude == 0.0 || !magnitude.is_finite() {
        return x;
    }
    // Near the ends of the range x is scaled: 2^±48 has the root 2^±16, and y³ stays finite.
    let (a, scale) = if magnitude < 1.0e-30 {
        (magnitude * 281_474_976_710_656.0, 1.0 / 65_536.0)
    } else if magnitude > 1.0e30 {
        (magnitude * (1.0 / 281_474_976_710_656.0), 65_536.0)
    } else {
        (magnitude, 1.0)
    };
    let mut y = cbrt_guess(a);
    y = halley(a, y);
    y = halley(a, y);
    let root = y * scale;
    if x < 0.0 { -root } else { root }
}

/// A start value for an iteration: ³√x for x > 0 from a third of the exponent, with a relative error of at
/// most 4 %.
#[cfg_attr(feature = "fast", inline(always))]
pub fn cbrt_guess(x: f32) -> f32 {
    // Exponent bias: 127·(1 − 1/3) in units of the mantissa's last bit, lowered to balance the error.
    f32::from_bits((x.to_bits() / 3).wrapping_add(0x2a51_4067))
}

/// One of Halley's steps for ³√a: y + y·((a − y³) / (2·y³ + a)). In this order nothing underflows.
fn halley(a: f32, y: f32) -> f32 {
    let cube = y * y * y;
    y + y * ((a - cube) / (2.0 * cube + a))
}

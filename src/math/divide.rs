//! Quotients of 128-bit by 64-bit integers, exact, without the division routines of the compiler's library.
//!
//! Two steps give the two quotient digits of 32 bits each. Each step multiplies by a precomputed reciprocal
//! word. See N. Möller, T. Granlund, "Improved division by invariant integers", IEEE Trans. Computers 60
//! (2011): algorithm 5 is the step, algorithm 6 the reciprocal. The reciprocal word starts from one hardware
//! division, accurate to 15 bits. Newton steps refine it, and a final remainder makes it exact.
//!
//! [`reciprocal_near`] is for uses that need no exact value.

/// The reciprocal word of a 32-bit divisor: floor((2^64 − 1) / d) − 2^32 for d ≥ 2^31.
const fn reciprocal_word(d: u32) -> u32 {
    // 2^48/d to a relative 2^-15. The bit is already set; it proves that the divisor is not zero.
    let seed = (u32::MAX / ((d >> 16) | 0x8000)) as i64;
    let d = d as i64;
    // |2^48 − seed·d| < 2^34: relative error 2^-30 after one step, below one unit after the second.
    let first = (seed << 16).wrapping_add(((1 << 48) - seed.wrapping_mul(d)).wrapping_mul(seed) >> 32);
    let rest = 0i64.wrapping_sub(first.wrapping_mul(d));
    let second = first.wrapping_add(rest.wrapping_mul(seed) >> 48);
    // 2^64 − 1 − second·d, modulo 2^64, is within one d of its range.
    let rest = (-1i64).wrapping_sub(second.wrapping_mul(d));
    let exact = if rest < 0 {
        second.wrapping_sub(1)
    } else if rest >= d {
        second.wrapping_add(1)
    } else {
        second
    };
    exact as u32
}

/// The reciprocal word of a 64-bit divisor (algorithm 6): floor((2^96 − 1) / d) − 2^32 for d ≥ 2^63.
const fn reciprocal(d: u64) -> u32 {
    let (d1, d0) = ((d >> 32) as u32, d as u32);
    let mut v = reciprocal_word(d1);
    let mut p = d1.wrapping_mul(v).wrapping_add(d0);
    if p < d0 {
        v = v.wrapping_sub(1);
        if p >= d1 {
            v = v.wrapping_sub(1);
            p = p.wrapping_sub(d1);
        }
        p = p.wrapping_sub(d1);
    }
    let t = (v as u64).wrapping_mul(d0 as u64);
    let (t1, t0) = ((t >> 32) as u32, t as u32);
    let p = p.wrapping_add(t1);
    if p < t1 {
        v = v.wrapping_sub(1);
        if ((p as u64) << 32) | t0 as u64 >= d {
            v = v.wrapping_sub(1);
        }
    }
    v
}

/// One quotient digit and the remainder of (u·2^32 + u0) / d (algorithm 5). `u` must be below `d`; `v` is the
/// reciprocal word of `d`.
const fn step(u: u64, u0: u32, d: u64, v: u32) -> (u32, u64) {
    let (d1, d0) = ((d >> 32) as u32, d as u32);
    let (u2, u1) = ((u >> 32) as u32, u as u32);
    let q = (v as u64).wrapping_mul(u2 as u64).wrapping_add(u);
    let (mut q1, q0) = ((q >> 32) as u32, q as u32);
    let r1 = u1.wrapping_sub(q1.wrapping_mul(d1));
    let t = (d0 as u64).wrapping_mul(q1 as u64);
    let mut r = (((r1 as u64) << 32) | u0 as u64).wrapping_sub(t).wrapping_sub(d);
    q1 = q1.wrapping_add(1);
    if (r >> 32) as u32 >= q0 {
        q1 = q1.wrapping_sub(1);
        r = r.wrapping_add(d);
    }
    if r >= d {
        q1 = q1.wrapping_add(1);
        r = r.wrapping_sub(d);
    }
    (q1, r)
}

/// floor((hi·2^64 + lo) / d), exact; `u64::MAX` if the quotient does not fit or d is zero.
///
/// At most 176 instructions on thumbv7em, one of them a division.
pub const fn div_wide(hi: u64, lo: u64, d: u64) -> u64 {
    if hi >= d {
        return u64::MAX;
    }
    // d > 0, so that the shift is at most 63; hi < d keeps hi inside its word.
    let shift = d.leading_zeros() & 63;
    let d = d << shift;
    let hi = (hi << shift) | ((lo >> 1) >> (63 - shift));
    let lo = lo << shift;
    let v = reciprocal(d);
    let (q1, r) = step(hi, (lo >> 32) as u32, d, v);
    let (q0, _) = step(r, lo as u32, d, v);
    ((q1 as u64) << 32) | q0 as u64
}

/// a·2^shift as high and low word, for a shift of 0…64.
const fn widen(a: u64, shift: u32) -> (u64, u64) {
    match shift {
        0 => (0, a),
        1..=63 => (a >> (64 - shift), a << shift),
        _ => (a, 0),
    }
}

/// floor(a·2^shift / b), exact; `u64::MAX` if the quotient does not fit or b is zero.
///
/// `shift` is 0…64; a larger shift counts as 64.
pub const fn div_shift(a: u64, shift: u32, b: u64) -> u64 {
    let (hi, lo) = widen(a, shift);
    div_wide(hi, lo, b)
}

/// An approximate reciprocal: 2^126 / d for d ≥ 2^63, at most 32 below the exact value. It is for products
/// that need no exact last bits.
///
/// The upper word comes from `f32`, with a relative error of 2^-22. Two Newton steps y ← y + y·(1 − x·y) with
/// x = d/2^64 reduce the error to 2^-30 and to 2^-59. The result is below 2^63.
pub const fn reciprocal_near(d: u64) -> u64 {
    const ONE: i64 = 1 << 62;
    let (d1, d0) = ((d >> 32) as u32 as u64, d as u32 as u64);
    // 30 fraction bits.
    let seed = ((1u64 << 62) as f32 / d1 as u32 as f32) as u32;
    let error = ONE.wrapping_sub((seed as u64).wrapping_mul(d1) as i64);
    let y = (seed as i64).wrapping_add((seed as i64).wrapping_mul(error >> 31) >> 31);
    // 62 fraction bits.
    let product = (y as u64).wrapping_mul(d1).wrapping_add((y as u64).wrapping_mul(d0) >> 32);
    let error = ONE.wrapping_sub(product as i64);
    ((y as u64) << 32).wrapping_add_signed(y.wrapping_mul(error >> 2) >> 28).wrapping_sub(16)
}

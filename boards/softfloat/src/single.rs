//! Sum, product and quotient of 32-bit numbers.
//!
//! Arguments and results are the bits of an `f32`. A mantissa stands with its first bit in bit 30, so that seven
//! bits below the last bit of the result decide on rounding. Bit 0 of a mantissa also says that a bit below is
//! set.
use crate::wide::Halves;

pub(crate) const SIGN: u32 = 0x8000_0000;
/// The bits of infinity without sign, one place to the left.
pub(crate) const LIMIT: u32 = 0xff00_0000;
const INFINITY: u32 = 0x7f80_0000;
const NAN: u32 = 0x7fc0_0000;
/// Says that a NaN is quiet.
const QUIET: u32 = 0x0040_0000;
/// First bit of a mantissa.
const FIRST: u32 = 0x4000_0000;
/// Bits of a mantissa.
const FRACTION: u32 = 0x007f_ffff;

/// The exponent as it stands in the bits.
#[inline(always)]
fn exponent(x: u32) -> u32 {
    x << 1 >> 24
}

/// The mantissa of a normal number.
#[inline(always)]
fn mantissa(x: u32) -> u32 {
    (x << 8 | SIGN) >> 1
}

/// The mantissa and the exponent of a number other than 0, with the exponent of a normal number below 1.
#[inline(always)]
fn parts(x: u32) -> (u32, i32) {
    match exponent(x) {
        0 => {
            let (fraction, zeros) = lift(x & FRACTION);
            (fraction >> 1, 9i32.wrapping_sub(zeros as i32))
        }
        normal => (mantissa(x), normal as i32),
    }
}

/// Shifts to the left until bit 31 is set; also returns by how much. `x` is not 0.
///
/// A core without an instruction that counts zeros takes 10 to 20 instructions.
#[inline(always)]
pub(crate) fn lift(x: u32) -> (u32, u32) {
    if !cfg!(narrow) {
        let zeros = x.leading_zeros() & 31;
        return (x << zeros, zeros);
    }
    let (mut x, mut zeros) = (x, 0);
    for shift in [16, 8, 4, 2, 1] {
        if x >> (32 - shift) == 0 {
            x <<= shift;
            zeros += shift;
        }
    }
    (x, zeros)
}

/// Rounds to nearest, ties to even. `exponent` is 1 to 254.
#[inline(always)]
fn round(sign: u32, exponent: u32, mantissa: u32) -> u32 {
    let odd = mantissa >> 7 & 1;
    let rounded = mantissa.wrapping_add(0x3f).wrapping_add(odd) >> 7;
    // The first bit of the mantissa adds one to the exponent.
    (exponent.wrapping_sub(1) << 23).wrapping_add(rounded) | sign
}

/// The same for any exponent: too large becomes infinite, too small becomes subnormal or 0.
#[inline(always)]
fn finish(sign: u32, exponent: i32, mantissa: u32) -> u32 {
    if (exponent as u32).wrapping_sub(1) < 254 {
        round(sign, exponent as u32, mantissa)
    } else {
        beyond(sign, exponent, mantissa)
    }
}

#[cold]
#[inline(never)]
pub(crate) fn beyond(sign: u32, exponent: i32, mantissa: u32) -> u32 {
    if exponent > 0 {
        return sign | INFINITY;
    }
    let shift = 1i32.wrapping_sub(exponent) as u32;
    if shift > 30 {
        return sign;
    }
    let kept = mantissa >> shift;
    let lost = kept << shift != mantissa;
    round(sign, 1, kept | u32::from(lost))
}

/// a + b.
#[inline(always)]
pub fn add(a: u32, b: u32) -> u32 {
    let (a, b) = if a << 1 < b << 1 { (b, a) } else { (a, b) };
    let (larger, smaller) = (exponent(a), exponent(b));
    if larger == 255 || smaller == 0 {
        return add_special(a, b);
    }
    add_mantissas(a, b, larger, larger.wrapping_sub(smaller), mantissa(b))
}

/// a + b with |a| ≥ |b|, `a` normal. The first bit of `b` stands `distance` places below that of `a`, if it is
/// in bit 30.
#[inline(always)]
fn add_mantissas(a: u32, b: u32, exponent: u32, distance: u32, smaller: u32) -> u32 {
    if distance > 25 {
        return a;
    }
    let sign = a & SIGN;
    let mut kept = smaller >> distance;
    // Seven bits below the mantissa are free.
    if distance > 7 {
        kept |= u32::from(kept << distance != smaller);
    }
    let larger = mantissa(a);
    if (a ^ b) as i32 >= 0 {
        let sum = larger.wrapping_add(kept);
        if sum < SIGN {
            return round(sign, exponent, sum);
        }
        return finish(sign, exponent.wrapping_add(1) as i32, sum >> 1 | sum & 1);
    }
    let rest = larger.wrapping_sub(kept);
    if rest >= FIRST {
        return round(sign, exponent, rest);
    }
    if rest == 0 {
        return 0;
    }
    if rest >= FIRST >> 1 {
        return finish(sign, exponent.wrapping_sub(1) as i32, rest << 1);
    }
    let (rest, zeros) = lift(rest);
    finish(sign, exponent.wrapping_add(1).wrapping_sub(zeros) as i32, rest >> 1)
}

/// |a| ≥ |b|, with an infinity or a NaN in `a`, or 0 or a subnormal number in `b`.
#[inline(never)]
fn add_special(a: u32, b: u32) -> u32 {
    if a << 1 >= LIMIT {
        return if a << 1 > LIMIT {
            a | QUIET
        } else if a ^ b == SIGN {
            NAN
        } else {
            a
        };
    }
    if b << 1 == 0 {
        return if a << 1 == 0 { a & b } else { a };
    }
    if exponent(a) == 0 {
        // Two subnormal numbers; a carry makes the sum a normal number.
        return match a ^ b {
            SIGN => 0,
            signs if signs < SIGN => a.wrapping_add(b & FRACTION),
            _ => a.wrapping_sub(b & FRACTION),
        };
    }
    add_mantissas(a, b, exponent(a), exponent(a).wrapping_sub(1), (b & FRACTION) << 7)
}

/// a − b.
#[inline(always)]
pub fn sub(a: u32, b: u32) -> u32 {
    add(a, b ^ SIGN)
}

/// a · b.
#[inline(always)]
pub fn mul(a: u32, b: u32) -> u32 {
    let (first, second) = (exponent(a), exponent(b));
    if first.wrapping_sub(1) >= 254 || second.wrapping_sub(1) >= 254 {
        return mul_special(a, b);
    }
    let exponent = first.wrapping_add(second).wrapping_sub(127) as i32;
    mul_mantissas((a ^ b) & SIGN, exponent, mantissa(a), mantissa(b))
}

/// The product of mantissas. `exponent` is that of a product below 2.
#[inline(always)]
fn mul_mantissas(sign: u32, exponent: i32, a: u32, b: u32) -> u32 {
    let product = if cfg!(narrow) {
        // 2^14 times the product of two numbers of 24 bits, in 16 bits each.
        let (a, b) = (Halves::of(a >> 7), Halves::of(b >> 7));
        let lower = a.lower.wrapping_mul(b.lower);
        let middle = a.lower.wrapping_mul(b.upper).wrapping_add(a.upper.wrapping_mul(b.lower));
        let upper = (a.upper.wrapping_mul(b.upper) << 16).wrapping_add(middle).wrapping_add(lower >> 16);
        upper | u32::from(lower << 16 != 0)
    } else {
        let product = u64::from(a << 1).wrapping_mul(u64::from(b));
        (product >> 31) as u32 | u32::from((product as u32) << 1 != 0)
    };
    if product < SIGN {
        return finish(sign, exponent, product);
    }
    finish(sign, exponent.wrapping_add(1), product >> 1 | product & 1)
}

/// 0, a subnormal number, an infinity or a NaN is among the factors.
#[inline(never)]
fn mul_special(a: u32, b: u32) -> u32 {
    let (larger, smaller) = if a << 1 < b << 1 { (b, a) } else { (a, b) };
    let sign = (a ^ b) & SIGN;
    if larger << 1 >= LIMIT {
        return if larger << 1 > LIMIT {
            larger | QUIET
        } else if smaller << 1 == 0 {
            NAN
        } else {
            sign | INFINITY
        };
    }
    if smaller << 1 == 0 {
        return sign;
    }
    let ((first, low), (second, high)) = (parts(a), parts(b));
    mul_mantissas(sign, low.wrapping_add(high).wrapping_sub(127), first, second)
}

/// 2^8/x − 2^8 for x = (128.5 + n)/256, rounded: a reciprocal with an error below 2^-7.5.
pub(crate) static RECIPROCALS: [u8; 128] = {
    let mut table = [0; 128];
    let mut n = 0;
    while n < 128 {
        let x = 257 + 2 * n as u32;
        table[n] = ((2 * 65_536 * 2 + x) / (2 * x) - 256) as u8;
        n += 1;
    }
    table
};

/// a / b.
#[inline(always)]
pub fn div(a: u32, b: u32) -> u32 {
    let (upper, lower) = (exponent(a), exponent(b));
    if upper.wrapping_sub(1) >= 254 || lower.wrapping_sub(1) >= 254 {
        return div_special(a, b);
    }
    let exponent = upper.wrapping_sub(lower).wrapping_add(127) as i32;
    div_mantissas((a ^ b) & SIGN, exponent, mantissa(a), mantissa(b))
}

/// The quotient of mantissas. `exponent` is that of a quotient from 1.
///
/// Two digits, of 13 and 12 bits, by the reciprocal r of the divisor. r is never too large, so neither is a
/// digit. The last digit is at most three units too small.
#[inline(always)]
fn div_mantissas(sign: u32, exponent: i32, a: u32, b: u32) -> u32 {
    let (a, b) = (a >> 7, b >> 7);
    let index = (b >> 16 & 0x7f) as usize;
    let seed = 256 + u32::from(RECIPROCALS[index]);
    // 2^32·(1 − seed·b), b in 24 bits: |error| < 2^25.
    let error = 0u32.wrapping_sub(seed.wrapping_mul(b)) as i32 >> 8;
    // r = seed + seed·(1 − seed·b) with 16 bits, relative error below 2^-14.
    let r = (seed << 8).wrapping_add_signed((seed as i32).wrapping_mul(error) >> 16);
    let digit = (a >> 9).wrapping_mul(r) >> 18;
    let rest = (a << 13).wrapping_sub(digit.wrapping_mul(b));
    let second = (rest >> 11).wrapping_mul(r) >> 17;
    let mut rest = (rest << 12).wrapping_sub(second.wrapping_mul(b));
    let mut quotient = (digit << 12).wrapping_add(second);
    while rest >= b {
        rest = rest.wrapping_sub(b);
        quotient = quotient.wrapping_add(1);
    }
    let lost = u32::from(rest != 0);
    if quotient >= 1 << 25 {
        finish(sign, exponent, quotient << 5 | lost)
    } else {
        finish(sign, exponent.wrapping_sub(1), quotient << 6 | lost)
    }
}

/// 0, a subnormal number, an infinity or a NaN is among the arguments.
#[inline(never)]
fn div_special(a: u32, b: u32) -> u32 {
    let sign = (a ^ b) & SIGN;
    if a << 1 > LIMIT {
        return a | QUIET;
    }
    if b << 1 > LIMIT {
        return b | QUIET;
    }
    match (a << 1, b << 1) {
        (0, 0) | (LIMIT, LIMIT) => NAN,
        (LIMIT, _) | (_, 0) => sign | INFINITY,
        (0, _) | (_, LIMIT) => sign,
        _ => {
            let ((upper, high), (lower, low)) = (parts(a), parts(b));
            div_mantissas(sign, high.wrapping_sub(low).wrapping_add(127), upper, lower)
        }
    }
}

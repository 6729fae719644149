//! Products wider than 64 bits, from products of 32 by 32 bits.
//!
//! A factor is split as a = a1·2^32 + a0 with unsigned a0; only a1 has the sign. Each of the four partial
//! products plus two 32-bit carries still fits into 64 bits: (2^32 − 1)² + 2·(2^32 − 1) = 2^64 − 1.

/// The low 32 bits of a number.
const fn low(a: u64) -> u64 {
    a & 0xffff_ffff
}

/// floor(a·b / 2^64), exact for all arguments.
///
/// The tick uses this function: 15 instructions inlined on thumbv7em, six of them multiplications.
#[inline(always)]
pub const fn mul_hi(a: i64, b: i64) -> i64 {
    let (a1, a0) = (a >> 32, low(a as u64) as i64);
    let (b1, b0) = (b >> 32, low(b as u64) as i64);
    // |a1·b0| ≤ 2^31·(2^32 − 1), so the added carry cannot overflow.
    let carry = (a0 as u64).wrapping_mul(b0 as u64) >> 32;
    let middle = a1.wrapping_mul(b0).wrapping_add(carry as i64);
    let other = a0.wrapping_mul(b1).wrapping_add(low(middle as u64) as i64);
    a1.wrapping_mul(b1).wrapping_add(middle >> 32).wrapping_add(other >> 32)
}

/// floor(a·b / 2^64) of unsigned factors, exact.
#[inline(always)]
pub const fn mul_hi_u(a: u64, b: u64) -> u64 {
    mul_wide(a, b).0
}

/// The 128-bit product as (high, low) words, exact. 15 instructions inlined on thumbv7em.
#[inline(always)]
pub const fn mul_wide(a: u64, b: u64) -> (u64, u64) {
    let (a1, a0) = (a >> 32, low(a));
    let (b1, b0) = (b >> 32, low(b));
    let first = a0.wrapping_mul(b0);
    let middle = a1.wrapping_mul(b0).wrapping_add(first >> 32);
    let other = a0.wrapping_mul(b1).wrapping_add(low(middle));
    let high = a1.wrapping_mul(b1).wrapping_add(middle >> 32).wrapping_add(other >> 32);
    (high, (other << 32) | low(first))
}

/// The square as (high, low) words, exact.
#[inline(always)]
pub const fn square_wide(a: u64) -> (u64, u64) {
    let (a1, a0) = (a >> 32, low(a));
    let middle = a1.wrapping_mul(a0);
    let (lo, carry) = a0.wrapping_mul(a0).overflowing_add(middle << 33);
    (a1.wrapping_mul(a1).wrapping_add(middle >> 31).wrapping_add(carry as u64), lo)
}

/// a·b / 2^shift, rounded to nearest, ties up, exact for all factors. If the result does not fit, the
/// function returns its low 64 bits.
///
/// `shift` is 0…127; higher bits of `shift` are ignored. At most 95 instructions on thumbv7em; 28 if inlined
/// with a shift that the compiler knows.
#[inline]
pub const fn mul_shift(a: i64, b: i64, shift: u32) -> i64 {
    let high = mul_hi(a, b);
    let low = a.wrapping_mul(b) as u64;
    // Rounding to nearest adds the last bit that is dropped.
    match shift & 127 {
        0 => low as i64,
        shift @ 1..=63 => {
            let floor = (high << (64 - shift)) as u64 | (low >> shift);
            floor.wrapping_add((low >> (shift - 1)) & 1) as i64
        }
        64 => high.wrapping_add((low >> 63) as i64),
        shift => {
            let shift = shift - 64;
            (high >> shift).wrapping_add((high >> (shift - 1)) & 1)
        }
    }
}

/// floor(a·n / 2^shift) from a 96-bit product. If the result does not fit, the function returns its low 64
/// bits.
///
/// `shift` is 0…32; a larger shift counts as 32. The tick uses this function: 4 to 8 instructions inlined on
/// thumbv7em with a shift that the compiler knows, three of them multiplications; otherwise 22.
#[inline(always)]
pub const fn mul_u32(a: i64, n: u32, shift: u32) -> i64 {
    let shift = if shift > 32 { 32 } else { shift };
    let first = low(a as u64).wrapping_mul(n as u64);
    // |a1·n| ≤ 2^31·(2^32 − 1): the carry fits.
    let high = (a >> 32).wrapping_mul(n as i64).wrapping_add((first >> 32) as i64);
    (high << (32 - shift)) | (low(first) >> shift) as i64
}

/// A 64-bit number without its last bit, for products that need not be exact in their last bit. The parts are
/// the upper word and the upper 31 bits of the lower word: `upper·2^32 + 2·lower`, at most 1 below the
/// number.
#[derive(Clone, Copy)]
pub struct Halves {
    upper: i32,
    lower: i32,
}

impl Halves {
    /// Splits a number.
    #[inline(always)]
    pub const fn of(x: i64) -> Self {
        Self { upper: (x >> 32) as i32, lower: (x as u32 >> 1) as i32 }
    }

    /// Minus the number. The upper word must not be −2^31.
    #[inline(always)]
    pub const fn negated(self) -> Self {
        Self { upper: -self.upper, lower: -self.lower }
    }

    /// The upper word.
    #[inline(always)]
    pub const fn upper(self) -> i64 {
        self.upper as i64
    }

    /// self·b / 2^64, with an error of at most 3. Eight instructions on a Cortex-M4.
    #[inline(always)]
    pub const fn times(self, b: Self) -> i64 {
        let cross = product(self.upper, b.lower).wrapping_add(product(self.lower, b.upper));
        (cross >> 31).wrapping_add(product(self.upper, b.upper))
    }

    /// (self·a + other·b) / 2^64, with an error of at most 4. Each product must be within ±2^124. Nine
    /// instructions on a Cortex-M4.
    #[inline(always)]
    pub const fn turn(self, a: Self, other: Self, b: Self) -> i64 {
        let cross = product(self.upper, a.lower)
            .wrapping_add(product(self.lower, a.upper))
            .wrapping_add(product(other.upper, b.lower))
            .wrapping_add(product(other.lower, b.upper));
        (cross >> 31).wrapping_add(product(self.upper, a.upper)).wrapping_add(product(other.upper, b.upper))
    }
}

/// a·b / 2^64 with an error of at most 3, for |a| and |b| up to 2^63: [`mul_hi`] without the product of the
/// lower words.
#[inline(always)]
pub const fn mul_near(a: i64, b: i64) -> i64 {
    Halves::of(a).times(Halves::of(b))
}

#[inline(always)]
const fn product(a: i32, b: i32) -> i64 {
    (a as i64).wrapping_mul(b as i64)
}

//! Programmed numbers before their unit is known. Decimals are kept exactly; results of expressions are f64.
use super::real;
use fixed::types::I32F32;

/// A programmed number before its unit is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Number {
    /// A literal: ±`mantissa` / 10^`scale`.
    Decimal { negative: bool, mantissa: u64, scale: u8 },
    /// The result of an expression.
    Real(f64),
}

/// Factor that converts a programmed number to the unit of a quantity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Factor {
    /// Numerator, at most 2^20.
    pub numerator: u32,
    /// Denominator, at least 1.
    pub denominator: u32,
}

impl Factor {
    /// The programmed number already has the unit.
    pub const ONE: Self = Self { numerator: 1, denominator: 1 };
    /// Inch to millimetre, exact.
    pub const INCH: Self = Self { numerator: 254, denominator: 10 };

    /// The factor `numerator` / `denominator`; the denominator must be at least 1.
    pub const fn new(numerator: u32, denominator: u32) -> Self {
        if numerator == denominator { Self::ONE } else { Self { numerator, denominator } }
    }
}

/// An unsigned literal of at most nine digits: `mantissa` / 10^`scale`.
#[derive(Clone, Copy)]
pub(super) struct Plain {
    pub mantissa: u32,
    /// At most 9.
    pub scale: u8,
}

impl Plain {
    /// The same value as a [`Number`].
    pub fn number(self) -> Number {
        Number::Decimal { negative: false, mantissa: self.mantissa.into(), scale: self.scale }
    }

    /// The bits of [`Number::fixed`].
    #[cfg_attr(feature = "fast", inline(always))]
    pub fn bits(self, factor: Factor) -> Option<i64> {
        let Self { mantissa, scale } = self;
        if factor == Factor::ONE {
            return Some(plain_bits(mantissa, scale));
        }
        quotient_bits(mantissa.into(), scale, factor)
    }

    /// The rounding remainder of these bits, see [`Number::rest`].
    pub fn rest(self, factor: Factor, bits: i64) -> i64 {
        let Self { mantissa, scale } = self;
        if factor != Factor::ONE || mantissa > i32::MAX as u32 {
            return decimal_rest(mantissa.into(), scale, factor, bits);
        }
        let power = POWERS.get(usize::from(scale)).map_or(1, |power| *power as i64);
        // Below 2^63; the remainder is below half a power of ten, 2^29.
        let left = (i64::from(mantissa) << 32).wrapping_sub(bits.wrapping_mul(power));
        (left << 32).checked_div(power).unwrap_or(0)
    }
}

const POWERS: [u64; 20] = {
    let mut table = [1; 20];
    let mut i = 1;
    while i < 20 {
        table[i] = table[i - 1] * 10;
        i += 1;
    }
    table
};

/// The factor 2^32 / 10^scale for a multiplication: `factor` / 2^(32 + `shift`), rounded up.
#[derive(Clone, Copy)]
struct Reciprocal {
    /// At least 2^63, so all bits are significant.
    factor: u64,
    /// Shift from 3 to 29.
    shift: u8,
}

/// Numbers for which [`RECIPROCALS`] rounds like a division: at most this number of decimals, and a mantissa
/// below the next constant.
const PLAIN_SCALE: u8 = 9;
const PLAIN_MANTISSA: u64 = 1 << 31;

/// The reciprocals for 1 to 9 decimals.
///
/// Mantissa / 10^scale · 2^32 + ½ is a multiple of 1 / (2 · 5^scale). The product with the reciprocal exceeds
/// the quotient by mantissa · excess / (10^scale · 2^(32 + shift)). If this excess is less than such a
/// multiple, both have the same whole part. The table compiles only if this holds for all plain mantissas.
const RECIPROCALS: [Reciprocal; PLAIN_SCALE as usize] = {
    let mut table = [Reciprocal { factor: 0, shift: 0 }; PLAIN_SCALE as usize];
    let mut scale = 1;
    while scale <= PLAIN_SCALE as usize {
        let power = POWERS[scale] as u128;
        let mut shift = 0;
        while (1_u128 << (64 + shift)) / power < 1 << 63 {
            shift += 1;
        }
        let factor = (1_u128 << (64 + shift)).div_ceil(power);
        let excess = factor * power - (1 << (64 + shift));
        assert!(0 < shift && shift < 32 && PLAIN_MANTISSA as u128 * excess * 2 < 1 << (scale + 32 + shift));
        table[scale - 1] = Reciprocal { factor: factor as u64, shift: shift as u8 };
        scale += 1;
    }
    table
};

impl Number {
    /// The number as f64 for expressions, rounded to nearest.
    pub fn real(self) -> f64 {
        match self {
            Self::Real(x) => x,
            Self::Decimal { negative, mantissa, scale } => {
                let x = real::from_decimal(mantissa, scale);
                if negative { -x } else { x }
            }
        }
    }

    /// The number times `factor` in fixed point, rounded to nearest, ties away from zero. Returns `None`
    /// beyond ±2^31.
    pub fn fixed(self, factor: Factor) -> Option<I32F32> {
        match self {
            Self::Real(x) => {
                let x = if factor == Factor::ONE { x } else { times(x, factor) };
                fixed_from_real(x)
            }
            Self::Decimal { negative, mantissa, scale } => {
                let bits = decimal_bits(mantissa, scale, factor)?;
                Some(I32F32::from_bits(if negative { bits.checked_neg()? } else { bits }))
            }
        }
    }

    /// The rounding remainder of `value` from [`Self::fixed`]: the number times `factor` minus `value`, LSB
    /// 2^-64, from −2^31 to 2^31.
    pub fn rest(self, factor: Factor, value: I32F32) -> i64 {
        let bits = value.to_bits();
        match self {
            Self::Real(x) => {
                let x = if factor == Factor::ONE { x } else { times(x, factor) };
                const LSB: f64 = (1_u64 << 32) as f64;
                // Both are below 2^53, so their difference is exact.
                ((x * LSB - bits as f64) * LSB) as i64
            }
            Self::Decimal { negative: false, mantissa, scale } => decimal_rest(mantissa, scale, factor, bits),
            Self::Decimal { mantissa, scale, .. } => {
                -decimal_rest(mantissa, scale, factor, bits.wrapping_neg())
            }
        }
    }

    /// The number as a whole number. Returns `None` if it has a fraction or is too large.
    pub fn whole(self) -> Option<i64> {
        if let Self::Decimal { negative, mantissa, scale: 0 } = self
            && mantissa < PLAIN_MANTISSA
        {
            return Some(if negative { -(mantissa as i64) } else { mantissa as i64 });
        }
        let x = self.real();
        let cut = real::trunc(x);
        (cut == x && real::abs(x) < 9e15).then_some(x as i64)
    }
}

/// `mantissa` / 10^`scale` · `factor` · 2^32, rounded to nearest, ties up.
fn decimal_bits(mantissa: u64, scale: u8, factor: Factor) -> Option<i64> {
    if factor == Factor::ONE && mantissa < PLAIN_MANTISSA && scale <= PLAIN_SCALE {
        return Some(plain_bits(mantissa as u32, scale));
    }
    quotient_bits(mantissa, scale, factor)
}

/// As [`decimal_bits`], without a division, for mantissas below [`PLAIN_MANTISSA`] with at most
/// [`PLAIN_SCALE`] decimals.
fn plain_bits(mantissa: u32, scale: u8) -> i64 {
    let mantissa = u64::from(mantissa);
    let Some(Reciprocal { factor, shift }) = RECIPROCALS.get(usize::from(scale).wrapping_sub(1)) else {
        return (mantissa << 32) as i64;
    };
    // mantissa · factor / 2^32 is below 2^63. The dropped bits are below the half that is added.
    let product = mantissa * (factor >> 32) + ((mantissa * (factor & 0xffff_ffff)) >> 32);
    // From 3 to 29.
    let shift = u32::from(*shift);
    let sum = product + u64::from(1_u32.wrapping_shl(shift - 1));
    let (high, low) = ((sum >> 32) as u32, sum as u32);
    let low = low.wrapping_shr(shift) | high.wrapping_shl(32 - shift);
    (u64::from(high.wrapping_shr(shift)) << 32 | u64::from(low)) as i64
}

/// As [`decimal_bits`], with a division, for all other numbers.
fn quotient_bits(mantissa: u64, scale: u8, factor: Factor) -> Option<i64> {
    let power = *POWERS.get(usize::from(scale))?;
    if factor == Factor::ONE && scale <= 9 {
        // In 64 bits, because the remainder is below 10^9 < 2^30.
        let whole = mantissa.checked_div(power)?;
        let rest = mantissa.wrapping_sub(whole.wrapping_mul(power));
        let fraction = ((rest << 33) + power).checked_div(power << 1)?;
        if whole >= 1 << 31 {
            return None;
        }
        return ((whole << 32) + fraction).try_into().ok();
    }
    // The dividend is below 2^(64+20+33), and the divisor is below 2^(64+32+1).
    let dividend = (u128::from(mantissa) * u128::from(factor.numerator)) << 33;
    let divisor = u128::from(power) * u128::from(factor.denominator);
    (dividend + divisor).checked_div(divisor << 1)?.try_into().ok()
}

/// `mantissa` / 10^`scale` · `factor` minus its rounded value `bits` / 2^32; LSB 2^-64.
fn decimal_rest(mantissa: u64, scale: u8, factor: Factor, bits: i64) -> i64 {
    let power = POWERS.get(usize::from(scale)).map_or(1, |power| *power);
    let divisor = i128::from(power) * i128::from(factor.denominator);
    // Below 2^(64+20+32); the remainder is below half a divisor, 2^(64+31).
    let number = (i128::from(mantissa) * i128::from(factor.numerator)) << 32;
    let left = number.wrapping_sub(i128::from(bits).wrapping_mul(divisor));
    (left << 32).checked_div(divisor).unwrap_or(0) as i64
}

fn times(x: f64, factor: Factor) -> f64 {
    x * f64::from(factor.numerator) / f64::from(factor.denominator)
}

/// `x` in fixed point, rounded to nearest, ties away from zero. Returns `None` beyond ±2^31 and for NaN.
fn fixed_from_real(x: f64) -> Option<I32F32> {
    let bits = x.to_bits();
    let exponent = ((bits >> 52) & 0x7ff) as i32;
    let mantissa = (bits & ((1 << 52) - 1)) | (u64::from(exponent != 0) << 52);
    // x = mantissa · 2^(exponent - 1075); the result is in units of 2^-32.
    let shift = exponent.max(1) - 1075 + 32;
    let magnitude = if shift >= 0 {
        if shift > 10 {
            return None;
        }
        mantissa << shift
    } else if shift < -54 {
        0
    } else {
        (mantissa + (1 << (-shift - 1))) >> -shift
    };
    let magnitude = i64::try_from(magnitude).ok()?;
    Some(I32F32::from_bits(if bits >> 63 == 1 { -magnitude } else { magnitude }))
}

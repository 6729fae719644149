//! Programmed numbers: decimals are kept exactly until the unit is known, results of expressions are f64.
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

/// Factor that leads from a programmed number to the unit of a quantity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Factor {
    /// At most 2^20.
    pub numerator: u32,
    /// From 1.
    pub denominator: u32,
}

impl Factor {
    /// The programmed number is already in the unit.
    pub const ONE: Self = Self { numerator: 1, denominator: 1 };
    /// Inch to millimetre, exactly.
    pub const INCH: Self = Self { numerator: 254, denominator: 10 };
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

impl Number {
    /// The number as a fraction, for expressions: nearest f64.
    pub fn real(self) -> f64 {
        match self {
            Self::Real(x) => x,
            Self::Decimal { negative, mantissa, scale } => {
                let x = real::from_decimal(mantissa, scale);
                if negative { -x } else { x }
            }
        }
    }

    /// The number times `factor` in fixed point, to nearest, ties away from zero; `None` beyond ±2^31.
    pub fn fixed(self, factor: Factor) -> Option<I32F32> {
        match self {
            Self::Real(x) => {
                let x = if factor == Factor::ONE {
                    x
                } else {
                    x * f64::from(factor.numerator) / f64::from(factor.denominator)
                };
                fixed_from_real(x)
            }
            Self::Decimal { negative, mantissa, scale } => {
                let bits = decimal_bits(mantissa, scale, factor)?;
                Some(I32F32::from_bits(if negative { bits.checked_neg()? } else { bits }))
            }
        }
    }

    /// The number as a whole number; `None` if it has a fraction or is too large.
    pub fn whole(self) -> Option<i64> {
        let x = self.real();
        let cut = real::trunc(x);
        (cut == x && real::abs(x) < 9e15).then_some(x as i64)
    }
}

/// `mantissa` / 10^`scale` · `factor` · 2^32, to nearest, ties up.
fn decimal_bits(mantissa: u64, scale: u8, factor: Factor) -> Option<i64> {
    let power = *POWERS.get(usize::from(scale))?;
    if factor == Factor::ONE && scale <= 9 {
        // The usual case in 64 bits: remainder below 10^9 < 2^30.
        let whole = mantissa.checked_div(power)?;
        let rest = mantissa.wrapping_sub(whole.wrapping_mul(power));
        let fraction = ((rest << 33) + power).checked_div(power << 1)?;
        if whole >= 1 << 31 {
            return None;
        }
        return ((whole << 32) + fraction).try_into().ok();
    }
    // Below 2^(64+20+33) and 2^(64+32+1).
    let dividend = (u128::from(mantissa) * u128::from(factor.numerator)) << 33;
    let divisor = u128::from(power) * u128::from(factor.denominator);
    (dividend + divisor).checked_div(divisor << 1)?.try_into().ok()
}

/// To nearest, ties away from zero; `None` beyond ±2^31 and for no number.
fn fixed_from_real(x: f64) -> Option<I32F32> {
    let bits = x.to_bits();
    let exponent = ((bits >> 52) & 0x7ff) as i32;
    let mantissa = (bits & ((1 << 52) - 1)) | (u64::from(exponent != 0) << 52);
    // x = mantissa · 2^(exponent - 1075); wanted are units of 2^-32.
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

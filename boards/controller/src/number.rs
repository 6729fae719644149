//! Decimals as integers: reads them from text, and writes them with a fixed number of decimals.
use core::fmt::{self, Display};

/// Reads a decimal at the start of `text`. Returns its value in 10^-`places`, without further decimals, and
/// the text after it. `None` without a number, or with more than 9 digits before the point.
pub fn decimal(text: &[u8], places: u32) -> Option<(i64, &[u8])> {
    let (is_negative, mut rest) = match text {
        [b'-', rest @ ..] => (true, rest),
        [b'+', rest @ ..] => (false, rest),
        _ => (false, text),
    };
    let (mut value, mut digits, mut left, mut behind_point) = (0_i64, 0, places, false);
    while let [first, tail @ ..] = rest {
        match first {
            b'0'..=b'9' => {
                digits += 1;
                if !behind_point || left > 0 {
                    value = value.checked_mul(10)?.checked_add(i64::from(first - b'0'))?;
                    left -= u32::from(behind_point);
                }
                if !behind_point && value > 999_999_999 {
                    return None;
                }
            }
            b'.' if !behind_point => behind_point = true,
            _ => break,
        }
        rest = tail;
    }
    if digits == 0 {
        return None;
    }
    let value = value.checked_mul(10_i64.checked_pow(left)?)?;
    Some((if is_negative { -value } else { value }, rest))
}

/// An integer in units of 10^-`places`, shown with `places` decimals.
#[derive(Clone, Copy)]
pub struct Fixed {
    /// Value in 10^-`places`.
    pub value: i64,
    /// Number of decimals, up to 9.
    pub places: u32,
}

impl Display for Fixed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let sign = if self.value < 0 { "-" } else { "" };
        let (size, unit) = (self.value.unsigned_abs(), 10_u64.saturating_pow(self.places.min(9)).max(1));
        let (whole, part) = (size.checked_div(unit).unwrap_or(0), size.checked_rem(unit).unwrap_or(0));
        if self.places == 0 {
            return write!(f, "{sign}{whole}");
        }
        write!(f, "{sign}{whole}.{part:0width$}", width = self.places as usize)
    }
}

/// `bits` (LSB 2^-32) times `factor` over `per`, to the nearest integer, ties away from zero.
pub fn rounded(bits: i64, factor: u32, per: u32) -> i64 {
    let (value, unit) = (i128::from(bits) * i128::from(factor), i128::from(per.max(1)) << 32);
    let half = if value < 0 { -(unit / 2) } else { unit / 2 };
    (value + half).checked_div(unit).unwrap_or(0) as i64
}

/// A position in mm (three decimals) or inch (four decimals).
pub fn position(bits: i64, inch: bool) -> Fixed {
    if inch {
        // 10^4 / 25.4
        Fixed { value: rounded(bits, 100_000, 254), places: 4 }
    } else {
        Fixed { value: rounded(bits, 1000, 1), places: 3 }
    }
}

/// A feed in mm/min (no decimals) or inch/min (one decimal).
pub fn feed(bits: i64, inch: bool) -> Fixed {
    if inch {
        Fixed { value: rounded(bits, 100, 254), places: 1 }
    } else {
        Fixed { value: rounded(bits, 1, 1), places: 0 }
    }
}

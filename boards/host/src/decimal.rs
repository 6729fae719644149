//! Decimals of fixed-point values: exact, or correctly rounded. Integers only.

/// Appends the exact decimal of `bits` / 2^`fraction`, without trailing zeros, but with at least one fraction
/// digit. `fraction` is at most 60.
pub fn push_exact(out: &mut String, bits: i128, fraction: u32) {
    if bits < 0 {
        out.push('-');
    }
    let magnitude = bits.unsigned_abs();
    push_integer(out, magnitude >> fraction);
    out.push('.');
    let mask = (1_u64 << fraction) - 1;
    let mut rest = magnitude as u64 & mask;
    loop {
        rest *= 10;
        out.push(char::from(b'0' + (rest >> fraction) as u8));
        rest &= mask;
        if rest == 0 {
            break;
        }
    }
}

/// Appends `value` / 10^`places` without trailing zeros, but with at least one fraction digit.
pub fn push_scaled(out: &mut String, value: i128, places: u32) {
    if value < 0 {
        out.push('-');
    }
    let unit = 10_u128.pow(places);
    let magnitude = value.unsigned_abs();
    push_integer(out, magnitude / unit);
    out.push('.');
    let mut rest = magnitude % unit;
    loop {
        rest *= 10;
        out.push(char::from(b'0' + (rest / unit) as u8));
        rest %= unit;
        if rest == 0 {
            break;
        }
    }
}

fn push_integer(out: &mut String, value: u128) {
    use std::fmt::Write;
    // Writing to a String cannot fail.
    let _ = write!(out, "{value}");
}

/// Decimal places of [`per_second`] and [`per_second_squared`].
pub const PLACES: u32 = 12;

/// Converts `bits` · 2^-58 per tick to units of 10^-12 per second, to nearest, ties away from zero.
pub fn per_second(bits: i64, cycle_us: u32) -> i128 {
    // 10^6 / cycle ticks per second, 10^12 for the places: 10^18 = 5^18 · 2^18, and 2^18 / 2^58 = 2^-40.
    divide_to_nearest(i128::from(bits) * 5_i128.pow(18), i128::from(cycle_us) << 40)
}

/// Converts `bits` · 2^-58 per tick² to units of 10^-12 per second², to nearest, ties away from zero.
pub fn per_second_squared(bits: i64, cycle_us: u32) -> i128 {
    let cycle = i128::from(cycle_us);
    divide_to_nearest(i128::from(bits) * 5_i128.pow(24), (cycle * cycle) << 34)
}

fn divide_to_nearest(value: i128, by: i128) -> i128 {
    let quotient = (value.abs() + by / 2) / by;
    if value < 0 { -quotient } else { quotient }
}

/// Reads `12.34` in units of 10^-places, exactly; other text, above all a sign, is refused.
pub fn parse(text: &[u8], places: usize) -> Option<u64> {
    let text = std::str::from_utf8(text).ok()?;
    let (whole, fraction) = text.split_once('.').unwrap_or((text, ""));
    let fraction = fraction.trim_end_matches('0');
    let digits = format!("{whole}{fraction:0<places$}");
    let plain = !whole.is_empty() && fraction.len() <= places && digits.bytes().all(|b| b.is_ascii_digit());
    if plain { digits.parse().ok() } else { None }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn exact(bits: i128, fraction: u32) -> String {
        let mut out = String::new();
        push_exact(&mut out, bits, fraction);
        out
    }

    #[test]
    fn exact_decimals_lose_nothing() {
        assert_eq!(exact(0, 32), "0.0");
        assert_eq!(exact(-1, 32), "-0.00000000023283064365386962890625");
        assert_eq!(exact(5 << 31, 32), "2.5");
        assert_eq!(exact((-100_000) << 32, 32), "-100000.0");
        assert_eq!(exact(1, 44), "0.00000000000005684341886080801486968994140625");
    }

    #[test]
    fn scaled_decimals_are_trimmed() {
        let scaled = |value, places| {
            let mut out = String::new();
            push_scaled(&mut out, value, places);
            out
        };
        assert_eq!(scaled(0, 6), "0.0");
        assert_eq!(scaled(1_004_000, 6), "1.004");
        assert_eq!(scaled(-1, 12), "-0.000000000001");
        assert_eq!(scaled(-7_000_000, 6), "-7.0");
    }

    #[test]
    fn rates_are_rounded_to_nearest() {
        // 0.25 mm/tick at 1 ms = 250 mm/s; the largest value does not overflow.
        assert_eq!(per_second(1 << 56, 1000), 250_000_000_000_000);
        assert_eq!(per_second_squared(1 << 56, 1000), 250_000 * 1_000_000_000_000);
        assert_eq!(per_second_squared(-(1 << 56), 100), -25_000_000 * 1_000_000_000_000);
        assert_eq!(per_second_squared(i64::MIN, 100), -3_200_000_000 * 1_000_000_000_000);
        // One LSB at 10 ms is 3.47e-16 mm/s: below half of the last place. 1441152 of them are half of it.
        assert_eq!(per_second(1, 10_000), 0);
        assert_eq!(per_second(1441, 10_000), 0);
        assert_eq!(per_second(1442, 10_000), 1);
        assert_eq!(per_second(-1442, 10_000), -1);
    }
}

//! Functions of f64 for expressions. They use only + − × ÷ and integer operations, so every machine gives the
//! same bits.
//!
//! Angles are in degrees and are reduced exactly, so `SIN[90]` = 1, `COS[90]` = 0, `SIN[30]` = 0.5.
//!
//! Errors against the exact value, tested by `host-tests/tests/language/nc_real.rs`:
//! - square root: correctly rounded;
//! - sine, cosine, arc tangent, exponential and logarithm: at most 2 ulp;
//! - tangent, cotangent, arc sine and arc cosine: at most 3 ulp.
//!
//! Powers with a whole exponent n up to 1024 are products; each multiplication rounds once. The relative
//! error is at most about |n|·2^-53.

#![expect(clippy::neg_cmp_op_on_partial_ord, reason = "`!(a <= b)` is meant to hold for what is no number")]

use crate::math::divide::div_wide;
use crate::math::root::sqrt_wide;
use crate::math::wide::mul_wide;

const LN2_HIGH: f64 = 0.693_147_180_369_123_8; // 33 bits, so that k·LN2_HIGH is exact for |k| < 2^20
const LN2_LOW: f64 = 1.908_214_929_270_587_7e-10;
const RADIAN_HIGH: f64 = 0.017_453_292_519_943_295; // π/180
const RADIAN_LOW: f64 = 2.948_652_270_870_168_7e-19;
const DEGREE_HIGH: f64 = 57.295_779_513_082_32; // 180/π
const DEGREE_LOW: f64 = -1.987_849_567_057_628_3e-15;

/// Magnitude.
pub(super) fn abs(x: f64) -> f64 {
    f64::from_bits(x.to_bits() & (u64::MAX >> 1))
}

/// The f64 nearest to `mantissa` / 10^`scale`, ties to even; `scale` is at most 19.
pub(super) fn from_decimal(mantissa: u64, scale: u8) -> f64 {
    const POWERS: [f64; 20] = [
        1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17,
        1e18, 1e19,
    ];
    let power = POWERS.get(usize::from(scale)).copied().unwrap_or(1e19);
    if mantissa <= 1 << 53 {
        // Both are exact, so there is only one rounding.
        return mantissa as f64 / power;
    }
    // 127 bits divided by at most 64 bits: the quotient has at least 63 bits. If there is a remainder, the
    // quotient is made odd, and then rounds correctly.
    let shift = 63 + mantissa.leading_zeros();
    let dividend = u128::from(mantissa) << shift;
    let divisor = power as u64;
    let high = ((dividend >> 64) as u64).checked_div(divisor).unwrap_or(0);
    let rest = ((dividend >> 64) as u64).wrapping_sub(high.wrapping_mul(divisor));
    let quotient = u128::from(high) << 64 | u128::from(div_wide(rest, dividend as u64, divisor));
    let sticky = u128::from(quotient.wrapping_mul(u128::from(divisor)) != dividend);
    (quotient | sticky) as f64 * power_of_two(-(shift as i32))
}

/// `x` rounded towards zero.
pub(super) fn trunc(x: f64) -> f64 {
    let exponent = ((x.to_bits() >> 52) & 0x7ff) as i32 - 1023;
    if exponent < 0 {
        return f64::from_bits(x.to_bits() & (1 << 63));
    }
    if exponent >= 52 {
        return x;
    }
    f64::from_bits(x.to_bits() & !((1 << (52 - exponent)) - 1))
}

/// `x` rounded towards minus infinity.
pub(super) fn floor(x: f64) -> f64 {
    let cut = trunc(x);
    if cut > x { cut - 1.0 } else { cut }
}

/// `x` rounded towards plus infinity.
pub(super) fn ceil(x: f64) -> f64 {
    -floor(-x)
}

/// `x` rounded to nearest, ties away from zero.
pub(super) fn round(x: f64) -> f64 {
    let cut = trunc(x);
    if abs(x - cut) < 0.5 {
        cut
    } else if x < 0.0 {
        cut - 1.0
    } else {
        cut + 1.0
    }
}

/// Remainder of `x` / `y` with the sign of `x`, exact. NaN for |y| below 10^-290, because of the range of
/// exponents.
pub(super) fn remainder(x: f64, y: f64) -> f64 {
    let (mut rest, divisor) = (abs(x), abs(y));
    if !rest.is_finite() || !(divisor >= 1e-290) {
        return f64::NAN;
    }
    if rest >= divisor {
        // Both are normal: x = m·2^e, and x mod y = (m·2^gap mod n)·2^e of y.
        let parts = |x: f64| ((x.to_bits() & ((1 << 52) - 1)) | (1 << 52), (x.to_bits() >> 52) as u32);
        let ((m, from), (n, to)) = (parts(rest), parts(divisor));
        let times = |a: u64, b: u64| {
            let (high, low) = mul_wide(a, b);
            low.wrapping_sub(div_wide(high, low, n).wrapping_mul(n))
        };
        let gap = from.saturating_sub(to);
        let mut power = 1;
        for bit in (0..11).rev() {
            power = times(power, power);
            if gap >> bit & 1 == 1 {
                power = times(power, 2);
            }
        }
        rest = times(times(m, 1), power) as f64 * power_of_two(to as i32 - 1075);
    }
    if x < 0.0 { -rest } else { rest }
}

/// 2^`k` for -1022 ≤ `k` ≤ 1023.
fn power_of_two(k: i32) -> f64 {
    f64::from_bits(((k.clamp(-1022, 1023) + 1023) as u64) << 52)
}

/// a·b as an unevaluated sum, exact (Dekker; |a|, |b| below 2^900).
fn product(a: f64, b: f64) -> (f64, f64) {
    const SPLIT: f64 = 134_217_729.0; // 2^27 + 1
    let halves = |x: f64| {
        let t = SPLIT * x;
        let high = t - (t - x);
        (high, x - high)
    };
    let p = a * b;
    let ((ah, al), (bh, bl)) = (halves(a), halves(b));
    (p, ((ah * bh - p) + ah * bl + al * bh) + al * bl)
}

/// a·(high + low) as a sum of two numbers.
fn scaled(a: f64, high: f64, low: f64) -> (f64, f64) {
    let (p, rest) = product(a, high);
    let rest = rest + a * low;
    let sum = p + rest;
    (sum, rest - (sum - p))
}

/// Σ c·z^k, the last coefficient first.
fn horner(z: f64, coefficients: &[f64]) -> f64 {
    coefficients.iter().fold(0.0, |sum, c| sum * z + c)
}

/// Sine of x + y radians, |x| ≤ π/4: Taylor series, next term below 2^-62.
fn sin_radians(x: f64, y: f64) -> f64 {
    const C: [f64; 8] = [
        1.0 / 355_687_428_096_000.0,
        -1.0 / 1_307_674_368_000.0,
        1.0 / 6_227_020_800.0,
        -1.0 / 39_916_800.0,
        1.0 / 362_880.0,
        -1.0 / 5040.0,
        1.0 / 120.0,
        -1.0 / 6.0,
    ];
    let z = x * x;
    x + (x * z * horner(z, &C) + y * (1.0 - 0.5 * z))
}

/// Cosine of x + y radians, |x| ≤ π/4.
fn cos_radians(x: f64, y: f64) -> f64 {
    const C: [f64; 8] = [
        -1.0 / 6_402_373_705_728_000.0,
        1.0 / 20_922_789_888_000.0,
        -1.0 / 87_178_291_200.0,
        1.0 / 479_001_600.0,
        -1.0 / 3_628_800.0,
        1.0 / 40_320.0,
        -1.0 / 720.0,
        1.0 / 24.0,
    ];
    let z = x * x;
    let half = 0.5 * z;
    let head = 1.0 - half;
    head + (((1.0 - head) - half) + (z * z * horner(z, &C) - x * y))
}

/// Quarter turn (0…3) and rest in ±45°, exact; `None` above 10^12 degrees.
fn reduce(degrees: f64) -> Option<(u8, f64)> {
    if !(abs(degrees) <= 1e12) {
        return None;
    }
    let quarter = round(degrees / 90.0);
    let rest = degrees - quarter * 90.0;
    Some(((quarter as i64 & 3) as u8, rest))
}

/// Sine and cosine of ±45°.
fn sin_cos_eighth(degrees: f64) -> (f64, f64) {
    let (x, y) = scaled(degrees, RADIAN_HIGH, RADIAN_LOW);
    // The only rational values besides 0 and ±1.
    let sine = if abs(degrees) == 30.0 { degrees / 60.0 } else { sin_radians(x, y) };
    (sine, cos_radians(x, y))
}

/// Sine and cosine of an angle in degrees; `None` above 10^12 degrees.
pub(super) fn sin_cos(degrees: f64) -> Option<(f64, f64)> {
    let (quarter, rest) = reduce(degrees)?;
    let (s, c) = sin_cos_eighth(rest);
    Some(match quarter {
        0 => (s, c),
        1 => (c, 0.0 - s),
        2 => (0.0 - s, 0.0 - c),
        _ => (0.0 - c, s),
    })
}

/// Tangent; `None` where it is infinite.
pub(super) fn tan(degrees: f64) -> Option<f64> {
    slope_of(degrees, 0)
}

/// Cotangent; `None` where it is infinite.
pub(super) fn cot(degrees: f64) -> Option<f64> {
    slope_of(degrees, 1).map(|x| 0.0 - x)
}

/// Tangent of an angle plus `quarters` right angles.
fn slope_of(degrees: f64, quarters: u8) -> Option<f64> {
    let (quarter, rest) = reduce(degrees)?;
    let upright = (quarter + quarters) & 1 == 1;
    if abs(rest) == 45.0 {
        return Some(if (rest > 0.0) == upright { -1.0 } else { 1.0 });
    }
    let (s, c) = sin_cos_eighth(rest);
    if upright { (s != 0.0).then(|| -c / s) } else { Some(s / c) }
}

/// Arc tangent in degrees.
pub(super) fn atan(x: f64) -> f64 {
    // atan(k/8) in degrees, k = 0…8, high and low part.
    const TABLE: [(f64, f64); 9] = [
        (0.0, 0.0),
        (7.125016348901798, -1.2948639595014213e-16),
        (14.036243467926479, -1.178545638282857e-16),
        (20.556045219583464, 7.735753643362621e-16),
        (26.56505117707799, -6.673432494950659e-16),
        (32.005383208083494, 1.8761647814886433e-15),
        (36.86989764584402, 1.3346864989901319e-15),
        (41.18592516570965, -2.0942594695766676e-15),
        (45.0, 0.0),
    ];
    // 1/1, 1/3, … of the series; |t| ≤ 1/16: next term below 2^-64.
    const C: [f64; 7] = [-1.0 / 15.0, 1.0 / 13.0, -1.0 / 11.0, 1.0 / 9.0, -1.0 / 7.0, 1.0 / 5.0, -1.0 / 3.0];
    let a = abs(x);
    let (numerator, denominator, above) = if a > 1.0 { (1.0, a, true) } else { (a, 1.0, false) };
    let k = round(numerator / denominator * 8.0);
    let c = k / 8.0;
    let (tilt_high, tilt_low) = TABLE.get(k as usize).copied().unwrap_or((45.0, 0.0));
    // (n/d - c)/(1 + c·n/d) = (n - c·d)/(d + c·n); c has 4 bits, both kept with their rounding error.
    let (cd, cd_low) = product(c, denominator);
    let top = numerator - cd;
    let top_low = -cd_low;
    let (cn, cn_low) = product(c, numerator);
    let bottom = denominator + cn;
    let bottom_low =
        (if denominator > cn { cn - (bottom - denominator) } else { denominator - (bottom - cn) }) + cn_low;
    let t = (top + top_low) / bottom;
    let (tb, tb_low) = product(t, bottom);
    let t_low = (((top - tb) - tb_low) + top_low - t * bottom_low) / bottom;
    let z = t * t;
    let (angle, angle_low) = scaled(t, DEGREE_HIGH, DEGREE_LOW);
    let small = angle_low + (t_low + t * z * horner(z, &C)) * DEGREE_HIGH;
    let result = if above {
        let base = 90.0 - tilt_high;
        let base_low = (90.0 - base) - tilt_high - tilt_low;
        sum3(base, -angle, base_low - small)
    } else {
        sum3(tilt_high, angle, tilt_low + small)
    };
    if x < 0.0 { -result } else { result }
}

/// a + b + c with one rounding error; |a| ≥ |b| or a = 0.
fn sum3(a: f64, b: f64, c: f64) -> f64 {
    let s = a + b;
    s + ((b - (s - a)) + c)
}

/// Angle of the point (x, y), -180 < result ≤ 180; 0 for the origin.
pub(super) fn atan2(y: f64, x: f64) -> f64 {
    if x > 0.0 {
        atan(y / x)
    } else if x < 0.0 {
        if y < 0.0 { atan(y / x) - 180.0 } else { atan(y / x) + 180.0 }
    } else if y > 0.0 {
        90.0
    } else if y < 0.0 {
        -90.0
    } else {
        0.0
    }
}

/// Arc sine in degrees; `None` outside ±1.
pub(super) fn asin(x: f64) -> Option<f64> {
    if !(abs(x) <= 1.0) {
        return None;
    }
    if abs(x) == 0.5 {
        return Some(x * 60.0);
    }
    let adjacent = sqrt((1.0 - x) * (1.0 + x));
    Some(if adjacent == 0.0 { x * 90.0 } else { atan(x / adjacent) })
}

/// Arc cosine in degrees; `None` outside ±1.
pub(super) fn acos(x: f64) -> Option<f64> {
    if !(abs(x) <= 1.0) {
        return None;
    }
    if abs(x) == 0.5 {
        return Some(90.0 - x * 60.0);
    }
    Some(if x == -1.0 { 180.0 } else { 2.0 * atan(sqrt((1.0 - x) / (1.0 + x))) })
}

/// Square root, correctly rounded (ties cannot occur); 0 for values that are not positive.
#[inline(never)]
pub(super) fn sqrt(x: f64) -> f64 {
    if !(x > 0.0) {
        return 0.0;
    }
    if x == f64::INFINITY {
        return x;
    }
    let (x, scale) = if x < 1e-290 { (x * power_of_two(200), power_of_two(-100)) } else { (x, 1.0) };
    let bits = x.to_bits();
    let exponent = (bits >> 52) as i32 - 1075;
    let mantissa = u128::from((bits & ((1 << 52) - 1)) | (1 << 52));
    // x = m·2^e with e even and m of 107 or 108 bits: a root of 54 bits.
    let shift = if exponent & 1 == 0 { 54 } else { 55 };
    let m = mantissa << shift;
    let root = sqrt_wide((m >> 64) as u64, m as u64);
    let sticky = u64::from(u128::from(root) * u128::from(root) != m);
    let half = (exponent - shift) / 2;
    // 54 bits and a sticky bit: rounded to 53 bits, to nearest.
    let rounded = (root >> 1) + (root & 1 & (sticky | (root >> 1) & 1));
    rounded as f64 * power_of_two(half + 1) * scale
}

/// e^x; infinite above 709.78, 0 below -745.
pub(super) fn exp(x: f64) -> f64 {
    if !(x <= 709.782_712_893_384) {
        return f64::INFINITY;
    }
    if x < -745.2 {
        return 0.0;
    }
    let k = round(x / (LN2_HIGH + LN2_LOW));
    let high = x - k * LN2_HIGH;
    let low = k * LN2_LOW;
    let r = high - low;
    let r_low = (high - r) - low;
    const C: [f64; 12] = [
        1.0 / 6_227_020_800.0,
        1.0 / 479_001_600.0,
        1.0 / 39_916_800.0,
        1.0 / 3_628_800.0,
        1.0 / 362_880.0,
        1.0 / 40_320.0,
        1.0 / 5040.0,
        1.0 / 720.0,
        1.0 / 120.0,
        1.0 / 24.0,
        1.0 / 6.0,
        0.5,
    ];
    let y = 1.0 + (r + (r_low + r * r * horner(r, &C)));
    let k = k as i32;
    let half = k / 2;
    y * power_of_two(half) * power_of_two(k - half)
}

/// Natural logarithm; `None` for values that are not positive.
pub(super) fn ln(x: f64) -> Option<f64> {
    if !(x > 0.0) || x == f64::INFINITY {
        return None;
    }
    let (x, below) = if x < 1e-290 { (x * power_of_two(200), 200) } else { (x, 0) };
    let mut k = (x.to_bits() >> 52) as i32 - 1023;
    let mut m = f64::from_bits((x.to_bits() & ((1 << 52) - 1)) | (1023 << 52));
    if m > core::f64::consts::SQRT_2 {
        m *= 0.5;
        k += 1;
    }
    let k = f64::from(k - below);
    // ln(1+f) = f - f²/2 + s·(f²/2 + R), s = f/(2+f), R = 2·s²·(1/3 + s²/5 + …); |s| ≤ 0.172.
    const C: [f64; 10] = [
        2.0 / 21.0,
        2.0 / 19.0,
        2.0 / 17.0,
        2.0 / 15.0,
        2.0 / 13.0,
        2.0 / 11.0,
        2.0 / 9.0,
        2.0 / 7.0,
        2.0 / 5.0,
        2.0 / 3.0,
    ];
    let f = m - 1.0;
    let s = f / (2.0 + f);
    let z = s * s;
    let half = 0.5 * f * f;
    let tail = s * (half + z * horner(z, &C));
    Some(k * LN2_HIGH - ((half - (tail + k * LN2_LOW)) - f))
}

/// x^y; `None` if it is not a real number.
pub(super) fn power(x: f64, y: f64) -> Option<f64> {
    if trunc(y) == y && abs(y) <= 1024.0 {
        let mut result = 1.0;
        let mut base = x;
        let mut count = abs(y) as u32;
        while count > 0 {
            if count & 1 == 1 {
                result *= base;
            }
            base *= base;
            count >>= 1;
        }
        return if y >= 0.0 { Some(result) } else { (result != 0.0).then(|| 1.0 / result) };
    }
    if x == 0.0 {
        return (y > 0.0).then_some(0.0);
    }
    Some(exp(y * ln(x)?))
}

//! Sine and cosine for the tick, without a division and without a loop.
//!
//! The angle is a multiple of 1/1024 revolution plus a rest r, with |r| at most ρ = π/1024. S and C, the sine
//! and cosine of the multiple, come from a table. Then
//!
//! sin = S + C·sin r − S·(1 − cos r),  cos = C − S·sin r − C·(1 − cos r).
//!
//! r is so small that sin r = r − a·r³ (a is near 1/6) and 1 − cos r = r²/2 − r⁴/24 suffice. Each product
//! keeps only the bits that matter. sin r and 1 − cos r have 64 fraction bits in two words. Their upper word
//! times the table's upper word (30 fraction bits) adds directly to the result with its 62 fraction bits.
use super::angle::sin_cos_fine;

/// Table points per revolution.
const POINTS: usize = 1024;

/// A quarter of a revolution.
const QUARTER: usize = POINTS / 4;

/// Points in the table. With the feature `fast`: a quarter more than a revolution, 10 kB. Without it: a quarter and
/// its end, 2 kB.
const TABLE: usize = if cfg!(feature = "fast") { POINTS + QUARTER } else { QUARTER + 1 };

/// Sine at multiples of 1/1024 revolution, with 62 fraction bits. The cosine is the sine a quarter of a
/// revolution further.
static SINE: [i64; TABLE] = table();

const fn table() -> [i64; TABLE] {
    let mut sine = [0; TABLE];
    let mut i = 0;
    while i < TABLE {
        sine[i] = sin_cos_fine((i as u64) << 54).0;
        i += 1;
    }
    sine
}

/// Sine and cosine at the multiple of 1/1024 revolution at or below an angle. `turns`: the angle, 2^-32
/// revolutions.
#[cfg(feature = "fast")]
#[inline(always)]
fn at_point(turns: u32) -> (i64, i64) {
    let point = (turns >> 22) as usize;
    (SINE[point], SINE[point + QUARTER])
}

/// The same bits from a table of a quarter revolution: mirrored values are mirrored exactly, and sine and
/// cosine of an eighth of a revolution are equal.
#[cfg(not(feature = "fast"))]
#[inline(always)]
fn at_point(turns: u32) -> (i64, i64) {
    let up = (turns >> 22) as usize & (QUARTER - 1);
    let down = QUARTER - up;
    // In every second quarter the sine falls: sine and cosine change places.
    let (sine, cosine) = if turns & 1 << 30 == 0 { (up, down) } else { (down, up) };
    // The sine is negative in the second half of a revolution, the cosine a quarter earlier. A mask of sign bits
    // negates the number.
    let mirrored = |x: i64, turns: u32| {
        let sign = i64::from(turns as i32 >> 31);
        (x ^ sign).wrapping_sub(sign)
    };
    (mirrored(SINE[sine], turns), mirrored(SINE[cosine], turns.wrapping_add(1 << 30)))
}

/// 2ρ·2^64: converts a rest in units of ρ·2^-63 to radians with 64 fraction bits.
const RADIANS: i64 = 0x0192_1fb5_4442_d184;

/// a·ρ³·2^58 with a = 1/6 − 0.87·ρ²/120. With this a, the error |sin r − r + a·r³| ≤ 2^-51.5 is least.
const CUBIC: u64 = 0x52ae_f161;

/// ρ²/2·2^48 and ρ⁴/12·2^48.
const SQUARE: u64 = 0x4ef4_f327;
const FOURTH: u64 = 2078;

/// Upper word of a product, rounded down.
#[inline(always)]
const fn high(a: i32, b: i32) -> i32 {
    ((a as i64 * b as i64) >> 32) as i32
}

/// A number as upper and lower word, both signed: v = upper·2^32 + lower.
#[inline(always)]
const fn split(v: i64) -> (i32, i32) {
    (((v >> 32) as i32).wrapping_add((v as u32 >> 31) as i32), v as i32)
}

/// Sine and cosine of an angle of `turns`·2^-64 revolutions, with 62 fraction bits. The absolute error is at
/// most 2^-46.8; 8·10^6 random angles gave at most 2^-46.93.
///
/// The results are exact at the quarter turns. Mirrored angles give mirrored results within 160 units of
/// 2^-62 (2^-54.7). The exception is an exact midpoint between two table points, where both sides differ by
/// up to 2^-47.6.
///
/// The function takes 82 instructions on thumbv7em, 18 of them multiplications; about 73 if inlined. Without
/// the feature `fast`, 20 more.
///
/// The error has these parts. In 1 − cos r: rounding of the rest 2^-48.7, and its square 2^-48.7. The 49
/// fraction bits of the result, with S and C in 30 fraction bits: 2^-48.7. The series of the sine: 2^-51.5.
/// The table: 2^-62.
#[inline]
pub fn sin_cos(turns: u64) -> (i64, i64) {
    // Nearest table point, and the rest in units of ρ·2^-63.
    let shifted = turns.wrapping_add(1 << 53);
    let rest = ((shifted << 10) ^ (1 << 63)) as i64;

    // (rest / 2^63)² with 31 fraction bits. Ties of the upper word round toward zero, so mirrored angles
    // agree. The word may wrap to −2^31, whose square is the same.
    let nearest = (rest.wrapping_add(0x7fff_ffff - (rest >> 63)) >> 32) as i32;
    let square = (nearest as i64 * nearest as i64) as u64 >> 31;
    let upper = (rest >> 32) as i32;

    // sin r: linear part by the full product, cubic part with 56 fraction bits.
    let (kh, kl) = split(RADIANS);
    let linear =
        (upper as i64 * kh as i64) + ((rest as u32 as u64 * kh as u64) >> 32) as i64 + high(upper, kl) as i64;
    let cubic = high(upper, ((square * CUBIC) >> 32) as i32);
    let sin_r = linear - ((cubic as i64) << 8);

    // cos r − 1, 64 fraction bits.
    let curve = SQUARE - ((square * FOURTH) >> 32);
    let cos_r = -(((square * curve) >> 15) as i64);

    let (wh, wl) = split(sin_r);
    let (vh, vl) = split(cos_r);
    let (s, c) = at_point((shifted >> 32) as u32);
    let (sh, sl) = split(s);
    let (ch, cl) = split(c);
    let sin_low = high(ch, wl) + high(cl, wh) + high(sh, vl);
    let cos_low = high(ch, vl) - high(sh, wl) - high(sl, wh);
    let sin = s + ch as i64 * wh as i64 + sh as i64 * vh as i64 + sin_low as i64;
    let cos = c - sh as i64 * wh as i64 + ch as i64 * vh as i64 + cos_low as i64;
    (sin, cos)
}

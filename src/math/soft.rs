//! Conversions of `float` for cores without floating-point instructions: the same bits by integers.
//!
//! Such a core takes 40 to 100 instructions for each operation of `f32`. These functions replace products and
//! sums by shifts where the result is the same.

/// Whether the core has no instructions for `f32`.
pub const IS_SOFT: bool = cfg!(any(
    all(target_arch = "arm", not(target_abi = "eabihf")),
    all(target_arch = "riscv32", not(target_feature = "f")),
));

/// [`size_f32`](super::float::size_f32).
pub fn size_f32(x: u64) -> f32 {
    let lower = x as u32 as f32;
    match (x >> 32) as u32 {
        0 => lower,
        upper => double(upper as f32, 32) + lower,
    }
}

/// The integer part of `x`·2^`scale` for x ≥ 0, exact; 0 for x < 0. From 2^63 + 2^40 on 2^63 − 1.
pub fn integer(x: f32, scale: u32) -> i64 {
    let bits = x.to_bits();
    // Place of the first bit.
    let place = (bits << 1 >> 24).wrapping_add(scale).wrapping_sub(127) as i32;
    if (bits as i32) < 0 || place < 0 {
        return 0;
    }
    let mantissa = bits << 8 | 0x8000_0000;
    match place as u32 {
        place @ 0..32 => i64::from(mantissa >> (31 - place)),
        place @ 32..63 => {
            let upper = mantissa >> (63 - place);
            i64::from(upper) << 32 | i64::from(mantissa << (place - 31))
        }
        _ if x.is_nan() => 0,
        // The two halves of the other method become too large one after the other.
        63 if mantissa == 0x8000_0000 => i64::MAX ^ 0xffff_ffff,
        _ => i64::MAX,
    }
}

/// x·2^`places` for a normal x above 0 with a normal result.
fn double(x: f32, places: u32) -> f32 {
    f32::from_bits(x.to_bits().wrapping_add(places << 23))
}

/// x / 2 for a normal x above 0 with a normal result.
pub fn half(x: f32) -> f32 {
    f32::from_bits(x.to_bits().wrapping_sub(1 << 23))
}

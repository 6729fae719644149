//! Comparisons of 32-bit and 64-bit numbers, of which every one with a NaN is false.
use crate::single::{LIMIT, SIGN};

/// Whether x is a NaN.
#[inline(always)]
fn is_nan(x: u32) -> bool {
    x << 1 > LIMIT
}

/// An integer that is in the order of the numbers. Both zeros give 0.
#[inline(always)]
fn order(x: u32) -> i32 {
    if x as i32 >= 0 { x as i32 } else { SIGN.wrapping_sub(x) as i32 }
}

/// a < b.
#[inline(always)]
pub fn less(a: u32, b: u32) -> bool {
    !is_nan(a) && !is_nan(b) && order(a) < order(b)
}

/// a ≤ b.
#[inline(always)]
pub fn less_or_equal(a: u32, b: u32) -> bool {
    !is_nan(a) && !is_nan(b) && order(a) <= order(b)
}

/// a = b.
#[inline(always)]
pub fn equal(a: u32, b: u32) -> bool {
    if a == b { !is_nan(a) } else { (a | b) << 1 == 0 }
}

/// a or b is a NaN.
#[inline(always)]
pub fn unordered(a: u32, b: u32) -> bool {
    is_nan(a) || is_nan(b)
}

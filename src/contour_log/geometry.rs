//! Computes what an entry of the log shows of a curve: radius, angle, and the change of direction from the
//! curve before (`knee`). The planner does this, in integers and with the IEEE operations + − × ÷.
use super::entry::{BlockType, Entry};
use crate::math::angle::atan2_turns;
use crate::math::root::sqrt_wide;
use crate::math::wide::square_wide;
use crate::path::{End, Shape};

const TAU: f64 = core::f64::consts::TAU;

/// √(Σ x²), exact, rounded down to the LSB.
fn norm<const AXES: usize>(x: &[i64; AXES]) -> u64 {
    let mut sum = (0u64, 0u64);
    for x in x {
        let (upper, lower) = square_wide(x.unsigned_abs());
        let (low, carry) = sum.1.overflowing_add(lower);
        sum = (sum.0.wrapping_add(upper).wrapping_add(carry.into()), low);
    }
    sqrt_wide(sum.0, sum.1)
}

/// Angle between the directions `a` and `b`, rad, 0..π; 0 if a direction is zero.
pub fn knee<const AXES: usize>(a: &[i64; AXES], b: &[i64; AXES]) -> f64 {
    let unit = |x: &[i64; AXES]| {
        let length = norm(x);
        // Scaled to a length of 2^50, so that sums of squares are accurate enough for the angle.
        let scale = if length == 0 { 0.0 } else { (1u64 << 50) as f64 / length as f64 };
        x.map(|x| (x as f64 * scale) as i64)
    };
    let (a, b) = (unit(a), unit(b));
    let (mut apart, mut along) = (a, a);
    for ((apart, along), b) in apart.iter_mut().zip(&mut along).zip(&b) {
        (*apart, *along) = (apart.wrapping_sub(*b), along.wrapping_add(*b));
    }
    let [apart, along] = [apart, along].map(|x| norm(&x) as i64);
    // Half the angle is below a quarter of a revolution.
    atan2_turns(apart, along) as f64 * (2.0 * TAU / 18_446_744_073_709_551_616.0)
}

/// Kind, radius, angle and knee of a curve. `exit`: direction at the end of the curve before.
pub fn describe<const AXES: usize>(
    shape: &Shape<AXES>,
    entry: &End<AXES>,
    exit: Option<&[i64; AXES]>,
) -> Entry {
    let knee = exit.map_or(0.0, |exit| knee(exit, &entry.tangent));
    let mut made = Entry { block_type: BlockType::Polynomial, knee, ..Entry::default() };
    if shape.is_line() {
        made.block_type = BlockType::Line;
    } else if let Some((radius, turn)) = shape.turn() {
        made.block_type = BlockType::Arc;
        made.radius_mm = radius as f64 / (1u64 << 44) as f64;
        made.angle = turn as f64 * (TAU / (1u64 << 59) as f64);
    }
    made
}

//! Speed profiles: path speed over time, for a path length, two end speeds and limits. This module does not
//! depend on geometry.
//!
//! | slope | acceleration over time |
//! |---|---|
//! | STEP | constant; one value at low speed, another value at high speed; jerk is not limited |
//! | TRAPEZ, HSC | linear ramps; TRAPEZ has four ramp times, HSC one; zero at both ends of a span |
//! | SIN2 | as TRAPEZ, but the ramps are squared sines |
//!
//! | file | what is in it |
//! |---|---|
//! | [`ramp_shape`] | the shapes of a ramp |
//! | [`ramp`] | the formulas of a change of speed |
//! | [`limits`] | limits along the path |
//! | [`kept`] | limits in few bytes, for blocks of the look-ahead |
//! | [`profile`] | the speed profile of a span: its times and lengths |
//! | [`brake`] | braking from the current motion to a lower speed |
//! | [`emit`] | the pieces of a profile, for the tick |
pub mod ramp_shape;

pub mod ramp;

pub mod limits;

pub mod kept;

pub mod profile;

pub mod brake;

pub mod emit;

use crate::math::wide::mul_shift;

/// Speed times time: 2^-58 · 2^-36 to 2^-44.
#[cfg_attr(feature = "fast", inline(always))]
fn area(v: i64, t: u64) -> i64 {
    mul_shift(v, t as i64, 50)
}

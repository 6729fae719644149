//! Speed over time for a length; knows nothing of geometry.
//!
//! A slope is the law of a change of speed. STEP: two accelerations. The others are jerk-limited, with four
//! ramp times and acceleration zero at both ends: TRAPEZ and HSC with linear ramps, SIN2 with ramps of a sine
//! squared.
//!
//! | file | what is in it |
//! |---|---|
//! | [`ramp_shape`] | the shapes of a ramp |
//! | [`ramp`] | the formulas of a change of speed |
//! | [`limits`] | what is permitted along the path |
//! | [`kept`] | limits in few bytes, as blocks of the look-ahead have them |
//! | [`profile`] | the law of a span: its times and lengths |
//! | [`brake`] | the way from a motion at hand to a lower speed |
//! | [`emit`] | the pieces of a law, for the tick |
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

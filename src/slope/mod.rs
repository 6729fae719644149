//! Speed over time for a length; knows nothing of geometry.
//!
//! A slope is the law of a change of speed. STEP: two accelerations. The others are jerk-limited, with four
//! ramp times and acceleration zero at both ends: TRAPEZ and HSC with linear ramps, SIN2 with ramps of a sine
//! squared.
//!
//! [`ramp_shape`] holds the shapes of a ramp, [`ramp`] the formulas of a change, [`profile`] the time law of
//! one block, [`brake`] the way out of a motion at hand, [`emit`] cuts it into what the tick needs.
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

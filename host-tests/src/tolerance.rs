//! Every tolerance of the tests, with its derivation.
//!
//! | name | value | derivation |
//! |---|---|---|
//! | [`PATH`] | 2 nm | set point 0.12 nm · √3; direction Q1.31: 2^-31 of 1 m is 0.5 nm; circle table and radius, 1.4 nm at R 1 m |
//! | [`REFERENCE`] | 10 nm | [`PATH`], and along the path what the time law's rounding leaves: 2^-44 mm per phase, at most 10^5 blocks |
//! | [`PLAN`] | 10^-6 | limits enter rounded to 24 bits or better (6·10^-8), speeds depend on at most two of them to the power 1 |
//! | [`SPEED_MARGIN`] | 2^-20 | the library plans with this part less speed and acceleration: roundings of `f32` |
//! | [`JERK_MARGIN`] | 2^-13 | the library plans with this part less jerk, so that rounding to set points stays below the limit |
//! | [`MIRROR`] | 1 LSB | a set point is rounded once, ties upward; mirrored, ties fall the other way |

/// Distance of a set point from the programmed contour, mm.
pub const PATH: f64 = 2e-6;

/// Distance of a set point from that of the reference with the same plan, mm.
pub const REFERENCE: f64 = 10e-6;

/// Speeds at transitions and durations against the reference planner, relative.
pub const PLAN: f64 = 1e-6;

/// Part of speeds and accelerations that the library leaves unused.
pub const SPEED_MARGIN: f64 = 1.0 / 1_048_576.0;

/// Part of the jerk that the library leaves unused.
pub const JERK_MARGIN: f64 = 1.0 / 8192.0;

/// Set points of a mirrored program, LSB.
pub const MIRROR: i64 = 1;

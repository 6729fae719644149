//! Every tolerance of the tests, with its derivation.
//!
//! | name | value | derivation |
//! |---|---|---|
//! | [`PATH`] | 0.01 nm | set points, end points and centres are rounded to 2^-32 mm: 0.12 pm per axis and each; the centre of an arc by radius moves by more where the chord is nearly the diameter; measured: 1.2 pm. Required: 2 nm |
//! | [`MERGED`] | 4900 · 2^-32 mm = 1.14 nm | on each axis, of a straight line that stands for several blocks, from the points left out; in space less than 2 nm, as required |
//! | [`MERGED_ROUNDING`] | 2^-28 mm | start, end and a point left out are rounded to 2^-33 mm on each axis. The distance of the point from the line has four of them, and four of √3 along the path, which count tangent times: less than 2^-30 times 1 + tangent. Two tangents of the library, rounded to 2^-40, add 2^-29 over 1 m |
//! | [`REFERENCE`] | 10 nm | required; the motion itself is off by less than [`PATH`] |
//! | [`RAMP`] | 2^-23 | ramp times are `f32` in the plan and f64 in the reference: two roundings; a point on a ramp is off by this part of the ramp's length |
//! | [`PLAN`] | 10^-6 | required; speeds follow from about ten roundings of 2^-24, and from searches that end 2^-21 below the root |
//! | [`TIE`] | 10^-6 | two times that decide how a corner is passed: sums of about ten roundings of 2^-24 each |
//! | [`SPEED_MARGIN`] | 2^-19 | the library plans with this part less speed and acceleration: ten roundings of 2^-24, sixteen that a plan may use up, six of its check |
//! | [`JERK_MARGIN`] | 2^-13 | the library plans with this part less jerk: the same, and third differences of rounded path distances |
//! | [`DISTANCE`] | 2^-37 mm | what a path distance of a tick is off by (`src/slope/emit.rs`), a sixteenth of the rounding of a set point. Along the path the library leaves 4 of it per tick² to that, where it is more than [`SPEED_MARGIN`]. Of jerk it leaves nothing, and an axis that moves n times as far as the path may show 8·n of it per tick³: a ramp of hundreds of ticks has less jerk than that, so leaving it would leave none |
//! | [`CUT`] | 1/2 LSB | in contour mode a block ends where a curve begins, between two steps of a position; the curve begins on the nearest one. Position jumps by that much there, on each axis, beside the rounding of set points |
//! | [`MIRROR`] | 1 LSB | a set point is rounded once, ties upward; mirrored, ties fall the other way |

/// Distance of a set point from the programmed contour, mm.
pub const PATH: f64 = 1e-8;

/// Distance of a dropped point from the merged line, mm, on each axis, and in space.
pub const MERGED: f64 = 4900.0 / 4_294_967_296.0;
pub const MERGED_PATH: f64 = 2e-6;

/// Effect of rounding of positions on this distance, mm, times 1 + tangent of the axis. If rounding decides,
/// both results are right.
pub const MERGED_ROUNDING: f64 = 1.0 / 268_435_456.0;

/// Distance of a set point from that of the reference with the same plan, mm.
pub const REFERENCE: f64 = 10e-6;

/// Uncertainty of a plan's ramps, relative.
pub const RAMP: f64 = 1.0 / 8_388_608.0;

/// Speeds at transitions and durations against the reference planner, relative.
pub const PLAN: f64 = 1e-6;

/// Times of two ways through a corner that differ by less are a tie, relative: single precision may decide it
/// either way.
pub const TIE: f64 = 1e-6;

/// Part of speeds and accelerations that the library leaves unused.
pub const SPEED_MARGIN: f64 = 1.0 / 524_288.0;

/// Part of the jerk that the library leaves unused.
pub const JERK_MARGIN: f64 = 1.0 / 8192.0;

/// Error of a path distance in a tick, mm: its coefficients have 2^-58 mm, and a piece lasts at most 128
/// ticks with jerk (`src/slope/emit.rs`). The error is a sixteenth of the rounding of a set point.
pub const DISTANCE: f64 = 1.0 / 137_438_953_472.0;

/// Highest displacement of an axis by rounding of the start of a curve, mm. With such a start in each tick a
/// difference of order n has at most 2^(n-1) times this value: the sum of every second weight.
pub const CUT: f64 = 0.5 / 4_294_967_296.0;

/// Set points of a mirrored program, LSB.
pub const MIRROR: i64 = 1;

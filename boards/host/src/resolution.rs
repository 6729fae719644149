//! Effect of the path's resolution on the differences of an axis, in addition to the rounding of set points.
//!
//! The allowances are the same as those of the library's tests (`host-tests/src/tolerance.rs`), in LSB of a
//! position, 2^-32 mm or degrees:
//!
//! | source | size | in a difference of order n | applies |
//! |---|---|---|---|
//! | path distance of a tick | 1/32, times axis travel per path | 2^n times | everywhere |
//! | start of a curve | 1/2 | 2^(n-1) times: every second weight | if corners are rounded |
//!
//! A path distance is exact to 2^-37 mm (`src/slope/emit.rs`). A block with a rounded end ends between two
//! steps of a position, and the next curve begins at the nearest step (`src/smooth/contour/mod.rs`).

/// Error of the path distance of a tick.
const DISTANCE: f64 = 1.0 / 32.0;
/// Error of the start of a curve.
const CUT: f64 = 0.5;

/// The error of one axis.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Resolution {
    /// Highest travel of the axis per travel of the path.
    pub steepest: f64,
    /// Whether corners are rounded.
    pub rounds: bool,
}

impl Resolution {
    /// Error of first, second and third differences, LSB.
    pub fn differences(self) -> [f64; 3] {
        let distance = 2.0 * DISTANCE * self.steepest.max(1.0);
        let start = if self.rounds { CUT } else { 0.0 };
        [1.0, 2.0, 4.0].map(|times| times * (distance + start))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_grows_with_the_order_and_with_what_the_axis_travels() {
        let of = |steepest, rounds| Resolution { steepest, rounds }.differences();
        assert_eq!(of(0.5, false), [0.0625, 0.125, 0.25]);
        assert_eq!(of(16.0, false), [1.0, 2.0, 4.0]);
        assert_eq!(of(1.0, true), [0.5625, 1.125, 2.25]);
    }
}

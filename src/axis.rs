//! The trait that a board implements to output set points.
//!
//! ```
//! use glidepath::{Axes, Position};
//!
//! /// Counts of a drive with 1,000 counts per mm.
//! struct Counts([i32; 3]);
//!
//! impl Axes<3> for Counts {
//!     fn write(&mut self, set_points: &[Position; 3]) {
//!         self.0 = set_points.map(|mm| (mm * 1000).round().to_num());
//!     }
//! }
//!
//! let mut drives = Counts([0; 3]);
//! drives.write(&[Position::from_num(1.5), Position::from_num(-2), Position::ZERO]);
//! assert_eq!(drives.0, [1500, -2000, 0]);
//! ```
use crate::quantity::Position;

/// Output of set points: step pulses, counts of a drive, or a fieldbus frame.
pub trait Axes<const AXES: usize> {
    /// Outputs one set point per axis, in mm or degrees. The board calls `write` at the start of its timer
    /// interrupt, so the moment of output does not vary. `write` must take bounded time.
    fn write(&mut self, set_points: &[Position; AXES]);
}

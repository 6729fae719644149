//! What a board implements: where set points go.
use crate::quantity::Position;

/// Output of set points. A board turns them into step pulses, counts or a fieldbus frame.
pub trait Axes<const AXES: usize> {
    /// Takes over one set point per axis. Called from the timer interrupt, first thing, so that it does not
    /// jitter.
    fn write(&mut self, set_points: &[Position; AXES]);
}

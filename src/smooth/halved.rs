//! Halves a line between lines that Surface or a spline smooths, and a corner that contour mode rounds. Each
//! side gets one half.
use super::{Parting, ProgrammedBlock, middle};
use crate::path::{Measure, Straight, straight_line};
use crate::quantity::Position;

/// A waiting block, and the kind of commands between it and the block before.
pub type Waiting<const AXES: usize> = (ProgrammedBlock<AXES>, Parting);

/// The rest of a line.
pub struct Rest<const AXES: usize> {
    line: Straight<AXES>,
    to: [Position; AXES],
    stop: bool,
}

impl<const AXES: usize> Rest<AXES> {
    /// Makes the other half of a block that ends in the middle of its line.
    pub fn follow(&self, block: &mut ProgrammedBlock<AXES>) {
        (block.from, block.to) = (block.to, self.to);
        self.line.assign_to(&mut block.element);
        block.data.stop = self.stop;
    }
}

/// Ends the line in its middle, and returns the rest. Returns `None` if the line is too short to be halved.
pub fn halve<const AXES: usize>(block: &mut ProgrammedBlock<AXES>, measure: &Measure) -> Option<Rest<AXES>> {
    let middle = middle(&block.from, &block.to);
    let line = straight_line(&middle, &block.to, measure).ok()??;
    let rest = Rest { line, to: block.to, stop: block.data.stop };
    straight_line(&block.from, &middle, measure).ok()??.assign_to(&mut block.element);
    (block.to, block.data.stop) = (middle, false);
    Some(rest)
}

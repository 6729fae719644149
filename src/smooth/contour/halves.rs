//! A curve of two polynomials with equal path length. They meet at the point of the curve that is nearest to
//! the corner.
use crate::path::poly::{Draft, Knot};
use crate::path::{Element, Passage};
use crate::quantity::Position;

use super::timed::larger;

/// A curve that is emitted in two halves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Halves<const AXES: usize> {
    pub from: Knot<AXES>,
    pub middle: Knot<AXES>,
    pub to: Knot<AXES>,
    /// Path length of a half, mm.
    pub length: f32,
    /// Largest ratio of the speed along the curve to the path speed.
    pub fastest: f32,
    /// Magnitudes of the third derivative of each axis, if acceleration may be non-zero in the curve.
    pub third: Option<[f32; AXES]>,
    /// Number of emitted halves.
    pub done: u8,
}

impl<const AXES: usize> Halves<AXES> {
    /// Not made yet.
    pub const NONE: Self = {
        let knot = Knot::BLANK;
        Self { from: knot, middle: knot, to: knot, length: 0.0, fastest: 1.0, third: None, done: 0 }
    };

    /// Whether the next element belongs to the block before the corner.
    pub fn is_before(&self) -> bool {
        self.done == 0
    }

    /// Whether both halves are emitted.
    pub fn is_done(&self) -> bool {
        self.done >= 2
    }

    /// End of the last emitted element, mm or degrees.
    pub fn stands(&self) -> &[Position; AXES] {
        match self.done {
            0 => &self.from.position,
            1 => &self.middle.position,
            _ => &self.to.position,
        }
    }

    /// Ends the curve early: no further element is emitted. Returns the end of the curve.
    pub fn finish(&mut self) -> &[Position; AXES] {
        self.done = 2;
        &self.to.position
    }

    /// Begins the next element; the returned draft computes the polynomials of its axes. Then call
    /// [`Self::settle`].
    pub fn next_element(&mut self, element: &mut Element<AXES>) -> Option<Draft<AXES>> {
        let ends = match self.done {
            0 => [&self.from, &self.middle],
            1 => [&self.middle, &self.to],
            _ => return None,
        };
        let made = Draft::begin(element, ends, self.length, self.fastest)?;
        self.done += 1;
        Some(if self.third.is_some() { made.cubic() } else { made })
    }

    /// Sets the derivatives of an element in which acceleration may be non-zero. These values are more
    /// accurate than values from the points of a short piece.
    pub fn settle(&self, element: &mut Element<AXES>) {
        if let (Some(bounds), Some(third)) = (&mut element.bounds, self.third) {
            bounds.passage = Passage::Through;
            bounds.second = larger(&element.entry.curvature, &element.exit.curvature);
            bounds.third = third;
        }
    }
}

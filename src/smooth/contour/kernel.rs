//! A shallow corner between two lines as two cubics that meet where the curve is nearest to the corner.
//!
//! ```text
//! Q(s) = P(s) + d·(c − |s|)³ / (6·c²)     −c ≤ s ≤ c,   d = t2 − t1
//! ```
//!
//! P is the contour over its own length s, from the corner on. The direction goes from t1 to t2 over 2·c, and
//! the second derivative rises and falls evenly: up to d/c in the middle, zero at both ends. So the third
//! derivative is ±d/c², the least that any curve of that length can have. The deviation is |d|·c/6 in the
//! middle and less elsewhere. As |Q'| is at most 1, the length of the contour counts as path, and no speed is
//! above the feed; in the middle it is below by 1 − cos θ/2.
use crate::path::poly::{Draft, Knot};
use crate::path::{Element, Passage};
use crate::quantity::Position;

use super::timed::larger;
use super::{LSB_40, ONE_32};

/// A curve that is handed out in two halves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Kernel<const AXES: usize> {
    from: Knot<AXES>,
    middle: Knot<AXES>,
    to: Knot<AXES>,
    /// Length of a half, mm.
    length: f32,
    /// Magnitudes of the third derivative.
    third: [f32; AXES],
    /// Halves handed out.
    done: u8,
}

impl<const AXES: usize> Kernel<AXES> {
    /// About the corner `origin` between two knots, both at the distance `c` from it.
    pub fn new(origin: &[Position; AXES], c: f32, from: &Knot<AXES>, to: &Knot<AXES>) -> Self {
        let mut middle = Knot { position: *origin, end: from.end };
        let mut third = [0.0; AXES];
        let per = 1.0 / c;
        let end = middle.end.tangent.iter_mut().zip(&mut middle.end.curvature);
        let axes = middle.position.iter_mut().zip(end).zip(&to.end.tangent).zip(&mut third);
        for (((x, (tangent, curvature)), t2), third) in axes {
            let change = t2 - *tangent;
            let d = change as f32 * LSB_40;
            let off = (d * c * (1.0 / 6.0) * ONE_32) as i64;
            *x = Position::from_bits(x.to_bits().saturating_add(off));
            *tangent += change / 2;
            *curvature = d * per;
            *third = (if d < 0.0 { -d } else { d }) * per * per * ROUNDED;
        }
        Self { from: *from, middle, to: *to, length: c, third, done: 0 }
    }

    /// Whether the next element belongs to the block before the corner.
    pub fn is_before(&self) -> bool {
        self.done == 0
    }

    /// Where the last element ended.
    pub fn stands(&self) -> &[Position; AXES] {
        match self.done {
            0 => &self.from.position,
            1 => &self.middle.position,
            _ => &self.to.position,
        }
    }

    /// No further element is handed out; where the curve ends.
    pub fn finish(&mut self) -> &[Position; AXES] {
        self.done = 2;
        &self.to.position
    }

    /// The next element, with its axes to be made; then: [`Self::settle`].
    pub fn next_element(&mut self, element: &mut Element<AXES>) -> Option<Draft<AXES>> {
        let (from, to) = match self.done {
            0 => (&self.from, &self.middle),
            1 => (&self.middle, &self.to),
            _ => return None,
        };
        let made = Draft::begin(element, [from, to], self.length, 1.0 + 1e-6)?;
        self.done += 1;
        Some(made)
    }

    /// The derivatives are known better than from the points of a short piece.
    pub fn settle(&self, element: &mut Element<AXES>) {
        if let Some(bounds) = &mut element.bounds {
            bounds.passage = Passage::Through;
            bounds.second = larger(&element.entry.curvature, &element.exit.curvature);
            bounds.third = self.third;
        }
    }
}

/// For rounding.
const ROUNDED: f32 = 1.0 + 1.0 / 1_048_576.0;

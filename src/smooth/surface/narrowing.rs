//! Kernels become narrower where the path leaves the tolerance, or where no element is possible.
//!
//! The points of the control polygon depend on the kernels. So all points first move back by their shift, then the
//! kernels become narrower, then the points move out by the new shift. A shift takes a walk over the vertices nearby,
//! and the window may have many vertices, so each call of the smoother handles a few vertices.
use super::parameters::Parameters;
use super::window::{NARROWED_BULGE, Window};

/// Vertices that one call handles.
const AT_ONCE: usize = 3;

/// The next step of the work.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Step {
    /// Points move back.
    Back,
    /// Points move out.
    Out,
    /// Lengths and turns of the control polygon are computed again.
    Settle,
}

/// Kernels that become narrower, between two calls.
#[derive(Clone, Copy, Debug)]
pub struct Narrowing {
    /// First and last vertex.
    from: u8,
    to: u8,
    /// The next vertex, and what happens with it.
    next: u8,
    step: Step,
    /// Factor for the width of the kernels.
    part: f32,
}

// A window has fewer vertices than a `u8` counts.
const _: () = assert!(super::window::VERTICES < 250);

impl<const AXES: usize> Window<AXES> {
    /// Makes the kernels of these vertices narrower by the factor `part`. The work is done by the next calls of
    /// [`Self::go_on_narrowing`].
    pub fn narrow(&mut self, from: usize, to: usize, part: f32) {
        let to = to.min(self.moved.saturating_sub(1));
        if from <= to {
            let [from, to] = [from, to].map(|k| k as u8);
            self.narrowing = Some(Narrowing { from, to, next: from, step: Step::Back, part });
        }
    }

    /// Handles a few vertices of [`Self::narrow`]. Returns `false` if no kernels become narrower.
    pub fn go_on_narrowing(&mut self, parameters: &Parameters) -> bool {
        let Some(mut narrowing) = self.narrowing.take() else { return false };
        let Narrowing { from, to, next, step, part } = narrowing;
        // The chords after the last vertex have moved with their starts.
        let last = if step == Step::Settle {
            (usize::from(to) + 2).min(self.moved.saturating_sub(1))
        } else {
            usize::from(to)
        };
        let end = (usize::from(next) + AT_ONCE).min(last + 1);
        for k in usize::from(next)..end {
            match step {
                Step::Back => self.shift(k, 1.0, parameters),
                Step::Out => self.shift(k, -1.0, parameters),
                Step::Settle => self.settle(k),
            }
        }
        (narrowing.next, narrowing.step) = match step {
            _ if end <= last => (end as u8, step),
            Step::Back => {
                for k in usize::from(from)..=usize::from(to) {
                    if let Some(vertex) = self.vertices.get_mut(k) {
                        vertex.width *= part;
                        vertex.offset = vertex.offset.map(|x| x * NARROWED_BULGE);
                    }
                }
                (from, Step::Out)
            }
            Step::Out => (from, Step::Settle),
            Step::Settle => return true,
        };
        self.narrowing = Some(narrowing);
        true
    }

    /// Moves the point of vertex `k` by its shift, times `sign`.
    fn shift(&mut self, k: usize, sign: f32, parameters: &Parameters) {
        let raw = self.back(k, parameters);
        if let Some(vertex) = self.vertices.get_mut(k) {
            let gain = vertex.gain * sign;
            for (offset, raw) in vertex.offset.iter_mut().zip(&raw) {
                *offset += gain * raw;
            }
        }
    }
}

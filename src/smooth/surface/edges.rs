//! Edges: corners between two lines that contour mode rounds. Kernels take no turn of more than 102 degrees:
//! the path would be much shorter than its polygon. And where a line on both sides is long beside what the
//! tolerance leaves of a kernel, the curve of a corner is faster: speed changes inside it.
use super::chords::Chord;
use super::parameters::{Parameters, Tolerance};
use super::window::{Programmed, Space};
use crate::math::float::{max, min};
use crate::path::Measure;
use crate::smooth::{Data, Form, ProgrammedBlock};

/// Step of direction (twice the sine of half the angle) of the sharpest turn that kernels take: 102 degrees.
pub const SHARPEST: f32 = 1.554_29;

/// Beyond it a line goes straight back: 179.6 degrees.
const BACK: f32 = 1.999_99;

/// A turn of less belongs to a smooth contour: 18 degrees. Between lines so long that a smooth curve through their ends
/// would be many tolerances beside them it does not, down to 6 degrees.
const EDGE: f32 = 0.313;
const LEAST: f32 = 0.1;

/// A line is long from so many widths of the kernel on that its turn has alone; beside turns of less than 35
/// degrees later, and of less than 18 degrees latest.
const LONG: f32 = 4.0;
const SLIGHT: f32 = 0.6;
const LONG_BESIDE_SLIGHT: f32 = 16.0;
const LONG_BESIDE_SMOOTH: f32 = 18.0;

/// What makes a corner an edge.
#[derive(Clone, Copy)]
pub struct Edges<'a> {
    pub parameters: &'a Parameters,
    pub space: Space,
}

impl<'a> Edges<'a> {
    pub fn new(parameters: &'a Parameters, measure: &Measure) -> Self {
        Self { parameters, space: Space::new(measure) }
    }

    /// Whether a block makes an edge with a chord before it.
    pub fn parts<const AXES: usize>(&self, before: &Chord<AXES>, block: &ProgrammedBlock<AXES>) -> bool {
        let Some(next) = self.chord(block).filter(|_| !before.arc) else { return false };
        let change = before.turn(&next);
        let turn = self.space.length(&change);
        if turn <= LEAST || turn > BACK || self.parameters.is_beyond(turn) {
            return false;
        }
        if turn > SHARPEST {
            return true;
        }
        let rapid = before.programmed.feed.is_none() && next.programmed.feed.is_none();
        let Tolerance { path, track } = self.tolerance(rapid);
        // A kernel alone deviates by a sixth of its width times the turn.
        let mut width = path / turn;
        if track > 0.0 {
            for (_, x) in change.iter().enumerate().filter(|(k, _)| !self.space.is_main(*k)) {
                width = min(width, track / max(max(*x, -*x), f32::MIN_POSITIVE));
            }
        }
        let long = match turn {
            ..=EDGE => LONG_BESIDE_SMOOTH,
            ..SLIGHT => LONG_BESIDE_SLIGHT,
            _ => LONG,
        };
        min(before.length, next.length) > long * 6.0 * width
    }

    /// Whether two blocks make an edge.
    pub fn between<const AXES: usize>(
        &self,
        before: &ProgrammedBlock<AXES>,
        block: &ProgrammedBlock<AXES>,
    ) -> bool {
        !before.data.stop && self.chord(before).is_some_and(|before| self.parts(&before, block))
    }

    /// What a curve in a corner may deviate; `rapid`: G00 on both sides.
    pub fn tolerance(&self, rapid: bool) -> Tolerance {
        self.parameters.left(self.parameters.tolerance(rapid), false)
    }

    /// A line that is not passed as it is.
    fn chord<const AXES: usize>(&self, block: &ProgrammedBlock<AXES>) -> Option<Chord<AXES>> {
        let Data { feed, n, number, .. } = block.data;
        if block.form != Form::Line || feed.is_none() && self.parameters.leaves_rapid() {
            return None;
        }
        Chord::new(&block.from, &block.to, Programmed { feed, n, number }, self.space)
    }
}

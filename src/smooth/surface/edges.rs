//! Edges: corners between two lines that contour mode rounds. Kernels take no turn of more than 102 degrees:
//! the path would be much shorter than its polygon. And where a line on both sides is long beside what the
//! tolerance leaves of a kernel, or a kernel is slow, the curve of a corner is faster: speed changes inside it.
use super::chords::Chord;
use super::parameters::{Parameters, Tolerance, Used};
use super::window::{Programmed, Space};
use crate::dynamics::Dynamics;
use crate::math::float::{max, min};
use crate::nc::SlopeType;
use crate::path::Measure;
use crate::smooth::contour::Edge;
use crate::smooth::{Data, Form, ProgrammedBlock};

/// Step of direction (twice the sine of half the angle) of the sharpest turn that kernels take: 102 degrees.
pub const SHARPEST: f32 = 1.554_29;

/// Beyond it a line goes straight back: 179.6 degrees.
const BACK: f32 = 1.999_99;

/// A turn of less belongs to a smooth contour, one of more is sharp: 18 and 74 degrees.
const EDGE: f32 = 0.313;
const SHARP: f32 = 1.2;

/// Widths of the kernel that its turn has alone, from which on a line can be an edge: in a smooth contour or a sharp turn,
/// and between both. Kernels of shorter lines are one smooth curve.
const APART: f32 = 2.5;
const ONE_CURVE: f32 = 0.34;
/// The same with STEP for every turn: only far shorter lines gain by kernels. Acceleration has no ramps there, so a curve
/// alone costs little.
const STEPPED_APART: f32 = 0.05;
/// Sharp turns of shorter lines belong to a row that turns back: there a kernel is compared with a standstill alone.
const ALONE: f32 = 4.0;

/// Conditions under which a corner is an edge.
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
    pub fn parts<const AXES: usize>(
        &self,
        before: &Chord<AXES>,
        block: &ProgrammedBlock<AXES>,
        dynamics: &Dynamics<AXES>,
    ) -> bool {
        let Some(next) = self.chord(block).filter(|_| !before.arc && !before.stop) else { return false };
        let change = before.turn(&next);
        let turn = self.space.length(&change);
        if turn <= 0.0 || turn > BACK || self.parameters.is_beyond(turn) {
            return false;
        }
        if turn > SHARPEST {
            return true;
        }
        let rapid = before.programmed.feed.is_none() && next.programmed.feed.is_none();
        let Tolerance { path, track } = self.tolerance(rapid, self.parameters.used(&before.stray));
        // A kernel alone deviates by a sixth of its width times the turn.
        let mut width = path / turn;
        for (_, x) in change.iter().enumerate().filter(|(k, _)| !self.space.is_main(*k)) {
            width = min(width, track / max(max(*x, -*x), f32::MIN_POSITIVE));
        }
        let (length, most) = (min(before.length, next.length), 6.0 * width);
        let stepped = dynamics.slope() == SlopeType::Step;
        let apart = match turn {
            _ if stepped => STEPPED_APART,
            smooth if smooth < EDGE => APART,
            _ => ONE_CURVE,
        };
        if stepped || length <= apart * most {
            return length > apart * most;
        }
        let half = min(most, min(self.parameters.widest(), length));
        let (second, mut third) = (change.map(|x| x / half), change.map(|x| x / (half * half)));
        let rate = turn / half;
        for (x, (t1, t2)) in third.iter_mut().zip(before.direction.iter().zip(&next.direction)) {
            *x = max(*x, -*x) + 0.5 * max(t1 + t2, -(t1 + t2)) * rate * rate;
        }
        let v = dynamics.passing([&second, &third], rapid, self.parameters.check_jerk());
        let (limits, ..) = dynamics.element(&block.element, block.data.feed);
        let edge = Edge {
            dynamics,
            rapid,
            tangents: [before.direction, next.direction],
            limits: [&limits, &limits],
            room: [0.5 * before.length, 0.5 * next.length],
        };
        if turn > SHARP && length < ALONE * most {
            edge.stands((v, half))
        } else {
            edge.is_quicker(width, (v, half))
        }
    }

    /// Whether a block is an arc that stays exact, so that contour mode rounds its transitions.
    pub fn keeps<const AXES: usize>(&self, block: &ProgrammedBlock<AXES>) -> bool {
        let rapid = block.data.feed.is_none() && self.parameters.leaves_rapid();
        let arc = block.form != Form::Line && self.parameters.rounds_arcs() && !rapid;
        arc && self.parameters.chord_of(&block.element).is_none()
    }

    /// Whether two blocks make an edge, where the first one is for contour mode. Beside arcs they always do, as far
    /// as both are smoothed.
    pub fn between<const AXES: usize>(
        &self,
        before: &ProgrammedBlock<AXES>,
        block: &ProgrammedBlock<AXES>,
        dynamics: &Dynamics<AXES>,
    ) -> bool {
        if before.data.stop {
            return false;
        }
        if before.form != Form::Line {
            // A small one, too: it has come in behind one that stays.
            return block.form != Form::Line || self.chord(block).is_some();
        }
        if self.keeps(block) {
            return self.chord(before).is_some();
        }
        self.chord(before).is_some_and(|before| self.parts(&before, block, dynamics))
    }

    /// Tolerance of a curve in a corner. `rapid`: G00 on both sides; `used`: by merged lines before it.
    pub fn tolerance(&self, rapid: bool, used: Used) -> Tolerance {
        self.parameters.left(self.parameters.tolerance(rapid), false, used)
    }

    /// A line that is not passed as it is.
    fn chord<const AXES: usize>(&self, block: &ProgrammedBlock<AXES>) -> Option<Chord<AXES>> {
        let Data { feed, n, number, .. } = block.data;
        if block.form != Form::Line || feed.is_none() && self.parameters.leaves_rapid() {
            return None;
        }
        let chord = Chord::new(&block.from, &block.to, Programmed { feed, n, number }, self.space);
        chord.filter(|chord| !self.parameters.is_longer(chord.length))
    }
}

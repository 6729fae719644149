//! Decides which corners between two lines are edges. Contour mode rounds an edge, and Surface all other
//! corners.
//!
//! A corner of more than 102 degrees is an edge. There the path of a smoothing curve would be much shorter
//! than its polygon.
//!
//! A smaller corner is an edge under two conditions. Both lines are long compared with the smoothing curve.
//! Contour mode passes the corner in less time than the smoothing curve, because the speed can change inside
//! a curve of contour mode. With the slope STEP, the lengths alone decide.
//!
//! Under a transformation, contour mode has no curves over time, so only corners of more than 102 degrees are
//! edges.
//!
//! A corner beyond MAX_ANGLE, and a line straight back, are no edges and are not rounded.
use super::chords::Chord;
use super::parameters::{Parameters, Tolerance, Used};
use super::window::{Programmed, Space};
use crate::dynamics::Dynamics;
use crate::math::float::{max, min};
use crate::nc::SlopeType;
use crate::path::Measure;
use crate::smooth::contour::Edge;
use crate::smooth::{Data, Form, ProgrammedBlock};

/// Change of direction (twice the sine of half the angle) of the sharpest turn of a smoothing curve: 102
/// degrees.
pub const SHARPEST: f32 = 1.554_29;

/// Above this change of direction, the line turns straight back: 179.6 degrees.
const BACK: f32 = 1.999_99;

/// A turn below 18 degrees belongs to a smooth contour; a turn above 74 degrees is sharp.
const EDGE: f32 = 0.313;
const SHARP: f32 = 1.2;

/// A line longer than this many widths can make an edge. The width is that of a single smoothing curve at the
/// turn. The first value is for smooth contours, the second for all other turns. Smoothing curves of shorter
/// lines join to one smooth curve.
const APART: f32 = 1.5;
const ONE_CURVE: f32 = 0.34;
/// With STEP: number of widths above which a line can make an edge, for every turn. STEP has no ramps of
/// acceleration, so a single curve costs little time. Only far shorter lines are quicker with smoothing
/// curves.
const STEPPED_APART: f32 = 0.05;
/// Sharp turns between lines shorter than this many widths belong to a run that turns back. There the
/// smoothing curve is compared with a stop only.
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

    /// Returns `true` if `block` makes an edge with the chord before it.
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
        if dynamics.is_transformed() {
            return false;
        }
        let rapid = before.programmed.feed.is_none() && next.programmed.feed.is_none();
        let Tolerance { path, track } = self.tolerance(rapid, self.parameters.used(&before.stray));
        // The smoothing curve of a single turn deviates by a sixth of its width times the turn.
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

    /// Returns `true` if the block is an arc that stays exact, so that contour mode rounds its transitions.
    pub fn keeps<const AXES: usize>(&self, block: &ProgrammedBlock<AXES>) -> bool {
        let rapid = block.data.feed.is_none() && self.parameters.leaves_rapid();
        let arc = block.form != Form::Line && self.parameters.rounds_arcs() && !rapid;
        arc && self.parameters.chord_of(&block.element).is_none()
    }

    /// Returns `true` if two blocks make an edge. The first block already belongs to contour mode. A
    /// transition between an arc and a smoothed block is always an edge.
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
            // A small arc also makes an edge after a block that stays.
            return block.form != Form::Line || self.chord(block).is_some();
        }
        if self.keeps(block) {
            return self.chord(before).is_some();
        }
        self.chord(before).is_some_and(|before| self.parts(&before, block, dynamics))
    }

    /// Tolerance of the curve at an edge. `rapid`: whether both lines are rapid motion (G00). `used`: the
    /// shares of the tolerance that merged lines have used.
    pub fn tolerance(&self, rapid: bool, used: Used) -> Tolerance {
        self.parameters.left(self.parameters.tolerance(rapid), false, used)
    }

    /// The chord of a line that Surface may change.
    fn chord<const AXES: usize>(&self, block: &ProgrammedBlock<AXES>) -> Option<Chord<AXES>> {
        let Data { feed, n, number, .. } = block.data;
        if block.form != Form::Line || feed.is_none() && self.parameters.leaves_rapid() {
            return None;
        }
        let chord = Chord::new(&block.from, &block.to, Programmed { feed, n, number }, self.space);
        chord.filter(|chord| !self.parameters.is_longer(chord.length))
    }
}

//! Merges chords (short lines of nearly the same direction) into one line before corners are rounded. The
//! curve of a corner takes at most half of each block, so corners between short chords are slow.
//!
//! The machine data `merge_chords` give a part of PATH_DEV to the merged lines. The curves at the corners of
//! these lines have the rest of PATH_DEV.
//!
//! Between two points the contour is straight, so the deviation is largest at a point that was left out. Up
//! to [`POINTS`] points are stored one by one. When this memory is full, the deviation so far is kept as one
//! number, and the deviation of later points is added to this number.
use super::curve::{aside, foot, plus, size};
use super::held_block::{HeldBlock, LONGEST_TICKS, Stray, travel};
use super::{Form, Parameters, ProgrammedBlock};
use crate::dynamics::Dynamics;
use crate::math::float::{max, to_f32};
use crate::path::{Measure, straight_line};
use crate::quantity::DISTANCE_LSB;

/// Number of stored points.
const POINTS: usize = 15;

/// Longest merged line, as a multiple of the tolerance. The curves at the corners of longer lines are fast
/// enough.
const LONGEST: f32 = 256.0;

/// Largest sine of the angle between a chord and the line.
const GENTLE: f32 = 0.25;

/// Rounding of the distance of a point in `f32`, as a share of the line's length.
const ROUNDED: f32 = 1.0 / (1u32 << 21) as f32;

/// Permitted deviation of other axes without TRACK_DEV, mm or degrees. The value covers the rounding of a
/// straight line.
const STRAIGHT: f32 = 1.0 / 65_536.0;

/// The chords of a line that may still grow.
#[derive(Clone, Copy, Debug)]
pub(super) struct Chords<const AXES: usize> {
    /// Points from the start of the line, mm; only the first `count` points are valid.
    points: [[f32; AXES]; POINTS],
    count: u8,
    /// Deviation of the line over points that are no longer stored.
    before: Stray,
}

impl<const AXES: usize> Chords<AXES> {
    /// A line without merged chords, which may deviate from its blocks by `before`.
    pub const fn beside(before: Stray) -> Self {
        Self { points: [[0.0; AXES]; POINTS], count: 0, before }
    }

    /// Extends `held` to a line over itself and the next block, if all points between stay inside their share
    /// of the tolerance. Returns whether the line is extended.
    #[inline(never)]
    pub fn gather(
        &mut self,
        held: &mut HeldBlock<AXES>,
        (block, next_rule): (&ProgrammedBlock<AXES>, Option<&Parameters>),
        dynamics: &Dynamics<AXES>,
        measure: &Measure,
    ) -> bool {
        let Some(rule) = held.rule.as_ref() else { return false };
        let Some(most) = rule.chords() else { return false };
        let is_line = held.is_line() && block.form == Form::Line;
        let is_fit = is_line && held.block.data.feed == block.data.feed && next_rule == Some(rule);
        let (from, to) = (&held.block.from, &block.to);
        let over = travel(from, to);
        let length = size(&measure.main, &over);
        if !is_fit || length > LONGEST * rule.path_dev {
            return false;
        }
        let point = travel(from, &held.block.to);
        let stray = self.stray(&over, &point, length, measure).filter(|stray| stray.is_within(most));
        let (Some(stray), Ok(Some(line))) = (stray, straight_line(from, to, measure)) else { return false };
        let whole = to_f32(line.length().to_bits()) * DISTANCE_LSB;
        if whole >= dynamics.line(line.tangent(), held.block.data.feed).0.v * LONGEST_TICKS {
            return false;
        }
        self.push(point, held.stray);
        line.assign_to(&mut held.block.element);
        (held.block.to, held.block.data) = (block.to, block.data);
        (held.length, held.stray) = (line.length().to_bits(), stray);
        held.known = None;
        true
    }

    /// Deviation of the dropped points, with the `last` one, from a line. Returns `None` if the direction of
    /// a chord differs too much.
    fn stray(&self, over: &[f32; AXES], last: &[f32; AXES], length: f32, measure: &Measure) -> Option<Stray> {
        let main = &measure.main;
        let (mut stray, mut before) = (Stray::NONE, [0.0; AXES]);
        let known = self.points.get(..usize::from(self.count)).unwrap_or_default();
        for point in known.iter().chain([last, over]) {
            let chord = plus(point, -1.0, &before);
            let off = plus(point, -foot(main, over, point), over);
            let turned = plus(&chord, -foot(main, over, &chord), over);
            // A chord that moves only other axes has no length.
            let is_gentle = size(main, &turned) < GENTLE * size(main, &chord);
            if !is_gentle {
                return None;
            }
            stray = stray.or(Stray { path: size(main, &off), track: aside(main, &off) });
            before = *point;
        }
        let rounded = Stray { path: ROUNDED * length, track: ROUNDED * aside(main, over) };
        Some(stray.and(self.before).and(rounded))
    }

    /// Adds a dropped point. `stray`: deviation of the line up to this point.
    fn push(&mut self, point: [f32; AXES], stray: Stray) {
        if usize::from(self.count) == POINTS {
            (self.count, self.before) = (0, stray);
        }
        if let Some(slot) = self.points.get_mut(usize::from(self.count)) {
            *slot = point;
            self.count += 1;
        }
    }
}

impl Parameters {
    /// Permitted deviation of chords from their line. Without TRACK_DEV, all axes except the main axes have
    /// to move evenly.
    pub(super) fn chords(&self) -> Option<Stray> {
        let part = self.preset().chords;
        let counts = self.method == crate::nc::ContourMethod::Dev && part > 0.0;
        counts.then(|| Stray { path: part * self.path_dev, track: max(part * self.track_dev, STRAIGHT) })
    }
}

//! Chords that become one line: a curve cut into chords that are short beside the tolerance is held up at
//! each of its corners, for a curve there takes half a block. So the machine data may give a part of PATH_DEV
//! to straight lines over several chords, and the curves at their corners have the rest.
//!
//! The largest deviation is that of a point left out: between two of them the contour is straight as well.
//! [`POINTS`] of them are known one by one. Beyond that, what the line is beside them adds up.
use super::curve::{aside, foot, plus, size};
use super::held_block::{HeldBlock, LONGEST_TICKS, Stray, travel};
use super::{Form, Parameters, ProgrammedBlock};
use crate::dynamics::Dynamics;
use crate::math::float::{max, to_f32};
use crate::path::{Measure, straight_line};
use crate::quantity::DISTANCE_LSB;

/// Points left out that are known.
const POINTS: usize = 15;

/// Longest line of several chords, in tolerances: a curve at the corner of a longer one is not held up by it.
const LONGEST: f32 = 256.0;

/// Largest sine between a chord and the line.
const GENTLE: f32 = 0.25;

/// Of the line's length: rounding of the distance of a point, in `f32`.
const ROUNDED: f32 = 1.0 / (1u32 << 21) as f32;

/// Mm or degrees that other axes may be beside the line without TRACK_DEV: what rounding makes of a straight one.
const STRAIGHT: f32 = 1.0 / 65_536.0;

/// What the line that may still grow is made of.
#[derive(Clone, Copy, Debug)]
pub(super) struct Chords<const AXES: usize> {
    /// From its start, mm; the first so many count.
    points: [[f32; AXES]; POINTS],
    count: u8,
    /// How far others may be from the line up to the last point.
    before: Stray,
}

impl<const AXES: usize> Chords<AXES> {
    /// No chord is merged yet; the line may deviate from them by so much.
    pub const fn beside(before: Stray) -> Self {
        Self { points: [[0.0; AXES]; POINTS], count: 0, before }
    }

    /// `held` becomes the line over it and the next block, which has this rule, if all points between are
    /// inside their part of the tolerance. Whether it does.
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

    /// How far the points left out are from a line, the `last` one among them. `None` where a chord does not
    /// go nearly its way.
    fn stray(&self, over: &[f32; AXES], last: &[f32; AXES], length: f32, measure: &Measure) -> Option<Stray> {
        let main = &measure.main;
        let (mut stray, mut before) = (Stray::NONE, [0.0; AXES]);
        let known = self.points.get(..usize::from(self.count)).unwrap_or_default();
        for point in known.iter().chain([last, over]) {
            let chord = plus(point, -1.0, &before);
            let off = plus(point, -foot(main, over, point), over);
            let turned = plus(&chord, -foot(main, over, &chord), over);
            // One that turns other axes alone has no length.
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

    /// The point is left out. `stray`: of the line up to it.
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
    /// What chords may be beside the line that stands for them. Without TRACK_DEV all axes that are no main
    /// axes have to go straight.
    pub(super) fn chords(&self) -> Option<Stray> {
        let part = self.preset().chords;
        let counts = self.method == crate::nc::ContourMethod::Dev && part > 0.0;
        counts.then(|| Stray { path: part * self.path_dev, track: max(part * self.track_dev, STRAIGHT) })
    }
}

//! Knees of one axis that may show within one tick.
//!
//! A second difference of set points shows a step of speed with a weight that falls from 1 to 0 within a
//! tick on either side of it. Steps that are a tick apart or more therefore never show more than the largest of them.
//! Steps closer than that add up as far as they have one sign; steps of opposite sign show less than either.
//!
//! Two knees are that close where the block between them takes less than a tick. Speed at a knee alone does not
//! tell: a block that begins and ends slowly may be quick in between, if the axes that move in it have the
//! jerk. Such a block is *short* here. The steps of all knees with short blocks between them are added up, per axis and
//! sign. As long as their sum is within what one knee of the axis may take, nothing changes. The first short
//! block that would exceed it is passed with no more than its length per tick. It then takes a tick, and the
//! sum begins anew behind it.
//!
//! A short block that is entered faster than that cannot be made to take a tick any more. Its end is passed only as fast
//! as the knee at its start leaves room for.
//!
//! STEP has its own rule ([`Dynamics::transition`]).
use super::append::Last;
use super::block::{Block, Marks};
use crate::dynamics::Dynamics;
use crate::math::float::{max, min};
use crate::nc::SlopeType;
use crate::path::End;

/// A block between two knees takes less than a tick only if it is shorter than that part of its jerk, or begins
/// or ends with more than a third of its length per tick, where a knee has a fourth of its part at most. From a
/// third of its length per tick it goes a third of it in a tick, and a 32nd part of its jerk.
const SHORT: f32 = 0.05;

/// Rounding of a speed at a knee, in `f32`.
const ROUNDED: f32 = 1.0 + 1.0 / 1_048_576.0;

/// The level of the override may rise by so much between two blocks.
const RISES: f32 = 2.0;

/// Steps of speed of every axis at the last knees that may show together, mm/tick: upward, downward.
#[derive(Clone, Copy, Debug)]
pub(super) struct Steps<const AXES: usize> {
    up: [f32; AXES],
    down: [f32; AXES],
    /// There are some.
    any: bool,
}

/// The last block, between two knees.
pub(super) struct Between<'a, const AXES: usize> {
    pub last: &'a Last<AXES>,
    pub block: &'a mut Block,
    /// Speed at 100 %, or at the planned override if that is higher, mm/tick.
    pub full: f32,
    /// Level of all speeds.
    pub level: f32,
}

/// The knee behind it, and the block that comes in there.
pub(super) struct Knee<'a, const AXES: usize> {
    pub entry: &'a End<AXES>,
    pub rapid: bool,
    /// Length of that block, mm.
    pub room: f32,
    /// Speed at 100 %, or at the planned override if that is higher, mm/tick.
    pub full: f32,
}

impl<const AXES: usize> Steps<AXES> {
    /// No steps.
    pub const NONE: Self = Self { up: [0.0; AXES], down: [0.0; AXES], any: false };

    /// Starts anew: the next knee falls into one tick with none before it.
    #[cfg_attr(feature = "fast", inline(always))]
    pub fn clear(&mut self) {
        self.any = false;
    }

    /// Speed at which a knee may be passed together with the knees before it. Alone it may be passed with `v` mm/tick,
    /// at any override.
    #[cfg_attr(feature = "fast", inline(always))]
    pub fn beside(
        &mut self,
        between: &mut Between<'_, AXES>,
        knee: &Knee<'_, AXES>,
        v: f32,
        dynamics: &Dynamics<AXES>,
    ) -> f32 {
        let is_near = between.last.length < 2.0 * between.full || knee.room < 2.0 * RISES * knee.full;
        if is_near && dynamics.slope() != SlopeType::Step {
            return self.take(between, knee, v, dynamics);
        }
        self.clear();
        v
    }

    /// As [`Self::beside`], where the block before or behind it may take less than a tick.
    #[cold]
    #[inline(never)]
    fn take(
        &mut self,
        between: &mut Between<'_, AXES>,
        &Knee { entry, rapid, .. }: &Knee<'_, AXES>,
        v: f32,
        dynamics: &Dynamics<AXES>,
    ) -> f32 {
        let Between { last, block, full, .. } = between;
        let any = core::mem::replace(&mut self.any, true);
        let is_long = last.length >= 2.0 * *full || last.length >= SHORT * block.limits_by_call().steepest();
        if !any || is_long || last.timed {
            self.begin(&last.exit, entry, v);
            return v;
        }
        let part = self.part(&last.exit, (entry, rapid), v, dynamics);
        let is_quick = block.cap > last.length;
        if part < 1.0 && between.take_a_tick() {
            let v = min(v, between.last.length);
            self.begin(&between.last.exit, entry, v);
            return v;
        }
        let v = part * v;
        if is_quick {
            // What was passed before its start has a part of its own.
            self.begin(&between.last.exit, entry, v);
        } else {
            self.add(&between.last.exit, entry, v);
        }
        v
    }

    /// The part of the speed `v` at which no axis' steps of one sign are more than what one knee may take; at most 1.
    fn part(
        &self,
        exit: &End<AXES>,
        (entry, rapid): (&End<AXES>, bool),
        v: f32,
        dynamics: &Dynamics<AXES>,
    ) -> f32 {
        let mut part = 1.0;
        for (k, (up, down)) in self.up.iter().zip(&self.down).enumerate() {
            let step = v * exit.turn(entry, k);
            let (before, step) = if step > 0.0 { (*up, step) } else { (*down, -step) };
            // A knee that takes all of it may be more by rounding: what is next to nothing passes beside it.
            let left = max(ROUNDED * dynamics.knee(k, rapid) - before, 0.0);
            if before > 0.0 && left < part * step {
                part = left / step;
            }
        }
        part
    }

    fn begin(&mut self, exit: &End<AXES>, entry: &End<AXES>, v: f32) {
        (self.up, self.down) = ([0.0; AXES], [0.0; AXES]);
        self.add(exit, entry, v);
    }

    fn add(&mut self, exit: &End<AXES>, entry: &End<AXES>, v: f32) {
        for (k, (up, down)) in self.up.iter_mut().zip(&mut self.down).enumerate() {
            let step = v * exit.turn(entry, k);
            (*up, *down) = (*up + max(step, 0.0), *down + max(-step, 0.0));
        }
    }
}

impl<const AXES: usize> Between<'_, AXES> {
    /// The block is passed with no more than its length per tick, at any override; `false`, and nothing has changed,
    /// where it is entered faster, or with acceleration.
    fn take_a_tick(&mut self) -> bool {
        let Self { last, block, full, level } = self;
        let range = block.override_range.lowered(*full, max(*level, 1.0), last.length);
        let v = min(*full, last.length);
        let v = if *level < 1.0 { v * range.raised(*level) } else { v };
        if block.cap > v || !block.is(Marks::ANCHOR) {
            return false;
        }
        (block.numbers.v, block.override_range) = (min(block.v(), v), range);
        block.marks.set(Marks::CHECKED, false);
        true
    }
}

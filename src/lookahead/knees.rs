//! Limits the speed where an axis has several knees (corners without a curve) within one tick. The slope STEP
//! has its own rule ([`Dynamics::transition`]).
//!
//! At a knee, the speed of an axis has a step. The acceleration of an axis is the second difference of its
//! set points. A step of speed appears in two second differences. Its weight in a second difference depends
//! on the time to the middle set point: 1 at this set point, 0 from one tick on. So two steps that are at
//! least a tick apart never show more than the larger step. Two closer steps of the same sign add up. Two
//! closer steps of opposite sign show at most the larger step.
//!
//! In this file, a block between two knees is *short* if the motion may pass it in less than a tick. The
//! speeds at its ends do not decide this, because the motion may be fast between two slow ends. For
//! consecutive knees with short blocks between them, the planner adds up the steps of each axis, positive and
//! negative steps separately. If a sum exceeds the axis's limit for one knee, the speed of the last short
//! block is limited to its length per tick. The block then takes a tick, and a new sum begins after it.
//!
//! A block cannot take a tick if the motion enters the block faster than this speed, or with acceleration.
//! Then the speed at the knee after the block is lowered, until the sum is within the limit.
use super::append::Last;
use super::block::{Block, Marks};
use crate::dynamics::Dynamics;
use crate::math::float::{max, min};
use crate::nc::SlopeType;
use crate::path::End;

/// A block between two knees takes less than a tick only in two cases. In the first case, it is shorter than
/// this part of its jerk. In the second case, its end speed is above a third of its length per tick; a knee
/// then has at most a fourth of its part. At this end speed, the motion covers in a tick a third of the
/// length and a 32nd of the jerk.
const SHORT: f32 = 0.05;

/// Rounding of a speed at a knee, in `f32`.
const ROUNDED: f32 = 1.0 + 1.0 / 1_048_576.0;

/// The planned override may rise by this factor between two blocks.
const RISES: f32 = 2.0;

/// Steps of speed of every axis at the last knees that may fall into one tick with the next one, mm/tick.
/// First positive steps, then negative ones.
#[derive(Clone, Copy, Debug)]
pub(super) struct Steps<const AXES: usize> {
    up: [f32; AXES],
    down: [f32; AXES],
    /// Whether there is any step.
    any: bool,
}

/// The last block, which lies between two knees.
pub(super) struct Between<'a, const AXES: usize> {
    pub last: &'a Last<AXES>,
    pub block: &'a mut Block,
    /// Speed at 100 %, or at the planned override if that is higher, mm/tick.
    pub full: f32,
    /// Planned override of all planned speeds.
    pub level: f32,
}

/// The knee after the block, and the new block.
pub(super) struct Knee<'a, const AXES: usize> {
    pub entry: &'a End<AXES>,
    pub rapid: bool,
    /// Length of the new block, mm.
    pub room: f32,
    /// Speed at 100 %, or at the planned override if that is higher, mm/tick.
    pub full: f32,
}

impl<const AXES: usize> Steps<AXES> {
    /// No steps of speed yet.
    pub const NONE: Self = Self { up: [0.0; AXES], down: [0.0; AXES], any: false };

    /// Clears the sums. Call this function if the next knee does not share a tick with any knee before.
    #[cfg_attr(feature = "fast", inline(always))]
    pub fn clear(&mut self) {
        self.any = false;
    }

    /// Speed (mm/tick) at which the motion may pass a knee together with the knees before it in the same
    /// tick. `v`: the speed that the knee alone permits, at any override.
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

    /// As [`Self::beside`], if the block before or after the knee may take less than a tick.
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
            // The knees before the block's start fall into another tick.
            self.begin(&between.last.exit, entry, v);
        } else {
            self.add(&between.last.exit, entry, v);
        }
        v
    }

    /// The factor for the speed `v`, at most 1. With this factor, no axis exceeds the limit of one knee in
    /// any direction.
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
            // A knee that uses all of the limit may exceed it by rounding. A negligible step is still
            // permitted in addition.
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
    /// Lowers the speed of the block to its length per tick, at any override. Returns `false`, and changes
    /// nothing, if the motion enters the block faster, or with acceleration.
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

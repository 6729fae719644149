//! The fastest motion along a path whose permitted speed changes from block to block, from standstill to
//! standstill, with limited acceleration and jerk: what a real-time planner is measured against, and may
//! never beat.
//!
//! ```text
//! minimise T   with   v <= V of the block,   -D <= a <= A,   |jerk| <= J
//! ```
//!
//! The path is cut into cells of constant jerk, an interior point method finds the best duration, speed and
//! acceleration of all of them at once ([`interior`]), and cells in which the jerk changes are cut again
//! until that gains nothing ([`grid`]). Nothing is assumed about the shape of the result: acceleration is
//! free at block ends, and speed may fall below the limit in a slow block so as to leave it accelerating.
//!
//! # How good it is
//!
//! From above: [`Optimum::time`] belongs to a motion that keeps every limit. The acceleration, jerk and
//! lengths of its pieces hold by construction, speed inside a piece is checked at its highest point, and what
//! rounding left over is removed by slowing the whole motion down (measured: nothing).
//!
//! From below: finer grids contain the coarser ones, so time only falls with refinement, to about an eighth
//! of the gain before each time. Refinement ends below 10⁻⁵ of the time; [`Optimum::gap`] is the gain of the
//! last one and the remaining duality gap. The problem is not convex, so that is an estimate, not a proof.
//! What supports it, over the 200 paths of [`crate::cases::feeds`]: from eight more starts each (zero
//! acceleration in valleys; the same and that at block ends with block speeds lowered at random by up to ten)
//! every search arrived, no time was below the usual one by more than 4.3·10⁻⁵ of it, none above by more than
//! 1.1·10⁻⁵. [`TOLERANCE`] covers both with a factor of two.
//!
//! Thirty cells a block at the end and 34 to 166 Newton steps are usual: 0.15 s a path, at most 3 s among the
//! 200.
pub mod banded;

pub mod interior;

pub mod grid;

pub mod anchors;

use super::profile::{Profile, Ramps};
use grid::Cells;
use interior::{Interior, Point};

/// Part of the time by which the true optimum may lie below [`Optimum::time`]. Derived above.
pub const TOLERANCE: f64 = 1e-4;

/// A part of the path with one speed limit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Block {
    /// Length, mm.
    pub length: f64,
    /// Highest speed, mm/s.
    pub speed: f64,
}

/// Limits along the whole path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Acceleration, mm/s².
    pub acceleration: f64,
    /// Deceleration, mm/s².
    pub deceleration: f64,
    /// Jerk, mm/s³.
    pub jerk: f64,
}

impl Limits {
    /// Equal acceleration and deceleration (mm/s²), reached within `ramp` seconds.
    pub fn even(acceleration: f64, ramp: f64) -> Self {
        Self { acceleration, deceleration: acceleration, jerk: acceleration / ramp }
    }

    /// Ramps of acceleration.
    pub fn accelerate(&self) -> Ramps {
        let ramp = self.acceleration / self.jerk;
        Ramps { a: self.acceleration, up: ramp, down: ramp }
    }

    /// Ramps of deceleration.
    pub fn brake(&self) -> Ramps {
        let ramp = self.deceleration / self.jerk;
        Ramps { a: self.deceleration, up: ramp, down: ramp }
    }
}

/// A part of a motion, within one block, with constant jerk.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece {
    /// Block it lies in.
    pub block: usize,
    /// Duration, s.
    pub time: f64,
    /// Speed at its start, mm/s.
    pub v: f64,
    /// Acceleration at its start, mm/s².
    pub a: f64,
    /// Jerk, mm/s³.
    pub jerk: f64,
}

impl Piece {
    /// Distance, speed and acceleration `t` seconds after its start.
    pub fn at(&self, t: f64) -> [f64; 3] {
        let Self { v, a, jerk, .. } = *self;
        [t * (v + t * (a / 2.0 + t * jerk / 6.0)), v + t * (a + t * jerk / 2.0), a + t * jerk]
    }

    /// Highest speed: at an end, or where acceleration falls through zero.
    pub fn fastest(&self) -> f64 {
        let peak = if self.jerk < 0.0 { (-self.a / self.jerk).clamp(0.0, self.time) } else { 0.0 };
        self.v.max(self.at(peak)[1]).max(self.at(self.time)[1])
    }

    /// The same motion, slower by a factor.
    fn slower(self, factor: f64) -> Self {
        Self {
            time: self.time * factor,
            v: self.v / factor,
            a: self.a / factor.powi(2),
            jerk: self.jerk / factor.powi(3),
            ..self
        }
    }
}

/// The fastest motion found.
#[derive(Clone, Debug, PartialEq)]
pub struct Optimum {
    /// Its duration, s: an upper bound of the optimum.
    pub time: f64,
    /// Estimate of what it may lie above the optimum, s.
    pub gap: f64,
    /// The motion.
    pub pieces: Vec<Piece>,
    /// Newton steps taken.
    pub steps: usize,
}

/// Longest cells at first, in ramp times.
const FIRST_CELL: f64 = 0.1;
/// Refinements at most.
const REFINEMENTS: usize = 6;
/// Refinement ends when it gains less than this part of the time.
const GAIN: f64 = 1e-5;
/// Parts of the mean time per inequality: barrier weights at the start of the first solution and of the
/// others, and at their end, where all inequalities together cost at most this part of the time.
const BARRIER: [f64; 3] = [0.1, 1e-3, 1e-6];
/// Factors by which the start motion is slower than the given motion, so that the start is inside all limits:
/// the first time, later.
const SLOWER: [f64; 2] = [1.1, 1.002];

/// The fastest motion; `None` if the search does not converge.
pub fn optimum(blocks: &[Block], limits: &Limits) -> Option<Optimum> {
    search(blocks, limits, &anchors::at_borders(blocks, limits), FIRST_CELL)
}

/// The fastest motion, searched from a given one that keeps the limits, with cells of at most `cell` ramp
/// times at first.
pub fn search(blocks: &[Block], limits: &Limits, start: &[Profile], cell: f64) -> Option<Optimum> {
    let unit = Unit::new(limits);
    let (mut cells, mut x) = Cells::sampled(blocks, limits, start, &unit, cell);
    let (mut steps, mut before) = (0, f64::INFINITY);
    for round in 0..=REFINEMENTS {
        let later = usize::from(round > 0);
        cells.grid.expect(&mut x, SLOWER[later]);
        let mut solver = Interior::new(&cells.grid, x);
        let scale = solver.x.time() / solver.inequalities() as f64;
        let done = solver.solve(BARRIER[later] * scale, BARRIER[2] * scale);
        steps += solver.steps;
        if !done {
            return None;
        }
        x = solver.x;
        let (time, gain) = (x.time(), before - x.time());
        if gain < GAIN * time || round == REFINEMENTS {
            let gap = (gain.max(0.0) + BARRIER[2] * time) * unit.time;
            return Some(Optimum { gap, steps, ..unit.motion(&x, &cells, blocks, limits) });
        }
        before = time;
        (cells, x) = cells.refined(&x);
    }
    None
}

/// Units in which the largest acceleration and the jerk are 1: s, mm/s, mm, mm/s² and mm/s³ of them.
pub struct Unit {
    time: f64,
    speed: f64,
    length: f64,
    acceleration: f64,
    jerk: f64,
}

impl Unit {
    fn new(limits: &Limits) -> Self {
        let &Limits { acceleration, jerk, .. } = limits;
        let time = acceleration / jerk;
        Self { time, speed: acceleration * time, length: acceleration * time * time, acceleration, jerk }
    }

    /// The motion in mm and s, from its jerks alone, slowed down until it keeps every limit.
    fn motion(&self, x: &Point, cells: &Cells, blocks: &[Block], limits: &Limits) -> Optimum {
        let mut pieces = Vec::with_capacity(x.h.len());
        let (mut v, mut a, mut factor) = (0.0, 0.0, 1.0_f64);
        for (k, (&h, &block)) in x.h.iter().zip(&cells.blocks).enumerate() {
            let jerk = (x.a[k + 1] - x.a[k]) / h * self.jerk;
            let piece = Piece { block, time: h * self.time, v, a, jerk };
            [_, v, a] = piece.at(piece.time);
            let over_a = (a / limits.acceleration).max(-a / limits.deceleration);
            factor = factor
                .max(piece.fastest() / blocks[block].speed)
                .max(over_a.max(0.0).sqrt())
                .max((jerk.abs() / limits.jerk).cbrt());
            pieces.push(piece);
        }
        pieces.iter_mut().for_each(|piece| *piece = piece.slower(factor));
        Optimum { time: pieces.iter().map(|p| p.time).sum(), gap: 0.0, pieces, steps: 0 }
    }
}

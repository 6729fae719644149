//! Corners whose steps of speed may fall into one tick.
//!
//! A block between two corners may take less than a tick if two conditions hold: it is shorter than two ticks
//! at its highest speed, and shorter than a twentieth of its jerk. The steps of speed at corners with such
//! blocks between them are added, for every axis those of one sign. The sum may have the limit of one corner.
//! If the sum would exceed this limit, the block is passed with at most its length per tick, and the sum
//! begins anew. If the block is entered faster or with acceleration, its end is slower instead; the sum
//! begins anew after a block that is entered faster.
use super::geometry::Element;
use super::limits::{BlockLimits, Machine, Turn};

/// Such a block is shorter than this part of its jerk.
const SHORT: f64 = 0.05;

/// The library stores speeds at corners in `f32`: a smaller excess is none.
const ROUNDED: f64 = 1.0 + 1.0 / 1_048_576.0;

/// The block before a corner.
pub struct Between<'a> {
    /// Its limits.
    pub limits: &'a mut BlockLimits,
    /// Its length.
    pub length: f64,
    /// Highest speed at its start.
    pub v_start: f64,
    /// Whether acceleration at its start may be non-zero.
    pub through: bool,
}

/// Steps of speed at the last corners, for each axis; upward and downward.
#[derive(Clone, Debug, Default)]
pub struct Knees {
    steps: Vec<[f64; 2]>,
}

impl Knees {
    /// The motion stands still, or has passed no corner yet.
    pub fn clear(&mut self) {
        self.steps.clear();
    }

    /// The permitted speed at the corner between two elements, for which a single corner permits `v`.
    pub fn take(&mut self, between: Between<'_>, elements: [&Element; 2], v: f64, machine: &Machine) -> f64 {
        let Between { limits, length, v_start, through } = between;
        let turns = machine.turns(elements);
        let new = |v: f64| -> Vec<[f64; 2]> {
            turns.iter().map(|Turn { by, .. }| [(v * by).max(0.0), (-v * by).max(0.0)]).collect()
        };
        let steepest = limits.j.into_iter().fold(0.0, f64::max);
        let is_short = length < 2.0 * limits.v && length < SHORT * steepest;
        if self.steps.is_empty() || !is_short {
            self.steps = new(v);
            return v;
        }
        let sides = self.steps.iter().zip(new(v)).zip(&turns);
        let part = sides.flat_map(|((before, step), turn)| {
            [0, 1].map(|sign| {
                if before[sign] > 0.0 {
                    (ROUNDED * turn.most - before[sign]).max(0.0) / step[sign]
                } else {
                    1.0
                }
            })
        });
        let part = part.filter(|part| !part.is_nan()).fold(1.0, f64::min);
        if part < 1.0 && !through && v_start <= length {
            limits.v = limits.v.min(length);
            let v = v.min(length);
            self.steps = new(v);
            return v;
        }
        let v = part * v;
        let steps = new(v);
        if v_start > length {
            self.steps = steps;
        } else {
            for (sum, step) in self.steps.iter_mut().zip(steps) {
                *sum = [sum[0] + step[0], sum[1] + step[1]];
            }
        }
        v
    }
}

//! Knees that a tick may show together.
//!
//! A block between two knees may take less than a tick if it is shorter than two ticks at its highest speed, and than
//! a twentieth of its jerk. The steps of speed at knees with such blocks between them are added up, for every
//! axis those of one sign. Together they may have what one knee may have. Where they would have more, the
//! block is passed with its length per tick at most, and the sum begins anew. Is it entered faster, or with
//! acceleration, its end is slower instead; the sum begins anew behind a block that is entered faster.
use super::geometry::Element;
use super::limits::{BlockLimits, Machine, Turn};

/// Such a block is shorter than that part of its jerk.
const SHORT: f64 = 0.05;

/// The library knows speeds at knees in `f32`: what is more by so little is not.
const ROUNDED: f64 = 1.0 + 1.0 / 1_048_576.0;

/// The block before a knee.
pub struct Between<'a> {
    /// Its limits.
    pub limits: &'a mut BlockLimits,
    /// Its length.
    pub length: f64,
    /// Speed at its start, at most.
    pub v_start: f64,
    /// Acceleration may pass its start.
    pub through: bool,
}

/// Steps of speed at the last knees, for each axis; upward and downward.
#[derive(Clone, Debug, Default)]
pub struct Knees {
    steps: Vec<[f64; 2]>,
}

impl Knees {
    /// The motion stands still, or knows no knee before.
    pub fn clear(&mut self) {
        self.steps.clear();
    }

    /// The speed at the knee between two elements that alone may be passed with `v`.
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

//! Cells of the path: how they begin and which cells are divided.
//!
//! The jerk of the optimum is at its limit or zero, and switches between these values a few times. Only a
//! cell that contains a switch costs time, in proportion to the square of its duration. So only these cells
//! are divided again.
use super::interior::{Grid, Point};
use super::{Block, Limits, Unit, anchors::Course};
use crate::reference::profile::Profile;

/// Lowest number of cells: four jerks need this number at first.
const FEWEST: f64 = 40.0;
/// Number of parts of a divided cell, and of its neighbours.
const PARTS: [usize; 2] = [4, 2];
/// Jerk that counts as zero or as the limit, in parts of the limit.
const SETTLED: f64 = 0.02;
/// Peaks of speed closer to the limit than this are looked at closely.
const NEAR: f64 = 1e-4;
/// Cells shorter than this are not divided, in ramp times.
const SHORTEST: f64 = 0.003;

/// Cells and the blocks they lie in.
#[derive(Clone, Debug, Default)]
pub struct Cells {
    /// For the optimisation.
    pub grid: Grid,
    /// Block of each cell.
    pub blocks: Vec<usize>,
}

impl Cells {
    /// Cells with nodes at the block ends and at equal times between them, at most `longest` ramp times apart
    /// in a given motion, and that motion.
    pub fn sampled(
        blocks: &[Block],
        limits: &Limits,
        motion: &[Profile],
        unit: &Unit,
        longest: f64,
    ) -> (Self, Point) {
        let course = Course::new(motion);
        let longest = (longest * unit.time).min(course.time() / FEWEST);
        let mut cells = Self::default();
        cells.grid.brake = limits.deceleration / limits.acceleration;
        let mut x = Point::at_rest();
        let (mut border, mut start) = (0.0, 0.0);
        for (i, block) in blocks.iter().enumerate() {
            let (mut from, to) = (border, border + block.length);
            let last = i + 1 == blocks.len();
            let end = if last { course.time() } else { course.arrival(to) };
            let count = ((end - start) / longest).ceil().max(1.0);
            let h = (end - start) / count;
            for k in 1..=count as usize {
                let state = course.at(start + h * k as f64);
                let s = if k == count as usize { to } else { state.s };
                cells.push(i, (s - from) / unit.length, block.speed / unit.speed);
                x.push(h / unit.time, state.v / unit.speed, state.a / unit.acceleration);
                from = s;
            }
            (border, start) = (to, end);
        }
        x.end_at_rest();
        (cells, x)
    }

    fn push(&mut self, block: usize, length: f64, cap: f64) {
        self.grid.length.push(length);
        self.grid.cap.push(cap);
        self.blocks.push(block);
    }

    /// Number of parts of each cell.
    fn parts(&self, x: &Point) -> Vec<usize> {
        let jerk: Vec<f64> = x.h.iter().zip(x.a.windows(2)).map(|(h, a)| (a[1] - a[0]) / h).collect();
        let mut parts = vec![1; x.h.len()];
        let mut cut = |k: usize, into: usize| {
            if let (Some(parts), Some(&h)) = (parts.get_mut(k), x.h.get(k))
                && h >= SHORTEST
            {
                *parts = into.max(*parts);
            }
        };
        for (k, &j) in jerk.iter().enumerate() {
            if j.abs() > SETTLED && j.abs() < 1.0 - SETTLED {
                cut(k, PARTS[0]);
                cut(k.wrapping_sub(1), PARTS[1]);
                cut(k + 1, PARTS[1]);
            }
            if k > 0 && (j - jerk[k - 1]).abs() > 2.0 * SETTLED {
                cut(k, PARTS[1]);
                cut(k - 1, PARTS[1]);
            }
            if x.a[k] > 0.0 && x.a[k + 1] < 0.0 {
                let peak = x.v[k] - 0.5 * x.a[k].powi(2) / j;
                if peak > self.grid.cap[k] * (1.0 - NEAR) {
                    cut(k, PARTS[0]);
                }
            }
        }
        parts
    }

    /// Finer cells, and the same motion there.
    pub fn refined(&self, x: &Point) -> (Self, Point) {
        let mut fine = Self::default();
        fine.grid.brake = self.grid.brake;
        let mut y = Point::at_rest();
        for (k, parts) in self.parts(x).into_iter().enumerate() {
            let h = x.h[k] / parts as f64;
            let (v, a) = (x.v[k], x.a[k]);
            let j = (x.a[k + 1] - a) / x.h[k];
            let mut from = 0.0;
            for i in 1..=parts {
                let t = h * i as f64;
                let s = if i == parts { self.grid.length[k] } else { t * (v + t * (a / 2.0 + t * j / 6.0)) };
                fine.push(self.blocks[k], s - from, self.grid.cap[k]);
                y.push(h, v + t * (a + t * j / 2.0), a + t * j);
                from = s;
            }
        }
        y.end_at_rest();
        (fine, y)
    }
}

//! Records every tick of a run for the page: path speed, set points, and the motion of each axis in percent
//! of its limits. Above [`MOST`] samples every second sample is dropped, and the larger value of both is
//! kept.
use crate::filtered::Filtered;
use crate::machine::Machine;
use crate::statistics::Statistics;
use glidepath::quantity::Position;
use glidepath::tick::Telemetry;

/// Highest number of samples.
const MOST: usize = 1 << 21;

/// LSB of a set point in the page: mm or degrees.
pub const STEP: f64 = 1e-4;

/// A recorded run, column by column.
pub struct Tape {
    /// Ticks per sample.
    pub stride: u64,
    /// Path speed, µm/s.
    pub speed: Vec<i32>,
    /// By axis: set point, [`STEP`].
    pub path: Vec<Vec<i32>>,
    /// By axis: set point after the filter, [`STEP`]; empty without filters.
    pub filtered: Vec<Vec<i32>>,
    /// By axis, then speed, acceleration, jerk: in thousandths of the limit, signed.
    pub share: Vec<Vec<i16>>,
    /// Samples at which another motion block begins, and this block.
    pub entries: Vec<[u32; 2]>,
    cycle_s: f64,
}

/// The nearest whole number, within the range of the column.
fn whole(value: f64) -> i32 {
    value.round() as i32
}

impl Tape {
    /// Nothing recorded yet.
    pub fn new(machine: &Machine) -> Self {
        let axes = machine.axes.len();
        let filtered = if Filtered::has(machine) { axes } else { 0 };
        Self {
            stride: 1,
            speed: Vec::new(),
            path: vec![Vec::new(); axes],
            filtered: vec![Vec::new(); filtered],
            share: vec![Vec::new(); 3 * axes],
            entries: Vec::new(),
            cycle_s: machine.cycle_s(),
        }
    }

    /// Records a row: set points before and after the filters.
    pub fn add(&mut self, telemetry: &Telemetry, [path, drives]: [&[Position]; 2], seen: &Statistics) {
        let tick = seen.ticks - 1;
        let mut shares = Vec::with_capacity(self.share.len());
        for (k, axis) in seen.axes.iter().enumerate() {
            let permitted = seen.monitor.permitted(k, tick);
            for (value, limit) in axis.latest(self.cycle_s).into_iter().zip(permitted) {
                let share = if limit > 0.0 { value / limit * 1e3 } else { 0.0 };
                shares.push(share.round().clamp(-30_000.0, 30_000.0) as i16);
            }
        }
        let speed = whole(telemetry.speed.to_bits() as f64 / (1_u64 << 58) as f64 / self.cycle_s * 1e3);
        if !tick.is_multiple_of(self.stride) {
            if let Some(last) = self.speed.last_mut() {
                *last = speed;
            }
            for (column, share) in self.share.iter_mut().zip(shares) {
                if let Some(last) =
                    column.last_mut().filter(|last| last.unsigned_abs() < share.unsigned_abs())
                {
                    *last = share;
                }
            }
            return;
        }
        if self.speed.len() == MOST {
            self.halve();
        }
        let sample = self.speed.len() as u32;
        if self.entries.last().is_none_or(|[_, block]| *block != telemetry.block) {
            self.entries.push([sample, telemetry.block]);
        }
        self.speed.push(speed);
        let steps = |point: &Position| whole(point.to_num::<f64>() / STEP);
        for (column, point) in self.path.iter_mut().zip(path) {
            column.push(steps(point));
        }
        for (column, point) in self.filtered.iter_mut().zip(drives) {
            column.push(steps(point));
        }
        for (column, share) in self.share.iter_mut().zip(shares) {
            column.push(share);
        }
    }

    /// Drops every second sample.
    fn halve(&mut self) {
        self.stride *= 2;
        let half = |column: &mut Vec<i32>| *column = column.iter().copied().step_by(2).collect();
        half(&mut self.speed);
        self.path.iter_mut().chain(&mut self.filtered).for_each(half);
        for column in &mut self.share {
            let larger = |pair: &[i16]| pair.iter().copied().max_by_key(|share| share.unsigned_abs());
            *column = column.chunks(2).filter_map(larger).collect();
        }
        for [sample, _] in &mut self.entries {
            *sample /= 2;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn halves_keep_the_larger_share() {
        let mut tape = Tape::new(&Machine::built_in());
        tape.speed = vec![1, 2, 3];
        tape.share = vec![vec![5, -7, 1]];
        tape.entries = vec![[0, 0], [2, 1]];
        tape.halve();
        assert_eq!((tape.stride, &tape.speed[..], &tape.share[0][..]), (2, &[1, 3][..], &[-7, 1][..]));
        assert_eq!(tape.entries, [[0, 0], [1, 1]]);
    }
}

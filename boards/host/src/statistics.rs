//! What a run was like: peaks by finite differences of the set points, distances, the digest.
use crate::machine::Machine;
use glidepath::channel::PlannedBlock;
use glidepath::digest::Digest;
use glidepath::quantity::{Distance, Position};
use glidepath::queue::Event;

/// Set points of one axis, seen one after the other.
#[derive(Clone, Debug, Default)]
pub struct AxisStatistics {
    last: i64,
    /// The latest first, second and third difference, in LSB of [`Position`].
    latest: [i128; 3],
    /// The largest magnitudes of these.
    peak: [u128; 3],
    /// Sum of the first differences' magnitudes, LSB.
    travel: u128,
    lowest: i64,
    highest: i64,
}

impl AxisStatistics {
    fn at_rest(start: Position) -> Self {
        let last = start.to_bits();
        Self { last, lowest: last, highest: last, ..Self::default() }
    }

    fn add(&mut self, set_point: Position) {
        let bits = set_point.to_bits();
        let first = i128::from(bits) - i128::from(self.last);
        let second = first - self.latest[0];
        let third = second - self.latest[1];
        self.latest = [first, second, third];
        for (peak, value) in self.peak.iter_mut().zip(self.latest) {
            *peak = (*peak).max(value.unsigned_abs());
        }
        self.travel += first.unsigned_abs();
        self.lowest = self.lowest.min(bits);
        self.highest = self.highest.max(bits);
        self.last = bits;
    }

    /// Speed, acceleration and jerk at the latest set point (mm/s, mm/s², mm/s³; degrees for rotary axes).
    pub fn latest(&self, cycle_s: f64) -> [f64; 3] {
        rates(self.latest.map(|difference| difference as f64), cycle_s)
    }

    /// The largest magnitudes so far.
    pub fn peak(&self, cycle_s: f64) -> [f64; 3] {
        rates(self.peak.map(|difference| difference as f64), cycle_s)
    }

    /// Distance travelled, back and forth, mm or degrees.
    pub fn travel(&self) -> f64 {
        self.travel as f64 / LSB_PER_MM
    }

    /// Lowest and highest set point.
    pub fn range(&self) -> [f64; 2] {
        [self.lowest as f64 / LSB_PER_MM, self.highest as f64 / LSB_PER_MM]
    }
}

const LSB_PER_MM: f64 = (1_u64 << 32) as f64;

/// The n-th difference over the n-th power of the cycle time.
fn rates(differences: [f64; 3], cycle_s: f64) -> [f64; 3] {
    let [first, second, third] = differences.map(|difference| difference / LSB_PER_MM);
    [first / cycle_s, second / cycle_s / cycle_s, third / cycle_s / cycle_s / cycle_s]
}

/// All about a run that is not kept tick by tick.
pub struct Statistics {
    /// One per axis.
    pub axes: Vec<AxisStatistics>,
    /// Active ticks, which is rows of a trace: the first is the rest at the start.
    pub ticks: u64,
    /// Over the set points of all active ticks.
    pub digest: Digest,
    /// Path length, LSB of [`Distance`], without its wrap.
    pub distance: i128,
    /// The time law of each motion block.
    pub blocks: Vec<PlannedBlock>,
    /// Technology functions, with the tick at which they were due.
    pub functions: Vec<(u64, Event)>,
    last_distance: Distance,
    /// Whether the last tick moved.
    moved: bool,
}

impl Statistics {
    /// Of a machine that stands still.
    pub fn new(start: &[Position]) -> Self {
        Self {
            axes: start.iter().map(|&position| AxisStatistics::at_rest(position)).collect(),
            ticks: 0,
            digest: Digest::new(),
            distance: 0,
            blocks: Vec::new(),
            functions: Vec::new(),
            last_distance: Distance::ZERO,
            moved: false,
        }
    }

    /// Takes in one active tick.
    pub fn add(&mut self, distance: Distance, set_points: &[Position]) {
        self.ticks += 1;
        self.digest.add(set_points);
        self.moved = distance != self.last_distance;
        self.distance += i128::from(distance.to_bits().wrapping_sub(self.last_distance.to_bits()));
        self.last_distance = distance;
        for (axis, &set_point) in self.axes.iter_mut().zip(set_points) {
            axis.add(set_point);
        }
    }

    /// Takes in a function that is due at the last tick.
    pub fn output(&mut self, event: Event) {
        self.functions.push((self.ticks.saturating_sub(1), event));
    }

    /// Adds the rest behind the last tick, so that a stop with a jump is seen in the peaks.
    pub fn finish(&mut self, set_points: &[Position]) {
        for _ in 0..3 {
            for (axis, &set_point) in self.axes.iter_mut().zip(set_points) {
                axis.add(set_point);
            }
        }
    }

    /// Path length in mm.
    pub fn distance_mm(&self) -> f64 {
        self.distance as f64 / (1_u64 << 44) as f64
    }

    /// Program time: from the first set point to the end of the time law, which lies at the last set point or, where
    /// that ends a motion, less than a tick before it.
    pub fn time_s(&self, machine: &Machine) -> f64 {
        let early = match self.blocks.last() {
            Some(block) if self.moved => block.wait.0.to_num::<f64>(),
            _ => 0.0,
        };
        (self.ticks.saturating_sub(1) as f64 - early) * f64::from(machine.channel.cycle_us) / 1e6
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn peaks_are_differences_and_see_a_hard_stop() {
        let mut statistics = Statistics::new(&[Position::ZERO]);
        // 1 mm per tick from rest, and a jump to rest.
        for i in 1..=10 {
            statistics.add(Distance::from_bits(i << 44), &[Position::from_num(-i)]);
        }
        statistics.finish(&[Position::from_num(-10)]);
        let axis = &statistics.axes[0];
        assert_eq!(axis.peak(0.001), [1e3, 1e6, 1e9]);
        assert_eq!((axis.travel(), axis.range()), (10.0, [-10.0, 0.0]));
        assert_eq!((statistics.ticks, statistics.distance_mm()), (10, 10.0));
    }
}

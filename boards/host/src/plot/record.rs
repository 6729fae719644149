//! Records the data for a picture of a run, in bounded memory for every length of the run.
use crate::filtered::Filtered;
use crate::machine::Machine;
use crate::statistics::AxisStatistics;
use glidepath::machine::AxisKind;
use glidepath::quantity::Position;
use glidepath::tick::Telemetry;

/// Highest number of stored points along the path, and of time intervals.
const PLACES: usize = 12_000;
const STRETCHES: usize = 1800;

/// A place of the path.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    /// The axes shown; those that the machine lacks are 0.
    pub at: [f64; 3],
    /// Path speed per second.
    pub speed: f64,
    /// In rapid motion.
    pub rapid: bool,
    /// Direction from the tip of the tool to its holder along the axes shown, under a transformation.
    pub tool: Option<[f64; 3]>,
}

/// A recorded run.
pub struct Picture {
    /// The axes shown: the main axes, where these move.
    pub axes: Vec<usize>,
    /// All axes that move.
    pub moving: Vec<usize>,
    /// The unit of the axes shown.
    pub unit: &'static str,
    /// The path, with the visible resolution.
    pub places: Vec<Place>,
    /// Points nearer than this to the last one are left out.
    spacing: f64,
    low: [f64; 3],
    high: [f64; 3],
    pending: Option<Place>,
    /// Speed of the path, then acceleration and jerk of each axis that moves, then of each axis what its filter
    /// makes of it in percent of AX_DEV, then positions of axes that move beside the path, then with a transformation
    /// the speed of each axis that moves.
    pub envelope: Envelope,
    /// Number of axes with filters (all or none), and of axes in independent motions.
    filtered: usize,
    alone: Vec<usize>,
    /// Whether a transformation makes the axes differ from the path.
    transformed: bool,
    /// By motion block: rapid motion.
    rapid: Vec<bool>,
    /// Ticks at which another block begins, and this block; several blocks may begin within a tick.
    pub entries: Vec<(u64, u32)>,
    ticks: u64,
}

impl Picture {
    /// Nothing recorded yet. Axes that are shown, that move on the path, that move beside it; which blocks are rapid
    /// motion; whether there is a transformation.
    pub fn new(
        machine: &Machine,
        axes: Vec<usize>,
        moving: Vec<usize>,
        (alone, rapid): (Vec<usize>, Vec<bool>),
        transformed: bool,
    ) -> Self {
        let filtered = if Filtered::has(machine) { machine.axes.len() } else { 0 };
        let speeds = if transformed { moving.len() } else { 0 };
        let envelope = Envelope::new(1 + 2 * moving.len() + filtered + alone.len() + speeds);
        let linear = axes.iter().all(|&index| machine.axes[index].kind == AxisKind::Linear);
        Self {
            axes,
            moving,
            unit: if linear { "mm" } else { "°" },
            places: Vec::new(),
            spacing: 0.0,
            low: [f64::INFINITY; 3],
            high: [f64::NEG_INFINITY; 3],
            pending: None,
            envelope,
            filtered,
            alone,
            transformed,
            rapid,
            entries: Vec::new(),
            ticks: 0,
        }
    }

    /// Takes in one tick; the first is the rest at the start.
    pub fn add(
        &mut self,
        telemetry: &Telemetry,
        set_points: &[Position],
        (seen, off): (&[AxisStatistics], &[f64]),
        (cycle_s, tool): (f64, Option<&[f64]>),
    ) {
        const LSB: f64 = (1_u64 << 58) as f64;
        let speed = telemetry.speed.to_bits() as f64 / LSB / cycle_s;
        let mut values = vec![speed as f32];
        for axis in self.moving.iter().filter_map(|&index| seen.get(index)) {
            let [_, accel, jerk] = axis.latest(cycle_s);
            values.extend([accel as f32, jerk as f32]);
        }
        values.extend((0..self.filtered).map(|axis| off.get(axis).copied().unwrap_or(0.0) as f32));
        let at = |axis: &usize| set_points.get(*axis).map_or(0.0, |position| position.to_num());
        values.extend(self.alone.iter().map(at));
        if self.transformed {
            let speed = |index: &usize| seen.get(*index).map_or(0.0, |axis| axis.latest(cycle_s)[0] as f32);
            values.extend(self.moving.iter().map(speed));
        }
        self.envelope.add(&values);

        if self.entries.last().is_none_or(|(_, block)| *block != telemetry.block) {
            self.entries.push((self.ticks, telemetry.block));
        }
        self.ticks += 1;

        let mut at = [0.0; 3];
        for (value, &index) in at.iter_mut().zip(&self.axes) {
            *value = set_points.get(index).map_or(0.0, |position| position.to_num());
        }
        let rapid = self.rapid.get(telemetry.block as usize).copied().unwrap_or(false);
        let along = |tool: &[f64]| {
            let part = |k: usize| self.axes.get(k).and_then(|axis| tool.get(*axis)).copied().unwrap_or(0.0);
            std::array::from_fn(part)
        };
        let tool = tool.map(along);
        self.place(Place { at, speed, rapid, tool });
    }

    /// Axes that move, and the series of their speeds; none without a transformation.
    pub fn speed_series(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        let first = 1 + 2 * self.moving.len() + self.filtered + self.alone.len();
        let moving = self.moving.iter().filter(|_| self.transformed);
        moving.enumerate().map(move |(index, axis)| (*axis, first + index))
    }

    /// Axes with filters, and their series.
    pub fn off_series(&self) -> impl Iterator<Item = (usize, usize)> + use<> {
        let first = 1 + 2 * self.moving.len();
        (0..self.filtered).map(move |axis| (axis, first + axis))
    }

    /// Axes in independent motions, and their series.
    pub fn alone_series(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        let first = 1 + 2 * self.moving.len() + self.filtered;
        self.alone.iter().enumerate().map(move |(index, axis)| (*axis, first + index))
    }

    fn place(&mut self, place: Place) {
        for (axis, &value) in place.at.iter().enumerate() {
            self.low[axis] = self.low[axis].min(value);
            self.high[axis] = self.high[axis].max(value);
        }
        // More than a picture of this size can show.
        let extent = (0..3).map(|axis| self.high[axis] - self.low[axis]).fold(0.0, f64::max);
        self.spacing = self.spacing.max(extent / 1000.0);
        let near = self.places.last().is_some_and(|last| distance(last, &place) < self.spacing);
        self.pending = near.then_some(place);
        if !near {
            self.places.push(place);
        }
        if self.places.len() > PLACES {
            self.spacing *= 2.0;
            let mut kept: Vec<Place> = Vec::with_capacity(PLACES);
            for place in &self.places {
                if kept.last().is_none_or(|last| distance(last, place) >= self.spacing) {
                    kept.push(*place);
                }
            }
            self.places = kept;
        }
    }

    /// Records the path to its very end.
    pub fn path(&self) -> impl Iterator<Item = Place> {
        self.places.iter().copied().chain(self.pending)
    }

    /// Ticks recorded, the first one included.
    pub fn ticks(&self) -> u64 {
        self.ticks
    }
}

fn distance(a: &Place, b: &Place) -> f64 {
    a.at.iter().zip(&b.at).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
}

/// Lowest and highest value of several series in equal time intervals.
pub struct Envelope {
    series: usize,
    /// Ticks per stretch.
    stride: u64,
    /// Ticks already in the last one.
    filled: u64,
    /// Per stretch and series: lowest, highest, mean magnitude.
    spans: Vec<[f32; 3]>,
}

impl Envelope {
    fn new(series: usize) -> Self {
        Self { series, stride: 1, filled: 0, spans: Vec::new() }
    }

    fn add(&mut self, values: &[f32]) {
        if self.filled == self.stride || self.spans.is_empty() {
            if self.len() == STRETCHES {
                self.halve();
            }
            if self.filled == self.stride || self.spans.is_empty() {
                self.spans.extend(values.iter().map(|&value| [value, value, value.abs()]));
                self.filled = 1;
                return;
            }
        }
        let last = self.spans.len() - self.series;
        self.filled += 1;
        let part = 1.0 / self.filled as f32;
        for (span, &value) in self.spans[last..].iter_mut().zip(values) {
            let [low, high, mean] = *span;
            *span = [low.min(value), high.max(value), mean + (value.abs() - mean) * part];
        }
    }

    /// Joins intervals in pairs.
    fn halve(&mut self) {
        let mut joined = Vec::with_capacity(self.spans.len());
        for pair in self.spans.chunks(2 * self.series) {
            let (first, second) = pair.split_at(self.series);
            joined.extend(
                first.iter().zip(second).map(|(a, b)| [a[0].min(b[0]), a[1].max(b[1]), (a[2] + b[2]) / 2.0]),
            );
        }
        self.spans = joined;
        self.stride *= 2;
        self.filled = self.stride;
    }

    /// Number of stretches.
    pub fn len(&self) -> usize {
        self.spans.len() / self.series
    }

    /// Ticks from one to the next.
    pub fn stride(&self) -> u64 {
        self.stride
    }

    /// The largest magnitude of one series.
    pub fn peak(&self, index: usize) -> f64 {
        self.series(index).map(|[low, high, _]| high.abs().max(low.abs())).fold(0.0, f64::max)
    }

    /// Lowest and highest values of one series, and the mean of their magnitudes.
    pub fn series(&self, index: usize) -> impl Iterator<Item = [f64; 3]> {
        self.spans.chunks(self.series).map(move |spans| spans[index].map(f64::from))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_run_keeps_its_extremes() {
        let mut envelope = Envelope::new(2);
        for i in 0..1_000_000 {
            let spike = if i == 777_777 { 5.0 } else { 0.0 };
            envelope.add(&[spike, -(i as f32)]);
        }
        assert!(envelope.len() <= STRETCHES && envelope.len() > STRETCHES / 2 - 1);
        assert_eq!(envelope.series(0).filter(|span| span[1] == 5.0).count(), 1);
        let at = envelope.series(0).position(|span| span[1] == 5.0).unwrap_or(0);
        assert_eq!(at as u64, 777_777 / envelope.stride());
        assert_eq!(envelope.series(1).last().map(|span| span[0]), Some(-999_999.0));
        // The mean of a full interval: the mean of its magnitudes.
        let (index, stride) = (3, envelope.stride() as f64);
        let mean = envelope.series(1).nth(index).map_or(0.0, |span| span[2]);
        let expected = (index as f64 + 0.5) * stride - 0.5;
        assert!((mean - expected).abs() < 1e-3 * expected, "{mean} {expected}");
    }
}

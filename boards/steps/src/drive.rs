//! The timer interrupt of a board with step output: takes set points from the interpolator, and writes the
//! words that a timer puts on the port.
use crate::port::{State, Steps};
use glidepath::fir::FilterTick;
use glidepath::machine::MachineData;
use glidepath::quantity::{Distance, Position};
use glidepath::tick::{self, Interpolator};

/// The result of a tick.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Done {
    /// State of the interpolator.
    pub motion: tick::State,
    /// State of the words.
    pub steps: State,
}

/// Step output after an interpolator, and the positions of the axes.
///
/// A tick writes the words for the following tick. So there are three positions: of the axes when the tick begins,
/// at the end of the words that begin now, and at the end of the words that are written now.
///
/// When the planner gives an axis at rest another coordinate, no motor turns. `Drive` recognises the tick of such a
/// change, which no motion can cause: the path rests, and an axis at rest moves further than its acceleration permits.
/// Smaller changes are driven: with 1 m/s² and 1 ms they are below 2 µm.
///
/// Steps that are cut off stay off until the planned motion rests. Then the axes are not at the set points;
/// [`Self::losses`] counts these cases.
#[derive(Clone, Debug)]
pub struct Drive<const AXES: usize, const SLOTS: usize> {
    steps: Steps<AXES, SLOTS>,
    here: [Position; AXES],
    under_way: [Position; AXES],
    written: [Position; AXES],
    distance: Distance,
    /// Axes whose next set point is another coordinate for the same place.
    shifted: [bool; AXES],
    /// Distances that no axis covers in its first tick, LSB 2^-32 mm.
    leaps: [u64; AXES],
    losses: u32,
}

impl<const AXES: usize, const SLOTS: usize> Drive<AXES, SLOTS> {
    /// A drive at rest at `start`, where `steps` stand too. `machine`: the data for which the steps were
    /// made.
    pub fn new(steps: Steps<AXES, SLOTS>, machine: &MachineData<AXES>, start: [Position; AXES]) -> Self {
        let cycle = u128::from(machine.channel.cycle_us);
        // mm/s² · µs² = 10^-12 mm, twice
        let leap = |accel: u32| ((u128::from(accel) * cycle * cycle) << 33).div_ceil(1_000_000_000_000);
        Self {
            steps,
            here: start,
            under_way: start,
            written: start,
            distance: Distance::ZERO,
            shifted: [false; AXES],
            leaps: machine.axes.map(|axis| u64::try_from(leap(axis.a_max)).unwrap_or(u64::MAX)),
            losses: 0,
        }
    }

    /// Writes the words to the set points of `interpolator`, then lets it compute the next ones. Bounded: see
    /// [`Steps::fill`] and [`Interpolator::tick`].
    pub fn tick<F: FilterTick<AXES>, const OVERLAYS: usize>(
        &mut self,
        interpolator: &mut Interpolator<'_, AXES, F, OVERLAYS>,
        words: &mut [u32; SLOTS],
    ) -> Done {
        let points = *interpolator.set_points();
        let before = core::mem::replace(&mut self.written, points);
        self.here = core::mem::replace(&mut self.under_way, before);
        for (axis, (is_shifted, point)) in self.shifted.iter_mut().zip(&points).enumerate() {
            if core::mem::take(is_shifted) {
                self.steps.shift(axis, *point);
                for place in [&mut self.here, &mut self.under_way] {
                    if let Some(place) = place.get_mut(axis) {
                        *place = *point;
                    }
                }
            }
        }
        let was_stopped = self.steps.is_stopped();
        let steps = self.steps.fill(&points, words);
        if steps == State::Stopped && !was_stopped {
            self.losses = self.losses.wrapping_add(1);
        }
        let motion = interpolator.tick();
        let distance = interpolator.telemetry().distance;
        let path_stands = core::mem::replace(&mut self.distance, distance) == distance;
        let next = interpolator.set_points();
        if path_stands && motion == tick::State::Active {
            self.look_for_shifts(&before, &points, next);
        }
        if steps == State::Stopped && motion == tick::State::Idle && *next == points {
            self.steps.stand_at(&points);
        }
        Done { motion, steps }
    }

    /// Finds axes that stood, and are now further away than they can move in a tick.
    fn look_for_shifts(
        &mut self,
        before: &[Position; AXES],
        points: &[Position; AXES],
        next: &[Position; AXES],
    ) {
        let ways = before.iter().zip(points).zip(next).zip(&self.leaps);
        for (is_shifted, (((before, point), next), leap)) in self.shifted.iter_mut().zip(ways) {
            *is_shifted = before == point && next.to_bits().abs_diff(point.to_bits()) > *leap;
        }
    }

    /// Stops all steps after the words already written, until the planned motion rests.
    pub fn cut(&mut self) {
        if !self.steps.is_stopped() {
            self.steps.stop();
            self.losses = self.losses.wrapping_add(1);
        }
    }

    /// How often steps were cut or had no room; the number may wrap. The position is unknown afterwards.
    pub const fn losses(&self) -> u32 {
        self.losses
    }

    /// Positions of the axes when the last tick began.
    pub const fn here(&self) -> &[Position; AXES] {
        &self.here
    }

    /// Positions at the end of the words that began with the last tick.
    pub const fn under_way(&self) -> &[Position; AXES] {
        &self.under_way
    }

    /// The step output.
    pub const fn steps(&self) -> &Steps<AXES, SLOTS> {
        &self.steps
    }
}

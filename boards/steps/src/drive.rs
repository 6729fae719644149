//! The timer interrupt of a board with step output: the interpolator's set points in, port words out.
use crate::port::{State, Steps};
use glidepath::fir::FilterTick;
use glidepath::machine::MachineData;
use glidepath::quantity::{Distance, Position};
use glidepath::tick::{self, Interpolator};

/// What a tick has done.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Done {
    /// Of the interpolator.
    pub motion: tick::State,
    /// Of the words.
    pub steps: State,
}

/// Step output behind an interpolator, and where the axes are.
///
/// A tick writes the words for the tick that follows. So there are three positions: where the axes are when the tick
/// begins, where the words that begin now lead, and where the words that are written now lead.
///
/// Where the planner gives an axis at rest another coordinate, no motor turns. The tick of such a change is like none of a
/// motion: the path stands, and an axis that stood moves further than its acceleration lets it. Changes smaller than that
/// are driven: with 1 m/s² and 1 ms they are below 2 µm.
///
/// Steps that are cut stay cut until the planned motion rests. Then the axes stand somewhere else than the set points
/// say: [`Self::losses`] counts that.
#[derive(Clone, Debug)]
pub struct Drive<const AXES: usize, const SLOTS: usize> {
    steps: Steps<AXES, SLOTS>,
    here: [Position; AXES],
    under_way: [Position; AXES],
    written: [Position; AXES],
    distance: Distance,
    /// Axes that have another coordinate for the same place, by the next set points.
    shifted: [bool; AXES],
    /// Ways that no axis makes in its first tick, LSB 2^-32 mm.
    leaps: [u64; AXES],
    losses: u32,
}

impl<const AXES: usize, const SLOTS: usize> Drive<AXES, SLOTS> {
    /// At rest at `start`, where `steps` stand too. `machine`: the data that the steps were made for.
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

    /// Writes the words that lead to the set points of `interpolator`, then lets it compute the next ones. Bounded: see
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

    /// Which axes stood, and now are further than they can come in a tick.
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

    /// Steps end with the words that are written, until the planned motion rests.
    pub fn cut(&mut self) {
        if !self.steps.is_stopped() {
            self.steps.stop();
            self.losses = self.losses.wrapping_add(1);
        }
    }

    /// Times that steps were cut, or had no room; the number may wrap. The position is not known then.
    pub const fn losses(&self) -> u32 {
        self.losses
    }

    /// Where the axes were when the last tick began.
    pub const fn here(&self) -> &[Position; AXES] {
        &self.here
    }

    /// Where the words lead that began with the last tick.
    pub const fn under_way(&self) -> &[Position; AXES] {
        &self.under_way
    }

    /// The step output.
    pub const fn steps(&self) -> &Steps<AXES, SLOTS> {
        &self.steps
    }
}

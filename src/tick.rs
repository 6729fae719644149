//! Set points of one tick: time to path distance to axis positions.
//!
//! A tick counts inside the piece of time at hand or takes the next one, and evaluates its cubic: that is the path
//! distance. It passes the curves that this distance has left ([`crate::queue::CurveConsumer::follow`]) and
//! evaluates the one it is on ([`crate::queue::Track::at`]). Integers only; no division, no square root, and no loop
//! without a fixed bound.
//!
//! Which piece of time comes next, also where the planner has asked for a change or has come late:
//! [`crate::queue::Timeline`]. At its end the tick marks the actions that are due and shows its result to the
//! operator ([`crate::operator::Operator`]).
//!
//! Behind the path come the overlays: an axis that moves on its own goes where its own motion has it
//! ([`crate::queue::Overlay`]).
//!
//! All that could go wrong is ruled out by the planner: a piece lasts at least one tick, its curve is in
//! the ring, and at most [`crate::queue::MAX_CURVES_PER_TICK`] curves begin within a tick. Without a piece
//! the set points rest.
use crate::fir::{FilterTick, Unfiltered};
use crate::quantity::{Accel, Distance, Position, Speed};
use crate::queue::{OverlayReceiver, Receiver};

/// What the tick just did.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum State {
    /// The set points rest: nothing is planned, or the motion stands in a feed hold or waits for an acknowledgement.
    Idle,
    /// The path rests and set points may still move: filters that settle, motions of single axes.
    Settling,
    /// A set point of the planned motion; dwell time counts.
    Active,
}

/// Path values of the last set point, for traces. Computed on demand, not in the tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Telemetry {
    /// Programmed N number.
    pub n: u32,
    /// Motion blocks since the split, from 0.
    pub block: u32,
    /// Path distance; wraps at ±2^19 mm.
    pub distance: Distance,
    /// Path speed. On a curve over time path is time, and the axes are slower: [`Interpolator::path_slope`].
    pub speed: Speed,
    /// Path acceleration.
    pub accel: Accel,
}

/// The handle of a channel that lives in the timer interrupt.
pub struct Interpolator<'a, const AXES: usize, F = Unfiltered, const OVERLAYS: usize = 0> {
    queue: Receiver<'a, AXES>,
    /// Of the path.
    set_points: [Position; AXES],
    filters: F,
    overlays: [OverlayReceiver<'a>; OVERLAYS],
}

impl<'a, const AXES: usize> Interpolator<'a, AXES> {
    /// At rest at `start`, fed through `queue`. [`crate::channel::Channel::split`] makes one; on its own it
    /// goes with a [`crate::plan::Planning`] that takes motions from another source than an NC program.
    pub fn new(queue: Receiver<'a, AXES>, start: [Position; AXES]) -> Self {
        Self::filtered(queue, start, Unfiltered)
    }
}

impl<'a, const AXES: usize, F: FilterTick<AXES>> Interpolator<'a, AXES, F> {
    /// The same with filters.
    pub fn filtered(queue: Receiver<'a, AXES>, start: [Position; AXES], filters: F) -> Self {
        Self::with_overlays(queue, start, filters, [])
    }
}

impl<'a, const AXES: usize, F: FilterTick<AXES>, const OVERLAYS: usize> Interpolator<'a, AXES, F, OVERLAYS> {
    /// The same with motions of single axes beside the path.
    pub fn with_overlays(
        queue: Receiver<'a, AXES>,
        start: [Position; AXES],
        filters: F,
        overlays: [OverlayReceiver<'a>; OVERLAYS],
    ) -> Self {
        queue.show_start(&start);
        Self { queue, set_points: start, filters, overlays }
    }

    /// Computes the next set point, marks the actions that are due, shows both to the operator. Instructions
    /// on a Cortex-M4F: see `docs/figures.md`; each action that becomes due takes about a dozen more.
    ///
    /// The planner must not interrupt it: an interrupt of higher priority than the planner's on the same
    /// core, or any on another one.
    pub fn tick(&mut self) -> State {
        let Some(distance) = self.queue.begin() else {
            return self.rest();
        };
        if let Some((track, along)) = self.queue.follow(distance) {
            track.at(along, &mut self.set_points);
        }
        let beside = self.overlay();
        self.filters.step(&self.set_points, distance, beside);
        self.queue.show(self.filters.set_points(&self.set_points));
        match self.filters.lag() {
            Some((lag, settled)) => self.queue.pass_later(lag, settled),
            None => self.queue.pass(),
        }
        State::Active
    }

    /// Nothing to do for the path.
    #[inline(never)]
    fn rest(&mut self) -> State {
        let moves = if self.overlay() {
            self.filters.step(&self.set_points, self.queue.distance(), true);
            true
        } else {
            self.filters.rest(&self.set_points)
        };
        self.queue.show(self.filters.set_points(&self.set_points));
        match self.filters.lag() {
            Some((lag, settled)) => self.queue.rest_later(lag, settled, moves),
            None => self.queue.rest(moves),
        }
        if moves { State::Settling } else { State::Idle }
    }

    /// Axes that move beside the path go where their own motions have them; whether one has a motion. Of a
    /// channel without overlays nothing is left of it.
    #[inline(always)]
    fn overlay(&mut self) -> bool {
        self.overlays.iter_mut().fold(false, |moves, overlay| overlay.step(&mut self.set_points) | moves)
    }

    /// The set point of every axis after the last tick, for the drives.
    pub fn set_points(&self) -> &[Position; AXES] {
        self.filters.set_points(&self.set_points)
    }

    /// The same before filters: where the path is.
    pub fn path_points(&self) -> &[Position; AXES] {
        &self.set_points
    }

    /// What every axis travels per path distance at the last set point, LSB 2^-40; `None` on a line or an arc, where
    /// the path distance is what the feed axes travel. On a curve over time it is not ([`Telemetry::speed`]): the
    /// driven speed is the path speed times what the feed axes travel together. Computed on demand, not in the tick.
    pub fn path_slope(&self) -> Option<[i64; AXES]> {
        let (track, along) = self.queue.segments.at_hand(self.queue.distance())?;
        track.slope(along)
    }

    /// Path values of the last set point.
    pub fn telemetry(&self) -> Telemetry {
        let (phase, tick) = self.queue.time.at_hand();
        let n = i64::from(tick);
        let (half, sixth) = (phase.half_accel.to_bits(), phase.sixth_jerk.to_bits());
        let speed = phase.speed.to_bits() + n * (2 * half + 3 * n * sixth);
        let distance = self.queue.distance();
        let segments = &self.queue.segments;
        let (number, block) = segments.peek(distance).map_or((0, 0), |s| (s.n, segments.block_of(s)));
        Telemetry {
            n: number,
            block,
            distance: Distance::from_bits(distance),
            speed: Speed::from_bits(speed),
            accel: Accel::from_bits(2 * half + 6 * n * sixth),
        }
    }
}

//! Set points of one tick: time to path distance to axis positions.
//!
//! A tick counts inside the piece of time at hand or takes the next one, evaluates its cubic, passes the elements
//! the path distance has left, and evaluates the one it is on. Integers only; no division, square root or search.
//!
//! The interrupt counts the ticks that take time of a piece. Before the tick with the number the planner has asked for it
//! leaves the pieces it has and goes on with others; so it does, with a way to a standstill, where what is planned ends at speed:
//! [`crate::queue::Clock`].
//!
//! All that could go wrong is ruled out by the planner: a piece lasts at least one tick, its element is in the ring,
//! at most [`SKIP_PER_TICK`] elements begin within a tick. Without a piece the set points rest.
use crate::control::Control;
use crate::quantity::{Accel, Distance, Position, Speed};
use crate::queue::{MOST, Phase, Receiver, Slot, clock};
use crate::technology::{Output, Technology};

/// Most elements one tick may pass.
pub const SKIP_PER_TICK: u32 = MOST;

/// What the tick just did.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum State {
    /// Nothing is planned: the set point rests. Not part of a motion's time.
    Idle,
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
    /// Path speed.
    pub speed: Speed,
    /// Path acceleration.
    pub accel: Accel,
}

/// The half of a channel that lives in the timer interrupt.
pub struct Interpolator<'a, const AXES: usize> {
    queue: Receiver<'a, AXES>,
    phase: Phase,
    /// Ticks of the piece evaluated.
    done: u16,
    /// It stops, or stands, without the planner.
    stops: bool,
    distance: Distance,
    set_points: [Position; AXES],
}

impl<'a, const AXES: usize> Interpolator<'a, AXES> {
    /// At rest at `start`, fed through `queue`. [`crate::channel::Channel::split`] makes one; on its own it goes with a
    /// [`crate::planning::Planning`] that takes motions from another source than an NC program.
    pub fn new(queue: Receiver<'a, AXES>, start: [Position; AXES]) -> Self {
        Self {
            queue,
            phase: Phase::BLANK,
            done: 0,
            stops: false,
            distance: Distance::ZERO,
            set_points: start,
        }
    }

    /// Computes the next set point. Instructions on a Cortex-M4F: see `docs/figures.md`.
    pub fn tick(&mut self) -> State {
        let instant = self.queue.clock.own();
        if let Some(number) = self.queue.clock.cut(instant) {
            // On its way to a standstill it has left them for good.
            if !self.stops {
                self.queue.phases.jump(number);
                self.done = u16::MAX;
            }
        }
        if self.done >= self.phase.ticks {
            if self.queue.clock.is_end(instant) {
                self.leave();
            }
            let more = if self.stops {
                self.stop()
            } else {
                self.queue.phases.pop_into(&mut self.phase, |phase| phase.ticks > 0)
            };
            if !more {
                return State::Idle;
            }
            self.done = 0;
        }
        let distance = self.phase.at(self.done);
        self.done += 1;
        self.distance = Distance::from_bits(distance);

        if let Some((segment, along)) = self.queue.segments.follow(distance) {
            segment.shape.at(along, &segment.base, &mut self.set_points);
        }
        self.queue.clock.pass();
        State::Active
    }

    /// Goes on with the way to a standstill.
    #[inline(never)]
    fn leave(&mut self) {
        self.queue.control.set_left(true);
        self.queue.reserve.begin(self.queue.clock.first());
        self.stops = true;
    }

    /// The next piece of the way to a standstill; behind it, when the planner has seen it, of what it has put into the queue since.
    #[inline(never)]
    fn stop(&mut self) -> bool {
        if self.queue.control.has_left() {
            return self.queue.reserve.take_into(&mut self.phase);
        }
        self.stops = false;
        self.queue.phases.pop_into(&mut self.phase, |phase| phase.ticks > 0)
    }

    /// Where the operator's commands go.
    pub fn control(&self) -> &'a Control {
        self.queue.control
    }

    /// The set point of every axis after the last tick.
    pub fn set_points(&self) -> &[Position; AXES] {
        &self.set_points
    }

    /// The next function whose point of the motion the last tick has reached or passed. Call it after every tick until it
    /// says `None`, in the interrupt or elsewhere.
    pub fn event(&mut self) -> Option<Output> {
        let event = self.queue.events.peek()?;
        if self.distance.to_bits().wrapping_sub(event.distance.to_bits()) < 0 {
            return None;
        }
        let event = self.queue.events.pop()?;
        self.queue.control.acknowledgements().put_out(event.ticket);
        let tick = (self.queue.clock.own() / clock::TICK).saturating_sub(1);
        Some(Output { tick, n: event.n, function: event.function, waits: event.ticket.waits() })
    }

    /// Hands over all functions that [`Self::event`] has.
    pub fn deliver(&mut self, technology: &mut impl Technology) {
        while let Some(output) = self.event() {
            technology.output(&output);
        }
    }

    /// Path values of the last set point.
    pub fn telemetry(&self) -> Telemetry {
        let n = i64::from(self.done.saturating_sub(1));
        let (half, sixth) = (self.phase.half_accel.to_bits(), self.phase.sixth_jerk.to_bits());
        let speed = self.phase.speed.to_bits() + n * (2 * half + 3 * n * sixth);
        let (number, block) =
            self.queue.segments.peek(self.distance.to_bits()).map_or((0, 0), |s| (s.n, s.block));
        Telemetry {
            n: number,
            block,
            distance: self.distance,
            speed: Speed::from_bits(speed),
            accel: Accel::from_bits(2 * half + 6 * n * sixth),
        }
    }
}

//! Set points of one tick: time to path distance to axis positions.
use crate::quantity::{Accel, Distance, Position, Speed};

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
    /// Motion blocks since program start, from 0.
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
    set_points: [Position; AXES],
    _queue: core::marker::PhantomData<&'a ()>,
}

impl<const AXES: usize> Interpolator<'_, AXES> {
    pub(crate) fn new(start: [Position; AXES]) -> Self {
        Self { set_points: start, _queue: core::marker::PhantomData }
    }

    /// Computes the next set point.
    pub fn tick(&mut self) -> State {
        State::Idle
    }

    /// The set point of every axis after the last tick.
    pub fn set_points(&self) -> &[Position; AXES] {
        &self.set_points
    }

    /// Path values of the last set point.
    pub fn telemetry(&self) -> Telemetry {
        Telemetry::default()
    }
}

//! The one door between planner and interrupt: two static single-producer single-consumer rings, one of curves and
//! one of time. The planner puts an element in before the first piece of time that moves along it.
use crate::path::Shape;
use crate::quantity::{Accel, Distance, Jerk, Position, Speed};
use heapless::spsc::{Consumer, Producer, Queue};

/// Elements handed over.
pub const SEGMENTS: usize = 32;
/// Pieces of time handed over.
pub const PHASES: usize = 64;

/// A curve at its place on the path.
#[derive(Clone, Copy, Debug)]
pub struct Segment<const AXES: usize> {
    /// The curve.
    pub shape: Shape<AXES>,
    /// What its offsets are added to.
    pub base: [Position; AXES],
    /// Path distance of its start.
    pub start: Distance,
    /// Programmed N number.
    pub n: u32,
    /// Motion blocks since program start, from 0.
    pub block: u32,
}

/// A piece of time: path distance as a cubic over `0..ticks` whole ticks,
/// s(n) = distance + n (speed + n (half_accel + n sixth_jerk)).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Phase {
    /// Path distance at its first tick.
    pub distance: Distance,
    /// Speed there.
    pub speed: Speed,
    /// Half the acceleration there.
    pub half_accel: Accel,
    /// A sixth of the jerk.
    pub sixth_jerk: Jerk,
    /// Ticks it lasts, at least 1.
    pub ticks: u16,
}

/// Static memory of the rings; a ring of `N` holds `N` − 1.
pub struct Rings<const AXES: usize> {
    segments: Queue<Segment<AXES>, SEGMENTS>,
    phases: Queue<Phase, PHASES>,
}

/// The planner's end.
pub struct Sender<'a, const AXES: usize> {
    /// Curves.
    pub segments: Producer<'a, Segment<AXES>>,
    /// Pieces of time.
    pub phases: Producer<'a, Phase>,
}

/// The interrupt's end.
pub struct Receiver<'a, const AXES: usize> {
    /// Curves.
    pub segments: Consumer<'a, Segment<AXES>>,
    /// Pieces of time.
    pub phases: Consumer<'a, Phase>,
}

impl<const AXES: usize> Rings<AXES> {
    /// Empty rings.
    pub const fn new() -> Self {
        Self { segments: Queue::new(), phases: Queue::new() }
    }

    /// Both ends.
    pub fn split(&mut self) -> (Sender<'_, AXES>, Receiver<'_, AXES>) {
        let (to_segments, segments) = self.segments.split();
        let (to_phases, phases) = self.phases.split();
        (Sender { segments: to_segments, phases: to_phases }, Receiver { segments, phases })
    }
}

impl<const AXES: usize> Default for Rings<AXES> {
    fn default() -> Self {
        Self::new()
    }
}

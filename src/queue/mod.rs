//! The one door between planner and interrupt: static single-producer single-consumer rings, one of curves, one of
//! time and one of events. The planner puts a curve in when its block goes into the look-ahead, and hands it on before the first piece
//! of time that moves along it.
pub mod clock;
mod course;
mod reserve;
mod ring;

pub use clock::Clock;
pub use course::{Course, Follower, Layer, MOST};
pub use reserve::{Keeper, Reserve, STOP_PIECES, Taker};
pub use ring::{Consumer, Producer, Ring, Slot};

use crate::control::{Control, Ticket};
use crate::math::wide::mul_u32;
use crate::path::Shape;
use crate::quantity::{Accel, Distance, Jerk, Position, Speed};

/// Elements handed on. A tick may pass [`MOST`] of them: two ticks of the shortest blocks. Each takes the room of a curve in the
/// channel, beside those of the look-ahead, and that of a law in the planner.
pub const SEGMENTS: usize = 64;
/// Pieces of time handed over.
pub const PHASES: usize = 256;

/// Events handed over.
pub const EVENTS: usize = 32;

/// Something the application is to do at a point of the motion.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Event {
    /// Path distance of its point.
    pub distance: Distance,
    /// Programmed N number.
    pub n: u32,
    /// What to do.
    pub function: Function,
    /// Its acknowledgement, if the motion waits for one.
    pub(crate) ticket: Ticket,
}

/// Technology functions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Function {
    /// M function.
    M(u16),
    /// H function.
    H(u16),
    /// S: spindle speed, 1/min.
    Spindle(#[cfg_attr(feature = "defmt", defmt(Debug2Format))] Position),
    /// T: tool number.
    Tool(u32),
}

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
    /// Ticks it lasts. 0 is a gate: the interrupt does not pass it, unless by a cut ([`Clock`]).
    pub ticks: u16,
}

impl<const AXES: usize> Segment<AXES> {
    /// Path distance of its end, LSB 2^-44 mm.
    #[inline(always)]
    pub fn end(&self) -> i64 {
        self.start.to_bits().wrapping_add(self.shape.length.to_bits())
    }
}

impl<const AXES: usize> Slot for Segment<AXES> {
    const BLANK: Self =
        Self { shape: Shape::BLANK, base: [Position::ZERO; AXES], start: Distance::ZERO, n: 0, block: 0 };
}

impl Slot for Phase {
    const BLANK: Self = Self {
        distance: Distance::ZERO,
        speed: Speed::ZERO,
        half_accel: Accel::ZERO,
        sixth_jerk: Jerk::ZERO,
        ticks: 0,
    };
}

impl Slot for Event {
    const BLANK: Self =
        Self { distance: Distance::ZERO, n: 0, function: Function::M(0), ticket: Ticket::NONE };
}

impl Phase {
    /// What is left of it behind its first `n` ticks.
    pub fn advance(&mut self, n: u16) {
        let ticks = i64::from(n);
        let (half, sixth) = (self.half_accel.to_bits(), self.sixth_jerk.to_bits());
        let bent = sixth.wrapping_mul(ticks).wrapping_mul(3);
        let gained = half.wrapping_mul(2).wrapping_add(bent).wrapping_mul(ticks);
        self.distance = Distance::from_bits(self.at(n));
        self.speed = Speed::from_bits(self.speed.to_bits().wrapping_add(gained));
        self.half_accel = Accel::from_bits(half.wrapping_add(bent));
        self.ticks = self.ticks.saturating_sub(n);
    }

    /// Path distance at its tick `n`, LSB 2^-44 mm. Runs in the tick.
    #[inline(always)]
    pub fn at(&self, n: u16) -> i64 {
        let times = i64::from(n);
        let slope = self.half_accel.to_bits().wrapping_add(self.sixth_jerk.to_bits().wrapping_mul(times));
        let mean = self.speed.to_bits().wrapping_add(slope.wrapping_mul(times));
        // 2^-58 to 2^-44
        self.distance.to_bits().wrapping_add(mul_u32(mean, u32::from(n), 14))
    }
}

/// Static memory of the rings, for a planner that looks `BLOCKS` blocks ahead.
pub struct Rings<const AXES: usize, const BLOCKS: usize> {
    segments: Course<AXES, BLOCKS>,
    phases: Ring<Phase, PHASES>,
    reserve: Reserve,
    events: Ring<Event, EVENTS>,
    control: Control,
    clock: Clock,
}

/// The planner's end.
pub struct Sender<'a, const AXES: usize> {
    /// Curves.
    pub segments: Layer<'a, AXES>,
    /// Pieces of time.
    pub phases: Producer<'a, Phase, PHASES>,
    /// Those of the way to a standstill: see [`Clock`].
    pub reserve: Keeper<'a>,
    /// Events.
    pub events: Producer<'a, Event, EVENTS>,
    /// Commands of the operator.
    pub control: &'a Control,
    /// Ticks passed, and the cut.
    pub clock: &'a Clock,
}

/// The interrupt's end.
pub struct Receiver<'a, const AXES: usize> {
    /// Curves.
    pub segments: Follower<'a, AXES>,
    /// Pieces of time.
    pub phases: Consumer<'a, Phase, PHASES>,
    /// Those of the way to a standstill: see [`Clock`].
    pub reserve: Taker<'a>,
    /// Events.
    pub events: Consumer<'a, Event, EVENTS>,
    /// Commands of the operator.
    pub control: &'a Control,
    /// Ticks passed, and the cut.
    pub clock: &'a Clock,
}

impl<const AXES: usize, const BLOCKS: usize> Rings<AXES, BLOCKS> {
    /// Memory for rings; all bits zero.
    pub const fn new() -> Self {
        Self {
            segments: Course::new(),
            phases: Ring::new(),
            reserve: Reserve::new(),
            events: Ring::new(),
            control: Control::blank(),
            clock: Clock::blank(),
        }
    }

    /// Both ends of every ring, emptied.
    pub fn split(&mut self) -> (Sender<'_, AXES>, Receiver<'_, AXES>) {
        let (to_segments, segments) = self.segments.split();
        let (to_phases, phases) = self.phases.split();
        let (to_reserve, reserve) = self.reserve.split();
        let (to_events, events) = self.events.split();
        self.control = Control::new();
        self.clock = Clock::new();
        let (control, clock) = (&self.control, &self.clock);
        (
            Sender {
                segments: to_segments,
                phases: to_phases,
                reserve: to_reserve,
                events: to_events,
                control,
                clock,
            },
            Receiver { segments, phases, reserve, events, control, clock },
        )
    }
}

impl<const AXES: usize, const BLOCKS: usize> Default for Rings<AXES, BLOCKS> {
    fn default() -> Self {
        Self::new()
    }
}

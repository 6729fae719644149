//! The memory that planner, interrupt and operator share. The memory is static, and every word has one
//! writer.
//!
//! | file | what is in it |
//! |---|---|
//! | `curves`, `cells` | the ring of curves: the start and the memory of each curve |
//! | `ring` | a ring for one producer and one consumer, used for the pieces of the speed profile |
//! | `time`, `clock` | the interrupt's step from piece to piece; agreement of planner and interrupt on a change of plan |
//! | `reserve` | the pieces of the stop that is always ready, for a planner that gets no time |
//! | `actions` | functions at points of the path |
//! | `status` | the result of each tick, for the operator |
//! | `driven` | how far the axes have really moved, also in curves that are planned over time (feature `driven`) |
//! | `arc_length` | the length of a curve as a function of the path distance (feature `driven`) |
//! | `overlay` | the motion of a single axis |
//! | `word` | words and places, from which the other files are built |
//!
//! When a block enters the look-ahead, the planner writes the block's curve into the ring of curves. Before
//! the first piece of motion on this curve, the planner releases the curve to the interrupt. The operator's
//! commands have words of their own ([`crate::control`]).
mod actions;
#[cfg(feature = "driven")]
mod arc_length;
mod cells;
pub mod clock;
mod curves;
#[cfg(feature = "driven")]
mod driven;
mod overlay;
mod reserve;
mod ring;
mod status;
mod time;
pub mod word;

pub use crate::technology::Function;
pub use actions::{Actions, Lag, Outlet, Scheduler};
pub use cells::{Segment, Track};
pub use clock::Clock;
pub use curves::{CurveConsumer, CurveProducer, CurveRing, MAX_CURVES_PER_TICK};
pub use overlay::{OVERLAY_PHASES, Overlay, OverlayReceiver, OverlaySender, fine, overlay_ends, set_point};
pub use reserve::{Keeper, Reserve, STOP_PIECES, Taker, WAY_PIECES};
pub use ring::{Consumer, Gauge, Producer, Ring, Slot};
pub use status::{Display, Snapshot, Words};
pub use time::{Change, Cut, NotNow, Pieces, Timeline, TooLate, renew};

use crate::control::Control;
use crate::machine::functions;
use crate::math::wide::mul_u32;
use crate::quantity::{Accel, Distance, Jerk, Position, Speed};
use crate::technology::Action;

/// Number of slots for released curves, in addition to the slots for the look-ahead. A slot holds one curve.
/// A tick passes at most [`MAX_CURVES_PER_TICK`] curves, so the slots hold at least one and a half ticks of
/// the shortest blocks. In a small build, an arc or a polynomial takes two slots. There the slots hold two
/// ticks of lines, or one tick of other curves.
pub const SEGMENTS: usize = if functions::IS_SMALL { 34 } else { 48 };
/// Number of pieces in the queue. The profile of a block takes at most seven pieces, that of a short block
/// two or three.
pub const PHASES: usize = if functions::IS_SMALL { 32 } else { 128 };

/// Number of actions (functions of the program at points of the path) that may be pending. A pending action
/// has been read by the planner, and not yet taken by the operator.
pub const ACTIONS: usize = if functions::IS_SMALL { 16 } else { 32 };

/// A function of the program (M, H, S or T) at the point of the path where it becomes due.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct PlacedAction {
    /// Path distance of the point at which the function becomes due.
    pub distance: Distance,
    /// N number of the programmed block.
    pub n: u32,
    /// The function, and whether it needs an acknowledgement.
    pub action: Action,
}

/// A piece of the speed profile: the path distance as a cubic of time, for `ticks` whole ticks. At tick n,
/// s(n) = distance + n (speed + n (half_accel + n sixth_jerk)). Packed, because the queue holds many pieces.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, packed(4))]
pub struct Phase {
    /// Path distance at the first tick of the piece, mm.
    pub distance: Distance,
    /// Path speed at the first tick, mm/tick.
    pub speed: Speed,
    /// Half the path acceleration at the first tick, mm/tick².
    pub half_accel: Accel,
    /// A sixth of the path jerk, mm/tick³; constant in the piece.
    pub sixth_jerk: Jerk,
    /// Number of ticks. 0 marks a barrier: the interrupt stops before a barrier until a change of plan leads
    /// past it ([`Clock`]).
    pub ticks: u16,
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

impl Phase {
    /// Drops the first `n` ticks of the piece: the piece starts later and ends at the same tick. The motion
    /// stays the same.
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

    /// Path distance at tick `n` of the piece, LSB 2^-44 mm. Runs in the tick.
    #[inline(always)]
    pub fn at(&self, n: u16) -> i64 {
        let times = i64::from(n);
        let slope = self.half_accel.to_bits().wrapping_add(self.sixth_jerk.to_bits().wrapping_mul(times));
        let mean = self.speed.to_bits().wrapping_add(slope.wrapping_mul(times));
        // Converts 2^-58 to 2^-44.
        self.distance.to_bits().wrapping_add(mul_u32(mean, u32::from(n), 14))
    }
}

/// Static memory that planner, interrupt and operator share, for a look-ahead of `BLOCKS` blocks.
pub struct Rings<const AXES: usize, const BLOCKS: usize> {
    segments: CurveRing<AXES, BLOCKS>,
    phases: Ring<Phase, PHASES>,
    reserve: Reserve,
    control: Control,
    shared: Shared<AXES>,
}

/// Data of the interrupt outside the rings. They are in one place, so that one register addresses all of
/// them.
#[repr(C)]
struct Shared<const AXES: usize> {
    clock: Clock,
    status: Words<AXES>,
    actions: Actions,
}

/// The planner's side of the shared memory; the planner writes curves, pieces and functions.
pub struct Sender<'a, const AXES: usize> {
    /// Writes the curves of the path.
    pub segments: CurveProducer<'a, AXES>,
    /// Writes the pieces of the speed profile.
    pub phases: Pieces<'a>,
    /// Writes the pieces of the reserve, the stop that is always ready ([`Timeline`]).
    pub reserve: Keeper<'a>,
    /// Writes the functions of the program at their points of the path.
    pub actions: Scheduler<'a>,
    /// Reads the commands of the operator.
    pub control: &'a Control,
    /// The clock of the interrupt, and the tick of a change of plan (the cut).
    pub clock: &'a Clock,
}

/// The interrupt's side of the shared memory; the interrupt reads curves and pieces, and writes the status.
pub struct Receiver<'a, const AXES: usize> {
    /// Reads the curves of the path.
    pub segments: CurveConsumer<'a, AXES>,
    /// Reads the pieces of the speed profile.
    pub time: Timeline<'a>,
    shared: &'a Shared<AXES>,
}

impl<const AXES: usize> Receiver<'_, AXES> {
    /// Begins a tick. Returns its path distance and writes it to the status; `None` if there is no piece.
    #[inline(always)]
    pub fn begin(&mut self) -> Option<i64> {
        let Shared { clock, status, .. } = self.shared;
        let distance = self.time.begin(clock)?;
        status.show_distance(distance);
        Some(distance)
    }

    /// The curve at a path distance, and the distance from the start of the curve. Writes N number and block
    /// to the status.
    #[inline(always)]
    pub fn follow(&mut self, distance: i64) -> Option<(Track<'_, AXES>, i64)> {
        let (track, along) = self.segments.follow(distance)?;
        self.shared.status.show_curve(track.segment.n, track.segment.block());
        Some((track, along))
    }

    /// Writes the set points of a tick to the status, mm or degrees.
    #[inline(always)]
    pub fn show(&self, set_points: &[Position; AXES]) {
        let Shared { clock, status, .. } = self.shared;
        status.show_points(clock.tick(), set_points);
    }

    /// Writes the set points before the first tick to the status, so that the operator reads the start
    /// position.
    pub fn show_start(&self, set_points: &[Position; AXES]) {
        [0, 1].iter().for_each(|tick| self.shared.status.show_points(*tick, set_points));
    }

    /// Ends a tick that had a piece: functions whose point the path has reached become due.
    #[inline(always)]
    pub fn pass(&mut self) {
        let Shared { clock, status, actions } = self.shared;
        if actions.is_armed() {
            actions.reach(status.distance(), clock.tick());
        }
        clock.pass();
    }

    /// Ends a tick without a piece: actions at the point where the path stands become due. `moves`: set
    /// points move although the path stands still.
    pub fn rest(&mut self, moves: bool) {
        let Shared { clock, actions, .. } = self.shared;
        actions.reach(self.distance(), clock.tick());
        clock.rest_while(moves);
    }

    /// As [`Self::pass`], with filters after the path: a function becomes due when the filtered axes reach
    /// its point, which is later than the path does. `settled`: whether the axes have stopped.
    #[inline(always)]
    pub fn pass_later(&mut self, lag: &mut Lag, settled: bool) {
        let Shared { clock, status, actions } = self.shared;
        if actions.is_armed() {
            actions.reach_later(status.distance(), clock.tick(), lag, settled);
        }
        clock.pass();
    }

    /// As [`Self::rest`], with filters after the path. `settled`: whether the axes have stopped. `moves`: set
    /// points still move.
    pub fn rest_later(&mut self, lag: &mut Lag, settled: bool, moves: bool) {
        let Shared { clock, actions, .. } = self.shared;
        actions.reach_later(self.distance(), clock.tick(), lag, settled);
        clock.rest_while(moves);
    }

    /// Path distance of the last tick that had a piece, LSB 2^-44 mm.
    pub fn distance(&self) -> i64 {
        self.shared.status.distance()
    }

    /// Distance that the feed axes have driven up to the path distance [`Self::distance`], LSB 2^-44 mm.
    #[cfg(feature = "driven")]
    pub fn driven(&self) -> i64 {
        self.segments.driven(self.distance())
    }
}

/// The operator's side of the shared memory; the operator writes commands, and reads functions and the
/// status.
pub struct Panel<'a, const AXES: usize> {
    /// Writes commands of the operator.
    pub control: &'a Control,
    /// Reads the functions that are due.
    pub actions: Outlet<'a>,
    /// Reads the status of the last tick.
    pub status: Display<'a, AXES>,
    /// The driven distance of each curve.
    #[cfg(feature = "driven")]
    drives: driven::Drives<'a>,
}

impl<const AXES: usize> Panel<'_, AXES> {
    /// The status of the last tick, and the distance that the feed axes have driven by the end of this tick.
    #[cfg(feature = "driven")]
    pub fn read(&self) -> (Snapshot<AXES>, Distance) {
        let mut driven = 0;
        let seen = self.status.read_with(|distance| driven = self.drives.at(distance.to_bits()));
        (seen, Distance::from_bits(driven))
    }
}

impl<const AXES: usize, const BLOCKS: usize> Rings<AXES, BLOCKS> {
    /// Empty memory. All bits are zero, so a static variable needs no data in flash.
    pub const fn new() -> Self {
        Self {
            segments: CurveRing::new(),
            phases: Ring::new(),
            reserve: Reserve::blank(),
            control: Control::blank(),
            shared: Shared { clock: Clock::blank(), status: Words::blank(), actions: Actions::blank() },
        }
    }

    /// Empties the memory and returns the handles of planner, interrupt and operator.
    pub fn split(&mut self) -> (Sender<'_, AXES>, Receiver<'_, AXES>, Panel<'_, AXES>) {
        let Self { segments, phases, reserve, control, shared } = self;
        shared.clock.reset();
        shared.actions.reset();
        (*control, shared.status) = (Control::new(), Words::blank());
        let (control, shared) = (&*control, &*shared);
        let Shared { clock, status, actions } = shared;
        let (to_segments, segments) = segments.split();
        let (to_phases, phases) = phases.split();
        let (to_reserve, reserve) = reserve.split();
        let (to_actions, outlet) = actions.ends();
        let display = Display::new(status, clock, to_phases.gauge(), to_segments.latest_word());
        #[cfg(feature = "driven")]
        let drives = to_segments.drives();
        (
            Sender {
                segments: to_segments,
                phases: to_phases,
                reserve: to_reserve,
                actions: to_actions,
                control,
                clock,
            },
            Receiver { segments, time: Timeline::new(phases, reserve), shared },
            Panel {
                control,
                actions: outlet,
                status: display,
                #[cfg(feature = "driven")]
                drives,
            },
        )
    }
}

impl<const AXES: usize, const BLOCKS: usize> Default for Rings<AXES, BLOCKS> {
    fn default() -> Self {
        Self::new()
    }
}

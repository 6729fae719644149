//! The interpolator: one set point per axis and tick, for the timer interrupt.
//!
//! ```
//! use glidepath::{AxisData, AxisKind, AxisName, Channel, ChannelData, Handles};
//! use glidepath::{MachineData, Position, Progress, State};
//!
//! let axis = AxisData::new(AxisName::new("X").unwrap(), AxisKind::Linear);
//! let machine = MachineData { axes: [axis], channel: ChannelData::new() };
//! let mut memory = Channel::<1, 120>::new();
//! let program: &[u8] = b"G01 X1 F600\nM30\n";
//! let handles = memory.split(&machine, [Position::ZERO], program).unwrap();
//! let Handles { mut planner, mut interpolator, .. } = handles;
//! while !matches!(planner.poll().unwrap(), Progress::Waiting | Progress::Done) {}
//!
//! // In the timer interrupt: write first, so that the moment of output does not vary; then compute.
//! let mut to_the_drives = Vec::new();
//! loop {
//!     to_the_drives.push(interpolator.set_points()[0]);
//!     if interpolator.tick() == State::Idle {
//!         break;
//!     }
//! }
//! assert_eq!(to_the_drives.last(), Some(&Position::from_num(1)));
//! ```
//!
//! A tick calculates in integers: no division, no square root, no loop without a fixed bound. A tick has
//! these steps:
//!
//! 1. When the current piece of the speed profile is used up, the tick takes the next piece
//!    ([`crate::queue::Timeline`]). A change of plan happens in this step. If the queue is empty, the tick
//!    takes the pieces of the reserve, the stop that is always ready. Without any piece, the path stands
//!    still, and steps 2 and 3 are left out.
//! 2. The tick evaluates the cubic polynomial of the piece. The value is the path distance.
//! 3. The tick drops the curves that the motion has passed ([`crate::queue::CurveConsumer::follow`]) and
//!    evaluates the current curve ([`crate::queue::Track::at`]). The values are the set points of the path.
//! 4. Axes that move alone get their set points from their own motion ([`crate::queue::Overlay`]).
//! 5. The filters of the axes, if there are any, smooth the set points of steps 3 and 4 ([`crate::fir`]).
//! 6. The tick writes the set points for the operator ([`crate::operator::Operator`]), and marks the
//!    functions whose point of the path has been reached. With filters, a function is marked later, when the
//!    filtered axes reach the point.
//!
//! The planner guarantees three conditions for the tick. A piece lasts at least one tick. The curve of a
//! piece is in the ring of curves. At most [`crate::queue::MAX_CURVES_PER_TICK`] curves begin within a tick.
use crate::fir::{FilterTick, Unfiltered};
use crate::quantity::{Accel, Distance, Position, Speed};
use crate::queue::{OverlayReceiver, Receiver};

/// What the axes did in a tick; the result of [`Interpolator::tick`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum State {
    /// The axes stand still. Either nothing is planned, or the motion is stopped by a feed hold, or it waits
    /// for an acknowledgement.
    Idle,
    /// The path stands still, but axes may still move: filters settle, or single axes have their own motion.
    Settling,
    /// The tick gave a set point of the planned motion. Dwell time counts as motion.
    Active,
}

/// Path values at the last set point, for traces; [`Interpolator::telemetry`] computes them on demand, not in
/// the tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Telemetry {
    /// N number of the programmed block.
    pub n: u32,
    /// Number of the motion block, counted from 0 since `Channel::split`.
    pub block: u32,
    /// Path distance as planned; wraps around at ±2^19 mm. In a curve that is planned over time, such as a
    /// rounded corner, the axes drive less; `Interpolator::driven_distance` (feature `driven`) returns how
    /// far.
    pub distance: Distance,
    /// Path speed, mm/tick. In a curve that is planned over time, the axes are slower than this value: see
    /// [`Interpolator::path_slope`].
    pub speed: Speed,
    /// Acceleration along the path, mm/tick².
    pub accel: Accel,
}

/// The handle of the timer interrupt: computes the set points of one tick per call of [`Self::tick`].
pub struct Interpolator<'a, const AXES: usize, F = Unfiltered, const OVERLAYS: usize = 0> {
    queue: Receiver<'a, AXES>,
    /// Set points of the path.
    set_points: [Position; AXES],
    filters: F,
    overlays: [OverlayReceiver<'a>; OVERLAYS],
}

impl<'a, const AXES: usize> Interpolator<'a, AXES> {
    /// Makes an interpolator whose axes are at `start` and which reads from `queue`. An application gets its
    /// interpolator from [`crate::channel::Channel::split`]. Without a channel, the interpolator serves a
    /// [`crate::plan::Planning`] whose motions do not come from an NC program.
    pub fn new(queue: Receiver<'a, AXES>, start: [Position; AXES]) -> Self {
        Self::filtered(queue, start, Unfiltered)
    }
}

impl<'a, const AXES: usize, F: FilterTick<AXES>> Interpolator<'a, AXES, F> {
    /// As [`Interpolator::new`], with FIR filters of the axes after the path.
    pub fn filtered(queue: Receiver<'a, AXES>, start: [Position; AXES], filters: F) -> Self {
        Self::with_overlays(queue, start, filters, [])
    }
}

impl<'a, const AXES: usize, F: FilterTick<AXES>, const OVERLAYS: usize> Interpolator<'a, AXES, F, OVERLAYS> {
    /// As [`Self::filtered`], with axes that may move independently of the path. `overlays`: one entry for
    /// each axis that can move independently at the same time.
    pub fn with_overlays(
        queue: Receiver<'a, AXES>,
        start: [Position; AXES],
        filters: F,
        overlays: [OverlayReceiver<'a>; OVERLAYS],
    ) -> Self {
        queue.show_start(&start);
        Self { queue, set_points: start, filters, overlays }
    }

    /// Computes the next set points, marks the functions that are due, and writes both for the operator.
    ///
    /// Cost: `docs/figures.md` counts the instructions on a Cortex-M4F. Each function that becomes due takes
    /// about a dozen more instructions.
    ///
    /// The planner must not interrupt this call. Call `tick` from an interrupt of higher priority than the
    /// planner, or on another core.
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

    /// Ends a tick in which the path stands still.
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

    /// Writes the set points of single axes. Returns whether an axis has its own motion. In a channel without
    /// overlays, the compiler removes this call.
    #[inline(always)]
    fn overlay(&mut self) -> bool {
        self.overlays.iter_mut().fold(false, |moves, overlay| overlay.step(&mut self.set_points) | moves)
    }

    /// The set points of the last tick, for the drives: mm or degrees, one per axis.
    pub fn set_points(&self) -> &[Position; AXES] {
        self.filters.set_points(&self.set_points)
    }

    /// The set points of the last tick before the filters of the axes, mm or degrees. Without filters they
    /// equal [`Self::set_points`].
    pub fn path_points(&self) -> &[Position; AXES] {
        &self.set_points
    }

    /// How far each axis travels per path distance at the last set point, LSB 2^-40. Returns `None` on a line
    /// or an arc: there, path distance is the travel of the feed axes.
    ///
    /// In a curve that is planned over time, the driven speed is [`Telemetry::speed`] times the length of
    /// this vector over the feed axes. The value is computed on demand and not in the tick.
    pub fn path_slope(&self) -> Option<[i64; AXES]> {
        let (track, along) = self.queue.segments.at_hand(self.queue.distance())?;
        track.slope(along)
    }

    /// Distance that the feed axes have driven, as in [`crate::operator::Status`]; wraps around at ±2^19 mm.
    /// The value is computed on demand, in `f32`, and not in the tick.
    #[cfg(feature = "driven")]
    pub fn driven_distance(&self) -> Distance {
        Distance::from_bits(self.queue.driven())
    }

    /// N number, block number, path distance, speed and acceleration at the last set point, from the plan. In
    /// a curve that is planned over time, the axes move less than the path distance: see [`Telemetry`].
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

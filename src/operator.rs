//! The handle `Operator`: gives commands and acknowledgements, takes the functions that are due, and reads
//! the status.
//!
//! One task owns this handle: a PLC task, a serial task, or a task on another core. No call waits for the
//! planner or the interrupt. Planner and interrupt never wait for the operator.
//!
//! ```
//! use glidepath::{AxisData, AxisKind, AxisName, Channel, ChannelData, Function, Handles};
//! use glidepath::{MachineData, Position, Progress, State};
//!
//! let axis = AxisData::new(AxisName::new("X").unwrap(), AxisKind::Linear);
//! let machine = MachineData { axes: [axis], channel: ChannelData::new() };
//! let program: &[u8] = b"N10 G01 X10 F1000\nN20 M8\nN30 X20\nM30\n";
//! let mut memory = Channel::<1, 120>::new();
//! let Handles { mut planner, mut interpolator, operator } =
//!     memory.split(&machine, [Position::ZERO], program).unwrap();
//!
//! operator.set_override(500); // 50.0 %
//! let mut functions = Vec::new();
//! let mut is_planned = false;
//! while !(is_planned && interpolator.tick() == State::Idle) {
//!     match planner.poll().unwrap() {
//!         Progress::Done => is_planned = true,
//!         Progress::Waiting => _ = interpolator.tick(),
//!         _ => {}
//!     }
//!     // In the task of the operator, as often as it can:
//!     while let Some(output) = operator.output() {
//!         functions.push((output.n, output.function));
//!     }
//! }
//! assert!(functions.contains(&(20, Function::M(8))));
//! let status = operator.status();
//! assert_eq!((status.n, status.state, status.set_points), (30, State::Idle, [Position::from_num(20)]));
//! ```
use crate::control::{Commands, Control, Unexpected};
use crate::path::Measure;
use crate::quantity::{Distance, Position, Speed};
use crate::queue::{Outlet, Panel};
use crate::technology::{Action, Function, Output, Technology};
use crate::tick::State;
use core::cell::Cell;
use core::marker::PhantomData;

/// The result of the last tick, as [`Operator::status`] returns it. All fields belong to the same tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Status<const AXES: usize> {
    /// The set point of every axis after the last tick, mm or degrees.
    pub set_points: [Position; AXES],
    /// N number of the programmed block on which the axes are.
    pub n: u32,
    /// Number of the motion block on which the axes are, counted from 0 since `Channel::split`.
    pub block: u32,
    /// Distance that the feed axes have driven; wraps around at ±2^19 mm. Without the feature `driven`, this
    /// field is the path distance as planned.
    pub distance: Distance,
    /// Path distance as planned; wraps around at ±2^19 mm. In a curve that is planned over time, such as a
    /// rounded corner, the path distance is time multiplied by the feed.
    #[cfg(feature = "driven")]
    pub planned: Distance,
    /// Mean speed of the set points over the last tick, along the feed axes; 0 at standstill. If no feed axis
    /// moves, the main axes count; if no main axis moves, all axes count. Resolution 2^-44 mm per tick.
    pub speed: Speed,
    /// Whether the axes moved in the last tick: the result of
    /// [`Interpolator::tick`](crate::tick::Interpolator::tick).
    pub state: State,
    /// Number of planned pieces of the speed profile that are still unused, 0…128 (0…32 in a small build).
    /// While the planner adds pieces, the count may be two too low.
    pub queued: u16,
    /// Number of ticks since `Channel::split`, with and without motion of the path; modulo 2^31. The last
    /// tick has the number `ticks` − 1, as in [`Output::tick`].
    pub ticks: u32,
}

/// Gives commands to a channel and shows the state of the motion. The handle is `Send` and not `Sync`: only
/// one task or interrupt at a time owns it.
///
/// A task calls [`Self::output`] as often as it can and acknowledges the functions that wait. An application without
/// such a task moves the operator into the timer interrupt and calls [`Self::deliver`] after every tick.
pub struct Operator<'a, const AXES: usize> {
    panel: Panel<'a, AXES>,
    measure: Measure,
    sole: PhantomData<Cell<()>>,
}

impl<'a, const AXES: usize> Operator<'a, AXES> {
    /// Makes an operator for the queue between planner and interrupt. `measure` selects the axes along which the
    /// speed counts. An application gets its operator from [`crate::channel::Channel::split`].
    pub const fn new(panel: Panel<'a, AXES>, measure: Measure) -> Self {
        Self { panel, measure, sole: PhantomData }
    }

    const fn control(&self) -> &'a Control {
        self.panel.control
    }

    /// Sets the feed override, in steps of 0.1 %: 500 is 50 %. Values above 2000 count as 2000. The override acts on
    /// feed and rapid motion; P-CHAN-00066 selects how. With 0 the axes stop on the path, as in a feed hold.
    pub fn set_override(&self, feed: u16) {
        self.control().set_override(feed);
    }

    /// Stops the axes on the path, as soon as the limits of the axes permit.
    pub fn feed_hold(&self) {
        self.control().set_hold(true);
    }

    /// Ends a [`Self::feed_hold`]: the motion resumes.
    pub fn resume(&self) {
        self.control().set_hold(false);
    }

    /// Stops the axes and drops the rest of the program. An abort ends a feed hold. A feed hold that is given after the
    /// abort holds the next program.
    pub fn abort(&self) {
        self.control().abort();
    }

    /// Switches reduced speed (P-AXIS-00214) on or off.
    pub fn set_reduced(&self, reduced: bool) {
        self.control().set_reduced(reduced);
    }

    /// The commands in force.
    pub fn commands(&self) -> Commands {
        self.control().commands()
    }

    /// Returns the next function whose point on the path has been reached. Call `output` until it returns
    /// `None`.
    ///
    /// At most 32 functions can be pending, 16 in a small build. If few places are free, the look-ahead gets
    /// shorter. If no place is free, the axes stop.
    pub fn output(&self) -> Option<Output> {
        let outlet: &Outlet<'a> = &self.panel.actions;
        let (placed, tick) = outlet.take()?;
        let Action::Out(function, ticket) = placed.action;
        self.control().acknowledgements().put_out(ticket);
        Some(Output { tick, n: placed.n, function, waits: ticket.waits() })
    }

    /// Passes all due functions to `technology`.
    pub fn deliver(&self, technology: &mut impl Technology) {
        while let Some(output) = self.output() {
            technology.output(&output);
        }
    }

    /// Acknowledges a function. If the same function has been output several times, the call acknowledges the
    /// first of these outputs.
    ///
    /// # Errors
    /// Returns [`Unexpected`] if no output of the function waits for an acknowledgement; nothing changes
    /// then.
    pub fn acknowledge(&self, function: Function) -> Result<(), Unexpected> {
        self.control().acknowledge(function)
    }

    /// The oldest M or H function that has been output and still waits for an acknowledgement.
    pub fn awaited(&self) -> Option<Function> {
        self.control().acknowledgements().awaited()
    }

    /// The result of the last tick. If a tick comes during the call, the call reads again. On the interrupt's
    /// core, one or two repetitions suffice. On another core, the call repeats until the tick ends.
    pub fn status(&self) -> Status<AXES> {
        #[cfg(feature = "driven")]
        let (seen, distance) = self.panel.read();
        #[cfg(not(feature = "driven"))]
        let seen = self.panel.status.read();
        #[cfg(not(feature = "driven"))]
        let distance = seen.distance;
        let state = match (seen.moved, seen.settles) {
            (true, _) => State::Active,
            (false, true) => State::Settling,
            (false, false) => State::Idle,
        };
        let mut travel = [0; AXES];
        for (travel, (to, from)) in travel.iter_mut().zip(seen.set_points.iter().zip(&seen.before)) {
            *travel = to.to_bits().wrapping_sub(from.to_bits());
        }
        Status {
            set_points: seen.set_points,
            n: seen.n,
            block: seen.block,
            distance,
            #[cfg(feature = "driven")]
            planned: seen.distance,
            // Converts from 2^-44 to 2^-58 mm per tick.
            speed: Speed::from_bits(self.measure.path(&travel).to_bits().saturating_mul(1 << 14)),
            state,
            queued: seen.queued,
            ticks: seen.ticks,
        }
    }
}

//! The third handle of a channel: commands, functions that are due, acknowledgements, and the status.
//!
//! It belongs to whoever watches the motion from outside: a PLC task, a serial task, another core. Nothing in
//! it waits for the planner or the interrupt, and neither waits for it.
use crate::control::{Commands, Control, Unexpected};
use crate::path::Measure;
use crate::quantity::{Distance, Position, Speed};
use crate::queue::{Outlet, Panel};
use crate::technology::{Action, Function, Output, Technology};
use crate::tick::State;
use core::cell::Cell;
use core::marker::PhantomData;

/// What the interrupt did last. All of it belongs to one tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Status<const AXES: usize> {
    /// The set point of every axis.
    pub set_points: [Position; AXES],
    /// Programmed N number.
    pub n: u32,
    /// Motion blocks since the split, from 0.
    pub block: u32,
    /// Path distance as planned; wraps at ±2^19 mm. A curve over time counts the time that it takes at the feed.
    pub distance: Distance,
    /// Speed of the set points along the feed axes, the mean over the last tick; 0 at rest. Where no feed axis moves it
    /// is that along the main axes, and where none of these moves that of all axes. To 2^-44 mm per tick.
    pub speed: Speed,
    /// What the last tick said.
    pub state: State,
    /// Pieces of time in the queue, 0…256: those the planner is ahead by. Two pieces that the planner puts in
    /// meanwhile may count or not.
    pub queued: u16,
    /// Ticks since the split, whether the path moved in them or not; modulo 2^31. The last one has the number
    /// `ticks` − 1, as in [`Output::tick`].
    pub ticks: u32,
}

/// Gives commands to a channel and sees what it does. `Send`, not `Sync`: one context at a time holds it, so
/// that every word has one writer.
///
/// The usual way: a task takes functions by [`Self::output`] as often as it can and acknowledges those that
/// wait. An application without such a task moves it into the interrupt, beside the interpolator, and calls
/// [`Self::deliver`] behind every tick.
pub struct Operator<'a, const AXES: usize> {
    panel: Panel<'a, AXES>,
    measure: Measure,
    sole: PhantomData<Cell<()>>,
}

impl<'a, const AXES: usize> Operator<'a, AXES> {
    /// Of the queue between planner and interrupt; `measure`: the axes along which the speed counts.
    /// [`crate::channel::Channel::split`] makes one.
    pub const fn new(panel: Panel<'a, AXES>, measure: Measure) -> Self {
        Self { panel, measure, sole: PhantomData }
    }

    const fn control(&self) -> &'a Control {
        self.panel.control
    }

    /// Feed override, LSB 0.1 %; more than 200 % is 200 %. It acts on feed and rapid motion; P-CHAN-00066
    /// says how. With 0 the motion stands still on the path, as in a feed hold.
    pub fn set_override(&self, feed: u16) {
        self.control().set_override(feed);
    }

    /// Stand still on the path as soon as the limits allow.
    pub fn feed_hold(&self) {
        self.control().set_hold(true);
    }

    /// End of [`Self::feed_hold`].
    pub fn resume(&self) {
        self.control().set_hold(false);
    }

    /// Stand still and forget the rest of the program. It ends a hold; a hold that is given behind it counts
    /// for what comes then.
    pub fn abort(&self) {
        self.control().abort();
    }

    /// Reduced speed (P-AXIS-00214) on or off.
    pub fn set_reduced(&self, reduced: bool) {
        self.control().set_reduced(reduced);
    }

    /// The commands as they stand.
    pub fn commands(&self) -> Commands {
        self.control().commands()
    }

    /// The next function whose point of the motion a tick has reached or passed. Call it until it says
    /// `None`: there is room for 32 in all, in a small build for 16. The fewer are free the less far the planner
    /// looks ahead, and with none the motion comes to a standstill.
    pub fn output(&self) -> Option<Output> {
        let outlet: &Outlet<'a> = &self.panel.actions;
        let (placed, tick) = outlet.take()?;
        let Action::Out(function, ticket) = placed.action;
        self.control().acknowledgements().put_out(ticket);
        Some(Output { tick, n: placed.n, function, waits: ticket.waits() })
    }

    /// Hands over all functions that [`Self::output`] has.
    pub fn deliver(&self, technology: &mut impl Technology) {
        while let Some(output) = self.output() {
            technology.output(&output);
        }
    }

    /// Acknowledges a function. If it was put out more than once, that put out first.
    ///
    /// # Errors
    /// Nothing waits for it: it was not put out yet, or it is acknowledged already. It is ignored.
    pub fn acknowledge(&self, function: Function) -> Result<(), Unexpected> {
        self.control().acknowledge(function)
    }

    /// The function put out first of those that are not acknowledged.
    pub fn awaited(&self) -> Option<Function> {
        self.control().acknowledgements().awaited()
    }

    /// What the last tick did. Reads again if a tick comes in between: on the interrupt's core at most once
    /// or twice, on another one while a tick is at hand.
    pub fn status(&self) -> Status<AXES> {
        let seen = self.panel.status.read();
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
            distance: seen.distance,
            // 2^-44 to 2^-58 mm per tick
            speed: Speed::from_bits(self.measure.path(&travel).to_bits().saturating_mul(1 << 14)),
            state,
            queued: seen.queued,
            ticks: seen.ticks,
        }
    }
}

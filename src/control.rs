//! What may come from outside while the motion runs: override, feed hold, resume, abort, reduced speed of an operator,
//! acknowledgements of functions.
//!
//! Feed hold, resume and abort act; override and reduced speed are not followed yet.
//!
//! Commands are atomics: any context may give them at any time, without a lock and without waiting. They act where
//! the time law is not yet handed to the interrupt, see [`crate::planning`].
mod acknowledge;

pub use acknowledge::Unexpected;
pub(crate) use acknowledge::{OPEN, Ticket};

use crate::queue::Function;
use acknowledge::Acknowledgements;
use core::sync::atomic::{AtomicU8, AtomicU16, Ordering};

/// Highest override: 200 %, LSB 0.1 %.
pub const MAX_OVERRIDE: u16 = 2000;

/// 100 %.
pub const FULL_OVERRIDE: u16 = 1000;

const HOLD: u8 = 1;
const ABORT: u8 = 2;
const REDUCED: u8 = 4;
/// An acknowledgement came that the planner has not looked at.
const ANSWERED: u8 = 8;

/// Commands to a running channel. Shared by all who give them and the planner that follows them.
pub struct Control {
    feed: AtomicU16,
    flags: AtomicU8,
    acknowledgements: Acknowledgements,
}

/// The commands as they stand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Commands {
    /// Feed override, 0…2000, LSB 0.1 %.
    pub feed: u16,
    /// The motion is to stand still on the path.
    pub hold: bool,
    /// The rest of the program is not wanted.
    pub abort: bool,
    /// Every axis keeps its reduced speed (P-AXIS-00214).
    pub reduced: bool,
}

impl Control {
    /// Full override, no hold.
    pub const fn new() -> Self {
        Self {
            feed: AtomicU16::new(FULL_OVERRIDE),
            flags: AtomicU8::new(0),
            acknowledgements: Acknowledgements::new(),
        }
    }

    /// Feed override, LSB 0.1 %; more than 200 % is 200 %.
    pub fn set_override(&self, feed: u16) {
        self.feed.store(feed.min(MAX_OVERRIDE), Ordering::Relaxed);
    }

    /// Stand still on the path as soon as the limits allow.
    pub fn feed_hold(&self) {
        self.set(HOLD, true);
    }

    /// End of [`Self::feed_hold`].
    pub fn resume(&self) {
        self.set(HOLD, false);
    }

    /// Stand still and forget the rest of the program; ends a hold too.
    pub fn abort(&self) {
        self.set(ABORT, true);
    }

    /// Reduced speed (P-AXIS-00214) on or off.
    pub fn set_reduced(&self, reduced: bool) {
        self.set(REDUCED, reduced);
    }

    /// Acknowledges a function. If it was put out more than once, that put out first.
    ///
    /// # Errors
    /// Nothing waits for it: it was not put out yet, or it is acknowledged already. It is ignored.
    pub fn acknowledge(&self, function: Function) -> Result<(), Unexpected> {
        self.acknowledgements.answer(function)?;
        self.set(ANSWERED, true);
        Ok(())
    }

    /// The function put out first of those that are not acknowledged.
    pub fn awaited(&self) -> Option<Function> {
        self.acknowledgements.awaited()
    }

    /// The commands as they stand.
    pub fn commands(&self) -> Commands {
        let flags = self.flags.load(Ordering::Relaxed);
        Commands {
            feed: self.feed.load(Ordering::Relaxed),
            hold: flags & HOLD != 0,
            abort: flags & ABORT != 0,
            reduced: flags & REDUCED != 0,
        }
    }

    /// Whether the motion is to stand still, or an acknowledgement to be looked at.
    #[inline(always)]
    pub(crate) fn wants_attention(&self) -> bool {
        self.flags.load(Ordering::Relaxed) & (HOLD | ABORT | ANSWERED) != 0
    }

    /// Whether the motion is to stand still.
    pub(crate) fn wants_standstill(&self) -> bool {
        self.flags.load(Ordering::Relaxed) & (HOLD | ABORT) != 0
    }

    /// Whether an acknowledgement is to be looked at.
    pub(crate) fn is_answered(&self) -> bool {
        self.flags.load(Ordering::Relaxed) & ANSWERED != 0
    }

    /// The tickets acknowledged, which are free again. For the planner.
    pub(crate) fn take_answers(&self) -> u32 {
        // What comes behind this sets the flag again.
        self.set(ANSWERED, false);
        self.acknowledgements.take_answers()
    }

    /// The open acknowledgements, for both ends of the queue.
    pub(crate) fn acknowledgements(&self) -> &Acknowledgements {
        &self.acknowledgements
    }

    /// The rest of the program is forgotten, and with it a hold in which it stood.
    pub(crate) fn aborted(&self) {
        self.set(ABORT | HOLD, false);
    }

    fn set(&self, flag: u8, on: bool) {
        if on {
            self.flags.fetch_or(flag, Ordering::Relaxed);
        } else {
            self.flags.fetch_and(!flag, Ordering::Relaxed);
        }
    }
}

impl Default for Control {
    fn default() -> Self {
        Self::new()
    }
}

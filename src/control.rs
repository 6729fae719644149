//! What may come from outside while the motion runs: override, feed hold, resume, abort, reduced speed of an operator,
//! acknowledgements of functions.
//!
//! Commands are one atomic word: any context may give them at any time, without a lock and without waiting. The
//! planner follows them from a few ticks behind its next call on, see [`crate::planning`].
mod acknowledge;

pub use acknowledge::Unexpected;
pub(crate) use acknowledge::{OPEN, Ticket};

use crate::queue::Function;
use acknowledge::Acknowledgements;
use core::sync::atomic::{AtomicU32, Ordering};

/// Highest override: 200 %, LSB 0.1 %.
pub const MAX_OVERRIDE: u16 = 2000;

/// 100 %.
pub const FULL_OVERRIDE: u16 = 1000;

/// The override is in the lower half of the word.
const FEED: u32 = 0xffff;
const HOLD: u32 = 1 << 16;
const ABORT: u32 = 2 << 16;
const REDUCED: u32 = 4 << 16;
/// An acknowledgement came that the planner has not looked at.
const ANSWERED: u32 = 8 << 16;
/// The interrupt has gone on with the way in reserve.
const LEFT: u32 = 16 << 16;

/// Commands to a running channel. Shared by all who give them and the planner that follows them.
pub struct Control {
    word: AtomicU32,
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
    /// The commands in the word.
    pub(crate) const COMMANDS: u32 = !(ANSWERED | LEFT);

    /// The word of [`Self::new`].
    pub(crate) const NORMAL: u32 = FULL_OVERRIDE as u32;

    /// Full override, no hold.
    pub const fn new() -> Self {
        Self { word: AtomicU32::new(Self::NORMAL), acknowledgements: Acknowledgements::new() }
    }

    /// Feed override, LSB 0.1 %; more than 200 % is 200 %. It acts on feed and rapid motion; P-CHAN-00066 says how. With 0
    /// the motion stands still on the path, as in a feed hold.
    pub fn set_override(&self, feed: u16) {
        let feed = u32::from(feed.min(MAX_OVERRIDE));
        let _ =
            self.word.fetch_update(Ordering::Relaxed, Ordering::Relaxed, |word| Some(word & !FEED | feed));
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
        Commands::of(self.word())
    }

    /// All of them in one word, to see whether something has changed.
    #[inline(always)]
    pub(crate) fn word(&self) -> u32 {
        self.word.load(Ordering::Relaxed)
    }

    /// Whether the interrupt stops, or stands, without the planner ([`crate::queue::Clock`]).
    #[inline(always)]
    pub(crate) fn has_left(&self) -> bool {
        self.word() & LEFT != 0
    }

    /// It does; or it may go on with what is in the queue.
    pub(crate) fn set_left(&self, left: bool) {
        self.set(LEFT, left);
    }

    /// Whether an acknowledgement is to be looked at.
    pub(crate) fn is_answered(&self) -> bool {
        self.word() & ANSWERED != 0
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

    fn set(&self, flag: u32, on: bool) {
        if on {
            self.word.fetch_or(flag, Ordering::Release);
        } else {
            self.word.fetch_and(!flag, Ordering::Release);
        }
    }
}

impl Commands {
    pub(crate) const fn of(word: u32) -> Self {
        Self {
            feed: (word & FEED) as u16,
            hold: word & HOLD != 0,
            abort: word & ABORT != 0,
            reduced: word & REDUCED != 0,
        }
    }

    /// Whether the motion is to stand still.
    pub(crate) const fn standstill(&self) -> bool {
        self.hold || self.abort || self.feed == 0
    }
}

impl Default for Control {
    fn default() -> Self {
        Self::new()
    }
}

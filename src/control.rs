//! What may come from outside while the motion runs: override, feed hold, resume, abort, reduced speed of an operator,
//! acknowledgements of functions.
//!
//! Each command has a word of its own, which giving it writes and nothing reads back: any context may give them at any time,
//! without a lock, without waiting and without compare-and-swap, which small cores do not have. The planner follows them
//! from a few ticks behind its next call on, see [`crate::plan`].
mod acknowledge;

pub use acknowledge::Unexpected;
pub(crate) use acknowledge::{OPEN, Ticket};

use crate::queue::Function;
use acknowledge::Acknowledgements;
use core::sync::atomic::{AtomicBool, AtomicU32, Ordering, fence};

/// Highest override: 200 %, LSB 0.1 %.
pub const MAX_OVERRIDE: u16 = 2000;

/// 100 %.
pub const FULL_OVERRIDE: u16 = 1000;

/// The commands in one word, for comparison: the override is in its lower half.
const FEED: u32 = 0xffff;
const HOLD: u32 = 1 << 16;
const ABORT: u32 = 2 << 16;
const REDUCED: u32 = 4 << 16;
/// An acknowledgement came that the planner has not looked at.
const ANSWERED: u32 = 8 << 16;
/// The interrupt has gone on with the way in reserve.
const LEFT: u32 = 16 << 16;

/// Commands to a running channel. Shared by all who give them and the planner that follows them.
///
/// A word with several writers takes the value written last: a hold that is given while the planner ends an aborted program
/// may count for that program or for the next one.
pub struct Control {
    /// Feed override, LSB 0.1 %.
    feed: AtomicU32,
    hold: AtomicBool,
    abort: AtomicBool,
    reduced: AtomicBool,
    /// An acknowledgement came. Written by whoever acknowledges, and by the planner that looks at it.
    answered: AtomicBool,
    /// The interrupt goes on with the way in reserve. Written by the interrupt, and by the planner that lets it go on.
    left: AtomicBool,
    /// One of the above was written since [`Self::word`] was put together.
    changed: AtomicBool,
    /// All of them as the planner saw them last. Written by the planner.
    seen: AtomicU32,
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
        Self { feed: AtomicU32::new(Self::NORMAL), seen: AtomicU32::new(Self::NORMAL), ..Self::blank() }
    }

    /// Memory for one; all bits zero.
    pub(crate) const fn blank() -> Self {
        Self {
            feed: AtomicU32::new(0),
            hold: AtomicBool::new(false),
            abort: AtomicBool::new(false),
            reduced: AtomicBool::new(false),
            answered: AtomicBool::new(false),
            left: AtomicBool::new(false),
            changed: AtomicBool::new(false),
            seen: AtomicU32::new(0),
            acknowledgements: Acknowledgements::new(),
        }
    }

    /// Feed override, LSB 0.1 %; more than 200 % is 200 %. It acts on feed and rapid motion; P-CHAN-00066 says how. With 0
    /// the motion stands still on the path, as in a feed hold.
    pub fn set_override(&self, feed: u16) {
        let feed = u32::from(feed.min(MAX_OVERRIDE));
        self.feed.store(feed, Ordering::Relaxed);
        self.changed.store(true, Ordering::Release);
    }

    /// Stand still on the path as soon as the limits allow.
    pub fn feed_hold(&self) {
        self.set(&self.hold, true);
    }

    /// End of [`Self::feed_hold`].
    pub fn resume(&self) {
        self.set(&self.hold, false);
    }

    /// Stand still and forget the rest of the program; ends a hold too.
    pub fn abort(&self) {
        self.set(&self.abort, true);
    }

    /// Reduced speed (P-AXIS-00214) on or off.
    pub fn set_reduced(&self, reduced: bool) {
        self.set(&self.reduced, reduced);
    }

    /// Acknowledges a function. If it was put out more than once, that put out first.
    ///
    /// # Errors
    /// Nothing waits for it: it was not put out yet, or it is acknowledged already. It is ignored.
    pub fn acknowledge(&self, function: Function) -> Result<(), Unexpected> {
        self.acknowledgements.answer(function)?;
        self.set(&self.answered, true);
        Ok(())
    }

    /// The function put out first of those that are not acknowledged.
    pub fn awaited(&self) -> Option<Function> {
        self.acknowledgements.awaited()
    }

    /// The commands as they stand.
    pub fn commands(&self) -> Commands {
        Commands::of(self.gather())
    }

    /// All of them in one word, to see whether something has changed. For the planner.
    #[inline(always)]
    pub(crate) fn word(&self) -> u32 {
        if self.changed.load(Ordering::Relaxed) {
            self.look();
        }
        self.seen.load(Ordering::Relaxed)
    }

    #[inline(never)]
    fn look(&self) {
        // What is written behind this sets it again.
        self.changed.store(false, Ordering::Relaxed);
        fence(Ordering::SeqCst);
        self.seen.store(self.gather(), Ordering::Relaxed);
    }

    fn gather(&self) -> u32 {
        let flag = |word: &AtomicBool, flag| if word.load(Ordering::Acquire) { flag } else { 0 };
        self.feed.load(Ordering::Relaxed)
            | flag(&self.hold, HOLD)
            | flag(&self.abort, ABORT)
            | flag(&self.reduced, REDUCED)
            | flag(&self.answered, ANSWERED)
            | flag(&self.left, LEFT)
    }

    /// Whether the interrupt stops, or stands, without the planner ([`crate::queue::Clock`]).
    #[inline(always)]
    pub(crate) fn has_left(&self) -> bool {
        self.left.load(Ordering::Relaxed)
    }

    /// It does; or it may go on with what is in the queue.
    pub(crate) fn set_left(&self, left: bool) {
        self.set(&self.left, left);
    }

    /// Whether an acknowledgement is to be looked at.
    pub(crate) fn is_answered(&self) -> bool {
        self.answered.load(Ordering::Relaxed)
    }

    /// The tickets acknowledged, which are free again. For the planner.
    pub(crate) fn take_answers(&self) -> u32 {
        // What comes behind this sets the flag again.
        self.set(&self.answered, false);
        fence(Ordering::SeqCst);
        self.acknowledgements.take_answers()
    }

    /// The open acknowledgements, for both ends of the queue.
    pub(crate) fn acknowledgements(&self) -> &Acknowledgements {
        &self.acknowledgements
    }

    /// The rest of the program is forgotten, and with it a hold in which it stood.
    pub(crate) fn aborted(&self) {
        self.set(&self.abort, false);
        self.set(&self.hold, false);
    }

    fn set(&self, word: &AtomicBool, on: bool) {
        word.store(on, Ordering::Release);
        self.changed.store(true, Ordering::Release);
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

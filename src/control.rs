//! The memory words through which the operator gives commands and acknowledgements to the planner. The
//! commands are override, feed hold, resume, abort and reduced speed.
//!
//! [`crate::operator::Operator`] writes the commands. Each word has one writer, the operator or the planner.
//! So the operator may give a command at any time, without a lock and without waiting. No access needs
//! compare-and-swap, which small cores lack. The planner reads the words in each call, and the motion changes
//! a few ticks later ([`crate::plan`]).
mod acknowledge;

pub(crate) use acknowledge::OPEN;
pub use acknowledge::Unexpected;

use crate::technology::Function;
use acknowledge::Acknowledgements;
use core::sync::atomic::{AtomicU32, Ordering};

/// Highest override: 200 %, LSB 0.1 %.
pub const MAX_OVERRIDE: u16 = 2000;

/// Override of 100 %, LSB 0.1 %.
pub const FULL_OVERRIDE: u16 = 1000;

/// Fields of the word that holds all commands. The override is in the lower half.
const FEED: u32 = 0xffff;
const HOLD: u32 = 1 << 16;
const ABORT: u32 = 2 << 16;
const REDUCED: u32 = 4 << 16;
/// An acknowledgement has come that the planner has not read yet.
const ANSWERED: u32 = 8 << 16;
/// Number of aborts given, in the word of the operator. The word of the planner has the bit [`ABORT`]
/// instead.
const ABORTS: u32 = 0xff << 24;
const ONE_ABORT: u32 = 1 << 24;

/// The commands and acknowledgements that operator and planner share.
pub struct Control {
    /// The commands. The operator writes this word and the next two.
    given: AtomicU32,
    /// Number of acknowledgements given.
    answers: AtomicU32,
    /// Number of changes of the two words above.
    changes: AtomicU32,
    /// Number of changes that the planner has read. The planner writes this word and the next three.
    looked: AtomicU32,
    /// Number of acknowledgements that the planner has read.
    heard: AtomicU32,
    /// Number of aborts carried out, in the format of `given`.
    aborted: AtomicU32,
    /// All commands as the planner read them last.
    seen: AtomicU32,
    /// Whether a limit of the PLC holds the axes. The planner writes this word.
    #[cfg(feature = "plc")]
    limited: AtomicU32,
    acknowledgements: Acknowledgements,
}

/// The commands in force.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Commands {
    /// Feed override, 0…2000, LSB 0.1 %.
    pub feed: u16,
    /// Whether the motion has to stop on the path (feed hold).
    pub hold: bool,
    /// Whether the rest of the program has to be dropped (abort).
    pub abort: bool,
    /// Whether every axis stays below its reduced speed (P-AXIS-00214).
    pub reduced: bool,
}

impl Control {
    /// The bits of the planner's word that hold commands.
    pub(crate) const COMMANDS: u32 = !ANSWERED;

    /// The planner's word while the override is 100 % and no command is in force.
    pub(crate) const NORMAL: u32 = FULL_OVERRIDE as u32;

    /// The memory before the first command: override 100 %, no feed hold.
    pub(crate) const fn new() -> Self {
        let [given, seen] = [const { AtomicU32::new(Self::NORMAL) }; 2];
        Self { given, seen, ..Self::blank() }
    }

    /// Empty memory: all bits are zero.
    pub(crate) const fn blank() -> Self {
        let [given, answers, changes, looked, heard, aborted, seen] = [const { AtomicU32::new(0) }; 7];
        let acknowledgements = Acknowledgements::new();
        Self {
            given,
            answers,
            changes,
            looked,
            heard,
            aborted,
            seen,
            #[cfg(feature = "plc")]
            limited: AtomicU32::new(0),
            acknowledgements,
        }
    }

    /// The open acknowledgements. Planner and operator both use this table.
    pub(crate) const fn acknowledgements(&self) -> &Acknowledgements {
        &self.acknowledgements
    }

    fn gather(&self) -> u32 {
        let given = self.given.load(Ordering::Acquire);
        let flag = |on, flag| if on { flag } else { 0 };
        let aborts = given & ABORTS != self.aborted.load(Ordering::Relaxed);
        let answered = self.answers.load(Ordering::Acquire) != self.heard.load(Ordering::Relaxed);
        #[cfg(feature = "plc")]
        let given = given | flag(self.is_limited(), HOLD);
        given & (FEED | HOLD | REDUCED) | flag(aborts, ABORT) | flag(answered, ANSWERED)
    }
}

/// Functions for the operator.
impl Control {
    /// Sets the feed override, LSB 0.1 %.
    pub(crate) fn set_override(&self, feed: u16) {
        self.give(FEED, feed.min(MAX_OVERRIDE).into());
    }

    pub(crate) fn set_hold(&self, hold: bool) {
        self.give(HOLD, if hold { HOLD } else { 0 });
    }

    pub(crate) fn set_reduced(&self, reduced: bool) {
        self.give(REDUCED, if reduced { REDUCED } else { 0 });
    }

    pub(crate) fn abort(&self) {
        let next = |aborts: u32| aborts.wrapping_add(ONE_ABORT) & ABORTS;
        let aborts = next(self.given.load(Ordering::Relaxed));
        // The count of aborts must not wrap around to the value of `aborted`: the abort would then look
        // carried out.
        let is_carried_out = aborts == self.aborted.load(Ordering::Relaxed);
        self.give(HOLD | ABORTS, if is_carried_out { next(aborts) } else { aborts });
    }

    pub(crate) fn acknowledge(&self, function: Function) -> Result<(), Unexpected> {
        self.acknowledgements.answer(function)?;
        self.answers.store(self.answers.load(Ordering::Relaxed).wrapping_add(1), Ordering::Release);
        self.change();
        Ok(())
    }

    /// The commands in force.
    pub(crate) fn commands(&self) -> Commands {
        Commands::of(self.gather())
    }

    fn give(&self, which: u32, commands: u32) {
        let given = self.given.load(Ordering::Relaxed) & !which | commands;
        self.given.store(given, Ordering::Release);
        self.change();
    }

    fn change(&self) {
        self.changes.store(self.changes.load(Ordering::Relaxed).wrapping_add(1), Ordering::Release);
    }
}

/// Functions for the planner.
impl Control {
    /// All commands, and whether an acknowledgement is unread. A change of this word means that a command or
    /// an acknowledgement has come.
    #[inline(always)]
    pub(crate) fn word(&self) -> u32 {
        if self.changes.load(Ordering::Relaxed) != self.looked.load(Ordering::Relaxed) {
            self.look();
        }
        self.seen.load(Ordering::Relaxed)
    }

    #[inline(never)]
    fn look(&self) {
        // A command that comes after this line counts as another change.
        self.looked.store(self.changes.load(Ordering::Acquire), Ordering::Relaxed);
        self.seen.store(self.gather(), Ordering::Relaxed);
    }

    /// Whether a limit of the PLC holds the axes.
    #[cfg(feature = "plc")]
    pub(crate) fn is_limited(&self) -> bool {
        self.limited.load(Ordering::Relaxed) != 0
    }

    /// Holds the axes because of a limit of the PLC, or ends this hold.
    #[cfg(feature = "plc")]
    pub(crate) fn limit(&self, is_limited: bool) {
        self.limited.store(is_limited.into(), Ordering::Relaxed);
        self.look();
    }

    /// Whether an acknowledgement is unread.
    pub(crate) fn is_answered(&self) -> bool {
        self.answers.load(Ordering::Relaxed) != self.heard.load(Ordering::Relaxed)
    }

    /// The tickets that have been acknowledged, one bit for each ticket. The call makes these tickets free.
    pub(crate) fn take_answers(&self) -> u32 {
        self.heard.store(self.answers.load(Ordering::Acquire), Ordering::Relaxed);
        self.look();
        self.acknowledgements.take_answers()
    }

    /// Marks the abort as carried out: the rest of the program is dropped.
    pub(crate) fn aborted(&self) {
        self.aborted.store(self.given.load(Ordering::Relaxed) & ABORTS, Ordering::Relaxed);
        self.look();
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

    /// Whether the axes have to stop: because of a feed hold, an abort, or an override of 0.
    pub(crate) const fn standstill(&self) -> bool {
        self.hold || self.abort || self.feed == 0
    }
}

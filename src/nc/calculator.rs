//! What expressions are worked out with, and how much of it a call may do.
//!
//! A line may hold more arithmetic than one call of the decoder is to do. What is left for the call is
//! counted; where it does not suffice, the expression at hand is laid aside in the middle, and everything
//! above it is left as if the text were wrong ([`Calculator::is_halted`] tells the one from the other). The
//! next call reads the line again: words that were complete are not read again, expressions of the statement
//! at hand that were complete are known by where they begin, and the one laid aside goes on. So nothing may
//! be changed before the last expression of a statement, or of a word of a block, is complete.
use super::expression::Stacks;
use super::parameter::Parameters;
use super::{Fault, NcErrorKind, Span};
use crate::machine::functions;
use core::cell::Cell;

/// Work of one call: about so many hundred instructions on the target.
const BUDGET: u32 = 320;

/// Expressions of one statement that are remembered: more than any has.
const KNOWN: usize = functions::EXPRESSIONS.room(16);

/// An expression that is complete: where it begins and ends in the line, and its value.
#[derive(Clone, Copy)]
struct Known {
    start: u16,
    end: u16,
    value: f64,
}

/// An expression that is not: where it begins, how far it was read, and what waits.
pub(super) struct Aside {
    pub at: usize,
    pub stacks: Stacks,
}

/// Parameters, and the work of a call.
pub(super) struct Calculator {
    pub parameters: Parameters,
    left: Cell<u32>,
    halted: Cell<bool>,
    /// Something was done in this call.
    moved: Cell<bool>,
    known: [Cell<Known>; KNOWN],
    count: Cell<usize>,
    aside: Cell<Option<Aside>>,
    /// Where that begins.
    aside_start: Cell<usize>,
    /// Variables from outside, for the line at hand.
    #[cfg(feature = "plc")]
    pub looked: super::variable::Looked,
}

/// No place in a line.
const NOWHERE: usize = usize::MAX;

impl Calculator {
    /// All bits zero; it begins with [`Self::clear`].
    pub const fn new() -> Self {
        Self {
            parameters: Parameters::new(),
            left: Cell::new(0),
            halted: Cell::new(false),
            moved: Cell::new(false),
            known: [const { Cell::new(Known { start: 0, end: 0, value: 0.0 }) }; KNOWN],
            count: Cell::new(0),
            aside: Cell::new(None),
            aside_start: Cell::new(0),
            #[cfg(feature = "plc")]
            looked: super::variable::Looked::new(),
        }
    }

    /// No parameter has a value, and no line is at hand.
    pub fn clear(&mut self) {
        self.parameters.clear();
        self.aside.set(None);
        self.reset();
    }

    /// A call begins; whether the line at hand goes on.
    pub fn begin(&self) -> bool {
        self.left.set(BUDGET);
        self.moved.set(false);
        let goes_on = self.halted.replace(false);
        if !goes_on {
            self.complete();
        }
        goes_on
    }

    /// No line is at hand.
    pub fn reset(&self) {
        self.halted.set(false);
        self.complete();
    }

    /// The statement or word at hand is complete.
    pub fn complete(&self) {
        self.count.set(0);
        self.aside_start.set(NOWHERE);
    }

    /// Whether the line at hand goes on in the next call.
    pub fn is_halted(&self) -> bool {
        self.halted.get()
    }

    /// Whether this call has done no more than that, and is complete.
    pub fn has_done_no_more_than(&self, work: u32) -> bool {
        !self.is_halted() && self.left.get() >= BUDGET - work
    }

    /// Work that had to be done.
    pub fn charge(&self, work: u32) {
        self.left.set(self.left.get().saturating_sub(work));
    }

    /// Whether there is time for that much work, which then counts. What a call begins with always has it.
    pub fn affords(&self, work: u32) -> bool {
        let left = self.left.get().checked_sub(work);
        if left.is_none() && self.moved.get() {
            return false;
        }
        self.moved.set(true);
        self.left.set(left.unwrap_or(0));
        true
    }

    /// The line goes on in the next call. The fault is none.
    pub fn halt<V>(&self) -> Result<V, Fault> {
        self.halted.set(true);
        Span::default().fault(NcErrorKind::Endless)
    }

    /// Lays the expression aside that begins at `start`. The line then halts.
    #[inline(never)]
    pub fn lay_aside(&self, start: usize, aside: Aside) {
        self.aside.set(Some(aside));
        self.aside_start.set(start);
    }

    /// Whether an expression may be laid aside: what was complete before it has to be known.
    pub fn knows_all(&self) -> bool {
        self.count.get() < self.known.len()
    }

    /// Whether the expression that begins at `start` was laid aside.
    #[cfg_attr(feature = "fast", inline(always))]
    pub fn has_aside(&self, start: usize) -> bool {
        self.aside_start.get() == start
    }

    /// The expression laid aside. It goes on, whatever its next step takes.
    #[inline(never)]
    pub fn take_aside(&self) -> Option<Aside> {
        self.aside_start.set(NOWHERE);
        self.moved.set(false);
        self.aside.take()
    }

    /// Remembers an expression that is complete.
    pub fn remember(&self, start: usize, end: usize, value: f64) {
        let count = self.count.get();
        if let Some(slot) = self.known.get(count) {
            slot.set(Known { start: start as u16, end: end as u16, value });
            self.count.set(count + 1);
        }
    }

    /// End and value of the expression that begins at `start`, if it was complete before the statement was
    /// read again.
    pub fn recall(&self, start: usize) -> Option<(usize, f64)> {
        let known = self.known.iter().take(self.count.get()).map(Cell::get);
        known
            .into_iter()
            .find(|known| usize::from(known.start) == start)
            .map(|known| (usize::from(known.end), known.value))
    }
}

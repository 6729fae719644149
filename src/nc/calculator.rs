//! The state of expressions, and the amount of arithmetic per call.
//!
//! A line may hold more arithmetic than one call of the decoder may do. The calculator counts the remaining
//! work of the call. If it does not suffice, the current expression is laid aside in the middle, and the
//! decoder leaves the line as if the text were wrong ([`Calculator::is_halted`] distinguishes both cases).
//! The next call reads the line again. It skips words that were complete; it knows complete expressions of
//! the current statement by their start; and it continues the expression laid aside. So the decoder must not
//! change any state before the last expression of a statement, or of a word of a block, is complete.
use super::expression::Stacks;
use super::parameter::Parameters;
use super::{Fault, NcErrorKind, Span};
use crate::machine::functions;
use core::cell::Cell;

/// Work of one call: approximately hundreds of instructions on the target.
const BUDGET: u32 = 320;

/// Number of complete expressions kept for one statement: more than any statement has.
const KNOWN: usize = functions::EXPRESSIONS.room(16);

/// A complete expression: its start and end in the line, and its value.
#[derive(Clone, Copy)]
struct Known {
    start: u16,
    end: u16,
    value: f64,
}

/// An incomplete expression: its start, the position read so far, and the waiting operators.
pub(super) struct Aside {
    pub at: usize,
    pub stacks: Stacks,
}

/// Parameters, and the work of a call.
pub(super) struct Calculator {
    pub parameters: Parameters,
    left: Cell<u32>,
    halted: Cell<bool>,
    /// Whether this call has made progress.
    moved: Cell<bool>,
    known: [Cell<Known>; KNOWN],
    count: Cell<usize>,
    aside: Cell<Option<Aside>>,
    /// Start of the expression laid aside.
    aside_start: Cell<usize>,
    /// Variables from outside, for the current line.
    #[cfg(feature = "plc")]
    pub looked: super::variable::Looked,
}

/// Not a position in a line.
const NOWHERE: usize = usize::MAX;

impl Calculator {
    /// All bits are zero; [`Self::clear`] comes first.
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

    /// Removes all parameter values and the current line.
    pub fn clear(&mut self) {
        self.parameters.clear();
        self.aside.set(None);
        self.reset();
    }

    /// Begins a call. Returns whether the current line continues.
    pub fn begin(&self) -> bool {
        self.left.set(BUDGET);
        self.moved.set(false);
        let goes_on = self.halted.replace(false);
        if !goes_on {
            self.complete();
        }
        goes_on
    }

    /// Drops the current line.
    pub fn reset(&self) {
        self.halted.set(false);
        self.complete();
    }

    /// The current statement or word is complete.
    pub fn complete(&self) {
        self.count.set(0);
        self.aside_start.set(NOWHERE);
    }

    /// Whether the current line continues in the next call.
    pub fn is_halted(&self) -> bool {
        self.halted.get()
    }

    /// Whether this call has done at most `work`, and is complete.
    pub fn has_done_no_more_than(&self, work: u32) -> bool {
        !self.is_halted() && self.left.get() >= BUDGET - work
    }

    /// Adds work that had to be done.
    pub fn charge(&self, work: u32) {
        self.left.set(self.left.get().saturating_sub(work));
    }

    /// Whether there is time for this work, which is then counted. The first work of a call always has time.
    pub fn affords(&self, work: u32) -> bool {
        let left = self.left.get().checked_sub(work);
        if left.is_none() && self.moved.get() {
            return false;
        }
        self.moved.set(true);
        self.left.set(left.unwrap_or(0));
        true
    }

    /// Halts the line until the next call. The returned fault is not an error.
    pub fn halt<V>(&self) -> Result<V, Fault> {
        self.halted.set(true);
        Span::default().fault(NcErrorKind::Endless)
    }

    /// Lays aside the expression that begins at `start`. The line then halts.
    #[inline(never)]
    pub fn lay_aside(&self, start: usize, aside: Aside) {
        self.aside.set(Some(aside));
        self.aside_start.set(start);
    }

    /// Whether an expression may be laid aside: all complete ones before it must be stored.
    pub fn knows_all(&self) -> bool {
        self.count.get() < self.known.len()
    }

    /// Whether the expression that begins at `start` was laid aside.
    #[cfg_attr(feature = "fast", inline(always))]
    pub fn has_aside(&self, start: usize) -> bool {
        self.aside_start.get() == start
    }

    /// The expression laid aside. It continues, whatever its next step costs.
    #[inline(never)]
    pub fn take_aside(&self) -> Option<Aside> {
        self.aside_start.set(NOWHERE);
        self.moved.set(false);
        self.aside.take()
    }

    /// Stores a complete expression.
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

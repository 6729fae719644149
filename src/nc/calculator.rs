//! Limits the arithmetic of one call of the decoder, and holds the P parameters and the unfinished
//! expression.
//!
//! A line may contain more arithmetic than one call may do. The calculator counts the work that is left in
//! this call. If the work does not suffice, the calculator stores the unfinished expression. The decoder then
//! leaves the line in the same way as a wrong line; [`Calculator::is_halted`] tells the two cases apart.
//!
//! The next call reads the same line again from its start. The decoder takes the values of complete
//! expressions from a list, and continues the stored expression. So no state may change before the last
//! expression of a statement, or of a word in a block, is complete.
use super::expression::Stacks;
use super::parameter::Parameters;
use super::{Fault, NcErrorKind, Span};
use crate::machine::functions;
use core::cell::Cell;

/// Work of one call, in units of about a hundred instructions on the target.
const BUDGET: u32 = 320;

/// Number of complete expressions that are stored for one statement; no statement has more.
const KNOWN: usize = functions::EXPRESSIONS.room(16);

/// A complete expression: its start and end in the line, and its value.
#[derive(Clone, Copy)]
struct Known {
    start: u16,
    end: u16,
    value: f64,
}

/// An incomplete expression: its start, the position up to which it is read, and its pending operators.
pub(super) struct Aside {
    pub at: usize,
    pub stacks: Stacks,
}

/// The P parameters, and the work of a call.
pub(super) struct Calculator {
    pub parameters: Parameters,
    left: Cell<u32>,
    halted: Cell<bool>,
    /// Whether this call has made progress.
    moved: Cell<bool>,
    known: [Cell<Known>; KNOWN],
    count: Cell<usize>,
    aside: Cell<Option<Aside>>,
    /// Start of the stored expression.
    aside_start: Cell<usize>,
    /// Values of outside variables for the current line.
    #[cfg(feature = "plc")]
    pub looked: super::variable::Looked,
}

/// A value that is no position in a line.
const NOWHERE: usize = usize::MAX;

impl Calculator {
    /// A calculator whose bits are all zero. Call [`Self::clear`] before use.
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

    /// Marks the current statement or word as complete.
    pub fn complete(&self) {
        self.count.set(0);
        self.aside_start.set(NOWHERE);
    }

    /// Whether the current line continues in the next call.
    pub fn is_halted(&self) -> bool {
        self.halted.get()
    }

    /// Whether this call has done at most `work`, and its line is complete.
    pub fn has_done_no_more_than(&self, work: u32) -> bool {
        !self.is_halted() && self.left.get() >= BUDGET - work
    }

    /// Counts work that cannot be postponed.
    pub fn charge(&self, work: u32) {
        self.left.set(self.left.get().saturating_sub(work));
    }

    /// Whether the call may still do this work. If so, the work is counted. The first work of a call is
    /// always permitted.
    pub fn affords(&self, work: u32) -> bool {
        let left = self.left.get().checked_sub(work);
        if left.is_none() && self.moved.get() {
            return false;
        }
        self.moved.set(true);
        self.left.set(left.unwrap_or(0));
        true
    }

    /// Stops work on the line until the next call. The returned fault is no error: it only ends this call.
    pub fn halt<V>(&self) -> Result<V, Fault> {
        self.halted.set(true);
        Span::default().fault(NcErrorKind::Endless)
    }

    /// Stores the expression that begins at `start`. The line then halts.
    #[inline(never)]
    pub fn lay_aside(&self, start: usize, aside: Aside) {
        self.aside.set(Some(aside));
        self.aside_start.set(start);
    }

    /// Whether an expression may be stored. This needs all complete expressions before it in the list.
    pub fn knows_all(&self) -> bool {
        self.count.get() < self.known.len()
    }

    /// Whether the expression that begins at `start` is stored.
    #[cfg_attr(feature = "fast", inline(always))]
    pub fn has_aside(&self, start: usize) -> bool {
        self.aside_start.get() == start
    }

    /// Returns the stored expression. The next step of this expression may have any cost.
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

    /// End and value of the expression that begins at `start`, if an earlier call has completed this
    /// expression. The decoder reads a statement again from its start when a call was not enough for it.
    pub fn recall(&self, start: usize) -> Option<(usize, f64)> {
        let known = self.known.iter().take(self.count.get()).map(Cell::get);
        known
            .into_iter()
            .find(|known| usize::from(known.start) == start)
            .map(|known| (usize::from(known.end), known.value))
    }
}

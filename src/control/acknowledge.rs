//! Acknowledgements that the motion waits for: one word each, which the planner, the interrupt and whoever acknowledges
//! change in turn.
//!
//! ```text
//!   free -planner-> planned -put out-> open -acknowledged-> answered -planner-> free
//! ```
//!
//! A word holds function and sequence number with its state, and is changed only from what it was known to be. So no order of
//! contexts can take one acknowledgement for another: neither one that comes early or twice, nor one for what an abort has
//! thrown away.
use crate::queue::Function;
use core::sync::atomic::{AtomicU32, Ordering};

/// Acknowledgements open at a time, from reading the program on.
pub(crate) const OPEN: usize = 32;

const FREE: u32 = 0;
const PLANNED: u32 = 1;
const PUT_OUT: u32 = 2;
const ANSWERED: u32 = 3;
const STATE: u32 = 3;

/// What is behind the state: M or H, number, which of the words, sequence number.
const OF_H: u32 = 1 << 2;
const CODE: u32 = 3;
const FUNCTION: u32 = 0xffff << CODE | OF_H;
const INDEX: u32 = 19;
const SEQUENCE: u32 = 24;

/// Nothing waits for this acknowledgement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Unexpected;

impl core::fmt::Display for Unexpected {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str("nothing waits for this acknowledgement")
    }
}

impl core::error::Error for Unexpected {}

/// A planned acknowledgement: its word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct Ticket(u32);

impl Ticket {
    /// Nothing waits.
    pub const NONE: Self = Self(0);

    /// One bit for each that can be open.
    pub const fn bit(self) -> u32 {
        if self.0 == 0 { 0 } else { 1 << (self.0 >> INDEX & (OPEN as u32 - 1)) }
    }

    pub const fn waits(self) -> bool {
        self.0 != 0
    }
}

const fn word(function: Function) -> Option<u32> {
    match function {
        Function::M(code) => Some((code as u32) << CODE),
        Function::H(code) => Some((code as u32) << CODE | OF_H),
        Function::Spindle(_) | Function::Tool(_) => None,
    }
}

/// All of them.
pub(crate) struct Acknowledgements {
    words: [AtomicU32; OPEN],
}

impl Acknowledgements {
    pub const fn new() -> Self {
        const { assert!(OPEN == 32, "a bit each in u32, five bits of index") };
        Self { words: [const { AtomicU32::new(FREE) }; OPEN] }
    }

    /// Plans one that comes behind all others with a lower `sequence`; `None` if there is no room. For the planner.
    pub fn plan(&self, function: Function, sequence: u8) -> Option<Ticket> {
        let free = |word: &AtomicU32| word.load(Ordering::Acquire) == FREE;
        let (index, slot) = self.words.iter().enumerate().find(|(_, word)| free(word))?;
        let planned = word(function)? | PLANNED | (index as u32) << INDEX | u32::from(sequence) << SEQUENCE;
        slot.store(planned, Ordering::Release);
        Some(Ticket(planned))
    }

    /// Its function is put out now; nothing happens if an abort has forgotten it.
    pub fn put_out(&self, ticket: Ticket) {
        let index = (ticket.0 >> INDEX) as usize % OPEN;
        if let (true, Some(word)) = (ticket.waits(), self.words.get(index)) {
            let open = ticket.0 & !STATE | PUT_OUT;
            let _ = word.compare_exchange(ticket.0, open, Ordering::AcqRel, Ordering::Relaxed);
        }
    }

    /// Acknowledges the one put out first.
    pub fn answer(&self, function: Function) -> Result<(), Unexpected> {
        let wanted = word(function).ok_or(Unexpected)?;
        let (word, open) = self.first(|open| open & FUNCTION == wanted).ok_or(Unexpected)?;
        // Someone else may have been faster.
        let answered = open & !STATE | ANSWERED;
        let done = word.compare_exchange(open, answered, Ordering::AcqRel, Ordering::Relaxed);
        done.map(|_| ()).map_err(|_| Unexpected)
    }

    /// The function of the one put out first.
    pub fn awaited(&self) -> Option<Function> {
        let (_, open) = self.first(|_| true)?;
        let code = (open >> CODE) as u16;
        Some(if open & OF_H == 0 { Function::M(code) } else { Function::H(code) })
    }

    fn first(&self, fits: impl Fn(u32) -> bool) -> Option<(&AtomicU32, u32)> {
        let mut first: Option<(&AtomicU32, u32)> = None;
        for word in &self.words {
            let open = word.load(Ordering::Acquire);
            if open & STATE != PUT_OUT || !fits(open) {
                continue;
            }
            let age = |other: u32| ((open >> SEQUENCE) as u8).wrapping_sub((other >> SEQUENCE) as u8) as i8;
            if first.is_none_or(|(_, other)| age(other) < 0) {
                first = Some((word, open));
            }
        }
        first
    }

    /// The bits of those that are answered, which are free again. For the planner.
    pub fn take_answers(&self) -> u32 {
        let mut answers = 0;
        for (index, word) in self.words.iter().enumerate() {
            if word.load(Ordering::Acquire) & STATE == ANSWERED {
                word.store(FREE, Ordering::Release);
                answers |= 1 << index;
            }
        }
        answers
    }

    /// Its function will not be put out. For the planner.
    pub fn give_back(&self, ticket: Ticket) {
        let index = (ticket.0 >> INDEX) as usize % OPEN;
        if let (true, Some(word)) = (ticket.waits(), self.words.get(index)) {
            word.store(FREE, Ordering::Release);
        }
    }

    /// Forgets all of them. For the planner.
    pub fn clear(&self) {
        for word in &self.words {
            word.store(FREE, Ordering::Release);
        }
    }
}

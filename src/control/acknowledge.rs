//! The table of acknowledgements for which the motion waits. A place of the table is for one function and has
//! three words. Each word has one writer:
//!
//! | word | written by | holds |
//! |---|---|---|
//! | `planned` | the planner | the ticket of the function, 0 when the place is free |
//! | `put_out` | the operator | the ticket of the function that the operator received last |
//! | `answered` | the operator | the ticket that the operator acknowledged last |
//!
//! A ticket names the function and has a sequence number. A function is *open* after its output and before
//! its acknowledgement. An acknowledgement belongs to the function of this number that has been open for the
//! longest time.
//!
//! The code compares whole tickets, so acknowledgements are never confused, in any order of accesses. An
//! early acknowledgement, a repeated one, or one for a function that an abort has dropped has no effect. No
//! write depends on the current value of a word. Such a write would need compare-and-swap, which small cores
//! lack.
//!
//! The planner uses the places in turn. A place never gets a ticket that `put_out` or `answered` still holds.
use crate::machine::functions;
use crate::technology::{Function, Ticket};
use core::sync::atomic::{AtomicU32, Ordering};

/// Largest number of functions that wait for acknowledgements at the same time. A function counts from the
/// time when the planner reads it.
pub(crate) const OPEN: usize = if functions::IS_SMALL { 16 } else { 32 };

const FREE: u32 = 0;

/// Fields of a ticket: a bit that distinguishes the ticket from [`FREE`]; M or H; number; place; sequence
/// number.
const PLANNED: u32 = 1;
const OF_H: u32 = 1 << 2;
const CODE: u32 = 3;
const FUNCTION: u32 = 0xffff << CODE | OF_H;
const INDEX: u32 = 19;
const SEQUENCE: u32 = 24;

/// The error of [`crate::operator::Operator::acknowledge`]: no function waits for this acknowledgement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Unexpected;

impl core::fmt::Display for Unexpected {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str("nothing waits for this acknowledgement")
    }
}

impl core::error::Error for Unexpected {}

impl Ticket {
    /// One bit for each acknowledgement that can be open.
    pub(crate) const fn bit(self) -> u32 {
        if self.0 == 0 { 0 } else { 1 << (self.0 >> INDEX & (OPEN as u32 - 1)) }
    }
}

const fn word(function: Function) -> Option<u32> {
    match function {
        Function::M(code) => Some((code as u32) << CODE),
        Function::H(code) => Some((code as u32) << CODE | OF_H),
        Function::Spindle(_) | Function::Tool(_) => None,
        #[cfg(feature = "grbl")]
        Function::Digital(..) | Function::Analog(..) => None,
        // These numbers are above those of M functions.
        #[cfg(feature = "grbl")]
        Function::Input(wait) => {
            let code =
                1 << 15 | (wait.is_analog as u32) << 12 | (wait.mode as u32 & 7) << 8 | wait.port as u32;
            Some(code << CODE)
        }
    }
}

/// The words of an acknowledgement.
struct Place {
    planned: AtomicU32,
    put_out: AtomicU32,
    answered: AtomicU32,
}

impl Place {
    const fn free() -> Self {
        let [planned, put_out, answered] = [const { AtomicU32::new(FREE) }; 3];
        Self { planned, put_out, answered }
    }

    /// The ticket of this place, if the function has been output and is not acknowledged.
    fn open(&self) -> Option<u32> {
        let ticket = self.planned.load(Ordering::Acquire);
        let open = ticket != FREE
            && self.put_out.load(Ordering::Acquire) == ticket
            && self.answered.load(Ordering::Acquire) != ticket;
        open.then_some(ticket)
    }

    /// Whether the function is acknowledged. Only the planner calls this function.
    fn is_answered(&self) -> bool {
        let ticket = self.planned.load(Ordering::Relaxed);
        ticket != FREE && self.answered.load(Ordering::Acquire) == ticket
    }

    /// Whether the place can take this ticket. Only the planner calls this function.
    fn takes(&self, ticket: u32) -> bool {
        let [planned, put_out, answered] =
            [&self.planned, &self.put_out, &self.answered].map(|word| word.load(Ordering::Acquire));
        planned == FREE && put_out != ticket && answered != ticket
    }
}

/// The table of all acknowledgements.
pub(crate) struct Acknowledgements {
    places: [Place; OPEN],
    /// The first place that the planner tries for the next acknowledgement. The planner writes this word.
    next: AtomicU32,
}

impl Acknowledgements {
    pub const fn new() -> Self {
        const { assert!(OPEN.is_power_of_two() && OPEN <= 32, "a bit each in u32, five bits of index") };
        Self { places: [const { Place::free() }; OPEN], next: AtomicU32::new(0) }
    }

    /// Plans an acknowledgement for a function. Returns `None` if there is no room. `sequence`: sequence
    /// number of the ticket. Only the planner calls this function.
    pub fn plan(&self, function: Function, sequence: u8) -> Option<Ticket> {
        let planned = word(function)? | PLANNED | u32::from(sequence) << SEQUENCE;
        let first = self.next.load(Ordering::Relaxed);
        let (index, place, ticket) = (0..OPEN as u32).find_map(|k| {
            let index = first.wrapping_add(k) % OPEN as u32;
            let ticket = planned | index << INDEX;
            let place = self.places.get(index as usize)?;
            place.takes(ticket).then_some((index, place, ticket))
        })?;
        place.planned.store(ticket, Ordering::Release);
        self.next.store(index.wrapping_add(1), Ordering::Relaxed);
        Some(Ticket(ticket))
    }

    /// Marks the function as output. If an abort has dropped the function, the call has no effect.
    pub fn put_out(&self, ticket: Ticket) {
        if let Some(place) = self.place(ticket) {
            place.put_out.store(ticket.0, Ordering::Release);
        }
    }

    /// Acknowledges a function. If the function is open several times, the call acknowledges the first
    /// output.
    pub fn answer(&self, function: Function) -> Result<(), Unexpected> {
        let wanted = word(function).ok_or(Unexpected)?;
        let (place, open) = self.first(|open| open & FUNCTION == wanted).ok_or(Unexpected)?;
        place.answered.store(open, Ordering::Release);
        Ok(())
    }

    /// The function that was output first and is not acknowledged.
    pub fn awaited(&self) -> Option<Function> {
        let (_, open) = self.first(|_| true)?;
        let code = (open >> CODE) as u16;
        Some(if open & OF_H == 0 { Function::M(code) } else { Function::H(code) })
    }

    fn first(&self, fits: impl Fn(u32) -> bool) -> Option<(&Place, u32)> {
        let mut first: Option<(&Place, u32)> = None;
        for place in &self.places {
            let Some(open) = place.open().filter(|open| fits(*open)) else { continue };
            let age = |other: u32| ((open >> SEQUENCE) as u8).wrapping_sub((other >> SEQUENCE) as u8) as i8;
            if first.is_none_or(|(_, other)| age(other) < 0) {
                first = Some((place, open));
            }
        }
        first
    }

    /// The place of a ticket; `None` if the ticket needs no acknowledgement.
    fn place(&self, ticket: Ticket) -> Option<&Place> {
        let index = (ticket.0 >> INDEX) as usize % OPEN;
        if ticket.waits() { self.places.get(index) } else { None }
    }

    /// The bits of answered tickets. The call makes these tickets free. Only the planner calls this function.
    pub fn take_answers(&self) -> u32 {
        let mut answers = 0;
        for (index, place) in self.places.iter().enumerate() {
            if place.is_answered() {
                place.planned.store(FREE, Ordering::Release);
                answers |= 1 << index;
            }
        }
        answers
    }

    /// Frees the ticket of a function that will not be output. Only the planner calls this function.
    pub fn give_back(&self, ticket: Ticket) {
        if let Some(place) = self.place(ticket) {
            place.planned.store(FREE, Ordering::Release);
        }
    }

    /// Drops all acknowledgements. Only the planner calls this function.
    pub fn clear(&self) {
        for place in &self.places {
            place.planned.store(FREE, Ordering::Release);
        }
    }
}

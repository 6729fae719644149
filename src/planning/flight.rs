//! Spans whose time law may still change: the interrupt has not left them.
use crate::lookahead::Release;
use crate::quantity::Distance;
use crate::queue::SEGMENTS;

/// Such a span.
#[derive(Clone, Copy, Debug)]
pub(super) struct Flight {
    pub span: Release,
    /// Path distance of its start, or of where it goes on after a standstill.
    pub start: Distance,
    /// Its first tick, and the time from its start to it.
    pub first: u32,
    pub next: u64,
    /// Ticks of rest behind it.
    pub rest: u64,
}

/// As many as curves fit in the queue: each span not yet begun has one there.
const SLOTS: usize = SEGMENTS;

/// All of them, in a ring: written in place.
pub(super) struct Flights {
    slots: [Flight; SLOTS],
    front: usize,
    len: usize,
}

impl Flights {
    pub const fn new() -> Self {
        const { assert!(SLOTS.is_power_of_two()) };
        let blank = Flight { span: Release::BLANK, start: Distance::ZERO, first: 0, next: 0, rest: 0 };
        Self { slots: [blank; SLOTS], front: 0, len: 0 }
    }

    pub const fn len(&self) -> usize {
        self.len
    }

    pub const fn is_full(&self) -> bool {
        self.len == SLOTS
    }

    /// The one `k` behind the front.
    #[inline(always)]
    pub fn get(&self, k: usize) -> Option<&Flight> {
        if k < self.len { self.slots.get((self.front + k) % SLOTS) } else { None }
    }

    /// The same, to change it.
    #[inline(always)]
    pub fn get_mut(&mut self, k: usize) -> Option<&mut Flight> {
        if k < self.len { self.slots.get_mut((self.front + k) % SLOTS) } else { None }
    }

    /// The slot behind the last one, for the next one; it counts after [`Self::push`].
    #[inline(always)]
    pub fn spare(&mut self) -> Option<&mut Flight> {
        if self.is_full() { None } else { self.slots.get_mut((self.front + self.len) % SLOTS) }
    }

    /// Takes in what is in [`Self::spare`].
    pub const fn push(&mut self) {
        if !self.is_full() {
            self.len += 1;
        }
    }

    /// The first one is over.
    pub const fn drop_first(&mut self) {
        if self.len > 0 {
            self.front = (self.front + 1) % SLOTS;
            self.len -= 1;
        }
    }

    /// Only the first ones are left, so many.
    pub fn truncate(&mut self, len: usize) {
        self.len = self.len.min(len);
    }
}

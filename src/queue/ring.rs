//! A ring for one producer and one consumer, without lock and without waiting. Each of them may interrupt the
//! other, or run on another core.
//!
//! Producer and consumer each have one counter, which only they write. A slot belongs to the producer until
//! the producer's counter passes it. Then the slot belongs to the consumer until the consumer's counter
//! passes it. Counters are never reset, and their lower bits are the index of the slot. So all `N` slots are
//! used, and no index needs a division.
//!
//! (The queue of the crate `heapless` is not used. After its split, the type no longer contains `N`, so an
//! index would need a division in the interrupt, and a panic for `N` = 0.)
#![allow(unsafe_code)]
use super::word::{Memory, Place, Ram, Replay, Word};
use core::sync::atomic::Ordering;

/// An item that a [`Ring`] can hold.
pub trait Slot: Copy {
    /// The content of an unused slot; all bits zero, so a ring takes no flash.
    const BLANK: Self;
}

/// `N` slots, a power of two. The counters come first, because a small offset takes fewer instructions.
#[repr(C)]
pub struct Ring<T: Slot, const N: usize, M: Memory = Ram> {
    /// Number of items taken out since `Ring::split`.
    taken: M::Word,
    /// Number of items put in since `Ring::split`.
    put: M::Word,
    slots: [M::Place<T>; N],
}

// SAFETY: only the one producer writes a slot, while `put - taken` says that the consumer does not own the
// slot. Only the one consumer reads the slot, while the consumer owns it. The counters pass ownership with
// release and acquire.
unsafe impl<T: Slot + Send, const N: usize, M: Memory> Sync for Ring<T, N, M> {}

/// The producer's handle of a [`Ring`]: puts items in.
pub struct Producer<'a, T: Slot, const N: usize, M: Memory = Ram> {
    ring: &'a Ring<T, N, M>,
}

/// The consumer's handle of a [`Ring`]: takes items out.
pub struct Consumer<'a, T: Slot, const N: usize, M: Memory = Ram> {
    ring: &'a Ring<T, N, M>,
}

/// A handle that only reads how full a [`Ring`] is.
pub struct Gauge<'a, T: Slot, const N: usize, M: Memory = Ram> {
    ring: &'a Ring<T, N, M>,
}

impl<T: Slot, const N: usize, M: Memory> Gauge<'_, T, N, M> {
    /// Number of items in the ring. Any task, interrupt or core may call this function. The call reads both
    /// counters one after the other, so the number may be slightly out of date.
    pub fn len(&self) -> u32 {
        let taken = self.ring.taken.load(Ordering::Relaxed);
        let len = self.ring.put.load(Ordering::Relaxed).wrapping_sub(taken);
        // The producer has withdrawn pieces between the two reads.
        if (len as i32) < 0 { 0 } else { len.min(N as u32) }
    }

    /// Whether the ring is empty.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

impl<T: Slot, const N: usize> Ring<T, N> {
    /// An empty ring in ordinary memory.
    pub const fn new() -> Self {
        Self::blank()
    }
}

impl<T: Slot, const N: usize, M: Memory> Ring<T, N, M> {
    const MASK: u32 = {
        assert!(N.is_power_of_two() && N <= 1 << 16, "the number of slots is a power of two");
        N as u32 - 1
    };

    /// An empty ring in any kind of memory; all bits zero.
    pub const fn blank() -> Self {
        Self { taken: M::Word::ZERO, put: M::Word::ZERO, slots: [const { M::Place::BLANK }; N] }
    }

    /// Empties the ring and returns its two handles.
    pub fn split(&mut self) -> (Producer<'_, T, N, M>, Consumer<'_, T, N, M>) {
        (self.taken, self.put) = (M::Word::ZERO, M::Word::ZERO);
        (Producer { ring: self }, Consumer { ring: self })
    }

    /// The handles of producer and consumer. The caller makes only one of each, for a ring that
    /// [`Self::split`] has emptied.
    pub(super) const fn ends(&self) -> (Producer<'_, T, N, M>, Consumer<'_, T, N, M>) {
        (Producer { ring: self }, Consumer { ring: self })
    }

    #[inline(always)]
    fn slot(&self, count: u32) -> &M::Place<T> {
        // The mask is below N, so the optimiser removes the check.
        &self.slots[(count & Self::MASK) as usize]
    }
}

impl<T: Slot, const N: usize> Default for Ring<T, N> {
    fn default() -> Self {
        Self::new()
    }
}

impl<'a, T: Slot, const N: usize, M: Memory> Producer<'a, T, N, M> {
    /// Returns a handle that reads how full the ring is, for any task, interrupt or core.
    pub const fn gauge(&self) -> Gauge<'a, T, N, M> {
        Gauge { ring: self.ring }
    }

    /// Number of further items that have room.
    #[inline(always)]
    pub fn room(&self) -> u32 {
        let put = self.ring.put.load(Ordering::Relaxed);
        (N as u32).wrapping_sub(put.wrapping_sub(self.ring.taken.load(Ordering::Acquire)))
    }

    /// Number of items in the ring.
    #[inline(always)]
    pub fn len(&self) -> u32 {
        (N as u32).wrapping_sub(self.room())
    }

    /// Whether there is no item.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Whether there is no room.
    #[inline(always)]
    pub fn is_full(&self) -> bool {
        self.room() == 0
    }

    /// Puts an item in.
    ///
    /// # Errors
    /// The ring is full. The error returns the item.
    #[inline(always)]
    pub fn push(&mut self, item: T) -> Result<(), T> {
        if self.push_with(|slot| *slot = item) { Ok(()) } else { Err(item) }
    }

    /// Lets `fill` write the next slot in place, and puts it in. Returns `false` if the ring is full.
    #[inline(always)]
    pub fn push_with(&mut self, fill: impl FnOnce(&mut T)) -> bool {
        if self.is_full() {
            return false;
        }
        let put = self.ring.put.load(Ordering::Relaxed);
        // SAFETY: the ring is not full, so the slot belongs to the one producer. The counter hands it over
        // below.
        unsafe { self.ring.slot(put).write(fill) };
        self.ring.put.store(put.wrapping_add(1), Ordering::Release);
        true
    }

    /// Fills the slot `ahead` items after the last item without publishing it. Returns `false` if there is no
    /// room. [`Self::put_in`] publishes all filled slots at once.
    pub fn fill_ahead(&mut self, ahead: u32, fill: impl FnOnce(&mut T)) -> bool {
        if ahead >= self.room() {
            return false;
        }
        let put = self.ring.put.load(Ordering::Relaxed);
        // SAFETY: there is room, so the one producer owns the slot until it is put in.
        unsafe { self.ring.slot(put.wrapping_add(ahead)).write(fill) };
        true
    }

    /// Publishes `count` items that [`Self::fill_ahead`] has filled.
    pub fn put_in(&mut self, count: u32) {
        let put = self.ring.put.load(Ordering::Relaxed);
        self.ring.put.store(put.wrapping_add(count), Ordering::Release);
    }

    /// Number of items put in since `Ring::split`.
    pub fn count(&self) -> u32 {
        self.ring.put.load(Ordering::Relaxed)
    }

    /// Number of items that the consumer has given back since `Ring::split`.
    pub fn taken(&self) -> u32 {
        self.ring.taken.load(Ordering::Acquire)
    }

    /// The item with this number, if it is one of the last `N` items put in.
    pub fn recent(&self, number: u32) -> Option<&T> {
        if self.count().wrapping_sub(number).wrapping_sub(1) >= N as u32 {
            return None;
        }
        // SAFETY: only this producer writes slots, and needs `&mut self` for that; the consumer only reads.
        Some(unsafe { &*self.ring.slot(number).get() })
    }

    /// Withdraws the items from `number` on.
    ///
    /// The consumer must not be able to reach these items. Before other items take their places, the caller
    /// has to wait for the current tick, which may read them ([`super::Clock::settle`]).
    pub fn withdraw(&mut self, number: u32) {
        if self.count().wrapping_sub(number) <= N as u32 {
            self.ring.put.store(number, Ordering::Release);
        }
    }
}

impl<T: Slot, const N: usize, M: Replay> Clone for Consumer<'_, T, N, M> {
    fn clone(&self) -> Self {
        Self { ring: self.ring }
    }
}

impl<T: Slot, const N: usize, M: Memory> Consumer<'_, T, N, M> {
    /// Number of items in the ring.
    #[inline(always)]
    pub fn len(&self) -> u32 {
        let taken = self.ring.taken.load(Ordering::Relaxed);
        self.ring.put.load(Ordering::Acquire).wrapping_sub(taken)
    }

    /// Whether there is no item.
    #[inline(always)]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The oldest item, which stays in the ring.
    #[inline(always)]
    pub fn peek(&self) -> Option<&T> {
        if self.is_empty() {
            return None;
        }
        // SAFETY: the ring is not empty, so the consumer owns the slot until `advance`, which needs `&mut
        // self`.
        Some(unsafe { &*self.ring.slot(self.ring.taken.load(Ordering::Relaxed)).get() })
    }

    /// Increments the counter. There must be an item.
    #[inline(always)]
    fn advance(&mut self) {
        let taken = self.ring.taken.load(Ordering::Relaxed);
        self.ring.taken.store(taken.wrapping_add(1), Ordering::Release);
    }

    /// Takes the oldest item out of the ring.
    #[inline(always)]
    pub fn pop(&mut self) -> Option<T> {
        let item = *self.peek()?;
        self.advance();
        Some(item)
    }

    /// Takes the oldest item out into `item` with one copy, if there is an item and `fit` accepts it.
    #[inline(always)]
    pub fn pop_into(&mut self, item: &mut T, fit: impl FnOnce(&T) -> bool) -> bool {
        // Copied into a register; otherwise the compiler would load it again.
        let ring = self.ring;
        let number = ring.taken.load(Ordering::Relaxed);
        if ring.put.load(Ordering::Acquire) == number {
            return false;
        }
        // SAFETY: the ring is not empty, so the consumer owns the slot until the counter moves on.
        let is_fit = unsafe {
            ring.slot(number).read(|oldest| {
                let is_fit = fit(oldest);
                if is_fit {
                    *item = *oldest;
                }
                is_fit
            })
        };
        if is_fit {
            ring.taken.store(number.wrapping_add(1), Ordering::Release);
        }
        is_fit
    }

    /// Gives back all items before the item with this number. The producer must have put that item in.
    #[inline(always)]
    pub fn jump(&mut self, number: u32) {
        self.ring.taken.store(number, Ordering::Release);
    }
}

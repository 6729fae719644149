//! Ticks passed, and how the planner takes back time it has handed over.
//!
//! Pieces are handed over well ahead. To change what is to come, the planner agrees on a tick with the interrupt, a *cut*:
//! before that tick the interrupt leaves the pieces it has and goes on with the one the cut names. In between nothing is
//! lost: up to that tick the old pieces hold.
//!
//! No order of events can mix both:
//!
//! 1. The planner puts a *gate* behind the old pieces, a piece of no ticks, which the interrupt does not pass, then
//!    the new pieces. Nothing has changed for the interrupt.
//! 2. It publishes the cut: the piece first, then the tick.
//! 3. It reads the ticks passed. As long as that tick has not begun, the interrupt will find the cut there. If it has
//!    begun, the interrupt either took the cut (its count of pieces is beyond the gate), or came before it was published:
//!    then it never will, and stays before the gate, so that the planner can take gate and pieces back.
//!
//! Step 3 takes for granted that a tick, once begun, ends before the planner goes on: it is an interrupt on the planner's
//! own core.
//!
//! The end of what is in the queue has a standing cut of its own, the *reserve*: where the laws handed over end at speed, the interrupt
//! goes on with a way to a standstill, unless the planner has moved the reserve on before. So a planner that gets no time
//! needs to do nothing for the motion to slow down. The pieces of that way have a place of their own (`reserve`). Once there,
//! the interrupt stays with them until the planner lets it go on.
//!
//! An instant is twice the number of ticks of motion passed since the split, modulo 2^32: even, so that an odd one is never.
use core::sync::atomic::{AtomicU32, Ordering, fence};

/// From one tick to the next.
pub const TICK: u32 = 2;

const NEVER: u32 = 1;

/// Shared by both ends of the queue.
pub struct Clock {
    /// Written by the interrupt.
    now: AtomicU32,
    /// The instant of the cut. This and the next are written by the planner.
    at: AtomicU32,
    /// The number of the piece that follows then.
    to: AtomicU32,
    /// The instant of the reserve, and its first piece.
    end: AtomicU32,
    first: AtomicU32,
}

impl Clock {
    pub(super) const fn new() -> Self {
        let [now, to, first] = [const { AtomicU32::new(0) }; 3];
        Self { now, at: AtomicU32::new(NEVER), to, end: AtomicU32::new(NEVER), first }
    }

    /// Memory for one; all bits zero.
    pub(super) const fn blank() -> Self {
        let [now, at, to, end, first] = [const { AtomicU32::new(0) }; 5];
        Self { now, at, to, end, first }
    }

    /// Ticks of motion passed. For the interrupt.
    #[inline(always)]
    pub fn own(&self) -> u32 {
        self.now.load(Ordering::Relaxed)
    }

    /// The same for the planner.
    #[inline(always)]
    pub fn now(&self) -> u32 {
        self.now.load(Ordering::Acquire)
    }

    /// The number of the piece to go on with, if there is a cut at `instant`. For the interrupt.
    #[inline(always)]
    pub fn cut(&self, instant: u32) -> Option<u32> {
        if self.at.load(Ordering::Relaxed) != instant {
            return None;
        }
        fence(Ordering::Acquire);
        Some(self.to.load(Ordering::Relaxed))
    }

    /// Whether what was planned ends at `instant`, and the motion is to stop. For the interrupt.
    #[inline(always)]
    pub fn is_end(&self, instant: u32) -> bool {
        self.end.load(Ordering::Relaxed) == instant
    }

    /// It does: the piece it goes on with. For the interrupt, which says so ([`crate::control::Control`]).
    pub fn first(&self) -> u32 {
        fence(Ordering::Acquire);
        self.first.load(Ordering::Relaxed)
    }

    /// The reserve that begins with the piece `first` holds at `instant`. For the planner, while there is none.
    pub fn keep(&self, instant: u32, first: u32) {
        self.first.store(first, Ordering::Relaxed);
        self.end.store(instant, Ordering::Release);
    }

    /// Takes the reserve back. For the planner: whether it came in time says [`crate::control::Control`].
    pub fn release(&self) {
        self.end.store(NEVER, Ordering::Release);
    }

    /// A tick is done. For the interrupt.
    #[inline(always)]
    pub fn pass(&self) {
        self.now.store(self.own().wrapping_add(TICK), Ordering::Release);
    }

    /// Publishes a cut. For the planner, while there is none.
    pub fn publish(&self, instant: u32, number: u32) {
        self.to.store(number, Ordering::Relaxed);
        self.at.store(instant, Ordering::Release);
    }

    /// Takes back a cut whose instant has passed. For the planner.
    pub fn withdraw(&self) {
        self.at.store(NEVER, Ordering::Relaxed);
    }
}

/// Whether the instant `a` is before `b`; they are less than 2^30 ticks apart.
#[inline(always)]
pub const fn is_before(a: u32, b: u32) -> bool {
    (a.wrapping_sub(b) as i32) < 0
}

//! The clock that planner, interrupt and operator share, and the words for a change of plan. With these
//! words, the planner withdraws pieces that the interrupt may already see.
//!
//! There are two counts of ticks. *Ticks* count all calls of the interrupt. *Instants* count only the ticks
//! that use a piece. There are pieces of motion, pieces of dwell, and one-tick pieces that show a standstill.
//! Pieces begin at instants, so the tick of a change of plan (the *cut*) is an instant too.
//!
//! All counts begin at `Rings::split`, step by 2 ([`TICK`]) and wrap at 2^32. So a count is even, and bit 0
//! is free for marks. An odd instant means "never": there is no cut, or no reserve.
//!
//! Every word has one writer:
//!
//! | word | written by | holds |
//! |---|---|---|
//! | `begun` | the interrupt, first in a tick | twice the number of ticks that have begun |
//! | `now` | the interrupt, last in a tick that used a piece | the instant of the next tick that uses a piece |
//! | `idle` | the interrupt, last in any other tick | twice the number of ticks that used no piece |
//! | `rested` | the interrupt, last in any other tick | `begun` of this tick; bit 0 is set if set points moved (filters or single axes) |
//! | `left` | the interrupt, when it changes to a reserve | a number that changes each time; bit 0 names the reserve |
//! | `at`, `to` | the planner | the cut: its instant, and the number of the first piece after the cut |
//! | `ends`, `firsts`, `cuts` | the planner | for each of two reserves: its first instant, its first piece, and the cut to which it belongs |
//! | `let_go` | the planner | a copy of `left`: with this copy, the planner permits the interrupt to return to the queue |
//!
//! **Running ticks.** While a tick runs, `begun` is ahead of the sum of `now` and `idle`. A planner on the
//! interrupt's core never sees a running tick. A planner on another core waits for the end of that tick
//! ([`Clock::settle`]) before it decides. The wait takes a few hundred instructions. The interrupt never
//! waits. (Both sides use only loads and stores. With these alone, two sides can decide who came first only
//! if one of them waits.)
//!
//! **Order of accesses.** The interrupt stores `begun` before it reads the planner's words. Both sides
//! execute a sequentially consistent fence between their write and their read. So at least one side sees the
//! write of the other. Every tick that ends after [`Clock::settle`] therefore sees what the planner has
//! written before.
//!
//! **Two reserves.** One reserve is valid while the planner writes the other one. Each reserve belongs to one
//! cut. A reserve is valid only as long as this cut is the last one that the interrupt has taken.
use super::word::{Memory, Ram, Word};
use core::sync::atomic::Ordering;

/// The difference between the instants of two successive ticks that use a piece.
pub const TICK: u32 = 2;

const NEVER: u32 = 1;

/// Names one of the two stored reserves (stops that are ready): one is in force, and the planner may be
/// writing the other one.
#[derive(Clone, Copy, Debug, Hash, PartialEq, Eq)]
pub enum Kept {
    /// The first of the two.
    One = 0,
    /// The second of the two.
    Other = 1,
}

impl Kept {
    const fn of<T>(self, both: &[T; 2]) -> &T {
        let [one, other] = both;
        match self {
            Self::One => one,
            Self::Other => other,
        }
    }
}

/// The clock that planner, interrupt and operator share. It counts ticks, and holds the change of plan and
/// the reserves that the planner offers to the interrupt.
pub struct Clock<M: Memory = Ram> {
    begun: M::Word,
    now: M::Word,
    at: M::Word,
    to: M::Word,
    ends: [M::Word; 2],
    firsts: [M::Word; 2],
    cuts: [M::Word; 2],
    idle: M::Word,
    rested: M::Word,
    left: M::Word,
    let_go: M::Word,
}

impl<M: Memory> Clock<M> {
    /// Memory for a clock; all bits are zero. Call [`Self::reset`] before use.
    pub const fn blank() -> Self {
        Self {
            begun: M::Word::ZERO,
            now: M::Word::ZERO,
            at: M::Word::ZERO,
            to: M::Word::ZERO,
            ends: [M::Word::ZERO; 2],
            firsts: [M::Word::ZERO; 2],
            cuts: [M::Word::ZERO; 2],
            idle: M::Word::ZERO,
            rested: M::Word::ZERO,
            left: M::Word::ZERO,
            let_go: M::Word::ZERO,
        }
    }

    /// Sets all counts to zero, and removes cut and reserves. Call this function before planner and interrupt
    /// run.
    pub fn reset(&mut self) {
        *self = Self::blank();
        self.withdraw();
        self.withdraw_reserves();
    }
}

/// Functions for the interrupt.
impl<M: Memory> Clock<M> {
    /// Begins a tick. Returns the instant that this tick has if it uses a piece.
    #[inline(always)]
    pub fn begin(&self) -> u32 {
        let begun = self.begun.load(Ordering::Relaxed).wrapping_add(TICK);
        self.begun.store(begun, Ordering::Relaxed);
        M::fence(Ordering::SeqCst);
        self.own()
    }

    /// Ends a tick that used a piece of motion or dwell.
    #[inline(always)]
    pub fn pass(&self) {
        self.now.store(self.own().wrapping_add(TICK), Ordering::Release);
    }

    /// Ends a tick that used no piece: the path stands still.
    pub fn rest(&self) {
        self.rest_while(false);
    }

    /// As [`Self::rest`]. `moves`: set points moved in this tick although the path stood still.
    pub fn rest_while(&self, moves: bool) {
        // Counts of ticks are even, so bit 0 is free for the mark.
        self.rested.store(self.begun.load(Ordering::Relaxed) | u32::from(moves), Ordering::Relaxed);
        let idle = self.idle.load(Ordering::Relaxed);
        self.idle.store(idle.wrapping_add(TICK), Ordering::Release);
    }

    /// The number of the running tick, counted from 0 since `Rings::split`.
    pub fn tick(&self) -> u32 {
        self.begun.load(Ordering::Relaxed).wrapping_sub(TICK) / TICK
    }

    /// The instant of the next tick that uses a piece. For the interrupt; the planner calls [`Self::now`].
    #[inline(always)]
    pub fn own(&self) -> u32 {
        self.now.load(Ordering::Relaxed)
    }

    /// The number of the piece after the cut, if there is a cut at `instant`.
    #[inline(always)]
    pub fn cut(&self, instant: u32) -> Option<u32> {
        if self.at.load(Ordering::Relaxed) != instant {
            return None;
        }
        M::fence(Ordering::Acquire);
        Some(self.to.load(Ordering::Relaxed))
    }

    /// Whether a reserve begins at `instant`: the interrupt then calls [`Self::leave`], unless a cut comes
    /// first.
    #[inline(always)]
    pub fn is_end(&self, instant: u32) -> bool {
        let [one, other] = &self.ends;
        one.load(Ordering::Relaxed) == instant || other.load(Ordering::Relaxed) == instant
    }

    /// Changes from the queue to the reserve that begins at `instant`, and returns the number of the
    /// reserve's first piece. `cut`: number of the piece after the last cut that the interrupt has taken.
    /// Returns `None` if the reserve belongs to another plan.
    pub fn leave(&self, instant: u32, cut: u32) -> Option<u32> {
        for (slot, (end, of)) in (0..).zip(self.ends.iter().zip(&self.cuts)) {
            if end.load(Ordering::Relaxed) != instant {
                continue;
            }
            M::fence(Ordering::Acquire);
            if of.load(Ordering::Relaxed) == cut {
                let left = self.left.load(Ordering::Relaxed) | 1;
                self.left.store(left.wrapping_add(1) | slot, Ordering::Release);
                let [one, other] = &self.firsts;
                return Some(if slot == 0 { one } else { other }.load(Ordering::Relaxed));
            }
        }
        None
    }

    /// Whether the planner permits the interrupt to return from the reserve to the queue.
    pub fn is_let_go(&self) -> bool {
        self.let_go.load(Ordering::Acquire) == self.left.load(Ordering::Relaxed)
    }
}

/// Functions for the planner.
impl<M: Memory> Clock<M> {
    /// The instant of the next tick that uses a piece. For the planner; the interrupt calls [`Self::own`].
    #[inline(always)]
    pub fn now(&self) -> u32 {
        self.now.load(Ordering::Acquire)
    }

    /// Number of ticks that used no piece, multiplied by [`TICK`].
    pub fn idle(&self) -> u32 {
        self.idle.load(Ordering::Acquire)
    }

    /// Waits until every tick that ends from now on sees all words written before this call. If planner and
    /// interrupt run on different cores, the call waits for the end of the running tick.
    pub fn settle(&self) {
        M::fence(Ordering::SeqCst);
        let begun = self.begun.load(Ordering::Acquire);
        M::wait(|| {
            let now = self.now.load(Ordering::Acquire);
            !is_before(now.wrapping_add(self.idle.load(Ordering::Acquire)), begun)
        });
    }

    /// Publishes a cut: at `instant`, the interrupt continues with the piece `number`. There must be no other
    /// cut.
    pub fn publish(&self, instant: u32, number: u32) {
        self.to.store(number, Ordering::Relaxed);
        self.at.store(instant, Ordering::Release);
        self.settle();
    }

    /// Removes the cut. Call this function only if the interrupt has taken the cut, or if the instant of the
    /// cut has passed.
    pub fn withdraw(&self) {
        self.at.store(NEVER, Ordering::Relaxed);
    }

    /// Adds a reserve: a stop that begins at `instant` with the piece number `first`. The reserve is valid
    /// only if the last cut that the interrupt has taken leads to the piece `cut`. The reserve `other` stays
    /// valid.
    pub fn keep(&self, other: Option<Kept>, instant: u32, first: u32, cut: u32) -> Kept {
        let kept = if other == Some(Kept::One) { Kept::Other } else { Kept::One };
        kept.of(&self.firsts).store(first, Ordering::Relaxed);
        kept.of(&self.cuts).store(cut, Ordering::Relaxed);
        kept.of(&self.ends).store(instant, Ordering::Release);
        kept
    }

    /// Withdraws a reserve. Returns `false` if the interrupt already uses this reserve.
    pub fn release(&self, kept: Kept) -> bool {
        kept.of(&self.ends).store(NEVER, Ordering::Release);
        self.settle();
        !self.has_left() || self.left.load(Ordering::Relaxed) & 1 != kept as u32
    }

    fn withdraw_reserves(&self) {
        self.ends.iter().for_each(|end| end.store(NEVER, Ordering::Release));
    }

    /// Whether the interrupt has left the queue and uses a reserve.
    #[inline(always)]
    pub fn has_left(&self) -> bool {
        let has_left = self.left.load(Ordering::Relaxed) != self.let_go.load(Ordering::Relaxed);
        if has_left {
            M::fence(Ordering::Acquire);
        }
        has_left
    }

    /// Lets the interrupt return to the queue when it has reached the end of the reserve. All reserves are
    /// withdrawn.
    pub fn let_go(&self) {
        self.withdraw_reserves();
        self.let_go.store(self.left.load(Ordering::Acquire), Ordering::Release);
        self.settle();
    }
}

/// Functions for the operator.
impl<M: Memory> Clock<M> {
    /// Number of ended ticks, in units of [`TICK`]. First flag: whether the last tick used a piece. Second
    /// flag: whether set points moved without a piece. A reader calls [`Self::is_at`] afterwards to check
    /// that its values belong together.
    pub fn ended(&self) -> (u32, [bool; 2]) {
        let now = self.now.load(Ordering::Acquire);
        let ended = now.wrapping_add(self.idle.load(Ordering::Acquire));
        let rested = self.rested.load(Ordering::Relaxed);
        let moved = rested & !1 != ended;
        (ended, [moved, !moved && rested & 1 == 1])
    }

    /// Whether no tick has begun since [`Self::ended`] returned `ended`. If so, all values read in between
    /// belong to the same tick.
    pub fn is_at(&self, ended: u32) -> bool {
        M::fence(Ordering::Acquire);
        self.begun.load(Ordering::Relaxed) == ended
    }
}

/// Whether the instant `a` is before `b`. Both must be less than 2^30 ticks apart.
#[inline(always)]
pub const fn is_before(a: u32, b: u32) -> bool {
    (a.wrapping_sub(b) as i32) < 0
}

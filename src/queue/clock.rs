//! Time: ticks, how far the motion has come, and the words by which the planner takes back time it has handed
//! over.
//!
//! Two clocks run. *Ticks* count every call of the interrupt, whether the path moves or not. *Instants* count
//! the ticks that take time of a piece: motion, dwell, the tick that shows a standstill. Pieces are handed
//! over by instants, so a cut is one too. An instant is twice the number of such ticks since the split,
//! modulo 2^32: even, so that an odd one is never.
//!
//! Every word has one writer:
//!
//! | word | written by | holds |
//! |---|---|---|
//! | `begun` | the interrupt, first thing in a tick | ticks begun |
//! | `now` | the interrupt, last thing in a tick that took time of a piece | the instant of the next one |
//! | `idle` | the interrupt, last thing in any other tick | how many of those there were |
//! | `rested` | the interrupt, in the same | `begun` in the last of them, one more where set points moved |
//! | `left` | the interrupt | how often it has left the queue for a reserve, and for which of two |
//! | `at`, `to` | the planner | the cut: its instant, and the piece that follows then |
//! | `ends`, `firsts`, `cuts` | the planner | two reserves: the instant, the first piece, the last cut before it |
//! | `let_go` | the planner | `left`, when the interrupt may go back to the queue |
//!
//! A tick is at hand while `begun` is ahead of `now` and `idle` together. A planner on the interrupt's own
//! core never finds it so; on another core it waits for that tick to end ([`Clock::settle`]) before it
//! decides anything: a few hundred instructions. The interrupt never waits. (Words that are loaded and stored
//! cannot decide which of two sides came first without one of them waiting.)
//!
//! There is room for two reserves, so that there is one at any time while the next one takes its place. Each
//! holds behind one cut only: for an interrupt that has not taken it, or has taken a later one, there is none.
//!
//! What the planner has written before [`Clock::settle`] is seen by every tick that ends behind it: `begun`
//! is stored before the tick looks at the planner's words, both sides put a sequentially consistent fence
//! between, so one sees what the other wrote.
use super::word::{Memory, Ram, Word};
use core::sync::atomic::Ordering;

/// One tick, in units of an instant.
pub const TICK: u32 = 2;

const NEVER: u32 = 1;

/// One of the two reserves.
#[derive(Clone, Copy, Debug, Hash, PartialEq, Eq)]
pub enum Kept {
    /// The first.
    One = 0,
    /// The second.
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

/// Shared by planner, interrupt and operator.
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
    /// Memory for one; all bits zero.
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

    /// Starts anew. Call it before both sides run.
    pub fn reset(&mut self) {
        *self = Self::blank();
        self.withdraw();
        self.withdraw_reserves();
    }
}

/// For the interrupt.
impl<M: Memory> Clock<M> {
    /// A tick begins: its instant, should it take time of a piece.
    #[inline(always)]
    pub fn begin(&self) -> u32 {
        let begun = self.begun.load(Ordering::Relaxed).wrapping_add(TICK);
        self.begun.store(begun, Ordering::Relaxed);
        M::fence(Ordering::SeqCst);
        self.own()
    }

    /// A tick ends that took time of a piece.
    #[inline(always)]
    pub fn pass(&self) {
        self.now.store(self.own().wrapping_add(TICK), Ordering::Release);
    }

    /// A tick ends that did not.
    pub fn rest(&self) {
        self.rest_while(false);
    }

    /// As [`Self::rest`]; `moves`: set points moved in this tick although the path stood.
    pub fn rest_while(&self, moves: bool) {
        // Counts of ticks are even.
        self.rested.store(self.begun.load(Ordering::Relaxed) | u32::from(moves), Ordering::Relaxed);
        let idle = self.idle.load(Ordering::Relaxed);
        self.idle.store(idle.wrapping_add(TICK), Ordering::Release);
    }

    /// The number of the current tick, from 0.
    pub fn tick(&self) -> u32 {
        self.begun.load(Ordering::Relaxed).wrapping_sub(TICK) / TICK
    }

    /// The instant of the next piece of time.
    #[inline(always)]
    pub fn own(&self) -> u32 {
        self.now.load(Ordering::Relaxed)
    }

    /// The number of the piece to go on with, if there is a cut at `instant`.
    #[inline(always)]
    pub fn cut(&self, instant: u32) -> Option<u32> {
        if self.at.load(Ordering::Relaxed) != instant {
            return None;
        }
        M::fence(Ordering::Acquire);
        Some(self.to.load(Ordering::Relaxed))
    }

    /// Whether what was planned may end at `instant`, and the motion is to stop.
    #[inline(always)]
    pub fn is_end(&self, instant: u32) -> bool {
        let [one, other] = &self.ends;
        one.load(Ordering::Relaxed) == instant || other.load(Ordering::Relaxed) == instant
    }

    /// Changes from the queue to the reserve of an instant after the last change of plan, and gives its first piece;
    /// `None` if the reserve belongs to another plan.
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

    /// Whether the interrupt may return to the queue.
    pub fn is_let_go(&self) -> bool {
        self.let_go.load(Ordering::Acquire) == self.left.load(Ordering::Relaxed)
    }
}

/// For the planner.
impl<M: Memory> Clock<M> {
    /// The instant of the next tick that takes time of a piece.
    #[inline(always)]
    pub fn now(&self) -> u32 {
        self.now.load(Ordering::Acquire)
    }

    /// Ticks that took no time of a piece, in units of [`TICK`].
    pub fn idle(&self) -> u32 {
        self.idle.load(Ordering::Acquire)
    }

    /// Waits until each tick that ends from now on sees what was written before. On another core than the interrupt's
    /// it waits for the current tick.
    pub fn settle(&self) {
        M::fence(Ordering::SeqCst);
        let begun = self.begun.load(Ordering::Acquire);
        M::wait(|| {
            let now = self.now.load(Ordering::Acquire);
            !is_before(now.wrapping_add(self.idle.load(Ordering::Acquire)), begun)
        });
    }

    /// Publishes a cut, while there is none: at `instant` the interrupt goes on with the piece `number`.
    pub fn publish(&self, instant: u32, number: u32) {
        self.to.store(number, Ordering::Relaxed);
        self.at.store(instant, Ordering::Release);
        self.settle();
    }

    /// Takes back a cut that the interrupt has taken, or whose instant has passed.
    pub fn withdraw(&self) {
        self.at.store(NEVER, Ordering::Relaxed);
    }

    /// Adds the reserve that holds at `instant`, begins with the piece `first`, and follows the change to the piece
    /// `cut`; `other` stays valid.
    pub fn keep(&self, other: Option<Kept>, instant: u32, first: u32, cut: u32) -> Kept {
        let kept = if other == Some(Kept::One) { Kept::Other } else { Kept::One };
        kept.of(&self.firsts).store(first, Ordering::Relaxed);
        kept.of(&self.cuts).store(cut, Ordering::Relaxed);
        kept.of(&self.ends).store(instant, Ordering::Release);
        kept
    }

    /// Takes a reserve back; `false`: the interrupt has gone on with it before.
    pub fn release(&self, kept: Kept) -> bool {
        kept.of(&self.ends).store(NEVER, Ordering::Release);
        self.settle();
        !self.has_left() || self.left.load(Ordering::Relaxed) & 1 != kept as u32
    }

    fn withdraw_reserves(&self) {
        self.ends.iter().for_each(|end| end.store(NEVER, Ordering::Release));
    }

    /// Whether the interrupt stops, or stands, without the planner.
    #[inline(always)]
    pub fn has_left(&self) -> bool {
        let has_left = self.left.load(Ordering::Relaxed) != self.let_go.load(Ordering::Relaxed);
        if has_left {
            M::fence(Ordering::Acquire);
        }
        has_left
    }

    /// The interrupt, at the end of the reserve, goes on with what is in the queue, and looks at the reserve
    /// no more.
    pub fn let_go(&self) {
        self.withdraw_reserves();
        self.let_go.store(self.left.load(Ordering::Acquire), Ordering::Release);
        self.settle();
    }
}

/// For the operator.
impl<M: Memory> Clock<M> {
    /// Ticks ended, in units of [`TICK`], and of the last one whether it took time of a piece, or else whether set
    /// points moved in it. For a snapshot: see [`Self::is_at`].
    pub fn ended(&self) -> (u32, [bool; 2]) {
        let now = self.now.load(Ordering::Acquire);
        let ended = now.wrapping_add(self.idle.load(Ordering::Acquire));
        let rested = self.rested.load(Ordering::Relaxed);
        let moved = rested & !1 != ended;
        (ended, [moved, !moved && rested & 1 == 1])
    }

    /// Whether no tick has begun since so many had ended: then all that was read in between belongs together.
    pub fn is_at(&self, ended: u32) -> bool {
        M::fence(Ordering::Acquire);
        self.begun.load(Ordering::Relaxed) == ended
    }
}

/// Whether the instant `a` is before `b`; they are less than 2^30 ticks apart.
#[inline(always)]
pub const fn is_before(a: u32, b: u32) -> bool {
    (a.wrapping_sub(b) as i32) < 0
}

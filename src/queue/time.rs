//! How the interrupt goes from one piece of time to the next, and how the planner changes what it has handed
//! over.
//!
//! Pieces are handed over well ahead. To change what is to come, the planner agrees on an instant with the
//! interrupt, a *cut*: before the tick of that instant the interrupt leaves the pieces it has and goes on
//! with the one the cut names. Up to that instant the old pieces hold.
//!
//! No order of events can mix both:
//!
//! 1. The planner puts a *barrier* behind the old pieces, a piece of no ticks, which the interrupt does not
//!    pass, then the new pieces ([`Change::begin`]). Nothing has changed for the interrupt.
//! 2. It publishes the cut: the piece first, then the instant. It waits for the tick at hand, if there is one
//!    ([`Clock::settle`]): from there on every tick sees the cut.
//! 3. It reads the instant of the next tick. If that is not behind the cut, the interrupt will take it. If it
//!    is, the interrupt says: by its count of pieces taken, beyond the barrier, it acknowledges that it has
//!    taken the cut. Without that it never will, and stays before the barrier; the planner takes barrier and pieces
//!    back ([`Change::commit`]).
//!
//! The end of what is in the queue has a standing cut of its own, the *reserve*: where the laws handed over
//! end at speed, the interrupt goes on with a way to a standstill, unless the planner has moved the reserve
//! on before. So a planner that gets no time needs to do nothing for the motion to slow down. The pieces of
//! that way have a place of their own ([`super::reserve`]). Once there, the interrupt stays with them until
//! the planner lets it go on. A cut and the reserve behind it change together ([`Change::hand_over`]): whenever
//! the planner is kept from its work in between, there is a way, and the right one.
//!
//! `host-tests/tests/interleavings` runs this code in every order of its accesses to shared words.
use super::word::{Memory, Ram, Replay};
use super::{Clock, Consumer, Keeper, PHASES, Phase, Producer, Slot, Taker};

/// The planner's end of the ring.
pub type Pieces<'a, M = Ram> = Producer<'a, Phase, PHASES, M>;

/// Barrier and new pieces that are being put in for a cut. [`Self::commit`] or [`Self::abandon`] ends it.
#[derive(Debug)]
#[must_use]
pub struct Change {
    /// The number of the first piece put in.
    first: u32,
    has_barrier: bool,
}

/// The interrupt leaves the pieces it has at this instant, or has done so.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cut(pub u32);

/// The interrupt has passed the instant of the cut on the pieces it had; all is as before.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TooLate;

/// New pieces do not count; all is as before.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NotNow {
    /// The interrupt has passed the instant of the cut on the pieces it had.
    TooLate,
    /// It has gone on with the way in reserve.
    Left,
}

/// Replaces the stop in force by the new one, which holds at the instant `at`, without a tick between. `false`: the
/// interrupt uses the old stop already, and it stays.
pub fn renew<M: Memory>(at: u32, keeper: &mut Keeper<'_, M>, clock: &Clock<M>) -> bool {
    let kept = keeper.hold(at, None, clock);
    let is_free = keeper.release(clock);
    if is_free {
        keeper.commit(Some(kept), None);
    } else {
        clock.release(kept);
    }
    is_free
}

impl Change {
    /// Puts the barrier in; what is put in from here on counts from the cut. There is room.
    pub fn begin<M: Memory, const N: usize>(pieces: &mut Producer<'_, Phase, N, M>) -> Self {
        let first = pieces.count();
        let _ = pieces.push(Phase::BLANK);
        Self { first, has_barrier: true }
    }

    /// A change for pieces that follow all pieces in the queue: nothing is left out, and no end marker is needed.
    pub fn append<M: Memory, const N: usize>(pieces: &Producer<'_, Phase, N, M>) -> Self {
        Self { first: pieces.count(), has_barrier: false }
    }

    /// The cut at `at`, the instant at which the new pieces begin. There is no other cut. Not where the reserve
    /// matters: [`Self::hand_over`].
    ///
    /// # Errors
    /// [`TooLate`]: barrier and new pieces are taken back.
    pub fn commit<M: Memory, const N: usize>(
        self,
        at: u32,
        pieces: &mut Producer<'_, Phase, N, M>,
        clock: &Clock<M>,
    ) -> Result<Cut, TooLate> {
        if self.publish(at, pieces, clock) {
            return Ok(Cut(at));
        }
        clock.withdraw();
        self.abandon(pieces, clock);
        Err(TooLate)
    }

    /// Whether the cut at `at` is in time.
    fn publish<M: Memory, const N: usize>(
        &self,
        at: u32,
        pieces: &Producer<'_, Phase, N, M>,
        clock: &Clock<M>,
    ) -> bool {
        clock.publish(at, self.first.wrapping_add(1));
        let is_ahead = !super::clock::is_before(at, clock.now());
        is_ahead || pieces.taken().wrapping_sub(self.first) as i32 > 0
    }

    /// Puts the new pieces in force from the instant `at` on, and with them the new reserve, which holds at the instant
    /// `way`; there is none if the pieces end in a stop. At each tick one of the two reserves is in force: the new one
    /// after the change only, the old one until the change is known to be in time.
    ///
    /// # Errors
    /// The change is too late, or the interrupt uses the old reserve. End marker and new pieces are withdrawn; nothing
    /// changes.
    pub fn hand_over<M: Memory, const N: usize>(
        self,
        at: u32,
        way: Option<u32>,
        pieces: &mut Producer<'_, Phase, N, M>,
        keeper: &mut Keeper<'_, M>,
        clock: &Clock<M>,
    ) -> Result<Option<Cut>, NotNow> {
        let cut = self.has_barrier.then_some(self.first.wrapping_add(1));
        let kept = way.map(|instant| keeper.hold(instant, cut, clock));
        let not_now = if self.has_barrier && !self.publish(at, pieces, clock) {
            NotNow::TooLate
        } else if !keeper.release(clock) {
            NotNow::Left
        } else {
            keeper.commit(kept, cut);
            return Ok(cut.map(|_| Cut(at)));
        };
        if self.has_barrier {
            clock.withdraw();
        }
        if let Some(kept) = kept {
            clock.release(kept);
        }
        self.abandon(pieces, clock);
        Err(not_now)
    }

    /// Takes barrier and new pieces back.
    pub fn abandon<M: Memory, const N: usize>(
        self,
        pieces: &mut Producer<'_, Phase, N, M>,
        clock: &Clock<M>,
    ) {
        pieces.withdraw(self.first);
        // A tick at hand may look at the barrier.
        clock.settle();
    }
}

/// The interrupt's end of the profile: the current piece and the next ones.
pub struct Timeline<'a, M: Memory = Ram> {
    phase: Phase,
    pieces: Consumer<'a, Phase, PHASES, M>,
    reserve: Taker<'a, M>,
    /// Ticks of the piece evaluated.
    done: u16,
    /// It stops, or stands, without the planner.
    stops: bool,
    /// The piece of the last cut taken.
    cut: u32,
}

impl<M: Replay> Clone for Timeline<'_, M> {
    fn clone(&self) -> Self {
        let Self { phase, pieces, reserve, done, stops, cut } = self;
        let (pieces, reserve) = (pieces.clone(), reserve.clone());
        Self { phase: *phase, pieces, reserve, done: *done, stops: *stops, cut: *cut }
    }
}

impl<M: Replay> Timeline<'_, M> {
    /// All that it remembers from one tick to the next.
    pub const fn key(&self) -> (Phase, u16, bool, ((u32, usize), u32)) {
        (self.phase, self.done, self.stops, (self.reserve.next(), self.cut))
    }
}

impl<'a, M: Memory> Timeline<'a, M> {
    /// A timeline without a piece.
    pub const fn new(pieces: Consumer<'a, Phase, PHASES, M>, reserve: Taker<'a, M>) -> Self {
        Self { phase: Phase::BLANK, pieces, reserve, done: 0, stops: false, cut: 0 }
    }

    /// A tick begins: its path distance, LSB 2^-44 mm, or `None` if there is no piece.
    /// [`Clock::pass`] or [`Clock::rest`] ends it.
    #[inline(always)]
    pub fn begin(&mut self, clock: &Clock<M>) -> Option<i64> {
        let instant = clock.begin();
        if let Some(number) = clock.cut(instant) {
            self.change_over(number);
        }
        if self.done >= self.phase.ticks {
            let more = if clock.is_end(instant) {
                self.stop(clock, true)
            } else if self.stops {
                self.stop(clock, false)
            } else {
                self.take()
            };
            if !more {
                return None;
            }
            self.done = 0;
        }
        let distance = self.phase.at(self.done);
        self.done += 1;
        Some(distance)
    }

    #[inline(always)]
    fn take(&mut self) -> bool {
        self.pieces.pop_into(&mut self.phase, |phase| phase.ticks > 0)
    }

    /// Leaves the pieces it has; on its way to a standstill it has left them for good.
    #[cold]
    #[inline(never)]
    fn change_over(&mut self, number: u32) {
        if !self.stops {
            self.pieces.jump(number);
            self.done = u16::MAX;
            self.cut = number;
        }
    }

    /// The next piece of the way to a standstill, which may begin here; behind it, when the planner has seen
    /// it, of what it has put into the queue since.
    #[cold]
    #[inline(never)]
    fn stop(&mut self, clock: &Clock<M>, begins: bool) -> bool {
        if begins
            && !self.stops
            && let Some(first) = clock.leave(clock.own(), self.cut)
        {
            self.reserve.begin(first);
            self.stops = true;
        }
        if !self.stops {
            return self.take();
        }
        if !clock.is_let_go() {
            return self.reserve.take_into(&mut self.phase);
        }
        self.stops = false;
        self.take()
    }

    /// The current piece, and the tick of it that was evaluated last.
    pub fn at_hand(&self) -> (&Phase, u16) {
        (&self.phase, self.done.saturating_sub(1))
    }
}

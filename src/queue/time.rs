//! The interrupt's step from one piece to the next, and the planner's change of pieces that the interrupt may
//! already see.
//!
//! The planner writes pieces well ahead. To replace future pieces, the planner agrees with the interrupt on a
//! tick, the *cut*. Before the cut, the interrupt uses the old pieces. At the cut, the interrupt goes to the
//! first new piece.
//!
//! In any order of events, the interrupt uses either the old pieces or the new ones:
//!
//! 1. The planner writes an end marker (*barrier*) behind the old pieces, and the new pieces behind the
//!    marker ([`Change::begin`]). The marker is a piece of no ticks, which the interrupt does not pass. So
//!    nothing changes for the interrupt.
//! 2. The planner publishes the cut: first the new piece, then the tick. If a tick is running on another
//!    core, the planner waits for its end ([`Clock::settle`]). From here on, every tick sees the cut.
//! 3. The planner checks whether the cut is in time ([`Change::commit`]). If the next tick is not after the
//!    cut, the interrupt will take the cut. If the next tick is after the cut, the interrupt has taken the
//!    cut only if it has passed the marker. Otherwise the interrupt never takes the cut and stays before the
//!    marker. In that case, the planner withdraws the marker and the new pieces.
//!
//! **Reserve.** If the queue ends at speed, the end of the queue has a cut that is always there. This cut
//! leads to the reserve: a planned stop, whose pieces are in a separate memory ([`super::reserve`]). If the
//! planner has not written more pieces by then, the interrupt takes this cut, and the axes brake. The
//! interrupt stays with the stop until the planner lets it return to the queue. A change of plan and the
//! reserve after it take effect together ([`Change::hand_over`]). So there is a valid stop at every moment,
//! even if the planner is interrupted in between.
//!
//! `host-tests/tests/interleavings` runs this code in every order of its accesses to shared words.
use super::word::{Memory, Ram, Replay};
use super::{Clock, Consumer, Keeper, PHASES, Phase, Producer, Slot, Taker};

/// The planner's handle for the pieces of the speed profile.
pub type Pieces<'a, M = Ram> = Producer<'a, Phase, PHASES, M>;

/// A change of plan in preparation: the barrier, and the new pieces written after it. [`Self::commit`],
/// [`Self::hand_over`] or [`Self::abandon`] ends the change.
#[derive(Debug)]
#[must_use]
pub struct Change {
    /// The number of the first new piece.
    first: u32,
    has_barrier: bool,
}

/// The instant of a change of plan (the cut): there the interrupt changes from its old pieces to new ones, or
/// has changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cut(pub u32);

/// The error of a late change: the interrupt has passed the instant of the cut on its old pieces. Nothing has
/// changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TooLate;

/// The reason why a change of plan had no effect. The old plan continues unchanged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NotNow {
    /// The interrupt has already passed the instant of the change.
    TooLate,
    /// The interrupt already uses the reserve, because the queue was empty.
    Left,
}

/// Replaces the stop in force by the stop that `keeper` has written last, which is valid from the instant
/// `at` on. Every tick has a valid stop. Returns `false` if the interrupt already uses the old stop; the old
/// stop then stays.
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
    /// Begins a change: writes the barrier. Pieces written after the barrier are valid from the cut on. The
    /// queue must have room for the barrier.
    pub fn begin<M: Memory, const N: usize>(pieces: &mut Producer<'_, Phase, N, M>) -> Self {
        let first = pieces.count();
        let _ = pieces.push(Phase::BLANK);
        Self { first, has_barrier: true }
    }

    /// Begins a change for pieces that follow all pieces in the queue. No piece is withdrawn, so no barrier
    /// is needed.
    pub fn append<M: Memory, const N: usize>(pieces: &Producer<'_, Phase, N, M>) -> Self {
        Self { first: pieces.count(), has_barrier: false }
    }

    /// Publishes the cut: from the instant `at` on, the new pieces are valid. There must be no other cut. If
    /// a reserve exists, use [`Self::hand_over`].
    ///
    /// # Errors
    /// Returns [`TooLate`] if the interrupt has already passed that instant. Barrier and new pieces are then
    /// withdrawn.
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

    /// Publishes the cut at `at` and returns whether it is in time.
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

    /// Publishes the cut: from the instant `at` on, the new pieces are valid. The new reserve, a stop from
    /// the instant `way` on, becomes valid with them. If the pieces end in a stop, there is no new reserve.
    /// At each tick, one reserve is valid: first the old one, and the new one as soon as the change is known
    /// to be in time.
    ///
    /// # Errors
    /// The change is too late, or the interrupt uses the old reserve. Barrier and new pieces are withdrawn;
    /// nothing changes.
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

    /// Withdraws the barrier and the new pieces after it: the change of plan does not take place.
    pub fn abandon<M: Memory, const N: usize>(
        self,
        pieces: &mut Producer<'_, Phase, N, M>,
        clock: &Clock<M>,
    ) {
        pieces.withdraw(self.first);
        // A tick in progress may read the barrier.
        clock.settle();
    }
}

/// The interrupt's handle of the speed profile: the current piece and the next ones.
pub struct Timeline<'a, M: Memory = Ram> {
    phase: Phase,
    pieces: Consumer<'a, Phase, PHASES, M>,
    reserve: Taker<'a, M>,
    /// Number of ticks evaluated in the current piece.
    done: u16,
    /// Whether the interrupt has changed to the reserve.
    stops: bool,
    /// Number of the piece after the last cut that the interrupt has taken.
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
    /// All state that this handle keeps from one tick to the next, for comparison in tests.
    pub const fn key(&self) -> (Phase, u16, bool, ((u32, usize), u32)) {
        (self.phase, self.done, self.stops, (self.reserve.next(), self.cut))
    }
}

impl<'a, M: Memory> Timeline<'a, M> {
    /// A timeline without a piece.
    pub const fn new(pieces: Consumer<'a, Phase, PHASES, M>, reserve: Taker<'a, M>) -> Self {
        Self { phase: Phase::BLANK, pieces, reserve, done: 0, stops: false, cut: 0 }
    }

    /// Begins a tick. Returns its path distance, LSB 2^-44 mm, or `None` if there is no piece.
    /// [`Clock::pass`] or [`Clock::rest`] ends the tick.
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

    /// Leaves the current pieces and continues at the cut. If the interrupt already uses a reserve, it has
    /// left the queue and ignores the cut.
    #[cold]
    #[inline(never)]
    fn change_over(&mut self, number: u32) {
        if !self.stops {
            self.pieces.jump(number);
            self.done = u16::MAX;
            self.cut = number;
        }
    }

    /// Takes the next piece of the stop. `begins`: the stop may begin here. At the end of the stop, after the
    /// planner has seen it, takes the next piece that the planner has written since.
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

    /// The current piece, and the number of the tick within the piece that was evaluated last.
    pub fn at_hand(&self) -> (&Phase, u16) {
        (&self.phase, self.done.saturating_sub(1))
    }
}

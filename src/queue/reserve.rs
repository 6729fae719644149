//! The pieces of a way to a standstill that the interrupt goes on with if the planner gets no time
//! ([`super::clock`]).
//!
//! One array holds the way in force and, behind it, the one that is being written: each ends with a piece of
//! no ticks, and has half of the array. So there is room for the next one whatever the one in force is. The
//! interrupt reads only the way in force, and only once it has left the queue for it; from then on until it is
//! let go nothing is written. While one way takes the place of the other both are left alone.
#![allow(unsafe_code)]
use super::clock::Kept;
use super::word::{Memory, Place, Ram, Replay};
use super::{Clock, Phase};
use crate::machine::functions;

/// Pieces of both ways together, a power of two. Usual ways have twenty at most; those through a whole chain of knees,
/// or of long ramps at short cycles, have more.
pub const STOP_PIECES: usize = if functions::IS_SMALL { 64 } else { 256 };
/// Pieces of a way, with the one that ends it.
pub const WAY_PIECES: u32 = STOP_PIECES as u32 / 2;
const MASK: u32 = STOP_PIECES as u32 - 1;

/// Static memory of the ways.
pub struct Reserve<M: Memory = Ram> {
    pieces: [M::Place<Phase>; STOP_PIECES],
}

// SAFETY: the interrupt reads pieces in force, the planner writes others; the clock says which are in force,
// with release and acquire.
unsafe impl<M: Memory> Sync for Reserve<M> {}

/// Writes ways.
pub struct Keeper<'a, M: Memory = Ram> {
    reserve: &'a Reserve<M>,
    /// The way in force: its first piece and how many there are.
    first: u32,
    count: u32,
    /// The same of the one that is being written.
    start: u32,
    written: u32,
    /// Where the clock has the one in force.
    kept: Option<Kept>,
    /// The piece of the last cut that the interrupt has taken or will take.
    cut: u32,
}

/// Goes along the way in force.
pub struct Taker<'a, M: Memory = Ram> {
    reserve: &'a Reserve<M>,
    next: u32,
}

impl<M: Memory> Reserve<M> {
    /// No way; all bits zero.
    pub const fn blank() -> Self {
        const { assert!(STOP_PIECES.is_power_of_two()) };
        Self { pieces: [const { M::Place::BLANK }; STOP_PIECES] }
    }

    /// Both ends.
    pub fn split(&mut self) -> (Keeper<'_, M>, Taker<'_, M>) {
        let keeper = Keeper { reserve: self, first: 0, count: 0, start: 0, written: 0, kept: None, cut: 0 };
        (keeper, Taker { reserve: self, next: 0 })
    }

    fn piece(&self, number: u32) -> &M::Place<Phase> {
        // The mask is below the length: the optimiser removes the check.
        &self.pieces[(number & MASK) as usize]
    }
}

impl<M: Replay> Clone for Keeper<'_, M> {
    fn clone(&self) -> Self {
        Self { ..*self }
    }
}

impl<M: Replay> Keeper<'_, M> {
    /// All that it remembers.
    pub const fn key(&self) -> ([u32; 5], Option<Kept>) {
        ([self.first, self.count, self.start, self.written, self.cut], self.kept)
    }
}

impl<M: Replay> Clone for Taker<'_, M> {
    fn clone(&self) -> Self {
        Self { ..*self }
    }
}

impl<M: Memory> Keeper<'_, M> {
    /// Begins a new way. Not while the interrupt is on the one in force.
    pub const fn begin(&mut self) {
        self.start = self.first.wrapping_add(self.count);
        self.written = 0;
    }

    /// Its next piece; one of no ticks ends it. `false` if there is no room.
    pub fn push(&mut self, piece: Phase) -> bool {
        if self.written >= WAY_PIECES {
            return false;
        }
        let number = self.start.wrapping_add(self.written);
        // SAFETY: outside of the way in force: the interrupt does not look at it.
        unsafe { self.reserve.piece(number).write(|place| *place = piece) };
        self.written += 1;
        true
    }

    /// The new way holds at `instant` beside the one in force, behind the cut to the piece `cut`, or behind the last
    /// one.
    pub(super) fn hold(&self, instant: u32, cut: Option<u32>, clock: &Clock<M>) -> Kept {
        clock.keep(self.kept, instant, self.start, cut.unwrap_or(self.cut))
    }

    /// The way in force is taken back, if there is one; `false`: the interrupt has gone on with it before.
    pub(super) fn release(&self, clock: &Clock<M>) -> bool {
        self.kept.is_none_or(|kept| clock.release(kept))
    }

    /// The new way is the one in force, or none is. Not before the old one was taken back.
    pub(super) const fn commit(&mut self, kept: Option<Kept>, cut: Option<u32>) {
        (self.first, self.count) = (self.start, if kept.is_some() { self.written } else { 0 });
        (self.kept, self.written) = (kept, 0);
        if let Some(cut) = cut {
            self.cut = cut;
        }
    }

    /// Pieces of the way that is being written.
    pub const fn written(&self) -> u32 {
        self.written
    }

    /// Takes the way in force back, and none is; `false`: the interrupt has gone on with it before.
    pub fn drop_kept(&mut self, clock: &Clock<M>) -> bool {
        let is_free = self.release(clock);
        if is_free {
            self.clear();
        }
        is_free
    }

    /// None is in force, and the clock has none.
    pub const fn clear(&mut self) {
        (self.count, self.kept) = (0, None);
    }
}

impl<M: Memory> Taker<'_, M> {
    /// The number of the next piece.
    pub const fn next(&self) -> u32 {
        self.next
    }

    /// At the first piece of the way in force.
    pub const fn begin(&mut self, first: u32) {
        self.next = first;
    }

    /// Its next piece into `piece`; `false` at its end.
    pub fn take_into(&mut self, piece: &mut Phase) -> bool {
        // SAFETY: of the way in force, up to the piece that ends it; the planner leaves it alone.
        let is_piece = unsafe {
            self.reserve.piece(self.next).read(|next| {
                if next.ticks > 0 {
                    *piece = *next;
                }
                next.ticks > 0
            })
        };
        self.next = self.next.wrapping_add(u32::from(is_piece));
        is_piece
    }
}

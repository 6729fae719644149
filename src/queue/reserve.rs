//! The pieces of the reserve: the stop that the interrupt executes if the planner gets no time
//! ([`super::clock`]).
//!
//! One array holds two stops, each in one half: the stop in force, and the stop that the planner is writing.
//! A piece of no ticks marks the end of a stop. The interrupt reads only the stop in force, and only after it
//! has left the queue. From then on, the planner writes no piece, until it lets the interrupt return to the
//! queue. While one stop replaces the other, both stay unchanged.
//!
//! A stop may have many pieces, because a piece on a ramp lasts at most 128 ticks. To save memory, a piece
//! that continues the piece before, except for rounding, is stored as this rounding alone. Four such pieces
//! take the place of one whole piece ([`change`]). Reading returns exactly the pieces that were written.
#![allow(unsafe_code)]
use super::clock::Kept;
use super::word::{Memory, Place, Ram, Replay};
use super::{Clock, Phase, Slot};
use crate::machine::functions;
use crate::quantity::{Accel, Distance, Jerk, Speed};

/// Number of places for the pieces of both stops, a power of two. A place holds one piece, or four that
/// continue the piece before. Usual stops have at most twenty pieces. A stop has more pieces if it leads
/// through many close corners without curves, or if its ramps are long compared with a tick.
pub const STOP_PIECES: usize = if functions::IS_SMALL { 64 } else { 256 };
/// Places for the pieces of one stop. One of them is for the end mark.
pub const WAY_PIECES: u32 = STOP_PIECES as u32 / 2;
const MASK: u32 = STOP_PIECES as u32 - 1;

/// Number of continuing pieces in the place of one whole piece.
const CHANGES: usize = 4;

/// Bits for a continuing piece: ticks, path distance, half the acceleration. The other 26 bits are for the
/// speed.
const TICKS: u32 = 10;
const PARTS: u32 = 14;
const ONES: i64 = (1 << PARTS) - 1;

/// Whether `piece` may be stored as a continuation of the piece before: both have the same jerk. At constant
/// speed, pieces are so long that each gets its own place.
fn may_go_on(before: &Phase, piece: &Phase) -> bool {
    let jerk = piece.sixth_jerk.to_bits();
    jerk == before.sixth_jerk.to_bits() && piece.half_accel.to_bits() | jerk != 0
}

/// How far `piece` differs by rounding from an exact continuation of the piece before, which has the same
/// jerk; never zero. Returns `None` if the difference is more than rounding. Not inlined, because most pieces
/// have another jerk.
#[inline(never)]
fn change(before: &Phase, piece: &Phase) -> Option<i64> {
    let mut ends = *before;
    ends.advance(ends.ticks);
    let Phase { distance, speed, half_accel, ticks, .. } = *piece;
    let distance = distance.to_bits().wrapping_sub(ends.distance.to_bits());
    let half = half_accel.to_bits().wrapping_sub(ends.half_accel.to_bits());
    let speed = speed.to_bits().wrapping_sub(ends.speed.to_bits());
    let change = speed << (TICKS + 2 * PARTS)
        | (half & ONES) << (TICKS + PARTS)
        | (distance & ONES) << TICKS
        | i64::from(ticks);
    (parts(change) == (distance, half, speed, ticks) && ticks > 0).then_some(change)
}

/// The parts of a difference: path distance, half the acceleration, speed, ticks.
const fn parts(change: i64) -> (i64, i64, i64, u16) {
    const UP: u32 = 64 - PARTS;
    let ticks = change & ((1 << TICKS) - 1);
    (
        change << (UP - TICKS) >> UP,
        change << (UP - TICKS - PARTS) >> UP,
        change >> (TICKS + 2 * PARTS),
        ticks as u16,
    )
}

fn put_change(place: &mut Phase, number: usize, change: i64) {
    match number {
        0 => place.distance = Distance::from_bits(change),
        1 => place.speed = Speed::from_bits(change),
        2 => place.half_accel = Accel::from_bits(change),
        _ => place.sixth_jerk = Jerk::from_bits(change),
    }
}

/// The continuing pieces in a place. A whole piece of no ticks marks such a place.
fn changes(place: &Phase) -> [i64; CHANGES] {
    let Phase { distance, speed, half_accel, sixth_jerk, .. } = *place;
    [distance.to_bits(), speed.to_bits(), half_accel.to_bits(), sixth_jerk.to_bits()]
}

/// Static memory of two stops: the one in force and the one that the planner is writing.
pub struct Reserve<M: Memory = Ram> {
    pieces: [M::Place<Phase>; STOP_PIECES],
}

// SAFETY: the interrupt reads only the pieces in force, and the planner writes only the others. The clock
// says which pieces are in force, with release and acquire.
unsafe impl<M: Memory> Sync for Reserve<M> {}

/// The planner's handle: writes the pieces of the next stop, and puts this stop in force.
pub struct Keeper<'a, M: Memory = Ram> {
    reserve: &'a Reserve<M>,
    /// The stop in force: number of its first piece, and number of its pieces.
    first: u32,
    count: u32,
    /// The stop that is being written. Its first and last piece, the number of its pieces, and the number of
    /// continuing pieces in the current place.
    start: u32,
    written: u32,
    last: Phase,
    changes: usize,
    /// The reserve of the clock that is in force.
    kept: Option<Kept>,
    /// The piece after the last cut that the interrupt has taken or will take.
    cut: u32,
}

/// The interrupt's handle: reads the pieces of the stop in force.
pub struct Taker<'a, M: Memory = Ram> {
    reserve: &'a Reserve<M>,
    next: u32,
    /// Index of the next piece within its place.
    change: usize,
}

impl<M: Memory> Reserve<M> {
    /// Memory without a stop; all bits are zero.
    pub const fn blank() -> Self {
        const { assert!(STOP_PIECES.is_power_of_two()) };
        Self { pieces: [const { M::Place::BLANK }; STOP_PIECES] }
    }

    /// The handles of planner and interrupt.
    pub fn split(&mut self) -> (Keeper<'_, M>, Taker<'_, M>) {
        let (first, count, start, written, cut) = (0, 0, 0, 0, 0);
        let last = Phase::BLANK;
        let keeper =
            Keeper { reserve: self, first, count, start, written, last, changes: 0, kept: None, cut };
        (keeper, Taker { reserve: self, next: 0, change: 0 })
    }

    fn piece(&self, number: u32) -> &M::Place<Phase> {
        // The mask is below the length, so the optimiser removes the check.
        &self.pieces[(number & MASK) as usize]
    }
}

impl<M: Replay> Clone for Keeper<'_, M> {
    fn clone(&self) -> Self {
        Self { ..*self }
    }
}

impl<M: Replay> Keeper<'_, M> {
    /// All state, for comparison in tests.
    pub fn key(&self) -> ([u32; 5], (i64, u16, usize), Option<Kept>) {
        let numbers = [self.first, self.count, self.start, self.written, self.cut];
        (numbers, (self.last.distance.to_bits(), self.last.ticks, self.changes), self.kept)
    }
}

impl<M: Replay> Clone for Taker<'_, M> {
    fn clone(&self) -> Self {
        Self { ..*self }
    }
}

impl<M: Memory> Keeper<'_, M> {
    /// Begins to write a new stop. Do not call this function while the interrupt uses the stop in force.
    pub const fn begin(&mut self) {
        self.start = self.first.wrapping_add(self.count);
        (self.written, self.last, self.changes) = (0, Phase::BLANK, CHANGES);
    }

    /// Appends a piece to the new stop; a piece of no ticks ends the stop. Returns `false` if there is no
    /// room.
    pub fn push(&mut self, piece: Phase) -> bool {
        let goes_on = self.written > 0 && may_go_on(&self.last, &piece);
        let change = if goes_on { change(&self.last, &piece) } else { None };
        if let Some(change) = change
            && self.changes < CHANGES
        {
            let number = self.start.wrapping_add(self.written).wrapping_sub(1);
            // SAFETY: the place is outside the stop in force, so the interrupt does not read it.
            unsafe { self.reserve.piece(number).write(|place| put_change(place, self.changes, change)) };
            (self.last, self.changes) = (piece, self.changes + 1);
            return true;
        }
        if self.written >= WAY_PIECES {
            return false;
        }
        let number = self.start.wrapping_add(self.written);
        let put = |place: &mut Phase| {
            *place = piece;
            if let Some(change) = change {
                *place = Phase::BLANK;
                put_change(place, 0, change);
            }
        };
        // SAFETY: as above.
        unsafe { self.reserve.piece(number).write(put) };
        (self.last, self.changes) = (piece, if change.is_some() { 1 } else { CHANGES });
        self.written += 1;
        true
    }

    /// Adds the new stop as a reserve that is valid from `instant` on, in addition to the stop in force. The
    /// new stop belongs to the cut to the piece `cut`, or to the last cut.
    pub(super) fn hold(&self, instant: u32, cut: Option<u32>, clock: &Clock<M>) -> Kept {
        clock.keep(self.kept, instant, self.start, cut.unwrap_or(self.cut))
    }

    /// Withdraws the stop in force, if there is one. Returns `false` if the interrupt already uses it.
    pub(super) fn release(&self, clock: &Clock<M>) -> bool {
        self.kept.is_none_or(|kept| clock.release(kept))
    }

    /// Puts the new stop in force, or none. The old stop is already withdrawn.
    pub(super) const fn commit(&mut self, kept: Option<Kept>, cut: Option<u32>) {
        (self.first, self.count) = (self.start, if kept.is_some() { self.written } else { 0 });
        (self.kept, self.written) = (kept, 0);
        if let Some(cut) = cut {
            self.cut = cut;
        }
    }

    /// Number of places that the stop being written uses.
    pub const fn written(&self) -> u32 {
        self.written
    }

    /// Withdraws the stop in force. Returns `false` if the interrupt already uses it.
    pub fn drop_kept(&mut self, clock: &Clock<M>) -> bool {
        let is_free = self.release(clock);
        if is_free {
            self.clear();
        }
        is_free
    }

    /// Forgets the stop in force. Call this function only if the clock has no reserve.
    pub const fn clear(&mut self) {
        (self.count, self.kept) = (0, None);
    }
}

impl<M: Memory> Taker<'_, M> {
    /// The number of the place with the next piece, and the index of the piece within this place.
    pub const fn next(&self) -> (u32, usize) {
        (self.next, self.change)
    }

    /// Goes to the first piece of the stop in force.
    pub const fn begin(&mut self, first: u32) {
        (self.next, self.change) = (first, 0);
    }

    /// Reads the next piece into `piece`, which must hold the piece before. Returns `false` at the end.
    pub fn take_into(&mut self, piece: &mut Phase) -> bool {
        let Self { reserve, next, change } = self;
        // SAFETY: the place belongs to the stop in force, up to its end mark. The planner does not change it.
        let (is_whole, is_last, by) = unsafe {
            reserve.piece(*next).read(|place| {
                if place.ticks > 0 {
                    *piece = *place;
                    return (true, true, 0);
                }
                let changes = changes(place);
                let by = changes.get(*change).copied().unwrap_or(0);
                (false, changes.get(*change + 1).is_none_or(|behind| *behind == 0), by)
            })
        };
        if !is_whole {
            if by == 0 {
                return false;
            }
            go_on(piece, by);
        }
        (*next, *change) = if is_last { (next.wrapping_add(1), 0) } else { (*next, *change + 1) };
        true
    }
}

/// The piece after `piece`.
fn go_on(piece: &mut Phase, change: i64) {
    let (distance, half, speed, ticks) = parts(change);
    piece.advance(piece.ticks);
    piece.distance = Distance::from_bits(piece.distance.to_bits().wrapping_add(distance));
    piece.half_accel = Accel::from_bits(piece.half_accel.to_bits().wrapping_add(half));
    piece.speed = Speed::from_bits(piece.speed.to_bits().wrapping_add(speed));
    piece.ticks = ticks;
}

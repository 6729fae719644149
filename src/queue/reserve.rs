//! The pieces of a way to a standstill that the interrupt goes on with if the planner gets no time
//! ([`super::clock`]).
//!
//! One array holds the way in force and, behind it, the one that is being written: each ends with a piece of
//! no ticks, and has half of the array. So there is room for the next one whatever the one in force is. The
//! interrupt reads only the way in force, and only once it has left the queue for it; from then on until it is
//! let go nothing is written. While one way takes the place of the other both are left alone.
//!
//! A part of a law has many pieces where ramps are long and ticks short: one that goes on as the one before it ended,
//! but for rounding, is kept as that rounding, four of them in the place of a whole one ([`change`]). What is taken
//! out is what was put in, bit by bit.
#![allow(unsafe_code)]
use super::clock::Kept;
use super::word::{Memory, Place, Ram, Replay};
use super::{Clock, Phase, Slot};
use crate::machine::functions;
use crate::quantity::{Accel, Distance, Jerk, Speed};

/// Places for the pieces of both stops, a power of two. A place holds one piece, or four that continue each other.
/// Usual stops have at most twenty pieces; stops through chains of knees, or with long ramps at short cycles, have
/// more.
pub const STOP_PIECES: usize = if functions::IS_SMALL { 64 } else { 256 };
/// Places of one stop, with the place that ends it.
pub const WAY_PIECES: u32 = STOP_PIECES as u32 / 2;
const MASK: u32 = STOP_PIECES as u32 - 1;

/// Pieces that go on in the place of a whole one.
const CHANGES: usize = 4;

/// Bits of a change: ticks, path distance, half the acceleration; the other 26 are the speed's.
const TICKS: u32 = 10;
const PARTS: u32 = 14;
const ONES: i64 = (1 << PARTS) - 1;

/// Whether `piece` may go on behind the one before it: with the same jerk. At constant speed a piece is so long that it
/// has a place of its own.
fn may_go_on(before: &Phase, piece: &Phase) -> bool {
    let jerk = piece.sixth_jerk.to_bits();
    jerk == before.sixth_jerk.to_bits() && piece.half_accel.to_bits() | jerk != 0
}

/// How `piece` differs from where the one before it ends, of the same jerk: a word that is not zero. `None`: by more than
/// rounding. Not inlined: most pieces have another jerk.
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

/// What a change is made of: path distance, half the acceleration, speed, ticks.
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

/// The pieces that go on, in the place of a whole one of no ticks.
fn changes(place: &Phase) -> [i64; CHANGES] {
    let Phase { distance, speed, half_accel, sixth_jerk, .. } = *place;
    [distance.to_bits(), speed.to_bits(), half_accel.to_bits(), sixth_jerk.to_bits()]
}

/// Static memory of both stops.
pub struct Reserve<M: Memory = Ram> {
    pieces: [M::Place<Phase>; STOP_PIECES],
}

// SAFETY: the interrupt reads pieces in force, the planner writes others; the clock says which are in force,
// with release and acquire.
unsafe impl<M: Memory> Sync for Reserve<M> {}

/// Writes the pieces of stops: the planner's end.
pub struct Keeper<'a, M: Memory = Ram> {
    reserve: &'a Reserve<M>,
    /// The way in force: its first piece and how many there are.
    first: u32,
    count: u32,
    /// The same of the one that is being written, its last piece, and how many go on in the place of that.
    start: u32,
    written: u32,
    last: Phase,
    changes: usize,
    /// Where the clock has the one in force.
    kept: Option<Kept>,
    /// The piece of the last cut that the interrupt has taken or will take.
    cut: u32,
}

/// Reads the pieces of the stop in force: the interrupt's end.
pub struct Taker<'a, M: Memory = Ram> {
    reserve: &'a Reserve<M>,
    next: u32,
    /// Which one of those that go on in that place.
    change: usize,
}

impl<M: Memory> Reserve<M> {
    /// No stop; all bits zero.
    pub const fn blank() -> Self {
        const { assert!(STOP_PIECES.is_power_of_two()) };
        Self { pieces: [const { M::Place::BLANK }; STOP_PIECES] }
    }

    /// Both ends.
    pub fn split(&mut self) -> (Keeper<'_, M>, Taker<'_, M>) {
        let (first, count, start, written, cut) = (0, 0, 0, 0, 0);
        let last = Phase::BLANK;
        let keeper =
            Keeper { reserve: self, first, count, start, written, last, changes: 0, kept: None, cut };
        (keeper, Taker { reserve: self, next: 0, change: 0 })
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
    /// Begins a new stop. Do not call it while the interrupt uses the stop in force.
    pub const fn begin(&mut self) {
        self.start = self.first.wrapping_add(self.count);
        (self.written, self.last, self.changes) = (0, Phase::BLANK, CHANGES);
    }

    /// Appends a piece; a piece of no ticks ends the stop. `false` if there is no room.
    pub fn push(&mut self, piece: Phase) -> bool {
        let goes_on = self.written > 0 && may_go_on(&self.last, &piece);
        let change = if goes_on { change(&self.last, &piece) } else { None };
        if let Some(change) = change
            && self.changes < CHANGES
        {
            let number = self.start.wrapping_add(self.written).wrapping_sub(1);
            // SAFETY: outside of the way in force: the interrupt does not look at it.
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
        // SAFETY: the same.
        unsafe { self.reserve.piece(number).write(put) };
        (self.last, self.changes) = (piece, if change.is_some() { 1 } else { CHANGES });
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

    /// Places used by the stop that is being written.
    pub const fn written(&self) -> u32 {
        self.written
    }

    /// Withdraws the stop in force; `false` if the interrupt uses it already.
    pub fn drop_kept(&mut self, clock: &Clock<M>) -> bool {
        let is_free = self.release(clock);
        if is_free {
            self.clear();
        }
        is_free
    }

    /// Forgets the stop; the clock has none.
    pub const fn clear(&mut self) {
        (self.count, self.kept) = (0, None);
    }
}

impl<M: Memory> Taker<'_, M> {
    /// The number of the place of the next piece, and which of those in it it is.
    pub const fn next(&self) -> (u32, usize) {
        (self.next, self.change)
    }

    /// Goes to the first piece of the stop in force.
    pub const fn begin(&mut self, first: u32) {
        (self.next, self.change) = (first, 0);
    }

    /// Reads the next piece into `piece`, which holds the one before; `false` at the end.
    pub fn take_into(&mut self, piece: &mut Phase) -> bool {
        let Self { reserve, next, change } = self;
        // SAFETY: of the way in force, up to the piece that ends it; the planner leaves it alone.
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

/// The piece behind `piece`.
fn go_on(piece: &mut Phase, change: i64) {
    let (distance, half, speed, ticks) = parts(change);
    piece.advance(piece.ticks);
    piece.distance = Distance::from_bits(piece.distance.to_bits().wrapping_add(distance));
    piece.half_accel = Accel::from_bits(piece.half_accel.to_bits().wrapping_add(half));
    piece.speed = Speed::from_bits(piece.speed.to_bits().wrapping_add(speed));
    piece.ticks = ticks;
}

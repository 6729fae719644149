//! The ring of curves, and where each of them begins: the tick finds the one it is on by path distance alone.
//!
//! A curve is written once, when its block goes into the look-ahead, and stays in its place until the
//! interrupt has passed it. The planner counts two kinds of them: those *handed on*, which pieces of time
//! move along, and behind them those of the look-ahead, of which the interrupt already knows where they are.
//!
//! Starts lie in an array of their own, longer than the ring, so that behind the last curve there is room for
//! starts that no distance reaches. So many of them are kept there as a tick looks at: it asks neither how
//! many curves there are nor where the array ends (its head is repeated behind its end), and halves a window
//! of fixed size.
//!
//! A start is the word to the interrupt that its curve is there: it is written behind the curve, the upper
//! half last. What it takes the place of is out of reach in both halves, so that a start half written is out
//! of reach too. Distances can be compared over a limited way only: where the curves of the look-ahead lead
//! beyond, their starts are written when the interrupt comes nearer.
//!
//! In a small build an arc or a polynomial takes two slots ([`super::cells`]): the first one for its part, the second
//! one for the curve. Each of the two has a number and a start. Both starts are the same path distance, so a tick that
//! passes the first slot passes the second one too, and never ends on a part. The interrupt goes by the first start,
//! so that is written last. What is counted here are slots then, and the look-ahead reaches less far where there are
//! many such curves.
//!
//! A slot has the lower half of the number of its motion block. Whoever reads it counts back from the latest number
//! that was put in ([`super::cells::whole`]), so numbers in the ring must be less than 2^16 apart. A curve may stand for
//! many motion blocks: before another one joins them the planner asks whether the numbers get too far apart
//! ([`CurveProducer::is_crowded`]). Where they do, the block has a curve of its own.
#![allow(unsafe_code)]
use super::SEGMENTS;
use super::cells::{self, BEFORE, IS_WHOLE, MOST, Place, Segment, Track, whole};
use crate::path::Shape;
use crate::quantity::{Distance, Position};
use core::hint::assert_unchecked;
use core::marker::PhantomData;
use core::sync::atomic::{AtomicU32, Ordering, fence};
use core::{ptr, slice};

/// Most curves that a tick passes. In a small build half as many.
pub const MAX_CURVES_PER_TICK: u32 = MOST_SLOTS / MOST as u32;

/// Most slots that it passes.
const MOST_SLOTS: u32 = 1 << HALVINGS;

/// How often a tick halves those that it looks at.
const HALVINGS: usize = 5;

/// Slots that a tick looks at: the one it is on, the next one, and those that it halves.
const WINDOW: usize = 2 + MOST_SLOTS as usize;
/// How it halves them.
const HALVES: [usize; HALVINGS] = {
    let mut halves = [1; HALVINGS];
    let mut k = HALVINGS - 1;
    while k > 0 {
        k -= 1;
        halves[k] = 2 * halves[k + 1];
    }
    halves
};
/// Starts behind a curve that are looked at from there.
const BEHIND: usize = WINDOW - 1;
/// The least look-ahead (P-STUP-00071): as many curves of any kind have room. More need not be in the ring together:
/// a span of several blocks is one of those that the look-ahead holds, and a curve of more elements passes through.
const LEAST: usize = 10;

/// Slots of the look-ahead beside one for each block.
const SPARE: usize = if IS_WHOLE { 0 } else { LEAST + 8 };
/// Slots that the look-ahead may need for one curve more than it asks for: of one that was held back, and of another.
const NEXT: usize = if IS_WHOLE { 0 } else { 2 * MOST };
/// Slots beside one for each block of the look-ahead: those, those of curves handed on, and the part of the curve that the
/// interrupt is on.
const SLOTS: usize = SPARE + SEGMENTS + BEFORE;
/// Starts beside those of the look-ahead: those of slots, out of reach behind the last one, and the head repeated.
const STARTS: usize = SLOTS + WINDOW + BEHIND;

/// A start so far behind the last curve is out of reach: 2^61. Distances are compared up to 2^63 apart: as
/// far as the curve at hand, the last one and this together.
const OUT_OF_REACH: i64 = 1 << 61;

/// Path that is shown ahead of what is handed on, from the end of the curve at hand, with which the next
/// start is compared alone: with what is out of reach behind it, below 2^63.
const SHOWN: i64 = 5 << 60;

/// Curves longer than that move every start that is out of reach. A window of shorter ones does not come near
/// it.
const LONG: i64 = OUT_OF_REACH / 64;

/// A motion block so far behind the oldest one of the ring does not become one curve with others: those that come until
/// the oldest one is left, a curve or more for each of them, are less than 2^16 behind it.
const MOST_APART: u32 = 1 << 15;

/// Two arrays, one behind the other.
#[repr(C)]
struct Both<T, const A: usize, const B: usize> {
    front: [T; A],
    back: [T; B],
}

impl<T, const A: usize, const B: usize> Both<T, A, B> {
    fn as_slice(&self) -> &[T] {
        // SAFETY: in C layout the second array begins where the first one ends, a multiple of their
        // alignment, and the struct ends with it: `A + B` elements in a row, borrowed as long as `self` is.
        unsafe { slice::from_raw_parts(ptr::from_ref(self).cast(), A + B) }
    }
}

/// Starts as large as a slot.
const fn as_starts<const AXES: usize>() -> usize {
    const { assert!(size_of::<Place<AXES>>().is_multiple_of(size_of::<Start>()), "as large as so many starts") };
    size_of::<Place<AXES>>() / size_of::<Start>()
}

/// The index `by` further in a ring of `len`.
#[inline(always)]
const fn on(at: usize, by: usize, len: usize) -> usize {
    let to = at + by;
    if to >= len { to - len } else { to }
}

/// A path distance in two words.
struct Start {
    lower: AtomicU32,
    upper: AtomicU32,
}

impl Start {
    const fn zero() -> Self {
        Self { lower: AtomicU32::new(0), upper: AtomicU32::new(0) }
    }

    #[inline(always)]
    fn get(&self) -> i64 {
        let [upper, lower] = [&self.upper, &self.lower].map(|word| word.load(Ordering::Relaxed));
        (u64::from(upper) << 32 | u64::from(lower)) as i64
    }

    #[inline(always)]
    fn set(&self, start: i64, order: Ordering) {
        self.lower.store(start as u32, Ordering::Relaxed);
        self.upper.store((start >> 32) as u32, order);
    }

    #[inline(always)]
    fn has_begun(&self, distance: i64) -> bool {
        distance.wrapping_sub(self.get()) >= 0
    }
}

/// Static memory of the ring: `BLOCKS` curves of the look-ahead, and those handed on.
pub struct CurveRing<const AXES: usize, const BLOCKS: usize> {
    slots: Both<Place<AXES>, BLOCKS, { BEFORE + SLOTS }>,
    starts: Both<Start, BLOCKS, STARTS>,
    /// Curves the interrupt has left since the split.
    taken: AtomicU32,
    /// The latest motion block of all that were put in, written by the planner.
    latest: AtomicU32,
}

/// Puts curves in. They are numbered from 0 since the split.
pub struct CurveProducer<'a, const AXES: usize> {
    /// The first [`BEFORE`] of them are not in the ring.
    slots: &'a [Place<AXES>],
    starts: &'a [Start],
    taken: &'a AtomicU32,
    latest: &'a AtomicU32,
    /// Curves put in.
    count: u32,
    /// Those handed on.
    handed: u32,
    /// Those whose start the interrupt can see.
    shown: u32,
    /// Where the first one starts that it cannot see. Only where there were long ones.
    hidden: i64,
    /// Where the next one goes, and where its start.
    slot: usize,
    place: usize,
    /// End of the last one.
    end: i64,
    /// There were long ones.
    long: bool,
}

/// Follows them.
pub struct CurveConsumer<'a, const AXES: usize> {
    taken: &'a AtomicU32,
    /// The start of the curve at hand, [`BEHIND`] others behind it, and its slot.
    start: RingCursor<'a, Start>,
    slot: RingCursor<'a, Place<AXES>>,
    latest: &'a AtomicU32,
}

/// An element of a ring, where its array ends, and the way back from there to its begin, in bytes, below 0: to
/// go on takes neither an index nor a check of one.
struct RingCursor<'a, T> {
    at: *const T,
    end: *const T,
    back: isize,
    ring: PhantomData<&'a [T]>,
}

// SAFETY: it is as good as the shared slice that it was made of.
unsafe impl<T: Sync> Send for RingCursor<'_, T> {}

impl<'a, T> RingCursor<'a, T> {
    /// At the first element. The ring is so many elements of the array, one at least, behind so many others.
    fn new(array: &'a [T], before: usize, len: usize) -> Self {
        let at = array.as_ptr().wrapping_add(before);
        let back = -((len * size_of::<T>()) as isize);
        Self { at, end: at.wrapping_add(len), back, ring: PhantomData }
    }

    /// Goes on by so many bytes, whole elements and no more than a lap.
    #[inline(always)]
    fn go_on(&mut self, by: usize) {
        let to = self.at.wrapping_byte_add(by);
        self.at = if to >= self.end { to.wrapping_byte_offset(self.back) } else { to };
    }
}

impl<const AXES: usize, const BLOCKS: usize> CurveRing<AXES, BLOCKS> {
    /// No curve.
    pub const fn new() -> Self {
        Self {
            slots: Both {
                front: [const { Place::blank() }; BLOCKS],
                back: [const { Place::blank() }; BEFORE + SLOTS],
            },
            starts: Both {
                front: [const { Start::zero() }; BLOCKS],
                back: [const { Start::zero() }; STARTS],
            },
            taken: AtomicU32::new(0),
            latest: AtomicU32::new(0),
        }
    }

    /// Empties the ring and gives its two ends.
    pub fn split(&mut self) -> (CurveProducer<'_, AXES>, CurveConsumer<'_, AXES>) {
        const {
            assert!(BLOCKS + SLOTS < MOST_APART as usize / 2, "numbers of motion blocks of 16 bits");
            assert!(BLOCKS + SPARE >= MOST * LEAST + NEXT - MOST, "the least look-ahead has room");
        }
        (*self.taken.get_mut(), *self.latest.get_mut()) = (0, 0);
        let Self { slots, starts, taken, latest } = self;
        for place in slots.front.iter_mut().chain(&mut slots.back) {
            place.clear();
        }
        let (slots, starts) = (slots.as_slice(), starts.as_slice());
        let (taken, latest) = (&*taken, &*latest);
        for start in starts {
            start.set(out_of_reach(0), Ordering::Relaxed);
        }
        let start = RingCursor::new(starts, 0, places(starts));
        let slot = RingCursor::new(slots, BEFORE, slots.len() - BEFORE);
        let producer = CurveProducer {
            slots,
            starts,
            taken,
            latest,
            count: 0,
            handed: 0,
            shown: 0,
            hidden: 0,
            slot: 0,
            place: 0,
            end: 0,
            long: false,
        };
        (producer, CurveConsumer { taken, start, slot, latest })
    }
}

impl<const AXES: usize, const BLOCKS: usize> Default for CurveRing<AXES, BLOCKS> {
    fn default() -> Self {
        Self::new()
    }
}

/// The lower word is the highest one: a start half written is never before what it will be.
const fn out_of_reach(end: i64) -> i64 {
    end.wrapping_add(OUT_OF_REACH) | 0xFFFF_FFFF
}

/// Places for starts in such an array.
const fn places(starts: &[Start]) -> usize {
    starts.len().saturating_sub(BEHIND)
}

impl<'a, const AXES: usize> CurveProducer<'a, AXES> {
    /// Blocks that the look-ahead may have.
    pub const fn ahead(&self) -> usize {
        self.slots.len().saturating_sub(BEFORE + SLOTS)
    }

    /// Slots of the ring.
    const fn most(&self) -> usize {
        self.slots.len().saturating_sub(BEFORE)
    }

    /// Whether there is no room for another line.
    #[cfg_attr(feature = "fast", inline(always))]
    pub fn is_full(&self) -> bool {
        !self.has_room(self.taken(), 1)
    }

    /// Whether so many slots are free: that of the part of the curve that the interrupt is on is not.
    #[cfg_attr(feature = "fast", inline(always))]
    fn has_room(&self, taken: u32, slots: usize) -> bool {
        self.count.wrapping_sub(taken) as usize + BEFORE + slots <= self.most()
    }

    /// Whether the look-ahead has all the room that there is for its curves, though they may be fewer than blocks.
    #[cfg_attr(feature = "fast", inline(always))]
    pub fn is_ahead_full(&self) -> bool {
        !IS_WHOLE && self.count.wrapping_sub(self.handed) as usize + NEXT > self.ahead() + SPARE
    }

    /// The slot of that index.
    fn slot(&self, index: usize) -> Option<&'a Place<AXES>> {
        self.slots.get(BEFORE + index)
    }

    /// The index of the slot with this number, of one that was put in last.
    fn index_of(&self, number: u32) -> usize {
        on(self.slot, self.most().saturating_sub(self.count.wrapping_sub(number) as usize), self.most())
    }

    /// Whether the slot with this number is that of a part.
    fn is_part(&self, number: u32) -> bool {
        // SAFETY: only this end of the ring writes slots, and needs `&mut self` for that.
        !IS_WHOLE
            && number != self.count
            && self.slot(self.index_of(number)).is_some_and(|slot| unsafe { slot.is_part() })
    }

    /// The number of a curve, from that of its part too.
    pub fn curve_of(&self, number: u32) -> u32 {
        number.wrapping_add(u32::from(self.is_part(number)))
    }

    /// The number of the next curve.
    pub fn after(&self, number: u32) -> u32 {
        self.curve_of(self.curve_of(number).wrapping_add(1))
    }

    /// Whether as many curves are handed on as the queue takes, or more path than distances are compared
    /// over.
    #[cfg_attr(feature = "fast", inline(always))]
    pub fn is_sated(&self) -> bool {
        // With another one of any kind they are not more.
        self.len() + MOST as u32 > SEGMENTS as u32 || (self.long && self.is_far(self.handed))
    }

    /// Whether there are more than the queue takes: the last span handed on had several.
    #[cfg_attr(feature = "fast", inline(always))]
    pub fn is_over(&self) -> bool {
        self.len() > SEGMENTS as u32 || (self.long && self.is_far(self.handed.wrapping_sub(1)))
    }

    /// Whether there is more path than distances are compared over from the curve that the interrupt is on to
    /// the one with this number.
    fn is_far(&self, number: u32) -> bool {
        self.is_behind(number, self.start(number), OUT_OF_REACH - self.length(self.taken()))
    }

    /// Whether the curve with this number and that start ends too far ahead to be shown before it is handed on.
    fn is_too_far(&self, number: u32, start: i64) -> bool {
        self.is_behind(number, start, OUT_OF_REACH - self.length(self.taken()))
            && self.is_behind(number, start, SHOWN - self.length(number))
    }

    /// Whether there is more path than that from the end of the curve the interrupt is on to the start of the
    /// one with this number. From there: the way of both, and the curve behind, may be more than can be
    /// compared.
    #[inline(never)]
    fn is_behind(&self, number: u32, start: i64, path: i64) -> bool {
        let next = self.taken().wrapping_add(1);
        (number.wrapping_sub(next) as i32) > 0 && start.wrapping_sub(self.start(next)) > path
    }

    /// Path length of the curve with this number, or nothing, LSB 2^-44 mm.
    fn length(&self, number: u32) -> i64 {
        if self.is_part(number) {
            return 0;
        }
        self.recent(number).map_or(0, |track| track.segment.length())
    }

    /// Path distance at which the curve with this number starts, LSB 2^-44 mm. Only of one that
    /// [`Self::recent`] has.
    pub fn start(&self, number: u32) -> i64 {
        if (number.wrapping_sub(self.shown) as i32) < 0 {
            return self.starts.get(self.place_of(number)).map_or(0, Start::get);
        }
        let before = numbers(self.shown, number).map(|number| self.length(number));
        before.fold(self.hidden, i64::wrapping_add)
    }

    /// The first curve that ends after a path distance, among those that the interrupt has not left.
    pub fn ends_behind(&self, distance: i64) -> Option<u32> {
        let first = self.taken();
        if first == self.count || self.end_of(first).wrapping_sub(distance) > 0 {
            return (first != self.count).then_some(first);
        }
        // The motion may have stood within the first one: the next one starts there.
        let second = first.wrapping_add(1);
        let mut end = self.start(second);
        numbers(second, self.count).find(|number| {
            end = end.wrapping_add(self.length(*number));
            end.wrapping_sub(distance) > 0
        })
    }

    /// Path distance at which it ends, LSB 2^-44 mm.
    pub fn end_of(&self, number: u32) -> i64 {
        self.start(number).wrapping_add(self.length(number))
    }

    /// The latest motion block of all that were put in.
    fn latest(&self) -> u32 {
        self.latest.load(Ordering::Relaxed)
    }

    /// The same, for others to count back from: see [`whole`].
    pub const fn latest_word(&self) -> &'a AtomicU32 {
        self.latest
    }

    /// The motion block of a curve of the ring.
    pub fn block_of(&self, segment: &Segment<AXES>) -> u32 {
        whole(self.latest(), segment.block())
    }

    /// Whether the motion block with this number, which comes next, must not become one curve with others: it would be
    /// too far from the oldest one that may be in use, that of the slot that the next curve takes.
    pub fn is_crowded(&self, block: u32) -> bool {
        // SAFETY: only this end of the ring writes slots, and needs `&mut self` for that.
        let oldest = self.slot(self.slot).map_or(0, |slot| unsafe { slot.block() });
        block.wrapping_sub(whole(self.latest(), oldest)) >= MOST_APART
    }

    /// Appends a curve with the offset of its points, its N number and its motion block; `false` if there is no room.
    #[cfg_attr(feature = "fast", inline(always))]
    pub fn push(&mut self, shape: &Shape<AXES>, base: &[Position; AXES], n: u32, block: u32) -> bool {
        let Some(slots) = cells::slots(shape) else { return false };
        if !self.has_room(self.taken(), slots) {
            return false;
        }
        let (front, index) = (self.slot, on(self.slot, slots - 1, self.most()));
        let part = if slots > 1 { self.slot(front) } else { None };
        let slot = self.slots.as_ptr().wrapping_add(BEFORE + index);
        // SAFETY: the slot is in the ring, and one is before it; not full, so the interrupt has given back these and
        // that of the part, and their starts are out of reach; of planners there is one.
        unsafe { cells::write(slot, part, shape, base, (n, block as u16)) };
        if (block.wrapping_sub(self.latest()) as i32) > 0 {
            self.latest.store(block, Ordering::Relaxed);
        }
        let (start, length) = (self.end, shape.length.to_bits());
        self.end = start.wrapping_add(length);
        let place = self.place;
        self.slot = on(index, 1, self.most());
        self.place = on(place, slots, places(self.starts));
        self.count = self.count.wrapping_add(slots as u32);
        if length >= LONG && !self.long {
            (self.long, self.hidden) = (true, start);
        }
        if self.long {
            self.show();
        } else {
            // The last one first.
            for k in (0..slots).rev() {
                let behind = on(place, BEHIND + k, places(self.starts));
                self.set(behind, out_of_reach(self.end), Ordering::Relaxed);
            }
            for k in (0..slots).rev() {
                self.set(on(place, k, places(self.starts)), start, Ordering::Release);
            }
            self.shown = self.count;
        }
        true
    }

    /// Releases that many more curves to the interrupt.
    #[cfg_attr(feature = "fast", inline(always))]
    pub fn hand_on(&mut self, curves: u32) {
        self.handed = if IS_WHOLE {
            self.handed.wrapping_add(curves)
        } else {
            (0..curves).fold(self.handed, |number, _| self.curve_of(number).wrapping_add(1))
        };
        if self.long {
            self.show();
        }
    }

    /// Writes the starts of curves handed on, and of more as far as distances are compared.
    #[inline(never)]
    fn show(&mut self) {
        let (from, mut start) = (self.shown, self.hidden);
        let (mut shown, mut end) = (from, start);
        let mut cleared = from.wrapping_add(BEHIND as u32);
        for _ in 0..self.slots.len() {
            let due = (self.handed.wrapping_sub(shown) as i32) > 0;
            let curve = self.curve_of(shown);
            if shown == self.count || (!due && self.is_too_far(curve, end)) {
                break;
            }
            let length = self.length(curve);
            (shown, end) = (curve.wrapping_add(1), end.wrapping_add(length));
            if length >= LONG || (cleared.wrapping_sub(shown) as i32) < 0 {
                cleared = shown;
            }
        }
        if shown == from {
            return;
        }
        for number in numbers(cleared, shown.wrapping_add(BEHIND as u32)) {
            self.set(self.place_of(number), out_of_reach(end), Ordering::Relaxed);
        }
        let mut number = from;
        while number != shown {
            let curve = self.curve_of(number);
            // The last one first.
            self.set(self.place_of(curve), start, Ordering::Release);
            if curve != number {
                self.set(self.place_of(number), start, Ordering::Release);
            }
            start = start.wrapping_add(self.length(curve));
            number = curve.wrapping_add(1);
        }
        (self.shown, self.hidden) = (shown, end);
    }

    /// Where the start of the curve with this number is.
    fn place_of(&self, number: u32) -> usize {
        let places = places(self.starts);
        let by = number.wrapping_sub(self.count);
        if (by as i32) < 0 {
            on(self.place, places.saturating_sub(by.wrapping_neg() as usize), places)
        } else {
            on(self.place, by as usize, places)
        }
    }

    #[inline(always)]
    fn set(&self, place: usize, start: i64, order: Ordering) {
        for place in [place, place + places(self.starts)] {
            if let Some(at) = self.starts.get(place) {
                at.set(start, order);
            }
        }
    }

    /// Number of curves that are released: the current one and those before it. At the end of all of them the interrupt
    /// may be on the first curve of the look-ahead; in the reserve, on a later one.
    #[inline(always)]
    pub fn len(&self) -> u32 {
        let ahead = self.handed.wrapping_sub(self.taken()) as i32;
        (ahead.max(0) as u32).max(u32::from(self.handed != 0))
    }

    /// Whether none was handed on yet.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Curves put in since the split.
    pub const fn count(&self) -> u32 {
        self.count
    }

    /// Curves handed on since the split.
    pub const fn handed(&self) -> u32 {
        self.handed
    }

    /// Curves the interrupt has left since the split.
    #[cfg_attr(feature = "fast", inline(always))]
    pub fn taken(&self) -> u32 {
        self.taken.load(Ordering::Acquire)
    }

    /// Path distance at which the last one ends.
    pub const fn end(&self) -> Distance {
        Distance::from_bits(self.end)
    }

    /// Path distance up to which the interrupt knows the path.
    pub fn known(&self) -> Distance {
        Distance::from_bits(if self.long { self.hidden } else { self.end })
    }

    /// Whether the interrupt knows the path up to that distance.
    #[cfg_attr(feature = "fast", inline(always))]
    pub fn is_known(&self, distance: Distance) -> bool {
        !self.long || distance.to_bits().wrapping_sub(self.known().to_bits()) <= 0
    }

    /// The curve that was put in as the one with this number, or whose part was, if it is one of the last.
    #[inline(never)]
    pub fn recent(&self, number: u32) -> Option<Track<'_, AXES>> {
        let number = self.curve_of(number);
        let back = self.count.wrapping_sub(number) as usize;
        if back.wrapping_sub(1) >= self.most() - BEFORE {
            return None;
        }
        let slot = self.slots.as_ptr().wrapping_add(BEFORE + self.index_of(number));
        // SAFETY: it is in there, with the one before; only this end of the ring writes slots, and needs `&mut self` for
        // that; the interrupt reads too.
        Some(unsafe { Track::new(slot) })
    }

    /// Takes back the curves after the current one. The axes stand at the path distance `stands`, where the next curve
    /// begins.
    pub fn end_at(&mut self, stands: i64) {
        self.withdraw(self.taken());
        (self.end, self.hidden) = (stands, stands);
    }

    /// Takes back the curves from the one with this number on, apart from that which the interrupt is on. It
    /// does not get further before they are put in anew. All that are left are handed on.
    pub fn withdraw(&mut self, number: u32) {
        let first = self.curve_of(self.taken()).wrapping_add(1);
        let number = if (number.wrapping_sub(first) as i32) < 0 { first } else { number };
        if self.recent(number.wrapping_sub(1)).is_none() {
            return;
        }
        let end = self.end_of(number.wrapping_sub(1));
        let behind = self.count.wrapping_add(BEHIND as u32);
        for number in numbers(number, behind) {
            self.set(self.place_of(number), out_of_reach(end), Ordering::Relaxed);
        }
        self.slot = self.index_of(number);
        self.place = self.place_of(number);
        (self.count, self.handed, self.end) = (number, number, end);
        self.forget(first.wrapping_sub(1));
        if (number.wrapping_sub(self.shown) as i32) < 0 {
            (self.shown, self.hidden) = (number, end);
        }
        self.show();
    }

    /// All slots but those of the curves from this one on say that they have its motion block: none that is in use is
    /// older, and none that comes.
    fn forget(&self, first: u32) {
        let Some(block) = self.recent(first).map(|track| track.segment.block()) else { return };
        // With the slot of its part.
        let used = self.count.wrapping_sub(first) as usize + BEFORE;
        for k in used..self.most() {
            // From the one that the next curve takes.
            if let Some(slot) = self.slot(on(self.slot, k - used, self.most())) {
                // SAFETY: the interrupt does not get there, and of planners there is one.
                unsafe { slot.set_block(block) };
            }
        }
    }
}

/// From one number of a curve up to another.
fn numbers(from: u32, to: u32) -> impl Iterator<Item = u32> {
    (0..to.wrapping_sub(from)).map(move |k| from.wrapping_add(k))
}

impl<const AXES: usize> CurveConsumer<'_, AXES> {
    /// The curve that a path distance not before the last one asked for is on, and the distance from its
    /// start; curves before it are given back, at most [`MAX_CURVES_PER_TICK`]. `None` before the first one.
    /// Runs in the tick.
    #[inline(always)]
    pub fn follow(&mut self, distance: i64) -> Option<(Track<'_, AXES>, i64)> {
        // SAFETY: it is in its ring, behind which the array goes on for as many as a window has behind its
        // first one.
        let [first, rest @ ..] = unsafe { &*self.start.at.cast::<[Start; WINDOW]>() };
        let mut at = first;
        if rest.first()?.has_begun(distance) {
            at = last_begun(rest, distance)?;
            // SAFETY: both are in one window, the first one in front.
            let passed = unsafe { ptr::from_ref(at).byte_offset_from_unsigned(first) };
            self.start.go_on(passed);
            self.slot.go_on(passed * as_starts::<AXES>());
            let taken = self.taken.load(Ordering::Relaxed);
            let passed = (passed / size_of::<Start>()) as u32;
            self.taken.store(taken.wrapping_add(passed), Ordering::Release);
        }
        let along = distance.wrapping_sub(at.get());
        if along < -(OUT_OF_REACH / 2) {
            return None;
        }
        fence(Ordering::Acquire);
        // SAFETY: in its ring, which says at once that there is one; and as its start is not out of reach,
        // the planner has put the curve in, and leaves it alone until it is given back.
        let track = unsafe {
            assert_unchecked(!self.slot.at.is_null());
            Track::new(self.slot.at)
        };
        Some((track, along))
    }

    /// The curve the interrupt is on, at the distance it asked for last.
    pub fn peek(&self, distance: i64) -> Option<&Segment<AXES>> {
        self.at_hand(distance).map(|(track, _)| track.segment)
    }

    /// The current curve with its part, and the distance from its start.
    pub fn at_hand(&self, distance: i64) -> Option<(Track<'_, AXES>, i64)> {
        // SAFETY: it is in its ring.
        let start = unsafe { &*self.start.at }.get();
        let along = distance.wrapping_sub(start);
        if along < -(OUT_OF_REACH / 2) {
            return None;
        }
        fence(Ordering::Acquire);
        // SAFETY: as in `follow`. Before the first tick it may be a part.
        unsafe { if (*self.slot.at).is_part() { None } else { Some((Track::new(self.slot.at), along)) } }
    }

    /// The motion block of a curve of the ring.
    pub fn block_of(&self, segment: &Segment<AXES>) -> u32 {
        whole(self.latest.load(Ordering::Relaxed), segment.block())
    }
}

/// The last one of these that has begun; the first one has.
#[inline(always)]
fn last_begun(starts: &[Start; WINDOW - 1], distance: i64) -> Option<&Start> {
    let (first, rest) = starts.split_first()?;
    if !rest.first()?.has_begun(distance) {
        return Some(first);
    }
    let mut window = rest;
    for half in HALVES {
        let (near, far) = window.split_at_checked(half)?;
        window = if far.first()?.has_begun(distance) { far } else { near };
    }
    window.first()
}

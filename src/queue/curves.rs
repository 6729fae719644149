//! The ring of curves. From the path distance alone, the tick finds the curve on which the axes are.
//!
//! The planner writes a curve when its block enters the look-ahead. The curve stays in its place until the
//! interrupt has passed it. First in the ring are the *released* curves, along which there are pieces of
//! motion. The curves of the look-ahead follow. The interrupt can find both kinds.
//!
//! **Starts.** The start of a curve is the path distance at which the curve begins. Starts are in an array of
//! their own, which is longer than the ring. A tick searches a window of fixed size in this array by halving.
//! The tick needs neither the number of curves nor the end of the array:
//!
//! - After the start of the last curve, the array has filler entries, enough for a window. Each of them is
//!   about 2^17 mm after the end of the path ([`OUT_OF_REACH`]). No tick moves so far.
//! - After the end of the array, its first entries are repeated.
//!
//! **A new curve.** The planner writes the curve, then the lower half of its start, then the upper half. From
//! then on, the interrupt may use the curve. Before, the entry is a filler: its upper half is far away, and
//! its lower half has the highest possible value. So any mixture of old and new halves is at or after the
//! final start. The interrupt cannot find the curve too early.
//!
//! **Range.** Path distances wrap around. So two of them compare correctly only if they are less than 2^19 mm
//! apart. If the curves of the look-ahead lead too far for this, the planner writes their starts later, when
//! the interrupt is nearer.
//!
//! **Small build.** An arc or a polynomial takes two slots ([`super::cells`]). The first one has its
//! additional data (the part), the second one is the slot of the curve. Both slots have the same start, so a
//! tick passes both or none. The interrupt reads the first of the two starts, so the planner writes that one
//! last. In this file, numbers of curves are then numbers of slots. Many such curves make the look-ahead
//! shorter.
//!
//! **Block numbers.** A slot has the lower 16 bits of the number of its motion block. A reader finds the
//! upper bits from the latest number ([`super::cells::whole`]). So all block numbers in the ring must be less
//! than 2^16 apart. One curve may replace many motion blocks. If the numbers could get too far apart, the
//! next block gets a curve of its own ([`CurveProducer::is_crowded`]).
#![allow(unsafe_code)]
use super::SEGMENTS;
use super::cells::{self, BEFORE, IS_WHOLE, MOST, Place, Segment, Track, whole};
#[cfg(feature = "driven")]
use super::driven::{Drive, Drives, Kept};
#[cfg(feature = "driven")]
use crate::path::Measure;
use crate::path::Shape;
use crate::quantity::{Distance, Position};
use core::hint::assert_unchecked;
use core::marker::PhantomData;
use core::sync::atomic::{AtomicU32, Ordering, fence};
use core::{ptr, slice};

/// Largest number of curves that a tick passes: 32, or 16 in a small build.
pub const MAX_CURVES_PER_TICK: u32 = MOST_SLOTS / MOST as u32;

/// Largest number of slots that a tick passes.
const MOST_SLOTS: u32 = 1 << HALVINGS;

/// Number of halvings in a tick.
const HALVINGS: usize = 5;

/// Slots that a tick reads: the current slot, the next slot, and the slots of the halvings.
const WINDOW: usize = 2 + MOST_SLOTS as usize;
/// Sizes of the halvings, in starts.
const HALVES: [usize; HALVINGS] = {
    let mut halves = [1; HALVINGS];
    let mut k = HALVINGS - 1;
    while k > 0 {
        k -= 1;
        halves[k] = 2 * halves[k + 1];
    }
    halves
};
/// Number of starts after a curve that a tick reads.
const BEHIND: usize = WINDOW - 1;
/// Smallest look-ahead (P-STUP-00071), in curves of any kind that have room. The ring never needs more curves
/// at the same time. A span of several blocks is a part of the look-ahead. A curve of more elements passes
/// through the ring.
const LEAST: usize = 10;

/// Slots of the look-ahead in addition to one slot per block.
const SPARE: usize = if IS_WHOLE { 0 } else { LEAST + 8 };
/// Slots that the look-ahead may need for two more curves than requested: a curve that was held back, and the
/// next one.
const NEXT: usize = if IS_WHOLE { 0 } else { 2 * MOST };
/// Slots in addition to one slot per block of the look-ahead: the additional slots above, released curves,
/// and the part of the current curve.
const SLOTS: usize = SPARE + SEGMENTS + BEFORE;
/// Starts in addition to those of the look-ahead: one per additional slot, starts out of reach after the last
/// curve, and the repeated head.
const STARTS: usize = SLOTS + WINDOW + BEHIND;

/// A start that is 2^61 (LSB 2^-44 mm) after the last curve is out of reach. Distances compare correctly up
/// to 2^63; the sum of the current curve, the last curve and this value is below.
const OUT_OF_REACH: i64 = 1 << 61;

/// Length of the path that the interrupt sees ahead of the released curves, counted from the end of the
/// current curve. Only the next start is compared with this end. This length plus [`OUT_OF_REACH`] is below
/// 2^63.
const SHOWN: i64 = 5 << 60;

/// A longer curve moves every start that is out of reach. A window of shorter curves stays far below the
/// limit.
const LONG: i64 = OUT_OF_REACH / 64;

/// A motion block must not join a curve if its number exceeds the oldest one in the ring by this value. Until
/// the oldest block is passed, at most one curve per block is added. So all numbers stay less than 2^16
/// apart.
const MOST_APART: u32 = 1 << 15;

/// Two arrays without a gap between them.
#[repr(C)]
struct Both<T, const A: usize, const B: usize> {
    front: [T; A],
    back: [T; B],
}

impl<T, const A: usize, const B: usize> Both<T, A, B> {
    fn as_slice(&self) -> &[T] {
        // SAFETY: in C layout, the second array begins where the first one ends, at a multiple of their
        // alignment, and the struct ends with it. So there are `A + B` consecutive elements, borrowed as long
        // as `self` is.
        unsafe { slice::from_raw_parts(ptr::from_ref(self).cast(), A + B) }
    }
}

/// The starts that fit into one slot.
const fn as_starts<const AXES: usize>() -> usize {
    const { assert!(size_of::<Place<AXES>>().is_multiple_of(size_of::<Start>()), "as large as so many starts") };
    size_of::<Place<AXES>>() / size_of::<Start>()
}

/// The index `by` places after `at`, in a ring of `len` places.
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

/// Static memory of the path: the `BLOCKS` curves of the look-ahead, and the released curves before them.
pub struct CurveRing<const AXES: usize, const BLOCKS: usize> {
    slots: Both<Place<AXES>, BLOCKS, { BEFORE + SLOTS }>,
    starts: Both<Start, BLOCKS, STARTS>,
    /// Number of curves that the interrupt has passed since `CurveRing::split`.
    taken: AtomicU32,
    /// The latest motion block in the ring. The planner writes this word.
    latest: AtomicU32,
    /// The driven distance of each curve.
    #[cfg(feature = "driven")]
    drives: Both<Kept, BLOCKS, SLOTS>,
}

/// The planner's handle: writes the curves of the path and releases them to the interrupt. Curves are
/// numbered from 0 since `CurveRing::split`.
pub struct CurveProducer<'a, const AXES: usize> {
    /// The slots. The first [`BEFORE`] slots are not part of the ring.
    slots: &'a [Place<AXES>],
    starts: &'a [Start],
    taken: &'a AtomicU32,
    latest: &'a AtomicU32,
    /// Number of curves written.
    count: u32,
    /// Number of released curves.
    handed: u32,
    /// Number of curves whose start the interrupt sees.
    shown: u32,
    /// Start of the first curve that the interrupt cannot see; used only after long curves.
    hidden: i64,
    /// Indices of the next curve and of its start.
    slot: usize,
    place: usize,
    /// End of the last curve.
    end: i64,
    /// Whether the ring has held long curves.
    long: bool,
    /// The driven distance of each curve.
    #[cfg(feature = "driven")]
    drives: Drives<'a>,
    /// Driven distance at the end of the last curve.
    #[cfg(feature = "driven")]
    driven: i64,
    /// The axes along which driven distance counts. `None`: the path distance of each curve is its driven
    /// length.
    #[cfg(feature = "driven")]
    measure: Option<Measure>,
}

/// The interrupt's handle: finds the curve at a path distance, and gives passed curves back.
pub struct CurveConsumer<'a, const AXES: usize> {
    taken: &'a AtomicU32,
    /// The start of the current curve, with [`BEHIND`] more starts after it, and the slot of the curve.
    start: RingCursor<'a, Start>,
    slot: RingCursor<'a, Place<AXES>>,
    latest: &'a AtomicU32,
    #[cfg(feature = "driven")]
    drives: Drives<'a>,
}

/// An element of a ring, the end of its array, and the negative offset from this end to the ring's first
/// element, in bytes. A step needs neither an index nor a bounds check.
struct RingCursor<'a, T> {
    at: *const T,
    end: *const T,
    back: isize,
    ring: PhantomData<&'a [T]>,
}

// SAFETY: the cursor is as safe to send as the shared slice from which it was made.
unsafe impl<T: Sync> Send for RingCursor<'_, T> {}

impl<'a, T> RingCursor<'a, T> {
    /// A cursor at the first element. The ring consists of `len` elements of the array, at least one, after
    /// `before` others.
    fn new(array: &'a [T], before: usize, len: usize) -> Self {
        let at = array.as_ptr().wrapping_add(before);
        let back = -((len * size_of::<T>()) as isize);
        Self { at, end: at.wrapping_add(len), back, ring: PhantomData }
    }

    /// Steps by a number of bytes: a multiple of the element size, at most one round.
    #[inline(always)]
    fn go_on(&mut self, by: usize) {
        let to = self.at.wrapping_byte_add(by);
        self.at = if to >= self.end { to.wrapping_byte_offset(self.back) } else { to };
    }
}

impl<const AXES: usize, const BLOCKS: usize> CurveRing<AXES, BLOCKS> {
    /// An empty ring.
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
            #[cfg(feature = "driven")]
            drives: Both { front: [const { Kept::new() }; BLOCKS], back: [const { Kept::new() }; SLOTS] },
        }
    }

    /// Empties the ring and returns its two handles.
    pub fn split(&mut self) -> (CurveProducer<'_, AXES>, CurveConsumer<'_, AXES>) {
        const {
            assert!(BLOCKS + SLOTS < MOST_APART as usize / 2, "numbers of motion blocks of 16 bits");
            assert!(BLOCKS + SPARE >= MOST * LEAST + NEXT - MOST, "the least look-ahead has room");
        }
        (*self.taken.get_mut(), *self.latest.get_mut()) = (0, 0);
        let Self { slots, starts, taken, latest, .. } = self;
        #[cfg(feature = "driven")]
        let drives = Drives::new(self.drives.as_slice(), taken);
        #[cfg(feature = "driven")]
        drives.clear();
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
            #[cfg(feature = "driven")]
            drives,
            #[cfg(feature = "driven")]
            driven: 0,
            #[cfg(feature = "driven")]
            measure: None,
        };
        let consumer = CurveConsumer {
            taken,
            start,
            slot,
            latest,
            #[cfg(feature = "driven")]
            drives,
        };
        (producer, consumer)
    }
}

impl<const AXES: usize, const BLOCKS: usize> Default for CurveRing<AXES, BLOCKS> {
    fn default() -> Self {
        Self::new()
    }
}

/// A start that is out of reach after a path end: [`OUT_OF_REACH`]. The lower word has its highest value, so
/// a half-written start is never below the final value.
const fn out_of_reach(end: i64) -> i64 {
    end.wrapping_add(OUT_OF_REACH) | 0xFFFF_FFFF
}

/// Number of starts in the array.
const fn places(starts: &[Start]) -> usize {
    starts.len().saturating_sub(BEHIND)
}

impl<'a, const AXES: usize> CurveProducer<'a, AXES> {
    /// Largest look-ahead that the ring has room for, in blocks.
    pub const fn ahead(&self) -> usize {
        self.slots.len().saturating_sub(BEFORE + SLOTS)
    }

    /// Number of slots in the ring.
    const fn most(&self) -> usize {
        self.slots.len().saturating_sub(BEFORE)
    }

    /// Whether the ring has no room for another line.
    #[cfg_attr(feature = "fast", inline(always))]
    pub fn is_full(&self) -> bool {
        !self.has_room(self.taken(), 1)
    }

    /// Whether this number of slots is free. The slot with the part of the current curve is not free.
    #[cfg_attr(feature = "fast", inline(always))]
    fn has_room(&self, taken: u32, slots: usize) -> bool {
        self.count.wrapping_sub(taken) as usize + BEFORE + slots <= self.most()
    }

    /// Whether the look-ahead has no slots for more curves. In a small build, this may happen before the
    /// look-ahead holds its largest number of blocks, because an arc or a polynomial takes two slots. In
    /// other builds, the result is always `false`.
    #[cfg_attr(feature = "fast", inline(always))]
    pub fn is_ahead_full(&self) -> bool {
        !IS_WHOLE && self.count.wrapping_sub(self.handed) as usize + NEXT > self.ahead() + SPARE
    }

    /// The slot with this index.
    fn slot(&self, index: usize) -> Option<&'a Place<AXES>> {
        self.slots.get(BEFORE + index)
    }

    /// The index of the slot with this number, one of the latest slots.
    fn index_of(&self, number: u32) -> usize {
        on(self.slot, self.most().saturating_sub(self.count.wrapping_sub(number) as usize), self.most())
    }

    /// Whether the slot with this number holds a part.
    fn is_part(&self, number: u32) -> bool {
        // SAFETY: only this handle writes slots, and needs `&mut self` for that.
        !IS_WHOLE
            && number != self.count
            && self.slot(self.index_of(number)).is_some_and(|slot| unsafe { slot.is_part() })
    }

    /// Converts a slot's number to the number of its curve. In a small build, an arc or a polynomial has two
    /// slots, and `number` may be that of either slot.
    pub fn curve_of(&self, number: u32) -> u32 {
        number.wrapping_add(u32::from(self.is_part(number)))
    }

    /// The number of the curve after the curve `number`. In a small build, curves may take two numbers.
    pub fn after(&self, number: u32) -> u32 {
        self.curve_of(self.curve_of(number).wrapping_add(1))
    }

    /// Whether the queue has its full number of released curves. Also `true` if the released path is so long
    /// that path distances can hardly be compared any more.
    #[cfg_attr(feature = "fast", inline(always))]
    pub fn is_sated(&self) -> bool {
        // Another curve of any kind would exceed the limit.
        self.len() + MOST as u32 > SEGMENTS as u32 || (self.long && self.is_far(self.handed))
    }

    /// Whether the queue has more released curves than its full number, because the last released span had
    /// several.
    #[cfg_attr(feature = "fast", inline(always))]
    pub fn is_over(&self) -> bool {
        self.len() > SEGMENTS as u32 || (self.long && self.is_far(self.handed.wrapping_sub(1)))
    }

    /// Whether the path from the current curve to the curve with this number is longer than distances can
    /// compare.
    fn is_far(&self, number: u32) -> bool {
        self.is_behind(number, self.start(number), OUT_OF_REACH - self.length(self.taken()))
    }

    /// Whether the curve with this number and start ends too far ahead to be shown before its release.
    fn is_too_far(&self, number: u32, start: i64) -> bool {
        self.is_behind(number, start, OUT_OF_REACH - self.length(self.taken()))
            && self.is_behind(number, start, SHOWN - self.length(number))
    }

    /// Whether the path from the end of the current curve to the start of the curve with this number is
    /// longer than `path`. The path counts from that end, because both curves together with the path between
    /// may exceed the comparable range.
    #[inline(never)]
    fn is_behind(&self, number: u32, start: i64, path: i64) -> bool {
        let next = self.taken().wrapping_add(1);
        (number.wrapping_sub(next) as i32) > 0 && start.wrapping_sub(self.start(next)) > path
    }

    /// Path length of the curve with this number, LSB 2^-44 mm; 0 if there is none.
    fn length(&self, number: u32) -> i64 {
        if self.is_part(number) {
            return 0;
        }
        self.recent(number).map_or(0, |track| track.segment.length())
    }

    /// Path distance at which the curve with this number starts, LSB 2^-44 mm. Valid only for curves that
    /// [`Self::recent`] returns.
    pub fn start(&self, number: u32) -> i64 {
        if (number.wrapping_sub(self.shown) as i32) < 0 {
            return self.starts.get(self.place_of(number)).map_or(0, Start::get);
        }
        let before = numbers(self.shown, number).map(|number| self.length(number));
        before.fold(self.hidden, i64::wrapping_add)
    }

    /// The number of the first curve that ends after a path distance, among the curves that the interrupt has
    /// not passed.
    pub fn ends_behind(&self, distance: i64) -> Option<u32> {
        let first = self.taken();
        if first == self.count || self.end_of(first).wrapping_sub(distance) > 0 {
            return (first != self.count).then_some(first);
        }
        // The motion may have stopped inside the first curve; the next curve starts at that place.
        let second = first.wrapping_add(1);
        let mut end = self.start(second);
        numbers(second, self.count).find(|number| {
            end = end.wrapping_add(self.length(*number));
            end.wrapping_sub(distance) > 0
        })
    }

    /// Path distance at which the curve `number` ends, LSB 2^-44 mm.
    pub fn end_of(&self, number: u32) -> i64 {
        self.start(number).wrapping_add(self.length(number))
    }

    /// The latest motion block in the ring.
    fn latest(&self) -> u32 {
        self.latest.load(Ordering::Relaxed)
    }

    /// The memory word with the number of the latest motion block. Readers need it to complete the 16-bit
    /// block number of a curve: see [`whole`].
    pub const fn latest_word(&self) -> &'a AtomicU32 {
        self.latest
    }

    /// The full number of the motion block to which a curve of the ring belongs, counted from 0 since
    /// `CurveRing::split`.
    pub fn block_of(&self, segment: &Segment<AXES>) -> u32 {
        whole(self.latest(), segment.block())
    }

    /// Whether the next motion block, which has this number, needs its own curve and must not join an
    /// existing one. Its number would be too far from the oldest block number in use, which the slot of the
    /// next curve holds.
    pub fn is_crowded(&self, block: u32) -> bool {
        // SAFETY: only this handle writes slots, and needs `&mut self` for that.
        let oldest = self.slot(self.slot).map_or(0, |slot| unsafe { slot.block() });
        block.wrapping_sub(whole(self.latest(), oldest)) >= MOST_APART
    }

    /// Appends a curve. `base`: the point to which the curve's offsets are added; `n`: N number; `block`:
    /// number of the motion block. Returns `false` if there is no room.
    #[cfg_attr(feature = "fast", inline(always))]
    pub fn push(&mut self, shape: &Shape<AXES>, base: &[Position; AXES], n: u32, block: u32) -> bool {
        let Some(slots) = cells::slots(shape) else { return false };
        if !self.has_room(self.taken(), slots) {
            return false;
        }
        let (front, index) = (self.slot, on(self.slot, slots - 1, self.most()));
        let part = if slots > 1 { self.slot(front) } else { None };
        let slot = self.slots.as_ptr().wrapping_add(BEFORE + index);
        // SAFETY: the slot is in the ring, and one slot is before it. The ring is not full, so the interrupt
        // has given back these slots and that of the part, and their starts are out of reach. There is only
        // one planner.
        unsafe { cells::write(slot, part, shape, base, (n, block as u16)) };
        if (block.wrapping_sub(self.latest()) as i32) > 0 {
            self.latest.store(block, Ordering::Relaxed);
        }
        let (start, length) = (self.end, shape.length.to_bits());
        #[cfg(feature = "driven")]
        self.measure(shape, base, self.count.wrapping_add(slots as u32 - 1));
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
            // The last start is written first.
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

    /// Sets the axes along which the driven distance counts, from the next curve on. `None`: the driven
    /// length of each curve is its path length.
    #[cfg(feature = "driven")]
    pub const fn set_measure(&mut self, measure: Option<Measure>) {
        self.measure = measure;
    }

    /// The driven distance at the end of the last curve, LSB 2^-44 mm.
    #[cfg(feature = "plc")]
    pub const fn driven_end(&self) -> i64 {
        self.driven
    }

    /// The driven distance of each curve, for other readers.
    #[cfg(feature = "driven")]
    pub(super) const fn drives(&self) -> Drives<'a> {
        self.drives
    }

    /// Writes the driven distance of a curve after the last one. `number`: number of the new curve.
    #[cfg(feature = "driven")]
    #[inline(never)]
    fn measure(&mut self, shape: &Shape<AXES>, base: &[Position; AXES], number: u32) {
        let at = [self.end, self.driven];
        let drive = match &self.measure {
            Some(measure) if !shape.is_line() && !shape.is_arc() => Drive::of((shape, base), measure, at),
            _ => Drive::plain(self.end, self.driven),
        };
        self.drives.set(number, &drive);
        self.driven = drive.end(shape.length.to_bits());
    }

    /// Releases the next `curves` curves to the interrupt.
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

    /// Writes the starts of released curves, and of further curves as far as distances can compare.
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
            // The last start is written first.
            self.set(self.place_of(curve), start, Ordering::Release);
            if curve != number {
                self.set(self.place_of(number), start, Ordering::Release);
            }
            start = start.wrapping_add(self.length(curve));
            number = curve.wrapping_add(1);
        }
        (self.shown, self.hidden) = (shown, end);
    }

    /// The index of the start of the curve with this number.
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

    /// Number of released curves that the interrupt has not passed, including the current one; at least 1
    /// after the first release. At the end of the released curves, the interrupt may already be on the first
    /// curve of the look-ahead. In the reserve, the interrupt may be on a later curve.
    #[inline(always)]
    pub fn len(&self) -> u32 {
        let ahead = self.handed.wrapping_sub(self.taken()) as i32;
        (ahead.max(0) as u32).max(u32::from(self.handed != 0))
    }

    /// Whether no curve is released yet.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Number of curves written since `CurveRing::split`.
    pub const fn count(&self) -> u32 {
        self.count
    }

    /// Number of curves released since `CurveRing::split`.
    pub const fn handed(&self) -> u32 {
        self.handed
    }

    /// Number of curves that the interrupt has passed since `CurveRing::split`.
    #[cfg_attr(feature = "fast", inline(always))]
    pub fn taken(&self) -> u32 {
        self.taken.load(Ordering::Acquire)
    }

    /// Path distance at which the last curve of the ring ends.
    pub const fn end(&self) -> Distance {
        Distance::from_bits(self.end)
    }

    /// Path distance up to which the interrupt knows the path.
    pub fn known(&self) -> Distance {
        Distance::from_bits(if self.long { self.hidden } else { self.end })
    }

    /// Whether the interrupt knows the path up to this distance.
    #[cfg_attr(feature = "fast", inline(always))]
    pub fn is_known(&self, distance: Distance) -> bool {
        !self.long || distance.to_bits().wrapping_sub(self.known().to_bits()) <= 0
    }

    /// The curve with this number. In a small build, `number` may be that of either slot of the curve.
    /// Returns `None` if the ring no longer holds the curve.
    #[inline(never)]
    pub fn recent(&self, number: u32) -> Option<Track<'_, AXES>> {
        let number = self.curve_of(number);
        let back = self.count.wrapping_sub(number) as usize;
        if back.wrapping_sub(1) >= self.most() - BEFORE {
            return None;
        }
        let slot = self.slots.as_ptr().wrapping_add(BEFORE + self.index_of(number));
        // SAFETY: the ring holds the slot and the slot before. Only this handle writes slots, and needs `&mut
        // self` for that; the interrupt only reads.
        Some(unsafe { Track::new(slot) })
    }

    /// Withdraws the curves after the interrupt's current curve. The axes stand at the path distance
    /// `stands`; the next curve to be written begins there.
    pub fn end_at(&mut self, stands: i64) {
        self.withdraw(self.taken());
        #[cfg(feature = "driven")]
        {
            let last = self.count.wrapping_sub(1);
            self.driven = match self.recent(last) {
                Some(_) => self.drives.get(last).at(stands),
                None => self.driven.wrapping_add(stands.wrapping_sub(self.end)),
            };
        }
        (self.end, self.hidden) = (stands, stands);
    }

    /// Withdraws the curves from this number on, except for the curve that the interrupt is on. The interrupt
    /// must not move further before the planner writes new curves. All remaining curves are released.
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
        #[cfg(feature = "driven")]
        {
            self.driven = self.drives.get(number.wrapping_sub(1)).at(end);
        }
        self.forget(first.wrapping_sub(1));
        if (number.wrapping_sub(self.shown) as i32) < 0 {
            (self.shown, self.hidden) = (number, end);
        }
        self.show();
    }

    /// Writes the current motion block into all slots except those of the curves from this number on. Then no
    /// slot has an older block number than the blocks in use.
    fn forget(&self, first: u32) {
        let Some(block) = self.recent(first).map(|track| track.segment.block()) else { return };
        // Includes the slot of the part.
        let used = self.count.wrapping_sub(first) as usize + BEFORE;
        for k in used..self.most() {
            // The range begins at the slot of the next curve.
            if let Some(slot) = self.slot(on(self.slot, k - used, self.most())) {
                // SAFETY: the interrupt does not reach these slots, and there is only one planner.
                unsafe { slot.set_block(block) };
            }
        }
    }
}

/// The numbers from one curve up to another.
fn numbers(from: u32, to: u32) -> impl Iterator<Item = u32> {
    (0..to.wrapping_sub(from)).map(move |k| from.wrapping_add(k))
}

impl<const AXES: usize> CurveConsumer<'_, AXES> {
    /// Finds the curve at a path distance, and the distance from the curve's start. `distance` must be at
    /// least that of the previous call. The call gives the curves before it back to the planner, at most
    /// [`MAX_CURVES_PER_TICK`]. Returns `None` before the first curve. Runs in the tick.
    #[inline(always)]
    pub fn follow(&mut self, distance: i64) -> Option<(Track<'_, AXES>, i64)> {
        // SAFETY: the start is in its ring. After the ring, the array continues for a whole window.
        let [first, rest @ ..] = unsafe { &*self.start.at.cast::<[Start; WINDOW]>() };
        let mut at = first;
        if rest.first()?.has_begun(distance) {
            at = last_begun(rest, distance)?;
            // SAFETY: both starts are in one window, and `first` is its first element.
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
        // SAFETY: the slot is in its ring, which is not empty. The start is not out of reach, so the planner
        // has written the curve. The planner does not change the slot until the slot is given back.
        let track = unsafe {
            assert_unchecked(!self.slot.at.is_null());
            Track::new(self.slot.at)
        };
        Some((track, along))
    }

    /// The curve on which the interrupt is, at the path distance of the last tick (LSB 2^-44 mm).
    pub fn peek(&self, distance: i64) -> Option<&Segment<AXES>> {
        self.at_hand(distance).map(|(track, _)| track.segment)
    }

    /// The interrupt's current curve, and the distance from the curve's start to the path distance
    /// `distance`, which must be on this curve. Both distances: LSB 2^-44 mm.
    pub fn at_hand(&self, distance: i64) -> Option<(Track<'_, AXES>, i64)> {
        // SAFETY: the start is in its ring.
        let start = unsafe { &*self.start.at }.get();
        let along = distance.wrapping_sub(start);
        if along < -(OUT_OF_REACH / 2) {
            return None;
        }
        fence(Ordering::Acquire);
        // SAFETY: as in `follow`. Before the first tick the slot may hold a part.
        unsafe { if (*self.slot.at).is_part() { None } else { Some((Track::new(self.slot.at), along)) } }
    }

    /// Driven distance at a path distance on the interrupt's current curve.
    #[cfg(feature = "driven")]
    pub(super) fn driven(&self, distance: i64) -> i64 {
        self.drives.at(distance)
    }

    /// The full number of the motion block to which a curve of the ring belongs, counted from 0 since
    /// `CurveRing::split`.
    pub fn block_of(&self, segment: &Segment<AXES>) -> u32 {
        whole(self.latest.load(Ordering::Relaxed), segment.block())
    }
}

/// The last of these starts that the distance has reached. The distance must have reached the first start.
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

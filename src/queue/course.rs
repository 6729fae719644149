//! The ring of curves, and where each of them begins: the tick finds the one it is on by path distance alone.
//!
//! Starts lie in an array of their own, twice as long as the ring, so that behind the last curve there is room for starts that
//! no distance reaches. So many of them are kept there as a tick looks at: it asks neither how many curves there are
//! nor where the array ends (its head is repeated behind its end), and halves a window of fixed size.
//!
//! A start is the word to the interrupt that its curve is there: it is written behind the curve, the upper half last. What it takes
//! the place of is out of reach in both halves, so that a start half written is out of reach too.
#![allow(unsafe_code)]
use super::ring::{Consumer, Producer, Ring};
use super::{SEGMENTS, Segment};
use core::ptr;
use core::sync::atomic::{AtomicU32, Ordering, fence};

/// Most curves that a tick passes.
pub const MOST: u32 = 32;

/// Curves that a tick looks at: the one it is on, the next one, and those that it halves five times.
const WINDOW: usize = 2 + MOST as usize;
/// How it halves them.
const HALVES: [usize; 5] = [16, 8, 4, 2, 1];
/// Starts behind a curve that are looked at from there.
const BEHIND: u32 = WINDOW as u32 - 1;
/// Numbers of curves are taken modulo this.
const PLACES: usize = 2 * SEGMENTS;
const MASK: u32 = PLACES as u32 - 1;

const _: () = assert!(PLACES.is_power_of_two() && SEGMENTS + WINDOW <= PLACES);

/// A start so far behind the last curve is out of reach: 2^61. Distances are compared up to 2^63 apart: as far as the curve at hand,
/// the last one and this together.
const OUT_OF_REACH: i64 = 1 << 61;

/// Curves longer than that move every start that is out of reach. A window of shorter ones does not come near it.
const LONG: i64 = OUT_OF_REACH / 64;

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

/// Static memory of the ring.
pub struct Course<const AXES: usize> {
    ring: Ring<Segment<AXES>, SEGMENTS>,
    starts: [Start; PLACES + WINDOW - 1],
}

/// Puts curves in.
pub struct Layer<'a, const AXES: usize> {
    ring: Producer<'a, Segment<AXES>, SEGMENTS>,
    /// End of the last one.
    end: i64,
    /// There were long ones.
    long: bool,
    starts: &'a [Start; PLACES + WINDOW - 1],
}

/// Follows them.
pub struct Follower<'a, const AXES: usize> {
    ring: Consumer<'a, Segment<AXES>, SEGMENTS>,
    starts: &'a [Start; PLACES + WINDOW - 1],
}

impl<const AXES: usize> Course<AXES> {
    /// No curve.
    pub const fn new() -> Self {
        Self { ring: Ring::new(), starts: [const { Start::zero() }; PLACES + WINDOW - 1] }
    }

    /// Both ends, emptied.
    pub fn split(&mut self) -> (Layer<'_, AXES>, Follower<'_, AXES>) {
        for start in &self.starts {
            start.set(out_of_reach(0), Ordering::Relaxed);
        }
        let (producer, consumer) = self.ring.split();
        let starts = &self.starts;
        (Layer { ring: producer, end: 0, long: false, starts }, Follower { ring: consumer, starts })
    }
}

impl<const AXES: usize> Default for Course<AXES> {
    fn default() -> Self {
        Self::new()
    }
}

/// The lower word is the highest one: a start half written is never before what it will be.
const fn out_of_reach(end: i64) -> i64 {
    end.wrapping_add(OUT_OF_REACH) | 0xFFFF_FFFF
}

impl<const AXES: usize> Layer<'_, AXES> {
    /// Whether there is no room, or more path than distances are compared over.
    #[inline(always)]
    pub fn is_full(&self) -> bool {
        self.ring.is_full() || (self.long && self.is_far())
    }

    #[inline(never)]
    fn is_far(&self) -> bool {
        let taken = self.ring.taken();
        self.ring.count().wrapping_sub(taken) > 1 && self.end.wrapping_sub(self.start(taken)) > OUT_OF_REACH
    }

    #[inline(always)]
    fn start(&self, number: u32) -> i64 {
        self.starts.get((number & MASK) as usize).map_or(0, Start::get)
    }

    /// Puts in what `fill` makes of a used curve, in its place; `false` if there is no room.
    #[inline(always)]
    pub fn push_with(&mut self, fill: impl FnOnce(&mut Segment<AXES>)) -> bool {
        let number = self.ring.count();
        let (mut start, mut end) = (0, 0);
        let pushed = self.ring.push_with(|segment| {
            fill(segment);
            start = segment.start.to_bits();
            end = start.wrapping_add(segment.shape.length.to_bits());
        });
        if pushed {
            self.end = end;
            if end.wrapping_sub(start) < LONG {
                self.set(number.wrapping_add(BEHIND), out_of_reach(end), Ordering::Relaxed);
            } else {
                self.long = true;
                self.clear_behind(number, BEHIND);
            }
            self.set(number, start, Ordering::Release);
        }
        pushed
    }

    /// So many starts behind the curve with this number are out of reach.
    #[inline(never)]
    fn clear_behind(&self, number: u32, count: u32) {
        for k in 1..=count {
            self.set(number.wrapping_add(k), out_of_reach(self.end), Ordering::Relaxed);
        }
    }

    #[inline(always)]
    fn set(&self, number: u32, start: i64, order: Ordering) {
        let place = (number & MASK) as usize;
        for place in [place, place + PLACES] {
            if let Some(at) = self.starts.get(place) {
                at.set(start, order);
            }
        }
    }

    /// Curves in the ring: the one the interrupt is on, and those before it.
    pub fn len(&self) -> u32 {
        self.ring.len()
    }

    /// Whether there was none yet.
    pub fn is_empty(&self) -> bool {
        self.ring.is_empty()
    }

    /// Curves put in since the split.
    pub fn count(&self) -> u32 {
        self.ring.count()
    }

    /// Curves the interrupt has left since the split.
    pub fn taken(&self) -> u32 {
        self.ring.taken()
    }

    /// The curve that was put in as the one with this number, if it is one of the last.
    pub fn recent(&self, number: u32) -> Option<&Segment<AXES>> {
        self.ring.recent(number)
    }

    /// Takes back the curves from the one with this number on, which the interrupt does not reach before they are put in anew.
    pub fn withdraw(&mut self, number: u32) {
        self.end = self.start(number);
        self.clear_behind(number.wrapping_sub(1), PLACES as u32 - 1);
        self.ring.withdraw(number);
    }
}

impl<const AXES: usize> Follower<'_, AXES> {
    /// The curve that a path distance not before the last one asked for is on, and the distance from its start; curves before it are
    /// given back, at most [`MOST`]. `None` before the first one. Runs in the tick.
    #[inline(always)]
    pub fn follow(&mut self, distance: i64) -> Option<(&Segment<AXES>, i64)> {
        let mut number = self.ring.taken();
        // The mask is below the length, and a window ends in it: no check of an index is left.
        let window: &[Start; WINDOW] = self.starts.get((number & MASK) as usize..)?.first_chunk()?;
        let [first, rest @ ..] = window;
        let mut at = first;
        if rest.first()?.has_begun(distance) {
            at = last_begun(rest, distance)?;
            let passed = ptr::from_ref(at).addr().wrapping_sub(ptr::from_ref(first).addr());
            number = number.wrapping_add((passed / size_of::<Start>()) as u32);
            self.ring.jump(number);
        }
        let along = distance.wrapping_sub(at.get());
        if along < -(OUT_OF_REACH / 2) {
            return None;
        }
        fence(Ordering::Acquire);
        // SAFETY: its start is not out of reach: it is in the ring, and not given back.
        Some((unsafe { self.ring.get(number) }, along))
    }

    /// The curve the interrupt is on.
    pub fn peek(&self) -> Option<&Segment<AXES>> {
        self.ring.peek()
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

//! The memory of the curves in the ring ([`super::curves`]). A slot of the ring has the data that every curve
//! has. A line has no other data. An arc or a polynomial has additional data, its *part*.
//!
//! | build | place of the part | slots per arc or polynomial |
//! |---|---|---|
//! | usual | in the same slot, after the other data | one |
//! | small | in the slot before the curve's slot | two |
//!
//! In a small build, the end of a slot with a part has a mark that says so. The part always lies just before
//! the curve's slot in memory. So there is one extra slot before the first slot of the ring. If a curve is in
//! the first slot of the ring, its part is in the extra slot. The last slot of the ring is then marked as a
//! part and stays empty.
#![allow(unsafe_code)]
use crate::machine::functions;
use crate::path::{Arc, Bent, Linear, Shape, Swings, add_cubic, add_poly};
use crate::quantity::{Distance, Position};
use core::cell::UnsafeCell;
use core::mem::{MaybeUninit, offset_of};

/// Whether each slot has room for a part after the data of its curve.
pub(super) const IS_WHOLE: bool = !functions::IS_SMALL;

/// Number of parts that fit into a slot, after the data of its curve.
const WHOLE: usize = if IS_WHOLE { 1 } else { 0 };

/// Largest number of slots that a curve takes.
pub(super) const MOST: usize = 2 - WHOLE;

/// Number of extra slots before the first slot of the ring.
pub(super) const BEFORE: usize = MOST - 1;

/// The data that every curve in the ring has; a line has no other data. The start of each curve is stored
/// separately: [`super::CurveProducer::start`].
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct Segment<const AXES: usize> {
    length: i64,
    gain: [i64; AXES],
    base: [Position; AXES],
    /// N number of the programmed block.
    pub n: u32,
    /// The lower half of the motion block's number: [`whole`].
    block: u16,
    unused: u8,
    /// The shift, with the kind of the curve in the bits above; or [`PART`].
    form: u8,
}

/// Bits for the curve's kind, above the bits of the shift.
const KIND: u8 = 0xC0;
const LINE: u8 = 0;
const ARC: u8 = 0x40;
const CUBIC: u8 = 0x80;
const POLY: u8 = 0xC0;
/// Marks a slot that holds a part. No shift has this value.
const PART: u8 = 0x3F;

/// The full number of a motion block, from its lower half and from a later number that is less than 2^16
/// higher.
pub(super) const fn whole(latest: u32, lower: u16) -> u32 {
    latest.wrapping_sub((latest as u16).wrapping_sub(lower) as u32)
}

/// Coefficients of a polynomial and their exponents.
#[derive(Clone, Copy)]
#[repr(C)]
struct Poly<const AXES: usize> {
    power: [[i32; 4]; AXES],
    down: [u8; AXES],
}

/// Room for the additional data of any curve.
#[repr(C)]
union Part<const AXES: usize> {
    arc: Arc,
    poly: Poly<AXES>,
}

/// Room for a curve.
#[repr(C)]
struct Cell<const AXES: usize> {
    segment: Segment<AXES>,
    part: [MaybeUninit<Part<AXES>>; WHOLE],
}

/// The slot of a curve.
pub(super) struct Place<const AXES: usize>(UnsafeCell<Cell<AXES>>);

// SAFETY: only the one planner writes it, before the interrupt sees a start of its curve, or after the
// interrupt has given it back. Between these times, only the one interrupt and the planner itself read it.
// The starts, and the count of passed curves, pass it on with release and acquire.
unsafe impl<const AXES: usize> Sync for Place<AXES> {}

impl<const AXES: usize> Place<AXES> {
    pub const fn blank() -> Self {
        Self(UnsafeCell::new(Cell {
            segment: Segment::BLANK,
            part: [const { MaybeUninit::uninit() }; WHOLE],
        }))
    }

    /// Marks the slot as empty.
    pub const fn clear(&mut self) {
        self.0.get_mut().segment.block = 0;
    }

    /// The data of a line.
    ///
    /// # Safety
    /// No other side writes the slot while the reference is in use.
    #[inline(always)]
    const unsafe fn segment(&self) -> &Segment<AXES> {
        // SAFETY: the caller guarantees it.
        unsafe { &(*self.0.get()).segment }
    }

    /// The lower half of the motion block's number.
    ///
    /// # Safety
    /// No other side writes the slot during the call.
    pub const unsafe fn block(&self) -> u16 {
        // SAFETY: the caller guarantees it. The rest of the slot may be a part.
        unsafe { (*self.0.get()).segment.block }
    }

    /// Changes the lower half of the motion block's number, for a curve that was withdrawn.
    ///
    /// # Safety
    /// No other side reads or writes the slot during the call.
    pub const unsafe fn set_block(&self, block: u16) {
        // SAFETY: the caller guarantees it.
        unsafe { (*self.0.get()).segment.block = block }
    }

    /// Whether this slot holds the part (the additional data) of a curve.
    ///
    /// # Safety
    /// No other side writes the slot during the call.
    #[inline(always)]
    pub const unsafe fn is_part(&self) -> bool {
        // SAFETY: the caller guarantees it. The other data of the slot may have any value.
        !IS_WHOLE && unsafe { (*self.0.get()).segment.form } == PART
    }
}

/// The place of the part that belongs to the curve in this slot.
#[inline(always)]
const fn part_of<const AXES: usize>(place: *const Place<AXES>) -> *const u32 {
    if IS_WHOLE {
        place.wrapping_byte_add(size_of::<Segment<AXES>>()).cast()
    } else {
        place.wrapping_sub(1).cast()
    }
}

/// A curve of the ring with all its data. The tick evaluates the curve with [`Self::at`].
#[derive(Clone, Copy)]
pub struct Track<'a, const AXES: usize> {
    /// The data that every curve has. For a line, these are all of its data.
    pub segment: &'a Segment<AXES>,
    /// The curve's slot. Reading the slot before is permitted too.
    place: *const Place<AXES>,
}

impl<'a, const AXES: usize> Track<'a, AXES> {
    /// The curve in a slot.
    ///
    /// # Safety
    /// [`write`] has written the curve, and no other side writes the slot while the reference is in use.
    #[inline(always)]
    pub(super) const unsafe fn new(place: *const Place<AXES>) -> Self {
        // SAFETY: the caller guarantees it.
        unsafe { Self { segment: (*place).segment(), place } }
    }

    /// The place of the part.
    #[inline(always)]
    const fn part<T>(&self) -> *const T {
        part_of(self.place).cast()
    }

    /// The additional data of an arc.
    ///
    /// # Safety
    /// The curve is an arc.
    #[inline(always)]
    const unsafe fn arc(&self) -> &'a Arc {
        // SAFETY: the caller guarantees it.
        unsafe { &*self.part() }
    }

    /// The additional data of a polynomial.
    ///
    /// # Safety
    /// The curve is a polynomial.
    #[inline(always)]
    const unsafe fn poly(&self) -> (&'a [[i32; 4]; AXES], &'a [u8; AXES]) {
        // SAFETY: the caller guarantees it.
        let Poly { power, down } = unsafe { &*self.part() };
        (power, down)
    }

    /// Position of every axis at a distance from the curve's start, LSB 2^-44 mm: see [`Shape::at`]. Runs in
    /// the tick.
    #[inline(always)]
    pub fn at(&self, distance: i64, out: &mut [Position; AXES]) {
        let Segment { base, form, .. } = self.segment;
        let linear = self.segment.linear();
        let w = linear.w(distance);
        *out = *base;
        if form & CUBIC != 0 {
            // SAFETY: the kind says that the curve is a polynomial.
            return unsafe {
                if form & KIND == POLY {
                    Self::add_bent::<false>(self.place, w, out);
                } else {
                    Self::add_bent::<true>(self.place, w, out);
                }
            };
        }
        if form & ARC != 0 {
            // SAFETY: the curve is an arc.
            unsafe { self.arc() }.add(w, out);
        }
        linear.add(w, base, out);
    }

    /// Adds a polynomial at `w`. Not inlined; otherwise lines would save its registers too.
    ///
    /// # Safety
    /// The curve is a polynomial.
    #[inline(never)]
    unsafe fn add_bent<const IS_CUBIC: bool>(place: *const Place<AXES>, w: i64, out: &mut [Position; AXES]) {
        // SAFETY: the caller guarantees it.
        let (Segment { gain, .. }, poly) = unsafe {
            let track = Self::new(place);
            (track.segment, track.poly())
        };
        if IS_CUBIC {
            add_cubic(w, gain, poly, out);
        } else {
            add_poly(w, gain, poly, out);
        }
    }

    /// As [`Self::at`], for callers outside the tick. A separate function, so that the curve is not on the
    /// caller's stack.
    #[inline(never)]
    pub fn point(&self, distance: i64) -> [Position; AXES] {
        self.shape().placed(distance, &self.segment.base)
    }

    /// Extends `swings`, the ranges of the derivatives of each axis, by those of a part of the curve
    /// ([`Shape::bend`]). A separate function, so that the curve is not on the caller's stack.
    #[inline(never)]
    pub fn bend(&self, part: [i64; 2], swings: &mut Swings<AXES>) {
        self.shape().bend(part, swings);
    }

    /// How far every axis travels per path distance at `along` from the curve's start, LSB 2^-40. Returns
    /// `None` for lines and arcs. The value is the difference of two points of the curve. Their distance to
    /// `along` is a 1024th of the curve's length, but at least 2^-14 mm or, on short curves, a 16th of the
    /// length. Do not call this function in the tick.
    #[inline(never)]
    pub fn slope(&self, along: i64) -> Option<[i64; AXES]> {
        if self.segment.form & CUBIC == 0 {
            return None;
        }
        let length = self.segment.length();
        let by = (length >> 10).max((length >> 4).min(1 << 30)).max(1);
        let ends = [along.saturating_sub(by), along.saturating_add(by)].map(|at| self.point(at));
        let [from, to] = ends;
        let mut slope = [0; AXES];
        for ((slope, from), to) in slope.iter_mut().zip(from).zip(to) {
            let travel = i128::from(to.to_bits().wrapping_sub(from.to_bits()));
            // Converts from 2^-32 mm per 2^-44 mm.
            *slope = (travel << 52).checked_div(2 * i128::from(by)).unwrap_or(0) as i64;
        }
        Some(slope)
    }

    /// The geometry of the curve, without its place in space.
    #[inline(never)]
    pub fn shape(&self) -> Shape<AXES> {
        // SAFETY: the kind says which data the curve has.
        let bent = unsafe {
            match self.segment.form & KIND {
                LINE => Bent::Line,
                ARC => Bent::Arc(self.arc()),
                _ => {
                    let (power, down) = self.poly();
                    Bent::Poly(power, down)
                }
            }
        };
        Shape::of_parts(Distance::from_bits(self.segment.length()), self.segment.linear(), bent)
    }
}

impl<const AXES: usize> Segment<AXES> {
    const BLANK: Self =
        Self { length: 0, gain: [0; AXES], base: [Position::ZERO; AXES], n: 0, block: 0, unused: 0, form: 0 };

    /// Path length of the curve, LSB 2^-44 mm.
    #[inline(always)]
    pub const fn length(&self) -> i64 {
        self.length
    }

    /// The point to which the curve's offsets are added, mm or degrees per axis.
    pub const fn base(&self) -> &[Position; AXES] {
        &self.base
    }

    /// The lower half of the motion block's number, which is counted from 0 since program start.
    #[inline(always)]
    pub const fn block(&self) -> u16 {
        self.block
    }

    /// Whether the curve is a line.
    pub const fn is_line(&self) -> bool {
        self.form & KIND == LINE
    }

    /// Whether the curve is an arc.
    pub const fn is_arc(&self) -> bool {
        self.form & KIND == ARC
    }

    #[inline(always)]
    const fn linear(&self) -> Linear<'_, AXES> {
        Linear { gain: &self.gain, shift: self.form & !KIND }
    }
}

/// Number of slots that a curve takes; `None` if the curve does not fit into [`MOST`] slots.
#[cfg_attr(feature = "fast", inline(always))]
pub(super) fn slots<const AXES: usize>(shape: &Shape<AXES>) -> Option<usize> {
    // An arc has two axes, so it fits for any number of axes.
    let fits = const {
        let (poly, arc) = (size_of::<Poly<AXES>>(), size_of::<Arc>());
        let room = offset_of!(Segment<AXES>, block);
        assert!(poly <= room && (AXES < 2 || arc <= room), "the slot before has room");
        arc <= room
    };
    match shape.bent() {
        Bent::Line => Some(1),
        Bent::Arc(_) if !IS_WHOLE && !fits => None,
        _ => Some(MOST),
    }
}

/// Writes a curve into a slot and the additional data into the part, with the base, the N number and the motion block.
/// `part`: the slot before, if the curve takes two slots.
///
/// # Safety
/// No other side reads or writes the slot, the slot of the part, and the slot before. All pointers are valid.
#[cfg_attr(feature = "fast", inline(always))]
pub(super) unsafe fn write<const AXES: usize>(
    place: *const Place<AXES>,
    part: Option<&Place<AXES>>,
    shape: &Shape<AXES>,
    base: &[Position; AXES],
    (n, block): (u32, u16),
) {
    let Linear { gain, shift } = shape.linear();
    // SAFETY: the caller guarantees that no other side uses the slots.
    unsafe {
        let kind = if shape.is_line() { LINE } else { write_part::<AXES>(part_of(place).cast_mut(), shape) };
        (*(*place).0.get()).segment = Segment {
            length: shape.length.to_bits(),
            gain: *gain,
            base: *base,
            n,
            block,
            unused: 0,
            form: shift & !KIND | kind,
        };
        if let Some(part) = part {
            let segment = &raw mut (*part.0.get()).segment;
            ((*segment).block, (*segment).form) = (block, PART);
        }
    }
}

/// Writes the additional data and returns the kind of the curve. Not inlined; otherwise lines would pay for
/// it.
///
/// # Safety
/// There is room for a part, and no other side reads or writes that room.
#[inline(never)]
unsafe fn write_part<const AXES: usize>(part: *mut u32, shape: &Shape<AXES>) -> u8 {
    // SAFETY: the caller guarantees it. Slots and parts are aligned to words.
    unsafe {
        match shape.bent() {
            Bent::Line => LINE,
            Bent::Arc(arc) => {
                *part.cast::<Arc>() = *arc;
                ARC
            }
            Bent::Poly(power, down) => {
                // Written field by field; otherwise the whole struct would first be built on the stack.
                let to = part.cast::<Poly<AXES>>();
                ((*to).power, (*to).down) = (*power, *down);
                let beyond = power.iter().fold(0, |all, [_, _, c4, c5]| all | c4 | c5);
                if beyond == 0 { CUBIC } else { POLY }
            }
        }
    }
}

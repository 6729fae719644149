//! The memory of curves ([`super::curves`]): a slot has what a line has, and what an arc or a polynomial has beside it is
//! a part of its own.
//!
//! Where there is memory for it, the part lies behind the slot. In a small build parts lie in a second ring, in the
//! order in which curves are put in, in units: a cubic takes one, an arc or another polynomial two that lie side by
//! side, for which one at the end is left out. A slot says where its part is, and a line where the next part goes: so
//! the slots of two curves say how much is in use between them, and nobody counts it. One unit stays empty, so that
//! all of them in use are told from none.
//!
//! Curves handed on and those of the look-ahead have a share of the units each. How far the look-ahead reaches does
//! not depend on how far the interrupt has come: the set points are the same whenever the planner is called.
#![allow(unsafe_code)]
use crate::machine::functions;
use crate::path::{Arc, Bent, Bounds, Linear, Shape, add_cubic, add_poly};
use crate::quantity::{Distance, Position};
use core::cell::UnsafeCell;
use core::mem::MaybeUninit;

/// Whether each slot has its part behind it. Then nobody asks for more than the number of curves.
pub(super) const IS_WHOLE: bool = !functions::IS_SMALL;

/// Parts behind a slot.
const WHOLE: usize = if IS_WHOLE { 1 } else { 0 };

/// The least look-ahead (P-STUP-00071): as many curves of any kind have room. More need not be in the ring together:
/// a span of several blocks is one of those that the look-ahead holds, and a curve of more elements passes through.
const LEAST: usize = 10;

/// Most units of a curve.
const MOST: usize = 2;
/// Units of curves handed on: so many curves of any kind as a tick may pass, with which it comes to the next one.
const HANDED: usize = MOST * super::MAX_CURVES_PER_TICK as usize;
/// Those of the look-ahead with which it is full.
const AHEAD: usize = 22;
/// All of them: before the look-ahead is full, a curve that was held back may be put in and another one; one unit may
/// be left out at the end, and one stays empty.
pub(super) const UNITS: usize = if IS_WHOLE { 0 } else { HANDED + AHEAD + 2 * MOST + 2 };

const _: () =
    assert!(IS_WHOLE || (AHEAD >= LEAST * MOST && UNITS <= 1 << 8), "places of 8 bits, enough of them");

/// What the ring has of a line, and of every other curve too. Where it starts is in the ring as well:
/// [`super::CurveProducer::start`].
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct Segment<const AXES: usize> {
    length: i64,
    gain: [i64; AXES],
    base: [Position; AXES],
    /// Programmed N number.
    pub n: u32,
    /// The lower half of the number of its motion block: [`whole`].
    block: u16,
    /// The unit where its part begins, or the next one.
    unit: u8,
    /// Shift, and above it the kind.
    form: u8,
}

/// Of what kind a curve is, above the bits of its shift.
const KIND: u8 = 0xC0;
const LINE: u8 = 0;
const ARC: u8 = 0x40;
const CUBIC: u8 = 0x80;
const POLY: u8 = 0xC0;

/// The number of a motion block from its lower half and a later number, less than 2^16 behind it.
pub(super) const fn whole(latest: u32, lower: u16) -> u32 {
    latest.wrapping_sub((latest as u16).wrapping_sub(lower) as u32)
}

/// Coefficients of a cubic and their exponents.
#[derive(Clone, Copy)]
#[repr(C)]
struct Cubic<const AXES: usize> {
    power: [[i32; 2]; AXES],
    down: [u8; AXES],
}

/// Those of another polynomial.
#[derive(Clone, Copy)]
#[repr(C)]
struct Poly<const AXES: usize> {
    power: [[i32; 4]; AXES],
    down: [u8; AXES],
}

/// Room for what any curve has beside a line.
#[repr(C)]
union Part<const AXES: usize> {
    arc: Arc,
    poly: Poly<AXES>,
    cubic: Cubic<AXES>,
}

/// A unit of such parts: a cubic, or half of any other.
#[repr(C)]
pub(super) union Unit<const AXES: usize> {
    cubic: Cubic<AXES>,
    half: [u32; HALF_ARC],
}

/// Words of half an arc.
const HALF_ARC: usize = size_of::<Arc>().div_ceil(2 * size_of::<u32>());

/// Room for a curve.
#[repr(C)]
struct Cell<const AXES: usize> {
    segment: Segment<AXES>,
    part: [MaybeUninit<Part<AXES>>; WHOLE],
}

/// The slot of a curve.
pub(super) struct Place<const AXES: usize>(UnsafeCell<Cell<AXES>>);

/// The unit of a part.
pub(super) struct UnitPlace<const AXES: usize>(UnsafeCell<MaybeUninit<Unit<AXES>>>);

// SAFETY: it is written only by the one planner, while the interrupt has not seen a start of its curve or has
// given it back, and read only by the one interrupt in between, or by the planner itself; starts and the count of
// curves left pass it with release and acquire.
unsafe impl<const AXES: usize> Sync for Place<AXES> {}

// SAFETY: as a place.
unsafe impl<const AXES: usize> Sync for UnitPlace<AXES> {}

impl<const AXES: usize> Place<AXES> {
    pub const fn blank() -> Self {
        let segment = Segment {
            length: 0,
            gain: [0; AXES],
            base: [Position::ZERO; AXES],
            n: 0,
            block: 0,
            unit: 0,
            form: 0,
        };
        Self(UnsafeCell::new(Cell { segment, part: [const { MaybeUninit::uninit() }; WHOLE] }))
    }

    /// It has no curve yet.
    pub const fn clear(&mut self) {
        self.0.get_mut().segment.block = 0;
    }

    /// What a line has.
    ///
    /// # Safety
    /// Nobody writes it as long as this is in use.
    #[inline(always)]
    const unsafe fn segment(&self) -> &Segment<AXES> {
        // SAFETY: the caller says so.
        unsafe { &(*self.0.get()).segment }
    }

    /// The lower half of the number of its motion block.
    ///
    /// # Safety
    /// Nobody writes it meanwhile.
    pub const unsafe fn block(&self) -> u16 {
        // SAFETY: the caller says so.
        unsafe { self.segment() }.block
    }

    /// That becomes another one: of a curve taken back.
    ///
    /// # Safety
    /// Nobody reads or writes it meanwhile.
    pub const unsafe fn set_block(&self, block: u16) {
        // SAFETY: the caller says so.
        unsafe { (*self.0.get()).segment.block = block }
    }

    /// The unit where its part begins, or the next one.
    ///
    /// # Safety
    /// Nobody writes it meanwhile.
    pub const unsafe fn unit(&self) -> usize {
        // SAFETY: the caller says so.
        unsafe { self.segment() }.unit as usize
    }
}

impl<const AXES: usize> UnitPlace<AXES> {
    pub const fn blank() -> Self {
        const {
            assert!(size_of::<Part<AXES>>() <= MOST * size_of::<Self>(), "any part has room");
            assert!(size_of::<Cubic<AXES>>() <= size_of::<Self>(), "a cubic has room");
        }
        Self(UnsafeCell::new(MaybeUninit::uninit()))
    }
}

/// A curve in its slot.
#[derive(Clone, Copy)]
pub struct Track<'a, const AXES: usize> {
    /// What a line has.
    pub segment: &'a Segment<AXES>,
    /// Its slot, and the first unit of all.
    place: *const Place<AXES>,
    units: *const UnitPlace<AXES>,
}

impl<'a, const AXES: usize> Track<'a, AXES> {
    /// The curve in a slot.
    ///
    /// # Safety
    /// [`PartWriter::write`] has put it in, and nobody writes it as long as this is in use; `units` are those it had.
    #[inline(always)]
    pub(super) const unsafe fn new(place: *const Place<AXES>, units: *const UnitPlace<AXES>) -> Self {
        // SAFETY: the caller says so.
        unsafe { Self { segment: (*place).segment(), place, units } }
    }

    /// Where its part is.
    #[inline(always)]
    const fn part<T>(&self) -> *const T {
        if IS_WHOLE {
            self.place.wrapping_byte_add(size_of::<Segment<AXES>>()).cast()
        } else {
            self.units.wrapping_add(self.segment.unit as usize).cast()
        }
    }

    /// What an arc has beside.
    ///
    /// # Safety
    /// It is one.
    #[inline(always)]
    const unsafe fn arc(&self) -> &'a Arc {
        // SAFETY: the caller says so.
        unsafe { &*self.part() }
    }

    /// What a polynomial has beside.
    ///
    /// # Safety
    /// It is one.
    #[inline(always)]
    const unsafe fn poly(&self) -> (&'a [[i32; 4]; AXES], &'a [u8; AXES]) {
        // SAFETY: the caller says so.
        let Poly { power, down } = unsafe { &*self.part() };
        (power, down)
    }

    /// What a cubic has beside.
    ///
    /// # Safety
    /// It is one.
    #[inline(always)]
    const unsafe fn cubic(&self) -> (&'a [[i32; 2]; AXES], &'a [u8; AXES]) {
        // SAFETY: the caller says so.
        let Cubic { power, down } = unsafe { &*self.part() };
        (power, down)
    }

    /// Position of every axis at a distance from its start, LSB 2^-44 mm: see [`Shape::at`]. Runs in the tick.
    #[inline(always)]
    pub fn at(&self, distance: i64, out: &mut [Position; AXES]) {
        let Segment { base, form, .. } = self.segment;
        let linear = self.segment.linear();
        let w = linear.w(distance);
        *out = *base;
        if form & CUBIC != 0 {
            // SAFETY: it is what its kind says.
            return unsafe {
                if form & KIND == POLY {
                    add_poly(w, linear.gain, self.poly(), out);
                } else {
                    add_cubic(w, linear.gain, self.cubic(), out);
                }
            };
        }
        if form & ARC != 0 {
            // SAFETY: it is one.
            unsafe { self.arc() }.add(w, out);
        }
        linear.add(w, out);
    }

    /// The same, not for the tick.
    pub fn point(&self, distance: i64) -> [Position; AXES] {
        self.shape().placed(distance, &self.segment.base)
    }

    /// Takes in how strongly a part of it bends ([`Shape::bend`]), as a call: the curve is not on the caller's stack.
    #[inline(never)]
    pub fn bend(&self, part: [i64; 2], bounds: &mut Bounds<AXES>) {
        self.shape().bend(part, bounds);
    }

    /// Its curve.
    #[inline(never)]
    pub fn shape(&self) -> Shape<AXES> {
        let whole;
        // SAFETY: it is what its kind says.
        let bent = unsafe {
            match self.segment.form & KIND {
                ARC => Bent::Arc(self.arc()),
                POLY => {
                    let (power, down) = self.poly();
                    Bent::Poly(power, down)
                }
                CUBIC => {
                    let (power, down) = self.cubic();
                    whole = power.map(|[c2, c3]| [c2, c3, 0, 0]);
                    Bent::Poly(&whole, down)
                }
                _ => Bent::Line,
            }
        };
        Shape::of_parts(Distance::from_bits(self.segment.length()), self.segment.linear(), bent)
    }
}

impl<const AXES: usize> Segment<AXES> {
    /// Path length, LSB 2^-44 mm.
    #[inline(always)]
    pub const fn length(&self) -> i64 {
        self.length
    }

    /// What the offsets of its points are added to.
    pub const fn base(&self) -> &[Position; AXES] {
        &self.base
    }

    /// The lower half of the number of its motion block, counted from 0 since program start.
    #[inline(always)]
    pub const fn block(&self) -> u16 {
        self.block
    }

    /// Whether it is a line.
    pub const fn is_line(&self) -> bool {
        self.form & KIND == LINE
    }

    #[inline(always)]
    const fn linear(&self) -> Linear<'_, AXES> {
        Linear { gain: &self.gain, shift: self.form & !KIND }
    }
}

/// Puts curves into slots, and their parts into units.
pub(super) struct PartWriter<'a, const AXES: usize> {
    units: &'a [UnitPlace<AXES>],
    /// Behind the last one.
    next: usize,
}

impl<'a, const AXES: usize> PartWriter<'a, AXES> {
    /// None is in.
    pub const fn new(units: &'a [UnitPlace<AXES>]) -> Self {
        Self { units, next: 0 }
    }

    /// The first unit.
    #[inline(always)]
    pub const fn units(&self) -> *const UnitPlace<AXES> {
        self.units.as_ptr()
    }

    /// Where the next part goes, or the front if there is too little room for it.
    pub const fn next(&self) -> usize {
        self.next
    }

    /// Parts from that unit on are taken back.
    pub const fn withdraw(&mut self, unit: usize) {
        self.next = unit;
    }

    /// Units in use from that one on.
    const fn used_from(&self, unit: usize) -> usize {
        if self.next < unit { self.next + UNITS - unit } else { self.next - unit }
    }

    /// Whether the look-ahead, whose parts begin at that unit, has all that it may have.
    pub const fn is_full(&self, ahead: usize) -> bool {
        self.used_from(ahead) > AHEAD
    }

    /// Whether curves handed on, from one unit to another, have more units than they may or, with `more`, would have
    /// with another curve.
    pub const fn is_sated(&self, [first, ahead]: [usize; 2], more: bool) -> bool {
        let more = if more { MOST } else { 0 };
        self.used_from(first).saturating_sub(self.used_from(ahead)) + more > HANDED
    }

    /// Puts a curve into a slot, with what its points are added to, its N number and its motion block; `false` if
    /// there is no room for its part. Parts in use begin at `first`.
    ///
    /// # Safety
    /// Nobody else reads or writes the slot, and nobody what is before that unit.
    #[cfg_attr(feature = "fast", inline(always))]
    pub unsafe fn write(
        &mut self,
        place: &Place<AXES>,
        shape: &Shape<AXES>,
        base: &[Position; AXES],
        (n, block): (u32, u16),
        first: usize,
    ) -> bool {
        let bent = shape.bent();
        let (kind, count) = match bent {
            Bent::Line => (LINE, 0),
            Bent::Arc(_) => (ARC, MOST),
            Bent::Poly(power, _) if power.iter().all(|[_, _, c4, c5]| c4 | c5 == 0) => (CUBIC, 1),
            Bent::Poly(..) => (POLY, MOST),
        };
        let Some(unit) = self.room(count, first) else { return false };
        // SAFETY: nobody has the slot, says the caller.
        let segment = unsafe { &mut (*place.0.get()).segment };
        let Linear { gain, shift } = shape.linear();
        *segment = Segment {
            length: shape.length.to_bits(),
            gain: *gain,
            base: *base,
            n,
            block,
            unit: unit as u8,
            form: shift & !KIND | kind,
        };
        if kind != LINE {
            self.write_part(place, unit, bent, kind);
        }
        self.next = unit + count;
        true
    }

    /// Where so many units lie side by side that are not in use.
    #[cfg_attr(feature = "fast", inline(always))]
    const fn room(&self, count: usize, first: usize) -> Option<usize> {
        if IS_WHOLE || count == 0 {
            return Some(self.next);
        }
        let wraps = self.next + count > UNITS;
        let unit = if wraps { 0 } else { self.next };
        // Whether those in use go on at the front already, and whether this one would reach the first of them.
        let goes_on = self.next < first;
        if (goes_on && wraps) || ((goes_on || wraps) && unit + count >= first) { None } else { Some(unit) }
    }

    /// Writes what comes to the linear part. Not inlined: lines would pay for it.
    #[inline(never)]
    fn write_part(&self, place: &Place<AXES>, unit: usize, bent: Bent<'_, AXES>, kind: u8) {
        let part = if IS_WHOLE {
            place.0.get().wrapping_byte_add(size_of::<Segment<AXES>>()).cast::<u32>()
        } else {
            self.units().wrapping_add(unit).cast_mut().cast::<u32>()
        };
        // SAFETY: so many units from there on are there, or the part of the slot is, aligned to words; none of it is in
        // use, says the caller; of writers there is one.
        unsafe {
            match bent {
                Bent::Line => {}
                Bent::Arc(arc) => *part.cast::<Arc>() = *arc,
                Bent::Poly(power, down) if kind == CUBIC => {
                    let power = power.map(|[c2, c3, ..]| [c2, c3]);
                    *part.cast::<Cubic<AXES>>() = Cubic { power, down: *down };
                }
                Bent::Poly(power, down) => {
                    *part.cast::<Poly<AXES>>() = Poly { power: *power, down: *down };
                }
            }
        }
    }
}

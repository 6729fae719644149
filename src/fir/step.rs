//! The interrupt's end: one set point per axis and tick, in integers, without a division.
//!
//! A mean is a running sum that is never summed up: n·y grows by what the newest sample is more than the
//! oldest one. Symmetric taps multiply the sum of a pair. What rounding leaves of a set point is added to the
//! next one: over a motion, the sum of what comes out is that of what went in, and where the path rests the
//! set point is that of the path to the last bit.
use super::bank::{COARSE, PLAIN};
use super::{AxisWords, FilterTick, Kind, Layout, ONE, Words};
use crate::quantity::Position;
use crate::queue::Lag;
use core::sync::atomic::{AtomicU16, Ordering};

/// Samples per tick and axis that are filled with a new position.
const FILLED: usize = 8;

/// Shift of a difference before it is divided, and what is added to a remainder so that it is never negative:
/// that many divisors.
const SCALE: u32 = 13;
const BIAS: u32 = 14;

/// What the interrupt remembers.
pub(super) struct State<const AXES: usize, const TAPS: usize> {
    axes: [Axis<TAPS>; AXES],
    out: [Position; AXES],
    /// Place of the newest sample.
    at: usize,
    /// Path distance of the last tick.
    distance: i64,
    /// Ticks since then in which the path has rested, and how many it takes to settle.
    rested: u32,
    /// Ticks since an axis has moved beside the path.
    alone: u32,
    window: u32,
    /// AX_DEV as in [`Words::tolerance`]; the ages of the delayed set point.
    tolerance: u32,
    delayed: [u32; 2],
    /// Samples filled since the last change was asked for.
    filled: usize,
    lag: Lag,
    runs: bool,
}

/// One axis.
struct Axis<const TAPS: usize> {
    samples: [i64; TAPS],
    layout: Layout,
    /// 2^32 by the length, up.
    factor: i32,
    /// Remainders of the last two set points: of a mean with [`BIAS`].
    rest: [i32; 2],
}

impl<const AXES: usize, const TAPS: usize> State<AXES, TAPS> {
    /// All bits zero.
    pub const fn new() -> Self {
        Self {
            axes: [const { Axis { samples: [0; TAPS], layout: PLAIN_ZERO, factor: 0, rest: [0; 2] } }; AXES],
            out: [Position::ZERO; AXES],
            at: 0,
            distance: 0,
            rested: 0,
            alone: 0,
            window: 0,
            tolerance: 0,
            delayed: [0; 2],
            filled: 0,
            lag: Lag::NONE,
            runs: false,
        }
    }
}

const PLAIN_ZERO: Layout = Layout { length: 0, ..PLAIN };

/// The interrupt's end of [`super::Filters`].
pub struct Filtered<'a, const AXES: usize, const TAPS: usize> {
    words: &'a Words<AXES, TAPS>,
    state: &'a mut State<AXES, TAPS>,
}

impl<'a, const AXES: usize, const TAPS: usize> Filtered<'a, AXES, TAPS> {
    /// At rest at `start`.
    pub(super) fn new(
        words: &'a Words<AXES, TAPS>,
        state: &'a mut State<AXES, TAPS>,
        start: &[Position; AXES],
    ) -> Self {
        let mut filtered = Self { words, state };
        // At least one call; each fills some.
        for _ in 0..=TAPS / FILLED {
            filtered.take_over(start);
        }
        filtered
    }

    /// A part of taking over other kernels, at rest at `path`.
    #[cold]
    #[inline(never)]
    fn take_over(&mut self, path: &[Position; AXES]) {
        let Self { words, state } = self;
        let asked = words.asked.load(Ordering::Acquire);
        if words.done.load(Ordering::Relaxed) == asked {
            return;
        }
        state.runs = false;
        state.out = *path;
        let from = state.filled;
        for (axis, position) in state.axes.iter_mut().zip(path) {
            axis.samples.iter_mut().skip(from).take(FILLED).for_each(|sample| *sample = position.to_bits());
        }
        state.filled = from + FILLED;
        if state.filled < TAPS {
            return;
        }
        for (axis, words) in state.axes.iter_mut().zip(&words.axes) {
            axis.begin(words);
        }
        let delay = words.delay.load(Ordering::Relaxed);
        state.delayed = [delay / 2, delay.div_ceil(2)];
        state.lag.delay = delay.div_ceil(2);
        state.window = words.window.load(Ordering::Relaxed);
        state.tolerance = words.tolerance.load(Ordering::Relaxed);
        (state.filled, state.at) = (0, 0);
        (state.rested, state.alone) = (state.window, state.window);
        state.runs = words.runs.load(Ordering::Relaxed) != 0;
        words.done.store(asked, Ordering::Release);
    }

    /// Filters a set point of every axis.
    #[inline(always)]
    fn filter(&mut self, path: &[Position; AXES]) {
        let State { axes, out, at, .. } = &mut *self.state;
        let next = *at + 1;
        *at = if next >= TAPS { 0 } else { next };
        for (((axis, words), x), y) in axes.iter_mut().zip(&self.words.axes).zip(path).zip(out) {
            axis.step(*at, &words.taps, x.to_bits(), y);
        }
        if self.state.tolerance != 0 {
            self.monitor();
        }
    }

    /// Keeps the largest deviations from the delayed set points.
    #[inline(never)]
    fn monitor(&mut self) {
        let State { axes, out, at, delayed: [later, earlier], .. } = &*self.state;
        for ((axis, words), y) in axes.iter().zip(&self.words.axes).zip(out) {
            let [later, earlier] = [later, earlier].map(|age| axis.sample(*at, *age));
            // The mean of both: of half cycles.
            let twice = later.wrapping_add(earlier).wrapping_sub(y.to_bits().wrapping_mul(2));
            let coarse = twice.unsigned_abs().wrapping_add((2 << COARSE) - 1) >> (COARSE + 1);
            let coarse = u32::try_from(coarse).unwrap_or(u32::MAX);
            if coarse > words.deviation.load(Ordering::Relaxed) {
                words.deviation.store(coarse, Ordering::Relaxed);
            }
        }
    }
}

impl<const AXES: usize, const TAPS: usize> FilterTick<AXES> for Filtered<'_, AXES, TAPS> {
    #[inline(always)]
    fn step(&mut self, points: &[Position; AXES], distance: i64, beside: bool) {
        let state = &mut *self.state;
        if !state.runs || self.words.runs.load(Ordering::Relaxed) == 0 {
            state.out = *points;
            return;
        }
        // Of a channel without overlays the compiler knows that it is false.
        if beside {
            state.alone = 0;
        } else if state.alone < state.window {
            state.alone += 1;
        }
        if distance != state.distance {
            state.distance = distance;
            state.rested = 0;
            self.words.unsettled.store(1, Ordering::Release);
        } else if state.rested < state.window {
            state.rested += 1;
            if state.rested == state.window {
                self.words.unsettled.store(0, Ordering::Release);
            }
        }
        self.filter(points);
    }

    fn rest(&mut self, path: &[Position; AXES]) -> bool {
        let State { runs, rested, alone, window, distance, .. } = *self.state;
        if runs && (rested < window || alone < window) {
            self.step(path, distance, false);
            return true;
        }
        if self.words.done.load(Ordering::Relaxed) != self.words.asked.load(Ordering::Relaxed) {
            self.take_over(path);
        }
        false
    }

    #[inline(always)]
    fn set_points<'b>(&'b self, _: &'b [Position; AXES]) -> &'b [Position; AXES] {
        &self.state.out
    }

    #[inline(always)]
    fn lag(&mut self) -> Option<(&mut Lag, bool)> {
        let settled = self.state.rested >= self.state.window;
        Some((&mut self.state.lag, settled))
    }
}

impl<const TAPS: usize> Axis<TAPS> {
    /// With the kernel written for it, at rest where all samples are.
    fn begin(&mut self, words: &AxisWords<TAPS>) {
        self.layout = words.layout();
        words.deviation.store(0, Ordering::Relaxed);
        let length = self.layout.length.max(1);
        (self.factor, self.rest) = (0, [0; 2]);
        if self.layout.kind == Kind::Mean {
            // Once per change, not in a tick of motion.
            self.factor = (u32::MAX / length).wrapping_add(1) as i32;
            self.rest = [(length << BIAS) as i32; 2];
        }
    }

    /// The sample of that age; `at` is the place of the newest.
    #[inline(always)]
    fn sample(&self, at: usize, age: u32) -> i64 {
        self.samples.get(Self::place(at, age)).copied().unwrap_or(0)
    }

    #[inline(always)]
    const fn place(at: usize, age: u32) -> usize {
        let place = at.wrapping_sub(age as usize);
        if place > at { place.wrapping_add(TAPS) } else { place }
    }

    #[inline(always)]
    fn step(&mut self, at: usize, taps: &[AtomicU16; TAPS], x: i64, y: &mut Position) {
        let Layout { kind, newest, length } = self.layout;
        match kind {
            Kind::Mean => {
                // Before the new sample is put in: with the longest window both have one place.
                let oldest = self.sample(at, newest + length);
                self.put(at, x);
                let newest = if newest == 0 { x } else { self.sample(at, newest) };
                let grows = newest.wrapping_sub(oldest);
                *y = Position::from_bits(y.to_bits().wrapping_add(self.mean(grows, length)));
            }
            Kind::Taps => {
                self.put(at, x);
                *y = Position::from_bits(self.multiply(at, taps));
            }
            Kind::Delay => {
                self.put(at, x);
                *y = Position::from_bits(self.sample(at, newest));
            }
        }
    }

    #[inline(always)]
    fn put(&mut self, at: usize, x: i64) {
        if let Some(slot) = self.samples.get_mut(at) {
            *slot = x;
        }
    }

    /// How much a mean of `length` samples grows where their sum does by `grows`, below 2^44.
    ///
    /// n·y + r = S + r′, with the remainders r of this set point and r′ of the last one: n·Δy = ΔS + 2r′ − r″
    /// − r. The quotient is found in two steps: of the upper bits, then of what is left.
    #[inline(always)]
    fn mean(&mut self, grows: i64, length: u32) -> i64 {
        let factor = i64::from(self.factor);
        let [last, before] = self.rest;
        let upper = ((((grows >> SCALE) as i32 as i64) * factor) >> 32) as i32;
        let left = (grows as i32)
            .wrapping_sub((upper << SCALE).wrapping_mul(length as i32))
            .wrapping_add(2 * last - before);
        let lower = ((left as i64 * factor) >> 32) as i32 - (1 << BIAS);
        let rest = left.wrapping_sub(lower.wrapping_mul(length as i32));
        self.rest = [rest, last];
        (i64::from(upper) << SCALE).wrapping_add(i64::from(lower))
    }

    /// Σ h·x.
    ///
    /// The samples lie in two runs, behind and before the place of the newest one. A pair may have both in one
    /// run or one in each: that changes once.
    #[inline(always)]
    fn multiply(&mut self, at: usize, taps: &[AtomicU16; TAPS]) -> i64 {
        let Layout { newest, length, .. } = self.layout;
        let last = Self::place(at, newest);
        let first = Self::place(at, newest + length - 1);
        let pairs = (length / 2) as usize;
        let (older, newer) = if first <= last {
            (self.samples.get(first..=last).unwrap_or(&[]), &[][..])
        } else {
            (self.samples.get(first..).unwrap_or(&[]), self.samples.get(..=last).unwrap_or(&[]))
        };
        let both = older.len().min(newer.len());
        let mut sum = Sum { lower: 0, upper: 0 };
        let (apart, inner) = taps.as_slice().split_at_checked(both).unwrap_or((&[], taps));
        // As many of each: groups of four begin alike.
        let (first, last) = (older.get(..both), newer.get(newer.len() - both..));
        sum.pairs(first.unwrap_or(&[]), last.unwrap_or(&[]), apart);
        let run = if older.len() > both {
            older.get(both..).unwrap_or(&[])
        } else {
            newer.get(..newer.len() - both).unwrap_or(&[])
        };
        let half = run.len() / 2;
        let behind = run.get(run.len() - half..).unwrap_or(&[]);
        sum.pairs(run.get(..half).unwrap_or(&[]), behind, inner.get(..half).unwrap_or(&[]));
        if length & 1 == 1
            && let (Some(tap), Some(centre)) = (taps.get(pairs), run.get(half))
        {
            sum.add(tap, *centre);
        }
        // Modulo 2^64; about the centre it fits.
        let about = run.get(half).or(newer.last()).copied().unwrap_or(0);
        let [rest, _] = self.rest;
        let left = sum.total().wrapping_sub(about.wrapping_mul(i64::from(ONE))).wrapping_add(i64::from(rest));
        self.rest[0] = left as i32 & (ONE - 1);
        about.wrapping_add(left >> ONE.trailing_zeros())
    }
}

/// Modulo 2^64: lower + upper·2^32.
struct Sum {
    lower: i64,
    upper: i32,
}

impl Sum {
    #[inline(always)]
    fn add(&mut self, tap: &AtomicU16, x: i64) {
        let tap = i32::from(tap.load(Ordering::Relaxed) as i16);
        // Both words signed.
        let lower = x as i32;
        let upper = ((x >> 32) as i32).wrapping_add((x as u32 >> 31) as i32);
        self.lower = self.lower.wrapping_add(i64::from(lower) * i64::from(tap));
        self.upper = self.upper.wrapping_add(upper.wrapping_mul(tap));
    }

    /// The first ones of `older` with the last ones of `newer`, as many as there are taps. Four at a time.
    #[inline(never)]
    fn pairs(&mut self, older: &[i64], newer: &[i64], taps: &[AtomicU16]) {
        let mut sum = Self { ..*self };
        let ((fours, older), (newer, reversed), (taps_of_fours, taps)) =
            (older.as_chunks::<4>(), newer.as_rchunks::<4>(), taps.as_chunks::<4>());
        for (([a0, a1, a2, a3], [b3, b2, b1, b0]), [t0, t1, t2, t3]) in
            fours.iter().zip(reversed.iter().rev()).zip(taps_of_fours)
        {
            sum.add(t0, a0.wrapping_add(*b0));
            sum.add(t1, a1.wrapping_add(*b1));
            sum.add(t2, a2.wrapping_add(*b2));
            sum.add(t3, a3.wrapping_add(*b3));
        }
        for ((a, b), tap) in older.iter().zip(newer.iter().rev()).zip(taps) {
            sum.add(tap, a.wrapping_add(*b));
        }
        *self = sum;
    }

    fn total(&self) -> i64 {
        self.lower.wrapping_add(i64::from(self.upper) << 32)
    }
}

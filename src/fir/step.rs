//! The interrupt's end: one set point per axis and tick, in integers, without a division.
//!
//! What rounding leaves of a set point is added to the next one: over a motion, the sum of what comes out is
//! that of what went in, and where the path rests the set point is that of the path to the last bit.
use super::bank::{COARSE, PLAIN};
use super::mean::Mean;
use super::taps::{Taps, Window};
use super::{AxisWords, FilterTick, Kind, Layout, Words};
use crate::quantity::Position;
use crate::queue::Lag;
use core::sync::atomic::Ordering;

/// Samples per tick and axis that are filled with a new position.
const FILLED: usize = 8;

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
    samples: Samples<TAPS>,
    /// The taps as [`AxisWords`] has them.
    kernel: [u8; TAPS],
    layout: Layout,
    window: Window,
    mean: Mean,
    taps: Taps,
}

/// Memory of the last ticks: positions, or second differences, each of them twice so that any window of them
/// lies in one piece.
struct Samples<const TAPS: usize>([[i32; 2]; TAPS]);

impl<const AXES: usize, const TAPS: usize> State<AXES, TAPS> {
    /// All bits zero.
    pub const fn new() -> Self {
        Self {
            axes: [const { Axis::ZERO }; AXES],
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
        for ((axis, words), position) in state.axes.iter_mut().zip(&words.axes).zip(path) {
            let sample = match words.layout().kind {
                Kind::Taps => 0,
                _ => position.to_bits(),
            };
            axis.samples.0.iter_mut().skip(from).take(FILLED).for_each(|slot| *slot = split(sample));
            for (own, byte) in axis.kernel.iter_mut().zip(&words.taps).skip(from).take(FILLED) {
                *own = byte.load(Ordering::Relaxed);
            }
        }
        state.filled = from + FILLED;
        if state.filled < TAPS {
            return;
        }
        for ((axis, words), position) in state.axes.iter_mut().zip(&words.axes).zip(path) {
            axis.begin(words, position.to_bits());
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
        for ((axis, x), y) in axes.iter_mut().zip(path).zip(out) {
            axis.step(*at, x.to_bits(), y);
        }
        if self.state.tolerance != 0 {
            self.monitor();
        }
    }

    /// Keeps the largest deviations from the delayed set points.
    #[inline(never)]
    fn monitor(&mut self) {
        let State { axes, out, at, delayed, .. } = &mut *self.state;
        for ((axis, words), y) in axes.iter_mut().zip(&self.words.axes).zip(out) {
            let [later, earlier] = axis.delayed(*at, *delayed);
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
                for (axis, words) in state.axes.iter().zip(&self.words.axes) {
                    if axis.taps.is_passed {
                        words.deviation.store(u32::MAX, Ordering::Relaxed);
                    }
                }
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
    const ZERO: Self = Self {
        samples: Samples([[0; 2]; TAPS]),
        kernel: [0; TAPS],
        layout: Layout { length: 0, ..PLAIN },
        window: Window::ZERO,
        mean: Mean::ZERO,
        taps: Taps::ZERO,
    };

    /// With the kernel written for it, at rest at `x`.
    fn begin(&mut self, words: &AxisWords<TAPS>, x: i64) {
        self.layout = words.layout();
        words.deviation.store(0, Ordering::Relaxed);
        self.window = Window::of::<TAPS>(&self.layout);
        self.mean = Mean::of(self.layout.length);
        self.taps = Taps::at(x);
    }

    #[inline(always)]
    fn step(&mut self, at: usize, x: i64, y: &mut Position) {
        *y = Position::from_bits(match self.layout.kind {
            Kind::Mean => y.to_bits().wrapping_add(self.average(at, x)),
            Kind::Taps => y.to_bits().wrapping_add(self.weigh(at, x)),
            Kind::Delay => {
                self.samples.put_position(at, x);
                self.samples.position(at, self.layout.newest)
            }
        });
    }

    /// How much the set point of an axis with a mean moves. Its own function, as the next one: the tick has no
    /// registers left for them.
    #[inline(never)]
    fn average(&mut self, at: usize, x: i64) -> i64 {
        let Layout { newest, length, .. } = self.layout;
        // Before the new sample is put in: with the longest window both have one place.
        let mut grows = x.wrapping_sub(self.samples.position(at, newest + length));
        self.samples.put_position(at, x);
        if newest > 0 {
            grows = grows.wrapping_sub(x).wrapping_add(self.samples.position(at, newest));
        }
        self.mean.grow(grows, length)
    }

    /// The same of an axis with taps.
    #[inline(never)]
    fn weigh(&mut self, at: usize, x: i64) -> i64 {
        let second = self.taps.take(x);
        self.samples.put_difference(at, second);
        let sum = self.window.weigh(self.samples.0.as_flattened(), &self.kernel, at, self.taps.carried());
        self.taps.give(sum)
    }

    /// The positions of these ages; `at` is the place of the newest. Once per tick.
    fn delayed(&mut self, at: usize, ages: [u32; 2]) -> [i64; 2] {
        if self.layout.kind == Kind::Taps {
            let [later, earlier] = ages;
            let second = self.samples.difference(at, later);
            let [now, before] = self.taps.late(second);
            [now, if earlier > later { before } else { now }]
        } else {
            ages.map(|age| self.samples.position(at, age))
        }
    }
}

const fn split(position: i64) -> [i32; 2] {
    [position as i32, (position >> 32) as i32]
}

impl<const TAPS: usize> Samples<TAPS> {
    #[inline(always)]
    fn put_position(&mut self, at: usize, x: i64) {
        if let Some(slot) = self.0.get_mut(at) {
            *slot = split(x);
        }
    }

    /// The position of that age; `at` is the place of the newest.
    #[inline(always)]
    fn position(&self, at: usize, age: u32) -> i64 {
        let place = at.wrapping_sub(age as usize);
        let place = if place > at { place.wrapping_add(TAPS) } else { place };
        let [lower, upper] = self.0.get(place).copied().unwrap_or([0; 2]);
        i64::from(upper) << 32 | i64::from(lower as u32)
    }

    #[inline(always)]
    fn put_difference(&mut self, at: usize, second: i32) {
        if let Some((first, again)) = self.0.as_flattened_mut().split_at_mut_checked(TAPS)
            && let (Some(slot), Some(copy)) = (first.get_mut(at), again.get_mut(at))
        {
            (*slot, *copy) = (second, second);
        }
    }

    /// The second difference of that age.
    #[inline(always)]
    fn difference(&self, at: usize, age: u32) -> i32 {
        self.0.as_flattened().get((at + TAPS).wrapping_sub(age as usize)).copied().unwrap_or(0)
    }
}

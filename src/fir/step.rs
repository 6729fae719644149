//! The interrupt's handle of the filters: one set point per axis and tick, in integers, without a division.
//!
//! The rounding remainder of a set point is added to the next one, so rounding errors do not add up over a
//! motion. While the path stands still, the set point is exactly that of the path.
use super::bank::{COARSE, PLAIN};
use super::mean::Mean;
use super::samples::{Ring, Samples};
use super::taps::{Taps, Window};
use super::{AxisWords, FilterTick, Kind, Layout, Words};
use crate::quantity::Position;
use crate::queue::Lag;
use core::sync::atomic::{Ordering, compiler_fence};

/// Number of samples per tick and axis that are filled with a new position.
const FILLED: usize = 8;

/// State of the interrupt.
pub(super) struct State<const AXES: usize, const TAPS: usize> {
    axes: [Axis<TAPS>; AXES],
    out: [Position; AXES],
    /// Whether every axis has a mean without a delay.
    all_means: bool,
    /// Place of the newest second difference.
    at: usize,
    /// Path distance of the last tick.
    distance: i64,
    /// Number of ticks for which the path has stood still. At `window` ticks the filters have settled.
    rested: u32,
    /// Number of ticks since the last motion of a single axis.
    alone: u32,
    window: u32,
    /// AX_DEV as in [`Words::tolerance`], and ages of the delayed set point.
    tolerance: u32,
    delayed: [u32; 2],
    /// Number of samples filled since the last change was demanded.
    filled: usize,
    lag: Lag,
    runs: bool,
}

/// State of one axis.
#[repr(C)]
struct Axis<const TAPS: usize> {
    ring: Ring,
    mean: Mean,
    layout: Layout,
    window: Window,
    taps: Taps,
    samples: Samples<TAPS>,
    /// The taps in the format of [`AxisWords`].
    kernel: [u8; TAPS],
}

impl<const AXES: usize, const TAPS: usize> State<AXES, TAPS> {
    /// A state with all filters off; all bits are zero.
    pub const fn new() -> Self {
        Self {
            axes: [const { Axis::ZERO }; AXES],
            out: [Position::ZERO; AXES],
            all_means: false,
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

    /// Restarts the count of ticks since the last motion of a single axis.
    #[cold]
    #[inline(never)]
    const fn accompany(&mut self) {
        self.alone = 0;
    }
}

/// The interrupt's handle of [`super::Filters`].
pub struct Filtered<'a, const AXES: usize, const TAPS: usize> {
    words: &'a Words<AXES, TAPS>,
    state: &'a mut State<AXES, TAPS>,
}

impl<'a, const AXES: usize, const TAPS: usize> Filtered<'a, AXES, TAPS> {
    /// Filters of axes that stand still at `start`.
    pub(super) fn new(
        words: &'a Words<AXES, TAPS>,
        state: &'a mut State<AXES, TAPS>,
        start: &[Position; AXES],
    ) -> Self {
        let mut filtered = Self { words, state };
        // At least one call is needed; each call fills some samples.
        for _ in 0..=TAPS / FILLED {
            filtered.take_over(start);
        }
        filtered
    }

    /// Does a part of a change of coefficients, while the axes stand still at `path`.
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
            axis.samples.fill(from, FILLED, sample);
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
        let is_mean = |axis: &Axis<TAPS>| axis.layout.kind == Kind::Mean && axis.layout.newest == 0;
        state.all_means = state.axes.iter().all(is_mean);
        (state.filled, state.at) = (0, 0);
        (state.rested, state.alone) = (state.window, state.window);
        state.runs = words.runs.load(Ordering::Relaxed) != 0;
        words.done.store(asked, Ordering::Release);
    }

    /// Handles the start of the path's motion.
    #[cold]
    #[inline(never)]
    fn start(&mut self) {
        self.state.rested = 0;
        self.words.unsettled.store(1, Ordering::Release);
    }

    /// Counts a tick in which the path stands still.
    #[inline(never)]
    fn settle(&mut self, beside: bool) {
        let state = &mut *self.state;
        if !beside && state.alone < state.window {
            state.alone += 1;
        }
        if state.rested < state.window {
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
    }

    /// Filters a set point of every axis.
    #[inline(always)]
    fn filter(&mut self, path: &[Position; AXES]) {
        let State { axes, out, at, all_means, .. } = &mut *self.state;
        if *all_means {
            average_all(axes, path, out);
        } else {
            let next = *at + 1;
            *at = if next >= TAPS { 0 } else { next };
            for ((axis, x), y) in axes.iter_mut().zip(path).zip(out) {
                if axis.layout.kind == Kind::Taps {
                    *y = Position::from_bits(y.to_bits().wrapping_add(axis.weigh(*at, x.to_bits())));
                } else {
                    axis.delay(x.to_bits(), y);
                }
            }
        }
        if self.state.tolerance != 0 {
            self.monitor();
        }
    }

    /// Updates the largest distance of each axis from its delayed, unfiltered set point.
    #[cold]
    #[inline(never)]
    fn monitor(&mut self) {
        let State { axes, out, at, delayed, .. } = &mut *self.state;
        for ((axis, words), y) in axes.iter_mut().zip(&self.words.axes).zip(out) {
            let [later, earlier] = axis.delayed(*at, *delayed, y.to_bits());
            // The mean of both positions, because the delay may have half a cycle.
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
        // In a channel without overlays, the compiler knows that `beside` is false.
        if beside {
            state.accompany();
        }
        if distance == state.distance {
            self.settle(beside);
        } else {
            state.distance = distance;
            if state.rested > 0 {
                self.start();
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
        ring: Ring::of(1),
        mean: Mean::ZERO,
        layout: Layout { length: 0, ..PLAIN },
        window: Window::ZERO,
        taps: Taps::ZERO,
        samples: Samples::ZERO,
        kernel: [0; TAPS],
    };

    /// Puts the coefficients of the planner into force, while the axis stands still at `x`.
    fn begin(&mut self, words: &AxisWords<TAPS>, x: i64) {
        self.layout = words.layout();
        let Layout { kind, newest, length } = self.layout;
        words.deviation.store(0, Ordering::Relaxed);
        self.ring = Ring::of(if kind == Kind::Mean { newest + length } else { newest });
        self.window = Window::of::<TAPS>(&self.layout);
        self.mean = Mean::of(length);
        self.taps = Taps::at(x);
    }

    /// Writes a position and returns the one that leaves the ring. Returns `None` if the ring would be longer
    /// than the memory.
    #[inline(always)]
    fn exchange(&mut self, x: i64) -> Option<i64> {
        let Some(oldest) = self.samples.exchange(self.ring.place(), x) else { return self.exchange_last(x) };
        self.ring.pass();
        Some(oldest)
    }

    /// As [`Self::exchange`], if the ring begins again at its last place.
    #[cold]
    #[inline(never)]
    fn exchange_last(&mut self, x: i64) -> Option<i64> {
        self.ring.rewind();
        let oldest = self.samples.exchange(self.ring.place(), x)?;
        self.ring.pass();
        Some(oldest)
    }

    /// A tick with a mean and no delay: the set point `y`, for the path at `x`.
    #[inline(always)]
    fn average(&mut self, x: i64, y: &mut Position) {
        let Some(oldest) = self.exchange(x) else { return };
        let grows = x.wrapping_sub(oldest);
        // Without this fence the compiler loads all values first, and runs out of registers.
        compiler_fence(Ordering::SeqCst);
        *y = Position::from_bits(self.mean.follow(grows, y.to_bits()));
    }

    /// A tick with taps: returns the change of the set point. `at` is the place of the newest second
    /// difference. A separate function, because the tick has no registers left.
    #[inline(never)]
    fn weigh(&mut self, at: usize, x: i64) -> i64 {
        let second = self.taps.take(x);
        self.samples.put_difference(at, second);
        let moved = self.window.weigh(self.samples.differences(), &self.kernel, at, self.taps.moved());
        self.taps.give(moved)
    }

    /// As [`Self::average`], with a delay; with or without a mean.
    #[inline(never)]
    fn delay(&mut self, x: i64, y: &mut Position) {
        let Layout { kind, newest, .. } = self.layout;
        let Some(oldest) = self.exchange(x) else { return };
        *y = Position::from_bits(if kind == Kind::Mean {
            let first = self.samples.position(&self.ring, newest);
            self.mean.follow(first.wrapping_sub(oldest), y.to_bits())
        } else if newest > 0 {
            oldest
        } else {
            x
        });
    }

    /// The positions with these ages, for the set point `y`; `at` is the place of the newest second
    /// difference. Call this function once per tick.
    fn delayed(&mut self, at: usize, ages: [u32; 2], y: i64) -> [i64; 2] {
        match self.layout.kind {
            Kind::Taps => {
                let [later, earlier] = ages;
                let second = self.samples.difference(at, later);
                let [now, before] = self.taps.late(second);
                [now, if earlier > later { before } else { now }]
            }
            Kind::Mean => ages.map(|age| self.samples.position(&self.ring, age)),
            Kind::Delay => [y; 2],
        }
    }
}

/// A tick of axes that all have a mean and no delay.
#[inline(always)]
fn average_all<const TAPS: usize>(axes: &mut [Axis<TAPS>], path: &[Position], out: &mut [Position]) {
    for ((axis, x), y) in axes.iter_mut().zip(path).zip(out) {
        axis.average(x.to_bits(), y);
    }
}

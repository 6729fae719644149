//! Computes how far the taps of a filter move an axis off its path, and which limits of acceleration and
//! speed keep this deviation inside AX_DEV.
//!
//! **Bound by the acceleration.** Let h be the taps, δ a filter that only delays by the same time, and G the
//! second sum of h − δ. The deviation of an axis from its delayed set point is exactly Σ G·x'', where x'' are
//! the second differences of its set points. So the deviation is at most Σ|G| times the largest acceleration.
//! A step of speed adds at most |G(0)| times the step. With SHARE p, all values are multiplied by p.
//!
//! **Bound by acceleration and jerk.** If the jerk of the axis is limited everywhere, also at corners without
//! a curve, there are two other bounds, and the smaller one holds. G is split into a part g and the
//! differences of a function T. Then the deviation is at most Σ|g| times the largest acceleration plus Σ|T|
//! times the largest jerk. The two bounds come from two splits. S(k) is the sum of G from the outer end to k:
//!
//! | T | Σ\|g\| |
//! |---|---|
//! | S up to the centre | \|ΣG\|: of a sinc of the order 100 nearly 0 |
//! | S up to its last change of sign, 0 from there to the centre | \|ΣG\| for orders below that |
//!
//! Accelerations and jerks are lowered by the same factor ([`Watch::bound`]). The worst motion with these
//! limits reaches at least 94 % of the smaller bound, with ramps of 50 cycles. So no other bound would be
//! much smaller.
//!
//! **Parts of AX_DEV.** Without such a jerk limit, acceleration and steps of speed at corners (P-AXIS-00013)
//! share AX_DEV. Their sum never exceeds AX_DEV, because each may have any sign:
//!
//! | where | quantity | part |
//! |---|---|---|
//! | in blocks longer than the filter | acceleration of the axis, times Σ\|G\| | 0.91 |
//! | a step of speed with no other one within the length of the filter | the step times \|G(0)\|, beside the acceleration before and after it | the rest: 0.09…1 |
//! | closer steps, and the blocks between them | each step | 0.09 |
//! | | acceleration of the axis | 0.455 |
//! | | all steps, as the acceleration of a curve: steps per time | 0.455 |
//!
//! **Why the limits are not higher at corners.** A sinc of a high order has many lobes. The worst motion
//! speeds up and brakes in the rhythm of these lobes. A corner is only one or two pulses of jerk, so its
//! deviation is smaller than AX_DEV. But all blocks have the same limits. The table gives deviations as parts
//! of AX_DEV, for corners of 90° at 4000 mm/min, FCUT = 30 Hz, 1 ms, TRAPEZ with ramps of 50 ms:
//!
//! | order | a corner | short blocks, same limits | a corner, with the best of all ratios of acceleration to jerk |
//! |---|---|---|---|
//! | 48 | 0.97 | | 0.97 |
//! | 64 | 0.96 | 0.97 | 0.97 |
//! | 78 | 0.90 | | 0.96 |
//! | 80 | 0.89 | 0.97 | 0.96 |
//! | 100 | 0.42 | 0.94 | 0.69 |
//! | 128 | 0.36 | 0.75 | 0.59 |
//! | 200 | 0.31 | 0.69 | 0.47 |
//!
//! Up to order 96, longer ramps would permit a corner with 0.9 of AX_DEV, but the program usually takes
//! longer.
//!
//! Separate limits for corners between long blocks would not help either. Their deviation depends more on the
//! speed than on the neighbouring blocks. All deviations grow in proportion to the limits. With limits for
//! 0.9 of AX_DEV at 4000 mm/min, other corners of the same square, and a feed hold, would exceed AX_DEV. With
//! the present limits, their deviations are:
//!
//! | order | 90° at 4000 mm/min | at a lower feed, or override | a reversal there | a hold while speeding up to 4000 mm/min |
//! |---|---|---|---|---|
//! | 100 | 0.42 | 0.88 (173 mm/min) | 0.93 | 0.84 |
//! | 128 | 0.36 | 0.54 (101 mm/min) | 0.68 | 0.51 |
//! | 200 | 0.31 | 0.38 (70 mm/min) | 0.55 | 0.40 |
//!
//! Longer ramps reduce these differences. With ramps of 80 to 100 ms, and limits for 0.9 at a corner, slower
//! corners and a feed hold reach at most 1.07 of AX_DEV. But if an operator changes the override by two
//! percent in the rhythm of the lobes, the deviation is 1.07 to 1.68 of AX_DEV. So higher limits would be
//! possible only for the ramps of the program, and only for an axis that stands still on the other side of
//! the transition. Motions that a command changes would keep the present limits.
//!
//! At a corner without a curve, above order 100, a deviation of 0.9 would leave only 0.1 of AX_DEV for
//! acceleration. This is a ninth of the present value.
use super::{AxisWords, Kind, Layout, ONE};
use crate::math::float::{max, min};

/// Part of AX_DEV for acceleration.
pub(super) const ACCELERATION: f32 = 0.91;
/// Part of AX_DEV for a step of speed with another step within the window of the filter.
pub(crate) const CLOSE: f32 = 0.09;
/// Parts of the acceleration's part, for blocks that the motion may pass within the window. One half is for
/// their acceleration, the other for the steps between them, which add up as in a curve.
pub(crate) const SHORT: f32 = 0.5;
/// Permitted deviation of an axis that continues after a step at the same speed, as a part of the deviation
/// of an axis that stops there. The value is (1 − 0.91)/(1 − 0.455), rounded down.
pub(crate) const GOING_ON: f32 = 0.16;
/// Part of AX_DEV that is used if jerk is limited everywhere; the rest is for rounding of limits and set
/// points.
const SMOOTH: f32 = 0.97;
/// Margin for rounding in `f32` and of set points.
const MARGIN: f32 = 1.0 - 1.0 / 65_536.0;

/// Distances from the centre, 0…100 cycles.
const SIDE: usize = super::MAX_ORDER as usize / 2 + 2;

/// Limits for the plan of an axis, because of its filter taps, AX_DEV and ACC_FACT. The head of
/// `fir/shape.rs` defines h and G.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Watch {
    /// Σ|h|: the filter raises speed, acceleration and jerk by at most this factor. Without negative taps,
    /// the factor is 1.
    pub gain: f32,
    /// Largest acceleration, mm/tick²; `None` if AX_DEV is not given.
    pub accel: Option<f32>,
    /// Largest step of speed that AX_DEV permits at constant speed before and after the step, mm/tick.
    pub knee: f32,
    /// Length of the filter, ticks. The deviations of two steps of speed within this time add up.
    pub window: f32,
    /// Σ|G| / |G(0)|, ticks: an acceleration causes as much deviation as a step of speed of `ratio` times the
    /// acceleration.
    pub ratio: f32,
    /// ACC_FACT of `#FILTER`, 1 to 10: factor for the permitted step of speed at a corner without a curve.
    /// The filter smooths the step, so the step may be larger.
    pub acc_fact: f32,
    /// The largest tap: a step of speed becomes an acceleration of at most `tap` times the step per tick.
    pub tap: f32,
    /// Two bounds; each has a factor of acceleration, 1/(mm/tick²), and a factor of jerk, 1/(mm/tick³). The
    /// deviation is at most AX_DEV if, for one bound, acceleration and jerk times their factors add up to at
    /// most 1. `None` if AX_DEV is not given.
    pub bound: Option<[[f32; 2]; 2]>,
}

/// The sums of the taps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Shape {
    /// Σ|h|.
    pub gain: f32,
    /// Σ|G|, ticks².
    pub area: f32,
    /// Largest |G|, ticks.
    pub peak: f32,
    /// Ticks from the first tap to the last one.
    pub window: f32,
    /// The largest tap.
    pub tap: f32,
    /// Σ|g|, ticks², and Σ|T|, ticks³, of both splits.
    pub smooth: [[f32; 2]; 2],
}

impl Shape {
    /// No limits.
    pub const NONE: Self =
        Self { gain: 1.0, area: 0.0, peak: 0.0, window: 0.0, tap: 1.0, smooth: [[0.0; 2]; 2] };

    /// The sums for the current taps.
    pub fn of<const TAPS: usize>(layout: &Layout, words: &AxisWords<TAPS>) -> Self {
        let total = one(layout);
        let window = layout.length.saturating_sub(1) as f32;
        let mut shape = Self { window, tap: 1.0 / total, ..Self::NONE };
        if layout.kind == Kind::Taps {
            let (mut gain, mut largest, pairs) = (0, 0, layout.length.div_ceil(2));
            for (k, tap) in (1..=pairs).zip(words.pairs()) {
                // With an odd number of taps, the centre is a pair of halves.
                let size = if k == pairs && !layout.length.is_multiple_of(2) { 2 * tap } else { tap };
                gain += 2 * tap.abs();
                largest = largest.max(size.abs());
            }
            shape.tap = largest as f32 / ONE as f32;
            shape.gain = if gain > ONE { gain as f32 / ONE as f32 * (2.0 - MARGIN) } else { 1.0 };
        }
        let (two, scale) = (layout.length.is_multiple_of(2), (2.0 - MARGIN) / total);
        let (mut tail, mut tails) = (0i32, 0.0);
        // On one side, T is 0 from the last change of sign to the centre. `inside` is Σ|g| of this side;
        // `outside` is Σ|T| of both sides.
        let (mut inside, mut outside) = (0.0, 0.0);
        second_sums(layout, words, |distance, sum| {
            // Both sides count, from the centre or from one of the two centre taps outwards.
            let sides = if distance == 0 || two && distance == 1 { 1.0 } else { 2.0 };
            let size = sum.unsigned_abs() as f32 * scale;
            let before = tail;
            tail += sum;
            let rest = (tail as f32 * scale).abs();
            if distance > 0 {
                if before.signum() * tail.signum() < 0 {
                    (inside, outside) = (rest, tails);
                } else {
                    inside += size;
                }
                tails += sides * rest;
            }
            if distance == usize::from(two) {
                let (all, centre) = if two { (2 * tail, 0.0) } else { (tail + before, size) };
                shape.smooth = [[(all as f32 * scale).abs(), tails], [2.0 * inside + centre, outside]];
            }
            shape.area += if distance == 0 && !two { size } else { 2.0 * size };
            shape.peak = max(shape.peak, size);
        });
        shape
    }

    /// Part of AX_DEV for a step of speed. On both sides of the step, the axis accelerates with at most the
    /// jerk `jerk`, up to `accel`. `tolerance` is AX_DEV, mm.
    #[inline(never)]
    pub fn corner<const TAPS: usize>(
        &self,
        (layout, words): (&Layout, &AxisWords<TAPS>),
        (accel, jerk): (f32, f32),
        tolerance: f32,
    ) -> f32 {
        let sums = Sums::of(layout, words);
        // At a distance of k ticks from the step, the acceleration is at most jerk·(k + 1).
        let ramp = if jerk * 256.0 < accel { 256 } else { (accel / jerk) as i32 };
        let [mut ends, mut goes_on] = [1.0; 2];
        let reach = (layout.length / 2 + 1) as i32;
        for shift in 0..reach {
            // Seen from `shift` ticks before the step: acceleration before and after the step.
            let [before, behind] = [-shift, shift].map(|from| {
                let rises = jerk
                    * (sums.first(from, from + ramp - 1)
                        + (1 - from) as f32 * sums.zeroth(from, from + ramp - 1));
                (rises + accel * sums.zeroth(from + ramp, 2 * SIDE as i32)) / tolerance
            });
            let size = max(sums.at(shift) / self.peak, 1e-6);
            ends = min(ends, (1.0 - before) / size);
            goes_on = min(goes_on, (1.0 - before - behind) / size);
        }
        min(ends, goes_on * (1.0 / GOING_ON)) * MARGIN
    }

    /// The value of [`Watch::bound`], with AX_DEV = `tolerance` (mm).
    pub fn bound(&self, tolerance: f32) -> [[f32; 2]; 2] {
        self.smooth.map(|split| split.map(|sum| sum / (SMOOTH * tolerance)))
    }

    /// Largest acceleration (mm/tick²) and largest step of speed (mm/tick) with AX_DEV = `tolerance` (mm).
    pub fn limits(&self, tolerance: f32) -> (f32, f32) {
        (ACCELERATION * MARGIN * tolerance / self.area, MARGIN * tolerance / self.peak)
    }
}

/// The sum of the taps.
fn one(layout: &Layout) -> f32 {
    if layout.kind == Kind::Mean { layout.length as f32 } else { ONE as f32 }
}

/// Calls `each` with G for every distance from the centre, from the outside to the centre, in units of
/// [`one`]. With an even number of taps, distances are half a cycle less and begin with 1.
fn second_sums<const TAPS: usize>(
    layout: &Layout,
    words: &AxisWords<TAPS>,
    mut each: impl FnMut(usize, i32),
) {
    let pairs = (layout.length / 2) as usize;
    let outer = if layout.length.is_multiple_of(2) { pairs.saturating_sub(1) } else { pairs };
    let mean = layout.kind == Kind::Mean;
    let (mut first, mut second) = (0, 0);
    for (k, tap) in words.pairs().enumerate().take(outer) {
        first += if mean { 1 } else { tap };
        second += first;
        each(pairs - 1 - k, second);
    }
}

/// |G| over the distance from the centre, and its sums outwards.
struct Sums {
    at: [f32; SIDE],
    zeroth: [f32; SIDE],
    first: [f32; SIDE],
}

impl Sums {
    fn of<const TAPS: usize>(layout: &Layout, words: &AxisWords<TAPS>) -> Self {
        let mut sums = Self { at: [0.0; SIDE], zeroth: [0.0; SIDE], first: [0.0; SIDE] };
        let scale = 1.0 / one(layout);
        let at = &mut sums.at;
        second_sums(layout, words, |distance, sum| {
            if let Some(slot) = at.get_mut(distance) {
                *slot = sum.unsigned_abs() as f32 * scale;
            }
        });
        if layout.length.is_multiple_of(2) {
            // The distance is half a cycle less than the true one, so the result is never too low.
            at[0] = at[1];
        }
        let (mut zeroth, mut first) = (0.0, 0.0);
        for (k, ((at, to_zeroth), to_first)) in
            sums.at.iter().zip(&mut sums.zeroth).zip(&mut sums.first).enumerate().skip(1)
        {
            zeroth += at;
            first += k as f32 * at;
            (*to_zeroth, *to_first) = (zeroth, first);
        }
        sums
    }

    fn at(&self, distance: i32) -> f32 {
        self.at.get(distance.unsigned_abs() as usize).copied().unwrap_or(0.0)
    }

    fn up_to(sums: &[f32; SIDE], distance: i32) -> f32 {
        sums.get((distance.max(0) as usize).min(SIDE - 1)).copied().unwrap_or(0.0)
    }

    /// Σ |G(i)| for `from` ≤ i ≤ `to`.
    fn zeroth(&self, from: i32, to: i32) -> f32 {
        let below = |x: i32| {
            if x < 0 { -Self::up_to(&self.zeroth, -x - 1) } else { self.at[0] + Self::up_to(&self.zeroth, x) }
        };
        if to < from { 0.0 } else { below(to) - below(from - 1) }
    }

    /// Σ i·|G(i)| for `from` ≤ i ≤ `to`.
    fn first(&self, from: i32, to: i32) -> f32 {
        let below = |x: i32| Self::up_to(&self.first, if x < 0 { -x - 1 } else { x });
        if to < from { 0.0 } else { below(to) - below(from - 1) }
    }
}

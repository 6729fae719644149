//! The time law of one block: up to four parts (speed up, cruise, slow down), exact in its length.
//!
//! The fastest profile from `v_in` to `v_out` over the length has the highest peak that the length and the limits
//! allow. The peak is searched in `f32`; with its ramp times taken as given, the distance of both slopes is then
//! computed in integers and the cruise gets what is left, to 2^-36 tick. If nothing is left (a slope that fills the
//! block, rounded against us), all times shrink by the missing part in ten million; the margins of the limits hold
//! that, and [`Profile::plan`] verifies it.
use super::ramp::Ramp;
use crate::lookahead::{Limits, min};
use crate::math::divide::{div_shift, div_wide};
use crate::math::root::sqrt_f32;
use crate::math::wide::{mul_shift, mul_wide};
use crate::quantity::{Distance, Speed, Time};

/// Three parts of a change of speed: acceleration rises, holds, falls.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Change {
    /// Their times, LSB 2^-36 tick.
    pub times: [u64; 3],
    /// Speed before the first, between them and after the last, LSB 2^-58 mm/tick.
    pub speeds: [i64; 4],
}

/// Speed over time in one block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Profile {
    /// From `v_in` to the peak.
    pub up: Change,
    /// Time at the peak, LSB 2^-36 tick.
    pub cruise: u64,
    /// From the peak to `v_out`.
    pub down: Change,
}

/// The plan broke a limit: a defect of the planner, reported instead of executed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Unplannable;

/// Longest block: 2^27 ticks.
const LONGEST: u64 = 1 << 63;

/// 2^58 and 2^36 as factors.
const SPEED_ONE: f32 = (1u64 << 58) as f32;
const TIME_ONE: f32 = (1u64 << 36) as f32;

/// Speed in units of 2^-58 from `f32`; the product is exact, the cast cuts nothing above 2^-34.
pub fn speed_bits(v: f32) -> i64 {
    (v * SPEED_ONE) as i64
}

/// Speed as `f32`.
pub fn speed_f32(bits: i64) -> f32 {
    bits as f32 * (1.0 / SPEED_ONE)
}

impl Change {
    /// Change from `v0` to `v1` with these times: speeds between the parts follow from equal peak accelerations,
    /// dv = ap (t1/2 + t2 + t3/2).
    fn new(v0: i64, v1: i64, times: [u64; 3]) -> Self {
        let dv = v1 - v0;
        let whole = times[0] + 2 * times[1] + times[2];
        let part = |time: u64| {
            let (hi, lo) = mul_wide(dv.unsigned_abs(), time);
            let size = div_wide(hi, lo, whole.max(1)) as i64;
            if dv < 0 { -size } else { size }
        };
        Self { times, speeds: [v0, v0 + part(times[0]), v1 - part(times[2]), v1] }
    }

    /// Path length of the three parts, LSB 2^-44 mm.
    pub fn lengths(&self) -> [i64; 3] {
        let [t1, t2, t3] = self.times;
        let [v0, v1, v2, v3] = self.speeds;
        // ∫v: a third of the change in a rising part, half while it holds, two thirds in a falling part
        [area(v0 + (v1 - v0) / 3, t1), area(v1 + (v2 - v1) / 2, t2), area(v3 - (v3 - v2) / 3, t3)]
    }

    /// Time of all three parts.
    pub fn time(&self) -> u64 {
        self.times.iter().sum()
    }

    /// Peak acceleration and the jerks of both ramps as `f32`, for verification.
    fn peak(&self) -> [f32; 3] {
        let dv = speed_f32((self.speeds[3] - self.speeds[0]).abs());
        let [t1, t2, t3] = self.times.map(|t| t as f32 * (1.0 / TIME_ONE));
        let whole = 0.5 * (t1 + t3) + t2;
        let a = if whole > 0.0 { dv / whole } else { 0.0 };
        let over = |t: f32| if t > 0.0 { a / t } else { 0.0 };
        [a, over(t1), over(t3)]
    }
}

/// Speed times time: 2^-58 · 2^-36 to 2^-44.
fn area(v: i64, t: u64) -> i64 {
    mul_shift(v, t as i64, 50)
}

impl Profile {
    /// The fastest profile over `length` inside `limits`.
    ///
    /// # Errors
    /// [`Unplannable`] if the speeds cannot be joined over that length, which the look-ahead rules out.
    pub fn plan(length: Distance, v_in: Speed, v_out: Speed, limits: &Limits) -> Result<Self, Unplannable> {
        let (v_in, v_out, length) = (v_in.to_bits(), v_out.to_bits(), length.to_bits());
        let up = Ramp::new(limits.a_up, limits.j[0], limits.j[1]);
        let down = Ramp::new(limits.a_down, limits.j[3], limits.j[2]);
        let low = v_in.max(v_out);
        let peak = low + peak_above(&up, &down, [v_in, v_out, low], length, limits.v);

        let times = |ramp: &Ramp, from: i64| {
            let times = ramp.times(speed_f32(peak - from));
            // up, so that rounding never raises a jerk
            times.map(|t| if peak == from || t == 0.0 { 0 } else { (t * TIME_ONE) as u64 + 1 })
        };
        let up_times = times(&up, v_in);
        let [end, hold, begin] = times(&down, v_out);
        let mut profile = Self {
            up: Change::new(v_in, peak, up_times),
            cruise: 0,
            down: Change::new(peak, v_out, [begin, hold, end]),
        };
        let slopes = profile.slopes_length();
        let rest = length - slopes;
        if rest >= 0 {
            // 2^-44 / 2^-58 to 2^-36; the remainder is less than 2^-36 tick of travel
            profile.cruise = div_shift(rest as u64, 50, peak.max(1) as u64);
        } else {
            let shrink = |time: u64| {
                let (hi, lo) = mul_wide(time, length.unsigned_abs());
                div_wide(hi, lo, slopes.max(1).unsigned_abs()) + u64::from(time > 0)
            };
            profile.up = Change::new(v_in, peak, profile.up.times.map(shrink));
            profile.down = Change::new(peak, v_out, profile.down.times.map(shrink));
        }
        profile.verify(limits)
    }

    fn slopes_length(&self) -> i64 {
        self.up.lengths().iter().sum::<i64>() + self.down.lengths().iter().sum::<i64>()
    }

    /// Duration of the block.
    pub fn time(&self) -> Time {
        Time::from_bits(self.up.time() + self.cruise + self.down.time())
    }

    /// Highest speed.
    pub fn peak(&self) -> Speed {
        Speed::from_bits(self.up.speeds[3])
    }

    /// Limits carry margins of 2^-20 (acceleration) and 2^-13 (jerk); half of them may be used up here.
    fn verify(self, limits: &Limits) -> Result<Self, Unplannable> {
        let [a, j0, j1] = self.up.peak();
        let [d, j2, j3] = self.down.peak();
        const A: f32 = 1.0 + 1.0 / 2_097_152.0;
        const J: f32 = 1.0 + 1.0 / 16_384.0;
        let inside = a <= limits.a_up * A
            && d <= limits.a_down * A
            && [j0, j1, j2, j3].iter().zip(&limits.j).all(|(j, limit)| *j <= limit * J)
            && speed_f32(self.up.speeds[3]) <= limits.v * A;
        if inside && self.cruise < LONGEST { Ok(self) } else { Err(Unplannable) }
    }
}

/// How far the peak lies above `low`, the higher one of both speeds: as far as the limit or the length allows.
///
/// The distance of both slopes grows with the peak; the root is bracketed and found by the Illinois form of the
/// secant method in a bounded number of steps.
fn peak_above(up: &Ramp, down: &Ramp, [v_in, v_out, low]: [i64; 3], length: i64, v_limit: f32) -> i64 {
    let limit = speed_bits(v_limit) - low;
    if limit <= 0 {
        return 0;
    }
    let [from_in, from_out] = [v_in, v_out].map(speed_f32);
    let [above_in, above_out] = [v_in, v_out].map(|v| speed_f32(low - v));
    let target = length as f32 * (1.0 / (1u64 << 44) as f32);
    let excess =
        |x: f32| up.distance(from_in, above_in + x) + down.distance(from_out, above_out + x) - target;
    let [mut x0, mut x1] = [0.0, speed_f32(limit)];
    let mut over = excess(x1);
    if over <= 0.0 {
        return limit;
    }
    let mut under = excess(x0);
    if under >= 0.0 {
        return 0;
    }
    // The distance grows with a power of the peak between 1.5 and 2.
    let mut x = x1 * sqrt_f32(min(under / (under - over), 1.0));
    let mut last_over = false;
    for step in 0..PEAK_STEPS {
        let value = excess(x);
        let same = step > 0 && last_over == (value > 0.0);
        last_over = value > 0.0;
        if last_over {
            (x1, over) = (x, value);
            if same {
                under *= 0.5;
            }
        } else {
            (x0, under) = (x, value);
            if same {
                over *= 0.5;
            }
        }
        let next = x0 + (x1 - x0) * (under / (under - over));
        let step = next - x;
        x = next;
        if value == 0.0 || step * step <= x * x * CLOSE {
            break;
        }
    }
    // A little below the root, so that the cruise has something to take up.
    let gain = speed_bits(x * (1.0 - 1.0 / 4_194_304.0)).clamp(0, limit);
    // A peak nobody could see would only cost parts.
    if gain < low >> 22 { 0 } else { gain }
}

/// Square of 2^-23: the next step would not move the root.
const CLOSE: f32 = 1.0 / (1u64 << 46) as f32;

/// Steps of the search for the peak.
const PEAK_STEPS: usize = 20;

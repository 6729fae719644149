//! The speed profile of one span: a gain of speed (three parts), a part at constant speed, and a braking
//! (three parts). The profile covers exactly the length of the span.
//!
//! The fastest profile has the highest peak speed that length and limits permit. A search in `f32` finds this
//! peak, and the ramp times for this peak are fixed. Integers then compute the length of both ramps. The rest
//! of the length has constant speed, and the time of this part is rounded to 2^-36 tick.
//!
//! The two ramps alone may be slightly longer than the span, because the search has rounding errors. Then all
//! times are shortened by one common factor, at most by 2^-22 of their value. Limits have margins for this,
//! and [`Profile::plan`] checks that the margins suffice. In a very short span, the rounding of the length
//! itself exceeds these margins. There the length of one part is changed instead, by up to 2^-42 mm.
use super::area;
use super::ramp::{JerkLimited, Ramp, Stepped, root_of_cubic};
use super::ramp_shape::RampShape;
use crate::machine::functions::StepBuilt;
use crate::math::divide::{div_shift, div_wide};
use crate::math::float::{max, min, size_f32, to_bits, to_f32};
use crate::math::root::sqrt_f32;
use crate::math::wide::{mul_near, mul_shift, mul_wide};
use crate::quantity::{DISTANCE_LSB, Distance, SPEED_LSB, Speed, Time, speed_bits, speed_f32};
use crate::slope::emit::TICK;
use crate::slope::limits::{Limits, SlopeLaw};

/// How the three parts of a [`Change`] divide a change of speed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// The slopes TRAPEZ, SIN2 and HSC: acceleration rises, is constant, and falls.
    JerkLimited(RampShape),
    /// The slope STEP: one constant acceleration, an unused part without duration, and another constant
    /// acceleration.
    Stepped(StepBuilt),
}

impl Default for Form {
    fn default() -> Self {
        Self::JerkLimited(RampShape::Linear)
    }
}

/// A change of speed inside a profile. The change has three parts, one after the other in time.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Change {
    /// How the parts divide the change.
    pub form: Form,
    /// Times of the three parts, LSB 2^-36 tick.
    pub times: [u64; 3],
    /// Speeds before the first part, between the parts and after the last part, LSB 2^-58 mm/tick.
    pub speeds: [i64; 4],
    /// Path lengths of the parts, LSB 2^-44 mm.
    pub lengths: [i64; 3],
}

/// The path speed over time in one span: a change to the peak speed, a part at constant speed, and a change
/// to the end speed.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Profile {
    /// The change from the start speed of the span to the peak speed.
    pub up: Change,
    /// Time at the peak speed, LSB 2^-36 tick.
    pub cruise: u64,
    /// The change from the peak speed to the end speed of the span.
    pub down: Change,
}

impl Profile {
    /// Sets all parts of the profile to zero.
    #[inline(never)]
    pub fn clear(&mut self) {
        for change in [&mut self.up, &mut self.down] {
            change.form = Form::default();
            (change.times, change.speeds, change.lengths) = ([0; 3], [0; 4], [0; 3]);
        }
        self.cruise = 0;
    }
}

/// The reason why a span has no profile.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Unplannable {
    /// The plan exceeds a limit. This is a defect of the planner; the plan is reported and not executed.
    Broken,
    /// The profile takes more than 2^27 ticks. Only a reduced speed (P-AXIS-00214) leads to this.
    TooSlow,
}

/// Longest span: 2^27 ticks.
const LONGEST: u64 = 1 << 63;

/// The difference `high` − `low`.
#[cfg_attr(feature = "fast", inline(always))]
fn gap_f32(low: i64, high: i64) -> f32 {
    size_f32((high - low) as u64) * SPEED_LSB
}

/// The gain of speed in a ramp with the duration `time`. The whole change is `dv`, with these three times.
#[inline(never)]
fn part(dv: i64, time: u64, [t1, t2, t3]: [u64; 3]) -> i64 {
    let (hi, lo) = mul_wide(dv.unsigned_abs(), time);
    let size = div_wide(hi, lo, (t1 + 2 * t2 + t3).max(1)) as i64;
    if dv < 0 { -size } else { size }
}

impl Change {
    /// Sets the change from `low` to `high` along a ramp that begins at `low`. Rounding raises no
    /// acceleration and no jerk.
    #[cfg_attr(feature = "fast", inline(always))]
    pub(super) fn speed_up(&mut self, ramp: &Ramp, low: i64, high: i64) {
        self.plan(ramp, [low, high], low, high, |times| times);
    }

    /// Sets the change from the speed `high` to the speed `low`, LSB 2^-58 mm/tick, with the times of `ramp`.
    #[cfg_attr(feature = "fast", inline(always))]
    pub(super) fn slow_down(&mut self, ramp: &Ramp, high: i64, low: i64) {
        self.plan(ramp, [low, high], high, low, |[near, hold, far]| [far, hold, near]);
    }

    /// `ordered`: reverses the times, which are in the order from `low` to `high`, if the change is a
    /// braking.
    #[cfg_attr(feature = "fast", inline(always))]
    fn plan(
        &mut self,
        ramp: &Ramp,
        [low, high]: [i64; 2],
        v0: i64,
        v1: i64,
        ordered: impl Fn([u64; 3]) -> [u64; 3],
    ) {
        let bits = |t: f32| if t == 0.0 { 0 } else { to_bits::<36>(t) as u64 + 1 };
        match ramp {
            _ if low == high => self.set(Form::default(), v0, v1, [0; 3]),
            Ramp::JerkLimited(ramp) => {
                let [near, hold, far] = ramp.times(gap_f32(low, high));
                let first = bits(near);
                let times = [first, bits(hold), if far == near { first } else { bits(far) }];
                self.set(Form::JerkLimited(ramp.shape()), v0, v1, ordered(times));
            }
            Ramp::Stepped(ramp) => {
                let [below, above] = ramp.parts(speed_f32(low), gap_f32(low, high));
                let middle = if above > 0.0 { (low + speed_bits(below)).min(high) } else { high };
                let time = |dv: i64, a: f32| bits(speed_f32(dv) / a);
                let times = [time(middle - low, ramp.a[0]), 0, time(high - middle, ramp.a[1])];
                self.speeds[1] = middle;
                self.set(Form::Stepped(ramp.built), v0, v1, ordered(times));
            }
        }
    }

    /// Sets the change from `v0` to `v1` with these times. With ramps, the speeds between the parts follow
    /// from equal peak accelerations: dv = ap (t1/2 + t2 + t3/2). With STEP, the speed in the middle stays.
    #[cfg_attr(feature = "fast", inline(always))]
    fn set(&mut self, form: Form, v0: i64, v1: i64, times: [u64; 3]) {
        self.form = form;
        let shape = match form {
            Form::JerkLimited(shape) => shape,
            Form::Stepped(_) => return self.set_stepped(v0, v1, times),
        };
        let dv = v1 - v0;
        if dv == 0 {
            (self.times, self.speeds, self.lengths) = ([0; 3], [v0; 4], [0; 3]);
            return;
        }
        let [t1, t2, t3] = times;
        let (first, last) = if t1 != t3 {
            (part(dv, t1, times), part(dv, t3, times))
        } else if t2 != 0 {
            let part = part(dv, t1, times);
            (part, part)
        } else {
            (dv >> 1, dv - (dv >> 1))
        };
        let [a, b] = [v0 + first, v1 - last];
        // Accurate to 2^-54 mm/tick.
        let mean = |x: i64| mul_near(x, shape.mean()) << 2;
        let mean_first = mean(first);
        // Both halves may differ by one bit; they have the same mean.
        let mean_last = if t1 == t3 { mean_first } else { mean(last) };
        // ∫v for linear ramps: a rising part contributes a third of the change, a constant part half, and a
        // falling part two thirds.
        let hold = if t2 == 0 { 0 } else { area(a + (b - a) / 2, t2) };
        self.times = times;
        self.speeds = [v0, a, b, v1];
        self.lengths = [area(v0 + mean_first, t1), hold, area(v1 - mean_last, t3)];
    }

    fn set_stepped(&mut self, v0: i64, v1: i64, [t1, _, t3]: [u64; 3]) {
        let middle = self.speeds[1];
        self.times = [t1, 0, t3];
        self.speeds = [v0, middle, middle, v1];
        self.lengths = [area(v0 + (middle - v0) / 2, t1), 0, area(middle + (v1 - middle) / 2, t3)];
    }

    /// Path length of all three parts, LSB 2^-44 mm.
    pub fn length(&self) -> i64 {
        self.lengths.iter().sum()
    }

    /// Time of all three parts, LSB 2^-36 tick.
    pub fn time(&self) -> u64 {
        self.times.iter().sum()
    }

    /// Shrinks the times of the change by `factor`·2^-62.
    #[inline(never)]
    fn shrink(&mut self, factor: u64) {
        let times =
            self.times.map(|t| if t == 0 { 0 } else { mul_shift(t as i64, factor as i64, 62) as u64 + 1 });
        self.set(self.form, self.speeds[0], self.speeds[3], times);
    }

    /// Shortens the longest part by `rounding` (LSB 2^-44 mm). Times and speeds stay.
    #[cold]
    #[inline(never)]
    fn give_way(&mut self, rounding: i64) {
        if let Some(longest) = self.lengths.iter_mut().max() {
            *longest = (*longest - rounding).max(0);
        }
    }

    /// Whether both accelerations of a STEP change are inside the limits `a`.
    fn is_stepped_inside(&self, a: [f32; 2]) -> bool {
        let [v0, middle, _, v1] = self.speeds;
        let parts = [(middle - v0, self.times[0]), (v1 - middle, self.times[2])];
        parts.into_iter().zip(a).all(|((dv, time), a)| {
            let dv = dv.unsigned_abs();
            // Converts 2^-36 to 2^-58.
            dv <= ROUNDING
                || size_f32(dv - ROUNDING) <= a * ACCEL_SLACK * (size_f32(time) * (1u64 << 22) as f32)
        })
    }

    /// Whether peak acceleration and mean jerks of a change with ramps are permitted. The check needs no
    /// division: dv ≤ a·whole/2 and dv ≤ j·t·whole/2, with whole = t1 + 2 t2 + t3. It uses `f32`: `dv` and
    /// `whole` are accurate to 2^-23 each, and the product adds 2^-23.
    fn is_inside(&self, a: f32, j_first: f32, j_last: f32) -> bool {
        let dv = (self.speeds[3] - self.speeds[0]).unsigned_abs();
        if dv <= ROUNDING {
            return true;
        }
        let dv = size_f32(dv - ROUNDING);
        let [t1, t2, t3] = self.times;
        // Converts 2^-36 to 2^-58.
        let half = size_f32(t1 + 2 * t2 + t3) * (1u64 << 21) as f32;
        let jerk = |j: f32, t: u64| t == 0 || dv <= j * (size_f32(t) * (JERK_SLACK / TICK as f32)) * half;
        let jerks = || {
            if t1 == t3 { jerk(min(j_first, j_last), t1) } else { jerk(j_first, t1) && jerk(j_last, t3) }
        };
        dv <= a * ACCEL_SLACK * half && jerks()
    }
}

/// Part of the margins of the limits that the plan may use: half of 2^-19 (speed, acceleration) and half of
/// 2^-13 (jerk). [`Change::is_inside`] adds six roundings of 2^-24.
const ACCEL_SLACK: f32 = 1.0 + 1.0 / 1_048_576.0;
const JERK_SLACK: f32 = 1.0 + 1.0 / 16_384.0;
/// For a change of speed below this value (2^-52 mm/tick), rounding to 2^-58 dominates.
const ROUNDING: u64 = 64;
/// The six lengths of a profile are rounded to 2^-44 mm each. Their sum exceeds the length of the block by at
/// most this number of LSB.
const ROUNDED_LENGTHS: i64 = 4;
/// All times of a profile may shrink by the factor 1 − 2^-22: the margins stay unused. In a short block,
/// rounding is a larger part of the length. There a length changes instead of the times.
const MARGIN: u32 = 22;

/// If needed, a peak is lowered by this power of two, relative to itself.
const LOWER: u32 = 18;

/// A peak above the higher end speed by less than this power of two, relative to that speed, is only
/// rounding. Two `f32` speeds and their difference cause this rounding. The ramps of such a peak may exceed
/// the rest of the block by more than the margin.
const NO_PEAK: u32 = 20;

impl Profile {
    /// Sets the fastest profile over `length` inside `limits`.
    ///
    /// # Errors
    /// [`Unplannable::Broken`]: the length does not suffice for the change between both end speeds. The
    /// look-ahead excludes this, so it is a defect. [`Unplannable::TooSlow`]: the block takes more than 2^27
    /// ticks.
    #[cfg_attr(feature = "fast", inline(always))]
    pub fn plan(
        &mut self,
        length: Distance,
        v_in: Speed,
        v_out: Speed,
        limits: &Limits,
    ) -> Result<(), Unplannable> {
        let [length, v_in, v_out] = [length.to_bits(), v_in.to_bits(), v_out.to_bits()];
        match self.plan_to(length, [v_in, v_out], limits, false) {
            // The peak comes from an `f32` search. If its ramps exceed the block by more than the margins,
            // the times would shrink too much.
            Err(Unplannable::Broken) => self.plan_to(length, [v_in, v_out], limits, true),
            planned => planned,
        }
    }

    /// As [`Self::plan`], with the highest peak, or with a lower one.
    #[inline(never)]
    fn plan_to(
        &mut self,
        length: i64,
        [v_in, v_out]: [i64; 2],
        limits: &Limits,
        lower: bool,
    ) -> Result<(), Unplannable> {
        let (mut room, mm) = (None, to_f32(length) * DISTANCE_LSB);
        let limits = limits.between([v_in, v_out].map(Speed::from_bits), mm, &mut room);
        let up = limits.speed_up();
        let down = limits.brake();
        let low = v_in.max(v_out);
        let mut peak = low + peak_above(&up, &down, [v_in, v_out, low], length, limits.v);
        if lower {
            let above = peak - low;
            peak -= if above < low >> NO_PEAK { above } else { above >> LOWER };
        }
        self.up.speed_up(&up, v_in, peak);
        self.down.slow_down(&down, peak, v_out);
        let slopes = self.up.length() + self.down.length();
        let rest = length - slopes;
        if rest >= 0 {
            // Converts 2^-44 / 2^-58 to 2^-36. The remainder is less than 2^-36 tick of travel. For a rest
            // below 2^-20 mm, it is less than 2^-20 of the rest.
            self.cruise = if rest < 1 << 24 && peak > 0 {
                to_bits::<36>(to_f32(rest) * 16_384.0 / to_f32(peak)) as u64
            } else {
                div_shift(rest as u64, 50, peak.max(1) as u64)
            };
        } else if rest >= -ROUNDED_LENGTHS && rest << MARGIN < -length {
            self.cruise = 0;
            let longer = if self.up.length() > self.down.length() { &mut self.up } else { &mut self.down };
            longer.give_way(-rest);
        } else {
            let factor = div_shift(length as u64, 62, slopes as u64);
            self.cruise = 0;
            self.up.shrink(factor);
            self.down.shrink(factor);
        }
        let changes = match limits.law {
            SlopeLaw::JerkLimited { j: [up_rise, up_fall, down_rise, down_fall], .. } => {
                self.up.is_inside(limits.a_up, up_rise, up_fall)
                    && self.down.is_inside(limits.a_down, down_rise, down_fall)
            }
            SlopeLaw::Stepped { a_up, a_down, .. } => {
                self.up.is_stepped_inside([limits.a_up, a_up])
                    && self.down.is_stepped_inside([a_down, limits.a_down])
            }
        };
        if !changes || peak > speed_bits(limits.v * ACCEL_SLACK) {
            return Err(Unplannable::Broken);
        }
        if self.cruise < LONGEST { Ok(()) } else { Err(Unplannable::TooSlow) }
    }

    /// Duration of the whole profile.
    pub fn time(&self) -> Time {
        Time::from_bits(self.up.time() + self.cruise + self.down.time())
    }

    /// Highest speed of the profile.
    pub fn peak(&self) -> Speed {
        Speed::from_bits(self.up.speeds[3])
    }
}

/// Finds the highest peak that the length and the speed limit permit. Returns its height above the higher end
/// speed, LSB 2^-58 mm/tick. `speeds`: the start speed, the end speed, and the higher one of both.
#[cfg_attr(feature = "fast", inline(always))]
pub fn peak_above(up: &Ramp, down: &Ramp, speeds: [i64; 3], length: i64, v_limit: f32) -> i64 {
    match (up, down) {
        (Ramp::JerkLimited(up), Ramp::JerkLimited(down)) => highest(up, down, speeds, length, v_limit),
        (Ramp::Stepped(up), Ramp::Stepped(down)) => highest(up, down, speeds, length, v_limit),
        // Both ramps of a block have the same slope.
        _ => 0,
    }
}

/// Highest peak of a profile; both ramps are of one slope.
///
/// The length of both ramps grows with the peak. Newton's method finds the root inside a bracket. If a step
/// leaves the bracket, the bracket is halved. The first guess is exact between two stops.
#[cfg_attr(feature = "fast", inline(always))]
fn highest<R: Guess>(up: &R, down: &R, [v_in, v_out, low]: [i64; 3], length: i64, v_limit: f32) -> i64 {
    let limit = speed_bits(v_limit) - low;
    if limit <= 0 {
        return 0;
    }
    let [from_in, from_out] = [v_in, v_out].map(speed_f32);
    let [above_in, above_out] = [v_in, v_out].map(|v| if v == low { 0.0 } else { gap_f32(v, low) });
    let target = to_f32(length) * (1.0 / (1u64 << 44) as f32);
    let [mut below, mut above] = [0.0, gap_f32(0, limit)];
    let mut limit_checked = false;
    let mut x = if v_in == v_out {
        let (x, exact) = R::level(up, down, from_in, target);
        if exact && x < above {
            return gained(x, limit, low);
        }
        x
    } else {
        let (near, far) = if v_in == low { (up, down) } else { (down, up) };
        let gap = max(above_in, above_out);
        let [length, slope] = far.distance(min(from_in, from_out), gap);
        if length >= target {
            return 0;
        }
        let sides = Sides { gap, slope, lengths: [target, target - length] };
        R::beside([up, down, near], max(from_in, from_out), &sides)
    };
    // The length by which both ramps exceed the block, and its derivative.
    let over = |x: f32| {
        let [s0, d0] = up.distance(from_in, above_in + x);
        let [s1, d1] = down.distance(from_out, above_out + x);
        [s0 + s1 - target, d0 + d1]
    };
    for _ in 0..PEAK_STEPS {
        if !(x > below && x < above) {
            if x >= above && !limit_checked {
                if over(above)[0] <= 0.0 {
                    return limit;
                }
                limit_checked = true;
                continue;
            }
            x = 0.5 * (below + above);
        }
        let [over, slope] = over(x);
        if over > 0.0 {
            (above, limit_checked) = (x, true);
        } else {
            below = x;
        }
        let step = over / slope;
        x -= step;
        if step * step <= x * x * CLOSE {
            break;
        }
    }
    gained(x, limit, low)
}

/// Slightly below the root, so that the part at constant speed has some length. Returns 0 for a negligible
/// peak.
fn gained(x: f32, limit: i64, low: i64) -> i64 {
    let gain = speed_bits(x * (1.0 - 1.0 / 4_194_304.0)).clamp(0, limit);
    if gain < low >> 22 { 0 } else { gain }
}

/// Square of 2^-12: the next Newton step would be about the square of the last one.
const CLOSE: f32 = 1.0 / (1u64 << 24) as f32;

/// A peak is far above the end speeds if its height above the higher speed is this multiple of their
/// difference.
const FAR: f32 = 8.0;

/// Largest number of steps of the search.
const PEAK_STEPS: usize = 25;

/// First guesses for the search of the peak.
trait Guess {
    /// Path length of the change by `dv` from `low` on, and its derivative by `dv`.
    fn distance(&self, low: f32, dv: f32) -> [f32; 2];

    /// The peak above `low` if both end speeds were `low`, and whether this value is exact.
    fn level(up: &Self, down: &Self, low: f32, length: f32) -> (f32, bool);

    /// The peak above `low`, the higher end speed. The ramps are: up, down, and the one of them that begins
    /// at `low`.
    fn beside(slopes: [&Self; 3], low: f32, sides: &Sides) -> f32;
}

/// Known values if both end speeds differ.
struct Sides {
    /// The difference of the speeds.
    gap: f32,
    /// Increase of the ramp's length from the lower speed, per speed.
    slope: f32,
    /// The whole length, and the rest of it for the motion above the higher speed.
    lengths: [f32; 2],
}

impl Guess for JerkLimited {
    #[cfg_attr(feature = "fast", inline(always))]
    fn distance(&self, low: f32, dv: f32) -> [f32; 2] {
        Self::distance(self, low, dv)
    }

    /// For ramps without a plateau. With k² = x/full of one ramp and (r·k)² of the other, both together take
    /// the length c1·k + c3·k³. The result is exact between two stops, and a good guess otherwise.
    #[cfg_attr(feature = "fast", inline(always))]
    fn level(up: &Self, down: &Self, low: f32, length: f32) -> (f32, bool) {
        let ratio = up.full / down.full;
        let ratio = if ratio == 1.0 { 1.0 } else { sqrt_f32(ratio) };
        let c1 = low * (up.time() + ratio * down.time());
        let c3 = up.cubic + ratio * ratio * ratio * down.cubic;
        let k = root_of_cubic(c1, 0.0, c3, length);
        let x = k * k * up.full;
        (x, x <= min(up.full, down.full))
    }

    /// For a ramp from `low` without a plateau, while the length of the other ramp grows linearly. With k² =
    /// x/full, both take c1·k + c2·k² + c3·k³ more.
    #[cfg_attr(feature = "fast", inline(always))]
    fn beside([up, down, near]: [&Self; 3], low: f32, sides: &Sides) -> f32 {
        let Sides { gap, slope, lengths: [length, left] } = *sides;
        // If the peak is far above both speeds, their difference hardly changes the result.
        let (x, _) = Self::level(up, down, low, length);
        if x > FAR * gap {
            return x;
        }
        let k = root_of_cubic(low * near.time(), slope * near.full, near.cubic, left);
        k * k * near.full
    }
}

impl Guess for Stepped {
    fn distance(&self, low: f32, dv: f32) -> [f32; 2] {
        Self::distance(self, low, dv)
    }

    fn level(up: &Self, down: &Self, low: f32, length: f32) -> (f32, bool) {
        (Self::peak(up, down, low, length), false)
    }

    fn beside([up, down, _]: [&Self; 3], low: f32, sides: &Sides) -> f32 {
        Self::peak(up, down, low, sides.lengths[1])
    }
}

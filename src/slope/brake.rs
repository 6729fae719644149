//! Plans a braking that replaces the rest of a span's profile, for example after a feed hold. The motion may
//! have any speed and acceleration when the braking begins. The braking ends with zero acceleration at a
//! given lower speed, or at the lowest speed that has room before the end of the span.
//!
//! **From a positive acceleration.** The acceleration first falls to zero, then the deceleration begins. STEP
//! has no jerk limit: its deceleration begins at once.
//!
//! **From a deceleration.** The motion is already on a ramp of deceleration or past it. With the deceleration
//! a and the jerk j, the new braking is planned as if its ramp had begun the time a/j ago. The start of this
//! ramp is computed in integers from the state of the motion, so speed and acceleration do not jump.
//!
//! **SIN2.** All ramps of a braking are linear, also with SIN2, because an existing acceleration does not fit
//! into the middle of a sine ramp. The limits assume the peak jerk of SIN2; a linear ramp with the mean jerk
//! stays below. A positive acceleration falls to zero with the peak jerk. A sine ramp falls no faster at any
//! point, so the linear ramp ends at no higher speed.
//!
//! **Limits of the blocks.** The new profile is nowhere faster than the old one, so the limits of every block
//! hold. Both profiles end with zero acceleration, and the old profile does not brake harder. One exception
//! has no effect: a linear ramp may brake later than a sine ramp. With SIN2, all blocks of such a span have
//! the same limit.
use super::area;
use super::profile::{Change, Form, Profile};
use super::ramp::{JerkLimited, Ramp};
use super::ramp_shape::RampShape;
use crate::math::divide::{div_shift, div_wide};
use crate::math::float::{max, min, size_f32, to_bits, to_f32};
use crate::math::root::sqrt_f32;
use crate::math::wide::{mul_near, mul_shift, mul_wide};
use crate::quantity::{speed_bits, speed_f32};
use crate::slope::limits::{Limits, SlopeLaw};

/// A motion at one instant. LSB: 2^-44 mm for the path distance, 2^-58 mm per tick for the speed, 2^-58 mm
/// per tick² for the acceleration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// Path distance, LSB 2^-44 mm.
    pub distance: i64,
    /// Speed along the path, LSB 2^-58 mm per tick.
    pub speed: i64,
    /// Acceleration along the path, LSB 2^-58 mm per tick².
    pub accel: i64,
}

impl Motion {
    /// Whether the motion stands still.
    pub const fn is_rest(&self) -> bool {
        self.speed == 0 && self.accel == 0
    }
}

/// A braking: where it starts and ends. The functions that make a braking also fill a [`Profile`] with its
/// changes of speed. After these changes, the motion keeps the last speed for `tail`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Brake {
    /// Path distance at which the braking starts, at or before the current instant.
    pub from: i64,
    /// Time from the start of the braking to the current instant, LSB 2^-36 tick.
    pub over: u64,
    /// Time at the last speed, after the changes of speed, LSB 2^-36 tick.
    pub tail: u64,
    /// Path distance at which the braking ends, LSB 2^-44 mm.
    pub end: i64,
    /// Speed at the end of the braking, LSB 2^-58 mm per tick; 0 for a stop.
    pub v_out: i64,
}

/// The target speed of a braking.
#[derive(Clone, Copy)]
struct Aim {
    v: i64,
    /// Whether the nearest higher speed is taken if there is no room to reach `v`.
    or_near: bool,
}

/// Below this length (LSB 2^-44 mm), one LSB of length matters for the jerk of the fastest profile.
pub const SHORT: i64 = 1 << 20;

/// Accelerations up to 2^-50 mm/tick² are rounding.
const NO_ACCEL: i64 = 1 << 8;

/// Largest number of steps in the search for an end speed, and the relative accuracy of the result.
const STEPS: usize = 48;
const CLOSE: f32 = 1.0 / (1u64 << 20) as f32;
const CLOSE_BELOW: f32 = 1.0 - CLOSE;
/// Margin for the rounding of a jerk that just takes the whole speed.
const OVER: f32 = 1.0 + 16.0 * CLOSE;

/// Largest number of steps that shorten a ramp whose length is rounded up.
const SHRINKS: usize = 8;

impl Brake {
    /// Brakes from `motion` to the speed `target`, or to the lowest speed that is possible before `end`, the
    /// path distance of the span's end. If the motion is already slower, only its acceleration ends.
    /// `profile` receives the changes of speed. `a_down` is the deceleration; `limits` are those of the rest
    /// of the span. `v_out` is the planned speed at the end of the span.
    ///
    /// Returns `None` in three cases:
    ///
    /// - the end speed would not be below `v_out`;
    /// - the rest of the span is too short for the end speed;
    /// - the time at the end speed would exceed sixteen times the braking time.
    pub fn plan(
        profile: &mut Profile,
        motion: &Motion,
        end: i64,
        v_out: i64,
        (limits, a_down): (&Limits, f32),
        target: i64,
    ) -> Option<Self> {
        let room = end.wrapping_sub(motion.distance);
        if motion.speed <= 0 || room <= 0 {
            return None;
        }
        let firm = Limits { a_down, ..*limits };
        let brake = Self::reach(profile, motion, room, &firm, Aim { v: target, or_near: true })?;
        if brake.v_out == 0 {
            return Some(brake);
        }
        let left = end.wrapping_sub(brake.end);
        if left == 0 {
            return (brake.v_out < v_out).then_some(brake);
        }
        if brake.v_out <= v_out {
            if left < SHORT {
                return Some(Self { tail: time_at(left, brake.v_out), end, ..brake });
            }
            return Some(brake);
        }
        let [low, dv] = [v_out, brake.v_out - v_out].map(speed_f32);
        if limits.brake().distance(low, dv)[0] <= mm(left) * (1.0 - CLOSE) && left >= SHORT {
            return Some(brake);
        }
        if v_out == 0 {
            return None;
        }
        let brake = Self::reach(profile, motion, room, &firm, Aim { v: v_out, or_near: true })?;
        let left = end.wrapping_sub(brake.end);
        if left == 0 {
            return (brake.v_out < v_out).then_some(brake);
        }
        // Near standstill, the rest would take very long. The existing profile is then faster.
        let tail = time_at(left, brake.v_out);
        let down = profile.down.times.iter().fold(0, |sum: u64, time| sum.saturating_add(*time));
        (brake.v_out <= v_out && tail >> 4 <= down).then_some(Self { tail, end, ..brake })
    }

    /// Brakes from `motion` to the speed `to` before `end`, if this is possible. The cost is a few
    /// evaluations, without a search.
    pub fn down_to(
        profile: &mut Profile,
        motion: &Motion,
        end: i64,
        (limits, a_down): (&Limits, f32),
        to: i64,
    ) -> Option<Self> {
        let room = end.wrapping_sub(motion.distance);
        if motion.speed <= 0 || room <= 0 {
            return None;
        }
        let firm = Limits { a_down, ..*limits };
        Self::reach(profile, motion, room, &firm, Aim { v: to, or_near: false })
    }

    /// Whether a stop from `motion` takes at most `part` of the path up to `end`. The function calculates in
    /// `f32`, so the result is approximate and cheap.
    pub fn fits(motion: &Motion, end: i64, limits: &Limits, part: f32) -> bool {
        let room = mm(end.wrapping_sub(motion.distance)) * part;
        let v = speed_f32(motion.speed);
        if motion.speed <= 0 || room <= 0.0 {
            return false;
        }
        let rises = matches!(limits.law, SlopeLaw::JerkLimited { .. }) && motion.accel >= -NO_ACCEL;
        !(rises && v * v > 2.0 * limits.a_down * room) && Self::needs(motion, limits) <= room
    }

    /// Path length that a stop from `motion` needs, mm. The function calculates in `f32`, so the result is
    /// approximate and cheap.
    pub fn needs(motion: &Motion, limits: &Limits) -> f32 {
        let v = speed_f32(motion.speed);
        let a = to_f32(motion.accel) * (1.0 / ACCEL_ONE);
        let SlopeLaw::JerkLimited { shape, j: [_, up_fall, down_rise, _], .. } = limits.law else {
            return limits.brake().distance(0.0, v)[0];
        };
        let ramp = limits.brake().linear();
        if motion.accel > NO_ACCEL {
            let time = a / (up_fall * shape.peak_jerk());
            let first = time * (v + a * time * (1.0 / 3.0));
            first + ramp.distance(0.0, v + 0.5 * a * time)[0]
        } else if motion.accel < -NO_ACCEL {
            let over = -a / down_rise;
            let begun = v - 0.5 * a * over;
            let before = over * (begun + a * over * (1.0 / 6.0));
            ramp.distance(0.0, begun)[0] - before
        } else {
            ramp.distance(0.0, v)[0]
        }
    }

    /// Whether the braking loses less than half of the speed of `motion`, and ends before `end`, so that
    /// another profile can follow.
    pub const fn ends_at_once(&self, motion: &Motion, end: i64) -> bool {
        self.v_out > motion.speed / 2 && end.wrapping_sub(self.end) >= SHORT
    }

    /// Path length from [`Self::from`] to the point after which the speed is below `v`, mm. `profile` holds
    /// the changes of speed.
    #[inline(never)]
    pub fn passes(&self, profile: &Profile, v: f32) -> f32 {
        let down = &profile.down;
        let [v0, va, vb, v1] = down.speeds.map(speed_f32);
        let [t1, t2, t3] = down.times.map(|t| size_f32(t) * (1.0 / (1u64 << 36) as f32));
        let [s1, s2, s3] = down.lengths.map(mm);
        let top = if profile.up.length() > 0 { speed_f32(profile.up.speeds[3]) } else { v0 };
        if v >= max(top, v0) {
            return 0.0;
        }
        let before = mm(profile.up.length()) + size_f32(profile.cruise) * (1.0 / (1u64 << 36) as f32) * v0;
        let stepped = matches!(down.form, Form::Stepped(_));
        // A part with constant acceleration between two speeds.
        let even = |from: f32, to: f32, time: f32| {
            time * ((from - v) / max(from - to, f32::MIN_POSITIVE)) * (0.5 * (from + v))
        };
        if v < v1 {
            f32::MAX
        } else if v >= va {
            if stepped {
                return before + even(v0, va, t1);
            }
            let u = sqrt_f32((v0 - v) / max(v0 - va, f32::MIN_POSITIVE));
            before + t1 * u * (v0 - (v0 - va) * u * u * (1.0 / 3.0))
        } else if v >= vb {
            before + s1 + even(va, vb, t2)
        } else {
            if stepped {
                return before + s1 + s2 + even(vb, v1, t3);
            }
            let w = sqrt_f32((v - v1) / max(vb - v1, f32::MIN_POSITIVE));
            before + s1 + s2 + s3 - t3 * w * (v1 + (vb - v1) * w * w * (1.0 / 3.0))
        }
    }

    /// For a curve whose limits trade speed for acceleration: the speed below which the braking keeps v +
    /// a²/2j ≤ `most`, mm/tick. `f32::MAX` if the whole braking does. `profile` holds the changes of speed,
    /// and `a_most` is √(2·j·`most`). The jerks of the profile are at most j. While the deceleration rises,
    /// the sum v + a²/2j does not grow, so it is at most the speed at the start. Later the sum falls.
    pub fn trade(&self, profile: &Profile, most: f32, a_most: f32) -> f32 {
        let j = a_most * a_most / (2.0 * max(most, f32::MIN_POSITIVE));
        let down = &profile.down;
        let [v0, va, vb, v1] = down.speeds.map(speed_f32);
        let [t1, _, t3] = down.times.map(|t| size_f32(t) * (1.0 / (1u64 << 36) as f32));
        let most = most * CLOSE_BELOW;
        if v0 <= most || j <= 0.0 {
            return f32::MAX;
        }
        // Linear ramps: dv = a·t/2.
        let decel = 2.0 * max((v0 - va) / max(t1, f32::MIN_POSITIVE), (vb - v1) / max(t3, f32::MIN_POSITIVE));
        let held = most - decel * decel / (2.0 * j);
        if held >= vb {
            return held;
        }
        // While the deceleration falls, a² = 2·(v − v1)·(a/t3).
        let part = decel / (max(t3, f32::MIN_POSITIVE) * j);
        min((most + v1 * part) / (1.0 + part), vb)
    }

    fn reach(profile: &mut Profile, motion: &Motion, room: i64, limits: &Limits, aim: Aim) -> Option<Self> {
        profile.clear();
        match limits.law {
            SlopeLaw::Stepped { .. } => Self::begin(profile, motion, room, &limits.brake(), aim),
            SlopeLaw::JerkLimited { shape, j: [_, up_fall, down_rise, down_fall], .. } => {
                let peak = shape.peak_jerk();
                let mut ramp = Linear { up_fall: up_fall * peak, a: limits.a_down, down_rise, down_fall };
                if motion.accel < -NO_ACCEL {
                    // Near the end of a sine ramp, the jerk is below its mean, so the speed loss would be
                    // larger.
                    let decel = to_f32(motion.accel) * (1.0 / ACCEL_ONE);
                    let ends = decel * decel * OVER / (2.0 * speed_f32(motion.speed));
                    ramp.down_fall = max(down_fall, min(ends, down_fall * peak));
                    ramp.go_on(profile, motion, room, aim)
                } else {
                    ramp.turn(profile, motion, room, aim)
                }
            }
        }
    }

    /// Plans from zero acceleration, or from an acceleration that may end at once. `profile.up` holds an
    /// acceleration that has to fall first.
    fn begin(profile: &mut Profile, motion: &Motion, room: i64, ramp: &Ramp, aim: Aim) -> Option<Self> {
        let distance = motion.distance;
        let length = profile.up.length();
        let v = if length > 0 { profile.up.speeds[3] } else { motion.speed };
        let rest = room - length;
        if rest < 0 {
            return None;
        }
        let most = v - aim.v;
        if most <= 0 {
            return Some(Self {
                from: distance,
                end: distance.wrapping_add(length),
                v_out: v,
                ..Self::default()
            });
        }
        let dv = lost(ramp, [0, most], v, rest, aim)?;
        profile.down.slow_down(ramp, v, v - dv);
        let down = profile.down.length();
        if dv == most {
            let end = distance.wrapping_add(length + down);
            return (down <= rest).then_some(Self { from: distance, end, v_out: aim.v, ..Self::default() });
        }
        profile.cruise = time_at(rest.checked_sub(down).filter(|left| *left >= 0)?, v);
        Some(Self { from: distance, over: 0, tail: 0, end: distance.wrapping_add(room), v_out: v - dv })
    }
}

/// Linear ramps: the jerk that ends an acceleration, the deceleration, and the jerks that begin and end the
/// deceleration.
struct Linear {
    up_fall: f32,
    a: f32,
    down_rise: f32,
    down_fall: f32,
}

impl Linear {
    fn ramp(&self) -> JerkLimited {
        JerkLimited::new(RampShape::Linear, self.a, self.down_fall, self.down_rise)
    }

    /// Plans from an acceleration of zero or above. Neither this function nor the next one is inlined, so
    /// that only one of both stack frames exists at a time.
    #[inline(never)]
    fn turn(&self, profile: &mut Profile, motion: &Motion, room: i64, aim: Aim) -> Option<Brake> {
        if motion.accel > NO_ACCEL {
            let time = ticks(to_f32(motion.accel) / (self.up_fall * ACCEL_ONE));
            profile.up = Change::fall(motion.speed, motion.accel, time);
        }
        Brake::begin(profile, motion, room, &Ramp::JerkLimited(self.ramp()), aim)
    }

    /// Plans from a deceleration.
    #[inline(never)]
    fn go_on(&self, profile: &mut Profile, motion: &Motion, room: i64, aim: Aim) -> Option<Brake> {
        let decel = motion.accel.unsigned_abs();
        let jerk_limited = self.ramp();
        let ramp = Ramp::JerkLimited(jerk_limited);
        let over = ticks(size_f32(decel) / (self.down_rise * ACCEL_ONE));
        // From its start, the ramp would have lost the speed a·t/2.
        let begun = Change::rise(motion.speed, decel, over);
        let v = begun.speeds[0];
        let before = begun.length();
        let room = room.saturating_add(before);
        // The speed loss is at least the one of the current deceleration.
        let least = (v - motion.speed).saturating_add(released(decel, self.down_fall));
        if least > v {
            return None;
        }
        let most = (v - aim.v).max(least);
        let dv = lost(&ramp, [least, most], v, room, aim)?;
        profile.down = Change::extended(v, v - dv, decel, over, &jerk_limited, self.down_fall)?;
        let length = profile.down.length();
        let left = room - length;
        if left < 0 {
            return None;
        }
        let from = motion.distance.wrapping_sub(before);
        if dv == most {
            return Some(Brake { from, over, tail: 0, end: from.wrapping_add(length), v_out: v - dv });
        }
        let tail = time_at(left, v - dv);
        Some(Brake { from, over, tail, end: from.wrapping_add(room), v_out: v - dv })
    }
}

/// The form of all changes of speed in this file.
const LINEAR: Form = Form::JerkLimited(RampShape::Linear);

/// 2^58, as a factor.
const ACCEL_ONE: f32 = (1u64 << 58) as f32;

/// A length (2^-44 mm) in mm.
fn mm(length: i64) -> f32 {
    to_f32(length) * (1.0 / (1u64 << 44) as f32)
}

/// Ticks as time, rounded up.
fn ticks(t: f32) -> u64 {
    to_bits::<36>(t) as u64 + 1
}

/// Time over a length (2^-44 mm) at a speed (2^-58 mm/tick), rounded down.
fn time_at(length: i64, v: i64) -> u64 {
    div_shift(length.max(0) as u64, 50, v.max(1) as u64)
}

/// Speed lost while a deceleration falls to zero: a²/2j, rounded up.
fn released(decel: u64, j: f32) -> i64 {
    let a = size_f32(decel) / ACCEL_ONE;
    let v = 0.5 * a * a / j;
    speed_bits(v + v * CLOSE)
}

/// The loss of the speed `v` within `room`: `most` if possible, otherwise the largest loss between `least`
/// and `most` that has room. The solution is unique: the distance grows with the loss up to two thirds of
/// `v`. For larger losses, it stays above the distance of `most`.
fn lost(ramp: &Ramp, [least, most]: [i64; 2], v: i64, room: i64, aim: Aim) -> Option<i64> {
    let target = mm(room) * (1.0 - CLOSE);
    let [mut low, mut high] = [least, most].map(speed_f32);
    let fits = |dv: f32| {
        let slow = speed_f32(v - speed_bits(dv).min(v));
        dv <= 0.0 || ramp.distance(slow, dv)[0] <= target
    };
    if least > most {
        return None;
    }
    if fits(high) {
        return Some(most);
    }
    if !aim.or_near || !fits(low) {
        return None;
    }
    for _ in 0..STEPS {
        let middle = 0.5 * (low + high);
        if fits(middle) {
            low = middle;
        } else {
            high = middle;
        }
        if high - low <= high * CLOSE {
            break;
        }
    }
    Some(speed_bits(low).max(least).min(most - 1))
}

impl Change {
    /// A change in which the current acceleration falls to zero.
    fn fall(v: i64, accel: i64, time: u64) -> Self {
        // Converts 2^-58 · 2^-36 to 2^-58, and halves the result.
        let gained = mul_shift(accel, time as i64, 37);
        let top = v + gained;
        Self {
            form: LINEAR,
            times: [0, 0, time],
            speeds: [v, v, v, top],
            lengths: [0, 0, area(top - third(gained), time)],
        }
    }

    /// A change in which a deceleration grows to `decel` within `time`, and ends at the speed `v`.
    fn rise(v: i64, decel: u64, time: u64) -> Self {
        let lost = mul_shift(decel as i64, time as i64, 37);
        let top = v + lost;
        Self {
            form: LINEAR,
            times: [time, 0, 0],
            speeds: [top, v, v, v],
            lengths: [area(top - third(lost), time), 0, 0],
        }
    }

    /// A braking from `v0` to `v1` with the deceleration `decel` after the time `over`; the deceleration
    /// still grows then.
    fn extended(v0: i64, v1: i64, decel: u64, over: u64, ramp: &JerkLimited, j_last: f32) -> Option<Self> {
        let [_, _, first] = ramp.times(speed_f32(v0 - v1));
        let mut first = ticks(first);
        for _ in 0..SHRINKS {
            first = first.max(over);
            let (hi, lo) = mul_wide(decel, first);
            let peak = div_wide(hi, lo, over.max(1));
            let last = ticks(size_f32(peak) / (j_last * ACCEL_ONE));
            let [lost_first, lost_last] = [first, last].map(|t| mul_shift(peak as i64, t as i64, 37));
            let rest = v0 - v1 - lost_first - lost_last;
            if rest >= 0 {
                let hold = div_shift(rest as u64, 36, peak);
                let (a, b) = (v0 - lost_first, v1 + lost_last);
                return (hold < 1 << 63).then_some(Self {
                    form: LINEAR,
                    times: [first, hold, last],
                    speeds: [v0, a, b, v1],
                    lengths: [
                        area(v0 - third(lost_first), first),
                        area(b + (a - b) / 2, hold),
                        area(v1 + third(lost_last), last),
                    ],
                });
            }
            if first == over {
                return None;
            }
            first -= (first >> 21).max(1);
        }
        None
    }
}

/// A third of `x`, accurate to 2^-54 mm/tick.
fn third(x: i64) -> i64 {
    mul_near(x, 0x1555_5555_5555_5555) << 2
}

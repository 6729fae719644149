//! Cuts the profile of a span into pieces for the interrupt. A piece gives the path distance as a cubic
//! polynomial of time. A piece starts at a tick and lasts a whole number of ticks.
//!
//! The seven parts of a [`Profile`] (ramps, constant acceleration, constant speed) begin and end between two
//! ticks. A piece begins at the first tick inside a part, with the state of the motion at this tick. A part
//! that contains no tick has no piece. So at most one piece begins at a tick, and the interrupt only counts
//! whole ticks.
//!
//! | part of a profile | longest piece, ticks |
//! |---|---|
//! | ramp (constant jerk) | 128 |
//! | ramp of SIN2 | 64 |
//! | constant acceleration | 512 |
//! | constant speed | 65,535 |
//!
//! The coefficients have an LSB of 2^-58 mm. With these lengths, the cubic differs from the exact curve by at
//! most 2^-37 mm. This is a sixteenth of the rounding of a set point.
use super::area;
use super::brake::Brake;
use super::profile::{Change, Form, Profile};
use super::ramp_shape::{RampShape, sine_node, sine_piece, sine_square};
use crate::machine::functions;
use crate::math::divide::reciprocal_near;
use crate::math::wide::{mul_hi, mul_near, mul_shift, mul_u32, mul_wide};
use crate::quantity::{Accel, Distance, Jerk, Speed, Time};
use crate::queue::{PHASES, Phase, Producer, Slot};
use core::slice::IterMut;

/// One tick in the time unit of profiles (LSB 2^-36 tick).
pub const TICK: u64 = 1 << 36;

/// Longest pieces, ticks: with jerk, with acceleration, at constant speed. The last value also applies to a
/// jerk that is a product of other values.
const LONGEST: [u32; 3] = [128, 512, 65_535];
const LONGEST_SINE: u32 = 64;

/// The change of speed within a part.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    /// Acceleration rises from zero: v = v0 + Δ u².
    Rise,
    /// Acceleration is constant: v = v0 + Δ u.
    Hold,
    /// Acceleration falls to zero: v = v1 − Δ (1 − u)².
    Fall,
    /// Acceleration rises from zero as in [`RampShape::SineSquare`]: v = v0 + Δ speed(u). Below, it falls to
    /// zero: v = v1 − Δ speed(1 − u).
    SineRise,
    SineFall,
}

/// One part of a profile. `u` is the time as a fraction of the part. Packed, because a profile has seven
/// parts, and three profiles are stored.
#[derive(Clone, Copy, Debug)]
#[repr(C, packed(4))]
struct Part {
    kind: Kind,
    time: u64,
    /// Path distances of the part's start and end, LSB 2^-44 mm, counted along the whole path.
    from: i64,
    to: i64,
    v0: i64,
    v1: i64,
}

/// Cuts the profiles of spans into pieces for the queue, one span after the other.
#[derive(Clone, Copy, Debug)]
pub struct Emitter {
    parts: [Part; PARTS],
    /// Number of the current part, and number of parts with a duration.
    part: usize,
    count: usize,
    /// Time from the start of the current part to the next tick.
    next: u64,
    /// Quotients by the part's time; the next part often has the same time.
    per_time: PerTime,
}

const PARTS: usize = 7;

const IDLE: Part = Part { kind: Kind::Hold, time: 0, from: 0, to: 0, v0: 0, v1: 0 };

/// 1/3, LSB 2^-62.
const THIRD: i64 = 0x1555_5555_5555_5555;

impl Default for Emitter {
    fn default() -> Self {
        Self::new()
    }
}

impl Emitter {
    /// An emitter without a profile. The next profile starts at a tick.
    pub const fn new() -> Self {
        Self { parts: [IDLE; PARTS], part: 0, count: 0, next: 0, per_time: PerTime::NONE }
    }

    /// Takes the profile of the next span, which starts at the path distance `start`. Call this function only
    /// when no piece is left: [`Self::has_piece`].
    pub fn begin(&mut self, profile: &Profile, start: Distance, length: Distance) {
        let end = start.to_bits().wrapping_add(length.to_bits());
        let mut slots = Slots(self.parts.iter_mut());
        let at = slots.lay_out(&profile.up, start.to_bits());
        // The braking is computed backward from the end, so the span ends exactly. The part at constant speed
        // lies between.
        let back = end.wrapping_sub(profile.down.length());
        let v = profile.peak().to_bits();
        slots.add(Part { kind: Kind::Hold, time: profile.cruise, from: at, to: back, v0: v, v1: v });
        slots.lay_out(&profile.down, back);
        (self.part, self.count) = (0, slots.used());
    }

    /// Takes a braking, whose parts are in `profile`. The next tick is at `brake.over` plus the time from the
    /// current instant to the next tick.
    pub fn begin_brake(&mut self, profile: &Profile, brake: &Brake) {
        self.next += brake.over;
        let mut slots = Slots(self.parts.iter_mut());
        let at = slots.lay_out(&profile.up, brake.from);
        let back = brake.end.wrapping_sub(profile.down.length());
        let back = if profile.cruise > 0 { back } else { at };
        let v = profile.down.speeds[0];
        slots.add(Part { kind: Kind::Hold, time: profile.cruise, from: at, to: back, v0: v, v1: v });
        let at = slots.lay_out(&profile.down, back);
        let v = brake.v_out;
        slots.add(Part { kind: Kind::Hold, time: brake.tail, from: at, to: brake.end, v0: v, v1: v });
        (self.part, self.count) = (0, slots.used());
    }

    /// Drops the rest of the current profile. The start of the next profile is then `time` (LSB 2^-36 tick)
    /// before a tick.
    pub fn resume_at(&mut self, time: u64) {
        (self.part, self.count) = (0, 0);
        self.next = time;
    }

    /// Time from the start of the next profile to the next tick, LSB 2^-36 tick.
    pub fn next(&self) -> u64 {
        self.next
    }

    /// Whether the emitter has written all pieces of its profile.
    #[cfg_attr(feature = "fast", inline(always))]
    pub fn is_done(&self) -> bool {
        self.part >= self.count
    }

    /// Steps to the part that contains the next tick. Returns `false` when no piece is left.
    #[cfg_attr(feature = "fast", inline(always))]
    pub fn has_piece(&mut self) -> bool {
        self.at_hand().is_some()
    }

    /// The current part, with the other data for a piece.
    #[cfg_attr(feature = "fast", inline(always))]
    fn at_hand(&mut self) -> Option<(&Part, &mut PerTime, &mut u64)> {
        let Self { parts, part: number, count, next, per_time, .. } = self;
        for part in parts.get(*number..*count)? {
            if *next < part.time {
                return Some((part, per_time, next));
            }
            *next -= part.time;
            *number += 1;
        }
        None
    }

    /// Puts up to `count` pieces into the queue, and adds their ticks to `ticks`. The queue must have room
    /// for the pieces. Returns `false` when no piece is left.
    #[inline(never)]
    pub fn hand_out(&mut self, queue: &mut Producer<'_, Phase, PHASES>, count: u32, ticks: &mut u32) -> bool {
        let mut left = count;
        let Self { parts, part: number, count, next, per_time, .. } = self;
        for part in parts.get(*number..*count).unwrap_or_default() {
            while *next < part.time {
                if left == 0 {
                    return true;
                }
                left -= 1;
                queue.push_with(|phase| {
                    part.cut(per_time, next, phase);
                    *ticks += u32::from(phase.ticks);
                });
            }
            *next -= part.time;
            *number += 1;
        }
        false
    }

    /// Writes the next piece into `phase`. Call this function only if [`Self::has_piece`] is true. The work
    /// is bounded.
    pub fn step(&mut self, phase: &mut Phase) {
        if let Some((part, per_time, next)) = self.at_hand() {
            part.cut(per_time, next, phase);
        }
    }

    /// Skips the remaining pieces, as if they were in the queue. Returns the sum of their ticks.
    #[cfg(feature = "plc")]
    pub fn skip(&mut self) -> u32 {
        let time: u64 = self.parts.iter().take(self.count).skip(self.part).map(|part| part.time).sum();
        let ticks = self.ticks();
        self.next = self.next.wrapping_add(u64::from(ticks) << 36).wrapping_sub(time);
        self.part = self.count;
        ticks
    }

    /// Lets the next motion start exactly at the next tick. Call this function only while the axes stand
    /// still.
    pub fn settle(&mut self) {
        self.next = 0;
    }

    /// Sum of the ticks of all pieces that are not written yet.
    pub fn ticks(&self) -> u32 {
        let time: u64 = self.parts.iter().take(self.count).skip(self.part).map(|part| part.time).sum();
        (time.saturating_sub(self.next).saturating_add(TICK - 1) >> 36) as u32
    }

    /// Time from the end of the current profile to the next tick; less than one tick.
    pub fn wait(&self) -> Time {
        let time: u64 = self.parts.iter().take(self.count).map(|part| part.time).sum();
        Time::from_bits(self.next.wrapping_sub(time) & (TICK - 1))
    }
}

/// Collects the parts that have a duration, one after the other.
struct Slots<'a>(IterMut<'a, Part>);

impl Slots<'_> {
    /// Writes the three parts of a change of speed, from the path distance `from` on. Returns the path
    /// distance of their end.
    #[cfg_attr(feature = "fast", inline(always))]
    fn lay_out(&mut self, change: &Change, from: i64) -> i64 {
        let mut at = from;
        let kinds = match change.form {
            Form::JerkLimited(shape) => match shape.built() {
                RampShape::Linear => [Kind::Rise, Kind::Hold, Kind::Fall],
                RampShape::SineSquare => [Kind::SineRise, Kind::Hold, Kind::SineFall],
            },
            Form::Stepped(_) => [Kind::Hold; 3],
        };
        for (k, kind) in kinds.into_iter().enumerate() {
            // There are three parts. Builds that are optimised for size need `min` so that the compiler knows
            // this.
            let k = k.min(2);
            let to = at.wrapping_add(change.lengths[k]);
            let (v0, v1) = (change.speeds[k], change.speeds[k + 1]);
            self.add(Part { kind, time: change.times[k], from: at, to, v0, v1 });
            at = to;
        }
        at
    }

    #[cfg_attr(feature = "fast", inline(always))]
    fn add(&mut self, part: Part) {
        if part.time > 0
            && let Some(slot) = self.0.next()
        {
            *slot = part;
        }
    }

    fn used(&self) -> usize {
        PARTS - self.0.len()
    }
}

impl Part {
    /// Writes the piece that begins at the time `next`, and sets `next` to the end of the piece.
    #[cfg_attr(feature = "fast", inline(always))]
    fn cut(&self, per_time: &mut PerTime, next: &mut u64, phase: &mut Phase) {
        let delta = self.v1 - self.v0;
        if delta != 0 && (per_time.time, per_time.delta) != (self.time, delta) {
            per_time.divide(self.time, delta);
        }
        let t = *next;
        let mut end = self.time;
        let mut longest = match self.kind {
            Kind::Hold if delta == 0 => LONGEST[2],
            Kind::Hold => LONGEST[1],
            _ => LONGEST[0],
        };
        if delta == 0 {
            *phase = self.cruise(t);
        } else if functions::SLOPES.is_built() && matches!(self.kind, Kind::SineRise | Kind::SineFall) {
            longest = LONGEST_SINE;
            (*phase, end) = self.sine_piece(per_time, t);
            // The end is after the current tick, for any rounding.
            end = end.max(t + 1);
        } else if t < TICK {
            self.first_piece(per_time, (t >> 4) as u32, t as u32 & 15, phase);
        } else {
            *phase = self.piece(per_time, t);
        }
        // The part continues at `t` for at least one tick.
        let ticks = ((end - t + (TICK - 1)) >> 36) as u32;
        let ticks = ticks.min(longest);
        phase.ticks = ticks as u16;
        // Rounding must not lead beyond the end of the part; otherwise the next piece would go backward.
        let beyond = phase.at(ticks as u16 - 1).wrapping_sub(self.to);
        if beyond > 0 {
            phase.distance = Distance::from_bits(phase.distance.to_bits().wrapping_sub(beyond));
        }
        *next = t + (u64::from(ticks) << 36);
    }

    /// The state at time `t` in a part at constant speed. The caller sets the length of the piece.
    #[cfg_attr(feature = "fast", inline(always))]
    fn cruise(&self, t: u64) -> Phase {
        Phase {
            distance: Distance::from_bits(self.from.wrapping_add(area(self.v0, t))),
            speed: Speed::from_bits(self.v0),
            ..Phase::BLANK
        }
    }

    /// The coefficients, in ticks, of the piece that begins at the time `t` in a part with a linear ramp.
    #[inline(never)]
    fn piece(&self, per_time: &PerTime, t: u64) -> Phase {
        let delta = self.v1 - self.v0;
        let fraction = |t: u64| (mul_wide(t << per_time.zeros, per_time.reciprocal).0) as i64;
        // Accurate to 2^-54. The factor of the jerk is n³, so its product is exact.
        let by = |x: i64, u: i64| mul_near(x, u) << 2;
        let slope = per_time.slope;
        let (s, v, half_accel, sixth_jerk) = match self.kind {
            Kind::Rise => {
                let u = fraction(t);
                let gained = by(by(delta, u), u);
                let s = self.from.wrapping_add(area(self.v0 + by(gained, THIRD), t));
                (s, self.v0 + gained, by(slope, u), per_time.sixth)
            }
            Kind::Hold => {
                let gained = by(delta, fraction(t));
                let s = self.from.wrapping_add(area(self.v0 + (gained >> 1), t));
                (s, self.v0 + gained, slope >> 1, 0)
            }
            _ => {
                let left = self.time - t;
                let u = fraction(left);
                let missing = by(by(delta, u), u);
                let s = self.to.wrapping_sub(area(self.v1 - by(missing, THIRD), left));
                (s, self.v1 - missing, by(slope, u), -per_time.sixth)
            }
        };
        Phase {
            distance: Distance::from_bits(s),
            speed: Speed::from_bits(v),
            half_accel: Accel::from_bits(half_accel),
            sixth_jerk: Jerk::from_bits(sixth_jerk),
            ticks: 0,
        }
    }

    /// The piece that begins at the time `t` in a ramp of [`RampShape::SineSquare`], and the time at which
    /// that piece ends.
    #[inline(never)]
    fn sine_piece(&self, per_time: &PerTime, t: u64) -> (Phase, u64) {
        let falls = self.kind == Kind::SineFall;
        // A falling ramp is the rising ramp with time reversed.
        let from_zero = if falls { self.time - t } else { t };
        let u = (mul_wide(from_zero << per_time.zeros, per_time.reciprocal).0) as i64;
        let k = sine_piece(u, falls);
        let bent = sine_square(u, k);
        let by = |x: i64, u: i64| mul_near(x, u) << 2;
        let delta = self.v1 - self.v0;
        let gained = by(delta, bent.speed);
        let made = area(by(delta, bent.distance), self.time);
        // `per_time.sixth` is a sixth of the mean jerk; the ramp has eight pieces.
        let jerk = mul_shift(per_time.sixth, bent.jerk, 59);
        let (s, v, jerk, end) = if falls {
            let s = self.to.wrapping_sub(area(self.v1, from_zero).wrapping_sub(made));
            (s, self.v1 - gained, -jerk, self.time - sine_node(self.time, k))
        } else {
            let s = self.from.wrapping_add(area(self.v0, from_zero)).wrapping_add(made);
            (s, self.v0 + gained, jerk, sine_node(self.time, k + 1))
        };
        let phase = Phase {
            distance: Distance::from_bits(s),
            speed: Speed::from_bits(v),
            half_accel: Accel::from_bits(by(per_time.slope, bent.half_accel)),
            sixth_jerk: Jerk::from_bits(jerk),
            ticks: 0,
        };
        (phase, end)
    }

    /// The piece that begins within the first tick of a part. It is computed from the start of the part, so
    /// that the powers of t stay below 1.
    #[inline(never)]
    fn first_piece(&self, per_time: &PerTime, t32: u32, rest: u32, phase: &mut Phase) {
        let times = |x: i64| mul_u32(x, t32, 32);
        // Mean speed gained. The other values are written at once, because the processor has few registers.
        let mean = match self.kind {
            Kind::Rise => {
                let bent = times(per_time.sixth);
                let third = times(bent);
                phase.speed = Speed::from_bits(self.v0 + 3 * third);
                phase.half_accel = Accel::from_bits(3 * bent);
                phase.sixth_jerk = Jerk::from_bits(per_time.sixth);
                third
            }
            Kind::Hold => {
                let half = per_time.slope >> 1;
                let mean = times(half);
                phase.speed = Speed::from_bits(self.v0 + 2 * mean);
                phase.half_accel = Accel::from_bits(half);
                phase.sixth_jerk = Jerk::ZERO;
                mean
            }
            _ => {
                let bent = times(-per_time.sixth);
                let mean = times(per_time.slope + bent);
                phase.speed = Speed::from_bits(self.v0 + 2 * mean + times(bent));
                phase.half_accel = Accel::from_bits(per_time.slope + 3 * bent);
                phase.sixth_jerk = Jerk::from_bits(-per_time.sixth);
                mean
            }
        };
        phase.distance = Distance::from_bits(self.from.wrapping_add(area_in_tick(self.v0 + mean, t32, rest)));
    }
}

/// Speed times a time below one tick, as in [`area`].
#[cfg_attr(feature = "fast", inline(always))]
fn area_in_tick(v: i64, t32: u32, rest: u32) -> i64 {
    // Upper bits with LSB 2^-58, then the lower four bits; accurate to 2^-62 mm.
    let upper = mul_u32(v, t32, 32);
    let lower = ((v >> 32) * i64::from(rest)) >> 4;
    (upper + lower + (1 << 13)) >> 14
}

/// A change of speed Δ divided by a time, LSB 2^-36 tick.
#[derive(Clone, Copy, Debug)]
struct PerTime {
    time: u64,
    delta: i64,
    /// 2^126 / (time << zeros).
    reciprocal: u64,
    zeros: u32,
    /// Δ per time, and a third of Δ per time squared.
    slope: i64,
    sixth: i64,
}

impl PerTime {
    /// Values for no part.
    const NONE: Self = Self { time: 0, delta: 0, reciprocal: 0, zeros: 0, slope: 0, sixth: 0 };

    #[inline(never)]
    fn divide(&mut self, time: u64, delta: i64) {
        let zeros = time.leading_zeros();
        // Below 2^63, so that products need no check of the sign.
        let reciprocal = reciprocal_near(time << (zeros & 63)) & (u64::MAX >> 1);
        // Per tick. A part below two ticks has so few ticks that the missing low bits do not add up.
        let scale = |x: i64| if zeros <= 26 { x >> (26 - zeros) } else { x << ((zeros - 26) & 63) };
        let per_tick = |x: i64| mul_hi(x, reciprocal as i64);
        let slope = scale(per_tick(delta));
        let sixth = scale(mul_hi(per_tick(slope), THIRD << 2));
        *self = Self { time, delta, reciprocal, zeros, slope, sixth };
    }
}

//! Computes one stroke: the speed profile of an axis from stop to stop. For a stroke of a given time, this
//! file also finds the speed.
use super::PIECES_OF_A_STROKE;
use crate::math::float::{min, size_f32, to_f32};
use crate::quantity::{Distance, Speed, speed_f32};
use crate::slope::emit::TICK;
use crate::slope::limits::Limits;
use crate::slope::profile::{Change, Form, Profile, Unplannable};
use crate::slope::ramp_shape::RampShape;

/// Number of halvings in the search for a speed.
const STEPS: usize = 26;

/// Number of pieces of the ramps of a stroke with SIN2.
const PIECES_OF_SINES: u64 = 32;
const PIECES_OF_SLOPES: u64 = 6;

/// Rounding lowers the limits and so lengthens a profile by less than one part in this number.
const ROUNDING: u64 = 1 << 17;

/// Makes the speed profile over `length` (2^-44 mm) inside `limits`.
///
/// # Errors
/// [`Unplannable::Broken`]: a defect of the planner. [`Unplannable::TooSlow`]: the stroke takes more than
/// 2^27 ticks.
pub fn plan(profile: &mut Profile, length: i64, limits: &Limits) -> Result<(), Unplannable> {
    profile.plan(Distance::from_bits(length), Speed::ZERO, Speed::ZERO, limits)
}

/// Ticks of a profile, rounded up.
pub fn ticks(profile: &Profile) -> u32 {
    (profile.time().to_bits().div_ceil(TICK)) as u32
}

/// Ticks of the fastest stroke of the axis: the ticks of the profile, rounded up, and one at the end. The
/// time by which rounding of the limits lengthens the profile does not count.
pub fn fastest(profile: &Profile) -> u32 {
    let time = profile.time().to_bits();
    let exact = time - time / ROUNDING;
    (exact.div_ceil(TICK) as u32 + 1).max(ticks(profile))
}

/// Whether a profile, including its last tick, has few enough pieces to be queued as a whole.
pub fn is_short(profile: &Profile) -> bool {
    let whole = |time: u64| time.div_ceil(TICK);
    let change = |change: &Change| {
        let [first, hold, last] = change.times.map(whole);
        let ramp = |time: u64| match change.form {
            Form::JerkLimited(RampShape::SineSquare) => 8 * time.div_ceil(512),
            Form::JerkLimited(RampShape::Linear) => time.div_ceil(128),
            Form::Stepped(_) => time.div_ceil(512),
        };
        ramp(first) + hold.div_ceil(512) + ramp(last)
    };
    change(&profile.up) + cruise(profile) + change(&profile.down) < u64::from(PIECES_OF_A_STROKE)
}

/// Number of pieces between the ramps of a profile.
const fn cruise(profile: &Profile) -> u64 {
    profile.cruise.div_ceil(TICK).div_ceil(65_535)
}

/// Makes the profile, at a lower speed if its ramps have too many pieces. Returns the speed.
///
/// # Errors
/// As [`plan`]. Also [`Unplannable::TooSlow`] if the part between the ramps has too many pieces. This is so
/// above about 196 000 ticks with SIN2, and above 1 900 000 ticks with the other slopes.
pub fn plan_short(profile: &mut Profile, length: i64, limits: &Limits) -> Result<f32, Unplannable> {
    let mut limits = *limits;
    plan(profile, length, &limits)?;
    for _ in 0..STEPS {
        if is_short(profile) {
            return Ok(limits.v);
        }
        // At a lower speed, the ramps take longer.
        let sine = matches!(profile.up.form, Form::JerkLimited(RampShape::SineSquare));
        let slopes = if sine { PIECES_OF_SINES } else { PIECES_OF_SLOPES };
        if slopes + cruise(profile) >= u64::from(PIECES_OF_A_STROKE) {
            return Err(Unplannable::TooSlow);
        }
        limits.v = 0.5 * min(limits.v, speed_f32(profile.peak().to_bits()));
        plan(profile, length, &limits)?;
    }
    Err(Unplannable::TooSlow)
}

/// The lowest speed at which a stroke over `length` takes at most `time` ticks. The fastest stroke must take
/// less. With STEP, the result is the smaller root of v²/a − v·time + length = 0. With every slope, the time
/// falls with rising speed, so a search by halving finds the result.
pub fn speed_for(length: i64, time: f32, limits: &Limits) -> f32 {
    let length = to_f32(length) * (1.0 / (1u64 << 44) as f32);
    let (up, down) = (limits.speed_up(), limits.brake());
    let (mut low, mut high) = (length / time, limits.v);
    for _ in 0..STEPS {
        let v = 0.5 * (low + high);
        let slopes = up.distance(0.0, v)[0] + down.distance(0.0, v)[0];
        let takes = up.duration(0.0, v) + down.duration(0.0, v) + (length - slopes) / v;
        // A speed that the stroke does not reach is above its fastest speed.
        if slopes < length && takes > time {
            low = v;
        } else {
            high = v;
        }
    }
    high
}

/// Converts a time (LSB 2^-36 tick) to ticks.
pub fn in_ticks(time: u64) -> f32 {
    size_f32(time) * (1.0 / TICK as f32)
}

//! Whether a corner without a curve is passed, or the motion stands still in it.
//!
//! A step of speed shows as jerk, so beside a knee both blocks leave it a part of their own. At a sharp
//! corner the speed that this buys is next to nothing, and longer ramps on both sides cost more than it
//! gains. So the times of both blocks are compared, each from rest at its other end: with a standstill in the
//! corner and all of the limits, or passing it with what is left of them.
use crate::dynamics::Share;
use crate::math::float::{max, min, to_i64};
use crate::quantity::{speed_bits, speed_f32};
use crate::slope::limits::Limits;
use crate::slope::profile::peak_above;

/// How a corner without a curve is passed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Way {
    /// With its speed, and with acceleration where the slope permits it.
    Through,
    /// With its speed, and no acceleration.
    Resting,
    /// As if it were a standstill.
    Standing,
}

/// The way that takes the least time between two blocks, which leave their shares if the corner is passed
/// with the speed `v`. `passes`: acceleration may pass it, which needs more of their own.
pub(super) fn quickest(blocks: [(&Limits, &Share, f32); 2], v: f32, passes: bool) -> Way {
    if blocks.iter().all(|(limits, share, _)| limits.are_within(share)) {
        return Way::Through;
    }
    let stop: f32 = blocks.iter().map(|(limits, _, length)| time(limits, *length, 0.0)).sum();
    let through = times(&blocks, v, false);
    let resting = if passes { times(&blocks, v, true) } else { through };
    if min(through, resting) > stop {
        Way::Standing
    } else if resting < through * CLEARLY {
        Way::Resting
    } else {
        Way::Through
    }
}

/// Times that differ by less are one: with acceleration through the corner its neighbours may do more.
const CLEARLY: f32 = 1.0 - 1.0 / 4096.0;

/// Ticks of both blocks with what their shares leave them, `resting` or not.
#[inline(never)]
fn times(blocks: &[(&Limits, &Share, f32); 2], v: f32, resting: bool) -> f32 {
    let left = |limits: &Limits, share: &Share| {
        let share = if resting { share.resting() } else { *share };
        limits.shared(&share)
    };
    blocks.iter().map(|(limits, share, length)| time(&left(limits, share), *length, v)).sum()
}

/// Ticks from rest to the speed `v`, or what can be reached of it, over a length; as many as from there to
/// rest.
#[inline(never)]
fn time(limits: &Limits, length: f32, v: f32) -> f32 {
    let [up, down] = [limits.speed_up(), limits.brake()];
    let v = min(v, min(up.reach(0.0, length), limits.v));
    let speeds = [0, speed_bits(v), speed_bits(v)];
    let bits = to_i64(length * (1u64 << 44) as f32);
    let peak = v + speed_f32(peak_above(&up, &down, speeds, bits, limits.v));
    let ramps = up.distance(0.0, peak)[0] + down.distance(v, peak - v)[0];
    let cruise = max(length - ramps, 0.0) / max(peak, f32::MIN_POSITIVE);
    up.duration(0.0, peak) + down.duration(v, peak - v) + cruise
}

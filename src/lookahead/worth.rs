//! Decides whether a stop at a corner without a curve takes less time than a slow passage.
//!
//! In a passage, the speed of the axes has a step at the corner (a knee). The step needs a part of the
//! acceleration and jerk limits, so only the rest is left for the profiles of both blocks. Their ramps are
//! then longer. At a sharp corner, the permitted speed is nearly zero, and the longer ramps cost more time
//! than the passage saves. For the comparison, each of the two blocks is planned alone, from standstill at
//! its other end. The stop has all of the limits, the passage only the rest.
use crate::dynamics::Share;
use crate::math::float::{max, min, to_i64};
use crate::quantity::{speed_bits, speed_f32};
use crate::slope::limits::Limits;
use crate::slope::profile::peak_above;

/// How the motion passes a corner without a curve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Way {
    /// At the permitted speed; acceleration may pass if the slope permits it.
    Through,
    /// At the permitted speed, with zero acceleration.
    Resting,
    /// The motion stops.
    Standing,
}

/// Decides how the motion passes the corner between two blocks in the least time. If the motion passes at the
/// speed `v`, the blocks have the limits that their shares leave. `passes`: acceleration may pass the corner,
/// which needs more of the limits.
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

/// Times with a smaller difference count as equal. Then acceleration passes the corner, because the
/// neighbours profit from this.
const CLEARLY: f32 = 1.0 - 1.0 / 4096.0;

/// Ticks of both blocks with the limits that their shares leave. `resting`: acceleration is zero at the
/// corner.
#[inline(never)]
fn times(blocks: &[(&Limits, &Share, f32); 2], v: f32, resting: bool) -> f32 {
    let left = |limits: &Limits, share: &Share| {
        let share = if resting { share.resting() } else { *share };
        limits.shared(&share)
    };
    blocks.iter().map(|(limits, share, length)| time(&left(limits, share), *length, v)).sum()
}

/// Ticks over `length` from a stop to the speed `v`, or to the speed that the length permits. The reverse
/// motion takes the same time.
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

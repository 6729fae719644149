//! Whether a corner is passed, or the motion stands still in it: whichever takes less time over both blocks,
//! each from rest at its other end. Passing it leaves both of them less acceleration and jerk, over all of
//! their length.
use super::limits::BlockLimits;
use super::profile::{Profile, reach};
use crate::tolerance::TIE;

/// What a corner is worth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Worth {
    /// It is passed.
    Passing,
    /// The motion stands still in it.
    Standing,
    /// Either takes as long; the first word is whether standing is quicker here.
    Tie(bool),
}

/// Of a corner between two blocks of these limits and lengths that may be passed with the speed `v`.
pub fn worth(blocks: [(BlockLimits, f64); 2], v: f64) -> Worth {
    let shared = blocks.map(|(mut limits, length)| {
        limits.share();
        (limits, length)
    });
    if shared == blocks {
        return Worth::Passing;
    }
    let [standing, passing] =
        [(blocks, 0.0), (shared, v)].map(|(blocks, v)| blocks.iter().map(|b| time(b, v)).sum::<f64>());
    if (standing - passing).abs() <= TIE * standing {
        Worth::Tie(standing < passing)
    } else if standing < passing {
        Worth::Standing
    } else {
        Worth::Passing
    }
}

/// Time from rest to the speed `v`, or what can be reached of it. It counts for slowing down to rest too.
fn time((limits, length): &(BlockLimits, f64), v: f64) -> f64 {
    let v = reach(*length, 0.0, v.min(limits.v), limits.accelerate());
    let law = Profile::fastest(*length, 0.0, v, limits.v, limits.accelerate(), limits.brake());
    law.map_or(f64::INFINITY, |law| law.time())
}

//! Decides whether the motion passes a corner or stops there: the choice with the shorter time over both
//! blocks, each from a stop at its other end. Passing the corner leaves both blocks less acceleration and
//! jerk over their whole length.
use super::limits::BlockLimits;
use super::profile::{Profile, reach};
use crate::tolerance::TIE;

/// The choice at a corner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Worth {
    /// It is passed.
    Passing,
    /// The motion stands still in it.
    Standing,
    /// Both take equal time; the flag says whether stopping is quicker here.
    Tie(bool),
}

/// The choice at a corner between two blocks with these limits and lengths, if the corner permits the speed
/// `v`.
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

/// Time from a stop to the speed `v`, or to the reachable part of `v`. The same time holds for braking to a
/// stop.
fn time((limits, length): &(BlockLimits, f64), v: f64) -> f64 {
    let v = reach(*length, 0.0, v.min(limits.v), limits.accelerate());
    let law = Profile::fastest(*length, 0.0, v, limits.v, limits.accelerate(), limits.brake());
    law.map_or(f64::INFINITY, |law| law.time())
}

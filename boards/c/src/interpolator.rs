//! The C functions for the timer interrupt.
use crate::AXES;
use crate::built::Interpolator;
use crate::part::{Part, answer};
use crate::result::Outcome;
use glidepath::quantity::Position;
use glidepath::tick;

/// The handle of the timer interrupt.
pub type InterpolatorHandle = Part<Interpolator, 0x7469_636b>;

/// The state after a tick.
#[repr(u32)]
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum State {
    /// The axes stand still: nothing is planned, or the motion is in a feed hold or waits for an
    /// acknowledgement.
    Idle = 0,
    /// The motion along the path has ended, and filters or single axes may still move the axes.
    Settling = 1,
    /// The set point belongs to the planned motion; dwell time counts.
    Active = 2,
}

impl From<tick::State> for State {
    fn from(state: tick::State) -> Self {
        match state {
            tick::State::Idle => Self::Idle,
            tick::State::Settling => Self::Settling,
            tick::State::Active => Self::Active,
        }
    }
}

/// Copies the set points of the last tick, GP_AXES of them, LSB 2^-32 mm or degrees.
///
/// Context: the timer interrupt. Write the set points to the drives first, then call `gp_tick`; then
/// the moment of output does not depend on the duration of the computation. Returns GP_RESULT_NULL,
/// CLOSED, IN_USE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gp_set_points(
    interpolator: *mut InterpolatorHandle,
    set_points: *mut i64,
) -> Outcome {
    // SAFETY: the pointers are null or point to what they say.
    unsafe {
        Part::with(interpolator, |tick| {
            answer(set_points.cast::<[i64; AXES]>(), tick.set_points().map(Position::to_bits))
        })
    }
    .into()
}

/// Computes the next set points. `state` returns the state after the tick; `state` may be NULL.
///
/// Context: the timer interrupt, once per cycle. Its priority must be above that of the planner's task,
/// or it runs on another core. Bounded time. Returns GP_RESULT_NULL, CLOSED, IN_USE; then the set
/// points do not change.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gp_tick(interpolator: *mut InterpolatorHandle, state: *mut State) -> Outcome {
    // SAFETY: the pointers are null or point to what they say.
    unsafe {
        Part::with(interpolator, |interpolator| {
            let did = interpolator.tick().into();
            let _ = answer(state, did);
            Ok(())
        })
    }
    .into()
}

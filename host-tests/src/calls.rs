//! Calls the planner between two ticks until it has no work.
use glidepath::channel::{Error, Planner, Progress};
use glidepath::fir::FilterPlan;
use glidepath::nc::Text;

/// Calls the planner until it waits or the program is done, at most `most` times. `each` gets the results in
/// between. Returns whether the program is done.
///
/// # Errors
/// The library's refusal.
pub fn call<T: Text, F: FilterPlan<AXES>, const AXES: usize, const BLOCKS: usize, const OVERLAYS: usize>(
    planner: &mut Planner<'_, T, AXES, BLOCKS, F, OVERLAYS>,
    most: usize,
    mut each: impl FnMut(Progress),
) -> Result<bool, Error> {
    for _ in 0..most {
        match planner.poll()? {
            Progress::Waiting => break,
            Progress::Done => return Ok(true),
            other => each(other),
        }
    }
    Ok(false)
}

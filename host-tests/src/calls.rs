//! What every run does between two ticks: the planner is called until it has nothing to do.
use glidepath::channel::{Error, Planner, Progress};
use glidepath::fir::FilterPlan;
use glidepath::nc::Text;

/// Calls the planner until it waits or the program is done, `most` times at most; `each` gets what it says in
/// between. Whether the program is done.
///
/// # Errors
/// What the library refused.
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

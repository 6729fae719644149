//! Types and functions that depend on the build: a build may leave out the filters of the axes, and single
//! axes.
use crate::text::Program;
use crate::{AXES, BLOCKS, OVERLAYS};
use glidepath::channel::{self, Handles, MachineError};
use glidepath::machine::MachineData;
use glidepath::quantity::Position;
use glidepath::tick;

/// Number of single axes that may move at the same time.
const BESIDE: usize = if cfg!(feature = "beside") { OVERLAYS } else { 0 };

#[cfg(feature = "filters")]
mod filter {
    use crate::{AXES, TAPS};
    use glidepath::fir::{Bank, Filtered, Filters};

    pub type Memory = Filters<AXES, TAPS>;
    pub type Plan = Bank<'static, AXES, TAPS>;
    pub type Tick = Filtered<'static, AXES, TAPS>;
}

#[cfg(not(feature = "filters"))]
mod filter {
    use glidepath::fir::Unfiltered;

    pub type Memory = ();
    pub type Plan = Unfiltered;
    pub type Tick = Unfiltered;
}

pub use filter::Memory as FilterMemory;

/// The channel and its handles.
pub type Channel = channel::Channel<AXES, BLOCKS, BESIDE>;
pub type Planner = channel::Planner<'static, Program, AXES, BLOCKS, filter::Plan, BESIDE>;
pub type Interpolator = tick::Interpolator<'static, AXES, filter::Tick, BESIDE>;
type Split = Handles<'static, Program, AXES, BLOCKS, filter::Plan, filter::Tick, BESIDE>;

/// Checks whether the channel supports these machine data.
///
/// # Errors
/// The reason.
pub fn check(machine: &MachineData<AXES>) -> Result<(), MachineError> {
    Channel::check(machine)?;
    #[cfg(feature = "filters")]
    FilterMemory::check(machine).map_err(|error| MachineError::Filter(error.axis().unwrap_or(0), error))?;
    Ok(())
}

/// Returns the handles. No program is loaded.
///
/// # Errors
/// As [`check`].
pub fn split(
    channel: &'static mut Channel,
    filters: &'static mut FilterMemory,
    machine: &'static MachineData<AXES>,
    start: [Position; AXES],
) -> Result<Split, MachineError> {
    let nothing = Program::Memory(&[]);
    #[cfg(feature = "filters")]
    return channel.split_filtered(filters, machine, start, nothing);
    #[cfg(not(feature = "filters"))]
    {
        let () = filters;
        channel.split(machine, start, nothing)
    }
}

//! Planner and interpolator: wiring only, all that an application holds.
use crate::machine::MachineData;
use crate::nc::{Place, Text};
use crate::quantity::{Distance, Position, Speed, Time};
use crate::tick::Interpolator;

/// The static memory of one channel: `AXES` axes, `BLOCKS` blocks of look-ahead.
pub struct Channel<const AXES: usize, const BLOCKS: usize> {
    rings: crate::queue::Rings<AXES>,
}

impl<const AXES: usize, const BLOCKS: usize> Channel<AXES, BLOCKS> {
    /// An empty channel.
    pub const fn new() -> Self {
        Self { rings: crate::queue::Rings::new() }
    }

    /// The two halves: `text` will be decoded and planned for `machine`, which stands at `start`.
    ///
    /// # Errors
    /// Machine data that this version cannot work with.
    pub fn split<'a, T: Text>(
        &'a mut self,
        machine: &MachineData<AXES>,
        start: [Position; AXES],
        text: T,
    ) -> Result<(Planner<'a, T, AXES, BLOCKS>, Interpolator<'a, AXES>), Error> {
        let (sender, receiver) = self.rings.split();
        let planning = crate::planning::Planning::new(machine, start, sender);
        Ok((Planner { _text: text, planning }, Interpolator::new(receiver, start)))
    }
}

impl<const AXES: usize, const BLOCKS: usize> Default for Channel<AXES, BLOCKS> {
    fn default() -> Self {
        Self::new()
    }
}

/// What one call of [`Planner::poll`] achieved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Progress {
    /// A bounded piece of work is done and there is more: call again.
    Working,
    /// The queue is full: call again after some ticks.
    Waiting,
    /// A motion block was planned for good.
    Planned(PlannedBlock),
    /// The program has ended and everything is handed to the interpolator.
    Done,
}

/// The time law of one motion block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlannedBlock {
    /// Motion blocks since program start, from 0.
    pub block: u32,
    /// Programmed N number.
    pub n: u32,
    /// Where it stands in the text.
    pub place: Place,
    /// Path length.
    pub length: Distance,
    /// Speed at its start.
    pub v_in: Speed,
    /// Highest speed.
    pub v_peak: Speed,
    /// Speed at its end.
    pub v_out: Speed,
    /// Duration.
    pub time: Time,
}

/// Why a program or a machine was refused.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Error {
    /// Filled in by the stages.
    Placeholder,
}

/// The half of a channel that works ahead: text to time law, a bounded piece per call.
pub struct Planner<'a, T, const AXES: usize, const BLOCKS: usize> {
    _text: T,
    /// x
    pub planning: crate::planning::Planning<'a, AXES, BLOCKS>,
}

impl<T: Text, const AXES: usize, const BLOCKS: usize> Planner<'_, T, AXES, BLOCKS> {
    /// Does a bounded piece of work. Call it in a loop while it says [`Progress::Working`] or [`Progress::Planned`].
    ///
    /// # Errors
    /// The program is refused; what was planned before stays valid and comes to a standstill. Further calls go on
    /// with planning that rest and end in [`Progress::Done`].
    pub fn poll(&mut self) -> Result<Progress, Error> {
        Ok(Progress::Done)
    }
}

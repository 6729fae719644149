//! Checks a program without a plan (feature `examine`): reads its text, and returns the refusals and warnings
//! that a run would give.
//!
//! Commands take the same route as in a run, up to the look-ahead. The check misses two refusals that need a
//! plan: a defect of the planner, and a reduced speed (P-AXIS-00214) that is too low.
use super::Planner;
use crate::fir::FilterPlan;
use crate::nc::{Command, NcError, Step, Text};

impl<'a, T: Text, const AXES: usize, const BLOCKS: usize, F: FilterPlan<AXES>, const OVERLAYS: usize>
    Planner<'a, T, AXES, BLOCKS, F, OVERLAYS>
{
    /// Makes [`Self::poll`] check programs instead of planning them. Call `examine` before the first [`Self::poll`];
    /// the check cannot be switched off again.
    ///
    /// This handle returns the same refusals and warnings as in a run. The path does not move, a dwell takes
    /// no time, and functions are acknowledged at once. Call the interpolator's tick when [`Self::poll`]
    /// returns [`Progress::Waiting`](super::Progress::Waiting): filters and single axes need the ticks.
    ///
    /// If an oscillation ends by `OFF INSTANT` or `OFF FEED`, the check assumes another end position of the
    /// axis than a run.
    ///
    /// ```
    /// use glidepath::{AxisData, AxisKind, AxisName, Channel, ChannelData, MachineData, Position, Progress};
    ///
    /// let axis = AxisData::new(AxisName::new("X").unwrap(), AxisKind::Linear);
    /// let machine = MachineData { axes: [axis], channel: ChannelData::new() };
    /// let program: &[u8] = b"G00 X10\nG04 S5\nM30\n";
    /// let mut memory = Channel::<1, 120>::new();
    /// let mut planner = memory.split(&machine, [Position::ZERO], program).unwrap().planner;
    /// planner.examine();
    /// let refused = loop {
    ///     match planner.poll() {
    ///         Ok(Progress::Done) => break None,
    ///         Ok(_) => {}
    ///         Err(error) => break Some(error),
    ///     }
    /// };
    /// let known = "G04 S (revolutions) is known, not available in this version";
    /// assert_eq!(refused.unwrap().to_string(), known);
    /// ```
    pub fn examine(&mut self) {
        self.planning.begin_to_examine();
    }

    /// Makes [`Self::seen`] return the commands of a run that are carried out; a real-time loop gives its
    /// commands in each pass.
    pub fn watch(&mut self) {
        self.watches = true;
    }

    /// The command that the last [`Self::poll`] read, accepted or refused. Each command is returned once.
    /// Valid only after [`Self::examine`] or [`Self::watch`].
    pub fn seen(&mut self) -> Option<Command<AXES>> {
        self.seen.take()
    }

    /// Keeps a command for [`Self::seen`].
    pub(super) fn see(&mut self, step: &Result<Step<AXES>, NcError>) {
        if let (true, Ok(Step::Command(command))) = (self.planning.examines(), step) {
            self.seen = Some(*command);
        }
    }

    /// Keeps a command that is carried out, for [`Self::seen`].
    pub(super) fn see_done(&mut self, command: &Command<AXES>) {
        if self.watches {
            self.seen = Some(*command);
        }
    }
}

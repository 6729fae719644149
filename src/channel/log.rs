//! The contour known in advance: the log of the PLC (feature `plc`).
use super::{Error, Planner};
use crate::contour_log::Recorder;
use crate::fir::FilterPlan;
use crate::nc::{Command, ContourLog, Text};

impl<'a, T: Text, const AXES: usize, const BLOCKS: usize, F: FilterPlan<AXES>, const OVERLAYS: usize>
    Planner<'a, T, AXES, BLOCKS, F, OVERLAYS>
{
    /// Writes the contour ahead from now on, where a PLC reads it:
    /// [`ContourMemory::split`](crate::contour_log::ContourMemory::split). Distances count from here. It is called once,
    /// before the first [`Self::poll`]. Each element then costs the planner a copy of 48 bytes and the angle to the one
    /// before; a polynomial is measured, too. The interrupt does nothing for it.
    pub fn log_contour(&mut self, recorder: Recorder<'a>) {
        self.planning.set_recorder(recorder);
    }

    /// #CONTOUR LOOKAHEAD LOG and #DISTANCE PROG START CLEAR.
    #[inline(never)]
    pub(super) fn log(&mut self, command: &Command<AXES>) -> Result<(), Error> {
        if !self.planning.has_recorder() {
            return Err(Error::NotEnabled(command.place(), NEEDS));
        }
        let taken = match command {
            Command::ContourLog(head, ContourLog::Clear) => {
                self.planning.rest(0);
                self.join(u32::MAX);
                self.planning.clear_log(head.n)
            }
            Command::ContourLog(head, log) => self.planning.log(head.n, *log),
            Command::DistanceClear(head) => self.planning.clear_distance(head.n),
            _ => Ok(()),
        };
        taken.map_err(|_| Error::NotEnabled(command.place(), CROWDED))
    }
}

const NEEDS: &str = "the log of the contour is not enabled; expected FCT_CONTOUR_LAH in configuration.interpolator.function (P-CHAN-00650)";

const CROWDED: &str = "more than 8 commands of #CONTOUR LOOKAHEAD LOG wait for one motion block; expected fewer between two blocks";

//! The contour known in advance: the log of the PLC (feature `plc`).
use super::{Error, Planner};
use crate::contour_log::{Moment, Question, QuestionUnit, Recorder, Unknown};
use crate::fir::FilterPlan;
use crate::nc::{Command, ContourLog, Text};
pub use crate::plan::Inquiry;

impl<'a, T: Text, const AXES: usize, const BLOCKS: usize, F: FilterPlan<AXES>, const OVERLAYS: usize>
    Planner<'a, T, AXES, BLOCKS, F, OVERLAYS>
{
    /// Writes the contour ahead from now on, where a PLC reads it:
    /// [`ContourMemory::split`](crate::contour_log::ContourMemory::split). Distances count from here. Machine data without
    /// FCT_CONTOUR_LAH (P-CHAN-00650) have no log: nothing is written. It is called once,
    /// before the first [`Self::poll`]. Each element then costs the planner a copy of 48 bytes and the angle to the one
    /// before; a polynomial is measured, too. The interrupt does nothing for it.
    pub fn log_contour(&mut self, recorder: Recorder<'a>) {
        self.planning.set_recorder(recorder);
    }

    /// Memory for the question where the path would stand still: [`Question::Standstill`]. It is called once, before the
    /// first [`Self::poll`].
    pub fn foresee(&mut self, inquiry: &'a mut Inquiry) {
        self.planning.set_inquiry(inquiry);
    }

    /// Answers a question about what comes, as far as the planner knows it now. To be called between two calls of
    /// [`Self::poll`], best after [`super::Progress::Waiting`]. The motion does not change. Bounded: it goes through the
    /// pieces and curves in the queue once; for [`Question::Standstill`] it does as much as a call of [`Self::poll`] for a
    /// feed hold.
    ///
    /// An answer is for a motion without a command, acknowledgement or late text in between. Filters of the axes come
    /// behind it.
    ///
    /// # Errors
    /// [`Unknown`] says why there is no answer, and when to ask again.
    pub fn forecast(&mut self, question: Question) -> Result<Moment<AXES>, Unknown> {
        self.planning.forecast(question)
    }

    /// Answers the question of another context, if there is one. [`Unknown::Searching`] is not told: the next call goes on.
    /// Whether a question was answered.
    pub fn answer(&mut self, unit: &QuestionUnit<AXES>) -> bool {
        let Some(question) = unit.pending() else { return false };
        let answer = self.planning.forecast(question);
        if answer == Err(Unknown::Searching) {
            return false;
        }
        unit.put(&answer);
        true
    }

    /// #CONTOUR LOOKAHEAD LOG and #DISTANCE PROG START CLEAR.
    #[inline(never)]
    pub(super) fn log(&mut self, command: &Command<AXES>) -> Result<(), Error> {
        if !self.planning.has_recorder() {
            return Err(Error::NotEnabled(command.place(), NEEDS));
        }
        if matches!(command, Command::ContourLog(..)) && !self.planning.has_storage() {
            return Err(Error::NotEnabled(command.place(), NO_STORAGE));
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

const NO_STORAGE: &str =
    "there is no storage for the log of the contour; expected fb_storage_size[0] above 0 (P-STUP-00033)";

pub(super) const CROWDED: &str = "more than 8 commands of #CONTOUR LOOKAHEAD LOG wait for one motion block; expected fewer between two blocks";

//! The planner's functions for a PLC (feature `plc`): the log of the path ahead, and questions about the
//! coming motion.
use super::{Error, Planner};
use crate::contour_log::{Moment, PositionLimits, Question, QuestionUnit, Recorder, Unknown};
use crate::fir::FilterPlan;
use crate::nc::{Command, ContourLog, Text};
pub use crate::plan::Inquiry;

impl<'a, T: Text, const AXES: usize, const BLOCKS: usize, F: FilterPlan<AXES>, const OVERLAYS: usize>
    Planner<'a, T, AXES, BLOCKS, F, OVERLAYS>
{
    /// Starts the log of the path ahead for a PLC:
    /// [`ContourMemory::split`](crate::contour_log::ContourMemory::split). Distances count from this call.
    /// Without FCT_CONTOUR_LAH (P-CHAN-00650) in the machine data, the planner writes no log. Call
    /// `log_contour` once, before the first [`Self::poll`]. Each element then costs the planner a copy of 44
    /// bytes and the angle to the element before. The interrupt does no work for the log.
    pub fn log_contour(&mut self, recorder: Recorder<'a>) {
        self.planning.set_recorder(recorder);
    }

    /// Supplies the memory that the planner needs to answer where a feed hold would stop the path:
    /// [`Question::Standstill`]. Call `foresee` once, before the first [`Self::poll`].
    pub fn foresee(&mut self, inquiry: &'a mut Inquiry) {
        self.planning.set_inquiry(inquiry);
    }

    /// Lets a PLC limit the positions of axes of the path during the motion: [`PositionLimits`]. Call `limit_positions` once,
    /// before the first [`Self::poll`]. `inquiry` also serves [`Question::Standstill`], as with [`Self::foresee`]. While a limit is in force, each tick costs the planner as
    /// much as a question for the stop of a feed hold. An application then calls [`Self::poll`] in every tick, also after
    /// [`super::Progress::Done`], up to the end of the motion.
    ///
    /// # Errors
    /// FCT_DYN_POS_LIMIT is not in P-CHAN-00650.
    pub fn limit_positions(
        &mut self,
        limits: &'a PositionLimits<AXES>,
        inquiry: &'a mut Inquiry,
    ) -> Result<(), Unknown> {
        self.planning.set_limits(limits, inquiry)
    }

    /// Answers a question about the coming motion, from the motion that is planned now. Call `forecast`
    /// between two calls of [`Self::poll`], best after [`super::Progress::Waiting`]. The motion does not
    /// change. The cost is bounded: one pass over the pieces and curves in the queue.
    /// [`Question::Standstill`] costs as much as a call of [`Self::poll`] for a feed hold.
    ///
    /// The answer assumes that no command, acknowledgement or late text comes later. The answer has positions
    /// before the axis filters.
    ///
    /// # Errors
    /// [`Unknown`] says why there is no answer, and when to ask again.
    pub fn forecast(&mut self, question: Question) -> Result<Moment<AXES>, Unknown> {
        self.planning.forecast(question)
    }

    /// Answers the question of a PLC, if there is one. Returns whether a question was answered.
    /// [`Unknown::Searching`] is no answer: the next call continues the search.
    pub fn answer(&mut self, unit: &QuestionUnit<AXES>) -> bool {
        let Some(question) = unit.pending() else { return false };
        let answer = self.planning.forecast(question);
        if answer == Err(Unknown::Searching) {
            return false;
        }
        unit.put(&answer);
        true
    }

    /// Carries out `#CONTOUR LOOKAHEAD LOG` and `#DISTANCE PROG START CLEAR`.
    #[inline(never)]
    pub(super) fn log(&mut self, command: &Command<AXES>) -> Result<(), Error> {
        if !self.planning.has_recorder() {
            return Err(Error::NotEnabled(command.place(), NEEDS));
        }
        if matches!(command, Command::ContourLog(..)) && self.planning.storage() == 0 {
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

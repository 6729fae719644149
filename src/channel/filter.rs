//! Carries out `#FILTER`: the planner changes the filter coefficients while all axes stand still, single axes
//! too.
use super::{Error, Planner, Progress};
use crate::fir::{Fate, FilterPlan};
use crate::nc::{Filter, Head, NcWarning, NcWarningKind, Text};
use crate::quantity::Position;

impl<'a, T: Text, const AXES: usize, const BLOCKS: usize, F: FilterPlan<AXES>, const OVERLAYS: usize>
    Planner<'a, T, AXES, BLOCKS, F, OVERLAYS>
{
    /// Carries out `#FILTER`: the motion stops, and resumes with other coefficients.
    pub(super) fn filter(&mut self, head: &Head, filter: &Filter) -> Result<Progress, Error> {
        let fate = self.filters.command(filter).map_err(|error| {
            let names = &self.decoder.setup().names;
            Error::Filter(
                head.place,
                error.axis().and_then(|k| names.get(k).copied()).unwrap_or_default(),
                error,
            )
        })?;
        if fate != Fate::Same {
            self.planning.rest(1);
        }
        if fate == Fate::NoOrder {
            return Ok(Progress::Warning(NcWarning {
                place: head.place,
                kind: NcWarningKind::FilterWithoutOrder,
            }));
        }
        Ok(Progress::Working)
    }

    /// Does a part of the change of coefficients, after all blocks are in the queue.
    #[inline(never)]
    pub(super) fn change_filters(&mut self) -> Progress {
        if !self.planning.is_at_rest() || !self.planning.is_shown() || !self.ends_beside() {
            return Progress::Waiting;
        }
        if !self.filters.is_settled() || !self.filters.work() {
            return Progress::Waiting;
        }
        if !self.filters.is_pending() {
            self.watch_filters();
        }
        Progress::Working
    }

    /// Computes again the limits that the filters impose on the plan.
    pub(super) fn watch_filters(&mut self) {
        if !F::EXIST {
            return;
        }
        let dynamics = self.planning.unwatched();
        for axis in 0..AXES {
            if let Some(watch) = self.filters.watch(axis) {
                dynamics.watch(axis, &watch, |jerk| self.filters.corner(axis, jerk));
            }
        }
    }

    /// Ticks until the axes stand still after an exact stop. After a dwell, the axes have already stood still
    /// for the dwell time.
    pub(super) fn settling(&self) -> u64 {
        self.filters.window().into()
    }

    /// Whether the path stops for an acknowledgement while filtered axes still move. The motion then resumes
    /// only after the axes stand still.
    pub(super) fn settles_at_gate(&self) -> bool {
        F::EXIST && !self.filters.is_settled() && self.planning.is_waiting()
    }

    /// Delay of all axes in half cycles, and AX_DEV. For simulators: a controller does not need this call.
    #[doc(hidden)]
    pub fn filter_in_force(&self) -> (u32, Position) {
        self.filters.in_force()
    }

    /// For each axis, the largest distance between the filtered set point and the unfiltered set point with
    /// the same delay, mm or degrees. The distance is measured since the last change of `#FILTER`, and only
    /// while AX_DEV is given.
    pub fn filter_deviation(&self) -> [Position; AXES] {
        core::array::from_fn(|axis| self.filters.deviation(axis))
    }
}

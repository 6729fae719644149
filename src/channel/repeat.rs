//! Real-time loops (feature `plc`): the planner reads a loop to its end and stores its commands. Then the
//! planner plans the stored commands again and again, as long as the PLC lets the loop repeat.
use super::{Error, Planner, Progress};
use crate::fir::FilterPlan;
use crate::nc::{Command, Head, Place, Text};
use crate::plan::{Seam, Turn};
use crate::rt_loop::{LoopError, LoopStore};
use crate::variable::Variable;

/// Stage of the current loop.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Stage {
    /// No loop.
    Outside,
    /// The commands of the loop are being read and stored.
    Reading(Head),
    /// A pass is complete, or the first pass has not begun; the flag decides on the next pass.
    Seam,
    /// Number of the next command to plan.
    Within(usize),
}

/// Real-time loops of a planner.
pub(super) struct Loops<'a, const AXES: usize> {
    pub(super) store: Option<LoopStore<'a, AXES>>,
    stage: Stage,
    /// #RT WHILE MODULO.
    modulo: bool,
    /// Number of passes of the current loop.
    passes: u32,
    /// #FLUSH WAIT: the following lines may read a variable, so they wait until the axes stand still.
    waits: bool,
    /// A function with FAW_SYNCH: after its line, the program waits for the motion.
    pub(super) flushes: bool,
}

impl<const AXES: usize> Loops<'_, AXES> {
    /// No loop, and no memory for a loop.
    pub(super) const NONE: Self =
        Self { store: None, stage: Stage::Outside, modulo: false, passes: 0, waits: false, flushes: false };

    /// Drops the current loop.
    pub(super) const fn forget(&mut self) {
        (self.stage, self.waits, self.flushes) = (Stage::Outside, false, false);
    }

    /// Whether commands come from a loop and not from the text.
    pub(super) const fn repeat(&self) -> bool {
        matches!(self.stage, Stage::Seam | Stage::Within(_))
    }

    /// Whether commands of the text are stored for a loop.
    pub(super) const fn read(&self) -> bool {
        matches!(self.stage, Stage::Reading(_))
    }
}

impl<'a, T: Text, const AXES: usize, const BLOCKS: usize, F: FilterPlan<AXES>, const OVERLAYS: usize>
    Planner<'a, T, AXES, BLOCKS, F, OVERLAYS>
{
    /// Sets the memory for real-time loops: [`LoopMemory::split`](crate::rt_loop::LoopMemory::split). Call
    /// this function once, before the first [`Self::poll`]. Without this memory, the planner refuses `#RT
    /// WHILE`. The planner also refuses if P-STUP-00033 (fb_storage_size) is 0 or too small for the loop.
    pub fn real_time_loops(&mut self, mut store: LoopStore<'a, AXES>) {
        store.limit(self.planning.storage());
        self.decoder.externals.flag = Some(store.flag());
        self.loops.store = Some(store);
    }

    /// Sets the variables that programs read and write under names `V.E.…`. Call this function once, before
    /// the first [`Self::poll`].
    ///
    /// The planner reads or writes a variable when it reads the line, which is before the axes reach that
    /// line. After `#FLUSH WAIT`, the axes have reached the line.
    pub fn variables(&mut self, variables: &'a [Variable]) {
        self.decoder.externals.variables = variables;
    }

    /// #FLUSH WAIT: if there are variables from outside, the planner reads the next lines when the axes
    /// stand still.
    pub(super) const fn wait_for_standstill(&mut self) {
        self.loops.waits = self.decoder.externals.exist();
    }

    /// Whether #FLUSH WAIT still waits. Call this function only after [`crate::plan::Work::Hungry`].
    pub(super) fn still_moves(&mut self) -> bool {
        self.loops.waits &= !self.planning.is_at_rest();
        self.loops.waits
    }

    /// Begins a loop at #RT WHILE; refuses #RT ENDWHILE outside a loop.
    pub(super) fn begin_loop(&mut self, head: &Head, modulo: Option<bool>) -> Result<(), Error> {
        let refuse = |error| Err(Error::Loop(head.place, error));
        let Some(modulo) = modulo else { return refuse(LoopError::Unopened) };
        let Some(store) = &mut self.loops.store else { return refuse(LoopError::NoMemory) };
        if self.planning.storage() == 0 {
            return refuse(LoopError::NoStorage);
        }
        if self.planning.has_spline() {
            return refuse(LoopError::SplineBefore);
        }
        store.clear();
        self.join(u32::MAX);
        (self.loops.stage, self.loops.modulo, self.loops.passes) = (Stage::Reading(*head), modulo, 0);
        Ok(())
    }

    /// Stores a command of a loop, or ends the loop at #RT ENDWHILE.
    #[inline(never)]
    pub(super) fn keep(&mut self, command: &Command<AXES>) -> Result<Progress, Error> {
        let place = command.place();
        let Some(store) = &mut self.loops.store else { return Ok(Progress::Working) };
        if let Command::RtEndWhile(_) = command {
            self.end_loop().map_err(|error| Error::Loop(place, error))?;
        } else {
            store.push(command).map_err(|error| Error::Loop(place, error))?;
        }
        Ok(Progress::Working)
    }

    /// Checks the loop at its end.
    fn end_loop(&mut self) -> Result<(), LoopError> {
        let start = *self.planning.position();
        let Some(store) = &self.loops.store else { return Err(LoopError::NoMemory) };
        if !store.moves(&start) {
            return Err(LoopError::NoMotion);
        }
        if store.end() != Some(start) {
            return Err(LoopError::NotClosed);
        }
        if store.spline(false) {
            return Err(LoopError::SplineBehind);
        }
        self.loops.stage = Stage::Seam;
        Ok(())
    }

    /// The place of #RT WHILE, if the text ends inside a loop.
    pub(super) const fn unclosed_loop(&self) -> Option<Place> {
        if let Stage::Reading(head) = self.loops.stage { Some(head.place) } else { None }
    }

    /// Plans the next command of a loop. At a seam, the decision on another pass waits as long as the planner
    /// has other work.
    #[inline(never)]
    pub(super) fn repeat(&mut self) -> Result<Progress, Error> {
        let Stage::Within(next) = self.loops.stage else { return self.pass_seam() };
        let command =
            self.loops.store.as_ref().and_then(|store| store.get(next)).map(|stored| stored.command());
        let Some(command) = command else {
            self.loops.stage = Stage::Seam;
            return Ok(Progress::Working);
        };
        self.loops.stage = Stage::Within(next + 1);
        let result = self.execute(&command);
        if result.is_err() {
            self.refuse();
        }
        result
    }

    /// Decides on another pass, if the decision cannot wait any longer.
    fn pass_seam(&mut self) -> Result<Progress, Error> {
        match self.planning.seam() {
            Seam::Wait => return Ok(Progress::Waiting),
            Seam::Working => return Ok(Progress::Working),
            Seam::Decide => {}
        }
        let Loops { store, stage, modulo, passes, .. } = &mut self.loops;
        let again = store.as_ref().is_some_and(LoopStore::is_enabled);
        // A check plans the loop once.
        #[cfg(feature = "examine")]
        let again = if self.planning.examines() { *passes == 0 } else { again };
        let turn = match (again, *passes) {
            (true, 0) => Turn::Begin,
            (true, _) => Turn::Again,
            (false, 0) => {
                *stage = Stage::Outside;
                return Ok(Progress::Working);
            }
            (false, _) => Turn::End,
        };
        let (place, modulo) = (store.as_ref().and_then(LoopStore::place), *modulo);
        *passes = passes.saturating_add(1);
        *stage = if again { Stage::Within(0) } else { Stage::Outside };
        if let (true, Some(store)) = (again, store) {
            store.pass();
        }
        if self.planning.turn(turn, modulo).is_err() {
            self.refuse();
            return Err(Error::NotEnabled(place.unwrap_or_default(), super::log::CROWDED));
        }
        Ok(Progress::Working)
    }

    /// Ends the loop: the current line is refused.
    pub(super) fn break_loop(&mut self) {
        if self.loops.repeat() {
            // If there is no room, the log ends with the program.
            let _ = self.planning.turn(Turn::End, false);
        }
        self.loops.forget();
    }
}

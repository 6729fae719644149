//! Real-time loops: the planner reads a loop to its end, then plans pass after pass (feature `plc`).
use super::{Error, Planner, Progress};
use crate::fir::FilterPlan;
use crate::nc::{Command, Head, Place, Text};
use crate::plan::{Seam, Turn};
use crate::rt_loop::{LoopError, LoopStore};
use crate::variable::Variable;

/// Where the loop at hand stands.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Stage {
    /// No loop.
    Outside,
    /// Its commands are read and kept.
    Reading(Head),
    /// A pass is complete, or the first one is to begin: the flag decides.
    Seam,
    /// The next command to plan.
    Within(usize),
}

/// Real-time loops of a planner.
pub(super) struct Loops<'a, const AXES: usize> {
    pub(super) store: Option<LoopStore<'a, AXES>>,
    stage: Stage,
    /// #RT WHILE MODULO.
    modulo: bool,
    /// Passes of the loop at hand.
    passes: u32,
    /// #FLUSH WAIT: what follows may read a variable, and waits until the axes stand.
    waits: bool,
    /// A function with FAW_SYNCH: behind its line the program waits for the motion.
    pub(super) flushes: bool,
}

impl<const AXES: usize> Loops<'_, AXES> {
    /// No loop, and no memory for one.
    pub(super) const NONE: Self =
        Self { store: None, stage: Stage::Outside, modulo: false, passes: 0, waits: false, flushes: false };

    /// The loop at hand is forgotten.
    pub(super) const fn forget(&mut self) {
        (self.stage, self.waits, self.flushes) = (Stage::Outside, false, false);
    }

    /// Whether commands come from a loop instead of the text.
    pub(super) const fn repeat(&self) -> bool {
        matches!(self.stage, Stage::Seam | Stage::Within(_))
    }

    /// Whether commands of the text are kept for a loop.
    pub(super) const fn read(&self) -> bool {
        matches!(self.stage, Stage::Reading(_))
    }
}

impl<'a, T: Text, const AXES: usize, const BLOCKS: usize, F: FilterPlan<AXES>, const OVERLAYS: usize>
    Planner<'a, T, AXES, BLOCKS, F, OVERLAYS>
{
    /// Real-time loops are kept in this memory from now on: [`LoopMemory::split`](crate::rt_loop::LoopMemory::split). It
    /// is called once, before the first [`Self::poll`]. Without it, the planner refuses `#RT WHILE`; so it does where
    /// P-STUP-00033 (fb_storage_size) is 0 or too small for a loop.
    pub fn real_time_loops(&mut self, mut store: LoopStore<'a, AXES>) {
        store.limit(self.planning.storage());
        self.decoder.externals.flag = Some(store.flag());
        self.loops.store = Some(store);
    }

    /// The variables V.E. of programs from now on. It is called once, before the first [`Self::poll`].
    ///
    /// A program reads a variable when the planner reads its line, ahead of the motion, and writes it then. Behind
    /// `#FLUSH WAIT` the motion has come to the line.
    pub fn variables(&mut self, variables: &'a [Variable]) {
        self.decoder.externals.variables = variables;
    }

    /// #FLUSH WAIT: with variables from outside, the lines behind it are read when the axes stand.
    pub(super) const fn wait_for_standstill(&mut self) {
        self.loops.waits = self.decoder.externals.exist();
    }

    /// Whether #FLUSH WAIT still waits. Only after [`crate::plan::Work::Hungry`].
    pub(super) fn still_moves(&mut self) -> bool {
        self.loops.waits &= !self.planning.is_at_rest();
        self.loops.waits
    }

    /// #RT WHILE and #RT ENDWHILE outside of a loop.
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

    /// A command between #RT WHILE and #RT ENDWHILE, or the latter.
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

    /// The loop is read.
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

    /// The text ends inside of a loop: where that begins.
    pub(super) const fn unclosed_loop(&self) -> Option<Place> {
        if let Stage::Reading(head) = self.loops.stage { Some(head.place) } else { None }
    }

    /// The next command of a loop. At a seam the decision waits as long as the planner can do without it.
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

    /// Decides on another pass, if that cannot wait any longer.
    fn pass_seam(&mut self) -> Result<Progress, Error> {
        match self.planning.seam() {
            Seam::Wait => return Ok(Progress::Waiting),
            Seam::Working => return Ok(Progress::Working),
            Seam::Decide => {}
        }
        let Loops { store, stage, modulo, passes, .. } = &mut self.loops;
        let again = store.as_ref().is_some_and(LoopStore::is_enabled);
        // A check goes through the loop once.
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

    /// The line at hand is refused: the loop ends where it is.
    pub(super) fn break_loop(&mut self) {
        if self.loops.repeat() {
            // Without room the log ends with the program.
            let _ = self.planning.turn(Turn::End, false);
        }
        self.loops.forget();
    }
}

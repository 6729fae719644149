//! Functions for a channel at rest: the next program, single lines, positions, zero offsets. At rest means
//! that the axes stand still and all commands read so far are carried out.
//!
//! The documentation of [`Planner`] says which state each function keeps.
use super::{Planner, Source};
use crate::fir::FilterPlan;
use crate::nc::{COORDINATE_MAX, Text};
use crate::quantity::Position;

/// The error of [`Planner::load`] and similar calls: the channel is not at rest. The error gives the text
/// back.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Busy<T> {
    /// The text that was not taken.
    pub text: T,
}

impl<T> core::fmt::Display for Busy<T> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str("a program is loaded at rest, when all blocks read are executed")
    }
}

impl<T: core::fmt::Debug> core::error::Error for Busy<T> {}

/// The reason why [`Planner::go_on`] did not continue the program after a refused line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum GoOnError {
    /// Axes still move, or some commands that were read are not carried out yet.
    NotAtRest,
    /// There is nothing to continue: no line was refused, or the program was aborted afterwards.
    NothingRefused,
}

impl core::fmt::Display for GoOnError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::NotAtRest => "a program goes on at rest, when all blocks read are executed",
            Self::NothingRefused => "no refused line to go on behind; load a program",
        })
    }
}

impl core::error::Error for GoOnError {}

/// The reason why the planner did not set a new position of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum PositionError {
    /// Axes still move, or some commands that were read are not carried out yet.
    NotAtRest,
    /// The machine has no such axis, or the position is outside of ±100 000 mm or degrees.
    Range,
}

impl core::fmt::Display for PositionError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::NotAtRest => "a position is set at rest, when all blocks read are executed",
            Self::Range => "no such position; expected an axis of the machine, at most 100 000 mm or degrees",
        })
    }
}

impl core::error::Error for PositionError {}

/// The reason why the planner did not set a zero offset.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum ZeroOffsetError {
    /// Axes still move, or some commands that were read are not carried out yet.
    NotAtRest,
    /// The set is not 0…5, the machine has no such axis, or the offset is outside of ±100 000 mm or degrees.
    Range,
}

impl core::fmt::Display for ZeroOffsetError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::NotAtRest => "a zero offset is set at rest, when all blocks read are executed",
            Self::Range => {
                "no such zero offset; expected set 0…5, an axis of the machine, at most 100 000 mm or degrees"
            }
        })
    }
}

impl core::error::Error for ZeroOffsetError {}

impl<'a, T: Text, const AXES: usize, const BLOCKS: usize, F: FilterPlan<AXES>, const OVERLAYS: usize>
    Planner<'a, T, AXES, BLOCKS, F, OVERLAYS>
{
    /// Whether the axes stand and all commands read so far are carried out. Only then can [`Self::load`] and
    /// the other calls at rest succeed.
    pub fn is_at_rest(&self) -> bool {
        let reads = self.held.is_some() || !self.decoder.is_between_lines();
        #[cfg(feature = "plc")]
        let reads = reads || self.loops.repeat() || self.loops.read();
        !reads && self.planning.is_at_rest() && self.beside.is_free() && self.filters.is_settled()
    }

    /// Takes the next program and returns the previous text. The program begins where the axes stand, with modal state as at
    /// program start. The axes move only after the next call of [`Self::poll`].
    ///
    /// # Errors
    /// The channel is not at rest: the error returns the new text, and nothing changes.
    pub fn load(&mut self, text: T) -> Result<T, Busy<T>> {
        self.replace(text, false)
    }

    /// Takes single lines (MDI) and returns the previous text. Modal state stays in force; after an abort it is as at program
    /// start.
    ///
    /// # Errors
    /// The channel is not at rest: the error returns the new text, and nothing changes.
    pub fn continue_with(&mut self, text: T) -> Result<T, Busy<T>> {
        let keeps = !self.is_lost();
        self.replace(text, keeps)
    }

    /// Continues the same text with its next program, for a stream that contains several programs. The
    /// program before may have ended by itself, by a refused line or by an abort. Modal state is as at
    /// program start.
    ///
    /// # Errors
    /// The channel is not at rest; nothing changes.
    pub fn load_next(&mut self) -> Result<(), Busy<()>> {
        if !self.is_at_rest() {
            return Err(Busy { text: () });
        }
        self.begin(false);
        self.decoder.load_next(*self.planning.position());
        Ok(())
    }

    /// Continues after a refused line, from where the axes stand, with the modal state before that line.
    ///
    /// The refused line may have done a part of its work, in the order of execution. Example: a motion before
    /// a refused M00. This part stays done. If the curve of a corner was refused for a software limit, the
    /// axes stop inside the limits. The blocks that were read ahead are then skipped. With Surface, up to 64
    /// points are skipped, and the error names the place of the last point.
    ///
    /// # Errors
    /// The channel is not at rest, or no line was refused; nothing changes.
    pub fn go_on(&mut self) -> Result<(), GoOnError> {
        if self.is_lost() || !self.decoder.is_refused() {
            return Err(GoOnError::NothingRefused);
        }
        if !self.is_at_rest() {
            return Err(GoOnError::NotAtRest);
        }
        self.planning.begin();
        self.decoder.go_on(*self.planning.position());
        self.source = Source::Open;
        Ok(())
    }

    /// Gives an axis that stands still another position in machine coordinates, mm or degrees. No axis moves.
    /// Homing needs this.
    ///
    /// The interpolator shows the new set point from its next tick on; this tick returns [`crate::tick::State::Active`]
    /// with path speed 0. A board that counts increments must treat the difference as a shift of its origin, not as
    /// motion. Offsets and software limits do not change and apply to the new position.
    ///
    /// # Errors
    /// The channel is not at rest, or the position is out of range; nothing changes.
    pub fn set_position(&mut self, axis: usize, position: Position) -> Result<(), PositionError> {
        const MAX: Position = Position::const_from_int(COORDINATE_MAX as i64);
        if axis >= AXES || position > MAX || position < -MAX {
            return Err(PositionError::Range);
        }
        if !self.is_at_rest() {
            return Err(PositionError::NotAtRest);
        }
        // The filters stop before the interrupt can see the new position.
        self.filters.suspend();
        if !self.planning.set_position(axis, position) {
            return Err(PositionError::NotAtRest);
        }
        #[cfg(feature = "kinematics")]
        self.learn(axis, position);
        #[cfg(not(feature = "kinematics"))]
        self.decoder.set_position(axis, position);
        Ok(())
    }

    /// Sets the zero offset of one axis. `set` is 0…5 for G54…G59 (P-ZERO-00003), `offset` is in mm or
    /// degrees. The offset is valid from the next line on, also in the active set, and for all later
    /// programs. No axis moves.
    ///
    /// # Errors
    /// The channel is not at rest, or an argument is out of range; nothing changes.
    pub fn set_zero_offset(
        &mut self,
        set: usize,
        axis: usize,
        offset: Position,
    ) -> Result<(), ZeroOffsetError> {
        if !self.is_at_rest() {
            return Err(ZeroOffsetError::NotAtRest);
        }
        if self.decoder.set_zero_offset(set, axis, offset) { Ok(()) } else { Err(ZeroOffsetError::Range) }
    }

    /// The position of every axis at the end of the blocks read so far, in machine coordinates. At rest, this
    /// position is exactly the set point.
    pub fn position(&self) -> &[Position; AXES] {
        self.planning.position()
    }

    fn replace(&mut self, text: T, keeps: bool) -> Result<T, Busy<T>> {
        if !self.is_at_rest() {
            return Err(Busy { text });
        }
        self.begin(keeps);
        Ok(self.decoder.load(text, *self.planning.position(), keeps))
    }

    /// Begins another program.
    fn begin(&mut self, keeps: bool) {
        if !keeps {
            self.planning.restart();
            self.filters.restart();
            self.watch_filters();
            self.released = 0;
            #[cfg(feature = "plc")]
            self.planning.start_log();
        }
        self.forget_abort();
        self.planning.begin();
        self.source = Source::Open;
        self.lost = false;
    }

    /// Whether the modal state does not belong to the position of the axes. A pending abort counts too, so
    /// that the result does not depend on the time of the planner's next call.
    fn is_lost(&self) -> bool {
        self.lost || self.planning.commands().abort
    }

    /// Drops a pending abort. At rest there is no motion for an abort to end.
    pub(super) fn forget_abort(&mut self) {
        self.lost = self.is_lost();
        self.planning.forget_abort();
    }
}

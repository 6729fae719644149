//! At rest: the next program, single lines, another position for the same place, zero offsets.
//!
//! What is kept and what begins anew stands with [`Planner`].
use super::{Planner, Source};
use crate::fir::FilterPlan;
use crate::nc::{COORDINATE_MAX, Text};
use crate::quantity::Position;

/// A text was not taken: the axes do not stand with everything executed that was read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Busy<T> {
    /// The text, back.
    pub text: T,
}

impl<T> core::fmt::Display for Busy<T> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str("a program is loaded at rest, when all blocks read are executed")
    }
}

impl<T: core::fmt::Debug> core::error::Error for Busy<T> {}

/// Why the program did not go on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum GoOnError {
    /// Axes move or will move by blocks that are read already.
    NotAtRest,
    /// No line was refused, or the rest of the program was aborted since.
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

/// Why a position was not set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum PositionError {
    /// Axes move or will move by blocks that are read already.
    NotAtRest,
    /// The machine has no such axis, or the position is beyond ±100 000 mm or degrees.
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

/// Why a zero offset was not set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum ZeroOffsetError {
    /// Axes move or will move by blocks that are read already.
    NotAtRest,
    /// There are the sets 0…5 and the axes of the machine, and offsets to ±100 000 mm or degrees.
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
    /// Whether the axes stand with everything executed that was read: the calls of this page are taken.
    pub fn is_at_rest(&self) -> bool {
        let reads = self.held.is_some() || !self.decoder.is_between_lines();
        !reads && self.planning.is_at_rest() && self.beside.is_free() && self.filters.is_settled()
    }

    /// Takes the next program. It begins where the axes stand, with everything as at program start. The text
    /// before comes back. Nothing runs before the next call of [`Self::poll`].
    ///
    /// # Errors
    /// Not at rest: the text comes back, and nothing has changed.
    pub fn load(&mut self, text: T) -> Result<T, Busy<T>> {
        self.replace(text, false)
    }

    /// Takes single lines (MDI): another text, with everything in force as the last one left it. After an
    /// abort it begins as [`Self::load`] does. The text before comes back.
    ///
    /// # Errors
    /// Not at rest: the text comes back, and nothing has changed.
    pub fn continue_with(&mut self, text: T) -> Result<T, Busy<T>> {
        let keeps = !self.is_lost();
        self.replace(text, keeps)
    }

    /// Takes the next program of the same text, behind the one that has ended, or that a refused line or an
    /// abort has ended. It begins as with [`Self::load`]. For a stream that holds one program behind the
    /// other.
    ///
    /// # Errors
    /// Not at rest: nothing has changed.
    pub fn load_next(&mut self) -> Result<(), Busy<()>> {
        if !self.is_at_rest() {
            return Err(Busy { text: () });
        }
        self.begin(false);
        self.decoder.load_next(*self.planning.position());
        Ok(())
    }

    /// Goes on behind a refused line, from where the axes stand and with everything in force that was in
    /// force before that line. What the line would have done before the word refused, in the order of
    /// execution (an M00 behind a motion), stays done. Where the curve of a corner was refused for a software
    /// limit, the axes stand inside the limits, before its part that leads beyond; of what was read ahead of
    /// there nothing is executed. With Surface that is up to 64 points, and the place of the error is that of the last.
    ///
    /// # Errors
    /// Not at rest, or there is no such line: nothing has changed.
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

    /// Says that an axis stands at `position`, machine coordinates, where it is: nothing moves. The set point
    /// of the interrupt is the new one from its next tick on, a [`crate::tick::State::Active`] one at path
    /// speed 0; a board that counts increments takes the difference as a shift of its origin, not as motion.
    /// Offsets and software limits stay as they are, and count for the new position.
    ///
    /// # Errors
    /// Not at rest, or no such position: nothing has changed.
    pub fn set_position(&mut self, axis: usize, position: Position) -> Result<(), PositionError> {
        const MAX: Position = Position::const_from_int(COORDINATE_MAX as i64);
        if axis >= AXES || position > MAX || position < -MAX {
            return Err(PositionError::Range);
        }
        if !self.is_at_rest() {
            return Err(PositionError::NotAtRest);
        }
        // Before the interrupt may see it.
        self.filters.suspend();
        if !self.planning.set_position(axis, position) {
            return Err(PositionError::NotAtRest);
        }
        self.decoder.set_position(axis, position);
        Ok(())
    }

    /// Sets the offset of an axis in one of the zero offsets, 0…5 for G54…G59 (P-ZERO-00003, here mm or
    /// degrees). It counts from the next line on, also where that zero offset is in force, and for all
    /// programs that follow; nothing moves.
    ///
    /// # Errors
    /// Not at rest, or there is no such zero offset: nothing has changed.
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

    /// The position of every axis, machine coordinates, where the blocks read so far end. At rest it is the
    /// set point, to the last bit.
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

    /// Another program.
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

    /// Whether what is in force does not belong to where the axes stand. An abort that is not carried out yet
    /// counts: what follows does not depend on when the planner is called.
    fn is_lost(&self) -> bool {
        self.lost || self.planning.commands().abort
    }

    /// At rest: there is nothing in motion that an abort could end.
    pub(super) fn forget_abort(&mut self) {
        self.lost = self.is_lost();
        self.planning.forget_abort();
    }
}

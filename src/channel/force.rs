//! The decoder's modal words, offsets and stored positions, for an application that reports and restores
//! them.
use super::Planner;
use super::rest::Busy;
use crate::fir::FilterPlan;
use crate::nc::{InForce, Setup, StoredOffsets, Text};

impl<'a, T: Text, const AXES: usize, const BLOCKS: usize, F: FilterPlan<AXES>, const OVERLAYS: usize>
    Planner<'a, T, AXES, BLOCKS, F, OVERLAYS>
{
    /// Modal state after the lines read so far; `None` inside a line. Only for programs of dialects other
    /// than ISG's.
    pub fn in_force(&self) -> Option<InForce<AXES>> {
        if self.held.is_some() { None } else { self.decoder.in_force() }
    }

    /// Restores an earlier state, or [`InForce::START`]. The state is valid from the next line on. Motion
    /// that is already read does not change.
    ///
    /// # Errors
    /// A line is being read: nothing has changed.
    pub fn put_in_force(&mut self, force: &InForce<AXES>) -> Result<(), Busy<()>> {
        let is_put = self.held.is_none() && self.decoder.put_in_force(force);
        if is_put { Ok(()) } else { Err(Busy { text: () }) }
    }

    /// The value of a parameter after the lines read so far; `None` if it has no value. `text` names the
    /// parameter as a comment does, without `#`: `100`, `<name>`.
    #[cfg(feature = "dialects")]
    pub fn parameter(&self, text: &[u8]) -> Option<f64> {
        self.decoder.parameter(text)
    }

    /// The zero offsets and the positions for G28 and G30 that programs have stored.
    pub fn stored(&self) -> StoredOffsets<AXES> {
        self.decoder.stored()
    }

    /// Restores zero offsets and positions, which are then valid from the next line on. Returns `false`, and
    /// changes nothing, if a value is beyond ±100 000 mm.
    #[must_use]
    pub fn put_stored(&mut self, stored: &StoredOffsets<AXES>) -> bool {
        self.decoder.put_stored(stored)
    }

    /// The settings of the decoder. A second decoder with the same settings reads lines in the same way.
    pub fn setup(&self) -> &Setup<AXES> {
        self.decoder.setup()
    }
}

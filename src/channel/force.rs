//! What a controller shows of the decoder, and brings back: modal words, offsets, stored places.
use super::Planner;
use super::rest::Busy;
use crate::fir::FilterPlan;
use crate::nc::{InForce, Setup, StoredOffsets, Text};

impl<'a, T: Text, const AXES: usize, const BLOCKS: usize, F: FilterPlan<AXES>, const OVERLAYS: usize>
    Planner<'a, T, AXES, BLOCKS, F, OVERLAYS>
{
    /// What the lines read so far have put in force; `None` inside of a line. For programs of other dialects than
    /// ISG's.
    pub fn in_force(&self) -> Option<InForce<AXES>> {
        if self.held.is_some() { None } else { self.decoder.in_force() }
    }

    /// Puts in force what was so before, or [`InForce::START`]. It counts from the next line on; motion that is read
    /// already stays as it is.
    ///
    /// # Errors
    /// A line is at hand: nothing has changed.
    pub fn put_in_force(&mut self, force: &InForce<AXES>) -> Result<(), Busy<()>> {
        let is_put = self.held.is_none() && self.decoder.put_in_force(force);
        if is_put { Ok(()) } else { Err(Busy { text: () }) }
    }

    /// Zero offsets and the places of G28 and G30 as programs have stored them.
    pub fn stored(&self) -> StoredOffsets<AXES> {
        self.decoder.stored()
    }

    /// Zero offsets and places as they were before. They count from the next line on. `false`: one of them is beyond
    /// ±100 000 mm, and nothing has changed.
    #[must_use]
    pub fn put_stored(&mut self, stored: &StoredOffsets<AXES>) -> bool {
        self.decoder.put_stored(stored)
    }

    /// The set-up of the decoder, for another one that reads the same lines.
    pub fn setup(&self) -> &Setup<AXES> {
        self.decoder.setup()
    }
}

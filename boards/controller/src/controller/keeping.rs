//! Offsets and stored places go to the store when the axes stand still.
use super::{Around, Controller};
use crate::motion::{Motion, Offsets};
use crate::store::Store;
use glidepath::nc::StoredOffsets;

impl<const AXES: usize> Offsets<AXES> {
    /// What of them the store keeps.
    pub const fn stored(&self) -> StoredOffsets<AXES> {
        StoredOffsets { zero: self.systems, places: [self.g28, self.g30] }
    }
}

impl<const AXES: usize, const N: usize> Controller<'_, AXES, N> {
    /// Stores what a G10, G28.1 or G30.1 has changed, if nothing moves; whether the store has it. In motion nothing is
    /// stored, and `true`: the next standstill does it.
    pub(crate) fn store_offsets<M: Motion<AXES>, S: Store<AXES>, W: embedded_io::Write>(
        &mut self,
        around: &mut Around<'_, '_, M, S, W>,
    ) -> bool {
        let offsets = around.motion.offsets().stored();
        if offsets == self.kept {
            return true;
        }
        let status = around.motion.status();
        if !status.is_at_rest || status.is_busy {
            return true;
        }
        // Also where the store fails: it is told once, and not tried again in each poll.
        self.kept = offsets;
        around.store.offsets(&offsets)
    }

    /// The same for a change whose line has been answered.
    pub(super) fn keep_offsets<M: Motion<AXES>, S: Store<AXES>, W: embedded_io::Write>(
        &mut self,
        around: &mut Around<'_, '_, M, S, W>,
    ) {
        if !self.store_offsets(around) {
            around.out.line(format_args!("[MSG:work offsets are not stored]"));
        }
    }
}

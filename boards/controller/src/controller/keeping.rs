//! Stores work offsets and the positions of G28 and G30 in the parameter store, as soon as the axes stand
//! still.
use super::{Around, Controller};
use crate::motion::{Motion, Offsets};
use crate::store::Store;
use glidepath::nc::StoredOffsets;

impl<const AXES: usize> Offsets<AXES> {
    /// The values that the store has.
    pub const fn stored(&self) -> StoredOffsets<AXES> {
        StoredOffsets { zero: self.systems, places: [self.g28, self.g30] }
    }
}

impl<const AXES: usize, const N: usize> Controller<'_, AXES, N> {
    /// Stores a change of G10, G28.1 or G30.1 if no axis moves. Returns whether the store has the values.
    /// During motion the function stores nothing and returns `true`; the next standstill stores the values.
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
        // This also happens after a failure: the failure is reported once, without a further attempt in each
        // poll.
        self.kept = offsets;
        around.store.offsets(&offsets)
    }

    /// The same for a change whose line is already answered.
    pub(super) fn keep_offsets<M: Motion<AXES>, S: Store<AXES>, W: embedded_io::Write>(
        &mut self,
        around: &mut Around<'_, '_, M, S, W>,
    ) {
        if !self.store_offsets(around) {
            around.out.line(format_args!("[MSG:work offsets are not stored]"));
        }
    }
}

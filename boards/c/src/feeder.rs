//! The C functions for the context that receives program text.
use crate::WINDOW;
use crate::part::{Part, answer};
use crate::result::Outcome;
use core::slice;
use glidepath::nc;

/// The handle of the context that receives program text.
pub type FeederHandle = Part<nc::Feeder<'static, WINDOW>, 0x6665_6564>;

/// Puts up to `length` bytes of program text into the window. `taken` returns the number of accepted
/// bytes. Give the other bytes again later.
///
/// Context: any, one call at a time: a task, or the interrupt of a serial line. Time in proportion to
/// `length`. Returns GP_RESULT_NULL, CLOSED, IN_USE, RANGE (more than 2^31 bytes).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gp_feed(
    feeder: *mut FeederHandle,
    bytes: *const u8,
    length: usize,
    taken: *mut usize,
) -> Outcome {
    if bytes.is_null() || taken.is_null() {
        return Outcome::Null;
    }
    if length > i32::MAX as usize {
        return Outcome::Range;
    }
    // SAFETY: the pointers are not null and point to what they say.
    unsafe {
        Part::with(feeder, |feeder| answer(taken, feeder.push(slice::from_raw_parts(bytes, length)))).into()
    }
}

/// Marks the text as complete: the program ends after the last byte.
///
/// Context: as `gp_feed`. Returns GP_RESULT_NULL, CLOSED, IN_USE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gp_feed_end(feeder: *mut FeederHandle) -> Outcome {
    // SAFETY: the pointer is null or one of the handles.
    unsafe { Part::tell(feeder, |feeder| feeder.end()) }
}

/// Begins another program: text that is in the window and not read yet is dropped. The new text is read
/// from the next call of `gp_load_next` or `gp_load_window` on.
///
/// Context: as `gp_feed`. Returns GP_RESULT_NULL, CLOSED, IN_USE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gp_feed_restart(feeder: *mut FeederHandle) -> Outcome {
    // SAFETY: the pointer is null or one of the handles.
    unsafe { Part::tell(feeder, |feeder| feeder.restart()) }
}

//! The handle of whoever receives program text.
use crate::WINDOW;
use crate::part::{Part, answer};
use crate::result::Outcome;
use core::slice;
use glidepath::nc;

/// The handle of whoever receives program text.
pub type FeederHandle = Part<nc::Feeder<'static, WINDOW>, 0x6665_6564>;

/// Puts `length` bytes of program text into the window, as many as there is room for. `taken` says how many: the others are to
/// be given again.
///
/// Context: any, one at a time: a task, or the interrupt of a serial line. Time in proportion to `length`. Answers
/// GP_RESULT_NULL, CLOSED, IN_USE, RANGE (more than 2^31 bytes).
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

/// The text is complete: behind the last byte the program ends.
///
/// Context: as `gp_feed`. Answers GP_RESULT_NULL, CLOSED, IN_USE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gp_feed_end(feeder: *mut FeederHandle) -> Outcome {
    // SAFETY: the pointer is null or one of the handles.
    unsafe { Part::tell(feeder, |feeder| feeder.end()) }
}

/// Another program follows: text that was put in and is not read yet is dropped. It counts from `gp_load_next` or
/// `gp_load_window` on.
///
/// Context: as `gp_feed`. Answers GP_RESULT_NULL, CLOSED, IN_USE.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn gp_feed_restart(feeder: *mut FeederHandle) -> Outcome {
    // SAFETY: the pointer is null or one of the handles.
    unsafe { Part::tell(feeder, |feeder| feeder.restart()) }
}

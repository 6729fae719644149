//! A handle in the storage: its value, whether the handle is open, and whether a call with the handle is in
//! progress.
use crate::result::Outcome;
use core::cell::UnsafeCell;
use core::mem::MaybeUninit;
use core::sync::atomic::{AtomicU32, Ordering};

/// A handle of the C interface. `MARK` is the first field of every kind of handle and tells the kinds apart,
/// so a call with a handle of another kind reads only this field.
#[repr(C)]
pub struct Part<T, const MARK: u32> {
    mark: AtomicU32,
    is_in_use: AtomicU32,
    value: UnsafeCell<MaybeUninit<T>>,
}

impl<T, const MARK: u32> Part<T, MARK> {
    /// Opens the handle.
    ///
    /// # Safety
    /// `part` is memory for one, which nobody uses.
    pub unsafe fn open(part: *mut Self, value: T) {
        // SAFETY: the caller says so.
        unsafe {
            (&raw mut (*part).value).cast::<T>().write(value);
            (&raw mut (*part).is_in_use).write(AtomicU32::new(0));
        }
        // SAFETY: the same; all other fields are written.
        unsafe { (*part).mark.store(MARK, Ordering::Release) };
    }

    /// Closes the handle: later calls are refused.
    ///
    /// # Safety
    /// `part` was opened.
    pub unsafe fn close(part: *mut Self) {
        // SAFETY: the caller says so.
        unsafe { (*part).mark.store(0, Ordering::Release) };
    }

    /// Whether a call is in progress.
    pub fn is_in_use(&self) -> bool {
        self.is_in_use.load(Ordering::Acquire) != 0
    }

    /// Calls a function with the value.
    ///
    /// A context that interrupts another one inside such a call is refused. If two cores call at the
    /// same time, the check may fail, so a handle must belong to one core.
    ///
    /// # Errors
    /// A null pointer, a handle that is not open, one that is in use, or what `act` says.
    ///
    /// # Safety
    /// `part` is null or points to memory of a storage.
    pub unsafe fn with(
        part: *mut Self,
        act: impl FnOnce(&mut T) -> Result<(), Outcome>,
    ) -> Result<(), Outcome> {
        if part.is_null() {
            return Err(Outcome::Null);
        }
        // SAFETY: the caller says so.
        let this = unsafe { &*part };
        if this.mark.load(Ordering::Acquire) != MARK {
            return Err(Outcome::Closed);
        }
        // No compare-and-swap, because small cores do not have it. A context that interrupts between these
        // two lines ends its call before they continue.
        if this.is_in_use.load(Ordering::Acquire) != 0 {
            return Err(Outcome::InUse);
        }
        this.is_in_use.store(1, Ordering::Relaxed);
        core::sync::atomic::compiler_fence(Ordering::SeqCst);
        // SAFETY: it is open, so it has a value, and nobody else is in here.
        let result = act(unsafe { &mut *this.value.get().cast::<T>() });
        this.is_in_use.store(0, Ordering::Release);
        result
    }

    /// The same for a function that cannot fail.
    ///
    /// # Safety
    /// As [`Self::with`].
    pub unsafe fn tell(part: *mut Self, act: impl FnOnce(&mut T)) -> Outcome {
        // SAFETY: the caller says so.
        unsafe {
            Self::with(part, |value| {
                act(value);
                Ok(())
            })
        }
        .into()
    }
}

/// Writes a result to the caller's memory.
///
/// # Errors
/// A null pointer.
///
/// # Safety
/// `to` is null or points to memory for one.
pub unsafe fn answer<T>(to: *mut T, value: T) -> Result<(), Outcome> {
    if to.is_null() {
        return Err(Outcome::Null);
    }
    // SAFETY: the caller says so.
    unsafe { to.write(value) };
    Ok(())
}

//! Words that planner, interrupt and operator share, each with one writer, and places whose data pass from
//! one owner to the next. All rings of the queue are made of such words and places.
//!
//! On the target, [`Memory`] is real memory. A test replaces it by a memory that records every access. The
//! test then runs the code of the target in every order of these accesses.
#![allow(unsafe_code)]
use super::Slot;
use core::cell::UnsafeCell;
use core::sync::atomic::{self, AtomicU32, Ordering};

/// A word of shared memory. One side writes the word; all sides may read it.
pub trait Word: Sync {
    /// The word with the value 0.
    const ZERO: Self;

    /// The value of the word.
    fn load(&self, order: Ordering) -> u32;

    /// Sets a new value. Only the writing side calls this function.
    fn store(&self, value: u32, order: Ordering);
}

/// A place of a ring in shared memory. Counters outside of it say which side owns the place.
pub trait Place<T: Slot>: Sized {
    /// An unused place.
    const BLANK: Self;

    /// Reads the place.
    ///
    /// # Safety
    /// No other side writes the place during the call.
    unsafe fn read<R>(&self, take: impl FnOnce(&T) -> R) -> R;

    /// Writes the place.
    ///
    /// # Safety
    /// No other side reads or writes the place during the call.
    unsafe fn write(&self, fill: impl FnOnce(&mut T));

    /// The address of the place, for a reference that outlives the call.
    fn get(&self) -> *mut T;
}

/// A kind of shared memory: its words, its places, and the order of accesses. Firmware uses [`Ram`]; tests
/// use a kind that tries all orders.
pub trait Memory {
    /// A word.
    type Word: Word;
    /// A place.
    type Place<T: Slot>: Place<T>;

    /// A fence, as [`core::sync::atomic::fence`].
    fn fence(order: Ordering);

    /// Waits until `is_over` returns `true`. Another side causes the change.
    fn wait(is_over: impl FnMut() -> bool);
}

/// Marks a memory whose accesses a test can repeat; the handles of its rings may be copied. The memory of a
/// target never has this trait.
pub trait Replay: Memory {}

/// The shared memory of real firmware: atomics and cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Ram;

impl Memory for Ram {
    type Word = AtomicU32;
    type Place<T: Slot> = UnsafeCell<T>;

    #[inline(always)]
    fn fence(order: Ordering) {
        atomic::fence(order);
    }

    #[inline(always)]
    fn wait(mut is_over: impl FnMut() -> bool) {
        while !is_over() {
            core::hint::spin_loop();
        }
    }
}

impl Word for AtomicU32 {
    #[allow(clippy::declare_interior_mutable_const)]
    const ZERO: Self = Self::new(0);

    #[inline(always)]
    fn load(&self, order: Ordering) -> u32 {
        self.load(order)
    }

    #[inline(always)]
    fn store(&self, value: u32, order: Ordering) {
        self.store(value, order);
    }
}

impl<T: Slot> Place<T> for UnsafeCell<T> {
    #[allow(clippy::declare_interior_mutable_const)]
    const BLANK: Self = Self::new(T::BLANK);

    #[inline(always)]
    unsafe fn read<R>(&self, take: impl FnOnce(&T) -> R) -> R {
        // SAFETY: the caller guarantees that no other side writes the place.
        take(unsafe { &*self.get() })
    }

    #[inline(always)]
    unsafe fn write(&self, fill: impl FnOnce(&mut T)) {
        // SAFETY: the caller guarantees that no other side uses the place.
        fill(unsafe { &mut *self.get() });
    }

    #[inline(always)]
    fn get(&self) -> *mut T {
        self.get()
    }
}

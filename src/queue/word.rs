//! What planner, interrupt and operator share: words, each written by one of them, and places that pass from
//! one to the other.
//!
//! Everything behind [`Memory`] is what the target has. A test puts a memory of its own in its place: it sees
//! every access of the code that runs on the target, and runs that code in every order of them.
#![allow(unsafe_code)]
use super::Slot;
use core::cell::UnsafeCell;
use core::sync::atomic::{self, AtomicU32, Ordering};

/// A word. One side writes it, all may read it.
pub trait Word: Sync {
    /// 0.
    const ZERO: Self;

    /// Its value.
    fn load(&self, order: Ordering) -> u32;

    /// Its new value, from the side that writes it.
    fn store(&self, value: u32, order: Ordering);
}

/// A place of a ring. Counters say whose it is.
pub trait Place<T: Slot>: Sized {
    /// An unused one.
    const BLANK: Self;

    /// Reads it.
    ///
    /// # Safety
    /// No other side writes it meanwhile.
    unsafe fn read<R>(&self, take: impl FnOnce(&T) -> R) -> R;

    /// Writes it.
    ///
    /// # Safety
    /// No other side reads or writes it meanwhile.
    unsafe fn write(&self, fill: impl FnOnce(&mut T));

    /// Where it is, for a reference that outlives the call.
    fn get(&self) -> *mut T;
}

/// Words, places, and what orders the accesses to them.
pub trait Memory {
    /// A word.
    type Word: Word;
    /// A place.
    type Place<T: Slot>: Place<T>;

    /// As [`core::sync::atomic::fence`].
    fn fence(order: Ordering);

    /// Waits until another side has come so far.
    fn wait(is_over: impl FnMut() -> bool);
}

/// A memory whose accesses can be made again: the ends of what lies in it may be copied. Never that of a
/// target.
pub trait Replay: Memory {}

/// Atomics and cells.
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
        // SAFETY: nobody writes it meanwhile, says the caller.
        take(unsafe { &*self.get() })
    }

    #[inline(always)]
    unsafe fn write(&self, fill: impl FnOnce(&mut T)) {
        // SAFETY: nobody else has it, says the caller.
        fill(unsafe { &mut *self.get() });
    }

    #[inline(always)]
    fn get(&self) -> *mut T {
        self.get()
    }
}

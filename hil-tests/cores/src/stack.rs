//! How deep the stack was: what is left of the paint on it.
use core::hint::black_box;
use core::ptr::addr_of;

const PAINT: u32 = 0xcccc_cccc;
/// Bytes below the caller's frame that its own calls may be using.
const NEAR: usize = 256;

unsafe extern "C" {
    /// Lowest address of the stack, and the address above its highest one: linker script.
    static _stack_end: u32;
    static _stack_start: u32;
}

/// Paints what is free of the stack.
#[inline(never)]
pub fn paint() {
    let here = black_box(0u32);
    let top = addr_of!(here).addr().saturating_sub(NEAR);
    let mut at = addr_of!(_stack_end).cast_mut();
    while at.addr() < top {
        // SAFETY: words of the stack below all frames; no interrupt is on.
        unsafe { at.write_volatile(PAINT) };
        at = at.wrapping_add(1);
    }
}

/// Bytes of the stack that were in use since [`paint`].
pub fn depth() -> usize {
    let (mut at, start) = (addr_of!(_stack_end), addr_of!(_stack_start).addr());
    // SAFETY: words of the stack; this function ends at the first that was in use.
    while at.addr() < start && unsafe { at.read_volatile() } == PAINT {
        at = at.wrapping_add(1);
    }
    start - at.addr()
}

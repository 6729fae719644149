//! How deep the stack was: what is left of the paint that the start-up code puts on it.
use core::ptr::addr_of;
use cortex_m_rt::STACK_PAINT_VALUE;

unsafe extern "C" {
    /// Lowest address of the stack, the address above its highest one, and the same of static memory: linker script.
    static _stack_end: u32;
    static _stack_start: u32;
    static _ram_start: u32;
    static __euninit: u32;
}

/// Bytes of stack, and how many of them were in use at a time since the start.
pub fn depth() -> (usize, usize) {
    let (end, start) = (addr_of!(_stack_end), addr_of!(_stack_start).addr());
    let mut free = end;
    // SAFETY: words of the stack, of which the lowest ones are in use by nobody: this function ends at the first that was.
    while free.addr() < start && unsafe { free.read_volatile() } == STACK_PAINT_VALUE {
        free = free.wrapping_add(1);
    }
    (start - end.addr(), start - free.addr())
}

/// Bytes of static memory of this binary.
pub fn statics() -> usize {
    addr_of!(__euninit).addr() - addr_of!(_ram_start).addr()
}

/// Whether `stack`, a stack pointer, is below the stack.
pub fn is_below(stack: usize) -> bool {
    stack < addr_of!(_stack_end).addr() + core::mem::size_of::<cortex_m_rt::ExceptionFrame>()
}

//! How deep the stack was: what is left of the paint that the start-up code puts on it.
use core::ptr::addr_of;
use cortex_m::register::msp;
use cortex_m_rt::STACK_PAINT_VALUE;

unsafe extern "C" {
    /// Lowest address of the stack, the address above its highest one, and the same of static memory: linker
    /// script.
    static _stack_end: u32;
    static _stack_start: u32;
    static _ram_start: u32;
    static __euninit: u32;
}

/// Bytes of stack, and how many of them were in use at a time since the start.
pub fn depth() -> (usize, usize) {
    let (end, start) = (addr_of!(_stack_end), addr_of!(_stack_start).addr());
    let mut free = end;
    // SAFETY: words of the stack, of which the lowest ones are in use by nobody: this function ends at the
    // first that was.
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

/// How deep some calls go below the one that watches them.
#[derive(Clone, Copy, Default)]
pub struct Watched {
    /// Bytes at the deepest.
    pub deepest: usize,
    from: usize,
}

impl Watched {
    /// Paints what is free of the stack, at most `bytes` of it, before a call.
    #[inline(always)]
    pub fn paint(&mut self, bytes: usize) {
        self.from = msp::read() as usize;
        let mut at = self.below(bytes);
        while at < self.from {
            // SAFETY: a word of the stack below all frames, in which no interrupt comes.
            unsafe { (at as *mut u32).write_volatile(STACK_PAINT_VALUE) };
            at += 4;
        }
    }

    /// Looks behind the call, in the function that painted, how much of that was in use.
    #[inline(always)]
    pub fn look(&mut self, bytes: usize) {
        let mut at = self.below(bytes);
        // SAFETY: as above.
        while at < self.from && unsafe { (at as *const u32).read_volatile() } == STACK_PAINT_VALUE {
            at += 4;
        }
        self.deepest = self.deepest.max(self.from - at);
    }

    #[inline(always)]
    fn below(&self, bytes: usize) -> usize {
        self.from.saturating_sub(bytes).max(addr_of!(_stack_end).addr()) & !3
    }
}

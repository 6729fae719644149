//! A free-running counter. How many counts an instruction takes depends on the machine; the first lines of a report show it.

#[cfg(target_arch = "arm")]
mod core_timer {
    const CONTROL: *mut u32 = 0xe000_e010 as *mut u32;
    const RELOAD: *mut u32 = 0xe000_e014 as *mut u32;
    const CURRENT: *mut u32 = 0xe000_e018 as *mut u32;
    /// SysTick has 24 bits and counts down.
    pub const MASK: u32 = 0x00ff_ffff;

    /// Starts SysTick on the core's clock, without its interrupt.
    pub fn start() {
        // SAFETY: SysTick's registers, which every core of this kind has; nothing else uses them.
        unsafe {
            RELOAD.write_volatile(MASK);
            CURRENT.write_volatile(0);
            CONTROL.write_volatile(0b101);
        }
    }

    #[inline(always)]
    pub fn now() -> u32 {
        // SAFETY: reading the register has no effect on what runs.
        unsafe { CURRENT.read_volatile() }.wrapping_neg()
    }

    /// Readings before and behind a loop of two instructions, or of nothing.
    #[inline(never)]
    pub fn around(times: u32) -> (u32, u32) {
        let (before, after): (u32, u32);
        // SAFETY: reads SysTick and counts down. One piece of assembly, so that nothing moves in between.
        unsafe {
            core::arch::asm!(
                "ldr {before}, [{register}]",
                "2:",
                "subs {times}, #1",
                "bne 2b",
                "ldr {after}, [{register}]",
                register = in(reg) CURRENT, times = inout(reg) times => _,
                before = out(reg) before, after = out(reg) after,
            );
        }
        (before.wrapping_neg(), after.wrapping_neg())
    }

    #[inline(never)]
    pub fn around_nothing() -> (u32, u32) {
        let (before, after): (u32, u32);
        // SAFETY: as above.
        unsafe {
            core::arch::asm!(
                "ldr {before}, [{register}]", "ldr {after}, [{register}]",
                register = in(reg) CURRENT, before = out(reg) before, after = out(reg) after,
            );
        }
        (before.wrapping_neg(), after.wrapping_neg())
    }
}

#[cfg(target_arch = "riscv32")]
mod core_timer {
    pub const MASK: u32 = u32::MAX;

    pub fn start() {}

    #[inline(always)]
    pub fn now() -> u32 {
        let now: u32;
        // SAFETY: reads a counter.
        unsafe { core::arch::asm!("csrr {}, minstret", out(reg) now, options(nostack)) };
        now
    }

    #[inline(never)]
    pub fn around(times: u32) -> (u32, u32) {
        let (before, after): (u32, u32);
        // SAFETY: reads a counter and counts down.
        unsafe {
            core::arch::asm!(
                "csrr {before}, minstret",
                "2:",
                "addi {times}, {times}, -1",
                "bnez {times}, 2b",
                "csrr {after}, minstret",
                times = inout(reg) times => _, before = out(reg) before, after = out(reg) after,
            );
        }
        (before, after)
    }

    #[inline(never)]
    pub fn around_nothing() -> (u32, u32) {
        let (before, after): (u32, u32);
        // SAFETY: as above.
        unsafe {
            core::arch::asm!(
                "csrr {before}, minstret", "csrr {after}, minstret",
                before = out(reg) before, after = out(reg) after,
            );
        }
        (before, after)
    }
}

pub(crate) use core_timer::start;

/// The count; it runs up and wraps.
#[inline(always)]
pub fn now() -> u32 {
    core_timer::now()
}

/// Counts between two readings, less than 2^24 apart on ARM.
#[inline(always)]
pub fn elapsed(before: u32, now: u32) -> u32 {
    now.wrapping_sub(before) & core_timer::MASK
}

/// Counts around a loop of two instructions that runs so many times, at least once.
pub fn around(times: u32) -> u32 {
    let (before, after) = core_timer::around(times);
    elapsed(before, after)
}

/// Counts of two readings in a row.
pub fn around_nothing() -> u32 {
    let (before, after) = core_timer::around_nothing();
    elapsed(before, after)
}

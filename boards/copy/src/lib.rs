//! Copies of memory for Cortex-M3 and up, four words at a time.
//!
//! The compiler calls these functions of the ARM run-time ABI (IHI 0043, 4.3.4) where it copies a structure.
//! Those that come with it copy a word in five instructions; these copy four words in four. They are taken
//! instead where this crate is linked: the others are weak.
#![no_std]

#[cfg(target_arch = "arm")]
mod aligned {
    use core::arch::naked_asm;

    /// Copies `r2` bytes from `r1` to `r0`, both multiples of four, upward. Blocks may overlap where the
    /// destination is lower.
    #[unsafe(naked)]
    #[unsafe(no_mangle)]
    unsafe extern "C" fn __aeabi_memcpy4() {
        naked_asm!(
            "subs r2, #16",
            "blo 2f",
            "push {{r4, r5, r6, lr}}",
            "1:",
            "ldm r1!, {{r3, r4, r5, r6}}",
            "stm r0!, {{r3, r4, r5, r6}}",
            "subs r2, #16",
            "bhs 1b",
            "pop {{r4, r5, r6, lr}}",
            // What is left, less 16: its bits 3 and 2 become carry and sign, then its bits 1 and 0.
            "2:",
            "lsls r3, r2, #29",
            "itt cs",
            "ldmcs r1!, {{r3, r12}}",
            "stmcs r0!, {{r3, r12}}",
            "itt mi",
            "ldrmi r3, [r1], #4",
            "strmi r3, [r0], #4",
            "lsls r2, r2, #31",
            "itt cs",
            "ldrhcs r3, [r1], #2",
            "strhcs r3, [r0], #2",
            "itt mi",
            "ldrbmi r3, [r1]",
            "strbmi r3, [r0]",
            "bx lr",
        )
    }

    /// The same, both multiples of eight.
    #[unsafe(naked)]
    #[unsafe(no_mangle)]
    unsafe extern "C" fn __aeabi_memcpy8() {
        naked_asm!("b {}", sym __aeabi_memcpy4)
    }

    /// The same; whether they are multiples of four is seen only here.
    #[unsafe(naked)]
    #[unsafe(no_mangle)]
    unsafe extern "C" fn __aeabi_memcpy() {
        naked_asm!("orr r3, r0, r1", "lsls r3, r3, #30", "beq {}", "b memcpy", sym __aeabi_memcpy4)
    }

    /// The same, where blocks may overlap.
    #[unsafe(naked)]
    #[unsafe(no_mangle)]
    unsafe extern "C" fn __aeabi_memmove4() {
        naked_asm!("subs r3, r0, r1", "cmp r3, r2", "bhs {}", "b memmove", sym __aeabi_memcpy4)
    }

    /// The same, both multiples of eight.
    #[unsafe(naked)]
    #[unsafe(no_mangle)]
    unsafe extern "C" fn __aeabi_memmove8() {
        naked_asm!("b {}", sym __aeabi_memmove4)
    }
}

//! Functions that copy and clear memory for Cortex-M3 and higher, eight words at a time.
//!
//! The compiler calls these functions of the ARM run-time ABI (IHI 0043, 4.3.4) to copy or to clear a
//! structure. The compiler's own functions copy a word in five instructions, and clear a word in four. The
//! functions of this crate copy eight words in four instructions and clear four words in four instructions,
//! and are a kilobyte smaller. The linker takes these functions, because the compiler's functions are weak.
//!
//! Unaligned words are read and written directly. These cores permit this, unless CCR.UNALIGN_TRP is set; the
//! compiler's own code relies on the same. For ARMv6-M the crate has copies only, which read no unaligned word.
#![no_std]

#[cfg(all(target_arch = "arm", narrow))]
mod narrow;

#[cfg(all(target_arch = "arm", not(narrow)))]
mod eabi {
    use core::arch::naked_asm;

    // r0: destination, r1: source, r2: number of bytes. r3, r12 and the flags are free.

    /// Both addresses are multiples of four.
    #[unsafe(naked)]
    #[unsafe(no_mangle)]
    unsafe extern "C" fn __aeabi_memcpy4() {
        naked_asm!(
            "subs r2, #32",
            "blo 2f",
            "push {{r4, r5, r6, r7, r8, r9, r10}}",
            "1:",
            "ldm r1!, {{r3, r4, r5, r6, r7, r8, r9, r10}}",
            "stm r0!, {{r3, r4, r5, r6, r7, r8, r9, r10}}",
            "subs r2, #32",
            "bhs 1b",
            "pop {{r4, r5, r6, r7, r8, r9, r10}}",
            // Less 32 the rest has the same lower bits: 4 and 3 become carry and sign, then 2 the sign, then 1 and 0 both.
            "2:",
            "lsls r3, r2, #28",
            "itttt cs",
            "ldmcs r1!, {{r3, r12}}",
            "stmcs r0!, {{r3, r12}}",
            "ldmcs r1!, {{r3, r12}}",
            "stmcs r0!, {{r3, r12}}",
            "itt mi",
            "ldmmi r1!, {{r3, r12}}",
            "stmmi r0!, {{r3, r12}}",
            "lsls r3, r2, #29",
            "it eq",
            "bxeq lr",
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

    /// Both addresses are multiples of eight.
    #[unsafe(naked)]
    #[unsafe(no_mangle)]
    unsafe extern "C" fn __aeabi_memcpy8() {
        naked_asm!("b {}", sym __aeabi_memcpy4)
    }

    /// Any addresses: a word in four instructions if not both are multiples of four.
    #[unsafe(naked)]
    #[unsafe(no_mangle)]
    unsafe extern "C" fn __aeabi_memcpy() {
        naked_asm!(
            "orr r3, r0, r1",
            "lsls r3, r3, #30",
            "beq {}",
            "subs r2, #4",
            "blo 2f",
            "1:",
            "ldr r3, [r1], #4",
            "str r3, [r0], #4",
            "subs r2, #4",
            "bhs 1b",
            "2:",
            "lsls r2, r2, #31",
            "itt cs",
            "ldrhcs r3, [r1], #2",
            "strhcs r3, [r0], #2",
            "itt mi",
            "ldrbmi r3, [r1]",
            "strbmi r3, [r0]",
            "bx lr",
            sym __aeabi_memcpy4,
        )
    }

    /// Any addresses, and both ranges may overlap. If the destination begins inside the source, the copy runs
    /// from the end down; otherwise it runs upward, which is also right for a destination below the source.
    #[unsafe(naked)]
    #[unsafe(no_mangle)]
    unsafe extern "C" fn __aeabi_memmove() {
        naked_asm!(
            "subs r3, r0, r1",
            "cmp r3, r2",
            "bhs {}",
            "add r0, r2",
            "add r1, r2",
            "subs r2, #4",
            "blo 2f",
            "1:",
            "ldr r3, [r1, #-4]!",
            "str r3, [r0, #-4]!",
            "subs r2, #4",
            "bhs 1b",
            "2:",
            "lsls r2, r2, #31",
            "itt cs",
            "ldrhcs r3, [r1, #-2]!",
            "strhcs r3, [r0, #-2]!",
            "itt mi",
            "ldrbmi r3, [r1, #-1]",
            "strbmi r3, [r0, #-1]",
            "bx lr",
            sym __aeabi_memcpy,
        )
    }

    /// Both addresses are multiples of four.
    #[unsafe(naked)]
    #[unsafe(no_mangle)]
    unsafe extern "C" fn __aeabi_memmove4() {
        naked_asm!("b {}", sym __aeabi_memmove)
    }

    /// Both addresses are multiples of eight.
    #[unsafe(naked)]
    #[unsafe(no_mangle)]
    unsafe extern "C" fn __aeabi_memmove8() {
        naked_asm!("b {}", sym __aeabi_memmove)
    }

    // r0: destination, r1: number of bytes. r2, r3, r12 and the flags are free.

    /// The address is a multiple of four.
    #[unsafe(naked)]
    #[unsafe(no_mangle)]
    unsafe extern "C" fn __aeabi_memclr4() {
        naked_asm!(
            "movs r2, #0",
            "movs r3, #0",
            "subs r1, #16",
            "blo 2f",
            "1:",
            "stm r0!, {{r2, r3}}",
            "stm r0!, {{r2, r3}}",
            "subs r1, #16",
            "bhs 1b",
            // The lower bits of the rest as above.
            "2:",
            "lsls r12, r1, #29",
            "it cs",
            "stmcs r0!, {{r2, r3}}",
            "it mi",
            "strmi r2, [r0], #4",
            "lsls r1, r1, #31",
            "it cs",
            "strhcs r2, [r0], #2",
            "it mi",
            "strbmi r2, [r0]",
            "bx lr",
        )
    }

    /// The address is a multiple of eight.
    #[unsafe(naked)]
    #[unsafe(no_mangle)]
    unsafe extern "C" fn __aeabi_memclr8() {
        naked_asm!("b {}", sym __aeabi_memclr4)
    }

    /// Any address.
    #[unsafe(naked)]
    #[unsafe(no_mangle)]
    unsafe extern "C" fn __aeabi_memclr() {
        naked_asm!(
            "lsls r3, r0, #30",
            "beq {}",
            "movs r2, #0",
            "subs r1, #4",
            "blo 2f",
            "1:",
            "str r2, [r0], #4",
            "subs r1, #4",
            "bhs 1b",
            "2:",
            "lsls r1, r1, #31",
            "it cs",
            "strhcs r2, [r0], #2",
            "it mi",
            "strbmi r2, [r0]",
            "bx lr",
            sym __aeabi_memclr4,
        )
    }
}

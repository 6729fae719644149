//! Copies for ARMv6-M: four words in four instructions, and an unaligned byte in four.
use core::arch::naked_asm;

/// Any addresses; behind it with addresses that are multiples of four or of eight. r0: destination, r1: source,
/// r2: number of bytes.
#[unsafe(naked)]
#[unsafe(no_mangle)]
unsafe extern "C" fn __aeabi_memcpy() {
    naked_asm!(
        "movs r3, r0",
        "orrs r3, r1",
        "lsls r3, r3, #30",
        "bne 5f",
        ".globl __aeabi_memcpy4",
        ".type __aeabi_memcpy4, %function",
        ".thumb_func",
        "__aeabi_memcpy4:",
        ".globl __aeabi_memcpy8",
        ".type __aeabi_memcpy8, %function",
        ".thumb_func",
        "__aeabi_memcpy8:",
        "subs r2, #16",
        "blo 2f",
        "push {{r4, r5, r6}}",
        "1:",
        "ldm r1!, {{r3, r4, r5, r6}}",
        "stm r0!, {{r3, r4, r5, r6}}",
        "subs r2, #16",
        "bhs 1b",
        "pop {{r4, r5, r6}}",
        // Less 16 the rest has the same lower bits: 3 and 2 become carry and sign.
        "2:",
        "lsls r3, r2, #29",
        "bcc 3f",
        "ldm r1!, {{r3}}",
        "stm r0!, {{r3}}",
        "ldm r1!, {{r3}}",
        "stm r0!, {{r3}}",
        "3:",
        "bpl 4f",
        "ldm r1!, {{r3}}",
        "stm r0!, {{r3}}",
        "4:",
        "lsls r2, r2, #30",
        "lsrs r2, r2, #30",
        // Bytes, from the last to the first.
        "5:",
        "subs r2, #1",
        "blo 7f",
        "6:",
        "ldrb r3, [r1, r2]",
        "strb r3, [r0, r2]",
        "subs r2, #1",
        "bhs 6b",
        "7:",
        "bx lr",
    )
}

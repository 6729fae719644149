//! Functions in assembly for ARMv6-M: the common case of each; the functions of Rust do the rest.
//!
//! A mantissa stands with its first bit in bit 31 here. A sum, a product or an integer is shifted to its place
//! in the result; the last bit that falls out is the carry, and `adcs` rounds by it. That rounds ties up, so
//! the end of each function clears the last bit of a tie.
use crate::single::{RECIPROCALS, add, beyond, div, lift, mul};
use core::arch::naked_asm;

extern "C" fn any_sum(a: u32, b: u32) -> u32 {
    add(a, b)
}

extern "C" fn any_product(a: u32, b: u32) -> u32 {
    mul(a, b)
}

extern "C" fn any_quotient(a: u32, b: u32) -> u32 {
    div(a, b)
}

extern "C" fn out_of_range(sign: u32, exponent: i32, mantissa: u32) -> u32 {
    beyond(sign, exponent, mantissa)
}

/// a − b; behind it a + b, and b − a: 36 to 60 instructions.
#[unsafe(naked)]
#[unsafe(no_mangle)]
extern "C" fn __aeabi_fsub() {
    naked_asm!(
        "movs r2, #1",
        "lsls r2, r2, #31",
        "eors r1, r2",
        ".globl __aeabi_fadd",
        ".type __aeabi_fadd, %function",
        ".thumb_func",
        "__aeabi_fadd:",
        "lsls r2, r0, #1",
        "lsls r3, r1, #1",
        "cmp r2, r3",
        "bhs 1f",
        // The larger one first.
        "eors r0, r1",
        "eors r1, r0",
        "eors r0, r1",
        "lsls r2, r0, #1",
        "lsls r3, r1, #1",
        // r2, r3: exponents.
        "1:",
        "lsrs r3, r3, #24",
        "beq 20f",
        "lsrs r2, r2, #24",
        "cmp r2, #255",
        "beq 22f",
        "subs r3, r2, r3",
        "cmp r3, #25",
        "bhi 14f",
        "push {{r4, r5}}",
        "movs r4, #128",
        "lsls r4, r4, #24",
        // r5: the mantissa of the smaller one, at its place below that of the larger one.
        "lsls r5, r1, #8",
        "orrs r5, r4",
        "cmp r3, #8",
        "bhi 15f",
        "lsrs r5, r5, r3",
        "2:",
        "lsls r3, r0, #8",
        "orrs r3, r4",
        "eors r1, r0",
        "bmi 10f",
        "adds r3, r3, r5",
        "bcs 17f",
        "lsls r3, r3, #1",
        // r0: sign and exponent of the result. r3: what follows the first bit, and nine bits below.
        "3:",
        "lsrs r0, r0, #23",
        "lsls r0, r0, #23",
        "4:",
        "lsls r1, r3, #23",
        "lsrs r3, r3, #9",
        "adcs r0, r3",
        "cmp r1, r4",
        "beq 5f",
        "pop {{r4, r5}}",
        "bx lr",
        "5:",
        "lsrs r0, r0, #1",
        "lsls r0, r0, #1",
        "pop {{r4, r5}}",
        "bx lr",
        // Different signs.
        "10:",
        "subs r3, r3, r5",
        "bpl 11f",
        "lsls r3, r3, #1",
        "b 3b",
        "11:",
        "beq 19f",
        "12:",
        "lsrs r1, r3, #19",
        "bne 13f",
        "lsls r3, r3, #12",
        "subs r2, #12",
        "b 12b",
        "13:",
        "subs r2, #1",
        "lsls r3, r3, #1",
        "bpl 13b",
        "lsrs r0, r0, #31",
        "cmp r2, #0",
        "ble 18f",
        "lsls r0, r0, #8",
        "orrs r0, r2",
        "lsls r0, r0, #23",
        "lsls r3, r3, #1",
        "b 4b",
        "14:",
        "bx lr",
        // Bits of the smaller one may fall out.
        "15:",
        "mov r12, r5",
        "lsrs r5, r5, r3",
        "mov r4, r5",
        "lsls r4, r4, r3",
        "cmp r4, r12",
        "beq 16f",
        "movs r4, #1",
        "orrs r5, r4",
        "16:",
        "movs r4, #128",
        "lsls r4, r4, #24",
        "b 2b",
        // A carry: the next exponent.
        "17:",
        "movs r1, #1",
        "lsls r1, r1, #23",
        "adds r0, r0, r1",
        "cmp r2, #254",
        "bne 3b",
        "lsrs r0, r0, #23",
        "lsls r0, r0, #23",
        "pop {{r4, r5}}",
        "bx lr",
        // A subnormal difference, which is exact.
        "18:",
        "lsls r0, r0, #31",
        "movs r1, #1",
        "subs r1, r1, r2",
        "lsrs r3, r3, r1",
        "lsrs r3, r3, #8",
        "orrs r0, r3",
        "pop {{r4, r5}}",
        "bx lr",
        "19:",
        "movs r0, #0",
        "pop {{r4, r5}}",
        "bx lr",
        // The smaller one is 0, or subnormal.
        "20:",
        "lsls r3, r1, #1",
        "bne 22f",
        "lsls r3, r0, #1",
        "beq 21f",
        "bx lr",
        "21:",
        "ands r0, r1",
        "bx lr",
        "22:",
        "push {{r3, lr}}",
        "bl {any}",
        "pop {{r3, pc}}",
        ".globl __aeabi_frsub",
        ".type __aeabi_frsub, %function",
        ".thumb_func",
        "__aeabi_frsub:",
        "movs r2, #1",
        "lsls r2, r2, #31",
        "eors r0, r2",
        "b __aeabi_fadd",
        any = sym any_sum,
    )
}

/// a · b: 47 to 53 instructions.
#[unsafe(naked)]
#[unsafe(no_mangle)]
extern "C" fn __aeabi_fmul() {
    naked_asm!(
        "lsls r2, r0, #1",
        "lsrs r2, r2, #24",
        "beq 6f",
        "lsls r3, r1, #1",
        "lsrs r3, r3, #24",
        "beq 6f",
        "cmp r2, #255",
        "beq 9f",
        "cmp r3, #255",
        "beq 9f",
        "adds r2, r2, r3",
        "push {{r4, r5, r6}}",
        // r3: the sign.
        "movs r3, r0",
        "eors r3, r1",
        "lsrs r3, r3, #31",
        // Mantissas of 24 bits: r0 and r4, r1 and r5.
        "uxth r4, r0",
        "uxth r5, r1",
        "lsls r0, r0, #9",
        "lsrs r0, r0, #25",
        "adds r0, #128",
        "lsls r1, r1, #9",
        "lsrs r1, r1, #25",
        "adds r1, #128",
        "movs r6, r4",
        "muls r6, r5, r6",
        "muls r4, r1, r4",
        "muls r5, r0, r5",
        "muls r0, r1, r0",
        "adds r4, r4, r5",
        "lsls r0, r0, #16",
        "adds r0, r0, r4",
        // r6: the last 16 bits of the product. r0: those before.
        "lsrs r4, r6, #16",
        "lsls r6, r6, #16",
        "adds r0, r0, r4",
        "bmi 1f",
        "lsls r0, r0, #1",
        "subs r2, #1",
        "1:",
        "subs r2, #127",
        "cmp r2, #253",
        "bhi 4f",
        "lsls r3, r3, #8",
        "adds r3, r3, r2",
        "lsls r3, r3, #23",
        "lsls r1, r0, #24",
        "lsrs r0, r0, #8",
        "adcs r0, r3",
        "lsls r2, r1, #1",
        "beq 2f",
        "pop {{r4, r5, r6}}",
        "bx lr",
        // A tie, or an exact product.
        "2:",
        "orrs r1, r6",
        "lsls r2, r1, #1",
        "bne 3f",
        "cmp r1, #0",
        "beq 3f",
        "lsrs r0, r0, #1",
        "lsls r0, r0, #1",
        "3:",
        "pop {{r4, r5, r6}}",
        "bx lr",
        // The exponent is too small or too large.
        "4:",
        "adds r1, r2, #1",
        "movs r2, #1",
        "ands r2, r0",
        "lsrs r0, r0, #1",
        "orrs r2, r0",
        "cmp r6, #0",
        "beq 5f",
        "movs r6, #1",
        "orrs r2, r6",
        "5:",
        "lsls r0, r3, #31",
        "pop {{r4, r5, r6}}",
        "push {{r3, lr}}",
        "bl {beyond}",
        "pop {{r3, pc}}",
        // 0, or a subnormal number.
        "6:",
        "lsls r2, r0, #1",
        "bne 7f",
        "lsls r2, r1, #1",
        "b 8f",
        "7:",
        "lsls r3, r1, #1",
        "bne 9f",
        "8:",
        "lsrs r2, r2, #24",
        "cmp r2, #255",
        "beq 9f",
        "eors r0, r1",
        "lsrs r0, r0, #31",
        "lsls r0, r0, #31",
        "bx lr",
        "9:",
        "push {{r3, lr}}",
        "bl {any}",
        "pop {{r3, pc}}",
        any = sym any_product,
        beyond = sym out_of_range,
    )
}

/// a / b: 69 to 73 instructions. The digits are those of `single::div`. A quotient is never a tie, so no bit
/// says whether something is left.
#[unsafe(naked)]
#[unsafe(no_mangle)]
extern "C" fn __aeabi_fdiv() {
    naked_asm!(
        "lsls r2, r0, #1",
        "lsrs r2, r2, #24",
        "beq 9f",
        "cmp r2, #255",
        "beq 9f",
        "lsls r3, r1, #1",
        "lsrs r3, r3, #24",
        "beq 9f",
        "cmp r3, #255",
        "beq 9f",
        "subs r2, r2, r3",
        "push {{r4, r5, r6, r7}}",
        // r3: the sign.
        "movs r3, r0",
        "eors r3, r1",
        "lsrs r3, r3, #31",
        // Mantissas of 24 bits.
        "movs r4, #128",
        "lsls r4, r4, #16",
        "lsls r0, r0, #9",
        "lsrs r0, r0, #9",
        "orrs r0, r4",
        "lsls r1, r1, #9",
        "lsrs r1, r1, #9",
        "orrs r1, r4",
        // r4: the reciprocal of the divisor.
        "lsrs r4, r1, #16",
        "ldr r5, 10f",
        "ldrb r4, [r5, r4]",
        "adds r4, #255",
        "adds r4, #1",
        "movs r5, r4",
        "muls r5, r1, r5",
        "rsbs r5, r5, #0",
        "asrs r5, r5, #8",
        "muls r5, r4, r5",
        "asrs r5, r5, #16",
        "lsls r4, r4, #8",
        "adds r4, r4, r5",
        // r5 and r6: the digits.
        "lsrs r5, r0, #9",
        "muls r5, r4, r5",
        "lsrs r5, r5, #18",
        "movs r6, r5",
        "muls r6, r1, r6",
        "lsls r0, r0, #13",
        "subs r0, r0, r6",
        "lsrs r6, r0, #11",
        "muls r6, r4, r6",
        "lsrs r6, r6, #17",
        "movs r7, r6",
        "muls r7, r1, r7",
        "lsls r0, r0, #12",
        "subs r0, r0, r7",
        "lsls r5, r5, #12",
        "adds r5, r5, r6",
        "cmp r0, r1",
        "bhs 3f",
        "1:",
        "lsls r5, r5, #6",
        "bmi 2f",
        "lsls r5, r5, #1",
        "subs r2, #1",
        "2:",
        "adds r2, #126",
        "cmp r2, #253",
        "bhi 4f",
        "lsls r3, r3, #8",
        "adds r3, r3, r2",
        "lsls r3, r3, #23",
        "lsrs r0, r5, #8",
        "adcs r0, r3",
        "pop {{r4, r5, r6, r7}}",
        "bx lr",
        "3:",
        "adds r5, #1",
        "subs r0, r0, r1",
        "cmp r0, r1",
        "bhs 3b",
        "b 1b",
        // The exponent is too small or too large. The quotient has 26 bits at most, so bit 0 is free.
        "4:",
        "adds r1, r2, #1",
        "lsrs r2, r5, #1",
        "cmp r0, #0",
        "beq 5f",
        "movs r6, #1",
        "orrs r2, r6",
        "5:",
        "lsls r0, r3, #31",
        "pop {{r4, r5, r6, r7}}",
        "push {{r3, lr}}",
        "bl {beyond}",
        "pop {{r3, pc}}",
        "9:",
        "push {{r3, lr}}",
        "bl {any}",
        "pop {{r3, pc}}",
        ".p2align 2",
        // The index has its first bit set.
        "10:",
        ".word {table} - 128",
        any = sym any_quotient,
        beyond = sym out_of_range,
        table = sym RECIPROCALS,
    )
}

/// From an integer; behind it from an integer without sign: 25 instructions.
#[unsafe(naked)]
#[unsafe(no_mangle)]
extern "C" fn __aeabi_i2f() {
    naked_asm!(
        "movs r1, #157",
        "cmp r0, #0",
        "bpl 1f",
        "rsbs r0, r0, #0",
        // The sign, one place above the exponent.
        "adds r1, #255",
        "adds r1, #1",
        "b 1f",
        ".globl __aeabi_ui2f",
        ".type __aeabi_ui2f, %function",
        ".thumb_func",
        "__aeabi_ui2f:",
        "movs r1, #157",
        "1:",
        "lsrs r2, r0, #16",
        "bne 2f",
        "lsls r0, r0, #16",
        "beq 7f",
        "subs r1, #16",
        "2:",
        "lsrs r2, r0, #24",
        "bne 3f",
        "lsls r0, r0, #8",
        "subs r1, #8",
        "3:",
        "lsrs r2, r0, #28",
        "bne 4f",
        "lsls r0, r0, #4",
        "subs r1, #4",
        "4:",
        "cmp r0, #0",
        "bmi 6f",
        "5:",
        "subs r1, #1",
        "lsls r0, r0, #1",
        "bpl 5b",
        "6:",
        "lsls r1, r1, #23",
        "lsls r2, r0, #24",
        "lsrs r0, r0, #8",
        "adcs r0, r1",
        "lsls r3, r2, #1",
        "bne 7f",
        "cmp r2, #0",
        "beq 7f",
        "lsrs r0, r0, #1",
        "lsls r0, r0, #1",
        "7:",
        "bx lr",
    )
}

/// Comparisons: 1 if true, 0 if false or with a NaN. `$less` and `$more` are the registers, `$not` and
/// `$not_unsigned` the conditions of false, `$zeros` the label for two zeros.
macro_rules! comparison {
    ($name:ident $first:literal $second:literal $not:literal $not_unsigned:literal $zeros:literal) => {
        #[unsafe(naked)]
        #[unsafe(no_mangle)]
        extern "C" fn $name() {
            naked_asm!(
                "movs r3, #255",
                "lsls r3, r3, #24",
                "lsls r2, r0, #1",
                "cmp r2, r3",
                "bhi 2f",
                "lsls r2, r1, #1",
                "cmp r2, r3",
                "bhi 2f",
                "movs r2, r0",
                "orrs r2, r1",
                "bmi 3f",
                concat!("cmp ", $first, ", ", $second),
                concat!($not, " 2f"),
                "1:",
                "movs r0, #1",
                "bx lr",
                "2:",
                "movs r0, #0",
                "bx lr",
                // One is negative, or both: the order of the bits without sign is reversed.
                "3:",
                "lsls r2, r2, #1",
                concat!("beq ", $zeros),
                concat!("cmp ", $first, ", ", $second),
                concat!($not_unsigned, " 2b"),
                "b 1b",
            )
        }
    };
}

comparison!(__aeabi_fcmplt "r0" "r1" "bge" "bls" "2b");
comparison!(__aeabi_fcmple "r0" "r1" "bgt" "blo" "1b");
comparison!(__aeabi_fcmpgt "r1" "r0" "bge" "bls" "2b");
comparison!(__aeabi_fcmpge "r1" "r0" "bgt" "blo" "1b");

/// Zeros before the first bit; 32 for 0.
#[unsafe(no_mangle)]
extern "C" fn __clzsi2(x: u32) -> u32 {
    if x == 0 { 32 } else { lift(x).1 }
}

/// The lower 64 bits of a product, by products of 16 bits: 25 instructions.
#[unsafe(naked)]
#[unsafe(no_mangle)]
extern "C" fn __aeabi_lmul() {
    naked_asm!(
        "push {{r4, r5}}",
        // The factors with an upper word.
        "muls r1, r2, r1",
        "muls r3, r0, r3",
        "adds r1, r1, r3",
        // The lower words, in halves: r3 and r0, r4 and r2.
        "lsrs r3, r0, #16",
        "lsrs r4, r2, #16",
        "uxth r0, r0",
        "uxth r2, r2",
        "movs r5, r3",
        "muls r5, r4, r5",
        "adds r1, r1, r5",
        "muls r3, r2, r3",
        "muls r4, r0, r4",
        "muls r0, r2, r0",
        // r5: the carry of the middle.
        "movs r5, #0",
        "adds r3, r3, r4",
        "adcs r5, r5",
        "lsls r5, r5, #16",
        "adds r1, r1, r5",
        "lsls r4, r3, #16",
        "lsrs r3, r3, #16",
        "adds r0, r0, r4",
        "adcs r1, r3",
        "pop {{r4, r5}}",
        "bx lr",
    )
}

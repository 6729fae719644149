//! How a core comes to `main`: by cortex-m-rt on ARM, by the lines below on RISC-V.

#[cfg(target_arch = "riscv32")]
core::arch::global_asm!(
    ".section .init, \"ax\"",
    ".global _start",
    "_start:",
    "la sp, _stack_start",
    "la t0, trap",
    "csrw mtvec, t0",
    "la t0, _sbss",
    "la t1, _ebss",
    "1: bgeu t0, t1, 2f",
    "sw zero, 0(t0)",
    "addi t0, t0, 4",
    "j 1b",
    "2: la t0, _sdata",
    "la t1, _edata",
    "la t2, _sidata",
    "3: bgeu t0, t1, 4f",
    "lw t3, 0(t2)",
    "sw t3, 0(t0)",
    "addi t0, t0, 4",
    "addi t2, t2, 4",
    "j 3b",
    "4: call main",
    ".balign 4",
    "trap: j {fault}",
    fault = sym fault,
);

/// Where a trap, or a fault of an ARM core, ends.
#[cfg(target_arch = "riscv32")]
extern "C" fn fault() -> ! {
    crate::exit(false)
}

#[cfg(target_arch = "arm")]
#[unsafe(no_mangle)]
unsafe extern "C" fn HardFault() -> ! {
    crate::exit(false)
}

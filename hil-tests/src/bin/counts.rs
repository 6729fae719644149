//! The proof that the counter counts instructions.
#![no_std]
#![no_main]
use core::fmt::Write;
use cortex_m_rt::entry;
use hil_tests::{Counter, Report, UNIT, exit};
use panic_semihosting as _;

macro_rules! nops {
    ($report:ident $counter:ident: $($count:literal),+) => {$(
        let (before, after): (u32, u32);
        // One piece of assembly, so that the compiler moves nothing in between the two readings.
        // SAFETY: reads the counter's register and does nothing.
        unsafe {
            core::arch::asm!(
                "ldr {before}, [{register}]",
                concat!(".rept ", $count, "\n nop\n .endr"),
                "ldr {after}, [{register}]",
                register = in(reg) Counter::REGISTER, before = out(reg) before, after = out(reg) after,
            );
        }
        let cost = $counter.net(after.wrapping_sub(before));
        let _ = writeln!($report, "nops {} counted {cost}", $count);
    )+};
}

#[entry]
fn main() -> ! {
    let mut report = Report::open();
    let counter = Counter::start();
    let _ = writeln!(report, "unit {UNIT}");
    nops!(report counter: 0, 1, 10, 100, 1000);
    report.flush();
    exit(true)
}

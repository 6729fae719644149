//! Goes deeper than the stack: it must end with a fault that says so, and never with [`DEEPEST`] calls.
#![no_std]
#![no_main]
use core::fmt::Write;
use core::hint::black_box;
use cortex_m_rt::entry;
use hil_tests::{Report, exit};
use panic_semihosting as _;

/// Calls that need more than the target has of RAM.
const DEEPEST: u32 = 4096;

#[inline(never)]
fn deeper(from: &[u32; 16], left: u32) -> u32 {
    let here = black_box(from.map(|word| word.wrapping_add(left)));
    if left == 0 {
        return here.iter().sum();
    }
    let below = deeper(&here, left - 1);
    black_box(&here);
    below
}

#[entry]
fn main() -> ! {
    let mut report = Report::open();
    let sum = deeper(&[1; 16], black_box(DEEPEST));
    let _ = writeln!(report, "{DEEPEST} calls deep, and nothing noticed it: {sum}");
    report.flush();
    exit(true)
}

//! The same as `same`, for the cases with six axes: a binary of its own, for its memory.
#![no_std]
#![no_main]
use core::fmt::Write;
use cortex_m_rt::entry;
use glidepath::channel::Channel;
use hil_cases::{AXES_6, BLOCKS_6, CASES_6};
use hil_tests::{Counter, Report, UNIT, exit, record};
use panic_semihosting as _;
use static_cell::ConstStaticCell;

static CHANNEL: ConstStaticCell<Channel<6, BLOCKS_6>> = ConstStaticCell::new(Channel::new());

#[entry]
fn main() -> ! {
    let mut report = Report::open();
    let counter = Counter::start();
    let _ = writeln!(report, "unit {UNIT}");
    let channel = CHANNEL.take();
    let mut good = true;
    for case in CASES_6 {
        good &= record(channel, &AXES_6, case, &counter, &mut report);
    }
    report.flush();
    exit(good)
}

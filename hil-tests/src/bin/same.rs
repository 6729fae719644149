//! Every set point of every tick of every case with three axes, and what tick and planner cost.
#![no_std]
#![no_main]
use core::fmt::Write;
use cortex_m_rt::entry;
use glidepath::channel::Channel;
use hil_cases::{AXES_3, BLOCKS, CASES_3};
use hil_tests::{Counter, Report, UNIT, exit, record};
use panic_semihosting as _;
use static_cell::ConstStaticCell;

static CHANNEL: ConstStaticCell<Channel<3, BLOCKS>> = ConstStaticCell::new(Channel::new());

#[entry]
fn main() -> ! {
    let mut report = Report::open();
    let counter = Counter::start();
    let _ = writeln!(report, "unit {UNIT}");
    let channel = CHANNEL.take();
    let mut good = true;
    for case in CASES_3 {
        good &= record(channel, &AXES_3, case, &counter, &mut report);
    }
    report.flush();
    exit(good)
}

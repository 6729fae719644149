//! Every set point of every tick of every case with three and four axes, and what tick and planner cost.
#![no_std]
#![no_main]
use core::fmt::Write;
use cortex_m_rt::entry;
use glidepath::channel::Channel;
use hil_cases::{AXES_3, AXES_4, BLOCKS, CASES_3, CASES_4};
use hil_tests::{Counter, Report, UNIT, exit, record};
use panic_semihosting as _;
use static_cell::ConstStaticCell;

static CHANNEL_3: ConstStaticCell<Channel<3, BLOCKS>> = ConstStaticCell::new(Channel::new());
static CHANNEL_4: ConstStaticCell<Channel<4, BLOCKS>> = ConstStaticCell::new(Channel::new());

#[entry]
fn main() -> ! {
    let mut report = Report::open();
    let counter = Counter::start();
    let _ = writeln!(report, "unit {UNIT}");
    let (channel_3, channel_4) = (CHANNEL_3.take(), CHANNEL_4.take());
    let mut good = true;
    for case in CASES_3 {
        good &= record(channel_3, &AXES_3, case, &counter, &mut report);
    }
    for case in CASES_4 {
        good &= record(channel_4, &AXES_4, case, &counter, &mut report);
    }
    report.flush();
    exit(good)
}

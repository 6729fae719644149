//! The programs with three axes, and commands all the time: every set point of every tick, and what the calls
//! cost that carry them out.
#![no_std]
#![no_main]
use cortex_m_rt::entry;
use glidepath::channel::Channel;
use hil_cases::{AXES_3, BLOCKS, CASES_3};
use hil_tests::record_commanded;
use panic_semihosting as _;
use static_cell::ConstStaticCell;

static CHANNEL: ConstStaticCell<Channel<3, BLOCKS>> = ConstStaticCell::new(Channel::new());

#[entry]
fn main() -> ! {
    record_commanded(CHANNEL.take(), &AXES_3, CASES_3)
}

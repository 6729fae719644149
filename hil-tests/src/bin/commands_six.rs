//! The programs with six axes, and commands all the time: every set point of every tick, and what the calls cost that
//! carry them out.
#![no_std]
#![no_main]
use cortex_m_rt::entry;
use glidepath::channel::Channel;
use hil_cases::{AXES_6, BLOCKS, CASES_6};
use hil_tests::record_commanded;
use panic_semihosting as _;
use static_cell::ConstStaticCell;

static CHANNEL: ConstStaticCell<Channel<6, BLOCKS>> = ConstStaticCell::new(Channel::new());

#[entry]
fn main() -> ! {
    record_commanded(CHANNEL.take(), &AXES_6, CASES_6)
}

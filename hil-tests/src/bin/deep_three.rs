//! The same as `same` with a deep look-ahead, for some cases.
#![no_std]
#![no_main]
use cortex_m_rt::entry;
use glidepath::channel::Channel;
use hil_cases::{AXES_3_DEEP, CASES_3_OTHER, DEEP};
use hil_tests::record_all;
use panic_semihosting as _;
use static_cell::ConstStaticCell;

static CHANNEL: ConstStaticCell<Channel<3, DEEP>> = ConstStaticCell::new(Channel::new());

#[entry]
fn main() -> ! {
    record_all(CHANNEL.take(), &AXES_3_DEEP, CASES_3_OTHER)
}

//! The same as `same_six` with a short look-ahead, for some cases.
#![no_std]
#![no_main]
use cortex_m_rt::entry;
use glidepath::channel::Channel;
use hil_cases::{AXES_6_SHORT, CASES_6_OTHER, SHORT};
use hil_tests::record_all;
use panic_semihosting as _;
use static_cell::ConstStaticCell;

static CHANNEL: ConstStaticCell<Channel<6, SHORT>> = ConstStaticCell::new(Channel::new());

#[entry]
fn main() -> ! {
    record_all(CHANNEL.take(), &AXES_6_SHORT, CASES_6_OTHER)
}

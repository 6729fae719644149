//! The same as `same`, for the cases with six axes: a binary of its own, for its memory.
#![no_std]
#![no_main]
use cortex_m_rt::entry;
use glidepath::channel::Channel;
use hil_cases::{AXES_6, BLOCKS, CASES_6};
use hil_tests::record_all;
use panic_semihosting as _;
use static_cell::ConstStaticCell;

static CHANNEL: ConstStaticCell<Channel<6, BLOCKS>> = ConstStaticCell::new(Channel::new());

#[entry]
fn main() -> ! {
    record_all(CHANNEL.take(), &AXES_6, CASES_6)
}

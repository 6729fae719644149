//! The same as `same` for programs of lines, arcs and contour mode: built without the other functions of the
//! library, they have the same set points.
#![no_std]
#![no_main]
use cortex_m_rt::entry;
use glidepath::channel::Channel;
use hil_cases::{AXES_3, BLOCKS, CASES_SLIM};
use hil_tests::record_all;
use panic_semihosting as _;
use static_cell::ConstStaticCell;

static CHANNEL: ConstStaticCell<Channel<3, BLOCKS>> = ConstStaticCell::new(Channel::new());

#[entry]
fn main() -> ! {
    record_all(CHANNEL.take(), &AXES_3, CASES_SLIM)
}

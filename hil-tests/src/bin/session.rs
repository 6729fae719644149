//! One channel from power-up to power-off, every set point of every tick: with its text in memory, and over a
//! line.
#![no_std]
#![no_main]
use cortex_m_rt::entry;
use glidepath::channel::Channel;
use glidepath::nc::Window;
use hil_cases::{AXES_3, BLOCKS, WINDOW};
use hil_tests::record_sessions;
use panic_semihosting as _;
use static_cell::ConstStaticCell;

static CHANNEL: ConstStaticCell<Channel<3, BLOCKS>> = ConstStaticCell::new(Channel::new());
static LINE: ConstStaticCell<Window<WINDOW>> = ConstStaticCell::new(Window::new());

#[entry]
fn main() -> ! {
    record_sessions(CHANNEL.take(), LINE.take(), &AXES_3)
}

//! The decoder alone: instructions for each line of a plain program in each dialect of the build, and bytes of
//! the channel.
#![no_std]
#![no_main]
use cortex_m_rt::entry;
use glidepath::channel::Channel;
use hil_cases::SHORT;
use hil_tests::record_decoder;
use panic_semihosting as _;
use static_cell::ConstStaticCell;

static CHANNEL: ConstStaticCell<Channel<3, SHORT>> = ConstStaticCell::new(Channel::new());

#[entry]
fn main() -> ! {
    record_decoder(CHANNEL.take())
}

//! A program under a transformation (feature `five`): every set point of every tick, and what tick and planner cost.
#![no_std]
#![no_main]
use cortex_m_rt::entry;
use glidepath::channel::Channel;
use hil_cases::BLOCKS;
use hil_tests::record_five;
use panic_semihosting as _;
use static_cell::ConstStaticCell;

static CHANNEL: ConstStaticCell<Channel<5, BLOCKS>> = ConstStaticCell::new(Channel::new());

#[entry]
fn main() -> ! {
    record_five(CHANNEL.take())
}

//! Filters behind the path and axes beside it: every set point of every tick, and what a tick costs with each.
#![no_std]
#![no_main]
use cortex_m_rt::entry;
use glidepath::channel::Channel;
use hil_cases::{BLOCKS, FilterMemory, OVERLAYS};
use hil_tests::record_beside;
use panic_semihosting as _;
use static_cell::ConstStaticCell;

static CHANNEL: ConstStaticCell<Channel<3, BLOCKS, OVERLAYS>> = ConstStaticCell::new(Channel::new());
static FILTERS: ConstStaticCell<FilterMemory> = ConstStaticCell::new(FilterMemory::new());

#[entry]
fn main() -> ! {
    record_beside(CHANNEL.take(), FILTERS.take())
}

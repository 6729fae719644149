//! A PLC beside the motion: a real-time loop that it ends, with and without a log, and a laser that it sets: set points and
//! outputs are the host's. `cargo xtask hil --plc`.
#![no_std]
#![no_main]
use cortex_m_rt::entry;
use glidepath::channel::Channel;
use hil_cases::{BLOCKS, PlcMemory};
use hil_tests::record_plc;
use panic_semihosting as _;
use static_cell::ConstStaticCell;

static CHANNEL: ConstStaticCell<Channel<3, BLOCKS>> = ConstStaticCell::new(Channel::new());
static MEMORY: ConstStaticCell<PlcMemory> = ConstStaticCell::new(PlcMemory::new());

#[entry]
fn main() -> ! {
    record_plc(CHANNEL.take(), MEMORY.take())
}

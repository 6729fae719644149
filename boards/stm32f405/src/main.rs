//! Glidepath on an STM32F405: an NC program from flash moves three axes.
//!
//! The main loop plans in bounded steps. TIM2 interrupts the main loop once per cycle, outputs the set points
//! of the previous cycle, and computes the next ones.
#![no_std]
#![no_main]

#[cfg(feature = "hardware")]
mod clock;
mod machine;
mod message;
mod motion;
mod output;
mod spi;

use cortex_m::asm::wfi;
use cortex_m_rt::entry;
use glidepath::channel::{Channel, Handles, Progress};
use glidepath::operator::Operator;
use glidepath::quantity::Position;
use glidepath_copy as _;
#[cfg(not(any(feature = "rtt", feature = "qemu")))]
use panic_never as _;
use static_cell::ConstStaticCell;
use stm32f4::stm32f405::Peripherals;

/// Number of axes of [`machine::MACHINE`].
const AXES: usize = 3;

/// The NC program; the environment variable `PROGRAM` selects another program at build time.
static TEXT: &[u8] = include_bytes!(concat!(env!("OUT_DIR"), "/program.nc"));

static CHANNEL: ConstStaticCell<Channel<AXES, { machine::BLOCKS }>> = ConstStaticCell::new(Channel::new());

#[entry]
fn main() -> ! {
    if let (Some(board), Some(channel)) = (Peripherals::take(), CHANNEL.try_take()) {
        run(board, channel);
    }
    message::end(motion::report());
    loop {
        wfi();
    }
}

fn run(board: Peripherals, channel: &'static mut Channel<AXES, { machine::BLOCKS }>) {
    #[cfg(feature = "hardware")]
    clock::start(&board.RCC, &board.FLASH);
    let Some(axes) = output::axes(board.SPI1, board.DMA2, board.GPIOA, &board.RCC) else { return };
    message::info!("{} bytes of program, cycle {} us", TEXT.len(), machine::MACHINE.channel.cycle_us);
    let handles = match channel.split(&machine::MACHINE, [Position::ZERO; AXES], TEXT) {
        Ok(handles) => handles,
        Err(_error) => {
            message::error!("machine data refused: {}", defmt::Debug2Format(&_error));
            return;
        }
    };
    let Handles { mut planner, interpolator, operator } = handles;
    motion::start(interpolator, axes, board.TIM2, &board.RCC, machine::MACHINE.channel.cycle_us);
    loop {
        acknowledge(&operator);
        match planner.poll() {
            Ok(Progress::Waiting) => wfi(),
            Ok(Progress::Done) => break,
            Ok(Progress::Planned) => {
                let _block = planner.planned();
                message::debug!("block {} of N{}", _block.block, _block.n);
            }
            Ok(Progress::Warning(_warning)) => message::info!("warning: {}", defmt::Debug2Format(&_warning)),
            Ok(Progress::Late) => message::info!("the planner was late: the motion stood still"),
            Ok(Progress::Slower) => {
                message::info!("slower: a standstill from the programmed speed has no room")
            }
            Ok(Progress::Starved) => message::info!("the program text is late"),
            Ok(Progress::Working | Progress::Replanned | Progress::Deviated(_)) => {}
            // Motion that was planned before the error is valid and ends in a stop; the loop then ends with
            // `Done`.
            Err(_error) => message::error!("program refused: {}", defmt::Debug2Format(&_error)),
        }
    }
    motion::wait_for_standstill(|| acknowledge(&operator));
    message::info!("at rest after {} ticks", motion::report().ticks);
}

/// This firmware carries out no M, H, S and T functions, so each function is acknowledged at once.
fn acknowledge(operator: &Operator<'_, AXES>) {
    while let Some(output) = operator.output() {
        if output.waits {
            let _ = operator.acknowledge(output.function);
        }
    }
}

//! Planner on core 0, tick on core 1. What both share is the channel and a few atomics; no lock, no critical section.
//!
//! ```text
//!   core 0: split, poll, poll, …        core 1: SysTick every millisecond: write, tick
//!            └── interpolator: once, through a mailbox ──┘
//! ```
#![no_std]
#![no_main]

#[cfg_attr(feature = "an521", path = "an521.rs")]
#[cfg_attr(not(feature = "an521"), path = "rp2350.rs")]
mod chip;
mod motion;

use cortex_m_rt::entry;
use glidepath::channel::{Channel, Handles, Progress};
use glidepath::quantity::Position;
use glidepath_copy as _;
use hil_cases::{AXES_3, BLOCKS, CASES_3};
use panic_never as _;

static mut CHANNEL: Channel<3, BLOCKS> = Channel::new();

/// The program, by its name in `programs/`.
const PROGRAM: &str = "corners";

#[entry]
fn main() -> ! {
    let program = CASES_3.iter().find(|case| case.name == PROGRAM).map(|case| case.text);
    // SAFETY: `main` runs once, on core 0, and nobody else names the channel.
    let channel = unsafe { &mut *(&raw mut CHANNEL) };
    if let Some(program) = program
        && let Ok(handles) = channel.split(&AXES_3, [Position::ZERO; 3], program)
    {
        let Handles { mut planner, interpolator, operator } = handles;
        motion::hand_over(interpolator);
        chip::start_other_core(motion::core_1);
        loop {
            // A program with functions takes them here, and acknowledges those that wait.
            while operator.output().is_some() {}
            match motion::planning(|| planner.poll()) {
                Ok(Progress::Waiting) => cortex_m::asm::nop(),
                Ok(Progress::Done) => break,
                Ok(_) => {}
                Err(_) => chip::end(false),
            }
        }
        motion::wait_for_end();
        chip::end(true);
    }
    chip::end(false)
}

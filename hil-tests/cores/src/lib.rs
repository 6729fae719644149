//! What the binaries need of a core: a start, a counter of instructions, text to the host, and how deep the stack was.
//!
//! Nothing here is of one chip. On ARM the counter is SysTick, on RISC-V it is `minstret`.
#![no_std]

mod counter;
mod floats;
mod host;
mod memory;
mod stack;
mod start;

pub use counter::{around, around_nothing, elapsed, now};
pub use floats::floats;
pub use host::{Report, exit};
pub use memory::channel;
pub use stack::{depth, paint};

#[cfg(copies)]
use glidepath_copy as _;

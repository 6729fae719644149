//! Floating point for cores that have no instructions for it: the bits of the compiler's functions, in fewer
//! instructions.

#![no_std]

mod compare;
mod convert;
mod single;
pub mod trial;
mod wide;

pub use compare::{equal, less, less_or_equal, unordered};
pub use convert::{from_i32, from_i64, from_u32, from_u64, to_i32, to_i64, to_u32, to_u64};
pub use single::{add, div, mul, sub};

#[cfg(all(target_os = "none", any(target_arch = "arm", target_arch = "riscv32")))]
mod export;
#[cfg(all(target_os = "none", target_arch = "arm", narrow))]
mod narrow;

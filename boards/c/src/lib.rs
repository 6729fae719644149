//! Glidepath for C. `cargo xtask header` generates the header `include/glidepath.h` from this crate.
//!
//! A C program has one [`storage::Storage`] in static memory. [`storage::gp_open`] makes four handles in this
//! memory: planner, interpolator, operator and feeder. Each handle belongs to one context, for example a task
//! or an interrupt. Every call checks its handle and returns a [`result::Outcome`]. No function of this crate
//! allocates, waits or unwinds.
#![cfg_attr(target_os = "none", no_std)]
// The contract of all pointers stands once, at the top of the header.
#![allow(clippy::missing_safety_doc)]

pub mod result;

pub mod machine;

pub mod interpolator;

pub mod planner;

pub mod operator;

pub mod feeder;

pub mod storage;

/// cbindgen:ignore
mod built;
mod message;
mod part;
mod text;

#[cfg(target_os = "none")]
use panic_never as _;

/// Number of axes. To change this constant, or one of the next two, edit the constant here, then run
/// `cargo xtask header`.
pub const AXES: usize = 3;

/// Number of blocks in the look-ahead, at least 10.
pub const BLOCKS: usize = 120;

/// Bytes of the text window: a power of two, at least 64. A line of the program has at most half of
/// this length.
pub const WINDOW: usize = 1024;

/// Order of the largest filter plus 1: an even number (P-AXIS-00587).
pub const TAPS: usize = 48;

/// Number of axes that may move independently of the path at the same time, by `gp_move_axis` and by
/// the program.
pub const OVERLAYS: usize = 2;

//! Glidepath turns an NC program into axis set points, in integers, with the same bits on every machine.
//!
//! ```text
//!       thread, RTOS task or low-priority interrupt: bounded work per call   |  timer interrupt: bounded work per tick
//!  text → nc ─commands→ path ─segments→ lookahead ─speeds→ slope ─time law→ queue → tick ─set points→ axis → board
//! ```
//!
//! An application holds two halves of one [`channel::Channel`]: the [`channel::Planner`] runs where time is not
//! critical and is called again and again; the [`tick::Interpolator`] is moved into the timer interrupt.
#![no_std]
// Only `queue::ring` may, and says why.
#![deny(unsafe_code)]

pub mod quantity;

pub mod math;

pub mod machine;

pub mod nc;

pub mod path;

pub mod lookahead;

pub mod slope;

pub mod control;

pub mod queue;

pub mod tick;

pub mod axis;

pub mod technology;

pub mod digest;

pub mod planning;

pub mod channel;

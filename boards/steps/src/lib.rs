//! From set points to step and direction: one buffer of port words per tick, for a timer and DMA.
//!
//! ```text
//!  set point of the tick ─→ counter ─counts in this tick→ spread ─slots→ axis ─bits→ [u32; SLOTS] ─DMA→ port
//!        backlash ──────────↗                                          timing ↗
//! ```
//!
//! A tick is divided into `SLOTS` slots of equal length. [`Steps::fill`] takes the set points of a tick and
//! writes the words from the set points of the tick before to these. A timer and DMA write one word per slot to
//! the port while the next tick is computed. So the pulses come one tick after the set points, equally on all
//! axes.
//!
//! | quantity | unit, range | rounding |
//! |---|---|---|
//! | set point | mm or degrees, LSB 2^-32 | |
//! | count, a step of the motor | integer | set point · counts / length, to the nearest, half a count up |
//! | slot of a step | 0…`SLOTS` − 1 | set point linear inside the tick; the slot that holds the crossing |
//!
//! The fraction of a count is kept exactly, as an integer in units of 1 / (length · 2^32) of a count. Errors do
//! not add up: at the end of every tick the sum of the steps is exactly the rounded set point.
//!
#![doc = include_str!("../README.md")]
#![no_std]
#![forbid(unsafe_code)]

pub use backlash::Backlash;
pub use data::{AxisSteps, MOTORS, Motor, Pin, StepData};
pub use drive::{Done, Drive};
pub use levels::Levels;
pub use port::{State, Steps};
pub use unfit::Unfit;

mod axis;

mod backlash;

mod counter;

mod data;

mod drive;

mod levels;

mod port;

mod spread;

mod timing;

mod unfit;

//! Converts set points to step and direction pulses: one buffer of port words per tick, for a timer with DMA.
//!
//! ```text
//!  set point of the tick ─→ counter ─counts in this tick→ spread ─slots→ axis ─bits→ [u32; SLOTS] ─DMA→ port
//!        backlash ──────────↗                                          timing ↗
//! ```
//!
//! A tick is divided into `SLOTS` slots of equal length. [`Steps::fill`] takes the set points of a tick, and
//! writes the port words for the way from the set points of the tick before. A timer with DMA outputs one
//! word per slot to the port, while the next tick is computed. So the pulses come one tick after the set
//! points, equally on all axes.
//!
//! | quantity | unit, range | rounding |
//! |---|---|---|
//! | set point | mm or degrees, LSB 2^-32 | |
//! | count, a step of the motor | integer | set point · counts / length, to the nearest, half a count up |
//! | slot of a step | 0…`SLOTS` − 1 | between two ticks, the set point changes linearly; the slot that holds the rounding boundary |
//!
//! The fraction of a count is kept exactly, in units of 1 / (length · 2^32) of a count, so errors do not add
//! up. At the end of every tick, the sum of the steps is exactly the rounded set point plus the backlash
//! taken up. The exception is a tick for which [`Steps::fill`] returns another state than [`State::InTime`].
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

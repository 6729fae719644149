//! The limits that bound the speed, transition by transition and block by block, and changes that make the
//! program faster.
//!
//! The simulator finds the limits by experiment: the program runs again, without events, with one limit of
//! the machine data raised by a quarter. If the motion is faster then, this limit bound its speed. The
//! experiment repeats no formula of the planner, so the answer holds for every slope and smoothing method,
//! and costs a controller nothing.

mod count;
mod loosen;
mod tell;
mod trial;

pub use count::Why;
pub use tell::Told;
pub use trial::{Asked, ask};

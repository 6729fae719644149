//! From the tool tip to the axes of a machine with rotary axes, and back.
//!
//! A program for such a machine gives the tool tip in workpiece coordinates and the angles of the rotary axes.
//! The linear axes follow from both. [`Chain`] holds the machine, checked once from its data ([`data`]).
//! [`Splitter`] turns one curve of tool tip and angles over path distance into quintic polynomials of the axes
//! over the same path distance. Between the ends of a polynomial the tool tip deviates from its curve by less
//! than [`cells::TIP_ERROR`]. This follows from a bound ([`bound`]), not from samples.
//!
//! The calculation uses `f64` with + − × ÷ only, and integer sines ([`crate::math::angle`]). So all machines
//! give the same bits. The ends and the coefficients of a polynomial are integers, and integer arithmetic
//! checks them.
pub mod bound;
pub mod cells;
pub mod chain;
pub mod data;
pub mod element;
pub mod orientation;
pub mod vector;

pub use cells::{Cell, Course, Round, SplitError, Splitter};
pub use chain::{AXES, Chain, ROTARIES};
pub use data::{CaHead, DataError, Universal, UniversalAxis};
pub use element::{Kinematic, Unfit};
pub use orientation::Reach;
pub use vector::Vector;

//! Kinematic transformation: from the tool tip to the axes of a machine with rotary axes, and back.
//!
//! A program for such a machine gives the tool tip in workpiece coordinates and the angles of the rotary
//! axes. The positions of the linear axes follow from both. [`Chain`] describes the machine; its data
//! ([`data`]) are checked once. [`Splitter`] turns a curve of tool tip and angles into polynomials of the
//! axes over the same path distance. Between the ends of a polynomial, the tool tip deviates from its curve
//! by less than [`cells::TIP_ERROR`], 5 nm. A bound ([`bound`]) guarantees this value, without samples.
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

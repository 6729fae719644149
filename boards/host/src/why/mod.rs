//! What bound the speed, joint by joint and block by block, and what would make the program faster.
//!
//! The planner itself is asked: the program runs again, without anything from outside, with one limit of the
//! machine data loosened by a quarter and all others as they are. Where the motion is faster then, that limit
//! bound it. No formula of the planner is repeated here, so the answer holds with every slope and with every
//! way of smoothing, and a controller pays nothing for it.

mod count;
mod loosen;
mod tell;
mod trial;

pub use count::Why;
pub use tell::Told;
pub use trial::{Asked, ask};

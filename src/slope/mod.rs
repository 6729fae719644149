//! Speed over time for a length; knows nothing of geometry.
//!
//! The one slope of this version is TRAPEZ: jerk-limited, with four ramp times, acceleration zero at the ends of a
//! block. [`ramp`] holds its formulas, [`profile`] the time law of one block, [`brake`] the way
//! out of a motion at hand, [`emit`] cuts it into what the tick
//! needs.
pub mod ramp;

pub mod profile;

pub mod brake;

pub mod emit;

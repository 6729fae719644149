//! What the test binaries share: a counter, output to the host, and how a test ends.
#![no_std]

mod counter;
mod record;
mod report;
pub mod stack;

use glidepath_copy as _;

pub use counter::{Counter, UNIT};
#[cfg(feature = "grbl")]
pub use record::record_decoder;
#[cfg(feature = "five")]
pub use record::record_five;
#[cfg(feature = "plc")]
pub use record::record_plc;
pub use record::{record_all, record_beside, record_commanded, record_sessions, report_memory};
pub use report::{Report, exit};

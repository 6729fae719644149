//! The Grbl 1.1 protocol as a state machine.
//!
//! ```text
//!  serial interrupt → Serial ─bytes→ line ─lines→ controller ─answers→ out (embedded-io)
//!                        └─real time────────────────↗  ↓ ↑
//!                                             Motion: planner, interpolator, decoder
//! ```
//!
//! The controller accesses no serial port, no clock and no planner. The serial interrupt passes the bytes to
//! the controller. Time and inputs are arguments of a call. The trait [`Motion`] represents the machine that
//! moves; [`machine`] implements this trait with Glidepath.
//!
#![doc = include_str!("../README.md")]
#![no_std]
#![forbid(unsafe_code)]

pub use controller::{Config, Controller, Look, Outputs, STORED_BYTES, Stored};
pub use inbox::{Inbox, RESET, Receiver, Serial, is_text};
pub use line::{LINE_BYTES, LineText};
pub use motion::{Homing, Jog, Message, Modal, Motion, Offsets, Overrides, Refusal, Spindle, Status, Taken};
pub use number::Fixed;
pub use settings::{AxisSettings, Settings};
pub use state::{Signals, State};
pub use store::Store;

mod number;

mod state;

mod settings;

pub mod store;

mod motion;

mod inbox;

mod line;

mod jog;

mod report;

mod controller;

mod system;

pub mod machine;

/// The output traits of `embedded-io`, in the version of this crate.
pub use embedded_io as io;

pub mod pins;

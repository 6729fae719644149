//! Glidepath turns an NC program into axis set points, in integers, with the same bits on every machine.
//!
//! ```text
//!       thread, RTOS task or low-priority interrupt: bounded work per call   |  timer interrupt: bounded work per tick
//!  text → nc ─commands→ path ─segments→ lookahead ─speeds→ slope ─time law→ queue → tick ─set points→ axis → board
//! ```
//!
//! An application holds two halves of one [`channel::Channel`]: the [`channel::Planner`] runs where time is not
//! critical and is called again and again; the [`tick::Interpolator`] is moved into the timer interrupt.
//!
//! ```
//! use glidepath::channel::{Channel, Progress};
//! use glidepath::machine::{AxisData, AxisKind, AxisName, ChannelData, MachineData};
//! use glidepath::quantity::Position;
//! use glidepath::tick::State;
//!
//! let axis = |name| AxisData::new(AxisName::new(name).unwrap(), AxisKind::Linear);
//! let channel = ChannelData { slope_profile: 1, corr_v_trans_jerk: true, ..ChannelData::new() };
//! let machine = MachineData { axes: [axis("X"), axis("Y"), axis("Z")], channel };
//! let program: &[u8] = b"N10 G01 X10 Y5 F1000\nM30\n";
//!
//! // On a controller a static variable: all of the memory is in it.
//! let mut memory = Channel::<3, 120>::new();
//! let (mut planner, mut interpolator) = memory.split(&machine, [Position::ZERO; 3], program).unwrap();
//! let mut planned = false;
//! loop {
//!     // In the main loop or a task: until the queue is full, or everything is in it.
//!     while !planned {
//!         match planner.poll().unwrap() {
//!             Progress::Done => planned = true,
//!             Progress::Waiting => break,
//!             _ => {}
//!         }
//!     }
//!     // In the timer interrupt, once per cycle:
//!     let state = interpolator.tick();
//!     let _to_the_drives: &[Position; 3] = interpolator.set_points();
//!     if planned && state == State::Idle {
//!         break;
//!     }
//! }
//! assert_eq!(interpolator.set_points().map(|axis| axis.to_num::<f64>()), [10.0, 5.0, 0.0]);
//! ```
#![no_std]
// Only the rings of `queue` may, and say why: `ring`, `course` and `reserve`.
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

#[cfg(feature = "defmt")]
mod logged;

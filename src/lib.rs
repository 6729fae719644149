//! Glidepath turns an NC program into axis set points, with the same bits on every machine.
//!
//! The tick calculates in integers. The planner uses IEEE + − × ÷ beside them; what it finds is verified in
//! integers before it is used.
//!
//! ```text
//!         planner: a task or the main loop, bounded work per call                   |  interrupt: bounded work per tick
//!
//!  text → nc ─commands→ path ─elements→ smooth → dynamics ─limits→ lookahead ─spans→ slope ─pieces→ queue → tick → axis
//!         └───────────────────────────────── plan ────────────────────────────────────┘              ↓
//!                                                                            operator: PLC, serial line, other core
//! ```
//!
//! An application holds three handles of one [`Channel`]. The [`Planner`] runs where time is not critical and
//! is called again and again. The [`Interpolator`] is moved into the timer interrupt. The [`Operator`] gives
//! commands, takes the functions that are due and sees the status, in any task or on another core.
//!
//! ```
//! use glidepath::{AxisData, AxisKind, AxisName, Channel, ChannelData, Handles};
//! use glidepath::{MachineData, Position, Progress, State};
//!
//! let axis = |name| AxisData::new(AxisName::new(name).unwrap(), AxisKind::Linear);
//! let channel = ChannelData { slope_profile: 1, corr_v_trans_jerk: true, ..ChannelData::new() };
//! let machine = MachineData { axes: [axis("X"), axis("Y"), axis("Z")], channel };
//! let program: &[u8] = b"N10 G01 X10 Y5 F1000\nM30\n";
//!
//! // On a controller a static variable: all of the memory is in it.
//! let mut memory = Channel::<3, 120>::new();
//! let handles = memory.split(&machine, [Position::ZERO; 3], program).unwrap();
//! let Handles { mut planner, mut interpolator, operator } = handles;
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
//! // In a PLC or serial task: commands, functions that are due, acknowledgements, and what happens now.
//! assert_eq!((operator.output(), operator.status().n), (None, 10));
//! assert_eq!(interpolator.set_points().map(|axis| axis.to_num::<f64>()), [10.0, 5.0, 0.0]);
//! ```
//!
//! # Where it is decided
//!
//! | question | file |
//! |---|---|
//! | how fast a corner may be taken | `dynamics/transition.rs`; as a curve: `dynamics/polynomial.rs` |
//! | whether a corner without a curve is passed or a standstill | `lookahead/worth.rs` |
//! | which curve a corner gets | `smooth/contour/choice.rs` |
//! | which curve a row of short blocks gets | `smooth/surface/mod.rs` |
//! | which curve points of a spline get | `smooth/spline/mod.rs` |
//! | how fast an arc may be taken | `dynamics/permitted.rs` |
//! | which speeds the look-ahead plans | `lookahead/plan.rs`, `lookahead/span.rs` |
//! | what a feed hold does | `plan/hold.rs`, `plan/descent.rs`, `plan/short_stop.rs` |
//! | at which point an M function comes out, and where the motion waits for it | `plan/functions.rs`, `plan/acknowledge.rs` |
//! | in which tick it comes out | `queue/actions.rs` |
//! | how an axis moves beside the path | `single/mod.rs`, `channel/beside.rs` |
//! | what a tick does, and so costs | `tick.rs`, `queue/curves.rs`, `queue/cells.rs`; the counts: `docs/figures.md` |
//! | what happens when the planner gets no time | `plan/reserve.rs` |
//! | how planner and interrupt agree on a change | `queue/time.rs`, `queue/clock.rs` |
//! | units, LSB, range and rounding of a number | `quantity.rs` |
//!
//! # Words
//!
//! | word | meaning |
//! |---|---|
//! | acknowledgement | The word of the operator that a function is carried out. |
//! | action | What is due at a point of the path: a function that is put out. |
//! | anchor | A transition where acceleration is zero. |
//! | barrier | A piece of no ticks: the interrupt passes it by a cut alone. |
//! | block | A motion as it was programmed, or a part of one, in the look-ahead. |
//! | brief block | A block that the motion passes within a tick. |
//! | channel | All memory of one path: a planner, an interpolator, an operator. |
//! | committed span | A span that left the look-ahead; the interrupt has not left it yet. |
//! | contour mode | Rounding of corners inside a tolerance (#CONTOUR MODE, G61, G261). |
//! | corner | A transition where the direction changes. |
//! | curve | The geometry of an element in the queue: a line, an arc or a polynomial; in the code a `Segment`. |
//! | cut | A change of the interrupt from one row of pieces to another, at an agreed tick. |
//! | dwell | Ticks of rest (G04). |
//! | ease | How much less than permitted a span uses so that an anchor inside it is not needed. |
//! | element | A curve over its own path length, with direction and curvature at both ends. |
//! | feed hold | A standstill on the path, wanted by the operator. |
//! | frontier | Where laws end; nothing behind it is in the queue. |
//! | gate | A point of the path that the motion passes only after acknowledgements. |
//! | instant | A tick of path motion, counted twice so that an odd number is never one. |
//! | joint | Both ends of two curves that meet. |
//! | knee | A step of direction at a transition without a curve, and the step of speed it causes. |
//! | law | The speed of a span over time. |
//! | level | The override that the look-ahead is planned for. |
//! | limits | Speed, acceleration and jerk permitted along the path. |
//! | look-ahead | The ring of blocks whose speeds may still change. |
//! | overlay | The motion of an axis beside the path, as the interrupt has it. |
//! | path distance | Length along the path since the start. |
//! | piece | A cubic of path distance over whole ticks; in the code a `Phase`. |
//! | profile | A law as ramps, with times and lengths. |
//! | programmed block | A motion block as it came from the program. |
//! | ramp | A part of a law in which acceleration rises or falls. |
//! | reserve | A way to a standstill that lies ready for a planner that gets no time. |
//! | set point | The position of an axis that a tick gives. |
//! | slope | The kind of law: STEP, TRAPEZ, SIN2 or HSC. |
//! | slope share | What is left to the slope beside a transition. |
//! | small build | A build without Surface and splines: it has less room for all that is under way. |
//! | smoother | A stage that makes elements of programmed blocks. |
//! | span | Blocks from one anchor to the next; they have one law. |
//! | stage | A step of the pipeline: it takes one type and returns the next. |
//! | stroke | A motion of one axis from rest to rest. |
//! | tick | One cycle of the interrupt. |
//! | transition | The point where two blocks meet. |
//! | valley | Where a law is slowest inside, with acceleration on both sides of a slow block. |
//! | way | A motion that leads to a standstill. |
#![no_std]
// Only six files of `queue` may have unsafe code, and each says why: `ring`, `curves`, `reserve` and `actions`, and the
// memory that they are made of, `cells` and `word`.
#![deny(unsafe_code)]

pub use axis::Axes;
pub use channel::{Channel, Error, Handles, Planner, Progress};
pub use machine::{AxisData, AxisKind, AxisName, ChannelData, MachineData};
pub use nc::{Library, Text};
pub use operator::{Operator, Status};
pub use quantity::Position;
pub use technology::{Function, Output, Technology};
pub use tick::{Interpolator, State};

// The tower: each module uses those above it alone (`host-tests/tests/papers/tower.rs`). Hidden are those that an
// application does not name.

#[doc(hidden)]
pub mod math;

pub mod quantity;

pub mod machine;

pub mod technology;

pub mod nc;

#[doc(hidden)]
pub mod path;

#[doc(hidden)]
pub mod control;

#[doc(hidden)]
pub mod queue;

pub mod fir;

#[doc(hidden)]
pub mod slope;

#[doc(hidden)]
pub mod dynamics;

pub mod single;

#[doc(hidden)]
pub mod smooth;

#[cfg(feature = "plc")]
pub mod contour_log;

#[doc(hidden)]
pub mod lookahead;

#[doc(hidden)]
pub mod plan;

pub mod tick;

pub mod axis;

pub mod operator;

#[doc(hidden)]
pub mod digest;

pub mod channel;

#[cfg(feature = "defmt")]
mod logged;

//! Glidepath reads an NC program and computes one set point per axis and timer tick, with the same bits on
//! every machine.
//!
//! The library uses no heap and no `std`. The timer interrupt calculates in integers. The planner also uses
//! floating point, but only the IEEE operations + − × ÷ √, and checks its results in integers.
//!
//! ```text
//!         planner: a task or the main loop, bounded work per call                   |  interrupt: bounded work per tick
//!
//!  text → nc ─commands→ path ─elements→ smooth → dynamics ─limits→ lookahead ─spans→ slope ─pieces→ queue → tick → axis
//!         └───────────────────────────────── plan ────────────────────────────────────┘              ↓
//!                                                                            operator: PLC, serial line, other core
//! ```
//!
//! An application holds the three handles of one [`Channel`]:
//!
//! | handle | runs in | does |
//! |---|---|---|
//! | [`Planner`] | a task or the main loop | reads text and plans; each call does a bounded piece of work |
//! | [`Interpolator`] | the timer interrupt | computes the set points of one tick |
//! | [`Operator`] | any task, or another core | gives commands, takes functions that are due, shows the status |
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
//! // On a controller, make this a static variable. It holds all of the memory.
//! let mut memory = Channel::<3, 120>::new();
//! let handles = memory.split(&machine, [Position::ZERO; 3], program).unwrap();
//! let Handles { mut planner, mut interpolator, operator } = handles;
//! let mut planned = false;
//! loop {
//!     // In the main loop or a task: plan until the queue is full, or until the whole program is planned.
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
//! // In a PLC or serial task: take due functions, acknowledge them, give commands, read the status.
//! assert_eq!((operator.output(), operator.status().n), (None, 10));
//! assert_eq!(interpolator.set_points().map(|axis| axis.to_num::<f64>()), [10.0, 5.0, 0.0]);
//! ```
//!
//! # Cargo features
//!
//! The features from `grbl` on are off by default. A build without a feature refuses the commands of that
//! feature by name.
//!
//! | feature | adds |
//! |---|---|
//! | `isg` | programs in the language of ISG controllers; a build without `grbl` always has this language |
//! | `slopes` | the slopes STEP and SIN2; a build without `grbl` always has them |
//! | `contour` | curves at corners: G61, G261, `#CONTOUR MODE` |
//! | `surface` | `#HSC [SURFACE]`: one smooth curve through many short blocks |
//! | `splines` | Akima, B-spline, HSC B-spline |
//! | `hsc` | the slope HSC |
//! | `expressions` | P parameters, functions, `$` statements |
//! | `beside` | single axes: oscillation, independent axes |
//! | `filters` | FIR filters of the axes |
//! | `fast` | fewer instructions for more flash, with `opt-level = 3` |
//! | `grbl` | programs in the language of Grbl 1.1 |
//! | `dialects` | programs in the languages of LinuxCNC and Grbl, with parameters, cycles and O words |
//! | `fanuc` | programs in the language of Fanuc controllers |
//! | `plc` | for a PLC: elements of the path ahead, real-time loops, `V.` variables |
//! | `driven` | the status counts the distance that the axes really drive, also in curves that are planned over time; `plc` enables this feature |
//! | `kinematics` | transformations of machines with rotary axes: `#KIN ID`, `#TRAFO` |
//! | `examine` | a check without planning, which reports what a run would refuse; for desktop tools |
//! | `defmt` | `defmt::Format` for errors and events |
//!
//! # Where to look in the sources
//!
//! | question | file |
//! |---|---|
//! | which speed a corner permits | `dynamics/transition.rs`; a corner with a curve: `dynamics/polynomial.rs` |
//! | whether the motion passes a corner without a curve or stops there | `lookahead/worth.rs` |
//! | which curve a corner gets | `smooth/contour/choice.rs` |
//! | which curve a run of short blocks gets | `smooth/surface/mod.rs` |
//! | which curve the points of a spline get | `smooth/spline/mod.rs` |
//! | which speed an arc permits | `dynamics/arc.rs` |
//! | how the limits of all axes become one limit of the path | `dynamics/permitted.rs` |
//! | which speeds the look-ahead plans | `lookahead/plan.rs`, `lookahead/span.rs` |
//! | how an override acts | `lookahead/pace.rs`, `plan/pace.rs` |
//! | what a feed hold does | `plan/hold.rs`, `plan/descent.rs`, `plan/short_stop.rs` |
//! | at which point an M function is output, and where the motion waits for its acknowledgement | `plan/functions.rs`, `plan/acknowledge.rs` |
//! | in which tick an M function is output | `queue/actions.rs` |
//! | which acknowledgement belongs to which function | `control/acknowledge.rs` |
//! | how an axis moves independently of the path | `single/mod.rs`, `channel/beside.rs` |
//! | what a tick does, and what it costs | `tick.rs`, `queue/curves.rs`, `queue/cells.rs`; the counts: `docs/figures.md` |
//! | what happens when the planner gets no time, or too little | `plan/reserve.rs`, `plan/late.rs` |
//! | how planner and interrupt agree on a change | `queue/time.rs`, `queue/clock.rs` |
//! | how a filter computes a set point | `fir/step.rs` |
//! | which machine data are refused | `channel/check.rs`, `machine/parameter.rs` |
//! | where inches become millimetres | `nc/compose.rs`, `nc/number.rs` |
//! | unit, LSB, range and rounding of a number | `quantity.rs` |
//!
//! # Words of the sources
//!
//! | word | meaning |
//! |---|---|
//! | acknowledgement | The operator's message that a function has been carried out. |
//! | action | A function of the program, output at a point of the path. |
//! | anchor | An end of a span: acceleration is zero there. |
//! | barrier | The end marker in the queue; the interrupt passes this marker only with a change of plan. |
//! | block | A motion of the program, or a part of one, in the look-ahead. |
//! | brief block | A very short block, of which the motion may pass several within a tick. |
//! | channel | All memory for one group of axes that follow one program, for planner, interpolator and operator. |
//! | committed span | A span that the look-ahead has released and the motion has not passed. A command may still change its profile. |
//! | contour mode | Rounding of corners inside a tolerance (#CONTOUR MODE, G61, G261). |
//! | corner | A transition where the direction changes. |
//! | curve | Geometry between two points: a line, an arc or a polynomial; in the queue, a `Segment`. |
//! | cut | The tick at which the interrupt changes from one plan to another. |
//! | dwell | A programmed pause (G04). |
//! | ease | The margin between the motion and the limits of a span, so that acceleration at its end need not be zero. |
//! | element | A curve over its own path length, with direction and curvature at both ends. |
//! | feed hold | A stop on the path, by a command of the operator. |
//! | frontier | The end of the planned pieces in the queue. |
//! | gate | A synchronisation point: the motion passes this point only after all demanded acknowledgements. |
//! | instant | Twice the number of ticks that used a piece (motion, dwell, or the tick that shows a standstill). An odd number means "never". |
//! | joint | In names of the code: a transition. |
//! | knee | A corner without a curve; also the step of speed that such a corner causes in an axis. |
//! | law | In names of the code: a speed profile. |
//! | level | The override for which the look-ahead is planned. The level follows the operator's override with a delay. |
//! | limits | Speed, acceleration and jerk permitted along the path. |
//! | look-ahead | The ring of blocks whose speeds may still change. |
//! | overlay | The motion of a single axis, as the interrupt takes it. |
//! | path distance | Length along the path since the start. In a curve that is planned over time: time multiplied by the feed. |
//! | piece | The path distance as a cubic polynomial of time, for a whole number of ticks; a `Phase` in the code. |
//! | profile | The path speed of a span over time: ramps with times and lengths. |
//! | programmed block | A motion block as the program has it. |
//! | ramp | A part of a profile in which acceleration rises or falls. |
//! | reserve | The stop that the interrupt uses if the planner gets no time. |
//! | row | A run: consecutive short blocks that Surface or a spline turns into one curve. |
//! | set point | The position of an axis for one tick. |
//! | slope | The kind of speed profile: STEP, TRAPEZ, SIN2 or HSC. |
//! | slope share | The part of a jerk limit that a transition leaves to the slope. |
//! | small build | A build without the features `surface` and `splines`; its queue has less room. |
//! | smoother | A stage that turns programmed blocks into elements. |
//! | span | Consecutive blocks with one speed profile; acceleration is zero at both ends. |
//! | stage | A step of the pipeline, which takes one type and returns the next. |
//! | stroke | A motion of a single axis from stop to stop. |
//! | tick | One cycle of the timer interrupt. |
//! | transition | The point where two blocks or two curves meet. |
//! | valley | A slow block that the axes enter while braking and leave while accelerating. |
//! | way | In names of the code: a braking path, the motion to a stop. |
#![cfg_attr(
    all(feature = "grbl", not(feature = "slopes")),
    allow(unreachable_patterns, reason = "nothing matches STEP in a build without it")
)]
#![no_std]
// Six files of `queue` have unsafe code, and each says why: `ring`, `curves`, `reserve`, `actions`, and their memory,
// `cells` and `word`.
#![deny(unsafe_code)]

pub use axis::Axes;
pub use channel::{Channel, Error, Handles, Planner, Progress};
pub use machine::{AxisData, AxisKind, AxisName, ChannelData, MachineData};
pub use nc::{Library, Text};
pub use operator::{Operator, Status};
pub use quantity::Position;
pub use technology::{Function, Output, Technology};
pub use tick::{Interpolator, State};

// Each module uses only modules above it (`host-tests/tests/papers/tower.rs`). Modules that an application does not name
// are hidden.

#[doc(hidden)]
pub mod math;

pub mod quantity;

pub mod machine;

pub mod technology;

#[cfg(feature = "plc")]
pub mod variable;

pub mod nc;

#[doc(hidden)]
pub mod path;

#[cfg(feature = "kinematics")]
pub mod kinematics;

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

#[cfg(feature = "plc")]
pub mod rt_loop;

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

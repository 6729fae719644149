//! The tests' measure of the interpolator. This crate uses only the public types of the library's interface,
//! so checker, reference and cases notice errors of the library.
//!
//! | module | question it answers |
//! |---|---|
//! | [`accept`] | are the figures those of the accepted tables |
//! | [`beside`] | and what do axes that move beside the path |
//! | [`calls`] | how is the planner called between two ticks |
//! | [`cases`] | which programs on which machines |
//! | [`cam`] | which programs of short blocks |
//! | [`seeds`] | which random cases, the same ones each time and others |
//! | [`never_slower`] | and is a smoothed program slower than standstills, less tolerance or less feed |
//! | [`holds`] | and how long does a feed hold take against the shortest stop on the path ahead |
//! | [`unlike`] | and do limits hold where axes are nothing alike |
//! | [`five_axes`] | where the tool is on a machine with rotary axes |
//! | [`trace`] | what the library made of them, tick by tick |
//! | [`check`] | is that a permitted motion on the programmed contour (needs no reference) |
//! | [`mod@reference`] | what would exact arithmetic have done |
//! | [`tolerance`] | how far apart may the two be, and why |
//! | [`corner`] | is what becomes of a single corner smooth and inside its tolerance |
//! | [`filtered`] | what becomes of it behind filters |
//! | [`rounded`] | what becomes of a text with rounded corners |
//! | [`splines`] | random runs with splines |
//! | [`loops`] | and what comes of a loop of many passes |
//! | [`mod@refusal`] | what is refused |
//! | [`deviation`] | is all of a contour inside it |
//! | [`every_tick`] | and when a hold or a planner without time comes before each tick |
//! | [`operate`] | and while an operator gives commands |
//! | [`cores`] | and with planner, interrupt and operator on a core each |
//! | [`sequences`] | what comes of programs, single lines and aborts one behind the other |
//! | [`properties`] | do all of these agree that the motion is a good one |

pub mod accept;

pub mod beside;

pub mod calls;

pub mod chains;

pub mod cases;

pub mod cam;

pub mod cores;

pub mod five_axes;

pub mod seeds;

pub mod sequences;

pub mod trace;
pub mod walk;

pub mod check;

pub mod reference;

pub mod tolerance;

pub mod properties;

pub mod corner;

pub mod deviation;

pub mod every_tick;

pub mod operate;

pub mod filtered;
/// Questions about what comes, against what then happens.
pub mod foresee;

pub mod rounded;

pub mod soak;

pub mod refusal;
/// Requests of a PLC from another thread.
pub mod requests;

pub mod sphere;
pub mod splines;

pub mod mutate;

pub mod loops;

pub mod never_slower;

pub mod holds;

pub mod shortest;

pub mod unlike;

/// The examples of the papers, as tests of the documentation.
#[cfg(doctest)]
#[doc = include_str!("../../docs/linking.md")]
pub mod linking {}

#[cfg(doctest)]
#[doc = include_str!("../../docs/machine-data.md")]
pub mod machine_data {}

#[cfg(doctest)]
#[doc = include_str!("../../docs/plc.md")]
pub mod plc {}

//! Arithmetic with the same bits on every machine, built from operations that a Cortex-M4F does in one
//! instruction.
//!
//! On a 32-bit core, the compiler turns 128-bit products and 64-bit quotients into library calls. The
//! functions here use products of 32 by 32 bits and one 32-bit hardware division instead. Where they use
//! `f32`, they use only IEEE operations, which round in the same way on every machine.
pub mod float;
pub mod soft;
pub mod wide;

pub mod divide;

pub mod root;

pub mod trig;

pub mod angle;

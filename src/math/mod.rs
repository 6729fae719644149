//! Integer arithmetic that is the same everywhere, cut to what a Cortex-M4 does in one instruction.
//!
//! The compiler's own 128-bit products and 64-bit quotients become library calls on a 32-bit core; these
//! functions use 32×32→64 products and one hardware 32-bit division instead. All but the `f32` roots are pure
//! integer code; the roots use only IEEE operations that round alike on every machine.
pub mod float;
pub mod wide;

pub mod divide;

pub mod root;

pub mod trig;

pub mod angle;

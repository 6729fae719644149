//! The decoder: converts program text to typed commands. The decoder knows text and modal state, but not the
//! limits of the machine.
//!
//! Applications use three items of this module. [`Text`] is a source of program text; a `&[u8]` implements
//! it. [`Window`] is a buffer for text that arrives over a serial line. [`Library`] holds a program with its
//! subroutines:
//!
//! ```
//! use glidepath::nc::{Library, Text};
//!
//! let mut library = Library { main: b"L hole\nM30\n", files: &[("hole.nc", b"G01 Z-1 F600\nG00 Z1\nM17\n")] };
//! assert_eq!(library.open("hole"), Ok(Some(1))); // what the decoder asks for at `L hole`
//! let mut first = [0; 7];
//! assert_eq!(library.read(1, 0, &mut first), Ok(7));
//! assert_eq!(&first, b"G01 Z-1");
//! ```
//!
//! The files of the module:
//!
//! ```text
//!  Text → line ─logical lines→ interpreter ┬ flow, control   $ statements, calls, jumps
//!                                          ├ plain           lines of N, G00, G01, F and axes alone, in one pass
//!                                          ├ block, compose  words: G, axes, F, M …, and the motion they make
//!                                          ├ hash, keyword   # commands and axis[…] with their keywords
//!                                          ├ variable        V. variables (feature `plc`)
//!                                          └ dialect         lines of programs of Grbl, LinuxCNC and Fanuc
//! ```
//!
//! Programmed decimals stay decimal until their unit is known. The targets of a [`Motion`] are then rounded
//! once, to 2^-32 mm or degrees. Expressions use f64 with + − × ÷ only, so all machines give the same bits.

mod axis_command;
mod block;
mod calculator;
mod command;
mod compose;
mod control;
mod cursor;
mod decoder;
#[cfg(feature = "grbl")]
mod dialect;
mod error;
mod expression;
mod flow;
mod function;
mod hash;
mod interpreter;
mod keyword;
mod line;
mod modal;
mod number;
mod parameter;
mod plain;
mod real;
mod restart;
mod smoothing;
mod stream;
#[cfg(feature = "plc")]
mod synch_variable;
mod text;
#[cfg(feature = "plc")]
mod variable;

pub use command::*;
pub(crate) use decoder::Restriction;
pub use decoder::{Decoder, DecoderMemory, Step};
#[cfg(feature = "grbl")]
pub use dialect::{ADDRESSES, AddressEntry, ForeignSetup, InForce, StoredOffsets, WORDS, WordEntry};
use error::{Fault, Span};
pub use error::{NcError, NcErrorKind, NcWarning, NcWarningKind};
pub use expression::EXPRESSION_DEPTH;
pub use flow::{CALL_DEPTH, NESTING, SUBROUTINES};
pub use function::*;
pub use interpreter::{BLOCK_WORDS, QUIET_LINES};
pub use line::{CONTINUATIONS, LINE_BYTES};
pub use modal::COORDINATE_MAX;
pub use parameter::PARAMETERS;
pub use stream::{Feeder, Stream, Window};
pub use text::*;
#[cfg(feature = "plc")]
pub(crate) use variable::Externals;

use crate::quantity::Position;

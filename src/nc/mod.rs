//! Program text to typed commands. Knows text and modal state, nothing of a machine's dynamics.
//!
//! ```text
//!  Text → line ─logical lines→ interpreter ┬ flow, control   $ statements, calls, jumps
//!                                          ├ plain           lines of N, G00, G01, F and axes alone, at once
//!                                          ├ block           words: G, axes, F, M …, and the motion they make
//!                                          ├ hash, keyword   # commands and axis[…] with their keywords
//!                                          └ dialect         lines of programs of Grbl and LinuxCNC
//! ```
//!
//! Numbers are decimals as long as nothing is calculated ([`Motion`] targets are the decimal rounded once, to
//! 2^-32); expressions are f64 from + − × ÷ alone, the same bits everywhere.

mod axis_command;
mod block;
mod calculator;
mod command;
mod compose;
mod control;
mod cursor;
mod decoder;
#[cfg(feature = "dialects")]
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
mod text;

pub use command::*;
pub(crate) use decoder::Restriction;
pub use decoder::{Decoder, DecoderMemory, Step};
#[cfg(feature = "dialects")]
pub use dialect::{ADDRESSES, ForeignSetup, InForce, StoredOffsets, WORDS, WordEntry};
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

use crate::quantity::Position;

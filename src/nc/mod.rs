//! Program text to typed commands. Knows text and modal state, nothing of a machine's dynamics.

mod command;
mod text;

pub use command::*;
pub use text::*;

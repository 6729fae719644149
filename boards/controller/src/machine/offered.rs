//! The line that is with the decoder.
use super::{Machine, refusal::refusal};
use crate::motion::Taken;
use glidepath::channel::Error;
use glidepath::tick::State;

/// Why the text at hand has come to an end.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum End {
    /// M2, M30, `%`.
    Program,
    /// A line was refused.
    Refused,
    /// Aborted.
    Aborted,
}

/// How far the line at hand is.
pub struct Offered {
    /// It is with the decoder.
    pub offered: bool,
    /// It is taken, and answered at rest: `G4`, the end of a program.
    pub waits: bool,
    /// It is taken, and its pause is not put out yet.
    pub pauses: bool,
    /// The decoder has come to an end, or will: no line is taken until it goes on at rest.
    pub end: Option<End>,
    /// What the planner said of the line.
    pub error: Option<Error>,
}

impl Offered {
    /// None is at hand.
    pub const NONE: Self = Self { offered: false, waits: false, pauses: false, end: None, error: None };
}

impl<const AXES: usize, const BLOCKS: usize, const OVERLAYS: usize> Machine<'_, AXES, BLOCKS, OVERLAYS> {
    /// Hands a line to the decoder, once. `beyond` is the number for a motion that leaves the software limits.
    pub(super) fn offer(&mut self, text: &[u8], beyond: u8) -> Taken {
        if !self.line.offered {
            if self.line.end.is_some() || !self.spool.is_read() || self.planner.in_force().is_none() {
                self.work();
                return Taken::NotYet;
            }
            self.spool.push(text);
            self.line.offered = true;
        }
        self.work();
        let stands = self.operator.status().state == State::Idle;
        if self.line.error.is_some() && self.line.end.is_some() && stands {
            // Answered when the next line can be read, so that a sender finds the machine idle.
            return Taken::NotYet;
        }
        if let Some(error) = self.line.error.take() {
            self.line.offered = false;
            return Taken::Refused(refusal(&error, beyond));
        }
        let is_taken = self.spool.is_read() && self.planner.in_force().is_some();
        if is_taken || self.line.end.is_some() {
            self.line.offered = false;
            return Taken::Yes;
        }
        Taken::NotYet
    }

    /// The answer of a line that is answered at rest.
    pub(super) fn answer_at_rest(&mut self) -> Taken {
        if self.line.waits {
            self.work();
        }
        self.line.waits &= self.is_under_way();
        if self.line.waits {
            return Taken::NotYet;
        }
        self.kept.program = None;
        Taken::Yes
    }
}

//! Passes a line to the decoder, and follows the line until its answer is known.
use super::{Machine, refusal::refusal};
use crate::motion::Taken;
use glidepath::channel::Error;
use glidepath::tick::State;

/// Why the current text has ended.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum End {
    /// M2, M30, `%`.
    Program,
    /// A line was refused.
    Refused,
    /// The operator or a probe aborted the text.
    Aborted,
}

/// State of the current line.
pub struct Offered {
    /// The decoder is working on the line.
    pub offered: bool,
    /// The line is decoded, and the answer comes at standstill: `G4`, the end of a program.
    pub waits: bool,
    /// The line is decoded, and its pause is not output yet.
    pub pauses: bool,
    /// The text has ended or will end: the controller takes no line until the planner continues at
    /// standstill.
    pub end: Option<End>,
    /// The planner's result for the line.
    pub error: Option<Error>,
    /// Tick since which a block waits for the next one while the axes stand.
    pub stands: Option<u32>,
}

impl Offered {
    /// None is at hand.
    pub const NONE: Self =
        Self { offered: false, waits: false, pauses: false, end: None, error: None, stands: None };
}

impl<const AXES: usize, const BLOCKS: usize, const OVERLAYS: usize> Machine<'_, AXES, BLOCKS, OVERLAYS> {
    /// Passes a line to the decoder, once. `beyond` is the error number for a motion beyond the software
    /// limits.
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
            // The answer waits until the next line can be read, so that a sender finds the machine idle.
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

    /// In contour mode a block waits for the next one, because both share a corner. If no line has come and the axes
    /// have stood for `us` microseconds, the block is executed without the next one, as if `G4P0` stood behind it.
    pub(super) fn go_without(&mut self, us: u32) {
        let (status, line) = (self.operator.status(), &self.line);
        let is_idle =
            status.state == State::Idle && !self.operator.commands().hold && !self.planner.is_at_rest();
        let has_other_cause =
            line.offered || line.waits || line.pauses || line.end.is_some() || self.cycles.homing.is_some();
        let reads = self.spool.is_read() && self.planner.in_force().is_some();
        if !is_idle || has_other_cause || !reads {
            self.line.stands = None;
            return;
        }
        let since = *self.line.stands.get_or_insert(status.ticks);
        // Ticks count modulo 2^31.
        let ticks = status.ticks.wrapping_sub(since) & (u32::MAX >> 1);
        if ticks.saturating_mul(self.data.channel.cycle_us) >= us {
            self.line.stands = None;
            self.spool.push(b"G4P0");
        }
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

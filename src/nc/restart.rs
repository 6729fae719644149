//! Begins another program, and restores the state after a refused line. After a refusal, only changes of
//! parameters remain.
use super::NcErrorKind;
use super::flow::Passing;
use super::interpreter::{Gathered, Interpreter, Next, Phase};
use super::line::Mark;
#[cfg(feature = "grbl")]
use super::modal::Mode;
use super::modal::{Before, Modal};

impl<const AXES: usize> Interpreter<AXES> {
    /// Begins another program. With `keeps`, the modal state stays in force.
    pub fn restart(&mut self, keeps: bool) {
        self.phase = Phase::Start;
        self.flow.clear();
        #[cfg(feature = "grbl")]
        self.clear_calls();
        if !keeps {
            self.calculator.parameters.clear();
            #[cfg(feature = "plc")]
            self.reset_functions();
            #[cfg(feature = "grbl")]
            let kept = self.modal;
            self.modal = Modal::new(self.setup.default_index);
            #[cfg(feature = "grbl")]
            if !self.is_isg() {
                self.modal = kept;
                self.begin_program(Mode::Rapid);
            }
        }
        self.before = Before::Alike;
        self.n = 0;
        self.drop_line();
    }

    /// Refuses the current line: the modal state from before the line is restored. P parameters keep assigned
    /// values.
    pub fn refuse(&mut self) {
        #[cfg(feature = "grbl")]
        self.refuse_foreign();
        match core::mem::replace(&mut self.before, Before::Alike) {
            Before::Alike => {}
            Before::Feed(mode, feed) => (self.modal.mode, self.modal.feed) = (mode, feed),
            Before::All(modal) => self.modal = modal,
        }
        self.drop_line();
    }

    /// Drops the rest of the current line.
    fn drop_line(&mut self) {
        #[cfg(feature = "plc")]
        {
            (self.written, self.in_loop) = (None, false);
        }
        self.queue.clear();
        self.warnings.clear();
        self.gathered = Gathered::Nothing;
        self.calculator.reset();
        self.moves = false;
        self.quiet = 0;
    }

    /// The line at which the program continues after a refusal at an earlier place, or at the end of the
    /// running program. Returns `None` for the next line.
    pub fn recover(&mut self, kind: NcErrorKind) -> Option<Mark> {
        match (kind, self.flow.passing) {
            (NcErrorKind::NoLabel, _) => {
                self.flow.passing = Passing::No;
                Some(self.flow.behind)
            }
            (NcErrorKind::Unclosed { .. }, passing) => {
                self.flow.leave_blocks();
                let next = match passing {
                    Passing::End(ending) => self.end_by_word(ending),
                    _ => self.finish_program(),
                };
                if let Next::At(mark) = next { Some(mark) } else { None }
            }
            (NcErrorKind::NoMainProgram, _) => {
                self.phase = Phase::Ended;
                None
            }
            _ => None,
        }
    }

    /// Cancels a jump that was already decided, because it is refused.
    pub fn stay(&mut self, mark: Mark) {
        if core::mem::take(&mut self.flow.left) {
            // No control block is open any more.
        } else if matches!(self.flow.passing, Passing::Label(_)) {
            self.flow.passing = Passing::No;
        } else if self.flow.innermost().is_some_and(|open| open.body == mark) {
            self.flow.blocks.pop();
        } else if self.flow.program == mark {
            self.flow.leave_call();
        }
    }
}

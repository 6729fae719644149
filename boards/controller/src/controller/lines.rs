//! Carries out received lines and answers each with `ok` or an error number.
use super::{Around, Controller, Mode};
use crate::line::{Assembler, Line};
use crate::motion::{Motion, Refusal, Taken};
use crate::store::Store;

/// Reason why the current line has no answer yet.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Waiting {
    Room,
    Homing,
}

/// Answer to a line.
pub(crate) enum Reply {
    Now(Result<(), Refusal>),
    /// `ok`, then a restart with the banner.
    Restart,
    Later(Waiting),
    /// The line has its answer already.
    Silent,
}

impl Reply {
    pub(crate) const OK: Self = Self::Now(Ok(()));

    pub(crate) fn error(code: u8) -> Self {
        Self::Now(Err(Refusal::new(code)))
    }
}

/// The store has failed.
pub(crate) const NOT_STORED: u8 = 7;

/// Highest number of bytes that a poll reads.
const BYTES_PER_POLL: usize = 256;

impl<const AXES: usize, const N: usize> Controller<'_, AXES, N> {
    /// Whether a line may be carried out now.
    fn reads(&self) -> bool {
        !matches!(self.mode, Mode::Alarm(true) | Mode::Home | Mode::JogStop | Mode::Sleep | Mode::Stopping(_))
    }

    pub(super) fn lines<M: Motion<AXES>, S: Store<AXES>, W: embedded_io::Write>(
        &mut self,
        around: &mut Around<'_, '_, M, S, W>,
    ) {
        if !self.reads() || !self.start_up(around) {
            return;
        }
        match self.waiting {
            Some(Waiting::Room) => return self.carry_out(around),
            Some(Waiting::Homing) => return self.answer(around, Reply::OK),
            None => {}
        }
        for _ in 0..BYTES_PER_POLL {
            let Some(byte) = self.inbox.byte() else { return };
            match self.line.push(byte) {
                Some(Line::Complete) => return self.carry_out(around),
                Some(Line::TooLong) => return self.answer(around, Reply::error(11)),
                None => {}
            }
        }
    }

    /// Carries out startup lines. Returns whether they are done.
    fn start_up<M: Motion<AXES>, S, W: embedded_io::Write>(
        &mut self,
        around: &mut Around<'_, '_, M, S, W>,
    ) -> bool {
        while let Some(line) = self.config.startup.get(usize::from(self.startup)) {
            if !line.is_empty() {
                let taken = around.motion.take(line);
                if taken == Taken::NotYet {
                    return false;
                }
                around.out.part(format_args!(">"));
                around.out.bytes(line);
                match taken {
                    Taken::Refused(refusal) => around.out.line(format_args!(":error:{}", refusal.code)),
                    _ => around.out.line(format_args!(":ok")),
                }
            }
            self.startup += 1;
        }
        true
    }

    fn carry_out<M: Motion<AXES>, S: Store<AXES>, W: embedded_io::Write>(
        &mut self,
        around: &mut Around<'_, '_, M, S, W>,
    ) {
        // The line is taken out and put back, because the command may change everything else.
        let line = core::mem::replace(&mut self.line, Assembler::new(self.config.text));
        let reply = match line.stripped() {
            [] => Reply::OK,
            [b'$', command @ ..] => self.system(around, command),
            _ => self.program_line(around, line.text()),
        };
        self.line = line;
        self.answer(around, reply);
    }

    fn program_line<M: Motion<AXES>, S: Store<AXES>, W: embedded_io::Write>(
        &mut self,
        around: &mut Around<'_, '_, M, S, W>,
        text: &[u8],
    ) -> Reply {
        match self.mode {
            Mode::Check => Reply::Now(around.motion.check(text)),
            Mode::Ready | Mode::Hold | Mode::Door(_) => {
                let taken = around.motion.take(text);
                if taken == Taken::Yes && !self.store_offsets(around) {
                    return Reply::error(NOT_STORED);
                }
                Reply::of(taken)
            }
            _ => Reply::error(9),
        }
    }

    fn answer<M: Motion<AXES>, S, W: embedded_io::Write>(
        &mut self,
        around: &mut Around<'_, '_, M, S, W>,
        reply: Reply,
    ) {
        self.waiting = None;
        match reply {
            Reply::Now(Ok(())) => around.out.line(format_args!("ok")),
            Reply::Now(Err(Refusal { code, message })) => {
                if !message.is_empty() {
                    around.out.line(format_args!("[MSG:{message}]"));
                }
                around.out.line(format_args!("error:{code}"));
            }
            Reply::Restart => {
                around.out.line(format_args!("ok"));
                self.restart(around);
            }
            Reply::Later(waiting) => self.waiting = Some(waiting),
            Reply::Silent => {}
        }
    }
}

impl Reply {
    pub(crate) fn of(taken: Taken) -> Self {
        match taken {
            Taken::Yes => Self::OK,
            Taken::NotYet => Self::Later(Waiting::Room),
            Taken::Refused(refusal) => Self::Now(Err(refusal)),
        }
    }
}

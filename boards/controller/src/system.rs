//! Carries out lines that begin with `$`: settings, reports, homing, jog, check mode.
use crate::controller::{Around, Controller, Mode, NOT_STORED, Reply, Stored, Waiting};
use crate::jog;
use crate::motion::Motion;
use crate::report::{self, RECEIVE_BYTES};
use crate::settings::Settings;
use crate::state::{Signals, State};
use crate::store::Store;

const UNKNOWN: u8 = 3;
const HOMING_OFF: u8 = 5;
const NOT_IDLE: u8 = 8;
const DOOR_OPEN: u8 = 13;
const STORED_TOO_LONG: u8 = 14;

/// Number of planner blocks in `$I`.
const BLOCKS: usize = 15;

impl<const AXES: usize, const N: usize> Controller<'_, AXES, N> {
    /// Carries out the command after `$`.
    pub(crate) fn system<M: Motion<AXES>, S: Store<AXES>, W: embedded_io::Write>(
        &mut self,
        around: &mut Around<'_, '_, M, S, W>,
        command: &[u8],
    ) -> Reply {
        let status = around.motion.status();
        let state = self.state(&status);
        // In an alarm the axes may still brake, and a write of the store would block the interrupt.
        let is_idle = match state {
            State::Alarm => status.is_at_rest,
            _ => state == State::Idle,
        };
        match command {
            [] => {
                let text = "[HLP:$$ $# $G $I $N $x=val $Nx=line $J=line $SLP $C $X $H ~ ! ? ctrl-x]";
                around.out.line(format_args!("{text}"));
                Reply::OK
            }
            b"$" if matches!(state, State::Run | State::Hold(_)) => Reply::error(NOT_IDLE),
            b"$" => {
                report::settings(&mut around.out, &self.config.settings);
                Reply::OK
            }
            b"G" => {
                report::modal(&mut around.out, around.motion, self.config.settings.inch);
                Reply::OK
            }
            b"C" => self.check_mode(around, state),
            b"X" => self.unlock(around),
            [b'J', b'=', words @ ..] => self.jog(around, state, words),
            b"#" | b"I" | b"N" | b"H" | b"SLP" if !is_idle => Reply::error(NOT_IDLE),
            b"#" => {
                let offsets = around.motion.offsets();
                report::offsets(&mut around.out, &offsets, self.config.settings.inch);
                Reply::OK
            }
            b"I" => {
                around.out.part(format_args!("[VER:1.1h.20190825:"));
                around.out.bytes(&self.config.info);
                around.out.line(format_args!("]"));
                around.out.line(format_args!("[OPT:V,{BLOCKS},{RECEIVE_BYTES}]"));
                Reply::OK
            }
            b"N" => {
                for (line, number) in self.config.startup.iter().zip(0..) {
                    around.out.part(format_args!("$N{number}="));
                    around.out.bytes(line);
                    around.out.line(format_args!(""));
                }
                Reply::OK
            }
            b"H" => self.home(around),
            b"SLP" => {
                self.mode = Mode::Sleep;
                around.motion.reset();
                around.out.line(format_args!("ok"));
                around.out.line(format_args!("[MSG:Sleeping]"));
                // The answer comes before the message.
                Reply::Silent
            }
            [b'N', number @ b'0'..=b'1', b'=', line @ ..] => self.startup_line(around, state, *number, line),
            [b'I', b'=', text @ ..] if is_idle => self.set_info(around, text),
            [b'R', b'S', b'T', b'=', what] if is_idle => self.restore(around, *what),
            [b'0'..=b'9', ..] if is_idle => self.set(around, command),
            [b'I', b'=', ..] | [b'R', b'S', b'T', b'=', _] | [b'0'..=b'9', ..] => Reply::error(NOT_IDLE),
            _ => Reply::error(UNKNOWN),
        }
    }

    fn check_mode<M: Motion<AXES>, S, W: embedded_io::Write>(
        &mut self,
        around: &mut Around<'_, '_, M, S, W>,
        state: State,
    ) -> Reply {
        match state {
            State::Check => {
                around.out.line(format_args!("[MSG:Disabled]"));
                Reply::Restart
            }
            State::Idle => {
                self.mode = Mode::Check;
                around.out.line(format_args!("[MSG:Enabled]"));
                Reply::OK
            }
            _ => Reply::error(NOT_IDLE),
        }
    }

    fn unlock<M: Motion<AXES>, S, W: embedded_io::Write>(
        &mut self,
        around: &mut Around<'_, '_, M, S, W>,
    ) -> Reply {
        if matches!(self.mode, Mode::Alarm(_)) {
            if around.signals.has(Signals::DOOR) {
                return Reply::error(DOOR_OPEN);
            }
            around.out.line(format_args!("[MSG:Caution: Unlocked]"));
            self.mode = Mode::Ready;
        }
        Reply::OK
    }

    fn jog<M: Motion<AXES>, S, W: embedded_io::Write>(
        &mut self,
        around: &mut Around<'_, '_, M, S, W>,
        state: State,
        words: &[u8],
    ) -> Reply {
        if !matches!(state, State::Idle | State::Jog) {
            return Reply::error(NOT_IDLE);
        }
        match jog::read(words, &self.config.names, &around.motion.modal()) {
            Ok(jog) => {
                let reply = Reply::of(around.motion.jog(&jog));
                // A waiting jog comes here too, because the same line is given again.
                if matches!(reply, Reply::Now(Ok(())) | Reply::Later(_)) {
                    self.mode = Mode::Jog;
                }
                reply
            }
            Err(code) => Reply::error(code),
        }
    }

    fn home<M: Motion<AXES>, S, W: embedded_io::Write>(
        &mut self,
        around: &mut Around<'_, '_, M, S, W>,
    ) -> Reply {
        if !self.config.settings.homing {
            return Reply::error(HOMING_OFF);
        }
        if around.signals.has(Signals::DOOR) {
            return Reply::error(DOOR_OPEN);
        }
        around.motion.home();
        self.mode = Mode::Home;
        Reply::Later(Waiting::Homing)
    }

    fn startup_line<M: Motion<AXES>, S: Store<AXES>, W: embedded_io::Write>(
        &mut self,
        around: &mut Around<'_, '_, M, S, W>,
        state: State,
        number: u8,
        line: &[u8],
    ) -> Reply {
        if state != State::Idle {
            return Reply::error(NOT_IDLE);
        }
        let Ok(stored) = Stored::from_slice(line) else { return Reply::error(STORED_TOO_LONG) };
        // The line is checked for errors before it is stored.
        if !line.is_empty()
            && let Err(refusal) = around.motion.check(line)
        {
            return Reply::Now(Err(refusal));
        }
        let [first, second] = &self.config.startup;
        let startup = if number & 1 == 0 { [&stored, second] } else { [first, &stored] }.map(Stored::clone);
        let info = self.config.info.clone();
        self.take_texts(around.store, startup, info)
    }

    fn set_info<M, S: Store<AXES>, W: embedded_io::Write>(
        &mut self,
        around: &mut Around<'_, '_, M, S, W>,
        text: &[u8],
    ) -> Reply {
        let Ok(stored) = Stored::from_slice(text) else { return Reply::error(STORED_TOO_LONG) };
        self.take_texts(around.store, self.config.startup.clone(), stored)
    }

    /// Makes texts active after the store has written them.
    fn take_texts(&mut self, store: &mut impl Store<AXES>, startup: [Stored; 2], info: Stored) -> Reply {
        let [first, second] = &startup;
        if !store.texts([first, second], &info) {
            return Reply::error(NOT_STORED);
        }
        (self.config.startup, self.config.info) = (startup, info);
        Reply::OK
    }

    fn set<M: Motion<AXES>, S: Store<AXES>, W: embedded_io::Write>(
        &mut self,
        around: &mut Around<'_, '_, M, S, W>,
        command: &[u8],
    ) -> Reply {
        let mut settings = self.config.settings;
        if let Err(code) = settings.set(command, self.config.has_pwm) {
            return Reply::error(code);
        }
        self.take_settings(around, settings)
    }

    /// Makes settings active if the machine supports them and the store has written them.
    fn take_settings<M: Motion<AXES>, S: Store<AXES>, W: embedded_io::Write>(
        &mut self,
        around: &mut Around<'_, '_, M, S, W>,
        settings: Settings<AXES>,
    ) -> Reply {
        if let Err(refusal) = around.motion.configure(&settings) {
            return Reply::Now(Err(refusal));
        }
        if !around.store.settings(&settings) {
            // Restores the old settings, which the machine supported before.
            let _ = around.motion.configure(&self.config.settings);
            return Reply::error(NOT_STORED);
        }
        self.config.settings = settings;
        Reply::OK
    }

    fn restore<M: Motion<AXES>, S: Store<AXES>, W: embedded_io::Write>(
        &mut self,
        around: &mut Around<'_, '_, M, S, W>,
        what: u8,
    ) -> Reply {
        let (settings, offsets) = match what {
            b'$' => (true, false),
            b'#' => (false, true),
            b'*' => (true, true),
            _ => return Reply::error(UNKNOWN),
        };
        if settings && let failed @ Reply::Now(Err(_)) = self.take_settings(around, self.config.defaults) {
            return failed;
        }
        if offsets {
            around.motion.clear_offsets();
            if !self.store_offsets(around) {
                return Reply::error(NOT_STORED);
            }
        }
        let none = [const { Stored::new() }; 2];
        if what == b'*'
            && let failed @ Reply::Now(Err(_)) = self.take_texts(around.store, none, Stored::new())
        {
            return failed;
        }
        around.out.line(format_args!("[MSG:Restoring defaults]"));
        Reply::Restart
    }
}

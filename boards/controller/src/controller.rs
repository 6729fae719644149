//! The Grbl controller as a state machine. One call of [`Controller::poll`] handles everything that has
//! arrived since the last call: bytes, pins, and results of the motion.
mod keeping;
mod lines;
mod outputs;
mod requests;

pub(crate) use lines::{NOT_STORED, Reply, Waiting};
pub use outputs::Outputs;

use crate::inbox::{Inbox, Request};
use crate::line::{Assembler, LineText};
use crate::motion::{Message, Motion, Overrides};
use crate::report::{self, Due, Text};
use crate::settings::Settings;
use crate::state::Signals;
use crate::store::Store;
use glidepath::machine::AxisName;
use glidepath::nc::StoredOffsets;
use heapless::Vec;

/// Bytes of a startup line and of the text of `$I`.
pub const STORED_BYTES: usize = 80;

/// A line that comes from the store.
pub type Stored = Vec<u8, STORED_BYTES>;

/// Start values of the controller: choices of the build, and values from the store.
#[derive(Clone, Debug)]
pub struct Config<const AXES: usize> {
    /// Names of the axes, one letter each.
    pub names: [AxisName; AXES],
    /// Form in which the motion side gets a line.
    pub text: LineText,
    /// The spindle has a variable speed.
    pub has_pwm: bool,
    /// Reports contain the current line number (`Ln:`).
    pub line_numbers: bool,
    /// `$` settings.
    pub settings: Settings<AXES>,
    /// The settings that `$RST=$` restores.
    pub defaults: Settings<AXES>,
    /// The controller begins in Alarm, as with `$22=1`, because the position may be lost.
    pub is_locked: bool,
    /// A message that follows the first banner.
    pub notice: Message,
    /// `$N0` and `$N1`.
    pub startup: [Stored; 2],
    /// Text of `$I`.
    pub info: Stored,
}

impl<const AXES: usize> Config<AXES> {
    /// Grbl's default settings for axes with these names.
    pub const fn new(names: [AxisName; AXES]) -> Self {
        Self {
            names,
            text: LineText::Grbl,
            has_pwm: true,
            line_numbers: false,
            settings: Settings::new(),
            defaults: Settings::new(),
            is_locked: false,
            notice: Message::new(),
            startup: [Stored::new(), Stored::new()],
            info: Stored::new(),
        }
    }
}

/// State of a stop for the safety door.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Door {
    /// The axes brake.
    Braking,
    /// Spindle and coolant are off.
    Parked,
    /// Spindle and coolant restart, since this time.
    Resuming(u32),
}

/// The current activity.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Mode {
    /// Idle or Run.
    Ready,
    Hold,
    Jog,
    /// A jog was cancelled and brakes.
    JogStop,
    /// `true`: only a reset ends the alarm.
    Alarm(bool),
    Door(Door),
    Check,
    Home,
    Sleep,
    /// The axes brake for a reset. The value says whether the machine is locked afterwards.
    Stopping(bool),
}

/// All inputs of one call of the controller.
pub(crate) struct Around<'m, 'w, M, S, W: embedded_io::Write> {
    pub(crate) now_ms: u32,
    pub(crate) signals: Signals,
    pub(crate) motion: &'m mut M,
    pub(crate) store: &'m mut S,
    pub(crate) out: Text<'w, W>,
}

/// The inputs of a call: time, pins, the motion side, the store.
pub struct Look<'m, M, S> {
    /// A clock in milliseconds, which may wrap.
    pub now_ms: u32,
    /// Inputs that are on.
    pub signals: Signals,
    /// The motion side.
    pub motion: &'m mut M,
    /// The parameter store.
    pub store: &'m mut S,
}

/// A controller with `AXES` axes and a serial input of `N` bytes.
pub struct Controller<'a, const AXES: usize, const N: usize> {
    inbox: Inbox<'a, N>,
    line: Assembler,
    pub(crate) config: Config<AXES>,
    pub(crate) mode: Mode,
    waiting: Option<Waiting>,
    pub(crate) overrides: Overrides,
    /// The operator has stopped the spindle in a hold.
    spindle_stopped: bool,
    due: Due,
    /// Number of the next startup line; 2: none.
    pub(crate) startup: u8,
    signals: Signals,
    program_ends: u8,
    offset: [glidepath::Position; AXES],
    /// Stored offsets and positions.
    kept: StoredOffsets<AXES>,
    outputs: Outputs,
    /// Time of the last motion.
    moved_ms: u32,
    is_started: bool,
}

/// Alarms of the probe: final state before the motion, and no change during the motion.
const PROBE_BEFORE: u8 = 4;
const PROBE_MISSED: u8 = 5;

impl<'a, const AXES: usize, const N: usize> Controller<'a, AXES, N> {
    /// The state before power-up; the first poll sends the banner.
    pub fn new(inbox: Inbox<'a, N>, config: Config<AXES>) -> Self {
        Self {
            inbox,
            line: Assembler::new(config.text),
            config,
            mode: Mode::Ready,
            waiting: None,
            overrides: Overrides::FULL,
            spindle_stopped: false,
            due: Due::NOW,
            startup: 2,
            signals: Signals::default(),
            program_ends: 0,
            offset: [glidepath::Position::ZERO; AXES],
            kept: StoredOffsets::ZERO,
            outputs: Outputs::default(),
            moved_ms: 0,
            is_started: false,
        }
    }

    /// Handles all inputs once and writes the answers. The work is bounded: at most 256 bytes are read, and
    /// at most one line is carried out.
    ///
    /// # Errors
    /// The error of `out`.
    pub fn poll<M: Motion<AXES>, S: Store<AXES>, W: embedded_io::Write>(
        &mut self,
        look: Look<'_, M, S>,
        out: &mut W,
    ) -> Result<(), W::Error> {
        let Look { now_ms, signals, motion, store } = look;
        let mut around = Around { now_ms, signals, motion, store, out: Text::new(out) };
        self.look(&mut around);
        around.out.finish()
    }

    fn look<M: Motion<AXES>, S: Store<AXES>, W: embedded_io::Write>(
        &mut self,
        around: &mut Around<'_, '_, M, S, W>,
    ) {
        if !self.is_started {
            self.power_up(around);
        }
        let new = around.signals.since(self.signals);
        self.signals = around.signals;
        // `|`, not `||`: both calls must run.
        if self.inbox.take(Request::Reset) | new.has(Signals::RESET) {
            self.reset(around);
        }
        self.requests(around, new);
        self.keys(around.motion);
        self.follow(around);
        if self.inbox.take(Request::Report) {
            self.report(around);
        }
        self.lines(around);
        self.keep_offsets(around);
        self.put_out(around);
    }

    fn power_up<M: Motion<AXES>, S, W: embedded_io::Write>(&mut self, around: &mut Around<'_, '_, M, S, W>) {
        self.is_started = true;
        self.program_ends = around.motion.status().program_ends;
        self.kept = around.motion.offsets().stored();
        // If the machine does not fit the settings, a message reports this; the motion side keeps the old
        // settings.
        let refused = around.motion.configure(&self.config.settings).err();
        self.greet(around, self.config.settings.homing || self.config.is_locked);
        let notice = core::mem::take(&mut self.config.notice);
        let refused = refused.map(|refusal| refusal.message);
        for message in [Some(notice), refused].iter().flatten().filter(|message| !message.is_empty()) {
            around.out.line(format_args!("[MSG:{message}]"));
        }
    }

    /// Sends the banner, and the lines after it.
    fn greet<M: Motion<AXES>, S, W: embedded_io::Write>(
        &mut self,
        around: &mut Around<'_, '_, M, S, W>,
        is_locked: bool,
    ) {
        around.motion.reset();
        self.set_overrides(around.motion, Overrides::FULL);
        self.spindle_stopped = false;
        self.due = Due::NOW;
        self.waiting = None;
        around.out.line(format_args!("\r\nGrbl 1.1h ['$' for help]"));
        if is_locked {
            self.mode = Mode::Alarm(false);
            around.out.line(format_args!("[MSG:'$H'|'$X' to unlock]"));
        } else {
            self.mode = Mode::Ready;
            self.startup = 0;
        }
    }

    /// 0x18: brakes inside the limits, clears the queue, and sends the banner at standstill. The position
    /// stays exact.
    fn reset<M: Motion<AXES>, S, W: embedded_io::Write>(&mut self, around: &mut Around<'_, '_, M, S, W>) {
        self.inbox.restart();
        self.line.clear();
        self.waiting = None;
        self.startup = 2;
        let is_locked = match self.mode {
            Mode::Home => {
                // The position of the axes is not known yet.
                around.out.line(format_args!("ALARM:6"));
                true
            }
            Mode::Alarm(_) | Mode::Sleep => true,
            Mode::Stopping(is_locked) => is_locked,
            _ => false,
        };
        around.motion.abort();
        self.mode = Mode::Stopping(is_locked);
    }

    /// Restarts the controller at the current position: `$C` and `$RST`.
    pub(crate) fn restart<M: Motion<AXES>, S, W: embedded_io::Write>(
        &mut self,
        around: &mut Around<'_, '_, M, S, W>,
    ) {
        let is_locked = matches!(self.mode, Mode::Alarm(_));
        self.greet(around, is_locked);
    }

    /// Raises an alarm: the axes brake, and the controller refuses motion.
    fn raise<M: Motion<AXES>, S, W: embedded_io::Write>(
        &mut self,
        around: &mut Around<'_, '_, M, S, W>,
        code: u8,
    ) {
        around.motion.abort();
        let is_critical = matches!(code, 1 | 2);
        // A reset that waits for standstill still ends with the banner.
        let is_stopping = matches!(self.mode, Mode::Stopping(_));
        self.mode = if is_stopping { Mode::Stopping(true) } else { Mode::Alarm(is_critical) };
        self.startup = 2;
        around.out.line(format_args!("ALARM:{code}"));
        if is_critical {
            around.out.line(format_args!("[MSG:Reset to continue]"));
        }
        self.tell_probe(around);
        if self.waiting.take().is_some() {
            // A probing line is carried out, and its result is an alarm.
            let probes = matches!(code, PROBE_BEFORE | PROBE_MISSED);
            around.out.line(if probes { format_args!("ok") } else { format_args!("error:9") });
        }
    }

    /// Reports the position of a probing motion that has ended.
    fn tell_probe<M: Motion<AXES>, S, W: embedded_io::Write>(
        &mut self,
        around: &mut Around<'_, '_, M, S, W>,
    ) {
        if around.motion.probe_ended() {
            report::probe(&mut around.out, &around.motion.offsets(), self.config.settings.inch);
        }
    }
}

//! The state machine: one [`Controller::poll`] looks at everything once.
use crate::inbox::{Inbox, Key, Request};
use crate::line::{Assembler, Line, LineText};
use crate::motion::{Homing, Motion, Overrides, Refusal, Spindle, Status, Taken};
use crate::report::{Due, Shown, Text};
use crate::settings::Settings;
use crate::state::{Signals, State};
use crate::store::Store;
use glidepath::machine::AxisName;
use heapless::Vec;

/// Bytes of a startup line and of the text of `$I`.
pub const STORED_BYTES: usize = 80;

/// A line of the store.
pub type Stored = Vec<u8, STORED_BYTES>;

/// What the controller begins with: what a build decides, and what a store has kept.
#[derive(Clone, Debug)]
pub struct Config<const AXES: usize> {
    /// Names of the axes, one letter each.
    pub names: [AxisName; AXES],
    /// What the motion side gets of a line.
    pub text: LineText,
    /// The spindle has a variable speed.
    pub has_pwm: bool,
    /// Reports name the line under way (`Ln:`).
    pub line_numbers: bool,
    /// `$` settings.
    pub settings: Settings<AXES>,
    /// `$N0` and `$N1`.
    pub startup: [Stored; 2],
    /// Text of `$I`.
    pub info: Stored,
}

impl<const AXES: usize> Config<AXES> {
    /// Grbl's settings for axes of these names.
    pub const fn new(names: [AxisName; AXES]) -> Self {
        Self {
            names,
            text: LineText::Grbl,
            has_pwm: true,
            line_numbers: false,
            settings: Settings::new(),
            startup: [Stored::new(), Stored::new()],
            info: Stored::new(),
        }
    }
}

/// What the pins of spindle and coolant are to show.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Outputs {
    /// Direction; off while it is stopped by hand, by the door, or asleep.
    pub spindle: Spindle,
    /// rpm with its override, inside `$31`…`$30`.
    pub rpm: u32,
    /// The same as a part of 65,535: 0 at `$31`, 65,535 at `$30`.
    pub duty: u16,
    /// Mist.
    pub mist: bool,
    /// Flood.
    pub flood: bool,
    /// The motors have current: while something moves, and `$1` ms longer.
    pub motors: bool,
}

/// How far a stop for the door is.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Door {
    /// The axes brake.
    Braking,
    /// Spindle and coolant are off.
    Parked,
    /// They come back, since that time.
    Resuming(u32),
}

/// What goes on.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Mode {
    /// Idle or Run.
    Ready,
    Hold,
    Jog,
    /// A jog was cancelled and brakes.
    JogStop,
    /// `true`: nothing but a reset helps.
    Alarm(bool),
    Door(Door),
    Check,
    Home,
    Sleep,
    /// Brakes for a reset. Then the machine is locked or not.
    Stopping(bool),
}

/// Why the line at hand has no answer yet.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Waiting {
    Room,
    Homing,
}

/// What a line gets for an answer.
pub(crate) enum Reply {
    Now(Result<(), Refusal>),
    /// `ok`, then a restart with banner.
    Restart,
    Later(Waiting),
    /// It has been answered.
    Silent,
}

impl Reply {
    pub(crate) const OK: Self = Self::Now(Ok(()));

    pub(crate) fn error(code: u8) -> Self {
        Self::Now(Err(Refusal::new(code)))
    }
}

/// Everything around the controller at one look.
pub(crate) struct Around<'m, 'w, M, S, W: embedded_io::Write> {
    pub(crate) now_ms: u32,
    pub(crate) signals: Signals,
    pub(crate) motion: &'m mut M,
    pub(crate) store: &'m mut S,
    pub(crate) out: Text<'w, W>,
}

/// What is looked at: time, inputs, the motion side, the store.
pub struct Look<'m, M, S> {
    /// A clock of milliseconds that may wrap.
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
    /// Stopped by hand in a hold.
    spindle_stopped: bool,
    due: Due,
    /// The next startup line; 2: none.
    pub(crate) startup: u8,
    signals: Signals,
    program_ends: u8,
    offset: [glidepath::Position; AXES],
    outputs: Outputs,
    /// When something moved last.
    moved_ms: u32,
    is_started: bool,
}

/// Time for the spindle to come up behind the door, ms.
const SPINDLE_MS: u32 = 4000;

/// Time for coolant, ms.
const COOLANT_MS: u32 = 1000;

/// Bytes that a poll reads at most.
const BYTES_PER_POLL: usize = 256;

impl<'a, const AXES: usize, const N: usize> Controller<'a, AXES, N> {
    /// Before power-up; the first poll says hello.
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
            outputs: Outputs::default(),
            moved_ms: 0,
            is_started: false,
        }
    }

    /// Looks at everything once and writes what is to be answered. Bounded: it reads at most 256 bytes and carries out
    /// at most one line.
    ///
    /// # Errors
    /// That of `out`.
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
        // `|`: both are looked at.
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
        self.put_out(around);
    }

    fn power_up<M: Motion<AXES>, S, W: embedded_io::Write>(&mut self, around: &mut Around<'_, '_, M, S, W>) {
        self.is_started = true;
        self.program_ends = around.motion.status().program_ends;
        // A machine that the settings do not fit is told; the motion side keeps what it had.
        let refused = around.motion.configure(&self.config.settings).err();
        self.greet(around, self.config.settings.homing);
        if let Some(Refusal { message, .. }) = refused {
            around.out.line(format_args!("[MSG:{message}]"));
        }
    }

    /// The banner, and what follows it.
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

    /// 0x18: brakes inside the limits, drops everything, and says hello at rest. The position stays exact.
    fn reset<M: Motion<AXES>, S, W: embedded_io::Write>(&mut self, around: &mut Around<'_, '_, M, S, W>) {
        self.inbox.restart();
        self.line.clear();
        self.waiting = None;
        self.startup = 2;
        let is_locked = match self.mode {
            Mode::Home => {
                // Where the axes are is not known yet.
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

    /// Everything restarts where the axes stand: `$C` and `$RST`.
    pub(crate) fn restart<M: Motion<AXES>, S, W: embedded_io::Write>(
        &mut self,
        around: &mut Around<'_, '_, M, S, W>,
    ) {
        let is_locked = matches!(self.mode, Mode::Alarm(_));
        self.greet(around, is_locked);
    }

    /// An alarm: brakes, and locks.
    fn raise<M: Motion<AXES>, S, W: embedded_io::Write>(
        &mut self,
        around: &mut Around<'_, '_, M, S, W>,
        code: u8,
    ) {
        around.motion.abort();
        let is_critical = matches!(code, 1 | 2);
        self.mode = Mode::Alarm(is_critical);
        self.startup = 2;
        around.out.line(format_args!("ALARM:{code}"));
        if is_critical {
            around.out.line(format_args!("[MSG:Reset to continue]"));
        }
        if self.waiting.take().is_some() {
            around.out.line(format_args!("error:9"));
        }
    }

    /// Hold, start, door, jog cancel: by byte or by pin.
    fn requests<M: Motion<AXES>, S, W: embedded_io::Write>(
        &mut self,
        around: &mut Around<'_, '_, M, S, W>,
        new: Signals,
    ) {
        let limit = new.has_limit() && self.config.settings.hard_limits;
        if limit && !matches!(self.mode, Mode::Home | Mode::Alarm(_) | Mode::Sleep | Mode::Stopping(_)) {
            self.raise(around, 1);
        }
        let status = around.motion.status();
        let hold = self.inbox.take(Request::Hold) | new.has(Signals::HOLD);
        let start = self.inbox.take(Request::Start) | new.has(Signals::START);
        let cancel = self.inbox.take(Request::JogCancel);
        if self.inbox.take(Request::Door) | around.signals.has(Signals::DOOR) {
            self.open_door(around);
        }
        match self.mode {
            Mode::Jog if hold || cancel => {
                around.motion.abort();
                self.mode = Mode::JogStop;
            }
            Mode::Ready if hold => {
                around.motion.hold();
                self.mode = Mode::Hold;
            }
            // A hold at the same look wins.
            Mode::Hold if start && !hold && status.is_at_rest => {
                self.spindle_stopped = false;
                around.motion.resume();
                self.mode = Mode::Ready;
            }
            Mode::Door(Door::Parked) if start && !around.signals.has(Signals::DOOR) => {
                self.mode = Mode::Door(Door::Resuming(around.now_ms));
            }
            _ => {}
        }
    }

    fn open_door<M: Motion<AXES>, S, W: embedded_io::Write>(&mut self, around: &mut Around<'_, '_, M, S, W>) {
        match self.mode {
            Mode::Home => self.raise(around, 7),
            Mode::Jog | Mode::JogStop => {
                around.motion.abort();
                self.mode = Mode::Door(Door::Braking);
            }
            Mode::Ready | Mode::Hold => {
                around.motion.hold();
                self.mode = Mode::Door(Door::Braking);
            }
            Mode::Door(Door::Resuming(_)) => self.mode = Mode::Door(Door::Parked),
            Mode::Door(_) | Mode::Alarm(_) | Mode::Check | Mode::Sleep | Mode::Stopping(_) => {}
        }
    }

    fn keys(&mut self, motion: &mut impl Motion<AXES>) {
        while let Some(key) = self.inbox.next_key() {
            let Overrides { feed, rapid, spindle } = self.overrides;
            let more = |percent: u8, by: i8| percent.saturating_add_signed(by).clamp(10, 200);
            let changed = match key {
                Key::FeedFull => Overrides { feed: 100, ..self.overrides },
                Key::Feed(by) => Overrides { feed: more(feed, by), rapid, spindle },
                Key::Rapid(rapid) => Overrides { rapid, ..self.overrides },
                Key::SpindleFull => Overrides { spindle: 100, ..self.overrides },
                Key::Spindle(by) => Overrides { spindle: more(spindle, by), feed, rapid },
                Key::SpindleStop => {
                    if self.mode == Mode::Hold && motion.status().is_at_rest {
                        self.spindle_stopped = !self.spindle_stopped;
                        self.due.overrides_changed();
                    }
                    continue;
                }
                Key::Flood | Key::Mist => {
                    if matches!(self.mode, Mode::Ready | Mode::Hold | Mode::Jog) {
                        let Status { mist, flood, .. } = motion.status();
                        motion.set_coolant(mist ^ (key == Key::Mist), flood ^ (key == Key::Flood));
                        self.due.overrides_changed();
                    }
                    continue;
                }
            };
            self.set_overrides(motion, changed);
        }
    }

    fn set_overrides(&mut self, motion: &mut impl Motion<AXES>, overrides: Overrides) {
        if self.overrides != overrides {
            self.overrides = overrides;
            motion.set_overrides(overrides);
            self.due.overrides_changed();
        }
    }

    /// What the motion side has come to.
    fn follow<M: Motion<AXES>, S, W: embedded_io::Write>(&mut self, around: &mut Around<'_, '_, M, S, W>) {
        if let Some(code) = around.motion.alarm() {
            self.raise(around, code);
        }
        let status = around.motion.status();
        if core::mem::replace(&mut self.program_ends, status.program_ends) != status.program_ends {
            self.set_overrides(around.motion, Overrides::FULL);
        }
        let stands = status.is_at_rest && !status.is_busy;
        match self.mode {
            Mode::Ready if status.is_paused => self.mode = Mode::Hold,
            Mode::Jog | Mode::JogStop if stands => self.mode = Mode::Ready,
            Mode::Door(Door::Braking) if status.is_at_rest => self.mode = Mode::Door(Door::Parked),
            Mode::Door(Door::Resuming(since)) => {
                let spindle = if status.spindle == Spindle::Off { 0 } else { SPINDLE_MS };
                let coolant = if status.mist || status.flood { COOLANT_MS } else { 0 };
                if around.now_ms.wrapping_sub(since) >= spindle + coolant {
                    around.motion.resume();
                    self.mode = Mode::Ready;
                }
            }
            Mode::Home => match status.homing {
                Homing::Running => {}
                Homing::Failed(code) => self.raise(around, code),
                Homing::Done => {
                    self.mode = Mode::Ready;
                    self.startup = 0;
                }
            },
            Mode::Stopping(is_locked) if stands => self.greet(around, is_locked),
            _ => {}
        }
        let offset = around.motion.offsets().work(around.motion.modal().system);
        if core::mem::replace(&mut self.offset, offset) != offset {
            self.due.offsets_changed();
        }
    }

    /// What reports call it now.
    pub fn state(&self, status: &Status<AXES>) -> State {
        match self.mode {
            Mode::Ready if status.is_busy => State::Run,
            Mode::Ready => State::Idle,
            Mode::Hold | Mode::Stopping(_) => State::Hold(u8::from(!status.is_at_rest)),
            Mode::Jog | Mode::JogStop => State::Jog,
            Mode::Alarm(_) => State::Alarm,
            Mode::Door(Door::Braking) => State::Door(2),
            Mode::Door(Door::Parked) => State::Door(u8::from(self.signals.has(Signals::DOOR))),
            Mode::Door(Door::Resuming(_)) => State::Door(3),
            Mode::Check => State::Check,
            Mode::Home => State::Home,
            Mode::Sleep => State::Sleep,
        }
    }

    /// Spindle and coolant as of the last poll.
    pub const fn outputs(&self) -> Outputs {
        self.outputs
    }

    /// Settings in force.
    pub const fn settings(&self) -> &Settings<AXES> {
        &self.config.settings
    }

    /// Bytes of text that were lost because no room was left.
    pub fn lost(&self) -> u32 {
        self.inbox.lost()
    }

    fn report<M: Motion<AXES>, S, W: embedded_io::Write>(&mut self, around: &mut Around<'_, '_, M, S, W>) {
        let status = around.motion.status();
        self.put_out(around);
        let Outputs { spindle, rpm, mist, flood, .. } = self.outputs;
        let shown = Shown {
            state: self.state(&status),
            status: &status,
            offset: self.offset,
            room: self.inbox.room(),
            signals: around.signals,
            overrides: self.overrides,
            names: &self.config.names,
            settings: &self.config.settings,
            spindle: (spindle, rpm),
            mist,
            flood,
            line_numbers: self.config.line_numbers,
        };
        self.due.report(&mut around.out, &shown);
    }

    fn put_out<M: Motion<AXES>, S, W: embedded_io::Write>(&mut self, around: &Around<'_, '_, M, S, W>) {
        let status = around.motion.status();
        let settings = &self.config.settings;
        let is_off = match self.mode {
            Mode::Door(Door::Parked) | Mode::Sleep | Mode::Alarm(true) => true,
            _ => self.spindle_stopped,
        };
        let coolant_off = match self.mode {
            Mode::Door(Door::Parked) | Mode::Sleep | Mode::Alarm(true) => true,
            Mode::Door(Door::Resuming(since)) => {
                status.spindle != Spindle::Off && around.now_ms.wrapping_sub(since) < SPINDLE_MS
            }
            _ => false,
        };
        let (least, most) = (settings.rpm_min_milli / 1000, settings.rpm_max_milli / 1000);
        let (spindle, rpm) = match status.spindle {
            Spindle::Off => (Spindle::Off, 0),
            _ if is_off => (Spindle::Off, 0),
            direction => {
                let wanted = u64::from(status.rpm) * u64::from(self.overrides.spindle) / 100;
                let rpm = u32::try_from(wanted).unwrap_or(u32::MAX).max(least).min(most.max(least));
                (direction, if status.rpm == 0 { 0 } else { rpm })
            }
        };
        let span = u64::from(most.saturating_sub(least));
        let part = u64::from(rpm.saturating_sub(least)) * 65_535;
        // Without a span there is one speed.
        let duty = if rpm == 0 { 0 } else { part.checked_div(span).unwrap_or(65_535).min(65_535) as u16 };
        if status.is_busy || !status.is_at_rest {
            self.moved_ms = around.now_ms;
        }
        let stays_on = settings.idle_ms == 255 && self.mode != Mode::Sleep;
        let is_recent = around.now_ms.wrapping_sub(self.moved_ms) <= u32::from(settings.idle_ms);
        let motors = stays_on || is_recent;
        let [mist, flood] = [status.mist, status.flood].map(|is_on| is_on && !coolant_off);
        self.outputs = Outputs { spindle, rpm, duty, mist, flood, motors };
    }

    /// Whether a line may be carried out now.
    fn reads(&self) -> bool {
        !matches!(self.mode, Mode::Alarm(true) | Mode::Home | Mode::JogStop | Mode::Sleep | Mode::Stopping(_))
    }

    fn lines<M: Motion<AXES>, S: Store<AXES>, W: embedded_io::Write>(
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

    /// Carries startup lines out; whether they are done.
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
        // Taken out and put back: the command may change everything else.
        let line = core::mem::replace(&mut self.line, Assembler::new(self.config.text));
        let reply = match line.stripped() {
            [] => Reply::OK,
            [b'$', command @ ..] => self.system(around, command),
            _ => self.program_line(around, line.text()),
        };
        self.line = line;
        self.answer(around, reply);
    }

    fn program_line<M: Motion<AXES>, S, W: embedded_io::Write>(
        &mut self,
        around: &mut Around<'_, '_, M, S, W>,
        text: &[u8],
    ) -> Reply {
        match self.mode {
            Mode::Check => Reply::Now(around.motion.check(text)),
            Mode::Ready | Mode::Hold | Mode::Door(_) => Reply::of(around.motion.take(text)),
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

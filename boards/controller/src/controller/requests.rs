//! Changes the state of the controller (Idle, Hold, Jog, Alarm, …) by real-time bytes, pins and results of
//! the motion.
use super::outputs::{COOLANT_MS, SPINDLE_MS};
use super::{Around, Controller, Door, Mode, Outputs};
use crate::inbox::{Key, Request};
use crate::motion::{Homing, Motion, Overrides, Spindle, Status};
use crate::report::Shown;
use crate::settings::Settings;
use crate::state::{Signals, State};

impl<const AXES: usize, const N: usize> Controller<'_, AXES, N> {
    /// Hold, start, door, jog cancel: by byte or by pin.
    pub(super) fn requests<M: Motion<AXES>, S, W: embedded_io::Write>(
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
            // If a hold and a start come in the same call, the hold acts.
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

    pub(super) fn keys(&mut self, motion: &mut impl Motion<AXES>) {
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

    pub(super) fn set_overrides(&mut self, motion: &mut impl Motion<AXES>, overrides: Overrides) {
        if self.overrides != overrides {
            self.overrides = overrides;
            motion.set_overrides(overrides);
            self.due.overrides_changed();
        }
    }

    /// Handles the results of the motion side.
    pub(super) fn follow<M: Motion<AXES>, S, W: embedded_io::Write>(
        &mut self,
        around: &mut Around<'_, '_, M, S, W>,
    ) {
        if let Some(code) = around.motion.alarm() {
            self.raise(around, code);
        }
        self.tell_probe(around);
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

    /// The state that reports show now.
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

    /// Spindle and coolant after the last poll.
    pub const fn outputs(&self) -> Outputs {
        self.outputs
    }

    /// The active settings.
    pub const fn settings(&self) -> &Settings<AXES> {
        &self.config.settings
    }

    /// Number of text bytes that were lost because there was no room.
    pub fn lost(&self) -> u32 {
        self.inbox.lost()
    }

    pub(super) fn report<M: Motion<AXES>, S, W: embedded_io::Write>(
        &mut self,
        around: &mut Around<'_, '_, M, S, W>,
    ) {
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
}

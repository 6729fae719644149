//! A test machine: a motion side that knows a few words, and a sender that stores all answers.
#![allow(dead_code)]
pub mod corruption;
pub mod homing;
pub mod session;
pub mod soak;
pub mod world;

use glidepath::machine::AxisName;
use glidepath::nc::StoredOffsets;
use glidepath::quantity::{Feed, Position};
use glidepath_controller::{
    Config, Controller, Homing, Inbox, Jog, Look, Message, Modal, Motion, Offsets, Overrides, Receiver,
    Refusal, Serial, Settings, Signals, Spindle, Status, Store, Taken,
};
use std::collections::VecDeque;

pub const AXES: usize = 3;

/// Blocks that the mock takes.
pub const BLOCKS: usize = 15;

/// Steps of time that it takes to brake.
const BRAKING: u32 = 3;

/// Moves by goals, a step of time each, and remembers what it was told.
#[derive(Default)]
pub struct Mock {
    pub lines: Vec<String>,
    pub jogs: Vec<Jog<AXES>>,
    pub calls: Vec<&'static str>,
    pub queue: VecDeque<[Position; AXES]>,
    pub status: Status<AXES>,
    pub modal: Modal,
    pub offsets: Offsets<AXES>,
    pub overrides: Option<Overrides>,
    pub held: bool,
    braking: u32,
    aborting: bool,
    pub alarm: Option<u8>,
    pub probe_ended: bool,
    /// What homing ends with.
    pub home_ends: Homing,
    pub homing_steps: u32,
    pub refuses_settings: bool,
    /// Moves go on only when told.
    pub frozen: bool,
}

impl Mock {
    /// Time goes by.
    pub fn step(&mut self) {
        if self.homing_steps > 0 {
            self.homing_steps -= 1;
            if self.homing_steps == 0 {
                self.status.homing = self.home_ends;
            }
        }
        if self.braking > 0 {
            self.braking -= 1;
        } else if self.aborting {
            self.aborting = false;
            self.queue.clear();
        } else if !self.held
            && !self.status.is_paused
            && !self.frozen
            && let Some(goal) = self.queue.pop_front()
        {
            self.status.position = goal;
        }
        self.refresh();
    }

    fn refresh(&mut self) {
        let moves = !self.queue.is_empty();
        self.status.is_busy = moves || self.aborting;
        self.status.is_at_rest = self.braking == 0 && (!moves || self.held || self.status.is_paused);
        self.status.free_blocks = (BLOCKS - self.queue.len()) as u8;
        self.status.feed = if self.status.is_at_rest { Feed::ZERO } else { self.modal.feed };
        (self.status.spindle, self.status.rpm) = (self.modal.spindle, self.modal.rpm);
        (self.status.mist, self.status.flood) = (self.modal.mist, self.modal.flood);
    }

    fn brake(&mut self) {
        if !self.status.is_at_rest {
            self.braking = BRAKING;
        }
    }

    /// Words of a line, or Grbl's code.
    fn words(line: &[u8]) -> Result<Vec<(u8, f64)>, u8> {
        let mut words = Vec::new();
        let mut rest = line;
        while let Some((&letter, tail)) = rest.split_first() {
            if !letter.is_ascii_uppercase() {
                return Err(1);
            }
            let end = tail.iter().position(|byte| !b"0123456789.+-".contains(byte)).unwrap_or(tail.len());
            let number = std::str::from_utf8(&tail[..end]).ok().and_then(|text| text.parse().ok());
            words.push((letter, number.ok_or(2)?));
            rest = &tail[end..];
        }
        for (letter, value) in &words {
            let known = match letter {
                b'G' => [0.0, 1.0, 4.0, 20.0, 21.0, 54.0, 55.0, 90.0, 91.0, 92.0].contains(value),
                b'M' => [0.0, 2.0, 3.0, 4.0, 5.0, 7.0, 8.0, 9.0, 30.0].contains(value),
                _ => b"XYZFSNPT".contains(letter),
            };
            if !known {
                return Err(20);
            }
        }
        Ok(words)
    }

    fn execute(&mut self, words: &[(u8, f64)]) {
        let mut goal = self.queue.back().copied().unwrap_or(self.status.position);
        let (mut moves, mut is_offset) = (false, false);
        for (letter, value) in words {
            match (letter, *value as i64) {
                (b'G', 92) => is_offset = true,
                (b'G', group @ (54 | 55)) => self.modal.system = group as u8,
                (b'G', units @ (20 | 21)) => self.modal.inch = units == 20,
                (b'G', mode @ (90 | 91)) => self.modal.incremental = mode == 91,
                (b'G', motion @ (0 | 1)) => self.modal.motion = motion as u16,
                (b'M', 0) => self.status.is_paused = true,
                (b'M', 2 | 30) => self.status.program_ends = self.status.program_ends.wrapping_add(1),
                (b'M', 3) => self.modal.spindle = Spindle::Clockwise,
                (b'M', 4) => self.modal.spindle = Spindle::CounterClockwise,
                (b'M', 5) => self.modal.spindle = Spindle::Off,
                (b'M', 7) => self.modal.mist = true,
                (b'M', 8) => self.modal.flood = true,
                (b'M', 9) => (self.modal.mist, self.modal.flood) = (false, false),
                (b'F', _) => self.modal.feed = Feed::saturating_from_num(*value),
                (b'S', rpm) => self.modal.rpm = rpm.max(0) as u32,
                (b'T', tool) => self.modal.tool = tool.max(0) as u32,
                (b'N', number) => self.status.line = number.max(0) as u32,
                (b'X'..=b'Z', _) => {
                    let axis = usize::from(letter - b'X');
                    let at = Position::saturating_from_num(*value);
                    if is_offset {
                        self.offsets.g92[axis] = self.status.position[axis].saturating_sub(at);
                    } else {
                        goal[axis] = at;
                        moves = true;
                    }
                }
                _ => {}
            }
        }
        if moves {
            self.queue.push_back(goal);
        }
        self.refresh();
    }
}

impl Motion<AXES> for Mock {
    fn take(&mut self, line: &[u8]) -> Taken {
        let words = match Self::words(line) {
            Ok(words) => words,
            Err(20) => {
                let mut message = Message::new();
                let _ = message.push_str("not a word of the mock");
                return Taken::Refused(Refusal { code: 20, message });
            }
            Err(code) => return Taken::Refused(Refusal::new(code)),
        };
        let waits = words.iter().any(|(letter, value)| *letter == b'G' && *value == 4.0);
        if self.queue.len() >= BLOCKS || waits && self.status.is_busy {
            return Taken::NotYet;
        }
        self.lines.push(String::from_utf8_lossy(line).into_owned());
        self.execute(&words);
        Taken::Yes
    }

    fn check(&mut self, line: &[u8]) -> Result<(), Refusal> {
        Self::words(line).map(|_| ()).map_err(Refusal::new)
    }

    fn jog(&mut self, jog: &Jog<AXES>) -> Taken {
        if self.queue.len() >= BLOCKS {
            return Taken::NotYet;
        }
        let mut goal = self.queue.back().copied().unwrap_or(self.status.position);
        for (goal, axis) in goal.iter_mut().zip(jog.axes) {
            if let Some(axis) = axis {
                *goal = if jog.incremental { goal.saturating_add(axis) } else { axis };
                if goal.to_num::<f64>().abs() > 1000.0 {
                    return Taken::Refused(Refusal::new(15));
                }
            }
        }
        self.jogs.push(*jog);
        self.queue.push_back(goal);
        self.refresh();
        Taken::Yes
    }

    fn hold(&mut self) {
        self.calls.push("hold");
        self.brake();
        self.held = true;
        self.refresh();
    }

    fn resume(&mut self) {
        self.calls.push("resume");
        (self.held, self.status.is_paused) = (false, false);
        self.refresh();
    }

    fn abort(&mut self) {
        self.calls.push("abort");
        self.brake();
        (self.aborting, self.held, self.status.is_paused) = (!self.queue.is_empty(), false, false);
        self.status.homing = Homing::Done;
        self.homing_steps = 0;
        self.refresh();
    }

    fn reset(&mut self) {
        self.calls.push("reset");
        self.modal = Modal::default();
        self.held = false;
        self.refresh();
    }

    fn set_overrides(&mut self, overrides: Overrides) {
        self.overrides = Some(overrides);
    }

    fn set_coolant(&mut self, mist: bool, flood: bool) {
        (self.modal.mist, self.modal.flood) = (mist, flood);
        self.refresh();
    }

    fn home(&mut self) {
        self.calls.push("home");
        self.homing_steps = 4;
        self.status.homing = Homing::Running;
    }

    fn clear_offsets(&mut self) {
        self.offsets = Offsets::default();
    }

    fn configure(&mut self, _: &Settings<AXES>) -> Result<(), Refusal> {
        if self.refuses_settings { Err(Refusal::new(12)) } else { Ok(()) }
    }

    fn status(&self) -> Status<AXES> {
        self.status
    }

    fn modal(&self) -> Modal {
        self.modal
    }

    fn offsets(&self) -> Offsets<AXES> {
        self.offsets
    }

    fn alarm(&mut self) -> Option<u8> {
        self.alarm.take()
    }

    fn probe_ended(&mut self) -> bool {
        std::mem::take(&mut self.probe_ended)
    }
}

/// A store that may fail.
#[derive(Default)]
pub struct Memory {
    pub fails: bool,
    pub kept: Vec<String>,
}

impl Store<AXES> for Memory {
    fn settings(&mut self, settings: &Settings<AXES>) -> bool {
        self.kept.push(format!("settings {}", settings.pulse_us));
        !self.fails
    }

    fn offsets(&mut self, offsets: &StoredOffsets<AXES>) -> bool {
        let [x, ..] = offsets.zero[0];
        self.kept.push(format!("offsets {x}"));
        !self.fails
    }

    fn texts(&mut self, startup: [&[u8]; 2], info: &[u8]) -> bool {
        let [first, second, info] = [startup[0], startup[1], info].map(String::from_utf8_lossy);
        self.kept.push(format!("N0={first} N1={second} I={info}"));
        !self.fails
    }
}

/// What the controller wrote.
#[derive(Default)]
pub struct Sink(pub Vec<u8>);

impl glidepath_controller::io::ErrorType for Sink {
    type Error = core::convert::Infallible;
}

impl glidepath_controller::io::Write for Sink {
    fn write(&mut self, bytes: &[u8]) -> Result<usize, Self::Error> {
        self.0.extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> Result<(), Self::Error> {
        Ok(())
    }
}

pub fn names() -> [AxisName; AXES] {
    ["X", "Y", "Z"].map(|name| AxisName::new(name).expect("a name"))
}

pub const BUFFER: usize = 1024;

/// A controller under test, and both sides of it.
pub struct Talk<'a> {
    pub receiver: Receiver<'a, BUFFER>,
    pub controller: Controller<'a, AXES, BUFFER>,
    pub mock: Mock,
    pub memory: Memory,
    pub sink: Sink,
    pub signals: Signals,
    pub now_ms: u32,
}

/// Memory of a serial input, for ever.
pub fn serial() -> &'static mut Serial<BUFFER> {
    Box::leak(Box::new(Serial::new()))
}

impl<'a> Talk<'a> {
    pub fn with(config: Config<AXES>, serial: &'a mut Serial<BUFFER>) -> Self {
        let (receiver, inbox): (_, Inbox<'a, BUFFER>) = serial.split();
        let mut mock = Mock::default();
        mock.refresh();
        Self {
            receiver,
            controller: Controller::new(inbox, config),
            mock,
            memory: Memory::default(),
            sink: Sink::default(),
            signals: Signals::default(),
            now_ms: 0,
        }
    }

    /// Behind its banner.
    pub fn new() -> Talk<'static> {
        let mut talk = Talk::with(Config::new(names()), serial());
        talk.poll();
        talk.said("\r\nGrbl 1.1h ['$' for help]\r\n");
        talk
    }

    /// One look; no time goes by for the mock.
    pub fn poll(&mut self) {
        let look = Look {
            now_ms: self.now_ms,
            signals: self.signals,
            motion: &mut self.mock,
            store: &mut self.memory,
        };
        let Ok(()) = self.controller.poll(look, &mut self.sink);
    }

    /// Time goes by until nothing changes any more.
    pub fn settle(&mut self) {
        for _ in 0..40 {
            self.poll();
            self.mock.step();
            self.now_ms = self.now_ms.wrapping_add(1);
        }
    }

    pub fn send(&mut self, bytes: impl AsRef<[u8]>) {
        for byte in bytes.as_ref() {
            self.receiver.push(*byte);
        }
    }

    /// What was said since the last call is this.
    #[track_caller]
    pub fn said(&mut self, text: &str) {
        assert_eq!(self.read(), text);
    }

    pub fn read(&mut self) -> String {
        String::from_utf8(std::mem::take(&mut self.sink.0)).expect("ASCII")
    }

    /// Sends a line and looks at the answer, character for character. `text` has LF for CR LF.
    #[track_caller]
    pub fn ask(&mut self, line: impl AsRef<[u8]>, text: &str) {
        self.send(line);
        self.send("\n");
        self.poll();
        self.said(&text.replace('\n', "\r\n"));
    }

    /// What a report calls the state.
    pub fn state(&mut self) -> String {
        self.read();
        self.send("?");
        self.poll();
        let report = self.read();
        report.trim_start_matches('<').split('|').next().unwrap_or_default().to_owned()
    }
}

/// A seed that no run had before, or the one that `GLIDEPATH_SEED` names.
pub fn fresh_seed() -> u64 {
    let given = std::env::var("GLIDEPATH_SEED").ok().and_then(|seed| seed.parse().ok());
    let seed = given.unwrap_or_else(|| {
        let now = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH);
        now.map_or(0, |now| now.as_micros() as u64 % 1_000_000_000)
    });
    println!("GLIDEPATH_SEED={seed}");
    seed
}

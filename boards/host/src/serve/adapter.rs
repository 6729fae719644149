//! Glidepath's planner and operator as the motion side of the protocol.
use super::spool::Spool;
use super::{AXES, words};
use glidepath::channel::{Error, Planner, Progress};
use glidepath::machine::MachineData;
use glidepath::nc::{Decoder, DecoderMemory, Setup, Step};
use glidepath::operator::Operator;
use glidepath::quantity::{Feed, Position};
use glidepath::technology::Function;
use glidepath::tick::State;
use glidepath_controller::{
    Homing, Jog, Message, Modal, Motion, Offsets, Overrides, Refusal, Settings, Spindle, Status, Taken,
};

/// Blocks of look-ahead.
pub const BLOCKS: usize = 120;

/// Calls of the planner in a row.
const CALLS: usize = 500;

/// Why the text at hand has come to an end.
#[derive(Clone, Copy, PartialEq, Eq)]
enum End {
    /// M2, M30.
    Program,
    /// A line was refused.
    Refused,
    /// Aborted, with modal words to come back or not.
    Aborted,
}

/// Both handles, and what the protocol wants to know beside them.
pub struct Adapter<'a> {
    planner: Planner<'a, &'a Spool, AXES, BLOCKS>,
    operator: Operator<'a, AXES>,
    spool: &'a Spool,
    machine: MachineData<AXES>,
    names: [String; AXES],
    cycle_us: u32,
    /// A line is with the decoder.
    offered: bool,
    /// The line is taken, and answered at rest: `G4`, the end of a program.
    waits: bool,
    /// The decoder has come to an end, or will: until it goes on at rest no line is taken.
    end: Option<End>,
    /// What the planner said of the line.
    error: Option<Error>,
    state: State,
    modal: Modal,
    offsets: Offsets<AXES>,
    spindle: Spindle,
    rpm: u32,
    mist: bool,
    flood: bool,
    program_ends: u8,
    axes: [glidepath_controller::AxisSettings; AXES],
}

impl<'a> Adapter<'a> {
    pub fn new(
        planner: Planner<'a, &'a Spool, AXES, BLOCKS>,
        operator: Operator<'a, AXES>,
        spool: &'a Spool,
        machine: &MachineData<AXES>,
    ) -> Self {
        let mut offsets = Offsets::default();
        for (index, system) in offsets.systems.iter_mut().enumerate() {
            for (place, axis) in system.iter_mut().zip(&machine.axes) {
                // 0.1 µm
                let tenths = axis.versch.get(index).copied().unwrap_or(0);
                *place = Position::from_bits((i64::from(tenths) << 32) / 10_000);
            }
        }
        let mut adapter = Self {
            planner,
            operator,
            spool,
            machine: *machine,
            names: machine.axes.map(|axis| axis.name.as_str().to_owned()),
            cycle_us: machine.channel.cycle_us,
            offered: false,
            waits: false,
            end: None,
            error: None,
            state: State::Idle,
            modal: Modal::default(),
            offsets,
            spindle: Spindle::Off,
            rpm: 0,
            mist: false,
            flood: false,
            program_ends: 0,
            axes: super::settings(machine).axes,
        };
        adapter.begin();
        adapter
    }

    /// The first line of a program: Grbl's modal words.
    fn begin(&mut self) {
        self.spool.push(words::in_force(&self.modal).as_bytes());
    }

    /// A tick has been.
    pub fn ticked(&mut self, state: State) {
        self.state = state;
        while let Some(output) = self.operator.output() {
            match output.function {
                Function::M(3) => self.spindle = Spindle::Clockwise,
                Function::M(4) => self.spindle = Spindle::CounterClockwise,
                Function::M(5) => self.spindle = Spindle::Off,
                Function::M(7) => self.mist = true,
                Function::M(8) => self.flood = true,
                Function::M(9) => (self.mist, self.flood) = (false, false),
                Function::Spindle(speed) => self.rpm = speed.to_num::<f64>() as u32,
                _ => {}
            }
            if output.waits {
                // Nothing is behind it that could fail.
                let _ = self.operator.acknowledge(output.function);
            }
        }
    }

    /// Lets the planner work.
    pub fn service(&mut self) {
        for _ in 0..CALLS {
            match self.planner.poll() {
                Ok(Progress::Waiting) => break,
                Ok(Progress::Done) => {
                    self.go_on();
                    break;
                }
                Ok(_) => {}
                Err(error) => {
                    self.error = Some(error);
                    self.end = Some(End::Refused);
                }
            }
        }
    }

    /// Behind the end of a text, at rest.
    fn go_on(&mut self) {
        if self.end.is_none() {
            self.end = Some(End::Program);
            self.program_ends = self.program_ends.wrapping_add(1);
        }
        if !self.planner.is_at_rest() {
            return;
        }
        let goes_on = match self.end {
            Some(End::Refused) => self.planner.go_on().is_ok() || self.load(),
            Some(End::Program) => {
                let Modal { tool, .. } = self.modal;
                self.modal = Modal { tool, ..Modal::default() };
                self.load()
            }
            Some(End::Aborted) | None => self.load(),
        };
        if goes_on {
            self.end = None;
        }
    }

    fn load(&mut self) -> bool {
        let is_loaded = self.planner.load_next().is_ok();
        if is_loaded {
            // A program begins without G92.
            self.offsets.g92 = [Position::ZERO; AXES];
            self.begin();
        }
        is_loaded
    }

    /// Hands a line to the decoder, once.
    fn offer(&mut self, line: &[u8], code: u8) -> Taken {
        if !self.offered {
            if self.end.is_some() || !self.spool.is_read() {
                self.service();
                return Taken::NotYet;
            }
            self.spool.push(line);
            self.offered = true;
        }
        self.service();
        if let Some(error) = self.error.take() {
            self.offered = false;
            return Taken::Refused(refusal(&error, code));
        }
        if self.spool.is_read() || self.end.is_some() {
            self.offered = false;
            return Taken::Yes;
        }
        Taken::NotYet
    }

    /// Where a jog of this axis leads, in coordinates of the machine.
    fn goal(&self, jog: &Jog<AXES>, axis: usize, way: Position) -> Position {
        let zero = Position::ZERO;
        let of = |all: &[Position; AXES]| all.get(axis).copied().unwrap_or(zero);
        let from = match (jog.incremental, jog.machine) {
            (true, _) => of(self.planner.position()),
            (false, true) => zero,
            (false, false) => of(&self.offsets.work(self.modal.system)),
        };
        way.saturating_add(from)
    }

    fn note(&mut self, line: &[u8]) {
        let before = self.modal.motion;
        words::note(line, &mut self.modal);
        let words = words::words(line);
        if !words.iter().any(|(letter, number)| *letter == b'G' && number.trim_start_matches('0') == "92") {
            return;
        }
        self.modal.motion = before;
        let system = self.offsets.systems.get(usize::from(self.modal.system.saturating_sub(54)));
        let system = system.copied().unwrap_or_default();
        let unit = if self.modal.inch { 25.4 } else { 1.0 };
        for (index, name) in self.names.iter().enumerate() {
            let word = words.iter().find(|(letter, _)| name.as_bytes() == [*letter]);
            let value = word.and_then(|(_, number)| number.parse::<f64>().ok());
            let (Some(value), Some(at), Some(place), Some(system)) = (
                value,
                self.planner.position().get(index),
                self.offsets.g92.get_mut(index),
                system.get(index),
            ) else {
                continue;
            };
            *place = at.saturating_sub(*system).saturating_sub(Position::saturating_from_num(value * unit));
        }
    }
}

/// The decoder's words for what is wrong.
fn refusal(error: &Error, other: u8) -> Refusal {
    let code = match error {
        Error::Nc(_) | Error::NotAvailable(..) | Error::NotEnabled(..) => 20,
        Error::SoftwareLimit(..) => other,
        _ => 33,
    };
    let mut message = Message::new();
    let told = format!("column {}: {error}", error.place().column);
    // Senders take ASCII; brackets would end the message.
    for letter in told.chars().filter(|letter| letter.is_ascii() && !"[]".contains(*letter)) {
        if message.push(letter).is_err() {
            break;
        }
    }
    Refusal { code, message }
}

impl Motion<AXES> for Adapter<'_> {
    fn take(&mut self, line: &[u8]) -> Taken {
        if !self.waits {
            let taken = self.offer(&words::translated(line), 33);
            if taken != Taken::Yes {
                return taken;
            }
            self.note(line);
            self.waits = words::synchronises(line);
        }
        self.waits &= self.status().is_busy;
        if self.waits { Taken::NotYet } else { Taken::Yes }
    }

    fn check(&mut self, line: &[u8]) -> Result<(), Refusal> {
        // A decoder of its own, with nothing in force but what a program begins with.
        let text = [words::in_force(&self.modal).as_bytes(), b"\n", &words::translated(line), b"\n"].concat();
        let mut memory = Box::new(DecoderMemory::new());
        let setup = Setup::new(&self.machine, *self.planner.position());
        let mut decoder = Decoder::new(&mut memory, setup, text.as_slice());
        loop {
            match decoder.step() {
                Ok(Step::End) => return Ok(()),
                Ok(_) => {}
                Err(error) => return Err(refusal(&Error::Nc(error), 33)),
            }
        }
    }

    fn jog(&mut self, jog: &Jog<AXES>) -> Taken {
        if self.offered {
            return self.offer(b"", 15);
        }
        let mut text = format!("G53 G90 G71 G01 F{}", words::decimal(jog.feed));
        for (index, (name, word)) in self.names.iter().zip(jog.axes).enumerate() {
            if let Some(way) = word {
                text += &format!(" {name}{}", words::decimal(self.goal(jog, index, way)));
            }
        }
        text += "\n";
        text += &words::in_force(&self.modal);
        self.offer(text.as_bytes(), 15)
    }

    fn hold(&mut self) {
        self.operator.feed_hold();
    }

    fn resume(&mut self) {
        self.operator.resume();
    }

    fn abort(&mut self) {
        self.operator.resume();
        self.operator.abort();
        self.spool.clear();
        (self.offered, self.waits) = (false, false);
        self.error = None;
        self.end = Some(End::Aborted);
        self.service();
    }

    fn reset(&mut self) {
        self.operator.resume();
        self.modal = Modal::default();
        (self.spindle, self.rpm, self.mist, self.flood) = (Spindle::Off, 0, false, false);
        if self.end.is_none() {
            self.spool.push(words::in_force(&self.modal).as_bytes());
        }
        self.service();
    }

    fn set_overrides(&mut self, overrides: Overrides) {
        // One override for feed and rapid motion, in 0.1 %.
        self.operator.set_override(u16::from(overrides.feed) * 10);
    }

    fn set_coolant(&mut self, mist: bool, flood: bool) {
        (self.mist, self.flood) = (mist, flood);
        (self.modal.mist, self.modal.flood) = (mist, flood);
    }

    fn home(&mut self) {}

    fn clear_offsets(&mut self) {
        self.offsets = Offsets::default();
    }

    fn configure(&mut self, settings: &Settings<AXES>) -> Result<(), Refusal> {
        let mut refusal = Refusal::new(52);
        let reason = if settings.axes != self.axes {
            "the machine file says that"
        } else if settings.homing {
            "there is no homing here"
        } else {
            return Ok(());
        };
        let _ = refusal.message.push_str(reason);
        Err(refusal)
    }

    fn status(&self) -> Status<AXES> {
        let seen = self.operator.status();
        // mm/tick to mm/min
        let feed = seen.speed.0.to_num::<f64>() * 60e6 / f64::from(self.cycle_us);
        let is_at_rest = self.state == State::Idle;
        Status {
            position: seen.set_points,
            is_busy: !is_at_rest || !self.planner.is_at_rest() || self.end.is_some(),
            is_at_rest,
            free_blocks: 15,
            feed: Feed::saturating_from_num(feed.abs()),
            spindle: self.spindle,
            rpm: self.rpm,
            mist: self.mist,
            flood: self.flood,
            program_ends: self.program_ends,
            homing: Homing::Done,
            ..Status::default()
        }
    }

    fn modal(&self) -> Modal {
        self.modal
    }

    fn offsets(&self) -> Offsets<AXES> {
        self.offsets
    }

    fn alarm(&mut self) -> Option<u8> {
        None
    }
}

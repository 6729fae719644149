//! The motion side as the protocol sees it: what a planner, an interpolator and a decoder have to do.
use crate::settings::Settings;
use glidepath::quantity::{Feed, Position};
use heapless::String;

/// A text that goes to the sender in `[MSG:…]`.
pub type Message = String<96>;

/// A line that is not taken.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Refusal {
    /// Grbl's code: `error:20`.
    pub code: u8,
    /// What is wrong, in words; empty: the code says it.
    pub message: Message,
}

impl Refusal {
    /// A code alone.
    pub const fn new(code: u8) -> Self {
        Self { code, message: Message::new() }
    }
}

/// What became of a line.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Taken {
    /// Understood, and its motion has room in the planner.
    Yes,
    /// No room yet: the same line is given again.
    NotYet,
    /// Not understood, or not possible.
    Refused(Refusal),
}

/// Direction of the spindle.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum Spindle {
    /// M5.
    #[default]
    Off,
    /// M3.
    Clockwise,
    /// M4.
    CounterClockwise,
}

/// How far a homing cycle is.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum Homing {
    /// None, or it is done.
    #[default]
    Done,
    /// Axes move.
    Running,
    /// It ended with this alarm: 8 or 9, for example.
    Failed(u8),
}

/// What the machine does now.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Status<const AXES: usize> {
    /// Machine coordinates.
    pub position: [Position; AXES],
    /// Motion is planned or under way, also one that stands in a hold.
    pub is_busy: bool,
    /// The axes stand still.
    pub is_at_rest: bool,
    /// The program waits for a start: M0, M1.
    pub is_paused: bool,
    /// Blocks that find room in the planner.
    pub free_blocks: u8,
    /// Number of the line under way; 0: none.
    pub line: u32,
    /// Path speed.
    pub feed: Feed,
    /// The spindle as the program has it, without override.
    pub spindle: Spindle,
    /// Its speed, rpm.
    pub rpm: u32,
    /// M7.
    pub mist: bool,
    /// M8.
    pub flood: bool,
    /// Programs that have ended (M2, M30), a count that may wrap.
    pub program_ends: u8,
    /// The homing cycle.
    pub homing: Homing,
}

impl<const AXES: usize> Default for Status<AXES> {
    fn default() -> Self {
        Self {
            position: [Position::ZERO; AXES],
            is_busy: false,
            is_at_rest: true,
            is_paused: false,
            free_blocks: 0,
            line: 0,
            feed: Feed::ZERO,
            spindle: Spindle::Off,
            rpm: 0,
            mist: false,
            flood: false,
            program_ends: 0,
            homing: Homing::Done,
        }
    }
}

/// Modal words in force, for `$G`.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Modal {
    /// G0, G1, G2, G3, G80; in tenths: G38.2 is 382.
    pub motion: u16,
    /// G54…G59: 54…59; G59.1…G59.3: 60…62.
    pub system: u8,
    /// G17, G18, G19.
    pub plane: u8,
    /// G20: inch.
    pub inch: bool,
    /// G91: increments.
    pub incremental: bool,
    /// G93: inverse time.
    pub inverse_time: bool,
    /// M0, M1, M2 or M30 while it is active.
    pub program: Option<u8>,
    /// M3, M4, M5.
    pub spindle: Spindle,
    /// M7.
    pub mist: bool,
    /// M8.
    pub flood: bool,
    /// T.
    pub tool: u32,
    /// F, in mm/min.
    pub feed: Feed,
    /// S, rpm.
    pub rpm: u32,
}

impl Default for Modal {
    fn default() -> Self {
        Self {
            motion: 0,
            system: 54,
            plane: 17,
            inch: false,
            incremental: false,
            inverse_time: false,
            program: None,
            spindle: Spindle::Off,
            mist: false,
            flood: false,
            tool: 0,
            feed: Feed::ZERO,
            rpm: 0,
        }
    }
}

/// Offsets and stored positions, for `$#`.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Offsets<const AXES: usize> {
    /// G54…G59.3.
    pub systems: [[Position; AXES]; 9],
    /// G28, machine coordinates.
    pub g28: [Position; AXES],
    /// G30.
    pub g30: [Position; AXES],
    /// G92.
    pub g92: [Position; AXES],
    /// Tool length of each axis; reports tell that of the third one.
    pub tool: [Position; AXES],
    /// Where the probe was, machine coordinates.
    pub probe: [Position; AXES],
    /// Whether it had contact.
    pub probed: bool,
}

impl<const AXES: usize> Default for Offsets<AXES> {
    fn default() -> Self {
        let zero = [Position::ZERO; AXES];
        Self { systems: [zero; 9], g28: zero, g30: zero, g92: zero, tool: zero, probe: zero, probed: false }
    }
}

impl<const AXES: usize> Offsets<AXES> {
    /// The sum of what is between machine and work coordinates in the system G54…G59.3 (54…62).
    pub fn work(&self, system: u8) -> [Position; AXES] {
        let index = usize::from(system.saturating_sub(54));
        let system = self.systems.get(index).copied().unwrap_or([Position::ZERO; AXES]);
        let mut sum = system;
        for (sum, (g92, tool)) in sum.iter_mut().zip(self.g92.iter().zip(&self.tool)) {
            *sum = sum.saturating_add(*g92).saturating_add(*tool);
        }
        sum
    }
}

/// A jog: `$J=`.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Jog<const AXES: usize> {
    /// Goals or ways of the axes that are named, mm.
    pub axes: [Option<Position>; AXES],
    /// They are ways (G91).
    pub incremental: bool,
    /// They are machine coordinates (G53).
    pub machine: bool,
    /// mm/min.
    pub feed: Feed,
}

/// Overrides, percent.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Overrides {
    /// 10…200.
    pub feed: u8,
    /// 25, 50 or 100.
    pub rapid: u8,
    /// 10…200.
    pub spindle: u8,
}

impl Overrides {
    /// 100 % each.
    pub const FULL: Self = Self { feed: 100, rapid: 100, spindle: 100 };
}

/// What executes. Calls return at once; what they start is seen in [`Self::status`].
pub trait Motion<const AXES: usize> {
    /// Takes a line of NC text. A line that is [`Taken::NotYet`] is given again, the same text, until it is taken or
    /// the controller is reset.
    fn take(&mut self, line: &[u8]) -> Taken;

    /// Reads a line for its errors. Modal words count for the next line of the check; nothing moves.
    ///
    /// # Errors
    /// As [`Self::take`].
    fn check(&mut self, line: &[u8]) -> Result<(), Refusal>;

    /// Takes a jog.
    fn jog(&mut self, jog: &Jog<AXES>) -> Taken;

    /// Brakes on the path.
    fn hold(&mut self);

    /// Goes on behind a hold or a pause.
    fn resume(&mut self);

    /// Brakes and drops everything that is not executed. The parser goes on from where the axes come to rest.
    fn abort(&mut self);

    /// Modal words as at power-up; spindle and coolant off. At rest, behind [`Self::abort`].
    fn reset(&mut self);

    /// Overrides of feed and rapid motion from now on. That of the spindle is put out by the controller.
    fn set_overrides(&mut self, overrides: Overrides);

    /// Coolant by hand: mist, flood.
    fn set_coolant(&mut self, mist: bool, flood: bool);

    /// Starts the homing cycle.
    fn home(&mut self);

    /// All offsets and stored positions are 0 (`$RST=#`).
    fn clear_offsets(&mut self);

    /// Settings have changed. At rest.
    ///
    /// # Errors
    /// The machine cannot have that; the setting is not stored.
    fn configure(&mut self, settings: &Settings<AXES>) -> Result<(), Refusal>;

    /// What it does now.
    fn status(&self) -> Status<AXES>;

    /// Modal words.
    fn modal(&self) -> Modal;

    /// Offsets.
    fn offsets(&self) -> Offsets<AXES>;

    /// An alarm of its own since the last call: 2 soft limit, 4 and 5 probe.
    fn alarm(&mut self) -> Option<u8>;

    /// Whether a probing motion has ended since the last call: its place is told before its line is answered.
    fn probe_ended(&mut self) -> bool;
}

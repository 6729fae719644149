//! The interface between the controller and the machine that moves: the trait [`Motion`] and its types.
use crate::settings::Settings;
use glidepath::quantity::{Feed, Position};
use heapless::String;

/// A text that goes to the sender in `[MSG:…]`.
pub type Message = String<96>;

/// Reason for which a line is refused.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Refusal {
    /// Grbl's error number: 20 for `error:20`.
    pub code: u8,
    /// Explanation in words; empty if the number is enough.
    pub message: Message,
}

impl Refusal {
    /// A refusal with an error number only.
    pub const fn new(code: u8) -> Self {
        Self { code, message: Message::new() }
    }
}

/// Result of a line.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Taken {
    /// The line is decoded, and the planner has room for its motion.
    Yes,
    /// There is no room yet: the caller must give the same line again.
    NotYet,
    /// The line has an error, or its motion is not possible.
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

/// State of a homing cycle.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum Homing {
    /// No cycle, or the cycle has ended.
    #[default]
    Done,
    /// The axes move.
    Running,
    /// The cycle ended with this alarm, for example 8 or 9.
    Failed(u8),
}

/// Status of the machine.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Status<const AXES: usize> {
    /// Machine coordinates.
    pub position: [Position; AXES],
    /// Motion is planned or in progress, also during a hold.
    pub is_busy: bool,
    /// The axes stand still.
    pub is_at_rest: bool,
    /// The program waits for a cycle start: M0, M1.
    pub is_paused: bool,
    /// Number of blocks for which the planner has room.
    pub free_blocks: u8,
    /// Number of the current line; 0: none.
    pub line: u32,
    /// Current path speed.
    pub feed: Feed,
    /// The spindle's programmed direction.
    pub spindle: Spindle,
    /// The spindle's programmed speed without override, rpm.
    pub rpm: u32,
    /// Whether M7 is on.
    pub mist: bool,
    /// Whether M8 is on.
    pub flood: bool,
    /// Number of ended programs (M2, M30); the number may wrap.
    pub program_ends: u8,
    /// State of the homing cycle.
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

/// Active modal words, for `$G`.
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
    /// M0, M1, M2 or M30 while the word is active.
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
    /// Tool length of each axis; reports contain that of the third axis.
    pub tool: [Position; AXES],
    /// Latched position of the probe, machine coordinates.
    pub probe: [Position; AXES],
    /// Whether the probe had contact.
    pub probed: bool,
}

impl<const AXES: usize> Default for Offsets<AXES> {
    fn default() -> Self {
        let zero = [Position::ZERO; AXES];
        Self { systems: [zero; 9], g28: zero, g30: zero, g92: zero, tool: zero, probe: zero, probed: false }
    }
}

impl<const AXES: usize> Offsets<AXES> {
    /// Sum of the offsets between machine and work coordinates in the system G54…G59.3 (54…62).
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
    /// Targets or distances of the axes in the jog, mm.
    pub axes: [Option<Position>; AXES],
    /// The values are distances (G91).
    pub incremental: bool,
    /// The values are machine coordinates (G53).
    pub machine: bool,
    /// Speed, mm/min.
    pub feed: Feed,
}

/// Overrides, percent.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Overrides {
    /// Feed, 10…200.
    pub feed: u8,
    /// Rapid motion, 25, 50 or 100.
    pub rapid: u8,
    /// Spindle, 10…200.
    pub spindle: u8,
}

impl Overrides {
    /// All overrides at 100 %.
    pub const FULL: Self = Self { feed: 100, rapid: 100, spindle: 100 };
}

/// The side that executes motion. Calls return at once; [`Self::status`] shows their effect.
pub trait Motion<const AXES: usize> {
    /// Takes a line of NC text. After [`Taken::NotYet`] the controller gives the same text again, until the
    /// line is taken or a reset comes.
    fn take(&mut self, line: &[u8]) -> Taken;

    /// Checks a line for errors. Modal words act on the next checked line; no axis moves.
    ///
    /// # Errors
    /// As [`Self::take`].
    fn check(&mut self, line: &[u8]) -> Result<(), Refusal>;

    /// Takes a jog.
    fn jog(&mut self, jog: &Jog<AXES>) -> Taken;

    /// Brakes on the path.
    fn hold(&mut self);

    /// Continues after a hold or a pause.
    fn resume(&mut self);

    /// Brakes and drops all motion that is not executed. The next line starts at the position of the
    /// standstill.
    fn abort(&mut self);

    /// Restores the modal words of power-up; spindle and coolant go off. Called at standstill, after
    /// [`Self::abort`].
    fn reset(&mut self);

    /// Sets the overrides of feed and rapid motion. The controller outputs the spindle override.
    fn set_overrides(&mut self, overrides: Overrides);

    /// Switches coolant by hand: mist, flood.
    fn set_coolant(&mut self, mist: bool, flood: bool);

    /// Starts the homing cycle.
    fn home(&mut self);

    /// Sets all offsets and stored positions to 0 (`$RST=#`).
    fn clear_offsets(&mut self);

    /// Applies changed settings. Called at standstill.
    ///
    /// # Errors
    /// The machine does not support the settings; the controller does not store them.
    fn configure(&mut self, settings: &Settings<AXES>) -> Result<(), Refusal>;

    /// Current status.
    fn status(&self) -> Status<AXES>;

    /// Active modal words.
    fn modal(&self) -> Modal;

    /// Offsets and stored positions.
    fn offsets(&self) -> Offsets<AXES>;

    /// An alarm of the motion side since the last call: 2 soft limit, 4 and 5 probe.
    fn alarm(&mut self) -> Option<u8>;

    /// Whether a probing motion has ended since the last call. The controller reports its position before it
    /// answers the line.
    fn probe_ended(&mut self) -> bool;
}

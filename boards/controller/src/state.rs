//! States of the controller and of its inputs, with the names that status reports use.
use core::fmt::{self, Display};

/// The state that a report shows.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum State {
    /// The axes stand still, and the machine is ready.
    Idle,
    /// A program moves the axes.
    Run,
    /// Feed hold: 0 at rest, 1 braking.
    Hold(u8),
    /// Manual motion.
    Jog,
    /// An alarm: the controller refuses motion.
    Alarm,
    /// Safety door: 0 closed and ready, 1 open, 2 braking, 3 resuming.
    Door(u8),
    /// Check mode: the controller checks lines, and no axis moves.
    Check,
    /// Homing.
    Home,
    /// Spindle, coolant and motors are off until a reset.
    Sleep,
}

impl Display for State {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Idle => f.write_str("Idle"),
            Self::Run => f.write_str("Run"),
            Self::Hold(sub) => write!(f, "Hold:{sub}"),
            Self::Jog => f.write_str("Jog"),
            Self::Alarm => f.write_str("Alarm"),
            Self::Door(sub) => write!(f, "Door:{sub}"),
            Self::Check => f.write_str("Check"),
            Self::Home => f.write_str("Home"),
            Self::Sleep => f.write_str("Sleep"),
        }
    }
}

/// Inputs that are on.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Signals(pub u16);

impl Signals {
    /// Probe.
    pub const PROBE: Self = Self(1 << 8);
    /// Safety door is open.
    pub const DOOR: Self = Self(1 << 9);
    /// Feed hold.
    pub const HOLD: Self = Self(1 << 10);
    /// Reset.
    pub const RESET: Self = Self(1 << 11);
    /// Cycle start.
    pub const START: Self = Self(1 << 12);

    /// Limit switch of an axis, 0…7.
    pub const fn limit(axis: u8) -> Self {
        Self(1 << (axis & 7))
    }

    /// The union of both sets of inputs.
    #[must_use]
    pub const fn and(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// Whether one of `other` is on.
    pub const fn has(self, other: Self) -> bool {
        self.0 & other.0 != 0
    }

    /// Whether a limit switch is on.
    pub const fn has_limit(self) -> bool {
        self.0 & 0xff != 0
    }

    /// The inputs of this set that are not in `before`.
    pub const fn since(self, before: Self) -> Self {
        Self(self.0 & !before.0)
    }
}

//! Modal state of the decoder: values that stay in force from block to block.
use super::Plane;
use crate::quantity::{Feed, Position};

/// Largest coordinate, mm or degrees.
pub const COORDINATE_MAX: i32 = 100_000;

/// G00…G03.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Mode {
    Rapid,
    Line,
    Clockwise,
    Counterclockwise,
    /// No motion word (G00…G03) is programmed yet. A motion is then G01 if there is a feed, otherwise rapid
    /// motion with a warning.
    Unprogrammed,
    /// As `Unprogrammed`, after the warning.
    UnprogrammedTold,
}

/// The modal state before the current line. All bits of the first variant are zero.
#[derive(Clone, Copy)]
#[repr(u8)]
pub(super) enum Before<const AXES: usize> {
    /// No value has changed.
    Alike,
    /// Only these values have changed; a plain line changes no others.
    Feed(Mode, Option<Feed>),
    /// The whole modal state.
    All(Modal<AXES>),
}

/// Values that stay in force from block to block.
#[derive(Clone, Copy)]
pub(super) struct Modal<const AXES: usize> {
    pub mode: Mode,
    pub plane: Plane,
    pub relative: bool,
    pub centre_absolute: bool,
    pub inch: bool,
    /// G7: X is a diameter.
    #[cfg(feature = "grbl")]
    pub diameter: bool,
    pub feed: Option<Feed>,
    pub exact_stop: bool,
    /// Index of the zero offset, 0…5 for G54…G59; `None` for G53.
    pub zero_set: Option<usize>,
    /// Offsets of G92.
    pub shift: [Position; AXES],
    pub radius: Option<Position>,
}

impl<const AXES: usize> Modal<AXES> {
    /// All bits zero.
    pub const BLANK: Self = Self {
        mode: Mode::Rapid,
        plane: Plane::G17,
        relative: false,
        centre_absolute: false,
        inch: false,
        #[cfg(feature = "grbl")]
        diameter: false,
        feed: None,
        exact_stop: false,
        zero_set: None,
        shift: [Position::ZERO; AXES],
        radius: None,
    };

    /// The state at program start: G01 (rapid motion until there is a feed), G17, G71, G90, G94, G162, G260,
    /// G150, G359, and G53 or the offset of P-ZERO-00002.
    pub fn new(default_index: u8) -> Self {
        Self { mode: Mode::Unprogrammed, zero_set: usize::from(default_index).checked_sub(1), ..Self::BLANK }
    }
}

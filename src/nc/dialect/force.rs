//! The modal state after a line, which the controller on a serial line reports and restores. Also the stored
//! zero offsets and positions (G10, G28.1, G30.1).
use super::course::CycleKind;
use super::{Interpreter, State};
use crate::machine::{MORE_OFFSETS, ZERO_OFFSETS};
use crate::nc::Plane;
use crate::nc::compose::in_range;
use crate::nc::modal::{Modal, Mode};
use crate::quantity::{Feed, Position};

/// The modal state after a line: modal words, F, tool, offsets of G92, tool length. Zero offsets belong to
/// the machine's set-up and not to this state.
#[derive(Clone, Copy)]
pub struct InForce<const AXES: usize> {
    modal: Modal<AXES>,
    now: State<AXES>,
}

/// Zero offsets: G54…G59.3.
const SETS: usize = ZERO_OFFSETS + MORE_OFFSETS;

/// Values that G10, G28.1 and G30.1 store, in machine coordinates.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct StoredOffsets<const AXES: usize> {
    /// Zero offsets of G54…G59.3, by set and axis.
    pub zero: [[Position; AXES]; SETS],
    /// Positions of G28 and G30, in this order.
    pub places: [[Position; AXES]; 2],
}

impl<const AXES: usize> StoredOffsets<AXES> {
    /// All values are 0.
    pub const ZERO: Self = Self { zero: [[Position::ZERO; AXES]; SETS], places: [[Position::ZERO; AXES]; 2] };

    /// Whether all values are inside ±100 000 mm.
    pub fn is_in_range(&self) -> bool {
        self.zero.iter().chain(&self.places).flatten().all(|value| in_range(*value))
    }
}

impl<const AXES: usize> InForce<AXES> {
    /// State at power-up: G0 G54 G17 G21 G90 G94, no F, T0, no G92 and no tool length.
    pub const START: Self =
        Self { modal: Modal { zero_set: Some(0), ..Modal::BLANK }, now: State::<AXES>::START };

    /// The motion word in tenths: 0 for G0, 10 for G1, 810 for G81, 800 for G80.
    pub const fn motion(&self) -> u16 {
        match (&self.now.cycle, self.now.no_motion, self.modal.mode) {
            (Some(cycle), ..) => match cycle.kind {
                CycleKind::Drill => 810,
                CycleKind::Dwell => 820,
                CycleKind::Peck => 830,
                CycleKind::Break => 730,
                CycleKind::Bore => 850,
                CycleKind::BoreDwell => 890,
                CycleKind::BoreStop => 860,
                CycleKind::Tap => 840,
                CycleKind::TapLeft => 740,
            },
            (None, true, _) => 800,
            (None, false, Mode::Rapid) => 0,
            (None, false, Mode::Line | Mode::Unprogrammed | Mode::UnprogrammedTold) => 10,
            (None, false, Mode::Clockwise) => 20,
            (None, false, Mode::Counterclockwise) => 30,
        }
    }

    /// Number of the plane word: 17, 18 or 19.
    pub const fn plane(&self) -> u8 {
        match self.modal.plane {
            Plane::G17 => 17,
            Plane::G18 => 18,
            Plane::G19 => 19,
        }
    }

    /// Whether G20 (inch) is in force.
    pub const fn is_inch(&self) -> bool {
        self.modal.inch
    }

    /// Whether G91 (incremental positions) is in force.
    pub const fn is_relative(&self) -> bool {
        self.modal.relative
    }

    /// Whether G93 (F is inverse time) is in force.
    pub const fn is_by_time(&self) -> bool {
        self.now.by_time
    }

    /// The zero offset in force, 0…8 for G54…G59.3.
    pub fn zero_offset(&self) -> usize {
        self.modal.zero_set.unwrap_or(0)
    }

    /// Feed F, mm/min; 0 if none is programmed.
    pub fn feed(&self) -> Feed {
        self.modal.feed.unwrap_or(Feed::ZERO)
    }

    /// Whether G95 (F per revolution) is in force.
    pub const fn is_per_turn(&self) -> bool {
        self.now.per_turn
    }

    /// Programmed spindle speed (word S), 1/min.
    pub const fn speed(&self) -> Position {
        self.now.speed
    }

    /// Whether mist (M7) and flood (M8) are on, in this order.
    pub const fn coolant(&self) -> [bool; 2] {
        [self.now.coolant & 1 != 0, self.now.coolant & 2 != 0]
    }

    /// The programmed tool number (word T).
    pub const fn tool(&self) -> u32 {
        self.now.tool.selected
    }

    /// Spindle word: 3 or 4; 0 if the spindle is off.
    pub const fn spindle(&self) -> u16 {
        self.now.spindle
    }

    /// Offsets of G92 for each axis, mm; 0 while they are suspended.
    pub const fn here(&self) -> [Position; AXES] {
        if self.now.here_off { [Position::ZERO; AXES] } else { self.now.here }
    }

    /// Tool length of each axis, mm.
    pub const fn tool_length(&self) -> [Position; AXES] {
        self.now.length
    }
}

impl<const AXES: usize> Interpreter<AXES> {
    /// The modal state that is in force after the lines read so far.
    pub fn in_force(&self) -> InForce<AXES> {
        InForce { modal: self.modal, now: self.foreign.now }
    }

    /// Restores a modal state for the next line and the following ones.
    pub fn put_in_force(&mut self, force: &InForce<AXES>) {
        (self.modal, self.foreign.now) = (force.modal, force.now);
        self.settle_plain();
        self.settle_shift();
    }

    /// Zero offsets and positions of G28 and G30 that programs have stored.
    pub fn stored(&self) -> StoredOffsets<AXES> {
        let mut zero = [[Position::ZERO; AXES]; SETS];
        let sets = self.setup.zero_offsets.iter().chain(&self.setup.foreign.offsets);
        for (to, from) in zero.iter_mut().zip(sets) {
            *to = *from;
        }
        StoredOffsets { zero, places: self.setup.foreign.stored }
    }

    /// Restores zero offsets and positions for the next line and the following ones.
    pub fn put_stored(&mut self, stored: &StoredOffsets<AXES>) {
        let sets = self.setup.zero_offsets.iter_mut().chain(&mut self.setup.foreign.offsets);
        for (to, from) in sets.zip(&stored.zero) {
            *to = *from;
        }
        self.setup.foreign.stored = stored.places;
    }
}

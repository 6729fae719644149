//! What the decoder hands to the next stage: one typed command at a time.
use crate::machine::{AxisKind, AxisName, MachineData};
use crate::quantity::{Feed, Position};

/// A place in the program text: where a command or an error comes from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Place {
    /// Line, counted from 1.
    pub line: u32,
    /// Column in bytes, counted from 1.
    pub column: u32,
    /// Bytes of the word meant.
    pub length: u32,
    /// Offset of the word in the text, bytes.
    pub offset: u32,
}

/// What the decoder knows of the machine: names, kinds, main axes. Nothing of its dynamics.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setup<const AXES: usize> {
    /// Axis names in the order of the coordinates.
    pub names: [AxisName; AXES],
    /// Axis types.
    pub kinds: [AxisKind; AXES],
    /// The main axes: abscissa, ordinate and applicate of G17.
    pub main: [Option<usize>; 3],
    /// P-CHAN-00108, in thousandths: 100 000 = F in mm/min, 100 = F in m/min (F times 100 000 / this).
    pub feedrate_factor_milli: u32,
    /// Axis positions before the first block.
    pub start: [Position; AXES],
}

impl<const AXES: usize> Setup<AXES> {
    /// The set-up of a machine standing at `start`.
    pub fn new(machine: &MachineData<AXES>, start: [Position; AXES]) -> Self {
        Self {
            names: machine.axes.map(|a| a.name),
            kinds: machine.axes.map(|a| a.kind),
            main: machine.main_axes(),
            feedrate_factor_milli: machine.channel.feedrate_factor_milli,
            start,
        }
    }
}

/// Plane of arcs: which main axes are its first and second.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Plane {
    /// G17: first and second main axis (X, Y).
    #[default]
    G17,
    /// G18: third and first main axis (Z, X).
    G18,
    /// G19: second and third main axis (Y, Z).
    G19,
}

impl Plane {
    /// Places of the plane's first and second axis in the list of main axes.
    pub const fn main_axes(self) -> [usize; 2] {
        match self {
            Self::G17 => [0, 1],
            Self::G18 => [2, 0],
            Self::G19 => [1, 2],
        }
    }
}

/// How an arc was given.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ArcBy {
    /// I, J, K: centre, absolute, in the plane's two axes. A target equal to the start is a full circle.
    Centre([Position; 2]),
    /// R: radius; negative takes the arc of more than 180°.
    Radius(Position),
}

/// G word of a motion block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MotionKind {
    /// G00.
    Rapid,
    /// G01.
    Line,
    /// G02 (clockwise) and G03, a helix where the third main axis moves too.
    Arc {
        /// G17, G18 or G19.
        plane: Plane,
        /// G02.
        clockwise: bool,
        /// Centre or radius.
        by: ArcBy,
    },
}

/// A motion block with absolute machine coordinates of its end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion<const AXES: usize> {
    /// Programmed block number, 0 if none.
    pub n: u32,
    /// First word of the motion in the text.
    pub place: Place,
    /// Rapid, line or arc.
    pub kind: MotionKind,
    /// End point of every axis, offsets applied.
    pub target: [Position; AXES],
    /// Feed, mm/min; of no meaning for [`MotionKind::Rapid`].
    pub feed: Feed,
    /// G60 or G360: standstill at the end of this block.
    pub exact_stop: bool,
}

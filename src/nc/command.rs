//! The commands that the decoder returns, one at a time, and the place in the program text of each.
#[cfg(feature = "grbl")]
use super::dialect::ForeignSetup;
use super::function::*;
use crate::machine::{AxisKind, AxisName, MachineData, SynchTable, ZERO_OFFSETS, functions, of_tenths};
use crate::quantity::{Feed, Position};
#[cfg(feature = "grbl")]
use crate::technology::{Function, InputWait};

/// A place in the program text, from which a command or an error comes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Place {
    /// Line, counted from 1.
    pub line: u32,
    /// Column in bytes, counted from 1.
    pub column: u32,
    /// Offset of the word in its file, bytes.
    pub offset: u32,
    /// Length of the word, bytes.
    pub length: u16,
    /// File: 0 is the main program, others are numbers from [`super::Text::open`].
    pub file: u16,
}

impl Place {
    /// No place: line 0.
    pub const NONE: Self = Self { line: 0, column: 0, offset: 0, length: 0, file: 0 };
}

/// The machine data that the decoder uses: axis names, kinds, main axes, offsets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setup<const AXES: usize> {
    /// Axis names in the order of the coordinates.
    pub names: [AxisName; AXES],
    /// Whether each axis is linear or rotary.
    pub kinds: [AxisKind; AXES],
    /// The main axes: abscissa, ordinate and applicate of G17.
    pub main: [Option<usize>; 3],
    /// P-CHAN-00108, in thousandths. 100 000: F in mm/min; 100: F in m/min. The factor of F is 100 000
    /// divided by this value.
    pub feedrate_factor_milli: u32,
    /// Positions of the axes before the first block, mm or degrees.
    pub start: [Position; AXES],
    /// P-ZERO-00003: zero offsets of G54…G59.
    pub zero_offsets: [[Position; AXES]; ZERO_OFFSETS],
    /// P-ZERO-00002: zero offset that is active at program start: 0 none (G53), 1…6 G54…G59.
    pub default_index: u8,
    /// P-CHAN-00041: synchronisation of M functions. It decides whether an M function is output before or
    /// after the motion of its block.
    pub m_synch: SynchTable,
    /// P-CHAN-00027: synchronisation of H functions. It decides whether an H function is output before or
    /// after the motion of its block.
    pub h_synch: SynchTable,
    /// Synchronisation of functions at program start, from the machine data.
    #[cfg(feature = "plc")]
    pub given: GivenSynch,
    /// Data that only programs of LinuxCNC and Grbl need.
    #[cfg(feature = "grbl")]
    pub foreign: ForeignSetup<AXES>,
}

/// Synchronisation of functions at program start. A program changes it by `V.G.M_FCT` and `V.G.H_FCT`.
#[cfg(feature = "plc")]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GivenSynch {
    /// P-CHAN-00041: synchronisation of M functions.
    pub m: SynchTable,
    /// P-CHAN-00027: synchronisation of H functions.
    pub h: SynchTable,
    /// Whether MEP_SVS and MEP_MOS are available: P-CHAN-00650 contains FCT_SHIFT_NCBL.
    pub shifts: bool,
    /// P-CHAN-00033: whether a program waits at its end for acknowledgements of late synchronisation.
    pub late_sync_ready: bool,
}

impl<const AXES: usize> Setup<AXES> {
    /// Empty data: all bits zero.
    pub(super) const BLANK: Self = Self {
        names: [AxisName([0; 4]); AXES],
        kinds: [AxisKind::Linear; AXES],
        main: [None; 3],
        feedrate_factor_milli: 0,
        start: [Position::ZERO; AXES],
        zero_offsets: [[Position::ZERO; AXES]; ZERO_OFFSETS],
        default_index: 0,
        m_synch: SynchTable::BLANK,
        h_synch: SynchTable::BLANK,
        #[cfg(feature = "plc")]
        given: GivenSynch {
            m: SynchTable::BLANK,
            h: SynchTable::BLANK,
            shifts: false,
            late_sync_ready: false,
        },
        #[cfg(feature = "grbl")]
        foreign: ForeignSetup::ISG,
    };

    /// The data of a machine whose axes are at `start`.
    pub fn new(machine: &MachineData<AXES>, start: [Position; AXES]) -> Self {
        let mut zero_offsets = [[Position::ZERO; AXES]; ZERO_OFFSETS];
        for (set, offsets) in zero_offsets.iter_mut().enumerate() {
            for (offset, axis) in offsets.iter_mut().zip(&machine.axes) {
                *offset = axis.versch.get(set).map_or(Position::ZERO, |tenths| of_tenths(*tenths));
            }
        }
        Self {
            names: machine.axes.map(|a| a.name),
            kinds: machine.axes.map(|a| a.kind),
            main: machine.main_axes(),
            feedrate_factor_milli: machine.channel.feedrate_factor_milli,
            start,
            zero_offsets,
            default_index: machine.channel.default_index,
            m_synch: machine.channel.m_synch,
            h_synch: machine.channel.h_synch,
            #[cfg(feature = "plc")]
            given: GivenSynch {
                m: machine.channel.m_synch,
                h: machine.channel.h_synch,
                shifts: machine.channel.interpolator.has(crate::machine::InterpolatorFunctions::SHIFT_NCBL),
                late_sync_ready: machine.channel.interpolator.late_sync_ready,
            },
            #[cfg(feature = "grbl")]
            foreign: ForeignSetup::new(machine),
        }
    }
}

/// The plane of arcs: two of the main axes, in this order.
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
    /// Indices of the plane's first and second axis in the list of main axes.
    pub const fn main_axes(self) -> [usize; 2] {
        match self {
            Self::G17 => [0, 1],
            Self::G18 => [2, 0],
            Self::G19 => [1, 2],
        }
    }
}

/// The word that defines an arc.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ArcBy {
    /// I, J, K: absolute coordinates of the centre, in the two axes of the plane. A target equal to the start
    /// means a full circle.
    Centre([Position; 2]),
    /// R: the radius; a negative radius selects the arc of more than 180°.
    Radius(Position),
}

/// The kind of a motion, which the G word of its block selects.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MotionKind {
    /// G00: rapid motion on a straight line.
    Rapid,
    /// G01: straight motion at feed.
    Line,
    /// G02 (clockwise) and G03; a helix if the third main axis moves too.
    Arc {
        /// G17, G18 or G19.
        plane: Plane,
        /// `true`: G02, clockwise. `false`: G03.
        clockwise: bool,
        /// Whether the block gives the centre or the radius of the arc.
        by: ArcBy,
    },
}

/// A motion block: kind, end point and feed. The end point is in machine coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion<const AXES: usize> {
    /// N number of the block in the program; 0 without one.
    pub n: u32,
    /// First word of the motion in the text.
    pub place: Place,
    /// Place of R, or of I, J and K, in the text. If the block has none of these words (R stays in force), it
    /// is [`Self::place`].
    pub centre: Place,
    /// Rapid motion, line or arc.
    pub kind: MotionKind,
    /// End point of every axis in machine coordinates, including offsets; mm or degrees.
    pub target: [Position; AXES],
    /// Feed, mm/min; unused for [`MotionKind::Rapid`].
    pub feed: Feed,
    /// G60 or G360: the axes stop at the end of this block.
    pub exact_stop: bool,
    /// Axes that the block names: bit i for axis i.
    pub named: u32,
}

/// A command with its parameters.
///
/// A block gives its commands in this order:
/// - switches, weights, S, T and D, in the order of the text;
/// - functions that [`Setup::m_synch`] and [`Setup::h_synch`] place before the motion;
/// - the motion or dwell;
/// - the other M and H functions;
/// - the program end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Command<const AXES: usize> {
    /// A motion: G00, G01, G02 or G03.
    Motion(Motion<AXES>),
    /// A dwell: G04 or `#TIME`.
    Dwell(Head, DwellTime),
    /// An M function, 0 to 999, for output. M02, M17, M29 and M30 are not among them: they end a program or a
    /// subroutine.
    M(Head, u16),
    /// An H function, 0 to 999, for output.
    H(Head, u16),
    /// Word S: spindle speed, 1/min.
    Spindle(Head, Value),
    /// Word T: tool number.
    Tool(Head, u32),
    /// Word D: number of a tool offset.
    ToolOffset(Head, u32),
    /// G93, G95 or G194: the meaning of the word F.
    FeedMode(Head, FeedMode),
    /// Word E: feed at the end of the block.
    EndFeed(Head),
    /// G60, G359 or G360: exact stop at the end of blocks.
    ExactStop(Head, ExactStop),
    /// `#SLOPE` or `#SET SLOPE PROFIL`: the kind of speed profile.
    Slope(Head, Slope),
    /// `#CONTOUR MODE`, G61, G260 or G261: rounding of corners.
    Contour(Head, Contour),
    /// `#HSC`: smoothing of short blocks.
    Hsc(Head, Hsc),
    /// `#FILTER`: FIR filters of the axes.
    Filter(Head, Filter),
    /// `#VECTOR LIMIT`: limits along the path.
    VectorLimit(Head, VectorLimit),
    /// G150, G151, `#SPLINE` or `#AKIMA`: direct splines.
    Spline(Head, Spline<AXES>),
    /// G130…G134, G231…G233, G338 or G339: accelerations and ramp times in percent.
    Weight(Head, Weight<AXES>),
    /// `#KIN ID` or `#TRAFO`: transformation of a machine with rotary axes.
    Kinematics(Head, Kinematics),
    /// `#PUT AX`: releases axes from the channel; bit i for axis i.
    PutAxes(Head, u32),
    /// `#CALL AX`: takes axes into the channel; bit i for axis i.
    CallAxes(Head, u32),
    /// `#RT WHILE`: begins a real-time loop. `true`: with the word MODULO.
    RtWhile(Head, bool),
    /// `#RT ENDWHILE`: ends a real-time loop.
    RtEndWhile(Head),
    /// `#CONTOUR LOOKAHEAD LOG`: switches or marks the log of the path ahead.
    ContourLog(Head, ContourLog),
    /// `#DISTANCE PROG START CLEAR`: distances of the log count from here.
    DistanceClear(Head),
    /// `#FLUSH&WAIT`: the program waits until the axes stand still.
    FlushWait(Head),
    /// `X[OSC …]`: oscillation of a single axis.
    Oscillation(Head, Oscillation),
    /// `X[INDP_… …]`: motion of a single axis, independent of the path.
    Independent(Head, Independent),
    /// `#WAIT INDP`: the program waits for independent motions; bit i for axis i.
    WaitIndependent(Head, u32),
    /// M02 or M30: the end of the program.
    ProgramEnd(Head, u16),
    /// M0, M1, M6 and M60 of LinuxCNC and Grbl: the axes stop until the operator acknowledges this M
    /// function.
    #[cfg(feature = "grbl")]
    Pause(Head, u16),
    /// M62 to M65, M67, M68 of LinuxCNC. `true`: at once, and the corner before the output stays sharp.
    /// `false`: together with the next motion.
    #[cfg(feature = "grbl")]
    Output(Head, Function, bool),
    /// M66 of LinuxCNC: the axes stop until the operator acknowledges [`Function::Input`].
    #[cfg(feature = "grbl")]
    WaitInput(Head, InputWait),
    /// A text for the operator, `#MSG ["text"]` or the comment `(MSG, text)`. The place is that of the text.
    #[cfg(any(feature = "grbl", feature = "plc"))]
    Message(Head),
    /// `#FLUSH`: the planner no longer holds blocks back until the next block is known.
    #[cfg(feature = "plc")]
    Flush(Head),
    /// #EXPL SYN: functions with MVS_SLP must be acknowledged before the next motion block.
    #[cfg(feature = "plc")]
    ExplicitSynch(Head),
    /// G38.2…G38.5 of other dialects: a motion until the probe switches. The planner refuses this command by
    /// name; an application with a probe carries it out.
    #[cfg(feature = "grbl")]
    Probe(Head, Probe<AXES>),
}

/// A probing motion: straight, until the probe switches.
#[cfg(feature = "grbl")]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Probe<const AXES: usize> {
    /// `true`: the probe closes during the motion. `false`: it opens (G38.4, G38.5).
    pub towards: bool,
    /// Whether a motion that ends without a switch of the probe is an error (G38.2, G38.4).
    pub must_switch: bool,
    /// End of the motion if the probe does not switch, machine coordinates.
    pub target: [Position; AXES],
    /// Feed, mm/min.
    pub feed: Feed,
}

impl<const AXES: usize> Command<AXES> {
    /// Block number and place of a command; `None` for a motion, which has both itself.
    pub const fn head(&self) -> Option<&Head> {
        match self {
            Self::Motion(_) => None,
            Self::Dwell(h, _)
            | Self::M(h, _)
            | Self::H(h, _)
            | Self::Spindle(h, _)
            | Self::Tool(h, _)
            | Self::ToolOffset(h, _)
            | Self::FeedMode(h, _)
            | Self::EndFeed(h)
            | Self::ExactStop(h, _)
            | Self::Slope(h, _)
            | Self::Contour(h, _)
            | Self::Hsc(h, _)
            | Self::Filter(h, _)
            | Self::VectorLimit(h, _)
            | Self::Spline(h, _)
            | Self::Weight(h, _)
            | Self::Kinematics(h, _)
            | Self::PutAxes(h, _)
            | Self::CallAxes(h, _)
            | Self::RtWhile(h, _)
            | Self::RtEndWhile(h)
            | Self::ContourLog(h, _)
            | Self::DistanceClear(h)
            | Self::FlushWait(h)
            | Self::Oscillation(h, _)
            | Self::Independent(h, _)
            | Self::WaitIndependent(h, _)
            | Self::ProgramEnd(h, _) => Some(h),
            #[cfg(feature = "grbl")]
            Self::Pause(h, _) | Self::Probe(h, _) | Self::Output(h, ..) | Self::WaitInput(h, _) => Some(h),
            #[cfg(any(feature = "grbl", feature = "plc"))]
            Self::Message(h) => Some(h),
            #[cfg(feature = "plc")]
            Self::Flush(h) | Self::ExplicitSynch(h) => Some(h),
        }
    }

    /// Whether the command only switches a function off. Such a command has no effect while the function is
    /// off.
    pub const fn switches_off(&self) -> bool {
        match self {
            Self::ExactStop(_, switch) => matches!(switch, ExactStop::Off),
            Self::Contour(_, contour) => matches!(contour.switch, Some(ContourSwitch::Off)),
            Self::Hsc(_, hsc) => matches!(hsc.switch, Some(false)),
            Self::Filter(_, filter) => matches!(filter.switch, Some(false)),
            Self::VectorLimit(_, limits) => !limits.on,
            Self::Spline(_, spline) => matches!(spline, Spline::Off),
            Self::Kinematics(_, kinematics) => matches!(kinematics, Kinematics::Off),
            _ => false,
        }
    }

    /// Place of the command in the text.
    pub const fn place(&self) -> Place {
        match (self, self.head()) {
            (Self::Motion(motion), _) => motion.place,
            (_, Some(head)) => head.place,
            _ => Place::NONE,
        }
    }

    /// N number of the block in the program; 0 without one.
    pub const fn n(&self) -> u32 {
        match (self, self.head()) {
            (Self::Motion(motion), _) => motion.n,
            (_, Some(head)) => head.n,
            _ => 0,
        }
    }

    /// Name of the command in the language, for messages.
    pub const fn name(&self) -> &'static str {
        match self {
            // Without ISG's words, no other command needs its name.
            #[cfg(feature = "grbl")]
            Self::Probe(..) => "probing (G38.2 to G38.5)",
            _ if !functions::ISG.is_built() => "a word of ISG's controllers",
            Self::Motion(motion) => match motion.kind {
                MotionKind::Rapid => "G00",
                MotionKind::Line => "G01",
                MotionKind::Arc { clockwise: true, .. } => "G02",
                MotionKind::Arc { .. } => "G03",
            },
            Self::Dwell(..) => "G04",
            Self::M(..) => "M function",
            Self::H(..) => "H function",
            Self::Spindle(..) => "spindle speed S",
            Self::Tool(..) => "tool T",
            Self::ToolOffset(..) => "tool offset D",
            Self::FeedMode(_, FeedMode::Time) => "G93",
            Self::FeedMode(_, FeedMode::PerRevolution) => "G95",
            Self::FeedMode(_, FeedMode::Percent) => "G194",
            Self::EndFeed(_) => "end feed E",
            Self::ExactStop(_, ExactStop::Block) => "G60",
            Self::ExactStop(_, ExactStop::On) => "G360",
            Self::ExactStop(_, ExactStop::Off) => "G359",
            Self::Slope(..) => "#SLOPE",
            Self::Contour(..) => "contouring (#CONTOUR MODE, G61, G261, G260)",
            Self::Hsc(..) => "#HSC",
            Self::Filter(..) => "#FILTER",
            Self::VectorLimit(..) => "#VECTOR LIMIT",
            Self::Spline(..) => "spline (G150, G151, #SPLINE, #AKIMA)",
            Self::Weight(_, weight) => weight.kind.name(),
            Self::Kinematics(_, Kinematics::Select(_)) => "#KIN ID",
            Self::Kinematics(..) => "#TRAFO",
            Self::PutAxes(..) => "#PUT AX",
            Self::CallAxes(..) => "#CALL AX",
            Self::RtWhile(..) => "#RT WHILE",
            Self::RtEndWhile(_) => "#RT ENDWHILE",
            Self::ContourLog(..) => "#CONTOUR LOOKAHEAD LOG",
            Self::DistanceClear(_) => "#DISTANCE PROG START CLEAR",
            Self::FlushWait(_) => "#FLUSH&WAIT",
            Self::Oscillation(..) => "oscillation [OSC …]",
            Self::Independent(..) => "independent axis [INDP_…]",
            Self::WaitIndependent(..) => "#WAIT INDP",
            Self::ProgramEnd(..) => "program end",
            #[cfg(feature = "grbl")]
            Self::Pause(..) => "pause",
            #[cfg(feature = "grbl")]
            Self::Output(..) => "output (M62 to M68)",
            #[cfg(feature = "grbl")]
            Self::WaitInput(..) => "wait for an input (M66)",
            #[cfg(any(feature = "grbl", feature = "plc"))]
            Self::Message(_) => "message",
            #[cfg(feature = "plc")]
            Self::Flush(_) => "#FLUSH",
            #[cfg(feature = "plc")]
            Self::ExplicitSynch(_) => "#EXPL SYN",
        }
    }
}

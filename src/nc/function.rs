//! Commands other than motion, as types. A field with the value `None` was not programmed: its parameter
//! keeps its value. ISG's defaults are in square brackets.
//!
//! Lengths are in mm, angles in degrees; both have LSB 2^-32 and are rounded to nearest.
use super::Place;
use crate::machine::functions;
use crate::quantity::Position;

/// A number with its own unit (percent, seconds, Hz, 1/min), LSB 2^-32, rounded to nearest.
pub type Value = fixed::types::I32F32;

/// Where a command comes from: the block and the word.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Head {
    /// N number of the block in the program; 0 without one.
    pub n: u32,
    /// Place of the command's word in the text.
    pub place: Place,
    /// Whether the block also holds a motion. The motion comes after switches and weights, before M and H.
    pub in_motion: bool,
}

/// The length of a dwell (G04, `#TIME`).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DwellTime {
    /// Seconds, 0…100 000.
    Seconds(Value),
    /// A number of revolutions of the spindle.
    Revolutions(Value),
}

/// The meaning of the word F, if it is not a speed (G94).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum FeedMode {
    /// G93: F is the time for the block.
    Time,
    /// G95: F is the feed per revolution of the spindle.
    PerRevolution,
    /// G194: F is a percentage.
    Percent,
}

/// Exact stop: a command to stop at the end of blocks. [`super::Motion::exact_stop`] also says whether its
/// block ends in an exact stop.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum ExactStop {
    /// G60: the axes stop at the end of this block.
    Block,
    /// G360: the axes stop at the end of each block from here on.
    On,
    /// G359: no exact stop from here on.
    Off,
}

/// The kind of speed profile (slope), which decides how acceleration changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum SlopeType {
    /// STEP: acceleration changes in steps, without a jerk limit.
    Step,
    /// TRAPEZ: acceleration rises and falls linearly, with constant jerk.
    Trapez,
    /// SIN2: acceleration rises and falls as a sine square.
    Sin2,
    /// HSC: as TRAPEZ, and acceleration may continue from block to block.
    Hsc,
}

impl SlopeType {
    /// Whether this is STEP, in a build that has STEP.
    #[inline(always)]
    pub const fn is_step(self) -> bool {
        functions::SLOPES.is_built() && matches!(self, Self::Step)
    }

    /// The slope with this number of P-CHAN-00071.
    pub const fn of_profile(profile: u8) -> Self {
        match profile {
            0 => Self::Step,
            1 => Self::Trapez,
            2 => Self::Sin2,
            _ => Self::Hsc,
        }
    }
}

/// A command that selects the slope: `#SLOPE`, `#SLOPE DEFAULT`, `#SET SLOPE PROFIL`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Slope {
    /// DEFAULT: selects the slope of the machine data (P-CHAN-00071).
    pub default: bool,
    /// TYPE: the slope to select.
    pub kind: Option<SlopeType>,
    /// NO_OPT, for the slope HSC. `false`: the axes may enter a slow block while braking, and leave it while
    /// accelerating \[true\].
    pub no_opt: Option<bool>,
}

/// The method of contour mode, which decides the curve of a corner.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum ContourMethod {
    /// DEV: limits the distance between curve and corner \[default\].
    Dev,
    /// DIST: gives the distances from the corner at which the curve begins and ends.
    Dist,
    /// POS: gives a point that the curve passes.
    Pos,
    /// DIST_SOFT: the dynamics of the axes determine the curve.
    DistSoft,
    /// DIST_MASTER: the dynamics of the axes determine the curve, and the master axis keeps its speed.
    DistMaster,
    /// PTP: shortest time over the whole contour.
    Ptp,
}

impl ContourMethod {
    /// Whether the method is DIST_SOFT, DIST_MASTER or PTP. The dynamics of the axes determine their curves,
    /// so these methods need ramp times.
    pub const fn is_optimised(self) -> bool {
        matches!(self, Self::DistSoft | Self::DistMaster | Self::Ptp)
    }
}

/// The time at which M and H functions of a corner are output.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum ContourAction {
    /// PRE_ACTION: before the curve.
    Pre,
    /// INTER_ACTION: in the middle of the curve \[default\].
    Inter,
    /// POST_ACTION: after the curve.
    Post,
}

/// How long contour mode rounds corners.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum ContourSwitch {
    /// G61: only the corner at the end of this block.
    Block,
    /// G261 or `#CONTOUR MODE ON`: every corner from here on.
    On,
    /// G260 or `#CONTOUR MODE OFF`: no corner from here on.
    Off,
}

/// Contour mode: `#CONTOUR MODE`, G61, G261, G260. With `switch: Some(ContourSwitch::Off)`, the command
/// switches contour mode off.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Contour {
    /// Switches contour mode on or off.
    pub switch: Option<ContourSwitch>,
    /// The method: DEV, DIST, POS, DIST_SOFT, DIST_MASTER or PTP.
    pub method: Option<ContourMethod>,
    /// Where functions of the corner are output: PRE_ACTION, INTER_ACTION or POST_ACTION.
    pub action: Option<ContourAction>,
    /// PATH_DEV: largest distance of the main axes from the corner \[1 mm\].
    pub path_dev: Option<Position>,
    /// TRACK_DEV: largest deviation of each tracking axis; 0: not monitored \[0°\].
    pub track_dev: Option<Position>,
    /// RELEVANT_PATH: a shorter block may be left out at a corner \[0 mm\]. The value is as programmed;
    /// contour mode uses at least 0.032 mm.
    pub relevant_path: Option<Position>,
    /// RELEVANT_TRACK: as RELEVANT_PATH, for tracking axes \[0°\].
    pub relevant_track: Option<Position>,
    /// REMAIN_PART: the part of a block that corner curves leave, percent \[0\].
    pub remain_part: Option<Value>,
    /// CHECK_JERK: which ramp time limits the jerk in a curve. 0: none, 1: the geometric one, 2: those of the
    /// slope \[P-CHAN-00110\].
    pub check_jerk: Option<u8>,
    /// MAX_ANGLE: a corner with a larger change of direction stays sharp \[178°\].
    pub max_angle: Option<Position>,
    /// CONST_VEL: the path speed is constant in the curve \[false\].
    pub const_vel: Option<bool>,
    /// PRE_DIST: distance from the start of the curve to the corner \[1 mm\].
    pub pre_dist: Option<Position>,
    /// POST_DIST: distance from the corner to the end of the curve \[1 mm\].
    pub post_dist: Option<Position>,
    /// X, Y, Z of POS: the interim point on the three main axes, including offsets.
    pub point: [Option<Position>; 3],
    /// PATH_DIST: largest distance from the corner to the ends of the curve, for DIST_SOFT and PTP \[1 mm\];
    /// -1: not monitored.
    pub path_dist: Option<Position>,
    /// TRACK_DIST: largest distance from the corner at which axes that are no main axes begin to deviate, for
    /// DIST_SOFT \[as PATH_DIST\]; -1: not monitored.
    pub track_dist: Option<Position>,
    /// SYM_DIST: distance from the corner to both ends of the curve of DIST_MASTER \[1 mm\]; -1: not
    /// monitored.
    pub sym_dist: Option<Position>,
    /// ACC_MAX: largest acceleration in a curve of DIST_SOFT or DIST_MASTER, percent of the axes'
    /// acceleration \[100\].
    pub acc_max: Option<Value>,
    /// ACC_MIN: least acceleration in a curve of DIST_SOFT or DIST_MASTER, percent of the axes' acceleration
    /// \[50\].
    pub acc_min: Option<Value>,
    /// RAMP_TIME: ramp time in a curve of DIST_SOFT or DIST_MASTER, percent of the axes' ramp time \[100\].
    pub ramp_time: Option<Value>,
    /// DIST_WEIGHT: how much the lengths of the neighbours decide which part of a block each corner may take,
    /// percent. 0: each corner may take up to half of the block \[0\].
    pub dist_weight: Option<Value>,
    /// MERGE: PTP makes one block of blocks that continue straight \[true\].
    pub merge: Option<bool>,
}

/// The method with which `#HSC` smooths the path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum HscMethod {
    /// SURFACE: one smooth curve through many short blocks.
    Surface,
    /// BSPLINE: a B-spline inside a tolerance.
    Bspline,
    /// OPMODE 1 (contour mode) or 2 (a spline through the points).
    Op(u8),
}

/// The command `#HSC`: smoothing of short blocks. `switch: Some(false)` switches it off.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Hsc {
    /// ON or OFF; `None` if the command only gives parameters.
    pub switch: Option<bool>,
    /// The method: SURFACE, BSPLINE or OPMODE.
    pub method: Option<HscMethod>,
    /// PATH_DEV: largest distance of the curve from the path \[0.2 mm\]. Surface: above 0. B-spline: 0 is not
    /// monitored.
    pub path_dev: Option<Position>,
    /// PATH_DEV_G00: PATH_DEV between rapid blocks \[as PATH_DEV\].
    pub path_dev_g00: Option<Position>,
    /// TRACK_DEV: largest deviation of each axis that is no main axis \[Surface 2°, B-spline 5°\].
    pub track_dev: Option<Position>,
    /// TRACK_DEV_G00: TRACK_DEV between rapid blocks \[as TRACK_DEV\].
    pub track_dev_g00: Option<Position>,
    /// MAX_ANGLE: a corner between lines with a larger change of direction stays sharp \[160°\].
    pub max_angle: Option<Position>,
    /// CHECK_JERK: which ramp time limits the jerk in a curve. 0: none, 1: the geometric one, 2: those of the
    /// slope \[P-CHAN-00110\].
    pub check_jerk: Option<u8>,
    /// AUTO_OFF_G00: rapid blocks stay unchanged \[false\].
    pub auto_off_g00: Option<bool>,
    /// CIR_MODE: how Surface treats arcs \[1\]. 0: arcs and their transitions stay exact. 1: small arcs are
    /// smoothed, and transitions with other arcs get curves. 2: as 1, and long arcs may be smoothed too.
    pub cir_mode: Option<u8>,
    /// CIR_MIN_ANGLE: an arc with a smaller angle counts as small \[30°\].
    pub cir_min_angle: Option<Position>,
    /// CIR_MIN_RADIUS: an arc with a smaller radius counts as small \[0 mm\].
    pub cir_min_radius: Option<Position>,
    /// MERGE: lines that are nearly straight become one line \[false\].
    pub merge: Option<bool>,
    /// LENGTH_LONG_CIR: least length of the chords by which CIR_MODE=2 replaces a long arc \[2 mm\].
    pub length_long_cir: Option<Position>,
    /// AUTO_OFF_PATH: where the B-spline would exceed PATH_DEV, it passes the point exactly \[false\].
    pub auto_off_path: Option<bool>,
    /// AUTO_OFF_TRACK: where the B-spline would exceed TRACK_DEV, it passes the point exactly \[false\].
    pub auto_off_track: Option<bool>,
    /// AUTO_OFF_G60: the B-spline ends at an exact stop \[false\].
    pub auto_off_g60: Option<bool>,
    /// MAX_PATH_LENGTH: the B-spline leaves a longer line unchanged \[0 mm: off\].
    pub max_path_length: Option<Position>,
    /// CONTERROR: tolerance of the curve with OPMODE \[0.1 mm\].
    pub conterror: Option<Position>,
}

impl Hsc {
    /// Whether the command has parameters in addition to its switch.
    pub fn gives_parameters(&self) -> bool {
        *self != Self { switch: self.switch, ..Self::default() }
    }
}

/// The command `#FILTER`: FIR filters of the axes. `switch: Some(false)` switches the filters off.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Filter {
    /// ON or OFF; `None` if the command only gives parameters.
    pub switch: Option<bool>,
    /// HSC: whether the command has the old form `#FILTER ON [HSC]`.
    pub hsc: bool,
    /// ORDER: order of the filters, 0…200.
    pub order: Option<u8>,
    /// ORDER_TIME: order of the filters as a time, µs.
    pub order_time_us: Option<Value>,
    /// SHARE: how strongly the filters act, percent \[100\].
    pub share: Option<Value>,
    /// AX_DEV: largest deviation of filtered set points from unfiltered ones of the same delay \[0 mm: not
    /// monitored\].
    pub ax_dev: Option<Position>,
    /// FCUT: cut-off frequency of a windowed sinc, Hz \[30\].
    pub fcut: Option<Value>,
    /// ACC_FACT: factor for the step of speed that P-AXIS-00013 permits at a corner, 1…10 \[1\].
    pub acc_fact: Option<Value>,
    /// QUALITY: width of a Gauss filter, above 0 to 1 \[1\].
    pub quality: Option<Value>,
}

/// The value of one limit of `#VECTOR LIMIT`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Limit {
    /// The value of the channel parameter (P-CHAN-00002, 00090, 00208).
    Channel,
    /// The given value, in the unit of P-CHAN-00351.
    Is(Value),
}

/// `#VECTOR LIMIT ON` or `OFF`, with the named limits. `on: false` switches them off.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct VectorLimit {
    /// `true`: ON. `false`: OFF.
    pub on: bool,
    /// ALL: every limit gets the value of the machine data.
    pub all: bool,
    /// ACC: limit of the path acceleration.
    pub acc: Option<Limit>,
    /// DEC: limit of the path deceleration.
    pub dec: Option<Limit>,
    /// VEL: limit of the path speed.
    pub vel: Option<Limit>,
    /// RADIAL_ACC: the planner refuses this limit.
    pub radial_acc: Option<Limit>,
    /// RADIAL_JERK: the planner refuses this limit.
    pub radial_jerk: Option<Limit>,
    /// JERK: the planner refuses this limit.
    pub jerk: Option<Limit>,
    /// TRANS_ACC: the planner refuses this limit.
    pub trans_acc: Option<Limit>,
    /// FEED: the limits act on motion at feed (G01, G02, G03).
    pub feed: bool,
    /// RAPID: the limits act on rapid motion (G00).
    pub rapid: bool,
}

/// The kind of a direct spline.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum SplineType {
    /// AKIMA: the curve passes through the programmed points \[default\].
    Akima,
    /// BSPLINE: the programmed points are control points; the curve passes near them.
    Bspline,
}

/// What decides the direction at an end of an Akima spline.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Tangent {
    /// AUTO: the points of the spline \[default\].
    Auto,
    /// TANGENTIAL: the neighbour block, whose direction the spline continues.
    Tangential,
    /// USER: the vector of `#AKIMA STARTVECTOR` or `#AKIMA ENDVECTOR`.
    User,
}

/// Commands of direct splines. [`Spline::Off`] switches the spline off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Spline<const AXES: usize> {
    /// G151, #SPLINE ON, #SET SPLINE ON: the spline begins.
    On,
    /// G150, #SPLINE OFF, #SET SPLINE OFF: the spline ends.
    Off,
    /// #SPLINE TYPE, #SET SPLINETYPE: selects the kind of spline.
    Type(SplineType),
    /// #AKIMA TRANS, #SET ASPLINE MODE: selects what decides the directions at the ends.
    Transition {
        /// START: what decides the direction at the start.
        start: Option<Tangent>,
        /// END: what decides the direction at the end.
        end: Option<Tangent>,
    },
    /// `#AKIMA STARTVECTOR`: the direction at the start, one component per axis.
    StartVector([Option<Value>; AXES]),
    /// `#AKIMA ENDVECTOR`: the direction at the end, one component per axis.
    EndVector([Option<Value>; AXES]),
}

/// Which machine data a weight word changes: acceleration or ramp time, at feed or in rapid motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum WeightKind {
    /// G130: acceleration at feed, one value per axis.
    Acceleration,
    /// G131: acceleration at feed, one value for all axes.
    AccelerationAll,
    /// G132: ramp time at feed, one value per axis.
    RampTime,
    /// G133: ramp time at feed, one value for all axes.
    RampTimeAll,
    /// G134: geometric ramp time, one value for all axes.
    GeometricRampTime,
    /// G231: acceleration in rapid motion, one value for all axes.
    RapidAcceleration,
    /// G232: ramp time in rapid motion, one value per axis.
    RapidRampTime,
    /// G233: ramp time in rapid motion, one value for all axes.
    RapidRampTimeAll,
    /// G338: ramp time at feed, one value for all axes.
    G338,
    /// G339: ramp time in rapid motion, one value for all axes.
    G339,
}

impl WeightKind {
    /// The kind of weight that a G number sets; `None` for other numbers.
    pub const fn from_g(number: u16) -> Option<Self> {
        Some(match number {
            130 => Self::Acceleration,
            131 => Self::AccelerationAll,
            132 => Self::RampTime,
            133 => Self::RampTimeAll,
            134 => Self::GeometricRampTime,
            231 => Self::RapidAcceleration,
            232 => Self::RapidRampTime,
            233 => Self::RapidRampTimeAll,
            338 => Self::G338,
            339 => Self::G339,
            _ => return None,
        })
    }

    /// Whether the word has one value per axis.
    pub const fn per_axis(self) -> bool {
        matches!(self, Self::Acceleration | Self::RampTime | Self::RapidRampTime)
    }

    /// The G word, for messages.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Acceleration => "G130",
            Self::AccelerationAll => "G131",
            Self::RampTime => "G132",
            Self::RampTimeAll => "G133",
            Self::GeometricRampTime => "G134",
            Self::RapidAcceleration => "G231",
            Self::RapidRampTime => "G232",
            Self::RapidRampTimeAll => "G233",
            Self::G338 => "G338",
            Self::G339 => "G339",
        }
    }
}

/// Weights of the axes: percent of the machine data, above 0 to 10 000. `None` means 100 % by ISG's rule.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weight<const AXES: usize> {
    /// Which machine data the weights change.
    pub kind: WeightKind,
    /// The weight of each axis in percent.
    pub percent: [Option<Value>; AXES],
}

/// The transformation of a machine with rotary axes: `#KIN ID[n]`, `#TRAFO ON`, `#TRAFO OFF`, `#TRAFO[n]`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Kinematics {
    /// `#KIN ID`: selects the data set for the next `#TRAFO ON`.
    Select(u16),
    /// #TRAFO ON: switches the transformation on.
    On,
    /// `#TRAFO[n]`: selects a data set and switches the transformation on.
    OnWith(u16),
    /// #TRAFO OFF: switches the transformation off.
    Off,
}

/// A command for the log of the path ahead: `#CONTOUR LOOKAHEAD [LOG]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ContourLog {
    /// ON: starts the log; with the number after PARAM, if given.
    On(Option<f64>),
    /// OFF: ends the log; with the number after PARAM, if given.
    Off(Option<f64>),
    /// PARAM alone: adds an entry with this number.
    Parameter(f64),
    /// CLEAR: removes all entries of the log.
    Clear,
}

/// The speed of an oscillation: one of three quantities.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum OscillationSpeed {
    /// FEED: speed of the axis, mm/min; P-CHAN-00108 may change the unit.
    Feed(Value),
    /// FREQ: number of oscillations per second, Hz.
    Frequency(Value),
    /// TIME: duration of one oscillation, s.
    Period(Value),
}

/// What an oscillation command does. Reversal positions are machine coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum OscillationAction {
    /// ON: the axis oscillates between two positions.
    On {
        /// First reversal position: 1ST_POS, or ZERO_POS − EXCUR.
        first: Position,
        /// Second reversal position: 2ND_POS, or ZERO_POS + EXCUR.
        second: Position,
        /// The speed: FEED, FREQ or TIME.
        speed: OscillationSpeed,
        /// 1ST_DELT: dwell at the first position, s \[0\].
        first_wait: Value,
        /// 2ND_DELT: dwell at the second position, s \[0\].
        second_wait: Value,
        /// NBR_OSC: number of oscillations \[endless\].
        count: Option<u32>,
        /// SHORT: a modulo axis turns the shorter way to each position.
        short: bool,
    },
    /// OFF: the oscillation ends after the current cycle.
    Off,
    /// OFF FEED: the oscillation ends at once, and the axis moves to the second position at this feed.
    OffFeed(Value),
    /// OFF INSTANT: the axis brakes and stays at the stop.
    OffInstant,
}

/// A command for the oscillation of a single axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Oscillation {
    /// Index of the axis, from 0.
    pub axis: usize,
    /// Starts the oscillation, or ends it in one of three ways.
    pub action: OscillationAction,
}

/// `X[INDP_SYN …]`, `X[INDP_ASYN …]`: motion of an independent axis.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Independent {
    /// Index of the axis, from 0.
    pub axis: usize,
    /// Whether the path waits for the motion (INDP_SYN).
    pub synchronous: bool,
    /// `true`: rapid motion (G00). `false`: motion at feed (G01).
    pub rapid: bool,
    /// `true`: the position is relative (G91). `false`: it is absolute (G90).
    pub relative: bool,
    /// POS, POSITION: the target, machine coordinates.
    pub position: Option<Position>,
    /// FEED: speed of the axis, mm/min.
    pub feed: Option<Value>,
    /// TIME: duration of the motion, s.
    pub time: Option<Value>,
    /// FEED_MAX_WEIGHT: speed in % of P-AXIS-00212, below 100.
    pub weight: Option<Value>,
    /// ACC_WEIGHT (with G01) or RAPID_ACC_WEIGHT (with G00): acceleration in % of the machine data \[100\].
    pub acceleration: Option<Value>,
    /// M: number of an M function that is output before the motion.
    pub m: Option<u32>,
    /// H: number of an H function that is output before the motion.
    pub h: Option<u32>,
    /// SLOPE_TYPE: the slope of this motion.
    pub slope: Option<SlopeType>,
}

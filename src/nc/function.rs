//! Commands other than motion, as types. A field with `None` was not programmed and keeps its value. ISG
//! defaults are in square brackets.
//!
//! Lengths are in mm, angles in degrees, both with LSB 2^-32, rounded to nearest.
use super::Place;
use crate::machine::functions;
use crate::quantity::Position;

/// A number with its own unit (percent, seconds, Hz, 1/min), LSB 2^-32, rounded to nearest.
pub type Value = fixed::types::I32F32;

/// The block and the word from which a command comes.
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

/// G60, G360, G359; [`ExactStop::Off`] switches the exact stop off. [`super::Motion::exact_stop`] contains
/// the result too.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum ExactStop {
    /// G60: at the end of this block.
    Block,
    /// G360: at the end of each block from here on.
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
    /// NO_OPT: `true` switches the optimised use of jerk off \[true\].
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

/// `#CONTOUR MODE`, G61, G261, G260. `switch: Some(ContourSwitch::Off)` switches contour mode off.
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
    /// RELEVANT_PATH \[0 mm\], as programmed (contour mode uses at least 0.032 mm).
    pub relevant_path: Option<Position>,
    /// RELEVANT_TRACK: as RELEVANT_PATH, for tracking axes \[0°\].
    pub relevant_track: Option<Position>,
    /// REMAIN_PART: the part of a block that corner curves leave, percent \[0\].
    pub remain_part: Option<Value>,
    /// CHECK_JERK, 0…2 \[P-CHAN-00110\].
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
    /// PATH_DIST \[1 mm\]; -1: not monitored.
    pub path_dist: Option<Position>,
    /// TRACK_DIST \[as PATH_DIST\]; -1: not monitored.
    pub track_dist: Option<Position>,
    /// SYM_DIST \[1 mm\]; -1: not monitored.
    pub sym_dist: Option<Position>,
    /// ACC_MAX, percent \[100\].
    pub acc_max: Option<Value>,
    /// ACC_MIN, percent \[50\].
    pub acc_min: Option<Value>,
    /// RAMP_TIME, percent \[100\].
    pub ramp_time: Option<Value>,
    /// DIST_WEIGHT, percent \[0\].
    pub dist_weight: Option<Value>,
    /// MERGE \[true\].
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

/// `#HSC`. `switch: Some(false)` switches it off.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Hsc {
    /// ON or OFF; `None` if the command only gives parameters.
    pub switch: Option<bool>,
    /// The method: SURFACE, BSPLINE or OPMODE.
    pub method: Option<HscMethod>,
    /// PATH_DEV \[0.2 mm\]; Surface: above 0, B-spline: 0 is not monitored.
    pub path_dev: Option<Position>,
    /// PATH_DEV_G00 \[as PATH_DEV\].
    pub path_dev_g00: Option<Position>,
    /// TRACK_DEV \[Surface 2°, B-spline 5°\].
    pub track_dev: Option<Position>,
    /// TRACK_DEV_G00 \[as TRACK_DEV\].
    pub track_dev_g00: Option<Position>,
    /// MAX_ANGLE \[160°\].
    pub max_angle: Option<Position>,
    /// CHECK_JERK, 0…2 \[P-CHAN-00110\].
    pub check_jerk: Option<u8>,
    /// AUTO_OFF_G00 \[false\].
    pub auto_off_g00: Option<bool>,
    /// CIR_MODE, 0…2 \[1\].
    pub cir_mode: Option<u8>,
    /// CIR_MIN_ANGLE \[30°\].
    pub cir_min_angle: Option<Position>,
    /// CIR_MIN_RADIUS \[0 mm\].
    pub cir_min_radius: Option<Position>,
    /// MERGE \[false\].
    pub merge: Option<bool>,
    /// LENGTH_LONG_CIR \[2 mm\].
    pub length_long_cir: Option<Position>,
    /// AUTO_OFF_PATH \[false\].
    pub auto_off_path: Option<bool>,
    /// AUTO_OFF_TRACK \[false\].
    pub auto_off_track: Option<bool>,
    /// AUTO_OFF_G60 \[false\].
    pub auto_off_g60: Option<bool>,
    /// MAX_PATH_LENGTH \[0 mm: off\].
    pub max_path_length: Option<Position>,
    /// CONTERROR of OPMODE 1 \[0.1 mm\].
    pub conterror: Option<Position>,
}

impl Hsc {
    /// Whether the command has parameters in addition to its switch.
    pub fn gives_parameters(&self) -> bool {
        *self != Self { switch: self.switch, ..Self::default() }
    }
}

/// `#FILTER`. `switch: Some(false)` switches the filters off.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Filter {
    /// ON or OFF; `None` if the command only gives parameters.
    pub switch: Option<bool>,
    /// HSC: the old form #FILTER ON \[HSC\].
    pub hsc: bool,
    /// ORDER, 0…200.
    pub order: Option<u8>,
    /// ORDER_TIME, µs.
    pub order_time_us: Option<Value>,
    /// SHARE, percent \[100\].
    pub share: Option<Value>,
    /// AX_DEV \[0 mm: not monitored\].
    pub ax_dev: Option<Position>,
    /// FCUT, Hz \[30\].
    pub fcut: Option<Value>,
    /// ACC_FACT, 1…10 \[1\].
    pub acc_fact: Option<Value>,
    /// QUALITY, above 0 to 1 \[1\].
    pub quality: Option<Value>,
}

/// One limit of #VECTOR LIMIT.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Limit {
    /// The channel parameter (P-CHAN-00002, 00090, 00208).
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
    /// RADIAL_ACC.
    pub radial_acc: Option<Limit>,
    /// RADIAL_JERK.
    pub radial_jerk: Option<Limit>,
    /// JERK.
    pub jerk: Option<Limit>,
    /// TRANS_ACC.
    pub trans_acc: Option<Limit>,
    /// FEED: for G01, G02, G03.
    pub feed: bool,
    /// RAPID: for G00.
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
    /// G151, #SPLINE ON, #SET SPLINE ON.
    On,
    /// G150, #SPLINE OFF, #SET SPLINE OFF.
    Off,
    /// #SPLINE TYPE, #SET SPLINETYPE.
    Type(SplineType),
    /// #AKIMA TRANS, #SET ASPLINE MODE.
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
    /// G130: acceleration, feed, per axis.
    Acceleration,
    /// G131: acceleration, feed, all axes.
    AccelerationAll,
    /// G132: ramp time, feed, per axis.
    RampTime,
    /// G133: ramp time, feed, all axes.
    RampTimeAll,
    /// G134: geometric ramp time, all axes.
    GeometricRampTime,
    /// G231: acceleration, rapid, all axes.
    RapidAcceleration,
    /// G232: ramp time, rapid, per axis.
    RapidRampTime,
    /// G233: ramp time, rapid, all axes.
    RapidRampTimeAll,
    /// G338: ramp time, feed, all axes.
    G338,
    /// G339: ramp time, rapid, all axes.
    G339,
}

impl WeightKind {
    /// The kind of a G number.
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

    /// The G word.
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

/// Weights in percent per axis, above 0 to 10 000 (`None`: 100 % by ISG's rule).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weight<const AXES: usize> {
    /// The values that the weights change.
    pub kind: WeightKind,
    /// The weight of each axis in percent.
    pub percent: [Option<Value>; AXES],
}

/// #KIN ID\[n\], #TRAFO ON, #TRAFO OFF, #TRAFO\[n\]. [`Kinematics::Off`] switches the transformation off.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Kinematics {
    /// `#KIN ID`: selects the data set for the next `#TRAFO ON`.
    Select(u16),
    /// #TRAFO ON.
    On,
    /// `#TRAFO\[n\]`: selects a data set and switches the transformation on.
    OnWith(u16),
    /// #TRAFO OFF.
    Off,
}

/// A command for the log of the path ahead: `#CONTOUR LOOKAHEAD [LOG]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ContourLog {
    /// ON: starts the log; with the value of PARAM, if given.
    On(Option<f64>),
    /// OFF: ends the log; with the value of PARAM, if given.
    Off(Option<f64>),
    /// PARAM only: an entry of its own.
    Parameter(f64),
    /// CLEAR: removes all entries of the log.
    Clear,
}

/// The speed of an oscillation, in one of three forms.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum OscillationSpeed {
    /// FEED: speed of the axis, mm/min (the unit depends on P-CHAN-00108).
    Feed(Value),
    /// FREQ: number of oscillations per second, Hz.
    Frequency(Value),
    /// TIME: duration of one oscillation, s.
    Period(Value),
}

/// `X[OSC …]`. Reversal positions are machine coordinates.
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
        /// SHORT.
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
    /// ACC_WEIGHT with G01, RAPID_ACC_WEIGHT with G00, % \[100\].
    pub acceleration: Option<Value>,
    /// M: number of an M function that is output before the motion.
    pub m: Option<u32>,
    /// H: number of an H function that is output before the motion.
    pub h: Option<u32>,
    /// SLOPE_TYPE: the slope of this motion.
    pub slope: Option<SlopeType>,
}

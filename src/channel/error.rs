//! Errors of machine data and of programs, with the messages that a user reads.
use crate::fir::FilterError;
#[cfg(feature = "kinematics")]
use crate::kinematics::SplitError;
use crate::machine::parameter::RangeError;
use crate::machine::{AxisName, Beyond, SYNCHRONISED, Synch};
use crate::nc::{NcError, Place};
#[cfg(feature = "kinematics")]
use crate::plan::SwitchError;
use crate::plan::{MotionError, SplineError};
use crate::quantity::Decimal;
#[cfg(feature = "plc")]
use crate::rt_loop::LoopError;

/// The reason why [`Channel::split`](super::Channel::split) refuses machine data.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum MachineError {
    /// A parameter of an axis is out of range. The number is the index of the axis.
    Axis(usize, RangeError),
    /// A parameter of the channel is out of range.
    Channel(RangeError),
    /// The machine data need a function that this build leaves out. The text names the function and the
    /// feature to enable.
    NotBuilt(&'static str),
    /// Two axes of the machine have this name.
    Name(AxisName),
    /// The axis name begins with a letter that has another meaning in the NC language.
    Reserved(AxisName),
    /// The parameter of this name gives a function a synchronisation that Glidepath does not have. The values
    /// are: name, number of the function, synchronisation.
    Synch(&'static str, u16, Synch),
    /// The parameter of this name gives a synchronisation to more functions than there is room for.
    TooManySynch(&'static str),
    /// The machine data of an axis have a filter that is not possible. The number is the index of the axis.
    Filter(usize, FilterError),
    /// P-CHAN-00650 names a function that does not exist or is not available. The texts are the fault and the
    /// expected value.
    #[cfg(feature = "plc")]
    Interpolator(&'static str, &'static str),
    /// The parameter of this name makes Glidepath output a function before its point of the path, but the
    /// synchronisation of the function does not permit this. The values are: name, number of the function,
    /// synchronisation, and what is expected.
    #[cfg(feature = "plc")]
    Shift(&'static str, u16, Synch, &'static str),
}

impl core::fmt::Display for MachineError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Axis(_, e) | Self::Channel(e) => write!(
                f,
                "{} ({}) = {} is outside {}…{}, bound by {}",
                e.name, e.id, e.value, e.min, e.max, e.because
            ),
            Self::NotBuilt(needs) => f.write_str(needs),
            Self::Name(name) => write!(f, "two axes are called {}", name.as_str()),
            Self::Reserved(name) => write!(
                f,
                "axis {}: {} is an address of the language; expected a name that begins with A, B, C, O, Q, U, V, W, X, Y or Z",
                name.as_str(),
                char::from(name.0[0])
            ),
            Self::Synch(name, code, synch) => {
                write!(f, "{name}[{code}] = {} is known, not available in this version", synch.name())
            }
            Self::TooManySynch(name) => write!(f, "{name}: more than {SYNCHRONISED} functions"),
            Self::Filter(_, error) => error.fmt(f),
            #[cfg(feature = "plc")]
            Self::Interpolator(said, expected) => {
                write!(f, "configuration.interpolator.function (P-CHAN-00650): {said}; expected {expected}")
            }
            #[cfg(feature = "plc")]
            Self::Shift(name, code, synch, expected) => {
                write!(f, "{name}[{code}] = {}: expected {expected}", synch.name())
            }
        }
    }
}

impl core::error::Error for MachineError {}

/// The reason why [`Planner::poll`](super::Planner::poll) refuses a line of the program, or ends the program.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Error {
    /// The text of the line is not correct in the language.
    Nc(NcError),
    /// The word is correct in the language, but Glidepath does not have this function. The values are the
    /// place and the name of the word.
    NotAvailable(Place, &'static str),
    /// The machine data do not enable this function. The values are the place of the word, and the parameter
    /// that the function needs.
    NotEnabled(Place, &'static str),
    /// The motion of a line is not possible; [`MotionError`] gives the reason.
    Motion(Place, MotionError),
    /// A motion block, or the curve of the corner before the block, leads this axis beyond its software
    /// limit.
    SoftwareLimit(Place, AxisName, Beyond),
    /// The active transformation cannot convert the path of a motion block. The name is that of the axis that
    /// causes the error, if it is one axis.
    #[cfg(feature = "kinematics")]
    NoTransformation(Place, AxisName, SplitError),
    /// `#KIN ID` or `#TRAFO` cannot change the transformation here.
    #[cfg(feature = "kinematics")]
    Transformation(Place, SwitchError),
    /// The filter that `#FILTER` selects for this axis is not possible.
    Filter(Place, AxisName, FilterError),
    /// A spline command, or a command within a spline, is not permitted here.
    Spline(Place, SplineError),
    /// A command of a real-time loop is not permitted here, or the loop has no room in memory.
    #[cfg(feature = "plc")]
    Loop(Place, LoopError),
    /// ACC or DEC of #VECTOR LIMIT is below 1 mm/s², or VEL is 0.
    PathAcceleration(Place),
    /// A block takes more than 2^27 ticks at reduced speed (P-AXIS-00214).
    ReducedTooSlow,
    /// A defect of the planner: the plan of a block failed its check.
    Unplannable,
}

impl Error {
    /// Line and column of the refused word. Line 0 if no word belongs to the error.
    pub fn place(&self) -> Place {
        match self {
            Self::Nc(e) => e.place,
            Self::NotAvailable(place, _)
            | Self::NotEnabled(place, _)
            | Self::Motion(place, _)
            | Self::SoftwareLimit(place, ..)
            | Self::Filter(place, ..)
            | Self::Spline(place, _)
            | Self::PathAcceleration(place) => *place,
            #[cfg(feature = "kinematics")]
            Self::NoTransformation(place, ..) | Self::Transformation(place, _) => *place,
            #[cfg(feature = "plc")]
            Self::Loop(place, _) => *place,
            Self::ReducedTooSlow | Self::Unplannable => Place::default(),
        }
    }
}

impl Error {
    /// ISG's number of this message; 0 if no number is known.
    pub const fn id(&self) -> u32 {
        match self {
            Self::Nc(error) => error.kind.id(),
            Self::Motion(_, MotionError::ArcInSpline) => 120_254,
            Self::Spline(_, SplineError::InSpline) => 120_255,
            Self::Spline(_, SplineError::InHsc) => 120_370,
            #[cfg(feature = "kinematics")]
            Self::Transformation(_, SwitchError::Active(_)) => 20_687,
            #[cfg(feature = "plc")]
            Self::Loop(_, error) => error.id(),
            _ => 0,
        }
    }
}

impl core::fmt::Display for Error {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Nc(e) => e.fmt(f),
            Self::NotAvailable(_, name) => write!(f, "{name} is known, not available in this version"),
            Self::NotEnabled(_, needs) => f.write_str(needs),
            Self::Motion(_, MotionError::Path(e)) => e.fmt(f),
            Self::Motion(_, MotionError::NoFeed) => f.write_str("the feed is 0; expected F above 0"),
            Self::Motion(_, MotionError::Released) => {
                f.write_str("an axis that moves here was released by #PUT AX; fetch it with #CALL AX")
            }
            Self::Motion(_, MotionError::ArcInSpline) => {
                f.write_str("an arc while a B-spline is on; expected G00, G01, or G150 before it")
            }
            Self::Spline(_, error) => spline(f, error),
            #[cfg(feature = "plc")]
            Self::Loop(_, error) => error.fmt(f),
            Self::Motion(_, MotionError::Beyond(beyond)) => software_limit(f, "the axis", beyond),
            Self::SoftwareLimit(_, axis, beyond) => {
                f.write_str("axis ")?;
                software_limit(f, axis.as_str(), beyond)
            }
            #[cfg(feature = "kinematics")]
            Self::Motion(_, MotionError::Split(error)) => error.fmt(f),
            #[cfg(feature = "kinematics")]
            Self::NoTransformation(_, axis, error) => error.tell(f, axis.as_str()),
            #[cfg(feature = "kinematics")]
            Self::Transformation(_, error) => error.fmt(f),
            Self::Filter(_, axis, error) => {
                if error.axis().is_some() {
                    write!(f, "axis {}: ", axis.as_str())?;
                }
                error.fmt(f)
            }
            Self::Motion(_, MotionError::TooSlow) => f.write_str(
                "at this feed the block takes more than 67 108 864 ticks; raise F or split the block",
            ),
            Self::PathAcceleration(_) => f.write_str(
                "limit along the path too low; expected ACC and DEC of 1 mm/s² (3600 mm/min²) at least, VEL above 0",
            ),
            Self::Motion(_, MotionError::StrokeTooSlow) => f.write_str(
                "at this speed a motion of the axis takes longer than can be planned; raise FEED or FREQ, or shorten TIME",
            ),
            Self::ReducedTooSlow => f.write_str(
                "at the reduced speed a block takes more than 134 217 728 ticks; raise vb_max_red (P-AXIS-00214) or the override",
            ),
            Self::Unplannable => {
                f.write_str("internal: the plan of a block broke a limit and is not executed")
            }
        }
    }
}

/// The text about a refused spline command.
fn spline(f: &mut core::fmt::Formatter<'_>, error: &SplineError) -> core::fmt::Result {
    match error {
        SplineError::TooFewPoints { points, needed } => {
            write!(f, "the spline has {points} points; expected at least {needed} before it is switched off")
        }
        SplineError::InSpline => {
            f.write_str("contour mode or #HSC together with a spline; expected G150, or G260, before it")
        }
        SplineError::InHsc => f.write_str("G150 or G151 while #HSC is on; expected #HSC OFF before it"),
        SplineError::FeedAxes => {
            f.write_str("a spline needs at most three feed axes (P-CHAN-00011, default_feed_axis)")
        }
    }
}

/// The last shown decimal of a position, 10^-6, in units of 2^-32, rounded up.
const SIXTH_DECIMAL: u64 = 4295;

/// Writes the position that an axis would reach, and its limit.
fn software_limit(f: &mut core::fmt::Formatter<'_>, axis: &str, beyond: &Beyond) -> core::fmt::Result {
    let (sign, id) = if beyond.is_positive() { ("positive", 178) } else { ("negative", 177) };
    // Enough decimals to show the difference.
    let decimals = if beyond.position.abs_diff(beyond.limit) <= SIXTH_DECIMAL { 10 } else { 6 };
    let [position, limit] = [beyond.position, beyond.limit].map(|bits| Decimal { bits, decimals });
    write!(
        f,
        "{axis} would come to {position}, its {sign} software limit is {limit} (P-AXIS-00{id}, machine coordinates)"
    )
}

impl core::error::Error for Error {}

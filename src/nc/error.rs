//! Errors and warnings of the decoder, with their messages.
use super::Place;
use crate::machine::functions::Function;
use core::fmt;
use heapless::String;

/// A refused line: the word, its place and the expected text. The decoder stops at this line until
/// [`super::Decoder::go_on`] continues after it.
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct NcError {
    /// Place of the refused word in the program text.
    pub place: Place,
    /// Why the word is refused, and what was expected.
    pub kind: NcErrorKind,
    /// The word itself, cut to 24 bytes.
    pub found: String<24, u8>,
    /// Names of the machine's axes, `X, Y, Z`, if they explain the error.
    pub axes: String<24, u8>,
}

/// Why a word of the program is refused. Numbers in the descriptions are those of ISG's messages.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum NcErrorKind {
    /// The source of the program text failed.
    Unreadable,
    /// A jump back, a call or a line needs text that the window of a stream no longer holds.
    BehindWindow,
    /// The text contains a control byte, for example NUL.
    ControlByte(u8),
    /// The text contains a byte above 127 outside of a comment.
    ForeignByte(u8),
    /// The logical line is longer than [`super::LINE_BYTES`].
    LineTooLong,
    /// The logical line has more than [`super::CONTINUATIONS`] continuation lines and long gaps.
    TooManyContinuations,
    /// The syntax is wrong. The text says what was expected.
    Expected(&'static str),
    /// Glidepath does not have this part of the language. The text is its name.
    NotAvailable(&'static str),
    /// The word needs a function that this build leaves out. The text names the function and the feature to
    /// enable.
    NotBuilt(&'static str),
    /// The word is a usual axis name, but the machine has no such axis.
    AxisNotHere,
    /// The letter is not an address of the language.
    UnknownWord,
    /// The language has no such G number.
    UnknownG,
    /// The language has no such `#` command.
    UnknownHash,
    /// The language has no such `$` statement.
    UnknownDollar,
    /// The command has no such keyword.
    UnknownKeyword {
        /// Name of the command.
        command: &'static str,
        /// Its keywords.
        keywords: &'static [&'static str],
    },
    /// The keyword does not fit the method or switch of the same command.
    KeywordMismatch {
        /// The method or switch.
        with: &'static str,
    },
    /// The language has no function with this name.
    UnknownFunction,
    /// The number is outside of its range.
    Range {
        /// Name of the quantity.
        what: &'static str,
        /// Least value.
        min: i32,
        /// Largest value.
        max: u32,
        /// Unit.
        unit: &'static str,
        /// Whether the least value itself is refused.
        above: bool,
    },
    /// The number has decimals, but a whole number is expected. The text names the word.
    NotWhole(&'static str),
    /// 20013: the block has the same word twice. The text names the word.
    Twice(&'static str),
    /// The block has two words that exclude each other. The text names the other word.
    Conflict(&'static str),
    /// G01, G02 or G03 needs a feed, and no F was programmed so far.
    NoFeed,
    /// 20003: the block has G60 and no motion.
    ExactStopAlone,
    /// The arc has neither I, J, K nor R.
    ArcUndefined,
    /// 21024: the arc has R in addition to I, J or K.
    ArcTwice,
    /// 20034: a full circle cannot be given by R.
    FullCircleByRadius,
    /// I, J or K is the word of an axis that is not in the plane of the arc.
    OutsidePlane,
    /// The block has I, J, K or R, but no arc (G02, G03).
    ArcWordAlone,
    /// The command needs a main axis that the machine does not have.
    NoMainAxis,
    /// An expression divides by zero.
    DivisionByZero,
    /// The argument of a function is outside of its domain. The text names the function.
    Domain(&'static str),
    /// The result of an expression is too large.
    Overflow,
    /// The expression is nested deeper than [`super::EXPRESSION_DEPTH`].
    ExpressionTooDeep,
    /// 20400: the index of a P parameter is not above 0.
    ParameterIndex,
    /// The program reads the parameter with this index before it has a value.
    ParameterUnset(u32),
    /// The program uses more parameters than [`super::PARAMETERS`].
    TooManyParameters,
    /// 20227: the counter of `$FOR` is not a parameter.
    ForCounter,
    /// A closing word has no opening word (20232 for $ENDFOR).
    Unopened {
        /// The missing opening word.
        opening: &'static str,
    },
    /// An opening word has no closing word. The place is that of the opening word.
    Unclosed {
        /// The missing closing word.
        closing: &'static str,
    },
    /// Control blocks are nested deeper than [`super::NESTING`].
    NestingTooDeep,
    /// Subroutine calls are nested deeper than [`super::CALL_DEPTH`].
    CallTooDeep,
    /// `$BREAK` or `$CONTINUE` is outside of a loop.
    NoLoop,
    /// The program has carried out more than [`super::QUIET_LINES`] lines without a command: an endless loop.
    Endless,
    /// The number has an exponent, as in `1e10`.
    Exponent,
    /// The label of `$GOTO` is not in this program.
    NoLabel,
    /// The text has no main program, only local subroutines.
    NoMainProgram,
    /// The call LL has a name that no %L of this file or of its callers declares.
    NoSubroutine,
    /// The call L has a name for which the text source has no file.
    NoFile,
    /// Two subroutines have the same name.
    SubroutineTwice,
    /// The text has more local subroutines than [`super::SUBROUTINES`].
    TooManySubroutines,
    /// The name is longer than 83 characters.
    NameTooLong,
    /// The block has other words beside a word that must stand alone. The text names this word.
    NotAlone(&'static str),
    /// The block has more M and H words, or more G words, than a block holds.
    BlockTooFull,
    /// 50593: the oscillation has neither FEED, FREQ nor TIME.
    OscillationSpeed,
    /// 22277: a position of a modulo axis is outside of 0 to 360°.
    OscillationModulo,
    /// 50603: words of an independent axis contradict each other. The text says which words fit.
    Independent(&'static str),
    /// The block lacks a word. The text names the word.
    Missing(&'static str),
    /// A numbered line ends with `*nn`, a checksum of serial transmission.
    Checksum,
    /// The program reads a V. variable that has no value yet.
    #[cfg(feature = "plc")]
    VariableUnset,
    /// Neither the language nor the application defines this V. variable.
    #[cfg(feature = "plc")]
    NoVariable,
    /// The program writes a V. variable that it may only read.
    #[cfg(feature = "plc")]
    VariableReadOnly,
    /// The value or use of `V.G.M_FCT` or `V.G.H_FCT` is not possible. The text says what is expected.
    #[cfg(feature = "plc")]
    SynchVariable(&'static str),
    /// 22073: the command is not permitted in a real-time loop.
    #[cfg(feature = "plc")]
    InLoop,
    /// The dialect has this word and Glidepath does not. The texts name the word and an alternative.
    #[cfg(feature = "grbl")]
    Known {
        /// The word.
        what: &'static str,
        /// The alternative.
        hint: &'static str,
    },
    /// This dialect has no such G or M word. The text is the name of the dialect.
    #[cfg(feature = "grbl")]
    UnknownCode(&'static str),
    /// The program reads a named parameter that has no value.
    #[cfg(feature = "grbl")]
    NameUnset,
    /// `(ABORT, …)` was reached. The text is that of the comment.
    #[cfg(feature = "grbl")]
    Aborted,
    /// The text does not have the subroutine that a call (O word or M98) names.
    #[cfg(feature = "grbl")]
    NoProgram,
    /// The block has a value that no word of the block uses.
    #[cfg(feature = "grbl")]
    Unused,
    /// The tool has no length in the machine data.
    #[cfg(feature = "grbl")]
    NoTool,
}

impl NcErrorKind {
    /// ISG's number of this message; 0 if no number is known.
    pub const fn id(&self) -> u32 {
        match self {
            Self::Twice(_) => 20013,
            Self::ExactStopAlone => 20003,
            Self::FullCircleByRadius => 20034,
            Self::ArcTwice => 21024,
            Self::ForCounter => 20227,
            Self::Unopened { opening } if matches!(opening.as_bytes(), b"$FOR") => 20232,
            Self::Unopened { opening } if matches!(opening.as_bytes(), b"$SWITCH") => 20225,
            Self::ParameterIndex => 20400,
            Self::OscillationSpeed => 50593,
            Self::OscillationModulo => 22277,
            Self::Independent(_) => 50603,
            #[cfg(feature = "plc")]
            Self::InLoop => 22073,
            Self::UnknownKeyword { command, .. } if matches!(command.as_bytes(), b"INDP") => 50603,
            _ => 0,
        }
    }
}

impl fmt::Display for NcError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        use NcErrorKind as K;
        let found = self.found.as_str();
        match self.kind {
            K::Unreadable => write!(f, "the program text could not be read"),
            K::BehindWindow => write!(
                f,
                "\"{found}\" needs text behind the window of the stream: expected loops, calls and lines within half of it"
            ),
            K::ControlByte(byte) => write!(f, "byte {byte:#04x} in the program: expected text"),
            K::ForeignByte(byte) => {
                write!(f, "byte {byte:#04x} outside of a comment: expected ASCII text")
            }
            K::LineTooLong => {
                write!(f, "line too long: expected at most {} bytes", super::LINE_BYTES)
            }
            K::TooManyContinuations => {
                write!(f, "too many continuation lines: expected at most {}", super::CONTINUATIONS)
            }
            K::Expected(what) if found.is_empty() => write!(f, "end of line: expected {what}"),
            K::Expected(what) => write!(f, "unexpected \"{found}\": expected {what}"),
            K::NotAvailable(what) => {
                write!(f, "{what} \"{found}\" is known, not available in this version")
            }
            K::NotBuilt(needs) => f.write_str(needs),
            #[cfg(feature = "plc")]
            K::VariableUnset => {
                write!(f, "variable {found} has no value yet: expected an assignment before it")
            }
            #[cfg(feature = "plc")]
            K::NoVariable => write!(
                f,
                "no variable {found}: expected V.E. and a name of the application (up to 8 in a line), V.P., V.L., V.RTG.LOOP.ENABLED, V.G.BLOCK_NR, V.G.FEEDRATE or V.G.M_FCT[n].SYNCH"
            ),
            #[cfg(feature = "plc")]
            K::VariableReadOnly => {
                write!(f, "variable {found} is read only: expected one that a program may write")
            }
            #[cfg(feature = "plc")]
            K::SynchVariable(expected) => write!(f, "{found}: expected {expected}"),
            #[cfg(feature = "plc")]
            K::InLoop => write!(
                f,
                "\"{found}\" in a real-time loop: expected G00 to G03, #SPLINE ON or OFF, #CONTOUR LOOKAHEAD LOG ON, OFF or [PARAM=…]"
            ),
            K::AxisNotHere => {
                write!(f, "axis {found} is known, not available on this machine (axes {})", self.axes)
            }
            K::UnknownWord => {
                write!(f, "unknown word \"{found}\": expected an address or an axis ({})", self.axes)
            }
            K::UnknownG => write!(f, "unknown G word \"{found}\": expected a G word of the language"),
            K::UnknownHash => write!(f, "unknown command \"{found}\": expected a # command of the language"),
            K::UnknownDollar => {
                write!(f, "unknown statement \"{found}\": expected a $ statement of the language")
            }
            K::UnknownKeyword { command, keywords } => {
                write!(f, "unknown keyword \"{found}\" in {command}: expected ")?;
                for (i, keyword) in keywords.iter().enumerate() {
                    f.write_str(if i > 0 { ", " } else { "" })?;
                    f.write_str(keyword)?;
                }
                Ok(())
            }
            K::KeywordMismatch { with } => write!(f, "keyword \"{found}\" does not go with {with}"),
            K::UnknownFunction => write!(f, "unknown function \"{found}\": expected SIN, COS, TAN, SQRT …"),
            K::Range { what, min, max, unit, above } => {
                let from = if above { "above " } else { "" };
                write!(f, "{what} out of range, \"{found}\": expected {from}{min} to {max}")?;
                if unit.is_empty() { Ok(()) } else { write!(f, " {unit}") }
            }
            K::NotWhole(what) => write!(f, "\"{found}\" has a fraction: expected a whole number for {what}"),
            K::Twice(what) => write!(f, "\"{found}\": {what} given twice in this block"),
            K::Conflict(with) => write!(f, "\"{found}\" cannot stand in one block with {with}"),
            K::NoFeed => write!(f, "motion without feed: expected F before G01, G02 or G03"),
            K::ExactStopAlone => write!(f, "G60 without motion: expected axis positions in its block"),
            K::ArcUndefined => write!(f, "arc without centre or radius: expected I, J, K or R"),
            K::ArcTwice => write!(f, "arc by centre and radius: expected either I, J, K or R"),
            K::FullCircleByRadius => write!(f, "full circle by radius: expected I, J, K"),
            K::OutsidePlane => {
                write!(f, "\"{found}\" is outside of the plane: expected the plane's I, J, K")
            }
            K::ArcWordAlone => write!(f, "\"{found}\" without arc: expected G02 or G03"),
            K::NoMainAxis => {
                write!(f, "\"{found}\" needs a main axis this machine lacks (axes {})", self.axes)
            }
            K::DivisionByZero => write!(f, "division by zero in \"{found}\""),
            K::Domain(function) => write!(f, "argument outside the domain of {function} in \"{found}\""),
            K::Overflow => write!(f, "result too large in \"{found}\""),
            K::ExpressionTooDeep => {
                write!(f, "expression too deep: expected at most {} open terms", super::EXPRESSION_DEPTH)
            }
            K::ParameterIndex => write!(f, "parameter index in \"{found}\": expected a whole number above 0"),
            K::ParameterUnset(index) => write!(f, "parameter P{index} has no value yet"),
            K::TooManyParameters => {
                write!(f, "too many parameters: expected at most {}", super::PARAMETERS)
            }
            K::ForCounter => write!(f, "counter \"{found}\" of $FOR: expected a P parameter"),
            K::Unopened { opening } => write!(f, "\"{found}\" without {opening}"),
            K::Unclosed { closing } => write!(f, "\"{found}\" without {closing}"),
            K::NestingTooDeep => write!(f, "control blocks too deep: expected at most {}", super::NESTING),
            K::CallTooDeep => write!(f, "subroutine calls too deep: expected at most {}", super::CALL_DEPTH),
            K::NoLoop => write!(f, "\"{found}\" outside of a loop"),
            K::Endless => write!(
                f,
                "no motion and no other command in {} lines at \"{found}\": expected a loop with an end",
                super::QUIET_LINES
            ),
            K::Exponent => write!(
                f,
                "\"{found}\" has an exponent: expected digits and a point, or a blank before end feed E"
            ),
            K::NoLabel => write!(f, "label \"{found}\" is not in this program"),
            K::NoMainProgram => write!(f, "no main program: expected a head % without L"),
            #[cfg(feature = "grbl")]
            K::NoProgram => write!(
                f,
                "no subprogram for \"{found}\": expected it before its call, or behind the main program for M98"
            ),
            K::NoSubroutine => write!(
                f,
                "subroutine \"{found}\" does not stand before the main program: expected %L {found} there"
            ),
            K::NoFile => write!(f, "no file \"{found}\" to call: expected the name of a program file"),
            K::SubroutineTwice => write!(f, "subroutine \"{found}\" is declared twice"),
            K::TooManySubroutines => {
                write!(f, "too many local subroutines: expected at most {}", super::SUBROUTINES)
            }
            K::NameTooLong => write!(f, "name too long: expected at most 83 characters"),
            K::NotAlone(what) => write!(f, "unexpected \"{found}\": expected {what} alone in its block"),
            K::BlockTooFull => {
                write!(f, "too many words in a block: expected at most {}", super::BLOCK_WORDS)
            }
            K::OscillationSpeed => write!(f, "oscillation speed not defined: expected FEED, FREQ or TIME"),
            K::OscillationModulo => write!(f, "position \"{found}\" of a modulo axis: expected 0 to 360 deg"),
            K::Independent(rule) => write!(f, "inadmissible \"{found}\": expected that {rule}"),
            K::Checksum => write!(
                f,
                "\"{found}\" at the end of a numbered line is a checksum: expected a line without one, or brackets around arithmetic"
            ),
            K::Missing(what) => write!(f, "missing in \"{found}\": expected {what}"),
            #[cfg(feature = "grbl")]
            K::Known { what, hint } => {
                write!(f, "{what} \"{found}\" is known, not available in this version; expected {hint}")
            }
            #[cfg(feature = "grbl")]
            K::NameUnset => write!(f, "parameter {found} has no value: expected an assignment before"),
            #[cfg(feature = "grbl")]
            K::UnknownCode(dialect) => write!(
                f,
                "unknown word \"{found}\": expected a word of the dialect {dialect} (`glidepath words {dialect}`)"
            ),
            #[cfg(feature = "grbl")]
            K::Aborted => {
                write!(
                    f,
                    "the program ends itself with ABORT, \"{}\"; expected a run without it",
                    found.trim()
                )
            }
            #[cfg(feature = "grbl")]
            K::Unused if found.starts_with(['E', 'e']) => {
                write!(
                    f,
                    "no word of this block uses \"{found}\": expected no E: no exponent of a number, no extruder"
                )
            }
            #[cfg(feature = "grbl")]
            K::Unused => write!(f, "no word of this block uses \"{found}\": expected a word that does"),
            #[cfg(feature = "grbl")]
            K::NoTool => write!(f, "\"{found}\" has no length: expected it in the machine data, tool_length"),
        }
    }
}

impl core::error::Error for NcError {}

/// A warning about a word of the program. The program continues.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct NcWarning {
    /// Place of the word in the program text.
    pub place: Place,
    /// What the warning is about.
    pub kind: NcWarningKind,
}

/// What a warning is about. Numbers in the descriptions are those of ISG's messages.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum NcWarningKind {
    /// 20685: a G04 block has an axis in addition to the time; the axis is ignored.
    DwellExtraAxis,
    /// $FOR with step 0 never ends.
    EndlessFor,
    /// M02 or M30 in a subroutine: it ends the whole program.
    EndInSubroutine,
    /// A comment without `)`: it ends at the end of the line.
    UnclosedComment,
    /// An arc switches `#CONTOUR MODE [PTP]` off.
    PtpArc,
    /// DIST_SOFT at a corner with an arc: only the distance determines the curve.
    SoftArc,
    /// DIST_MASTER at a corner where the master axis changes direction: only the distance determines the
    /// curve.
    MasterRests,
    /// DIST_SOFT, DIST_MASTER or PTP with the slope STEP, which has no ramp time: only the tolerance
    /// determines the curves.
    StepIsNotOptimised,
    /// A dwell at a corner that is to be rounded: the corner stays sharp, and the axes dwell there.
    DwellAtCorner,
    /// 120542: parameters of #HSC while #HSC is on; they have no effect.
    HscIsOn,
    /// #FILTER ON, and no axis has an order (ORDER, ORDER_TIME, P-AXIS-00587, P-AXIS-00591): nothing is
    /// filtered.
    FilterWithoutOrder,
    /// A spline has to begin tangentially, but no motion block since the choice of its type gives a
    /// direction.
    NoTangent,
    /// A turn that #HSC \[SURFACE\] does not round, although MAX_ANGLE permits it. The turn is straight back,
    /// or more than 102 degrees at an arc.
    SurfaceSharp,
    /// #HSC \[SURFACE\] found no curve inside its tolerance, at a block before the named one.
    SurfaceLost,
    /// The dynamics of an axis limit its oscillation.
    OscillationLimited,
    /// The programmed time of an axis motion is too short for the limits of the axis.
    MotionLimited,
    /// Arithmetic after an address, without brackets. The value is the result in thousandths.
    Computed(i32),
    /// R in a block without an arc: R stays in force for the arcs that follow.
    RadiusAlone,
    /// M17 or M29 in the main program: it ends the program.
    MainEnds,
    /// A program head follows words that have no head: the program of those words ends there.
    HeadEnds,
    /// SHORT of a linear axis has no effect.
    ShortLinear,
    /// The first motion comes before any F, G00 and G01: it is rapid motion.
    RapidWithoutFeed,
    /// G64 without P. The value is the permitted distance from the path, µm.
    #[cfg(feature = "grbl")]
    BlendTolerance(u32),
    /// Q of G64 has no effect: Glidepath merges no lines.
    #[cfg(feature = "grbl")]
    NoMerging,
    /// M49 to M53 and M56 have no effect: the operator's overrides stay enabled.
    #[cfg(feature = "grbl")]
    OverridesStay,
    /// A block after `/` in a program of Grbl: it is carried out.
    #[cfg(feature = "grbl")]
    BlockSkip,
    /// G4 with more than a minute: the value may be meant in milliseconds.
    #[cfg(feature = "grbl")]
    LongDwell,
    /// F in the block of a G20 or G21 that changes the unit: F counts in the unit from before the change.
    #[cfg(feature = "grbl")]
    FeedBeforeUnit,
    /// The program of LinuxCNC ends without M2, M30 or %: modal state stays in force.
    #[cfg(feature = "grbl")]
    NoProgramEnd,
    /// A comment that LinuxCNC carries out has no effect.
    #[cfg(feature = "grbl")]
    ActiveComment,
    /// G43 on a machine without tool lengths: the length is 0.
    #[cfg(feature = "grbl")]
    NoToolTable,
    /// A number without a decimal point in a program of Fanuc: it counts 0.001 mm, 0.001° or 0.0001 inch.
    #[cfg(feature = "grbl")]
    LeastIncrement,
    /// G95: the feed is F times the programmed spindle speed, whatever the spindle does.
    #[cfg(feature = "grbl")]
    FeedOfSpindle,
    /// G96: the spindle speed changes at the start of each block, and is constant inside the block.
    #[cfg(feature = "grbl")]
    SpeedByBlock,
    /// A mode of the controller has no effect in Glidepath.
    #[cfg(feature = "grbl")]
    ModeWithoutEffect,
    /// A command to Grbl that reports or unlocks has no effect.
    #[cfg(feature = "grbl")]
    Report,
    /// P or Q of M100 to M199: the machine only gets the number of the function.
    #[cfg(feature = "grbl")]
    NoArguments,
}

impl NcWarningKind {
    /// Whether the planner gives the warning when it takes a motion or a dwell. All other warnings come from
    /// the decoder.
    pub const fn is_of_curve(&self) -> bool {
        matches!(
            self,
            Self::PtpArc
                | Self::SoftArc
                | Self::MasterRests
                | Self::StepIsNotOptimised
                | Self::DwellAtCorner
                | Self::HscIsOn
                | Self::FilterWithoutOrder
                | Self::NoTangent
                | Self::SurfaceSharp
                | Self::SurfaceLost
                | Self::OscillationLimited
                | Self::MotionLimited
        )
    }
}

impl NcWarning {
    /// ISG's number of this message; 0 if no number is known. Messages that ISG describes without a number
    /// have numbers of this project, from 900001. Their reaction class is 1: the program continues.
    pub const fn id(&self) -> u32 {
        match self.kind {
            NcWarningKind::DwellExtraAxis => 20685,
            NcWarningKind::HscIsOn => 120_542,
            NcWarningKind::OscillationLimited => 900_001,
            NcWarningKind::MotionLimited => 900_002,
            NcWarningKind::SurfaceSharp => 900_003,
            NcWarningKind::SurfaceLost => 900_004,
            _ => 0,
        }
    }
}

impl fmt::Display for NcWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self.kind {
            NcWarningKind::Computed(thousandths) => {
                let (sign, size) = (if thousandths < 0 { "-" } else { "" }, thousandths.unsigned_abs());
                let (whole, rest) = (size / 1000, size % 1000);
                return write!(
                    f,
                    "arithmetic between plain numbers: the value is {sign}{whole}.{rest:03}; expected brackets around it, or a word less"
                );
            }
            NcWarningKind::RadiusAlone => "R without an arc does nothing here: it stays in force for G02 and G03",
            NcWarningKind::MainEnds => "M17 or M29 ends the main program; expected M02 or M30 at its end",
            NcWarningKind::HeadEnds => {
                "a program head ends the program of the words before it; expected % before the first word"
            }
            NcWarningKind::RapidWithoutFeed => "motion before F, G00 and G01 is rapid motion; expected one of them",
            NcWarningKind::ShortLinear => "SHORT of a linear axis does nothing; expected a modulo axis",
            NcWarningKind::DwellExtraAxis => "G04 takes one time: the other axis is ignored",
            NcWarningKind::EndlessFor => "$FOR with step 0 never ends",
            NcWarningKind::UnclosedComment => "comment without ): it ends with its line",
            NcWarningKind::PtpArc => "an arc deselects #CONTOUR MODE [PTP]",
            NcWarningKind::SoftArc => {
                "DIST_SOFT beside an arc: the curve keeps the corner distance, axes are not optimised"
            }
            NcWarningKind::MasterRests => {
                "DIST_MASTER where the master axis rests or turns back: the curve keeps the corner distance, axes are not optimised"
            }
            NcWarningKind::StepIsNotOptimised => {
                "DIST_SOFT, DIST_MASTER and PTP need ramp times: with the slope STEP the curves keep their tolerance, axes are not optimised"
            }
            NcWarningKind::DwellAtCorner => {
                "G04 between rounded blocks: the motion stands still in the programmed corner, which gets no curve"
            }
            NcWarningKind::HscIsOn => "#HSC is on: its parameters stay as they are; switch it off first",
            NcWarningKind::FilterWithoutOrder => {
                "#FILTER ON and no axis has an order (ORDER, ORDER_TIME or filter_fir.order, P-AXIS-00587): nothing is filtered"
            }
            NcWarningKind::NoTangent => {
                "no motion block since the type of the spline was chosen: it begins with an automatic direction"
            }
            NcWarningKind::SurfaceSharp => {
                "a turn straight back, or of more than 102 degrees beside an arc: #HSC [SURFACE] does not round it, the motion stands still there"
            }
            NcWarningKind::SurfaceLost => {
                "#HSC [SURFACE] found no curve inside its tolerance for a block before this one: the motion stands still in its corners"
            }
            NcWarningKind::OscillationLimited => {
                "the dynamics of the axis limit the oscillation: it is slower than programmed"
            }
            NcWarningKind::MotionLimited => {
                "the dynamics of the axis do not allow this TIME: the motion takes longer"
            }
            #[cfg(feature = "grbl")]
            NcWarningKind::BlendTolerance(um) => {
                return write!(
                    f,
                    "G64 without P: corners are rounded by {} mm at most (blend_tolerance); expected P for another value",
                    f64::from(um) / 1000.0
                );
            }
            #[cfg(feature = "grbl")]
            NcWarningKind::OverridesStay => "M49 to M53 and M56 change nothing here: overrides stay on",
            #[cfg(feature = "grbl")]
            NcWarningKind::NoMerging => "Q of G64 merges no lines here: the motion is nearer to the path",
            #[cfg(feature = "grbl")]
            NcWarningKind::BlockSkip => "Grbl carries out a block with / before it, and so does this version",
            #[cfg(feature = "grbl")]
            NcWarningKind::LongDwell => "a dwell of more than a minute: P of G4 is in seconds, not milliseconds",
            #[cfg(feature = "grbl")]
            NcWarningKind::FeedBeforeUnit => {
                "F beside a change of the unit: LinuxCNC takes F in the unit before; expected F in the next block"
            }
            #[cfg(feature = "grbl")]
            NcWarningKind::NoProgramEnd => "the text ends without M2, M30 or %: what is in force stays",
            #[cfg(feature = "grbl")]
            NcWarningKind::ActiveComment => "this comment is carried out by LinuxCNC, not by this version",
            #[cfg(feature = "grbl")]
            NcWarningKind::NoToolTable => {
                "the machine data have no tool lengths: the length is 0; expected tool_length in the machine data"
            }
            #[cfg(feature = "grbl")]
            NcWarningKind::LeastIncrement => {
                "numbers without a decimal point count 0.001 mm or degrees, or 0.0001 inch; expected a point behind millimetres and inches"
            }
            #[cfg(feature = "grbl")]
            NcWarningKind::FeedOfSpindle => "G95: the feed is F times the programmed S, whatever the spindle does",
            #[cfg(feature = "grbl")]
            NcWarningKind::SpeedByBlock => "G96: the spindle speed is put out at the start of each block, and stays inside of it",
            #[cfg(feature = "grbl")]
            NcWarningKind::ModeWithoutEffect => "this mode of the controller has no effect here: the path is the programmed one",
            #[cfg(feature = "grbl")]
            NcWarningKind::Report => "a command to Grbl that moves nothing: it has no effect here",
            #[cfg(feature = "grbl")]
            NcWarningKind::NoArguments => "P and Q are not handed on: the machine gets the function's number alone",
            NcWarningKind::EndInSubroutine => "program end inside a subroutine ends the whole program",
        })
    }
}

impl core::error::Error for NcWarning {}

/// A part of the logical line: first byte and length.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Span {
    pub at: u16,
    pub len: u16,
}

/// A refusal of a part of the current line. The decoder adds place and text.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Fault {
    pub span: Span,
    pub kind: NcErrorKind,
}

impl Span {
    /// A fault with this span.
    pub fn fault<V>(self, kind: NcErrorKind) -> Result<V, Fault> {
        Err(Fault { span: self, kind })
    }

    /// Checks that a function is compiled in, for the word at this place.
    #[inline(always)]
    pub const fn needs(self, function: Function) -> Result<(), Fault> {
        match function.check() {
            Ok(()) => Ok(()),
            Err(needs) => Err(Fault { span: self, kind: NcErrorKind::NotBuilt(needs) }),
        }
    }
}

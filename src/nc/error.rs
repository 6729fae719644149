//! Errors and warnings of the decoder.
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
    /// A jump back, a call, or a line that needs text which the window of a stream no longer holds.
    BehindWindow,
    /// The text contains a control byte, for example NUL.
    ControlByte(u8),
    /// The text contains a byte above 127 outside of a comment.
    ForeignByte(u8),
    /// The logical line is longer than [`super::LINE_BYTES`].
    LineTooLong,
    /// The logical line has more continuation lines than the decoder can keep places for.
    TooManyContinuations,
    /// The syntax is wrong. The text says what was expected.
    Expected(&'static str),
    /// Glidepath does not have this part of the language. The text is its name.
    NotAvailable(&'static str),
    /// A function that this build leaves out. The text names the function and the feature to enable.
    NotBuilt(&'static str),
    /// The word is a usual axis name, but the machine has no such axis.
    AxisNotHere,
    /// The letter is not an address of the language.
    UnknownWord,
    /// The language has no such G number.
    UnknownG,
    /// M, H, T, D or S number.
    UnknownHash,
    /// The language has no such `$` statement.
    UnknownDollar,
    /// The command has no such keyword.
    UnknownKeyword {
        /// Command.
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
        /// Quantity.
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
    /// Closing word without its opening word (20232 for $ENDFOR).
    Unopened {
        /// Opening word.
        opening: &'static str,
    },
    /// Opening word without its closing word; the place is the opening word.
    Unclosed {
        /// Closing word.
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
    /// A number with an exponent, `1e10`.
    Exponent,
    /// The label of `$GOTO` is not in this program.
    NoLabel,
    /// The text has no main program, only local subroutines.
    NoMainProgram,
    /// LL with a name that no %L of this file or its callers declares.
    NoSubroutine,
    /// L with a name for which the text source has no file.
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
    /// 50603: contradictory words of an independent axis. The text says which words fit.
    Independent(&'static str),
    /// The block lacks a word. The text names the word.
    Missing(&'static str),
    /// `*nn` at the end of a numbered line: a checksum of serial transmission.
    Checksum,
    /// A V. variable that was not written yet.
    #[cfg(feature = "plc")]
    VariableUnset,
    /// A V. variable that neither language nor application defines.
    #[cfg(feature = "plc")]
    NoVariable,
    /// A V. variable that a program may not write.
    #[cfg(feature = "plc")]
    VariableReadOnly,
    /// A value or use of `V.G.M_FCT` or `V.G.H_FCT` that is not possible. The text says what is expected.
    #[cfg(feature = "plc")]
    SynchVariable(&'static str),
    /// 22073: a command that is not permitted in a real-time loop.
    #[cfg(feature = "plc")]
    InLoop,
    /// A word that the dialect has and Glidepath does not. The texts name the word and an alternative.
    #[cfg(feature = "grbl")]
    Known {
        /// The word.
        what: &'static str,
        /// The alternative.
        hint: &'static str,
    },
    /// A G or M word that this dialect does not have.
    #[cfg(feature = "grbl")]
    UnknownCode(&'static str),
    /// A parameter with a name that has no value.
    #[cfg(feature = "grbl")]
    NameUnset,
    /// A call (O word or M98) of a subroutine that the text does not have.
    #[cfg(feature = "grbl")]
    NoProgram,
    /// A value that no word of the block uses.
    #[cfg(feature = "grbl")]
    Unused,
    /// A tool without a length in the machine data.
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
    /// M02 or M30 inside a subroutine ends the whole program.
    EndInSubroutine,
    /// A comment without `)`: the line end closes it.
    UnclosedComment,
    /// An arc deselects contour mode by PTP.
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
    /// Arithmetic after an address, without brackets; the value is the result in thousandths.
    Computed(i32),
    /// R in a block without an arc: it stays in force for arcs that follow.
    RadiusAlone,
    /// M17 or M29 in the main program ends it.
    MainEnds,
    /// A program head after words without a head: the head ends the program of those words.
    HeadEnds,
    /// SHORT of a linear axis has no effect.
    ShortLinear,
    /// The first motion comes before F, G00 and G01: such motions are rapid.
    RapidWithoutFeed,
    /// G64 without P. The value is the permitted distance from the path, µm.
    #[cfg(feature = "grbl")]
    BlendTolerance(u32),
    /// Q of G64.
    #[cfg(feature = "grbl")]
    NoMerging,
    /// M49 to M53: the operator's overrides stay enabled.
    #[cfg(feature = "grbl")]
    OverridesStay,
    /// `/` in a program of Grbl, which carries out the block.
    #[cfg(feature = "grbl")]
    BlockSkip,
    /// G4 of more than a minute.
    #[cfg(feature = "grbl")]
    LongDwell,
    /// F in the block of a G20 or G21 that changes the unit.
    #[cfg(feature = "grbl")]
    FeedBeforeUnit,
    /// A program of LinuxCNC without M2, M30 or %.
    #[cfg(feature = "grbl")]
    NoProgramEnd,
    /// A comment that LinuxCNC carries out.
    #[cfg(feature = "grbl")]
    ActiveComment,
    /// G43 on a machine without tool lengths.
    #[cfg(feature = "grbl")]
    NoToolTable,
    /// A length without a decimal point in a program of Fanuc.
    #[cfg(feature = "grbl")]
    LeastIncrement,
    /// G95: the feed counts by the programmed spindle speed.
    #[cfg(feature = "grbl")]
    FeedOfSpindle,
    /// G96: the spindle speed changes from block to block.
    #[cfg(feature = "grbl")]
    SpeedByBlock,
    /// A mode of the controller without effect here.
    #[cfg(feature = "grbl")]
    ModeWithoutEffect,
    /// A command to Grbl that reports or unlocks.
    #[cfg(feature = "grbl")]
    Report,
    /// P or Q of M100 to M199.
    #[cfg(feature = "grbl")]
    NoArguments,
}

impl NcWarningKind {
    /// Whether the warning comes from the planner, which takes the motion or the dwell, and not from the
    /// decoder.
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
    /// ISG's number of this message; 0 if no number is known. A message that ISG describes without a number
    /// has a number of this project: 900001 and up. Their reaction class is 1: the program continues.
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

/// Byte and length in the logical line.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Span {
    pub at: u16,
    pub len: u16,
}

/// A refusal inside the current line; the decoder adds place and text.
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

//! `#` commands of ISG's language. The decoder recognises a command by its words, and then reads the keywords
//! in its brackets.
use super::cursor::Cursor;
use super::expression::expression;
use super::function::*;
use super::interpreter::{Gathered, Interpreter};
use super::keyword::{COORDINATE, Range, Units, checked, list, number};
use super::line::Line;
use super::number::Factor;
use super::smoothing::{AkimaWords, HscWords, LogWords};
use super::{Command, Fault, Head, NcErrorKind};
use crate::machine::functions::{self, Function};
use core::cell::Cell;

#[derive(Clone, Copy, PartialEq, Eq)]
enum Hash {
    Contour(Option<ContourSwitch>),
    LogOn,
    LogOff,
    LogClear,
    Log,
    Hsc(Option<bool>),
    SlopeDefault,
    Slope,
    SetSlope,
    Filter(Option<bool>),
    VectorLimit(bool),
    AkimaTrans,
    StartVector,
    EndVector,
    SplineType(SplineType),
    SplineOn,
    SplineOff,
    AsplineMode,
    KinId,
    TrafoOn,
    TrafoOff,
    Trafo,
    PutAx,
    CallAx,
    RtWhile,
    RtEndWhile,
    DistanceClear,
    FlushWait,
    #[cfg(feature = "plc")]
    Flush,
    #[cfg(feature = "plc")]
    Message,
    #[cfg(feature = "plc")]
    ExplicitSynch,
    WaitIndependent,
    Time,
}

impl Hash {
    /// The function that must be compiled in for this command.
    const fn function(self) -> Option<Function> {
        match self {
            Self::Contour(Some(ContourSwitch::Off)) | Self::Hsc(Some(false)) | Self::Filter(Some(false)) => {
                None
            }
            Self::Contour(_) | Self::Hsc(_) => Some(functions::CONTOUR),
            Self::AkimaTrans
            | Self::StartVector
            | Self::EndVector
            | Self::SplineType(_)
            | Self::SplineOn
            | Self::AsplineMode => Some(functions::SPLINES),
            Self::Filter(_) => Some(functions::FILTERS),
            Self::WaitIndependent => Some(functions::BESIDE),
            _ => None,
        }
    }
}

/// All commands. A longer command comes before a command with which it begins.
const COMMANDS: &[(&str, Hash)] = &[
    ("CONTOUR MODE ON", Hash::Contour(Some(ContourSwitch::On))),
    ("CONTOUR MODE OFF", Hash::Contour(Some(ContourSwitch::Off))),
    ("CONTOUR MODE", Hash::Contour(None)),
    ("CONTOUR LOOKAHEAD LOG ON", Hash::LogOn),
    ("CONTOUR LOOKAHEAD LOG OFF", Hash::LogOff),
    ("CONTOUR LOOKAHEAD LOG CLEAR", Hash::LogClear),
    ("CONTOUR LOOKAHEAD CLEAR", Hash::LogClear),
    ("CONTOUR LOOKAHEAD LOG", Hash::Log),
    ("HSC ON", Hash::Hsc(Some(true))),
    ("HSC OFF", Hash::Hsc(Some(false))),
    ("HSC", Hash::Hsc(None)),
    ("SLOPE DEFAULT", Hash::SlopeDefault),
    ("SLOPE", Hash::Slope),
    ("SET SLOPE PROFIL", Hash::SetSlope),
    ("FILTER ON", Hash::Filter(Some(true))),
    ("FILTER OFF", Hash::Filter(Some(false))),
    ("FILTER", Hash::Filter(None)),
    ("VECTOR LIMIT ON", Hash::VectorLimit(true)),
    ("VECTOR LIMIT OFF", Hash::VectorLimit(false)),
    ("AKIMA TRANS", Hash::AkimaTrans),
    ("AKIMA STARTVECTOR", Hash::StartVector),
    ("AKIMA ENDVECTOR", Hash::EndVector),
    ("SPLINE TYPE AKIMA", Hash::SplineType(SplineType::Akima)),
    ("SPLINE TYPE BSPLINE", Hash::SplineType(SplineType::Bspline)),
    ("SPLINE ON", Hash::SplineOn),
    ("SPLINE OFF", Hash::SplineOff),
    ("SET SPLINETYPE AKIMA", Hash::SplineType(SplineType::Akima)),
    ("SET SPLINETYPE BSPLINE", Hash::SplineType(SplineType::Bspline)),
    ("SET SPLINE ON", Hash::SplineOn),
    ("SET SPLINE OFF", Hash::SplineOff),
    ("SET ASPLINE MODE", Hash::AsplineMode),
    ("KIN ID", Hash::KinId),
    ("TRAFO ON", Hash::TrafoOn),
    ("TRAFO OFF", Hash::TrafoOff),
    ("TRAFO", Hash::Trafo),
    ("PUT AX", Hash::PutAx),
    ("CALL AX", Hash::CallAx),
    ("RT WHILE", Hash::RtWhile),
    ("RT ENDWHILE", Hash::RtEndWhile),
    ("DISTANCE PROG START CLEAR", Hash::DistanceClear),
    ("DISTANCE PROGRAM START CLEAR", Hash::DistanceClear),
    ("FLUSH&WAIT", Hash::FlushWait),
    #[cfg(feature = "plc")]
    ("FLUSH WAIT", Hash::FlushWait),
    #[cfg(feature = "plc")]
    ("FLUSH", Hash::Flush),
    #[cfg(feature = "plc")]
    ("MSG", Hash::Message),
    #[cfg(feature = "plc")]
    ("EXPL SYN", Hash::ExplicitSynch),
    ("WAIT INDP", Hash::WaitIndependent),
    ("TIME", Hash::Time),
];

/// First words of ISG's commands that Glidepath knows but does not have.
const OTHER: &[&str] = &[
    "ACS",
    "ADD",
    "ANG",
    "AX",
    "BACKWARD",
    "BCS",
    "CACHE",
    "CAXTRACK",
    "CAX",
    "CHANNEL",
    "CHF",
    "CHR",
    "CLEAR",
    "COLD",
    "CONTROL",
    "CORR",
    "COUPLE",
    "CS",
    "CYL",
    "DEL",
    "DIST",
    "DISABLE",
    "DYNAMIC",
    "ECS",
    "EDM",
    "ENABLE",
    "ERROR",
    "EXPL",
    "EXPORT",
    "FACE",
    "FILE",
    "FLUSH",
    "FREE",
    "FRC",
    "GEAR",
    "GET",
    "GANTRY",
    "HANDWHEEL",
    "IDENT",
    "INDP",
    "INIT",
    "INTF",
    "JOG",
    "KIN",
    "LOG",
    "MACHINE",
    "MAIN",
    "MANUAL",
    "MCS",
    "MEAS",
    "MIRROR",
    "MSG",
    "NIBBLE",
    "OPTIONAL",
    "ORI",
    "OTC",
    "OVERWRITE",
    "PROFILE",
    "PROJECT",
    "PSET",
    "PRESET",
    "PTP",
    "PUNCH",
    "PUT",
    "ROTATION",
    "REPOSITION",
    "RPF",
    "RT",
    "SCALE",
    "SELECT",
    "SEGMENTATION",
    "SET",
    "SIGNAL",
    "SINGLE",
    "SPINDLE",
    "STOP",
    "STRING",
    "SUPPRESS",
    "TANGFEED",
    "TLC",
    "TOOL",
    "TRACK",
    "TRC",
    "TUBE",
    "TURN",
    "UNLOCK",
    "UPDATE",
    "USER",
    "VAR",
    "ENDVAR",
    "VECTOR",
    "VOLCOMP",
    "WAIT",
    "WCS",
];

impl<const AXES: usize> Interpreter<AXES> {
    /// Reads the command after `#`, which must be alone in its line. A separate function, so that its stack
    /// frame does not exist while words are read.
    #[inline(never)]
    pub fn hash_command(&mut self, c: &mut Cursor<'_>, line: &Line) -> Result<(), Fault> {
        let mark = c.mark();
        c.bump();
        let words = c.mark();
        let Some((_, id)) = COMMANDS.iter().find(|(name, _)| c.eat_words(name)) else {
            let word = c.letters();
            if word.is("SPLINE") {
                return c.expected("ON, OFF, TYPE AKIMA or TYPE BSPLINE");
            }
            let other = OTHER.iter().any(|name| word.is(name));
            c.back_to(words);
            while c.peek().is_ascii_alphanumeric() || matches!(c.raw(), b'&' | b'_') {
                c.bump();
            }
            let span = c.since(mark);
            return span.fault(if other {
                NcErrorKind::NotAvailable("command")
            } else {
                NcErrorKind::UnknownHash
            });
        };
        let span = c.since(mark);
        id.function().map_or(Ok(()), |function| span.needs(function))?;
        let head = self.head_of(line, span);
        self.arguments(
            c,
            *id,
            head,
            #[cfg(feature = "plc")]
            line,
        )?;
        let end = c.require_end("a # command");
        if end.is_err() {
            self.gathered = Gathered::Nothing;
        }
        end
    }

    /// Units for keywords that concern the main axes.
    fn main_units(&self) -> Units {
        Units { length: self.length_factor(), feed: Factor::ONE }
    }

    fn arguments(
        &mut self,
        c: &mut Cursor<'_>,
        id: Hash,
        head: Head,
        #[cfg(feature = "plc")] line: &Line,
    ) -> Result<(), Fault> {
        self.gathered = Gathered::Single(Cell::new(match id {
            Hash::Contour(switch) => Command::Contour(head, self.contour(c, switch)?),
            Hash::LogClear => Command::ContourLog(head, ContourLog::Clear),
            Hash::LogOn | Hash::LogOff | Hash::Log => Command::ContourLog(head, self.log(c, id)?),
            Hash::Hsc(switch) => Command::Hsc(head, self.hsc(c, switch)?),
            Hash::SlopeDefault => Command::Slope(head, Slope { default: true, ..Slope::default() }),
            Hash::Slope => Command::Slope(head, self.slope(c)?),
            Hash::SetSlope => Command::Slope(head, self.old_slope(c)?),
            Hash::Filter(switch) => Command::Filter(head, self.filter(c, switch)?),
            Hash::VectorLimit(on) => Command::VectorLimit(head, self.vector_limit(c, on)?),
            Hash::AkimaTrans => Command::Spline(head, self.akima(c)?),
            Hash::StartVector => Command::Spline(head, Spline::StartVector(self.axis_vector(c)?)),
            Hash::EndVector => Command::Spline(head, Spline::EndVector(self.axis_vector(c)?)),
            Hash::SplineType(kind) => Command::Spline(head, Spline::Type(kind)),
            Hash::SplineOn => Command::Spline(head, Spline::On),
            Hash::SplineOff => Command::Spline(head, Spline::Off),
            Hash::AsplineMode => {
                c.require(b'[', "[start, end]")?;
                let start = self.aspline_mode(c)?;
                c.require(b',', ", and the mode of the end")?;
                let end = self.aspline_mode(c)?;
                c.require(b']', "]")?;
                Command::Spline(head, Spline::Transition { start: Some(start), end: Some(end) })
            }
            Hash::KinId => Command::Kinematics(head, Kinematics::Select(self.kinematic_id(c)?)),
            Hash::Trafo => Command::Kinematics(head, Kinematics::OnWith(self.kinematic_id(c)?)),
            Hash::TrafoOn => Command::Kinematics(head, Kinematics::On),
            Hash::TrafoOff => Command::Kinematics(head, Kinematics::Off),
            Hash::PutAx => Command::PutAxes(head, self.axis_list(c)?),
            Hash::CallAx => Command::CallAxes(head, self.axis_list(c)?),
            Hash::RtWhile => {
                let modulo = c.eat_words("MODULO") || {
                    let bracket = c.eat(b'[');
                    if bracket && !c.eat_words("MODULO") {
                        return c.expected("MODULO");
                    }
                    if bracket {
                        c.require(b']', "]")?;
                    }
                    bracket
                };
                #[cfg(feature = "plc")]
                {
                    self.in_loop = true;
                }
                Command::RtWhile(head, modulo)
            }
            Hash::RtEndWhile => {
                #[cfg(feature = "plc")]
                {
                    self.in_loop = false;
                }
                Command::RtEndWhile(head)
            }
            Hash::DistanceClear => Command::DistanceClear(head),
            Hash::FlushWait => Command::FlushWait(head),
            #[cfg(feature = "plc")]
            Hash::Flush => Command::Flush(head),
            #[cfg(feature = "plc")]
            Hash::ExplicitSynch => Command::ExplicitSynch(head),
            #[cfg(feature = "plc")]
            Hash::Message => Command::Message(Head { place: line.place(message(c)?), ..head }),
            Hash::WaitIndependent => Command::WaitIndependent(head, self.axis_list(c)?),
            Hash::Time => {
                let mark = c.mark();
                let seconds = number(c, &self.calculator, mark, Range::new(0, 100_000, "s"))?;
                Command::Dwell(head, DwellTime::Seconds(seconds))
            }
        }));
        Ok(())
    }

    // Separate functions, so that only one list of keywords is on the stack.

    #[inline(never)]
    fn log(&self, c: &mut Cursor<'_>, id: Hash) -> Result<ContourLog, Fault> {
        let mut words = LogWords::default();
        if c.peek() == b'[' || id == Hash::Log {
            list(c, &self.calculator, self.main_units(), &mut words)?;
        }
        match (id, words.param) {
            (Hash::LogOn, param) => Ok(ContourLog::On(param)),
            (Hash::LogOff, param) => Ok(ContourLog::Off(param)),
            (_, Some(param)) => Ok(ContourLog::Parameter(param)),
            _ => c.expected("ON, OFF, CLEAR or [PARAM=…]"),
        }
    }

    #[inline(never)]
    fn hsc(&self, c: &mut Cursor<'_>, switch: Option<bool>) -> Result<Hsc, Fault> {
        let mut words = HscWords::default();
        words.hsc.switch = switch;
        let mark = c.mark();
        if functions::CONTOUR.is_built() && is_list(c, switch.is_some())? {
            list(c, &self.calculator, self.main_units(), &mut words)?;
        }
        if let Some(mode) = words.opmode {
            if !(1..=2).contains(&mode) {
                let kind = NcErrorKind::Range { what: "OPMODE", min: 1, max: 2, unit: "", above: false };
                return c.since(mark).fault(kind);
            }
            words.hsc.method = Some(HscMethod::Op(mode));
        }
        Ok(words.hsc)
    }

    #[inline(never)]
    fn slope(&self, c: &mut Cursor<'_>) -> Result<Slope, Fault> {
        let mut slope = Slope::default();
        list(c, &self.calculator, self.main_units(), &mut slope)?;
        if slope == Slope::default() {
            return c.expected("TYPE or NO_OPT in brackets");
        }
        Ok(slope)
    }

    #[inline(never)]
    fn filter(&self, c: &mut Cursor<'_>, switch: Option<bool>) -> Result<Filter, Fault> {
        let mut filter = Filter { switch, ..Filter::default() };
        if functions::FILTERS.is_built() && is_list(c, switch.is_some())? {
            list(c, &self.calculator, self.main_units(), &mut filter)?;
        }
        Ok(filter)
    }

    #[inline(never)]
    fn vector_limit(&self, c: &mut Cursor<'_>, on: bool) -> Result<VectorLimit, Fault> {
        let mut limit = VectorLimit { on, ..VectorLimit::default() };
        limit.all = c.eat_words("ALL");
        if !limit.all && c.peek() != b'[' {
            return c.expected("ALL or [ and limits");
        }
        while c.peek() == b'[' {
            list(c, &self.calculator, self.main_units(), &mut limit)?;
        }
        Ok(limit)
    }

    #[inline(never)]
    fn akima(&self, c: &mut Cursor<'_>) -> Result<Spline<AXES>, Fault> {
        let mut words = AkimaWords::default();
        list(c, &self.calculator, self.main_units(), &mut words)?;
        Ok(Spline::Transition { start: words.start, end: words.end })
    }

    /// #CONTOUR MODE: the interim point becomes a machine coordinate.
    #[inline(never)]
    fn contour(&self, c: &mut Cursor<'_>, switch: Option<ContourSwitch>) -> Result<Contour, Fault> {
        let mut contour = Contour { switch, ..Contour::default() };
        let mark = c.mark();
        if functions::CONTOUR.is_built() && is_list(c, switch.is_some())? {
            list(c, &self.calculator, self.main_units(), &mut contour)?;
        }
        for (value, main) in contour.point.iter_mut().zip(self.setup.main) {
            if let Some(value) = value {
                let Some(axis) = main else { return c.since(mark).fault(NcErrorKind::NoMainAxis) };
                *value = checked(value.saturating_add(self.offset(axis)), c.since(mark))?;
            }
        }
        Ok(contour)
    }

    /// Reads `#SET SLOPE PROFIL [1]`, or this command with the keywords of `#SLOPE`.
    #[inline(never)]
    fn old_slope(&self, c: &mut Cursor<'_>) -> Result<Slope, Fault> {
        let mark = c.mark();
        c.require(b'[', "[ and the profile")?;
        if c.peek().is_ascii_digit() || c.peek_upper() == b'P' {
            let number_mark = c.mark();
            let number = expression(c, &self.calculator)?;
            let kind = match number.whole() {
                Some(0) => SlopeType::Step,
                Some(1) => SlopeType::Trapez,
                Some(2) => SlopeType::Sin2,
                Some(3) => SlopeType::Hsc,
                _ => {
                    let kind = NcErrorKind::Range { what: "profile", min: 0, max: 3, unit: "", above: false };
                    return c.since(number_mark).fault(kind);
                }
            };
            c.require(b']', "]")?;
            return Ok(Slope { kind: Some(kind), ..Slope::default() });
        }
        c.back_to(mark);
        let mut slope = Slope::default();
        list(c, &self.calculator, self.main_units(), &mut slope)?;
        Ok(slope)
    }

    /// Reads a mode: 1 automatic, 2 tangential, 3 given by the user.
    fn aspline_mode(&self, c: &mut Cursor<'_>) -> Result<Tangent, Fault> {
        let mark = c.mark();
        match expression(c, &self.calculator)?.whole() {
            Some(1) => Ok(Tangent::Auto),
            Some(2) => Ok(Tangent::Tangential),
            Some(3) => Ok(Tangent::User),
            _ => c.since(mark).fault(NcErrorKind::Range {
                what: "mode",
                min: 1,
                max: 3,
                unit: "",
                above: false,
            }),
        }
    }

    /// Reads an identifier such as `[9]`.
    fn kinematic_id(&self, c: &mut Cursor<'_>) -> Result<u16, Fault> {
        c.require(b'[', "[ and the number of a kinematic")?;
        let mark = c.mark();
        let id =
            expression(c, &self.calculator)?.whole().and_then(|n| u16::try_from(n).ok()).filter(|n| *n > 0);
        let span = c.since(mark);
        let kind = NcErrorKind::Range { what: "kinematic", min: 1, max: 65_535, unit: "", above: false };
        let id = id.ok_or(Fault { span, kind })?;
        c.require(b']', "]")?;
        Ok(id)
    }

    /// Reads a vector such as `X1 Y0 …`, one number per axis.
    #[inline(never)]
    fn axis_vector(&self, c: &mut Cursor<'_>) -> Result<[Option<Value>; AXES], Fault> {
        let mut vector = [None; AXES];
        if c.at_end() {
            return c.expected("axis components");
        }
        while !c.at_end() {
            let mark = c.mark();
            let Some(axis) = self.axis_here(c) else { return self.no_axis(c) };
            let value = number(c, &self.calculator, mark, COORDINATE)?;
            if let Some(slot) = vector.get_mut(axis)
                && slot.replace(value).is_some()
            {
                return c.since(mark).fault(NcErrorKind::Twice("axis"));
            }
        }
        Ok(vector)
    }

    /// Reads a list of axes such as `[Z]`, `[X, Y]`, `[X,1,0]` or `ALL`; returns one bit per axis. Logical
    /// numbers and places are checked and dropped.
    fn axis_list(&self, c: &mut Cursor<'_>) -> Result<u32, Fault> {
        if c.eat_words("ALL") {
            return Ok((0..AXES as u32).fold(0, |bits, axis| bits | 1_u32.wrapping_shl(axis)));
        }
        let mut bits = 0_u32;
        let mark = c.mark();
        c.require(b'[', "[ and axes")?;
        loop {
            while c.eat(b',') {}
            if c.eat(b']') {
                if c.eat(b'[') {
                    continue;
                }
                break;
            }
            if c.peek().is_ascii_digit() && bits != 0 {
                c.whole("axis number")?;
                continue;
            }
            let Some(axis) = self.axis_name(c) else { return self.no_axis(c) };
            bits |= 1_u32.wrapping_shl(axis as u32);
        }
        if bits == 0 {
            return c.since(mark).fault(NcErrorKind::Expected("at least one axis in brackets"));
        }
        Ok(bits)
    }

    /// The axis whose name is the identifier at the cursor.
    fn axis_name(&self, c: &mut Cursor<'_>) -> Option<usize> {
        let mark = c.mark();
        let word = c.identifier(24);
        let axis = self.setup.names.iter().position(|name| word.is(name.as_str()));
        if axis.is_none() {
            c.back_to(mark);
        }
        axis
    }

    /// Refuses a word that is not an axis.
    fn no_axis<V>(&self, c: &mut Cursor<'_>) -> Result<V, Fault> {
        if c.at_end() {
            return c.expected("an axis or ]");
        }
        let span = c.here();
        let usual = matches!(c.peek_upper(), b'A'..=b'C' | b'Q' | b'U'..=b'Z');
        span.fault(if usual { NcErrorKind::AxisNotHere } else { NcErrorKind::Expected("an axis") })
    }
}

/// Whether keywords follow in brackets. After a switch, the brackets may be missing, but no other text may
/// follow.
fn is_list(c: &mut Cursor<'_>, switched: bool) -> Result<bool, Fault> {
    match c.peek() {
        b'[' => Ok(true),
        _ if !switched => Ok(true),
        0 => Ok(false),
        _ => c.expected("[ and keywords, or nothing behind the switch"),
    }
}

/// Reads `["text"]` and returns the text.
#[cfg(feature = "plc")]
fn message(c: &mut Cursor<'_>) -> Result<super::Span, Fault> {
    c.require(b'[', "[\"text\"]")?;
    c.require(b'"', "\" and a text")?;
    let mark = c.mark();
    while !matches!(c.raw(), b'"' | 0) {
        c.bump();
    }
    let text = c.since(mark);
    c.require(b'"', "\" behind the text")?;
    c.require(b']', "] behind the text, without values")?;
    Ok(text)
}

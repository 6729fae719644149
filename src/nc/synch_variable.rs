//! Variables that set the synchronisation of an M or H function: `V.G.M_FCT[25].SYNCH`,
//! `V.G.H_FCT[25].PRE_OUTP_PATH` (feature `plc`).
//!
//! | name | meaning |
//! |---|---|
//! | `SYNCH` | kind of synchronisation, as a number: P-CHAN-00041 (M), P-CHAN-00027 (H) |
//! | `PRE_OUTP_PATH` | distance before its place at which the function is output, mm (inches with G70): P-CHAN-00070, P-CHAN-00107 |
//!
//! A value is valid for the lines after its assignment, up to the end of the program. The next program begins
//! with the values of the machine data.
use super::cursor::Cursor;
use super::interpreter::Interpreter;
use super::{Fault, NcErrorKind, Span};
use crate::machine::{SHIFT_MAX, Synch, SynchTable};

/// Largest number of a function.
const LAST: u16 = 999;

/// FAW_SYNCH beside another kind.
const FAW: u32 = 0x1000_0000;

/// 0.1 µm in a millimetre.
const TENTHS_PER_MM: f64 = 10_000.0;

const MEMBERS: &str = "V.G.M_FCT[0…999].SYNCH or .PRE_OUTP_PATH, with the number in digits";

/// A variable of one M or H function.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) struct FunctionVariable {
    is_h: bool,
    code: u16,
    /// `true`: PRE_OUTP_PATH. `false`: SYNCH.
    is_path: bool,
}

/// Whether a name up to `[` is `G.M_FCT` or `G.H_FCT`.
pub(super) fn is_function(letters: &[u8]) -> bool {
    matches!(letters, b"G.M_FCT" | b"G.H_FCT")
}

/// Reads the number of a function at `[`, up to `]`.
pub(super) fn number(c: &mut Cursor<'_>) -> Result<u16, Fault> {
    let mark = c.mark();
    c.bump();
    let mut code = None;
    while c.raw().is_ascii_digit() {
        code = Some((code.unwrap_or(0) * 10 + u16::from(c.raw() - b'0')).min(LAST + 1));
        c.bump();
    }
    match code.filter(|code| c.raw() == b']' && *code <= LAST) {
        Some(code) => {
            c.bump();
            Ok(code)
        }
        None => c.rest_from(mark).fault(NcErrorKind::Expected(MEMBERS)),
    }
}

/// The variable with this name, which is in upper case and without `V.`.
pub(super) fn parse(letters: &[u8]) -> Option<FunctionVariable> {
    let rest = letters.strip_prefix(b"G.")?;
    let is_h = rest.first() == Some(&b'H');
    let rest = rest.get(1..)?.strip_prefix(b"_FCT[")?;
    let end = rest.iter().position(|letter| *letter == b']')?;
    let (digits, member) = (rest.get(..end)?, rest.get(end + 1..)?);
    let code =
        digits.iter().fold(0u16, |code, digit| code.wrapping_mul(10).wrapping_add(u16::from(digit - b'0')));
    match member {
        b".SYNCH" => Some(FunctionVariable { is_h, code, is_path: false }),
        b".PRE_OUTP_PATH" => Some(FunctionVariable { is_h, code, is_path: true }),
        _ => None,
    }
}

/// Why a variable of an M or H function has no value.
pub(super) fn missing(letters: &[u8]) -> NcErrorKind {
    match parse(letters) {
        Some(_) => {
            NcErrorKind::SynchVariable("a function of MEP_SVS or MEP_MOS; the others have no shift (21512)")
        }
        None => NcErrorKind::SynchVariable(MEMBERS),
    }
}

impl<const AXES: usize> Interpreter<AXES> {
    fn table(&self, is_h: bool) -> &SynchTable {
        if is_h { &self.setup.h_synch } else { &self.setup.m_synch }
    }

    fn unit(&self) -> f64 {
        if self.modal.inch { 25.4 } else { 1.0 }
    }

    /// The value of a variable of an M or H function.
    pub(super) fn function_value(&self, letters: &[u8]) -> Option<f64> {
        let FunctionVariable { is_h, code, is_path } = parse(letters)?;
        let table = self.table(is_h);
        let synch = table.of(code);
        if is_path {
            let mm = f64::from(table.shift(code)) / TENTHS_PER_MM;
            return synch.is_shifted().then_some(mm / self.unit());
        }
        let bits = Synch::ALL.iter().find(|(known, ..)| *known == synch)?.2;
        Some(f64::from(bits | if table.flushes(code) { FAW } else { 0 }))
    }

    /// Writes a variable of an M or H function.
    pub(super) fn set_function(&mut self, letters: &[u8], value: f64) -> Result<(), NcErrorKind> {
        let Some(FunctionVariable { is_h, code, is_path }) = parse(letters) else {
            return Err(missing(letters));
        };
        let table = *self.table(is_h);
        let changed = if is_path {
            let tenths = value * self.unit() * TENTHS_PER_MM + 0.5;
            if !(0.0..=f64::from(SHIFT_MAX) + 0.5).contains(&tenths) || value < 0.0 {
                return Err(NcErrorKind::SynchVariable("0…200 000 mm"));
            }
            table.with_shift(code, tenths as u32)
        } else {
            let (synch, flushes) = kind(value).ok_or(NcErrorKind::SynchVariable(KINDS))?;
            if synch.is_shifted() && !self.setup.given.shifts {
                return Err(NcErrorKind::SynchVariable(
                    "FCT_SHIFT_NCBL in configuration.interpolator.function (P-CHAN-00650) for MEP_SVS and MEP_MOS",
                ));
            }
            if flushes { table.with_flush(code, synch) } else { table.with(code, synch) }
        };
        if changed.overflows() {
            return Err(NcErrorKind::SynchVariable("at most 32 functions with a synchronisation or a shift"));
        }
        *(if is_h { &mut self.setup.h_synch } else { &mut self.setup.m_synch }) = changed;
        Ok(())
    }

    /// Refuses a shift of a function whose synchronisation has no shift.
    pub(super) fn check_shift(&self, is_h: bool, code: u16, span: Span) -> Result<(), Fault> {
        let table = self.table(is_h);
        if table.shift(code) == 0 || table.of(code).is_shifted() {
            return Ok(());
        }
        let expected = "MEP_SVS or MEP_MOS: the function has a shift (V.G.M_FCT[…].PRE_OUTP_PATH), which this \
            synchronisation does not know";
        span.fault(NcErrorKind::SynchVariable(expected))
    }

    /// Restores the synchronisation of the machine data, for the next program.
    pub(super) fn reset_functions(&mut self) {
        (self.setup.m_synch, self.setup.h_synch) = (self.setup.given.m, self.setup.given.h);
    }
}

const KINDS: &str = "the number of a synchronisation: 0 NO_SYNCH, 1 MOS, 2 MVS_SVS, 4 MVS_SNS, 8 MNS_SNS, 16384 MVS_SLM, \
    32768 MVS_SLP, 16777216 MEP_SVS, 1048576 MEP_MOS; 268435456 more with FAW_SYNCH";

/// The available kind of synchronisation with this number, and whether FAW_SYNCH is set too.
fn kind(value: f64) -> Option<(Synch, bool)> {
    if !(0.0..=f64::from(u32::MAX)).contains(&value) {
        return None;
    }
    let bits = value as u32;
    let flushes = bits > FAW && bits & FAW != 0;
    let bits = if flushes { bits & !FAW } else { bits };
    let (synch, ..) = Synch::ALL.iter().find(|(synch, _, known)| *known == bits && synch.is_available())?;
    (f64::from(value as u32) == value).then_some((*synch, flushes))
}

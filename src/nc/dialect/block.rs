//! Reads the words of a line of LinuxCNC, Grbl or Fanuc, and stores them by modal group and by letter.
//! `order.rs` carries them out.
use super::words::{NOT_BUILT, WordEntry, find, group};
use crate::machine::{Dialect, functions};
use crate::nc::block::Given;
use crate::nc::cursor::Cursor;
use crate::nc::interpreter::Interpreter;
use crate::nc::number::Number;
use crate::nc::{Fault, NcErrorKind, Span, real};
use heapless::Vec;

/// Letters of the alphabet.
const LETTERS: usize = 26;

/// A G or M word of the line.
#[derive(Clone, Copy)]
pub(super) struct Said {
    pub word: &'static WordEntry,
    /// The number of the word: M100…M199 share one table entry.
    pub number: u16,
    pub span: Span,
}

/// The words of a line.
pub(super) struct Block<const AXES: usize> {
    pub axes: [Option<Given>; AXES],
    /// The first axis word.
    pub first: Option<Span>,
    values: [Option<Given>; LETTERS],
    /// Assignments `#n=`: parameter and value. The decoder carries them out after it has read the whole line.
    pub assigned: Vec<(u32, f64), ASSIGNED>,
    said: [Option<Said>; group::COUNT],
    /// Letters whose number has no decimal point, one bit each; used for Fanuc programs.
    pub pointless: u32,
}

/// Cost of a word, in the unit of [`crate::nc::calculator`].
const WORD: u32 = 8;

/// Largest number of assignments in a line.
const ASSIGNED: usize = 16;

/// Most digits of a number; most digits after the decimal point.
const DIGITS: u8 = 19;

impl<const AXES: usize> Block<AXES> {
    const fn new() -> Self {
        Self {
            axes: [None; AXES],
            first: None,
            values: [None; LETTERS],
            assigned: Vec::new(),
            said: [None; group::COUNT],
            pointless: 0,
        }
    }

    /// The word of a modal group, if the line has one.
    pub fn said(&self, group: u8) -> Option<Said> {
        self.said.get(usize::from(group)).copied().flatten()
    }

    fn slot(&mut self, letter: u8) -> Option<&mut Option<Given>> {
        self.values.get_mut(usize::from(letter.wrapping_sub(b'A')))
    }

    /// Returns the value after a letter and marks it as used.
    pub fn take(&mut self, letter: u8) -> Option<Given> {
        self.slot(letter)?.take()
    }

    /// The value after a letter.
    pub fn value(&self, letter: u8) -> Option<Given> {
        self.values.get(usize::from(letter.wrapping_sub(b'A'))).copied().flatten()
    }

    /// The value after a letter, to be changed.
    pub fn value_mut(&mut self, letter: u8) -> Option<&mut Given> {
        self.slot(letter)?.as_mut()
    }

    /// Whether the number after a letter has no decimal point.
    pub const fn is_pointless(&self, letter: u8) -> bool {
        self.pointless & 1_u32.wrapping_shl(letter.wrapping_sub(b'A') as u32) != 0
    }

    /// Checks that every value has been used.
    pub fn is_used_up(&self) -> Result<(), Fault> {
        let left = self.values.iter().flatten().map(|given| given.span).min_by_key(|span| span.at);
        match left {
            Some(span) => span.fault(NcErrorKind::Unused),
            None => Ok(()),
        }
    }
}

impl<const AXES: usize> Interpreter<AXES> {
    /// Reads the words of a line.
    pub(super) fn read_block(&mut self, c: &mut Cursor<'_>) -> Result<Block<AXES>, Fault> {
        let mut block = Block::new();
        let (mut numbered, mut spindle) = (false, false);
        while !c.at_end() {
            let mark = c.mark();
            let letter = c.peek_upper();
            if self.setup.foreign.dialect().is_fanuc() {
                no_macro(c)?;
            }
            if letter == b'#' {
                self.read_assignment(c, &mut block)?;
                continue;
            }
            if letter == b'$'
                && self.setup.foreign.dialect() == Dialect::LinuxCnc
                && !spindle
                && self.read_spindle(c)?
            {
                spindle = true;
                continue;
            }
            if letter == b'/' && self.setup.foreign.dialect().is_fanuc() {
                if self.setup.foreign.block_delete {
                    break;
                }
                skip_switch(c);
                continue;
            }
            if !letter.is_ascii_alphabetic() {
                return self.no_address(c, letter);
            }
            c.bump();
            match letter {
                b'G' | b'M' => self.read_code(c, mark, letter, &mut block)?,
                b'N' => {
                    let given = self.read_value(c, mark)?;
                    if numbered {
                        return given.span.fault(NcErrorKind::Twice("N"));
                    }
                    numbered = true;
                    self.n = whole_part(given.number);
                }
                b'O' => {
                    c.back_to(mark);
                    return c.here().fault(NcErrorKind::NotAlone("an O word"));
                }
                b'A' | b'B' | b'C' | b'U'..=b'Z' => self.read_axis(c, mark, letter, &mut block)?,
                _ => self.read_letter(c, mark, letter, &mut block)?,
            }
            self.calculator.charge(WORD);
        }
        Ok(block)
    }

    /// Reads `$` and the number of a spindle; the only spindle is `$0`. Returns whether there is a number.
    fn read_spindle(&self, c: &mut Cursor<'_>) -> Result<bool, Fault> {
        let mark = c.mark();
        c.bump();
        if !matches!(c.peek(), b'0'..=b'9' | b'-' | b'.') {
            c.back_to(mark);
            return Ok(false);
        }
        let given = self.read_value(c, mark)?;
        if given.number.real() != 0.0 {
            return given.span.fault(NcErrorKind::Known { what: "a second spindle", hint: "$0" });
        }
        Ok(true)
    }

    /// Reads a letter that is not an axis, with its value.
    fn read_letter(
        &self,
        c: &mut Cursor<'_>,
        mark: usize,
        letter: u8,
        block: &mut Block<AXES>,
    ) -> Result<(), Fault> {
        let given = self.read_value(c, mark)?;
        self.note_point(c, given, letter, block);
        match block.slot(letter) {
            Some(slot) if slot.is_none() => *slot = Some(given),
            _ => return given.span.fault(NcErrorKind::Twice("a letter")),
        }
        Ok(())
    }

    /// Notes whether the number has a decimal point.
    fn note_point(&self, c: &Cursor<'_>, given: Given, letter: u8, block: &mut Block<AXES>) {
        if self.setup.foreign.dialect().is_fanuc() && !c.part(given.span).contains(&b'.') {
            block.pointless |= 1_u32.wrapping_shl(u32::from(letter.wrapping_sub(b'A')));
        }
    }

    /// Handles text that does not begin with a letter.
    fn no_address(&self, c: &mut Cursor<'_>, byte: u8) -> Result<Block<AXES>, Fault> {
        match byte {
            b'$' => c.rest_of_word().fault(NcErrorKind::Known {
                what: "a command to the controller",
                hint: "a program without it",
            }),
            b',' => c.expected("a decimal point, not a comma"),
            b'*' => c.rest_of_word().fault(NcErrorKind::Checksum),
            b'@' | b'^' => {
                c.rest_of_word().fault(NcErrorKind::Known { what: "a polar coordinate", hint: "X and Y" })
            }
            _ => c.expected("an address such as G, X, F or M"),
        }
    }

    fn read_axis(
        &self,
        c: &mut Cursor<'_>,
        mark: usize,
        letter: u8,
        block: &mut Block<AXES>,
    ) -> Result<(), Fault> {
        let Some(axis) = self.letters.axis(letter) else {
            if letter == b'U' && self.setup.foreign.dialect().is_fanuc() {
                return self.read_letter(c, mark, letter, block);
            }
            return c.since(mark).fault(NcErrorKind::AxisNotHere);
        };
        let given = self.read_value(c, mark)?;
        self.note_point(c, given, letter, block);
        block.first.get_or_insert(given.span);
        match block.axes.get_mut(axis) {
            Some(slot) if slot.is_none() => *slot = Some(given),
            _ => return given.span.fault(NcErrorKind::Twice("axis")),
        }
        Ok(())
    }

    /// Reads an assignment such as `#5=…`.
    fn read_assignment(&self, c: &mut Cursor<'_>, block: &mut Block<AXES>) -> Result<(), Fault> {
        if !functions::DIALECTS.is_built() {
            return c.here().fault(NO_PARAMETERS);
        }
        let mark = c.mark();
        let target = self.target(c)?;
        c.require(b'=', "= behind the parameter")?;
        let value = self.evaluate(c)?;
        let full = Fault { span: c.since(mark), kind: NcErrorKind::BlockTooFull };
        block.assigned.push((target, value)).map_err(|_| full)
    }

    /// Reads the value after a letter: a number or an expression. Blanks inside are ignored.
    fn read_value(&self, c: &mut Cursor<'_>, mark: usize) -> Result<Given, Fault> {
        let negative = c.peek() == b'-';
        let at = c.mark();
        if negative || c.peek() == b'+' {
            c.bump();
        }
        if matches!(c.peek_upper(), b'0'..=b'9' | b'.') {
            return literal(c, mark, negative);
        }
        if matches!(c.peek_upper(), b'#' | b'[')
            || c.peek().is_ascii_alphabetic() && c.next().is_ascii_alphabetic()
        {
            if self.setup.foreign.dialect().is_fanuc() {
                return c.here().fault(MACRO);
            }
            if !functions::DIALECTS.is_built() {
                return c.here().fault(NO_PARAMETERS);
            }
            c.back_to(at);
            let value = self.evaluate(c)?;
            return Ok(Given { number: Number::Real(value), span: c.since(mark) });
        }
        c.expected("a number")
    }

    /// Reads G or M and its number.
    fn read_code(
        &self,
        c: &mut Cursor<'_>,
        mark: usize,
        letter: u8,
        block: &mut Block<AXES>,
    ) -> Result<(), Fault> {
        let given = self.read_value(c, mark)?;
        let span = given.span;
        let unknown = Fault { span, kind: NcErrorKind::UnknownCode(self.setup.foreign.dialect().name()) };
        let tenths = tenths(given.number).ok_or(unknown)?;
        let word = find(self.setup.foreign.dialect(), letter, tenths).ok_or(unknown)?;
        if let Err(hint) = word.is_built() {
            return span.fault(NcErrorKind::Known { what: word.text, hint });
        }
        match block.said.get_mut(usize::from(word.group)) {
            Some(slot) if slot.is_none() => *slot = Some(Said { word, number: tenths / 10, span }),
            _ => return span.fault(NcErrorKind::Twice("a word of this modal group")),
        }
        Ok(())
    }
}

/// Skips `/` and the number of its switch, if there is one.
pub(super) fn skip_switch(c: &mut Cursor<'_>) {
    c.bump();
    if matches!(c.peek(), b'1'..=b'9') {
        c.bump();
    }
}

/// Refuses a statement of macro B.
fn no_macro(c: &mut Cursor<'_>) -> Result<(), Fault> {
    let mark = c.mark();
    let word = c.letters();
    let statement = ["IF", "GOTO", "WHILE", "DO", "END", "THEN", "POPEN", "DPRNT", "BPRNT"];
    let is_macro =
        word.bytes().is_empty() && c.peek() == b'#' || statement.iter().any(|statement| word.is(statement));
    c.back_to(mark);
    if is_macro {
        return c.here().fault(MACRO);
    }
    Ok(())
}

/// The error for macro B.
const MACRO: NcErrorKind = NcErrorKind::Known { what: "macro B", hint: "a program without macros" };

/// The error for parameters and expressions in a build without them.
const NO_PARAMETERS: NcErrorKind =
    NcErrorKind::Known { what: "a parameter or an expression", hint: NOT_BUILT };

/// Reads a number without a sign.
pub(super) fn literal(c: &mut Cursor<'_>, mark: usize, negative: bool) -> Result<Given, Fault> {
    let (mut mantissa, mut scale, mut significant) = (0_u64, 0_u8, 0_u8);
    let (mut point, mut digits, mut full) = (false, false, false);
    loop {
        let byte = c.peek();
        let digit = byte.wrapping_sub(b'0');
        if digit > 9 {
            if byte != b'.' || point {
                break;
            }
            point = true;
        } else if significant < DIGITS && scale < DIGITS {
            // The value is below 10^19 and fits into 64 bits.
            mantissa = mantissa.wrapping_mul(10).wrapping_add(u64::from(digit));
            significant += u8::from(mantissa != 0);
            scale += u8::from(point);
            digits = true;
        } else {
            full |= !point;
        }
        c.bump();
    }
    if full {
        return c.since(mark).fault(NcErrorKind::Overflow);
    }
    if !digits {
        return c.expected("a number");
    }
    Ok(Given { number: Number::Decimal { negative, mantissa, scale }, span: c.since(mark) })
}

/// The number of a G or M word in tenths. Returns `None` if the number has more than one digit after the
/// decimal point.
fn tenths(number: Number) -> Option<u16> {
    if let Number::Real(value) = number {
        let tenths = real::round(value * 10.0);
        return (real::abs(value * 10.0 - tenths) < 1e-3 && (0.0..10_000.0).contains(&tenths))
            .then_some(tenths as u16);
    }
    let Number::Decimal { negative: false, mantissa, scale } = number else { return None };
    let (mut tenths, mut scale) = (mantissa.checked_mul(10)?, scale);
    while scale > 0 {
        if tenths % 10 != 0 {
            return None;
        }
        (tenths, scale) = (tenths / 10, scale - 1);
    }
    u16::try_from(tenths).ok()
}

/// A line number without its fraction.
fn whole_part(number: Number) -> u32 {
    let Number::Decimal { mantissa, scale, .. } = number else { return 0 };
    let power = 10_u64.saturating_pow(u32::from(scale));
    u32::try_from(mantissa.checked_div(power).unwrap_or(0)).unwrap_or(u32::MAX)
}

//! The words of a line, by modal group and by letter; nothing is carried out yet.
use super::words::{WordEntry, find, group};
use crate::nc::block::Given;
use crate::nc::cursor::Cursor;
use crate::nc::interpreter::Interpreter;
use crate::nc::number::Number;
use crate::nc::{Fault, NcErrorKind, Span};

/// Letters of the alphabet.
const LETTERS: usize = 26;

/// A G or M word that stands in the line.
#[derive(Clone, Copy)]
pub(super) struct Said {
    pub word: &'static WordEntry,
    /// M100…M199 share an entry.
    pub number: u16,
    pub span: Span,
}

/// The words of a line.
pub(super) struct Block<const AXES: usize> {
    pub axes: [Option<Given>; AXES],
    /// The first axis word.
    pub first: Option<Span>,
    values: [Option<Given>; LETTERS],
    said: [Option<Said>; group::COUNT],
}

/// Work of a word, as [`crate::nc::calculator`] counts it.
const WORD: u32 = 8;

/// Digits that a number keeps; places behind the point.
const DIGITS: u8 = 19;

impl<const AXES: usize> Block<AXES> {
    const fn new() -> Self {
        Self { axes: [None; AXES], first: None, values: [None; LETTERS], said: [None; group::COUNT] }
    }

    /// The word of a modal group.
    pub fn said(&self, group: u8) -> Option<Said> {
        self.said.get(usize::from(group)).copied().flatten()
    }

    fn slot(&mut self, letter: u8) -> Option<&mut Option<Given>> {
        self.values.get_mut(usize::from(letter.wrapping_sub(b'A')))
    }

    /// The value behind a letter, which is used.
    pub fn take(&mut self, letter: u8) -> Option<Given> {
        self.slot(letter)?.take()
    }

    /// The value behind a letter.
    pub fn value(&self, letter: u8) -> Option<Given> {
        self.values.get(usize::from(letter.wrapping_sub(b'A'))).copied().flatten()
    }

    /// That every value was used by something.
    pub fn is_used_up(&self) -> Result<(), Fault> {
        let left = self.values.iter().flatten().map(|given| given.span).min_by_key(|span| span.at);
        match left {
            Some(span) => span.fault(NcErrorKind::Unused),
            None => Ok(()),
        }
    }

    /// Whether nothing stands in the line.
    pub fn is_empty(&self) -> bool {
        self.first.is_none()
            && self.values.iter().all(Option::is_none)
            && self.said.iter().all(Option::is_none)
    }
}

impl<const AXES: usize> Interpreter<AXES> {
    /// Reads the words of a line.
    pub(super) fn read_block(&mut self, c: &mut Cursor<'_>) -> Result<Block<AXES>, Fault> {
        let mut block = Block::new();
        let mut numbered = false;
        while !c.at_end() {
            let mark = c.mark();
            let letter = c.peek_upper();
            if !letter.is_ascii_alphabetic() {
                return self.no_address(c, letter);
            }
            c.bump();
            match letter {
                b'G' | b'M' => self.read_code(c, mark, letter, &mut block)?,
                b'N' => {
                    let given = read_value(c, mark)?;
                    if numbered {
                        return given.span.fault(NcErrorKind::Twice("N"));
                    }
                    numbered = true;
                    self.n = whole_part(given.number);
                }
                b'O' => self.read_program_number(c, mark, &block)?,
                b'A' | b'B' | b'C' | b'U'..=b'Z' => self.read_axis(c, mark, letter, &mut block)?,
                _ => {
                    let given = read_value(c, mark)?;
                    match block.slot(letter) {
                        Some(slot) if slot.is_none() => *slot = Some(given),
                        _ => return given.span.fault(NcErrorKind::Twice("a letter")),
                    }
                }
            }
            self.calculator.charge(WORD);
        }
        Ok(block)
    }

    /// What does not begin with a letter.
    fn no_address(&self, c: &mut Cursor<'_>, byte: u8) -> Result<Block<AXES>, Fault> {
        match byte {
            b'#' | b'[' => c.rest_of_word().fault(PARAMETERS),
            b'$' => c.rest_of_word().fault(NcErrorKind::Known {
                what: "a command to the controller",
                hint: "a program without it",
            }),
            b'*' => c.rest_of_word().fault(NcErrorKind::Checksum),
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
            return c.since(mark).fault(NcErrorKind::AxisNotHere);
        };
        let given = read_value(c, mark)?;
        block.first.get_or_insert(given.span);
        match block.axes.get_mut(axis) {
            Some(slot) if slot.is_none() => *slot = Some(given),
            _ => return given.span.fault(NcErrorKind::Twice("axis")),
        }
        Ok(())
    }

    /// `O0001`: a program number. What else begins with O is a subroutine, a loop or a branch.
    fn read_program_number(&self, c: &mut Cursor<'_>, mark: usize, block: &Block<AXES>) -> Result<(), Fault> {
        if c.peek().is_ascii_digit() {
            let _ = read_value(c, mark)?;
            if c.at_end() && block.is_empty() {
                return Ok(());
            }
        }
        c.back_to(mark);
        c.here().fault(NcErrorKind::Known {
            what: "O word",
            hint: "a program without subroutines, loops and branches",
        })
    }

    /// G or M and its number.
    fn read_code(
        &self,
        c: &mut Cursor<'_>,
        mark: usize,
        letter: u8,
        block: &mut Block<AXES>,
    ) -> Result<(), Fault> {
        let given = read_value(c, mark)?;
        let span = given.span;
        let unknown = Fault { span, kind: NcErrorKind::UnknownCode(self.setup.foreign.dialect.name()) };
        let tenths = tenths(given.number).ok_or(unknown)?;
        let word = find(self.setup.foreign.dialect, letter, tenths).ok_or(unknown)?;
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

/// What parameters and expressions are refused with.
const PARAMETERS: NcErrorKind =
    NcErrorKind::Known { what: "parameters and expressions (#, [ ])", hint: "a plain number" };

/// A number behind a letter. Blanks inside do not count.
fn read_value(c: &mut Cursor<'_>, mark: usize) -> Result<Given, Fault> {
    let negative = match c.peek() {
        b'-' => {
            c.bump();
            true
        }
        b'+' => {
            c.bump();
            false
        }
        _ => false,
    };
    if matches!(c.peek(), b'#' | b'[') {
        return c.rest_of_word().fault(PARAMETERS);
    }
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
            // Below 10^19, which 64 bits hold.
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

/// The number of a G or M word in tenths, if it has one place at most.
fn tenths(number: Number) -> Option<u16> {
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

/// A line number, without its fraction.
fn whole_part(number: Number) -> u32 {
    let Number::Decimal { mantissa, scale, .. } = number else { return 0 };
    let power = 10_u64.saturating_pow(u32::from(scale));
    u32::try_from(mantissa.checked_div(power).unwrap_or(0)).unwrap_or(u32::MAX)
}

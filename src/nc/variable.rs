//! `V.` variables of ISG's language (feature `plc`).
//!
//! | name | meaning | lifetime |
//! |---|---|---|
//! | `V.E.name` | a variable of the application ([`crate::variable`]) | as the application keeps it |
//! | `V.P.name` | a variable of the program | to the end of the program |
//! | `V.L.name` | a variable of the current subroutine, or of the main program | to its return |
//! | `V.RTG.LOOP.ENABLED` | whether real-time loops repeat | |
//! | `V.G.BLOCK_NR`, `V.G.FEEDRATE` | N number of the block before; F in mm/min. Read only | |
//! | `V.G.M_FCT[n]…` | synchronisation of a function: `synch_variable` | to the end of the program |
//!
//! The table of P parameters also holds the `V.P.` and `V.L.` variables, at indices above all P numbers. For
//! the other variables, the decoder reads all values of a line before it interprets the line, and writes
//! values after the line.
use super::cursor::Cursor;
use super::flow::hash;
use super::interpreter::Interpreter;
use super::synch_variable;
use super::{Fault, NcErrorKind, Span};
use crate::variable::{LoopFlag, Variable};
use core::cell::Cell;
use heapless::Vec;

/// Longest name after `V.`, characters.
const NAME: usize = 63;

/// Largest number of V.E., V.RTG. and V.G. variables that a line may read.
const READS: usize = 8;

/// First index of V.P. and V.L. in the table of parameters.
pub(super) const NAMED: u32 = 1 << 31;

/// Bits of a name's hash. A program has about ten names, so two names with equal hashes are not expected.
const HASH: u32 = (1 << 27) - 1;

/// Largest number of open subroutine calls, including the main program. V.P. uses the next number.
const LEVELS: u32 = 15;

/// The name after `V.`, in upper case.
pub(super) struct Name {
    letters: Vec<u8, NAME>,
}

/// Where the value of a variable is stored.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Place {
    /// In the table of parameters.
    Own(u32),
    /// Outside the decoder; the value is the hash of the name.
    Outside(u32),
}

/// Whether a V. variable is at the cursor, and not an axis with the name V.
pub(super) fn is_here(c: &mut Cursor<'_>) -> bool {
    let mut ahead = *c;
    if ahead.peek_upper() != b'V' || ahead.next() != b'.' {
        return false;
    }
    ahead.bump();
    ahead.next().is_ascii_alphabetic()
}

/// Reads the name of a variable.
pub(super) fn name(c: &mut Cursor<'_>) -> Result<Name, Fault> {
    let mark = c.mark();
    c.require(b'V', "V. and a name").or_else(|_| c.require(b'v', "V. and a name"))?;
    c.bump();
    let mut letters = Vec::new();
    while c.raw().is_ascii_alphanumeric() || matches!(c.raw(), b'_' | b'.' | b'[') {
        if c.raw() == b'[' {
            if !synch_variable::is_function(&letters) {
                break;
            }
            let code = synch_variable::number(c)?;
            let digits = [code / 100, code / 10 % 10, code % 10].map(|digit| digit as u8 + b'0');
            let [a, b, d] = digits;
            let _ = letters.extend_from_slice(&[b'[', a, b, d, b']']);
            continue;
        }
        if letters.push(c.raw().to_ascii_uppercase()).is_err() {
            return c.since(mark).fault(NcErrorKind::NameTooLong);
        }
        c.bump();
    }
    if c.raw() == b'[' {
        return c.rest_from(mark).fault(NcErrorKind::NotAvailable("array of V. variables"));
    }
    Ok(Name { letters })
}

impl Name {
    fn hash(&self) -> u32 {
        let hash = hash(&self.letters);
        (hash ^ hash >> 32) as u32
    }

    /// Where the variable is stored. `level`: number of open calls.
    pub fn place(&self, level: u8) -> Option<Place> {
        let level = u32::from(level).min(LEVELS - 1);
        match self.letters.as_slice() {
            [b'P', b'.', _, ..] => Some(Place::Own(NAMED | self.hash() & HASH)),
            [b'L', b'.', _, ..] => Some(Place::Own(NAMED | (level + 1) << 27 | self.hash() & HASH)),
            _ if synch_variable::parse(&self.letters).is_some() => Some(Place::Outside(self.hash())),
            [b'E', b'.', _, ..] | b"RTG.LOOP.ENABLED" | b"G.BLOCK_NR" | b"G.FEEDRATE" => {
                Some(Place::Outside(self.hash()))
            }
            _ => None,
        }
    }

    /// Why the variable has no value.
    pub fn missing(&self) -> NcErrorKind {
        if synch_variable::is_function(self.letters.get(..7).unwrap_or(&[])) {
            synch_variable::missing(&self.letters)
        } else {
            NcErrorKind::NoVariable
        }
    }
}

/// The decoder's access to outside variables.
#[derive(Clone, Copy)]
pub(crate) struct Externals<'a> {
    pub variables: &'a [Variable],
    pub flag: Option<&'a LoopFlag>,
}

impl<'a> Externals<'a> {
    pub const NONE: Self = Self { variables: &[], flag: None };

    /// Whether the application has given any outside variables.
    pub const fn exist(&self) -> bool {
        !self.variables.is_empty() || self.flag.is_some()
    }

    fn find(&self, name: &[u8]) -> Option<&'a Variable> {
        self.variables.iter().find(|variable| variable.is(name))
    }
}

/// Values of outside variables that the current line reads.
pub(super) struct Looked {
    /// Number of open calls.
    pub level: Cell<u8>,
    values: [Cell<(u32, f64)>; READS],
    count: Cell<usize>,
}

impl Looked {
    pub const fn new() -> Self {
        Self { level: Cell::new(0), values: [const { Cell::new((0, 0.0)) }; READS], count: Cell::new(0) }
    }

    fn put(&self, hash: u32, value: f64) {
        if let Some(slot) = self.values.get(self.count.get()) {
            slot.set((hash, value));
            self.count.set(self.count.get() + 1);
        }
    }

    /// The value of an outside variable.
    pub fn get(&self, hash: u32) -> Option<f64> {
        let mut values = self.values.iter().take(self.count.get()).map(Cell::get);
        values.find(|(known, _)| *known == hash).map(|(_, value)| value)
    }
}

/// An assignment of the current line to an outside variable.
#[derive(Clone, Copy)]
pub(super) struct Write {
    /// The name in the line, including `V.`.
    span: Span,
    value: f64,
}

impl<const AXES: usize> Interpreter<AXES> {
    /// Called before a line: drops variables of subroutines that have returned, and reads outside values.
    pub fn look_up(&mut self, line: &[u8], externals: &Externals<'_>) {
        let looked = &self.calculator.looked;
        let level = self.flow.frames.len() as u8;
        let before = looked.level.replace(level);
        looked.count.set(0);
        if level < before {
            let first = NAMED | (u32::from(level) + 2).min(LEVELS) << 27;
            self.calculator.parameters.forget(first, u32::MAX);
        }
        let looked = &self.calculator.looked;
        let mut c = Cursor::new(line);
        while !c.at_end() {
            if !is_here(&mut c) {
                c.bump();
                continue;
            }
            let Ok(name) = name(&mut c) else { continue };
            let value = match name.letters.as_slice() {
                b"RTG.LOOP.ENABLED" => externals.flag.map(|flag| f64::from(u8::from(flag.get()))),
                b"G.BLOCK_NR" => Some(f64::from(self.n)),
                b"G.FEEDRATE" => {
                    let feed = self.modal.feed.map_or(0, |feed| feed.to_bits());
                    Some(feed as f64 / 4_294_967_296.0)
                }
                [b'E', b'.', rest @ ..] => externals.find(rest).map(Variable::get),
                letters => self.function_value(letters),
            };
            if let Some(value) = value {
                looked.put(name.hash(), value);
            }
        }
    }

    /// Carries out `V.… = value`, or stores the assignment until the end of the line.
    #[inline(never)]
    pub fn assign_variable(&mut self, c: &mut Cursor<'_>) -> Result<(), Fault> {
        let mark = c.mark();
        let name = name(c)?;
        let span = c.since(mark);
        let Some(place) = name.place(self.calculator.looked.level.get()) else {
            return span.fault(name.missing());
        };
        c.require(b'=', "= behind the variable")?;
        let value = match () {
            () if c.eat_words("TRUE") => 1.0,
            () if c.eat_words("FALSE") => 0.0,
            () => super::expression::expression(c, &self.calculator)?.real(),
        };
        match place {
            Place::Own(index) => {
                self.calculator.parameters.set(index, value).map_err(|kind| Fault { span, kind })
            }
            Place::Outside(_) if self.written.is_some() => {
                span.fault(NcErrorKind::Twice("a variable outside"))
            }
            Place::Outside(_) => {
                self.written = Some(Write { span, value });
                Ok(())
            }
        }
    }

    /// Called after a line: carries out its assignment.
    pub fn write_out(&mut self, line: &[u8], externals: &Externals<'_>) -> Result<(), Fault> {
        let Some(Write { span, value }) = self.written.take() else { return Ok(()) };
        let mut c = Cursor::new(line);
        c.back_to(usize::from(span.at));
        let name = name(&mut c)?;
        match (name.letters.as_slice(), externals.flag) {
            (b"RTG.LOOP.ENABLED", Some(flag)) => flag.assign(value >= 0.5),
            ([b'E', b'.', rest @ ..], _) => match externals.find(rest) {
                Some(variable) if variable.is_writable() => variable.assign(value),
                Some(_) => return span.fault(NcErrorKind::VariableReadOnly),
                None => return span.fault(NcErrorKind::NoVariable),
            },
            (letters, _) if synch_variable::parse(letters).is_some() => {
                self.set_function(letters, value).map_err(|kind| Fault { span, kind })?;
            }
            ([b'G', ..], _) => return span.fault(NcErrorKind::VariableReadOnly),
            _ => return span.fault(NcErrorKind::NoVariable),
        }
        Ok(())
    }
}

//! Splits bytes into logical lines: drops comments, joins continuation lines, and keeps the place of every
//! byte.
//!
//! A line ends with LF, CR LF or a lone CR. The line end also closes a comment, as on ISG's controllers. If
//! the closing bracket is missing, a warning says so, because the rest of the line belongs to the comment.
#[cfg(feature = "grbl")]
mod comment;
mod skip;

#[cfg(feature = "grbl")]
pub(super) use comment::ForeignComments;

use super::{NcError, NcErrorKind, Place, Span, Text, TextError};
use crate::machine::functions;
use heapless::{String, Vec};

/// Longest logical line in bytes, without comments and outer blanks: 512; 256 in a small build.
pub const LINE_BYTES: usize = if functions::IS_SMALL { 256 } else { 512 };
/// Largest number of continuation lines (and long gaps) in one logical line: 12; 6 in a small build.
pub const CONTINUATIONS: usize = if functions::IS_SMALL { 6 } else { 12 };
/// Bytes read in one call.
const SLICE: usize = 256;
/// U+FEFF in UTF-8.
const BYTE_ORDER_MARK: [u8; 3] = [0xef, 0xbb, 0xbf];
/// Gaps of up to this number of bytes are kept as blanks. A longer gap becomes one blank and an anchor.
const GAP: u32 = 16;

/// The place of a part of the line: its bytes from `index` on are those of the text from `offset` on.
#[derive(Clone, Copy, Debug, Default)]
struct Anchor {
    index: u16,
    line: u32,
    column: u32,
    offset: u32,
    file: u16,
}

/// One logical line.
pub(super) struct Line {
    bytes: [u8; LINE_BYTES],
    /// Number of bytes in use.
    len: usize,
    /// Places of the line's start and of its continuations.
    anchors: Vec<Anchor, { CONTINUATIONS + 1 }>,
}

/// Start of a physical line in the text.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Mark {
    pub offset: u32,
    pub line: u32,
    pub file: u16,
}

impl Mark {
    /// No mark: all bits zero.
    pub const BLANK: Self = Self { offset: 0, line: 0, file: 0 };

    /// The first line of a file.
    pub const fn start_of(file: u16) -> Self {
        Self { offset: 0, line: 1, file }
    }
}

/// The result of one call of [`LineReader::fill`].
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Fill {
    Partial,
    /// The text has no bytes yet.
    Late,
    Line,
    End,
}

impl Line {
    pub const fn new() -> Self {
        Self { bytes: [0; LINE_BYTES], len: 0, anchors: Vec::new() }
    }

    pub fn bytes(&self) -> &[u8] {
        self.bytes.get(..self.len).unwrap_or(&[])
    }

    /// Adds a byte. Returns `false` if there is no room.
    fn push(&mut self, byte: u8) -> bool {
        let slot = self.bytes.get_mut(self.len);
        let fits = slot.is_some();
        if let Some(slot) = slot {
            *slot = byte;
            self.len += 1;
        }
        fits
    }

    /// Adds the leading bytes of `text` that are words with single blanks between them. Returns the number of
    /// bytes.
    #[inline(never)]
    fn push_words(&mut self, text: &[u8]) -> usize {
        let room = self.bytes.get_mut(self.len..).unwrap_or(&mut []);
        let (mut seen, mut last) = (0, BLANK);
        for (slot, &byte) in room.iter_mut().zip(text) {
            let kind = KINDS[usize::from(byte)];
            if kind + last > BLANK {
                break;
            }
            *slot = byte;
            last = kind;
            seen += 1;
        }
        // Without a trailing blank.
        let words = seen - usize::from(seen > 0) * usize::from(last);
        self.len += words;
        words
    }

    /// Notes that the following bytes are those from `place` on in the text. Returns `false` if there is no
    /// room.
    fn anchor(&mut self, place: &Place) -> bool {
        let Place { line, column, offset, file, .. } = *place;
        self.anchors.push(Anchor { index: self.len as u16, line, column, offset, file }).is_ok()
    }

    /// The place of a part of the line.
    #[inline(never)]
    pub fn place(&self, span: Span) -> Place {
        let mut found = Anchor::default();
        for anchor in &self.anchors {
            if anchor.index <= span.at {
                found = *anchor;
            }
        }
        let delta = u32::from(span.at.saturating_sub(found.index));
        Place {
            line: found.line,
            column: found.column + delta,
            offset: found.offset + delta,
            length: span.len,
            file: found.file,
        }
    }

    /// The refusal of a part of the line.
    pub fn error(&self, span: Span, kind: NcErrorKind) -> NcError {
        let mut found = String::new();
        let part = self.bytes().get(usize::from(span.at)..).unwrap_or(&[]);
        for byte in part.iter().take(usize::from(span.len)) {
            let _ = found.push(char::from(*byte)); // longer words are cut
        }
        NcError { place: self.place(span), kind, found, axes: String::new() }
    }

    pub fn clear(&mut self) {
        self.len = 0;
        self.anchors.clear();
    }
}

/// Kinds of bytes outside comments: part of a word, a blank, or a byte with special treatment.
const WORD: u8 = 0;
const BLANK: u8 = 1;
const OTHER: u8 = 2;

const KINDS: [u8; 256] = {
    let mut kinds = [OTHER; 256];
    let mut byte = b'!';
    while byte < 0x7f {
        if !matches!(byte, b'(' | b')' | b';' | b'\\') {
            kinds[byte as usize] = WORD;
        }
        byte += 1;
    }
    kinds[b' ' as usize] = BLANK;
    kinds
};

/// Reads logical lines; each call reads a slice of the text.
pub(super) struct LineReader<T> {
    text: T,
    chunk: [u8; 64],
    used: u8,
    filled: u8,
    file: u16,
    /// Offset of the next byte.
    offset: u32,
    line: u32,
    /// Offset of the physical line's start.
    line_offset: u32,
    fresh: bool,
    logical: Logical,
    /// Whether the current line is refused before it is complete.
    refused: bool,
    /// Whether the rest of a refused line is being skipped.
    skips: bool,
    /// State of comments in LinuxCNC and Grbl programs.
    #[cfg(feature = "grbl")]
    pub foreign: ForeignComments,
}

/// State of the current logical line.
#[derive(Clone, Copy)]
struct Logical {
    /// Start of the logical line.
    start: Mark,
    comment: u16,
    /// The parenthesis that opened the outermost comment.
    opened: Place,
    /// The first comment of the logical line without a closing parenthesis.
    unclosed: Option<Place>,
    remark: bool,
    continued: bool,
    /// Number of bytes dropped since the last kept one, and whether a line end is among them.
    gap: u32,
    broken: bool,
    /// Whether only blanks have followed the last kept byte.
    in_words: bool,
}

impl Logical {
    const NONE: Self = Self {
        start: Mark::start_of(0),
        comment: 0,
        opened: Place::NONE,
        unclosed: None,
        remark: false,
        continued: false,
        gap: 0,
        broken: false,
        in_words: false,
    };
}

impl<T: Text> LineReader<T> {
    pub const fn new(text: T) -> Self {
        Self {
            text,
            chunk: [0; 64],
            used: 0,
            filled: 0,
            file: 0,
            offset: 0,
            line: 1,
            line_offset: 0,
            fresh: true,
            logical: Logical::NONE,
            refused: false,
            skips: false,
            #[cfg(feature = "grbl")]
            foreign: ForeignComments::ISG,
        }
    }

    /// Continues to read at the start of a line.
    pub fn seek(&mut self, mark: Mark) {
        self.used = 0;
        self.filled = 0;
        self.file = mark.file;
        self.offset = mark.offset;
        self.line = mark.line;
        self.line_offset = mark.offset;
        self.fresh = true;
        self.refused = false;
        self.skips = false;
    }

    /// Start of the last logical line.
    pub const fn line_start(&self) -> Mark {
        self.logical.start
    }

    /// Start of the next line.
    pub const fn next_start(&self) -> Mark {
        Mark { offset: self.offset, line: self.line, file: self.file }
    }

    /// Place of the next byte.
    pub const fn here(&self) -> Place {
        let column = self.offset.wrapping_sub(self.line_offset).wrapping_add(1);
        Place { line: self.line, column, offset: self.offset, length: 0, file: self.file }
    }

    /// Begins a logical line; the text before the line may be dropped.
    fn begin(&mut self) {
        self.text.pass(self.file, self.offset);
        self.logical.start = self.next_start();
        self.fresh = false;
        self.logical.comment = 0;
        self.logical.unclosed = None;
        self.logical.remark = false;
        self.logical.continued = false;
        self.logical.gap = 0;
        self.logical.broken = false;
        self.logical.in_words = false;
        #[cfg(feature = "grbl")]
        self.foreign.clear();
    }

    /// Handles the end of a text line, whose first byte was read at `here`. Returns whether the logical line
    /// ends too.
    fn end_line(&mut self, byte: u8, here: Place) -> Result<bool, TextError> {
        if byte == b'\r'
            && let Err(error) = self.step_over_line_feed()
        {
            self.offset = here.offset;
            return Err(error);
        }
        self.line = self.line.wrapping_add(1);
        self.line_offset = self.offset;
        self.close_comment();
        self.logical.remark = false;
        if !self.logical.continued {
            self.fresh = true;
            return Ok(true);
        }
        self.logical.continued = false;
        self.logical.gap = self.logical.gap.saturating_add(1);
        self.logical.broken = true;
        Ok(false)
    }

    /// Reads until a logical line is complete, at most a slice.
    pub fn fill(&mut self, line: &mut Line) -> Result<Fill, NcError> {
        if self.skips {
            return self.skip();
        }
        if self.fresh {
            line.clear();
            self.begin();
        }
        let mut budget = SLICE;
        while budget > 0 {
            if let Err(error) = self.refill() {
                return self.missing(error);
            }
            let run = self.take_run(line, budget);
            if run > 0 {
                if self.step_over_line_end() {
                    return Ok(Fill::Line);
                }
                budget -= run;
                continue;
            }
            budget -= 1;
            let byte = match self.next_byte() {
                Ok(byte) => byte,
                Err(error) => return self.missing(error),
            };
            let Some(byte) = byte else {
                self.fresh = true;
                self.close_comment();
                let nothing = self.offset == self.logical.start.offset;
                return Ok(if nothing { Fill::End } else { Fill::Line });
            };
            let here = Place { length: 1, ..self.here() };
            self.offset = self.offset.wrapping_add(1);
            if matches!(byte, b'\n' | b'\r') {
                match self.end_line(byte, here) {
                    Ok(true) => return Ok(Fill::Line),
                    Ok(false) => continue,
                    Err(error) => return self.missing(error),
                }
            }
            if byte == BYTE_ORDER_MARK[0] && here.offset == 0 {
                (self.used, self.filled) = (0, 0);
                match self.is_marked() {
                    Ok(marked) if marked => {
                        self.offset = BYTE_ORDER_MARK.len() as u32;
                        continue;
                    }
                    Ok(_) => {}
                    Err(error) => {
                        self.offset = here.offset;
                        return self.missing(error);
                    }
                }
            }
            if byte < b' ' && byte != b'\t' || byte == 0x7f {
                return Err(self.refuse(here, NcErrorKind::ControlByte(byte)));
            }
            if self.dropped(byte, here) {
                self.logical.gap = self.logical.gap.saturating_add(1);
                self.logical.in_words &=
                    self.logical.comment == 0 && !self.logical.remark && !self.logical.continued;
            } else if byte >= 0x80 {
                return Err(self.refuse(here, NcErrorKind::ForeignByte(byte)));
            } else if self.logical.continued {
                let mut error = self.refuse(here, NcErrorKind::Expected("the end of the line after \\"));
                let _ = error.found.push(char::from(byte));
                return Err(error);
            } else {
                if let Err(kind) = keep(line, byte, here, self.logical.gap, self.logical.broken) {
                    return Err(self.refuse(here, kind));
                }
                self.logical.gap = 0;
                self.logical.broken = false;
                self.logical.in_words = true;
            }
        }
        Ok(Fill::Partial)
    }

    /// Takes the usual text: words with blanks before and between them, at most `budget` bytes. Returns the
    /// number of bytes.
    fn take_run(&mut self, line: &mut Line, budget: usize) -> usize {
        let rest = self.chunk.get(usize::from(self.used)..usize::from(self.filled)).unwrap_or(&[]);
        let rest = rest.get(..budget).unwrap_or(rest);
        if !self.logical.in_words {
            // The first byte of a line begins a word. The first byte of a file may belong to a byte order
            // mark.
            let begins = rest.first().is_some_and(|byte| KINDS[usize::from(*byte)] == WORD);
            if !begins
                || self.offset != self.logical.start.offset
                || self.offset == 0
                || !line.anchor(&self.here())
            {
                return 0;
            }
            self.logical.in_words = true;
        }
        if self.logical.gap > GAP {
            return 0;
        }
        let before = line.len;
        for _ in 0..self.logical.gap {
            line.push(b' ');
        }
        let run = line.push_words(rest);
        if run == 0 {
            // The byte after the blanks is not known yet.
            line.len = before;
            return 0;
        }
        self.logical.gap = 0;
        self.used += run as u8;
        self.offset = self.offset.wrapping_add(run as u32);
        run
    }

    /// Skips a line feed directly after a word, which ends the line. Returns `false` if there is none.
    fn step_over_line_end(&mut self) -> bool {
        let next = if self.used < self.filled { self.chunk.get(usize::from(self.used)) } else { None };
        if next != Some(&b'\n') {
            return false;
        }
        self.used += 1;
        self.offset = self.offset.wrapping_add(1);
        self.line = self.line.wrapping_add(1);
        self.line_offset = self.offset;
        self.fresh = true;
        true
    }

    /// Handles comments and continuations. Returns `true` for a byte that is not part of the line.
    fn dropped(&mut self, byte: u8, here: Place) -> bool {
        #[cfg(feature = "grbl")]
        if self.foreign.is_on {
            return self.foreign_dropped(byte, here);
        }
        match byte {
            _ if self.logical.remark => true,
            b'(' => {
                if self.logical.comment == 0 {
                    self.logical.opened = here;
                }
                self.logical.comment = self.logical.comment.saturating_add(1);
                true
            }
            b')' if self.logical.comment > 0 => {
                self.logical.comment -= 1;
                true
            }
            _ if self.logical.comment > 0 => true,
            b';' => {
                self.logical.remark = true;
                true
            }
            b' ' | b'\t' => true,
            b'\\' => {
                self.logical.continued = true;
                true
            }
            _ => false,
        }
    }

    /// Closes open comments at the line end.
    fn close_comment(&mut self) {
        if self.logical.comment > 0 {
            self.logical.unclosed.get_or_insert(self.logical.opened);
            self.logical.comment = 0;
        }
    }

    /// The first comment of the last line that lacks a closing parenthesis.
    pub const fn unclosed(&self) -> Option<Place> {
        self.logical.unclosed
    }

    /// Skips the LF of CR LF.
    fn step_over_line_feed(&mut self) -> Result<(), TextError> {
        match self.next_byte()? {
            Some(b'\n') => self.offset = self.offset.wrapping_add(1),
            // If it is not read yet, the byte is still in the chunk.
            Some(_) => self.used = self.used.saturating_sub(1),
            None => {}
        }
        Ok(())
    }

    /// A refusal of an earlier part of the text.
    pub fn error_at(&mut self, place: Place, kind: NcErrorKind) -> NcError {
        let mut error = refusal(place, kind);
        let mut buffer = [0; 24];
        let wanted = usize::from(place.length).min(buffer.len());
        let part = buffer.get_mut(..wanted);
        let count = part.and_then(|b| self.text.read(place.file, place.offset, b).ok()).unwrap_or(0);
        for byte in buffer.iter().take(count) {
            let _ = error.found.push(char::from(*byte));
        }
        error
    }

    /// The file with this name, if there is one.
    pub fn open(&mut self, name: &str) -> Result<Option<u16>, TextError> {
        self.text.open(name)
    }

    /// Whether the file begins with a byte order mark.
    fn is_marked(&mut self) -> Result<bool, TextError> {
        for (expected, at) in BYTE_ORDER_MARK.iter().zip(0..) {
            let mut single = [0];
            if self.text.read(self.file, at, &mut single)? == 0 || single[0] != *expected {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// Refuses the current line before it is complete: its rest is skipped when the program continues.
    #[cold]
    fn refuse(&mut self, place: Place, kind: NcErrorKind) -> NcError {
        (self.refused, self.logical.continued) = (true, false);
        refusal(place, kind)
    }

    /// Handles text that is not available: the program is refused, or continues later from the same byte.
    fn missing(&mut self, error: TextError) -> Result<Fill, NcError> {
        match error {
            TextError::Failed => Err(refusal(self.here(), NcErrorKind::Unreadable)),
            TextError::Forgotten => Err(self.refuse(self.here(), NcErrorKind::BehindWindow)),
            TextError::NotYet => Ok(Fill::Late),
        }
    }

    /// Reads more text if no byte is left.
    fn refill(&mut self) -> Result<(), TextError> {
        if self.used >= self.filled {
            let count = self.text.read(self.file, self.offset, &mut self.chunk)?;
            self.used = 0;
            self.filled = count.min(64) as u8;
        }
        Ok(())
    }

    fn next_byte(&mut self) -> Result<Option<u8>, TextError> {
        self.refill()?;
        let byte =
            if self.used < self.filled { self.chunk.get(usize::from(self.used)).copied() } else { None };
        self.used += u8::from(byte.is_some());
        Ok(byte)
    }
}

/// Adds a byte after a gap. If the gap is shortened, an anchor keeps the place of the byte.
fn keep(line: &mut Line, byte: u8, here: Place, gap: u32, broken: bool) -> Result<(), NcErrorKind> {
    let long = Err(NcErrorKind::LineTooLong);
    if line.len == 0 || broken || gap > GAP {
        if line.len > 0 && !line.push(b' ') {
            return long;
        }
        if !line.anchor(&here) {
            return Err(NcErrorKind::TooManyContinuations);
        }
    } else {
        for _ in 0..gap {
            if !line.push(b' ') {
                return long;
            }
        }
    }
    if line.push(byte) { Ok(()) } else { long }
}

/// A refusal of text that is not in the logical line yet.
fn refusal(place: Place, kind: NcErrorKind) -> NcError {
    NcError { place, kind, found: String::new(), axes: String::new() }
}

//! Reads a logical line from left to right. Blanks between words are ignored.
use super::number::{Number, Plain};
use super::{Fault, NcErrorKind, Span};

/// Letters of a word, upper case.
#[derive(Clone, Copy)]
pub(super) struct Word {
    letters: [u8; 24],
    len: u8,
}

impl Word {
    pub fn bytes(&self) -> &[u8] {
        self.letters.get(..usize::from(self.len)).unwrap_or(&[])
    }

    /// Whether the word equals the upper-case word `word`.
    pub fn is(&self, word: &str) -> bool {
        self.bytes() == word.as_bytes()
    }

    fn push(&mut self, byte: u8) {
        if let Some(slot) = self.letters.get_mut(usize::from(self.len)) {
            *slot = byte.to_ascii_uppercase();
            self.len += 1;
        }
    }
}

/// A reading position in a logical line.
#[derive(Clone, Copy)]
pub(super) struct Cursor<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Cursor<'a> {
    pub const fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, at: 0 }
    }

    /// The byte at the cursor, which may be a blank; 0 at the end.
    pub fn raw(&self) -> u8 {
        self.bytes.get(self.at).copied().unwrap_or(0)
    }

    /// The byte after the cursor; 0 at the end.
    pub fn next(&self) -> u8 {
        self.bytes.get(self.at + 1).copied().unwrap_or(0)
    }

    pub fn bump(&mut self) {
        if self.at < self.bytes.len() {
            self.at += 1;
        }
    }

    fn skip_blanks(&mut self) {
        while self.raw() == b' ' {
            self.at += 1;
        }
    }

    /// The next byte that is not blank; 0 at the end.
    #[inline(never)]
    pub fn peek(&mut self) -> u8 {
        self.skip_blanks();
        self.raw()
    }

    /// The next letter in upper case, or another byte, after blanks.
    #[inline(never)]
    pub fn peek_upper(&mut self) -> u8 {
        self.peek().to_ascii_uppercase()
    }

    /// Skips `byte` if it is next.
    #[inline(never)]
    pub fn eat(&mut self, byte: u8) -> bool {
        let hit = self.peek() == byte;
        if hit {
            self.at += 1;
        }
        hit
    }

    pub fn at_end(&mut self) -> bool {
        self.peek() == 0
    }

    /// Index of the next byte that is not blank.
    #[inline(never)]
    pub fn mark(&mut self) -> usize {
        self.mark_at_once()
    }

    /// As [`Self::mark`], inlined for speed.
    #[cfg_attr(feature = "fast", inline(always))]
    pub fn mark_at_once(&mut self) -> usize {
        self.skip_blanks();
        self.at
    }

    /// Goes back to a mark.
    pub fn back_to(&mut self, mark: usize) {
        self.at = mark;
    }

    /// The span from `mark` to the cursor, without blanks at the end.
    #[inline(never)]
    pub fn since(&self, mark: usize) -> Span {
        let mut end = self.at;
        while end > mark && self.bytes.get(end - 1) == Some(&b' ') {
            end -= 1;
        }
        Span { at: mark as u16, len: (end - mark) as u16 }
    }

    /// As [`Self::since`], if no blank is before the cursor.
    pub fn word_from(&self, mark: usize) -> Span {
        Span { at: mark as u16, len: self.at.wrapping_sub(mark) as u16 }
    }

    /// The word at the cursor: letters and digits, or one byte; empty at the end.
    #[inline(never)]
    pub fn here(&mut self) -> Span {
        let mark = self.mark();
        let mut end = mark;
        while self.bytes.get(end).is_some_and(|b| b.is_ascii_alphanumeric() || matches!(b, b'_' | b'.')) {
            end += 1;
        }
        if end == mark && mark < self.bytes.len() {
            end += 1;
        }
        Span { at: mark as u16, len: (end - mark) as u16 }
    }

    /// The word at the cursor up to the next blank, including a sign or bracket at its front.
    #[inline(never)]
    pub fn rest_of_word(&mut self) -> Span {
        let mark = self.mark();
        let mut end = mark;
        while self.bytes.get(end).is_some_and(|b| *b != b' ') {
            end += 1;
        }
        Span { at: mark as u16, len: (end - mark) as u16 }
    }

    /// The text from `mark` to the next blank after the cursor.
    #[cfg(feature = "plc")]
    pub fn rest_from(&self, mark: usize) -> Span {
        let mut end = self.at;
        while self.bytes.get(end).is_some_and(|b| *b != b' ') {
            end += 1;
        }
        Span { at: mark as u16, len: (end - mark) as u16 }
    }

    /// Refuses the word at the cursor.
    pub fn expected<V>(&mut self, what: &'static str) -> Result<V, Fault> {
        self.here().fault(NcErrorKind::Expected(what))
    }

    /// Skips `byte`, or refuses another byte.
    pub fn require(&mut self, byte: u8, what: &'static str) -> Result<(), Fault> {
        if self.eat(byte) { Ok(()) } else { self.expected(what) }
    }

    /// Refuses any text except the end of the line.
    pub fn require_end(&mut self, statement: &'static str) -> Result<(), Fault> {
        if self.at_end() { Ok(()) } else { self.here().fault(NcErrorKind::NotAlone(statement)) }
    }

    /// Reads letters only (functions, operators, `$` words).
    #[inline(never)]
    pub fn letters(&mut self) -> Word {
        self.skip_blanks();
        let mut word = Word { letters: [0; 24], len: 0 };
        while self.raw().is_ascii_alphabetic() {
            word.push(self.raw());
            self.at += 1;
        }
        word
    }

    /// Reads letters, digits and underscores, at most `limit`.
    #[inline(never)]
    pub fn identifier(&mut self, limit: usize) -> Word {
        self.skip_blanks();
        let mut word = Word { letters: [0; 24], len: 0 };
        let mut count = 0;
        while count < limit && (self.raw().is_ascii_alphanumeric() || self.raw() == b'_') {
            word.push(self.raw());
            self.at += 1;
            count += 1;
        }
        word
    }

    /// Skips `words` (upper case, blanks ignored) if they are at the cursor and no letter follows.
    #[inline(never)]
    pub fn eat_words(&mut self, words: &str) -> bool {
        let mark = self.mark();
        for expected in words.bytes() {
            if expected == b' ' {
                self.skip_blanks();
                continue;
            }
            if self.raw().to_ascii_uppercase() != expected {
                self.at = mark;
                return false;
            }
            self.at += 1;
        }
        if self.raw().is_ascii_alphanumeric() || self.raw() == b'_' {
            self.at = mark;
            return false;
        }
        true
    }

    /// Reads digits as a whole number.
    #[inline(never)]
    pub fn whole(&mut self, what: &'static str) -> Result<u32, Fault> {
        let mark = self.mark();
        let mut value = 0_u32;
        let mut fits = true;
        while self.raw().is_ascii_digit() {
            let digit = u32::from(self.raw() - b'0');
            match value.checked_mul(10).and_then(|v| v.checked_add(digit)) {
                Some(v) => value = v,
                None => fits = false,
            }
            self.at += 1;
        }
        let span = self.since(mark);
        if span.len == 0 {
            return self.expected(what);
        }
        if !fits {
            return span.fault(NcErrorKind::Range { what, min: 0, max: u32::MAX, unit: "", above: false });
        }
        Ok(value)
    }

    /// Reads an unsigned decimal number. Digits beyond the 19th significant digit and the 19th decimal are
    /// cut off.
    #[inline(never)]
    pub fn decimal(&mut self) -> Result<Number, Fault> {
        self.skip_blanks();
        match self.plain_decimal() {
            Some(plain) => Ok(plain.number()),
            None => self.any_decimal(),
        }
    }

    /// Reads one to nine digits with at most one decimal point, without E or another point after them.
    /// Otherwise returns `None`, and the cursor stays.
    #[cfg_attr(feature = "fast", inline(always))]
    pub fn plain_decimal(&mut self) -> Option<Plain> {
        let rest = self.bytes.get(self.at..)?;
        let mut mantissa = 0;
        let mut length = digits(rest, &mut mantissa);
        let (mut count, mut scale) = (length, 0);
        if rest.get(length) == Some(&b'.') {
            scale = digits(rest.get(length + 1..)?, &mut mantissa);
            count += scale;
            length += 1 + scale;
        }
        if !(1..=9).contains(&count) || matches!(rest.get(length), Some(b'.' | b'E' | b'e')) {
            return None;
        }
        self.at += length;
        Some(Plain { mantissa, scale: scale as u8 })
    }

    /// Whether the byte before the cursor is a decimal point.
    #[cfg(feature = "fanuc")]
    #[inline(always)]
    pub fn is_behind_point(&self) -> bool {
        self.at.checked_sub(1).and_then(|at| self.bytes.get(at)) == Some(&b'.')
    }

    /// Reads one to nine digits without a decimal point after them.
    #[cfg_attr(feature = "fast", inline(always))]
    pub fn plain_whole(&mut self) -> Option<u32> {
        let rest = self.bytes.get(self.at..)?;
        let mut number = 0;
        let length = digits(rest, &mut number);
        if !(1..=9).contains(&length) || rest.get(length) == Some(&b'.') {
            return None;
        }
        self.at += length;
        Some(number)
    }

    /// Reads any number; the error says why there is none.
    #[inline(never)]
    fn any_decimal(&mut self) -> Result<Number, Fault> {
        let mark = self.mark();
        let (mut mantissa, mut scale, mut significant) = (0_u64, 0_u8, 0_u8);
        let (mut point, mut digits, mut full) = (false, false, false);
        loop {
            let byte = self.raw();
            let digit = byte.wrapping_sub(b'0');
            if digit > 9 {
                if byte != b'.' || point {
                    break;
                }
                point = true;
            } else if significant < 19 && scale < 19 {
                // Below 10^19, which fits into 64 bits.
                mantissa = mantissa.wrapping_mul(10).wrapping_add(u64::from(digit));
                significant += u8::from(mantissa != 0);
                scale += u8::from(point);
                digits = true;
            } else {
                full |= !point;
            }
            self.at += 1;
        }
        if digits && self.raw().eq_ignore_ascii_case(&b'E') {
            let ahead = |n| self.bytes.get(self.at + n).copied().unwrap_or(0);
            let sign = usize::from(matches!(ahead(1), b'+' | b'-'));
            if ahead(1 + sign).is_ascii_digit() {
                self.at += 1 + sign;
                while self.raw().is_ascii_digit() {
                    self.at += 1;
                }
                return self.since(mark).fault(NcErrorKind::Exponent);
            }
        }
        if full {
            return self.since(mark).fault(NcErrorKind::Overflow);
        }
        if !digits {
            self.at = mark;
            return self.expected("a number");
        }
        Ok(Number::Decimal { negative: false, mantissa, scale })
    }
}

/// Appends the leading digits of `text` to `number`, and returns how many there are. With more than nine
/// digits, the number is invalid.
fn digits(text: &[u8], number: &mut u32) -> usize {
    let mut count = 0;
    for byte in text {
        // Handled as a whole word; a byte would be masked again.
        let digit = u32::from(*byte).wrapping_sub(u32::from(b'0'));
        if digit > 9 {
            break;
        }
        *number = number.wrapping_mul(10).wrapping_add(digit);
        count += 1;
    }
    count
}

impl<'a> Cursor<'a> {
    /// The bytes of a part of the line.
    pub fn part(&self, span: Span) -> &'a [u8] {
        let from = usize::from(span.at);
        self.bytes.get(from..from + usize::from(span.len)).unwrap_or(&[])
    }

    /// Whether `byte` comes later in the line.
    pub fn has_ahead(&self, byte: u8) -> bool {
        self.bytes.get(self.at..).unwrap_or(&[]).contains(&byte)
    }

    /// Moves to the end of a part of the line.
    pub fn step_over(&mut self, span: Span) {
        self.at = usize::from(span.at) + usize::from(span.len);
    }
}

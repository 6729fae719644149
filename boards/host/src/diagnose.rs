//! Messages with a place: source line, caret, refused word, expected word.
//!
//! Places count bytes, as the decoder does. Program text may contain any bytes. Bytes that are no text, or
//! that would move the cursor, are shown as one substitute character each. Long lines are cut around the
//! caret.
use anstyle::{AnsiColor, Style};
use std::fmt::Write as _;
use std::io::Read as _;
use std::path::Path;

/// A text with a name.
#[derive(Clone)]
pub struct Source {
    /// The name that the user gave.
    pub name: String,
    /// Its bytes.
    pub text: Vec<u8>,
}

/// The text without the byte 0x1A at its end, by which DOS marks the end of a text.
fn without_end_mark(mut text: Vec<u8>) -> Vec<u8> {
    if text.last() == Some(&0x1a) {
        text.pop();
    }
    text
}

impl Source {
    /// Reads a file.
    pub fn read(path: &Path) -> Result<Self, Vec<Diagnostic>> {
        let name = path.display().to_string();
        match std::fs::read(path) {
            Ok(text) => Ok(Self { name, text: without_end_mark(text) }),
            Err(error) => Err(vec![Diagnostic::error(format!("cannot read {name}: {error}"))]),
        }
    }

    /// Reads the standard input to its end.
    pub fn read_input() -> Result<Self, Vec<Diagnostic>> {
        let mut text = Vec::new();
        match std::io::stdin().lock().read_to_end(&mut text) {
            Ok(_) => Ok(Self { name: "-".into(), text: without_end_mark(text) }),
            Err(error) => Err(vec![Diagnostic::error(format!("cannot read the standard input: {error}"))]),
        }
    }

    /// Line and column (both from 1, the column in bytes) of a byte offset.
    pub fn position(&self, offset: usize) -> (usize, usize) {
        let starts = self.line_starts().take_while(|start| *start <= offset);
        let (number, start) = starts.enumerate().last().unwrap_or((0, 0));
        (number + 1, offset.min(self.text.len()) - start + 1)
    }

    /// Offsets of the first bytes of all lines: after LF, CR LF, or CR alone, as in the decoder.
    fn line_starts(&self) -> impl Iterator<Item = usize> + '_ {
        let next = |at: usize| self.text.get(at).copied();
        let ends = (0..self.text.len()).filter(move |&at| {
            next(at) == Some(b'\n') || next(at) == Some(b'\r') && next(at + 1) != Some(b'\n')
        });
        std::iter::once(0).chain(ends.map(|at| at + 1))
    }

    /// All lines, without their line ends.
    pub fn lines(&self) -> impl Iterator<Item = &[u8]> {
        self.line_starts().map(|start| {
            let line = self.text[start..].split(|byte| matches!(byte, b'\n' | b'\r')).next();
            line.unwrap_or(b"")
        })
    }

    /// The line with this number, from 1; empty if the line does not exist.
    pub fn line(&self, number: usize) -> &[u8] {
        self.lines().nth(number.saturating_sub(1)).unwrap_or(b"")
    }
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Severity {
    Error,
    Warning,
    Note,
}

struct Shown {
    name: String,
    line: usize,
    column: usize,
    excerpt: String,
    caret_at: usize,
    caret_len: usize,
}

/// One message.
pub struct Diagnostic {
    severity: Severity,
    /// Number of the message in ISG's or Glidepath's count; may be empty.
    pub id: String,
    /// The refused word and the reason.
    pub message: String,
    shown: Option<Shown>,
    expected: Option<String>,
}

impl Diagnostic {
    /// An error, which ends the run.
    pub fn error(message: impl Into<String>) -> Self {
        Self::new(Severity::Error, message.into())
    }

    /// A warning.
    pub fn warning(message: impl Into<String>) -> Self {
        Self::new(Severity::Warning, message.into())
    }

    /// A message of the program to the operator.
    pub fn note(message: impl Into<String>) -> Self {
        Self::new(Severity::Note, message.into())
    }

    fn new(severity: Severity, message: String) -> Self {
        Self { severity, id: String::new(), message, shown: None, expected: None }
    }

    /// Adds the number of the message.
    pub fn id(mut self, id: impl Into<String>) -> Self {
        self.id = id.into();
        self
    }

    /// Adds the place: line and column from 1; column and length in bytes.
    pub fn at(mut self, source: &Source, line: usize, column: usize, length: usize) -> Self {
        let (excerpt, caret_at, caret_len) = excerpt(source.line(line), column.max(1) - 1, length);
        self.shown = Some(Shown { name: source.name.clone(), line, column, excerpt, caret_at, caret_len });
        self
    }

    /// Adds the words next to the caret: the expected input.
    pub fn expected(mut self, text: impl Into<String>) -> Self {
        self.expected = Some(text.into());
        self
    }

    /// Line and column from 1; zeros without a place.
    pub fn place(&self) -> (usize, usize) {
        self.shown.as_ref().map_or((0, 0), |shown| (shown.line, shown.column))
    }

    /// The source line of the message as shown: a long line is cut around the caret.
    pub fn excerpt(&self) -> Option<&str> {
        self.shown.as_ref().map(|shown| shown.excerpt.as_str())
    }

    /// Name of the source text.
    pub fn source(&self) -> Option<&str> {
        self.shown.as_ref().map(|shown| shown.name.as_str())
    }

    /// Prints the message on the error output, coloured on a terminal.
    pub fn print(&self) {
        anstream::eprint!("{}", self.render());
    }

    /// The text that [`Self::print`] prints.
    pub fn render(&self) -> String {
        let (word, colour) = match self.severity {
            Severity::Error => ("error", AnsiColor::Red),
            Severity::Warning => ("warning", AnsiColor::Yellow),
            Severity::Note => ("note", AnsiColor::Green),
        };
        let (head, strong, rule) =
            (colour.on_default().bold(), Style::new().bold(), AnsiColor::Blue.on_default().bold());
        let id = if self.id.is_empty() { String::new() } else { format!("[{}]", self.id) };
        let mut out = String::new();
        // Writing to a String cannot fail.
        let _ = writeln!(out, "{head}{word}{id}{head:#}{strong}: {}{strong:#}", self.message);
        if let Some(shown) = &self.shown {
            let number = shown.line.to_string();
            let margin = " ".repeat(number.len());
            let label = self.expected.as_ref().map_or_else(String::new, |text| format!(" {text}"));
            let _ = writeln!(
                out,
                "{margin}{rule}-->{rule:#} {}:{}:{}\n\
                 {margin} {rule}|{rule:#}\n\
                 {rule}{number} |{rule:#} {}\n\
                 {margin} {rule}|{rule:#} {}{head}{}{label}{head:#}",
                shown.name,
                shown.line,
                shown.column,
                shown.excerpt,
                " ".repeat(shown.caret_at),
                "^".repeat(shown.caret_len),
            );
        } else if let Some(expected) = &self.expected {
            let _ = writeln!(out, " {rule}={rule:#} {expected}");
        }
        out
    }
}

/// Highest width of a shown line.
const WIDTH: usize = 120;

/// The printable part of `line` around byte `at`, and start and length of the caret in this part, in
/// characters.
fn excerpt(line: &[u8], at: usize, length: usize) -> (String, usize, usize) {
    // Each character with its first byte; a byte that is no text becomes U+FFFD.
    let mut characters: Vec<(usize, char)> = Vec::new();
    let mut offset = 0;
    for chunk in line.utf8_chunks() {
        for (index, character) in chunk.valid().char_indices() {
            characters.push((offset + index, printable(character)));
        }
        offset += chunk.valid().len();
        for index in 0..chunk.invalid().len() {
            characters.push((offset + index, char::REPLACEMENT_CHARACTER));
        }
        offset += chunk.invalid().len();
    }
    let caret = characters.iter().take_while(|(start, _)| *start < at).count();
    let end = characters.iter().take_while(|(start, _)| *start < at + length).count();
    let from = if characters.len() <= WIDTH { 0 } else { caret.saturating_sub(WIDTH / 2) };
    let to = characters.len().min(from + WIDTH);
    let mut out = String::new();
    if from > 0 {
        out.push('…');
    }
    out.extend(characters[from..to].iter().map(|(_, character)| character));
    if to < characters.len() {
        out.push('…');
    }
    let shift = usize::from(from > 0);
    (out, caret - from + shift, end.min(to).saturating_sub(caret).max(1))
}

fn printable(character: char) -> char {
    match character {
        '\t' => ' ',
        '\0'..='\x1f' => char::from_u32(0x2400 + character as u32).unwrap_or(' '),
        '\x7f' => '␡',
        // C1 controls, and characters that change the writing direction.
        '\u{80}'..='\u{9f}' | '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}' => {
            char::REPLACEMENT_CHARACTER
        }
        _ => character,
    }
}

/// Returns the candidate nearest to `word` by edit distance, if the distance is small enough.
pub fn nearest<'a>(word: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let word = word.to_ascii_lowercase();
    candidates
        .into_iter()
        .map(|candidate| (distance(&word, &candidate.to_ascii_lowercase()), candidate))
        .min_by_key(|(distance, _)| *distance)
        .filter(|(distance, candidate)| *distance <= 2 + candidate.len() / 5)
        .map(|(_, candidate)| candidate)
}

/// Levenshtein distance, by characters.
fn distance(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, x) in a.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, y) in b.iter().enumerate() {
            let substituted = diagonal + usize::from(x != *y);
            diagonal = row[j + 1];
            row[j + 1] = substituted.min(diagonal + 1).min(row[j] + 1);
        }
    }
    row[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn caret_stands_below_the_word() {
        assert_eq!(excerpt(b"N10 G01 X5", 8, 2), ("N10 G01 X5".into(), 8, 2));
        // ä has two bytes and one column, \xff and NUL one each.
        assert_eq!(excerpt(b"\xc3\xa4\xff\0 X5", 5, 2), ("ä\u{fffd}␀ X5".into(), 4, 2));
        // After the end of the line there is still one caret.
        assert_eq!(excerpt(b"N10", 3, 0), ("N10".into(), 3, 1));
    }

    #[test]
    fn long_lines_are_cut_around_the_caret() {
        let mut line = vec![b' '; 10_000];
        line[7000] = b'?';
        let (text, caret, length) = excerpt(&line, 7000, 1);
        assert_eq!(text.chars().nth(caret), Some('?'));
        assert_eq!((text.chars().count(), length), (WIDTH + 2, 1));
    }

    #[test]
    fn near_names_are_suggested() {
        let names = ["dynamik.a_max", "dynamik.vb_max", "vb_eilgang"];
        assert_eq!(nearest("dynamik.amax", names), Some("dynamik.a_max"));
        assert_eq!(nearest("vb_Eilgnag", names), Some("vb_eilgang"));
        assert_eq!(nearest("colour", names), None);
    }
}

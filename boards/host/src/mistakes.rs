//! Lists all mistakes of a program: takes refusals in the order of execution, and returns them in the order
//! of the text.
//!
//! After a refused line the program continues, so that the next mistake is found too. If a line cannot be
//! decoded, its end point is unknown. Later refusals that depend on the position (arcs, software limits) are
//! therefore left out, and their number is reported.
use crate::diagnose::{Diagnostic, Source};
use crate::files::Files;
use crate::program;
use glidepath::channel::Error;
use glidepath::plan::MotionError;

/// Mistakes that are shown without `--mistakes`.
pub const SHOWN: usize = 20;

/// Refusals of one run.
pub struct Mistakes {
    /// Number of refusals that ends the run.
    most: usize,
    found: Vec<Error>,
    /// A line could not be decoded: positions are unknown after this line.
    is_lost: bool,
    /// Number of left-out refusals that depend on the position.
    left_out: usize,
    /// Number of refusals of lines that were already refused.
    repeated: usize,
}

impl Mistakes {
    /// No refusals yet; at least one refusal is accepted.
    pub fn new(most: usize) -> Self {
        Self { most: most.max(1), found: Vec::new(), is_lost: false, left_out: 0, repeated: 0 }
    }

    /// Whether nothing was refused.
    pub fn is_empty(&self) -> bool {
        self.found.is_empty()
    }

    /// Takes a refusal. Returns whether the program continues.
    pub fn add(&mut self, error: Error, files: &Files) -> bool {
        let of_position = match &error {
            Error::SoftwareLimit(..) => true,
            Error::Motion(_, MotionError::Path(path)) => path.concerns_centre(),
            _ => false,
        };
        let ends = matches!(error, Error::ReducedTooSlow | Error::Unplannable);
        if of_position && self.is_lost {
            self.left_out += 1;
            return self.left_out < LEFT_OUT;
        }
        self.is_lost = self.is_lost
            || !matches!(error, Error::Motion(..) | Error::SoftwareLimit(..)) && may_move(files, &error);
        if self.found.iter().any(|known| known.place() == error.place()) {
            // A line of a loop.
            self.repeated += 1;
            return !ends && self.repeated < LEFT_OUT;
        }
        self.found.push(error);
        !ends && self.found.len() < self.most
    }

    /// Whether the program continues after the last refusal.
    pub fn goes_on(&self) -> bool {
        !self.found.is_empty() && self.found.len() < self.most
    }

    /// Whether the last refused line has a known end point: a motion that was decoded.
    pub fn leads_on(&self) -> bool {
        matches!(self.found.last(), Some(Error::Motion(..) | Error::SoftwareLimit(..)))
    }

    /// The messages, in the order of the text.
    pub fn tell(self, files: &Files) -> Vec<Diagnostic> {
        let found = self.found.iter().map(|error| program::refusal(files, error)).collect();
        let mut told = arrange(found, &files.main);
        if self.most > 1 && self.found.len() >= self.most {
            let message = format!("the first {} mistakes are shown; --mistakes N shows more", self.most);
            told.push(Diagnostic::note(message));
        }
        if self.left_out > 0 {
            let message = format!(
                "{} later refusal{} of arcs or software limits left out: the position behind a line that is \
                 not understood is unknown",
                self.left_out,
                program::plural(self.left_out),
            );
            told.push(Diagnostic::note(message));
        }
        told
    }
}

/// Whether the refused line may move an axis: the line is no prose, and has a letter other than N, G or F
/// with a value.
fn may_move(files: &Files, error: &Error) -> bool {
    let place = error.place();
    files.with(place.file, |source| {
        let line = String::from_utf8_lossy(source.line(place.line as usize)).to_uppercase();
        let code = line.split(['(', ';']).next().unwrap_or_default();
        !is_prose(&line) && code.contains(['X', 'Y', 'Z', 'A', 'B', 'C', 'U', 'V', 'W', '@', '#', '$', 'L'])
    })
}

/// Refusals that are left out before the run ends.
const LEFT_OUT: usize = 10_000;

/// Returns the refusals in the order of the text, the main program first. Lines of prose become one message
/// each.
fn arrange(mut found: Vec<Diagnostic>, main: &Source) -> Vec<Diagnostic> {
    found.sort_by_key(|told| {
        let source = told.source().unwrap_or_default();
        (source != main.name, source.to_owned(), told.place())
    });
    let start = percent(&String::from_utf8_lossy(&main.text));
    let prose = |told: &Diagnostic| told.excerpt().is_some_and(is_prose);
    let mut told: Vec<Diagnostic> = Vec::new();
    for mut diagnostic in found {
        if prose(&diagnostic) {
            let word = std::mem::take(&mut diagnostic.message);
            diagnostic.message = format!("this line is text, not NC: {word}");
            diagnostic = diagnostic.expected("expected words such as G01 X10 F600, or a comment in ( )");
        }
        let (line, column) = diagnostic.place();
        if start.is_some_and(|start| line < start) && diagnostic.source() == Some(&main.name) {
            let word = std::mem::take(&mut diagnostic.message);
            diagnostic.message = format!("text before %: {word}");
            diagnostic = diagnostic.expected("expected % in the first line, or ( ) around the text");
        }
        if diagnostic.excerpt().is_some_and(|line| ends_too_early(line, column)) {
            diagnostic = diagnostic.expected("expected no ( in a comment: a comment ends at its first )");
        }
        told.push(diagnostic);
    }
    told
}

/// The line of the first `%`, from 1, if words follow this line: the `%` that begins a program.
fn percent(text: &str) -> Option<usize> {
    let at = text.lines().position(|line| line.trim() == "%")?;
    let code = |line: &str| !line.trim().is_empty() && !line.trim_start().starts_with(['(', ';', '%']);
    text.lines().skip(at + 1).any(code).then_some(at + 1)
}

/// Whether a comment with another `(` in it has ended before the column: the text behind its first `)` counts.
fn ends_too_early(line: &str, column: usize) -> bool {
    let before = line.as_bytes().get(..column.saturating_sub(1)).unwrap_or_default();
    let (mut open, mut nested) = (false, false);
    for byte in before {
        match byte {
            b'(' => {
                nested |= open;
                open = true;
            }
            b')' if open => open = false,
            b';' if !open => return false,
            _ => {}
        }
    }
    nested && !open
}

/// Whether a line reads as prose: at least three words of letters only, two of them with at least four
/// letters, and more such words than words with digits.
fn is_prose(line: &str) -> bool {
    let code = line.split(['(', ';', '%', '#', '"', '=']).next().unwrap_or_default();
    let (mut words, mut long, mut others) = (0, 0, 0);
    for word in code.split_whitespace() {
        let word = word.trim_matches(|letter: char| letter.is_ascii_punctuation());
        if word.chars().all(|letter| letter.is_alphabetic() || letter == '-' || letter == '\'') {
            words += 1;
            long += usize::from(word.chars().count() >= 4);
        } else {
            others += 1;
        }
    }
    words >= 3 && long >= 2 && words > others
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_comment_in_a_comment_is_told() {
        for (line, column, early) in [
            ("(a (b) c)", 8, true),
            ("(a) G0 (b) C1", 12, false),
            ("G1 ((a) X1) Y", 11, true),
            ("; (a (b) c", 8, false),
            ("(a (b", 5, false),
        ] {
            assert_eq!(ends_too_early(line, column), early, "{line}");
        }
    }

    #[test]
    fn the_percent_that_begins_a_program_is_found() {
        for (text, line) in [
            ("name.nc\n%\nG21\nM30\n%\n", Some(2)),
            ("%\nG21\nM30\n%\n", Some(1)),
            ("G21\nM30\n%\n\n(end)\n", None),
            ("G21\nM30\n", None),
        ] {
            assert_eq!(percent(text), line, "{text}");
        }
    }

    #[test]
    fn prose_is_told_from_programs() {
        for line in ["This is a note to the operator", "Dear all, please mill this part."] {
            assert!(is_prose(line), "{line}");
        }
        for line in
            ["N10 G01 X10 Y20 F600", "G0 X Y Z", "N10 (This is a note to the operator)", "$IF P1 GT 2", ""]
        {
            assert!(!is_prose(line), "{line}");
        }
    }
}

//! Warnings and refusals of the library as messages with their place in the text.
use crate::diagnose::Diagnostic;
use crate::files::Files;
use glidepath::channel::Error;
use glidepath::machine::Dialect;
use glidepath::nc::{Head, NcError, NcErrorKind, NcWarning, Place, WORDS};
use std::collections::HashSet;

pub fn place(diagnostic: Diagnostic, files: &Files, place: Place) -> Diagnostic {
    files.with(place.file, |source| {
        diagnostic.at(source, place.line as usize, place.column as usize, usize::from(place.length))
    })
}

/// A refusal of the decoder.
fn refused(files: &Files, error: &NcError) -> Diagnostic {
    let told = explained(files, error.place, &error.to_string(), id(error.kind.id()));
    match error.kind {
        NcErrorKind::AxisNotHere => told.expected(
            "expected --machine with this axis; glidepath machine new --kind 4axis writes one with A",
        ),
        NcErrorKind::NotAvailable(_)
        | NcErrorKind::UnknownG
        | NcErrorKind::UnknownHash
        | NcErrorKind::UnknownWord => match foreign_hint(&error.found) {
            Some(hint) => told.expected(hint),
            None => told,
        },
        _ => told,
    }
}

/// ISG's own words for common words of other dialects.
const IN_ISG: [(&str, &str); 6] = [
    ("G20", "G70 is inch in ISG"),
    ("G21", "G71 is millimetre in ISG"),
    ("G28", "G74 is homing in ISG"),
    ("G64", "#CONTOUR MODE rounds corners in ISG"),
    ("G90.1", "G161 is it in ISG"),
    ("G91.1", "G162 is it in ISG"),
];

/// What to do about a word that ISG's language does not have, and another dialect has.
fn foreign_hint(found: &str) -> Option<String> {
    let word = found.trim().to_uppercase();
    let rest = word.get(1..)?;
    if word.starts_with('#') && rest.starts_with(|c: char| c.is_ascii_digit() || c == '<' || c == '[') {
        return Some("expected a # command of ISG; --dialect linuxcnc reads # parameters".into());
    }
    if word.starts_with('O') && rest.chars().all(|c| c.is_ascii_digit()) {
        return Some(
            "expected a word of ISG; --dialect linuxcnc or fanuc reads O words and O numbers".into(),
        );
    }
    let letter = word.chars().next().filter(|letter| matches!(letter, 'G' | 'M'))?;
    let tenths = (rest.parse::<f64>().ok()? * 10.0).round();
    let entry = WORDS.iter().find(|entry| {
        entry.letter == letter && f64::from(entry.tenths) == tenths && entry.is_built().is_ok()
    })?;
    let dialect = Dialect::ALL.iter().find(|dialect| **dialect != Dialect::Isg && entry.is_in(**dialect))?;
    let number = entry.tenths / 10;
    let written = match entry.tenths % 10 {
        0 => format!("{letter}{number}"),
        tenth => format!("{letter}{number}.{tenth}"),
    };
    let own = IN_ISG.iter().find(|(foreign, _)| *foreign == written).map(|(_, own)| *own);
    let name = dialect.name();
    Some(match own {
        Some(own) => {
            format!("expected a word of ISG: {own}; with --dialect {name} {written} is read: {}", entry.text)
        }
        None => format!("expected a word of ISG; with --dialect {name} {written} is read: {}", entry.text),
    })
}

/// The expected word stands next to the caret.
fn explained(files: &Files, at: Place, text: &str, id: String) -> Diagnostic {
    let split = text.find(" expected ").map(|at| text.split_at(at));
    match split {
        Some((what, expected)) => {
            let what = what.trim_end_matches([':', ';', ',']);
            place(Diagnostic::error(what).id(id), files, at).expected(expected.trim_start())
        }
        None => place(Diagnostic::error(text).id(id), files, at),
    }
}

/// ISG's number of a message, if it has one.
fn id(number: u32) -> String {
    if number == 0 { String::new() } else { number.to_string() }
}

/// A warning of the decoder or the planner.
pub fn remark(files: &Files, warning: &NcWarning) -> Diagnostic {
    place(Diagnostic::warning(warning.to_string()).id(id(warning.id())), files, warning.place)
}

/// A refusal of the planner.
pub fn refusal(files: &Files, error: &Error) -> Diagnostic {
    match error {
        Error::Nc(error) => refused(files, error),
        Error::ReducedTooSlow | Error::Unplannable => Diagnostic::error(error.to_string()),
        Error::NotAvailable(at, name) if name.starts_with("probing") => {
            explained(files, *at, &error.to_string(), String::new()).expected(
                "expected a machine with a probe; the simulated controller of glidepath serve has one",
            )
        }
        // All other refusals have a place.
        _ => explained(files, error.place(), &error.to_string(), id(error.id())),
    }
}

/// Warnings that were already given. Lines of loops and subroutines run again, so each warning is given once.
#[derive(Default)]
pub struct Warned(HashSet<(u16, u32, String)>);

impl Warned {
    /// Whether this one is made for the first time.
    pub fn is_new(&mut self, warning: &NcWarning) -> bool {
        self.0.insert((warning.place.file, warning.place.offset, warning.to_string()))
    }
}

/// A program that repeats more than `limit` commands.
pub fn endless(files: &Files, at: Place, limit: u64) -> Diagnostic {
    let message = format!("the program goes on after {limit} commands of lines that were carried out before");
    place(Diagnostic::error(message), files, at).expected("expected an end; --max-commands N allows for more")
}

/// A comment of the program for the operator. `value` returns the value of a parameter; `(DEBUG, …)` and
/// `(PRINT, …)` show such values. `None` for `(DEBUG, …)` that the program hides with `#5599=0`.
pub fn message(files: &Files, head: &Head, value: impl Fn(&[u8]) -> Option<f64>) -> Option<Diagnostic> {
    let (text, before) = files.with(head.place.file, |source| {
        let from = head.place.offset as usize;
        let text = source.text.get(from..from + usize::from(head.place.length));
        let text = String::from_utf8_lossy(text.unwrap_or_default()).trim().to_owned();
        let before = source.text.get(from.saturating_sub(20)..from).unwrap_or_default();
        (text, String::from_utf8_lossy(before).to_uppercase().replace([' ', '\t'], ""))
    });
    let is_debug = before.ends_with("(DEBUG,");
    if is_debug && value(b"5599") == Some(0.0) {
        return None;
    }
    let text = if is_debug || before.ends_with("(PRINT,") { with_values(&text, value) } else { text };
    Some(Diagnostic::note(format!("line {}: {text}", head.place.line)))
}

/// The text with values in place of `#5` and `#<name>`. `%d` selects no decimals, `%f` four, `%.2f` two, `%lf` six.
fn with_values(text: &str, value: impl Fn(&[u8]) -> Option<f64>) -> String {
    let (mut shown, mut rest, mut decimals) = (String::new(), text, 6);
    while let Some(at) = rest.find(['#', '%']) {
        let (before, from) = rest.split_at(at);
        shown += before;
        let (taken, put) = if from.starts_with('%') {
            match format_of(from) {
                Some((length, digits)) => {
                    decimals = digits;
                    (length, String::new())
                }
                None => (1, "%".to_owned()),
            }
        } else {
            match name_of(from) {
                0 => (1, "#".to_owned()),
                length => {
                    let found = from.get(1..length).and_then(|name| value(name.as_bytes()));
                    (length, found.map_or("######".to_owned(), |value| format!("{value:.decimals$}")))
                }
            }
        };
        shown += &put;
        rest = from.get(taken..).unwrap_or_default();
    }
    shown + rest
}

/// Length of `#5` or `#<name>` at the start of the text; 0 if there is none.
fn name_of(text: &str) -> usize {
    if text.starts_with("#<") {
        return text.find('>').map_or(0, |end| end + 1);
    }
    let digits = text.bytes().skip(1).take_while(u8::is_ascii_digit).count();
    if digits == 0 { 0 } else { digits + 1 }
}

/// Length and decimals of `%d`, `%f`, `%lf` or `%.2f` at the start of the text.
fn format_of(text: &str) -> Option<(usize, usize)> {
    for (format, decimals) in [("%d", 0), ("%f", 4), ("%lf", 6)] {
        if text.starts_with(format) {
            return Some((format.len(), decimals));
        }
    }
    let digit = text.strip_prefix("%.")?;
    let digits = digit.bytes().take_while(u8::is_ascii_digit).count();
    let decimals = digit.get(..digits)?.parse::<usize>().ok().filter(|decimals| *decimals < 16)?;
    digit[digits..].starts_with('f').then_some((digits + 3, decimals))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_of_other_dialects_have_a_hint() {
        let known =
            WORDS.iter().filter(|entry| entry.is_built().is_ok() && matches!(entry.letter, 'G' | 'M'));
        let hints = known.filter(|entry| {
            let (whole, tenth) = (entry.tenths / 10, entry.tenths % 10);
            foreign_hint(&format!("{}{whole}.{tenth}", entry.letter)).is_some()
        });
        assert!(hints.count() > 50);
        let hint = foreign_hint("g20").expect("a hint");
        assert_eq!(
            hint,
            "expected a word of ISG: G70 is inch in ISG; with --dialect linuxcnc G20 is read: inch"
        );
        for (found, part) in [("G28", "G74"), ("O100", "O words"), ("#5", "parameters"), ("G99", "end at R")]
        {
            assert!(foreign_hint(found).is_some_and(|hint| hint.contains(part)), "{found}");
        }
        for found in ["X5", "G777", "G41", "#HSC", "", "é"] {
            assert_eq!(foreign_hint(found), None, "{found}");
        }
    }

    #[test]
    fn values_stand_in_place_of_parameters() {
        let value = |name: &[u8]| match name {
            b"5" => Some(1.25),
            b"<far>" => Some(-100.0),
            _ => None,
        };
        for (text, wanted) in [
            ("no value", "no value"),
            ("x=#5, #<far>", "x=1.250000, -100.000000"),
            ("%d#5 %.2f#5 %f#5 %lf#5", "1 1.25 1.2500 1.250000"),
            ("#<none> #7", "###### ######"),
            ("100 % and # and #<open", "100 % and # and #<open"),
            ("%.f#5", "%.f1.250000"),
        ] {
            assert_eq!(with_values(text, value), wanted, "{text}");
        }
    }
}

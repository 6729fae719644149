//! Warnings and refusals of the library as messages with their place in the text.
use crate::diagnose::Diagnostic;
use crate::files::Files;
use glidepath::channel::Error;
use glidepath::nc::{Head, NcError, NcWarning, Place};
use std::collections::HashSet;

pub fn place(diagnostic: Diagnostic, files: &Files, place: Place) -> Diagnostic {
    files.with(place.file, |source| {
        diagnostic.at(source, place.line as usize, place.column as usize, usize::from(place.length))
    })
}

/// A refusal of the decoder.
fn refused(files: &Files, error: &NcError) -> Diagnostic {
    explained(files, error.place, &error.to_string(), id(error.kind.id()))
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

/// A comment of the program for the operator.
pub fn message(files: &Files, head: &Head) -> Diagnostic {
    let text = files.with(head.place.file, |source| {
        let from = head.place.offset as usize;
        let text = source.text.get(from..from + usize::from(head.place.length));
        String::from_utf8_lossy(text.unwrap_or_default()).trim().to_owned()
    });
    Diagnostic::note(format!("line {}: {text}", head.place.line))
}

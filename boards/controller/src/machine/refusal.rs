//! Translates refusals of decoder and planner to Grbl's error numbers. Their words become a message.
use super::scan::NUMBER_BYTES;
use crate::motion::{Message, Refusal};
use core::fmt::Write;
use glidepath::channel::Error;
use glidepath::nc::{NcError, NcErrorKind};
use glidepath::path::PathError;
use glidepath::plan::MotionError;

/// The error number of Grbl.
fn code(error: &Error, beyond: u8) -> u8 {
    match error {
        Error::Nc(error) => code_of(error),
        Error::NotAvailable(..) | Error::NotEnabled(..) => 20,
        Error::SoftwareLimit(..) => beyond,
        Error::Motion(_, MotionError::NoFeed) => 22,
        Error::Motion(_, MotionError::Path(error)) => of_path(error),
        Error::Motion(..) => 33,
        _ => 20,
    }
}

fn of_path(error: &PathError) -> u8 {
    if error.concerns_centre() { 34 } else { 33 }
}

/// Grbl's error number for a kind of refusal.
fn code_of(error: &NcError) -> u8 {
    use NcErrorKind as K;
    let letter = error.found.as_str().as_bytes().first().copied().unwrap_or(0);
    match error.kind {
        K::Expected("a number") => 2,
        K::Expected(_) if letter == b'R' => 34,
        K::Expected(_) if letter.is_ascii_alphabetic() => 33,
        K::Expected(_) | K::ControlByte(_) | K::ForeignByte(_) | K::Checksum => 1,
        K::Overflow => 2,
        K::LineTooLong => 11,
        K::Range { .. } if error.found.contains('-') && matches!(letter, b'F' | b'S' | b'P' | b'T') => 4,
        K::Range { what: "T", .. } => 38,
        K::Range { what: "P of G10", .. } => 29,
        K::Range { .. } => 33,
        K::NotWhole(_) => 23,
        K::Twice("a word of this modal group") => 21,
        K::Twice(_) => 25,
        K::Conflict("another use of its axis words") => 24,
        K::Conflict(_) => 21,
        K::NoFeed => 22,
        K::ArcUndefined | K::OutsidePlane => 35,
        K::ArcTwice | K::FullCircleByRadius => 33,
        K::Missing("axis words") => 26,
        K::Missing("G0 or G1") => 30,
        K::Missing("G0, G1, G2 or G3 behind G80") => 31,
        K::Missing(_) => 28,
        K::ArcWordAlone | K::Unused | K::NotAlone(_) => 36,
        K::NoTool => 38,
        _ => 20,
    }
}

/// Number and words of a refusal. `beyond` is the number for a motion beyond the software limits.
pub fn refusal(error: &Error, beyond: u8) -> Refusal {
    let mut message = Message::new();
    // A text that is too long is cut.
    let column = error.place().column.saturating_sub(NUMBER_BYTES);
    let _ = match column {
        0 => write!(Ascii(&mut message), "{error}"),
        _ => write!(Ascii(&mut message), "column {column}: {error}"),
    };
    Refusal { code: code(error, beyond), message }
}

/// Replaces characters that senders cannot read: they take ASCII, and brackets would end the message.
pub struct Ascii<'a>(pub &'a mut Message);

impl Write for Ascii<'_> {
    fn write_str(&mut self, text: &str) -> core::fmt::Result {
        for letter in text.chars() {
            let letter = match letter {
                '[' => '(',
                ']' => ')',
                letter if letter.is_ascii_graphic() || letter == ' ' => letter,
                '²' => '2',
                '³' => '3',
                _ => '?',
            };
            self.0.push(letter).map_err(|_| core::fmt::Error)?;
        }
        Ok(())
    }
}

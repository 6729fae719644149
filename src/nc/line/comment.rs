//! Comments of LinuxCNC, Grbl and Fanuc. Comments do not nest, a `\` does not continue a line, and some
//! comments are messages or commands.
use super::LineReader;
use crate::nc::dialect::Note;
use crate::nc::{Place, Text};

/// Number of letters that distinguish active comments.
const LETTERS: usize = 6;

/// The current comment, and the last active comment of the line.
#[derive(Clone, Copy)]
pub struct ForeignComments {
    /// Whether programs are in the language of LinuxCNC or Grbl.
    pub is_on: bool,
    /// The first letters of the comment in upper case.
    letters: [u8; LETTERS],
    /// Number of letters so far. A number above the capacity means that the comment is not active.
    count: u8,
    /// The kind of comment, which is known after `,`, and the place of its text.
    begun: Option<(Note, Place)>,
    note: Option<(Note, Place)>,
}

impl ForeignComments {
    /// The state for ISG's comments.
    pub const ISG: Self = Self { is_on: false, letters: [0; LETTERS], count: 0, begun: None, note: None };

    /// Clears the state at the start of a line.
    pub fn clear(&mut self) {
        (self.count, self.begun, self.note) = (0, None, None);
    }

    /// The active comment of the line; the last one if there are several.
    pub fn take(&mut self) -> Option<(Note, Place)> {
        self.note.take()
    }

    /// Adds a byte of a comment.
    fn add(&mut self, byte: u8, here: Place) {
        if self.begun.is_some() {
            return;
        }
        match byte {
            b' ' | b'\t' => {}
            b',' => {
                let behind =
                    Place { column: here.column + 1, offset: here.offset.wrapping_add(1), length: 0, ..here };
                self.begun = self.kind().map(|note| (note, behind));
                self.count = u8::MAX;
            }
            _ => {
                if let Some(slot) = self.letters.get_mut(usize::from(self.count)) {
                    *slot = byte.to_ascii_uppercase();
                }
                self.count = self.count.saturating_add(1);
            }
        }
    }

    fn kind(&self) -> Option<Note> {
        let long = usize::from(self.count) > LETTERS;
        let word = self.letters.get(..usize::from(self.count).min(LETTERS))?;
        match word {
            b"MSG" | b"DEBUG" | b"PRINT" => Some(Note::Message),
            b"ABORT" => Some(Note::Abort),
            b"LOG" => Some(Note::Other),
            // LOGOPEN, LOGAPPEND, PROBEOPEN.
            b"LOGOPE" | b"LOGAPP" | b"PROBEO" if long => Some(Note::Other),
            _ => None,
        }
    }

    /// Ends the comment.
    fn close(&mut self, here: Place) {
        if let Some((note, place)) = self.begun.take() {
            let length = here.offset.wrapping_sub(place.offset).min(u32::from(u16::MAX)) as u16;
            self.note = Some((note, Place { length, ..place }));
        }
        self.count = 0;
    }
}

impl<T: Text> LineReader<T> {
    /// Handles comments. Returns `true` for a byte that is not part of the line.
    pub(super) fn foreign_dropped(&mut self, byte: u8, here: Place) -> bool {
        if self.logical.remark {
            return true;
        }
        if self.logical.comment > 0 {
            if byte == b')' {
                self.logical.comment = 0;
                self.foreign.close(here);
            } else {
                self.foreign.add(byte, here);
            }
            return true;
        }
        match byte {
            b'(' => {
                (self.logical.opened, self.logical.comment) = (here, 1);
                self.foreign.count = 0;
                true
            }
            b';' => {
                self.logical.remark = true;
                true
            }
            _ => matches!(byte, b' ' | b'\t'),
        }
    }
}

//! Collects bytes to lines. In Grbl's form, blanks, comments and `/` are removed, and letters become upper
//! case. A line that is too long counts as one line, and is refused.
use heapless::Vec;

/// Bytes of the longest configurable line.
pub const LINE_BYTES: usize = 255;

/// Form in which the motion side gets a line.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum LineText {
    /// Grbl's form: without blanks, comments and `/`, in upper case, at most 79 characters.
    Grbl,
    /// The received form without control characters, at most 255 bytes. For a language in which blanks count.
    /// Lines that begin with `$` are read in Grbl's form.
    AsReceived,
}

/// Result of a line end.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Line {
    /// A line is complete.
    Complete,
    /// The line was too long.
    TooLong,
}

/// Longest line of Grbl.
const GRBL_BYTES: usize = 79;

/// Position in the text.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Comment {
    None,
    /// Inside `(` and `)`.
    Bracket,
    /// After `;`.
    Rest,
}

/// The current line.
pub struct Assembler {
    text: LineText,
    /// The line in Grbl's form.
    stripped: Vec<u8, LINE_BYTES>,
    /// The line in the received form.
    raw: Vec<u8, LINE_BYTES>,
    comment: Comment,
    is_too_long: bool,
    /// The previous byte was CR.
    behind_cr: bool,
    /// The line was returned: the next byte begins a new line.
    is_done: bool,
}

impl Assembler {
    /// Nothing is received yet.
    pub const fn new(text: LineText) -> Self {
        Self {
            text,
            stripped: Vec::new(),
            raw: Vec::new(),
            comment: Comment::None,
            is_too_long: false,
            behind_cr: false,
            is_done: false,
        }
    }

    /// Drops the current line. An LF after a CR before the call counts as a separate line.
    pub fn clear(&mut self) {
        *self = Self::new(self.text);
    }

    fn begin(&mut self) {
        self.stripped.clear();
        self.raw.clear();
        (self.comment, self.is_too_long, self.is_done) = (Comment::None, false, false);
    }

    /// Takes a byte. Returns whether it ends a line. CR LF is one line end.
    pub fn push(&mut self, byte: u8) -> Option<Line> {
        let behind_cr = core::mem::replace(&mut self.behind_cr, byte == b'\r');
        if byte == b'\n' && behind_cr {
            return None;
        }
        if self.is_done {
            self.begin();
        }
        if byte == b'\n' || byte == b'\r' {
            self.is_done = true;
            return Some(if self.is_too_long { Line::TooLong } else { Line::Complete });
        }
        self.keep(byte);
        None
    }

    fn keep(&mut self, byte: u8) {
        let blank = if byte == b'\t' { b' ' } else { byte };
        let fits = blank < b' ' || blank == 0x7f || self.raw.push(blank).is_ok();
        self.is_too_long |= !fits && self.text == LineText::AsReceived;
        match (self.comment, byte) {
            (Comment::Bracket, b')') => self.comment = Comment::None,
            (Comment::Bracket | Comment::Rest, _) => {}
            (Comment::None, b'(') => self.comment = Comment::Bracket,
            (Comment::None, b';') => self.comment = Comment::Rest,
            (Comment::None, ..=b' ' | b'/' | 0x7f..) => {}
            (Comment::None, _) => {
                let is_full = self.stripped.len() >= GRBL_BYTES && self.text == LineText::Grbl;
                let fits = !is_full && self.stripped.push(byte.to_ascii_uppercase()).is_ok();
                self.is_too_long |= !fits && self.text == LineText::Grbl;
            }
        }
    }

    /// The line in Grbl's form.
    pub fn stripped(&self) -> &[u8] {
        &self.stripped
    }

    /// The line for the motion side.
    pub fn text(&self) -> &[u8] {
        match self.text {
            LineText::Grbl => &self.stripped,
            LineText::AsReceived => &self.raw,
        }
    }
}

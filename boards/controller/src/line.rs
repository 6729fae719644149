//! From bytes to lines: what Grbl drops is dropped, and a line that is too long is one line all the same.
use heapless::Vec;

/// Bytes of the longest line that can be configured.
pub const LINE_BYTES: usize = 255;

/// What is handed to the motion side.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum LineText {
    /// As Grbl has it: without blanks, comments and `/`, in upper case, at most 79 characters.
    Grbl,
    /// As it was received, without control characters, at most 255 bytes. For a language in which blanks count.
    /// Lines that begin with `$` are read as Grbl reads them.
    AsReceived,
}

/// What a line end left.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Line {
    /// A line is complete.
    Complete,
    /// It was too long.
    TooLong,
}

/// Longest line of Grbl.
const GRBL_BYTES: usize = 79;

/// Where the text is.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Comment {
    None,
    /// Between `(` and `)`.
    Bracket,
    /// Behind `;`.
    Rest,
}

/// The line at hand.
pub struct Assembler {
    text: LineText,
    /// As Grbl has it.
    stripped: Vec<u8, LINE_BYTES>,
    /// As it was received.
    raw: Vec<u8, LINE_BYTES>,
    comment: Comment,
    is_too_long: bool,
    /// The byte before was CR.
    behind_cr: bool,
    /// The line was handed out: the next byte begins another one.
    is_done: bool,
}

impl Assembler {
    /// Nothing received.
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

    /// Forgets what there is of a line. LF behind a CR before it counts as a line of its own.
    pub fn clear(&mut self) {
        *self = Self::new(self.text);
    }

    fn begin(&mut self) {
        self.stripped.clear();
        self.raw.clear();
        (self.comment, self.is_too_long, self.is_done) = (Comment::None, false, false);
    }

    /// Takes a byte; whether it ends a line. CR LF is one line end.
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

    /// The line as Grbl has it.
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

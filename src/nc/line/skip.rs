//! Skips text: the rest of a refused line, or the rest of a program that another program replaces.
use super::{Fill, LineReader, Mark, SLICE};
use crate::nc::{NcError, Text};

impl<T: Text> LineReader<T> {
    /// Continues with another text, from its start. Returns the previous text.
    pub fn replace(&mut self, mut text: T) -> T {
        self.seek(Mark { offset: text.start(), ..Mark::start_of(0) });
        core::mem::replace(&mut self.text, text)
    }

    /// Continues with the next program in the main file, after a line that ends at `mark`.
    pub fn next_program(&mut self, mark: Mark) {
        let begins = self.text.next_program();
        // The part of a line that is already read does not belong to the next program.
        let begun = !self.fresh && self.offset != self.logical.start.offset;
        let goes_on = begun && mark == self.next_start() && begins.is_none();
        self.seek(Mark { offset: begins.unwrap_or(mark.offset), ..mark });
        self.skips = goes_on;
    }

    /// Continues with the next line after a refusal.
    pub fn go_on(&mut self) {
        self.skips |= core::mem::take(&mut self.refused);
    }

    /// Whether the line at the mark can be read again.
    pub fn holds(&self, mark: Mark) -> bool {
        self.text.holds(mark.file, mark.offset)
    }

    /// Skips the rest of a line; a call skips at most a slice.
    #[cold]
    #[inline(never)]
    pub(super) fn skip(&mut self) -> Result<Fill, NcError> {
        for _ in 0..SLICE {
            self.text.pass(self.file, self.offset);
            let byte = match self.next_byte() {
                Ok(byte) => byte,
                Err(error) => return self.missing(error),
            };
            let Some(byte) = byte else {
                (self.fresh, self.skips) = (true, false);
                break;
            };
            let here = self.here();
            self.offset = self.offset.wrapping_add(1);
            if !matches!(byte, b'\n' | b'\r') {
                self.logical.continued &= self.dropped(byte, here);
                continue;
            }
            if byte == b'\r'
                && let Err(error) = self.step_over_line_feed()
            {
                self.offset = here.offset;
                return self.missing(error);
            }
            self.line = self.line.wrapping_add(1);
            self.line_offset = self.offset;
            (self.logical.comment, self.logical.remark) = (0, false);
            if !core::mem::take(&mut self.logical.continued) {
                (self.fresh, self.skips) = (true, false);
                break;
            }
        }
        Ok(Fill::Partial)
    }
}

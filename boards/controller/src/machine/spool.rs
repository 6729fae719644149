//! Holds lines on their way to the decoder: a ring that contains the current line. Only the task of the
//! planner uses this ring.
use core::cell::Cell;
use glidepath::nc::{Text, TextError};

/// Bytes of the ring: twice the longest line with its number.
const BYTES: u32 = 1024;

/// Text that grows by whole lines. The next line enters the ring when the decoder has read the line before.
pub struct Spool {
    bytes: [Cell<u8>; BYTES as usize],
    /// Number of bytes put in so far.
    put: Cell<u32>,
    /// Number of bytes that the decoder has read.
    passed: Cell<u32>,
}

impl Spool {
    /// An empty ring.
    pub const fn new() -> Self {
        Self { bytes: [const { Cell::new(0) }; BYTES as usize], put: Cell::new(0), passed: Cell::new(0) }
    }

    /// Appends a line, with a line end.
    pub fn push(&self, line: &[u8]) {
        for byte in line.iter().chain(b"\n") {
            let put = self.put.get();
            if let Some(place) = self.place(put) {
                place.set(*byte);
            }
            self.put.set(put.wrapping_add(1));
        }
    }

    /// Drops the text that the decoder has not read.
    pub fn clear(&self) {
        self.passed.set(self.put.get());
    }

    /// Whether the decoder has read all lines and waits for the next line.
    pub fn is_read(&self) -> bool {
        self.passed.get() == self.put.get()
    }

    fn place(&self, offset: u32) -> Option<&Cell<u8>> {
        self.bytes.get((offset % BYTES) as usize)
    }
}

impl Default for Spool {
    fn default() -> Self {
        Self::new()
    }
}

impl Text for &Spool {
    fn read(&mut self, _: u16, offset: u32, buffer: &mut [u8]) -> Result<usize, TextError> {
        let there = self.put.get().wrapping_sub(offset);
        if there == 0 {
            return Err(TextError::NotYet);
        }
        if there > BYTES {
            return Err(TextError::Forgotten);
        }
        let count = buffer.len().min(there as usize);
        for (to, k) in buffer.iter_mut().take(count).zip(0..) {
            *to = self.place(offset.wrapping_add(k)).map_or(0, Cell::get);
        }
        Ok(count)
    }

    fn pass(&mut self, _: u16, offset: u32) {
        self.passed.set(offset);
    }

    fn holds(&self, _: u16, offset: u32) -> bool {
        self.put.get().wrapping_sub(offset) <= BYTES
    }

    fn start(&mut self) -> u32 {
        self.clear();
        self.put.get()
    }

    fn next_program(&mut self) -> Option<u32> {
        Some(self.start())
    }
}

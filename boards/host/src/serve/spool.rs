//! Lines on their way to the decoder.
use glidepath::nc::{Text, TextError};
use std::cell::{Cell, RefCell};

/// Text that grows by whole lines and is forgotten behind the decoder.
pub struct Spool {
    text: RefCell<Vec<u8>>,
    /// Offset of the first byte of `text`.
    first: Cell<u32>,
    /// The decoder has come so far.
    passed: Cell<u32>,
}

impl Spool {
    pub fn new() -> Self {
        Self { text: RefCell::default(), first: Cell::new(0), passed: Cell::new(0) }
    }

    /// Appends a line.
    pub fn push(&self, line: &[u8]) {
        let mut text = self.text.borrow_mut();
        text.extend_from_slice(line);
        text.push(b'\n');
    }

    /// Forgets what the decoder has not come to.
    pub fn clear(&self) {
        self.passed.set(self.end());
    }

    /// Whether the decoder has read all lines and asks for the next one.
    pub fn is_read(&self) -> bool {
        self.passed.get() == self.end()
    }

    fn end(&self) -> u32 {
        self.first.get().wrapping_add(self.text.borrow().len() as u32)
    }
}

impl Text for &Spool {
    fn read(&mut self, _: u16, offset: u32, buffer: &mut [u8]) -> Result<usize, TextError> {
        let text = self.text.borrow();
        let at = offset.wrapping_sub(self.first.get()) as usize;
        let mut rest = text.get(at..).ok_or(TextError::Forgotten)?;
        if rest.is_empty() {
            return Err(TextError::NotYet);
        }
        rest.read(0, 0, buffer)
    }

    fn pass(&mut self, _: u16, offset: u32) {
        self.passed.set(offset);
        let mut text = self.text.borrow_mut();
        let behind = offset.wrapping_sub(self.first.get()) as usize;
        // Loops of the program may lead back: a good deal is kept.
        const KEPT: usize = 1 << 20;
        if behind > 2 * KEPT && behind <= text.len() {
            text.drain(..behind - KEPT);
            self.first.set(offset.wrapping_sub(KEPT as u32));
        }
    }

    fn holds(&self, _: u16, offset: u32) -> bool {
        offset.wrapping_sub(self.first.get()) as usize <= self.text.borrow().len()
    }

    fn start(&mut self) -> u32 {
        self.clear();
        self.end()
    }

    fn next_program(&mut self) -> Option<u32> {
        Some(self.start())
    }
}

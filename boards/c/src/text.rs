//! The program text that the planner reads: text in memory, or text that arrives in the window.
use crate::WINDOW;
use glidepath::nc::{Stream, Text, TextError};

/// Program text.
pub enum Program {
    /// Text in memory, which must stay there while it is loaded.
    Memory(&'static [u8]),
    /// Text that arrives in the window.
    Window(Stream<'static, WINDOW>),
}

impl Text for Program {
    fn read(&mut self, file: u16, offset: u32, buffer: &mut [u8]) -> Result<usize, TextError> {
        match self {
            Self::Memory(text) => text.read(file, offset, buffer),
            Self::Window(stream) => stream.read(file, offset, buffer),
        }
    }

    fn pass(&mut self, file: u16, offset: u32) {
        if let Self::Window(stream) = self {
            stream.pass(file, offset);
        }
    }

    fn holds(&self, file: u16, offset: u32) -> bool {
        match self {
            Self::Memory(_) => true,
            Self::Window(stream) => stream.holds(file, offset),
        }
    }

    fn start(&mut self) -> u32 {
        match self {
            Self::Memory(_) => 0,
            Self::Window(stream) => stream.start(),
        }
    }

    fn next_program(&mut self) -> Option<u32> {
        match self {
            Self::Memory(_) => None,
            Self::Window(stream) => stream.next_program(),
        }
    }
}

//! The interface to a source of program text, for example a slice in flash, files on a PC, or a block device.

/// Random access to the bytes of an NC program and of the files that it calls with `L`. Loops and subroutines read parts
/// of the text again. A `&[u8]` implements this trait for one file.
pub trait Text {
    /// Copies bytes of a file, from `offset` on, into `buffer`, and returns their number. 0 means the end of
    /// the file. `file` is 0 for the main program, or a number from [`Text::open`].
    ///
    /// # Errors
    /// The device failed, or the text at `offset` has not arrived yet.
    fn read(&mut self, file: u16, offset: u32, buffer: &mut [u8]) -> Result<usize, TextError>;

    /// Returns the number of the file that a program calls by `name` (ASCII, at most 83 bytes), or `None` if
    /// there is no such file. The same name must always give the same number. The default implementation has
    /// no files. A file can be opened before its text has arrived.
    ///
    /// # Errors
    /// The device failed.
    fn open(&mut self, name: &str) -> Result<Option<u16>, TextError> {
        let _ = name;
        Ok(None)
    }

    /// Tells the source that the decoder has reached the line at `offset` of a file. A [`super::Window`] then
    /// drops text that is far before this line.
    fn pass(&mut self, file: u16, offset: u32) {
        let _ = (file, offset);
    }

    /// Whether the line at `offset` of a file can be read again. The decoder calls this function before it
    /// jumps there.
    fn holds(&self, file: u16, offset: u32) -> bool {
        let _ = (file, offset);
        true
    }

    /// Offset of the main program's first byte when the text is loaded. The offset is 0, except in a stream
    /// that held other programs before. A wrapper around a stream must forward this call.
    fn start(&mut self) -> u32 {
        0
    }

    /// Offset of the next program in the main file; `None` if this program follows directly after the last
    /// line.
    fn next_program(&mut self) -> Option<u32> {
        None
    }
}

/// The reason why [`Text::read`] or [`Text::open`] returned no text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum TextError {
    /// The device failed: the program is refused.
    Failed,
    /// The text has not arrived yet, from a serial line or a slow card. The decoder asks again. Meanwhile the motion
    /// continues with the arrived text, and stops at its end.
    NotYet,
    /// The window of a stream no longer holds the text, or a line is longer than the window. The line is
    /// refused.
    Forgotten,
}

impl Text for &[u8] {
    fn read(&mut self, _: u16, offset: u32, buffer: &mut [u8]) -> Result<usize, TextError> {
        let rest = self.get(offset as usize..).unwrap_or(&[]);
        let count = rest.len().min(buffer.len());
        if let (Some(to), Some(from)) = (buffer.get_mut(..count), rest.get(..count)) {
            to.copy_from_slice(from);
        }
        Ok(count)
    }
}

/// A main program and the files that it may call, all in memory (flash).
#[derive(Clone, Copy, Debug)]
pub struct Library<'a> {
    /// The text of the main program.
    pub main: &'a [u8],
    /// Name and text of the other files. `L name` calls the file `name`, or `name.nc` if there is no `name`.
    pub files: &'a [(&'a str, &'a [u8])],
}

impl Library<'_> {
    /// The name of a file, for messages; `None` for the main program.
    pub fn name(&self, file: u16) -> Option<&str> {
        let index = usize::from(file).checked_sub(1)?;
        self.files.get(index).map(|(name, _)| *name)
    }
}

impl Text for Library<'_> {
    fn read(&mut self, file: u16, offset: u32, buffer: &mut [u8]) -> Result<usize, TextError> {
        let mut text = match usize::from(file).checked_sub(1) {
            None => self.main,
            Some(index) => self.files.get(index).ok_or(TextError::Failed)?.1,
        };
        text.read(0, offset, buffer)
    }

    fn open(&mut self, name: &str) -> Result<Option<u16>, TextError> {
        let position =
            |wanted: &dyn Fn(&str) -> bool| self.files.iter().position(|(listed, _)| wanted(listed));
        let found = position(&|listed| listed == name)
            .or_else(|| position(&|listed| listed.strip_suffix(".nc") == Some(name)));
        Ok(found.and_then(|index| u16::try_from(index + 1).ok()))
    }
}

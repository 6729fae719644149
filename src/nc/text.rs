//! Where program text comes from: slices in flash, files on a desktop, a block device.

/// Random access to the bytes of an NC program and of the files it calls with `L`. Loops and subroutines read
/// parts of them again.
pub trait Text {
    /// Copies bytes of a file from `offset` on into `buffer` and says how many; 0 at the end of the file.
    /// `file` is 0 for the main program, or what [`Text::open`] answered.
    ///
    /// # Errors
    /// The device failed, or there is nothing at `offset` yet.
    fn read(&mut self, file: u16, offset: u32, buffer: &mut [u8]) -> Result<usize, TextError>;

    /// The number of the file a program calls by `name` (ASCII, at most 83 bytes), the same for every call;
    /// `None` if there is no such file. A text without this is one file alone.
    ///
    /// # Errors
    /// The device failed. A file whose text is still on its way can be opened.
    fn open(&mut self, name: &str) -> Result<Option<u16>, TextError> {
        let _ = name;
        Ok(None)
    }

    /// The decoder has come to the line that begins at `offset` of a file. A text that forgets may forget
    /// what lies far enough before it: see [`super::Window`].
    fn pass(&mut self, file: u16, offset: u32) {
        let _ = (file, offset);
    }

    /// Whether the line that begins at `offset` of a file can be read again. Asked before the decoder jumps
    /// there.
    fn holds(&self, file: u16, offset: u32) -> bool {
        let _ = (file, offset);
        true
    }

    /// Where the main file begins when it is loaded: its first byte, but for a stream, which has other programs
    /// behind it. A text that passes its calls on to a stream passes this one on, too.
    fn start(&mut self) -> u32 {
        0
    }

    /// Where the next program begins in the main file, if that is not behind the last line read.
    fn next_program(&mut self) -> Option<u32> {
        None
    }
}

/// Why there is no text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum TextError {
    /// The device failed: the program is refused.
    Failed,
    /// It has not arrived yet (a serial line, a slow card): the decoder asks again. What has arrived moves
    /// on; where it ends, the motion comes to a standstill.
    NotYet,
    /// It is behind the window of a stream, or a line is longer than the window: the line is refused.
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

/// A main program with the files it may call, all in memory (flash).
#[derive(Clone, Copy, Debug)]
pub struct Library<'a> {
    /// The program that runs.
    pub main: &'a [u8],
    /// Name and text of the others. `L name` calls `name`, or `name.nc` if that is all there is.
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

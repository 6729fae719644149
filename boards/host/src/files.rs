//! The program and the files that it calls with `L`, in the folder of the program.
use crate::diagnose::{Diagnostic, Source};
use glidepath::nc::{Text, TextError};
use std::cell::{Cell, RefCell};
use std::path::{Path, PathBuf};

/// The texts. Each file is read once, at its first call, so all passes see the same bytes.
pub struct Files {
    /// The main program.
    pub main: Source,
    directory: PathBuf,
    called: RefCell<Vec<(PathBuf, Source)>>,
}

impl Files {
    /// Reads the main program; `-` is the standard input, with called files in the current directory.
    ///
    /// # Errors
    /// It cannot be read.
    pub fn read(program: &Path) -> Result<Self, Vec<Diagnostic>> {
        if program.as_os_str() == "-" {
            let main = Source::read_input()?;
            return Ok(Self { main, directory: PathBuf::new(), called: RefCell::default() });
        }
        let directory = program.parent().unwrap_or(Path::new("")).to_path_buf();
        Ok(Self { main: Source::read(program)?, directory, called: RefCell::default() })
    }

    /// A program that calls no other files.
    #[cfg(test)]
    pub fn of_text(text: &str) -> Self {
        let main = Source { name: "test.nc".into(), text: text.as_bytes().to_vec() };
        Self { main, directory: PathBuf::new(), called: RefCell::default() }
    }

    /// The same texts for another thread.
    pub fn again(&self) -> Self {
        let (main, called) = (self.main.clone(), RefCell::new(self.called.borrow().clone()));
        Self { main, directory: self.directory.clone(), called }
    }

    /// The files read so far, without the main program.
    pub fn called(&self) -> Vec<PathBuf> {
        self.called.borrow().iter().map(|(path, _)| path.clone()).collect()
    }

    /// The name of a called file; none for the main program.
    pub fn name(&self, file: u16) -> Option<String> {
        (file > 0).then(|| self.with(file, |source| source.name.clone()))
    }

    /// Shows the file that a place names.
    pub fn with<V>(&self, file: u16, show: impl FnOnce(&Source) -> V) -> V {
        let called = self.called.borrow();
        let found = usize::from(file).checked_sub(1).and_then(|index| called.get(index));
        show(found.map_or(&self.main, |(_, source)| source))
    }
}

/// The files, with text that may be late.
pub struct Delayed<'a> {
    /// The text.
    pub files: &'a Files,
    /// Whether the text is late.
    pub late: &'a Cell<bool>,
}

impl Text for Delayed<'_> {
    fn read(&mut self, file: u16, offset: u32, buffer: &mut [u8]) -> Result<usize, TextError> {
        if self.late.get() { Err(TextError::NotYet) } else { self.files.read(file, offset, buffer) }
    }

    fn open(&mut self, name: &str) -> Result<Option<u16>, TextError> {
        self.files.open(name)
    }
}

impl Text for &Files {
    fn read(&mut self, file: u16, offset: u32, buffer: &mut [u8]) -> Result<usize, TextError> {
        self.with(file, |source| source.text.as_slice().read(0, offset, buffer))
    }

    /// `name` as given, else with `.nc` or `.ngc` appended; LinuxCNC's names are in lower case.
    fn open(&mut self, name: &str) -> Result<Option<u16>, TextError> {
        let small = name.to_lowercase();
        let names = [name.to_owned(), format!("{name}.nc"), format!("{name}.ngc"), format!("{small}.ngc")];
        let Some(path) = names.map(|name| self.directory.join(name)).into_iter().find(|path| path.is_file())
        else {
            return Ok(None);
        };
        let mut called = self.called.borrow_mut();
        let index = match called.iter().position(|(known, _)| *known == path) {
            Some(index) => index,
            None => {
                let source = Source::read(&path).map_err(|_| TextError::Failed)?;
                called.push((path, source));
                called.len() - 1
            }
        };
        u16::try_from(index + 1).map(Some).map_err(|_| TextError::Failed)
    }
}

//! Flash memory in a file, for a controller on the PC.
extern crate std;

use embedded_storage::nor_flash::{ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash};
use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::Path;
use std::vec::Vec;

/// Bytes of an erase block, and of the whole file.
const BLOCK: usize = 4096;
const BYTES: usize = 2 * BLOCK;

/// A file of 8,192 bytes that holds the store. Each call waits until the system has written it.
#[derive(Debug)]
pub struct FileFlash {
    file: File,
}

impl FileFlash {
    /// Opens the file, or makes one without records. A file that is shorter counts as erased behind its end.
    ///
    /// # Errors
    /// The file cannot be opened, or has more bytes than a store.
    pub fn open(path: &Path) -> io::Result<Self> {
        let mut file = File::options().read(true).write(true).create(true).truncate(false).open(path)?;
        let length = file.metadata()?.len();
        if length > BYTES as u64 {
            return Err(io::Error::new(
                io::ErrorKind::InvalidData,
                "the file is longer than a parameter store",
            ));
        }
        file.seek(SeekFrom::End(0))?;
        let missing = BYTES.saturating_sub(length as usize);
        file.write_all(&Vec::from_iter(core::iter::repeat_n(0xff, missing)))?;
        Ok(Self { file })
    }

    fn put(&mut self, offset: u32, bytes: &[u8]) -> Result<(), FileError> {
        self.file.seek(SeekFrom::Start(offset.into()))?;
        self.file.write_all(bytes)?;
        Ok(self.file.sync_data()?)
    }
}

/// The file cannot be read or written.
#[derive(Debug)]
pub struct FileError(pub io::Error);

impl From<io::Error> for FileError {
    fn from(error: io::Error) -> Self {
        Self(error)
    }
}

impl NorFlashError for FileError {
    fn kind(&self) -> NorFlashErrorKind {
        NorFlashErrorKind::Other
    }
}

impl ErrorType for FileFlash {
    type Error = FileError;
}

impl ReadNorFlash for FileFlash {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Self::Error> {
        self.file.seek(SeekFrom::Start(offset.into()))?;
        Ok(self.file.read_exact(bytes)?)
    }

    fn capacity(&self) -> usize {
        BYTES
    }
}

impl NorFlash for FileFlash {
    const WRITE_SIZE: usize = 4;
    const ERASE_SIZE: usize = BLOCK;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), Self::Error> {
        self.put(from, &Vec::from_iter(core::iter::repeat_n(0xff, to.saturating_sub(from) as usize)))
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Self::Error> {
        self.put(offset, bytes)
    }
}

//! A file in the place of flash memory, for a controller on a PC.
extern crate std;

use embedded_storage::nor_flash::{
    ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash, check_erase, check_read, check_write,
};
use std::boxed::Box;
use std::ffi::OsString;
use std::fs::{File, TryLockError};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};
use std::{format, vec::Vec};

/// Bytes of an erase block, and of the whole file.
const BLOCK: usize = 4096;
const BYTES: usize = 2 * BLOCK;

/// A file of 8,192 bytes that holds the store.
///
/// Each change writes a new file beside the old one and puts it in its place. So the file is the one before the change or
/// the one behind it, whenever the process ends. One process at a time has the file.
#[derive(Debug)]
pub struct FileFlash {
    path: PathBuf,
    /// Locked as long as it is open.
    file: File,
    bytes: Box<[u8; BYTES]>,
}

impl FileFlash {
    /// Opens the file, or makes one without records.
    ///
    /// # Errors
    /// The file cannot be opened, another process has it, or it has not the length of a store.
    pub fn open(path: &Path) -> io::Result<Self> {
        let mut file = File::options().read(true).write(true).create(true).truncate(false).open(path)?;
        lock(&file)?;
        let mut found = Vec::new();
        Read::by_ref(&mut file).take(BYTES as u64 + 1).read_to_end(&mut found)?;
        let mut bytes = Box::new([0xff; BYTES]);
        match found.len() {
            0 => {}
            BYTES => bytes.copy_from_slice(&found),
            _ => {
                let length = file.metadata()?.len();
                let message = format!("the file has {length} bytes, and a parameter store has {BYTES}");
                return Err(io::Error::new(io::ErrorKind::InvalidData, message));
            }
        }
        // A link stays: the file that it leads to is replaced.
        let mut flash = Self { path: path.canonicalize()?, file, bytes };
        if found.is_empty() {
            flash.replace()?;
        }
        Ok(flash)
    }

    /// Puts a file with the bytes as they are now in the place of the old one.
    fn replace(&mut self) -> io::Result<()> {
        let mut name = OsString::from(".");
        name.push(self.path.file_name().unwrap_or_default());
        name.push(".new");
        let new = self.path.with_file_name(name);
        let mut file = File::create(&new)?;
        lock(&file)?;
        file.write_all(&*self.bytes)?;
        file.sync_all()?;
        std::fs::rename(&new, &self.path)?;
        self.file = file;
        Ok(())
    }

    /// Carries out a change of the bytes; they stay as they are where the file does not take it.
    fn change(&mut self, change: impl FnOnce(&mut [u8; BYTES])) -> Result<(), FileError> {
        let before = self.bytes.clone();
        change(&mut self.bytes);
        if let Err(error) = self.replace() {
            self.bytes = before;
            return Err(FileError::Io(error));
        }
        Ok(())
    }
}

fn lock(file: &File) -> io::Result<()> {
    match file.try_lock() {
        Ok(()) => Ok(()),
        Err(TryLockError::WouldBlock) => {
            Err(io::Error::new(io::ErrorKind::ResourceBusy, "another process has the file"))
        }
        // A file system that knows no locks.
        Err(TryLockError::Error(error)) if error.kind() == io::ErrorKind::Unsupported => Ok(()),
        Err(TryLockError::Error(error)) => Err(error),
    }
}

/// The file cannot be written, or a place lies outside of it.
#[derive(Debug)]
pub enum FileError {
    /// The system says so.
    Io(io::Error),
    /// The place.
    Place(NorFlashErrorKind),
}

impl NorFlashError for FileError {
    fn kind(&self) -> NorFlashErrorKind {
        match self {
            Self::Io(_) => NorFlashErrorKind::Other,
            Self::Place(kind) => *kind,
        }
    }
}

impl ErrorType for FileFlash {
    type Error = FileError;
}

impl ReadNorFlash for FileFlash {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Self::Error> {
        check_read(self, offset, bytes.len()).map_err(FileError::Place)?;
        for (to, from) in bytes.iter_mut().zip(self.bytes.iter().skip(offset as usize)) {
            *to = *from;
        }
        Ok(())
    }

    fn capacity(&self) -> usize {
        BYTES
    }
}

impl NorFlash for FileFlash {
    const WRITE_SIZE: usize = 4;
    const ERASE_SIZE: usize = BLOCK;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), Self::Error> {
        check_erase(self, from, to).map_err(FileError::Place)?;
        self.change(|bytes| {
            let (from, to) = (from as usize, to as usize);
            bytes.iter_mut().take(to).skip(from).for_each(|byte| *byte = 0xff);
        })
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Self::Error> {
        check_write(self, offset, bytes.len()).map_err(FileError::Place)?;
        self.change(|all| {
            for (to, from) in all.iter_mut().skip(offset as usize).zip(bytes) {
                *to = *from;
            }
        })
    }
}

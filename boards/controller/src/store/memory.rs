//! RAM in the place of flash memory: for tests, and for a controller whose host stores the parameters.
use embedded_storage::nor_flash::{
    ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash, check_erase, check_read, check_write,
};

/// `BYTES` of RAM that behave like flash memory: a write clears bits, and an erase sets 4,096 bytes.
#[derive(Clone, Debug)]
pub struct MemoryFlash<const BYTES: usize>(pub [u8; BYTES]);

impl<const BYTES: usize> MemoryFlash<BYTES> {
    /// Erased memory.
    pub const fn new() -> Self {
        Self([0xff; BYTES])
    }
}

impl<const BYTES: usize> Default for MemoryFlash<BYTES> {
    fn default() -> Self {
        Self::new()
    }
}

/// An address outside the memory, or not aligned.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Misplaced(pub NorFlashErrorKind);

impl NorFlashError for Misplaced {
    fn kind(&self) -> NorFlashErrorKind {
        self.0
    }
}

impl<const BYTES: usize> ErrorType for MemoryFlash<BYTES> {
    type Error = Misplaced;
}

impl<const BYTES: usize> MemoryFlash<BYTES> {
    fn part(&mut self, from: u32, length: usize) -> Result<&mut [u8], Misplaced> {
        let part = self.0.get_mut(from as usize..).and_then(|rest| rest.get_mut(..length));
        part.ok_or(Misplaced(NorFlashErrorKind::OutOfBounds))
    }
}

impl<const BYTES: usize> ReadNorFlash for MemoryFlash<BYTES> {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Self::Error> {
        check_read(self, offset, bytes.len()).map_err(Misplaced)?;
        bytes.copy_from_slice(self.part(offset, bytes.len())?);
        Ok(())
    }

    fn capacity(&self) -> usize {
        BYTES
    }
}

impl<const BYTES: usize> NorFlash for MemoryFlash<BYTES> {
    const WRITE_SIZE: usize = 4;
    const ERASE_SIZE: usize = 4096;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), Self::Error> {
        check_erase(self, from, to).map_err(Misplaced)?;
        self.part(from, to.saturating_sub(from) as usize)?.fill(0xff);
        Ok(())
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Self::Error> {
        check_write(self, offset, bytes.len()).map_err(Misplaced)?;
        for (place, byte) in self.part(offset, bytes.len())?.iter_mut().zip(bytes) {
            *place &= byte;
        }
        Ok(())
    }
}

//! Where program text comes from: a slice in flash, a file on a desktop, a block device.

/// Random access to the bytes of an NC program file. Loops and subroutines read parts of it again.
pub trait Text {
    /// Copies bytes from `offset` on into `buffer` and says how many; 0 at the end of the text.
    fn read(&mut self, offset: u32, buffer: &mut [u8]) -> Result<usize, TextError>;
}

/// The text could not be read (device error).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct TextError;

impl Text for &[u8] {
    fn read(&mut self, offset: u32, buffer: &mut [u8]) -> Result<usize, TextError> {
        let rest = self.get(offset as usize..).unwrap_or(&[]);
        let count = rest.len().min(buffer.len());
        if let (Some(to), Some(from)) = (buffer.get_mut(..count), rest.get(..count)) {
            to.copy_from_slice(from);
        }
        Ok(count)
    }
}

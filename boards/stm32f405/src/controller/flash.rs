//! The flash memory of the parameter store: sectors 2 and 3 of the chip, 16 KiB each.
//!
//! During the write of a word or the erase of a sector the processor waits: 16 µs, and up to half a second.
//! The store calls these functions only at standstill. The firmware starts at sector 4.
use embedded_storage::nor_flash::{ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash};
use stm32f4::stm32f405::FLASH;

/// First address, first sector, and sizes.
const ADDRESS: usize = 0x0800_8000;
const FIRST: u8 = 2;
const SECTOR: usize = 16 * 1024;
const BYTES: usize = 2 * SECTOR;

/// Keys that unlock the registers (RM0090, 3.6.2).
const KEYS: [u32; 2] = [0x4567_0123, 0xcdef_89ab];

/// The two sectors.
pub struct Sectors(FLASH);

/// The memory refuses to write, or the address is outside the memory.
#[derive(Debug)]
pub struct Refused;

impl NorFlashError for Refused {
    fn kind(&self) -> NorFlashErrorKind {
        NorFlashErrorKind::Other
    }
}

impl ErrorType for Sectors {
    type Error = Refused;
}

impl Sectors {
    /// Takes over the registers.
    pub const fn new(flash: FLASH) -> Self {
        Self(flash)
    }

    fn wait(&self) -> Result<(), Refused> {
        while self.0.sr().read().bsy().bit_is_set() {}
        let status = self.0.sr().read();
        let bad = status.pgserr().bit_is_set()
            || status.pgperr().bit_is_set()
            || status.pgaerr().bit_is_set()
            || status.wrperr().bit_is_set();
        if bad { Err(Refused) } else { Ok(()) }
    }

    /// Calls a function with unlocked registers and words of 32 bits, which need a supply of 2.7 V or more.
    fn unlocked(&mut self, what: impl FnOnce(&mut Self) -> Result<(), Refused>) -> Result<(), Refused> {
        for key in KEYS {
            // SAFETY: the keys are those of the manual.
            self.0.keyr().write(|w| unsafe { w.bits(key) });
        }
        // Flags of earlier errors are cleared by writing ones.
        // SAFETY: bits 4 to 7, as the manual has them.
        self.0.sr().write(|w| unsafe { w.bits(0xf0) });
        let done = self.wait().and_then(|()| what(self));
        self.0.cr().write(|w| w.lock().set_bit());
        // The data cache may contain the old content.
        self.0.acr().modify(|_, w| w.dcen().clear_bit());
        self.0.acr().modify(|_, w| w.dcrst().set_bit());
        self.0.acr().modify(|_, w| w.dcrst().clear_bit());
        self.0.acr().modify(|_, w| w.dcen().set_bit());
        done
    }
}

/// The address of a range, if the whole range is inside the memory.
fn address(offset: u32, length: usize) -> Result<usize, Refused> {
    let end = (offset as usize).checked_add(length).filter(|end| *end <= BYTES);
    end.map(|_| ADDRESS + offset as usize).ok_or(Refused)
}

impl ReadNorFlash for Sectors {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Refused> {
        let from = address(offset, bytes.len())?;
        for (byte, at) in bytes.iter_mut().zip(from..) {
            // SAFETY: an address inside the two sectors, which can always be read.
            *byte = unsafe { (at as *const u8).read_volatile() };
        }
        Ok(())
    }

    fn capacity(&self) -> usize {
        BYTES
    }
}

impl NorFlash for Sectors {
    const WRITE_SIZE: usize = 4;
    const ERASE_SIZE: usize = SECTOR;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), Refused> {
        address(from, to.checked_sub(from).ok_or(Refused)? as usize)?;
        let [first, end] = [from, to].map(|place| (place as usize).checked_div(SECTOR).unwrap_or(0) as u8);
        self.unlocked(|flash| {
            for sector in first..end {
                flash.0.cr().write(|w| {
                    // SAFETY: sectors 2 and 3.
                    unsafe { w.snb().bits(FIRST + sector) };
                    w.psize().psize32().ser().set_bit()
                });
                flash.0.cr().modify(|_, w| w.strt().set_bit());
                flash.wait()?;
            }
            Ok(())
        })
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Refused> {
        let to = address(offset, bytes.len())?;
        if to % 4 != 0 || bytes.len() % 4 != 0 {
            return Err(Refused);
        }
        self.unlocked(|flash| {
            flash.0.cr().write(|w| w.psize().psize32().pg().set_bit());
            for (word, at) in bytes.chunks_exact(4).zip((to..).step_by(4)) {
                let Some(word) = word.first_chunk() else { continue };
                // SAFETY: an aligned address inside the two sectors, which contain no part of the firmware.
                unsafe { (at as *mut u32).write_volatile(u32::from_le_bytes(*word)) };
                flash.wait()?;
            }
            Ok(())
        })
    }
}

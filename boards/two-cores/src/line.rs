//! The serial line of QEMU's `mps2-an521`, without interrupts.

const DATA: *mut u32 = 0x5020_0000 as *mut u32;
const STATE: *mut u32 = 0x5020_0004 as *mut u32;
const CONTROL: *mut u32 = 0x5020_0008 as *mut u32;
const DIVIDER: *mut u32 = 0x5020_0010 as *mut u32;
/// A byte has arrived.
const RECEIVED: u32 = 2;

/// The byte that asks the sender to begin.
const READY: u32 = 0x11;

/// The line; one core has it.
pub struct Line(());

impl Line {
    /// Turns on receiver and transmitter, and asks the sender to begin.
    pub fn open() -> Self {
        // SAFETY: registers of UART 0, which only this type uses.
        unsafe {
            DIVIDER.write_volatile(16);
            CONTROL.write_volatile(3);
            DATA.write_volatile(READY);
        }
        Self(())
    }

    /// The next byte, if one has arrived.
    pub fn byte(&mut self) -> Option<u8> {
        // SAFETY: as above.
        unsafe { (STATE.read_volatile() & RECEIVED != 0).then(|| DATA.read_volatile() as u8) }
    }
}

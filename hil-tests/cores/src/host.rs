//! Text to the host, and the end: semihosting, which ARM and RISC-V share but for the instruction that calls.
use core::fmt::{self, Write};

const OPEN: usize = 0x01;
const WRITE: usize = 0x05;
const EXIT: usize = 0x18;
/// Why the program ends: as it should, and by an error of its own.
const DONE: usize = 0x2_0026;
const FAILED: usize = 0x2_0023;

#[cfg(target_arch = "arm")]
fn call(operation: usize, argument: usize) -> usize {
    let result;
    // SAFETY: the host reads what the argument points to, and changes nothing else.
    unsafe { core::arch::asm!("bkpt 0xab", inout("r0") operation => result, in("r1") argument) };
    result
}

#[cfg(target_arch = "riscv32")]
fn call(operation: usize, argument: usize) -> usize {
    let result;
    // SAFETY: as above. The three instructions must not be compressed, and lie in one page.
    unsafe {
        core::arch::asm!(
            ".option push", ".option norvc", ".balign 16",
            "slli x0, x0, 0x1f", "ebreak", "srai x0, x0, 7",
            ".option pop",
            inout("a0") operation => result, in("a1") argument,
        );
    }
    result
}

/// Ends the emulation; the emulator leaves with code 0 only on success.
pub fn exit(success: bool) -> ! {
    loop {
        call(EXIT, if success { DONE } else { FAILED });
    }
}

/// Collects text and hands it over in pieces.
pub struct Report {
    handle: usize,
    text: [u8; 256],
    used: usize,
}

impl Report {
    /// Opens the host's output, and starts the counter.
    pub fn open() -> Self {
        crate::counter::start();
        let (name, length, write) = (c":tt", 3, 4);
        let block = [name.as_ptr() as usize, write, length];
        Self { handle: call(OPEN, block.as_ptr() as usize), text: [0; 256], used: 0 }
    }

    /// Hands over what is left.
    pub fn flush(&mut self) {
        let block = [self.handle, self.text.as_ptr() as usize, self.used];
        call(WRITE, block.as_ptr() as usize);
        self.used = 0;
    }
}

impl Write for Report {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        for &byte in text.as_bytes() {
            if self.used == self.text.len() {
                self.flush();
            }
            if let Some(place) = self.text.get_mut(self.used) {
                *place = byte;
                self.used += 1;
            }
        }
        Ok(())
    }
}

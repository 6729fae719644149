//! Lines to the host over semihosting, which an emulator and a probe both understand.
use crate::stack;
use core::arch::naked_asm;
use core::fmt::{self, Write};
use cortex_m_semihosting::hio::{self, HostStream};
use cortex_m_semihosting::{debug, hprintln};
use glidepath::quantity::Position;
use static_cell::ConstStaticCell;

/// Collects text and hands it over in large pieces: every hand-over stops the core.
pub struct Report {
    host: HostStream,
    text: &'static mut [u8; TEXT],
    used: usize,
}

const TEXT: usize = 1024;

/// Not on the stack, whose depth is measured.
static MEMORY: ConstStaticCell<[u8; TEXT]> = ConstStaticCell::new([0; TEXT]);

impl Report {
    /// Opens the host's output; a host without one fails the test.
    pub fn open() -> Self {
        match (hio::hstdout(), MEMORY.try_take()) {
            (Ok(host), Some(text)) => Self { host, text, used: 0 },
            _ => exit(false),
        }
    }

    /// One line `s` with the bits of every axis in hexadecimal.
    pub fn set_points(&mut self, set_points: &[Position]) {
        let mut line = [b' '; 2 + 16 * 8];
        line[0] = b's';
        for (digits, point) in line[2..].chunks_exact_mut(16).zip(set_points) {
            let mut bits = point.to_bits();
            for digit in digits.iter_mut().rev() {
                *digit = b"0123456789abcdef"[(bits & 15) as usize];
                bits >>= 4;
            }
        }
        self.bytes(&line[..2 + 16 * set_points.len()]);
        self.bytes(b"\n");
    }

    /// Hands over what is left.
    pub fn flush(&mut self) {
        let _ = self.host.write_all(&self.text[..self.used]);
        self.used = 0;
    }

    fn bytes(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            if self.used == self.text.len() {
                self.flush();
            }
            self.text[self.used] = byte;
            self.used += 1;
        }
    }
}

impl Write for Report {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        self.bytes(text.as_bytes());
        Ok(())
    }
}

/// Ends the test: the emulator or the probe passes success or failure on as its exit code.
pub fn exit(success: bool) -> ! {
    debug::exit(if success { debug::EXIT_SUCCESS } else { debug::EXIT_FAILURE });
    loop {
        cortex_m::asm::wfi();
    }
}

/// Needs no stack: an overflow of that is what may have led here.
#[unsafe(naked)]
#[unsafe(no_mangle)]
unsafe extern "C" fn HardFault() -> ! {
    naked_asm!(
        "mrs r0, msp",
        "movw r1, #:lower16:_stack_start",
        "movt r1, #:upper16:_stack_start",
        "msr msp, r1",
        "b {}",
        sym fault
    )
}

/// `stack` is the stack pointer behind the exception frame.
extern "C" fn fault(stack: usize) -> ! {
    if stack::is_below(stack) {
        hprintln!("hard fault: stack overflow at {stack:#010x}");
    } else {
        // SAFETY: the frame that the core has put on the stack; its seventh word is where the fault came.
        let at = unsafe { (stack as *const u32).add(6).read_volatile() };
        hprintln!("hard fault at {at:#010x}");
    }
    exit(false)
}

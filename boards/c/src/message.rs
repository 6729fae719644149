//! Writes messages to memory of the C program.
use core::ffi::c_char;
use core::fmt::{self, Display, Write};

/// Text of a fixed size that ends with a NUL; text that does not fit is left out.
struct Message {
    to: *mut c_char,
    /// Number of bytes, NUL included.
    size: usize,
    used: usize,
}

impl Write for Message {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        for letter in text.chars() {
            let mut bytes = [0; 4];
            let bytes = letter.encode_utf8(&mut bytes).as_bytes();
            // A character is written completely or not at all, and nothing is written after a character that
            // does not fit.
            if bytes.len() >= self.size.saturating_sub(self.used) {
                self.size = self.used.min(self.size);
                return Ok(());
            }
            for byte in bytes {
                // SAFETY: the comparison above keeps the index inside the caller's memory.
                unsafe { self.to.add(self.used).write(*byte as c_char) };
                self.used += 1;
            }
        }
        Ok(())
    }
}

/// Writes `what` and a NUL.
///
/// # Safety
/// `to` is null or points to `size` bytes.
pub unsafe fn write(to: *mut c_char, size: usize, what: &dyn Display) {
    if to.is_null() || size == 0 {
        return;
    }
    let mut message = Message { to, size, used: 0 };
    let _ = write!(message, "{what}");
    // SAFETY: a letter always leaves room for the NUL.
    unsafe { to.add(message.used).write(0) };
}

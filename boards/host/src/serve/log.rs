//! `--log`: every byte of the serial line with its time.
use std::fs::File;
use std::io::{self, Write};
use std::path::Path;
use std::time::Instant;

/// The file. A row is `SECONDS > BYTES` for what a sender sent, `SECONDS < BYTES` for what it got: printable bytes as they
/// are, `\r`, `\n`, `\xNN` and `\\` for the others. Rows are as the bytes came and went, not lines of the protocol.
pub struct Log {
    file: File,
    begun: Instant,
}

impl Log {
    /// A new file.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn new(path: &Path) -> io::Result<Self> {
        Ok(Self { file: File::create(path)?, begun: Instant::now() })
    }

    /// A row; no bytes, no row.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn row(&mut self, direction: char, bytes: &[u8]) -> io::Result<()> {
        if bytes.is_empty() {
            return Ok(());
        }
        let mut text = String::new();
        for byte in bytes {
            match byte {
                b'\\' => text.push_str("\\\\"),
                b'\r' => text.push_str("\\r"),
                b'\n' => text.push_str("\\n"),
                b' '..=b'~' => text.push(char::from(*byte)),
                _ => text.push_str(&format!("\\x{byte:02x}")),
            }
        }
        writeln!(self.file, "{:.6} {direction} {text}", self.begun.elapsed().as_secs_f64())
    }
}

//! `--log`: every byte of the serial line with its time.
use std::fs::File;
use std::io::{self, Write};
use std::path::Path;
use std::time::Instant;

/// The log file. A row is `SECONDS > BYTES` for bytes from the sender, and `SECONDS < BYTES` for bytes to the
/// sender. Printable bytes are written unchanged, other bytes as `\r`, ` `, `\xNN` and `\\`. Rows are pieces
/// of the stream, not lines of the protocol.
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

    /// Writes a row; without bytes there is no row.
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

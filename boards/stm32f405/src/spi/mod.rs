//! Set points as SPI frames, for an FPGA, a drive or a second controller that makes pulses or currents.
//!
//! | bytes | content |
//! |---|---|
//! | 0…1 | frame number, wraps |
//! | 2 + 4·i … 5 + 4·i | set point of axis i, signed, LSB 2^-16 mm (15 nm) or degree, rounded to nearest |
//! | last 2 | CRC-16 (polynomial 0x1021, start 0xffff) over all bytes before |
//!
//! Little endian; the select line is low during a frame. Three axes take 16 bytes, 12 µs at 10.5 MHz. The
//! core computes during the transfer.
mod frame;
#[cfg(feature = "hardware")]
mod wire;

pub use frame::LONGEST;
#[cfg(feature = "hardware")]
pub use wire::Spi1;

use glidepath::axis::Axes;
use glidepath::quantity::Position;

/// The transport of frames.
pub trait Wire {
    /// Starts to send the first bytes of `frame`, and does not wait for the end.
    fn send(&mut self, frame: &[u8; LONGEST], length: usize);
}

/// Sends one frame per cycle.
pub struct Frames<W> {
    wire: W,
    number: u16,
}

impl<W: Wire> Frames<W> {
    /// Frames from number 0 on.
    pub fn new(wire: W) -> Self {
        Self { wire, number: 0 }
    }
}

impl<W: Wire, const AXES: usize> Axes<AXES> for Frames<W> {
    fn write(&mut self, set_points: &[Position; AXES]) {
        let (frame, length) = frame::frame(self.number, set_points);
        self.number = self.number.wrapping_add(1);
        self.wire.send(&frame, length);
    }
}

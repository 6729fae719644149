//! Set points as SPI frames, for an FPGA, a drive or a second controller that makes pulses or currents of them.
//!
//! | bytes | content |
//! |---|---|
//! | 0…1 | frame number, wraps |
//! | 2 + 4·i … 5 + 4·i | set point of axis i, signed, LSB 2^-16 mm (15 nm) or degree, rounded to nearest |
//! | last 2 | CRC-16 (polynomial 0x1021, start 0xffff) over all bytes before |
//!
//! Little endian; select is low for the length of one frame. Three axes take 16 bytes, 12 µs at 10.5 MHz.
mod bus;

pub use bus::{Pin4, Spi1};

use embedded_hal::digital::OutputPin;
use embedded_hal::spi::SpiBus;
use glidepath::axis::Axes;
use glidepath::quantity::Position;

/// Bits of a set point below the LSB of a frame.
const SHIFT: u32 = 16;

/// Bytes of the longest frame: 8 axes.
const LONGEST: usize = 2 + 4 * 8 + 2;

/// Sends one frame per cycle over `bus`, selected by `select`.
pub struct Frames<Bus, Select> {
    bus: Bus,
    select: Select,
    number: u16,
}

impl<Bus: SpiBus, Select: OutputPin> Frames<Bus, Select> {
    /// Frames from number 0 on.
    pub fn new(bus: Bus, select: Select) -> Self {
        Self { bus, select, number: 0 }
    }

    fn send(&mut self, frame: &[u8]) {
        // A frame that does not get through shows as a gap in the numbers or a wrong CRC at the receiver, which has to
        // bring its drives to rest; there is nothing better to do about it on this side.
        let _ = self.select.set_low();
        let _ = self.bus.write(frame);
        let _ = self.bus.flush();
        let _ = self.select.set_high();
    }
}

impl<Bus: SpiBus, Select: OutputPin, const AXES: usize> Axes<AXES> for Frames<Bus, Select> {
    fn write(&mut self, set_points: &[Position; AXES]) {
        const { assert!(4 + 4 * AXES <= LONGEST) };
        let mut frame = [0; LONGEST];
        let (head, rest) = frame.split_at_mut(2);
        head.copy_from_slice(&self.number.to_le_bytes());
        for (bytes, point) in rest.chunks_exact_mut(4).zip(set_points) {
            let rounded = point.to_bits().wrapping_add(1 << (SHIFT - 1)) >> SHIFT;
            bytes.copy_from_slice(&(rounded as i32).to_le_bytes());
        }
        let length = 2 + 4 * AXES;
        let check = crc16(frame.iter().take(length)).to_le_bytes();
        for (to, from) in frame.iter_mut().skip(length).zip(check) {
            *to = from;
        }
        self.number = self.number.wrapping_add(1);
        if let Some(frame) = frame.get(..length + 2) {
            self.send(frame);
        }
    }
}

/// CRC-16 with polynomial 0x1021, start value 0xffff, most significant bit first.
fn crc16<'a>(bytes: impl Iterator<Item = &'a u8>) -> u16 {
    bytes.fold(0xffff, |crc, &byte| {
        (0..8).fold(crc ^ (u16::from(byte) << 8), |crc, _| {
            if crc & 0x8000 == 0 { crc << 1 } else { (crc << 1) ^ 0x1021 }
        })
    })
}

//! Converts set points to the bytes of a frame, without hardware.
use glidepath::quantity::Position;

/// Bits of a set point below the LSB of a frame.
const SHIFT: u32 = 16;

/// Bytes of the longest frame: 8 axes.
pub const LONGEST: usize = 2 + 4 * 8 + 2;

/// Returns the frame with this number, and the number of used bytes.
pub fn frame<const AXES: usize>(number: u16, set_points: &[Position; AXES]) -> ([u8; LONGEST], usize) {
    const { assert!(4 + 4 * AXES <= LONGEST) };
    let mut frame = [0; LONGEST];
    let (head, rest) = frame.split_at_mut(2);
    head.copy_from_slice(&number.to_le_bytes());
    for (bytes, point) in rest.chunks_exact_mut(4).zip(set_points) {
        let rounded = point.to_bits().wrapping_add(1 << (SHIFT - 1)) >> SHIFT;
        bytes.copy_from_slice(&(rounded as i32).to_le_bytes());
    }
    let length = 2 + 4 * AXES;
    let mut crc = START;
    for byte in frame.iter().take(length) {
        crc = next(crc, *byte);
    }
    for (to, from) in frame.iter_mut().skip(length).zip(crc.to_le_bytes()) {
        *to = from;
    }
    (frame, length + 2)
}

/// CRC-16 with polynomial 0x1021, start value 0xffff, most significant bit first.
const START: u16 = 0xffff;

/// The CRC of each byte alone.
static TABLE: [u16; 256] = {
    let mut table = [0; 256];
    let mut byte = 0;
    while byte < 256 {
        let mut crc = (byte as u16) << 8;
        let mut bit = 0;
        while bit < 8 {
            crc = if crc & 0x8000 == 0 { crc << 1 } else { (crc << 1) ^ 0x1021 };
            bit += 1;
        }
        table[byte] = crc;
        byte += 1;
    }
    table
};

/// The CRC with one byte more.
const fn next(crc: u16, byte: u8) -> u16 {
    // The index is below 256.
    (crc << 8) ^ TABLE[((crc >> 8) as u8 ^ byte) as usize]
}

/// The check value of this CRC in published catalogues.
const _: () = {
    let text = b"123456789";
    let (mut crc, mut i) = (START, 0);
    while i < text.len() {
        crc = next(crc, text[i]);
        i += 1;
    }
    assert!(crc == 0x29b1);
};

//! Pairs of numbers for tests, and a digest of what a core computes from them.
//!
//! The operators here are those of the language: instructions on a PC, the functions of this crate on a core
//! without floating point. Both must give the same digest.
use core::hint::black_box;

/// A generator of numbers (xorshift).
pub struct Random(u64);

impl Random {
    /// The generator that begins at a number other than 0.
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// Any 64 bits.
    pub fn bits(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0 ^ self.0 >> 32 ^ self.0 << 29
    }

    /// The bits of two numbers: any, of exponents with a difference below 29, neighbours, with few bits,
    /// subnormal, or of small exponents.
    pub fn pair(&mut self) -> (u32, u32) {
        let (kind, bits) = (self.bits() >> 20 & 7, self.bits());
        let (a, b) = ((bits >> 32) as u32, bits as u32);
        match kind {
            0 | 1 => (a, b),
            2 | 3 => (a, (a & 0x7f80_0000).wrapping_add(((b >> 23) % 29) << 23) ^ (b & 0x807f_ffff)),
            4 => (a, a.wrapping_add(b & 7).wrapping_sub(3) ^ (b & 1 << 31)),
            5 => (a & 0xffff_0000, b & 0xffff_f000),
            6 => (a & 0x80ff_ffff, b),
            _ => ((a & 0x80ff_ffff) | 63 << 24, (b & 0x80ff_ffff) | 63 << 24),
        }
    }
}

/// Takes in the bits of a number; all NaNs are alike.
fn take(digest: u64, x: f32) -> u64 {
    take_bits(digest, if x.is_nan() { 0x7fc0_0000 } else { u64::from(x.to_bits()) })
}

fn take_bits(digest: u64, bits: u64) -> u64 {
    (digest ^ bits).wrapping_mul(0x0000_0100_0000_01b3).rotate_left(23)
}

/// Digest of sums, differences, products, quotients, comparisons and conversions of so many pairs, and of a
/// product of integers.
#[inline(never)]
pub fn digest(seed: u64, pairs: u32) -> u64 {
    let (mut numbers, mut digest) = (Random::new(seed), 0);
    for _ in 0..pairs {
        let (a, b) = numbers.pair();
        let (x, y) = (black_box(f32::from_bits(a)), black_box(f32::from_bits(b)));
        for result in [x + y, x - y, x * y, x / y] {
            digest = take(digest, result);
        }
        let comparisons = [x < y, x <= y, x > y, x >= y, x == y, x != y];
        for truth in comparisons {
            digest = take_bits(digest, truth.into());
        }
        let long = black_box(numbers.bits() >> (a & 63));
        let (high, low) = ((long >> 32) as u32, long as u32);
        for result in [low as f32, low as i32 as f32, long as f32, long as i64 as f32, (high as i32) as f32] {
            digest = take(digest, result);
        }
        digest = take_bits(digest, x as u64 ^ (x as i64 as u64).rotate_left(11));
        digest = take_bits(digest, u64::from(y as u32) ^ u64::from(y as i32 as u32).rotate_left(32));
        digest =
            take_bits(digest, black_box(long).wrapping_mul(black_box(u64::from(a) << 32 | u64::from(b))));
        digest = take_bits(digest, black_box(u64::from(a)).wrapping_mul(black_box(u64::from(b))));
    }
    digest
}

/// Whether copies of bytes are right at all places in a word, of all lengths below 40.
///
/// A core of ARM copies by functions of its own.
pub fn copies() -> bool {
    let source: [u8; 48] = core::array::from_fn(|n| n as u8 ^ 0xa5);
    for (from, to) in (0..16).map(|places| (places & 3, places >> 2)) {
        for length in 0..40usize {
            let mut target = [0u8; 48];
            let (source, target_part) = (source.get(from..from + length), target.get_mut(to..to + length));
            if let (Some(source), Some(target_part)) = (source, target_part) {
                target_part.copy_from_slice(black_box(source));
            }
            let target = black_box(target);
            let is_right = |(n, byte): (usize, &u8)| {
                let expected = if (to..to + length).contains(&n) { (n - to + from) as u8 ^ 0xa5 } else { 0 };
                *byte == expected
            };
            if !target.iter().enumerate().all(is_right) {
                return false;
            }
        }
    }
    true
}

//! The moving average: a running sum that is never summed up.
//!
//! n·y grows by what the newest sample is more than the oldest one, whatever the length n.

/// Shift of a difference before it is divided, and what is added to a remainder so that it is never negative:
/// that many divisors.
const SCALE: u32 = 13;
const BIAS: u32 = 14;

/// What the mean of one axis remembers.
pub(super) struct Mean {
    /// 2^32 by the length, up.
    factor: i32,
    /// Remainders of the last two set points, with [`BIAS`].
    rest: [i32; 2],
}

impl Mean {
    /// Of no axis.
    pub const ZERO: Self = Self { factor: 0, rest: [0; 2] };

    /// Of so many samples. Divides: once per change, not in a tick of motion.
    pub fn of(length: u32) -> Self {
        let length = length.max(1);
        Self { factor: (u32::MAX / length).wrapping_add(1) as i32, rest: [(length << BIAS) as i32; 2] }
    }

    /// How much a mean of `length` samples grows where their sum does by `grows`, below 2^44.
    ///
    /// n·y + r = S + r′, with the remainders r of this set point and r′ of the last one: n·Δy = ΔS + 2r′ − r″
    /// − r. The quotient is found in two steps: of the upper bits, then of what is left.
    #[inline(always)]
    pub fn grow(&mut self, grows: i64, length: u32) -> i64 {
        let factor = i64::from(self.factor);
        let [last, before] = self.rest;
        let upper = ((((grows >> SCALE) as i32 as i64) * factor) >> 32) as i32;
        let left = (grows as i32)
            .wrapping_sub((upper << SCALE).wrapping_mul(length as i32))
            .wrapping_add(2 * last - before);
        let lower = ((left as i64 * factor) >> 32) as i32 - (1 << BIAS);
        let rest = left.wrapping_sub(lower.wrapping_mul(length as i32));
        self.rest = [rest, last];
        (i64::from(upper) << SCALE).wrapping_add(i64::from(lower))
    }
}

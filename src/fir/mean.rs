//! The moving average of n samples as a running sum. In each tick, the newest sample is added and the oldest
//! one is subtracted. So the cost does not depend on n.

/// Number of bits by which a difference is shifted right before the first of two divisions.
const SCALE: u32 = 13;
/// The upper quotient is reduced by this value, so the remainder is never negative.
const BIAS: i32 = 2;

/// The state of one axis. Words that are used together share 64 bits: one access.
pub(super) struct Mean {
    /// 2^32 divided by the length, rounded up, and the length times 2^[`SCALE`]. Powers of two are stored,
    /// because a multiplication is faster than a shift of two words.
    upper: u64,
    /// Rounding remainders of the last set point and of the one before.
    rest: u64,
    /// 2^[`SCALE`], and the length, for the lower quotient.
    lower: u64,
}

impl Mean {
    /// A mean without samples.
    pub const ZERO: Self = Self { upper: 0, rest: 0, lower: 0 };

    /// A mean of `length` samples. The function divides, so call it for a change of filters and not in a
    /// tick.
    pub fn of(length: u32) -> Self {
        let length = length.max(1);
        let factor = (u32::MAX / length).wrapping_add(1);
        Self { upper: pair(factor, length << SCALE), rest: 0, lower: pair(1 << SCALE, length) }
    }

    /// The set point after `y`, if the sum of the samples changes by `grows`, which is below 2^44.
    ///
    /// n·y + r = S + r′, with the remainders r of this set point and r′ of the last one. So n·Δy = ΔS + 2r′ −
    /// r″ − r. The quotient comes in two steps: first from the upper bits, then from the remainder.
    #[inline(always)]
    pub fn follow(&mut self, grows: i64, y: i64) -> i64 {
        let ([factor, long], [last, before], [scale, length]) =
            (halves(self.upper), halves(self.rest), halves(self.lower));
        let quotient = |value: i32| ((i64::from(value) * i64::from(factor)) >> 32) as i32;
        let upper = quotient((grows >> SCALE) as i32).wrapping_sub(BIAS);
        let left =
            (grows as i32).wrapping_sub(upper.wrapping_mul(long)).wrapping_add(2 * last).wrapping_sub(before);
        let lower = quotient(left);
        self.rest = pair(left.wrapping_sub(lower.wrapping_mul(length)) as u32, last as u32);
        let y = y.wrapping_add(i64::from(upper) * i64::from(scale));
        y.wrapping_add(i64::from(lower as u32))
    }
}

const fn pair(lower: u32, upper: u32) -> u64 {
    (upper as u64) << 32 | lower as u64
}

const fn halves(pair: u64) -> [i32; 2] {
    [pair as i32, (pair >> 32) as i32]
}

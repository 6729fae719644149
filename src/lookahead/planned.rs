//! A planned speed in four bytes, for the memory of a block.
//!
//! A planned speed has 27 significant bits, rounded down. Limits have 24 bits (`f32`), so they are stored
//! exactly. The planner rounds a speed to this format before it uses the speed, so storing changes nothing.
//! Only the start speed of the first block has all its bits: it is the actual speed of the motion
//! ([`super::ring::Ring`]).
use crate::quantity::Speed;

/// A planned speed, or none. The order is that of the speeds; none is below all of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Planned(u32);

/// Number of bits after the first one.
const BITS: u32 = 26;

/// Number of low bits that do not fit into the format, for a speed that is not negative.
#[cfg_attr(feature = "fast", inline(always))]
const fn beyond(bits: i64) -> u32 {
    (i64::BITS - BITS - 1).saturating_sub(bits.leading_zeros())
}

/// The highest storable speed that is at most `v`; `v` is not negative.
#[cfg_attr(feature = "fast", inline(always))]
pub(super) const fn settled(v: Speed) -> Speed {
    let bits = v.to_bits();
    let beyond = beyond(bits);
    Speed::from_bits(bits >> beyond << beyond)
}

impl Planned {
    /// The value for a block without a planned speed; all bits zero.
    pub const NONE: Self = Self(0);
    /// The speed 0: the motion stops.
    pub const ZERO: Self = Self::below(Speed::ZERO);

    /// The highest storable speed that is at most `v`; none for a negative `v`.
    #[cfg_attr(feature = "fast", inline(always))]
    pub const fn below(v: Speed) -> Self {
        let bits = v.to_bits();
        if bits < 0 {
            return Self::NONE;
        }
        let beyond = beyond(bits);
        // The first bit counts in the exponent. Exponents end at 37, so a value is free for none.
        Self((beyond << BITS) + (bits >> beyond) as u32 + 1)
    }

    /// The speed. Without a planned speed, the result is [`super::block::UNPLANNED`], which is negative.
    #[cfg_attr(feature = "fast", inline(always))]
    pub const fn speed(self) -> Speed {
        let Some(bits) = self.0.checked_sub(1) else { return super::block::UNPLANNED };
        let beyond = (bits >> BITS).saturating_sub(1);
        Speed::from_bits(((bits - (beyond << BITS)) as i64) << beyond)
    }

    /// [`Self::below`] as a function call instead of inlined code, which takes less flash. For callers that
    /// do not go through all blocks.
    #[inline(never)]
    pub const fn below_by_call(v: Speed) -> Self {
        Self::below(v)
    }

    /// [`Self::speed`] as a function call instead of inlined code, as in [`Self::below_by_call`].
    #[inline(never)]
    pub const fn speed_by_call(self) -> Speed {
        self.speed()
    }

    /// Whether a speed is planned.
    pub const fn is_some(self) -> bool {
        self.0 != 0
    }

    /// Stores four bytes of other data in place of a speed.
    pub const fn of_bits(bits: u32) -> Self {
        Self(bits)
    }

    /// The four bytes, see [`Self::of_bits`].
    pub const fn bits(self) -> u32 {
        self.0
    }
}

//! A planned speed in four bytes.
//!
//! It has 27 significant bits, cut below, and is exact where a limit is: that has 24. All speeds that blocks are
//! planned with are such speeds, so that what is kept is what was planned; the first block begins with the speed
//! that the motion has: [`super::ring::Ring`].
use crate::quantity::Speed;

/// A planned speed, or none. They compare as speeds do; none is below all of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Planned(u32);

/// Bits behind the first one.
const BITS: u32 = 26;

/// By how much a speed, not negative, is too long for them.
#[cfg_attr(feature = "fast", inline(always))]
const fn beyond(bits: i64) -> u32 {
    (i64::BITS - BITS - 1).saturating_sub(bits.leading_zeros())
}

/// The highest speed that can be planned, at most `v`, not negative.
#[cfg_attr(feature = "fast", inline(always))]
pub(super) const fn settled(v: Speed) -> Speed {
    let bits = v.to_bits();
    let beyond = beyond(bits);
    Speed::from_bits(bits >> beyond << beyond)
}

impl Planned {
    /// No speed; all bits zero.
    pub const NONE: Self = Self(0);
    /// A stop.
    pub const ZERO: Self = Self::below(Speed::ZERO);

    /// The highest one that is at most `v`; none below zero.
    #[cfg_attr(feature = "fast", inline(always))]
    pub const fn below(v: Speed) -> Self {
        let bits = v.to_bits();
        if bits < 0 {
            return Self::NONE;
        }
        let beyond = beyond(bits);
        // The first bit counts as one of the exponent. Exponents end at 37, so there is room for none.
        Self((beyond << BITS) + (bits >> beyond) as u32 + 1)
    }

    /// The speed; the one below zero ([`super::block::UNPLANNED`]) for none.
    #[cfg_attr(feature = "fast", inline(always))]
    pub const fn speed(self) -> Speed {
        let Some(bits) = self.0.checked_sub(1) else { return super::block::UNPLANNED };
        let beyond = (bits >> BITS).saturating_sub(1);
        Speed::from_bits(((bits - (beyond << BITS)) as i64) << beyond)
    }

    /// [`Self::below`] where no pass asks for each block: a call, which takes less room in flash.
    #[inline(never)]
    pub const fn below_by_call(v: Speed) -> Self {
        Self::below(v)
    }

    /// [`Self::speed`], as [`Self::below_by_call`].
    #[inline(never)]
    pub const fn speed_by_call(self) -> Speed {
        self.speed()
    }

    /// Whether there is a speed.
    pub const fn is_some(self) -> bool {
        self.0 != 0
    }

    /// Four bytes of something else, and those.
    pub const fn of_bits(bits: u32) -> Self {
        Self(bits)
    }

    /// See [`Self::of_bits`].
    pub const fn bits(self) -> u32 {
        self.0
    }
}

//! The limits of a block in the compact form that the look-ahead stores: seven numbers, and five bits for the
//! slope.
//!
//! With CONST_VEL (constant speed in a curve), only the lower jerk of each direction is stored. This costs no
//! speed, because accelerations are small there.
use super::limits::{Joins, Limits, Loose, SlopeLaw, lower};
use super::ramp_shape::RampShape;
use crate::machine::functions::STEP_BUILT;
use crate::math::float::{max, min};

/// The numeric part of the limits of one block, as the look-ahead stores it. The other part is [`LawKind`].
#[derive(Clone, Copy, Debug)]
pub struct Numbers {
    /// Speed, mm/tick.
    pub v: f32,
    /// Acceleration and deceleration, mm/tick².
    a: [f32; 2],
    /// Numbers of the slope, in this order. TRAPEZ, SIN2, HSC: mean jerks, mm/tick³. STEP: change-over speed,
    /// both accelerations above this speed, deceleration at standstill. With CONST_VEL: the lower jerk of
    /// each direction, an unused number, the acceleration of [`Loose`]. STEP with CONST_VEL: change-over
    /// speed, the lower acceleration, the acceleration of [`Loose`], deceleration at standstill.
    law: [f32; 4],
}

/// The part of stored limits that is not a number, in five bits: the kind of slope, which blocks may share a
/// span, and whether CONST_VEL demands a constant speed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LawKind(u8);

impl LawKind {
    /// Bits of the byte that this type does not use. A block stores other marks in them.
    pub const FREE: u8 = !(Self::LAW | Self::JOINS | Self::STAYS);

    const LAW: u8 = 3;
    const SINE: u8 = RampShape::SineSquare as u8;
    const STEPPED: u8 = 2;
    const ACROSS: u8 = 3;
    const JOINS: u8 = 12;
    const ANY: u8 = Joins::Any as u8;
    const VALLEYS: u8 = Joins::Valleys as u8;
    const STAYS: u8 = 16;

    /// Takes the kind from a byte; the bits of [`Self::FREE`] are ignored.
    #[inline(always)]
    pub const fn of(byte: u8) -> Self {
        Self(byte & !Self::FREE)
    }

    /// The five bits, for the byte in which a block stores them. The bits of [`Self::FREE`] are 0.
    #[inline(always)]
    pub const fn bits(self) -> u8 {
        self.0
    }

    /// Whether the look-ahead may permit acceleration at the ends of slow blocks: see
    /// [`Limits::may_have_valleys`].
    #[inline(always)]
    pub const fn may_have_valleys(self) -> bool {
        self.0 & Self::JOINS == Self::VALLEYS
    }

    /// Whether blocks with other speeds may be in one span with this block: see [`Limits::varies`].
    #[inline(always)]
    pub const fn varies(self) -> bool {
        self.0 & Self::JOINS != 0
    }

    /// Whether CONST_VEL demands a constant speed in the block: see [`Loose`].
    #[inline(always)]
    pub const fn stays(self) -> bool {
        self.0 & Self::STAYS != 0
    }

    #[inline(always)]
    const fn joins(self) -> Joins {
        if self.0 & Self::VALLEYS != 0 {
            Joins::Valleys
        } else if self.0 & Self::ANY != 0 {
            Joins::Any
        } else {
            Joins::Alike
        }
    }
}

impl Numbers {
    /// Numbers of an unused place: all bits are zero.
    pub const NOTHING: Self = Self { v: 0.0, a: [0.0; 2], law: [0.0; 4] };

    /// The limits from which [`Limits::kept`] made these numbers. `kind`: the other part from the same call.
    #[cfg_attr(feature = "fast", inline(always))]
    pub fn limits(&self, kind: LawKind) -> Limits {
        let (v, [a_up, a_down], [w, x, y, z]) = (self.v, self.a, self.law);
        let (stays, stepped) = (kind.stays(), kind.0 & LawKind::STEPPED != 0);
        let law = if let (true, Some(built)) = (stepped, STEP_BUILT) {
            let across = kind.0 & LawKind::LAW == LawKind::ACROSS;
            let (change_over, a_up, a_down) = (w, x, if stays { x } else { y });
            SlopeLaw::Stepped { change_over, a_up, a_down, still: z, across, built }
        } else {
            let sine = kind.0 & LawKind::SINE != 0;
            let shape = if sine { RampShape::SineSquare.built() } else { RampShape::Linear };
            SlopeLaw::JerkLimited {
                shape,
                joins: kind.joins(),
                j: if stays { [w, w, x, x] } else { self.law },
            }
        };
        let loose = match (stays, stepped) {
            (false, _) => Loose::NONE,
            (true, false) => Loose::of(z),
            (true, true) => Loose::of(y),
        };
        Limits { v, a_up, a_down, law, loose }
    }
}

impl Limits {
    /// Lowers these limits to those of another block of the same span, as [`Self::join`]. The other block's
    /// limits are in stored form.
    #[cfg_attr(feature = "fast", inline(always))]
    pub(crate) fn join_kept(&mut self, numbers: &Numbers, kind: LawKind) {
        let SlopeLaw::JerkLimited { j, .. } = &mut self.law else { return self.join_any(numbers, kind) };
        if kind.0 & (LawKind::STEPPED | LawKind::STAYS) != 0 {
            return self.join_any(numbers, kind);
        }
        lower(j, numbers.law);
        self.v = max(self.v, numbers.v);
        self.a_up = min(self.a_up, numbers.a[0]);
        self.a_down = min(self.a_down, numbers.a[1]);
        self.loose = Loose::NONE;
    }

    #[inline(never)]
    fn join_any(&mut self, numbers: &Numbers, kind: LawKind) {
        self.join(&numbers.limits(kind));
    }

    /// Divides the limits into the two parts that a block stores; [`Numbers::limits`] joins them again. With
    /// CONST_VEL, only the lower jerk of each direction is kept.
    #[cfg_attr(feature = "fast", inline(always))]
    pub fn kept(&self) -> (Numbers, LawKind) {
        let stays = self.loose.is_some();
        let a = self.loose.get();
        let (law, kind) = match self.law {
            SlopeLaw::JerkLimited { shape, joins, j } => {
                let law = if stays { [min(j[0], j[1]), min(j[2], j[3]), 0.0, a] } else { j };
                (law, shape as u8 | joins as u8)
            }
            SlopeLaw::Stepped { change_over, a_up, a_down, still, across, .. } => {
                let kind = if across { LawKind::ACROSS } else { LawKind::STEPPED };
                let upper = if stays { [min(a_up, a_down), a] } else { [a_up, a_down] };
                ([change_over, upper[0], upper[1], still], kind)
            }
        };
        let kind = if stays { kind | LawKind::STAYS } else { kind };
        (Numbers { v: self.v, a: [self.a_up, self.a_down], law }, LawKind(kind))
    }
}

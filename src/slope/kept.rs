//! Limits as the look-ahead keeps them for each of its blocks: seven numbers, and in some bits what their law is.
//! As an enum they would take four bytes more.
use super::limits::{Joins, Limits, SlopeLaw};
use super::ramp_shape::RampShape;

/// The numbers of limits.
#[derive(Clone, Copy, Debug)]
pub struct Numbers {
    /// Speed, mm/tick.
    pub v: f32,
    /// Acceleration and deceleration, mm/tick².
    a: [f32; 2],
    /// Those of the law: mean jerks, mm/tick³; of STEP the change-over speed, both accelerations above it, and
    /// the deceleration at standstill.
    law: [f32; 4],
}

/// Which law limits have, in the lower four bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LawKind(u8);

impl LawKind {
    /// Bits that are free for other use.
    pub const FREE: u8 = !(Self::LAW | Self::JOINS);

    const LAW: u8 = 3;
    const SINE: u8 = 1;
    const STEPPED: u8 = 2;
    const ACROSS: u8 = 3;
    const JOINS: u8 = 12;
    const ANY: u8 = 4;
    const VALLEYS: u8 = 8;

    /// Those bits of a byte.
    #[inline(always)]
    pub const fn of(byte: u8) -> Self {
        Self(byte & !Self::FREE)
    }

    /// The bits.
    #[inline(always)]
    pub const fn bits(self) -> u8 {
        self.0
    }

    /// As [`Limits::may_have_valleys`] says it.
    #[inline(always)]
    pub const fn may_have_valleys(self) -> bool {
        self.0 & Self::JOINS == Self::VALLEYS
    }

    /// As [`Limits::varies`] says it.
    #[inline(always)]
    pub const fn varies(self) -> bool {
        self.0 & Self::JOINS != 0
    }

    const fn joins(self) -> Joins {
        match self.0 & Self::JOINS {
            Self::ANY => Joins::Any,
            Self::VALLEYS => Joins::Valleys,
            _ => Joins::Alike,
        }
    }
}

impl Numbers {
    /// All bits zero.
    pub const NOTHING: Self = Self { v: 0.0, a: [0.0; 2], law: [0.0; 4] };

    /// The limits that these numbers and this law are.
    #[inline(always)]
    pub fn limits(&self, kind: LawKind) -> Limits {
        let (v, [a_up, a_down], [w, x, y, z]) = (self.v, self.a, self.law);
        let across = kind.0 & LawKind::LAW == LawKind::ACROSS;
        let law = if kind.0 & LawKind::STEPPED != 0 {
            SlopeLaw::Stepped { change_over: w, a_up: x, a_down: y, still: z, across }
        } else {
            let sine = kind.0 & LawKind::SINE != 0;
            let shape = if sine { RampShape::SineSquare } else { RampShape::Linear };
            SlopeLaw::JerkLimited { shape, joins: kind.joins(), j: self.law }
        };
        Limits { v, a_up, a_down, law }
    }
}

impl Limits {
    /// Their numbers and their law.
    #[inline(always)]
    pub fn kept(&self) -> (Numbers, LawKind) {
        let (law, kind) = match self.law {
            SlopeLaw::JerkLimited { shape, joins, j } => {
                let shape = if shape == RampShape::SineSquare { LawKind::SINE } else { 0 };
                let joins = match joins {
                    Joins::Alike => 0,
                    Joins::Any => LawKind::ANY,
                    Joins::Valleys => LawKind::VALLEYS,
                };
                (j, shape | joins)
            }
            SlopeLaw::Stepped { change_over, a_up, a_down, still, across } => {
                let kind = if across { LawKind::ACROSS } else { LawKind::STEPPED };
                ([change_over, a_up, a_down, still], kind)
            }
        };
        (Numbers { v: self.v, a: [self.a_up, self.a_down], law }, LawKind(kind))
    }
}

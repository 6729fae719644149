//! What may be due at a point of the path, and what an application implements: where M, H, S and T go.
use crate::quantity::Position;

/// Technology functions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Function {
    /// M function.
    M(u16),
    /// H function.
    H(u16),
    /// S: spindle speed, 1/min.
    Spindle(#[cfg_attr(feature = "defmt", defmt(Debug2Format))] Position),
    /// T: tool number.
    Tool(u32),
}

/// A planned acknowledgement, or none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Ticket(pub(crate) u32);

impl Ticket {
    /// Nothing waits.
    pub(crate) const NONE: Self = Self(0);

    /// Whether the motion waits for it.
    pub const fn waits(self) -> bool {
        self.0 != 0
    }
}

/// What is due when the path reaches a point. Each kind is carried out in one place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Action {
    /// The operator puts a function out; the ticket is its acknowledgement, if the motion waits for one.
    Out(Function, Ticket),
}

/// A technology function at its point of the motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Output {
    /// The number of the tick that reached the point: ticks since the split, from 0, whether the path moved
    /// in them or not; modulo 2^31.
    pub tick: u32,
    /// Programmed N number.
    pub n: u32,
    /// What to do.
    pub function: Function,
    /// The motion goes on, at its synchronisation point, only after
    /// [`acknowledge`](crate::operator::Operator::acknowledge).
    pub waits: bool,
}

/// Carries out technology functions. A machine hands them to its PLC, a simulator writes them down.
pub trait Technology {
    /// Takes over a function whose point the motion has reached.
    fn output(&mut self, output: &Output);
}

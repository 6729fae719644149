//! What an application implements: where M, H, S and T go.
use crate::queue::Function;

/// A technology function at its point of the motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Output {
    /// The tick that reached the point: ticks of motion before it, modulo 2^31.
    pub tick: u32,
    /// Programmed N number.
    pub n: u32,
    /// What to do.
    pub function: Function,
    /// The motion goes on, at its synchronisation point, only after
    /// [`acknowledge`](crate::control::Control::acknowledge).
    pub waits: bool,
}

/// Carries out technology functions. A machine hands them to its PLC, a simulator writes them down.
pub trait Technology {
    /// Takes over a function whose point the motion has reached.
    fn output(&mut self, output: &Output);
}

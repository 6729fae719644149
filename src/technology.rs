//! Technology functions of the program: M, H, S and T. The planner places each function at a point of the
//! path. When the motion reaches that point, [`Operator::output`](crate::operator::Operator::output) returns
//! the function.
//!
//! An application calls `output` itself. Or it implements [`Technology`], and calls
//! [`Operator::deliver`](crate::operator::Operator::deliver), which passes all due functions:
//!
//! ```
//! use glidepath::{Function, Output, Technology};
//!
//! #[derive(Default)]
//! struct Plc {
//!     has_coolant: bool,
//! }
//!
//! impl Technology for Plc {
//!     fn output(&mut self, output: &Output) {
//!         match output.function {
//!             Function::M(8) => self.has_coolant = true,
//!             Function::M(9) => self.has_coolant = false,
//!             _ => {}
//!         }
//!     }
//! }
//!
//! let mut plc = Plc::default();
//! plc.output(&Output { tick: 0, n: 10, function: Function::M(8), waits: false });
//! assert!(plc.has_coolant);
//! ```
use crate::quantity::Position;

/// A function of the program that a PLC or the application carries out: M, H, S, T.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Function {
    /// An M function with its number.
    M(u16),
    /// An H function with its number.
    H(u16),
    /// The word S: spindle speed, 1/min.
    Spindle(#[cfg_attr(feature = "defmt", defmt(Debug2Format))] Position),
    /// The word T: tool number.
    Tool(u32),
    /// M62 to M65 of LinuxCNC, a digital output: the port number, and whether the output is switched on.
    #[cfg(feature = "grbl")]
    Digital(u8, bool),
    /// M67 and M68 of LinuxCNC, an analogue output: the port number, and the value.
    #[cfg(feature = "grbl")]
    Analog(u8, #[cfg_attr(feature = "defmt", defmt(Debug2Format))] Position),
    /// M66 of LinuxCNC: the axes stand still until this function is acknowledged.
    #[cfg(feature = "grbl")]
    Input(InputWait),
}

/// What M66 waits for. The application acknowledges the function when the input meets the condition, or when
/// the time is over.
#[cfg(feature = "grbl")]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct InputWait {
    /// Number of the input, as in the program.
    pub port: u8,
    /// `true`: an analogue input (word E). `false`: a digital input (word P).
    pub is_analog: bool,
    /// Word L. 0: no wait. 1: the input rises. 2: the input falls. 3: the input is high. 4: the input is low.
    pub mode: u8,
    /// Word Q: longest wait in ms; 0 for L0.
    pub timeout_ms: u32,
}

/// The number of an acknowledgement that the motion waits for, or none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Ticket(pub(crate) u32);

impl Ticket {
    /// No acknowledgement is needed.
    pub(crate) const NONE: Self = Self(0);

    /// Whether the motion waits for an acknowledgement.
    pub const fn waits(self) -> bool {
        self.0 != 0
    }
}

/// An action at a point of the path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Action {
    /// Output of a function. The ticket names the acknowledgement, if the motion waits for one.
    Out(Function, Ticket),
}

/// A technology function whose point of the path has been reached.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Output {
    /// The number of the tick that reached the point. Ticks count from 0 since `Channel::split`, modulo 2^31.
    pub tick: u32,
    /// N number of the block that programs the function.
    pub n: u32,
    /// The function.
    pub function: Function,
    /// Whether the axes stand still at the synchronisation point until
    /// [`acknowledge`](crate::operator::Operator::acknowledge) is called.
    pub waits: bool,
}

/// A receiver of technology functions: a PLC, or a simulator that records them.
pub trait Technology {
    /// Carries out a function whose point of the path has been reached.
    fn output(&mut self, output: &Output);
}

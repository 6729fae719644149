//! Machine data of the step output: pins, steps per length, times of the drivers, backlash.
use crate::backlash::Backlash;

/// Motors that an axis may have.
pub const MOTORS: usize = 2;

/// A pin of the port, and the level that means "on".
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Pin {
    /// Bit of the port, 0…15.
    pub bit: u8,
    /// Whether the pin is low when on: a pulse goes down, or the positive direction is low.
    pub is_inverted: bool,
}

impl Pin {
    /// A pin that is high when on.
    pub const fn new(bit: u8) -> Self {
        Self { bit, is_inverted: false }
    }

    /// The same pin, low when on.
    pub const fn inverted(self) -> Self {
        Self { is_inverted: !self.is_inverted, ..self }
    }

    /// The port word that switches the pin on.
    pub(crate) const fn on(self) -> u32 {
        if self.is_inverted { self.reset() } else { self.set() }
    }

    /// The port word that switches the pin off.
    pub(crate) const fn off(self) -> u32 {
        if self.is_inverted { self.set() } else { self.reset() }
    }

    /// The lower half of a word sets bits.
    const fn set(self) -> u32 {
        1 << (self.bit & 15)
    }

    /// The upper half resets them.
    const fn reset(self) -> u32 {
        self.set() << 16
    }
}

/// A motor with its two pins.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Motor {
    /// Pin that is on during a pulse.
    pub step: Pin,
    /// Pin that is on while the axis moves in the positive direction.
    pub direction: Pin,
}

impl Motor {
    /// A motor on two pins of the port that are high when on.
    pub const fn new(step: u8, direction: u8) -> Self {
        Self { step: Pin::new(step), direction: Pin::new(direction) }
    }

    /// The same motor, mounted in reverse.
    pub const fn reversed(self) -> Self {
        Self { direction: self.direction.inverted(), ..self }
    }
}

/// The step output of one axis.
///
/// Counts per length are a fraction, so that nothing is rounded. 80 steps per mm are 80 in 1; 250.123 steps
/// per mm are 250,123 in 1,000; 3,200 steps per turn of a rotary axis are 3,200 in 360 (degrees).
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct AxisSteps {
    /// Counts in [`Self::length`], 1…1,000,000,000.
    pub counts: u32,
    /// Length that these counts move, mm (rotary: degrees), 1…1,000,000.
    pub length: u32,
    /// Least time that the step pin stays on, ns; rounded up to slots, one at least.
    pub pulse_ns: u32,
    /// Least time between the end of a pulse and the next one, ns; rounded up to slots, one at least.
    pub gap_ns: u32,
    /// Least time from a change of direction to the next pulse, ns; rounded up to slots.
    pub setup_ns: u32,
    /// Least time from the end of a pulse to a change of direction, ns; rounded up to slots.
    pub hold_ns: u32,
    /// The motors of the axis. Two of them, as in a gantry, get the same steps.
    pub motors: [Option<Motor>; MOTORS],
    /// Play of the drive train that a reversal has to take up; [`Backlash::NONE`]: none.
    pub backlash: Backlash,
}

impl AxisSteps {
    /// An axis with one motor, times that suit common drivers (pulse and gap 2 µs, set-up and hold 1 µs), and no
    /// backlash.
    pub const fn new(counts: u32, length: u32, motor: Motor) -> Self {
        Self {
            counts,
            length,
            pulse_ns: 2000,
            gap_ns: 2000,
            setup_ns: 1000,
            hold_ns: 1000,
            motors: [Some(motor), None],
            backlash: Backlash::NONE,
        }
    }
}

/// The step output of a machine: axes in the order of its machine data, all pins on one port.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct StepData<const AXES: usize> {
    /// Length of a slot, ns. Slots fill the interpolation cycle exactly.
    pub slot_ns: u32,
    /// Step output of each axis.
    pub axes: [AxisSteps; AXES],
}

//! Inputs and outputs of a board through embedded-hal.
use crate::controller::Outputs;
use crate::motion::Spindle;
use crate::state::Signals;
use embedded_hal::digital::{InputPin, OutputPin};
use embedded_hal::pwm::SetDutyCycle;

/// A debounced input: a change counts after a number of equal samples.
pub struct Input<P> {
    pin: P,
    is_inverted: bool,
    /// Number of equal samples after which a change counts.
    looks: u8,
    changed: u8,
    is_on: bool,
}

impl<P: InputPin> Input<P> {
    /// An input that is on while its pin is high, or low if `is_inverted`. A change counts after `looks`
    /// samples, 1…255.
    pub const fn new(pin: P, is_inverted: bool, looks: u8) -> Self {
        Self { pin, is_inverted, looks, changed: 0, is_on: false }
    }

    /// Samples the pin. Returns whether the input is on.
    ///
    /// # Errors
    /// The error of the pin.
    pub fn look(&mut self) -> Result<bool, P::Error> {
        let is_on = self.pin.is_high()? != self.is_inverted;
        self.changed = if is_on == self.is_on { 0 } else { self.changed.saturating_add(1) };
        if self.changed >= self.looks.max(1) {
            (self.is_on, self.changed) = (is_on, 0);
        }
        Ok(self.is_on)
    }
}

/// Samples the limit switches of the axes, in the order of the axes.
///
/// # Errors
/// The error of a pin.
pub fn limits<P: InputPin>(inputs: &mut [Input<P>]) -> Result<Signals, P::Error> {
    let mut signals = Signals::default();
    for (input, axis) in inputs.iter_mut().zip(0..8) {
        if input.look()? {
            signals = signals.and(Signals::limit(axis));
        }
    }
    Ok(signals)
}

/// Spindle and coolant.
pub struct Tool<W, P> {
    /// PWM of the spindle speed.
    pub pwm: W,
    /// On while the spindle turns.
    pub enable: P,
    /// On while the spindle turns counterclockwise.
    pub direction: P,
    /// Mist.
    pub mist: P,
    /// Flood.
    pub flood: P,
}

/// A pin or the PWM failed.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum ToolError<W, P> {
    /// The PWM.
    Pwm(W),
    /// A pin.
    Pin(P),
}

impl<W: SetDutyCycle, P: OutputPin> Tool<W, P> {
    /// Outputs the wanted state of spindle and coolant. The speed goes off before the direction changes.
    ///
    /// # Errors
    /// The error of the first pin that fails; the other pins are not changed.
    pub fn put_out(&mut self, outputs: &Outputs) -> Result<(), ToolError<W::Error, P::Error>> {
        let Outputs { spindle, duty, mist, flood, .. } = *outputs;
        if spindle == Spindle::Off || duty == 0 {
            self.pwm.set_duty_cycle_fully_off().map_err(ToolError::Pwm)?;
        }
        if spindle != Spindle::Off {
            let reverse = spindle == Spindle::CounterClockwise;
            self.direction.set_state(reverse.into()).map_err(ToolError::Pin)?;
        }
        self.enable.set_state((spindle != Spindle::Off).into()).map_err(ToolError::Pin)?;
        if spindle != Spindle::Off && duty != 0 {
            self.pwm.set_duty_cycle_fraction(duty, u16::MAX).map_err(ToolError::Pwm)?;
        }
        self.mist.set_state(mist.into()).map_err(ToolError::Pin)?;
        self.flood.set_state(flood.into()).map_err(ToolError::Pin)
    }
}

//! Computes the wanted state of spindle, coolant and motors for the output pins.
use super::{Around, Controller, Door, Mode};
use crate::motion::{Motion, Spindle};

/// Wanted state of spindle, coolant and motors.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Outputs {
    /// Direction of the spindle; off while the operator, the door or sleep stops the spindle.
    pub spindle: Spindle,
    /// Speed in rpm with the override, between `$31` and `$30`.
    pub rpm: u32,
    /// The speed as part of 65,535: 0 at `$31`, 65,535 at `$30`.
    pub duty: u16,
    /// Mist.
    pub mist: bool,
    /// Flood.
    pub flood: bool,
    /// The motors have current: during motion, and `$1` ms longer.
    pub motors: bool,
}

/// Time in ms for the start of the spindle after the door closes.
pub(super) const SPINDLE_MS: u32 = 4000;

/// Time in ms for the start of coolant.
pub(super) const COOLANT_MS: u32 = 1000;

impl<const AXES: usize, const N: usize> Controller<'_, AXES, N> {
    pub(super) fn put_out<M: Motion<AXES>, S, W: embedded_io::Write>(
        &mut self,
        around: &Around<'_, '_, M, S, W>,
    ) {
        let status = around.motion.status();
        let settings = &self.config.settings;
        let is_off = match self.mode {
            Mode::Door(Door::Parked) | Mode::Sleep | Mode::Alarm(true) => true,
            _ => self.spindle_stopped,
        };
        let coolant_off = match self.mode {
            Mode::Door(Door::Parked) | Mode::Sleep | Mode::Alarm(true) => true,
            Mode::Door(Door::Resuming(since)) => {
                status.spindle != Spindle::Off && around.now_ms.wrapping_sub(since) < SPINDLE_MS
            }
            _ => false,
        };
        let (least, most) = (settings.rpm_min_milli / 1000, settings.rpm_max_milli / 1000);
        let (spindle, rpm) = match status.spindle {
            Spindle::Off => (Spindle::Off, 0),
            _ if is_off => (Spindle::Off, 0),
            direction => {
                let wanted = u64::from(status.rpm) * u64::from(self.overrides.spindle) / 100;
                let rpm = u32::try_from(wanted).unwrap_or(u32::MAX).max(least).min(most.max(least));
                (direction, if status.rpm == 0 { 0 } else { rpm })
            }
        };
        let span = u64::from(most.saturating_sub(least));
        let part = u64::from(rpm.saturating_sub(least)) * 65_535;
        // If `$30` and `$31` are equal, there is only one speed.
        let duty = if rpm == 0 { 0 } else { part.checked_div(span).unwrap_or(65_535).min(65_535) as u16 };
        if status.is_busy || !status.is_at_rest {
            self.moved_ms = around.now_ms;
        }
        let stays_on = settings.idle_ms == 255 && self.mode != Mode::Sleep;
        let is_recent = around.now_ms.wrapping_sub(self.moved_ms) <= u32::from(settings.idle_ms);
        let motors = stays_on || is_recent;
        let [mist, flood] = [status.mist, status.flood].map(|is_on| is_on && !coolant_off);
        self.outputs = Outputs { spindle, rpm, duty, mist, flood, motors };
    }
}

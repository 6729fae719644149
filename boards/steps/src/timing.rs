//! The times that a driver needs (pulse, gap, set-up, hold), rounded up to whole slots of the tick.
use crate::data::AxisSteps;

/// Times in slots. All are at most the number of slots of a tick.
#[derive(Clone, Copy, Debug)]
pub struct Timing {
    /// Time for which the step pin is on.
    pub pulse: u32,
    /// Smallest distance of two steps: a pulse and a gap.
    pub period: u32,
    /// From a change of direction to the next step.
    pub setup: u32,
    /// From the start of a step to the next change of direction: the pulse and the hold time.
    pub hold: u32,
}

impl Timing {
    /// Rounds up; `slot_ns` is not 0.
    pub fn new(data: &AxisSteps, slot_ns: u32) -> Self {
        let slots = |ns: u32| match slot_ns {
            0 => u32::MAX,
            _ => ns.div_ceil(slot_ns),
        };
        let pulse = slots(data.pulse_ns).max(1);
        Self {
            pulse,
            period: pulse.saturating_add(slots(data.gap_ns).max(1)),
            setup: slots(data.setup_ns),
            hold: pulse.saturating_add(slots(data.hold_ns)),
        }
    }

    /// Steps in one direction that fit into a tick of `slots`.
    pub fn most(&self, slots: u32) -> u32 {
        slots.checked_div(self.period).unwrap_or(0)
    }

    /// Steps that fit into a tick of `slots` in which the direction changes as late as possible.
    pub fn most_behind_turn(&self, slots: u32) -> u32 {
        // The step before begins in the last slot of the tick before; the first step after the turn begins at
        // `begin`.
        let begin = self.hold.saturating_sub(1).saturating_add(self.setup);
        match slots.checked_sub(begin) {
            Some(left) => left.div_ceil(self.period.max(1)),
            None => 0,
        }
    }
}

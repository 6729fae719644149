//! Debounces the limit switches and the probe, and stores the positions of the axes at a change of an input.
//!
//! The timer interrupt calls [`Latch::look`] once per tick with a sample of the inputs. An interrupt of the
//! input itself may call [`Latch::edge`] between two ticks, with the position at this moment. The latch
//! stores the position of the first sample that differs. The change counts only after a given number of equal
//! samples; its position is the stored one. A bounce that is shorter than these samples does not change the
//! stored position.
use crate::state::Signals;
use glidepath::Position;

/// One input.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Edge<const AXES: usize> {
    /// The debounced state.
    pub is_on: bool,
    /// Number of counted changes; the number may wrap.
    pub changes: u8,
    /// Machine coordinates of all axes at the last counted change.
    pub place: [Position; AXES],
    candidate: Option<[Position; AXES]>,
    /// Number of samples with the other state.
    other: u8,
    /// Number of samples with the old state since the first different sample.
    quiet: u8,
}

impl<const AXES: usize> Edge<AXES> {
    const OFF: Self =
        Self { is_on: false, changes: 0, place: [Position::ZERO; AXES], candidate: None, other: 0, quiet: 0 };

    fn edge(&mut self, is_on: bool, position: &[Position; AXES]) {
        if is_on != self.is_on && self.candidate.is_none() {
            (self.candidate, self.other, self.quiet) = (Some(*position), 0, 0);
        }
    }

    fn look(&mut self, is_on: bool, position: &[Position; AXES], looks: u8) {
        self.edge(is_on, position);
        let Some(candidate) = self.candidate else { return };
        if is_on == self.is_on {
            (self.other, self.quiet) = (0, self.quiet.saturating_add(1));
            if self.quiet >= looks {
                self.candidate = None;
            }
            return;
        }
        (self.other, self.quiet) = (self.other.saturating_add(1), 0);
        if self.other >= looks {
            (self.is_on, self.place, self.candidate) = (is_on, candidate, None);
            self.changes = self.changes.wrapping_add(1);
        }
    }
}

/// Limit switches of all axes, and the probe.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Latch<const AXES: usize> {
    limits: [Edge<AXES>; AXES],
    probe: Edge<AXES>,
    looks: u8,
}

impl<const AXES: usize> Latch<AXES> {
    /// All inputs are off. A change counts after `looks` equal samples, 1…255.
    pub const fn new(looks: u8) -> Self {
        Self { limits: [Edge::OFF; AXES], probe: Edge::OFF, looks: if looks == 0 { 1 } else { looks } }
    }

    /// Takes a sample between two ticks. `position`: machine coordinates of the axes at this moment.
    pub fn edge(&mut self, signals: Signals, position: &[Position; AXES]) {
        for (edge, axis) in self.limits.iter_mut().zip(0..) {
            edge.edge(signals.has(Signals::limit(axis)), position);
        }
        self.probe.edge(signals.has(Signals::PROBE), position);
    }

    /// Takes the sample of a tick.
    pub fn look(&mut self, signals: Signals, position: &[Position; AXES]) {
        let looks = self.looks;
        for (edge, axis) in self.limits.iter_mut().zip(0..) {
            edge.look(signals.has(Signals::limit(axis)), position, looks);
        }
        self.probe.look(signals.has(Signals::PROBE), position, looks);
    }

    /// Latch of an axis's limit switch.
    pub fn limit(&self, axis: usize) -> Option<&Edge<AXES>> {
        self.limits.get(axis)
    }

    /// Latch of the probe.
    pub const fn probe(&self) -> &Edge<AXES> {
        &self.probe
    }

    /// The debounced inputs.
    pub fn signals(&self) -> Signals {
        let mut signals = if self.probe.is_on { Signals::PROBE } else { Signals::default() };
        for (_, axis) in self.limits.iter().zip(0..).filter(|(edge, _)| edge.is_on) {
            signals = signals.and(Signals::limit(axis));
        }
        signals
    }
}

/// The position at slot `slot` of `slots`, between the set points of two ticks.
pub fn between<const AXES: usize>(
    from: &[Position; AXES],
    to: &[Position; AXES],
    slot: u16,
    slots: u16,
) -> [Position; AXES] {
    let mut at = *to;
    for (at, from) in at.iter_mut().zip(from) {
        let way = i128::from(at.to_bits()) - i128::from(from.to_bits());
        let part = (way * i128::from(slot.min(slots))).checked_div(i128::from(slots)).unwrap_or(way);
        *at = Position::from_bits(from.to_bits().wrapping_add(part as i64));
    }
    at
}

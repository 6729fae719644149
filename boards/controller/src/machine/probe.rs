//! Probing, G38.2 to G38.5: a line on the path that ends when the probe input changes.
//!
//! The line is a normal motion. The change of the input aborts this motion, and the axes brake on the path.
//! The reported position is that of the axes at the change of the input, not the position at standstill.
use super::{Machine, Probing, Scan, offered::End};
use crate::motion::Taken;
use glidepath::quantity::Position;

/// State of a probing motion.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum ProbeCycle<const AXES: usize> {
    /// The axes move until the probe changes.
    Moving(Probing),
    /// The probe has changed at this position; the axes brake.
    Braking([Position; AXES]),
    /// The motion has ended; the line is answered next.
    Ended,
    /// The probe was in its final state before the motion: an alarm answers the line.
    Failed,
}

impl<const AXES: usize, const BLOCKS: usize, const OVERLAYS: usize> Machine<'_, AXES, BLOCKS, OVERLAYS> {
    /// Whether a line probes: by a word of the line, or by the active motion word.
    pub(super) fn probing_of(&self, scan: &Scan) -> Option<Probing> {
        let modal = self.kept.probing.filter(|_| scan.moves_by_modal_word());
        scan.probing.or(modal)
    }

    /// Waits before a probing line until all earlier lines are executed, and checks that the probe is not in
    /// its final state. Returns whether the line may start.
    pub(super) fn may_probe(&mut self, probing: Probing) -> bool {
        if self.is_under_way() {
            self.go_without(0);
            self.work();
            return false;
        }
        if self.inputs.probe().is_on == probing.toward {
            self.cycles.alarm = Some(4);
            self.cycles.probe = Some(ProbeCycle::Failed);
            return false;
        }
        true
    }

    /// The answer of a probing line.
    pub(super) fn answer_probe(&mut self) -> Taken {
        if self.cycles.probe == Some(ProbeCycle::Ended) && !self.cycles.probe_ended {
            self.cycles.probe = None;
            return Taken::Yes;
        }
        Taken::NotYet
    }

    pub(super) fn follow_probe(&mut self) {
        match self.cycles.probe {
            Some(ProbeCycle::Moving(probing)) => {
                let probe = *self.inputs.probe();
                if probe.is_on == probing.toward {
                    self.operator.resume();
                    self.operator.abort();
                    self.line.end = Some(End::Aborted);
                    self.cycles.probe = Some(ProbeCycle::Braking(probe.place));
                    self.work();
                } else if !self.is_under_way() {
                    let place = *self.planner.position();
                    self.end_probe(place, false);
                    if probing.alarms {
                        self.cycles.alarm = Some(5);
                    }
                }
            }
            Some(ProbeCycle::Braking(place)) if !self.is_under_way() => self.end_probe(place, true),
            _ => {}
        }
    }

    fn end_probe(&mut self, place: [Position; AXES], contact: bool) {
        self.kept.probe = (place, contact);
        self.cycles.probe_ended = true;
        self.cycles.probe = Some(ProbeCycle::Ended);
    }
}

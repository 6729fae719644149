//! The transformation of the decoded program: a change of the transformation changes positions.
use super::decode::numbers;
use super::{Kind, Program, Segment};
use crate::tolerance::Tolerance;
use glidepath::kinematics::Kinematic;
use glidepath::nc::{Head, Kinematics};
use glidepath::quantity::Position;

/// The selection of a program. The planner reports refusals.
pub(super) struct Switch<'a> {
    pub(super) sets: &'a [Kinematic],
    pub(super) selected: u16,
    pub(super) active: Option<&'a Kinematic>,
}

impl Switch<'_> {
    /// Handles a command. Returns the active transformation and the position, if they change.
    pub(super) fn take<const AXES: usize>(
        &mut self,
        command: Kinematics,
        at: &[Position; AXES],
    ) -> (Option<u16>, Option<[Position; AXES]>) {
        match command {
            Kinematics::Select(id) => self.selected = id,
            Kinematics::OnWith(id) => self.selected = id,
            Kinematics::On | Kinematics::Off => {}
        }
        let on = matches!(command, Kinematics::On | Kinematics::OnWith(_));
        let off = command == Kinematics::Off;
        match self.active {
            None if on => {
                self.active = self.sets.iter().find(|set| set.id == self.selected);
                (self.active.map(|set| set.id), self.active.and_then(|set| set.workpiece(at)))
            }
            Some(set) if off => {
                self.active = None;
                (Some(0), set.axes(at))
            }
            _ => (None, None),
        }
    }
}

impl Program {
    /// The transformation changes, and with it all later positions.
    pub(super) fn transform(&mut self, head: &Head, at: &[Position], id: u16) {
        self.transformed.push((self.motions, id));
        self.stop();
        self.segments.push(Segment {
            n: head.n,
            place: head.place,
            kind: Kind::Dwell(0.0),
            end: numbers(at),
            feed: None,
            stop: true,
            smoothed: false,
            tolerance: Tolerance::default(),
            dynamics: self.latest_dynamics(),
        });
    }
}

//! `#CONTOUR MODE [DEV]` while a kinematic transformation is active: decides whether contour mode or Surface
//! smooths the corners.
//!
//! The curve of DEV takes at most half of each line. In a run of short lines, such curves bend twice as much
//! as the run, and their third derivative grows as the lines become shorter. A rotary axis that turns the
//! tool permits little acceleration and jerk, so these curves are slow. The smoothing curves of Surface
//! overlap, and make one even curve from a run of equal corners.
//!
//! So under a transformation, Surface smooths the corners with the tolerances of DEV. Surface leaves edges to
//! contour mode ([`super::edged`]). If the program uses settings that Surface does not have, contour mode
//! rounds all corners.
use super::edged::Edged;
use super::{Kind, Selected, Smoother, Smoothing, Wanted, surface};
use crate::dynamics::Dynamics;
use crate::nc::Contour;

impl<const AXES: usize> Smoothing<AXES> {
    /// Whether Surface works for DEV. Surface then waits for late text, as DEV does, so that the path does
    /// not depend on the arrival time of text.
    pub(super) fn is_row(&self) -> bool {
        matches!(self.kind, Kind::Surface(_)) && self.selected == Selected::None && self.wanted.is_none()
    }

    /// Takes a command of contour mode while Surface works for DEV. Where the command changes settings, the last
    /// block ends at its programmed point.
    pub(super) fn change_row(&mut self, command: &Contour) {
        let before = self.contour;
        self.contour.command(command);
        if self.contour != before {
            self.want(Wanted::Contour);
        }
    }

    /// Chooses the smoother for the next block. While a block is held back, the smoother stays.
    pub(super) fn choose_row(&mut self, dynamics: &Dynamics<AXES>) {
        if self.selected != Selected::None || self.holds() {
            return;
        }
        match &self.kind {
            Kind::Contour(contouring) if dynamics.is_transformed() && self.measure.is_space() => {
                let settings = contouring.settings();
                if settings.is_row() {
                    self.contour = settings;
                    self.begin_row();
                }
            }
            Kind::Surface(_) if !dynamics.is_transformed() => self.begin_contour(),
            _ => {}
        }
    }

    #[cold]
    #[inline(never)]
    fn begin_row(&mut self) {
        let parameters = surface::Parameters::of_contour(self.contour.parameters());
        self.kind = Kind::Surface(Edged::new(self.measure, &parameters));
    }
}

//! `#CONTOUR MODE [DEV]` under a transformation. Takes the settings of contour mode, and chooses the smoother.
//!
//! A curve of DEV takes at most half of each line. In a row of short lines it bends twice as much as the row, and its
//! third derivative grows as lines become shorter. An axis that turns the tool has little acceleration and jerk, so
//! this costs time. The kernels of Surface overlap, so a row of equal corners is one even curve.
//!
//! Under a transformation the smoother of Surface therefore works with the tolerances of DEV. It compares each corner
//! and leaves edges to contour mode ([`super::edged`]). Settings that Surface does not have stay with contour mode.
use super::edged::Edged;
use super::{Kind, Selected, Smoother, Smoothing, Wanted, surface};
use crate::dynamics::Dynamics;
use crate::nc::Contour;

impl<const AXES: usize> Smoothing<AXES> {
    /// Whether Surface works for DEV. It then waits for late text, as DEV does: the path must not depend on the
    /// arrival time of text.
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

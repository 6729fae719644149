//! Direct splines: the commands G151 (on) and G150 (off), and their parameters.
use super::spline::{self, DirectParameters, Mode, Start};
use super::{Before, Kind, Selected, Smoothing, SplineError, Wanted};
use crate::nc::{NcWarningKind, Spline, SplineType, Tangent};

impl<const AXES: usize> Smoothing<AXES> {
    /// Takes a command of direct splines. Returns a warning about the command, if there is one.
    ///
    /// # Errors
    /// The command is refused; nothing has changed.
    pub fn spline(
        &mut self,
        command: &Spline<AXES>,
        before: &Before<'_, AXES>,
    ) -> Result<Option<NcWarningKind>, SplineError> {
        match command {
            Spline::On | Spline::Off if matches!(self.selected, Selected::Hsc(_)) => Err(SplineError::InHsc),
            Spline::On if self.selected == Selected::Spline => Ok(None),
            Spline::On => self.begin_spline(before),
            Spline::Off if self.selected == Selected::None => Ok(None),
            Spline::Off => self.end_spline().map(|()| None),
            _ => {
                self.spline.update(command, before.taken);
                Ok(None)
            }
        }
    }

    /// Carries out G151.
    fn begin_spline(&mut self, before: &Before<'_, AXES>) -> Result<Option<NcWarningKind>, SplineError> {
        self.check_axes()?;
        if self.rounds_corners() {
            return Err(SplineError::InSpline);
        }
        let mode = match self.spline.kind {
            SplineType::Akima => Mode::Akima,
            SplineType::Bspline => Mode::Direct,
        };
        let mut start = Start { mode, slope: None, entry: None };
        let mut remark = None;
        match self.spline.ends[0] {
            Tangent::Auto => {}
            Tangent::User => start.slope = self.vector(0),
            Tangent::Tangential if mode == Mode::Akima => {
                let exit = before.exit.filter(|_| !self.spline.is_fresh(before.taken));
                start.entry = exit.copied();
                remark = start.entry.is_none().then_some(NcWarningKind::NoTangent);
            }
            Tangent::Tangential => {}
        }
        self.keep_contour();
        self.selected = Selected::Spline;
        self.want(Wanted::Spline(start));
        Ok(remark)
    }

    /// Carries out G150.
    fn end_spline(&mut self) -> Result<(), SplineError> {
        let (points, needed) = (self.points(), self.spline.points());
        if points < needed {
            return Err(SplineError::TooFewPoints { points, needed });
        }
        let end = if self.spline.ends[1] == Tangent::User { self.vector(1) } else { None };
        if let Kind::Spline(splining) = &mut self.kind {
            splining.switch_off(end, self.spline.ends[1] == Tangent::Tangential);
        }
        self.selected = Selected::None;
        Ok(())
    }

    /// Number of points of the active spline.
    fn points(&self) -> u32 {
        match &self.kind {
            Kind::Spline(splining) if self.wanted.is_none() => splining.points().max(1),
            _ => 1,
        }
    }

    /// The slope that the program gives for one end of the curve, if it gives one.
    fn vector(&self, end: usize) -> Option<[f32; AXES]> {
        spline::slope(&self.measure, &self.spline.vector(end)?)
    }

    /// Whether a block may move this axis at an end of the active spline although its start and end positions
    /// are equal for this axis.
    pub(super) fn leans(&self, axis: usize) -> bool {
        self.selected == Selected::Spline && self.spline.leans(axis)
    }

    /// Restores the parameters of program start.
    pub(super) const fn restart_direct(&mut self) {
        self.spline = DirectParameters::at_start();
    }
}

//! Stands in for Surface or for the splines in a build without them ([`crate::machine::functions`]). The type
//! has no values, so it needs neither memory nor code.
use super::spline::Mode;
#[cfg(not(feature = "splines"))]
use super::{Before, Selected, Smoothing, SplineError};
use super::{Parting, ProgrammedBlock, Smoothed, Smoother};
use crate::dynamics::Dynamics;
#[cfg(not(feature = "splines"))]
use crate::nc::Spline;
use crate::nc::{NcWarningKind, Place};
use core::convert::Infallible;

/// A build without direct splines: only the command that switches a spline off arrives here.
#[cfg(not(feature = "splines"))]
impl<const AXES: usize> Smoothing<AXES> {
    /// Takes the command that switches a spline off.
    ///
    /// # Errors
    /// `#HSC` is on.
    pub const fn spline(
        &mut self,
        command: &Spline<AXES>,
        _: &Before<'_, AXES>,
    ) -> Result<Option<NcWarningKind>, SplineError> {
        match command {
            Spline::On | Spline::Off if matches!(self.selected, Selected::Hsc(_)) => Err(SplineError::InHsc),
            _ => Ok(None),
        }
    }

    /// No axis has a start or end vector.
    pub(super) const fn leans(&self, _: usize) -> bool {
        false
    }

    /// There are no parameters.
    pub(super) const fn restart_direct(&mut self) {}
}

/// A type without values.
#[derive(Clone, Copy, Debug)]
pub struct Absent<const AXES: usize>(Infallible);

/// The same interface as a spline.
impl<const AXES: usize> Absent<AXES> {
    pub const fn points(&self) -> u32 {
        match self.0 {}
    }

    pub const fn mode(&self) -> Mode {
        match self.0 {}
    }

    pub const fn switch_off(&mut self, _: Option<[f32; AXES]>, _: bool) {
        match self.0 {}
    }
}

impl<const AXES: usize> Smoother<AXES> for Absent<AXES> {
    fn take(&mut self, _: &ProgrammedBlock<AXES>, _: &Dynamics<AXES>, _: Parting) {
        match self.0 {}
    }

    fn work(&mut self, _: &Dynamics<AXES>) -> bool {
        match self.0 {}
    }

    fn emit(&mut self, _: impl FnOnce(&Smoothed<'_, AXES>)) -> bool {
        match self.0 {}
    }

    fn flush(&mut self, _: bool) {
        match self.0 {}
    }

    fn cancel(&mut self) {
        match self.0 {}
    }

    fn clear(&mut self) {
        match self.0 {}
    }

    fn restart(&mut self) {
        match self.0 {}
    }

    fn place(&self) -> Option<Place> {
        match self.0 {}
    }

    fn remark(&mut self) -> Option<NcWarningKind> {
        match self.0 {}
    }

    fn is_idle(&self) -> bool {
        match self.0 {}
    }

    fn is_empty(&self) -> bool {
        match self.0 {}
    }

    fn rounds(&self) -> bool {
        match self.0 {}
    }

    fn holds(&self) -> bool {
        match self.0 {}
    }

    fn gives_way(&mut self) -> bool {
        match self.0 {}
    }
}

//! Stands in for contour mode in a build without contour mode ([`crate::machine::functions`]). This contour
//! mode is always off, so all blocks pass unchanged.
use super::contour::{Preset, Settings};
use super::{Parting, ProgrammedBlock, Smoothed, Smoother};
use crate::dynamics::Dynamics;
use crate::nc::{Contour, NcWarningKind, Place};
use crate::path::Measure;

/// Contour mode that is off.
#[derive(Clone, Copy, Debug)]
pub struct Straight<const AXES: usize> {
    settings: Settings,
}

impl<const AXES: usize> Straight<AXES> {
    /// Contour mode that stays off.
    pub fn new(_: Measure, preset: Preset) -> Self {
        Self { settings: Settings::off(preset) }
    }

    /// Contour mode that stays off, with the machine data in `settings`.
    pub fn with(_: Measure, settings: &Settings) -> Self {
        Self { settings: settings.restarted() }
    }

    /// Takes the machine data in `settings`; contour mode stays off.
    pub fn begin(&mut self, settings: &Settings) {
        self.settings = settings.restarted();
    }

    /// The settings of contour mode that are in force.
    pub const fn settings(&self) -> Settings {
        self.settings
    }

    /// The only command that arrives here switches contour mode off.
    pub const fn command(&mut self, _: &Contour, _: bool) {}
}

impl<const AXES: usize> Smoother<AXES> for Straight<AXES> {
    fn take(&mut self, _: &ProgrammedBlock<AXES>, _: &Dynamics<AXES>, _: Parting) {}

    fn work(&mut self, _: &Dynamics<AXES>) -> bool {
        false
    }

    fn emit(&mut self, _: impl FnOnce(&Smoothed<'_, AXES>)) -> bool {
        false
    }

    fn flush(&mut self, _: bool) {}

    fn cancel(&mut self) {}

    fn clear(&mut self) {}

    fn restart(&mut self) {}

    fn place(&self) -> Option<Place> {
        None
    }

    fn remark(&mut self) -> Option<NcWarningKind> {
        None
    }

    fn is_idle(&self) -> bool {
        true
    }

    fn is_empty(&self) -> bool {
        true
    }

    fn rounds(&self) -> bool {
        false
    }

    fn holds(&self) -> bool {
        false
    }

    fn gives_way(&mut self) -> bool {
        false
    }
}

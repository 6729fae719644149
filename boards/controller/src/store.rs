//! What outlives power: settings, startup lines, and the text of `$I`.
use crate::settings::Settings;

/// A parameter store. A call returns when the data are safe; the axes are at rest meanwhile. `false`: not stored.
pub trait Store<const AXES: usize> {
    /// Keeps all settings.
    fn settings(&mut self, settings: &Settings<AXES>) -> bool;

    /// Keeps startup line 0 or 1.
    fn startup(&mut self, number: u8, line: &[u8]) -> bool;

    /// Keeps the text of `$I`.
    fn info(&mut self, text: &[u8]) -> bool;
}

/// No store: everything is forgotten when power goes.
impl<const AXES: usize> Store<AXES> for () {
    fn settings(&mut self, _: &Settings<AXES>) -> bool {
        true
    }

    fn startup(&mut self, _: u8, _: &[u8]) -> bool {
        true
    }

    fn info(&mut self, _: &[u8]) -> bool {
        true
    }
}

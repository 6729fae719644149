//! Data that survive a power cut: settings, offsets with stored positions, and startup lines with the text of
//! `$I`.
//!
//! ```text
//!  controller ─sets→ Store: Parameters ─records→ Log ─words→ flash (embedded-storage)
//! ```
//!
//! Each of these three sets is one record. So after a power cut a set is the old one or the new one, never a
//! mixture.
#[cfg(feature = "file")]
mod file;
mod log;
mod memory;
mod parameters;
mod record;

#[cfg(feature = "file")]
pub use file::{FileError, FileFlash};
pub use log::Unfit;
pub use memory::MemoryFlash;
pub use parameters::Parameters;

use crate::settings::Settings;
use glidepath::nc::StoredOffsets;

/// A parameter store. A call returns after the data are stored; the axes stand still during the call.
/// `false`: not stored.
pub trait Store<const AXES: usize> {
    /// Stores all settings.
    fn settings(&mut self, settings: &Settings<AXES>) -> bool;

    /// Stores the values of G10, G28.1 and G30.1.
    fn offsets(&mut self, offsets: &StoredOffsets<AXES>) -> bool;

    /// Stores both startup lines and the text of `$I`.
    fn texts(&mut self, startup: [&[u8]; 2], info: &[u8]) -> bool;
}

/// A store that is elsewhere.
impl<const AXES: usize, S: Store<AXES>> Store<AXES> for &mut S {
    fn settings(&mut self, settings: &Settings<AXES>) -> bool {
        (**self).settings(settings)
    }

    fn offsets(&mut self, offsets: &StoredOffsets<AXES>) -> bool {
        (**self).offsets(offsets)
    }

    fn texts(&mut self, startup: [&[u8]; 2], info: &[u8]) -> bool {
        (**self).texts(startup, info)
    }
}

/// `None` is no store, as `()`.
impl<const AXES: usize, S: Store<AXES>> Store<AXES> for Option<S> {
    fn settings(&mut self, settings: &Settings<AXES>) -> bool {
        self.as_mut().is_none_or(|store| store.settings(settings))
    }

    fn offsets(&mut self, offsets: &StoredOffsets<AXES>) -> bool {
        self.as_mut().is_none_or(|store| store.offsets(offsets))
    }

    fn texts(&mut self, startup: [&[u8]; 2], info: &[u8]) -> bool {
        self.as_mut().is_none_or(|store| store.texts(startup, info))
    }
}

/// No store: everything is forgotten when power goes.
impl<const AXES: usize> Store<AXES> for () {
    fn settings(&mut self, _: &Settings<AXES>) -> bool {
        true
    }

    fn offsets(&mut self, _: &StoredOffsets<AXES>) -> bool {
        true
    }

    fn texts(&mut self, _: [&[u8]; 2], _: &[u8]) -> bool {
        true
    }
}

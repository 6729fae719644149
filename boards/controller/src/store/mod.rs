//! What outlives power: settings, work offsets with stored places, startup lines with the text of `$I`.
//!
//! ```text
//!  controller ─sets→ Store: Parameters ─records→ Log ─words→ flash (embedded-storage)
//! ```
//!
//! What belongs together is one record, so a power cut leaves the old set or the new one, and never a mixture.
#[cfg(feature = "file")]
mod file;
mod log;
mod memory;
mod parameters;
mod record;

#[cfg(feature = "file")]
pub use file::FileFlash;
pub use log::Unfit;
pub use memory::MemoryFlash;
pub use parameters::Parameters;

use crate::settings::Settings;
use glidepath::nc::StoredOffsets;

/// A parameter store. A call returns when the data are safe; the axes are at rest meanwhile. `false`: not stored.
pub trait Store<const AXES: usize> {
    /// Keeps all settings.
    fn settings(&mut self, settings: &Settings<AXES>) -> bool;

    /// Keeps what G10, G28.1 and G30.1 have stored.
    fn offsets(&mut self, offsets: &StoredOffsets<AXES>) -> bool;

    /// Keeps both startup lines and the text of `$I`.
    fn texts(&mut self, startup: [&[u8]; 2], info: &[u8]) -> bool;
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

//! The parameter store in flash memory: implements [`Store`].
use super::Store;
use super::log::{Log, Unfit};
use super::record;
use crate::controller::Config;
use crate::motion::Message;
use crate::settings::Settings;
use core::fmt::Write;
use embedded_storage::nor_flash::NorFlash;
use glidepath::nc::StoredOffsets;

/// Stores settings, work offsets with stored positions, and texts of a machine with `AXES` axes in the flash
/// memory `F`.
///
/// Each of the three sets is one record with version and checksum. After a power cut each set is the old one
/// or the new one. The memory needs two halves of whole erase blocks, with room for eight records each. A
/// half needs 4 KiB for up to five axes, and 8 KiB for six to eight. A call writes a record, and sometimes
/// also erases a half.
pub struct Parameters<F, const AXES: usize> {
    log: Log<F>,
}

impl<F: NorFlash, const AXES: usize> Parameters<F, AXES> {
    /// Opens the store. A memory without records is empty: the first write erases the memory.
    ///
    /// # Errors
    /// The memory cannot contain the store.
    pub fn open(flash: F) -> Result<Self, Unfit> {
        Ok(Self { log: Log::open(flash, record::longest(AXES))? })
    }

    /// Copies settings and texts into the start values of the controller, and returns the offsets for the
    /// machine. If a stored set does not fit this build, the defaults stay, and the controller reports this
    /// after its banner.
    pub fn load(&mut self, config: &mut Config<AXES>) -> StoredOffsets<AXES> {
        let mut unread = heapless::Vec::<&str, 3>::new();
        let mut read = |is_known: bool, name| {
            if !is_known {
                // There are three sets.
                let _ = unread.push(name);
            }
        };
        if let Some((version, content)) = self.log.get(record::SETTINGS) {
            let settings = record::read_settings(content, &config.defaults);
            let known = settings.filter(|_| version == record::VERSION);
            config.settings = known.unwrap_or(config.settings);
            read(known.is_some(), "settings");
        }
        let mut offsets = StoredOffsets::ZERO;
        if let Some((version, content)) = self.log.get(record::OFFSETS) {
            let known = record::read_offsets(content).filter(|_| version == record::VERSION);
            offsets = known.unwrap_or(offsets);
            read(known.is_some(), "work offsets");
        }
        if let Some((version, content)) = self.log.get(record::TEXTS) {
            let known = record::read_texts(content).filter(|_| version == record::VERSION);
            read(known.is_some(), "startup lines");
            if let Some([first, second, info]) = known {
                (config.startup, config.info) = ([first, second], info);
            }
        }
        if let Some((first, others)) = unread.split_first() {
            let mut notice = Message::new();
            // The message is cut if the text is too long.
            let _ = write!(notice, "stored {first}");
            for other in others {
                let _ = write!(notice, ", {other}");
            }
            let _ = write!(notice, " cannot be read: defaults are in force");
            config.notice = notice;
        }
        offsets
    }

    /// Where the memory holds something that is no whole record: the offset of the first such place, in bytes. A memory that
    /// takes each change whole, as a file does, never has that. On a chip a power cut may leave such a place, and the
    /// record before it is in force.
    ///
    /// # Errors
    /// The memory cannot be read.
    pub fn damage(&mut self) -> Result<Option<u32>, Unfit> {
        self.log.damage()
    }

    /// Whether the store holds work offsets.
    pub fn has_offsets(&self) -> bool {
        self.log.has(record::OFFSETS)
    }

    /// The memory.
    pub fn into_flash(self) -> F {
        self.log.into_flash()
    }

    fn put(&mut self, kind: u8, content: Option<record::Content>) -> bool {
        content.is_some_and(|content| self.log.put(kind, record::VERSION, &content).is_ok())
    }
}

impl<F: NorFlash, const AXES: usize> Store<AXES> for Parameters<F, AXES> {
    fn settings(&mut self, settings: &Settings<AXES>) -> bool {
        self.put(record::SETTINGS, record::settings(settings))
    }

    fn offsets(&mut self, offsets: &StoredOffsets<AXES>) -> bool {
        self.put(record::OFFSETS, record::offsets(offsets))
    }

    fn texts(&mut self, startup: [&[u8]; 2], info: &[u8]) -> bool {
        self.put(record::TEXTS, record::texts(startup, info))
    }
}

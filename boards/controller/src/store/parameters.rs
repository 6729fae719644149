//! The parameter store in a flash memory.
use super::Store;
use super::log::{Log, Unfit};
use super::record;
use crate::controller::Config;
use crate::motion::Message;
use crate::settings::Settings;
use core::fmt::Write;
use embedded_storage::nor_flash::NorFlash;
use glidepath::nc::StoredOffsets;

/// Settings, work offsets with stored places, and texts of a machine with `AXES` axes in the flash memory `F`.
///
/// Each of the three sets is one record with version and check sum. After a power cut each set is the old one or the new
/// one. The memory needs two halves of whole erase blocks with room for eight records each: with up to five axes 4 KiB,
/// with six to eight 8 KiB. A call takes as long as the memory needs to write a record, and now and then to erase a half.
pub struct Parameters<F, const AXES: usize> {
    log: Log<F>,
}

impl<F: NorFlash, const AXES: usize> Parameters<F, AXES> {
    /// Opens the store. A memory that holds no record is empty: it is erased at the first write.
    ///
    /// # Errors
    /// A memory that cannot hold it.
    pub fn open(flash: F) -> Result<Self, Unfit> {
        Ok(Self { log: Log::open(flash, record::longest(AXES))? })
    }

    /// Puts settings and texts into what the controller begins with, and gives the offsets for the machine. A set that
    /// is there but is not one of this build keeps its default; then the controller says so behind its banner.
    pub fn load(&mut self, config: &mut Config<AXES>) -> StoredOffsets<AXES> {
        let mut unread = heapless::Vec::<&str, 3>::new();
        let mut read = |is_known: bool, name| {
            if !is_known {
                // There are three.
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
            // A text that is too long is cut.
            let _ = write!(notice, "stored {first}");
            for other in others {
                let _ = write!(notice, ", {other}");
            }
            let _ = write!(notice, " cannot be read: defaults are in force");
            config.notice = notice;
        }
        offsets
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

//! `--store`: settings, offsets and startup lines in a file, by the parameter store of the boards.
use super::{AXES, BLOCKS, settings};
use glidepath::channel::Channel;
use glidepath::machine::MachineData;
use glidepath::nc::StoredOffsets;
use glidepath_controller::Config;
use glidepath_controller::store::{FileFlash, Parameters, Unfit};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

/// The file. Each change is whole in it before its line is answered.
pub struct Kept {
    path: PathBuf,
    pub parameters: Parameters<FileFlash, AXES>,
}

impl Kept {
    /// Opens the file, or makes one.
    ///
    /// # Errors
    /// It cannot be opened, is no store, or is damaged.
    pub fn open(path: &Path) -> io::Result<Self> {
        let flash = FileFlash::open(path).map_err(|error| refused(path, error.kind(), &error.to_string()))?;
        let unfit = |unfit: Unfit| refused(path, ErrorKind::InvalidData, &format!("{unfit:?}"));
        let mut parameters = Parameters::open(flash).map_err(unfit)?;
        if let Some(offset) = parameters.damage().map_err(unfit)? {
            let message = format!(
                "damaged, or no parameter store: what begins at byte {offset} is no record with its check sum; \
                 expected: a file that --store has written. Without the file the machine file's values are in force"
            );
            return Err(refused(path, ErrorKind::InvalidData, &message));
        }
        Ok(Self { path: path.to_owned(), parameters })
    }

    /// Puts what the file holds into `config`, and gives the machine data with these settings and the offsets. What the
    /// file does not hold is as the machine file has it.
    ///
    /// # Errors
    /// What it holds does not fit this machine.
    pub fn load(
        &mut self,
        machine: &MachineData<AXES>,
        config: &mut Config<AXES>,
    ) -> io::Result<(MachineData<AXES>, StoredOffsets<AXES>)> {
        let offsets = self.parameters.load(config);
        if !config.notice.is_empty() {
            return Err(refused(&self.path, ErrorKind::InvalidData, &config.notice));
        }
        let data = config.settings.onto(machine, &config.defaults);
        if let Err(error) = Channel::<AXES, BLOCKS, AXES>::check(&data) {
            let message = format!("the stored settings do not fit the machine: {error}");
            return Err(refused(&self.path, ErrorKind::InvalidData, &message));
        }
        Ok((data, if self.parameters.has_offsets() { offsets } else { settings::stored(machine) }))
    }
}

fn refused(path: &Path, kind: ErrorKind, message: &str) -> io::Error {
    io::Error::new(kind, format!("{}: {message}", path.display()))
}

//! Files that appear only when the run has succeeded, all of them or none.
use crate::diagnose::Diagnostic;
use std::fs::{self, File};
use std::io::Write;
use std::path::{Path, PathBuf};

/// Written beside their final names, and renamed by [`Outputs::commit`]; dropped without it, they vanish.
pub struct Outputs {
    files: Vec<(PathBuf, PathBuf)>,
    /// What must not be overwritten: the inputs, then every output.
    taken: Vec<PathBuf>,
}

impl Outputs {
    /// None yet; `inputs` are protected.
    pub fn new(inputs: impl IntoIterator<Item = PathBuf>) -> Self {
        let taken = inputs.into_iter().filter_map(|path| path.canonicalize().ok()).collect();
        Self { files: Vec::new(), taken }
    }

    /// Opens a file that will be called `path`.
    pub fn create(&mut self, path: &Path) -> Result<File, Vec<Diagnostic>> {
        let name = path.file_name().ok_or_else(|| refused(path, "a file name is missing"))?;
        if path.is_dir() {
            return Err(refused(path, "it is a directory"));
        }
        if path.exists() && !path.is_file() {
            // A device or a pipe: it has no content to keep whole, and must not be replaced.
            return File::options().write(true).open(path).map_err(|error| refused(path, error));
        }
        // Where a link leads there is the file to replace, not the link.
        let path = path.canonicalize().unwrap_or_else(|_| path.to_path_buf());
        if self.taken.contains(&path) {
            return Err(refused(&path, "this run reads or writes it already"));
        }
        let mut partial = name.to_os_string();
        partial.push(format!(".{}-{}.part", std::process::id(), self.files.len()));
        let partial = path.with_file_name(partial);
        let file = File::create(&partial).map_err(|error| refused(&path, error))?;
        self.taken.push(path.clone());
        self.files.push((partial, path));
        Ok(file)
    }

    /// A whole file at once.
    pub fn write(&mut self, path: &Path, bytes: &[u8]) -> Result<(), Vec<Diagnostic>> {
        self.create(path)?.write_all(bytes).map_err(|error| refused(path, error))
    }

    /// Gives the files their names.
    pub fn commit(&mut self) -> Result<(), Vec<Diagnostic>> {
        for (partial, path) in &self.files {
            fs::rename(partial, path).map_err(|error| refused(path, error))?;
        }
        self.files.clear();
        Ok(())
    }
}

impl Drop for Outputs {
    fn drop(&mut self) {
        for (partial, _) in &self.files {
            // Nothing sensible is left to do where this fails: the file is marked as a part by its name.
            let _ = fs::remove_file(partial);
        }
    }
}

/// The message for a file that cannot be written.
pub fn refused(path: &Path, reason: impl std::fmt::Display) -> Vec<Diagnostic> {
    vec![Diagnostic::error(format!("cannot write {}: {reason}", path.display()))]
}

//! Output files that appear only when the run has succeeded: all files or none.
use crate::diagnose::Diagnostic;
use std::fs::{self, File};
use std::io::{self, Seek, Write};
use std::path::{Path, PathBuf};

/// Output files under temporary names, so that an interrupted run leaves no files. [`Outputs::commit`] writes
/// the files next to their final names and renames them.
pub struct Outputs {
    files: Vec<Kept>,
    /// Files that must not be overwritten: the inputs, then every output.
    taken: Vec<PathBuf>,
    /// One output goes to the standard output.
    on_stdout: bool,
}

/// A file that is not in its place yet.
struct Kept {
    content: File,
    /// Temporary name and final name.
    partial: PathBuf,
    path: PathBuf,
}

impl Outputs {
    /// No outputs yet; `inputs` are protected.
    pub fn new(inputs: impl IntoIterator<Item = PathBuf>) -> Self {
        let taken = inputs.into_iter().filter_map(|path| path.canonicalize().ok()).collect();
        Self { files: Vec::new(), taken, on_stdout: false }
    }

    /// Whether one of the outputs goes to the standard output.
    pub fn on_stdout(&self) -> bool {
        self.on_stdout
    }

    /// Opens a file with the final name `path`; `-` is the standard output.
    pub fn create(&mut self, path: &Path) -> Result<Box<dyn Write>, Vec<Diagnostic>> {
        if path == Path::new("-") {
            self.on_stdout = true;
            return Ok(Box::new(std::io::stdout()));
        }
        let name = path.file_name().ok_or_else(|| refused(path, "a file name is missing"))?;
        if path.is_dir() {
            return Err(refused(path, "it is a directory"));
        }
        if path.exists() && !path.is_file() {
            // A device or a pipe has no content to protect, and must not be replaced.
            let file = File::options().write(true).open(path).map_err(|error| refused(path, error))?;
            return Ok(Box::new(file));
        }
        // If the name is a link, its target is replaced, not the link. A file that does not exist yet is
        // identified by its directory, for every path to this directory.
        let path = path.canonicalize().unwrap_or_else(|_| in_its_directory(path));
        if self.taken.contains(&path) {
            return Err(refused(&path, "this run reads or writes it already"));
        }
        let mut partial = name.to_os_string();
        partial.push(format!(".{}-{}.part", std::process::id(), self.files.len()));
        let partial = path.with_file_name(partial);
        let mut options = File::options();
        options.read(true).write(true).create(true).truncate(true);
        let unwritable = |error| refused(&path, error);
        let file = options.open(&partial).map_err(unwritable)?;
        // If a file that is in use keeps its name, the file is removed at the end of the run.
        let _ = fs::remove_file(&partial);
        let content = file.try_clone().map_err(unwritable)?;
        self.taken.push(path.clone());
        self.files.push(Kept { content, partial, path });
        Ok(Box::new(file))
    }

    /// Writes a whole file at once.
    pub fn write(&mut self, path: &Path, bytes: &[u8]) -> Result<(), Vec<Diagnostic>> {
        let mut out = self.create(path)?;
        out.write_all(bytes).and_then(|()| out.flush()).map_err(|error| refused(path, error))
    }

    /// Renames the files to their final names.
    pub fn commit(&mut self) -> Result<(), Vec<Diagnostic>> {
        for Kept { content, partial, path } in &mut self.files {
            let write = |content: &mut File| -> io::Result<()> {
                content.rewind()?;
                io::copy(content, &mut File::create(&*partial)?)?;
                Ok(())
            };
            write(content).map_err(|error| refused(path, error))?;
        }
        for Kept { partial, path, .. } in &self.files {
            fs::rename(partial, path).map_err(|error| refused(path, error))?;
        }
        self.files.clear();
        Ok(())
    }
}

impl Drop for Outputs {
    fn drop(&mut self) {
        for Kept { partial, .. } in &self.files {
            // If the removal fails, the file stays under its temporary name.
            let _ = fs::remove_file(partial);
        }
    }
}

/// Returns the path of a file with the canonical path of its directory.
fn in_its_directory(path: &Path) -> PathBuf {
    let parent = path.parent().filter(|parent| *parent != Path::new(""));
    let directory = parent.unwrap_or(Path::new(".")).canonicalize();
    match (directory, path.file_name()) {
        (Ok(directory), Some(name)) => directory.join(name),
        _ => path.to_path_buf(),
    }
}

/// The message for a file that cannot be written.
pub fn refused(path: &Path, reason: impl std::fmt::Display) -> Vec<Diagnostic> {
    vec![Diagnostic::error(format!("cannot write {}: {reason}", path.display()))]
}

//! Generates the header of the C interface from the sources, and runs C programs with the library.
pub mod c;

use std::path::{Path, PathBuf};

/// `boards/c`.
pub fn folder() -> PathBuf {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    here.parent().unwrap_or(here).to_path_buf()
}

/// The path of the header.
pub fn file() -> PathBuf {
    folder().join("include/glidepath.h")
}

/// Generates the header from the sources.
///
/// # Errors
/// A source that cbindgen cannot read.
pub fn header() -> Result<String, String> {
    let config = cbindgen::Config::from_file(folder().join("cbindgen.toml"))?;
    // The generator also reads the modules of these files, in this order.
    let builder = cbindgen::Builder::new().with_config(config).with_src(folder().join("src/lib.rs"));
    let mut text = Vec::new();
    builder.generate().map_err(|e| e.to_string())?.write(&mut text);
    String::from_utf8(text).map_err(|e| e.to_string())
}

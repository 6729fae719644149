//! The header of the C interface, made of its sources.
use std::path::{Path, PathBuf};

/// Sources in the order in which the header shows them.
const SOURCES: [&str; 8] =
    ["lib", "result", "machine", "interpolator", "planner", "operator", "feeder", "storage"];

/// `boards/c`.
pub fn folder() -> PathBuf {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    here.parent().unwrap_or(here).to_path_buf()
}

/// Where the header is.
pub fn file() -> PathBuf {
    folder().join("include/glidepath.h")
}

/// The header as the sources have it.
///
/// # Errors
/// A source that cbindgen cannot read.
pub fn header() -> Result<String, String> {
    let config = cbindgen::Config::from_file(folder().join("cbindgen.toml"))?;
    let mut builder = cbindgen::Builder::new().with_config(config);
    for name in SOURCES {
        builder = builder.with_src(folder().join("src").join(name).with_extension("rs"));
    }
    let mut text = Vec::new();
    builder.generate().map_err(|e| e.to_string())?.write(&mut text);
    String::from_utf8(text).map_err(|e| e.to_string())
}

//! Writes `boards/c/include/glidepath.h`.
use glidepath_c_header::{file, header};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    std::fs::write(file(), header()?)?;
    println!("{}", file().display());
    Ok(())
}

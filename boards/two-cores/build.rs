//! Copies the memory map to the folder in which the linker script of cortex-m-rt searches for it.
use std::{env, fs, path::Path};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let map = Path::new(&env::var("CARGO_MANIFEST_DIR")?).join("../../hil-tests/maps/mps2-an505.x");
    let out = env::var("OUT_DIR")?;
    fs::copy(&map, Path::new(&out).join("memory.x"))?;
    println!("cargo:rustc-link-search={out}");
    println!("cargo:rerun-if-changed={}", map.display());
    Ok(())
}

//! Memory map of the chip, where the linker script of cortex-m-rt looks for it.
use std::{env, fs, path::Path};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let is_emulated = env::var_os("CARGO_FEATURE_AN521").is_some();
    let map = if is_emulated { "maps/mps2-an521.x" } else { "maps/rp2350.x" };
    let out = env::var("OUT_DIR")?;
    fs::copy(Path::new(&env::var("CARGO_MANIFEST_DIR")?).join(map), Path::new(&out).join("memory.x"))?;
    println!("cargo:rustc-link-search={out}");
    println!("cargo:rerun-if-changed=maps");
    Ok(())
}

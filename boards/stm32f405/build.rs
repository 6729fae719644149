//! Writes the memory map, passes linker scripts to the linker, and selects the program in flash.
use std::{env, fs, path::Path};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let root = Path::new(&env::var("CARGO_MANIFEST_DIR")?).join("../..");
    let program = root.join(env::var("PROGRAM").unwrap_or_else(|_| "programs/lines.nc".into()));
    let out = env::var("OUT_DIR")?;
    for (from, to) in [(root.join("memory.x"), "memory.x"), (program, "program.nc")] {
        fs::copy(&from, Path::new(&out).join(to)).map_err(|e| format!("{}: {e}", from.display()))?;
        println!("cargo:rerun-if-changed={}", from.display());
    }
    if env::var_os("CARGO_FEATURE_CONTROLLER").is_some() {
        // Vectors in sector 0, the store in sectors 2 and 3, the firmware from sector 4 on.
        let map = Path::new(&out).join("memory.x");
        let text = fs::read_to_string(&map)?;
        fs::write(&map, text + "\n_stext = ORIGIN(FLASH) + 64K;\n")?;
    }
    println!("cargo:rerun-if-env-changed=PROGRAM");
    println!("cargo:rustc-link-search={out}");
    if env::var_os("CARGO_FEATURE_RTT").is_some() || env::var_os("CARGO_FEATURE_QEMU").is_some() {
        println!("cargo:rustc-link-arg=-Tdefmt.x");
    }
    Ok(())
}

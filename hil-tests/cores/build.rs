//! Puts the memory map where the linker script looks for it, and says whether the core can run `glidepath-copy`, and has
//! use for `glidepath-softfloat`.
use std::{env, fs, path::Path};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let root = Path::new(&env::var("CARGO_MANIFEST_DIR")?).join("../..");
    let map = env::var("HIL_MEMORY_X").unwrap_or_else(|_| "memory.x".into());
    let out = env::var("OUT_DIR")?;
    fs::copy(root.join(&map), Path::new(&out).join("memory.x"))?;
    println!("cargo:rustc-link-search={out}");
    let target = env::var("TARGET")?;
    if target.starts_with("thumbv") {
        println!("cargo:rustc-cfg=copies");
    }
    if !target.ends_with("eabihf") {
        println!("cargo:rustc-cfg=soft");
    }
    println!("cargo:rerun-if-changed={}", root.join(&map).display());
    println!("cargo:rerun-if-env-changed=HIL_MEMORY_X");
    println!("cargo:rerun-if-env-changed=HIL_FLOATS");
    Ok(())
}

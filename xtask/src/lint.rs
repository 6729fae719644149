//! Formatting, clippy and documentation; every warning is an error.
use crate::shell::{cargo, root, run, step};
use crate::toolchain::{Toolchain, clippy_driver};

const FIRMWARE: [&str; 2] = ["hil-tests", "boards/stm32f405"];

/// Targets that can only load and store words.
const SMALL: [&str; 2] = ["thumbv6m-none-eabi", "riscv32imc-unknown-none-elf"];

/// All of it.
pub fn all() -> Result<(), String> {
    step("format");
    run(cargo(&root()).args(["fmt", "--all", "--check"]))?;
    for folder in FIRMWARE {
        run(cargo(&root().join(folder)).args(["fmt", "--all", "--check"]))?;
    }
    step("clippy, host");
    run(cargo(&root()).args([
        "clippy",
        "--workspace",
        "--all-targets",
        "--release",
        "--",
        "-D",
        "warnings",
    ]))?;
    let toolchain = Toolchain::find()?;
    step("clippy, firmware");
    for folder in FIRMWARE {
        firmware(&toolchain, folder)?;
    }
    step("cores without compare-and-swap");
    for target in SMALL {
        if !toolchain.check(target)? {
            eprintln!("   off: no library for {target} (`rustup target add {target}`)");
        }
    }
    step("documentation");
    run(cargo(&root()).args(["doc", "--workspace", "--no-deps", "--lib"]).env("RUSTDOCFLAGS", "-D warnings"))
}

fn firmware(toolchain: &Toolchain, folder: &str) -> Result<(), String> {
    let folder = root().join(folder);
    match toolchain {
        Toolchain::Prebuilt { .. } => {
            run(toolchain.cargo(&folder, "clippy").args(["--workspace", "--", "-D", "warnings"]))
        }
        Toolchain::FromSource { rustc, .. } => {
            let Some(driver) = clippy_driver(rustc) else {
                eprintln!("   off: no clippy for {} (Debian: rust-web-clippy)", rustc.display());
                return Ok(());
            };
            // What `cargo clippy` does, with the clippy of this compiler instead of the host toolchain's.
            let mut command = toolchain.cargo(&folder, "check");
            command.arg("--workspace").env("RUSTC_WORKSPACE_WRAPPER", driver);
            run(command.env("CLIPPY_ARGS", "-D__CLIPPY_HACKERY__warnings__CLIPPY_HACKERY__"))
        }
    }
}

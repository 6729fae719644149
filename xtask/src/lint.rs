//! Formatting, clippy and documentation; every warning is an error.
use crate::WITHOUT;
use crate::shell::{cargo, root, run, step};
use crate::toolchain::{TARGET, Toolchain, clippy_driver};
use std::path::PathBuf;
use std::process::{Command, Stdio};

const FIRMWARE: [&str; 6] =
    ["hil-tests", "boards/stm32f405", "boards/c", "boards/embassy", "boards/rtic", "boards/two-cores"];

/// Other cores. The cores of the first and the last kind can only load and store words.
const CORES: [&str; 5] = [
    "thumbv6m-none-eabi",
    "thumbv7m-none-eabi",
    "thumbv8m.main-none-eabi",
    "riscv32imac-unknown-none-elf",
    "riscv32imc-unknown-none-elf",
];

/// Functions that a build may leave out: each function is checked alone.
const FUNCTIONS: [&str; 15] = [
    "contour",
    "surface",
    "splines",
    "hsc",
    "expressions",
    "filters",
    "beside",
    "grbl",
    "hsc,grbl",
    "dialects",
    "fanuc",
    "kinematics",
    "plc",
    "driven",
    "examine",
];

/// Optional tools for the package, and their arguments: comparison with the last version in the history, and
/// licences of dependencies.
const TOOLS: [(&str, &[&str]); 2] = [
    ("cargo-semver-checks", &["semver-checks", "--package", "glidepath", "--baseline-rev", "HEAD~1"]),
    ("cargo-deny", &["deny", "check", "licenses", "bans"]),
];

/// Runs all checks.
pub fn all() -> Result<(), String> {
    step("format");
    run(cargo(&root()).args(["fmt", "--all", "--check"]))?;
    for folder in FIRMWARE.into_iter().chain([WITHOUT]) {
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
    step("features of the library");
    let library = |features: &[&str]| {
        let mut command = cargo(&root());
        command.args(["clippy", "--package", "glidepath", "--lib", "--release"]).args(features);
        run(command.args(["--", "-D", "warnings"]))
    };
    library(&["--features", "defmt"])?;
    library(&["--no-default-features"])?;
    for function in FUNCTIONS {
        library(&["--no-default-features", "--features", function])?;
    }
    run(cargo(&root().join(WITHOUT))
        .args(["clippy", "--all-targets", "--release", "--", "-D", "warnings"])
        .env("CARGO_TARGET_DIR", root().join("target")))?;
    step("oldest compiler");
    oldest()?;
    step("other cores");
    for target in CORES {
        if toolchain.has(target) {
            toolchain.check(target)?;
        } else {
            eprintln!("   off: no library for {target} (`rustup target add {target}`)");
        }
    }
    step("documentation");
    run(cargo(&root()).args(["doc", "--workspace", "--no-deps", "--lib"]).env("RUSTDOCFLAGS", "-D warnings"))
}

/// Builds the package without the rest of the repository, then runs the optional tools.
pub fn package() -> Result<(), String> {
    step("the package");
    run(cargo(&root()).args(["package", "--package", "glidepath", "--allow-dirty", "--locked"]))?;
    for (tool, arguments) in TOOLS {
        step(tool);
        if crate::shell::on_path(tool).is_none() {
            eprintln!("   off: {tool} is not installed");
            continue;
        }
        run(cargo(&root()).args(arguments))?;
    }
    Ok(())
}

/// The compiler of `rust-version`, if it is installed, refuses newer functions. Without it, clippy's
/// `incompatible_msrv` finds newer functions of the standard library, but not newer syntax.
fn oldest() -> Result<(), String> {
    let version = env!("CARGO_PKG_RUST_VERSION");
    let Some(cargo) = toolchain_of(version) else {
        eprintln!(
            "   off: Rust {version} is not installed (`rustup toolchain install {version}`); clippy's incompatible_msrv is on"
        );
        return Ok(());
    };
    let mut command = Command::new(&cargo);
    command.current_dir(root()).stdin(Stdio::null());
    command.args(["check", "--package", "glidepath", "--lib", "--features", "defmt"]);
    command.env("RUSTC", cargo.with_file_name("rustc")).env("CARGO_TARGET_DIR", root().join("target/oldest"));
    run(&mut command)
}

/// Cargo of a version that rustup has installed.
fn toolchain_of(version: &str) -> Option<PathBuf> {
    let home = std::env::var_os("RUSTUP_HOME").map(PathBuf::from);
    let home = home.or_else(|| Some(PathBuf::from(std::env::var_os("HOME")?).join(".rustup")))?;
    let is_it = |name: &str| {
        let number = name.split('-').next().unwrap_or(name);
        number == version || number.strip_prefix(version).is_some_and(|rest| rest.starts_with('.'))
    };
    let toolchains = std::fs::read_dir(home.join("toolchains")).ok()?.flatten();
    let found = toolchains.filter(|entry| entry.file_name().to_str().is_some_and(is_it));
    found.map(|entry| entry.path().join("bin/cargo")).find(|cargo| cargo.is_file())
}

fn firmware(toolchain: &Toolchain, folder: &str) -> Result<(), String> {
    let folder = root().join(folder);
    match toolchain {
        Toolchain::Prebuilt { .. } => {
            run(toolchain.cargo(&folder, "clippy", TARGET).args(["--workspace", "--", "-D", "warnings"]))
        }
        Toolchain::FromSource { rustc, .. } => {
            let Some(driver) = clippy_driver(rustc) else {
                eprintln!("   off: no clippy for {} (Debian: rust-web-clippy)", rustc.display());
                return Ok(());
            };
            // The same as `cargo clippy`, with the clippy of this compiler instead of the host's.
            let mut command = toolchain.cargo(&folder, "check", TARGET);
            command.arg("--workspace").env("RUSTC_WORKSPACE_WRAPPER", driver);
            run(command.env("CLIPPY_ARGS", "-D__CLIPPY_HACKERY__warnings__CLIPPY_HACKERY__"))
        }
    }
}

//! Finds the compiler for firmware, or says what to install.
//!
//! 1. The host toolchain has the target's library: plain `--target`.
//! 2. A compiler has the library's source (from a distribution, or the component rust-src): the library is
//!    built too, with `-Zbuild-std=core`.
//! 3. Debian and root: the distribution's compiler and source are installed, then 2.
//! 4. Otherwise the user gets both instructions. This program never calls rustup.
use crate::shell;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// Target triple of the reference target.
pub const TARGET: &str = "thumbv7em-none-eabihf";

const COMPILER_PACKAGES: &[&str] = &["rustc-web", "rust-web-src"];
const EMULATOR: &str = "qemu-system-arm";
/// Packages of emulators, by name.
const EMULATORS: [(&str, &str); 2] = [(EMULATOR, EMULATOR), ("qemu-system-riscv32", "qemu-system-misc")];
const C_COMPILER: &str = "arm-none-eabi-gcc";
/// FreeRTOS includes headers of a C library.
const C_COMPILER_PACKAGES: &[&str] = &["gcc-arm-none-eabi", "libnewlib-arm-none-eabi"];
const CLIPPY_PACKAGE: &str = "rust-web-clippy";

/// The way in which this computer compiles firmware.
pub enum Toolchain {
    /// The library for the target comes with the compiler.
    Prebuilt {
        /// `rustc --version`.
        version: String,
    },
    /// The library is built from source.
    FromSource {
        /// `rustc --version`.
        version: String,
        /// The compiler.
        rustc: PathBuf,
        /// A linker for ARM.
        linker: PathBuf,
    },
}

impl Toolchain {
    /// Finds the first working way, and installs packages if needed.
    pub fn find() -> Result<Self, String> {
        if let Some(found) = Self::look() {
            return Ok(found);
        }
        install(COMPILER_PACKAGES).map_err(|why| {
            format!(
                "no compiler for {TARGET} ({why}). With rustup: `rustup target add {TARGET}`. On Debian, as root: \
                 `apt-get install {} {EMULATOR}`.",
                COMPILER_PACKAGES.join(" ")
            )
        })?;
        Self::look()
            .ok_or_else(|| format!("installed {COMPILER_PACKAGES:?}, but no linker for ARM was found"))
    }

    fn look() -> Option<Self> {
        let host = PathBuf::from(std::env::var_os("RUSTC").unwrap_or_else(|| "rustc".into()));
        let sysroot = query(&host, &["--print", "sysroot"])?;
        if Path::new(&sysroot).join("lib/rustlib").join(TARGET).join("lib").is_dir() {
            return Some(Self::Prebuilt { version: query(&host, &["--version"])? });
        }
        let linker = linker(Path::new(&sysroot))?;
        [PathBuf::from("/usr/bin/rustc"), host].into_iter().find_map(|rustc| {
            let sysroot = query(&rustc, &["--print", "sysroot"])?;
            let source = Path::new(&sysroot).join("lib/rustlib/src/rust/library/Cargo.lock");
            let version = query(&rustc, &["--version"])?;
            source.is_file().then(|| Self::FromSource { version, rustc, linker: linker.clone() })
        })
    }

    /// `rustc --version` of the firmware's compiler.
    pub fn version(&self) -> &str {
        match self {
            Self::Prebuilt { version } | Self::FromSource { version, .. } => version,
        }
    }

    /// Whether the library for this target, or its source, exists.
    pub fn has(&self, target: &str) -> bool {
        match self {
            Self::FromSource { .. } => true,
            Self::Prebuilt { .. } => {
                let rustc = PathBuf::from(std::env::var_os("RUSTC").unwrap_or_else(|| "rustc".into()));
                let sysroot = query(&rustc, &["--print", "sysroot"]).unwrap_or_default();
                Path::new(&sysroot).join("lib/rustlib").join(target).join("lib").is_dir()
            }
        }
    }

    /// Checks whether the library, and the crates for boards, compile for another target.
    pub fn check(&self, target: &str) -> Result<(), String> {
        let mut command = shell::cargo(&shell::root());
        command.args(["check", "--lib", "--release", "--target", target]);
        for package in ["glidepath", "glidepath-steps", "glidepath-controller"] {
            command.args(["--package", package]);
        }
        command.env("CARGO_TARGET_DIR", folder_of_artifacts());
        if let Self::FromSource { rustc, .. } = self {
            command.arg("-Zbuild-std=core").env("RUSTC", rustc).env("RUSTC_BOOTSTRAP", "1");
        }
        shell::run(&mut command)
    }

    /// `cargo SUBCOMMAND` in `folder` for a target, in release.
    pub fn cargo(&self, folder: &Path, subcommand: &str, target: &str) -> Command {
        let mut command = shell::cargo(folder);
        command.args([subcommand, "--release", "--target", target]);
        // Incremental builds divide the code differently, so instructions and stack would depend on the
        // user's settings.
        command.env("CARGO_TARGET_DIR", folder_of_artifacts()).env("CARGO_INCREMENTAL", "0");
        if let Self::FromSource { rustc, linker, .. } = self {
            command.arg("-Zbuild-std=core").env("RUSTC", rustc).env("RUSTC_BOOTSTRAP", "1");
            let target = target.to_uppercase().replace(['-', '.'], "_");
            command.env(format!("CARGO_TARGET_{target}_LINKER"), linker);
        }
        command
    }
}

/// `target/fw`, separate from the host's build, because the compiler differs.
pub fn folder_of_artifacts() -> PathBuf {
    shell::root().join("target/fw")
}

/// The emulator of the reference target; installs it if needed.
pub fn emulator() -> Result<PathBuf, String> {
    emulator_of(EMULATOR)
}

/// The emulator with this name; installs it if needed.
pub fn emulator_of(name: &str) -> Result<PathBuf, String> {
    if let Some(found) = shell::on_path(name) {
        return Ok(found);
    }
    let package =
        EMULATORS.iter().find(|(emulator, _)| *emulator == name).map_or(name, |(_, package)| package);
    install(&[package]).map_err(|why| {
        format!(
            "no {name} ({why}). On Debian, as root: `apt-get install {package}`; elsewhere the package qemu."
        )
    })?;
    shell::on_path(name).ok_or_else(|| format!("{name} is installed but not on PATH"))
}

/// The C compiler for the target; installs it if needed.
pub fn c_compiler() -> Result<PathBuf, String> {
    if let Some(found) = shell::on_path(C_COMPILER) {
        return Ok(found);
    }
    install(C_COMPILER_PACKAGES).map_err(|why| {
        let packages = C_COMPILER_PACKAGES.join(" ");
        format!("no {C_COMPILER} ({why}). On Debian, as root: `apt-get install {packages}`.")
    })?;
    shell::on_path(C_COMPILER).ok_or_else(|| format!("{C_COMPILER} is installed but not on PATH"))
}

/// The clippy for a compiler from a distribution's source; installs it if needed.
pub fn clippy_driver(rustc: &Path) -> Option<PathBuf> {
    let driver = rustc.with_file_name("clippy-driver");
    if !driver.is_file() && rustc.starts_with("/usr/bin") {
        install(&[CLIPPY_PACKAGE]).ok()?;
    }
    driver.is_file().then_some(driver)
}

fn linker(sysroot: &Path) -> Option<PathBuf> {
    let hosts = std::fs::read_dir(sysroot.join("lib/rustlib")).ok()?;
    let bundled = hosts.flatten().map(|host| host.path().join("bin/rust-lld")).find(|lld| lld.is_file());
    bundled.or_else(|| ["rust-lld", "ld.lld", "arm-none-eabi-ld"].into_iter().find_map(shell::on_path))
}

fn query(program: &Path, arguments: &[&str]) -> Option<String> {
    let output = Command::new(program).args(arguments).stdin(Stdio::null()).output().ok()?;
    output.status.success().then(|| String::from_utf8_lossy(&output.stdout).trim().to_owned())
}

fn install(packages: &[&str]) -> Result<(), String> {
    if !Path::new("/etc/debian_version").exists() || shell::on_path("apt-get").is_none() {
        return Err("not a Debian system".into());
    }
    if query(Path::new("id"), &["-u"]).as_deref() != Some("0") {
        return Err("not root, so nothing was installed".into());
    }
    shell::step(&format!("installing {}", packages.join(" ")));
    let apt = |arguments: &[&str]| {
        let mut command = Command::new("apt-get");
        command.args(arguments).stdin(Stdio::null()).env("DEBIAN_FRONTEND", "noninteractive");
        shell::run(&mut command)
    };
    apt(&["-q", "update"])?;
    apt(&[&["-q", "install", "-y", "--no-install-recommends"], packages].concat())
}

//! Builds firmware and runs it in the emulator or on a board.
use crate::shell::{self, Output};
use crate::toolchain::{self, TARGET, Toolchain};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

/// Time limit of a run: far more than any test needs, also on a busy computer. A firmware that hangs does not
/// end by itself.
const LIMIT: Duration = Duration::from_secs(1800);

/// Time limit of a program with serial input, which waits for ever after a lost byte.
const TALK_LIMIT: Duration = Duration::from_secs(240);

/// The emulated reference machine.
const REFERENCE: &str = "netduinoplus2";

/// Chip of the reference board.
const CHIP: &str = "STM32F405RGTx";

/// A core in an emulated machine.
pub struct Core {
    /// Description.
    pub name: &'static str,
    target: &'static str,
    machine: &'static str,
    /// Memory map, relative to the root.
    map: &'static str,
}

/// Cores other than the reference target.
pub const CORES: [Core; 2] = [
    Core {
        name: "Cortex-M3",
        target: "thumbv7m-none-eabi",
        machine: "mps2-an385",
        map: "hil-tests/maps/mps2-an385.x",
    },
    Core {
        name: "Cortex-M33",
        target: "thumbv8m.main-none-eabi",
        machine: "mps2-an505",
        map: "hil-tests/maps/mps2-an505.x",
    },
];

/// The place where firmware runs.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// QEMU's netduinoplus2.
    Emulator,
    /// A board with a debug probe.
    Probe,
}

/// A compiler, and a place to run.
pub struct Firmware {
    toolchain: Toolchain,
    place: Place,
    runner: PathBuf,
}

impl Firmware {
    /// Finds compiler and runner, and installs missing tools if possible.
    pub fn prepare(place: Place) -> Result<Self, String> {
        let toolchain = Toolchain::find()?;
        let runner = match place {
            Place::Emulator => toolchain::emulator()?,
            Place::Probe => {
                shell::on_path("probe-rs").ok_or("no probe-rs on PATH: see hil-tests/README.md")?
            }
        };
        let how = match &toolchain {
            Toolchain::Prebuilt { .. } => "library for the target installed",
            Toolchain::FromSource { .. } => "library built from source",
        };
        eprintln!("   firmware by {}, {how}", toolchain.version());
        Ok(Self { toolchain, place, runner })
    }

    /// The way in which this computer compiles.
    pub fn toolchain(&self) -> &Toolchain {
        &self.toolchain
    }

    /// The compiler's version.
    pub fn compiler(&self) -> &str {
        self.toolchain.version()
    }

    /// Builds the package in `folder` (relative to the root) with `features`.
    pub fn build(&self, folder: &str, arguments: &[&str], variables: &[(&str, &str)]) -> Result<(), String> {
        let mut command = self.toolchain.cargo(&shell::root().join(folder), "build", TARGET);
        command.args(arguments).envs(variables.iter().copied());
        shell::run(&mut command)
    }

    /// Builds binaries of the package in `folder` with these functions of the library only, for size, in a
    /// separate folder: [`small`].
    pub fn build_small(&self, folder: &str, functions: &str, names: &[&str]) -> Result<(), String> {
        let mut command = self.toolchain.cargo(&shell::root().join(folder), "build", TARGET);
        command.args(["--no-default-features", "--features", functions]);
        command.args(names.iter().flat_map(|name| ["--bin", name]));
        // The compiler's own inlining limit, not that of the large build.
        command.env("RUSTFLAGS", "-C link-arg=-Tlink.x").env("CARGO_PROFILE_RELEASE_OPT_LEVEL", "z");
        shell::run(command.env("CARGO_TARGET_DIR", toolchain::folder_of_artifacts().join(SMALL)))
    }

    /// Returns the compiler's messages if a build must fail; an error if the build succeeds.
    pub fn build_fails(&self, folder: &str, arguments: &[&str]) -> Result<String, String> {
        let mut command = self.toolchain.cargo(&shell::root().join(folder), "build", TARGET);
        let output = shell::capture(command.args(arguments), LIMIT)?;
        if output.success {
            Err(format!("{folder} {arguments:?} builds and must not"))
        } else {
            Ok(output.err)
        }
    }

    /// Builds a binary of the package in `folder` for another core, and runs it. Returns its output, or
    /// `None` if there is no library for this core.
    pub fn elsewhere(&self, core: &Core, folder: &str, name: &str) -> Result<Option<String>, String> {
        self.elsewhere_with(core, folder, &[], name)
    }

    /// The same, with `features` of the package.
    pub fn elsewhere_with(
        &self,
        core: &Core,
        folder: &str,
        features: &[&str],
        name: &str,
    ) -> Result<Option<String>, String> {
        if !self.toolchain.has(core.target) {
            eprintln!("   {}: off, no library for {} (`rustup target add`)", core.name, core.target);
            return Ok(None);
        }
        let mut command = self.toolchain.cargo(&shell::root().join(folder), "build", core.target);
        command.args(features).args(["--bin", name]).env("HIL_MEMORY_X", core.map);
        shell::run(&mut command)?;
        let file = toolchain::folder_of_artifacts().join(core.target).join("release").join(name);
        let mut command = emulator(&self.runner, core.machine);
        let output = shell::capture(command.arg("-kernel").arg(&file), LIMIT)?;
        let text = String::from_utf8_lossy(&output.out).into_owned();
        if output.success {
            Ok(Some(text))
        } else {
            Err(format!("{name} on {}: {text}{}", core.name, output.err))
        }
    }

    /// Runs a binary to its end and returns its output.
    pub fn run(&self, name: &str) -> Result<Output, String> {
        self.run_file(name, &artifact(name))
    }

    fn run_file(&self, name: &str, file: &Path) -> Result<Output, String> {
        let mut command = match self.place {
            Place::Emulator => {
                let mut command = emulator(&self.runner, REFERENCE);
                command.args(["-icount", "shift=0,sleep=off", "-kernel"]);
                command
            }
            Place::Probe => {
                let mut command = Command::new(&self.runner);
                command.args(["run", "--chip", CHIP]);
                command
            }
        };
        command.arg(file);
        let output = shell::capture(&mut command, LIMIT)?;
        if output.timed_out {
            return Err(format!("{name} did not end within {} s", LIMIT.as_secs()));
        }
        Ok(output)
    }

    /// Output of a binary with serial input: `sender` returns the next bytes after each new output.
    pub fn talk(&self, name: &str, sender: impl FnMut(&[u8]) -> Option<Vec<u8>>) -> Result<String, String> {
        self.talk_on(REFERENCE, &artifact(name), sender)
    }

    /// The same on another machine.
    pub fn talk_on(
        &self,
        machine: &str,
        file: &Path,
        sender: impl FnMut(&[u8]) -> Option<Vec<u8>>,
    ) -> Result<String, String> {
        let output = shell::talk(&mut self.with_line(machine, file, "stdio"), TALK_LIMIT, sender)?;
        let text = String::from_utf8_lossy(&output.out).into_owned();
        if output.success {
            return Ok(text);
        }
        Err(format!("{} failed on the target:\n{text}\n{}", file.display(), output.err))
    }

    /// The same, with the other output, also after a failure.
    pub fn speak(&self, name: &str, sender: impl FnMut(&[u8]) -> Option<Vec<u8>>) -> Result<Output, String> {
        shell::talk(&mut self.with_line(REFERENCE, &artifact(name), "stdio"), TALK_LIMIT, sender)
    }

    /// Command for a binary in the emulator with its first serial line at a pseudo terminal. The first output
    /// names the terminal.
    pub fn at_terminal(&self, name: &str) -> Command {
        self.with_line(REFERENCE, &artifact(name), "pty")
    }

    fn with_line(&self, machine: &str, file: &Path, line: &str) -> Command {
        let mut command = Command::new(&self.runner);
        command.args(["-M", machine, "-nographic", "-monitor", "none", "-serial", line]);
        command.args(["-semihosting-config", "enable=on,target=native", "-icount", "shift=0,sleep=off"]);
        command.arg("-kernel").arg(file);
        command
    }

    /// The output of a binary; an error if it failed.
    pub fn report(&self, name: &str) -> Result<String, String> {
        self.report_file(name, &artifact(name))
    }

    /// The same for a binary of [`Self::build_small`].
    pub fn report_small(&self, name: &str) -> Result<String, String> {
        self.report_file(name, &small(name))
    }

    fn report_file(&self, name: &str, file: &Path) -> Result<String, String> {
        let output = self.run_file(name, file)?;
        let text = String::from_utf8_lossy(&output.out).into_owned();
        if output.success {
            return Ok(text);
        }
        let tail: Vec<&str> = text.lines().rev().filter(|line| !line.starts_with("s ")).take(12).collect();
        let tail = tail.into_iter().rev().collect::<Vec<_>>().join("\n");
        Err(format!("{name} failed on the target:\n{tail}\n{}", output.err))
    }
}

/// QEMU with a machine that only uses semihosting.
fn emulator(runner: &Path, machine: &str) -> Command {
    let mut command = Command::new(runner);
    command.args(["-M", machine, "-nographic", "-monitor", "none", "-serial", "none"]);
    command.args(["-semihosting-config", "enable=on,target=native"]);
    command
}

/// Folder of small builds below that of firmware artifacts.
const SMALL: &str = "small";

/// A binary of [`Firmware::build_small`].
pub fn small(name: &str) -> PathBuf {
    toolchain::folder_of_artifacts().join(SMALL).join(TARGET).join("release").join(name)
}

/// A binary in the folder of firmware artifacts.
pub fn artifact(name: &str) -> PathBuf {
    artifact_of(TARGET, name)
}

/// A binary for another core.
pub fn artifact_of(target: &str, name: &str) -> PathBuf {
    toolchain::folder_of_artifacts().join(target).join("release").join(name)
}

//! Runs real senders with `glidepath serve`, and with the controller's firmware in the emulator.
use crate::controller;
use crate::firmware::{Firmware, Place};
use crate::shell::{capture, cargo, root, run, step};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

/// The senders in Python that need a few seconds, with their package names.
const PYTHON: [&str; 2] = ["pygrbl-streamer==1.0.5", "grbl-streamer==2.0.2"];

/// The one in Python that needs a minute.
const BCNC: [&str; 1] = ["bCNC==0.9.16"];

/// Two more in Python.
const MORE: [&str; 2] = ["plotdeck==1.0.0", "gantrix==0.1.1"];

/// The sender for Node, and the package that drives it.
const NODE: [&str; 3] = ["cncjs@1.11.5", "socket.io-client@2", "jsonwebtoken@9"];

/// The conversations.
const SCRIPTS: &str = "boards/controller/senders";

/// Longest time for an installation.
const INSTALLING: Duration = Duration::from_secs(600);

/// Jobs of bCNC and cncjs.
const JOBS: &str = "10";

/// Lines of a job in the short form.
const SHORT: &str = "300";

/// All six to `serve`, four of them to the firmware; what cannot be installed is an error. The jobs have up to so many lines.
pub fn all(lines: &str) -> Result<(), String> {
    step("senders");
    let python = python(&[PYTHON.as_slice(), &MORE, &BCNC].concat())?;
    let modules = node()?;
    let program = serve()?;
    quick(&python, lines, &desktop(&program))?;
    let mut more = Command::new(&python);
    more.arg(root().join(SCRIPTS).join("more.py")).arg(lines);
    run(with(&mut more, &desktop(&program)))?;
    let mut tcp = Command::new(&program);
    tcp.args(["serve", "--tcp", "0", "--speed", "20"]);
    slow(&python, &modules, lines, [&tcp, &desktop(&program)])?;
    step("firmware");
    let firmware = Firmware::prepare(Place::Emulator)?;
    controller::build(&firmware)?;
    step("senders, firmware in the emulator");
    let terminal = firmware.at_terminal(controller::BINARY);
    quick(&python, lines, &terminal)?;
    slow(&python, &modules, lines, [&terminal, &terminal])
}

/// bCNC and cncjs, each to the controller that its command runs.
fn slow(python: &Path, modules: &Path, lines: &str, [bcnc, cncjs]: [&Command; 2]) -> Result<(), String> {
    let script = |name: &str| root().join(SCRIPTS).join(name);
    let mut command = Command::new(python);
    run(with(command.arg(script("bcnc.py")).args([lines, JOBS]), bcnc))?;
    let mut command = Command::new("node");
    run(with(command.arg(script("cncjs.mjs")).arg(modules).args([lines, JOBS]), cncjs))
}

/// The command with another one as its last arguments.
fn with<'c>(command: &'c mut Command, other: &Command) -> &'c mut Command {
    command.arg(other.get_program()).args(other.get_args())
}

/// The two quick senders with `serve`, for every run of the tests: about 10 s, and 10 s more with
/// installation.
pub fn short() -> Result<(), String> {
    step("senders (short)");
    installed(|python| quick(python, SHORT, &desktop(&serve()?)))
}

/// The two quick senders with the firmware, which is already built.
pub fn with_firmware(firmware: &Firmware) -> Result<(), String> {
    step("senders (short), firmware in the emulator");
    installed(|python| quick(python, SHORT, &firmware.at_terminal(controller::BINARY)))
}

/// If the senders cannot be installed (no network, no Python), a message says so, without an error.
fn installed(what: impl FnOnce(&Path) -> Result<(), String>) -> Result<(), String> {
    match python(&PYTHON) {
        Ok(python) => what(&python),
        Err(reason) => {
            eprintln!("   SKIPPED: the senders cannot be installed: {reason}");
            Ok(())
        }
    }
}

/// The two quick senders with a controller that this command starts.
fn quick(python: &Path, lines: &str, controller: &Command) -> Result<(), String> {
    let mut command = Command::new(python);
    command.arg(root().join(SCRIPTS).join("python.py")).arg(lines);
    run(with(&mut command, controller))
}

/// The controller on the PC, twenty times as fast as real time.
fn desktop(program: &Path) -> Command {
    let mut command = Command::new(program);
    command.args(["serve", "--pty", "--speed", "20"]);
    command
}

fn folder() -> PathBuf {
    root().join("target/senders")
}

/// A Python that has these packages.
fn python(packages: &[&str]) -> Result<PathBuf, String> {
    let python = folder().join("bin/python");
    if !python.exists() {
        quiet(Command::new("python3").args(["-m", "venv"]).arg(folder()))?;
    }
    // Installed packages need no network.
    let pip =
        ["-m", "pip", "install", "-q", "--disable-pip-version-check", "--retries", "1", "--timeout", "10"];
    quiet(Command::new(&python).args(pip).args(packages))?;
    Ok(python)
}

/// The folder whose modules are those of [`NODE`].
fn node() -> Result<PathBuf, String> {
    let modules = folder().join("node");
    if !Path::new(&modules).join("node_modules/cncjs/package.json").exists() {
        std::fs::create_dir_all(&modules).map_err(|e| format!("{}: {e}", modules.display()))?;
        quiet(
            Command::new("npm").args(["install", "--no-audit", "--no-fund"]).args(NODE).current_dir(&modules),
        )?;
    }
    Ok(modules)
}

/// The controller on the desktop.
fn serve() -> Result<PathBuf, String> {
    let root = root();
    run(cargo(&root).args(["build", "--release", "-p", "glidepath-host"]))?;
    Ok(root.join("target/release/glidepath"))
}

/// Runs to the end; an error has the last line of the output.
fn quiet(command: &mut Command) -> Result<(), String> {
    let output = capture(command, INSTALLING)?;
    let last = output.err.trim().lines().last().unwrap_or_default().to_owned();
    if output.success { Ok(()) } else { Err(last) }
}

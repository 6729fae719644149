//! Real senders against `glidepath serve`.
use crate::shell::{cargo, root, run, step};
use std::process::Command;

/// The senders, as their registry has them.
const PACKAGES: [&str; 2] = ["pygrbl-streamer==1.0.5", "grbl-streamer==2.0.2"];

/// The conversation.
const SCRIPT: &str = "boards/controller/senders/python.py";

/// Installs them beside the build's files, and lets each send a job of so many lines.
pub fn all(lines: &str) -> Result<(), String> {
    let root = root();
    step("senders");
    let folder = root.join("target/senders");
    let python = folder.join("bin/python");
    if !python.exists() {
        run(Command::new("python3").args(["-m", "venv"]).arg(&folder))?;
    }
    run(Command::new(&python).args(["-m", "pip", "install", "-q"]).args(PACKAGES))?;
    run(cargo(&root).args(["build", "--release", "-p", "glidepath-host"]))?;
    run(Command::new(&python).arg(root.join(SCRIPT)).arg(root.join("target/release/glidepath")).arg(lines))
}

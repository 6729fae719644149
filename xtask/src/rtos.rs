//! Glidepath inside RTIC, in the emulator: each program ends with the host's digest.
use crate::firmware::Firmware;
use crate::host::{self, HostRun};
use crate::shell::step;
use crate::target;

/// Folder and binary of each program.
const PROGRAMS: [(&str, &str); 1] =
    [("boards/rtic", "glidepath-rtic")];

/// Lines of functions that the program puts out.
const FUNCTIONS: usize = 3;

/// Only these: `cargo xtask rtos`.
pub fn all() -> Result<(), String> {
    step("firmware");
    run(&Firmware::prepare(crate::firmware::Place::Emulator)?)
}

/// Builds all of them and runs them.
pub fn run(firmware: &Firmware) -> Result<(), String> {
    step("in an operating system");
    let host = host::tasks()?;
    for (folder, binary) in PROGRAMS {
        firmware.build(folder, &[], &[])?;
        alike(&host, binary, &firmware.report(binary)?)?;
    }
    Ok(())
}

/// The set points are the host's, and the functions came.
fn alike(host: &HostRun, name: &str, report: &str) -> Result<(), String> {
    let last = report.lines().last().unwrap_or_default();
    let values = target::fields(last);
    let theirs = (target::number(&values, "ticks", report)?, target::digest(&values, report)?);
    let ours = (u64::from(host.outcome.ticks), host.outcome.digest.value());
    let functions = report.lines().filter(|line| line.starts_with('N')).count();
    if theirs != ours || functions != FUNCTIONS {
        return Err(format!(
            "{name}: host {} ticks, digest {:016x}, {FUNCTIONS} functions; target:\n{report}",
            ours.0, ours.1
        ));
    }
    eprintln!(
        "   {name:<16} {:>7} ticks  {:016x}  as on the host, {functions} functions",
        theirs.0, theirs.1
    );
    Ok(())
}

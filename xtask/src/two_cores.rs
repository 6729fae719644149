//! The board of two cores: planner on one, interrupt on the other, with the host's digest; and the build for its chip.
use crate::firmware::{Firmware, Place};
use crate::shell::{capture, root, run, step};
use crate::{host, target, toolchain};
use std::process::Command;
use std::time::Duration;

const BOARD: &str = "boards/two-cores";
const BINARY: &str = "glidepath-two-cores";
/// The program that it runs: `PROGRAM` of the board.
const PROGRAM: &str = "corners";
const EMULATED: &str = "thumbv8m.main-none-eabi";
const CHIP: &str = "thumbv8m.main-none-eabihf";
const LONGEST: Duration = Duration::from_secs(600);

/// Fewest ticks that come while the other core is inside a call of the planner: otherwise the run shows nothing.
const BESIDE: u64 = 10;

/// Only this: `cargo xtask two-cores`.
pub fn all() -> Result<(), String> {
    check(&Firmware::prepare(Place::Emulator)?)
}

/// Builds for the chip, which links only without a panicking path, and for the emulator, and runs that.
pub fn check(firmware: &Firmware) -> Result<(), String> {
    step("two cores");
    for (target, features) in [(CHIP, &[][..]), (EMULATED, &["--features", "an521"])] {
        if !firmware.toolchain().has(target) {
            eprintln!("   off: no library for {target} (`rustup target add`)");
            return Ok(());
        }
        run(firmware.toolchain().cargo(&root().join(BOARD), "build", target).args(features))?;
    }
    let host = host::one(PROGRAM)?.outcome;
    let mut command = Command::new(toolchain::emulator()?);
    command.args(["-M", "mps2-an521", "-nographic", "-monitor", "none", "-serial", "none"]);
    command.args([
        "-semihosting-config",
        "enable=on,target=native",
        "-icount",
        "shift=0,sleep=off",
        "-kernel",
    ]);
    command.arg(toolchain::folder_of_artifacts().join(EMULATED).join("release").join(BINARY));
    let output = capture(&mut command, LONGEST)?;
    let text = String::from_utf8_lossy(&output.out).into_owned();
    let values = target::fields(&text);
    let value = |key| target::number(&values, key, &text);
    let theirs = (value("ticks")?, target::digest(&values, &text)?);
    let ours = (u64::from(host.ticks), host.digest.value());
    if !output.success || theirs != ours || value("starved")? != 0 {
        return Err(format!(
            "two cores: host {} ticks, digest {:016x}; target: {text}{}",
            ours.0, ours.1, output.err
        ));
    }
    let beside = value("beside")?;
    if beside < BESIDE {
        return Err(format!("{beside} ticks came during a call of the planner: the run shows nothing"));
    }
    eprintln!(
        "   {PROGRAM}: {} ticks on one core, {beside} of them during a planner call on the other, {:016x} as on the host",
        theirs.0, theirs.1
    );
    Ok(())
}

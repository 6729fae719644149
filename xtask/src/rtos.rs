//! Glidepath inside RTIC, Embassy, FreeRTOS and C programs, in the emulator: each ends with the host's digest.
use crate::firmware::{Firmware, Place, artifact};
use crate::host::{self, HostRun};
use crate::shell::{root, step};
use crate::{shell, target, toolchain};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

/// Their workspace, and the binaries of those in Rust.
const TASKS: &str = "boards/tasks";
const PROGRAMS: [&str; 2] = ["glidepath-rtic", "glidepath-embassy"];

/// The static library for C, and the program made with it.
const C: &str = "boards/c";
const C_LIBRARY: &str = "libglidepath_c.a";
const C_PROGRAM: &str = "glidepath-c";
const C_SOURCES: [&str; 4] = ["start.c", "work.c", "print.c", "program.S"];

/// FreeRTOS: the example, the crate that holds the kernel, and what of it is compiled.
const FREERTOS: &str = "boards/freertos";
const FREERTOS_PROGRAM: &str = "glidepath-freertos";
const KERNEL_CRATE: &str = "/freertos-next-";
const KERNEL_PORT: &str = "portable/GCC/ARM_CM4F";
const KERNEL_SOURCES: [&str; 4] = ["tasks.c", "queue.c", "list.c", "portable/GCC/ARM_CM4F/port.c"];

/// Longest time to fetch the kernel.
const LONGEST: Duration = Duration::from_secs(600);

/// The core, how to compile, and warnings that are errors.
const C_FLAGS: [&str; 14] = [
    "-mcpu=cortex-m4",
    "-mthumb",
    "-mfpu=fpv4-sp-d16",
    "-mfloat-abi=hard",
    "-std=gnu11",
    "-O2",
    "-g",
    "-Wall",
    "-Wextra",
    "-Werror",
    "-ffreestanding",
    "-nostdlib",
    "-Wl,--gc-sections",
    "-Wl,-z,noexecstack",
];

/// Lines of functions that the program puts out.
const FUNCTIONS: usize = 3;

/// Only these: `cargo xtask rtos`.
pub fn all() -> Result<(), String> {
    step("firmware");
    run(&Firmware::prepare(Place::Emulator)?)
}

/// Builds all of them and runs them.
pub fn run(firmware: &Firmware) -> Result<(), String> {
    step("in an operating system");
    let host = host::tasks()?;
    firmware.build(TASKS, &[], &[])?;
    for binary in PROGRAMS {
        alike(&host, binary, &firmware.report(binary)?)?;
    }
    step("in C programs");
    c_programs(firmware, &host)
}

/// Writes the header for C: `cargo xtask header`.
pub fn header() -> Result<(), String> {
    shell::run(shell::cargo(&root()).args(["run", "--release", "--package", "glidepath-c-header"]))
}

/// The static library, linked to C programs: one without an operating system, and one with FreeRTOS.
fn c_programs(firmware: &Firmware, host: &HostRun) -> Result<(), String> {
    let compiler = match toolchain::c_compiler() {
        Ok(compiler) => compiler,
        Err(why) => {
            eprintln!("   off: {why}");
            return Ok(());
        }
    };
    let example = root().join(C).join("example");
    let common = C_SOURCES.map(|name| example.join(name));
    let bare = [&common[..], &[example.join("main.c")]].concat();
    let (kernel, freertos) = (kernel()?, root().join(FREERTOS));
    let mut with_kernel = [&common[..], &[freertos.join("main.c")]].concat();
    with_kernel.extend(KERNEL_SOURCES.map(|name| kernel.join(name)));
    let folders = [freertos, kernel.join("include"), kernel.join(KERNEL_PORT)];
    for (name, sources, folders) in [(C_PROGRAM, bare, &[][..]), (FREERTOS_PROGRAM, with_kernel, &folders)] {
        let mut gcc = Command::new(&compiler);
        gcc.args(C_FLAGS).arg("-I").arg(root().join(C).join("include")).arg("-I").arg(&example);
        gcc.args(folders.iter().flat_map(|folder| ["-I".into(), folder.clone()]));
        gcc.arg(format!("-Wa,-I,{}", root().join(TASKS).display()));
        gcc.arg("-L").arg(root()).arg("-T").arg(example.join("link.ld"));
        gcc.args(sources).arg(artifact(C_LIBRARY)).arg("-lgcc");
        shell::run(gcc.arg("-o").arg(artifact(name)))?;
        alike(host, name, &firmware.report(name)?)?;
    }
    Ok(())
}

/// The folder of the FreeRTOS kernel, which a crate of the registry holds.
fn kernel() -> Result<PathBuf, String> {
    let mut command = shell::cargo(&root().join(FREERTOS));
    command.args(["metadata", "--format-version", "1", "--locked"]);
    let output = shell::capture(&mut command, LONGEST)?;
    let text = String::from_utf8_lossy(&output.out);
    let is_it = |word: &&str| word.contains(KERNEL_CRATE) && word.ends_with("Cargo.toml");
    let manifest = text.split('"').find(is_it).ok_or(output.err)?;
    Ok(Path::new(manifest).with_file_name("FreeRTOS-Kernel"))
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

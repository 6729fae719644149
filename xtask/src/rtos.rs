//! Runs Glidepath with RTIC, Embassy, FreeRTOS and C programs, and on two cores, in the emulator: the digest
//! must equal the PC's.
use crate::firmware::{Firmware, Place, artifact, artifact_of};
use crate::host::{self, HostRun};
use crate::shell::{root, step};
use crate::{shell, target, toolchain};
use hil_cases::{END_OF_PART, SECOND_PART, TASKS as TASKS_NC};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

/// Their workspace.
const TASKS: &str = "boards/tasks";

/// The static library for C, and the files of all programs with this library.
const C: &str = "boards/c";
const C_PACKAGE: &str = "glidepath-c";
const C_LIBRARY: &str = "libglidepath_c.a";
const C_SOURCES: [&str; 4] = ["start.c", "work.c", "line.c", "print.c"];

/// FreeRTOS: the example, the crate with the kernel, and the compiled kernel files.
const FREERTOS: &str = "boards/freertos";
const KERNEL_CRATE: &str = "/freertos-next-";
const KERNEL_PORT: &str = "portable/GCC/ARM_CM4F";
const KERNEL_SOURCES: [&str; 4] = ["tasks.c", "queue.c", "list.c", "portable/GCC/ARM_CM4F/port.c"];

/// Time limit for the download of the kernel.
const LONGEST: Duration = Duration::from_secs(600);

/// Core, compiler options, and warnings that are errors.
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

/// Lines about functions in the program's output.
const FUNCTIONS: usize = 4;

/// The byte that a program sends when its line is ready.
const READY: char = '\u{11}';

/// Output of a program at which the sender sends the first part, and the second part.
const SIGNALS: [&[u8]; 2] = [b"\x11", b"N80"];

/// Target and machine of the program for two cores. The first core of the machine has no floating point.
const TWO_CORES_TARGET: &str = "thumbv8m.main-none-eabi";
const TWO_CORES_MACHINE: &str = "mps2-an521";
const TWO_CORES: Program = Program {
    name: "two-cores",
    binary: "glidepath-two-cores",
    sources: &["src/main.rs", "src/second.rs", "src/line.rs"],
};

/// Each program: its name in `cargo xtask rtos NAME`, its binary, and the files of its folder that a user
/// writes.
struct Program {
    name: &'static str,
    binary: &'static str,
    sources: &'static [&'static str],
}

const RUST: [Program; 2] = [
    Program { name: "rtic", binary: "glidepath-rtic", sources: &["src/main.rs"] },
    Program { name: "embassy", binary: "glidepath-embassy", sources: &["src/main.rs"] },
];
const C_PROGRAMS: [Program; 2] = [
    Program {
        name: "c",
        binary: "glidepath-c",
        sources: &["example/main.c", "example/work.c", "example/line.c", "example/machine.h"],
    },
    Program {
        name: "freertos",
        binary: "glidepath-freertos",
        sources: &["main.c", "../c/example/work.c", "../c/example/line.c", "../c/example/machine.h"],
    },
];

/// Runs only these programs: `cargo xtask rtos`, or the program `name`.
pub fn all(name: Option<&str>) -> Result<(), String> {
    let known = RUST.iter().chain(&C_PROGRAMS).chain([&TWO_CORES]).map(|program| program.name);
    if let Some(name) = name
        && !known.clone().any(|other| other == name)
    {
        let known: Vec<&str> = known.collect();
        return Err(format!("no program is called {name}; expected one of {}", known.join(", ")));
    }
    step("firmware");
    chosen(&Firmware::prepare(Place::Emulator)?, name)
}

/// Builds and runs all programs.
pub fn run(firmware: &Firmware) -> Result<(), String> {
    chosen(firmware, None)
}

fn chosen(firmware: &Firmware, name: Option<&str>) -> Result<(), String> {
    let is_chosen = |program: &&Program| name.is_none_or(|name| name == program.name);
    let rust: Vec<&Program> = RUST.iter().filter(is_chosen).collect();
    let c: Vec<&Program> = C_PROGRAMS.iter().filter(is_chosen).collect();
    let compiler = if c.is_empty() { Err("not asked for".into()) } else { toolchain::c_compiler() };
    let host = host::tasks()?;
    let mut packages: Vec<&str> = rust.iter().map(|program| program.binary).collect();
    if compiler.is_ok() {
        packages.push(C_PACKAGE);
    }
    // One build, so that common parts are compiled once.
    let packages: Vec<&str> = packages.iter().flat_map(|name| ["--package", name]).collect();
    if !packages.is_empty() {
        firmware.build(TASKS, &packages, &[])?;
    }
    step("in an operating system, in C, and on two cores");
    for program in rust {
        alike(&host, program, firmware)?;
    }
    if is_chosen(&&TWO_CORES) {
        two_cores(firmware, &host)?;
    }
    match compiler {
        Ok(compiler) => c.iter().try_for_each(|program| c_program(firmware, &host, &compiler, program)),
        Err(why) => {
            c.iter().for_each(|program| eprintln!("   {}: off: {why}", program.name));
            Ok(())
        }
    }
}

/// Builds and runs the program for two cores.
fn two_cores(firmware: &Firmware, host: &HostRun) -> Result<(), String> {
    if !firmware.toolchain().has(TWO_CORES_TARGET) {
        eprintln!("   {}: off, no library for {TWO_CORES_TARGET} (`rustup target add`)", TWO_CORES.name);
        return Ok(());
    }
    let mut command = firmware.toolchain().cargo(&root().join(TASKS), "build", TWO_CORES_TARGET);
    shell::run(command.args(["--package", TWO_CORES.binary]))?;
    let file = artifact_of(TWO_CORES_TARGET, TWO_CORES.binary);
    alike_on(host, &TWO_CORES, |answer| firmware.talk_on(TWO_CORES_MACHINE, &file, answer))
}

/// Writes the header for C: `cargo xtask header`.
pub fn header() -> Result<(), String> {
    shell::run(shell::cargo(&root()).args(["run", "--release", "--package", "glidepath-c-header"]))
}

/// Links the static library with a C program: one without an operating system, or one with FreeRTOS.
fn c_program(firmware: &Firmware, host: &HostRun, compiler: &Path, program: &Program) -> Result<(), String> {
    let example = root().join(C).join("example");
    let mut sources: Vec<PathBuf> = C_SOURCES.iter().map(|name| example.join(name)).collect();
    let mut folders = vec![root().join(C).join("include"), example.clone()];
    if program.name == "freertos" {
        let (kernel, freertos) = (kernel()?, root().join(FREERTOS));
        sources.push(freertos.join("main.c"));
        sources.extend(KERNEL_SOURCES.map(|name| kernel.join(name)));
        folders.extend([freertos, kernel.join("include"), kernel.join(KERNEL_PORT)]);
    } else {
        sources.push(example.join("main.c"));
    }
    let mut gcc = Command::new(compiler);
    gcc.args(C_FLAGS);
    for folder in folders {
        gcc.arg("-I").arg(folder);
    }
    gcc.arg("-L").arg(root()).arg("-T").arg(example.join("link.ld"));
    gcc.args(sources).arg(artifact(C_LIBRARY)).arg("-lgcc");
    shell::run(gcc.arg("-o").arg(artifact(program.binary)))?;
    alike(host, program, firmware)
}

/// The folder of the FreeRTOS kernel, inside a crate.
fn kernel() -> Result<PathBuf, String> {
    let mut command = shell::cargo(&root().join(FREERTOS));
    command.args(["metadata", "--format-version", "1", "--locked"]);
    let output = shell::capture(&mut command, LONGEST)?;
    let text = String::from_utf8_lossy(&output.out);
    let is_it = |word: &&str| word.contains(KERNEL_CRATE) && word.ends_with("Cargo.toml");
    let manifest = text.split('"').find(is_it).ok_or(output.err)?;
    Ok(Path::new(manifest).with_file_name("FreeRTOS-Kernel"))
}

/// The parts of the program: the sender sends the second part when the axes stand still.
fn parts() -> [Vec<u8>; 2] {
    let at = TASKS_NC.windows(SECOND_PART.len()).position(|word| word == SECOND_PART);
    let (first, second) = TASKS_NC.split_at_checked(at.unwrap_or(0)).unwrap_or_default();
    [first, second].map(|part| [part, &[END_OF_PART]].concat())
}

/// Runs a program on the reference machine, as [`alike_on`].
fn alike(host: &HostRun, program: &Program, firmware: &Firmware) -> Result<(), String> {
    alike_on(host, program, |answer| firmware.talk(program.binary, answer))
}

/// The sender's next bytes, after each new output of the program.
type Sender<'a> = &'a mut dyn FnMut(&[u8]) -> Option<Vec<u8>>;

/// Runs a program, with its text over the serial line. Checks set points and functions against the PC's, and
/// the number of user lines against the folder's README.
fn alike_on(
    host: &HostRun,
    program: &Program,
    talk: impl FnOnce(Sender<'_>) -> Result<String, String>,
) -> Result<(), String> {
    let (name, mut parts, mut next) = (program.name, parts(), 0);
    let report = talk(&mut |said| {
        let signal = SIGNALS.get(next)?;
        let is_time = said.windows(signal.len()).any(|word| word == *signal);
        let part = parts.get_mut(next).filter(|_| is_time)?;
        next += 1;
        Some(std::mem::take(part))
    })?;
    let last = report.lines().last().unwrap_or_default();
    let values = target::fields(last);
    let theirs = (target::number(&values, "ticks", &report)?, target::digest(&values, &report)?);
    let ours = (u64::from(host.outcome.ticks), host.outcome.digest.value());
    let functions = report.lines().filter(|line| line.trim_start_matches(READY).starts_with('N')).count();
    if theirs != ours || functions != FUNCTIONS {
        return Err(format!(
            "{name}: host {} ticks, digest {:016x}, {FUNCTIONS} functions; target:\n{report}",
            ours.0, ours.1
        ));
    }
    let lines = told_lines(program)?;
    eprintln!(
        "   {name:<10} {:>7} ticks  {:016x}  as on the host; {functions} functions, {lines} lines of user code",
        theirs.0, theirs.1
    );
    Ok(())
}

/// Number of lines of code that a user writes, without comments and empty lines; the README must have this
/// number.
fn told_lines(program: &Program) -> Result<usize, String> {
    let folder = root().join("boards").join(program.name);
    let read = |file: &str| {
        std::fs::read_to_string(folder.join(file)).map_err(|e| format!("{}/{file}: {e}", program.name))
    };
    let mut lines = 0;
    for file in program.sources {
        let is_code = |line: &&str| !line.trim().is_empty() && !line.trim().starts_with("//");
        lines += read(file)?.lines().filter(is_code).count();
    }
    let said = format!("{lines} lines of code");
    if read("README.md")?.contains(&said) {
        return Ok(lines);
    }
    Err(format!("boards/{}/README.md does not say \"{said}\"", program.name))
}

//! The table of cores: programs on emulated cores, with the PC's digests, instructions, flash and RAM.
//!
//! Two builds: all functions with the flags for products, and lines, arcs and contour mode for size. Each
//! core has its own counter; loops of known length check that the counter is right to one instruction.
use crate::figures::{self, Figures};
use crate::firmware::{Firmware, Place};
use crate::shell::{root, step};
use crate::target::{self, Cost, TargetRun};
use crate::{elf, host, shell, toolchain};
use std::collections::BTreeMap;
use std::fmt::Write;
use std::process::Command;
use std::time::Duration;

const PACKAGE: &str = "hil-cores";
const TESTS: &str = "hil-tests";

/// Time limit of a run.
const LONGEST: Duration = Duration::from_secs(900);

/// The file of the figures, and the page that shows the figures.
const ACCEPTED: &str = "hil-tests/tables/cores.toml";
const PAGE: &str = "docs/cores.md";
/// Marks around the generated part of the page.
const BEGIN: &str = "<!-- begin of figures: `cargo xtask cores --accept` -->\n";
const END: &str = "<!-- end of figures -->\n";

/// Begin of the line about floating point, on a core without instructions for it.
const FLOATS: &str = "floats ";

/// Ticks per second: the cycle of the machines.
const TICKS: u64 = 1000;

/// The builds.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Build {
    /// All functions.
    Full,
    /// Lines, arcs and contour mode, for size.
    Small,
}

impl Build {
    const ALL: [Self; 2] = [Self::Full, Self::Small];

    fn key(self) -> &'static str {
        if self == Self::Full { "full" } else { "small" }
    }

    /// The program with corner curves, for the table.
    fn corners(self) -> &'static str {
        if self == Self::Full { "corners" } else { "contour" }
    }
}

/// An emulated machine.
struct Machine {
    emulator: &'static str,
    machine: &'static [&'static str],
    /// An instruction takes two to the power of this number in nanoseconds. The number is small enough for
    /// calls that are counted with 24 bits, and large enough for more than one count per instruction.
    shift: &'static str,
    /// Number of counts, and of instructions, that are equal.
    counts: [u64; 2],
    map: &'static str,
}

const ARM: &str = "qemu-system-arm";
const RISC_V: &str = "qemu-system-riscv32";

const AN385: Machine = Machine {
    emulator: ARM,
    machine: &["mps2-an385"],
    shift: "6",
    counts: [8, 5],
    map: "hil-tests/maps/mps2-an385.x",
};
const VIRT: Machine = Machine {
    emulator: RISC_V,
    machine: &["virt", "-bios", "none"],
    shift: "0",
    counts: [1, 1],
    map: "hil-tests/maps/riscv-virt.x",
};
const AN505: Machine = Machine {
    emulator: ARM,
    machine: &["mps2-an505"],
    shift: "6",
    counts: [32, 25],
    map: "hil-tests/maps/mps2-an505.x",
};
const NETDUINO: Machine =
    Machine { emulator: ARM, machine: &["netduinoplus2"], shift: "3", counts: [168, 125], map: "memory.x" };

/// A core of the table.
struct Core {
    key: &'static str,
    name: &'static str,
    target: &'static str,
    /// Machines for the full build and for the small build.
    machines: [Machine; 2],
    chip: &'static str,
    mhz: u64,
}

impl Core {
    fn machine(&self, build: Build) -> &Machine {
        let [full, small] = &self.machines;
        if build == Build::Full { full } else { small }
    }
}

const CORES: [Core; 6] = [
    Core {
        key: "m0",
        name: "Cortex-M0+",
        target: "thumbv6m-none-eabi",
        // A Cortex-M3 executes all instructions of a Cortex-M0+.
        machines: [AN385, AN385],
        chip: "RP2040",
        mhz: 133,
    },
    Core {
        key: "m3",
        name: "Cortex-M3",
        target: "thumbv7m-none-eabi",
        machines: [AN385, AN385],
        chip: "SAM3X8E",
        mhz: 84,
    },
    Core {
        key: "m4f",
        name: "Cortex-M4F",
        target: "thumbv7em-none-eabihf",
        machines: [NETDUINO, NETDUINO],
        chip: "STM32F405",
        mhz: 168,
    },
    Core {
        key: "m33",
        name: "Cortex-M33F",
        target: "thumbv8m.main-none-eabihf",
        machines: [AN505, AN505],
        chip: "RP2350, ARM",
        mhz: 150,
    },
    Core {
        key: "rv32imc",
        name: "RV32IMC",
        target: "riscv32imc-unknown-none-elf",
        machines: [VIRT, VIRT],
        chip: "ESP32-C3",
        mhz: 160,
    },
    Core {
        key: "rv32imac",
        name: "RV32IMAC",
        target: "riscv32imac-unknown-none-elf",
        machines: [VIRT, VIRT],
        chip: "RP2350, RISC-V",
        mhz: 150,
    },
];

/// Hard limits, also for accepted figures. Core and build, then: tick, tick on curves, block of lines with
/// its decoder, block with a curve, largest call, bytes of flash, bytes of channel and stack. All other
/// figures may not be worse than accepted.
const LIMITS: [(&str, [u64; 7]); 12] = [
    ("m0.full", [1870, 2620, 51200, 296_000, 377_000, 573 * 1024, 64 * 1024]),
    ("m0.small", [2610, 3270, 60900, 1_100_000, 421_000, 284 * 1024, 33 * 1024]),
    ("m3.full", [400, 530, 41100, 250_000, 383_000, 546 * 1024, 63 * 1024]),
    ("m3.small", [1070, 1170, 49200, 1_040_000, 427_000, 258 * 1024, 33 * 1024]),
    ("m4f.full", [390, 540, 10200, 53400, 39400, 527 * 1024, 63 * 1024]),
    ("m4f.small", [1050, 1160, 17200, 198_000, 48900, 261 * 1024, 33 * 1024]),
    ("m33.full", [390, 540, 10100, 52000, 39100, 520 * 1024, 63 * 1024]),
    ("m33.small", [1060, 1160, 16900, 195_000, 48300, 259 * 1024, 33 * 1024]),
    ("rv32imc.full", [650, 900, 44700, 272_000, 402_000, 701 * 1024, 63 * 1024]),
    ("rv32imc.small", [1420, 1760, 58200, 1_140_000, 446_000, 335 * 1024, 33 * 1024]),
    ("rv32imac.full", [650, 900, 44700, 272_000, 402_000, 701 * 1024, 63 * 1024]),
    ("rv32imac.small", [1420, 1760, 58200, 1_140_000, 446_000, 335 * 1024, 33 * 1024]),
];

/// Names of these figures, after the core and the build.
const LIMITED: [&str; 7] =
    ["tick_max_plain", "tick_max", "block_plain", "block_curve", "poll_max", "flash", "ram_total"];

/// Cores, builds and `--accept` in the arguments of `cargo xtask cores`. Without a name: all cores and
/// builds.
struct Chosen {
    cores: Vec<&'static Core>,
    builds: Vec<Build>,
    accept: bool,
}

impl Chosen {
    fn read(words: &[&str]) -> Result<Self, String> {
        let known = CORES.iter().map(|core| core.key).chain(Build::ALL.map(Build::key)).chain(["--accept"]);
        let known: Vec<&str> = known.collect();
        if let Some(word) = words.iter().find(|word| !known.contains(word)) {
            return Err(format!("cores {word}: expected one of {}", known.join(", ")));
        }
        let mut cores: Vec<&Core> = CORES.iter().filter(|core| words.contains(&core.key)).collect();
        if cores.is_empty() {
            cores = CORES.iter().collect();
        }
        let mut builds: Vec<Build> =
            Build::ALL.into_iter().filter(|build| words.contains(&build.key())).collect();
        if builds.is_empty() {
            builds = Build::ALL.to_vec();
        }
        Ok(Self { cores, builds, accept: words.contains(&"--accept") })
    }
}

/// Runs all or the named cores: `cargo xtask cores`. Each core is measured and compared, or accepted,
/// separately. A core that fails does not stop the others, and an interrupted run keeps its finished
/// measurements.
pub fn all(words: &[&str]) -> Result<(), String> {
    let Chosen { cores, builds, accept } = Chosen::read(words)?;
    let firmware = Firmware::prepare(Place::Emulator)?;
    let mut failed = Vec::new();
    for build in builds {
        let expected = expected(build)?;
        for core in &cores {
            step(&format!("{}, {} build", core.name, build.key()));
            let measured = measure(&firmware, core, build, &expected);
            let ended = measured.and_then(|values| {
                let figures = Figures { compiler: firmware.compiler().into(), values };
                if figures.values.is_empty() { Ok(()) } else { end(&figures, accept) }
            });
            if let Err(why) = ended {
                eprintln!("   FAILED: {why}");
                failed.push(format!("{}, {} build: {why}", core.name, build.key()));
            }
        }
    }
    if failed.is_empty() { Ok(()) } else { Err(failed.join("\n")) }
}

/// Ticks and digest of each program on the PC.
fn expected(build: Build) -> Result<Expected, String> {
    if build == Build::Full {
        let runs = host::cores()?.into_iter();
        let outcome = |run: host::HostRun| (u64::from(run.outcome.ticks), run.outcome.digest.value());
        return Ok(runs.map(|run| (run.name.to_owned(), outcome(run))).collect());
    }
    let mut found = BTreeMap::new();
    for line in host::slim()?.lines() {
        let (name, rest) = line.split_once(' ').ok_or(line)?;
        let values = target::fields(rest);
        if target::number(&values, "look_ahead", line)? == hil_cases::SHORT as u64 {
            let outcome = (target::number(&values, "ticks", line)?, target::digest(&values, line)?);
            found.insert(name.to_owned(), outcome);
        }
    }
    Ok(found)
}

/// Ticks and digest of a program, by its name.
type Expected = BTreeMap<String, (u64, u64)>;

/// The figures of a core and a build; none without a library or an emulator.
fn measure(
    firmware: &Firmware,
    core: &Core,
    build: Build,
    expected: &Expected,
) -> Result<BTreeMap<String, u64>, String> {
    let mut figures = BTreeMap::new();
    let Some(report) = run(firmware, core, build)? else { return Ok(figures) };
    let runs = counted(&report, core.machine(build).counts)?;
    compare(core, &runs, expected)?;
    compare_floats(core, &report)?;
    let prefix = format!("core.{}.{}", core.key, build.key());
    add(&mut figures, &prefix, &runs, build)?;
    let values = report.lines().find_map(|line| line.strip_prefix("memory ")).map(target::fields);
    let values = values.ok_or("no bytes of memory")?;
    let [channel, stack] =
        [target::number(&values, "channel", &report)?, target::number(&values, "stack", &report)?];
    let file = std::fs::read(artifact(core, build, "size")).map_err(|e| format!("size: {e}"))?;
    let flash = elf::flash(&file).ok_or("size: no load segments")?;
    for (key, value) in
        [("ram_channel", channel), ("ram_stack", stack), ("ram_total", channel + stack), ("flash", flash)]
    {
        figures.insert(format!("{prefix}.{key}"), value);
    }
    Ok(figures)
}

/// Whether each program has the ticks and the digest of the PC.
fn compare(core: &Core, runs: &[TargetRun], expected: &Expected) -> Result<(), String> {
    for run in runs {
        let theirs = (run.ticks, run.digest);
        if expected.get(&run.name) != Some(&theirs) || run.starved != 0 || run.failed.is_some() {
            return Err(format!(
                "{} on {} DIFFERS: host {:x?}, target {theirs:x?}, starved {}",
                run.name,
                core.name,
                expected.get(&run.name),
                run.starved
            ));
        }
        eprintln!("   {:<16} {:>7} ticks  {:016x}  as on the host", run.name, run.ticks, run.digest);
    }
    Ok(())
}

/// Whether the functions for floating point of a core without its instructions give the bits of the PC.
fn compare_floats(core: &Core, report: &str) -> Result<(), String> {
    if core.target.ends_with("eabihf") {
        return Ok(());
    }
    let line = report.lines().find_map(|line| line.strip_prefix(FLOATS)).ok_or("floats were not tried")?;
    let pairs = target::number(&target::fields(line), "pairs", line)?;
    let digest = glidepath_softfloat::trial::digest(1, pairs.try_into().map_err(|_| line)?);
    if line != format!("pairs {pairs} digest {digest:016x} copies right") {
        return Err(format!("floating point on {}: {line}; host: {digest:016x}", core.name));
    }
    eprintln!("   {pairs} pairs of numbers: floating point as on the host");
    Ok(())
}

/// Builds both binaries and runs the one that counts; `None` without a library or an emulator.
fn run(firmware: &Firmware, core: &Core, build: Build) -> Result<Option<String>, String> {
    let machine = core.machine(build);
    if !firmware.toolchain().has(core.target) {
        eprintln!("   off: no library for {} (`rustup target add`)", core.target);
        return Ok(None);
    }
    let emulator = match toolchain::emulator_of(machine.emulator) {
        Ok(emulator) => emulator,
        Err(why) => {
            eprintln!("   off: {why}");
            return Ok(None);
        }
    };
    let is_riscv = machine.emulator == RISC_V;
    let mut command = firmware.toolchain().cargo(&root().join(TESTS), "build", core.target);
    command
        .args(["--package", PACKAGE])
        .env("HIL_MEMORY_X", machine.map)
        .env("CARGO_TARGET_DIR", folder(build));
    let script = if is_riscv { "-C link-arg=-Tmemory.x" } else { "-C link-arg=-Tlink.x" };
    if build == Build::Small {
        // The compiler's own inlining limit, not that of the large build.
        command.args(["--no-default-features", "--features", "glidepath/contour"]);
        command.env("RUSTFLAGS", script).env("CARGO_PROFILE_RELEASE_OPT_LEVEL", "z");
    } else if is_riscv {
        command.env(
            "RUSTFLAGS",
            format!("{script} -C llvm-args=-inline-threshold=40 -C llvm-args=-unroll-max-count=2"),
        );
    }
    shell::run(&mut command)?;
    let mut command = Command::new(emulator);
    command.arg("-M").args(machine.machine);
    command.args(["-nographic", "-monitor", "none", "-serial", "none"]);
    command.args(["-semihosting-config", "enable=on,target=native"]);
    command.args(["-icount", &format!("shift={},sleep=off", machine.shift)]);
    let output = shell::capture(command.arg("-kernel").arg(artifact(core, build, "costs")), LONGEST)?;
    let text = String::from_utf8_lossy(&output.out).into_owned();
    if output.success { Ok(Some(text)) } else { Err(format!("{}: {text}{}", core.name, output.err)) }
}

fn folder(build: Build) -> std::path::PathBuf {
    let folder = toolchain::folder_of_artifacts();
    if build == Build::Full { folder } else { folder.join("small") }
}

fn artifact(core: &Core, build: Build, name: &str) -> std::path::PathBuf {
    folder(build).join(core.target).join("release").join(name)
}

/// The runs of a report, in instructions. Fails if the count of a loop of known length is wrong by more than
/// one instruction.
fn counted(report: &str, [counts, instructions]: [u64; 2]) -> Result<Vec<TargetRun>, String> {
    let lines = |is_loop: bool| report.lines().filter(move |line| line.starts_with("loop ") == is_loop);
    let mut loops = Vec::new();
    for line in lines(true) {
        let values = target::fields(line.strip_prefix("loop ").unwrap_or(line));
        loops.push((
            target::number(&values, "instructions", line)?,
            target::number(&values, "counted", line)?,
        ));
    }
    let instructions = |counted: u64| (counted * instructions + counts / 2) / counts;
    if loops.is_empty() {
        return Err("the counter of the core was not looked at".into());
    }
    if let Some((number, counted)) =
        loops.iter().find(|&&(number, counted)| instructions(counted).abs_diff(number) > 1)
    {
        return Err(format!("{number} instructions were counted as {}", instructions(*counted)));
    }
    let text: Vec<&str> = lines(false).filter(|line| !line.starts_with(FLOATS)).collect();
    let mut runs = target::read_runs(&text.join("\n"))?;
    let convert = |cost: &mut Cost| (cost.sum, cost.max) = (instructions(cost.sum), instructions(cost.max));
    for run in &mut runs {
        let costs = [&mut run.start, &mut run.tick, &mut run.plan, &mut run.wait, &mut run.decode];
        costs.into_iter().for_each(convert);
    }
    Ok(runs)
}

/// The figures of a core and a build.
fn add(
    figures: &mut BTreeMap<String, u64>,
    prefix: &str,
    runs: &[TargetRun],
    build: Build,
) -> Result<(), String> {
    let per_block = |sum: u64, run: &TargetRun| sum.div_ceil(run.blocks.max(1));
    for run in runs {
        let mut set = |key: &str, value: u64| figures.insert(format!("{prefix}.{}.{key}", run.name), value);
        set("tick_mean", run.tick.sum.div_ceil(run.tick.calls.max(1)));
        set("tick_max", run.tick.max);
        set("block_total_mean", per_block(run.plan.sum, run));
        set("decode_mean", per_block(run.decode.sum, run));
        set("poll_max", run.plan.max.max(run.wait.max));
    }
    let named =
        |name: &str| runs.iter().find(|run| run.name == name).ok_or_else(|| format!("{name} did not run"));
    let most = |of: &dyn Fn(&TargetRun) -> u64| runs.iter().map(of).max().unwrap_or(0);
    let (plain, curve) = (named("plain")?, named(build.corners())?);
    let straight = named("lines")?.tick.max.max(named("arcs")?.tick.max).max(plain.tick.max);
    for (key, value) in [
        ("tick_max_plain", straight),
        ("tick_max", most(&|run| run.tick.max)),
        ("block_plain", per_block(plain.plan.sum, plain)),
        ("block_curve", per_block(curve.plan.sum, curve)),
        ("poll_max", most(&|run| run.plan.max.max(run.wait.max))),
        ("start_max", most(&|run| run.start.max)),
    ] {
        figures.insert(format!("{prefix}.{key}"), value);
    }
    Ok(())
}

/// Writes the figures to the file, or compares them.
fn end(measured: &Figures, accept: bool) -> Result<(), String> {
    eprint!("{}", measured.table());
    let beyond = beyond(measured);
    if !beyond.is_empty() {
        return Err(format!("beyond a hard limit: {}", beyond.join("; ")));
    }
    let file = root().join(ACCEPTED);
    let accepted = std::fs::read_to_string(&file).ok().and_then(|text| Figures::from_toml(&text).ok());
    if accept {
        // Figures that were not measured this time stay.
        let mut all = accepted.map_or_else(BTreeMap::new, |accepted| accepted.values);
        all.extend(measured.values.clone());
        let all = Figures { compiler: measured.compiler.clone(), values: all };
        let text = all.to_toml(
            "Accepted figures of the table of cores: instructions and bytes. Written by `cargo xtask cores --accept`.",
        );
        std::fs::write(&file, text).map_err(|e| format!("{}: {e}", file.display()))?;
        return write_page(&all);
    }
    let mut accepted =
        accepted.ok_or_else(|| format!("{ACCEPTED}: `cargo xtask cores --accept` writes it"))?;
    let page = page()?;
    if generated(&page) != Some(tables(&accepted).as_str()) {
        return Err(format!("{PAGE} is not what {ACCEPTED} says: `cargo xtask cores --accept` writes both"));
    }
    let builds: Vec<String> = measured.values.keys().filter_map(|key| prefix(key)).collect();
    accepted.values.retain(|key, _| prefix(key).is_some_and(|prefix| builds.contains(&prefix)));
    let (wrong, better) = figures::differences(measured, &accepted);
    eprintln!("   {} figures, {better} better than accepted", measured.values.len());
    if wrong.is_empty() { Ok(()) } else { Err(format!("worse than accepted:\n   {}", wrong.join("\n   "))) }
}

/// `core.KEY.BUILD` of a figure's name.
fn prefix(key: &str) -> Option<String> {
    let parts: Vec<&str> = key.splitn(4, '.').collect();
    (parts.len() == 4).then(|| parts[..3].join("."))
}

/// Figures beyond their hard limit, as text.
fn beyond(measured: &Figures) -> Vec<String> {
    let mut found = Vec::new();
    for (prefix, limits) in LIMITS {
        for (key, limit) in LIMITED.iter().zip(limits) {
            let key = format!("core.{prefix}.{key}");
            if let Some(value) = measured.values.get(&key).filter(|&&value| value > limit) {
                found.push(format!("{key} = {value}, limit {limit}"));
            }
        }
    }
    found
}

fn page() -> Result<String, String> {
    std::fs::read_to_string(root().join(PAGE)).map_err(|e| format!("{PAGE}: {e}"))
}

/// The generated part of the page.
fn generated(page: &str) -> Option<&str> {
    let (_, rest) = page.split_once(BEGIN)?;
    Some(rest.split_once(END)?.0)
}

fn write_page(figures: &Figures) -> Result<(), String> {
    let page = page()?;
    let old = generated(&page).ok_or_else(|| format!("{PAGE}: no part for figures"))?;
    let new = page.replace(&format!("{BEGIN}{old}{END}"), &format!("{BEGIN}{}{END}", tables(figures)));
    std::fs::write(root().join(PAGE), new).map_err(|e| format!("{PAGE}: {e}"))
}

/// The tables of the page.
fn tables(figures: &Figures) -> String {
    let mut text = String::new();
    for build in Build::ALL {
        let title = if build == Build::Full {
            "All functions"
        } else {
            "Lines, arcs and contour mode, for few bytes"
        };
        let curve = build.corners();
        let _ = write!(
            text,
            "### {title}\n\n| core | tick, lines and arcs | tick, curves | block, lines | block, curves | largest call | of program | flash | channel and stack |\n\
             |---|---:|---:|---:|---:|---:|---|---:|---:|\n"
        );
        for core in &CORES {
            row(figures, core, build, &mut text);
        }
        let _ = write!(text, "\nThe block with curves is that of `programs/{curve}.nc`. ");
        let _ = writeln!(text, "Limits, in the same order:\n");
        let _ = writeln!(
            text,
            "| core | tick, lines and arcs | tick, curves | block, lines | block, curves | largest call | flash | channel and stack |"
        );
        let _ = writeln!(text, "|---|---:|---:|---:|---:|---:|---:|---:|");
        for core in &CORES {
            let key = format!("{}.{}", core.key, build.key());
            if let Some((_, limits)) = LIMITS.iter().find(|(prefix, _)| *prefix == key) {
                let limits: Vec<String> = limits.iter().map(u64::to_string).collect();
                let _ = writeln!(text, "| {} | {} |", core.name, limits.join(" | "));
            }
        }
        text.push('\n');
    }
    let _ = write!(
        text,
        "### Blocks per second, derived\n\n| chip | core | clock | lines, all functions | curves, all functions | lines, small build | curves, small build |\n\
         |---|---|---:|---:|---:|---:|---:|\n"
    );
    for core in &CORES {
        let _ = write!(text, "| {} | {} | {} MHz |", core.chip, core.name, core.mhz);
        for build in Build::ALL {
            for block in ["block_plain", "block_curve"] {
                let _ = write!(text, " {} |", per_second(figures, core, build, block));
            }
        }
        text.push('\n');
    }
    text
}

fn row(figures: &Figures, core: &Core, build: Build, text: &mut String) {
    let prefix = format!("core.{}.{}", core.key, build.key());
    let get = |key: &str| figures.values.get(&format!("{prefix}.{key}")).copied();
    let show = |key: &str| get(key).map_or("not measured".into(), |value| value.to_string());
    let is_it = |key: &&String| {
        key.starts_with(&prefix)
            && key.ends_with(".poll_max")
            && figures.values.get(*key) == get("poll_max").as_ref()
    };
    let cases = figures.values.keys().filter(is_it).filter_map(|key| key.strip_prefix(&format!("{prefix}.")));
    let case = cases.filter_map(|key| key.strip_suffix(".poll_max")).next().unwrap_or("");
    let _ = write!(text, "| {} |", core.name);
    for key in LIMITED {
        let _ = write!(text, " {} |", show(key));
        if key == "poll_max" {
            let _ = write!(text, " {case} |");
        }
    }
    text.push('\n');
}

/// Blocks per second at one instruction per clock, without the time of the ticks.
fn per_second(figures: &Figures, core: &Core, build: Build, block: &str) -> String {
    let get = |key: &str| figures.values.get(&format!("core.{}.{}.{key}", core.key, build.key())).copied();
    let (Some(block), Some(tick)) = (get(block), get("tick_max")) else { return "not measured".into() };
    ((core.mhz * 1_000_000).saturating_sub(tick * TICKS) / block.max(1)).to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    const REPORT: &str = "loop instructions 10 counted 16\nloop instructions 100 counted 160\n\
        case plain axes 3 blocks 30\ncost tick calls 2 sum 320 max 161\nend ticks 2 starved 0 blocks 1 digest 0\n\
        memory channel 1 stack 2\n";

    #[test]
    fn counts_become_instructions() {
        let runs = counted(REPORT, [8, 5]).unwrap_or_default();
        assert_eq!((runs[0].tick.sum, runs[0].tick.max), (200, 101));
    }

    #[test]
    fn a_counter_that_is_not_exact_is_told() {
        let wrong = REPORT.replace("100 counted 160", "100 counted 164");
        assert_eq!(counted(&wrong, [8, 5]).err().as_deref(), Some("100 instructions were counted as 103"));
        assert!(counted("", [8, 5]).is_err());
    }

    #[test]
    fn limits_are_those_of_a_core_and_a_build() {
        for (key, _) in LIMITS {
            let is_it =
                |core: &Core| Build::ALL.iter().any(|build| format!("{}.{}", core.key, build.key()) == key);
            assert!(CORES.iter().any(is_it), "{key}");
        }
    }

    #[test]
    fn words_name_cores_and_builds() {
        let read =
            |words: &[&str]| Chosen::read(words).map(|it| (it.cores.len(), it.builds.len(), it.accept));
        assert_eq!(read(&[]), Ok((6, 2, false)));
        assert_eq!(read(&["m0", "small", "--accept"]), Ok((1, 1, true)));
        assert!(read(&["m9"]).is_err_and(|error| error.starts_with("cores m9: expected one of m0, ")));
    }

    #[test]
    fn a_figure_beyond_its_limit_is_told() {
        let (prefix, limits) = LIMITS[0];
        let value = |more| BTreeMap::from([(format!("core.{prefix}.flash"), limits[5] + more)]);
        let figures = |more| Figures { compiler: String::new(), values: value(more) };
        assert!(beyond(&figures(0)).is_empty());
        assert_eq!(beyond(&figures(1)).len(), 1);
    }
}

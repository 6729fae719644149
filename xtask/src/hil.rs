//! The target's tests: same bits, real interrupt, no panicking path, and the figures.
use crate::controller;
use crate::dialects;
use crate::figures::{self, Beside, Commanded, Figures, MemoryFigures};
use crate::firmware::{CORES, Firmware, Place, artifact, small};
use crate::host::{self, HostRun};
use crate::rtos;
use crate::shell::step;
use crate::stack::Calls;
use crate::target::{self, TargetRun};
use crate::{elf, shell};
use std::collections::BTreeMap;

const TESTS: &str = "hil-tests";
const BOARD: &str = "boards/stm32f405";
const BOARD_BINARY: &str = "glidepath-stm32f405";

/// The binary with a transformation.
const FIVE: &str = "same_five";

/// One for each configuration, in the order of [`host::run_all`]: together they have no room in the memory.
pub const SAME: [&str; 6] = ["same", "same_four", "same_six", "short_three", "deep_three", "short_six"];

/// The binary that counts instructions and bytes.
const COMMANDS: [&str; 2] = ["commands", "commands_six"];
const COUNTED: [&str; 5] = ["counts", "nopanic", "beside", "commands", "commands_six"];

/// Calls of `nopanic` whose stack has a bound, also in the build for size.
const NOPANIC_CALLS: [(&str, &str); 3] =
    [("start", "7nopanic5start"), ("poll", "7nopanic4poll"), ("interrupt", "SysTick")];

/// Calls whose stack has a bound: axes, binary, call, and a part of the mangled name of the function.
type Bounded = (u64, &'static str, &'static [(&'static str, &'static str)]);
const BOUND: [Bounded; 3] = [
    (3, "nopanic", &NOPANIC_CALLS),
    (3, "same", &[("tick", "9hil_cases3run4tick")]),
    (6, "same_six", &[("poll", "9hil_cases3run4poll"), ("tick", "9hil_cases3run4tick")]),
];

/// Functions of the smallest build with corners, and its binaries that run programs, in the order of
/// [`host::slim_all`].
const SLIM_FUNCTIONS: &str = "glidepath/contour";
const SLIM: [&str; 2] = ["slim", "slim_short"];

/// Arguments of a build.
fn binaries(names: &[&'static str]) -> Vec<&'static str> {
    names.iter().flat_map(|name| ["--bin", name]).collect()
}

/// Highest number of bytes of static memory that are copied from flash at the start, in any binary.
const COPIED: u64 = 512;

/// Highest number of instructions in the board's interrupt: frame, tick and functions.
const INTERRUPT: u64 = 600;

/// The case whose planner has no work for some ticks, because its filters change.
const RESTS: &str = "beside_all";

/// Lowest number of programs that another core runs.
const OTHER_CORES: usize = 3;

/// Programs that the board's firmware runs, in addition to the test firmware.
const BOARD_PROGRAMS: [&str; 2] = ["lines", "arcs"];

/// All tests: `cargo xtask hil`.
pub fn all(place: Place) -> Result<(), String> {
    step("firmware");
    let firmware = Firmware::prepare(place)?;
    let features: &[&str] = if place == Place::Probe { &["--features", "hardware"] } else { &[] };
    let tests = binaries(&[&SAME[..], &COUNTED, &["session", "interrupt", "overflow"]].concat());
    firmware.build(TESTS, &[&tests, features].concat(), &[])?;
    let host = host::run_all()?;
    step("set points of every tick, host and target");
    let (runs, mut memory) = measure(&firmware, &host)?;
    counter(&firmware.report("counts")?)?;
    step("one channel from power-up to power-off");
    sessions(&firmware.report("session")?)?;
    step("filters behind the path, axes beside it");
    memory.beside = beside(&firmware.report("beside")?)?;
    step("commands all the time");
    memory.commands = commands(&firmware)?;
    if place == Place::Emulator {
        step("a program under a transformation");
        five(&firmware)?;
        step("lines, arcs and contour mode alone");
        memory.slim = slim(&firmware)?;
        step("the decoder in each dialect");
        memory.dialects = dialects::measure(&firmware)?;
    }
    step("interpolator in the timer interrupt");
    let report = firmware.report("interrupt")?;
    interrupt(&report, &host)?;
    late(&report, &host)?;
    memory.interrupted = target::read_memory(&report)?;
    step("an overflow of the stack");
    overflow(&firmware)?;
    if place == Place::Emulator {
        memory.controller = controller::short(&firmware)?;
    }
    let measured = Figures::measured(firmware.compiler(), &runs, &memory)?;
    if place == Place::Probe {
        eprint!("{}", measured.table());
        return Ok(());
    }
    step("other cores");
    cores(&firmware, &host)?;
    step("the board's firmware");
    board(&firmware, &host)?;
    rtos::run(&firmware)?;
    step("no panicking path");
    no_panic(&firmware)?;
    step("figures");
    figures::compare(&measured)?;
    eprintln!("\nhil: all passed");
    Ok(())
}

/// Only the counts: `cargo xtask bench`.
pub fn bench(accept: bool) -> Result<(), String> {
    step("firmware");
    let firmware = Firmware::prepare(Place::Emulator)?;
    firmware.build(TESTS, &binaries(&[&SAME[..], &COUNTED, &["interrupt"]].concat()), &[])?;
    let (runs, mut memory) = measure(&firmware, &host::run_all()?)?;
    counter(&firmware.report("counts")?)?;
    memory.beside = beside(&firmware.report("beside")?)?;
    memory.commands = commands(&firmware)?;
    memory.slim = slim(&firmware)?;
    memory.dialects = dialects::measure(&firmware)?;
    memory.interrupted = target::read_memory(&firmware.report("interrupt")?)?;
    memory.controller = controller::interrupt(&firmware)?;
    let measured = Figures::measured(firmware.compiler(), &runs, &memory)?;
    step("figures");
    eprint!("{}", measured.table());
    if accept { figures::accept(&measured) } else { figures::compare(&measured) }
}

/// Only the check for panicking code: `cargo xtask hil --panic`.
pub fn panic_proof() -> Result<(), String> {
    step("no panicking path");
    no_panic(&Firmware::prepare(Place::Emulator)?)
}

/// Only the interpolator in the timer interrupt: `cargo xtask hil --interrupt`.
pub fn only_interrupt() -> Result<(), String> {
    step("interpolator in the timer interrupt");
    let firmware = Firmware::prepare(Place::Emulator)?;
    firmware.build(TESTS, &binaries(&["interrupt"]), &[])?;
    let (report, host) = (firmware.report("interrupt")?, host::run_all()?);
    interrupt(&report, &host)?;
    late(&report, &host)
}

/// Only commands: `cargo xtask hil --commands`.
pub fn only_commands() -> Result<(), String> {
    step("firmware");
    let firmware = Firmware::prepare(Place::Emulator)?;
    firmware.build(TESTS, &binaries(&COMMANDS), &[])?;
    step("commands all the time");
    for (name, worst) in commands(&firmware)? {
        let Commanded { poll, seed, wait } = worst;
        eprintln!("   {name:<16} {poll:>9} with schedule {seed:<3} {wait:>9} where it waits");
    }
    Ok(())
}

/// Only the smallest build: `cargo xtask hil --slim`.
pub fn only_slim() -> Result<(), String> {
    step("firmware");
    let firmware = Firmware::prepare(Place::Emulator)?;
    step("lines, arcs and contour mode alone");
    for (key, value) in slim(&firmware)? {
        eprintln!("   {key:<36} {value:>9}");
    }
    Ok(())
}

/// Only filters and overlays: `cargo xtask hil --beside`.
pub fn only_beside() -> Result<(), String> {
    step("firmware");
    let firmware = Firmware::prepare(Place::Emulator)?;
    firmware.build(TESTS, &binaries(&["beside"]), &[])?;
    step("filters behind the path, axes beside it");
    let figures = beside(&firmware.report("beside")?)?;
    figures.each(|key, value| eprintln!("   {key:<36} {value:>9}"));
    Ok(())
}

/// Only a PLC during the motion: `cargo xtask hil --plc`. The binary compares its results with those of the
/// PC.
pub fn only_plc() -> Result<(), String> {
    step("firmware");
    let firmware = Firmware::prepare(Place::Emulator)?;
    firmware.build(TESTS, &["--bin", "plc", "--features", "plc"], &[])?;
    step("a PLC that ends a loop and sets a laser");
    let report = firmware.report("plc")?;
    let (told, runs): (Vec<&str>, Vec<&str>) = report.lines().partition(|line| line.starts_with("laser "));
    if told != ["laser same"] {
        return Err(format!("the laser differs from the simulator's: {told:?}"));
    }
    eprintln!("   the laser changes at the simulator's ticks");
    for run in target::read_runs(&runs.join("\n"))? {
        let tick = &run.tick;
        let mean = tick.sum / tick.calls.max(1);
        eprintln!("   {:<16} {:016x}  tick {} at most, {mean} on average", run.name, run.digest, tick.max);
    }
    Ok(())
}

/// A program under a transformation only: `cargo xtask hil --five`.
pub fn only_five() -> Result<(), String> {
    step("firmware");
    let firmware = Firmware::prepare(Place::Emulator)?;
    step("a program under a transformation");
    let host = five(&firmware)?;
    five_elsewhere(&firmware, &host)
}

/// Highest figures of the program under a transformation on the reference core. Instructions of a motion block on
/// average, of a planner call, and of a tick; bytes of the channel, and of the stack.
const FIVE_LIMITS: [(&str, u64); 5] = [
    ("five.block_mean", 220_000),
    ("five.poll_max", 135_000),
    ("five.tick_max", 700),
    ("five.ram_channel", 90_000),
    ("five.ram_stack", 13_000),
];

/// The program under a transformation has the host's set points on the reference core, and its figures are within their
/// limits. Its binary is built with a feature of its own. Returns the host's run.
fn five(firmware: &Firmware) -> Result<[HostRun; 1], String> {
    firmware.build(TESTS, &["--features", "five", "--bin", FIVE], &[])?;
    let report = firmware.report(FIVE)?;
    let (runs, host) = (target::read_runs(&report)?, [host::five()?]);
    alike(&host, &runs)?;
    static_memory(FIVE)?;
    let mut figures = BTreeMap::<&str, u64>::new();
    let mut set = |key, value: u64| {
        let most = figures.entry(key).or_default();
        *most = value.max(*most);
    };
    for run in &runs {
        let plan = run.plan.sum.saturating_sub(run.decode.sum);
        set("five.block_mean", plan.div_ceil(run.blocks.max(1)));
        set("five.poll_max", run.plan.max.max(run.wait.max));
        set("five.tick_max", run.tick.max);
    }
    for row in target::read_memory(&report)? {
        set("five.ram_channel", row.channel);
        set("five.ram_stack", row.depth);
    }
    for (key, limit) in FIVE_LIMITS {
        let value = figures.get(key).copied().ok_or_else(|| format!("{FIVE} reports no {key}"))?;
        eprintln!("   {key:<36} {value:>9}   limit {limit}");
        if value > limit {
            return Err(format!("{key} is {value}, its limit {limit}"));
        }
    }
    Ok(host)
}

/// The same set points on the other cores.
fn five_elsewhere(firmware: &Firmware, host: &[HostRun]) -> Result<(), String> {
    for core in &CORES {
        if let Some(report) = firmware.elsewhere_with(core, TESTS, &["--features", "five"], FIVE)? {
            eprintln!("   {}", core.name);
            alike(host, &target::read_runs(&report)?)?;
        }
    }
    Ok(())
}

/// The programs of all configurations, and what memory they took.
fn measure(firmware: &Firmware, host: &[HostRun]) -> Result<(Vec<TargetRun>, MemoryFigures), String> {
    let (mut runs, mut said, mut success) = (Vec::new(), String::new(), true);
    let mut memory = MemoryFigures::default();
    for name in SAME {
        let output = firmware.run(name)?;
        let report = String::from_utf8_lossy(&output.out);
        runs.extend(target::read_runs(&report)?);
        memory.plain.extend(target::read_memory(&report)?);
        memory.painted.extend(target::read_stacks(&report)?);
        static_memory(name)?;
        said = said + "\n" + &output.err;
        success &= output.success;
    }
    if runs.len() != host.len() {
        let (of, all) = (runs.len(), host.len());
        return Err(format!("the target ran {of} of {all} cases{said}"));
    }
    let mut different = 0;
    for (ours, theirs) in host.iter().zip(&runs) {
        match difference(ours, theirs) {
            None => eprintln!(
                "   {:<16} {} × {:<3} {:>7} ticks {:>5} blocks  {:016x}  same",
                ours.name, ours.axes, ours.blocks, theirs.ticks, theirs.blocks, theirs.digest
            ),
            Some(what) => {
                different += 1;
                eprintln!("   {:<16} {} × {:<3} DIFFERS: {what}", ours.name, ours.axes, ours.blocks);
            }
        }
    }
    if different > 0 {
        return Err(format!("{different} of {} programs differ between host and target", host.len()));
    }
    if !success {
        return Err(format!("{} ended with an error", SAME.join(" or ")));
    }
    let reference = binary("nopanic")?;
    memory.flash = elf::flash(&reference).ok_or("nopanic: no load segments")?;
    memory.modules = elf::by_module(&reference).ok_or("nopanic: no symbols")?;
    for (axes, name, calls) in BOUND {
        let read = Calls::read(&binary(name)?).map_err(|e| format!("{name}: {e}"))?;
        for (call, function) in calls {
            let depth = read.depth(function).map_err(|e| format!("{name}: {e}"))?;
            memory.bounds.insert(format!("{call}_{axes}_axes"), depth);
        }
    }
    Ok((runs, memory))
}

/// Checks that the session equals the PC's, and that text over a serial line makes no difference.
fn sessions(report: &str) -> Result<(), String> {
    let host = host::sessions()?;
    alike(&host, &target::read_runs(report)?)?;
    if host.iter().any(|run| run.outcome != host[0].outcome) {
        return Err("text over a line led to other set points than text in memory".into());
    }
    Ok(())
}

/// Checks that the cases with filters and overlays equal the PC's, and returns their cost.
fn beside(report: &str) -> Result<Beside, String> {
    let runs = target::read_runs(report)?;
    alike(&host::beside_all()?, &runs)?;
    static_memory("beside")?;
    Beside::of(&runs, target::read_beside(report)?)
}

/// Checks that the cases with commands equal the PC's, with every schedule, and returns the most expensive
/// planner call of each.
fn commands(firmware: &Firmware) -> Result<BTreeMap<String, Commanded>, String> {
    let mut runs = Vec::new();
    for name in COMMANDS {
        runs.extend(target::read_runs(&firmware.report(name)?)?);
    }
    alike(&host::commanded_all()?, &runs)?;
    let mut worst = BTreeMap::<String, Commanded>::new();
    let mut seeds = BTreeMap::<String, u64>::new();
    for run in runs {
        let seed = seeds.entry(run.name.clone()).or_default();
        let worst = worst.entry(run.name).or_default();
        let poll = run.plan.max.max(run.wait.max);
        if poll > worst.poll {
            (worst.poll, worst.seed) = (poll, *seed);
        }
        worst.wait = worst.wait.max(run.wait.max);
        *seed += 1;
    }
    Ok(worst)
}

/// Checks the build with few functions and for size: programs have the set points of the PC with the same
/// functions, those without corner curves also the set points of the full PC build, and no panicking code is
/// left. Returns the cost.
fn slim(firmware: &Firmware) -> Result<BTreeMap<String, u64>, String> {
    firmware.build_small(TESTS, SLIM_FUNCTIONS, &[&SLIM[..], &["nopanic"]].concat())?;
    let (mut runs, mut figures) = (Vec::new(), BTreeMap::new());
    for name in SLIM {
        let report = firmware.report_small(name)?;
        runs.extend(target::read_runs(&report)?);
        for row in target::read_memory(&report)? {
            let mut set = |part: &str, bytes: u64| {
                figures.insert(format!("slim.ram_{part}_{}x{}", row.axes, row.blocks), bytes);
            };
            set("channel", row.channel);
            set("stack", row.depth);
            set("total", row.channel + row.depth);
        }
    }
    if let [Some(few), Some(many)] = [30, 120].map(|n| figures.get(&format!("slim.ram_channel_3x{n}"))) {
        figures.insert("slim.ram_bytes_per_block".into(), (many - few).div_ceil(90));
    }
    alike_small(&host::slim()?, &runs)?;
    let full: Vec<HostRun> = host::slim_all()?.into_iter().filter(|run| !is_contour(run.name)).collect();
    let curveless: Vec<&TargetRun> = runs.iter().filter(|run| !is_contour(&run.name)).collect();
    alike(&full, &curveless)?;
    let plain = |run: &&TargetRun| !is_contour(&run.name);
    let most = |runs: &mut dyn Iterator<Item = &TargetRun>| runs.map(|run| run.tick.max).max().unwrap_or(0);
    figures.insert("slim.tick_max".into(), most(&mut runs.iter()));
    figures.insert("slim.tick_max_plain".into(), most(&mut runs.iter().filter(plain)));
    let long: Vec<&TargetRun> = runs.iter().filter(|run| run.look_ahead == hil_cases::BLOCKS).collect();
    let [blocks, plan]: [u64; 2] =
        [long.iter().map(|run| run.blocks).sum(), long.iter().map(|run| run.plan.sum - run.decode.sum).sum()];
    figures.insert("slim.block_mean".into(), plan.div_ceil(blocks.max(1)));
    let file = small("nopanic");
    let nopanic = std::fs::read(&file).map_err(|e| format!("{}: {e}", file.display()))?;
    figures.insert("slim.flash".into(), elf::flash(&nopanic).ok_or("nopanic: no load segments")?);
    let calls = Calls::read(&nopanic).map_err(|e| format!("nopanic: {e}"))?;
    for (call, function) in NOPANIC_CALLS {
        let depth = calls.depth(function).map_err(|e| format!("nopanic: {e}"))?;
        figures.insert(format!("slim.stack_bound_{call}"), depth.bytes.into());
    }
    Ok(figures)
}

/// Whether a case has corner curves. The length of the look-ahead over curves depends on the build.
fn is_contour(name: &str) -> bool {
    figures::CONTOUR.contains(&name)
}

/// Checks that ticks, blocks and digests equal those of the PC.
fn alike_small(host: &str, target: &[TargetRun]) -> Result<(), String> {
    let lines: Vec<&str> = host.lines().collect();
    if lines.len() != target.len() || lines.is_empty() {
        return Err(format!("the target ran {} of {} cases", target.len(), lines.len()));
    }
    for (line, run) in lines.into_iter().zip(target) {
        let (name, rest) = line.split_once(' ').ok_or(line)?;
        let values = target::fields(rest);
        let value = |key| target::number(&values, key, line);
        let ours = [value("look_ahead")?, value("ticks")?, value("blocks")?, target::digest(&values, line)?];
        let theirs = [run.look_ahead as u64, run.ticks, run.blocks, run.digest];
        if name != run.name || ours != theirs || run.starved != 0 || run.failed.is_some() {
            return Err(format!("{name} DIFFERS: host {line}; target {} {theirs:x?}", run.name));
        }
        eprintln!("   {name:<16} {:>7} ticks  {:016x}  as on the host built alike", run.ticks, run.digest);
    }
    Ok(())
}

/// Checks that every set point of every tick equals that of the PC.
fn alike<T: std::borrow::Borrow<TargetRun>>(host: &[HostRun], target: &[T]) -> Result<(), String> {
    if host.len() != target.len() {
        return Err(format!("the target ran {} of {} cases", target.len(), host.len()));
    }
    for (ours, theirs) in host.iter().zip(target.iter().map(T::borrow)) {
        if let Some(what) = difference(ours, theirs) {
            return Err(format!("{} DIFFERS: {what}", ours.name));
        }
        eprintln!("   {:<16} {:>7} ticks  {:016x}  same", ours.name, theirs.ticks, theirs.digest);
    }
    Ok(())
}

/// Checks that the channel takes no flash: almost no bytes are copied from flash at the start.
fn static_memory(name: &str) -> Result<(), String> {
    let copied = elf::copied(&binary(name)?).ok_or_else(|| format!("{name}: no load segments"))?;
    if copied > COPIED {
        return Err(format!(
            "{name}: {copied} bytes of static memory are copied from flash, more than {COPIED}"
        ));
    }
    Ok(())
}

/// Checks that the emulator counts instructions exactly.
fn counter(report: &str) -> Result<(), String> {
    let mut lines = 0;
    for line in report.lines().filter(|line| line.starts_with("nops ")) {
        let row = target::fields(line);
        let [nops, counted] = ["nops", "counted"].map(|key| target::number(&row, key, line));
        if nops? != counted? && !report.starts_with("unit cycles") {
            return Err(format!("the emulator does not count instructions exactly: {line}"));
        }
        lines += 1;
    }
    if lines == 0 { Err("nothing was counted".into()) } else { Ok(()) }
}

/// Checks that a stack overflow ends in a fault with a message.
fn overflow(firmware: &Firmware) -> Result<(), String> {
    let output = firmware.run("overflow")?;
    let said = String::from_utf8_lossy(&output.out);
    eprintln!("   {}", said.trim());
    if output.success || !said.contains("stack overflow") {
        return Err(format!("overflow did not end with its fault: {said} {}", output.err));
    }
    Ok(())
}

/// Differences, with the first differing tick.
fn difference(host: &HostRun, target: &TargetRun) -> Option<String> {
    if (host.name, host.axes, host.blocks) != (target.name.as_str(), target.axes, target.look_ahead) {
        return Some(format!(
            "the target ran {} with {} axes and {} blocks",
            target.name, target.axes, target.look_ahead
        ));
    }
    let ticks = |run: &[i64]| run.len() / host.axes;
    let mut pairs = host.set_points.chunks(host.axes).zip(target.set_points.chunks(host.axes));
    if let Some(tick) = pairs.position(|(ours, theirs)| ours != theirs) {
        let line = |who: &str, points: &[i64], tick: usize| {
            let points = points.get(tick * host.axes..(tick + 1) * host.axes).unwrap_or_default();
            let bits: Vec<String> = points.iter().map(|bits| format!("{bits:#018x}")).collect();
            format!("\n      tick {tick:>6} {who:<6} {}", bits.join(" "))
        };
        let mut text = format!("first at tick {tick}");
        for tick in tick.saturating_sub(1)..=tick {
            text += &line("host", &host.set_points, tick);
            text += &line("target", &target.set_points, tick);
        }
        return Some(text);
    }
    if let Some(failed) = &target.failed {
        return Some(format!("{failed} after {} equal ticks", ticks(&target.set_points)));
    }
    let ours = &host.outcome;
    let ours = [u64::from(ours.ticks), u64::from(ours.blocks), u64::from(ours.starved), ours.digest.value()];
    let theirs = [target.ticks, target.blocks, target.starved, target.digest];
    if ours != theirs || ticks(&host.set_points) != ticks(&target.set_points) {
        let common = ticks(&host.set_points).min(ticks(&target.set_points));
        return Some(format!(
            "{common} equal ticks, then only one of them goes on; ticks, blocks, starved, digest: host {ours:x?}, \
             target {theirs:x?}"
        ));
    }
    if target.ticks == 0 || target.starved != 0 && host.name != RESTS {
        return Some(format!("{} ticks, starved for {}", target.ticks, target.starved));
    }
    None
}

/// Checks the digests of the interrupt test, and that the test did its work.
fn interrupt(report: &str, host: &[HostRun]) -> Result<(), String> {
    let mut preempted = 0;
    let mut lines = 0;
    for line in report.lines().filter(|line| !line.starts_with("memory ") && !line.starts_with("late ")) {
        let Some(line) = line.strip_prefix("interrupt ") else { return Err(format!("interrupt: {line}")) };
        let (name, rest) = line.split_once(' ').ok_or(line)?;
        let values = target::fields(rest);
        let value = |key| target::number(&values, key, line);
        let (digest, ticks) = (target::digest(&values, line)?, value("ticks")?);
        let host = host.iter().find(|run| run.name == name).ok_or(line)?;
        eprintln!("   {line}");
        if digest != host.outcome.digest.value() || ticks != u64::from(host.outcome.ticks) {
            return Err(format!(
                "{name} in the interrupt: host {} ticks, digest {:016x}",
                host.outcome.ticks,
                host.outcome.digest.value()
            ));
        }
        if value("missed")? != 0 || value("starved")? != 0 {
            return Err(format!("{name}: ticks missed or starved"));
        }
        preempted += value("preempted")?;
        lines += 1;
    }
    if lines == 0 || preempted == 0 {
        return Err("no interrupt came while the planner worked: the test shows nothing".into());
    }
    Ok(())
}

/// Checks a planner that is always late: the firmware has checked the accelerations, and the end equals that
/// of the PC.
fn late(report: &str, host: &[HostRun]) -> Result<(), String> {
    let (mut runs, mut late) = (0, 0);
    for line in report.lines().filter_map(|line| line.strip_prefix("late ")) {
        let (name, rest) = line.split_once(' ').ok_or(line)?;
        let values = target::fields(rest);
        let value = |key| target::number(&values, key, line);
        let end = [value("end_x")?, value("end_y")?, value("end_z")?].map(|bits| bits as i64);
        let host = host.iter().find(|run| run.name == name && run.axes == 3).ok_or(line)?;
        if !host.set_points.ends_with(&end) {
            return Err(format!("{name} with a planner that is late: {line}"));
        }
        (runs, late) = (runs + 1, late + value("late")?);
    }
    eprintln!("   {runs} runs with a planner that was late {late} times");
    if runs == 0 || late < 10 * runs {
        return Err("the planner was hardly ever late: the test shows nothing".into());
    }
    Ok(())
}

/// Checks the digests of some programs on other cores.
fn cores(firmware: &Firmware, host: &[HostRun]) -> Result<(), String> {
    for core in &CORES {
        let Some(report) = firmware.elsewhere(core, TESTS, "core")? else { continue };
        let mut same = 0;
        for line in report.lines().filter_map(|line| line.strip_prefix("core ")) {
            let (name, rest) = line.split_once(' ').ok_or(line)?;
            let values = target::fields(rest);
            let (digest, ticks) = (target::digest(&values, line)?, target::number(&values, "ticks", line)?);
            let is_it = |run: &&HostRun| (run.name, run.axes, run.blocks) == (name, 3, hil_cases::SHORT);
            let ours = host.iter().find(is_it).ok_or(line)?.outcome;
            if (digest, ticks) != (ours.digest.value(), u64::from(ours.ticks)) {
                return Err(format!(
                    "{}: {line}; host: {} ticks, digest {:016x}",
                    core.name,
                    ours.ticks,
                    ours.digest.value()
                ));
            }
            same += 1;
        }
        if same < OTHER_CORES {
            return Err(format!("{}: {same} programs ran, expected {OTHER_CORES} at least", core.name));
        }
        eprintln!("   {}: {same} programs, digests as on the host", core.name);
    }
    Ok(())
}

/// Runs the board's firmware in the emulator, with some programs.
fn board(firmware: &Firmware, host: &[HostRun]) -> Result<(), String> {
    for name in BOARD_PROGRAMS {
        let program = format!("programs/{name}.nc");
        let variables = [("PROGRAM", program.as_str()), ("DEFMT_LOG", "info")];
        firmware.build(BOARD, &["--features", "qemu"], &variables)?;
        let output = firmware.run(BOARD_BINARY)?;
        let values = target::fields(&output.err);
        let digest = target::digest(&values, &output.err)?;
        let host = host.iter().find(|run| run.name == name).ok_or(name)?;
        eprintln!("   {name}: {}, {} bytes of defmt messages", output.err.trim(), output.out.len());
        let good = digest == host.outcome.digest.value()
            && target::number(&values, "starved", &output.err)? == 0
            && target::number(&values, "missed", &output.err)? == 0;
        let longest = target::number(&values, "longest", &output.err)?;
        if longest > INTERRUPT {
            return Err(format!(
                "{program} on the board: an interrupt of {longest} instructions, limit {INTERRUPT}"
            ));
        }
        static_memory(BOARD_BINARY)?;
        if !good || !output.success {
            return Err(format!("{program} on the board: host {:016x}", host.outcome.digest.value()));
        }
    }
    Ok(())
}

/// Checks that firmware in release form links with a panic handler that cannot be linked, and contains no
/// symbol of the panic machinery. Checks that it does not link with one added unchecked index.
fn no_panic(firmware: &Firmware) -> Result<(), String> {
    let refusal = firmware.build_fails(TESTS, &["--bin", "nopanic", "--features", "bad"])?;
    if !refusal.contains("panic-never") {
        return Err(format!(
            "nopanic with an unchecked index failed to build, but not by panic-never:\n{refusal}"
        ));
    }
    eprintln!("   an unchecked index is refused by the linker");
    if let Err(error) = firmware.build(TESTS, &["--bin", "nopanic"], &[]) {
        firmware.build(TESTS, &["--bin", "nopanic", "--features", "locate"], &[])?;
        let places = elf::panic_locations(&binary("nopanic")?).join("\n   ");
        return Err(format!("{error}\nplaces that can panic, standard library's own included:\n   {places}"));
    }
    panic_symbols("nopanic")?;
    for features in ["", "hardware"] {
        firmware.build(BOARD, &["--features", features], &[])?;
        panic_symbols(BOARD_BINARY)?;
    }
    Ok(())
}

fn binary(name: &str) -> Result<Vec<u8>, String> {
    let file = artifact(name);
    std::fs::read(&file).map_err(|e| format!("{}: {e}", file.display()))
}

fn panic_symbols(name: &str) -> Result<(), String> {
    let file = artifact(name);
    let bytes = binary(name)?;
    let symbols = elf::symbols(&bytes).ok_or_else(|| format!("{}: no symbol table", file.display()))?;
    let panics = |symbol: &&String| {
        symbol.contains("9panicking") || symbol.contains("rust_begin_unwind") || symbol.contains("panic_fmt")
    };
    let found: Vec<&String> = symbols.iter().filter(panics).collect();
    eprintln!("   {name}: {} symbols, {} of them of the panic machinery", symbols.len(), found.len());
    let relative = file.strip_prefix(shell::root()).unwrap_or(&file);
    if found.is_empty() && !symbols.is_empty() {
        return Ok(());
    }
    Err(format!("{} holds {found:?}", relative.display()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glidepath::digest::Digest;
    use hil_cases::Outcome;

    fn pair() -> (HostRun, TargetRun) {
        let mut digest = Digest::new();
        digest.add(&[]);
        let outcome = Outcome { ticks: 3, starved: 0, blocks: 1, digest };
        let host = HostRun { name: "a", axes: 2, blocks: 9, set_points: vec![1, 2, 3, -4, 5, 6], outcome };
        let report = format!(
            "unit instructions\ncase a axes 2 blocks 9\ns {:016x}{:016x}\ns {:016x}{:016x}\ns {:016x}{:016x}\n\
             cost tick calls 3 sum 30 max 11\nend ticks 3 starved 0 blocks 1 digest {:016x}\n",
            1,
            2,
            3,
            -4i64,
            5,
            6,
            digest.value()
        );
        let mut runs = target::read_runs(&report).unwrap_or_default();
        (host, runs.pop().unwrap_or_default())
    }

    #[test]
    fn equal_runs_are_equal() {
        let (host, target) = pair();
        assert_eq!(target.set_points, host.set_points);
        assert_eq!(difference(&host, &target), None);
    }

    #[test]
    fn the_first_differing_tick_is_named_with_both_sides() {
        let (host, mut target) = pair();
        target.set_points[3] += 1;
        target.set_points[4] += 1;
        let text = difference(&host, &target).unwrap_or_default();
        assert!(text.starts_with("first at tick 1\n"), "{text}");
        assert!(text.contains("0xfffffffffffffffc") && text.contains("0xfffffffffffffffd"), "{text}");
    }

    #[test]
    fn a_run_that_ends_early_or_has_another_digest_differs() {
        let (host, mut target) = pair();
        target.set_points.truncate(4);
        assert!(difference(&host, &target).is_some_and(|text| text.starts_with("2 equal ticks")));
        let (host, mut target) = pair();
        target.digest ^= 1;
        assert!(difference(&host, &target).is_some());
    }

    #[test]
    fn an_interrupt_test_without_preemption_shows_nothing() {
        let (host, target) = pair();
        let line = |preempted| {
            let digest = target.digest;
            format!(
                "interrupt a period_us 9 ticks 3 starved 0 missed 0 preempted {preempted} digest {digest:016x}"
            )
        };
        assert_eq!(interrupt(&line(1), &[pair().0]), Ok(()));
        assert!(interrupt(&line(0), &[host]).is_err());
    }
}

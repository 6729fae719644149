//! Instruction counts and bytes: measured, compared with the accepted figures and the hard limits, and
//! written to files.
use crate::controller;
use crate::document::{self, reached};
use crate::shell::root;
use crate::stack::Depth;
use crate::target::{Memory, Stacks, TargetRun};
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::PathBuf;

/// Hard limits of the project, also for accepted figures: key, highest value.
pub(crate) const LIMITS: [(&str, u64); 50] = [
    ("total.block_mean_plain_3_axes", 7850),
    ("total.block_mean_3_axes", 13_100),
    ("case.surface.block_mean", 20_000),
    ("case.splines.block_mean", 60_000),
    ("case.cam_dev.block_mean", 36_100),
    ("case.corners.block_mean", 40_600),
    ("case.contour.block_mean", 85_100),
    ("total.block_mean_contour_3_axes", 38_000),
    ("total.block_mean_contour_4_axes", 29_400),
    ("total.block_mean_contour_6_axes", 82_000),
    ("total.tick_max_plain_3_axes", 425),
    ("total.tick_max_plain_6_axes", 650),
    ("total.tick_max_3_axes", 520),
    ("total.tick_max_4_axes", 650),
    ("total.tick_max_6_axes", 800),
    ("total.poll_max_3_axes", 40_000),
    ("total.poll_max_4_axes", 40_000),
    ("total.poll_max_6_axes", 36_000),
    ("command.poll_max", 90_000),
    ("command.wait_max", 3000),
    ("case.hsc.block_mean", 8000),
    ("case.micro.block_mean", 8000),
    ("case.short_arcs.block_mean", 10_260),
    ("total.block_mean_hsc", 8000),
    ("case.plain.decode_mean", 2500),
    ("case.cam.decode_mean", 2500),
    ("dialect.isg.decode_mean", 2500),
    ("dialect.linuxcnc.decode_mean", 2500),
    ("dialect.grbl.decode_mean", 2500),
    ("dialect.fanuc.decode_mean", 2500),
    ("flash.reference", 506 * 1024),
    ("slim.flash", 252 * 1024),
    ("slim.ram_total_3x30", 30 * 1024 + 128),
    ("slim.ram_total_3x120", 44 * 1024),
    ("slim.ram_bytes_per_block", 136),
    ("slim.stack_bound_start", 4352),
    ("slim.stack_bound_poll", 4128),
    ("slim.stack_bound_interrupt", 1024),
    ("stack.bound_tick_3_axes", 1024),
    ("stack.bound_tick_6_axes", 1024),
    ("stack.bound_interrupt_3_axes", 1024),
    ("stack.bound_start_3_axes", 2048),
    ("stack.bound_poll_3_axes", 4096),
    ("stack.bound_poll_6_axes", 4096),
    ("beside.tick_32_taps", 160),
    ("beside.tick_moving_average", 40),
    ("beside.tick_oscillating_axis", 120),
    ("beside.bytes_per_tap", 10),
    ("beside.bytes_per_overlay", 3584),
    ("controller.interrupt_max", controller::INTERRUPT),
];

/// Bytes of stack that must stay unused.
pub(crate) const STACK_FREE: u64 = 8192;

/// Bytes of RAM of the reference target.
pub(crate) const RAM: u64 = 128 * 1024;

/// Goals that are not reached yet. Every run prints them, and the accepted table prevents worse values.
pub(crate) const GOALS: [(&str, u64); 6] = [
    ("case.hsc_opt.block_mean", 8000),
    ("total.block_mean_plain_3_axes", 6000),
    ("case.short_arcs.block_mean", 8000),
    ("command.wait_max", 3000),
    ("ram.bytes_per_block_3_axes", 160),
    ("flash.reference", 256 * 1024),
];

/// Programs in contour mode, with curves in corners.
pub(crate) const CONTOUR: [&str; 5] = ["contour", "corners", "cam_dev", "rotary_corners", "six_corners"];

/// Programs without contour mode, with several arcs in a tick.
pub(crate) const SHORT_ARCS: [&str; 1] = ["short_arcs"];

/// Programs without contour mode, with other slopes than TRAPEZ. *Plain* programs are in none of these four
/// lists.
pub(crate) const SLOPES: [&str; 5] = ["step", "sin2", "hsc", "hsc_opt", "micro"];

/// Programs with curves over many blocks.
pub(crate) const SMOOTHED: [&str; 4] = ["surface", "rows", "splines", "six_surface"];

/// Blocks of look-ahead with which instructions are counted.
const LOOK_AHEAD: usize = hil_cases::BLOCKS;

/// Programs with HSC and without corner curves: the mean over all of them is a figure too.
pub(crate) const HSC: [&str; 4] = ["hsc", "hsc_opt", "micro", "short_arcs"];

/// Figures that describe the measurement, not the quality.
const DESCRIPTIVE: [&str; 4] = ["ticks", "blocks", "schedule", "stack_size"];

/// Figures that depend on the arrival of a sender's bytes, and do not repeat exactly; only their limit
/// counts.
const ARRIVING: [&str; 1] = ["controller.interrupt_max"];

/// Bytes of flash of a module, a part of the sum. A change may move code between modules.
pub(crate) const FLASH_OF: &str = "flash_of.";

/// Bytes of flash by which builds of the same sources may differ. The folder of the checkout influences the
/// order of sections, and so the gaps between them.
const GAPS: u64 = 64;

/// First line of the accepted table.
const TITLE: &str = "Accepted figures of the STM32F405 target: instructions and bytes. Written by `cargo xtask bench --accept`.";

/// With the compiler of the accepted table counts repeat exactly; another compiler may differ by this, in
/// percent.
const OTHER_COMPILER_PERCENT: u64 = 10;

/// The most expensive planner calls of a program with continuous commands of the operator; instructions.
#[derive(Clone, Copy, Debug, Default)]
pub struct Commanded {
    /// The most expensive call, and the schedule of commands of this call.
    pub poll: u64,
    pub seed: u64,
    /// The most expensive call that waited.
    pub wait: u64,
}

/// Memory of the target.
#[derive(Debug, Default)]
pub struct MemoryFigures {
    /// Planner and tick in one loop, each configuration.
    pub plain: Vec<Memory>,
    /// The tick in an interrupt.
    pub interrupted: Vec<Memory>,
    /// For each kind of call and each configuration: used bytes of a painted stack.
    pub painted: Vec<Stacks>,
    /// The same from the machine code, by call and axes.
    pub bounds: BTreeMap<String, Depth>,
    /// Bytes of flash of decoder, planner and tick for three axes.
    pub flash: u64,
    /// Bytes of flash by module.
    pub modules: BTreeMap<String, u64>,
    /// Filters and overlays.
    pub beside: Beside,
    /// The build with lines, arcs and contour mode only: `slim.` and the name of a figure.
    pub slim: BTreeMap<String, u64>,
    /// The most expensive planner calls by program, with continuous commands of the operator.
    pub commands: BTreeMap<String, Commanded>,
    /// The longest interrupt of the controller's firmware, instructions.
    pub controller: u64,
    /// Instructions of the decoder in each dialect, flash and RAM of builds with them.
    pub dialects: BTreeMap<String, u64>,
}

/// Cost of filters and of independent axes: instructions per tick and axis in addition to the same path
/// without them, rounded up, and bytes.
#[derive(Clone, Copy, Debug, Default)]
pub struct Beside {
    taps: u64,
    average: u64,
    oscillation: u64,
    /// The most expensive planner call, including switched filters and started axes, and that of the split.
    largest: [u64; 2],
    bytes: [u64; 2],
}

impl Beside {
    /// Computes the cost from the runs of `beside`; the first run has the path only.
    pub fn of(runs: &[TargetRun], bytes: [u64; 2]) -> Result<Self, String> {
        let [nothing, taps, average, oscillation, ..] = runs else {
            return Err(format!("{} runs with filters and overlays", runs.len()));
        };
        let mean = |run: &TargetRun| run.tick.sum as f64 / run.tick.calls.max(1) as f64;
        let more = |run: &TargetRun, axes: f64| ((mean(run) - mean(nothing)) / axes).ceil().max(0.0) as u64;
        let (taps, average, oscillation) = (more(taps, 3.0), more(average, 3.0), more(oscillation, 1.0));
        let largest = |of: fn(&TargetRun) -> u64| runs.iter().map(of).max().unwrap_or(0);
        let largest = [largest(|run| run.plan.max), largest(|run| run.start.max)];
        Ok(Self { taps, average, oscillation, largest, bytes })
    }

    /// Every figure.
    pub fn each(&self, mut show: impl FnMut(&str, u64)) {
        let ([tap, overlay], [poll, start]) = (self.bytes, self.largest);
        for (key, value) in [
            ("beside.tick_32_taps", self.taps),
            ("beside.tick_moving_average", self.average),
            ("beside.tick_oscillating_axis", self.oscillation),
            ("beside.poll_max", poll),
            ("beside.start_max", start),
            ("beside.bytes_per_tap", tap),
            ("beside.bytes_per_overlay", overlay),
        ] {
            show(key, value);
        }
    }
}

/// All figures, named `section.key`.
pub struct Figures {
    pub(crate) compiler: String,
    pub(crate) values: BTreeMap<String, u64>,
}

impl Figures {
    /// Report of the target.
    pub fn measured(compiler: &str, runs: &[TargetRun], memory: &MemoryFigures) -> Result<Self, String> {
        let mut values = BTreeMap::new();
        let counted = || runs.iter().filter(|run| run.look_ahead == LOOK_AHEAD);
        for run in counted() {
            let mut set = |key: &str, value: u64| values.insert(format!("case.{}.{key}", run.name), value);
            set("ticks", run.ticks);
            set("blocks", run.blocks);
            set("tick_max", run.tick.max);
            set("tick_mean", run.tick.sum.div_ceil(run.tick.calls.max(1)));
            set("block_mean", planning(run).div_ceil(run.blocks.max(1)));
            set("decode_mean", run.decode.sum.div_ceil(run.blocks.max(1)));
            set("poll_max", run.plan.max);
            set("wait_max", run.wait.max);
        }
        for axes in [3, 4, 6] {
            let all = || counted().filter(move |run| run.axes == axes);
            let is = |names: &[&str], run: &TargetRun| names.contains(&run.name.as_str());
            let contour = || all().filter(|run| is(&CONTOUR, run));
            let others = || all().filter(|run| !is(&CONTOUR, run) && !is(&SMOOTHED, run));
            let plain = || others().filter(|run| !is(&SLOPES, run) && !is(&SHORT_ARCS, run));
            let mut set = |key: &str, value: u64| values.insert(format!("total.{key}_{axes}_axes"), value);
            set("tick_max", all().map(|run| run.tick.max).max().unwrap_or(0));
            set("tick_max_plain", others().map(|run| run.tick.max).max().unwrap_or(0));
            let ticks = |of: fn(&TargetRun) -> u64| all().map(of).sum::<u64>();
            set("tick_mean", ticks(|run| run.tick.sum).div_ceil(ticks(|run| run.tick.calls).max(1)));
            set("block_mean", per_block(all(), planning));
            set("block_mean_plain", per_block(plain(), planning));
            set("block_mean_contour", per_block(contour(), planning));
            set("decode_mean", per_block(all(), |run| run.decode.sum));
            set("poll_max", all().map(|run| run.plan.max).max().unwrap_or(0));
            set("start_max", all().map(|run| run.start.max).max().unwrap_or(0));
        }
        let hsc = counted().filter(|run| HSC.contains(&run.name.as_str()));
        values.insert("total.block_mean_hsc".into(), per_block(hsc, planning));
        add_memory(&mut values, memory)?;
        Ok(Self { compiler: compiler.into(), values })
    }

    /// Returns the figures as text for people.
    pub fn table(&self) -> String {
        let mut text = String::new();
        for (key, value) in &self.values {
            let _ = writeln!(text, "   {key:<36} {value:>9}");
        }
        text
    }

    fn accepted() -> Result<Self, String> {
        let file = accepted_file();
        let text = std::fs::read_to_string(&file)
            .map_err(|e| format!("{}: {e}; `cargo xtask bench --accept` writes it", file.display()))?;
        Self::from_toml(&text).map_err(|line| format!("{}: {line}", file.display()))
    }

    /// Reads the text of [`Self::to_toml`]. The error is the first line with another form.
    pub(crate) fn from_toml(text: &str) -> Result<Self, String> {
        let mut figures = Self { compiler: String::new(), values: BTreeMap::new() };
        let mut section = "";
        for line in text.lines().map(str::trim).filter(|line| !line.is_empty() && !line.starts_with('#')) {
            if let Some(name) = line.strip_prefix('[').and_then(|line| line.strip_suffix(']')) {
                section = name;
            } else if let Some((key, value)) = line.split_once(" = ") {
                match value.parse() {
                    Ok(number) => {
                        figures.values.insert(format!("{section}.{key}"), number);
                    }
                    Err(_) if key == "compiler" => figures.compiler = value.trim_matches('"').into(),
                    Err(_) => return Err(line.into()),
                }
            } else {
                return Err(line.into());
            }
        }
        Ok(figures)
    }

    pub(crate) fn to_toml(&self, title: &str) -> String {
        let mut text = format!("# {title}\ncompiler = \"{}\"\n", self.compiler);
        let mut last = "";
        for (name, value) in &self.values {
            let (section, key) = name.rsplit_once('.').unwrap_or(("", name));
            if section != last {
                let _ = writeln!(text, "\n[{section}]");
                last = section;
            }
            let _ = writeln!(text, "{key} = {value}");
        }
        text
    }
}

/// Mean over all blocks of these programs.
fn per_block<'a>(runs: impl Iterator<Item = &'a TargetRun>, of: fn(&TargetRun) -> u64) -> u64 {
    let add = |(sum, blocks), run: &TargetRun| (sum + of(run), blocks + run.blocks);
    let (sum, blocks): (u64, u64) = runs.fold((0, 0), add);
    sum.div_ceil(blocks.max(1))
}

/// Instructions of the planner without the decoder.
fn planning(run: &TargetRun) -> u64 {
    run.plan.sum.saturating_sub(run.decode.sum)
}

fn add_memory(values: &mut BTreeMap<String, u64>, memory: &MemoryFigures) -> Result<(), String> {
    let mut channels = BTreeMap::new();
    for row in &memory.plain {
        // Three digits, so that rows are sorted.
        let mut set = |part: &str, bytes: u64| {
            values.insert(format!("ram.axes_{}_blocks_{:03}.{part}", row.axes, row.blocks), bytes)
        };
        set("channel", row.channel);
        set("planner", row.planner);
        set("interpolator", row.interpolator);
        set("stack", row.depth);
        set("total", row.channel + row.depth);
        values.insert("ram.stack_size".into(), row.stack);
        channels.insert((row.axes, row.blocks), row.channel);
    }
    memory.beside.each(|key, value| {
        values.insert(key.into(), value);
    });
    values.extend(memory.slim.iter().map(|(key, value)| (key.clone(), *value)));
    values.extend(memory.dialects.iter().map(|(key, value)| (key.clone(), *value)));
    for (name, worst) in &memory.commands {
        values.insert(format!("command.{name}.poll_max"), worst.poll);
        values.insert(format!("command.{name}.schedule"), worst.seed);
    }
    let most = |part: fn(&Commanded) -> u64| memory.commands.values().map(part).max();
    values.insert("command.poll_max".into(), most(|worst| worst.poll).ok_or("no commands were given")?);
    values.insert("command.wait_max".into(), most(|worst| worst.wait).ok_or("no commands were given")?);
    values.insert("controller.interrupt_max".into(), memory.controller);
    let deepest = memory.interrupted.iter().map(|row| row.depth).max().ok_or("no stack was measured")?;
    values.insert("ram.interrupted.stack".into(), deepest);
    values.insert("flash.reference".into(), memory.flash);
    for (module, &bytes) in &memory.modules {
        values.insert(format!("{FLASH_OF}{module}"), bytes);
    }
    for axes in [3, 6] {
        let of =
            |part: fn(&Stacks) -> u64| memory.painted.iter().filter(|row| row.axes == axes).map(part).max();
        for (call, deepest) in
            [("start", of(|row| row.start)), ("poll", of(|row| row.poll)), ("tick", of(|row| row.tick))]
        {
            let deepest = deepest.ok_or("the stack of a call was not measured")?;
            values.insert(format!("stack.{call}_{axes}_axes"), deepest);
        }
    }
    for (call, depth) in &memory.bounds {
        values.insert(format!("stack.bound_{call}"), depth.bytes.into());
    }
    for (axes, few, many) in [(3, 30, 190), (6, 30, 120)] {
        let channel = |blocks| channels.get(&(axes, blocks)).copied().ok_or("a configuration was not run");
        let per_block = (channel(many)? - channel(few)?) / (many - few);
        values.insert(format!("ram.bytes_per_block_{axes}_axes"), per_block);
    }
    Ok(())
}

/// Writes `measured` to the accepted table.
pub fn accept(measured: &Figures) -> Result<(), String> {
    let write = |file: PathBuf, text: String| {
        if let Some(folder) = file.parent() {
            std::fs::create_dir_all(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
        }
        eprintln!("   wrote {}", file.display());
        std::fs::write(&file, text).map_err(|e| format!("{}: {e}", file.display()))
    };
    write(accepted_file(), measured.to_toml(TITLE))?;
    write(document(), document::text(measured))?;
    limits(measured)
}

/// Fails if a figure is worse than accepted or beyond a hard limit, or if a document is out of date.
pub fn compare(measured: &Figures) -> Result<(), String> {
    let accepted = Figures::accepted()?;
    if measured.compiler != accepted.compiler {
        eprintln!(
            "   accepted with {}, now {}: {OTHER_COMPILER_PERCENT} % allowed",
            accepted.compiler, measured.compiler
        );
    }
    let (mut wrong, better) = differences(measured, &accepted);
    let document = document();
    if std::fs::read_to_string(&document).ok() != Some(document::text(&accepted)) {
        wrong.push(format!("{} is not what the accepted table says", document.display()));
    }
    if better > 0 {
        eprintln!("   {better} figures are better than accepted; `cargo xtask bench --accept` keeps them");
    }
    limits(measured)?;
    if wrong.is_empty() {
        eprintln!("   {} figures, none worse than accepted", measured.values.len());
        return Ok(());
    }
    Err(format!(
        "{} figures\n   {}\nIf that is meant: `cargo xtask bench --accept`, and the reason in the commit.",
        wrong.len(),
        wrong.join("\n   ")
    ))
}

/// Figures that are worse than accepted or not comparable, and the number of better figures.
pub(crate) fn differences(measured: &Figures, accepted: &Figures) -> (Vec<String>, usize) {
    let percent = if measured.compiler == accepted.compiler { 0 } else { OTHER_COMPILER_PERCENT };
    let mut wrong = Vec::new();
    let mut better = 0;
    for (key, &value) in &measured.values {
        let name = key.rsplit('.').next().unwrap_or(key);
        match accepted.values.get(key) {
            None if key.starts_with(FLASH_OF) => {}
            None => wrong.push(format!("{key} = {value} has no accepted value")),
            Some(_) if DESCRIPTIVE.contains(&name) || key.starts_with(FLASH_OF) => {}
            Some(_) if ARRIVING.contains(&key.as_str()) => {}
            Some(&limit) if value > limit + limit * percent / 100 + gaps(name) => {
                wrong.push(format!("{key} = {value}, accepted {limit}"));
            }
            Some(&limit) if value < limit => better += 1,
            Some(_) => {}
        }
    }
    let lost = |key: &&String| !key.starts_with(FLASH_OF) && !measured.values.contains_key(*key);
    for key in accepted.values.keys().filter(lost) {
        wrong.push(format!("{key} is accepted but was not measured"));
    }
    (wrong, better)
}

/// Permitted increase of a figure without a change of the sources.
fn gaps(name: &str) -> u64 {
    if name == "flash" || name == "reference" { GAPS } else { 0 }
}

fn limits(measured: &Figures) -> Result<(), String> {
    let mut beyond = Vec::new();
    for (key, goal) in GOALS {
        let value = measured.values.get(key).copied().ok_or_else(|| format!("{key} was not measured"))?;
        eprintln!("   {key:<32} {value:>6}   goal {goal}{}", reached(value, goal));
    }
    for (key, limit) in LIMITS {
        let value = measured.values.get(key).copied().ok_or_else(|| format!("{key} was not measured"))?;
        eprintln!("   {key:<32} {value:>6}   limit {limit}");
        if value > limit {
            beyond.push(format!("{key} = {value}, limit {limit}"));
        }
    }
    let stack = measured.values.get("ram.stack_size").copied().ok_or("no stack was measured")?;
    for (key, &depth) in measured.values.iter().filter(|(key, _)| key.ends_with(".stack")) {
        let free = stack.saturating_sub(depth);
        eprintln!("   {key:<32} {depth:>6}   free {free}, at least {STACK_FREE}");
        if free < STACK_FREE {
            beyond.push(format!("{key} = {depth} of {stack}, less than {STACK_FREE} free"));
        }
    }
    if beyond.is_empty() { Ok(()) } else { Err(format!("beyond a hard limit: {}", beyond.join("; "))) }
}

/// Checks those of `figures` that have a hard limit.
pub fn within_limits(figures: &BTreeMap<String, u64>) -> Result<(), String> {
    let is_beyond = |(key, limit): &(&str, u64)| figures.get(*key).is_some_and(|value| value > limit);
    match LIMITS.iter().find(|limit| is_beyond(limit)) {
        Some((key, limit)) => Err(format!("{key} is beyond its limit {limit}")),
        None => Ok(()),
    }
}

fn accepted_file() -> PathBuf {
    root().join("hil-tests/tables/accepted.toml")
}

fn document() -> PathBuf {
    root().join("docs/figures.md")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn figures(compiler: &str, values: &[(&str, u64)]) -> Figures {
        let values = values.iter().map(|&(key, value)| (key.to_owned(), value)).collect();
        Figures { compiler: compiler.into(), values }
    }

    #[test]
    fn one_instruction_more_is_worse() {
        let accepted = figures("rustc 1", &[("case.a.tick_max", 200), ("case.a.ticks", 10)]);
        let same = figures("rustc 1", &[("case.a.tick_max", 200), ("case.a.ticks", 11)]);
        assert_eq!(differences(&same, &accepted), (vec![], 0));
        let better = figures("rustc 1", &[("case.a.tick_max", 199), ("case.a.ticks", 10)]);
        assert_eq!(differences(&better, &accepted), (vec![], 1));
        let worse = figures("rustc 1", &[("case.a.tick_max", 201), ("case.a.ticks", 10)]);
        assert_eq!(differences(&worse, &accepted).0, ["case.a.tick_max = 201, accepted 200"]);
    }

    #[test]
    fn another_compiler_may_need_a_tenth_more() {
        let accepted = figures("rustc 1", &[("total.tick_max_3_axes", 200)]);
        let within = figures("rustc 2", &[("total.tick_max_3_axes", 220)]);
        assert_eq!(differences(&within, &accepted), (vec![], 0));
        let beyond = figures("rustc 2", &[("total.tick_max_3_axes", 221)]);
        assert_eq!(differences(&beyond, &accepted).0.len(), 1);
    }

    #[test]
    fn gaps_between_sections_are_no_change() {
        let accepted = figures("rustc 1", &[("slim.flash", 1000), ("flash.reference", 1000)]);
        let moved = figures("rustc 1", &[("slim.flash", 1064), ("flash.reference", 1064)]);
        assert_eq!(differences(&moved, &accepted).0.len(), 0);
        let grown = figures("rustc 1", &[("slim.flash", 1065), ("flash.reference", 1065)]);
        assert_eq!(differences(&grown, &accepted).0.len(), 2);
    }

    #[test]
    fn a_figure_missing_on_either_side_is_told() {
        let (one, none) = (figures("", &[("a.b", 1)]), figures("", &[]));
        assert_eq!(differences(&one, &none).0, ["a.b = 1 has no accepted value"]);
        assert_eq!(differences(&none, &one).0, ["a.b is accepted but was not measured"]);
    }

    #[test]
    fn the_table_is_read_as_it_is_written() {
        let written =
            figures("rustc 1 (x)", &[("case.a.ticks", 3), ("case.b.ticks", 4), ("size.axes_3.total", 5)]);
        let read = Figures::from_toml(&written.to_toml(TITLE));
        assert!(read.is_ok_and(|read| read.compiler == written.compiler && read.values == written.values));
        assert_eq!(Figures::from_toml("[case.a]\nticks = many").err().as_deref(), Some("ticks = many"));
    }

    #[test]
    fn hard_limits_hold_whatever_is_accepted() {
        let mut values: Vec<(&str, u64)> = [GOALS.as_slice(), LIMITS.as_slice()].concat();
        values.extend([("ram.stack_size", 20_000), ("ram.axes_3_blocks_120.stack", 20_000 - STACK_FREE)]);
        assert_eq!(limits(&figures("", &values)), Ok(()));
        assert!(limits(&figures("", &values[1..])).is_err());
        values[GOALS.len()].1 += 1;
        assert!(limits(&figures("", &values)).is_err());
        values[GOALS.len()].1 -= 1;
        if let Some(stack) = values.last_mut() {
            stack.1 += 1;
        }
        assert!(limits(&figures("", &values)).is_err());
    }
}

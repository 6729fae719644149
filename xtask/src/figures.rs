//! Instruction counts and bytes: measured, compared with the accepted ones and with the hard limits, written down.
use crate::shell::root;
use crate::target::{TargetRun, fields, number};
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::PathBuf;

/// Hard limits of the project, whatever is accepted: key, largest value.
const LIMITS: [(&str, u64); 15] = [
    ("total.block_mean_3_axes", 6000),
    ("total.tick_max_3_axes", 400),
    ("total.tick_max_6_axes", 650),
    ("total.poll_max_3_axes", 40_000),
    ("total.poll_max_4_axes", 40_000),
    ("total.poll_max_6_axes", 40_000),
    ("case.contour.tick_max", 600),
    ("case.corners.tick_max", 600),
    ("case.six_corners.tick_max", 1000),
    ("case.hsc.block_mean", 8000),
    ("case.micro.block_mean", 8000),
    ("case.short_arcs.block_mean", 8000),
    ("total.block_mean_hsc", 8000),
    ("case.plain.decode_mean", 2500),
    ("case.cam.decode_mean", 2500),
];

/// What is aimed at and not reached yet: said at every run; the accepted table keeps it from getting worse.
const GOALS: [(&str, u64); 2] = [("case.hsc_opt.block_mean", 8000), ("size.bytes_per_block_3_axes", 160)];

/// Programs with curves in corners: their ticks and plans have figures of their own.
const CURVES: [&str; 3] = ["contour", "corners", "six_corners"];

/// Programs with several arcs in a tick: their plans have figures of their own.
const SHORT_ARCS: [&str; 1] = ["short_arcs"];

/// Programs with other slopes than TRAPEZ: their plans have figures of their own.
const SLOPES: [&str; 5] = ["step", "sin2", "hsc", "hsc_opt", "micro"];

/// Programs that run with HSC, without curves in corners: their plans together have a figure too.
const HSC: [&str; 4] = ["hsc", "hsc_opt", "micro", "short_arcs"];

/// Figures that say what was measured, not how good it is.
const DESCRIPTIVE: [&str; 2] = ["ticks", "blocks"];

/// With the compiler of the accepted table counts repeat exactly; another one may differ by this, in percent.
const OTHER_COMPILER_PERCENT: u64 = 10;

/// All figures, named `section.key`.
pub struct Figures {
    compiler: String,
    values: BTreeMap<String, u64>,
}

impl Figures {
    /// What the target reported.
    pub fn measured(compiler: &str, runs: &[TargetRun], sizes: &str) -> Result<Self, String> {
        let mut values = BTreeMap::new();
        for run in runs {
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
            let runs = || runs.iter().filter(move |run| run.axes == axes);
            let ticks = || runs().filter(|run| !CURVES.contains(&run.name.as_str()));
            let own = |name: &str| SLOPES.contains(&name) || SHORT_ARCS.contains(&name);
            let plans = || ticks().filter(|run| !own(&run.name));
            let sum = |of: fn(&TargetRun) -> u64| ticks().map(of).sum::<u64>();
            let mut set = |key: &str, value: u64| values.insert(format!("total.{key}_{axes}_axes"), value);
            set("tick_max", ticks().map(|run| run.tick.max).max().unwrap_or(0));
            set("tick_mean", sum(|run| run.tick.sum).div_ceil(sum(|run| run.tick.calls).max(1)));
            set("block_mean", per_block(plans(), planning));
            set("decode_mean", per_block(plans(), |run| run.decode.sum));
            set("poll_max", runs().map(|run| run.plan.max).max().unwrap_or(0));
        }
        let hsc = runs.iter().filter(|run| HSC.contains(&run.name.as_str()));
        values.insert("total.block_mean_hsc".into(), per_block(hsc, planning));
        add_sizes(&mut values, sizes)?;
        Ok(Self { compiler: compiler.into(), values })
    }

    /// As text for people.
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

    /// What [`Self::to_toml`] writes; the line that is something else.
    fn from_toml(text: &str) -> Result<Self, String> {
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

    fn to_toml(&self) -> String {
        let mut text = format!(
            "# Accepted figures of the STM32F405 target: instructions and bytes. Written by `cargo xtask bench --accept`.\n\
             compiler = \"{}\"\n",
            self.compiler
        );
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

    fn to_markdown(&self) -> String {
        let get = |key: &str| self.values.get(key).copied().unwrap_or(0);
        let mut text = format!(
            "# Figures of the reference target\n\n\
             Generated by `cargo xtask bench --accept` from what `cargo xtask hil` measures and compares; do not edit.\n\n\
             Core: Cortex-M4F (STM32F405 as emulated by QEMU), `{}`, `opt-level = 3`, fat LTO, look-ahead 120 blocks.\n\
             Counted are executed **instructions**, not cycles: QEMU has no cycle model. Counts repeat exactly.\n\n\
             ## Limits\n\n| figure | measured | limit |\n|---|---:|---:|\n",
            self.compiler
        );
        for (key, limit) in LIMITS {
            let _ = writeln!(text, "| `{key}` | {} | {limit} |", get(key));
        }
        for (key, goal) in GOALS {
            let _ = writeln!(text, "| `{key}` | {} | goal {goal}{} |", get(key), reached(get(key), goal));
        }
        text += "\n## Instructions\n\n`tick` is one call of `Interpolator::tick`. `plan` is path, look-ahead and slope for \
                 one motion block: all calls of\n`Planner::poll` but those that find the queue full, without the decoder's share, \
                 divided by the blocks. `decode` is that share: the\ndecoder run alone over the same program, loops and expressions \
                 included, divided by the blocks. `poll` is one call of `Planner::poll`.\n\n\
                 | program | ticks | blocks | tick mean | tick max | plan mean | decode mean | poll max | poll, queue full |\n\
                 |---|---:|---:|---:|---:|---:|---:|---:|---:|\n";
        let cases = self.values.keys().filter_map(|key| key.strip_prefix("case.")?.strip_suffix(".ticks"));
        for case in cases {
            let _ = write!(text, "| {case} ");
            for key in [
                "ticks",
                "blocks",
                "tick_mean",
                "tick_max",
                "block_mean",
                "decode_mean",
                "poll_max",
                "wait_max",
            ] {
                let _ = write!(text, "| {} ", get(&format!("case.{case}.{key}")));
            }
            text += "|\n";
        }
        for axes in [3, 4, 6] {
            let total = |key: &str| get(&format!("total.{key}_{axes}_axes"));
            let _ = writeln!(
                text,
                "| **all, {axes} axes** | | | {} | {} | {} | {} | {} | |",
                total("tick_mean"),
                total("tick_max"),
                total("block_mean"),
                total("decode_mean"),
                total("poll_max")
            );
        }
        let _ = writeln!(text, "| **{}** | | | | | {} | | | |", HSC.join(", "), get("total.block_mean_hsc"));
        text += "\n## RAM\n\nBytes of static memory; everything a channel needs is in these three.\n\n\
                 | axes | blocks | `Channel` | `Planner` | `Interpolator` | total |\n|---:|---:|---:|---:|---:|---:|\n";
        for (axes, blocks) in [(3, 30), (3, 120), (3, 190), (6, 30), (6, 120), (6, 190)] {
            let part = |part: &str| get(&format!("size.axes_{axes}_blocks_{blocks}.{part}"));
            let _ = writeln!(
                text,
                "| {axes} | {blocks} | {} | {} | {} | {} |",
                part("channel"),
                part("planner"),
                part("interpolator"),
                part("total")
            );
        }
        let _ = writeln!(
            text,
            "\nPer block of look-ahead: {} bytes with 3 axes, {} with 6.",
            get("size.bytes_per_block_3_axes"),
            get("size.bytes_per_block_6_axes")
        );
        text
    }
}

/// The mean over all blocks of these programs.
fn per_block<'a>(runs: impl Iterator<Item = &'a TargetRun>, of: fn(&TargetRun) -> u64) -> u64 {
    let add = |(sum, blocks), run: &TargetRun| (sum + of(run), blocks + run.blocks);
    let (sum, blocks): (u64, u64) = runs.fold((0, 0), add);
    sum.div_ceil(blocks.max(1))
}

/// What the planner needs without the decoder's share.
fn planning(run: &TargetRun) -> u64 {
    run.plan.sum.saturating_sub(run.decode.sum)
}

fn add_sizes(values: &mut BTreeMap<String, u64>, report: &str) -> Result<(), String> {
    for line in report.lines().filter(|line| line.starts_with("nops ")) {
        let row = fields(line);
        if number(&row, "nops", line)? != number(&row, "counted", line)? && !report.starts_with("unit cycles")
        {
            return Err(format!("the emulator does not count instructions exactly: {line}"));
        }
    }
    let mut totals = BTreeMap::new();
    for line in report.lines().filter_map(|line| line.strip_prefix("size ")) {
        let row = fields(line);
        let (axes, blocks) = (number(&row, "axes", line)?, number(&row, "blocks", line)?);
        let mut total = 0;
        for part in ["channel", "planner", "interpolator"] {
            let bytes = number(&row, part, line)?;
            total += bytes;
            values.insert(format!("size.axes_{axes}_blocks_{blocks}.{part}"), bytes);
        }
        values.insert(format!("size.axes_{axes}_blocks_{blocks}.total"), total);
        totals.insert((axes, blocks), total);
    }
    for axes in [3, 6] {
        let total = |blocks| totals.get(&(axes, blocks)).copied().ok_or("a size is missing in the report");
        let per_block = (total(190)? - total(30)?).div_ceil(160);
        values.insert(format!("size.bytes_per_block_{axes}_axes"), per_block);
    }
    Ok(())
}

/// Writes `measured` down as accepted.
pub fn accept(measured: &Figures) -> Result<(), String> {
    let write = |file: PathBuf, text: String| {
        if let Some(folder) = file.parent() {
            std::fs::create_dir_all(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
        }
        eprintln!("   wrote {}", file.display());
        std::fs::write(&file, text).map_err(|e| format!("{}: {e}", file.display()))
    };
    write(accepted_file(), measured.to_toml())?;
    write(document(), measured.to_markdown())?;
    limits(measured)
}

/// Fails on a figure that is worse than accepted or beyond a hard limit, and on a document that is out of date.
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
    if std::fs::read_to_string(&document).ok() != Some(accepted.to_markdown()) {
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

/// What is worse than accepted or not comparable, and how many figures are better.
fn differences(measured: &Figures, accepted: &Figures) -> (Vec<String>, usize) {
    let percent = if measured.compiler == accepted.compiler { 0 } else { OTHER_COMPILER_PERCENT };
    let mut wrong = Vec::new();
    let mut better = 0;
    for (key, &value) in &measured.values {
        let name = key.rsplit('.').next().unwrap_or(key);
        match accepted.values.get(key) {
            None => wrong.push(format!("{key} = {value} has no accepted value")),
            Some(_) if DESCRIPTIVE.contains(&name) => {}
            Some(&limit) if value > limit + limit * percent / 100 => {
                wrong.push(format!("{key} = {value}, accepted {limit}"));
            }
            Some(&limit) if value < limit => better += 1,
            Some(_) => {}
        }
    }
    for key in accepted.values.keys().filter(|key| !measured.values.contains_key(*key)) {
        wrong.push(format!("{key} is accepted but was not measured"));
    }
    (wrong, better)
}

/// How to say whether a goal is reached.
fn reached(value: u64, goal: u64) -> &'static str {
    if value > goal { ", not reached" } else { "" }
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
    if beyond.is_empty() { Ok(()) } else { Err(format!("beyond a hard limit: {}", beyond.join("; "))) }
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
    fn a_figure_missing_on_either_side_is_told() {
        let (one, none) = (figures("", &[("a.b", 1)]), figures("", &[]));
        assert_eq!(differences(&one, &none).0, ["a.b = 1 has no accepted value"]);
        assert_eq!(differences(&none, &one).0, ["a.b is accepted but was not measured"]);
    }

    #[test]
    fn the_table_is_read_as_it_is_written() {
        let written =
            figures("rustc 1 (x)", &[("case.a.ticks", 3), ("case.b.ticks", 4), ("size.axes_3.total", 5)]);
        let read = Figures::from_toml(&written.to_toml());
        assert!(read.is_ok_and(|read| read.compiler == written.compiler && read.values == written.values));
        assert_eq!(Figures::from_toml("[case.a]\nticks = many").err().as_deref(), Some("ticks = many"));
    }

    #[test]
    fn hard_limits_hold_whatever_is_accepted() {
        let mut values: Vec<(&str, u64)> = [GOALS.as_slice(), LIMITS.as_slice()].concat();
        assert_eq!(limits(&figures("", &values)), Ok(()));
        assert!(limits(&figures("", &values[..values.len() - 1])).is_err());
        values[GOALS.len()].1 += 1;
        assert!(limits(&figures("", &values)).is_err());
    }
}

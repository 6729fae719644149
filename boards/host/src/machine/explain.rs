//! Explains a machine file: each value with unit, ISG id, and the line or `default`.
use super::load::{label, thousandths};
use super::{Machine, limits, slope_name, words};
use glidepath::machine::parameter::{AXIS, AXIS_FOREIGN, CHANNEL, CHANNEL_FOREIGN, Parameter};
use glidepath::machine::{AxisKind, NO_LIMIT, Synch};
use std::fmt::Write;

/// A value in a common unit.
fn plain<Target>(parameter: &Parameter<Target>, milli: i64, rotary: bool) -> String {
    if !parameter.words.is_empty() {
        let number = milli / 1000;
        let is_set =
            |index: usize| if parameter.joined { number >> index & 1 == 1 } else { number == index as i64 };
        let set = parameter.words.iter().enumerate().filter(|(index, _)| is_set(*index));
        return set.map(|(_, word)| *word).collect::<Vec<_>>().join("|");
    }
    let [mm, degrees] = match parameter.unit {
        "µm/s" => ["mm/s", "°/s"],
        "mm/s²" => ["mm/s²", "°/s²"],
        "0.1 µm or 0.0001°" => ["mm", "°"],
        "µs" => ["ms"; 2],
        "0.1 %" => ["%"; 2],
        unit if unit.contains(|letter: char| letter.is_ascii_digit()) => return choice(unit, milli),
        unit => [unit; 2],
    };
    let unit = if rotary { degrees } else { mm };
    let divisor = match parameter.unit {
        "µm/s" | "µs" => 1e3,
        "0.1 µm or 0.0001°" => 1e4,
        "0.1 %" => 10.0,
        _ => 1.0,
    };
    if parameter.name.starts_with("kenngr.swe_") && milli.abs() == i64::from(NO_LIMIT) * 1000 {
        return "none".into();
    }
    let value = milli as f64 / 1000.0 / divisor;
    format!("{value} {unit}").trim_end().to_owned()
}

/// A number with a meaning: `1 (TRAPEZ)`.
fn choice(unit: &str, milli: i64) -> String {
    let number = thousandths(milli);
    let parts = unit.split([',', ':']).map(str::trim);
    let meaning = parts.into_iter().find_map(|part| part.strip_prefix(&*number)?.strip_prefix(' '));
    meaning.map_or(number.clone(), |meaning| format!("{number} ({meaning})"))
}

/// One line of the explanation.
struct Line {
    words: String,
    value: String,
    name: String,
    id: String,
    origin: String,
}

fn lines<Target>(
    table: &str,
    parameters: &[Parameter<Target>],
    target: &Target,
    (machine, rotary): (&Machine, bool),
) -> Vec<Line> {
    let of = |parameter: &Parameter<Target>| {
        let label = format!("{table}.{}", parameter.name);
        let given = machine.given.iter().find(|(name, _)| *name == label);
        Line {
            words: words::of(parameter.name).into(),
            value: plain(parameter, (parameter.get)(target), rotary),
            name: parameter.name.into(),
            id: parameter.id.into(),
            origin: given.map_or_else(|| "default".into(), |(_, line)| format!("line {line}")),
        }
    };
    parameters.iter().map(of).collect()
}

/// Given values first, then defaults.
fn print(out: &mut String, mut lines: Vec<Line>) {
    lines.sort_by_key(|line| line.origin == "default");
    let width = |of: fn(&Line) -> &str| lines.iter().map(|line| of(line).chars().count()).max().unwrap_or(0);
    let (words, value) = (width(|line| &line.words), width(|line| &line.value));
    let (name, id) = (width(|line| &line.name), width(|line| &line.id));
    for line in &lines {
        let Line { words: told, value: what, name: key, id: number, origin } = line;
        let _ = writeln!(out, "  {told:words$}  {what:value$}  {key:name$}  {number:id$}  {origin}");
    }
}

/// Every value of a machine.
pub fn explain(machine: &Machine) -> String {
    let mut out = format!("{}\n\nchannel\n", machine.name);
    let mut channel = lines("channel", CHANNEL, &machine.channel, (machine, false));
    channel.extend(lines("channel", CHANNEL_FOREIGN, &machine.channel, (machine, false)));
    print(&mut out, channel);
    for (table, id, synchs) in
        [("M", "P-CHAN-00041", &machine.channel.m_synch), ("H", "P-CHAN-00027", &machine.channel.h_synch)]
    {
        for (code, synch) in synchs.entries() {
            let name = Synch::ALL.iter().find(|(known, ..)| *known == synch).map_or("", |(_, name, _)| name);
            let _ = writeln!(
                out,
                "  {table}{code} is put out as {name}{}{}  {}",
                if synchs.flushes(code) { "|FAW_SYNCH" } else { "" },
                match synchs.shift(code) {
                    0 => String::new(),
                    shift => format!(", {} mm before its place", f64::from(shift) / 1e4),
                },
                label("channel", id, "synchronisation")
            );
        }
    }
    let slope = machine.slope();
    for axis in &machine.axes {
        let (name, rotary) = (axis.name.as_str(), axis.kind == AxisKind::Rotary);
        let kind = match axis.kind {
            AxisKind::Linear => "linear",
            AxisKind::Rotary => "rotary",
            AxisKind::Spindle => "spindle",
        };
        let _ = writeln!(out, "\naxis {name}, {kind}");
        let table = format!("axis.{name}");
        let mut all = lines(&table, AXIS, axis, (machine, rotary));
        all.extend(lines(&table, AXIS_FOREIGN, axis, (machine, rotary)));
        print(&mut out, all);
        let permitted = limits(&axis.planned(&machine.channel), slope);
        let unit = if rotary { "°" } else { "mm" };
        let jerk = if permitted.jerk.is_finite() {
            format!("jerk up to {:.0} {unit}/s³", permitted.jerk)
        } else {
            "jerk without limit".into()
        };
        let _ = writeln!(
            out,
            "  so with slope {}: speed up to {} {unit}/s, acceleration up to {} {unit}/s², {jerk}",
            slope_name(slope),
            permitted.speed,
            permitted.accel_feed.max(permitted.accel_rapid),
        );
    }
    out
}

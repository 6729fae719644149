//! The summary of a run, for people and for programs.
use crate::beside::{Beside, Oscillation};
use crate::clock::clock;
use crate::deviation;
use crate::events::{Event, function_name};
use crate::files::Files;
use crate::filtered::{Filtered, FilteredAxis};
use crate::knee::knees;
use crate::machine::{Machine, slope_name};
use crate::monitor::Step;
use crate::program::{Program, Segment, plural};
use crate::statistics::{Effect, Statistics};
use crate::usage;
use crate::why::{Told, Why};
use anstyle::Style;
use glidepath::machine::AxisKind;
use glidepath::quantity::{Speed, Time};
use serde::{Serialize, Serializer};
use std::fmt::Write;

/// Slowest corners that are shown.
const CORNERS: usize = 5;

/// Events that are shown.
const EVENTS: usize = 12;

/// The summary of a run. Speeds in mm/s, accelerations in mm/s², jerk in mm/s³; degrees for rotary axes.
#[derive(Serialize)]
pub struct Summary {
    program: String,
    machine: String,
    /// Slope at program start.
    slope: &'static str,
    look_ahead: u32,
    program_time_s: f64,
    ticks: u64,
    cycle_s: f64,
    blocks: usize,
    dwell_s: f64,
    /// Time at standstill because of an event.
    held_s: f64,
    /// Time at standstill because of a missing acknowledgement.
    waited_s: f64,
    path_mm: f64,
    v_path_max: f64,
    /// Whether the motion was slower than programmed, so that a stop without the planner fits into the queue.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    slower: bool,
    /// Elements under a transformation, and the number of resulting polynomials of the axes.
    #[serde(skip_serializing_if = "Option::is_none")]
    transformed: Option<[u32; 2]>,
    /// Deviation of the driven path from the programmed path.
    #[serde(flatten)]
    shape: Option<deviation::Told>,
    /// Digest over all set points after the first row of the trace, 16 hexadecimal digits.
    digest: String,
    /// Time per tool, spindle, feed.
    #[serde(flatten)]
    usage: usage::Told,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    filtered: Vec<FilteredAxis>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    oscillations: Vec<Oscillation>,
    #[serde(serialize_with = "in_order")]
    axes: Vec<(String, Axis)>,
    stops: usize,
    slowest_corners: Vec<Corner>,
    /// The limits that bound the speed, if requested.
    #[serde(skip_serializing_if = "Option::is_none")]
    why: Option<Told>,
    /// Jerk that was not compared with its limit, and the reason.
    #[serde(skip_serializing_if = "Option::is_none")]
    left_out: Option<String>,
    /// Number of transitions with a step of acceleration, and the highest step.
    #[serde(skip_serializing_if = "Option::is_none")]
    steps: Option<Steps>,
    /// Exceeded limits.
    exceeded: usize,
    warnings: Vec<Warning>,
    functions: Vec<Output>,
    events: Vec<Happening>,
    plan: Vec<Span>,
}

/// Transitions at which the machine data permit a step of acceleration, and a step has shown.
#[derive(Serialize)]
struct Steps {
    count: u64,
    largest: f64,
    axis: String,
    n: u32,
    unit: &'static str,
}

/// An event from outside.
#[derive(Serialize)]
struct Happening {
    /// Text of the event in the file.
    t_s: f64,
    /// The first tick with the event; none if the program had ended before.
    tick: Option<u64>,
    what: String,
    line: usize,
    reaction: Option<Reaction>,
}

/// The effect of the event begins at this tick.
#[derive(Serialize)]
struct Reaction {
    what: &'static str,
    after_s: f64,
    path_mm: f64,
}

/// A technology function.
#[derive(Serialize)]
struct Output {
    t_s: f64,
    n: u32,
    function: String,
    /// Whether the motion needs its acknowledgement.
    waits: bool,
    /// Time of the acknowledgement.
    acknowledged_s: Option<f64>,
}

#[derive(Serialize)]
struct Axis {
    v_max: f64,
    a_max: f64,
    j_max: f64,
    v_limit: f64,
    a_limit: f64,
    j_limit: f64,
    travel: f64,
    lowest: f64,
    highest: f64,
    unit: &'static str,
}

/// A transition between two blocks.
#[derive(Serialize)]
struct Corner {
    v: f64,
    /// Block that ends at the transition: N number, line, and file if it is a called file.
    block: u32,
    n: u32,
    line: u32,
    #[serde(skip_serializing_if = "Option::is_none")]
    file: Option<String>,
    /// N number of the block that begins at the transition.
    next_n: u32,
    /// Angle of the programmed path at the transition, degrees.
    knee: f64,
    /// The limit that bound the speed there.
    #[serde(skip_serializing_if = "Option::is_none")]
    bound: Option<String>,
}

#[derive(Serialize)]
struct Warning {
    id: String,
    line: usize,
    column: usize,
    /// The file, if it is a called file.
    #[serde(skip_serializing_if = "Option::is_none")]
    file: Option<String>,
    text: String,
}

/// A speed profile.
#[derive(Serialize)]
struct Span {
    /// The first of its motion blocks, and the number of blocks.
    block: u32,
    blocks: u32,
    n: u32,
    line: u32,
    /// The file, if it is a called file.
    #[serde(skip_serializing_if = "Option::is_none")]
    file: Option<String>,
    length_mm: f64,
    v_in: f64,
    v_peak: f64,
    v_out: f64,
    time_s: f64,
    /// Time from a standstill at its end to the tick at which the next motion may begin.
    wait_s: f64,
}

fn in_order<S: Serializer>(axes: &[(String, Axis)], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_map(axes.iter().map(|(name, axis)| (name, axis)))
}

impl Summary {
    /// The summary of a complete run.
    pub fn new(
        files: &Files,
        machine: &Machine,
        program: &Program,
        events: &[Event],
        statistics: &Statistics,
        why: Option<&Why>,
    ) -> Self {
        let cycle_s = machine.cycle_s();
        let speed = |v: Speed| v.to_bits() as f64 / (1_u64 << 58) as f64 / cycle_s;
        let time = |t: Time| t.to_bits() as f64 / (1_u64 << 36) as f64 * cycle_s;
        let axes = machine.axes.iter().zip(&statistics.axes).enumerate().map(|(k, (data, seen))| {
            let allowed = program.allowed_anywhere(k, machine);
            let [v_max, a_max, j_max] = seen.peak(cycle_s);
            let [lowest, highest] = seen.range();
            let axis = Axis {
                v_max,
                a_max,
                j_max,
                v_limit: allowed.speed,
                a_limit: allowed.accel,
                j_limit: allowed.jerk,
                travel: seen.travel(),
                lowest,
                highest,
                unit: if data.kind == AxisKind::Linear { "mm" } else { "°" },
            };
            (data.name.as_str().to_owned(), axis)
        });
        let motions: Vec<&Segment> = program.motions().collect();
        let place = |block: u32| motions.get(block as usize).map(|motion| motion.place).unwrap_or_default();
        let plan = statistics.spans.iter().map(|block| Span {
            block: block.block,
            blocks: block.blocks,
            n: block.n,
            line: place(block.block).line,
            file: files.name(place(block.block).file),
            length_mm: mm(block.length.to_bits().into()),
            v_in: speed(block.v_in),
            v_peak: speed(block.v_peak),
            v_out: speed(block.v_out),
            time_s: time(block.time),
            wait_s: time(block.wait),
        });
        let warnings = program.warnings.iter().map(|warning| {
            let (line, column) = warning.place();
            let file = warning.source().filter(|name| *name != files.main.name).map(str::to_owned);
            Warning { id: warning.id.clone(), line, column, file, text: warning.message.clone() }
        });
        let plan: Vec<Span> = plan.collect();
        let functions = statistics.functions.iter().map(|done| Output {
            t_s: in_seconds(done.tick, machine),
            n: done.output.n,
            function: function_name(done.output.function),
            waits: done.output.waits,
            acknowledged_s: done.acknowledged.map(|tick| in_seconds(tick, machine)),
        });
        // Events change the planned speeds.
        let planned = events.is_empty();
        let (stops, mut slowest_corners) = corners(files, program, statistics, planned, speed);
        for corner in &mut slowest_corners {
            let bound = why.and_then(|why| why.joints.get(corner.block as usize).copied().flatten());
            corner.bound = bound.map(|bound| bound.name(machine));
        }
        let events = events.iter().zip(&statistics.outcomes).map(|(event, outcome)| Happening {
            t_s: event.time_ns as f64 / 1e9,
            tick: outcome.tick,
            what: event.what.to_string(),
            line: event.line,
            reaction: outcome.reaction.map(|reaction| Reaction {
                what: match reaction.effect {
                    Effect::Standstill => "standstill",
                    Effect::Motion => "motion",
                },
                after_s: in_seconds(reaction.ticks, machine),
                path_mm: mm(reaction.distance),
            }),
        });
        let v_path_max = if planned && !statistics.over_time {
            plan.iter().map(|span| span.v_peak).fold(0.0, f64::max)
        } else {
            speed(statistics.fastest)
        };
        Self {
            program: files.main.name.clone(),
            machine: machine.name.clone(),
            slope: slope_name(machine.slope()),
            look_ahead: machine.channel.look_ahead,
            program_time_s: statistics.time_s(machine),
            ticks: statistics.ticks,
            cycle_s,
            blocks: statistics.blocks(),
            dwell_s: if statistics.aborted {
                in_seconds(statistics.dwelt, machine).min(program.dwell_s())
            } else {
                program.dwell_s()
            },
            held_s: in_seconds(statistics.held, machine),
            waited_s: in_seconds(statistics.waited, machine),
            path_mm: statistics.distance_mm(),
            v_path_max,
            slower: statistics.slower,
            transformed: (statistics.split.elements > 0)
                .then_some([statistics.split.elements, statistics.split.polynomials]),
            shape: statistics
                .deviation
                .as_ref()
                .map(|seen| deviation::Told::new(seen, machine, statistics.blocks())),
            digest: format!("{:016x}", statistics.digest.value()),
            usage: statistics.usage.tell(&statistics.functions, statistics.time_s(machine)),
            filtered: statistics.filtered.axes(),
            oscillations: statistics.beside.oscillations(&program.beside, machine),
            axes: axes.collect(),
            stops,
            slowest_corners,
            why: why.map(|why| Told::new(why, machine, program)),
            left_out: statistics.monitor.left_out(),
            steps: (statistics.monitor.stepped > 0).then(|| {
                let Step { axis, n, size } = statistics.monitor.largest;
                let data = &machine.axes[axis];
                Steps {
                    count: statistics.monitor.stepped,
                    largest: size,
                    axis: data.name.as_str().to_owned(),
                    n,
                    unit: if data.kind == AxisKind::Linear { "mm/s²" } else { "°/s²" },
                }
            }),
            exceeded: statistics.monitor.excess.len(),
            warnings: warnings.collect(),
            functions: functions.collect(),
            events: events.collect(),
            plan,
        }
    }

    /// Text for programs.
    pub fn to_json(&self) -> String {
        // Numbers and strings only: nothing that JSON could not hold.
        let mut text = serde_json::to_string_pretty(self).unwrap_or_default();
        text.push('\n');
        text
    }

    /// Text for people.
    pub fn to_text(&self) -> String {
        let mut out = String::new();
        // Writing to a String cannot fail.
        let _ = self.write_text(&mut out);
        out
    }

    fn write_text(&self, out: &mut String) -> std::fmt::Result {
        let bold = Style::new().bold();
        let dim = Style::new().dimmed();
        write!(out, "{bold}{}{bold:#} {dim}on{dim:#} {}", self.program, self.machine)?;
        writeln!(out, "{dim}, slope{dim:#} {}{dim}, look-ahead{dim:#} {}", self.slope, self.look_ahead)?;
        writeln!(out)?;
        let cycle = self.cycle_s * 1e3;
        writeln!(
            out,
            "  program time   {bold}{:.3} s{bold:#}{}, {} tick{} of {cycle} ms",
            self.program_time_s,
            clock(self.program_time_s),
            self.ticks,
            if self.ticks == 1 { "" } else { "s" }
        )?;
        write!(out, "  motion         {} block{}", self.blocks, plural(self.blocks))?;
        write!(out, ", {:.3} mm of path", self.path_mm)?;
        if self.dwell_s > 0.0 {
            write!(out, ", {:.3} s{} of dwell", self.dwell_s, clock(self.dwell_s))?;
        }
        if self.held_s > 0.0 {
            write!(out, ", {:.3} s{} held", self.held_s, clock(self.held_s))?;
        }
        if self.waited_s > 0.0 {
            write!(out, ", {:.3} s{} waited", self.waited_s, clock(self.waited_s))?;
        }
        writeln!(out)?;
        let moving = self.program_time_s - self.dwell_s - self.held_s - self.waited_s;
        let mean = if moving > 0.0 { self.path_mm / moving } else { 0.0 };
        writeln!(out, "  path speed     {:.1} mm/s at most, {mean:.1} mm/s in the mean", self.v_path_max)?;
        if self.slower {
            writeln!(
                out,
                "  slower         than programmed: from a higher speed a standstill has too many pieces of time"
            )?;
        }
        if let Some([elements, polynomials]) = self.transformed {
            writeln!(
                out,
                "  transformation {elements} elements of the tip are {polynomials} polynomials of the axes"
            )?;
        }
        if let Some(shape) = &self.shape {
            shape.write(out)?;
        }
        if !self.functions.is_empty() {
            let names: Vec<&str> =
                self.functions.iter().take(8).map(|output| output.function.as_str()).collect();
            let more = if self.functions.len() > 8 {
                format!(" … ({} in all)", self.functions.len())
            } else {
                String::new()
            };
            writeln!(out, "  functions      {}{more}", names.join(" "))?;
        }
        self.usage.write(out)?;
        writeln!(out, "  digest         {}", self.digest)?;
        writeln!(out)?;
        writeln!(
            out,
            "  {dim}axis     travel                  range         speed  of limit  acceleration  of limit          \
             jerk  of limit{dim:#}"
        )?;
        for (name, axis) in &self.axes {
            let unit = axis.unit;
            let range = format!("{:.3} … {:.3}", axis.lowest, axis.highest);
            writeln!(
                out,
                "  {bold}{name:<4}{bold:#}{:>11.3} {unit:<2}{range:>20}{:>9.1} {unit}/s{}{:>8.1} {unit}/s²{}{:>9.0} {unit}/s³{}",
                axis.travel,
                axis.v_max,
                share(axis.v_max, axis.v_limit, unit),
                axis.a_max,
                share(axis.a_max, axis.a_limit, unit),
                axis.j_max,
                share(axis.j_max, axis.j_limit, unit),
            )?;
        }
        if let Some(left_out) = &self.left_out {
            writeln!(out, "  {left_out}")?;
        }
        if let Some(Steps { count, largest, axis, n, unit }) = &self.steps {
            let joints = if *count == 1 { "joint" } else { "joints" };
            writeln!(
                out,
                "  {count} {joints} with a step of acceleration, the largest one {largest:.1} {unit} of {axis} at N{n}"
            )?;
        }
        self.usage.write_feeds(out)?;
        Filtered::write(&self.filtered, out)?;
        Beside::write(&self.oscillations, out)?;
        if !self.events.is_empty() {
            writeln!(out)?;
            writeln!(out, "  {dim}    event at{dim:#}")?;
            for event in self.events.iter().take(EVENTS) {
                let outcome = match &event.reaction {
                    Some(Reaction { what, after_s, path_mm }) => {
                        let after = milliseconds(*after_s);
                        format!("{dim}{what} after{dim:#} {after} ms{dim},{dim:#} {path_mm:.3} mm")
                    }
                    None if event.tick.is_none() => format!("{dim}after the end{dim:#}"),
                    None => String::new(),
                };
                let (at, clock) = (event.t_s, clock(event.t_s));
                let line = format!("  {at:>10.3} s{clock}  {:<18}  {outcome}", event.what);
                writeln!(out, "{}", line.trim_end())?;
            }
            if self.events.len() > EVENTS {
                writeln!(out, "  {dim}… {} in all{dim:#}", self.events.len())?;
            }
        }
        let waits: Vec<&Output> = self.functions.iter().filter(|output| output.waits).collect();
        if !waits.is_empty() {
            writeln!(out)?;
            writeln!(out, "  {dim} output at{dim:#}")?;
            for output in waits.iter().take(EVENTS) {
                let outcome = match output.acknowledged_s {
                    Some(at) => {
                        format!("{dim}acknowledged after{dim:#} {} ms", milliseconds(at - output.t_s))
                    }
                    None => format!("{dim}not acknowledged{dim:#}"),
                };
                let (at, clock) = (output.t_s, clock(output.t_s));
                writeln!(out, "  {at:>10.3} s{clock}  {:<18}  {outcome}", output.function)?;
            }
            if waits.len() > EVENTS {
                writeln!(out, "  {dim}… {} in all{dim:#}", waits.len())?;
            }
        }
        if !self.slowest_corners.is_empty() {
            writeln!(out)?;
            let of = self.blocks - 1;
            write!(out, "  slowest corners of {of}")?;
            if self.stops > 0 {
                write!(out, ", {} at a standstill", self.stops)?;
            }
            writeln!(out)?;
            for corner in &self.slowest_corners {
                let bound = corner.bound.as_ref().map_or_else(String::new, |bound| format!("  {bound}"));
                let file = corner.file.as_ref().map_or_else(String::new, |name| format!(" of {name}"));
                writeln!(
                    out,
                    "    {:>8.2} mm/s  {} → {}  {:.1}°  {dim}line {}{file}{dim:#}{bound}",
                    corner.v,
                    number(corner.n, corner.block),
                    number(corner.next_n, corner.block + 1),
                    corner.knee,
                    corner.line,
                )?;
            }
        }
        if let Some(why) = &self.why {
            why.write(out)?;
        }
        if !self.warnings.is_empty() {
            writeln!(out)?;
            writeln!(out, "  {} warning{}", self.warnings.len(), plural(self.warnings.len()))?;
        }
        Ok(())
    }
}

/// `N120`, or the running number if no N number is programmed.
fn number(n: u32, block: u32) -> String {
    if n == 0 { format!("block {block}") } else { format!("N{n}") }
}

/// A peak in percent of its limit, in a column of the width of the heading.
fn share(value: f64, limit: f64, unit: &str) -> String {
    // A degree sign is one column narrower than mm.
    let pad = if unit == "mm" { "" } else { " " };
    if limit > 0.0 && limit.is_finite() {
        format!("{pad}{:>8.1} %", value / limit * 100.0)
    } else {
        String::new()
    }
}

fn in_seconds(ticks: u64, machine: &Machine) -> f64 {
    (ticks as f64 * f64::from(machine.channel.cycle_us)) / 1e6
}

fn mm(bits: i128) -> f64 {
    bits as f64 / (1_u64 << 44) as f64
}

/// Number of standstills between blocks, and the slowest transitions; standstills come first.
///
/// The speed of a transition inside a span is that of the set points, because nothing is planned there. At
/// the end of a span it is the `planned` speed, if the planned speed occurred: without events, and not on a
/// curve over time. A standstill must show in a row.
fn corners(
    files: &Files,
    program: &Program,
    statistics: &Statistics,
    planned: bool,
    speed: impl Fn(Speed) -> f64,
) -> (usize, Vec<Corner>) {
    let mut speeds: Vec<(Option<Speed>, usize)> = statistics.transitions.iter().copied().zip(0..).collect();
    if planned {
        for (last, speed) in statistics.ends() {
            if let Some((v, _)) = speeds.get_mut(last) {
                *v = Some(speed);
            }
        }
        // Near a transition, a row may stand still too: at the end of a short element before it.
        for (v, index) in &mut speeds {
            if statistics.course.joint(*index).is_some_and(|seen| seen.speed == Speed::ZERO) {
                *v = Some(Speed::ZERO);
            }
        }
    }
    let mut speeds: Vec<(Speed, usize)> =
        speeds.into_iter().filter_map(|(v, index)| Some((v?, index))).collect();
    let stops = speeds.iter().filter(|(v, _)| *v == Speed::ZERO).count();
    speeds.sort_unstable();
    let mut corners = Vec::new();
    let motions: Vec<&Segment> = program.motions().collect();
    let knees = knees(program);
    for &(v, index) in speeds.iter().take(CORNERS) {
        let (Some(before), Some(after)) = (motions.get(index), motions.get(index + 1)) else { continue };
        corners.push(Corner {
            v: speed(v),
            block: index as u32,
            n: before.n,
            line: before.place.line,
            file: files.name(before.place.file),
            next_n: after.n,
            knee: knees.get(index).copied().unwrap_or(0.0),
            bound: None,
        });
    }
    (stops, corners)
}

/// Value to the µs, without unnecessary digits.
fn milliseconds(s: f64) -> String {
    let text = format!("{:.3}", s * 1e3);
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

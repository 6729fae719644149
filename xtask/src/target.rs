//! Reads the report of the test firmware, line by line.
use std::collections::BTreeMap;

/// Number, sum and highest value of a count on the target.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cost {
    /// Number of calls.
    pub calls: u64,
    /// Sum over all calls.
    pub sum: u64,
    /// The most expensive call.
    pub max: u64,
}

/// A case with its results on the target.
#[derive(Debug, Default)]
pub struct TargetRun {
    /// Name of the case.
    pub name: String,
    /// Number of axes.
    pub axes: usize,
    /// Blocks of look-ahead.
    pub look_ahead: usize,
    /// Bits of the set points, as on the host.
    pub set_points: Vec<i64>,
    /// Instructions of `Channel::split`.
    pub start: Cost,
    /// The interpolator's calls.
    pub tick: Cost,
    /// Planner calls with work.
    pub plan: Cost,
    /// Planner calls that found the queue full.
    pub wait: Cost,
    /// The decoder alone.
    pub decode: Cost,
    /// Ticks with motion or dwell.
    pub ticks: u64,
    /// Ticks without planned motion, between the first and the last tick with motion.
    pub starved: u64,
    /// Motion blocks planned.
    pub blocks: u64,
    /// Digest over all set points.
    pub digest: u64,
    /// Reason for which the case did not end.
    pub failed: Option<String>,
}

/// Reads the report of `same`.
pub fn read_runs(report: &str) -> Result<Vec<TargetRun>, String> {
    let mut runs: Vec<TargetRun> = Vec::new();
    for line in report.lines() {
        let (kind, rest) = line.split_once(' ').unwrap_or((line, ""));
        if kind == "unit" || kind == "memory" || kind == "stacks" || kind == "beside" {
            continue;
        }
        if kind == "case" {
            let (name, rest) = rest.split_once(' ').ok_or_else(|| unreadable(line))?;
            let values = fields(rest);
            let value = |key| number(&values, key, line).map(|number| number as usize);
            let (axes, look_ahead) = (value("axes")?, value("blocks")?);
            runs.push(TargetRun { name: name.into(), axes, look_ahead, ..TargetRun::default() });
            continue;
        }
        let run = runs.last_mut().ok_or_else(|| unreadable(line))?;
        match kind {
            "s" => {
                for digits in rest.as_bytes().chunks(16) {
                    let bits = std::str::from_utf8(digits).ok().and_then(|d| u64::from_str_radix(d, 16).ok());
                    run.set_points.push(bits.ok_or_else(|| unreadable(line))? as i64);
                }
            }
            "cost" => {
                let (name, values) = rest.split_once(' ').ok_or_else(|| unreadable(line))?;
                let values = fields(values);
                let value = |key| number(&values, key, line);
                let cost = Cost { calls: value("calls")?, sum: value("sum")?, max: value("max")? };
                match name {
                    "start" => run.start = cost,
                    "tick" => run.tick = cost,
                    "plan" => run.plan = cost,
                    "wait" => run.wait = cost,
                    "decode" => run.decode = cost,
                    _ => return Err(unreadable(line)),
                }
            }
            "end" => {
                let values = fields(rest);
                run.ticks = number(&values, "ticks", line)?;
                run.starved = number(&values, "starved", line)?;
                run.blocks = number(&values, "blocks", line)?;
                run.digest = digest(&values, line)?;
            }
            "failed" => run.failed = Some(rest.into()),
            _ => return Err(unreadable(line)),
        }
    }
    Ok(runs)
}

/// Bytes of a tap of the filters and of an overlay, as the target reports them.
pub fn read_beside(report: &str) -> Result<[u64; 2], String> {
    let line = report.lines().find_map(|line| line.strip_prefix("beside ")).ok_or("no bytes of a tap")?;
    let values = fields(line);
    Ok([number(&values, "tap", line)?, number(&values, "overlay", line)?])
}

/// Costs of the decoder by the name of the dialect.
pub fn read_dialects(report: &str) -> Result<BTreeMap<String, Cost>, String> {
    let lines = report.lines().filter_map(|line| line.strip_prefix("dialect "));
    let read = |line: &str| {
        let (name, values) = line.split_once(' ').ok_or_else(|| unreadable(line))?;
        let values = fields(values);
        let value = |key| number(&values, key, line);
        Ok((name.to_owned(), Cost { calls: value("calls")?, sum: value("sum")?, max: value("max")? }))
    };
    lines.map(read).collect()
}

/// Bytes of the channel in the report of `decode`.
pub fn read_channel(report: &str) -> Result<u64, String> {
    let line =
        report.lines().find_map(|line| line.strip_prefix("channel ")).ok_or("no bytes of the channel")?;
    number(&fields(line), "bytes", line)
}

/// RAM of a configuration, from the target's report.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Memory {
    /// Number of axes.
    pub axes: u64,
    /// Blocks of look-ahead.
    pub blocks: u64,
    /// Bytes of the channel: static.
    pub channel: u64,
    /// Bytes of the planner's half, on the stack.
    pub planner: u64,
    /// Bytes of the interpolator.
    pub interpolator: u64,
    /// Bytes of stack that the memory map has.
    pub stack: u64,
    /// Bytes of stack in use at its deepest.
    pub depth: u64,
}

/// The lines of a report about memory.
pub fn read_memory(report: &str) -> Result<Vec<Memory>, String> {
    let lines = report.lines().filter_map(|line| line.strip_prefix("memory "));
    let read = |line: &str| {
        let values = fields(line);
        let value = |key| number(&values, key, line);
        Ok(Memory {
            axes: value("axes")?,
            blocks: value("blocks")?,
            channel: value("channel")?,
            planner: value("planner")?,
            interpolator: value("interpolator")?,
            stack: value("stack")?,
            depth: value("depth")?,
        })
    };
    lines.map(read).collect()
}

/// Depth of the stack below each kind of call, bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stacks {
    /// Number of axes.
    pub axes: u64,
    /// `Channel::split`.
    pub start: u64,
    /// `Planner::poll`.
    pub poll: u64,
    /// `Interpolator::tick`.
    pub tick: u64,
}

/// The lines of a report about the stack.
pub fn read_stacks(report: &str) -> Result<Vec<Stacks>, String> {
    let lines = report.lines().filter_map(|line| line.strip_prefix("stacks "));
    let read = |line: &str| {
        let values = fields(line);
        let value = |key| number(&values, key, line);
        Ok(Stacks {
            axes: value("axes")?,
            start: value("start")?,
            poll: value("poll")?,
            tick: value("tick")?,
        })
    };
    lines.map(read).collect()
}

/// `a 1 b 2` as a map.
pub fn fields(text: &str) -> BTreeMap<&str, &str> {
    let words: Vec<&str> = text.split_whitespace().collect();
    words.chunks_exact(2).map(|pair| (pair[0], pair[1])).collect()
}

/// The number with the name `key`.
pub fn number(fields: &BTreeMap<&str, &str>, key: &str, line: &str) -> Result<u64, String> {
    fields.get(key).and_then(|value| value.parse().ok()).ok_or_else(|| unreadable(line))
}

/// The digest in hexadecimal.
pub fn digest(fields: &BTreeMap<&str, &str>, line: &str) -> Result<u64, String> {
    let digits = fields.get("digest").ok_or_else(|| unreadable(line))?;
    u64::from_str_radix(digits, 16).map_err(|_| unreadable(line))
}

fn unreadable(line: &str) -> String {
    format!("the target said something unexpected: {line}")
}

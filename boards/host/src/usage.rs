//! Usage of machine and tools by a job: time per tool, time with the spindle on, distribution of the feed.
use crate::clock::clock;
use crate::machine::Machine;
use crate::program::Program;
use crate::statistics::{Pause, PutOut};
use glidepath::queue::Function;
use glidepath::tick::Telemetry;
use serde::Serialize;
use std::fmt::Write;

/// Bars of the histogram: equal parts of the highest programmed feed; the last bar includes all higher
/// values.
const BARS: usize = 10;

/// Rows of motion at feed, by their speed.
#[derive(Clone, Debug, Default)]
pub struct Usage {
    /// Whether each motion block is rapid.
    rapid: Vec<bool>,
    /// Speed of the highest programmed feed, LSB of [`glidepath::quantity::Speed`].
    highest: i64,
    /// The same, mm/min.
    feed: f64,
    cycle_s: f64,
    rows: [u64; BARS],
}

/// A bar: feed in mm/min, time in s.
#[derive(Clone, Debug, Serialize)]
pub struct Bar {
    from: f64,
    to: f64,
    time_s: f64,
}

/// Time with a tool; none before the first one.
#[derive(Clone, Debug, Serialize)]
pub struct Tool {
    tool: Option<u32>,
    time_s: f64,
}

/// Values for the summary.
#[derive(Clone, Debug, Serialize)]
pub struct Told {
    #[serde(skip_serializing_if = "Vec::is_empty")]
    tools: Vec<Tool>,
    /// Between M3 or M4 and M5.
    spindle_on_s: f64,
    feed_histogram: Vec<Bar>,
}

impl Usage {
    /// Usage before the run begins.
    pub fn new(machine: &Machine, program: &Program) -> Self {
        let feed = program.motions().filter_map(|motion| motion.feed).fold(0.0, f64::max);
        let cycle_s = machine.cycle_s();
        Self {
            rapid: program.motions().map(|motion| motion.feed.is_none()).collect(),
            highest: (feed / 60.0 * cycle_s * (1_u64 << 58) as f64) as i64,
            feed,
            cycle_s,
            rows: [0; BARS],
        }
    }

    /// Records a row.
    pub fn add(&mut self, telemetry: &Telemetry, pause: Pause) {
        let is_feed = self.rapid.get(telemetry.block as usize) == Some(&false);
        let speed = telemetry.speed.to_bits();
        if !is_feed || pause != Pause::None || speed <= 0 || self.highest <= 0 {
            return;
        }
        // A speed at the upper end of a bar belongs to this bar; rounding of the feed does not leave the last
        // bar.
        let bar = (i128::from(speed) - 1) * BARS as i128 / i128::from(self.highest);
        self.rows[usize::try_from(bar).unwrap_or(0).min(BARS - 1)] += 1;
    }

    /// Returns the result with the functions of the run and its length.
    pub fn tell(&self, functions: &[PutOut], time_s: f64) -> Told {
        let at = |done: &PutOut| (done.tick as f64 * self.cycle_s).min(time_s);
        let step = self.feed / BARS as f64;
        let bars = self.rows.iter().enumerate().filter(|_| self.rows.iter().any(|rows| *rows > 0));
        Told {
            tools: tools(functions, time_s, at),
            spindle_on_s: spindle(functions, time_s, at),
            feed_histogram: bars
                .map(|(index, rows)| Bar {
                    from: step * index as f64,
                    to: step * (index + 1) as f64,
                    time_s: *rows as f64 * self.cycle_s,
                })
                .collect(),
        }
    }
}

/// Time per tool. The tool changes at M6 if the program has M6, else at T.
fn tools(functions: &[PutOut], time_s: f64, at: impl Fn(&PutOut) -> f64) -> Vec<Tool> {
    let by_m6 = functions.iter().any(|done| done.output.function == Function::M(6));
    let mut tools: Vec<Tool> = Vec::new();
    let (mut selected, mut tool, mut since) = (None, None, 0.0);
    let mut put = |tool: Option<u32>, time_s: f64| match tools.iter_mut().find(|known| known.tool == tool) {
        Some(known) => known.time_s += time_s,
        None if time_s > 0.0 => tools.push(Tool { tool, time_s }),
        None => {}
    };
    for done in functions {
        let changes = match done.output.function {
            Function::Tool(number) => {
                selected = Some(number);
                !by_m6
            }
            Function::M(6) => selected.is_some(),
            _ => false,
        };
        if changes {
            let now = at(done);
            put(tool, now - since);
            (tool, since) = (selected, now);
        }
    }
    put(tool, time_s - since);
    if tools.iter().all(|tool| tool.tool.is_none()) { Vec::new() } else { tools }
}

/// Time with the spindle on.
fn spindle(functions: &[PutOut], time_s: f64, at: impl Fn(&PutOut) -> f64) -> f64 {
    let (mut on, mut sum) = (None, 0.0);
    for done in functions {
        match done.output.function {
            Function::M(3 | 4) => on = on.or(Some(at(done))),
            Function::M(5) => sum += on.take().map_or(0.0, |since| at(done) - since),
            _ => {}
        }
    }
    sum + on.map_or(0.0, |since| time_s - since)
}

impl Told {
    /// For people.
    pub fn write(&self, out: &mut String) -> std::fmt::Result {
        if !self.tools.is_empty() {
            let name =
                |tool: &Tool| tool.tool.map_or_else(|| "no tool".to_owned(), |tool| format!("T{tool}"));
            let one = |tool: &Tool| format!("{} {:.3} s{}", name(tool), tool.time_s, clock(tool.time_s));
            let tools: Vec<String> = self.tools.iter().map(one).collect();
            writeln!(out, "  tools          {}", tools.join(", "))?;
        }
        if self.spindle_on_s > 0.0 {
            writeln!(out, "  spindle on     {:.3} s{}", self.spindle_on_s, clock(self.spindle_on_s))?;
        }
        Ok(())
    }

    /// The histogram: a bar for each tenth of the highest feed that took time.
    pub fn write_feeds(&self, out: &mut String) -> std::fmt::Result {
        let longest = self.feed_histogram.iter().map(|bar| bar.time_s).fold(0.0, f64::max);
        let all: f64 = self.feed_histogram.iter().map(|bar| bar.time_s).sum();
        if longest <= 0.0 {
            return Ok(());
        }
        writeln!(out)?;
        writeln!(out, "  time at feed, by the speed along the path, mm/min")?;
        for bar in self.feed_histogram.iter().filter(|bar| bar.time_s > 0.0) {
            let range = format!("{:.0} … {:.0}", bar.from, bar.to);
            let drawn = "█".repeat(((bar.time_s / longest * 30.0).ceil() as usize).clamp(1, 30));
            let (time_s, share) = (bar.time_s, bar.time_s / all * 100.0);
            writeln!(out, "    {range:>17} {time_s:>10.3} s {share:>5.1} %  {drawn}")?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glidepath::technology::Output;

    fn put_out(tick: u64, function: Function) -> PutOut {
        PutOut { tick, output: Output { tick: 0, n: 0, function, waits: false }, acknowledged: None }
    }

    #[test]
    fn tools_change_at_m6_or_at_t() {
        let usage = Usage { cycle_s: 0.001, ..Usage::default() };
        let times = |functions: &[PutOut]| {
            let told = usage.tell(functions, 10.0);
            let tools: Vec<(Option<u32>, f64)> = told.tools.iter().map(|t| (t.tool, t.time_s)).collect();
            (tools, told.spindle_on_s)
        };
        let [t1, t2] = [1, 2].map(Function::Tool);
        let by_t = [put_out(1000, t1), put_out(2000, Function::M(3)), put_out(4000, t2), put_out(5000, t1)];
        assert_eq!(times(&by_t), (vec![(None, 1.0), (Some(1), 8.0), (Some(2), 1.0)], 8.0));
        let by_m6 = [
            put_out(0, t1),
            put_out(1000, Function::M(6)),
            put_out(1500, Function::M(4)),
            put_out(2000, t2),
            put_out(3000, Function::M(5)),
            put_out(4000, Function::M(6)),
        ];
        assert_eq!(times(&by_m6), (vec![(None, 1.0), (Some(1), 3.0), (Some(2), 6.0)], 1.5));
        assert_eq!(times(&[]), (Vec::new(), 0.0));
    }
}

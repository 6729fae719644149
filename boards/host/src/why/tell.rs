//! The limits that bound the speed, as a part of the summary: for people and for programs.
use super::count::{Bound, Why};
use crate::clock::clock;
use crate::knee::{SHARP, knees};
use crate::machine::Machine;
use crate::program::{Program, Segment, plural};
use crate::smooth::ADVISED;
use anstyle::Style;
use serde::Serialize;
use std::fmt::Write;

/// Number of reasons that are shown; the others are one line.
const REASONS: usize = 6;
/// Number of changes that are shown.
const HELPS: usize = 5;

/// Values for programs.
#[derive(Serialize)]
pub struct Told {
    /// Program time without events.
    program_time_s: f64,
    /// The most frequent reason first.
    bound: Vec<Reason>,
    /// Program times with one change.
    helps: Vec<Helps>,
    /// Advice in words.
    advice: Vec<String>,
}

#[derive(Serialize)]
struct Reason {
    by: String,
    joints: usize,
    blocks: usize,
}

#[derive(Serialize)]
struct Helps {
    limit: &'static str,
    change: &'static str,
    program_time_s: f64,
}

impl Told {
    /// The result of a run.
    pub fn new(why: &Why, machine: &Machine, program: &Program) -> Self {
        let counts = why.counts();
        let bound = counts.iter().map(|(bound, count)| Reason {
            by: bound.name(machine),
            joints: count.joints,
            blocks: count.blocks,
        });
        let helps = why.helps.iter().map(|help| Helps {
            limit: help.limit.name(),
            change: help.limit.change(),
            program_time_s: help.time_s,
        });
        Self {
            program_time_s: why.time_s,
            bound: bound.collect(),
            helps: helps.collect(),
            advice: advice(why, program),
        }
    }

    /// Text for people.
    pub fn write(&self, out: &mut String) -> std::fmt::Result {
        let (bold, dim) = (Style::new().bold(), Style::new().dimmed());
        writeln!(out)?;
        writeln!(out, "  {:<53}{dim}transitions    blocks{dim:#}", "what bound the speed")?;
        for Reason { by, joints, blocks } in self.bound.iter().take(REASONS) {
            writeln!(out, "    {by:<54}{joints:>8}{blocks:>10}")?;
        }
        if let Some(rest @ [_, ..]) = self.bound.get(REASONS..) {
            let sum = |of: fn(&Reason) -> usize| rest.iter().map(of).sum::<usize>();
            let [joints, blocks] = [sum(|reason| reason.joints), sum(|reason| reason.blocks)];
            let others = format!("{} other{}", rest.len(), plural(rest.len()));
            writeln!(out, "    {others:<54}{joints:>8}{blocks:>10}")?;
        }
        if !self.helps.is_empty() || !self.advice.is_empty() {
            let clock = clock(self.program_time_s);
            writeln!(out, "  what would make {:.3} s{clock} shorter", self.program_time_s)?;
        }
        for Helps { limit, change, program_time_s } in self.helps.iter().take(HELPS) {
            let part = (1.0 - program_time_s / self.program_time_s) * 100.0;
            writeln!(
                out,
                "    {bold}{program_time_s:>8.3} s{bold:#}{}  −{part:.1} %  {limit} {change}",
                clock(*program_time_s)
            )?;
        }
        for advice in &self.advice {
            writeln!(out, "    {advice}")?;
        }
        Ok(())
    }
}

/// The change in the program, without a change of machine data.
fn advice(why: &Why, program: &Program) -> Vec<String> {
    let motions: Vec<&Segment> = program.motions().collect();
    let mut advice = Vec::new();
    let (mut sharp, mut kept, mut rounded, mut stops) = (0, 0, 0, 0);
    for ((bound, motion), knee) in why.joints.iter().zip(&motions).zip(knees(program)) {
        match bound {
            Some(Bound::Stop | Bound::Function) => stops += 1,
            Some(Bound::Limit(..) | Bound::Corner | Bound::Several) if knee > SHARP => {
                let count = match (motion.smoothed, bound) {
                    (false, _) => &mut sharp,
                    (true, Some(Bound::Corner)) => &mut kept,
                    (true, _) => &mut rounded,
                };
                *count += 1;
            }
            _ => {}
        }
    }
    let corners =
        |count: usize| format!("{count} corner{} {}", plural(count), if count == 1 { "has" } else { "have" });
    if sharp > 0 {
        let what = "no curve: #CONTOUR MODE or #HSC rounds inside a tolerance";
        advice.push(format!("{} {what}", corners(sharp)));
    }
    if let Some(time) = why.smoothed_s.filter(|_| sharp > 0) {
        advice.push(format!("--smooth {ADVISED} rounds them: {time:.3} s{}", clock(time)));
    }
    if kept > 0 {
        let what = "no curve where smoothing is on: another method may round what this one leaves";
        advice.push(format!("{} {what}", corners(kept)));
    }
    if rounded > 0 {
        advice.push(format!("{} a curve: a larger tolerance may make it faster", corners(rounded)));
    }
    if stops > 0 {
        let what = "programmed (G60, G360, G04, functions that are waited for)";
        advice.push(format!("{stops} standstill{} {what}", plural(stops)));
    }
    advice
}

//! A spiral of short lines over a sphere with the tool normal to the surface, and a lower bound of its time
//! from the limits of the axes at each point alone.
use crate::five_axes::{Machine, universal};
use crate::operate::{Operated, operate_transformed};
use crate::properties::permitted;
use glidepath::Position;
use glidepath::kinematics::{AXES, CaHead, Kinematic, Vector};
use glidepath::machine::{AxisData, AxisKind, AxisName, ChannelData, MachineData};
use std::f64::consts::TAU;
use std::fmt::Write;

/// A job: lines of one length along a spiral about the pole of a sphere.
#[derive(Clone, Debug)]
pub struct Job {
    /// Radius of the sphere, mm.
    pub radius: f64,
    /// Length of a line, mm.
    pub step: f64,
    /// Number of lines.
    pub lines: usize,
    /// Angle from the pole where the spiral begins, and where it ends, degree.
    pub tilt: [f64; 2],
    /// Number of decimals.
    pub digits: usize,
    /// Feed, mm/min.
    pub feed: f64,
}

/// A machine of five axes and its names.
pub struct Bench {
    /// Its chain.
    pub machine: Machine,
    /// Its axes.
    pub data: MachineData<5>,
}

/// One of the machines "trunnion", "table", "head" and "mixed", with the dynamics of the example machines.
pub fn bench(name: &str, slope: u8) -> Option<Bench> {
    let (rotary, machine) = match name {
        "trunnion" => (
            ["B", "C"],
            Machine::Universal(universal(
                [4, 3, 0, 1, 2, 5],
                &[([0.0, -1.0, 0.0], [0, 0, -500_000]), ([0.0, 0.0, -1.0], [0; 3])],
            )),
        ),
        "table" => (
            ["A", "C"],
            Machine::Universal(universal(
                [4, 3, 0, 1, 2, 5],
                &[([-1.0, 0.0, 0.0], [0, 0, 500_000]), ([0.0, 0.0, -1.0], [0; 3])],
            )),
        ),
        "mixed" => (
            ["B", "C"],
            Machine::Universal(universal(
                [4, 0, 1, 2, 3, 5],
                &[([0.0, 1.0, 0.0], [0, 0, 1_000_000]), ([0.0, 0.0, -1.0], [0; 3])],
            )),
        ),
        "head" => (["C", "A"], Machine::Head(CaHead { param: [1_500_000, 800_000, 0, 0, 0, 0, 0, 0, 0] })),
        _ => return None,
    };
    let names = ["X", "Y", "Z", rotary[0], rotary[1]];
    let axes = std::array::from_fn(|k| {
        let kind = if k < 3 { AxisKind::Linear } else { AxisKind::Rotary };
        let mut axis = AxisData::new(AxisName::new(names[k]).expect("a letter"), kind);
        let ramp = if k < 3 { 150_000 } else { 60_000 };
        crate::cases::machines::accelerations(&mut axis, 2000, if k < 3 { 6000 } else { 2000 });
        crate::cases::machines::ramps(&mut axis, ramp);
        axis.tr_geom = 10_000;
        let v = if k < 3 { 1_000_000 } else { 120_000 };
        (axis.vb_max, axis.vb_eilgang) = (v, v);
        axis
    });
    let channel = ChannelData {
        cycle_us: 1000,
        slope_profile: slope,
        surface: true,
        ptp: true,
        corr_v_trans_jerk: true,
        ..ChannelData::new()
    };
    Some(Bench { machine, data: MachineData { axes, channel } })
}

impl Job {
    /// The point of the spiral at `w` lines from its start: direction from the centre.
    fn direction(&self, w: f64) -> [f64; 3] {
        // z falls evenly with the path, as nearly even as a spiral of equal lines needs.
        let [from, to] = self.tilt.map(|t| t.to_radians());
        let ring = |t: f64| t.sin();
        // Angle from the pole by the covered area, so the pitch is constant.
        let (c0, c1) = (from.cos(), to.cos());
        let share = w / self.lines as f64;
        let cos = c0 + (c1 - c0) * share;
        let tilt = cos.acos();
        // With dφ = step/(R sin θ) dw and w linear in cos θ: φ = k ∫ dw / sin θ = k·N/(c0 − c1)·(θ − θ0).
        let turn = self.step / self.radius * self.lines as f64 / (c0 - c1) * (tilt - from);
        [ring(tilt) * turn.cos(), ring(tilt) * turn.sin(), cos]
    }

    /// Tip and angles at `w` lines from the start; of several solutions, the angles nearest to `last`.
    fn pose(&self, bench: &Bench, w: f64, last: &mut [Position; 3]) -> (Vector, [Position; 3]) {
        let d = self.direction(w);
        let r = self.radius;
        let direction = Vector::new(d[0], d[1], d[2]);
        *last = bench.machine.chain().angles(direction, last).expect("a direction in reach");
        (Vector::new(r * d[0], r * d[1], r * d[2] - r), *last)
    }

    /// The program, with a command of smoothing.
    pub fn text(&self, bench: &Bench, smooth: &str) -> String {
        let mut text = String::from("N1 G90\n");
        let mut last = [Position::ZERO; 3];
        let (digits, names) = (self.digits, [3, 4].map(|k| char::from(bench.data.axes[k].name.0[0])));
        let words = |pose: (Vector, [Position; 3])| {
            let (p, a) = pose;
            let a = a.map(|a| a.to_num::<f64>());
            format!(
                "X{:.digits$} Y{:.digits$} Z{:.digits$} {}{:.digits$} {}{:.digits$}",
                p.x, p.y, p.z, names[0], a[0], names[1], a[1]
            )
        };
        for k in 0..=self.lines {
            let pose = words(self.pose(bench, k as f64, &mut last));
            let _ = match k {
                0 => {
                    let angles = &pose[pose.find(&format!(" {}", names[0])).unwrap_or(0)..];
                    writeln!(text, "G00{angles}\n#TRAFO ON\nG00 {pose}\nG04 0.1\n{smooth}")
                }
                1 => writeln!(text, "G01 {pose} F{:.0}", self.feed),
                _ => writeln!(text, "{pose}"),
            };
        }
        text + "#CONTOUR MODE OFF\n#HSC OFF\nM30\n"
    }

    /// The axes at `w` lines from the start.
    fn axes(&self, bench: &Bench, w: f64, last: &mut [Position; 3]) -> [f64; AXES] {
        let (tip, angles) = self.pose(bench, w, last);
        let axes = bench.machine.chain().inverse(tip, &angles).expect("in range");
        axes.map(|x| x.to_num::<f64>())
    }

    /// Lower bound of the time in seconds, from the limits of the axes at each point alone.
    pub fn bound(&self, bench: &Bench) -> f64 {
        let mut last = [Position::ZERO; 3];
        let (mut time, h) = (0.0, 1.0);
        let parts = self.lines;
        let limits: Vec<_> = bench
            .data
            .axes
            .iter()
            .map(|axis| permitted(axis, bench.data.channel.slope_profile, false, true, true))
            .collect();
        let rows: Vec<[f64; AXES]> =
            (0..parts + 4).map(|k| self.axes(bench, k as f64 - 1.5, &mut last)).collect();
        for w in rows.windows(4) {
            let mut v = self.feed / 60.0;
            for (k, limit) in limits.iter().enumerate() {
                let [a, b, c, d] = [w[0][k], w[1][k], w[2][k], w[3][k]];
                let s = self.step * h;
                let first = ((c - b) / s).abs();
                let second = ((d - c - b + a) / (2.0 * s * s)).abs();
                let third = ((d - 3.0 * c + 3.0 * b - a) / (s * s * s)).abs();
                v = v.min(limit.v / first).min((limit.a / second).sqrt()).min((limit.jerk / third).cbrt());
            }
            time += self.step / v;
        }
        time * parts as f64 / (parts + 1) as f64
    }
}

/// Results of a job.
#[derive(Clone, Debug)]
pub struct Shown {
    /// Seconds from the start of the first line to the end of the last.
    pub time: f64,
    /// Ticks at standstill during the lines.
    pub rest: usize,
    /// Speed over a line's length, as part of the mean speed over `NEAR` lines on each side: lowest value,
    /// and its place (lines from the start).
    pub slowest: (f64, usize),
    /// Largest distance of the tip from the sphere, mm.
    pub off: f64,
    /// The run.
    pub run: Operated,
}

/// Number of lines on each side with which a line's speed is compared.
const NEAR: usize = 20;

/// Runs a job.
///
/// # Errors
/// The error of the planner.
pub fn run(bench: &Bench, job: &Job, smooth: &str) -> Result<Shown, String> {
    let text = job.text(bench, smooth);
    let sets = [Kinematic::new(9, &bench.machine.chain(), &bench.data).map_err(|e| e.to_string())?];
    let start = [Position::ZERO; 5];
    let run = operate_transformed::<5, 120>(&text, start, &bench.data, &sets, (&[], 1_000_000), 3_000_000)?;
    Ok(shown(bench, job, run))
}

fn shown(bench: &Bench, job: &Job, run: Operated) -> Shown {
    let cycle = f64::from(bench.data.channel.cycle_us) * 1e-6;
    let tips: Vec<[f64; 3]> = (0..run.trace.len())
        .map(|tick| {
            let mut row = run.trace.row(tick);
            bench.machine.tip(&std::array::from_fn(|_| Position::from_bits(row.next().unwrap_or(0))))
        })
        .collect();
    let far = |a: &[f64; 3], b: &[f64; 3]| (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt();
    let first = job.direction(0.0).map(|x| x * job.radius);
    let start = [first[0], first[1], first[2] - job.radius];
    let grain = 2.0 * 0.1f64.powi(job.digits as i32);
    // The dwell at the start of the spiral.
    let begins = tips.windows(20).position(|w| far(&w[0], &start) < grain && w[0] == w[19]).unwrap_or(0);
    let at_rest = |k: usize| far(&tips[k], &tips[k - 1]) < 1e-8;
    let from = (begins + 1..tips.len()).find(|k| !at_rest(*k)).unwrap_or(begins);
    let to = (from + 1..tips.len()).rev().find(|k| !at_rest(*k)).unwrap_or(from);
    let rest = (from + 1..to).filter(|k| at_rest(*k)).count();
    let (mut way, mut marks, mut off) = (0.0, vec![from as f64], 0.0f64);
    for k in from..=to {
        let d = far(&tips[k], &tips[k - 1]);
        while way + d >= job.step * marks.len() as f64 {
            let share = (job.step * marks.len() as f64 - way) / d;
            marks.push(k as f64 - 1.0 + share);
        }
        way += d;
        let [x, y, z] = tips[k];
        off = off.max(((x * x + y * y + (z + job.radius).powi(2)).sqrt() - job.radius).abs());
    }
    let times: Vec<f64> = marks.windows(2).map(|w| w[1] - w[0]).collect();
    let mut slowest = (f64::INFINITY, 0);
    for k in 2 * NEAR..times.len().saturating_sub(2 * NEAR) {
        let around = &times[k - NEAR..=k + NEAR];
        let mut sorted = around.to_vec();
        sorted.sort_by(f64::total_cmp);
        let part = sorted[NEAR] / times[k];
        if part < slowest.0 {
            slowest = (part, k);
        }
    }
    Shown { time: (to - from + 1) as f64 * cycle, rest, slowest, off, run }
}

/// Limits of every axis at every tick.
///
/// # Errors
/// The first excess.
pub fn keeps_limits(bench: &Bench, run: &Operated) -> Result<(), String> {
    let slope = bench.data.channel.slope_profile;
    let limits: Vec<_> =
        bench.data.axes.iter().map(|axis| permitted(axis, slope, true, true, true)).collect();
    crate::check::limits(&run.trace, &limits).map(|_| ())
}

/// Lower bound of the time in seconds for the path of a run, from the limits of the axes at each point alone.
/// `slow` is a run at a small feed (mm/min), and `feed` is the intended feed.
pub fn bound_of(bench: &Bench, slow: (&Operated, f64), feed: f64) -> f64 {
    let (slow, slowly) = slow;
    let per_tick = slowly / 60.0 * f64::from(bench.data.channel.cycle_us) * 1e-6;
    let limits: Vec<_> = bench
        .data
        .axes
        .iter()
        .map(|axis| permitted(axis, bench.data.channel.slope_profile, false, true, true))
        .collect();
    let mut time = 0.0;
    let way = |tick: usize| slow.distances[tick] as f64 / (1u64 << 44) as f64;
    for tick in 3..slow.trace.len() {
        let s = (way(tick) - way(tick - 3)) / 3.0;
        // Without the motion to the start and its ramps.
        if (s / per_tick - 1.0).abs() > 0.01 {
            continue;
        }
        let (mut v, row) = (feed / 60.0, |tick: usize| slow.trace.mm(tick));
        let (a, b, c, d) = (row(tick - 3), row(tick - 2), row(tick - 1), row(tick));
        for (k, limit) in limits.iter().enumerate() {
            let first = ((c[k] - b[k]) / s).abs();
            let second = ((d[k] - c[k] - b[k] + a[k]) / (2.0 * s * s)).abs();
            let third = ((d[k] - 3.0 * c[k] + 3.0 * b[k] - a[k]) / (s * s * s)).abs();
            v = v.min(limit.v / first).min((limit.a / second).sqrt()).min((limit.jerk / third).cbrt());
        }
        time += s / v;
    }
    time
}

/// Turns of the spiral.
pub fn turns(job: &Job) -> f64 {
    let [from, to] = job.tilt.map(|t| t.to_radians());
    job.step / job.radius * job.lines as f64 / (from.cos() - to.cos()) * (to - from) / TAU
}

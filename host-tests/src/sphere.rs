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

/// Limits of each axis: inside a straight motion, and with the geometric ramp time in curves.
fn both_limits(bench: &Bench) -> Vec<[crate::check::Limits; 2]> {
    let slope = bench.data.channel.slope_profile;
    let of = |axis| [false, true].map(|curved| permitted(axis, slope, false, true, curved));
    bench.data.axes.iter().map(of).collect()
}

/// Seconds for a straight part of `way` mm between two corners with the speed `slow`: the speed rises up to
/// `fast` with the path jerk `jerk`, and falls again.
fn between_corners(way: f64, slow: f64, fast: f64, jerk: f64) -> f64 {
    if fast <= slow {
        return way / fast.max(1e-9);
    }
    let ramp = |gain: f64| 2.0 * (gain / jerk).sqrt();
    let far = |gain: f64| (2.0 * slow + gain) * ramp(gain);
    let (mut low, mut high) = (0.0, fast - slow);
    if far(high) <= way {
        return 2.0 * ramp(high) + (way - far(high)) / fast;
    }
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if far(middle) <= way { low = middle } else { high = middle }
    }
    2.0 * ramp(low) + (way - far(low)) / (slow + low)
}

impl Job {
    /// Time in seconds of the quickest row of smoothing curves whose tip stays within `path_dev` mm of the
    /// lines. Each corner has one curve of triangular curvature, and its polygon lies `path_dev` outside the
    /// corner, so the curve cuts 2·`path_dev`: for the turn θ the half width is 12·`path_dev`/θ, at most a
    /// line. The corner is passed at one speed with the whole jerk of each axis. Between two corners the speed
    /// rises as far as the jerk of the slope permits. A corner whose curve over both lines lies within `path_dev` counts
    /// as smooth. Where the row permits more than the sphere itself
    /// ([`Job::bound`]), the sphere binds.
    pub fn rounded_bound(&self, bench: &Bench, path_dev: f64) -> f64 {
        let mut last = [Position::ZERO; 3];
        let poses: Vec<_> =
            (0..self.lines + 3).map(|k| self.pose(bench, k as f64 - 1.0, &mut last)).collect();
        let chain = bench.machine.chain();
        let limits = both_limits(bench);
        let at = |line: usize, share: f64| -> [f64; AXES] {
            let ((p, a), (q, b)) = (&poses[line], &poses[line + 1]);
            let mix = |x: f64, y: f64| x + (y - x) * share;
            let tip = Vector::new(mix(p.x, q.x), mix(p.y, q.y), mix(p.z, q.z));
            let angles: [Position; 3] =
                std::array::from_fn(|k| Position::from_num(mix(a[k].to_num::<f64>(), b[k].to_num::<f64>())));
            chain.inverse(tip, &angles).expect("in range").map(|x| x.to_num::<f64>())
        };
        let length = |line: usize| {
            let ((p, _), (q, _)) = (&poses[line], &poses[line + 1]);
            ((q.x - p.x).powi(2) + (q.y - p.y).powi(2) + (q.z - p.z).powi(2)).sqrt()
        };
        let heading = |line: usize| {
            let ((p, _), (q, _)) = (&poses[line], &poses[line + 1]);
            [q.x - p.x, q.y - p.y, q.z - p.z].map(|x| x / length(line))
        };
        let feed = self.feed / 60.0;
        // The corner at the start of a line: half width and speed.
        let corner = |line: usize| {
            let (before, after) = (heading(line - 1), heading(line));
            let turn = (0..3).map(|k| (after[k] - before[k]).powi(2)).sum::<f64>().sqrt();
            let width = (12.0 * path_dev / turn.max(1e-12)).min(length(line - 1)).min(length(line));
            let h = 1.0 / 1024.0;
            let (a, b, c) = (at(line - 1, 1.0 - h), at(line, 0.0), at(line, h));
            let mut v = feed;
            if 0.125 * turn * length(line - 1).max(length(line)) <= path_dev {
                return (0.0, v);
            }
            for (k, [_, limit]) in limits.iter().enumerate() {
                let d = (c[k] - b[k]) / (h * length(line)) - (b[k] - a[k]) / (h * length(line - 1));
                let d = d.abs().max(1e-12);
                v = v.min((limit.a * width / d).sqrt()).min((limit.jerk * width * width / d).cbrt());
            }
            (width, v)
        };
        let mut time = 0.0;
        for line in 1..=self.lines {
            let (first, last) = (corner(line), corner(line + 1));
            let l = length(line);
            let h = 0.125;
            let x: Vec<_> = (0..4).map(|k| at(line, 0.5 + (f64::from(k) - 1.5) * h)).collect();
            let (mut fast, mut jerk) = (feed, f64::INFINITY);
            for (k, [along, limit]) in limits.iter().enumerate() {
                let s = h * l;
                let [a, b, c, d] = [x[0][k], x[1][k], x[2][k], x[3][k]];
                let slope = ((c - b) / s).abs().max(1e-12);
                let second = ((d - c - b + a) / (2.0 * s * s)).abs();
                let third = ((d - 3.0 * c + 3.0 * b - a) / (s * s * s)).abs();
                fast =
                    fast.min(limit.v / slope).min((limit.a / second).sqrt()).min((limit.jerk / third).cbrt());
                jerk = jerk.min(along.jerk / slope);
            }
            let curved = (first.0 + last.0).min(l);
            let v = first.1.min(last.1).min(fast);
            time += curved / v + between_corners(l - curved, v, fast, jerk);
        }
        time.max(self.bound(bench))
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

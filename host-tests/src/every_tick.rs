//! One disturbance before each tick of a program: a planner without processor time, or a feed hold. The
//! checker checks every tick of each run.
//!
//! A [`Case`] is a path in one form of contour mode, and a [`Slope`] is its speed profile. [`Track::new`]
//! runs the path without a disturbance, and also at a low override, so slowly that the set points show the
//! path. [`Track::disturb`] runs the path again with one disturbance and checks:
//!
//! - speed, acceleration and jerk of every axis at every tick, so that no set point jumps;
//! - the path distance never goes back, and each set point lies on the path of the slow run;
//! - the motion ends exactly at the end, with the same path distance, and the planner reports at most once
//!   that it was late;
//! - a stall and a hold both lead to a standstill.
//!
//! The duration of a feed hold is compared with the closed form, [`Stop`].
use crate::calls::call;
use crate::check::{self, Limits};
use crate::reference::profile::Ramps;
use crate::reference::stop::Stop;
use crate::trace::Trace;
use glidepath::channel::{Channel, Handles, Progress};
use glidepath::machine::{AxisData, AxisKind, AxisName, ChannelData, MachineData};
use glidepath::quantity::Position;
use glidepath::tick::State;
use std::fmt::Write;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Speed of every axis, mm/s and degrees/s.
const V: f64 = 1000.0;
/// Acceleration of every axis, mm/s² and degrees/s².
const A: f64 = 2000.0;
/// Every ramp time, and the geometric one, s.
const RAMP: f64 = 0.15;
const RAMP_GEOMETRIC: f64 = 0.01;
/// Decelerations of STEP below and above its change-over speed, and that speed.
const STAGES: [f64; 2] = [2000.0, 1200.0];
const CHANGE_OVER: f64 = 250.0;
/// Seconds per tick.
const CYCLE: f64 = 0.001;

/// Highest travel of the rotary axis per millimetre of path, degrees.
const STEEPEST: f64 = 16.0;

/// Number of ticks at standstill after which only the planner can continue the motion.
const STANDS: usize = 3;

/// Ticks from a command to the first tick that differs: the next call reads the command, and it acts four
/// ticks later.
pub const REACTION: usize = 5;

/// Number of ticks of a changed override.
const SLOWER: usize = 150;

/// Highest number of ticks of a run.
const LONGEST: usize = 200_000;

/// A slope.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Slope {
    /// As `#SLOPE` names it.
    pub word: &'static str,
    /// P-CHAN-00071.
    pub number: u8,
}

/// The slopes. HSC with NO_OPT=0 has the name HSC0.
pub const SLOPES: [(&str, Slope); 5] = [
    ("TRAPEZ", Slope { word: "TRAPEZ", number: 1 }),
    ("SIN2", Slope { word: "SIN2", number: 2 }),
    ("HSC", Slope { word: "HSC", number: 3 }),
    ("STEP", Slope { word: "STEP", number: 0 }),
    ("HSC0", Slope { word: "HSC NO_OPT=0", number: 3 }),
];

/// A path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Path {
    /// Chords of this many µm along a curve, at F6000.
    Chords(u32),
    /// Corners of many angles.
    Corners,
    /// Arcs and lines with tangential and other transitions.
    Arcs,
    /// Lines with a rotary axis, which also moves alone.
    Rotary,
    /// Circles of several turns, whole and in halves, with lines between.
    Circles,
}

/// A path in one form of contour mode.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Case {
    /// Name for the command line and messages.
    pub name: &'static str,
    /// The path.
    pub path: Path,
    /// Parameters of `#CONTOUR MODE` or `#HSC`; empty: off.
    pub contour: &'static str,
}

const fn case(name: &'static str, path: Path, contour: &'static str) -> Case {
    Case { name, path, contour }
}

/// Paths with contour mode off and on, with curves over length and over time.
pub const CASES: [Case; 18] = [
    case("chords", Path::Chords(280), ""),
    case("chords-dev", Path::Chords(280), "DEV PATH_DEV=0.02"),
    case("chords-ptp", Path::Chords(280), "PTP PATH_DEV=0.02"),
    case("corners", Path::Corners, ""),
    case("corners-dev", Path::Corners, "DEV PATH_DEV=0.1"),
    case("corners-ptp", Path::Corners, "PTP PATH_DEV=0.1"),
    case("corners-soft", Path::Corners, "DIST_SOFT PATH_DIST=1"),
    case("arcs", Path::Arcs, ""),
    case("circles", Path::Circles, ""),
    case("arcs-dev", Path::Arcs, "DEV PATH_DEV=0.05"),
    case("rotary", Path::Rotary, ""),
    case("rotary-dev", Path::Rotary, "DEV PATH_DEV=0.1 TRACK_DEV=0.5"),
    case("rotary-soft", Path::Rotary, "DIST_SOFT PATH_DIST=1"),
    case("mm-dev", Path::Chords(1000), "DEV PATH_DEV=0.02"),
    case("mm-soft", Path::Chords(1000), "DIST_SOFT PATH_DIST=0.5"),
    case("chords-surface", Path::Chords(280), "SURFACE PATH_DEV=0.02"),
    case("corners-surface", Path::Corners, "SURFACE PATH_DEV=0.1"),
    case("rotary-surface", Path::Rotary, "SURFACE PATH_DEV=0.1 TRACK_DEV=0.5"),
];

impl Case {
    /// The case of this name.
    pub fn named(name: &str) -> Option<Self> {
        CASES.into_iter().find(|case| case.name == name)
    }

    /// Axes of its machine.
    pub fn axes(&self) -> usize {
        if self.path == Path::Rotary { 4 } else { 3 }
    }

    /// Its program with a slope and this number of blocks.
    pub fn text(&self, slope: Slope, blocks: usize) -> String {
        let mut text = format!("%{}\n#SLOPE [TYPE={}]\nG90\n", self.name, slope.word);
        let hsc = self.contour.starts_with("SURFACE");
        if hsc {
            let _ = writeln!(text, "#HSC ON [{}]", self.contour);
        } else if !self.contour.is_empty() {
            let _ = writeln!(text, "#CONTOUR MODE [{}]\nG261", self.contour);
        }
        self.path.write(&mut text, blocks);
        if hsc {
            text.push_str("#HSC OFF\n");
        } else if !self.contour.is_empty() {
            text.push_str("G260\n");
        }
        text + "M30\n"
    }
}

impl Path {
    /// Number of blocks of a program that is longer than queue and look-ahead.
    pub fn blocks(self) -> usize {
        match self {
            Self::Chords(_) => 300,
            Self::Corners => 24,
            Self::Arcs => 24,
            Self::Rotary => 24,
            Self::Circles => 18,
        }
    }

    /// Blocks of look-ahead.
    fn look_ahead(self) -> u32 {
        if matches!(self, Self::Chords(_)) { 120 } else { 10 }
    }

    fn write(self, text: &mut String, blocks: usize) {
        match self {
            Self::Chords(um) => {
                text.push_str("G01 F6000\n");
                // Equally along a curve that bends to both sides, with radii of at least 2 m, once 100 mm.
                let (mut x, mut y, mut turn) = (0.0_f64, 0.0_f64, 0.0_f64);
                let chord = f64::from(um) * 1e-3;
                for k in 0..blocks {
                    let radius = if (200..220).contains(&k) { 100.0 } else { 2000.0 };
                    turn += chord / radius * (k as f64 * 0.05).cos();
                    (x, y) = (x + chord * turn.cos(), y + chord * turn.sin());
                    let z = 0.05 * (k as f64 * 0.01).sin();
                    let _ = writeln!(text, "N{} X{x:.4} Y{y:.4} Z{z:.4}", 10 * k + 10);
                }
            }
            Self::Corners => {
                let (mut x, mut y, mut turn) = (0.0_f64, 0.0_f64, 0.0_f64);
                for k in 0..blocks {
                    let length = [6.0, 2.5, 9.0, 4.0, 1.5][k % 5];
                    turn += [30.0_f64, -90.0, 135.0, 10.0, -45.0, 3.0, 60.0][k % 7].to_radians();
                    (x, y) = (x + length * turn.cos(), y + length * turn.sin());
                    let feed = [12_000, 6000, 9000][k % 3];
                    let _ = writeln!(text, "N{} G01 X{x:.4} Y{y:.4} Z{} F{feed}", 10 * k + 10, k % 2);
                }
            }
            Self::Arcs => {
                let mut x = 0.0_f64;
                for k in 0..blocks / 3 {
                    let radius = [2.0, 3.5, 1.25][k % 3];
                    let feed = [9000, 6000][k % 2];
                    let word = ["G02", "G03"][k % 2];
                    // A line, a half circle that begins at a right angle or continues tangentially, and
                    // another line.
                    let _ = writeln!(text, "N{} G01 X{:.3} Y{} F{feed}", 30 * k + 10, x + 4.0, k % 2);
                    let _ =
                        writeln!(text, "N{} {word} X{:.3} I{radius}", 30 * k + 20, x + 4.0 + 2.0 * radius);
                    let _ = writeln!(text, "N{} G01 Y{:.3}", 30 * k + 30, [-5.0, 4.0][k % 2]);
                    x += 4.0 + 2.0 * radius;
                }
            }
            Self::Circles => {
                let mut x = 0.0_f64;
                for k in 0..blocks / 6 {
                    let (n, radius, feed) = (60 * k, [1.0, 3.0, 0.6][k % 3], [20_000, 9000][k % 2]);
                    let word = ["G02", "G03"][k % 2];
                    x += 4.0;
                    let _ = writeln!(text, "N{} G01 X{x} F{feed}", n + 10);
                    // Two and three turns, each followed by a half turn.
                    for turn in 0..2 + k % 2 {
                        let _ = writeln!(text, "N{} {word} X{x} I{radius} F{feed}", n + 20 + 10 * turn);
                    }
                    for half in 0..3 {
                        let centre = if half % 2 == 0 { radius } else { -radius };
                        x += 2.0 * centre;
                        let _ = writeln!(text, "N{} {word} X{x:.3} I{centre}", n + 50 + 3 * half);
                    }
                }
            }
            Self::Rotary => {
                let mut x = 0.0_f64;
                for k in 0..blocks {
                    if k % 6 == 5 {
                        let _ = writeln!(text, "N{} G01 A{} F6000", 10 * k + 10, 6 * k);
                        continue;
                    }
                    x += [5.0, 3.0, 8.0][k % 3];
                    let y = [0.0, 1.0, 2.5, -1.0][k % 4];
                    let turn = 6 * k as i32 + [5, -20, 40][k % 3];
                    let _ = writeln!(text, "N{} G01 X{x} Y{y} A{turn} F9000", 10 * k + 10);
                }
            }
        }
    }
}

/// The machine of all cases.
pub fn machine<const AXES: usize>(case: Case, slope: Slope) -> MachineData<AXES> {
    let [v, a] = [V * 1e3, A].map(|x| x as u32);
    let [ramp, geometric] = [RAMP, RAMP_GEOMETRIC].map(|s| (s * 1e6) as u32);
    let axes = std::array::from_fn(|k| {
        let kind = if k < 3 { AxisKind::Linear } else { AxisKind::Rotary };
        let mut axis = AxisData::new(AxisName::new(["X", "Y", "Z", "A"][k % 4]).expect("a letter"), kind);
        (axis.vb_max, axis.vb_eilgang) = (v, v);
        axis.a_max = a;
        (axis.a_beschl, axis.a_brems, axis.a_grenz) = (a, a, a);
        (axis.tr_beschl_zu, axis.tr_beschl_ab, axis.tr_brems_zu, axis.tr_brems_ab) = (ramp, ramp, ramp, ramp);
        (axis.tr_grenz, axis.tr_geom) = (ramp, geometric);
        axis.a_stufe = STAGES.map(|a| a as u32);
        axis.vb_stufe_1_2 = (CHANGE_OVER * 1e3) as u32;
        axis
    });
    let channel = ChannelData {
        cycle_us: (CYCLE * 1e6) as u32,
        slope_profile: slope.number,
        look_ahead: case.path.look_ahead(),
        // A step of acceleration at a transition is not permitted, so the jerk is limited everywhere.
        corr_v_trans_jerk: true,
        ptp: true,
        surface: true,
        ..ChannelData::new()
    };
    MachineData { axes, channel }
}

/// Limits of every axis. The ramps of the slope are longer than the geometric one, by more than π/2.
fn limits(slope: Slope, axes: usize) -> Vec<Limits> {
    let jerk = if slope.number == 0 { f64::INFINITY } else { A / RAMP_GEOMETRIC };
    vec![Limits { v: V, a: A, jerk }; axes]
}

/// The disturbance before a tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Disturbance {
    /// Nothing.
    None,
    /// The planner gets no processor time until the motion stands still.
    Stall,
    /// The planner gets no processor time for this number of ticks.
    ShortStall(usize),
    /// A feed hold, until the motion stands still.
    Hold,
    /// An override for the whole run, 0.1 %.
    Override(u16),
    /// Another override for 150 ticks, 0.1 %; then 100 % again.
    Slower(u16),
}

/// A run.
#[derive(Clone, Debug, Default)]
pub struct Run {
    /// Set points of all ticks, including standstill.
    pub trace: Trace,
    /// Path distance after each of them, LSB 2^-44 mm.
    pub distances: Vec<i64>,
    /// Tick after which the motion stood still, for a stall or hold.
    pub stood: Option<usize>,
    /// How often the planner reported that it was late.
    pub late: usize,
}

/// Runs a text with a disturbance before tick `at`. The planner is called until it has nothing to do.
///
/// # Errors
/// The library's refusal, or a motion that does not end.
pub fn run<const AXES: usize>(
    text: &str,
    machine: &MachineData<AXES>,
    at: usize,
    disturbance: Disturbance,
) -> Result<Run, String> {
    let mut channel: Box<Channel<AXES, 120>> = Box::new(Channel::new());
    let start = [Position::ZERO; AXES];
    let Handles { mut planner, mut interpolator, operator } =
        channel.split(machine, start, text.as_bytes()).map_err(|e| e.to_string())?;
    let mut run = Run { trace: Trace::empty(CYCLE, AXES), ..Run::default() };
    let (mut idle, mut over) = (0, disturbance == Disturbance::None);
    for tick in 0..LONGEST {
        let mut stalled = false;
        match disturbance {
            Disturbance::Override(factor) if tick == 0 => operator.set_override(factor),
            Disturbance::Slower(factor) if tick == at => operator.set_override(factor),
            Disturbance::Slower(_) if tick == at + SLOWER => operator.set_override(1000),
            Disturbance::Hold if tick == at => operator.feed_hold(),
            Disturbance::Hold if tick > at && !over && planner.is_holding() && idle >= STANDS => {
                run.stood = Some((tick - 1).saturating_sub(idle));
                operator.resume();
                over = true;
            }
            Disturbance::Stall if tick >= at && !over => {
                stalled = tick < at + STANDS || idle < STANDS;
                over = !stalled;
                run.stood = over.then(|| (tick - 1).saturating_sub(idle));
            }
            Disturbance::ShortStall(ticks) => stalled = (at..at + ticks).contains(&tick),
            _ => {}
        }
        let most = if stalled { 0 } else { usize::MAX };
        let done = call(&mut planner, most, |progress| run.late += usize::from(progress == Progress::Late))
            .map_err(|e| format!("tick {tick}: {e:?}"))?;
        let state = interpolator.tick();
        idle = if state == State::Idle { idle + 1 } else { 0 };
        run.trace.push(interpolator.set_points().iter().map(|p| p.to_bits()));
        run.distances.push(interpolator.telemetry().distance.to_bits());
        if done && state == State::Idle {
            return Ok(run);
        }
    }
    Err(format!("does not end within {LONGEST} ticks"))
}

/// A case with a slope, undisturbed, and its path.
pub struct Track<const AXES: usize> {
    /// Case and slope.
    pub name: String,
    /// Its program.
    pub text: String,
    machine: MachineData<AXES>,
    limits: Vec<Limits>,
    slope: Slope,
    /// The run without a disturbance.
    pub plain: Run,
    /// A run that is so slow that its set points show the path.
    scan: Run,
    /// The path, from that.
    places: Vec<Place<AXES>>,
}

/// A place of the path: travel of every axis per millimetre of path, and the change of this travel.
struct Place<const AXES: usize> {
    /// Path distance, mm.
    s: f64,
    per_mm: [f64; AXES],
    change: [f64; AXES],
}

/// Smallest path distance between two places, mm: rounding of set points is far less.
const APART: f64 = 0.002;

/// The places of a run.
fn places<const AXES: usize>(run: &Run) -> Vec<Place<AXES>> {
    let s = |row: usize| (run.distances[row] - run.distances[0]) as f64 / 2.0_f64.powi(44);
    let mut rows = vec![0];
    for row in 1..run.distances.len() {
        if s(row) - s(rows[rows.len() - 1]) >= APART {
            rows.push(row);
        }
    }
    let mut places: Vec<Place<AXES>> = Vec::new();
    for pair in rows.windows(2) {
        let length = s(pair[1]) - s(pair[0]);
        let column = |k: usize| &run.trace.columns[k];
        let per_mm: [f64; AXES] = std::array::from_fn(|k| {
            (column(k)[pair[1]] - column(k)[pair[0]]) as f64 / (1u64 << 32) as f64 / length
        });
        let change = places.last().map_or([0.0; AXES], |before| {
            std::array::from_fn(|k| (per_mm[k] - before.per_mm[k]) / (s(pair[1]) - before.s) * 2.0)
        });
        places.push(Place { s: s(pair[0]), per_mm, change });
    }
    places
}

/// Duration and distance of a feed hold, and the closed form: the planned motion for [`REACTION`] ticks, then
/// the shortest stop.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Held {
    /// The tick of the command.
    pub tick: usize,
    /// Speed, mm/s, and acceleration, mm/s², when the command acts.
    pub motion: [f64; 2],
    /// Measured time and distance: s and mm.
    pub seen: Stop,
    /// The closed form.
    pub wanted: Stop,
}

impl Held {
    /// Measured value divided by the closed form. One tick and 10 µm are not counted.
    pub fn ratios(&self) -> [f64; 2] {
        let ratio = |seen: f64, wanted: f64, free: f64| (seen - free).max(0.0) / wanted.max(free);
        [ratio(self.seen.time, self.wanted.time, CYCLE), ratio(self.seen.way, self.wanted.way, 0.01)]
    }
}

impl<const AXES: usize> Track<AXES> {
    /// Runs and checks a program with this number of blocks, once normally and once slowly.
    ///
    /// # Errors
    /// The fault.
    pub fn new(case: Case, slope: Slope, blocks: usize) -> Result<Self, String> {
        let name = format!("{} with {}", case.name, slope.word);
        let (text, machine) = (case.text(slope, blocks), machine::<AXES>(case, slope));
        let fault = |what: String| format!("{name}: {what}");
        let plain = run(&text, &machine, 0, Disturbance::None).map_err(fault)?;
        let scan = run(&text, &machine, 0, Disturbance::Override(50)).map_err(fault)?;
        let (limits, places) = (limits(slope, AXES), places(&scan));
        let track = Self { text, machine, limits, slope, plain, scan, places, name: name.clone() };
        track.judge(&track.plain).map_err(fault)?;
        track.judge(&track.scan).map_err(fault)?;
        Ok(track)
    }

    /// Ticks of motion.
    pub fn ticks(&self) -> usize {
        self.plain.distances.len()
    }

    /// Runs it with a disturbance before tick `at` and judges it.
    ///
    /// # Errors
    /// The first fault.
    pub fn disturb(&self, at: usize, disturbance: Disturbance) -> Result<Run, String> {
        let run = run(&self.text, &self.machine, at, disturbance)?;
        self.judge(&run)?;
        if run.stood.is_none() && matches!(disturbance, Disturbance::Stall | Disturbance::Hold) {
            // A hold after the last motion stops no axis.
            if at + STANDS + REACTION < self.ticks() {
                return Err("does not stand".to_owned());
            }
        }
        Ok(run)
    }

    /// Limits, path, order and end.
    ///
    /// # Errors
    /// The first fault.
    pub fn judge(&self, run: &Run) -> Result<(), String> {
        check::limits(&run.trace, &self.limits)?;
        if let Some(tick) = run.distances.windows(2).position(|w| w[1] < w[0]) {
            return Err(format!("goes back at tick {tick}"));
        }
        if run.late > 1 {
            return Err(format!("says {} times that it is late", run.late));
        }
        let last = |run: &Run| {
            (run.distances.last().copied(), run.trace.row(run.trace.len() - 1).collect::<Vec<_>>())
        };
        let [seen, wanted] = [run, &self.plain].map(last);
        if seen != wanted {
            return Err(format!("ends at {seen:?}, not at {wanted:?}"));
        }
        // Both runs move forward, so the place on the path is found by following it.
        let (scan, mut next) = (&self.scan, 0);
        for tick in 0..run.distances.len() {
            let at = run.distances[tick];
            while scan.distances[next] < at && next + 1 < scan.distances.len() {
                next += 1;
            }
            let before = next.saturating_sub(1);
            let [from, to] = [before, next].map(|row| scan.distances[row]);
            let part = if to > from { (at - from) as f64 / (to - from) as f64 } else { 1.0 };
            let off: f64 = (0..AXES)
                .map(|k| {
                    let [a, b, x] = [
                        scan.trace.columns[k][before],
                        scan.trace.columns[k][next],
                        run.trace.columns[k][tick],
                    ];
                    let off = (x - a) as f64 - (b - a) as f64 * part;
                    off * off
                })
                .sum::<f64>()
                .sqrt()
                / (1u64 << 32) as f64;
            // No further than from one point of the slow run to the next.
            let apart = (to - from) as f64 / 2.0_f64.powi(44) * if AXES > 3 { STEEPEST } else { 1.0 };
            if off > apart + 1e-6 {
                return Err(format!("tick {tick}: {off} mm off the path, {apart} at most"));
            }
        }
        Ok(())
    }

    /// Path distance in the tick after a row, mm. In a curve over time the axes slow down and turn while the
    /// path continues evenly; a stop must brake the path.
    fn step(&self, run: &Run, row: usize) -> f64 {
        let next = (row + 1).min(run.distances.len() - 1);
        (run.distances[next] - run.distances[row]) as f64 / 2.0_f64.powi(44)
    }

    /// Distance of the main axes in the tick after a row, mm; of the other axes if the main axes stand still.
    fn length(&self, row: usize) -> f64 {
        let length = |axes: std::ops::Range<usize>| -> f64 {
            let columns = &self.plain.trace.columns[axes];
            let x = columns.iter().map(|x| (x[row + 1] - x[row]) as f64);
            x.map(|x| x * x).sum::<f64>().sqrt() / (1u64 << 32) as f64
        };
        let main = length(0..3);
        if main > 0.0 { main } else { length(3..AXES.max(3)) }
    }

    /// With STEP, the shortest stop from a path distance and a speed. Each place and speed uses the full
    /// deceleration that the curve leaves to every axis, a ≥ |x′·a + x″·v²|.
    fn shortest_with_steps(&self, from: i64, v: f64) -> Stop {
        let from = (from - self.scan.distances[0]) as f64 / 2.0_f64.powi(44);
        let first = self.places.partition_point(|place| place.s <= from).saturating_sub(1);
        let (mut squared, mut at, mut stop) = (v * v, from, Stop::default());
        for pair in self.places[first..].windows(2) {
            if squared < 1e-9 {
                break;
            }
            let (place, end) = (&pair[0], pair[1].s);
            let most = STAGES[usize::from(squared.sqrt() > CHANGE_OVER)];
            let decel = (0..AXES)
                .map(|k| (most - place.change[k].abs() * squared).max(0.0) / place.per_mm[k].abs())
                .fold(f64::INFINITY, f64::min);
            let way = (squared / (2.0 * decel)).min(end - at);
            let next = (squared - 2.0 * decel * way).max(0.0);
            stop.way += way;
            stop.time += 2.0 * way / (squared.sqrt() + next.sqrt());
            (squared, at) = (next, end);
        }
        stop
    }

    /// The shortest stop from the motion at a row. The limits of the path are those of the axis with the
    /// largest share, up to the end of the stop.
    fn shortest(&self, row: usize, v: f64, a: f64) -> Stop {
        if self.slope.number == 0 {
            return self.shortest_with_steps(self.plain.distances[row], v);
        }
        let (mut share, mut gone) = (0.0_f64, 0.0);
        let mut stop = Stop::default();
        for row in row..self.ticks() - 1 {
            let step = self.step(&self.plain, row);
            let most = self.plain.trace.columns.iter().map(|x| (x[row + 1] - x[row]).unsigned_abs()).max();
            let length = self.length(row);
            // Less than a nanometre has no direction.
            if length > 1e-6 {
                let part = most.unwrap_or(0) as f64 / (1u64 << 32) as f64 / length;
                if part > share {
                    share = part;
                    let ramps = Ramps { a: A / share, up: RAMP, down: RAMP };
                    stop = Stop::with_jerk(v, a, ramps, ramps);
                }
            }
            gone += step;
            if gone > stop.way {
                break;
            }
        }
        stop
    }

    /// Duration and distance of a hold before tick `at`, if the hold stopped a motion.
    pub fn held(&self, run: &Run, at: usize) -> Option<Held> {
        let (at, stood) = (at.max(1), run.stood?);
        // Between the rows: the command comes at a tick, and acts a few ticks later.
        let before = at - 1;
        let acts = (before + REACTION).min(self.ticks() - 2);
        let [v, next] = [acts, acts + 1].map(|row| self.step(&self.plain, row) / CYCLE);
        let a = (next - v) / CYCLE;
        let way = |run: &Run, rows: std::ops::Range<usize>| rows.map(|row| self.step(run, row)).sum::<f64>();
        let seen = Stop {
            time: stood.saturating_sub(before) as f64 * CYCLE,
            way: way(run, before..stood.max(before)),
        };
        let stop = self.shortest(acts, v, a);
        let wanted = Stop {
            time: stop.time + (acts - before) as f64 * CYCLE,
            way: stop.way + way(&self.plain, before..acts),
        };
        Some(Held { tick: at, motion: [v, a], seen, wanted })
    }
}

/// Results of a track with disturbances before many ticks.
#[derive(Clone, Debug, Default)]
pub struct Report {
    /// Ticks tried.
    pub tried: usize,
    /// Faults, with their ticks.
    pub faults: Vec<(usize, String)>,
    /// Durations and distances of all holds.
    pub holds: Vec<Held>,
    /// Highest part of its limits of speed, acceleration and jerk that an axis used.
    pub used: [f64; 3],
}

impl Report {
    /// The hold with the largest ratio, of time or way.
    pub fn worst(&self, which: usize) -> Option<&Held> {
        self.holds.iter().max_by(|a, b| a.ratios()[which].total_cmp(&b.ratios()[which]))
    }

    /// The ratio that this part of all holds does not exceed.
    pub fn quantile(&self, which: usize, part: f64) -> f64 {
        let mut all: Vec<f64> = self.holds.iter().map(|held| held.ratios()[which]).collect();
        all.sort_by(f64::total_cmp);
        all.get(((all.len() as f64 * part) as usize).min(all.len().saturating_sub(1))).copied().unwrap_or(0.0)
    }
}

/// Disturbs a track before all of these ticks, in two threads.
pub fn disturb_all<const AXES: usize>(
    track: &Track<AXES>,
    ticks: impl Iterator<Item = usize>,
    disturbance: Disturbance,
) -> Report {
    let ticks: Vec<usize> = ticks.collect();
    let (next, all) = (AtomicUsize::new(0), Mutex::new(Report::default()));
    let work = || {
        while let Some(&at) = ticks.get(next.fetch_add(1, Ordering::Relaxed)) {
            let verdict = track.disturb(at, disturbance);
            let held = match (&verdict, disturbance) {
                (Ok(run), Disturbance::Hold) => track.held(run, at),
                _ => None,
            };
            let used = verdict.as_ref().map_or([0.0; 3], |run| track.used(run));
            let mut all = all.lock().expect("no panic elsewhere");
            all.tried += 1;
            all.used = std::array::from_fn(|k| all.used[k].max(used[k]));
            all.holds.extend(held);
            all.faults.extend(verdict.err().map(|fault| (at, fault)));
        }
    };
    std::thread::scope(|scope| {
        for _ in 0..2 {
            scope.spawn(work);
        }
    });
    let mut report = all.into_inner().expect("no panic");
    report.faults.sort_by_key(|(at, _)| *at);
    report.holds.sort_by_key(|held| held.tick);
    report
}

impl<const AXES: usize> Track<AXES> {
    /// Highest part of its limits of speed, acceleration and jerk that an axis uses.
    fn used(&self, run: &Run) -> [f64; 3] {
        let mut used = [0.0_f64; 3];
        for (column, limit) in run.trace.columns.iter().zip(&self.limits) {
            let values = check::peaks(column, CYCLE).values;
            for ((used, value), limit) in used.iter_mut().zip(values).zip([limit.v, limit.a, limit.jerk]) {
                *used = used.max(value / limit);
            }
        }
        used
    }
}

//! The example programs of ISG's documents, run as files: the expected result or refusal of each, with three
//! slopes at the start.
//!
//! The programs are in `../shared/spec/programs` next to the repository, or in `spec/programs` of the folder
//! in the variable GLIDEPATH_SHARED. If they are missing, the test prints this and checks nothing. If there
//! is a Python with numpy (`python3`, or the variable PYTHON), `tools/check_trace.py` of the same folder
//! checks each motion again, from the decoded lines.
use glidepath::channel::{Channel, Handles};
use glidepath::machine::{AxisData, AxisKind, AxisName, ChannelData, MachineData, Synch, SynchTable};
use glidepath::nc::{Command, Decoder, DecoderMemory, MotionKind, Setup, Step};
use glidepath::quantity::Position;
use glidepath::queue::Function;
use glidepath::tick::State;
use host_tests::calls::call;
use host_tests::cases::machines;
use host_tests::check::{self, Limits};
use host_tests::trace::Trace;
use std::fmt::Write as _;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command as Process;

type Machine = MachineData<5>;

/// Names of the axes.
const NAMES: [&str; 5] = ["X", "Y", "Z", "A", "C"];

/// Slopes at program start, as in P-CHAN-00071; ISG's default is STEP.
const SLOPES: [(&str, u8); 3] = [("default", 0), ("TRAPEZ", 1), ("HSC", 3)];

/// What a program must show.
enum Show {
    /// This is its last point, this its distance from the programmed lines at most, and this is true of the
    /// run.
    Runs { end: [f64; 2], off: f64, and: fn(&Run) -> Result<(), String> },
    /// This is refused, in these words.
    Refused(&'static str),
}

use Show::{Refused, Runs};

/// A program, the unit of its F (P-CHAN-00108 in thousandths: 100 is m/min), and what it shows.
struct Example {
    name: &'static str,
    feed_unit: u32,
    show: Show,
}

const MM_MIN: u32 = 100_000;
const M_MIN: u32 = 100;

const fn runs(
    name: &'static str,
    feed_unit: u32,
    end: [f64; 2],
    off: f64,
    and: fn(&Run) -> Result<(), String>,
) -> Example {
    Example { name, feed_unit, show: Runs { end, off, and } }
}

const fn refused(name: &'static str, words: &'static str) -> Example {
    Example { name, feed_unit: MM_MIN, show: Refused(words) }
}

const OSC: &str = "OSC";

/// All of them.
const EXAMPLES: [Example; 42] = [
    refused("A8-EX01_positions_feed", OSC),
    refused("A8-EX02_zero_excur", OSC),
    refused("A8-EX03_freq_count", OSC),
    refused("A8-EX04_period", OSC),
    refused("A8-EX05_with_infeed", OSC),
    refused("A8-EX06_dwell", OSC),
    refused("A8-EX07_modulo_short", OSC),
    refused("A8-EX08_off", OSC),
    refused("A8-EX09_off_feed", OSC),
    refused("A8-EX10_osc_7", OSC),
    refused("A8-EX11_osc_7", OSC),
    refused("C40-EX01_mode1", "FCT_CONTOUR_LAH"),
    refused("C40-EX02_inside_rt_loop", "#RT WHILE"),
    refused("C40-EX03_outside_rt_loop", "FCT_CONTOUR_LAH"),
    runs("D3-EX01_poly_G61", MM_MIN, [160.0, 20.0], 1.0, four_corners_of_1_mm),
    runs("D3-EX02_poly_G261_1", MM_MIN, [160.0, 20.0], 1.0, four_corners_of_1_mm),
    runs("D3-EX03_poly_G261_2", MM_MIN, [160.0, 20.0], 1.0, four_corners_of_1_mm),
    runs("D3-EX04_relevant_block", M_MIN, [10.0, 0.0], 5.0, the_short_block_is_left_out),
    runs("D3-EX05_actions_INTER_ACTION", MM_MIN, [100.0, 100.0], 4.0, m25_in_the_curve),
    runs("D3-EX06_actions_POST_ACTION", MM_MIN, [100.0, 100.0], 4.0, m25_behind_the_curve),
    runs("D3-EX07_poly_jerk", M_MIN, [200.0, 0.0], 4.0, the_jerk_slows_the_first_corner_alone),
    runs("D3-EX08_poly_const_speed", MM_MIN, [0.0, 0.0], 1.0, the_second_corner_keeps_its_speed),
    runs("D3-EX09_contour_on_off", M_MIN, [0.0, 0.0], 1.0, three_corners_of_1_mm),
    runs("D3-EX10_dev", MM_MIN, [100.0, 100.0], 5.0, |run| off_the_corner(run, 4.99, 5.0)),
    runs("D3-EX11_dist", MM_MIN, [100.0, 100.0], 5.0, leaves_10_mm_before_and_returns_5_mm_behind),
    runs("D3-EX12_pos", MM_MIN, [100.0, 100.0], 14.2, meets_outside),
    runs("D3-EX13_dist_soft", M_MIN, [80.0, 80.0], 12.0, leaves_at_most_12_mm_before),
    runs("D3-EX14_dev_compare", M_MIN, [80.0, 80.0], 0.2, |run| off_80(run, 0.199, 0.2)),
    runs("D3-EX15_ptp", MM_MIN, [100.0, 100.0], 5.0, |run| off_the_corner(run, 1.0, 5.0)),
    runs("D3-EX16_mfunc_output", MM_MIN, [300.0, 300.0], 10.0, two_functions_and_two_dwells),
    runs("D3-EX17_max_angle_change", MM_MIN, [0.0, 0.0], 0.5, nothing_is_rounded),
    runs("D3-EX18_angle_sweep", MM_MIN, [-50.0, 0.0], 0.5, rounded_up_to_73_degrees),
    runs("D3-EX19_put_ax", MM_MIN, [100.0, 50.0], 0.5, the_axis_given_away_ends_it),
    runs("D3-EX20_surface", MM_MIN, [100.0, 37.5], 0.02, |_| Ok(())),
    runs("D3-EX21_surface_two_step", MM_MIN, [100.0, 37.5], 0.02, |_| Ok(())),
    runs("D3-EX22_bspline", MM_MIN, [100.0, 37.5], 0.2, corners_are_cut_by_0_2_mm),
    runs("D3-EX23_bspline_two_step", MM_MIN, [100.0, 37.5], 0.2, corners_are_cut_by_0_2_mm),
    runs("D3-EX24_slope_types", MM_MIN, [15.0, 50.0], 1e-6, |_| Ok(())),
    runs("D3-EX25_weight_axis", MM_MIN, [100.0, 100.0], 1e-6, |run| accelerations(run, [1000.0, 1500.0])),
    runs("D3-EX26_weight_all", MM_MIN, [100.0, 100.0], 1e-6, |run| accelerations(run, [1000.0, 1000.0])),
    runs("D3-EX27_akima_circle", M_MIN, [80.0, 0.0], f64::INFINITY, the_spline_is_a_circle_and_as_fast),
    refused("D3-EX28_five_axis", "#KIN ID"),
];

/// a 2000 mm/s², ramps 50 ms, v 1000 mm/s. M25 is MVS_SNS, M26 MVS_SVS; PTP is allowed.
fn machine(example: &Example, slope: u8) -> Machine {
    let axes = NAMES.map(|name| {
        let kind = if matches!(name, "A" | "C") { AxisKind::Rotary } else { AxisKind::Linear };
        let mut axis = AxisData::new(AxisName::new(name).expect("a letter"), kind);
        (axis.vb_max, axis.vb_eilgang) = (1_000_000, 1_000_000);
        axis.a_max = 2000;
        (axis.a_beschl, axis.a_brems, axis.a_grenz) = (2000, 2000, 2000);
        (axis.a_stufe, axis.a_grenz_stufe) = ([2000; 2], [2000; 2]);
        (axis.tr_grenz, axis.tr_geom) = (50_000, 10_000);
        if example.name.contains("EX07") {
            // With shorter ramps the jerk of a curve of 4 mm permits 4 m/min.
            machines::ramps(&mut axis, 2_000_000);
            axis.tr_geom = 2_000_000;
        }
        axis
    });
    let channel = ChannelData {
        slope_profile: slope,
        feedrate_factor_milli: example.feed_unit,
        ptp: true,
        surface: true,
        corr_v_trans_jerk: true,
        m_synch: SynchTable::NONE.with(25, Synch::MvsSns).with(26, Synch::MvsSvs),
        ..ChannelData::new()
    };
    MachineData { axes, channel }
}

/// A run.
struct Run {
    trace: Trace,
    /// Functions with the row of their tick.
    outputs: Vec<(usize, Function)>,
}

/// Runs a text; functions are acknowledged in the next tick.
fn run(text: &str, machine: &Machine) -> Result<Run, String> {
    let mut channel: Box<Channel<5, 120>> = Box::new(Channel::new());
    let start = [Position::ZERO; 5];
    let Handles { mut planner, mut interpolator, operator } =
        channel.split(machine, start, text.as_bytes()).map_err(|e| e.to_string())?;
    let mut run = Run { trace: Trace::empty(0.001, 5), outputs: Vec::new() };
    let mut idle = 0;
    for row in 0..1_000_000 {
        let done = call(&mut planner, usize::MAX, |_| {}).map_err(|e| e.to_string())?;
        let state = interpolator.tick();
        run.trace.push(interpolator.set_points().iter().map(|p| p.to_bits()));
        while let Some(output) = operator.output() {
            run.outputs.push((row, output.function));
            if output.waits {
                operator.acknowledge(output.function).map_err(|e| format!("{e:?}"))?;
            }
        }
        idle = if state == State::Idle { idle + 1 } else { 0 };
        if done && state == State::Idle {
            return Ok(run);
        }
        if idle > 5000 {
            return Err(format!("stands from tick {} on", row - idle));
        }
    }
    Err("does not end".to_owned())
}

impl Run {
    fn rows(&self) -> impl Iterator<Item = Vec<f64>> + '_ {
        (0..self.trace.len()).map(|row| self.trace.mm(row))
    }

    /// Smallest distance of a point of X and Y from the lines between set points.
    fn near(&self, point: [f64; 2]) -> f64 {
        let rows: Vec<_> = self.rows().collect();
        let distance = |w: &[Vec<f64>]| {
            let [dx, dy] = [w[1][0] - w[0][0], w[1][1] - w[0][1]];
            let [px, py] = [point[0] - w[0][0], point[1] - w[0][1]];
            let square = dx * dx + dy * dy;
            let part = if square > 0.0 { ((px * dx + py * dy) / square).clamp(0.0, 1.0) } else { 0.0 };
            (px - part * dx).hypot(py - part * dy)
        };
        rows.windows(2).map(distance).fold(f64::INFINITY, f64::min)
    }

    /// Path speeds of X and Y in the ticks in which both rows are this near to a point.
    fn speeds(&self, point: [f64; 2], within: f64) -> Vec<f64> {
        let rows: Vec<_> = self.rows().collect();
        let inside = |q: &[f64]| (q[0] - point[0]).hypot(q[1] - point[1]) < within;
        let pairs = rows.windows(2).filter(|w| inside(&w[0]) && inside(&w[1]));
        pairs.map(|w| (w[1][0] - w[0][0]).hypot(w[1][1] - w[0][1]) / 0.001).collect()
    }
}

fn want(good: bool, what: impl FnOnce() -> String) -> Result<(), String> {
    if good { Ok(()) } else { Err(what()) }
}

/// Corners off by between these distances.
fn corners(run: &Run, points: &[[f64; 2]], least: f64, most: f64) -> Result<(), String> {
    for point in points {
        let off = run.near(*point);
        want((least..=most).contains(&off), || format!("{off} mm off {point:?}, not {least} to {most}"))?;
    }
    Ok(())
}

/// Sharp corners: as near as a tick comes.
fn sharp(run: &Run, points: &[[f64; 2]]) -> Result<(), String> {
    corners(run, points, 0.0, 0.01)
}

fn four_corners_of_1_mm(run: &Run) -> Result<(), String> {
    corners(run, &[[40.0, 100.0], [60.0, 20.0], [80.0, 20.0], [100.0, 100.0]], 0.999, 1.001)?;
    sharp(run, &[[20.0, 100.0], [120.0, 100.0], [140.0, 20.0]])
}

fn three_corners_of_1_mm(run: &Run) -> Result<(), String> {
    corners(run, &[[100.0, 0.0], [100.0, 100.0], [0.0, 100.0]], 0.999, 1.01)
}

fn off_the_corner(run: &Run, least: f64, most: f64) -> Result<(), String> {
    corners(run, &[[100.0, 0.0]], least, most + 1e-6)
}

fn off_80(run: &Run, least: f64, most: f64) -> Result<(), String> {
    corners(run, &[[80.0, 0.0]], least, most + 1e-3)
}

/// (5, 1) would be passed with the block of 1 mm; nothing ends there.
fn the_short_block_is_left_out(run: &Run) -> Result<(), String> {
    corners(run, &[[5.0, 0.0]], 0.1, 5.0)?;
    sharp(run, &[[10.0, 3.0]])
}

/// Where M25 came out.
fn at_m25(run: &Run) -> Result<Vec<f64>, String> {
    let [(row, Function::M(25))] = run.outputs[..] else { return Err(format!("{:?}", run.outputs)) };
    Ok(run.trace.mm(row))
}

fn m25_in_the_curve(run: &Run) -> Result<(), String> {
    off_the_corner(run, 3.9, 4.0)?;
    let at = at_m25(run)?;
    // In the middle of the curve, no further on than a tick.
    want((at[1] - (100.0 - at[0])).abs() < 0.2 && at[1] > 1.0, || format!("M25 at {at:?}"))
}

fn m25_behind_the_curve(run: &Run) -> Result<(), String> {
    off_the_corner(run, 3.9, 4.0)?;
    let at = at_m25(run)?;
    want((at[0] - 100.0).abs() < 1e-3 && at[1] > 5.0 && at[1] < 30.0, || format!("M25 at {at:?}"))
}

fn the_jerk_slows_the_first_corner_alone(run: &Run) -> Result<(), String> {
    corners(run, &[[100.0, 50.0], [200.0, 50.0]], 3.9, 4.0 + 1e-6)?;
    let slowest = |point| run.speeds(point, 6.0).into_iter().fold(f64::INFINITY, f64::min) * 60.0 / 1000.0;
    let [checked, free] = [[100.0, 50.0], [200.0, 50.0]].map(slowest);
    want(checked < 0.9 * free && free > 3.9, || format!("{checked} and {free} m/min"))
}

fn the_second_corner_keeps_its_speed(run: &Run) -> Result<(), String> {
    corners(run, &[[100.0, 0.0], [0.0, 100.0]], 0.999, 1.001)?;
    let speeds = run.speeds([0.0, 100.0], 2.0);
    let [slow, fast] = [f64::min, f64::max].map(|f| speeds.iter().copied().reduce(f).unwrap_or(0.0));
    want(slow > 0.0 && fast / slow < 1.001, || format!("{slow} to {fast} mm/s"))
}

fn leaves_10_mm_before_and_returns_5_mm_behind(run: &Run) -> Result<(), String> {
    off_the_corner(run, 0.5, 5.0)?;
    let tick = 0.1;
    let leaves = run.rows().filter(|q| q[1] == 0.0).map(|q| q[0]).fold(0.0, f64::max);
    let returns = run.rows().filter(|q| q[0] == 100.0).map(|q| q[1]).fold(100.0, f64::min);
    let bent = run.rows().filter(|q| q[1] > 0.0 && q[0] < 100.0).map(|q| q[1]).fold(0.0, f64::max);
    want(
        (90.0 - tick..=90.0 + 0.5).contains(&leaves)
            && (5.0 - 0.5..=5.0 + tick).contains(&returns)
            && bent <= 5.0,
        || format!("leaves at X {leaves}, returns at Y {returns}, {bent}"),
    )
}

fn meets_outside(run: &Run) -> Result<(), String> {
    let off = run.near([110.0, -10.0]);
    want(off < 0.06, || format!("{off} mm off (110, -10)"))
}

fn leaves_at_most_12_mm_before(run: &Run) -> Result<(), String> {
    let leaves = run.rows().filter(|q| q[1] == 0.0).map(|q| q[0]).fold(0.0, f64::max);
    let off = run.near([80.0, 0.0]);
    want(leaves >= 68.0 - 0.05 && off > 0.2, || format!("leaves at X {leaves}, {off} mm off"))
}

fn two_functions_and_two_dwells(run: &Run) -> Result<(), String> {
    let functions: Vec<_> = run.outputs.iter().map(|(_, function)| *function).collect();
    want(functions == [Function::M(25), Function::M(26)], || format!("{functions:?}"))?;
    // The longest rests: 2 s and 1 s.
    let rows: Vec<_> = (0..run.trace.len()).map(|row| run.trace.row(row).collect::<Vec<_>>()).collect();
    let (mut rests, mut ticks) = (vec![0], 0);
    for w in rows.windows(2) {
        ticks = if w[0] == w[1] { ticks + 1 } else { 0 };
        if ticks == 0 {
            rests.push(0);
        }
        if let Some(last) = rests.last_mut() {
            *last = ticks;
        }
    }
    rests.sort_unstable();
    let longest: Vec<_> = rests.iter().rev().take(2).collect();
    want((2000..2040).contains(longest[0]) && (1000..1040).contains(longest[1]), || format!("{longest:?}"))
}

/// Sharp corners of the spline. With STEP, the default, a standstill there takes less time than a curve; with other slopes
/// each of them is cut by half of the tolerance at least.
const SHARP_OF_THE_SPLINE: &[[f64; 2]] =
    &[[3.0, 25.0], [25.0, 25.0], [30.0, 35.0], [55.0, 32.5], [58.0, 12.0], [90.0, 35.0]];

/// Its other corners: a quarter at least.
const GENTLE_OF_THE_SPLINE: &[[f64; 2]] =
    &[[15.0, 15.0], [23.0, 12.0], [50.0, 37.5], [70.0, 12.0], [77.5, 10.0]];

/// The start and the end are met, other corners are cut by up to the tolerance.
fn corners_are_cut_by_0_2_mm(run: &Run) -> Result<(), String> {
    corners(run, SHARP_OF_THE_SPLINE, 0.0, 0.2005)?;
    corners(run, GENTLE_OF_THE_SPLINE, 0.0, 0.2005)?;
    sharp(run, &[[0.0, 0.0], [100.0, 37.5]])
}

/// Ticks of each way round the circle, and how far they are from it.
fn the_spline_is_a_circle_and_as_fast(run: &Run) -> Result<(), String> {
    let (mut ways, mut off) = (vec![0_usize], 0.0_f64);
    for q in run.rows() {
        if q[1] > 1e-9 {
            *ways.last_mut().expect("one") += 1;
            off = off.max((q[0].hypot(q[1] - 80.0) - 80.0).abs());
        } else if ways.last() != Some(&0) {
            ways.push(0);
        }
    }
    let [spline, arc, 0] = ways[..] else { return Err(format!("{ways:?}")) };
    // The linear pass takes ten times the arc's; on this machine both slow down to get into the circle.
    want(spline < arc * 3 / 2 && off < 0.002, || format!("{spline} and {arc} ticks, {off} mm off"))
}

fn nothing_is_rounded(run: &Run) -> Result<(), String> {
    sharp(run, &[[100.0, 0.0], [100.0, 100.0]])
}

fn rounded_up_to_73_degrees(run: &Run) -> Result<(), String> {
    // How near each visit to the corner comes: one for each pass, and one on the way back from a pass
    // straight on.
    let (mut visits, mut inside) = (Vec::new(), false);
    for q in run.rows() {
        let off = q[0].hypot(q[1]);
        if off < 2.0 {
            if !inside {
                visits.push(f64::INFINITY);
            }
            if let Some(last) = visits.last_mut() {
                *last = off.min(*last);
            }
        }
        inside = off < 2.0;
    }
    // The run begins there.
    let rounded: Vec<bool> = visits.iter().skip(1).map(|off| *off > 0.3).collect();
    let mut wanted = Vec::new();
    for angle in (0..13).map(|k| 7.5 * f64::from(k)).chain((0..14).map(|k| 270.0 + 7.5 * f64::from(k))) {
        let turn = if angle > 180.0 { (angle - 360.0_f64).abs() } else { angle };
        wanted.push(turn > 0.0 && turn <= 73.0);
        if turn == 0.0 {
            wanted.push(false);
        }
    }
    want(rounded == wanted, || format!("{visits:?}"))
}

fn the_axis_given_away_ends_it(run: &Run) -> Result<(), String> {
    sharp(run, &[[50.0, 50.0]])
}

/// Largest accelerations of X and Y: weighted, and used.
fn accelerations(run: &Run, limits: [f64; 2]) -> Result<(), String> {
    for (k, limit) in limits.into_iter().enumerate() {
        let a = check::peaks(&run.trace.columns[k], run.trace.cycle).values[1];
        want(a <= limit * 1.0001 && a > 0.98 * limit, || format!("axis {k}: {a} mm/s², not {limit}"))?;
    }
    Ok(())
}

/// Limits of every axis.
fn limits(machine: &Machine) -> Vec<Limits> {
    let of = |axis: &AxisData| Limits {
        v: f64::from(axis.vb_max) * 1e-3,
        a: f64::from(axis.a_max),
        jerk: f64::INFINITY,
    };
    machine.axes.iter().map(of).collect()
}

/// The programmed lines as the checker reads them.
fn contour(text: &str, machine: &Machine) -> Result<String, String> {
    let mut memory = DecoderMemory::<5>::new();
    let setup = Setup::new(machine, [Position::ZERO; 5]);
    let mut decoder = Decoder::new(&mut memory, setup, text.as_bytes());
    let mut segments = Vec::new();
    let mut feed = 0.0;
    loop {
        match decoder.step().map_err(|e| e.to_string())? {
            Step::Command(Command::Motion(motion)) => {
                let end: Vec<_> = NAMES
                    .iter()
                    .zip(&motion.target)
                    .map(|(name, to)| format!("\"{name}\": {:.10}", to.to_num::<f64>()))
                    .collect();
                if matches!(motion.kind, MotionKind::Arc { .. }) {
                    return Err("no arcs here".to_owned());
                }
                feed = f64::max(feed, motion.feed.to_num::<f64>());
                // Speeds are no matter of this check: blocks left out have the feed of others.
                segments.push(format!(
                    "{{\"n\": {}, \"type\": \"line\", \"end\": {{{}}}}}",
                    motion.n,
                    end.join(", ")
                ));
            }
            Step::End => break,
            _ => {}
        }
    }
    let names = NAMES.map(|name| format!("\"{name}\"")).join(", ");
    Ok(format!(
        "{{\"axes\": [{names}], \"main\": [\"X\", \"Y\", \"Z\"], \"start\": {{}}, \"segments\": [{}]}}",
        segments.join(", ")
    ))
}

/// The word of the checker.
fn judged(
    checker: &Path,
    name: &str,
    text: &str,
    machine: &Machine,
    run: &Run,
    off: f64,
) -> Result<(), String> {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("spec-{name}"));
    std::fs::create_dir_all(&folder).map_err(|e| e.to_string())?;
    let mut trace = format!("t_s,{}\n", NAMES.join(","));
    for (row, q) in run.rows().enumerate() {
        let _ = write!(trace, "{:.3}", row as f64 * 0.001);
        for x in q {
            let _ = write!(trace, ",{x:.12}");
        }
        trace.push('\n');
    }
    let axis = |axis: &AxisData| {
        let limit = f64::from(axis.vb_max) * 1e-3;
        format!("\"{}\": {{\"v\": {limit}, \"a\": {}}}", axis.name.as_str(), axis.a_max)
    };
    let axes: Vec<_> = machine.axes.iter().map(axis).collect();
    let limits = format!(
        "{{\"cycle_s\": 0.001, \"path_tol\": {}, \"track_tol\": 180, \"resolution\": {:e}, \"allowed_extra_stops\": 1000, \
         \"axes\": {{{}}}}}",
        off + 1e-6,
        1.0 / (1u64 << 32) as f64,
        axes.join(", ")
    );
    let mut command = Process::new(std::env::var("PYTHON").unwrap_or_else(|_| "python3".to_owned()));
    command.arg(checker).arg("--no-exact");
    let contour = contour(text, machine)?;
    for (option, file, content) in
        [("--trace", "t.csv", trace), ("--contour", "c.json", contour), ("--limits", "l.json", limits)]
    {
        let path = folder.join(file);
        std::fs::write(&path, content).map_err(|e| e.to_string())?;
        command.arg(option).arg(path);
    }
    let said = command.arg("--out").arg(folder.join("r.json")).output().map_err(|e| e.to_string())?;
    want(said.status.success(), || {
        format!("{}: {}", folder.display(), String::from_utf8_lossy(&said.stdout).trim())
    })
}

/// A line that is seen even if the test passes.
fn say(line: &str) {
    let _ = writeln!(std::io::stderr(), "{line}");
}

#[test]
fn every_example_of_the_sources_runs_or_is_refused() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let shared = std::env::var_os("GLIDEPATH_SHARED").map_or_else(|| root.join("../shared"), PathBuf::from);
    let (folder, checker) = (shared.join("spec/programs"), shared.join("tools/check_trace.py"));
    if !folder.is_dir() {
        say(&format!("NOT RUN: the example programs are not in {}", folder.display()));
        return;
    }
    let python = std::env::var("PYTHON").unwrap_or_else(|_| "python3".to_owned());
    let numpy = Process::new(python).args(["-c", "import numpy"]).output();
    let judge = checker.is_file() && numpy.is_ok_and(|output| output.status.success());
    if !judge {
        say("NOT JUDGED AGAIN: check_trace.py needs python3 with numpy");
    }
    let files = std::fs::read_dir(&folder).expect("a folder").flatten();
    let mut names: Vec<_> = files
        .map(|file| file.file_name().to_string_lossy().into_owned())
        .filter_map(|name| name.strip_suffix(".nc").map(str::to_owned))
        .collect();
    names.sort();
    assert_eq!(names, EXAMPLES.map(|example| example.name), "another example");
    let mut faults = Vec::new();
    for example in &EXAMPLES {
        let text = std::fs::read_to_string(folder.join(format!("{}.nc", example.name))).expect("text");
        let mut seen = Vec::new();
        for (slope, number) in SLOPES {
            let machine = machine(example, number);
            let verdict = match (run(&text, &machine), &example.show) {
                (Err(fault), Refused(words)) => want(fault.contains(words), || fault.clone()),
                (Ok(_), Refused(words)) => Err(format!("runs, and should be refused for {words}")),
                (Err(fault), Runs { .. }) => Err(fault),
                (Ok(run), Runs { end, off, and }) => check::limits(&run.trace, &limits(&machine))
                    .and_then(|_| {
                        let last = run.trace.mm(run.trace.len() - 1);
                        want((last[0] - end[0]).abs() + (last[1] - end[1]).abs() < 1e-8, || {
                            format!("ends at {last:?}")
                        })
                    })
                    .and_then(|()| {
                        // With STEP and 60 m/min stops take 1.791 s, the curves 1.847 s.
                        let stands = slope == "default" && example.name == "D3-EX09_contour_on_off";
                        if stands {
                            sharp(&run, &[[100.0, 0.0], [100.0, 100.0], [0.0, 100.0]])
                        } else {
                            and(&run)
                        }
                    })
                    .and_then(|()| {
                        let cuts = example.name.contains("bspline") && slope != "default";
                        if !cuts {
                            return Ok(());
                        }
                        corners(&run, SHARP_OF_THE_SPLINE, 0.1, 0.2005)?;
                        corners(&run, GENTLE_OF_THE_SPLINE, 0.05, 0.2005)
                    })
                    .and_then(|()| {
                        // The judge's contour has no arcs.
                        let again = if judge && off.is_finite() && !seen.contains(&run.trace.columns) {
                            judged(
                                &checker,
                                &format!("{}-{slope}", example.name),
                                &text,
                                &machine,
                                &run,
                                *off,
                            )
                        } else {
                            Ok(())
                        };
                        seen.push(run.trace.columns.clone());
                        again
                    }),
            };
            if let Err(fault) = verdict {
                faults.push(format!("{} with {slope}: {fault}", example.name));
            }
        }
        // STEP is not TRAPEZ, unless the program chooses its own slope. Alone between two rests HSC is.
        let chooses = text.contains("#SLOPE") && !example.name.contains("EX24");
        if seen.len() == SLOPES.len() && ((seen[0] == seen[1]) != chooses || (chooses && seen[1] != seen[2]))
        {
            faults.push(format!("{}: the slope at the start makes no difference, or one", example.name));
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

/// The folder of the example programs, if it is there.
fn programs() -> Option<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let shared = std::env::var_os("GLIDEPATH_SHARED").map_or_else(|| root.join("../shared"), PathBuf::from);
    let folder = shared.join("spec/programs");
    if !folder.is_dir() {
        say(&format!("NOT RUN: the example programs are not in {}", folder.display()));
        return None;
    }
    Some(folder)
}

/// An example without the lines that contain one of these.
fn without(folder: &Path, name: &str, left_out: &[&str]) -> String {
    let text = std::fs::read_to_string(folder.join(format!("{name}.nc"))).expect("text");
    let kept = text.lines().filter(|line| !left_out.iter().any(|words| line.contains(words)));
    kept.map(|line| format!("{line}\n")).collect()
}

fn example(name: &str) -> &'static Example {
    static ALL: [Example; 42] = EXAMPLES;
    ALL.iter().find(|example| example.name == name).expect("an example")
}

/// D3-181, D3-182, D3-196, D3-197: parameters and selection in one command or in two are one path to the bit.
#[test]
fn one_command_or_two_is_one_path_ex20_ex21_ex22_ex23() {
    let Some(folder) = programs() else { return };
    for (_, slope) in SLOPES {
        for pair in
            [["D3-EX20_surface", "D3-EX21_surface_two_step"], ["D3-EX22_bspline", "D3-EX23_bspline_two_step"]]
        {
            let [one, two] = pair.map(|name| {
                run(&without(&folder, name, &[]), &machine(example(name), slope)).expect("runs").trace.columns
            });
            assert!(one == two, "{pair:?}");
        }
    }
}

/// D3-237, D3-EX27: the linear pass stands at each corner; the spline goes round at the feed, tangential at both ends,
/// in a fraction of the time.
#[test]
fn the_spline_takes_a_fraction_of_the_linear_pass_ex27() {
    let Some(folder) = programs() else { return };
    let name = "D3-EX27_akima_circle";
    let machine = machine(example(name), 3);
    let pass = |left_out: &[&str]| {
        let run = run(&without(&folder, name, left_out), &machine).expect("runs");
        let rows: Vec<_> = run.rows().collect();
        // Of the first way round: its ticks, and its speeds.
        let from = rows.iter().position(|q| q[1] > 1e-9).expect("a circle") - 1;
        let to = from + 1 + rows[from + 1..].iter().position(|q| q[1] <= 1e-9).expect("its end");
        let speed = |w: &[Vec<f64>]| (w[1][0] - w[0][0]).hypot(w[1][1] - w[0][1]) / 0.001;
        let speeds: Vec<_> = rows[from - 5..to + 5].windows(2).map(speed).collect();
        (to - from, speeds)
    };
    let (spline, fast) = pass(&[]);
    let (linear, slow) = pass(&["G151", "G150"]);
    let least = |speeds: &[f64]| speeds.iter().copied().fold(f64::INFINITY, f64::min);
    let most = |speeds: &[f64]| speeds.iter().copied().fold(0.0, f64::max);
    println!(
        "{spline} and {linear} ticks; {} to {} mm/s, {} to {}",
        least(&fast),
        most(&fast),
        least(&slow),
        most(&slow)
    );
    assert!(linear >= 6 * spline, "{spline} and {linear} ticks");
    assert!(most(&fast) > 0.999 * 20_000.0 / 60.0 && least(&fast) > 100.0, "{fast:?}");
    assert!(least(&slow) < 10.0);
}

/// D3-238, D3-EX28 without its transformation: the path speed is constant, and what C permits at 120 degrees/s.
#[test]
fn the_rotary_axis_alone_limits_the_speed_ex28() {
    let Some(folder) = programs() else { return };
    let name = "D3-EX28_five_axis";
    let mut machine = machine(example(name), 3);
    machine.channel.feedrate_factor_milli = M_MIN;
    machine.axes[4].vb_max = 120_000;
    machine.axes[4].vb_eilgang = 120_000;
    let text = without(&folder, name, &["#KIN ID", "#TRAFO"]);
    let speeds = |text: &str| {
        let run = run(text, &machine).expect("runs");
        // Between 30 degrees and 330.
        let rows: Vec<_> = run.rows().filter(|q| q[1] > 11.0).collect();
        let off = rows.iter().map(|q| (q[0].hypot(q[1] - 80.0) - 80.0).abs()).fold(0.0, f64::max);
        let all: Vec<_> =
            rows.windows(2).map(|w| (w[1][0] - w[0][0]).hypot(w[1][1] - w[0][1]) / 0.001).collect();
        let [least, most] = [f64::min, f64::max].map(|of| all.iter().copied().reduce(of).expect("some"));
        (least, most, off)
    };
    let (least, most, off) = speeds(&text);
    println!("{least} to {most} mm/s, {off} mm off");
    let full = 120.0 / 360.0 * std::f64::consts::TAU * 80.0;
    assert!(least > 0.98 * full && most < 1.002 * full && off < 0.1, "{least} to {most} mm/s, {off} mm off");
    let (least, most, _) = speeds(&text.replace("#HSC ON[SURFACE PATH_DEV 0.1]", ""));
    assert!(least < 0.2 * most, "{least} to {most} mm/s without");
}

//! Random machine data over their permitted ranges, random programs of a suitable size, and an operator, all
//! from one number.
//!
//! Lengths, radii and feeds follow from the motion of the machine in some ticks. So every run has some
//! thousand ticks, with 1 mm/s² at 0.1 ms and with 50,000 mm/s² at 10 ms.
use crate::cases::machines;
use crate::cases::random::{Mix, Random, program};
use crate::cases::{NM, Program, decimal, set_point};
use crate::check::{self, Limits};
use crate::operate::{
    Act, LONGEST, Operated, POLLS, TOO_LONG, operate_within, random_acts, with_overrides, with_stalls,
    with_starvation,
};
use crate::properties::{axis_limits, permitted_at};
use crate::reference::geometry::{Contour, Element};
use crate::reference::merge::path_tolerance;
use crate::tolerance::{CUT, DISTANCE};
use glidepath::machine::{
    AccelerationUnit, AxisData, MODE_LINEAR, MODE_MASTER, MachineData, Synch, SynchTable,
};
use glidepath::quantity::Position;
use std::fmt::Write;

/// Result of a seed.
#[derive(Clone, Debug, PartialEq)]
pub enum Outcome {
    /// No fault, with the number of ticks.
    Good(usize),
    /// The run takes longer than permitted.
    TooLong,
    /// The library refused the program, with the reason that the rules of the language give.
    Refused(String),
    /// A fault, with all data to repeat it.
    Fault(String),
}

/// A run from one number.
#[derive(Clone, Debug)]
pub struct Setup<const AXES: usize> {
    /// The machine.
    pub machine: MachineData<AXES>,
    /// Its motion blocks.
    pub program: Program,
    /// A line that switches contour mode on; empty without.
    pub contour: String,
    /// Lines before a motion block (its index): dwells, weights, functions, contour mode.
    pub lines: Vec<(usize, String)>,
    /// Words at the end of a motion block (its index): functions.
    pub words: Vec<(usize, &'static str)>,
    /// Commands of the operator.
    pub acts: Vec<(usize, Act)>,
    /// Calls of the planner between two ticks.
    pub polls: usize,
}

/// Cycles, µs.
const CYCLES: [f64; 2] = [100.0, 10_000.0];
/// Blocks of the look-ahead.
const LOOK_AHEAD: [f64; 2] = [10.0, 500.0];
/// Ramp times, µs.
const RAMPS: [f64; 2] = [100.0, 2e6];
/// Accelerations, mm/s².
const ACCELERATIONS: [f64; 2] = [1.0, 50_000.0];
/// Largest speeds, µm/s.
const SPEEDS: [f64; 2] = [1.0, 2e9];
/// Values of most machines.
const USUAL_SPEEDS: [f64; 2] = [1e3, 2e9];
/// Number of ticks of a block.
const TICKS: [f64; 2] = [0.3, 300.0];
/// Number of ticks of all blocks of a slow machine, if each block has the shortest length.
const LONG: f64 = 20_000.0;
/// Shortest blocks, mm: most of them, and the resolution of the text.
const SHORTEST: [f64; 2] = [1e-4, 1e-6];
/// Functions of the programs.
const FUNCTIONS: [&str; 6] = ["M3", "M24", "M25", "M26", "M27", "H7"];

/// A value between two bounds, equally distributed in orders of magnitude; once in eight one of the bounds.
fn within(r: &mut Random, [low, high]: [f64; 2]) -> f64 {
    match r.bits() % 16 {
        0 => low,
        1 => high,
        _ => r.magnitude(low, high),
    }
}

/// Order of magnitude of an axis: acceleration, ramp time, speed.
fn size(r: &mut Random) -> [f64; 3] {
    let speeds = if r.once_in(8) { SPEEDS } else { USUAL_SPEEDS };
    [within(r, ACCELERATIONS), within(r, RAMPS), within(r, speeds)]
}

fn axis(r: &mut Random, data: &mut AxisData, [a, ramp, v]: [f64; 3], cycle_us: u32) {
    let near = |r: &mut Random, x: f64, [low, high]: [f64; 2]| (x * r.magnitude(0.4, 2.5)).clamp(low, high);
    for value in [&mut data.a_beschl, &mut data.a_brems, &mut data.a_grenz] {
        *value = near(r, a, ACCELERATIONS) as u32;
    }
    let most = data.a_beschl.max(data.a_brems).max(data.a_grenz);
    data.a_max = if r.once_in(2) { most } else { (f64::from(most) * r.magnitude(1.0, 4.0)) as u32 };
    let alike = r.once_in(2);
    let one = near(r, ramp, RAMPS) as u32;
    for value in [
        &mut data.tr_beschl_zu,
        &mut data.tr_beschl_ab,
        &mut data.tr_brems_zu,
        &mut data.tr_brems_ab,
        &mut data.tr_grenz,
    ] {
        *value = if alike { one } else { near(r, ramp, RAMPS) as u32 };
    }
    let ramps = [data.tr_beschl_zu, data.tr_beschl_ab, data.tr_brems_zu, data.tr_brems_ab, data.tr_grenz];
    let shortest = ramps.into_iter().fold(u32::MAX, u32::min);
    data.tr_min = if r.once_in(2) { shortest } else { 1 };
    data.tr_geom = match r.bits() % 6 {
        0 => 0,
        1 => r.magnitude(1.0, f64::from(cycle_us)) as u32,
        2 => shortest,
        _ => within(r, RAMPS) as u32,
    };
    data.vb_max = near(r, v, SPEEDS) as u32;
    data.vb_eilgang = (f64::from(data.vb_max) * r.between(0.2, 1.0)).max(1.0) as u32;
    data.vb_max_red = match r.bits() % 4 {
        0 => 0,
        1 => r.magnitude(1.0, f64::from(data.vb_max).max(1.0)) as u32,
        _ => (f64::from(data.vb_max) * r.unit()) as u32,
    };
    data.a_trans_weight = if r.once_in(3) { r.between(1.0, 1000.9) as u32 } else { 0 };
    data.r_trans_weight = if r.once_in(3) { r.between(0.0, 1000.9) as u32 } else { 1000 };
    let mut stage = || (f64::from(data.a_max) * r.between(0.1, 1.0)).max(1.0) as u32;
    (data.a_stufe, data.a_grenz_stufe) = ([stage(), stage()], [stage(), stage()]);
    (data.d_stufe, data.d_grenz_stufe) = ([0, stage()], [stage(), 0]);
    data.vb_stufe_1_2 = r.magnitude(1.0, f64::from(data.vb_max).max(1.0)) as u32;
    data.vb_grenz_stufe_1_2 = r.magnitude(1.0, f64::from(data.vb_max).max(1.0)) as u32;
}

/// The machine, and the slowest [`size`] of its axes.
fn machine<const AXES: usize>(r: &mut Random) -> (MachineData<AXES>, [f64; 3]) {
    let cycle_us = within(r, CYCLES) as u32;
    let mut slowest = size(r);
    let independent = r.once_in(4);
    let mut machine = machines::machine::<AXES>(cycle_us, |_, _| {});
    for data in &mut machine.axes {
        let own = if independent { size(r) } else { slowest };
        axis(r, data, own, cycle_us);
        slowest = [slowest[0].min(own[0]), slowest[1].max(own[1]), slowest[2].min(own[2])];
    }
    let channel = &mut machine.channel;
    channel.slope_profile = (r.bits() % 4) as u8;
    channel.look_ahead = within(r, LOOK_AHEAD) as u32;
    channel.corr_v_trans_jerk = r.once_in(2);
    channel.check_jerk_on_poly_path = (r.bits() % 3) as u8;
    channel.override_weight_prog_feed = (r.bits() % 3) as u8;
    channel.ptp = true;
    channel.acceleration_weight = (r.bits() % 3) as u8;
    channel.ramp_weight = (r.bits() % 5) as u8;
    channel.cir_radial_acc_limit = r.once_in(2);
    channel.vector_unit = AccelerationUnit::MmS2;
    channel.m_synch = SynchTable::NONE
        .with(24, Synch::NoSynch)
        .with(25, Synch::MvsSns)
        .with(26, Synch::MvsSvs)
        .with(27, Synch::MnsSns);
    channel.h_synch = SynchTable::NONE.with(7, Synch::MnsSns);
    (machine, slowest)
}

/// The run of a seed; `stalls`: sometimes the planner gets no processor time.
pub fn setup<const AXES: usize>(seed: u64, stalls: bool) -> Setup<AXES> {
    let mut random = Random::new(seed ^ 0x6d61_6368_696e_6573);
    let r = &mut random;
    let (mut machine, size) = machine::<AXES>(r);
    let cycle_us = machine.channel.cycle_us;
    // From the seed itself, so that the other values stay the same.
    if [0, 6, 8].contains(&(seed % 11)) {
        machine.channel.merge_chords = (seed / 11 % 76) as u8;
    }
    // One or several axes that measure the path; only a single one may be the master.
    let feeds = if r.once_in(8) { r.bits() as usize % AXES + 1 } else { 0 };
    for _ in 0..feeds {
        let axis = &mut machine.axes[r.bits() as usize % AXES];
        axis.default_feed_axis = true;
        axis.achs_mode = MODE_LINEAR | MODE_MASTER;
    }

    // Travel in this number of ticks from stop to stop, and the highest speed.
    let spin = if AXES > 3 && r.once_in(4) { r.magnitude(1.0, 1000.0) } else { 1.0 };
    let shortest = SHORTEST[usize::from(r.once_in(3))];
    let [a, ramp, v] = [size[0], size[1] * 1e-6, size[2] * 1e-3];
    let reach = |ticks: f64| {
        let time = ticks * f64::from(cycle_us) * 1e-6;
        let speed =
            if time > 2.0 * ramp { a * (0.5 * time - 0.5 * ramp) } else { a * time * time / (8.0 * ramp) };
        let speed = speed.min(v);
        ((0.5 * speed * time / spin).clamp(shortest, 2000.0), speed)
    };
    // Sometimes so many blocks that a deep look-ahead is full.
    let many = r.once_in(12);
    let most = if many { 12.0 } else { TICKS[1] };
    let mut ticks = [r.magnitude(TICKS[0], most), r.magnitude(TICKS[0], most)];
    ticks.sort_by(f64::total_cmp);
    let (lengths, speed) = (ticks.map(|ticks| reach(ticks).0), reach(ticks[1]).1);
    // A machine that is slow relative to its cycle takes longer for the shortest block, so it gets fewer
    // blocks.
    let least =
        (16.0 * shortest * spin * ramp / a).cbrt().max(shortest * spin / v) / (f64::from(cycle_us) * 1e-6);
    let blocks = if many { r.between(60.0, 900.0) } else { r.between(5.0, 60.0) };
    let blocks = blocks.min(LONG / least).max(4.0) as usize;
    let feed = (60.0 * speed).clamp(1.0, 1e7);
    // On smaller arcs the path could turn so far in a tick that the checker could not find its direction.
    let a_max = machine.axes.iter().map(|data| data.a_max).max().unwrap_or(0);
    let least_radius =
        (f64::from(a_max) * (f64::from(cycle_us) * 1e-6).powi(2)).max(0.3 * lengths[0]).max(0.01);
    let mix = Mix {
        axes: AXES,
        blocks,
        length: lengths,
        feed: [(feed * r.magnitude(0.05, 1.0)).max(1.0), feed * r.magnitude(1.0, 4.0)],
        // An arc needs both axes of its plane among the feed axes, and is at most as long as some hundred
        // lines.
        arcs: if least_radius > (30.0 * lengths[1]).min(500.0) || feeds > 0 {
            0
        } else {
            [0, 2, 5][(r.bits() % 3) as usize]
        },
        rapids: [0, 4, 9][(r.bits() % 3) as usize],
        stops: 20,
        knee: r.magnitude(1e-4, 3.0),
        radius: [least_radius, (2.0 * lengths[1]).min(500.0).max(2.0 * least_radius)],
        turn: [lengths[0], 10.0 * lengths[1]],
        spin,
    };
    let mut program = program(seed, mix);
    program.optimised = r.once_in(2);

    let mut setup = Setup {
        machine,
        program,
        contour: String::new(),
        lines: Vec::new(),
        words: Vec::new(),
        acts: Vec::new(),
        polls: if r.once_in(4) { POLLS[(r.bits() % 2) as usize] } else { POLLS[2] },
    };
    if r.once_in(2) {
        setup.contour = contour_mode(r, &setup, lengths, 0, "ON ");
        let changes = r.once_in(3);
        for k in 1..blocks {
            let at = setup.contour.contains("POS") && r.once_in(2);
            if at || (changes && r.once_in(8)) {
                let line = match r.bits() % 6 {
                    0 if !at => "#CONTOUR MODE OFF".to_owned(),
                    1 if !at => contour_mode(r, &setup, lengths, k, "ON "),
                    _ => contour_mode(r, &setup, lengths, k, ""),
                };
                setup.lines.push((k, line));
            }
        }
    }
    setup.interrupt(r, a, feed);

    let expected = (blocks as f64 * ticks[1] * 0.7) as usize + 50;
    let holds = if r.once_in(2) { random_acts(r, expected) } else { Vec::new() };
    let acts = if r.once_in(3) { holds } else { with_overrides(r, expected, holds) };
    let mut acts = if r.once_in(3) { with_starvation(r, expected, acts) } else { acts };
    if r.once_in(4) {
        // Down to a standstill.
        let tick = (r.unit() * expected as f64) as usize;
        acts.push((tick, Act::Override(r.between(0.0, 20.0) as u16)));
        acts.push((tick + r.magnitude(1.0, 500.0) as usize, Act::Override(1000)));
    }
    acts.push((0, Act::Acknowledge(if r.once_in(3) { 0 } else { r.magnitude(1.0, 300.0) as usize })));
    acts.sort_by_key(|(tick, _)| *tick);
    setup.acts = if stalls { with_stalls(r, expected, acts) } else { acts };
    setup
}

/// A line of contour mode with a tolerance near the lengths of the blocks; `k`: the block before whose end
/// the line stands.
fn contour_mode<const AXES: usize>(
    r: &mut Random,
    setup: &Setup<AXES>,
    lengths: [f64; 2],
    k: usize,
    on: &str,
) -> String {
    let [d, e] = [(); 2].map(|()| r.magnitude(0.01 * lengths[0], lengths[1]).clamp(1e-6, 100.0));
    let masters = setup.machine.axes.iter().filter(|axis| axis.default_feed_axis).count();
    let mut method = match r.bits() % 9 {
        _ if masters == 1 && r.once_in(2) => {
            format!("DIST_MASTER SYM_DIST={d:.6} RAMP_TIME={} ACC_MIN={}", r.bits() % 200, r.bits() % 101)
        }
        0 => format!("DEV PATH_DEV={d:.6} TRACK_DEV={e:.6}"),
        1 => format!("DIST PRE_DIST={d:.6} POST_DIST={e:.6} TRACK_DEV=10"),
        2 => format!("DIST_SOFT PATH_DIST={d:.6} RAMP_TIME={} ACC_MIN={}", r.bits() % 200, r.bits() % 101),
        3 => format!("PTP PATH_DEV={d:.6}"),
        4 => format!("DIST PRE_DIST={d:.6} POST_DIST={d:.6} TRACK_DEV=10"),
        5 => format!("PTP PATH_DEV={d:.6} PATH_DIST={e:.6} MERGE={}", r.bits() % 2),
        6 => format!("DIST_SOFT PATH_DIST={d:.6} TRACK_DIST={e:.6} DIST_WEIGHT={}", r.bits() % 101),
        7 => {
            // Near the end of the block.
            let mut line = format!("POS PRE_DIST={d:.6} POST_DIST={e:.6}");
            let end = setup.program.moves.get(k).map_or(&setup.program.start, |block| &block.target);
            for (name, nm) in ["X", "Y", "Z"].into_iter().zip(end) {
                let off = r.between(-1.0, 1.0) * d.max(e) * NM as f64;
                let _ = write!(line, " {name}{}", decimal(nm + off as i64));
            }
            line
        }
        _ => format!("DEV PATH_DEV={d:.6} RELEVANT_PATH={d:.6} TRACK_DEV=10"),
    };
    let of_corners = ["DEV", "DIST ", "POS"].into_iter().any(|name| method.starts_with(name));
    if of_corners && r.once_in(3) {
        method.push_str([" CHECK_JERK=0", " CHECK_JERK=2", " CONST_VEL=1"][(r.bits() % 3) as usize]);
    }
    if method.starts_with("DEV") && r.once_in(4) {
        let _ = write!(method, " REMAIN_PART={} MAX_ANGLE={}", r.bits() % 101, r.bits() % 181);
    }
    if !method.starts_with("DIST_") && r.once_in(4) {
        method.push_str([" PRE_ACTION", " INTER_ACTION", " POST_ACTION"][(r.bits() % 3) as usize]);
    }
    format!("#CONTOUR MODE {on}[{method}]")
}

impl<const AXES: usize> Setup<AXES> {
    /// Functions, dwells and weights at random blocks. A weight never raises a speed or shortens a ramp.
    fn interrupt(&mut self, r: &mut Random, a: f64, feed: f64) {
        let blocks = self.program.moves.len();
        let cycle = f64::from(self.machine.channel.cycle_us) * 1e-6;
        if r.once_in(3) {
            let seldom = 2 + r.bits() % 10;
            for k in 0..blocks {
                let name = FUNCTIONS[r.bits() as usize % FUNCTIONS.len()];
                match r.bits() % 2 {
                    _ if !r.once_in(seldom) => {}
                    0 => self.words.push((k, name)),
                    _ => self.lines.push((k, name.to_owned())),
                }
            }
        }
        if r.once_in(4) {
            for _ in 0..1 + r.bits() % 4 {
                let dwell = format!("G04 X{:.4}", r.between(0.0, 100.0) * cycle);
                self.lines.push((r.bits() as usize % blocks, dwell));
            }
        }
        if r.once_in(4) {
            for _ in 0..1 + r.bits() % 4 {
                let percent = 20 + r.bits() % 81;
                let line = match r.bits() % 5 {
                    0 => format!("G131 = {percent}"),
                    1 => format!("G130 X{percent} Y{}", 120 - percent),
                    2 => format!("G133 = {}", 100 + percent),
                    3 => format!(
                        "#VECTOR LIMIT ON [ACC={:.3} DEC={:.3}]",
                        (a * r.between(0.2, 1.0)).max(1.0),
                        a.max(1.0)
                    ),
                    _ => format!("#VECTOR LIMIT ON [VEL={:.3}]", feed * r.magnitude(0.1, 10.0)),
                };
                self.lines.push((r.bits() as usize % blocks, line));
            }
        }
    }

    /// The NC text.
    pub fn text(&self) -> String {
        let text = self.program.text(&self.machine);
        let (head, rest) = text.split_once('\n').expect("a head");
        let mut all = format!("{head}\n");
        if !self.contour.is_empty() {
            let _ = writeln!(all, "N0 {}", self.contour);
        }
        for line in rest.lines() {
            let number =
                line.strip_prefix('N').and_then(|line| line.split(' ').next()?.parse::<usize>().ok());
            let block = number.filter(|n| *n > 0 && n.is_multiple_of(10)).map(|n| n / 10 - 1);
            for (_, line) in self.lines.iter().filter(|(k, _)| Some(*k) == block) {
                let _ = writeln!(all, "{line}");
            }
            all.push_str(line);
            for (_, word) in self.words.iter().filter(|(k, _)| Some(*k) == block) {
                let _ = write!(all, " {word}");
            }
            all.push('\n');
        }
        all
    }

    /// Runs and checks the case.
    pub fn run(&self) -> Outcome {
        self.run_within(LONGEST)
    }

    /// The same with a highest number of ticks.
    pub fn run_within(&self, longest: usize) -> Outcome {
        let start: [Position; AXES] =
            std::array::from_fn(|k| Position::from_bits(set_point(self.program.start[k])));
        let run = operate_within::<AXES, 500>(
            &self.text(),
            start,
            &self.machine,
            (&self.acts, self.polls),
            longest,
        );
        let verdict = run.and_then(|run| self.judge(&run).map(|()| run.trace.ticks()));
        match verdict {
            Ok(ticks) => Outcome::Good(ticks),
            Err(fault) if fault.ends_with(TOO_LONG) => Outcome::TooLong,
            Err(fault) if fault.ends_with("ReducedTooSlow") && self.reduces() => Outcome::Refused(fault),
            Err(fault) if fault.contains("TooFewPoints") || fault.contains("FeedAxes") => {
                Outcome::Refused(fault)
            }
            // A random target outside the permitted range of a program.
            Err(fault) if fault.contains("Range { what: \"coordinate\"") => Outcome::Refused(fault),
            Err(fault) if fault.ends_with("TooSlow)") => Outcome::Refused(fault),
            Err(fault) => Outcome::Fault(fault),
        }
    }

    /// Whether the operator asks for the reduced speed.
    fn reduces(&self) -> bool {
        self.acts.iter().any(|(_, act)| *act == Act::Reduced(true))
    }

    /// Whether the jerk of corner curves is not limited.
    fn is_unchecked(&self) -> bool {
        let lines = self.lines.iter().map(|(_, line)| line).filter(|line| line.contains('['));
        if self.contour.is_empty() {
            return false;
        }
        let mut modes = lines.filter(|line| line.starts_with("#CONTOUR")).chain([&self.contour]);
        let off = self.machine.channel.check_jerk_on_poly_path == 0;
        modes.any(|line| line.contains("CHECK_JERK=0") || (off && !line.contains("CHECK_JERK")))
    }

    /// Effect of the path's resolution on the differences of an axis. The path distance of a tick is exact to
    /// [`DISTANCE`]; the error of an axis that moves n times as far is n times this value. In contour mode
    /// the start of each curve adds [`CUT`].
    fn resolution(&self, contour: &Contour) -> Vec<Limits> {
        let cycle = f64::from(self.machine.channel.cycle_us) * 1e-6;
        // Two errors make one difference of a jump: see the sums below.
        let cut = if self.contour.is_empty() { 0.0 } else { 0.5 * CUT };
        // On axes that do not measure the path, a curve through the points is steeper than its chords in
        // places. The other axes move no further than the path.
        let chords = self.contour.contains("CONTOUR") || self.contour.is_empty();
        let steepest = |axis: usize| {
            let travel = |element: &Element| element.travel(axis).abs() / check::measured(element).max(1e-9);
            let times = contour.elements.iter().map(travel).fold(0.0, f64::max);
            let feeds = contour.elements.iter().any(|element| element.feed_axes.contains(&axis));
            if chords || feeds { times } else { 8.0 * times }
        };
        let most = (0..AXES).map(|axis| steepest(axis).max(1.0) * DISTANCE + cut);
        most.map(|r| Limits { v: 2.0 * r / cycle, a: 4.0 * r / cycle.powi(2), jerk: 8.0 * r / cycle.powi(3) })
            .collect()
    }

    /// Checks all limits at every tick and the exact end, and without contour mode the contour.
    fn judge(&self, run: &Operated) -> Result<(), String> {
        let mut contour = self.program.contour(&self.machine);
        let resolution = self.resolution(&contour);
        let with = |limits: Limits, axis: usize| {
            let Limits { v, a, jerk } = resolution[axis];
            Limits { v: limits.v + v, a: limits.a + a, jerk: limits.jerk + jerk }
        };
        let mut limits = axis_limits(&self.machine, &contour);
        for (axis, limits) in limits.iter_mut().enumerate() {
            *limits = with(*limits, axis);
            if self.is_unchecked() {
                limits.jerk = f64::INFINITY;
            }
        }
        check::limits(&run.trace, &limits)?;
        if run.aborted {
            return Ok(());
        }
        if self.contour.is_empty() {
            for feed in contour.elements.iter_mut().filter_map(|element| element.feed.as_mut()) {
                *feed *= run.over;
            }
            let start: Vec<i64> = self.program.start.iter().map(|&nm| set_point(nm)).collect();
            let rapid = |axis: &AxisData| (f64::from(axis.vb_eilgang) * 1e-3).powi(2);
            let v_rapid = self.machine.axes.iter().map(rapid).sum::<f64>().sqrt();
            check::ends(&run.trace, &start, &self.program.end_points())?;
            let course = check::path(&run.trace, &contour, path_tolerance(&contour), v_rapid)?;
            return check::by_place(&run.trace, &course, &contour, |axis, elements| {
                with(permitted_at(&self.machine, axis, &contour.elements[elements]), axis)
            });
        }
        let end: Vec<i64> = self.program.end().iter().map(|&nm| set_point(nm)).collect();
        let last = run.trace.len() - 1;
        if !run.trace.row(last).eq(end.iter().copied()) {
            return Err(format!("ends at {:?}, not at {end:?}", run.trace.row(last).collect::<Vec<_>>()));
        }
        Ok(())
    }
}

/// A seed without some of its parts, to find the cause of a fault: without an operator, without contour mode.
pub fn plain<const AXES: usize>(seed: u64, sharp: bool) -> Setup<AXES> {
    let mut setup = setup::<AXES>(seed, false);
    setup.acts.retain(|(_, act)| matches!(act, Act::Acknowledge(_)));
    if sharp {
        setup.contour.clear();
        setup.lines.retain(|(_, line)| !line.starts_with("#CONTOUR"));
    }
    setup
}

/// A seed, with the number of axes that belongs to it.
pub fn soak(seed: u64, stalls: bool) -> Outcome {
    soak_within(seed, stalls, LONGEST)
}

/// The same for so many ticks at most.
pub fn soak_within(seed: u64, stalls: bool, longest: usize) -> Outcome {
    match seed % 4 {
        0 => setup::<3>(seed, stalls).run_within(longest),
        1 => setup::<4>(seed, stalls).run_within(longest),
        2 => setup::<5>(seed, stalls).run_within(longest),
        _ => setup::<6>(seed, stalls).run_within(longest),
    }
}

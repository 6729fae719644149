//! Random machine data over their permitted ranges, random programs of about their size, and an operator: one number gives all of it.
//!
//! Lengths, radii and feeds follow from what the machine can do in some ticks, so that every run has some thousand ticks, with an
//! acceleration of 1 mm/s² at 0.1 ms as with 50 000 mm/s² at 10 ms.
use crate::cases::machines;
use crate::cases::random::{Mix, Random, program};
use crate::cases::{Program, set_point};
use crate::check;
use crate::operate::{
    Act, Operated, TOO_LONG, crawls_along, judge, operate_text, random_acts, with_overrides, with_stalls,
    with_starvation,
};
use crate::properties::axis_limits;
use glidepath::machine::{AxisData, MachineData};
use glidepath::quantity::Position;

/// What came of a seed.
#[derive(Clone, Debug, PartialEq)]
pub enum Outcome {
    /// All is well, in so many ticks.
    Good(usize),
    /// It takes longer than a run may.
    Skipped,
    /// A fault, with all that it needs.
    Fault(String),
}

/// A run from one number.
#[derive(Clone, Debug)]
pub struct Setup<const AXES: usize> {
    /// The machine.
    pub machine: MachineData<AXES>,
    /// The program without its contour mode.
    pub program: Program,
    /// A line that switches contour mode on; empty without.
    pub contour: String,
    /// No block is longer, mm or degrees.
    pub longest: f64,
    /// Commands of the operator.
    pub acts: Vec<(usize, Act)>,
    /// Calls of the planner between two ticks.
    pub polls: usize,
}

/// Ramp times, µs.
const RAMPS: [f64; 2] = [100.0, 2e6];
/// Accelerations, mm/s².
const ACCELERATIONS: [f64; 2] = [1.0, 50_000.0];
/// Largest speeds, µm/s.
const SPEEDS: [f64; 2] = [1e3, 2e9];
/// Ticks that a block takes.
const TICKS: [f64; 2] = [0.3, 400.0];

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
        _ => r.magnitude(RAMPS[0], RAMPS[1]) as u32,
    };
    data.vb_max = near(r, v, SPEEDS) as u32;
    data.vb_eilgang = (f64::from(data.vb_max) * r.between(0.2, 1.0)) as u32;
    data.vb_max_red = (f64::from(data.vb_max) * r.unit()) as u32;
    data.a_trans_weight = if r.once_in(3) { r.between(1.0, 1000.9) as u32 } else { 0 };
    data.r_trans_weight = if r.once_in(3) { r.between(0.0, 1000.9) as u32 } else { 1000 };
    let mut stage = || (f64::from(data.a_max) * r.between(0.1, 1.0)).max(1.0) as u32;
    (data.a_stufe, data.a_grenz_stufe) = ([stage(), stage()], [stage(), stage()]);
    (data.d_stufe, data.d_grenz_stufe) = ([0, stage()], [stage(), 0]);
    data.vb_stufe_1_2 = r.magnitude(1.0, f64::from(data.vb_max)) as u32;
    data.vb_grenz_stufe_1_2 = r.magnitude(1.0, f64::from(data.vb_max)) as u32;
}

/// The run of a seed; `stalls`: the planner gets no time now and then.
pub fn setup<const AXES: usize>(seed: u64, stalls: bool) -> Setup<AXES> {
    let mut random = Random::new(seed ^ 0x6d61_6368_696e_6573);
    let r = &mut random;
    let cycle_us = r.magnitude(100.0, 10_000.9) as u32;
    let size = [
        r.magnitude(ACCELERATIONS[0], ACCELERATIONS[1]),
        r.magnitude(RAMPS[0], RAMPS[1]),
        r.magnitude(SPEEDS[0], SPEEDS[1]),
    ];
    let mut machine = machines::machine::<AXES>(cycle_us, |_, _| {});
    for data in &mut machine.axes {
        axis(r, data, size, cycle_us);
    }
    let channel = &mut machine.channel;
    channel.slope_profile = (r.bits() % 4) as u8;
    channel.look_ahead = r.magnitude(10.0, 500.9) as u32;
    channel.corr_v_trans_jerk = r.once_in(2);
    channel.check_jerk_on_poly_path = (r.bits() % 3) as u8;
    channel.override_weight_prog_feed = (r.bits() % 3) as u8;
    channel.ptp = true;

    // How far it goes in so many ticks from rest to rest, and its speed then.
    let [a, ramp, v] = [size[0], size[1] * 1e-6, size[2] * 1e-3];
    let reach = |ticks: f64| {
        let time = ticks * f64::from(cycle_us) * 1e-6;
        let speed =
            if time > 2.0 * ramp { a * (0.5 * time - 0.5 * ramp) } else { a * time * time / (8.0 * ramp) };
        let speed = speed.min(v);
        ((0.5 * speed * time).clamp(1e-4, 2000.0), speed)
    };
    let mut ticks = [r.magnitude(TICKS[0], TICKS[1]), r.magnitude(TICKS[0], TICKS[1])];
    ticks.sort_by(f64::total_cmp);
    let (lengths, speed) = (ticks.map(|ticks| reach(ticks).0), reach(ticks[1]).1);
    let blocks = r.between(5.0, 60.0) as usize;
    let feed = (60.0 * speed).clamp(1.0, 1e7);
    // On smaller arcs a tick may go so far round that the judge could not tell which way.
    let a_max = machine.axes.iter().map(|data| data.a_max).max().unwrap_or(0);
    let least_radius =
        (f64::from(a_max) * (f64::from(cycle_us) * 1e-6).powi(2)).max(0.3 * lengths[0]).max(0.01);
    let mix = Mix {
        axes: AXES,
        blocks,
        length: lengths,
        feed: [(feed * r.magnitude(0.05, 1.0)).max(1.0), feed * r.magnitude(1.0, 4.0)],
        arcs: if least_radius > 500.0 { 0 } else { [0, 2, 5][(r.bits() % 3) as usize] },
        rapids: [0, 4, 9][(r.bits() % 3) as usize],
        stops: 20,
        knee: r.magnitude(1e-4, 3.0),
        radius: [least_radius, (2.0 * lengths[1]).min(500.0).max(2.0 * least_radius)],
        turn: [lengths[0], 10.0 * lengths[1]],
    };
    let mut program = program(seed, mix);
    program.optimised = r.once_in(2);

    let contour = if r.once_in(2) { String::new() } else { contour_mode(r, lengths) };
    let expected = (blocks as f64 * ticks[1] * 0.7) as usize + 50;
    let holds = if r.once_in(2) { random_acts(r, expected) } else { Vec::new() };
    let acts = if r.once_in(3) { holds } else { with_overrides(r, expected, holds) };
    let acts = if r.once_in(3) { with_starvation(r, expected, acts) } else { acts };
    let acts = if stalls { with_stalls(r, expected, acts) } else { acts };
    // Turns of a helix, and lines of rotary axes alone.
    let longest = (20.0 * lengths[1]).max(100.0);
    Setup { machine, program, contour, longest, acts, polls: 1000 }
}

/// A line that switches contour mode on, with a tolerance about the lengths of the blocks.
fn contour_mode(r: &mut Random, lengths: [f64; 2]) -> String {
    let d = r.magnitude(0.01 * lengths[0], lengths[1]).clamp(0.0001, 100.0);
    let e = r.magnitude(0.01 * lengths[0], lengths[1]).clamp(0.0001, 100.0);
    let mut method = match r.bits() % 6 {
        0 => format!("DEV PATH_DEV={d:.4} TRACK_DEV={e:.4}"),
        1 => format!("DIST PRE_DIST={d:.4} POST_DIST={e:.4} TRACK_DEV=10"),
        2 => format!("DIST_SOFT PATH_DIST={d:.4} RAMP_TIME={} ACC_MIN={}", r.bits() % 200, r.bits() % 101),
        3 => format!("PTP PATH_DEV={d:.4}"),
        4 => format!("DIST PRE_DIST={d:.4} POST_DIST={d:.4} TRACK_DEV=10"),
        _ => format!("DEV PATH_DEV={d:.4} RELEVANT_PATH={d:.4} TRACK_DEV=10"),
    };
    if (method.starts_with("DEV") || method.starts_with("DIST ")) && r.once_in(3) {
        method.push_str([" CHECK_JERK=0", " CHECK_JERK=2", " CONST_VEL=1"][(r.bits() % 3) as usize]);
    }
    format!("#CONTOUR MODE ON [{method}]")
}

impl<const AXES: usize> Setup<AXES> {
    /// The NC text.
    pub fn text(&self) -> String {
        let text = self.program.text(&self.machine);
        let (head, rest) = text.split_once('\n').expect("a head");
        if self.contour.is_empty() { text.clone() } else { format!("{head}\nN0 {}\n{rest}", self.contour) }
    }

    /// Runs it before the judge.
    pub fn run(&self) -> Outcome {
        let start: [Position; AXES] =
            std::array::from_fn(|k| Position::from_bits(set_point(self.program.start[k])));
        let run = operate_text::<AXES, 500>(&self.text(), start, &self.machine, &self.acts, self.polls);
        let verdict = run.and_then(|run| self.judge(&run).map(|()| run.trace.ticks()));
        match verdict {
            Ok(ticks) => Outcome::Good(ticks),
            Err(fault) if fault.ends_with(TOO_LONG) || fault.contains("TooSlow") => Outcome::Skipped,
            // The operator asks for a speed at which a block takes longer than one may.
            Err(fault)
                if fault.ends_with("Unplannable")
                    && crawls_along(&self.machine, &self.acts, self.longest) =>
            {
                Outcome::Skipped
            }
            Err(fault) => Outcome::Fault(fault),
        }
    }

    /// All limits at every tick and the exact end; on the contour without contour mode.
    fn judge(&self, run: &Operated) -> Result<(), String> {
        if self.contour.is_empty() {
            return judge(&self.program, &self.machine, run);
        }
        let contour = self.program.contour(&self.machine);
        let mut limits = axis_limits(&self.machine, &contour);
        let channel = &self.machine.channel;
        if self.contour.contains("CHECK_JERK=0")
            || (channel.check_jerk_on_poly_path == 0 && !self.contour.contains("CHECK_JERK"))
        {
            limits.iter_mut().for_each(|limits| limits.jerk = f64::INFINITY);
        }
        check::limits(&run.trace, &limits)?;
        if run.aborted {
            return Ok(());
        }
        let end: Vec<i64> = self.program.end().iter().map(|&nm| set_point(nm)).collect();
        let last = run.trace.len() - 1;
        if !run.trace.row(last).eq(end.iter().copied()) {
            return Err(format!("ends at {:?}, not at {end:?}", run.trace.row(last).collect::<Vec<_>>()));
        }
        Ok(())
    }
}

/// A seed without some of it, to find the cause of a fault: without an operator, without contour mode.
pub fn plain<const AXES: usize>(seed: u64, sharp: bool) -> Setup<AXES> {
    let setup = setup::<AXES>(seed, false);
    let contour = if sharp { String::new() } else { setup.contour };
    Setup { acts: Vec::new(), contour, ..setup }
}

/// A seed, with the number of axes that belongs to it.
pub fn soak(seed: u64, stalls: bool) -> Outcome {
    match seed % 4 {
        0 => setup::<3>(seed, stalls).run(),
        1 => setup::<4>(seed, stalls).run(),
        2 => setup::<5>(seed, stalls).run(),
        _ => setup::<6>(seed, stalls).run(),
    }
}

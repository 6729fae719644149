//! What must hold of every motion, whatever the program: asked of the judge, for the limits of the machine.
use crate::cases::{Program, set_point};
use crate::check::{self, Course, Limits, Peaks};
use crate::reference::geometry::{Contour, Element, Shape};
use crate::reference::merge::path_tolerance;
use crate::tolerance;
use crate::trace::{Run, Trace, run};
use glidepath::machine::{AxisData, MachineData};
use glidepath::quantity::Speed;

/// What was measured on the way.
#[derive(Clone, Debug)]
pub struct Verdict {
    /// The motion.
    pub run: Run,
    /// Its contour.
    pub contour: Contour,
    /// Largest v, a, jerk of each axis.
    pub peaks: Vec<Peaks>,
    /// Distances along the contour.
    pub course: Course,
}

/// Limits of an axis for the kinds of motion that occur. `curved`: knees and arcs accelerate axes too, then
/// tangential and normal acceleration together may reach `a_max`, and the jerk a / min(ramp time, geometric
/// ramp time).
///
/// `slope` as in P-CHAN-00071. A ramp of SIN2 has a jerk of π/2 · a / ramp time; STEP has any, and the larger
/// one of the accelerations of its stages.
pub fn permitted(axis: &AxisData, slope: u8, rapid: bool, feed: bool, curved: bool) -> Limits {
    if slope == 0 {
        let sets = [(feed, axis.vb_max, axis.stages(false)), (rapid, axis.vb_eilgang, axis.stages(true))];
        let mut limits = Limits { v: 0.0, a: 0.0, jerk: f64::INFINITY };
        for (_, v, stages) in sets.into_iter().filter(|(occurs, ..)| *occurs) {
            let a = stages.a.into_iter().chain(stages.d).fold(0, u32::max);
            limits.v = limits.v.max(f64::from(v) * 1e-3);
            limits.a = limits.a.max(f64::from(if curved { axis.a_max } else { a }));
        }
        return limits;
    }
    // 0 is preset with the smallest ramp time.
    let geometric = if axis.tr_geom == 0 { axis.tr_min } else { axis.tr_geom };
    let shape = if slope == 2 { std::f64::consts::FRAC_PI_2 } else { 1.0 };
    let mut limits = Limits { v: 0.0, a: 0.0, jerk: 0.0 };
    let mut allow = |um_s: u32, mm_s2: u32, ramps: &[u32]| {
        limits.v = limits.v.max(f64::from(um_s) * 1e-3);
        limits.a = limits.a.max(f64::from(if curved { axis.a_max } else { mm_s2 }));
        for &ramp in ramps {
            let jerk = |us: u32| f64::from(mm_s2) / (f64::from(us) * 1e-6);
            limits.jerk = limits.jerk.max(shape * jerk(ramp));
            if curved {
                limits.jerk = limits.jerk.max(jerk(ramp.min(geometric)));
            }
        }
    };
    if feed {
        allow(axis.vb_max, axis.a_beschl, &[axis.tr_beschl_zu, axis.tr_beschl_ab]);
        allow(axis.vb_max, axis.a_brems, &[axis.tr_brems_zu, axis.tr_brems_ab]);
    }
    if rapid {
        allow(axis.vb_eilgang, axis.a_grenz, &[axis.tr_grenz]);
    }
    limits
}

/// Limits of an axis at a place: inside a straight block what its slope may show; in an arc and at a joint
/// also what the contour may cause. At a joint jerk is free where the machine data permit a step: of speed
/// with P-AXIS-00013, of acceleration without P-CHAN-00009 where an arc takes part.
pub fn permitted_at<const AXES: usize>(
    machine: &MachineData<AXES>,
    axis: usize,
    elements: &[Element],
) -> Limits {
    let channel = &machine.channel;
    let is_arc = |element: &Element| element.shape != Shape::Line;
    let joint = elements.len() > 1;
    let rapid = elements.iter().any(|e| e.feed.is_none());
    let feed = elements.iter().any(|e| e.feed.is_some());
    let arc = elements.iter().any(is_arc);
    let data = &machine.axes[axis];
    let mut limits = permitted(data, channel.slope_profile, rapid, feed, joint || arc);
    widen(&mut limits, machine, elements, axis);
    if joint && (data.a_trans_weight > 0 || (arc && !channel.corr_v_trans_jerk)) {
        limits.jerk = f64::INFINITY;
    }
    limits
}

/// Asks the judge for the limits of every axis at every tick, wherever it is.
///
/// # Errors
/// The first excess.
pub fn keeps_limits<const AXES: usize>(
    trace: &Trace,
    course: &Course,
    contour: &Contour,
    machine: &MachineData<AXES>,
) -> Result<(), String> {
    check::by_place(trace, course, contour, |axis, elements| {
        permitted_at(machine, axis, &contour.elements[elements])
    })
}

/// Limits of all axes of a machine for a contour, at any of its places.
pub fn axis_limits<const AXES: usize>(machine: &MachineData<AXES>, contour: &Contour) -> Vec<Limits> {
    let rapid = contour.elements.iter().any(|e| e.feed.is_none());
    let feed = contour.elements.iter().any(|e| e.feed.is_some());
    let curved = contour.elements.len() > 1 || contour.elements.iter().any(|e| e.shape != Shape::Line);
    let slope = machine.channel.slope_profile;
    let limits = machine.axes.iter().enumerate().map(|(k, axis)| {
        let mut limits = permitted(axis, slope, rapid, feed, curved);
        widen(&mut limits, machine, &contour.elements, k);
        if curved && (axis.a_trans_weight > 0 || !machine.channel.corr_v_trans_jerk) {
            limits.jerk = f64::INFINITY;
        }
        limits
    });
    limits.collect()
}

/// How much further an axis goes on a line than the path, whose feed axes leave it out (P-CHAN-00011); 0: no
/// further.
fn gain(element: &Element, axis: usize) -> f64 {
    let length = element.feed_axes.iter().map(|&k| element.travel(k).powi(2)).sum::<f64>().sqrt();
    let gain = element.travel(axis).abs() / length;
    if element.shape == Shape::Line && length > 0.0 && gain > 1.0 { gain } else { 0.0 }
}

/// What errors of path distances add to the differences of an axis that goes further than the path: a
/// difference of order n has 2^n of them. The second one has its room inside the acceleration.
fn widen<const AXES: usize>(
    limits: &mut Limits,
    machine: &MachineData<AXES>,
    elements: &[Element],
    axis: usize,
) {
    let cycle = f64::from(machine.channel.cycle_us) * 1e-6;
    let error = elements.iter().map(|element| gain(element, axis)).fold(0.0, f64::max) * tolerance::DISTANCE;
    limits.v += 2.0 * error / cycle;
    limits.jerk += 8.0 * error / cycle.powi(3);
}

/// Runs a program and asks the judge for everything.
///
/// # Errors
/// The first fault, with the program's name.
pub fn verify<const AXES: usize, const BLOCKS: usize>(
    program: &Program,
    machine: &MachineData<AXES>,
) -> Result<Verdict, String> {
    let fault = |what: String| format!("{}: {what}\n{}", program.name, head(&program.text(machine)));
    let run = run::<AXES, BLOCKS>(program, machine).map_err(fault)?;
    let contour = program.contour(machine);
    let limits = axis_limits(machine, &contour);
    let start: Vec<i64> = program.start.iter().map(|&nm| set_point(nm)).collect();
    let points = program.end_points();
    check::ends(&run.trace, &start, &points).map_err(fault)?;
    let peaks = check::limits(&run.trace, &limits).map_err(fault)?;
    // Rapid motion: no axis faster than its limit, so the path not faster than all of them together.
    let v_rapid = machine.axes.iter().map(|a| (f64::from(a.vb_eilgang) * 1e-3).powi(2)).sum::<f64>().sqrt();
    let course = check::path(&run.trace, &contour, path_tolerance(&contour), v_rapid).map_err(fault)?;
    keeps_limits(&run.trace, &course, &contour, machine).map_err(fault)?;
    let planned: usize = run.blocks.iter().map(|span| span.blocks as usize).sum();
    if planned != contour.elements.len() {
        return Err(fault(format!("{planned} blocks planned, {} move", contour.elements.len())));
    }
    let turns = contour.elements.iter().any(|element| matches!(element.shape, Shape::Arc { .. }));
    plan_is_consistent(&run, program.optimised || turns).map_err(fault)?;
    Ok(Verdict { run, contour, peaks, course })
}

/// Blocks follow each other in order, each starts at the speed at which the last one ended, and their
/// durations and waits add up to the ticks of the motion. `within`: they may end within a block.
fn plan_is_consistent(run: &Run, within: bool) -> Result<(), String> {
    let mut v = Speed::ZERO;
    let mut n = 0;
    let mut time = 0;
    let mut first = 0;
    for (i, block) in run.blocks.iter().enumerate() {
        // NO_OPT=0, and arcs behind two turns: in the block where the one before ends.
        let goes_on = within && block.block + 1 == first && block.n >= n;
        if !goes_on && (block.block != first || block.n <= n) {
            return Err(format!("block {i} says it is {} with N{} after N{n}", block.block, block.n));
        }
        if block.v_in != v || block.v_peak < block.v_in.max(block.v_out) {
            return Err(format!(
                "block {i}: speeds {:?}, {:?}, {:?} after {v:?}",
                block.v_in, block.v_peak, block.v_out
            ));
        }
        (v, n) = (block.v_out, block.n);
        first += block.blocks;
        time += block.time.to_bits() + block.wait.to_bits();
    }
    // LSB of a time: 2^-36 tick. Laws that were made anew take longer than those told.
    let (ticks, told) = ((run.trace.ticks() as u64) << 36, time);
    let fits = if run.slower { told <= ticks } else { told == ticks };
    if v != Speed::ZERO || !fits {
        return Err(format!("ends with {v:?} after {} ticks, planned {time} / 2^36", run.trace.ticks()));
    }
    Ok(())
}

/// The first lines of a long text.
fn head(text: &str) -> String {
    text.lines().take(12).collect::<Vec<_>>().join("\n")
}

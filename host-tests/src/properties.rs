//! Properties of every motion, for every program, checked for the limits of the machine.
use crate::cases::{Program, set_point};
use crate::check::{self, Course, Limits, Peaks};
use crate::reference::geometry::{Contour, Element, Shape};
use crate::reference::merge::path_tolerance;
use crate::tolerance;
use crate::trace::{Run, Trace, run};
use glidepath::machine::{AxisData, MachineData};
use glidepath::quantity::Speed;

/// Measured values.
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

/// Limits of an axis for the kinds of motion. `curved`: corners and arcs accelerate axes too. Then tangential
/// and normal acceleration together may reach `a_max`, and the jerk may reach a / min(ramp time, geometric
/// ramp time).
///
/// `slope` as in P-CHAN-00071. A ramp of SIN2 has a jerk of π/2 · a / ramp time. STEP has unlimited jerk, and
/// the larger acceleration of its stages.
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

/// Limits of an axis at a place: inside a straight block those of the slope; in an arc and at a transition
/// also those of the contour. At a transition jerk is not limited if the machine data permit a step: of speed
/// with P-AXIS-00013, of acceleration without P-CHAN-00009 next to an arc.
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

/// Checks the limits of every axis at every tick, at every place.
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

/// Limits of all axes of a machine for a contour, at all places.
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

/// Travel of an axis on a line per travel of the path, if the axis is no feed axis (P-CHAN-00011); 0: no more
/// than the path.
fn gain(element: &Element, axis: usize) -> f64 {
    let length = element.feed_axes.iter().map(|&k| element.travel(k).powi(2)).sum::<f64>().sqrt();
    let gain = element.travel(axis).abs() / length;
    if element.shape == Shape::Line && length > 0.0 && gain > 1.0 { gain } else { 0.0 }
}

/// Effect of path distance errors on the differences of an axis that moves further than the path. A
/// difference of order n has 2^n errors; the acceleration has room for those of the second difference.
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

/// Runs a program and checks all properties.
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
    // Rapid motion: no axis exceeds its limit, so the path is no faster than all axes together.
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

/// Checks that blocks follow in order, that each block starts at the end speed of the block before, and that
/// durations and waits add up to the ticks of the motion. `within`: a speed profile may end within a block.
fn plan_is_consistent(run: &Run, within: bool) -> Result<(), String> {
    let mut v = Speed::ZERO;
    let mut n = 0;
    let mut time = 0;
    let mut first = 0;
    for (i, block) in run.blocks.iter().enumerate() {
        // With NO_OPT=0, and in arcs after two turns: in the block in which the speed profile before ends.
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
    // LSB of a time: 2^-36 tick. Replaced speed profiles take longer than the reported ones.
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

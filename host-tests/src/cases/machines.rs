//! Machines of the tests.
use super::random::Random;
use glidepath::machine::{AxisData, AxisKind, AxisName, ChannelData, MODE_LINEAR, MODE_MASTER, MachineData};

/// Names in the order of the axes.
const NAMES: [&str; 6] = ["X", "Y", "Z", "A", "B", "C"];

/// A machine of up to six axes: three linear axes, then rotary ones; `set` changes every axis.
pub fn machine<const AXES: usize>(cycle_us: u32, set: impl Fn(usize, &mut AxisData)) -> MachineData<AXES> {
    let axes = std::array::from_fn(|k| {
        let kind = if k < 3 { AxisKind::Linear } else { AxisKind::Rotary };
        let name = AxisName::new(NAMES[k]).expect("a letter");
        let mut axis = AxisData::new(name, kind);
        set(k, &mut axis);
        axis
    });
    // Jerk is limited at tangential transitions of lines and arcs too; by default (P-CHAN-00009 = 0) it is
    // not limited there.
    let channel = ChannelData { cycle_us, slope_profile: 1, corr_v_trans_jerk: true, ..ChannelData::new() };
    MachineData { axes, channel }
}

/// Sets all accelerations.
pub fn accelerations(axis: &mut AxisData, a: u32, a_max: u32) {
    axis.a_max = a_max;
    (axis.a_beschl, axis.a_brems, axis.a_grenz) = (a, a, a);
}

/// Sets all ramp times, µs.
pub fn ramps(axis: &mut AxisData, tr: u32) {
    (axis.tr_beschl_zu, axis.tr_beschl_ab) = (tr, tr);
    (axis.tr_brems_zu, axis.tr_brems_ab) = (tr, tr);
    axis.tr_grenz = tr;
}

/// The machine for motions from stop to stop: a 2000 mm/s², ramps 50 ms, v 200 mm/s. The contour may cause no
/// more acceleration and jerk than the slope, so no reserve is left when both act.
pub fn even<const AXES: usize>(cycle_us: u32) -> MachineData<AXES> {
    machine(cycle_us, |_, axis| {
        axis.vb_max = 200_000;
        axis.vb_eilgang = 200_000;
        accelerations(axis, 2000, 2000);
        ramps(axis, 50_000);
        axis.tr_geom = 50_000;
    })
}

/// The machine of the published examples: acceleration 2000 of 6000 mm/s², v 1000 mm/s, ramps 150 ms.
pub fn examples<const AXES: usize>(cycle_us: u32) -> MachineData<AXES> {
    machine(cycle_us, |_, axis| {
        axis.vb_max = 1_000_000;
        axis.vb_eilgang = 1_000_000;
        accelerations(axis, 2000, 6000);
        ramps(axis, 150_000);
    })
}

/// Four different ramp times, other deceleration than acceleration.
pub fn uneven<const AXES: usize>(cycle_us: u32) -> MachineData<AXES> {
    machine(cycle_us, |_, axis| {
        axis.vb_max = 400_000;
        axis.vb_eilgang = 350_000;
        axis.a_max = 3000;
        (axis.a_beschl, axis.a_brems, axis.a_grenz) = (2000, 1500, 2500);
        (axis.tr_beschl_zu, axis.tr_beschl_ab) = (60_000, 150_000);
        (axis.tr_brems_zu, axis.tr_brems_ab) = (100_000, 200_000);
        axis.tr_grenz = 40_000;
    })
}

/// Every axis different: a milling machine with a slow Z and quick rotary axes.
pub fn mill<const AXES: usize>(cycle_us: u32) -> MachineData<AXES> {
    machine(cycle_us, |k, axis| {
        axis.vb_max = [1_000_000, 800_000, 300_000, 120_000, 180_000, 360_000][k];
        axis.vb_eilgang = axis.vb_max / 10 * 9;
        axis.a_max = [6000, 5000, 2500, 2000, 2000, 4000][k];
        axis.a_beschl = axis.a_max / 3;
        axis.a_brems = axis.a_max / 4;
        axis.a_grenz = axis.a_max / 2;
        (axis.tr_beschl_zu, axis.tr_beschl_ab) = (60_000 + 5_000 * k as u32, 70_000);
        (axis.tr_brems_zu, axis.tr_brems_ab) = (50_000, 90_000 - 7_000 * k as u32);
        axis.tr_grenz = 45_000;
        axis.tr_geom = 10_000 + 3_000 * k as u32;
    })
}

/// The machine with a slope of P-CHAN-00071. For STEP, two stages near the accelerations of the other slopes.
pub fn with_slope<const AXES: usize>(mut machine: MachineData<AXES>, slope: u8) -> MachineData<AXES> {
    machine.channel.slope_profile = slope;
    for axis in &mut machine.axes {
        axis.a_stufe = [axis.a_beschl, axis.a_beschl / 5 * 3];
        axis.d_stufe = [axis.a_brems / 5 * 4, 0];
        axis.vb_stufe_1_2 = axis.vb_max / 4;
        axis.a_grenz_stufe = [axis.a_grenz / 5 * 3, axis.a_grenz];
        axis.d_grenz_stufe = [0, axis.a_grenz / 2];
        axis.vb_grenz_stufe_1_2 = axis.vb_eilgang / 3;
    }
    machine
}

/// The machine with these feed axes (P-CHAN-00011), all of them marked as master axes (P-AXIS-00015).
pub fn feeding<const AXES: usize>(mut machine: MachineData<AXES>, axes: &[usize]) -> MachineData<AXES> {
    for &k in axes {
        machine.axes[k].default_feed_axis = true;
        machine.axes[k].achs_mode = MODE_LINEAR | MODE_MASTER;
    }
    machine
}

/// An unrealistic machine: every axis has its own random limits, within the ranges of the parameters.
pub fn arbitrary<const AXES: usize>(seed: u64) -> MachineData<AXES> {
    let mut r = Random::new(seed);
    let cycle_us = [100, 250, 500, 1000, 2000, 4000, 10_000][(r.bits() % 7) as usize];
    let mut machine = machine(cycle_us, |k, axis| {
        let mut r = Random::new(seed.wrapping_mul(64) + k as u64 + 1);
        let mut magnitude = |low: f64, high: f64| r.magnitude(low, high) as u32;
        // At most 16 mm per tick.
        axis.vb_max = magnitude(1e4, 2e6).min(16_000_000_000_u64.div_euclid(cycle_us.into()) as u32);
        axis.a_max = magnitude(200.0, 30_000.0);
        for ramp in [
            &mut axis.tr_beschl_zu,
            &mut axis.tr_beschl_ab,
            &mut axis.tr_brems_zu,
            &mut axis.tr_brems_ab,
            &mut axis.tr_grenz,
        ] {
            *ramp = magnitude(1e4, 3e5);
        }
        axis.tr_geom = magnitude(1e3, 3e5);
        let mut part = |of: u32| (f64::from(of) * r.between(0.2, 1.0)) as u32;
        (axis.a_beschl, axis.a_brems, axis.a_grenz) = (part(axis.a_max), part(axis.a_max), part(axis.a_max));
        axis.vb_eilgang = part(axis.vb_max);
        if r.once_in(3) {
            axis.a_trans_weight = r.between(1.0, 1000.0) as u32;
        }
        stages(seed.wrapping_mul(64) + k as u64 + 33, axis);
    });
    machine.channel.look_ahead = [10, 30, 120][(r.bits() % 3) as usize];
    machine
}

/// Random stages of the slope STEP.
fn stages(seed: u64, axis: &mut AxisData) {
    let mut r = Random::new(seed);
    let mut a = || (f64::from(axis.a_max) * r.between(0.1, 1.0)) as u32;
    (axis.a_stufe, axis.a_grenz_stufe) = ([a(), a()], [a(), a()]);
    let mut d = || if r.once_in(3) { 0 } else { (f64::from(axis.a_max) * r.between(0.1, 1.0)) as u32 };
    (axis.d_stufe, axis.d_grenz_stufe) = ([d(), d()], [d(), d()]);
    axis.vb_stufe_1_2 = r.magnitude(1000.0, f64::from(axis.vb_max)) as u32;
    axis.vb_grenz_stufe_1_2 = r.magnitude(1000.0, f64::from(axis.vb_max)) as u32;
}

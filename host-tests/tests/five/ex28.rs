//! EX28 of ISG's documents: a head with C and A normal to a secant contour, with its transformation.
use glidepath::kinematics::{CaHead, Kinematic};
use glidepath::machine::{AxisData, AxisKind, AxisName, ChannelData, MachineData};
use glidepath::quantity::Position;
use host_tests::cases::machines;
use host_tests::five_axes::Machine;
use host_tests::operate::operate_transformed;
use std::path::{Path, PathBuf};

/// CA head: 150 mm from the tip to the axis of A.
const HEAD: CaHead = CaHead { param: [1_500_000, 800_000, 0, 0, 0, 0, 0, 0, 0] };

/// D3-236: 2000 mm/s² at feed, 6000 at most, 1000 mm/s and ramps of 150 ms; rotary axes 2000, 120 °/s, 60 ms.
fn machine() -> MachineData<5> {
    let axes = [("X", false), ("Y", false), ("Z", false), ("C", true), ("A", true)].map(|(name, rotary)| {
        let kind = if rotary { AxisKind::Rotary } else { AxisKind::Linear };
        let mut axis = AxisData::new(AxisName::new(name).expect("a letter"), kind);
        machines::accelerations(&mut axis, 2000, if rotary { 2000 } else { 6000 });
        machines::ramps(&mut axis, if rotary { 60_000 } else { 150_000 });
        axis.tr_geom = 10_000;
        (axis.vb_max, axis.vb_eilgang) = if rotary { (120_000, 120_000) } else { (1_000_000, 1_000_000) };
        axis
    });
    // The feed of the example is in m/min.
    let channel = ChannelData {
        cycle_us: 4000,
        slope_profile: 3,
        feedrate_factor_milli: 100,
        surface: true,
        corr_v_trans_jerk: true,
        ..ChannelData::new()
    };
    MachineData { axes, channel }
}

fn example() -> Option<String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let shared = std::env::var_os("GLIDEPATH_SHARED").map_or_else(|| root.join("../shared"), PathBuf::from);
    let text = std::fs::read_to_string(shared.join("spec/programs/D3-EX28_five_axis.nc"));
    if text.is_err() {
        println!("NOT RUN: the example is not there");
    }
    text.ok()
}

/// The points of the secant contour.
fn corners() -> Vec<[f64; 2]> {
    let angle = |k: u32| f64::from(k).to_radians() * 360.0 / 64.0;
    let mut points = vec![[-80.0, 0.0], [0.0, 0.0]];
    points.extend((1..=64).map(|k| [80.0 * angle(k).sin(), 80.0 * (1.0 - angle(k).cos())]));
    points.push([80.0, 0.0]);
    points
}

/// Distance of a point from the secant contour.
fn off(p: [f64; 2], corners: &[[f64; 2]]) -> f64 {
    let one = |w: &[[f64; 2]]| {
        let d = [w[1][0] - w[0][0], w[1][1] - w[0][1]];
        let share =
            ((p[0] - w[0][0]) * d[0] + (p[1] - w[0][1]) * d[1]) / (d[0] * d[0] + d[1] * d[1]).max(1e-30);
        let share = share.clamp(0.0, 1.0);
        (p[0] - w[0][0] - share * d[0]).hypot(p[1] - w[0][1] - share * d[1])
    };
    corners.windows(2).map(one).fold(f64::INFINITY, f64::min)
}

/// Least and largest speed of the tip in the circle, mm/s, and its largest deviation, mm.
fn circle(text: &str) -> [f64; 3] {
    let data = machine();
    let head = Machine::Head(HEAD);
    let kinematics = [Kinematic::new(9, &head.chain(), &data).expect("fits")];
    let run =
        operate_transformed::<5, 120>(text, [Position::ZERO; 5], &data, &kinematics, (&[], 1000), 1_000_000)
            .expect("runs");
    let tips: Vec<[f64; 3]> = (0..run.trace.len())
        .map(|tick| {
            let mut row = run.trace.row(tick);
            head.tip(&std::array::from_fn(|_| Position::from_bits(row.next().unwrap_or(0))))
        })
        .collect();
    let corners = corners();
    // The first block leads along the second one.
    let begins = tips.iter().position(|p| p[0] < -1.0).expect("the start of the contour");
    let deviation = tips[begins..].iter().map(|p| off([p[0], p[1]], &corners)).fold(0.0, f64::max);
    // Behind the way up to the speed, and before the one down to the corner at the end, where C stands still.
    let angle = |p: &[f64; 3]| p[0].atan2(80.0 - p[1]).to_degrees().rem_euclid(360.0);
    let speeds: Vec<f64> = tips[begins..]
        .windows(2)
        .filter(|w| w[1][1] > 5.0 && (30.0..290.0).contains(&angle(&w[1])))
        .map(|w| (w[1][0] - w[0][0]).hypot(w[1][1] - w[0][1]) / 0.004)
        .collect();
    let least = speeds.iter().copied().fold(f64::INFINITY, f64::min);
    [least, speeds.iter().copied().fold(0.0, f64::max), deviation]
}

/// D3-238, figures 27 and 28: linear blocks fluctuate; with Surface and HSC the speed is that of C at 120 °/s.
#[test]
fn the_rotary_axis_bounds_the_speed_of_the_tip() {
    let Some(text) = example() else { return };
    let [least, most, off] = circle(&text);
    println!("{least:.3} to {most:.3} mm/s, {off:.6} mm off");
    let full = 120.0 / 360.0 * std::f64::consts::TAU * 80.0;
    assert!(least > 0.99 * full && most < 1.01 * full, "{least} to {most} mm/s, of {full}");
    assert!(off < 0.1 + 10e-6, "{off} mm off");
    let [least, most, off] = circle(&text.replace("#HSC ON[SURFACE PATH_DEV 0.1]", ""));
    println!("linear blocks: {least:.3} to {most:.3} mm/s, {off:.9} mm off");
    assert!(least < 0.2 * most && off < 10e-6, "{least} to {most} mm/s, {off} mm off");
}

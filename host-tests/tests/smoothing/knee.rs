//! P-AXIS-00013: the speed at a corner without a curve. The step of each axis' speed is at most a · weight ·
//! cycle.
use glidepath::machine::MachineData;
use glidepath::quantity::Speed;
use host_tests::cases::knees::{beside, chain, turning};
use host_tests::cases::{Program, machines};
use host_tests::properties::verify;

const A: f64 = 2000.0;
const CYCLE: f64 = 0.001;
const RAMP: f64 = 0.05;

/// Ample room for the contour's acceleration and jerk, so that the weight alone decides.
fn machine(weight: u32) -> MachineData<3> {
    machines::machine(1000, |_, axis| {
        (axis.vb_max, axis.vb_eilgang) = (1_000_000, 1_000_000);
        machines::accelerations(axis, A as u32, 100_000);
        machines::ramps(axis, (RAMP * 1e6) as u32);
        axis.tr_geom = 1000;
        axis.a_trans_weight = weight;
    })
}

/// Speed at which the knee of two lines is passed, mm/s.
fn knee_speed(machine: &MachineData<3>, second: [f64; 2]) -> f64 {
    let program = Program::new("knee", 3).line(&[50.0, 0.0], 60_000.0).line(&second, 60_000.0);
    let verdict = verify::<3, 120>(&program, machine).unwrap_or_else(|fault| panic!("{fault}"));
    verdict.run.blocks[0].v_out.to_bits() as f64 / 2f64.powi(58) / CYCLE
}

/// Rows: D3-247.
#[test]
fn a_knee_is_taken_as_fast_as_its_weight_permits() {
    for (weight, part) in [(1, 0.001), (10, 0.01), (50, 0.05), (200, 0.2)] {
        let step = A * part * CYCLE;
        // Axis X loses and Y gains all of the speed at 90°; at 180° X changes by twice the speed.
        for (second, size) in [([50.0, 50.0], 1.0), ([0.0, 0.0], 2.0)] {
            let v = knee_speed(&machine(weight), second);
            assert!((v * size / step - 1.0).abs() < 1e-5, "weight {weight}: {v} mm/s, step {step}");
        }
    }
}

/// Rows: CF-12.
#[test]
fn weight_zero_is_cycle_over_ramp_time() {
    let v = knee_speed(&machine(0), [50.0, 50.0]);
    let step = A * CYCLE / RAMP * CYCLE;
    assert!((v / step - 1.0).abs() < 1e-5, "{v} mm/s, step {step}");
}

/// Speed at which a line enters a circle of 20 mm that touches it, mm/s.
fn tangential_speed(machine: &MachineData<3>) -> f64 {
    let program = Program::new("tangential", 3).line(&[50.0, 0.0], 30_000.0).arc(
        &[70.0, 20.0],
        [0.0, 20.0],
        false,
        30_000.0,
    );
    let verdict = verify::<3, 120>(&program, machine).unwrap_or_else(|fault| panic!("{fault}"));
    verdict.run.blocks[0].v_out.to_bits() as f64 / 2f64.powi(58) / CYCLE
}

/// Line to circle with a channel's switch and a weight.
fn bend(on: bool, weight: u32) -> MachineData<3> {
    let mut machine = machine(0);
    machine.channel.corr_v_trans_jerk = on;
    for axis in &mut machine.axes {
        axis.r_trans_weight = weight;
    }
    machine
}

/// P-CHAN-00009 = 1 and P-AXIS-00154: the step of acceleration, v²/R, has that part of the jerk which a
/// transition may cause: two fifths of a / ramp time, here with the geometric one of a cycle.
///
/// Rows: D3-248.
#[test]
fn a_tangential_transition_causes_the_part_of_the_jerk_that_its_weight_gives() {
    for (weight, part) in [(1, 0.001), (10, 0.01), (100, 0.1), (500, 0.5), (1000, 1.0), (0, 1.0)] {
        let v = tangential_speed(&bend(true, weight));
        let step = 0.4 * part * A;
        assert!((v * v / 20.0 / step - 1.0).abs() < 2e-4, "weight {weight}: {v} mm/s");
    }
    // A knee has its own weight.
    assert_eq!(knee_speed(&bend(true, 1), [50.0, 50.0]), knee_speed(&bend(false, 1), [50.0, 50.0]));
}

/// P-CHAN-00009 = 0: the transition is passed as fast as the circle is.
///
/// Rows: D3-262, D3-281.
#[test]
fn a_tangential_transition_may_have_any_jerk_by_default() {
    let v = tangential_speed(&bend(false, 1));
    assert!((v * v / 20.0 / A - 1.0).abs() < 1e-5, "{v} mm/s");
    // A circle of 10 mm at 6000 mm/min, with a geometric ramp of 10 ms: 100 mm/s, and 28.28 with limited
    // jerk.
    let program = Program::new("tangential", 3).line(&[50.0, 0.0], 6000.0).arc(
        &[60.0, 10.0],
        [0.0, 10.0],
        false,
        6000.0,
    );
    for slope in 1..4 {
        let speed = |on| {
            let mut machine = machines::even::<3>(1000);
            (machine.channel.slope_profile, machine.channel.corr_v_trans_jerk) = (slope, on);
            for axis in &mut machine.axes {
                axis.tr_geom = 10_000;
            }
            let verdict = verify::<3, 120>(&program, &machine).unwrap_or_else(|fault| panic!("{fault}"));
            let s = verdict.course.s;
            s.windows(2).find(|s| s[1] >= 50.0).map(|s| (s[1] - s[0]) / CYCLE)
        };
        let [free, limited] = [false, true].map(|on| speed(on).expect("the circle"));
        assert!((free / 100.0 - 1.0).abs() < 1e-3, "slope {slope}: {free} mm/s");
        assert!((limited / 28.28 - 1.0).abs() < 1e-2, "slope {slope}: {limited} mm/s");
    }
}

/// Step of the speed of Y at a knee so slight that it is to come at 180 mm/s, of lines with a feed of 200
/// mm/s, mm/s: so passing it is quicker than standing still in it, though a knee takes jerk from both lines.
fn slight_knee(machine: &MachineData<3>, step: f64) -> f64 {
    // As far as coordinates go: 1 nm.
    let rise = (50.0 * step / 180.0 * 1e6).round() * 1e-6;
    let program = Program::new("slight knee", 3).line(&[50.0, 0.0], 12_000.0).line(&[100.0, rise], 12_000.0);
    let verdict = verify::<3, 120>(&program, machine).unwrap_or_else(|fault| panic!("{fault}"));
    let v = verdict.run.blocks[0].v_out.to_bits() as f64 / 2f64.powi(58) / CYCLE;
    v * rise / 50f64.hypot(rise)
}

/// P-AXIS-00013 up to 100 %, whatever the jerk: the step of speed is all that the acceleration gives in a
/// cycle, and beside an arc what the arc leaves.
#[test]
fn a_weight_permits_any_jerk_at_a_knee() {
    for (weight, part) in [(100, 0.1), (400, 0.4), (1000, 1.0)] {
        let mut machine = machine(weight);
        for axis in &mut machine.axes {
            axis.tr_geom = (RAMP * 1e6) as u32;
        }
        let step = A * part * CYCLE;
        let taken = slight_knee(&machine, step);
        assert!((taken / step - 1.0).abs() < 1e-5, "weight {weight}: {taken} mm/s of {step}");
        // All acceleration belongs to the knee, but for what the ramps of the slope are within a tick.
        for axis in &mut machine.axes {
            axis.a_max = A as u32;
        }
        let near = 0.4 * A * CYCLE / RAMP / 3.0;
        let step = (A * part).min(A - near) * CYCLE;
        let taken = slight_knee(&machine, step);
        assert!((taken / step - 1.0).abs() < 1e-5, "weight {weight}: {taken} mm/s of {step}");
    }
}

/// An axis turns back at the ends of a block of half a micrometre in which it rests, or over several of them: all
/// those knees are in one tick, and have what one may have.
#[test]
fn knees_within_a_tick_share_what_one_may_take() {
    let [there, back] = [[1.0, 1.0], [1.0, -1.0]];
    let turns: [&[[f64; 2]]; 5] = [
        &[there, [0.000_5, 0.0], back],
        &[there, [0.000_5, 0.000_25], [0.000_5, 0.0], back],
        &[there, [0.000_1, 0.000_04], [0.000_2, 0.0], [0.000_1, -0.000_04], back],
        &[there, [0.000_01, 0.0], [0.000_01, -0.000_01], [0.000_01, -0.000_02], [0.000_01, -0.000_03]],
        &[there, [0.000_5, 0.0], back, [0.000_5, 0.0], there, [0.000_5, 0.0], back],
    ];
    for slope in 1..3 {
        for blocks in turns {
            let (program, machine) = (beside(blocks), turning(slope));
            verify::<4, 120>(&program, &machine)
                .unwrap_or_else(|fault| panic!("{slope}, {blocks:?}: {fault}"));
        }
    }
}

/// Speed of each block's end, and the highest one in it, mm/s.
fn speeds(blocks: &[[f64; 2]], slope: u8) -> Vec<[f64; 2]> {
    let verdict = verify::<4, 120>(&beside(blocks), &turning(slope));
    let verdict = verdict.unwrap_or_else(|fault| panic!("{slope}, {blocks:?}: {fault}"));
    let mm_s = |v: Speed| v.to_bits() as f64 / 2f64.powi(58) / CYCLE;
    verdict.run.blocks.iter().map(|block| [block.v_out, block.v_peak].map(mm_s)).collect()
}

/// What a block of half a micrometre between two knees costs is a tick: its own speed is lower, that at the knees is not.
/// It is not where the steps are of opposite sign, or where both together are no more than one may be.
#[test]
fn knees_that_share_a_tick_are_as_fast_as_alone() {
    let alone = 100.0 * 0.95 * CYCLE;
    let third = 0.000_5 / 3.0 / CYCLE;
    let tests = [
        ([1.0, 1.0], [1.0, -1.0], alone, true),
        ([1.0, 1.0], [1.0, 1.0], alone, false),
        ([1.0, 0.228], [1.0, -0.228], third, false),
    ];
    for slope in 1..3 {
        for (there, back, v, slow) in tests {
            let [before, between, _] = speeds(&[there, [0.000_5, 0.0], back], slope)[..] else {
                panic!("three blocks")
            };
            for end in [before[0], between[0]] {
                assert!((end / v - 1.0).abs() < 1e-4, "slope {slope}, {back:?}: {end} mm/s, alone {v}");
            }
            // Its ends are rounded to 2^-32 mm.
            let length = 0.000_5 / CYCLE * (1.0 + 1e-6);
            assert_eq!(between[1] <= length, slow, "slope {slope}, {back:?}: {} mm/s", between[1]);
        }
    }
}

/// Chains of short blocks with knees of all sizes: `GLIDEPATH_FROM` and `GLIDEPATH_SEEDS` take others.
#[test]
fn random_chains_of_knees_keep_every_limit() {
    let given = |name: &str| std::env::var(name).ok().and_then(|value| value.parse::<u64>().ok());
    let (from, count) = (given("GLIDEPATH_FROM").unwrap_or(0), given("GLIDEPATH_SEEDS").unwrap_or(300));
    let faults: Vec<String> = (from..from + count)
        .filter_map(|seed| {
            let (program, machine) = chain(seed);
            verify::<4, 120>(&program, &machine).err().map(|fault| format!("{seed}: {fault}"))
        })
        .collect();
    assert!(faults.is_empty(), "{} of {count}: {:#?}", faults.len(), &faults[..faults.len().min(10)]);
}

//! P-AXIS-00013: how fast a knee is taken. The step of each axis' speed is at most a · weight · cycle.
use glidepath::machine::MachineData;
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

/// P-CHAN-00009 and P-AXIS-00154: the step of acceleration, v²/R, is at most a · weight.
#[test]
fn a_tangential_transition_is_taken_as_fast_as_its_weight_permits() {
    let bend = |on, weight| {
        let mut machine = machine(0);
        machine.channel.corr_v_trans_jerk = on;
        for axis in &mut machine.axes {
            axis.r_trans_weight = weight;
        }
        machine
    };
    for (weight, part) in [(1, 0.001), (10, 0.01), (100, 0.1), (0, CYCLE / RAMP)] {
        let v = tangential_speed(&bend(true, weight));
        assert!((v * v / 20.0 / (A * part) - 1.0).abs() < 1e-5, "weight {weight}: {v} mm/s");
    }
    // Never more than the jerk permits, which is in force without the parameters too.
    let free = tangential_speed(&bend(false, 1));
    assert!(tangential_speed(&bend(true, 100)) < free);
    assert_eq!(tangential_speed(&bend(true, 1000)), free);
    // A knee has its own weight.
    assert_eq!(knee_speed(&bend(true, 1), [50.0, 50.0]), knee_speed(&bend(false, 1), [50.0, 50.0]));
}

//! Independent axes under a transformation.
use glidepath::kinematics::{AXES, Chain, Kinematic};
use glidepath::machine::MachineData;
use host_tests::beside::{Run, run_transformed};
use host_tests::five_axes;

/// A program on one of the machines.
fn run(machine: usize, data: &MachineData<AXES>, text: &str) -> Result<Run, String> {
    let chain = five_axes::machines()[machine].chain();
    let kinematics = [Kinematic::new(9, &chain, data).expect("fits")];
    run_transformed(text, data, &kinematics, &[], 40)
}

/// A8-044, CF-34: under a transformation the axis along machine z oscillates while the tip moves across it. Other axes
/// of the machine do not, nor does any where the linear axes are not at right angles to one another.
#[test]
fn the_axis_along_machine_z_alone_oscillates() {
    let data = super::transformed::axes(1);
    let oscillates = |machine: usize, axis: &str| {
        let text = format!(
            "#TRAFO ON\n{axis}[OSC ON 1ST_POS=-5 2ND_POS=5 FREQ=2 NBR_OSC=4]\nG91 G01 X50 Y20 F1000\n#TRAFO OFF\nM30\n"
        );
        run(machine, &data, &text)
    };
    let run_of_z = oscillates(0, "Z").expect("runs");
    let column = |axis: usize| run_of_z.axes[axis].iter().map(|x| *x as f64 / (1u64 << 32) as f64);
    let [low, high] = [f64::min, f64::max].map(|of| column(2).reduce(of).expect("ticks"));
    assert!((low + 5.0).abs() < 1e-9 && (high - 5.0).abs() < 1e-9, "{low} to {high}");
    // Both at once: the tip is on its way while the axis turns back.
    let both = (0..run_of_z.axes[0].len()).filter(|t| {
        let moves = |axis: usize| *t > 0 && run_of_z.axes[axis][*t] != run_of_z.axes[axis][*t - 1];
        moves(0) && moves(2)
    });
    assert!(both.count() > 200);
    for axis in ["X", "Y", "A", "B", "C"] {
        // The CA head of these machines has C and A at the places of A and B.
        let refused = axis != "C";
        let error = oscillates(0, axis).err();
        assert_eq!(error.is_some(), refused, "{axis}: {error:?}");
        assert!(error.is_none_or(|error| error.contains("along machine z")), "{axis}");
    }
    // Linear axes that are not at right angles are no Cartesian base.
    let mut askew = *five_axes::universal([0, 1, 2, 3, 4, 5], &[([1.0, 0.0, 0.0], [0; 3])]);
    askew.axis[0].orientation = [1.0, 0.0, 0.2];
    let chain = Chain::universal(&askew).expect("a machine");
    let kinematics = [Kinematic::new(9, &chain, &data).expect("fits")];
    let text = "#TRAFO ON\nZ[OSC ON 1ST_POS=-5 2ND_POS=5 FREQ=2 NBR_OSC=4]\nM30\n";
    let refused = run_transformed(text, &data, &kinematics, &[], 40).err();
    assert!(refused.is_some_and(|error| error.contains("at right angles")));
    // Independent motions of its axes are refused, those of others are not.
    let moves = |axis: &str| {
        let text = format!("#TRAFO ON\n{axis}[INDP_SYN G01 G90 POS=3 FEED=100]\nM30\n");
        run(0, &data, &text).err()
    };
    assert!(moves("X").is_some_and(|error| error.contains("independent motion")));
    assert_eq!(moves("C"), None);
}

/// A motion of the tip that moves the axis ends its oscillation first.
#[test]
fn a_motion_that_carries_the_axis_ends_its_oscillation() {
    let data = super::transformed::axes(1);
    let text = "#TRAFO ON\nZ[OSC ON 1ST_POS=-5 2ND_POS=5 FREQ=2]\nG91 G01 B20 F1000\n#TRAFO OFF\nM30\n";
    let run = run(0, &data, text).expect("runs");
    run.keeps_limits(&data, 1, true).expect("limits");
}

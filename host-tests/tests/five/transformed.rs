//! Programs under a transformation: the tip on its path by matrices, and the limits of every axis at every tick.
use glidepath::kinematics::{AXES, Kinematic};
use glidepath::machine::{AxisKind, MachineData};
use glidepath::quantity::Position;
use host_tests::cases::machines;
use host_tests::check;
use host_tests::five_axes::{self, Machine};
use host_tests::operate::{Act, Operated, operate_transformed};
use host_tests::properties::permitted;

const BLOCKS: usize = 120;

/// The axes of a machine, six at most: three linear and three rotary ones.
fn axes(slope: u8) -> MachineData<AXES> {
    let mut machine = machines::machine::<AXES>(1000, |_, _| {});
    for (k, axis) in machine.axes.iter_mut().enumerate() {
        machines::accelerations(axis, 2000, 6000);
        machines::ramps(axis, 60_000);
        (axis.vb_max, axis.vb_eilgang) = (500_000, 500_000);
        axis.tr_geom = 10_000;
        if k >= 3 {
            axis.kind = AxisKind::Rotary;
            (axis.vb_max, axis.vb_eilgang) = (120_000, 120_000);
        }
    }
    machine.channel.slope_profile = slope;
    (machine.channel.surface, machine.channel.ptp) = (true, true);
    machine
}

fn run(machine: &Machine, data: &MachineData<AXES>, text: &str, acts: &[(usize, Act)]) -> Result<Operated, String> {
    let kinematics = [Kinematic::new(9, &machine.chain(), data).map_err(|e| e.to_string())?];
    let start = [Position::ZERO; AXES];
    operate_transformed::<AXES, BLOCKS>(text, start, data, &kinematics, (acts, 40), 1_000_000)
}

/// Limits of every axis at every tick.
fn keeps_limits(data: &MachineData<AXES>, run: &Operated) {
    let slope = data.channel.slope_profile;
    let limits: Vec<_> = data.axes.iter().map(|axis| permitted(axis, slope, true, true, true)).collect();
    check::limits(&run.trace, &limits).expect("limits");
}

/// The tip at every tick, mm.
fn tips(machine: &Machine, run: &Operated) -> Vec<[f64; 3]> {
    let rows = (0..run.trace.len()).map(|tick| {
        let mut row = run.trace.row(tick);
        std::array::from_fn(|_| Position::from_bits(row.next().unwrap_or(0)))
    });
    rows.map(|axes| machine.tip(&axes)).collect()
}

#[test]
fn a_line_of_the_tip() {
    for machine in &five_axes::machines() {
        for slope in [1, 3] {
            let data = axes(slope);
            let text = "N10 G01 X10 Y20 Z30 F6000\nN15 A10 B20\nN20 #TRAFO ON\nN30 G91 X30 Y-20 A20 B-35\nN40 G02 X10 Y10 I10 A5\nN50 #TRAFO OFF\nN60 G01 G90 X0 Y0 Z0\nM30\n";
            let run = run(machine, &data, text, &[]).expect("runs");
            keeps_limits(&data, &run);
            let tips = tips(machine, &run);
            println!("{} ticks, {:?}", tips.len(), tips.last());
        }
    }
}

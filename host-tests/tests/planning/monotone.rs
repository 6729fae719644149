//! The path distance never runs backward, and no rounding at the end of a block shows in a set point.
use glidepath::channel::{Channel, Handles};
use glidepath::machine::{AxisData, AxisKind, AxisName, ChannelData, MachineData};
use glidepath::quantity::Position;
use glidepath::tick::State;
use host_tests::calls::call;

fn machine(cycle_us: u32, v: u32, a: u32, tr: [u32; 4]) -> MachineData<3> {
    let axis = |name| AxisData {
        vb_max: v,
        vb_eilgang: v,
        a_max: 6000,
        a_beschl: a,
        a_brems: a,
        a_grenz: a,
        tr_min: 1000,
        tr_beschl_zu: tr[0],
        tr_beschl_ab: tr[1],
        tr_brems_zu: tr[2],
        tr_brems_ab: tr[3],
        tr_grenz: 50_000,
        ..AxisData::new(AxisName::new(name).expect("a name"), AxisKind::Linear)
    };
    let channel = ChannelData { cycle_us, slope_profile: 1, corr_v_trans_jerk: true, ..ChannelData::new() };
    MachineData { axes: [axis("X"), axis("Y"), axis("Z")], channel }
}

/// Smallest step of the path distance and largest step of a set point in one tick, LSB.
fn steps(machine: &MachineData<3>, program: &str) -> (i64, i64) {
    let mut channel = Box::new(Channel::<3, 120>::new());
    let Handles { mut planner, mut interpolator, .. } =
        channel.split(machine, [Position::ZERO; 3], program.as_bytes()).expect("a machine");
    let (mut done, mut last) = (false, (0i64, [0i64; 3]));
    let (mut smallest, mut largest) = (i64::MAX, 0);
    loop {
        done = done || call(&mut planner, usize::MAX, |_| {}).expect("a program");
        if interpolator.tick() == State::Idle && done {
            return (smallest, largest);
        }
        let distance = interpolator.telemetry().distance.to_bits();
        let points = interpolator.set_points().map(|x| x.to_bits());
        smallest = smallest.min(distance.wrapping_sub(last.0));
        largest = points.iter().zip(last.1).map(|(x, y)| (x - y).abs()).fold(largest, i64::max);
        last = (distance, points);
    }
}

#[test]
fn the_path_distance_never_runs_backward() {
    let mut state = 0x9e37_79b9_7f4a_7c15u64;
    let mut random = |from: f64, to: f64| {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        from + (to - from) * ((state >> 11) as f64 / (1u64 << 53) as f64)
    };
    for case in 0..300 {
        let ramps = [0; 4].map(|_: u32| random(10_000.0, 150_000.0) as u32);
        let cycle = [100, 250, 1000, 2000][case % 4];
        let machine = machine(cycle, 200_000, random(200.0, 5000.0) as u32, ramps);
        let mut program = String::new();
        for _ in 0..12 {
            let (x, y, f) = (random(-40.0, 40.0), random(-40.0, 40.0), random(500.0, 12_000.0));
            program += &format!("G01 X{x:.6} Y{y:.6} F{f:.0}\n");
        }
        program += "G02 X0 Y0 R200\nG01 X10\nM30\n";
        let (smallest, _) = steps(&machine, &program);
        assert!(smallest >= 0, "case {case}: {smallest} LSB of 2^-44 mm\n{program}");
    }
}

#[test]
fn a_length_just_below_a_power_of_two_is_not_passed() {
    // 16 mm less a few LSB of the path distance: the normalised distance must not reach its sign bit.
    let machine = machine(1000, 100_000, 500, [90_751, 95_950, 64_218, 121_924]);
    let (smallest, largest) = steps(&machine, "G01 X2.806462547 Y15.751944895 F6000\nM30\n");
    assert!(smallest >= 0);
    // 100 mm/s at 1 ms
    assert!(largest <= (0.1 * 4_294_967_296.0) as i64 + 1, "{largest}");
}

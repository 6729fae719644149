//! A queue with less room, and ways to a standstill with fewer pieces: the motion is inside its limits whenever the
//! planner gets no time, stands, and goes on where it stood.
use glidepath::{
    AxisData, AxisKind, AxisName, Channel, ChannelData, Handles, MachineData, Position, Progress, State,
};
use std::fmt::Write;

/// mm/s².
const ACCELERATION: u32 = 3000;
/// Ticks in which any motion here comes to rest.
const STALL: usize = 1000;

const fn axis(name: &str) -> AxisData {
    match AxisName::new(name) {
        Some(name) => AxisData {
            a_max: ACCELERATION,
            a_beschl: ACCELERATION,
            a_brems: ACCELERATION,
            a_grenz: ACCELERATION,
            ..AxisData::new(name, AxisKind::Linear)
        },
        None => panic!("not a name"),
    }
}

fn machine(slope: u8) -> MachineData<3> {
    MachineData {
        axes: [axis("X"), axis("Y"), axis("Z")],
        channel: ChannelData { slope_profile: slope, look_ahead: 30, ..ChannelData::new() },
    }
}

/// A chain of short blocks that turn by half a degree to and fro, and where it ends.
fn chain() -> (String, [f64; 2]) {
    let (mut program, mut at) = (String::from("G01 F20000\n"), [0.0, 0.0]);
    for k in 0..150 {
        at = [at[0] + 0.8, if k % 2 == 0 { 0.007 } else { 0.0 }];
        let _ = writeln!(program, "X{:.3} Y{:.3}", at[0], at[1]);
    }
    program.push_str("M30\n");
    (program, at)
}

/// Largest acceleration of an axis, mm/s², where the axes stand at the end, and how often they stood. The planner gets
/// no time behind the tick `from`.
fn run(program: &str, slope: u8, from: usize) -> (f64, [f64; 3], u32) {
    let mut memory = Box::new(Channel::<3, 30>::new());
    let machine = machine(slope);
    let handles = memory.split(&machine, [Position::ZERO; 3], program.as_bytes()).expect("machine data");
    let Handles { mut planner, mut interpolator, .. } = handles;
    let mut points = vec![[0.0; 3]; 2];
    let mut stood = 0;
    loop {
        let stalls = (from..from + STALL).contains(&points.len());
        let progress = if stalls { Progress::Waiting } else { planner.poll().expect("it is carried out") };
        match progress {
            Progress::Done | Progress::Waiting => {
                let state = interpolator.tick();
                if state == State::Idle && progress == Progress::Done {
                    break;
                }
                points.push(interpolator.set_points().map(Position::to_num::<f64>));
            }
            Progress::Late => stood += 1,
            _ => {}
        }
        assert!(points.len() < 100_000, "it does not end");
    }
    let second = points.windows(3).flat_map(|w| [0, 1, 2].map(|k| (w[2][k] - 2.0 * w[1][k] + w[0][k]).abs()));
    let cycle = f64::from(machine.channel.cycle_us) * 1e-6;
    (second.fold(0.0, f64::max) / (cycle * cycle), points[points.len() - 1], stood)
}

#[test]
fn a_planner_without_time_leaves_a_motion_inside_its_limits() {
    let (program, end) = chain();
    for slope in [0, 1, 2] {
        let (plain, ..) = run(&program, slope, usize::MAX - STALL);
        let mut stands = 0;
        for from in (2..400).step_by(13) {
            let (most, at, stood) = run(&program, slope, from);
            let what = format!("slope {slope}, tick {from}: {most} mm/s², {at:?}");
            assert!(most <= plain.max(f64::from(ACCELERATION)) * 1.001, "{what}, {plain} without");
            assert!((at[0] - end[0]).abs() < 1e-6 && (at[1] - end[1]).abs() < 1e-6, "{what}");
            stands += stood;
        }
        assert!(stands > 10, "slope {slope}: {stands} standstills");
    }
}

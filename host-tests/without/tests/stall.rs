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

/// What came of a run.
struct Run {
    /// Largest acceleration of an axis, mm/s².
    most: f64,
    /// Where the axes stand at the end, mm.
    at: [f64; 3],
    ticks: usize,
    /// How often the planner came late, and how often the motion was made slower for a way without room.
    stood: u32,
    slowed: u32,
}

/// A run in which the planner gets no time behind the tick `from` for so many ticks.
fn run(program: &str, machine: &MachineData<3>, from: usize, stall: usize) -> Run {
    let mut memory = Box::new(Channel::<3, 30>::new());
    let handles = memory.split(machine, [Position::ZERO; 3], program.as_bytes()).expect("machine data");
    let Handles { mut planner, mut interpolator, .. } = handles;
    let mut points = vec![[0.0; 3]; 2];
    let (mut stood, mut slowed) = (0, 0);
    loop {
        let stalls = (from..from + stall).contains(&points.len());
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
            Progress::Slower => slowed += 1,
            _ => {}
        }
        assert!(points.len() < 1_000_000, "it does not end");
    }
    let second = points.windows(3).flat_map(|w| [0, 1, 2].map(|k| (w[2][k] - 2.0 * w[1][k] + w[0][k]).abs()));
    let cycle = f64::from(machine.channel.cycle_us) * 1e-6;
    let most = second.fold(0.0, f64::max) / (cycle * cycle);
    Run { most, at: points[points.len() - 1], ticks: points.len(), stood, slowed }
}

#[test]
fn a_planner_without_time_leaves_a_motion_inside_its_limits() {
    let (program, end) = chain();
    for slope in [0, 1, 2] {
        let machine = machine(slope);
        let plain = run(&program, &machine, usize::MAX - STALL, STALL).most;
        let mut stands = 0;
        for from in (2..400).step_by(13) {
            let Run { most, at, stood, .. } = run(&program, &machine, from, STALL);
            let what = format!("slope {slope}, tick {from}: {most} mm/s², {at:?}");
            assert!(most <= plain.max(f64::from(ACCELERATION)) * 1.001, "{what}, {plain} without");
            assert!((at[0] - end[0]).abs() < 1e-6 && (at[1] - end[1]).abs() < 1e-6, "{what}");
            stands += stood;
        }
        assert!(stands > 10, "slope {slope}: {stands} standstills");
    }
}

/// Ramps of two seconds at 0.1 ms: a way from the speed of this line has more pieces than there is room for.
#[test]
fn a_way_without_room_makes_the_motion_slower() {
    const RAMP_US: u32 = 2_000_000;
    const STAND: usize = 40_000;
    let mut slow = machine(1);
    slow.channel.cycle_us = 100;
    for axis in &mut slow.axes {
        axis.vb_max = 1_000_000;
        (axis.tr_beschl_ab, axis.tr_beschl_zu, axis.tr_grenz) = (RAMP_US, RAMP_US, RAMP_US);
        (axis.tr_brems_ab, axis.tr_brems_zu, axis.tr_min) = (RAMP_US, RAMP_US, RAMP_US);
    }
    let program = "G01 X2000 F60000\nX2001 Y2\nM30\n";
    let plain = run(program, &slow, usize::MAX - STAND, STAND);
    assert_eq!(plain.slowed, 1);
    // With room it takes 39,829 ticks: it is slower, and no crawl.
    assert!((40_000..120_000).contains(&plain.ticks), "{}", plain.ticks);
    for from in (2..plain.ticks).step_by(2999) {
        let Run { most, at, stood, .. } = run(program, &slow, from, STAND);
        assert!(most <= f64::from(ACCELERATION) * 1.001, "tick {from}: {most} mm/s²");
        assert!((at[0] - 2001.0).abs() < 1e-6 && (at[1] - 2.0).abs() < 1e-6, "tick {from}: {at:?}");
        assert!(stood <= plain.stood + 1, "tick {from}: {stood}");
    }
}

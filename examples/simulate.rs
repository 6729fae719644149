//! Runs a program given as a string and prints where the axes are, every 100 ticks.
//!
//! `cargo run --release -p glidepath --example simulate`
use glidepath::{
    AxisData, AxisKind, AxisName, Channel, ChannelData, Handles, MachineData, Position, Progress, State,
};

const PROGRAM: &[u8] = b"N10 G01 X40 F6000
N20 G03 X40 Y20 J10
N30 G01 X0
M30
";

/// An axis of 2000 mm/s² with the ISG default for everything else.
fn axis(name: &str) -> Option<AxisData> {
    let name = AxisName::new(name)?;
    Some(AxisData {
        a_beschl: 2000,
        a_brems: 2000,
        a_grenz: 2000,
        a_max: 2000,
        ..AxisData::new(name, AxisKind::Linear)
    })
}

/// Runs the example.
pub fn main() -> Result<(), Box<dyn std::error::Error>> {
    let axes = [axis("X"), axis("Y"), axis("Z")].map(|axis| axis.expect("a name of an axis"));
    let channel = ChannelData { slope_profile: 1, corr_v_trans_jerk: true, ..ChannelData::new() };
    let machine = MachineData { axes, channel };
    let mut memory = Box::new(Channel::<3, 120>::new());
    let Handles { mut planner, mut interpolator, operator } =
        memory.split(&machine, [Position::ZERO; 3], PROGRAM)?;
    let mut done = false;
    loop {
        while !done {
            match planner.poll().map_err(|error| format!("line {}: {error}", error.place().line))? {
                Progress::Done => done = true,
                Progress::Waiting => break,
                _ => {}
            }
        }
        let state = interpolator.tick();
        let status = operator.status();
        if status.ticks % 100 == 0 {
            let [x, y, _] = interpolator.set_points().map(|position| position.to_num::<f64>());
            println!("{:6} ticks  N{}  X {x:9.4}  Y {y:9.4}", status.ticks, status.n);
        }
        if done && state == State::Idle {
            let [x, y, _] = interpolator.set_points().map(|position| position.to_num::<f64>());
            println!("{:6} ticks  end  X {x:9.4}  Y {y:9.4}", status.ticks);
            assert_eq!([x, y], [0.0, 20.0]);
            return Ok(());
        }
    }
}

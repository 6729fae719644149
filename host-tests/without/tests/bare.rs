//! A build without the `#` commands refuses each of them with what it needs, and runs the lines around it.
#![cfg(not(feature = "commands"))]
use glidepath::{AxisData, AxisKind, AxisName, Channel, ChannelData, Handles, MachineData, Position, Progress, State};

#[test]
fn a_hash_command_is_refused_by_its_name_and_the_channel_goes_on() {
    let axis = |name| AxisData::new(AxisName::new(name).expect("a name"), AxisKind::Linear);
    let channel = ChannelData { slope_profile: 1, look_ahead: 30, ..ChannelData::new() };
    let machine = MachineData { axes: [axis("X"), axis("Y"), axis("Z")], channel };
    for command in ["#SLOPE [TYPE=STEP]", "#CONTOUR MODE OFF", "#VECTOR LIMIT ON [ACC=100]", "#NOTHING", "#"] {
        let program = format!("G01 X1 F1000\n{command}\nY3 M5\nM30\n");
        let mut memory = Box::new(Channel::<3, 30>::new());
        let handles = memory.split(&machine, [Position::ZERO; 3], program.as_bytes()).expect("machine data");
        let Handles { mut planner, mut interpolator, operator } = handles;
        let mut refused = Vec::new();
        loop {
            match planner.poll() {
                Ok(Progress::Done) if interpolator.tick() == State::Idle => {
                    if planner.go_on().is_err() {
                        break;
                    }
                }
                Ok(Progress::Done | Progress::Waiting) => _ = interpolator.tick(),
                Ok(_) => {}
                Err(error) => refused.push((error.place().line, error.place().column, error.to_string())),
            }
            while operator.output().is_some() {}
        }
        let [(2, 1, message)] = refused.as_slice() else { panic!("{command}: {refused:?}") };
        assert!(message.ends_with("expected the library's feature `commands`"), "{command}: {message}");
        assert_eq!(interpolator.set_points().map(Position::to_num), [1.0, 3.0, 0.0], "{command}");
    }
}

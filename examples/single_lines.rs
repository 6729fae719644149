//! One channel takes lines one by one, as from a keyboard. A refused line costs that line.
//!
//! `cargo run --release -p glidepath --example single_lines`
use glidepath::{
    AxisData, AxisKind, AxisName, Channel, ChannelData, Handles, MachineData, Position, Progress, State,
};

const LINES: [&[u8]; 5] = [b"G01 X10 F3000", b"Y5", b"X20 Q1", b"G91 X-4", b"G90 Y0"];

/// Runs the example.
pub fn main() -> Result<(), Box<dyn std::error::Error>> {
    let axes =
        ["X", "Y", "Z"].map(|name| AxisData::new(AxisName::new(name).expect("a name"), AxisKind::Linear));
    let machine = MachineData { axes, channel: ChannelData { slope_profile: 1, ..ChannelData::new() } };
    let mut memory = Box::new(Channel::<3, 120>::new());
    let first: &[u8] = b"";
    let Handles { mut planner, mut interpolator, .. } = memory.split(&machine, [Position::ZERO; 3], first)?;
    let mut refused = 0;
    for line in LINES {
        // The axes stand: the channel takes another line. Feed and modal functions stay in force.
        while !planner.is_at_rest() {
            _ = planner.poll();
            _ = interpolator.tick();
        }
        planner.continue_with(line)?;
        loop {
            match planner.poll() {
                Ok(Progress::Done) if interpolator.tick() == State::Idle => break,
                Ok(Progress::Waiting) => _ = interpolator.tick(),
                Ok(_) => {}
                Err(error) => {
                    refused += 1;
                    println!("{}: column {}: {error}", String::from_utf8_lossy(line), error.place().column);
                }
            }
        }
        let [x, y, _] = interpolator.set_points().map(|position| position.to_num::<f64>());
        println!("{:16} X {x:7.3}  Y {y:7.3}", String::from_utf8_lossy(line));
    }
    assert_eq!((refused, interpolator.set_points()[0]), (1, Position::from_num(6)));
    Ok(())
}

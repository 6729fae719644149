//! An oscillating axis beside the path, and FIR filters behind it.
//!
//! `cargo run --release -p glidepath --example beside`
use glidepath::channel::FilteredHandles;
use glidepath::fir::Filters;
use glidepath::machine::FilterType;
use glidepath::{AxisData, AxisKind, AxisName, Channel, ChannelData, MachineData, Position, Progress, State};

const PROGRAM: &[u8] = b"N10 Z[OSC ON 1ST_POS=-2 2ND_POS=2 FREQ=2]
N20 #FILTER ON
N30 G01 X40 F3000
N40 Y10
N50 Z[OSC OFF]
M30
";

/// Runs the example.
pub fn main() -> Result<(), Box<dyn std::error::Error>> {
    let axes = ["X", "Y", "Z"].map(|name| {
        let mut axis = AxisData::new(AxisName::new(name).expect("a name"), AxisKind::Linear);
        axis.filter.kind = FilterType::Average; // P-AXIS-00586
        axis.filter.order = 20; // P-AXIS-00587
        axis
    });
    let machine = MachineData { axes, channel: ChannelData { slope_profile: 1, ..ChannelData::new() } };
    // Memory for one axis beside the path, and for filters of up to 40 taps.
    let mut memory = Box::new(Channel::<3, 120, 1>::new());
    let mut filters = Box::new(Filters::<3, 40>::new());
    let handles = memory.split_filtered(&mut filters, &machine, [Position::ZERO; 3], PROGRAM)?;
    let FilteredHandles { mut planner, mut interpolator, .. } = handles;
    let (mut lowest, mut highest, mut done) = (0.0_f64, 0.0_f64, false);
    loop {
        while !done {
            match planner.poll().map_err(|error| format!("line {}: {error}", error.place().line))? {
                Progress::Done => done = true,
                Progress::Waiting => break,
                _ => {}
            }
        }
        let state = interpolator.tick();
        let z = interpolator.set_points()[2].to_num::<f64>();
        (lowest, highest) = (lowest.min(z), highest.max(z));
        if done && state == State::Idle {
            break;
        }
    }
    println!("Z between {lowest:.3} and {highest:.3} mm, the path ends at {:?}", interpolator.set_points());
    assert!(lowest < -1.9 && highest > 1.9);
    Ok(())
}

//! Takes M functions where the path reaches them, and acknowledges the one that the motion waits for.
//!
//! `cargo run --release -p glidepath --example functions`
use glidepath::machine::{Synch, SynchTable};
use glidepath::{
    AxisData, AxisKind, AxisName, Channel, ChannelData, Function, Handles, MachineData, Position, Progress,
    State,
};

const PROGRAM: &[u8] = b"N10 G01 X10 F3000\nN20 M7\nN30 X20\nN40 M25\nN50 X30\nM30\n";

/// Ticks that the clamp of M25 takes to close.
const CLAMP_TICKS: u32 = 250;

/// Runs the example.
pub fn main() -> Result<(), Box<dyn std::error::Error>> {
    let axes =
        ["X", "Y", "Z"].map(|name| AxisData::new(AxisName::new(name).expect("a name"), AxisKind::Linear));
    // P-CHAN-00041: the motion stands at M25 until the PLC acknowledges it.
    let m_synch = SynchTable::NONE.with(25, Synch::MvsSvs);
    let channel = ChannelData { slope_profile: 1, m_synch, ..ChannelData::new() };
    let machine = MachineData { axes, channel };
    let mut memory = Box::new(Channel::<3, 120>::new());
    let Handles { mut planner, mut interpolator, operator } =
        memory.split(&machine, [Position::ZERO; 3], PROGRAM)?;
    let (mut clamp, mut seen) = (None, Vec::new());
    loop {
        let mut done = false;
        loop {
            match planner.poll()? {
                Progress::Done => done = true,
                Progress::Waiting => {}
                _ => continue,
            }
            break;
        }
        let state = interpolator.tick();
        while let Some(output) = operator.output() {
            println!("tick {:5}: {:?} of N{}", output.tick, output.function, output.n);
            seen.push(output.function);
            if output.waits {
                clamp = Some((output.tick + CLAMP_TICKS, output.function));
            }
        }
        if let Some((due, function)) = clamp
            && operator.status().ticks > due
        {
            operator.acknowledge(function).map_err(|_| "nothing waits for it")?;
            println!("tick {:5}: {function:?} acknowledged", operator.status().ticks);
            clamp = None;
        }
        if done && state == State::Idle {
            assert!(seen.contains(&Function::M(7)) && seen.contains(&Function::M(25)), "{seen:?}");
            return Ok(());
        }
    }
}

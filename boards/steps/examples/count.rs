//! Ticks of three axes at one speed, to count the instructions of `fill` with Callgrind.
//!
//! `cargo build -p glidepath-steps --release --example count`, then for 10 steps per tick and axis
//! `valgrind --tool=callgrind --toggle-collect='count::measured' target/release/examples/count 10`
use glidepath::machine::{AxisData, AxisKind, AxisName, ChannelData, MachineData};
use glidepath::quantity::Position;
use glidepath_steps::{AxisSteps, Motor, State, StepData, Steps};
use std::hint::black_box;

const SLOTS: usize = 200;
const TICKS: i64 = 1000;

fn main() {
    let counts: i64 = std::env::args().nth(1).and_then(|text| text.parse().ok()).unwrap_or(10);
    let axis = |name| AxisData {
        vb_max: 1_000_000,
        a_max: 4000,
        ..AxisData::new(AxisName::new(name).unwrap_or_default(), AxisKind::Linear)
    };
    let machine = MachineData { axes: [axis("X"), axis("Y"), axis("Z")], channel: ChannelData::new() };
    let motors = [0, 2, 4].map(|bit| AxisSteps::new(100, 1, Motor::new(bit, bit + 1)));
    let data = StepData { slot_ns: 5000, axes: motors };
    let mut at = [Position::ZERO; 3];
    let mut steps = match Steps::<3, SLOTS>::new(&data, &machine, &at) {
        Ok(steps) => steps,
        Err(unfit) => return println!("{unfit}"),
    };
    let mut words = [0; SLOTS];
    for tick in 0..=TICKS {
        let bits = ((tick * counts) << 32) / 100;
        at = at.map(|_| Position::from_bits(bits));
        if measured(&mut steps, &at, &mut words) != State::InTime {
            println!("tick {tick} is late");
        }
        black_box(&words);
    }
    println!("{} ticks, {} steps of each axis", TICKS + 1, steps.count(0));
}

#[inline(never)]
fn measured(steps: &mut Steps<3, SLOTS>, at: &[Position; 3], words: &mut [u32; SLOTS]) -> State {
    steps.fill(at, words)
}

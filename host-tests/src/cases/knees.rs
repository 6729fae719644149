//! Programs and machines whose axes reverse within blocks of nanometres to micrometres, so several corners
//! may be in one tick.
use super::random::Random;
use super::{Program, machines};
use glidepath::machine::MachineData;

/// X has a jerk of a hundredth of a millimetre within a tick, and moves together with the slow axis A.
pub fn turning(slope: u8) -> MachineData<4> {
    let mut machine = machines::machine(1000, |k, axis| {
        (axis.vb_max, axis.tr_min) = (1_000_000, 1000);
        let (a, ramp) = if k == 3 { (100, 50_000) } else { (50_000, 1000) };
        machines::accelerations(axis, a, a);
        machines::ramps(axis, ramp);
        axis.tr_geom = 1000;
        axis.a_trans_weight = 950;
    });
    machine.channel.slope_profile = slope;
    machine
}

/// Blocks with these lengths in millimetres of X and degrees of A.
pub fn beside(blocks: &[[f64; 2]]) -> Program {
    let mut at = [0.0; 4];
    let mut program = Program::new("beside", 4);
    for [x, a] in blocks {
        (at[0], at[3]) = (at[0] + x, at[3] + a);
        program = program.line(&at, 60_000.0);
    }
    program
}

/// Lines between which one axis, or two, reverse within up to five blocks of nanometres to micrometres,
/// mostly at constant speed.
pub fn chain(seed: u64) -> (Program, MachineData<4>) {
    let mut r = Random::new(seed);
    let slope = 1 + r.bits() % 3;
    let mut machine = turning(slope as u8);
    for axis in &mut machine.axes[1..] {
        let a = r.magnitude(3.0, 1000.0) as u32;
        machines::accelerations(axis, a, a * (1 + (r.bits() % 3) as u32));
        machines::ramps(axis, r.magnitude(1000.0, 500_000.0) as u32);
        axis.a_trans_weight = if r.once_in(4) { 0 } else { r.between(300.0, 1000.9) as u32 };
        axis.tr_geom = r.magnitude(1000.0, 100_000.0) as u32;
    }
    let steepest = [r.magnitude(0.001, 1.0), 0.0, r.magnitude(0.1, 3.0)];
    let moves = |r: &mut Random, length: f64, part: f64| {
        let length = (length * 1e6).ceil() * 1e-6;
        let travels = steepest.map(|steep| (length * steep * part * 1e6).round() * 1e-6);
        (length, travels, r.magnitude(100.0, 60_000.0))
    };
    let mut blocks = Vec::new();
    let mut side = 1.0;
    for _ in 0..4 {
        let long = r.magnitude(0.01, 1.0);
        blocks.push(moves(&mut r, long, side));
        let count = 1 + r.bits() % 5;
        let steady = !r.once_in(3);
        for k in 1..=count {
            let part = if steady { 1.0 - 2.0 * k as f64 / (count + 1) as f64 } else { r.between(-1.0, 1.0) };
            let length = r.magnitude(1e-5, 2e-3);
            blocks.push(moves(&mut r, length, side * part));
        }
        side = -side;
    }
    let mut at = [0.0; 4];
    let mut program = Program::new(format!("chain {seed}"), 4);
    program.optimised = slope == 3 && r.once_in(2);
    for (length, travels, feed) in blocks {
        at[0] += length;
        for (at, travel) in at[1..].iter_mut().zip(travels) {
            *at += travel;
        }
        program = program.line(&at, feed);
    }
    (program, machine)
}

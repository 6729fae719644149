//! Chains of short blocks with a corner between any two blocks, without contour mode. A stop then takes many
//! blocks, and many pieces if acceleration is zero at each block end.
//!
//! One number gives machine, program and disturbances. Each run is made twice: without disturbance, and with
//! a planner that gets no processor time at many ticks, until the motion stands still.
use crate::cases::random::Random;
use crate::cases::{Program, machines};
use crate::operate::{Act, Operated, POLLS, TOO_LONG, judge, operate, random_acts, with_overrides};
use crate::soak::Outcome;
use glidepath::machine::MachineData;

/// Machine, program, disturbances.
#[derive(Clone, Debug)]
pub struct Chain {
    /// Its machine.
    pub machine: MachineData<3>,
    /// Its program.
    pub program: Program,
    /// Holds and overrides.
    pub acts: Vec<(usize, Act)>,
    /// Calls of the planner between two ticks.
    pub polls: usize,
    random: Random,
}

/// Parameters of a chain.
#[derive(Clone, Copy, Debug)]
pub struct Links {
    /// Blocks.
    pub count: usize,
    /// Length of a block, mm.
    pub length: f64,
    /// Angle of a corner, degrees; `to_and_fro`: to alternating sides.
    pub turn: f64,
    /// Whether corners turn to alternating sides.
    pub to_and_fro: bool,
}

/// A machine with 2000 mm/s² and ramps of this number of µs.
pub fn machine(cycle_us: u32, ramp_us: u32, look_ahead: u32, slope: u8) -> MachineData<3> {
    let mut machine = machines::machine::<3>(cycle_us, |_, axis| {
        (axis.vb_max, axis.vb_eilgang) = (1_000_000, 1_000_000);
        (axis.a_beschl, axis.a_brems, axis.a_grenz, axis.a_max) = (2000, 2000, 2000, 2000);
        (axis.tr_beschl_zu, axis.tr_beschl_ab) = (ramp_us, ramp_us);
        (axis.tr_brems_zu, axis.tr_brems_ab, axis.tr_grenz) = (ramp_us, ramp_us, ramp_us);
        (axis.tr_geom, axis.tr_min) = (ramp_us.min(10_000), ramp_us.min(10_000));
        // Corners take acceleration and unlimited jerk, so they are passed fast.
        axis.a_trans_weight = 1000;
        axis.vb_max_red = 20_000;
        (axis.a_stufe, axis.a_grenz_stufe) = ([2000; 2], [2000; 2]);
    });
    (machine.channel.look_ahead, machine.channel.slope_profile) = (look_ahead, slope);
    machine
}

/// Continues with a straight line of this length in mm, then with a chain.
pub fn go_on(mut program: Program, line: f64, links: Links, feed: f64) -> Program {
    let last = program.end().to_vec();
    let mut at = [last[0], last[1]].map(|nm| nm as f64 * 1e-6);
    let mut turn = 0.0_f64;
    let step = |at: &mut [f64; 2], length: f64, turn: f64| {
        *at = [at[0] + length * turn.cos(), at[1] + length * turn.sin()];
    };
    if line > 0.0 {
        step(&mut at, line, turn);
        program = program.line(&[at[0], at[1], 0.0], feed);
    }
    for k in 0..links.count {
        let side = if links.to_and_fro && k % 2 == 1 { -1.0 } else { 1.0 };
        turn += side * links.turn.to_radians();
        step(&mut at, links.length, turn);
        program = program.line(&[at[0], at[1], 0.0], feed);
    }
    program
}

/// The case of a seed.
pub fn chain(seed: u64) -> Chain {
    let mut random = Random::new(seed ^ 0x6368_6169_6e73);
    let r = &mut random;
    let cycle_us = [100, 250, 500, 1000, 2000][(r.bits() % 5) as usize];
    let ramp = if r.once_in(8) { r.magnitude(150_000.0, 2e6) } else { r.magnitude(5_000.0, 150_000.0) };
    let look_ahead = [30, 120, 500][(r.bits() % 3) as usize];
    let slope = [1, 2, 1, 2, 3, 0][(r.bits() % 6) as usize];
    let mut machine = machine(cycle_us, ramp as u32, look_ahead, slope);
    let a = r.magnitude(300.0, 8000.0);
    for axis in &mut machine.axes {
        let a = (a * r.magnitude(0.7, 1.4)) as u32;
        (axis.a_beschl, axis.a_brems, axis.a_grenz) = (a, a, a);
        axis.a_max = (f64::from(a) * r.magnitude(1.0, 3.0)) as u32;
        (axis.a_stufe, axis.a_grenz_stufe) = ([a; 2], [a; 2]);
        axis.a_trans_weight = if r.once_in(8) { 0 } else { r.magnitude(100.0, 1000.9) as u32 };
        axis.tr_geom = if r.once_in(4) { 0 } else { (r.magnitude(500.0, 50_000.0)) as u32 };
    }
    machine.channel.override_weight_prog_feed = (r.bits() % 3) as u8;
    let mut program = Program::new(format!("chains of seed {seed}"), 3);
    for _ in 0..1 + r.bits() % 3 {
        let line = if r.once_in(3) { 0.0 } else { r.magnitude(1.0, 300.0) };
        let links = Links {
            count: r.magnitude(20.0, 400.0) as usize,
            length: r.magnitude(0.05, 4.0),
            turn: r.magnitude(0.1, 4.0),
            to_and_fro: r.once_in(2),
        };
        let feed = r.magnitude(3_000.0, 60_000.0).round();
        program = go_on(program, line, links, feed);
    }
    program.optimised = r.once_in(2);
    let polls = if r.once_in(4) { POLLS[(r.bits() % 2) as usize] } else { POLLS[2] };
    let holds = if r.once_in(4) { random_acts(r, 4000) } else { Vec::new() };
    let acts = if r.once_in(3) { with_overrides(r, 4000, holds) } else { holds };
    Chain { machine, program, acts, polls, random }
}

impl Chain {
    /// Runs and checks the case, with these disturbances.
    ///
    /// # Errors
    /// The first fault.
    pub fn run(&self, stalls: &[(usize, Act)]) -> Result<Operated, String> {
        let mut acts = [&self.acts, stalls].concat();
        acts.sort_by_key(|(tick, _)| *tick);
        let run = operate::<3, 500>(&self.program, &self.machine, &acts, self.polls)?;
        judge(&self.program, &self.machine, &run)?;
        Ok(run)
    }

    /// Stalls at random ticks of a motion, each until the motion stands still.
    pub fn stalls(&mut self, ticks: usize, count: usize) -> Vec<(usize, Act)> {
        // Less than the checker waits for a motion.
        let stand = (8_000_000 / self.machine.channel.cycle_us as usize).min(18_000);
        let mut at = 0;
        let mut stalls = Vec::new();
        for _ in 0..count {
            at += (self.random.unit() * 2.0 * ticks as f64 / count as f64) as usize;
            stalls.push((at, Act::Stall(stand)));
            at += stand;
        }
        stalls
    }
}

/// Runs and checks a seed, without disturbance and with stalls.
pub fn soak(seed: u64) -> Outcome {
    let mut chain = chain(seed);
    let run = chain.run(&[]).and_then(|plain| {
        let ticks = plain.trace.len();
        let stalls = chain.stalls(ticks, 8);
        let run = chain.run(&stalls).map(|run| ticks + run.trace.len());
        run.map_err(|fault| if fault.ends_with(TOO_LONG) { fault } else { format!("{fault}; {stalls:?}") })
    });
    match run {
        Ok(ticks) => Outcome::Good(ticks),
        Err(fault) if fault.ends_with(TOO_LONG) => Outcome::TooLong,
        Err(fault) => Outcome::Fault(fault),
    }
}

/// Ticks at standstill between the first and the last tick with motion.
pub fn stands(run: &Operated) -> usize {
    let moves = |pair: &[i64]| pair[1] != pair[0];
    let pairs: Vec<bool> = run.distances.windows(2).map(moves).collect();
    let first = pairs.iter().position(|moves| *moves).unwrap_or(0);
    let last = pairs.iter().rposition(|moves| *moves).unwrap_or(0);
    pairs[first..=last].iter().filter(|moves| !**moves).count()
}

//! The cases on the host: what the target has to repeat.
use glidepath::channel::{Channel, Error, Progress};
use glidepath::machine::MachineData;
use glidepath::quantity::Position;
use hil_cases::{
    AXES_3, AXES_4, AXES_6, BLOCKS, BLOCKS_6, CASES_3, CASES_4, CASES_6, Case, Outcome, Watch, run,
};

/// A case as the host ran it.
pub struct HostRun {
    /// Name of the case.
    pub name: &'static str,
    /// Number of axes.
    pub axes: usize,
    /// Bits of the set points: every axis of the first tick, of the second, ….
    pub set_points: Vec<i64>,
    /// Ticks, blocks, digest.
    pub outcome: Outcome,
}

struct Collector<'a>(&'a mut Vec<i64>);

impl<const AXES: usize> Watch<AXES> for Collector<'_> {
    fn polled(&mut self, _: u32, _: &Result<Progress, Error>) {}

    fn ticked(&mut self, _: u32, set_points: &[Position; AXES]) {
        self.0.extend(set_points.iter().map(|point| point.to_bits()));
    }
}

/// Every case, in the order of the target's.
pub fn run_all() -> Result<Vec<HostRun>, String> {
    let three = CASES_3.iter().map(|case| run_one::<3, BLOCKS>(case, &AXES_3));
    let four = CASES_4.iter().map(|case| run_one::<4, BLOCKS>(case, &AXES_4));
    let six = CASES_6.iter().map(|case| run_one::<6, BLOCKS_6>(case, &AXES_6));
    three.chain(four).chain(six).collect()
}

fn run_one<const AXES: usize, const BLOCKS: usize>(
    case: &Case,
    machine: &MachineData<AXES>,
) -> Result<HostRun, String> {
    let mut set_points = Vec::new();
    let mut channel = Box::new(Channel::<AXES, BLOCKS>::new());
    let outcome = run(&mut channel, machine, case.text, &mut Collector(&mut set_points))
        .map_err(|failure| format!("programs/{}.nc on the host: {failure:?}", case.name))?;
    Ok(HostRun { name: case.name, axes: AXES, set_points, outcome })
}

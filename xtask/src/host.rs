//! Runs the cases on the PC; the target must repeat the results.
use crate::{WITHOUT, shell};
use glidepath::channel::{Channel, Error, Progress};
use glidepath::machine::MachineData;
use glidepath::nc::Window;
use glidepath::quantity::Position;
use hil_cases::{
    AXES_3, AXES_3_DEEP, AXES_3_SHORT, AXES_4, AXES_6, AXES_6_SHORT, BLOCKS, BesideCase, CASES_3,
    CASES_3_OTHER, CASES_4, CASES_6, CASES_6_OTHER, CASES_BESIDE, CASES_CORES, CASES_SLIM, Case, DEEP,
    FilterMemory, Line, Outcome, SEEDS, SHORT, Watch, beside, commanded, run, session,
};
use std::time::Duration;

/// Time limit for the build and the run of a PC program with few functions.
const LONGEST: Duration = Duration::from_secs(1200);

/// A case with its results on the PC.
pub struct HostRun {
    /// Name of the case.
    pub name: &'static str,
    /// Number of axes.
    pub axes: usize,
    /// Blocks of look-ahead.
    pub blocks: usize,
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

/// Every case of every configuration, in the order of the target's ([`crate::hil::SAME`]).
pub fn run_all() -> Result<Vec<HostRun>, String> {
    let three = CASES_3.iter().map(|case| run_one::<3, BLOCKS>(case, &AXES_3));
    let four = CASES_4.iter().map(|case| run_one::<4, BLOCKS>(case, &AXES_4));
    let six = CASES_6.iter().map(|case| run_one::<6, BLOCKS>(case, &AXES_6));
    let short_three = CASES_3_OTHER.iter().map(|case| run_one::<3, SHORT>(case, &AXES_3_SHORT));
    let deep_three = CASES_3_OTHER.iter().map(|case| run_one::<3, DEEP>(case, &AXES_3_DEEP));
    let short_six = CASES_6_OTHER.iter().map(|case| run_one::<6, SHORT>(case, &AXES_6_SHORT));
    three.chain(four).chain(six).chain(short_three).chain(deep_three).chain(short_six).collect()
}

/// The programs of the table of cores, with a short look-ahead.
pub fn cores() -> Result<Vec<HostRun>, String> {
    CASES_CORES.iter().map(|case| run_one::<3, SHORT>(case, &AXES_3_SHORT)).collect()
}

/// The cases with lines, arcs and contour mode, from a PC program that is built with these functions only:
/// the output of the example `slim`.
pub fn slim() -> Result<String, String> {
    let mut command = shell::cargo(&shell::root().join(WITHOUT));
    command.args(["run", "--release", "--features", "contour", "--example", "slim"]);
    command.env("CARGO_TARGET_DIR", shell::root().join("target"));
    let output = shell::capture(&mut command, LONGEST)?;
    if !output.success {
        return Err(format!("the host built for lines, arcs and contour mode: {}", output.err));
    }
    String::from_utf8(output.out).map_err(|e| e.to_string())
}

/// The cases with lines, arcs and contour mode, with 120 and with 30 blocks.
pub fn slim_all() -> Result<Vec<HostRun>, String> {
    let long = CASES_SLIM.iter().map(|case| run_one::<3, BLOCKS>(case, &AXES_3));
    long.chain(CASES_SLIM.iter().map(|case| run_one::<3, SHORT>(case, &AXES_3_SHORT))).collect()
}

fn run_one<const AXES: usize, const BLOCKS: usize>(
    case: &Case,
    machine: &MachineData<AXES>,
) -> Result<HostRun, String> {
    let mut set_points = Vec::new();
    let mut channel = Box::new(Channel::<AXES, BLOCKS>::new());
    let outcome = run(&mut channel, machine, case.text, &mut Collector(&mut set_points))
        .map_err(|failure| format!("programs/{}.nc on the host: {failure:?}", case.name))?;
    Ok(HostRun { name: case.name, axes: AXES, blocks: BLOCKS, set_points, outcome })
}

/// The session from power-up to power-off, with its text in memory and over a line.
pub fn sessions() -> Result<Vec<HostRun>, String> {
    ["session", "session_line"].into_iter().map(run_session).collect()
}

fn run_session(name: &'static str) -> Result<HostRun, String> {
    let mut set_points = Vec::new();
    let mut channel = Box::new(Channel::<3, BLOCKS>::new());
    let mut window = Window::new();
    let window = (name == "session_line").then_some(&mut window);
    let outcome = session(&mut channel, &AXES_3, window, Collector(&mut set_points))
        .map_err(|failure| format!("{name} on the host: {failure:?}"))?;
    Ok(HostRun { name, axes: 3, blocks: BLOCKS, set_points, outcome })
}

/// The case with a transformation.
pub fn five() -> Result<HostRun, String> {
    let mut set_points = Vec::new();
    let mut channel = Box::new(Channel::<5, BLOCKS>::new());
    let outcome = hil_cases::five(&mut channel, &mut Collector(&mut set_points))
        .map_err(|failure| format!("{} on the host: {failure:?}", hil_cases::FIVE))?;
    Ok(HostRun { name: hil_cases::FIVE, axes: 5, blocks: BLOCKS, set_points, outcome })
}

/// What the programs of [`crate::rtos`] do.
pub fn tasks() -> Result<HostRun, String> {
    let mut set_points = Vec::new();
    let mut channel = Box::new(Channel::<3, BLOCKS>::new());
    let watch = &mut Collector(&mut set_points);
    let outcome = hil_cases::tasks(&mut channel, &mut Window::new(), Line::SERIAL, watch)
        .map_err(|failure| format!("boards/tasks/tasks.nc on the host: {failure:?}"))?;
    Ok(HostRun { name: "tasks", axes: 3, blocks: BLOCKS, set_points, outcome })
}

/// The cases with three and with six axes and continuous commands: all schedules of each case.
pub fn commanded_all() -> Result<Vec<HostRun>, String> {
    let mut runs = commanded_on::<3>(&AXES_3, CASES_3)?;
    runs.extend(commanded_on::<6>(&AXES_6, CASES_6)?);
    Ok(runs)
}

fn commanded_on<const AXES: usize>(
    machine: &MachineData<AXES>,
    cases: &[Case],
) -> Result<Vec<HostRun>, String> {
    let run_one = |(case, seed): (&Case, u32)| {
        let mut set_points = Vec::new();
        let mut channel = Box::new(Channel::<AXES, BLOCKS>::new());
        let outcome = commanded(&mut channel, machine, case, seed, &mut Collector(&mut set_points))
            .map_err(|failure| format!("{} with commands {seed} on the host: {failure:?}", case.name))?;
        Ok(HostRun { name: case.name, axes: AXES, blocks: BLOCKS, set_points, outcome })
    };
    cases.iter().flat_map(|case| (0..=SEEDS).map(move |seed| (case, seed))).map(run_one).collect()
}

/// The cases with filters and overlays.
pub fn beside_all() -> Result<Vec<HostRun>, String> {
    let run_one = |case: &BesideCase| {
        let mut set_points = Vec::new();
        let mut channel = Box::new(Channel::new());
        let mut filters = Box::new(FilterMemory::new());
        let outcome = beside::<BLOCKS, _>(&mut channel, &mut filters, case, &mut Collector(&mut set_points))
            .map_err(|failure| format!("{} on the host: {failure:?}", case.name))?;
        Ok(HostRun { name: case.name, axes: 3, blocks: BLOCKS, set_points, outcome })
    };
    CASES_BESIDE.iter().map(run_one).collect()
}

//! Runs a program with independent axes, and checks the motion of the axes without knowledge of the library's
//! plan.
use crate::calls::call;
use crate::filtered::jerk_rounding;
use crate::operate::{Act, TOO_LONG};
use crate::properties::permitted;
use glidepath::channel::{Channel, Handles, Progress};
use glidepath::fir::{FilterPlan, FilterTick, Filters};
use glidepath::kinematics::Kinematic;
use glidepath::machine::{FilterType, MachineData};
use glidepath::nc::NcWarning;
use glidepath::quantity::Position;
use glidepath::technology::Output;
use glidepath::tick::State;

/// Highest number of independent axes at once.
pub const OVERLAYS: usize = 3;

/// Blocks of look-ahead.
pub const BLOCKS: usize = 120;

/// Samples of a filter: the highest order is 200.
pub const TAPS: usize = 202;

/// 1 mm or degree.
pub const ONE: i64 = 1 << 32;

/// A run.
#[derive(Clone, Debug, Default)]
pub struct Run {
    /// Set points of every axis, tick by tick; the first row is before the first tick.
    pub axes: Vec<Vec<i64>>,
    /// Set points before the filters.
    pub path: Vec<Vec<i64>>,
    /// Axes that were reported to exceed AX_DEV.
    pub deviated: Vec<usize>,
    /// State after every tick.
    pub states: Vec<State>,
    /// Messages.
    pub warnings: Vec<NcWarning>,
    /// Functions that were output.
    pub outputs: Vec<Output>,
    /// Positions of the planner at the end.
    pub position: Vec<i64>,
    /// N number at every tick.
    pub n: Vec<u32>,
}

/// Most ticks of a run.
pub const LONGEST: usize = 1_000_000;

/// Runs `text` from position 0, with `polls` planner calls between two ticks, and one more tick at standstill
/// at the end.
///
/// # Errors
/// The library's refusal, or a motion that does not end.
pub fn run<const AXES: usize>(
    text: &str,
    machine: &MachineData<AXES>,
    acts: &[(usize, Act)],
    polls: usize,
) -> Result<Run, String> {
    let mut channel: Box<Channel<AXES, BLOCKS, OVERLAYS>> = Box::new(Channel::new());
    let start = [Position::ZERO; AXES];
    if machine.axes.iter().all(|axis| axis.filter.kind == FilterType::None) {
        let handles = channel.split(machine, start, text.as_bytes());
        return run_with(handles.map_err(|error| error.to_string())?, acts, polls);
    }
    let mut filters: Box<Filters<AXES, TAPS>> = Box::new(Filters::new());
    let handles = channel.split_filtered(&mut filters, machine, start, text.as_bytes());
    run_with(handles.map_err(|error| error.to_string())?, acts, polls)
}

/// The same without filters, on a machine with these transformations; the first of them is the default.
///
/// # Errors
/// The same.
pub fn run_transformed<const AXES: usize>(
    text: &str,
    machine: &MachineData<AXES>,
    kinematics: &[Kinematic],
    acts: &[(usize, Act)],
    polls: usize,
) -> Result<Run, String> {
    let mut channel: Box<Channel<AXES, BLOCKS, OVERLAYS>> = Box::new(Channel::new());
    let handles = channel.split(machine, [Position::ZERO; AXES], text.as_bytes());
    let mut handles = handles.map_err(|error| error.to_string())?;
    handles.planner.transform_with(kinematics, kinematics.first().map_or(0, |first| first.id));
    run_with(handles, acts, polls)
}

/// The same for any channel.
type Any<'a, P, I, const AXES: usize> = Handles<'a, &'a [u8], AXES, BLOCKS, P, I, OVERLAYS>;

fn run_with<P: FilterPlan<AXES>, I: FilterTick<AXES>, const AXES: usize>(
    handles: Any<'_, P, I, AXES>,
    acts: &[(usize, Act)],
    polls: usize,
) -> Result<Run, String> {
    let Handles { mut planner, mut interpolator, operator } = handles;
    let mut run = Run { axes: vec![vec![0]; AXES], path: vec![vec![0]; AXES], ..Run::default() };
    let mut acts = acts.iter().peekable();
    let (mut stalled, mut ended) = (0, false);
    for tick in 0..LONGEST {
        while let Some((_, act)) = acts.next_if(|(at, _)| *at <= tick) {
            act.give(&operator);
            if let Act::Stall(ticks) = act {
                stalled = stalled.max(tick + ticks);
            }
        }
        let most = if tick < stalled { 0 } else { polls };
        let said = |progress| match progress {
            Progress::Warning(warning) => run.warnings.push(warning),
            Progress::Deviated(axis) => run.deviated.push(axis),
            _ => {}
        };
        let done = call(&mut planner, most, said).map_err(|error| format!("tick {tick}: {error}"))?;
        let state = interpolator.tick();
        if operator.status().state != state {
            return Err(format!(
                "tick {tick}: the operator sees {:?}, not {state:?}",
                operator.status().state
            ));
        }
        run.states.push(state);
        run.n.push(operator.status().n);
        for (column, point) in run.axes.iter_mut().zip(interpolator.set_points()) {
            column.push(point.to_bits());
        }
        for (column, point) in run.path.iter_mut().zip(interpolator.path_points()) {
            column.push(point.to_bits());
        }
        if operator.status().set_points != *interpolator.set_points() {
            return Err(format!("tick {tick}: the operator sees other set points"));
        }
        while let Some(output) = operator.output() {
            run.outputs.push(output);
        }
        ended = done && state == State::Idle;
        if ended && !planner.is_at_rest() {
            return Err(format!("tick {tick}: done, and not at rest"));
        }
        if ended && acts.peek().is_none() {
            run.position = planner.position().iter().map(|axis| axis.to_bits()).collect();
            return Ok(run);
        }
    }
    if ended {
        // The operator has a later command.
        run.position = planner.position().iter().map(|axis| axis.to_bits()).collect();
        return Ok(run);
    }
    let moved = |x: &Vec<i64>| x.iter().rev().take(LONGEST / 4).any(|at| Some(at) != x.last());
    if !run.axes.iter().any(moved) {
        return Err("nothing moves any more".to_owned());
    }
    Err(TOO_LONG.to_owned())
}

impl Run {
    /// Ticks at which the axis reverses, or begins or ends a standstill.
    pub fn reversals(&self, axis: usize) -> Vec<(usize, i64)> {
        let x = &self.axes[axis];
        let mut found = Vec::new();
        let mut direction = 0;
        for (tick, pair) in x.windows(2).enumerate() {
            let now = (pair[1] - pair[0]).signum();
            if direction != 0 && now != direction {
                found.push((tick, pair[0]));
            }
            direction = now;
        }
        found
    }

    /// Ticks at which the axis reaches `position` from another position.
    pub fn arrivals(&self, axis: usize, position: i64) -> Vec<usize> {
        let x = &self.axes[axis];
        (1..x.len()).filter(|&tick| x[tick] == position && x[tick - 1] != position).collect()
    }

    /// End positions of all axes, mm or degrees.
    pub fn ends(&self) -> Vec<f64> {
        self.axes.iter().map(|x| *x.last().expect("a tick") as f64 / ONE as f64).collect()
    }

    /// Checks speed, acceleration and jerk of every axis at every tick: of single axes within the limits of
    /// feed and rapid motion; `curved` if the path has corners too.
    ///
    /// # Errors
    /// The first fault.
    pub fn keeps_limits<const AXES: usize>(
        &self,
        machine: &MachineData<AXES>,
        slope: u8,
        curved: bool,
    ) -> Result<(), String> {
        let cycle = f64::from(machine.channel.cycle_us) * 1e-6;
        for (k, (x, data)) in self.axes.iter().zip(&machine.axes).enumerate() {
            let limits = permitted(data, slope, true, true, curved);
            let most = [limits.v * cycle, limits.a * cycle.powi(2), limits.jerk * cycle.powi(3)];
            // Set points are rounded to half a step each. A filter adds what it makes of that and the
            // difference of two remainders.
            let filtered = machine.axes.iter().any(|axis| axis.filter.kind != FilterType::None);
            let rounding = if filtered { 3.25 } else { 1.0 };
            let jerk = if filtered { jerk_rounding(machine, k) } else { 1.0 };
            let most = [(most[0], rounding), (most[1], 2.0 * rounding), (most[2], 4.0 * jerk)];
            let mut differences = x.clone();
            for (order, (most, rounding)) in most.into_iter().enumerate() {
                differences = differences.windows(2).map(|pair| pair[1] - pair[0]).collect();
                for (tick, difference) in differences.iter().enumerate() {
                    let size = difference.unsigned_abs() as f64;
                    if size > most * ONE as f64 + rounding {
                        return Err(format!(
                            "axis {k}, tick {tick}: difference {} is {} of {most}",
                            order + 1,
                            size / ONE as f64
                        ));
                    }
                }
            }
        }
        Ok(())
    }
}

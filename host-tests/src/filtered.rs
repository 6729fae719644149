//! Runs a program with filters after the path, tick by tick, with commands of an operator.
use crate::calls::call;
use crate::operate::Act;
use crate::trace::Trace;
use glidepath::channel::{Channel, FilteredHandles, Progress};
use glidepath::fir::Filters;
use glidepath::machine::{AxisData, FilterData, FilterType, MachineData};
use glidepath::quantity::Position;
use glidepath::technology::Output;
use glidepath::tick::State;

/// Samples per axis: the highest order is 200.
pub const TAPS: usize = 202;

/// A filtered run. All traces begin with a row at rest and hold every tick, those of rest included.
#[derive(Clone, Debug, Default)]
pub struct Filtered {
    /// Set points of the path, and those for the drives.
    pub path: Trace,
    /// Set points for the drives.
    pub drives: Trace,
    /// State after each tick.
    pub states: Vec<State>,
    /// Functions, with the tick after which they were output.
    pub outputs: Vec<(usize, Output)>,
    /// Ticks at which the planner reported a hold, from the first tick of each hold.
    pub holds: Vec<usize>,
    /// Axes that were reported to exceed AX_DEV.
    pub deviated: Vec<usize>,
    /// Largest deviation of each axis as the library says, LSB.
    pub deviation: Vec<i64>,
    /// Warnings, as text.
    pub warnings: Vec<String>,
}

/// All axes filtered with that type and order, from the start on.
pub fn with_filter<const AXES: usize>(
    mut machine: MachineData<AXES>,
    kind: FilterType,
    order: u8,
) -> MachineData<AXES> {
    for axis in &mut machine.axes {
        axis.filter = FilterData { enable: true, kind, order, ..FilterData::NONE };
    }
    machine
}

/// At most the acceleration that filters permit: 0.25 mm per cycle².
pub fn permit_filters(axis: &mut AxisData, cycle_us: u32) {
    let most = (240_000_000_000 / (u64::from(cycle_us) * u64::from(cycle_us))).min(u32::MAX.into()) as u32;
    let AxisData {
        a_max, a_beschl, a_brems, a_grenz, a_stufe, d_stufe, a_grenz_stufe, d_grenz_stufe, ..
    } = axis;
    let stages = a_stufe.iter_mut().chain(d_stufe).chain(a_grenz_stufe).chain(d_grenz_stufe);
    for a in [a_max, a_beschl, a_brems, a_grenz].into_iter().chain(stages) {
        *a = (*a).min(most);
    }
}

/// Effect of rounding on the jerk of an axis in a filtered channel, from its effect on the jerk of the path.
pub fn jerk_rounding<const AXES: usize>(machine: &MachineData<AXES>, axis: usize) -> f64 {
    let filter = &machine.axes[axis].filter;
    let averages = !matches!(filter.kind, FilterType::None | FilterType::Delay);
    // The plan has a jerk lower by this amount. In addition, a delay of half a cycle gives the rounded mean
    // of two set points.
    if averages && filter.order > 0 && filter.share > 0 { 1.0 } else { 1.5 }
}

const LONGEST: usize = 3_000_000;

/// Runs a text from the origin; `acts` are commands with the tick before which they are given.
///
/// # Errors
/// The library's refusal, or a motion that does not end.
pub fn run<const AXES: usize>(
    text: &str,
    machine: &MachineData<AXES>,
    acts: &[(usize, Act)],
    polls: usize,
) -> Result<Filtered, String> {
    run_from(text, [Position::ZERO; AXES], machine, acts, polls)
}

/// The same from `start` on.
///
/// # Errors
/// The same.
pub fn run_from<const AXES: usize>(
    text: &str,
    start: [Position; AXES],
    machine: &MachineData<AXES>,
    acts: &[(usize, Act)],
    polls: usize,
) -> Result<Filtered, String> {
    let mut channel: Box<Channel<AXES, 120>> = Box::new(Channel::new());
    let mut filters: Box<Filters<AXES, TAPS>> = Box::new(Filters::new());
    let handles = channel.split_filtered(&mut filters, machine, start, text.as_bytes());
    let FilteredHandles { mut planner, mut interpolator, operator } = handles.map_err(|e| e.to_string())?;
    let cycle = f64::from(machine.channel.cycle_us) * 1e-6;
    let mut run = Filtered {
        path: Trace::empty(cycle, AXES),
        drives: Trace::empty(cycle, AXES),
        ..Filtered::default()
    };
    run.path.push(start.map(Position::to_bits));
    run.drives.push(start.map(Position::to_bits));
    run.states.push(State::Idle);
    let mut acts = acts.iter().peekable();
    let (mut stalled_until, mut held, mut rests) = (0, false, 0);
    for tick in 1..LONGEST {
        while let Some((_, act)) = acts.next_if(|(at, _)| *at <= tick) {
            act.give(&operator);
            if let Act::Stall(ticks) = act {
                stalled_until = stalled_until.max(tick + ticks);
            }
        }
        let most = if tick < stalled_until { 0 } else { polls };
        let said = |progress| match progress {
            Progress::Deviated(axis) => run.deviated.push(axis),
            Progress::Warning(warning) => run.warnings.push(warning.to_string()),
            _ => {}
        };
        let done = call(&mut planner, most, said).map_err(|e| format!("tick {tick}: {e}"))?;
        if planner.is_holding() && !held {
            run.holds.push(tick);
        }
        held = planner.is_holding();
        let state = interpolator.tick();
        run.path.push(interpolator.path_points().iter().map(|p| p.to_bits()));
        run.drives.push(interpolator.set_points().iter().map(|p| p.to_bits()));
        run.states.push(state);
        assert_eq!(operator.status().state, state, "tick {tick}");
        assert_eq!(operator.status().set_points, *interpolator.set_points());
        while let Some(output) = operator.output() {
            run.outputs.push((tick, output));
            if output.waits {
                let _ = operator.acknowledge(output.function);
            }
        }
        if done && state == State::Idle {
            run.deviation = planner.filter_deviation().map(Position::to_bits).to_vec();
            assert!(planner.is_at_rest());
            assert_eq!(planner.position(), interpolator.set_points());
            return Ok(run);
        }
        rests = if state == State::Idle { rests + 1 } else { 0 };
        if rests > 3000 && acts.peek().is_none() {
            return Err(format!("nothing moves at tick {tick}"));
        }
    }
    Err("too long".to_owned())
}

impl Filtered {
    /// Twice what each axis deviates from the mean of the path `delay`/2 ticks ago, LSB, tick by tick.
    pub fn deviations(&self, axis: usize, delay: usize) -> impl Iterator<Item = i64> + '_ {
        let path = &self.path.columns[axis];
        let ago = move |tick: usize, ticks: usize| path[tick.saturating_sub(ticks)];
        self.drives.columns[axis]
            .iter()
            .enumerate()
            .map(move |(tick, y)| 2 * y - ago(tick, delay / 2) - ago(tick, delay.div_ceil(2)))
    }

    /// The largest of them, LSB.
    pub fn largest(&self, axis: usize, delay: usize) -> f64 {
        self.deviations(axis, delay).map(|twice| twice.unsigned_abs()).max().unwrap_or(0) as f64 / 2.0
    }
}

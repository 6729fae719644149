//! Runs a program through the library and stores every set point.
use crate::cases::{Program, set_point};
use crate::reference::geometry::Contour;
use glidepath::channel::{Channel, Handles, PlannedBlock, Progress};
use glidepath::digest::Digest;
use glidepath::machine::MachineData;
use glidepath::nc::NcWarningKind;
use glidepath::quantity::Position;
use glidepath::tick::State;

/// Number of planner calls without progress after which a run is given up.
const STUCK: usize = 10_000_000;

/// Set points of a motion at equal time steps; the first row is the standstill before the motion.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Trace {
    /// Time between two rows, s.
    pub cycle: f64,
    /// Per axis one column of set points, unit 2^-32 mm or degrees.
    pub columns: Vec<Vec<i64>>,
}

impl Trace {
    /// A trace with this number of axes and no rows.
    pub fn empty(cycle: f64, axes: usize) -> Self {
        Self { cycle, columns: vec![Vec::new(); axes] }
    }

    /// A trace that begins at standstill in `start`.
    pub fn new(cycle: f64, start: &[i64]) -> Self {
        Self { cycle, columns: start.iter().map(|&x| vec![x]).collect() }
    }

    /// Appends one row.
    pub fn push(&mut self, row: impl IntoIterator<Item = i64>) {
        for (column, x) in self.columns.iter_mut().zip(row) {
            column.push(x);
        }
    }

    /// Rows.
    pub fn len(&self) -> usize {
        self.columns.first().map_or(0, Vec::len)
    }

    /// True without any row.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Ticks of motion.
    pub fn ticks(&self) -> usize {
        self.len().saturating_sub(1)
    }

    /// Duration, s.
    pub fn time(&self) -> f64 {
        self.ticks() as f64 * self.cycle
    }

    /// Set points of one row.
    pub fn row(&self, tick: usize) -> impl Iterator<Item = i64> + '_ {
        self.columns.iter().map(move |c| c[tick])
    }

    /// Set points of one row in mm.
    pub fn mm(&self, tick: usize) -> Vec<f64> {
        self.row(tick).map(|x| x as f64 / (1u64 << 32) as f64).collect()
    }
}

/// All results of a program.
#[derive(Clone, Debug)]
pub struct Run {
    /// Set points.
    pub trace: Trace,
    /// The planner's report about each block.
    pub blocks: Vec<PlannedBlock>,
    /// Digest over all ticks.
    pub digest: u64,
    /// Warnings of the planner, with their lines.
    pub warnings: Vec<(u32, NcWarningKind)>,
    /// Speed profiles were replaced by slower ones, so that a stop fits into the queue.
    pub slower: bool,
}

/// Runs `program`: the planner until the queue is full, then `burst` ticks, and so on.
///
/// # Errors
/// The library's refusal.
pub fn run_in_bursts<const AXES: usize, const BLOCKS: usize>(
    program: &Program,
    machine: &MachineData<AXES>,
    burst: usize,
) -> Result<Run, String> {
    let start: [Position; AXES] = std::array::from_fn(|k| Position::from_bits(set_point(program.start[k])));
    run_text::<AXES, BLOCKS>(&program.text(machine), start, machine, burst)
        .map_err(|fault| format!("{}: {fault}", program.name))
}

/// The same for any NC text, from `start` on.
///
/// # Errors
/// The library's refusal.
pub fn run_text<const AXES: usize, const BLOCKS: usize>(
    text: &str,
    start: [Position; AXES],
    machine: &MachineData<AXES>,
    burst: usize,
) -> Result<Run, String> {
    let mut channel: Box<Channel<AXES, BLOCKS>> = Box::new(Channel::new());
    let Handles { mut planner, mut interpolator, .. } =
        channel.split(machine, start, text.as_bytes()).map_err(|e| e.to_string())?;
    let mut run = Run {
        trace: Trace::empty(f64::from(machine.channel.cycle_us) * 1e-6, AXES),
        blocks: Vec::new(),
        digest: 0,
        warnings: Vec::new(),
        slower: false,
    };
    let mut digest = Digest::new();
    let mut tick = || {
        let state = interpolator.tick();
        if state == State::Active {
            digest.add(interpolator.set_points());
            run.trace.push(interpolator.set_points().iter().map(|p| p.to_bits()));
        }
        state
    };
    let mut idle = 0;
    loop {
        match planner.poll().map_err(|e| format!("{e:?}"))? {
            Progress::Planned => run.blocks.push(planner.planned()),
            Progress::Warning(warning) => run.warnings.push((warning.place.line, warning.kind)),
            Progress::Working
            | Progress::Replanned
            | Progress::Starved
            | Progress::Late
            | Progress::Deviated(_) => idle += 1,
            Progress::Slower => {
                run.slower = true;
                idle += 1;
            }
            Progress::Waiting => {
                for _ in 0..burst {
                    if tick() == State::Active {
                        idle = 0;
                    }
                }
                idle += 1;
            }
            Progress::Done => break,
        }
        assert!(idle < STUCK, "no progress:\n{text}");
    }
    while tick() == State::Active {}
    run.digest = digest.value();
    Ok(run)
}

/// [`run_in_bursts`] with a queue that is always as full as possible.
///
/// # Errors
/// The library's refusal.
pub fn run<const AXES: usize, const BLOCKS: usize>(
    program: &Program,
    machine: &MachineData<AXES>,
) -> Result<Run, String> {
    run_in_bursts::<AXES, BLOCKS>(program, machine, 1)
}

/// Set points of an arbitrary motion. `at` returns the block and the position in the block at a time, `None`
/// after the end. Tests of the checker use such motions.
pub fn sampled(contour: &Contour, cycle: f64, at: impl Fn(f64) -> Option<Vec<f64>>) -> Trace {
    let bits =
        |p: &[f64]| -> Vec<i64> { p.iter().map(|x| (x * (1u64 << 32) as f64).round() as i64).collect() };
    let mut trace = Trace::new(cycle, &bits(&contour.start));
    for tick in 1.. {
        match at(f64::from(tick) * cycle) {
            Some(point) => trace.push(bits(&point)),
            None => break,
        }
    }
    if let Some(last) = contour.elements.last() {
        trace.push(bits(&last.to));
    }
    trace
}

//! Programs with rounded corners from text to set points.
use crate::cases::machines;
use crate::trace::Trace;
use glidepath::channel::{Channel, Handles, PlannedBlock, Progress};
use glidepath::digest::Digest;
use glidepath::machine::MachineData;
use glidepath::nc::NcWarningKind;
use glidepath::quantity::Position;
use glidepath::technology::Output;
use glidepath::tick::State;

/// Results of a text.
pub struct Run {
    /// Set points.
    pub trace: Trace,
    /// Spans as they were planned.
    pub blocks: Vec<PlannedBlock>,
    /// Rows at which functions were due.
    pub events: Vec<(usize, Output)>,
    /// Lines with a message.
    pub warnings: Vec<(u32, NcWarningKind)>,
    /// Over all set points.
    pub digest: u64,
}

/// Runs a text from `start`.
pub fn run_from<const AXES: usize>(text: &str, start: [Position; AXES], machine: &MachineData<AXES>) -> Run {
    let mut channel: Box<Channel<AXES, 120>> = Box::new(Channel::new());
    let Handles { mut planner, mut interpolator, operator } =
        channel.split(machine, start, text.as_bytes()).expect("machine data");
    let mut run = Run {
        trace: Trace::empty(f64::from(machine.channel.cycle_us) * 1e-6, AXES),
        blocks: Vec::new(),
        events: Vec::new(),
        warnings: Vec::new(),
        digest: 0,
    };
    let mut digest = Digest::new();
    let mut tick = |run: &mut Run| {
        let state = interpolator.tick();
        if state == State::Active {
            digest.add(interpolator.set_points());
            run.trace.push(interpolator.set_points().iter().map(|p| p.to_bits()));
        }
        while let Some(event) = operator.output() {
            run.events.push((run.trace.len() - 1, event));
        }
        run.digest = digest.value();
        state
    };
    loop {
        match planner.poll().unwrap_or_else(|e| panic!("line {}: {e}\n{text}", e.place().line)) {
            Progress::Planned => run.blocks.push(planner.planned()),
            Progress::Waiting => _ = tick(&mut run),
            Progress::Warning(warning) => run.warnings.push((warning.place.line, warning.kind)),
            Progress::Done => break,
            _ => {}
        }
    }
    while tick(&mut run) == State::Active {}
    run
}

/// Runs a text on the even machine with three axes.
pub fn run(text: &str) -> Run {
    run_from::<3>(text, [Position::ZERO; 3], &machines::even(1000))
}

impl Run {
    /// Smallest distance between the set points and a point, in the first two axes.
    pub fn distance(&self, point: [f64; 2]) -> f64 {
        (0..self.trace.len())
            .map(|i| self.trace.mm(i))
            .map(|q| (q[0] - point[0]).hypot(q[1] - point[1]))
            .fold(f64::INFINITY, f64::min)
    }

    /// Remaining lengths of the blocks with this number, and lengths of their curves: all elements in order.
    pub fn lengths(&self, n: u32) -> Vec<f64> {
        self.blocks
            .iter()
            .filter(|b| b.n == n)
            .map(|b| b.length.to_bits() as f64 / (1u64 << 44) as f64)
            .collect()
    }

    /// Seconds.
    pub fn time(&self) -> f64 {
        self.trace.time()
    }

    /// Speed of an axis from row to row, mm/s.
    pub fn axis_speeds(&self, k: usize) -> Vec<f64> {
        let column: Vec<f64> = (0..self.trace.len()).map(|i| self.trace.mm(i)[k]).collect();
        column.windows(2).map(|w| (w[1] - w[0]) / self.trace.cycle).collect()
    }

    /// Speed along the contour between rows.
    pub fn speeds(&self) -> Vec<f64> {
        let row = |i: usize| self.trace.mm(i);
        (1..self.trace.len())
            .map(|i| {
                row(i).iter().zip(row(i - 1)).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
                    / self.trace.cycle
            })
            .collect()
    }
}

/// [`machines::even`] with 1 m/s and HSC.
pub fn quick<const AXES: usize>(cycle_us: u32) -> MachineData<AXES> {
    let mut machine = machines::even::<AXES>(cycle_us);
    machine.channel.slope_profile = 3;
    machine.channel.ptp = true;
    for axis in &mut machine.axes {
        (axis.vb_max, axis.vb_eilgang) = (1_000_000, 1_000_000);
    }
    machine
}

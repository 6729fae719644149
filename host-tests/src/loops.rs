//! Runs of programs with real-time loops.
use glidepath::channel::{Channel, Handles, Progress};
use glidepath::contour_log::{ContourMemory, ContourReader};
use glidepath::digest::Digest;
use glidepath::machine::{InterpolatorData, MachineData};
use glidepath::operator::{Operator, Status};
use glidepath::quantity::Position;
use glidepath::rt_loop::{LoopMemory, LoopSwitch};
use glidepath::tick::State;
use glidepath::variable::Variable;

/// State of a run at a tick.
pub struct Now<'a, 'b> {
    /// The PLC's handle of real-time loops.
    pub switch: LoopSwitch<'b>,
    /// The contour log.
    pub contour: ContourReader<'b>,
    /// The operator.
    pub operator: &'a Operator<'b, 3>,
    /// The status after the tick.
    pub status: Status<3>,
    /// Ticks before it.
    pub tick: u64,
}

/// Runs a program from zero, with room for `COMMANDS` commands of a loop; calls `each` after every tick.
/// Returns the digest of all set points, and the error if the program is refused.
///
/// # Panics
/// The planner does not come to an end.
pub fn run<const COMMANDS: usize>(
    text: &str,
    machine: &MachineData<3>,
    each: impl FnMut(&Now<'_, '_>),
) -> (u64, Option<String>) {
    run_with::<COMMANDS>(text, machine, &[], each)
}

/// The same with variables V.E.
///
/// # Panics
/// As [`run`].
pub fn run_with<const COMMANDS: usize>(
    text: &str,
    machine: &MachineData<3>,
    variables: &[Variable],
    mut each: impl FnMut(&Now<'_, '_>),
) -> (u64, Option<String>) {
    let mut machine = *machine;
    machine.channel.interpolator = InterpolatorData { log_max: u32::MAX, ..InterpolatorData::ALL };
    let mut memory = Box::new(ContourMemory::<512, 128>::new());
    let mut loops = Box::new(LoopMemory::<3, COMMANDS>::new());
    let mut channel: Box<Channel<3, 120>> = Box::new(Channel::new());
    let (recorder, contour) = memory.split();
    let (store, switch) = loops.split();
    let handles = channel.split(&machine, [Position::ZERO; 3], text.as_bytes()).expect("machine data");
    let Handles { mut planner, mut interpolator, operator } = handles;
    planner.log_contour(recorder);
    if COMMANDS > 0 {
        planner.real_time_loops(store);
    }
    planner.variables(variables);
    let (mut refused, mut digest) = (None, Digest::new());
    switch.enable();
    for tick in 0.. {
        let mut calls = 0;
        let done = loop {
            match planner.poll() {
                Ok(Progress::Waiting) => break false,
                Ok(Progress::Done) => break true,
                Ok(_) => {}
                Err(error) => refused = Some(format!("{} {error}", error.id())),
            }
            calls += 1;
            assert!(calls < 1_000_000, "the planner waits for nothing");
        };
        let state = interpolator.tick();
        digest.add(interpolator.set_points());
        each(&Now { switch, contour, operator: &operator, status: operator.status(), tick });
        if done && state == State::Idle {
            break;
        }
    }
    (digest.value(), refused)
}

fn mm(position: Position) -> f64 {
    position.to_num()
}

/// A circle of 20 mm of four arcs, entered and left along its tangent.
pub const CIRCLE: &str = "N10 G01 X30 F6000\nN20 #RT WHILE\nN30 G03 X40 Y10 I0 J10\nN40 X30 Y20 I-10 J0\nN50 X20 Y10 I0 J-10\n\
    N60 X30 Y0 I10 J0\nN70 #RT ENDWHILE\nN80 G01 X60\nM30\n";

/// Ends the loop in pass `pass`, when the motion reaches the block `n`; a pass begins with N30. Returns the
/// number of passes, the lowest speed (mm/s) between the start of the first pass and the end of the last one,
/// and the last position.
///
/// # Panics
/// The program is refused.
pub fn drive(text: &str, machine: &MachineData<3>, pass: u64, n: u32) -> (u64, f64, [f64; 3]) {
    let (mut passes, mut last_n, mut slowest, mut end) = (0, 0, f64::MAX, [0.0; 3]);
    let cycle = f64::from(machine.channel.cycle_us) * 1e-6;
    let (_, refused) = run::<16>(text, machine, |now| {
        let at = now.status.n;
        passes += u64::from(at == 30 && last_n != 30);
        if (30..=60).contains(&at) {
            slowest = slowest.min(now.status.speed.0.to_num::<f64>() / cycle);
        }
        if passes == pass && at == n {
            now.switch.disable();
        }
        last_n = at;
        end = now.status.set_points.map(mm);
    });
    assert_eq!(refused, None);
    (passes, slowest, end)
}

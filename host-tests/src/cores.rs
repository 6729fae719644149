//! Runs a program with planner, interrupt and operator on separate threads, as on a chip with several cores.
//!
//! The order of events differs between runs: the planner is early, late, or in the middle of a change when
//! the interrupt needs its next piece. The checked properties hold in every order.
use crate::cases::random::Random;
use crate::cases::{machines, set_point};
use crate::check;
use crate::operate::{
    Act, LONGEST, Operated, TOO_LONG, crawls, judge, operate_text, random_acts, random_setup, with_overrides,
};
use crate::properties::permitted;
use crate::trace::Trace;
use glidepath::channel::{Channel, Handles, Planner, Progress};
use glidepath::machine::MachineData;
use glidepath::operator::Operator;
use glidepath::quantity::Position;
use glidepath::technology::Output;
use glidepath::tick::{Interpolator, State};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// Number of consecutive ticks at standstill after which a run is given up. The operator then has no further
/// command, and no thread waits for a core.
const RESTS: usize = 3_000_000;

/// Data that the threads share in addition to the channel.
#[derive(Default)]
struct Board {
    /// The planner has no further work, and the operator has no further command.
    planned: AtomicBool,
    /// The interrupt has output all motion, or a thread has given up.
    over: AtomicBool,
    /// All commands were given.
    silent: AtomicBool,
    /// Ticks so far.
    ticks: AtomicUsize,
}

/// Runs `text` from `start` on. `acts` are commands, each with the tick after which it is given. The
/// interrupt yields its core after up to `pace` ticks; with many ticks the planner is always late.
/// the time.
///
/// The library's refusal, or a motion that does not end.
/// The library's refusal, or a motion that does not end.
pub fn operate_on_cores<const BLOCKS: usize>(
    text: &str,
    start: [Position; 3],
    machine: &MachineData<3>,
    acts: &[(usize, Act)],
    pace: u64,
) -> Result<Operated, String> {
    let mut channel: Box<Channel<3, BLOCKS>> = Box::new(Channel::new());
    let handles = channel.split(machine, start, text.as_bytes()).map_err(|e| e.to_string())?;
    let Handles { planner, interpolator, operator } = handles;
    let over = acts.iter().map(|(_, act)| if let Act::Override(feed) = act { *feed } else { 0 });
    let mut run = Operated {
        trace: Trace::empty(f64::from(machine.channel.cycle_us) * 1e-6, 3),
        aborted: acts.iter().any(|(_, act)| *act == Act::Abort),
        over: f64::from(over.fold(1000, u16::max)) / 1000.0,
        ..Operated::default()
    };
    let board = Board::default();
    std::thread::scope(|scope| {
        let operating = scope.spawn(|| command(operator, acts, &board));
        let planning = scope.spawn(|| plan(planner, &board));
        let shown = show(interpolator, &mut run, pace, &board);
        board.over.store(true, Ordering::Release);
        run.outputs = operating.join().map_err(|_| "the operator")?;
        let (late, refused) = planning.join().map_err(|_| "the planner")?;
        run.late = late;
        refused.and(shown)
    })?;
    Ok(run)
}

/// The operator: gives commands at their ticks and takes due functions. Functions that wait are acknowledged
/// at once.
fn command(operator: Operator<'_, 3>, acts: &[(usize, Act)], board: &Board) -> Vec<(usize, Output)> {
    let (mut acts, mut outputs) = (acts.iter().peekable(), Vec::new());
    loop {
        // This is read first, so that earlier output is taken below.
        let over = board.over.load(Ordering::Acquire);
        let tick = operator.status().ticks as usize;
        while let Some((_, act)) = acts.next_if(|(at, _)| *at <= tick) {
            act.give(&operator);
        }
        board.silent.store(acts.peek().is_none(), Ordering::Release);
        while let Some(output) = operator.output() {
            outputs.push((tick, output));
            if output.waits {
                // After an abort no function waits.
                let _ = operator.acknowledge(output.function);
            }
        }
        if over {
            return outputs;
        }
        std::thread::yield_now();
    }
}

/// The planner, called again and again. Returns the number of ticks at which it was late.
fn plan<const BLOCKS: usize>(
    mut planner: Planner<'_, &[u8], 3, BLOCKS>,
    board: &Board,
) -> (Vec<usize>, Result<(), String>) {
    let mut late = Vec::new();
    while !board.over.load(Ordering::Relaxed) {
        let silent = board.silent.load(Ordering::Acquire);
        match planner.poll() {
            // After the last command this does not change.
            Ok(Progress::Done) => board.planned.store(silent, Ordering::Release),
            Ok(Progress::Waiting) => std::thread::yield_now(),
            Ok(Progress::Late) => late.push(board.ticks.load(Ordering::Relaxed)),
            Ok(_) => {}
            Err(error) => {
                board.over.store(true, Ordering::Relaxed);
                return (late, Err(format!("{error:?}")));
            }
        }
    }
    (late, Ok(()))
}

/// The interrupt. Returns the number of ticks until all motion is output.
fn show(
    mut interpolator: Interpolator<'_, 3>,
    run: &mut Operated,
    pace: u64,
    board: &Board,
) -> Result<(), String> {
    let (mut random, mut rests) = (Random::new(pace), 0);
    while !board.over.load(Ordering::Relaxed) {
        let planned = board.planned.load(Ordering::Acquire);
        let state = interpolator.tick();
        board.ticks.fetch_add(1, Ordering::Relaxed);
        // Three differences of set points need four equal rows.
        if rests < 4 {
            run.trace.push(interpolator.set_points().iter().map(|p| p.to_bits()));
            run.distances.push(interpolator.telemetry().distance.to_bits());
        }
        if planned && state == State::Idle {
            return Ok(());
        }
        rests = if state == State::Idle { rests + 1 } else { 0 };
        if rests > RESTS && board.silent.load(Ordering::Relaxed) {
            return Err("nothing moves".to_owned());
        }
        if run.distances.len() > LONGEST {
            return Err(TOO_LONG.to_owned());
        }
        if state == State::Idle || random.bits().is_multiple_of(pace) {
            std::thread::yield_now();
        }
    }
    Ok(())
}

/// Consecutive ticks of the interrupt: the planner is hardly ever late, sometimes late, always late.
const PACES: [u64; 3] = [5, 40, 300];

/// Runs and checks a program and an operator of [`random_setup`]. Returns how often the planner was late, or
/// `None` if the program takes longer than a run may.
///
/// # Errors
/// The first fault.
pub fn random_case(seed: u64) -> Result<Option<usize>, String> {
    let (program, machine, mut random) = random_setup(seed);
    let acts = if random.once_in(2) { random_acts(&mut random, 3000) } else { Vec::new() };
    let acts = if random.once_in(2) { acts } else { with_overrides(&mut random, 3000, acts) };
    let start = std::array::from_fn(|k| Position::from_bits(set_point(program.start[k])));
    let pace = PACES[seed as usize % 3];
    let run = operate_on_cores::<120>(&program.text(&machine), start, &machine, &acts, pace);
    let verdict = run.and_then(|run| judge(&program, &machine, &run).map(|()| run.late.len()));
    match verdict {
        Ok(late) => Ok(Some(late)),
        Err(fault) if fault == TOO_LONG || (fault.ends_with("Unplannable") && crawls(&machine, &acts)) => {
            Ok(None)
        }
        Err(fault) => Err(format!("seed {seed}, pace {pace}, {acts:?}: {fault}")),
    }
}

/// Contour mode, functions with and without acknowledgement, a dwell, exact stops, splines.
fn text(random: &mut Random, slope: &str, mode: &str) -> String {
    let mut text = format!("%t\n#SLOPE [TYPE={slope}]\n#CONTOUR MODE [{mode}]\nG01 X1 G261 F9000\n");
    for k in 1..150_u32 {
        let y = (random.unit() * 3.0 * 1000.0).round() / 1000.0;
        text += &format!("N{} X{} Y{y}", 10 * k, 1 + 3 * k);
        text += match random.bits() % 24 {
            0 => " M9\n",
            1 => "\nM7\n",
            2 => "\nG04 X0.02\nM8\n",
            3 => " H4\n",
            4 => " G60\n",
            _ => "\n",
        };
    }
    text += "G260 X640 Y0\n#SPLINE TYPE AKIMA\n#SPLINE ON\n";
    for k in 1..40 {
        text += &format!("N{} X{} Y{}\n", 2000 + k, 640 + 2 * k, [0.0, 1.5, 2.0, 0.7][k % 4]);
    }
    text + "#SPLINE OFF\nM30\n"
}

/// Runs such a text with one of the slopes and methods. Checks for the same functions in the same order as
/// with one thread, the same end, and the limits of all axes. Returns how often the planner was late.
///
/// # Errors
/// The first fault.
pub fn text_case(seed: u64) -> Result<usize, String> {
    let slopes = ["STEP", "TRAPEZ", "SIN2", "HSC"];
    let modes = [
        "DEV PATH_DEV=0.05",
        "DIST_SOFT PATH_DIST=0.6",
        "PTP PATH_DEV=0.05",
        "DIST PRE_DIST=0.5 POST_DIST=0.4",
    ];
    let slope = seed % 4;
    let (word, mode, pace) = (slopes[slope as usize], modes[seed as usize / 4 % 4], PACES[seed as usize % 3]);
    let mut random = Random::new(seed);
    let text = text(&mut random, word, mode);
    let mut machine = machines::with_slope(machines::mill::<3>(1000), slope as u8);
    machine.channel.ptp = true;
    let acts = if (seed / 16).is_multiple_of(2) {
        Vec::new()
    } else {
        let holds = random_acts(&mut random, 6000);
        let holds = holds.into_iter().filter(|(_, act)| *act != Act::Abort).collect();
        with_overrides(&mut random, 6000, holds)
    };
    let start = [Position::ZERO; 3];
    let case = format!("seed {seed}, {word}, {mode}, pace {pace}, {acts:?}");
    let alone =
        operate_text::<3, 120>(&text, start, &machine, &[], 1000).map_err(|e| format!("{case}: {e}"))?;
    let run =
        operate_on_cores::<120>(&text, start, &machine, &acts, pace).map_err(|e| format!("{case}: {e}"))?;
    let limits: Vec<_> =
        machine.axes.iter().map(|axis| permitted(axis, slope as u8, false, true, true)).collect();
    check::limits(&run.trace, &limits).map_err(|e| format!("{case}: {e}, late at {:?}", run.late))?;
    let functions = |run: &Operated| {
        run.outputs.iter().map(|(_, output)| (output.n, output.function)).collect::<Vec<_>>()
    };
    let (seen, expected) = (functions(&run), functions(&alone));
    if seen != expected || seen.len() < 10 {
        return Err(format!("{case}: functions {seen:?} instead of {expected:?}"));
    }
    // With another override, a curve over time is another curve.
    let end = |run: &Operated| {
        let distance = if acts.is_empty() { run.distances.last().copied() } else { None };
        (distance, run.trace.row(run.trace.len() - 1).collect::<Vec<_>>())
    };
    if end(&run) != end(&alone) {
        return Err(format!("{case}: ends at {:?}, not at {:?}", end(&run), end(&alone)));
    }
    if let Some(tick) = run.distances.windows(2).position(|w| w[0] > w[1]) {
        return Err(format!("{case}: goes back at tick {tick}"));
    }
    Ok(run.late.len())
}

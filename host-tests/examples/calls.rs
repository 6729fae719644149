//! The most expensive planner call while an operator gives commands at any tick, and the most expensive one
//! that waits. The programs are those of the target's tests and random ones, with random commands every 1 to
//! 50 ticks.
//! `cargo run --release -p host-tests --example calls -- FIRST_SEED LAST_SEED [random|steady|alone|programs]`; `steady` has
//! the commands of the target's own case, `alone` has none, `programs` leaves the target's programs out.
//!
//! The cost is the number of executed basic blocks of the PC's code, which is the same in each run. The
//! special build below counts the blocks, in a separate folder. In other builds the cost is the time in
//! nanoseconds, the lowest of five runs.
//!
//! ```text
//! CARGO_INCREMENTAL=0 CARGO_TARGET_DIR=target/counted RUSTFLAGS="-Cpasses=sancov-module -Ccodegen-units=8
//!   -Cllvm-args=-sanitizer-coverage-level=3 -Cllvm-args=-sanitizer-coverage-trace-pc"
//!   cargo run --release --target x86_64-unknown-linux-gnu -p host-tests --example calls -- 0 5000
//! ```
//!
//! The option `--target` keeps these flags away from build scripts, which would not link with them.
//!
//! In the search for a stop, one basic block is 9 to 12 instructions of a Cortex-M4.
use glidepath::channel::{Channel, Handles, Progress};
use glidepath::machine::MachineData;
use glidepath::operator::Operator;
use glidepath::quantity::Position;
use glidepath::tick::State;
use hil_cases::{AXES_3, AXES_4, AXES_6, CASES_3, CASES_4, CASES_6, Case};
use host_tests::cases::random::Random;
use host_tests::cases::set_point;
use host_tests::never_slower::{Case as Rounded, METHODS, SLOPES};
use host_tests::operate::{Act, random_setup};
use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

/// Basic blocks since the start; stays zero where the build does not count.
static BLOCKS: AtomicU64 = AtomicU64::new(0);

// The build calls this in each basic block. In machine code, so that it is not counted itself.
#[cfg(target_arch = "x86_64")]
core::arch::global_asm!(
    ".globl __sanitizer_cov_trace_pc",
    "__sanitizer_cov_trace_pc:",
    "incq {blocks}(%rip)",
    "ret",
    blocks = sym BLOCKS,
    options(att_syntax)
);

/// What counts: blocks, or nanoseconds.
fn now(start: Instant) -> u64 {
    match BLOCKS.load(Ordering::Relaxed) {
        0 => start.elapsed().as_nanos() as u64,
        blocks => blocks,
    }
}

/// Who gives commands.
#[derive(Clone, Copy, PartialEq)]
enum Schedule {
    Alone,
    Steady,
    Random,
}

/// No command comes later, and no run is longer, ticks.
const UNTIL: u32 = 6000;
const LONGEST: u32 = 40_000;
/// More calls in one tick are without end.
const ENDLESS: u32 = 100_000;

/// A call: its cost, its tick, and its number in the tick.
#[derive(Clone, Copy, Default)]
struct Call {
    cost: u64,
    tick: u32,
    number: u32,
}

/// The costliest calls: of all that do something, and of those that wait.
type Worst = [Call; 2];

/// The commands of the target's own case, each 37 ticks.
fn steady(tick: u32) -> Vec<Act> {
    let all = [
        Act::Override(700),
        Act::Override(1500),
        Act::Hold,
        Act::Resume,
        Act::Reduced(true),
        Act::Reduced(false),
        Act::Override(50),
        Act::Override(1000),
    ];
    if tick >= UNTIL { normal() } else { vec![all[(tick / 37 % 8) as usize]] }
}

fn normal() -> Vec<Act> {
    vec![Act::Resume, Act::Reduced(false), Act::Override(1000)]
}

fn random_acts(random: &mut Random) -> Vec<Act> {
    match random.bits() % 12 {
        0..=3 => vec![Act::Hold],
        4..=6 => vec![Act::Resume],
        7 => vec![Act::Reduced(random.once_in(2))],
        8 => vec![Act::Override(random.magnitude(10.0, 2000.0) as u16)],
        9 => vec![Act::Override(1000)],
        10 => vec![Act::Override(500 + (random.bits() % 1500) as u16)],
        _ if random.once_in(8) => vec![Act::Abort],
        _ => normal(),
    }
}

/// Runs a program; with random commands also with few calls in a tick.
fn run<const AXES: usize>(
    (text, start): (&[u8], [Position; AXES]),
    machine: &MachineData<AXES>,
    schedule: Schedule,
    seed: u64,
) -> Worst {
    let mut channel: Box<Channel<AXES, 120>> = Box::new(Channel::new());
    let mut worst = Worst::default();
    let Ok(Handles { mut planner, mut interpolator, operator }) = channel.split(machine, start, text) else {
        return worst;
    };
    let give = |operator: &Operator<'_, AXES>, acts: Vec<Act>| {
        acts.into_iter().for_each(|act| act.give(operator));
    };
    let mut random = Random::new(seed ^ 0x5eed);
    let longest = 1 + random.bits() % 50;
    let polls = [ENDLESS, ENDLESS, 12, 3, 1][(random.bits() % 5) as usize];
    let polls = if schedule == Schedule::Random { polls } else { ENDLESS };
    let (mut next, mut done) = (1, false);
    let begun = Instant::now();
    for tick in 0..LONGEST {
        match schedule {
            Schedule::Steady if tick % 37 == 0 => give(&operator, steady(tick)),
            Schedule::Random if tick == UNTIL => give(&operator, normal()),
            Schedule::Random if tick == next && tick < UNTIL => {
                give(&operator, random_acts(&mut random));
                next += 1 + (random.bits() % longest) as u32;
            }
            _ => {}
        }
        for number in 0..if done { 0 } else { polls } {
            assert!(number + 1 < ENDLESS, "seed {seed}, tick {tick}: calls without end");
            let before = now(begun);
            let said = planner.poll();
            let cost = now(begun) - before;
            let waits = matches!(said, Ok(Progress::Waiting));
            let most = &mut worst[usize::from(waits)];
            if cost > most.cost {
                *most = Call { cost, tick, number };
            }
            done = matches!(said, Ok(Progress::Done) | Err(_));
            if waits || done {
                break;
            }
        }
        if interpolator.tick() == State::Idle && done {
            break;
        }
    }
    worst
}

/// The least of some runs, where time counts.
fn least(run: impl Fn() -> Worst) -> Worst {
    let mut worst = run();
    for _ in 1..if BLOCKS.load(Ordering::Relaxed) > 0 { 1 } else { 5 } {
        for (least, again) in worst.iter_mut().zip(run()) {
            *least = if again.cost < least.cost { again } else { *least };
        }
    }
    worst
}

/// Runs the same with each seed and tells the worst calls.
fn search(name: &str, seeds: Range<u64>, run: impl Fn(u64) -> Worst) {
    let mut most = [(Call::default(), 0); 2];
    for seed in seeds {
        for (most, call) in most.iter_mut().zip(least(|| run(seed))) {
            if call.cost > most.0.cost {
                *most = (call, seed);
            }
        }
    }
    let [works, waits] = most.map(|(Call { cost, tick, number }, seed)| {
        format!("{cost:>6} (seed {seed}, tick {tick}, call {number})")
    });
    println!("{name:<20} works {works:<42} waits {waits}");
}

fn cases<const AXES: usize>(
    cases: &[Case],
    machine: &MachineData<AXES>,
    schedule: Schedule,
    seeds: &Range<u64>,
) {
    for case in cases {
        let start = [Position::ZERO; AXES];
        search(case.name, seeds.clone(), |seed| run((case.text, start), machine, schedule, seed));
    }
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let seed = |k: usize, other: u64| arguments.get(k).map_or(other, |a| a.parse().expect("a seed"));
    let seeds = seed(0, 0)..seed(1, 20);
    let schedule = match arguments.get(2).map(String::as_str) {
        None | Some("random" | "programs") => Schedule::Random,
        Some("steady") => Schedule::Steady,
        Some("alone") => Schedule::Alone,
        Some(other) => panic!("{other}: random, steady, alone or programs"),
    };
    let only_programs = arguments.get(2).is_some_and(|word| word == "programs");
    let each = if only_programs {
        0..0
    } else if schedule == Schedule::Random {
        seeds.clone()
    } else {
        0..1
    };
    cases(CASES_3, &AXES_3, schedule, &each);
    cases(CASES_4, &AXES_4, schedule, &each);
    cases(CASES_6, &AXES_6, schedule, &each);
    // Each smoother, with the slopes in turn.
    for (method, name) in METHODS.iter().enumerate() {
        search(&format!("random, {name}"), seeds.clone(), |seed| {
            let rounded = Rounded::new(seed);
            let slope = seed as usize % SLOPES.len();
            let text = rounded.program(slope, method, 1.0);
            run((text.as_bytes(), rounded.start()), &rounded.machine(slope), schedule, seed)
        });
    }
    search("random programs", seeds, |seed| {
        let (program, machine, _) = random_setup(seed);
        let start = std::array::from_fn(|k| Position::from_bits(set_point(program.start[k])));
        run((program.text(&machine).as_bytes(), start), &machine, schedule, seed)
    });
}

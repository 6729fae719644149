//! Stops with more pieces than the queue has room for: chains of short blocks with corners, where
//! acceleration is zero at every end, and long ramps at short cycles. If the planner gets no time, the motion
//! still ends inside all limits, because the planner keeps the motion so slow that the stop fits. The motion
//! is slower, but does not stop.
use host_tests::cases::Program;
use host_tests::chains::{Chain, Links, chain, go_on, machine, soak, stands};
use host_tests::operate::{Act, Operated, judge, operate};
use host_tests::soak::Outcome;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

/// Ticks in which every queue of these programs runs out, and the motion comes to rest but for long ramps.
const STALL: usize = 12_000;

/// Calls of a planner that keeps up.
const KEEPS_UP: usize = 1_000_000;

/// A program on a machine.
struct Case {
    name: &'static str,
    machine: glidepath::machine::MachineData<3>,
    program: Program,
    /// A standstill from the planned speed has no room.
    slower: bool,
}

fn case(name: &'static str, [cycle_us, ramp_us, look_ahead]: [u32; 3], slope: u8, slower: bool) -> Case {
    let links = match name {
        "long" => Links { count: 0, length: 0.0, turn: 0.0, to_and_fro: false },
        "bow" => Links { count: 200, length: 1.5, turn: 0.4, to_and_fro: false },
        _ => Links { count: 150, length: 0.8, turn: 0.5, to_and_fro: true },
    };
    let program = Program::new(name, 3);
    let program = if name == "long" { go_on(program, 1500.0, links, 60_000.0) } else { program };
    let program = if name == "twice" { go_on(program, 60.0, links, 30_000.0) } else { program };
    let program = go_on(program, 20.0, links, 30_000.0);
    Case { name, machine: machine(cycle_us, ramp_us, look_ahead, slope), program, slower }
}

/// Chains with every slope, and a long block whose ramps have more pieces than places: those that go on as the piece
/// before take a quarter of one. Without room for them in a small build: `host-tests/without`.
fn cases() -> Vec<Case> {
    let mut cases =
        vec![case("long", [100, 1_500_000, 120], 1, false), case("long", [100, 1_500_000, 120], 3, false)];
    for slope in 0..4 {
        let slower = slope == 1 || slope == 2;
        cases.push(case("zigzag", [1000, 50_000, 120], slope, slower));
        // With TRAPEZ it just has room.
        cases.push(case("twice", [500, 30_000, 120], slope, slope == 2));
        cases.push(case("bow", [1000, 100_000, 500], slope, slower));
    }
    cases
}

impl Case {
    fn run(&self, acts: &[(usize, Act)]) -> Result<Operated, String> {
        let run = operate::<3, 500>(&self.program, &self.machine, acts, KEEPS_UP)?;
        judge(&self.program, &self.machine, &run)?;
        Ok(run)
    }

    fn name(&self) -> String {
        format!(
            "{}, slope {}, {} µs",
            self.name, self.machine.channel.slope_profile, self.machine.channel.cycle_us
        )
    }
}

/// Undisturbed, the motion is slower where it has to be, says so, and stands nowhere.
///
/// Rows: OP-05.
#[test]
fn a_way_without_room_makes_the_motion_slower() {
    let mut faults = Vec::new();
    for case in cases() {
        match case.run(&[]) {
            Ok(run) => {
                let ticks = run.distances.len();
                println!("{}: {ticks} ticks, {} stands, slower {:?}", case.name(), stands(&run), run.slower);
                if case.slower == run.slower.is_empty() {
                    faults.push(format!("{}: slower {:?}", case.name(), run.slower));
                }
                if stands(&run) > 0 || !run.late.is_empty() {
                    faults.push(format!("{}: stands {}, late {:?}", case.name(), stands(&run), run.late));
                }
            }
            Err(fault) => faults.push(format!("{}: {fault}", case.name())),
        }
    }
    assert!(faults.is_empty(), "{faults:#?}");
}

/// A planner without time before every so many ticks: all limits hold, and the motion stands.
#[test]
fn a_stall_before_every_29th_tick() {
    let stride = if std::env::var_os("EVERY_TICK").is_some() { 1 } else { 29 };
    let faults = Mutex::new(Vec::new());
    let mut tried = 0;
    for case in cases() {
        let plain = case.run(&[]).unwrap_or_else(|fault| panic!("{}: {fault}", case.name()));
        // Long runs less often.
        let stride = stride * plain.distances.len().div_ceil(2500);
        let ticks: Vec<usize> = (0..plain.distances.len()).step_by(stride).collect();
        let next = AtomicUsize::new(0);
        let work = || {
            while let Some(&at) = ticks.get(next.fetch_add(1, Relaxed)) {
                let verdict = case.run(&[(at, Act::Stall(STALL))]).and_then(|run| {
                    let end = &run.distances[at + STALL - 10..at + STALL];
                    let stands = end.iter().all(|s| *s == end[0]);
                    if stands || case.name == "long" { Ok(()) } else { Err("does not stand".to_owned()) }
                });
                if let Err(fault) = verdict {
                    faults.lock().expect("no panic").push(format!("{}, tick {at}: {fault}", case.name()));
                }
            }
        };
        std::thread::scope(|scope| {
            scope.spawn(work);
            work();
        });
        tried += ticks.len();
        println!(
            "{}: {} ticks, {} faults so far",
            case.name(),
            ticks.len(),
            faults.lock().expect("no panic").len()
        );
    }
    let faults = faults.into_inner().expect("no panic");
    assert!(faults.is_empty(), "{} of {tried}: {:#?}", faults.len(), &faults[..faults.len().min(5)]);
}

/// Random chains on random machines, undisturbed and with stalls. The example `machines` goes on with it.
#[test]
fn random_chains_stalled() {
    let mut faults = Vec::new();
    for seed in host_tests::seeds::seeds(0..60, 10) {
        if let Outcome::Fault(fault) = soak(seed) {
            faults.push(format!("seed {seed}: {fault}"));
        }
    }
    assert!(faults.is_empty(), "{faults:#?}");
}

/// Knees that P-AXIS-00013 leaves most of the acceleration to, and a deceleration that passes them: together no
/// more than the largest acceleration.
#[test]
fn a_way_through_knees_leaves_them_their_acceleration() {
    for seed in [100_033, 100_686, 200_394] {
        if let Outcome::Fault(fault) = soak(seed) {
            panic!("seed {seed}: {fault}");
        }
    }
}

/// Not once, but often: the speed from which there is a way is found again behind each standstill.
#[test]
fn a_chain_stalled_often_comes_to_its_end() {
    let mut chain: Chain = chain(11);
    chain.acts.clear();
    let plain = chain.run(&[]).unwrap_or_else(|fault| panic!("{fault}"));
    let stalls = chain.stalls(plain.trace.len(), 20);
    let run = chain.run(&stalls).unwrap_or_else(|fault| panic!("{fault}"));
    assert!(run.late.len() > 2, "{:?}", run.late);
}

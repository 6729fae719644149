//! A planner call does a bounded part of the search for a stop, for every command at every tick. A call that
//! waits has not searched.
use glidepath::channel::{Channel, Handles, Progress};
use glidepath::machine::MachineData;
use glidepath::operator::Operator;
use glidepath::quantity::Position;
use glidepath::tick::State;
use hil_cases::{AXES_3, AXES_4, AXES_6, CASES_3, CASES_4, CASES_6};
use host_tests::cases::random::Random;
use host_tests::cases::set_point;
use host_tests::operate::{Act, random_setup};

/// Cost of a call at most, in about 100 instructions of a Cortex-M4 (`src/plan/search.rs`): what is spent before the
/// last step, and that step, a round with its law and its first span.
const MOST: u32 = 60 + 760 + 40;

/// No command comes later, and no run is longer, ticks.
const UNTIL: u32 = 4000;
const LONGEST: u32 = 8000;

/// What calls cost for the search: the costliest of all, and of those that waited.
#[derive(Default)]
struct Costs {
    most: u32,
    waits: u32,
    /// Calls that ended within a search, and all that searched.
    pieces: u32,
    calls: u32,
}

fn command(random: &mut Random) -> Act {
    match random.bits() % 12 {
        0..=4 => Act::Hold,
        5..=7 => Act::Resume,
        8 => Act::Reduced(random.once_in(2)),
        9 => Act::Override(random.magnitude(10.0, 2000.0) as u16),
        _ => Act::Override(1000),
    }
}

/// Runs a program with random commands each 1 to 50 ticks, and with as many calls in a tick as it wants, or a few.
fn run<const AXES: usize>(
    (text, start): (&[u8], [Position; AXES]),
    machine: &MachineData<AXES>,
    seed: u64,
    costs: &mut Costs,
) {
    let mut channel: Box<Channel<AXES, 120>> = Box::new(Channel::new());
    let Handles { mut planner, mut interpolator, operator } = channel.split(machine, start, text).unwrap();
    let give = |operator: &Operator<'_, AXES>, act: Act| act.give(operator);
    let mut random = Random::new(seed);
    let longest = 1 + random.bits() % 50;
    let polls = [100_000, 12, 3, 1][(seed % 4) as usize];
    let mut next = 1;
    for tick in 0..LONGEST {
        if tick == next && tick < UNTIL {
            give(&operator, command(&mut random));
            next += 1 + (random.bits() % longest) as u32;
        } else if tick == UNTIL {
            for act in [Act::Resume, Act::Reduced(false), Act::Override(1000)] {
                give(&operator, act);
            }
        }
        for call in 0.. {
            assert!(call < 100_000, "seed {seed}, tick {tick}: calls without end");
            let said = planner.poll();
            let cost = planner.searched();
            costs.most = costs.most.max(cost);
            costs.calls += u32::from(cost > 0);
            match said {
                Ok(Progress::Waiting) => {
                    costs.waits = costs.waits.max(cost);
                    break;
                }
                Ok(Progress::Done) | Err(_) => return,
                Ok(_) if call + 1 >= polls => break,
                Ok(_) => costs.pieces += u32::from(cost >= 60),
            }
        }
        if interpolator.tick() == State::Idle && tick > UNTIL {
            return;
        }
    }
}

fn judge(costs: &Costs) {
    println!("{} of {} calls end within a search; most {}", costs.pieces, costs.calls, costs.most);
    assert!(costs.most <= MOST, "{} for a search in one call", costs.most);
    assert_eq!(costs.waits, 0, "a call that waits has searched");
    assert!(costs.pieces > 100, "no search took several calls");
}

#[test]
fn a_search_is_cut_in_every_program_of_the_target() {
    let mut costs = Costs::default();
    for seed in 0..16 {
        for case in CASES_3 {
            run((case.text, [Position::ZERO; 3]), &AXES_3, seed, &mut costs);
        }
        for case in CASES_4 {
            run((case.text, [Position::ZERO; 4]), &AXES_4, seed, &mut costs);
        }
        for case in CASES_6 {
            run((case.text, [Position::ZERO; 6]), &AXES_6, seed, &mut costs);
        }
    }
    judge(&costs);
}

#[test]
fn a_search_is_cut_in_random_programs_on_random_machines() {
    let mut costs = Costs::default();
    for seed in 0..200 {
        let (program, machine, _) = random_setup(seed);
        let start = std::array::from_fn(|k| Position::from_bits(set_point(program.start[k])));
        run((program.text(&machine).as_bytes(), start), &machine, seed, &mut costs);
    }
    judge(&costs);
}

//! Random programs on random machines with an operator who holds, resumes, aborts and changes the override;
//! program text comes late, and the planner gets no time, all at random ticks, with a check of every tick:
//! `cargo run --release -p host-tests --example operate -- FIRST_SEED LAST_SEED`. With one slope only:
//! `... LAST_SEED SLOPE`, SLOPE as in P-CHAN-00071. In every second group of two dozen seeds the planner gets
//! no time at some ticks ([`is_stalled`]).
use host_tests::operate::{
    POLLS, is_stalled, judge, may_end, operate, random_acts, random_setup, with_overrides, with_stalls,
    with_starvation,
};

fn main() {
    let mut seeds = std::env::args().skip(1).map(|a| a.parse().expect("a seed"));
    let first: u64 = seeds.next().unwrap_or(0);
    let last = seeds.next().unwrap_or(1000);
    let slope = seeds.next();
    let (mut faults, mut skipped) = ([0, 0], 0);
    for seed in first..last {
        let (program, mut machine, mut random) = random_setup(seed);
        if let Some(slope) = slope {
            machine.channel.slope_profile = slope as u8;
        }
        let holds = if random.once_in(2) { random_acts(&mut random, 3000) } else { Vec::new() };
        let acts = if random.once_in(4) { holds } else { with_overrides(&mut random, 3000, holds) };
        let acts = if random.once_in(3) { with_starvation(&mut random, 3000, acts) } else { acts };
        let polls = POLLS[(random.bits() % 3) as usize];
        // Last: the seeds without have the same numbers as before.
        let stalled = is_stalled(seed);
        let acts = if stalled { with_stalls(&mut random, 3000, acts) } else { acts };
        let run = operate::<3, 120>(&program, &machine, &acts, polls);
        let verdict = run.and_then(|run| judge(&program, &machine, &run));
        if let Err(fault) = verdict {
            if may_end(&fault, &program, &machine, &acts) {
                skipped += 1;
                continue;
            }
            faults[usize::from(stalled)] += 1;
            println!("seed {seed}, {acts:?}, {polls} polls: {fault}\n");
        }
        if (seed + 1 - first).is_multiple_of(1000) {
            let [without, with] = faults;
            println!("{} of {} runs, {without} faults, {with} with stalls", seed + 1 - first, last - first);
        }
    }
    let [without, with] = faults;
    println!(
        "{} runs, {without} faults, {with} with stalls; {skipped} longer than a million ticks, or than a block may be",
        last - first
    );
    std::process::exit(i32::from(without + with > 0));
}

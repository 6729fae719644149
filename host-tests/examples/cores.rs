//! Programs with planner, interrupt and operator on separate threads, any number of seeds:
//! `cargo run --release -p host-tests --example cores -- FIRST_SEED LAST_SEED`.
use host_tests::cores::{random_case, text_case};

fn main() {
    let mut seeds = std::env::args().skip(1).map(|a| a.parse().expect("a seed"));
    let first: u64 = seeds.next().unwrap_or(0);
    let last = seeds.next().unwrap_or(1000);
    let (mut faults, mut late, mut skipped) = (0, 0, 0);
    for seed in first..last {
        let random = if first >= 1_000_000 { random_case(seed) } else { Ok(None) };
        for case in [random, text_case(seed).map(Some)] {
            match case {
                Ok(Some(times)) => late += times,
                Ok(None) => skipped += 1,
                Err(fault) => {
                    faults += 1;
                    println!("{fault}\n");
                }
            }
        }
        if (seed + 1 - first).is_multiple_of(50) {
            println!("{} of {} seeds, {faults} faults, late {late} times", seed + 1 - first, last - first);
        }
    }
    println!("{} seeds, {faults} faults, late {late} times; {skipped} too long", last - first);
    std::process::exit(i32::from(faults > 0));
}

//! Random runs with splines and a check of every tick:
//! `cargo run --release -p host-tests --example splines -- FIRST LAST`.
use host_tests::soak::Outcome;
use host_tests::splines::soak;

fn main() {
    let mut seeds = std::env::args().skip(1).map(|a| a.parse::<u64>().expect("a seed"));
    let first = seeds.next().unwrap_or(0);
    let last = seeds.next().unwrap_or(100);
    let (mut good, mut long, mut refused, mut faults) = (0, 0, 0, 0);
    for seed in first..last {
        match std::panic::catch_unwind(|| soak(seed, seed % 2 == 1)) {
            Ok(Outcome::Good(_)) => good += 1,
            Ok(Outcome::TooLong) => long += 1,
            Ok(Outcome::Refused(why)) => {
                refused += 1;
                println!("seed {seed}: refused: {why}");
            }
            Ok(Outcome::Fault(fault)) => {
                faults += 1;
                println!("seed {seed}: FAULT {}", fault.chars().take(300).collect::<String>());
            }
            Err(_) => {
                faults += 1;
                println!("seed {seed}: PANIC");
            }
        }
    }
    println!("{good} good, {long} too long, {refused} refused, {faults} faults");
    std::process::exit(i32::from(faults > 0));
}

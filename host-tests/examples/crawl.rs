//! Random programs with an operator who sets the override nearly to zero, switches reduced speed on, or
//! holds, and ends this a little later:
//! `cargo run --release -p host-tests --example crawl -- FIRST_SEED LAST_SEED`. The checker checks every
//! tick, and afterwards the motion must be as fast as before.
use host_tests::operate::{Crawled, crawl};

fn main() {
    let mut seeds = std::env::args().skip(1).map(|a| a.parse().expect("a seed"));
    let first: u64 = seeds.next().unwrap_or(0);
    let last = seeds.next().unwrap_or(1000);
    let (mut faults, mut long) = (0, 0);
    for seed in first..last {
        match crawl(seed) {
            Crawled::Good => {}
            Crawled::Long => long += 1,
            Crawled::Fault(fault) => {
                faults += 1;
                println!("seed {seed}: {fault}");
            }
        }
    }
    println!(
        "seeds {first} to {last}: {faults} faults; {long} that take longer without an operator than is tried"
    );
    std::process::exit(i32::from(faults > 0));
}

//! Random programs while an operator turns the override nearly to zero, asks for the reduced speed or holds, and takes
//! that back a little later, as many as wanted: `cargo run --release -p host-tests --example crawl -- FIRST_SEED
//! LAST_SEED`. The judge sees every tick, and the motion has to be as fast as ever again behind each of them.
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

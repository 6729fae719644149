//! Curves over time on machines whose axes differ widely, at cycles of 0.1 and 0.25 ms: every limit at every
//! tick.
//! `cargo run --release -p host-tests --example unlike -- FIRST LAST`.
use host_tests::unlike::Unlike;

fn main() {
    let seeds: Vec<u64> = std::env::args().skip(1).filter_map(|word| word.parse().ok()).collect();
    let [first, last] = seeds[..] else { panic!("two seeds") };
    let (mut good, mut faults, mut ticks) = (0, 0, 0);
    for seed in first..last {
        match Unlike::new(seed).judge() {
            Ok(count) => (good, ticks) = (good + 1, ticks + count),
            Err(fault) => {
                faults += 1;
                println!("seed {seed}: {fault}");
            }
        }
        if (seed + 1 - first) % 1000 == 0 {
            println!("{}: {good} within limits, {faults} not, {ticks} ticks", seed + 1);
        }
    }
    println!("{good} within limits, {faults} not, {ticks} ticks");
}

//! Random programs on random machine data over their permitted ranges, with an operator and a check of every
//! tick:
//! `cargo run --release -p host-tests --example machines -- FIRST_SEED LAST_SEED [stalls|chains] [long]`.
//! With `stalls` the planner sometimes gets no processor time. `chains`: chains of short blocks with corners,
//! each without disturbance and with stalls. `long`: runs of up to twenty million ticks instead of one
//! million (some gigabytes). `machines -- SEED` shows one seed, the result without an operator and without
//! contour mode, and the time with a stop at the end of each block by the f64 reference. Two threads.
use host_tests::chains;
use host_tests::operate::{LONGEST, longest};
use host_tests::soak::{Outcome, plain, setup, soak_within};
use std::io::IsTerminal;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::time::Instant;

const THREADS: usize = 2;

/// Ticks of a long run.
const LONG: usize = 20_000_000;

fn show<const AXES: usize>(seed: u64, stalls: bool, most: usize) {
    let setup = setup::<AXES>(seed, stalls);
    println!("{:#?}\n{}\n{:?}, {} polls", setup.machine, setup.text(), setup.acts, setup.polls);
    println!("without an operator: {:?}", plain::<AXES>(seed, false).run_within(most));
    println!("without contour mode too: {:?}", plain::<AXES>(seed, true).run_within(most));
    println!("with standstills at least: {:.0} ticks", longest(&setup.program, &setup.machine));
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let stalls = arguments.iter().any(|word| word == "stalls");
    let chained = arguments.iter().any(|word| word == "chains");
    let most = if arguments.iter().any(|word| word == "long") { LONG } else { LONGEST };
    let seeds: Vec<u64> = arguments.iter().filter_map(|word| word.parse().ok()).collect();
    let (first, last) = match seeds[..] {
        [seed] if chained => {
            let chain = chains::chain(seed);
            println!("{:#?}\n{:?}, {} polls", chain.machine, chain.acts, chain.polls);
            (seed, seed + 1)
        }
        [seed] => {
            match seed % 4 {
                0 => show::<3>(seed, stalls, most),
                1 => show::<4>(seed, stalls, most),
                2 => show::<5>(seed, stalls, most),
                _ => show::<6>(seed, stalls, most),
            }
            (seed, seed + 1)
        }
        [first, last, ..] => (first, last),
        [] => (0, 1000),
    };
    println!("seeds {first} to {last}, {}", if stalls { "with stalls" } else { "without stalls" });
    let (next, done) = (AtomicU64::new(first), AtomicU64::new(0));
    let [faults, too_long, refused, ticks] = [const { AtomicU64::new(0) }; 4];
    let begun = Instant::now();
    let every = if std::io::stderr().is_terminal() { 50 } else { 1000 };
    std::thread::scope(|scope| {
        for _ in 0..THREADS {
            scope.spawn(|| {
                loop {
                    let seed = next.fetch_add(1, Relaxed);
                    if seed >= last {
                        break;
                    }
                    let run = || if chained { chains::soak(seed) } else { soak_within(seed, stalls, most) };
                    match std::panic::catch_unwind(run) {
                        Ok(Outcome::Good(count)) => _ = ticks.fetch_add(count as u64, Relaxed),
                        Ok(Outcome::TooLong) => {
                            too_long.fetch_add(1, Relaxed);
                            println!("seed {seed}: longer");
                        }
                        Ok(Outcome::Refused(_)) => _ = refused.fetch_add(1, Relaxed),
                        Ok(Outcome::Fault(fault)) => {
                            faults.fetch_add(1, Relaxed);
                            println!("seed {seed}: {fault}");
                        }
                        Err(_) => {
                            faults.fetch_add(1, Relaxed);
                            println!("seed {seed}: panicked");
                        }
                    }
                    let count = done.fetch_add(1, Relaxed) + 1;
                    if count.is_multiple_of(every) {
                        let left =
                            (last - first - count) as f64 * begun.elapsed().as_secs_f64() / count as f64;
                        eprintln!(
                            "{count} of {}, {} faults, {left:.0} s to go",
                            last - first,
                            faults.load(Relaxed)
                        );
                    }
                }
            });
        }
    });
    let faults = faults.into_inner();
    println!(
        "{} programs, {} ticks, {faults} faults; {} refused (a block of more than 2^26 ticks), {} longer than {most} ticks",
        last - first,
        ticks.into_inner(),
        refused.into_inner(),
        too_long.into_inner()
    );
    std::process::exit(i32::from(faults > 0));
}

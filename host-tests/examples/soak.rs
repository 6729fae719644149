//! Random programs on random machines with a check of every tick, any number of seeds:
//! `cargo run --release -p host-tests --example soak -- FIRST_SEED LAST_SEED SLOPE`, SLOPE as in
//! P-CHAN-00071.
use host_tests::cases::machines;
use host_tests::cases::random::{Mix, program};
use host_tests::check::allowance;
use host_tests::properties::{axis_limits, verify};

/// Faults among the seeds; prints them.
fn soak<const AXES: usize>(seeds: std::ops::Range<u64>, slope: u8) -> usize {
    let mut faults = 0;
    let (mut error, mut used) = (0.0_f64, [0.0_f64; 3]);
    for seed in seeds {
        let mut machine = machines::arbitrary::<AXES>(seed);
        machine.channel.slope_profile = slope;
        let mut program = program(seed, Mix::arbitrary(AXES, seed));
        program.optimised = seed % 2 == 1;
        match verify::<AXES, 120>(&program, &machine) {
            Ok(verdict) => {
                error = error.max(verdict.course.error);
                for (peaks, limits) in verdict.peaks.iter().zip(axis_limits(&machine, &verdict.contour)) {
                    let parts = peaks.values.into_iter().zip([limits.v, limits.a, limits.jerk]);
                    for ((used, (value, limit)), order) in used.iter_mut().zip(parts).zip(1..) {
                        let rounding = allowance(order, verdict.run.trace.cycle);
                        *used = used.max((value - rounding) / limit);
                    }
                }
            }
            Err(fault) => {
                faults += 1;
                println!("{AXES} axes, {fault}\n");
            }
        }
    }
    println!(
        "{AXES} axes: {faults} faults; path error {:.2} pm; speed, acceleration and jerk used to {used:.4?}",
        error * 1e9
    );
    faults
}

fn main() {
    let mut seeds = std::env::args().skip(1).map(|a| a.parse().expect("a seed"));
    let first = seeds.next().unwrap_or(0);
    let (seeds, slope) = (first..seeds.next().unwrap_or(100), seeds.next().unwrap_or(1) as u8);
    let faults = [soak::<1>, soak::<2>, soak::<3>, soak::<6>]
        .iter()
        .map(|soak| soak(seeds.clone(), slope))
        .sum::<usize>();
    std::process::exit(i32::from(faults > 0));
}

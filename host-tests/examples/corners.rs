//! Checks random corners in contour mode, any number of seeds:
//! `cargo run --release -p host-tests --example corners -- FIRST_SEED LAST_SEED` (50,000 take some minutes).
use glidepath::nc::Contour;
use host_tests::cases::machines;
use host_tests::corner::{judge_with, random};

fn main() {
    let mut seeds = std::env::args().skip(1).map(|a| a.parse::<u64>().expect("a seed"));
    let (first, last) = (seeds.next().unwrap_or(0), seeds.next().unwrap_or(1000));
    let machine = machines::even::<3>(1000);
    let (mut faults, mut sharp, mut limited) = (0, 0, 0);
    let (mut most, mut least, mut uneven) = (0.0_f64, f64::INFINITY, 0.0_f64);
    let mut elements = [0u32; 40];
    for seed in first..last {
        if (seed - first) % 5000 == 4999 {
            println!("{} of {}", seed - first + 1, last - first);
        }
        match judge_with(&random(seed), &machine, |dev| Contour { const_vel: Some(true), ..dev }) {
            Ok(seen) if seen.sharp => sharp += 1,
            Ok(seen) => {
                elements[seen.elements] += 1;
                most = most.max(seen.used);
                uneven = uneven.max(seen.uneven);
                if seen.used > 1.0 || seen.uneven > 1e-3 {
                    println!("{seed}: {seen:?} {:?}", random(seed).program.moves);
                    faults += 1;
                }
                if seen.limited {
                    limited += 1;
                } else {
                    least = least.min(seen.used);
                    if seen.used < 0.999 {
                        println!("{seed}: {seen:?} {:?}", random(seed).program.moves);
                        faults += 1;
                    }
                }
            }
            Err(fault) => {
                println!("{seed}: {fault}");
                faults += 1;
            }
        }
    }
    println!(
        "{faults} faults; {sharp} sharp, {limited} limited by length; tolerance used {least:.5} … {most:.6}; uneven {uneven:.2e}; elements {elements:?}"
    );
    std::process::exit(i32::from(faults > 0));
}

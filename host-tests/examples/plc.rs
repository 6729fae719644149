//! Answers to a PLC, compared with the later motion.
//!
//! `plc forecast SEEDS`: questions about the coming motion, at random moments of this number of random
//! programs with each slope.
//! `plc requests COUNT`: requests from another thread while programs run.
use host_tests::foresee::{Asks, Told, run};
use host_tests::requests;

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    let number = arguments.get(2).and_then(|number| number.parse().ok());
    match (arguments.get(1).map(String::as_str), number) {
        (Some("forecast"), Some(seeds)) => forecast(seeds),
        (Some("requests"), Some(count)) => ask(count),
        _ => println!("plc forecast SEEDS, or plc requests COUNT"),
    }
}

fn forecast(seeds: u64) {
    for (slope, name) in ["STEP", "TRAPEZ", "SIN2", "HSC"].into_iter().enumerate() {
        let (mut told, mut shortest) = (Told::default(), Told::default());
        for seed in 0..seeds {
            run(seed, slope as u8, Asks::States, &mut told);
            run(seed, slope as u8, Asks::Stops, &mut told);
            run(seed, slope as u8, Asks::Nothing, &mut shortest);
        }
        println!("{name}\n  state {:?}\n  feed  {:?}\n  stand {:?}", told.state, told.feed, told.stand);
        let mean = |told: &Told| told.stopping as f64 / f64::from(told.stand.compared.max(1));
        println!(
            "  a stop takes {:.2} ticks, {:.2} where a hold looks for shorter ones",
            mean(&told),
            mean(&shortest)
        );
    }
}

fn ask(count: u64) {
    let alone = requests::run(None).1;
    let (asked, driven) = requests::run(Some(count));
    println!("{asked:?}");
    let unlike = driven.iter().filter(|driven| Some(*driven) != alone.first()).count();
    println!("{} programs driven to their end, {unlike} of them not as without requests", driven.len());
    assert_eq!(unlike, 0);
}

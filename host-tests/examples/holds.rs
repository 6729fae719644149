//! Feed holds at random ticks of random programs, with each slope and method, against the shortest stop on the path ahead:
//! `cargo run --release -p host-tests --example holds -- FIRST LAST [HOLDS [METHOD …]]`. A program runs with one tolerance, and
//! again with each of its holds (4). `host-tests/src/holds.rs` says what the measure is.
use host_tests::holds::{Held, MOST, of_seed};
use host_tests::never_slower::{METHODS, SLOPES};

fn main() {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let numbers: Vec<u64> = words.iter().filter_map(|word| word.parse().ok()).collect();
    let [first, last, rest @ ..] = &numbers[..] else { panic!("two seeds") };
    let count = rest.first().copied().unwrap_or(4);
    let named = |method: &str| words.iter().any(|word| word == method);
    let all = !METHODS.iter().any(|name| named(name));
    println!(
        "| slope | method | holds | time: 95 %, worst | distance: 95 %, worst | above {MOST} | and above {MOST} of the shortest found | faults |"
    );
    println!("|---|---|---:|---:|---:|---:|---:|---:|");
    for (slope, (name, ..)) in SLOPES.iter().enumerate() {
        for (method, on) in METHODS.iter().enumerate().filter(|(_, on)| all || named(on)) {
            let (mut seen, mut faults): (Vec<(Held, u64)>, u64) = (Vec::new(), 0);
            for seed in *first..*last {
                let Ok(outcome) = of_seed(seed, (slope, method), count) else { continue };
                for fault in &outcome.faults {
                    println!("{name}, {on}, seed {seed}: {fault}");
                    faults += 1;
                }
                seen.extend(outcome.holds.into_iter().map(|held| (held, seed)));
            }
            let [time, distance] = [0, 1].map(|which| {
                seen.sort_by(|(a, _), (b, _)| a.ratios()[which].total_cmp(&b.ratios()[which]));
                let most = seen.get(seen.len() * 95 / 100).map_or(0.0, |(held, _)| held.ratios()[which]);
                let worst = seen.last().map_or(String::new(), |(held, seed)| {
                    let [seen, wanted] = [held.seen, held.wanted].map(|stop| [stop.time, stop.way][which]);
                    let ratio = held.ratios()[which];
                    format!("{ratio:.2} ({seen:.3} of {wanted:.3}, seed {seed}, tick {})", held.tick)
                });
                format!("{most:.2}, {worst}")
            });
            let above = seen.iter().filter(|(held, _)| held.is_long()).count();
            let longer = seen.iter().filter(|(held, _)| held.is_longer_than_found()).count();
            println!(
                "| {name} | {on} | {} | {time} | {distance} | {above} | {longer} | {faults} |",
                seen.len()
            );
        }
    }
}

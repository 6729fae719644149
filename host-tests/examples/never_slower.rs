//! Random programs with every slope and method, compared with stops, less tolerance, half the feed and DEV,
//! as a table:
//! `cargo run --release -p host-tests --example never_slower -- FIRST LAST [METHOD …]`. 2,000 programs: 0 2000.
//! After each worst quotient follow its seed and the part of all comparisons that exceed 1.01 (1.02 with
//! DEV).
//! With the word `show`: the program FIRST with slope number LAST and one method, and its times.
use host_tests::never_slower::{Case, METHODS, SLOPES, Worst};

fn main() {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let seeds: Vec<u64> = words.iter().filter_map(|word| word.parse().ok()).collect();
    let [first, last] = seeds[..] else { panic!("two seeds") };
    let named =
        |method: &str| METHODS.iter().any(|name| words.iter().any(|word| word == name) && *name == method);
    let all = !METHODS.iter().any(|name| named(name));
    if words.iter().any(|word| word == "show") {
        for method in METHODS.into_iter().filter(|method| named(method)) {
            println!("{}", Case::new(first).show(last as usize, method));
        }
        return;
    }
    println!("| slope | method | standstills | less tolerance | half the feed | DEV | refused |");
    println!("|---|---|---:|---:|---:|---:|---:|");
    for (slope, (name, ..)) in SLOPES.iter().enumerate() {
        for (method, on) in METHODS.iter().enumerate().filter(|(_, on)| all || named(on)) {
            let mut worst = Worst::default();
            for seed in first..last {
                Case::new(seed).measure(seed, slope, method, &mut worst);
            }
            let [a, b, c, d] = std::array::from_fn(|k| {
                let (quotient, seed) = worst.quotients[k];
                let part = 100.0 * f64::from(worst.above[k]) / f64::from(worst.compared[k].max(1));
                format!("{quotient:.3} ({seed}), {part:.1} %")
            });
            println!("| {name} | {on} | {a} | {b} | {c} | {d} | {} |", worst.refused);
        }
    }
}

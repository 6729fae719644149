//! Simulated hours of jobs, jogs, holds, resets and errors at full speed: 24 by
//! `cargo run -p glidepath-controller --release --example soak`, another number as argument.
#[path = "../tests/bench/mod.rs"]
mod bench;

use bench::soak::soak;

/// Ticks of an hour.
const HOUR: u64 = 3_600_000;

/// Ticks of a part: a quarter of an hour on one machine.
const PART: u64 = HOUR / 4;

/// Memory of the process, pages; 0 where the system does not tell.
fn pages() -> u64 {
    let text = std::fs::read_to_string("/proc/self/statm").unwrap_or_default();
    text.split(' ').nth(1).and_then(|pages| pages.parse().ok()).unwrap_or(0)
}

fn main() {
    let hours: f64 = std::env::args().nth(1).and_then(|text| text.parse().ok()).unwrap_or(24.0);
    let first = bench::fresh_seed();
    let (mut ticks, mut lines, mut seed) = (0, 0, first);
    let mut begun = 0;
    while (ticks as f64) < hours * HOUR as f64 {
        let soaked = soak(seed, PART.min((hours * HOUR as f64) as u64));
        (ticks, lines) = (ticks + soaked.ticks, lines + soaked.lines);
        begun = if begun == 0 { pages() } else { begun };
        println!("{:.2} h, {lines} lines, {} pages; {soaked:?}", ticks as f64 / HOUR as f64, pages());
        seed += 1;
    }
    // A rig leaks its serial memory on purpose: two kilobytes.
    let most = begun + (seed - first) + 64;
    assert!(pages() <= most, "{} pages, {begun} at the beginning", pages());
    println!(
        "{:.2} simulated hours: no wrong state, each line answered once, no place off by a bit",
        ticks as f64 / HOUR as f64
    );
}

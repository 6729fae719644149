//! A long conversation over a bad line: 10^8 bytes by
//! `cargo run -p glidepath-controller --release --example damage`, or another number as argument. With the
//! second argument `machine` the test includes planner and interpolator, and checks that no axis leaves its
//! travel range.
#[path = "../tests/bench/mod.rs"]
mod bench;

use bench::corruption::{Damaged, damage, damage_of};
use bench::world::{World, settings, with_rig};

/// Bytes of a seed.
const BYTES: u64 = 1_000_000;

fn machine(seed: u64) -> Damaged {
    let mut settings = settings();
    settings.soft_limits = true;
    with_rig(&settings, World::new(seed), |rig| damage_of(rig, seed, BYTES))
}

fn main() {
    let mut arguments = std::env::args().skip(1);
    let bytes: u64 = arguments.next().and_then(|text| text.parse().ok()).unwrap_or(100_000_000);
    let has_machine = arguments.next().is_some_and(|word| word == "machine");
    let first = bench::fresh_seed();
    let (mut done, mut lines, mut resets, mut seed) = (0, 0, 0, first);
    while done < bytes {
        let damaged = if has_machine { machine(seed) } else { damage(seed, BYTES) };
        (done, lines, resets) = (done + damaged.bytes, lines + damaged.lines, resets + damaged.resets);
        seed += 1;
        if has_machine || (seed - first).is_multiple_of(10) {
            println!("{done} bytes, {lines} lines, {resets} resets");
        }
    }
    println!("{done} bytes, {lines} lines, {resets} resets: each line answered once");
}

//! Homing cycles on random machines: 10,000 by
//! `cargo run -p glidepath-controller --release --example homing`, or another number as argument. Each switch
//! has 20 µm of hysteresis and bounces; speeds, positions and directions are random.
//!
//! The command fails if an axis ends farther from its switch than the distance of a slot, or reaches its hard
//! stop.
#[path = "../tests/bench/mod.rs"]
mod bench;

/// The first machine: those before are in the tests.
const FIRST: u64 = 100;

fn main() {
    let machines: u64 = std::env::args().nth(1).and_then(|text| text.parse().ok()).unwrap_or(10_000);
    let (mut stray, mut beyond) = (0.0f64, 0.0f64);
    for done in 1..=machines {
        let homed = bench::homing::home(FIRST + done - 1);
        (stray, beyond) = (stray.max(homed.stray), beyond.max(homed.beyond));
        if done.is_multiple_of(1000) {
            println!("{done} machines homed");
        }
    }
    println!(
        "{machines} machines homed: at most {stray:.3} ways of a slot off a switch, {beyond:.3} mm behind one"
    );
}

//! The host's side of `cargo xtask hil --plc`: what the target has to show.
use glidepath::channel::Channel;
use hil_cases::{BLOCKS, LASER_POWER, PASSES, PlcMemory, RING_DIGEST, Unwatched, laser, ring};

/// A log changes no set point; the ring is as long as its passes: 3 + 100·2π + 3 mm at 50 mm/s.
#[test]
fn a_ring_that_a_plc_ends() {
    let mut channel = Box::new(Channel::<3, BLOCKS>::new());
    let mut memory = Box::new(PlcMemory::new());
    for logs in [false, true] {
        let outcome = ring(&mut channel, &mut memory, logs, &mut Unwatched).expect("it runs");
        assert_eq!(format!("{:016x}", outcome.digest.value()), format!("{RING_DIGEST:016x}"), "logs: {logs}");
        let steady = (6.0 + f64::from(PASSES) * std::f64::consts::TAU) / 50.0 * 1000.0;
        let slow = f64::from(outcome.ticks) - steady;
        assert!((0.0..1000.0).contains(&slow), "{slow} ms longer than at {steady} ms");
    }
}

/// The power changes at the ticks at which the simulator tells it (`boards/host/tests/plc.rs` has the same list).
#[test]
fn a_laser_that_a_plc_sets() {
    let mut channel = Box::new(Channel::<3, BLOCKS>::new());
    let mut memory = Box::new(PlcMemory::new());
    let mut changes = Vec::new();
    let told = |tick, percent| changes.push((tick, percent));
    laser(&mut channel, &mut memory, &mut Unwatched, told).expect("it runs");
    assert_eq!(changes, LASER_POWER);
}

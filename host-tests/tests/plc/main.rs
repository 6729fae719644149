//! The PC's side of `cargo xtask hil --plc`: the expected results of the target.
mod distance;
mod limits;

use glidepath::channel::Channel;
use hil_cases::{BLOCKS, LASER_POWER, PASSES, PlcMemory, RING_DIGEST, Unwatched, laser, ring};

/// A log changes no set point. The ring is as long as its passes: 3 + 100·2π + 3 mm, at most 50 mm/s; in the circle of 1 mm
/// acceleration binds a little below.
#[test]
fn a_ring_that_a_plc_ends() {
    let mut channel = Box::new(Channel::<3, BLOCKS>::new());
    let mut memory = Box::new(PlcMemory::new());
    for logs in [false, true] {
        let outcome = ring(&mut channel, &mut memory, logs, &mut Unwatched).expect("it runs");
        assert_eq!(format!("{:016x}", outcome.digest.value()), format!("{RING_DIGEST:016x}"), "logs: {logs}");
        let length = 6.0 + f64::from(PASSES) * std::f64::consts::TAU;
        let mean = 1000.0 * length / f64::from(outcome.ticks);
        assert!((43.0..50.0).contains(&mean), "{mean} mm/s in the mean");
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

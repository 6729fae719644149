//! Bytes that are damaged on the line: each line is answered once, and after the next line end sender and
//! controller agree again.
mod bench;

use bench::corruption::{damage, damage_of};
use bench::world::{World, settings, with_rig};

#[test]
fn a_million_damaged_bytes() {
    let seed = bench::fresh_seed();
    for seed in (0..6).chain(seed..seed + 4) {
        let damaged = damage(seed, 100_000);
        assert!(damaged.lines > 1000 && damaged.resets > 10, "{damaged:?}");
    }
}

/// With planner and interpolator behind it: besides, no axis leaves its travel.
#[test]
fn damaged_bytes_move_no_axis_beyond_its_travel() {
    let seed = bench::fresh_seed();
    for seed in (0..4).chain(seed..seed + 4) {
        let damaged = real_machine(seed, 25_000);
        assert!(damaged.lines > 800 && damaged.resets > 3, "{damaged:?}");
    }
}

fn real_machine(seed: u64, bytes: u64) -> bench::corruption::Damaged {
    let mut settings = settings();
    settings.soft_limits = true;
    with_rig(&settings, World::new(seed), |rig| {
        let damaged = damage_of(rig, seed, bytes);
        assert!(rig.world.seen.iter().all(|(least, _)| *least < -1.0), "{:?}", rig.world.seen);
        damaged
    })
}

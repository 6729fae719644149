//! Bytes that are damaged on their way: each line is answered once, and the next line end brings both sides in step.
mod bench;

use bench::corruption::damage;

#[test]
fn a_million_damaged_bytes() {
    let seed = bench::fresh_seed();
    for seed in (0..6).chain(seed..seed + 4) {
        let damaged = damage(seed, 100_000);
        assert!(damaged.lines > 1000 && damaged.resets > 10, "{damaged:?}");
    }
}

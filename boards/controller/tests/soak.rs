//! Minutes of random operation; hours by `cargo run -p glidepath-controller --release --example soak`.
mod bench;

/// Rows of the machine: no state that must not follow, each line answered once, each place exact to the last bit.
#[test]
fn ten_minutes_of_work() {
    let fresh = bench::fresh_seed();
    for seed in [1, 2, 3, fresh] {
        let soaked = bench::soak::soak(seed, 150_000);
        assert!(soaked.jobs > 3 && soaked.homed > 0 && soaked.lines > 50, "{soaked:?}");
    }
    // The same seed does the same.
    let [first, second] = [9, 9].map(|seed| bench::soak::soak(seed, 20_000).digest);
    assert_eq!(first, second);
}

//! Many short random sessions: every report, banner and answer comes within its bound.
mod bench;

use bench::session::{Figures, session};

fn sessions(seeds: impl Iterator<Item = u64>) -> Figures {
    let mut figures = Figures::default();
    for seed in seeds {
        session(seed, &mut figures);
    }
    println!("{figures:?}");
    figures
}

#[test]
fn a_hundred_random_sessions() {
    let fresh = bench::fresh_seed();
    let figures = sessions((0..70).chain(fresh..fresh + 30));
    assert!(figures.lines > 3_000 && figures.resets > 100 && figures.machines > 100, "{figures:?}");
}

/// As many as `GLIDEPATH_SESSIONS` says, 10,000 otherwise; `GLIDEPATH_SEED` is the first seed.
#[test]
#[ignore = "minutes"]
fn thousands_of_random_sessions() {
    let count =
        std::env::var("GLIDEPATH_SESSIONS").ok().and_then(|count| count.parse().ok()).unwrap_or(10_000);
    let fresh = bench::fresh_seed();
    sessions(fresh..fresh + count);
}

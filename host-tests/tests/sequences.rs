//! Random sessions of one channel: [`host_tests::sequences`].
use host_tests::sequences::{Done, session};

/// GLIDEPATH_SEEDS: how many; GLIDEPATH_FROM: the first one.
#[test]
fn sessions_do_what_their_lines_say() {
    let number = |name| std::env::var(name).ok().and_then(|number: String| number.parse::<u64>().ok());
    let (from, count) = (number("GLIDEPATH_FROM").unwrap_or(0), number("GLIDEPATH_SEEDS").unwrap_or(60));
    let (mut all, mut faults) = (Done::default(), Vec::new());
    for seed in from..from + count {
        match session(seed) {
            Ok(done) => {
                all.steps += done.steps;
                all.ticks += done.ticks;
                all.refused += done.refused;
                all.aborted += done.aborted;
                all.repeated += done.repeated;
            }
            Err(what) => {
                println!("{}", what.lines().next().unwrap_or_default());
                faults.push(what);
            }
        }
    }
    println!("{all:?}, {} faults", faults.len());
    let first: Vec<String> = faults.iter().take(4).cloned().collect();
    assert!(faults.is_empty(), "{} faults\n{}", faults.len(), first.join("\n\n"));
    let Done { steps, refused, aborted, repeated, .. } = all;
    assert!(steps > 100 && refused > 10 && aborted > 10 && repeated > 10, "{all:?}");
}

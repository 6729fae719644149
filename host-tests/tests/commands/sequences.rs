//! Random sessions of one channel: [`host_tests::sequences`].
use host_tests::sequences::{Done, session};

/// Sessions that were wrong once: the start of a motion was told by its remainder in a filter; a jog behind an abort that
/// was not carried out yet; a filter of two taps, whose jerk had nothing left for rounding, twice; end speeds of HSC that
/// were rounded in a program behind one with commands, three times.
const ONCE: [u64; 7] = [300_501, 300_693, 5_937, 8_079, 6_967, 303_339, 304_355];

/// GLIDEPATH_SEEDS: how many; GLIDEPATH_FROM: the first one.
#[test]
fn sessions_do_what_their_lines_say() {
    let number = |name| std::env::var(name).ok().and_then(|number: String| number.parse::<u64>().ok());
    let (from, count) = (number("GLIDEPATH_FROM").unwrap_or(0), number("GLIDEPATH_SEEDS").unwrap_or(60));
    let (mut all, mut faults) = (Done::default(), Vec::new());
    for seed in ONCE.into_iter().chain(from..from + count) {
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

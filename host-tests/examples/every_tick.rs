//! One disturbance before each tick of a program, with a check of every tick:
//! `cargo run --release -p host-tests --example every_tick -- PROGRAM SLOPE STEP stall|hold|STALL_TICKS [FIRST [LAST]]`.
//!
//! PROGRAM and SLOPE are names, several separated by commas, or `all`. STEP is 1 for every tick. `stall`: the
//! planner gets no processor time until the motion stands still; a number: for this number of ticks. `hold`:
//! a feed hold, compared with the closed form. FIRST and LAST are ticks. Without arguments the command lists
//! the names.
use host_tests::every_tick::{CASES, Case, Disturbance, Report, SLOPES, Slope, Track, disturb_all};
use std::time::Instant;

fn main() {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let [programs, slopes, step, what, range @ ..] = &args[..] else {
        println!("programs: {}", CASES.map(|case| case.name).join(" "));
        println!("slopes: {}", SLOPES.map(|(name, _)| name).join(" "));
        return;
    };
    let step: usize = step.parse().expect("a number of ticks");
    let disturbance = match what.as_str() {
        "stall" => Disturbance::Stall,
        "hold" => Disturbance::Hold,
        ticks => Disturbance::ShortStall(ticks.parse().expect("stall, hold or a number of ticks")),
    };
    let tick = |k: usize, or: usize| range.get(k).map_or(or, |tick| tick.parse().expect("a tick"));
    let range = tick(0, 0)..tick(1, usize::MAX);
    let chosen = |list: &str, name: &str| list == "all" || list.split(',').any(|wanted| wanted == name);
    let known = |list: &str, names: &[&str]| {
        let unknown = list.split(',').find(|name| *name != "all" && !names.contains(name));
        assert!(unknown.is_none(), "{} is not one of {names:?}", unknown.unwrap_or_default());
    };
    known(programs, &CASES.map(|case| case.name));
    known(slopes, &SLOPES.map(|(name, _)| name));
    let mut faults = 0;
    for case in CASES.into_iter().filter(|case| chosen(programs, case.name)) {
        for (_, slope) in SLOPES.into_iter().filter(|(name, _)| chosen(slopes, name)) {
            let go = if case.axes() == 4 { go::<4> } else { go::<3> };
            faults += go(case, slope, step, disturbance, range.clone());
        }
    }
    std::process::exit(i32::from(faults > 0));
}

/// Prints what came of one track; its faults.
fn go<const AXES: usize>(
    case: Case,
    slope: Slope,
    step: usize,
    disturbance: Disturbance,
    range: std::ops::Range<usize>,
) -> usize {
    let begun = Instant::now();
    let track = match Track::<AXES>::new(case, slope, case.path.blocks()) {
        Ok(track) => track,
        Err(fault) => {
            println!("undisturbed: {fault}");
            return 1;
        }
    };
    let ticks = (0..track.ticks()).step_by(step).filter(|tick| range.contains(tick));
    let report = disturb_all(&track, ticks, disturbance);
    let Report { tried, faults, used, .. } = &report;
    println!(
        "{:<28} {:>6} ticks {tried:>6} tried {:>5} faults; of the good ones v, a, jerk to {:.3} {:.3} {:.3}; {:.0} s",
        track.name,
        track.ticks(),
        faults.len(),
        used[0],
        used[1],
        used[2],
        begun.elapsed().as_secs_f64(),
    );
    for (at, fault) in faults.iter().take(3) {
        println!("    before tick {at}: {fault}");
    }
    for (which, name) in ["time", "way"].into_iter().enumerate() {
        let Some(worst) = report.worst(which) else { continue };
        let [half, most] = [0.5, 0.95].map(|part| report.quantile(which, part));
        println!(
            "    {name}: median {half:.2}, 95 % below {most:.2}, worst {:.2} at tick {} ({:.2} mm/s, {:.0} mm/s²): {:.3} s, \
             {:.3} mm; closed form {:.3} s, {:.3} mm",
            worst.ratios()[which],
            worst.tick,
            worst.motion[0],
            worst.motion[1],
            worst.seen.time,
            worst.seen.way,
            worst.wanted.time,
            worst.wanted.way,
        );
    }
    faults.len()
}

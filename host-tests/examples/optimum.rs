//! The optimal times of the paths with changing feeds, with progress, half a minute:
//! `cargo run --release -p host-tests --example optimum` prints them next to the accepted ones,
//! `… --example optimum -- accept` writes `host-tests/tables/optimum.csv`.
//! Two numbers instead of `accept` are the first path and the one after the last.
use host_tests::cases::feeds::{Accepted, Feeds, PATHS, accepted, table, write};
use host_tests::reference::optimum::anchors::{at_borders, in_valleys};
use host_tests::reference::optimum::optimum;
use host_tests::reference::profile::Profile;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let numbers: Vec<u64> = arguments.iter().filter_map(|a| a.parse().ok()).collect();
    let paths = if let &[first, end] = numbers.as_slice() { first..end } else { 0..PATHS };
    let before = accepted().unwrap_or_default();
    let mut rows = Vec::new();
    println!("path blocks ramp_s  optimum_s    gap  at borders  in valleys  steps pieces   runs_s  accepted");
    for number in paths {
        let path = Feeds::new(number);
        let start = std::time::Instant::now();
        let Some(found) = optimum(&path.blocks, &path.limits) else {
            println!("{number}: not found");
            std::process::exit(1);
        };
        let time = |profiles: Vec<Profile>| profiles.iter().map(Profile::time).sum::<f64>();
        let row = Accepted {
            number,
            blocks: path.blocks.len(),
            ramp: path.ramp,
            length: path.blocks.iter().map(|b| b.length).sum(),
            time: found.time,
            at_borders: time(at_borders(&path.blocks, &path.limits)),
            in_valleys: time(in_valleys(&path.blocks, &path.limits)),
        };
        let percent = |t: f64| 100.0 * (t / row.time - 1.0);
        let change = before.iter().find(|b| b.number == number).map_or(f64::NAN, |b| percent(b.time));
        println!(
            "{number:4} {:6} {:6} {:10.6} {:.0e} {:+9.2} % {:+9.2} % {:6} {:6} {:8.2} {change:+8.4} %",
            row.blocks,
            row.ramp,
            row.time,
            found.gap,
            percent(row.at_borders),
            percent(row.in_valleys),
            found.steps,
            found.pieces.len(),
            start.elapsed().as_secs_f64(),
        );
        rows.push(row);
    }
    for (name, time) in [
        ("zero acceleration at block ends", (|r: &Accepted| r.at_borders) as fn(&Accepted) -> f64),
        ("zero acceleration in valleys", |r| r.in_valleys),
    ] {
        let over = rows.iter().map(|r| 100.0 * (time(r) / r.time - 1.0));
        let (mean, worst) = (over.clone().sum::<f64>() / rows.len() as f64, over.fold(0.0, f64::max));
        println!("{name}: {mean:.2} % over the optimum on average, {worst:.2} % at worst");
    }
    if arguments.iter().any(|a| a == "accept")
        && let Err(fault) = std::fs::write(table(), write(&rows))
    {
        println!("{fault}");
        std::process::exit(1);
    }
}

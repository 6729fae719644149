//! A sphere of short lines with the tool normal to it, on machines of five axes:
//! `cargo run --release -p host-tests --example sphere -- [KEY=VALUE]…`
//!
//! Keys: machine (trunnion, table, mixed, head), radius, step, lines, from, to, digits, feed, slope, smooth, trace
//! (a file for the axes of each tick), own (a small feed: the bound of the path that this method drives).
use host_tests::sphere::{Job, bench, bound_of, keeps_limits, run, turns};
use std::process::ExitCode;

fn main() -> ExitCode {
    let mut job =
        Job { radius: 50.0, step: 0.3, lines: 20_000, tilt: [20.0, 80.0], digits: 5, feed: 12_000.0 };
    let (mut machine, mut slope, mut smooth) = (String::from("trunnion"), 3, String::from("surface"));
    let (mut trace, mut own, mut path_dev) = (None, 0.0, 0.01);
    for argument in std::env::args().skip(1) {
        let Some((key, value)) = argument.split_once('=') else {
            eprintln!("{argument}: expected KEY=VALUE");
            return ExitCode::FAILURE;
        };
        let number = value.parse::<f64>().unwrap_or(f64::NAN);
        match key {
            "machine" => machine = value.to_owned(),
            "radius" => job.radius = number,
            "step" => job.step = number,
            "lines" => job.lines = number as usize,
            "from" => job.tilt[0] = number,
            "to" => job.tilt[1] = number,
            "digits" => job.digits = number as usize,
            "feed" => job.feed = number,
            "own" => own = number,
            "dev" => path_dev = number,
            "slope" => slope = number as u8,
            "smooth" => smooth = value.to_owned(),
            "trace" => trace = Some(value.to_owned()),
            _ => {
                eprintln!(
                    "{key}: expected machine, radius, step, lines, from, to, digits, feed, slope, smooth"
                );
                return ExitCode::FAILURE;
            }
        }
    }
    let command = match smooth.as_str() {
        "surface" => &*format!("#HSC ON [SURFACE PATH_DEV={path_dev}]"),
        "bspline" => &*format!("#HSC ON [BSPLINE PATH_DEV={path_dev}]"),
        "dev" => &*format!("#CONTOUR MODE ON [DEV PATH_DEV={path_dev}]"),
        "none" => "",
        other => other,
    };
    let Some(bench) = bench(&machine, slope) else {
        eprintln!("{machine}: expected trunnion, table, mixed or head");
        return ExitCode::FAILURE;
    };
    let bound = job.bound(&bench);
    let rounded = job.rounded_bound(&bench, path_dev);
    if own > 0.0 {
        // The path of that method itself, driven slowly.
        let slow = Job { feed: own, ..job.clone() };
        match run(&bench, &slow, command) {
            Ok(shown) => println!("bound of its path {:.2} s", bound_of(&bench, (&shown.run, own), job.feed)),
            Err(error) => println!("{error}"),
        }
    }
    match run(&bench, &job, command) {
        Ok(shown) => {
            println!(
                "{machine} R{} {} x {} mm, {:.1} turns, slope {slope}, {smooth}: {:.2} s, bound {bound:.2} s, \
                 {rounded:.2} s with corners {:+.1} %, {} ticks of rest, slowest line {:.3} of its neighbours (line {}), {:.3} um off; limits {:?}",
                job.radius,
                job.lines,
                job.step,
                turns(&job),
                shown.time,
                100.0 * (shown.time / rounded - 1.0),
                shown.rest,
                shown.slowest.0,
                shown.slowest.1,
                shown.off * 1e3,
                keeps_limits(&bench, &shown.run),
            );
            if let Some(path) = trace {
                let mut text = String::new();
                for tick in 0..shown.run.trace.len() {
                    let row: Vec<String> =
                        shown.run.trace.mm(tick).iter().map(|x| format!("{x:.9}")).collect();
                    text += &row.join(",");
                    text.push('\n');
                }
                let _ = std::fs::write(path, text);
            }
            ExitCode::SUCCESS
        }
        Err(error) => {
            println!("{machine} {smooth}: {error}");
            ExitCode::FAILURE
        }
    }
}

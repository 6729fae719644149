//! The circle of 64 chords, and the table of program times.
use glidepath::machine::MachineData;
use host_tests::accept;
use host_tests::cases::{Program, machines, named};
use host_tests::properties::verify;
use host_tests::reference::limits::path_length;
use host_tests::reference::profile::rest_to_rest;
use std::fmt::Write;
use std::path::Path;

/// Feed of the examples: 20 m/min.
const FEED: f64 = 20_000.0;

fn programs() -> Vec<Program> {
    vec![
        named::one_line(80.0, FEED, 3),
        named::square(FEED, 3),
        named::slot(FEED, 3),
        named::circle(FEED, 3),
        named::chords(FEED, 3),
        named::helix(FEED),
        named::pocket(FEED),
        named::wave(400, 0.5, FEED),
    ]
}

/// One row: time, time of a straight line of the same length, peaks of the axes.
fn row(machine: &MachineData<3>, program: &Program) -> String {
    let verdict = verify::<3, 120>(program, machine).unwrap();
    let length: f64 = verdict.contour.elements.iter().map(path_length).sum();
    let x = machine.axes[0];
    let a = f64::from(x.a_beschl);
    let v = (f64::from(x.vb_max) * 1e-3).min(FEED / 60.0);
    let straight = rest_to_rest(length, v, a, f64::from(x.tr_beschl_zu) * 1e-6);
    let peak = |order: usize| verdict.peaks.iter().map(|p| p.values[order]).fold(0.0, f64::max);
    format!(
        "{},{},{length:.3},{:.3},{straight:.3},{:.1},{:.0},{:.0},{:.2}",
        program.name,
        verdict.run.blocks.len(),
        verdict.run.trace.time(),
        peak(0),
        peak(1),
        peak(2),
        verdict.course.error * 1e9,
    )
}

/// Compares with the accepted table, or accepts.
fn times(name: &str, machine: &MachineData<3>) {
    let mut table = String::from(
        "program,blocks,length_mm,time_s,straight_line_s,v_peak_mm_s,a_peak_mm_s2,jerk_peak_mm_s3,path_error_pm\n",
    );
    for program in programs() {
        let _ = writeln!(table, "{}", row(machine, &program));
    }
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tables").join(name);
    accept::compare_file(&path, &table, accept::reason().as_deref())
        .unwrap_or_else(|fault| panic!("{fault}"));
}

#[test]
fn times_are_those_of_the_accepted_tables() {
    times("times.csv", &machines::even(1000));
    times("times_examples.csv", &machines::examples(1000));
}

#[test]
fn a_circle_of_chords_breaks_no_limit_at_any_feed() {
    for feed in [600.0, 6000.0, FEED, 60_000.0] {
        for machine in [machines::even::<3>(1000), machines::uneven(1000), machines::mill(1000)] {
            verify::<3, 120>(&named::chords(feed, 3), &machine).unwrap();
        }
    }
}

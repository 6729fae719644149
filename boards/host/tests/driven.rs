//! Path speed and distance of a run are those of the set points, inside curves over time too.
mod common;
use common::*;
use serde_json::json;
use std::fs;

/// Chords of the set points, mm, one per pair of ticks: along the feed axes, where they rest along all others.
fn chords(trace: &Trace, feed: usize) -> Vec<f64> {
    let step = |pair: &[Row]| {
        let travel: Vec<f64> =
            pair[1].axes.iter().zip(&pair[0].axes).map(|(to, from)| (to - from) as f64 * LSB).collect();
        let length = |travel: &[f64]| travel.iter().map(|travel| travel * travel).sum::<f64>().sqrt();
        let along = length(&travel[..feed]);
        if along > 0.0 { along } else { length(&travel) }
    };
    trace.rows.windows(2).map(step).collect()
}

/// What is shown is what is driven, to a thousandth: the sum of the steps; every step, and the mean speed of the
/// ticks around it, as shares of the largest step.
///
/// The mean is the chord but for a twelfth of the second difference of the speed, and an arc is longer than its
/// chord by a 24th of the square of its angle: both are far below a thousandth at 1 ms.
fn agrees(run: &Run, feed: usize) {
    let (rows, chords) = (&run.trace.rows, chords(&run.trace, feed));
    let fastest = chords.iter().copied().fold(0.0, f64::max);
    let (sum, shown) = (chords.iter().sum::<f64>(), rows[rows.len() - 1].s_mm);
    assert!((shown - sum).abs() < 1e-3 * sum, "{shown} mm shown, {sum} mm driven");
    assert!((number(&run.summary["path_mm"]) - shown).abs() < 1e-6, "{}", run.summary["path_mm"]);
    for (tick, (pair, chord)) in rows.windows(2).zip(&chords).enumerate() {
        let step = pair[1].s_mm - pair[0].s_mm;
        let mean = (pair[0].v_mm_s + pair[1].v_mm_s) / 2.0 * 1e-3;
        // With STEP a corner has a step of speed, at some time between two ticks.
        if run.summary["program"].as_str().is_some_and(|name| name.ends_with("step.nc"))
            && pair[0].block != pair[1].block
        {
            continue;
        }
        // A step of acceleration between the two ticks takes the mean an eighth of it off.
        let bent = (pair[1].a_mm_s2 - pair[0].a_mm_s2).abs() * 1e-6 / 8.0;
        let off = (step - chord).abs().max((mean - chord).abs() - bent);
        assert!(off < 1e-3 * fastest, "tick {tick}: {step} mm, {mean} mm by speed, {chord} mm driven");
    }
    let highest = rows.iter().map(|row| row.v_mm_s).fold(0.0, f64::max);
    let told = number(&run.summary["v_path_max"]);
    assert!((told - highest).abs() < 0.01 * highest, "{told} mm/s told, {highest} mm/s shown");
}

#[test]
fn speeds_and_distances_shown_are_driven() {
    let entries = fs::read_dir(shipped("../../programs")).expect("the shipped programs");
    let mut programs: Vec<String> =
        entries.filter_map(|entry| entry.ok()?.file_name().into_string().ok()).collect();
    programs.retain(|name| name.ends_with(".nc"));
    programs.sort();
    for program in programs {
        let (machine, feed) = match program.as_str() {
            // The path is that of the tip: `host-tests/tests/five`.
            "tip.nc" => continue,
            // No shipped machine has their axes.
            "six.nc" | "six_corners.nc" | "six_surface.nc" => continue,
            "handling.nc" => (Some("machines/handling.toml"), 1),
            "rotary.nc" | "rotary_corners.nc" => (Some("machines/five-axis.toml"), 3),
            _ => (None, 3),
        };
        println!("{program}");
        let path = shipped(&format!("../../programs/{program}"));
        agrees(&run(&format!("driven-{program}"), &path, machine.map(shipped).as_deref()), feed);
    }
}

#[test]
fn a_curve_over_time_counts_what_is_driven() {
    let text =
        "%u\nN10 #CONTOUR MODE [DEV PATH_DEV=0.1]\nN20 G261 G01 X50 F6000\nN30 Y50\nN40 X0\nN50 G260\nM30\n";
    let run = run("driven-u", &written("driven-u", text), None);
    agrees(&run, 3);
    let path = number(&run.summary["path_mm"]);
    assert!((path - 149.78).abs() < 0.01, "{path} mm");
    // Nothing stands still but both ends, and no corner is slower than the trace around it.
    assert_eq!(run.summary["stops"], json!(0));
    let mut blocks = run.trace.rows.windows(2).filter(|pair| pair[0].block != pair[1].block);
    let slowest = blocks.by_ref().map(|pair| pair[0].v_mm_s.min(pair[1].v_mm_s)).fold(f64::MAX, f64::min);
    let told = number(&run.summary["slowest_corners"][0]["v"]);
    assert!((told - slowest).abs() < 2.0, "{told} mm/s told, {slowest} mm/s in the trace");
}

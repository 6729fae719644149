//! The summary names the limits that bound the speed, and the changes that make the program faster.
mod common;

use common::{number, run, run_with, shipped};
use serde_json::{Value, json};
use std::fmt::Write;
use std::fs;
use std::path::Path;

fn written(name: &str, text: &str) -> String {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("why-{name}"));
    fs::write(&path, text).expect("a file for the test");
    path.to_str().expect("plain characters").to_owned()
}

/// The built-in machine with some of its lines in other words.
fn machine(name: &str, changes: &[(&str, &str)]) -> String {
    let mut text = fs::read_to_string(shipped("machines/default.toml")).expect("it is shipped");
    for (from, to) in changes {
        assert!(text.contains(from), "{from}");
        text = text.replace(from, to);
    }
    written(&format!("{name}.toml"), &text)
}

/// Joints and blocks that were bound by something whose name begins like that.
fn bound(summary: &Value, by: &str) -> [u64; 2] {
    let reasons = summary["why"]["bound"].as_array().expect("a list");
    let of = |field: &str| {
        let like = |reason: &&Value| reason["by"].as_str().is_some_and(|name| name.starts_with(by));
        reasons.iter().filter(like).filter_map(|reason| reason[field].as_u64()).sum()
    };
    [of("joints"), of("blocks")]
}

fn helps(summary: &Value, by: &str) -> Option<f64> {
    let helps = summary["why"]["helps"].as_array().expect("a list");
    let like = |help: &&Value| help["limit"].as_str().is_some_and(|name| name.starts_with(by));
    helps.iter().find(like).map(|help| number(&help["program_time_s"]))
}

/// A circle of chords: a knee of 5.6° every 7.85 mm.
fn chords() -> String {
    shipped("../../programs/chords.nc")
}

#[test]
fn chords_are_bound_by_the_time_of_ramps_and_say_what_helps() {
    let seen = run("why-chords", &chords(), None);
    let found = ["corner without a curve", "ramp time (P-AXIS-00195"].map(|by| bound(&seen.summary, by));
    assert_eq!(found, [[66, 0], [0, 67]], "{}", seen.summary["why"]);
    // The slowest one is the reversal before the circle.
    let corner = &seen.summary["slowest_corners"][1];
    assert!(corner["bound"].as_str().is_some_and(|by| by.starts_with("corner without")), "{corner}");
    assert!((number(&corner["knee"]) - 5.625).abs() < 1e-3, "{corner}");
    for expected in ["what bound the speed", "66 corners have no curve: #CONTOUR MODE", "20 % shorter"] {
        assert!(seen.stdout.contains(expected), "{}", seen.stdout);
    }
    // What is told of shorter ramps comes true.
    let shorter = machine("ramps", &[("= 150_000", "= 120_000")]);
    let told = helps(&seen.summary, "ramp time (P-AXIS-00195").expect("it helps");
    let then = number(&run("why-ramps", &chords(), Some(&shorter)).summary["program_time_s"]);
    assert!(
        (told - then).abs() < 1e-9 && then < 0.95 * number(&seen.summary["program_time_s"]),
        "{told} {then}"
    );
    // With curves in the corners, other limits: of the axis that bends.
    let text = fs::read_to_string(chords()).expect("it is shipped");
    let text = text.replace("N20 ", "N15 #CONTOUR MODE [DEV PATH_DEV=0.02]\nN16 G261\nN20 ");
    let curved = run("why-curved", &written("curved.nc", &text), None);
    let all = bound(&curved.summary, "geometric ramp time (P-AXIS-00199) of ");
    assert_eq!(all, bound(&curved.summary, "geometric ramp time"), "each has its axis");
    assert!(all[0] >= 60, "{}", curved.summary["why"]);
    assert!(curved.stdout.contains("corners have a curve: a larger tolerance"), "{}", curved.stdout);
}

#[test]
fn what_binds_is_found_one_by_one() {
    let of = |name: &str, text: &str, machine: Option<&str>, by: &str| {
        let seen = run_with(&format!("why-{name}"), &written(&format!("{name}.nc"), text), machine, &[]);
        let found = bound(&seen.summary, by);
        assert!(found != [0, 0], "{name}: {by}: {}", seen.summary["why"]);
        found
    };
    assert_eq!(of("feed", "N10 G01 X50 F600\nN20 G03 Y100 J50\nM30\n", None, "feed F"), [1, 2]);
    assert_eq!(of("rapid", "N10 G00 X1500\nM30\n", None, "axis speed (P-AXIS-00212"), [0, 1]);
    let slow = machine("slow", &[("= 1_000_000", "= 50_000")]);
    assert_eq!(of("slow", "N10 G01 X100 F60000\nM30\n", Some(&slow), "axis speed"), [0, 1]);
    assert_eq!(of("accel", "N10 G01 X500 F60000\nM30\n", None, "acceleration (P-AXIS-00001"), [0, 1]);
    assert_eq!(of("stop", "N10 G01 G60 X50 F6000\nN20 X90\nM30\n", None, "exact stop"), [1, 0]);
    assert_eq!(of("dwell", "N10 G01 X50 F6000\nN20 G04 X0.1\nN30 X90\nM30\n", None, "exact stop"), [1, 0]);
    assert_eq!(of("reversal", "N10 G01 X50 F6000\nN20 X0\nM30\n", None, "corner without a curve"), [1, 0]);
}

/// Lines of 2 mm that nearly go straight on: at 200 mm/s a standstill takes more than ten of them.
#[test]
fn a_look_ahead_that_is_too_short_is_told() {
    let mut text = String::from("G01 F12000\n");
    for i in 1..=60 {
        let angle = f64::from(i) * 2e-5;
        let _ = writeln!(text, "N{} G91 X{:.6} Y{:.6}", 10 * i, 2.0 * angle.cos(), 2.0 * angle.sin());
    }
    text.push_str("M30\n");
    let program = written("ahead.nc", &text);
    let free = [("corr_v_trans_jerk = 1", "corr_v_trans_jerk = 0"), ("tr_geom = 10_000", "tr_geom = 1_000")];
    let machine = machine("ahead", &free);
    let short = run_with("why-short", &program, Some(&machine), &["--look-ahead", "10"]);
    let [joints, _] = bound(&short.summary, "look-ahead (P-STUP-00071)");
    assert!(joints > 10, "{}", short.summary["why"]);
    let then = run_with("why-long", &program, Some(&machine), &["--look-ahead", "20"]);
    let told = helps(&short.summary, "look-ahead").expect("it helps");
    assert!((told - number(&then.summary["program_time_s"])).abs() < 1e-9);
}

#[test]
fn what_comes_from_outside_is_told_apart() {
    let program = written("outside.nc", "N10 G01 X100 F6000\nN20 M25\nN30 X200\nM30\n");
    let events = written("outside.events", "0.2 override 50\n");
    let machine = machine("m25", &[("[channel]", "[channel]\nm_synch.25 = \"MVS_SVS\"")]);
    let slowed = run_with("why-slowed", &program, Some(&machine), &["--events", &events]);
    assert_eq!(bound(&slowed.summary, "operator"), [0, 1], "{}", slowed.summary["why"]);
    let late = run_with("why-late", &program, Some(&machine), &["--ack", "0.3"]);
    assert_eq!(bound(&late.summary, "function that is waited for"), [1, 0], "{}", late.summary["why"]);
    // What helps is said of the program by itself.
    let alone = run_with("why-alone", &program, Some(&machine), &[]);
    for seen in [&slowed, &late] {
        assert_eq!(seen.summary["why"]["program_time_s"], alone.summary["program_time_s"]);
    }
}

#[test]
fn it_is_not_asked_where_it_is_not_wanted() {
    let seen = run_with("why-never", &chords(), None, &["--why", "never"]);
    assert_eq!(
        (&seen.summary["why"], &seen.summary["slowest_corners"][0]["bound"]),
        (&json!(null), &json!(null))
    );
    assert!(!seen.stdout.contains("what bound the speed"), "{}", seen.stdout);
}

/// With DEV, lines over many chords would be faster: that is said with what it would gain.
#[test]
fn one_line_of_many_chords_is_offered() {
    let mut text = String::from("#CONTOUR MODE [DEV PATH_DEV=0.1]\nG261 G01 F6000\n");
    for k in 1..=400 {
        let angle = f64::from(k) * std::f64::consts::TAU / 400.0;
        let _ = writeln!(text, "N{k} X{:.6} Y{:.6}", 20.0 * angle.sin(), 20.0 - 20.0 * angle.cos());
    }
    let program = written("chords.nc", &(text + "M30\n"));
    let name = "one line of nearly straight chords (merge_chords)";
    let merged = machine("chords", &[("[channel]", "[channel]\nmerge_chords = 50")]);
    let [apart, one] = [("apart", None), ("one", Some(merged.as_str()))]
        .map(|(name, machine)| run(&format!("chords-{name}"), &program, machine).summary);
    let gained = number(&one["program_time_s"]);
    assert!(gained < 0.8 * number(&apart["program_time_s"]), "{gained} of {}", apart["program_time_s"]);
    assert_eq!((helps(&apart, name), helps(&one, name)), (Some(gained), None));
}

/// Arcs and lines in turn, with knees of 18° between them.
fn waves(on: &str) -> String {
    let mut text = format!("G90 G17 G01 X0 Y0 Z0 F10000\n{on}\n");
    for k in 0..12 {
        let x = f64::from(k);
        let arc = if k % 2 == 0 { "G02" } else { "G03" };
        let _ = writeln!(text, "G01 X{:.1} Y0\n{arc} X{:.1} Y0 R0.8", x + 0.5, x + 1.0);
    }
    text + "G01 X14 Y0\nM30\n"
}

#[test]
fn a_corner_that_smoothing_leaves_is_not_said_to_have_a_curve() {
    let corners = "corner without a curve";
    let kept =
        run("why-kept", &written("kept.nc", &waves("#HSC ON [SURFACE PATH_DEV=0.05 CIR_MODE=0]")), None);
    assert!(bound(&kept.summary, corners)[0] >= 20, "{}", kept.stdout);
    assert!(kept.stdout.contains("have no curve where smoothing is on"), "{}", kept.stdout);
    assert!(!kept.stdout.contains("have a curve"), "{}", kept.stdout);
    let text = waves("#CONTOUR MODE ON [DEV PATH_DEV=0.05]");
    let rounded = run("why-rounded", &written("rounded.nc", &text), None);
    assert_eq!(bound(&rounded.summary, corners)[0], 0, "{}", rounded.stdout);
    assert!(!rounded.stdout.contains("no curve"), "{}", rounded.stdout);
}

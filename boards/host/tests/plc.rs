//! `--plc` from outside: answers, the picture, and files that are refused.
use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

fn glidepath(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_glidepath")).args(arguments).output().expect("the simulator starts")
}

fn shipped(path: &str) -> String {
    format!("{}/../../{path}", env!("CARGO_MANIFEST_DIR"))
}

fn written(name: &str, text: &str) -> String {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    fs::write(&path, text).expect("a file for the test");
    path.to_str().expect("a path of plain characters").to_owned()
}

fn answers(program: &str, plc: &str, more: &[&str]) -> Vec<Value> {
    let arguments = [&["run", program, "--plc", plc, "--answers", "-"], more].concat();
    let output = glidepath(&arguments);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).expect("text");
    text.lines().map(|line| serde_json::from_str(line).expect(line)).collect()
}

/// The worked example: the power changes 2 mm before and behind the knees, and on the narrow arc; elements by hand.
#[test]
fn a_laser_follows_knees_and_radii() {
    let picture = Path::new(env!("CARGO_TARGET_TMPDIR")).join("reach.svg");
    let picture = picture.to_str().expect("plain characters");
    let answers =
        answers(&shipped("programs/laser.nc"), &shipped("programs/laser.plc"), &["--reach", picture]);
    let laser: Vec<(f64, u64)> = answers
        .iter()
        .filter_map(|line| Some((line["distance_mm"].as_f64()?, line["laser_percent"].as_u64()?)))
        .collect();
    let wanted = [(0.0, 100), (18.0, 40), (22.0, 100), (33.0, 40), (37.0, 100), (77.854, 40), (80.996, 100)];
    assert_eq!(laser.len(), wanted.len(), "{laser:?}");
    for ((at, percent), (wanted, of)) in laser.iter().zip(wanted) {
        assert!((at - wanted).abs() < 0.06 && *percent == of, "{laser:?}");
    }
    let asked = |word: &str| answers.iter().find(|line| line["ask"] == word).expect("asked");
    let elements = asked("elements")["elements"].as_array().expect("a list");
    let kinds: Vec<_> = elements.iter().map(|e| e["block_type"].as_u64().expect("a number")).collect();
    assert_eq!(kinds, [1, 1, 1, 2, 1, 2, 1]);
    let arc = &elements[5];
    assert_eq!((arc["block_number"].as_u64(), arc["programmed_radius_mm"].as_f64()), (Some(60), Some(2.0)));
    let angle = arc["circle_angle_rad"].as_f64().expect("an angle");
    assert!((angle + std::f64::consts::FRAC_PI_2).abs() < 1e-8, "{arc}");
    let knee = elements[1]["tangent_variation_rad"].as_f64().expect("a knee");
    assert!((knee - std::f64::consts::FRAC_PI_2).abs() < 1e-8, "{elements:?}");
    assert!(asked("reach")["reach_mm"].as_f64().is_some_and(|reach| (reach - 98.996).abs() < 1e-3));
    for word in ["state", "feed", "standstill"] {
        assert!(asked(word)["set_points"].is_array(), "{}", asked(word));
    }
    assert_eq!(asked("feed")["n"], 20);
    let svg = fs::read_to_string(picture).expect("the picture");
    assert!(svg.starts_with("<svg") && svg.contains("power of the laser") && svg.ends_with("</svg>\n"));
    if std::env::var("ACCEPT_PICTURES").is_ok() {
        fs::write(shipped("docs/reach.svg"), svg).expect("the picture of the document");
    } else {
        let kept = fs::read_to_string(shipped("docs/reach.svg")).expect("the picture of the document");
        assert!(svg == kept, "docs/reach.svg is another picture; ACCEPT_PICTURES=1 writes it anew");
    }
}

/// A hold where the answer said it stands: events and requests together.
#[test]
fn a_hold_stands_where_it_was_told() {
    let program = shipped("programs/laser.nc");
    let plc = written("stand.plc", "0.2 standstill\n0.9 reach\n");
    let events = written("stand.events", "0.2 feedhold\n1 resume\n");
    let answers = answers(&program, &plc, &["--events", &events]);
    // The hold is given before the planner works in that tick: it stands already where it will.
    let told = &answers[0]["set_points"];
    let stood = answers[1]["distance_mm"].as_f64().expect("a distance");
    assert!((told[0].as_f64().expect("X") - stood).abs() < 1e-6, "{answers:?}");
}

/// Without functions in the machine data the answers say what is expected; the entries of a log by index.
#[test]
fn machine_data_enable_the_answers() {
    let program = written(
        "log.nc",
        "G01 F3000\nN10 X5\n#CONTOUR LOOKAHEAD LOG ON [PARAM=7]\nN20 Y5\n#CONTOUR LOOKAHEAD LOG OFF\nN30 X9\n",
    );
    let plc = written("log.plc", "0.05 log 0\n0.05 state 0.01\n0.05 elements 0 0.5 ; nothing else\n");
    let with = answers(&program, &plc, &[]);
    assert_eq!(with[0]["elements"].as_array().map(Vec::len), Some(3), "{with:?}");
    assert_eq!(with[0]["elements"][0]["parameter"], 7.0);
    let plain = written("plain.nc", "G01 F3000\nN10 X5\nN20 Y5\n");
    let machine = shipped("boards/host/machines/default.toml");
    let without = answers(&plain, &plc, &["--machine", &machine]);
    assert!(without[1]["unknown"].as_str().is_some_and(|text| text.contains("FCT_CALC_STATE_AT_T")));
    assert_eq!(without[2]["elements"].as_array().map(Vec::len), Some(0));
}

/// Each mistake of a file of requests is told with its place and what was expected.
#[test]
fn requests_are_refused_with_line_column_word_and_what_was_expected() {
    let program = shipped("programs/laser.nc");
    for (text, place, word) in [
        ("0 reeach\n", ":1:3", "is reach meant?"),
        ("0\n", ":1:2", "expected reach"),
        ("x reach\n", ":1:1", "a time in seconds"),
        ("0 reach 1\n", ":1:9", "end of the line"),
        ("1 reach\n0.5 reach\n", ":2:1", "times ascend"),
        ("0 elements 1\n", ":1:13", "millimetres"),
        ("0 elements 1 -2\n", ":1:14", "millimetres"),
        ("0 log 1.5\n", ":1:7", "an index"),
        ("0 state\n", ":1:8", "seconds"),
        ("0 laser 1 181 1 1\n", ":1:11", "180 degrees"),
        ("0 laser 1 1 1 101\n", ":1:15", "percent"),
    ] {
        let plc = written("wrong.plc", text);
        let output = glidepath(&["run", &program, "--plc", &plc, "--answers", "-"]);
        let told = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(1), "{text}: {told}");
        assert!(told.contains(place) && told.contains(word), "{text}: {told}");
    }
    assert_eq!(glidepath(&["run", &program, "--plc", &program]).status.code(), Some(2));
    assert_eq!(glidepath(&["run", &program, "--answers", "-"]).status.code(), Some(2));
}

//! Trace, summary and picture with a reduced content.
mod common;

use common::{number, run_with, shipped, written};
use std::fs;
use std::io::Read;
use std::path::Path;
use std::process::{Command, Output};

fn glidepath(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_glidepath")).args(arguments).output().expect("the simulator starts")
}

fn path(name: &str) -> String {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("extract-{name}"));
    path.to_str().expect("plain characters").to_owned()
}

/// Every 70th row and the last one, two columns, compressed: the cells are those of the whole trace.
#[test]
fn a_trace_of_some_rows_and_columns_is_part_of_the_whole() {
    let program = written("extract", "N10 G01 X10 F600\nN20 Y7 F900\nM30\n");
    let [whole, part] = ["whole.csv", "part.csv.gz"].map(path);
    assert!(glidepath(&["run", &program, "--trace", &whole, "--why", "never"]).status.success());
    let options = ["--trace-every", "70", "--columns", "y,Tick"];
    let part_run = [&["run", &program, "--trace", &part, "--why", "never"][..], &options].concat();
    assert!(glidepath(&part_run).status.success());
    let whole = fs::read_to_string(whole).expect("it was asked for");
    let mut text = String::new();
    let file = fs::File::open(part).expect("it was asked for");
    flate2::read::GzDecoder::new(file).read_to_string(&mut text).expect("gzip");
    let rows: Vec<&str> = whole.lines().skip(1).collect();
    let last = rows.len() - 1;
    let expected =
        rows.iter().enumerate().filter(|(tick, _)| tick % 70 == 0 || *tick == last).map(|(_, row)| {
            let cells: Vec<&str> = row.split(',').collect();
            format!("{},{}", cells[8], cells[0])
        });
    let expected: Vec<String> = std::iter::once("Y,tick".to_owned()).chain(expected).collect();
    assert!(!last.is_multiple_of(70), "the last row is one of its own");
    assert_eq!(text.lines().collect::<Vec<_>>(), expected);
}

#[test]
fn what_is_not_there_is_refused_with_what_is() {
    let program = shipped("tests/programs/shapes.nc");
    let csv = path("refused.csv");
    let told = |options: &[&str]| {
        let output = glidepath(&[&["run", &program, "--why", "never"][..], options].concat());
        assert!(!output.status.success(), "{options:?}");
        String::from_utf8_lossy(&output.stderr).into_owned()
    };
    let column = told(&["--trace", &csv, "--columns", "t_s,Q"]);
    assert!(column.contains("no column `Q`") && column.contains("expected tick, t_s, n"), "{column}");
    assert!(!Path::new(&csv).exists(), "all outputs or none");
    assert!(told(&["--columns", "X"]).contains("--trace"));
    assert!(told(&["--trace", &csv, "--trace-every", "0"]).contains("1.."));
    assert!(told(&["--plot", &path("a.svg"), "--planes", "uv"]).contains("xy, xz, yz, space"));
}

#[test]
fn a_picture_has_the_planes_that_are_asked_for() {
    let program = written("extract-planes", "N10 G01 X10 Y5 Z2 F600\nN20 G00 X0\nM30\n");
    let drawn = |name: &str, options: &[&str]| {
        let file = path(name);
        let run = [&["run", &program, "--plot", &file, "--why", "never"][..], options].concat();
        assert!(glidepath(&run).status.success());
        fs::read_to_string(file).expect("it was asked for")
    };
    let count = |svg: &str, text: &str| svg.matches(&format!(">{text}<")).count();
    let asked = drawn("asked.svg", &["--planes", "YZ,xz"]);
    assert_eq!([count(&asked, "Y Z  mm"), count(&asked, "X Z  mm"), count(&asked, "X Y  mm")], [1, 1, 0]);
    assert_eq!(count(&asked, "Path in space"), 0);
    let plain = drawn("plain.svg", &[]);
    assert_eq!([count(&plain, "X Y  mm"), count(&plain, "Path in space")], [1, 1]);
}

/// Tools by M6, spindle and feed: 30 mm at 600 mm/min take three seconds and their ramps.
#[test]
fn the_summary_has_tools_spindle_and_feeds() {
    let text = "T1 M6\nM3 S1000\nG00 X10\nG01 X40 F600\nM5\nT2 M6\nG01 Y20 F1200\nM30\n";
    let run = run_with("extract-usage", &written("extract-usage", text), None, &["--why", "never"]);
    let all = number(&run.summary["program_time_s"]);
    let tools = run.summary["tools"].as_array().expect("a list");
    let times: Vec<f64> = tools.iter().map(|tool| number(&tool["time_s"])).collect();
    assert_eq!([&tools[0]["tool"], &tools[1]["tool"]], [1, 2]);
    assert!((times.iter().sum::<f64>() - all).abs() < 1e-9, "{times:?} {all}");
    let spindle = number(&run.summary["spindle_on_s"]);
    assert!(spindle > 3.0 && spindle < all && (spindle - times[0]).abs() < 0.01, "{spindle} {times:?}");
    let bars = run.summary["feed_histogram"].as_array().expect("a list");
    assert_eq!(bars.len(), 10);
    // Steady motion at 600 and at 1200 mm/min: the fifth bar and the last one.
    let [half, full] = [4, 9].map(|bar| number(&bars[bar]["time_s"]));
    let others: f64 = bars.iter().map(|bar| number(&bar["time_s"])).sum::<f64>() - half - full;
    assert!(half > 2.5 && full > 0.7 && others < half, "{half} {full} {others}");
    assert!(run.stdout.contains("  tools          T1 ") && run.stdout.contains("mm/min"), "{}", run.stdout);
    assert!(run.stdout.contains("600 … 720") || run.stdout.contains("480 … 600"), "{}", run.stdout);
}

#[test]
fn completions_and_manual_pages_are_written() {
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let output = glidepath(&["completions", shell]);
        let text = String::from_utf8_lossy(&output.stdout);
        assert!(output.status.success() && text.contains("trace-every"), "{shell}");
    }
    let folder = path("man");
    let _ = fs::remove_dir_all(&folder);
    assert!(!glidepath(&["man", &folder]).status.success(), "no folder of that name");
    fs::create_dir(&folder).expect("a folder");
    assert!(glidepath(&["man", &folder]).status.success());
    let page = fs::read_to_string(Path::new(&folder).join("glidepath-run.1")).expect("a page");
    assert!(page.contains(".TH") && page.contains("trace\\-every"), "{}", &page[..200]);
}

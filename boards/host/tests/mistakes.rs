//! All mistakes of a program in one run, in the order of its text.
mod common;

use std::io::Write;
use std::process::{Command, Output, Stdio};

const BAD: &str = "%bad
This is a note to the operator
N10 G01 X10 F600
N20 G02 X20 Y0 I1 J5
N25 G03 X30 Y0 I5 J0
N50 G02 X60 Y0 I1 J7
N60 X[1+] Y2
N65 G02 X70 Y0 I1 J7
N70 G95 F1
M30
";

fn glidepath(arguments: &[&str], input: &str) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_glidepath"));
    command.args(arguments).stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().expect("it starts");
    // A program that is not read to its end is no failure here.
    let _ = child.stdin.take().map(|mut stdin| stdin.write_all(input.as_bytes()));
    child.wait_with_output().expect("it ends")
}

/// The lines that are named, in their order.
fn lines(output: &Output) -> Vec<usize> {
    let text = String::from_utf8_lossy(&output.stderr);
    let places = text.lines().filter(|line| line.trim_start().starts_with("--> "));
    places.filter_map(|place| place.rsplit(':').nth(1).and_then(|line| line.parse().ok())).collect()
}

#[test]
fn all_mistakes_are_told_in_the_order_of_the_text() {
    for command in ["check", "run"] {
        let output = glidepath(&[command, "-"], BAD);
        assert_eq!(output.status.code(), Some(1));
        // Two wrong arcs with a right one between them; behind N60 nobody knows where an arc begins.
        assert_eq!(lines(&output), [2, 4, 6, 7, 9], "{}", String::from_utf8_lossy(&output.stderr));
        let text = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(text.contains("this line is text, not NC"), "{text}");
        assert!(text.contains("note: 1 later refusal of arcs or software limits left out"), "{text}");
    }
}

#[test]
fn mistakes_are_limited() {
    let output = glidepath(&["check", "-", "--mistakes", "2"], BAD);
    assert_eq!(lines(&output), [2, 4]);
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(text.contains("note: the first 2 mistakes are shown; --mistakes N shows more"), "{text}");
    // A refused line of an endless loop is told once.
    let output = glidepath(&["check", "-"], "$WHILE 1\nN10 G01 X1 Q5\n$ENDWHILE\nM30\n");
    assert_eq!(lines(&output), [2]);
}

/// A refusal in one file does not keep the others from their turn.
#[test]
fn several_files_are_checked_one_after_another() {
    let good = common::shipped("tests/programs/shapes.nc");
    let output = glidepath(&["check", "-", &good, "no such file"], BAD);
    assert_eq!(output.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&output.stdout).contains("8 motion blocks"));
    assert!(String::from_utf8_lossy(&output.stderr).contains("cannot read no such file"));
    assert_eq!(glidepath(&["check", &good, &good], "").status.code(), Some(0));
    let output = glidepath(&["run", &good, &good, "--trace", "t.csv"], "");
    assert!(String::from_utf8_lossy(&output.stderr).contains("several programs do not go into one output"));
}

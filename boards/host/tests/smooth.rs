//! `--smooth` smooths a program without smoothing if this makes the program faster.
mod common;

use std::process::Command;

/// What a run says on both outputs.
fn run(program: &str, options: &[&str]) -> String {
    let mut command = Command::new(env!("CARGO_BIN_EXE_glidepath"));
    let output = command.args(["run", program]).args(options).output().expect("it starts");
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8_lossy(&output.stderr).into_owned() + &String::from_utf8_lossy(&output.stdout)
}

fn seconds(text: &str) -> f64 {
    let (_, behind) = text.split_once("program time").expect("a summary");
    behind.split_whitespace().next().and_then(|word| word.parse().ok()).expect("a time")
}

#[test]
fn corners_are_rounded_inside_the_tolerance() {
    let lines: String = (0..20).map(|k| format!("N{k} G01 X{} Y{k} F6000\n", k % 2 * 20)).collect();
    let program = common::written("smooth-corners", &format!("%corners\n{lines}M30\n"));
    let (plain, smooth) = (run(&program, &[]), run(&program, &["--smooth", "0.01"]));
    assert!(seconds(&smooth) < seconds(&plain), "{smooth}");
    assert!(smooth.contains("note: --smooth 0.01: #"), "{smooth}");
    assert!(smooth.contains("of 0.01 mm permitted"), "{smooth}");
    // The advice has told that time.
    let told = format!("--smooth 0.01 rounds them: {:.3} s", seconds(&smooth));
    assert!(plain.contains(&told), "{told}: {plain}");
}

#[test]
fn no_program_gets_slower() {
    let line = common::written("smooth-line", "%line\nG01 X10 F600\nM30\n");
    assert!(run(&line, &["--smooth", "0.05"]).contains("makes this program no faster: it runs as it is"));
    let own =
        common::written("smooth-own", "%own\n#CONTOUR MODE ON [DEV PATH_DEV=0.1]\nG01 X10 F600\nY10\nM30\n");
    assert!(run(&own, &["--smooth", "0.05"]).contains("has smoothing of its own"));
    let rows: String = (0..40).map(|k| format!("G1 X{} S{}\n", f64::from(k) * 0.1, k * 37 % 255)).collect();
    let raster = common::written(
        "smooth-raster",
        &format!("G21 G90\nM4 S0\nG1 F6000\n{rows}G1 Y0.1 S0\nG1 X0\nM5\nM2\n"),
    );
    assert!(seconds(&run(&raster, &["--smooth", "0.05"])) <= seconds(&run(&raster, &[])));
}

//! `check` reports the same as `run`, without planning.
mod common;

use common::{shipped, written};
use std::process::{Command, Output};
use std::time::{Duration, Instant};

fn glidepath(arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_glidepath"));
    command.args(arguments).output().expect("the simulator starts")
}

/// Standard output and error output, and whether it ended well.
fn told(output: &Output) -> (bool, String, String) {
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (output.status.success(), text(&output.stdout), text(&output.stderr))
}

/// X and Y have software limits of ±20 mm, and X a filter.
fn limited() -> String {
    let path = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("check-limited.toml");
    let limits = "kenngr.swe_neg = -200_000\nkenngr.swe_pos = 200_000\n";
    let filter = "filter_fir.type = 1\nfilter_fir.order = 20\n";
    let text = format!("[axis.X]\n{limits}{filter}[axis.Y]\n{limits}[axis.Z]\n");
    std::fs::write(&path, text).expect("a machine for the test");
    path.to_str().expect("plain characters").to_owned()
}

/// The error output of `run` on a refused program is that of `check`.
fn same_refusal(name: &str, text: &str, expected: &str) {
    let (program, machine) = (written(&format!("check-{name}"), text), limited());
    let [run, check] =
        ["run", "check"].map(|command| told(&glidepath(&[command, &program, "--machine", &machine])));
    assert!(!run.0 && !check.0, "{name}: {run:?} {check:?}");
    assert!(run.2.contains(expected), "{name}: {}", run.2);
    assert_eq!(run.2, check.2, "{name}");
}

/// Refusals of the planner: geometry, feed, limits of travel, also those of curves, and functions that it does not have.
#[test]
fn what_the_planner_refuses_is_refused_without_a_plan() {
    let long = "F0.00000001 X5";
    for (k, (line, expected)) in [
        ("G02 X10 Y0 I1 J5", "from the centre"),
        ("G03 X12 Y0 R2", "radius"),
        ("X25", "software limit"),
        ("G02 X1 Y0 I0 J-11", "software limit"),
        ("G04 S5", "G04 S"),
        (long, "raise F or split"),
        ("#PUT AX[X]\nN21 X5", "released"),
        ("D1", "D "),
        ("G93 F2 X5", "G93"),
    ]
    .into_iter()
    .enumerate()
    {
        same_refusal(&format!("line-{k}"), &format!("N10 G01 X1 F600\nN20 {line}\nN30 X2\nM30\n"), expected);
    }
    same_refusal("no-feed", "N10 G00 X1\nN20 G01 X5\nM30\n", "motion without feed");
    let akima = "N10 G01 F3000\n#SPLINE TYPE AKIMA\n#SPLINE ON\nN20 X10 Y19.9\nN30 X10.2 Y19.99\n\
        N40 X15 Y19.99\nN50 X20 Y-10\n#SPLINE OFF\nM30\n";
    same_refusal("akima", akima, "software limit");
}

/// All mistakes of a text: those behind a motion that is refused, too.
#[test]
fn mistakes_behind_a_refused_motion_are_told_by_both() {
    let text = "N10 G01 X1 F600\nN20 X25\nN30 G02 X10 Y0 I1 J5\nN40 G91 X-20\nN50 E500\nM30\n";
    same_refusal("many", text, "N20");
    let (_, _, stderr) = told(&glidepath(&["check", &written("check-many", text), "--machine", &limited()]));
    // From X10 the block N40 leads to X-10, which is permitted.
    for (line, refused) in [(2, true), (3, true), (4, false), (5, true)] {
        assert_eq!(stderr.contains(&format!("check-many.nc:{line}:")), refused, "{line}: {stderr}");
    }
}

/// Remarks about curves come from the smoother, which a check runs.
#[test]
fn remarks_are_those_of_the_plan() {
    let soft = "N10 G01 X10 F3000\n#CONTOUR MODE ON [DIST_SOFT PATH_DIST=1]\nN20 G02 X20 Y10 I0 J10\nN30 G01 Y20\n\
        G04 X0.1\nM26\nX5\n#CONTOUR MODE OFF\nM30\n";
    let spline =
        "N10 G00 X5\nN20 G04 X0.1\n#SET SPLINE TYPE BSPLINE\nG151\nG01 X10 Y5 F600\nX20\nX30 Y9\nG150\nM30\n";
    let own = [("soft", soft), ("spline", spline)];
    let own = own.map(|(name, text)| written(&format!("check-remark-{name}"), text));
    let names = ["arcs", "corners", "hsc_opt", "splines", "first"];
    let shipped = names.map(|name| shipped(&format!("../../programs/{name}.nc")));
    for program in own.iter().chain(&shipped) {
        let plan = told(&glidepath(&["check", program, "--plan"]));
        assert_eq!(told(&glidepath(&["check", program])), plan, "{program}");
    }
    assert!(told(&glidepath(&["check", &own[0]])).2.contains("warning"), "a remark to compare");
}

/// Functions and filters do not keep a check waiting: far more functions than the queue has room for, all with
/// acknowledgement.
#[test]
fn functions_and_filters_are_passed() {
    let functions = "M26\nH5\n".repeat(300);
    let text = format!(
        "N10 G01 X1 F600\n{functions}#FILTER ON [AX_DEV=0.1]\nX2\n{functions}#FILTER OFF\nX3\n{functions}M30\n"
    );
    let (ended, stdout, stderr) =
        told(&glidepath(&["check", &written("check-functions", &text), "--machine", &limited()]));
    assert!(ended && stdout.contains("3 motion blocks"), "{stdout}{stderr}");
}

/// A motion of 100 hours: driven it would take minutes.
#[test]
fn a_check_does_not_drive() {
    let begun = Instant::now();
    let program = written("check-long", "N10 G01 X600 F1\nX0\nX600\nN20 G04 X100000\nM30\n");
    let (ended, _, stderr) = told(&glidepath(&["check", &program]));
    assert!(ended, "{stderr}");
    assert!(begun.elapsed() < Duration::from_secs(10), "{:?}", begun.elapsed());
}

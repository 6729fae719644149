//! Runs with events: commands of the operator, late text, a late planner, and acknowledgements.
mod common;
use common::*;
use serde_json::{Value, json};
use std::fs;
use std::path::Path;
use std::process::Command;

/// A file of events that the test writes itself.
fn events(name: &str, text: &str) -> String {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{name}.events"));
    fs::write(&path, text).expect("events for the test");
    path.to_str().expect("a path of plain characters").to_owned()
}

/// Pieces of a straight line are no corners, and a standstill at the end of a run is one.
#[test]
fn corners_are_where_the_path_bends_and_an_abort_tells_its_way() {
    let program = written("pieces", "%pieces\nG01 X10 F6000\nX20\nX30\nY10\nY20\nM30\n");
    let script = events("pieces", "0.3 abort\n");
    let whole = run("pieces", &program, None);
    let corners = whole.summary["slowest_corners"].as_array().expect("a list");
    let slow =
        corners.iter().filter(|corner| number(&corner["v"]) < 50.0).map(|corner| corner["block"].clone());
    assert_eq!(slow.collect::<Vec<_>>(), [json!(2)], "{corners:?}");
    let aborted = run_with("pieces-aborted", &program, None, &["--events", &script]);
    let reaction = &aborted.summary["events"][0]["reaction"];
    assert_eq!(reaction["what"], json!("standstill"));
    let path = number(&aborted.summary["path_mm"]);
    assert!(number(&reaction["path_mm"]) > 1.0 && number(&reaction["path_mm"]) < path, "{reaction}");
}

#[test]
fn a_late_planner_takes_time_and_loses_nothing() {
    let program = shipped("../../programs/short_blocks.nc");
    let plain = run("in-time", &program, None);
    let late = events("late", "; long enough for any queue\n2 stall 30\n");
    let run = run_with("late", &program, None, &["--events", &late]);
    let rows = &run.trace.rows;
    assert_eq!(run.summary["ticks"], json!(rows.len()));
    for (tick, row) in rows.iter().enumerate() {
        let t: f64 = row.t_s.parse().expect("a number");
        assert!((t - tick as f64 * 0.001).abs() < 1e-9, "{tick} {t}");
    }
    // From the standstill to the end of the 30 s nothing moves, and nothing is said to move.
    let event = &run.summary["events"][0];
    assert_eq!(
        (&event["what"], &event["tick"], &event["line"]),
        (&json!("planner late 30 s"), &json!(2000), &json!(2))
    );
    let reaction = &event["reaction"];
    assert_eq!(reaction["what"], json!("standstill"));
    let still = 2000 + (number(&reaction["after_s"]) * 1000.0).round() as usize;
    assert!(rows[still - 1].axes != rows[still].axes && rows[1999].s_mm < rows[still].s_mm);
    assert!((rows[still].s_mm - rows[1999].s_mm - number(&reaction["path_mm"])).abs() < 1e-9);
    for row in &rows[still + 1..32_000] {
        assert_eq!((&row.axes, row.v_mm_s, row.a_mm_s2), (&rows[still].axes, 0.0, 0.0), "{}", row.t_s);
    }
    // It shows the standstill once more, and starts from rest.
    assert!(rows[32_010].axes != rows[still].axes);
    assert!((number(&run.summary["held_s"]) - (32_000 - still - 1) as f64 * 0.001).abs() < 0.005);
    let ends = |rows: &[Row]| rows[rows.len() - 1].axes.clone();
    assert_eq!(ends(rows), ends(&plain.trace.rows));
    assert_eq!(run.summary["blocks"], plain.summary["blocks"]);
    assert!((number(&run.summary["path_mm"]) - number(&plain.summary["path_mm"])).abs() < 1e-9);
}

#[test]
fn late_text_is_braked_for_and_nothing_is_lost() {
    let program = shipped("../../programs/short_blocks.nc");
    let late = events("late-text", "0.3 starve 30\n");
    for slope in ["step", "trapez", "sin2", "hsc"] {
        let plain = run_with(&format!("{slope}-in-time"), &program, None, &["--slope", slope]);
        let run = run_with(&format!("{slope}-late"), &program, None, &["--slope", slope, "--events", &late]);
        let event = &run.summary["events"][0];
        assert_eq!(event["what"], json!("program text late 30 s"));
        assert_eq!(event["reaction"]["what"], json!("standstill"), "{slope}");
        // It moves on with what it knows, and then stands until there is text.
        let still = 300 + (number(&event["reaction"]["after_s"]) * 1000.0).round() as usize;
        let rows = &run.trace.rows;
        for row in &rows[still + 1..30_300] {
            assert_eq!((&row.axes, row.v_mm_s), (&rows[still].axes, 0.0), "{slope} {}", row.t_s);
        }
        assert!(rows[30_305].axes != rows[still].axes, "{slope}");
        for name in ["X", "Y"] {
            let axis = &run.summary["axes"][name];
            for kind in ["v", "a", "j"] {
                let limit = axis[format!("{kind}_limit")].as_f64().unwrap_or(f64::INFINITY);
                let allowance = if kind == "j" { 4.0 * LSB * 1e9 } else { 0.01 };
                assert!(
                    number(&axis[format!("{kind}_max")]) <= limit + allowance,
                    "{slope} {name} {kind}: {axis}"
                );
            }
        }
        let ends = |rows: &[Row]| rows[rows.len() - 1].axes.clone();
        assert_eq!(ends(rows), ends(&plain.trace.rows), "{slope}");
        assert!((number(&run.summary["path_mm"]) - number(&plain.summary["path_mm"])).abs() < 1e-9);
    }
}

/// Rows: OP-06.
#[test]
fn a_hold_stands_on_the_path_and_goes_on() {
    let program = cut_line("held");
    let script = events("held", "0.3 feedhold\n2.3 resume\n");
    for slope in ["step", "trapez", "sin2", "hsc"] {
        let plain = run_with(&format!("{slope}-whole"), &program, None, &["--slope", slope]);
        let run =
            run_with(&format!("{slope}-held"), &program, None, &["--slope", slope, "--events", &script]);
        let rows = &run.trace.rows;
        let [hold, resume] = [0, 1].map(|i| run.summary["events"][i]["reaction"].clone());
        assert_eq!((&hold["what"], &resume["what"]), (&json!("standstill"), &json!("motion")), "{slope}");
        let still = 300 + (number(&hold["after_s"]) * 1000.0).round() as usize;
        let moves = 2300 + (number(&resume["after_s"]) * 1000.0).round() as usize;
        assert!(rows[still - 1].axes != rows[still].axes && rows[299].s_mm < rows[still].s_mm, "{slope}");
        for row in &rows[still + 1..moves] {
            assert_eq!((&row.axes, row.v_mm_s), (&rows[still].axes, 0.0), "{slope} {}", row.t_s);
        }
        // Both in no time: 500 mm/s is lost in 300 ms at most, and the first set point that moves is near.
        assert!(still <= 700 && moves <= 2310, "{slope}: {still} {moves}");
        for name in ["X", "Y"] {
            let axis = &run.summary["axes"][name];
            for kind in ["v", "a", "j"] {
                let limit = &axis[format!("{kind}_limit")];
                let allowance = if kind == "j" { 4.0 * LSB * 1e9 } else { 0.01 };
                // STEP knows no jerk.
                let limit = limit.as_f64().unwrap_or(f64::INFINITY);
                assert!(
                    number(&axis[format!("{kind}_max")]) <= limit + allowance,
                    "{slope} {name} {kind}: {axis}"
                );
            }
        }
        assert_eq!(rows[rows.len() - 1].axes, plain.trace.rows[plain.trace.rows.len() - 1].axes);
        assert_eq!(run.summary["blocks"], plain.summary["blocks"], "{slope}");
        assert!((number(&run.summary["path_mm"]) - number(&plain.summary["path_mm"])).abs() < 1e-9);
    }
}

#[test]
fn a_hold_without_end_is_an_error_without_files() {
    let (program, script) = (cut_line("endless"), events("endless", "0.1 override 150\n0.3 feedhold\n"));
    let file = Path::new(env!("CARGO_TARGET_TMPDIR")).join("endless.csv");
    let _ = fs::remove_file(&file);
    let mut command = Command::new(env!("CARGO_BIN_EXE_glidepath"));
    command.args(["run", &program, "--events", &script, "--trace"]).arg(&file);
    let output = command.output().expect("the simulator starts");
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(1), "{text}");
    assert!(text.contains("the motion stands still from"), "{text}");
    assert!(
        text.contains("endless.events:2:5") && text.contains("expected a later resume or abort"),
        "{text}"
    );
    assert!(!file.exists());
}

/// Axes beside the path move too: it stands still when they do.
#[test]
fn a_hold_without_end_counts_axes_beside_the_path() {
    let text = "X[INDP_ASYN G01 FEED=600 POS=50]\nG01 F1000 Y5\nM30\n";
    let (program, script) = (written("beside-held", text), events("beside-held", "0.7 feedhold\n"));
    let mut command = Command::new(env!("CARGO_BIN_EXE_glidepath"));
    let output = command.args(["run", &program, "--events", &script]).output().expect("the simulator starts");
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(1), "{text}");
    let from = text.split("the motion stands still from ").nth(1).and_then(|rest| rest.split(' ').next());
    let from: f64 = from.and_then(|from| from.parse().ok()).unwrap_or_else(|| panic!("{text}"));
    assert!((0.7..0.9).contains(&from), "{text}");
}

#[test]
fn an_abort_ends_at_rest_on_the_path() {
    let program = cut_line("aborted");
    for (name, text) in [
        ("abort", "0.3 abort\n"),
        ("hold-abort", "0.3 feedhold\n1.5 abort\n"),
        ("zero-abort", "0.3 override 0\n1.5 abort\n"),
    ] {
        let run = run_with(name, &program, None, &["--events", &events(name, text)]);
        let rows = &run.trace.rows;
        let last = &rows[rows.len() - 1];
        assert_eq!(last.v_mm_s, 0.0, "{name}");
        let [x, y] =
            [last.axes[0], last.axes[1]].map(|bits| bits as f64 / f64::from(1 << 16) / f64::from(1 << 16));
        // Between the chord and the parabola its ends are on.
        assert!((0.0..1e-4).contains(&(y - 0.000_004 * x * x)), "{name}: {x} {y}");
        assert!(last.axes[0] > rows[299].axes[0] && last.axes[0] < bits("100.0"), "{name}");
        assert_eq!(run.summary["ticks"], json!(rows.len()));
    }
}

#[test]
fn events_are_told_and_drawn_and_leave_the_rest_alone() {
    let program = shipped("../../programs/plate.nc");
    let plain = run("no-events", &program, None);
    let none = run_with("only-comments", &program, None, &["--events", &events("none", "# nothing\n\n")]);
    assert_eq!(plain.summary, none.summary);

    let all = events(
        "all",
        "0.5 override 62.5\n1 feedhold\n1.0001 resume\n8 reduced on\n8 reduced off ; at once\n100000 abort\n",
    );
    let run = run_with("all", &program, None, &["--events", &all]);
    let told: Vec<_> = run.summary["events"]
        .as_array()
        .into_iter()
        .flatten()
        .map(|event| (event["tick"].as_u64(), event["what"].as_str().unwrap_or_default()))
        .collect();
    let expected = [
        (Some(500), "override 62.5 %"),
        (Some(1000), "feed hold"),
        (Some(1001), "resume"),
        (Some(8000), "reduced on"),
        (Some(8000), "reduced off"),
        (None, "abort"),
    ];
    assert_eq!(told, expected);
    assert!(
        run.stderr.contains("all.events:6:8") && run.stderr.contains("before this event"),
        "{}",
        run.stderr
    );
    let svg = fs::read_to_string(run.directory.join("p.svg")).expect("it was asked for");
    for (tick, what) in expected {
        assert!(run.stdout.contains(what), "{}", run.stdout);
        assert_eq!(svg.contains(&format!(">{what}</text>")), tick.is_some(), "{what}");
    }
    // Drawing looks on.
    let mut command = Command::new(env!("CARGO_BIN_EXE_glidepath"));
    let output = command.args(["run", &program, "--events", &all]).output().expect("the simulator starts");
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(text.contains(run.summary["digest"].as_str().unwrap_or("none")), "{text}");
}

#[test]
fn the_shipped_events_are_accepted() {
    let file = shipped("../../programs/plate.events");
    let run = run_with("shipped", &shipped("../../programs/plate.nc"), None, &["--events", &file]);
    let told = run.summary["events"].as_array().expect("a list");
    let given = told.iter().filter(|event| event["tick"].is_u64()).count();
    assert_eq!((told.len(), given), (6, 6));
    assert!(run.stderr.is_empty(), "{}", run.stderr);
}

/// A rounded corner with M25, then M26 before a block.
const ACTIONS: &str = "%m\nN100 #CONTOUR MODE [DEV, PATH_DEV 2, INTER_ACTION]\nN110 G01 X60 G61 M25 F6000\n\
    N120 Y60\nN130 X0 M26\nM30\n";

fn synchronised(name: &str) -> String {
    let machine = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{name}.toml"));
    let text = fs::read_to_string(shipped("machines/default.toml")).expect("the shipped machine");
    let text = format!("{text}\n[channel.m_synch]\n25 = \"MVS_SNS\"\n26 = 0x2\n");
    fs::write(&machine, text).expect("a machine for the test");
    machine.to_str().expect("a path of plain characters").to_owned()
}

#[test]
fn functions_are_acknowledged_at_once_late_or_by_events() {
    let (program, machine) = (written("actions", ACTIONS), synchronised("actions"));
    let ms = |value: &Value| (number(value) * 1e3).round() as i64;
    let functions = |run: &Run| {
        let functions = run.summary["functions"].as_array().expect("a list").iter();
        functions.map(|f| (ms(&f["t_s"]), ms(&f["acknowledged_s"]))).collect::<Vec<_>>()
    };
    let at_once = run("at-once", &program, Some(&machine));
    let [(first, one), (second, two)] = functions(&at_once)[..] else { panic!("{:?}", at_once.summary) };
    assert_eq!((one - first, two - second), (1, 1));
    assert_eq!(at_once.summary["waited_s"], json!(0.0));
    // 0.25 s from each output.
    let late = run_with("late-ack", &program, Some(&machine), &["--ack", "0.25"]);
    let delayed = second + 249;
    assert_eq!(functions(&late), [(first, first + 250), (delayed, delayed + 250)]);
    assert_eq!(ms(&late.summary["waited_s"]), 2 * 249);
    assert!(late.stdout.contains("0.498 s waited") && late.stdout.contains("acknowledged after 250 ms"));
    let svg = fs::read_to_string(late.directory.join("p.svg")).expect("it was asked for");
    assert!(svg.contains(">M25</text>") && svg.contains(">M26</text>"));
    // By an event, one that comes too early, and one at once.
    let script = events("actions", "0.1 ack M25\n3 ack M25\n");
    let run = run_with("acked", &program, Some(&machine), &["--events", &script]);
    assert_eq!(functions(&run)[0], (first, 3000));
    assert!(run.stderr.contains("actions.events:1:5") && run.stderr.contains("nothing waits for M25"));
    assert_eq!(run.stderr.matches("warning").count(), 1, "{}", run.stderr);
    // The set points stay where the curve is in its middle.
    let rows = &run.trace.rows;
    assert!(rows[first as usize..3000].iter().all(|row| row.axes == rows[first as usize].axes));
    assert_ne!(rows[3005].axes, rows[3000].axes);
}

#[test]
fn a_function_that_is_never_acknowledged_is_named() {
    let (program, machine) = (written("never", ACTIONS), synchronised("never"));
    let script = events("never", "0.1 ack M25\n0.2 feedhold\n0.4 resume\n");
    for (options, expected) in
        [(["--ack", "never"], "acknowledgement of M25"), (["--events", &script], "never.events:1:5")]
    {
        let mut command = Command::new(env!("CARGO_BIN_EXE_glidepath"));
        command.args(["run", &program, "--machine", &machine]).args(options);
        let output = command.output().expect("the simulator starts");
        let text = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(1), "{text}");
        assert!(text.contains(expected) && text.contains("--ack SECONDS"), "{text}");
    }
    // Nothing to reduce.
    let script = events("nothing-reduced", "0.1 reduced on\n");
    let run = run_with("nothing-reduced", &program, None, &["--events", &script]);
    assert!(run.stderr.contains("events:1:5") && run.stderr.contains("vb_max_red"), "{}", run.stderr);
    // An abort ends the wait.
    let script = events("never-abort", "0.1 ack M25\n4 abort\n");
    let run = run_with("never-abort", &program, Some(&machine), &["--events", &script]);
    assert_eq!(run.summary["functions"][0]["acknowledged_s"], Value::Null);
    assert_eq!(run.summary["events"][1]["tick"], json!(4000));
}

#[test]
fn a_dwell_behind_an_abort_does_not_count() {
    let program = written("abort-dwell", "%a\nN10 G01 X1 F60\nN20 G04 X5\nN30 X2\nN40 G04 X1\nM30\n");
    let dwell = |name: &str, text: &str| {
        let run = run_with(name, &program, None, &["--events", &events(name, text)]);
        number(&run.summary["dwell_s"])
    };
    assert_eq!(dwell("abort-before", "0.5 abort\n"), 0.0);
    // The dwell begins after 1.02 s; the first set point of a standstill is that of tick 1019 or so.
    let part = dwell("abort-within", "4.5 abort\n");
    assert!((3.4..3.5).contains(&part), "{part}");
    assert_eq!(dwell("abort-between", "6.5 abort\n"), 5.0);
    assert_eq!(dwell("no-abort", "0.5 override 100\n"), 6.0);
}

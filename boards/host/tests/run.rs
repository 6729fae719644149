//! Runs of the command: the output files are compared with each other and with the program.
mod common;
use common::*;
use serde_json::{Value, json};
use std::fs;
use std::path::Path;
use std::process::Command;

#[test]
fn a_trace_is_at_rest_at_both_ends_and_complete() {
    let run = run("ends", &shipped("tests/programs/shapes.nc"), None);
    assert_eq!(run.trace.header, "tick,t_s,n,block,s_mm,v_mm_s,a_mm_s2,X,Y,Z");
    let rows = &run.trace.rows;
    let (first, last) = (&rows[0], &rows[rows.len() - 1]);
    assert_eq!((first.v_mm_s, first.a_mm_s2, first.s_mm), (0.0, 0.0, 0.0));
    assert_eq!((last.v_mm_s, last.a_mm_s2), (0.0, 0.0));
    assert_eq!((first.axes.as_slice(), last.axes.as_slice()), (&[0; 3][..], &[0; 3][..]));
    assert_eq!(
        (rows[1000].t_s.as_str(), rows[1050].t_s.as_str(), first.t_s.as_str()),
        ("1.0", "1.05", "0.0")
    );
    assert_eq!(run.summary["ticks"], json!(rows.len()));
    // The time law ends within the last tick.
    let rest = last.t_s.parse::<f64>().unwrap_or(-1.0) - number(&run.summary["program_time_s"]);
    assert!((0.0..0.001).contains(&rest), "{rest}");
    assert_eq!(run.summary["cycle_s"], json!(0.001));
    // So do the laws of all blocks, with the waits behind standstills.
    let lasts = |plan: &Value| number(&plan["time_s"]) + number(&plan["wait_s"]);
    let planned: f64 = run.summary["plan"].as_array().into_iter().flatten().map(lasts).sum();
    let dwells = number(&run.summary["dwell_s"]);
    let off = number(&run.summary["program_time_s"]) - planned - dwells;
    assert!(off.abs() < 0.001, "{planned} s planned, {off} s off");

    // Every block is there, in order, under its number.
    let mut blocks: Vec<(u32, u32)> = rows.iter().map(|row| (row.block, row.n)).collect();
    blocks.dedup();
    let expected = [10, 20, 30, 40, 50, 70, 80, 90].into_iter().enumerate();
    assert_eq!(blocks, expected.map(|(block, n)| (block as u32, n)).collect::<Vec<_>>());
    assert_eq!(run.summary["blocks"], json!(8));
}

#[test]
fn digest_and_peaks_can_be_computed_from_the_trace() {
    let run = run("digest", &shipped("tests/programs/shapes.nc"), None);
    // FNV-1a over the halves of every set point, from the printed decimals: they must be exact for that.
    let mut digest = 0xcbf2_9ce4_8422_2325_u64;
    for row in &run.trace.rows {
        for &axis in &row.axes {
            for half in [axis as u64 & 0xffff_ffff, axis as u64 >> 32] {
                digest = (digest ^ half).wrapping_mul(0x0000_0100_0000_01b3);
            }
        }
    }
    assert_eq!(run.summary["digest"], json!(format!("{digest:016x}")));

    for (index, name) in ["X", "Y", "Z"].into_iter().enumerate() {
        let mut values: Vec<i64> = run.trace.rows.iter().map(|row| row.axes[index]).collect();
        let rest = values[values.len() - 1];
        values.splice(0..0, [values[0]; 3]);
        values.extend([rest; 3]);
        let mut scale = LSB;
        for field in ["v_max", "a_max", "j_max"] {
            values = values.windows(2).map(|pair| pair[1] - pair[0]).collect();
            scale *= 1000.0;
            let peak = values.iter().map(|value| value.abs()).max().unwrap_or(0) as f64 * scale;
            let said = number(&run.summary["axes"][name][field]);
            assert!((peak - said).abs() <= 1e-9 * peak, "{name} {field}: {peak} {said}");
        }
        let axis = &run.summary["axes"][name];
        for kind in ["v", "a", "j"] {
            let (peak, limit) =
                (number(&axis[format!("{kind}_max")]), number(&axis[format!("{kind}_limit")]));
            // Rounding of set points: 8 · half an LSB per tick³.
            let allowance = if kind == "j" { 4.0 * LSB * 1e9 } else { 0.01 };
            assert!(peak > 0.0 && peak <= limit + allowance, "{name} {kind}: {peak} of {limit}");
        }
    }
}

/// P-CHAN-00009 = 0: a line that touches a circle of 10 mm, and leaves it, at 100 mm/s.
#[test]
fn joints_with_a_permitted_step_are_counted() {
    let directory = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("steps");
    std::fs::create_dir_all(&directory).expect("a directory for the test");
    let write = |name: &str, text: &str| {
        std::fs::write(directory.join(name), text).expect("a file for the test");
        directory.join(name).to_str().expect("plain characters").to_owned()
    };
    let program = write("touch.nc", "N10 G01 X50 F6000\nN20 G03 X60 Y10 I0 J10\nN30 G01 Y40\nM30\n");
    let default = std::fs::read_to_string(shipped("machines/default.toml")).expect("a shipped machine");
    assert!(default.contains("corr_v_trans_jerk = 1"));
    let machine = write("free.toml", &default.replace("corr_v_trans_jerk = 1", "corr_v_trans_jerk = 0"));
    let free = run("steps-free", &program, Some(&machine));
    assert_eq!(free.summary["steps"]["count"], json!(2));
    let largest = number(&free.summary["steps"]["largest"]);
    assert!((largest / 1000.0 - 1.0).abs() < 0.05, "{largest} mm/s², v²/R is 1000");
    assert!(number(&free.summary["axes"]["X"]["j_max"]) > number(&free.summary["axes"]["X"]["j_limit"]));
    for expected in [
        "2 joints with a step of acceleration, the largest one",
        "jerk not compared at joints: P-CHAN-00009 = 0",
    ] {
        assert!(free.stdout.contains(expected), "{}", free.stdout);
    }
    let limited = run("steps-limited", &program, None);
    assert_eq!((&limited.summary["steps"], &limited.summary["left_out"]), (&json!(null), &json!(null)));
    assert_eq!((&free.summary["exceeded"], &limited.summary["exceeded"]), (&json!(0), &json!(0)));
    assert!(number(&free.summary["program_time_s"]) < 0.9 * number(&limited.summary["program_time_s"]));
}

/// An axis beside the path has a slope of its own: its jerk is compared with that one, to both sides.
#[test]
fn jerk_beside_the_path_is_that_of_its_own_slope() {
    let default = std::fs::read_to_string(shipped("machines/default.toml")).expect("a shipped machine");
    let machine = |name: &str, slope: u32| {
        let path = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
        assert!(default.contains("\nprofile = 1 "));
        let text = default.replace("\nprofile = 1 ", &format!("\nprofile = {slope} "));
        std::fs::write(&path, text).expect("a file for the test");
        path.to_str().expect("plain characters").to_owned()
    };
    let (step, trapez) = (machine("beside-step.toml", 0), machine("beside-trapez.toml", 1));
    for (name, machine, text) in [
        ("step", &trapez, "G01 F6000\nX[INDP_SYN G01 FEED=6000 POS=20 SLOPE_TYPE=STEP]\n"),
        ("sine", &trapez, "G01 F6000\nX[INDP_SYN G01 FEED=6000 POS=20 SLOPE_TYPE=SIN2]\n"),
        (
            "heavy",
            &trapez,
            "#SLOPE [TYPE=TRAPEZ]\nG130 X10\nG01 F6000 X1\nX[INDP_SYN G01 FEED=6000 POS=20]\n",
        ),
        ("async", &step, "#SLOPE [TYPE=SIN2 NO_OPT=1]\nG01 F600 Z-1\nY[INDP_ASYN G01 FEED=600 POS=-2]\n"),
        (
            "osc",
            &step,
            "#SLOPE [TYPE=TRAPEZ]\nG01 F600\nY[OSC ON 1ST_POS=-1 2ND_POS=0 TIME=0.3 NBR_OSC=2]\nX20\n",
        ),
    ] {
        let run = run(&format!("beside-{name}"), &written(name, &format!("{text}M30\n")), Some(machine));
        assert_eq!(run.summary["exceeded"], json!(0), "{name}: {}", run.stderr);
    }
}

#[test]
fn path_columns_belong_together() {
    let run = run("columns", &shipped("tests/programs/shapes.nc"), None);
    let rows = &run.trace.rows;
    for triple in rows.windows(3) {
        let [before, row, after] = triple else { continue };
        assert!(after.s_mm >= row.s_mm);
        // Differences of a motion with at most 13 334 mm/s³, the limit of one axis, √3 for three of them.
        let jerk = 13_334.0 * 3.0_f64.sqrt();
        let v = (after.s_mm - before.s_mm) / 0.002;
        assert!((v - row.v_mm_s).abs() <= jerk * 1e-6 / 4.0 + 1e-6, "t = {}: {v} {}", row.t_s, row.v_mm_s);
        let a = (after.v_mm_s - before.v_mm_s) / 0.002;
        assert!((a - row.a_mm_s2).abs() <= jerk * 1e-3 / 2.0 + 1e-3, "t = {}: {a} {}", row.t_s, row.a_mm_s2);
    }
    let planned = run.summary["plan"].as_array().expect("a list").iter();
    let planned: f64 = planned.map(|block| number(&block["length_mm"])).sum();
    assert!((planned - rows[rows.len() - 1].s_mm).abs() < 1e-9);
    assert!((planned - number(&run.summary["path_mm"])).abs() < 1e-9);
}

#[test]
fn the_contour_is_what_was_programmed() {
    let run = run("contour", &shipped("tests/programs/shapes.nc"), None);
    let at = |x: f64, y: f64, z: f64| json!({"X": x, "Y": y, "Z": z});
    let centre = |x: f64, y: f64| json!({"X": x, "Y": y});
    let expected = json!({
        "axes": ["X", "Y", "Z"],
        "main": ["X", "Y", "Z"],
        "start": at(0.0, 0.0, 0.0),
        "segments": [
            {"n": 10, "type": "line", "end": at(10.0, 0.0, 0.0), "stop": false},
            {"n": 20, "type": "line", "end": at(50.125, 0.0, 0.0), "feed": 6000.0, "stop": false},
            {"n": 30, "type": "arc", "plane": ["X", "Y"], "center": centre(50.125, -10.0), "dir": "cw",
             "turns": 0, "end": at(60.125, -10.0, 0.0), "feed": 6000.0, "stop": false},
            {"n": 40, "type": "arc", "plane": ["X", "Y"], "center": centre(70.125, -10.0), "dir": "ccw",
             "turns": 0, "end": at(70.125, 0.0, 0.0), "feed": 6000.0, "stop": false},
            {"n": 50, "type": "line", "end": at(70.125, 20.0, 0.0), "feed": 6000.0, "stop": true},
            {"n": 60, "type": "dwell"},
            {"n": 70, "type": "arc", "plane": ["X", "Y"], "center": centre(50.125, 20.0), "dir": "ccw",
             "turns": 0, "end": at(70.125, 20.0, 3.0), "feed": 9000.0, "stop": false},
            {"n": 80, "type": "arc", "plane": ["Z", "X"], "center": {"Z": 3.0, "X": 75.125}, "dir": "cw",
             "turns": 0, "end": at(70.125, 20.0, 3.0), "feed": 9000.0, "stop": false},
            {"n": 90, "type": "line", "end": at(0.0, 0.0, 0.0), "stop": false},
        ],
    });
    let mut contour = run.contour;
    // 0.05 s is no binary fraction: it is compared apart.
    let time = contour["segments"][5].as_object_mut().and_then(|dwell| dwell.remove("time"));
    assert!((number(&time.expect("a dwell has a time")) - 0.05).abs() < 1e-9);
    assert_eq!(contour, expected);
}

#[test]
fn the_default_machine_file_gives_the_same_bits() {
    let program = shipped("../../programs/first.nc");
    let built_in = run("built-in", &program, None);
    let default = run("default", &program, Some(&shipped("machines/default.toml")));
    assert_eq!(built_in.summary["digest"], default.summary["digest"]);
    assert!(default.stdout.contains("default.toml") && built_in.stdout.contains("built-in"));
    // Another machine moves differently.
    let bench = run("bench", &program, Some(&shipped("machines/bench.toml")));
    assert_ne!(built_in.summary["digest"], bench.summary["digest"]);
}

#[test]
fn rotary_axes_move_along_and_alone() {
    let text = "%rotary\nN10 G01 X30 Y40 C36.5 F6000\nN20 G01 A-12.25 F3600\nN30 X30 Y0\nM30\n";
    let run = run("rotary", &written("rotary", text), Some(&shipped("machines/five-axis.toml")));
    assert!(run.trace.header.ends_with(",X,Y,Z,A,C"), "{}", run.trace.header);
    let last = &run.trace.rows[run.trace.rows.len() - 1].axes;
    assert_eq!(last, &["30.0", "0.0", "0.0", "-12.25", "36.5"].map(bits));
    assert_eq!(run.contour["main"], json!(["X", "Y", "Z"]));
    for (name, unit) in [("X", "mm"), ("C", "°")] {
        let axis = &run.summary["axes"][name];
        assert_eq!(axis["unit"], json!(unit));
        assert!(number(&axis["v_max"]) <= number(&axis["v_limit"]));
    }
}

#[test]
fn what_is_shown_of_a_path_along_a_feed_axis() {
    let machine = shipped("machines/handling.toml");
    let led = run("handling", &shipped("../../programs/handling.nc"), Some(&machine));
    // Path, its speed and F are those of X; the contour has the feed along all main axes.
    assert!((number(&led.summary["path_mm"]) - 600.0).abs() < 1e-6, "{}", led.summary);
    assert!(led.trace.rows.iter().all(|row| row.v_mm_s <= 20_000.0 / 60.0));
    let feed = |n: usize| number(&led.contour["segments"][n]["feed"]);
    let expected = 20_000.0 * 100_f64.hypot(60.0) / 100.0;
    assert!((feed(0) - 20_000.0).abs() < 1e-6 && (feed(1) - expected).abs() < 1e-6, "{}", feed(1));
    assert_eq!(led.summary["warnings"], json!([]));
    // What the planner remarks about a curve is told like a remark of the decoder, once for each place.
    let text = "%up\n#CONTOUR MODE ON [DIST_MASTER]\n$FOR P1 = 1, 3, 1\nN10 G01 Z20 F6000\nN20 X[10*P1]\nN30 Z0\n$ENDFOR\nM30\n";
    let up = run("up", &written("up", text), Some(&machine));
    let told = up.summary["warnings"].as_array().expect("a list");
    assert_eq!(told.len(), 2, "{told:?}");
    assert!(
        told.iter().all(|warning| warning["text"].as_str().is_some_and(|text| text.contains("master axis")))
    );
}

#[test]
fn a_dwell_at_a_rounded_corner_is_told() {
    let text = "%dwell\nN10 G261\nN20 G01 X10 F6000\nN30 G04 X0.1\nN40 Y10\nM30\n";
    let run = run("dwell", &written("dwell", text), None);
    let told = run.summary["warnings"].as_array().expect("a list");
    assert_eq!(told.len(), 1, "{told:?}");
    assert!(run.stderr.contains("dwell.nc:4:") && run.stderr.contains("programmed corner"), "{}", run.stderr);
}

#[test]
fn the_feed_factor_makes_metres_of_the_feed() {
    let machine = Path::new(env!("CARGO_TARGET_TMPDIR")).join("metres.toml");
    let text = "[channel.prog_start]\nfeedrate_factor = 0.1\nslope.profile = 1\n[axis.X]\n";
    fs::write(&machine, text).expect("a machine for the test");
    let run = run("metres", &written("metres", "%m\nG01 X10 F2.5\nM30\n"), machine.to_str());
    assert!((number(&run.contour["segments"][0]["feed"]) - 2500.0).abs() < 1e-6);
}

#[test]
fn warnings_and_functions_are_told() {
    let text = "%L part\nN10 G01 X1 F600 M7\nM30\n%main\nN1 M3 S500\nLL part\nM30\n";
    let run = run("warnings", &written("warnings", text), None);
    assert!(run.stderr.contains("warning") && run.stderr.contains("warnings.nc:3:1"), "{}", run.stderr);
    assert_eq!(run.summary["warnings"][0]["line"], json!(3));
    assert_eq!(run.summary["warnings"][0]["column"], json!(1));
    assert!(run.summary["warnings"][0]["text"].as_str().is_some_and(|text| text.contains("subroutine")));
    let functions: Vec<_> = run.summary["functions"].as_array().into_iter().flatten().collect();
    let names: Vec<_> = functions.iter().filter_map(|function| function["function"].as_str()).collect();
    assert_eq!(names, ["S500", "M3", "M7"]);
    assert!(number(&functions[2]["t_s"]) > 0.0);
}

#[test]
fn pictures_have_their_format() {
    let program = shipped("tests/programs/shapes.nc");
    let run = run("picture", &program, None);
    let svg = fs::read_to_string(run.directory.join("p.svg")).expect("it was asked for");
    assert!(svg.starts_with("<svg ") && svg.contains("Path speed") && svg.contains("shapes.nc"));
    let png = run.directory.join("p.png");
    let mut command = Command::new(env!("CARGO_BIN_EXE_glidepath"));
    let output = command.arg("run").arg(&program).arg("--plot").arg(&png).output().expect("it starts");
    assert_eq!(output.status.code(), Some(0));
    assert!(fs::read(&png).expect("it was asked for").starts_with(b"\x89PNG\r\n"));
}

#[test]
fn the_first_refusal_counts() {
    let cases = [
        ("alone", "%n\nN10 G01 X1 F600\nN20 #MCS ON\nN30 X2\nM30\n"),
        // A later line is not even NC.
        ("before-another", "%n\nN10 G01 X1 F600\nN20 #MCS ON\nN30 X[\nM30\n"),
    ];
    for (name, text) in cases {
        let program = written(name, text);
        let mut command = Command::new(env!("CARGO_BIN_EXE_glidepath"));
        let output = command.args(["run", &program]).output().expect("the simulator starts");
        let text = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(1), "{text}");
        assert!(text.contains("known, not available in this version"), "{text}");
        assert!(text.contains(&format!("{name}.nc:3:5")) && text.contains("N20 #MCS ON"), "{text}");
    }
}

#[test]
fn limits_of_the_summary_are_weighted() {
    let text = "%w\nG131 150\nG133 = 50\nN10 G01 X200 F18000\nG131 10\nG133 200\nN20 X0\nM30\n";
    let run = run("weighted", &written("weighted", text), None);
    let axis = &run.summary["axes"]["X"];
    // 2000 mm/s² in 150 ms, or in the geometric ramp of 10 ms.
    assert!((number(&axis["j_limit"]) - 3000.0 / 0.01).abs() < 1e-6, "{axis}");
    assert!((number(&axis["a_max"]) - 3000.0).abs() < 30.0, "{axis}");
    let jerk = number(&axis["j_max"]);
    assert!((jerk - 3000.0 / 0.075).abs() < 0.01 * jerk, "{axis}");
}

#[test]
fn options_do_what_the_machine_file_does() {
    let program = cut_line("options");
    let text = fs::read_to_string(shipped("machines/default.toml")).expect("it is shipped");
    let text = text.replace("look_ahead = 120 ", "look_ahead = 11 ").replace("profile = 1 ", "profile = 3 ");
    let machine = Path::new(env!("CARGO_TARGET_TMPDIR")).join("options.toml");
    fs::write(&machine, text).expect("a machine for the test");
    let by_file = run("by-file", &program, machine.to_str());
    let by_option = run_with("by-option", &program, None, &["--slope", "hsc", "--look-ahead", "11"]);
    assert_eq!(by_file.summary["digest"], by_option.summary["digest"]);
    let plain = run("no-option", &program, None);
    let deep = run_with("deep", &program, None, &["--slope", "hsc"]);
    for (other, slope, depth) in [(&plain, "TRAPEZ", 120), (&deep, "HSC", 120), (&by_file, "HSC", 11)] {
        assert_eq!((&other.summary["slope"], &other.summary["look_ahead"]), (&json!(slope), &json!(depth)));
    }
    assert_ne!(by_option.summary["digest"], deep.summary["digest"]);
    assert_ne!(plain.summary["digest"], deep.summary["digest"]);
}

#[test]
fn blocks_of_a_span_are_counted_and_their_corners_are_seen() {
    let run = run_with("spans", &cut_line("spans"), None, &["--slope", "hsc"]);
    assert_eq!(run.summary["blocks"], json!(21));
    let spans: Vec<[u64; 2]> = run.summary["plan"]
        .as_array()
        .into_iter()
        .flatten()
        .map(|span| ["block", "blocks"].map(|field| span[field].as_u64().expect("a number")))
        .collect();
    // One behind the other, over all blocks, and fewer than these.
    let mut next = 0;
    for [block, blocks] in &spans {
        assert_eq!(*block, next);
        next += blocks;
    }
    assert!(next == 21 && spans.len() < 21, "{spans:?}");

    let rows = &run.trace.rows;
    let corners = run.summary["slowest_corners"].as_array().expect("a list");
    assert_eq!(corners.len(), 5);
    let mut inside = 0;
    for corner in corners {
        let block = corner["block"].as_u64().expect("a number");
        let after = rows.iter().position(|row| u64::from(row.block) > block).expect("it has an end");
        let seen = rows[after - 1].v_mm_s.min(rows[after].v_mm_s);
        let v = number(&corner["v"]);
        assert_eq!(corner["n"], json!(20 + 10 * block));
        assert_eq!(corner["line"], json!(3 + block));
        if spans.iter().any(|[first, blocks]| first + blocks == block + 1) {
            // 2000 mm/s² for less than a tick.
            assert!((v - seen).abs() <= 2.0, "{corner} {seen}");
        } else {
            inside += 1;
            assert!((v - seen).abs() <= 1e-9 && v > 10.0, "{corner} {seen}");
        }
    }
    assert!(inside > 0, "{corners:?}");
}

#[test]
fn pictures_show_limits_beside_values() {
    let run = run("limits", &shipped("../../programs/first.nc"), None);
    let svg = fs::read_to_string(run.directory.join("p.svg")).expect("it was asked for");
    let texts = [
        "limit of the axes",
        "programmed",
        "limit of an axis 6\u{202f}000",
        "limit of an axis 200\u{202f}000",
    ];
    for text in texts {
        assert!(svg.contains(&format!("{text}</text>")), "{text}");
    }
    // Axes of different dynamics are compared each with its own.
    let slow = fs::read_to_string(shipped("machines/default.toml")).expect("it is shipped");
    let at = slow.find("[axis.Y").expect("a table");
    let slow = format!("{}{}", &slow[..at], slow[at..].replacen("a_max = 6000", "a_max = 5000", 1));
    let machine = Path::new(env!("CARGO_TARGET_TMPDIR")).join("slow.toml");
    fs::write(&machine, slow).expect("a machine for the test");
    let other = crate::run("slow", &shipped("../../programs/first.nc"), machine.to_str());
    let other = fs::read_to_string(other.directory.join("p.svg")).expect("it was asked for");
    let own = |svg: &str| {
        svg.contains("% of the limit of each axis</text>") && svg.contains(">Y 5\u{202f}000</text>")
    };
    assert_eq!((own(&svg), own(&other)), (false, true));
}

/// What reaches a limit does not seem to cross it: the line of the limit lies outside of the stroke.
#[test]
fn the_speed_at_the_feed_stays_below_its_line() {
    let program = written("at-feed", "N10 G01 X100 F6000\nM30\n");
    let run = run("at-feed", &program, None);
    let svg = fs::read_to_string(run.directory.join("p.svg")).expect("it was asked for");
    // Heights of a path in the first chart, from the top.
    let heights = |colour: &str, width: &str| -> Vec<f64> {
        let look = format!("stroke=\"{colour}\" stroke-width=\"{width}\"");
        let line = svg.lines().find(|line| line.contains(&look) && line.contains("d=\"M"));
        let data = line.and_then(|line| line.split("d=\"M").nth(1)).and_then(|data| data.split('"').next());
        let numbers = data.expect("a path").replace('l', " ").replace('-', " -");
        let numbers: Vec<f64> = numbers.split_whitespace().filter_map(|number| number.parse().ok()).collect();
        let steps = numbers.chunks(2).map(|pair| pair[1]);
        steps
            .scan(0.0, |at, step| {
                *at += step;
                Some(*at)
            })
            .collect()
    };
    let highest = |all: Vec<f64>| all.into_iter().fold(f64::MAX, f64::min);
    let feed = highest(heights("#8fb8d8", "1.6"));
    let path = highest(heights("#1f2933", "1").into_iter().filter(|height| *height > 100.0).collect());
    // Half of both strokes between them.
    assert!(feed + 0.8 <= path - 0.5 + 0.011, "feed at {feed}, path at {path}");
}

#[test]
fn pictures_show_where_the_path_leaves_the_programmed_one() {
    let run = run("insets", &shipped("../../programs/first.nc"), None);
    let svg = fs::read_to_string(run.directory.join("p.svg")).expect("it was asked for");
    for text in ["Largest deviations", "Deviation", "% of the tolerance", "N60:  0.2 of 0.2 mm"] {
        assert!(svg.contains(&format!("{text}</text>")), "{text}");
    }
    // The band of the tolerance, three times.
    assert_eq!(svg.lines().filter(|line| line.contains("#cfe8d6")).count(), 3);
    // A program without smoothing has none; rotary axes are shown like the others.
    let rotary = shipped("../../programs/rotary_corners.nc");
    let rotary = crate::run("insets-rotary", &rotary, Some(&shipped("machines/five-axis.toml")));
    let rotary = fs::read_to_string(rotary.directory.join("p.svg")).expect("it was asked for");
    let names = ["X", "Y", "C"].map(|name| rotary.contains(&format!(">{name} ")));
    assert_eq!((names, rotary.contains(">C</text>")), ([true; 3], true));
    let plain = crate::run("insets-plain", &shipped("../../programs/plate.nc"), None);
    let plain = fs::read_to_string(plain.directory.join("p.svg")).expect("it was asked for");
    assert!(!plain.contains("Largest deviations") && !plain.contains("#cfe8d6"));
}

/// The headline: both slopes run the first program in some seconds of motion, and HSC is not the slower one.
#[test]
fn the_first_program_shows_what_there_is() {
    let program = shipped("../../programs/first.nc");
    let begun = std::time::Instant::now();
    let trapez = run("first-trapez", &program, None);
    assert!(begun.elapsed().as_secs_f64() < 20.0);
    let hsc = run_with("first-hsc", &program, None, &["--slope", "hsc"]);
    let time = |seen: &Run| number(&seen.summary["program_time_s"]);
    assert!(time(&hsc) <= time(&trapez), "{} {}", time(&hsc), time(&trapez));
    for seen in [&trapez, &hsc] {
        assert!(number(&seen.summary["program_time_s"]) < 6.0);
        assert!(number(&seen.summary["elements_per_block"]) > 2.0);
        assert!((number(&seen.summary["deviation"]["value"]) - 0.2).abs() < 0.001);
    }
}

/// The path of `plate.nc` turns on arcs, between two ticks, and ends where it began.
#[test]
fn travel_and_ends_are_those_of_the_path() {
    let run = run("first-travel", &shipped("../../programs/plate.nc"), None);
    for (axis, expected) in [("X", 1370.0), ("Y", 1060.0), ("Z", 80.0)] {
        let travel = number(&run.summary["axes"][axis]["travel"]);
        assert!((travel - expected).abs() < 1e-5, "{axis}: {travel}");
    }
    assert!(run.stdout.contains(" 1370.000 mm"), "{}", run.stdout);
    let svg = std::fs::read_to_string(run.directory.join("p.svg")).expect("it was asked for");
    let dots: Vec<[&str; 3]> = svg
        .lines()
        .filter_map(|line| line.strip_prefix("<circle "))
        .map(|dot| {
            ["cx=\"", "cy=\"", "r=\""]
                .map(|key| dot.split(key).nth(1).and_then(|v| v.split('"').next()).unwrap_or(""))
        })
        .collect();
    // Two views; in each the end, then the start in its middle, smaller.
    let pairs = dots.windows(2).filter(|pair| pair[0][..2] == pair[1][..2]);
    let radii: Vec<(f64, f64)> =
        pairs.map(|pair| (pair[0][2].parse().unwrap_or(0.0), pair[1][2].parse().unwrap_or(0.0))).collect();
    assert_eq!(radii.len(), 2, "{dots:?}");
    assert!(radii.iter().all(|(end, start)| *end > start + 2.0), "{radii:?}");
}

/// A machine with short ramps whose slopes take all that an axis can: v in µm/s, a in mm/s², ramps in µs.
fn quick_machine(name: &str, cycle_us: u32, slope: u8, axes: [(&str, u32, u32, u32); 3]) -> String {
    let mut text = format!(
        "[channel]\ncycle_us={cycle_us}\nlook_ahead=120\ncorr_v_trans_jerk=1\n[channel.prog_start.slope]\nprofile={slope}\n[channel.configuration.path_preparation]\nfunction=\"FCT_DEFAULT|FCT_SURFACE|FCT_PTP\"\n"
    );
    for (axis, v, a, tr) in axes {
        text += &format!(
            "[axis.{axis}]\ntype=\"linear\"\nvb_eilgang={v}\n[axis.{axis}.dynamik]\nvb_max={v}\na_max={a}\ntr_geom={tr}\n[axis.{axis}.slope_profil]\na_beschl={a}\na_brems={a}\na_grenz={a}\n"
        );
        for key in ["beschl_zu", "beschl_ab", "brems_zu", "brems_ab", "grenz"] {
            text += &format!("tr_{key}={tr}\n");
        }
    }
    written(name, &text)
}

/// Two blocks in one direction but for the rounding of their coordinates, and acceleration passes from one to the
/// other. With ramps of few ticks the step of speed showed beside the largest acceleration.
#[test]
fn a_turn_by_rounding_leaves_acceleration_its_limit() {
    let text = "G01 F7263\nG261\nG01 X7.692572 Y13.040208\nG01 X7.694265 Y13.043078\nG01 X13.628536 Y18.474884\nG01 X17.577865 Y13.322202\nG01 X14.836227 Y17.630896\nG01 X-30.254026 Y88.493674\n";
    let axes = [("X", 99_282, 477, 16_682), ("Y", 274_805, 13_927, 10_098), ("Z", 127_214, 6245, 45_878)];
    let machine = quick_machine("turn.toml", 2000, 2, axes);
    let run = run("turn", &written("turn", text), Some(&machine));
    assert!(!run.stderr.contains("error"), "{}", run.stderr);
}

//! `--plc`: answers, the picture, and refused files.
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

/// An entry of a log: kind, N, start (mm), length (mm) or parameter, knee (rad).
type Logged = (u64, u64, f64, f64, f64);

fn is_log(answer: &Value, wanted: &[Logged]) {
    let entries = answer["elements"].as_array().expect("a list");
    assert_eq!(entries.len(), wanted.len(), "{answer}");
    for (entry, (kind, n, start, value, knee)) in entries.iter().zip(wanted) {
        let is_mark = (3..=5).contains(kind);
        let value_name = if is_mark { "parameter" } else { "length_mm" };
        let knee_is = entry["tangent_variation_rad"].as_f64().unwrap_or(0.0);
        assert_eq!((entry["block_type"].as_u64(), entry["block_number"].as_u64()), (Some(*kind), Some(*n)));
        for (got, want) in [
            (entry["start_position_mm"].as_f64(), *start),
            (entry[value_name].as_f64(), *value),
            (Some(knee_is), *knee),
        ] {
            assert!(got.is_some_and(|got| (got - want).abs() < 1e-6), "{entry}: expected {want}");
        }
    }
}

/// A program of the sources, where they are; else the same lines from here.
fn example(name: &str, lines: &str) -> String {
    let shared = std::env::var("GLIDEPATH_SHARED").unwrap_or_else(|_| shipped("../shared"));
    let path = format!("{shared}/spec/programs/{name}.nc");
    if Path::new(&path).is_file() { path } else { written(&format!("{name}.nc"), lines) }
}

const KITE: &str = "N080 G1 X4 Y4\nN090 X8 Y4\nN100 X8 Y0\nN110 X4 Y-4\nN120 G1 X0 Y0\n";

/// A pass of the loop of C40-EX02 and EX03, from `start` on, with that knee at its start.
fn pass(start: f64, knee: f64) -> Vec<Logged> {
    use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};
    let long = 32f64.sqrt();
    let lines = [
        (80, long, knee),
        (90, 4.0, FRAC_PI_4),
        (100, 4.0, FRAC_PI_2),
        (110, long, FRAC_PI_4),
        (120, long, FRAC_PI_2),
    ];
    let mut at = start;
    lines
        .map(|(n, length, knee)| {
            at += length;
            (1, n, at - length, length, knee)
        })
        .to_vec()
}

/// Length of a pass: 3·√32 + 2·4 mm.
fn pass_mm() -> f64 {
    3.0f64.mul_add(32f64.sqrt(), 8.0)
}

/// C40-EX01, C40-051: the marked blocks by index, with distances from #DISTANCE PROG START CLEAR.
#[test]
fn c40_ex01_by_index() {
    let right = std::f64::consts::FRAC_PI_2;
    let lines = "N090 G01 X0 Y0 F1000\nN100 #DISTANCE PROG START CLEAR\nN110 X200\nN200 #CONTOUR LOOKAHEAD LOG ON\nN210 Y100\n\
        N300 X0\nN400 Y0\nN500 #CONTOUR LOOKAHEAD LOG OFF\nN510 M30\n";
    let told = answers(&example("C40-EX01_mode1", lines), &written("ex01.plc", "0.1 log 0\n"), &[]);
    let wanted = [
        (3, 200, 200.0, 0.0, 0.0),
        (1, 210, 200.0, 100.0, right),
        (1, 300, 300.0, 200.0, right),
        (1, 400, 500.0, 100.0, right),
        (5, 500, 600.0, 0.0, 0.0),
    ];
    is_log(&told[0], &wanted);
}

/// C40-EX02, C40-052: a log inside of the loop has it once, whatever the number of passes.
#[test]
fn c40_ex02_is_logged_once() {
    let lines = format!(
        "N050 G1 X0 Y0 F1000\nN060 #RT WHILE\nN070 #CONTOUR LOOKAHEAD LOG ON [PARAM=1]\n{KITE}\
         N130 #CONTOUR LOOKAHEAD LOG OFF [PARAM=8]\nN140 #RT ENDWHILE\nN150 M30\n"
    );
    for passes in [1u64, 3, 7] {
        let plc = written("ex02.plc", &format!("0 loop {passes}\nend log 0\nend reach\n"));
        let told = answers(&example("C40-EX02_inside_rt_loop", &lines), &plc, &[]);
        let mut wanted = vec![(3, 70, 0.0, 1.0, 0.0)];
        wanted.extend(pass(0.0, 0.0));
        wanted.push((5, 130, pass_mm(), 8.0, 0.0));
        is_log(&told[1], &wanted);
        assert_eq!(
            (told[2]["passes"].as_u64(), told[2]["loop_enabled"].as_bool()),
            (Some(passes), Some(false))
        );
        let reach = told[2]["reach_mm"].as_f64().expect("a distance");
        assert!((reach - passes as f64 * pass_mm()).abs() < 1e-6, "{reach}");
    }
}

/// C40-EX03, C40-053: a log around the loop has its entry, its repetition and its exit.
#[test]
fn c40_ex03_is_logged_three_times() {
    let lines = format!(
        "N050 G1 X0 Y0 F1000\nN060 #CONTOUR LOOKAHEAD LOG ON [PARAM=1]\nN070 #RT WHILE\n{KITE}N130 #RT ENDWHILE\n\
         N140 #CONTOUR LOOKAHEAD LOG OFF [PARAM=8]\nN150 M30\n"
    );
    let right = std::f64::consts::FRAC_PI_2;
    for passes in [3u32, 5] {
        let plc = written("ex03.plc", &format!("0 loop {passes}\nend log 0\n"));
        let told = answers(&example("C40-EX03_outside_rt_loop", &lines), &plc, &[]);
        let mut wanted = vec![(3, 60, 0.0, 1.0, 0.0)];
        wanted.extend(pass(0.0, 0.0));
        wanted.extend(pass(pass_mm(), right));
        wanted.extend(pass(f64::from(passes - 1) * pass_mm(), right));
        wanted.push((5, 140, f64::from(passes) * pass_mm(), 8.0, 0.0));
        is_log(&told[1], &wanted);
    }
}

fn refused(arguments: &[&str]) -> String {
    let output = glidepath(arguments);
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(1), "{told}");
    told
}

/// A loop that nothing ends is told before it runs; one that nothing begins is left out, and that is told.
#[test]
fn a_loop_without_end_or_beginning_is_told() {
    let program =
        written("loop.nc", &format!("G1 X0 Y0 F1000\nN60 #RT WHILE\n{KITE}#RT ENDWHILE\nG1 X9\nM30\n"));
    for text in ["0 loop on\n", "0 loop 2\n0.5 loop on\n", "0 loop on\n1 reach\n"] {
        let told = refused(&["run", &program, "--plc", &written("on.plc", text), "--answers", "-"]);
        assert!(
            told.contains("does not end") && told.contains("loop.nc:2:") && told.contains("loop off"),
            "{told}"
        );
    }
    let output = glidepath(&["run", &program]);
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success() && told.contains("left out") && told.contains("loop.nc:2:"), "{told}");
    // By the clock: the pass at hand is the last one. 300 mm of path in 18 s at F1000.
    let plc = written("off.plc", "0 loop on\n6 loop off\nend reach\n");
    let told = answers(&program, &plc, &[]);
    let passes = told[2]["passes"].as_u64().expect("a number");
    assert!((4..=7).contains(&passes), "{told:?}");
    // An abort ends it, too.
    let events = written("abort.events", "3 abort\n");
    let told = answers(&program, &written("on.plc", "0 loop on\nend reach\n"), &["--events", &events]);
    assert_eq!(told[1]["loop_enabled"], true);
    let few = refused(&[
        "run",
        &program,
        "--plc",
        &written("many.plc", "0 loop 9999\n"),
        "--answers",
        "-",
        "--max-commands",
        "99",
    ]);
    assert!(few.contains("--max-commands"), "{few}");
}

/// P-STUP-00033 says how many commands a loop may have. Row: C40-054.
#[test]
fn storage_bounds_a_loop() {
    let lines: String = (0..40).map(|i| format!("X{}\n", i % 2)).collect();
    let program = written("long.nc", &format!("G1 X0 F1000\n#RT WHILE\n{lines}X0\n#RT ENDWHILE\nM30\n"));
    let machine = |bytes: u32| {
        let text = format!("startup.fb_storage_size = {bytes}\n[axis.X]\ntype = \"linear\"\n");
        written(&format!("storage{bytes}.toml"), &text)
    };
    for command in ["check", "run"] {
        let told = refused(&[command, &program, "--machine", &machine(1024)]);
        assert!(told.contains("has more than") && told.contains("P-STUP-00033"), "{told}");
        let told = refused(&[command, &program, "--machine", &machine(0)]);
        assert!(told.contains("no storage") && told.contains("P-STUP-00033"), "{told}");
        let output = glidepath(&[command, &program, "--machine", &machine(100_000)]);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    }
}

/// V.E. from the command line, the machine file and the PLC; V.P. and V.L. beside them.
#[test]
fn variables_come_from_outside() {
    let text = "G01 X10 F6000\n#FLUSH WAIT\nV.P.A = V.E.STEP\nV.L.B = 1\n$IF V.E.DEEP > 2\nX[V.P.A+V.L.B]\n$ELSE\nX30\n$ENDIF\n\
        V.E.DONE = 1\nM30\n";
    let program = written("variables.nc", text);
    let at_end = |more: &[&str], plc: &str| {
        let told = answers(&program, &written("variables.plc", plc), more);
        told.iter().map(|line| line["value"].as_f64().or(line["distance_mm"].as_f64())).collect::<Vec<_>>()
    };
    let set = ["--set", "STEP=20", "--set", "v.e.deep=1.5", "--set", "DONE=FALSE"];
    assert_eq!(at_end(&set, "end variable DONE\nend reach\n"), [Some(1.0), Some(30.0)]);
    // Before the motion has come to the line.
    assert_eq!(at_end(&set, "0.02 set DEEP 3\nend reach\n"), [Some(3.0), Some(21.0)]);
    // Too late.
    assert_eq!(at_end(&set, "0.4 set DEEP 3\nend reach\n")[1], Some(30.0));
    let told = refused(&["run", &program, "--set", "STEP=20"]);
    assert!(told.contains("variables.nc:5:") || told.contains("variables.nc:10:"), "{told}");
    let machine = written(
        "variables.toml",
        "[variables]\nSTEP = 20\nDEEP = 2.5\nDONE = false\n[axis.X]\ntype = \"linear\"\n",
    );
    for command in ["check", "run"] {
        let output = glidepath(&[command, &program, "--machine", &machine]);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    }
    for wrong in ["\"A B\" = 1", "A = \"x\"", "A = 1\na = 2", "A = inf"] {
        let file = written("wrong.toml", &format!("[variables]\n{wrong}\n[axis.X]\ntype = \"linear\"\n"));
        let told = refused(&["run", &program, "--machine", &file]);
        assert!(told.contains("wrong.toml:"), "{told}");
    }
}

/// What comes too late for the program is told, as is what is not there for such programs.
#[test]
fn late_requests_and_other_options_are_told() {
    let program = written("short.nc", "G01 X1 F6000\nM30\n");
    let plc = written("late.plc", "0 reach\n99 reach\nend reach\n");
    let output = glidepath(&["run", &program, "--plc", &plc, "--answers", "-"]);
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(told.contains("ends before this request") && told.contains("late.plc:2:"), "{told}");
    assert_eq!(String::from_utf8_lossy(&output.stdout).lines().count(), 2);
    let looped = written("some.nc", &format!("G1 X0 Y0 F1000\n#RT WHILE\n{KITE}#RT ENDWHILE\nM30\n"));
    for options in [&["--smooth", "0.1"][..], &["--why", "always"]] {
        let told = refused(&[&["run", &looped], options].concat());
        assert!(told.contains("real-time loops") && told.contains(options[0]), "{told}");
    }
    for (text, place, word) in [
        ("0 set\n", ":1:6", "the name of a variable"),
        ("0 set A\n", ":1:8", "a number"),
        ("0 set A 1e999\n", ":1:9", "a number"),
        ("0 loop\n", ":1:7", "on, off"),
        ("0 loop 0\n", ":1:8", "on, off"),
        ("end loop on\n", ":1:5", "a question"),
        ("end reach\n1 reach\n", ":2:1", "times ascend"),
    ] {
        let told = refused(&["run", &program, "--plc", &written("wrong2.plc", text), "--answers", "-"]);
        assert!(told.contains(place) && told.contains(word), "{text}: {told}");
    }
}

/// The firmware in the emulator changes the power at the same ticks: `LASER_POWER` of hil-tests/cases.
#[test]
fn the_laser_changes_at_the_ticks_of_the_firmware() {
    let answers = answers(&shipped("programs/laser.nc"), &shipped("programs/laser.plc"), &[]);
    let told: Vec<(u64, u64)> = answers
        .iter()
        .filter_map(|line| Some((line["tick"].as_u64()?, line["laser_percent"].as_u64()?)))
        .collect();
    let cases = fs::read_to_string(shipped("hil-tests/cases/src/plc.rs")).expect("the cases");
    let list =
        cases.split_once("LASER_POWER: ").and_then(|(_, rest)| rest.split_once("] =")).expect("a list").1;
    let list = list.split_once("];").expect("its end").0;
    let numbers: Vec<u64> =
        list.split(|c: char| !c.is_ascii_digit()).filter_map(|text| text.parse().ok()).collect();
    let wanted: Vec<(u64, u64)> = numbers.chunks_exact(2).map(|pair| (pair[0], pair[1])).collect();
    assert_eq!(told, wanted);
}

/// `check --plc`: mistakes of the file with their place, variables that only the PLC names, and functions that the machine
/// data do not enable. With --plan the PLC acts.
#[test]
fn check_reads_the_requests() {
    let program = written("checked.nc", "G01 X10 F6000\n#FLUSH WAIT\nX[V.E.STEP]\nM30\n");
    assert!(refused(&["check", &program]).contains("checked.nc:3:"));
    let plc = written("checked.plc", "0 set STEP 20\n0.1 state 0.01\n0.2 log 0\n0.3 standstill\n9 feed\n");
    let told = |more: &[&str]| {
        let output = glidepath(&[&["check", &program, "--plc", &plc], more].concat());
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8_lossy(&output.stderr).into_owned()
    };
    assert_eq!(told(&[]), "");
    let late = told(&["--plan"]);
    assert!(late.contains("checked.plc:5:1") && late.contains("ends before this request"), "{late}");
    let machine = |text: &str| {
        written(
            "checked.toml",
            &format!("channel.prog_start.slope.profile = 1\n{text}\n[axis.X]\ntype = \"linear\"\n"),
        )
    };
    let plain = told(&["--machine", &machine("")]);
    for (place, name) in [
        ("checked.plc:2:1", "FCT_CALC_STATE_AT_T"),
        ("checked.plc:3:1", "FCT_CONTOUR_LAH"),
        ("checked.plc:4:1", "FCT_CALC_POS_V_0"),
        ("checked.plc:5:1", "FCT_CALC_TIME"),
    ] {
        assert!(plain.contains(place) && plain.contains(name), "{plain}");
    }
    let enabled = "channel.configuration.interpolator.function = \"FCT_IPO_DEFAULT|FCT_CONTOUR_LAH|FCT_CALC_TIME|\
        FCT_CALC_STATE_AT_T|FCT_CALC_POS_V_0\"";
    let stored = told(&["--machine", &machine(enabled)]);
    assert!(stored.contains("P-STUP-00033") && stored.matches("warning").count() == 1, "{stored}");
    let wrong = written("wrong-check.plc", "0 set STEP 20\n1 reeach\n2 elements 1\n");
    let told = refused(&["check", &program, "--plc", &wrong]);
    assert!(told.contains(":2:3") && told.contains("is reach meant?") && told.contains(":3:13"), "{told}");
    assert!(refused(&["check", &program, "--plc", "no-such-file.plc"]).contains("no-such-file.plc"));
}

/// P-CHAN-00070 and P-CHAN-00033 in a machine file: M96 comes 10 mm before X40 of a run. Row: C40-064.
#[test]
fn a_machine_file_shifts_functions() {
    let program = written("shift.nc", "N10 G01 X20 F6000\nN20 X40\nN30 M96\nN40 X60\nM30\n");
    let machine = |functions: &str, tables: &str| {
        let text = format!(
            "[channel]\nconfiguration.interpolator.function = \"FCT_IPO_DEFAULT{functions}\"\n\
             prog_start.late_sync_ready = 1\n{tables}[axis.X]\ntype = \"linear\"\n"
        );
        written("shift.toml", &text)
    };
    let tables = "[channel.m_synch]\n96 = \"MEP_SVS\"\n[channel.m_pre_outp]\n96 = 100000\n";
    let right = machine("|FCT_SHIFT_NCBL", tables);
    let output = glidepath(&["run", &program, "--machine", &right]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    for (functions, tables, expected) in [
        ("", tables, "FCT_SHIFT_NCBL"),
        ("|FCT_SHIFT_NCBL", "[channel.m_pre_outp]\n96 = 1\n", "MEP_SVS or MEP_MOS"),
        ("|FCT_SHIFT_NCBL", "[channel.h_pre_outp]\n96 = -1\n", "shift.toml:5:6"),
        ("|FCT_SHIFT_NCBL", "[channel.m_pre_outp]\n96 = 2000000001\n", "0…2000000000"),
        ("|FCT_SHIFT_NCBL", "[channel.m_pre_outp]\n1000 = 1\n", "0…999"),
        ("|FCT_SYNC", "", "FCT_SYNC"),
    ] {
        let told = refused(&["check", &program, "--machine", &machine(functions, tables)]);
        assert!(told.contains(expected), "{told}");
    }
}

/// The # commands of the examples run, in one program; those of the transformation in the shipped one. Row: NC-009.
#[test]
fn every_hash_command_of_the_examples_runs() {
    let text = "#SLOPE [TYPE=TRAPEZ]\n#SLOPE DEFAULT\n#SET SLOPE PROFIL[1]\n#FILTER [AX_DEV=0.5]\n#FILTER OFF\n\
        #VECTOR LIMIT ON [VEL=5000 ACC=5000 DEC=5000]\nN10 G01 X10 F6000\n#VECTOR LIMIT OFF ALL\n\
        #CONTOUR MODE [DEV PATH_DEV=0.1]\nG261\nN20 Y10\nN30 X20\nG260\n#HSC ON [OPMODE=1 CONTERROR=0.1]\nN40 Y20\nN45 X25\n\
        #HSC OFF\n#AKIMA TRANS [START=TANGENTIAL END=TANGENTIAL]\n#SPLINE ON\nN50 X30 Y25\nN60 X40 Y20\nN70 X50 Y25\n\
        #SPLINE OFF\n#DISTANCE PROG START CLEAR\n#CONTOUR LOOKAHEAD LOG ON\nN80 X60\n#CONTOUR LOOKAHEAD LOG OFF\n\
        #CONTOUR LOOKAHEAD LOG CLEAR\n#FLUSH&WAIT\nN90 X70 Y0\n#RT WHILE\nN100 X80\nN110 X70\n#RT ENDWHILE\nN120 X0\n\
        #PUT AX [Z]\nM30\n";
    let told = answers(&written("hash.nc", text), &written("hash.plc", "0 loop 2\nend reach\n"), &[]);
    let distance = told[1]["distance_mm"].as_f64().expect("a number");
    // From N80 on: 10 mm, N90, two passes of 20 mm, N120.
    let wanted = 10.0 + 10f64.hypot(25.0) + 40.0 + 70.0;
    assert!((distance - wanted).abs() < 1e-6, "{told:?}");
    let machine = shipped("boards/host/machines/ca-head.toml");
    let output = glidepath(&["run", &shipped("programs/tip.nc"), "--machine", &machine]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

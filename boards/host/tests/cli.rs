//! The command line: exit codes, messages, and files that are or are not written.
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn glidepath(arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_glidepath"));
    command.args(arguments).output().expect("the simulator starts")
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// An empty directory of this test's own.
fn directory(name: &str) -> PathBuf {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = fs::remove_dir_all(&path);
    fs::create_dir_all(&path).expect("a directory for the test");
    path
}

fn file(directory: &Path, name: &str, content: &[u8]) -> String {
    let path = directory.join(name);
    fs::write(&path, content).expect("a file for the test");
    path.to_str().expect("a path of plain characters").to_owned()
}

fn shipped(path: &str) -> String {
    format!("{}/{path}", env!("CARGO_MANIFEST_DIR"))
}

/// Runs, expects a refusal, and returns its message.
fn refusal(arguments: &[&str]) -> String {
    let output = glidepath(arguments);
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
    assert!(output.stdout.is_empty(), "{}", String::from_utf8_lossy(&output.stdout));
    stderr(&output)
}

#[test]
fn usage_errors_have_their_own_exit_code() {
    for arguments in [&[][..], &["run"], &["walk", "a.nc"], &["run", "a.nc", "--plot", "a.gif"]] {
        let output = glidepath(arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {}", stderr(&output));
    }
    assert!(stderr(&glidepath(&["run", "a.nc", "--plot", "a.gif"])).contains(".svg or .png"));
    assert_eq!(glidepath(&["--help"]).status.code(), Some(0));
}

#[test]
fn check_counts_what_it_decoded() {
    let output = glidepath(&["check", &shipped("tests/programs/shapes.nc")]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(text.contains("8 motion blocks (4 arcs), 1 dwell, 0 warnings"), "{text}");
}

#[test]
fn a_missing_program_is_named() {
    let text = refusal(&["run", "no such program.nc"]);
    assert!(text.starts_with("error: cannot read no such program.nc: "), "{text}");
}

#[test]
fn refusals_show_line_and_caret() {
    let directory = directory("caret");
    let program = file(&directory, "caret.nc", b"%caret\r\nN10 G01 X1 F600\r\nN20 G01 X[1+] Y2\r\n");
    let text = refusal(&["check", &program]);
    let lines: Vec<&str> = text.lines().collect();
    let column: usize = lines[1].rsplit(':').next().and_then(|column| column.parse().ok()).expect("a column");
    assert_eq!(lines[1], format!(" --> {program}:3:{column}"), "{text}");
    assert_eq!(lines[3], "3 | N20 G01 X[1+] Y2", "{text}");
    assert_eq!(lines[4].find('^'), Some(4 + column - 1), "{text}");
    assert!(lines[4].contains("expected "), "{text}");
}

#[test]
fn any_bytes_are_a_program_that_is_refused_in_text() {
    let directory = directory("bytes");
    let mut noise = b"%noise\nN10 G01 X1 F600 ".to_vec();
    noise.extend((0..=255).rev());
    let cases: [(&str, &[u8], &str); 4] = [
        ("latin1.nc", b"%a\nN10 G01 X1 F600\nN20 \xfcber\n", "latin1.nc:3:5"),
        ("nul.nc", b"%a\nN10 G01 X1 F600\nN20 \0\n", "nul.nc:3:5"),
        ("noise.nc", &noise, "noise.nc:2:17"),
        ("utf16.nc", b"\xff\xfe%\0a\0\n\0", "utf16.nc:1:1"),
    ];
    for (name, content, place) in cases {
        let text = refusal(&["run", &file(&directory, name, content)]);
        assert!(text.contains(place), "{text}");
        let odd = text.chars().find(|character| character.is_control() && *character != '\n');
        assert_eq!(odd, None, "{text:?}");
    }
}

#[test]
fn a_refused_program_leaves_no_file() {
    let directory = directory("refused");
    let program = file(&directory, "a.nc", b"%a\nN10 G01 X10 F600\nN20 G01 X20\nN30 G01 QQ\n");
    let outputs = ["t.csv", "s.json", "c.json", "p.svg"].map(|name| file(&directory, name, b"as it was"));
    let [trace, summary, contour, plot] = &outputs;
    let arguments = ["--trace", trace, "--summary", summary, "--contour", contour, "--plot", plot];
    let text = refusal(&[&["run", &program][..], &arguments].concat());
    assert!(text.contains("a.nc:4:"), "{text}");
    for output in &outputs {
        assert_eq!(fs::read(output).expect("it was there before"), b"as it was");
    }
    let names = fs::read_dir(&directory).expect("the directory is there").count();
    assert_eq!(names, 5, "nothing but the program and the four old files");
}

#[test]
fn outputs_that_cannot_be_written_are_named() {
    let directory = directory("unwritable");
    let program = file(&directory, "a.nc", b"%a\nN10 G01 X10 F600\nM30\n");
    let nowhere = directory.join("nowhere").join("t.csv");
    let nowhere = nowhere.to_str().expect("a path of plain characters");
    let text = refusal(&["run", &program, "--trace", nowhere]);
    assert!(text.starts_with(&format!("error: cannot write {nowhere}: ")), "{text}");
    let itself = refusal(&["run", &program, "--summary", &program]);
    assert!(itself.contains("reads or writes it already"), "{itself}");
    let one = directory.join("one").to_str().expect("a path of plain characters").to_owned();
    let twice = refusal(&["run", &program, "--summary", &one, "--contour", &one, "--trace", &one]);
    assert!(twice.contains("reads or writes it already"), "{twice}");
    // Another way to the same file, which is not there yet.
    let two = directory.join("two").to_str().expect("a path of plain characters").to_owned();
    let around = directory.join("..").join(directory.file_name().expect("a name")).join("two");
    let around = around.to_str().expect("a path of plain characters");
    let twice = refusal(&["run", &program, "--summary", &two, "--contour", around]);
    assert!(twice.contains("reads or writes it already"), "{twice}");
    assert!(!Path::new(&one).exists());
    if cfg!(target_os = "linux") {
        let full = refusal(&["run", &program, "--summary", "/dev/full"]);
        assert!(full.contains("cannot write /dev/full"), "{full}");
    }
}

/// Rows: D3-236, CF-35.
#[test]
fn shipped_machines_are_accepted() {
    let directory = directory("machines");
    let program = file(&directory, "a.nc", b"%a\nN10 G01 X10 F600\nM30\n");
    let transformed = ["ca-head", "bc-trunnion", "ac-table", "head-table", "rotary-table"];
    for machine in ["default", "five-axis", "handling", "bench"].into_iter().chain(transformed) {
        let machine = shipped(&format!("machines/{machine}.toml"));
        let output = glidepath(&["check", &program, "--machine", &machine]);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    }
}

/// The whole message for a machine file that is wrong in one place.
fn machine_refusal(name: &str, content: &str) -> String {
    let directory = directory(name);
    let program = file(&directory, "a.nc", b"%a\nM30\n");
    let machine = file(&directory, "m.toml", content.as_bytes());
    refusal(&["run", &program, "--machine", &machine])
}

/// Rows: C40-060, CF-14.
#[test]
fn machine_files_are_refused_with_line_name_value_and_range() {
    let cases = [
        ("range", "[channel]\ncycle_us = 99\n[axis.X]\n", 2, &["channel.cycle_us = 99", "100…10000 µs"][..]),
        (
            "type",
            "[axis.X]\nvb_eilgang = \"fast\"\n",
            2,
            &["P-AXIS-00209", "\"fast\"", "an integer, 1…2000000000 µm/s"],
        ),
        ("whole", "[axis.X.dynamik]\na_max = 6000.0\n", 2, &["P-AXIS-00008", "6000.0", "an integer"]),
        (
            "unknown",
            "[axis.X]\n[axis.X.dynamik]\namax = 1\n",
            3,
            &["unknown parameter axis.X.dynamik.amax", "`dynamik.a_max`"],
        ),
        (
            "table",
            "[axis.X]\na_beschl = 1\n",
            2,
            &["unknown parameter axis.X.a_beschl", "`slope_profil.a_beschl`"],
        ),
        (
            "kind",
            "[axis.X]\ntype = \"rotatory\"\n",
            2,
            &["\"rotatory\"", "\"linear\", \"rotary\" or \"spindle\""],
        ),
        (
            "later",
            "[channel.vector]\nradial_acceleration = 5\n",
            2,
            &["(P-CHAN-00361) is known, not available in this version"],
        ),
        (
            "synch-later",
            "[axis.X]\n[channel.m_synch]\n25 = \"MNE_SNS\"\n",
            3,
            &["m_synch[25] (P-CHAN-00041) = MNE_SNS is known, not available in this version", "MVS_SNS"],
        ),
        (
            "synch-unknown",
            "[axis.X]\n[channel.h_synch]\n25 = 3\n",
            3,
            &["h_synch[25] (P-CHAN-00027) = 3: no synchronisation", "NO_SYNCH, MOS, MVS_SVS"],
        ),
        (
            "synch-number",
            "[axis.X]\n[channel.h_synch]\nM25 = 2\n",
            3,
            &["h_synch[M25] (P-CHAN-00027): no number of a function", "0…999"],
        ),
        (
            "mode",
            "[axis.X]\n[channel]\noverride_weight_prog_feed = 3\n",
            3,
            &["(P-CHAN-00066) = 3: out of range", "0…2"],
        ),
        (
            "stage",
            "[axis.X.lslope_profil]\na_stufe_2 = 1001\n",
            2,
            &["(P-AXIS-00012) = 1001: out of range", "1…1000 mm/s², limited by dynamik.a_max"],
        ),
        (
            "braking-stage",
            "[axis.X.lslope_profil]\nd_grenz_stufe_1 = 1001\n",
            2,
            &["(P-AXIS-00280) = 1001: out of range", "0…1000 mm/s², limited by dynamik.a_max"],
        ),
        (
            "change-over",
            "[axis.X.lslope_profil]\nvb_stufe_1_2 = 300000\n",
            2,
            &["(P-AXIS-00221) = 300000: out of range", "1…200000 µm/s, limited by dynamik.vb_max"],
        ),
        (
            "change-over-default",
            "[axis.X]\nvb_eilgang = 50_000\ndynamik.vb_max = 50_000\n[axis.X.lslope_profil]\nvb_grenz_stufe_1_2 = 100000\n",
            5,
            &["(P-AXIS-00211) = 100000: out of range", "1…50000 µm/s, limited by dynamik.vb_max"],
        ),
        (
            "rapid-ramp",
            "[axis.X.slope_profil]\ntr_grenz = 1\n",
            2,
            &["(P-AXIS-00200) = 1: out of range", "10000…4294967295 µs, limited by dynamik.tr_min"],
        ),
        (
            "reduced",
            "[axis.X]\nvb_max_red = 200001\n",
            2,
            &["(P-AXIS-00214) = 200001: out of range", "0…200000 µm/s, limited by dynamik.vb_max"],
        ),
        (
            "weighted-ramp",
            "[axis.X.dynamik]\ntr_w_min = 9999\n",
            2,
            &["(P-AXIS-00293) = 9999: out of range", "10000…50000 µs"],
        ),
        (
            "jerk-weight",
            "[axis.X.dynamik]\nr_trans_weight = 1001\n",
            2,
            &["(P-AXIS-00154) = 1001: out of range", "0…1000 0.1 %"],
        ),
        (
            "unit",
            "[axis.X]\n[channel.vector]\nacc_dec_unit = \"MM_S\"\n",
            3,
            &["(P-CHAN-00351): unknown word \"MM_S\"", "\"MM_M2\" or \"MM_S2\""],
        ),
        (
            "vector",
            "[axis.X]\n[channel.vector]\nvelocity = -1\n",
            3,
            &["(P-CHAN-00090) = -1: out of range", "0…2000000000 mm/min"],
        ),
        (
            "jerk",
            "[axis.X]\n[channel]\ncorr_v_trans_jerk = 2\n",
            3,
            &["(P-CHAN-00009) = 2: out of range", "0…1 (0 off, 1 on)"],
        ),
        (
            "weighted",
            "[axis.X]\n[channel.prog_start.slope]\nramp_time = 5\n",
            3,
            &["(P-CHAN-00073) = 5: out of range", "0…4"],
        ),
        ("filter", "[axis.X.filter_fir]\norder = 201\n", 2, &["(P-AXIS-00587) = 201", "0…200"]),
        ("depends", "[axis.X]\nvb_eilgang = 300000\n", 2, &["= 300000", "1…200000 µm/s", "dynamik.vb_max"]),
        (
            "default",
            "[axis.X]\n[axis.X.dynamik]\na_max = 900\n",
            3,
            &["a_beschl (P-AXIS-00001) = 1000 (the default)", "1…900 mm/s²"],
        ),
        (
            "deep",
            "[channel]\nlook_ahead = 9999\n[axis.X]\n",
            2,
            &["channel.look_ahead (P-STUP-00071) = 9999", "10…500 blocks"],
        ),
        (
            "shallow",
            "[channel]\nlook_ahead = 9\n[axis.X]\n",
            2,
            &["(P-STUP-00071) = 9: out of range", "10…500 blocks"],
        ),
        (
            "slopes",
            "[axis.X]\n[channel.prog_start.slope]\nprofile = 7\n",
            3,
            &["(P-CHAN-00071) = 7: out of range", "0…3", "0 STEP, 1 TRAPEZ, 2 SIN2, 3 HSC"],
        ),
        (
            "decimals",
            "[channel]\nprog_start.feedrate_factor = 0.0625\n[axis.X]\n",
            2,
            &["0.0625", "three decimals"],
        ),
        ("name", "[axis.\"1X\"]\n", 1, &["`1X` cannot be the name of an axis"]),
        ("twice", "[axis.X]\n[axis.x]\n", 2, &["axis X is there already"]),
        (
            "address",
            "[axis.X]\n[axis.F1]\n",
            2,
            &["axis F1: F is an address of the language", " a name that begins with A, B, C, O, Q"],
        ),
        ("top", "[axes.X]\n", 1, &["unknown table `axes`", "`axis`"]),
        ("syntax", "[axis.X]\nvb_eilgang =\n", 2, &["not a TOML file"]),
    ];
    for (name, content, line, expected) in cases {
        let text = machine_refusal(name, content);
        assert!(text.contains(&format!("m.toml:{line}:")), "{name}: {text}");
        for part in expected {
            assert!(text.contains(part), "{name}: {part} not in {text}");
        }
        assert_eq!(text.matches("error").count(), 1, "{name}: {text}");
    }
    let slope = "[channel.prog_start.slope]\nprofile = 1\n";
    assert!(machine_refusal("empty", slope).contains("a machine needs an axis"));
    let seven: String = ('A'..='G').map(|letter| format!("[axis.{letter}]\n")).collect();
    assert!(machine_refusal("seven", &seven).contains("7 axes: this simulator is built for 1 to 6"));
}

/// The worked value of P-AXIS-00212, and a ramp shorter than a cycle: taken, and it is said what is planned with.
#[test]
fn machine_data_beyond_a_tick_are_warned_of() {
    let directory = directory("beyond-a-tick");
    let program = file(&directory, "a.nc", b"%a\nN10 G01 X10 F600\nM30\n");
    let text = "[channel.prog_start.slope]\nprofile = 1\n[axis.X.dynamik]\nvb_max = 60_000_000\ntr_min = 400\n\
        [axis.X.slope_profil]\ntr_grenz = 400\n";
    let machine = file(&directory, "m.toml", text.as_bytes());
    for command in ["check", "run"] {
        let output = glidepath(&[command, &program, "--machine", &machine]);
        let text = stderr(&output);
        assert_eq!(output.status.code(), Some(0), "{text}");
        for expected in [
            "axis.X.dynamik.vb_max (P-AXIS-00212) = 60000000: planned with 16000000 µm/s",
            "limited by cycle_us: at most 16 mm per tick",
            "axis.X.dynamik.tr_min (P-AXIS-00201) = 400: planned with 1000 µs",
            "axis.X.slope_profil.tr_grenz (P-AXIS-00200) = 400: planned with 1000 µs",
            "m.toml:4:",
        ] {
            assert!(text.contains(expected), "{expected}\n{text}");
        }
        assert_eq!(text.matches("warning").count(), 3, "{text}");
    }
}

#[test]
fn options_in_place_of_machine_data_are_checked_alike() {
    let directory = directory("overrides");
    let program = file(&directory, "a.nc", b"%a\nN10 G01 X10 F600\nM30\n");
    // STEP, which is ISG's default, and a look-ahead that no version of this simulator has memory for.
    let bare = file(&directory, "bare.toml", b"[channel]\nlook_ahead = 9000\n[axis.X]\n");
    for (slope, profile) in [("step", 0), ("trapez", 1), ("sin2", 2), ("hsc", 3)] {
        let text = format!("[channel.prog_start.slope]\nprofile = {profile}\n[axis.X]\n");
        let machine = file(&directory, "m.toml", text.as_bytes());
        let by_file = glidepath(&["check", &program, "--machine", &machine]);
        let by_option =
            glidepath(&["check", &program, "--machine", &bare, "--slope", slope, "--look-ahead", "60"]);
        assert_eq!(by_file.status.code(), by_option.status.code(), "{slope}: {}", stderr(&by_option));
        if by_file.status.code() == Some(1) {
            let (by_file, by_option) = (stderr(&by_file), stderr(&by_option));
            let message =
                |text: &str| text.lines().next()?.split_once("channel.").map(|(_, it)| it.to_owned());
            assert!(
                message(&by_file).is_some_and(|it| message(&by_option) == Some(it)),
                "{by_file}{by_option}"
            );
            assert!(by_option.starts_with("error: --slope: channel.prog_start.slope.profile"), "{by_option}");
        }
    }
    for depth in ["9", "501"] {
        let text = refusal(&["run", &program, "--look-ahead", depth]);
        let expected = format!("--look-ahead: channel.look_ahead (P-STUP-00071) = {depth}: out of range");
        assert!(text.contains(&expected) && text.contains("10…500 blocks"), "{text}");
    }
    let unknown = glidepath(&["run", &program, "--slope", "square"]);
    assert_eq!(unknown.status.code(), Some(2));
    assert!(stderr(&unknown).contains("step, trapez, sin2, hsc"), "{}", stderr(&unknown));
}

#[test]
fn events_are_refused_with_line_column_word_and_what_was_expected() {
    let directory = directory("events-refused");
    let program = file(&directory, "a.nc", b"%a\nN10 G01 X10 F600\nM30\n");
    let cases = [
        ("soon abort", "1:1", "`soon`", "a time in seconds"),
        (
            "; first\r\n 0.5 halt",
            "2:6",
            "`halt`",
            "override, feedhold, resume, abort, reduced, starve, stall or ack",
        ),
        ("0.5 resum", "1:5", "`resum`", "is resume meant?"),
        ("0.5 # nothing", "1:4", "the event is missing", "override, feedhold"),
        ("0.5 override 200.1", "1:14", "`200.1`", "percent, 0…200"),
        ("0.5 override 99.95", "1:14", "`99.95`", "one decimal at most"),
        ("0.5 reduced", "1:12", "on or off is missing", "on or off"),
        ("0.5 starve 0", "1:12", "`0`", "seconds without program text, above 0"),
        ("0.5 ack S3", "1:9", "`S3`", "an M or H function"),
        ("0.5 feedhold now", "1:14", "`now`", "the end of the line"),
        ("2 feedhold\n1.5 resume", "2:1", "a time before the one above", "2 of line 1 or later"),
    ];
    for (text, place, word, expected) in cases {
        let events = file(&directory, "e.txt", text.as_bytes());
        let told = refusal(&["run", &program, "--events", &events]);
        assert!(told.contains(&format!(" --> {events}:{place}\n")), "{text}: {told}");
        assert!(told.contains(word) && told.contains(expected), "{text}: {told}");
        assert_eq!(told.matches("error").count(), 1, "{text}: {told}");
    }
    let two = file(&directory, "e.txt", b"1 halt\n2 resume\n3 stop\n");
    assert_eq!(refusal(&["run", &program, "--events", &two]).matches("error").count(), 2);
    // No output takes the place of the file.
    let good = file(&directory, "e.txt", b"0 override 50\n");
    let kept = refusal(&["run", &program, "--events", &good, "--trace", &good]);
    assert!(kept.contains("reads or writes it already"), "{kept}");
    assert!(refusal(&["run", &program, "--events", "no such file"]).contains("cannot read no such file"));
}

#[test]
fn called_files_lie_beside_the_program() {
    let directory = directory("called");
    file(&directory, "outer.nc", b"%outer\nN20 G01 X2 F600\nL inner.nc\nM17\n");
    file(&directory, "inner.nc", b"N30 G01 X3\n");
    let program = file(&directory, "main.nc", b"%main\nN10 G00 X1\nL outer\nL \"inner\"\nN40 G01 X4\nM30\n");
    let summary = directory.join("summary.json");
    let output = glidepath(&["run", &program, "--summary", summary.to_str().expect("plain characters")]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let output = glidepath(&["check", &program]);
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    // Standing still at X3 a second time is no motion.
    assert!(text.contains("4 motion blocks"), "{text}");

    let program = file(&directory, "gone.nc", b"N10 G00 X1\nL outer.nc\nL gone_astray\n");
    let refused = refusal(&["run", &program]);
    assert!(refused.contains("no file \"gone_astray\" to call"), "{refused}");
    assert!(refused.contains("gone.nc:3:3"), "{refused}");
    assert!(refused.contains("expected the name of a program file"), "{refused}");
}

#[test]
fn refusals_in_called_files_show_that_file() {
    let directory = directory("called-refused");
    file(&directory, "decoded.nc", b"%decoded\n(text)\nN30 G01 X3 F600 Q5\n");
    file(&directory, "planned.nc", b"\n\nN30 G01 X3 F600\nN40 G95 F1\n");
    for (name, place, line) in
        [("decoded", "decoded.nc:3:17", "N30 G01 X3 F600 Q5"), ("planned", "planned.nc:4:5", "N40 G95 F1")]
    {
        let program = file(&directory, "main.nc", format!("N10 G00 X1\nL {name}\n").as_bytes());
        for command in ["run", "check"] {
            let text = refusal(&[command, &program]);
            assert!(text.contains(place) && text.contains(line), "{text}");
        }
    }
}

/// What the decoder accepts and the planner refuses: one answer.
#[test]
fn check_refuses_what_run_refuses() {
    let directory = directory("one-answer");
    let machine = file(
        &directory,
        "m.toml",
        b"[axis.X.kenngr]\nswe_pos = 500000\nswe_neg = -500000\n[axis.Y]\n[axis.Z]\n",
    );
    for (k, line) in
        ["E500", "D1", "G93 F2 X5", "G95 F0.1 X5", "G02 X10 Y0 I1 J5", "X60", "G04 S5", "X10 F0.00000001"]
            .into_iter()
            .enumerate()
    {
        let text = format!("N10 G01 X1 F600\nN20 {line}\nN30 X2\nM30\n");
        let program = file(&directory, &format!("p{k}.nc"), text.as_bytes());
        let [run, check] =
            ["run", "check"].map(|command| refusal(&[command, &program, "--machine", &machine]));
        assert!(run.contains("error") && run.contains(":2:"), "{line}: {run}");
        assert_eq!(run, check, "{line}");
    }
}

#[test]
fn lines_end_with_lf_crlf_or_cr() {
    let directory = directory("line-ends");
    let lines = ["%main", "N10 G01 X10 F600", "N20 X20 Q5", "M30", ""];
    for (name, end) in [("lf", "\n"), ("crlf", "\r\n"), ("cr", "\r")] {
        let text = refusal(&["check", &file(&directory, &format!("{name}.nc"), lines.join(end).as_bytes())]);
        assert!(text.contains(&format!("{name}.nc:3:9")) && text.contains("3 | N20 X20 Q5\n"), "{text}");
        let good = lines.join(end).replace(" Q5", "");
        let output = glidepath(&["check", &file(&directory, &format!("{name}.nc"), good.as_bytes())]);
        assert!(String::from_utf8_lossy(&output.stdout).contains("2 motion blocks"), "{name}");
    }
}

#[test]
fn endless_programs_are_stopped() {
    let directory = directory("endless");
    let silent = file(&directory, "silent.nc", b"N10 G00 X1\n$WHILE 1\nP1=5\n$ENDWHILE\nM30\n");
    let moving = file(&directory, "moving.nc", b"$WHILE 1\nN10 G00 X1\nN20 X0\n$ENDWHILE\nM30\n");
    for command in ["run", "check"] {
        let text = refusal(&[command, &silent]);
        assert!(text.contains("no motion and no other command in 1000000 lines"), "{text}");
        assert!(text.contains("silent.nc:"), "{text}");
        let text = refusal(&[command, &moving, "--max-commands", "1000"]);
        let told = "goes on after 1000 commands of lines that were carried out before";
        assert!(text.contains(told) && text.contains("moving.nc:2:"), "{text}");
        assert!(text.contains("--max-commands"), "{text}");
    }
    // Without the option; backward by GOTO; one line alone.
    for (name, text) in [
        ("goto", "N10: G00 X1\nX0\n$GOTO N10\nM30\n"),
        ("alone", "$WHILE 1\nM3\n$ENDWHILE\nM30\n"),
        ("sub", "%L s\nG00 X1\nX0\nM29\n%main\n$WHILE 1\nLL s\n$ENDWHILE\nM30\n"),
    ] {
        let text = refusal(&["check", &file(&directory, &format!("{name}.nc"), text.as_bytes())]);
        assert!(text.contains("goes on after 1000000 commands of lines that were"), "{name}: {text}");
    }
    // Two lines are carried out once more.
    let twice = file(&directory, "twice.nc", b"$FOR P1=1,2,1\nN10 G00 X1\nN20 X0\n$ENDFOR\nM30\n");
    assert_eq!(glidepath(&["check", &twice, "--max-commands", "2"]).status.code(), Some(0));
    refusal(&["check", &twice, "--max-commands", "1"]);
}

/// More lines than a loop may repeat.
#[test]
fn a_long_program_is_not_endless() {
    let directory = directory("long");
    let lines: String = (1..=1_050_000).map(|i| format!("X{:.4}\n", f64::from(i) * 5e-4)).collect();
    let long = file(&directory, "long.nc", format!("G01 F60000\n{lines}M30\n").as_bytes());
    let output = glidepath(&["check", &long]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(String::from_utf8_lossy(&output.stdout).contains("1050000 motion blocks"));
}

#[test]
fn a_minute_and_more_is_told_as_a_clock_shows_it() {
    let directory = directory("clock");
    let program = |name: &str, text: &str| file(&directory, name, text.as_bytes());
    let out = |program: &str| String::from_utf8_lossy(&glidepath(&["run", program]).stdout).into_owned();
    let long = out(&program("long.nc", "G01 X10 F600\nG04 X75\nG01 X0\nM30\n"));
    assert!(long.contains(" s (0:01:17), 7"), "{long}");
    assert!(long.contains("75.000 s (0:01:15) of dwell"), "{long}");
    let short = out(&program("short.nc", "G01 X10 F600\nM30\n"));
    assert!(!short.contains("(0:"), "{short}");
}

#[test]
fn a_warning_in_a_loop_is_told_once() {
    let directory = directory("warned-once");
    let text = b"$FOR P1=1,5,1\nN10 G00 XP1 (to\n$ENDFOR\nN20 X0 (back\nM30\n";
    let output = glidepath(&["check", &file(&directory, "a.nc", text)]);
    let (told, out) = (stderr(&output), String::from_utf8_lossy(&output.stdout).into_owned());
    assert!(out.contains("2 warnings") && told.matches("comment without )").count() == 2, "{out}{told}");
    assert!(told.contains("a.nc:2:13") && told.contains("a.nc:4:8"), "{told}");
}

#[test]
fn a_called_file_is_not_overwritten_and_is_named() {
    let directory = directory("called-kept");
    let called = file(&directory, "sub.nc", b"N30 G01 Y3 F600\nN40 X4\n");
    let program = file(&directory, "main.nc", b"N10 G00 X1\nL sub\nN50 G01 Y5\nM30\n");
    for option in ["--trace", "--summary", "--contour"] {
        let text = refusal(&["run", &program, option, &called]);
        assert!(text.contains("reads or writes it already"), "{text}");
    }
    assert_eq!(fs::read(&called).expect("it is still there"), b"N30 G01 Y3 F600\nN40 X4\n");

    let summary = directory.join("s.json").to_str().expect("plain characters").to_owned();
    let output = glidepath(&["run", &program, "--summary", &summary]);
    assert!(String::from_utf8_lossy(&output.stdout).contains(&format!("line 1 of {called}")), "{output:?}");
    let text = fs::read_to_string(&summary).expect("it was asked for");
    let summary: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    let places: Vec<_> = summary["plan"].as_array().into_iter().flatten().collect();
    let places: Vec<_> =
        places.iter().map(|block| (block["line"].as_u64(), block["file"].as_str())).collect();
    let sub = Some(called.as_str());
    assert_eq!(places, [(Some(1), None), (Some(1), sub), (Some(2), sub), (Some(3), None)]);
}

#[test]
fn radius_errors_point_at_the_words_that_give_it() {
    let directory = directory("radius");
    for (arc, column, word) in
        [("G02 X10 Y10 I5 J5.1", 17, "^^^^^^^"), ("G02 X50 Y0 R3", 16, "^^"), ("G03 I0 J0", 9, "^^^^^")]
    {
        let text = format!("N10 G00 X0\nN20 {arc} F600\nM30\n");
        let text = refusal(&["run", &file(&directory, "a.nc", text.as_bytes())]);
        assert!(text.contains(&format!("a.nc:2:{column}\n")), "{arc}: {text}");
        assert!(text.contains(&format!(" {word} ")) || text.contains(&format!(" {word}\n")), "{arc}: {text}");
    }
}

#[test]
fn the_trace_can_go_to_the_standard_output() {
    let directory = directory("stdout");
    let program = file(&directory, "a.nc", b"%a\nN10 G01 X10 F600\nM30\n");
    let path = directory.join("t.csv");
    let path = path.to_str().expect("a path of plain characters");
    let to_file = glidepath(&["run", &program, "--trace", path]);
    assert_eq!(to_file.status.code(), Some(0), "{}", stderr(&to_file));
    let mut command = Command::new(env!("CARGO_BIN_EXE_glidepath"));
    let piped = command.current_dir(&directory).args(["run", &program, "--trace", "-"]).output();
    let piped = piped.expect("the simulator starts");
    assert_eq!(piped.status.code(), Some(0), "{}", stderr(&piped));
    assert!(!directory.join("-").exists(), "no file of that name");
    assert!(piped.stdout == fs::read(path).expect("it was asked for"), "the same rows and nothing else");
    assert!(stderr(&piped).contains("program time"), "{}", stderr(&piped));
    let twice = refusal(&["run", &program, "--summary", "-", "--trace", "-"]);
    assert!(twice.contains("the standard output takes one"), "{twice}");
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_standard_output_is_an_error() {
    let directory = directory("full");
    let program = file(&directory, "a.nc", b"%a\nN10 G01 X10 F600\nM30\n");
    let summary = directory.join("s.json");
    for arguments in [&["run", "--summary", summary.to_str().expect("plain characters")][..], &["check"]] {
        let full = fs::File::options().write(true).open("/dev/full").expect("a device of Linux");
        let mut command = Command::new(env!("CARGO_BIN_EXE_glidepath"));
        let output =
            command.args(arguments).arg(&program).stdout(full).output().expect("the simulator starts");
        assert_eq!(output.status.code(), Some(1), "{arguments:?}");
        assert!(stderr(&output).contains("cannot write the standard output"), "{}", stderr(&output));
    }
    assert!(!summary.exists(), "all outputs or none");
}

/// A run that is broken off while it writes, by Ctrl-C or otherwise, leaves nothing behind.
#[cfg(unix)]
#[test]
fn a_run_broken_off_leaves_no_files() {
    let directory = directory("broken-off");
    let program = file(&directory, "long.nc", b"%long\nN10 G01 X1 F600\nN20 G04 X50000\nM30\n");
    let trace = directory.join("t.csv");
    let mut command = Command::new(env!("CARGO_BIN_EXE_glidepath"));
    let mut child = command
        .args(["run", &program, "--trace"])
        .arg(&trace)
        .stderr(std::process::Stdio::null())
        .spawn()
        .expect("the simulator starts");
    std::thread::sleep(std::time::Duration::from_millis(500));
    assert!(child.try_wait().expect("a child").is_none(), "it is still at work");
    child.kill().expect("it can be killed");
    child.wait().expect("a child");
    let entries = fs::read_dir(&directory).expect("a directory").flatten();
    let left: Vec<_> = entries.map(|entry| entry.file_name()).collect();
    assert_eq!(left, ["long.nc"]);
}

#[test]
fn zero_offsets_come_from_the_machine_file() {
    let directory = directory("zero-offsets");
    let program = file(&directory, "a.nc", b"%a\nN10 G00 X1\nN20 G54 G00 X1\nN30 G53 X1\nM30\n");
    let machine =
        "[channel]\ndefault_index = 2\n[axis.X]\nnp_grp.1.versch = 100_000\nnp_grp.2.versch = -25_000\n";
    let machine = file(&directory, "m.toml", machine.as_bytes());
    let contour = directory.join("c.json");
    let contour = contour.to_str().expect("a path of plain characters");
    let output = glidepath(&["run", &program, "--machine", &machine, "--contour", contour]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let contour = fs::read_to_string(contour).expect("it was asked for");
    let contour: serde_json::Value = serde_json::from_str(&contour).expect("JSON");
    let ends: Vec<f64> = contour["segments"]
        .as_array()
        .into_iter()
        .flatten()
        .filter_map(|segment| segment["end"]["X"].as_f64().or_else(|| segment["end"][0].as_f64()))
        .collect();
    assert_eq!(ends, [-1.5, 11.0, 1.0], "{contour}");

    let wrong = file(&directory, "w.toml", b"[axis.X]\nnp_grp.1.versch = 1_000_000_001\n");
    let text = refusal(&["check", &program, "--machine", &wrong]);
    assert!(text.contains("w.toml:2:19") && text.contains("P-ZERO-00003"), "{text}");
}

//! `glidepath machine`: files written from options and from the settings of other controllers, explained, and run.
use std::fs;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Output, Stdio};

fn glidepath(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_glidepath")).args(arguments).output().expect("the simulator starts")
}

fn good(arguments: &[&str]) -> String {
    let output = glidepath(arguments);
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8_lossy(&output.stdout).into_owned()
}

fn refused(arguments: &[&str]) -> String {
    let output = glidepath(arguments);
    assert!(!output.status.success(), "{arguments:?}");
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn file(name: &str, text: &str) -> String {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("machines-{name}"));
    fs::write(&path, text).expect("a file for the test");
    path.to_str().expect("plain characters").to_owned()
}

/// The machine file that comes of these settings, and the same as a file.
fn made(name: &str, settings: &str) -> (String, String) {
    let text = good(&["machine", "from", &file(name, settings)]);
    let machine = file(&format!("{name}.toml"), &text);
    (text, machine)
}

/// Value of a key in the table of an axis.
fn value(text: &str, axis: &str, key: &str) -> Option<String> {
    let (_, table) = text.split_once(&format!("[axis.{axis}]\n"))?;
    let table = table.split("\n[").next()?;
    let line = table.lines().find(|line| line.starts_with(&format!("{key} =")))?;
    let (_, value) = line.split('#').next()?.split_once('=')?;
    Some(value.trim().replace('_', ""))
}

fn shipped(name: &str) -> String {
    format!("{}/machines/{name}", env!("CARGO_MANIFEST_DIR"))
}

/// Each shipped kind is what `new` writes, has no remark, and runs a program inside its limits and its travel.
#[test]
fn ready_machines_are_those_of_new_and_run() {
    let program = |name: &str, z: f64| {
        let text = format!(
            "G21 G90\nG0 X10 Y10\nG1 Z{z} F300\nG1 X60 F1200\nG2 X70 Y20 I0 J10\nG1 Y60\nG0 X0 Y0\nM30\n"
        );
        file(&format!("{name}.nc"), &text)
    };
    for (kind, name, z) in [
        ("router", "router.toml", -2.0),
        ("mill", "mill.toml", -5.0),
        ("laser", "laser.toml", 3.0),
        ("4axis", "four-axis.toml", -5.0),
    ] {
        let written = good(&["machine", "new", "--kind", kind]);
        let text = fs::read_to_string(shipped(name)).expect("a shipped machine");
        assert_eq!(written, text, "{name}: write it anew by `machine new --kind {kind}`");
        let explained = glidepath(&["machine", "explain", &shipped(name)]);
        assert!(explained.status.success() && explained.stderr.is_empty(), "{name}");
        let program = program(kind, z);
        let run = ["run", &program, "--machine", &shipped(name), "--dialect", "grbl", "--why", "never"];
        assert!(good(&run).contains("program time"), "{name}");
    }
    // A program of its kind for the rotary axis: beyond the software limits of X it is refused.
    let turn = file("turn.nc", "G01 X20 A720 F2000\nX0 A0\nM30\n");
    good(&["check", &turn, "--plan", "--machine", &shipped("four-axis.toml")]);
    let far = file("far.nc", "G01 X700 F2000\nM30\n");
    assert!(refused(&["check", &far, "--machine", &shipped("four-axis.toml")]).contains("software limit"));
}

#[test]
fn new_takes_what_it_is_asked_for() {
    let asked = ["--speed", "6000", "--acceleration", "900", "--ramp", "33", "--travel", "500,400,90.5"];
    let text = good(&[&["machine", "new", "--kind", "router"][..], &asked].concat());
    for (axis, key, expected) in [
        ("X", "dynamik.vb_max", "100000"),
        ("Z", "dynamik.vb_max", "40000"),
        ("Y", "slope_profil.a_beschl", "900"),
        ("Z", "slope_profil.a_grenz", "450"),
        ("Y", "slope_profil.tr_grenz", "33000"),
        ("X", "kenngr.swe_pos", "5000000"),
        ("Z", "kenngr.swe_neg", "-905000"),
    ] {
        assert_eq!(value(&text, axis, key).as_deref(), Some(expected), "{axis} {key}");
    }
    for (option, wrong, expected) in [
        ("--kind", "lathe", "router, mill, laser, 4axis"),
        ("--speed", "0", "1 to 1000000"),
        ("--travel", "1,2", "three lengths"),
    ] {
        let kind = ["--kind", "mill"];
        let kind = if option == "--kind" { &kind[..0] } else { &kind[..] };
        let told = refused(&[&["machine", "new", option, wrong], kind].concat());
        assert!(told.contains(expected), "{option}: {told}");
    }
    let output = Path::new(env!("CARGO_TARGET_TMPDIR")).join("machines-new.toml");
    let path = output.to_str().expect("plain characters");
    assert_eq!(good(&["machine", "new", "--kind", "laser", "--output", path]), "");
    assert_eq!(fs::read_to_string(&output).ok(), Some(good(&["machine", "new", "--kind", "laser"])));
}

const GRBL: &str = "Grbl 1.1h ['$' for help]\n$0=10\n$2=0\n$3=5 (dir invert)\n$11=0.010\n$20=1\n$30=1000\n$32=0\n\
    $100=800.000\n$101=800.000\n$102=400.000\n$110=2000.000 (x max rate, mm/min)\n$111=1500.000\n$112=800.000\n\
    $120=100.000\n$121=90.000\n$122=50.000\n$130=300.000\n$131=180.000\n$132=45.000\nok\n";

#[test]
fn grbl_settings_become_a_machine() {
    let (text, machine) = made("grbl", GRBL);
    for (axis, key, expected) in [
        ("X", "vb_eilgang", "33333"),
        ("Y", "dynamik.vb_max", "25000"),
        ("Z", "slope_profil.a_beschl", "50"),
        ("X", "kenngr.swe_neg", "-3000000"),
        ("Z", "kenngr.swe_pos", "0"),
        ("X", "steps.counts", "800000"),
        ("X", "steps.direction_inverted", "1"),
        ("Y", "steps.direction_inverted", "0"),
        ("Z", "steps.pulse_ns", "10000"),
    ] {
        assert_eq!(value(&text, axis, key).as_deref(), Some(expected), "{axis} {key}\n{text}");
    }
    assert!(text.contains("dialect = \"grbl\"") && text.contains("; $110=2000.000 mm/min"), "{text}");
    for left in ["$11=0.010: the tolerance of corners", "$30=1000: spindle", "# Not taken:"] {
        assert!(text.contains(left), "{left}\n{text}");
    }
    let program = file("grbl.nc", "G21 G90\nG0 X-10\nG1 X-100 F3000\nM30\n");
    // 90 mm at most at 2000 mm/min.
    let told = good(&["run", &program, "--machine", &machine]);
    assert!(told.contains("program time"), "{told}");
    // From the standard input.
    let mut child = Command::new(env!("CARGO_BIN_EXE_glidepath"))
        .args(["machine", "from", "-"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .expect("the simulator starts");
    child.stdin.take().expect("a pipe").write_all(GRBL.as_bytes()).expect("a reader");
    let piped = child.wait_with_output().expect("an end").stdout;
    let piped = String::from_utf8_lossy(&piped);
    assert_eq!(piped.lines().skip(1).collect::<Vec<_>>(), text.lines().skip(1).collect::<Vec<_>>());
    // Without soft limits there is no travel.
    let (free, _) = made("grbl-free", &GRBL.replace("$20=1", "$20=0"));
    assert_eq!(value(&free, "X", "kenngr.swe_neg"), None);
    assert!(free.contains("$130=300.000: travel, which counts only with $20=1"), "{free}");
}

const LINUXCNC: &str = "# a mill\n[EMCMOT]\nSERVO_PERIOD = 2000000\n[DISPLAY]\nDISPLAY = axis\n[TRAJ]\n\
    COORDINATES = X Y Y Z A\nLINEAR_UNITS = mm\nMAX_LINEAR_VELOCITY = 60\n[KINS]\nJOINTS = 5\n\
    KINEMATICS = trivkins coordinates=XYYZA kinstype=BOTH\n[AXIS_X]\nMAX_VELOCITY = 50.0\nMAX_ACCELERATION = 500\n\
    MIN_LIMIT = -1\nMAX_LIMIT = 600\n[JOINT_0]\nTYPE = LINEAR\nMAX_VELOCITY = 45.5\nMAX_ACCELERATION = 750\n\
    STEP_SCALE = -320\nSTEPLEN = 2500\nDIRSETUP = 5000\nBACKLASH = 0.02\nFERROR = 1\nHOME = 0\n[AXIS_Y]\n\
    MAX_VELOCITY = 80\nMAX_ACCELERATION = 400\n[AXIS_Z]\nMAX_VELOCITY = 20 # slow\nMAX_ACCELERATION = 100\n\
    MIN_LIMIT = -1e99\nMAX_LIMIT = 1e99\n[JOINT_3]\nSCALE = 400\n[AXIS_A]\nTYPE = ANGULAR\nMAX_VELOCITY = 90\n\
    MAX_ACCELERATION = 360\nMAX_JERK = 3600\n";

#[test]
fn a_linuxcnc_file_becomes_a_machine() {
    let (text, machine) = made("mill.ini", LINUXCNC);
    for (axis, key, expected) in [
        // The lowest of axis, joint and path.
        ("X", "dynamik.vb_max", "45500"),
        ("X", "slope_profil.a_beschl", "500"),
        ("Y", "dynamik.vb_max", "60000"),
        ("Z", "dynamik.vb_max", "20000"),
        ("A", "dynamik.vb_max", "90000"),
        ("A", "slope_profil.tr_grenz", "100000"),
        ("X", "kenngr.swe_pos", "6000000"),
        ("X", "steps.counts", "320000"),
        ("X", "steps.direction_inverted", "1"),
        ("X", "steps.backlash", "200"),
        // The joint of Z is the fourth one.
        ("Z", "steps.counts", "400000"),
    ] {
        assert_eq!(value(&text, axis, key).as_deref(), Some(expected), "{axis} {key}\n{text}");
    }
    assert_eq!(value(&text, "Z", "kenngr.swe_neg"), None, "1e99 is no limit");
    assert!(text.contains("cycle_us = 2000") && text.contains("[axis.A]\ntype = \"rotary\""), "{text}");
    for left in
        ["HOME = 0 (line", "FERROR = 1", "joints beyond the first", "sections without machine data: DISPLAY"]
    {
        assert!(text.contains(left), "{left}\n{text}");
    }
    let program = file("mill.nc", "G21 G90\nG0 X10 Y5\nG1 X100 A90 F3000\nM2\n");
    assert!(good(&["run", &program, "--machine", &machine]).contains("program time"));
    // Inches, and the sections of older versions.
    let old = "[TRAJ]\nCOORDINATES = X Z\nLINEAR_UNITS = inch\n[AXIS_0]\nMAX_VELOCITY = 2\nMAX_ACCELERATION = 10\n\
        MIN_LIMIT = -0.5\nMAX_LIMIT = 12\nSCALE = 4000\n[AXIS_1]\nMAX_VELOCITY = 1\nMAX_ACCELERATION = 5\n";
    let (text, _) = made("old.ini", old);
    assert_eq!(value(&text, "X", "dynamik.vb_max").as_deref(), Some("50800"));
    assert_eq!(value(&text, "X", "kenngr.swe_pos").as_deref(), Some("3048000"));
    assert_eq!(value(&text, "X", "steps.counts").as_deref(), Some("157480"));
    assert_eq!(value(&text, "Z", "slope_profil.a_brems").as_deref(), Some("127"));
}

const KLIPPER: &str = "[include macros.cfg]\n[printer]\nkinematics: cartesian\nmax_velocity: 300\nmax_accel: 3000 # mm/s²\n\
    max_z_velocity = 5\nmax_z_accel = 100\nsquare_corner_velocity: 5.0\n[stepper_x]\nstep_pin: PF0\ndir_pin: !PF1\n\
    microsteps: 16\nrotation_distance: 40\nposition_max: 235\nposition_min: -10\n[stepper_y]\nmicrosteps: 16\n\
    rotation_distance: 40\ngear_ratio: 80:20\nposition_max: 235\n[stepper_z]\nmicrosteps: 16\nrotation_distance: 8\n\
    position_max: 250\n[stepper_z1]\ndir_pin: !PC1\n[extruder]\nnozzle_diameter: 0.4\n[gcode_macro A]\ngcode:\n  G28\n  G1 X5\n\
    #*# [stepper_z]\n#*# position_endstop = 1.5\n#*# position_max = 240\n";

#[test]
fn a_klipper_file_becomes_a_machine() {
    let (text, machine) = made("printer.cfg", KLIPPER);
    for (axis, key, expected) in [
        ("X", "dynamik.vb_max", "300000"),
        ("Y", "dynamik.a_max", "3000"),
        ("Z", "vb_eilgang", "5000"),
        ("Z", "slope_profil.a_grenz", "100"),
        ("X", "kenngr.swe_neg", "-100000"),
        ("Z", "kenngr.swe_pos", "2400000"),
        // 200 steps of 16 parts on 40 mm, with a gear of 4 on Y.
        ("X", "steps.counts", "80000"),
        ("Y", "steps.counts", "320000"),
        ("Z", "steps.counts", "400000"),
        ("X", "steps.direction_inverted", "1"),
        ("Z", "steps.direction_2_inverted", "1"),
    ] {
        assert_eq!(value(&text, axis, key).as_deref(), Some(expected), "{axis} {key}\n{text}");
    }
    for left in ["square_corner_velocity = 5.0 (line 8): corners", "macros.cfg (line 1)", "extruder"] {
        assert!(text.contains(left), "{left}\n{text}");
    }
    let program = file("printer.nc", "G21 G90\nG0 X10 Y5\nG1 X100 F6000\nM2\n");
    assert!(good(&["run", &program, "--machine", &machine, "--dialect", "grbl"]).contains("program time"));
    let (text, _) = made("corexy.cfg", &KLIPPER.replace("cartesian", "corexy"));
    assert_eq!(value(&text, "X", "steps.counts"), None);
    assert!(value(&text, "Z", "steps.counts").is_some() && text.contains("each of their motors drives both"));
}

/// File, line, column, word and what was expected.
#[test]
fn wrong_settings_are_refused_with_their_place() {
    for (name, text, expected) in [
        ("words.txt", "hello\nworld\n", &["the settings of no controller", "$110=500.000"][..]),
        ("a.txt", "$110=fast\n$120=10\n", &["a.txt:1:6", "$110=fast: no number"]),
        ("b.txt", "$110=500\n", &["axis X has no $120"]),
        ("c.txt", "$110=0\n$120=10\n", &["c.txt:1:6", "a number above 0"]),
        (
            "d.ini",
            "[TRAJ]\nLINEAR_UNITS = miles\n[AXIS_X]\nMAX_VELOCITY = 1\nMAX_ACCELERATION = 2\n",
            &["d.ini:2:16", "mm or inch"],
        ),
        (
            "e.ini",
            "[TRAJ]\nLINEAR_UNITS = mm\nCOORDINATES = X\n[AXIS_X]\nMAX_VELOCITY = much\n",
            &["e.ini:5:16", "no number", "MAX_ACCELERATION is missing"],
        ),
        ("f.ini", "[TRAJ]\nLINEAR_UNITS = mm\nnonsense\n", &["f.ini:3:1", "a line that is no setting"]),
        ("g.cfg", "[printer]\nkinematics: delta\nmax_velocity: 1\nmax_accel: 1\n", &["g.cfg:2:13", "corexy"]),
        ("h.cfg", "[printer]\nmax_velocity: 1\n", &["max_accel is missing"]),
        ("i.cfg", "[printer]\nmax_velocity: 1\nmax_accel: 1\n", &["0 axes", "1 to 6 axes"]),
        ("j.txt", "$110=1e12\n$120=10\n", &["vb_eilgang", "out of range"]),
    ] {
        let told = refused(&["machine", "from", &file(name, text)]);
        assert!(expected.iter().all(|part| told.contains(part)), "{name}: {told}");
    }
}

#[test]
fn explain_says_what_is_given_and_what_is_a_default() {
    let text = "[channel]\ncycle_us = 500\n[axis.X]\ndynamik.vb_max = 50_000\nvb_eilgang = 40_000\n[axis.A]\ntype = \"rotary\"\n";
    let output = glidepath(&["machine", "explain", &file("explain.toml", text)]);
    let told = String::from_utf8_lossy(&output.stdout).into_owned();
    let line = |words: &str| told.lines().find(|line| line.trim_start().starts_with(words)).unwrap_or("");
    for (words, parts) in [
        ("interpolation cycle", &["0.5 ms", "cycle_us", "line 2"][..]),
        ("slope: how", &["0 (STEP)", "prog_start.slope.profile", "P-CHAN-00071", "default"]),
        ("largest speed  ", &["50 mm/s", "dynamik.vb_max", "P-AXIS-00212", "line 4"]),
        ("speed of rapid", &["40 mm/s", "P-AXIS-00209", "line 5"]),
        ("software limit, neg", &["none", "P-AXIS-00177", "default"]),
    ] {
        assert!(parts.iter().all(|part| line(words).contains(part)), "{words}: {}", line(words));
    }
    assert!(told.contains("axis A, rotary") && told.contains("°/s²"), "{told}");
    assert!(told.contains("jerk without limit"), "{told}");
    let warned = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(warned.contains("the slope is STEP") && warned.contains("explain.toml:1:"), "{warned}");
    // The slope by its name is enough.
    let named = text.replace("cycle_us = 500", "slope = \"trapez\"");
    assert!(glidepath(&["machine", "explain", &file("named.toml", &named)]).stderr.is_empty());
}

/// Names in plain units are the same machine.
#[test]
fn plain_names_stand_for_isg_parameters() {
    let plain = "[channel]\ncycle_ms = 0.5\nslope = \"TRAPEZ\"\n[axis.X]\nrapid_speed_mm_s = 40.5\nmax_speed_mm_s = 50\n\
        max_acceleration_mm_s2 = 800\nacceleration_mm_s2 = 700\nramp_time_ms = 12.5\ncurve_ramp_time_ms = 10\n\
        travel_min_mm = -5\ntravel_max_mm = 300.5\n[axis.A]\ntype = \"rotary\"\nmax_speed_deg_s = 90\nrapid_speed_deg_s = 80\n";
    let isg = "[channel]\ncycle_us = 500\nprog_start.slope.profile = 1\n[axis.X]\nvb_eilgang = 40_500\n\
        dynamik.vb_max = 50_000\ndynamik.a_max = 800\nslope_profil.a_beschl = 700\nslope_profil.a_brems = 700\n\
        slope_profil.a_grenz = 700\nslope_profil.tr_beschl_zu = 12_500\nslope_profil.tr_beschl_ab = 12_500\n\
        slope_profil.tr_brems_zu = 12_500\nslope_profil.tr_brems_ab = 12_500\nslope_profil.tr_grenz = 12_500\n\
        dynamik.tr_geom = 10_000\nkenngr.swe_neg = -50_000\nkenngr.swe_pos = 3_005_000\n[axis.A]\ntype = \"rotary\"\n\
        dynamik.vb_max = 90_000\nvb_eilgang = 80_000\n";
    let values = |name: &str, text: &str| {
        let told = good(&["machine", "explain", &file(name, text)]);
        // Without the name of the file and the lines of it.
        let line =
            |line: &str| line.rsplit_once("  ").map_or(line, |(values, _)| values).trim_end().to_owned();
        let mut lines: Vec<String> = told.lines().skip(1).map(line).collect();
        lines.sort();
        lines
    };
    assert_eq!(values("plain.toml", plain), values("isg.toml", isg));
    for (name, text, expected) in [
        ("twice", "[axis.X]\nmax_speed_mm_s = 5\ndynamik.vb_max = 5000\n", "gives what axis.X."),
        ("unit", "[axis.X]\nmax_speed_deg_s = 5\n", "max_speed_mm_s"),
        ("fine", "[axis.X]\nmax_speed_mm_s = 5.00001\n", "three decimals at most"),
        ("whole", "[axis.X]\nacceleration_mm_s2 = 5.5\n", "an integer"),
        ("range", "[axis.X]\nmax_speed_mm_s = 0\n", "0.001…2000000"),
        ("near", "[axis.X]\nmax_sped_mm_s = 5\n", "is `max_speed_mm_s` meant?"),
        ("slope", "[channel]\nslope = \"fast\"\n[axis.X]\n", "\"TRAPEZ\""),
    ] {
        let told = refused(&["machine", "explain", &file(&format!("{name}.toml"), text)]);
        assert!(told.contains(expected) && told.contains(&format!("{name}.toml:2:")), "{name}: {told}");
    }
}

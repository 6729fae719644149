//! The summary reports the deviation of the driven path from the programmed path, and the number of curves.
mod common;

use common::{LSB, Run, number, run, run_with, shipped, written};
use serde_json::json;

/// Distance of a point from the line through two others, no further than their ends.
fn from_line(q: [f64; 2], a: [f64; 2], b: [f64; 2]) -> f64 {
    let d = [b[0] - a[0], b[1] - a[1]];
    let along = ((q[0] - a[0]) * d[0] + (q[1] - a[1]) * d[1]) / (d[0] * d[0] + d[1] * d[1]);
    let part = along.clamp(0.0, 1.0);
    (q[0] - a[0] - d[0] * part).hypot(q[1] - a[1] - d[1] * part)
}

fn points(run: &Run) -> Vec<[f64; 2]> {
    run.trace.rows.iter().map(|row| [0, 1].map(|k| row.axes[k] as f64 * LSB)).collect()
}

#[test]
fn the_deviation_is_that_of_the_set_points() {
    // Slow, so that the set points are close together.
    let text = "N10 #CONTOUR MODE [DEV PATH_DEV=0.4]\nN20 G261 G01 X10 F300\nN30 Y10\nN40 X12 Y20\nM30\n";
    let run = run("deviation", &written("deviation", text), None);
    let corners = [[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [12.0, 20.0]];
    let points = points(&run);
    let lines: Vec<_> = corners.windows(2).collect();
    let off = |q: &[f64; 2]| lines.iter().map(|l| from_line(*q, l[0], l[1])).fold(f64::MAX, f64::min);
    let away = |c: &[f64; 2]| points.windows(2).map(|p| from_line(*c, p[0], p[1])).fold(f64::MAX, f64::min);
    let largest = points.iter().map(off).chain(corners.iter().map(away)).fold(0.0, f64::max);
    let told = &run.summary["deviation"];
    assert!((number(&told["value"]) - largest).abs() < 1e-5, "{told} for {largest}");
    assert!(number(&told["value"]) > 0.39 && number(&told["value"]) <= 0.4, "{told}");
    assert_eq!((&told["tolerance"], &told["n"]), (&json!(0.4), &json!(20)));
    // Three lines, two corners of two curves each.
    assert_eq!(
        (&run.summary["elements"], &run.summary["elements_per_block"]),
        (&json!(7), &json!(7.0 / 3.0))
    );
    assert!(run.stdout.contains("mm of 0.4 mm permitted, 100.0 %, at N20"), "{}", run.stdout);
    assert!(run.stdout.contains("7, 2.33 per motion block"), "{}", run.stdout);
}

/// Where the nearest block is another one, the deviation has a cusp. Here it is largest there, between two points at
/// which the curve is looked at: 9 % more than at either of them.
#[test]
fn a_cusp_between_the_points_of_a_curve_counts() {
    let corners = [
        [0.0, 0.0],
        [-0.937, 0.118],
        [-1.165, 0.703],
        [-1.009, 0.015],
        [0.018, 0.718],
        [-0.686, 0.294],
        [-0.96, 0.029],
    ];
    let lines: String = corners.iter().skip(1).map(|[x, y]| format!("X{x} Y{y}\n")).collect();
    let run = run("cusp", &written("cusp", &format!("#HSC ON [OPMODE=2]\nG01 F60\n{lines}M30\n")), None);
    let points = points(&run);
    let away = |q: &[f64; 2]| (q[0] - corners[2][0]).hypot(q[1] - corners[2][1]);
    let from = |one: &(usize, f64), other: &(usize, f64)| one.1.total_cmp(&other.1);
    let (third, _) = points.iter().map(away).enumerate().min_by(from).expect("points");
    // Set points a micrometre apart, and places between them: of the way along the first two lines.
    let mut largest: f64 = 0.0;
    for two in points[..third].windows(2) {
        for part in (0..32).map(|k| f64::from(k) / 32.0) {
            let q = [0, 1].map(|k| two[0][k] + (two[1][k] - two[0][k]) * part);
            let off = corners[..3].windows(2).map(|l| from_line(q, l[0], l[1]));
            largest = largest.max(off.fold(f64::MAX, f64::min));
        }
    }
    let told = number(&run.summary["deviation"]["value"]);
    assert!((told - largest).abs() < 2e-5 && told > 0.0858, "{told} for {largest}");
}

/// So is the place where a curve is nearest to a corner: between its points it is further out than its chords.
#[test]
fn a_corner_is_as_far_off_as_the_curve_itself() {
    for (name, pre, post, last) in [
        ("off-long", 4.0, 1.0, [6.0, 6.0]),
        ("off-short", 0.3, 2.0, [6.0, 6.0]),
        ("off-flat", 1.0, 3.0, [10.0, 2.0]),
    ] {
        let text = format!(
            "N10 #CONTOUR MODE [DIST PRE_DIST={pre} POST_DIST={post}]\nN20 G261 G01 X6 F60\nN30 X{} Y{}\nM30\n",
            last[0], last[1]
        );
        let run = run(name, &written(name, &text), None);
        let corners = [[0.0, 0.0], [6.0, 0.0], last];
        let points = points(&run);
        let off =
            |q: &[f64; 2]| corners.windows(2).map(|l| from_line(*q, l[0], l[1])).fold(f64::MAX, f64::min);
        let away = points.windows(2).map(|p| from_line(corners[1], p[0], p[1])).fold(f64::MAX, f64::min);
        let largest = points.iter().map(off).fold(away, f64::max);
        let told = number(&run.summary["deviation"]["value"]);
        assert!((told - largest).abs() < 1e-6, "{name}: {told} for {largest}");
    }
}

#[test]
fn rotary_axes_have_a_deviation_of_their_own() {
    let text =
        "N10 #CONTOUR MODE [DEV PATH_DEV=1 TRACK_DEV=0.5]\nN20 G261 G01 X40 C30 F3000\nN30 Y40 C-10\nM30\n";
    let run = run("tracking", &written("tracking", text), Some(&shipped("machines/five-axis.toml")));
    let told = &run.summary["tracking"];
    assert_eq!(told.as_array().map(Vec::len), Some(1), "{told}");
    assert_eq!(
        (&told[0]["axis"], &told[0]["unit"], &told[0]["tolerance"]),
        (&json!("C"), &json!("°"), &json!(0.5))
    );
    let value = number(&told[0]["value"]);
    assert!(value > 0.05 && value <= 0.5, "{told}");
}

#[test]
fn arcs_are_programmed_paths_too() {
    let text = "N10 #CONTOUR MODE [DEV PATH_DEV=0.2]\nN20 G261 G01 X30 F3000\nN30 G02 X50 I10\nN40 G03 Z5 I10\nN50 G01 X80\nM30\n";
    let run = run("arcs-off", &written("arcs-off", text), None);
    let told = &run.summary["deviation"];
    assert!((0.18..=0.2001).contains(&number(&told["value"])), "{told}");
}

#[test]
fn methods_without_a_tolerance_are_told_without_one() {
    let text = "N10 #CONTOUR MODE [DIST PRE_DIST=4 POST_DIST=4]\nN20 G261 G01 X30 F3000\nN30 Y30\nM30\n";
    let run = run("no-tolerance", &written("no-tolerance", text), None);
    let told = &run.summary["deviation"];
    assert_eq!(told["tolerance"], json!(null));
    // By far the most of it in the middle: 3/8 of the distance.
    assert!((number(&told["value"]) - 1.5 * 2_f64.sqrt() / 2.0).abs() < 0.5, "{told}");
    // Nothing is smoothed: nothing is told. Lines that go straight on become one.
    let text = "N10 G01 X10 F3000\nN20 X20\nN30 X30\nN40 Y10\nM30\n";
    let plain = crate::run("plain-off", &written("plain-off", text), None);
    assert_eq!(plain.summary["deviation"], json!(null));
    assert!(number(&plain.summary["elements_per_block"]) < 1.0, "{}", plain.stdout);
}

/// One line stands for many chords, and the corner between two lines for the last and the first of them.
#[test]
fn lines_over_many_chords_are_followed() {
    let mut text = String::from("#CONTOUR MODE [DEV PATH_DEV=0.1]\nG261 G01 F3000\n");
    for k in 1..=120 {
        let angle = f64::from(k) * std::f64::consts::TAU / 120.0;
        text += &format!("N{k} X{:.6} Y{:.6}\n", 20.0 * angle.sin(), 20.0 - 20.0 * angle.cos());
    }
    let file = std::fs::read_to_string(shipped("machines/default.toml")).expect("it is shipped");
    let machine = written("merged.toml", &file.replacen("[channel]", "[channel]\nmerge_chords = 50", 1));
    let run = run("merged", &written("merged", &(text + "M30\n")), Some(&machine));
    let told = &run.summary["deviation"];
    // Two chords each: what is between them is 0.0274 mm beside their line.
    assert!((number(&told["value"]) - 0.0274).abs() < 1e-4, "{told}");
    assert!(number(&run.summary["elements_per_block"]) < 1.1, "{}", run.stdout);
}

/// Behind an abort no end of a block is missed.
#[test]
fn an_abort_misses_nothing() {
    let text = "#CONTOUR MODE [DEV PATH_DEV=0.2]\nG261 G01 X50 F3000\nY50\nX100\nM30\n";
    let events = written("abort.events", "0.3 abort\n");
    let run = run_with("aborted", &written("aborted", text), None, &["--events", &events]);
    assert!(run.trace.rows.last().expect("rows").axes[0] as f64 * LSB < 20.0);
    let told = &run.summary["deviation"];
    assert!(told.is_null() || number(&told["value"]) <= 0.2 + 1e-6, "{told}");
}

/// Behind an abort the path is where it ended, though lines over many blocks were handed on beyond it.
#[test]
fn an_abort_takes_merged_lines_back() {
    let mut text = String::from("#CONTOUR MODE [DEV PATH_DEV=1 RELEVANT_PATH=0.2]\nG261 G01 F3000\n");
    for k in 1..=20 {
        text += &format!("N{k} X{} Y{} Z{}\n", 3 * k.min(10), 3 * (k.max(10) - 10), f64::from(k % 3) * 0.001);
    }
    let file = std::fs::read_to_string(shipped("machines/default.toml")).expect("it is shipped");
    let machine = written("back.toml", &file.replacen("[channel]", "[channel]\nmerge_chords = 50", 1));
    let program = written("back", &(text + "M30\n"));
    for event in ["0.3 abort\n", "0.9 abort\n", "0.8 feedhold\n1.4 abort\n"] {
        let events = written("back.events", event);
        let run = run_with("back", &program, Some(&machine), &["--events", &events]);
        assert!(run.trace.rows.last().expect("rows").axes[1] as f64 * LSB < 20.0, "it is aborted on its way");
        assert!(number(&run.summary["deviation"]["value"]) <= 1.0, "{}", run.summary["deviation"]);
    }
}

/// A point beside a helix is nearest to it elsewhere than at its own angle.
#[test]
fn steep_helices_are_followed_in_space() {
    let text = "#CONTOUR MODE [DEV PATH_DEV=0.0153]\nG261 G01 F678\n\
                N10 G02 X0.254547 Y-0.577171 Z0.699484 I0.096698 J-0.302070\nN20 G01 X-0.1959 Y-0.8491 Z0.7694\nM30\n";
    let run = run("helix", &written("helix", text), None);
    let value = number(&run.summary["deviation"]["value"]);
    assert!((0.014..=0.0153 + 1e-6).contains(&value), "{}", run.summary["deviation"]);
}

/// G260 in a block leaves the corner before it to the method of its own (D3-026).
/// The nearest point of a steep helix may lie inside it where the angle in its plane lies outside.
#[test]
fn beside_the_angles_of_a_helix_its_inside_counts() {
    let text = "#CONTOUR MODE ON [DEV PATH_DEV=1]\nN20 G01 X20 F6000\nN30 G03 X23 Y3 R3 Z45\nM30\n";
    let run = run("helix-inside", &written("helix-inside", text), None);
    let told = &run.summary["deviation"];
    assert!((0.9..=1.001).contains(&number(&told["value"])), "{told}");
}

/// A rotary axis has several values where the main axes are once: at the start of a full circle, and where it moves
/// alone.
#[test]
fn one_place_may_have_several_values_of_a_rotary_axis() {
    for (name, text, most) in [
        (
            "full-circle",
            "#CONTOUR MODE ON [DEV PATH_DEV=0.1 TRACK_DEV=0.3]\nG01 F2000 X-20 Y0\nX0\nG03 J20 A30\nG01 X50 A20\nM30\n",
            0.3,
        ),
        (
            "turned-alone",
            "G01 F1000\nY-47\n#HSC ON [BSPLINE PATH_DEV=0.2 TRACK_DEV=1 MAX_ANGLE=180]\nA12\n\
             G03 X66 Y-47.2 I33.1 J33\n#HSC OFF\nM30\n",
            1.0,
        ),
    ] {
        let run = run(name, &written(name, text), Some(&shipped("machines/five-axis.toml")));
        let told = &run.summary["tracking"];
        let off = told.as_array().and_then(|axes| axes.iter().find(|axis| axis["axis"] == "A"));
        assert!(off.is_none_or(|axis| number(&axis["value"]) <= most * 1.001), "{name}: {told}");
    }
}

#[test]
fn the_corner_before_g260_has_its_own_tolerance() {
    let text = "#CONTOUR MODE ON [DIST_SOFT PATH_DIST=12]\nG01 X50 F9000\nN20 Y50\nN30 G260 X0\n\
                #CONTOUR MODE ON [DEV PATH_DEV=0.02]\nN40 Y20\nN50 X20\nM30\n";
    let run = run("ended", &written("ended", text), None);
    let told = &run.summary["deviation"];
    assert!(number(&told["value"]) <= 0.02 + 1e-6 && told["n"] == 40, "{told}");
}

/// A block is left out at the corner: the command before it counts, though the one behind has a tolerance.
#[test]
fn a_corner_over_a_block_left_out_has_the_tolerance_of_its_command() {
    let text = "#CONTOUR MODE [DIST PRE_DIST=4 POST_DIST=4]\nN10 G261 G01 X30 F3000\n\
                #CONTOUR MODE ON [DEV PATH_DEV=0.02]\nN20 Y0.02\nN30 Y30\nN40 X0\nM30\n";
    let run = run("left-out", &written("left-out", text), None);
    let told = &run.summary["deviation"];
    // What is told is the corner that has one.
    assert!(number(&told["value"]) <= 0.02 + 1e-6 && told["n"] == 40, "{told}");
}

/// An axis that moves beside the path is not compared, and that is said.
#[test]
fn an_axis_beside_the_path_is_left_out() {
    let text = "N5 #HSC ON [SURFACE PATH_DEV=0.01]\nG01 Y1 F1000\nX[INDP_SYN G01 G90 POS=5 FEED=1000]\nN20 Y5\nN30 Y9 Z1\nM30\n";
    let run = run("beside", &written("beside", text), Some(&surface("beside.toml")));
    let told = &run.summary["deviation"];
    assert!(number(&told["value"]) <= 0.01, "{told}");
    assert_eq!(run.summary["left_out"], json!(["X"]));
    assert!(run.stdout.contains(", without X: beside the path"), "{}", run.stdout);
}

/// A long curve is further out than its chords: points of its own count.
#[test]
fn a_curve_is_as_near_to_a_point_as_it_is_and_not_as_its_chords_are() {
    let mut text =
        "#SLOPE [TYPE=HSC]\nG01 X0 Y0 F6000\n#HSC ON [SURFACE PATH_DEV=0.1 TRACK_DEV=1]\n".to_owned();
    for row in 0..6 {
        for k in 0..40 {
            let x = 0.5 * f64::from(if row % 2 == 0 { k } else { 39 - k });
            let y = 0.4 * f64::from(row);
            text += &format!("X{x:.3} Y{y:.3} Z{:.3}\n", 0.2 * (0.8 * x).sin() * (0.5 * y).cos());
        }
    }
    let run = run("curved", &written("curved", &(text + "#HSC OFF\nM30\n")), Some(&surface("curved.toml")));
    let told = &run.summary["deviation"];
    assert!(number(&told["value"]) <= 0.1 && number(&told["value"]) > 0.09, "{told}");
}

/// CHECK_JERK=0 of Surface: what its curves do to the jerk is not compared.
#[test]
fn jerk_that_surface_may_not_check_is_not_compared() {
    let text = |check: u8| {
        format!(
            "#SLOPE [TYPE=HSC]\nG01 X0 Y0 Z0 F60000\n#HSC ON [SURFACE PATH_DEV=0.5 CHECK_JERK={check}]\nX20\nX25 Y3\nX30 Y12\nX50 Y12\n#HSC OFF\nM30\n"
        )
    };
    let file = surface("free.toml");
    let free = run("free", &written("free", &text(0)), Some(&file));
    assert!(free.stdout.contains("jerk not compared: CHECK_JERK = 0"), "{}", free.stdout);
    let checked = run("checked", &written("checked", &text(1)), Some(&file));
    assert!(!checked.stdout.contains("CHECK_JERK"), "{}", checked.stdout);
}

/// Parameters of #HSC while it is on are not taken (warning 120542): nothing is judged by them.
#[test]
fn parameters_that_are_not_taken_judge_nothing() {
    let text = "N10 G90 G17 G01 F3000\nN20 #HSC ON [SURFACE PATH_DEV=0.08]\nN30 X20\nN40 #HSC [SURFACE PATH_DEV=0.001 CHECK_JERK=0]\nN50 Y20\nN60 X0\nN70 #HSC OFF\nM30\n";
    let run = run("refused", &written("refused", text), Some(&surface("refused.toml")));
    assert_eq!(run.summary["deviation"]["tolerance"], json!(0.08));
    assert!(run.stdout.contains("mm of 0.08 mm permitted"), "{}", run.stdout);
    assert!(!run.stdout.contains("jerk not compared"), "{}", run.stdout);
    assert!(run.stderr.contains("120542"), "{}", run.stderr);
}

/// The built-in machine, with Surface.
fn surface(name: &str) -> String {
    let file = std::fs::read_to_string(shipped("machines/default.toml")).expect("it is shipped");
    let table = "[channel.configuration.path_preparation]\nfunction = \"FCT_DEFAULT|FCT_SURFACE\"\n";
    let with = if file.contains("FCT_SURFACE") { file } else { file + "\n" + table };
    written(name, &with)
}

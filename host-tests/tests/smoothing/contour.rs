//! Contour mode: checks of single corners, and programs from text to set points.
use glidepath::channel::{Channel, Handles, Progress};
use glidepath::machine::MachineData;
use glidepath::nc::{Contour, ContourMethod, NcWarning, Place};
use glidepath::quantity::Position;
use glidepath::queue::Function;
use host_tests::cases::machines;
use host_tests::cases::random::{Mix, program};
use host_tests::cases::{Program, set_point};
use host_tests::check;
use host_tests::corner::{blocks, dev, judge_with, random, round};
use host_tests::properties::axis_limits;
use host_tests::rounded::{Run, quick, run, run_from};

/// Rows: D3-001, D3-018, D3-019, D3-024.
#[test]
fn random_corners_are_smooth_and_use_their_tolerance() {
    // `cargo run --release -p host-tests --example corners -- 0 50000` goes on with it.
    let machine = machines::even::<3>(1000);
    let mut free = 0;
    for seed in host_tests::seeds::seeds(0..2000, 200) {
        // At constant speed: with that each of them is a curve over its arc length.
        let seen = judge_with(&random(seed), &machine, |dev| Contour { const_vel: Some(true), ..dev })
            .unwrap_or_else(|fault| panic!("corner {seed}: {fault}"));
        assert!(
            !seen.sharp && !seen.timed && seen.used <= 1.0 && seen.uneven <= 1e-3,
            "corner {seed}: {seen:?}"
        );
        if !seen.limited {
            free += 1;
            assert!(seen.used >= 0.999, "corner {seed}: {seen:?}");
        }
    }
    assert!(free > 800, "{free}");
}

/// Rows: D3-025, D3-075, CF-07.
#[test]
fn switches_in_blocks_and_between_them_round_the_same_corners() {
    let by_block = "%a\nN10 X0 Y0 G01 F1000\nN20 X10 Y50\nN30 G61 X20 Y50\nN40 G61 X30 Y10\nN50 G61 X40 Y10\nN60 G61 X50 Y50\nN70 X60 Y50\nN80 X70 Y10\nN90 X80 Y10\nM30\n";
    let inside = "%b\nN10 X0 Y0 G01 F1000\nN20 X10 Y50\nN30 G261 X20 Y50\nN40 X30 Y10\nN50 X40 Y10\nN60 X50 Y50\nN70 G260 X60 Y50\nN80 X70 Y10\nN90 X80 Y10\nM30\n";
    let between = "%c\nN10 X0 Y0 G01 F1000\nN20 X10 Y50\nN25 G261\nN30 X20 Y50\nN40 X30 Y10\nN50 X40 Y10\nN60 X50 Y50\nN70 X60 Y50\nN75 G260\nN80 X70 Y10\nN90 X80 Y10\nM30\n";
    let runs = [by_block, inside, between].map(run);
    assert_eq!(runs[0].digest, runs[1].digest);
    assert_eq!(runs[0].digest, runs[2].digest);
    for corner in [[20.0, 50.0], [30.0, 10.0], [40.0, 10.0], [50.0, 50.0]] {
        let off = runs[0].distance(corner);
        assert!((0.999..1.001).contains(&off), "{corner:?}: {off}");
    }
    for corner in [[10.0, 50.0], [60.0, 50.0], [70.0, 10.0]] {
        assert!(runs[0].distance(corner) < 0.01, "{corner:?}");
    }
}

/// Rows: D3-074, D3-078.
#[test]
fn on_and_off_by_command_and_whatever_the_feed() {
    let text = |on: &str, off: &str, feed: u32| {
        format!("N10 G01 X0 Y0 F{feed}\n{on}\nN30 X50\nN40 Y50\nN50 X0\nN60 Y0\n{off}\nN70 X10\nM30\n")
    };
    let command = run(&text("#CONTOUR MODE ON [DEV PATH_DEV=1.0]", "#CONTOUR MODE OFF", 6000));
    let words = run(&text("#CONTOUR MODE [DEV PATH_DEV=1.0]\nG261", "G260", 6000));
    assert_eq!(command.digest, words.digest);
    assert!(command.distance([0.0, 50.0]) > 0.999 && command.distance([0.0, 0.0]) == 0.0);
    // Over its arc length the curve is the same at any speed.
    let at =
        |feed: u32| run(&text("#CONTOUR MODE ON [DEV PATH_DEV=1.0 CONST_VEL=1]", "#CONTOUR MODE OFF", feed));
    let [quick, slow] = [6000, 500].map(at);
    // One law may be that of both halves.
    let paths = [&quick, &slow].map(|run| [30, 40, 50, 60].iter().flat_map(|n| run.lengths(*n)).sum::<f64>());
    assert!((paths[0] - paths[1]).abs() < 1e-9, "{paths:?}");
    for n in [40, 50, 60] {
        let lines = [&quick, &slow].map(|run| run.lengths(n).into_iter().fold(0.0, f64::max));
        assert_eq!(lines[0], lines[1], "N{n}");
    }
}

/// Rows: D3-030, CF-06.
#[test]
fn straight_on_and_straight_back_get_no_curve() {
    let blocks = [
        "N10 G01 X10 F1000\nN20 X20\n",
        "N10 G01 X10 F1000\nN20 X2\n",
        "N10 G01 X10 F1000\nN20 G02 X10 Y-8 J-4\n",
    ];
    let modes = [
        "DEV PATH_DEV=1 MAX_ANGLE=180",
        "DIST MAX_ANGLE=180",
        "POS X10 Y-5",
        "POS PRE_DIST=0 X11 Y0",
        "DIST_SOFT",
        "PTP MERGE=0",
    ];
    for text in
        modes.iter().flat_map(|mode| blocks.map(|blocks| format!("#CONTOUR MODE ON [{mode}]\n{blocks}M30\n")))
    {
        let text = text.as_str();
        let run = run_from(text, [Position::ZERO; 3], &quick(1000));
        // Straight on, one law may be that of both.
        assert_eq!(run.blocks.iter().map(|span| span.blocks).sum::<u32>(), 2, "{text}");
        assert!(run.distance([10.0, 0.0]) < 0.02);
    }
}

/// Rows: D3-026, D3-032.
#[test]
fn the_last_block_of_a_program_ends_where_it_should() {
    for text in [
        "N10 G01 G61 X10 F1000\nM30\n",
        "G261\nN10 G01 X10 F1000\nN20 Y10\nM30\n",
        "N10 G61 G01 X10 F1000\nG04 X0.1\nN20 Y10\nM30\n",
    ] {
        let run = run(text);
        let last = run.trace.mm(run.trace.len() - 1);
        assert_eq!(last[0], 10.0, "{text}");
    }
    // A dwell, an exact stop and G260 between the blocks keep the corner.
    for text in [
        "N10 G61 G01 X10 F1000\nG04 X0.1\nN20 Y10\nM30\n",
        "N10 G61 G60 G01 X10 F1000\nN20 Y10\nM30\n",
        "N10 G61 G01 X10 F1000\nG260\nN20 Y10\nM30\n",
        "N10 G61 G01 X10 F1000\n#PUT AX [Z]\nN20 Y10\nM30\n",
        "#PUT AX [Z]\nN10 G61 G01 X10 F1000\n#CALL AX [Z]\nN20 Y10\nM30\n",
        "G261\nN10 G01 X10 F1000\n#CALL AX [Z]\nN20 Y10\nM30\n",
        "N10 G61 G01 X10 F1000\n#FLUSH&WAIT\nN20 Y10\nM30\n",
    ] {
        assert!(run(text).distance([10.0, 0.0]) < 1e-3, "{text}");
    }
    assert!(run("N10 G61 G01 X10 F1000\nN20 G260 Y10\nM30\n").distance([10.0, 0.0]) > 0.99);
}

/// Rows: D3-156, D3-157.
#[test]
fn an_axis_given_away_does_not_move() {
    let text = b"N10 G01 X10 F1000\n#PUT AX [Z]\nN20 X20\nN30 Z1\nM30\n";
    let mut channel: Box<Channel<3, 120>> = Box::new(Channel::new());
    let data = machines::even(1000);
    let Handles { mut planner, mut interpolator, .. } =
        channel.split(&data, [Position::ZERO; 3], &text[..]).expect("machine data");
    let error = loop {
        match planner.poll() {
            Ok(Progress::Done) => panic!("accepted"),
            Ok(Progress::Waiting) => _ = interpolator.tick(),
            Ok(_) => {}
            Err(error) => break error,
        }
    };
    assert_eq!(error.place().line, 4, "{error}");
    let fetched = run("N10 G01 X10 F1000\n#PUT AX [Z]\nN20 X20\n#CALL AX [Z]\nN30 Z1\nM30\n");
    assert_eq!(fetched.trace.mm(fetched.trace.len() - 1), [20.0, 0.0, 1.0]);
}

/// Rows: D3-023, D3-089, D3-090, D3-104, D3-105, D3-106, D3-107, D3-115.
#[test]
fn deviation_distances_and_interim_point() {
    let dev = run("#CONTOUR MODE [DEV PATH_DEV=5]\nN10 G01 X100 G61 F6000\nN20 Y100\nM30\n");
    let off = dev.distance([100.0, 0.0]);
    assert!((4.995..5.005).contains(&off), "{off}");
    // What is left of the blocks says where the curve begins and ends.
    let dist = run("#CONTOUR MODE [DIST PRE_DIST=10 POST_DIST=5]\nN10 G01 X100 G61 F6000\nN20 Y100\nM30\n");
    assert!(
        (dist.lengths(10)[0] - 90.0).abs() < 1e-6 && (dist.lengths(20).last().unwrap() - 95.0).abs() < 1e-6
    );
    let pos = run(
        "#CONTOUR MODE [POS PRE_DIST=2 POST_DIST=3 X110 Y-10 Z0]\nN10 G01 X100 G61 F6000\nN20 Y100\nM30\n",
    );
    assert!(
        (pos.lengths(10)[0] - 98.0).abs() < 1e-6 && (pos.lengths(20).last().unwrap() - 97.0).abs() < 1e-6
    );
    assert!(pos.distance([110.0, -10.0]) < 0.1);
    // Distance 0 keeps the contour up to the corner.
    let zero =
        run("#CONTOUR MODE [POS PRE_DIST=0 POST_DIST=3 X101 Y1 Z0]\nN10 G01 X100 G61 F6000\nN20 Y100\nM30\n");
    assert!((zero.lengths(10)[0] - 100.0).abs() < 1e-6);
    let speeds = pos.speeds();
    assert!(speeds.iter().all(|v| *v <= 100.0 * (1.0 + 1e-6)), "feed");
}

/// Rows: D3-021, D3-033, D3-034, D3-035, D3-036, D3-037, D3-077, D3-091, D3-092, D3-093, CF-09, CF-22.
#[test]
fn distances_stay_inside_half_a_block_and_what_is_to_remain() {
    // Both ends of N20 want more than its half: nothing is left of it.
    let text = |rest: &str| {
        format!("#CONTOUR MODE ON [DEV PATH_DEV=50 {rest}]\nN10 G01 X100 F6000\nN20 Y40\nN30 X0\nM30\n")
    };
    let all = run(&text(""));
    assert!((all.lengths(10)[0] - 80.0).abs() < 1e-9, "{:?}", all.lengths(10));
    let curve: f64 = all.lengths(20).iter().sum();
    assert!(all.lengths(20).len().is_multiple_of(2) && curve < 40.0, "{:?}", all.lengths(20));
    // 10 % remain: 45 % for each corner.
    let part = run(&text("REMAIN_PART=10"));
    assert!((part.lengths(10)[0] - 82.0).abs() < 1e-4, "{:?}", part.lengths(10));
    assert!(part.lengths(20).iter().any(|l| (l - 4.0).abs() < 1e-4), "{:?}", part.lengths(20));
    // Equal distances shrink together, unequal ones alone.
    let dist = |pre: f64, post: f64| {
        run(&format!(
            "#CONTOUR MODE [DIST PRE_DIST={pre} POST_DIST={post}]\nN10 G01 X100 G61 F6000\nN20 Y10\nM30\n"
        ))
    };
    let left = |run: &Run| [run.lengths(10)[0], *run.lengths(20).last().unwrap()];
    let near = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).abs() < 1e-4 && (a[1] - b[1]).abs() < 1e-4;
    assert!(near(left(&dist(20.0, 20.0)), [95.0, 5.0]));
    assert!(near(left(&dist(20.0, 8.0)), [80.0, 5.0]));
}

/// Rows: D3-038.
#[test]
fn arcs_are_left_and_entered_by_at_most_a_quarter_turn() {
    // A full circle of radius 5 would give half its length; a corner of 90° to it.
    let text =
        "#CONTOUR MODE [DIST PRE_DIST=12 POST_DIST=12]\nN10 G01 X50 G61 F3000\nN20 G02 X50 Y0 I5 J0\nM30\n";
    let run = run(text);
    let quarter = 5.0 * std::f64::consts::FRAC_PI_2;
    assert!((run.lengths(10)[0] - (50.0 - quarter)).abs() < 1e-4, "{:?}", run.lengths(10));
    assert!((run.lengths(20).last().unwrap() - 3.0 * quarter).abs() < 1e-4, "{:?}", run.lengths(20));
}

/// Rows: D3-039, D3-040, D3-044, D3-045, D3-046, CF-10, CF-11.
#[test]
fn short_blocks_are_left_out() {
    let head = "N03 G01 X0 Y0 Z0 F4000\nG04 X0.1\n";
    let text = format!(
        "#CONTOUR MODE [DEV, PATH_DEV 5, RELEVANT_PATH 2]\n{head}N04 X5 G261\nN05 Y1\nN09 X10 Y3 G260\nN10 Y0\nM30\n"
    );
    let first = run(&text);
    assert!(first.lengths(5).is_empty(), "{:?}", first.lengths(5));
    assert!((first.lengths(4)[0] - 2.5).abs() < 1e-4, "{:?}", first.lengths(4));
    assert!((first.lengths(9).last().unwrap() - (29f64.sqrt() - 2.5)).abs() < 1e-4, "{:?}", first.lengths(9));
    // Several of them, inside a sphere; the one that leaves it counts even if it is short.
    let several = super_short("N05 X5.5\nN06 Y0.5\nN07 X5\nN08 Y1.4\nN09 X8 Y1.4\n");
    assert!([5, 6, 7].iter().all(|n| several.lengths(*n).is_empty()));
    assert!(!several.lengths(8).is_empty());
    // Where no curve follows, a line stands for them, and the end is the programmed one.
    let ended = super_short("N05 X5.5 Y0.3\n");
    assert_eq!(
        ended.trace.mm(ended.trace.len() - 1),
        [5.5, 0.3, 0.0].map(|x: f64| set_point((x * 1e6) as i64) as f64 / (1u64 << 32) as f64)
    );
    // A way out of the sphere below 16 µm becomes a line from where the blocks left out began.
    let replaced = super_short("N05 X5.6 Y0.79\nN06 X5.6 Y0.795\nN07 X5.607 Y0.805\nN08 X9 Y9\n");
    assert!([5, 6].iter().all(|n| replaced.lengths(*n).is_empty()), "{:?}", replaced.lengths(6));
    let curve_and_rest: f64 = replaced.lengths(7).iter().sum();
    assert!(curve_and_rest > 0.5, "{:?}", replaced.lengths(7));
    // The minimum is that of the system, not another one: the curve reaches into half of that line, or of the
    // block.
    for (end, stands) in [("X5.609 Y0.807", true), ("X5.607 Y0.809", true), ("X5.613 Y0.806", false)] {
        let text = format!("N05 X5.6 Y0.79\nN06 X5.6 Y0.795\nN07 {end}\nN08 X9 Y9\n");
        let reach = 5.0 - super_short(&text).lengths(4)[0];
        assert!(if stands { reach > 0.4 } else { reach < 0.01 }, "{end}: {reach}");
    }
    // Below 32 µm everything is short, whatever is programmed; above it nothing.
    for (x, y, short) in [(5.02, 0.02, true), (5.031, 0.0, true), (5.0, 0.0316, true), (5.0, 0.0324, false)] {
        for relevant in ["", "RELEVANT_PATH=0", "RELEVANT_PATH=0.01"] {
            for mode in ["DEV PATH_DEV=1", "DIST PRE_DIST=1 POST_DIST=1"] {
                let text = format!(
                    "#CONTOUR MODE ON [{mode} {relevant}]\nN10 G01 X5 F4000\nN20 X{x} Y{y}\nN30 X9 Y5\nM30\n"
                );
                assert_eq!(run(&text).lengths(20).is_empty(), short, "{text}");
            }
        }
    }
    // With RELEVANT_PATH that is the limit.
    for (y, short) in [(0.495, true), (0.505, false)] {
        let text = format!(
            "#CONTOUR MODE ON [DEV PATH_DEV=1 RELEVANT_PATH=0.5]\nN10 G01 X5 F4000\nN20 Y{y}\nN30 X9 Y5\nM30\n"
        );
        assert_eq!(run(&text).lengths(20).is_empty(), short, "{y}");
    }
}

/// Contouring goes on up to where it is switched off, gets other parameters or has to stand still: the corner
/// before the blocks left out is rounded, and the last of them ends where it was programmed to.
///
/// Rows: D3-048, D3-280.
#[test]
fn what_ends_a_row_of_short_blocks_keeps_the_corner_before_it() {
    let rows =
        |between: &str| super_short(&format!("N05 X5.3 Y0.4\nN06 X5.2 Y0.8\n{between}N07 X5.4 Y9\nN08 X9\n"));
    let corner = [5.0, 0.0];
    for (between, rounds_on) in [
        ("#CONTOUR MODE [PATH_DEV=0.5]\n", true),
        ("#CONTOUR MODE [POST_ACTION]\n", true),
        ("#CONTOUR MODE OFF\n", false),
        ("G260\n", false),
        ("G04 X0.1\n", true),
        ("#FLUSH&WAIT\n", true),
    ] {
        let run = rows(between);
        let [off, there] = [run.distance(corner), run.distance([5.2, 0.8])];
        // Of the line over both blocks the curve has half.
        assert!((0.05..0.3).contains(&off) && there < 0.02, "{between}: {off} {there}");
        let from = run.lengths(4)[0];
        assert!((from - 5.0 + 0.5 * 0.2_f64.hypot(0.8)).abs() < 1e-3, "{between}: {from}");
        assert_eq!(run.distance([5.4, 9.0]) > 0.3, rounds_on, "{between}");
        assert!(run.lengths(5).is_empty() && !run.lengths(6).is_empty(), "{between}");
        let end = run.trace.mm(run.trace.len() - 1);
        assert!((end[0] - 9.0).abs() < 1e-9 && (end[1] - 9.0).abs() < 1e-9);
    }
    // The program may end there, too, and the row may lead back.
    let ended = super_short("N05 X5.3 Y0.4\nN06 X5.2 Y0.8\n");
    assert!(ended.distance(corner) > 0.05 && ended.distance([5.2, 0.8]) < 1e-6);
    let back = super_short("N05 X5.3 Y0.4\nN06 X5 Y0\nG04 X0.1\nN07 Y9\n");
    assert!(back.distance(corner) < 1e-6);
    // What changes nothing ends nothing.
    let plain = rows("");
    for nothing in ["G261\n", "#CONTOUR MODE ON\n", "#CONTOUR MODE [PATH_DEV=1]\n"] {
        assert_eq!(rows(nothing).digest, plain.digest, "{nothing}");
    }
    assert!(plain.lengths(6).is_empty() && plain.distance([5.2, 0.8]) > 0.05);
}

/// RELEVANT_PATH is for both neighbours of a corner with DEV, for the one behind it with DIST; there a block
/// before it is too short below 16 µm.
///
/// Rows: D3-279, CF-36, CF-37.
#[test]
fn which_neighbours_the_relevant_path_concerns() {
    let joined = |mode: &str, x: f64| {
        let run = run(&format!(
            "N10 G01 X0 Y5 F4000\n#CONTOUR MODE ON [{mode} RELEVANT_PATH=2]\nN20 X{x} Y5.003\nN30 X20 Y9\nN40 Y30\nM30\n"
        ));
        run.lengths(20).is_empty()
    };
    for (x, dev, dist) in [
        (0.012, true, true),
        (0.015, true, true),
        (0.017, true, false),
        (1.0, true, false),
        (2.1, false, false),
    ] {
        assert_eq!(joined("DEV PATH_DEV=3", x), dev, "DEV {x}");
        assert_eq!(joined("DIST PRE_DIST=1 POST_DIST=1", x), dist, "DIST {x}");
    }
    for (y, short) in [(1.9, true), (2.1, false)] {
        for mode in ["DEV PATH_DEV=3", "DIST PRE_DIST=1 POST_DIST=1"] {
            let text = format!(
                "#CONTOUR MODE ON [{mode} RELEVANT_PATH=2]\nN20 G01 X20 F4000\nN30 Y{y}\nN40 X30 Y30\nM30\n"
            );
            assert_eq!(run(&text).lengths(30).is_empty(), short, "{mode} {y}");
        }
    }
}

/// A keyword counts for the methods that have it, and as if it had never been given for the others.
#[test]
fn keywords_are_not_inherited_by_methods_that_lack_them() {
    let machine = quick::<4>(1000);
    let text = |given: &str, mode: &str, path: &str| {
        format!("#CONTOUR MODE [{given}]\n#CONTOUR MODE ON [{mode}]\n{path}M30\n")
    };
    let corner = "N10 G01 X80 A5 F20000\nN20 Y0.5 A5.2\nN30 X160 Y20\nG260\nN40 Y90 M25\n";
    let arcs = "N10 G01 X40 F20000\nN20 G02 X60 Y20 I20\nN30 G01 X90 Y60 M25\nG260\nN40 Y90\n";
    let every = "REMAIN_PART=60 MAX_ANGLE=20 RELEVANT_PATH=1 RELEVANT_TRACK=1 TRACK_DEV=0.01 CHECK_JERK=0 CONST_VEL=1 POST_ACTION";
    for (mode, path) in [
        ("DIST_SOFT PATH_DIST=-1", corner),
        ("DIST_SOFT PATH_DIST=8", arcs),
        ("PTP PATH_DEV=2 INTER_ACTION", corner),
        ("PTP PATH_DIST=5 INTER_ACTION", corner),
    ] {
        for given in ["DEV", "DIST"] {
            let digest =
                |given: &str| run_from(&text(given, mode, path), [Position::ZERO; 4], &machine).digest;
            assert_eq!(digest(&format!("{given} {every}")), digest("DEV"), "{mode}\n{path}");
        }
    }
    let pos = "POS PRE_DIST=30 POST_DIST=30 X75 Y2 CHECK_JERK=1 CONST_VEL=0 INTER_ACTION";
    let digest = |given: &str| run_from(&text(given, pos, corner), [Position::ZERO; 4], &machine).digest;
    assert_eq!(digest(&format!("DEV {every}")), digest("DEV"));
    // They come back with their method.
    let back = |between: &str| {
        run_from(
            &text(
                &format!("DEV PATH_DEV=50 {every}"),
                between,
                "#CONTOUR MODE [DEV]\nN10 G01 X80 F20000\nN20 X160 Y10\n",
            ),
            [Position::ZERO; 4],
            &machine,
        )
    };
    assert_eq!(back("PTP").digest, back("DEV").digest);
    assert!((back("PTP").lengths(10)[0] - 64.0).abs() < 1e-4, "{:?}", back("PTP").lengths(10));
}

/// A dwell is at the programmed corner, and a warning says so.
#[test]
fn a_dwell_between_rounded_blocks_is_at_the_corner() {
    let warned = |text: &str| {
        let run = run(text);
        let said: Vec<_> = run
            .warnings
            .iter()
            .map(|(line, kind)| (*line, NcWarning { place: Place::NONE, kind: *kind }.to_string()))
            .collect();
        (run.distance([10.0, 0.0]), said)
    };
    let (off, said) = warned("G261\nN10 G01 X10 F1000\nG04 X0.1\nN20 Y10\nM30\n");
    let [(3, text)] = &said[..] else { panic!("{said:?}") };
    assert!(off < 1e-6 && text.contains("G04") && text.contains("corner"), "{off} {text}");
    // Not where there would be none.
    for text in [
        "N10 G01 X10 F1000\nG04 X0.1\nN20 Y10\nM30\n",
        "G261\nN10 G01 X10 F1000\nG260\nG04 X0.1\nN20 Y10\nM30\n",
        "G261\nN10 G01 G60 X10 F1000\nG04 X0.1\nN20 Y10\nM30\n",
        "G261\nG04 X0.1\nN10 G01 X10 F1000\nN20 Y10\nM30\n",
    ] {
        assert_eq!(warned(text).1, [], "{text}");
    }
}

fn super_short(blocks: &str) -> Run {
    run(&format!("#CONTOUR MODE ON [DEV PATH_DEV=1 RELEVANT_PATH=1]\nN04 G01 X5 F4000\n{blocks}M30\n"))
}

/// Rows: D3-047.
#[test]
fn a_short_block_to_begin_with_joins_the_next() {
    let run = run(
        "N10 G01 X0 Y5 F4000\n#CONTOUR MODE ON [DEV PATH_DEV=1 RELEVANT_PATH=2]\nN20 X1\nN30 X20\nN40 Y20\nM30\n",
    );
    assert!(run.lengths(20).is_empty() && (run.distance([20.0, 5.0]) - 1.0).abs() < 0.01);
}

/// Rows: D3-154.
#[test]
fn knees_beyond_the_largest_angle_stay() {
    let text = "#CONTOUR MODE [DEV PATH_DEV=0.5]\nN1 F10000\nG261\nN5 #CONTOUR MODE [MAX_ANGLE=91]\nN10 G01 X50 Y0\nN15 #CONTOUR MODE [MAX_ANGLE=89]\nN20 X50 Y50\nN25 #CONTOUR MODE [MAX_ANGLE=6]\nN30 X0 Y50\nN40 X0 Y0\nM30\n";
    let run = run(text);
    // N10 took the limit before it, N20 the next one.
    assert!(
        run.distance([50.0, 0.0]) > 0.49
            && run.distance([50.0, 50.0]) < 0.05
            && run.distance([0.0, 50.0]) < 0.05
    );
}

/// Two lines of 20 mm at this knee, or an arc instead of one of them. At constant speed no curve gives way to
/// a standstill.
#[test]
fn the_largest_angle_is_178_degrees_and_concerns_two_lines() {
    let pieces = |knee: f64, parameters: &str, arc: usize| {
        let (sin, cos) = (180.0 - knee).to_radians().sin_cos();
        let [x, y] = [20.0 - 20.0 * cos, 20.0 * sin];
        // Half a circle of 20 mm, whose tangent at the corner is that of the line.
        let (i, j) = (20.0 * sin, 20.0 * cos);
        let behind = format!("N20 G03 X{:.6} Y{:.6} I{:.6} J{:.6}", 20.0 - 2.0 * i, -2.0 * j, -i, -j);
        let blocks = match arc {
            0 => format!("N10 G01 X20\nN20 X{x:.6} Y{y:.6}"),
            1 => format!("N10 G02 X20 Y0 I10 J0\nN20 G01 X{:.6} Y{:.6}", 20.0 - 20.0 * sin, -20.0 * cos),
            _ => format!("N10 G01 X20\n{behind}"),
        };
        let text = format!(
            "F3000\n#CONTOUR MODE ON [DEV PATH_DEV=0.1 CONST_VEL=1 {parameters}]\n{blocks}\nG260\nM30\n"
        );
        let run = run(&text);
        run.lengths(10).len() + run.lengths(20).len()
    };
    assert!(pieces(177.5, "", 0) > 2 && pieces(177.9, "", 0) > 2);
    assert!(pieces(178.2, "", 0) == 2 && pieces(179.0, "", 0) == 2);
    assert!(pieces(179.0, "MAX_ANGLE=180", 0) > 2);
    for arc in [1, 2] {
        for parameters in ["", "MAX_ANGLE=30", "MAX_ANGLE=1"] {
            assert!(pieces(90.0, parameters, arc) > 2, "{arc} {parameters}");
        }
    }
    assert_eq!(pieces(90.0, "MAX_ANGLE=30", 0), 2);
    // Nor is it one of POS.
    let pos = run(
        "#CONTOUR MODE [DEV MAX_ANGLE=30]\n#CONTOUR MODE ON [POS X19 Y1]\nN10 G01 X20 F3000\nN20 G260 Y20\nM30\n",
    );
    assert!(pos.lengths(10).len() > 1);
}

/// Rows: D3-155.
#[test]
fn a_sweep_of_angles_is_rounded_up_to_the_limit() {
    let text = "#CONTOUR MODE [DEV PATH_DEV=0.50 RELEVANT_PATH=0.1 MAX_ANGLE=73]\nP100 = 50\nF10000\nN10 G01 X-P100 Y0\n$FOR P123 = 0, 90, 7.5\nN2 G01 X0 Y0 G61\nP1 = COS[P123]*P100\nP2 = SIN[P123]*P100\nNP123 XP1 YP2\nN100 G01 X-P100 Y0\n$ENDFOR\nM30\n";
    let run = run(text);
    let curves = run
        .blocks
        .windows(3)
        .filter(|w| w[0].n == 2 && w[1].n == 2 && w[0].block == w[1].block && w[2].n != 2)
        .count();
    assert_eq!(curves, 9);
}

/// Rows: D3-055, CF-08.
#[test]
fn jerk_is_checked_where_it_is_asked_for() {
    let text = |check: u8| {
        format!(
            "#CONTOUR MODE [DEV PATH_DEV 4 CONST_VEL=1 CHECK_JERK={check}]\nN6 G01 X100 G61 F20000\nN8 Y100\nM30\n"
        )
    };
    let [none, geometric, ramps] = [0, 1, 2].map(|check| run(&text(check)).time());
    let mut machine = machines::even::<3>(1000);
    for axis in &mut machine.axes {
        axis.tr_geom = 10_000;
    }
    let hard = run_from(&text(1), [Position::ZERO; 3], &machine).time();
    let soft = run_from(&text(2), [Position::ZERO; 3], &machine).time();
    assert!(none < geometric && geometric == ramps, "{none} {geometric} {ramps}");
    assert!(hard < soft, "{hard} {soft}");
    // At the highest speed no less time is needed with a check than without.
    let varying = |check: u8| run(&text(check).replace(" CONST_VEL=1", "")).time();
    assert!(varying(0) <= varying(1) && varying(1) < geometric, "{} {}", varying(0), varying(1));
    // P-CHAN-00110 until the program says otherwise.
    let plain = "#CONTOUR MODE [DEV PATH_DEV 4 CONST_VEL=1]\nN6 G01 X100 G61 F20000\nN8 Y100\nM30\n";
    assert_eq!(run(plain).time(), geometric);
    machine.channel.check_jerk_on_poly_path = 2;
    assert_eq!(run_from(plain, [Position::ZERO; 3], &machine).time(), soft);
    // Sampled when the curve is made: between the blocks is not too late.
    let between = "#CONTOUR MODE [DEV PATH_DEV 4 CONST_VEL=1 CHECK_JERK=1]\nN6 G01 X100 G61 F20000\n#CONTOUR MODE [CHECK_JERK=0]\nN8 Y100\nM30\n";
    assert_eq!(run(between).time(), none);
}

/// CHECK_JERK=1: P-AXIS-00199 limits the jerk that a curve causes where it is longer than the ramp times,
/// too.
///
/// Rows: D3-053.
#[test]
fn a_geometric_ramp_time_above_the_ramp_times_slows_curves_down() {
    let run = |check: u8, geometric: u32| {
        let mut machine = machines::even::<3>(1000);
        for axis in &mut machine.axes {
            axis.tr_geom = geometric;
        }
        let text = format!(
            "#CONTOUR MODE [DEV PATH_DEV 4 CONST_VEL=1 CHECK_JERK={check}]\nN6 G01 X100 G61 F20000\nN8 Y100\nM30\n"
        );
        run_from(&text, [Position::ZERO; 3], &machine)
    };
    let [short, long] = [50_000, 200_000].map(|geometric| run(1, geometric));
    assert!(short.time() < long.time(), "{} {}", short.time(), long.time());
    // Ramp times are not its business.
    assert_eq!(run(2, 50_000).time(), run(2, 200_000).time());
    // a / geometric ramp time inside the curve, away from its ends: mm/s³.
    let a = f64::from(machines::even::<3>(1000).axes[0].a_max);
    let jerk = |run: &Run| {
        let rows: Vec<_> = (0..run.trace.len()).map(|k| run.trace.mm(k)).collect();
        let curve = |q: &[f64]| q[0] < 100.0 - 0.05 && q[1] > 0.05;
        let inside = rows.windows(4).filter(|w| w.iter().all(|q| curve(q)));
        let third = |w: &[Vec<f64>], k: usize| (w[3][k] - 3.0 * (w[2][k] - w[1][k]) - w[0][k]).abs() / 1e-9;
        inside.flat_map(|w| [third(w, 0), third(w, 1)]).fold(0.0, f64::max)
    };
    for (run, ramp) in [(&short, 0.05), (&long, 0.2)] {
        let (jerk, limit) = (jerk(run), a / ramp);
        println!("{jerk} of {limit} mm/s³");
        assert!(jerk <= limit, "{jerk} of {limit} mm/s³");
        assert!(jerk > 0.2 * limit, "{jerk} of {limit} mm/s³");
    }
}

#[test]
fn constant_speed_through_the_corner() {
    let text = "#CONTOUR MODE [DEV PATH_DEV=2 CONST_VEL=1]\nN10 G01 X100 G61 F8000\nN20 X30 Y100\nM30\n";
    let run = run(text);
    // Rows between the end of N10's line and the begin of N20's.
    let (mut low, mut high, mut rows) = (f64::INFINITY, 0.0_f64, 0);
    let edge = run.lengths(10)[0];
    for (i, v) in run.speeds().into_iter().enumerate() {
        let [q, p] = [run.trace.mm(i + 1), run.trace.mm(i)];
        let on_second = |q: &[f64]| ((q[0] - 100.0) / -70.0 - q[1] / 100.0).abs() < 1e-9;
        if q[0] > edge + 0.2
            && p[0] > edge + 0.2
            && !on_second(&q)
            && q[1] > 0.0
            && p[1] > 0.0
            && !on_second(&p)
        {
            (low, high, rows) = (low.min(v), high.max(v), rows + 1);
        }
    }
    assert!(rows > 20 && high / low < 1.001, "{rows} rows, {low} … {high}");
}

/// Each corner with both.
#[test]
fn the_speed_varies_in_the_curve_unless_it_is_to_be_constant() {
    let mut faster = 0;
    for (dev, x, y) in [(0.2, 50, 50), (2.0, 100, 100), (2.0, 30, 100), (1.0, 60, 80), (5.0, 100, 60)] {
        for slope in 0..3 {
            let machine = machines::with_slope(machines::mill(1000), slope);
            let go = |constant: u8| {
                let text = format!(
                    "#CONTOUR MODE [DEV PATH_DEV={dev} CONST_VEL={constant}]\nN10 G01 X100 G61 F40000\nN20 X{x} Y{y}\nM30\n"
                );
                run_from(&text, [Position::ZERO; 3], &machine)
            };
            let [varying, constant] = [go(0), go(1)];
            let inside = |run: &Run| {
                let from = run.lengths(10)[0];
                let rows = (1..run.trace.len()).map(|i| (run.trace.mm(i - 1), run.trace.mm(i)));
                let curve = rows.zip(run.speeds()).filter(|((p, q), _)| {
                    let off = |q: &[f64]| (q[0] - 100.0) * f64::from(y) - q[1] * f64::from(x - 100);
                    p[0] > from + 0.01 && p[1] > 0.0 && off(q).abs() > 1e-3
                });
                curve.fold([f64::INFINITY, 0.0], |[low, high], (_, v)| [v.min(low), v.max(high)])
            };
            let [low, high] = inside(&varying);
            let what = format!("PATH_DEV={dev} X{x} Y{y}, slope {slope}");
            // STEP knows no jerk: its curve is passed evenly, and sooner. A standstill may be the quickest of
            // all.
            let sharp = low == f64::INFINITY;
            assert!(slope == 0 || sharp || high > 1.05 * low, "{what}: {low} … {high}");
            let [least, most] = inside(&constant);
            assert!(most < 1.002 * least, "{what}: {least} … {most}");
            // STEP: its acceleration is divided between path and contour by element, which may cost a tick or
            // two.
            let more = if slope == 0 { 1.003 } else { 1.0 };
            assert!(
                varying.time() <= more * constant.time(),
                "{what}: {} {}",
                varying.time(),
                constant.time()
            );
            faster += usize::from(varying.time() < constant.time());
        }
    }
    assert!(faster >= 10, "{faster} of 15");
}

/// As in D3-EX08: a corner with the speed that each of its parts permits, and another one with constant
/// speed.
///
/// Rows: D3-058.
#[test]
fn constant_speed_is_switched_on_from_corner_to_corner() {
    let text = "#CONTOUR MODE ON [DEV PATH_DEV=2]\nN6 G01 X100 F40000\nN7 Y100\n\
        #CONTOUR MODE [CONST_VEL=1]\nN8 X0\n#CONTOUR MODE [CONST_VEL=0]\nN9 G260 Y200\nM30\n";
    let run = run_from(text, [Position::ZERO; 3], &machines::mill(1000));
    // Rows inside a curve are on none of the lines.
    let inside = |x: std::ops::Range<f64>, y: std::ops::Range<f64>| {
        let seen = (1..run.trace.len()).zip(run.speeds()).filter(|(i, _)| {
            [run.trace.mm(i - 1), run.trace.mm(*i)].iter().all(|q| x.contains(&q[0]) && y.contains(&q[1]))
        });
        let speeds = seen.fold([f64::INFINITY, 0.0], |[low, high], (_, v)| [v.min(low), v.max(high)]);
        speeds[1] / speeds[0]
    };
    let near = 1e-4;
    let (upto, from) = (50.0..100.0 - near, near..50.0);
    let seen = [
        inside(upto.clone(), from.clone()),
        inside(upto.clone(), upto.clone()),
        inside(from, 100.0 + near..150.0),
    ];
    assert!(seen[0] > 1.05 && (1.0..1.002).contains(&seen[1]) && seen[2] > 1.05, "{seen:?}");
}

/// The little acceleration of such a curve is not that of the lines beside it: with HSC they were one span,
/// which took 30 times as long.
#[test]
fn constant_speed_costs_no_more_with_hsc() {
    for (dev, y) in [(1.0, 10), (1.0, 60), (0.1, 60), (0.01, 60)] {
        let time = |slope: u8| {
            let text =
                format!("#CONTOUR MODE ON [DEV PATH_DEV={dev} CONST_VEL=1]\nG01 X60 F6000\nG260 Y{y}\nM30\n");
            let machine = machines::with_slope(machines::mill(1000), slope);
            run_from(&text, [Position::ZERO; 3], &machine).time()
        };
        let [trapez, hsc] = [time(1), time(3)];
        // Of four ramp times HSC takes the longest.
        assert!(hsc <= 1.1 * trapez, "PATH_DEV={dev} Y{y}: {hsc} s, {trapez} s with TRAPEZ");
    }
}

#[test]
fn functions_between_the_blocks_are_due_in_the_middle_of_the_curve() {
    let text = "#CONTOUR MODE [DEV, PATH_DEV 4, INTER_ACTION]\nN110 G01 X100 G61 M25 F6000\nN120 Y100\nM30\n";
    let run = run(text);
    let [(row, event)] = run.events[..] else { panic!("{:?}", run.events) };
    assert_eq!(event.function, Function::M(25));
    let at = run.trace.mm(row);
    // On the bisector, not further on than a tick.
    assert!((100.0 - at[0] - at[1]).abs() < 0.2 && at[1] > 0.0, "{at:?}");
}

#[test]
fn every_axis_stays_inside_its_limits() {
    for seed in host_tests::seeds::seeds(0..24, 2) {
        let mix = Mix { length: [0.05, 40.0], knee: 3.0, ..Mix::general(3, 40) };
        limits_hold::<3>(&program(seed, mix), &machines::even(1000), "DEV PATH_DEV=0.2 MAX_ANGLE=180");
        limits_hold::<3>(&program(seed, mix), &machines::mill(1000), "DIST PRE_DIST=2 POST_DIST=1");
        let mut mill = machines::mill::<3>(1000);
        mill.channel.slope_profile = 3;
        limits_hold::<3>(&program(seed, mix), &quick(1000), "DEV PATH_DEV=0.05 MAX_ANGLE=180");
        limits_hold::<3>(&program(seed, mix), &mill, "DEV PATH_DEV=0.02");
        limits_hold::<3>(&program(seed, mix), &quick(1000), "DIST_SOFT PATH_DIST=1");
        limits_hold::<3>(&program(seed, mix), &quick(1000), "DIST_SOFT PATH_DIST=5 DIST_WEIGHT=70");
        mill.channel.slope_profile = 2;
        limits_hold::<3>(&program(seed, mix), &mill, "DIST_SOFT PATH_DIST=-1 ACC_MIN=100");
        mill.channel.slope_profile = 0;
        limits_hold::<3>(&program(seed, mix), &mill, "DIST_SOFT PATH_DIST=3");
        let lines = Mix { arcs: 0, ..mix };
        limits_hold::<3>(&program(seed, lines), &quick(1000), "PTP PATH_DEV=0.1");
        mill.channel.slope_profile = 1;
        mill.channel.ptp = true;
        limits_hold::<3>(&program(seed, lines), &mill, "PTP PATH_DEV=0.5");
        let turning = Mix { length: [0.5, 40.0], knee: 3.0, ..Mix::general(5, 30) };
        limits_hold::<5>(&program(seed, turning), &machines::uneven(1000), "DEV PATH_DEV=0.2 TRACK_DEV=0.5");
        limits_hold::<5>(&program(seed, turning), &quick(4000), "DEV PATH_DEV=0.2 TRACK_DEV=0.1");
        limits_hold::<5>(&program(seed, turning), &quick(1000), "DIST_SOFT PATH_DIST=5 TRACK_DIST=2");
        limits_hold::<5>(
            &program(seed, turning),
            &machines::even(4000),
            "DEV PATH_DEV=0.5 RELEVANT_PATH=1 RELEVANT_TRACK=5",
        );
    }
}

fn limits_hold<const AXES: usize>(program: &Program, machine: &MachineData<AXES>, mode: &str) {
    let text = program.text(machine).replacen("N1 G90\n", &format!("N1 G90\n#CONTOUR MODE ON [{mode}]\n"), 1);
    let start: [Position; AXES] = std::array::from_fn(|k| Position::from_bits(set_point(program.start[k])));
    let run = run_from(&text, start, machine);
    let contour = program.contour(machine);
    let limits = axis_limits(machine, &contour);
    check::limits(&run.trace, &limits)
        .unwrap_or_else(|fault| panic!("{} [{mode}]: {fault}\n{text}", program.name));
    let end: Vec<i64> = program.end().iter().map(|&nm| set_point(nm)).collect();
    assert!(run.trace.row(run.trace.len() - 1).eq(end), "{} [{mode}]", program.name);
}

/// Rows: D3-028, D3-031.
#[test]
fn tracking_axes_bend_along_and_keep_their_tolerance() {
    let machine = machines::even::<5>(1000);
    let program = Program::new("tracking", 5)
        .line(&[50.0, 0.0, 0.0, 20.0, 0.0], 3000.0)
        .line(&[50.0, 50.0, 0.0, -40.0, 30.0], 3000.0);
    let blocks = blocks(&program, &machine);
    let degrees = |d: i64| Some(Position::from_bits(set_point(d)));
    let dev = |path_dev: i64| Contour { const_vel: Some(true), ..dev(path_dev) };
    let free = round(&blocks, &machine, &dev(1_000_000));
    let bound = round(&blocks, &machine, &Contour { track_dev: degrees(100_000), ..dev(1_000_000) });
    let dist = round(
        &blocks,
        &machine,
        &Contour {
            method: Some(ContourMethod::Dist),
            track_dev: degrees(100_000),
            pre_dist: degrees(5_000_000),
            post_dist: degrees(5_000_000),
            ..Contour::default()
        },
    );
    // The value of each tracking axis where the curve is nearest to the corner.
    let off = |pieces: &[host_tests::corner::Piece<5>]| {
        let curve: Vec<_> = pieces.iter().filter(|p| p.out.curving.is_some()).collect();
        let q = curve[curve.len() / 2].at(0.0);
        (q[3] - 20.0).abs().max(q[4].abs())
    };
    assert!(off(&free) > 0.2, "{}", off(&free));
    for pieces in [&bound, &dist] {
        assert!((0.0995..=0.1).contains(&off(pieces)), "{}", off(pieces));
        for pair in pieces.windows(2) {
            let (before, behind) = (pair[0].ends(true), pair[1].ends(false));
            for order in 0..2 {
                let noise = 2.0 * (before.1[order] + behind.1[order]) + 1e-6;
                for k in 0..5 {
                    let jump = (before.0[order][k] - behind.0[order][k]).abs();
                    assert!(jump < noise, "axis {k}, order {order}: {jump} above {noise}");
                }
            }
        }
    }
    // Straight on in space: without a tolerance for tracking axes nothing to round, with one there is.
    let straight = Program::new("straight", 5)
        .line(&[50.0, 0.0, 0.0, 20.0, 0.0], 3000.0)
        .line(&[100.0, 0.0, 0.0, -40.0, 30.0], 3000.0);
    let straight = host_tests::corner::blocks(&straight, &machine);
    assert_eq!(round(&straight, &machine, &dev(1_000_000)).len(), 2);
    let bound = round(&straight, &machine, &Contour { track_dev: degrees(100_000), ..dev(1_000_000) });
    assert!(bound.len() > 2 && (0.0995..=0.1).contains(&off(&bound)), "{}", bound.len());
}

#[test]
fn what_cannot_be_a_curve_stays_a_corner() {
    for mode in [
        "DEV PATH_DEV=0",
        "DEV REMAIN_PART=100",
        "DIST PRE_DIST=0 POST_DIST=0",
        "POS PRE_DIST=1 POST_DIST=1 X90000 Y-90000 Z0",
    ] {
        let run = run(&format!("#CONTOUR MODE [{mode}]\nN10 G01 X100 G61 F6000\nN20 Y100\nM30\n"));
        assert!(run.distance([100.0, 0.0]) < 1e-2 && run.blocks.len() == 2, "{mode}: {}", run.blocks.len());
        assert_eq!(run.trace.mm(run.trace.len() - 1), [100.0, 100.0, 0.0]);
    }
    // A long way round is one where there is room for it.
    let far = run(
        "#CONTOUR MODE [POS PRE_DIST=1 POST_DIST=1 X400 Y-300 Z50]\nN10 G01 X100 G61 F60000\nN20 Y100\nM30\n",
    );
    assert!(far.distance([400.0, -300.0]) < 1.0);
}

/// Through a point a picometre beside its start the curve is bent more than the format of a polynomial holds:
/// a straight line leads to its end, and the program ends where it has to, to the bit.
#[test]
fn a_curve_that_no_format_holds_ends_where_it_has_to() {
    for (pre, post) in [(1e-6, 1e-5), (1e-6, 1e-3), (1e-6, 0.1), (1e-5, 1e-9)] {
        let contour = format!(
            "#CONTOUR MODE [POS PRE_DIST={pre:.9} POST_DIST={post:.9} X{:.9} Y0 Z0]",
            10.0 - pre + 1e-9
        );
        let run = run(&format!("{contour}\nN10 G01 X10 G61 F600\nN20 Y10\nM30\n"));
        let last = run.trace.row(run.trace.len() - 1).collect::<Vec<_>>();
        assert_eq!(last, [10 << 32, 10 << 32, 0], "{contour}");
    }
}

/// What changes the dynamics behind a block leaves it as it was programmed, though smoothing still holds it back:
/// #SLOPE, weights, #VECTOR LIMIT.
#[test]
fn a_block_held_back_keeps_its_dynamics() {
    let mut machine = machines::with_slope(quick::<3>(1000), 1);
    machine.channel.surface = true;
    let run = |text: &str| run_from::<3>(text, [Position::ZERO; 3], &machine);
    let block = "N10 G01 X100 F6000\n";
    for mode in [
        "#CONTOUR MODE ON [DEV PATH_DEV=0.1]\n",
        "#CONTOUR MODE ON [DIST_SOFT PATH_DIST=5]\n",
        "#HSC ON [SURFACE PATH_DEV=0.1]\n",
        "#HSC ON [BSPLINE PATH_DEV=0.1]\n",
        "G151\n",
    ] {
        let alone = run(&format!("{mode}{block}M30\n"));
        for change in ["#SLOPE [TYPE=STEP]", "G131 20", "G133 400", "G130 X30", "#VECTOR LIMIT ON [VEL=1000]"]
        {
            let text = format!("{mode}{block}{change}\nM30\n");
            assert_eq!(run(&text).digest, alone.digest, "{text}");
            // It acts on the next one, whatever is on.
            let text = format!("{mode}{change}\n{block}M30\n");
            assert_ne!(run(&text).digest, alone.digest, "{text}");
        }
    }
    // The next block begins where it ends, with what it changed.
    for change in ["G131 20", "G133 400"] {
        let run = run(&format!("#CONTOUR MODE ON [DEV PATH_DEV=0.1]\n{block}{change}\nN20 Y100\nM30\n"));
        let at = run.distance([100.0, 0.0]);
        assert!(at < 1e-3, "{change}: {at}");
    }
}

/// A command that changes none of that is as if it were not there: the corner is rounded, the row goes on.
#[test]
fn what_changes_no_dynamics_ends_no_row() {
    for (slope, name) in [(1, "TRAPEZ"), (3, "HSC")] {
        let mut machine = machines::with_slope(quick::<3>(1000), slope);
        machine.channel.surface = true;
        let run = |text: &str| run_from::<3>(text, [Position::ZERO; 3], &machine);
        for mode in [
            "#CONTOUR MODE ON [DEV PATH_DEV=0.5]",
            "#HSC ON [SURFACE PATH_DEV=0.1]",
            "#HSC ON [BSPLINE PATH_DEV=0.1]",
            "G151",
        ] {
            let text = |between: &str| {
                let before = format!("G131 80\nG132 X70\n#VECTOR LIMIT ON [VEL=5000]\n{mode}\n");
                let row = "N10 G01 X20 F6000\nN20 X25 Y2\n";
                format!("{before}{row}{between}\nN30 X30 Y6\nN40 X40 Y20\nM30\n")
            };
            let alone = run(&text(""));
            let same = format!("#SLOPE [TYPE={name}]");
            for nothing in [
                same.as_str(),
                "#SLOPE DEFAULT",
                "G131 80",
                "G132 X70",
                "#VECTOR LIMIT ON [VEL=5000]",
                "#VECTOR LIMIT OFF [ACC]",
            ] {
                assert_eq!(run(&text(nothing)).digest, alone.digest, "{}", text(nothing));
            }
            for change in
                ["#SLOPE [TYPE=SIN2]", "G131 81", "G132 X71", "G132 Y70", "#VECTOR LIMIT ON [VEL=5001]"]
            {
                assert_ne!(run(&text(change)).digest, alone.digest, "{}", text(change));
            }
        }
    }
}

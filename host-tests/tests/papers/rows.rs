//! Rows of docs/conformance.md whose faults in the code no other test had found.
use glidepath::machine::AxisKind;
use glidepath::nc::{Contour, ContourMethod};
use glidepath::quantity::Position;
use host_tests::cases::{Program, machines};
use host_tests::corner::{blocks, position, round};
use host_tests::reference::profile::{Profile, Ramps};
use host_tests::rounded::{quick, run_from};
use host_tests::trace::run;

/// No curve straight on and straight back, with any method that has its distance from the corner alone; one
/// at a corner between.
#[test]
fn no_method_makes_a_curve_straight_on_or_straight_back() {
    let mut machine = machines::even::<3>(1000);
    machine.channel.ptp = true;
    let mm = |x: i64| Some(position(x * 1_000_000));
    let method = |method| Contour { method: Some(method), max_angle: mm(180), ..Contour::default() };
    let methods = [
        Contour { path_dev: mm(1), ..method(ContourMethod::Dev) },
        Contour { pre_dist: mm(2), post_dist: mm(2), ..method(ContourMethod::Dist) },
        Contour { pre_dist: mm(3), post_dist: mm(1), ..method(ContourMethod::Dist) },
        Contour { path_dist: mm(3), ..method(ContourMethod::DistSoft) },
        Contour { path_dev: mm(1), ..method(ContourMethod::Ptp) },
    ];
    for slope in [1, 3] {
        machine.channel.slope_profile = slope;
        for contour in &methods {
            for (to, curves) in
                [([20.0, 0.0], false), ([3.0, 0.0], false), ([20.0, 5.0], true), ([5.0, 5.0], true)]
            {
                let program = Program::new("corner", 3).line(&[10.0, 0.0], 6000.0).line(&to, 6000.0);
                let pieces = round(&blocks(&program, &machine), &machine, contour);
                let curve = pieces.iter().filter(|piece| piece.out.curving.is_some()).count();
                assert_eq!(
                    curve > 0,
                    curves,
                    "slope {slope}, {:?}, to {to:?}: {curve} pieces",
                    contour.method
                );
            }
        }
    }
}

/// CF-05: with HSC all four changes of acceleration take the longest of the four ramp times.
///
/// Rows: D3-270.
#[test]
fn hsc_has_the_longest_ramp_time() {
    let mut machine = machines::uneven::<3>(1000);
    machine.channel.slope_profile = 3;
    let x = &machine.axes[0];
    let ramps = [x.tr_beschl_zu, x.tr_beschl_ab, x.tr_brems_zu, x.tr_brems_ab].map(|us| f64::from(us) * 1e-6);
    let longest = ramps.into_iter().fold(0.0, f64::max);
    let law = |a: u32, ramp: f64| Ramps { a: f64::from(a), up: ramp, down: ramp };
    for (length, feed) in [(20.0, 24_000.0), (300.0, 24_000.0), (300.0, 9000.0)] {
        let program = Program::new("line", 3).line(&[length], feed);
        let ticks = run::<3, 120>(&program, &machine).expect("it runs").trace.ticks() as f64;
        let (up, down) = (law(x.a_beschl, longest), law(x.a_brems, longest));
        let fastest = Profile::fastest(length, 0.0, 0.0, feed / 60.0, up, down).expect("from rest to rest");
        let wanted = fastest.time() * 1000.0;
        assert!((ticks - wanted).abs() < 1.0 + 2e-4 * wanted, "{length} mm: {ticks} ticks, not {wanted}");
    }
}

/// A block of 14 µm between long ones is left out by distances, and never by an interim point.
#[test]
fn an_interim_point_leaves_no_block_out() {
    let machine = machines::even::<3>(1000);
    let mm = |x: i64| Some(position(x * 1_000_000));
    let program = Program::new("short", 3)
        .line(&[10.0], 6000.0)
        .line(&[10.01, 0.01], 6000.0)
        .line(&[20.0, 8.0], 6000.0);
    let dist = Contour {
        method: Some(ContourMethod::Dist),
        pre_dist: mm(2),
        post_dist: mm(2),
        max_angle: mm(180),
        ..Contour::default()
    };
    let pos = Contour { method: Some(ContourMethod::Pos), ..dist };
    for (contour, wanted) in [(dist, 2), (pos, 3)] {
        let pieces = round(&blocks(&program, &machine), &machine, &contour);
        let mut numbers: Vec<u32> = pieces.iter().map(|piece| piece.out.data.number).collect();
        numbers.dedup();
        assert_eq!(numbers.len(), wanted, "{:?}: {numbers:?}", contour.method);
    }
}

/// CF-33, PTP with PATH_DIST alone: the curve begins there, and the deviation is what comes of it; with both the
/// smaller one counts.
///
/// Rows: D3-143.
#[test]
fn a_distance_of_ptp_counts_without_its_deviation() {
    let corner = |mode: &str| {
        let text =
            format!("#CONTOUR MODE ON [{mode}]\nN10 G01 X80 F20000\nN20 Y80\n#CONTOUR MODE OFF\nM30\n");
        let run = run_from(&text, [Position::ZERO; 3], &quick::<3>(1000));
        let rows = (0..run.trace.len()).map(|row| run.trace.mm(row));
        let leaves = rows.filter(|q| q[1] == 0.0).map(|q| q[0]).fold(0.0, f64::max);
        (80.0 - leaves, run.distance([80.0, 0.0]))
    };
    let (distance, off) = corner("PTP PATH_DIST=20");
    assert!((19.0..20.4).contains(&distance) && off > 1.2, "{distance} mm before the corner, {off} mm off");
    let (shorter, off) = corner("PTP PATH_DIST=5");
    assert!((4.5..5.4).contains(&shorter) && off > 0.1, "{shorter} mm before the corner, {off} mm off");
    let (_, kept) = corner("PTP PATH_DIST=20 PATH_DEV=0.3");
    assert!(kept <= 0.3 + 1e-3, "{kept} mm off");
    let (kept, _) = corner("PTP PATH_DIST=5 PATH_DEV=3");
    assert!((4.5..5.4).contains(&kept), "{kept} mm before the corner");
    // Of two commands the last one holds, whichever is the smaller corner.
    let [(last, off), (_, kept)] = [
        "PATH_DEV=0.3]\n#CONTOUR MODE ON [PTP PATH_DIST=20",
        "PATH_DIST=5]\n#CONTOUR MODE ON [PTP PATH_DEV=3",
    ]
    .map(|commands| corner(&format!("PTP {commands}")));
    assert_eq!(last, distance);
    assert!(off > 1.2 && kept > 1.0, "{off} mm, {kept} mm off");
}

/// D3-003, every slope with every method: of 100 mm the first half is what it is without a method, and another
/// one with another slope.
#[test]
fn every_slope_goes_with_every_method_d3_003() {
    let mut machine = machines::with_slope(machines::uneven::<3>(1000), 1);
    (machine.channel.ptp, machine.channel.surface) = (true, true);
    // Along X the feed is the same.
    let led = machines::feeding(machine, &[0]);
    let methods = [
        ("#CONTOUR MODE ON [DEV PATH_DEV=0.2]", "#CONTOUR MODE OFF"),
        ("#CONTOUR MODE ON [DIST PRE_DIST=2 POST_DIST=2]", "#CONTOUR MODE OFF"),
        ("#CONTOUR MODE ON [POS PRE_DIST=4 POST_DIST=4 X100 Y0.3]", "#CONTOUR MODE OFF"),
        ("#CONTOUR MODE ON [DIST_SOFT PATH_DIST=4]", "#CONTOUR MODE OFF"),
        ("#CONTOUR MODE ON [DIST_MASTER SYM_DIST=4]", "#CONTOUR MODE OFF"),
        ("#CONTOUR MODE ON [PTP PATH_DIST=4]", "#CONTOUR MODE OFF"),
        ("#HSC ON [SURFACE PATH_DEV=0.2]", "#HSC OFF"),
        ("#HSC ON [BSPLINE PATH_DEV=0.2]", "#HSC OFF"),
    ];
    let moved = |slope: &str, (on, off): (&str, &str)| {
        let path = "N10 G01 X100 F9000\nN20 X150 Y40\nN30 X160 Y90";
        let text = format!("#SLOPE [TYPE={slope}]\n{on}\n{path}\n{off}\nM30\n");
        let machine = if on.contains("DIST_MASTER") { &led } else { &machine };
        let run = run_from(&text, [Position::ZERO; 3], machine);
        let begins = (0..run.trace.len()).map(|row| run.trace.mm(row)).take_while(|q| q[0] < 50.0);
        (begins.collect::<Vec<_>>(), run.distance([100.0, 0.0]), run.trace.mm(run.trace.len() - 1))
    };
    // Limits of a spline are rounded: 1.2 µm here.
    let alike = |a: &[Vec<f64>], b: &[Vec<f64>]| {
        a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a[0] - b[0]).abs() < 2e-3)
    };
    let mut plain: Vec<Vec<Vec<f64>>> = Vec::new();
    for slope in ["STEP", "TRAPEZ", "SIN2", "HSC"] {
        let (alone, off, _) = moved(slope, ("(none)", "(none)"));
        assert!(off < 1e-3, "{slope}: {off} mm off");
        assert!(!plain.iter().any(|other| alike(other, &alone)), "{slope} is another one");
        for method in methods {
            let (begins, off, end) = moved(slope, method);
            assert!(alike(&begins, &alone), "{slope}, {}: another begin", method.0);
            assert!(off > 0.02, "{slope}, {}: {off} mm off", method.0);
            assert_eq!(end[..2], [160.0, 90.0], "{slope}, {}", method.0);
        }
        plain.push(alone);
    }
}

/// CF-17, P-AXIS-00001 and P-AXIS-00011 of a spindle count for nothing, whatever they are.
#[test]
fn a_spindle_limits_nothing_cf_17() {
    let path = "S1000 M3\nN10 G01 X100 F9000\nN20 Y60\nN30 G00 X20\nM30\n";
    for slope in [0, 1] {
        let moved = |of_spindle: u32| {
            let mut machine = machines::with_slope(machines::uneven::<4>(1000), slope);
            let spindle = &mut machine.axes[3];
            spindle.kind = AxisKind::Spindle;
            (spindle.a_beschl, spindle.a_stufe) = (of_spindle, [of_spindle; 2]);
            (spindle.a_brems, spindle.d_stufe, spindle.a_max) = (of_spindle, [of_spindle; 2], of_spindle);
            run_from(path, [Position::ZERO; 4], &machine)
        };
        let [usual, weak, none] = [1000, 1, 0].map(moved);
        assert!(usual.trace.len() > 1000 && usual.trace.columns[3].iter().all(|turned| *turned == 0));
        assert_eq!((usual.digest, usual.digest), (weak.digest, none.digest), "slope {slope}");
    }
}

/// CF-26, each axis that moves before the corner has not come to its end when each one behind it leaves.
#[test]
fn with_dist_soft_all_axes_bend_cf_26() {
    let text = "#CONTOUR MODE ON [DIST_SOFT PATH_DIST=8]\nN10 G01 X40 Z10 A30 F6000\nN20 G260 Y40 B30\nM30\n";
    let machine = machines::mill::<5>(1000);
    let run = run_from(text, [Position::ZERO; 5], &machine);
    let rows: Vec<Vec<f64>> = (0..run.trace.len()).map(|row| run.trace.mm(row)).collect();
    let [before, behind] = [&[(0, 40.0), (2, 10.0), (3, 30.0)][..], &[(1, 40.0), (4, 30.0)][..]];
    for (leaves, _) in behind {
        let first = rows.iter().find(|q| q[*leaves] > 1e-6).expect("it moves");
        for (axis, end) in before {
            assert!(first[*axis] < end - 0.05, "axis {axis} is at {} when {leaves} leaves", first[*axis]);
        }
    }
    let last = rows.last().expect("it moves");
    assert!(before.iter().chain(behind).all(|(axis, end)| (last[*axis] - end).abs() < 1e-9), "{last:?}");
}

/// D3-022: whatever the method asks for, it takes half of each block at most, where distances are equal half of
/// the shorter one.
#[test]
fn no_method_takes_more_than_half_of_a_block_d3_022() {
    let mut machine = machines::even::<3>(1000);
    machine.channel.ptp = true;
    for (mode, most) in [
        ("DEV PATH_DEV=50", [4.0, 4.0]),
        ("DIST PRE_DIST=30 POST_DIST=30", [4.0, 4.0]),
        ("DIST PRE_DIST=30 POST_DIST=29", [20.0, 4.0]),
        ("POS PRE_DIST=30 POST_DIST=29 X38 Y2", [20.0, 4.0]),
        ("DIST_SOFT PATH_DIST=30", [4.0, 4.0]),
        ("PTP PATH_DIST=30", [4.0, 4.0]),
        ("PTP PATH_DEV=50", [4.0, 4.0]),
    ] {
        let text = format!("#CONTOUR MODE ON [{mode}]\nN10 G01 X40 F6000\nN20 G260 Y8\nM30\n");
        let run = run_from(&text, [Position::ZERO; 3], &machine);
        let rows: Vec<Vec<f64>> = (0..run.trace.len()).map(|row| run.trace.mm(row)).collect();
        let leaves = rows.iter().position(|q| q[1] != 0.0).expect("a curve");
        let enters = rows.iter().rposition(|q| q[0] != 40.0).expect("a curve");
        // The tick before it leaves, and the one behind that in which it enters.
        let [before, behind] = [40.0 - rows[leaves][0], rows[enters][1]];
        assert!(before <= most[0] && before > 0.5 * most[0], "{mode}: {before} mm before the corner");
        assert!(behind <= most[1] && behind > 0.5 * most[1], "{mode}: {behind} mm behind the corner");
    }
}

/// D3-073: a command with one keyword leaves all others as they are. What each of them does shows without it.
#[test]
fn keywords_may_be_set_one_by_one_d3_073() {
    let corners = "N10 G01 X40 A9 F20000\nN20 X40.05 Y0.25\nN30 X60 Y10 A15\nM7\nN40 Y14\nN50 X20\nN60 X60 Y20 A0\nN70 X80\nN80 Y40";
    let lists: [(&str, &[&str]); 4] = [
        (
            "DEV",
            &[
                "PATH_DEV=0.3",
                "TRACK_DEV=0.05",
                "RELEVANT_PATH=0.29",
                "REMAIN_PART=80",
                "CHECK_JERK=0",
                "CONST_VEL=1",
                "MAX_ANGLE=120",
                "PRE_ACTION",
            ],
        ),
        ("DIST", &["PRE_DIST=1.5", "POST_DIST=1.7", "TRACK_DEV=0.05", "RELEVANT_PATH=0.5", "POST_ACTION"]),
        ("POS", &["PRE_DIST=1.5", "POST_DIST=1.7", "X41", "Y1", "POST_ACTION"]),
        ("DIST_SOFT", &["PATH_DIST=1.8", "TRACK_DIST=1.2", "ACC_MAX=60", "RAMP_TIME=150", "DIST_WEIGHT=60"]),
    ];
    let mut machine = machines::even::<4>(1000);
    for axis in &mut machine.axes {
        axis.tr_geom = 10_000;
    }
    for (method, keywords) in lists {
        let run = |commands: &[String]| {
            let commands: String =
                commands.iter().map(|words| format!("#CONTOUR MODE [{method} {words}]\n")).collect();
            let text = format!("{commands}G261\n{corners}\nG260\nM30\n");
            let run = run_from(&text, [Position::ZERO; 4], &machine);
            (run.digest, run.events.iter().map(|(row, _)| *row).collect::<Vec<_>>())
        };
        let all = run(&[keywords.join(" ")]);
        for k in 0..keywords.len() {
            let mut turned: Vec<String> = keywords.iter().map(|&word| word.to_owned()).collect();
            turned.rotate_left(k);
            assert!(run(&turned) == all, "{method}: from {} on, one by one", keywords[k]);
            assert!(run(&[turned[1..].join(" ")]) != all, "{method}: without {}", keywords[k]);
        }
    }
}

/// With Surface and TRAPEZ no block is faster than its own feed: a block of another feed begins another element.
#[test]
fn smoothed_blocks_keep_their_own_feed() {
    let mut machine = machines::even::<3>(1000);
    machine.channel.surface = true;
    for length in [0.2, 0.5, 1.0, 2.0] {
        let mut text = String::from("#HSC ON [SURFACE PATH_DEV=0.1]\nG01 F6000\n");
        // Forty blocks fast, forty slow, forty fast, along a gentle bow.
        for k in 1..=120 {
            let feed = match k {
                1 | 81 => " F6000",
                41 => " F600",
                _ => "",
            };
            let x = f64::from(k) * length;
            let y = 0.1 * length * (f64::from(k) * 0.7).sin();
            text += &format!("N{k} X{x:.4} Y{y:.4}{feed}\n");
        }
        text += "#HSC OFF\nM30\n";
        let run = run_from(&text, [Position::ZERO; 3], &machine);
        let rows: Vec<_> = (0..run.trace.len()).map(|row| run.trace.mm(row)).collect();
        let slow =
            rows.windows(2).filter(|w| w[0][0] > 40.0 * length + 0.12 && w[1][0] < 80.0 * length - 0.12);
        let fastest = slow.map(|w| (w[1][0] - w[0][0]).hypot(w[1][1] - w[0][1]) / 1e-3).fold(0.0, f64::max);
        assert!(fastest > 1.0 && fastest < 10.1, "{length} mm: {fastest} mm/s");
    }
}

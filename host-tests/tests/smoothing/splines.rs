//! Splines: the curves compared with an independent f64 reference, programs from text to set points,
//! refusals, and checks of random runs.
use glidepath::channel::Error;
use glidepath::nc::{Hsc, HscMethod, NcWarningKind, Spline, SplineType, Tangent};
use glidepath::quantity::Position;
use glidepath::smooth::{Before, Smoothing};
use host_tests::cases::machines;
use host_tests::cases::random::Random;
use host_tests::cases::{Kind, Move, NM, Program, set_point};
use host_tests::check;
use host_tests::corner::{Piece, blocks, smooth};
use host_tests::properties::permitted;
use host_tests::refusal::{refusal, refused};
use host_tests::rounded::{quick, run, run_from};
use host_tests::soak::Outcome;

type Vector = [f64; 3];

/// A row of points with turns of 0 to 180° and lengths between these, mm.
fn points(seed: u64, count: usize, lengths: [f64; 2], turns: f64) -> Program {
    let mut r = Random::new(seed);
    let (mut at, mut heading) = ([0.0_f64; 3], r.between(0.0, 6.0));
    let nm = |at: &[f64; 3]| at.iter().map(|x| (x * NM as f64).round() as i64).collect::<Vec<i64>>();
    let moves = (0..count).map(|_| {
        heading += r.between(-turns, turns);
        let (length, climb) = (r.magnitude(lengths[0], lengths[1]), r.between(-0.5, 0.5));
        at = [at[0] + length * heading.cos(), at[1] + length * heading.sin(), at[2] + length * climb];
        Move { kind: Kind::Line, target: nm(&at), feed: 6000.0, stop: false }
    });
    Program { optimised: false, name: format!("points {seed}"), start: vec![0; 3], moves: moves.collect() }
}

fn mm(program: &Program) -> Vec<Vector> {
    let bits = |p: &[i64]| std::array::from_fn(|k| set_point(p[k]) as f64 / (1u64 << 32) as f64);
    std::iter::once(bits(&program.start)).chain(program.moves.iter().map(|m| bits(&m.target))).collect()
}

fn plus(a: &Vector, f: f64, b: &Vector) -> Vector {
    std::array::from_fn(|k| a[k] + f * b[k])
}

fn size(a: &Vector) -> f64 {
    a.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// Akima's slopes over the chord length, with automatic ends.
fn akima(p: &[Vector]) -> Vec<[Vector; 4]> {
    let chord: Vec<(Vector, f64)> = p
        .windows(2)
        .map(|w| {
            let d = plus(&w[1], -1.0, &w[0]);
            (d.map(|x| x / size(&d)), size(&d))
        })
        .collect();
    let n = chord.len();
    let m = |i: i64| -> Vector {
        let at = |i: usize| chord[i].0;
        match i {
            -1 => plus(&plus(&at(0), 1.0, &at(0)), -1.0, &at(1)),
            -2 => plus(&at(0).map(|x| 3.0 * x), -2.0, &at(1)),
            i if i == n as i64 => plus(&plus(&at(n - 1), 1.0, &at(n - 1)), -1.0, &at(n - 2)),
            i if i == n as i64 + 1 => plus(&at(n - 1).map(|x| 3.0 * x), -2.0, &at(n - 2)),
            i => at(i as usize),
        }
    };
    let slope = |i: usize| -> Vector {
        let i = i as i64;
        let [m0, m1, m2, m3] = [m(i - 2), m(i - 1), m(i), m(i + 1)];
        let (w1, w2) = (size(&plus(&m3, -1.0, &m2)), size(&plus(&m1, -1.0, &m0)));
        if w1 + w2 < 1e-9 {
            return plus(&m1.map(|x| 0.5 * x), 0.5, &m2);
        }
        plus(&m1.map(|x| x * w1 / (w1 + w2)), w2 / (w1 + w2), &m2)
    };
    (0..n)
        .map(|i| {
            let h = chord[i].1 / 3.0;
            [p[i], plus(&p[i], h, &slope(i)), plus(&p[i + 1], -h, &slope(i + 1)), p[i + 1]]
        })
        .collect()
}

/// De Boor's algorithm: the clamped cubic B-spline with uniform knots.
fn de_boor(p: &[Vector], t: f64) -> Vector {
    let spans = p.len() - 3;
    let knot = |i: i64| (i - 3).clamp(0, spans as i64) as f64;
    let k = 3 + (t.floor() as i64).clamp(0, spans as i64 - 1);
    let mut d: Vec<Vector> = (0..4).map(|j| p[(k - 3 + j) as usize]).collect();
    for r in 1..4 {
        for j in (r..4).rev() {
            let i = k - 3 + j as i64;
            let (low, high) = (knot(i), knot(i + 4 - r as i64));
            let alpha = (t - low) / (high - low);
            d[j] = plus(&d[j - 1].map(|x| x * (1.0 - alpha)), alpha, &d[j]);
        }
    }
    d[3]
}

fn bezier(b: &[Vector; 4], u: f64) -> Vector {
    let v = 1.0 - u;
    std::array::from_fn(|k| {
        v * v * v * b[0][k] + 3.0 * u * v * v * b[1][k] + 3.0 * u * u * v * b[2][k] + u * u * u * b[3][k]
    })
}

/// Largest distance of points of the elements from a curve given by many points in order.
fn apart(pieces: &[Piece<3>], curve: &[Vector]) -> f64 {
    let distance = |q: &[f64], a: &Vector, b: &Vector| {
        let (d, e) = (plus(b, -1.0, a), [q[0] - a[0], q[1] - a[1], q[2] - a[2]]);
        let square = d.iter().map(|x| x * x).sum::<f64>();
        let s = (d.iter().zip(&e).map(|(a, b)| a * b).sum::<f64>() / square.max(1e-30)).clamp(0.0, 1.0);
        size(&plus(&e, -s, &d))
    };
    let mut most = 0.0_f64;
    for piece in pieces {
        for u in [0.0, 0.13, 0.37, 0.5, 0.71, 0.9, 1.0] {
            let q = piece.at(u);
            let off = curve.windows(2).map(|w| distance(&q, &w[0], &w[1])).fold(f64::INFINITY, f64::min);
            most = most.max(off);
        }
    }
    most
}

fn direct(kind: SplineType) -> impl FnOnce(&mut Smoothing<3>) {
    move |stage| {
        let before = Before { taken: 0, exit: None };
        for command in [Spline::Type(kind), Spline::On] {
            stage.spline(&command, &before).expect("it is accepted");
        }
    }
}

/// Path speed: elements are as long as their curve, to 0.1 %.
fn evenness(pieces: &[Piece<3>]) -> f64 {
    let mut most = 0.0_f64;
    for piece in pieces.iter().filter(|piece| piece.length() > 0.01) {
        let chords: f64 = (0..200)
            .map(|i| {
                let [a, b] = [piece.at(f64::from(i) / 200.0), piece.at(f64::from(i + 1) / 200.0)];
                a.iter().zip(&b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
            })
            .sum();
        most = most.max((chords / piece.length() - 1.0).abs());
    }
    most
}

#[test]
fn d3_235_akima_passes_its_points_and_is_the_curve_of_the_reference() {
    // Steps of curvature are free: the curve is Akima's.
    let mut machine = machines::even::<3>(1000);
    machine.channel.corr_v_trans_jerk = false;
    for seed in 0..60 {
        let program = points(seed, 24, [0.05, 30.0], 1.2);
        let blocks = blocks::<3>(&program, &machine);
        let pieces = smooth(&blocks, &machine, direct(SplineType::Akima));
        for block in &blocks {
            let hit = pieces.iter().any(|piece| {
                let mut at = [Position::ZERO; 3];
                let shape = &piece.out.element.shape;
                shape.at(shape.length.to_bits(), &piece.base, &mut at);
                at == block.to
            });
            assert!(hit, "seed {seed}: no element ends in {:?}", block.to);
        }
        let curve: Vec<Vector> = akima(&mm(&program))
            .iter()
            .flat_map(|b| (0..400).map(|i| bezier(b, f64::from(i) / 400.0)).collect::<Vec<_>>())
            .chain([mm(&program)[24]])
            .collect();
        let off = apart(&pieces, &curve);
        // The reference is a polygon of 400 chords per block.
        assert!(off < 2.5e-4, "seed {seed}: {off} mm off");
        let uneven = evenness(&pieces);
        assert!(uneven < 1e-3, "seed {seed}: {uneven}");
    }
}

#[test]
fn d3_235_direct_b_spline_is_the_one_of_de_boor() {
    let machine = machines::even::<3>(1000);
    for seed in 0..60 {
        let count = 3 + seed as usize % 20;
        let program = points(seed, count, [0.5, 30.0], 1.4);
        let pieces = smooth(&blocks::<3>(&program, &machine), &machine, direct(SplineType::Bspline));
        let p = mm(&program);
        let spans = (p.len() - 3) as f64;
        let steps = 400 * (p.len() - 3);
        let curve: Vec<Vector> = (0..=steps).map(|i| de_boor(&p, spans * i as f64 / steps as f64)).collect();
        let off = apart(&pieces, &curve);
        assert!(off < 2.5e-4, "seed {seed}: {off} mm off");
        let (first, last) = (pieces[0].at(0.0), pieces[pieces.len() - 1].at(1.0));
        assert!((0..3).all(|k| first[k] == p[0][k] && last[k] == p[p.len() - 1][k]), "seed {seed}");
    }
}

/// D3-184, D3-187, D3-193: the curve stays inside PATH_DEV, however the points lie; blocks are split for it.
#[test]
fn d3_184_the_hsc_b_spline_keeps_path_dev_and_passes_first_and_last() {
    let machine = machines::even::<3>(1000);
    let mut used = 0.0_f64;
    for seed in 0..300 {
        let program = points(seed, 16, [[1e-3, 100.0], [1.0, 20.0]][seed as usize % 2], 3.125);
        let deviation = Random::new(seed).magnitude(1e-3, 1.0);
        let hsc = Hsc {
            switch: Some(true),
            method: Some(HscMethod::Bspline),
            path_dev: Some(Position::from_bits((deviation * (1u64 << 32) as f64) as i64)),
            max_angle: Some(Position::from_num(180)),
            ..Hsc::default()
        };
        let blocks = blocks::<3>(&program, &machine);
        let pieces = smooth(&blocks, &machine, |stage| assert_eq!(stage.hsc(&hsc), Ok(true)));
        let p = mm(&program);
        let off = apart(&pieces, &p);
        assert!(off <= deviation, "seed {seed}: {off} of {deviation}");
        used = used.max(off / deviation);
        let (first, last) = (pieces[0].at(0.0), pieces[pieces.len() - 1].at(1.0));
        assert!((0..3).all(|k| first[k] == p[0][k] && last[k] == p[p.len() - 1][k]), "seed {seed}");
        // Every point is near the curve too.
        let curve: Vec<Vector> = pieces
            .iter()
            .flat_map(|piece| (0..=64).map(|i| piece.at(f64::from(i) / 64.0)).collect::<Vec<_>>())
            .map(|q| [q[0], q[1], q[2]])
            .collect();
        for point in &p {
            let near = curve.iter().map(|q| size(&plus(q, -1.0, point))).fold(f64::INFINITY, f64::min);
            let step = pieces.iter().map(Piece::length).fold(0.0, f64::max) / 64.0;
            assert!(near <= deviation + step, "seed {seed}: {point:?} is {near} off");
        }
    }
    assert!(used > 0.99, "{used}");
}

/// The least distance of a point from a piece: the nearest of some places, and a ternary search beside that.
fn nearest(piece: &Piece<3>, point: &Vector) -> f64 {
    let off = |s: f64| {
        let q = piece.at(s);
        size(&plus(&[q[0], q[1], q[2]], -1.0, point))
    };
    let places = (0..=16).map(|i| f64::from(i) / 16.0);
    let best = places.min_by(|a, b| off(*a).total_cmp(&off(*b))).expect("places");
    let (mut low, mut high) = (f64::max(best - 1.0 / 16.0, 0.0), f64::min(best + 1.0 / 16.0, 1.0));
    for _ in 0..60 {
        let (one, two) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
        if off(one) < off(two) { high = two } else { low = one }
    }
    off(0.5 * (low + high))
}

/// D3-184: every point is near the curve too, by the same tolerance, however long the blocks beside it are.
#[test]
fn d3_184_points_between_long_blocks_are_near_the_curve() {
    let machine = machines::even::<3>(1000);
    let mut used = 0.0_f64;
    for seed in 0..100 {
        let length = Random::new(seed).magnitude(30.0, 3000.0);
        let program = points(seed, 12, [0.3 * length, length], 3.0);
        let deviation = Random::new(seed).magnitude(2e-3, 1e-2);
        let hsc = Hsc {
            switch: Some(true),
            method: Some(HscMethod::Bspline),
            path_dev: Some(Position::from_bits((deviation * (1u64 << 32) as f64) as i64)),
            max_angle: Some(Position::from_num(180)),
            ..Hsc::default()
        };
        let pieces = smooth(&blocks::<3>(&program, &machine), &machine, |stage| {
            assert_eq!(stage.hsc(&hsc), Ok(true));
        });
        for point in &mm(&program) {
            let off = pieces.iter().map(|piece| nearest(piece, point)).fold(f64::INFINITY, f64::min);
            assert!(off <= deviation, "seed {seed}: {point:?} is {off} off, permitted {deviation}");
            used = used.max(off / deviation);
        }
    }
    assert!(used > 0.97, "{used}");
}

/// With steps of curvature limited, it agrees on both sides of every point, and the points stay.
#[test]
fn akima_has_no_step_of_curvature_where_jerk_is_limited() {
    let machine = machines::even::<3>(1000);
    for seed in 0..60 {
        let program = points(seed, 24, [0.5, 20.0], 1.0);
        let blocks = blocks::<3>(&program, &machine);
        let pieces = smooth(&blocks, &machine, direct(SplineType::Akima));
        for pair in pieces.windows(2) {
            let (exit, entry) = (pair[0].out.element.exit, pair[1].out.element.entry);
            assert_eq!(exit.tangent, entry.tangent, "seed {seed}");
            for k in 0..3 {
                let step = (exit.curvature[k] - entry.curvature[k]).abs();
                assert!(step <= 1e-6, "seed {seed}: a step of curvature of {step} / mm");
            }
        }
        let exact: Vec<Vector> = akima(&mm(&program))
            .iter()
            .flat_map(|b| (0..400).map(|i| bezier(b, f64::from(i) / 400.0)).collect::<Vec<_>>())
            .chain([mm(&program)[24]])
            .collect();
        let off = apart(&pieces, &exact);
        assert!(off < 1.3e-3, "seed {seed}: {off}");
    }
}

#[test]
fn d3_196_d3_197_one_command_or_two_is_the_same_curve() {
    let body = "N40 X3 Y25\nN50 X15 Y15\nN60 X23 Y12\nN70 X25 Y25\nN80 X30 Y35\nN90 X50 Y37.5\nN100 X55 Y32.5\nN110 X58 Y12\nN120 X70 Y12\nN130 X77.5 Y10\nN140 X90 Y35\nN150 X100 Y37.5\nN160 #HSC OFF\nN170 M30\n";
    let one = run(&format!("N20 G00 X0 Y0 Z0 F10000\nN30 #HSC ON [BSPLINE PATH_DEV=0.2 MERGE=1]\n{body}"));
    let two = run(&format!(
        "N20 G00 X0 Y0 Z0 F10000\nN25 #HSC [BSPLINE PATH_DEV=0.2 MERGE=1]\nN30 #HSC ON\n{body}"
    ));
    // D3-194: and in steps.
    let three = run(&format!(
        "N20 G00 X0 Y0 Z0 F10000\nN24 #HSC [BSPLINE PATH_DEV=0.2]\nN25 #HSC [BSPLINE MERGE=1]\nN30 #HSC ON [BSPLINE]\n{body}"
    ));
    assert_eq!((one.digest, one.digest), (two.digest, three.digest));
    for corner in [[3.0, 25.0], [25.0, 25.0], [55.0, 32.5]] {
        let off = one.distance(corner);
        // As near as a tick of 0.166 mm comes. Not every corner uses all of the tolerance.
        assert!((0.1..0.2_f64.hypot(0.5 * 0.1667)).contains(&off), "{corner:?}: {off}");
    }
    assert_eq!((one.distance([0.0, 0.0]), one.distance([100.0, 37.5])), (0.0, 0.0));
}

/// Text with a zigzag of sharp corners under these keywords; the least distance from its second point.
fn zigzag(keywords: &str, words: &str) -> f64 {
    let text = format!(
        "N10 G01 X0 Y0 F3000\nN20 #HSC ON [BSPLINE PATH_DEV=0.1 {keywords}]\nN30 X10\nN40 {words} Y10\nN50 X20\nN60 Y20\nN70 #HSC OFF\nM30\n"
    );
    run(&text).distance([10.0, 10.0])
}

/// D3-187, D3-189 to D3-192, CF-39.
#[test]
fn d3_187_to_d3_192_deselection() {
    let split = zigzag("", "");
    assert!((0.099..0.1005).contains(&split), "{split}");
    // D3-187: exceeding the tolerance deselects.
    assert!(zigzag("AUTO_OFF_PATH=1", "") < 1e-3);
    // D3-190: an exact stop stands on the curve, or in its point.
    assert!((0.08..0.1005).contains(&zigzag("", "G60")));
    assert_eq!(zigzag("AUTO_OFF_G60=1", "G60"), 0.0);
    assert!((0.08..0.1005).contains(&zigzag("", "G360")));
    assert_eq!(zigzag("AUTO_OFF_G60=1", "G360"), 0.0);
    // D3-191: long blocks; its maximum (CF-03).
    assert!(zigzag("MAX_PATH_LENGTH=9", "") < 1e-3);
    assert!((0.099..0.1005).contains(&zigzag("MAX_PATH_LENGTH=11", "")));
    assert!((0.099..0.1005).contains(&zigzag("MAX_PATH_LENGTH=0", "")));
    // D3-189: rapid blocks.
    assert!((0.099..0.1005).contains(&zigzag("", "G00")));
    assert!(zigzag("AUTO_OFF_G00=1", "G00") < 1e-3);
    // D3-192: sharp angles.
    assert!(zigzag("MAX_ANGLE=89", "") < 1e-3);
    assert!((0.099..0.1005).contains(&zigzag("MAX_ANGLE=91", "")));
    // D3-184: 0 is not monitored; then the points control the curve.
    let free = run(
        "N10 G01 X0 Y0 F3000\nN20 #HSC ON [BSPLINE PATH_DEV=0]\nN30 X10\nN40 Y10\nN50 X20\nN60 Y20\nN70 #HSC OFF\nM30\n",
    );
    let off = free.distance([10.0, 10.0]);
    assert!((off - 10.0 * 2.0_f64.sqrt() / 6.0).abs() < 1e-3, "{off}");
}

/// D3-185, D3-188: a tracking axis keeps its own tolerance.
#[test]
fn d3_185_tracking_axes_keep_their_tolerance() {
    let mut machine = machines::even::<4>(1000);
    for axis in &mut machine.axes {
        (axis.vb_max, axis.vb_eilgang) = (1_000_000, 1_000_000);
    }
    let start = [Position::ZERO; 4];
    let off = |keywords: &str| {
        let text = format!(
            "N10 G01 X0 F3000\nN20 #HSC ON [BSPLINE PATH_DEV=0 {keywords}]\nN30 X10 A30\nN40 X20 A0\nN50 X30 A30\nN60 #HSC OFF\nM30\n"
        );
        let run = run_from::<4>(&text, start, &machine);
        let at = |x: f64| {
            [0.0, 30.0, 0.0, 30.0][(x / 10.0) as usize % 4] * (1.0 - (x / 10.0).fract())
                + [30.0, 0.0, 30.0, 0.0][(x / 10.0) as usize % 4] * (x / 10.0).fract()
        };
        (0..run.trace.len())
            .map(|i| run.trace.mm(i))
            .map(|q| (q[3] - at(q[0].min(29.999_999))).abs())
            .fold(0.0, f64::max)
    };
    let [monitored, other, deselected] =
        ["TRACK_DEV=2", "TRACK_DEV=0.5", "TRACK_DEV=0.5 AUTO_OFF_TRACK=1"].map(off);
    assert!((1.9..2.01).contains(&monitored), "{monitored}");
    assert!((0.45..0.505).contains(&other), "{other}");
    assert!(deselected < 0.01, "{deselected}");
    assert!(off("TRACK_DEV=0") > 5.0);
}

/// D3-273, D3-274: with P-CHAN-00239 = 1 it rounds where it deselects itself, inside PATH_DEV.
#[test]
fn d3_274_points_of_deselection_are_rounded() {
    let mut machine = machines::even::<3>(1000);
    let text = "N10 G01 X0 Y0 F3000\nN20 #HSC ON [BSPLINE PATH_DEV=0.1 MAX_PATH_LENGTH=9]\nN30 X10\nN40 Y10\nN50 X20\nN60 Y20\nN70 #HSC OFF\nM30\n";
    for (mode, range) in [(0, 0.0..1e-3), (1, 0.099..0.1005), (2, 0.0..1e-3)] {
        machine.channel.auto_contour_mode = mode;
        let off = run_from::<3>(text, [Position::ZERO; 3], &machine).distance([10.0, 10.0]);
        assert!(range.contains(&off), "{mode}: {off}");
    }
}

/// D3-186: points on a straight line are left out.
#[test]
fn d3_186_merge_leaves_points_of_straight_lines_out() {
    let machine = machines::even::<3>(1000);
    let target = |i: i64| if i <= 40 { vec![i * NM / 2, 0, 0] } else { vec![20 * NM, (i - 40) * 10 * NM, 0] };
    let program = |points: Vec<i64>| {
        let line = |i| Move { kind: Kind::Line, target: target(i), feed: 6000.0, stop: false };
        let moves = points.into_iter().map(line).collect();
        Program { optimised: false, name: "row".to_owned(), start: vec![0; 3], moves }
    };
    let count = |points: Vec<i64>, merge: bool| {
        let program = program(points);
        let hsc = Hsc {
            switch: Some(true),
            method: Some(HscMethod::Bspline),
            merge: Some(merge),
            ..Hsc::default()
        };
        let pieces =
            smooth(&blocks::<3>(&program, &machine), &machine, |stage| assert_eq!(stage.hsc(&hsc), Ok(true)));
        let last = pieces[pieces.len() - 1].at(1.0);
        assert_eq!(last, [20.0, 20.0, 0.0]);
        pieces.len()
    };
    let [all, merged] = [false, true].map(|merge| count((1..=42).collect(), merge));
    // The line behind the corner belongs to the corner.
    assert_eq!(merged, count(vec![40, 41, 42], false));
    assert!(merged < all, "{all} and {merged}");
}

/// D3-195: while it is on, its parameters stay; 120542 says so.
#[test]
fn d3_195_parameters_stay_while_it_is_on() {
    let text = "N10 G01 X0 Y0 F3000\nN20 #HSC ON [BSPLINE PATH_DEV=0.1]\nN30 X10\nN35 #HSC [BSPLINE PATH_DEV=0.01]\nN40 Y10\nN50 X20\nN60 Y20\nN70 #HSC OFF\nM30\n";
    let run = run(text);
    assert_eq!(run.warnings, [(4, NcWarningKind::HscIsOn)]);
    let off = run.distance([10.0, 10.0]);
    assert!((0.099..0.1005).contains(&off), "{off}");
}

/// OPMODE 1 is DEV with CONTERROR; OPMODE 2 passes smooth points and rounds prismatic parts.
#[test]
fn d3_235_opmode() {
    let square = |on: &str, off: &str| {
        format!("N10 G01 X0 Y0 F3000\n{on}\nN30 X10\nN40 Y10\nN50 X20\nN60 Y20\n{off}\nM30\n")
    };
    let one = run(&square("#HSC ON [OPMODE=1 CONTERROR=0.05]", "#HSC OFF"));
    let dev = run(&square("#CONTOUR MODE ON [DEV PATH_DEV=0.05]", "#CONTOUR MODE OFF"));
    assert_eq!(one.digest, dev.digest);
    let default = run(&square("#HSC ON [OPMODE=1]", "#HSC OFF"));
    assert!((0.099..0.1005).contains(&default.distance([10.0, 10.0])));
    let two = run(&square("#HSC ON [OPMODE=2 CONTERROR=0.05]", "#HSC OFF"));
    assert!((0.049..0.0505).contains(&two.distance([10.0, 10.0])));
    let mut circle = "N1 G01 X0 Y0 F6000\n#HSC ON [OPMODE=2]\n".to_owned();
    for i in 1..=30 {
        let angle = f64::from(i) * 6.0_f64.to_radians();
        circle += &format!("N{i}0 X{:.6} Y{:.6}\n", 50.0 * angle.sin(), 50.0 - 50.0 * angle.cos());
    }
    let run = run(&(circle + "#HSC OFF\nM30\n"));
    let round = (0..run.trace.len()).map(|i| run.trace.mm(i));
    // But for the ends, where the directions are automatic: on the circle and not on its chords.
    let off = round
        .filter(|q| q[1] > 5.0 && q[1] < 95.0)
        .map(|q| (q[0].hypot(q[1] - 50.0) - 50.0).abs())
        .fold(0.0, f64::max);
    assert!(off < 3e-3, "{off}");
}

/// D3-235: a part is prismatic where the path turns by more than 20 degrees, or where one block is more than 4 times as
/// long as the other. Its corners are rounded inside the tolerance; elsewhere the curve goes through the points.
#[test]
fn prismatic_parts_begin_at_20_degrees_and_4_lengths_d3_235() {
    // The distance from the third point, where the path turns; all turn the same way.
    let off = |turn: f64, lengths: [f64; 2]| {
        let mut text = "N10 G01 X0 Y0 F120\n#HSC ON [OPMODE=2 CONTERROR=0.05]\n".to_owned();
        let (mut at, mut heading, mut corner) = ([0.0_f64; 2], 0.0_f64, [0.0; 2]);
        let legs = [lengths[0], lengths[0], lengths[0], lengths[1], lengths[1], lengths[1]];
        for (k, length) in legs.into_iter().enumerate() {
            heading += if k == 3 { turn } else { 2.0 };
            at = [at[0] + length * heading.to_radians().cos(), at[1] + length * heading.to_radians().sin()];
            text += &format!("X{:.6} Y{:.6}\n", at[0], at[1]);
            if k == 2 {
                corner = at;
            }
        }
        run(&(text + "#HSC OFF\nM30\n")).distance(corner)
    };
    for lengths in [[10.0, 10.0], [4.0, 12.0]] {
        for (turn, is_prismatic) in [(19.0, false), (19.9, false), (20.1, true), (25.0, true)] {
            assert_eq!(
                off(turn, lengths) > 0.005,
                is_prismatic,
                "{turn} degrees, {lengths:?}: {}",
                off(turn, lengths)
            );
        }
    }
    for (ratio, is_prismatic) in [(3.9, false), (4.1, true)] {
        for lengths in [[5.0, 5.0 * ratio], [5.0 * ratio, 5.0]] {
            assert_eq!(off(15.0, lengths) > 0.003, is_prismatic, "ratio {ratio}: {}", off(15.0, lengths));
        }
    }
}

/// D3-186: what the points that MERGE leaves out are beside the line adds up: along a row of points on a large circle, each
/// hardly beside the line, the motion stays inside PATH_DEV.
#[test]
fn what_merge_leaves_out_adds_up_d3_186() {
    for (radius, step, dev) in [(1000.0, 0.1, 1.28), (200.0, 0.05, 0.2), (5000.0, 0.5, 0.6)] {
        let mut text =
            format!("N10 G01 X0 Y0 F3000\n#HSC ON [BSPLINE PATH_DEV={dev} MERGE=1 AUTO_OFF_PATH=1]\n");
        for k in 1..=1500 {
            let angle = f64::from(k) * step / radius;
            text += &format!("X{:.6} Y{:.6}\n", radius * angle.sin(), radius * (1.0 - angle.cos()));
        }
        let run = run(&(text + "#HSC OFF\nM30\n"));
        let rows = (0..run.trace.len()).map(|row| run.trace.mm(row));
        let off = rows.map(|q| (q[0].hypot(q[1] - radius) - radius).abs()).fold(0.0, f64::max);
        assert!(off <= dev * (1.0 + 1.0 / 128.0), "radius {radius}: {off} of {dev}");
    }
}

/// The curve leaves the block before it and enters the one behind it tangentially: the speed goes on.
#[test]
fn g_03_tangential_ends_and_arcs_between() {
    let text = |trans: &str, middle: &str| {
        format!(
            "N10 G01 X0 Y0 F3000\nN15 X20\n#AKIMA TRANS [{trans}]\nG151\nN20 X30 Y2\nN30 X38 Y8\n{middle}N40 X40 Y20\nG150\nN50 X40 Y50\nM30\n"
        )
    };
    let slowest = |text: &str| {
        let run = run_from::<3>(text, [Position::ZERO; 3], &quick(1000));
        let speeds = run.speeds();
        let inside = &speeds[speeds.len() / 5..speeds.len() * 4 / 5];
        inside.iter().copied().fold(f64::INFINITY, f64::min)
    };
    let tangential = slowest(&text("START=TANGENTIAL END=TANGENTIAL", ""));
    let automatic = slowest(&text("START=AUTO END=AUTO", ""));
    assert!(tangential > 10.0 && automatic < 5.0, "{tangential} and {automatic} mm/s");
    // An arc between two curves: it stays, and both meet it tangentially.
    let arc = text("START=TANGENTIAL END=TANGENTIAL", "N35 G03 X40 Y12 R5\nN36 G01 X40 Y14\n");
    assert!(slowest(&arc) > 5.0);
}

#[test]
fn g_03_user_vectors_and_old_forms() {
    let body = "N20 X10 Y3\nN30 X20 Y0\nN40 X30 Y3\n";
    let run_of = |head: &str| run(&format!("N10 G01 X0 Y0 F3000\n{head}\n{body}G150\nM30\n"));
    let new = run_of(
        "#SPLINE TYPE AKIMA\n#AKIMA TRANS [START=USER END=USER]\n#AKIMA STARTVECTOR X0 Y1 Z0\n#AKIMA ENDVECTOR X0 Y5 Z0\nG151",
    );
    let old = run_of(
        "#SET SPLINETYPE AKIMA\n#SET ASPLINE MODE[3,3]\n#AKIMA STARTVECTOR X0 Y2 Z0\n#AKIMA ENDVECTOR X0 Y1 Z0\n#SET SPLINE ON",
    );
    assert_eq!(new.digest, old.digest);
    // It leaves upward.
    let first = (0..new.trace.len()).map(|i| new.trace.mm(i)).find(|q| q[1] > 0.01).expect("it moves");
    assert!(first[0] < 0.1 * first[1], "{first:?}");
    let automatic = run_of("G151");
    assert_ne!(automatic.digest, new.digest);
}

#[test]
fn g_03_refusals() {
    let machine = machines::even::<3>(1000);
    let id = |text: &str| refused::<3>(&format!("G01 X0 F1000\n{text}\nM30\n"), &machine).id();
    let too_few = |text: &str| {
        let error = refused::<3>(&format!("G01 X1 F1000\n{text}\nM30\n"), &machine);
        assert!(error.to_string().contains("points; expected at least"), "{error}");
        assert!(matches!(error, Error::Spline(..)));
    };
    too_few("G151\nX10\nG150");
    too_few("#AKIMA TRANS [START=TANGENTIAL END=AUTO]\nG151\nX10\nG150");
    too_few("#SPLINE TYPE BSPLINE\nG151\nX10\nX20 Y1\nG150");
    let accepted = |text: &str| {
        let error = refusal::<3>(&format!("G01 X1 F1000\n{text}\nM30\n"), &machine);
        assert!(error.is_none(), "{text}: {error:?}");
    };
    accepted("G151\nX10\nX20 Y1\nG150");
    accepted("#AKIMA TRANS [START=TANGENTIAL END=TANGENTIAL]\nG151\nX10\nG150 X20 Y1");
    accepted("#SPLINE TYPE BSPLINE\nG151\nX10\nX20 Y1\nX30\nG150");
    assert_eq!(id("#SPLINE TYPE BSPLINE\nG151\nX10\nX20 Y1\nG02 X30 Y11 R10"), 120_254);
    for other in
        ["#CONTOUR MODE ON [DEV PATH_DEV=1]", "G261", "G61 X50", "#HSC ON [BSPLINE]", "#HSC ON [OPMODE=1]"]
    {
        assert_eq!(id(&format!("G151\nX10\nX20 Y1\n{other}")), 120_255, "{other}");
    }
    assert_eq!(id("G261\nG151"), 120_255);
    for word in ["G150", "G151", "#SPLINE ON", "#SET SPLINE OFF"] {
        assert_eq!(id(&format!("#HSC ON [BSPLINE]\nX10\n{word}")), 120_370, "{word}");
    }
}

/// No direction is known directly behind the choice of the type: it begins as it likes, and that is said.
#[test]
fn g_03_no_tangential_entry_directly_behind_the_type() {
    let text = |type_at: [&str; 2]| {
        format!(
            "#AKIMA TRANS [START=TANGENTIAL END=AUTO]\n{}N10 G01 X10 Y0 F1000\n{}G151\nN20 X20 Y5\nN30 X30 Y0\nG150\nM30\n",
            type_at[0], type_at[1]
        )
    };
    let [before, behind] =
        [["#SPLINE TYPE AKIMA\n", ""], ["", "#SPLINE TYPE AKIMA\n"]].map(|at| run(&text(at)));
    assert_eq!(before.warnings, []);
    assert_eq!(behind.warnings, [(4, NcWarningKind::NoTangent)]);
    assert_ne!(before.digest, behind.digest);
}

/// The position in the block of G150 is not part of the curve, that in the block of G151 is.
#[test]
fn g_03_positions_in_the_blocks_that_switch() {
    let apart = run("N10 G01 X0 Y0 F3000\nG151\nN20 X10 Y5\nN30 X20 Y0\nG150\nN40 X30 Y5\nM30\n");
    let together = run("N10 G01 X0 Y0 F3000\nN20 G151 X10 Y5\nN30 X20 Y0\nN40 G150 X30 Y5\nM30\n");
    assert_eq!(apart.digest, together.digest);
    // A line from there on.
    for i in 0..together.trace.len() {
        let q = together.trace.mm(i);
        if q[0] > 20.001 {
            assert!((q[1] - 0.5 * (q[0] - 20.0)).abs() < 1e-6, "{q:?}");
        }
    }
}

/// Standstills, functions, feeds, rotary axes at rest, blocks without motion, the end of the program.
#[test]
fn what_stands_between_points() {
    let stands = |text: &str, point: [f64; 2]| {
        let run = run(text);
        let rows: Vec<Vec<f64>> = (0..run.trace.len()).map(|i| run.trace.mm(i)).collect();
        let rest = rows.windows(2).filter(|w| w[0] == w[1]).count();
        (run.distance(point), rest)
    };
    for kind in ["AKIMA", "BSPLINE"] {
        let text = |line: &str| {
            format!(
                "#SPLINE TYPE {kind}\nN10 G01 X0 Y0 F3000\nG151\nN20 X10 Y5\nN30 X20 Y0\n{line}\nN40 X30 Y5\nN50 X40 Y0\nN60 X50 Y5\nM30\n"
            )
        };
        // A dwell ends the curve in the point.
        let (off, rest) = stands(&text("G04 0.05"), [20.0, 0.0]);
        assert!(off == 0.0 && rest >= 50, "{kind}: {off} mm, {rest} ticks");
        let whole = run(&text(""));
        let last = whole.trace.mm(whole.trace.len() - 1);
        assert!(last[0] == 50.0 && last[1] == 5.0, "{kind}: {last:?}");
        // What changes nothing between two points leaves the curve as it is.
        for line in ["M3", "N35", "X20 Y0", "S100"] {
            assert_eq!(run(&text(line)).digest, whole.digest, "{kind}: {line}");
        }
        assert_eq!(run(&text("M3")).events.len(), 1);
        // Another feed: the same curve.
        assert!(run(&text("F1000")).time() > 1.2 * whole.time());
    }
    let (off, _) = stands(
        "N10 G01 X0 Y0 F3000\nG151\nN20 X10 Y5\nN30 G60 X20 Y0\nN40 X30 Y5\nN50 X40 Y0\nG150\nM30\n",
        [20.0, 0.0],
    );
    assert_eq!(off, 0.0);
    let mut machine = machines::even::<4>(1000);
    (machine.axes[3].vb_max, machine.axes[3].vb_eilgang) = (100_000, 100_000);
    let text =
        "N10 G01 X0 Y0 F3000\nG151\nN20 X10 Y5\nN30 X20 Y0\nN35 A10\nN40 X30 Y5 A12\nN50 X40 Y0\nG150\nM30\n";
    let run = run_from::<4>(text, [Position::ZERO; 4], &machine);
    // The main axes rest while A turns.
    let turned = (0..run.trace.len()).map(|i| run.trace.mm(i)).filter(|q| q[3] > 0.1 && q[3] < 9.9);
    assert!(turned.clone().count() > 10 && turned.clone().all(|q| q[0] == 20.0 && q[1] == 0.0));
}

/// Every slope, and the limits of every axis at every tick.
#[test]
fn random_points_keep_every_limit_with_every_slope() {
    for seed in 0..40_u64 {
        let program = points(seed, 40, [1e-3, 40.0], [0.3, 3.1][seed as usize % 2]);
        let mut machine = machines::mill::<3>(1000);
        machine.channel.slope_profile = (seed % 4) as u8;
        let mode =
            ["G151", "#SPLINE TYPE BSPLINE\nG151", "#HSC ON [BSPLINE PATH_DEV=0.05]", "#HSC ON [OPMODE=2]"];
        let text = program.text(&machine);
        let (head, rest) = text.split_once('\n').expect("a head");
        let text = format!("{head}\n{}\n{rest}", mode[(seed / 4 % 4) as usize]);
        let run = run_from::<3>(&text, [Position::ZERO; 3], &machine);
        let limits: Vec<_> = machine
            .axes
            .iter()
            .map(|axis| permitted(axis, machine.channel.slope_profile, false, true, true))
            .collect();
        check::limits(&run.trace, &limits).unwrap_or_else(|fault| panic!("seed {seed}: {fault}"));
    }
}

/// `cargo run --release -p host-tests --example splines -- 0 10000` goes on with it.
#[test]
fn random_machines_programs_and_operators_keep_every_limit() {
    let mut good = 0;
    // Those last ones lost a block where the B-spline and contour mode take turns.
    let seeds = host_tests::seeds::seeds(0..500, 100).chain([314_518, 321_981, 328_862]);
    for seed in seeds {
        match host_tests::splines::soak(seed, seed % 2 == 1) {
            Outcome::Good(_) => good += 1,
            Outcome::TooLong | Outcome::Refused(_) => {}
            Outcome::Fault(fault) => panic!("seed {seed}: {fault}"),
        }
    }
    assert!(good > 560, "{good}");
}

/// Each end of an Akima spline: the directions that tangents ask for.
#[test]
fn ends_take_the_directions_given() {
    let machine = machines::even::<3>(1000);
    let program = points(3, 6, [5.0, 10.0], 0.5);
    let blocks = blocks::<3>(&program, &machine);
    let exit = blocks[0].element.exit;
    let pieces = smooth(&blocks[1..], &machine, |stage| {
        let before = Before { taken: 1, exit: Some(&exit) };
        let transition = Spline::Transition { start: Some(Tangent::Tangential), end: None };
        for command in [transition, Spline::On] {
            stage.spline(&command, &before).expect("it is accepted");
        }
    });
    assert_eq!(pieces[0].out.element.entry.tangent, exit.tangent);
    assert_eq!(pieces[0].out.element.entry.curvature, [0.0; 3]);
}

/// D3-236, D3-237: 64 secant points of a circle of 80 mm at 20 m/min. The linear pass stands nearly in each corner
/// and takes ten times as long; the spline reaches the feed and meets the lines before and behind tangentially.
#[test]
fn d3_237_the_spline_pass_takes_a_tenth_of_the_linear_pass() {
    let mut machine = machines::examples::<3>(4000);
    (machine.channel.slope_profile, machine.channel.corr_v_trans_jerk) = (3, false);
    let text = |on: &str, off: &str| {
        let mut text =
            format!("#AKIMA TRANS [START=TANGENTIAL END=TANGENTIAL]\nN1 G01 X-80 F20000\nN2 X0\n{on}\n");
        for i in 1..=64 {
            let angle = (f64::from(i) * 5.625).to_radians();
            text += &format!("N{i}0 X{:.6} Y{:.6}\n", 80.0 * angle.sin(), 80.0 - 80.0 * angle.cos());
        }
        text + &format!("{off}\nN2000 X80\nM30\n")
    };
    let circle = |text: &str| {
        let run = run_from::<3>(text, [Position::ZERO; 3], &machine);
        let inside = (0..run.trace.len()).filter(|i| run.trace.mm(*i)[1] > 1e-9).count();
        let fastest = run.speeds().into_iter().fold(0.0, f64::max);
        let off = (0..run.trace.len())
            .map(|i| run.trace.mm(i))
            .filter(|q| q[1] > 1e-9)
            .map(|q| (q[0].hypot(q[1] - 80.0) - 80.0).abs())
            .fold(0.0, f64::max);
        let before = run.speeds()[..run.trace.len() - 1]
            .iter()
            .zip(0..)
            .find(|(_, i)| run.trace.mm(*i)[1] > 1e-9)
            .map_or(0.0, |(v, _)| *v);
        (inside as f64 * 0.004, fastest, off, before)
    };
    let (spline, fastest, off, entry) = circle(&text("G151", "G150"));
    let (linear, ..) = circle(&text("", ""));
    assert!((9.0..12.0).contains(&(linear / spline)), "{linear} s and {spline} s");
    assert!((333.0..333.4).contains(&fastest) && off < 1e-3, "{fastest} mm/s, {off} mm");
    assert!(entry > 333.0, "{entry} mm/s into the circle");
}

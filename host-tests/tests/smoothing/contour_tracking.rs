//! Contour mode and tracking axes: the meaning of short blocks, and the deviation of these axes at any place.
use glidepath::nc::{Contour, ContourMethod};
use glidepath::quantity::Position;
use host_tests::cases::random::Random;
use host_tests::cases::{NM, Program, machines};
use host_tests::corner::{Piece, blocks, position, round};
use host_tests::deviation::follows;
use host_tests::rounded::{Run, quick, run_from};

/// The tracking axis where the second one is at `y`.
fn turned(run: &Run, y: f64) -> f64 {
    let row = (0..run.trace.len()).find(|&i| run.trace.mm(i)[1] >= y).expect("it comes there");
    run.trace.mm(row)[3]
}

/// A block of 10 µm that turns A by 30°, with every method that leaves blocks out.
///
/// Rows: D3-041.
#[test]
fn a_block_that_is_short_in_space_alone_is_kept() {
    for mode in [
        "DEV PATH_DEV=0.1 TRACK_DEV=0.2 RELEVANT_TRACK=0.1",
        "DEV PATH_DEV=0.1 RELEVANT_PATH=0.1 RELEVANT_TRACK=29",
        "DIST PRE_DIST=1 POST_DIST=1 TRACK_DEV=0.2 RELEVANT_TRACK=0.1",
        "DIST_SOFT PATH_DIST=1",
        "PTP PATH_DEV=0.1",
    ] {
        // At the end of a line, at the begin of one, and alone.
        for blocks in [
            "G01 X10 F5000\nX10.01 A30\nX10.01 Y20\nY25\n",
            "G01 X0.01 A30 F5000\nX0.01 Y20\nY25\n",
            "G01 X10 F5000\nA30\nY20\nY25\n",
        ] {
            let text = format!("#CONTOUR MODE ON [{mode}]\n{blocks}M30\n");
            let run = run_from::<4>(&text, [Position::ZERO; 4], &quick(1000));
            for y in [2.0, 10.0, 15.0] {
                let a = turned(&run, y);
                assert!((a - 30.0).abs() <= 0.2, "{mode}: {a}° at Y {y}\n{text}");
            }
        }
    }
}

/// Up to RELEVANT_TRACK, of each tracking axis by itself, a block is short, and not beyond it: behind a
/// corner, and before one.
#[test]
fn the_relevant_track_is_a_limit_of_each_axis() {
    for mode in ["DEV PATH_DEV=2 RELEVANT_PATH=1", "DIST PRE_DIST=2 POST_DIST=2 RELEVANT_PATH=1"] {
        for (a, b, short) in [
            (0.098, 0.0, true),
            (0.102, 0.0, false),
            (-0.15, 0.0, false),
            (0.09, -0.09, true),
            (0.09, 0.102, false),
        ] {
            let text = format!(
                "#CONTOUR MODE ON [{mode} RELEVANT_TRACK=0.1]\nN10 G01 X20 F4000\nN20 X20.5 A{a} B{b}\nN30 Y30\nM30\n"
            );
            let run = run_from::<5>(&text, [Position::ZERO; 5], &quick(1000));
            assert_eq!(run.lengths(20).is_empty(), short, "{text}");
        }
    }
    for (a, short) in [(0.098, true), (0.102, false)] {
        let text = format!(
            "#CONTOUR MODE ON [DEV PATH_DEV=2 RELEVANT_PATH=1 RELEVANT_TRACK=0.1]\nN10 G01 X0.5 A{a} F4000\nN20 X20 Y9\nN30 Y30\nM30\n"
        );
        let run = run_from::<4>(&text, [Position::ZERO; 4], &quick(1000));
        assert_eq!(run.lengths(10).is_empty(), short, "{text}");
    }
    // No more than the tolerance, whatever is relevant.
    let text = "#CONTOUR MODE ON [DEV PATH_DEV=2 TRACK_DEV=0.05 RELEVANT_PATH=1 RELEVANT_TRACK=1]\nN10 G01 X20 F4000\nN20 X20.5 A0.2\nN30 Y30\nM30\n";
    assert!(!run_from::<4>(text, [Position::ZERO; 4], &quick(1000)).lengths(20).is_empty());
}

/// With unequal distances a curve swings out: so does a tracking axis, elsewhere than in the middle.
///
/// Rows: D3-029.
#[test]
fn unequal_distances_keep_the_tracking_tolerance_all_along_the_curve() {
    let text =
        "#CONTOUR MODE ON [DIST PRE_DIST=10 POST_DIST=2 TRACK_DEV=0.1]\nG01 X100 A20 F6000\nY100 A-40\nM30\n";
    let run = run_from::<4>(text, [Position::ZERO; 4], &quick(1000));
    let most = (0..run.trace.len()).map(|i| run.trace.mm(i)[3]).fold(0.0, f64::max);
    assert!((20.0..=20.1).contains(&most), "{most}");
    let machine = machines::even::<4>(1000);
    let mut shorter = 0;
    for seed in 0..200 {
        let mut r = Random::new(seed);
        let angle = r.between(-170.0, 170.0).to_radians();
        let [g1, g2] = [0; 2].map(|_| r.between(-1.0, 1.0));
        let [pre, post] = [0; 2].map(|_| r.magnitude(0.3, 20.0));
        let tolerance = r.magnitude(0.02, 2.0);
        let nm = |x: f64| (x * NM as f64).round() / NM as f64;
        let corner = [50.0, 0.0, 0.0, nm(50.0 * g1)];
        let end = [nm(50.0 + 50.0 * angle.cos()), nm(50.0 * angle.sin()), 0.0, nm(50.0 * (g1 + g2))];
        let program = Program::new("unequal", 4).line(&corner, 3000.0).line(&end, 3000.0);
        let contour = Contour {
            track_dev: mm(tolerance),
            pre_dist: mm(pre),
            post_dist: mm(post),
            max_angle: Some(Position::const_from_int(180)),
            method: Some(ContourMethod::Dist),
            ..Contour::default()
        };
        let blocks = blocks(&program, &machine);
        let pieces = round(&blocks, &machine, &contour);
        let points = [vec![0.0; 4], corner.to_vec(), end.to_vec()];
        let fits = |part: f64| follows(&polygon_of(&pieces), &points, [50.0, part * tolerance]);
        assert!(fits(1.0 + 1e-5), "{seed}: {pre} {post} {tolerance}");
        // The distances of this corner without the tolerance.
        let free = round(&blocks, &machine, &Contour { track_dev: mm(0.0), ..contour });
        assert!(
            pieces.len() > 2 || free.len() == 2,
            "{seed}: {angle} {g1} {g2} {pre} {post} {tolerance}: {}",
            free.len()
        );
        if free[0].length() + 1e-6 < pieces[0].length() {
            shorter += 1;
        }
    }
    assert!((60..190).contains(&shorter), "{shorter}");
}

fn mm(x: f64) -> Option<Position> {
    Some(position((x * NM as f64).round() as i64))
}

/// All of a rounded contour as points.
fn polygon_of(pieces: &[Piece<4>]) -> Vec<Vec<f64>> {
    let mut points = vec![pieces[0].at(0.0)];
    for piece in pieces {
        let parts = if piece.out.curving.is_some() { 48 } else { 1 };
        points.extend((1..=parts).map(|i| piece.at(f64::from(i) / f64::from(parts))));
    }
    points
}

/// Rows of short blocks, in which the tracking axis turns along, or by itself.
#[test]
fn short_blocks_keep_the_tracking_tolerance() {
    let machine = machines::even::<4>(1000);
    let nm = |x: f64| (x * NM as f64).round() / NM as f64;
    let mut left_out = 0;
    for seed in 0..60 {
        let mut r = Random::new(seed);
        let (mut heading, mut slope) = (0.0, r.between(-2.0, 2.0));
        let mut at = [0.0; 4];
        let mut points = vec![at.to_vec()];
        let mut program = Program::new("short", 4);
        let [least, most] = if r.once_in(2) { [0.002, 0.1] } else { [0.02, 2.0] };
        for _ in 0..30 {
            heading += r.between(-0.8, 0.8);
            slope += r.between(-1.0, 1.0);
            let length = r.magnitude(least, most);
            let turn = if r.once_in(10) { r.between(-3.0, 3.0) } else { slope * length };
            let way = [length * f64::cos(heading), length * f64::sin(heading), 0.0, turn];
            at = std::array::from_fn(|k| nm(at[k] + way[k]));
            program = program.line(&at, 6000.0);
            points.push(at.to_vec());
        }
        let blocks = blocks(&program, &machine);
        for d in [0.01, 0.05, 0.2] {
            let contour = Contour {
                path_dev: mm(d),
                track_dev: mm(d),
                relevant_path: mm(d),
                relevant_track: mm(d),
                max_angle: Some(Position::const_from_int(180)),
                method: Some(ContourMethod::Dev),
                ..Contour::default()
            };
            let dist = Contour {
                method: Some(ContourMethod::Dist),
                path_dev: None,
                pre_dist: mm(3.0 * d),
                post_dist: mm(if r.once_in(2) { d } else { 3.0 * d }),
                ..contour
            };
            for (contour, near) in [(contour, d), (dist, 6.0 * d)] {
                let pieces = round(&blocks, &machine, &contour);
                assert!(
                    follows(&polygon_of(&pieces), &points, [near * 1.001, d * 1.001]),
                    "{:?} {d}, row {seed}",
                    contour.method
                );
                let mut numbers: Vec<u32> = pieces.iter().map(|piece| piece.out.data.number).collect();
                numbers.dedup();
                left_out += 30 - numbers.len();
            }
        }
    }
    assert!(left_out > 500, "{left_out}");
}

//! DIST_MASTER, and the other methods if the feed axes are not the main axes.
use glidepath::channel::Error;
use glidepath::machine::{MODE_MASTER, MachineData};
use glidepath::nc::{Contour, ContourMethod, NcWarningKind};
use glidepath::path;
use glidepath::quantity::Position;
use host_tests::cases::machines::feeding;
use host_tests::cases::random::{Mix, Random, program};
use host_tests::cases::{NM, Program, machines, set_point};
use host_tests::check;
use host_tests::corner::{blocks, position, round};
use host_tests::deviation::deviation;
use host_tests::operate::{Act, operate_text};
use host_tests::properties::{axis_limits, permitted};
use host_tests::refusal::{refusal, refused};
use host_tests::rounded::{Run, quick, run_from};

/// Programs from zero on.
fn go(text: &str, machine: &MachineData<3>) -> Run {
    run_from(text, [Position::ZERO; 3], machine)
}

/// The machine of the corners, led by X.
fn led() -> MachineData<3> {
    feeding(quick(1000), &[0])
}

/// A plate is handed on: X goes all the way, Y and Z beside it.
fn handling(mode: &str, feed: u32) -> String {
    format!(
        "#CONTOUR MODE ON [{mode}]\nN10 G01 X100 F{feed}\nN20 X200 Y60\nN30 X300 Y-10 Z30\nN40 X400 Z0\nN50 X500 Z40\nN60 G260 X600 Y0 Z0\nM30\n"
    )
}

/// Slopes dy/dx and dz/dx of the handling path, and where each begins.
const SLOPES: [[f64; 2]; 6] = [[0.0, 0.0], [0.6, 0.0], [-0.7, 0.3], [0.0, -0.3], [0.0, 0.4], [0.1, -0.4]];

/// Y and Z of the handling path before it is rounded.
fn programmed(x: f64) -> [f64; 2] {
    let mut at = [0.0; 2];
    for (i, slope) in SLOPES.iter().enumerate() {
        let along = (x - 100.0 * i as f64).clamp(0.0, 100.0);
        at = [0, 1].map(|k| at[k] + slope[k] * along);
    }
    at
}

/// Rows: D3-130.
#[test]
fn the_master_keeps_its_speed_and_the_others_change_theirs_evenly() {
    const V: f64 = 20_000.0 / 60.0;
    let run = go(&handling("DIST_MASTER SYM_DIST=-1", 20_000), &led());
    assert!(run.warnings.is_empty(), "{:?}", run.warnings);
    // From the first corner to the last one X has its feed, and so the whole takes as long as a straight
    // line.
    let row = |i: usize| run.trace.mm(i);
    for (i, v) in run.axis_speeds(0).into_iter().enumerate() {
        let x = row(i)[0];
        assert!(!(45.0..550.0).contains(&x) || (v - V).abs() < 1e-4 * V, "{v} at {x}");
    }
    let straight = go("N10 G01 X600 F20000\nM30\n", &led()).time();
    assert!((run.time() - straight).abs() < 3e-3, "{} {straight}", run.time());
    // Each corner by the formula: acceleration is a trapezoid over the time T = 2·D/V, and both motions of an
    // axis follow it, so that y = yC + m2·(x − xC) + (m1 − m2)·(what one of them still has to go).
    for corner in 1..SLOPES.len() {
        let at = 100.0 * corner as f64;
        let change = [0, 1].map(|k| SLOPES[corner][k] - SLOPES[corner - 1][k]);
        let rows: Vec<usize> = (0..run.trace.len()).filter(|&i| (row(i)[0] - at).abs() < 49.0).collect();
        // What is beside the programmed contour, for a change of slope of 1.
        let off = |i: usize, k: usize| (row(i)[1 + k] - programmed(row(i)[0])[k]) / change[k];
        let beside: Vec<(f64, f64)> = rows
            .iter()
            .map(|&i| {
                let k = usize::from(change[1].abs() > change[0].abs());
                // Both axes are bent by the same law.
                if change[0] * change[1] != 0.0 {
                    assert!((off(i, 0) - off(i, 1)).abs() < 1e-5, "corner {corner}");
                }
                (row(i)[0] - at, off(i, k))
            })
            .collect();
        // The extent of the curve, and its largest acceleration and jerk, by differences over ticks.
        let begins = beside.iter().find(|(_, off)| *off > 1e-6).expect("a curve").0;
        let ends = beside.iter().rev().find(|(_, off)| *off > 1e-6).expect("a curve").0;
        assert!((begins + ends).abs() < 1.0, "corner {corner}: from {begins} to {ends}");
        let curve: Vec<f64> = rows
            .iter()
            .map(|&i| {
                let k = usize::from(change[1].abs() > change[0].abs());
                row(i)[1 + k] / change[k]
            })
            .collect();
        let second: Vec<f64> = curve.windows(3).map(|w| (w[2] - 2.0 * w[1] + w[0]) * 1e6).collect();
        let third: Vec<f64> = second.windows(2).map(|w| (w[1] - w[0]) * 1e3).collect();
        let [a, j] = [&second, &third].map(|d| d.iter().copied().fold(0.0, f64::max));
        assert!(second.iter().all(|s| *s > -1e-3 * a), "corner {corner}: the acceleration has one sign");
        // V = a·(T − ramp) with ramp = a/j.
        let (ramp, whole) = (a / j, V / a + a / j);
        let distance = 0.5 * V * whole;
        assert!(whole > 2.0 * ramp && distance < 50.01, "corner {corner}: {whole} s, {distance} mm");
        for (u, off) in &beside {
            // Time before the middle on the first line, after it on the second: the same.
            let t = 0.5 * whole - u.abs() / V;
            let hold = whole - 2.0 * ramp;
            let p = if t <= 0.0 {
                0.0
            } else if t <= ramp {
                j * t.powi(3) / 6.0
            } else {
                a * (ramp * ramp / 6.0 + 0.5 * (t - ramp) * t.min(ramp + hold))
            };
            assert!((p - off).abs() < 2e-3 * V * ramp, "corner {corner} at {u}: {off} instead of {p}");
        }
    }
}

#[test]
fn the_distance_is_path_of_the_master_and_the_same_on_both_sides() {
    // Where Y begins to turn, and where it goes straight again: mm of X before and behind the corner at 100.
    let extent = |run: &Run, slopes: [f64; 2]| {
        let row = |i: usize| run.trace.mm(i);
        let off = |i: usize| {
            let x = row(i)[0] - 100.0;
            (row(i)[1] - 100.0 * slopes[0] - x * slopes[usize::from(x > 0.0)]).abs() > 1e-6
        };
        let first = (0..run.trace.len()).find(|&i| off(i)).expect("a curve");
        let last = (0..run.trace.len()).rev().find(|&i| off(i)).expect("a curve");
        [100.0 - row(first - 1)[0], row(last + 1)[0] - 100.0]
    };
    let corner = |rest: &str, feed: u32, [up, down]: [f64; 2]| {
        let text = format!(
            "#CONTOUR MODE ON [DIST_MASTER {rest}]\nN10 G01 X100 Y{} F{feed}\nN20 G260 X200 Y{}\nM30\n",
            100.0 * up,
            100.0 * (up + down)
        );
        (go(&text, &led()), [up, down])
    };
    for (slopes, distance) in [([0.0, 1.0], 12.0), ([0.5, -0.3], 7.5), ([-2.0, 1.0], 20.0), ([3.0, 3.2], 5.0)]
    {
        // At a feed at which that distance needs more than ACC_MIN and less than ACC_MAX.
        let run = corner(&format!("SYM_DIST={distance} ACC_MIN=1"), 6000, slopes);
        let seen = extent(&run.0, slopes);
        // Up to what does not show yet at both ends.
        for side in seen {
            assert!((0.8 * distance..=distance + 0.11).contains(&side), "{slopes:?}: {seen:?} of {distance}");
        }
        assert!((seen[0] - seen[1]).abs() < 0.25, "{slopes:?}: {seen:?}");
        // What is left of both blocks is path: that of X alone.
        let left = [run.0.lengths(10)[0], *run.0.lengths(20).last().expect("a block")];
        assert!(left.iter().all(|l| (l - (100.0 - distance)).abs() < 1e-3), "{slopes:?}: {left:?}");
    }
    // The default is 1 mm, off is half a block, and what is given stays.
    let left = |rest: &str| corner(rest, 6000, [0.0, 0.5]).0.lengths(10)[0];
    assert!((left("ACC_MIN=1") - 99.0).abs() < 1e-3, "{}", left("ACC_MIN=1"));
    assert!((left("SYM_DIST=-1 ACC_MIN=1") - 50.0).abs() < 3e-3, "{}", left("SYM_DIST=-1 ACC_MIN=1"));
    let text = "#CONTOUR MODE [DIST_MASTER SYM_DIST=4 ACC_MIN=1]\n#CONTOUR MODE ON [DIST_MASTER]\nN10 G01 X100 F6000\nN20 G260 X200 Y50\nM30\n";
    assert!((go(text, &led()).lengths(10)[0] - 96.0).abs() < 1e-3);
}

/// Largest acceleration and jerk of Y within `reach` of X200.
fn peaks_within(run: &Run, reach: f64) -> [f64; 2] {
    let rows = (0..run.trace.len()).map(|i| run.trace.mm(i));
    let y: Vec<f64> = rows.filter(|row| (row[0] - 200.0).abs() < reach).map(|row| row[1]).collect();
    let second: Vec<f64> = y.windows(3).map(|w| (w[2] - 2.0 * w[1] + w[0]) * 1e6).collect();
    let third = second.windows(2).map(|w| (w[1] - w[0]).abs() * 1e3);
    [second.iter().fold(0.0, |m, a| a.abs().max(m)), third.fold(0.0, f64::max)]
}

#[test]
fn acceleration_and_ramp_of_a_corner_follow_their_keywords() {
    // Y changes its speed in the middle of a long way: nothing else accelerates it. Of 2000 mm/s² a curve
    // takes 93 % at most, of 40 000 mm/s³ 85 %: that is 100 %, with a ramp of 55 ms.
    let peaks = |run: &Run| peaks_within(run, 100.0);
    let corner = |rest: &str| {
        go(
            &format!(
                "#CONTOUR MODE ON [DIST_MASTER {rest}]\nN10 G01 X200 F12000\nN20 G260 X400 Y200\nN30 X500 Y300\nM30\n"
            ),
            &led(),
        )
    };
    let near = |seen: f64, expected: f64| (seen - expected).abs() < 5e-3 * expected;
    const A: f64 = 0.93 * 2000.0;
    const RAMP: f64 = A / (0.85 * 40_000.0);
    // No more than ACC_MIN is needed: 50 % without being asked for, 200 mm/s in 200/930 + ramp.
    let half = corner("SYM_DIST=60");
    assert!(near(peaks(&half)[0], 0.5 * A) && near(peaks(&half)[1], 0.5 * A / RAMP), "{:?}", peaks(&half));
    let left = 200.0 - 0.5 * 200.0 * (200.0 / (0.5 * A) + RAMP);
    assert!((half.lengths(10)[0] - left).abs() < 0.02, "{} {left}", half.lengths(10)[0]);
    let quarter = corner("SYM_DIST=90 ACC_MIN=25");
    assert!(near(peaks(&quarter)[0], 0.25 * A), "{:?}", peaks(&quarter));
    // More than ACC_MIN where the distance asks for it: D = v/2·(v/a + ramp).
    let more = corner("SYM_DIST=20");
    assert!(near(peaks(&more)[0], 200.0 / (2.0 * 20.0 / 200.0 - RAMP)), "{:?}", peaks(&more));
    // Up to 100 % without being asked for, then less speed; up to ACC_MAX if that is given.
    let all = corner("SYM_DIST=10");
    let inside = |run: &Run| peaks_within(run, 9.9)[0];
    assert!(near(inside(&all), A), "{}", inside(&all));
    let some = corner("SYM_DIST=10 ACC_MAX=60");
    assert!(near(inside(&some), 0.6 * A) && some.time() > all.time(), "{}", inside(&some));
    let slowest = |run: &Run| {
        let x = run.axis_speeds(0);
        (0..x.len())
            .filter(|&i| (150.0..250.0).contains(&run.trace.mm(i)[0]))
            .map(|i| x[i])
            .fold(1e9, f64::min)
    };
    let v = |acceleration: f64| {
        // D = v/2·(v/a + ramp), solved for the speed.
        0.5 * (-RAMP * acceleration
            + (RAMP * RAMP * acceleration * acceleration + 8.0 * 10.0 * acceleration).sqrt())
    };
    assert!(
        near(slowest(&all), v(A)) && near(slowest(&some), v(0.6 * A)),
        "{} {}",
        slowest(&all),
        slowest(&some)
    );
    assert!(near(slowest(&more), 200.0) && near(slowest(&half), 200.0));
    // RAMP_TIME: 100 % without being asked for, the jerk of twice the time is half.
    let slow = corner("SYM_DIST=60 RAMP_TIME=200");
    let same = corner("SYM_DIST=60 RAMP_TIME=100");
    assert_eq!(same.digest, half.digest);
    assert!(near(peaks(&slow)[1], 0.25 * A / RAMP), "{:?}", peaks(&slow));
    // What belongs to other methods is refused beside it.
    for word in ["PATH_DIST=1", "TRACK_DIST=1", "PATH_DEV=1", "MERGE=0"] {
        let text = format!("#CONTOUR MODE [DIST_MASTER {word}]\nM30\n");
        assert!(matches!(refused(&text, &led()), Error::Nc(_)), "{word}");
    }
    for (word, fits) in [
        ("SYM_DIST=-2", false),
        ("ACC_MAX=101", false),
        ("ACC_MIN=-1", false),
        ("RAMP_TIME=10001", false),
        ("RAMP_TIME=10000", true),
        ("DIST_WEIGHT=101", false),
        ("DIST_WEIGHT=100", true),
    ] {
        let text = format!("#CONTOUR MODE [DIST_MASTER {word}]\nG00 X1\nM30\n");
        assert_eq!(refusal(&text, &led()).is_none(), fits, "{word}");
    }
}

#[test]
fn blocks_are_divided_by_the_neighbours_on_the_masters_path() {
    // N20 is 20 mm of X between 60 mm and 30 mm, however far Y goes: half of it for each corner, or two
    // thirds and one.
    let divided = |weight: &str| {
        let text = format!(
            "#CONTOUR MODE ON [DIST_MASTER SYM_DIST=-1 ACC_MIN=1 ACC_MAX=5 {weight}]\nN10 G01 X60 Y50 F20000\nN20 X80 Y-40\nN30 G260 X110 Y30\nN40 X200\nM30\n"
        );
        let run = go(&text, &led());
        assert!(run.warnings.is_empty() && run.trace.mm(run.trace.len() - 1) == [200.0, 30.0, 0.0]);
        [60.0 - run.lengths(10)[0], 30.0 - *run.lengths(30).last().expect("a block")]
    };
    let shift = 10.0 / 3.0;
    for (weight, expected) in [
        ("", [10.0, 10.0]),
        ("DIST_WEIGHT=0", [10.0, 10.0]),
        ("DIST_WEIGHT=50", [10.0 + 0.5 * shift, 10.0 - 0.5 * shift]),
        ("DIST_WEIGHT=100", [10.0 + shift, 10.0 - shift]),
    ] {
        let seen = divided(weight);
        assert!(seen.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-3), "{weight}: {seen:?}");
    }
}

#[test]
fn a_handling_path_is_faster_with_a_master_than_with_the_path_in_space() {
    for slope in 1..4 {
        for (distance, feed) in [(-1.0, 20_000), (40.0, 12_000), (20.0, 20_000), (5.0, 60_000)] {
            let with = |method: &str, feed_axes: &[usize]| {
                let mut machine = feeding(quick(1000), feed_axes);
                machine.channel.slope_profile = slope;
                let run = go(&handling(&format!("{method}={distance}"), feed), &machine);
                (run.time(), run.axis_speeds(0))
            };
            let (soft, _) = with("DIST_SOFT PATH_DIST", &[]);
            let (master, x) = with("DIST_MASTER SYM_DIST", &[0]);
            assert!(master <= soft, "slope {slope}, {distance} mm, F {feed}: {master} s instead of {soft} s");
            if distance < 0.0 {
                // No corner costs speed: DIST_SOFT slows X down wherever the path turns away from it.
                let straight = 600.0 / (20_000.0 / 60.0) + (20_000.0 / 60.0) / 2000.0 + 0.05;
                assert!((master - straight).abs() < 6e-3, "slope {slope}: {master} {straight}");
                assert!(x.iter().all(|v| *v <= 20_000.0 / 60.0 + 1e-3));
                assert!(soft > 1.08 * master, "{soft} {master}");
                // As in the README.
                if slope == 3 {
                    assert!((master - 2.017).abs() < 2e-3 && (soft - 2.198).abs() < 2e-3, "{master} {soft}");
                }
            }
        }
    }
}

/// Rows: D3-132.
#[test]
fn where_the_master_rests_or_turns_back_the_curve_keeps_its_distance_and_says_so() {
    // Up, across, back and down again.
    let text = |mode: &str| {
        format!(
            "#CONTOUR MODE ON [{mode}]\nN10 G01 Z50 F20000\nN20 X100 Y30\nN30 X200\nN40 X20 Y60\nN50 G260 Y0 Z0\nM30\n"
        )
    };
    let master = go(&text("DIST_MASTER SYM_DIST=5"), &led());
    // Not N20 → N30: there it goes on.
    let told: Vec<u32> = master.warnings.iter().map(|(line, _)| *line).collect();
    assert!(
        master.warnings.iter().all(|(_, kind)| *kind == NcWarningKind::MasterRests),
        "{:?}",
        master.warnings
    );
    assert_eq!(told, [3, 5, 6]);
    // The distance alone, as DIST has it: on the path of each block, which is Z where X rests.
    let dist =
        go(&text("DIST PRE_DIST=5 POST_DIST=5").replace("N30 X200\n", "N30 G260 X200\nG261\n"), &led());
    for n in [10, 50] {
        let [a, b] = [&master, &dist].map(|run| run.lengths(n));
        assert!(
            a.len() == b.len() && a.iter().zip(&b).all(|(a, b)| (a - b).abs() < 1e-9),
            "N{n}: {a:?} {b:?}"
        );
    }
    assert!((master.lengths(10)[0] - 45.0).abs() < 1e-6, "{:?}", master.lengths(10));
    let seen = master.trace.mm(master.trace.len() - 1);
    assert_eq!(seen, [20.0, 0.0, 0.0]);
    let limits: Vec<_> = led().axes.iter().map(|axis| permitted(axis, 3, false, true, true)).collect();
    check::limits(&master.trace, &limits).expect("limits");
    // The corner as it is where nothing is to be rounded: no word.
    let sharp = go(
        "#CONTOUR MODE ON [DIST_MASTER SYM_DIST=0]\nN10 G01 Z50 F20000\nN20 X100\nN30 G260 X0\nM30\n",
        &led(),
    );
    assert_eq!(sharp.warnings.len(), 1);
}

#[test]
fn without_a_master_axis_the_method_is_refused() {
    let text = "N10 G01 X1 F600\nN20 #CONTOUR MODE ON [DIST_MASTER SYM_DIST=1]\nN30 X2\nM30\n";
    let marked = |feed: &[usize], master: &[usize]| {
        let mut machine = machines::even::<3>(1000);
        for &k in feed {
            machine.axes[k].default_feed_axis = true;
        }
        for &k in master {
            machine.axes[k].achs_mode |= MODE_MASTER;
        }
        machine
    };
    for (feed, master) in [
        (&[][..], &[][..]),
        (&[], &[0]),
        (&[0], &[]),
        (&[0], &[1]),
        (&[0, 1], &[0]),
        (&[0, 1, 2], &[0, 1, 2]),
    ] {
        let error = refused(text, &marked(feed, master));
        assert_eq!(error.place().line, 2, "{feed:?}, {master:?}: {error}");
        assert!(matches!(error, Error::NotEnabled(..)), "{error}");
        for parameter in ["P-CHAN-00011", "P-AXIS-00015"] {
            assert!(error.to_string().contains(parameter), "{error}");
        }
    }
    assert!(refusal(text, &marked(&[0], &[0])).is_none());
    assert!(refusal(text, &marked(&[2], &[0, 2])).is_none());
    // Parameters of the method may be set before; the other methods need no master.
    assert!(refusal("#CONTOUR MODE [SYM_DIST=3]\nG01 X2 F600\nM30\n", &marked(&[], &[])).is_none());
    // The only linear axis is the only feed axis without being named.
    let mut alone = machines::even::<1>(1000);
    alone.axes[0].achs_mode |= MODE_MASTER;
    assert!(refusal(text, &alone).is_none());
}

/// A walk of `count` lines with a seed, mm.
fn walk(seed: u64, count: usize) -> (Program, Vec<[f64; 3]>) {
    let mut r = Random::new(seed);
    let mut at = [0.0; 3];
    let mut points = vec![at];
    let mut program = Program::new(format!("walk {seed}"), 3);
    for _ in 0..count {
        for x in &mut at {
            *x = ((*x + r.between(-1.0, 1.0) * r.magnitude(0.1, 5.0)) * NM as f64).round() / NM as f64;
        }
        program = program.line(&at, 6000.0);
        points.push(at);
    }
    (program, points)
}

/// Rows: D3-027.
#[test]
fn tolerances_are_distances_in_space_whatever_measures_the_path() {
    let mm = |x: f64| Some(position((x * NM as f64) as i64));
    let method = |method| Contour { method: Some(method), ..Contour::default() };
    let mut curves = 0;
    for (seed, feed) in (0..24).flat_map(|seed| [(seed, &[0][..]), (seed, &[1, 2])]) {
        let mut machine = feeding(machines::even::<3>(1000), feed);
        let (program, corners) = walk(seed, 24);
        let blocks = blocks(&program, &machine);
        for slope in [1, 3] {
            machine.channel.slope_profile = slope;
            for d in [0.003, 0.05] {
                for contour in [
                    Contour { path_dev: mm(d), ..method(ContourMethod::Dev) },
                    Contour { path_dev: mm(d), relevant_path: mm(1.0), ..method(ContourMethod::Dev) },
                    Contour { path_dev: mm(d), ..method(ContourMethod::Ptp) },
                ] {
                    let pieces = round(&blocks, &machine, &contour);
                    let (off, block) = deviation(&corners, &pieces);
                    assert!(
                        off <= d,
                        "{contour:?}, walk {seed}, {feed:?}, slope {slope}: {off} at block {block}"
                    );
                    curves += pieces.iter().filter(|piece| piece.out.curving.is_some()).count();
                    // Direction and curvature go on at every joint, over the path.
                    for pair in pieces.windows(2) {
                        let ends = |end: &path::End<3>| {
                            (
                                end.tangent.map(|t| t as f64 / (1u64 << 40) as f64),
                                end.curvature.map(f64::from),
                            )
                        };
                        let curved = pair.iter().any(|piece| piece.out.curving.is_some());
                        let (a, b) = (ends(&pair[0].out.element.exit), ends(&pair[1].out.element.entry));
                        for k in 0..3 {
                            let scale = 1.0 + a.0[k].abs();
                            let jump = (a.0[k] - b.0[k]).abs();
                            assert!(!curved || jump < 1e-6 * scale, "walk {seed}, axis {k}: {jump}");
                        }
                    }
                }
            }
        }
    }
    assert!(curves > 5000, "{curves}");
}

#[test]
fn a_curve_takes_its_tolerance_whatever_measures_the_path() {
    // Over time it may be less: what is given is the deviation where both motions are equally far from the
    // corner.
    for (feed, slope, constant, least) in [
        (&[0][..], 1, 1, 0.999),
        (&[0], 1, 0, 0.6),
        (&[0], 3, 0, 0.6),
        (&[0, 2], 1, 1, 0.999),
        (&[1], 1, 1, 0.999),
    ] {
        let mut machine = feeding(quick::<3>(1000), feed);
        machine.channel.slope_profile = slope;
        let text = format!(
            "#CONTOUR MODE ON [DEV PATH_DEV=0.5 CONST_VEL={constant}]\nN10 G01 X80 Y20 F6000\nN20 G260 X110 Y90\nM30\n"
        );
        let run = go(&text, &machine);
        let off = run.distance([80.0, 20.0]);
        assert!((0.5 * least..0.5005).contains(&off), "{feed:?}, slope {slope}: {off}");
    }
}

/// Lines of a mix for the machine, as text in a mode.
fn text_of<const AXES: usize>(program: &Program, machine: &MachineData<AXES>, mode: &str) -> String {
    program.text(machine).replacen("N1 G90\n", &format!("N1 G90\n#CONTOUR MODE ON [{mode}]\n"), 1)
}

/// Every axis inside its limits, and at the end exactly.
fn limits_hold<const AXES: usize>(program: &Program, machine: &MachineData<AXES>, mode: &str) -> usize {
    let text = text_of(program, machine, mode);
    let start: [Position; AXES] = std::array::from_fn(|k| Position::from_bits(set_point(program.start[k])));
    let run = run_from(&text, start, machine);
    check::limits(&run.trace, &axis_limits(machine, &program.contour(machine)))
        .unwrap_or_else(|fault| panic!("{} [{mode}]: {fault}\n{text}", program.name));
    let end: Vec<i64> = program.end().iter().map(|&nm| set_point(nm)).collect();
    assert!(run.trace.row(run.trace.len() - 1).eq(end), "{} [{mode}]", program.name);
    run.trace.len()
}

/// A program in which the axis goes on and on, mostly.
fn onward(seed: u64, mut program: Program, axis: usize) -> Program {
    let mut r = Random::new(seed);
    let mut at = program.start[axis];
    for block in &mut program.moves {
        at += (r.magnitude(0.5, 40.0) * NM as f64) as i64 * if r.once_in(12) { -1 } else { 1 };
        block.target[axis] = at;
    }
    program
}

const MODES: [&str; 9] = [
    "DIST_MASTER SYM_DIST=5",
    "DIST_MASTER SYM_DIST=-1 ACC_MIN=100",
    "DIST_MASTER SYM_DIST=2 RAMP_TIME=50 DIST_WEIGHT=70",
    "DIST_SOFT PATH_DIST=5",
    "DEV PATH_DEV=0.2 MAX_ANGLE=180",
    "DIST PRE_DIST=2 POST_DIST=1",
    "POS PRE_DIST=1 POST_DIST=1",
    "PTP PATH_DEV=0.1",
    "DEV PATH_DEV=0.1 RELEVANT_PATH=1",
];

#[test]
fn every_axis_stays_inside_its_limits_with_every_slope() {
    for seed in 0..5 {
        for slope in 0..4 {
            for (i, mode) in MODES.iter().enumerate() {
                let seed = seed * 16 + i as u64;
                let mix = Mix { length: [0.05, 40.0], knee: 3.0, arcs: 0, ..Mix::general(3, 30) };
                let mut mill = machines::with_slope(machines::mill::<3>(1000), slope);
                mill.channel.ptp = true;
                limits_hold(&onward(seed, program(seed, mix), 0), &feeding(mill, &[0]), mode);
                let mut even = machines::with_slope(quick::<3>(2000), slope);
                even.channel.ptp = true;
                limits_hold(&onward(seed, program(seed, mix), 1), &feeding(even, &[1]), mode);
                // A rotary master, and other axes beside it.
                let turning = Mix { length: [0.5, 40.0], knee: 3.0, arcs: 0, ..Mix::general(5, 20) };
                let mut turned = machines::with_slope(machines::mill::<5>(1000), slope);
                turned.channel.ptp = true;
                limits_hold(&onward(seed, program(seed, turning), 3), &feeding(turned, &[3]), mode);
            }
            // Two feed axes, with arcs in their plane.
            let mix = Mix { length: [0.05, 40.0], knee: 2.0, ..Mix::general(2, 30) };
            for mode in &MODES[3..7] {
                let machine = machines::with_slope(machines::mill::<2>(1000), slope);
                limits_hold(&program(seed, mix), &feeding(machine, &[0, 1]), mode);
            }
        }
    }
}

#[test]
fn a_hold_and_an_override_in_a_led_corner_keep_the_limits() {
    let text = handling("DIST_MASTER SYM_DIST=30", 20_000);
    for slope in 0..4 {
        let machine = machines::with_slope(led(), slope);
        let limits: Vec<_> =
            machine.axes.iter().map(|axis| permitted(axis, slope, false, true, true)).collect();
        let go = |acts: &[(usize, Act)]| {
            let run = operate_text::<3, 120>(&text, [Position::ZERO; 3], &machine, acts, 1000)
                .unwrap_or_else(|fault| panic!("slope {slope}, {acts:?}: {fault}"));
            check::limits(&run.trace, &limits)
                .unwrap_or_else(|fault| panic!("slope {slope}, {acts:?}: {fault}"));
            run
        };
        let whole = go(&[]);
        let (rows, length) = (whole.trace.len(), *whole.distances.last().expect("it moves"));
        let end: Vec<i64> = whole.trace.row(rows - 1).collect();
        for tick in (0..rows - 2).step_by(23) {
            for acts in [
                [(tick, Act::Hold), (tick + 2000, Act::Resume)],
                [(tick, Act::Override(300)), (tick + 400, Act::Override(1000))],
                [(tick, Act::Override(1800)), (tick + 300, Act::Override(1000))],
            ] {
                let run = go(&acts);
                assert!(run.trace.row(run.trace.len() - 1).eq(end.iter().copied()), "{acts:?}");
                // Above 100 % corners are made for more speed.
                assert!(
                    acts[0].1 == Act::Override(1800) || run.distances.last() == Some(&length),
                    "{acts:?}"
                );
            }
        }
    }
}

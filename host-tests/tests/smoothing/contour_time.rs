//! Contour mode over time: DIST_SOFT, PTP, and DEV with HSC.
use glidepath::channel::{Channel, Handles, Progress};
use glidepath::machine::MachineData;
use glidepath::nc::{Contour, ContourMethod, NcWarningKind};
use glidepath::quantity::Position;
use glidepath::queue::Function;
use host_tests::cases::random::Random;
use host_tests::cases::{Program, machines};
use host_tests::check;
use host_tests::corner::{Piece, blocks, dev, judge, random, round};
use host_tests::properties::permitted;
use host_tests::rounded::{Run, quick, run_from};

#[test]
fn random_corners_over_time_are_smooth_and_use_their_tolerance() {
    let machine = quick::<3>(1000);
    let [mut timed, mut free, mut brief] = [0; 3];
    for seed in host_tests::seeds::seeds(0..5000, 400) {
        let seen = judge(&random(seed), &machine).unwrap_or_else(|fault| panic!("corner {seed}: {fault}"));
        if !seen.timed {
            continue;
        }
        timed += 1;
        assert!(seen.used <= 1.0 && seen.uneven <= 1e-6, "corner {seed}: {seen:?}");
        if !seen.limited {
            free += 1;
            // Where both motions share an axis, less overlap may be faster.
            brief += u32::from(seen.used < 0.999);
        }
    }
    println!("{timed} over time, {free} free, {brief} of them with less than the tolerance");
    assert!(timed > 200 && free > 100 && 10 * brief <= free, "{timed}, {free}, {brief}");
}

/// Rows: D3-140, D3-142.
#[test]
fn a_square_is_faster_rounded_than_with_stops() {
    let text =
        |mode: &str| format!("{mode}\nN10 G01 X80 Y0 F20000\nN20 X80 Y80\nN30 X0 Y80\nN40 G260 X0 Y0\nM30\n");
    let machine = quick::<3>(1000);
    let square = |mode: &str| {
        let run = run_from(&text(mode), [Position::ZERO; 3], &machine);
        let limits =
            machine.axes.iter().map(|axis| permitted(axis, 3, false, true, true)).collect::<Vec<_>>();
        check::limits(&run.trace, &limits).unwrap_or_else(|fault| panic!("{mode}: {fault}"));
        for corner in [[80.0, 0.0], [80.0, 80.0], [0.0, 80.0]] {
            assert!(run.distance(corner) > 0.0999, "{mode}: {}", run.distance(corner));
        }
        run.time()
    };
    // With stops 1.827 s; the optimum on this curve is 1.695 s.
    let dev = square("#CONTOUR MODE ON [DEV PATH_DEV=0.1]");
    assert!((1.7..1.745).contains(&dev), "{dev}");
    let ptp = square("#CONTOUR MODE ON [PTP PATH_DEV=0.1]");
    assert!((1.69..1.71).contains(&ptp), "{ptp}");
    // The distance at which that curve leaves the line; of both the smaller corner.
    let by_dist = square("#CONTOUR MODE ON [PTP PATH_DIST=0.566]");
    assert!((by_dist - ptp).abs() < 1e-3, "{by_dist}");
    let both = square("#CONTOUR MODE ON [PTP PATH_DEV=0.1 PATH_DIST=5]");
    assert_eq!(both, ptp);
}

/// Rows: D3-138, D3-139, D3-141, D3-152.
#[test]
fn ptp_has_an_axis_at_its_limit_and_acceleration_at_the_ends_of_the_corner() {
    let text = |mode: &str| format!("#CONTOUR MODE ON [{mode}]\nN10 G01 X80 F20000\nN20 G260 Y80\nM30\n");
    let ptp = run_from(&text("PTP PATH_DEV=0.1"), [Position::ZERO; 3], &quick(1000));
    let dev = run_from(&text("DEV PATH_DEV=0.1"), [Position::ZERO; 3], &quick(1000));
    assert!(ptp.time() < dev.time(), "{} {}", ptp.time(), dev.time());
    // All rows between the one where Y begins and the one where X ends: X with its jerk, and still slowing
    // down.
    let row = |i: usize| ptp.trace.mm(i);
    let begins = (0..ptp.trace.len()).find(|&i| row(i)[1] > 0.0).expect("Y moves");
    let ends = (0..ptp.trace.len()).find(|&i| row(i)[0] >= 80.0).expect("X arrives");
    assert!(ends > begins + 20, "{begins} {ends}");
    let second = |i: usize, k: usize| (row(i + 1)[k] - 2.0 * row(i)[k] + row(i - 1)[k]) * 1e6;
    let (first, last) = (second(begins, 0), second(ends - 1, 0));
    assert!(first < -1500.0 && last > -100.0, "{first} {last}");
    for i in begins + 2..ends - 2 {
        let jerk = (second(i + 1, 0) - second(i, 0)) * 1e3;
        assert!((37_000.0..40_000.0).contains(&jerk), "{jerk} at {i} of {begins}..{ends}");
    }
}

/// D3-139, D3-287: where the feed is reached, a PTP corner is driven at the feed with the least acceleration that its
/// tolerance permits. Where the feed is not reached, an axis uses what it has: the test below.
#[test]
fn ptp_at_the_feed_takes_the_least_acceleration_d3_287() {
    let drive = |mode: &str, feed: u32| {
        let text = format!("#CONTOUR MODE ON [{mode}]\nN10 G01 X100 F{feed}\nN20 Y100\nM30\n");
        run_from(&text, [Position::ZERO; 3], &quick(1000))
    };
    // Least speed in the corner, and largest acceleration of an axis there.
    let corner = |run: &Run| {
        let row = |i: usize| run.trace.mm(i);
        let inside = (1..run.trace.len() - 1).filter(|&i| row(i)[1] > 0.0 && row(i)[0] < 100.0);
        inside.fold((f64::MAX, 0.0), |(v, a): (f64, f64), i| {
            let step = |k: usize| [row(i)[k] - row(i - 1)[k], row(i + 1)[k] - row(i)[k]];
            let (x, y) = (step(0), step(1));
            let most = f64::max((x[1] - x[0]).abs(), (y[1] - y[0]).abs()) * 1e6;
            (v.min(x[0].hypot(y[0]) * 1e3), a.max(most))
        })
    };
    for (feed, dev) in [(6000, 5.0), (6000, 2.0), (3000, 1.0), (9000, 10.0)] {
        let run = drive(&format!("PTP PATH_DEV={dev}"), feed);
        let (off, v) = (run.distance([100.0, 0.0]), f64::from(feed) / 60.0);
        assert!((0.995 * dev..1.001 * dev).contains(&off), "F{feed}, PATH_DEV={dev}: {off}");
        let (least, most) = corner(&run);
        // At constant speed a circle as far from the corner, R·(√2 − 1). Where both lines overlap, which takes the
        // time of one line as long as both, even acceleration, √2·v²/(8·a), but for its ramps.
        let bound = if least > 0.99 * v {
            v * v * (2.0_f64.sqrt() - 1.0) / dev
        } else {
            1.4 * 2.0_f64.sqrt() * v * v / (8.0 * dev)
        };
        println!("F{feed}, PATH_DEV={dev}: {off} mm, {least} mm/s, {most} of {bound} mm/s²");
        assert!(
            most < bound && least > 0.7 * v,
            "F{feed}, PATH_DEV={dev}: {least} mm/s, {most} of {bound} mm/s²"
        );
        let line = run_from(&format!("G01 X200 F{feed}\nM30\n"), [Position::ZERO; 3], &quick(1000));
        assert!(run.time() <= line.time() + 0.002, "{} of {}", run.time(), line.time());
    }
}

/// D3-286: the slope STEP has no ramp times, so DIST_SOFT, DIST_MASTER and PTP optimise nothing. One warning for each
/// command tells.
#[test]
fn with_step_nothing_is_optimised_and_a_warning_tells_d3_286() {
    let warnings = |slope: &str, mode: &str| {
        let text = format!(
            "#SLOPE [TYPE={slope}]\n#CONTOUR MODE ON [{mode}]\nN10 G01 X80 F6000\nN20 Y80\nN30 X0\n#CONTOUR MODE OFF\n#CONTOUR MODE ON [{mode}]\nX80\nY0\nM30\n"
        );
        run_from(&text, [Position::ZERO; 3], &quick(1000)).warnings
    };
    for mode in ["DIST_SOFT PATH_DIST=2", "PTP PATH_DEV=0.5"] {
        let told = warnings("STEP", mode);
        assert_eq!(
            told.iter().map(|(_, kind)| *kind).collect::<Vec<_>>(),
            [NcWarningKind::StepIsNotOptimised; 2]
        );
        for slope in ["TRAPEZ", "SIN2", "HSC"] {
            assert_eq!(warnings(slope, mode), [], "{slope}, {mode}");
        }
    }
    for mode in ["DEV PATH_DEV=0.1", "DIST PRE_DIST=1", "POS"] {
        assert_eq!(warnings("STEP", mode), [], "{mode}");
    }
}

#[test]
fn ptp_makes_one_of_blocks_that_go_straight_on() {
    let text = |merge: &str, between: &str| {
        format!(
            "#CONTOUR MODE ON [PTP PATH_DEV=5 {merge}]\nN10 G01 X10 Y5 F20000\nN20 X30 Y15\n{between}N30 X40 Y20\nN40 G260 X40 Y80\nM30\n"
        )
    };
    let one = run_from(&text("", ""), [Position::ZERO; 3], &quick(1000));
    let apart = run_from(&text("MERGE=0", ""), [Position::ZERO; 3], &quick(1000));
    // The corner has half of all three blocks to begin in, not of the last one.
    let off = |run: &Run| run.distance([40.0, 20.0]);
    assert!(off(&one) > 1.5 * off(&apart) && one.time() < apart.time(), "{} {}", off(&one), off(&apart));
    assert!(one.lengths(10).is_empty() && one.lengths(20).is_empty(), "{:?}", one.lengths(10));
    assert_eq!(one.blocks.iter().map(|span| span.blocks).sum::<u32>(), 4);
    assert!(!apart.lengths(10).is_empty() || !apart.lengths(20).is_empty());
    // A function between the blocks keeps its point; another feed its block.
    let held = run_from(&text("", "M25\n"), [Position::ZERO; 3], &quick(1000));
    let [(row, _)] = held.events[..] else { panic!("{:?}", held.events) };
    assert!((held.trace.mm(row)[0] - 30.0).abs() < 0.4, "{:?}", held.trace.mm(row));
    let slower = run_from(&text("", "F10000\n"), [Position::ZERO; 3], &quick(1000));
    assert!(off(&slower) < 1.1 * off(&apart), "{}", off(&slower));
}

/// Rows: D3-150, D3-151.
#[test]
fn ptp_is_enabled_by_machine_data_and_ends_at_an_arc() {
    let text = "#CONTOUR MODE ON [PTP PATH_DEV=0.5]\nN10 G01 X40 F20000\nN20 Y40\nN30 G02 X60 Y60 I20\nN40 G01 X90\nN50 Y0\nM30\n";
    let run = run_from(text, [Position::ZERO; 3], &quick(1000));
    assert_eq!(run.warnings, [(4, NcWarningKind::PtpArc)]);
    assert!((run.distance([40.0, 0.0]) - 0.5).abs() < 1e-3);
    // The corner before the arc, and all behind it.
    for corner in [[40.0, 40.0], [60.0, 60.0], [90.0, 60.0]] {
        assert!(run.distance(corner) < 0.2, "{corner:?}");
    }
    let mut channel: Box<Channel<3, 120>> = Box::new(Channel::new());
    let machine = machines::even(1000);
    let Handles { mut planner, .. } =
        channel.split(&machine, [Position::ZERO; 3], text.as_bytes()).expect("machine data");
    let error = loop {
        match planner.poll() {
            Ok(Progress::Working) => {}
            Ok(other) => panic!("{other:?}"),
            Err(error) => break error,
        }
    };
    assert_eq!(error.place().line, 1);
    assert!(error.to_string().contains("P-CHAN-00600"), "{error}");
}

/// Rows: D3-116, D3-127.
#[test]
fn soft_corners_keep_their_distance_and_change_speed_evenly() {
    let soft = |rest: &str, feed: u32| {
        let text = format!("#CONTOUR MODE ON [DIST_SOFT {rest}]\nN10 G01 X80 F{feed}\nN20 G260 Y80\nM30\n");
        run_from(&text, [Position::ZERO; 3], &quick(1000))
    };
    // Where Y leaves 0 and X arrives at 80: never further than the distance.
    let distance = |run: &Run| {
        let row = |i: usize| run.trace.mm(i);
        let begins = (0..run.trace.len()).find(|&i| row(i)[1] > 0.0).expect("Y moves");
        let arrives = (0..run.trace.len()).find(|&i| row(i)[0] >= 80.0).expect("X arrives");
        (80.0 - row(begins - 1)[0]).max(row(arrives)[1])
    };
    let speeds = |run: &Run| {
        let (row, cycle) = (|i: usize| run.trace.mm(i), run.trace.cycle);
        let middle = (1..run.trace.len())
            .filter(|&i| row(i)[1] > 0.0 && row(i)[0] < 80.0)
            .map(|i| (row(i)[0] - row(i - 1)[0] + row(i)[1] - row(i - 1)[1]) / cycle);
        middle.fold([f64::INFINITY, 0.0], |[low, high], v| [v.min(low), v.max(high)])
    };
    let wide = soft("PATH_DIST=12", 12_000);
    let [low, high] = speeds(&wide);
    // Both axes change their speed by the same law: their sum stays.
    assert!(high - low < 0.01 * high, "{low} {high}");
    assert!((11.9..=12.0 + 0.2).contains(&distance(&wide)), "{}", distance(&wide));
    // With less distance more acceleration, up to ACC_MAX; then less speed.
    let half = soft("PATH_DIST=20", 6000);
    assert!((peaks_inside(&half) - 0.5).abs() < 0.05, "{}", peaks_inside(&half));
    let most = soft("PATH_DIST=2 ACC_MAX=80", 12_000);
    assert!(
        peaks_inside(&most) < 0.8 && distance(&most) <= 2.1,
        "{} {}",
        peaks_inside(&most),
        distance(&most)
    );
    assert!(speeds(&most)[1] < 0.6 * high && most.time() > wide.time());
    // Not monitored: half the block.
    let off = soft("PATH_DIST=-1 ACC_MIN=1 ACC_MAX=10", 12_000);
    assert!((30.0..40.2).contains(&distance(&off)), "{}", distance(&off));
    // A longer ramp: less jerk.
    let slow = soft("PATH_DIST=-1 RAMP_TIME=200", 6000);
    assert!(jerk_inside(&slow) < 0.6 * jerk_inside(&half), "{} {}", jerk_inside(&slow), jerk_inside(&half));
}

/// The largest ramp time of the four, and of the axes; ACC_MAX and RAMP_TIME act on that.
///
/// Rows: D3-124.
#[test]
fn soft_corners_take_the_longest_ramp_time() {
    const WIDE: &str = "PATH_DIST=-1 ACC_MIN=100";
    let rises = |set: &dyn Fn(&mut MachineData<3>), rest: &str| {
        let mut machine = quick::<3>(1000);
        for axis in &mut machine.axes {
            (axis.a_beschl, axis.a_brems, axis.a_max) = (2000, 2000, 4000);
            (axis.tr_beschl_zu, axis.tr_beschl_ab, axis.tr_brems_zu, axis.tr_brems_ab) =
                (100_000, 100_000, 100_000, 100_000);
            axis.tr_geom = 50_000;
        }
        set(&mut machine);
        let text = format!("#CONTOUR MODE ON [DIST_SOFT {rest}]\nN10 G01 X400 F30000\nN20 G260 Y400\nM30\n");
        let run = run_from(&text, [Position::ZERO; 3], &machine);
        // Ticks from rest to all of the acceleration, of Y in the corner.
        let row = |i: usize| run.trace.mm(i)[1];
        let a: Vec<f64> = (1..run.trace.len() - 1)
            .filter(|&i| run.trace.mm(i)[0] < 400.0)
            .map(|i| (row(i + 1) - 2.0 * row(i) + row(i - 1)) * 1e6)
            .collect();
        let most = a.iter().copied().fold(0.0, f64::max);
        let first = a.iter().position(|a| *a > 0.05 * most).expect("it begins");
        let full = a.iter().position(|a| *a > 0.95 * most).expect("it is there");
        (most, (full - first) as f64 / 0.9)
    };
    let near = |seen: (f64, f64), a: f64, ramp: f64| {
        assert!(
            (seen.0 - a).abs() < 0.02 * a && (seen.1 - ramp).abs() < 0.02 * ramp,
            "{seen:?}, not {a} in {ramp}"
        );
    };
    near(rises(&|_| {}, WIDE), 2000.0, 100.0);
    near(rises(&|_| {}, "PATH_DIST=-1 ACC_MIN=50"), 1000.0, 100.0);
    // 4000 mm/s² in 200 ms and 1000 mm/s² in 100 ms: of one axis, and of two.
    let one = |machine: &mut MachineData<3>| {
        for axis in &mut machine.axes {
            (axis.a_beschl, axis.a_brems) = (4000, 1000);
            (axis.tr_beschl_zu, axis.tr_beschl_ab) = (200_000, 200_000);
        }
    };
    near(rises(&one, WIDE), 1000.0, 200.0);
    near(rises(&one, "PATH_DIST=-1 ACC_MIN=100 RAMP_TIME=150"), 1000.0, 300.0);
    let two = |machine: &mut MachineData<3>| {
        (machine.axes[0].a_beschl, machine.axes[0].a_brems) = (4000, 4000);
        (machine.axes[0].tr_brems_ab, machine.axes[1].a_beschl, machine.axes[1].a_brems) =
            (200_000, 1000, 1000);
    };
    near(rises(&two, WIDE), 1000.0, 200.0);
    // No more than ACC_MAX, where the distance asks for more.
    let bound = |rest: &str| rises(&|_| {}, &format!("PATH_DIST=40 ACC_MIN=1 {rest}")).0;
    assert!(
        (bound("ACC_MAX=40") - 800.0).abs() < 20.0 && bound("ACC_MAX=90") > 900.0,
        "{} {}",
        bound("ACC_MAX=40"),
        bound("ACC_MAX=90")
    );
}

/// Largest acceleration of X in the corner, as a part of 2000 mm/s².
fn peaks_inside(run: &Run) -> f64 {
    let row = |i: usize| run.trace.mm(i);
    (1..run.trace.len() - 1)
        .filter(|&i| row(i)[1] > 0.0 && row(i)[0] < 80.0)
        .map(|i| (row(i + 1)[0] - 2.0 * row(i)[0] + row(i - 1)[0]).abs() * 1e6 / 2000.0)
        .fold(0.0, f64::max)
}

/// Largest jerk of X in the corner, mm/s³.
fn jerk_inside(run: &Run) -> f64 {
    let row = |i: usize| run.trace.mm(i);
    (2..run.trace.len() - 1)
        .filter(|&i| row(i - 1)[1] > 0.0 && row(i)[0] < 80.0)
        .map(|i| (row(i + 1)[0] - 3.0 * row(i)[0] + 3.0 * row(i - 1)[0] - row(i - 2)[0]).abs() * 1e9)
        .fold(0.0, f64::max)
}

/// Rows: D3-123.
#[test]
fn soft_beside_an_arc_keeps_the_distance_and_says_so() {
    let text = "#CONTOUR MODE ON [DIST_SOFT PATH_DIST=3]\nN10 G01 X40 F2000\nN20 G260 G02 X60 Y20 I20\nM30\n";
    let run = run_from(text, [Position::ZERO; 3], &quick(1000));
    assert_eq!(run.warnings, [(3, NcWarningKind::SoftArc)]);
    assert!((run.lengths(10)[0] - 37.0).abs() < 1e-4, "{:?}", run.lengths(10));
}

/// Rows: D3-128.
#[test]
fn distances_are_divided_by_the_neighbours_lengths() {
    // N20 is 20 mm between 60 mm and 30 mm: half of it for each corner, or two thirds and one.
    let soft = |weight: &str, rest: &str| {
        let text = format!(
            "#CONTOUR MODE ON [DIST_SOFT PATH_DIST=-1 ACC_MIN=1 ACC_MAX=5 {weight}]\nN10 G01 X60 F20000\nN20 Y20\n{rest}"
        );
        run_from(&text, [Position::ZERO; 3], &quick(1000))
    };
    let rest = "N30 G260 X90\nN40 Y90\nM30\n";
    let left = |run: &Run| [60.0 - run.lengths(10)[0], 30.0 - *run.lengths(30).last().unwrap()];
    for (weight, expected) in [
        ("", [10.0, 10.0]),
        ("DIST_WEIGHT=0", [10.0, 10.0]),
        ("DIST_WEIGHT=50", [10.0 + 5.0 / 3.0, 10.0 - 5.0 / 3.0]),
        ("DIST_WEIGHT=100", [40.0 / 3.0, 20.0 / 3.0]),
    ] {
        let run = soft(weight, rest);
        let seen = left(&run);
        assert!(seen.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-3), "{weight}: {seen:?}");
        let end = run.trace.mm(run.trace.len() - 1);
        assert_eq!(end, [90.0, 90.0, 0.0]);
    }
    // N20 is divided no other way if nothing follows, or its end is not rounded.
    for rest in ["M30\n", "G260\nN30 X90\nM30\n", "G04 X0.1\nN30 X90\nM30\n", "N30 G260 X60 Y50\nM30\n"] {
        let run = soft("DIST_WEIGHT=100", rest);
        let expected = if rest.contains("Y50") { 40.0 / 3.0 } else { 10.0 };
        assert!((60.0 - run.lengths(10)[0] - expected).abs() < 1e-3, "{rest}: {:?}", run.lengths(10));
    }
    // A reversal before the block that waits: nothing of the block before it is lost.
    for last in ["N40 G60 X20 Y30\nM30\n", "N40 G260 X20 Y30\nM30\n"] {
        let run = soft("DIST_WEIGHT=70", &format!("N30 X90\nN35 X50\n{last}"));
        let most = (0..run.trace.len()).map(|i| run.trace.mm(i)[0]).fold(0.0, f64::max);
        assert!((most - 90.0).abs() < 1e-3, "{most}");
        assert_eq!(run.trace.mm(run.trace.len() - 1), [20.0, 30.0, 0.0]);
    }
    // A weight that changes from corner to corner gives no block away twice.
    let changing = "#CONTOUR MODE [DIST_WEIGHT=0]\nN30 X90\n#CONTOUR MODE [DIST_WEIGHT=100]\nN40 Y90\nN50 X0\nN60 G260 Y0\nM30\n";
    let run = soft("DIST_WEIGHT=100", changing);
    assert_eq!(run.trace.mm(run.trace.len() - 1), [0.0; 3]);
}

/// N20 is 40 mm between a long block and a short one, whose half is all that the second corner could have.
///
/// Rows: D3-126.
#[test]
fn a_weight_makes_better_use_of_a_block_between_unequal_ones() {
    for (first, last) in [(200.0, 4.0), (100.0, 10.0)] {
        let used = |weight: u32| {
            let text = format!(
                "#CONTOUR MODE ON [DIST_SOFT PATH_DIST=-1 ACC_MIN=1 DIST_WEIGHT={weight}]\nN10 G01 X{first} F40000\nN20 Y40\nN30 G260 X{}\nM30\n",
                first + last
            );
            let run = run_from(&text, [Position::ZERO; 3], &quick(1000));
            first - run.lengths(10)[0] + last - run.lengths(30).last().unwrap()
        };
        let used = [0, 50, 100].map(used);
        assert!((used[0] - 20.0 - last / 2.0).abs() < 1e-3, "{used:?}");
        assert!(used[0] < used[1] && used[1] < used[2] && (used[2] - 40.0).abs() < 1e-3, "{used:?}");
    }
}

/// A turns 1° with each mm, there and back.
#[test]
fn track_dist_shortens_the_distance() {
    // Each feed needs a part of the acceleration between ACC_MIN and ACC_MAX.
    for (rest, expected, feed) in [
        ("PATH_DIST=12", 12.0, 12_000),
        ("PATH_DIST=12 TRACK_DIST=2", 2.0, 3000),
        ("PATH_DIST=12 TRACK_DIST=30", 12.0, 12_000),
        ("PATH_DIST=-1 TRACK_DIST=3", 3.0, 4000),
        ("PATH_DIST=3 TRACK_DIST=-1", 3.0, 4000),
    ] {
        let text =
            format!("#CONTOUR MODE ON [DIST_SOFT {rest}]\nN10 G01 X80 A80 F{feed}\nN20 G260 Y80 A0\nM30\n");
        let run = run_from::<4>(&text, [Position::ZERO; 4], &quick(1000));
        assert!((80.0 - run.lengths(10)[0] - expected).abs() < 1e-3, "{rest}: {:?}", run.lengths(10));
        let turned = (0..run.trace.len()).map(|i| run.trace.mm(i)[3]).fold(0.0, f64::max);
        assert!(turned >= 80.0 - expected && turned < 80.0, "{rest}: {turned}°");
    }
    // Without a tracking axis that turns there it says nothing.
    let text =
        "#CONTOUR MODE ON [DIST_SOFT PATH_DIST=12 TRACK_DIST=2]\nN10 G01 X80 F12000\nN20 G260 Y80\nM30\n";
    let run = run_from::<4>(text, [Position::ZERO; 4], &quick(1000));
    assert!((80.0 - run.lengths(10)[0] - 12.0).abs() < 1e-3, "{:?}", run.lengths(10));
}

/// Rows: D3-129.
#[test]
fn a_soft_corner_is_calmer_than_one_by_deviation() {
    // The programs of DIST_SOFT 12 mm against DEV 0.2 mm: 2.5 m/min.
    let text = |mode: &str| {
        format!(
            "N1 #CONTOUR MODE [{mode}]\nN2 G00 X0 Y0\nN3 G261\nN4 G01 X80 Y0 F2500\nN5 X80 Y80\nN6 G260\nM30\n"
        )
    };
    // As in the README: s, mm/s², mm/s³, mm.
    for (mode, expected) in [
        ("DIST_SOFT PATH_DIST=12", [3.905, 835.0, 17_000.0, 0.486]),
        ("DEV PATH_DEV=0.2", [3.915, 1213.5, 36_195.0, 0.2]),
        ("PTP PATH_DEV=0.2", [3.915, 1249.0, 38_396.0, 0.2]),
    ] {
        let run = run_from(&text(mode), [Position::ZERO; 3], &quick(1000));
        let [a, j] = [2000.0 * peaks_inside(&run), jerk_inside(&run)];
        let seen = [run.time(), a, j, run.distance([80.0, 0.0])];
        for (seen, expected) in seen.into_iter().zip(expected) {
            assert!((seen - expected).abs() < 2e-3 * expected, "{mode}: {seen} instead of {expected}");
        }
    }
}

#[test]
fn actions_of_curves_over_time_have_their_place() {
    // DIST_SOFT has no such keyword, and one given for another method is none of its own.
    for mode in ["PTP PATH_DEV=0.5", "DEV PATH_DEV=0.5", "DIST_SOFT PATH_DIST=5"] {
        for (action, x, y) in [
            ("PRE_ACTION", 90.0..99.5, 0.0..0.01),
            ("INTER_ACTION", 99.0..100.0, 0.01..1.0),
            ("POST_ACTION", 99.99..100.01, 0.5..10.0),
        ] {
            let soft = mode.starts_with("DIST_SOFT");
            let (own, before) = if soft { ("", action) } else { (action, "INTER_ACTION") };
            if soft && action == "INTER_ACTION" {
                continue;
            }
            let (x, y) = if soft { (99.0..100.0, 0.01..1.0) } else { (x, y) };
            let text = format!(
                "#CONTOUR MODE [DEV {before}]\n#CONTOUR MODE ON [{mode} {own}]\nN10 G01 X100 M25 F6000\nN20 G260 Y100\nM30\n"
            );
            let run = run_from(&text, [Position::ZERO; 3], &quick(1000));
            let [(row, event)] = run.events[..] else { panic!("{:?}", run.events) };
            assert_eq!(event.function, Function::M(25));
            let at = run.trace.mm(row);
            assert!(x.contains(&at[0]) && y.contains(&at[1]), "{mode} {action}: {at:?}");
        }
    }
}

#[test]
fn two_curves_that_fill_a_block_leave_nothing_between_them() {
    // Steps of 40 mm: each corner takes half of what is beside it, and what rounding leaves would be too
    // short to be fast.
    let steps: String =
        (1..=6).map(|i| format!("N{i}0 G01 X{} Y{}\n", 40 * (i + 1) / 2, 40 * (i / 2))).collect();
    for mode in ["DIST_SOFT PATH_DIST=-1", "DIST_SOFT PATH_DIST=20", "PTP PATH_DEV=20", "DEV PATH_DEV=20"] {
        let text = format!("F30000\n#CONTOUR MODE ON [{mode}]\n{steps}N70 G260 X200\nM30\n");
        let run = run_from(&text, [Position::ZERO; 3], &quick(1000));
        let [x, y] = [0, 1].map(|k| run.axis_speeds(k));
        // Between the first corner and the last.
        let inside = (0..x.len()).filter(|&i| {
            let at = run.trace.mm(i);
            at[0] > 41.0 && at[1] < 79.0
        });
        let slowest = inside.map(|i| x[i].hypot(y[i])).fold(f64::INFINITY, f64::min);
        assert!(slowest > 100.0, "{mode}: {slowest} mm/s");
    }
}

/// D3-119. ACC_MAX=0 is the gentlest, as 1 % is: the less acceleration, the longer it takes.
#[test]
fn acc_max_0_is_the_gentlest() {
    let time = |percent: u32| {
        let text = format!(
            "#CONTOUR MODE ON [DIST_SOFT PATH_DIST=20 ACC_MIN=0 ACC_MAX={percent}]\nN10 G01 X80 F20000\nN20 G260 Y80\nM30\n"
        );
        run_from(&text, [Position::ZERO; 3], &quick(1000)).time()
    };
    let [none, least, half, all] = [0, 1, 50, 100].map(time);
    assert_eq!(none, least);
    assert!(least > half && half > all, "{least} {half} {all}");
}

/// Lines of nanometres beside which a rotary axis turns up to 300 degrees per millimetre: where a curve ends is rounded
/// on the axes that the path is measured along, and the direction behind it must not follow from that.
#[test]
fn elements_over_time_go_as_far_as_the_directions_of_their_ends_say() {
    let machine = machines::machine::<4>(141, |_, axis| {
        (axis.vb_max, axis.vb_eilgang) = (50_000, 50_000);
        machines::accelerations(axis, 1, 1);
        machines::ramps(axis, 100);
        axis.tr_geom = 100;
    });
    let mut timed = 0;
    for seed in 0..40 {
        let mut r = Random::new(seed);
        let mut program = Program::new(format!("steep {seed}"), 4);
        let (mut at, steepest) = ([0.0; 4], r.magnitude(1.0, 300.0));
        for _ in 0..20 {
            let length = f64::from(1 + (r.bits() % 9) as u32) * 1e-6;
            at[(r.bits() % 2) as usize] += length;
            at[3] += (length * steepest * r.between(-1.0, 1.0) * 1e6).round() * 1e-6;
            program = program.line(&at, 1000.0);
        }
        let method = if seed % 2 == 0 { ContourMethod::Ptp } else { ContourMethod::Dev };
        let contour = Contour { method: Some(method), check_jerk: Some(0), ..dev(1000) };
        for piece in round(&blocks(&program, &machine), &machine, &contour) {
            timed += u32::from(is_timed(&piece));
            goes_as_far_as_it_says(&piece).unwrap_or_else(|fault| panic!("{seed}: {fault}"));
        }
    }
    assert!(timed > 400, "{timed}");
}

fn is_timed(piece: &Piece<4>) -> bool {
    piece.out.element.bounds.is_some_and(|bounds| bounds.is_timed())
}

/// Over time a direction changes to one side: its mean is between those of the ends, but for the rounding of
/// both ends.
fn goes_as_far_as_it_says(piece: &Piece<4>) -> Result<(), String> {
    let (from, to) = (piece.at(0.0), piece.at(1.0));
    let [entry, exit] = [piece.out.element.entry, piece.out.element.exit].map(|end| end.tangent);
    for k in 0..4 {
        let [a, b] = [entry[k], exit[k]].map(|t| t as f64 / 2f64.powi(40) * piece.length());
        let (way, rounding) = (to[k] - from[k], 3.0 / 2f64.powi(32));
        if way < a.min(b) - rounding || way > a.max(b) + rounding {
            let lsb = 2f64.powi(32);
            return Err(format!("axis {k}: {} LSB, {} to {} by its ends", way * lsb, a * lsb, b * lsb));
        }
    }
    Ok(())
}

/// With DIST_WEIGHT a corner takes all of a block whose other neighbour is a nanometre.
#[test]
fn a_block_that_a_corner_takes_whole_leaves_nothing() {
    for last in [1e-6, 1e-5, 1e-4] {
        let text = format!(
            "#CONTOUR MODE ON [DIST_SOFT PATH_DIST=-1 ACC_MIN=1 DIST_WEIGHT=100]\nN10 G01 X1000 F20000\nN20 Y1\nN30 X{:.6}\nN40 G260 Y2\nM30\n",
            1000.0 + last
        );
        let machine = quick::<3>(1000);
        let run = run_from(&text, [Position::ZERO; 3], &machine);
        let limits =
            machine.axes.iter().map(|axis| permitted(axis, 3, false, true, true)).collect::<Vec<_>>();
        check::limits(&run.trace, &limits).unwrap_or_else(|fault| panic!("{last}: {fault}"));
        let most = (0..run.trace.len()).map(|i| run.trace.mm(i)[1]).fold(0.0, f64::max);
        assert!(most <= 2.0, "{most}");
    }
}

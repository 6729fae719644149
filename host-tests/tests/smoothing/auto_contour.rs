//! P-CHAN-00239: the corners at which the HSC B-spline is off.
use glidepath::quantity::Position;
use host_tests::rounded::{Run, quick, run_from};
use host_tests::walk::judge;

fn go(text: &str, mode: u8) -> Run {
    let mut machine = quick::<3>(1000);
    machine.channel.auto_contour_mode = mode;
    run_from::<3>(text, [Position::ZERO; 3], &machine)
}

/// Distances of the path from corners, µm: line/line beyond MAX_ANGLE, line/arc, arc/arc, arc/line.
fn corners(on: &str, off: &str, mode: u8) -> [i64; 4] {
    let run = go(
        &format!(
            "N10 G01 X0 Y0 F3000\n{on}\nN20 X20\nN30 X40 Y20\nN40 G02 X60 Y20 R30\nN50 G02 X80 Y20 R30\nN60 G01 X100\n{off}\nM30\n"
        ),
        mode,
    );
    let last = run.trace.mm(run.trace.len() - 1);
    assert_eq!(last, [100.0, 20.0, 0.0]);
    [[20.0, 0.0], [40.0, 20.0], [60.0, 20.0], [80.0, 20.0]]
        .map(|corner| (run.distance(corner) * 1e3).round() as i64)
}

/// D3-008, D3-273, D3-274, CF-23: 0 keeps the corners, 1 rounds all of them, 2 those beside arcs, and these with
/// the curves of the DEV that the sources name.
#[test]
fn corners_where_the_b_spline_deselects_itself() {
    let spline = ["#HSC ON [BSPLINE PATH_DEV=0.1 MAX_ANGLE=30]", "#HSC OFF"];
    let corners_of = |mode: u8| corners(spline[0], spline[1], mode);
    assert_eq!(corners_of(0), [0; 4]);
    let dev = corners("#CONTOUR MODE ON [DEV PATH_DEV=0.1 RELEVANT_PATH=0.1]", "#CONTOUR MODE OFF", 0);
    assert!(dev[1..].iter().all(|off| (98..=103).contains(off)), "{dev:?}");
    let [kept, ref beside @ ..] = corners_of(2);
    // Set points need not be at the same places of the same curve.
    let same = |beside: &[i64]| beside.iter().zip(&dev[1..]).all(|(a, b)| (a - b).abs() <= 1);
    assert!(kept == 0 && same(beside), "{kept} {beside:?}, {dev:?}");
    let [rounded, ref beside @ ..] = corners_of(1);
    assert!((99..=100).contains(&rounded), "{rounded}");
    assert!(same(beside), "{beside:?}, {dev:?}");
}

/// D3-274: PATH_DEV and TRACK_DEV of #HSC are those of the corners, RELEVANT_PATH with them.
#[test]
fn corners_keep_the_tolerance_of_the_curve() {
    // Set points are beside the curve's nearest point by up to 5 %.
    for dev in [100_i64, 200] {
        let on = format!("#HSC ON [BSPLINE PATH_DEV={}]", dev as f64 * 1e-3);
        let [_, beside @ ..] = corners(&on, "#HSC OFF", 2);
        assert!(
            beside.iter().all(|off| (dev * 98 / 100..=dev * 105 / 100).contains(off)),
            "{dev}: {beside:?}"
        );
    }
    // A line as long as PATH_DEV between two arcs is left out: one corner instead of two.
    let text = |dev: f64, length: f64| {
        format!(
            "N10 G01 X0 Y0 F3000\n#HSC ON [BSPLINE PATH_DEV={dev}]\nN20 X20\nN30 G02 X40 R30\nN40 G01 X{0}\nN50 G02 X{1} R30\nN60 G01 X90\n#HSC OFF\nM30\n",
            40.0 + length,
            60.0 + length
        )
    };
    let elements =
        |length: f64| go(&text(0.1, length), 2).blocks.iter().filter(|block| block.n == 40).count();
    assert_eq!((elements(0.01), elements(5.0) > 0), (0, true));
    // TRACK_DEV: where PATH_DEV alone leaves more.
    let mut machine = quick::<4>(1000);
    machine.channel.auto_contour_mode = 2;
    let short_of = |track: f64| {
        let text = format!(
            "N10 G01 X0 Y0 F3000\n#HSC ON [BSPLINE PATH_DEV=0.5 TRACK_DEV={track}]\nN20 X20 A20\nN30 G02 X40 R30 A0\nN40 G01 X60\n#HSC OFF\nM30\n"
        );
        let run = run_from::<4>(&text, [Position::ZERO; 4], &machine);
        20.0 - (0..run.trace.len()).map(|row| run.trace.mm(row)[3]).fold(0.0, f64::max)
    };
    let [monitored, not_monitored] = [2.0, 0.0].map(short_of);
    assert!((0.5..2.0).contains(&monitored) && not_monitored > 2.5, "{monitored} and {not_monitored}");
}

/// The corner needs no standstill where an arc begins, and the motion is faster than with corners kept.
#[test]
fn rounded_corners_are_passed_without_a_standstill() {
    let text = "N10 G01 X0 Y0 F3000\n#HSC ON [BSPLINE PATH_DEV=0.1]\nN20 X20\nN30 X40 Y5\nN40 G02 X60 R30\nN50 G01 X80 Y10\nN60 X100\n#HSC OFF\nM30\n";
    let [kept, rounded] = [0, 2].map(|mode| go(text, mode));
    let least = |run: &Run| {
        let speeds = run.speeds();
        let inner = speeds.len() / 10..speeds.len() * 9 / 10;
        speeds[inner].iter().copied().fold(f64::INFINITY, f64::min)
    };
    assert!(least(&kept) < 0.5 && least(&rounded) > 3.0, "{} and {}", least(&kept), least(&rounded));
    assert!(rounded.time() < 0.97 * kept.time(), "{} and {}", rounded.time(), kept.time());
}

/// What stands beside an arc: exact stops, functions, a dwell, the end of the program.
#[test]
fn what_stands_beside_an_arc() {
    let distance = |line: &str| {
        let run = go(
            &format!(
                "N10 G01 X0 Y0 F3000\n#HSC ON [BSPLINE PATH_DEV=0.1 AUTO_OFF_G60=1]\nN20 X10\nN30 {line}\nN40 G02 X40 R30\nN50 G01 X60\nM30\n"
            ),
            1,
        );
        (run.distance([20.0, 0.0]), run.trace.mm(run.trace.len() - 1), run.events.len())
    };
    let end = vec![60.0, 0.0, 0.0];
    assert_eq!(distance("G60 X20"), (0.0, end.clone(), 0));
    assert_eq!(distance("X20\nG04 0.05"), (0.0, end.clone(), 0));
    let (off, last, events) = distance("X20\nM3");
    assert!((0.098..=0.105).contains(&off) && last == end && events == 1, "{off} {last:?} {events}");
    // It begins with an arc, and ends with one.
    let run = go(
        "N10 G01 X0 Y0 F3000\n#HSC ON [BSPLINE PATH_DEV=0.1]\nN20 G02 X20 R30\nN30 G02 X40 R30\n#HSC OFF\nN40 G01 X60\nM30\n",
        2,
    );
    assert!((0.098..=0.105).contains(&run.distance([20.0, 0.0])));
    let off = run.distance([40.0, 0.0]);
    assert!(off < 1e-5, "HSC is off: {off}");
}

/// On and off for each seed: AUTO_OFF_PATH, the longest line and the largest angle vary.
fn smoothed(seed: u64, [dev, track]: [f64; 2]) -> [String; 2] {
    let words =
        ["", " AUTO_OFF_PATH=1", " MAX_PATH_LENGTH=1", " MAX_ANGLE=30", " MERGE=1"][seed as usize % 5];
    let on = format!("#HSC ON [BSPLINE PATH_DEV={dev} TRACK_DEV={track} AUTO_OFF_G60=1{words}]");
    [on, "#HSC OFF".to_owned()]
}

/// D3-274: tolerance, limits and exact ends of random paths of lines and arcs.
#[test]
fn random_paths_keep_tolerance_limits_and_ends() {
    let number = |name: &str| std::env::var(name).ok().and_then(|value| value.parse().ok());
    let first = number("GLIDEPATH_FROM").unwrap_or(0);
    let mut faults = 0;
    for seed in first..first + number("GLIDEPATH_SEEDS").unwrap_or(80) {
        let slope = [3, 3, 1, 2, 0][seed as usize % 5];
        let ramp = [50_000, 150_000][seed as usize / 5 % 2];
        let mode = [1, 2][seed as usize / 2 % 2];
        let judged = if seed % 3 == 0 {
            judge::<4>(seed, 40, (ramp, slope), smoothed, |machine| machine.channel.auto_contour_mode = mode)
        } else {
            judge::<3>(seed, 40, (ramp, slope), smoothed, |machine| machine.channel.auto_contour_mode = mode)
        };
        if let Err(fault) = judged {
            println!(
                "seed {seed}: mode {mode}, slope {slope}, ramps {ramp} µs: {}",
                fault.lines().next().unwrap_or("")
            );
            faults += 1;
        }
    }
    assert_eq!(faults, 0);
}

//! Oscillation: FCT-A8, row by row.
use glidepath::channel::{Channel, Handles};
use glidepath::machine::{FilterData, FilterType, MachineData};
use glidepath::quantity::Position;
use glidepath::tick::State;
use host_tests::beside::{ONE, Run, run};
use host_tests::calls::call;
use host_tests::cases::machines::{accelerations, even, machine, ramps};
use host_tests::operate::Act;

/// Slope 0 STEP, 1 TRAPEZ, 2 SIN2, 3 HSC.
fn with_slope(slope: u8) -> MachineData<3> {
    let mut machine = even::<3>(1000);
    machine.channel.slope_profile = slope;
    for axis in &mut machine.axes {
        axis.a_stufe = [2000; 2];
    }
    machine
}

fn good<const AXES: usize>(text: &str, machine: &MachineData<AXES>) -> Run {
    let run = run(text, machine, &[], 40).unwrap_or_else(|error| panic!("{text}: {error}"));
    if let Err(error) = run.keeps_limits(machine, machine.channel.slope_profile, false) {
        panic!("{text}: {error}");
    }
    let ends: Vec<i64> = run.axes.iter().map(|x| *x.last().expect("a tick")).collect();
    assert_eq!(ends, run.position, "{text}: the planner knows where the axes stand");
    run
}

/// Ticks from one arrival at `position` to the next.
fn periods(run: &Run, axis: usize, position: i64) -> Vec<usize> {
    run.arrivals(axis, position * ONE).windows(2).map(|pair| pair[1] - pair[0]).collect()
}

/// A machine of the published examples: acceleration 1000, linear slope, a cycle of 2 ms.
fn grinder(v_um_s: u32) -> MachineData<3> {
    let mut grinder = machine::<3>(2000, |_, axis| {
        (axis.vb_max, axis.vb_eilgang) = (v_um_s, v_um_s);
        accelerations(axis, 1000, 1000);
        ramps(axis, 10_000);
        axis.a_stufe = [1000; 2];
    });
    grinder.channel.slope_profile = 0;
    grinder
}

const SUB: &str = "%L sub_mv\nN1000 G01 G90 Y100 F500\nN2000 Y-100\nM29\n%osc_7\n";

/// A8-054, A8-055, A8-056: EX10.
#[test]
fn limited_by_acceleration() {
    let text =
        format!("{SUB}N10 X[OSC ON 1ST_POS=-120 2ND_POS=120 FREQ=0.6]\nN20 LL sub_mv\nN30 X[OSC OFF]\nM30\n");
    let run = good(&text, &grinder(5_000_000));
    let periods = periods(&run, 0, 120);
    assert!(periods.len() > 10, "A8-056");
    assert!(periods.iter().all(|period| *period == 982), "A8-056: 1.964 s in {periods:?} ticks of 2 ms");
    assert_eq!(run.warnings.iter().map(|w| w.id()).collect::<Vec<_>>(), [900_001], "A8-055");
    let peak = run.axes[0].windows(2).map(|pair| pair[1] - pair[0]).max().expect("a tick") as f64;
    let peak = peak / ONE as f64 / 0.002;
    assert!((488.0..490.5).contains(&peak), "A8-056: {peak} mm/s");
}

/// A8-055, A8-057: EX11.
#[test]
fn limited_by_speed() {
    let text =
        format!("{SUB}N10 X[OSC ON 1ST_POS=-520 2ND_POS=520 FREQ=0.2]\nN20 LL sub_mv\nN30 X[OSC OFF]\nM30\n");
    let run = good(&text, &grinder(500_000));
    let periods = periods(&run, 0, 520);
    assert!(periods.len() > 5, "A8-057");
    assert!(periods.iter().all(|period| *period == 2582), "A8-057: 5.164 s in {periods:?} ticks of 2 ms");
    assert_eq!(run.warnings.len(), 1, "A8-055: once");
}

/// Farthest positions of an axis, mm.
fn range(run: &Run, axis: usize) -> [f64; 2] {
    let x = &run.axes[axis];
    [x.iter().min(), x.iter().max()].map(|x| *x.expect("a tick") as f64 / ONE as f64)
}

/// NC-010. EX01 to EX09, with every slope: A8-045, A8-046, A8-047, A8-048, A8-049, A8-050, A8-051, A8-052, A8-053. All
/// end on position 2: A8-018. What they show beside that: A8-001, A8-002, A8-003, A8-004, A8-005, A8-007, A8-019,
/// A8-020, A8-028, A8-029, A8-030, A8-031, A8-039, A8-040.
#[test]
fn every_example_oscillates() {
    let feeding = "G01 G90 Y90 F600\n";
    let off = "X[OSC OFF]\n";
    let expected = [
        ("EX01", "X[OSC ON 1ST_POS=-80 2ND_POS=90 FEED=1200]\n", feeding, off, [-80.0, 90.0], 0),
        ("EX02", "X[OSC ON ZERO_POS=10 EXCUR=70 FEED=1200]\n", feeding, off, [-60.0, 80.0], 0),
        ("EX03", "X[OSC ON ZERO_POS=0 EXCUR=60 FREQ=1.25 NBR_OSC=7]\n", feeding, off, [-60.0, 60.0], 7),
        ("EX04", "X[OSC ON ZERO_POS=0 EXCUR=60 TIME=0.9]\n", feeding, off, [-60.0, 60.0], 0),
        ("EX05", "X[OSC ON 1ST_POS=60 2ND_POS=140 FREQ=1.1]\n", "G01 G90 Y400 F250\n", off, [0.0, 140.0], 0),
        (
            "EX06",
            "X[OSC ON 1ST_POS=-70 1ST_DELT=0.4 2ND_POS=120 2ND_DELT=0.3 FEED=1500]\n",
            feeding,
            off,
            [-70.0, 120.0],
            0,
        ),
        ("EX07 modulo", "X[OSC ON 1ST_POS=15 2ND_POS=345 FEED=900 SHORT]\n", feeding, off, [-15.0, 15.0], 0),
        ("EX08", "X[OSC ON 1ST_POS=-80 2ND_POS=80 FEED=1000]\n", feeding, off, [-80.0, 80.0], 0),
        (
            "EX09",
            "X[OSC ON 1ST_POS=-80 2ND_POS=80 FEED=1000]\n",
            feeding,
            "X[OSC OFF FEED=4000]\n",
            [-80.0, 80.0],
            0,
        ),
    ];
    for (name, on, path, off, reach, count) in expected {
        let text = format!("{on}{path}{off}M30\n");
        for slope in 0..4 {
            let mut machine = with_slope(slope);
            for axis in &mut machine.axes {
                (axis.vb_max, axis.vb_eilgang) = (1_000_000, 1_000_000);
                accelerations(axis, 8000, 8000);
                axis.a_stufe = [8000; 2];
            }
            if name.contains("modulo") {
                machine.axes[0].kind = glidepath::machine::AxisKind::Rotary;
            }
            let run = good(&text, &machine);
            assert_eq!(range(&run, 0), reach, "{name}, slope {slope}");
            let second = if name.contains("modulo") { reach[0] } else { reach[1] };
            assert_eq!(run.ends()[0], second, "A8-018: {name}, slope {slope}");
            let times = run.arrivals(0, (second * ONE as f64) as i64).len();
            assert!(count == 0 && times > 0 || times == count, "{name}: {times} times on position 2");
            assert_eq!(run.warnings, [], "{name}");
            if name.contains("EX05") {
                // A8-049: its path, bit for bit, with a stop where the oscillation was commanded.
                let alone = |line: &str| {
                    let stop = line.contains("[OSC ON");
                    if stop { "#FLUSH&WAIT".to_owned() } else { line.to_owned() }
                };
                let lines = text.lines().filter(|line| !line.contains("[OSC OFF")).map(alone);
                let without = good(&(lines.collect::<Vec<_>>().join("\n") + "\n"), &machine);
                let moves = |run: &Run| {
                    let mut rows = run.axes[1].clone();
                    rows.dedup();
                    rows
                };
                assert_eq!(moves(&run), moves(&without), "A8-049, slope {slope}");
                assert!(moves(&run).len() > 1000, "A8-049: it moves");
            }
        }
    }
}

/// A8-041, A8-026, A8-027, A8-003, A8-010, A8-059: FREQ and TIME are kept to a tick over 1000 periods, with
/// every slope; A8-034: so often.
#[test]
fn a_period_does_not_drift() {
    for (slope, pace, period) in [
        (0, "FREQ=3", 1000.0 / 3.0),
        (1, "TIME=0.3337", 333.7),
        (2, "FREQ=2.7", 1000.0 / 2.7),
        (3, "TIME=0.4", 400.0),
    ] {
        let text = format!("X[OSC ON 1ST_POS=-2 2ND_POS=1.5 {pace} NBR_OSC=1001]\nG04 420\nM30\n");
        let run = good(&text, &with_slope(slope));
        assert_eq!(run.warnings, []);
        for (position, times) in [(-2 * ONE, 1001), (ONE * 3 / 2, 1001)] {
            let arrivals = run.arrivals(0, position);
            assert_eq!(arrivals.len(), times, "A8-034: slope {slope}");
            // The first one ends the positioning, or begins at it.
            let first = arrivals[1] as f64 - period;
            for (k, tick) in arrivals.iter().enumerate().skip(1) {
                let exact = first + k as f64 * period;
                assert!(
                    (*tick as f64 - exact).abs() <= 1.0,
                    "A8-041: slope {slope}, period {k}: {tick}, {exact}"
                );
            }
        }
    }
}

/// A8-004, A8-032, A8-033, A8-011: waits are part of the period; with FEED they come beside it. A8-025: the feed.
#[test]
fn waits_at_the_reversals() {
    let text = |pace: &str| {
        format!("X[OSC ON 1ST_POS=-5 2ND_POS=5 {pace} 1ST_DELT=0.2 2ND_DELT=0.1 NBR_OSC=5]\nG04 9\nM30\n")
    };
    for slope in 0..4 {
        for (pace, period) in [("TIME=1.5", Some(1500)), ("FEED=3000", None)] {
            let run = good(&text(pace), &with_slope(slope));
            let x = &run.axes[0];
            for (row, position, wait) in [("A8-032", -5 * ONE, 200), ("A8-033", 5 * ONE, 100)] {
                let arrivals = run.arrivals(0, position);
                assert_eq!(arrivals.len(), 5);
                let last = usize::from(position > 0);
                for at in &arrivals[..5 - last] {
                    let rest = x[*at..].iter().take_while(|x| **x == position).count();
                    assert!((wait..=wait + 4).contains(&rest), "{row}: slope {slope}, {pace}: {rest} ticks");
                }
                if let Some(period) = period {
                    assert!(arrivals.windows(2).skip(1).all(|pair| pair[1] - pair[0] == period), "A8-011");
                }
            }
            if period.is_none() {
                let v = x.windows(2).map(|pair| pair[1] - pair[0]).max().expect("a tick");
                assert!((v as f64 / ONE as f64 / 0.05 - 1.0).abs() < 1e-3, "A8-025: slope {slope}");
            }
        }
    }
}

/// A8-033: behind the last counted stroke there is no wait.
#[test]
fn behind_the_last_stroke_there_is_no_wait_a8_033() {
    for slope in 0..4 {
        let text =
            "X[OSC ON 1ST_POS=-5 2ND_POS=5 TIME=2 2ND_DELT=0.5 NBR_OSC=2]\nG04 2.8\nG01 X6 Y1 F3000\nM30\n";
        let run = good(text, &with_slope(slope));
        let arrivals = run.arrivals(0, 5 * ONE);
        let last = *arrivals.last().expect("it comes there");
        let rest = run.axes[0][last..].iter().take_while(|x| **x == 5 * ONE).count();
        assert!(arrivals.len() == 2 && rest < 60, "slope {slope}: {arrivals:?}, {rest} ticks");
    }
}

/// A8-055: a FEED that the axis cannot have is limited and told, and one that it can have is not.
#[test]
fn a_feed_that_is_too_fast_is_told_a8_055() {
    for slope in 0..4 {
        let machine = with_slope(slope);
        let most = f64::from(machine.axes[0].vb_max) * 60e-3;
        for (feed, told) in [(1.5 * most, true), (0.2 * most, false)] {
            let text = format!("X[OSC ON 1ST_POS=-900 2ND_POS=900 FEED={feed:.0} NBR_OSC=2]\nG04 20\nM30\n");
            let run = good(&text, &machine);
            let ids: Vec<_> = run.warnings.iter().map(|warning| warning.id()).collect();
            assert_eq!(!ids.is_empty(), told, "slope {slope}, FEED={feed}: {ids:?}");
        }
    }
}

/// A8-013, A8-021: the path stops for the start, and goes on while the axis oscillates; A8-007, A8-049: its
/// set points are what they are without the oscillation.
#[test]
fn the_path_is_what_it_is_without() {
    let rest = "G01 G90 Y50 F2000\nY20 Z5\nY0 Z0\n";
    let with = format!("G01 Y10 F2000\nX[OSC ON 1ST_POS=1 2ND_POS=9 FREQ=1.3]\n{rest}X[OSC OFF]\nM30\n");
    let without = format!("G01 Y10 F2000\n#FLUSH&WAIT\n{rest}M30\n");
    let machine = with_slope(1);
    let moves = |run: &Run| {
        let rows = run.axes[1].iter().zip(&run.axes[2]).map(|(y, z)| (*y, *z));
        let mut rows: Vec<_> = rows.collect();
        rows.dedup();
        rows
    };
    let (with, without) = (good(&with, &machine), good(&without, &machine));
    assert_eq!(moves(&with), moves(&without), "A8-049");
    let begins = with.axes[0].iter().position(|x| *x != 0).expect("it oscillates");
    assert_eq!(with.axes[1][begins - 1], 10 * ONE, "A8-013: the block is over");
    assert!(with.arrivals(0, 9 * ONE).len() > 2, "A8-007: while the path moves");
}

/// A8-018: it ends on position 2. A8-022, A8-052: OFF ends with the cycle; A8-023, A8-053: OFF FEED at once; A8-024: OFF INSTANT where it is;
/// A8-042: a counted one too; A8-014, A8-015, A8-017, A8-016: implicit ends; A8-008, A8-009.
#[test]
fn it_ends_as_told() {
    let on = "X[OSC ON 1ST_POS=-20 2ND_POS=20 TIME=2 NBR_OSC=50]\nG04 1.9\n";
    for slope in 0..4 {
        let machine = with_slope(slope);
        let run = |rest: &str| good(&format!("{on}{rest}M30\n"), &machine);
        let last = |run: &Run| run.arrivals(0, 20 * ONE).len();
        let off = run("X[OSC OFF]\n");
        assert_eq!(off.ends()[0], 20.0, "A8-022");
        let cycles = last(&off);
        // At 1.9 s on the way back from it, at 1.2 s still towards it.
        assert_eq!(cycles, 2, "A8-022, A8-042");
        let early = good(&format!("{}X[OSC OFF]\nM30\n", on.replace("1.9", "1.2")), &machine);
        assert_eq!((early.ends()[0], last(&early)), (20.0, 1), "A8-022: the cycle at hand");
        let fast = run("X[OSC OFF FEED=9000]\n");
        assert_eq!((fast.ends()[0], range(&fast, 0)), (20.0, [-20.0, 20.0]), "A8-023");
        assert!(fast.axes[0].len() < off.axes[0].len(), "A8-023: sooner");
        let instant = run("X[OSC OFF INSTANT]\nG91 G01 X1 F3000\n");
        let end = instant.ends()[0];
        assert!(instant.axes[0].len() < off.axes[0].len() && end.abs() < 20.0, "A8-024: {end}");
        let onward = run("G90 G01 X30 F3000\n");
        assert_eq!((onward.ends()[0], last(&onward)), (30.0, cycles), "A8-014");
        let again = run("X[OSC ON 1ST_POS=25 2ND_POS=31 FREQ=2]\nG04 2\n");
        assert_eq!((again.ends()[0], last(&again)), (31.0, cycles), "A8-015");
        let flush = run("#FLUSH&WAIT\nG01 Y1 F1000\n");
        assert_eq!((flush.ends()[0], last(&flush)), (20.0, cycles), "A8-016");
        let begins = flush.axes[1].iter().position(|y| *y != 0).expect("Y moves");
        assert_eq!(flush.axes[0][begins], 20 * ONE, "A8-016");
        let end = run("");
        assert_eq!((end.ends()[0], last(&end)), (20.0, cycles), "A8-017");
    }
}

/// A8-039: FEED is the speed between the ramps. A8-023: OFF FEED goes to the second position at its own speed, at
/// once, and not at that of the oscillation.
#[test]
fn speeds_are_those_told() {
    let on = "X[OSC ON 1ST_POS=-20 2ND_POS=20 FEED=600 NBR_OSC=50]\nG04 7\n";
    for slope in 0..4 {
        let machine = with_slope(slope);
        let fastest = |x: &[i64]| x.windows(2).map(|pair| (pair[1] - pair[0]).abs()).max().unwrap_or(0);
        let mm_s = |per_tick: i64| per_tick as f64 / ONE as f64 * 1000.0;
        let off = good(&format!("{on}X[OSC OFF]\nM30\n"), &machine);
        let swings = mm_s(fastest(&off.axes[0]));
        assert!((swings / 10.0 - 1.0).abs() < 1e-5, "A8-039, slope {slope}: {swings}");
        let fast = good(&format!("{on}X[OSC OFF FEED=4500]\nM30\n"), &machine);
        let leaves = mm_s(fastest(&fast.axes[0]));
        assert!((leaves / 75.0 - 1.0).abs() < 1e-5, "A8-023, slope {slope}: {leaves}");
        assert_eq!(fast.ends()[0], 20.0);
        assert!(off.axes[0].len() > fast.axes[0].len() + 1000, "A8-023, slope {slope}: at once");
    }
    // The override is the path's: an oscillation has the speed or time that it was told.
    let text = "X[OSC ON 1ST_POS=-20 2ND_POS=20 FEED=6000 NBR_OSC=4]\nG04 8\nM30\n";
    let [plain, slow] = [vec![], vec![(0, Act::Override(500))]].map(|acts| {
        let run = run(text, &with_slope(1), &acts, 40).expect("it runs");
        periods(&run, 0, 20)
    });
    assert!(plain.len() == 3 && plain == slow, "A8-007: {plain:?} {slow:?}");
}

/// A8-016: everything with which a program of this version asks where an axis is, or takes it out of the path
/// and back; what goes on reading without that lets it swing.
#[test]
fn a_position_request_ends_it() {
    let mut machine = with_slope(1);
    machine.axes[0].filter = FilterData { kind: FilterType::Gauss, order: 10, ..FilterData::NONE };
    let ended = |between: &str| {
        let text = format!(
            "X[OSC ON 1ST_POS=-20 2ND_POS=20 TIME=2 NBR_OSC=50]\nG04 1.9\n{between}\nG01 Y1 F1000\nG04 3\nM30\n"
        );
        let run = good(&text, &machine);
        assert_eq!(run.ends(), [20.0, 1.0, 0.0], "{between}");
        let begins = run.axes[1].iter().position(|y| *y != 0).expect("Y moves");
        // What is seen is filtered: it comes to rest a few ticks later.
        let rests = run.axes[0][begins + 20..].iter().all(|x| *x == 20 * ONE);
        assert!(!rests || run.arrivals(0, 20 * ONE).len() == 2, "{between}: at the end of its cycle");
        rests
    };
    for request in ["#FLUSH&WAIT", "#PUT AX [X]", "#CALL AX [X,1,0]", "#FILTER ON", "#FILTER [ORDER=8]"] {
        assert!(ended(request), "A8-016: {request}");
    }
    for other in ["#PUT AX [Z]", "G54", "G92 Y0", "P1=3", "M7", "G04 0.1"] {
        assert!(!ended(other), "A8-016: {other}");
    }
    // Variables that would ask for a position are refused: no value is made up.
    for variable in ["V.A.ABS.X", "V.A.ACT_POS.X", "V.G.N"] {
        let text = format!("X[OSC ON 1ST_POS=-20 2ND_POS=20 TIME=2]\nP1 = {variable}\nM30\n");
        let error = run(&text, &machine, &[], 40).expect_err(variable);
        assert!(error.contains("not available") || error.contains("no variable"), "{variable}: {error}");
    }
}

/// A8-005: the linear slope has one acceleration, at once; the others have ramps; before the
/// first stroke the axis goes to the first position.
#[test]
fn shapes_of_the_figures() {
    for slope in 0..4u8 {
        let machine = with_slope(slope);
        let run = good("X[OSC ON 1ST_POS=20 2ND_POS=60 FEED=6000 NBR_OSC=3]\nG04 4\nM30\n", &machine);
        let x = &run.axes[0];
        let first = x.iter().position(|x| *x == 20 * ONE).expect("the first position");
        assert!(x[..first].windows(2).all(|pair| pair[0] <= pair[1]), "slope {slope}: it goes there");
        assert_eq!(range(&run, 0), [0.0, 60.0], "slope {slope}");
        let v: Vec<i64> = x.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let a: Vec<i64> = v.windows(2).map(|pair| pair[1] - pair[0]).collect();
        // 2000 mm/s² per cycle².
        let most = 2000.0 * 1e-6 * ONE as f64;
        let is = |a: i64, of: f64| (a.abs() as f64 / most - of).abs() < 1e-3;
        let whole = a.iter().filter(|a| is(**a, 1.0)).count();
        let none = a.iter().filter(|a| is(**a, 0.0)).count();
        if slope == 0 {
            // But for the ticks in which a phase begins or ends.
            assert!((a.len() - whole - none) < 7 * 4 * 2, "{} {whole} {none}", a.len());
            assert!(whole > 7 * 2 * 40, "{whole}");
        } else {
            assert!(a.len() - whole - none > 7 * 4 * 10, "slope {slope}: {} {whole} {none}", a.len());
        }
    }
}

/// A8-044, CF-34: an oscillation under a transformation needs one. A machine without data sets refuses it before the
/// axis moves.
#[test]
fn no_oscillation_under_a_transformation() {
    for trafo in ["#TRAFO ON", "#TRAFO[9]"] {
        let text = format!("{trafo}\nX[OSC ON 1ST_POS=20 2ND_POS=60 FEED=6000]\nM30\n");
        let error = run(&text, &with_slope(1), &[], 40).expect_err(trafo);
        assert!(error.contains("expected trafo[]") && error.contains("#TRAFO"), "{error}");
    }
}

/// P-AXIS-00177 and 00178 hold for both reversals; A8-035: with offsets; A8-036: over the turn; A8-006, A8-037,
/// A8-038: any axis, both ways.
#[test]
fn positions_of_the_reversals() {
    let mut machine = with_slope(1);
    machine.axes[2].swe_pos = 30 * 10_000;
    let refused = |text: &str| run(text, &machine, &[], 40).expect_err(text);
    assert!(refused("Z[OSC ON 1ST_POS=0 2ND_POS=31 FREQ=1]\nM30\n").contains("P-AXIS-00178"));
    // A stroke of months: the message speaks of what the command has.
    let slow = refused("X[OSC ON 1ST_POS=0 2ND_POS=5 FREQ=0.000001]\nG04 1\nM30\n");
    assert!(slow.contains("raise FEED or FREQ"), "{slow}");
    let run = good(
        "G92 Y7\nY[OSC ON 1ST_POS=1 2ND_POS=2 FREQ=2 \\\n INCL_OFFSETS NBR_OSC=3]\nG04 2\nM30\n",
        &machine,
    );
    assert_eq!((range(&run, 1), run.ends()[1]), ([0.0, 9.0], 9.0), "A8-035, A8-006");
    machine.axes[0].kind = glidepath::machine::AxisKind::Rotary;
    let run = good("X[OSC ON 1ST_POS=350 2ND_POS=20 FREQ=1 SHORT NBR_OSC=2]\nG04 3\nM30\n", &machine);
    assert_eq!((range(&run, 0), run.ends()[0]), ([-10.0, 20.0], 20.0), "A8-036");
}

/// A8-012, A8-054, A8-060, A8-061: accelerations and ramps are those of the feed, of the slope of P-CHAN-00071, and
/// #SLOPE does not change them.
#[test]
fn dynamics_of_the_strokes() {
    for slope in 0..4u8 {
        let mut machine = with_slope(slope);
        machine.axes[0].a_stufe = [500, 900];
        machine.axes[0].vb_stufe_1_2 = 20_000;
        accelerations(&mut machine.axes[0], 1500, 2000);
        machine.axes[0].a_grenz = 2000;
        let text = "#SLOPE [TYPE=TRAPEZ]\nX[OSC ON 1ST_POS=-20 2ND_POS=20 FREQ=10 NBR_OSC=4]\nG04 2\nM30\n";
        let run = good(text, &machine);
        assert_eq!(run.warnings.len(), 1, "A8-054");
        let v: Vec<i64> = run.axes[0].windows(2).map(|pair| pair[1] - pair[0]).collect();
        let a = v.windows(2).map(|pair| (pair[1] - pair[0]).abs()).max().expect("a tick") as f64 / ONE as f64
            * 1e6;
        let most = if slope == 0 { 900.0 } else { 1500.0 };
        assert!((0.97 * most..=most * 1.0001).contains(&a), "A8-012: slope {slope}: {a}");
    }
}

/// A planner without time, a hold and an abort in the middle: the axis stays inside its limits, and a hold
/// goes on.
#[test]
fn holds_aborts_and_stalls() {
    for slope in 0..4 {
        let machine = with_slope(slope);
        let text = "X[OSC ON 1ST_POS=-20 2ND_POS=20 TIME=2 NBR_OSC=3]\nG01 Y90 F600\nM30\n";
        for at in (0..4000).step_by(173) {
            for (acts, end) in [
                (vec![(at, Act::Hold), (at + 900, Act::Resume)], true),
                (vec![(at, Act::Stall(1500))], true),
                (vec![(at, Act::Abort)], false),
                (
                    vec![
                        (at, Act::Hold),
                        (at + 3, Act::Resume),
                        (at + 50, Act::Hold),
                        (at + 800, Act::Abort),
                    ],
                    false,
                ),
                (vec![(at, Act::Override(500)), (at + 700, Act::Override(1000))], true),
            ] {
                let run = run(text, &machine, &acts, 40).unwrap_or_else(|e| panic!("{slope} {acts:?}: {e}"));
                run.keeps_limits(&machine, slope, false).unwrap_or_else(|e| panic!("{slope} {acts:?}: {e}"));
                let ends: Vec<i64> = run.axes.iter().map(|x| *x.last().expect("a tick")).collect();
                assert_eq!(ends, run.position, "{slope} {acts:?}");
                if end {
                    assert_eq!(run.ends(), [20.0, 90.0, 0.0], "{slope} {acts:?}");
                    assert_eq!(run.arrivals(0, 20 * ONE).len(), 3, "{slope} {acts:?}");
                }
            }
        }
    }
}

/// Runs a text until all is over, with an abort before the tick `abort`; the planner has 2,000 calls between two
/// ticks, and never needs all of them. The number of the motion block at each tick.
fn blocks_of(text: &str, abort: usize) -> Vec<u32> {
    let machine = with_slope(3);
    let mut channel: Box<Channel<3, 120, 1>> = Box::new(Channel::new());
    let handles = channel.split(&machine, [Position::ZERO; 3], text.as_bytes());
    let Handles { mut planner, mut interpolator, operator } = handles.expect("in range");
    let mut blocks = Vec::new();
    for tick in 0..10_000 {
        if tick == abort {
            operator.abort();
        }
        let mut working = 0;
        let done = call(&mut planner, 2000, |_| working += 1).expect("a program");
        assert!(working < 2000, "abort at {abort}, tick {tick}: the planner has always something to do");
        let state = interpolator.tick();
        blocks.push(interpolator.telemetry().block);
        if done && state == State::Idle {
            return blocks;
        }
    }
    panic!("abort at {abort}: no end");
}

/// An abort that finds the axis at a standstill before the path has one: there is nothing to do for it.
#[test]
fn an_abort_leaves_the_planner_nothing_to_do() {
    let text = "G01 Y1 F1000\nX[OSC ON ZERO_POS=0 EXCUR=2 FEED=3000]\nY20 F1500\nM30\n";
    for abort in (100..1000).step_by(25) {
        blocks_of(text, abort);
    }
}

/// No motion block has begun while an axis moves beside a path that has none.
#[test]
fn no_block_is_at_hand_before_the_first_one() {
    let text = "X[OSC ON 1ST_POS=0 2ND_POS=5 FREQ=1]\nG04 1\nX[OSC OFF]\nG01 Y5 F1000\nM30\n";
    assert!(blocks_of(text, usize::MAX).iter().all(|block| *block == 0));
}

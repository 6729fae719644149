//! P-CHAN-00011: the path is measured along the feed axes.
use glidepath::channel::{Channel, Error, MachineError};
use glidepath::machine::{AxisKind, MODE_LINEAR, MODE_MASTER, MachineData};
use glidepath::path::PathError;
use glidepath::plan::MotionError;
use glidepath::quantity::Position;
use host_tests::cases::machines::{self, feeding};
use host_tests::cases::random::{Mix, program};
use host_tests::operate::{Act, POLLS, judge, operate, operate_text, random_setup, with_overrides};
use host_tests::properties::verify;
use host_tests::refusal::refusal;
use host_tests::rounded::{Run, run_from};
use host_tests::trace::Trace;

fn go(text: &str, machine: &MachineData<3>) -> Run {
    run_from(text, [Position::ZERO; 3], machine)
}

#[test]
fn machine_data_that_make_no_sense_are_refused() {
    let refused = |change: fn(&mut MachineData<3>)| {
        let mut machine = machines::even::<3>(1000);
        change(&mut machine);
        let mut channel: Box<Channel<3, 120>> = Box::new(Channel::new());
        let text: &[u8] = b"M30\n";
        channel.split(&machine, [Position::ZERO; 3], text).err()
    };
    assert_eq!(refused(|_| {}), None);
    assert_eq!(refused(|machine| machine.axes[1].achs_mode = MODE_MASTER), None);
    // A modulo axis is known to ISG, not here.
    for mode in [0, 4, MODE_LINEAR | 0x200, u32::MAX] {
        let mut machine = machines::even::<3>(1000);
        machine.axes[1].achs_mode = mode;
        let mut channel: Box<Channel<3, 120>> = Box::new(Channel::new());
        let text: &[u8] = b"M30\n";
        let error = channel.split(&machine, [Position::ZERO; 3], text).err();
        assert!(
            matches!(error, Some(MachineError::Axis(1, e)) if e.id == "P-AXIS-00015"),
            "{mode}: {error:?}"
        );
    }
    let spindle = refused(|machine| {
        (machine.axes[2].kind, machine.axes[2].default_feed_axis) = (AxisKind::Spindle, true);
    });
    assert!(matches!(spindle, Some(MachineError::Axis(2, e)) if e.id == "P-CHAN-00011"), "{spindle:?}");
}

/// Rows: D3-131.
#[test]
fn the_path_is_measured_along_the_feed_axes() {
    // 0…3: X, Y, Z, A, C. What each block is long.
    let lengths = |feed: &[usize], text: &str| {
        let machine = feeding(machines::even::<5>(1000), feed);
        let run = run_from(text, [Position::ZERO; 5], &machine);
        run.blocks.iter().map(|b| b.length.to_bits() as f64 / (1u64 << 44) as f64).collect::<Vec<f64>>()
    };
    let near = |seen: Vec<f64>, expected: &[f64]| {
        let fits =
            seen.len() == expected.len() && seen.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-9 * b);
        assert!(fits, "{seen:?} instead of {expected:?}");
    };
    let text = "N10 G01 X3 Y4 Z12 A20 F6000\nN20 X9 Y4\nN30 Y12\nN40 A60\nM30\n";
    near(lengths(&[], text), &[13.0, 6.0, 8.0, 40.0]);
    near(lengths(&[0], text), &[3.0, 6.0, 8.0, 40.0]);
    near(lengths(&[0, 1], text), &[5.0, 6.0, 8.0, 40.0]);
    near(lengths(&[3], text), &[20.0, 6.0, 8.0, 40.0]);
    near(lengths(&[0, 3], text), &[(9.0_f64 + 400.0).sqrt(), 6.0, 8.0, 40.0]);
    // A feed axis that hardly moves: a 64th of what moves most.
    near(lengths(&[0], "N10 G01 X0.001 Y20.48 F6000\nM30\n"), &[0.32]);
    // A helix: the arc alone, all main axes, an axis beside them too.
    let helix = "N10 G01 X10 F6000\nN20 G03 X-10 I-10 Z15 A20\nM30\n";
    let half = std::f64::consts::PI * 10.0;
    near(lengths(&[0, 1], helix), &[10.0, half]);
    near(lengths(&[], helix), &[10.0, half.hypot(15.0)]);
    near(lengths(&[0, 1, 3], helix), &[10.0, half.hypot(20.0)]);
    // The speed that F means.
    let machine = feeding(machines::even::<3>(1000), &[0]);
    let run = go("N10 G01 X60 Y80 F3000\nM30\n", &machine);
    let top = |k: usize| run.axis_speeds(k).into_iter().fold(0.0, f64::max);
    assert!((top(0) - 50.0).abs() < 1e-3 && (top(1) - 200.0 / 3.0).abs() < 1e-3, "{} {}", top(0), top(1));
    // An arc along one of its axes has no speed that a feed could mean.
    for (feed, plane, ends) in
        [(&[0][..], "", true), (&[0, 2], "", true), (&[0, 2], "G18", false), (&[3], "", true)]
    {
        let machine = feeding(machines::even::<5>(1000), feed);
        let arc = if plane.is_empty() { "G02 X20 I10" } else { "G02 X20 I10 K0" };
        let seen = refusal(&format!("N10 G01 F600\nN20 {plane} {arc}\nM30\n"), &machine);
        let no_plane = matches!(seen, Some(Error::Motion(_, MotionError::Path(PathError::NoFeedPlane(_)))));
        assert_eq!(no_plane, ends, "{feed:?}: {seen:?}");
        if let Some(error) = seen.filter(|_| ends) {
            assert!(error.place().line == 2 && error.to_string().contains("P-CHAN-00011"), "{error}");
        }
    }
}

#[test]
fn pieces_of_a_line_become_one_whatever_measures_them() {
    let text: String = (1..=200)
        .map(|i| {
            format!("G01 X{} Y{} Z{} F6000\n", 0.1 * f64::from(i), 0.3 * f64::from(i), -0.2 * f64::from(i))
        })
        .collect();
    let whole = "G01 X20 Y60 Z-40 F6000\nM30\n";
    for feed in [&[0][..], &[1], &[1, 2]] {
        let machine = feeding(machines::even::<3>(1000), feed);
        let [pieces, one] = [format!("{text}M30\n"), whole.to_owned()].map(|text| go(&text, &machine));
        assert_eq!(pieces.blocks.iter().map(|b| b.blocks).sum::<u32>(), 200);
        assert!((pieces.time() - one.time()).abs() < 2e-3, "{feed:?}: {} {}", pieces.time(), one.time());
        assert_eq!(pieces.trace.mm(pieces.trace.len() - 1), [20.0, 60.0, -40.0]);
    }
    // To and fro along the axis that is no feed axis: nothing is left out.
    let zigzag: String = (1..=50)
        .map(|i| format!("G01 X{} Y{} F6000\n", 0.2 * f64::from(i), f64::from(i % 2) * 1e-3))
        .collect();
    let run = go(&format!("{zigzag}M30\n"), &feeding(machines::even::<3>(1000), &[0]));
    let high = (0..run.trace.len()).filter(|&i| run.trace.mm(i)[1] > 0.8e-3).count();
    assert!(high > 100, "{high}");
}

#[test]
fn random_programs_keep_limits_feed_and_path() {
    for seed in host_tests::seeds::seeds(0..40, 4) {
        for slope in 0..4 {
            let mix = Mix { arcs: 0, ..Mix::arbitrary(3, seed) };
            let mut machine = machines::arbitrary::<3>(seed);
            machine.channel.slope_profile = slope;
            for feed in [&[0][..], &[1], &[0, 2]] {
                // The judge follows the path with the feed along these axes.
                let verdict = verify::<3, 120>(&program(seed, mix), &feeding(machine, feed));
                verdict.unwrap_or_else(|fault| panic!("slope {slope}, feed {feed:?}: {fault}"));
            }
        }
        let arcs = Mix::arbitrary(2, seed);
        let machine = feeding(machines::arbitrary::<2>(seed), &[0, 1]);
        verify::<2, 120>(&program(seed, arcs), &machine).unwrap_or_else(|fault| panic!("{fault}"));
    }
}

#[test]
fn overrides_and_holds_keep_them_too() {
    for seed in host_tests::seeds::seeds(0..60, 6) {
        let (_, machine, mut random) = random_setup(seed);
        let program = program(seed, Mix { arcs: 0, ..Mix::arbitrary(3, seed) });
        let machine = feeding(machine, &[(seed % 3) as usize]);
        let ticks = operate::<3, 120>(&program, &machine, &[], 1000).expect("runs").trace.len();
        let others = host_tests::operate::random_acts(&mut random, ticks);
        let acts = with_overrides(&mut random, ticks, others);
        let polls = POLLS[(random.bits() % 3) as usize];
        operate::<3, 120>(&program, &machine, &acts, polls)
            .and_then(|run| judge(&program, &machine, &run))
            .unwrap_or_else(|fault| panic!("{}, {acts:?}, {polls} polls: {fault}", program.name));
    }
}

#[test]
fn a_knee_is_that_of_the_axes_that_turn() {
    // P-AXIS-00013: a step of 2000 mm/s² · 5 % · 1 ms. Ample room for all else.
    let mut machine = machines::machine::<3>(1000, |_, axis| {
        (axis.vb_max, axis.vb_eilgang) = (1_000_000, 1_000_000);
        machines::accelerations(axis, 2000, 100_000);
        machines::ramps(axis, 50_000);
        axis.tr_geom = 1000;
        axis.a_trans_weight = 50;
    });
    machine.channel.slope_profile = 1;
    let permitted = 2000.0 * 0.05 * 0.001;
    for slope in [0.02, 0.1, 1.0, 7.0] {
        let text = format!("N10 G01 X50 F60000\nN20 X100 Y{}\nM30\n", 50.0 * slope);
        let run = go(&text, &feeding(machine, &[0]));
        // X goes on as it is, Y takes all that it may.
        let v = run.blocks[0].v_out.to_bits() as f64 / 2f64.powi(58) / 1e-3;
        assert!((v * slope / permitted - 1.0).abs() < 1e-4, "slope {slope}: {v} mm/s");
        if slope > 0.1 {
            continue;
        }
        // That is what the set points do: X passes at that speed, and Y begins with its part of it.
        let at = (0..run.trace.len()).find(|&i| run.trace.mm(i)[0] > 50.0).expect("it comes by");
        let [x, y] = [0, 1].map(|k| run.axis_speeds(k));
        assert!((x[at - 1] / v - 1.0).abs() < 0.02 && (x[at] / v - 1.0).abs() < 0.02, "slope {slope}");
        assert!((y[at] / permitted - 1.0).abs() < 0.02, "slope {slope}: {}", y[at]);
    }
}

/// The last axis has little acceleration, with a short cycle.
fn fast_axis() -> MachineData<4> {
    machines::machine(100, |k, axis| {
        (axis.vb_max, axis.vb_eilgang) = (1_000_000, 1_000_000);
        let a = if k == 3 { 50 } else { 2000 };
        machines::accelerations(axis, a, a);
        (axis.a_stufe, axis.a_grenz_stufe) = ([a; 2], [a; 2]);
        machines::ramps(axis, 50_000);
    })
}

/// The largest acceleration of that axis, and what it may have: four times half of 2^-32 degrees, to which a set
/// point is rounded, are added.
fn most_and_allowed(trace: &Trace) -> [f64; 2] {
    let a: Vec<f64> = (0..trace.len()).map(|i| trace.mm(i)[3]).collect();
    let most = a.windows(3).map(|a| (a[2] - 2.0 * a[1] + a[0]).abs() / 1e-8).fold(0.0, f64::max);
    [most, 50.0 + 2.0 / (1u64 << 32) as f64 / 1e-8]
}

/// An axis that travels 1,800 times as far as the feed axes, 1024 times as far as its path counts, and has little
/// acceleration: what a path distance is rounded by shows in it so many times.
#[test]
fn the_rounding_of_the_path_stays_inside_the_acceleration_of_a_fast_axis() {
    let mut failed = Vec::new();
    for slope in 0..4 {
        let mut machine = fast_axis();
        machine.channel.slope_profile = slope;
        for k in 0..8 {
            let x = 0.01 + 0.001 * f64::from(k);
            let text = format!("N10 G01 X{x} A{} F6000\nN20 X0 A0\nM30\n", 1800.0 * x);
            let run = run_from(&text, [Position::ZERO; 4], &feeding(machine, &[0, 1, 2]));
            let [most, allowed] = most_and_allowed(&run.trace);
            println!("slope {slope}, X{x}: {most} of {allowed}");
            if most > allowed {
                failed.push((slope, x, most));
            }
        }
    }
    assert!(failed.is_empty(), "{failed:?}");
}

/// A feed hold finds room for it too: its way to a standstill has limits of its own.
#[test]
fn the_rounding_of_the_path_stays_inside_the_acceleration_of_a_hold() {
    let mut failed = Vec::new();
    for slope in 0..4 {
        let mut machine = fast_axis();
        machine.channel.slope_profile = slope;
        // Short ramps: their jerk is enough for a way to a standstill of its own.
        for axis in &mut machine.axes {
            axis.tr_min = 1000;
            machines::ramps(axis, 1000);
        }
        // The last of them slow down already.
        for k in 0..24 {
            let text = "N10 G01 X0.05 A90 F6000\nM30\n";
            let acts = [(2000 + 613 * k, Act::Hold), (2000 + 613 * k + 6000, Act::Resume)];
            let run =
                operate_text::<4, 120>(text, [Position::ZERO; 4], &feeding(machine, &[0, 1, 2]), &acts, 1000);
            let trace = run.expect("runs").trace;
            let [most, allowed] = most_and_allowed(&trace);
            println!("slope {slope}, hold {k}: {most} of {allowed}, {} ticks", trace.len());
            if most > allowed {
                failed.push((slope, k, most));
            }
        }
    }
    assert!(failed.is_empty(), "{failed:?}");
}

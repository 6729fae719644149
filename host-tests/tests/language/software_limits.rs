//! Software limits of the axes: P-AXIS-00177 and P-AXIS-00178, along the whole path.
use glidepath::channel::{Channel, Error, Handles, MachineError, Progress};
use glidepath::machine::{AxisData, AxisKind, AxisName, ChannelData, MachineData, NO_LIMIT};
use glidepath::quantity::Position;
use glidepath::tick::State;

const BLOCKS: usize = 30;

/// X, Y and Z from -10 to 100 mm, C from -360 to 360 degrees.
fn machine() -> MachineData<4> {
    let axis = |name, kind| {
        let (swe_neg, swe_pos) =
            if kind == AxisKind::Linear { (-100_000, 1_000_000) } else { (-3_600_000, 3_600_000) };
        AxisData { swe_neg, swe_pos, ..AxisData::new(AxisName::new(name).unwrap(), kind) }
    };
    let linear = |name| axis(name, AxisKind::Linear);
    let channel =
        ChannelData { slope_profile: 1, look_ahead: BLOCKS as u32, ptp: true, ..ChannelData::new() };
    MachineData { axes: [linear("X"), linear("Y"), linear("Z"), axis("C", AxisKind::Rotary)], channel }
}

/// What a run gave: the first refusal, where the axes stand, and how far they went.
struct Run {
    error: Option<Error>,
    stands: [f64; 4],
    low: [f64; 4],
    high: [f64; 4],
    /// Functions put out.
    functions: usize,
}

fn run_from(machine: &MachineData<4>, start: [f64; 4], text: &str) -> Run {
    let mut memory = Channel::<4, BLOCKS>::new();
    let at = start.map(Position::from_num);
    let Handles { mut planner, mut interpolator, operator } =
        memory.split(machine, at, text.as_bytes()).unwrap();
    let mut run = Run { error: None, stands: start, low: start, high: start, functions: 0 };
    for _ in 0..1_000_000 {
        let mut done = false;
        loop {
            match planner.poll() {
                Ok(Progress::Waiting) => break,
                Ok(Progress::Done) => {
                    done = true;
                    break;
                }
                Ok(_) => {}
                Err(error) => {
                    run.error.get_or_insert(error);
                }
            }
        }
        let state = interpolator.tick();
        run.functions += core::iter::from_fn(|| operator.output()).count();
        run.stands = interpolator.set_points().map(|p| p.to_num());
        for (k, x) in run.stands.into_iter().enumerate() {
            (run.low[k], run.high[k]) = (run.low[k].min(x), run.high[k].max(x));
        }
        if done && state == State::Idle {
            assert_eq!(planner.position(), interpolator.set_points(), "{text}");
            return run;
        }
    }
    panic!("no end");
}

fn run(text: &str) -> Run {
    run_from(&machine(), [0.0; 4], text)
}

#[track_caller]
fn refused(text: &str, line: u32, column: u32, axis: &str, position: f64, limit: f64) -> Run {
    let run = run(text);
    match &run.error {
        Some(Error::SoftwareLimit(place, name, beyond)) => {
            let mm = |bits| Position::from_bits(bits).to_num::<f64>();
            assert_eq!((place.line, place.column, name.as_str()), (line, column, axis), "{text}");
            assert!((mm(beyond.position) - position).abs() < 2e-6, "{text}: {}", mm(beyond.position));
            assert_eq!((mm(beyond.limit), beyond.is_positive()), (limit, position > limit), "{text}");
        }
        other => panic!("{text}: {other:?}"),
    }
    for k in 0..3 {
        assert!(run.low[k] >= -10.0 && run.high[k] <= 100.0, "{text}: {:?} {:?}", run.low, run.high);
    }
    run
}

/// Rows: OP-10.
#[test]
fn an_axis_may_go_up_to_its_limit_and_not_beyond() {
    let at_limit = run("G00 X100 Y-10 C360\nG01 X-10 Y100 Z100 C-360 F6000\n");
    assert_eq!((at_limit.error, at_limit.stands), (None, [-10.0, 100.0, 100.0, -360.0]));
    let run = refused("G00 X90\nN20 G01 F1000 Y5 X100.001 Z3\nX0\n", 2, 5, "X", 100.001, 100.0);
    assert_eq!(run.stands, [90.0, 0.0, 0.0, 0.0], "the blocks before it run, the axes stop before it");
    let text = run.error.unwrap().to_string();
    for part in ["axis X", "100.001", "100.000000", "positive", "P-AXIS-00178"] {
        assert!(text.contains(part), "{text}");
    }
    refused("G00 C-361\n", 1, 1, "C", -361.0, -360.0);
    refused("G91 G00 Y-5\nY-5\nY-0.0001\n", 3, 1, "Y", -10.0001, -10.0);
    refused("G92 Z50\nG00 Z51\n", 2, 1, "Z", 101.0, 100.0);
    let off = run_from(
        &MachineData {
            axes: machine().axes.map(|a| AxisData { swe_neg: -NO_LIMIT, swe_pos: NO_LIMIT, ..a }),
            ..machine()
        },
        [0.0; 4],
        "G00 X5000 C-9999",
    );
    assert_eq!((off.error, off.stands[0]), (None, 5000.0));
}

#[test]
fn all_of_an_arc_counts() {
    // From (0, 0) about (50, 0): the ends are inside, the arc is not, by one side or the other.
    refused("G02 X100 Y0 I50 F9000\nG03 X0 I-50 J0 F1000\nG03 X100 Y0 I50", 3, 1, "Y", -50.0, -10.0);
    refused("G01 Y60 F5000\nG02 X0 Y60 I0 J30\n", 2, 1, "X", -30.0, -10.0);
}

#[test]
fn an_arc_that_touches_its_limit_is_inside() {
    // A full circle of radius 55 about (45, 45): from -10 to 100 in both axes.
    let all = run("G01 X45 Y-10 F9000\nG02 J55\nG03 J55\nX100 Y45 R55\nM30");
    assert_eq!(all.error, None);
    assert!((all.high[0] - 100.0).abs() < 1e-4 && (all.low[0] + 10.0).abs() < 1e-4);
    refused("G01 X45 Y-10 F9000\nG02 J55.001\n", 2, 1, "X", -10.001, -10.0);
    // A quarter that ends at the extreme, and one that begins there.
    assert_eq!(
        run("G01 X90 Y50 F9000\nG03 X80 Y60 I-10\nG02 X90 Y50 J-10\nG18 G03 X100 Z10 I10").error,
        None
    );
    // A helix: the third axis goes straight.
    refused("G17 G02 X0 Y0 I5 Z100.5 F3000", 1, 5, "Z", 100.5, 100.0);
}

/// Every arc of a circle that sticks out on one side: refused just if a dense sampling of it leaves the
/// limits.
#[test]
fn arcs_are_refused_as_a_sampling_says() {
    let (mut inside, mut outside) = (0, 0);
    for k in 0..24 {
        for m in 0..24 {
            for clockwise in [true, false] {
                let angle = |k: u32| f64::from(k) * core::f64::consts::TAU / 24.0;
                // Out at the right by 5 mm.
                let (cx, cy, r) = (45.0, 45.0, 60.0);
                let at = |a: f64| (cx + r * a.cos(), cy + r * a.sin());
                let far = |(x, y): (f64, f64)| (x - 100.0).max(y - 100.0).max(-10.0 - x).max(-10.0 - y);
                let (from, to) = (at(angle(k)), at(angle(m)));
                if far(from) > -0.01 || far(to) > -0.01 {
                    continue;
                }
                let mut sweep = angle(m) - angle(k);
                if clockwise {
                    sweep = -sweep;
                }
                if sweep <= 1e-9 {
                    sweep += core::f64::consts::TAU;
                }
                let sign = if clockwise { -1.0 } else { 1.0 };
                let most = (0..=2000)
                    .map(|i| far(at(angle(k) + sign * sweep * f64::from(i) / 2000.0)))
                    .fold(f64::MIN, f64::max);
                let g = if clockwise { 2 } else { 3 };
                let text = format!(
                    "G01 X{:.6} Y{:.6} F9000\nG{g:02} X{:.6} Y{:.6} I{:.6} J{:.6}\n",
                    from.0,
                    from.1,
                    to.0,
                    to.1,
                    cx - from.0,
                    cy - from.1
                );
                let refused = run(&text).error.is_some();
                assert_eq!(refused, most > 0.0, "{k} {m} {clockwise}: {most}");
                *(if refused { &mut outside } else { &mut inside }) += 1;
            }
        }
    }
    assert!(inside > 20 && outside > 100, "{inside} {outside}");
}

#[test]
fn curves_in_corners_stay_inside() {
    // The interim point lies outside, the blocks do not.
    let text = "#CONTOUR MODE [POS PRE_DIST=20 POST_DIST=20 X105 Y-2]\nG261\nG01 X95 F3000 M7\nY60\nX0\nM30";
    let stopped = run(text);
    let Some(Error::SoftwareLimit(place, axis, beyond)) = stopped.error else {
        panic!("{:?}", stopped.error)
    };
    assert_eq!((place.line, place.column, axis.as_str()), (4, 1, "X"), "the block behind the corner");
    assert!(beyond.is_positive() && beyond.position > 100 << 32 && beyond.limit == 100 << 32);
    assert_eq!(stopped.functions, 0, "M7 belongs to the point that was not reached");
    assert!(stopped.stands[0] >= 75.0 && stopped.stands[0] < 100.0, "{:?}", stopped.stands);
    // Wider limits let it pass: it is the curve that leaves them.
    let mut wide = machine();
    (wide.axes[0].swe_pos, wide.axes[1].swe_neg) = (2_000_000, -1_000_000);
    let passed = run_from(&wide, [0.0; 4], text);
    assert!(passed.error.is_none(), "{:?}", passed.error);
    assert!(passed.high[0] > 100.0, "{:?}", passed.high);
    // With unequal distances a curve swings out.
    let text = "#CONTOUR MODE [DIST PRE_DIST=10 POST_DIST=3]\nG261\nG01 X100 F6000\nY60\nX0\nM30";
    let passed = run_from(&wide, [0.0; 4], text);
    assert!(passed.error.is_none() && (100.1..101.0).contains(&passed.high[0]), "{:?}", passed.high);
    let Some(Error::SoftwareLimit(_, _, beyond)) = run(text).error else { panic!("not refused") };
    let most = Position::from_bits(beyond.position).to_num::<f64>();
    assert!((100.0..passed.high[0] + 1e-3).contains(&most), "{most} {}", passed.high[0]);
    // Inside the corner nothing is refused, up to the limits.
    for method in ["DEV PATH_DEV=2", "DIST PRE_DIST=9 POST_DIST=9", "DIST_SOFT PATH_DIST=9", "PTP PATH_DEV=1"]
    {
        let text = format!(
            "#CONTOUR MODE [{method}]\nG261\nG01 X100 F6000\nY100\nX-10\nY-10\nX0 Y0\nG02 X20 Y20 I20\nG01 X30\nM30"
        );
        let run = run(&text);
        assert_eq!(run.error, None, "{method}");
        assert!(run.low.iter().all(|x| *x >= -10.0) && run.high.iter().all(|x| *x <= 100.0), "{method}");
    }
}

/// A spline of Akima goes through its points and swings out between them: the curve counts, not the points.
#[test]
fn splines_between_points_stay_inside() {
    let points = "X20 Y90\nX40 Y100\nX41 Y100\nX60 Y60\nX70 Y0\n";
    let text = format!("G01 F3000 Y40\nG151\n{points}G150\nM30");
    let mut wide = machine();
    wide.axes[1].swe_pos = 2_000_000;
    let passed = run_from(&wide, [0.0; 4], &text);
    assert!(passed.error.is_none() && (100.01..110.0).contains(&passed.high[1]), "{:?}", passed.high);
    let stopped = run(&text);
    let Some(Error::SoftwareLimit(_, axis, beyond)) = stopped.error else { panic!("{:?}", stopped.error) };
    assert!(axis.as_str() == "Y" && beyond.is_positive() && beyond.limit == 100 << 32);
    assert!(stopped.high[1] <= 100.0, "{:?}", stopped.high);
    // One that its points control stays between them.
    for (on, off) in [("#SPLINE TYPE BSPLINE\nG151", "G150"), ("#HSC ON [BSPLINE PATH_DEV=1]", "#HSC OFF")] {
        let inside = run(&format!("G01 F3000 Y40\n{on}\n{points}{off}\nM30"));
        assert!(inside.error.is_none() && inside.high[1] <= 100.0, "{on}: {:?}", inside.error);
    }
}

/// Random corners near the limits: no set point is beyond them, whatever the method.
#[test]
fn no_set_point_is_beyond_a_limit() {
    let mut state = 12345_u64;
    let mut random = |n: u64| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) % n
    };
    let methods = [
        "DEV PATH_DEV=5",
        "DIST PRE_DIST=15 POST_DIST=4",
        "POS PRE_DIST=12 POST_DIST=7 X90 Y90",
        "DIST_SOFT PATH_DIST=9",
        "PTP PATH_DEV=4",
    ];
    let (mut ended, mut stopped) = (0, 0);
    for _ in 0..60 {
        let method = methods[random(5) as usize];
        let mut text = format!("#CONTOUR MODE [{method}]\nG261\nG01 F9000\n");
        let mut at = (0.0, 0.0);
        for _ in 0..5 {
            let corner = |v: u64| [-10.0, 100.0, 99.0, 45.0, -9.5][v as usize];
            let to = (corner(random(5)), corner(random(5)));
            let chord = f64::hypot(to.0 - at.0, to.1 - at.1);
            if chord > 1.0 && !method.starts_with("PTP") && random(8) == 0 {
                text += &format!(
                    "G0{} X{} Y{} R{:.4}\n",
                    2 + random(2),
                    to.0,
                    to.1,
                    chord * 0.5 * (1.001 + random(50) as f64 * 0.02)
                );
            } else {
                text += &format!("G01 X{} Y{}\n", to.0, to.1);
            }
            at = to;
        }
        let run = run(&text);
        let inside = |k: usize| run.low[k] > -10.0 - 2e-9 && run.high[k] < 100.0 + 2e-9;
        assert!(inside(0) && inside(1), "{text}: {:?} {:?} {:?}", run.error, run.low, run.high);
        match run.error {
            None => ended += 1,
            Some(Error::SoftwareLimit(..)) => stopped += 1,
            Some(other) => panic!("{text}: {other}"),
        }
    }
    assert!(ended > 5 && stopped > 5, "{ended} {stopped}");
}

#[test]
fn an_axis_outside_may_come_back_and_go_no_further() {
    let from = |text: &str| run_from(&machine(), [120.0, 0.0, 0.0, 0.0], text);
    let back = from("G00 Y50\nX110\nX50\nX100\n");
    assert_eq!((back.error, back.stands[..2].to_vec()), (None, vec![100.0, 50.0]));
    assert!(matches!(from("G00 X120.1").error, Some(Error::SoftwareLimit(..))));
    assert!(matches!(from("G00 X105\nX106").error, Some(Error::SoftwareLimit(..))));
}

#[test]
fn a_message_tells_position_and_limit_apart() {
    for (text, told) in [
        ("G00 X100.0000001", "would come to 100.0000000999, its positive software limit is 100.0000000000 "),
        ("G00 X100.000001", "would come to 100.0000010000, its positive software limit is 100.0000000000 "),
        ("G00 X100.000002", "would come to 100.000002, its positive software limit is 100.000000 "),
        ("G00 X101", "would come to 101.000000, its positive software limit is 100.000000 "),
    ] {
        let message = run(text).error.unwrap().to_string();
        assert!(message.contains(told), "{message}");
    }
}

#[test]
fn a_refused_motion_leaves_no_trace_and_the_next_line_goes_on() {
    let mut memory = Channel::<4, BLOCKS>::new();
    let text = b"G01 X90 F3000\nG00 G91 X20 M5\nY10 X-1\nM30\n".as_slice();
    let machine = machine();
    let Handles { mut planner, mut interpolator, operator } =
        memory.split(&machine, [Position::ZERO; 4], text).unwrap();
    let (mut refusals, mut idle) = (0, 0);
    for _ in 0..100_000 {
        loop {
            match planner.poll() {
                Ok(Progress::Waiting | Progress::Done) => break,
                Ok(_) => {}
                Err(error) => {
                    refusals += 1;
                    assert_eq!(error.place().line, 2);
                }
            }
        }
        if interpolator.tick() == State::Idle {
            idle += 1;
            if planner.go_on().is_err() && idle > 3 {
                break;
            }
        }
    }
    assert_eq!(refusals, 1);
    assert!(operator.output().is_none(), "M5 belongs to the refused line");
    let ends = interpolator.set_points().map(|p| p.to_num::<f64>());
    assert_eq!(ends[..2], [-1.0, 10.0], "absolute and at feed, as before the line");
}

/// A plain line, which the decoder takes in one pass: G00 or the feed of the refused one would show in the
/// time.
#[test]
fn a_refused_plain_line_changes_nothing_in_force() {
    let ticks = |bad: &str| {
        let mut memory = Channel::<4, BLOCKS>::new();
        let text = format!("G01 X5 F600\nG04 0.01\n{bad}\nY20\n");
        let machine = machine();
        let Handles { mut planner, mut interpolator, .. } =
            memory.split(&machine, [Position::ZERO; 4], text.as_bytes()).unwrap();
        let (mut ticks, mut refusals) = (0, 0);
        for _ in 0..100_000 {
            let mut done = false;
            while !done {
                match planner.poll() {
                    Ok(Progress::Waiting) => break,
                    Ok(Progress::Done) => done = true,
                    Ok(_) => {}
                    Err(_) => refusals += 1,
                }
            }
            let idle = interpolator.tick() == State::Idle;
            ticks += i32::from(!idle);
            if idle && done && planner.go_on().is_err() {
                break;
            }
        }
        assert_eq!(interpolator.set_points()[1], Position::from_num(20));
        // The standstill behind a refusal has a tick of its own.
        (refusals, ticks - refusals)
    };
    let (_, without) = ticks("(nothing)");
    assert!(without > 2000);
    for bad in ["G00 X500", "X500 F6000", "G01 X-200 F1"] {
        assert_eq!(ticks(bad), (1, without), "{bad}");
    }
}

#[test]
fn limits_are_checked_with_the_machine_data() {
    for (neg, pos) in [(5, 5), (10, -10), (-NO_LIMIT, -NO_LIMIT)] {
        let mut machine = machine();
        (machine.axes[1].swe_neg, machine.axes[1].swe_pos) = (neg, pos);
        let mut memory = Channel::<4, BLOCKS>::new();
        let refused = memory.split(&machine, [Position::ZERO; 4], b"M30".as_slice()).err();
        assert!(matches!(refused, Some(MachineError::Axis(1, e)) if e.id == "P-AXIS-00177"), "{neg} {pos}");
    }
}

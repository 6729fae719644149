//! The checker accepts a motion that uses its limits fully, and finds each kind of fault.
use host_tests::cases::{Program, machines, named, set_point};
use host_tests::check::{self, Limits};
use host_tests::reference::geometry::Contour;
use host_tests::reference::limits::path_length;
use host_tests::reference::motion::Motion;
use host_tests::reference::profile::{Profile, Ramps};
use host_tests::tolerance;
use host_tests::trace::{Trace, sampled};

/// A program, its contour, and a motion along it that stops at every joint, with `scale` times the permitted
/// speed, acceleration and jerk.
fn motion(program: &Program, cycle_us: u32, scale: [f64; 3]) -> (Contour, Trace) {
    let machine = machines::even::<3>(cycle_us);
    let contour = program.contour(&machine);
    let cycle = f64::from(cycle_us) * 1e-6;
    let profiles: Vec<Profile> = contour
        .elements
        .iter()
        .map(|element| {
            // Speed, acceleration and jerk of the axis with the largest part of the path; all axes are alike.
            let length = path_length(element);
            let share = (0..3).map(|k| element.travel(k).abs()).fold(0.0, f64::max) / length;
            let v = (200.0 * scale[0] / share).min(element.feed.unwrap() / 60.0);
            let a = 2000.0 * scale[1] / share;
            let ramp = 0.05 * scale[1] / scale[2];
            let ramps = Ramps { a, up: ramp, down: ramp };
            Profile::fastest(length, 0.0, 0.0, v, ramps, ramps).unwrap()
        })
        .collect();
    let motion = Motion::new(&contour, &profiles, cycle);
    let trace = sampled(&contour, cycle, |t| motion.at(t));
    (contour, trace)
}

/// The limits of [`machines::even`].
const EVEN: [Limits; 3] = [Limits { v: 200.0, a: 2000.0, jerk: 40_000.0 }; 3];

/// Lines along and across the axes, with stops.
fn zigzag() -> Program {
    Program::new("zigzag", 3)
        .line(&[80.0], 60_000.0)
        .stop()
        .line(&[80.0, 30.0], 60_000.0)
        .stop()
        .line(&[20.0, -50.0, 40.0], 60_000.0)
        .stop()
}

fn judge(program: &Program, contour: &Contour, trace: &Trace) -> Result<(), String> {
    check::limits(trace, &EVEN)?;
    let course = check::path(trace, contour, tolerance::PATH, 200.0)?;
    let (a, allowance, tick) = course.acceleration(trace.cycle);
    // Any direction: 2000 mm/s² on each of three axes.
    if a > 2000.0 * 3f64.sqrt() + allowance {
        return Err(format!("path acceleration {a} at {tick}"));
    }
    let start: Vec<i64> = program.start.iter().map(|&nm| set_point(nm)).collect();
    check::ends(trace, &start, &program.end_points())
}

#[test]
fn accepts_motions_at_their_limits() {
    for cycle_us in [100, 1000, 4000, 10_000] {
        let program = zigzag();
        let (contour, trace) = motion(&program, cycle_us, [1.0; 3]);
        judge(&program, &contour, &trace).unwrap();
        // The limits are in fact used: the judge measured them, not something smaller.
        let peaks = check::limits(&trace, &EVEN).unwrap();
        assert!(peaks[0].values[0] > 199.9, "{peaks:?}");
        assert!(peaks[0].values[1] > 1999.0, "{peaks:?}");
        assert!(peaks[0].values[2] > 39_990.0, "{peaks:?}");
    }
}

#[test]
fn catches_one_part_in_ten_thousand_too_much() {
    let program = zigzag();
    for (order, name) in ["speed", "acceleration", "jerk"].into_iter().enumerate() {
        let mut scale = [1.0; 3];
        scale[order] = 1.0001;
        let (_, trace) = motion(&program, 1000, scale);
        let refused = check::limits(&trace, &EVEN).unwrap_err();
        assert!(refused.contains(name), "{refused}");
    }
}

#[test]
fn catches_jumps_at_the_ends() {
    let (_, trace) = motion(&zigzag(), 1000, [1.0; 3]);
    let mut late = trace.clone();
    let mut early = trace.clone();
    let (first, last) = (20, trace.len() - 20);
    for column in &mut late.columns {
        column.drain(1..first);
    }
    for column in &mut early.columns {
        column.drain(last..);
    }
    assert!(check::limits(&late, &EVEN).is_err());
    assert!(check::limits(&early, &EVEN).is_err());
}

#[test]
fn catches_a_set_point_beside_the_path() {
    let program = zigzag();
    let (contour, trace) = motion(&program, 1000, [1.0; 3]);
    for (axis, part, caught) in [(1, 0.8, false), (1, 1.2, true), (2, -1.2, true)] {
        let mut bent = trace.clone();
        bent.columns[axis][100] += (part * tolerance::PATH * 4_294_967_296.0) as i64;
        assert_eq!(check::path(&bent, &contour, tolerance::PATH, 200.0).is_err(), caught, "{axis} {part}");
    }
}

#[test]
fn catches_a_wrong_radius_and_a_wrong_sense() {
    let right = named::slot(6000.0, 3);
    let (contour, trace) = motion(&right, 1000, [1.0; 3]);
    check::path(&trace, &contour, tolerance::PATH, 200.0).unwrap();
    let machine = machines::even::<3>(1000);
    let mut sense = named::slot(6000.0, 3);
    if let host_tests::cases::Kind::Arc { clockwise, .. } = &mut sense.moves[1].kind {
        *clockwise = true;
    }
    assert!(check::path(&trace, &sense.contour(&machine), tolerance::PATH, 200.0).is_err());
    let mut radius = named::slot(6000.0, 3);
    if let host_tests::cases::Kind::Arc { by, .. } = &mut radius.moves[1].kind {
        *by = host_tests::cases::By::Offset([5, 15 * host_tests::cases::NM]);
    }
    assert!(check::path(&trace, &radius.contour(&machine), tolerance::PATH, 200.0).is_err());
}

#[test]
fn catches_a_tracking_axis_out_of_step() {
    let machine = machines::even::<4>(1000);
    let program = Program::new("along", 4).line(&[10.0, 0.0, 0.0, 90.0], 600.0);
    let contour = program.contour(&machine);
    let at = |t: f64, lag: f64| {
        let u = t / 2.0;
        (u < 1.0).then(|| vec![10.0 * u, 0.0, 0.0, 90.0 * u - lag * u * (1.0 - u)])
    };
    let good = sampled(&contour, 0.001, |t| at(t, 0.0));
    check::path(&good, &contour, tolerance::PATH, 200.0).unwrap();
    let bad = sampled(&contour, 0.001, |t| at(t, 0.001));
    assert!(check::path(&bad, &contour, tolerance::PATH, 200.0).is_err());
}

#[test]
fn catches_what_is_left_out() {
    // There, 5 µm on, and back. The motion turns 2 µm before the far end.
    let program = Program::new("turn", 3).line(&[10.0], 6000.0).line(&[0.0], 6000.0);
    let (contour, trace) = motion(&program, 1000, [1.0; 3]);
    judge(&program, &contour, &trace).unwrap();
    let mut short = trace.clone();
    let cap = set_point(9_995_000);
    for x in &mut short.columns[0] {
        *x = (*x).min(cap);
    }
    assert!(judge(&program, &contour, &short).is_err());

    // A corner that is cut by one tick at low speed.
    let program = zigzag();
    let (contour, trace) = motion(&program, 1000, [1.0; 3]);
    let corner = (0..trace.len()).find(|&t| trace.columns[1][t] > 0).unwrap();
    let mut cut = trace.clone();
    for column in &mut cut.columns {
        column.drain(corner - 40..corner + 10);
    }
    assert!(judge(&program, &contour, &cut).is_err());

    // A step back, and an end that is never reached.
    let mut back = trace.clone();
    for column in &mut back.columns {
        column.swap(200, 203);
    }
    assert!(check::path(&back, &contour, tolerance::PATH, 200.0).is_err());
    let mut stuck = trace.clone();
    for column in &mut stuck.columns {
        column.truncate(trace.len() - 100);
    }
    assert!(check::path(&stuck, &contour, tolerance::PATH, 200.0).is_err());
}

#[test]
fn catches_blocks_out_of_order_and_blocks_skipped() {
    let machine = machines::even::<3>(1000);
    let program = Program::new("square", 3)
        .line(&[0.0, 0.2], 12_000.0)
        .line(&[0.2, 0.2], 12_000.0)
        .line(&[0.2, 0.0], 12_000.0)
        .line(&[0.0, 0.0], 12_000.0);
    let contour = program.contour(&machine);
    let (_, trace) = motion(&program, 1000, [1.0; 3]);
    check::path(&trace, &contour, tolerance::PATH, 200.0).unwrap();
    // The same square the other way round, and without motion at all.
    let (_, other) = motion(&program.reversed(), 1000, [1.0; 3]);
    assert!(check::path(&other, &contour, tolerance::PATH, 200.0).is_err());
    let mut none = Trace::new(0.001, &[0; 3]);
    none.push([0; 3]);
    assert!(check::path(&none, &contour, tolerance::PATH, 200.0).is_err());
}

#[test]
fn catches_ends_off_by_one_bit() {
    let program = zigzag();
    let (_, trace) = motion(&program, 1000, [1.0; 3]);
    let (start, ends) = ([0; 3], program.end_points());
    check::ends(&trace, &start, &ends).unwrap();
    for axis in 0..3 {
        let mut end = trace.clone();
        *end.columns[axis].last_mut().unwrap() += 1;
        assert!(check::ends(&end, &start, &ends).is_err());
        let mut begin = trace.clone();
        begin.columns[axis][0] -= 1;
        assert!(check::ends(&begin, &start, &ends).is_err());
    }
    let stop = (0..trace.len()).find(|&t| trace.row(t).eq(ends[0].0.iter().copied())).unwrap();
    let mut missed = trace.clone();
    for t in stop.. {
        if missed.columns[0][t] != ends[0].0[0] {
            break;
        }
        missed.columns[0][t] -= 1;
    }
    assert!(check::ends(&missed, &start, &ends).is_err());
}

//! The operator handle: its status during the motion, read from another thread.
use glidepath::channel::{Channel, Handles, Progress};
use glidepath::operator::{Operator, Status};
use glidepath::quantity::Position;
use glidepath::queue::Function;
use glidepath::tick::{Interpolator, State};
use host_tests::calls::call;
use host_tests::cases::machines;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

const PROGRAM: &[u8] =
    b"$FOR P1 = 1, 20, 1\nN10 G01 X20 Y5 F300\nN20 G02 X30 Y15 I0 J10\nN30 G01 Y30 Z3\nN40 G04 0.01\n\
    N50 G01 X0 Y0 Z0\n$ENDFOR\nM30\n";

/// Reads of the status.
const READS: usize = 10_000_000;
/// Reads that saw another tick than the one before, at least.
const CHANGES: usize = 1000;

const fn is_send<T: Send>() {}

/// Each handle may go to a thread, a task or a core of its own.
const _: () = {
    is_send::<Operator<'static, 3>>();
    is_send::<Interpolator<'static, 3>>();
    is_send::<Handles<'static, &'static [u8], 3, 120>>();
};

/// What a tick gave, as the operator has to see it.
#[derive(Clone, PartialEq, Debug)]
struct Row {
    set_points: [Position; 3],
    distance: i64,
    n: u32,
    block: u32,
    state: State,
}

impl Row {
    fn of(status: &Status<3>) -> Self {
        let Status { set_points, distance, n, block, state, .. } = *status;
        Self { set_points, distance: distance.to_bits(), n, block, state }
    }
}

/// Runs the program, with a few ticks of rest at first, `each` behind every tick.
fn run(mut each: impl FnMut(&Interpolator<'_, 3>, &Operator<'_, 3>, State)) {
    let machine = machines::even(1000);
    let mut channel: Box<Channel<3, 120>> = Box::new(Channel::new());
    let handles = channel.split(&machine, [Position::ZERO; 3], PROGRAM).expect("machine data");
    let Handles { mut planner, mut interpolator, operator } = handles;
    for _ in 0..5 {
        let state = interpolator.tick();
        each(&interpolator, &operator, state);
    }
    loop {
        let done = call(&mut planner, usize::MAX, |_| {}).expect("a program");
        let state = interpolator.tick();
        each(&interpolator, &operator, state);
        if done && state == State::Idle {
            return;
        }
    }
}

#[test]
fn the_status_is_what_the_last_tick_did() {
    let mut ticks = 0;
    let mut before = [0.0; 3];
    run(|interpolator, operator, state| {
        ticks += 1;
        let (status, telemetry) = (operator.status(), interpolator.telemetry());
        assert_eq!((status.ticks, status.state), (ticks, state));
        assert_eq!(&status.set_points, interpolator.set_points());
        assert_eq!((status.n, status.block), (telemetry.n, telemetry.block));
        assert_eq!(status.planned, telemetry.distance);
        // C1: the speed is that of the set points, to 2^-44 mm per tick.
        let points = status.set_points.map(|point| point.to_num::<f64>());
        let step = points.iter().zip(&before).map(|(to, from)| (to - from).powi(2)).sum::<f64>().sqrt();
        let speed = status.speed.0.to_num::<f64>();
        assert!((speed - step).abs() < 1e-9, "{speed} and {step} mm per tick");
        // The mean over a tick is near the speed at its end: 2000 mm/s² at 1 ms.
        if state == State::Active {
            let off = speed - telemetry.speed.0.to_num::<f64>();
            assert!(off.abs() < 0.003, "{off}");
        }
        assert!(status.queued <= 256);
        before = points;
    });
    assert!(ticks > 10_000, "{ticks}");
}

/// The speed is that of the set points also where the path is a curve over time, and behind filters and rest.
#[test]
fn speed_is_that_of_the_set_points_in_curves_over_time() {
    for mode in ["[DEV PATH_DEV=0.1]", "[DIST_SOFT PATH_DIST=3]", "[PTP PATH_DEV=0.5]", "[POS]"] {
        let text = format!(
            "#CONTOUR MODE ON {mode}\nG01 X50 F6000\nY50\nG04 X0.05\nX0\nG02 X0 Y0 J-25\nG01 Z5\nM30\n"
        );
        let mut machine = machines::even(1000);
        (machine.channel.slope_profile, machine.channel.ptp) = (3, true);
        let mut channel: Box<Channel<3, 120>> = Box::new(Channel::new());
        let handles = channel.split(&machine, [Position::ZERO; 3], text.as_bytes()).expect("machine data");
        let Handles { mut planner, mut interpolator, operator } = handles;
        let (mut before, mut slowest) = ([0.0; 3], f64::MAX);
        loop {
            let done = call(&mut planner, usize::MAX, |_| {}).expect("a program");
            let state = interpolator.tick();
            let status = operator.status();
            let points = interpolator.set_points().map(|point| point.to_num::<f64>());
            let step = points.iter().zip(&before).map(|(to, from)| (to - from).powi(2)).sum::<f64>().sqrt();
            let speed = status.speed.0.to_num::<f64>();
            assert!((speed - step).abs() < 1e-9, "{mode}: {speed} and {step} mm per tick");
            if (45.0..50.0).contains(&points[0]) && (0.0..5.0).contains(&points[1]) {
                slowest = slowest.min(speed);
            }
            before = points;
            if done && state == State::Idle {
                break;
            }
        }
        // As planned it is 0.1 mm per tick in curves over time; the axes are slower.
        assert!(slowest < 0.09, "{mode}: {slowest} mm per tick");
    }
}

#[test]
fn another_thread_never_sees_a_mixture() {
    // What each tick gives is the same in every run.
    let mut rows = Vec::new();
    run(|interpolator, _, state| {
        let telemetry = interpolator.telemetry();
        let row = Row {
            set_points: *interpolator.set_points(),
            distance: telemetry.distance.to_bits(),
            n: telemetry.n,
            block: telemetry.block,
            state,
        };
        rows.push(row);
    });
    let at_rest = Row { set_points: [Position::ZERO; 3], distance: 0, n: 0, block: 0, state: State::Idle };
    let machine = machines::even(1000);
    let (is_over, seen) = (AtomicBool::new(false), AtomicUsize::new(0));
    let mut changes = 0;
    // On a machine with other work a reader may stand still for most of a run: then there are more of them.
    let goes_on = |seen: usize, changes: usize| seen < READS || (changes <= CHANGES && seen < 30 * READS);
    while goes_on(seen.load(Ordering::Relaxed), changes) {
        let mut channel: Box<Channel<3, 120>> = Box::new(Channel::new());
        let handles = channel.split(&machine, [Position::ZERO; 3], PROGRAM).expect("machine data");
        let Handles { mut planner, mut interpolator, operator } = handles;
        is_over.store(false, Ordering::Relaxed);
        std::thread::scope(|scope| {
            let reader = scope.spawn(|| {
                let (operator, mut last, mut changes) = (operator, 0, 0);
                while !is_over.load(Ordering::Relaxed) {
                    for _ in 0..100 {
                        let status = operator.status();
                        let row = (status.ticks as usize).checked_sub(1).map_or(&at_rest, |row| &rows[row]);
                        assert_eq!(Row::of(&status), *row, "tick {}", status.ticks);
                        assert!(last <= status.ticks, "backward");
                        changes += usize::from(last != status.ticks);
                        last = status.ticks;
                    }
                    seen.fetch_add(100, Ordering::Relaxed);
                }
                changes
            });
            for _ in 0..5 {
                interpolator.tick();
            }
            let mut done = false;
            for _ in 5..rows.len() {
                done = done || call(&mut planner, usize::MAX, |_| {}).expect("a program");
                interpolator.tick();
            }
            is_over.store(true, Ordering::Relaxed);
            changes += reader.join().expect("no mixture");
        });
    }
    println!("{changes} of {} reads saw a new tick", seen.load(Ordering::Relaxed));
    assert!(changes > CHANGES, "{changes} of {} reads saw a new tick", seen.load(Ordering::Relaxed));
}

#[test]
fn aborts_that_nobody_has_seen_do_not_cancel_out() {
    let machine = machines::even(1000);
    for count in [1, 255, 256, 257, 512] {
        let mut channel: Box<Channel<3, 120>> = Box::new(Channel::new());
        let text: &[u8] = b"N10 G01 X100 F6000\nM30\n";
        let handles = channel.split(&machine, [Position::ZERO; 3], text).expect("machine data");
        let Handles { mut planner, mut interpolator, operator } = handles;
        for _ in 0..100 {
            while !matches!(planner.poll().expect("a program"), Progress::Waiting | Progress::Done) {}
            interpolator.tick();
        }
        for _ in 0..count {
            operator.abort();
        }
        assert!(operator.commands().abort, "{count}");
        for _ in 0..2000 {
            while !matches!(planner.poll().expect("a program"), Progress::Waiting | Progress::Done) {}
            interpolator.tick();
        }
        assert!(
            !operator.commands().abort && interpolator.set_points()[0] < Position::from_num(50),
            "{count}"
        );
    }
}

#[test]
fn a_tick_counts_whether_the_path_moves_or_not() {
    let machine = machines::even(1000);
    let mut channel: Box<Channel<3, 120>> = Box::new(Channel::new());
    let text: &[u8] = b"N10 G01 X1 F6000 M5\nN20 X2\nM30\n";
    let handles = channel.split(&machine, [Position::ZERO; 3], text).expect("machine data");
    let Handles { mut planner, mut interpolator, operator } = handles;
    assert_eq!((operator.status().ticks, operator.status().state), (0, State::Idle));
    for tick in 1..=100 {
        assert_eq!(interpolator.tick(), State::Idle);
        assert_eq!((operator.status().ticks, operator.status().state), (tick, State::Idle));
    }
    while !matches!(planner.poll().expect("a program"), Progress::Waiting | Progress::Done) {}
    let mut tick = 100;
    while interpolator.tick() == State::Active {
        // An operator that is late sees the tick at which the point was reached all the same.
        tick += 1;
    }
    let output = operator.output().expect("M5");
    let at = output.tick;
    assert!(output.function == Function::M(5) && output.n == 10);
    assert!(101 < at && at + 1 < tick, "{at} of {tick}");
    assert_eq!((operator.output(), operator.status().ticks), (None, tick + 1));
    let status = operator.status();
    assert_eq!((status.state, status.speed.to_bits(), status.queued), (State::Idle, 0, 0));
}

/// Behind an abort inside a block the path goes on from where it stands: in the first tick of the next motion
/// too, the speed is that of the set points.
#[test]
fn speed_is_that_of_the_set_points_behind_an_abort() {
    for slope in 0..4 {
        let mut machine = machines::even(1000);
        machine.channel.slope_profile = slope;
        let mut channel: Box<Channel<3, 120>> = Box::new(Channel::new());
        let text: &[u8] = b"N10 G01 X100 F6000\nN20 X200\nM30\n";
        let handles = channel.split(&machine, [Position::ZERO; 3], text).expect("machine data");
        let Handles { mut planner, mut interpolator, operator } = handles;
        let (mut before, mut compared) = (0, 0);
        for tick in 0..8000 {
            let aborts = [300, 310, 2500].contains(&tick);
            if aborts {
                operator.abort();
            }
            if [1000, 3500].contains(&tick) {
                operator.resume();
                assert!(planner.is_at_rest() && planner.load(&b"N10 G91 G01 X100 F6000\nM30\n"[..]).is_ok());
            }
            while !matches!(planner.poll().expect("a program"), Progress::Waiting | Progress::Done) {}
            let state = interpolator.tick();
            let [x, _, _] = interpolator.set_points().map(Position::to_bits);
            let seen = operator.status().speed.to_bits() >> 26;
            if state == State::Active {
                // Path distance has finer bits than a set point.
                assert!(
                    (seen - (x - before)).abs() <= 1,
                    "slope {slope}, tick {tick}: {seen}, {}",
                    x - before
                );
                compared += 1;
            }
            before = x;
        }
        assert!(compared > 2000, "{compared}");
    }
}

//! Feed hold, resume and abort at any tick: inside all limits, on the path, exact at the end.
use glidepath::machine::MachineData;
use glidepath::quantity::Position;
use host_tests::cases::feeds::Feeds;
use host_tests::cases::random::{Mix, Random, program};
use host_tests::cases::{Program, machines};
use host_tests::check;
use host_tests::operate::{Act, Operated, POLLS, judge, operate, operate_text, random_acts, random_setup};
use host_tests::properties::permitted;

/// Corners of several angles, tangential transitions, an arc, an exact stop, short blocks.
fn track() -> Program {
    let mut program = Program::new("track", 3)
        .line(&[6.0, 0.0, 0.0], 9000.0)
        .line(&[12.0, 1.0, 0.0], 9000.0)
        .line(&[12.0, 8.0, 1.0], 6000.0)
        .line(&[5.0, 8.0, 1.0], 12_000.0);
    for k in 1..=12 {
        let x = 5.0 - 0.25 * f64::from(k);
        program = program.line(&[x, 8.0 + 0.01 * f64::from(k * k), 1.0], 9000.0);
    }
    program
        .line(&[-6.0, 9.44, 1.0], 9000.0)
        .arc(&[-8.0, 7.44, 1.0], [0.0, -2.0], false, 5000.0)
        .line(&[-8.0, 5.0, 0.0], 7000.0)
        .stop()
        .line(&[-6.0, 0.0, 0.0], 4000.0)
}

fn machine(slope: u8) -> MachineData<3> {
    let mut machine = machines::mill(1000);
    machine.channel.slope_profile = slope;
    machine
}

fn run(program: &Program, machine: &MachineData<3>, acts: &[(usize, Act)], polls: usize) -> Operated {
    operate::<3, 120>(program, machine, acts, polls)
        .and_then(|run| judge(program, machine, &run).map(|()| run))
        .unwrap_or_else(|fault| panic!("{}, {acts:?}, {polls} polls: {fault}", program.name))
}

/// A hold before each tick of the track, for longer than any stop takes.
fn every_tick(slope: u8, polls: usize, at_most: usize) {
    let (program, machine) = (track(), machine(slope));
    let ticks = run(&program, &machine, &[], polls).trace.len();
    let mut longest = 0;
    for tick in 0..ticks - 2 {
        let held = run(&program, &machine, &[(tick, Act::Hold), (tick + 1000, Act::Resume)], polls);
        let stood = *held.holds.first().unwrap_or_else(|| panic!("hold at {tick}: no standstill"));
        longest = longest.max(stood - tick);
        // It stays where it is until it is to go on.
        assert!(
            held.distances[stood..tick + 999].iter().all(|s| *s == held.distances[stood]),
            "hold at {tick}"
        );
    }
    println!("slope {slope}: {ticks} ticks, stands after {longest} at most");
    assert!(longest <= at_most, "slope {slope}: {longest}");
}

#[test]
fn trapez_at_every_tick() {
    every_tick(1, 1000, 285);
}

#[test]
fn hsc_at_every_tick() {
    every_tick(3, 1000, 341);
}

#[test]
fn sin2_at_every_tick() {
    every_tick(2, 1000, 288);
}

/// Rows: OP-01.
#[test]
fn step_at_every_tick() {
    every_tick(0, 1000, 197);
}

#[test]
fn a_hold_that_follows_a_hold_at_every_tick() {
    for slope in 0..4 {
        let (program, machine) = (track(), machine(slope));
        let ticks = run(&program, &machine, &[], 1000).trace.len();
        for tick in 0..ticks {
            // Resumed before it stands, and held again before or shortly after it goes on.
            let again = tick + 4 + 13 * (tick % 32);
            let acts =
                [(tick, Act::Hold), (tick + 3, Act::Resume), (again, Act::Hold), (again + 1000, Act::Resume)];
            run(&program, &machine, &acts, 1000);
        }
    }
}

#[test]
fn random_commands_in_random_programs() {
    // `cargo run --release -p host-tests --example operate -- 0 100000` goes on with it.
    for seed in host_tests::seeds::seeds(0..120, 12) {
        let mut machine = machines::arbitrary::<3>(seed);
        machine.channel.slope_profile = (seed % 4) as u8;
        let program = program(seed, Mix::arbitrary(3, seed));
        let ticks = operate::<3, 120>(&program, &machine, &[], 1000).expect("runs").trace.len();
        let mut random = Random::new(seed);
        for _ in 0..3 {
            let acts = random_acts(&mut random, ticks);
            let polls = POLLS[(random.bits() % 3) as usize];
            let first = run(&program, &machine, &acts, polls);
            let again = run(&program, &machine, &acts, polls);
            assert_eq!(first.trace, again.trace, "seed {seed}");
        }
    }
}

/// The way down of STEP has a law for each half of the speed. What is left behind the last of them is a tenth of a
/// nanometre, and far less than that was rounded at the first.
#[test]
fn what_is_left_of_a_way_in_halves_is_long_enough() {
    let (program, machine, _) = random_setup(11_091_388);
    for tick in 1300..1312 {
        run(&program, &machine, &[(tick, Act::Hold), (tick + 20, Act::Resume)], 12);
    }
}

/// Of several feeds, of which the slow ones would take 30 times as long as planned for the rest.
fn feeds(name: &str, far: [[f64; 3]; 2]) -> Program {
    let mut program = Program::new(name, 3)
        .line(&[0.02, 0.0, 0.0], 20.0)
        .line(&[0.04, 0.0, 0.0], 400.0)
        .line(&far[0], 12_000.0)
        .line(&far[1], 400.0);
    program.optimised = true;
    program
}

/// So many ticks longer than without it any hold of 300 ticks makes the program, at one of these overrides. The second
/// of them counts from the fifth tick on: the plan may be for more than the override of now.
fn longest_hold(program: &Program, [first, then]: [u16; 2]) -> usize {
    let machine = machine(3);
    let begins = [(0, Act::Override(first)), (5, Act::Override(then))];
    let alone = run(program, &machine, &begins, 1000).trace.len();
    let held = |tick| [begins.as_slice(), &[(tick, Act::Hold), (tick + 300, Act::Resume)]].concat();
    let longer = |tick| run(program, &machine, &held(tick), 1000).trace.len() - alone;
    (6..alone).step_by(3).map(longer).max().unwrap_or(0)
}

/// What is left of a span of HSC goes on as fast as planned, wherever the hold was: where it speeds up, though it began
/// at some speed, where it is fastest, and where it slows down.
#[test]
fn a_hold_in_a_span_of_several_feeds_leaves_it_as_fast() {
    let program = feeds("feeds", [[40.0, 0.0, 0.0], [40.02, 0.0, 0.0]]).line(&[40.04, 0.0, 0.0], 20.0);
    for over in [[1000, 1000], [600, 600], [1000, 500], [1200, 1000]] {
        let longer = longest_hold(&program, over);
        assert!(longer < 550, "{over:?}: {longer}");
    }
}

/// The same in a span that ends at speed.
#[test]
fn a_hold_in_a_span_that_ends_at_speed_leaves_it_as_fast() {
    let program = feeds("gains", [[2.0, 0.0, 0.0], [2.5, 0.1, 0.0]]).line(&[20.0, 3.0, 0.0], 12_000.0);
    for over in [[1000, 1000], [600, 600]] {
        let longer = longest_hold(&program, over);
        assert!(longer < 500, "{over:?}: {longer}");
    }
}

/// Where a law uses less deceleration than permitted, a standstill and a change of pace use all of it.
#[test]
fn random_commands_along_changing_feeds() {
    for number in [30, 55, 58, 113, 120, 126, 192, 198] {
        let program = Feeds::new(number).program(format!("feeds {number}"), 3);
        let machine = machine(3);
        let ticks = operate::<3, 120>(&program, &machine, &[], 1000).expect("runs").trace.len();
        let mut random = Random::new(number);
        for _ in 0..40 {
            run(&program, &machine, &random_acts(&mut random, ticks), 1000);
        }
    }
}

#[test]
fn abort_stands_still_on_the_path_and_stays() {
    let (program, machine) = (track(), machine(1));
    let whole = run(&program, &machine, &[], 1000);
    for tick in (0..whole.trace.len()).step_by(7) {
        let aborted = run(&program, &machine, &[(tick, Act::Abort)], 1000);
        let held = run(&program, &machine, &[(tick, Act::Hold), (tick + 1000, Act::Resume)], 1000);
        // The way to the standstill is that of a hold.
        let rows = aborted.trace.len();
        assert!(rows <= tick + 320, "abort at {tick}: {rows} rows");
        for row in 0..rows.min(held.trace.len()) {
            assert!(aborted.trace.row(row).eq(held.trace.row(row)), "abort at {tick}: row {row}");
        }
    }
}

#[test]
fn a_dwell_runs_on_in_a_hold_and_is_never_shorter() {
    let machine = machine(1);
    let text = "G04 X0.05\nG01 X3 F6000\nG04 X0.2\nM5\nG04 X0.1\nG01 X5 Y1\nM30\n";
    let start = [Position::ZERO; 3];
    let limits: Vec<_> = machine
        .axes
        .iter()
        .map(|axis| permitted(axis, machine.channel.slope_profile, false, true, false))
        .collect();
    let go = |acts: &[(usize, Act)]| {
        let run = operate_text::<3, 120>(text, start, &machine, acts, 1000)
            .unwrap_or_else(|fault| panic!("{acts:?}: {fault}"));
        check::limits(&run.trace, &limits).unwrap_or_else(|fault| panic!("{acts:?}: {fault}"));
        let last: Vec<i64> = run.trace.row(run.trace.len() - 1).collect();
        assert_eq!(last, [5 << 32, 1 << 32, 0], "{acts:?}");
        // Ticks at rest in X3.
        (run.trace.columns[0].iter().filter(|x| **x == 3 << 32).count(), run)
    };
    let (rest, whole) = go(&[]);
    assert!((300..=302).contains(&rest), "{rest}");
    for tick in 0..whole.trace.len() - 2 {
        let (held, run) = go(&[(tick, Act::Hold), (tick + 600, Act::Resume)]);
        let stood = *run.holds.first().unwrap_or_else(|| panic!("hold at {tick}: no standstill"));
        assert!(run.trace.row(stood).eq(run.trace.row(tick + 599)), "hold at {tick}");
        assert!(held >= rest, "hold at {tick}: {held}");
        // What is behind the dwell waits.
        let stays = |tick: usize| whole.trace.row(tick).next() == Some(3 << 32);
        if stays(tick) && stays((tick + 8).min(whole.trace.len() - 1)) {
            assert_eq!(run.trace.row(tick + 599).next(), Some(3 << 32), "hold at {tick}");
        }
    }
}

#[test]
fn an_abort_ends_a_dwell() {
    let text = "G01 X3 F6000\nG04 X200\nM5\nG04 X0.1\nG01 X5 Y1\nM30\n";
    for slope in 0..4 {
        let go = |acts: &[(usize, Act)]| {
            let machine = machine(slope);
            let run = operate_text::<3, 120>(text, [Position::ZERO; 3], &machine, acts, 1000);
            run.unwrap_or_else(|fault| panic!("slope {slope}, {acts:?}: {fault}")).trace.len()
        };
        let moves = go(&[(1, Act::Hold), (1, Act::Abort)]).max(400);
        for tick in [1, 20, 100, 150, 200, moves, moves + 1, 5000, 70_000] {
            let all = go(&[(tick, Act::Abort)]);
            assert!(all <= tick + 400 && (tick < moves || all <= tick + 10), "slope {slope}: {tick}, {all}");
            // A hold before it, and a second one.
            let all = go(&[(tick, Act::Hold), (tick + 5, Act::Abort)]);
            assert!(all <= tick + 405, "slope {slope}: {tick}, {all}");
        }
    }
}

#[test]
fn a_hold_keeps_the_corners_of_contour_mode() {
    // Corners of lines and arcs, one held back while the operator acts, and one at the end of the program.
    let text = "%c\n#CONTOUR MODE [DEV PATH_DEV=0.5]\nN10 G01 X6 G261 F9000\nN20 Y5\nN30 X9 Y7 M7\nN40 G02 X13 Y7 I2 J0\n\
        N50 G01 X13.5\nN60 Y2\nN70 G260 X20\nM30\n";
    let start = [Position::ZERO; 3];
    for slope in 0..4 {
        let machine = machine(slope);
        let go = |acts: &[(usize, Act)], polls| {
            operate_text::<3, 120>(text, start, &machine, acts, polls)
                .unwrap_or_else(|fault| panic!("slope {slope}, {acts:?}: {fault}"))
        };
        let limits: Vec<_> =
            machine.axes.iter().map(|axis| permitted(axis, slope, false, true, true)).collect();
        let whole = go(&[], 1000);
        let (rows, length) = (whole.trace.len(), *whole.distances.last().expect("it moves"));
        let end: Vec<i64> = whole.trace.row(rows - 1).collect();
        for tick in (0..rows - 2).step_by(5) {
            // Few calls: the corner is still held back when the command comes.
            for polls in [3, 1000] {
                let acts = [(tick, Act::Hold), (tick + 1000, Act::Resume)];
                let held = go(&acts, polls);
                check::limits(&held.trace, &limits)
                    .unwrap_or_else(|fault| panic!("slope {slope}, {acts:?}, {polls} polls: {fault}"));
                assert!(held.trace.row(held.trace.len() - 1).eq(end.iter().copied()), "{acts:?}");
                // The same curves: not a bit of path is lost.
                assert_eq!(held.distances.last(), Some(&length), "slope {slope}, {acts:?}, {polls} polls");
                let aborted = go(&[(tick, Act::Abort)], polls);
                check::limits(&aborted.trace, &limits)
                    .unwrap_or_else(|fault| panic!("slope {slope}, abort at {tick}, {polls} polls: {fault}"));
                // Curves over time leave less to the brake.
                let most = if slope == 3 { 500 } else { 400 };
                assert!(aborted.trace.len() <= tick + most, "slope {slope}, abort at {tick}");
            }
        }
    }
}

#[test]
fn a_hold_in_a_curve_over_time_keeps_the_limits() {
    // Slope and contour have the same jerk: nothing is left over but what the curve leaves.
    let mut machine = machines::even::<3>(1000);
    machine.channel.slope_profile = 3;
    for axis in &mut machine.axes {
        (axis.vb_max, axis.vb_eilgang) = (1_000_000, 1_000_000);
    }
    let limits: Vec<_> = machine.axes.iter().map(|axis| permitted(axis, 3, false, true, true)).collect();
    for (dev, y, most) in [("0.1", 80, 1300), ("0.5", 20, 1300), ("0.02", 3, 1000)] {
        let text = format!(
            "%c\n#CONTOUR MODE [DEV PATH_DEV={dev}]\nN10 G01 X80 G261 F20000\nN20 X100 Y{y}\nN30 X0 Y{y}\nN40 Y0\n\
             N50 G260 X-20\nM30\n"
        );
        let go = |acts: &[(usize, Act)]| {
            operate_text::<3, 120>(&text, [Position::ZERO; 3], &machine, acts, 1000)
                .unwrap_or_else(|fault| panic!("{acts:?}: {fault}"))
        };
        let whole = go(&[]);
        let (rows, length) = (whole.trace.len(), *whole.distances.last().expect("it moves"));
        let end: Vec<i64> = whole.trace.row(rows - 1).collect();
        for tick in (0..rows - 2).step_by(7) {
            let acts = [(tick, Act::Hold), (tick + 2000, Act::Resume)];
            let held = go(&acts);
            check::limits(&held.trace, &limits).unwrap_or_else(|fault| panic!("{dev}, {acts:?}: {fault}"));
            assert!(held.trace.row(held.trace.len() - 1).eq(end.iter().copied()), "{acts:?}");
            assert_eq!(held.distances.last(), Some(&length), "{acts:?}");
            let aborted = go(&[(tick, Act::Abort)]);
            assert!(
                aborted.trace.len() <= tick + most,
                "{dev}: abort at {tick} of {rows}: {}",
                aborted.trace.len()
            );
        }
    }
}

//! Override and reduced speed at any tick: the speed of P-CHAN-00066, inside all limits, on the path.
use glidepath::machine::{ChannelData, MachineData};
use glidepath::quantity::Position;
use host_tests::cases::{Program, machines};
use host_tests::check;
use host_tests::operate::{
    Act, Crawled, Operated, POLLS, crawl, judge, operate, operate_text, random_setup, with_overrides,
};
use host_tests::properties::permitted;

fn run(program: &Program, machine: &MachineData<3>, acts: &[(usize, Act)], polls: usize) -> Operated {
    operate::<3, 120>(program, machine, acts, polls)
        .and_then(|run| judge(program, machine, &run).map(|()| run))
        .unwrap_or_else(|fault| panic!("{}, {acts:?}, {polls} polls: {fault}", program.name))
}

/// Path speed at each tick, mm/min.
fn speeds(run: &Operated) -> Vec<f64> {
    let per_minute = 60.0 / run.trace.cycle / 2.0_f64.powi(44);
    run.distances.windows(2).map(|w| w[1].wrapping_sub(w[0]) as f64 * per_minute).collect()
}

/// Ticks within which a change of speed is complete: a command is seen a tick later, acts four ticks behind
/// that, and the change itself takes no longer than from standstill to the highest speed.
const REACTION: usize = 5;

/// Rows: D3-263, D3-266, D3-268, CF-02.
#[test]
fn worked_table_of_p_chan_00066() {
    // D3-267: v_max 50, v_prog 80, v_red 5 m/min, override 50 %.
    let table = [
        (0, true, 2.5),
        (0, false, 25.0),
        (1, true, 5.0),
        (1, false, 40.0),
        (2, true, 5.0),
        (2, false, 25.0),
    ];
    for (mode, reduced, m_min) in table {
        let mut machine = machines::mill::<3>(1000);
        machine.channel.override_weight_prog_feed = mode;
        (machine.axes[0].vb_max, machine.axes[0].vb_eilgang) = (833_333, 833_333);
        machine.axes[0].vb_max_red = 83_333;
        let program = Program::new("table", 3).line(&[900.0, 0.0, 0.0], 80_000.0);
        let acts = [(0, Act::Override(500)), (0, Act::Reduced(reduced))];
        let fastest = speeds(&run(&program, &machine, &acts, 1000)).into_iter().fold(0.0, f64::max);
        let part = fastest / (m_min * 1000.0);
        assert!((0.9999..=1.0).contains(&part), "mode {mode}, reduced {reduced}: {fastest} mm/min");
    }
}

/// P-AXIS-00214 is a limit: an override above 100 % does not lift it, in any mode and with any slope.
#[test]
fn an_override_above_100_does_not_lift_the_reduced_speed() {
    for slope in 0..4 {
        for mode in 0..3 {
            for over in [1000, 1010, 1500, 2000] {
                let mut machine = machines::with_slope(machines::mill::<3>(1000), slope);
                machine.channel.override_weight_prog_feed = mode;
                machine.axes[0].vb_max_red = 83_333;
                let program = Program::new("reduced", 3).line(&[300.0, 0.0, 0.0], 20_000.0);
                for acts in [
                    vec![(0, Act::Override(over)), (0, Act::Reduced(true))],
                    vec![(0, Act::Reduced(true)), (500, Act::Override(over))],
                ] {
                    let fastest =
                        speeds(&run(&program, &machine, &acts, 1000)).into_iter().fold(0.0, f64::max);
                    let part = fastest / 5000.0;
                    assert!(
                        (0.9998..=1.0).contains(&part),
                        "slope {slope}, mode {mode}, {acts:?}: {fastest} mm/min"
                    );
                }
            }
        }
    }
}

/// P-AXIS-00214 is a speed of each axis: the path is as fast as the axis that reaches its own first, and an axis
/// with 0 has none.
#[test]
fn the_reduced_speed_is_that_of_the_axis_that_reaches_it_first() {
    for (reduced, m_min) in
        [([0, 83_333], 6.25), ([83_333, 0], 25.0 / 3.0), ([50_000, 83_333], 5.0), ([83_333, 50_000], 3.75)]
    {
        let mut machine = machines::mill::<3>(1000);
        for (axis, reduced) in machine.axes.iter_mut().zip(reduced) {
            axis.vb_max_red = reduced;
        }
        let program = Program::new("slanting", 3).line(&[180.0, 240.0, 0.0], 20_000.0);
        let run = run(&program, &machine, &[(0, Act::Reduced(true))], 1000);
        let part = speeds(&run).into_iter().fold(0.0, f64::max) / (m_min * 1000.0);
        assert!((0.9998..=1.000_001).contains(&part), "{reduced:?} µm/s: {part} of {m_min} m/min");
    }
}

/// The lowest P-AXIS-00214 (1 µm/s) beside high speeds: the motion goes on, as slow as that.
#[test]
fn a_reduced_speed_far_below_the_feed_is_no_standstill() {
    for slope in 0..4 {
        for v in [1, 10, 100] {
            let mut machine = machines::with_slope(machines::mill::<3>(1000), slope);
            machine.axes[0].vb_max_red = v;
            let length = f64::from(v) * 5e-3;
            let program = Program::new("crawl", 3)
                .line(&[length, 0.0, 0.0], 60_000.0)
                .line(&[-length, 0.0, 0.0], 60_000.0);
            let fastest = speeds(&run(&program, &machine, &[(0, Act::Reduced(true))], 1000));
            let part = fastest.into_iter().fold(0.0, f64::max) / (f64::from(v) * 0.06);
            assert!((0.98..=1.001).contains(&part), "slope {slope}, {v} µm/s: {part}");
        }
    }
}

/// At 1 µm/s a block of a metre takes eleven days.
#[test]
fn a_block_too_long_for_the_reduced_speed_is_refused() {
    let mut machine = machines::mill::<3>(1000);
    machine.axes[0].vb_max_red = 1;
    let program = Program::new("crawl", 3).line(&[1000.0, 0.0, 0.0], 60_000.0);
    let acts = [(0, Act::Reduced(true))];
    let fault = operate::<3, 120>(&program, &machine, &acts, 1000).expect_err("too slow");
    assert!(fault.ends_with("ReducedTooSlow"), "{fault}");
}

#[test]
fn override_acts_inside_a_block_downward_and_upward() {
    for slope in 0..4 {
        let machine = machines::with_slope(machines::mill::<3>(1000), slope);
        let program = Program::new("long", 3).line(&[6000.0, 0.0, 0.0], 20_000.0);
        // Every change comes when the one before is complete, or in the middle of it.
        for wait in [1500, 60] {
            let steps = [1000, 300, 1500, 1490, 50, 2000, 900, 1000];
            let acts: Vec<_> =
                steps.iter().enumerate().map(|(k, f)| (500 + k * wait, Act::Override(*f))).collect();
            let run = run(&program, &machine, &acts, 12);
            let v = speeds(&run);
            if wait == 60 {
                continue;
            }
            for (k, over) in steps.iter().enumerate() {
                let wanted = 20.0 * f64::from(*over);
                // 2 m/s² and 1.5 m/s² at least, and ramps of 60 to 90 ms.
                let settled = 500 + k * wait + REACTION + 900;
                let seen = &v[settled..500 + (k + 1) * wait];
                let off = seen.iter().map(|v| (v / wanted - 1.0).abs()).fold(0.0, f64::max);
                assert!(off < 1e-4, "slope {slope}, step {k}: {} for {wanted}", seen[0]);
            }
            // 100 % to 30 %: the slowing down begins within the reaction.
            let at = 500 + wait;
            assert!(v[at + REACTION + 2] < v[at], "slope {slope}");
        }
    }
}

#[test]
fn constant_override_costs_no_more_than_the_same_feed() {
    for slope in 0..4 {
        let machine = machines::with_slope(machines::mill::<3>(1000), slope);
        let track = |factor: f64| {
            let mut program = Program::new("track", 3);
            for k in 0..40 {
                let x = f64::from(k) * 3.0;
                let y = [0.0, 0.8, 1.1, 0.4][k as usize % 4];
                let f = [9000.0, 6000.0, 12_000.0][k as usize % 3];
                program = program.line(&[x, y, 0.0], f * factor);
            }
            program
        };
        let half = run(&track(1.0), &machine, &[(0, Act::Override(500))], 1000).trace.len();
        let same = run(&track(0.5), &machine, &[], 1000).trace.len();
        println!("slope {slope}: {half} ticks at 50 %, {same} at half the feed");
        // Planned for 100 %, run at half: acceleration may vanish at more places than needed.
        assert!(half as f64 <= same as f64 * 1.05, "slope {slope}: {half} ticks, {same} at half the feed");
        let double = run(&track(1.0), &machine, &[(0, Act::Override(2000))], 1000).trace.len();
        let same = run(&track(2.0), &machine, &[], 1000).trace.len();
        println!("slope {slope}: {double} ticks at 200 %, {same} at twice the feed");
        assert!(
            double as f64 <= same as f64 * 1.05,
            "slope {slope}: {double} ticks, {same} at twice the feed"
        );
    }
}

/// Rows: OP-02.
#[test]
fn a_change_at_every_tick() {
    for slope in 0..4 {
        let machine = machines::with_slope(machines::mill::<3>(1000), slope);
        let mut program = Program::new("track", 3)
            .line(&[6.0, 0.0, 0.0], 9000.0)
            .line(&[12.0, 1.0, 0.0], 9000.0)
            .line(&[12.0, 8.0, 1.0], 6000.0);
        for k in 1..=12 {
            let x = 12.0 - 0.25 * f64::from(k);
            program = program.line(&[x, 8.0 + 0.01 * f64::from(k * k), 1.0], 9000.0);
        }
        program =
            program.arc(&[7.0, 7.44, 1.0], [0.0, -2.0], false, 5000.0).stop().line(&[0.0, 0.0, 0.0], 7000.0);
        let ticks = run(&program, &machine, &[], 12).trace.len();
        for tick in 0..ticks {
            let low = [200, 640, 990][tick % 3];
            let acts = [
                (tick, Act::Override(low)),
                (tick + 90, Act::Override(1700)),
                (tick + 150, Act::Override(1000)),
            ];
            run(&program, &machine, &acts, POLLS[tick % 2]);
        }
    }
}

/// Spans of several blocks, and corners, in which axes have different reduced speeds.
#[test]
fn no_axis_is_faster_than_its_reduced_speed() {
    let mut machine = machines::mill::<3>(1000);
    machine.channel.ptp = true;
    let reduced = [100.0, 60.0, 50.0];
    for (axis, v) in machine.axes.iter_mut().zip(reduced) {
        axis.vb_max_red = (v * 1e3) as u32;
    }
    let corners = "G01 X50 F20000\nG01 X100\nY50\nX0 Y0 Z3\nX-1\nX-1.5 Z5\nG260 X-100\nM30\n";
    let mut texts = vec!["%s\nG01 Y1 F6000\nY100 F20000\nY100.5 Z0.3\nX3 Z40\nM30\n".to_owned()];
    for mode in
        ["DEV PATH_DEV=0.1", "PTP PATH_DEV=0.1", "DIST_SOFT PATH_DIST=3", "DIST PRE_DIST=2 POST_DIST=1"]
    {
        texts.push(format!("%c\n#CONTOUR MODE ON [{mode}]\n{corners}"));
    }
    // Steps, one slow block in seven, with ten blocks known at a time: it leaves when the ones behind it are
    // fast.
    let steps: String = (1..=40).map(|k| if k % 7 == 0 { "Y30\n" } else { "X30\n" }).collect();
    texts.push(format!("%h\nG91 G01 F20000\n{steps}M30\n"));
    let few = MachineData { channel: ChannelData { look_ahead: 10, ..machine.channel }, ..machine };
    for slope in ["TRAPEZ", "SIN2", "STEP", "HSC NO_OPT=1", "HSC NO_OPT=0"] {
        for text in &texts {
            let machine = if text.starts_with("%h") { &few } else { &machine };
            let text = text.replacen('\n', &format!("\n#SLOPE [TYPE={slope}]\n"), 1);
            let acts = [(0, Act::Reduced(true))];
            let run = operate_text::<3, 120>(&text, [Position::ZERO; 3], machine, &acts, 1000).unwrap();
            for (axis, limit) in reduced.into_iter().enumerate() {
                let x: Vec<f64> = (0..run.trace.len()).map(|k| run.trace.mm(k)[axis]).collect();
                let fastest = x.windows(2).map(|w| (w[1] - w[0]).abs() / 0.001).fold(0.0, f64::max);
                assert!(fastest <= limit * 1.000_01, "axis {axis}: {fastest} of {limit} mm/s\n{text}");
            }
        }
    }
}

/// At 0.1 % for a while: 100 mm with F10 would take a week.
#[test]
fn a_knob_turned_nearly_to_zero_is_turned_up_again() {
    for slope in 0..4 {
        let machine = machines::with_slope(machines::mill::<3>(1000), slope);
        let program = Program::new("slow", 3).line(&[100.0, 0.0, 0.0], 10.0).line(&[100.0, 1.0, 0.0], 2000.0);
        for down in [0, 300] {
            let acts =
                [(down, Act::Override(1)), (down + 700, Act::Override(2)), (down + 900, Act::Override(2000))];
            let v = speeds(&run(&program, &machine, &acts, 1000));
            let nearly = &v[down + 300..down + 690];
            assert!(nearly.iter().all(|v| (0.01..0.1).contains(v)), "slope {slope}: {:?}", nearly.first());
        }
    }
}

#[test]
fn override_of_zero_holds() {
    let machine = machines::mill::<3>(1000);
    let program = Program::new("long", 3).line(&[100.0, 0.0, 0.0], 6000.0);
    let acts = [(300, Act::Override(0)), (1500, Act::Override(400)), (2000, Act::Override(1000))];
    let run = run(&program, &machine, &acts, 12);
    assert_eq!(run.holds.len(), 1);
    assert!(run.distances[run.holds[0]..1499].iter().all(|s| *s == run.distances[run.holds[0]]));
    assert!(speeds(&run)[1501..1999].iter().all(|v| *v <= 2400.0 * 1.0001));
}

#[test]
fn random_overrides_in_random_programs() {
    // `cargo run --release -p host-tests --example operate -- 0 100000` goes on with it, and with holds
    // between them.
    for seed in host_tests::seeds::seeds(0..150, 15) {
        let (program, machine, mut random) = random_setup(seed);
        let acts = with_overrides(&mut random, 3000, Vec::new());
        let polls = POLLS[(random.bits() % 3) as usize];
        let first = run(&program, &machine, &acts, polls);
        assert_eq!(first.trace, run(&program, &machine, &acts, polls).trace, "seed {seed}");
    }
}

/// The last span known is cut by a slowing down, what is left of it ends slower than planned, and then the
/// override rises before the interrupt is there: the whole span gets a law again, and has to be able to slow
/// down to that end.
#[test]
fn a_law_taken_back_can_reach_an_end_made_slower() {
    let machine = machines::with_slope(machines::examples::<3>(4000), 1);
    let text = "N30 G00 Y15.2198\nN60 X27.4226 Y58.5139\nN70 #CONTOUR MODE ON [DIST PRE_DIST=1.2447 POST_DIST=0.4085]\n\
                N80 G02 X10.3037 Y43.2598 R13.5098 F1408\nN90 I16.5337 F1772\nN100 G00 X18.8151\nM30\n";
    let acts = [(468, Act::Override(276)), (1973, Act::Override(52)), (7544, Act::Override(1000))];
    let run = operate_text::<3, 120>(text, [Position::ZERO; 3], &machine, &acts, 1000).unwrap();
    let limits: Vec<_> = machine.axes.iter().map(|axis| permitted(axis, 1, true, true, true)).collect();
    check::limits(&run.trace, &limits).unwrap();
    let end = [18.8151_f64, 43.2598, 0.0].map(|x| (x * 4_294_967_296.0).round() as i64);
    assert!(run.trace.row(run.trace.len() - 1).eq(end));
}

/// STEP with less deceleration below the change-over speed (P-AXIS-00221) than above it: what a higher override had
/// planned above that speed is not possible at a part of its speed, below it.
#[test]
fn a_lower_override_finds_less_deceleration_below_the_change_over_speed() {
    let (program, machine, _) = random_setup(3_002_796);
    let acts = [(1083, Act::Reduced(true)), (1489, Act::Override(1040)), (2436, Act::Override(924))];
    run(&program, &machine, &acts, 40);
}

/// Rapid motion has no feed to go beyond: above 100 % it stays as fast as the axes allow in curves too, and
/// below it is slower.
#[test]
fn the_override_does_not_raise_rapid_motion_in_curves() {
    let text =
        "N120 #CONTOUR MODE [DEV PATH_DEV=0.5]\nN130 G261\nN180 G01 X30 F600\nN200 G00 Y20\nN210 X60\nM30\n";
    for (mode, slope) in (0..3).flat_map(|mode| (0..4).map(move |slope| (mode, slope))) {
        let mut machine = machines::even::<3>(1000);
        for axis in &mut machine.axes {
            (axis.vb_max, axis.vb_eilgang) = (20_000, 20_000);
        }
        machine = machines::with_slope(machine, slope);
        machine.channel.override_weight_prog_feed = mode;
        let limits: Vec<_> =
            machine.axes.iter().map(|axis| permitted(axis, slope, true, true, true)).collect();
        let ticks = [500, 1000, 1482, 2000].map(|over| {
            let acts = [(1, Act::Override(over))];
            let run = operate_text::<3, 120>(text, [Position::ZERO; 3], &machine, &acts, 1000).unwrap();
            check::limits(&run.trace, &limits)
                .unwrap_or_else(|fault| panic!("{mode} {slope} {over}: {fault}"));
            run.trace.len()
        });
        assert!(
            ticks.is_sorted_by(|slower, faster| slower >= faster),
            "mode {mode}, slope {slope}: {ticks:?}"
        );
    }
}

/// With HSC, where the override counts for the programmed feed alone, the look-ahead follows it down and up:
/// nothing of it stays slow.
#[test]
fn an_override_that_fell_leaves_nothing_slow_behind() {
    for seed in (7..400).step_by(12).chain([499, 847, 1183, 1375]) {
        let (program, machine, _) = random_setup(seed);
        assert_eq!((machine.channel.slope_profile, machine.channel.override_weight_prog_feed), (3, 1));
        let alone = run(&program, &machine, &[], 1000).distances.len();
        let dips = (0..12).map(|k| 50 + 100 * k);
        let acts: Vec<_> =
            dips.flat_map(|at| [(at, Act::Override(1)), (at + 40, Act::Override(1000))]).collect();
        let ticks = run(&program, &machine, &acts, 1000).distances.len();
        // What the changes to and fro take.
        assert!(2 * ticks < 3 * alone + 2 * 12 * 100, "seed {seed}: {ticks} ticks, alone {alone}");
    }
}

/// Nearly to a standstill and back, a few times. With the seeds that come last a span kept the speed of the
/// crawl: one whose law was slowing down at it, and one that was entered slower than planned.
#[test]
fn behind_a_crawl_it_is_as_fast_as_before() {
    let mut tried = 0;
    for seed in host_tests::seeds::seeds((0..60).chain([4819, 8179, 11_799]), 8) {
        match crawl(seed) {
            Crawled::Good => tried += 1,
            Crawled::Long => {}
            Crawled::Fault(fault) => panic!("seed {seed}: {fault}"),
        }
    }
    assert!(tried > 20, "{tried}");
}

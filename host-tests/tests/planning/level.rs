//! The ring is planned for the current override: the table of P-CHAN-00066 in every block, and no effect of
//! an earlier override.
use glidepath::machine::{AxisData, AxisKind, AxisName, ChannelData, MachineData, Synch, SynchTable};
use glidepath::quantity::Position;
use host_tests::cases::{Program, machines};
use host_tests::check;
use host_tests::operate::{Act, Operated, judge, operate, operate_text};
use host_tests::properties::permitted;

fn run(program: &Program, machine: &MachineData<3>, acts: &[(usize, Act)]) -> Operated {
    operate::<3, 120>(program, machine, acts, 1000)
        .and_then(|run| judge(program, machine, &run).map(|()| run))
        .unwrap_or_else(|fault| panic!("{}, {acts:?}: {fault}", program.name))
}

/// A slope with a mode of P-CHAN-00066.
fn mill(slope: u8, mode: u8) -> MachineData<3> {
    let mut machine = machines::with_slope(machines::mill::<3>(1000), slope);
    machine.channel.override_weight_prog_feed = mode;
    machine
}

/// 2^-44 mm.
fn mm(distance: i64) -> f64 {
    distance as f64 / 2f64.powi(44)
}

/// Length of a block, mm, and feeds of two that take turns, mm/min; a block in the middle of a change has no
/// steady speed.
const LENGTH: f64 = 600.0;
const FEEDS: [f64; 2] = [80_000.0, 20_000.0];
const BLOCKS: usize = 24;
/// What the machine permits, mm/min.
const V_MAX: f64 = 50_000.0;

/// Highest speed in every block, mm/min.
fn fastest(run: &Operated) -> Vec<f64> {
    let mut fastest = vec![0.0_f64; BLOCKS];
    let at = |tick: usize| mm(run.distances[tick].wrapping_sub(run.distances[0]));
    for tick in 1..run.distances.len() {
        let (before, now) = (at(tick - 1), at(tick));
        let [first, last] = [before + 1e-6, now - 1e-6].map(|s| (s / LENGTH) as usize);
        if first == last && last < BLOCKS {
            fastest[last] = fastest[last].max((now - before) / run.trace.cycle * 60.0);
        }
    }
    fastest
}

/// D3-264 to D3-267 with an override from the start, and after another one: every block of a span reaches
/// what the table says.
///
/// Rows: D3-265.
#[test]
fn every_block_has_the_speed_of_the_table() {
    for (slope, optimised) in [(0, false), (1, false), (2, false), (3, false), (3, true)] {
        for mode in 0..3 {
            let mut machine = mill(slope, mode);
            for axis in &mut machine.axes {
                (axis.vb_max, axis.vb_eilgang) = (833_333, 833_333);
            }
            let mut program = Program::new("turns", 3);
            for k in 0..BLOCKS {
                program = program.line(&[(k + 1) as f64 * LENGTH], FEEDS[k % 2]);
            }
            program.optimised = optimised;
            for over in [500, 800, 1000, 1500] {
                for before in [1000, 1500, 600] {
                    let acts = [(0, Act::Override(before)), (2000, Act::Override(over))];
                    let run = run(&program, &machine, &acts);
                    let part = f64::from(over) / 1000.0;
                    // So far it may be the law of before.
                    let changed = mm(run.distances[2000].wrapping_sub(run.distances[0])) / LENGTH;
                    for (k, v) in fastest(&run).into_iter().enumerate().skip(changed as usize + 8) {
                        let feed = FEEDS[k % 2];
                        let wanted = match mode {
                            1 => (feed * part).min(V_MAX),
                            _ => (feed.min(V_MAX) * part).min(V_MAX),
                        };
                        assert!(
                            (0.9999..=1.000_001).contains(&(v / wanted)),
                            "slope {slope}, NO_OPT=0 {optimised}, mode {mode}, {before} to {over}, block {k}: {v} for {wanted}"
                        );
                    }
                }
            }
        }
    }
}

/// Blocks of changing feeds, and corners.
fn track(count: usize) -> Program {
    let mut program = Program::new("track", 3);
    let mut x = 0.0;
    for k in 0..count {
        x += [3.0, 6.0, 1.0, 4.0, 2.0][k % 5];
        let feed = [9000.0, 4000.0, 12_000.0, 6000.0][k % 4];
        let y = if k % 7 < 4 { 0.0 } else { [0.4, 1.0, 0.6][k % 3] };
        program = program.line(&[x, y, 0.0], feed);
    }
    program
}

/// Ticks from where the path distance `from` is passed to the end.
fn rest(run: &Operated, from: i64) -> usize {
    let start = run.distances[0];
    let at = run.distances.iter().position(|s| s.wrapping_sub(start) >= from).expect("on the way");
    run.trace.len() - at
}

#[test]
fn nothing_is_left_of_a_higher_override() {
    for optimised in [false, true] {
        let program = Program { optimised, ..track(300) };
        for mode in 0..3 {
            let machine = mill(3, mode);
            for back in [1000, 800] {
                let steady = run(&program, &machine, &[(0, Act::Override(back))]);
                let acts =
                    [(0, Act::Override(back)), (500, Act::Override(1500)), (1500, Act::Override(back))];
                let changed = run(&program, &machine, &acts);
                // A second behind the change there are blocks that were planned for another override; later
                // there are none. Which anchors a trial removes depends a little on the blocks in the ring.
                for (tick, tolerance) in [(2500, 0.01), (20_000, 0.003)] {
                    let from = changed.distances[tick].wrapping_sub(changed.distances[0]);
                    let [changed, steady] = [&changed, &steady].map(|run| rest(run, from));
                    println!("NO_OPT=0 {optimised}, mode {mode}, {back}: {changed} ticks, {steady} without");
                    assert!(
                        changed as f64 <= steady as f64 * (1.0 + tolerance),
                        "NO_OPT=0 {optimised}, mode {mode}, {back}: {changed} ticks, {steady} without"
                    );
                }
            }
        }
    }
}

/// Where speeds change so little from block to block that rounding what is planned would be more, a lower level is
/// as possible as the one before: the plan of single blocks slows down through all of them.
#[test]
fn a_lower_level_is_possible_through_the_shortest_blocks() {
    for (slope, length, feed) in [0, 1, 2, 3]
        .into_iter()
        .flat_map(|slope| [(0.002, 4000.0), (0.02, 20_000.0)].map(|(l, f)| (slope, l, f)))
    {
        let machine = mill(slope, 1);
        let mut program = Program::new("shortest", 3);
        for k in 1..=1500 {
            // Turns that show nothing, and keep lines from becoming one.
            program = program.line(&[k as f64 * length, f64::from(k % 2) * 3e-6, 0.0], feed);
        }
        for tick in [20, 60, 150, 300] {
            for (high, low) in [(2000, 1990), (1500, 700), (1000, 250)] {
                let acts = [
                    (0, Act::Override(high)),
                    (tick, Act::Override(low)),
                    (tick + 70, Act::Override(high)),
                    (tick + 140, Act::Override(low)),
                ];
                let _ = run(&program, &machine, &acts);
            }
        }
    }
}

/// A mill of three unequal axes, whose look-ahead waits at M3 for an acknowledgement.
fn uneven_mill(slope: u8) -> MachineData<3> {
    let axis = |name: &str, a: u32, v: u32| AxisData {
        a_max: a,
        a_beschl: a,
        a_brems: a,
        a_grenz: a,
        a_stufe: [a, a / 2],
        a_grenz_stufe: [a, a / 2],
        vb_max: v,
        vb_eilgang: v,
        vb_max_red: v / 8,
        tr_geom: 50_000,
        tr_grenz: 50_000,
        tr_min: 10_000,
        ..AxisData::new(AxisName::new(name).expect("a name"), AxisKind::Linear)
    };
    MachineData {
        axes: [axis("X", 2000, 300_000), axis("Y", 1500, 250_000), axis("Z", 800, 100_000)],
        channel: ChannelData {
            cycle_us: 1000,
            slope_profile: slope,
            corr_v_trans_jerk: true,
            surface: true,
            m_synch: SynchTable::NONE.with(3, Synch::MvsSvs),
            ..ChannelData::new()
        },
    }
}

/// While an operator turns the override to and fro the level follows it, and spans begin at a crawl. One that was
/// planned to be no faster than its ends, and ends at rest, is no crawl for that.
#[test]
fn a_span_begun_at_a_crawl_speeds_up() {
    use Act::{Acknowledge, Override, Reduced};
    // Through these points; before some of them a line of NC text.
    let corners = [
        ("M3", [5.0, 0.0, 5.0]),
        ("", [45.0, 0.0, 0.0]),
        ("", [0.0, -35.0, 41.0]),
        ("", [0.0, 0.0, 0.0]),
        ("M3", [0.0, -26.0, 0.0]),
        ("", [-33.0, 0.0, 0.0]),
        ("", [0.0, 0.0, 0.0]),
        ("", [0.0, -32.0, 0.0]),
        ("", [4.0, 0.0, 0.0]),
        ("", [0.0, -10.0, 0.0]),
        ("", [0.0, 0.0, 0.0]),
        ("", [0.0, 0.0, -20.0]),
        ("", [0.0, 48.0, 0.0]),
        ("", [0.0, 0.0, 0.0]),
        ("", [0.0, 0.0, -12.0]),
    ];
    let surface = "#HSC ON [SURFACE PATH_DEV=0.05]";
    let smoothed = [
        ("", [0.0, 0.0, -25.0]),
        ("M3", [0.0, 0.0, 0.0]),
        (surface, [0.0, 0.0, 36.0]),
        ("", [0.0, 0.0, 4.0]),
        ("", [0.0, 31.0, -25.0]),
        ("", [0.0, 0.0, 0.0]),
        ("", [0.0, 26.0, -18.625]),
        ("", [0.0, 0.0, 0.0]),
        ("#HSC OFF", [0.0, 0.0, 0.0]),
        (surface, [-39.0, 0.0, 0.0]),
        ("", [0.0, 0.0, 0.0]),
        ("", [40.0, 0.0, 0.0]),
        ("", [0.0, 0.0, 0.0]),
        ("", [0.0, 0.0, -0.375]),
        ("", [0.0, 0.0, 0.0]),
        ("", [0.0, 0.125, 0.0]),
        ("", [0.0, 0.0, 0.0]),
    ];
    let turned = |acts: &[(usize, Act)]| {
        let last = acts.last().map_or(0, |act| act.0) + 30;
        let end = [(last, Override(1000)), (last, Reduced(false))];
        [&[(0, Acknowledge(50))], acts, &end].concat()
    };
    let at_corners = [
        (16, Override(16)),
        (989, Override(1469)),
        (1271, Override(1181)),
        (2084, Override(3)),
        (2834, Override(1457)),
        (2852, Override(20)),
    ];
    let at_smoothed = [
        (9, Override(1726)),
        (37, Override(1338)),
        (43, Override(1371)),
        (646, Reduced(true)),
        (1093, Reduced(false)),
        (1806, Override(1)),
        (5757, Override(1317)),
    ];
    for (slope, points, acts) in [(3, &corners[..], &at_corners[..]), (1, &smoothed, &at_smoothed)] {
        let line = |(before, [x, y, z]): &(&str, [f64; 3])| format!("{before}\nX{x} Y{y} Z{z}\n");
        let lines: String = points.iter().map(line).collect();
        let text = format!("G01 F6000\n#CONTOUR MODE ON [DEV PATH_DEV=0.1]\n{lines}#HSC OFF\nM30\n");
        let machine = uneven_mill(slope);
        let limits = machine.axes.each_ref().map(|axis| permitted(axis, slope, false, true, true));
        let run = |acts: &[(usize, Act)]| {
            let run = operate_text::<3, 120>(&text, [Position::ZERO; 3], &machine, acts, 40)
                .unwrap_or_else(|fault| panic!("slope {slope}: {fault}"));
            check::limits(&run.trace, &limits).unwrap_or_else(|fault| panic!("slope {slope}: {fault}"));
            run.distances.len()
        };
        let [alone, ticks] = [run(&turned(&[])), run(&turned(acts))];
        // What the commands take, and the changes behind the last of them.
        let last = acts.last().map_or(0, |act| act.0);
        assert!(ticks < last + 2 * alone, "slope {slope}: {ticks} ticks, {alone} alone");
    }
}

/// A level that falls while the motion crawls does not take the crawl for the plan: once the motion is up to speed
/// again, it does not come down to it at the start of what was planned then.
#[test]
fn a_level_that_falls_at_a_crawl_leaves_nothing_slow_behind() {
    let line = |program: Program, k: usize| program.line(&[30.0 * (k + 1) as f64], [9000.0, 6000.0][k % 2]);
    let program = (0..100).fold(Program::new("line", 3), line);
    for slope in 0..4 {
        let machine = mill(slope, 0);
        // From the crawl to 150 % and down again, a few times.
        let turn = |k: usize| [(600 + 200 * k, Act::Override(1500)), (620 + 200 * k, Act::Override(10))];
        let mut acts = vec![(400, Act::Override(10))];
        acts.extend((0..5).flat_map(turn));
        acts.push((1800, Act::Override(1000)));
        let run = run(&program, &machine, &acts);
        let v: Vec<f64> = run
            .distances
            .windows(2)
            .map(|w| mm(w[1].wrapping_sub(w[0])) / run.trace.cycle * 60.0)
            .skip(1800)
            .collect();
        let fast = |v: &f64| *v > 5900.0;
        let (first, last) = (v.iter().position(fast), v.iter().rposition(fast));
        let (first, last) = first.zip(last).expect("it is fast again");
        let slowest = v[first..last].iter().copied().fold(f64::MAX, f64::min);
        assert!(slowest > 500.0, "slope {slope}: {slowest} mm/min");
    }
}

//! FIR filters of the axes (D3-004, D3-223…D3-234).
use glidepath::fir::{FilterPlan, FilterTick, Filters};
use glidepath::machine::{FilterData, FilterType, MachineData};
use glidepath::quantity::Position;
use glidepath::tick::State;
use host_tests::cases::machines;
use host_tests::cases::random::{Mix, Random, program};
use host_tests::cases::set_point;
use host_tests::check;
use host_tests::filtered::{self, Filtered, permit_filters, run, run_from, with_filter};
use host_tests::operate::{Act, POLLS, random_acts};
use host_tests::properties::axis_limits;
use host_tests::seeds::seeds;

const ONE: f64 = 4_294_967_296.0;

const TYPES: [FilterType; 4] = [FilterType::Average, FilterType::Gauss, FilterType::Sinc, FilterType::Delay];

/// A square of 20 mm with corners of 90°, there and back.
const SQUARE: &str = "#SLOPE [TYPE=TRAPEZ]\nN10 G01 X20 F4000\nN20 Y20\nN30 X0\nN40 Y0\nN50 M30\n";

fn square(kind: FilterType, order: u8, options: &str) -> Filtered {
    let machine = with_filter(machines::even::<3>(1000), kind, order);
    let text = format!("#FILTER ON [{options}]\n{SQUARE}");
    run(&text, &machine, &[], 1000).unwrap()
}

fn delay(kind: FilterType, order: u8) -> usize {
    if kind == FilterType::Delay { 2 * usize::from(order) } else { usize::from(order) }
}

#[test]
fn a_motion_ends_where_the_path_ends_and_sums_are_equal() {
    // G-01, D3-004, D3-223, D3-231: a filter of each type, at rest to the last bit, without drift.
    for kind in TYPES {
        for order in [1, 2, 3, 8, 15, 16, 33, 64, 100, 101, 199, 200] {
            if kind == FilterType::Delay && order > 100 {
                continue;
            }
            let run = square(kind, order, "SHARE=100");
            let name = format!("{kind:?} {order}");
            let last = run.path.columns[0].len() - 1;
            for axis in 0..3 {
                let (path, drives) = (&run.path.columns[axis], &run.drives.columns[axis]);
                assert_eq!(path[last], drives[last], "{name}");
                // The sum of the deviations is 0: nothing is lost or won by rounding.
                let sum: i128 = run.deviations(axis, delay(kind, order)).map(i128::from).sum();
                assert_eq!(sum, 0, "{name} axis {axis}");
            }
            assert_eq!(run.states[last], State::Idle);
            let settling = run.states.iter().filter(|state| **state == State::Settling).count();
            assert!((1..=usize::from(order)).contains(&settling), "{name} {settling}");
        }
    }
}

/// The taps of a kernel by their formulas, from the outside in; with the sum one.
fn taps(kind: FilterType, order: usize, quality: f64, cut_off: f64, share: f64) -> Vec<f64> {
    use std::f64::consts::PI;
    let n = order as f64;
    let weight = |k: usize| {
        let d = k as f64 - n / 2.0;
        match kind {
            FilterType::Average => 1.0,
            FilterType::Gauss => (-d * d / 2.0 / (quality * n / 6.0).powi(2)).exp(),
            FilterType::Sinc => {
                let window =
                    0.42 + 0.5 * (2.0 * PI * d / (n + 2.0)).cos() + 0.08 * (4.0 * PI * d / (n + 2.0)).cos();
                let sinc = if d == 0.0 { 2.0 * cut_off } else { (2.0 * PI * cut_off * d).sin() / (PI * d) };
                sinc * window
            }
            _ => unreachable!(),
        }
    };
    let weights: Vec<f64> = (0..=order).map(weight).collect();
    let sum: f64 = weights.iter().sum();
    let mut taps: Vec<f64> = weights.iter().map(|w| w / sum * share).collect();
    taps[order / 2] += (1.0 - share) / 2.0;
    taps[order.div_ceil(2)] += (1.0 - share) / 2.0;
    taps
}

/// What the filter makes of the path, mm, by the formulas.
fn weighed(path: &[i64], taps: &[f64]) -> Vec<f64> {
    let at = |tick: usize, ago: usize| path[tick.saturating_sub(ago)] as f64 / ONE;
    (0..path.len()).map(|tick| taps.iter().enumerate().map(|(k, h)| h * at(tick, k)).sum()).collect()
}

#[test]
fn kernels_are_those_of_their_types() {
    // D3-224, D3-226, D3-228, D3-230: order, share, cut-off frequency and quality do what they say.
    let cases: [(FilterType, usize, &str, f64, f64, f64); 12] = [
        (FilterType::Average, 20, "", 1.0, 0.03, 1.0),
        (FilterType::Average, 31, "", 1.0, 0.03, 1.0),
        (FilterType::Average, 40, "SHARE=60", 1.0, 0.03, 0.6),
        (FilterType::Gauss, 40, "", 1.0, 0.03, 1.0),
        (FilterType::Gauss, 41, "QUALITY=0.5", 0.5, 0.03, 1.0),
        (FilterType::Gauss, 200, "QUALITY=0.2 SHARE=30", 0.2, 0.03, 0.3),
        (FilterType::Gauss, 200, "", 1.0, 0.03, 1.0),
        (FilterType::Sinc, 40, "", 1.0, 0.03, 1.0),
        (FilterType::Sinc, 101, "FCUT=60", 1.0, 0.06, 1.0),
        (FilterType::Sinc, 200, "FCUT=10", 1.0, 0.01, 1.0),
        (FilterType::Sinc, 60, "FCUT=200 SHARE=50", 1.0, 0.2, 0.5),
        (FilterType::Average, 1, "", 1.0, 0.03, 1.0),
    ];
    for (kind, order, options, quality, cut_off, share) in cases {
        let run = square(kind, order as u8, if options.is_empty() { "SHARE=100" } else { options });
        let taps = taps(kind, order, quality, cut_off, share);
        for axis in 0..2 {
            let expected = weighed(&run.path.columns[axis], &taps);
            let off =
                run.drives.columns[axis].iter().zip(&expected).map(|(y, x)| (*y as f64 / ONE - x).abs());
            let off = off.fold(0.0, f64::max);
            let from_path = run.largest(axis, order) / ONE;
            // Taps are rounded to 2^-15 of their sum; a mean is not.
            let allowed = if kind == FilterType::Average && share == 1.0 && order > 1 {
                3e-10
            } else {
                6e-3 * from_path + 3e-7 * order as f64
            };
            assert!(off <= allowed, "{kind:?} {order} {options}: {off} of {from_path}");
            assert!(from_path > 1e-3 || order == 1 || kind == FilterType::Sinc);
        }
    }
}

/// A machine that passes corners of 90° at full feed: 200 m/s² with a cycle of 1 ms.
fn stiff(cycle_us: u32) -> MachineData<3> {
    let mut machine = machines::even::<3>(cycle_us);
    for axis in &mut machine.axes {
        // As fast as filters permit.
        let a = (249_000_000_000 / u64::from(cycle_us * cycle_us)) as u32;
        (axis.a_max, axis.a_beschl, axis.a_brems, axis.a_grenz) = (a, a, a, a);
        axis.a_trans_weight = 1000;
    }
    machine
}

fn of_types(orders: &[u8]) -> impl Iterator<Item = (FilterType, u8)> + '_ {
    TYPES[..3].iter().flat_map(move |kind| orders.iter().map(move |order| (*kind, *order)))
}

#[test]
fn ax_dev_is_kept_and_used_at_corners() {
    // G-01, D3-227, D3-234: every axis, at every tick, with each type.
    for (kind, order) in of_types(&[8, 9, 16, 33, 40, 48, 52, 64, 78, 80, 88, 96, 100, 101, 128, 150, 200]) {
        for machine in [machines::even::<3>(1000), stiff(1000)] {
            let machine = with_filter(machine, kind, order);
            let run = run(&format!("#FILTER ON [AX_DEV=0.001]\n{SQUARE}"), &machine, &[], 1000).unwrap();
            let name = format!("{kind:?} {order} {}", machine.axes[0].a_max);
            assert!(run.deviated.is_empty(), "{name}");
            let is_stiff = machine.axes[0].a_trans_weight > 0;
            // Where G has both signs, what a corner shows is less than what a motion could make of it: the
            // test below. Where knees take speed, accelerations are limited by Σ|G| alone.
            let least = match (kind, order, is_stiff) {
                (FilterType::Sinc, 49..=78, false) => 0.0009,
                (FilterType::Sinc, 79..=80, false) => 0.00088,
                (FilterType::Sinc, 79..=88, false) => 0.00077,
                (FilterType::Sinc, 79..=96, false) => 0.00055,
                (FilterType::Sinc, 49..=52, true) => 0.00089,
                (FilterType::Sinc, 49..=64, true) => 0.0008,
                (FilterType::Sinc, 49..=100, true) => 0.0004,
                (FilterType::Sinc, 97..=100, _) => 0.0004,
                (FilterType::Sinc, 101.., _) => 0.00025,
                _ => 0.0009,
            };
            for axis in 0..2 {
                let largest = run.largest(axis, order.into()) / ONE;
                println!("{name} axis {axis}: {largest}");
                assert!(largest <= 0.001, "{name} axis {axis}: {largest}");
                assert!(largest >= least, "{name} axis {axis}: {largest}");
                // The library says the same.
                let said = run.deviation[axis] as f64 / ONE;
                assert!((said - largest).abs() < 3e-7, "{said} {largest}");
            }
            // Σ|G| alone would leave such a sinc 48 mm/s² and less.
            if kind == FilterType::Sinc && order > 100 && !is_stiff {
                let peaks = check::peaks(&run.path.columns[0], 1e-3);
                println!("{name}: {} mm/s²", peaks.values[1]);
                assert!(peaks.values[1] > 290.0, "{name}: {}", peaks.values[1]);
            }
        }
    }
}

/// What a corner leaves of AX_DEV behind a sinc of a high order, another motion takes: blocks that speed up
/// and slow down as its lobes do, without an operator. A corner that used 0.9 of it would need limits with
/// which those blocks are beyond it.
#[test]
fn what_a_corner_leaves_of_ax_dev_short_blocks_take() {
    let with = |order: u8, lines: &str| {
        let machine = with_filter(machines::even::<3>(1000), FilterType::Sinc, order);
        run(&format!("#FILTER ON [AX_DEV=0.001]\n{lines}"), &machine, &[], 1000)
            .unwrap()
            .largest(0, order.into())
            / ONE
    };
    for (order, length, least) in
        [(64, 0.26, 0.96), (80, 0.39, 0.96), (100, 0.67, 0.92), (128, 0.44, 0.74), (200, 0.52, 0.68)]
    {
        let mut lines = "#SLOPE [TYPE=TRAPEZ]\nG91 G01 X20 F1000\n".to_owned();
        for _ in 0..40 {
            lines += &format!("X{length} F12000\nX0.002 F1000\n");
        }
        let [blocks, corner] = [with(order, &(lines + "M30\n")), with(order, SQUARE)].map(|used| used * 1e3);
        println!("{order}: {blocks} of AX_DEV, {corner} at a corner");
        assert!((least..=1.0).contains(&blocks), "{order}: {blocks}");
        assert!(order < 100 || corner < 0.5 * blocks, "{order}: {blocks} {corner}");
    }
}

/// Nor could corners between long blocks have limits of their own: with the same ones, the same corners at a lower feed or
/// override, a reversal, and a single hold deviate by so much more that they would be beyond AX_DEV if a corner at
/// 4000 mm/min used 0.9 of it. All is in proportion: limits c times as large make each of them c times as large, at c times
/// the feed.
#[test]
fn what_a_fast_corner_leaves_of_ax_dev_slower_ones_and_a_hold_take() {
    let with = |order: u8, lines: &str, acts: &[(usize, Act)]| {
        let machine = with_filter(machines::even::<3>(1000), FilterType::Sinc, order);
        let run = run(&format!("#FILTER ON [AX_DEV=0.001]\n{lines}"), &machine, acts, 1000).unwrap();
        assert!(run.deviated.is_empty());
        run.largest(0, order.into()) / ONE * 1e3
    };
    for (order, feed) in [(100, 173), (128, 101), (200, 70)] {
        let fast = with(order, SQUARE, &[]);
        let slow = with(order, &SQUARE.replace("F4000", &format!("F{feed}")), &[]);
        let overridden = with(order, SQUARE, &[(0, Act::Override(feed / 4))]);
        let back = format!("#SLOPE [TYPE=TRAPEZ]\nG01 X20 F{feed}\nX0\nM30\n");
        let reversed = with(order, &back, &[]);
        let held = |tick: usize| with(order, SQUARE, &[(tick, Act::Hold), (tick + 500, Act::Resume)]);
        let held = (4..40).step_by(4).map(held).fold(0.0, f64::max);
        println!("{order}: {fast} at F4000, {slow} at F{feed}, {overridden}, {reversed}, {held} with a hold");
        for other in [slow, overridden, reversed, held] {
            assert!(other <= 1.0 && 0.9 * other > fast, "{order}: {other} {fast}");
        }
    }
}

/// Nor could a corner between long blocks have limits of its own, with longer ramps, which the lobes of a sinc answer
/// less. With those a fast corner uses 0.9 of AX_DEV and more, and one hold at any tick keeps it or nearly so; but an
/// override that swings by two percent, as a worn knob does, is beyond it: each change acts at once, with the limits of
/// the block. The machine itself has these limits, as the planner would never give them.
#[test]
fn limits_for_an_isolated_corner_leave_nothing_to_an_override_that_swings() {
    // Acceleration, mm/s², and ramps, µs; by how much the filter's negative taps lower both; ticks of half a swing.
    for (order, a, ramp, gain, half) in
        [(100, 887.0, 80_000, 1.21, 18), (128, 1077.0, 100_000, 1.309, 18), (200, 1209.0, 80_000, 1.489, 16)]
    {
        let mut machine = with_filter(machines::even::<3>(1000), FilterType::Sinc, order);
        for axis in &mut machine.axes {
            let a = (a * gain) as u32;
            (axis.a_max, axis.a_beschl, axis.a_brems, axis.a_grenz) = (a, a, a, a);
            machines::ramps(axis, ramp);
            axis.tr_geom = ramp;
        }
        let with = |lines: &str, acts: &[(usize, Act)]| {
            run(lines, &machine, acts, 1000).unwrap().largest(0, order.into()) / ONE * 1e3
        };
        let line = "#SLOPE [TYPE=TRAPEZ]\nG01 X100 F4000\nM30\n";
        let corner = with(SQUARE, &[]);
        let at = |feed: usize| with(&SQUARE.replace("F4000", &format!("F{feed}")), &[]);
        let slower = [100, 150, 200, 300, 400, 700, 1200, 2000].map(at).into_iter().fold(0.0, f64::max);
        let held = |tick: usize| with(line, &[(tick, Act::Hold), (tick + 500, Act::Resume)]);
        let held = (4..200).step_by(4).map(held).fold(0.0, f64::max);
        let swing = |k: usize| (300 + k * half, Act::Override(if k.is_multiple_of(2) { 980 } else { 1000 }));
        let swung = with(line, &(0..32).map(swing).collect::<Vec<_>>());
        println!("{order}: {corner} at a corner, {slower} at slower ones, {held} with a hold, {swung} swung");
        assert!((0.9..1.0).contains(&corner) && held < 1.04, "{order}: {corner} {held}");
        assert!(swung > 1.04 && swung > held, "{order}: {swung}");
    }
}

#[test]
fn without_ax_dev_the_deviation_doubles_with_order_cycle_and_feed() {
    // G-01, D3-224: where the corner is passed at the feed, N·T·v/8 of a mean.
    let corner = |order: u8, cycle_us: u32, feed: u32| {
        let machine = with_filter(stiff(cycle_us), FilterType::Average, order);
        let text = format!("#SLOPE [TYPE=TRAPEZ]\nN10 G01 X20 F{feed}\nN20 Y20\nN30 X0\nN40 Y0\nN50 M30\n");
        run(&text, &machine, &[], 1000).unwrap().largest(0, order.into()) / ONE
    };
    let one = corner(40, 1000, 2000);
    let exact = 40.0 * 42.0 / 41.0 * 1e-3 * 2000.0 / 60.0 / 8.0;
    assert!((one / exact - 1.0).abs() < 0.03, "{one} {exact}");
    for (what, two) in [
        ("order", corner(80, 1000, 2000)),
        ("cycle", corner(40, 2000, 2000)),
        ("feed", corner(40, 1000, 4000)),
    ] {
        assert!((two / one - 2.0).abs() < 0.06, "{what}: {one} {two}");
    }
}

#[test]
fn opposite_passes_have_mirrored_shapes() {
    for (kind, order) in of_types(&[8, 21, 64, 200]) {
        let machine = with_filter(machines::even::<3>(1000), kind, order);
        let pass = |there: &str, back: &str| {
            let text = format!(
                "#SLOPE [TYPE=TRAPEZ]\nN10 G01 G60 {there} F4000\nG04 1\nN20 {back}\nN30 G60 X0 Y0\nM30\n"
            );
            run(&text, &machine, &[], 1000).unwrap()
        };
        let plus = pass("X10 Y5", "X20 Y-5");
        let minus = pass("X-10 Y-5", "X-20 Y5");
        for axis in 0..2 {
            let both = plus.drives.columns[axis].iter().zip(&minus.drives.columns[axis]);
            let off = both.map(|(a, b)| (a + b).abs()).max().unwrap();
            assert!(off <= 1, "{kind:?} {order}: {off} LSB");
            // So is what the path gives.
            let both = plus.path.columns[axis].iter().zip(&minus.path.columns[axis]);
            assert!(both.map(|(a, b)| (a + b).abs()).max().unwrap() <= 1);
        }
    }
}

#[test]
fn what_no_axis_can_do_passes_a_filter_and_is_said() {
    // D3-004: a path that jumps is a defect, and no filter makes more of it: the axis ends where it ends.
    let machine = with_filter(machines::even::<3>(1000), FilterType::Gauss, 33);
    let mut filters: Box<Filters<3, 40>> = Box::new(Filters::new());
    for jump in [1i64 << 29, (1 << 30) + 1, 1 << 40] {
        let (mut bank, mut tick) = filters.split(&machine, &[Position::ZERO; 3]).unwrap();
        let (mut off, mut last) = (0, [Position::ZERO; 3]);
        for (number, at) in (0..200).map(|number| (number, if number < 50 { 0 } else { jump })) {
            let points = [Position::from_bits(at), Position::ZERO, Position::from_bits(-at)];
            tick.step(&points, at, false);
            last = *tick.set_points(&points);
            assert!((0..=jump).contains(&last[0].to_bits()), "{jump} {number}: {last:?}");
            assert_eq!(last[0].to_bits() + last[2].to_bits(), 0, "{jump} {number}");
            off = off.max((last[0].to_bits() - at).abs());
        }
        assert_eq!(last, [Position::from_bits(jump), Position::ZERO, Position::from_bits(-jump)]);
        let passes = jump > 1 << 30;
        assert_eq!(off > 0, !passes, "{jump}: {off}");
        assert_eq!(bank.beyond(), passes.then_some(0));
        assert_eq!(bank.beyond(), None);
    }
    // Nor is it planned.
    let mut fast = machine;
    fast.axes[1].a_max = 250_001;
    let error = run("M30\n", &fast, &[], 1000).unwrap_err();
    assert!(error.contains("P-AXIS-00008") && error.contains("0.25 mm"), "{error}");
}

/// A random program and machine, filters of all types and orders, an operator.
///
/// # Panics
/// What is wrong.
fn random_run(seed: u64) {
    let mut random = Random::new(seed);
    let mut machine = machines::arbitrary::<3>(seed);
    machine.channel.slope_profile = (seed % 4) as u8;
    for axis in &mut machine.axes {
        permit_filters(axis, machine.channel.cycle_us);
        axis.filter.enable = true;
        axis.filter.kind = FilterType::of_number((random.bits() % 5) as u8);
        axis.filter.order = match axis.filter.kind {
            FilterType::Delay => random.bits() % 101,
            _ => random.bits() % 201,
        } as u8;
        axis.filter.share = if random.once_in(2) { 100 } else { (random.bits() % 101) as u8 };
    }
    let tolerance = random.magnitude(1e-4, 1.0);
    let program = program(seed, Mix::general(3, 20));
    let mut text = program.text(&machine);
    let watched = !seed.is_multiple_of(3);
    if watched {
        text = text.replacen("N1 G90\n", &format!("N1 G90\n#FILTER [AX_DEV={tolerance:.7}]\n"), 1);
    }
    let start: [Position; 3] = std::array::from_fn(|k| Position::from_bits(set_point(program.start[k])));
    let undisturbed = match run_from(&text, start, &machine, &[], 1000) {
        Err(why) if why == "too long" || why.contains("ticks; raise F") => return,
        other => other.unwrap_or_else(|why| panic!("{why}\n{text}")),
    };
    let mut acts = random_acts(&mut random, undisturbed.path.ticks());
    for _ in 0..random.bits() % 4 {
        let at = (random.unit() * undisturbed.path.ticks() as f64) as usize;
        acts.push((at, Act::Override(200 + (random.bits() % 1800) as u16)));
        acts.push((at / 2, Act::Stall((random.bits() % 400) as usize)));
    }
    acts.sort_by_key(|(tick, _)| *tick);
    let polls = POLLS[(random.bits() % 3) as usize];
    let disturbed = match run_from(&text, start, &machine, &acts, polls) {
        Err(why) if why == "too long" || why.contains("ticks; raise") => return,
        other => other.unwrap_or_else(|why| panic!("{why}\n{text}")),
    };
    let limits = axis_limits(&machine, &program.contour(&machine));
    let aborted = acts.iter().any(|(_, act)| *act == Act::Abort);
    let ends: Vec<i64> = program.end().iter().map(|nm| set_point(*nm)).collect();
    let delay = machine.axes.iter().map(|axis| {
        let order = usize::from(axis.filter.order);
        match axis.filter.kind {
            FilterType::None => 0,
            FilterType::Delay => 2 * order,
            _ if axis.filter.share == 0 => 0,
            _ => order,
        }
    });
    let delay = delay.max().unwrap();
    for (run, may_end) in [(&undisturbed, false), (&disturbed, aborted)] {
        let last = run.path.ticks() - 1;
        for axis in 0..3 {
            let (path, drives) = (&run.path.columns[axis], &run.drives.columns[axis]);
            assert_eq!(path[last], drives[last]);
            assert!(may_end || drives[last] == ends[axis], "ends at {}", drives[last]);
            let peaks = check::peaks(drives, run.drives.cycle);
            let limit = limits[axis];
            for (order, limit) in [limit.v, limit.a, limit.jerk].into_iter().enumerate() {
                // The path is rounded by half a unit at most, what its filter makes of that by a quarter more
                // at most. A filtered set point gets the remainder of the one before: its own error is the
                // difference of two, of one unit each. Jerk is planned so much lower.
                let part = if order < 2 { 3.25 } else { filtered::jerk_rounding(&machine, axis) };
                let allowance = part * check::allowance(order as i32 + 1, run.drives.cycle);
                let value = peaks.values[order];
                assert!(
                    value <= limit * (1.0 + 1e-9) + allowance,
                    "axis {axis} order {order}: {value} above {limit} at {} {:?}",
                    peaks.ticks[order],
                    machine.axes[axis].filter
                );
            }
            if watched {
                let largest = run.largest(axis, delay) / ONE;
                assert!(
                    largest <= tolerance + 1e-9,
                    "axis {axis}: {largest} beyond {tolerance}, {:?}",
                    machine.axes[axis].filter
                );
            }
        }
        assert!(run.deviated.is_empty());
    }
}

/// GLIDEPATH_SEEDS: how many; GLIDEPATH_FROM: the first one. 3000 take some minutes:
/// `GLIDEPATH_FROM=10000 GLIDEPATH_SEEDS=3000 cargo test -p host-tests --release --test beside filters::random`
#[test]
fn random_programs_with_an_operator_keep_everything() {
    // D3-227, D3-232, D3-234: filters differ per axis, with holds, changes of the override and stalls. The
    // first ones went beyond AX_DEV once: curves beside a step of speed, a step that is almost a standstill.
    let number = |name| std::env::var(name).ok().and_then(|number: String| number.parse().ok());
    if let Some(count) = number("GLIDEPATH_SEEDS") {
        let from: u64 = number("GLIDEPATH_FROM").unwrap_or(0);
        let faulty = |seed: &u64| std::panic::catch_unwind(|| random_run(*seed)).is_err();
        let faults: Vec<u64> = (from..from + count).filter(faulty).collect();
        assert!(faults.is_empty(), "{faults:?}");
        return;
    }
    let once = [10_558, 11_308, 11_432, 11_858, 11_863, 12_472, 12_865];
    for seed in seeds(once.into_iter().chain(0..12), 4) {
        random_run(seed);
    }
}

fn even(kind: FilterType, order: u8) -> MachineData<3> {
    let mut machine = with_filter(machines::even::<3>(1000), kind, order);
    machine.channel.slope_profile = 1;
    machine
}

#[test]
fn each_axis_has_its_own_filter() {
    // D3-232: type, order and share of each axis; the delay is that of the slowest one.
    let mut machine = machines::even::<3>(1000);
    machine.channel.slope_profile = 1;
    let own = [(FilterType::Gauss, 40, 100), (FilterType::Average, 20, 60), (FilterType::Average, 30, 100)];
    for (axis, (kind, order, share)) in machine.axes.iter_mut().zip(own) {
        axis.filter = FilterData { enable: true, kind, order, share, ..FilterData::NONE };
    }
    let run = run("N10 G01 X10 Y7 Z-4 F6000\nN20 X0 Y0 Z0\nM30\n", &machine, &[], 1000).unwrap();
    for (axis, (kind, order, share)) in own.into_iter().enumerate() {
        let later = (40 - usize::from(order)) / 2;
        let mut taps = vec![0.0; later];
        taps.extend(self::taps(kind, order.into(), 1.0, 0.03, f64::from(share) / 100.0));
        let expected = weighed(&run.path.columns[axis], &taps);
        let off = run.drives.columns[axis].iter().zip(&expected).map(|(y, x)| (*y as f64 / ONE - x).abs());
        let off = off.fold(0.0, f64::max);
        assert!(off <= 6e-3 * run.largest(axis, 40) / ONE + 1e-5, "axis {axis}: {off}");
    }
}

#[test]
fn filters_change_at_a_standstill_and_nothing_steps() {
    // D3-223, D3-225, D3-231, D3-233: on, off and other parameters in the program; the type is the axis' own.
    let mut machine = even(FilterType::Average, 20);
    machine.axes[1].filter.kind = FilterType::Gauss;
    machine.axes[2].filter.kind = FilterType::None;
    for axis in &mut machine.axes {
        axis.filter.enable = false;
    }
    let text = "N10 G01 X10 Y10 Z10 F6000\n#FILTER ON\nN20 X20 Y0\n#FILTER [ORDER=50 SHARE=80]\nN30 X0 Z0\n\
                #FILTER OFF\nN40 Y10\n#FILTER ON [HSC]\nN50 X0 Y0\nM30\n";
    let run_of = |text: &str| run(text, &machine, &[], 1000).unwrap();
    let filtered = run_of(text);
    // ISG's default of jerk: B is a/ramp.
    for axis in 0..3 {
        let peaks = check::peaks(&filtered.drives.columns[axis], 1e-3);
        assert!(peaks.values[0] <= 200.001 && peaks.values[1] <= 2000.01, "{:?}", peaks.values);
        assert!(peaks.values[2] <= 40_001.0, "{:?}", peaks.values);
    }
    assert!(filtered.states.contains(&State::Settling));
    // Off again in N40, where Y goes up as Z rests at 0, on in all other motions.
    let Filtered { path, drives, .. } = &filtered;
    let moves = |axis: usize, tick: usize| path.columns[axis][tick] - path.columns[axis][tick - 1];
    let begins = (1..path.columns[2].len()).rfind(|tick| moves(2, *tick) != 0).expect("N30");
    for (sense, off) in [(1, true), (-1, false)] {
        let mut ticks = (begins..path.columns[1].len()).filter(|tick| moves(1, *tick).signum() == sense);
        let same = |tick: usize| (0..3).all(|k| path.columns[k][tick] == drives.columns[k][tick]);
        assert_eq!((ticks.clone().count() > 50, ticks.all(same)), (true, off));
    }
    // The old form is the same, whatever the machine data say.
    let [none, on, old] =
        ["", "#FILTER ON\n", "#FILTER ON [HSC]\n"].map(|word| run_of(&format!("{word}{SQUARE}")));
    assert!(none.drives.columns == none.path.columns);
    assert!(on.drives.columns == old.drives.columns);
    // All axes that have a filter: none of them is the path of so many ticks ago.
    for axis in 0..2 {
        let (path, drives) = (&on.path.columns[axis], &on.drives.columns[axis]);
        assert!((0..=20).all(|ago| path[..path.len() - ago] != drives[ago..]), "axis {axis}");
    }
    // Off at first: the drives get the path.
    let first = (0..50).all(|tick| filtered.drives.columns[0][tick] == filtered.path.columns[0][tick]);
    assert!(first);
    // ORDER_TIME is an order: 5500 µs are 5 cycles. Of both, ORDER counts.
    let times = ["ORDER_TIME=5500", "ORDER=5", "ORDER=5 ORDER_TIME=90000"];
    let runs = times.map(|given| run_of(&format!("#FILTER ON [{given}]\n{SQUARE}")).drives.columns);
    assert!(runs[0] == runs[1] && runs[1] == runs[2]);
    assert!(runs[0] != run_of(&format!("#FILTER ON [ORDER=6]\n{SQUARE}")).drives.columns);
    // Less than a cycle: not filtered, and that is said.
    let off = run_of(&format!("#FILTER ON [ORDER_TIME=999]\n{SQUARE}"));
    assert!(off.drives.columns == off.path.columns && off.warnings.len() == 1, "{:?}", off.warnings);
}

#[test]
fn what_cannot_be_filtered_is_refused() {
    // D3-229, D3-231: ACC_FACT needs P-AXIS-00013, #FILTER ON a type.
    let refused = |text: &str, machine: &MachineData<3>| run(text, machine, &[], 1000).unwrap_err();
    let square = |options: &str| format!("#FILTER ON [{options}]\n{SQUARE}");
    let none = machines::even::<3>(1000);
    assert!(refused(&square("ORDER=8"), &none).contains("P-AXIS-00586"));
    let average = even(FilterType::Average, 20);
    assert!(refused(&square("ACC_FACT=2"), &average).contains("P-AXIS-00013"));
    assert!(refused(&square("AX_DEV=0.000001"), &average).contains("AX_DEV"));
    let delay = even(FilterType::Delay, 20);
    assert!(refused(&square("ORDER=101"), &delay).contains("at most 100"));
    // With it, corners are faster, and the axes keep their limits.
    let mut weighted = even(FilterType::Average, 40);
    for axis in &mut weighted.axes {
        axis.a_trans_weight = 1000;
        // What a corner shows beside the slope has room.
        axis.a_max = 30_000;
    }
    let [slow, fast] = ["ACC_FACT=1", "ACC_FACT=10"]
        .map(|given| run(&square(given).replace("F4000", "F600"), &weighted, &[], 1000).unwrap());
    // D3-229: P-AXIS-00013 permits a step of 2 mm/s; ten times that lets the feed of 10 mm/s pass.
    let corner = |run: &Filtered| {
        let [x, y] = [0, 1].map(|axis| &run.path.columns[axis]);
        let tick = (0..y.len()).find(|tick| y[*tick] > 0).unwrap();
        (x[tick - 1] - x[tick - 2]) as f64 / ONE / 1e-3
    };
    println!("{} {} {} {}", fast.path.ticks(), slow.path.ticks(), corner(&fast), corner(&slow));
    assert!(fast.path.ticks() < slow.path.ticks(), "{} {}", fast.path.ticks(), slow.path.ticks());
    assert!(corner(&slow) < 2.01 && corner(&fast) > 9.99, "{} {}", corner(&slow), corner(&fast));
    for axis in 0..2 {
        let peaks = check::peaks(&fast.drives.columns[axis], 1e-3);
        assert!(peaks.values[1] <= 30_000.1, "{:?}", peaks.values);
    }
}

#[test]
fn exact_stops_dwells_and_functions_wait_for_the_axes() {
    // D3-004: a corner with G60 is reached to the bit; M and H come when the axes are there.
    let mut machine = even(FilterType::Gauss, 64);
    machine.channel.m_synch = glidepath::machine::SynchTable::NONE;
    let text = "N10 G01 G60 X10 F6000\nN20 Y10\nN30 M7\nN40 G04 0.1\nN50 X0 Y0\nN60 M9\nM30\n";
    let run = run(text, &machine, &[(300, Act::Hold), (900, Act::Resume)], 1000).unwrap();
    let at = |axis: usize, tick: usize| run.drives.columns[axis][tick] as f64 / ONE;
    let corner = (0..run.drives.ticks()).any(|tick| at(0, tick) == 10.0 && at(1, tick) == 0.0);
    assert!(corner, "not in the corner");
    let stands = (0..run.drives.ticks()).filter(|tick| at(0, *tick) == 10.0 && at(1, *tick) == 10.0).count();
    assert!((100..105).contains(&stands), "dwells {stands} ticks");
    for (tick, place) in run.outputs.iter().map(|(tick, _)| *tick).zip([[10.0, 10.0], [0.0, 0.0]]) {
        assert_eq!([at(0, tick), at(1, tick)], place, "at {tick}");
        assert_ne!([at(0, tick - 1), at(1, tick - 1)], place);
    }
    assert_eq!(run.outputs.len(), 2);
    // It says that it stands when the axes do.
    let hold = run.holds[0];
    assert_eq!(run.drives.columns[0][hold], run.drives.columns[0][hold + 50]);
    assert_eq!(run.drives.columns[0][hold], run.path.columns[0][hold]);
}

/// D3-224: a mean is less than an LSB off that of its window, at every tick, alone or beside other filters, with
/// all that comes of remainders.
#[test]
fn a_mean_is_that_of_its_window() {
    let mut text = String::from("#SLOPE [TYPE=TRAPEZ]\nG01 F9000\n");
    let mut random = Random::new(16);
    for _ in 0..60 {
        let [x, y] = [0; 2].map(|_| random.between(-40.0, 40.0));
        text += &format!("X{x:.3} Y{y:.3}\n");
    }
    text += "M30\n";
    for (order, beside) in
        [(2, None), (3, Some(1)), (6, None), (30, Some(8)), (31, None), (127, None), (200, Some(60))]
    {
        let mut machine = with_filter(machines::even::<3>(1000), FilterType::Average, order);
        if let Some(order) = beside {
            machine.axes[1].filter = FilterData { kind: FilterType::Gauss, order, ..machine.axes[1].filter };
        }
        let run = run(&text, &machine, &[], 1000).unwrap();
        let (path, drives) = (&run.path.columns[0], &run.drives.columns[0]);
        let n = i128::from(order) + 1;
        for (tick, y) in drives.iter().enumerate() {
            let window = (0..=usize::from(order)).map(|ago| i128::from(path[tick.saturating_sub(ago)]));
            let off = n * i128::from(*y) - window.sum::<i128>();
            assert!(off.abs() < n, "order {order}, tick {tick}: {off} of {n}");
        }
        assert!(drives.len() > 10_000);
    }
}

/// D3-224, D3-226: what a command does not name stays as an earlier one gave it.
#[test]
fn share_and_order_stay_until_they_are_given_again_d3_224_d3_226() {
    let mut machine = even(FilterType::Gauss, 20);
    machine.axes.iter_mut().for_each(|axis| axis.filter.enable = false);
    // From where the first axis moves: a command takes ticks of rest.
    let drives = |commands: &str| {
        let run = run(&format!("{commands}\n{SQUARE}"), &machine, &[], 1000).unwrap();
        let begins = run.drives.columns[0].iter().position(|x| *x != 0).expect("X moves");
        run.drives.columns.iter().map(|column| column[begins..].to_vec()).collect::<Vec<_>>()
    };
    let both = drives("#FILTER ON [ORDER=40 SHARE=60]");
    assert!(drives("#FILTER [SHARE=60]\n#FILTER ON [ORDER=40]") == both);
    assert!(drives("#FILTER [ORDER=40]\n#FILTER ON [SHARE=60]") == both);
    assert!(drives("#FILTER [ORDER=40 SHARE=60]\n#FILTER ON") == both);
    assert!(drives("#FILTER ON [ORDER=40]") != both && drives("#FILTER ON [SHARE=60]") != both);
}

/// P-AXIS-00591: the order as a time, in whole cycles, rounded down; below a cycle nothing is filtered.
#[test]
fn an_order_as_a_time_is_whole_cycles() {
    let with = |order: u8, order_time_us: u32| {
        let mut machine = even(FilterType::Average, order);
        machine.axes.iter_mut().for_each(|axis| axis.filter.order_time_us = order_time_us);
        run(SQUARE, &machine, &[], 1000).unwrap().drives.columns
    };
    for (time, order) in [(20_000, 20), (20_999, 20), (1000, 1), (999, 0), (0, 0)] {
        assert!(with(0, time) == with(order, 0), "{time} us");
    }
    assert!(with(10, 20_000) == with(10, 0), "the order counts before the time");
}

/// D3-232: an axis whose order has the other parity than the longest delay lies half a cycle between its set points: its
/// taps are averaged with themselves a cycle later.
#[test]
fn half_a_cycle_is_the_mean_of_two_d3_232() {
    let mut machine = machines::even::<3>(1000);
    machine.channel.slope_profile = 1;
    let own = [(FilterType::Gauss, 41), (FilterType::Gauss, 20), (FilterType::Average, 30)];
    for (axis, (kind, order)) in machine.axes.iter_mut().zip(own) {
        axis.filter = FilterData { enable: true, kind, order, ..FilterData::NONE };
    }
    let run = run("N10 G01 X10 Y7 Z-4 F6000\nN20 X0 Y0 Z0\nM30\n", &machine, &[], 1000).unwrap();
    for (axis, (kind, order)) in own.into_iter().enumerate().skip(1) {
        let taps = taps(kind, order.into(), 1.0, 0.03, 1.0);
        let later = (41 - usize::from(order)) / 2;
        let mean = [later, later + 1].map(|first| {
            let shifted: Vec<f64> = std::iter::repeat_n(0.0, first).chain(taps.iter().copied()).collect();
            weighed(&run.path.columns[axis], &shifted)
        });
        let [one, other] = &mean;
        let mut most: f64 = 0.0;
        for (y, (a, b)) in run.drives.columns[axis].iter().zip(one.iter().zip(other)) {
            most = most.max((*y as f64 / ONE - 0.5 * (a + b)).abs());
        }
        // Half a cycle beside it would be half a cycle's way: 0.05 mm at 100 mm/s.
        assert!(most < 6e-3 * run.largest(axis, 41) / ONE + 1e-5, "axis {axis}: {most}");
    }
}

/// D3-004: a function on the way comes when the filtered axes are there, as much later as the filters delay.
#[test]
fn functions_on_the_way_come_as_late_as_the_filters_delay_d3_004() {
    for (kind, order, delay) in
        [(FilterType::Average, 100, 50), (FilterType::Gauss, 200, 100), (FilterType::Delay, 60, 60)]
    {
        let mut machine = even(kind, order);
        machine.channel.m_synch =
            glidepath::machine::SynchTable::NONE.with(25, glidepath::machine::Synch::Mos);
        let run = run("N10 G01 X20 F6000\nM25\nN20 X60\nM30\n", &machine, &[], 1000).unwrap();
        let at = |trace: &host_tests::trace::Trace, tick: usize| trace.columns[0][tick] as f64 / ONE;
        let passes = (0..run.path.ticks()).find(|tick| at(&run.path, *tick) >= 20.0).expect("on the way");
        let [(tick, _)] = run.outputs[..] else { panic!("{:?}", run.outputs) };
        assert_eq!(tick, passes + delay, "{kind:?} {order}");
        assert!((at(&run.drives, tick) - 20.0).abs() < 0.11, "{}", at(&run.drives, tick));
    }
}

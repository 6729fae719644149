//! HSC: acceleration may be non-zero at the ends of blocks. Dividing a path into blocks changes nothing, and
//! the limits hold.
use glidepath::machine::MachineData;
use glidepath::quantity::Position;
use host_tests::cases::feeds::{ACCELERATION, Feeds, PATHS, accepted};
use host_tests::cases::random::{Mix, Random, program};
use host_tests::cases::{Program, edges, machines, named, set_point};
use host_tests::check;
use host_tests::operate::{Act, Operated, judge, operate, operate_text};
use host_tests::properties::{Verdict, permitted, verify};
use host_tests::reference::optimum::TOLERANCE;
use host_tests::trace::{run, run_text};
use std::f64::consts::TAU;

fn hsc<const AXES: usize>(mut machine: MachineData<AXES>) -> MachineData<AXES> {
    machine.channel.slope_profile = 3;
    machine
}

fn good<const AXES: usize>(program: &Program, machine: &MachineData<AXES>) -> Verdict {
    verify::<AXES, 120>(program, &hsc(*machine)).unwrap_or_else(|fault| panic!("{fault}"))
}

/// 100 mm along X in `blocks` pieces of random lengths, the longest four times the shortest.
fn cut(blocks: usize, seed: u64) -> Program {
    let mut random = Random::new(seed);
    let lengths: Vec<f64> = (0..blocks).map(|_| random.between(1.0, 4.0)).collect();
    let total: f64 = lengths.iter().sum();
    let mut program = Program::new(format!("line in {blocks} pieces"), 3);
    let mut at = 0.0;
    for length in &lengths[1..] {
        at += length;
        program = program.line(&[100.0 * at / total], 10_000.0);
    }
    program.line(&[100.0], 10_000.0)
}

/// Rows: D3-206.
#[test]
fn a_line_cut_into_pieces_takes_the_same_time() {
    let machine = machines::examples::<3>(1000);
    let whole = good(&cut(1, 0), &machine).run.trace.ticks();
    for (blocks, seed) in [(2, 1), (10, 2), (10, 3), (100, 4)] {
        for optimised in [false, true] {
            let program = Program { optimised, ..cut(blocks, seed) };
            let ticks = good(&program, &machine).run.trace.ticks();
            assert!(ticks.abs_diff(whole) <= 1, "{blocks} pieces: {ticks} ticks, one piece {whole}");
        }
    }
}

/// A full circle of radius 40 mm in so many arcs.
fn circle(arcs: u32) -> Program {
    let mut program = Program::new(format!("circle in {arcs} arcs"), 3);
    for i in 1..=arcs {
        let at = |i: u32| {
            let angle = TAU * f64::from(i) / f64::from(arcs);
            [40.0 * angle.sin(), 40.0 - 40.0 * angle.cos()].map(|x| (x * 1e6).round() / 1e6)
        };
        let [x, y] = at(i - 1);
        program = program.arc(&at(i), [-x, 40.0 - y], false, 6000.0);
    }
    program
}

#[test]
fn a_circle_cut_into_arcs_takes_the_same_time() {
    let machine = machines::examples::<3>(1000);
    let whole = good(&circle(1), &machine).run.trace.ticks();
    for arcs in [2, 7, 360] {
        let ticks = good(&circle(arcs), &machine).run.trace.ticks();
        assert!(ticks.abs_diff(whole) <= 1, "{arcs} arcs: {ticks} ticks, one arc {whole}");
    }
}

#[test]
fn a_circle_cut_into_arcs_takes_nearly_the_same_time_with_trapez_sin2_and_step() {
    for slope in [1, 2, 0] {
        let machine = machines::with_slope(machines::examples::<3>(1000), slope);
        let time = |arcs: u32| {
            let verdict = verify::<3, 120>(&circle(arcs), &machine).unwrap_or_else(|fault| panic!("{fault}"));
            verdict.run.trace.ticks()
        };
        let whole = time(1);
        for arcs in [2, 7, 360] {
            let ticks = time(arcs);
            println!("slope {slope}: {arcs} arcs: {ticks} ticks, one arc {whole}");
            assert!(
                ticks.abs_diff(whole) * 50 <= whole,
                "slope {slope}, {arcs} arcs: {ticks} ticks, one {whole}"
            );
        }
    }
}

fn random<const AXES: usize>(seeds: std::ops::Range<u64>, cycle_us: u32) {
    for seed in seeds {
        let machines = [machines::even(cycle_us), machines::uneven(cycle_us), machines::mill(cycle_us)];
        let mix = if seed % 4 == 3 { Mix::surface(AXES, 400) } else { Mix::general(AXES, 60) };
        for optimised in [false, true] {
            let program = Program { optimised, ..program(seed, mix) };
            good::<AXES>(&program, &machines[seed as usize % 3]);
        }
    }
}

#[test]
fn random_programs_keep_their_limits() {
    random::<1>(9100..9110, 1000);
    random::<2>(9200..9210, 1000);
    random::<3>(9300..9330, 1000);
    random::<6>(9600..9606, 1000);
    random::<3>(9700..9703, 100);
    random::<3>(9704..9712, 4000);
}

#[test]
fn arbitrary_machines_keep_their_limits() {
    // `cargo run --release -p host-tests --example soak -- 0 5000 3` goes on with it.
    for seed in host_tests::seeds::seeds(0..60, 6) {
        for optimised in [false, true] {
            let one = Program { optimised, ..program(seed, Mix::arbitrary(1, seed)) };
            good::<1>(&one, &machines::arbitrary(seed));
            let three = Program { optimised, ..program(seed, Mix::arbitrary(3, seed)) };
            good::<3>(&three, &machines::arbitrary(seed));
        }
    }
    // A plan of single blocks, then a tiny block with less jerk in one span with the last of them.
    good::<2>(&program(655, Mix::arbitrary(2, 655)), &machines::arbitrary(655));
}

#[test]
fn edges_keep_their_limits() {
    for program in edges::three_axes() {
        good::<3>(&program, &machines::uneven(1000));
    }
    for program in edges::rotary() {
        good::<4>(&program, &machines::even(1000));
    }
}

#[test]
fn never_slower_than_with_zero_acceleration_at_every_block_end() {
    for program in
        [named::pieces(600, 0.2, 60_000.0), named::wave(600, 0.3, 60_000.0), named::slot(6000.0, 3)]
    {
        let machine = machines::even::<3>(1000);
        let trapez = verify::<3, 120>(&program, &machine).unwrap().run.trace.ticks();
        let hsc = good(&program, &machine).run.trace.ticks();
        println!("{}: {hsc} ticks, TRAPEZ {trapez}", program.name);
        assert!(hsc <= trapez, "{}: {hsc} ticks, TRAPEZ {trapez}", program.name);
    }
}

/// Mean and worst time over the optimum, %.
const MEAN: f64 = 3.0;
const WORST: f64 = 6.0;
/// The same with NO_OPT=0.
const OPTIMISED_MEAN: f64 = 1.0;
const OPTIMISED_WORST: f64 = 2.5;

/// The machine of a path with changing feeds.
fn feeds_machine(path: &Feeds) -> MachineData<1> {
    let ramp = (path.ramp * 1e6) as u32;
    hsc(machines::machine::<1>(1000, |_, axis| {
        (axis.vb_max, axis.vb_eilgang) = (1_000_000, 1_000_000);
        machines::accelerations(axis, ACCELERATION as u32, ACCELERATION as u32);
        machines::ramps(axis, ramp);
        axis.tr_geom = ramp;
    }))
}

/// `cargo run --release -p host-tests --example compare` prints every path.
fn beside_the_optimum(optimised: bool) -> [f64; 2] {
    let (mut sum, mut worst) = (0.0, 0.0_f64);
    let optima = accepted().expect("the table");
    for (number, optimum) in (0..PATHS).zip(&optima) {
        let path = Feeds::new(number);
        let program = Program { optimised, ..path.program(format!("feeds {number}"), 1) };
        let blocks = run::<1, 120>(&program, &feeds_machine(&path)).unwrap().blocks;
        // Ticks to s.
        let time = blocks.iter().map(|span| span.time.to_bits() as f64).sum::<f64>() / 2f64.powi(36) * 1e-3;
        let over = time / optimum.time - 1.0;
        assert!(over >= -TOLERANCE, "path {number}: {time} s, optimum {} s", optimum.time);
        sum += 100.0 * over;
        worst = worst.max(100.0 * over);
    }
    let mean = sum / optima.len() as f64;
    println!("{mean:.2} % over the optimum on average, {worst:.2} % at worst");
    [mean, worst]
}

#[test]
fn near_the_optimum_along_changing_feeds_and_never_faster() {
    let [mean, worst] = beside_the_optimum(false);
    assert!(mean <= MEAN && worst <= WORST, "{mean} % over the optimum on average, {worst} % at worst");
}

/// Rows: D3-200.
#[test]
fn nearer_to_the_optimum_with_no_opt_0() {
    let [mean, worst] = beside_the_optimum(true);
    assert!(
        mean <= OPTIMISED_MEAN && worst <= OPTIMISED_WORST,
        "{mean} % over the optimum on average, {worst} % at worst"
    );
}

#[test]
fn changing_feeds_keep_their_limits_with_no_opt_0() {
    for number in 1000..1150 {
        let path = Feeds::new(number);
        let mut machine = feeds_machine(&path);
        for axis in &mut machine.axes {
            match number % 3 {
                1 => axis.a_brems = 1300,
                2 => axis.a_beschl = 900,
                _ => {}
            }
        }
        machine.channel.look_ahead = [120, 60, 30, 20][(number / 3 % 4) as usize];
        let program = Program { optimised: true, ..path.program(format!("feeds {number}"), 1) };
        good::<1>(&program, &machine);
    }
}

/// Slow arcs, a slow line and slow corners between fast blocks: each is cut, whatever its shape.
#[test]
fn blocks_of_every_shape_are_entered_and_left_with_acceleration() {
    let machine = machines::examples::<3>(1000);
    let program = Program::new("shapes", 3)
        .line(&[80.0], 18_000.0)
        .arc(&[80.0, 60.0], [0.0, 30.0], false, 3_000.0)
        .line(&[0.0, 60.0], 18_000.0)
        .line(&[-20.0, 60.0], 2_000.0)
        .line(&[-100.0, 60.0], 18_000.0)
        .line(&[-102.0, 60.0], 4_000.0)
        .line(&[-160.0, 60.0], 18_000.0);
    let before = good(&program, &machine).run.trace.ticks();
    let program = Program { optimised: true, ..program };
    let verdict = good(&program, &machine);
    let ticks = verdict.run.trace.ticks();
    let inside = verdict.run.blocks.iter().filter(|span| span.blocks == 0).count();
    println!("{before} ticks, {ticks} with NO_OPT=0, {inside} spans inside a block");
    assert!(ticks < before && inside > 0, "{before} ticks, {ticks} with NO_OPT=0, {inside} spans inside");
}

#[test]
fn no_opt_0_changes_nothing_but_hsc() {
    let machine = machines::even::<3>(1000);
    let program = named::slot(6000.0, 3).text(&machine);
    let digest = |slope: &str| {
        let text = program.replacen("N10 ", &format!("N2 #SLOPE [{slope}]\nN10 "), 1);
        run_text::<3, 120>(&text, [Position::ZERO; 3], &machine, 1).unwrap().digest
    };
    assert_eq!(digest("TYPE=TRAPEZ NO_OPT=0"), digest("TYPE=TRAPEZ"));
    assert_eq!(digest("TYPE=SIN2 NO_OPT=0"), digest("TYPE=SIN2 NO_OPT=1"));
    assert_eq!(digest("TYPE=HSC"), digest("TYPE=HSC NO_OPT=1"));
}

/// Corners in random programs on random machines. With seeds 235 and 692 a span once began faster than the
/// highest speed that it had been left: what follows was refused as impossible.
#[test]
fn random_corners_can_be_planned() {
    for seed in host_tests::seeds::seeds((0..12).chain([235, 692]), 3) {
        let mix = Mix { length: [0.05, 40.0], knee: 3.0, arcs: 0, ..Mix::general(3, 30) };
        let program = program(seed, mix);
        let mut machine = machines::arbitrary::<3>(seed);
        machine.channel.slope_profile = 3;
        // With P-AXIS-00013 jerk has no limit at a knee without a curve.
        machine.axes.iter_mut().for_each(|axis| axis.a_trans_weight = 0);
        let limits: Vec<_> = machine.axes.iter().map(|axis| permitted(axis, 3, true, true, true)).collect();
        let start = std::array::from_fn(|k| Position::from_bits(set_point(program.start[k])));
        for (mode, no_opt) in
            [("DIST PRE_DIST=2 POST_DIST=1", 1), ("DEV PATH_DEV=0.2", 1), ("DIST PRE_DIST=2 POST_DIST=1", 0)]
        {
            let head = format!("#SLOPE [TYPE=HSC NO_OPT={no_opt}]\n#CONTOUR MODE [{mode}]\nG261\nN1 ");
            let text = program.text(&machine).replacen("N1 ", &head, 1).replace("M30", "G260\nM30");
            let run = operate_text::<3, 120>(&text, start, &machine, &[], 1000).unwrap();
            check::limits(&run.trace, &limits)
                .unwrap_or_else(|fault| panic!("{seed}, {mode}, NO_OPT={no_opt}: {fault}"));
        }
    }
}

/// Faster than `part` of the feeds of the blocks under way, from a tick on: first tick.
fn above_the_feed(path: &Feeds, run: &Operated, part: f64, from: usize) -> Option<usize> {
    let ends: Vec<f64> = path
        .blocks
        .iter()
        .scan(0.0, |end, block| {
            *end += block.length;
            Some(*end)
        })
        .collect();
    let start = run.distances[0];
    let at = |tick: usize| run.distances[tick].wrapping_sub(start) as f64 / 2f64.powi(44);
    (from.max(1)..run.distances.len()).find(|&tick| {
        let (before, now) = (at(tick - 1), at(tick));
        let first = ends.partition_point(|end| *end < before - 1e-6).min(ends.len() - 1);
        let last = ends.partition_point(|end| *end < now).min(ends.len() - 1);
        let feed = path.feeds[first..=last].iter().copied().fold(0.0, f64::max);
        let v = (now - before) / run.trace.cycle * 60.0;
        v > feed * part * (1.0 + 1e-5) + 1e-3
    })
}

/// A span has one law for blocks of several feeds: no block is faster than its part of the feed, and all of
/// it takes no longer than the override makes it.
#[test]
fn an_override_is_kept_in_every_block() {
    // Slowing down from the highest feed, with the reaction before.
    const SETTLED: usize = 500;
    for number in 0..30 {
        let path = Feeds::new(number);
        let machine = feeds_machine(&path);
        for optimised in [false, true] {
            let program = Program { optimised, ..path.program(format!("feeds {number}"), 1) };
            let operated = |acts: &[(usize, Act)]| operate::<1, 120>(&program, &machine, acts, 1000).unwrap();
            let whole = operated(&[]).trace.len();
            for over in [50, 300, 900] {
                let part = f64::from(over) / 1000.0;
                let run = operated(&[(0, Act::Override(over))]);
                assert_eq!(above_the_feed(&path, &run, part, 0), None, "path {number}, {over}");
                let ticks = run.trace.len() as f64 * part;
                assert!(
                    ticks <= whole as f64 * 1.02 + 10.0,
                    "path {number}, {over}: {ticks} of {whole} ticks"
                );
                // In the middle, and back.
                let (down, up) = (whole / 3, whole / 3 + 2 * SETTLED);
                let run = operated(&[(down, Act::Override(over)), (up, Act::Override(1000))]);
                let above = above_the_feed(&path, &run, part, down + SETTLED);
                assert!(above.is_none_or(|tick| tick >= up), "path {number}, {over} at {down}: {above:?}");
                assert_eq!(above_the_feed(&path, &run, 1.0, 0), None, "path {number}, {over} at {down}");
            }
        }
    }
}

/// The same behind a higher override: what was planned for that is left no faster than the one of now
/// permits.
#[test]
fn an_override_is_kept_in_every_block_behind_a_higher_one() {
    const SETTLED: usize = 500;
    for number in 0..40 {
        let path = Feeds::new(number);
        let mut machine = feeds_machine(&path);
        machine.channel.override_weight_prog_feed = (number % 2) as u8;
        for optimised in [false, true] {
            let program = Program { optimised, ..path.program(format!("feeds {number}"), 1) };
            let operated = |acts: &[(usize, Act)]| {
                let run = operate::<1, 120>(&program, &machine, acts, 1000).unwrap();
                judge(&program, &machine, &run).unwrap_or_else(|fault| panic!("{}: {fault}", program.name));
                run
            };
            let whole = operated(&[]).trace.len();
            for (high, low) in [(1500, 1000), (2000, 700), (1200, 1100), (1000, 600)] {
                let down = whole / 4;
                let acts = [(0, Act::Override(high)), (down, Act::Override(low))];
                let run = operated(&acts);
                let part = f64::from(low) / 1000.0;
                let above = above_the_feed(&path, &run, part, down + SETTLED);
                assert_eq!(above, None, "path {number}, NO_OPT=0 {optimised}, {high} to {low} at {down}");
                let above = above_the_feed(&path, &run, f64::from(high) / 1000.0, 0);
                assert_eq!(above, None, "path {number}, NO_OPT=0 {optimised}, {high} to {low} at {down}");
                // And up and down again.
                let (up, again) = (down + 600, down + 1200);
                let acts = [acts[0], acts[1], (up, Act::Override(high)), (again, Act::Override(low))];
                let run = operated(&acts);
                let above = above_the_feed(&path, &run, part, again + SETTLED);
                assert_eq!(above, None, "path {number}, NO_OPT=0 {optimised}, {high} to {low} at {again}");
            }
        }
    }
}

/// Many metres of tangential lines and quarter circles: the way is long enough for more speed than numbers
/// hold. A line beside an arc has the acceleration of both in one span, which costs some per cent.
#[test]
fn a_long_way_is_hardly_slower_than_with_trapez() {
    for (line, radius, feed) in [(3000.0, 100.0, 60_000.0), (6000.0, 1500.0, 900_000.0)] {
        let machine = machines::machine::<3>(1000, |_, axis| {
            (axis.vb_max, axis.vb_eilgang, axis.a_max) = (16_000_000, 16_000_000, 60_000);
            machines::accelerations(axis, 20_000, 20_000);
            machines::ramps(axis, 150_000);
        });
        let mut program = Program::new(format!("lines of {line} mm"), 3);
        let mut at = [0.0, 0.0];
        for k in 0..14 {
            let [(dx, dy), (nx, ny)] =
                [k, k + 1].map(|k| [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)][k % 4]);
            at = [at[0] + line * dx, at[1] + line * dy];
            program = program.line(&at, feed);
            at = [at[0] + radius * (dx + nx), at[1] + radius * (dy + ny)];
            program = program.arc(&at, [radius * nx, radius * ny], false, feed);
        }
        let ticks = |machine| verify::<3, 120>(&program, &machine).unwrap().run.trace.ticks();
        let (hsc, trapez) = (ticks(hsc(machine)), ticks(machine));
        assert!(hsc * 20 <= trapez * 21, "{line} mm: {hsc} ticks, TRAPEZ {trapez}");
    }
}

/// A long block, and a short slow one behind it in the same span.
fn approach() -> Program {
    Program::new("approach", 3).line(&[1000.0], 12_000.0).line(&[1001.0], 2400.0)
}

/// Highest path speed from a tick on, mm/s.
fn fastest(run: &Operated, from: usize) -> f64 {
    let ticks = run.distances[from..].windows(2).map(|w| w[1].wrapping_sub(w[0]));
    ticks.max().unwrap_or(0) as f64 / 2f64.powi(44) / run.trace.cycle
}

#[test]
fn a_long_block_goes_on_after_a_change() {
    let machine = hsc(machines::examples::<3>(1000));
    let ticks =
        |acts: &[(usize, Act)]| operate::<3, 120>(&approach(), &machine, acts, 40).unwrap().trace.len();
    let whole = ticks(&[]);
    let slower = ticks(&[(1000, Act::Override(900))]);
    assert!(slower * 9 <= whole * 10, "{slower} ticks at 90 %, {whole} without");
    let half = ticks(&[(0, Act::Override(500))]);
    let less = ticks(&[(0, Act::Override(500)), (1000, Act::Override(510))]);
    assert!(less <= half, "{less} ticks at 51 %, {half} at 50 %");
    let held = ticks(&[(1500, Act::Hold), (2000, Act::Resume)]);
    assert!(held <= whole + 1200, "{held} ticks with a hold of 500, {whole} without");
}

#[test]
fn reduced_speed_counts_beside_an_override() {
    let mut machine = hsc(machines::examples::<3>(1000));
    machine.axes[0].vb_max_red = 50_000;
    for over in [300, 500, 900] {
        let acts = [(0, Act::Override(over)), (600, Act::Reduced(true))];
        let run = operate::<3, 120>(&approach(), &machine, &acts, 40).unwrap();
        let (v, permitted) = (fastest(&run, 1600), f64::from(over) * 0.05);
        assert!(v <= permitted * 1.000_001, "{over}: {v} mm/s, permitted {permitted}");
    }
}

#[test]
fn the_lowest_override_ends_no_program() {
    let mut machine = hsc(machines::examples::<3>(1000));
    machine.channel.cycle_us = 100;
    let mut program = Program::new("half circles", 3);
    for (y, j) in [(4.0, 2.0), (0.0, -2.0), (4.0, 2.0)] {
        program = program.arc(&[0.0, y], [0.0, j], false, 60.0);
    }
    let acts = [(0, Act::Override(1)), (20_000, Act::Override(1000))];
    let run = operate::<3, 120>(&program, &machine, &acts, 40).unwrap();
    assert!(run.trace.len() < 220_000, "{} ticks", run.trace.len());
}

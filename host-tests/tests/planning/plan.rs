//! The plan: the reference's plan is a permitted motion, and the library's plan equals the reference's.
use glidepath::machine::MachineData;
use host_tests::cases::knees::{beside, chain, turning};
use host_tests::cases::random::{Mix, program};
use host_tests::cases::{Program, edges, machines, named, set_point};
use host_tests::operate::{self, operate, random_setup};
use host_tests::properties::axis_limits;
use host_tests::reference::geometry::Contour;
use host_tests::reference::limits::Machine;
use host_tests::reference::merge::merged;
use host_tests::reference::motion::Motion;
use host_tests::reference::planner::{SPEED, blocks, blocks_of, plan};
use host_tests::reference::profile::Profile;
use host_tests::trace::{run, sampled};
use host_tests::{check, tolerance};

fn merged_for<const AXES: usize>(program: &Program, machine: &MachineData<AXES>) -> (Contour, Machine) {
    let axes = Machine::new(&machine.axes, &machine.channel);
    (merged(&program.contour_as_decoded(machine), &axes), axes)
}

/// The reference's plan, sampled in f64, before the judge.
fn permitted<const AXES: usize>(program: &Program, machine: &MachineData<AXES>) -> Result<(), String> {
    let (contour, axes) = merged_for(program, machine);
    let profiles = plan(&blocks(&contour, &axes), machine.channel.look_ahead as usize);
    let motion = Motion::new(&contour, &profiles, 1.0);
    let cycle = f64::from(machine.channel.cycle_us) * 1e-6;
    let trace = sampled(&contour, cycle, |t| motion.at(t / cycle));
    check::limits(&trace, &axis_limits(machine, &contour))?;
    check::path(&trace, &contour, tolerance::PATH, 3000.0)?;
    check::path(&trace, &program.contour(machine), tolerance::MERGED_PATH, 3000.0)?;
    let start: Vec<i64> = program.start.iter().map(|&nm| set_point(nm)).collect();
    let stops: Vec<_> = program.end_points();
    check::ends(&trace, &start, &stops)
}

/// TRAPEZ, SIN2, STEP.
const SLOPES: [u8; 3] = [1, 2, 0];

fn machines_of<const AXES: usize>(cycle_us: u32, slopes: &[u8]) -> impl Iterator<Item = MachineData<AXES>> {
    slopes.iter().flat_map(move |&slope| {
        [machines::even(cycle_us), machines::uneven(cycle_us), machines::mill(cycle_us)]
            .map(|machine| machines::with_slope(machine, slope))
    })
}

fn judge<const AXES: usize>(programs: impl Iterator<Item = Program>, cycle_us: u32) {
    let mut faults = Vec::new();
    for (program, slopes) in programs.zip(SLOPES.chunks(1).cycle()) {
        for machine in machines_of::<AXES>(cycle_us, slopes) {
            if let Err(fault) = permitted(&program, &machine) {
                let slope = machine.channel.slope_profile;
                faults.push(format!("{}, slope {slope}: {fault}", program.name));
            }
        }
    }
    assert!(faults.is_empty(), "{} faults\n{}", faults.len(), faults.join("\n"));
}

#[test]
fn the_reference_plans_permitted_motions() {
    judge::<2>((2000..2020).map(|seed| program(seed, Mix::general(2, 50))), 1000);
    judge::<3>((2100..2120).map(|seed| program(seed, Mix::general(3, 50))), 1000);
    judge::<3>((2200..2210).map(|seed| program(seed, Mix::surface(3, 300))), 1000);
    judge::<6>((2300..2310).map(|seed| program(seed, Mix::general(6, 50))), 1000);
    judge::<3>((2400..2410).map(|seed| program(seed, Mix::general(3, 50))), 4000);
}

#[test]
fn the_reference_plans_permitted_motions_at_the_edges() {
    judge::<3>(edges::three_axes().into_iter(), 1000);
    judge::<4>(edges::rotary().into_iter(), 1000);
    let named =
        [named::chords(20_000.0, 3), named::slot(6000.0, 3), named::helix(6000.0), named::pocket(20_000.0)];
    judge::<3>(named.into_iter(), 1000);
}

/// Largest relative difference between the library's plan and the reference's.
fn compare<const AXES: usize>(program: &Program, machine: &MachineData<AXES>) -> f64 {
    let run = run::<AXES, 120>(program, machine).unwrap();
    let (contour, axes) = merged_for(program, machine);
    let blocks = blocks_of(&contour, &axes, &run.blocks);
    let profiles = plan(&blocks, machine.channel.look_ahead as usize);
    assert_eq!(run.blocks.len(), profiles.len(), "{}", program.name);
    let mut largest = 0.0_f64;
    // Where a speed was possible only because the next one is lower, that one follows from the difference of
    // a distance and a length: it is known to a part of the higher speed, and the duration 2·length/(v_in +
    // v_out) to twice as much.
    let tight = |p: &Profile| p.rise.time() == 0.0 && p.v_out < 0.7 * p.v_in && p.cruise < 1e-6 * p.time();
    let mut scale_in = 0.0;
    for (i, (block, profile)) in run.blocks.iter().zip(&profiles).enumerate() {
        let pairs = [
            ("length", block.length.to_bits() as f64 / 2f64.powi(44), profile.length),
            ("start speed", block.v_in.to_bits() as f64 * SPEED, profile.v_in),
            ("highest speed", block.v_peak.to_bits() as f64 * SPEED, profile.v_peak),
            ("end speed", block.v_out.to_bits() as f64 * SPEED, profile.v_out),
            ("duration", block.time.to_bits() as f64 / 2f64.powi(36), profile.time()),
        ];
        let scale_out = if tight(profile) { 2.0 * profile.v_in } else { 0.0 };
        for (what, library, reference) in pairs {
            let scale = match what {
                "start speed" => reference.max(scale_in),
                "end speed" => reference.max(scale_out),
                "duration" if tight(profile) => 2.0 * reference,
                _ => reference,
            };
            // A speed is known to its last bit.
            let known = if what.ends_with("speed") { SPEED } else { 0.0 };
            let off = ((library - reference).abs() - known).max(0.0);
            let off = if scale == 0.0 { off } else { off / scale };
            if off > tolerance::PLAN {
                println!(
                    "{}, slope {}, block {i}: {what} {library}, reference {reference}, {off:.2e}\n  {:?}",
                    program.name, machine.channel.slope_profile, program.moves[i]
                );
            }
            largest = largest.max(off);
        }
        scale_in = scale_out;
    }
    largest
}

fn same_plan<const AXES: usize>(programs: impl Iterator<Item = Program>, cycle_us: u32) {
    let mut worst = 0.0_f64;
    for program in programs {
        for machine in machines_of::<AXES>(cycle_us, &SLOPES) {
            worst = worst.max(compare(&program, &machine));
        }
    }
    println!("largest relative difference {worst:.2e}");
    assert!(worst <= tolerance::PLAN, "{worst}");
}

/// Rows: D3-020, D3-269.
#[test]
fn the_library_plans_what_the_reference_plans() {
    same_plan::<1>((2500..2510).map(|seed| program(seed, Mix::general(1, 60))), 1000);
    same_plan::<2>((2510..2520).map(|seed| program(seed, Mix::general(2, 60))), 1000);
    same_plan::<3>((2520..2540).map(|seed| program(seed, Mix::general(3, 60))), 1000);
    same_plan::<3>((2540..2550).map(|seed| program(seed, Mix::surface(3, 500))), 1000);
    same_plan::<6>((2550..2560).map(|seed| program(seed, Mix::general(6, 60))), 1000);
    same_plan::<3>((2560..2564).map(|seed| program(seed, Mix::general(3, 60))), 250);
    same_plan::<3>((2564..2570).map(|seed| program(seed, Mix::general(3, 60))), 4000);
}

#[test]
fn the_library_plans_what_the_reference_plans_at_the_edges() {
    same_plan::<3>(edges::three_axes().into_iter(), 1000);
    same_plan::<4>(edges::rotary().into_iter(), 1000);
    same_plan::<3>([named::pieces(600, 0.2, 60_000.0), named::wave(600, 0.3, 60_000.0)].into_iter(), 1000);
}

/// Fewer than the ring holds: lines straight on, 100 nm to a millimetre long, of two feeds (at most `feed`)
/// so that none grows. With `arcs`, quarter circles behind short ones.
fn short_blocks(seed: u64, feed: f64, arcs: bool) -> Program {
    let mut state = seed;
    let mut next = |n: u64| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) % n
    };
    let mut program = Program::new("short blocks", 3);
    let (mut at, mut along, mut last) = ([0.0, 0.0], 0, 0);
    for block in 0..90 {
        let feed = (feed * (1.0 - 0.02 * (block % 2) as f64)).round();
        // Blocks of one kind twenty in a row, between longer ones.
        let nanometres = match ((block / 20 + seed) % 5, next(8)) {
            (_, 0) => 200_000 + next(800_000),
            (0, _) => 100 + next(300),
            (1, _) => 100 + next(500),
            (2, _) => 20_000 + next(2_000),
            (3, 1..4) => 100 + next(1_900),
            (3, _) => 20_000 + next(60_000),
            (_, 1) => 100 + next(50),
            _ => 300_000 + next(700_000),
        };
        // No two alike, which would be one span.
        let nanometres = if nanometres == last { nanometres + 1 } else { nanometres };
        last = nanometres;
        at[along] += nanometres as f64 * 1e-6;
        program = program.line(&at, feed);
        if arcs && nanometres < 5_000 && next(4) == 0 {
            let radius = 2.0;
            let mut centre = [0.0; 2];
            centre[1 - along] = radius;
            at = [at[0] + radius, at[1] + radius];
            program = program.arc(&at, centre, along == 1, feed);
            along = 1 - along;
        }
    }
    program
}

#[test]
fn the_library_plans_what_the_reference_plans_of_short_blocks() {
    let mut worst = 0.0_f64;
    for (seed, machine) in (0..8).flat_map(|seed| machines_of::<3>(1000, &SLOPES).map(move |m| (seed, m))) {
        let v = f64::from(machine.axes[0].vb_max.min(machine.axes[1].vb_max));
        let feed = 0.9 * v * 0.06;
        worst = worst.max(compare(&short_blocks(seed, feed, seed % 2 == 1), &machine));
    }
    assert!(worst <= tolerance::PLAN, "{worst}");
}

/// Knees of one axis within a tick: the block between them takes a tick where they would add up, and nowhere else.
#[test]
fn the_library_plans_what_the_reference_plans_of_knees_within_a_tick() {
    let mut worst = 0.0_f64;
    for slope in 1..3 {
        for last in [[1.0, -1.0], [1.0, 1.0], [1.0, -0.2]] {
            for between in [&[[0.000_5, 0.0]][..], &[[0.000_1, 0.0], [0.000_2, -0.000_1]]] {
                let blocks = [&[[1.0, 1.0]], between, &[last]].concat();
                worst = worst.max(compare(&beside(&blocks), &turning(slope)));
            }
        }
    }
    assert!(worst <= tolerance::PLAN, "{worst}");
}

/// Chains whose axes turn back within blocks of nanometres to micrometres. Some of these are so short beside their jerk that
/// what their neighbours do shows together with a knee at one end. Speeds near zero follow from differences; times do
/// not.
#[test]
fn the_library_takes_the_time_of_the_reference_over_chains_of_knees() {
    let mut chains = 0;
    for seed in 0..1000 {
        let (program, machine) = chain(seed);
        if machine.channel.slope_profile == 3 {
            continue;
        }
        chains += 1;
        permitted(&program, &machine).unwrap_or_else(|fault| panic!("chain {seed}: {fault}"));
        let run = run::<4, 120>(&program, &machine).unwrap();
        let library: f64 = run.blocks.iter().map(|block| block.time.to_bits() as f64 / 2f64.powi(36)).sum();
        let (contour, axes) = merged_for(&program, &machine);
        let profiles = plan(&blocks_of(&contour, &axes, &run.blocks), machine.channel.look_ahead as usize);
        let reference: f64 = profiles.iter().map(Profile::time).sum();
        let off = (library / reference - 1.0).abs();
        assert!(off <= tolerance::PLAN, "chain {seed}: {library} ticks, reference {reference}");
    }
    assert!(chains > 600, "{chains}");
}

#[test]
fn the_library_plans_what_the_reference_plans_along_feed_axes() {
    let mut worst = 0.0_f64;
    for seed in 2600..2630 {
        let lines = Mix { arcs: 0, ..Mix::general(3, 60) };
        for machine in machines_of::<3>(1000, &SLOPES) {
            for feed in [&[0][..], &[1, 2]] {
                worst = worst.max(compare(&program(seed, lines), &machines::feeding(machine, feed)));
            }
        }
        // Arcs in the plane of two feed axes, helices among them; a rotary axis among three.
        let mix = Mix { arcs: 0, ..Mix::general(5, 40) };
        for machine in machines_of::<5>(1000, &SLOPES) {
            worst = worst.max(compare(&program(seed, mix), &machines::feeding(machine, &[0, 3])));
        }
        for machine in machines_of::<2>(1000, &SLOPES) {
            let program = program(seed, Mix::general(2, 40));
            worst = worst.max(compare(&program, &machines::feeding(machine, &[0, 1])));
        }
    }
    println!("largest relative difference {worst:.2e}");
    assert!(worst <= tolerance::PLAN, "{worst}");
}

/// Of a block of STEP that is just as long as the change of speed needs, the peak is the rounding of a speed: its slopes
/// are longer than the block by 2^-20 of it, and the law is one without a peak.
#[test]
fn a_peak_of_rounding_is_none() {
    for seed in [10_002_932, 11_012_864] {
        let (program, machine, _) = random_setup(seed);
        operate::<3, 120>(&program, &machine, &[], 1000)
            .and_then(|run| operate::judge(&program, &machine, &run))
            .unwrap_or_else(|fault| panic!("seed {seed}: {fault}"));
    }
}

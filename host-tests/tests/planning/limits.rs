//! Seeded random programs: every axis inside its limits at every tick, on the contour, exact at its ends.
use glidepath::machine::MachineData;
use host_tests::cases::random::{Mix, program};
use host_tests::cases::{Program, edges, machines, named};
use host_tests::check::peaks;
use host_tests::operate::{judge, operate, random_setup};
use host_tests::properties::{Verdict, verify};

fn good<const AXES: usize, const BLOCKS: usize>(program: &Program, machine: &MachineData<AXES>) -> Verdict {
    verify::<AXES, BLOCKS>(program, machine).unwrap_or_else(|fault| panic!("{fault}"))
}

/// Machines for a number of axes.
fn machines_of<const AXES: usize>(cycle_us: u32) -> [MachineData<AXES>; 3] {
    [machines::even(cycle_us), machines::uneven(cycle_us), machines::mill(cycle_us)]
}

fn random<const AXES: usize>(seeds: std::ops::Range<u64>, cycle_us: u32) {
    for seed in seeds {
        let machine = &machines_of::<AXES>(cycle_us)[seed as usize % 3];
        let mix = if seed % 4 == 3 { Mix::surface(AXES, 400) } else { Mix::general(AXES, 40) };
        good::<AXES, 120>(&program(seed, mix), machine);
    }
}

#[test]
fn one_axis() {
    random::<1>(100..112, 1000);
}

#[test]
fn two_axes() {
    random::<2>(200..216, 1000);
}

#[test]
fn three_axes() {
    random::<3>(300..330, 1000);
}

/// P-AXIS-00008 limits what an axis of an arc has to do along and across the path together, with every slope: it
/// is kept and used, and more of it takes less time.
///
/// Rows: D3-244.
#[test]
fn an_arc_uses_the_highest_acceleration_of_its_axes() {
    for slope in 0..4 {
        let mut last = f64::MAX;
        for a_max in [2000, 2200, 2400] {
            let mut machine = machines::even::<3>(1000);
            machine.axes.iter_mut().for_each(|axis| {
                (axis.vb_max, axis.vb_eilgang) = (2_000_000, 2_000_000);
                machines::accelerations(axis, 2000, a_max);
                axis.tr_geom = 10_000;
            });
            let machine = machines::with_slope(machine, slope);
            let arc = Program::new("arc", 3).arc(&[400.0, 0.0], [200.0, 0.0], true, 120_000.0);
            let run = good::<3, 120>(&arc, &machine).run;
            let seen = [0, 1].map(|k| peaks(&run.trace.columns[k], 0.001).values[1] / f64::from(a_max));
            // With STEP a quarter is left to knees.
            let most = if slope == 0 { 0.75 } else { 1.0 } + 1e-4;
            assert!(seen.iter().all(|part| *part < most), "slope {slope}, {a_max} mm/s²: {seen:?}");
            assert!(run.trace.time() < last, "slope {slope}, {a_max} mm/s²");
            last = run.trace.time();
        }
    }
}

#[test]
fn five_axes() {
    random::<5>(500..512, 1000);
}

#[test]
fn six_axes() {
    random::<6>(600..612, 1000);
}

#[test]
fn other_cycles() {
    random::<3>(700..704, 100);
    random::<3>(704..712, 4000);
    random::<4>(712..720, 10_000);
}

#[test]
fn arbitrary_machines() {
    // `cargo run --release -p host-tests --example soak -- 0 5000` goes on with it.
    for seed in host_tests::seeds::seeds(0..80, 8) {
        good::<1, 120>(&program(seed, Mix::arbitrary(1, seed)), &machines::arbitrary(seed));
        good::<3, 120>(&program(seed, Mix::arbitrary(3, seed)), &machines::arbitrary(seed));
    }
}

/// Rows: D3-013.
#[test]
fn edges_of_three_axes() {
    for program in edges::three_axes() {
        for machine in &machines_of::<3>(1000) {
            good::<3, 120>(&program, machine);
        }
    }
}

#[test]
fn a_steep_helix_turns_as_fast_as_its_circle() {
    // A turn of radius 1 mm while Z goes 20 mm: the path is three times as long as the circle.
    for slope in 1..4 {
        let mut machine = machines::even::<3>(4000);
        machine.channel.slope_profile = slope;
        // A slow third axis leaves the speed to the circle.
        machines::accelerations(&mut machine.axes[2], 300, 300);
        let mut program = Program::new("steep helix", 3);
        for turn in 1..=12 {
            program = program.arc(&[0.0, 0.0, 20.0 * f64::from(turn)], [1.0, 0.0], true, 20_000.0);
        }
        good::<3, 120>(&program, &machine);
    }
}

#[test]
fn path_distance_goes_round() {
    // 600 m of path: its distance, ±2^19 mm, passes its end.
    let mut program = Program::new("to and fro", 3);
    for i in 1..=6 {
        let x = 50_000.0 - 100_000.0 * f64::from(i % 2);
        program = program.line(&[x, f64::from(i)], 60_000.0);
    }
    let verdict = good::<3, 120>(&program, &machines::examples(1000));
    assert!(verdict.course.s.last().is_some_and(|s| *s > 524_288.0), "{:?}", verdict.course.s.last());
}

#[test]
fn edges_of_rotary_axes() {
    for program in edges::rotary() {
        for machine in &machines_of::<4>(1000) {
            good::<4, 120>(&program, machine);
        }
    }
}

#[test]
fn a_contour_is_never_left_out_between_ticks() {
    // Acceleration along the contour: no more than all axes together give.
    for seed in 800..812 {
        let machine = machines::even::<3>(1000);
        let verdict = good::<3, 120>(&program(seed, Mix { rapids: 0, ..Mix::general(3, 40) }), &machine);
        let (a, allowance, tick) = verdict.course.acceleration(0.001);
        assert!(a <= 2000.0 * 3f64.sqrt() + allowance, "seed {seed}: {a} + {allowance} at {tick}");
    }
}

/// Blocks of two feeds by turns, which are not merged.
fn unlike(mut program: Program) -> Program {
    for block in program.moves.iter_mut().step_by(2) {
        block.feed *= 0.999;
    }
    program
}

/// Rows: D3-199, D3-220, C40-056, C40-057, C40-058, C40-059.
#[test]
fn depth_of_look_ahead_costs_time_only() {
    let random = (900..904).map(|seed| program(seed, Mix::surface(3, 500)));
    for program in random.chain([unlike(named::pieces(600, 0.2, 60_000.0)), named::wave(600, 0.3, 60_000.0)])
    {
        let machine = |look_ahead| {
            let mut machine = machines::mill::<3>(1000);
            machine.channel.look_ahead = look_ahead;
            machine
        };
        let ticks = [
            good::<3, 30>(&program, &machine(30)).run.trace.ticks(),
            good::<3, 120>(&program, &machine(120)).run.trace.ticks(),
            good::<3, 190>(&program, &machine(190)).run.trace.ticks(),
        ];
        // One tick: where the end falls between ticks.
        let name = &program.name;
        assert!(ticks[0] + 1 >= ticks[1] && ticks[1] + 1 >= ticks[2], "{name}: {ticks:?}");
        // Six millimetres in view are too few for the feed: depth is in use.
        if name.contains("pieces") {
            assert!(3 * ticks[0] > 4 * ticks[1] && 20 * ticks[1] > 21 * ticks[2], "{name}: {ticks:?}");
        }
        // The memory may be larger than the depth asked for.
        let less = good::<3, 190>(&program, &machine(30));
        assert_eq!(less.run.trace.ticks(), ticks[0]);
    }
}

/// STEP gains speed from a knee on at once: the next one came within two ticks, though its block is as long
/// as three at the speed of the first (225.2 of 225 mm/s²).
#[test]
fn knees_that_step_brings_close_share_the_acceleration() {
    let (program, machine, _) = random_setup(107_052);
    assert_eq!(machine.channel.slope_profile, 0);
    let run = operate::<3, 120>(&program, &machine, &[], 1000).unwrap();
    judge(&program, &machine, &run).unwrap();
}

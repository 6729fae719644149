//! The same program in another place, direction or order, or run again, is the same motion.
use host_tests::cases::random::{Mix, program};
use host_tests::cases::{Program, machines, named};
use host_tests::tolerance::MIRROR;
use host_tests::trace::{Run, Trace, run, run_in_bursts};

fn of(program: &Program) -> Run {
    run::<3, 120>(program, &machines::even(1000)).unwrap()
}

/// Largest difference of `a` and the columns of `b` taken from `columns` with their sign, LSB.
fn difference(a: &Trace, b: &Trace, columns: [(usize, i64); 3]) -> i64 {
    assert_eq!(a.ticks(), b.ticks());
    let each = columns.into_iter().enumerate().map(|(k, (from, sign))| {
        let pairs = a.columns[k].iter().zip(&b.columns[from]);
        pairs.map(|(x, y)| (x - sign * y).abs()).max().unwrap_or(0)
    });
    each.max().unwrap_or(0)
}

fn samples() -> impl Iterator<Item = Program> {
    let random = (1000..1012).map(|seed| program(seed, Mix::general(3, 40)));
    random.chain([named::chords(20_000.0, 3), named::helix(6000.0), named::pocket(12_000.0)])
}

#[test]
fn mirrored() {
    for program in samples() {
        let plain = of(&program);
        for axis in 0..3 {
            let mut columns = [(0, 1), (1, 1), (2, 1)];
            columns[axis].1 = -1;
            let other = of(&program.mirrored(axis));
            let off = difference(&plain.trace, &other.trace, columns);
            assert!(off <= MIRROR, "{} mirrored in {axis}: {off} LSB", program.name);
        }
    }
}

#[test]
fn turned_by_a_quarter() {
    for seed in 1100..1112 {
        // Arcs in the XY plane only: the others would need planes that do not exist.
        let mut program = program(seed, Mix { arcs: 0, ..Mix::general(3, 40) });
        if seed % 3 == 0 {
            program = named::slot(f64::from(seed as u32) * 5.0, 3);
        }
        let (plain, other) = (of(&program), of(&program.turned()));
        let off = difference(&plain.trace, &other.trace, [(1, 1), (0, -1), (2, 1)]);
        assert!(off <= MIRROR, "{}: {off} LSB", program.name);
    }
}

#[test]
fn reversed_takes_the_same_time() {
    // Acceleration and deceleration are alike on this machine, and all blocks are in view: time may run
    // backward.
    for program in samples().filter(|p| p.moves.len() < 100) {
        let (plain, other) = (of(&program), of(&program.reversed()));
        // Every standstill waits for the next tick.
        let stops = plain.blocks.iter().filter(|b| b.v_out.to_bits() == 0).count() as i64;
        let off = plain.trace.ticks() as i64 - other.trace.ticks() as i64;
        // A corner without a curve is judged by what the corner before it has left of the block between them:
        // where passing and standing still take the same time, the order decides.
        let ties = plain.trace.ticks() as i64 / 10_000;
        assert!(off.abs() <= stops + 1 + ties, "{}: {off} ticks, {stops} stops", program.name);
    }
}

#[test]
fn same_bits_again_and_whenever_the_planner_gets_its_turn() {
    for seed in host_tests::seeds::seeds(1200..1208, 2) {
        let program = program(seed, Mix::general(6, 60));
        let machine = machines::mill::<6>(1000);
        let first = run::<6, 120>(&program, &machine).unwrap();
        assert_ne!(first.digest, 0);
        for burst in [1, 3, 17] {
            let again = run_in_bursts::<6, 120>(&program, &machine, burst).unwrap();
            assert_eq!(first.trace, again.trace, "seed {seed}, {burst} ticks a turn");
            assert_eq!((first.digest, &first.blocks), (again.digest, &again.blocks));
        }
    }
}

#[test]
fn the_digest_is_fnv_1a_over_all_set_points() {
    let run = of(&named::slot(6000.0, 3));
    let mut hash = 0xcbf2_9ce4_8422_2325_u64;
    for tick in 0..run.trace.len() {
        for x in run.trace.row(tick) {
            for half in [x as u32, (x >> 32) as u32] {
                hash = (hash ^ u64::from(half)).wrapping_mul(0x100_0000_01b3);
            }
        }
    }
    assert_eq!(run.digest, hash);
}

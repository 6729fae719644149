//! Blocks that continue in a straight line are merged: as fast as the whole line, and no function at a point
//! between is lost.
use glidepath::channel::{Channel, Handles, Progress};
use glidepath::machine::MachineData;
use glidepath::quantity::Position;
use glidepath::queue::Function;
use glidepath::tick::State;
use host_tests::calls::call;
use host_tests::cases::random::Random;
use host_tests::cases::{Program, machines};
use host_tests::properties::{Verdict, verify};
use host_tests::trace::{Run, run_text};

/// From zero to `end` in `blocks` pieces of random lengths, the longest four times the shortest, rounded to
/// six decimals.
fn cut(end: &[f64], blocks: usize, seed: u64, feed: f64) -> Program {
    let mut random = Random::new(seed);
    let lengths: Vec<f64> = (0..blocks).map(|_| random.between(1.0, 4.0)).collect();
    let total: f64 = lengths.iter().sum();
    let mut program = Program::new(format!("line to {end:?} in {blocks} pieces"), end.len());
    let mut at = 0.0;
    for length in &lengths[1..] {
        at += length;
        program = program.line(&end.iter().map(|x| x * at / total).collect::<Vec<_>>(), feed);
    }
    program.line(end, feed)
}

fn good<const AXES: usize>(program: &Program, machine: &MachineData<AXES>) -> Verdict {
    verify::<AXES, 120>(program, machine).unwrap_or_else(|fault| panic!("{fault}"))
}

/// Lines of 100 mm.
const ENDS: [[f64; 3]; 5] = [
    [100.0, 0.0, 0.0],
    [57.735_027, 57.735_027, -57.735_027],
    [62.354_971, 53.12, 57.333_1],
    [99.417, 10.3, 3.1],
    [-0.01, 70.710_679, 70.710_677],
];

/// So many ticks more than the whole line, at most: absolute, and of the whole.
fn pieces_take_as_long(slope: u8, absolute: usize, relative: f64) {
    let machine = machines::with_slope(machines::examples::<3>(1000), slope);
    for (end, seed) in ENDS.iter().zip(1..) {
        let whole = good(&cut(end, 1, 0, 10_000.0), &machine).run.trace.ticks();
        for blocks in [2, 10, 100, 1000, 10_000] {
            let ticks = good(&cut(end, blocks, seed, 10_000.0), &machine).run.trace.ticks();
            let most = absolute + (whole as f64 * relative) as usize;
            println!("slope {slope}: {end:?} in {blocks}: {ticks} ticks, whole {whole}");
            assert!(
                ticks.abs_diff(whole) <= most,
                "{end:?}, {blocks} pieces: {ticks} ticks, one piece {whole}"
            );
        }
    }
}

#[test]
fn a_line_in_pieces_takes_the_same_time_with_hsc() {
    pieces_take_as_long(3, 1, 0.0);
}

#[test]
fn a_line_in_pieces_takes_nearly_the_same_time_with_trapez_sin2_and_step() {
    for slope in [1, 2, 0] {
        pieces_take_as_long(slope, 0, 0.02);
    }
}

#[test]
fn a_rotary_axis_goes_along() {
    let machine = machines::with_slope(machines::even::<4>(1000), 3);
    for end in [[40.0, 30.0, 0.0, 77.7], [0.0, 0.0, 0.0, 90.0], [0.001, 0.0, 0.0, 45.0]] {
        let whole = good::<4>(&cut(&end, 1, 0, 6000.0), &machine).run;
        let pieces = good::<4>(&cut(&end, 50, 9, 6000.0), &machine).run;
        assert!(pieces.blocks.len() < 5, "{end:?}: {} spans", pieces.blocks.len());
        let [pieces, whole] = [pieces, whole].map(|run| run.trace.ticks());
        assert!(pieces.abs_diff(whole) <= 1, "{end:?}: {pieces} ticks, one piece {whole}");
    }
}

/// A program on three axes.
fn motion(text: &str, slope: u8) -> Run {
    let machine = machines::with_slope(machines::examples::<3>(1000), slope);
    run_text::<3, 120>(text, [Position::ZERO; 3], &machine, 1)
        .unwrap_or_else(|fault| panic!("{text}: {fault}"))
}

/// STEP has a span for each line.
fn spans(text: &str) -> usize {
    motion(text, 0).blocks.len()
}

#[test]
fn only_what_goes_on_alike_is_merged() {
    let one = "N10 G01 X1 Y0.5 F5000\nN20 X2 Y1\nN30 X3 Y1.5\nM30\n";
    assert_eq!(spans(one), 1);
    let run = motion(one, 1);
    // The N number of the last, the count of all.
    assert_eq!((run.blocks[0].n, run.blocks[0].block, run.blocks[0].blocks), (30, 0, 3));
    for (text, lines) in [
        // Feed, kind of motion, direction.
        ("G01 X1 F5000\nX2 F5001\nM30\n", 2),
        ("G01 X1 F5000\nG00 X2\nX3\nM30\n", 2),
        ("G01 X1 F5000\nX0.5\nX1\nM30\n", 3),
        ("G01 X1 F5000\nX2 Y0.0001\nM30\n", 2),
        ("G01 X1 F5000\nX2 Y0.000001\nX3 Y0\nM30\n", 1),
        ("G01 X1 F5000\nX2 Y0.000002\nX3 Y0\nM30\n", 2),
        // What belongs to the point between.
        ("G60 G01 X1 F5000\nX2\nM30\n", 2),
        ("G01 X1 F5000\nM5\nX2\nM30\n", 2),
        ("G01 X1 F5000\nG04 0.1\nX2\nM30\n", 2),
        ("G01 X1 F5000\nG130 X50\nX2\nM30\n", 2),
        ("G01 X1 F5000\n#SLOPE [TYPE=TRAPEZ]\nX2\nM30\n", 2),
        ("G01 X1 F5000\n#VECTOR LIMIT ON [VEL=100]\nX2\nM30\n", 2),
        ("G01 X1 F5000\nG61 X2\nX3\nM30\n", 3),
        // An exact stop at its end, also when it comes without motion.
        ("G01 X1 F5000\nG60 X2\nX3\nM30\n", 2),
        ("G01 X1 F5000\nX2\nG60 X2\nX3\nM30\n", 2),
        // Nothing in between.
        ("G01 X1 F5000\nX1\nX2\nM30\n", 1),
        ("G00 X1\nX2\nM30\n", 1),
    ] {
        assert_eq!(spans(text), lines, "{text}");
    }
}

#[test]
fn an_exact_stop_stays_where_it_is() {
    for slope in [0, 1, 2, 3] {
        let run = motion("G01 X10 F5000\nG60 X20\nX30\nX40\nG60 X40\nX50\nM30\n", slope);
        let stands: Vec<i64> =
            run.blocks.iter().filter(|b| b.v_out.to_bits() == 0).map(|b| b.length.to_bits() >> 44).collect();
        assert_eq!(stands, [20, 20, 10], "slope {slope}");
    }
}

#[test]
fn events_come_at_their_points() {
    let text = b"N10 G01 X10 F5000\nN20 X20\nN30 M5\nN40 X30\nN50 X40\nN60 H7\nM30\n";
    let machine = machines::with_slope(machines::examples::<3>(1000), 3);
    let mut channel = Channel::<3, 120>::new();
    let Handles { mut planner, mut interpolator, operator } =
        channel.split(&machine, [Position::ZERO; 3], &text[..]).unwrap();
    let mut seen = Vec::new();
    let mut done = false;
    let mut before = 0.0;
    loop {
        done = done || call(&mut planner, usize::MAX, |_| {}).unwrap();
        if interpolator.tick() == State::Idle && done {
            break;
        }
        let x = interpolator.set_points()[0].to_bits() as f64 / 2f64.powi(32);
        while let Some(event) = operator.output() {
            seen.push((event.function, before, x));
        }
        before = x;
    }
    let at = |function: Function| *seen.iter().find(|(f, ..)| *f == function).unwrap();
    let (_, before, x) = at(Function::M(5));
    assert!(before < 20.0 && x >= 20.0, "M5 between {before} and {x}");
    assert_eq!(at(Function::H(7)).2, 40.0);
}

/// Lines of many pieces there and back: they stand for more blocks than 16 bits count, and would all be in the queue at
/// once. N says which block it is.
#[test]
fn blocks_are_counted_over_lines_of_many_pieces() {
    const PIECES: u32 = 8000;
    let mut text = String::from("G01 F10000\n");
    for block in 0..12 * PIECES {
        let (leg, piece) = (block / PIECES, block % PIECES + 1);
        let at = if leg % 2 == 0 { piece } else { PIECES - piece };
        text.push_str(&format!("N{} X{:.3}\n", block + 1, 0.001 * f64::from(at)));
    }
    text.push_str("M30\n");
    let machine = machines::with_slope(machines::examples::<3>(1000), 1);
    let mut channel = Channel::<3, 120>::new();
    let Handles { mut planner, mut interpolator, operator } =
        channel.split(&machine, [Position::ZERO; 3], text.as_bytes()).unwrap();
    let (mut done, mut last) = (false, 0);
    while !done || interpolator.tick() == State::Active {
        let (telemetry, status) = (interpolator.telemetry(), operator.status());
        last = telemetry.block;
        assert!(telemetry.n == 0 || telemetry.n == last + 1, "N{} in block {last}", telemetry.n);
        assert_eq!((status.n, status.block), (telemetry.n, last));
        while !done {
            match planner.poll().unwrap() {
                Progress::Done => done = true,
                Progress::Waiting => {
                    interpolator.tick();
                    break;
                }
                _ => {}
            }
        }
    }
    assert_eq!(last, 12 * PIECES - 1);
}

#[test]
fn the_machine_moves_before_a_long_line_is_read() {
    // 20,000 blocks of 50 µm: 1 m.
    let mut text = String::from("N1 G01 F10000\n");
    for i in 1..=20_000 {
        text.push_str(&format!("N{i} X{:.6}\n", 0.05 * f64::from(i)));
    }
    text.push_str("M30\n");
    for slope in [0, 1, 2, 3] {
        let machine = machines::with_slope(machines::examples::<3>(1000), slope);
        let mut channel = Channel::<3, 120>::new();
        let Handles { mut planner, .. } =
            channel.split(&machine, [Position::ZERO; 3], text.as_bytes()).unwrap();
        while planner.poll().unwrap() != Progress::Planned {}
        let planned = planner.planned();
        let read = planned.block + planned.blocks;
        println!("slope {slope}: planned up to block {read}");
        // A stop takes 14 mm: a span of twice that, or all of one that was read.
        assert!(read < 5000, "slope {slope}: read up to block {read}");
        while !matches!(planner.poll().unwrap(), Progress::Waiting | Progress::Done) {}
    }
}

//! Program text that comes late, and a planner that is too slow: the motion slows down with its slope, stops
//! at the end of the known path, resumes, and loses nothing.
use glidepath::machine::MachineData;
use glidepath::quantity::Position;
use host_tests::cases::random::{Mix, Random, program};
use host_tests::cases::{Program, machines, named};
use host_tests::check;
use host_tests::operate::{
    Act, LONGEST, Operated, TOO_LONG, is_long, judge, longest, operate, operate_text, random_acts,
    random_setup, with_overrides, with_starvation,
};
use host_tests::properties::permitted;
use host_tests::trace;

/// The judged run of a program whose text comes as told.
fn run(program: &Program, machine: &MachineData<3>, acts: &[(usize, Act)]) -> Operated {
    let run = operate::<3, 120>(program, machine, acts, 1000).unwrap();
    judge(program, machine, &run).unwrap_or_else(|fault| panic!("{} {acts:?}: {fault}", program.name));
    run
}

/// A machine that looks ten blocks ahead.
fn machine(slope: u8) -> MachineData<3> {
    let mut machine = machines::with_slope(machines::mill(1000), slope);
    machine.channel.look_ahead = 10;
    machine
}

/// The first and the last tick of each standstill between first and last motion, however short.
fn stands(run: &Operated) -> Vec<[usize; 2]> {
    let moves: Vec<usize> =
        (1..run.distances.len()).filter(|&k| run.distances[k] != run.distances[k - 1]).collect();
    moves.windows(2).filter(|pair| pair[1] > pair[0] + 1).map(|pair| [pair[0] + 1, pair[1] - 1]).collect()
}

/// Text that is late before each tick of a program, until any queue has run out.
fn late_before_every_tick(slope: u8) {
    /// Ticks that outlast any queue of the program.
    const LONG: usize = 3000;
    // Other feeds: the blocks stay blocks.
    let mut program = Program::new("line", 3);
    for k in 1..=120 {
        program = program.line(&[0.5 * f64::from(k), 0.0, 0.0], [3000.0, 3300.0][k as usize % 2]);
    }
    let machine = machine(slope);
    let plain = run(&program, &machine, &[]);
    let (ticks, mut stood) = (plain.distances.len(), 0);
    for tick in 1..ticks {
        let late = run(&program, &machine, &[(tick, Act::Starve(LONG))]);
        // All had been read already, or it stands once, for what is left of the time.
        let stands = stands(&late);
        assert_eq!(
            stands.len(),
            late.starved.len(),
            "slope {slope}, tick {tick}: {stands:?} {:?}",
            late.starved
        );
        for ([from, to], said) in stands.iter().zip(&late.starved) {
            stood += 1;
            // Said where the last block is handed on; it moves as soon as there is text.
            assert!((tick..=*from).contains(said), "slope {slope}, tick {tick}: {said}, {from}");
            assert!((tick + LONG - 1..tick + LONG + 3).contains(to), "slope {slope}, tick {tick}: {to}");
        }
        assert!(stands.len() <= 1, "slope {slope}, tick {tick}: {stands:?} {:?}", late.starved);
        assert_eq!(late.distances.last(), plain.distances.last(), "slope {slope}, tick {tick}");
    }
    println!("slope {slope}: {stood} of {ticks} stand");
    assert!(stood > ticks / 5, "slope {slope}: {stood} of {ticks}");
}

/// Rows: OP-03.
#[test]
fn late_before_any_tick_it_stands_at_the_end_of_what_there_is_with_step() {
    late_before_every_tick(0);
}

#[test]
fn late_before_any_tick_it_stands_at_the_end_of_what_there_is_with_trapez() {
    late_before_every_tick(1);
}

#[test]
fn late_before_any_tick_it_stands_at_the_end_of_what_there_is_with_sin2() {
    late_before_every_tick(2);
}

#[test]
fn late_before_any_tick_it_stands_at_the_end_of_what_there_is_with_hsc() {
    late_before_every_tick(3);
}

#[test]
fn a_short_delay_is_not_felt() {
    // Ten blocks of 0.8 mm at 50 mm/s last 160 ms.
    for slope in 0..4 {
        let (program, machine) = (named::wave(60, 0.8, 3000.0), machine(slope));
        let plain = run(&program, &machine, &[]);
        for tick in (100..800).step_by(50) {
            let late = run(&program, &machine, &[(tick, Act::Starve(20))]);
            assert_eq!(plain.trace, late.trace, "slope {slope}, tick {tick}");
        }
    }
}

#[test]
fn text_that_trickles_in_moves_as_it_comes() {
    for slope in 0..4 {
        let program = named::wave(60, 0.8, 3000.0);
        let machine = machine(slope);
        let bytes = program.text(&machine).len();
        let plain = run(&program, &machine, &[]).distances.len();
        for rate in [1, 2, 5, 13] {
            let slow = run(&program, &machine, &[(0, Act::Slow(rate))]);
            // Behind the slower one of text and motion comes no more than the way of a few blocks.
            let (needed, ticks) = (plain.max(bytes / rate), slow.distances.len());
            assert!(
                ticks < needed + 300,
                "slope {slope}, {rate} bytes a tick: {ticks} ticks, {needed} needed"
            );
            println!("slope {slope}, {rate} bytes a tick: {ticks} ticks, {needed} needed");
        }
    }
}

/// Corners of a zigzag in contour mode: each takes the planner dozens of calls.
fn zigzag(pitch: f64, method: &str) -> String {
    let mut text = format!("%zigzag\n#CONTOUR MODE [{method}]\nG01 X0.1 G261 F9000\n");
    for k in 1..150 {
        let y = [0.0, 0.3, 0.1, 0.7][k as usize % 4] * pitch;
        text += &format!("X{:.3} Y{y:.3}\n", 0.1 + pitch * f64::from(k));
    }
    text + "G260\nM30\n"
}

/// A planner with a few calls a tick, with all of the text or as it trickles in, in contour mode too: without
/// handing on what there is before the next corner is made, the queue ran out at speed.
///
/// Rows: OP-04.
#[test]
fn a_planner_that_does_not_keep_up_brakes() {
    let zigzags = [(1.0, "DEV PATH_DEV=0.05"), (0.3, "DEV PATH_DEV=0.02"), (3.0, "DIST_SOFT PATH_DIST=0.5")]
        .map(|(pitch, method)| zigzag(pitch, method));
    for slope in 0..4 {
        let machine = machines::with_slope(machines::mill::<3>(1000), slope);
        let limits: Vec<_> =
            machine.axes.iter().map(|axis| permitted(axis, slope, false, true, true)).collect();
        for text in &zigzags {
            let mut longest = 0;
            for polls in [2, 5, 12, 40, 1000] {
                for acts in [&[][..], &[(0, Act::Slow(3))], &[(0, Act::Slow(30))]] {
                    let run =
                        operate_text::<3, 120>(text, [Position::ZERO; 3], &machine, acts, polls).unwrap();
                    check::limits(&run.trace, &limits).unwrap_or_else(|fault| {
                        panic!("slope {slope}, {polls} calls, {acts:?}: {fault}\n{text}")
                    });
                    longest = longest.max(run.trace.len());
                }
            }
            println!("slope {slope}: {longest} ticks at most");
        }
        for polls in [1, 3] {
            for program in [named::wave(60, 0.8, 3000.0), named::wave(600, 0.05, 3000.0)] {
                let run = operate::<3, 120>(&program, &machine, &[], polls).unwrap();
                judge(&program, &machine, &run).unwrap();
            }
        }
    }
}

#[test]
fn random_programs_late_held_and_overridden() {
    for seed in host_tests::seeds::seeds((0..200).chain([36_576_798]), 20) {
        let mut machine = machines::arbitrary::<3>(seed);
        machine.channel.slope_profile = (seed % 4) as u8;
        let program = program(seed, Mix::arbitrary(3, seed));
        let mut random = Random::new(seed + 5000);
        let acts = if random.once_in(2) { random_acts(&mut random, 3000) } else { Vec::new() };
        let acts = if random.once_in(2) { with_overrides(&mut random, 3000, acts) } else { acts };
        let acts = with_starvation(&mut random, 3000, acts);
        let last = acts.last().map_or(0, |(tick, _)| *tick);
        let verdict = operate::<3, 120>(&program, &machine, &acts, 1000)
            .and_then(|run| judge(&program, &machine, &run));
        // Some take so long whoever is beside them: 36576798 does.
        if let Err(fault) = verdict {
            assert!(fault.ends_with(TOO_LONG) && is_long(&program, &machine, last), "{acts:?}: {fault}");
        }
    }
}

/// With a standstill at the end of each block it takes longest: by that a run is known that was given up and is
/// a good one. Some programs have these standstills.
#[test]
fn nothing_takes_longer_than_with_standstills() {
    let mut compared = 0;
    for seed in 0..48 {
        let (mut program, machine, _) = random_setup(seed);
        let most = longest(&program, &machine);
        if seed / 4 % 2 == 0 {
            program.moves.iter_mut().for_each(|block| block.stop = true);
        }
        if most > 20_000.0 {
            continue;
        }
        let run = operate::<3, 120>(&program, &machine, &[], 1000).unwrap();
        // A standstill is at a tick; the first and the last one are at rest.
        let whole = most + (program.moves.len() + 2) as f64;
        assert!(run.distances.len() as f64 <= whole, "seed {seed}: {} above {most}", run.distances.len());
        compared += 1;
    }
    assert!(compared > 20, "{compared}");
}

/// HSC has one ramp time, and stops as TRAPEZ does with the longest ramps: a program of a million ticks with holds is not a
/// fault. What is expected is what the program takes.
#[test]
fn a_long_program_with_hsc_is_long() {
    let (program, machine, _) = random_setup(1_001_343);
    let takes = trace::run::<3, 120>(&program, &machine).expect("the program runs").trace.ticks();
    assert!((900_000..LONGEST).contains(&takes), "{takes}");
    // Each block takes whole ticks.
    let last = LONGEST - takes + program.moves.len();
    assert!(is_long(&program, &machine, last) && !is_long(&program, &machine, 0), "{takes}");
}

/// The ring is never full: everything is handed on as it comes. With the last seed a block once was planned
/// for a standstill at its end, and too short for the higher speed that came later.
#[test]
fn random_programs_that_trickle_in() {
    for seed in host_tests::seeds::seeds((0..200).chain([3371]), 20) {
        let mut machine = machines::arbitrary::<3>(seed);
        machine.channel.slope_profile = (seed % 4) as u8;
        run(&program(seed, Mix::arbitrary(3, seed)), &machine, &[(0, Act::Slow(2 + seed as usize % 5))]);
    }
}

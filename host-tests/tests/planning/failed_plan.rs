//! A plan that fails during the motion: the axes stop inside their limits, with any commands in between. The
//! channel continues from the position of the standstill.
use glidepath::channel::{Channel, Error, Handles, Progress};
use glidepath::machine::MachineData;
use glidepath::quantity::Position;
use glidepath::tick::State;
use host_tests::cases::random::Random;
use host_tests::cases::{Program, machines};
use host_tests::check;
use host_tests::operate::{Act, random_acts, with_overrides};
use host_tests::properties::axis_limits;
use host_tests::trace::Trace;

/// Ticks of a run, at most.
const LONGEST: usize = 40_000;

/// Long and short lines to both sides.
fn lines(random: &mut Random) -> Program {
    let mut program = Program::new("long", 3);
    for k in 0..12 {
        let side = if k % 2 == 0 { 1.0 } else { -1.0 };
        let long = if random.once_in(3) { 20.0 * random.unit() } else { 300.0 + 600.0 * random.unit() };
        let feed = 500.0 + 20_000.0 * random.unit();
        program = program.line(&[side * long, 40.0 * random.unit(), 3.0 * random.unit()], feed);
    }
    program
}

/// A machine with any slope and mode of the override. At its reduced speed 134 mm take 2^27 ticks.
fn machine(seed: u64) -> MachineData<3> {
    let mut machine = machines::arbitrary::<3>(seed);
    machine.channel.slope_profile = (seed % 4) as u8;
    machine.channel.override_weight_prog_feed = (seed / 4 % 3) as u8;
    machine.channel.cycle_us = 1000;
    machine.axes[0].vb_max_red = 1;
    machine
}

/// Commands at random ticks, the reduced speed among them.
fn acts(random: &mut Random) -> Vec<(usize, Act)> {
    let others = if random.once_in(2) { random_acts(random, 2000) } else { Vec::new() };
    let others = others.into_iter().filter(|(_, act)| *act != Act::Abort).collect();
    let mut acts = with_overrides(random, 2000, others);
    let on = (random.unit() * 2000.0) as usize;
    acts.push((on, Act::Reduced(true)));
    for _ in 0..3 {
        // Slowed down further while the motion stops.
        acts.push(((on + random.magnitude(1.0, 100.0) as usize).min(2000), Act::Override(1)));
    }
    acts.sort_by_key(|(tick, _)| *tick);
    acts
}

/// Runs to a standstill, then to the end of another program; whether a plan failed.
fn stops_and_lives_on(seed: u64) -> bool {
    let (mut random, mut machine) = (Random::new(seed), machine(seed));
    machine.channel.look_ahead = 10 + (seed % 20) as u32;
    let program = lines(&mut random);
    let acts = acts(&mut random);
    let text = program.text(&machine);
    let again = "G91 G01 X5 F1000\nM30\n";
    let mut channel: Box<Channel<3, 30>> = Box::new(Channel::new());
    let handles = channel.split(&machine, [Position::ZERO; 3], text.as_bytes()).unwrap();
    let Handles { mut planner, mut interpolator, operator } = handles;
    let mut trace = Trace::empty(1e-3, 3);
    let mut acts = acts.into_iter().peekable();
    let (mut failed, mut ended, mut rest) = (false, 0, 0);
    for tick in 0..LONGEST {
        if tick == LONGEST / 2 {
            // A slow machine.
            operator.abort();
        }
        while let Some((_, act)) = acts.next_if(|(at, _)| *at <= tick) {
            act.give(&operator);
        }
        let done = loop {
            match planner.poll() {
                Ok(Progress::Waiting) => break false,
                Ok(Progress::Done) => break true,
                Ok(_) => {}
                Err(error) => {
                    assert_eq!(error, Error::ReducedTooSlow, "seed {seed}, tick {tick}");
                    assert!(!failed, "seed {seed}, tick {tick}: it fails twice");
                    failed = true;
                }
            }
        };
        let state = interpolator.tick();
        trace.push(interpolator.set_points().iter().map(|p| p.to_bits()));
        if done && state == State::Idle {
            assert!(planner.is_at_rest(), "seed {seed}, tick {tick}: not at rest");
            assert_eq!(planner.position(), interpolator.set_points(), "seed {seed}, tick {tick}");
            ended += 1;
            if ended == 2 {
                break;
            }
            operator.resume();
            operator.set_override(1000);
            operator.set_reduced(false);
            acts = Vec::new().into_iter().peekable();
            assert!(planner.load(again.as_bytes()).is_ok(), "seed {seed}: at rest");
        }
        rest = if state == State::Idle { rest + 1 } else { 0 };
        assert!(rest < 50_000, "seed {seed}: nothing moves at tick {tick}");
    }
    assert_eq!(ended, 2, "seed {seed}: no end");
    let limits = axis_limits(&machine, &program.contour(&machine));
    check::limits(&trace, &limits).unwrap_or_else(|fault| panic!("seed {seed}: {fault}"));
    failed
}

#[test]
fn a_plan_that_fails_in_motion_ends_in_a_standstill_inside_all_limits() {
    let failed = (0..1500).filter(|&seed| stops_and_lives_on(seed)).count();
    assert!(failed > 400, "{failed} of 1500 runs fail");
}

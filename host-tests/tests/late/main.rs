//! Late synchronisation: functions whose acknowledgement is needed later than in their block, MVS_SLM,
//! MVS_SLP with #EXPL SYN, and FAW_SYNCH, after which the program continues when the motion has reached this
//! block.
use glidepath::channel::{Channel, Handles, Progress};
use glidepath::machine::{MachineData, Synch, SynchTable};
use glidepath::operator::Operator;
use glidepath::quantity::Position;
use glidepath::technology::Function;
use glidepath::tick::State;
use glidepath::variable::{Access, Variable};
use host_tests::cases::machines;

mod shift;

/// M24 and M25 are MVS_SLM, M26 and M27 are MVS_SLP, M28 is MOS and FAW_SYNCH.
fn machine() -> MachineData<3> {
    let mut machine = machines::with_slope(machines::even(1000), 1);
    machine.channel.m_synch = SynchTable::NONE
        .with(24, Synch::MvsSlm)
        .with(25, Synch::MvsSlm)
        .with(26, Synch::MvsSlp)
        .with(27, Synch::MvsSlp)
        .with_flush(28, Synch::Mos);
    machine
}

/// What a tick shows.
struct Now<'a> {
    tick: u64,
    /// X, Y, Z in mm.
    at: [f64; 3],
    waits: bool,
    speed: f64,
    out: &'a [(u64, u16)],
}

/// Runs programs one after another, from zero: `each` before the next tick. M functions with the tick at which they came.
/// A run in which the axes wait for ever ends behind 20 s.
fn run(
    programs: &[&str],
    variables: &[Variable],
    each: impl FnMut(&Now<'_>, &Operator<'_, 3>),
) -> (Vec<(u64, u16)>, [f64; 3], bool) {
    run_on(&machine(), programs, variables, each)
}

/// The same on another machine.
fn run_on(
    machine: &MachineData<3>,
    programs: &[&str],
    variables: &[Variable],
    mut each: impl FnMut(&Now<'_>, &Operator<'_, 3>),
) -> (Vec<(u64, u16)>, [f64; 3], bool) {
    let mut channel: Box<Channel<3, 120>> = Box::new(Channel::new());
    let mut rest = programs.iter().map(|text| text.as_bytes());
    let first = rest.next().unwrap_or_default();
    let handles = channel.split(machine, [Position::ZERO; 3], first).expect("machine data");
    let Handles { mut planner, mut interpolator, operator } = handles;
    planner.variables(variables);
    let (mut out, mut at, mut waits) = (Vec::new(), [0.0; 3], false);
    for tick in 0..20_000 {
        let mut calls = 0;
        let done = loop {
            match planner.poll().expect("the program is right") {
                Progress::Waiting => break false,
                Progress::Done => break true,
                _ => {}
            }
            calls += 1;
            assert!(calls < 1_000_000, "the planner waits for nothing");
        };
        let state = interpolator.tick();
        while let Some(output) = operator.output() {
            if let Function::M(code) = output.function {
                out.push((tick, code));
            }
        }
        let speed = operator.status().speed.0.to_num::<f64>();
        at = operator.status().set_points.map(|point| point.to_num());
        waits = planner.is_waiting();
        each(&Now { tick, at, waits, speed, out: &out }, &operator);
        if done && state == State::Idle {
            match rest.next() {
                Some(next) => assert!(planner.load(next).is_ok(), "at rest"),
                None => break,
            }
        }
    }
    (out, at, waits)
}

const SLM: &str = "N05 M24\nN10 M25 G00 X25\nN20 X50\nN30 X75\nN40 X100\nN50 G01 X125 F6000\nN60 Z100\nM30\n";
const SLP: &str = "N05 M26 G00 X25\nN10 M27\nN20 X50\nN30 X75\nN40 X100\nN50 G01 X125 F6000\nN60 #EXPL SYN\nN70 G00 X0\n\
    N80 X0 Y5\nM30\n";

fn acknowledge(operator: &Operator<'_, 3>, codes: &[u16]) {
    for code in codes {
        operator.acknowledge(Function::M(*code)).expect("it waits");
    }
}

/// MVS_SLM: put out with its block, acknowledged before the next block at feed: through three blocks of rapid motion.
#[test]
fn slm_waits_before_the_next_motion_at_feed() {
    let mut stood = 0;
    let (out, end, _) = run(&[SLM], &[], |now, operator| {
        if now.waits {
            assert_eq!(now.at, [100.0, 0.0, 0.0], "tick {}", now.tick);
            stood += 1;
            // One of them is not enough.
            match stood {
                50 => acknowledge(operator, &[25]),
                100 => acknowledge(operator, &[24]),
                _ => {}
            }
        }
    });
    assert_eq!((stood, end), (100, [125.0, 0.0, 100.0]));
    assert_eq!(out.iter().map(|(_, code)| *code).collect::<Vec<_>>(), [24, 25]);
    assert!(out.iter().all(|(tick, _)| *tick < 5), "{out:?}");
}

/// Acknowledged in time, the motion passes at speed; never acknowledged, it stands there for ever.
#[test]
fn slm_that_is_acknowledged_in_time_stops_nothing() {
    let mut slowest = f64::MAX;
    let mut open = true;
    let (_, end, _) = run(&[SLM], &[], |now, operator| {
        if open && now.at[0] > 30.0 {
            acknowledge(operator, &[24, 25]);
            open = false;
        }
        if (90.0..110.0).contains(&now.at[0]) {
            slowest = slowest.min(now.speed);
        }
        assert!(!now.waits);
    });
    assert!(slowest > 0.05 && end == [125.0, 0.0, 100.0], "{slowest}");
    let (_, end, waits) = run(&[SLM], &[], |_, _| {});
    assert_eq!((end, waits), ([100.0, 0.0, 0.0], true));
}

/// In a block at feed MVS_SLM is as MVS_SVS.
#[test]
fn slm_in_a_block_at_feed_waits_before_it() {
    let text = "N10 G00 X5\nN20 G01 X9 F6000 M24\nM30\n";
    let (out, end, waits) = run(&[text], &[], |_, _| {});
    assert_eq!((out.len(), end, waits), (1, [5.0, 0.0, 0.0], true));
}

/// MVS_SLP: #EXPL SYN demands the acknowledgement, before the next motion.
#[test]
fn slp_waits_at_expl_syn() {
    let mut stood = 0;
    let (out, end, _) = run(&[SLP], &[], |now, operator| {
        if now.waits {
            assert_eq!(now.at, [125.0, 0.0, 0.0], "tick {}", now.tick);
            stood += 1;
            if stood == 30 {
                acknowledge(operator, &[26, 27]);
            }
        }
    });
    assert_eq!((stood, end), (30, [0.0, 5.0, 0.0]));
    // M27 stands behind the motion of N05.
    assert!(out[0].1 == 26 && out[0].0 < 5 && out[1].1 == 27 && out[1].0 > 50, "{out:?}");
    // Without #EXPL SYN nothing waits, and without a function #EXPL SYN does nothing.
    for text in [SLP.replace("N60 #EXPL SYN\n", ""), SLP.replace("M26 ", "").replace("N10 M27\n", "")] {
        let (_, end, waits) = run(&[&text], &[], |now, _| assert!(!now.waits));
        assert_eq!((end, waits), ([0.0, 5.0, 0.0], false));
    }
}

/// What no block of a program demands is demanded by the next program.
#[test]
fn late_functions_outlive_their_program() {
    let (first, second) =
        ("N05 M24 G00 X5\nN10 M26\nM30\n", "N10 G01 X9 F6000\nN20 #EXPL SYN\nN30 X12\nM30\n");
    let mut places = Vec::new();
    let (_, end, _) = run(&[first, second], &[], |now, operator| {
        if now.waits && places.last() != Some(&now.at[0]) {
            places.push(now.at[0]);
            acknowledge(operator, &[if now.at[0] < 6.0 { 24 } else { 26 }]);
        }
    });
    assert_eq!((places, end), (vec![5.0, 9.0], [12.0, 0.0, 0.0]));
}

/// Rounded corners of the way there stay rounded and fast.
#[test]
fn corners_before_the_demand_stay_rounded() {
    let square = "#CONTOUR MODE [DEV PATH_DEV=0.2]\nG261\nG01 X20 F3000\nY20\nX40\nG260\n";
    let digest = |text: &str| {
        let mut points = Vec::new();
        let (_, end, _) = run(&[text], &[], |now, _| points.push(now.at));
        assert_eq!(end, [40.0, 20.0, 0.0]);
        points
    };
    assert_eq!(digest(&format!("M26\n{square}M30\n")), digest(&format!("M3\n{square}M30\n")));
}

/// FAW_SYNCH: the lines behind the function are read when the motion has come there.
#[test]
fn faw_reads_on_when_the_motion_is_there() {
    for (function, end) in [(" M28", 30.0), ("", 20.0)] {
        let variables = [Variable::new("AIM", Access::Read)];
        variables[0].set(20.0);
        let text = format!("N10 G01 X10 F6000{function}\nN20 X[V.E.AIM]\nM30\n");
        let (out, at, _) = run(&[&text], &variables, |now, _| {
            if now.at[0] > 9.0 {
                variables[0].set(30.0);
            }
            assert!(now.out.len() < 2);
        });
        assert_eq!((out.len(), at), (usize::from(!function.is_empty()), [end, 0.0, 0.0]));
    }
}

//! FCT_DYN_POS_LIMIT: limits of axis positions that a PLC moves during the motion.
use glidepath::channel::{Channel, Handles, Inquiry, Progress};
use glidepath::contour_log::{LimitState, PositionLimits, Side, Unknown};
use glidepath::machine::{InterpolatorData, InterpolatorFunctions, MachineData};
use glidepath::quantity::Position;
use glidepath::tick::State;
use host_tests::cases::machines;
use host_tests::cases::random::Random;
use host_tests::seeds::seeds;

/// Ticks of a run, at most.
const LONGEST: usize = 60_000;

fn machine(slope: u8) -> MachineData<3> {
    let mut machine = machines::with_slope(machines::even(1000), slope);
    machine.channel.interpolator = InterpolatorData::ALL;
    machine
}

/// What a tick shows.
struct Now {
    tick: usize,
    at: [f64; 3],
    /// Path speed, mm/tick.
    speed: f64,
    state: LimitState,
}

/// Runs a program; `each` before every tick. The ticks, or `None` if it does not end.
fn run(
    machine: &MachineData<3>,
    text: &str,
    mut each: impl FnMut(&Now, &PositionLimits<3>),
) -> Option<usize> {
    let limits = PositionLimits::new();
    let mut inquiry = Box::new(Inquiry::new());
    let mut channel: Box<Channel<3, 120>> = Box::new(Channel::new());
    let handles = channel.split(machine, [Position::ZERO; 3], text.as_bytes()).expect("machine data");
    let Handles { mut planner, mut interpolator, operator } = handles;
    planner.limit_positions(&limits, &mut inquiry).expect("enabled");
    let (mut last, mut before) = ([0.0; 3], [0.0; 3]);
    for tick in 0..LONGEST {
        let status = operator.status();
        let at = status.set_points.map(|point| point.to_num::<f64>());
        let speed = status.speed.0.to_num::<f64>();
        each(&Now { tick, at, speed, state: limits.state() }, &limits);
        let done = loop {
            match planner.poll().expect(text) {
                Progress::Waiting => break false,
                Progress::Done => break true,
                _ => {}
            }
        };
        let state = interpolator.tick();
        let at = interpolator.set_points().map(|point| point.to_num::<f64>());
        for k in 0..3 {
            // 2000 mm/s² per axis in curves and on lines, 200 mm/s; rounding of three set points.
            let accel = (at[k] - 2.0 * last[k] + before[k]).abs();
            assert!(accel <= 2000e-6 * 1.002 + 2e-9, "{text}: tick {tick}, {} mm/s²", accel * 1e6);
            assert!((at[k] - last[k]).abs() <= 0.2 * 1.0001, "{text}: tick {tick}");
        }
        (before, last) = (last, at);
        if done && state == State::Idle {
            return Some(tick);
        }
    }
    None
}

fn mm(x: f64) -> Option<Position> {
    Some(Position::from_num(x))
}

/// C40-068: with every slope the axes stand at the limit to a cycle, and the motion goes on when the PLC lifts the limit.
#[test]
fn the_axes_stand_at_the_limit_to_a_cycle() {
    for slope in [0, 1, 2, 3] {
        for (side, end) in [(Side::High, 100.0), (Side::Low, -100.0)] {
            let text = format!("G01 F6000\nN10 X{end}\n");
            let place = 0.6 * end;
            let (mut fastest, mut stood, mut told) = (0.0f64, None, Vec::new());
            let ended = run(&machine(slope), &text, |now, limits| {
                if now.tick == 0 {
                    limits.set(0, side, mm(place));
                }
                fastest = fastest.max(now.speed);
                if told.last().is_none_or(|(_, _, state)| *state != now.state) {
                    told.push((now.tick, now.at[0], now.state));
                }
                if stood.is_none() && now.state == LimitState::Standing(0, side) {
                    stood = Some((now.tick, now.at[0]));
                }
                if let Some((tick, at)) = stood
                    && now.tick == tick + 100
                {
                    assert_eq!(now.at[0].to_bits(), at.to_bits(), "slope {slope}: it stands");
                    limits.set(0, side, None);
                }
            });
            let (tick, at) = stood.unwrap_or_else(|| panic!("slope {slope} {side:?}: {ended:?} {told:?}"));
            let left = (place - at) * end.signum();
            println!(
                "slope {slope} {side:?}: {left} mm before the limit, a cycle is {fastest} mm, tick {tick}"
            );
            assert!((0.0..=1.01 * fastest).contains(&left), "slope {slope} {side:?}: {left} mm, {fastest}");
            assert!(ended.is_some_and(|ended| ended > tick + 100), "slope {slope}: {ended:?}");
        }
    }
}

/// C40-068: a limit that comes too late is told. The axes brake as a feed hold does, without a jump.
#[test]
fn a_limit_that_comes_too_late_is_told() {
    let mut told = Vec::new();
    let ended = run(&machine(1), "G01 F6000\nN10 X100\n", |now, limits| {
        if now.tick == 600 {
            limits.set(0, Side::High, mm(now.at[0] + 0.5));
        }
        if told.last() != Some(&now.state) {
            told.push(now.state);
        }
        if now.tick == 1500 {
            assert!(now.speed == 0.0, "it stands");
            limits.set(0, Side::High, None);
        }
    });
    assert!(ended.is_some());
    assert!(told.contains(&LimitState::Exceeded(0, Side::High)), "{told:?}");
    assert_eq!(told.last(), Some(&LimitState::Free));
}

/// C40-068: random programs with smoothing, arcs and limits at random moments: no set point is beyond a limit, unless the
/// state tells it.
#[test]
fn limits_hold_in_random_programs() {
    let (mut stood, mut exceeded, mut worst) = (0, 0, 0.0f64);
    for seed in seeds(0..40, 10) {
        let mut random = Random::new(seed);
        let mut text = String::from("G01 F9000\n#CONTOUR MODE [DEV PATH_DEV=0.2]\nG261\n");
        for n in 1..12 {
            let [x, y] = [(); 2].map(|()| random.between(-20.0, 40.0));
            text.push_str(&format!("N{n} X{x:.3} Y{y:.3}\n"));
        }
        text.push_str("G260\n");
        let (when, slope) = (random.between(0.0, 400.0) as usize, random.between(0.0, 4.0) as u8);
        let place = random.between(5.0, 30.0);
        let mut waits = 0;
        let (mut told, mut is_set) = (false, false);
        let ended = run(&machine(slope), &text, |now, limits| {
            if now.tick == when && now.at[1] < place {
                limits.set(1, Side::High, mm(place));
                is_set = true;
            }
            match now.state {
                LimitState::Exceeded(..) => told = true,
                LimitState::Standing(..) => waits += 1,
                _ => {}
            }
            if is_set && !told {
                worst = worst.max(now.at[1] - place);
            }
            if waits == 50 || (told && now.speed == 0.0) {
                limits.set(1, Side::High, None);
                is_set = false;
            }
        });
        stood += usize::from(waits > 0);
        exceeded += usize::from(told);
        assert!(ended.is_some(), "{text}");
    }
    println!("{stood} stood before the limit, {exceeded} came too late, {worst} mm beyond without a word");
    assert!(stood > 5 && worst <= 0.0, "{stood} {exceeded} {worst}");
}

/// C40-068: the machine data enable the function.
#[test]
fn limits_need_the_function() {
    let mut machine = machine(1);
    machine.channel.interpolator.functions = InterpolatorFunctions::IPO_DEFAULT;
    let (limits, mut inquiry) = (PositionLimits::new(), Inquiry::new());
    let mut channel: Box<Channel<3, 120>> = Box::new(Channel::new());
    let handles =
        channel.split(&machine, [Position::ZERO; 3], b"G01 X1 F600\n".as_slice()).expect("machine data");
    let Handles { mut planner, .. } = handles;
    assert_eq!(planner.limit_positions(&limits, &mut inquiry), Err(Unknown::NotEnabled("FCT_DYN_POS_LIMIT")));
}

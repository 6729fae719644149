//! A change of the motion that is planned and withdrawn, because the interrupt was faster or no stop was
//! found in time, leaves no traces: later plans fit the current motion.
use glidepath::channel::{Channel, Handles, Progress};
use glidepath::quantity::Position;
use glidepath::tick::State;
use host_tests::cases::machines;
use host_tests::cases::random::Random;

/// Short lines along a circle, rounded by DEV.
fn chords() -> String {
    let point = |k: u32| {
        let (sin, cos) = (f64::from(k) * 0.01).sin_cos();
        format!("N{k} X{:.4} Y{:.4}\n", 20.0 * sin, 20.0 - 20.0 * cos)
    };
    let points: String = (0..3000).map(point).collect();
    format!("G01 F20000\n#CONTOUR MODE ON [DEV PATH_DEV=0.02]\n{points}M30\n")
}

/// Runs it with STEP while an operator holds, goes on and turns the override at random, and says what went wrong.
fn run(text: &str, seed: u64) -> Result<(), String> {
    let mut random = Random::new(seed);
    let machine = machines::with_slope(machines::examples::<3>(1000), 0);
    let mut channel = Box::new(Channel::<3, 120>::new());
    let handles = channel.split(&machine, [Position::ZERO; 3], text.as_bytes()).expect("good data");
    let Handles { mut planner, mut interpolator, operator } = handles;
    let mut done = false;
    for _ in 0..200_000 {
        if interpolator.tick() == State::Idle && done {
            return Ok(());
        }
        if random.once_in(700) {
            operator.feed_hold();
        }
        if random.once_in(100) {
            operator.resume();
        }
        if random.once_in(500) {
            operator.set_override((random.bits() % 1500 + 10) as u16);
        }
        let polls = if random.once_in(500) { 0 } else { 12 };
        for _ in 0..polls {
            match planner.poll() {
                Ok(Progress::Done) => done = true,
                Ok(_) => {}
                Err(error) => return Err(format!("seed {seed}: {error:?}")),
            }
        }
    }
    Err(format!("seed {seed}: does not end"))
}

#[test]
fn commands_along_short_lines_leave_them_plannable() {
    let text = chords();
    let faults: Vec<String> =
        host_tests::seeds::seeds(0..60, 10).filter_map(|seed| run(&text, seed).err()).collect();
    assert!(faults.is_empty(), "{faults:#?}");
}

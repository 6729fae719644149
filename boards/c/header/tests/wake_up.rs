//! A planner that sleeps as long as its result says makes the same motion as a planner that is called after
//! each tick.
use glidepath::channel::{Channel, Handles, Progress};
use glidepath::digest::Digest;
use glidepath::machine::MachineData;
use glidepath::quantity::Position;
use glidepath::tick::State;
use hil_cases::{AXES_3, AXES_6, BLOCKS, CASES_3, CASES_6, Case};

/// Ticks, digest and calls of the planner's task.
fn run<const AXES: usize>(machine: &MachineData<AXES>, case: &Case, sleeps: bool) -> (u32, u64, u32) {
    let mut channel = Box::new(Channel::<AXES, BLOCKS>::new());
    let handles = channel.split(machine, [Position::ZERO; AXES], case.text).expect("machine data");
    let Handles { mut planner, mut interpolator, operator } = handles;
    let (mut ticks, mut digest, mut calls, mut sleep, mut is_done) = (0, Digest::new(), 0, 0, false);
    loop {
        // An acknowledgement wakes the planner.
        let mut wake = sleep == 0;
        while let Some(output) = operator.output() {
            wake |= output.waits && operator.acknowledge(output.function).is_ok();
        }
        sleep -= u32::from(sleep > 0);
        if wake {
            calls += 1;
            loop {
                match planner.poll() {
                    Ok(Progress::Waiting) => break,
                    Ok(Progress::Done) => {
                        is_done = true;
                        break;
                    }
                    Ok(Progress::Late) => panic!("{}: late", case.name),
                    Ok(_) => {}
                    Err(error) => panic!("{}: {error}", case.name),
                }
            }
            sleep = if sleeps { planner.wakes_after().unwrap_or(1000) - 1 } else { 0 };
        }
        if interpolator.tick() == State::Active {
            ticks += 1;
            digest.add(interpolator.set_points());
        } else if is_done {
            return (ticks, digest.value(), calls);
        }
    }
}

fn compare<const AXES: usize>(machine: &MachineData<AXES>, cases: &[Case]) {
    for case in cases {
        let (ticks, digest, calls) = run(machine, case, false);
        let (slept_ticks, slept_digest, slept_calls) = run(machine, case, true);
        println!("{:<16} {ticks:>7} ticks {calls:>7} calls {slept_calls:>6} with sleep", case.name);
        assert_eq!((slept_ticks, slept_digest), (ticks, digest), "{}", case.name);
        assert!(slept_calls <= calls, "{}", case.name);
    }
}

#[test]
fn a_planner_that_sleeps_makes_the_same_motion() {
    compare(&AXES_3, CASES_3);
    compare(&AXES_6, CASES_6);
}

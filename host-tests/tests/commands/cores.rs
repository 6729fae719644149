//! Planner, interrupt and operator on separate threads, ordered only by the words of the channel: limits,
//! path, exact end and functions are right in every order of events.
use host_tests::cores::{random_case, text_case};
use host_tests::seeds::seeds;

#[test]
fn random_programs_keep_their_limits_on_three_cores() {
    assert!(judged(seeds(0..10, 4)) > 10);
}

/// The long form: the threads wait for one another, so each program takes seconds on a processor of two cores.
#[test]
#[ignore = "500 programs"]
fn many_random_programs_keep_their_limits_on_three_cores() {
    assert!(judged(0..500) > 400);
}

/// Number of programs without a fault; some of them with a planner that was late.
fn judged(seeds: impl Iterator<Item = u64>) -> usize {
    let (mut late, mut judged) = (0, 0);
    for seed in seeds {
        if let Some(times) = random_case(seed).unwrap_or_else(|fault| panic!("{fault}")) {
            (late, judged) = (late + times, judged + 1);
        }
    }
    println!("{judged} programs, the planner was late {late} times");
    assert!(late > 0, "the planner was never late");
    judged
}

#[test]
fn curves_and_functions_come_whole_on_three_cores() {
    let late: usize = (0..12).map(|seed| text_case(seed).unwrap_or_else(|fault| panic!("{fault}"))).sum();
    println!("the planner was late {late} times");
    assert!(late > 0, "{late}");
}

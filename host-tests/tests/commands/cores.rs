//! Planner, interrupt and operator on separate threads, ordered only by the words of the channel: limits,
//! path, exact end and functions are right in every order of events.
use host_tests::cores::{random_case, text_case};
use host_tests::seeds::seeds;

#[test]
fn random_programs_keep_their_limits_on_three_cores() {
    let (mut late, mut judged) = (0, 0);
    for seed in seeds(0..30, 10) {
        if let Some(times) = random_case(seed).unwrap_or_else(|fault| panic!("{fault}")) {
            (late, judged) = (late + times, judged + 1);
        }
    }
    println!("{judged} programs, the planner was late {late} times");
    assert!(judged > 30 && late > 0, "{judged}, {late}");
}

#[test]
fn curves_and_functions_come_whole_on_three_cores() {
    let late: usize = (0..32).map(|seed| text_case(seed).unwrap_or_else(|fault| panic!("{fault}"))).sum();
    println!("the planner was late {late} times");
    assert!(late > 0, "{late}");
}

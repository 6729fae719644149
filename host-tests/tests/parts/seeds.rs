//! Fixed seeds first, then new seeds, which are equal in all tests of a run and differ from the fixed ones.
use host_tests::seeds::{VARIABLE, own, seeds};

#[test]
fn fixed_seeds_come_first_and_then_a_runs_own() {
    let first = own();
    assert!(first >= 1_000_000 || std::env::var_os(VARIABLE).is_some());
    for _ in 0..2 {
        let all: Vec<u64> = seeds((0..3).chain([17]), 2).collect();
        assert_eq!(all, [0, 1, 2, 17, first, first + 1]);
    }
}

/// Another process has other ones, unless it is told which.
#[test]
fn the_number_is_another_each_time_and_can_be_given() {
    let number = |given: Option<&str>| -> u64 {
        let mut command = std::process::Command::new(std::env::current_exe().expect("this test"));
        command.args(["--exact", "seeds::fixed_seeds_come_first_and_then_a_runs_own", "--nocapture"]);
        command.env_remove(VARIABLE);
        if let Some(given) = given {
            command.env(VARIABLE, given);
        }
        let said = String::from_utf8(command.output().expect("it runs").stdout).expect("text");
        let (_, rest) = said.split_once(&format!("{VARIABLE}=")).expect("the number is printed");
        rest.split_whitespace().next().and_then(|number| number.parse().ok()).expect("a number")
    };
    assert_eq!(number(Some("4711")), 4711);
    assert_ne!(number(None), number(None));
}

//! The decoder with changed lines of all dialects:
//! `cargo run --release -p host-tests --example mutate -- COUNT FIRST`.
//! COUNT is the number of lines of each dialect, default 25,000,000: 10^8 in all.
use glidepath::machine::Dialect;
use host_tests::mutate::search;

fn main() {
    let mut numbers = std::env::args().skip(1).map(|number| number.parse::<u64>().expect("a number"));
    let (count, first) = (numbers.next().unwrap_or(25_000_000), numbers.next().unwrap_or(0));
    let mut silent = 0;
    for dialect in Dialect::ALL {
        let found = search(*dialect, first, count);
        println!("{}: {count} lines, {} accepted, {} values", dialect.name(), found.accepted, found.values);
        found.silent.iter().take(20).for_each(|line| println!("does nothing: {line}"));
        silent += found.silent.len();
    }
    assert_eq!(silent, 0, "values that do nothing");
}

//! Real-time loops of many passes: `rt_loops PASSES`.
use host_tests::cases::machines;
use host_tests::loops::{CIRCLE, drive};

fn main() {
    let passes = std::env::args().nth(1).map_or(1000, |text| text.parse().expect("a number of passes"));
    for slope in 0..4 {
        let machine = machines::with_slope(machines::even(1000), slope);
        let (driven, slowest, end) = drive(CIRCLE, &machine, passes, 30);
        println!("slope {slope}: {driven} passes, slowest {slowest:.6} mm/s, end {end:?}");
    }
}

//! Real-time loops: passes without a stop, the exit, what is refused, and what the log has of them.
use host_tests::cases::machines;
use host_tests::loops::{CIRCLE, drive};

/// G-09: a tangential seam is passed at speed with every slope, and the loop is left so.
#[test]
fn no_stop_at_a_tangential_seam() {
    for slope in 0..4 {
        let machine = machines::with_slope(machines::even(1000), slope);
        let (passes, slowest, end) = drive(CIRCLE, &machine, 20, 30);
        println!("slope {slope}: {passes} passes, slowest {slowest}");
        assert_eq!((passes, end), (20, [60.0, 0.0, 0.0]), "slope {slope}");
        assert!(slowest > 99.9, "slope {slope}: {slowest} mm/s");
    }
}

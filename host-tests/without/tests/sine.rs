//! The sine of the tick has a table of a quarter of a revolution where the library is built without `fast`: its points
//! are those of a whole revolution.
use glidepath::math::angle::sin_cos_fine;
use glidepath::math::trig::sin_cos;

/// Points of the table per revolution.
const POINTS: u64 = 1024;

/// A quarter of a revolution.
const QUARTER: u64 = 1 << 62;

#[test]
fn a_quarter_mirrored_has_the_bits_of_a_revolution() {
    for point in 0..POINTS {
        let turns = point << 54;
        let of_table = (sin_cos_fine(turns).0, sin_cos_fine(turns.wrapping_add(QUARTER)).0);
        assert_eq!(sin_cos(turns), of_table, "point {point}");
    }
}

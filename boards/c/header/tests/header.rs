//! Checks that the header in the repository equals the header that the sources give.
use glidepath_c_header::{file, header};

#[test]
fn the_header_is_that_of_the_sources() {
    let there = std::fs::read_to_string(file()).expect("boards/c/include/glidepath.h");
    let made = header().expect("a header");
    assert!(there == made, "boards/c/include/glidepath.h is not up to date: run `cargo xtask header`");
}

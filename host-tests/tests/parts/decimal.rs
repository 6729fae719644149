//! Positions in messages: the text equals that of the library of fixed-point numbers, which rounds to
//! nearest, ties to even.
use glidepath::quantity::{Decimal, Position};

/// splitmix64 (Steele, Lea, Flood 2014).
fn next(state: &mut u64) -> u64 {
    *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let z = (*state ^ (*state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

fn same(bits: i64) {
    for decimals in [6, 10] {
        let ours = Decimal { bits, decimals }.to_string();
        let theirs = format!("{:.decimals$}", Position::from_bits(bits));
        assert_eq!(ours, theirs, "{bits:#x} with {decimals} decimals");
    }
}

#[test]
fn positions_are_written_as_the_library_of_numbers_writes_them() {
    for bits in [0, 1, -1, 1 << 25, -(1 << 25), 3 << 25, (1 << 32) - 1, 1 - (1 << 32), i64::MAX, i64::MIN] {
        same(bits);
    }
    let mut state = 1;
    for _ in 0..200_000 {
        let word = next(&mut state);
        let size = next(&mut state) % 64;
        same(word as i64 >> size);
        // Ties: a half behind the last decimal.
        same(((word >> size) as i64) << 25);
    }
}

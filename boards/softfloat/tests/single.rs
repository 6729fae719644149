//! The functions against the computer's own, bit for bit: all pairs of edges, and random numbers.
//!
//! The long form tries 10^8 pairs: `cargo test --release -p glidepath-softfloat -- --ignored`.
use glidepath_softfloat as soft;
use soft::trial::Random;

/// Numbers at the borders: zeros, subnormal and normal numbers, infinities, NaNs, and each exponent with a few
/// mantissas.
fn edges() -> Vec<u32> {
    let mut found =
        vec![0, 1, 2, 3, 0x7f_fffe, 0x7f_ffff, 0x7f80_0000, 0x7f80_0001, 0x7fc0_0000, 0x7fff_ffff];
    for exponent in
        (1..255).step_by(3).chain([127, 128, 126, 150, 151, 157, 158, 159, 189, 190, 191, 254, 253])
    {
        for mantissa in [0, 1, 2, 0x40_0000, 0x3f_ffff, 0x7f_ffff, 0x7f_fffe, 0x55_5555] {
            found.push(exponent << 23 | mantissa);
        }
    }
    let negative: Vec<u32> = found.iter().map(|x| x | 1 << 31).collect();
    found.extend(negative);
    found
}

/// Whether the results are the same number, or both NaN.
fn same(mine: u32, theirs: f32) -> bool {
    if theirs.is_nan() { f32::from_bits(mine).is_nan() } else { mine == theirs.to_bits() }
}

fn try_pair(a: u32, b: u32) {
    let (x, y) = (f32::from_bits(a), f32::from_bits(b));
    let sums = [
        ("+", soft::add(a, b), x + y),
        ("-", soft::sub(a, b), x - y),
        ("*", soft::mul(a, b), x * y),
        ("/", soft::div(a, b), x / y),
    ];
    for (sign, mine, theirs) in sums {
        assert!(same(mine, theirs), "{a:#x} {sign} {b:#x} = {:#x}, not {mine:#x}", theirs.to_bits());
    }
    let comparisons = [
        ("<", soft::less(a, b), x < y),
        ("<=", soft::less_or_equal(a, b), x <= y),
        ("==", soft::equal(a, b), x == y),
        ("unordered", soft::unordered(a, b), x.is_nan() || y.is_nan()),
    ];
    for (sign, mine, theirs) in comparisons {
        assert_eq!(mine, theirs, "{a:#x} {sign} {b:#x}");
    }
}

fn try_conversions(bits: u64) {
    let single = bits as u32;
    let x = f32::from_bits(single);
    assert_eq!(soft::to_u32(single), x as u32, "{single:#x}");
    assert_eq!(soft::to_i32(single), x as i32, "{single:#x}");
    assert_eq!(soft::to_u64(single), x as u64, "{single:#x}");
    assert_eq!(soft::to_i64(single), x as i64, "{single:#x}");
    assert_eq!(soft::from_u32(single), (single as f32).to_bits(), "{single}");
    assert_eq!(soft::from_i32(single as i32), (single as i32 as f32).to_bits(), "{single}");
    for shift in [0, 20, 31, 32, 40] {
        let long = bits >> shift;
        assert_eq!(soft::from_u64(long), (long as f32).to_bits(), "{long}");
        assert_eq!(soft::from_i64(long as i64), (long as i64 as f32).to_bits(), "{long}");
        assert_eq!(soft::from_i64(-(long as i64)), (-(long as i64) as f32).to_bits(), "{long}");
    }
}

fn random(seed: u64, pairs: u64) {
    let mut numbers = Random::new(seed);
    for _ in 0..pairs {
        let (a, b) = numbers.pair();
        try_pair(a, b);
        try_conversions(numbers.bits());
    }
}

#[test]
fn edges_are_as_on_the_host() {
    let edges = edges();
    for &a in &edges {
        for &b in &edges {
            try_pair(a, b);
        }
        try_conversions(u64::from(a));
        try_conversions(u64::from(a) << 32 | 0x8000_0001);
        try_conversions(u64::from(a) << 25);
    }
}

#[test]
fn random_numbers_are_as_on_the_host() {
    random(0x9e37_79b9_7f4a_7c15, 2_000_000);
}

#[test]
#[ignore = "a minute; 10^8 pairs"]
fn many_random_numbers_are_as_on_the_host() {
    random(0xd1b5_4a32_d192_ed03, 100_000_000);
}

/// All mantissas of a divisor: the digits of a quotient rely on the reciprocal.
#[test]
#[ignore = "a minute; all divisors"]
fn all_divisors_divide_as_on_the_host() {
    for divisor in 0x3f80_0000..0x4000_0000u32 {
        for number in [0x3f80_0000, 0x3fff_ffff, divisor - 1, divisor + 1, 0x3fc0_0000 ^ (divisor >> 3)] {
            let (a, b) = (f32::from_bits(number), f32::from_bits(divisor));
            assert_eq!(soft::div(number, divisor), (a / b).to_bits(), "{a} / {b}");
        }
    }
}

#[test]
fn copies_are_right() {
    assert!(soft::trial::copies());
}

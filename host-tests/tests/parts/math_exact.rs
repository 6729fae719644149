//! Products, quotients and roots against the compiler's 128-bit arithmetic and f64.
use glidepath::math::divide::{div_shift, div_wide, reciprocal_near};
use glidepath::math::root::{cbrt_f32, sqrt_f32, sqrt_u64, sqrt_wide};
use glidepath::math::wide::{mul_hi, mul_hi_u, mul_shift, mul_u32, mul_wide, square_wide};

const CASES: usize = 1_000_000;

/// splitmix64 (Steele, Lea, Flood 2014).
struct Random(u64);

impl Random {
    fn word(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// All magnitudes alike, often next to a power of two.
    fn spread(&mut self) -> u64 {
        let word = self.word();
        let size = (word & 63) as u32;
        match (word >> 6) & 7 {
            0 => (1 << size) - 1,
            1 => 1 << size,
            2 => (1u64 << size).wrapping_neg(),
            3 => (self.word() & 3) << size,
            _ => self.word() >> size,
        }
    }
}

/// Ties up, low 64 bits.
fn nearest(product: i128, shift: u32) -> i64 {
    if shift == 0 { product as i64 } else { (((product >> (shift - 1)) + 1) >> 1) as i64 }
}

#[test]
fn products_are_exact() {
    let mut random = Random(1);
    for _ in 0..CASES {
        let (a, b) = (random.spread(), random.spread());
        let product = u128::from(a) * u128::from(b);
        assert_eq!(mul_wide(a, b), ((product >> 64) as u64, product as u64), "{a} {b}");
        assert_eq!(square_wide(a), mul_wide(a, a), "{a}");
        assert_eq!(mul_hi_u(a, b), (product >> 64) as u64, "{a} {b}");
        let (a, b) = (a as i64, b as i64);
        let product = i128::from(a) * i128::from(b);
        assert_eq!(mul_hi(a, b), (product >> 64) as i64, "{a} {b}");
        let shift = (random.word() % 128) as u32;
        assert_eq!(mul_shift(a, b, shift), nearest(product, shift), "{a} {b} {shift}");
        let (n, shift) = (random.spread() as u32, (random.word() % 33) as u32);
        assert_eq!(
            mul_u32(a, n, shift),
            ((i128::from(a) * i128::from(n)) >> shift) as i64,
            "{a} {n} {shift}"
        );
    }
}

#[test]
fn edges_of_products() {
    let edges = [i64::MIN, i64::MIN + 1, -1 << 32, -1, 0, 1, u32::MAX as i64, 1 << 32, i64::MAX];
    for a in edges {
        for b in edges {
            let product = i128::from(a) * i128::from(b);
            assert_eq!(mul_hi(a, b), (product >> 64) as i64);
            for shift in 0..128 {
                assert_eq!(mul_shift(a, b, shift), nearest(product, shift), "{a} {b} {shift}");
            }
        }
    }
}

#[test]
fn quotients_are_exact() {
    let mut random = Random(2);
    for _ in 0..CASES {
        let (hi, lo, d) = (random.spread(), random.spread(), random.spread());
        // Most quotients should fit: hi below d half of the time.
        let hi = if d != 0 && random.word() & 1 == 0 { hi % d } else { hi };
        let n = (u128::from(hi) << 64) | u128::from(lo);
        let expected = n.checked_div(d.into()).map_or(u64::MAX, |q| q.min(u64::MAX.into()) as u64);
        assert_eq!(div_wide(hi, lo, d), expected, "{hi} {lo} {d}");

        let (a, shift) = (random.spread(), (random.word() % 65) as u32);
        let n = u128::from(a) << shift;
        let expected = n.checked_div(d.into()).map_or(u64::MAX, |q| q.min(u64::MAX.into()) as u64);
        assert_eq!(div_shift(a, shift, d), expected, "{a} {shift} {d}");
    }
}

#[test]
fn reciprocals_are_near() {
    let mut random = Random(8);
    for k in 0..CASES {
        let d = match k {
            0..64 => (1 << 63) + (1 << (k % 64).min(62)),
            64..128 => u64::MAX - ((1 << (k % 64).min(62)) - 1),
            128 => 1 << 63,
            129 => u64::MAX,
            _ => random.word() | 1 << 63,
        };
        let expected = ((1 << 126) / u128::from(d)) as u64;
        let near = reciprocal_near(d);
        assert!(near < 1 << 63 && near <= expected && expected - near <= 32, "{d}: {near}, {expected}");
    }
}

/// Quotients at and next to a whole number are where a wrong digit would show.
#[test]
fn quotients_around_multiples() {
    let mut random = Random(3);
    for _ in 0..CASES {
        let (q, d) = (random.spread(), random.spread().max(1));
        let n = u128::from(q) * u128::from(d);
        let word = |n: u128| ((n >> 64) as u64, n as u64);
        let (hi, lo) = word(n);
        assert_eq!(div_wide(hi, lo, d), q);
        let (hi, lo) = word(n + u128::from(d - 1));
        assert_eq!(div_wide(hi, lo, d), q);
        if q > 0 {
            let (hi, lo) = word(n - 1);
            assert_eq!(div_wide(hi, lo, d), q - 1);
        }
    }
}

fn is_root(n: u128, root: u64) -> bool {
    let root = u128::from(root);
    let above = (root + 1).checked_mul(root + 1);
    root * root <= n && above.is_none_or(|above| n < above)
}

#[test]
fn integer_roots_are_exact() {
    let mut random = Random(5);
    for i in 0..CASES {
        let (hi, lo) = (random.spread(), random.spread());
        let hi = if i % 4 == 0 { 0 } else { hi };
        let n = (u128::from(hi) << 64) | u128::from(lo);
        assert!(is_root(n, sqrt_wide(hi, lo)), "{hi} {lo}");
        assert!(is_root(lo.into(), sqrt_u64(lo).into()), "{lo}");
        // Squares and their lower neighbours.
        let square = u128::from(lo) * u128::from(lo);
        assert_eq!(sqrt_wide((square >> 64) as u64, square as u64), lo);
        let small = lo as u32;
        assert_eq!(sqrt_u64(u64::from(small) * u64::from(small)), small);
        if lo > 0 {
            let below = square - 1;
            assert_eq!(sqrt_wide((below >> 64) as u64, below as u64), lo - 1);
        }
        if small > 0 {
            assert_eq!(sqrt_u64(u64::from(small) * u64::from(small) - 1), small - 1);
        }
    }
    for n in 0..100_000u64 {
        assert!(is_root(n.into(), sqrt_u64(n).into()), "{n}");
        assert!(is_root(n.into(), sqrt_wide(0, n)), "{n}");
        // Both ends of the scaled range, where seed and clamps are worst.
        for hi in [u64::MAX - n, (1 << 62) + n, (1 << 63) + n] {
            assert!(is_root((u128::from(hi) << 64) | u128::from(u64::MAX), sqrt_wide(hi, u64::MAX)), "{hi}");
            assert!(is_root(hi.into(), sqrt_u64(hi).into()), "{hi}");
        }
    }
}

/// Largest relative error of `f` against `reference` over all mantissas of `binades` from 2^`from` on.
fn worst(f: fn(f32) -> f32, reference: fn(f64) -> f64, from: i32, binades: i32) -> f64 {
    let first = ((127 + from) as u32) << 23;
    let mut worst = 0.0f64;
    for bits in first..first + ((binades as u32) << 23) {
        let x = f32::from_bits(bits);
        let exact = reference(x.into());
        worst = worst.max((f64::from(f(x)) / exact - 1.0).abs());
    }
    worst
}

#[test]
fn float_square_root() {
    // Two binades are all there is: a factor 4 only moves the exponent.
    let error = worst(sqrt_f32, f64::sqrt, 0, 2);
    // Measured 8.94e-8, three quarters of the last bit of a number just above a power of two.
    assert!(error <= 9.0e-8, "{error:e}");
    let mut random = Random(6);
    for _ in 0..CASES {
        let x = f32::from_bits((random.word() as u32) & 0x7fff_ffff);
        if x.is_finite() && x > 0.0 {
            let ratio = f64::from(sqrt_f32(x)) / f64::from(x).sqrt();
            assert!((ratio - 1.0).abs() <= 9.0e-8, "{x:e}");
        }
    }
    assert_eq!(sqrt_f32(0.0), 0.0);
    assert_eq!(sqrt_f32(f32::INFINITY), f32::INFINITY);
    assert!(sqrt_f32(-1.0).is_nan());
    for n in 0..4096u32 {
        assert_eq!(sqrt_f32((n * n) as f32), n as f32);
    }
}

#[test]
fn float_cube_root() {
    let error = worst(cbrt_f32, f64::cbrt, 0, 3);
    // Measured 9.67e-8.
    assert!(error <= 9.8e-8, "{error:e}");
    let mut random = Random(7);
    for _ in 0..CASES {
        let x = f32::from_bits(random.word() as u32);
        if x.is_finite() && x != 0.0 {
            let ratio = f64::from(cbrt_f32(x)) / f64::from(x).cbrt();
            assert!((ratio - 1.0).abs() <= 1.2e-7, "{x:e}");
            assert_eq!(cbrt_f32(-x), -cbrt_f32(x));
        }
    }
    assert_eq!(cbrt_f32(0.0), 0.0);
    assert_eq!(cbrt_f32(f32::INFINITY), f32::INFINITY);
}

/// Cores without floating point convert by integers: the same bits at the borders of all exponents and between.
#[test]
fn conversions_by_integers_have_the_same_bits() {
    use glidepath::math::{float, soft};
    for exponent in 0..256u32 {
        for mantissa in [0, 1, 0x2a_aaaa, 0x40_0000, 0x7f_ffff] {
            for sign in [0, 1 << 31] {
                let x = f32::from_bits(sign | exponent << 23 | mantissa);
                assert_eq!(soft::integer(x, 58), float::to_bits::<58>(x), "{x:e}");
                assert_eq!(soft::integer(x, 40), float::to_bits::<40>(x), "{x:e}");
                assert_eq!(soft::integer(x.abs(), 0), float::to_i64(x.abs()), "{x:e}");
                if sign == 0 && (2..254).contains(&exponent) {
                    assert_eq!(soft::half(x), 0.5 * x);
                }
            }
        }
    }
    let mut x = 1u64;
    for _ in 0..100_000 {
        x = x.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        for x in [x, x >> 20, x >> 31, x >> 33, x & 0xffff_ffff_0000_0000] {
            assert_eq!(soft::size_f32(x).to_bits(), float::size_f32(x).to_bits(), "{x}");
        }
    }
}

//! Sine, cosine and arc tangent, compared with CORDIC in 120 fraction bits, which shares no code with the
//! library: only shifts and additions, with angles from Machin's formula and power series.
use glidepath::math::angle::{atan2_turns, sin_cos_fine};
use glidepath::math::trig::sin_cos;

const CASES: usize = 1_000_000;

/// Fraction bits of the reference.
const BITS: usize = 120;

/// splitmix64 (Steele, Lea, Flood 2014).
struct Random(u64);

impl Random {
    fn word(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }
}

/// a / b < 1 by long division.
fn ratio(mut a: i128, b: i128) -> i128 {
    let mut quotient = 0;
    for _ in 0..BITS {
        a <<= 1;
        quotient <<= 1;
        if a >= b {
            a -= b;
            quotient += 1;
        }
    }
    quotient
}

/// atan(1/n) in radians for n > 1.
fn arctan_inverse(n: i128) -> i128 {
    let (mut power, mut sum, mut k) = ((1 << BITS) / n, 0, 1);
    while power != 0 {
        sum += if k % 4 == 1 { power / k } else { -power / k };
        power /= n * n;
        k += 2;
    }
    sum
}

struct Cordic {
    /// atan(2^-i) in revolutions.
    angles: Vec<i128>,
    /// Length of a unit vector after all rotations.
    gain: i128,
}

impl Cordic {
    fn new() -> Self {
        let pi = 16 * arctan_inverse(5) - 4 * arctan_inverse(239);
        let inverse_power = |i: usize| {
            if i < 60 {
                return arctan_inverse(1 << i);
            }
            1 << (BITS - i)
        };
        let mut angles = vec![1 << (BITS - 3)];
        angles.extend((1..BITS - 6).map(|i| ratio(inverse_power(i), 2 * pi)));
        let mut cordic = Cordic { angles, gain: 0 };
        cordic.gain = cordic.rotate(0, 1 << BITS).1;
        cordic
    }

    /// (sin, cos)·length·gain of an angle within a third of a revolution.
    fn rotate(&self, mut angle: i128, length: i128) -> (i128, i128) {
        let (mut x, mut y) = (length, 0);
        for (i, step) in self.angles.iter().enumerate() {
            if angle >= 0 {
                (x, y) = (x - (y >> i), y + (x >> i));
                angle -= step;
            } else {
                (x, y) = (x + (y >> i), y - (x >> i));
                angle += step;
            }
        }
        (y, x)
    }

    /// Sine and cosine of turns·2^-64 revolutions.
    fn sin_cos(&self, turns: u64, unit: i128) -> (i128, i128) {
        let quarter = turns.wrapping_add(1 << 61) >> 62;
        let rest = turns.wrapping_sub(quarter << 62) as i64;
        let (sin, cos) = self.rotate(i128::from(rest) << (BITS - 64), unit);
        [(sin, cos), (cos, -sin), (-sin, -cos), (-cos, sin)][(quarter & 3) as usize]
    }

    /// 1 / gain, so that `sin_cos` comes out with radius 1.
    fn unit(&self) -> i128 {
        ratio(1 << BITS, self.gain)
    }

    /// Direction of (x, y) in revolutions, x > 0.
    fn direction(&self, x: i64, y: i64) -> i128 {
        let shift = x.leading_zeros().min(y.unsigned_abs().leading_zeros()) + 54;
        let (mut x, mut y, mut angle) = (i128::from(x) << shift, i128::from(y) << shift, 0);
        for (i, step) in self.angles.iter().enumerate() {
            if y > 0 {
                (x, y) = (x + (y >> i), y - (x >> i));
                angle += step;
            } else {
                (x, y) = (x - (y >> i), y + (x >> i));
                angle -= step;
            }
        }
        angle
    }
}

/// |value·2^-62 − reference|.
fn error(value: i64, reference: i128) -> f64 {
    ((i128::from(value) << (BITS - 62)) - reference).unsigned_abs() as f64 / (1u128 << BITS) as f64
}

/// Table points and their midpoints with their neighbours, and ties of the rounded rest (2^21), then
/// seeded random angles.
fn angles() -> impl Iterator<Item = u64> {
    let edges = (0..2048u64).flat_map(|i| {
        [0, 1, 2, 1 << 21, 1 << 31, 1 << 40, 1 << 52, (1 << 52) + (1 << 21)]
            .into_iter()
            .flat_map(move |d: u64| [(i << 53).wrapping_add(d), (i << 53).wrapping_sub(d)])
    });
    let mut random = Random(11);
    edges.chain((0..CASES).map(move |_| random.word()))
}

#[test]
fn sine_and_cosine_within_their_bounds() {
    let cordic = Cordic::new();
    let unit = cordic.unit();
    let (mut tick, mut fine) = (0.0f64, 0.0f64);
    for turns in angles() {
        let (s, c) = cordic.sin_cos(turns, unit);
        let (sin, cos) = sin_cos(turns);
        tick = tick.max(error(sin, s)).max(error(cos, c));
        let (sin, cos) = sin_cos_fine(turns);
        fine = fine.max(error(sin, s)).max(error(cos, c));
    }
    // Measured 2^-46.93 and 2^-62.03, over more angles 2^-46.9 and 2^-61.98.
    assert!(tick.log2() < -46.8);
    assert!(fine.log2() < -61.9);
}

#[test]
fn quarter_turns_are_exact() {
    const ONE: i64 = 1 << 62;
    for (quarter, expected) in [(0, ONE), (ONE, 0), (0, -ONE), (-ONE, 0)].into_iter().enumerate() {
        assert_eq!(sin_cos((quarter as u64) << 62), expected);
        assert_eq!(sin_cos_fine((quarter as u64) << 62), expected);
    }
}

#[test]
fn sine_is_odd_and_cosine_even() {
    let mut worst = 0;
    let mut worst_at_midpoint = 0;
    for turns in angles() {
        let ((sin, cos), (sin_back, cos_back)) = (sin_cos(turns), sin_cos(turns.wrapping_neg()));
        let difference = (sin + sin_back).abs().max((cos - cos_back).abs());
        if turns % (1 << 54) == 1 << 53 {
            worst_at_midpoint = worst_at_midpoint.max(difference);
        } else {
            worst = worst.max(difference);
        }
        if turns % (1 << 62) != 1 << 61 {
            let (sin, cos) = sin_cos_fine(turns);
            assert_eq!(sin_cos_fine(turns.wrapping_neg()), (-sin, cos), "{turns}");
        }
    }
    // Measured 131 and 20241 units of 2^-62.
    assert!(worst <= 160, "{worst}");
    assert!(worst_at_midpoint <= 20_500, "{worst_at_midpoint}");
}

#[test]
fn arc_tangent_within_its_bound() {
    let cordic = Cordic::new();
    let mut random = Random(12);
    let mut worst = 0u64;
    for i in 0..CASES {
        let size = |word: u64| (word as i64) >> (word & 63);
        let (x, y) = match i % 3 {
            0 => (random.word() as i64, random.word() as i64),
            1 => (size(random.word()), size(random.word())),
            // One size for both: slopes around one.
            _ => {
                let bits = random.word() & 63;
                ((random.word() as i64) >> bits, (random.word() as i64) >> bits)
            }
        };
        let x = x.saturating_abs().max(1);
        let expected = ((cordic.direction(x, y) + (1 << (BITS - 65))) >> (BITS - 64)) as u64;
        let angle = atan2_turns(y, x);
        worst = worst.max((angle.wrapping_sub(expected) as i64).unsigned_abs());
        assert_eq!(atan2_turns(-y.max(-i64::MAX), x), atan2_turns(y.max(-i64::MAX), x).wrapping_neg());
        assert_eq!(atan2_turns(y, -x), (1u64 << 63).wrapping_sub(angle), "{x} {y}");
    }
    // Measured 13 units of 2^-64 revolutions.
    assert!(worst <= 14, "{worst}");
}

#[test]
fn axes_and_diagonals_are_exact() {
    const EIGHTH: u64 = 1 << 61;
    assert_eq!(atan2_turns(0, 0), 0);
    for r in [1, 2, 3, 1000, (1 << 31) + 1, (1 << 58) + 1, i64::MAX] {
        let around = [(r, 0), (r, r), (0, r), (-r, r), (-r, 0), (-r, -r), (0, -r), (r, -r)];
        for (eighth, (x, y)) in (0u64..).zip(around) {
            assert_eq!(atan2_turns(y, x), eighth * EIGHTH, "{x} {y}");
        }
    }
    assert_eq!(atan2_turns(i64::MIN, i64::MIN), 5 * EIGHTH);
    assert_eq!(atan2_turns(0, i64::MIN), 4 * EIGHTH);
}

/// There and back: the direction of a point on the circle is its angle.
#[test]
fn arc_tangent_undoes_sine_and_cosine() {
    let mut worst = 0;
    for turns in angles() {
        let (sin, cos) = sin_cos_fine(turns);
        worst = worst.max((atan2_turns(sin, cos).wrapping_sub(turns) as i64).unsigned_abs());
    }
    assert!(worst <= 10, "{worst}");
}

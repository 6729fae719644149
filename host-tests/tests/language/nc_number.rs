//! Decimals to fixed point: exact against big integers, to nearest, ties away from zero.
use crate::nc_decode::{Random, commands, motions, value};

/// digits / 10^scale · num/den in units of 2^-32, by long division in 128 bits, then the rest decides.
fn reference(digits: u64, scale: u32, num: u64, den: u64) -> i64 {
    let divisor = 10_u128.pow(scale) * u128::from(den);
    let mut rest = u128::from(digits) * u128::from(num);
    let mut bits = (rest / divisor) as i64;
    rest %= divisor;
    for _ in 0..32 {
        rest *= 2;
        bits = bits * 2 + i64::from(rest >= divisor);
        if rest >= divisor {
            rest -= divisor;
        }
    }
    bits + i64::from(rest * 2 >= divisor)
}

fn text_of(digits: u64, scale: u32) -> String {
    let digits = format!("{digits:0>width$}", width = scale as usize + 1);
    let (whole, fraction) = digits.split_at(digits.len() - scale as usize);
    if scale == 0 { whole.to_string() } else { format!("{whole}.{fraction}") }
}

fn x_bits(program: &str) -> i64 {
    motions(program)[0].target[0].to_bits()
}

/// D3-010.
#[test]
fn coordinates_are_rounded_once() {
    let mut random = Random(3);
    for round in 0..20_000 {
        let scale = random.below(15) as u32;
        let digits = random.below(100_000 * 10_u64.pow(scale).min(10_u64.pow(14)));
        let text = text_of(digits, scale);
        let expected = reference(digits, scale, 1, 1);
        assert_eq!(x_bits(&format!("G0 X{text}")), expected, "{text} (round {round})");
        assert_eq!(x_bits(&format!("G0 X-{text}")), -expected, "-{text}");
    }
}

/// D3-010: what rounding leaves of increments does not add up, however they are written.
#[test]
fn increments_end_where_their_sum_does() {
    // As a plain block, as a block of any other kind, as an expression, in inches.
    let ways = [("", "", "", 1), ("", "M5 ", "", 1), ("", "", "]", 1), ("G70 ", "", "", 254)];
    for (before, ahead, behind, tenths) in ways {
        let mut random = Random(17);
        for even in [true, false] {
            let mut text = format!("{before}G91 F1000\n");
            // In 10^-9.
            let mut sum: i64 = 0;
            for _ in 0..4000 {
                let scale = if even { 1 } else { 1 + random.below(9) as u32 };
                let digits = if even { 1 } else { 1 + random.below(10_u64.pow(scale)) };
                let turns = !even && random.below(2) == 1;
                let value = (digits * 10_u64.pow(9 - scale)) as i64;
                sum += if turns { -value } else { value };
                let sign = if turns { "-" } else { "" };
                let opens = if behind.is_empty() { "" } else { "[" };
                text += &format!("{ahead}G1 X{opens}{sign}{}{behind}\n", text_of(digits, scale));
            }
            let den = if tenths == 1 { 1 } else { 10 };
            let expected = reference(sum.unsigned_abs(), 9, tenths, den) * sum.signum();
            let end = motions(&text).last().expect("a motion").target[0].to_bits();
            let what = format!("{before}{ahead}{behind}, {even}");
            assert_eq!(end, expected, "{what}: {} LSB beside it", end - expected);
        }
    }
}

/// Decimals of at most nine digits are multiplied instead of divided: those next to the middle between two
/// fixed-point numbers are the first that a reciprocal with too few bits would round wrongly.
#[test]
fn decimals_next_to_a_tie() {
    for scale in 1..=9 {
        // digits · 2^32 / 10^scale = digits · 2^(32 - scale) / 5^scale.
        let modulus = 5_u64.pow(scale);
        let power = (1_u64 << (32 - scale)) % modulus;
        let times = |a: u64, b: u64| (u128::from(a) * u128::from(b) % u128::from(modulus)) as u64;
        // The inverse by Euler: power^(4 · 5^(scale - 1) - 1).
        let (mut inverse, mut square, mut left) = (1, power, 4 * (modulus / 5) - 1);
        while left > 0 {
            if left % 2 == 1 {
                inverse = times(inverse, square);
            }
            (square, left) = (times(square, square), left / 2);
        }
        for rest in (modulus / 2).saturating_sub(2)..modulus / 2 + 4 {
            let first = times(rest % modulus, inverse);
            let most = 999_999_999.min(100_000 * 10_u64.pow(scale));
            for digits in [first, first + (most - first) / modulus * modulus] {
                let text = text_of(digits, scale);
                let expected = reference(digits, scale, 1, 1);
                assert_eq!(x_bits(&format!("G0 X{text}")), expected, "{text}");
                assert_eq!(x_bits(&format!("G0 X={text}")), expected, "{text}");
                assert_eq!(x_bits(&format!("G0 X-{text}")), -expected, "-{text}");
            }
        }
    }
}

#[test]
fn inches_are_25_4_mm() {
    let mut random = Random(4);
    for _ in 0..5000 {
        let scale = random.below(10) as u32;
        let digits = random.below(3900 * 10_u64.pow(scale));
        let text = text_of(digits, scale);
        assert_eq!(x_bits(&format!("G70 G0 X{text}")), reference(digits, scale, 254, 10), "{text}");
    }
    assert_eq!(
        motions("G70 G0 X1 C90")[0].target.map(|p| p.to_num::<f64>()),
        [25.4, 0.0, 0.0, 0.0, 90.0].map(|x: f64| { (x * 4_294_967_296.0).round() / 4_294_967_296.0 }),
        "rotary axes stay in degrees"
    );
}

#[test]
fn ties_go_away_from_zero() {
    // 2^-33 has 33 decimals in full; 19 significant digits reach the tie from above and below.
    assert_eq!(x_bits("G0 X0.0000000001164153219"), 1, "just above half");
    assert_eq!(x_bits("G0 X0.0000000001164153218"), 0, "just below half");
    // 0.5 of the LSB exactly: only an expression can say it.
    assert_eq!(x_bits("G0 X=2**-33"), 1);
    assert_eq!(x_bits("G0 X=-[2**-33]"), -1);
    assert_eq!(x_bits("G0 X=3*2**-33"), 2);
    assert_eq!(x_bits("G0 X=2**-34"), 0);
}

/// NC-006.
#[test]
fn feed_follows_p_chan_00108() {
    use glidepath::nc::Command;
    for (milli, text, digits, scale) in [
        (100_000, "1000", 1000, 0),
        (100, "2.5", 25, 1),
        (100, "20", 20, 0),
        (100_000, "0.125", 125, 3),
        (254_000, "7.1", 71, 1),
    ] {
        let mut setup = crate::nc_decode::setup();
        setup.feedrate_factor_milli = milli;
        let program = format!("G01 X1 F{text}");
        let (out, _, error, _) = crate::nc_decode::decode_with(setup, program.as_bytes(), 100);
        assert_eq!(error, None);
        let Command::Motion(motion) = out[0] else { panic!("{out:?}") };
        assert_eq!(
            motion.feed.to_bits(),
            reference(digits, scale, 100_000, u64::from(milli)),
            "{milli} {text}"
        );
    }
}

#[test]
fn literals_in_expressions_are_the_nearest_f64() {
    let mut random = Random(5);
    for _ in 0..20_000 {
        let digits = random.next() >> random.below(50);
        let scale = random.below(19) as u32;
        let text = text_of(digits, scale);
        if digits >= 10_u64.pow(19) {
            continue;
        }
        assert_eq!(value(&text), text.parse::<f64>().unwrap(), "{text}");
    }
}

#[test]
fn f64_results_round_to_nearest() {
    let mut random = Random(6);
    for _ in 0..20_000 {
        let x = (random.next() as i64 >> 12) as f64 / 4_294_967_296.0 / 64.0;
        if x.abs() >= 100_000.0 {
            continue;
        }
        // x is a dyadic number: its decimal text is exact, but as an expression it comes as f64.
        let expected = (x * 4_294_967_296.0).round() as i64;
        let whole = (x * 64.0 * 4_294_967_296.0) as i64;
        assert_eq!(x_bits(&format!("P1={whole} G0 X=P1/2**38")), expected, "{x}");
    }
}

/// D3-010.
#[test]
fn many_digits() {
    let long = format!("G0 X1.{}", "3".repeat(400));
    assert_eq!(x_bits(&long), reference(1_333_333_333_333_333_333, 18, 1, 1));
    assert_eq!(x_bits("G0 X000000000000000000000000012.5"), 25 << 31);
    assert_eq!(x_bits("G0 X.5"), 1 << 31);
    assert_eq!(x_bits("G0 X5."), 5 << 32);
    assert_eq!(x_bits("G0 X100000"), 100_000 << 32);
    assert_eq!(commands("G0 X-100000").len(), 1);
}

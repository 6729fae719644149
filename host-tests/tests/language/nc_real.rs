//! Functions of expressions compared with the standard library, through the language: at most 2 ulp, and
//! exact if the true value is simple.
use crate::nc_decode::{Random, error, value};
use glidepath::nc::NcErrorKind;

/// Distance in units of the last place of `b`.
fn ulps(a: f64, b: f64) -> f64 {
    if a == b {
        return 0.0;
    }
    let unit = f64::from_bits(b.abs().to_bits() + 1) - b.abs();
    (a - b).abs() / unit
}

/// Worst distance of a function over arguments of three decimals, which f64 holds as std parses them.
fn worst(name: &str, from: i64, to: i64, reference: impl Fn(f64) -> f64) -> f64 {
    let mut random = Random(7);
    let mut worst = 0.0_f64;
    for _ in 0..4000 {
        let milli = from + random.below((to - from) as u64) as i64;
        let text =
            format!("{}{}.{:03}", if milli < 0 { "-" } else { "" }, milli.abs() / 1000, milli.abs() % 1000);
        let (ours, theirs) = (value(&format!("{name}[{text}]")), reference(text.parse().unwrap()));
        let distance = ulps(ours, theirs);
        assert!(distance <= 3.0, "{name}[{text}] = {ours:e}, std {theirs:e}: {distance} ulp");
        worst = worst.max(distance);
    }
    println!("{name}: {worst} ulp");
    worst
}

/// sin(x + 90°·quarters), reduced exactly first; std's conversion to radians gets its own error back.
fn sin_degrees(x: f64, quarters: i64) -> f64 {
    let turn = (x / 90.0).round();
    let rest = x - turn * 90.0;
    let radians = rest.to_radians();
    let lost = rest.mul_add(0.017_453_292_519_943_295, -radians) + rest * 2.948_652_270_870_168_7e-19;
    let (s, c) = (radians.sin() + lost * radians.cos(), radians.cos() - lost * radians.sin());
    match (turn as i64 + quarters).rem_euclid(4) {
        0 => s,
        1 => c,
        2 => -s,
        _ => -c,
    }
}

/// Radians to degrees with the error of the product given back.
fn degrees(radians: f64) -> f64 {
    let high = radians.to_degrees();
    high + (radians.mul_add(57.295_779_513_082_32, -high) + radians * -1.987_849_567_057_628_3e-15)
}

#[test]
fn sine_and_cosine() {
    assert!(worst("SIN", -720_000, 720_000, |x| sin_degrees(x, 0)) <= 2.0);
    assert!(worst("COS", -720_000, 720_000, |x| sin_degrees(x, 1)) <= 2.0);
    assert!(worst("SIN", -1_000_000_000, 1_000_000_000, |x| sin_degrees(x, 0)) <= 2.0);
}

#[test]
fn tangent_and_its_inverse() {
    assert!(worst("TAN", -89_000, 89_000, |x| sin_degrees(x, 0) / sin_degrees(x, 1)) <= 3.0);
    assert!(worst("COT", 1, 179_000, |x| sin_degrees(x, 1) / sin_degrees(x, 0)) <= 3.0);
    assert!(worst("ATAN", -10_000, 10_000, |x| degrees(x.atan())) <= 2.0);
    assert!(worst("ATAN", -1_000_000, 1_000_000, |x| degrees(x.atan())) <= 2.0);
}

#[test]
fn arc_sine_and_arc_cosine() {
    assert!(worst("ASIN", -1000, 1000, |x| degrees(x.asin())) <= 3.0);
    assert!(worst("ACOS", -1000, 1000, |x| degrees(x.acos())) <= 3.0);
}

#[test]
fn root_exponential_logarithm() {
    assert_eq!(worst("SQRT", 0, 1_000_000_000, f64::sqrt), 0.0, "correctly rounded");
    assert!(worst("EXP", -300_000, 300_000, f64::exp) <= 2.0);
    assert!(worst("LN", 1, 100_000_000, f64::ln) <= 2.0);
}

#[test]
fn whole_parts() {
    assert_eq!(worst("INT", -100_000, 100_000, f64::trunc), 0.0);
    assert_eq!(worst("ROUND", -100_000, 100_000, f64::round), 0.0);
    assert_eq!(worst("FUP", -100_000, 100_000, f64::ceil), 0.0);
    assert_eq!(worst("FRACT", -100_000, 100_000, f64::fract), 0.0);
    assert_eq!(worst("ABS", -100_000, 100_000, f64::abs), 0.0);
    assert_eq!(worst("SIGN", -3, 4, |x| if x == 0.0 { 0.0 } else { x.signum() }), 0.0);
}

/// NC-007.
#[test]
fn exact_values() {
    for (expression, expected) in [
        ("SIN[0]", 0.0),
        ("SIN[30]", 0.5),
        ("SIN[90]", 1.0),
        ("SIN[150]", 0.5),
        ("SIN[180]", 0.0),
        ("SIN[-30]", -0.5),
        ("SIN[210]", -0.5),
        ("SIN[270]", -1.0),
        ("SIN[3600030]", 0.5),
        ("COS[0]", 1.0),
        ("COS[60]", 0.5),
        ("COS[90]", 0.0),
        ("COS[120]", -0.5),
        ("COS[180]", -1.0),
        ("COS[270]", 0.0),
        ("COS[-60]", 0.5),
        ("TAN[45]", 1.0),
        ("TAN[135]", -1.0),
        ("COT[45]", 1.0),
        ("ATAN[1]", 45.0),
        ("ATAN[-1]", -45.0),
        ("ACOT[1]", 45.0),
        ("ATAN2[1,0]", 90.0),
        ("ATAN2[1,-1]", 135.0),
        ("ATAN2[-1,-1]", -135.0),
        ("ASIN[1]", 90.0),
        ("ASIN[0.5]", 30.0),
        ("ACOS[-1]", 180.0),
        ("ACOS[0.5]", 60.0),
        ("ACOS[1]", 0.0),
        ("SQRT[2]*SQRT[2]", 2.0_f64.sqrt() * 2.0_f64.sqrt()),
        ("SQR[1.5]", 2.25),
        ("EXP[0]", 1.0),
        ("LN[1]", 0.0),
        ("DEXP[3]", 1000.0),
        ("MIN[2,-3]", -3.0),
        ("MAX[2,-3]", 2.0),
        ("7 MOD 4", 3.0),
        ("-7 MOD 4", -3.0),
        ("1 MOD 0.1", 1.0_f64 % 0.1),
        ("2**10", 1024.0),
        ("2**-2", 0.25),
        ("-2**2", -4.0),
        ("PI", std::f64::consts::PI),
    ] {
        let ours = value(expression);
        assert_eq!(ours, expected, "{expression} = {ours:e}");
    }
    assert!(ulps(value("2**0.5"), 2.0_f64.sqrt()) <= 2.0);
    assert!(ulps(value("DLOG[1000]"), 3.0) <= 2.0);
}

#[test]
fn outside_the_domain() {
    for (expression, kind) in [
        ("SQRT[-1]", NcErrorKind::Domain("SQRT")),
        ("LN[0]", NcErrorKind::Domain("LN")),
        ("ASIN[1.001]", NcErrorKind::Domain("ASIN")),
        ("ACOS[-2]", NcErrorKind::Domain("ACOS")),
        ("TAN[90]", NcErrorKind::Domain("TAN")),
        ("COT[0]", NcErrorKind::Domain("COT")),
        ("SIN[1000000000001]", NcErrorKind::Domain("SIN")),
        ("[-1]**0.5", NcErrorKind::Domain("**")),
        ("1/0", NcErrorKind::DivisionByZero),
        ("1 MOD [1-1]", NcErrorKind::DivisionByZero),
        ("EXP[1000]", NcErrorKind::Overflow),
        ("10**400", NcErrorKind::Overflow),
        ("1 MOD 10**-300", NcErrorKind::Overflow),
    ] {
        assert_eq!(error(&format!("P1={expression}")).kind, kind, "{expression}");
    }
}

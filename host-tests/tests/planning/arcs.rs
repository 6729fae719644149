//! Arcs as curves: from a micrometre to hundreds of metres, compared with the circle in f64. Ends are exact.
use glidepath::nc::Plane;
use glidepath::path::{Element, Measure, PathError, arc};
use glidepath::quantity::Position;
use host_tests::cases::random::Random;
use std::f64::consts::TAU;

const LSB: f64 = 1.0 / 4_294_967_296.0;
const LSB_40: f64 = 1.0 / (1u64 << 40) as f64;
const LSB_44: f64 = 1.0 / (1u64 << 44) as f64;

fn measure() -> Measure {
    Measure::new([Some(0), Some(1), Some(2)], core::iter::empty(), core::iter::empty())
}

struct Sample {
    from: [i64; 3],
    to: [i64; 3],
    centre: [i64; 2],
    clockwise: bool,
}

/// `grid`: coordinates have so many LSB. `None` if the ends are one point.
fn sample(r: &mut Random, grid: i64) -> Option<Sample> {
    let radius = r.magnitude(1e-2, 9e4);
    let least = (1e-5 / radius).max(1e-9);
    let (angle, sweep) = (r.between(0.0, TAU), r.magnitude(least, 6.2));
    let clockwise = r.unit() < 0.5;
    let turned = if clockwise { angle - sweep } else { angle + sweep };
    let on = |x: f64| (x / LSB / grid as f64).round() as i64 * grid;
    let centre = [r.between(-100.0, 100.0), r.between(-100.0, 100.0)].map(on);
    let at = |angle: f64, z: f64| {
        [centre[0] + on(radius * angle.cos()), centre[1] + on(radius * angle.sin()), on(z)]
    };
    let rise = if r.unit() < 0.5 { r.magnitude(1e-6, 10.0) } else { 0.0 };
    let (from, to) = (at(angle, 1.0), at(turned, 1.0 + rise));
    (from[..2] != to[..2]).then_some(Sample { from, to, centre, clockwise })
}

/// Distance from the start to `x` as an angle, in the direction of the arc, and both radii.
fn exact(s: &Sample) -> (f64, [f64; 2], [f64; 2]) {
    let r0 = [0, 1].map(|k| (s.from[k] - s.centre[k]) as f64 * LSB);
    let way = [0, 1].map(|k| (s.to[k] - s.from[k]) as f64 * LSB);
    let r1 = [0, 1].map(|k| (s.to[k] - s.centre[k]) as f64 * LSB);
    let (cross, dot) = (r0[0] * way[1] - r0[1] * way[0], r0[0] * r1[0] + r0[1] * r1[1]);
    let angle = (if s.clockwise { -cross } else { cross }).atan2(dot);
    // In one direction it is a full circle.
    (if angle <= 0.0 { angle + TAU } else { angle }, r0, r1)
}

fn element(s: &Sample) -> Result<Element<3>, PathError> {
    let [from, to] = [s.from, s.to].map(|x| x.map(Position::from_bits));
    arc(&from, &to, s.centre.map(Position::from_bits), Plane::G17, s.clockwise, &measure())
}

fn check(s: &Sample, element: &Element<3>) {
    let (angle, r0, r1) = exact(s);
    let (radius, last) = (r0[0].hypot(r0[1]), r1[0].hypot(r1[1]));
    let (grow, rise) = (last - radius, (s.to[2] - s.from[2]) as f64 * LSB);
    let from = s.from.map(Position::from_bits);
    let base = element.shape.base(&from);
    let at = |distance: i64| {
        let mut x = [Position::ZERO; 3];
        element.shape.at(distance, &base, &mut x);
        x.map(Position::to_bits)
    };
    let bits = element.shape.length.to_bits();
    assert_eq!((at(0), at(bits)), (s.from, s.to));

    let length = (radius.max(last) * angle).hypot(grow).hypot(rise);
    let off = bits as f64 * LSB_44 - length;
    assert!(off.abs() <= length * 1e-12 + radius * 1e-15 + 8.0 * LSB_44, "{off} of {length}, R {radius}");

    // f64 itself is off by 2^-52 of the radius.
    let tolerance = 1.1 * LSB + radius * (1.0 / (1u64 << 43) as f64);
    let sign = if s.clockwise { -1.0 } else { 1.0 };
    for part in [0.0, 0.25, 0.5, 0.77, 1.0] {
        let x = at((bits as f64 * part) as i64);
        let (sin, cos) = (sign * angle * part).sin_cos();
        let size = 1.0 + grow * part / radius;
        let off = [
            r0[0] * (cos - 1.0) * size - r0[1] * sin * size + r0[0] * (size - 1.0),
            r0[0] * sin * size + r0[1] * (cos - 1.0) * size + r0[1] * (size - 1.0),
            rise * part,
        ];
        for k in 0..3 {
            let error = (x[k] - s.from[k]) as f64 * LSB - off[k];
            assert!(error.abs() <= tolerance, "axis {k} at {part}: {error}, R {radius}, {angle}");
        }
    }
    for (end, r, size) in [(&element.entry, r0, radius), (&element.exit, r1, last)] {
        let (along, outward) = (sign * size * angle / length, grow / length);
        let unit = r.map(|x| x / size);
        let tangent =
            [unit[0] * outward - unit[1] * along, unit[1] * outward + unit[0] * along, rise / length];
        for (k, (is, exact)) in end.tangent.iter().zip(tangent).enumerate() {
            let error = *is as f64 * LSB_40 - exact;
            // LSB of length and gain show on short arcs.
            assert!(
                error.abs() <= 4.0 * LSB_40 + (20.0 * LSB_44 + size * 1e-15) / length,
                "axis {k}: {error}"
            );
        }
        for (is, unit) in end.curvature.iter().zip(unit) {
            let curvature = -unit * along * along / size;
            assert!((f64::from(*is) - curvature).abs() <= 4e-7 / size, "curvature {is} {curvature}");
        }
    }
    let circle = element.circle.unwrap();
    let share = radius.max(last) * angle / length;
    assert!((f64::from(circle.share) / share - 1.0).abs() < 4e-7, "share {} {share}", circle.share);
    assert!((f64::from(circle.radius) / radius.min(last) - 1.0).abs() < 2e-7);
}

#[test]
fn arcs_are_circles_with_exact_ends() {
    let mut r = Random::new(7);
    for i in 0..200_000 {
        // Of each second one the coordinates have three decimals, about.
        let Some(s) = sample(&mut r, if i % 2 == 0 { 1 } else { 4_294_967 }) else { continue };
        match element(&s) {
            Ok(element) => check(&s, &element),
            // Too coarse for so small a circle, or longer than a block may be.
            Err(PathError::RadiusDiffers { .. } | PathError::NoRadius | PathError::TooLong) => {}
            Err(error) => panic!("{error:?}"),
        }
    }
}

#[test]
fn ends_in_one_direction_are_a_full_circle() {
    for clockwise in [false, true] {
        for way in [[3, 4], [-8, 0], [7, -7], [0, 1], [300, 401], [-5, 12]] {
            for [first, last] in [[1 << 32, 1 << 32], [1 << 32, (1 << 32) + 300], [12_345_678, 12_340_000]] {
                let at = |size: i64| [way[0] * size, way[1] * size, 0];
                let s = Sample { from: at(first), to: at(last), centre: [0, 0], clockwise };
                let length = element(&s).unwrap().shape.length.to_bits() as f64 * LSB_44;
                let radius = f64::hypot(way[0] as f64, way[1] as f64) * first.max(last) as f64 * LSB;
                let circle = TAU * radius;
                assert!((length / circle - 1.0).abs() < 1e-8, "{way:?} {first} {last}: {length} of {circle}");
            }
        }
    }
}

/// 2π times 100 m is too much, and so is what no longer fits the number.
#[test]
fn circles_longer_than_a_block_are_refused() {
    for radius in [41_800.0, 60_000.0, 95_000.0, 120_000.0] {
        let x = (radius / LSB) as i64;
        for from in [[x, 0, 0], [x, x, 0], [-x, x, 0]] {
            let s = Sample { from, to: from, centre: [0, 0], clockwise: false };
            assert_eq!(element(&s), Err(PathError::TooLong), "{radius}");
        }
    }
}

//! Polynomials of the fifth degree from integers, compared with the same polynomials in f64: from a
//! micrometre to metres, with small and large curvature, with axes faster than the path. Ends are exact, and
//! no derivative exceeds its bound. The same for cubics, which only need points and directions.
use glidepath::path::poly::{Draft, Knot};
use glidepath::path::{Element, End};
use glidepath::quantity::Position;
use host_tests::cases::random::Random;

const LSB: f64 = 1.0 / 4_294_967_296.0;
const LSB_40: f64 = 1.0 / (1u64 << 40) as f64;

/// Powers over 0..1 of one axis.
fn powers(travel: f64, [v0, v1]: [f64; 2], [w0, w1]: [f64; 2]) -> [f64; 6] {
    let third = 10.0 * travel - 6.0 * v0 - 4.0 * v1 - 1.5 * w0 + 0.5 * w1;
    let fourth = -15.0 * travel + 8.0 * v0 + 7.0 * v1 + 1.5 * w0 - w1;
    [0.0, v0, 0.5 * w0, third, fourth, 6.0 * travel - 3.0 * (v0 + v1) - 0.5 * (w0 - w1)]
}

/// Value and three derivatives.
fn at(p: &[f64; 6], u: f64) -> [f64; 4] {
    let mut out = [0.0; 4];
    for (n, c) in p.iter().enumerate() {
        let mut factor = 1.0;
        for (k, out) in out.iter_mut().enumerate().filter(|(k, _)| *k <= n) {
            *out += factor * c * u.powi((n - k) as i32);
            factor *= (n - k) as f64;
        }
    }
    out
}

/// All axes.
fn finish((mut element, mut draft): (Element<3>, Draft<3>)) -> Option<Element<3>> {
    while !draft.is_done() {
        draft.go_on(&mut element)?;
    }
    Some(element)
}

#[test]
fn integers_make_the_polynomial_of_f64() {
    let r = &mut Random::new(7);
    let (mut made, mut worst) = (0, 0.0f64);
    for _ in 0..30_000 {
        let length = r.magnitude(1e-4, 500.0) as f32;
        let h = f64::from(length);
        // The first axis may be much faster than the path; the third one rests.
        let (fast, bend) = (r.magnitude(1e-3, 900.0), r.magnitude(1e-7, 1.5));
        let mut ends = [End { tangent: [0; 3], curvature: [0.0; 3] }; 2];
        let from = [r.between(-900.0, 900.0), r.between(-900.0, 900.0), 3.0].map(|x| (x / LSB) as i64);
        let mut to = from;
        for (k, size) in [fast, 1.0].into_iter().enumerate() {
            let slope = r.between(-size, size);
            let way = h * (slope + size * bend * r.between(-0.3, 0.3));
            to[k] += (way / LSB).round() as i64;
            for end in &mut ends {
                end.tangent[k] = ((slope + size * bend * r.between(-1.0, 1.0)) / LSB_40) as i64;
                end.curvature[k] = (size * bend * r.between(-3.0, 3.0) / h) as f32;
            }
        }
        let [from, to] = [from, to].map(|x| x.map(Position::from_bits));
        let [a, b] = [Knot { position: from, end: ends[0] }, Knot { position: to, end: ends[1] }];
        let Some(element) = Draft::new(&a, &b, length, 1.0).and_then(finish) else { continue };
        made += 1;
        let (bits, bounds) = (element.shape.length.to_bits(), element.bounds.unwrap());
        let mut out = from;
        element.shape.at(bits, &from, &mut out);
        assert_eq!(out, to, "{length} {ends:?}");
        for k in 0..3 {
            let number = |t: i64| t as f64 * LSB_40 * h;
            let second = |c: f32| f64::from(c) * h * h;
            let travel = (to[k].to_bits() - from[k].to_bits()) as f64 * LSB;
            let p = powers(
                travel,
                [number(ends[0].tangent[k]), number(ends[1].tangent[k])],
                [second(ends[0].curvature[k]), second(ends[1].curvature[k])],
            );
            let size = p[2..].iter().map(|c| c.abs()).sum::<f64>();
            for i in 0..=16 {
                let u = f64::from(i) / 16.0;
                let [x, first, second, third] = at(&p, u);
                element.shape.at((bits as f64 * u) as i64, &from, &mut out);
                let off = ((out[k].to_bits() - from[k].to_bits()) as f64 * LSB - x).abs();
                // Half a step, the rounding of lengths, and 2^-24 of the curvature's part.
                let most = 0.6 * LSB + 1e-12 * first.abs() + 1.5e-7 * size;
                worst = worst.max(off / most);
                assert!(off <= most, "axis {k} of {length} at {u}: off by {off:e}, {most:e}");
                let least = 2e-6 * size;
                for (value, bound, power) in
                    [(first, bounds.first[k], 1), (second, bounds.second[k], 2), (third, bounds.third[k], 3)]
                {
                    let (value, bound) = (value.abs(), f64::from(bound) * h.powi(power));
                    assert!(value <= bound * (1.0 + 1e-6) + least, "axis {k} of {length}: {value:e}");
                }
            }
        }
    }
    assert!(made > 25_000, "{made}");
    println!("{made} made, off by {worst:.2} of what is permitted");
}

#[test]
fn a_cubic_is_that_of_points_and_directions() {
    let r = &mut Random::new(8);
    let mut worst = 0.0f64;
    for _ in 0..20_000 {
        let length = r.magnitude(1e-3, 500.0) as f32;
        let h = f64::from(length);
        let from = [r.between(-900.0, 900.0), r.between(-900.0, 900.0), 3.0].map(|x| (x / LSB) as i64);
        let (mut to, mut ends) = (from, [End { tangent: [0; 3], curvature: [0.0; 3] }; 2]);
        let bend = r.magnitude(1e-7, 1.5);
        for (k, to) in to.iter_mut().enumerate().take(2) {
            let slope = r.between(-1.0, 1.0);
            *to += (h * (slope + bend * r.between(-0.3, 0.3)) / LSB).round() as i64;
            for end in &mut ends {
                end.tangent[k] = ((slope + bend * r.between(-1.0, 1.0)) / LSB_40) as i64;
                // Of no use.
                end.curvature[k] = (r.between(-3.0, 3.0) / h) as f32;
            }
        }
        let [from, to] = [from, to].map(|x| x.map(Position::from_bits));
        let [a, b] = [Knot { position: from, end: ends[0] }, Knot { position: to, end: ends[1] }];
        let made = Draft::new(&a, &b, length, 1.0).map(|(element, draft)| (element, draft.cubic()));
        let element = made.and_then(finish).unwrap();
        let (bits, bounds) = (element.shape.length.to_bits(), element.bounds.unwrap());
        let mut out = from;
        element.shape.at(bits, &from, &mut out);
        assert_eq!(out, to, "{length} {ends:?}");
        for k in 0..3 {
            let travel = (to[k].to_bits() - from[k].to_bits()) as f64 * LSB;
            let [v0, v1] = [0, 1].map(|i| ends[i].tangent[k] as f64 * LSB_40 * h);
            let (d, e) = (travel - v0, v1 - v0);
            let p = [0.0, v0, 3.0 * d - e, e - 2.0 * d, 0.0, 0.0];
            let size = p[2].abs() + p[3].abs();
            for i in 0..=16 {
                let u = f64::from(i) / 16.0;
                let [x, first, ..] = at(&p, u);
                element.shape.at((bits as f64 * u) as i64, &from, &mut out);
                let off = ((out[k].to_bits() - from[k].to_bits()) as f64 * LSB - x).abs();
                // Half a step, the rounding of lengths, and 2^-28 of what bends.
                let most = 0.6 * LSB + 1e-12 * first.abs() + 4e-9 * size;
                worst = worst.max(off / most);
                assert!(off <= most, "axis {k} of {length} at {u}: off by {off:e}, {most:e}");
                let bound = f64::from(bounds.first[k]) * h;
                assert!(first.abs() <= bound * (1.0 + 1e-6) + 2e-6 * size, "axis {k} of {length}: {first:e}");
            }
        }
    }
    println!("off by {worst:.2} of what is permitted");
}

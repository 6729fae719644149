//! The cases: a program, its text, its contour and its mirror images agree.
use host_tests::cases::random::{Mix, Random, program};
use host_tests::cases::{Program, decimal, edges, machines, named, set_point};
use host_tests::reference::geometry::{Contour, Shape};

const TOLERANCE: f64 = 3e-6;

fn machine() -> glidepath::machine::MachineData<6> {
    machines::mill(1000)
}

fn random(seed: u64) -> Program {
    program(seed, Mix::general(6, 60))
}

fn same_points(a: &Contour, b: &Contour, map: impl Fn(Vec<f64>) -> Vec<f64>, backward: bool) {
    let count = a.elements.len();
    assert_eq!(count, b.elements.len());
    for i in 0..count {
        let other = &b.elements[if backward { count - 1 - i } else { i }];
        for step in 0..=16 {
            let u = f64::from(step) / 16.0;
            let (p, q) = (map(a.elements[i].at(u)), other.at(if backward { 1.0 - u } else { u }));
            for (p, q) in p.iter().zip(&q) {
                assert!((p - q).abs() < 1e-9, "block {i} at {u}: {p} {q}");
            }
        }
    }
}

#[test]
fn contours_are_continuous_and_arcs_end_on_their_circle() {
    for seed in 0..40 {
        let contour = random(seed).contour(&machine());
        let mut at = contour.start.clone();
        let mut arcs = 0;
        for element in &contour.elements {
            assert_eq!(at, element.from);
            for (u, point) in [(0.0, &element.from), (1.0, &element.to)] {
                for (p, q) in element.at(u).iter().zip(point) {
                    assert!((p - q).abs() < 1e-9, "seed {seed}: {p} {q}");
                }
            }
            if let Shape::Arc { radius, .. } = element.shape {
                arcs += 1;
                assert!((radius[0] - radius[1]).abs() < TOLERANCE, "seed {seed}: {radius:?}");
            }
            at.clone_from(&element.to);
        }
        assert!(arcs > 3);
    }
}

#[test]
fn length_and_projection_agree_with_the_curve() {
    let mut r = Random::new(7);
    for seed in 0..20 {
        for element in random(seed).contour(&machine()).elements {
            let polyline: f64 = (0..2000)
                .map(|i| {
                    let (a, b) = (element.at(f64::from(i) / 2000.0), element.at(f64::from(i + 1) / 2000.0));
                    element.main.iter().map(|&k| (b[k] - a[k]).powi(2)).sum::<f64>().sqrt()
                })
                .sum();
            assert!((polyline - element.main_length()).abs() <= 1e-5 * polyline, "{element:?}");
            let u = r.unit();
            let found = element.project(&element.at(u), u + 0.01);
            assert!((found - u).abs() < 1e-7, "{found} {u} {element:?}");
            let h = 1e-6;
            for (k, d) in element.derivative(u).into_iter().enumerate() {
                let slope = (element.at(u + h)[k] - element.at(u - h)[k]) / (2.0 * h);
                assert!((slope - d).abs() <= 1e-5 * (1.0 + d.abs()), "{k} {slope} {d}");
            }
        }
    }
}

#[test]
fn mirrored_turned_and_reversed_programs_are_that() {
    for seed in 0..20 {
        let machine = machine();
        let p = random(seed);
        let contour = p.contour(&machine);
        for axis in 0..6 {
            let mirror = |mut x: Vec<f64>| {
                x[axis] = -x[axis];
                x
            };
            same_points(&contour, &p.mirrored(axis).contour(&machine), mirror, false);
            assert_eq!(p.mirrored(axis).mirrored(axis).moves, p.moves);
        }
        assert_eq!(p.reversed().reversed().start, p.start);
        same_points(&contour, &p.reversed().contour(&machine), |x| x, true);
    }
    let flat = program(5, Mix::general(2, 60));
    let machine = machines::even::<2>(1000);
    let turn = |x: Vec<f64>| vec![-x[1], x[0]];
    same_points(&flat.contour(&machine), &flat.turned().contour(&machine), turn, false);
}

#[test]
fn text_is_what_the_program_says() {
    let p = Program::new("text", 3).line(&[1.5, -0.000_001], 600.0).stop().arc(
        &[1.5, 20.0],
        [0.0, 10.0],
        true,
        90.5,
    );
    let text = p.text(&machines::even::<3>(1000));
    assert_eq!(
        text,
        "%case\nN1 G90\nN10 G60 G01 X1.5 Y-0.000001 Z0 F600\nN20 G02 X1.5 Y20 Z0 I0 J10 F90.5\nM30\n"
    );
    assert_eq!(decimal(-100_500_000), "-100.5");
    // Half an LSB is rounded away from zero: 2^-33 mm is between the nanometres, so look at whole ones.
    assert_eq!(set_point(1_000_000), 1 << 32);
    assert_eq!(set_point(-1), -4295);
    assert_eq!(random(3), random(3));
    assert_ne!(random(3).moves, random(4).moves);
}

#[test]
fn named_programs_are_closed_where_they_should_be() {
    let machine = machines::even::<3>(1000);
    let chords = named::chords(20_000.0, 3).contour(&machine);
    assert_eq!(chords.elements.len(), 66);
    for element in &chords.elements[1..65] {
        assert!((element.main_length() - 160.0 * (std::f64::consts::PI / 64.0).sin()).abs() < 2e-6);
    }
    assert_eq!(named::slot(1.0, 3).end(), [0; 3]);
    assert_eq!(named::helix(1.0).end(), [0; 3]);
    assert!(edges::three_axes().len() + edges::rotary().len() > 20);
}

//! Contour mode in runs of short blocks: the driven contour stays inside the tolerance, also with left-out
//! blocks.
use glidepath::nc::{Contour, ContourMethod, Value};
use glidepath::quantity::Position;
use host_tests::cases::machines;
use host_tests::cases::random::Random;
use host_tests::cases::{NM, Program};
use host_tests::corner::{blocks, position, round};
use host_tests::deviation::deviation;

/// A polygon of so many blocks of these lengths, mm, as a program and as points. Half of them in the plane.
fn polygon(seed: u64, count: usize, [least, most]: [f64; 2]) -> (Program, Vec<[f64; 3]>) {
    let mut r = Random::new(seed);
    let flat = r.once_in(2);
    // Knees of a walk: gentle ones, or any.
    let knee = if r.once_in(3) { 180.0 } else { 40.0 };
    let mut heading = [r.between(-180.0, 180.0), 0.0];
    let mut at = [0.0; 3];
    let mut points = vec![at];
    let mut program = Program::new(format!("polygon {seed}"), 3);
    for _ in 0..count {
        heading[0] += r.between(-knee, knee);
        heading[1] = if flat { 0.0 } else { r.between(-80.0, 80.0) };
        let (sin, cos) = heading[0].to_radians().sin_cos();
        let (up, level) = heading[1].to_radians().sin_cos();
        let length = r.magnitude(least, most);
        for (x, d) in at.iter_mut().zip([cos * level, sin * level, up]) {
            *x = ((*x + length * d) * NM as f64).round() / NM as f64;
        }
        program = program.line(&at, 6000.0);
        points.push(at);
    }
    (program, points)
}

fn mm(x: f64) -> Option<Position> {
    Some(position((x * NM as f64).round() as i64))
}

/// Every method with the tolerance or distance `d`, in mm.
fn methods(d: f64) -> [(&'static str, Contour); 9] {
    let method = |method| Contour { method: Some(method), ..Contour::default() };
    let dev = Contour { path_dev: mm(d), ..method(ContourMethod::Dev) };
    let soft = Contour { path_dist: mm(d), ..method(ContourMethod::DistSoft) };
    let max_angle = Some(Position::const_from_int(180));
    [
        ("DEV", dev),
        ("DEV MAX_ANGLE=180", Contour { max_angle, ..dev }),
        ("DEV RELEVANT_PATH", Contour { relevant_path: mm(0.2), ..dev }),
        // As is advised.
        ("DEV RELEVANT_PATH=PATH_DEV", Contour { relevant_path: mm(d), ..dev }),
        ("PTP", Contour { method: Some(ContourMethod::Ptp), ..dev }),
        ("DIST", Contour { pre_dist: mm(d), post_dist: mm(d), ..method(ContourMethod::Dist) }),
        ("DIST_SOFT", soft),
        ("DIST_SOFT DIST_WEIGHT", Contour { dist_weight: Some(Value::const_from_int(100)), ..soft }),
        ("POS", Contour { pre_dist: mm(d), post_dist: mm(d), ..method(ContourMethod::Pos) }),
    ]
}

/// Runs polygons of these lengths by every method; how many blocks were left out in all.
fn keeps(seeds: std::ops::Range<u64>, lengths: [f64; 2]) -> usize {
    const BLOCKS: usize = 40;
    let mut machine = machines::even::<3>(1000);
    let mut left_out = 0;
    for hsc in [false, true] {
        machine.channel.slope_profile = if hsc { 3 } else { 1 };
        for seed in seeds.clone() {
            let (program, corners) = polygon(seed, BLOCKS, lengths);
            let blocks = blocks(&program, &machine);
            for d in [0.001, 0.003, 0.01, 0.03, 0.1] {
                for (name, contour) in methods(d) {
                    let pieces = round(&blocks, &machine, &contour);
                    let (off, block) = deviation(&corners, &pieces);
                    assert!(off <= d, "{name} {d}, polygon {seed}, HSC {hsc}: {off} at block {block}");
                    let end = &pieces.last().expect("motion").at(1.0);
                    assert!(
                        end.iter().zip(&corners[BLOCKS]).all(|(a, b)| (a - b).abs() < 1e-9),
                        "{name} {seed}"
                    );
                    let mut numbers: Vec<u32> = pieces.iter().map(|piece| piece.out.data.number).collect();
                    numbers.dedup();
                    left_out += BLOCKS - numbers.len();
                }
            }
        }
    }
    left_out
}

/// Rows: D3-079, D3-149.
#[test]
fn short_blocks_keep_the_tolerance_by_every_method() {
    assert!(keeps(0..8, [0.02, 1.0]) > 100);
}

/// Rows: D3-042, D3-043, D3-277.
#[test]
fn blocks_that_are_left_out_keep_the_tolerance() {
    assert!(keeps(1000..1008, [0.001, 0.1]) > 1000);
}

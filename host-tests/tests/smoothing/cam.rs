//! The programs of short blocks have the described properties.
use host_tests::cam;

/// The end points of all blocks behind the head; words that are missing stay.
fn points(text: &str) -> Vec<[f64; 3]> {
    let mut at = [0.0; 3];
    let mut points = vec![at];
    for line in text.lines().skip_while(|line| !line.contains("G01")).skip(1) {
        for word in line.split_whitespace().skip(1) {
            let Some(axis) = "XYZ".find(|letter| word.starts_with(letter)) else { continue };
            at[axis] = word[1..].parse().expect("a number");
        }
        if !line.ends_with("M30") {
            points.push(at);
        }
    }
    points
}

fn lengths(points: &[[f64; 3]]) -> Vec<f64> {
    let length = |pair: &[[f64; 3]]| (0..3).map(|k| (pair[1][k] - pair[0][k]).powi(2)).sum::<f64>().sqrt();
    points.windows(2).map(length).collect()
}

#[test]
fn the_circle_has_64_chords_and_tangential_lines() {
    let text = cam::circle("#CONTOUR MODE [DEV PATH_DEV=0.02]\nG261");
    assert!(text.contains("N20 #CONTOUR MODE [DEV PATH_DEV=0.02]\nN30 G261\nN40 G01 F20000\n"), "{text}");
    let points = points(&text);
    let lengths = lengths(&points);
    assert_eq!((lengths.len(), lengths[0], lengths[65]), (66, 80.0, 80.0));
    let chord = 160.0 * f64::sin(std::f64::consts::PI / 64.0);
    assert!(lengths[1..65].iter().all(|length| (length - chord).abs() < 2e-6), "{lengths:?}");
    assert!(points[1..66].iter().all(|p| (f64::hypot(p[0] - 80.0, p[1] - 80.0) - 80.0).abs() < 1e-6));
    // Counterclockwise, as the line before it goes on.
    assert!(points[2][0] > 80.0 && points[2][1] > 0.0);
}

#[test]
fn rows_are_5000_segments_on_their_surface() {
    let points = points(&cam::rows(""));
    let lengths = lengths(&points);
    assert_eq!(lengths.len(), cam::SEGMENTS);
    assert!(lengths.iter().all(|length| (0.048..0.502).contains(length)), "{lengths:?}");
    let mean = lengths.iter().sum::<f64>() / 5000.0;
    assert!((0.25..0.30).contains(&mean), "{mean}");
    for [x, y, z] in &points {
        let surface = 5.0 * (x / 10.0).sin() * (y / 10.0).cos();
        assert!((z - surface).abs() < 9e-4, "X{x} Y{y} Z{z} for {surface}");
    }
    // A whole row takes about 230 segments.
    assert_eq!(points.iter().filter(|p| p[0] == 60.0 || p[0] == 0.0).count() / 2, 21);
    assert!(points.iter().all(|p| p.iter().all(|v| (v * 1e3 - (v * 1e3).round()).abs() < 1e-6)));
}

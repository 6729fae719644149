//! Whole programs: the result, computed in a second way.
use crate::nc_decode::motions;
use glidepath::nc::{ArcBy, MotionKind};

/// Within an LSB of 2^-32 of what f64 says.
fn near(ours: glidepath::quantity::Position, theirs: f64) -> bool {
    (ours.to_num::<f64>() - theirs).abs() <= 2.4e-10
}

/// NC-008.
#[test]
fn a_fan_of_13_and_14_strokes() {
    let all = motions(include_str!("../../programs/nc/sweep.nc"));
    assert_eq!(all.len(), 1 + 3 * 13 + 3 * 14);
    let strokes = all[1..].iter().skip(1).step_by(3);
    let angles = (0..13).map(|i| 7.5 * f64::from(i)).chain((0..14).map(|i| 270.0 + 7.5 * f64::from(i)));
    for (stroke, angle) in strokes.zip(angles) {
        assert_eq!(stroke.n, angle as u32, "the fraction of a block number is cut");
        assert!(near(stroke.target[0], 40.0 * angle.to_radians().cos()), "{angle}");
        assert!(near(stroke.target[1], 40.0 * angle.to_radians().sin()), "{angle}");
        assert_eq!(stroke.feed, 3000);
    }
    assert!(all.iter().skip(3).step_by(3).all(|m| m.target[0] == -40 && m.target[1] == 0));
}

/// NC-007.
#[test]
fn a_polygon_and_its_circle() {
    let all = motions(include_str!("../../programs/nc/polygon.nc"));
    assert_eq!(all.len(), 2 + 16 + 1 + 4);
    for (i, corner) in all[2..18].iter().enumerate() {
        let angle = f64::from(i as u32 + 1) * 22.5;
        assert!(near(corner.target[0], 25.0 * angle.to_radians().sin()), "{i}");
        assert!(near(corner.target[1], 25.0 * (1.0 - angle.to_radians().cos())), "{i}");
        assert_eq!(corner.target[4].to_num::<f64>(), angle - 90.0);
        assert_eq!((corner.n, corner.feed.to_num::<f64>()), (50, 1500.0));
    }
    // The corners on the axes are exact.
    assert_eq!((all[5].target[0], all[5].target[1]), (25.into(), 25.into()));
    assert_eq!((all[17].target[0], all[17].target[1]), (0.into(), 0.into()));
    let circle = &all[21];
    let centre = [0, 25].map(glidepath::quantity::Position::from_num);
    assert!(
        matches!(circle.kind, MotionKind::Arc { clockwise: false, by: ArcBy::Centre(c), .. } if c == centre)
    );
    assert_eq!(circle.target, all[20].target, "a full circle ends where it began");
    assert_eq!(circle.feed, 2000);
}

#[test]
fn the_same_program_twice_gives_the_same_commands() {
    let text = include_str!("../../programs/nc/everything.nc");
    assert_eq!(crate::nc_decode::commands(text), crate::nc_decode::commands(text));
}

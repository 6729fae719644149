//! How far a moved contour is from the programmed one, block by block, either way. Nothing but points is taken from the library.
use crate::corner::Piece;

/// Points of each piece of the moved contour.
const POINTS: u32 = 32;

/// Points of each programmed block.
const PLACES: u32 = 16;

type Point = [f64; 3];

fn apart(a: &Point, b: &Point) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
}

fn between(a: &Point, b: &Point, u: f64) -> Point {
    std::array::from_fn(|k| a[k] + (b[k] - a[k]) * u)
}

/// Distance of a point from a straight piece.
fn from_line(q: &Point, [a, b]: [&Point; 2]) -> f64 {
    let along = (0..3).map(|k| (q[k] - a[k]) * (b[k] - a[k])).sum::<f64>();
    let square = apart(a, b).powi(2);
    let u = if square > 0.0 { (along / square).clamp(0.0, 1.0) } else { 0.0 };
    apart(q, &between(a, b, u))
}

/// The largest distance between a polygon and what is moved in its place, and the block where it is. What a piece stands for are the
/// blocks from that of the one before to that of the one behind: far parts that come near do not count.
pub fn deviation<const AXES: usize>(corners: &[Point], pieces: &[Piece<AXES>]) -> (f64, usize) {
    let blocks = corners.len() - 1;
    let number = |piece: &Piece<AXES>| piece.out.data.number as usize;
    let mut numbers: Vec<usize> = pieces.iter().map(number).collect();
    numbers.dedup();
    let beside = |n: usize| {
        let i = numbers.iter().position(|number| *number == n).expect("one of them");
        let last = numbers.get(i + 1).copied().unwrap_or(blocks - 1);
        [i.checked_sub(1).map_or(0, |i| numbers[i]), last]
    };
    let points = |piece: &Piece<AXES>| {
        let point = |i: u32| {
            let at = piece.at(f64::from(i) / f64::from(POINTS));
            [at[0], at[1], at[2]]
        };
        (0..=POINTS).map(point).collect::<Vec<Point>>()
    };
    let moved: Vec<_> = pieces.iter().map(|piece| (beside(number(piece)), points(piece))).collect();
    let mut worst = (0.0, 0);
    let mut see = |off: f64, block: usize| {
        if off > worst.0 {
            worst = (off, block);
        }
    };
    for ([first, last], points) in &moved {
        for q in points {
            let off = (*first..=*last).map(|b| from_line(q, [&corners[b], &corners[b + 1]]));
            see(off.fold(f64::INFINITY, f64::min), *last);
        }
    }
    for b in 0..blocks {
        let near: Vec<_> =
            moved.iter().filter(|(near, _)| (near[0]..=near[1]).contains(&b)).map(|m| &m.1).collect();
        for i in 0..=PLACES {
            let q = between(&corners[b], &corners[b + 1], f64::from(i) / f64::from(PLACES));
            let lines = near.iter().flat_map(|points| points.windows(2));
            let off = lines.map(|pair| from_line(&q, [&pair[0], &pair[1]])).fold(f64::INFINITY, f64::min);
            see(off, b);
        }
    }
    worst
}

//! Deviation between a driven contour and the programmed contour, block by block, in both directions. Only
//! points come from the library.
use crate::corner::Piece;

/// Number of points on each piece of the driven contour.
const POINTS: u32 = 32;

/// Number of points on each programmed block.
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

/// The largest distance between a polygon and the driven contour that replaces it, and the block with this
/// distance. A piece is compared with the blocks between those of its neighbours, so distant parts that come
/// near do not count.
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

/// The places between two points, as parts, at which a linear and a quadratic condition hold; both sets are
/// convex.
type Free = Option<[f64; 2]>;

/// Whether a path follows a contour in order, within `path` in the first three axes and within `track` in
/// every other axis. Both are followed forward at the same time (Fréchet distance, with the free space of Alt
/// and Godau). Both are polygons.
pub fn follows(path: &[Vec<f64>], contour: &[Vec<f64>], [near, track]: [f64; 2]) -> bool {
    // Interval of the line from `a` to `b` within the distance of point `q`.
    let free = |q: &[f64], a: &[f64], b: &[f64]| -> Free {
        let (mut low, mut high) = (0.0_f64, 1.0_f64);
        for k in 3..q.len() {
            let (off, d) = (a[k] - q[k], b[k] - a[k]);
            if d == 0.0 {
                if off.abs() > track {
                    return None;
                }
                continue;
            }
            let ends = [(-track - off) / d, (track - off) / d];
            low = low.max(ends[0].min(ends[1]));
            high = high.min(ends[0].max(ends[1]));
        }
        let [mut dd, mut od, mut oo] = [0.0; 3];
        for k in 0..3 {
            let (off, d) = (a[k] - q[k], b[k] - a[k]);
            (dd, od, oo) = (dd + d * d, od + off * d, oo + off * off);
        }
        if dd > 0.0 {
            let root = od * od - dd * (oo - near * near);
            if root < 0.0 {
                return None;
            }
            low = low.max((-od - root.sqrt()) / dd);
            high = high.min((-od + root.sqrt()) / dd);
        } else if oo > near * near {
            return None;
        }
        (low <= high).then_some([low, high])
    };
    let (columns, rows) = (path.len() - 1, contour.len() - 1);
    // Reachable part of the left sides of the cells in a column.
    let mut left: Vec<Free> = vec![None; rows];
    let mut open = true;
    for (j, left) in left.iter_mut().enumerate() {
        *left = free(&path[0], &contour[j], &contour[j + 1]).filter(|free| open && free[0] <= 0.0);
        open = left.is_some_and(|free| free[1] >= 1.0);
    }
    let mut along = true;
    for i in 0..columns {
        let [a, b] = [&path[i], &path[i + 1]];
        let mut bottom = free(&contour[0], a, b).filter(|free| along && free[0] <= 0.0);
        along = bottom.is_some_and(|free| free[1] >= 1.0);
        for j in 0..rows {
            let right = free(b, &contour[j], &contour[j + 1]);
            let top = free(&contour[j + 1], a, b);
            let beyond = |side: Free, from: Free| {
                let (side, from) = (side?, from?);
                (from[0] <= side[1]).then_some([side[0].max(from[0]), side[1]])
            };
            let next_left = if bottom.is_some() { right } else { beyond(right, left[j]) };
            bottom = if left[j].is_some() { top } else { beyond(top, bottom) };
            left[j] = next_left;
        }
    }
    left[rows - 1].is_some_and(|free| free[1] >= 1.0)
}

//! Checks, in integers, that a cell of Surface or a line stays inside the tolerance. A cell is the polynomial
//! of the fifth degree between two knots of the smoothed path.
//!
//! A polynomial lies inside the convex hull of its Bernstein coefficients. The difference between a part of a
//! cell and the programmed chord beside this part is such a polynomial. If all coefficients of the difference
//! are inside the tolerance, the path is inside the tolerance.
//!
//! Path and chords are compared at equal fractions of both lengths, so the path also follows the contour in
//! its order.
use super::parameters::Tolerance;
use crate::math::float::{max, to_f32};
use crate::math::wide::mul_shift;
use crate::path::poly::Knot;
use crate::quantity::Position;

/// Coefficients, LSB 2^-26 mm, from the start of the cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hull<const AXES: usize> {
    points: [[i32; AXES]; 6],
}

const LSB_40: f32 = 1.0 / (1u64 << 40) as f32;
const ONE_26: f32 = (1u32 << 26) as f32;
/// Number of bits by which the LSB of a hull is coarser than that of a position.
const COARSER: u32 = 6;

/// Margin of a tolerance for rounding: 2^-17 mm, in LSB of a hull.
const ROUNDING: i64 = 1 << 9;

/// An offset in the LSB of a hull, limited to its range.
fn coarse(x: Position, from: Position) -> i32 {
    let d = x.to_bits().wrapping_sub(from.to_bits()) >> COARSER;
    d.clamp(i64::from(-BEYOND), i64::from(BEYOND)) as i32
}

/// 16 mm or degrees: no cell is that large.
const BEYOND: i32 = 1 << 30;

/// Interpolates between two numbers; `part`: LSB 2^-31.
#[cfg_attr(feature = "fast", inline(always))]
fn between(a: i32, b: i32, part: i32) -> i32 {
    let d = i64::from(b) - i64::from(a);
    a.wrapping_add(((d * i64::from(part) + (1 << 30)) >> 31) as i32)
}

/// A part below 1, LSB 2^-31.
fn part_of(x: f32) -> i32 {
    const MOST: f32 = 2_147_483_520.0;
    let x = x * 2_147_483_648.0;
    if x <= 0.0 {
        0
    } else if x >= MOST {
        i32::MAX
    } else {
        x as i32
    }
}

/// A tolerance less the margin for rounding, LSB 2^-26 mm.
fn most(tolerance: f32) -> i64 {
    ((tolerance * ONE_26) as i64 - ROUNDING).max(0)
}

/// A chord next to a cell, or a part of a chord: both ends, and the tolerance. Also which fraction of the
/// rest of the cell lies next to this chord.
pub struct Beside<'a, const AXES: usize> {
    pub ends: [&'a [Position; AXES]; 2],
    pub tolerance: Tolerance,
    pub part: f32,
}

impl<const AXES: usize> Hull<AXES> {
    /// The cell of `length` (mm) between two knots. Returns `None` if the cell is too large.
    pub fn new(from: &Knot<AXES>, to: &Knot<AXES>, length: f32) -> Option<Self> {
        let mut points = [[0; AXES]; 6];
        let fine = ONE_26 * length;
        for k in 0..AXES {
            let end = coarse(*to.position.get(k)?, *from.position.get(k)?);
            let slope = |knot: &Knot<AXES>| {
                let t = to_f32(*knot.end.tangent.get(k)?) * (LSB_40 * 0.2) * fine;
                let c = *knot.end.curvature.get(k)? * (0.05 * length) * fine;
                (max(t, -t) + max(c, -c) < 2.5e8).then_some([t as i32, (2.0 * t) as i32, c as i32])
            };
            let ([t0, tt0, c0], [t1, tt1, c1]) = (slope(from)?, slope(to)?);
            if end.abs() >= BEYOND / 2 {
                return None;
            }
            let column = [0, t0, tt0 + c0, end - tt1 + c1, end - t1, end];
            for (point, x) in points.iter_mut().zip(column) {
                *point.get_mut(k)? = x;
            }
        }
        Some(Self { points })
    }

    /// An upper bound of the path speed in the cell, relative to the planned speed.
    pub fn fastest(&self, length: f32, space: impl Fn(&[f32; AXES]) -> f32) -> f32 {
        let mut most = 0.0;
        for pair in self.points.windows(2) {
            let [a, b] = pair else { continue };
            let mut d = [0.0; AXES];
            for (d, (a, b)) in d.iter_mut().zip(a.iter().zip(b)) {
                *d = (b - a) as f32;
            }
            most = max(most, space(&d));
        }
        most * 5.0 / (ONE_26 * length) * (1.0 + 1.0 / 1_048_576.0)
    }

    /// Cuts the cell at `part`: keeps the second part, and returns the first part.
    fn cut(&mut self, part: i32) -> Self {
        let mut before = *self;
        for k in 0..AXES {
            let mut b = [0; 6];
            for (b, point) in b.iter_mut().zip(&self.points) {
                *b = point.get(k).copied().unwrap_or(0);
            }
            let (mut left, mut right) = (b, b);
            for i in 1..6 {
                for j in 0..6 - i {
                    b[j] = between(b[j], b[j + 1], part);
                }
                (left[i], right[5 - i]) = (b[0], b[5 - i]);
            }
            for ((before, behind), (left, right)) in
                before.points.iter_mut().zip(&mut self.points).zip(left.into_iter().zip(right))
            {
                if let (Some(before), Some(behind)) = (before.get_mut(k), behind.get_mut(k)) {
                    (*before, *behind) = (left, right);
                }
            }
        }
        before
    }

    /// Whether the part of the cell next to a chord is inside the tolerance. The call removes this part, so
    /// the next call checks the part that follows.
    pub fn keeps(&mut self, origin: &[Position; AXES], chord: &Beside<'_, AXES>, main: u32) -> bool {
        let part = part_of(chord.part);
        let own = if part == i32::MAX { *self } else { self.cut(part) };
        let (path, track) = (most(chord.tolerance.path), most(chord.tolerance.track));
        let mut squares = [0i64; 6];
        for k in 0..AXES {
            let (Some(origin), Some(from), Some(to)) =
                (origin.get(k), chord.ends[0].get(k), chord.ends[1].get(k))
            else {
                return false;
            };
            let (from, to) = (coarse(*from, *origin), coarse(*to, *origin));
            if from.abs() == BEYOND || to.abs() == BEYOND {
                return false;
            }
            let is_main = main >> (k & 31) & 1 == 1;
            for (i, (point, square)) in own.points.iter().zip(&mut squares).enumerate() {
                let Some(x) = point.get(k) else { return false };
                // Fifths of 2^31.
                let at = between(from, to, if i == 5 { i32::MAX } else { 429_496_730 * i as i32 });
                let d = i64::from(*x) - i64::from(at);
                if is_main {
                    *square = square.saturating_add(d * d);
                } else if d.abs() > track {
                    return false;
                }
            }
        }
        squares.iter().all(|square| *square <= path * path)
    }
}

/// A line that is checked chord by chord.
pub struct Straight<'a, const AXES: usize> {
    at: [Position; AXES],
    to: &'a [Position; AXES],
}

impl<'a, const AXES: usize> Straight<'a, AXES> {
    pub fn new(from: &[Position; AXES], to: &'a [Position; AXES]) -> Self {
        Self { at: *from, to }
    }

    /// Whether the part of the line next to a chord is inside the tolerance. The call removes this part. The
    /// distance of a line from a chord is largest at an end.
    pub fn keeps(&mut self, chord: &Beside<'_, AXES>, main: u32) -> bool {
        let part = i64::from(part_of(chord.part));
        let mut end = self.at;
        for (end, to) in end.iter_mut().zip(self.to) {
            let d = to.to_bits().wrapping_sub(end.to_bits());
            let d = if chord.part >= 1.0 { d } else { mul_shift(d, part, 31) };
            *end = Position::from_bits(end.to_bits().wrapping_add(d));
        }
        let ends = [(&self.at, chord.ends[0]), (&end, chord.ends[1])];
        let inside = ends.into_iter().all(|(at, beside)| {
            let mut square = 0i64;
            let tracks = at.iter().zip(beside).enumerate().all(|(k, (at, beside))| {
                let d = i64::from(coarse(*at, *beside));
                if main >> (k & 31) & 1 == 1 {
                    square = square.saturating_add(d * d);
                    return d.abs() < i64::from(BEYOND);
                }
                d.abs() <= most(chord.tolerance.track)
            });
            tracks && square <= most(chord.tolerance.path) * most(chord.tolerance.path)
        });
        self.at = end;
        inside
    }
}

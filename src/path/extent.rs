//! Computes the least and the greatest coordinate of an axis on a curve, for the check of the software
//! limits.
use super::arc::plane_hypot;
use super::{Curve, Element, FINER};
use crate::math::angle::atan2_turns;
use crate::math::float::to_f32;
use crate::math::wide::Halves;
use crate::quantity::Position;
use heapless::Vec;

/// A quarter of a revolution, LSB 2^-64.
const QUARTER: u64 = 1 << 62;

/// Largest depth of halvings of a polynomial; below: their largest number.
const DEPTH: u32 = 8;
const SPLITS: u32 = 12;

/// A nanometre: more than the rounding of a curve's end and of the direction there.
const NEAR: f64 = 1.0 / (1u64 << 20) as f64;

const LSB_32: f64 = 1.0 / (1u64 << 32) as f64;
const ONE_32: f64 = (1u64 << 32) as f64;

impl<const AXES: usize> Element<AXES> {
    /// The least and the greatest coordinate of an axis, on an arc from `from` to `to` about `centre`. If
    /// start and end radius differ, the larger one counts.
    pub fn arc_range(
        &self,
        axis: usize,
        from: &[Position; AXES],
        to: &[Position; AXES],
        centre: &[Position; 2],
    ) -> [Option<Position>; 2] {
        let ends = [from.get(axis).copied(), to.get(axis).copied()];
        let [Some(start), Some(end)] = ends else { return ends };
        let mut range = [start.min(end), start.max(end)];
        let Curve::Arc(arc) = self.shape.curve else { return range.map(Some) };
        let [p, q] = arc.plane.map(usize::from);
        let which = if axis == p { 0 } else { 1 };
        if axis == p || axis == q {
            let a = arc.a;
            let radius = |at: &[Position; AXES]| {
                let of = |k: usize, centre: Position| {
                    at.get(k).map_or(0, |x| x.to_bits().wrapping_sub(centre.to_bits()) << FINER)
                };
                plane_hypot([of(p, centre[0]), of(q, centre[1])])
            };
            // Rounded to the LSB of a position; smaller parts do not count.
            let radius = Position::from_bits(radius(from).max(radius(to)) >> FINER);
            let centre = centre[which];
            // Converts from 2^-59 revolutions; at most one revolution.
            let sweep = Halves::of(self.shape.end_w()).times(Halves::of(arc.turn));
            let size = (sweep.unsigned_abs() << 5).wrapping_sub(u64::from(sweep.unsigned_abs() >= 1 << 59));
            let begin = atan2_turns(a[1], a[0]);
            // The directions of the two extremes of this axis.
            let passes = |direction: u64| {
                let turned = direction.wrapping_sub(begin);
                (if sweep < 0 { turned.wrapping_neg() } else { turned }) <= size
            };
            let up = which as u64 * QUARTER;
            if passes(up) {
                range[1] = range[1].max(centre.saturating_add(radius));
            }
            if passes(up.wrapping_add(2 * QUARTER)) {
                range[0] = range[0].min(centre.saturating_sub(radius));
            }
        }
        range.map(Some)
    }

    /// Checks an axis against its lower and upper limit, on a polynomial that begins at `from`. For each
    /// limit, the result is a coordinate beyond the limit if the axis reaches one, otherwise the start.
    /// Inside the curve, the check halves the curve up to 12 times, and uses the hull of each part. So an
    /// extreme closely below a limit may count as beyond.
    pub fn bent_range(
        &self,
        axis: usize,
        from: &[Position; AXES],
        limits: [Position; 2],
    ) -> [Option<Position>; 2] {
        let start = from.get(axis).copied();
        let (Some(x), Some(bounds)) = (start, &self.bounds) else { return [start; 2] };
        // With the steepest slope of the axis, its range is too wide, but still inside the limits for most
        // curves.
        let slope = bounds.first.get(axis).copied().unwrap_or(0.0);
        let way = to_f32(self.shape.length.to_bits()) * (1.0 / 4096.0) * slope;
        let way = Position::from_bits(way as i64);
        if x.saturating_sub(way) >= limits[0] && x.saturating_add(way) <= limits[1] {
            return [start; 2];
        }
        let Some(offsets) = self.bernstein(axis) else { return [start; 2] };
        let room = limits.map(|limit| (limit.saturating_sub(x).to_bits()) as f64 * LSB_32);
        let at = |offset: f64| Some(x.saturating_add(Position::from_bits((offset * ONE_32) as i64)));
        let low = above(&offsets.map(|offset| -offset), -room[0]).map_or(start, |offset| at(-offset));
        [low, above(&offsets, room[1]).map_or(start, at)]
    }

    /// Bernstein coefficients of the polynomial of one axis, mm, relative to its start.
    fn bernstein(&self, axis: usize) -> Option<[f64; 6]> {
        let Curve::Poly { power, down } = &self.shape.curve else { return None };
        let (power, down, gain) = (power.get(axis)?, *down.get(axis)?, *self.shape.gain.get(axis)?);
        // τ at the end, and the units of both parts: see `poly`.
        let end = self.shape.end_w() as f64 * (1.0 / (1u64 << 62) as f64);
        let unit = f64::from_bits((1023 - 12 - u64::from(down)) << 52);
        let a1 = gain as f64 * (1.0 / (1u64 << 44) as f64) * end;
        let mut factor = unit * end;
        let [a2, a3, a4, a5] = power.map(|c| {
            factor *= end;
            f64::from(c) * factor
        });
        Some([
            0.0,
            0.2 * a1,
            0.4 * a1 + 0.1 * a2,
            0.6 * a1 + 0.3 * a2 + 0.1 * a3,
            0.8 * a1 + 0.6 * a2 + 0.4 * a3 + 0.2 * a4,
            a1 + a2 + a3 + a4 + a5,
        ])
    }
}

/// A coordinate of a polynomial above `most`, if there is one. The polynomial lies inside the hull of its
/// Bernstein coefficients. If the hull exceeds `most`, the function examines both halves, down to a 256th of
/// the curve.
fn above(whole: &[f64; 6], most: f64) -> Option<f64> {
    let most = most + NEAR;
    let mut open: Vec<([f64; 6], u32), { DEPTH as usize + 2 }> = Vec::new();
    open.push((*whole, 0)).ok()?;
    let mut left = SPLITS;
    while let Some((b, depth)) = open.pop() {
        let top = b.iter().fold(b[0], |top, x| if *x > top { *x } else { top });
        if top <= most {
            continue;
        }
        let ends = if b[0] > b[5] { b[0] } else { b[5] };
        if ends > most {
            return Some(ends);
        }
        if depth == DEPTH || left == 0 {
            return Some(top);
        }
        left -= 1;
        for half in halves(&b) {
            open.push((half, depth + 1)).ok()?;
        }
    }
    None
}

/// Both halves of a polynomial (de Casteljau).
fn halves(b: &[f64; 6]) -> [[f64; 6]; 2] {
    let (mut row, mut first, mut last) = (*b, *b, *b);
    for k in 1..6 {
        for i in 0..6 - k {
            row[i] = 0.5 * (row[i] + row[i + 1]);
        }
        first[k] = row[0];
        last[5 - k] = row[5 - k];
    }
    [first, last]
}

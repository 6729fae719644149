//! Computes the lead of a point: how far the point of the control polygon moves sideways from the contour
//! near a transition from a straight run to a curve.
//!
//! Without a lead, the smoothing curves (kernels) spread the rise of the curvature evenly to both sides of
//! the transition. The curve has little room for this, because the deviation of its chords has used the
//! tolerance. The straight run has all of the tolerance. So points of the run move inwards some distance
//! before the transition, and points near the transition move outwards. Most of the rise then lies on the
//! run.
//!
//! The lead of a point is a sum over the turns ahead of it, up to 1.25 kernel widths away. A step of
//! curvature k at a distance of t·c, with the kernel width c, moves the point by k·c²/24·L(t); a positive L
//! moves the point inwards. The lead acts as far as the contour before the point is straight. The same holds
//! in reverse direction, so a path has the same points in both directions. On a constant curvature no point
//! moves. On a free-form surface, which is bent on both sides of a point, points hardly move.
//!
//! Two kinds of curve get no lead. Before a curve with narrow kernels, the tolerance leaves no room on the
//! run either. Before a curve with very short chords, the window of 64 vertices has no room for kernels as
//! wide as on the run. Before a gentle curve, the lead is smaller.
use super::parameters::{Parameters, Tolerance};
use super::window::{VERTICES, Vertex, Window};
use crate::math::float::{max, min};
use crate::math::root::sqrt_f32;

/// L at every quarter of a kernel width from the transition on. L ends with the value 0 and the slope 0. The
/// values come from trials with circles of 64 chords. They give the least time with a path inside 10 µm.
const LEAD: [f32; 6] = [-1.4578, -1.3704, 1.2, 2.6956, 1.2566, 0.0];
const PER_KERNEL: f32 = 4.0;

/// Range of the part ahead with turns and curvature that count, in kernel widths.
const REACH: f32 = 1.25;
/// Range after a vertex in which the contour is compared with the part ahead, in kernel widths.
const BEHIND: f32 = 1.1511;
/// A contour with at least this part of the curvature ahead counts as constant curvature.
const EVEN: f32 = 0.6518;
/// A contour that leaves its tangent by more than this number of tolerances is not straight. The distance is
/// k·c²/24, with the widest kernel.
const BENT: f32 = 0.7729;

/// Largest lead of a point, in tolerances. The path before the transition has to stay inside the tolerance.
const MOST: f32 = 2.3;
/// Kernel widths as parts of the widest kernel: points have a lead from the first on, and the full lead from
/// the second on.
const WIDE: f32 = 0.5;
const FULL: f32 = 0.8;

/// Range over which curvature and chords of a curve ahead are measured, in kernel widths. A point with a lead
/// is at most [`REACH`] before the curve, so the range contains more than one chord of the curve. This range
/// is known. A vertex moves when the kernels up to 1.25 widths ahead are known. Kernels are known when the
/// contour is known one width further.
const SEEN: f32 = 2.0;
/// Bulge k·c²/24 of a curve in tolerances, with the widest kernel. From the first value on, the lead is
/// reduced, and from the second value on it is zero. The kernels of such a curve are much narrower than those
/// on the run.
const NARROW: f32 = 1.15;
const NARROWEST: f32 = 1.45;
/// Room of the window for chords of a curve, in widest kernels. With the first value there is no lead, with
/// the second the full lead. With a lead, the path bends earlier, and more of the contour has to be known. In
/// a smaller window, kernels would become narrower.
const CRAMPED: f32 = 7.0;
const ROOMY: f32 = 8.5;
/// Bulge of a curve, in tolerances, below which the lead is reduced, and the least part of the lead. Such
/// points would be farther away than needed.
const GENTLE: f32 = 0.95;
const LEAST: f32 = 0.8;

/// −L' at a distance in kernel widths.
fn weight(away: f32) -> f32 {
    let at = away * PER_KERNEL;
    let k = at as usize;
    let value = |k: usize| LEAD.get(k).copied().unwrap_or(0.0);
    let slope = |k: usize| match k {
        0 => value(1) - value(0),
        1..5 => 0.5 * (value(k + 1) - value(k - 1)),
        _ => 0.0,
    };
    if k >= LEAD.len() - 1 {
        return 0.0;
    }
    let u = at - k as f32;
    let rest = 6.0 * u * (1.0 - u);
    let (first, last) = ((1.0 - u) * (1.0 - 3.0 * u), u * (3.0 * u - 2.0));
    -PER_KERNEL * (rest * (value(k + 1) - value(k)) + first * slope(k) + last * slope(k + 1))
}

/// 0 at `none`, 1 at `all`, linear between, constant outside.
fn ramp(x: f32, none: f32, all: f32) -> f32 {
    min(max((x - none) / (all - none), 0.0), 1.0)
}

/// The weight of a curvature in a mean over `over` mm; the weight falls with the distance.
fn mean(away: f32, over: f32) -> f32 {
    2.0 / over * max(0.0, 1.0 - away / over)
}

/// Position of a vertex relative to another one.
struct Beside {
    /// Distance, mm.
    away: f32,
    /// Weight: the vertex itself counts half.
    part: f32,
    /// Mean distance from its neighbours, mm.
    length: f32,
}

/// The path on one side of a vertex.
#[derive(Clone, Copy)]
struct Side<const AXES: usize> {
    lead: [f32; AXES],
    /// Mean curvatures, 1/mm: of the part ahead, and for the comparison with the other side.
    ahead: [f32; AXES],
    behind: [f32; AXES],
    /// Three sums of squares of the turns over [`SEEN`], with weights that fall with the distance. The first
    /// has no other weight, the second the squares of the mean distances from the neighbours, and the third
    /// the squares of the turns.
    squares: f32,
    lengths: f32,
    fourths: f32,
}

impl<const AXES: usize> Window<AXES> {
    /// Passes each vertex on one side, up to `over` mm away, to `add`, with its relative position.
    #[inline]
    fn beside_of(&self, k: usize, ahead: bool, over: f32, mut add: impl FnMut(&Vertex<AXES>, &Beside)) {
        let mut at = Beside { away: 0.0, part: 0.5, length: 0.0 };
        if ahead {
            let mut vertices = self.from(k).peekable();
            while let Some(vertex) = vertices.next()
                && at.away < over
            {
                let next = vertices.peek().map(|next| next.length);
                at.length = 0.5 * (vertex.length + next.unwrap_or(vertex.length));
                add(vertex, &at);
                (at.part, at.away) = (1.0, at.away + next.unwrap_or(over));
            }
        } else {
            let mut next = self.get(k + 1).map(|next| next.length);
            for vertex in self.before(k + 1) {
                if at.away >= over {
                    break;
                }
                at.length = 0.5 * (vertex.length + next.unwrap_or(vertex.length));
                add(vertex, &at);
                (at.part, at.away) = (1.0, at.away + vertex.length);
                next = Some(vertex.length);
            }
        }
    }

    /// How straight the contour is on one side of a vertex, over the widest kernel: 1 is straight, 0 is not.
    fn straightness(&self, k: usize, ahead: bool, tolerance: f32) -> f32 {
        let over = REACH * self.widest;
        let mut sum = [0.0; AXES];
        self.beside_of(k, ahead, over, |vertex, at| {
            let part = at.part * mean(at.away, over);
            for (sum, turn) in sum.iter_mut().zip(&vertex.turn) {
                *sum += part * turn;
            }
        });
        let beside = self.length(&sum) * self.widest * self.widest * (1.0 / 24.0);
        let rest = max(0.0, 1.0 - beside / max(BENT * tolerance, f32::MIN_POSITIVE));
        rest * rest
    }

    /// The lead that results from the turns on one side of a vertex, and the sums from which the lead is
    /// limited.
    fn side(&self, k: usize, ahead: bool, width: f32) -> Side<AXES> {
        let none = [0.0; AXES];
        let mut side =
            Side { lead: none, ahead: none, behind: none, squares: 0.0, lengths: 0.0, fourths: 0.0 };
        let (per, over) = (1.0 / width, SEEN * width);
        self.beside_of(k, ahead, over, |vertex, at| {
            let lead = at.part * width * (1.0 / 24.0) * weight(at.away * per);
            let [seen, far, near] = [SEEN, REACH, BEHIND].map(|over| at.part * mean(at.away, over * width));
            let sums = side.lead.iter_mut().zip(&mut side.ahead).zip(&mut side.behind);
            let mut square = 0.0;
            for (axis, (((sum, ahead), behind), turn)) in sums.zip(&vertex.turn).enumerate() {
                *sum += lead * turn;
                *ahead += far * turn;
                *behind += near * turn;
                square += if self.is_main(axis) { turn * turn } else { 0.0 };
            }
            side.squares += seen * square;
            side.lengths += seen * square * at.length * at.length;
            side.fourths += seen * square * square;
        });
        side
    }

    /// The share of the lead that a curve permits.
    fn share(&self, side: &Side<AXES>, path: f32) -> f32 {
        // On a circle, a point turns by the curvature times the mean length of its two chords.
        let curvature = sqrt_f32(side.fourths / max(side.lengths, f32::MIN_POSITIVE));
        let chord = sqrt_f32(side.lengths / max(side.squares, f32::MIN_POSITIVE));
        let deviation = curvature * self.widest * self.widest * (1.0 / 24.0) / max(path, f32::MIN_POSITIVE);
        let kernels = chord * VERTICES as f32 / max(self.widest, f32::MIN_POSITIVE);
        let gentle = max(LEAST, min(1.0, deviation / GENTLE));
        let most = min(1.0, MOST * path / max(self.length(&side.lead), f32::MIN_POSITIVE));
        gentle * most * ramp(deviation, NARROWEST, NARROW) * ramp(kernels, CRAMPED, ROOMY)
    }

    /// The lead of a vertex's point, mm, towards the inside of the curve that follows.
    #[inline(never)]
    pub fn lead(&self, k: usize, parameters: &Parameters) -> [f32; AXES] {
        let mut lead = [0.0; AXES];
        let Some(vertex) = self.get(k) else { return lead };
        let wide = ramp(vertex.width / max(self.widest, f32::MIN_POSITIVE), WIDE, FULL);
        if wide <= 0.0 {
            return lead;
        }
        let Tolerance { path, .. } = self.tolerance(k, parameters);
        let straight = [true, false].map(|ahead| self.straightness(k, ahead, path));
        if straight == [0.0; 2] {
            return lead;
        }
        let sides = [true, false].map(|ahead| self.side(k, ahead, vertex.width));
        for (k, straight) in straight.into_iter().enumerate() {
            let [Some(own), Some(other)] = [sides.get(1 - k), sides.get(k)] else { continue };
            let (ahead, behind) = (self.length(&own.ahead), self.length(&other.behind));
            if straight <= 0.0 || ahead <= 0.0 {
                continue;
            }
            let rest = max(1.0 - behind / (EVEN * ahead), 0.0);
            let part = straight * rest * rest * wide * self.share(own, path);
            for (lead, own) in lead.iter_mut().zip(&own.lead) {
                *lead += part * own;
            }
        }
        lead
    }
}

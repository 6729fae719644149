//! The path before a curve: where a straight run changes into an even turn, points of the control polygon
//! lead.
//!
//! Kernels distribute the ramp of curvature evenly on both sides of such a transition: inside the curve, and
//! outside of the straight run before. Beside a curve there is little room, because its chords have used the
//! tolerance. Beside the straight run all of the tolerance is free. So points of the run move inwards some distance
//! before the transition, points near the transition move outwards, and most of the ramp lies on the run.
//!
//! The shift of a point is a sum over the turns ahead, within 1.25 kernels. A step of curvature k at a distance of t
//! kernels moves the point by k·c²/24·L(t): inwards where L is positive. The shift counts as far as the contour on
//! the other side is straight, compared with the part ahead and with its tolerance. The same holds in reverse, so a
//! path has the same points in both directions. In an even curvature no point moves; on a free-form surface, which is
//! bent on both sides, nearly none.
//!
//! The shift fades out where it gains nothing: before a curve with narrow kernels, because then the tolerance leaves no
//! room beside the run either; and before one with chords so short that the window has no room for kernels as wide as
//! on the run. Before a gentle curve the shift is smaller.
use super::parameters::{Parameters, Tolerance};
use super::window::{VERTICES, Vertex, Window};
use crate::math::float::{max, min};
use crate::math::root::sqrt_f32;

/// L at every quarter of a kernel from the transition on. L ends with 0 and slope 0. Found by trials with circles of
/// 64 chords, for the least time with a path inside 10 µm.
const LEAD: [f32; 6] = [-1.4578, -1.3704, 1.2, 2.6956, 1.2566, 0.0];
const PER_KERNEL: f32 = 4.0;

/// Range of the part ahead that counts, with its turns and its curvature, in kernels.
const REACH: f32 = 1.25;
/// Range behind a vertex in which the contour is compared with the part ahead, in kernels.
const BEHIND: f32 = 1.1511;
/// A contour with at least this part of the curvature ahead counts as equally even.
const EVEN: f32 = 0.6518;
/// A contour this many tolerances beside its tangent (k·c²/24, with the widest kernel) is not straight.
const BENT: f32 = 0.7729;

/// Largest lead of a point, in tolerances: the path before the transition has to stay inside them.
const MOST: f32 = 2.3;
/// Parts of the widest kernel: from the first on points lead, from the second on by the full amount.
const WIDE: f32 = 0.5;
const FULL: f32 = 0.8;

/// Range over which curvature and chords of a curve ahead are measured, in kernels. Points that lead, up to [`REACH`]
/// before the curve, have more than one chord of it there. This part is known: a vertex moves when kernels are known
/// 1.25 kernels behind it, and kernels are known when the contour is known one kernel further.
const SEEN: f32 = 2.0;
/// Numbers of tolerances (k·c²/24, with the widest kernel) of a curve: from the first on points lead less, from the
/// second on not at all, because its kernels are much narrower than those on the run.
const NARROW: f32 = 1.15;
const NARROWEST: f32 = 1.45;
/// The window's room for chords of a curve, in widest kernels: with the first number no point leads, with the second
/// all do. Where points lead, the path bends earlier, and more has to be known: with less room kernels would get
/// narrower.
const CRAMPED: f32 = 7.0;
const ROOMY: f32 = 8.5;
/// Number of tolerances of a curve below which points lead less, because they are further away than needed; and the
/// least part of the lead.
const GENTLE: f32 = 0.95;
const LEAST: f32 = 0.8;

/// −L' at a distance, in kernels.
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

/// 0 at one value, 1 at another one, linear between, constant beyond.
fn ramp(x: f32, none: f32, all: f32) -> f32 {
    min(max((x - none) / (all - none), 0.0), 1.0)
}

/// The weight of a curvature in a mean over `over` mm, falling with the distance.
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
    /// Mean curvatures, per mm: for the part ahead, and for the comparison.
    ahead: [f32; AXES],
    behind: [f32; AXES],
    /// Sums of squares of the turns over [`SEEN`], falling with the distance: unweighted, weighted by the squares of
    /// the mean distances from the neighbours, and by the squares of the turns.
    squares: f32,
    lengths: f32,
    fourths: f32,
}

impl<const AXES: usize> Window<AXES> {
    /// The vertices on one side of a vertex, up to `over` mm, each with its relative position.
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

    /// How straight the contour is on one side of a vertex, over the widest kernel: 1 to 0.
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

    /// The lead that the turns on one side of a vertex demand.
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

    /// The part of the lead before a curve.
    fn share(&self, side: &Side<AXES>, path: f32) -> f32 {
        // A circle of any chords turns at each point by its curvature times the mean length beside the point.
        let curvature = sqrt_f32(side.fourths / max(side.lengths, f32::MIN_POSITIVE));
        let chord = sqrt_f32(side.lengths / max(side.squares, f32::MIN_POSITIVE));
        let deviation = curvature * self.widest * self.widest * (1.0 / 24.0) / max(path, f32::MIN_POSITIVE);
        let kernels = chord * VERTICES as f32 / max(self.widest, f32::MIN_POSITIVE);
        let gentle = max(LEAST, min(1.0, deviation / GENTLE));
        let most = min(1.0, MOST * path / max(self.length(&side.lead), f32::MIN_POSITIVE));
        gentle * most * ramp(deviation, NARROWEST, NARROW) * ramp(kernels, CRAMPED, ROOMY)
    }

    /// The lead of a vertex's point, mm, towards the inside of the following curve.
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

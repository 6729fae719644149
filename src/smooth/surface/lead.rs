//! What lies before a curve: where a straight run goes over into an even turn, points of the control polygon lead.
//!
//! Kernels lay the ramp of curvature evenly on both sides of such a joint: as far inside the curve as outside the
//! run before it. Beside a curve there is little room, since its chords have used the tolerance; beside the
//! straight run there is all of it. So points of the run go inwards some way before the joint, those near the joint
//! go outwards, and most of the ramp lies on the run.
//!
//! How far is a sum over the turns ahead, within 1.25 kernels, weighted so that a step of curvature k at a distance
//! of t kernels moves the point by k·c²/24·L(t): inwards where L is positive. It counts as far as the contour is
//! straight on the other side: in comparison with what is ahead, and beside its tolerance. The same holds the
//! other way round, so a path has the same points in both directions. Where curvature is even nothing moves, and on a
//! free-form surface, which is bent on both sides, next to nothing.
use super::parameters::{Parameters, Tolerance};
use super::window::{Vertex, Window};
use crate::math::float::{max, min};

/// L at every quarter of a kernel from the joint on. It ends with 0, and without a slope. Found by trials with circles
/// of 64 chords, for the least time with which their path stays within 10 µm.
const LEAD: [f32; 6] = [-1.4578, -1.3704, 1.2, 2.6956, 1.2566, 0.0];
const PER_KERNEL: f32 = 4.0;

/// Of a kernel: how far what is ahead counts, with its turns and its curvature.
const REACH: f32 = 1.25;
/// Of a kernel: how far behind a vertex the contour is compared with what is ahead.
const BEHIND: f32 = 1.1511;
/// A contour with this part of the curvature ahead, or more, is as even as that.
const EVEN: f32 = 0.6518;
/// So many tolerances (k·c²/24, with the widest kernel) beside its tangent a contour is not straight.
const BENT: f32 = 0.7729;

/// No point leads by more tolerances than that: what is before the joint is to stay inside them.
const MOST: f32 = 2.3;
/// Parts of the widest kernel from which on points lead, and lead as far as they are to.
const WIDE: f32 = 0.5;
const FULL: f32 = 0.8;

/// So many tolerances (k·c²/24, with the widest kernel) of a curve from which on points lead less, and not at all: its
/// kernels are much narrower than those on the run.
const NARROW: f32 = 1.5;
const NARROWEST: f32 = 1.75;

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

/// The weights of a mean curvature over so many mm, falling with the distance.
fn mean(away: f32, over: f32) -> f32 {
    2.0 / over * max(0.0, 1.0 - away / over)
}

/// What is on one side of a vertex.
#[derive(Clone, Copy)]
struct Side<const AXES: usize> {
    lead: [f32; AXES],
    /// Turn of all.
    turn: [f32; AXES],
    /// Mean curvatures, per mm: ahead of the other side, and behind it.
    ahead: [f32; AXES],
    behind: [f32; AXES],
}

impl<const AXES: usize> Window<AXES> {
    /// The vertices on one side of a vertex, itself by half, with their distances: up to `over` mm.
    #[inline(always)]
    fn beside_of(&self, k: usize, ahead: bool, over: f32, mut add: impl FnMut(&Vertex<AXES>, f32, f32)) {
        let (mut away, mut part) = (0.0, 0.5);
        if ahead {
            let mut vertices = self.from(k).peekable();
            while let Some(vertex) = vertices.next()
                && away < over
            {
                add(vertex, away, part);
                part = 1.0;
                away += vertices.peek().map_or(over, |next| next.length);
            }
        } else {
            for vertex in self.before(k + 1) {
                if away >= over {
                    break;
                }
                add(vertex, away, part);
                part = 1.0;
                away += vertex.length;
            }
        }
    }

    /// How straight the contour is on one side of a vertex, over the widest kernel: 1 to 0.
    fn straightness(&self, k: usize, ahead: bool, tolerance: f32) -> f32 {
        let over = REACH * self.widest;
        let mut sum = [0.0; AXES];
        self.beside_of(k, ahead, over, |vertex, away, part| {
            let part = part * mean(away, over);
            for (sum, turn) in sum.iter_mut().zip(&vertex.turn) {
                *sum += part * turn;
            }
        });
        let beside = self.length(&sum) * self.widest * self.widest * (1.0 / 24.0);
        let rest = max(0.0, 1.0 - beside / max(BENT * tolerance, f32::MIN_POSITIVE));
        rest * rest
    }

    /// What the turns on one side of a vertex ask for.
    fn side(&self, k: usize, ahead: bool, width: f32) -> Side<AXES> {
        let none = [0.0; AXES];
        let mut side = Side { lead: none, turn: none, ahead: none, behind: none };
        let per = 1.0 / width;
        self.beside_of(k, ahead, REACH * width, |vertex, away, part| {
            let lead = part * width * (1.0 / 24.0) * weight(away * per);
            let (far, near) = (part * mean(away, REACH * width), part * mean(away, BEHIND * width));
            let sums = side.lead.iter_mut().zip(&mut side.turn).zip(&mut side.ahead).zip(&mut side.behind);
            for ((((sum, whole), ahead), behind), turn) in sums.zip(&vertex.turn) {
                *sum += lead * turn;
                *whole += part * turn;
                *ahead += far * turn;
                *behind += near * turn;
            }
        });
        side
    }

    /// The curvature of a curve that begins somewhere on one side, as even as it may be, per mm: k over a length l of
    /// it turns by k·l, and its mean is k·l²/over².
    fn curvature(&self, side: &Side<AXES>, over: f32) -> f32 {
        let turn = self.length(&side.turn);
        turn * turn / max(over * over * self.length(&side.ahead), f32::MIN_POSITIVE)
    }

    /// How far the point of a vertex leads, mm: towards the inside of the curve it lies before.
    #[inline(never)]
    pub fn lead(&self, k: usize, parameters: &Parameters) -> [f32; AXES] {
        let mut lead = [0.0; AXES];
        let Some(vertex) = self.get(k).filter(|vertex| vertex.width > 0.0) else { return lead };
        let Tolerance { path, .. } = self.tolerance(k, parameters);
        let straight = [true, false].map(|ahead| self.straightness(k, ahead, path));
        if straight == [0.0; 2] {
            return lead;
        }
        let part = vertex.width / max(self.widest, f32::MIN_POSITIVE);
        let wide = min(max((part - WIDE) / (FULL - WIDE), 0.0), 1.0);
        let sides = [true, false].map(|ahead| self.side(k, ahead, vertex.width));
        for (k, straight) in straight.into_iter().enumerate() {
            let [Some(own), Some(other)] = [sides.get(1 - k), sides.get(k)] else { continue };
            let (ahead, behind) = (self.length(&own.ahead), self.length(&other.behind));
            if straight <= 0.0 || ahead <= 0.0 {
                continue;
            }
            let rest = max(1.0 - behind / (EVEN * ahead), 0.0);
            let deviation =
                self.curvature(own, REACH * vertex.width) * self.widest * self.widest * (1.0 / 24.0);
            let narrow = (NARROWEST - deviation / max(path, f32::MIN_POSITIVE)) / (NARROWEST - NARROW);
            let most = min(1.0, MOST * path / max(self.length(&own.lead), f32::MIN_POSITIVE));
            let part = straight * rest * rest * most * wide * min(max(narrow, 0.0), 1.0);
            for (lead, own) in lead.iter_mut().zip(&own.lead) {
                *lead += part * own;
            }
        }
        lead
    }
}

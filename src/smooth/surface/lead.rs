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
//!
//! It fades out where it would gain nothing: before a curve whose kernels are narrow, since the tolerance leaves no room
//! beside the run either, and before one of so short chords that the window has no room for kernels as wide as those on
//! the run. Before a gentle curve it is less.
use super::parameters::{Parameters, Tolerance};
use super::window::{VERTICES, Vertex, Window};
use crate::math::float::{max, min};
use crate::math::root::sqrt_f32;

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

/// Of a kernel: over so much the curvature and the chords of a curve ahead are measured. Points that lead, up to
/// [`REACH`] before it, have more than one of its chords there. It is known: a vertex is moved when kernels are known
/// 1.25 kernels behind it, and those when a contour is known one more.
const SEEN: f32 = 2.0;
/// So many tolerances (k·c²/24, with the widest kernel) of a curve from which on points lead less, and not at all: its
/// kernels are much narrower than those on the run.
const NARROW: f32 = 1.15;
const NARROWEST: f32 = 1.45;
/// The window has room for so many of the widest kernel in chords of a curve: no point leads, and all do. Where points
/// lead the path bends earlier, and more has to be known: with less room kernels become narrower.
const CRAMPED: f32 = 7.0;
const ROOMY: f32 = 8.5;
/// So many tolerances of a curve below which points lead less, as it is further from them than it has to be, and the
/// part that they lead by at least.
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

/// 0 at one value, 1 at another one, even between, and constant beyond.
fn ramp(x: f32, none: f32, all: f32) -> f32 {
    min(max((x - none) / (all - none), 0.0), 1.0)
}

/// The weights of a mean curvature over so many mm, falling with the distance.
fn mean(away: f32, over: f32) -> f32 {
    2.0 / over * max(0.0, 1.0 - away / over)
}

/// Where a vertex is beside another one.
struct Beside {
    /// Distance, mm.
    away: f32,
    /// How much it counts: the vertex itself by half.
    part: f32,
    /// Mean distance from its neighbours, mm.
    length: f32,
}

/// What is on one side of a vertex.
#[derive(Clone, Copy)]
struct Side<const AXES: usize> {
    lead: [f32; AXES],
    /// Mean curvatures, per mm: ahead of the other side, and behind it.
    ahead: [f32; AXES],
    behind: [f32; AXES],
    /// Sums of the squares of the turns over [`SEEN`], less with the distance: of these alone, by the squares of the
    /// mean distances from the neighbours, and by the squares of the turns.
    squares: f32,
    lengths: f32,
    fourths: f32,
}

impl<const AXES: usize> Window<AXES> {
    /// The vertices on one side of a vertex, up to `over` mm, each with where it is.
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

    /// What the turns on one side of a vertex ask for.
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

    /// The part that points lead by before a curve.
    fn share(&self, side: &Side<AXES>, path: f32) -> f32 {
        // A circle of any chords turns at each point by its curvature times the mean length beside it.
        let curvature = sqrt_f32(side.fourths / max(side.lengths, f32::MIN_POSITIVE));
        let chord = sqrt_f32(side.lengths / max(side.squares, f32::MIN_POSITIVE));
        let deviation = curvature * self.widest * self.widest * (1.0 / 24.0) / max(path, f32::MIN_POSITIVE);
        let kernels = chord * VERTICES as f32 / max(self.widest, f32::MIN_POSITIVE);
        let gentle = max(LEAST, min(1.0, deviation / GENTLE));
        let most = min(1.0, MOST * path / max(self.length(&side.lead), f32::MIN_POSITIVE));
        gentle * most * ramp(deviation, NARROWEST, NARROW) * ramp(kernels, CRAMPED, ROOMY)
    }

    /// Distance by which the point of a vertex leads, mm. The point lies towards the inside of the curve that follows.
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

//! Computes points of Surface's smoothed path Q. Q is the control polygon P plus one smoothing curve (kernel)
//! at each vertex of the polygon.
//!
//! Let s be the length along the polygon. Vertex i is at s_i, the direction changes there by d_i, and c_i is
//! half the width of its kernel. With u = 1 − |s − s_i|/c_i,
//!
//! ```text
//! Q = P + Σ d_i·c_i·u³/6      Q' = P' ± Σ d_i·u²/2      Q'' = Σ d_i·u/c_i
//! ```
//!
//! The sum is over all vertices that are nearer than c_i. Q is twice continuously differentiable for any
//! widths.
//!
//! The path distance of an element is the length s. |Q'| is at most 1, because the path is shorter than the
//! polygon, so the speed does not exceed the feed.
use super::window::{SLOWEST, Vertex, Window, step};
use crate::math::float::{max, min, to_i64};
use crate::math::wide::mul_shift;
use crate::path::poly::Knot;
use crate::path::{End, Measure, straight};
use crate::quantity::Position;

/// A place on the control polygon: a vertex, and a distance (mm) after this vertex.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spot {
    pub vertex: usize,
    pub x: f32,
}

/// Part of a kernel's width that an element covers.
const CELL: f32 = 0.9;
/// An element that ends where a kernel ends has at least this part of its normal length.
const SLIVER: f32 = 0.1;
/// An element ends at least this part of the widest kernel before the end of the checked path. Nearer to that
/// end, points may still move when a kernel is reduced, and the element between old and new points would turn
/// sharply.
const SETTLED: f32 = 0.5;
/// Longest element, mm.
const LONGEST: f32 = 8.0;
/// Shortest line, mm.
const LINE: f32 = 1.0;
/// Shorter distances count as none, mm.
const NOTHING: f32 = 1e-6;

/// An element has a constant speed if its distance to a step of curvature is below this part of the kernel's
/// width.
const NEAR_STEP: f32 = 0.4652;

/// Margin for rounding of a place at the end of a kernel.
#[cfg(feature = "kinematics")]
const WITHIN: f32 = 1.01;

const ONE_40: f32 = (1u64 << 40) as f32;
const ONE_32: f32 = (1u64 << 32) as f32;

/// The length of the next element of a Surface curve, and whether this element is straight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aim {
    /// Length of the element, measured from the last knot along the control polygon, mm.
    pub way: f32,
    /// Whether the path is straight up to this distance.
    pub is_straight: bool,
}

/// The path ahead of a place.
struct Ahead {
    /// Whether a kernel acts at the place.
    active: bool,
    /// Distance to the start of the first kernel ahead.
    start: f32,
    /// Distance to the first place where an element has to end, because of a strong turn or a change in the
    /// program.
    strong: f32,
    forced: f32,
}

fn positive(x: f32) -> i64 {
    to_i64(x * ONE_32)
}

impl<const AXES: usize> Window<AXES> {
    /// Distance along the control polygon from a place to a later vertex.
    pub fn to_vertex(&self, spot: &Spot, vertex: usize) -> f32 {
        let mut way = -spot.x;
        for k in spot.vertex + 1..=vertex {
            way += self.get(k).map_or(0.0, |vertex| vertex.moved_length);
        }
        way
    }

    /// Distance along the control polygon from a vertex to a later place.
    pub fn since(&self, spot: &Spot, vertex: usize) -> f32 {
        let mut way = spot.x;
        for k in vertex + 1..=spot.vertex {
            way += self.get(k).map_or(0.0, |vertex| vertex.moved_length);
        }
        way
    }

    /// Distance along the control polygon from one place to a later one.
    pub fn way(&self, from: &Spot, to: &Spot) -> f32 {
        if from.vertex == to.vertex { to.x - from.x } else { self.to_vertex(from, to.vertex) + to.x }
    }

    /// The place at the distance `way` (mm) after a place.
    pub fn advance(&self, spot: &Spot, way: f32) -> Spot {
        let Spot { mut vertex, mut x } = *spot;
        x += way;
        while let Some(next) = self.get(vertex + 1)
            && vertex + 1 < self.moved
            && x >= next.moved_length - NOTHING
        {
            x = max(x - next.moved_length, 0.0);
            vertex += 1;
            if x < NOTHING {
                x = 0.0;
            }
        }
        Spot { vertex, x }
    }

    /// Finds what lies ahead of a place. Ends of elements nearer than `least` (mm) do not count.
    fn look_ahead(&self, spot: &Spot, least: f32) -> Ahead {
        let mut ahead = Ahead { active: false, start: f32::MAX, strong: f32::MAX, forced: f32::MAX };
        let note = |place: &mut f32, at: f32| {
            if at > least {
                *place = min(*place, at);
            }
        };
        let mut away = spot.x;
        for vertex in self.before(spot.vertex + 1) {
            if away >= self.widest {
                break;
            }
            if vertex.is(Vertex::<AXES>::TURNS) && vertex.width > away + NOTHING {
                ahead.active = true;
                if vertex.is(Vertex::<AXES>::STRONG) {
                    note(&mut ahead.strong, vertex.width - away);
                }
            }
            away += vertex.moved_length;
        }
        away = -spot.x;
        let first = spot.vertex + 1;
        for (k, vertex) in (first..self.moved).zip(self.from(first)) {
            away += vertex.moved_length;
            let last = self.ended && k + 1 == self.len();
            if vertex.is(Vertex::<AXES>::TURNS) && !last {
                ahead.start = min(ahead.start, away - vertex.width);
                if vertex.is(Vertex::<AXES>::STRONG) {
                    note(&mut ahead.strong, away - vertex.width);
                    note(&mut ahead.strong, away);
                    note(&mut ahead.strong, away + vertex.width);
                }
            }
            if vertex.is(Vertex::<AXES>::FORCED) || last {
                note(&mut ahead.forced, away);
                break;
            }
        }
        ahead.active |= ahead.start <= NOTHING;
        ahead
    }

    /// The sharp turn at a place, or the next sharp turn whose kernel ends before the neighbours of its
    /// vertex. Also returns the distance to the start of the turn.
    pub fn sharp(&self, spot: &Spot) -> Option<(&Vertex<AXES>, f32)> {
        let mut away = -spot.x;
        let mut vertices = self.from(spot.vertex).take(self.moved.saturating_sub(spot.vertex)).peekable();
        while let (Some(vertex), Some(next)) = (vertices.next(), vertices.peek()) {
            let alone = vertex.width <= vertex.moved_length && vertex.width <= next.moved_length;
            if alone && vertex.is(Vertex::<AXES>::STRONG) && away + vertex.width > NOTHING {
                return Some((vertex, max(away - vertex.width, 0.0)));
            }
            away += next.moved_length;
        }
        None
    }

    /// Whether an element of `length` (mm) lies inside the kernel of a corner that no other kernel reaches. The
    /// motion passes this corner at one speed, and the speed changes along the lines.
    #[cfg(feature = "kinematics")]
    pub fn is_in_corner(&self, spot: &Spot, length: f32) -> bool {
        let mut corners = (0..self.moved.saturating_sub(1)).filter_map(|k| {
            let (vertex, next) = (self.get(k)?, self.get(k + 1)?);
            let room = min(vertex.moved_length, next.moved_length);
            let from = if k <= spot.vertex { self.since(spot, k) } else { -self.to_vertex(spot, k) };
            let most = WITHIN * vertex.width;
            let inside = vertex.is(Vertex::<AXES>::STRONG) && from >= -most && from + length <= most;
            inside.then_some(vertex.width <= room)
        });
        corners.next().unwrap_or(false)
    }

    /// Whether an element lies inside the kernel of a corner; never without transformations.
    #[cfg(not(feature = "kinematics"))]
    #[inline(always)]
    pub const fn is_in_corner(&self, _: &Spot, _: f32) -> bool {
        false
    }

    /// Whether an element of `length` (mm) comes near a step of curvature. Near a step, the curvature uses
    /// most of the permitted jerk, and little jerk is left to change the speed.
    pub fn is_near_step(&self, spot: &Spot, length: f32) -> bool {
        let near = |vertex: &Vertex<AXES>, away: f32| {
            vertex.is(Vertex::<AXES>::STEPS) && away < NEAR_STEP * vertex.width - NOTHING
        };
        let mut away = spot.x;
        for vertex in self.before(spot.vertex + 1) {
            if away >= self.widest {
                break;
            }
            if near(vertex, away) {
                return true;
            }
            away += vertex.moved_length;
        }
        away = -spot.x - length;
        for vertex in self.from(spot.vertex + 1).take(self.moved.saturating_sub(spot.vertex + 1)) {
            away += vertex.moved_length;
            if away >= self.widest {
                break;
            }
            if near(vertex, away) {
                return true;
            }
        }
        false
    }

    /// Length of the next element; `None` if more vertices must be known first.
    pub fn aim(&self, spot: &Spot) -> Option<Aim> {
        let all = self.ended && self.checked == self.len();
        let last = self.checked.checked_sub(1)?;
        // After the checked vertices, the kernels are known up to their reach.
        let known = if all { f32::MAX } else { self.to_vertex(spot, last) + self.reach };
        if known < 0.0 || last < spot.vertex && !all {
            return None;
        }
        let (from, to) = (self.get(spot.vertex)?, self.get(spot.vertex + 1)?);
        let part = min(spot.x / max(to.moved_length, f32::MIN_POSITIVE), 1.0);
        let width = max(from.width + (to.width - from.width) * part, max(0.5 * from.width, 0.5 * to.width));
        let mut way = min(CELL * max(width, 4.0 * NOTHING), LONGEST);
        let least = SLIVER * way;
        let ahead = self.look_ahead(spot, least);
        let mut near = min(ahead.forced, ahead.strong);
        if ahead.forced < near + least {
            near = ahead.forced;
        }
        if !ahead.active {
            let way = min(ahead.forced, min(ahead.start, known - self.reach));
            if way >= LINE || way > NOTHING && way == ahead.forced {
                return Some(Aim { way, is_straight: way >= LINE });
            }
            if !all && known < 1.5 * self.reach {
                return None;
            }
            if ahead.start < LINE && ahead.start > max(least, NOTHING) {
                return Some(Aim { way: ahead.start, is_straight: false });
            }
        }
        let settled = if self.is_full() { 0.0 } else { SETTLED * self.reach };
        if !all && known < way + self.reach + settled {
            return None;
        }
        if near < 4.0 * way {
            // The element is divided into equal parts.
            let parts = 1.0 + (near / (1.1 * way)) as i32 as f32;
            way = if near <= 1.1 * way { near } else { near / parts };
        }
        Some(Aim { way: min(way, ahead.forced), is_straight: false })
    }

    /// The point of the path at a place.
    pub fn knot(&self, spot: &Spot, measure: &Measure) -> Option<Knot<AXES>> {
        let from = self.get(spot.vertex)?;
        let Some(to) = self.get(spot.vertex + 1).filter(|_| spot.vertex + 1 < self.moved) else {
            return self.end(spot.vertex, measure);
        };
        let length = to.moved_length;
        let per = 1.0 / max(length, f32::MIN_POSITIVE);
        let heading = step(from, &to.at, &to.offset).map(|x| x * per);
        let rest = length - spot.x;
        let mut off = [0.0; AXES];
        let mut direction = heading;
        let mut bend = [0.0; AXES];
        let mut count = 0;
        let mut add = |vertex: &Vertex<AXES>, away: f32, behind: bool| {
            if away >= vertex.width || !vertex.is(Vertex::<AXES>::TURNS) {
                return;
            }
            count += 1;
            let inverse = 1.0 / vertex.width;
            let u = 1.0 - away * inverse;
            let half = 0.5 * u * u;
            let (g, t, k) =
                (vertex.width * u * half * (1.0 / 3.0), if behind { -half } else { half }, u * inverse);
            let sums = off.iter_mut().zip(&mut direction).zip(&mut bend);
            for (((off, direction), bend), turn) in sums.zip(&vertex.moved_turn) {
                *off += turn * g;
                *direction += turn * t;
                *bend += turn * k;
            }
        };
        let mut away = spot.x;
        for vertex in self.before(spot.vertex + 1) {
            if away >= self.widest {
                break;
            }
            add(vertex, away, true);
            away += vertex.moved_length;
        }
        away = rest;
        let first = spot.vertex + 1;
        let mut ahead = self.from(first).take(self.moved.saturating_sub(first)).peekable();
        // The last moved vertex has no turn yet.
        while let (Some(vertex), Some(next)) = (ahead.next(), ahead.peek()) {
            if away >= self.widest {
                break;
            }
            add(vertex, away, false);
            away += next.moved_length;
        }
        if count == 0 && from.is_on_contour() && to.is_on_contour() {
            return on_chord((from, to), (spot.x, rest), measure);
        }
        // Counted from the nearer vertex.
        let (near, way) = if spot.x <= rest { (from, spot.x) } else { (to, -rest) };
        let mut position = near.at;
        for (((x, offset), heading), off) in position.iter_mut().zip(&near.offset).zip(&heading).zip(&off) {
            let d = offset + heading * way + off;
            *x = Position::from_bits(x.to_bits().wrapping_add(signed(d)));
        }
        self.knot_of(position, &direction, &bend)
    }

    /// The point with its derivatives over the polygon's length. The path is never longer than the polygon.
    fn knot_of(
        &self,
        position: [Position; AXES],
        direction: &[f32; AXES],
        bend: &[f32; AXES],
    ) -> Option<Knot<AXES>> {
        if self.length(direction) < SLOWEST * 0.8 {
            return None;
        }
        let tangent = direction.map(|x| to_i64(x * ONE_40));
        Some(Knot { position, end: End { tangent, curvature: *bend } })
    }

    /// The point of the last vertex.
    fn end(&self, k: usize, measure: &Measure) -> Option<Knot<AXES>> {
        let (from, to) = (self.get(k.checked_sub(1)?)?, self.get(k)?);
        if from.is_on_contour() {
            return on_chord((from, to), (to.moved_length, 0.0), measure);
        }
        let (d, length) = self.chord(k)?;
        let per = 1.0 / max(length, f32::MIN_POSITIVE);
        self.knot_of(to.at, &d.map(|x| x * per), &[0.0; AXES])
    }
}

fn signed(x: f32) -> i64 {
    if x < 0.0 { -positive(-x) } else { positive(x) }
}

/// A point on a programmed chord that no kernel reaches: exact to the last bit.
fn on_chord<const AXES: usize>(
    (from, to): (&Vertex<AXES>, &Vertex<AXES>),
    (x, rest): (f32, f32),
    measure: &Measure,
) -> Option<Knot<AXES>> {
    let tangent = *straight(&from.at, &to.at, measure).ok()??.tangent();
    let (near, way) = if x <= rest { (from, positive(x)) } else { (to, -positive(rest)) };
    let mut position = near.at;
    for (x, tangent) in position.iter_mut().zip(&tangent) {
        *x = Position::from_bits(x.to_bits().wrapping_add(mul_shift(*tangent, way, 40)));
    }
    Some(Knot { position, end: End { tangent, curvature: [0.0; AXES] } })
}

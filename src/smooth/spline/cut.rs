//! A piece of a curve, a cubic over a parameter u = 0…1, becomes elements over their own arc length.
//!
//! An element is a polynomial of the fifth degree that has position, direction and curvature of the cubic at
//! both its ends. It is taken where its path speed is right to [`EVEN`] and where it is no farther beside the
//! cubic than [`NEAR`] says; else it is tried half as long.
use crate::math::float::max;
use crate::path::poly::{Draft, Knot};
use crate::path::{Element, End};
use crate::quantity::Position;
use crate::smooth::contour::corner_curve::{EVEN, HEAVIEST, fastest, knot_of, site_of};
use crate::smooth::contour::curve::{Main, Quintic, Site, plus, size};

/// An element is so near to its curve, mm, and so near relative to its size where that is more: what `f32` can
/// tell.
const NEAR: f32 = 1e-4;
const NEAR_PART: f32 = 1.0 / 1_048_576.0;
/// Distance from a point within which the curvature of a curve is made continuous, mm.
pub const BENT: f32 = 1e-3;

/// Steps of a piece at which it may be cut.
const STEPS: u16 = 512;

/// Elements are not cut shorter, mm.
const SHORTEST: f32 = 2.5e-4;

/// A cubic whose speed at an end is below this part of its size has no direction there.
const LEAST_SPEED: f32 = 1.0 / 1024.0;

/// How the curve continues at an end of a piece.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Joint<const AXES: usize> {
    /// With the direction and the curvature that the piece before had; with those of the piece itself.
    Smooth,
    /// With that curvature, along so much of the piece.
    Bent([f32; AXES], f32),
    /// With the direction that the piece before had and another curvature.
    Tangent,
    /// In another direction.
    Corner,
}

/// A piece that is cut into elements.
#[derive(Clone, Copy, Debug)]
pub struct Piece<const AXES: usize> {
    curve: Quintic<AXES>,
    /// Its coordinates are from here.
    origin: [Position; AXES],
    /// Where the next element begins.
    here: Knot<AXES>,
    /// Where the last one ends.
    end: Knot<AXES>,
    /// Steps done, and steps that are tried.
    done: u16,
    step: u16,
    /// Steps of the first and the last element at most.
    edges: [u16; 2],
    /// mm.
    near: f32,
}

/// The result of a cut.
#[derive(Clone, Copy, Debug)]
pub enum Cut<const AXES: usize> {
    /// A shorter element has to be tried.
    Again,
    /// An element, with its axes to be made, and whether it is the last one.
    Element(Element<AXES>, Draft<AXES>, bool),
    /// A straight line to there, in place of what has no format, and whether it is the last one.
    Straight([Position; AXES], bool),
}

impl<const AXES: usize> Piece<AXES> {
    /// The cubic of these points of Bézier, from `origin`. It begins at `from`, whose direction and curvature
    /// count as `joints` says, and ends at the position `to`.
    pub fn new(
        axes: &Main,
        bezier: &[[f32; AXES]; 4],
        origin: &[Position; AXES],
        (from, to): (&Knot<AXES>, &[Position; AXES]),
        joints: &[Joint<AXES>; 2],
    ) -> Self {
        let curve = Quintic::cubic(bezier);
        let extent =
            bezier.iter().fold(0.0, |most, point| max(most, size(axes, &plus(point, -1.0, &bezier[0]))));
        let ends = [0.0, 1.0].map(|u| end(axes, &curve, u, extent));
        let mut here = Knot { position: from.position, ..knot_of(&ends[0], origin) };
        let mut there = Knot { position: *to, ..knot_of(&ends[1], origin) };
        let mut edges = [STEPS; 2];
        match &joints[0] {
            Joint::Smooth => here.end = from.end,
            Joint::Tangent => here.end.tangent = from.end.tangent,
            Joint::Bent(..) => here.end = from.end,
            Joint::Corner => {}
        }
        if let Joint::Bent(curvature, _) = &joints[1] {
            there.end.curvature = *curvature;
        }
        for (edge, joint) in edges.iter_mut().zip(joints) {
            if let Joint::Bent(_, length) = joint {
                *edge =
                    ((f32::from(STEPS) * (length / max(extent, f32::MIN_POSITIVE))) as u16).clamp(1, STEPS);
            }
        }
        let bent = joints.iter().any(|joint| matches!(joint, Joint::Bent(..)));
        let near = max(if bent { BENT } else { NEAR }, NEAR_PART * extent);
        let step = edges[0];
        Self { curve, origin: *origin, here, end: there, done: 0, step, edges, near }
    }

    /// Tries the next element.
    pub fn cut(&mut self, axes: &Main) -> Cut<AXES> {
        let left = STEPS - self.done;
        // The last element begins where its curvature is to agree from.
        let before_edge = left.saturating_sub(self.edges[1]);
        if before_edge > 0 && self.step > before_edge {
            self.step = before_edge;
        }
        self.step = self.step.min(left);
        let to = self.done + self.step;
        let [u0, u1] = [self.done, to].map(|step| f32::from(step) * (1.0 / f32::from(STEPS)));
        let last = to == STEPS;
        let knot = if last { self.end } else { knot_of(&self.curve.site(axes, u1), &self.origin) };
        let [a, b] = [&self.here, &knot].map(|knot| site_of(knot, &self.origin));
        let length = self.curve.length(axes, u0, u1);
        let element = Quintic::new(&a, &b, length);
        let [above, below] = element.unevenness(axes, length);
        let fits = element.weight() < HEAVIEST;
        let is_near = |t: f32| {
            let u = u0 + (u1 - u0) * t;
            self.curve.is_near(axes, &element.point(t), u, self.near)
        };
        let fine = fits && max(above, below) <= EVEN && [0.25, 0.5, 0.75].into_iter().all(is_near);
        if !fine && self.step > 1 && (length > 2.0 * SHORTEST || !fits) {
            self.step /= 2;
            return Cut::Again;
        }
        let made = if fits { Draft::new(&self.here, &knot, length, fastest(above)) } else { None };
        if made.is_none() && self.step > 1 {
            self.step /= 2;
            return Cut::Again;
        }
        (self.here, self.done) = (knot, to);
        self.step = self.step.saturating_mul(2);
        match made {
            Some((element, draft)) => Cut::Element(element, draft, last),
            None => Cut::Straight(knot.position, last),
        }
    }

    /// Start of the next element, and end of the last one.
    pub fn here(&self) -> &Knot<AXES> {
        &self.here
    }

    /// End of the curve.
    pub fn end(&self) -> &Knot<AXES> {
        &self.end
    }
}

/// An end of a cubic of that size, from its start or to its end. Where it has no speed, with the direction from
/// a point nearby.
#[inline(never)]
fn end<const AXES: usize>(axes: &Main, curve: &Quintic<AXES>, u: f32, extent: f32) -> Site<AXES> {
    let site = curve.site(axes, u);
    if size(axes, &curve.first(u)) >= LEAST_SPEED * extent {
        return site;
    }
    let inner = if u > 0.5 { 1.0 - 1.0 / 64.0 } else { 1.0 / 64.0 };
    let (there, here) = (curve.point(inner), curve.point(u));
    let away = if u > 0.5 { plus(&here, -1.0, &there) } else { plus(&there, -1.0, &here) };
    let way = max(size(axes, &away), f32::MIN_POSITIVE);
    Site { tangent: away.map(|x| x / way), curvature: [0.0; AXES], ..site }
}

/// Curvature of a path with these derivatives over a parameter, in every axis.
#[inline(never)]
pub fn curvature<const AXES: usize>(axes: &Main, first: &[f32; AXES], second: &[f32; AXES]) -> [f32; AXES] {
    let speed = max(size(axes, first), f32::MIN_POSITIVE);
    let tangent = first.map(|x| x / speed);
    let mut along = 0.0;
    for k in axes.of::<AXES>() {
        if let (Some(a), Some(b)) = (second.get(k), tangent.get(k)) {
            along += a * b;
        }
    }
    plus(second, -along, &tangent).map(|x| x / (speed * speed))
}

/// A knot at rest: for what begins with a corner.
pub const fn at<const AXES: usize>(position: [Position; AXES]) -> Knot<AXES> {
    Knot { position, end: End { tangent: [0; AXES], curvature: [0.0; AXES] } }
}

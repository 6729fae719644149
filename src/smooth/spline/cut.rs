//! Cuts a piece of a spline, a cubic over a parameter u = 0…1, into elements over their own arc length.
//!
//! An element is a polynomial of the fifth degree, with position, direction and curvature of the cubic at
//! both ends. The planner accepts an element under two conditions. The speed along the element differs from
//! the path speed by at most the fraction [`EVEN`]. The distance of the element from the cubic is below
//! [`NEAR`]. Otherwise the planner tries an element of half the length.
use crate::math::float::max;
use crate::path::poly::{Draft, Knot};
use crate::path::{Element, End};
use crate::quantity::Position;
use crate::smooth::contour::corner_curve::{EVEN, HEAVIEST, fastest, knot_of, site_of};
use crate::smooth::contour::curve::{Main, Quintic, Site, plus, size};

/// Permitted distance of an element from its curve, mm. For a larger curve, the distance is relative to its
/// size, because `f32` limits the resolution.
const NEAR: f32 = 1e-4;
const NEAR_PART: f32 = 1.0 / 1_048_576.0;
/// Largest distance by which the change to a continuous curvature at a point moves the curve, mm.
pub const BENT: f32 = 1e-3;

/// Number of places in a piece at which a cut is possible.
const STEPS: u16 = 512;

/// Shortest element, mm.
const SHORTEST: f32 = 2.5e-4;

/// A cubic has no direction at an end if its speed there is below this part of its size.
const LEAST_SPEED: f32 = 1.0 / 1024.0;

/// How the curve continues at an end of a piece.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Joint<const AXES: usize> {
    /// At its start, the piece has direction and curvature of the piece before. At its end, the piece has its
    /// own direction and curvature.
    Smooth,
    /// The end gets this curvature. The curve changes along this length of the piece, mm.
    Bent([f32; AXES], f32),
    /// The curve continues in the same direction with another curvature.
    Tangent,
    /// The curve continues in another direction.
    Corner,
}

/// A piece that is being cut into elements.
#[derive(Clone, Copy, Debug)]
pub struct Piece<const AXES: usize> {
    curve: Quintic<AXES>,
    /// Origin of the coordinates.
    origin: [Position; AXES],
    /// Start of the next element.
    here: Knot<AXES>,
    /// End of the last element.
    end: Knot<AXES>,
    /// Number of steps done, and number of steps in the current try.
    done: u16,
    step: u16,
    /// Largest number of steps in the first and in the last element.
    edges: [u16; 2],
    /// Permitted distance of an element from its curve, mm.
    near: f32,
}

/// The result of [`Piece::cut`], which tries one element of the spline.
#[derive(Clone, Copy, Debug)]
pub enum Cut<const AXES: usize> {
    /// A shorter element has to be tried.
    Again,
    /// The next element, the draft that computes the polynomials of its axes, and whether this element is the
    /// last one.
    Element(Element<AXES>, Draft<AXES>, bool),
    /// A straight line to this point replaces an element that the number format cannot hold. The flag tells
    /// whether it is the last element.
    Straight([Position; AXES], bool),
}

impl<const AXES: usize> Piece<AXES> {
    /// The cubic of these Bézier points, relative to `origin`, from the knot `from` to the position `to`.
    /// `joints`: how direction and curvature continue at both ends.
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
        // The last element begins where its curvature has to agree with that of the end.
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

/// An end of a cubic of this size. If the cubic has no speed there, the direction comes from a point nearby.
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

/// A knot without direction, for the start after a corner.
pub const fn at<const AXES: usize>(position: [Position; AXES]) -> Knot<AXES> {
    Knot { position, end: End { tangent: [0; AXES], curvature: [0.0; AXES] } }
}

//! Computes B-splines. The points are the corners of a polygon, the control polygon, which the curve follows.
//!
//! The curve is a cubic B-spline with knots at equal distances. Let a leg (side of the polygon) lead from C₁
//! to C₂, with C₀ before it and C₃ after it. The Bézier points of the curve over this leg are
//!
//! ```text
//! B₀ = C₁ + Δ₁/6,  B₁ = C₁ + D/3,  B₂ = C₁ + 2D/3,  B₃ = C₂ + Δ₂/6        D = C₂ − C₁,  Δᵢ = Cᵢ₋₁ − 2·Cᵢ + Cᵢ₊₁
//! ```
//!
//! The curve over the leg is L(u) + (1−u)³·Δ₁/6 + u³·Δ₂/6, with the point L(u) of the leg and u = 0…1. So its
//! distance from the leg is known without a search.
//!
//! **Tolerance.** Let t₁ and t₂ be the directions of the legs before and after a corner. Let a and b be the
//! distances from the corner to the control points next to it. Then Δ = b·t₂ − a·t₁. The component of Δ along
//! a leg moves the curve only along that leg. The component across the leg moves the curve by at most max(a,
//! b)·|t₂ − t₁|/6. So the curve at a corner stays inside the tolerance if no control point next to the corner
//! is farther away than
//!
//! ```text
//! d = 6·PATH_DEV / |t₂ − t₁|
//! ```
//!
//! A longer leg gets an additional control point at the distance d, which splits the leg. At such a point, Δ
//! is set to 0. So the curve passes through this point, and is a straight line between two such points. For a
//! tracking axis, the same formula applies with the change of its slope dx/ds in place of t₂ − t₁, and with
//! TRACK_DEV.
//!
//! A direct spline (G151) begins and ends at its first and last point, with knots at distance 0 there
//! (clamped): see [`direct`].
use super::window::{Leg, Window};
use crate::math::float::{magnitude, max, min};
use crate::smooth::contour::curve::{plus, size};

/// Tolerances of the distance between the curve and its polygon.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerance {
    /// Path tolerance, mm; infinite if not monitored.
    pub path: f32,
    /// Tolerance of other axes, mm or degrees.
    pub track: f32,
}

/// Part of the tolerance that the curve may use; the rest is for rounding and for the elements' distance from
/// the curve.
const PART: f32 = 1.0 - 1.0 / 4096.0;

/// Coordinates count from the start of a leg, so rounding is this part of the travel.
const ROUNDED: f32 = 1.0 / 8_388_608.0;

/// Largest distance between point `i` and the control points next to it, mm. Returns `None` if there is no
/// leg on one side.
pub fn reach<const AXES: usize>(window: &Window<AXES>, i: i32, tolerance: &Tolerance) -> Option<f32> {
    let (before, behind) = (window.leg(i - 1)?, window.leg(i)?);
    let axes = window.axes();
    let step = plus(&behind.slope, -1.0, &before.slope);
    let mut reach = f32::MAX;
    let mut lower = |deviation: f32, step: f32, travel: f32| {
        let room = 6.0 * max(PART * deviation - ROUNDED * travel, 0.5 * deviation);
        // The quotient is computed only if it is not too large.
        if room < step * 1e6 {
            reach = min(reach, room / step);
        }
    };
    lower(tolerance.path, size(axes, &step), max(before.length, behind.length));
    let travels = before.travel.iter().zip(&behind.travel).map(|(a, b)| max(magnitude(*a), magnitude(*b)));
    for (k, (step, travel)) in step.iter().zip(travels).enumerate() {
        if !axes.contains(k) {
            lower(tolerance.track, magnitude(*step), travel);
        }
    }
    Some(reach)
}

/// The additional control points inside a leg, and the permitted distance of control points from both ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Inside {
    /// Distances from the start of the leg, mm; an unused entry holds the length of the leg.
    pub at: [f32; 2],
    pub count: usize,
}

impl Inside {
    /// The control points of a leg of this length.
    pub fn new(length: f32, [before, behind]: [f32; 2]) -> Self {
        match (before < length, behind < length) {
            (false, false) => Self { at: [length; 2], count: 0 },
            (true, false) => Self { at: [before, length], count: 1 },
            (false, true) => Self { at: [length - behind, length], count: 1 },
            (true, true) if before + behind < length => Self { at: [before, length - behind], count: 2 },
            (true, true) => Self { at: [length * (before / (before + behind)), length], count: 1 },
        }
    }

    /// Distance from the start of the leg to its first control point.
    pub fn first(&self) -> f32 {
        self.at[0]
    }

    /// Distance from the last control point to the end of a leg of this length.
    pub fn last(&self, length: f32) -> f32 {
        match self.count {
            0 => length,
            1 => length - self.at[0],
            _ => length - self.at[1],
        }
    }

    /// Both ends of part `i`.
    pub fn part(&self, i: usize, length: f32) -> [f32; 2] {
        let place = |i: usize| match i {
            0 => 0.0,
            i if i <= self.count => self.at[(i - 1) & 1],
            _ => length,
        };
        [place(i), place(i + 1)]
    }
}

/// Bézier points of a part of a leg, from the leg's start. `before` and `behind`: distances from the ends of the leg to
/// the next control points; `None` where the curve passes the end of the leg.
pub fn part<const AXES: usize>(
    leg: &Leg<AXES>,
    inside: &Inside,
    i: usize,
    [before, behind]: [Option<[f32; AXES]>; 2],
) -> [[f32; AXES]; 4] {
    let length = leg.length;
    let [from, to] = inside.part(i, length);
    let at = |s: f32| if s < length { leg.slope.map(|x| x * s) } else { leg.travel };
    let (c1, c2) = (at(from), at(to));
    let d = plus(&c2, -1.0, &c1);
    // Δ from both vectors that lead away from a control point.
    let bend = |a: &[f32; AXES], b: &[f32; AXES]| plus(a, 1.0, b).map(|x| x * (1.0 / 6.0));
    let back = d.map(|x| -x);
    let none = [0.0; AXES];
    let bend1 = before.filter(|_| i == 0).map_or(none, |step| bend(&step, &d));
    let bend2 = behind.filter(|_| i == inside.count).map_or(none, |step| bend(&back, &step));
    [plus(&c1, 1.0, &bend1), plus(&c1, 1.0 / 3.0, &d), plus(&c1, 2.0 / 3.0, &d), plus(&c2, 1.0, &bend2)]
}

/// Bézier points of the direct spline over the current leg, counted from its start.
///
/// The knot interval k is 1 for a leg with a piece of the curve, and 0 for the first and the last leg. The
/// inner Bézier points divide a leg in the ratio k₋₁ : k : k₊₁; k₋₁ and k₊₁ are the intervals of the
/// neighbouring legs. The joint of two pieces divides the distance between their neighbouring inner points in
/// the ratio k₋₁ : k.
pub fn direct<const AXES: usize>(window: &Window<AXES>) -> Option<[[f32; AXES]; 4]> {
    let (leg, before, behind) = (window.leg(0)?, window.leg(-1)?, window.leg(1)?);
    // All legs have a piece, except the first and the last one.
    let knot = |i: i32| {
        let inner = window.leg(i).is_some() && !window.is_end(i) && !window.is_end(i + 1);
        if inner { 1.0_f32 } else { 0.0 }
    };
    let [k0, k1, k2, k3, k4] = [-2, -1, 0, 1, 2].map(knot);
    let travel = |leg: &Leg<AXES>, share: f32| leg.travel.map(|x| x * share);
    let between =
        |a: &[f32; AXES], b: &[f32; AXES], share: f32| plus(&a.map(|a| a * (1.0 - share)), share, b);
    let (whole, here) = (k1 + k2 + k3, &leg);
    let inner1 = travel(here, k1 / whole);
    let inner2 = travel(here, (k1 + k2) / whole);
    let last = travel(&before, (k0 + k1) / (k0 + k1 + k2) - 1.0);
    let next = plus(&leg.travel, k2 / (k2 + k3 + k4), &behind.travel);
    let start = between(&last, &inner1, k1 / (k1 + k2));
    let end = between(&inner2, &next, k2 / (k2 + k3));
    Some([start, inner1, inner2, end])
}

/// Whether a leg at a point is longer than the permitted distance of control points.
pub fn exceeds<const AXES: usize>(window: &Window<AXES>, i: i32, tolerance: &Tolerance) -> bool {
    let (Some(before), Some(behind)) = (window.leg(i - 1), window.leg(i)) else { return false };
    reach(window, i, tolerance).is_some_and(|reach| reach < max(before.length, behind.length))
}

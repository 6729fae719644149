//! Stores the points on which the current part of a spline depends, at most eight, and computes the straight
//! lines (legs) between them.
use super::LSB_32;
use crate::math::float::to_f32;
use crate::nc::Place;
use crate::path::Measure;
use crate::quantity::Position;
use crate::smooth::Data;
use crate::smooth::contour::curve::{Main, size};

/// Number of points in the window: two before the current leg, its two ends, three after it, and one new
/// point.
pub const POINTS: usize = 8;
/// Number of points that are kept before the current leg.
const BEFORE: usize = 2;
/// Number of points after the end of the current leg on which its curve depends.
const BEHIND: usize = 3;

/// A point, and the block that leads to it.
#[derive(Clone, Copy, Debug)]
pub struct Vertex<const AXES: usize> {
    pub at: [Position; AXES],
    /// Data of the block; unused for the first point.
    pub data: Data,
}

/// The straight line from one point to the next.
#[derive(Clone, Copy, Debug)]
pub struct Leg<const AXES: usize> {
    /// Travel of every axis, mm.
    pub travel: [f32; AXES],
    /// Direction: dx/ds of every axis.
    pub slope: [f32; AXES],
    /// Path length, mm.
    pub length: f32,
}

/// The axes along which path length counts.
pub fn along(measure: &Measure, axes: usize) -> Main {
    if measure.is_space() {
        return measure.main;
    }
    let mut feed = (0..axes).filter(|k| measure.feeds(*k));
    Main::new([feed.next(), feed.next(), feed.next()])
}

/// Travel of the axes, mm.
pub fn travel<const AXES: usize>(from: &[Position; AXES], to: &[Position; AXES]) -> [f32; AXES] {
    let mut travel = [0.0; AXES];
    for (x, (from, to)) in travel.iter_mut().zip(from.iter().zip(to)) {
        *x = to_f32(to.to_bits().wrapping_sub(from.to_bits())) * LSB_32;
    }
    travel
}

/// The points of a spline that are known so far, around the leg that becomes a curve next.
#[derive(Clone, Copy, Debug)]
pub struct Window<const AXES: usize> {
    points: [Vertex<AXES>; POINTS],
    count: usize,
    /// Index of the point where the current leg begins.
    at: usize,
    /// Whether the first known point is the first of the curve.
    whole: bool,
    /// Whether the last known point is the last of the curve.
    closed: bool,
    axes: Main,
}

impl<const AXES: usize> Window<AXES> {
    /// An empty window. `axes`: the axes along which path length counts.
    #[inline(always)]
    pub const fn new(axes: Main) -> Self {
        let data = Data { feed: None, n: 0, place: Place::NONE, number: 0, stop: false };
        let points = [Vertex { at: [Position::ZERO; AXES], data }; POINTS];
        Self { points, count: 0, at: 0, whole: true, closed: false, axes }
    }

    /// The axes along which path length counts.
    pub const fn axes(&self) -> &Main {
        &self.axes
    }

    /// Drops all points.
    pub const fn clear(&mut self) {
        (self.count, self.at, self.whole, self.closed) = (0, 0, true, false);
    }

    /// Whether there is no point.
    pub const fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// Whether there is a current leg.
    pub const fn has_leg(&self) -> bool {
        self.at + 1 < self.count
    }

    /// Whether all points are known on which the current leg depends.
    pub const fn is_ready(&self) -> bool {
        self.has_leg() && (self.closed || self.at + 1 + BEHIND < self.count)
    }

    /// Marks the last point as the last one of the curve.
    pub const fn close(&mut self) {
        self.closed = true;
    }

    /// Whether the last point of the curve is known.
    pub const fn is_closed(&self) -> bool {
        self.closed
    }

    /// Whether the curve has too few points to control a cubic.
    pub const fn is_short(&self) -> bool {
        self.whole && self.closed && self.count < 4
    }

    /// Adds the next point. There is room while [`Self::is_ready`] is false.
    pub fn push(&mut self, vertex: Vertex<AXES>) {
        if let Some(point) = self.points.get_mut(self.count) {
            *point = vertex;
            self.count += 1;
        }
    }

    /// The last point.
    pub fn last(&mut self) -> Option<&mut Vertex<AXES>> {
        self.points.get_mut(..self.count)?.last_mut()
    }

    /// Replaces the last point.
    pub fn replace(&mut self, vertex: Vertex<AXES>) {
        if let Some(last) = self.last() {
            *last = vertex;
        }
    }

    /// Goes on to the next leg.
    pub fn advance(&mut self) {
        self.at += 1;
        if self.at > BEFORE {
            self.points.copy_within(1.., 0);
            (self.at, self.whole) = (self.at - 1, false);
            self.count -= 1;
        }
    }

    /// Point `i`, counted from the start of the current leg.
    pub fn point(&self, i: i32) -> Option<&Vertex<AXES>> {
        let at = usize::try_from(self.at as i32 + i).ok()?;
        self.points.get(..self.count)?.get(at)
    }

    /// Whether this is the first or the last point of the curve.
    pub fn is_end(&self, i: i32) -> bool {
        let at = self.at as i32 + i;
        (self.whole && at <= 0) || (self.closed && at + 1 >= self.count as i32)
    }

    /// The leg from the point `i` to the next one.
    pub fn leg(&self, i: i32) -> Option<Leg<AXES>> {
        let travel = travel(&self.point(i)?.at, &self.point(i + 1)?.at);
        let length = size(&self.axes, &travel);
        if length <= 0.0 {
            return None;
        }
        let per = 1.0 / length;
        Some(Leg { travel, slope: travel.map(|x| x * per), length })
    }
}

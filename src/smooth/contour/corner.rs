//! Finds the corner distances of a curve over arc length: how far the curve reaches into both blocks.
//!
//! The curve is a polynomial of the fifth degree, with direction and curvature of the blocks at both ends.
//! The speed along the curve over the parameter is nearly constant: in a corner of 90°, the speed varies by
//! about 0.2 %.
//!
//! The deviation grows with the corner distances. A search finds the distances at which the curve uses all of
//! the tolerance, with a few trials per call.
use super::curve::{Deviation, Main, Quintic, Side, Site, aside, dot, even_speed, plus, size};
use super::{Parameters, TANGENTIAL};
use crate::math::float::{max, min};
use crate::math::root::sqrt_f32;
use crate::nc::ContourMethod;
use crate::path::Measure;

/// Share of a tolerance that the search aims at, and the accuracy of the search. The rest of the tolerance is
/// for rounding.
pub const AIM: f32 = 1.0 - 2e-4;
const NEAR: f32 = 1.2e-4;

/// Largest number of trials for a corner distance.
const TRIALS: usize = 16;

/// Share of [`AIM`] that is left for the elements' distance from the curve.
const SLACK: f32 = 6e-5;

/// Trials per call between lines: a trial takes a hundredth of the work of a trial at an arc.
const TRIALS_PER_CALL: usize = 4;

/// The two blocks of a corner. Offsets count from the end of the first block.
pub struct Corner<'a, const AXES: usize> {
    /// The main axes, in whose space the corner lies.
    pub main: &'a Main,
    /// The block before the corner.
    pub before: Side<AXES>,
    /// The block after the corner.
    pub behind: Side<AXES>,
    /// The vector from one block to the other, over blocks that are left out; `None` if no block is left out.
    pub gap: Option<[f32; AXES]>,
}

/// A relative change of curvature below this value counts as none.
const ALIKE: f32 = 1.0 / 256.0;

/// Cosine of 102 degrees.
const SHARP: f32 = -0.207_912;

/// Tolerances of a corner, mm and degrees. A tracking tolerance of 0 means none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerance {
    /// Tolerance of the main axes; `None` if distances are given.
    pub path: Option<f32>,
    /// Tolerance of each other axis, mm or degrees.
    pub track: f32,
}

impl<const AXES: usize> Corner<'_, AXES> {
    /// DIST_MASTER: whether, on both lines, the path length is the travel of the master axis in the same
    /// direction.
    pub fn follows_master(&self, rule: &Parameters, measure: &Measure) -> bool {
        let Some(k) = measure.master().filter(|_| rule.method == ContourMethod::DistMaster) else {
            return false;
        };
        let along = |side: &Side<AXES>| side.tangent().get(k).copied().unwrap_or(0.0);
        let (before, behind) = (along(&self.before), along(&self.behind));
        let product = before * behind;
        self.before.rate == 0.0 && self.behind.rate == 0.0 && product > 1.0 - 1e-4 && product < 1.0 + 1e-4
    }

    /// Whether the curve with equal distances is known in closed form: both sides are lines, no block is left
    /// out, and the path is that in space.
    pub fn is_symmetric(&self, rule: &Parameters, measure: &Measure) -> bool {
        let lines = self.before.rate == 0.0 && self.behind.rate == 0.0 && self.gap.is_none();
        lines && measure.is_space() && rule.method != ContourMethod::Pos
    }

    /// Whether any axis changes its speed at the corner.
    pub fn turns(&self) -> bool {
        let ends = self.before.tangent().iter().zip(self.behind.tangent());
        ends.fold(0.0, |most, (a, b)| max(most, max(a - b, b - a))) >= TANGENTIAL
    }

    /// Whether a main axis changes its curvature at the corner: an arc begins or ends, or the radius changes.
    pub fn steps(&self) -> bool {
        let change = size(self.main, &plus(self.behind.curvature(), -1.0, self.before.curvature()));
        change > ALIKE * max(self.before.rate, self.behind.rate)
    }

    /// Whether the corner turns the main axes by more than 102 degrees.
    pub fn is_sharp(&self) -> bool {
        let [before, behind] = self.spaces_per_path();
        dot(self.main, self.before.tangent(), self.behind.tangent()) < SHARP * before * behind
    }

    /// Distance in space per path distance, before and after the corner.
    pub fn spaces_per_path(&self) -> [f32; 2] {
        [self.before.space_per_path, self.behind.space_per_path]
    }

    /// The curve with these corner distances.
    pub fn between(&self, reach: [f32; 2]) -> Quintic<AXES> {
        let ([begin, end], speed) = self.ends(reach);
        Quintic::new(&begin, &end, speed)
    }

    /// Ends of the curve, and its speed there, mm per unit of the parameter.
    fn ends(&self, [c1, c2]: [f32; 2]) -> ([Site<AXES>; 2], f32) {
        let (begin, mut end) = (self.before.at(-c1), self.behind.at(c2));
        if let Some(gap) = &self.gap {
            end.offset = plus(&end.offset, 1.0, gap);
        }
        let speed = even_speed(self.main, &begin, &end, mean(self.spaces_per_path()));
        ([begin, end], speed)
    }

    /// Largest distance of a non-main axis from the contour, on a curve with these corner distances.
    ///
    /// Each place of the curve has its place on the contour: the one at the same path distance, s = −c1 … c2
    /// from the corner. A quintic with the same ends gives s(u). An axis has the slopes g1 and g2. Its
    /// deviation is (g2 − g1)·y(u) before the corner, and (g1 − g2)·x(u) after the corner. x is the quintic
    /// from −c1 to a stop at 0; y is the quintic from 0 to c2. With equal distances, both deviations are
    /// largest at the corner, at u = 1/2. With unequal distances, the quintic of the shorter side may first
    /// swing to the other side. This happens if its speed is more than 2.5 times its distance, because its
    /// third coefficient is then negative.
    ///
    /// If blocks are left out, their line is the contour between both sides. The places along this line are
    /// checked in equal steps too.
    fn track_deviation(&self, curve: &Quintic<AXES>, reach: [f32; 2]) -> f32 {
        let [c1, c2] = reach;
        if self.gap.is_none() && c1 == c2 {
            return aside(self.main, &curve.point(0.5));
        }
        let (_, v) = self.ends(reach);
        let unmoved = [0.0; AXES];
        let gap = self.gap.as_ref().unwrap_or(&unmoved);
        let way = size(self.main, gap) / mean(self.spaces_per_path());
        let along = |u: f32| u * v - c1 + (c1 + c2 + way - v) * u * u * u * (10.0 - u * (15.0 - 6.0 * u));
        let (g1, g2) = (self.before.tangent(), self.behind.tangent());
        let off = |u: f32| {
            let (s, at) = (along(u), curve.point(u));
            let off = if s <= 0.0 {
                plus(&at, -s, g1)
            } else if s < way {
                plus(&at, -s / way, gap)
            } else {
                plus(&plus(&at, -1.0, gap), way - s, g2)
            };
            aside(self.main, &off)
        };
        let mut most = 0.0;
        for place in [0.0, way] {
            let (mut low, mut high) = (0.0, 1.0);
            for _ in 0..HALVINGS {
                let u = 0.5 * (low + high);
                if along(u) < place { low = u } else { high = u }
            }
            most = max(most, off(0.5 * (low + high)));
        }
        if let Some(u) = swing(c1 / v) {
            most = max(most, off(1.0 - u));
        }
        if let Some(u) = swing(c2 / v) {
            most = max(most, off(u));
        }
        if self.gap.is_some() {
            most = (1..TRACK_PLACES).fold(most, |most, i| max(most, off(i as f32 / TRACK_PLACES as f32)));
        }
        most
    }

    /// Path length of a curve with these corner distances.
    pub fn path(&self, curve: &Quintic<AXES>) -> f32 {
        curve.length(self.main, 0.0, 1.0) / mean(self.spaces_per_path())
    }
}

/// The place where the quintic from a stop at 0 to `distance`, with the speed 1 there, is furthest on the
/// other side of 0. Returns `None` if it stays on one side.
fn swing(distance: f32) -> Option<f32> {
    // u³·(a + b·u + c·u²) has its extremes at 3a + 4b·u + 5c·u² = 0.
    let (a, b, c) = (10.0 * distance - 4.0, 7.0 - 15.0 * distance, 6.0 * distance - 3.0);
    let square = 4.0 * b * b - 15.0 * a * c;
    (a < 0.0 && square >= 0.0).then(|| -3.0 * a / (2.0 * b + sqrt_f32(square)))
}

/// Number of times that the search for a place halves its range. The second value is the number of places
/// on a whole curve.
const HALVINGS: u32 = 20;
const TRACK_PLACES: u32 = 16;

/// The mean of two values: one for each side of a corner.
pub fn mean([before, behind]: [f32; 2]) -> f32 {
    0.5 * (before + behind)
}

/// Share of a tolerance that a curve uses (1 is all), and the permitted distance of its elements from the
/// curve, mm. The elements are exact at the place nearest to the corner, where the deviation is usually
/// largest.
type Use = (f32, f32);

/// Searches the largest share, at most 1, of given distances with which the curve stays inside a tolerance.
/// The method is regula falsi with the Illinois rule.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Search<const AXES: usize> {
    distances: [f32; 2],
    /// Whether the deviation is searched along the whole curve: at arcs and left-out blocks. This takes a
    /// hundred times the work.
    along: bool,
    /// The curve of the current trial, if it is made, and the progress of the search for its deviation.
    curve: Quintic<AXES>,
    is_made: bool,
    deviation: Deviation,
    /// Number of trials so far, and the current share.
    trials: usize,
    part: f32,
    /// The largest known share inside the tolerance and the smallest known share outside, each with its
    /// excess over [`AIM`]. An excess is halved if its share has not changed for two trials. `room`:
    /// permitted distance of elements at the lower share.
    low: f32,
    high: f32,
    under: f32,
    over: f32,
    room: f32,
    side: i8,
}

impl<const AXES: usize> Search<AXES> {
    fn new(distances: [f32; 2], along: bool) -> Self {
        let (curve, is_made, deviation) = (Quintic::NONE, false, Deviation::NEW);
        let ([low, high], [under, over]) = ([0.0, 1.0], [-AIM, 0.0]);
        let (trials, part, room, side) = (0, 1.0, 0.0, 0);
        Self { distances, along, curve, is_made, deviation, trials, part, low, high, under, over, room, side }
    }

    /// The share of the tolerance that the current curve uses; `None` while its deviation is still searched.
    fn use_of(&mut self, corner: &Corner<'_, AXES>, tolerance: &Tolerance) -> Option<Use> {
        if !self.is_made {
            self.curve = corner.between(self.distances.map(|c| c * self.part));
            self.is_made = true;
        }
        let Self { curve, .. } = self;
        let (mut most, mut slack) = (0.0, f32::MAX);
        if let Some(path) = tolerance.path {
            let mut elsewhere = 0.0;
            if self.along {
                let reach = self.distances.map(|c| c * self.part);
                let sides = [&corner.before, &corner.behind];
                elsewhere = self.deviation.go_on(corner.main, curve, sides, reach, corner.gap.as_ref())?;
                slack = max(path - elsewhere, SLACK * path);
            }
            most = max(curve.distance(corner.main, &[0.0; AXES], 0.5, elsewhere), elsewhere) / path;
        }
        if tolerance.track > 0.0 {
            let reach = self.distances.map(|c| c * self.part);
            most = max(most, corner.track_deviation(curve, reach) / tolerance.track);
        }
        Some((most, slack))
    }

    /// Does one trial. Returns `None` while the search goes on. At the end, returns the share and the
    /// permitted distance of elements, or `Some(None)` if there is no curve.
    fn go_on(&mut self, corner: &Corner<'_, AXES>, tolerance: &Tolerance) -> Option<Option<Use>> {
        let (used, slack) = self.use_of(corner, tolerance)?;
        let off = used - AIM;
        if self.trials == 0 {
            if used <= AIM + NEAR {
                return Some(Some((1.0, slack)));
            }
            self.over = off;
        } else {
            self.narrow(off, slack);
            if off > -NEAR && off < NEAR {
                return Some(Some((self.part, slack)));
            }
        }
        if self.trials >= TRIALS {
            // The result is less accurate, but inside the tolerance.
            return Some(if self.low > 0.0 { Some((self.low, self.room)) } else { None });
        }
        self.trials += 1;
        self.part = self.low + (self.high - self.low) * (-self.under / (self.over - self.under));
        (self.is_made, self.deviation) = (false, Deviation::NEW);
        None
    }

    /// Uses the result of a trial.
    fn narrow(&mut self, off: f32, slack: f32) {
        if off > 0.0 {
            (self.high, self.over) = (self.part, off);
            if self.side == 1 {
                self.under *= 0.5;
            }
            self.side = 1;
        } else {
            (self.low, self.under, self.room) = (self.part, off, slack);
            if self.side == -1 {
                self.over *= 0.5;
            }
            self.side = -1;
        }
    }
}

/// The search for the largest part, at most 1, of given distances with which the curve stays inside a
/// tolerance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reach<const AXES: usize> {
    tolerance: Tolerance,
    search: Search<AXES>,
    /// The share that keeps the tolerance at the corner point, which is usually the result.
    first: f32,
}

impl<const AXES: usize> Reach<AXES> {
    /// A new search, without trials.
    pub fn new(tolerance: Tolerance, distances: [f32; 2]) -> Self {
        Self { tolerance, search: Search::new(distances, false), first: 1.0 }
    }

    /// A new search with other distances and the same tolerance.
    pub fn within(&self, distances: [f32; 2]) -> Self {
        Self::new(self.tolerance, distances)
    }

    /// The curve with the found share, if the last trial made this curve.
    pub fn curve(&self, part: f32) -> Option<&Quintic<AXES>> {
        (self.first * self.search.part == part).then_some(&self.search.curve)
    }

    /// Continues the search. Returns `None` while the search goes on. At the end, returns the share and the
    /// permitted distance of the elements from the curve (mm), or `Some(None)` if there is no curve.
    #[inline(never)]
    pub fn go_on(&mut self, corner: &Corner<'_, AXES>) -> Option<Option<(f32, f32)>> {
        let trials = if self.search.along { 1 } else { TRIALS_PER_CALL };
        for _ in 0..trials {
            let Some(found) = self.search.go_on(corner, &self.tolerance) else { continue };
            let Some((part, slack)) = found else { return Some(None) };
            let straight = corner.before.rate == 0.0 && corner.behind.rate == 0.0 && corner.gap.is_none();
            if self.search.along || self.tolerance.path.is_none() || straight {
                return Some(Some((self.first * part, slack)));
            }
            self.first = part;
            self.search = Search::new(self.search.distances.map(|c| c * part), true);
            return None;
        }
        None
    }
}

/// The change of direction at a corner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turn {
    /// Sine of half the change of direction, over the main axes.
    pub sine: f32,
    /// Cosine of half the change of direction, over the main axes.
    pub cosine: f32,
    /// Largest change of slope of the other axes.
    pub track: f32,
}

/// Smallest distance in space per path distance.
const SLOWEST: f32 = 1.0 / 1024.0;

/// The change of direction between both sides of a corner. Returns `None` if the main axes do not move, or
/// hardly move, on one of the sides.
pub fn turn<const AXES: usize>(measure: &Measure, before: &Side<AXES>, behind: &Side<AXES>) -> Option<Turn> {
    let main = &measure.main;
    let moves = |side: &Side<AXES>| {
        if !measure.is_space() {
            return side.space_per_path > SLOWEST;
        }
        let square = dot(main, side.tangent(), side.tangent());
        square > 1.0 - 1e-4 && square < 1.0 + 1e-4
    };
    if !moves(before) || !moves(behind) {
        return None;
    }
    let unit = |side: &Side<AXES>| side.tangent().map(|t| t / side.space_per_path);
    let (before, behind) = (unit(before), unit(behind));
    let (change, both) = (plus(&behind, -1.0, &before), plus(&behind, 1.0, &before));
    let track = aside(main, &change);
    Some(Turn { sine: 0.5 * size(main, &change), cosine: min(0.5 * size(main, &both), 1.0), track })
}

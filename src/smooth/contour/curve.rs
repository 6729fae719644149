//! Geometry of a corner in `f32`, relative to the corner point: positions, deviations and lengths of a curve,
//! and the places at which the curve is cut into elements.
//!
//! Rounding moves a curve by 10^-7 of its size. Elements still meet exactly, because the elements on both
//! sides of a cut use the same numbers.
use crate::math::float::{magnitude, max, min, to_f32, to_i64};
use crate::math::root::sqrt_f32;
use crate::math::trig::sin_cos;
pub use crate::path::measure::Main;
use crate::path::{Element, End, Measure};

const LSB_40: f32 = 1.0 / (1u64 << 40) as f32;

/// 2^64 / 2π and 2^-62.
const TURNS: f32 = 2.935_890_4e18;
const LSB_62: f32 = 1.0 / (1u64 << 62) as f32;

/// Scalar product of the main axes' components.
pub fn dot<const AXES: usize>(main: &Main, a: &[f32; AXES], b: &[f32; AXES]) -> f32 {
    if main.lead()
        && let ([a0, a1, a2, ..], [b0, b1, b2, ..]) = (a.as_slice(), b.as_slice())
    {
        return a0 * b0 + a1 * b1 + a2 * b2;
    }
    main.of::<AXES>().fold(0.0, |sum, k| sum + a[k] * b[k])
}

/// Length of the vector of the main axes' components.
pub fn size<const AXES: usize>(main: &Main, a: &[f32; AXES]) -> f32 {
    sqrt_f32(dot(main, a, a))
}

/// Collects one value per axis.
#[cfg_attr(feature = "fast", inline(always))]
fn each<const AXES: usize>(values: impl Iterator<Item = f32>) -> [f32; AXES] {
    let mut out = [0.0; AXES];
    for (x, value) in out.iter_mut().zip(values) {
        *x = value;
    }
    out
}

/// a + f·b.
pub fn plus<const AXES: usize>(a: &[f32; AXES], f: f32, b: &[f32; AXES]) -> [f32; AXES] {
    let mut sum = *a;
    for (sum, b) in sum.iter_mut().zip(b) {
        *sum += f * b;
    }
    sum
}

/// The largest magnitude of any non-main axis.
pub fn aside<const AXES: usize>(main: &Main, a: &[f32; AXES]) -> f32 {
    let others = a.iter().enumerate().filter(|(k, _)| !main.contains(*k));
    others.fold(0.0, |most, (_, x)| max(most, magnitude(*x)))
}

/// The place on the straight line to `end` that is nearest to `point`, as a fraction of the line. Both
/// vectors count from the start of the line.
pub fn foot<const AXES: usize>(main: &Main, end: &[f32; AXES], point: &[f32; AXES]) -> f32 {
    let square = dot(main, end, end);
    if square > 0.0 { min(max(dot(main, point, end) / square, 0.0), 1.0) } else { 0.0 }
}

/// Distance of a point from the straight line to `end`.
fn segment_distance<const AXES: usize>(main: &Main, end: &[f32; AXES], point: &[f32; AXES]) -> f32 {
    size(main, &plus(point, -foot(main, end, point), end))
}

/// A point of a corner curve, with direction and curvature, relative to the corner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Site<const AXES: usize> {
    /// Offset from the corner, mm.
    pub offset: [f32; AXES],
    /// Direction: dx/ds of every axis.
    pub tangent: [f32; AXES],
    /// Curvature: d²x/ds² of every axis, 1/mm.
    pub curvature: [f32; AXES],
}

impl<const AXES: usize> Site<AXES> {
    /// The corner itself, without direction.
    pub const NONE: Self = Self { offset: [0.0; AXES], tangent: [0.0; AXES], curvature: [0.0; AXES] };
}

/// A block at the corner, as a function of the distance from the corner. Distances before the corner are
/// negative.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Side<const AXES: usize> {
    tangent: [f32; AXES],
    curvature: [f32; AXES],
    /// Axes of an arc's plane.
    plane: Option<[usize; 2]>,
    /// Angle per path distance, 1/mm; 0 for a line.
    pub rate: f32,
    /// Distance in space per path distance: exactly 1 if the main axes are the feed axes.
    pub space_per_path: f32,
}

/// Distance in space per path distance of a direction.
pub fn space_per_path<const AXES: usize>(measure: &Measure, tangent: &[f32; AXES]) -> f32 {
    if measure.is_space() { 1.0 } else { size(&measure.main, tangent) }
}

/// Converts the tangent at one end of an element to numbers: dx/ds of every axis.
pub fn direction<const AXES: usize>(end: &End<AXES>) -> [f32; AXES] {
    end.tangent.map(|t| to_f32(t) * LSB_40)
}

impl<const AXES: usize> Side<AXES> {
    /// Makes the side from the block `element`. `end`: direction and curvature at the end of the block that
    /// is at the corner.
    pub fn new(element: &Element<AXES>, end: &End<AXES>, measure: &Measure) -> Self {
        let tangent = direction(end);
        let space_per_path = space_per_path(measure, &tangent);
        let mut side = Self { tangent, curvature: end.curvature, plane: None, rate: 0.0, space_per_path };
        if let Some(circle) = element.circle {
            let inside = |x: &[f32; AXES]| {
                let sum = circle.plane.iter().filter_map(|k| x.get(*k)).fold(0.0, |sum, x| sum + x * x);
                sqrt_f32(sum)
            };
            side.plane = Some(circle.plane);
            side.rate = inside(&side.curvature) / max(inside(&side.tangent), f32::MIN_POSITIVE);
        }
        side
    }

    /// Direction at the corner.
    pub fn tangent(&self) -> &[f32; AXES] {
        &self.tangent
    }

    /// Curvature at the corner.
    pub const fn curvature(&self) -> &[f32; AXES] {
        &self.curvature
    }

    /// The point at the distance `s` (mm) from the corner.
    pub fn at(&self, s: f32) -> Site<AXES> {
        let offset = self.tangent.map(|t| t * s);
        let mut site = Site { offset, tangent: self.tangent, curvature: self.curvature };
        if let Some(plane) = self.plane {
            let angle = self.rate * s;
            // Half the angle is used, because 1 − cos is then accurate for small angles.
            let (half, other) = sine(0.5 * angle);
            let (sin, cos) = (2.0 * half * other, 1.0 - 2.0 * half * half);
            let along = sin / self.rate;
            let across = 2.0 * half * half / (self.rate * self.rate);
            for k in plane {
                let (Some(t), Some(c)) = (self.tangent.get(k), self.curvature.get(k)) else { continue };
                if let Some(x) = site.offset.get_mut(k) {
                    *x = t * along + c * across;
                }
                if let Some(x) = site.tangent.get_mut(k) {
                    *x = t * cos + c * along;
                }
                if let Some(x) = site.curvature.get_mut(k) {
                    *x = c * cos - t * self.rate * sin;
                }
            }
        }
        site
    }

    /// The point without direction and curvature.
    pub fn point(&self, s: f32) -> [f32; AXES] {
        let mut point = self.tangent.map(|t| t * s);
        if let Some(plane) = self.plane {
            let (half, other) = sine(0.5 * (self.rate * s));
            let along = 2.0 * half * other / self.rate;
            let across = 2.0 * half * half / (self.rate * self.rate);
            for k in plane {
                if let (Some(x), Some(t), Some(c)) =
                    (point.get_mut(k), self.tangent.get(k), self.curvature.get(k))
                {
                    *x = t * along + c * across;
                }
            }
        }
        point
    }

    /// Distance of a point from the block on one side of the corner. `side` is −1 before the corner and 1
    /// after it. If the distance is surely at most `most`, the result may be any such value.
    pub fn distance(&self, main: &Main, point: &[f32; AXES], (guess, side): (f32, f32), most: f32) -> f32 {
        let inside = |s: f32| side * max(side * s, 0.0);
        if self.rate == 0.0 {
            let square = self.space_per_path * self.space_per_path;
            let s = inside(dot(main, point, &self.tangent) / square);
            return size(main, &plus(point, -s, &self.tangent));
        }
        let mut s = inside(guess);
        let mut away = [0.0; AXES];
        for _ in 0..FOOT_STEPS {
            let site = self.at(s);
            away = plus(point, -1.0, &site.offset);
            if dot(main, &away, &away) <= SURELY * most * most {
                return 0.0;
            }
            let square = self.space_per_path * self.space_per_path;
            let bent = square - dot(main, &away, &site.curvature);
            let step = dot(main, &away, &site.tangent) / max(bent, 0.25 * square);
            let (before, next) = (s, inside(s + step));
            s = next;
            if magnitude(next - before) * self.rate <= NEXT {
                // Up to here, the block counts as straight.
                away = plus(&away, before - next, &site.tangent);
                break;
            }
        }
        size(main, &away)
    }
}

/// Angle of the last step towards the foot of a perpendicular. The arc is then 2^-25 of the radius off its
/// tangent.
const NEXT: f32 = 1.0 / 4096.0;

/// Largest number of steps towards the foot.
const FOOT_STEPS: usize = 4;

/// Sine and cosine.
fn sine(angle: f32) -> (f32, f32) {
    let (sin, cos) = sin_cos(to_i64(angle * TURNS) as u64);
    (to_f32(sin) * LSB_62, to_f32(cos) * LSB_62)
}

/// A polynomial of the fifth degree over u = 0…1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quintic<const AXES: usize> {
    power: [[f32; AXES]; 6],
}

impl<const AXES: usize> Quintic<AXES> {
    /// Not made yet.
    pub const NONE: Self = Self { power: [[0.0; AXES]; 6] };

    /// The curve from one site to the other, with `speed` (mm per u) at both ends and no acceleration along
    /// the path.
    pub fn new(a: &Site<AXES>, b: &Site<AXES>, speed: f32) -> Self {
        let square = speed * speed;
        let mut power = [[0.0; AXES]; 6];
        for k in 0..AXES {
            let get = |x: &[f32; AXES]| x.get(k).copied().unwrap_or(0.0);
            let travel = get(&b.offset) - get(&a.offset);
            let [v0, v1] = [get(&a.tangent) * speed, get(&b.tangent) * speed];
            let [w0, w1] = [get(&a.curvature) * square, get(&b.curvature) * square];
            let column = [
                get(&a.offset),
                v0,
                0.5 * w0,
                10.0 * travel - 6.0 * v0 - 4.0 * v1 - 1.5 * w0 + 0.5 * w1,
                -15.0 * travel + 8.0 * v0 + 7.0 * v1 + 1.5 * w0 - w1,
                6.0 * travel - 3.0 * (v0 + v1) - 0.5 * (w0 - w1),
            ];
            for (row, value) in power.iter_mut().zip(column) {
                if let Some(x) = row.get_mut(k) {
                    *x = value;
                }
            }
        }
        Self { power }
    }

    /// The cubic with these four Bézier points.
    pub fn cubic(points: &[[f32; AXES]; 4]) -> Self {
        let [b0, b1, b2, b3] = points;
        let first = plus(b1, -1.0, b0).map(|x| 3.0 * x);
        // The differences of the points, and the differences of those.
        let bend = plus(&plus(b2, -2.0, b1), 1.0, b0).map(|x| 3.0 * x);
        let twist = plus(&plus(b3, -1.0, b0), -3.0, &plus(b2, -1.0, b1));
        let none = [0.0; AXES];
        Self { power: [*b0, first, bend, twist, none, none] }
    }

    /// For each axis, the magnitudes of all coefficients except the constant one are added. Returns the
    /// largest sum, mm.
    pub fn weight(&self) -> f32 {
        let [_, rest @ ..] = &self.power;
        let mut most = 0.0;
        for k in 0..AXES {
            let size = |row: &[f32; AXES]| row.get(k).map_or(0.0, |x| magnitude(*x));
            most = max(most, rest.iter().map(size).sum());
        }
        most
    }

    /// Point, first and second derivative.
    pub fn at(&self, u: f32) -> [[f32; AXES]; 3] {
        let [p0, p1, p2, p3, p4, p5] = &self.power;
        let mut at = [*p0, [0.0; AXES], [0.0; AXES]];
        let [points, firsts, seconds] = &mut at;
        let rows = points.iter_mut().zip(firsts).zip(seconds);
        let powers = p1.iter().zip(p2).zip(p3.iter().zip(p4).zip(p5));
        for (((x, first), second), ((c1, c2), ((c3, c4), c5))) in rows.zip(powers) {
            *x += u * (c1 + u * (c2 + u * (c3 + u * (c4 + u * c5))));
            *first = c1 + u * (2.0 * c2 + u * (3.0 * c3 + u * (4.0 * c4 + u * 5.0 * c5)));
            *second = 2.0 * c2 + u * (6.0 * c3 + u * (12.0 * c4 + u * 20.0 * c5));
        }
        at
    }

    /// The point at `u` alone.
    pub fn point(&self, u: f32) -> [f32; AXES] {
        let [p0, p1, p2, p3, p4, p5] = &self.power;
        let rest = p0.iter().zip(p1).zip(p2).zip(p3.iter().zip(p4).zip(p5));
        each(
            rest.map(|(((c0, c1), c2), ((c3, c4), c5))| {
                c0 + u * (c1 + u * (c2 + u * (c3 + u * (c4 + u * c5))))
            }),
        )
    }

    /// First derivative.
    pub fn first(&self, u: f32) -> [f32; AXES] {
        let [_, p1, p2, p3, p4, p5] = &self.power;
        let rest = p1.iter().zip(p2).zip(p3.iter().zip(p4).zip(p5));
        each(rest.map(|((c1, c2), ((c3, c4), c5))| {
            c1 + u * (2.0 * c2 + u * (3.0 * c3 + u * (4.0 * c4 + u * 5.0 * c5)))
        }))
    }

    /// Upper bounds of the first three derivatives of each axis with respect to path distance. The path has
    /// the length `length` (mm) and is proportional to u. The bounds come from the control points, and
    /// include rounding.
    pub fn hull(&self, length: f32) -> [[f32; AXES]; 3] {
        let [_, p1, p2, p3, p4, p5] = &self.power;
        let mut hull = [[0.0; AXES]; 3];
        let [first, second, third] = &mut hull;
        let powers = p1.iter().zip(p2).zip(p3.iter().zip(p4).zip(p5));
        let rows = first.iter_mut().zip(second).zip(third);
        let (per, rest) = (1.0 / length, length * HIDDEN);
        for (((first, second), third), ((c1, c2), ((c3, c4), c5))) in rows.zip(powers) {
            let [b0, b1, b2, b3] = [2.0 * c2, 2.0 * c3, 4.0 * c4, 20.0 * c5];
            let [t0, t1, t2] = [6.0 * c3, 12.0 * c4, 60.0 * c5];
            let sum =
                [c1, &b0, &(3.0 * c3), &b2, &(5.0 * c5)].into_iter().map(|x| magnitude(*x)).sum::<f32>();
            let bent = [b0, b0 + b1, b0 + 2.0 * b1 + b2, b0 + 3.0 * (b1 + b2) + b3];
            let twisted = [t0, t0 + t1, t0 + 2.0 * t1 + t2];
            *first = (sum + rest) * per;
            *second = (bent.into_iter().map(magnitude).fold(0.0, max) + rest) * per * per;
            *third = (twisted.into_iter().map(magnitude).fold(0.0, max) + rest) * per * per * per;
        }
        hull
    }

    /// Squares of the speed of the main axes at these values of u.
    #[cfg_attr(feature = "fast", inline(always))]
    fn squares<const N: usize>(&self, main: &Main, places: &[f32; N]) -> [f32; N] {
        let [_, p1, p2, p3, p4, p5] = &self.power;
        let mut sums = [0.0; N];
        // The loop runs over the axes, so that common terms are computed once.
        for k in main.of::<AXES>() {
            let get = |p: &[f32; AXES]| p.get(k).copied().unwrap_or(0.0);
            let [c1, c2, c3, c4] = [get(p1), 2.0 * get(p2), 3.0 * get(p3), 4.0 * get(p4)];
            let c5 = get(p5);
            for (sum, u) in sums.iter_mut().zip(places) {
                let speed = c1 + u * (c2 + u * (c3 + u * (c4 + u * 5.0 * c5)));
                *sum += speed * speed;
            }
        }
        sums
    }

    /// Second derivative.
    pub fn second(&self, u: f32) -> [f32; AXES] {
        let [_, _, p2, p3, p4, p5] = &self.power;
        let rest = p2.iter().zip(p3).zip(p4.iter().zip(p5));
        each(rest.map(|((c2, c3), (c4, c5))| 2.0 * c2 + u * (6.0 * c3 + u * (12.0 * c4 + u * 20.0 * c5))))
    }

    /// Third derivative.
    #[inline(never)]
    pub fn third(&self, u: f32) -> [f32; AXES] {
        let [.., p3, p4, p5] = &self.power;
        let mut out = *p3;
        for (x, (c4, c5)) in out.iter_mut().zip(p4.iter().zip(p5)) {
            *x = 6.0 * *x + u * (24.0 * c4 + u * 60.0 * c5);
        }
        out
    }

    /// The point at `u` with direction and curvature over arc length.
    pub fn site(&self, main: &Main, u: f32) -> Site<AXES> {
        let [offset, first, second] = self.at(u);
        let speed = max(size(main, &first), f32::MIN_POSITIVE);
        let tangent = first.map(|x| x / speed);
        let along = dot(main, &second, &tangent);
        let curvature = plus(&second, -along, &tangent).map(|x| x / (speed * speed));
        Site { offset, tangent, curvature }
    }

    /// The point at `u`, with direction and curvature over a path of `path` mm per u.
    pub fn site_over(&self, path: f32, u: f32) -> Site<AXES> {
        let [offset, first, second] = self.at(u);
        let per = 1.0 / path;
        Site { offset, tangent: first.map(|x| x * per), curvature: second.map(|x| x * (per * per)) }
    }

    /// Largest relative excess of the speed along the curve over the path speed, at places between the ends.
    /// `path`: path length (mm) per unit of u. The speed of the feed axes is compared with the path speed.
    /// The speed of the main axes is compared with `space_per_path` times the path speed, if `space_per_path`
    /// is above 0.
    pub fn haste(&self, measure: &Measure, path: f32, space_per_path: f32) -> f32 {
        let mut most = 0.0;
        for u in PLACES {
            let first = self.first(u);
            let fed = measure.length(&first) / path;
            let space = path * space_per_path;
            let along = if space > 0.0 { size(&measure.main, &first) / space } else { 0.0 };
            most = max(most, max(fed, along) - 1.0);
        }
        most
    }

    /// Arc length from `u0` to `u1`: Gauss's rule with eight points.
    pub fn length(&self, main: &Main, u0: f32, u1: f32) -> f32 {
        let (middle, half) = (0.5 * (u0 + u1), 0.5 * (u1 - u0));
        let places = GAUSS.map(|(x, _)| middle + half * x);
        let squares = self.squares(main, &places);
        half * squares
            .iter()
            .zip(GAUSS)
            .fold(0.0, |sum, (square, (_, weight))| sum + weight * sqrt_f32(*square))
    }

    /// Largest relative difference of the speed along the curve from `speed`, above and below, at places
    /// between the ends.
    pub fn unevenness(&self, main: &Main, speed: f32) -> [f32; 2] {
        let [mut most, mut least] = [0.0, f32::MAX];
        for square in self.squares(main, &PLACES) {
            most = max(most, square);
            least = min(least, square);
        }
        [max(sqrt_f32(most) / speed - 1.0, 0.0), max(1.0 - sqrt_f32(least) / speed, 0.0)]
    }

    /// Whether the speed in the middle alone shows that [`Self::unevenness`] exceeds `even`, a small value.
    pub fn is_uneven(&self, main: &Main, speed: f32, even: f32) -> bool {
        let [square] = self.squares(main, &[0.5]);
        let off = square / (speed * speed) - 1.0;
        // Squares differ by twice the relative difference; the rest is for rounding.
        magnitude(off) > 2.01 * even + 4e-6
    }

    /// Squared distance of the place `u` from a point, over the main axes; and the halves of its first and
    /// second derivative with respect to u.
    #[cfg_attr(feature = "fast", inline(always))]
    fn seen(&self, main: &Main, point: &[f32; AXES], u: f32) -> [f32; 3] {
        let [p0, p1, p2, p3, p4, p5] = &self.power;
        let [mut square, mut along, mut slope, mut bend] = [0.0; 4];
        for k in main.of::<AXES>() {
            let get = |p: &[f32; AXES]| p.get(k).copied().unwrap_or(0.0);
            let [c1, c2, c3, c4, c5] = [get(p1), get(p2), get(p3), get(p4), get(p5)];
            let away = get(p0) + u * (c1 + u * (c2 + u * (c3 + u * (c4 + u * c5)))) - get(point);
            let first = c1 + u * (2.0 * c2 + u * (3.0 * c3 + u * (4.0 * c4 + u * 5.0 * c5)));
            let second = 2.0 * c2 + u * (6.0 * c3 + u * (12.0 * c4 + u * 20.0 * c5));
            square += away * away;
            along += away * first;
            slope += first * first;
            bend += away * second;
        }
        [square, along, slope + bend]
    }

    /// The parameter of the curve's point nearest to `point`; the search begins at `u`. Returns `None` as
    /// soon as a place with a squared distance of at most `most` is found.
    fn search(&self, main: &Main, point: &[f32; AXES], mut u: f32, most: f32) -> Option<f32> {
        for _ in 0..NEAREST_STEPS {
            let [square, along, slope] = self.seen(main, point, u);
            if square <= most {
                return None;
            }
            let next = if slope > 0.0 { min(max(u - along / slope, 0.0), 1.0) } else { u };
            let is_near = max(next - u, u - next) <= NEAR;
            u = next;
            if is_near {
                break;
            }
        }
        Some(u)
    }

    /// The parameter of the curve's point nearest to `point`; the search begins at `u`.
    pub fn nearest(&self, main: &Main, point: &[f32; AXES], u: f32) -> f32 {
        self.search(main, point, u, -1.0).unwrap_or(u)
    }

    /// Whether the distance of a point from the curve is at most `most`; the search begins at `u`.
    pub fn is_near(&self, main: &Main, point: &[f32; AXES], u: f32, most: f32) -> bool {
        // The foot on the tangent is never farther away than the nearest point of the curve.
        let (away, along) = (plus(&self.point(u), -1.0, point), self.first(u));
        let foot = u - dot(main, &away, &along) / max(dot(main, &along, &along), f32::MIN_POSITIVE);
        let there = self.point(min(max(foot, 0.0), 1.0));
        size(main, &plus(&there, -1.0, point)) <= most || self.distance(main, point, u, most) <= most
    }

    /// Distance of a point from the curve; the search begins at `u`. If the distance is surely at most
    /// `most`, the result may be any such value.
    pub fn distance(&self, main: &Main, point: &[f32; AXES], u: f32, most: f32) -> f32 {
        let nearest = self.search(main, point, u, SURELY * most * most);
        nearest.map_or(0.0, |u| size(main, &plus(&self.point(u), -1.0, point)))
    }
}

/// Margin for rounding.
const SURELY: f32 = 0.999;

/// Searches the largest distance between a curve and the contour that the curve replaces. The search measures
/// distances from places on the curve and from places on the contour. Each call examines a few places.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deviation {
    outward: Peak,
    inward: Peak,
    /// The search along the line over left-out blocks.
    across: Peak,
}

impl Deviation {
    /// A new search.
    pub const NEW: Self = Self { outward: Peak::NEW, inward: Peak::NEW, across: Peak::NEW };

    /// Continues the search; returns the deviation at the end of the search. `reach`: corner distances before
    /// and after the corner. `gap`: the vector over left-out blocks.
    pub fn go_on<const AXES: usize>(
        &mut self,
        main: &Main,
        curve: &Quintic<AXES>,
        sides: [&Side<AXES>; 2],
        reach: [f32; 2],
        gap: Option<&[f32; AXES]>,
    ) -> Option<f32> {
        let [before, behind] = sides;
        let past = |point: &[f32; AXES]| gap.map_or(*point, |gap| plus(point, -1.0, gap));
        let block = |place: f32| {
            if place < 0.0 { (before, place * reach[0]) } else { (behind, place * reach[1]) }
        };
        if !self.outward.is_found() {
            self.outward.climb(OUTWARD, |place, top| {
                let (q, s) = (curve.point(0.5 + 0.5 * place), block(place).1);
                let off_before = || before.distance(main, &q, (min(s, 0.0), -1.0), top);
                let off_behind = || behind.distance(main, &past(&q), (max(s, 0.0), 1.0), top);
                // If the curve is near one of the blocks, the other blocks do not matter.
                let mut off = if place < 0.0 { off_before() } else { off_behind() };
                if off > top {
                    off = min(off, if place < 0.0 { off_behind() } else { off_before() });
                }
                gap.filter(|_| off > top).map_or(off, |gap| min(off, segment_distance(main, gap, &q)))
            });
            return None;
        }
        if !self.inward.is_found() {
            self.inward.climb(INWARD, |place, top| {
                let (side, s) = block(place);
                let point = side.point(s);
                let point = gap.filter(|_| place > 0.0).map_or(point, |gap| plus(&point, 1.0, gap));
                curve.distance(main, &point, 0.5 + 0.5 * place, top)
            });
            return None;
        }
        let most = max(self.inward.top, self.outward.top);
        let Some(gap) = gap else { return Some(most) };
        // The ends of the line count too: the curve may be furthest from them.
        let over = |part: f32| gap.map(|x| part * x);
        self.across.climb(INWARD, |place, top| curve.distance(main, &over(0.5 + 0.5 * place), 0.5, top));
        if !self.across.is_found() {
            return None;
        }
        let most = max(most, self.across.top);
        let most = max(most, curve.distance(main, &over(0.0), 0.5, most));
        Some(max(most, curve.distance(main, &over(1.0), 0.5, most)))
    }
}

/// Searches the largest value of a function over −1…1. The search begins at the best of equally spaced
/// places. From there it tries both sides, in shorter and shorter steps.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Peak {
    /// Number of examined places.
    seen: u8,
    /// The two places from which the search goes uphill.
    around: f32,
    step: f32,
    top: f32,
    best: f32,
}

impl Peak {
    const NEW: Self = Self { seen: 0, around: 0.0, step: 1.0 / SAMPLES as f32, top: 0.0, best: 0.0 };

    const fn is_found(&self) -> bool {
        self.seen >= EVEN_PLACES + 2 * REFINEMENTS
    }

    /// Examines at most `places` more places. If a value is not above the largest one so far, `value` may
    /// return any number that is not above.
    fn climb(&mut self, places: u8, value: impl Fn(f32, f32) -> f32) {
        for _ in 0..places {
            if self.is_found() {
                return;
            }
            let place = self.next();
            let here = value(place, self.top);
            if here > self.top {
                (self.top, self.best) = (here, place);
            }
        }
    }

    fn next(&mut self) -> f32 {
        let seen = self.seen;
        self.seen += 1;
        if seen < EVEN_PLACES {
            // The search goes outward: the value is usually largest near the corner, and lower values need
            // not be known. The corner itself is left out.
            let away = f32::from(1 + seen / 2) * self.step;
            return if seen.is_multiple_of(2) { -away } else { away };
        }
        if (seen - EVEN_PLACES).is_multiple_of(2) {
            self.step *= 0.5;
            self.around = self.best;
            return self.around - self.step;
        }
        self.around + self.step
    }
}

/// Places per call. Each place on the curve is compared with two blocks.
const OUTWARD: u8 = 4;
const INWARD: u8 = 12;

/// Number of halvings of the step.
const REFINEMENTS: u8 = 4;

/// Newton's steps to the nearest point of a curve.
const NEAREST_STEPS: usize = 4;
/// If the last Newton step is below this value, the next step is about its square, which is negligible.
const NEAR: f32 = 1.0 / 2048.0;

/// Number of steps on each side of the corner, and of places between the steps at which the distance from an
/// arc is measured.
const SAMPLES: u8 = 8;
const EVEN_PLACES: u8 = 2 * SAMPLES - 2;

/// Rounding of derivatives, as a share of the path length: products of coefficients up to 60 with sums of 24
/// bits.
const HIDDEN: f32 = 1.0 / 1024.0;

/// Places between the ends at which speed is examined.
const PLACES: [f32; 9] = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9];

/// Gauss's rule of eight points: places and weights.
const GAUSS: [(f32, f32); 8] = [
    (-0.183_434_64, 0.362_683_78),
    (0.183_434_64, 0.362_683_78),
    (-0.525_532_4, 0.313_706_65),
    (0.525_532_4, 0.313_706_65),
    (-0.796_666_5, 0.222_381_03),
    (0.796_666_5, 0.222_381_03),
    (-0.960_289_84, 0.101_228_54),
    (0.960_289_84, 0.101_228_54),
];

/// The speed with which a [`Quintic`] between two sites moves evenly. The speed in the middle is then equal
/// to the speed at the ends, with Q' = 15/8·D − 7/16·v·(tA + tB) − v²·(kA − kB)/32. `space_per_path`:
/// distance in space per path distance.
pub fn even_speed<const AXES: usize>(
    main: &Main,
    a: &Site<AXES>,
    b: &Site<AXES>,
    space_per_path: f32,
) -> f32 {
    let travel = plus(&b.offset, -1.0, &a.offset);
    let both = plus(&a.tangent, 1.0, &b.tangent);
    let bend = plus(&a.curvature, -1.0, &b.curvature);
    let [along, across] = [&travel, &bend].map(|x| dot(main, x, &both));
    let [square, mixed, bent] =
        [(&travel, &travel), (&travel, &bend), (&bend, &bend)].map(|(a, b)| dot(main, a, b));
    let a = space_per_path * space_per_path - (49.0 / 256.0) * dot(main, &both, &both);
    let mut speed = 0.0;
    for _ in 0..3 {
        // The distance, less a part of the curvature.
        let part = speed * speed * (1.0 / 60.0);
        let b = (105.0 / 128.0) * (along - part * across);
        let c = (225.0 / 64.0) * (square - part * (2.0 * mixed - part * bent));
        speed = (sqrt_f32(max(b * b + a * c, 0.0)) - b) / a;
    }
    speed
}

//! One corner: how far the curve reaches into its blocks, and the elements it consists of.
//!
//! The curve is a polynomial of the fifth degree that leaves one block and enters the other with their directions and
//! curvatures, and with a speed over its parameter that makes it even: through a corner of 90° its arc length
//! goes with the parameter to 0.2 %. Two of them meet where the interim point is given. Elements are cut from it at
//! places of which position, direction and curvature are computed once for both neighbours, and each is again a
//! polynomial, now over its own arc length; as many of them as it takes for the right path speed.
use super::curve::{Main, Quintic, Side, Site, dot, even_speed, plus, size};
use crate::lookahead::{max, min};
use crate::math::float::to_f32;
use crate::path::poly::{Knot, poly};
use crate::path::{Element, End};
use crate::quantity::Position;

/// Largest relative difference between path speed and speed along the curve; half of it where the speed is to be
/// constant.
pub const EVEN: f32 = 9e-4;
/// See [`EVEN`].
pub const CONSTANT: f32 = 4e-4;

/// Part of a tolerance that is aimed at, and how closely: the rest is for rounding.
const AIM: f32 = 1.0 - 2e-4;
const NEAR: f32 = 1.2e-4;

/// Trials for a corner distance.
const TRIALS: usize = 16;

/// What of [`AIM`] is left to elements beside the curve.
const SLACK: f32 = 6e-5;

/// Largest sum of coefficients, mm: see [`mod@crate::path::poly`], where they grow by 2^5.
const HEAVIEST: f32 = 4096.0;

/// Elements of half a curve at most.
const MOST_PARTS: u32 = 16;

const LSB_32: f32 = 1.0 / (1u64 << 32) as f32;
const ONE_32: f32 = (1u64 << 32) as f32;
const ONE_40: f32 = (1u64 << 40) as f32;

/// What a corner lies between. Offsets are from the end of the block before it.
pub struct Corner<'a, const AXES: usize> {
    /// Main axes.
    pub main: &'a Main,
    /// The block before it.
    pub before: Side<AXES>,
    /// The block behind it.
    pub behind: Side<AXES>,
}

/// Tolerances of a corner, mm and degrees; a tracking tolerance of 0 is none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerance {
    /// Of the main axes; none where distances are given.
    pub path: Option<f32>,
    /// Of each other axis.
    pub track: f32,
}

impl<const AXES: usize> Corner<'_, AXES> {
    /// The curve from `a` before the corner to `b` behind it.
    fn curve(&self, a: &Site<AXES>, b: &Site<AXES>) -> Quintic<AXES> {
        Quintic::new(a, b, even_speed(self.main, a, b))
    }

    /// The curve with these corner distances.
    pub fn between(&self, [c1, c2]: [f32; 2]) -> Quintic<AXES> {
        self.curve(&self.before.at(-c1), &self.behind.at(c2))
    }

    /// How much of the tolerance a curve with these distances takes: 1 is all of it. And how far, mm, its elements may
    /// be beside it: they pass the place nearest to the corner, where the deviation mostly is largest. `along`: beside
    /// arcs it is looked for elsewhere too, which is a hundred times the work.
    fn use_of(&self, tolerance: &Tolerance, [c1, c2]: [f32; 2], along: bool) -> (f32, f32) {
        let curve = self.between([c1, c2]);
        let (mut most, mut slack) = (0.0, f32::MAX);
        if let Some(path) = tolerance.path {
            let mut off = curve.distance(self.main, &[0.0; AXES], 0.5);
            if along {
                let elsewhere = curve.deviation(self.main, [&self.before, &self.behind], [c1, c2]);
                off = max(off, elsewhere);
                slack = max(path - elsewhere, SLACK * path);
            }
            most = off / path;
        }
        if tolerance.track > 0.0 {
            let [middle, ..] = curve.at(0.5);
            for (_, x) in middle.iter().enumerate().filter(|(k, _)| !self.main.contains(&Some(*k))) {
                most = max(most, max(*x, -*x) / tolerance.track);
            }
        }
        (most, slack)
    }

    /// The largest part, at most 1, of the distances with which the curve stays inside the tolerance, and how far its
    /// elements may be beside it. Blocks left out between the two are neglected.
    pub fn reach(&self, tolerance: &Tolerance, distances: [f32; 2]) -> Option<(f32, f32)> {
        let (first, slack) = self.search(tolerance, distances, false)?;
        if tolerance.path.is_none() || (self.before.rate == 0.0 && self.behind.rate == 0.0) {
            return Some((first, slack));
        }
        // Mostly that is it.
        let (second, slack) = self.search(tolerance, distances.map(|c| c * first), true)?;
        Some((first * second, slack))
    }

    /// Regula falsi with the Illinois rule.
    fn search(&self, tolerance: &Tolerance, distances: [f32; 2], along: bool) -> Option<(f32, f32)> {
        let scaled = |part: f32| distances.map(|c| c * part);
        let (whole, slack) = self.use_of(tolerance, distances, along);
        if whole <= AIM + NEAR {
            return Some((1.0, slack));
        }
        let mut room = 0.0;
        let ([mut low, mut high], [mut under, mut over]) = ([0.0, 1.0], [-AIM, whole - AIM]);
        let mut side = 0;
        for _ in 0..TRIALS {
            let part = low + (high - low) * (-under / (over - under));
            let (used, slack) = self.use_of(tolerance, scaled(part), along);
            let off = used - AIM;
            if off > 0.0 {
                (high, over) = (part, off);
                if side == 1 {
                    under *= 0.5;
                }
                side = 1;
            } else {
                (low, under, room) = (part, off, slack);
                if side == -1 {
                    over *= 0.5;
                }
                side = -1;
            }
            if off > -NEAR && off < NEAR {
                return Some((part, slack));
            }
        }
        // Not that near, but inside.
        if low > 0.0 { Some((low, room)) } else { None }
    }
}

/// A curve that is handed out element by element.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Course<const AXES: usize> {
    main: Main,
    origin: [Position; AXES],
    /// Both halves, and the part of each that belongs to the course.
    halves: [(Quintic<AXES>, [f32; 2]); 2],
    /// Where the last element ended, and its site.
    at: Knot<AXES>,
    last: Knot<AXES>,
    /// Elements of each half, and those handed out of both.
    parts: u32,
    done: u32,
}

/// Length of the halves of a course through a given point that is tried first, and how often it is improved.
const LENGTHS: usize = 3;

impl<const AXES: usize> Course<AXES> {
    /// The curve between two knots; offsets are from `origin`. Through `interim` if that is given. The path speed in
    /// its elements is right to `even` (relative), and they are at most `slack` (mm) beside it. `None` where it cannot be made.
    pub fn new(
        main: &Main,
        origin: &[Position; AXES],
        from: &Knot<AXES>,
        to: &Knot<AXES>,
        interim: Option<&[f32; AXES]>,
        [even, slack]: [f32; 2],
    ) -> Option<Self> {
        let [a, b] = [from, to].map(|knot| site_of(knot, origin));
        let halves = if let Some(point) = interim {
            let [first, second] = through(main, &a, point, &b)?;
            [(first, [0.0, 1.0]), (second, [0.0, 1.0])]
        } else {
            let speed = even_speed(main, &a, &b);
            if speed <= 0.0 {
                return None;
            }
            let curve = Quintic::new(&a, &b, speed);
            // The joint is where the curve is nearest to the corner: there the elements are exactly as far as planned.
            let u = min(max(curve.nearest(main, &[0.0; AXES], 0.5), 0.25), 0.75);
            [(curve, [0.0, u]), (curve, [u, 1.0])]
        };
        let mut course =
            Self { main: *main, origin: *origin, halves, at: *from, last: *to, parts: 1, done: 0 };
        while !course.is_fine(even, slack) {
            if course.parts >= MOST_PARTS {
                // Through a given point the curve is what it is.
                return if interim.is_some() && course.fits() { Some(course) } else { None };
            }
            course.parts *= 2;
        }
        Some(course)
    }

    /// The curve of element `i`, and its parameter at the share `t` of the element.
    fn place(&self, i: u32, t: f32) -> (&Quintic<AXES>, f32) {
        let [first, second] = &self.halves;
        let ((curve, [u0, u1]), within) = if i < self.parts { (first, i) } else { (second, i - self.parts) };
        (curve, u0 + (u1 - u0) * ((within as f32 + t) / self.parts as f32))
    }

    /// Ends and arc length of element `i`.
    fn part(&self, i: u32) -> ([Site<AXES>; 2], f32) {
        let ((curve, u0), (_, u1)) = (self.place(i, 0.0), self.place(i, 1.0));
        ([u0, u1].map(|u| curve.site(&self.main, u)), curve.length(&self.main, u0, u1))
    }

    /// Whether all elements have the right path speed, and are not too far beside the curve.
    fn is_fine(&self, even: f32, slack: f32) -> bool {
        (0..2 * self.parts).all(|i| {
            let ([a, b], length) = self.part(i);
            let element = Quintic::new(&a, &b, length);
            let [above, below] = element.unevenness(&self.main, length);
            let beside = |t: f32| {
                let (curve, u) = self.place(i, t);
                curve.distance(&self.main, &element.at(t)[0], u)
            };
            element.weight() < HEAVIEST
                && max(above, below) <= even
                && (slack == f32::MAX || max(max(beside(0.25), beside(0.5)), beside(0.75)) <= slack)
        })
    }

    /// Whether the format of a polynomial holds every element.
    fn fits(&self) -> bool {
        (0..2 * self.parts).all(|i| {
            let ([a, b], length) = self.part(i);
            Quintic::new(&a, &b, length).weight() < HEAVIEST
        })
    }

    /// Whether the next element belongs to the first half.
    pub fn is_before(&self) -> bool {
        self.done < self.parts
    }

    /// Whether all elements are handed out.
    pub fn is_done(&self) -> bool {
        self.done >= 2 * self.parts
    }
}

impl<const AXES: usize> Iterator for Course<AXES> {
    type Item = Element<AXES>;

    fn next(&mut self) -> Option<Element<AXES>> {
        if self.is_done() {
            return None;
        }
        let ([a, b], length) = self.part(self.done);
        let [above, _] = Quintic::new(&a, &b, length).unevenness(&self.main, length);
        self.done += 1;
        let to = if self.is_done() { self.last } else { knot_of(&b, &self.origin) };
        let from = core::mem::replace(&mut self.at, to);
        poly(&from, &to, length, 1.0 + 1.25 * above + 1e-6)
    }
}

/// Two polynomials that meet at a point with as many derivatives in common as they have to spare: four. Their arc
/// lengths follow in a few rounds, beginning with the straight lines.
fn through<const AXES: usize>(
    main: &Main,
    a: &Site<AXES>,
    point: &[f32; AXES],
    b: &Site<AXES>,
) -> Option<[Quintic<AXES>; 2]> {
    let travel = [plus(point, -1.0, &a.offset), plus(&b.offset, -1.0, point)];
    let chords = [size(main, &travel[0]), size(main, &travel[1])];
    let mut lengths = chords;
    let mut curves = None;
    for _ in 0..=LENGTHS {
        let [h1, h2] = lengths;
        if h1 <= 0.0 || h2 <= 0.0 {
            return None;
        }
        let (r1, r2) = (1.0 / h1, 1.0 / h2);
        // Third and fourth derivative of both at the point agree: two equations for slope and second derivative.
        let m11 = 36.0 * (r2 * r2 - r1 * r1);
        let m12 = 9.0 * (r1 + r2);
        let m21 = -192.0 * (r1 * r1 * r1 + r2 * r2 * r2);
        let m22 = -m11;
        let det = m11 * m22 - m12 * m21;
        let mut middle = Site { offset: *point, tangent: [0.0; AXES], curvature: [0.0; AXES] };
        for k in 0..AXES {
            let get = |x: &[f32; AXES]| x.get(k).copied().unwrap_or(0.0);
            let (d1, d2) = (get(&travel[0]) * r1, get(&travel[1]) * r2);
            let (t0, t3, k0, k3) = (get(&a.tangent), get(&b.tangent), get(&a.curvature), get(&b.curvature));
            let e1 = 60.0 * (d2 * r2 * r2 - d1 * r1 * r1) - 24.0 * (t3 * r2 * r2 - t0 * r1 * r1)
                + 3.0 * (k3 * r2 + k0 * r1);
            let e2 = -360.0 * (d2 * r2 * r2 * r2 + d1 * r1 * r1 * r1)
                + 168.0 * (t3 * r2 * r2 * r2 + t0 * r1 * r1 * r1)
                - 24.0 * (k3 * r2 * r2 - k0 * r1 * r1);
            if let (Some(t), Some(c)) = (middle.tangent.get_mut(k), middle.curvature.get_mut(k)) {
                *t = (e1 * m22 - m12 * e2) / det;
                *c = (m11 * e2 - m21 * e1) / det;
            }
        }
        let first = Quintic::new(a, &middle, h1);
        let second = Quintic::new(&middle, b, h2);
        // No longer than twice the way: what is longer would swing out the further.
        lengths = [
            min(first.length(main, 0.0, 1.0), 2.0 * chords[0]),
            min(second.length(main, 0.0, 1.0), 2.0 * chords[1]),
        ];
        curves = Some([first, second]);
    }
    curves
}

fn site_of<const AXES: usize>(knot: &Knot<AXES>, origin: &[Position; AXES]) -> Site<AXES> {
    let mut offset = [0.0; AXES];
    for (offset, (x, origin)) in offset.iter_mut().zip(knot.position.iter().zip(origin)) {
        *offset = to_f32(x.to_bits().wrapping_sub(origin.to_bits())) * LSB_32;
    }
    Site { offset, tangent: knot.end.tangent.map(|t| to_f32(t) / ONE_40), curvature: knot.end.curvature }
}

fn knot_of<const AXES: usize>(site: &Site<AXES>, origin: &[Position; AXES]) -> Knot<AXES> {
    let mut position = *origin;
    for (x, offset) in position.iter_mut().zip(site.offset) {
        *x = Position::from_bits(x.to_bits().saturating_add((offset * ONE_32) as i64));
    }
    let end = End { tangent: site.tangent.map(|t| (t * ONE_40) as i64), curvature: site.curvature };
    Knot { position, end }
}

/// Directions before and behind a corner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turn {
    /// Half the angle it turns by, as sine and cosine: over the main axes.
    pub sine: f32,
    /// See there.
    pub cosine: f32,
    /// Largest change of slope of the other axes.
    pub track: f32,
}

/// `None` where main axes do not move as far as the path on both sides.
pub fn turn<const AXES: usize>(main: &Main, before: &[f32; AXES], behind: &[f32; AXES]) -> Option<Turn> {
    let whole = |t: &[f32; AXES]| {
        let square = dot(main, t, t);
        square > 1.0 - 1e-4 && square < 1.0 + 1e-4
    };
    if !whole(before) || !whole(behind) {
        return None;
    }
    let (change, both) = (plus(behind, -1.0, before), plus(behind, 1.0, before));
    let mut track = 0.0;
    for (_, x) in change.iter().enumerate().filter(|(k, _)| !main.contains(&Some(*k))) {
        track = max(track, max(*x, -*x));
    }
    Some(Turn { sine: 0.5 * size(main, &change), cosine: min(0.5 * size(main, &both), 1.0), track })
}

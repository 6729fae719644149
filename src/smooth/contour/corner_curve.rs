//! The curve of a corner over its arc length, cut into elements.
//!
//! One polynomial of the fifth degree, or two that meet where the interim point is given. Elements are cut
//! from it at places of which position, direction and curvature are computed once for both neighbours, and
//! each is again a polynomial, now over its own arc length; as many of them as it takes for the right path
//! speed.
//!
//! Where the feed counts along other axes than the main ones, a path distance is another way in space on
//! either side of the corner. There path is the polynomial's own parameter: its speed goes over from the one
//! to the other, and both halves are one element each.
use super::corner::mean;
use super::curve::{Main, Quintic, Site, even_speed, plus, size};
use super::{LSB_32, ONE_32};
use crate::math::float::{max, min, to_f32, to_i64};
use crate::path::poly::{Draft, Knot};
use crate::path::{Bounds, Element, End, Measure};
use crate::quantity::{Distance, Position};

/// Largest relative difference between path speed and speed along the curve; a third of it, up or down, where
/// the speed is to be constant.
pub const EVEN: f32 = 9e-4;
/// See [`EVEN`].
pub const CONSTANT: f32 = 3e-4;

/// Largest sum of coefficients, mm: see [`mod@crate::path::poly`], where they grow by 2^5.
pub const HEAVIEST: f32 = 4096.0;

/// Elements of half a curve at most.
const MOST_PARTS: u32 = 16;

/// Elements of which it is kept what was seen of them: as many as mostly are enough.
const SEEN: usize = 16;
/// Of a curve through a given point, which is seldom: in a small build each is looked at again.
const SEEN_GIVEN: usize = if cfg!(any(feature = "surface", feature = "splines")) { SEEN } else { 0 };

/// Steps of half a curve through a given point, at which it may be cut, and elements of all of it at most.
const STEPS: u16 = 256;
const MOST_CUTS: usize = 96;

const ONE_40: f32 = (1u64 << 40) as f32;

/// A curve that is handed out element by element.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CornerCurve<const AXES: usize> {
    /// Way in space per path distance before and behind the corner.
    spaces_per_path: [f32; 2],
    origin: [Position; AXES],
    /// All of it, or the first half of one through a given point.
    curve: Quintic<AXES>,
    kept: Kept<AXES>,
    /// Where path is the parameter: mm per u of both.
    path: Option<[f32; 2]>,
    /// Where the last element ended, and its site.
    at: Knot<AXES>,
    last: Knot<AXES>,
    /// Elements of each half, and those of both that are found fine, later those handed out.
    parts: u32,
    done: u32,
    /// More elements would not help: they only have to fit the format.
    any: bool,
    /// Where the element looked at last ends.
    seam: Seam<AXES>,
}

/// What is kept of a curve beside its polynomial.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Kept<const AXES: usize> {
    /// Where its halves meet. And of the first elements: path length, and how far its speed is above what that says.
    /// 0: not known.
    Whole { joint: f32, seen: [[f32; 2]; SEEN] },
    /// Through a given point: its second half. The curve is what it is, and may bend sharply in places. There its
    /// elements are the shorter.
    Given { second: Quintic<AXES>, cuts: Cuts, seen: [[f32; 2]; SEEN_GIVEN] },
}

/// The end of one element, where another one of the same half begins.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Seam<const AXES: usize> {
    /// Number of the one that begins there; that of none if it is not known.
    of: u32,
    /// The one before belongs to the first half.
    is_first: bool,
    site: Site<AXES>,
}

/// An element before it is made.
pub struct Rehearsal<const AXES: usize> {
    /// Whether the element belongs to the block before the corner.
    pub is_first: bool,
    /// Path length, mm.
    pub length: f32,
    /// Speed along it per path speed at most.
    pub fastest: f32,
    ends: [Site<AXES>; 2],
}

impl<const AXES: usize> Rehearsal<AXES> {
    /// Bounds of its derivatives ([`Quintic::hull`]).
    pub fn hull(&self) -> [[f32; AXES]; 3] {
        let [from, to] = &self.ends;
        Quintic::new(from, to, self.length).hull(self.length)
    }
}

/// What an element is of the curve of its half.
struct Portion<'a, const AXES: usize> {
    curve: &'a Quintic<AXES>,
    /// It is the first half.
    is_first: bool,
    /// The part of the curve that belongs to the course.
    span: [f32; 2],
    /// Of that, where it begins and how much it is, in so many steps of all of it.
    steps: [f32; 2],
    of: f32,
}

impl<const AXES: usize> Portion<'_, AXES> {
    /// The curve's parameter at the share `t` of it.
    fn at(&self, t: f32) -> f32 {
        let ([u0, u1], [from, more]) = (self.span, self.steps);
        u0 + (u1 - u0) * ((from + more * t) / self.of)
    }
}

/// Where a curve through a given point is cut.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Cuts {
    /// Steps of each element, less one.
    steps: [u8; MOST_CUTS],
    /// How many elements there are, and steps of the one that is tried behind them.
    count: u8,
    step: u16,
}

impl Cuts {
    /// Both halves are tried whole.
    const NEW: Self = Self { steps: [0; MOST_CUTS], count: 0, step: STEPS };

    /// Evenly, as often as any other curve.
    const EVEN: Self = Self {
        steps: [(STEPS / MOST_PARTS as u16 - 1) as u8; MOST_CUTS],
        count: 2 * MOST_PARTS as u8,
        step: 0,
    };

    /// Both ends of element `i`, in steps over both halves.
    fn ends(&self, i: u32) -> [u16; 2] {
        let whole = self.steps.iter().take(i.min(u32::from(self.count)) as usize);
        let from = whole.fold(0, |sum, steps| sum + u16::from(*steps) + 1);
        let steps = if i < u32::from(self.count) {
            self.steps.get(i as usize).map_or(0, |steps| u16::from(*steps) + 1)
        } else {
            self.step
        };
        [from, from + steps]
    }

    /// What is tried is fine: the next one may be twice as long, as far as its half goes. Whether there is no
    /// next one.
    fn accept(&mut self) -> bool {
        let [_, to] = self.ends(u32::from(self.count));
        if let Some(steps) = self.steps.get_mut(usize::from(self.count)) {
            *steps = (self.step - 1) as u8;
            self.count += 1;
        }
        self.step = (2 * self.step).min(STEPS - to % STEPS);
        to >= 2 * STEPS
    }

    /// It is not: half as long. Whether it can be tried.
    fn shorten(&mut self) -> bool {
        self.step /= 2;
        self.step > 0
    }

    /// Whether there is no room for another element.
    fn is_full(&self) -> bool {
        usize::from(self.count) >= MOST_CUTS
    }
}

/// The result of a step of fitting.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fit {
    /// There is more to do.
    Working,
    /// The course is ready to be handed out.
    Ready,
    /// It cannot be made.
    Failed,
}

/// Length of the halves of a course through a given point that is tried first, and how often it is improved.
const LENGTHS: usize = 3;

impl<const AXES: usize> CornerCurve<AXES> {
    /// A curve between two knots, whose halves are made by [`Self::lay`]; `given`: through a given point. Inline, in
    /// every build: it is made where it stays.
    #[inline(always)]
    pub fn new(
        spaces_per_path: [f32; 2],
        origin: &[Position; AXES],
        [from, to]: [&Knot<AXES>; 2],
        given: bool,
    ) -> Self {
        Self {
            spaces_per_path,
            origin: *origin,
            curve: Quintic::NONE,
            kept: if given {
                Kept::Given { second: Quintic::NONE, cuts: Cuts::NEW, seen: [[0.0; 2]; SEEN_GIVEN] }
            } else {
                Kept::Whole { joint: 0.5, seen: [[0.0; 2]; SEEN] }
            },
            path: None,
            at: *from,
            last: *to,
            parts: 1,
            done: 0,
            any: false,
            seam: Seam { of: u32::MAX, is_first: true, site: Site::NONE },
        }
    }

    /// Makes both halves, through `interim` if that is given. `lead`: the path between both ends, where a master
    /// axis is the path. Whether it can be made. Before it is handed out: [`Self::fit`].
    #[inline(never)]
    pub fn lay(&mut self, measure: &Measure, interim: Option<&[f32; AXES]>, lead: Option<f32>) -> bool {
        let main = &measure.main;
        let a = site_of(&self.at, &self.origin);
        // What begins at no element stands in for the end.
        self.seam.site = site_of(&self.last, &self.origin);
        let b = &self.seam.site;
        let space_per_path = mean(self.spaces_per_path);
        if space_per_path <= 0.0 && lead.is_none() {
            return false;
        }
        let curve = &mut self.curve;
        let path = match (&mut self.kept, interim) {
            (Kept::Given { second, .. }, Some(point)) => {
                let Some(lengths) = through(main, &a, point, b, space_per_path, [curve, second]) else {
                    return false;
                };
                lengths
            }
            (Kept::Whole { joint, .. }, _) => {
                let speed = lead.unwrap_or_else(|| even_speed(main, &a, b, space_per_path));
                if speed <= 0.0 {
                    return false;
                }
                *curve = Quintic::new(&a, b, speed);
                // The joint is where the curve is nearest to the corner: there the elements are exactly as far as
                // planned. A master axis has reached the corner's coordinate.
                let nearest = || min(max(curve.nearest(main, &[0.0; AXES], 0.5), 0.25), 0.75);
                *joint = if lead.is_some() { 0.5 } else { nearest() };
                [speed; 2]
            }
            _ => return false,
        };
        self.path = (!measure.is_space()).then_some(path);
        true
    }

    /// Start and end of the curve, before it is handed out.
    pub fn ends(&self) -> [&Knot<AXES>; 2] {
        [&self.at, &self.last]
    }

    /// Continues by one element to cut the curve into as few as possible. Their path speed is right to `even`
    /// (relative), and they deviate by at most `slack` (mm).
    pub fn fit(&mut self, measure: &Measure, even: f32, slack: f32) -> Fit {
        if self.cuts().is_some() && !self.any {
            return self.fit_given(measure, even);
        }
        if self.is_fine(measure, self.done, even, slack) {
            self.done += 1;
            if !self.is_done() {
                return Fit::Working;
            }
            self.done = 0;
            return Fit::Ready;
        }
        if self.any || self.parts >= MOST_PARTS {
            return Fit::Failed;
        }
        self.done = 0;
        self.parts *= 2;
        Fit::Working
    }

    /// Goes on to cut a curve through a given point. What no number of elements makes even is as even as it
    /// can be.
    fn fit_given(&mut self, measure: &Measure, even: f32) -> Fit {
        let next = self.cuts().filter(|cuts| !cuts.is_full()).map(|cuts| u32::from(cuts.count));
        let fits = next.is_some_and(|i| self.is_fine(measure, i, even, f32::MAX));
        let Kept::Given { cuts, .. } = &mut self.kept else { return Fit::Failed };
        if fits {
            return if cuts.accept() { Fit::Ready } else { Fit::Working };
        }
        if cuts.is_full() || !cuts.shorten() {
            (self.any, *cuts) = (true, Cuts::EVEN);
        }
        Fit::Working
    }

    /// Where it is cut, through a given point.
    const fn cuts(&self) -> Option<&Cuts> {
        match &self.kept {
            Kept::Given { cuts, .. } => Some(cuts),
            Kept::Whole { .. } => None,
        }
    }

    /// Elements of both halves.
    fn count(&self) -> u32 {
        self.cuts().map_or(2 * self.parts, |cuts| u32::from(cuts.count))
    }

    /// What of the curve element `i` is.
    fn portion(&self, i: u32) -> Portion<'_, AXES> {
        match &self.kept {
            Kept::Given { second, cuts, .. } => {
                let [from, to] = cuts.ends(i);
                let is_first = from < STEPS;
                let (curve, start) = if is_first { (&self.curve, 0) } else { (second, STEPS) };
                let steps = [f32::from(from - start), f32::from(to.saturating_sub(from))];
                Portion { curve, is_first, span: [0.0, 1.0], steps, of: f32::from(STEPS) }
            }
            Kept::Whole { joint, .. } => {
                let is_first = i < self.parts;
                let (span, within) =
                    if is_first { ([0.0, *joint], i) } else { ([*joint, 1.0], i - self.parts) };
                let steps = [within as f32, 1.0];
                Portion { curve: &self.curve, is_first, span, steps, of: self.parts as f32 }
            }
        }
    }

    /// Whether element `i` belongs to the first half.
    fn is_first(&self, i: u32) -> bool {
        match self.cuts() {
            Some(cuts) => cuts.ends(i)[0] < STEPS,
            None => i < self.parts,
        }
    }

    /// Path length of a portion.
    fn length(&self, measure: &Measure, portion: &Portion<'_, AXES>) -> f32 {
        let [u0, u1] = [0.0, 1.0].map(|t| portion.at(t));
        match self.path_of(portion) {
            Some(path) => path * (u1 - u0),
            None => portion.curve.length(&measure.main, u0, u1),
        }
    }

    /// Both ends of element `i`, which is this portion.
    fn sites(&self, measure: &Measure, i: u32, portion: &Portion<'_, AXES>) -> [Site<AXES>; 2] {
        let Seam { of, is_first, site } = &self.seam;
        let begins = *of == i && *is_first == portion.is_first;
        [if begins { *site } else { self.site(measure, portion, 0.0) }, self.site(measure, portion, 1.0)]
    }

    /// The point of a portion at the share `t` of it.
    fn site(&self, measure: &Measure, portion: &Portion<'_, AXES>, t: f32) -> Site<AXES> {
        let u = portion.at(t);
        match self.path_of(portion) {
            Some(path) => portion.curve.site_over(path, u),
            None => portion.curve.site(&measure.main, u),
        }
    }

    /// Where path is the parameter: mm per u in a portion.
    fn path_of(&self, portion: &Portion<'_, AXES>) -> Option<f32> {
        self.path.map(|[first, second]| if portion.is_first { first } else { second })
    }

    /// How far the speed along an element is above and below what its path says at most, relative.
    fn unevenness(&self, measure: &Measure, element: &Quintic<AXES>, length: f32) -> [f32; 2] {
        if self.path.is_some() {
            let [before, behind] = self.spaces_per_path;
            return [element.haste(measure, length, max(before, behind)), 0.0];
        }
        element.unevenness(&measure.main, length)
    }

    /// Whether element `i` has the right path speed, and is not too far beside the curve.
    fn is_fine(&mut self, measure: &Measure, i: u32, even: f32, slack: f32) -> bool {
        let portion = self.portion(i);
        let ([a, b], length) = (self.sites(measure, i, &portion), self.length(measure, &portion));
        let element = Quintic::new(&a, &b, length);
        let is_first = portion.is_first;
        let counts = !self.any && self.path.is_none();
        if counts && element.is_uneven(&measure.main, length, even) {
            self.seam = Seam { of: i, is_first, site: a };
            return false;
        }
        let is_near = |t: f32| portion.curve.is_near(&measure.main, &element.point(t), portion.at(t), slack);
        let (mut is_fine, mut seen) = (false, None);
        if element.weight() < HEAVIEST {
            let [above, below] = self.unevenness(measure, &element, length);
            let is_even = max(above, below) <= even;
            // Over its own parameter an element is a part of the curve.
            is_fine =
                !counts || (is_even && (slack == f32::MAX || [0.25, 0.5, 0.75].into_iter().all(is_near)));
            seen = Some([length, above]);
        }
        let kept = match &mut self.kept {
            Kept::Whole { seen, .. } => seen.as_mut_slice(),
            Kept::Given { seen, .. } => seen.as_mut_slice(),
        };
        if let (Some(kept), Some(seen)) = (kept.get_mut(i as usize), seen) {
            *kept = seen;
        }
        // What is not fine is tried again from the same place, or all of it from the begin.
        self.seam = Seam { of: if is_fine { i + 1 } else { i }, is_first, site: if is_fine { b } else { a } };
        is_fine
    }

    /// Path length of element `i`, and how far its speed is above what that says.
    fn known(&self, measure: &Measure, i: u32) -> [f32; 2] {
        let seen = match &self.kept {
            Kept::Whole { seen, .. } => seen.as_slice(),
            Kept::Given { seen, .. } => seen.as_slice(),
        };
        match seen.get(i as usize) {
            Some(seen) if seen[0] > 0.0 => *seen,
            _ => self.look_at(measure, i),
        }
    }

    /// The same of one that is not kept.
    #[cold]
    #[inline(never)]
    fn look_at(&self, measure: &Measure, i: u32) -> [f32; 2] {
        let portion = self.portion(i);
        let ([a, b], length) = (self.sites(measure, i, &portion), self.length(measure, &portion));
        [length, self.unevenness(measure, &Quintic::new(&a, &b, length), length)[0]]
    }

    /// Whether the next element belongs to the first half.
    pub fn is_before(&self) -> bool {
        self.is_first(self.done)
    }

    /// End of the last element.
    pub fn stands(&self) -> &[Position; AXES] {
        &self.at.position
    }

    /// No further element is handed out; where the curve ends.
    pub fn finish(&mut self) -> &[Position; AXES] {
        self.done = self.count();
        self.at = self.last;
        &self.last.position
    }

    /// Whether all elements are handed out.
    pub fn is_done(&self) -> bool {
        self.done >= self.count()
    }
}

impl<const AXES: usize> CornerCurve<AXES> {
    /// The first element after the joint of both halves.
    pub fn behind_joint(&self) -> u32 {
        match self.cuts() {
            Some(_) => (0..self.count()).find(|i| !self.is_first(*i)).unwrap_or(0),
            None => self.parts,
        }
    }

    /// Element `i`, but for the last bit of its ends. `None` after the last one.
    pub fn rehearse(&mut self, measure: &Measure, i: u32) -> Option<Rehearsal<AXES>> {
        if i >= self.count() {
            return None;
        }
        let [length, above] = self.known(measure, i);
        let portion = self.portion(i);
        let (is_first, ends) = (portion.is_first, self.sites(measure, i, &portion));
        self.seam = Seam { of: i + 1, is_first, site: ends[1] };
        Some(Rehearsal { is_first, length, fastest: fastest(above), ends })
    }

    /// Length and bounds of an element; `None` if it cannot be made.
    pub fn bounds(&self, element: &Rehearsal<AXES>) -> Option<(Distance, Bounds<AXES>)> {
        let [from, to] = &element.ends.map(|site| knot_of(&site, &self.origin));
        Bounds::between(from, to, element.length, element.fastest)
    }

    /// The next element, with its axes to be made.
    pub fn next_element(&mut self, measure: &Measure, element: &mut Element<AXES>) -> Option<Draft<AXES>> {
        if self.is_done() {
            return None;
        }
        let i = self.done;
        let [length, above] = self.known(measure, i);
        self.done += 1;
        let to = if self.is_done() {
            self.last
        } else {
            knot_of(&self.site(measure, &self.portion(i), 1.0), &self.origin)
        };
        let made = Draft::begin(element, [&self.at, &to], length, fastest(above))?;
        self.at = to;
        Some(made)
    }
}

/// Two polynomials that meet at a point with as many derivatives in common as they have to spare: four. Their
/// path lengths follow in a few rounds, beginning with the straight lines. `space_per_path`: of the path in
/// space. Made in their places; both lengths. `None` where they cannot be made.
#[inline(never)]
fn through<const AXES: usize>(
    main: &Main,
    a: &Site<AXES>,
    point: &[f32; AXES],
    b: &Site<AXES>,
    space_per_path: f32,
    [first, second]: [&mut Quintic<AXES>; 2],
) -> Option<[f32; 2]> {
    let travel = [plus(point, -1.0, &a.offset), plus(&b.offset, -1.0, point)];
    let chords = [size(main, &travel[0]) / space_per_path, size(main, &travel[1]) / space_per_path];
    let mut lengths = chords;
    for round in 0..=LENGTHS {
        let [h1, h2] = lengths;
        if h1 <= 0.0 || h2 <= 0.0 {
            return None;
        }
        let (r1, r2) = (1.0 / h1, 1.0 / h2);
        // Third and fourth derivative of both at the point agree: two equations for slope and second
        // derivative.
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
        *first = Quintic::new(a, &middle, h1);
        *second = Quintic::new(&middle, b, h2);
        if round == LENGTHS {
            break;
        }
        // No longer than twice the way: what is longer would swing out the further.
        lengths = [
            min(first.length(main, 0.0, 1.0) / space_per_path, 2.0 * chords[0]),
            min(second.length(main, 0.0, 1.0) / space_per_path, 2.0 * chords[1]),
        ];
    }
    Some(lengths)
}

/// Speed along an element per path speed at most, from what is seen of it at some places.
pub fn fastest(above: f32) -> f32 {
    1.0 + 1.25 * above + 1e-6
}

/// A knot as a site; offsets are from `origin`.
pub fn site_of<const AXES: usize>(knot: &Knot<AXES>, origin: &[Position; AXES]) -> Site<AXES> {
    let mut offset = [0.0; AXES];
    for (offset, (x, origin)) in offset.iter_mut().zip(knot.position.iter().zip(origin)) {
        *offset = to_f32(x.to_bits().wrapping_sub(origin.to_bits())) * LSB_32;
    }
    Site { offset, tangent: knot.end.tangent.map(|t| to_f32(t) / ONE_40), curvature: knot.end.curvature }
}

/// A site as a knot.
pub fn knot_of<const AXES: usize>(site: &Site<AXES>, origin: &[Position; AXES]) -> Knot<AXES> {
    let mut position = *origin;
    for (x, offset) in position.iter_mut().zip(site.offset) {
        *x = Position::from_bits(x.to_bits().saturating_add(to_i64(offset * ONE_32)));
    }
    let end = End { tangent: site.tangent.map(|t| to_i64(t * ONE_40)), curvature: site.curvature };
    Knot { position, end }
}

//! Makes the curve of a corner over its arc length, and cuts the curve into elements.
//!
//! The curve is one polynomial of the fifth degree. With POS, there are two such polynomials, which meet at
//! the given interim point. Each element is a polynomial over its own arc length. The required accuracy of
//! the path speed decides how many elements there are. Position, direction and curvature at a cut are
//! computed once, for the elements on both sides.
//!
//! If the feed axes are not the main axes, path length is not distance in space. The same path length then
//! means different distances in space before and after the corner. In this case the polynomial's parameter
//! serves as path length, and each half of the curve is one element. The speed in space changes inside the
//! curve.
use super::corner::mean;
use super::curve::{Main, Quintic, Site, even_speed, plus, size};
use super::{LSB_32, ONE_32};
use crate::math::float::{max, min, to_f32, to_i64};
use crate::path::poly::{Draft, Knot};
use crate::path::{Bounds, Element, End, Measure};
use crate::quantity::{Distance, Position};

/// Largest relative difference between path speed and speed along the curve.
pub const EVEN: f32 = 9e-4;
/// The same limit if the program demands constant speed (CONST_VEL): a third of [`EVEN`].
pub const CONSTANT: f32 = 3e-4;

/// Largest [`Quintic::weight`] of an element, mm. [`mod@crate::path::poly`] stores the coefficients as
/// integers scaled by 2^5, which limits their size.
pub const HEAVIEST: f32 = 4096.0;

/// Largest number of elements in half a curve.
const MOST_PARTS: u32 = 16;

/// Number of elements with stored length and speed. A curve usually has fewer elements.
const SEEN: usize = 16;
/// The same number for a curve through a given point, which is rare. A small build computes each element
/// again.
const SEEN_GIVEN: usize = if cfg!(any(feature = "surface", feature = "splines")) { SEEN } else { 0 };

/// Number of steps in half a curve through a given point; a cut is possible at each step. The second value is
/// the largest number of elements.
const STEPS: u16 = 256;
const MOST_CUTS: usize = 96;

const ONE_40: f32 = (1u64 << 40) as f32;

/// A curve that is emitted element by element.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CornerCurve<const AXES: usize> {
    /// Distance in space per path distance before and after the corner.
    spaces_per_path: [f32; 2],
    origin: [Position; AXES],
    /// The whole curve, or the first half of a curve through a given point.
    curve: Quintic<AXES>,
    kept: Kept<AXES>,
    /// Path length (mm) per unit of the parameter in both halves, if the path is the parameter.
    path: Option<[f32; 2]>,
    /// End of the last element, and end of the whole curve.
    at: Knot<AXES>,
    last: Knot<AXES>,
    /// Number of elements in each half, and number of accepted elements, later of emitted elements.
    parts: u32,
    done: u32,
    /// Whether more elements would not improve the accuracy. The elements then only have to fit the format.
    any: bool,
    /// End of the last examined element.
    seam: Seam<AXES>,
}

/// Data of a curve in addition to its polynomial.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Kept<const AXES: usize> {
    /// A curve that is one polynomial. `joint`: parameter where both halves meet. `seen`: path length of the
    /// first elements, and excess of their speed; 0 if unknown.
    Whole { joint: f32, seen: [[f32; 2]; SEEN] },
    /// A curve through a given point; `second` is its second half. Such a curve may have sharp bends, where
    /// its elements are shorter.
    Given { second: Quintic<AXES>, cuts: Cuts, seen: [[f32; 2]; SEEN_GIVEN] },
}

/// The end of an element, where another one of the same half begins.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Seam<const AXES: usize> {
    /// Number of the element that begins here; an invalid number if unknown.
    of: u32,
    /// Whether the element before belongs to the first half.
    is_first: bool,
    site: Site<AXES>,
}

/// Data of an element whose polynomials for the axes are not computed yet.
pub struct Rehearsal<const AXES: usize> {
    /// Whether the element belongs to the block before the corner.
    pub is_first: bool,
    /// Path length, mm.
    pub length: f32,
    /// Largest ratio of the speed along the element to the path speed.
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

/// The part of a half that an element covers.
struct Portion<'a, const AXES: usize> {
    curve: &'a Quintic<AXES>,
    /// Whether the half is the first one.
    is_first: bool,
    /// The range of the curve's parameter that belongs to the half.
    span: [f32; 2],
    /// Start and size of the element in steps of the half, and number of steps in the half.
    steps: [f32; 2],
    of: f32,
}

impl<const AXES: usize> Portion<'_, AXES> {
    /// The curve's parameter at the fraction `t` of the element.
    fn at(&self, t: f32) -> f32 {
        let ([u0, u1], [from, more]) = (self.span, self.steps);
        u0 + (u1 - u0) * ((from + more * t) / self.of)
    }
}

/// The cuts of a curve through a given point.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Cuts {
    /// Number of steps of each element, minus one.
    steps: [u8; MOST_CUTS],
    /// Number of elements. `step`: number of steps of the element that is tried next.
    count: u8,
    step: u16,
}

impl Cuts {
    /// Each half is first tried as one element.
    const NEW: Self = Self { steps: [0; MOST_CUTS], count: 0, step: STEPS };

    /// Equal cuts, with the largest number that other curves have.
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

    /// Accepts the tried element. The next element may be twice as long, but ends with its half. Returns
    /// whether the curve is complete.
    fn accept(&mut self) -> bool {
        let [_, to] = self.ends(u32::from(self.count));
        if let Some(steps) = self.steps.get_mut(usize::from(self.count)) {
            *steps = (self.step - 1) as u8;
            self.count += 1;
        }
        self.step = (2 * self.step).min(STEPS - to % STEPS);
        to >= 2 * STEPS
    }

    /// Rejects the tried element: the next try has half the length. Returns whether a try is possible.
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
    /// The curve is ready to be emitted.
    Ready,
    /// The curve cannot be made.
    Failed,
}

/// Number of rounds that improve the path lengths of the two halves of a curve through a given point. In the
/// first round, both lengths are straight distances.
const LENGTHS: usize = 3;

impl<const AXES: usize> CornerCurve<AXES> {
    /// A curve between two knots; [`Self::lay`] makes its halves. `given`: whether the curve passes a given
    /// point. Inline in every build, so that the curve is made in its final place.
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

    /// Makes both halves, through the point `interim` if given. `lead`: path length (mm) between both ends,
    /// if the travel of a master axis is the path. Returns whether the halves can be made. Then call
    /// [`Self::fit`].
    #[inline(never)]
    pub fn lay(&mut self, measure: &Measure, interim: Option<&[f32; AXES]>, lead: Option<f32>) -> bool {
        let main = &measure.main;
        let a = site_of(&self.at, &self.origin);
        // At the end, the number of the element is invalid.
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
                // The halves meet where the curve is nearest to the corner, so the elements have exactly the
                // planned distance there. With a master axis, the halves meet at the corner's coordinate of
                // this axis.
                let nearest = || min(max(curve.nearest(main, &[0.0; AXES], 0.5), 0.25), 0.75);
                *joint = if lead.is_some() { 0.5 } else { nearest() };
                [speed; 2]
            }
            _ => return false,
        };
        self.path = (!measure.is_space()).then_some(path);
        true
    }

    /// Start and end of the curve, before the first element is emitted.
    pub fn ends(&self) -> [&Knot<AXES>; 2] {
        [&self.at, &self.last]
    }

    /// Examines one more element. The curve gets as few elements as possible. The path speed is accurate to
    /// `even` (relative), and elements deviate by at most `slack` (mm).
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

    /// Continues to cut a curve through a given point. If no number of elements reaches the accuracy, the
    /// result is as accurate as possible.
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

    /// The cuts of a curve through a given point.
    const fn cuts(&self) -> Option<&Cuts> {
        match &self.kept {
            Kept::Given { cuts, .. } => Some(cuts),
            Kept::Whole { .. } => None,
        }
    }

    /// Number of elements in both halves.
    fn count(&self) -> u32 {
        self.cuts().map_or(2 * self.parts, |cuts| u32::from(cuts.count))
    }

    /// The part of the curve that element `i` covers.
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

    /// Path length of a portion, mm.
    fn length(&self, measure: &Measure, portion: &Portion<'_, AXES>) -> f32 {
        let [u0, u1] = [0.0, 1.0].map(|t| portion.at(t));
        match self.path_of(portion) {
            Some(path) => path * (u1 - u0),
            None => portion.curve.length(&measure.main, u0, u1),
        }
    }

    /// Both ends of element `i`, which covers `portion`.
    fn sites(&self, measure: &Measure, i: u32, portion: &Portion<'_, AXES>) -> [Site<AXES>; 2] {
        let Seam { of, is_first, site } = &self.seam;
        let begins = *of == i && *is_first == portion.is_first;
        [if begins { *site } else { self.site(measure, portion, 0.0) }, self.site(measure, portion, 1.0)]
    }

    /// The point at the fraction `t` of a portion.
    fn site(&self, measure: &Measure, portion: &Portion<'_, AXES>, t: f32) -> Site<AXES> {
        let u = portion.at(t);
        match self.path_of(portion) {
            Some(path) => portion.curve.site_over(path, u),
            None => portion.curve.site(&measure.main, u),
        }
    }

    /// Path length (mm) per unit of the parameter in a portion, if the path is the parameter.
    fn path_of(&self, portion: &Portion<'_, AXES>) -> Option<f32> {
        self.path.map(|[first, second]| if portion.is_first { first } else { second })
    }

    /// Largest relative difference of the speed along an element from its path speed, above and below.
    fn unevenness(&self, measure: &Measure, element: &Quintic<AXES>, length: f32) -> [f32; 2] {
        if self.path.is_some() {
            let [before, behind] = self.spaces_per_path;
            return [element.haste(measure, length, max(before, behind)), 0.0];
        }
        element.unevenness(&measure.main, length)
    }

    /// Whether element `i` has an accurate path speed, and is near enough to the curve.
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
            // If the path is the parameter, the element is exactly a part of the curve.
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
        // A rejected element is tried again from the same place, or its half begins anew.
        self.seam = Seam { of: if is_fine { i + 1 } else { i }, is_first, site: if is_fine { b } else { a } };
        is_fine
    }

    /// Path length of element `i`, and the excess of its speed.
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

    /// As [`Self::known`], for an element that is not stored.
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

    /// End of the last emitted element, mm or degrees.
    pub fn stands(&self) -> &[Position; AXES] {
        &self.at.position
    }

    /// Ends the curve early, so that no further element is emitted. Returns the end of the curve.
    pub fn finish(&mut self) -> &[Position; AXES] {
        self.done = self.count();
        self.at = self.last;
        &self.last.position
    }

    /// Whether all elements are emitted.
    pub fn is_done(&self) -> bool {
        self.done >= self.count()
    }
}

impl<const AXES: usize> CornerCurve<AXES> {
    /// The number of the first element in the second half.
    pub fn behind_joint(&self) -> u32 {
        match self.cuts() {
            Some(_) => (0..self.count()).find(|i| !self.is_first(*i)).unwrap_or(0),
            None => self.parts,
        }
    }

    /// Element `i`, before its ends are rounded to positions. Returns `None` after the last element.
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

    /// Begins the next element; the returned draft computes the polynomials of its axes.
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

/// Makes two polynomials that meet at a point with as many equal derivatives as possible: four. Their path
/// lengths follow in a few rounds; the first lengths are straight distances. `space_per_path`: distance in
/// space per path distance. Returns both lengths, or `None` if the polynomials cannot be made.
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
        // Equal third and fourth derivatives at the point give two equations, for slope and second
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
        // A length is at most twice the straight distance; a longer curve would swing out too far.
        lengths = [
            min(first.length(main, 0.0, 1.0) / space_per_path, 2.0 * chords[0]),
            min(second.length(main, 0.0, 1.0) / space_per_path, 2.0 * chords[1]),
        ];
    }
    Some(lengths)
}

/// Upper bound of the ratio of speed along an element to path speed. `above`: largest relative excess found
/// at some places.
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

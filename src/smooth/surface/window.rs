//! Stores the vertices from which Surface computes the points of its path: at most 64.
//!
//! A vertex is a point of the programmed contour, or an additional point on a chord. Each vertex has a point
//! of the *control polygon*, which the smoothing curves (kernels) round.
//!
//! Three passes run over the vertices. They give each vertex the width of its kernel, then its point of the
//! control polygon, and then check the path beside it. A pass needs some of the vertices ahead of it, so each
//! pass stays that far behind the pass before. If a check fails, the kernels there become narrower. The path
//! is made up to the last checked vertex.
use super::knot::Spot;
use super::narrowing::Narrowing;
use super::parameters::{Parameters, Tolerance, Used};
use crate::math::float::{magnitude, max, min, to_f32};
use crate::math::root::sqrt_f32;
use crate::path::Measure;
use crate::quantity::Position;
use heapless::Deque;

/// Largest number of vertices in the window.
pub const VERTICES: usize = 64;

const LSB_32: f32 = 1.0 / (1u64 << 32) as f32;

/// Data of a chord, kept with the vertex at its end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Programmed {
    /// Feed, mm/min; `None` for rapid motion.
    pub feed: Option<f32>,
    /// N number of the block in the program.
    pub n: u32,
    /// Number of motion blocks before the block, since the split.
    pub number: u32,
}

/// A point of the programmed contour in the window, with the data for its smoothing curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vertex<const AXES: usize> {
    /// Position of the point, mm or degrees.
    pub at: [Position; AXES],
    /// Offset from the vertex to the point of the control polygon, mm.
    pub offset: [f32; AXES],
    /// Change of direction at the programmed point, before points move.
    pub turn: [f32; AXES],
    /// Change of direction of the control polygon at this vertex.
    pub moved_turn: [f32; AXES],
    /// Distance from the vertex before, mm, before points move.
    pub length: f32,
    /// Distance from the vertex before along the control polygon, mm, after the points have moved.
    pub moved_length: f32,
    /// Distance from the start of the run, LSB 2^-20 mm; only differences are used.
    pub distance: u32,
    /// Half width of the smoothing curve (kernel) around the vertex, mm of path.
    pub width: f32,
    /// How far the point moves out, as a part of the distance that the kernels cut off: 1 where the contour
    /// is smooth, 0 at an edge.
    pub gain: f32,
    pub programmed: Programmed,
    pub marks: u8,
    /// If the chord before the vertex replaces merged lines: the shares of the tolerance that they use.
    pub used: Used,
    /// Under a transformation: the vertex is a corner of a long line.
    #[cfg(feature = "kinematics")]
    pub is_corner: bool,
}

impl<const AXES: usize> Vertex<AXES> {
    /// The vertex is a point of the program.
    pub const PROGRAMMED: u8 = 1;
    /// An element ends here: a feed or a function begins.
    pub const FORCED: u8 = 2;
    /// The chord before the vertex is a part of an arc.
    pub const ARC: u8 = 4;
    /// The control polygon turns here by more than rounding.
    pub const TURNS: u8 = 8;
    /// The control polygon turns here sharply: an element ends at the vertex and where its kernel ends.
    pub const STRONG: u8 = 16;
    /// A long line meets a curve here, so the curvature has a step.
    pub const STEPS: u8 = 32;
    /// The point of the control polygon does not move: the run begins or ends along the line.
    pub const FIXED: u8 = 64;
    /// The motion stops at this vertex, on the curve.
    pub const STANDS: u8 = 128;

    pub const fn is(&self, mark: u8) -> bool {
        self.marks & mark != 0
    }

    /// Whether the vertex is a corner of a long line, under a transformation.
    #[cfg(feature = "kinematics")]
    pub const fn is_corner(&self) -> bool {
        self.is_corner
    }

    /// Whether the vertex is a corner of a long line; never without transformations.
    #[cfg(not(feature = "kinematics"))]
    #[inline(always)]
    pub const fn is_corner(&self) -> bool {
        false
    }

    /// The vertex becomes a corner of a long line: its point moves out by half of the cut of its kernel.
    #[cfg(feature = "kinematics")]
    pub fn make_corner(&mut self) {
        self.is_corner = true;
        self.gain = min(self.gain, HALF);
    }

    /// Whether the control polygon passes the contour point here.
    pub fn is_on_contour(&self) -> bool {
        self.offset.iter().all(|x| *x == 0.0)
    }

    /// Sets the change of direction of the control polygon at this vertex. `length`: magnitude of `turn`.
    fn turn_by(&mut self, turn: [f32; AXES], length: f32) {
        self.moved_turn = turn;
        self.marks &= !(Self::TURNS | Self::STRONG);
        if turn.iter().any(|d| magnitude(*d) > STRAIGHT) {
            self.marks |= Self::TURNS;
        }
        if length > STRONG || self.is_corner() {
            self.marks |= Self::STRONG;
        }
    }
}

/// Gain of a corner of a long line. The polygon lies outside the corner by half of the kernel's cut, and the curve
/// lies inside by the other half. So the kernel may cut twice the tolerance ([`WHOLE`]).
#[cfg(feature = "kinematics")]
pub const HALF: f32 = 0.5;
const WHOLE: f32 = 2.0;
/// Under a transformation: largest gain of a vertex, and additional deviation of its kernel as a part of the
/// tolerance. The wider kernels of points that move out less make up to a third more speed where lines are as long
/// as a kernel.
#[cfg(feature = "kinematics")]
const TRANSFORMED_GAIN: f32 = 0.6;
const TRANSFORMED_MORE: f32 = 1.2;

/// A larger turn ends an element at its vertex and where its kernel ends.
const STRONG: f32 = 0.2;

/// A smaller change of direction is rounding.
const STRAIGHT: f32 = 1.0 / 1_048_576.0;

/// The main axes, bit k for axis k.
#[derive(Clone, Copy, Debug)]
pub struct Space(pub u32);

impl Space {
    pub fn new(measure: &Measure) -> Self {
        Self(measure.main.of::<32>().fold(0, |bits, k| bits | 1 << k))
    }

    /// Length of a vector in space.
    #[cfg_attr(feature = "fast", inline(always))]
    pub fn length<const AXES: usize>(self, d: &[f32; AXES]) -> f32 {
        let mut sum = 0.0;
        for (k, x) in d.iter().enumerate() {
            if self.is_main(k) {
                sum += x * x;
            }
        }
        sqrt_f32(sum)
    }

    /// Whether an axis is a main axis.
    #[cfg_attr(feature = "fast", inline(always))]
    pub const fn is_main(self, axis: usize) -> bool {
        self.0 >> (axis & 31) & 1 == 1
    }
}

/// The current vertices of the run, from the place where the path is made to the newest vertex.
#[derive(Debug)]
pub struct Window<const AXES: usize> {
    pub vertices: Deque<Vertex<AXES>, VERTICES>,
    pub space: Space,
    /// Number of vertices that have a width.
    pub wide: usize,
    /// Number of vertices that have a point of the control polygon.
    pub moved: usize,
    /// Number of checked vertices.
    pub checked: usize,
    /// How often kernels were reduced because of the next vertex to check.
    pub again: u8,
    /// Number of vertices that were checked before the last reduction.
    pub furthest: usize,
    /// Half width of the widest kernel of the run, mm.
    pub widest: f32,
    /// Current limit for the half width of new kernels, mm. The limit is lower if the window has been full.
    pub reach: f32,
    /// Upper limit for [`Vertex::gain`] in this run.
    pub most: f32,
    /// Whether the last vertex is the end of the run.
    pub ended: bool,
    /// Value of [`Vertex::distance`] at the start of the run, while the start is near; otherwise `None`.
    pub begun: Option<u32>,
    /// Kernels that become narrower; no other work is done before.
    pub narrowing: Option<Narrowing>,
    /// Whether a transformation for rotary axes follows.
    #[cfg(feature = "kinematics")]
    pub is_transformed: bool,
}

/// A vertex whose turn (twice the sine of half the angle) is below the first value is smooth; above the
/// second value it is an edge.
const SMOOTH: f32 = 0.14;
const EDGE: f32 = 0.35;

/// Additional deviation of a kernel, as a part of the tolerance, if its vertex moves out.
const MORE: f32 = 0.6;

/// Steps of the search for a width, and the relative change that ends the search.
const STEPS: usize = 9;
const ALIKE: f32 = 1.0 / 64.0;

/// Share of a tolerance that the checked path may use, for space and for other axes. If the path exceeds this
/// share, kernels are reduced by the next factor, at most as often as the last number. Other axes may have
/// kinks where the path in space has none, and their points also move out there.
const WELL: f32 = 0.98;
const WELL_BESIDE: f32 = 0.93;
const LITTLE: f32 = 0.85;
const AGAIN: u8 = 8;

/// Checked places, in halves of a chord. Additional places are checked if the half exceeds this part of a
/// kernel.
const PLACES: [f32; 2] = [0.0, 1.0];
const BETWEEN_PLACES: [f32; 2] = [0.5, 1.5];
const SPARSE: f32 = 0.2;

/// Factor for a bulge in a place where kernels are reduced.
pub const NARROWED_BULGE: f32 = 0.97;

/// Largest change of the half width of kernels per distance, mm per mm.
pub const SLOPE: f32 = 0.5;

/// A vertex moves when the contour is known this number of widest kernels ahead. A later kernel may reduce
/// others within twice the widest width. So the width is known to within a slope of 0.8; a slope of 1 would
/// suffice.
const KNOWN: f32 = 1.25;

/// Factor for the widest kernel while the window is full. A smaller factor would leave kernels narrower than
/// the window demands for long.
const HURRIED: f32 = 0.92;

/// Smallest permitted ratio of path length to polygon length, at any place.
pub const SLOWEST: f32 = 0.6;

/// 2^-20 mm, in mm.
const LSB_20: f32 = 1.0 / (1u32 << 20) as f32;

impl<const AXES: usize> Window<AXES> {
    // Made in place in every build.
    #[inline(always)]
    pub fn new(measure: &Measure) -> Self {
        Self {
            vertices: Deque::new(),
            space: Space::new(measure),
            wide: 0,
            moved: 0,
            checked: 0,
            again: 0,
            furthest: 0,
            widest: 0.0,
            reach: 0.0,
            most: 1.0,
            ended: false,
            begun: None,
            narrowing: None,
            #[cfg(feature = "kinematics")]
            is_transformed: false,
        }
    }

    /// Whether a transformation for rotary axes follows.
    #[cfg(feature = "kinematics")]
    pub const fn is_transformed(&self) -> bool {
        self.is_transformed
    }

    /// Sets whether a transformation for rotary axes follows.
    #[cfg(feature = "kinematics")]
    pub const fn transform(&mut self, is_transformed: bool) {
        self.is_transformed = is_transformed;
    }

    /// Does nothing in a build without transformations.
    #[cfg(not(feature = "kinematics"))]
    #[inline(always)]
    pub const fn transform(&mut self, _: bool) {}

    /// Whether a transformation follows; never in a build without transformations.
    #[cfg(not(feature = "kinematics"))]
    #[inline(always)]
    pub const fn is_transformed(&self) -> bool {
        false
    }

    /// Length of a vector in space.
    #[cfg_attr(feature = "fast", inline(always))]
    pub fn length(&self, d: &[f32; AXES]) -> f32 {
        self.space.length(d)
    }

    /// Whether an axis is a main axis.
    #[cfg_attr(feature = "fast", inline(always))]
    pub const fn is_main(&self, axis: usize) -> bool {
        self.space.is_main(axis)
    }

    /// Whether the deviation `d` is inside `part` times the tolerance.
    pub fn is_inside(&self, d: &[f32; AXES], tolerance: &Tolerance, part: f32) -> bool {
        let most = tolerance.track * part;
        let tracks = d.iter().enumerate().all(|(k, x)| self.is_main(k) || magnitude(*x) <= most);
        tracks && self.length(d) <= tolerance.path * part
    }

    /// Empties the window and begins a run.
    pub fn begin(&mut self, from: &[Position; AXES], parameters: &Parameters) {
        let widest = parameters.widest();
        self.most = parameters.gain();
        #[cfg(feature = "kinematics")]
        if self.is_transformed {
            self.most = min(self.most, TRANSFORMED_GAIN);
        }
        self.vertices.clear();
        let programmed = Programmed { feed: None, n: 0, number: 0 };
        let _ = self.vertices.push_back(Vertex {
            at: *from,
            offset: [0.0; AXES],
            turn: [0.0; AXES],
            moved_turn: [0.0; AXES],
            length: 0.0,
            moved_length: 0.0,
            distance: 0,
            width: 0.0,
            gain: 0.0,
            programmed,
            marks: Vertex::<AXES>::PROGRAMMED,
            used: Used::NOTHING,
            #[cfg(feature = "kinematics")]
            is_corner: false,
        });
        (self.wide, self.moved, self.ended, self.begun) = (1, 1, false, Some(0));
        (self.checked, self.again, self.furthest) = (1, 0, 1);
        (self.widest, self.reach, self.narrowing) = (widest, widest, None);
    }

    pub fn len(&self) -> usize {
        self.vertices.len()
    }

    /// Whether there is no room for another chord.
    pub fn is_full(&self) -> bool {
        self.room() < super::chords::BETWEEN + 2
    }

    pub fn room(&self) -> usize {
        VERTICES - self.vertices.len()
    }

    pub fn get(&self, k: usize) -> Option<&Vertex<AXES>> {
        self.vertices.get(k)
    }

    /// Returns the vertices from number `k` on.
    #[cfg_attr(feature = "fast", inline(always))]
    pub fn from(&self, k: usize) -> impl Iterator<Item = &Vertex<AXES>> {
        let (front, back) = self.vertices.as_slices();
        let rest = back.get(k.saturating_sub(front.len())..).unwrap_or(&[]);
        front.get(k..).unwrap_or(&[]).iter().chain(rest)
    }

    /// Returns the vertices before number `k`, the nearest first.
    #[cfg_attr(feature = "fast", inline(always))]
    pub fn before(&self, k: usize) -> impl Iterator<Item = &Vertex<AXES>> {
        let (front, back) = self.vertices.as_slices();
        let rest = back.get(..k.saturating_sub(front.len())).unwrap_or(&[]);
        rest.iter().rev().chain(front.get(..k.min(front.len())).unwrap_or(&[]).iter().rev())
    }

    /// The vector from one vertex of the control polygon to the next one, `k`, and its length.
    #[cfg_attr(feature = "fast", inline(always))]
    pub fn chord(&self, k: usize) -> Option<([f32; AXES], f32)> {
        let (from, to) = (self.vertices.get(k.checked_sub(1)?)?, self.vertices.get(k)?);
        let d = step(from, &to.at, &to.offset);
        Some((d, self.length(&d)))
    }

    /// Appends a vertex. `turn`: change of direction at the vertex before. The window must have room.
    pub fn push(
        &mut self,
        (at, offset): (&[Position; AXES], &[f32; AXES]),
        (turn, edge): (&[f32; AXES], Option<f32>),
        length: f32,
        programmed: Programmed,
        (marks, used): (u8, Used),
    ) {
        let mut gain = self.most;
        let mut distance = 0;
        if let Some(last) = self.vertices.back_mut() {
            last.turn = *turn;
            distance = last.distance.wrapping_add((length * (1.0 / LSB_20)) as u32);
            if let Some(edge) = edge {
                last.gain = min(last.gain, edge);
            }
            gain = last.gain;
        }
        let widest = max(self.reach, f32::MIN_POSITIVE);
        let _ = self.vertices.push_back(Vertex {
            at: *at,
            offset: *offset,
            turn: [0.0; AXES],
            moved_turn: [0.0; AXES],
            length,
            moved_length: length,
            distance,
            width: 0.0,
            gain: min(self.most, gain + length / widest),
            programmed,
            marks,
            used,
            #[cfg(feature = "kinematics")]
            is_corner: false,
        });
        if self.begun.is_some_and(|begun| distance.wrapping_sub(begun) > 100 << 20) {
            self.begun = None;
        }
        // Towards an edge, the gain falls to zero.
        let mut k = self.len().saturating_sub(2);
        while k > self.moved {
            let Some(behind) = self.vertices.get(k) else { return };
            let most = behind.gain + behind.length / widest;
            let Some(before) = self.vertices.get_mut(k - 1) else { return };
            if before.gain <= most {
                break;
            }
            before.gain = most;
            k -= 1;
        }
    }

    /// Distance from a vertex to a later one, mm.
    pub fn between(&self, from: usize, to: usize) -> f32 {
        match (self.vertices.get(from), self.vertices.get(to)) {
            (Some(from), Some(to)) => to.distance.wrapping_sub(from.distance) as f32 * LSB_20,
            _ => 0.0,
        }
    }

    /// The tolerance at a vertex.
    pub fn tolerance(&self, k: usize, parameters: &Parameters) -> Tolerance {
        let rapid = |k: usize| self.vertices.get(k).is_none_or(|vertex| vertex.programmed.feed.is_none());
        let used = |k: usize| self.vertices.get(k).map_or(Used::NOTHING, |vertex| vertex.used);
        let used = used(k).larger(used(k + 1));
        parameters.left(parameters.tolerance(rapid(k) && rapid(k + 1)), false, used)
    }

    /// Gives the next vertex its width. Returns `false` if the vertex has to wait for more vertices.
    pub fn widen(&mut self, parameters: &Parameters) -> bool {
        let (k, last) = (self.wide, self.len().saturating_sub(1));
        if k > last || !(self.ended || self.between(k, last) >= self.reach) || !self.ended && k == last {
            return false;
        }
        let mut cap = self.reach;
        let Some(vertex) = self.vertices.get(k) else { return false };
        if let Some(begun) = self.begun {
            cap = min(cap, vertex.distance.wrapping_sub(begun) as f32 * LSB_20);
        }
        if self.ended {
            cap = min(cap, self.between(k, last));
        }
        let (length, before) = (vertex.length, k.checked_sub(1).and_then(|k| self.vertices.get(k)));
        cap = min(cap, before.map_or(0.0, |before| before.width + SLOPE * length));
        let tolerance = self.tolerance(k, parameters);
        let more = match self.is_transformed() {
            true if vertex.is_corner() => WHOLE,
            true => 1.0 + TRANSFORMED_MORE * vertex.gain,
            false => 1.0 + MORE * vertex.gain,
        };
        let near = before.map_or(0.0, |before| before.width);
        let width = self.search((k, near), cap, &tolerance, more);
        if let Some(vertex) = self.vertices.get_mut(k) {
            vertex.width = width;
        }
        self.wide = k + 1;
        self.slope_down(k);
        true
    }

    /// Limits the widths of earlier vertices that have not moved yet, so that the width changes slowly.
    fn slope_down(&mut self, from: usize) {
        let mut k = from;
        while k > self.moved {
            let Some(behind) = self.vertices.get(k) else { return };
            let most = behind.width + SLOPE * behind.length;
            let Some(before) = self.vertices.get_mut(k - 1) else { return };
            if before.width <= most {
                return;
            }
            before.width = most;
            k -= 1;
        }
    }

    /// The largest width up to `cap` with which the deviation at a vertex is inside the tolerance. `near`:
    /// width of the vertex before, which is usually similar.
    fn search(&self, (k, near): (usize, f32), cap: f32, tolerance: &Tolerance, more: f32) -> f32 {
        let (mut low, mut high) = (0.0, max(cap, 0.0));
        let above = near * (1.0 + ALIKE);
        if 0.0 < above && above < high && !self.fits(k, above, tolerance, more) {
            high = above;
            let below = near * (1.0 - ALIKE);
            if self.fits(k, below, tolerance, more) {
                low = below;
            } else {
                high = below;
            }
        } else if high <= 0.0 || self.fits(k, high, tolerance, more) {
            return high;
        }
        for _ in 0..STEPS {
            if high - low <= ALIKE * high {
                break;
            }
            let middle = 0.5 * (low + high);
            if self.fits(k, middle, tolerance, more) {
                low = middle;
            } else {
                high = middle;
            }
        }
        low
    }

    /// Whether the deviation at a vertex is inside the tolerance if all vertices nearby have this width.
    fn fits(&self, k: usize, width: f32, tolerance: &Tolerance, more: f32) -> bool {
        let Some((chord, length)) = self.chord(k) else { return true };
        let per = 1.0 / max(length, f32::MIN_POSITIVE);
        let mut direction = chord.map(|x| x * per);
        let mut off = [0.0; AXES];
        let inverse = 1.0 / width;
        let mut add = |vertex: &Vertex<AXES>, away: f32, behind: bool| {
            let u = 1.0 - away * inverse;
            let (g, t) = (width * u * u * u * (1.0 / 6.0), 0.5 * u * u);
            let t = if behind { -t } else { t };
            for ((off, direction), turn) in off.iter_mut().zip(&mut direction).zip(&vertex.turn) {
                *off += turn * g;
                *direction += turn * t;
            }
        };
        // The direction before the vertex: earlier vertices count as ahead.
        let mut away = 0.0;
        let mut ahead = self.from(k).peekable();
        while let Some(vertex) = ahead.next()
            && away < width
        {
            add(vertex, away, false);
            away += ahead.peek().map_or(width, |next| next.length);
        }
        away = length_of(self.get(k));
        for vertex in self.before(k) {
            if away >= width {
                break;
            }
            add(vertex, away, true);
            away += vertex.length;
        }
        self.is_inside(&off, tolerance, more) && self.length(&direction) >= SLOWEST
    }

    /// Gives the next vertex its point of the control polygon. Returns `false` if the vertex has to wait for
    /// more vertices.
    pub fn move_out(&mut self, parameters: &Parameters) -> bool {
        let k = self.moved;
        let known = self.wide.checked_sub(1);
        let is_known = self.ended && self.wide == self.len()
            || known.is_some_and(|known| known > k && self.between(k, known) >= KNOWN * self.reach);
        if k >= self.wide || !is_known {
            return false;
        }
        let raw = self.back(k, parameters);
        if let Some(vertex) = self.vertices.get_mut(k) {
            if vertex.is(Vertex::<AXES>::FIXED) {
                vertex.gain = 0.0;
            }
            for (offset, raw) in vertex.offset.iter_mut().zip(&raw) {
                *offset -= vertex.gain * raw;
            }
        }
        self.moved = k + 1;
        self.settle(k);
        true
    }

    /// The shift of a vertex's point with gain 1: the cut of the kernels, less its lead.
    pub fn back(&self, k: usize, parameters: &Parameters) -> [f32; AXES] {
        let mut back = self.deviation(k);
        for (back, lead) in back.iter_mut().zip(self.lead(k, parameters)) {
            *back -= lead;
        }
        back
    }

    /// The deviation of the smoothed polygon at a vertex, before points move.
    fn deviation(&self, k: usize) -> [f32; AXES] {
        let mut off = [0.0; AXES];
        let mut add = |vertex: &Vertex<AXES>, away: f32| {
            let u = 1.0 - away / vertex.width;
            let g = vertex.width * u * u * u * (1.0 / 6.0);
            for (off, turn) in off.iter_mut().zip(&vertex.turn) {
                *off += turn * g;
            }
        };
        let mut away = 0.0;
        let mut ahead = self.from(k).take(self.wide.saturating_sub(k)).peekable();
        while let Some(vertex) = ahead.next()
            && away < self.widest
        {
            if away < vertex.width {
                add(vertex, away);
            }
            away += ahead.peek().map_or(0.0, |next| next.length);
        }
        away = length_of(self.get(k));
        for vertex in self.before(k) {
            if away < vertex.width {
                add(vertex, away);
            }
            if away >= self.widest {
                break;
            }
            away += vertex.length;
        }
        off
    }

    /// Computes length and direction of the control polygon up to a vertex again, after points have moved.
    pub fn settle(&mut self, k: usize) {
        let Some((chord, length)) = self.chord(k) else { return };
        let per = 1.0 / max(length, f32::MIN_POSITIVE);
        let mut turn = chord.map(|x| x * per);
        if let Some((before, length)) = k.checked_sub(1).and_then(|k| self.chord(k)) {
            let per = 1.0 / max(length, f32::MIN_POSITIVE);
            for (turn, before) in turn.iter_mut().zip(&before) {
                *turn -= before * per;
            }
        } else {
            turn = [0.0; AXES];
        }
        if let Some(vertex) = self.vertices.get_mut(k) {
            vertex.moved_length = length;
        }
        let length = self.length(&turn);
        if let Some(vertex) = k.checked_sub(1).and_then(|k| self.vertices.get_mut(k)) {
            vertex.turn_by(turn, length);
        }
    }

    /// Reduces the kernels, because the window is full and no element is possible.
    pub fn hurry(&mut self) {
        self.reach *= HURRIED;
        for k in self.moved..self.wide {
            if let Some(vertex) = self.vertices.get_mut(k) {
                vertex.width = min(vertex.width, self.reach);
            }
        }
    }

    /// Compares the path with the tolerance at the next vertex and in the middle of the chord after this
    /// vertex. If the path exceeds its share of the tolerance, kernels nearby are reduced. Returns `false` if
    /// more of the contour must be known first.
    pub fn check(&mut self, parameters: &Parameters) -> bool {
        let k = self.checked;
        let last = self.moved.saturating_sub(2);
        let all = self.ended && self.moved == self.len();
        if k >= self.moved || !all && (k >= last || self.between(k, last) < self.reach) {
            return false;
        }
        let Tolerance { path, track } = self.tolerance(k, parameters);
        let well = Tolerance { path: WELL * path, track: WELL_BESIDE * track };
        let way = self.get(k + 1).filter(|_| k + 1 < self.moved).map_or(0.0, |next| 0.5 * next.moved_length);
        let sparse = way > SPARSE * self.get(k).map_or(0.0, |vertex| vertex.width);
        let is_well = |part: &f32| {
            let off = self.beside(&Spot { vertex: k, x: part * way });
            self.is_inside(&off, &well, 1.0)
        };
        let fits = PLACES.iter().all(is_well) && (!sparse || BETWEEN_PLACES.iter().all(is_well));
        if fits || self.again >= AGAIN {
            self.checked = k + 1;
            if self.checked > self.furthest {
                (self.furthest, self.again) = (self.checked, 0);
            }
            return true;
        }
        self.again += 1;
        let near = |j: usize| {
            let away = self.between(j.min(k), j.max(k));
            self.get(j).is_some_and(|vertex| vertex.width + way > away)
        };
        let first = (0..k).find(|j| near(*j)).unwrap_or(k);
        let last = (k..self.moved).rev().find(|j| near(*j)).unwrap_or(k);
        self.narrow(first, last, LITTLE);
        // Vertices with an opposite turn now have neighbours with narrower kernels, so the check begins again
        // there.
        self.checked = first.max(1);
        true
    }

    /// The vector from the programmed chord to the smoothed path, at a place.
    fn beside(&self, spot: &Spot) -> [f32; AXES] {
        let Some(from) = self.get(spot.vertex) else { return [0.0; AXES] };
        let mut off = from.offset;
        let mut add = |vertex: &Vertex<AXES>, away: f32| {
            if away < vertex.width {
                let u = 1.0 - away / vertex.width;
                let g = vertex.width * u * u * u * (1.0 / 6.0);
                for (off, turn) in off.iter_mut().zip(&vertex.moved_turn) {
                    *off += turn * g;
                }
            }
        };
        let mut away = spot.x;
        for vertex in self.before(spot.vertex + 1) {
            if away >= self.widest {
                break;
            }
            add(vertex, away);
            away += vertex.moved_length;
        }
        away = -spot.x;
        for vertex in self.from(spot.vertex + 1).take(self.moved.saturating_sub(spot.vertex + 1)) {
            away += vertex.moved_length;
            if away >= self.widest {
                break;
            }
            add(vertex, away);
        }
        if let Some(to) = self.get(spot.vertex + 1) {
            let part = min(spot.x / max(to.moved_length, f32::MIN_POSITIVE), 1.0);
            for (off, (from, to)) in off.iter_mut().zip(from.offset.iter().zip(&to.offset)) {
                *off += part * (to - from);
            }
        }
        off
    }

    /// Vertex `k` becomes the start of a run; earlier vertices are dropped.
    pub fn restart(&mut self, k: usize) {
        for _ in 0..k {
            self.pop();
        }
        let mut away = 0.0;
        for k in 0..self.len() {
            let Some(vertex) = self.vertices.get_mut(k) else { break };
            if k == 0 {
                (vertex.width, vertex.offset) = (0.0, [0.0; AXES]);
                vertex.turn = [0.0; AXES];
                vertex.turn_by([0.0; AXES], 0.0);
                self.begun = Some(vertex.distance);
                continue;
            }
            away += if k < self.moved { vertex.moved_length } else { vertex.length };
            vertex.width = min(vertex.width, 0.9 * away);
        }
        (self.wide, self.moved) = (self.wide.max(1), self.moved.max(1));
        (self.checked, self.again, self.furthest) = (1, 0, 1);
        for k in 1..self.moved.min(3) {
            self.settle(k);
        }
        if let Some(vertex) = self.vertices.front_mut() {
            vertex.turn_by([0.0; AXES], 0.0);
        }
    }

    /// Drops the first vertex.
    pub fn pop(&mut self) {
        if self.vertices.pop_front().is_some() {
            (self.wide, self.moved) = (self.wide.saturating_sub(1), self.moved.saturating_sub(1));
            self.checked = self.checked.saturating_sub(1);
            self.furthest = self.furthest.saturating_sub(1);
        }
    }
}

/// The vector from one point of the control polygon to another one, mm.
#[cfg_attr(feature = "fast", inline(always))]
pub fn step<const AXES: usize>(
    from: &Vertex<AXES>,
    to: &[Position; AXES],
    offset: &[f32; AXES],
) -> [f32; AXES] {
    let mut d = [0.0; AXES];
    let ends = to.iter().zip(&from.at).zip(offset.iter().zip(&from.offset));
    for (d, ((to, from), (offset, before))) in d.iter_mut().zip(ends) {
        *d = to_f32(to.to_bits().wrapping_sub(from.to_bits())) * LSB_32 + (offset - before);
    }
    d
}

/// Length from the vertex before, mm.
fn length_of<const AXES: usize>(vertex: Option<&Vertex<AXES>>) -> f32 {
    vertex.map_or(0.0, |vertex| vertex.length)
}

/// How smooth the contour is at a turn: 1 for a smooth contour, 0 for an edge. `turn`: twice the sine of half
/// the angle.
pub fn smoothness(turn: f32) -> f32 {
    let x = min(max((EDGE - turn) * (1.0 / (EDGE - SMOOTH)), 0.0), 1.0);
    x * x * (3.0 - 2.0 * x)
}

//! Turns blocks into chords for Surface: a line becomes one chord, an arc many. Inside a long chord, the
//! module adds vertices on the smooth curve that the chords approximate.
use super::parameters::{Parameters, Tolerance, Used};
#[cfg(feature = "kinematics")]
use super::window::HALF;
use super::window::{Programmed, Space, Vertex, Window, smoothness};
use crate::math::float::{max, min, to_f32, to_i64};
use crate::quantity::{Distance, Position};
use crate::smooth::{Data, Form, ProgrammedBlock};

const LSB_32: f32 = 1.0 / (1u64 << 32) as f32;
const ONE_30: f32 = (1u32 << 30) as f32;

/// A part of a block between two vertices.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chord<const AXES: usize> {
    pub from: [Position; AXES],
    pub to: [Position; AXES],
    /// Direction: change of position of each axis per mm of path in space.
    pub direction: [f32; AXES],
    /// Length, mm.
    pub length: f32,
    pub programmed: Programmed,
    /// Whether the chord is a part of an arc.
    pub arc: bool,
    /// Whether this is half a line, which continues at the start or end of the run.
    pub half: bool,
    /// Whether the motion stops at the end of the chord; the curve continues afterwards.
    pub stop: bool,
    /// Deviation of the lines that this chord replaces.
    pub stray: Tolerance,
}

/// The block that chords are made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Source<const AXES: usize> {
    pub block: ProgrammedBlock<AXES>,
    /// Start and length of the next chord of an arc. A length of 0 takes the whole block.
    next: Distance,
    step: Distance,
    from: [Position; AXES],
    /// Whether the motion follows the block exactly.
    pub exact: bool,
    /// Whether the program has a function before the block.
    pub parted: bool,
    /// Whether this is half a line: the run begins in its middle.
    pub half: bool,
    /// Whether all chords of the block have been taken.
    pub is_over: bool,
}

/// Largest number of additional vertices of a chord.
pub const BETWEEN: usize = 11;
/// Lines with a larger change of direction are not merged.
const GENTLE: f32 = 0.2;
/// Distance between two additional vertices, as a share of the smoothing width.
const STEP: f32 = 0.25;
/// Additional vertices at each end of a long chord: they cover the smoothing width, plus one.
const ENDS: usize = 5;
/// A chord longer than this many smoothing widths is straight except near its ends.
const LONG: f32 = 3.0;
/// A turn (twice the sine of half the angle) below this value counts as none.
const SLIGHT: f32 = 0.001;
/// Share of a tolerance that the curve may lie away from its chord. If the curve gets less room, its
/// curvature oscillates.
const BULGE: f32 = 0.96;
/// A curve that exceeds this multiple of the tolerance gets only [`LESS`]; the rest is for the smoothing
/// curves.
const FAR: f32 = 1.05;
/// Under a transformation: from this multiple of the tolerance on, a chord is a long line between two corners.
/// The half width of a corner's kernel is then less than a third of the line.
#[cfg(feature = "kinematics")]
const ALONE: f32 = 5.0;
/// Places in a chord where the curve is farthest from the chord, as shares of the chord. The first place is
/// for a curve that bends to one side. The other two are for a curve that crosses its chord.
const FARTHEST: [f32; 3] = [0.5, 0.211_325, 0.788_675];
const LESS: f32 = 0.6;

impl<const AXES: usize> Source<AXES> {
    /// Begins a block. `chord`: length (mm) of the chords of an arc; `None` if the block is a single chord.
    pub fn new(block: &ProgrammedBlock<AXES>, chord: Option<f32>, exact: bool, parted: bool) -> Self {
        let length = block.element.shape.length.to_bits();
        let mut step = length;
        if let Some(chord) = chord {
            let most = max(to_f32(length) / max(chord * (1u64 << 44) as f32, 1.0), 0.0);
            // An arc has at least two chords, so that a full circle has a chord with a direction.
            step = length / (2 + i64::from(min(most, 1e6) as u32)) + 1;
        }
        let next = Distance::ZERO;
        let (block, from, step) = (*block, block.from, Distance::from_bits(step));
        Self { block, next, step, from, exact, parted, half: false, is_over: false }
    }

    /// The next chord; `None` if no main axis moves. The chord stays the next one until a call of
    /// [`Self::go_on`].
    pub fn chord(&self, window: &Window<AXES>) -> Option<Chord<AXES>> {
        let Data { feed, n, number, .. } = self.block.data;
        let programmed = Programmed { feed, n, number };
        let end = self.next.to_bits().saturating_add(self.step.to_bits());
        let mut to = self.block.to;
        if end < self.block.element.shape.length.to_bits() {
            to = self.block.element.shape.point(end, &self.block.from);
        }
        let mut chord = Chord::new(&self.from, &to, programmed, window.space)?;
        (chord.arc, chord.half) = (self.block.form != Form::Line, self.half);
        Some(chord)
    }

    /// Steps to the next chord, which begins at `to`.
    pub fn go_on(&mut self, to: &[Position; AXES]) {
        let end = self.next.to_bits().saturating_add(self.step.to_bits());
        self.next = Distance::from_bits(end);
        self.from = *to;
        self.is_over = end >= self.block.element.shape.length.to_bits();
    }
}

impl<const AXES: usize> Chord<AXES> {
    /// The chord between two points. Returns `None` if no main axis moves.
    pub fn new(
        from: &[Position; AXES],
        to: &[Position; AXES],
        programmed: Programmed,
        space: Space,
    ) -> Option<Self> {
        let mut direction = [0.0; AXES];
        for (d, (from, to)) in direction.iter_mut().zip(from.iter().zip(to)) {
            *d = to_f32(to.to_bits().wrapping_sub(from.to_bits())) * LSB_32;
        }
        let length = space.length(&direction);
        if length <= 0.0 {
            return None;
        }
        let per = 1.0 / length;
        let direction = direction.map(|d| d * per);
        let stray = Tolerance { path: 0.0, track: 0.0 };
        Some(Self {
            from: *from,
            to: *to,
            direction,
            length,
            programmed,
            arc: false,
            half: false,
            stop: false,
            stray,
        })
    }

    /// Length of a straight block in space, mm.
    pub fn length_of(block: &ProgrammedBlock<AXES>, window: &Window<AXES>) -> Option<f32> {
        let none = Programmed { feed: None, n: 0, number: 0 };
        Self::new(&block.from, &block.to, none, window.space).map(|chord| chord.length)
    }

    /// Replaces this line and the next one by one chord, if the points between stay inside the tolerance
    /// `most`.
    pub fn merged(&self, next: &Self, most: &Tolerance, window: &Window<AXES>) -> Option<Self> {
        if self.stop
            || self.arc
            || next.arc
            || self.half
            || next.half
            || window.length(&self.turn(next)) > GENTLE
        {
            return None;
        }
        let mut both = Self::new(&self.from, &next.to, next.programmed, window.space)?;
        both.stop = next.stop;
        let mut off = self.direction;
        for (off, both) in off.iter_mut().zip(&both.direction) {
            *off = (*off - both) * self.length;
        }
        both.stray = Tolerance { path: self.stray.path + window.length(&off), track: self.stray.track };
        for (_, off) in off.iter().enumerate().filter(|(k, _)| !window.is_main(*k)) {
            both.stray.track = max(both.stray.track, self.stray.track + max(*off, -*off));
        }
        (both.stray.track <= most.track && both.stray.path <= most.path).then_some(both)
    }

    /// The change of direction to the next chord.
    pub fn turn(&self, next: &Self) -> [f32; AXES] {
        let mut turn = next.direction;
        for (turn, before) in turn.iter_mut().zip(&self.direction) {
            *turn -= before;
        }
        turn
    }
}

/// A chord between its neighbours.
pub struct Between<'a, const AXES: usize> {
    pub chord: &'a Chord<AXES>,
    pub before: Option<&'a Chord<AXES>>,
    pub behind: Option<&'a Chord<AXES>>,
    /// Marks of the vertex at the end of the chord.
    pub marks: u8,
}

/// The curve that a chord approximates, by the slope between curve and chord at both ends.
struct Bulge<const AXES: usize> {
    slopes: [[f32; AXES]; 2],
}

impl<const AXES: usize> Bulge<AXES> {
    const NONE: Self = Self { slopes: [[0.0; AXES]; 2] };

    /// Offset of the curve from its chord at the share `w` of a chord of `length`.
    fn at(&self, w: f32, length: f32) -> [f32; AXES] {
        let rest = 1.0 - w;
        let [first, last] = &self.slopes;
        let (a, b) = (length * w * rest * rest, -length * w * w * rest);
        let mut off = *first;
        for (off, last) in off.iter_mut().zip(last) {
            *off = *off * a + last * b;
        }
        off
    }
}

/// The share of a bulge that a tolerance permits.
fn kept(bulge: f32, tolerance: f32) -> f32 {
    let most = if bulge > FAR * tolerance { LESS } else { BULGE };
    min(1.0, most * tolerance / max(bulge, f32::MIN_POSITIVE))
}

impl<const AXES: usize> Window<AXES> {
    /// The turn from one chord to the next, and its smoothness. The smoothness is the share of the turn that
    /// the curve has at the vertex.
    fn leaves(&self, one: &Chord<AXES>, next: &Chord<AXES>) -> ([f32; AXES], f32) {
        let turn = one.turn(next);
        (turn, smoothness(self.length(&turn)))
    }

    /// Returns `true` if a long line meets a curve of chords without a corner. There the curvature has a
    /// step, from zero to that of the curve.
    fn curvature_steps(&self, one: &Chord<AXES>, next: &Chord<AXES>) -> bool {
        let long = LONG * self.reach;
        let (turn, smooth) = self.leaves(one, next);
        (one.length > long) != (next.length > long) && smooth > 0.0 && self.length(&turn) > SLIGHT
    }

    /// The curve that the chord approximates.
    fn bulge(&self, between: &Between<'_, AXES>, tolerance: &Tolerance) -> Bulge<AXES> {
        let Between { chord, before, behind, .. } = between;
        let mut bulge = Bulge::NONE;
        // A long chord is straight: the curve next to it starts in its direction.
        let long = LONG * self.reach;
        let mut of = |slot: usize, one: &Chord<AXES>, next: &Chord<AXES>, sign: f32| {
            let (turn, smooth) = self.leaves(one, next);
            let other = if slot == 0 { one } else { next };
            let share = if other.length > long { 1.0 } else { chord.length / (one.length + next.length) };
            let part = sign * smooth * share;
            if let Some(slopes) = bulge.slopes.get_mut(slot) {
                *slopes = turn.map(|turn| turn * part);
            }
        };
        if let Some(before) = before {
            of(0, before, chord, -1.0);
        }
        if let Some(behind) = behind {
            of(1, chord, behind, 1.0);
        }
        let mut part = 1.0;
        for place in FARTHEST {
            let off = bulge.at(place, chord.length);
            part = min(part, kept(self.length(&off), tolerance.path));
            for (_, x) in off.iter().enumerate().filter(|(k, _)| !self.is_main(*k)) {
                part = min(part, kept(max(*x, -*x), tolerance.track));
            }
        }
        for slopes in &mut bulge.slopes {
            *slopes = slopes.map(|x| x * part);
        }
        bulge
    }

    /// Takes a chord. The window needs room for [`BETWEEN`] + 1 vertices. `heading`: direction of the polygon
    /// before this chord; the call replaces it by the direction at the chord's end.
    pub fn take(
        &mut self,
        between: &Between<'_, AXES>,
        heading: &mut Option<[f32; AXES]>,
        parameters: &Parameters,
    ) {
        let chord = between.chord;
        let widest = max(self.reach, f32::MIN_POSITIVE);
        let step = STEP * widest;
        let edge = between.before.map(|before| self.leaves(before, chord).1);
        if let Some(before) = between.before
            && self.curvature_steps(before, chord)
            && let Some(vertex) = self.vertices.back_mut()
        {
            vertex.marks |= Vertex::<AXES>::STEPS;
        }
        let used = parameters.used(&chord.stray);
        let mut bulge = Bulge::NONE;
        let mut count = 0;
        let mut long = false;
        let fixed = if chord.half { Vertex::<AXES>::FIXED } else { 0 };
        if chord.half {
            count = (chord.length / step) as usize + 1;
            long = count > BETWEEN;
            count = if long { 2 * ENDS } else { count };
        } else if chord.length > step {
            long = chord.length > LONG * widest;
            if long {
                count = 2 * ENDS;
            } else {
                count = (chord.length / step) as usize;
                let tolerance = parameters.tolerance(chord.programmed.feed.is_none());
                bulge = self.bulge(between, &parameters.left(tolerance, false, used));
            }
        }
        let mut from = (chord.from, [0.0; AXES]);
        let arc = if chord.arc { Vertex::<AXES>::ARC } else { 0 };
        let mut edge = edge;
        #[cfg(feature = "kinematics")]
        let is_long = self.is_transformed && self.cuts(between, parameters);
        #[cfg(feature = "kinematics")]
        if is_long {
            (count, long) = (0, false);
            if let (Some(_), Some(vertex)) = (between.before, self.vertices.back_mut()) {
                edge = Some(HALF);
                vertex.make_corner();
            }
        }
        let parts = 1.0 / (count + 1) as f32;
        for k in 1..=count.min(BETWEEN) {
            let w = match (long, k) {
                (false, _) => k as f32 * parts,
                (true, ..=ENDS) => k as f32 * step / chord.length,
                (true, _) => 1.0 - (2 * ENDS + 1 - k) as f32 * step / chord.length,
            };
            let mut at = chord.from;
            let part = to_i64(w * ONE_30);
            for (at, to) in at.iter_mut().zip(&chord.to) {
                let d = to.to_bits().wrapping_sub(at.to_bits());
                let d = crate::math::wide::mul_shift(d, part, 30);
                *at = Position::from_bits(at.to_bits().wrapping_add(d));
            }
            let offset = bulge.at(w, chord.length);
            self.append(&mut from, (&at, &offset), edge.take(), heading, (chord, arc | fixed, used));
        }
        let marks = between.marks | Vertex::<AXES>::PROGRAMMED | arc;
        self.append(&mut from, (&chord.to, &[0.0; AXES]), edge, heading, (chord, marks, used));
        #[cfg(feature = "kinematics")]
        if let (true, Some(vertex)) = (is_long, self.vertices.back_mut()) {
            vertex.make_corner();
        }
    }

    /// Whether the curve that the chord approximates lies so far outside the tolerance that each corner is a curve
    /// of its own ([`ALONE`]). Such a chord has no additional vertices: both ends move, and the line between them.
    #[cfg(feature = "kinematics")]
    fn cuts(&self, between: &Between<'_, AXES>, parameters: &Parameters) -> bool {
        let Between { chord, before, behind, .. } = between;
        let before = before.map_or(0.0, |before| self.length(&before.turn(chord)));
        let behind = behind.map_or(0.0, |behind| self.length(&chord.turn(behind)));
        let Tolerance { path, .. } = parameters.tolerance(chord.programmed.feed.is_none());
        !chord.half && 0.125 * chord.length * max(before, behind) > ALONE * path
    }

    /// Appends a vertex, with the turn at the vertex before.
    fn append(
        &mut self,
        from: &mut ([Position; AXES], [f32; AXES]),
        (at, offset): (&[Position; AXES], &[f32; AXES]),
        edge: Option<f32>,
        heading: &mut Option<[f32; AXES]>,
        (chord, marks, used): (&Chord<AXES>, u8, Used),
    ) {
        let is_straight = from.1.iter().chain(offset).all(|x| *x == 0.0);
        let mut d = [0.0; AXES];
        let ends = from.0.iter().zip(at).zip(from.1.iter().zip(offset));
        for (d, ((from, to), (before, offset))) in d.iter_mut().zip(ends) {
            *d = to_f32(to.to_bits().wrapping_sub(from.to_bits())) * LSB_32 + (offset - before);
        }
        let length = self.length(&d);
        let per = 1.0 / max(length, f32::MIN_POSITIVE);
        let direction = if is_straight { chord.direction } else { d.map(|d| d * per) };
        let mut turn = [0.0; AXES];
        if let Some(heading) = heading {
            for (turn, (now, before)) in turn.iter_mut().zip(direction.iter().zip(&*heading)) {
                *turn = now - before;
            }
        }
        self.push((at, offset), (&turn, edge), length, chord.programmed, (marks, used));
        *heading = Some(direction);
        *from = (*at, *offset);
    }
}

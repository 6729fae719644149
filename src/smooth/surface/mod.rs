//! `#HSC \[SURFACE\]`: short blocks become one curve with continuous direction and curvature, inside a
//! tolerance. The curve hardly depends on where exactly the programmed points lie on the surface of the
//! workpiece.
//!
//! **Method.** The contour is a sequence of vertices. Each vertex has a smoothing curve, its kernel, which
//! rounds the polygon over a part of the path (`knot.rs`). A kernel is as wide as the tolerance permits.
//! Kernels cut off corners. So the vertices first move outwards by the same amount, and the result follows
//! the curve that the chords approximate (`window.rs`). Vertices move farther where a straight run changes
//! into a curve (`lead.rs`). The output is a sequence of polynomials of the fifth degree (cells), which meet
//! at knots about half a kernel apart. There are far fewer cells than blocks.
//!
//! **Tolerance.** The planner computes the curve in `f32`. Before an element is emitted, integers check that
//! all of the element is inside the tolerance (`cell.rs`). If this check fails, the kernels become narrower
//! and the planner tries the element again. If no kernel is narrow enough, a straight line leads to the next
//! programmed point, with a corner there; the planner reports a warning.
//!
//! **Ends of a run.** Before an edge, a run ends in the middle of a line, and contour mode rounds the edge
//! (`edges.rs`, `smooth/edged.rs`). A run ends exactly at a vertex in these cases:
//!
//! - a turn beyond MAX_ANGLE;
//! - a dwell, or a function with acknowledgement;
//! - an exact stop (for the B-spline of `#HSC`, only with AUTO_OFF_G60);
//! - an arc that stays exact;
//! - a block without main axes;
//! - with AUTO_OFF_G00, a rapid block.
//!
//! A change of feed, or a function without acknowledgement, begins a new element; the run continues.
//!
//! Late text also ends a run, if the motion would otherwise stop. Only in this case does the path depend on
//! the arrival time of text. Where Surface works for `#CONTOUR MODE [DEV]` (`smooth/row.rs`), it waits for
//! late text instead.
mod cell;
mod chords;
mod edges;
mod knot;
mod lead;
mod narrowing;
mod parameters;
mod window;

pub(super) use edges::Edges;
pub use parameters::{Parameters, Used};

use self::cell::{Beside, Hull, Straight};
use self::chords::{Between, Chord, Source};
use self::edges::SHARPEST;
use self::knot::{Aim, Spot};
use self::window::{Programmed, Vertex, Window};
use crate::dynamics::{Curving, Dynamics, Near};
use crate::math::float::{max, min, to_i64};
use crate::math::wide::mul_shift;
use crate::nc::{NcWarningKind, Place};
use crate::path::poly::{Draft, Knot};
use crate::path::{Element, Measure, Passage, line_to};
use crate::quantity::Position;
use crate::smooth::{Data, Form, Parting, ProgrammedBlock, Smoothed, Smoother, middle};

/// Emits a line as a separate block. Returns whether there is a line.
#[inline(never)]
fn lay<const AXES: usize>(
    place: &mut Option<(ProgrammedBlock<AXES>, Parting)>,
    [from, to]: [&[Position; AXES]; 2],
    data: Data,
    measure: &Measure,
) -> bool {
    let block = ProgrammedBlock { element: Element::BLANK, from: *from, to: *to, form: Form::Line, data };
    let (block, _) = place.insert((block, Parting::None));
    let made = line_to([from, to], measure, &mut block.element) == Ok(true);
    if !made {
        *place = None;
    }
    made
}

/// An element that waits to be emitted.
#[derive(Clone, Copy, Debug)]
struct Made<const AXES: usize> {
    element: Element<AXES>,
    data: Data,
    due: u32,
    /// For a curve: the nearest sharp turn, which limits the speed.
    curve: Option<Near>,
    /// The polynomials of the axes, as far as they are made; `None` when all are made.
    draft: Option<Draft<AXES>>,
}

/// End of the elements that have been made.
#[derive(Clone, Copy, Debug)]
struct Front<const AXES: usize> {
    spot: Spot,
    knot: Knot<AXES>,
}

/// Failed attempts for the next element.
#[derive(Clone, Copy, Debug)]
struct Tried {
    halved: u8,
    narrowed: u8,
}

impl Tried {
    const NOTHING: Self = Self { halved: 0, narrowed: 0 };
}

/// State when the window did not suffice for the next element: checked vertices, the widest kernel, and
/// whether the end of the run is known.
type Waits = Option<(usize, f32, bool)>;

/// The smoothing stage of `#HSC [SURFACE]`.
#[derive(Debug)]
pub struct Surface<const AXES: usize> {
    measure: Measure,
    parameters: Parameters,
    window: Window<AXES>,
    /// The current block, if parts of it are not in the window yet.
    source: Option<Source<AXES>>,
    /// The last chord, which waits for the next chord, and the chord before it.
    pending: Option<Chord<AXES>>,
    passed: Option<Chord<AXES>>,
    /// Direction of the polygon at the end of the last chord.
    heading: Option<[f32; AXES]>,
    /// Set if the run ends after the current chords; the value tells whether the motion stops there.
    ending: Option<bool>,
    front: Option<Front<AXES>>,
    tried: Tried,
    waits: Waits,
    made: Option<Made<AXES>>,
    place: Place,
    /// The last sharp turn, with the distance of the front after this turn.
    behind: Near,
    /// The warning about corners that are not rounded.
    remark: Option<NcWarningKind>,
}

/// How often an element is halved, and how often the kernels are reduced.
const HALVED: u8 = 2;
const NARROWED: u8 = 14;
const NARROWER: f32 = 0.7;

/// From this turn on (twice the sine of half the angle: 41 degrees), the motion passes the turn at a constant
/// lower speed.
const SHARP: f32 = 0.7;
/// Factor by which the speed in such a turn may exceed the speed in curves of contour mode.
const QUICK: f32 = 1.1;

/// Largest ratio of the speed along a cell to the path speed.
const FASTEST: f32 = 1.5;

const ONE_30: f32 = (1u32 << 30) as f32;

impl<const AXES: usize> Surface<AXES> {
    // In place, in every build.
    #[inline(always)]
    pub fn new(measure: Measure, parameters: &Parameters) -> Self {
        Self {
            measure,
            parameters: *parameters,
            window: Window::new(&measure),
            source: None,
            pending: None,
            passed: None,
            heading: None,
            ending: None,
            front: None,
            tried: Tried::NOTHING,
            waits: None,
            made: None,
            place: Place::default(),
            behind: Near::NONE,
            remark: None,
        }
    }

    /// Ends the run after the current chords.
    fn end_row(&mut self) {
        self.window.vertices.clear();
        (self.window.wide, self.window.moved, self.window.checked) = (0, 0, 0);
        (self.window.ended, self.window.narrowing) = (false, None);
        (self.pending, self.passed, self.heading, self.front, self.ending) = (None, None, None, None, None);
        (self.tried, self.waits, self.behind) = (Tried::NOTHING, None, Near::NONE);
    }

    /// Takes a chord, or the end of the run, into the window. Returns `false` if there is no work.
    fn feed(&mut self) -> bool {
        if self.window.ended {
            return false;
        }
        if self.pending.is_some() && self.window.is_full() {
            // The window is full, and no element is possible.
            self.window.hurry();
            return true;
        }
        // A reference, because a source is large.
        let Some(source) = self.source.as_ref().filter(|source| !source.exact && self.ending.is_none())
        else {
            if self.ending.is_none() && self.source.is_some() && self.pending.is_some() {
                self.ending = Some(false);
            }
            if self.ending.is_none() {
                return false;
            }
            if let Some(pending) = &self.pending {
                self.ending = self.ending.map(|stop| stop || pending.stop);
                self.push(None, 0);
                self.window.ended = true;
                return true;
            }
            if self.window.len() == 0 {
                self.ending = None;
            }
            return false;
        };
        let Some(mut next) = source.chord(&self.window) else {
            // No main axis moves: the chord is the rounding of an arc's end.
            if let Some(source) = &mut self.source {
                source.go_on(&source.block.to.clone());
            }
            return self.finish_source();
        };
        next.stop = source.block.data.stop && self.parameters.stands();
        let mut marks = 0;
        if let Some(pending) = &self.pending
            && !source.parted
            && pending.programmed.feed == next.programmed.feed
            && let Some(most) = self.parameters.merged()
            && let Some(both) = pending.merged(&next, &most, &self.window)
        {
            self.pending = Some(both);
            if let Some(source) = &mut self.source {
                source.go_on(&next.to);
            }
            return self.finish_source();
        }
        if let Some(pending) = &self.pending {
            let turn = pending.turn(&next);
            let is_arc = source.block.form != Form::Line;
            let turn = self.window.length(&turn);
            if turn > SHARPEST || !is_arc && self.parameters.is_beyond(turn) {
                self.ending = Some(false);
                return true;
            }
            if source.parted && pending.programmed.number != next.programmed.number
                || pending.programmed.feed != next.programmed.feed
            {
                marks = Vertex::<AXES>::FORCED;
            }
            if pending.stop {
                marks |= Vertex::<AXES>::FORCED | Vertex::<AXES>::STANDS;
            }
            self.push(Some(&next), marks);
        }
        self.pending = Some(next);
        if let Some(source) = &mut self.source {
            self.place = source.block.data.place;
            source.go_on(&next.to);
        }
        self.finish_source()
    }

    /// Whether a block turns by more than kernels permit, although MAX_ANGLE permits the turn.
    fn is_sharp(&self, source: &Source<AXES>) -> bool {
        let Some(pending) = self.pending.as_ref().filter(|_| !source.exact && self.ending.is_none()) else {
            return false;
        };
        let turn = source.chord(&self.window).map_or(0.0, |next| self.window.length(&pending.turn(&next)));
        let is_arc = source.block.form != Form::Line;
        turn > SHARPEST && (is_arc || !self.parameters.is_beyond(turn))
    }

    /// The `rest` of the last line, in whose middle the run ends. The run ends there if the next block makes
    /// an edge with the line, or is an arc that stays exact. The rest is half of the line, or the whole line
    /// if the run has no other line. Returns whether the rest is half, and the shares of the tolerance that
    /// the merged lines use. Call this function only if a block may be taken.
    pub(super) fn leave(
        &mut self,
        block: &ProgrammedBlock<AXES>,
        dynamics: &Dynamics<AXES>,
        rest: &mut Option<(ProgrammedBlock<AXES>, Parting)>,
    ) -> Option<(bool, Used)> {
        let pending = self.pending.as_mut().filter(|_| self.ending.is_none())?;
        let edges = Edges { parameters: &self.parameters, space: self.window.space };
        if !edges.keeps(block) && !edges.parts(pending, block, dynamics) {
            return None;
        }
        let alone = self.window.len() == 0;
        let used = self.parameters.used(&pending.stray);
        let from = if alone { pending.from } else { middle(&pending.from, &pending.to) };
        let Programmed { feed, n, number } = pending.programmed;
        let data = Data { feed, n, place: self.place, number, stop: false };
        if !lay(rest, [&from, &pending.to], data, &self.measure) {
            return None;
        }
        if alone {
            self.pending = None;
        } else {
            (pending.to, pending.length, pending.half) = (from, 0.5 * pending.length, true);
            self.ending = Some(false);
        }
        Some((!alone, used))
    }

    /// Takes the second half of a line, in whose middle the run begins.
    pub(super) fn take_half(&mut self, block: &ProgrammedBlock<AXES>, dynamics: &Dynamics<AXES>) {
        self.take(block, dynamics, Parting::None);
        if let Some(source) = &mut self.source {
            source.half = true;
        }
    }

    /// Whether an element waits to be emitted.
    pub(super) const fn hands_out(&self) -> bool {
        self.made.is_some()
    }

    /// Removes the current block if all its chords have been taken. Returns `true`: there was work.
    fn finish_source(&mut self) -> bool {
        if let Some(source) = self.source.as_ref().filter(|source| source.is_over) {
            if source.block.data.stop && !self.parameters.stands() {
                self.ending = Some(true);
            }
            self.source = None;
        }
        true
    }

    /// Puts the waiting chord into the window.
    fn push(&mut self, behind: Option<&Chord<AXES>>, marks: u8) {
        let Some(chord) = self.pending.take() else { return };
        if self.window.len() == 0 {
            self.window.begin(&chord.from, &self.parameters);
            self.heading = None;
        }
        let before = self.passed.as_ref();
        let between = Between { chord: &chord, before, behind, marks };
        self.window.take(&between, &mut self.heading, &self.parameters);
        self.passed = Some(chord);
    }

    /// Makes the next element, or a part of it. Returns `false` if more of the contour has to be known.
    fn advance(&mut self, dynamics: &Dynamics<AXES>) -> bool {
        let Some(front) = &self.front else {
            if self.window.checked < 2 {
                return false;
            }
            let spot = Spot { vertex: 0, x: 0.0 };
            let Some(knot) = self.window.knot(&spot, &self.measure) else {
                self.give_up();
                return true;
            };
            self.front = Some(Front { spot, knot });
            return true;
        };
        let all = self.window.ended && self.window.checked == self.window.len();
        if all && front.spot.vertex + 1 >= self.window.len() {
            self.end_row();
            return true;
        }
        // Tries again only if more vertices are checked, the limit of widths has changed, or the end of the
        // run is known. New vertices alone are no reason to try.
        let known =
            Some((self.window.checked, self.window.reach, self.window.ended || self.window.is_full()));
        if self.waits == known {
            return false;
        }
        let Some(aim) = self.window.aim(&front.spot) else {
            self.waits = known;
            return false;
        };
        // One after the other, because each uses much stack.
        let is_done = aim.is_straight && self.go_straight(&aim);
        if !is_done && !self.bend(&aim, dynamics) {
            self.give_up();
        }
        true
    }

    /// Data of an element from the front to a place.
    fn data(&self, from: &Spot, to: &Spot) -> (Data, u32) {
        let chord = |k: usize| self.window.get(k).map(|vertex| vertex.programmed);
        let none = Programmed { feed: None, n: 0, number: 0 };
        let first = chord(from.vertex + 1).unwrap_or(none);
        let last = if to.x > 0.0 { chord(to.vertex + 1) } else { chord(to.vertex) }.unwrap_or(first);
        let ends = self.window.ended && to.vertex + 1 == self.window.len();
        let stands =
            to.x <= 0.0 && self.window.get(to.vertex).is_some_and(|vertex| vertex.is(Vertex::<AXES>::STANDS));
        let stop = stands || ends && self.ending == Some(true);
        let Programmed { feed, n, number } = last;
        (Data { feed, n, place: self.place, number, stop }, first.number)
    }

    /// Makes a line where the polygon does not turn. If the line leaves the tolerance, the kernels are
    /// reduced and the result is `false`.
    #[inline(never)]
    fn go_straight(&mut self, aim: &Aim) -> bool {
        let Some(front) = &self.front else { return false };
        let from = front.spot;
        let spot = self.window.advance(&from, aim.way);
        let Some(mut knot) = self.window.knot(&spot, &self.measure) else { return false };
        let mut straight = Straight::new(&front.knot.position, &knot.position);
        let main = self.window.space.0;
        if !self.is_inside(&from, &spot, |chord| straight.keeps(chord, main)) {
            return false;
        }
        let begin = front.knot.position;
        let data = self.data(&from, &spot);
        self.make(data);
        let Some(made) = &mut self.made else { return false };
        if line_to([&begin, &knot.position], &self.measure, &mut made.element) != Ok(true) {
            self.made = None;
            return false;
        }
        // The line has the direction of the polygon, except for rounding.
        knot.end = made.element.exit;
        self.behind.way += aim.way;
        self.reach(spot, &knot);
        true
    }

    /// Makes a cell. Returns `false` if no cell is possible.
    #[inline(never)]
    fn bend(&mut self, aim: &Aim, dynamics: &Dynamics<AXES>) -> bool {
        let Some(front) = &self.front else { return false };
        let from = front.spot;
        let way = aim.way / f32::from(1u8 << self.tried.halved.min(HALVED));
        let spot = self.window.advance(&from, way);
        let mut knot = Knot::BLANK;
        let shape = self.cell(front, &spot, &mut knot);
        if shape.is_some_and(|shape| self.begin(&spot, &knot, shape)) {
            let rapid = self.made.as_ref().is_some_and(|made| made.data.feed.is_none());
            let near = self.near(&from, way, rapid, dynamics);
            if let Some(made) = &mut self.made {
                made.curve = Some(near);
            }
            self.reach(spot, &knot);
        } else if self.tried.halved < HALVED {
            self.tried.halved += 1;
        } else if self.tried.narrowed < NARROWED {
            self.tried.halved = 0;
            self.tried.narrowed += 1;
            self.narrow(&from, aim.way);
        } else {
            return false;
        }
        true
    }

    /// Begins an element from the front to a knot, with `length` (mm). `fastest`: bound of its speed relative
    /// to the path speed. Returns whether the element can be made.
    #[inline(never)]
    fn begin(&mut self, spot: &Spot, knot: &Knot<AXES>, [length, fastest]: [f32; 2]) -> bool {
        let Some(from) = self.front.as_ref().map(|front| front.spot) else { return false };
        let data = self.data(&from, spot);
        let is_corner = self.window.is_transformed() && self.window.is_in_corner(&from, length);
        let steady = is_corner || self.window.is_near_step(&from, length);
        self.make(data);
        let (Some(made), Some(front)) = (&mut self.made, &self.front) else { return false };
        made.draft = Draft::begin(&mut made.element, [&front.knot, knot], length, fastest);
        if let Some(bounds) = &mut made.element.bounds {
            bounds.passage = if steady { Passage::Steady } else { Passage::Flowing };
        }
        if made.draft.is_none() {
            self.made = None;
        }
        self.made.is_some()
    }

    /// The sharp turn in an element of `length` (mm), or the nearer one of its neighbours.
    #[inline(never)]
    fn near(&mut self, from: &Spot, length: f32, rapid: bool, dynamics: &Dynamics<AXES>) -> Near {
        self.behind.way += length;
        let Some((vertex, way)) = self.window.sharp(from) else { return self.behind };
        let per = 1.0 / vertex.width;
        let second = vertex.moved_turn.map(|x| x * per);
        let third = second.map(|x| x * per);
        let v = QUICK * dynamics.passing([&second, &third], rapid, self.parameters.check_jerk());
        if way < 0.5 * length {
            self.behind = Near { v, way: 0.0 };
            if self.window.length(&vertex.moved_turn) < SHARP {
                return Near::NONE;
            }
        } else if way < self.behind.way {
            return Near { v, way };
        }
        self.behind
    }

    /// Computes the cell from the front to a place, with its `knot` there. Returns its length and its largest
    /// speed relative to the path, or `None` if the cell leaves the tolerance.
    #[inline(never)]
    fn cell(&self, front: &Front<AXES>, spot: &Spot, knot: &mut Knot<AXES>) -> Option<[f32; 2]> {
        *knot = self.window.knot(spot, &self.measure)?;
        let space = |d: &[f32; AXES]| self.window.length(d);
        let length = self.window.way(&front.spot, spot);
        let mut hull = Hull::new(&front.knot, knot, length)?;
        let fastest = max(hull.fastest(length, space), 1.0);
        if !(fastest < FASTEST && length > 0.0) {
            return None;
        }
        let (origin, main) = (&front.knot.position, self.window.space.0);
        let inside = self.is_inside(&front.spot, spot, |chord| hull.keeps(origin, chord, main));
        inside.then_some([length, fastest])
    }

    /// Whether all of an element is inside the tolerance. `keeps` checks one chord after the other.
    fn is_inside(&self, from: &Spot, to: &Spot, mut keeps: impl FnMut(&Beside<'_, AXES>) -> bool) -> bool {
        let mut left = self.window.way(from, to);
        let mut x = from.x;
        let mut at = self.on_contour(from);
        for k in from.vertex..=to.vertex {
            let last = k == to.vertex;
            if last && to.x <= 0.0 {
                break;
            }
            let Some(vertex) = self.window.get(k + 1) else { return false };
            let way = if last { to.x - x } else { vertex.moved_length - x };
            let end = if last { self.on_contour(to) } else { vertex.at };
            let is_last = last || k + 1 == to.vertex && to.x <= 0.0;
            let part = if is_last { 1.0 } else { way / max(left, f32::MIN_POSITIVE) };
            if !keeps(&Beside { ends: [&at, &end], tolerance: self.tolerance(k + 1), part }) {
                return false;
            }
            left -= way;
            (x, at) = (0.0, end);
        }
        true
    }

    /// The tolerance that is left for the curve at the chord before vertex `k`.
    fn tolerance(&self, k: usize) -> parameters::Tolerance {
        let vertex = self.window.get(k);
        let arc = vertex.is_some_and(|vertex| vertex.is(Vertex::<AXES>::ARC));
        let used = vertex.map_or(Used::NOTHING, |vertex| vertex.used);
        self.parameters.left(self.programmed(k), arc, used)
    }

    /// The programmed tolerance at the chord before vertex `k`.
    fn programmed(&self, k: usize) -> parameters::Tolerance {
        let rapid = |k: usize| self.window.get(k).is_none_or(|vertex| vertex.programmed.feed.is_none());
        if !rapid(k) {
            return self.parameters.tolerance(false);
        }
        let own = self.parameters.tolerance(true);
        if rapid(k + 1) && k.checked_sub(1).is_none_or(|k| k == 0 || rapid(k)) {
            return own;
        }
        let normal = self.parameters.tolerance(false);
        parameters::Tolerance { path: max(own.path, normal.path), track: max(own.track, normal.track) }
    }

    /// The point of the programmed contour at a place.
    fn on_contour(&self, spot: &Spot) -> [Position; AXES] {
        let Some(from) = self.window.get(spot.vertex) else { return [Position::ZERO; AXES] };
        let mut at = from.at;
        let Some(to) = self.window.get(spot.vertex + 1) else { return at };
        let part = min(spot.x / max(to.moved_length, f32::MIN_POSITIVE), 1.0);
        let part = to_i64(part * ONE_30);
        for (at, to) in at.iter_mut().zip(&to.at) {
            let d = mul_shift(to.to_bits().wrapping_sub(at.to_bits()), part, 30);
            *at = Position::from_bits(at.to_bits().wrapping_add(d));
        }
        at
    }

    /// Moves the front to a place and drops vertices far before this place.
    #[inline(never)]
    fn reach(&mut self, mut spot: Spot, knot: &Knot<AXES>) {
        (self.tried, self.waits) = (Tried::NOTHING, None);
        let widest = self.parameters.widest();
        if self.window.reach < widest {
            self.window.reach = min(widest, self.window.reach * 1.02);
        }
        while spot.vertex > 0
            && let Some(first) = self.window.get(0)
        {
            let way = self.window.since(&spot, 0);
            if first.width > way {
                break;
            }
            self.window.pop();
            spot.vertex -= 1;
        }
        self.front = Some(Front { spot, knot: *knot });
    }

    /// Reduces the kernels that reach the next element.
    #[cold]
    #[inline(never)]
    fn narrow(&mut self, from: &Spot, way: f32) {
        let to = self.window.advance(from, way);
        let mut last = to.vertex + 1;
        let mut away = 0.0;
        while let Some(vertex) = self.window.get(last + 1)
            && last + 1 < self.window.moved
        {
            away += vertex.moved_length;
            if away > vertex.width {
                break;
            }
            last += 1;
        }
        let first = (0..from.vertex)
            .find(|k| self.window.get(*k).is_some_and(|vertex| vertex.width > self.window.since(from, *k)));
        self.window.narrow(first.unwrap_or(from.vertex), last, NARROWER);
    }

    /// Makes a straight line to the next programmed vertex, where the motion stops.
    #[cold]
    #[inline(never)]
    fn give_up(&mut self) {
        self.remark = Some(NcWarningKind::SurfaceLost);
        let from = self.front.map_or(Spot { vertex: 0, x: 0.0 }, |front| front.spot);
        let known = self.window.moved.max(2).min(self.window.len());
        let next = (from.vertex + 1..known)
            .find(|k| self.window.get(*k).is_some_and(|vertex| vertex.is(Vertex::<AXES>::PROGRAMMED)));
        let next = next.unwrap_or(known.saturating_sub(1));
        let at = self.window.get(next).map(|vertex| vertex.at);
        let start =
            self.front.map(|front| front.knot.position).or(self.window.get(from.vertex).map(|v| v.at));
        if let (Some(start), Some(at)) = (start, at) {
            let data = self.data(&from, &Spot { vertex: next, x: 0.0 });
            self.make(data);
            let made = self.made.as_mut();
            let line = made.map(|made| line_to([&start, &at], &self.measure, &mut made.element));
            if line != Some(Ok(true)) {
                self.made = None;
            }
        }
        (self.tried, self.waits) = (Tried::NOTHING, None);
        self.front = None;
        if self.window.ended && next + 1 >= self.window.len() {
            self.end_row();
        } else {
            self.window.restart(next);
        }
    }

    /// Makes a line in place of a cell that cannot be made. This case does not occur, because every cell in
    /// the range of a hull can be made.
    #[cold]
    #[inline(never)]
    fn replace(&mut self, from: &[Position; AXES]) {
        let Some(made) = &mut self.made else { return };
        (made.draft, made.curve) = (None, None);
        let line = self
            .front
            .as_ref()
            .map(|front| line_to([from, &front.knot.position], &self.measure, &mut made.element));
        if line != Some(Ok(true)) {
            self.made = None;
        }
    }

    /// Passes the current block unchanged.
    #[inline(never)]
    fn pass(&mut self) {
        if let Some(source) = &self.source {
            let ProgrammedBlock { element, data, .. } = &source.block;
            let (element, data, due) = (*element, *data, data.number);
            self.made = Some(Made { element, data, due, curve: None, draft: None });
        }
        (self.source, self.ending) = (None, None);
    }

    /// Starts to make an element.
    #[inline(never)]
    fn make(&mut self, (data, due): (Data, u32)) {
        self.made = Some(Made { element: Element::BLANK, data, due, curve: None, draft: None });
    }
}

impl<const AXES: usize> Smoother<AXES> for Surface<AXES> {
    #[inline(never)]
    fn take(&mut self, block: &ProgrammedBlock<AXES>, dynamics: &Dynamics<AXES>, parting: Parting) {
        self.window.transform(dynamics.is_transformed());
        let moves = block.from.iter().zip(&block.to).enumerate();
        let moves = moves.filter(|(k, _)| self.window.is_main(*k)).any(|(_, (from, to))| from != to);
        let rapid = block.data.feed.is_none() && self.parameters.leaves_rapid();
        let (chord, arc) = match block.form {
            Form::Line => (None, false),
            Form::Arc { .. } => (self.parameters.chord_of(&block.element), true),
        };
        let long = !arc
            && Chord::length_of(block, &self.window).is_some_and(|length| self.parameters.is_longer(length));
        let exact = rapid || long || if arc { chord.is_none() } else { !moves };
        if (exact || parting == Parting::Awaited) && self.holds() {
            self.ending = self.ending.or(Some(false));
        }
        let source = Source::new(block, chord, exact, parting != Parting::None);
        if self.is_sharp(&source) {
            self.remark = Some(NcWarningKind::SurfaceSharp);
        }
        self.source = Some(source);
    }

    #[inline(never)]
    fn work(&mut self, dynamics: &Dynamics<AXES>) -> bool {
        if let Some(made) = &mut self.made {
            let Some(draft) = made.draft.as_mut().filter(|draft| !draft.is_done()) else { return false };
            if draft.go_on(&mut made.element).is_some() {
                // The element is emitted in the same call.
                return !draft.is_done();
            }
            let from = *draft.from();
            self.replace(&from);
            return true;
        }
        if self.window.len() > 0
            && (self.window.go_on_narrowing(&self.parameters)
                || self.advance(dynamics)
                || self.window.check(&self.parameters)
                || self.window.move_out(&self.parameters))
        {
            return true;
        }
        if self.window.len() > 0 && self.window.widen(&self.parameters) {
            return true;
        }
        if self.window.len() == 0
            && self.pending.is_none()
            && self.source.as_ref().is_some_and(|source| source.exact)
        {
            self.pass();
            return true;
        }
        self.feed()
    }

    fn emit(&mut self, into: impl FnOnce(&Smoothed<'_, AXES>)) -> bool {
        let Some(Made { element, data, due, curve: near, draft }) = &self.made else { return false };
        if draft.as_ref().is_some_and(|draft| !draft.is_done()) {
            return false;
        }
        let jerk = self.parameters.check_jerk();
        let curving = near.map(|near| Curving { jerk, constant: None, near });
        into(&Smoothed {
            element,
            end: draft.as_ref().map(Draft::to),
            data,
            curving,
            due: *due,
            known: None,
        });
        self.made = None;
        true
    }

    fn flush(&mut self, stop: bool) {
        if self.holds() {
            self.ending = Some(stop || self.ending == Some(true));
        }
    }

    fn cancel(&mut self) {
        self.flush(false);
    }

    fn clear(&mut self) {
        self.end_row();
        (self.source, self.made) = (None, None);
    }

    fn restart(&mut self) {
        self.clear();
    }

    fn place(&self) -> Option<Place> {
        Some(self.source.map_or(self.place, |source| source.block.data.place))
    }

    fn remark(&mut self) -> Option<NcWarningKind> {
        self.remark.take()
    }

    fn is_idle(&self) -> bool {
        false
    }

    fn is_empty(&self) -> bool {
        !self.holds()
    }

    fn rounds(&self) -> bool {
        false
    }

    fn holds(&self) -> bool {
        self.window.len() > 0 || self.pending.is_some() || self.source.is_some() || self.made.is_some()
    }

    fn gives_way(&mut self) -> bool {
        let waits = self.holds() && self.ending.is_none();
        self.flush(false);
        waits
    }
}

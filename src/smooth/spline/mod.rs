//! Splines: the end points of lines become the points of a smooth curve.
//!
//! | command | curve | file |
//! |---|---|---|
//! | G151, #SPLINE TYPE AKIMA | through all points | `akima.rs` |
//! | G151, #SPLINE TYPE BSPLINE | B-spline with the points as its control points | `polygon.rs` |
//! | #HSC \[BSPLINE\] | B-spline with the points as its control points, inside a tolerance | `polygon.rs`, or Surface |
//! | #HSC \[OPMODE=2\] | through all points, except at prismatic corners, which are rounded inside a tolerance | both |
//!
//! Surface (`surface/mod.rs`) makes the curve of `#HSC \[BSPLINE\]` if PATH_DEV is above 0, and
//! AUTO_OFF_PATH, AUTO_OFF_TRACK and P-CHAN-00239 are off. A build without Surface always uses `polygon.rs`.
//!
//! The curve over a block depends on a few points before and after it, so blocks are held back until these
//! points are known. A command that demands a stop (a dwell, a wait, the end of the program) ends the curve
//! at the last point. The next block then begins a new curve. At an exact stop (G60, G360), the motion stops
//! on the curve; on a B-spline, at the place nearest to the point.
//!
//! A line stays straight, between two curves, in three cases:
//!
//! - the line moves no axis of the path;
//! - its path length exceeds the travel of these axes by more than a thousandth;
//! - these axes travel less than half a micrometre.
//!
//! An arc is passed on unchanged. An Akima spline is tangential to the arc at both ends of the arc.
//!
//! An Akima spline has a continuous direction; its curvature has steps at its points. If P-CHAN-00009 limits
//! the jerk of such a step, and the slope is not STEP, both sides get the same curvature at the point: the
//! mean. This moves the curve near the point by at most `cut::BENT`.
mod akima;
mod cut;
mod parameters;
mod polygon;
mod window;

pub use parameters::{DirectParameters, HscParameters, Rules, slope};

use self::akima::{Given, is_corner, slopes};
use self::cut::{BENT, Cut, Joint, Piece, curvature};
use self::polygon::{Inside, Tolerance, direct, exceeds, part, reach};
use self::window::{Leg, Vertex, Window, along};
use crate::dynamics::{Curving, Dynamics, Near};
use crate::math::float::{max, min, to_f32, to_i64};
use crate::math::root::sqrt_f32;
use crate::nc::{NcWarningKind, Place};
use crate::path::poly::{Draft, Knot};
use crate::path::{Element, End, Measure, Passage, line};
use crate::quantity::{DISTANCE_LSB, Position};
use crate::smooth::contour::curve::{aside, direction, plus, size};
use crate::smooth::{Data, Form, Parting, ProgrammedBlock, Smoothed, Smoother};

const LSB_32: f32 = 1.0 / (1u64 << 32) as f32;

/// Largest ratio of a block's path length to the travel of the path axes.
const LONGER: f32 = 1.0 + 1.0 / 1024.0;
/// Shortest leg of the curve, mm. A shorter leg is only a few steps of a position long, so its direction
/// would be inaccurate.
const SHORTEST_LEG: f32 = 5e-4;
/// Smallest length of a direction along the path axes, for a tangential end.
const LEAST_TANGENT: f32 = 0.5;
/// A part is prismatic if the change of direction is above 20° (the cosine of this angle), or the ratio of
/// lengths is above 4.
const PRISMATIC: [f32; 2] = [0.939_692_6, 4.0];
/// Cosine of the largest angle of a rounded corner: 178°.
const REVERSAL: f32 = -0.999_390_8;
/// Curvature change over an element of length 1 that moves the element by 1.
const SHIFT: f32 = 0.017_28;
/// Smallest part of a leg in which curvature changes.
const LEAST_PART: f32 = 1.0 / 256.0;
/// Points that are left out move the path by at most this part of PATH_DEV, all together.
const MERGED: f32 = 1.0 / 128.0;

/// The kind of curve that the spline stage makes from points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Mode {
    /// An Akima spline (G151), which passes the points.
    Akima,
    /// A B-spline (G151) with the points as its control points.
    Direct,
    /// The B-spline of `#HSC`, with its tolerances.
    Control(Rules),
    /// The spline of `#HSC [OPMODE=2]`, with its tolerance CONTERROR in mm.
    Interpolating(f32),
}

/// The start of a curve: its kind, and its direction if one is given.
#[derive(Clone, Copy, Debug)]
pub struct Start<const AXES: usize> {
    pub mode: Mode,
    /// The slope given by the program.
    pub slope: Option<[f32; AXES]>,
    /// Direction and curvature at the end of the block before, for a tangential start.
    pub entry: Option<End<AXES>>,
}

/// An element in progress, or one that waits to be emitted.
#[derive(Clone, Copy, Debug)]
struct Made<const AXES: usize> {
    element: Element<AXES>,
    data: Data,
    curving: Option<Curving>,
    due: u32,
    draft: Option<Draft<AXES>>,
}

/// How a curve begins and ends.
#[derive(Clone, Copy, Debug)]
struct Ends<const AXES: usize> {
    given: Given<AXES>,
    /// Start of the curve after a block with a given end: point, direction and curvature.
    entry: Option<End<AXES>>,
    /// End of the curve before a block with a given start: point, direction and curvature.
    exit: Option<End<AXES>>,
}

/// The place on the curve where the next element begins.
#[derive(Clone, Copy, Debug)]
struct Course<const AXES: usize> {
    /// Number of the part in the current leg.
    part: usize,
    /// End of the last element, and how the next piece continues.
    here: Knot<AXES>,
    joint: Joint<AXES>,
    piece: Option<Piece<AXES>>,
    /// Data of the piece. Also the number of motion blocks whose functions act before it.
    data: (Data, u32),
}

/// The smoothing stage: from linear blocks to the elements of a curve.
#[derive(Clone, Copy, Debug)]
pub struct Splining<const AXES: usize> {
    measure: Measure,
    /// P-CHAN-00110.
    check_jerk: u8,
    mode: Mode,
    on: bool,
    /// Whether the next block gives the direction at the end of the curve.
    waits: bool,
    window: Window<AXES>,
    ends: Ends<AXES>,
    /// Number of points since the spline was switched on.
    points: u32,
    /// Total distance of the left-out points from the path, mm.
    stray: f32,
    course: Course<AXES>,
    made: Option<Made<AXES>>,
    /// The block after the curve.
    behind: Option<ProgrammedBlock<AXES>>,
}

impl<const AXES: usize> Splining<AXES> {
    /// Begins a spline. `check_jerk`: value of P-CHAN-00110. Inline, so that the value is made in place.
    #[inline(always)]
    pub fn new(measure: Measure, check_jerk: u8, start: &Start<AXES>) -> Self {
        let data = Data { feed: None, n: 0, place: Place::NONE, number: 0, stop: false };
        let here = cut::at([Position::ZERO; AXES]);
        Self {
            measure,
            check_jerk,
            mode: start.mode,
            on: true,
            waits: false,
            window: Window::new(along(&measure, AXES)),
            ends: Ends { given: Given { start: start.slope, end: None }, entry: start.entry, exit: None },
            points: 0,
            stray: 0.0,
            course: Course { part: 0, here, joint: Joint::Corner, piece: None, data: (data, 0) },
            made: None,
            behind: None,
        }
    }

    /// The kind of the spline.
    pub const fn mode(&self) -> Mode {
        self.mode
    }

    /// Number of points since the spline was switched on, including the start.
    pub const fn points(&self) -> u32 {
        self.points
    }

    /// Ends the list of points. `end`: the slope at the end of the curve, if one is given. `waits`: whether
    /// the next block gives this slope.
    pub fn switch_off(&mut self, end: Option<[f32; AXES]>, waits: bool) {
        self.on = false;
        if waits && self.window.has_leg() && !self.window.is_closed() {
            self.waits = true;
        } else {
            self.ends.given.end = end;
            self.close();
        }
    }

    /// Ends the curve with the last point.
    fn close(&mut self) {
        self.waits = false;
        self.window.close();
    }

    /// Ends the curve tangentially where the element `next` begins.
    fn close_into(&mut self, next: &Element<AXES>) {
        self.ends.given.end = tangent(&self.window, &next.entry);
        self.ends.exit = self.ends.given.end.map(|_| next.entry);
        self.close();
    }

    /// Drops the curve; the next one begins with this end, or without a given direction.
    fn begin(&mut self, entry: Option<End<AXES>>) {
        self.window.clear();
        let slope = entry.as_ref().and_then(|entry| tangent(&self.window, entry));
        let entry = entry.filter(|_| slope.is_some());
        self.ends = Ends { given: Given { start: slope, end: None }, entry, exit: None };
        self.stray = 0.0;
        (self.course.part, self.course.joint) = (0, Joint::Corner);
    }

    /// MERGE: leaves the previous point out, if three conditions hold. The point is on the straight line
    /// between its neighbours, the feed does not change there, and no command acts there.
    #[inline(never)]
    fn merges(&mut self, block: &ProgrammedBlock<AXES>) -> bool {
        let Mode::Control(Rules { merge: true, path_dev, .. }) = self.mode else { return false };
        let window = &self.window;
        let Some(last) = (0..window::POINTS as i32).rev().find(|i| window.point(*i).is_some()) else {
            return false;
        };
        let (Some(middle), Some(first)) = (window.point(last), window.point(last - 1)) else { return false };
        let same = middle.data.feed == block.data.feed && !middle.data.stop;
        let whole = window::travel(&first.at, &block.to);
        let way = window::travel(&first.at, &middle.at);
        let axes = window.axes();
        let square = crate::smooth::contour::curve::dot(axes, &whole, &whole);
        let share = crate::smooth::contour::curve::dot(axes, &way, &whole) / max(square, f32::MIN_POSITIVE);
        let off = plus(&way, -share, &whole);
        let stray = max(size(axes, &off), aside(axes, &off));
        if !(same && share > 0.0 && share < 1.0) || self.stray + stray > MERGED * path_dev {
            return false;
        }
        self.stray += stray;
        self.window.replace(Vertex { at: block.to, data: block.data });
        true
    }

    /// Whether the curve has a corner at a point: it has no slope, or the path is prismatic there.
    fn is_corner(&self, i: i32) -> bool {
        match self.mode {
            Mode::Interpolating(_) => is_corner(&self.window, i, PRISMATIC[0], PRISMATIC[1]),
            _ => is_corner(&self.window, i, -1.0, f32::MAX),
        }
    }

    /// Whether a leg is straight except near its rounded ends.
    fn is_straight(&self, leg: i32) -> bool {
        match self.mode {
            Mode::Akima => false,
            // A stop has ended the curve with too few points. The result is a polygon, and the curve passes
            // its ends.
            Mode::Direct => self.window.is_short(),
            Mode::Control(_) => true,
            Mode::Interpolating(_) => self.is_corner(leg) || self.is_corner(leg + 1),
        }
    }

    /// Slopes of the curve before and after a point.
    fn slopes(&self, i: i32) -> Option<[[f32; AXES]; 2]> {
        let slope = |leg: i32| self.window.leg(leg).map(|leg: Leg<AXES>| leg.slope);
        if self.is_straight(i - 1)
            && let Some(before) = slope(i - 1)
        {
            return Some([before; 2]);
        }
        if self.is_straight(i)
            && let Some(behind) = slope(i)
        {
            return Some([behind; 2]);
        }
        slopes(&self.window, &self.ends.given, i, |i| self.is_corner(i))
    }

    /// How an Akima curve continues at a point after its first point: with the common curvature of both
    /// sides.
    fn joint(&self, i: i32, dynamics: &Dynamics<AXES>) -> Joint<AXES> {
        let axes = self.window.axes();
        if self.is_corner(i) || (self.window.is_end(i) && self.ends.exit.is_none()) {
            return Joint::Corner;
        }
        let bends = dynamics.limits_bends();
        let ends = (self.slopes(i - 1), self.slopes(i), self.window.leg(i - 1));
        let (Some([_, t0]), Some([t1, _]), Some(before)) = ends else { return Joint::Tangent };
        if !bends || self.is_straight(i - 1) || self.is_straight(i) {
            return Joint::Tangent;
        }
        // Second derivatives of both cubics.
        let second = plus(&plus(&before.slope.map(|m| -6.0 * m), 2.0, &t0), 4.0, &t1);
        let own = curvature(axes, &t1, &second.map(|x| x / before.length));
        let (mean, shortest) = match (&self.ends.exit, self.window.leg(i), self.slopes(i + 1)) {
            (_, Some(behind), Some([t2, _])) => {
                let second = plus(&plus(&behind.slope.map(|m| 6.0 * m), -4.0, &t1), -2.0, &t2);
                let other = curvature(axes, &t1, &second.map(|x| x / behind.length));
                (plus(&own, 1.0, &other).map(|x| 0.5 * x), max(before.length, behind.length))
            }
            (Some(exit), ..) => (exit.curvature, before.length),
            _ => return Joint::Tangent,
        };
        bent(axes, &own, mean, shortest)
    }

    /// The piece of an Akima spline over the current leg.
    fn akima_piece(&mut self, dynamics: &Dynamics<AXES>) -> Option<()> {
        let (leg, from) = (self.window.leg(0)?, self.window.point(0)?.at);
        let to = *self.window.point(1)?;
        let ([_, t0], [t1, _]) = (self.slopes(0)?, self.slopes(1)?);
        let third = leg.length * (1.0 / 3.0);
        let inner = [t0.map(|t| t * third), plus(&leg.travel, -third, &t1)];
        let bezier = [[0.0; AXES], inner[0], inner[1], leg.travel];
        let first = self.window.is_end(0);
        if first && let Some(entry) = self.ends.entry {
            self.course.here = Knot { position: from, end: entry };
            let second = plus(&plus(&leg.slope.map(|m| 6.0 * m), -4.0, &t0), -2.0, &t1);
            let own = curvature(self.window.axes(), &t0, &second.map(|x| x / leg.length));
            self.course.joint = match dynamics.limits_bends() {
                true => bent(self.window.axes(), &own, entry.curvature, leg.length),
                false => Joint::Tangent,
            };
        }
        let end = self.joint(1, dynamics);
        let (data, due) = (to.data, to.data.number);
        self.lay(&bezier, &from, &from, &to.at, end, (data, due));
        Some(())
    }

    /// The piece of a direct B-spline over the current leg. Outer legs have no piece.
    fn direct_piece(&mut self) -> Option<()> {
        let Some(bezier) = direct(&self.window) else {
            self.window.advance();
            return Some(());
        };
        let (first, last) = (self.window.is_end(-1), self.window.is_end(2));
        let (before, from) = (*self.window.point(-1)?, *self.window.point(0)?);
        let (to, behind) = (*self.window.point(1)?, *self.window.point(2)?);
        let leg = self.window.leg(0)?;
        let mut data = to.data;
        let mut due = data.number;
        let (mut begins, mut ends) =
            (self.course.here.position, shifted(&to.at, &plus(&bezier[3], -1.0, &leg.travel)));
        if first {
            (begins, due) = (before.at, from.data.number);
            data.stop |= from.data.stop;
        }
        if last {
            let stop = data.stop | behind.data.stop;
            (ends, data) = (behind.at, Data { stop, ..behind.data });
        }
        let joint = if last { Joint::Corner } else { Joint::Smooth };
        self.lay(&bezier, &from.at, &begins, &ends, joint, (data, due));
        Some(())
    }

    /// The tolerance of corners that are rounded.
    fn tolerance(&self) -> Tolerance {
        match self.mode {
            Mode::Control(rules) => rules.tolerance(),
            Mode::Interpolating(conterror) => Tolerance { path: conterror, track: f32::MAX },
            Mode::Akima | Mode::Direct => Tolerance { path: f32::MAX, track: f32::MAX },
        }
    }

    /// Permitted distance between a point and its control points. Returns `None` if the curve passes the
    /// point.
    fn reach(&self, i: i32) -> Option<f32> {
        let window = &self.window;
        if window.is_end(i) || !self.is_straight(i - 1) || !self.is_straight(i) {
            return None;
        }
        let stops = window.point(i)?.data.stop;
        let room = reach(window, i, &self.tolerance())?;
        let turns = |cosine: f32| is_corner(window, i, cosine, f32::MAX);
        let Mode::Control(rules) = self.mode else {
            return (!turns(REVERSAL)).then_some(room);
        };
        let is_off = |leg: i32| {
            let (Some(long), Some(end)) = (window.leg(leg), window.point(leg + 1)) else { return false };
            long.length > rules.longest || (rules.off_rapid && end.data.feed.is_none())
        };
        let beyond = |off: bool, track: bool| off && exceeds(window, i, &rules.part_of_tolerance(track));
        let off = turns(rules.cosine)
            || is_off(i - 1)
            || is_off(i)
            || beyond(rules.off_path, false)
            || beyond(rules.off_track, true);
        let kept = (stops && rules.off_stop) || (off && (turns(REVERSAL) || !rules.rounds));
        (!kept).then_some(room)
    }

    /// Control points inside a leg.
    fn inside(&self, leg: i32) -> Option<Inside> {
        let reach = |i: i32| self.reach(i).unwrap_or(f32::MAX);
        Some(Inside::new(self.window.leg(leg)?.length, [reach(leg), reach(leg + 1)]))
    }

    /// The next piece of a polygon over the current leg.
    fn control_piece(&mut self) -> Option<()> {
        let (leg, inside) = (self.window.leg(0)?, self.inside(0)?);
        let (from, to) = (*self.window.point(0)?, *self.window.point(1)?);
        let i = self.course.part;
        let step = |leg: Leg<AXES>, way: f32| leg.slope.map(|x| x * way);
        let before = self.reach(0).and_then(|_| {
            let before = self.window.leg(-1)?;
            Some(step(before, -self.inside(-1)?.last(before.length)))
        });
        let behind = self.reach(1).and_then(|_| Some(step(self.window.leg(1)?, self.inside(1)?.first())));
        let (is_first, is_last) = (i == 0, i == inside.count);
        let bezier = part(&leg, &inside, i, [before, behind]);
        let end = match behind {
            _ if !is_last => shifted(&from.at, &bezier[3]),
            Some(_) => shifted(&to.at, &plus(&bezier[3], -1.0, &leg.travel)),
            None => to.at,
        };
        let begins = if is_first && before.is_none() { from.at } else { self.course.here.position };
        if is_first && before.is_none() && !self.goes_on(0) {
            self.course.joint = Joint::Corner;
        }
        let joint = match behind {
            None if is_last && !self.goes_on(1) => Joint::Corner,
            None if is_last => Joint::Tangent,
            _ => Joint::Smooth,
        };
        let data = Data { stop: to.data.stop && is_last, ..to.data };
        let rounded = (is_first && before.is_some()) || (is_last && behind.is_some());
        if !rounded {
            // The piece is straight over the whole leg.
            self.go_straight(&begins, &end, (data, data.number));
            (self.course.here, self.course.joint) = (cut::at(end), joint);
            if let Some(made) = &self.made {
                self.course.here.end = made.element.exit;
            }
            self.next_part();
            return Some(());
        }
        self.lay(&bezier, &from.at, &begins, &end, joint, (data, data.number));
        Some(())
    }

    /// Whether an Akima curve meets a straight leg at a point.
    fn goes_on(&self, i: i32) -> bool {
        !self.window.is_end(i) && self.is_straight(i - 1) != self.is_straight(i)
    }

    /// Starts to cut a piece.
    #[inline(never)]
    fn lay(
        &mut self,
        bezier: &[[f32; AXES]; 4],
        origin: &[Position; AXES],
        begins: &[Position; AXES],
        ends: &[Position; AXES],
        end: Joint<AXES>,
        data: (Data, u32),
    ) {
        let here = Knot { position: *begins, ..self.course.here };
        let joints = [self.course.joint, end];
        let piece = Piece::new(self.window.axes(), bezier, origin, (&here, ends), &joints);
        self.course.piece = Some(piece);
        self.course.joint = end;
        self.course.data = data;
    }

    /// Continues with a straight line.
    fn go_straight(&mut self, from: &[Position; AXES], to: &[Position; AXES], (data, due): (Data, u32)) {
        let Ok(Some(element)) = line(from, to, &self.measure) else { return };
        self.made = Some(Made { element, data, curving: None, due, draft: None });
    }

    /// Goes on to the next part of the leg, or to the next leg.
    fn next_part(&mut self) {
        self.course.part += 1;
        let parts = if self.is_straight(0) { self.inside(0) } else { None };
        if parts.is_none_or(|inside| self.course.part > inside.count) {
            self.next_leg();
        }
    }

    /// Goes on after the last piece of a leg.
    fn next_leg(&mut self) {
        self.window.advance();
        self.course.part = 0;
    }

    /// The next element of the piece.
    fn cut(&mut self) {
        let axes = *self.window.axes();
        let Some(piece) = &mut self.course.piece else { return };
        let from = piece.here().position;
        let cut = piece.cut(&axes);
        let (mut data, due) = self.course.data;
        let last = match cut {
            Cut::Again => return,
            Cut::Element(_, _, last) | Cut::Straight(_, last) => last,
        };
        data.stop &= last;
        match cut {
            Cut::Element(mut element, draft, _) => {
                if let Some(bounds) = &mut element.bounds {
                    bounds.passage = Passage::Flowing;
                }
                let curving = Some(Curving { jerk: self.check_jerk, constant: None, near: Near::NONE });
                self.made = Some(Made { element, data, curving, due, draft: Some(draft) });
            }
            Cut::Straight(to, _) => self.go_straight(&from, &to, (data, due)),
            Cut::Again => {}
        }
        if last {
            self.course.here = *piece_end(&self.course.piece, &self.course.here);
            self.course.piece = None;
            self.next_part();
        }
    }

    /// The piece over the current leg.
    fn next_piece(&mut self, dynamics: &Dynamics<AXES>) -> Option<()> {
        match self.mode {
            _ if self.is_straight(0) => self.control_piece(),
            Mode::Direct => self.direct_piece(),
            _ => self.akima_piece(dynamics),
        }
    }

    /// Completes the curve: emits the block after it, or begins a new curve. Returns whether there was work.
    fn finish(&mut self) -> bool {
        if let Some(block) = self.behind.take() {
            let ProgrammedBlock { element, data, .. } = block;
            self.made = Some(Made { element, data, curving: None, due: data.number, draft: None });
            let arc = block.form != Form::Line && self.mode == Mode::Akima;
            self.begin(arc.then_some(element.exit));
            return true;
        }
        if self.window.is_closed() {
            self.begin(None);
            return true;
        }
        false
    }
}

fn piece_end<'a, const AXES: usize>(piece: &'a Option<Piece<AXES>>, other: &'a Knot<AXES>) -> &'a Knot<AXES> {
    piece.as_ref().map_or(other, Piece::end)
}

/// Whether a straight block is a leg of a curve: the travel of the path axes must equal the path length.
pub fn is_leg<const AXES: usize>(measure: &Measure, block: &ProgrammedBlock<AXES>) -> bool {
    let travel = window::travel(&block.from, &block.to);
    let length = to_f32(block.element.shape.length.to_bits()) * DISTANCE_LSB;
    let along = size(&along(measure, AXES), &travel);
    block.form == Form::Line && along >= SHORTEST_LEG && length <= LONGER * along
}

/// The direction of an end as a slope. Returns `None` if the direction has no component along the path axes.
fn tangent<const AXES: usize>(window: &Window<AXES>, end: &End<AXES>) -> Option<[f32; AXES]> {
    let tangent = direction(end);
    (size(window.axes(), &tangent) > LEAST_TANGENT).then_some(tangent)
}

/// A position shifted by `by`.
fn shifted<const AXES: usize>(from: &[Position; AXES], by: &[f32; AXES]) -> [Position; AXES] {
    let mut to = *from;
    for (x, by) in to.iter_mut().zip(by) {
        *x = Position::from_bits(x.to_bits().saturating_add(to_i64(by * (1.0 / LSB_32))));
    }
    to
}

/// Gives both sides of a point this curvature, over a length that [`BENT`] permits.
fn bent<const AXES: usize>(
    axes: &crate::smooth::contour::curve::Main,
    own: &[f32; AXES],
    other: [f32; AXES],
    longest: f32,
) -> Joint<AXES> {
    let step = plus(&other, -1.0, own);
    let step = max(size(axes, &step), aside(axes, &step));
    let length = min(longest, sqrt_f32(BENT / max(SHIFT * step, 1e-12)));
    if length < LEAST_PART * longest { Joint::Tangent } else { Joint::Bent(other, length) }
}

impl<const AXES: usize> Smoother<AXES> for Splining<AXES> {
    #[inline(never)]
    fn take(&mut self, block: &ProgrammedBlock<AXES>, _: &Dynamics<AXES>, parting: Parting) {
        if self.on && is_leg(&self.measure, block) {
            let vertex = Vertex { at: block.to, data: block.data };
            if self.window.is_empty() {
                self.window.push(Vertex { at: block.from, data: block.data });
                self.points = self.points.max(1);
            }
            if parting != Parting::None || !self.merges(block) {
                self.window.push(vertex);
                self.points += 1;
            }
            return;
        }
        if !self.window.is_closed() {
            if (self.waits || block.form != Form::Line) && matches!(self.mode, Mode::Akima) {
                self.close_into(&block.element);
            } else {
                self.close();
            }
        }
        self.points = self.points.max(1) + u32::from(self.on);
        self.behind = Some(*block);
    }

    #[inline(never)]
    fn work(&mut self, dynamics: &Dynamics<AXES>) -> bool {
        if let Some(made) = &mut self.made {
            let Some(draft) = made.draft.as_mut().filter(|draft| !draft.is_done()) else { return false };
            if draft.go_on(&mut made.element).is_none() {
                // The format cannot hold the element.
                let (from, to, data) = (*draft.from(), *draft.to(), (made.data, made.due));
                self.made = None;
                self.go_straight(&from, &to, data);
                return true;
            }
            // The element is emitted in the same call.
            return !draft.is_done();
        }
        if self.course.piece.is_some() {
            self.cut();
            return true;
        }
        if self.window.is_ready() {
            if self.next_piece(dynamics).is_none() {
                self.next_leg();
            }
            return true;
        }
        !self.window.has_leg() && self.finish()
    }

    fn emit(&mut self, into: impl FnOnce(&Smoothed<'_, AXES>)) -> bool {
        let Some(Made { element, data, curving, due, draft }) = &self.made else { return false };
        if draft.as_ref().is_some_and(|draft| !draft.is_done()) {
            return false;
        }
        into(&Smoothed {
            element,
            end: draft.as_ref().map(Draft::to),
            data,
            curving: *curving,
            due: *due,
            known: None,
        });
        self.made = None;
        true
    }

    fn flush(&mut self, stop: bool) {
        if let Some(behind) = &mut self.behind {
            behind.data.stop |= stop;
        } else if stop && self.window.has_leg() {
            // The stop is on the curve.
            if let Some(last) = self.window.last() {
                last.data.stop = true;
            }
        } else if !self.window.is_closed() {
            self.close();
        }
    }

    fn cancel(&mut self) {
        if !self.window.is_closed() {
            self.close();
        }
    }

    fn clear(&mut self) {
        self.begin(None);
        (self.course.piece, self.made, self.behind) = (None, None, None);
        self.waits = false;
    }

    fn restart(&mut self) {
        self.clear();
        self.on = false;
    }

    fn place(&self) -> Option<Place> {
        self.window.point(1).map(|point| point.data.place)
    }

    fn remark(&mut self) -> Option<NcWarningKind> {
        None
    }

    fn is_idle(&self) -> bool {
        !self.on && self.is_empty()
    }

    fn is_empty(&self) -> bool {
        !self.holds() && !self.window.is_closed()
    }

    fn rounds(&self) -> bool {
        false
    }

    fn holds(&self) -> bool {
        self.window.has_leg() || self.course.piece.is_some() || self.made.is_some() || self.behind.is_some()
    }

    fn gives_way(&mut self) -> bool {
        // No: the path must not depend on the arrival time of text.
        false
    }
}

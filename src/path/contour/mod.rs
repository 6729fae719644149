//! Contour mode (G61, G261, #CONTOUR MODE): corners between blocks become curves that are continuous in direction and
//! curvature, inside a tolerance (DEV), at given distances (DIST), through a given point (POS), or such that axes change
//! their speed as they can (DIST_SOFT, PTP; DEV with HSC): `timed.rs` says why and where.
//!
//! A block whose end is to be rounded is held back until the next one is known; nothing else is. What the corner
//! cuts from it only shortens its path length: the curve of the block stays the same to the last bit. The block
//! behind the corner is made anew from where the corner's curve ends.
//!
//! Blocks too short for a curve (RELEVANT_PATH, RELEVANT_TRACK) are left out: the curve goes from the last relevant block
//! to the first one that ends beyond the limit. A short block to begin with is joined to the line behind it. Where no
//! curve comes of it, a straight line stands for the blocks left out.
//!
//! When something is sampled: whether the end of a block is rounded, by which method and how far, when that block
//! comes; CHECK_JERK and CONST_VEL when the next one comes. G260 and #CONTOUR MODE OFF between two blocks cancel the
//! corner between them, inside the second one they do not. PRE_ACTION, INTER_ACTION and POST_ACTION count as they stood when the
//! block before the corner came.
mod corner;
mod curve;
mod parameters;
mod timed;

pub use parameters::Parameters;

use self::corner::{CONSTANT, Corner, Course, EVEN, turn};
use self::curve::{Main, Quintic, Side, plus, size};
use self::timed::{Overlap, Rise, Timed};
use super::poly::Knot;
use super::{Element, PathError, arc, line};
use crate::lookahead::{Curving, Dynamics, max, min};
use crate::math::float::to_f32;
use crate::math::root::{cbrt_f32, sqrt_f32};
use crate::nc::{
    Contour, ContourAction, ContourMethod, ContourSwitch, NcWarningKind, Place, Plane, SlopeType,
};
use crate::quantity::{Distance, Position};

/// How a block was programmed, to make its rest anew.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Form {
    /// Straight.
    Line,
    /// About a centre.
    Arc {
        /// In the two axes of the plane.
        centre: [Position; 2],
        /// Its plane.
        plane: Plane,
        /// G02.
        clockwise: bool,
    },
}

/// What goes with a block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Data {
    /// Feed, mm/min; rapid without.
    pub feed: Option<f32>,
    /// Programmed N number.
    pub n: u32,
    /// Where it stands in the text.
    pub place: Place,
    /// Motion blocks before it.
    pub number: u32,
    /// It ends in an exact stop.
    pub stop: bool,
}

/// A block as it comes in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Block<const AXES: usize> {
    /// Its curve.
    pub element: Element<AXES>,
    /// Where that begins.
    pub from: [Position; AXES],
    /// Where it ends.
    pub to: [Position; AXES],
    /// How it was programmed.
    pub form: Form,
    /// What goes with it.
    pub data: Data,
}

/// A block whose end waits for the next one.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Held<const AXES: usize> {
    block: Block<AXES>,
    /// Path length as programmed, LSB 2^-44 mm.
    length: i64,
    /// How its end is rounded; not at all without.
    rule: Option<Parameters>,
    /// End of the blocks left out behind it, and what goes with the last of them.
    skipped: Option<([Position; AXES], Data)>,
}

/// What goes on to the look-ahead.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outgoing<const AXES: usize> {
    /// The curve.
    pub element: Element<AXES>,
    /// What goes with it.
    pub data: Data,
    /// Set for the curve in a corner.
    pub curving: Option<Curving>,
    /// Functions with no more motion blocks before them come before it.
    pub due: u32,
}

/// A curve in a corner on its way out: what goes with each half, and the functions due before it.
#[derive(Clone, Copy, Debug)]
struct Turning<const AXES: usize> {
    course: Curve<AXES>,
    halves: [(Data, u32); 2],
    curving: Curving,
}

/// The stage: between the blocks' curves and the look-ahead.
#[derive(Clone, Copy, Debug)]
pub struct Contouring<const AXES: usize> {
    main: [Option<usize>; 3],
    parameters: Parameters,
    /// G261.
    on: bool,
    /// G61, for the next motion block.
    once: bool,
    /// What goes out, in this order: the block before a corner, its curve or what stands for blocks left out, the block
    /// behind it.
    before: Option<Outgoing<AXES>>,
    bridge: Option<Outgoing<AXES>>,
    course: Option<Turning<AXES>>,
    held: Option<Held<AXES>>,
    /// What is to be said about the curve that the last block led to.
    remark: Option<NcWarningKind>,
}

/// The curve of a corner.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Curve<const AXES: usize> {
    /// Over its arc length.
    Even(Course<AXES>),
    /// Over time.
    Timed(Timed<AXES>),
}

impl<const AXES: usize> Curve<AXES> {
    /// Whether the next element belongs to the block before the corner.
    fn is_before(&self) -> bool {
        match self {
            Self::Even(course) => course.is_before(),
            Self::Timed(timed) => timed.is_before(),
        }
    }
}

impl<const AXES: usize> Iterator for Curve<AXES> {
    type Item = Element<AXES>;

    fn next(&mut self) -> Option<Element<AXES>> {
        match self {
            Self::Even(course) => course.next(),
            Self::Timed(timed) => timed.next(),
        }
    }
}

/// What two corners leave of a block may go to the second one if it is this part, as a power of two: far less than what the
/// tolerance has to spare.
const SLIVER: u32 = 14;

/// 2^-44 mm, and back.
const LSB_44: f32 = 1.0 / (1u64 << 44) as f32;
const ONE_44: f32 = (1u64 << 44) as f32;
const LSB_32: f32 = 1.0 / (1u64 << 32) as f32;

/// Sine of half an angle below which a transition is tangential, and cosine of half an angle below which it is a
/// reversal.
const TANGENTIAL: f32 = 1.0 / 65_536.0;
const REVERSAL: f32 = 1.0 / 1024.0;

/// How often a corner is made smaller.
const SMALLER: usize = 8;

/// A block below 16 µm behind blocks left out is replaced by a line from where they began.
const SYSTEM_LEAST: i64 = (1 << 44) / 1000 * 16;

/// Shortest corner distance worth a curve, mm.
const SHORTEST: f32 = 1e-5;

/// π/2.
const QUARTER: f32 = core::f32::consts::FRAC_PI_2;

impl<const AXES: usize> Contouring<AXES> {
    /// Off; `check_jerk` is P-CHAN-00110.
    pub fn new(main: [Option<usize>; 3], check_jerk: u8) -> Self {
        let parameters = Parameters::new(check_jerk);
        Self {
            main,
            parameters,
            on: false,
            once: false,
            before: None,
            bridge: None,
            course: None,
            held: None,
            remark: None,
        }
    }

    /// Takes in a command. `in_motion`: it stands in a block with a motion.
    pub fn command(&mut self, contour: &Contour, in_motion: bool) {
        if self.held.is_some_and(|held| held.skipped.is_some()) && !in_motion {
            // Blocks left out: the corner ends here.
            self.cancel();
        }
        self.parameters.update(contour);
        match contour.switch {
            None => {}
            Some(ContourSwitch::Block) => self.once = true,
            Some(ContourSwitch::On) => self.on = true,
            Some(ContourSwitch::Off) => {
                self.on = false;
                if !in_motion {
                    self.cancel();
                }
            }
        }
    }

    /// No curve at the end of the block held back.
    pub fn cancel(&mut self) {
        if let Some(held) = &mut self.held {
            held.rule = None;
        }
    }

    /// Whether a block can go past this stage: nothing is held back, and its end is not rounded. Asked only when
    /// [`Self::outgoing`] has no more.
    pub fn is_idle(&self) -> bool {
        self.held.is_none() && !self.on && !self.once
    }

    /// Takes in the next block; only when [`Self::outgoing`] has no more.
    ///
    /// # Errors
    /// The line in place of blocks left out is too long.
    #[inline(never)]
    pub fn take(&mut self, block: &Block<AXES>, dynamics: &Dynamics<AXES>) -> Result<(), PathError> {
        let mut rounds = (self.on || core::mem::take(&mut self.once)) && !block.data.stop;
        if rounds && self.parameters.method == ContourMethod::Ptp && block.form != Form::Line {
            self.on = false;
            rounds = false;
            self.remark = Some(NcWarningKind::PtpArc);
        }
        let mut next = Held {
            block: *block,
            length: block.element.shape.length.to_bits(),
            rule: if rounds { Some(self.parameters) } else { None },
            skipped: None,
        };
        if let Some(held) = &mut self.held
            && let Some(rule) = held.rule
        {
            if rounds && held.leaves_out(&next.block, &rule, &self.main) {
                held.skipped = Some((block.to, block.data));
                return Ok(());
            }
            let straight = held.block.form == Form::Line && block.form == Form::Line;
            let from = if straight && held.is_short(&rule) {
                Some(held.block.from)
            } else if held.skipped.is_some() && next.length < SYSTEM_LEAST {
                Some(held.block.to)
            } else {
                None
            };
            if let Some(from) = from
                && let Some(element) = line(&from, &block.to, &self.main)?
            {
                next.block = Block { element, from, form: Form::Line, ..*block };
                next.length = element.shape.length.to_bits();
                if from == held.block.to {
                    held.skipped = None;
                } else {
                    // The short one to begin with is part of it.
                    self.held = None;
                }
            }
        }
        if let Some(held) = self.held.take() {
            self.join(held, &mut next, dynamics);
        }
        self.held = Some(next);
        Ok(())
    }

    /// What is to be said about the curve that the last block led to, once.
    pub fn remark(&mut self) -> Option<NcWarningKind> {
        self.remark.take()
    }

    /// Lets go of the block held back; `stop` demands a standstill at its end.
    pub fn release(&mut self, stop: bool) {
        if let Some(held) = &mut self.held {
            held.rule = None;
            held.skipped.as_mut().map_or(&mut held.block.data, |(_, data)| data).stop |= stop;
        }
    }

    /// Forgets what it holds.
    pub fn clear(&mut self) {
        (self.held, self.before, self.course, self.bridge) = (None, None, None, None);
        self.once = false;
    }

    /// Whether the end of the last block is to be rounded.
    pub fn rounds(&self) -> bool {
        self.held.as_ref().is_some_and(|held| held.rule.is_some())
    }

    /// Whether a block is held back.
    pub fn holds(&self) -> bool {
        self.held.is_some()
    }

    /// The block that is left of `held` goes out, with a curve to `next` if there is one.
    fn join(&mut self, held: Held<AXES>, next: &mut Held<AXES>, dynamics: &Dynamics<AXES>) {
        let mut element = held.block.element;
        let data = held.block.data;
        let mut cut = held.rule.and_then(|rule| self.corner(&held, next, &rule, dynamics));
        for _ in 0..SMALLER {
            let Some(reach) = &mut cut else { break };
            let rest = element.shape.length.to_bits() - reach.before;
            let [base, next_base] = [&held.block, &next.block].map(|b| b.element.shape.base(&b.from));
            let mut from = Knot { position: held.block.from, end: element.entry };
            if rest > 0 {
                element.shape.at(rest, &base, &mut from.position);
                from.end = element.end_at(rest);
            }
            let mut begin = next.block.from;
            if reach.behind > 0 {
                next.block.element.shape.at(reach.behind, &next_base, &mut begin);
            }
            let Ok(renewed) = next.renewed(&begin, &self.main) else { break };
            let to = Knot { position: begin, end: renewed.entry };
            let curving = Curving { jerk: self.parameters.check_jerk, constant: self.parameters.const_vel };
            let even = if curving.constant { CONSTANT } else { EVEN };
            let (main, origin) = (&self.main, &held.block.to);
            let course = match &reach.way {
                Way::Timed(overlap) => Some(Curve::Timed(Timed::new(origin, *overlap, &from, &to)))
                    .filter(|_| overlap.rise.v > 0.0),
                Way::Even { interim, slack } => {
                    let interim = interim.as_ref();
                    Course::new(main, origin, &from, &to, interim, [even, *slack]).map(Curve::Even)
                }
            };
            if let Some(course) = course {
                let [first, second] = [data, next.block.data];
                let due = match held.rule.map(|rule| rule.action) {
                    Some(ContourAction::Pre) => [second.number; 2],
                    Some(ContourAction::Post) => [first.number; 2],
                    _ => [first.number, second.number],
                };
                let halves = [(first, due[0]), (second, due[1])];
                self.course = Some(Turning { course, halves, curving });
                next.block.element = renewed;
                next.block.from = begin;
                if rest == 0 {
                    return;
                }
                element.shape.length = Distance::from_bits(rest);
                element.exit = from.end;
                break;
            }
            // An arc may come back so near to the other block that no even curve joins them there.
            [reach.before, reach.behind] = [reach.before, reach.behind].map(|c| c - c / 4);
        }
        self.before = Some(Outgoing { element, data, curving: None, due: data.number });
        if self.course.is_none() {
            self.bridge = held.bridge(&self.main);
        }
    }

    /// Whether and how far a curve reaches into both blocks.
    fn corner(
        &mut self,
        held: &Held<AXES>,
        next: &Held<AXES>,
        rule: &Parameters,
        dynamics: &Dynamics<AXES>,
    ) -> Option<Cut<AXES>> {
        let before = Side::new(&held.block.element, &held.block.element.exit);
        let behind = Side::new(&next.block.element, &next.block.element.entry);
        let turn = turn(&self.main, before.tangent(), behind.tangent())?;
        let position = rule.method == ContourMethod::Pos;
        if !position && !rule.rounds(&turn, before.rate > 0.0 || behind.rate > 0.0) {
            return None;
        }
        let arc = held.block.form != Form::Line || next.block.form != Form::Line;
        match rule.method {
            ContourMethod::Ptp if arc => return None,
            ContourMethod::DistSoft if arc => self.remark = Some(NcWarningKind::SoftArc),
            _ => {}
        }
        // Largest distances: a share of the programmed length, a quarter of a turn.
        let mut most = [0.0; 2];
        let mut whole = [false; 2];
        let lengths = [(held.length, &before), (next.length, &behind)];
        for ((most, whole), (length, side)) in most.iter_mut().zip(&mut whole).zip(lengths) {
            *most = to_f32(length) * LSB_44 * rule.share;
            *whole = true;
            if side.rate * *most > QUARTER {
                *most = QUARTER / side.rate;
                *whole = false;
            }
        }
        let mut slack = f32::MAX;
        let mut distances = rule.distances(most);
        let corner = Corner { main: &self.main, before, behind };
        if let Some(overlap) = self.overlap([held, next], &corner, rule, dynamics, min(most[0], most[1])) {
            let reach = (overlap.rise.distance() * f64::from(ONE_44)) as i64;
            // What is left of a halved line may be some LSB less than its half.
            let before = reach.min(held.block.element.shape.length.to_bits());
            return Some(Cut { before, behind: reach.min(next.length / 2), way: Way::Timed(overlap) });
        }
        let tolerance = rule.tolerance();
        if !position && (tolerance.path.is_some() || tolerance.track > 0.0) {
            let (part, room) = corner.reach(&tolerance, distances)?;
            distances = distances.map(|c| c * part);
            slack = room;
        }
        if !position && max(distances[0], distances[1]) < SHORTEST {
            return None;
        }
        let bits = |i: usize, length: i64| {
            if whole[i] && distances[i] >= most[i] && rule.share >= 0.5 {
                length / 2
            } else {
                ((distances[i] * ONE_44) as i64).min(length / 2)
            }
        };
        let [reach_before, reach_behind] = [bits(0, held.length), bits(1, next.length)];
        let mut interim = None;
        let mut before = reach_before;
        let left = held.block.element.shape.length.to_bits();
        if left - before <= held.length >> SLIVER {
            before = left;
        }
        if position {
            let mut point = [0.0; AXES];
            for (k, value) in self.main.iter().zip(rule.point) {
                let (Some(k), Some(value)) = (*k, value) else { continue };
                if let (Some(x), Some(corner)) = (point.get_mut(k), held.block.to.get(k)) {
                    *x = to_f32(value.to_bits().saturating_sub(corner.to_bits())) * LSB_32;
                }
            }
            interim = Some(point);
        }
        Some(Cut { before, behind: reach_behind, way: Way::Even { interim, slack } })
    }

    /// The curve over time between two lines, if that is what the method asks for or what is faster: the largest distance from the
    /// corner is `most`.
    fn overlap(
        &self,
        [held, next]: [&Held<AXES>; 2],
        corner: &Corner<'_, AXES>,
        rule: &Parameters,
        dynamics: &Dynamics<AXES>,
        most: f32,
    ) -> Option<Overlap> {
        let [first, second] = [&held.block, &next.block];
        let soft = matches!(rule.method, ContourMethod::DistSoft | ContourMethod::DistMaster);
        let quick = match rule.method {
            ContourMethod::Dev => dynamics.slope() == SlopeType::Hsc && !self.parameters.const_vel,
            ContourMethod::Ptp => true,
            _ => soft,
        };
        let straight = first.form == Form::Line && second.form == Form::Line && first.to == second.from;
        let rapid = first.data.feed.is_none();
        if !quick || !straight || held.skipped.is_some() || rapid != second.data.feed.is_none() {
            return None;
        }
        let [v1, a1, j1] = dynamics.along(&first.element, first.data.feed)?;
        let [v2, a2, j2] = dynamics.along(&second.element, second.data.feed)?;
        let v = min(v1, v2);
        let (t1, t2) = (corner.before.tangent(), corner.behind.tangent());
        let change = plus(t2, -1.0, t1);
        // Both at once: every axis changes its speed evenly.
        let of = if rule.method == ContourMethod::Ptp { PART_PTP } else { PART };
        let [a, j] = dynamics.together(&change, rapid, of);
        if soft {
            let mut distance = rule.distances([most; 2])[0];
            if self.tracks(&change) {
                distance = min(distance, rule.track_distance());
            }
            return Some(Overlap::whole(soft_rise(rule, distance, [v, a, j])?)).filter(Overlap::is_long);
        }
        // How far both may be from the corner when they are equally far from it.
        let turn = f64::from(size(&self.main, &change));
        let mut off = rule.deviation().map_or(f64::MAX, |dev| f64::from(dev * EXACT) / turn);
        let track = rule.tolerance().track;
        for (_, x) in change.iter().enumerate().filter(|(k, _)| !self.main.contains(&Some(*k))) {
            if track > 0.0 && *x != 0.0 {
                off = f64::min(off, f64::from(track * EXACT / max(*x, -*x)));
            }
        }
        let reach = f64::from(rule.ptp_distance());
        let whole = Rise::within(most, v, a, j);
        let way = if whole.half_way() <= off && whole.distance() <= reach {
            // DEV uses all of its tolerance; PTP all of its axes, which takes the same time.
            let most = f64::min(off / whole.half_way(), f64::from(most) / whole.distance());
            let by = if rule.method == ContourMethod::Ptp || most < 1.0 { 1.0 } else { most };
            Overlap::whole(whole.stretched(by))
        } else {
            let alone = [t1, t2].map(|t| dynamics.together(t, rapid, of));
            let [_, j_sum] = dynamics.together(&plus(t1, 1.0, t2), rapid, of);
            let brief = alone.iter().fold([min(a1, a2), min(min(j1, j2), j_sum)], |[a, j], alone| {
                [min(a, alone[0]), min(j, alone[1])]
            });
            let overlap = |[a, j]: [f32; 2]| {
                let rise = Rise::within(most, v, a, j);
                let (by_off, by_reach) = (Overlap::off(rise, off), Overlap::from_distance(rise, reach));
                if by_off.time < by_reach.time { by_off } else { by_reach }
            };
            let way = overlap(brief);
            if way.is_brief() { way } else { overlap([min(brief[0], a), min(brief[1], j)]) }
        };
        // Where the corner is not slower than the feed, the shorter curve over arc length is faster.
        let room = min(most, rule.ptp_distance());
        let part = corner.reach(&rule.tolerance(), [room; 2]).map_or(0.0, |(part, _)| part);
        let c = room * part;
        let curve = corner.between([c; 2]);
        let length = curve.length(&self.main, 0.0, 1.0);
        let through = self.speed(&curve, length, v, dynamics, rapid);
        let limits = [v, min(a1, a2), min(j1, j2)];
        let quick = part == 0.0 || (way.duration() as f32) < even_time([through, c, length], &way, limits);
        Some(way).filter(|way| quick && way.is_long())
    }

    /// About the speed at which a curve over arc length is passed.
    fn speed(
        &self,
        curve: &Quintic<AXES>,
        length: f32,
        v: f32,
        dynamics: &Dynamics<AXES>,
        rapid: bool,
    ) -> f32 {
        let mut through = v;
        for u in [0.0, 0.25, 0.5, 0.75, 1.0] {
            let [a, _] = dynamics.together(&curve.at(u)[2], rapid, [1.0; 2]);
            let j = dynamics.across(&curve.third(u), rapid, self.parameters.check_jerk);
            let slowest = min(sqrt_f32(NORMAL * min(a, UNLIMITED)), cbrt_f32(TWISTED * min(j, UNLIMITED)));
            through = min(through, slowest * length);
        }
        through
    }

    /// Whether other than main axes change their direction.
    fn tracks(&self, change: &[f32; AXES]) -> bool {
        change.iter().enumerate().any(|(k, x)| *x != 0.0 && !self.main.contains(&Some(k)))
    }
}

/// A jerk that is none, mm/tick³.
const UNLIMITED: f32 = 1e6;

/// Of a tolerance.
const EXACT: f32 = 1.0 - 1.0 / 16_384.0;

/// What a curve over time takes at most of the axes' largest acceleration and of their jerk budget. The rest is for changes of
/// path speed inside it, for a feed hold before all: the less is left, the longer that takes. PTP is for the shortest time.
const PART: [f32; 2] = [0.93, 0.85];
/// See [`PART`].
const PART_PTP: [f32; 2] = [0.975, 0.96];

/// Parts of acceleration and jerk that a curve over arc length takes; of the jerk half, and of the speed for it four fifths.
const NORMAL: f32 = 0.8;
const TWISTED: f32 = 0.25;

/// How long it takes to go through a corner at the speed `through` on a curve over arc length that begins and ends at the
/// distance `c` and is so long, from where the curve over time begins to where it ends: with the speed, acceleration and jerk
/// of the lines.
fn even_time([through, c, length]: [f32; 3], way: &Overlap, [v, a, j]: [f32; 3]) -> f32 {
    let reach = way.rise.distance() as f32;
    let change = v - through;
    let time = if change >= a * a / j { change / a + a / j } else { 2.0 * sqrt_f32(max(change, 0.0) / j) };
    let ramps = 0.5 * (v + through) * time;
    2.0 * (time + (reach - c - ramps) / v) + length / through
}

/// DIST_SOFT: the least acceleration, from ACC_MIN to ACC_MAX, with which the speed changes within `distance`; a lower
/// speed if ACC_MAX is not enough.
fn soft_rise(rule: &Parameters, distance: f32, [v, a, j]: [f32; 3]) -> Option<Rise> {
    let [least, most] = rule.acc;
    let ramp = max(rule.ramp_time, 1e-4) * a / j;
    // D = v·T/2 with T = v/a' + ramp, or 2·√(v·ramp/a') if a' is not reached.
    let mut part = v * v * v * ramp / (a * distance * distance);
    let hold = distance - 0.5 * v * ramp;
    if v > part * a * ramp && hold > 0.0 {
        part = v * v / (2.0 * a * hold);
    }
    let part = min(max(part, least), most);
    if part <= 0.0 || distance <= 0.0 {
        return None;
    }
    let a = part * a;
    Some(Rise::within(distance, v, a, min(a / ramp, j)))
}

/// What a corner takes from its blocks, LSB 2^-44 mm, and how.
struct Cut<const AXES: usize> {
    before: i64,
    behind: i64,
    way: Way<AXES>,
}

/// A curve that is to be made.
enum Way<const AXES: usize> {
    /// Over arc length: the point it is to go through, from the corner, and how far beside the curve its elements may
    /// be, mm.
    Even { interim: Option<[f32; AXES]>, slack: f32 },
    /// Over time.
    Timed(Overlap),
}

impl<const AXES: usize> Held<AXES> {
    /// Whether the way from one point to another is irrelevant: along the main axes and every other one.
    fn is_irrelevant(from: &[Position; AXES], to: &[Position; AXES], rule: &Parameters, main: &Main) -> bool {
        let mut travel = [0.0; AXES];
        for (travel, (from, to)) in travel.iter_mut().zip(from.iter().zip(to)) {
            *travel = to_f32(to.to_bits().saturating_sub(from.to_bits())) * LSB_32;
        }
        let mut others = travel.iter().enumerate().filter(|(k, _)| !main.contains(&Some(*k)));
        size(main, &travel) <= rule.relevant_path && others.all(|(_, x)| max(*x, -*x) <= rule.relevant_track)
    }

    /// Whether the next block is left out: it is short, and ends no further from the end of this one.
    fn leaves_out(&self, next: &Block<AXES>, rule: &Parameters, main: &Main) -> bool {
        let arc = next.form != Form::Line;
        let short = !arc || to_f32(next.element.shape.length.to_bits()) * LSB_44 <= rule.relevant_path;
        rule.method != ContourMethod::Pos
            && short
            && Self::is_irrelevant(&next.from, &next.to, rule, main)
            && Self::is_irrelevant(&self.block.to, &next.to, rule, main)
    }

    /// Whether it is too short to begin a curve.
    fn is_short(&self, rule: &Parameters) -> bool {
        rule.method != ContourMethod::Pos && to_f32(self.length) * LSB_44 <= rule.relevant_path
    }

    /// The line in place of the blocks left out.
    fn bridge(&self, main: &Main) -> Option<Outgoing<AXES>> {
        let (to, data) = self.skipped?;
        let element = line(&self.block.to, &to, main).ok().flatten()?;
        Some(Outgoing { element, data, curving: None, due: data.number })
    }

    /// The rest of the block from a point on it.
    fn renewed(
        &self,
        from: &[Position; AXES],
        main: &[Option<usize>; 3],
    ) -> Result<Element<AXES>, PathError> {
        if *from == self.block.from {
            return Ok(self.block.element);
        }
        match self.block.form {
            Form::Line => Ok(line(from, &self.block.to, main)?.unwrap_or(self.block.element)),
            Form::Arc { centre, plane, clockwise } => {
                arc(from, &self.block.to, centre, plane, clockwise, main)
            }
        }
    }
}

impl<const AXES: usize> Contouring<AXES> {
    /// What goes on next, if anything does before another block comes.
    pub fn outgoing(&mut self) -> Option<Outgoing<AXES>> {
        // Asked before taking: an empty one would be copied too.
        if self.before.is_some() {
            return self.before.take();
        }
        if let Some(Turning { course, halves, curving }) = &mut self.course {
            let (data, due) = halves[usize::from(!course.is_before())];
            if let Some(element) = course.next() {
                return Some(Outgoing {
                    element,
                    data: Data { stop: false, ..data },
                    curving: Some(*curving),
                    due,
                });
            }
            self.course = None;
        }
        if self.bridge.is_some() {
            return self.bridge.take();
        }
        if self.held.as_ref()?.rule.is_some() {
            return None;
        }
        let held = self.held.take()?;
        self.bridge = held.bridge(&self.main);
        let Held { block: Block { element, data, .. }, .. } = held;
        Some(Outgoing { element, data, curving: None, due: data.number })
    }
}

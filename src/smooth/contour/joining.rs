//! Makes the curve of a corner in bounded steps. The steps select the kind of curve, and find how far the
//! curve reaches into both blocks. The next steps shorten the blocks and make the elements of the curve.
use super::choice::{Approach, Candidate, Choice, bends, passes, shallow_distance};
use super::corner::{AIM, Corner, Reach, Tolerance, turn};
use super::corner_curve::{CONSTANT, CornerCurve, EVEN, Fit, Rehearsal};
use super::curve::Side;
use super::cut::{Cut, Room, SHORTEST, ends, enter};
use super::halves::Halves;
use super::held_block::{HeldBlock, Skipped, Stray, travel};
use super::kernel::kernel;
use super::symmetric::Symmetric;
use super::timed::{Overlap, Timed};
use super::{Cornering, Course, LSB_32, ONE_44, Parameters, Turning};
use crate::dynamics::{Curving, Dynamics, Near, Steady};
use crate::math::float::{max, min, to_bits, to_f32, to_i64};
use crate::nc::{ContourAction, ContourMethod, NcWarningKind};
use crate::path::poly::{Knot, distance};
use crate::path::{Measure, Passage};
use crate::quantity::{DISTANCE_LSB, Distance, Position};
use core::num::NonZeroI64;

/// If blocks are left out: the share of a tolerance that is reserved for the curve between the examined
/// places.
const UNSEEN: f32 = 1.0 / 256.0;
/// The same share for the tolerance of tracking axes.
const UNSEEN_TRACK: f32 = 1.0 / 32.0;

/// Largest number of reductions of a curve.
const SMALLER: u8 = 8;

/// Trials per call for the corner distances, and fitted elements per call. Each call has a fixed cost.
const TRIALS: usize = 4;
const ELEMENTS: usize = 6;
/// Elements per call whose speed is examined.
const TIMED: u32 = 4;

/// Data of a corner in addition to its blocks and their rule.
pub struct Setting<'a, const AXES: usize> {
    /// Main axes and feed axes.
    pub measure: &'a Measure,
    /// CHECK_JERK in force: limit of the jerk that the curvature may cause, 0 to 2.
    pub check_jerk: u8,
    /// CONST_VEL in force: whether the speed is constant inside the curve.
    pub const_vel: bool,
    /// Limits of the axes.
    pub dynamics: &'a Dynamics<AXES>,
    /// The blocks left out at the corner.
    pub skipped: Option<&'a Skipped<AXES>>,
}

/// Alternatives to a curve over arc length: a curve over time, and a stop in the corner with DEV.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Rivals {
    approach: Approach,
    candidate: Option<Candidate>,
    may_stop: bool,
}

/// The search for the corner distances of a curve over arc length. After the search, the quickest choice is
/// taken: this curve, a curve over time, or a stop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Search<const AXES: usize> {
    room: Room,
    reach: Reach<AXES>,
    rivals: Rivals,
}

/// The next step.
#[derive(Clone, Copy, Debug, PartialEq)]
enum JoinStep {
    /// Search the corner distances: [`Course::Reaching`].
    Reaching,
    /// Make a curve over arc length with this cut. Its elements may deviate by `slack`, mm.
    Cutting { cut: Cut, slack: f32, smaller: u8 },
    /// Fit its elements.
    Fitting { cut: Cut, slack: f32, smaller: u8 },
    /// CONST_VEL: find the speed that all elements permit. `steady`: speed and length of the elements so far.
    /// `element`: the next one; `None` stands for the element in the middle, which is examined first. That
    /// element turns most and usually permits the lowest speed.
    Timing { cut: Cut, element: Option<u32>, steady: Steady },
    /// The elements are known: reduce both blocks to their rests.
    Joining { cut: Cut, steady: Option<Steady> },
    /// Make a curve over time.
    Overlapping(Overlap),
    /// Make the curve of a shallow corner with this corner distance, mm.
    Bending(f32),
    /// There is no curve.
    Sharp,
}

/// The quickest choice in a corner.
enum Quickest {
    /// A stop.
    Standing,
    /// A curve over time.
    Timed(Overlap),
    /// A curve over arc length, with the share of the distances, and the permitted distance of its elements,
    /// mm.
    Even((f32, f32)),
}

impl JoinStep {
    /// Sets the step for the quickest choice. Written in place, because a whole step would be copied.
    #[inline(always)]
    fn take<const AXES: usize>(
        &mut self,
        [held, next]: [&HeldBlock<AXES>; 2],
        rule: &Parameters,
        room: &Room,
        quickest: Quickest,
    ) {
        *self = Self::Sharp;
        match quickest {
            Quickest::Standing => {}
            Quickest::Timed(way) => *self = Self::Overlapping(way),
            Quickest::Even(found) => {
                if let Some((cut, slack)) = room.cut(held, next, rule, found) {
                    *self = Self::Cutting { cut, slack, smaller: 0 };
                }
            }
        }
    }
}

/// The work on the corner between two blocks, one piece of work per call.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Joining {
    stage: JoinStep,
}

fn corner<'a, const AXES: usize>(
    held: &HeldBlock<AXES>,
    next: &HeldBlock<AXES>,
    &Setting { measure, skipped, .. }: &Setting<'a, AXES>,
) -> Corner<'a, AXES> {
    let before = Side::new(&held.block.element, &held.block.element.exit, measure);
    let behind = Side::new(&next.block.element, &next.block.element.entry, measure);
    let gap = skipped.map(|skipped| travel(&held.block.to, &skipped.to));
    Corner { main: &measure.main, before, behind, gap }
}

impl Joining {
    /// The state without a corner.
    #[inline(always)]
    pub const fn new() -> Self {
        Self { stage: JoinStep::Sharp }
    }

    /// Begins the work on the corner between two blocks: finds whether a curve is possible, and which kinds.
    /// Returns the warning about the corner, if there is one. `behind`: length of the block after both, LSB
    /// 2^-44 mm; given if that length is known and the corner before that block is rounded.
    pub fn go_into<const AXES: usize>(
        &mut self,
        [held, next]: [&mut HeldBlock<AXES>; 2],
        behind: Option<i64>,
        setting: &Setting<'_, AXES>,
        into: &mut Course<AXES>,
    ) -> Option<NcWarningKind> {
        let mut remark = None;
        self.stage = JoinStep::Sharp;
        let rule = held.rule.as_ref()?;
        let corner = corner(held, next, setting);
        if let Some(room) = Self::room((held, &corner), (next, behind), rule, setting, &mut remark) {
            held.look_up(setting.dynamics);
            next.look_up(setting.dynamics);
            Self::choose([held, next], &corner, room, setting, (&mut self.stage, into));
        }
        remark
    }

    /// How far a curve may reach into both blocks, if a curve is possible.
    #[inline(always)]
    fn room<const AXES: usize>(
        (held, corner): (&HeldBlock<AXES>, &Corner<'_, AXES>),
        (next, following): (&HeldBlock<AXES>, Option<i64>),
        rule: &Parameters,
        setting: &Setting<'_, AXES>,
        remark: &mut Option<NcWarningKind>,
    ) -> Option<Room> {
        let (before, behind) = (&corner.before, &corner.behind);
        if corner.follows_master(rule, setting.measure) {
            // The other methods need only a change of direction; the corner may be in other axes than the
            // main axes.
            if !corner.turns() {
                return None;
            }
        } else {
            let turn = turn(setting.measure, before, behind)?;
            let with_arc = before.rate > 0.0 || behind.rate > 0.0;
            if !rule.rounds(&turn, with_arc, with_arc && corner.steps()) {
                return None;
            }
            match rule.method {
                ContourMethod::DistMaster => *remark = Some(NcWarningKind::MasterRests),
                _ if held.is_line() && next.is_line() => {}
                ContourMethod::Ptp => return None,
                ContourMethod::DistSoft => *remark = Some(NcWarningKind::SoftArc),
                _ => {}
            }
        }
        let parts =
            [rule.part(next.length, held.previous.map(NonZeroI64::get)), rule.part(held.length, following)];
        let mut room = Room::new([(held.length, before), (next.length, behind)], parts, rule);
        // The corner before may have used another weight, or slightly more than half of the block.
        let left = to_f32(held.block.element.shape.length.to_bits()) * DISTANCE_LSB;
        if left < room.most[0] {
            room.most[0] = left;
            room.distances = rule.distances(room.most);
        }
        Some(room)
    }

    /// Decides which kinds of curve are possible.
    #[inline(never)]
    fn choose<const AXES: usize>(
        [held, next]: [&HeldBlock<AXES>; 2],
        corner: &Corner<'_, AXES>,
        room: Room,
        setting: &Setting<'_, AXES>,
        (stage, into): (&mut JoinStep, &mut Course<AXES>),
    ) {
        let (Some(rule), Some(first), Some(second)) = (&held.rule, &held.known, &next.known) else { return };
        let tolerance = Self::tolerance([held, next], setting.skipped, rule);
        let approach = Approach::new([&first.permitted.0, &second.permitted.0], room.most);
        let choice = Choice {
            blocks: [held, next],
            corner,
            rule,
            setting,
            most: room.least(),
            tolerance: &tolerance,
            approach: &approach,
        };
        if let Some(c) = shallow_distance(&choice) {
            *stage = JoinStep::Bending(c);
            return;
        }
        let candidate = Candidate::new(&choice);
        // A corner with left-out blocks has no point to stop at, and a constant speed permits no stop.
        let may_stop = rule.may_stand() && setting.skipped.is_none() && !setting.const_vel;
        if let Some(Candidate { way, only: true, full }) = candidate {
            let stands = may_stop
                && full
                && approach.stops_within(approach.overlapping(&way) * approach.known() + 1.0);
            *stage = if stands { JoinStep::Sharp } else { JoinStep::Overlapping(way) };
            return;
        }
        let position = rule.method == ContourMethod::Pos;
        if position || (tolerance.path.is_none() && tolerance.track <= 0.0 && candidate.is_none()) {
            if may_stop {
                // The method gives no bound for the distances: the search tries the whole room and compares.
                *stage = JoinStep::Reaching;
                Self::search(&room, tolerance, (&approach, &None, may_stop), into);
            } else {
                stage.take([held, next], rule, &room, Quickest::Even((1.0, f32::MAX)));
            }
            return;
        }
        let compares = Self::compares(rule, corner, &candidate, may_stop);
        let [distance, other] = room.distances;
        if corner.is_symmetric(rule, setting.measure) && distance == other {
            let symmetric = Symmetric::new(corner);
            let used = symmetric.used(corner.main, &tolerance, distance);
            let part = if used > AIM { AIM / used } else { 1.0 };
            let even = |c: f32| (symmetric.path(c), passes(&symmetric.bends(c), held.is_rapid(), setting));
            let reached = part * distance;
            let quicker = |less: &f32| {
                let loose = less * reached;
                approach.even(even(loose), [loose; 2]) < approach.even(even(reached), [reached; 2])
            };
            let less = approach
                .loosened([reached; 2])
                .filter(|less| compares && candidate.is_none() && quicker(less));
            let part = part * less.unwrap_or(1.0);
            let found = [Some((part, f32::MAX)), compares.then(|| even(part * distance))];
            let rivals = (&approach, &candidate, may_stop);
            stage.take([held, next], rule, &room, Self::compare(&room, rivals, found));
            return;
        }
        // The search is the same, with a curve over time as alternative.
        *stage = JoinStep::Reaching;
        Self::search(&room, tolerance, (&approach, &candidate, may_stop), into);
    }

    /// Starts the search for the corner distances. A separate function, because it has two callers.
    #[inline(never)]
    fn search<const AXES: usize>(
        room: &Room,
        tolerance: Tolerance,
        (approach, candidate, may_stop): (&Approach, &Option<Candidate>, bool),
        into: &mut Course<AXES>,
    ) {
        let rivals = Rivals { approach: *approach, candidate: *candidate, may_stop };
        *into =
            Course::Reaching(Search { room: *room, reach: Reach::new(tolerance, room.distances), rivals });
    }

    /// The permitted deviation of a curve.
    fn tolerance<const AXES: usize>(
        [held, next]: [&HeldBlock<AXES>; 2],
        skipped: Option<&Skipped<AXES>>,
        rule: &Parameters,
    ) -> Tolerance {
        let mut tolerance = rule.tolerance();
        // The share of the tolerance that lines over several blocks have already used.
        let stray = held.stray.or(next.stray).or(skipped.map_or(Stray::NONE, |skipped| skipped.stray));
        let [unseen, unseen_track] = if skipped.is_some() { [UNSEEN, UNSEEN_TRACK] } else { [0.0; 2] };
        if let Some(path) = &mut tolerance.path {
            *path = (*path - stray.path) * (1.0 - unseen);
        }
        if tolerance.track > 0.0 {
            tolerance.track = max((tolerance.track - stray.track) * (1.0 - unseen_track), f32::MIN_POSITIVE);
        }
        tolerance
    }

    /// Whether a curve over arc length has alternatives. A sharp corner of Surface that has a curve over time
    /// always takes this curve, even if a stop is quicker.
    fn compares<const AXES: usize>(
        rule: &Parameters,
        corner: &Corner<'_, AXES>,
        candidate: &Option<Candidate>,
        may_stop: bool,
    ) -> bool {
        if candidate.is_some() { !rule.edges || !corner.is_sharp() } else { may_stop }
    }

    /// Returns the quickest choice: a curve over arc length with the found share of the distances, a curve
    /// over time, or a stop. `even`: path length of the curve over arc length, and its largest speed; `None`
    /// if there is no alternative.
    #[inline(never)]
    fn compare(
        room: &Room,
        (approach, candidate, may_stop): (&Approach, &Option<Candidate>, bool),
        [found, even]: [Option<(f32, f32)>; 2],
    ) -> Quickest {
        let part = found.map_or(0.0, |(part, _)| part);
        let even = even.map(|even| approach.even(even, room.distances.map(|c| c * part)));
        let even = even.unwrap_or(f32::MAX);
        let may_win = candidate.as_ref().filter(|candidate| candidate.way.duration() < even);
        let over_time = may_win.map(|candidate| approach.overlapping(&candidate.way));
        let quickest = min(even, over_time.unwrap_or(f32::MAX));
        // Times are accurate to a tick, and to the unknown speeds at neighbouring corners.
        if may_stop && approach.stops_within(quickest * approach.known() + 1.0) {
            return Quickest::Standing;
        }
        match candidate.as_ref().filter(|_| over_time == Some(quickest)) {
            Some(Candidate { way, .. }) => Quickest::Timed(*way),
            None => found.map_or(Quickest::Standing, Quickest::Even),
        }
    }

    /// Does the next piece of work. Returns whether the corner is done. Then `into` holds the curve, if there
    /// is one, and both blocks are reduced to their rests.
    #[inline(never)]
    pub fn go_on<const AXES: usize>(
        &mut self,
        [held, next]: [&mut HeldBlock<AXES>; 2],
        setting: &Setting<'_, AXES>,
        into: &mut Course<AXES>,
    ) -> bool {
        let Self { stage } = self;
        match stage {
            _ if held.rule.is_none() => *into = Course::None,
            JoinStep::Reaching => {
                Self::decide([held, next], setting, stage, into);
                return false;
            }
            JoinStep::Cutting { .. } => return Self::cut(held, next, setting, stage, into),
            JoinStep::Fitting { .. } => {
                Self::fit(stage, setting, into);
                let JoinStep::Joining { cut, steady } = stage else { return false };
                Self::join(held, next, (*cut, *steady), setting, into);
            }
            JoinStep::Timing { .. } => {
                Self::time([held, next], setting, stage, into);
                return false;
            }
            JoinStep::Joining { cut, steady } => Self::join(held, next, (*cut, *steady), setting, into),
            JoinStep::Overlapping(overlap) => Self::overlap(held, next, *overlap, setting, into),
            JoinStep::Bending(c) => Self::bend([held, next], *c, setting, into),
            JoinStep::Sharp => *into = Course::None,
        }
        true
    }

    // The following functions are not inlined, so that only one of their stack frames exists at a time.

    /// Decides the kind of curve and its distances.
    #[inline(never)]
    fn decide<const AXES: usize>(
        [held, next]: [&HeldBlock<AXES>; 2],
        setting: &Setting<'_, AXES>,
        stage: &mut JoinStep,
        into: &mut Course<AXES>,
    ) {
        let (Some(rule), Course::Reaching(search)) = (&held.rule, into) else {
            *stage = JoinStep::Sharp;
            return;
        };
        let Search { room, reach, rivals } = search;
        let corner = corner(held, next, setting);
        let Some(found) = (0..TRIALS).find_map(|_| reach.go_on(&corner)) else { return };
        let Rivals { approach, candidate, may_stop } = rivals;
        let compares = Self::compares(rule, &corner, candidate, *may_stop);
        let even = |part: f32| {
            let made;
            let curve = match reach.curve(part) {
                Some(curve) => curve,
                None => {
                    made = corner.between(room.distances.map(|c| c * part));
                    &made
                }
            };
            (corner.path(curve), passes(&bends(curve), held.is_rapid(), setting))
        };
        let all = found.filter(|_| compares).map(|(part, _)| (part, even(part)));
        if let Some((part, made)) = all {
            let reached = room.distances.map(|c| c * part);
            // A longer curve that leaves no room for a change of speed gains nothing.
            if let Some(less) = approach.loosened(reached).filter(|_| rule.method != ContourMethod::DistSoft)
            {
                let loose = reached.map(|c| c * less);
                if approach.even(even(part * less), loose) < approach.even(made, reached) {
                    room.distances = loose;
                    *reach = reach.within(loose);
                    return;
                }
            }
        }
        let even = all.map(|(_, made)| made);
        let rivals = (&*approach, &*candidate, *may_stop);
        let quickest = Self::compare(room, rivals, [found, even]);
        stage.take([held, next], rule, room, quickest);
    }

    /// Makes the curve over arc length. Returns whether it needs no fitting.
    #[inline(never)]
    fn cut<const AXES: usize>(
        held: &mut HeldBlock<AXES>,
        next: &mut HeldBlock<AXES>,
        setting: &Setting<'_, AXES>,
        stage: &mut JoinStep,
        into: &mut Course<AXES>,
    ) -> bool {
        let &mut JoinStep::Cutting { cut, slack, smaller } = stage else { return true };
        let Some(rule) = &held.rule else { return true };
        if cut.is_even() && !setting.const_vel {
            let mut symmetric = Symmetric::NONE;
            if Self::is_symmetric([held, next], rule, setting, &mut symmetric) {
                Self::halve([held, next], cut, &symmetric, setting, into);
                return true;
            }
        }
        let mut spaces = [0.0; 2];
        *into = Course::None;
        let lead = Self::lead([held, next], (rule, cut), setting, &mut spaces);
        if !Self::begin([held, next], (cut, spaces), setting, into) {
            *stage = JoinStep::Sharp;
        } else if even(into)
            .is_some_and(|course| Self::lay(course, (&held.block.to, rule), setting.measure, lead))
        {
            *stage = JoinStep::Fitting { cut, slack, smaller };
        } else {
            *into = Course::None;
            *stage = cut.smaller(slack, smaller);
        }
        false
    }

    /// Whether the curve is known in closed form, and each half is one element.
    #[inline(never)]
    fn is_symmetric<const AXES: usize>(
        [held, next]: [&HeldBlock<AXES>; 2],
        rule: &Parameters,
        setting: &Setting<'_, AXES>,
        symmetric: &mut Symmetric<AXES>,
    ) -> bool {
        let corner = corner(held, next, setting);
        if !corner.is_symmetric(rule, setting.measure) {
            return false;
        }
        *symmetric = Symmetric::new(&corner);
        symmetric.is_even()
    }

    /// Makes the curve in closed form, and shortens both blocks.
    #[inline(never)]
    fn halve<const AXES: usize>(
        [held, next]: [&mut HeldBlock<AXES>; 2],
        cut: Cut,
        symmetric: &Symmetric<AXES>,
        setting: &Setting<'_, AXES>,
        into: &mut Course<AXES>,
    ) {
        into.begin_halves([held, next], setting);
        let Course::Turning(Turning { course: Cornering::Halves(halves), passage, .. }) = into else {
            return;
        };
        if !enter(held, next, cut, setting.measure, [&mut halves.from, &mut halves.to]) {
            *into = Course::None;
            return;
        }
        symmetric.curve(to_f32(cut.before) * DISTANCE_LSB, halves);
        *passage = cut.leave(held, next, &halves.from, setting.const_vel);
    }

    /// Cuts the curve into elements.
    #[inline(never)]
    fn fit<const AXES: usize>(stage: &mut JoinStep, setting: &Setting<'_, AXES>, into: &mut Course<AXES>) {
        let &Setting { measure, const_vel, .. } = setting;
        let (&mut JoinStep::Fitting { cut, slack, smaller }, Some(course)) = (&mut *stage, even(into)) else {
            return;
        };
        let even = if const_vel { CONSTANT } else { EVEN };
        let mut fit = Fit::Working;
        for _ in 0..ELEMENTS {
            fit = course.fit(measure, even, slack);
            if fit != Fit::Working {
                break;
            }
        }
        match fit {
            Fit::Working => {}
            Fit::Failed => *stage = cut.smaller(slack, smaller),
            Fit::Ready if const_vel => {
                let steady = Steady { length: 0.0, ..Steady::FREE };
                *stage = JoinStep::Timing { cut, element: None, steady };
            }
            Fit::Ready => *stage = JoinStep::Joining { cut, steady: None },
        }
    }

    /// Adds some elements to their common length, and lowers the common speed if an element demands it.
    #[inline(never)]
    fn time<const AXES: usize>(
        [held, next]: [&HeldBlock<AXES>; 2],
        setting: &Setting<'_, AXES>,
        stage: &mut JoinStep,
        into: &mut Course<AXES>,
    ) {
        let (JoinStep::Timing { cut, element, steady }, Some(course)) = (&mut *stage, even(into)) else {
            return;
        };
        let feed = |part: &Rehearsal<AXES>| [held, next][usize::from(!part.is_first)].block.data.feed;
        let Some(from) = *element else {
            *element = Some(0);
            let part = course.rehearse(setting.measure, course.behind_joint());
            let known = part.and_then(|part| Self::permitted(course, &part, feed(&part), setting));
            steady.v = known.map_or(steady.v, |(_, v)| v);
            return;
        };
        for i in from..from + TIMED {
            let known = course.rehearse(setting.measure, i).and_then(|part| {
                let (check, feed) = (setting.check_jerk, feed(&part));
                if setting.dynamics.permits(steady.v, &part.hull(), (feed, part.fastest), check) {
                    return Some((distance(part.length)?, None));
                }
                let (length, v) = Self::permitted(course, &part, feed, setting)?;
                Some((length, Some(v)))
            });
            let Some((length, v)) = known else {
                *stage = JoinStep::Joining { cut: *cut, steady: Some(*steady) };
                return;
            };
            *element = Some(i + 1);
            steady.length += to_f32(length.to_bits()) * DISTANCE_LSB;
            if let Some(v) = v {
                steady.v = min(steady.v, v);
                return;
            }
        }
    }

    /// Length of an element, and its permitted speed. Returns `None` if the element cannot be made.
    #[inline(never)]
    fn permitted<const AXES: usize>(
        course: &CornerCurve<AXES>,
        part: &Rehearsal<AXES>,
        feed: Option<f32>,
        setting: &Setting<'_, AXES>,
    ) -> Option<(Distance, f32)> {
        let (length, mut bounds) = course.bounds(part)?;
        bounds.passage = Passage::Constant;
        let curving = Curving { jerk: setting.check_jerk, constant: Some(Steady::FREE), near: Near::NONE };
        let (limits, ..) = setting.dynamics.polynomial(length, &bounds, feed, curving);
        Some((length, limits.v))
    }

    /// Completes the curve over arc length, and shortens both blocks.
    #[inline(never)]
    fn join<const AXES: usize>(
        held: &mut HeldBlock<AXES>,
        next: &mut HeldBlock<AXES>,
        (cut, steady): (Cut, Option<Steady>),
        setting: &Setting<'_, AXES>,
        into: &mut Course<AXES>,
    ) {
        let passage = even(into)
            .and_then(|course| cut.part(held, next, course.ends(), (setting.measure, setting.const_vel)));
        match (&mut *into, passage) {
            (Course::Turning(turning), Some(passage)) => {
                (turning.curving.constant, turning.passage) = (steady, passage);
            }
            _ => *into = Course::None,
        }
    }

    /// Cuts both blocks where a curve over time begins and ends, and makes the curve.
    #[inline(never)]
    fn overlap<const AXES: usize>(
        held: &mut HeldBlock<AXES>,
        next: &mut HeldBlock<AXES>,
        overlap: Overlap,
        setting: &Setting<'_, AXES>,
        into: &mut Course<AXES>,
    ) {
        *into = Course::None;
        let Some(rule) = &held.rule else { return };
        let reach = to_bits::<44>(overlap.rise.distance());
        let (cut, all) = Cut::even(held, next, rule, reach);
        if overlap.rise.v <= 0.0 || all <= 0 {
            return;
        }
        let mut from = Knot::BLANK;
        let mut to = Knot::BLANK;
        if !enter(held, next, cut, setting.measure, [&mut from, &mut to]) {
            return;
        }
        Self::pass([held, next], (overlap, all), [&from, &to], setting, into);
        cut.leave(held, next, &from, setting.const_vel);
    }

    /// The curve over time between two knots, up to `all` (LSB 2^-44 mm) from the corner.
    #[inline(never)]
    fn pass<const AXES: usize>(
        [held, next]: [&HeldBlock<AXES>; 2],
        (overlap, all): (Overlap, i64),
        knots: [&Knot<AXES>; 2],
        setting: &Setting<'_, AXES>,
        into: &mut Course<AXES>,
    ) {
        let course = Timed::new(&held.block.to, overlap, all, knots);
        *into = Course::Turning(Turning::new([held, next], Cornering::Timed(course), setting));
    }

    /// Cuts both blocks at a shallow corner, and makes the curve.
    #[inline(never)]
    fn bend<const AXES: usize>(
        [held, next]: [&mut HeldBlock<AXES>; 2],
        c: f32,
        setting: &Setting<'_, AXES>,
        into: &mut Course<AXES>,
    ) {
        *into = Course::None;
        let Some(rule) = &held.rule else { return };
        let most = held.length.min(next.length) / 2;
        let (cut, reach) = Cut::even(held, next, rule, to_i64(c * ONE_44).min(most));
        let c = to_f32(reach) * DISTANCE_LSB;
        if c < SHORTEST {
            return;
        }
        into.begin_halves([held, next], setting);
        let Course::Turning(Turning { course: Cornering::Halves(halves), .. }) = into else { return };
        if !enter(held, next, cut, setting.measure, [&mut halves.from, &mut halves.to]) {
            *into = Course::None;
            return;
        }
        kernel(&held.block.to, c, halves);
        cut.leave(held, next, &halves.from, setting.const_vel);
    }

    /// Distance in space per path distance on both sides, and the path of a curve with these cuts if a master
    /// axis is the path.
    #[inline(never)]
    fn lead<const AXES: usize>(
        [held, next]: [&HeldBlock<AXES>; 2],
        (rule, Cut { before, behind }): (&Parameters, Cut),
        setting: &Setting<'_, AXES>,
        spaces: &mut [f32; 2],
    ) -> Option<f32> {
        let corner = corner(held, next, setting);
        *spaces = corner.spaces_per_path();
        let path = || to_f32(before.saturating_add(behind)) * DISTANCE_LSB;
        corner.follows_master(rule, setting.measure).then(path)
    }

    /// Begins a curve over arc length at its two knots, still without its halves. Returns whether there are
    /// such knots.
    #[inline(never)]
    fn begin<const AXES: usize>(
        [held, next]: [&HeldBlock<AXES>; 2],
        (cut, spaces): (Cut, [f32; 2]),
        setting: &Setting<'_, AXES>,
        into: &mut Course<AXES>,
    ) -> bool {
        let (mut from, mut to) = (Knot::BLANK, Knot::BLANK);
        if !ends(held, next, cut, setting.measure, [&mut from, &mut to]) {
            return false;
        }
        let given = held.rule.as_ref().is_some_and(|rule| rule.method == ContourMethod::Pos);
        let knots = [&from, &to];
        let course = CornerCurve::new(spaces, &held.block.to, knots, given);
        *into = Course::Turning(Turning::new([held, next], Cornering::Even(course), setting));
        true
    }

    /// Makes the halves of the curve. Returns whether they can be made.
    #[inline(never)]
    fn lay<const AXES: usize>(
        course: &mut CornerCurve<AXES>,
        (corner, rule): (&[Position; AXES], &Parameters),
        measure: &Measure,
        lead: Option<f32>,
    ) -> bool {
        let mut point = [0.0; AXES];
        for (k, value) in measure.main.places().into_iter().zip(rule.point()) {
            let (Some(k), Some(value)) = (k, value) else { continue };
            if let (Some(x), Some(corner)) = (point.get_mut(k), corner.get(k)) {
                *x = to_f32(value.to_bits().saturating_sub(corner.to_bits())) * LSB_32;
            }
        }
        let interim = (rule.method == ContourMethod::Pos).then_some(&point);
        course.lay(measure, interim, lead)
    }
}

/// The curve over arc length, if the course holds one.
fn even<const AXES: usize>(course: &mut Course<AXES>) -> Option<&mut CornerCurve<AXES>> {
    match course {
        Course::Turning(Turning { course: Cornering::Even(curve), .. }) => Some(curve),
        _ => None,
    }
}

impl Cut {
    /// The next step with smaller cuts. An arc may come back so near to the other block that no even curve
    /// joins them.
    fn smaller(self, slack: f32, smaller: u8) -> JoinStep {
        if smaller + 1 >= SMALLER {
            return JoinStep::Sharp;
        }
        let [before, behind] = [self.before, self.behind].map(|c| c - c / 4);
        JoinStep::Cutting { cut: Self { before, behind }, slack, smaller: smaller + 1 }
    }
}

impl<const AXES: usize> Course<AXES> {
    /// Begins a curve in two halves, which are not made yet. A separate function, because it has two callers.
    #[inline(never)]
    fn begin_halves(&mut self, blocks: [&HeldBlock<AXES>; 2], setting: &Setting<'_, AXES>) {
        *self = Self::Turning(Turning::new(blocks, Cornering::Halves(Halves::NONE), setting));
    }
}

impl<const AXES: usize> Turning<AXES> {
    /// A curve between these blocks. The caller sets how the speed behaves, unless the curve is over time.
    #[inline(always)]
    fn new(
        [held, next]: [&HeldBlock<AXES>; 2],
        course: Cornering<AXES>,
        setting: &Setting<'_, AXES>,
    ) -> Self {
        let [first, second] = [&held.block.data, &next.block.data];
        let due = match held.rule.as_ref().map(|rule| rule.action) {
            Some(ContourAction::Pre) => [second.number; 2],
            Some(ContourAction::Post) => [first.number; 2],
            _ => [first.number, second.number],
        };
        let curving = Curving { jerk: setting.check_jerk, constant: None, near: Near::NONE };
        Self { course, before: *first, due, curving, passage: Passage::Varying, draft: None }
    }
}

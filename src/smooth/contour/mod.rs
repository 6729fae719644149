//! Contour mode (G61, G261, #CONTOUR MODE): corners between blocks become curves that are continuous in
//! direction and curvature, inside a tolerance (DEV), at given distances (DIST), through a given point (POS),
//! or such that axes change their speed as they can (DIST_SOFT, DIST_MASTER, PTP; DEV where that is
//! quickest): `timed.rs` says why and where.
//!
//! A block whose end is to be rounded is held back until the next one is known; nothing else is. What the
//! corner cuts from it only shortens its path length: the curve of the block stays the same to the last bit.
//! Its end is then between two steps of a position, and the corner's curve begins on the nearest one, half a
//! step of each axis beside it at most. The block behind the corner begins on the step nearest to where the
//! corner's curve ends: an arc is made anew from there; a line keeps its direction, and has so much less path.
//!
//! Blocks too short for a curve (RELEVANT_PATH, RELEVANT_TRACK) are left out: the curve goes from the last
//! relevant block to the first one that ends beyond the limit. A short line to begin with is joined to the
//! line behind it: with DEV where it is short by RELEVANT_PATH, with the others below 16 µm. Where no curve
//! comes of it, a straight line stands for the blocks left out. Their deviation is counted, which the sources
//! leave out; so RELEVANT_PATH counts up to the tolerance, and its least value of 32 µm up to a quarter of a
//! given corner distance.
//!
//! With DEV a line may stand for nearly straight chords, if the machine data say so: `chords.rs`.
//!
//! When something is sampled: whether the end of a block is rounded, by which method and how far, when that
//! block comes; CHECK_JERK and CONST_VEL when the next one comes. G260 and #CONTOUR MODE OFF between two
//! blocks cancel the corner between them, inside the second one they do not. PRE_ACTION, INTER_ACTION and
//! POST_ACTION count as they stood when the block before the corner came. A keyword that the method in force
//! does not have counts as if it had never been given.
//!
//! A dwell, or whatever else demands a standstill between two blocks, is at the programmed corner: the motion
//! cannot rest in a curve that stands for it. So there is no curve there, and a warning says so for a dwell.
//! (The sources print a program with a dwell behind G61 and do not say what becomes of the corner.)
//!
//! A row of blocks left out ends where contouring is switched off or gets other parameters, at a standstill,
//! and at the program end: the corner before them is rounded, with the line over them as the block behind it,
//! whose end is passed exactly. What changes nothing, as a second G261, ends nothing.
mod choice;
mod chords;
mod corner;
pub(super) mod corner_curve;
pub(super) mod curve;
mod cut;
mod halves;
mod held_block;
mod held_blocks;
mod joining;
mod kernel;
mod parameters;
mod symmetric;
mod timed;

pub(super) use choice::Edge;
pub(super) use parameters::half_sine;
pub use parameters::{Parameters, Preset};

use self::chords::Chords;
use self::corner_curve::CornerCurve;
use self::halves::Halves;
use self::held_block::{HeldBlock, Skipped, Stray};
use self::held_blocks::{HeldBlocks, Slot};
use self::joining::{Joining, Search, Setting};
use self::timed::Timed;
use crate::dynamics::{Curving, Dynamics};
use crate::nc::{Contour, ContourMethod, ContourSwitch, NcWarningKind, Place, SlopeType};
use crate::path::poly::Draft;
use crate::path::{Element, Measure, Passage, line_to, straight_line};
use crate::quantity::{Distance, Position};
use crate::smooth::{Data, Form, Parting, ProgrammedBlock, Smoothed, Smoother};
use core::num::NonZeroI64;

/// An element that waits to be emitted.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Made<const AXES: usize> {
    element: Element<AXES>,
    /// See [`Smoothed::end`].
    end: Option<[Position; AXES]>,
    data: Data,
    curving: Option<Curving>,
    /// See [`Smoothed::due`].
    due: u32,
}

impl<const AXES: usize> Made<AXES> {
    /// None yet.
    const BLANK: Self = Self { element: Element::BLANK, end: None, data: Data::BLANK, curving: None, due: 0 };

    fn smoothed(&self) -> Smoothed<'_, AXES> {
        let Self { element, end, data, curving, due } = self;
        Smoothed { element, end: end.as_ref(), data, curving: *curving, due: *due, known: None }
    }
}

/// A curve in a corner on its way out.
#[derive(Clone, Copy, Debug)]
struct Turning<const AXES: usize> {
    course: Cornering<AXES>,
    /// What goes with its first half; with the second one what goes with the block behind it.
    before: Data,
    /// Functions due before each half.
    due: [u32; 2],
    curving: Curving,
    /// It is passed at one speed where the blocks beside it have the way to change theirs. A curve over time
    /// has its own.
    passage: Passage,
    /// Of the element that is being made.
    draft: Option<Draft<AXES>>,
}

impl<const AXES: usize> Turning<AXES> {
    /// The next element, which is not made yet, before the block behind the curve or of it. `None` if there is none.
    fn begin(&mut self, behind: &Data, measure: &Measure, made: &mut Made<AXES>) -> Option<()> {
        self.label(behind, made);
        let draft = self.draft.insert(self.course.next_element(measure, &mut made.element)?);
        made.end = Some(*draft.to());
        if let Some(bounds) = made.element.bounds.as_mut().filter(|bounds| !bounds.is_timed()) {
            bounds.passage = self.passage;
        }
        made.curving = Some(self.curving);
        Some(())
    }

    /// What goes with the next element.
    #[inline(always)]
    fn label(&self, behind: &Data, made: &mut Made<AXES>) {
        let [before_due, behind_due] = self.due;
        let (data, due) =
            if self.course.is_before() { (&self.before, before_due) } else { (behind, behind_due) };
        (made.data, made.due) = (Data { stop: false, ..*data }, due);
    }

    /// Whether its last element is made.
    fn is_done(&self) -> bool {
        self.draft.is_none() && self.course.is_done()
    }

    /// A line from there to the end of the curve, in place of what cannot be made; `None` at its end.
    #[cold]
    #[inline(never)]
    fn go_straight(
        &mut self,
        from: &[Position; AXES],
        (behind, measure): (&Data, &Measure),
        made: &mut Made<AXES>,
    ) -> Option<()> {
        self.draft = None;
        self.label(behind, made);
        if line_to([from, self.course.finish()], measure, &mut made.element) != Ok(true) {
            return None;
        }
        (made.curving, made.end) = (None, None);
        Some(())
    }

    /// Goes on making it. `None` where it cannot be made.
    fn go_on(&mut self, element: &mut Element<AXES>) -> Option<()> {
        let Some(draft) = &mut self.draft else { return Some(()) };
        draft.go_on(element)?;
        if draft.is_done() {
            self.course.settle(element);
            self.draft = None;
        }
        Some(())
    }
}

/// Settings in force: all state that stays when no block is held back.
#[derive(Clone, Copy, Debug)]
pub struct Settings {
    parameters: Parameters,
    on: bool,
    once: bool,
}

impl Settings {
    /// Takes in a command, while another kind of smoothing is at work.
    pub fn command(&mut self, contour: &Contour) {
        self.parameters.update(contour);
        match contour.switch {
            None => {}
            Some(ContourSwitch::Block) => self.once = true,
            Some(switch) => self.on = switch == ContourSwitch::On,
        }
    }

    /// The interim point of POS by main axes, if corners may have it.
    pub fn swings(&self) -> [bool; 3] {
        let pos = (self.on || self.once) && self.parameters.method == ContourMethod::Pos;
        self.parameters.point().map(|point| pos && point.is_some())
    }

    /// Whether the end of the next block is rounded.
    pub const fn is_on(&self) -> bool {
        self.on || self.once
    }

    /// Settings at program start.
    pub fn restarted(&self) -> Self {
        Self::off(self.parameters.preset())
    }

    /// Off.
    pub fn off(preset: Preset) -> Self {
        Self { parameters: Parameters::new(preset), on: false, once: false }
    }

    /// P-CHAN-00110.
    pub const fn check_jerk_of_channel(&self) -> u8 {
        self.parameters.preset().check_jerk
    }

    /// Settings with DEV at every corner, and no block left out.
    pub fn at_edges(check_jerk: u8) -> Self {
        let mut parameters = Parameters::new(Preset { check_jerk, chords: 0.0 });
        (parameters.max_angle, parameters.edges) = (1.0, true);
        Self { parameters, on: true, once: false }
    }

    /// Settings at program start, changed by this command.
    pub fn on_with(&self, contour: &Contour) -> Self {
        let mut parameters = Parameters::new(self.parameters.preset());
        parameters.update(contour);
        Self { parameters, on: true, once: false }
    }
}

/// The stage: between the blocks' curves and the look-ahead.
#[derive(Clone, Copy, Debug)]
pub struct Contouring<const AXES: usize> {
    measure: Measure,
    parameters: Parameters,
    /// G261.
    on: bool,
    /// G61, for the next motion block.
    once: bool,
    /// What goes out, in this order: the block before a corner, element by element its curve, or what stands
    /// for blocks left out, the block behind it. The first one is the last of `blocks` then.
    is_leaving: bool,
    /// The element at hand is there: of the curve, or what stands for blocks left out.
    is_made: bool,
    /// The corner between the block held back and the one that waits, while it is worked on: nothing goes out then.
    joining: Option<Joining>,
    course: Course<AXES>,
    /// The block held back. The one behind it, whose end is rounded by DIST_WEIGHT: its share in the corner
    /// before it depends on the next one. Or a line that may still grow by the next one. Only behind a block
    /// whose end is rounded. The one behind that, while the corner between both others is worked on.
    blocks: HeldBlocks<AXES>,
    /// The blocks left out behind the one held back; until the line that stands for them is made, behind the one that
    /// leaves.
    skipped: Option<Skipped<AXES>>,
    /// The next block is half a line that ends or begins where nothing turns.
    half: bool,
    /// What is to be said about the curve that the last block led to.
    remark: Option<NcWarningKind>,
    /// Since the last command a warning has told that the slope STEP optimises nothing.
    told: bool,
}

/// What is being made, one at a time.
#[derive(Clone, Copy, Debug)]
enum Course<const AXES: usize> {
    /// Nothing.
    None,
    /// What the last line is made of, while it may grow.
    Gathering(Chords<AXES>),
    /// The distances of a curve are searched for.
    Reaching(Search<AXES>),
    /// A curve.
    Turning(Turning<AXES>),
}

impl<const AXES: usize> Course<AXES> {
    /// A line that may be beside what it stands for by so much may grow. A call of its own: it is there twice.
    #[inline(never)]
    fn gather(&mut self, stray: Stray) {
        *self = Self::Gathering(Chords::beside(stray));
    }
}

/// The curve of a corner.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Cornering<const AXES: usize> {
    /// Over its arc length.
    Even(CornerCurve<AXES>),
    /// Over time.
    Timed(Timed<AXES>),
    /// Between two lines, in two halves.
    Halves(Halves<AXES>),
}

impl<const AXES: usize> Cornering<AXES> {
    /// Whether the next element belongs to the block before the corner.
    fn is_before(&self) -> bool {
        match self {
            Self::Even(course) => course.is_before(),
            Self::Timed(timed) => timed.is_before(),
            Self::Halves(halves) => halves.is_before(),
        }
    }
}

impl<const AXES: usize> Cornering<AXES> {
    /// The next element, with its axes to be made.
    fn next_element(&mut self, measure: &Measure, element: &mut Element<AXES>) -> Option<Draft<AXES>> {
        match self {
            Self::Even(course) => course.next_element(measure, element),
            Self::Timed(timed) => timed.next_element(element),
            Self::Halves(halves) => halves.next_element(element),
        }
    }

    /// Whether all elements are handed out.
    fn is_done(&self) -> bool {
        match self {
            Self::Even(course) => course.is_done(),
            Self::Timed(timed) => timed.is_done(),
            Self::Halves(halves) => halves.is_done(),
        }
    }

    /// Where the last element ended.
    fn stands(&self) -> [Position; AXES] {
        match self {
            Self::Even(course) => *course.stands(),
            Self::Timed(timed) => *timed.stands(),
            Self::Halves(halves) => *halves.stands(),
        }
    }

    /// No further element is handed out; where the curve ends.
    fn finish(&mut self) -> &[Position; AXES] {
        match self {
            Self::Even(course) => course.finish(),
            Self::Timed(timed) => timed.finish(),
            Self::Halves(halves) => halves.finish(),
        }
    }

    /// The element is made.
    fn settle(&self, element: &mut Element<AXES>) {
        match self {
            Self::Even(_) => {}
            Self::Timed(timed) => timed.settle(element),
            Self::Halves(halves) => halves.settle(element),
        }
    }
}

const ONE_44: f32 = (1u64 << 44) as f32;
const LSB_32: f32 = 1.0 / (1u64 << 32) as f32;
const ONE_32: f32 = (1u64 << 32) as f32;
const LSB_40: f32 = 1.0 / (1u64 << 40) as f32;

/// Sine of half an angle below which a transition is tangential, and cosine of half an angle below which it
/// is a reversal.
const TANGENTIAL: f32 = 1.0 / 65_536.0;
const REVERSAL: f32 = 1.0 / 1024.0;

impl<const AXES: usize> Contouring<AXES> {
    /// Off.
    // In place, in every build: as a result it would be on the stack twice.
    #[inline(always)]
    pub fn new(measure: Measure, preset: Preset) -> Self {
        let parameters = Parameters::new(preset);
        Self {
            measure,
            parameters,
            on: false,
            once: false,
            is_leaving: false,
            is_made: false,
            joining: None,
            course: Course::None,
            blocks: HeldBlocks::none(),
            skipped: None,
            half: false,
            remark: None,
            told: false,
        }
    }

    /// With what was in force.
    // In place, in every build: as a result it would be on the stack twice.
    #[inline(always)]
    pub fn with(measure: Measure, settings: &Settings) -> Self {
        let Settings { parameters, on, once } = *settings;
        Self { parameters, on, once, ..Self::new(measure, parameters.preset()) }
    }

    /// As [`Self::with`], in place. Call it only while no block is held back.
    pub fn begin(&mut self, settings: &Settings) {
        self.clear();
        (self.half, self.remark) = (false, None);
        Settings { parameters: self.parameters, on: self.on, once: self.once } = *settings;
    }

    /// Settings in force.
    pub fn settings(&self) -> Settings {
        let Self { parameters, on, once, .. } = *self;
        Settings { parameters, on, once }
    }

    /// The tolerances of the corner behind the next block, which is half a line that ends or begins where
    /// nothing turns, or a whole block.
    pub(super) const fn tolerate(&mut self, [path_dev, track_dev]: [f32; 2], half: bool) {
        (self.parameters.path_dev, self.parameters.track_dev, self.half) = (path_dev, track_dev, half);
    }

    /// Takes in a command. `in_motion`: it stands in a block with a motion.
    pub fn command(&mut self, contour: &Contour, in_motion: bool) {
        let before = self.parameters;
        self.told = false;
        self.parameters.update(contour);
        if self.parameters != before && self.left_behind().is_some() && !in_motion {
            // Blocks left out: contouring goes on up to here.
            self.cancel();
        }
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

    /// The block held back, and the one that waits behind it.
    fn held(&self) -> Option<&HeldBlock<AXES>> {
        self.blocks.first()
    }

    /// The blocks left out behind it.
    fn left_behind(&self) -> Option<&Skipped<AXES>> {
        self.skipped.as_ref().filter(|_| !self.is_leaving)
    }

    /// See [`Self::held`].
    fn waiting(&self) -> Option<&HeldBlock<AXES>> {
        let [_, waiting, _] = self.blocks.all();
        waiting.block()
    }

    /// What came last has no curve at its end: the last block, if it is held back, or those left out behind it.
    /// `stop` demands a standstill there.
    #[inline(never)]
    fn end(&mut self, stop: bool) {
        let is_leaving = self.is_leaving;
        let [held, waiting, third] = self.blocks.all_mut();
        let third = if is_leaving { None } else { third.block_mut() };
        if let Some(last) = third.or(waiting.block_mut()) {
            last.rule = None;
            last.block.data.stop |= stop;
        } else if let (Some(skipped), false) = (&mut self.skipped, is_leaving) {
            skipped.over = true;
            skipped.data.stop |= stop;
        } else if let Some(held) = held.block_mut() {
            held.rule = None;
            held.block.data.stop |= stop;
        }
    }

    /// The block that waits comes behind the one held back: left out, part of it, or behind a corner.
    /// `behind`: length of the one after it, LSB 2^-44 mm, if the corner between them is rounded and that is
    /// known.
    fn enter(&mut self, behind: Option<i64>, parted: bool, dynamics: &Dynamics<AXES>) {
        if !self.left_out() && (parted || !self.merges(dynamics)) {
            self.join(behind, dynamics);
        } else {
            let [_, waiting, _] = self.blocks.all_mut();
            *waiting = Slot::Free;
        }
    }

    /// Whether the next block is left out. If it stands for one left out before it, it becomes the line over
    /// both.
    #[inline(never)]
    fn left_out(&mut self) -> bool {
        let Self { blocks, skipped, measure, .. } = self;
        let [slot, Slot::Block(next), _] = blocks.all_mut() else { return false };
        let Slot::Block(held) = slot else { return false };
        let Some(rule) = &held.rule else { return false };
        if next.rule.is_some()
            && let Some(more) = held.leave_out(skipped.as_ref(), next, rule, measure)
        {
            *skipped = Some(more);
            return true;
        }
        if let Some(standing) = held.stands(skipped.as_ref(), next, rule, measure) {
            let from = if standing.whole { held.block.from } else { held.block.to };
            if let Ok(Some(rest)) = straight_line(&from, &next.block.to, measure) {
                next.become_line(&from, &rest);
                next.length = next.block.element.shape.length.to_bits();
                next.stray = standing.stray;
                *skipped = None;
                if standing.whole {
                    // The short one to begin with is part of it.
                    *slot = Slot::Free;
                }
            }
        }
        false
    }

    /// Whether the line that came last grows by the next block. A line behind a corner that is done begins
    /// where that ends.
    fn gathers(
        &mut self,
        block: &ProgrammedBlock<AXES>,
        rule: Option<&Parameters>,
        dynamics: &Dynamics<AXES>,
    ) -> bool {
        let Self { blocks, skipped, course, .. } = self;
        let last = match blocks.all_mut() {
            [_, Slot::Block(waiting), _] => waiting,
            [Slot::Block(held), _, _] if held.is_untouched() && skipped.is_none() => held,
            _ => return false,
        };
        if last.rule.as_ref().is_none_or(|rule| rule.chords().is_none()) {
            return false;
        }
        if matches!(course, Course::None) {
            course.gather(last.stray);
        }
        let Course::Gathering(chords) = course else { return false };
        chords.gather(last, (block, rule), dynamics, &self.measure)
    }

    /// Whether the block held back and the next one become one.
    #[inline(never)]
    fn merges(&mut self, dynamics: &Dynamics<AXES>) -> bool {
        let Self { blocks, skipped: None, measure, .. } = self else { return false };
        let [Slot::Block(held), Slot::Block(next), _] = blocks.all_mut() else { return false };
        held.merge(next, dynamics, measure)
    }

    /// The corner between the block held back and the next one.
    #[inline(never)]
    fn join(&mut self, behind: Option<i64>, dynamics: &Dynamics<AXES>) {
        let Self { blocks, skipped, measure, joining, course, .. } = self;
        let [held, Slot::Block(next), _] = blocks.all_mut() else { return };
        let Slot::Block(held) = held else {
            blocks.leave();
            return;
        };
        let method = held.rule.as_ref().map_or(self.parameters.method, |rule| rule.method);
        let (check_jerk, const_vel) = self.parameters.curving(method);
        let setting = Setting { measure, check_jerk, const_vel, dynamics, skipped: skipped.as_ref() };
        next.previous = held.rule.as_ref().and_then(|_| NonZeroI64::new(held.length));
        let joining = joining.insert(Joining::new());
        let remark = joining.go_into([held, next], behind, &setting, course);
        if remark.is_some() {
            self.remark = remark;
        }
    }

    /// The corner is done: the block before it goes on, and what stands for blocks left out, if there is no
    /// curve. The block behind it is held back in its place.
    #[inline(never)]
    fn joined(&mut self) {
        self.joining = None;
        if matches!(self.course, Course::Turning(_)) {
            self.skipped = None;
        }
        let [Slot::Block(held), ..] = self.blocks.all() else { return };
        self.is_leaving = held.block.element.shape.length > Distance::ZERO;
        self.blocks.leave();
        if !self.is_leaving {
            self.left();
        }
    }

    /// The block before a corner has gone.
    fn left(&mut self) {
        self.is_leaving = false;
        if self.skipped.is_some() {
            self.bridge();
            return;
        }
        let [.., last] = self.blocks.all_mut();
        *last = Slot::Free;
    }

    /// What stands for blocks left out comes in its place.
    #[cold]
    #[inline(never)]
    fn bridge(&mut self) {
        let Self { blocks, skipped, measure, .. } = self;
        let [.., last] = blocks.all_mut();
        let (Some(Skipped { to, data, .. }), Some(held)) = (skipped.take(), last.block()) else { return };
        let from = held.block.to;
        *last = Slot::Made(Made::BLANK);
        let Slot::Made(made) = last else { return };
        (made.data, made.due) = (data, data.number);
        self.is_made = line_to([&from, &to], measure, &mut made.element) == Ok(true);
    }

    /// The block held back, which of two that are joined is the second one.
    fn current(&self) -> Option<&HeldBlock<AXES>> {
        if self.joining.is_some() { self.waiting() } else { self.held() }
    }

    /// What is left of a curve that cannot be made is a line; nothing is left at its end.
    #[cold]
    #[inline(never)]
    fn go_straight(&mut self) {
        let (Course::Turning(turning), Some((held, made))) = (&mut self.course, self.blocks.made()) else {
            return;
        };
        let from = turning.draft.as_ref().map_or_else(|| turning.course.stands(), |draft| *draft.from());
        self.is_made = turning.go_straight(&from, (&held.block.data, &self.measure), made).is_some();
        if !self.is_made {
            self.course = Course::None;
        }
    }

    /// Whether something goes out before anything comes in.
    pub(super) fn hands_out(&self) -> bool {
        let goes_out = self.current().is_some_and(|held| held.rule.is_none());
        self.is_leaving || self.is_made || goes_out
    }

    /// The block that waits comes in, when what is before it is done and gone and it need not wait for
    /// another one; or the line over blocks left out, when no more of them come. Whether one does.
    #[inline(never)]
    fn let_in(&mut self, dynamics: &Dynamics<AXES>) -> bool {
        if self.is_leaving || self.is_made {
            return false;
        }
        if self.skipped.as_ref().is_some_and(|skipped| skipped.over) {
            self.let_in_skipped(dynamics);
            return true;
        }
        if self.waiting().is_none_or(HeldBlock::waits) {
            return false;
        }
        self.enter(None, true, dynamics);
        true
    }

    /// The line over blocks left out comes in, before a block that waits.
    #[cold]
    #[inline(never)]
    fn let_in_skipped(&mut self, dynamics: &Dynamics<AXES>) {
        let Self { blocks, skipped, measure, .. } = self;
        let [held, waiting, third] = blocks.all_mut();
        let (Some(skipped), Slot::Block(held)) = (skipped.take(), held) else { return };
        // What waits is the third one while the corner before it is worked on.
        *third = *waiting;
        *waiting = Slot::Block(HeldBlock::BLANK);
        let Slot::Block(next) = waiting else { return };
        if held.behind(&skipped, measure, next) {
            self.enter(None, true, dynamics);
        } else {
            (*waiting, *third) = (*third, Slot::Free);
        }
    }

    /// The place of a block that waits.
    fn free(&mut self) -> &mut Slot<AXES> {
        let [_, waiting, third] = self.blocks.all_mut();
        if self.joining.is_some() { third } else { waiting }
    }

    /// A block waits.
    #[inline(never)]
    fn put(&mut self, block: &ProgrammedBlock<AXES>, rule: Option<Parameters>) {
        let half = core::mem::take(&mut self.half);
        let place = self.free();
        *place = Slot::Block(HeldBlock::new(block));
        let Slot::Block(held) = place else { return };
        held.rule = rule;
        if half {
            // Nearly all of it is for the one corner.
            held.length += held.length / 8 * 7;
        }
    }
}

impl<const AXES: usize> Smoother<AXES> for Contouring<AXES> {
    #[inline(never)]
    fn take(&mut self, block: &ProgrammedBlock<AXES>, dynamics: &Dynamics<AXES>, parting: Parting) {
        let mut rounds = (self.on || core::mem::take(&mut self.once)) && !block.data.stop;
        if rounds && self.parameters.method == ContourMethod::Ptp && block.form != Form::Line {
            self.on = false;
            rounds = false;
            self.remark = Some(NcWarningKind::PtpArc);
        }
        let optimised = rounds && self.parameters.method.is_optimised();
        if optimised && !self.told && dynamics.slope() == SlopeType::Step {
            self.told = true;
            self.remark = Some(NcWarningKind::StepIsNotOptimised);
        }
        let rule = if rounds { Some(self.parameters.by(self.parameters.method)) } else { None };
        if parting == Parting::None && self.gathers(block, rule.as_ref(), dynamics) {
            return;
        }
        if matches!(self.course, Course::Gathering(_)) {
            self.course = Course::None;
        }
        if let Some(waiting) = self.waiting() {
            let behind = waiting.rule.as_ref().map(|_| block.element.shape.length.to_bits());
            self.enter(behind, true, dynamics);
            self.put(block, rule);
            return;
        }
        self.put(block, rule);
        if self.held().is_some() && self.waiting().is_some_and(HeldBlock::waits) {
            return;
        }
        self.enter(None, parting != Parting::None, dynamics);
    }

    #[inline(never)]
    fn work(&mut self, dynamics: &Dynamics<AXES>) -> bool {
        if let (Some(joining), [Slot::Block(held), Slot::Block(next), _]) =
            (&mut self.joining, self.blocks.all_mut())
        {
            let method = held.rule.as_ref().map_or(self.parameters.method, |rule| rule.method);
            let (check_jerk, const_vel) = self.parameters.curving(method);
            let skipped = self.skipped.as_ref();
            let setting = Setting { measure: &self.measure, check_jerk, const_vel, dynamics, skipped };
            if !joining.go_on([held, next], &setting, &mut self.course) {
                return true;
            }
            self.joined();
            return !self.is_leaving;
        }
        let Course::Turning(turning) = &mut self.course else {
            return self.let_in(dynamics);
        };
        // The block before the corner, or an element that is made.
        if self.is_leaving || (self.is_made && turning.draft.is_none()) {
            return false;
        }
        let Some((held, made)) = self.blocks.made() else { return false };
        if !self.is_made {
            self.is_made = turning.begin(&held.block.data, &self.measure, made).is_some();
        }
        if self.is_made && turning.go_on(&mut made.element).is_some() {
            let goes_on = turning.draft.is_some();
            if turning.is_done() {
                self.course = Course::None;
            }
            // What is made goes out in the same call.
            return goes_on;
        }
        self.go_straight();
        true
    }

    fn emit(&mut self, into: impl FnOnce(&Smoothed<'_, AXES>)) -> bool {
        if self.is_leaving {
            if let [.., Slot::Block(held)] = self.blocks.all() {
                into(&held.smoothed());
            }
            self.left();
            return true;
        }
        if self.joining.is_some() {
            return false;
        }
        let [slot, _, last] = self.blocks.all_mut();
        if let (true, Slot::Made(made)) = (self.is_made, last) {
            into(&made.smoothed());
            self.is_made = false;
            return true;
        }
        let Some(held) = slot.block().filter(|held| held.rule.is_none()) else { return false };
        into(&held.smoothed());
        *slot = Slot::Free;
        true
    }

    fn flush(&mut self, stop: bool) {
        self.end(stop);
    }

    fn cancel(&mut self) {
        self.end(false);
    }

    fn restart(&mut self) {
        self.clear();
        (self.on, self.remark) = (false, None);
        self.parameters = Parameters::new(self.parameters.preset());
    }

    fn place(&self) -> Option<Place> {
        self.current().map(|held| held.block.data.place)
    }

    fn clear(&mut self) {
        for place in self.blocks.all_mut() {
            *place = Slot::Free;
        }
        (self.is_leaving, self.is_made, self.joining, self.skipped) = (false, false, None, None);
        self.course = Course::None;
        self.once = false;
    }

    fn remark(&mut self) -> Option<NcWarningKind> {
        self.remark.take()
    }

    fn is_idle(&self) -> bool {
        self.held().is_none() && !self.on && !self.once
    }

    #[cfg_attr(feature = "fast", inline(always))]
    fn is_empty(&self) -> bool {
        // Whatever there is else, is there with a block held back.
        self.held().is_none() && !self.is_made
    }

    fn rounds(&self) -> bool {
        let [held, waiting, third] = self.blocks.all();
        let third = if self.is_leaving { None } else { third.block() };
        match third.or(waiting.block()) {
            Some(last) => last.rule.is_some(),
            None => {
                held.block().is_some_and(|held| held.rule.is_some())
                    && self.left_behind().is_none_or(|skipped| !skipped.over)
            }
        }
    }

    fn holds(&self) -> bool {
        self.held().is_some()
    }

    fn gives_way(&mut self) -> bool {
        // A corner that is held back waits for its second block: the path does not depend on when the text
        // comes.
        false
    }
}

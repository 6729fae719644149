//! Contour mode (G61, G261, `#CONTOUR MODE`): corners between blocks become curves with continuous direction
//! and curvature.
//!
//! | method | curve of a corner |
//! |---|---|
//! | DEV | stays inside the tolerance PATH_DEV |
//! | DIST | begins and ends at given distances from the corner |
//! | POS | passes a given point |
//! | PTP, DIST_SOFT, DIST_MASTER | the axes change their speed as fast as their limits permit (`timed.rs`); DEV uses this curve too where it is quickest |
//!
//! **Blocks.** A block whose end is to be rounded is held back until the next block is known. A corner
//! shortens the block before it, and does not change any other coefficient of that block. In general, the
//! shortened end is not a multiple of 2^-32 mm, the LSB of a position. So the curve begins at the nearest
//! such position, and each axis is off by at most 2^-33 mm. The block after the corner begins at the end of
//! the curve. An arc is computed again from there; a line keeps its direction and becomes shorter.
//!
//! **Short blocks.** A block that is too short for a curve (RELEVANT_PATH, RELEVANT_TRACK) is left out. The
//! curve then leads from the last block before such blocks to the first block that ends farther away. If no
//! curve is possible, a straight line replaces the blocks. A short line before a corner is joined to the
//! block after the corner. With DEV, short means RELEVANT_PATH here; with the other methods at most 16 µm.
//! POS neither leaves out nor joins blocks.
//!
//! The deviation of left-out blocks counts against the tolerance, so the tolerance also limits RELEVANT_PATH.
//! (ISG's manuals do not describe this rule.) RELEVANT_PATH is at least 32 µm, or a quarter of the given
//! corner distances if this is less.
//!
//! A run of left-out blocks ends at a stop, at the program end, and where contour mode is switched off or
//! gets other parameters. The corner before the run is rounded. The straight line over the run is then the
//! block after this corner, and its end stays exact. A command that changes nothing, for example a second
//! G261, does not end the run.
//!
//! With DEV, one line may also replace nearly straight chords, if the machine data permit this (`chords.rs`).
//!
//! **Parameters.** CHECK_JERK and CONST_VEL act with the values that are in force when the planner makes the
//! curve. By then the planner has read the block behind the corner. All other keywords act with the values in
//! force at the block before the corner; so do PRE_ACTION, INTER_ACTION and POST_ACTION. A keyword that the
//! current method does not have counts as not programmed.
//!
//! G260 or `#CONTOUR MODE OFF` on a line of its own between two blocks cancels the curve between the blocks.
//! If the command is in the line of the block after the corner, the curve stays.
//!
//! **Stops.** A dwell between two blocks, or another command that demands a stop, belongs to the programmed
//! corner. The motion cannot stop there on a curve that replaces the corner. So the corner stays sharp, and
//! for a dwell the planner reports a warning. (ISG's manuals print a program with a dwell after G61, and do
//! not say what happens to the corner.)
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
    /// Exact end of the element, if known.
    end: Option<[Position; AXES]>,
    data: Data,
    curving: Option<Curving>,
    /// See [`Smoothed::due`].
    due: u32,
}

impl<const AXES: usize> Made<AXES> {
    /// No element.
    const BLANK: Self = Self { element: Element::BLANK, end: None, data: Data::BLANK, curving: None, due: 0 };

    fn smoothed(&self) -> Smoothed<'_, AXES> {
        let Self { element, end, data, curving, due } = self;
        Smoothed { element, end: end.as_ref(), data, curving: *curving, due: *due, known: None }
    }
}

/// A corner's curve that is being emitted.
#[derive(Clone, Copy, Debug)]
struct Turning<const AXES: usize> {
    course: Cornering<AXES>,
    /// Data of the first half. The second half has the data of the block after the corner.
    before: Data,
    /// Functions due before each half.
    due: [u32; 2],
    curving: Curving,
    /// The curve has a constant speed if the blocks next to it have room for a change of speed. A curve over
    /// time has its own speeds.
    passage: Passage,
    /// The element that is being made.
    draft: Option<Draft<AXES>>,
}

impl<const AXES: usize> Turning<AXES> {
    /// Begins the next element of the curve. `None` if there is none.
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

    /// Sets the data of the next element.
    #[inline(always)]
    fn label(&self, behind: &Data, made: &mut Made<AXES>) {
        let [before_due, behind_due] = self.due;
        let (data, due) =
            if self.course.is_before() { (&self.before, before_due) } else { (behind, behind_due) };
        (made.data, made.due) = (Data { stop: false, ..*data }, due);
    }

    /// Whether the last element is made.
    fn is_done(&self) -> bool {
        self.draft.is_none() && self.course.is_done()
    }

    /// A line from this point to the end of the curve, for a curve that cannot be made. Returns `None` at the
    /// end of the curve.
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

    /// Continues to make the element. `None` if it cannot be made.
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

/// The settings of contour mode: its parameters, and whether G261 or G61 is on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    parameters: Parameters,
    on: bool,
    once: bool,
}

impl Settings {
    /// Changes the settings by a command, while another kind of smoothing is active.
    pub fn command(&mut self, contour: &Contour) {
        self.parameters.update(contour);
        match contour.switch {
            None => {}
            Some(ContourSwitch::Block) => self.once = true,
            Some(switch) => self.on = switch == ContourSwitch::On,
        }
    }

    /// For each main axis: whether corners get a curve through an interim point (POS) with a coordinate for
    /// this axis.
    pub fn swings(&self) -> [bool; 3] {
        let pos = (self.on || self.once) && self.parameters.method == ContourMethod::Pos;
        self.parameters.point().map(|point| pos && point.is_some())
    }

    /// Whether contour mode rounds the end of the next block.
    pub const fn is_on(&self) -> bool {
        self.on || self.once
    }

    /// The settings of contour mode at program start.
    pub fn restarted(&self) -> Self {
        Self::off(self.parameters.preset())
    }

    /// Contour mode off.
    pub fn off(preset: Preset) -> Self {
        Self { parameters: Parameters::new(preset), on: false, once: false }
    }

    /// The default of CHECK_JERK in the machine data (P-CHAN-00110), 0 to 2.
    pub const fn check_jerk_of_channel(&self) -> u8 {
        self.parameters.preset().check_jerk
    }

    /// Settings for the edges of Surface: DEV at every corner, and no block left out.
    pub fn at_edges(check_jerk: u8) -> Self {
        let mut parameters = Parameters::new(Preset { check_jerk, chords: 0.0 });
        (parameters.max_angle, parameters.edges) = (1.0, true);
        Self { parameters, on: true, once: false }
    }

    /// The parameters.
    #[cfg(all(feature = "kinematics", feature = "surface"))]
    pub(super) const fn parameters(&self) -> &Parameters {
        &self.parameters
    }

    /// Whether Surface may smooth runs of lines with these settings ([`super::row`]).
    #[cfg(all(feature = "kinematics", feature = "surface"))]
    pub(super) fn is_row(&self) -> bool {
        self.on && !self.once && self.parameters.is_row()
    }

    /// Settings at program start, changed by `contour`.
    pub fn on_with(&self, contour: &Contour) -> Self {
        let mut parameters = Parameters::new(self.parameters.preset());
        parameters.update(contour);
        Self { parameters, on: true, once: false }
    }
}

/// The smoothing stage of contour mode: takes programmed blocks, and emits shortened blocks and the curves at
/// their corners.
#[derive(Clone, Copy, Debug)]
pub struct Contouring<const AXES: usize> {
    measure: Measure,
    parameters: Parameters,
    /// Whether G261 is on.
    on: bool,
    /// Whether G61 is on, for the next motion block.
    once: bool,
    /// Whether elements are being emitted. The order is: the block before a corner, its curve element by
    /// element or the line over left-out blocks, and the block after. The first of them is then the last one
    /// of `blocks`.
    is_leaving: bool,
    /// Whether the current element of the curve, or the line over left-out blocks, is made.
    is_made: bool,
    /// The corner between the held block and the waiting block, while work on it goes on. Meanwhile no
    /// element is emitted.
    joining: Option<Joining>,
    course: Course<AXES>,
    /// The held blocks. First: the held block. Second, only after a block whose end is rounded: a block that
    /// waits for the next one. The next block decides how much the corner may take (DIST_WEIGHT), or may
    /// extend this line. Third: the block after the second, while work on the corner between the first two
    /// goes on.
    blocks: HeldBlocks<AXES>,
    /// The blocks left out after the held block, until the line over them is made.
    skipped: Option<Skipped<AXES>>,
    /// Whether the next block is half a line, with a turn at one end only.
    half: bool,
    /// The warning about the curve at the last corner.
    remark: Option<NcWarningKind>,
    /// Whether a warning since the last command reported that the slope STEP does not optimise.
    told: bool,
}

/// The work in progress, one at a time.
#[derive(Clone, Copy, Debug)]
enum Course<const AXES: usize> {
    /// Nothing.
    None,
    /// The chords of the last line, while the line may grow.
    Gathering(Chords<AXES>),
    /// The search for the distances of a curve.
    Reaching(Search<AXES>),
    /// A curve.
    Turning(Turning<AXES>),
}

impl<const AXES: usize> Course<AXES> {
    /// Permits the line to grow, with this deviation. A separate function, because it has two callers.
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
    /// Begins the next element; the returned draft computes the polynomials of its axes.
    fn next_element(&mut self, measure: &Measure, element: &mut Element<AXES>) -> Option<Draft<AXES>> {
        match self {
            Self::Even(course) => course.next_element(measure, element),
            Self::Timed(timed) => timed.next_element(element),
            Self::Halves(halves) => halves.next_element(element),
        }
    }

    /// Whether all elements are emitted.
    fn is_done(&self) -> bool {
        match self {
            Self::Even(course) => course.is_done(),
            Self::Timed(timed) => timed.is_done(),
            Self::Halves(halves) => halves.is_done(),
        }
    }

    /// End of the last element.
    fn stands(&self) -> [Position; AXES] {
        match self {
            Self::Even(course) => *course.stands(),
            Self::Timed(timed) => *timed.stands(),
            Self::Halves(halves) => *halves.stands(),
        }
    }

    /// Ends the curve early: no further element is emitted. Returns the end of the curve.
    fn finish(&mut self) -> &[Position; AXES] {
        match self {
            Self::Even(course) => course.finish(),
            Self::Timed(timed) => timed.finish(),
            Self::Halves(halves) => halves.finish(),
        }
    }

    /// Completes the element.
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

/// θ is the change of direction. A transition is tangential if sin(θ/2) is below the first value, and a
/// reversal if cos(θ/2) is below the second value.
const TANGENTIAL: f32 = 1.0 / 65_536.0;
const REVERSAL: f32 = 1.0 / 1024.0;

impl<const AXES: usize> Contouring<AXES> {
    /// Contour mode off.
    // Made in place in every build; a returned value would be on the stack twice.
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

    /// Contour mode with these settings.
    // Made in place in every build; a returned value would be on the stack twice.
    #[inline(always)]
    pub fn with(measure: Measure, settings: &Settings) -> Self {
        let Settings { parameters, on, once } = *settings;
        Self { parameters, on, once, ..Self::new(measure, parameters.preset()) }
    }

    /// Begins anew with these settings, as [`Self::with`] but in place. Call this function only while no
    /// block is held back.
    pub fn begin(&mut self, settings: &Settings) {
        self.clear();
        (self.half, self.remark) = (false, None);
        Settings { parameters: self.parameters, on: self.on, once: self.once } = *settings;
    }

    /// The settings of contour mode that are in force.
    pub fn settings(&self) -> Settings {
        let Self { parameters, on, once, .. } = *self;
        Settings { parameters, on, once }
    }

    /// Sets the tolerances of the corner after the next block. `half`: this block is half a line, with a turn
    /// at one end only.
    pub(super) const fn tolerate(&mut self, [path_dev, track_dev]: [f32; 2], half: bool) {
        (self.parameters.path_dev, self.parameters.track_dev, self.half) = (path_dev, track_dev, half);
    }

    /// Takes a command of contour mode. `in_motion`: whether the command is in a block with a motion.
    pub fn command(&mut self, contour: &Contour, in_motion: bool) {
        let before = self.parameters;
        self.told = false;
        self.parameters.update(contour);
        if self.parameters != before && self.left_behind().is_some() && !in_motion {
            // Other parameters end the run of left-out blocks, and the end of its line gets no curve.
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

    /// The held block.
    fn held(&self) -> Option<&HeldBlock<AXES>> {
        self.blocks.first()
    }

    /// The blocks left out after the held block.
    fn left_behind(&self) -> Option<&Skipped<AXES>> {
        self.skipped.as_ref().filter(|_| !self.is_leaving)
    }

    /// The waiting block, see [`Self::held`].
    fn waiting(&self) -> Option<&HeldBlock<AXES>> {
        let [_, waiting, _] = self.blocks.all();
        waiting.block()
    }

    /// Gives no curve to the end of the last block. The last block is the held block or the line over
    /// left-out blocks. `stop` demands a stop there.
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

    /// Brings the waiting block in after the held block. The waiting block is left out, joined to the held
    /// block, or the block after a corner. `behind`: length of the block after it, LSB 2^-44 mm; given if
    /// that length is known and the corner between them is rounded.
    fn enter(&mut self, behind: Option<i64>, parted: bool, dynamics: &Dynamics<AXES>) {
        if !self.left_out() && (parted || !self.merges(dynamics)) {
            self.join(behind, dynamics);
        } else {
            let [_, waiting, _] = self.blocks.all_mut();
            *waiting = Slot::Free;
        }
    }

    /// Leaves out the next block if it is too short. If the next block replaces an earlier left-out block, it
    /// becomes the line over both. Returns whether the next block is left out.
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
                    // The short line at the start is part of the joined line.
                    *slot = Slot::Free;
                }
            }
        }
        false
    }

    /// Whether the next block extends the last line. A line after a finished corner begins at the end of the
    /// corner's curve.
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

    /// Whether the held block and the next one become one.
    #[inline(never)]
    fn merges(&mut self, dynamics: &Dynamics<AXES>) -> bool {
        let Self { blocks, skipped: None, measure, .. } = self else { return false };
        let [Slot::Block(held), Slot::Block(next), _] = blocks.all_mut() else { return false };
        held.merge(next, dynamics, measure)
    }

    /// Begins the corner between the held block and the next one.
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

    /// Ends the work on a corner. The block before it is emitted, and the line over left-out blocks if there
    /// is no curve. The block after it becomes the held block.
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

    /// Ends the emission of the block before a corner.
    fn left(&mut self) {
        self.is_leaving = false;
        if self.skipped.is_some() {
            self.bridge();
            return;
        }
        let [.., last] = self.blocks.all_mut();
        *last = Slot::Free;
    }

    /// Makes the line over blocks left out the next element.
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

    /// The held block; of two joined blocks the second one.
    fn current(&self) -> Option<&HeldBlock<AXES>> {
        if self.joining.is_some() { self.waiting() } else { self.held() }
    }

    /// If a curve cannot be made, a line replaces its rest. At the end of the curve, there is no rest.
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

    /// Whether an element is to be emitted before a block is taken.
    pub(super) fn hands_out(&self) -> bool {
        let goes_out = self.current().is_some_and(|held| held.rule.is_none());
        self.is_leaving || self.is_made || goes_out
    }

    /// Takes the waiting block when everything before it is done and emitted, and no other block is needed
    /// first. Otherwise takes the line over left-out blocks, when their sequence is complete. Returns whether
    /// a block was taken.
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

    /// Takes the line over blocks left out, before a waiting block.
    #[cold]
    #[inline(never)]
    fn let_in_skipped(&mut self, dynamics: &Dynamics<AXES>) {
        let Self { blocks, skipped, measure, .. } = self;
        let [held, waiting, third] = blocks.all_mut();
        let (Some(skipped), Slot::Block(held)) = (skipped.take(), held) else { return };
        // The waiting block is the third block while work on the corner before it goes on.
        *third = *waiting;
        *waiting = Slot::Block(HeldBlock::BLANK);
        let Slot::Block(next) = waiting else { return };
        if held.behind(&skipped, measure, next) {
            self.enter(None, true, dynamics);
        } else {
            (*waiting, *third) = (*third, Slot::Free);
        }
    }

    /// The place of a waiting block.
    fn free(&mut self) -> &mut Slot<AXES> {
        let [_, waiting, third] = self.blocks.all_mut();
        if self.joining.is_some() { third } else { waiting }
    }

    /// Puts a block into the waiting place.
    #[inline(never)]
    fn put(&mut self, block: &ProgrammedBlock<AXES>, rule: Option<Parameters>) {
        let half = core::mem::take(&mut self.half);
        let place = self.free();
        *place = Slot::Block(HeldBlock::new(block));
        let Slot::Block(held) = place else { return };
        held.rule = rule;
        if half {
            // Nearly the whole block is for its only corner.
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
        // The block before the corner, or a finished element.
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
            // The element is emitted in the same call.
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
        // Other state exists only together with a held block.
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
        // A corner that is held back waits for its second block, so the path does not depend on the arrival
        // time of text.
        false
    }
}
